/* SPDX-License-Identifier: BSD-2-Clause */
/* Report page of `pzs solve` (report.h). */
#include <math.h>
#include <string.h>
#include "../quads/vector.h"
#include "report_page.h"

static double value_of(const page *page, int k, int i)
{
    return analysis_output(page->analysis, k, i, page->output);
}

/* Write the table row of an output: its value, or the range of its values if it has several. */
static void write_output(const page *page, int k)
{
    const scene_output *output = &page->design->output[k];
    const int count = analysis_outputs(page->analysis, k);
    const double reference = output->reference, first = value_of(page, k, 0);
    double low = first, high = first, mean = 0;
    char unit[WORDS_UNIT];
    for (int i = 0; i < count; i++) {
        low = fmin(low, value_of(page, k, i));
        high = fmax(high, value_of(page, k, i));
        mean += value_of(page, k, i) / count;
    }
    const double most = fmax(fmax(-low, high), isfinite(reference) ? fabs(reference) : 0);
    words_unit(&page->design->units, words_of_output(output), unit);
    put(page->file, PUT_ROW("%t|%a"), output->name, low, most, unit);
    if (count > 1)
        put(page->file, " to %a<br><span class=\"soft\">%d values, mean %a</span>", high, most,
            unit, count, mean, most, unit);
    put(page->file, "|%a|%n\n", reference, most, unit, first / reference);
}

static void write_outputs(const page *page)
{
    put(page->file,
        PUT_TABLE("Outputs; the ratio is value over reference, of the first value where there are "
                  "more. --json gives all values.",
                  "^Output^Value^Reference^Ratio"));
    for (int k = 0; k < page->design->outputs; k++)
        write_output(page, k);
    put(page->file, PUT_TABLE_END);
}

/*
 * Make the curve of displacement output k along one mesh line in the direction of the surface
 * coordinate theta1 (along = 0) or theta2 (along = 1), or a curve without points for other outputs.
 *   point [2 nodes of the output] out  surface coordinates of its nodes, then the displacements
 */
static draw_series curve_of(const page *page, int k, int along, double *point)
{
    const analysis *analysis = page->analysis;
    const scene_output *output = &page->design->output[k];
    const int count = analysis_outputs(analysis, k);
    const double *first = page->mesh->theta[0];
    if (words_of_output(output) != QUANTITY_LENGTH || count < 2)
        return (draw_series){.style = "wire"};
    for (int i = 0; i < count; i++) {
        const double *place = page->mesh->theta[analysis_output_node(analysis, k, i)];
        first = i == 0 ? place : first;
        if (place[1 - along] != first[1 - along])
            return (draw_series){.style = "wire"};
        point[i] = place[along];
        point[count + i] = value_of(page, k, i);
    }
    return (draw_series){"wire", point,        point + count,
                         count,  output->name, (4 - k % 4) * (count - 1) / 4};
}

/* Draw a diagram of the displacement outputs along mesh lines in one direction (curve_of). */
static void draw_lines(const page *page, int along)
{
    const char *length = page->design->units.length;
    const char *x_unit = page->mesh->is_angle[along] ? "rad" : length;
    const scene_line *line = &page->mesh->line[along];
    double *point = page->curve;
    for (int k = 0; k < page->design->outputs; k++) {
        page->series[k] = curve_of(page, k, along, point);
        point += 2 * page->series[k].count;
    }
    draw_diagram diagram = {.x = {.from = line->point[0], .to = line->point[line->elements]},
                            .series = page->series,
                            .count = page->design->outputs};
    if (page_diagram(page, &diagram,
                     along ? "<h2>Along lines of θ₂</h2>\n" : "<h2>Along lines of θ₁</h2>\n",
                     "Outputs along lines of the mesh", x_unit, length))
        put(page->file, PAGE_CAPTION("Displacement (%t) over the parameter (%t)."),
            diagram.y.unit.name, diagram.x.unit.name);
}

/* Choose scale and view of the deformed shape; only a linear displacement is magnified. */
static void fit_deformed(page *page)
{
    page_displace(page, page->u);
    page->scale = (draw_scale){false, page->largest, page->design->units.length};
    if (!page->analysis->is_nonlinear)
        page->space.factor = view_magnification(page->mesh, page->scale.most, 0.1);
    page_include(page);
    shell_find_body(&page->body, page->analysis, &page->space);
    view_fit(&page->space.view, 600, 560, 180);
}

static void draw_deformed(const page *page)
{
    shell_draw_body(&page->space, &page->body, false);
    shell_lines(&page->space, NULL, "rest");
    shell_surface(&page->space, page->value, &page->scale);
    shell_lines(&page->space, NULL, "rest ghost");
    shell_draw_body(&page->space, &page->body, true);
    shell_marks(&page->space);
    shell_directions(&page->space);
}

static void write_deformed(const page *page)
{
    const view *view = &page->space.view;
    fputs("<figure>\n", page->file);
    draw_begin(page->file, DRAW_IMAGE, view->width, view->height, "Deformed shape in space",
               "The shape is coloured by the size of the displacement, over the undeformed mesh");
    draw_deformed(page);
    draw_end(page->file, DRAW_IMAGE);
    put(page->file, "<p class=\"keys\">%s%s</p>",
        PAGE_KEY("gone", "undeformed") PAGE_KEY("pins", "support") PAGE_KEY("load", "point load"),
        page->body.is_given ? PAGE_KEY("solid", "rigid body, the part near the shell") : "");
    put(page->file, "<figcaption>Size of the displacement, drawn <b>× %n</b>; largest %q",
        page->space.factor, page->scale.most, page->scale.unit);
    page_legend(page, &page->scale);
}

