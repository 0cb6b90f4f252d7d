/* SPDX-License-Identifier: BSD-2-Clause */
/* Report page of `pzs solve` (report.h). */
#include <math.h>
#include <stdlib.h>
#include "report_page.h"
#include "../text/words.h"

/* ---- outputs ---------------------------------------------------------- */

typedef struct spread {
    double low, high, mean, most;
    int count;
} spread;

/*
 * Range and mean of the values of a named output. An output at a point has one value, an output on
 * an edge or at all nodes has several.
 */
static spread spread_of(const analysis *analysis, const double *output, int k)
{
    const double reference = analysis->design.scene->output[k].reference;
    spread s = {HUGE_VAL, -HUGE_VAL, 0, 0, analysis_outputs(analysis, k)};
    for (int i = 0; i < s.count; i++) {
        const double value = analysis_output(analysis, k, i, output);
        s.low = fmin(s.low, value);
        s.high = fmax(s.high, value);
        s.mean += value / s.count;
    }
    s.most = fmax(fmax(fabs(s.low), fabs(s.high)), isfinite(reference) ? fabs(reference) : 0);
    return s;
}

static void write_output(FILE *file, const analysis *analysis, const double *output, int k)
{
    const scene_output *named = &analysis->design.scene->output[k];
    const spread s = spread_of(analysis, output, k);
    char unit[WORDS_UNIT];
    words_unit(analysis->design.scene, words_of_output(named), unit);
    put(file, "<tr><th scope=\"row\">%t</th><td>", named->name);
    if (s.count == 1)
        put(file, "%a", s.mean, s.most, unit);
    else
        put(file, "%a to %a<br><span class=\"soft\">%d values, mean %a</span>", s.low, s.most, unit,
            s.high, s.most, unit, s.count, s.mean, s.most, unit);
    put(file, "</td><td>%a</td><td>%n</td></tr>\n", named->reference, s.most, unit,
        analysis_output(analysis, k, 0, output) / named->reference);
}

/* Write one row of a table: the i-th value of an output with its node or its electrode. */
static void write_place(FILE *file, const analysis *analysis, int k, int i, double value,
                        double most, const char *unit)
{
    const mesh *mesh = &analysis->design.mesh;
    const int node = analysis_output_node(analysis, k, i);
    char name[SCENE_LABEL];
    if (node >= 0) {
        const double *theta = mesh->theta[node], *x = mesh->point[node].x;
        if (mesh->quads) {
            put_row(file, "%d|%n|%n|%n|%a", i + 1, x[0], x[1], x[2], value, most, unit);
            return;
        }
        put_row(file, "%d|%n|%n|%n|%n|%n|%a", i + 1, theta[0], theta[1], x[0], x[1], x[2], value,
                most, unit);
    } else {
        analysis_output_electrode(analysis, k, i, name);
        put_row(file, "%t|%a", name, value, most, unit);
    }
}

/* Write the table of all values of an output with several nodes or electrodes. */
static void write_places(FILE *file, const analysis *analysis, const double *output, int k)
{
    static const char *const heads[] = {"Electrode|Value", "Node|θ₁|θ₂|x|y|z|Value",
                                        "Node|x|y|z|Value"};
    enum { MOST_VALUES = 400 };
    const spread s = spread_of(analysis, output, k);
    const bool has_nodes = analysis_output_node(analysis, k, 0) >= 0;
    char unit[WORDS_UNIT];
    words_unit(analysis->design.scene, words_of_output(&analysis->design.scene->output[k]), unit);
    put(file, "<details><summary>%t: %d values</summary>\n", analysis->design.scene->output[k].name,
        s.count);
    put_table(file, s.count > MOST_VALUES ? "The first 400; --json gives all" : "",
              heads[has_nodes + (has_nodes && analysis->design.mesh.quads)]);
    for (int i = 0; i < s.count && i < MOST_VALUES; i++)
        write_place(file, analysis, k, i, analysis_output(analysis, k, i, output), s.most, unit);
    put_table_end(file);
    fputs("</details>\n", file);
}

static void write_outputs(FILE *file, const analysis *analysis, const double *output)
{
    const int outputs = analysis->design.scene->outputs;
    if (outputs == 0)
        return;
    put_table(file,
              "Outputs; the ratio is value over reference, of the first value where there "
              "are more",
              "Output|Value|Reference|Ratio");
    for (int k = 0; k < outputs; k++)
        write_output(file, analysis, output, k);
    put_table_end(file);
    for (int k = 0; k < outputs; k++)
        if (analysis_outputs(analysis, k) > 1)
            write_places(file, analysis, output, k);
}

