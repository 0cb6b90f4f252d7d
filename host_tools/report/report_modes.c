/* SPDX-License-Identifier: BSD-2-Clause */
/* Report page of `pzs modes` (report.h). */
#include <math.h>
#include "../model/modal.h"
#include "report_page.h"

/*
 * MOST_DRAWN: number of modes of which a page shows pictures. MOST_IN_PICTURE, COLUMNS: number of
 * mode shapes in the picture file, and in a row of it. WIDE, TALL: largest size of a mode shape in
 * pixels; GAP: space to the next one; TEXT: height of the text below it.
 */
enum { MOST_DRAWN = 24, MOST_IN_PICTURE = 6, COLUMNS = 3 };
enum { WIDE = SHELL_MAP_WIDTH, TALL = 280, GAP = 12, TEXT = 26 };

/* Whether the modes are those of a measured matrix, which are drawn as maps of the outputs. */
static bool is_measured(const page *page)
{
    return page->mesh->elements == 0;
}

/* Colours: size of the displacement over the largest one, for outputs of a matrix with its sign. */
static void choose_scale(page *page)
{
    page->scale = (draw_scale){is_measured(page), 1, ""};
}

static int drawn(const page *page, int most)
{
    const int count = page->vibrating->vibration.count;
    return count < most ? count : most;
}

/* Fill the values at the outputs of a measured mode, over the largest one. */
static void choose_outputs(page *page, const double *shape)
{
    const int targets = page->design->targets;
    design_shape(page->design, shape, page->row);
    const draw_scale scale = draw_scale_of(true, "", page->row, targets);
    for (int t = 0; t < targets; t++)
        page->row[t] /= scale.most;
    page_rows(page);
}

/* Choose a mode for the next picture: its largest displacement is 1, and the view contains it. */
static void choose_mode(page *page, int mode)
{
    const double *shape =
        page->vibrating->vibration.shape + (size_t)mode * (size_t)page->mesh->free_dof;
    if (is_measured(page)) {
        choose_outputs(page, shape);
        return;
    }
    page_displace(page, shape);
    for (int n = 0; n < page->mesh->nodes; n++)
        page->value[n] /= page->largest;
    page->space.factor = view_magnification(page->mesh, page->largest, 0.15);
    view_begin(&page->space.view, page->mesh, false);
    page_include(page);
    view_fit(&page->space.view, WIDE, TALL, TALL / 3.0);
}

/* View of the picture of a mode. */
static const view *view_of(const page *page)
{
    return is_measured(page) ? &page->map.view : &page->space.view;
}

static void draw_mode(const page *page)
{
    if (is_measured(page)) {
        shell_surface(&page->map, page->value, &page->scale);
        return;
    }
    shell_lines(&page->space, NULL, "rest");
    shell_surface(&page->space, page->value, &page->scale);
    shell_edges(&page->space, NULL, "outline");
}

/* ---- page --------------------------------------------------------------- */

static void write_figures(page *page)
{
    fputs(
        "<h2>Mode shapes</h2>\n<p class=\"soft\">Displacement over the largest one, drawn from the "
        "undeformed mesh.</p>\n<div class=\"row\">\n",
        page->file);
    for (int mode = 0; mode < drawn(page, MOST_DRAWN); mode++) {
        choose_mode(page, mode);
        fputs("<figure>\n", page->file);
        draw_begin(
            page->file, DRAW_IMAGE, view_of(page)->width, view_of(page)->height,
            "Mode shape in space",
            "The shape is coloured by the size of the displacement, over the undeformed mesh");
        draw_mode(page);
        draw_end(page->file, DRAW_IMAGE);
        put(page->file, PAGE_CAPTION("<b>Mode %d</b>: %n Hz"), mode + 1,
            page->vibrating->vibration.frequency[mode]);
    }
    fputs("</div>\n<figure><figcaption>", page->file);
    page_legend(page, &page->scale);
}

static void write_row(const page *page, int mode)
{
    const vibration *vibration = &page->vibrating->vibration;
    const coupling *coupling = &page->vibrating->coupling;
    const double *share = vibration->effective[mode], mass = vibration->mass;
    double shorted = (double)NAN, squared = (double)NAN;
    if (mode < coupling->count) {
        shorted = coupling->short_frequency[mode];
        squared = coupling->squared[mode];
    }
    put(page->file, PUT_ROW("%d|%n|%n|%n|%n|%p|%p|%p"), mode + 1, vibration->frequency[mode],
        vibration_damping(vibration, page->design, mode), shorted, squared, share[0] / mass,
        share[1] / mass, share[2] / mass);
}

static void write_page(page *page)
{
    page_begin(page,
               page->vibrating->is_loaded
                   ? "Vibration about the equilibrium under loads and voltages"
                   : "Vibration about the reference state",
               -1);
    put(page->file,
        "<h2>Modes</h2>\n" PUT_TABLE(
            "Natural frequencies; shares of the mass that take part in motions along x, y and z. "
            "Short-circuit frequency and coupling factor where electrodes are open.",
            "^Mode^Frequency (Hz)^Damping ratio^Short circuit (Hz)^Coupling k²^Mass x^y^z"));
    for (int mode = 0; mode < page->vibrating->vibration.count; mode++)
        write_row(page, mode);
    put(page->file, PUT_TABLE_END);
    write_figures(page);
}

/* ---- picture ------------------------------------------------------------ */

/* Height of the tallest picture of the first modes, in pixels. */
static double tallest(page *page, int count)
{
    double most = 0;
    for (int mode = 0; mode < count; mode++) {
        choose_mode(page, mode);
        most = fmax(most, view_of(page)->height);
    }
    return most;
}

static void write_picture(page *page)
{
    const int count = drawn(page, MOST_IN_PICTURE);
    const int columns = count < COLUMNS ? count : COLUMNS, rows = (count + COLUMNS - 1) / COLUMNS;
    const double tall = tallest(page, count) + TEXT,
                 width = fmax(columns * (WIDE + GAP), DRAW_LEGEND_WIDTH), height = rows * tall + 44;
    page_begin_picture(page, "mode shapes, displacement over the largest one", width, height);
    for (int mode = 0; mode < count; mode++) {
        const int column = mode % COLUMNS, row = mode / COLUMNS;
        choose_mode(page, mode);
        put(page->file, "<g transform=\"translate(%f,%f)\">\n", (double)(column * (WIDE + GAP)),
            row * tall);
        draw_mode(page);
        put(page->file, PUT_TEXT("mode %d, %n Hz") "</g>\n", "", 4.0, tall - TEXT / 2.0, mode + 1,
            page->vibrating->vibration.frequency[mode]);
    }
    draw_legend(page->file, &page->scale, 0, height - 32);
}

int report_modes(const report_job *job, const loaded_modes *modes)
{
    page page = {.vibrating = modes};
    return page_write(&page, job, &modes->analysis, choose_scale, write_page, write_picture);
}
