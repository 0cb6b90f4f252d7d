/* Page of `pzs simulate` (report_simulate.h). */
#include "report_simulate.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "report.h"
#include "report_html.h"
#include "report_parts.h"
#include "../cli/words.h"

/* ---- record ----------------------------------------------------------- */

int record_open(simulate_record *r, const simulation *s)
{
    const design *d = &s->nominal->design;
    memset(r, 0, sizeof *r);
    r->ticks = d->scene->simulate.ticks;
    r->bins = r->ticks < RECORD_BINS ? r->ticks : RECORD_BINS;
    r->amplifiers = d->amplifiers;
    r->lower = d->lower;
    r->upper = d->upper;
    r->volt = calloc((size_t)(RECORD_BINS * d->amplifiers), sizeof *r->volt);
    return r->volt ? 0 : -1;
}

void record_close(simulate_record *r)
{
    free(r->volt);
    memset(r, 0, sizeof *r);
}

void record_tick(simulate_record *r, const simulate_sample *sample)
{
    const int bin = (int)((double)sample->tick * r->bins / r->ticks);
    r->error[sample->law][bin] = fmax(r->error[sample->law][bin], sample->error);
    if (sample->law == LAW_CONTROLLER)
        r->missed[bin] = fmax(r->missed[bin], sample->missed);
    if (sample->law == LAW_CONTROLLER)
        memcpy(r->volt + (size_t)(bin * r->amplifiers), sample->volt,
               (size_t)r->amplifiers * sizeof *r->volt);
}

typedef struct page {
    FILE *file;
    const simulation *s;
    const simulate_record *r;
    const scene *scene;
    double *vector, *wanted, *misfit; /* [nodes][3], [nodes][3], [nodes] of the shape being drawn;
                                         see parts_misfit */
    draw_view view;
    draw_scale scale;
    double factor;
} page;

/* ---- words ------------------------------------------------------------ */

/* Does something not work as it should in a phase: an electrode, a sensor, the controller? */
static int is_faulty(const simulation *s, const simulate_phase *phase)
{
    const scene_simulate *simulate = &s->nominal->design.scene->simulate;
    for (int k = 0; k < s->nominal->design.amplifiers; k++)
        if (!isnan(phase->held[k]))
            return 1;
    for (int k = 0; k < simulate->events; k++) {
        const scene_event *event = &simulate->event[k];
        const int passes =
            event->type == EVENT_NAN || event->type == EVENT_FROZEN || event->type == EVENT_LOST;
        if (passes && event->tick < phase->until && event->tick + event->ticks > phase->from)
            return 1;
    }
    return simulate->fault_chance > 0 && phase->from < simulate->fault_until;
}

/* The phase that ends farthest above its optimum; of those without faults where only_sound. Returns
 * NULL where there is none. */
static const simulate_phase *worst_phase(const simulation *s, int only_sound, double *above)
{
    const simulate_phase *worst = NULL;
    for (int k = 0; k < s->phases; k++) {
        const simulate_phase *phase = &s->phase[k];
        const double here = phase->course[LAW_CONTROLLER].steady / phase->optimum - 1;
        if ((only_sound && is_faulty(s, phase)) || (worst && !(here > *above)))
            continue;
        worst = phase;
        *above = here;
    }
    return worst;
}

static void write_verdict(const page *p)
{
    double above = 0, sound = 0;
    const simulate_phase *worst = worst_phase(p->s, 0, &above);
    fprintf(
        p->file,
        "<p class=\"verdict\"><b>%ld volts beyond a limit or the slew</b> in %d ticks; at the end of every phase the shape error is ",
        p->s->count[LAW_CONTROLLER].beyond, p->scene->simulate.ticks);
    if (above > 0) {
        fputs("at most ", p->file);
        html_percent(p->file, above);
        fprintf(p->file, " above the optimum for that plant in the same limits (phase from tick %d",
                worst->from);
        if (is_faulty(p->s, worst) && worst_phase(p->s, 1, &sound)) {
            fputs(", ", p->file);
            html_percent(p->file, fmax(sound, 0));
            fputs(" in those without faults", p->file);
        }
        fputs(").</p>\n", p->file);
    } else {
        fputs("no more than the optimum for that plant in the same limits.</p>\n", p->file);
    }
}

