/* SPDX-License-Identifier: BSD-2-Clause */
/* Report page of `pzs simulate` (report_simulate.h). */
#include "report_simulate.h"
#include "../simulate/imperfections.h"
#include "../simulate/simulate_words.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "report_page.h"
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
    if (sample->law != LAW_CONTROLLER)
        return;
    record->missed[bin] = fmax(record->missed[bin], sample->measurement_error);
    record->vibration[bin] = fmax(record->vibration[bin], sample->vibration);
    memcpy(record->volt + (size_t)(bin * record->amplifiers), sample->voltage,
           (size_t)record->amplifiers * sizeof *record->volt);
}

typedef struct simulate_page {
    FILE *file;
    const simulation *s;
    const simulate_record *r;
    const scene *scene;
    const design *d;
    page_shape shape; /* the shape that is drawn at present */
    double *aim; /* [targets] target values of this shape, corrected by the free functions of the
                    target */
    draw_view view;
    draw_scale misfit;
    double factor;
    draw_axis time;
} simulate_page;

/* ---- words ------------------------------------------------------------ */

static const char *const law_name[LAWS] = {"Controller", "Clipped least squares",
                                           "Regularised, then clipped"};
/* Number of control laws in the drawings; the tables contain all of them. */
enum { DRAWN = LAW_CLAMP + 1 };

/*
 * The phase in which the controller's error ends farthest above its optimum.
 *   above  out  relative excess of the error over the optimum
 * Returns NULL if no phase has an error.
 */
static const simulate_phase *worst_phase(const simulation *simulation, double *above)
{
    const simulate_phase *worst = NULL;
    *above = -1;
    for (int k = 0; k < simulation->phases; k++) {
        const simulate_phase *phase = &simulation->phase[k];
        const double here = phase->course[LAW_CONTROLLER].steady / phase->optimum - 1;
        if (!(here > *above))
            continue;
        worst = phase;
        *above = here;
    }
    return worst;
}

static void write_verdict(const simulate_page *p)
{
    double above;
    char name[SIMULATE_PHASE_TEXT];
    const simulate_phase *worst = worst_phase(p->s, &above);
    put(p->file,
        "<p class=\"verdict\"><b>%d voltages beyond a limit or the step limit</b> in %d "
        "ticks",
        (int)p->s->count[LAW_CONTROLLER].beyond_limits, p->r->ticks);
    if (worst) {
        simulate_words_phase(p->s, worst, name);
        put(p->file,
            "; at the end of a phase the relative RMS error is at most %p above the "
            "optimum for that plant in the same limits (“%t”, from tick %d)",
            fmax(above, 0), name, worst->from);
    }
    fputs(".</p>\n", p->file);
}

static void write_phases(const simulate_page *p)
{
    put_table(
        p->file,
        "Relative RMS error: root of the weighted squares of the misfit over those "
        "of the scene’s target. Steady: over the last ticks of the phase. Optimum: the best "
        "voltages for this plant in the same limits. Clipped: least squares without limits, cut "
        "to limits and step limit, same plant and sensors. Regularised, clipped: the same with "
        "the one parameter that is best for the scene’s target on the controller’s model, chosen "
        "knowing the answer. Settled: ticks until the shape stays "
        "within 5 % of its change. Step limit: ticks that the step limit alone needs.",
        "Tick|~Events|Optimum|Steady|Clipped|Regularised,<br/>clipped|Worst|Settled|Step limit");
    for (int k = 0; k < p->s->phases; k++) {
        const simulate_phase *phase = &p->s->phase[k];
        const simulate_course *course = phase->course;
        char name[SIMULATE_PHASE_TEXT];
        simulate_words_phase(p->s, phase, name);
        put_row(p->file, "%d|~%t|%p|%p|%p|%p|%p|%n|%d", phase->from, name, phase->optimum,
                course[LAW_CONTROLLER].steady, course[LAW_CLAMP].steady,
                course[LAW_REGULARISED].steady, course[LAW_CONTROLLER].worst,
                course->settled < 0 ? (double)NAN : course->settled, course->step_limit_ticks);
    }
    put_table_end(p->file);
}

/*
 * Write the results that depend on optional parts of the control loop: shape estimator, fault
 * detector, and a device with its firmware.
 */
