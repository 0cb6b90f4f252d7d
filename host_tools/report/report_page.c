/* SPDX-License-Identifier: BSD-2-Clause */
/* Frame of report pages and picture files, and pictures of a reached shape (report_page.h). */
#include "report_page.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../mesh/springs.h"
#include "../quads/vector.h"

#define PROGRAM "piezoshape " PZS_VERSION_TEXT
#define FACT(name, value) "<div><dt>" name "</dt><dd>" value "</dd></div>\n"

static int open_page(page *page, const report_job *job, const analysis *analysis)
{
    const design *design = &analysis->design;
    const size_t nodes = (size_t)design->mesh.nodes, targets = (size_t)design->targets;
    size_t values = 0;
    for (int k = 0; k < design->outputs; k++)
        values += (size_t)analysis_outputs(analysis, k);
    page->file = job->file;
    page->job = job;
    page->analysis = analysis;
    page->design = design;
    page->mesh = &design->mesh;
    page->inputs = design_inputs_of(design);
    words_unit(&design->units, QUANTITY_PRESSURE, page->pressure);
    page->vector = calloc(7 * nodes + targets + 2 * values, sizeof *page->vector);
    page->series = calloc((size_t)design->outputs + 1, sizeof *page->series);
    if (shell_open(&page->space, job->file, design, false) < 0 ||
        shell_open(&page->map, job->file, design, true) < 0 || !page->vector || !page->series)
        return -1;
    page->wanted = page->vector + 3 * nodes;
    page->value = page->wanted + 3 * nodes;
    page->row = page->value + nodes;
    page->curve = page->row + targets;
    page->space.vector = page->vector;
    page->space.factor = 1;
    page->space.has_failed = page->map.has_failed = &page->has_failed;
    return 0;
}

/* Write the command line, with quotes around words that are special to the shell. */
static void write_command(const report_job *job)
{
    for (int k = 0; k < job->words; k++) {
        const char *word = job->word[k];
        const char *quote = strpbrk(word, " \t\"'$&;<>()[]{}*?|\\") ? "'" : "";
        if (k == 0 && strrchr(word, '/'))
            word = strrchr(word, '/') + 1;
        put(job->file, "%s%t%t%t", k ? " " : "", quote, word, quote);
    }
}

static void write_structure_facts(const page *page, double residual)
{
    const mesh *mesh = page->mesh;
    const pzs_solver_info *info = &page->analysis->equilibrium.solver.info;
    const char *kinematics = mesh->formulation.cartesian ? "Cartesian" : "local";
    put(page->file,
        FACT("Mesh", "%d elements (types: %d), %d nodes") FACT("Free dof", "%d, half bandwidth %d")
            FACT("Element", "%s kinematics, %s metric, %d dof per node") FACT("Thickness", "%q")
                FACT("Condition number, scaled", "%r") FACT("Solver residual", "%r"),
        mesh->elements, mesh->types, mesh->nodes, mesh->free_dof, mesh_half_bandwidth(mesh),
        kinematics, mesh->formulation.metric ? "exact" : "flat", (int)mesh->dof_per_node,
        mesh->laminate.thickness, page->design->units.length, page->analysis->model.info.condition,
        residual);
    if (page->analysis->is_nonlinear)
        put(page->file,
            FACT("Load steps", "%d, %d linear solves")
                FACT("Equilibrium", "<b%s</b>, %d negative pivots")
                    FACT("Load factor reached", "%n"),
            (int)info->load_steps, (int)info->linear_solves,
            info->negative_pivots ? " class=\"warn\">unstable" : ">stable",
            (int)info->negative_pivots, info->load_factor);
    else
        put(page->file,
            FACT("Solver error estimate, energy norm; without the discretisation error", "%r"),
            page->analysis->model.info.error_estimate);
}

static void write_facts(const page *page, double residual)
{
    const design *design = page->design;
    fputs("<dl>\n", page->file);
    if (page->analysis->source->has_structure)
        write_structure_facts(page, residual);
    else
        put(page->file, FACT("Measured matrix", "%d outputs, %d actuators, in %t"),
            design->measured.outputs, design->amplifiers, design->measured.file);
    if (design->goal.given)
        put(page->file, FACT("Target", "<code>%t</code>"), expr_text(design->goal.value));
    fprintf(page->file, FACT("Scene", "%08lx") "</dl>\n", (unsigned long)design->structure.scene);
}