static void write_phase(const page *p, const simulate_phase *phase)
{
    const simulate_course *c = phase->course;
    char name[WORDS_PHASE];
    words_phase(p->s, phase, name);
    fprintf(p->file, "<tr><th scope=\"row\">%d</th><td class=\"note\">", phase->from);
    html_text(p->file, name);
    fputs("</td><td>", p->file);
    html_percent(p->file, phase->optimum);
    fputs("</td><td>", p->file);
    html_percent(p->file, c[LAW_CONTROLLER].steady);
    fputs("</td><td>", p->file);
    html_percent(p->file, c[LAW_CLAMP].steady);
    fputs("</td><td>", p->file);
    html_percent(p->file, c[LAW_REGULARISED].steady);
    fputs("</td><td>", p->file);
    html_percent(p->file, c[LAW_CONTROLLER].worst);
    fputs("</td><td>", p->file);
    if (c->settled < 0)
        fputs("&ndash;", p->file);
    else
        fprintf(p->file, "%d", c->settled);
    fprintf(p->file, "</td><td>%d</td></tr>\n", c->slew_ticks);
}

static void write_phases(const page *p)
{
    html_table_begin(
        p->file,
        "Shape error: root of the weighted squares of the misfit over those of the scene&rsquo;s target. Steady: over the "
        "last ticks of the phase. Optimum: the best volts for this plant in the same limits. Clipped: least squares without limits, "
        "cut to limits and slew, same plant and sensors. Regularised: the same with the one parameter that is best for the "
        "scene&rsquo;s target on the controller&rsquo;s model, chosen knowing the answer. Settled: ticks until the shape stays within 5 % of its way. Slew: ticks the slew "
        "alone needs.",
        "<th scope=\"col\">Tick</th><th scope=\"col\" class=\"note\">What happens</th><th scope=\"col\">Optimum</th>"
        "<th scope=\"col\">Steady</th><th scope=\"col\">Clipped</th><th scope=\"col\">Regularised, clipped</th><th scope=\"col\">Worst</th><th scope=\"col\">Settled</th>"
        "<th scope=\"col\">Slew</th>");
    for (int k = 0; k < p->s->phases; k++)
        write_phase(p, &p->s->phase[k]);
    html_table_end(p->file);
}

/* What not every controller does. */
static void write_extras(const page *p, const simulate_count *c)
{
    const device_board *board = p->s->board;
    char text[SCENE_ERROR];
    if (p->s->estimates) {
        estimator_text(&p->s->estimator, p->s->nominal, text);
        fprintf(p->file, "<p>The shape is estimated. By the influence %s, ",
                words_influence(p->scene));
        html_text(p->file, text);
        fputs(".</p>\n", p->file);
    }
    if (p->scene->simulate.finds)
        fprintf(
            p->file,
            "<p>Electrodes that the controller found not to follow: %ld, the slowest after %d ticks; %ld of them were in good "
            "order.</p>\n",
            c->found, c->search, c->wrong);
    if (!board)
        return;
    fprintf(p->file, "<p>The controller is the firmware of %s, in %s", board->name,
            board->bits == 32 ? "float" : "double");
    if (board->twin)
        fprintf(p->file,
                ", under QEMU: %ld of %ld ticks with the bits of the same C on this computer",
                c->same, simulate_ran(c));
    fputs(".</p>\n", p->file);
}

static void write_counts(const page *p)
{
    static const char *const name[LAWS] = {"Controller", "Clipped least squares",
                                           "Regularised, then clipped"};
    html_table_begin(
        p->file, "Ticks of all laws",
        "<th scope=\"col\">Law</th><th scope=\"col\">Volts beyond limit or slew</th>"
        "<th scope=\"col\">Not finite</th><th scope=\"col\">Lost</th><th scope=\"col\">Held</th><th scope=\"col\">A sensor doubted</th>"
        "<th scope=\"col\">Out of passes</th><th scope=\"col\">Most passes</th>");
    for (int law = 0; law < LAWS; law++) {
        const simulate_count *c = &p->s->count[law];
        fprintf(
            p->file,
            "<tr><th scope=\"row\">%s</th><td>%ld</td><td>%ld</td><td>%ld</td><td>%ld</td><td>%ld</td><td>%ld</td><td>%d</td></tr>\n",
            name[law], c->beyond, c->not_finite, c->lost, c->status[PZS_W_HELD],
            c->status[PZS_W_SENSOR], c->status[PZS_W_ITERATIONS], c->passes_most);
    }
    html_table_end(p->file);
    write_extras(p, &p->s->count[LAW_CONTROLLER]);
}