/* ---- outputs along mesh lines ----------------------------------------- */

static const double *theta_of(const analysis *analysis, int k, int i)
{
    return analysis->design.mesh.theta[analysis_output_node(analysis, k, i)];
}

/*
 * The coordinate, 0 (theta1) or 1 (theta2), along which the nodes of a displacement output lie, or
 * -1 if they do not lie on one mesh line.
 */
static int line_of(const analysis *analysis, int k)
{
    const scene_output *output = &analysis->design.scene->output[k];
    bool differs[2] = {false, false};
    if (analysis->design.mesh.quads || output->electric != ELECTRIC_NONE ||
        output->contact != CONTACT_NONE)
        return -1;
    for (int i = 2; i < 2 * analysis_outputs(analysis, k); i++)
        differs[i % 2] |= theta_of(analysis, k, i / 2)[i % 2] != theta_of(analysis, k, 0)[i % 2];
    return differs[0] == differs[1] ? -1 : differs[1];
}

/* Diagram of all outputs that lie along the same coordinate. */
typedef struct line_chart {
    FILE *file;
    const analysis *a;
    const double *output;
    int along;
    draw_axis x, y;
    char name[WORDS_UNIT]; /* name of the unit of x */
} line_chart;

/* Fit the axes to all values of the diagram. Returns false if there are none. */
static bool fit_chart(line_chart *c)
{
    const scene *scene = c->a->design.scene;
    const scene_line *line = &scene->line[c->along];
    bool is_given = false;
    c->x = (draw_axis){line->point[0], line->point[line->elements], 84, 604, false, "%n", {1, ""}};
    c->y = (draw_axis){0, 0, 240, 6, false, "%n", {1, ""}};
    for (int k = 0; k < scene->outputs; k++) {
        if (line_of(c->a, k) != c->along)
            continue;
        const spread values = spread_of(c->a, c->output, k);
        c->y.low = fmin(c->y.low, values.low);
        c->y.high = fmax(c->y.high, values.high);
        is_given = true;
    }
    words_unit(scene, words_of_theta(scene, c->along), c->name);
    c->x.unit = put_unit_of(fmax(fabs(c->x.low), fabs(c->x.high)), c->name);
    c->y.unit = put_unit_of(fmax(-c->y.low, c->y.high), scene->unit_length);
    c->y.high += c->y.high > c->y.low ? 0 : 1;
    return is_given;
}

/*
 * Lowest free height at or below y for a name of one line, so that names do not overlap.
 *   taken [names]  in  heights of the names already written
 */
static double free_place(double y, const double *taken, int names)
{
    const double height = 13;
    for (int again = 0; again < names; again++)
        for (int i = 0; i < names; i++)
            if (fabs(taken[i] - y) < height)
                y = taken[i] + height;
    return y;
}

static void draw_curves(const line_chart *c)
{
    enum { NAMES = 64 };
    double taken[NAMES];
    int names = 0;
    for (int k = 0; k < c->a->design.scene->outputs; k++) {
        bool is_drawing = false;
        double at[2] = {0, 0};
        if (line_of(c->a, k) != c->along)
            continue;
        draw_path(c->file, "wire");
        for (int i = 0; i < analysis_outputs(c->a, k); i++) {
            at[0] = draw_on(&c->x, theta_of(c->a, k, i)[c->along]);
            at[1] = draw_on(&c->y, analysis_output(c->a, k, i, c->output));
            draw_step(c->file, &is_drawing, at);
        }
        const double place = free_place(at[1], taken, names < NAMES ? names : NAMES);
        taken[names++ % NAMES] = place;
        put(c->file, "\"/><text class=\"tag\" x=\"%f\" y=\"%f\">%t</text>\n", c->x.to + 6,
            place + 4, c->a->design.scene->output[k].name);
    }
}

static void draw_lines(FILE *file, const analysis *analysis, const double *output, int along)
{
    const scene *scene = analysis->design.scene;
    line_chart c = {.file = file, .a = analysis, .output = output, .along = along};
    if (analysis->design.mesh.quads || !fit_chart(&c))
        return;
    put(file, "<section>\n<h2>Along lines of %s</h2>\n<figure style=\"max-width:760px\">\n",
        SHELL_THETA(along));
    draw_begin(file, DRAW_CHART, 720, 274, "Outputs along lines of the mesh",
               "A curve for each output");
    draw_grid(file, &c.x, &c.y, true);
    draw_grid(file, &c.x, &c.y, false);
    put(file, "<text class=\"value\" x=\"344\" y=\"269\">%s%u</text>\n", SHELL_THETA(along),
        c.x.unit.name);
    draw_curves(&c);
    draw_end(file, DRAW_CHART);
    put(file, "<figcaption>Displacement%s%t.</figcaption></figure>\n</section>\n",
        *scene->unit_length ? " in " : "", c.y.unit.name);
}