static void write_warnings(const page *page)
{
    static const char *const item = "<li><b class=\"warn\">%t</b>: %t</li>\n";
    const analysis *analysis = page->analysis;
    const plausible *warnings = &analysis->warnings;
    char text[SCENE_ERROR];
    if (warnings->count > 0)
        fputs("<h2>Warnings</h2>\n", page->file);
    fputs("<ul>\n", page->file);
    for (int k = 0; k < warnings->count; k++)
        put(page->file, item, warnings->warning[k].rule, warnings->warning[k].text);
    if (warnings->dropped > 0)
        put(page->file, "<li>and %d more</li>\n", warnings->dropped);
    if (analysis->is_nonlinear && analysis->status == PZS_W_BEHIND) {
        equilibrium_penetration_text(&analysis->equilibrium, analysis->status, text);
        put(page->file, item, pzs_status_text(analysis->status), text);
    }
    fputs("</ul>\n", page->file);
}

void page_begin(const page *page, const char *kind, double residual)
{
    const design *design = page->design;
    put(page->file,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
        "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>%t</title>\n",
        design->name);
    draw_style(page->file, true);
    const char *units = words_unitless(&design->units)
                            ? "The scene names no units: its numbers are "
                              "in any consistent ones, angles in rad."
                            : "";
    put(page->file,
        "</head>\n<body>\n<main>\n<header>\n<p class=\"kicker\">%s</p>\n<h1>%t</h1>\n<p>%t</p>\n"
        "<p class=\"soft\">%s</p>\n",
        kind, design->name, design->about ? design->about : "", units);
    write_facts(page, residual);
    write_warnings(page);
    fputs("</header>\n", page->file);
}

static void end_page(const page *page)
{
    page_structure(page);
    fputs("<footer>" PROGRAM ": <code>", page->file);
    write_command(page->job);
    fputs("</code></footer>\n</main>\n</body>\n</html>\n", page->file);
}

/* Space around the drawing in a picture file, in pixels: at both sides, above and below. */
enum { EDGE = 20, HEAD = 52, FOOT = 26 };

void page_begin_picture(const page *page, const char *title, double width, double height)
{
    const design *design = page->design;
    const double wide = width + 2 * EDGE, tall = height + HEAD + FOOT;
    const char *about = design->about ? design->about : "";
    const char *target = design->goal.given ? expr_text(design->goal.value) : "none";
    put(page->file,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "width=\"%f\" height=\"%f\" viewBox=\"%d %d %f %f\" role=\"img\">\n<title>%t: %t</title>"
        "<desc>%t Target: %t. Command: ",
        wide, tall, -EDGE, -HEAD, wide, tall, design->name, title, about, target);
    write_command(page->job);
    fputs("</desc>\n", page->file);
    draw_style(page->file, false);
    put(page->file,
        "<rect class=\"back\" x=\"%f\" y=\"%f\" width=\"%f\" height=\"%f\" rx=\"8\"/>\n",
        0.5 - EDGE, 0.5 - HEAD, wide - 1, tall - 1);
    put(page->file, PUT_TEXT("%t") PUT_TEXT("%t") PUT_TEXT(PROGRAM), "title", 0.0, 26.0 - HEAD,
        design->name, "", 0.0, 43.0 - HEAD, title, "end", width, height + FOOT - 9);
}

void page_legend(const page *page, const draw_scale *scale)
{
    if (scale->most > 0 && isfinite(scale->most)) {
        fputs("<div class=\"scale\">", page->file);
        draw_begin(page->file, DRAW_IMAGE, DRAW_LEGEND_WIDTH, 32, "Colour scale",
                   "Colours of the values of the picture");
        draw_legend(page->file, scale, 0, 0);
        draw_end(page->file, DRAW_IMAGE);
        fputs("</div>\n", page->file);
    } else {
        fputs("<p class=\"keys\">Zero everywhere.</p>\n", page->file);
    }
    fputs("</figcaption></figure>\n", page->file);
}

void page_map(const page *page, const double *value, draw_scale scale, const char *title,
              const char *note)
{
    const draw_scale own = draw_scale_of(true, scale.unit, value, page->mesh->nodes);
    fputs("<figure class=\"map\">\n", page->file);
    shell_map(&page->map, value, &scale, title);
    put(page->file, "<figcaption><b>%t</b>: largest %q%s", title, own.most, scale.unit, note);
    page_legend(page, &scale);
}