/* What vibration would make of the loop, where the densities say it. */
static void write_certificate(const page *p)
{
    const certificate *c = &p->s->nominal->certificate;
    char text[3 * SCENE_ERROR];
    certificate_text(c, text);
    if (!c->made)
        return;
    fputs("<p><b>Quasi-static plant: no inertia.</b> ", p->file);
    if (c->vibrates)
        fprintf(p->file, "First natural frequency %.4g Hz. ", certificate_first(c));
    else
        fputs("Vibration is not known: ", p->file);
    html_text(p->file, c->vibrates ? text : c->why_not);
    fputs("</p>\n", p->file);
}

/* The plant as it is, of what the controller believes. */
static void write_plant(const page *p)
{
    const scene_simulate *simulate = &p->scene->simulate;
    fprintf(p->file, "<p>A %s plant", p->s->plant.analysis.nonlinear ? "nonlinear" : "linear");
    for (int i = 0; i < p->scene->materials; i++) {
        fputs(i ? "; " : ": ", p->file);
        html_text(p->file, p->scene->material[i].name);
        fprintf(p->file, " stiffness &times;&nbsp;%g, d &times;&nbsp;%g",
                simulate->stiffness ? simulate->stiffness[i] : 1, simulate->d ? simulate->d[i] : 1);
    }
    fprintf(p->file, "; hysteresis %g. Sensors: %d, ", simulate->hysteresis,
            p->s->estimates ? p->s->estimator.sensors : p->s->nominal->design.targets);
    if (p->s->estimates) {
        fputs("with the noise of their readings", p->file);
    } else {
        fputs("noise ", p->file);
        html_quantity(p->file, simulate->noise, p->scene->unit_length);
    }
    fprintf(p->file, ", delay %d ticks. Amplifiers: steps of ", simulate->delay);
    html_quantity(p->file, simulate->step, p->scene->unit_voltage);
    fputs(", dead band ", p->file);
    html_quantity(p->file, simulate->dead_band, p->scene->unit_voltage);
    fprintf(p->file,
            ". The controller&rsquo;s influence is that %s. Every shape is an equilibrium.</p>\n",
            simulate->at_target ? "at the nonlinear optimum it believes in" : "at rest");
}

/* ---- over time -------------------------------------------------------- */

static const double left = 64, right = 1150, top = 8;

static double x_of(const page *p, double tick)
{
    return left + (right - left) * tick / p->r->ticks;
}

enum {
    TICK_ROWS = 3,
    TICK_ROW = 13,
    TICK_ROOM = 34,
    END_ROOM = 110,
    FOOT = TICK_ROWS * TICK_ROW + 6
};

/* Ticks of the phases in rows below one another, each in the first row that has room; the end of
 * time in the first. */
static void draw_ticks(const page *p, double bottom)
{
    double taken[TICK_ROWS] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < p->s->phases; k++) {
        const double x = x_of(p, p->s->phase[k].from);
        int row = x > right - END_ROOM;
        while (row < TICK_ROWS && x < taken[row] + TICK_ROOM)
            row++;
        if (row == TICK_ROWS)
            continue;
        taken[row] = x;
        if (row > 0)
            fprintf(p->file, "<path class=\"grid\" d=\"M%.1f %.1fv%d\"/>", x, bottom,
                    3 + row * TICK_ROW);
        fprintf(p->file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%d</text>\n", x,
                bottom + 13 + row * TICK_ROW, p->s->phase[k].from);
    }
    fprintf(p->file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">tick %d, ", right,
            bottom + 13, p->r->ticks);
    html_quantity(p->file, p->r->ticks / p->scene->simulate.rate, "s");
    fputs("</text>\n", p->file);
}

/* Verticals at the phases, their ticks below. */
static void draw_phases(const page *p, double bottom)
{
    fputs("<path class=\"grid\" d=\"", p->file);
    for (int k = 1; k < p->s->phases; k++)
        fprintf(p->file, "M%.1f %.1fV%.1f", x_of(p, p->s->phase[k].from), top, bottom);
    fprintf(p->file,
            "\"/>\n<rect class=\"frame\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
            left, top, right - left, bottom - top);
    draw_ticks(p, bottom);
}

