/* SPDX-License-Identifier: BSD-2-Clause */
/* Report page of `pzs shape` (report.h). */
#include <math.h>
#include <stdlib.h>
#include "report_page.h"

/* One result: a set of voltages, the shape that it reaches, and numbers for its drawings. */
typedef struct result {
    const voltages *v;
    page_shape shape;
    shell_mark *mark; /* [amplifiers] whether the voltage is at or beyond a limit */
    double voltage;   /* largest absolute voltage */
    int beyond;       /* number of amplifiers with a voltage beyond the limits of the scene */
} result;

typedef struct shape_page {
    FILE *file;
    analysis *a;
    const design *d;
    result *result;
    int results, plans;
    int *plan; /* [actuators] index of the plan on which the actuator is drawn, or -1 */
    draw_view view;
    double factor;              /* magnification of displacements in every drawing */
    draw_scale misfit, voltage; /* colour scales, the same for all results */
    double residual;            /* largest relative residual of the solves of the drawn shapes */
} shape_page;

/* ---- results ---------------------------------------------------------- */

static bool is_limited(const voltages *result)
{
    return isfinite(result->limit[0]) || isfinite(result->limit[1]);
}

static bool is_at(double voltage, double limit)
{
    return fabs(voltage - limit) <= 1e-9 * fabs(limit);
}

static bool is_beyond(const design *design, const voltages *result, int k)
{
    return result->voltage[k] < design->lower[k] || result->voltage[k] > design->upper[k];
}

/*
 * Mark the amplifiers that are at an active limit of this result, unless they are held, and those
 * with a voltage beyond the limits of the scene. Returns 0, or -1: out of memory.
 */
static int fill_marks(const design *design, result *result)
{
    const size_t amplifiers = (size_t)design->amplifiers;
    const common_limits common = {LIMITS_GIVEN, result->v->limit[0], result->v->limit[1]};
    double *lower = calloc(2 * amplifiers + 1, sizeof *lower);
    double *upper = lower ? lower + amplifiers : NULL;
    char error[SCENE_ERROR];
    result->mark = calloc(amplifiers + 1, sizeof *result->mark);
    if (!lower || !result->mark) {
        free(lower);
        return -1;
    }
    const bool has_limits = is_limited(result->v) && result->v->active_limits > 0 &&
                            design_limits(design, common, lower, upper, error) == 0;
    for (int k = 0; k < design->amplifiers; k++) {
        const double voltage = result->v->voltage[k];
        const bool is_active = is_at(voltage, lower[k]) || is_at(voltage, upper[k]) ||
                               is_at(voltage, design->lower[k]) || is_at(voltage, design->upper[k]);
        if (has_limits && is_active && !design_is_held(design, k))
            result->mark[k] = SHELL_AT_LIMIT;
        else if (is_beyond(design, result->v, k))
            result->mark[k] = SHELL_BEYOND;
    }
    free(lower);
    return 0;
}

static int fill_result(const design *design, const voltages *v, result *r)
{
    r->v = v;
    if (fill_marks(design, r) < 0 || page_shape_open(&r->shape, &design->mesh) < 0)
        return -1;
    page_shape_fill(&r->shape, design, v->u, v->shape, v->aligned_target);
    for (int k = 0; k < design->amplifiers; k++) {
        r->beyond += is_beyond(design, v, k);
        r->voltage = fmax(r->voltage, fabs(v->voltage[k]));
    }
    return 0;
}

/* Choose the colour scales, the magnification and the view that all results share. */
static void fit_page(shape_page *p)
{
    double most = 0;
    p->misfit = (draw_scale){true, 0, p->d->scene->unit_length};
    p->voltage = (draw_scale){true, 0, p->d->scene->unit_voltage};
    for (int t = 0; t < p->d->targets; t++)
        most = fmax(most, fabs(p->d->target[t]));
    for (int k = 0; k < p->results; k++) {
        p->misfit.most = fmax(p->misfit.most, p->result[k].shape.worst);
        p->voltage.most = fmax(p->voltage.most, p->result[k].voltage);
        most = fmax(most, page_largest(&p->d->mesh, p->result[k].shape.vector));
        p->residual = fmax(p->residual, p->result[k].v->residual);
    }
    p->factor = p->a->nonlinear ? 1 : draw_magnification(&p->d->mesh, most, 0.2);
    draw_view_begin(&p->view, &p->d->mesh);
    for (int k = 0; k < p->results; k++) {
        draw_view_mesh(&p->view, &p->d->mesh, p->result[k].shape.vector, p->factor);
        draw_view_mesh(&p->view, &p->d->mesh, p->result[k].shape.wanted, p->factor);
    }
    draw_view_fit(&p->view, 420, 420);
}