bool page_diagram(const page *page, draw_diagram *diagram, const char *heading, const char *title,
                  const char *x_unit, const char *y_unit)
{
    draw_axis *x = &diagram->x, *y = &diagram->y;
    draw_fit(diagram);
    if (!(x->high > x->low && y->high > y->low))
        return false;
    x->from = 84, x->to = 604;
    y->from = 240, y->to = 6;
    x->unit = put_unit_of(fmax(-x->low, x->high), x_unit);
    y->unit = put_unit_of(fmax(-y->low, y->high), y_unit);
    put(page->file, "%s<figure class=\"chart\">\n", heading);
    draw_begin(page->file, DRAW_CHART, 720, 274, title, "A curve for each output");
    draw_grid(page->file, diagram, true);
    draw_grid(page->file, diagram, false);
    draw_curves(page->file, diagram);
    draw_end(page->file, DRAW_CHART);
    return true;
}

void page_displace(page *page, const double *u)
{
    design_vectors(page->mesh, u, page->vector);
    page->largest = 0;
    for (int n = 0; n < page->mesh->nodes; n++) {
        page->value[n] = vector_length(page->vector + 3 * n);
        page->largest = fmax(page->largest, page->value[n]);
    }
}

void page_rows(page *page)
{
    for (int n = 0; n < page->mesh->nodes; n++)
        page->value[n] = (double)NAN;
    for (int t = 0; t < page->design->targets; t++)
        page->value[page->design->target_node[t]] = page->row[t];
}

draw_scale page_shape(page *page, const voltages *result, const double *target)
{
    const design *design = page->design;
    const scene_direction direction = {.component = design->goal.what.component};
    page_displace(page, result->displacement);
    (void)design_misfit(design, result->shape, target, page->row);
    page_rows(page);
    for (int i = 0; i < 3 * page->mesh->nodes; i++)
        page->wanted[i] = (double)NAN;
    for (int t = 0; t < design->targets; t++) {
        const int node = design->target_node[t];
        double along[3];
        springs_direction(&page->mesh->point[node], &direction, along);
        for (int i = 0; i < 3; i++)
            page->wanted[3 * node + i] = page->vector[3 * node + i] - page->row[t] * along[i];
    }
    return draw_scale_of(true, design->units.length, page->row, design->targets);
}

void page_include(page *page)
{
    shell_include(&page->space);
    page->space.vector = page->wanted;
    shell_include(&page->space);
    page->space.vector = page->vector;
}

void page_draw_shape(const page *page, const draw_scale *scale)
{
    const shell *space = &page->space;
    if (page->mesh->elements == 0) {
        shell_map(&page->map, page->value, scale, "Misfit at the outputs");
        return;
    }
    draw_begin(page->file, DRAW_IMAGE, space->view.width, space->view.height,
               "Reached shape in space",
               "The shape is coloured by its misfit, with the target as lines over it");
    shell_edges(space, NULL, "outline");
    shell_surface(space, page->value, scale);
    shell_lines(space, page->wanted, "wire");
    if (page->design->goal.what.where.type == WHERE_POINT)
        shell_node(space, page->wanted, page->design->target_node[0], "dot", 3.5);
    shell_directions(space);
    draw_end(page->file, DRAW_IMAGE);
}

void page_keys(const page *page, const char *more)
{
    static const char *const keys =
        PAGE_KEY("line", "target") PAGE_KEY("dash", "undeformed edges") PAGE_KEY("pins", "support");
    put(page->file, "<p class=\"keys\">%s%s</p>\n", page->mesh->elements > 0 ? keys : "", more);
}

int page_write(page *page, const report_job *job, const analysis *analysis, page_function *prepare,
               page_function *write_page, page_function *write_picture)
{
    page->has_failed = open_page(page, job, analysis) < 0;
    if (!page->has_failed) {
        prepare(page);
        (job->is_svg ? write_picture : write_page)(page);
        if (job->is_svg)
            fputs("</svg>\n", page->file);
        else
            end_page(page);
    }
    shell_close(&page->space);
    shell_close(&page->map);
    free(page->vector);
    free(page->series);
    return page->has_failed || ferror(page->file) ? -1 : 0;
}