typedef struct log_axis {
    double low, high, bottom;
} log_axis;

static double y_of(const log_axis *axis, double value)
{
    const double share = log(fmax(value, axis->low) / axis->low) / log(axis->high / axis->low);
    return axis->bottom - (axis->bottom - top) * fmin(share, 1);
}

/* Whole steps of 1, 2, 5 around all errors. */
static log_axis axis_of(const page *p, double bottom)
{
    static const double step[3] = {1, 2, 5};
    log_axis axis = {HUGE_VAL, 0, bottom};
    for (int law = 0; law < LAWS; law++)
        for (int i = 0; i < p->r->bins; i++) {
            axis.low = fmin(axis.low, p->r->error[law][i] > 0 ? p->r->error[law][i] : HUGE_VAL);
            axis.high = fmax(axis.high, p->r->error[law][i]);
        }
    for (int i = 0; i < p->r->bins && p->s->estimates; i++)
        axis.low = fmin(axis.low, p->r->missed[i] > 0 ? p->r->missed[i] : HUGE_VAL);
    for (int k = 0; k < p->s->phases; k++)
        axis.low = fmin(axis.low, p->s->phase[k].optimum > 0 ? p->s->phase[k].optimum : axis.low);
    axis.low = fmax(isfinite(axis.low) ? axis.low : 1, 1e-6 * axis.high);
    double below = pow(10, floor(log10(axis.low)));
    for (int i = 1; i < 3; i++)
        below = step[i] * pow(10, floor(log10(axis.low))) <= axis.low
                    ? step[i] * pow(10, floor(log10(axis.low)))
                    : below;
    axis.low = below;
    axis.high = fmax(axis.high, 2 * axis.low);
    return axis;
}

static void draw_levels(const page *p, const log_axis *axis)
{
    static const double step[3] = {1, 2, 5};
    for (double ten = pow(10, floor(log10(axis->low))); ten <= axis->high; ten *= 10)
        for (int i = 0; i < 3; i++) {
            const double y = y_of(axis, step[i] * ten);
            if (step[i] * ten < axis->low * (1 - 1e-9) || step[i] * ten > axis->high)
                continue;
            fprintf(
                p->file,
                "<path class=\"grid\" d=\"M%.1f %.1fH%.1f\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">",
                left, y, right, left - 6, y + 4);
            html_percent(p->file, step[i] * ten);
            fputs("</text>\n", p->file);
        }
}

/* value [bins] in: an error over time */
static void draw_curve(const page *p, const log_axis *axis, const char *style, double width,
                       const double *value)
{
    fprintf(p->file, "<path class=\"%s\" style=\"stroke-width:%.1f\" d=\"", style, width);
    for (int i = 0; i < p->r->bins; i++)
        fprintf(p->file, "%c%.1f %.1f", i ? 'L' : 'M',
                x_of(p, (i + 0.5) * p->r->ticks / p->r->bins), y_of(axis, value[i]));
    fputs("\"/>\n", p->file);
}

static void draw_errors(const page *p)
{
    const log_axis axis = axis_of(p, 250);
    static const char *const style[LAWS] = {"wire", "rest", ""};
    fputs("<figure>\n", p->file);
    draw_begin_chart(
        p->file, 1160, axis.bottom + FOOT,
        "Shape error over time of the controller and of clipped least squares, with the optimum of each phase");
    draw_levels(p, &axis);
    draw_phases(p, axis.bottom);
    for (int law = LAW_CLAMP; law >= 0; law--)
        draw_curve(p, &axis, style[law], 1.6, p->r->error[law]);
    if (p->s->estimates)
        draw_curve(p, &axis, "wire", 0.7, p->r->missed);
    fputs("<path class=\"outline\" d=\"", p->file);
    for (int k = 0; k < p->s->phases; k++)
        fprintf(p->file, "M%.1f %.1fH%.1f", x_of(p, p->s->phase[k].from),
                y_of(&axis, p->s->phase[k].optimum), x_of(p, p->s->phase[k].until));
    fputs("\"/>\n", p->file);
    draw_end_chart(p->file);
    fputs(
        "<figcaption><span class=\"keys\"><span><i class=\"key\"></i>controller</span><span><i class=\"key gone\"></i>clipped</span>"
        "<span><i class=\"key dash\"></i>optimum of the plant</span></span> Shape error, logarithmic",
        p->file);
    if (p->s->estimates)
        fputs("; thin: what the estimate is off by", p->file);
    if (p->r->ticks > p->r->bins)
        fprintf(p->file, "; the largest of every %d ticks",
                (p->r->ticks + p->r->bins - 1) / p->r->bins);
    fputs(".</figcaption></figure>\n", p->file);
}