/* ---- drawings --------------------------------------------------------- */

typedef struct solve_page {
    FILE *file;
    const analysis *a;
    const mesh *m;
    double *vector, *size; /* [nodes][3] displacement; [nodes] its absolute value, also used for
                              other maps */
    double factor;
    draw_view view;
    draw_scale scale;
    shell_body body;
} solve_page;

/*
 * Choose the colour scale, the magnification and the view of the deformed shape. Large
 * displacements, of nonlinear results, are not magnified.
 */
static void fit_deformed(solve_page *p)
{
    p->scale = (draw_scale){false, page_largest(p->m, p->vector), p->m->scene->unit_length};
    for (int n = 0; n < p->m->nodes; n++)
        p->size[n] = sqrt(draw_dot3(p->vector + 3 * n, p->vector + 3 * n));
    p->factor = p->a->nonlinear ? 1 : draw_magnification(p->m, p->scale.most, 0.1);
    draw_view_begin(&p->view, p->m);
    draw_view_mesh(&p->view, p->m, p->vector, p->factor);
    shell_body_find(&p->body, p->a, p->vector, &p->view);
    draw_view_fit(&p->view, 600, 560);
}

static int draw_deformed(const solve_page *p)
{
    const shell rest = {.file = p->file, .m = p->m, .view = &p->view};
    shell moved = rest;
    moved.vector = p->vector;
    moved.factor = p->factor;
    shell_body_draw(p->file, &p->body, &p->view, false);
    shell_lines(&rest, "rest");
    const int failed = shell_surface(&moved, p->size, &p->scale);
    shell_lines(&rest, "rest ghost");
    shell_body_draw(p->file, &p->body, &p->view, true);
    shell_loads(&moved);
    shell_outputs(&moved);
    shell_directions(&moved);
    return failed;
}

/* Write the legend of the lines and marks in the drawing. */
static void write_deformed_keys(const solve_page *p)
{
    const scene *scene = p->m->scene;
    bool has_point_load = false;
    for (int k = 0; k < scene->loads; k++)
        has_point_load |= scene->load[k].type == LOAD_POINT;
    put(p->file, "<p class=\"keys\"><span><i class=\"key gone\"></i>undeformed</span><span>"
                 "<i class=\"key hold\"></i>support</span>");
    if (has_point_load)
        put(p->file, "<span><i class=\"key load\"></i>point load</span>");
    if (p->body.is_given)
        put(p->file,
            "<span><i class=\"key solid\"></i>rigid body, the part along the shell</span>");
    fputs("</p>", p->file);
}

static int write_deformed(const solve_page *p)
{
    fputs("<figure>\n", p->file);
    draw_begin(p->file, DRAW_IMAGE, p->view.width, p->view.height, "Deformed shape in space",
               "The shape is coloured by the size of the displacement, over the undeformed mesh");
    const int failed = draw_deformed(p);
    draw_end(p->file, DRAW_IMAGE);
    fputs("<figcaption>Size of the displacement, ", p->file);
    page_magnified(p->file, p->m, p->factor);
    put(p->file, "; largest %q", p->scale.most, p->scale.unit);
    draw_legend(p->file, &p->scale);
    write_deformed_keys(p);
    fputs("</figcaption></figure>\n", p->file);
    return failed;
}

/* Draw the map of the displacement component along e1, e2 or e3 (a = 0, 1, 2). */
static int draw_component_map(const solve_page *p, int a)
{
    static const char *const lines_label[3] = {"u₁ along θ₁", "u₂ along θ₂", "u₃ outwards"},
                             *const quad_label[3] = {"u₁ along e₁ of the nodes",
                                                     "u₂ along e₂ of the nodes", "u₃ outwards"};
    const char *const name = p->m->quads ? quad_label[a] : lines_label[a];
    draw_scale scale = {true, 0, p->scale.unit};
    for (int n = 0; n < p->m->nodes; n++) {
        p->size[n] = draw_dot3(p->m->point[n].e[a], p->vector + 3 * n);
        scale.most = fmax(scale.most, fabs(p->size[n]));
    }
    const bool is_negligible = scale.most > 0 && scale.most < 1e-9 * p->scale.most;
    scale.most = is_negligible ? 0 : scale.most;
    put(p->file, "<figure><h3>%s</h3>\n", name);
    const int failed = shell_map(p->file, p->m, p->size, &scale, name);
    if (is_negligible)
        fputs("<p class=\"keys\">Below 10⁻⁹ of the largest displacement.</p>", p->file);
    else
        draw_legend(p->file, &scale);
    fputs("</figure>\n", p->file);
    return failed;
}