static void write_extras(const simulate_page *p, const simulate_count *count)
{
    const device_board *board = p->s->board;
    char text[SCENE_ERROR];
    if (p->s->estimates) {
        estimator_text(&p->s->estimator, p->s->nominal, text);
        put(p->file, "<p>The shape is estimated. By the influence %s, %t.</p>\n",
            simulate_words_influence(p->scene), text);
    }
    if (p->scene->simulate.finds)
        put(p->file,
            "<p>Electrodes detected as faulty: %d, the slowest after %d ticks; %d of "
            "them were in good order.</p>\n",
            (int)count->detected, count->detection_ticks, (int)count->falsely_detected);
    if (!board)
        return;
    put(p->file, "<p>The controller is the firmware of %t, in %s", board->name,
        board->bits == 32 ? "float" : "double");
    if (board->twin)
        put(p->file, ", under QEMU: %d of %d ticks with the bits of the same C on this computer",
            (int)count->agreeing_ticks, (int)simulate_ran(count));
    fputs(".</p>\n", p->file);
}

static void write_counts(const simulate_page *p)
{
    put_table(p->file, "Ticks of all laws",
              "Law|Voltages beyond limit or step limit|Not "
              "finite|Missed ticks|Held|A sensor rejected|Out of iterations|Most iterations");
    for (int law = 0; law < LAWS; law++) {
        const simulate_count *count = &p->s->count[law];
        put_row(p->file, "%s|%d|%d|%d|%d|%d|%d|%d", law_name[law], (int)count->beyond_limits,
                (int)count->not_finite, (int)count->missed_ticks, (int)count->status[PZS_W_HELD],
                (int)count->status[PZS_W_SENSOR], (int)count->status[PZS_W_ITERATIONS],
                count->iterations_most);
    }
    put_table_end(p->file);
    write_extras(p, &p->s->count[LAW_CONTROLLER]);
}

/* Write in what the simulated plant differs from the model of the controller. */
static void write_plant(const simulate_page *p)
{
    const scene_simulate *simulate = &p->scene->simulate;
    char imperfections[400];
    const int sensors = p->s->estimates ? p->s->estimator.sensors : p->d->targets;
    put(p->file, "<p>A %s plant", p->s->plant.analysis.nonlinear ? "nonlinear" : "linear");
    for (int i = 0; i < p->scene->materials; i++) {
        const double stiffness = simulate->stiffness ? simulate->stiffness[i] : 1;
        const double d = simulate->d ? simulate->d[i] : 1;
        put(p->file, "%s%t stiffness × %n, d × %n", i ? "; " : ": ", p->scene->material[i].name,
            stiffness, d);
    }
    imperfections_text(p->d, imperfections, sizeof imperfections);
    put(p->file, ". Imperfections: %t. Sensors: %d, ", *imperfections ? imperfections : "none",
        sensors);
    if (p->s->estimates)
        put(p->file, "with the noise of their readings");
    else
        put(p->file, "noise %q", simulate->noise, p->scene->unit_length);
    put(p->file,
        ", delay %d ticks. Amplifiers: steps of %q, dead band %q. The controller’s "
        "influence matrix is that of the %s. %t.</p>\n",
        simulate->delay, simulate->step, p->scene->unit_voltage, simulate->dead_band,
        p->scene->unit_voltage,
        simulate->at_target ? "nonlinear optimum of its model" : "undeformed shell",
        p->s->plant.has_inertia ? "The plant has inertia: it vibrates about its equilibria"
                                : "Every shape is an equilibrium");
}

/*
 * Write the effect of vibrations on the control loop, as far as the scene gives the densities of
 * the materials.
 */
static void write_certificate(const simulate_page *p)
{
    const certificate *certificate = &p->s->nominal->certificate;
    char text[CERTIFICATE_TEXT];
    if (!certificate->is_made)
        return;
    certificate_text(certificate, text);
    if (p->s->plant.has_inertia)
        put(p->file, "<p><b>Plant with inertia, %d modes.</b> ", (int)p->s->plant.modal.modes);
    else
        put(p->file, "<p><b>Quasi-static plant: no inertia (%t).</b> ", p->s->plant.reason);
    if (certificate->has_modes)
        put(p->file, "First natural frequency %q. %t</p>\n", certificate_first(certificate), "Hz",
            text);
    else
        put(p->file, "Vibration is not known: %t</p>\n", certificate->reason);
}

/* ---- over time -------------------------------------------------------- */

enum { TOP = 8, BOTTOM = 250, FOOT = 34, LEFT = 64, RIGHT = 1150 };

static double bin_at(const simulate_page *p, double bin)
{
    return draw_on(&p->time, bin * p->r->ticks / p->r->bins);
}

/*
 * Draw the frame of a picture with the time axis, and a vertical line at the beginning of each
 * phase.
 */