/* One amplifier: runs of one colour, then a line where it is at a limit. */
static void draw_row(const page *p, int amplifier, const draw_scale *scale, double y, double height)
{
    const simulate_record *r = p->r;
    const double *voltage = r->volt + amplifier;
    for (int i = 0, end; i < r->bins; i = end) {
        const int level = draw_level(scale, voltage[i * r->amplifiers]);
        for (end = i + 1;
             end < r->bins && draw_level(scale, voltage[end * r->amplifiers]) == level;)
            end++;
        const double from = x_of(p, (double)i * r->ticks / r->bins),
                     to = x_of(p, (double)end * r->ticks / r->bins);
        draw_path(p->file, scale, level);
        fprintf(p->file, "M%.1f %.1fH%.1fv%.1fH%.1fz\"/>", from, y, to, height, from);
    }
    fputs("<path class=\"frame\" style=\"stroke:var(--ink)\" d=\"", p->file);
    for (int i = 0, end; i < r->bins; i = end) {
        const int at = voltage[i * r->amplifiers] <= r->lower[amplifier] ||
                       voltage[i * r->amplifiers] >= r->upper[amplifier];
        for (end = i + 1;
             end < r->bins && at == (voltage[end * r->amplifiers] <= r->lower[amplifier] ||
                                     voltage[end * r->amplifiers] >= r->upper[amplifier]);)
            end++;
        if (at)
            fprintf(p->file, "M%.1f %.1fH%.1f", x_of(p, (double)i * r->ticks / r->bins),
                    y + height / 2, x_of(p, (double)end * r->ticks / r->bins));
    }
    fputs("\"/>\n", p->file);
}

static void draw_volts(const page *p)
{
    const double height = fmax(4, fmin(14, 420.0 / p->r->amplifiers)),
                 bottom = top + height * p->r->amplifiers;
    draw_scale scale = {1, 0, p->scene->unit_voltage};
    for (int i = 0; i < p->r->bins * p->r->amplifiers; i++)
        scale.most = fmax(scale.most, fabs(p->r->volt[i]));
    fputs("<figure>\n", p->file);
    draw_begin_chart(p->file, 1160, bottom + FOOT,
                     "Volts of every amplifier over time, with a line where one is at a limit");
    fputs("<g class=\"flat\">\n", p->file);
    for (int k = 0; k < p->r->amplifiers; k++)
        draw_row(p, k, &scale, top + height * k, height);
    fputs("</g>\n", p->file);
    for (int k = 0; k < p->r->amplifiers && height >= 10; k++) {
        char name[SCENE_LABEL];
        scene_amplifier_name(p->scene, k, name);
        fprintf(p->file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", left - 6,
                top + height * (k + 0.8));
        html_text(p->file, name);
        fputs("</text>\n", p->file);
    }
    draw_phases(p, bottom);
    draw_end_chart(p->file);
    fputs(
        "<figcaption>Volts of the amplifiers under the controller, a row each; the line within marks those at a limit.",
        p->file);
    draw_legend(p->file, &scale);
    fputs("</figcaption></figure>\n", p->file);
}

/* ---- shapes ----------------------------------------------------------- */

/* Displacement, misfit and wanted shape of one end into the page's arrays. */
static void take_shape(const page *p, const simulate_phase *phase, simulate_law law)
{
    const design *d = &p->s->nominal->design;
    const simulate_course *course = &phase->course[law];
    report_displacement(&d->mesh, course->u, p->vector);
    parts_misfit(d, course->shape, phase->target, p->vector, p->misfit, p->wanted);
}

static int draw_shape(const page *p, const simulate_phase *phase, simulate_law law)
{
    take_shape(p, phase, law);
    fprintf(p->file, "<figure><h3>%s ",
            law == LAW_CONTROLLER ? "Controller" : "Clipped least squares");
    html_percent(p->file, phase->course[law].steady);
    fputs("</h3>\n", p->file);
    const int failed = parts_shape(p->file, &p->view, &p->s->nominal->design, p->vector, p->wanted,
                                   p->misfit, p->factor, &p->scale);
    fputs("</figure>\n", p->file);
    return failed;
}