/* ---- words ------------------------------------------------------------ */

static void write_limits(const shape_page *p, const voltages *result)
{
    if (!is_limited(result))
        fputs("–", p->file);
    else if (result->limit[0] == -result->limit[1])
        put(p->file, "±\xc2\xa0%q", result->limit[1], p->voltage.unit);
    else
        put(p->file, "%n to %q", result->limit[0], result->limit[1], p->voltage.unit);
}

static void write_name(const shape_page *p, const voltages *result)
{
    put(p->file, "%t", result->name);
    if (!is_limited(result))
        return;
    fputs(", ", p->file);
    write_limits(p, result);
}

/*
 * The result shown first: the first one computed within limits, or simply the first one if none has
 * limits.
 */
static const result *main_result(const shape_page *p)
{
    for (int k = 0; k < p->results; k++)
        if (is_limited(p->result[k].v))
            return &p->result[k];
    return p->result;
}

/* Write the error of the main result, and the error that would remain without voltage limits. */
static void write_verdict(const shape_page *p)
{
    const voltages *best = main_result(p)->v, *open = NULL;
    for (int k = 0; k < p->results; k++) {
        const voltages *result = p->result[k].v;
        if (!is_limited(result) && (!open || result->error < open->error))
            open = result;
    }
    put(p->file, "<p class=\"verdict\"><b>Relative RMS error %p</b>: ", best->error);
    write_name(p, best);
    put(p->file, ", limit active at %d of %d amplifiers.", best->active_limits, p->d->amplifiers);
    if (is_limited(best) && open)
        put(p->file, " Unconstrained, %p would remain.", open->error);
    fputs("</p>\n", p->file);
}

static void write_row(const shape_page *p, const result *result, double worst_error)
{
    const char *unit = p->voltage.unit;
    put(p->file, "<tr><th scope=\"row\">%t</th><td>", result->v->name);
    write_limits(p, result->v);
    put(p->file,
        "</td><td>%p<span class=\"bar\" aria-hidden=\"true\"><i style=\"width:%f%%\"></i>"
        "</span></td>",
        result->v->error, fmin(100 * result->v->error / worst_error, 100));
    put(p->file, is_limited(result->v) ? "<td>%d of %d</td>" : "<td>–</td>",
        result->v->active_limits, p->d->amplifiers);
    put(p->file, result->beyond ? "<td>%a</td><td><b>%d</b></td>" : "<td>%a</td><td>%d</td>",
        result->voltage, p->voltage.most, unit, result->beyond);
    put(p->file, "<td>%r</td></tr>\n", result->v->optimality);
}

static void write_table(const shape_page *p)
{
    double worst = 0;
    for (int k = 0; k < p->results; k++)
        worst = fmax(worst, p->result[k].v->error);
    put_table(
        p->file,
        "Relative RMS error: root of the weighted squares of the misfit over those "
        "of what is wanted (target less the shape without voltages). Clipped least squares: "
        "voltages without limits, cut to the limits. Regularised, then clipped: the same with the "
        "one parameter that leaves the smallest error, chosen knowing the answer. KKT violation: "
        "largest violated optimality condition, relative.",
        "Voltages|Limits|Relative RMS error|Limit active|Largest voltage|Beyond the<br>scene’s "
        "limits|KKT violation");
    for (int k = 0; k < p->results; k++)
        write_row(p, &p->result[k], worst);
    put_table_end(p->file);
}

/*
 * Write notes on amplifiers with narrower limits than the table says, on target rows that cannot
 * move and therefore do not count in the error, and on free functions.
 */
static void write_notes(const shape_page *p)
{
    const design *design = p->d;
    const voltages *result = main_result(p)->v;
    if (result->narrowed + result->held > 0)
        put(p->file,
            "<p>Of %d amplifiers, with narrower limits than the table says (own limits, "
            "field_limit): %d; held: %d.</p>\n",
            design->amplifiers, result->narrowed, result->held);
    if (result->fixed_off > 0)
        put(p->file,
            "<p>%d of %d target rows lie on constrained dof and cannot move, %d of them "
            "away from the target; the error does not count them, with them it would be %p.</p>\n",
            design->fixed_rows, design->targets, result->fixed_off, result->error_all);
    for (int k = 0; k < design->free_functions; k++)
        put(p->file, "%s%t%s", k ? ", " : "<p>Free functions, taken out of target, RMS and error: ",
            design->scene->target.free[k].name, k + 1 == design->free_functions ? ".</p>\n" : "");
}

/*
 * Weighted root mean square and peak-to-valley value of the field x, or of x - y.
 *   x, y [targets]  in  y may be NULL
 */
