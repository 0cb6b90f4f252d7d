/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Frames of the pages and of single pictures, and drawings of shapes with their misfit
 * (report_page.h).
 */
#include "report_page.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../text/words.h"

#define PROGRAM "piezoshape " PZS_VERSION_TEXT
#define FACT(name, value) "<div><dt>" name "</dt><dd>" value "</dd></div>\n"

/* ---- frame ------------------------------------------------------------ */

/*
 * Write the command line, without the folder of the program and with quotes around words that
 * contain blanks or special characters of the shell.
 */
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

/*
 * Result of a check of the solution, or NAN if it is negative, which means that the check was not
 * made.
 */
static double checked(double value)
{
    return value < 0 ? (double)NAN : value;
}

/* Write the number of load steps and linear solves, and whether the equilibrium is stable. */
static void write_path(FILE *file, const pzs_solver *run)
{
    put(file, FACT("Load steps", "%d, %d linear solves"), (int)run->info.load_steps,
        (int)run->info.linear_solves);
    if (run->info.negative_pivots)
        put(file, FACT("Equilibrium", "<b class=\"warn\">unstable</b>, %d negative pivots"),
            (int)run->info.negative_pivots);
    else
        put(file, FACT("Equilibrium", "stable"));
    if (run->info.load_factor < 1)
        put(file, FACT("Load factor reached", "<b class=\"warn\">%r</b>"), run->info.load_factor);
}

/* Write the size of the mesh and the checks of the solves. */
static void write_structure_facts(FILE *file, const analysis *analysis, double residual)
{
    const mesh *mesh = &analysis->design.mesh;
    const scene *scene = analysis->design.scene;
    static const char *const kinematics[] = {"local", "Cartesian"}, *const metric[] = {"flat",
                                                                                       "exact"};
    if (mesh->quads)
        put(file, FACT("Mesh", "%d elements of %d type%s, %d nodes"), mesh->elements, mesh->types,
            mesh->types == 1 ? "" : "s", mesh->nodes);
    else
        put(file, FACT("Mesh", "%d × %d elements of %d type%s, %d nodes"), scene->line[0].elements,
            scene->line[1].elements, mesh->types, mesh->types == 1 ? "" : "s", mesh->nodes);
    put(file, FACT("Free dof", "%d, half bandwidth %d"), mesh->free_dof, mesh_half_bandwidth(mesh));
    put(file, FACT("Element", "%s kinematics, %s metric, %d dof per node"),
        kinematics[scene->element.cartesian], metric[scene->element.metric],
        (int)mesh->dof_per_node);
    put(file, FACT("Thickness", "%q"), mesh->laminate.thickness, scene->unit_length);
    put(file, FACT("Condition number, scaled", "%r"), checked(analysis->model.info.condition));
    put(file, FACT("Solver residual", "%r"), checked(residual));
    if (analysis->nonlinear)
        write_path(file, &analysis->equilibrium.solver);
    else
        put(file,
            FACT("Solver error estimate, energy norm; without the discretisation error", "%r"),
            checked(analysis->model.info.error_estimate));
}

static void write_facts(FILE *file, const analysis *analysis, double residual)
{
    const scene *scene = analysis->design.scene;
    char hash[20];
    fputs("<dl>\n", file);
    if (analysis->source->has_structure)
        write_structure_facts(file, analysis, residual);
    else
        put(file, FACT("Measured matrix", "%d outputs, %d actuators"), scene->influence.outputs,
            scene->amplifiers);
    if (scene->target.given)
        put(file, FACT("Target", "<code>%t</code>"), expr_text(scene->target.value));
    snprintf(hash, sizeof hash, "%08lx", (unsigned long)scene->hash);
    put(file, FACT("Scene", "%s") "</dl>\n", hash);
}

/*
 * Write the list of the warnings on implausible numbers, and of the warning of the last load step.
 */
static void write_warnings(FILE *file, const analysis *analysis)
{
    const plausible *warnings = &analysis->warnings;
    const bool is_behind = analysis->nonlinear && analysis->status == PZS_W_BEHIND;
    char text[SCENE_ERROR];
    if (warnings->count == 0 && !is_behind)
        return;
    fputs("<h2>Warnings</h2>\n<ul>\n", file);
    for (int k = 0; k < warnings->count; k++)
        put(file, "<li><b class=\"warn\">%t</b>: %t</li>\n", warnings->warning[k].rule,
            warnings->warning[k].text);
    if (warnings->dropped > 0)
        put(file, "<li>and %d more</li>\n", warnings->dropped);
    if (is_behind) {
        equilibrium_penetration_text(&analysis->equilibrium, analysis->status, text);
        put(file, "<li><b class=\"warn\">%t</b>: %t</li>\n", pzs_status_text(analysis->status),
            text);
    }
    fputs("</ul>\n", file);
}

void page_begin(const report_job *job, const analysis *analysis, const char *kind, double residual)
{
    const scene *scene = analysis->design.scene;
    FILE *file = job->file;
    put(file,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
        "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>%t</title>\n",
        scene->name);
    draw_page_style(file);
    put(file,
        "</head>\n<body>\n<main>\n<header>\n<p class=\"kicker\">%s</p>\n<h1>%t</h1>\n<p>"
        "%t</p>\n",
        kind, scene->name, scene->about ? scene->about : "");
    if (words_unitless(scene))
        put(file, "<p class=\"soft\">The scene names no units: its numbers are in any consistent "
                  "ones, angles in rad.</p>\n");
    write_facts(file, analysis, residual);
    write_warnings(file, analysis);
    fputs("</header>\n", file);
}