/* Is this the end of conditions that the phase after it changes? Sensor faults leave the shape as
 * it is. */
static int is_worth_seeing(const simulation *s, int k)
{
    return k + 1 == s->phases ||
           fabs(s->phase[k].optimum - s->phase[k + 1].optimum) > 0.02 * s->phase[k].optimum;
}

/* Scales and view that all shapes share. */
static void prepare_shapes(page *p)
{
    const mesh *m = &p->s->nominal->design.mesh;
    double most = 0;
    draw_view_begin(&p->view, m);
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < p->s->phases; k++)
            for (int law = 0; law <= LAW_CLAMP; law++) {
                take_shape(p, &p->s->phase[k], (simulate_law)law);
                for (int n = 0; n < m->nodes; n++) {
                    p->scale.most =
                        fmax(p->scale.most, isnan(p->misfit[n]) ? 0 : fabs(p->misfit[n]));
                    most = fmax(most, sqrt(draw_dot3(p->vector + 3 * n, p->vector + 3 * n)));
                }
                if (pass == 1)
                    parts_include(&p->view, m, p->vector, p->factor);
            }
        p->factor = parts_magnification(m, most, 0.3);
    }
    p->scale.is_signed = 1;
    p->scale.unit = p->scene->unit_length;
    draw_view_fit(&p->view, 420, 320);
}

static int draw_shapes(const page *p)
{
    int failed = 0;
    parts_keys(p->file, "");
    for (int k = 0; k < p->s->phases; k++) {
        char name[WORDS_PHASE];
        if (!is_worth_seeing(p->s, k))
            continue;
        words_phase(p->s, &p->s->phase[k], name);
        fprintf(p->file, "<article class=\"set\">\n<h3>Tick %d: end of &ldquo;",
                p->s->phase[k].until - 1);
        html_text(p->file, name);
        fputs("&rdquo;</h3>\n<div class=\"row two\">\n", p->file);
        for (int law = 0; law <= LAW_CLAMP; law++)
            failed |= draw_shape(p, &p->s->phase[k], (simulate_law)law);
        fputs("</div>\n</article>\n", p->file);
    }
    fputs("<p class=\"soft\">Misfit, reached minus target, on one scale; ", p->file);
    parts_magnified(p->file, &p->s->nominal->design.mesh, p->factor);
    fputs(".</p>\n", p->file);
    draw_legend(p->file, &p->scale);
    return failed;
}

/* ---- page ------------------------------------------------------------- */

static int write_page(page *p)
{
    const analysis *a = p->s->nominal;
    html_begin(p->file, p->scene->name);
    parts_head(p->file, a, "The controller in closed loop", a->model.info.residual,
               a->model.info.error_estimate);
    write_verdict(p);
    fputs("<section>\n<h2>Over time</h2>\n", p->file);
    write_plant(p);
    write_certificate(p);
    draw_errors(p);
    draw_volts(p);
    fputs("</section>\n<section>\n<h2>Phases</h2>\n", p->file);
    write_phases(p);
    write_counts(p);
    fputs("</section>\n<section>\n<h2>Shapes</h2>\n", p->file);
    prepare_shapes(p);
    const int failed = draw_shapes(p);
    fputs(
        "</section>\n<section>\n<h2>Structure the controller believes in</h2>\n<div class=\"row two\">\n",
        p->file);
    parts_layers(p->file, p->scene);
    parts_conditions(p->file, &a->design);
    fputs("</div>\n</section>\n", p->file);
    html_end(p->file);
    return failed;
}

int report_simulate(FILE *file, const simulation *s, const simulate_record *r)
{
    const size_t nodes = (size_t)s->nominal->design.mesh.nodes;
    page p = {.file = file, .s = s, .r = r, .scene = s->nominal->design.scene};
    p.vector = calloc(3 * nodes, sizeof *p.vector);
    p.wanted = calloc(3 * nodes, sizeof *p.wanted);
    p.misfit = calloc(nodes, sizeof *p.misfit);
    const int failed = !p.vector || !p.wanted || !p.misfit || write_page(&p);
    free(p.vector);
    free(p.wanted);
    free(p.misfit);
    return failed || ferror(file) ? -1 : 0;
}