static void write_components(const page *page)
{
    static const char *const name[3] = {"u₁ along e₁", "u₂ along e₂", "u₃ outwards"};
    fputs("<h2>Displacement of the middle surface</h2>\n<p class=\"soft\">Each on a scale of its "
          "own.</p>\n<div class=\"row\">\n",
          page->file);
    for (int a = 0; a < 3; a++) {
        for (int n = 0; n < page->mesh->nodes; n++)
            page->value[n] = vector_dot(page->mesh->point[n].triad[a], page->vector + 3 * n);
        draw_scale scale = draw_scale_of(true, page->scale.unit, page->value, page->mesh->nodes);
        const bool is_negligible = scale.most < 1e-9 * page->scale.most;
        scale.most = is_negligible ? 0 : scale.most;
        page_map(page, page->value, scale, name[a],
                 is_negligible ? ", below 10⁻⁹ of the largest displacement" : "");
    }
    fputs("</div>\n", page->file);
}

static void write_contact_map(const page *page)
{
    const pzs_contact_info *info = &page->analysis->equilibrium.contact.info;
    put(page->file,
        "<h2>Contact pressure</h2>\n<p>%d nodes in contact; the body is at most %q deep between "
        "nodes, which is the sag of the elements.</p>\n",
        (int)info->nodes, info->sag, page->design->units.length);
    page_map(page, info->pressure,
             draw_scale_of(false, page->pressure, info->pressure, page->mesh->nodes),
             "Contact pressure", ", per undeformed area");
}

/* Write a map of the potentials of each bare face (without electrodes) of the layers. */
static void write_potentials(const page *page)
{
    const design *design = page->design;
    char title[WORDS_FACE + 12] = "Electric ";
    char *const name = title + strlen(title);
    fputs("<h2>Faces without electrodes</h2>\n<div class=\"row\">\n", page->file);
    for (int k = 0; k < 2 * design->layers; k++) {
        if (!words_bare_face(design->layer, k, name))
            continue;
        for (int n = 0; n < page->mesh->nodes; n++)
            page->value[n] =
                bare_faces_potential(&design->bare, page->analysis->input_value, k / 2, k % 2, n);
        page_map(page, page->value,
                 draw_scale_of(true, design->units.voltage, page->value, page->mesh->nodes), title,
                 "");
    }
    fputs("</div>\n", page->file);
}

static void write_force(FILE *file, const char *name, const total_force *total)
{
    put(file, PUT_ROW("%t|%n|%n|%n|%n|%n|%n"), name, total->force[0], total->force[1],
        total->force[2], total->moment[0], total->moment[1], total->moment[2]);
}

/* Write the reactions of the supports and the sums of all forces, which are in equilibrium. */
static void write_reactions(const page *page)
{
    const reactions *all = &page->analysis->reactions;
    if (all->supports == 0)
        return;
    put(page->file,
        PUT_TABLE("Forces of the supports on the shell; moments about the mean position of their "
                  "nodes. Below: all forces, with moments about the origin; their sum vanishes at "
                  "equilibrium.",
                  "^Support^Force x^y^z^Moment x^y^z"));
    for (int k = 0; k < all->supports; k++)
        write_force(page->file, all->support[k].name, &all->support[k].total);
    write_force(page->file, "all supports", &all->held);
    write_force(page->file, "loads", &all->load);
    write_force(page->file, "springs", &all->spring);
    write_force(page->file, "contact", &all->contact);
    write_force(page->file, "sum", &all->sum);
    put(page->file, PUT_TABLE_END);
}

static void write_page(page *page)
{
    const analysis *analysis = page->analysis;
    voltages applied = {.voltage = analysis->input_value};
    char title[64];
    snprintf(applied.name, sizeof applied.name, "%s", page->inputs.title);
    snprintf(title, sizeof title, "Displacement under loads and applied %ss", page->inputs.name);
    page_begin(page, title,
               analysis->is_nonlinear ? analysis->equilibrium.solver.info.residual
                                      : analysis->model.info.residual);
    fputs("<h2>Result</h2>\n<div class=\"row\">\n", page->file);
    write_deformed(page);
    fputs("<div>\n", page->file);
    write_outputs(page);
    write_reactions(page);
    page_voltages(page, &applied, 1);
    fputs("</div>\n</div>\n", page->file);
    page_path(page);
    for (int along = 0; along < 2 && !page->mesh->quads; along++)
        draw_lines(page, along);
    if (page->body.is_given)
        write_contact_map(page);
    write_components(page);
    if (page->design->bare.count > 0)
        write_potentials(page);
    page_stress(page);
}

static void write_picture(page *page)
{
    const double width = page->space.view.width, height = page->space.view.height;
    page_begin_picture(page, "size of the displacement", width, height + 44);
    draw_deformed(page);
    draw_legend(page->file, &page->scale, 0, height + 12);
    put(page->file, PUT_TEXT("displacement × %n"), "end", width, height + 38, page->space.factor);
}

int report_solve(const report_job *job, const analysis *analysis, const double *u,
                 const double *output, const stress_field *stress)
{
    page page = {.u = u, .output = output, .stress = stress};
    return page_write(&page, job, analysis, fit_deformed, write_page, write_picture);
}