void page_end(const report_job *job)
{
    put(job->file, "<footer>" PROGRAM ": <code>");
    write_command(job);
    fputs("</code></footer>\n</main>\n</body>\n</html>\n", job->file);
}

enum { PICTURE_EDGE = 20, PICTURE_HEAD = 52, PICTURE_FOOT = 26 };

void picture_begin(const report_job *job, const scene *scene, const char *title, double width,
                   double height)
{
    const double all[2] = {width + 2 * PICTURE_EDGE, height + PICTURE_HEAD + PICTURE_FOOT};
    put(job->file,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg "
        "xmlns=\"http://www.w3.org/2000/svg\" width=\"%f\" height=\"%f\" viewBox=\"0 0 %f %f\" "
        "role=\"img\">\n",
        all[0], all[1], all[0], all[1]);
    put(job->file, "<title>%t: %t</title><desc>%t ", scene->name, title,
        scene->about ? scene->about : "");
    if (scene->target.given)
        put(job->file, "Target: %t. ", expr_text(scene->target.value));
    fputs("Command: ", job->file);
    write_command(job);
    fputs("</desc>\n", job->file);
    draw_picture_style(job->file);
    put(job->file, "<rect class=\"back\" x=\".5\" y=\".5\" width=\"%f\" height=\"%f\" rx=\"8\"/>\n",
        all[0] - 1, all[1] - 1);
    put(job->file,
        "<text class=\"title\" x=\"%d\" y=\"26\">%t</text><text x=\"%d\" y=\"43\">"
        "%t</text>\n",
        PICTURE_EDGE, scene->name, PICTURE_EDGE, title);
    put(job->file, "<g transform=\"translate(%d %d)\">\n", PICTURE_EDGE, PICTURE_HEAD);
}

void picture_end(const report_job *job, double width, double height)
{
    put(job->file, "</g>\n<text class=\"end\" x=\"%f\" y=\"%f\">" PROGRAM "</text>\n</svg>\n",
        PICTURE_EDGE + width, height + PICTURE_HEAD + PICTURE_FOOT - 9);
}

/* ---- shapes ----------------------------------------------------------- */

int page_shape_open(page_shape *shape, const mesh *mesh)
{
    const size_t nodes = (size_t)mesh->nodes;
    shape->vector = calloc(3 * nodes, sizeof *shape->vector);
    shape->wanted = calloc(3 * nodes, sizeof *shape->wanted);
    shape->misfit = calloc(nodes, sizeof *shape->misfit);
    return shape->vector && shape->wanted && shape->misfit ? 0 : -1;
}

void page_shape_close(page_shape *shape)
{
    free(shape->vector);
    free(shape->wanted);
    free(shape->misfit);
}

void page_shape_fill(page_shape *shape, const design *design, const double *u,
                     const double *reached, const double *target)
{
    report_displacement(&design->mesh, u, shape->vector);
    shape->worst = 0;
    for (int i = 0; i < 3 * design->mesh.nodes; i++)
        shape->misfit[i / 3] = shape->wanted[i] = (double)NAN;
    for (int t = 0; t < design->targets; t++) {
        const int n = design->target_node[t];
        const double misfit = reached[t] - target[t];
        double along[3];
        draw_component(&design->mesh.point[n], design->scene->target.what.component, along);
        for (int i = 0; i < 3; i++)
            shape->wanted[3 * n + i] = shape->vector[3 * n + i] - misfit * along[i];
        shape->misfit[n] = misfit;
        shape->worst = fmax(shape->worst, fabs(misfit));
    }
}

int page_shape_draw(FILE *file, const page_shape *shape, const draw_view *view,
                    const design *design, double factor, const draw_scale *scale)
{
    if (design->mesh.elements == 0)
        return shell_map(file, &design->mesh, shape->misfit, scale, "Misfit at the outputs");
    const shell rest = {.file = file, .view = view, .m = &design->mesh};
    shell reached = rest, target = rest;
    reached.vector = shape->vector;
    target.vector = shape->wanted;
    reached.factor = target.factor = factor;
    draw_begin(file, DRAW_IMAGE, view->width, view->height, "Reached shape in space",
               "The shape is coloured by its misfit, with the target as lines over it");
    shell_edges(&rest, "outline");
    const int failed = shell_surface(&reached, shape->misfit, scale);
    shell_lines(&target, "wire");
    if (design->scene->target.what.where.type == WHERE_POINT)
        shell_dot(&target, design->target_node[0]);
    shell_directions(&reached);
    draw_end(file, DRAW_IMAGE);
    return failed;
}

void page_keys(FILE *file, const mesh *mesh, const char *more)
{
    if (mesh->elements == 0)
        put(file, "<p class=\"keys\">%s</p>\n", more);
    else
        put(file,
            "<p class=\"keys\"><span><i class=\"key\"></i>target</span><span><i class=\"key "
            "dash\"></i>undeformed edges</span><span><i class=\"key "
            "hold\"></i>support</span>%s</p>\n",
            more);
}

double page_largest(const mesh *mesh, const double *vector)
{
    double most = 0;
    for (int n = 0; n < mesh->nodes; n++)
        most = fmax(most, draw_dot3(vector + 3 * n, vector + 3 * n));
    return sqrt(most);
}

void page_magnified(FILE *file, const mesh *mesh, double factor)
{
    if (mesh->elements == 0) {
        fputs("at the places of the outputs", file);
        return;
    }
    put(file, factor == 1 ? "displacement to scale" : "displacement <b>× %n</b>", factor);
    fputs(shell_is_thinned(mesh) ? ", not every mesh line drawn" : "", file);
}