typedef struct optics {
    double rms, valley;
} optics;
static optics optics_of(const design *design, const double *x, const double *y)
{
    double low = HUGE_VAL, high = -HUGE_VAL, weight = 0;
    for (int t = 0; t < design->targets; t++) {
        const double value = y ? x[t] - y[t] : x[t];
        low = fmin(low, value);
        high = fmax(high, value);
        weight += design->weight[t] * design->weight[t];
    }
    return (optics){sqrt(design_squares(design, x, y) / weight), high - low};
}

static void write_optics(const shape_page *p)
{
    const optics target = optics_of(p->d, p->d->target, NULL);
    const char *unit = p->misfit.unit;
    put_table(p->file,
              "Shapes in the direction of the target. RMS: about zero, with the weights "
              "of the target, over its rows that can move. PV: peak to valley.",
              "Shape|RMS|PV|Misfit, RMS|Misfit, PV");
    put_row(p->file, "Target|%q|%q||", target.rms, unit, target.valley, unit);
    for (int k = 0; k < p->results; k++) {
        const voltages *result = p->result[k].v;
        const optics shape = optics_of(p->d, result->shape, NULL);
        const optics misfit = optics_of(p->d, result->shape, result->aligned_target);
        put_row(p->file, "%t|%q|%q|%q|%q", result->name, shape.rms, unit, shape.valley, unit,
                misfit.rms, unit, misfit.valley, unit);
    }
    put_table_end(p->file);
}

/* ---- pictures of one result ------------------------------------------- */

static int draw_reached(const shape_page *p, const result *result)
{
    fputs("<figure>\n", p->file);
    const int failed =
        page_shape_draw(p->file, &result->shape, &p->view, p->d, p->factor, &p->misfit);
    fputs("<figcaption>Reached shape and <b>target</b> as lines, ", p->file);
    page_magnified(p->file, &p->d->mesh, p->factor);
    fputs(". Misfit on one scale for all results:", p->file);
    draw_legend(p->file, &p->misfit);
    fputs("</figcaption></figure>\n", p->file);
    return failed;
}

/* Draw target and reached values at the outputs of a measured matrix, on one scale. */
static int draw_levels(const shape_page *p, const result *result)
{
    const double *const value[2] = {result->v->aligned_target, result->v->shape};
    static const char *const name[2] = {"Target", "Reached"};
    draw_scale scale = {true, 0, p->misfit.unit};
    int failed = 0;
    for (int k = 0; k < 2; k++)
        for (int t = 0; t < p->d->targets; t++)
            scale.most = fmax(scale.most, fabs(value[k][t]));
    for (int k = 0; k < 2; k++) {
        fputs("<figure>\n", p->file);
        failed |= shell_map(p->file, &p->d->mesh, value[k], &scale, name[k]);
        put(p->file, "<figcaption>%s; one scale for target and reached:", name[k]);
        draw_legend(p->file, &scale);
        fputs("</figcaption></figure>\n", p->file);
    }
    return failed;
}

static int draw_misfit(const shape_page *p, const result *result)
{
    const draw_scale own = {true, result->shape.worst, p->misfit.unit};
    const optics misfit = optics_of(p->d, result->v->shape, result->v->aligned_target);
    fputs("<figure>\n", p->file);
    const int failed =
        shell_map(p->file, &p->d->mesh, result->shape.misfit, &own, "Misfit, reached minus target");
    put(p->file,
        "<figcaption>Misfit, reached minus target: largest <b>%q</b>, RMS %q, PV %q%s. "
        "Scale of this result:",
        result->shape.worst, own.unit, misfit.rms, own.unit, misfit.valley, own.unit,
        p->d->targets < p->d->mesh.nodes ? "; grey where there is no target" : "");
    draw_legend(p->file, &own);
    fputs("</figcaption></figure>\n", p->file);
    return failed;
}

/* Write the names of the actuators on one plan. */
static void write_plan(const shape_page *p, int which)
{
    const char *comma = "<h3>";
    for (int k = 0; k < p->d->scene->actuators; k++)
        if (p->plan[k] == which) {
            put(p->file, "%s%t", comma, p->d->scene->actuator[k].name);
            comma = ", ";
        }
    fputs("</h3>\n", p->file);
}

static void draw_voltages(const shape_page *p, const result *result)
{
    const scene *scene = p->d->scene;
    fputs("<figure>\n", p->file);
    if (p->plans == 0)
        page_bars(p->file, scene, result->v->voltage, result->mark, &p->voltage);
    for (int which = 0; which < p->plans; which++) {
        if (p->plans > 1)
            write_plan(p, which);
        shell_voltages(p->file, &p->d->mesh, p->plan, which, result->v->voltage, result->mark,
                       &p->voltage);
    }
    put(p->file, "<figcaption>Voltages%s: largest <b>%q</b>",
        p->plans > 0 ? " in their patches" : "", result->voltage, p->voltage.unit);
    for (int k = 0; k < scene->actuators; k++)
        if (scene->actuator[k].is_temperature)
            put(p->file, ", %t %q", scene->actuator[k].name,
                result->v->voltage[scene->actuator[k].first], scene->unit_temperature);
    fputs(". One scale for all results:", p->file);
    draw_legend(p->file, &p->voltage);
    fputs("</figcaption></figure>\n", p->file);
}