static int write_components(const solve_page *p)
{
    int failed = 0;
    fputs("<section>\n<h2>Displacement of the middle surface</h2>\n<p class=\"soft\">Each on a "
          "scale of its own.</p>\n<div class=\"row three\">\n",
          p->file);
    for (int a = 0; a < 3; a++)
        failed |= draw_component_map(p, a);
    fputs("</div>\n</section>\n", p->file);
    return failed;
}

/* Write the map of the contact pressure, if the scene contains a contact. */
static int write_contact_map(const solve_page *p)
{
    const pzs_contact *contact = &p->a->equilibrium.contact;
    char unit[WORDS_UNIT];
    draw_scale scale = {false, 0, words_unit(p->m->scene, QUANTITY_PRESSURE, unit)};
    if (!p->a->nonlinear || !p->m->scene->contact.given)
        return 0;
    for (int n = 0; n < p->m->nodes; n++)
        scale.most = fmax(scale.most, contact->info.pressure[n]);
    fputs("<section>\n<h2>Contact pressure</h2>\n<figure class=\"map\">\n", p->file);
    const int failed = shell_map(p->file, p->m, contact->info.pressure, &scale, "Contact pressure");
    put(p->file,
        "<figcaption>%d nodes in contact, largest pressure %q, per undeformed area; "
        "the body is at most %q deep between nodes, which is the sag of the elements",
        (int)contact->info.nodes, scale.most, unit, contact->info.sag, p->m->scene->unit_length);
    draw_legend(p->file, &scale);
    fputs("</figcaption></figure>\n</section>\n", p->file);
    return failed;
}

/* ---- page ------------------------------------------------------------- */

static page_set applied_set(const void *context, int set)
{
    (void)set;
    return (page_set){"Voltage", context};
}

static int write_page(const report_job *job, const solve_page *p, const double *output)
{
    const analysis *analysis = p->a;
    page_begin(job, analysis, "Displacement under loads and applied voltages",
               analysis->nonlinear ? analysis->equilibrium.solver.info.residual
                                   : analysis->model.info.residual);
    fputs("<section>\n<h2>Result</h2>\n<div class=\"row two\">\n", p->file);
    int failed = write_deformed(p);
    fputs("<div>\n", p->file);
    write_outputs(p->file, analysis, output);
    page_conditions(p->file, &analysis->design);
    page_voltages(p->file, &analysis->design, 1, applied_set, analysis->input_value);
    fputs("</div>\n</div>\n</section>\n", p->file);
    for (int along = 0; along < 2; along++)
        draw_lines(p->file, analysis, output, along);
    failed |= write_contact_map(p);
    failed |= write_components(p);
    fputs("<section>\n<h2>Structure</h2>\n", p->file);
    page_layers(p->file, p->m->scene);
    fputs("</section>\n", p->file);
    page_end(job);
    return failed;
}

static int write_picture(const report_job *job, const solve_page *p)
{
    const double height = p->view.height + 44;
    picture_begin(job, p->m->scene, "size of the displacement", p->view.width, height);
    const int failed = draw_deformed(p);
    draw_legend_at(p->file, &p->scale, 0, p->view.height + 12);
    put(p->file, "<text class=\"end\" x=\"%f\" y=\"%f\">", p->view.width, p->view.height + 38);
    put(p->file, p->factor == 1 ? "displacement to scale</text>\n" : "displacement × %n</text>\n",
        p->factor);
    picture_end(job, p->view.width, height);
    return failed;
}

int report_solve(const report_job *job, const analysis *analysis, const double *u,
                 const double *output)
{
    const size_t nodes = (size_t)analysis->design.mesh.nodes;
    solve_page p = {.file = job->file, .a = analysis, .m = &analysis->design.mesh};
    int failed = -1;
    p.vector = calloc(3 * nodes, sizeof *p.vector);
    p.size = calloc(nodes, sizeof *p.size);
    if (p.vector && p.size) {
        report_displacement(p.m, u, p.vector);
        fit_deformed(&p);
        failed = job->is_svg ? write_picture(job, &p) : write_page(job, &p, output);
    }
    free(p.vector);
    free(p.size);
    return failed || ferror(job->file) ? -1 : 0;
}