static void draw_time(const simulate_page *p, double bottom)
{
    const draw_axis y = {.from = bottom, .to = TOP};
    put(p->file, "<rect class=\"frame\" x=\"%d\" y=\"%d\" width=\"%d\" height=\"%f\"/>\n", LEFT,
        TOP, RIGHT - LEFT, bottom - TOP);
    draw_grid(p->file, &p->time, &y, true);
    draw_path(p->file, "rest ghost");
    for (int k = 1; k < p->s->phases; k++)
        put(p->file, "M%f %dV%f", draw_on(&p->time, p->s->phase[k].from), TOP, bottom);
    put(p->file, "\"/><text class=\"end\" x=\"%d\" y=\"%f\">tick, of %q in all</text>\n", RIGHT,
        bottom + 28, p->r->ticks / p->scene->control.rate, "s");
}

/* Extend the range of an axis to include a value. Values that are not positive are ignored. */
static void include(draw_axis *axis, double value)
{
    axis->low = value > 0 ? fmin(axis->low, value) : axis->low;
    axis->high = value > 0 ? fmax(axis->high, value) : axis->high;
}

/* Logarithmic axis for all errors; at most six powers of ten below the largest one. */
static draw_axis error_axis(const simulate_page *p)
{
    draw_axis axis = {HUGE_VAL, 0, BOTTOM, TOP, true, "%p", {1, ""}};
    for (int i = 0; i < p->r->bins; i++) {
        for (int law = 0; law < DRAWN; law++)
            include(&axis, p->r->error[law][i]);
        if (p->s->estimates)
            include(&axis, p->r->missed[i]);
        include(&axis, p->r->vibration[i]);
    }
    for (int k = 0; k < p->s->phases; k++)
        include(&axis, p->s->phase[k].optimum);
    axis.high = axis.high > 0 ? axis.high : 1;
    axis.low = 0.8 * fmin(fmax(axis.low, 1e-6 * axis.high), axis.high / 2);
    return axis;
}

/*
 * Draw an error over time.
 *   value [bins]  in  error in each bin
 */
static void draw_curve(const simulate_page *p, const draw_axis *axis, const char *style,
                       const double *value)
{
    bool is_drawing = false;
    draw_path(p->file, style);
    for (int i = 0; i < p->r->bins; i++) {
        const double at[2] = {bin_at(p, i + 0.5), draw_on(axis, value[i])};
        draw_step(p->file, &is_drawing, at);
    }
    draw_path_end(p->file);
}

static void draw_errors(const simulate_page *p)
{
    const draw_axis axis = error_axis(p);
    draw_grid(p->file, &p->time, &axis, false);
    draw_time(p, BOTTOM);
    draw_curve(p, &axis, "rest bold", p->r->error[LAW_CLAMP]);
    draw_curve(p, &axis, "wire bold", p->r->error[LAW_CONTROLLER]);
    if (p->s->estimates)
        draw_curve(p, &axis, "wire", p->r->missed);
    if (p->s->plant.has_inertia)
        draw_curve(p, &axis, "rest", p->r->vibration);
    draw_path(p->file, "outline");
    for (int k = 0; k < p->s->phases; k++) {
        const double y = draw_on(&axis, p->s->phase[k].optimum);
        const double from[2] = {draw_on(&p->time, p->s->phase[k].from), y};
        const double to[2] = {draw_on(&p->time, p->s->phase[k].until), y};
        draw_line(p->file, from, to);
    }
    draw_path_end(p->file);
}

static void write_errors(const simulate_page *p)
{
    fputs("<figure>\n", p->file);
    draw_begin(p->file, DRAW_CHART, RIGHT + 10, BOTTOM + FOOT, "Relative RMS error over time",
               "Of the controller and of clipped least squares, with the optimum of each phase");
    draw_errors(p);
    draw_end(p->file, DRAW_CHART);
    put(p->file,
        "<figcaption><span class=\"keys\"><span><i class=\"key\"></i>controller</span>"
        "<span><i class=\"key gone\"></i>clipped</span><span><i class=\"key dash\"></i>optimum of "
        "the plant</span></span> Relative RMS error, logarithmic%s%s",
        p->s->estimates ? "; thin: error of the estimate" : "",
        p->s->plant.has_inertia ? "; thin grey: vibration, the distance from the equilibrium" : "");
    if (p->r->ticks > p->r->bins)
        put(p->file, "; the largest of every %d ticks",
            (p->r->ticks + p->r->bins - 1) / p->r->bins);
    fputs(".</figcaption></figure>\n", p->file);
}

/*
 * What is drawn of an amplifier in a bin: with a colour scale the index of the voltage's colour,
 * without one (NULL) whether a limit is active.
 */
