/* Page of `pzs simulate` (report_simulate.h). */
#include "report_simulate.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "report.h"
#include "report_html.h"
#include "report_parts.h"
#include "../simulate/simulate_words.h"
#include "../text/words.h"

/* ---- record ----------------------------------------------------------- */

int record_open(simulate_record *record, const simulation *simulation)
{
    const design *design = &simulation->nominal->design;
    memset(record, 0, sizeof *record);
    record->ticks = design->scene->simulate.ticks;
    record->bins = record->ticks < RECORD_BINS ? record->ticks : RECORD_BINS;
    record->amplifiers = design->amplifiers;
    record->lower = design->lower;
    record->upper = design->upper;
    record->volt = calloc((size_t)(RECORD_BINS * design->amplifiers), sizeof *record->volt);
    return record->volt ? 0 : -1;
}

void record_close(simulate_record *record)
{
    free(record->volt);
    memset(record, 0, sizeof *record);
}

void record_tick(simulate_record *record, const simulate_sample *sample)
{
    const int bin = (int)((double)sample->tick * record->bins / record->ticks);
    record->error[sample->law][bin] = fmax(record->error[sample->law][bin], sample->error);
    if (sample->law == LAW_CONTROLLER)
        record->missed[bin] = fmax(record->missed[bin], sample->missed);
    if (sample->law == LAW_CONTROLLER)
        memcpy(record->volt + (size_t)(bin * record->amplifiers), sample->volt,
               (size_t)record->amplifiers * sizeof *record->volt);
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
static int is_faulty(const simulation *simulation, const simulate_phase *phase)
{
    const scene_simulate *simulate = &simulation->nominal->design.scene->simulate;
    for (int k = 0; k < simulation->nominal->design.amplifiers; k++)
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
static const simulate_phase *worst_phase(const simulation *simulation, int only_sound,
                                         double *above)
{
    const simulate_phase *worst = NULL;
    for (int k = 0; k < simulation->phases; k++) {
        const simulate_phase *phase = &simulation->phase[k];
        const double here = phase->course[LAW_CONTROLLER].steady / phase->optimum - 1;
        if ((only_sound && is_faulty(simulation, phase)) || (worst && !(here > *above)))
            continue;
        worst = phase;
        *above = here;
    }
    return worst;
}

static void write_verdict(const page *page)
{
    double above = 0, sound = 0;
    const simulate_phase *worst = worst_phase(page->s, 0, &above);
    fprintf(
        page->file,
        "<p class=\"verdict\"><b>%ld volts beyond a limit or the slew</b> in %d ticks; at the end of every phase the shape error is ",
        page->s->count[LAW_CONTROLLER].beyond, page->scene->simulate.ticks);
    if (above > 0) {
        fputs("at most ", page->file);
        html_percent(page->file, above);
        fprintf(page->file,
                " above the optimum for that plant in the same limits (phase from tick %d",
                worst->from);
        if (is_faulty(page->s, worst) && worst_phase(page->s, 1, &sound)) {
            fputs(", ", page->file);
            html_percent(page->file, fmax(sound, 0));
            fputs(" in those without faults", page->file);
        }
        fputs(").</p>\n", page->file);
    } else {
        fputs("no more than the optimum for that plant in the same limits.</p>\n", page->file);
    }
}

static void write_phase(const page *page, const simulate_phase *phase)
{
    const simulate_course *course = phase->course;
    char name[SIMULATE_PHASE_TEXT];
    simulate_words_phase(page->s, phase, name);
    fprintf(page->file, "<tr><th scope=\"row\">%d</th><td class=\"note\">", phase->from);
    html_text(page->file, name);
    fputs("</td><td>", page->file);
    html_percent(page->file, phase->optimum);
    fputs("</td><td>", page->file);
    html_percent(page->file, course[LAW_CONTROLLER].steady);
    fputs("</td><td>", page->file);
    html_percent(page->file, course[LAW_CLAMP].steady);
    fputs("</td><td>", page->file);
    html_percent(page->file, course[LAW_REGULARISED].steady);
    fputs("</td><td>", page->file);
    html_percent(page->file, course[LAW_CONTROLLER].worst);
    fputs("</td><td>", page->file);
    if (course->settled < 0)
        fputs("&ndash;", page->file);
    else
        fprintf(page->file, "%d", course->settled);
    fprintf(page->file, "</td><td>%d</td></tr>\n", course->slew_ticks);
}

static void write_phases(const page *page)
{
    html_table_begin(
        page->file,
        "Shape error: root of the weighted squares of the misfit over those of the scene&rsquo;s target. Steady: over the "
        "last ticks of the phase. Optimum: the best volts for this plant in the same limits. Clipped: least squares without limits, "
        "cut to limits and slew, same plant and sensors. Regularised: the same with the one parameter that is best for the "
        "scene&rsquo;s target on the controller&rsquo;s model, chosen knowing the answer. Settled: ticks until the shape stays within 5 % of its way. Slew: ticks the slew "
        "alone needs.",
        "<th scope=\"col\">Tick</th><th scope=\"col\" class=\"note\">What happens</th><th scope=\"col\">Optimum</th>"
        "<th scope=\"col\">Steady</th><th scope=\"col\">Clipped</th><th scope=\"col\">Regularised, clipped</th><th scope=\"col\">Worst</th><th scope=\"col\">Settled</th>"
        "<th scope=\"col\">Slew</th>");
    for (int k = 0; k < page->s->phases; k++)
        write_phase(page, &page->s->phase[k]);
    html_table_end(page->file);
}

/* What not every controller does. */
static void write_extras(const page *page, const simulate_count *count)
{
    const device_board *board = page->s->board;
    char text[SCENE_ERROR];
    if (page->s->estimates) {
        estimator_text(&page->s->estimator, page->s->nominal, text);
        fprintf(page->file, "<p>The shape is estimated. By the influence %s, ",
                simulate_words_influence(page->scene));
        html_text(page->file, text);
        fputs(".</p>\n", page->file);
    }
    if (page->scene->simulate.finds)
        fprintf(
            page->file,
            "<p>Electrodes that the controller found not to follow: %ld, the slowest after %d ticks; %ld of them were in good "
            "order.</p>\n",
            count->found, count->search, count->wrong);
    if (!board)
        return;
    fprintf(page->file, "<p>The controller is the firmware of %s, in %s", board->name,
            board->bits == 32 ? "float" : "double");
    if (board->twin)
        fprintf(page->file,
                ", under QEMU: %ld of %ld ticks with the bits of the same C on this computer",
                count->same, simulate_ran(count));
    fputs(".</p>\n", page->file);
}

static void write_counts(const page *page)
{
    static const char *const name[LAWS] = {"Controller", "Clipped least squares",
                                           "Regularised, then clipped"};
    html_table_begin(
        page->file, "Ticks of all laws",
        "<th scope=\"col\">Law</th><th scope=\"col\">Volts beyond limit or slew</th>"
        "<th scope=\"col\">Not finite</th><th scope=\"col\">Lost</th><th scope=\"col\">Held</th><th scope=\"col\">A sensor doubted</th>"
        "<th scope=\"col\">Out of passes</th><th scope=\"col\">Most passes</th>");
    for (int law = 0; law < LAWS; law++) {
        const simulate_count *count = &page->s->count[law];
        fprintf(
            page->file,
            "<tr><th scope=\"row\">%s</th><td>%ld</td><td>%ld</td><td>%ld</td><td>%ld</td><td>%ld</td><td>%ld</td><td>%d</td></tr>\n",
            name[law], count->beyond, count->not_finite, count->lost, count->status[PZS_W_HELD],
            count->status[PZS_W_SENSOR], count->status[PZS_W_ITERATIONS], count->passes_most);
    }
    html_table_end(page->file);
    write_extras(page, &page->s->count[LAW_CONTROLLER]);
}

/* What vibration would make of the loop, where the densities say it. */
static void write_certificate(const page *page)
{
    const certificate *certificate = &page->s->nominal->certificate;
    char text[3 * SCENE_ERROR];
    certificate_text(certificate, text);
    if (!certificate->is_made)
        return;
    fputs("<p><b>Quasi-static plant: no inertia.</b> ", page->file);
    if (certificate->has_modes)
        fprintf(page->file, "First natural frequency %.4g Hz. ", certificate_first(certificate));
    else
        fputs("Vibration is not known: ", page->file);
    html_text(page->file, certificate->has_modes ? text : certificate->reason);
    fputs("</p>\n", page->file);
}

/* The plant as it is, of what the controller believes. */
static void write_plant(const page *page)
{
    const scene_simulate *simulate = &page->scene->simulate;
    fprintf(page->file, "<p>A %s plant",
            page->s->plant.analysis.nonlinear ? "nonlinear" : "linear");
    for (int i = 0; i < page->scene->materials; i++) {
        fputs(i ? "; " : ": ", page->file);
        html_text(page->file, page->scene->material[i].name);
        fprintf(page->file, " stiffness &times;&nbsp;%g, d &times;&nbsp;%g",
                simulate->stiffness ? simulate->stiffness[i] : 1, simulate->d ? simulate->d[i] : 1);
    }
    fprintf(page->file, "; hysteresis %g. Sensors: %d, ", simulate->hysteresis,
            page->s->estimates ? page->s->estimator.sensors : page->s->nominal->design.targets);
    if (page->s->estimates) {
        fputs("with the noise of their readings", page->file);
    } else {
        fputs("noise ", page->file);
        html_quantity(page->file, simulate->noise, page->scene->unit_length);
    }
    fprintf(page->file, ", delay %d ticks. Amplifiers: steps of ", simulate->delay);
    html_quantity(page->file, simulate->step, page->scene->unit_voltage);
    fputs(", dead band ", page->file);
    html_quantity(page->file, simulate->dead_band, page->scene->unit_voltage);
    fprintf(page->file,
            ". The controller&rsquo;s influence is that %s. Every shape is an equilibrium.</p>\n",
            simulate->at_target ? "at the nonlinear optimum it believes in" : "at rest");
}

/* ---- over time -------------------------------------------------------- */

static const double left = 64, right = 1150, top = 8;

static double x_of(const page *page, double tick)
{
    return left + (right - left) * tick / page->r->ticks;
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
static void draw_ticks(const page *page, double bottom)
{
    double taken[TICK_ROWS] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < page->s->phases; k++) {
        const double x = x_of(page, page->s->phase[k].from);
        int row = x > right - END_ROOM;
        while (row < TICK_ROWS && x < taken[row] + TICK_ROOM)
            row++;
        if (row == TICK_ROWS)
            continue;
        taken[row] = x;
        if (row > 0)
            fprintf(page->file, "<path class=\"grid\" d=\"M%.1f %.1fv%d\"/>", x, bottom,
                    3 + row * TICK_ROW);
        fprintf(page->file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%d</text>\n", x,
                bottom + 13 + row * TICK_ROW, page->s->phase[k].from);
    }
    fprintf(page->file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">tick %d, ", right,
            bottom + 13, page->r->ticks);
    html_quantity(page->file, page->r->ticks / page->scene->simulate.rate, "s");
    fputs("</text>\n", page->file);
}

/* Verticals at the phases, their ticks below. */
static void draw_phases(const page *page, double bottom)
{
    fputs("<path class=\"grid\" d=\"", page->file);
    for (int k = 1; k < page->s->phases; k++)
        fprintf(page->file, "M%.1f %.1fV%.1f", x_of(page, page->s->phase[k].from), top, bottom);
    fprintf(page->file,
            "\"/>\n<rect class=\"frame\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
            left, top, right - left, bottom - top);
    draw_ticks(page, bottom);
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
static log_axis axis_of(const page *page, double bottom)
{
    static const double step[3] = {1, 2, 5};
    log_axis axis = {HUGE_VAL, 0, bottom};
    for (int law = 0; law < LAWS; law++)
        for (int i = 0; i < page->r->bins; i++) {
            axis.low =
                fmin(axis.low, page->r->error[law][i] > 0 ? page->r->error[law][i] : HUGE_VAL);
            axis.high = fmax(axis.high, page->r->error[law][i]);
        }
    for (int i = 0; i < page->r->bins && page->s->estimates; i++)
        axis.low = fmin(axis.low, page->r->missed[i] > 0 ? page->r->missed[i] : HUGE_VAL);
    for (int k = 0; k < page->s->phases; k++)
        axis.low =
            fmin(axis.low, page->s->phase[k].optimum > 0 ? page->s->phase[k].optimum : axis.low);
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

static void draw_levels(const page *page, const log_axis *axis)
{
    static const double step[3] = {1, 2, 5};
    for (double ten = pow(10, floor(log10(axis->low))); ten <= axis->high; ten *= 10)
        for (int i = 0; i < 3; i++) {
            const double y = y_of(axis, step[i] * ten);
            if (step[i] * ten < axis->low * (1 - 1e-9) || step[i] * ten > axis->high)
                continue;
            fprintf(
                page->file,
                "<path class=\"grid\" d=\"M%.1f %.1fH%.1f\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">",
                left, y, right, left - 6, y + 4);
            html_percent(page->file, step[i] * ten);
            fputs("</text>\n", page->file);
        }
}

/* value [bins] in: an error over time */
static void draw_curve(const page *page, const log_axis *axis, const char *style, double width,
                       const double *value)
{
    fprintf(page->file, "<path class=\"%s\" style=\"stroke-width:%.1f\" d=\"", style, width);
    for (int i = 0; i < page->r->bins; i++)
        fprintf(page->file, "%c%.1f %.1f", i ? 'L' : 'M',
                x_of(page, (i + 0.5) * page->r->ticks / page->r->bins), y_of(axis, value[i]));
    fputs("\"/>\n", page->file);
}

static void draw_errors(const page *page)
{
    const log_axis axis = axis_of(page, 250);
    static const char *const style[LAWS] = {"wire", "rest", ""};
    fputs("<figure>\n", page->file);
    draw_begin_chart(
        page->file, 1160, axis.bottom + FOOT,
        "Shape error over time of the controller and of clipped least squares, with the optimum of each phase");
    draw_levels(page, &axis);
    draw_phases(page, axis.bottom);
    for (int law = LAW_CLAMP; law >= 0; law--)
        draw_curve(page, &axis, style[law], 1.6, page->r->error[law]);
    if (page->s->estimates)
        draw_curve(page, &axis, "wire", 0.7, page->r->missed);
    fputs("<path class=\"outline\" d=\"", page->file);
    for (int k = 0; k < page->s->phases; k++)
        fprintf(page->file, "M%.1f %.1fH%.1f", x_of(page, page->s->phase[k].from),
                y_of(&axis, page->s->phase[k].optimum), x_of(page, page->s->phase[k].until));
    fputs("\"/>\n", page->file);
    draw_end_chart(page->file);
    fputs(
        "<figcaption><span class=\"keys\"><span><i class=\"key\"></i>controller</span><span><i class=\"key gone\"></i>clipped</span>"
        "<span><i class=\"key dash\"></i>optimum of the plant</span></span> Shape error, logarithmic",
        page->file);
    if (page->s->estimates)
        fputs("; thin: what the estimate is off by", page->file);
    if (page->r->ticks > page->r->bins)
        fprintf(page->file, "; the largest of every %d ticks",
                (page->r->ticks + page->r->bins - 1) / page->r->bins);
    fputs(".</figcaption></figure>\n", page->file);
}

/* One amplifier: runs of one colour, then a line where it is at a limit. */
static void draw_row(const page *page, int amplifier, const draw_scale *scale, double y,
                     double height)
{
    const simulate_record *record = page->r;
    const double *voltage = record->volt + amplifier;
    for (int i = 0, end; i < record->bins; i = end) {
        const int level = draw_level(scale, voltage[i * record->amplifiers]);
        for (end = i + 1;
             end < record->bins && draw_level(scale, voltage[end * record->amplifiers]) == level;)
            end++;
        const double from = x_of(page, (double)i * record->ticks / record->bins),
                     to = x_of(page, (double)end * record->ticks / record->bins);
        draw_path(page->file, scale, level);
        fprintf(page->file, "M%.1f %.1fH%.1fv%.1fH%.1fz\"/>", from, y, to, height, from);
    }
    fputs("<path class=\"frame\" style=\"stroke:var(--ink)\" d=\"", page->file);
    for (int i = 0, end; i < record->bins; i = end) {
        const int at = voltage[i * record->amplifiers] <= record->lower[amplifier] ||
                       voltage[i * record->amplifiers] >= record->upper[amplifier];
        for (end = i + 1; end < record->bins &&
                          at == (voltage[end * record->amplifiers] <= record->lower[amplifier] ||
                                 voltage[end * record->amplifiers] >= record->upper[amplifier]);)
            end++;
        if (at)
            fprintf(page->file, "M%.1f %.1fH%.1f",
                    x_of(page, (double)i * record->ticks / record->bins), y + height / 2,
                    x_of(page, (double)end * record->ticks / record->bins));
    }
    fputs("\"/>\n", page->file);
}

static void draw_volts(const page *page)
{
    const double height = fmax(4, fmin(14, 420.0 / page->r->amplifiers)),
                 bottom = top + height * page->r->amplifiers;
    draw_scale scale = {1, 0, page->scene->unit_voltage};
    for (int i = 0; i < page->r->bins * page->r->amplifiers; i++)
        scale.most = fmax(scale.most, fabs(page->r->volt[i]));
    fputs("<figure>\n", page->file);
    draw_begin_chart(page->file, 1160, bottom + FOOT,
                     "Volts of every amplifier over time, with a line where one is at a limit");
    fputs("<g class=\"flat\">\n", page->file);
    for (int k = 0; k < page->r->amplifiers; k++)
        draw_row(page, k, &scale, top + height * k, height);
    fputs("</g>\n", page->file);
    for (int k = 0; k < page->r->amplifiers && height >= 10; k++) {
        char name[SCENE_LABEL];
        scene_amplifier_name(page->scene, k, name);
        fprintf(page->file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", left - 6,
                top + height * (k + 0.8));
        html_text(page->file, name);
        fputs("</text>\n", page->file);
    }
    draw_phases(page, bottom);
    draw_end_chart(page->file);
    fputs(
        "<figcaption>Volts of the amplifiers under the controller, a row each; the line within marks those at a limit.",
        page->file);
    draw_legend(page->file, &scale);
    fputs("</figcaption></figure>\n", page->file);
}

/* ---- shapes ----------------------------------------------------------- */

/* Displacement, misfit and wanted shape of one end into the page's arrays. */
static void take_shape(const page *page, const simulate_phase *phase, simulate_law law)
{
    const design *design = &page->s->nominal->design;
    const simulate_course *course = &phase->course[law];
    report_displacement(&design->mesh, course->u, page->vector);
    parts_misfit(design, course->shape, phase->target, page->vector, page->misfit, page->wanted);
}

static int draw_shape(const page *page, const simulate_phase *phase, simulate_law law)
{
    take_shape(page, phase, law);
    fprintf(page->file, "<figure><h3>%s ",
            law == LAW_CONTROLLER ? "Controller" : "Clipped least squares");
    html_percent(page->file, phase->course[law].steady);
    fputs("</h3>\n", page->file);
    const int failed = parts_shape(page->file, &page->view, &page->s->nominal->design, page->vector,
                                   page->wanted, page->misfit, page->factor, &page->scale);
    fputs("</figure>\n", page->file);
    return failed;
}

/* Is this the end of conditions that the phase after it changes? Sensor faults leave the shape as
 * it is. */
static int is_worth_seeing(const simulation *simulation, int k)
{
    return k + 1 == simulation->phases ||
           fabs(simulation->phase[k].optimum - simulation->phase[k + 1].optimum) >
               0.02 * simulation->phase[k].optimum;
}

/* Scales and view that all shapes share. */
static void prepare_shapes(page *page)
{
    const mesh *mesh = &page->s->nominal->design.mesh;
    double most = 0;
    draw_view_begin(&page->view, mesh);
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < page->s->phases; k++)
            for (int law = 0; law <= LAW_CLAMP; law++) {
                take_shape(page, &page->s->phase[k], (simulate_law)law);
                for (int n = 0; n < mesh->nodes; n++) {
                    page->scale.most =
                        fmax(page->scale.most, isnan(page->misfit[n]) ? 0 : fabs(page->misfit[n]));
                    most = fmax(most, sqrt(draw_dot3(page->vector + 3 * n, page->vector + 3 * n)));
                }
                if (pass == 1)
                    parts_include(&page->view, mesh, page->vector, page->factor);
            }
        page->factor = parts_magnification(mesh, most, 0.3);
    }
    page->scale.is_signed = 1;
    page->scale.unit = page->scene->unit_length;
    draw_view_fit(&page->view, 420, 320);
}

static int draw_shapes(const page *page)
{
    int failed = 0;
    parts_keys(page->file, "");
    for (int k = 0; k < page->s->phases; k++) {
        char name[SIMULATE_PHASE_TEXT];
        if (!is_worth_seeing(page->s, k))
            continue;
        simulate_words_phase(page->s, &page->s->phase[k], name);
        fprintf(page->file, "<article class=\"set\">\n<h3>Tick %d: end of &ldquo;",
                page->s->phase[k].until - 1);
        html_text(page->file, name);
        fputs("&rdquo;</h3>\n<div class=\"row two\">\n", page->file);
        for (int law = 0; law <= LAW_CLAMP; law++)
            failed |= draw_shape(page, &page->s->phase[k], (simulate_law)law);
        fputs("</div>\n</article>\n", page->file);
    }
    fputs("<p class=\"soft\">Misfit, reached minus target, on one scale; ", page->file);
    parts_magnified(page->file, &page->s->nominal->design.mesh, page->factor);
    fputs(".</p>\n", page->file);
    draw_legend(page->file, &page->scale);
    return failed;
}

/* ---- page ------------------------------------------------------------- */

static int write_page(page *page)
{
    const analysis *analysis = page->s->nominal;
    html_begin(page->file, page->scene->name);
    parts_head(page->file, analysis, "The controller in closed loop", analysis->model.info.residual,
               analysis->model.info.error_estimate);
    write_verdict(page);
    fputs("<section>\n<h2>Over time</h2>\n", page->file);
    write_plant(page);
    write_certificate(page);
    draw_errors(page);
    draw_volts(page);
    fputs("</section>\n<section>\n<h2>Phases</h2>\n", page->file);
    write_phases(page);
    write_counts(page);
    fputs("</section>\n<section>\n<h2>Shapes</h2>\n", page->file);
    prepare_shapes(page);
    const int failed = draw_shapes(page);
    fputs(
        "</section>\n<section>\n<h2>Structure the controller believes in</h2>\n<div class=\"row two\">\n",
        page->file);
    parts_layers(page->file, page->scene);
    parts_conditions(page->file, &analysis->design);
    fputs("</div>\n</section>\n", page->file);
    html_end(page->file);
    return failed;
}

int report_simulate(FILE *file, const simulation *simulation, const simulate_record *record)
{
    const size_t nodes = (size_t)simulation->nominal->design.mesh.nodes;
    page page = {
        .file = file, .s = simulation, .r = record, .scene = simulation->nominal->design.scene};
    page.vector = calloc(3 * nodes, sizeof *page.vector);
    page.wanted = calloc(3 * nodes, sizeof *page.wanted);
    page.misfit = calloc(nodes, sizeof *page.misfit);
    const int failed = !page.vector || !page.wanted || !page.misfit || write_page(&page);
    free(page.vector);
    free(page.wanted);
    free(page.misfit);
    return failed || ferror(file) ? -1 : 0;
}