static int draw_result(const shape_page *p, const result *result)
{
    fputs("<article class=\"set\">\n<h3>", p->file);
    write_name(p, result->v);
    put(p->file, " — relative RMS error %p</h3>\n<div class=\"row\">\n", result->v->error);
    int failed = p->a->source->has_structure ? draw_reached(p, result) : draw_levels(p, result);
    failed |= draw_misfit(p, result);
    draw_voltages(p, result);
    fputs("</div>\n</article>\n", p->file);
    return failed;
}

/* ---- page ------------------------------------------------------------- */

static page_set result_set(const void *context, int set)
{
    const shape_page *p = context;
    return (page_set){p->result[set].v->name, p->result[set].v->voltage};
}

static int write_page(const report_job *job, const shape_page *p, const modes *modes)
{
    int failed = 0;
    page_begin(job, p->a, "Voltages for a wanted shape", p->residual);
    write_verdict(p);
    fputs("<section>\n<h2>Voltages</h2>\n", p->file);
    write_table(p);
    write_notes(p);
    write_optics(p);
    page_voltages(p->file, p->d, p->results, result_set, p);
    fputs("</section>\n<section>\n<h2>Shapes</h2>\n", p->file);
    page_keys(p->file, &p->d->mesh,
              "<span><i class=\"key stop\"></i>limit active</span><span><i class=\"key "
              "over\"></i>beyond the scene’s limits</span>");
    for (int k = 0; k < p->results; k++)
        failed |= draw_result(p, &p->result[k]);
    fputs("</section>\n", p->file);
    page_modes(p->file, p->d->scene, modes);
    page_source(p->file, p->a, p->a->source->has_structure ? "Structure" : "Matrix");
    page_end(job);
    return failed;
}

/* Write the main picture: the reached shape and the voltages of the main result. */
static int write_picture(const report_job *job, const shape_page *p)
{
    const double width = 760, height = fmax(p->view.height, 330) + 44;
    const result *result = main_result(p);
    const draw_scale own = {true, result->shape.worst, p->misfit.unit};
    char title[160];
    snprintf(title, sizeof title,
             "%.60s: relative RMS error %.3g %%. Colour: misfit, lines: "
             "target",
             result->v->name, 100 * result->v->error);
    picture_begin(job, p->d->scene, title, width, height);
    put(p->file, "<svg width=\"420\" height=\"%f\">", p->view.height);
    const int failed = page_shape_draw(p->file, &result->shape, &p->view, p->d, p->factor, &own);
    put(p->file, "</svg>\n<svg x=\"436\" width=\"320\" height=\"350\">");
    if (p->plans > 0)
        shell_voltages(p->file, &p->d->mesh, p->plan, 0, result->v->voltage, result->mark,
                       &p->voltage);
    else
        page_bars(p->file, p->d->scene, result->v->voltage, result->mark, &p->voltage);
    fputs("</svg>\n", p->file);
    draw_legend_at(p->file, &own, 0, height - 32);
    draw_legend_at(p->file, &p->voltage, 430, height - 32);
    picture_end(job, width, height);
    return failed;
}

static int fill_page(shape_page *p, const voltages *voltages)
{
    p->plan = calloc((size_t)p->d->scene->actuators + 1, sizeof *p->plan);
    p->result = calloc((size_t)p->results + 1, sizeof *p->result);
    if (!p->plan || !p->result)
        return -1;
    p->plans = shell_plans(p->d->scene, p->plan);
    for (int k = 0; k < p->results; k++)
        if (fill_result(p->d, &voltages[k], &p->result[k]) < 0)
            return -1;
    fit_page(p);
    return 0;
}

int report_shape(const report_job *job, analysis *analysis, const voltages *voltages, int count,
                 const modes *modes)
{
    shape_page p = {.file = job->file, .a = analysis, .d = &analysis->design, .results = count};
    int failed = fill_page(&p, voltages);
    if (!failed)
        failed = job->is_svg ? write_picture(job, &p) : write_page(job, &p, modes);
    for (int k = 0; p.result && k < count; k++) {
        page_shape_close(&p.result[k].shape);
        free(p.result[k].mark);
    }
    free(p.result);
    free(p.plan);
    return failed || ferror(job->file) ? -1 : 0;
}