static int bin_state(const simulate_page *p, int amplifier, const draw_scale *scale, int bin)
{
    const double voltage = p->r->volt[bin * p->r->amplifiers + amplifier];
    if (scale)
        return draw_level(scale, voltage);
    return voltage <= p->r->lower[amplifier] || voltage >= p->r->upper[amplifier];
}

/*
 * Draw the row of one amplifier over time. With a colour scale: bars in the colour of its voltage.
 * Without one: a line wherever a limit is active.
 */
static void draw_row(const simulate_page *p, int amplifier, const draw_scale *scale, double y,
                     double height)
{
    for (int i = 0, end; i < p->r->bins; i = end) {
        const int state = bin_state(p, amplifier, scale, i);
        for (end = i + 1; end < p->r->bins && bin_state(p, amplifier, scale, end) == state;)
            end++;
        if (!scale && !state)
            continue;
        draw_path(p->file, scale ? draw_class(scale, state) : "at");
        if (scale)
            put(p->file, "M%f %fH%fv%fH%fz\"/>", bin_at(p, i), y, bin_at(p, end), height,
                bin_at(p, i));
        else
            put(p->file, "M%f %fH%f\"/>", bin_at(p, i), y + height / 2, bin_at(p, end));
    }
}

static void write_voltages(const simulate_page *p)
{
    const int rows = p->r->amplifiers;
    const double height = fmax(4, fmin(14, 420.0 / rows)), bottom = TOP + height * rows;
    draw_scale scale = {true, 0, p->scene->unit_voltage};
    for (int i = 0; i < p->r->bins * rows; i++)
        scale.most = fmax(scale.most, fabs(p->r->volt[i]));
    fputs("<figure>\n", p->file);
    draw_begin(p->file, DRAW_CHART, RIGHT + 10, bottom + FOOT,
               "Voltages of the amplifiers over time",
               "A row for each amplifier, with a line where a limit is active");
    fputs("<g class=\"flat\">\n", p->file);
    for (int k = 0; k < rows; k++) {
        draw_row(p, k, &scale, TOP + height * k, height);
        draw_row(p, k, NULL, TOP + height * k, height);
    }
    fputs("</g>\n", p->file);
    for (int k = 0; k < rows; k++) {
        char name[SCENE_LABEL];
        scene_amplifier_name(p->scene, k, name);
        put(p->file, "<text class=\"end\" style=\"font-size:%fpx\" x=\"%d\" y=\"%f\">%t</text>\n",
            fmin(height, 11), LEFT - 6, TOP + height * (k + 0.8), name);
    }
    draw_time(p, bottom);
    draw_end(p->file, DRAW_CHART);
    fputs("<figcaption>Voltages of the amplifiers under the controller, a row each; the line "
          "within marks active limits.",
          p->file);
    draw_legend(p->file, &scale);
    fputs("</figcaption></figure>\n", p->file);
}

/* ---- shapes ----------------------------------------------------------- */

/* Copy the shape at the end of phase k under a control law into the page, with its misfit. */
static void take_shape(simulate_page *p, int k, int law)
{
    const simulate_phase *phase = &p->s->phase[k];
    const double *shape = phase->course[law].shape;
    (void)design_misfit(p->d, shape, phase->target, p->aim);
    for (int t = 0; t < p->d->targets; t++)
        p->aim[t] = shape[t] - p->aim[t];
    page_shape_fill(&p->shape, p->d, phase->course[law].displacement, shape, p->aim);
}

/* Whether a law for comparison has diverged before the end of phase k. */
static bool has_diverged(const simulate_page *p, int k, int law)
{
    return isinf(p->s->phase[k].course[law].steady);
}

/* Choose the colour scale, the magnification and the view that all shapes share. */
static void fit_shapes(simulate_page *p)
{
    double most = 0;
    p->misfit = (draw_scale){true, 0, p->scene->unit_length};
    draw_view_begin(&p->view, &p->d->mesh);
    for (int k = 0; k < DRAWN * p->s->phases; k++) {
        if (has_diverged(p, k / DRAWN, k % DRAWN))
            continue;
        take_shape(p, k / DRAWN, k % DRAWN);
        p->misfit.most = fmax(p->misfit.most, p->shape.worst);
        most = fmax(most, page_largest(&p->d->mesh, p->shape.vector));
    }
    p->factor = draw_magnification(&p->d->mesh, most, 0.3);
    for (int k = 0; k < DRAWN * p->s->phases; k++) {
        if (has_diverged(p, k / DRAWN, k % DRAWN))
            continue;
        take_shape(p, k / DRAWN, k % DRAWN);
        draw_view_mesh(&p->view, &p->d->mesh, p->shape.vector, p->factor);
    }
    draw_view_fit(&p->view, 420, 320);
}

/*
 * Whether the shape at the end of phase k is drawn: in the last phase, and if the optimum changes
 * in the following phase. After a fault of a sensor, for example, the optimum stays the same.
 */
static bool is_worth_seeing(const simulation *simulation, int k)
{
    const double optimum = simulation->phase[k].optimum;
    return k + 1 == simulation->phases ||
           fabs(optimum - simulation->phase[k + 1].optimum) > 0.02 * optimum;
}

static int draw_phase(simulate_page *p, int k)
{
    int failed = 0;
    char name[SIMULATE_PHASE_TEXT];
    simulate_words_phase(p->s, &p->s->phase[k], name);
    put(p->file,
        "<article class=\"set\">\n<h3>Tick %d: end of “%t”</h3>\n<div class=\"row two\">"
        "\n",
        p->s->phase[k].until - 1, name);
    for (int law = 0; law < DRAWN; law++) {
        if (has_diverged(p, k, law)) {
            put(p->file, "<figure><h3>%s: diverged</h3></figure>\n", law_name[law]);
            continue;
        }
        take_shape(p, k, law);
        put(p->file, "<figure><h3>%s %p</h3>\n", law_name[law], p->s->phase[k].course[law].steady);
        failed |= page_shape_draw(p->file, &p->shape, &p->view, p->d, p->factor, &p->misfit);
        fputs("</figure>\n", p->file);
    }
    fputs("</div>\n</article>\n", p->file);
    return failed;
}

static int write_shapes(simulate_page *p)
{
    int failed = 0;
    fit_shapes(p);
    page_keys(p->file, &p->d->mesh, "");
    for (int k = 0; k < p->s->phases; k++)
        if (is_worth_seeing(p->s, k))
            failed |= draw_phase(p, k);
    fputs("<p class=\"soft\">Misfit, reached minus target, on one scale; ", p->file);
    page_magnified(p->file, &p->d->mesh, p->factor);
    fputs(".</p>\n", p->file);
    draw_legend(p->file, &p->misfit);
    return failed;
}

/* ---- page ------------------------------------------------------------- */

static page_set last_voltages(const void *context, int k)
{
    const simulate_page *p = context;
    return (page_set){"At the last tick",
                      p->s->phase[p->s->phases - 1 - k].course[LAW_CONTROLLER].voltage};
}

static int write_page(const report_job *job, simulate_page *p)
{
    page_begin(job, p->s->nominal, "The controller in closed loop",
               p->s->nominal->model.info.residual);
    write_verdict(p);
    fputs("<section>\n<h2>Over time</h2>\n", p->file);
    write_plant(p);
    write_certificate(p);
    write_errors(p);
    write_voltages(p);
    page_voltages(p->file, p->d, 1, last_voltages, p);
    fputs("</section>\n<section>\n<h2>Phases</h2>\n", p->file);
    write_phases(p);
    write_counts(p);
    fputs("</section>\n<section>\n<h2>Shapes</h2>\n", p->file);
    const int failed = write_shapes(p);
    fputs("</section>\n", p->file);
    page_source(p->file, p->s->nominal, "The controller’s model");
    page_end(job);
    return failed;
}

static int write_picture(const report_job *job, const simulate_page *p)
{
    picture_begin(job, p->scene,
                  "relative RMS error over time: controller bold, clipped grey, "
                  "optimum of the plant dashed",
                  RIGHT, BOTTOM + FOOT);
    draw_errors(p);
    picture_end(job, RIGHT, BOTTOM + FOOT);
    return 0;
}

int report_simulate(const report_job *job, const simulation *simulation,
                    const simulate_record *record)
{
    const design *design = &simulation->nominal->design;
    simulate_page p = {.file = job->file,
                       .s = simulation,
                       .r = record,
                       .scene = design->scene,
                       .d = design,
                       .time = {0, record->ticks, LEFT, RIGHT, false, "%n", {1, ""}}};
    int failed = page_shape_open(&p.shape, &design->mesh);
    p.aim = calloc((size_t)design->targets + 1, sizeof *p.aim);
    failed |= p.aim ? 0 : -1;
    if (!failed)
        failed = job->is_svg ? write_picture(job, &p) : write_page(job, &p);
    page_shape_close(&p.shape);
    free(p.aim);
    return failed || ferror(job->file) ? -1 : 0;
}
