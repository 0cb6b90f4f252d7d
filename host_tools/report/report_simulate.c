/* SPDX-License-Identifier: BSD-2-Clause */
/* Report page of `pzs simulate` (report.h). */
#include <math.h>
#include "../simulate/simulate_words.h"
#include "report_page.h"

static void write_verdict(const page *page)
{
    const simulation *simulation = page->simulation;
    const simulate_phase *worst = simulation->phase;
    double above = -1;
    char name[SIMULATE_PHASE_TEXT];
    for (int k = 0; k < simulation->phases; k++) {
        const simulate_phase *phase = &simulation->phase[k];
        const double here = phase->course[LAW_CONTROLLER].steady / phase->optimum - 1;
        worst = here > above ? phase : worst;
        above = fmax(above, here);
    }
    simulate_words_phase(simulation, worst, name);
    put(page->file,
        "<p class=\"verdict\"><b>%d %ss beyond a limit or the step limit</b> in %d ticks; at "
        "the end of a phase the relative RMS error is at most %p above the optimum for that plant "
        "in the same limits (“%t”, from tick %d).</p>\n",
        (int)simulation->count[LAW_CONTROLLER].beyond_limits, page->inputs.name,
        page->record->ticks, fmax(above, 0), name, worst->from);
}

static void write_phases(const page *page)
{
    char text[SIMULATE_TEXT];
    simulate_words_columns(page->simulation, text);
    put(page->file,
        PUT_TABLE("Relative RMS errors; %t",
                  "^Tick^~Events^Optimum^Steady^Vibration^Clipped^Regularised,<br/>clipped^Worst"
                  "^Settled^Step limit"),
        text);
    for (int k = 0; k < page->simulation->phases; k++) {
        const simulate_phase *phase = &page->simulation->phase[k];
        const simulate_course *course = phase->course;
        simulate_words_phase(page->simulation, phase, text);
        put(page->file, PUT_ROW("%d|~%t|%p|%p|%p|%p|%p|%p|%n|%d"), phase->from, text,
            phase->optimum, course[LAW_CONTROLLER].steady, course[LAW_CONTROLLER].vibration,
            course[LAW_CLAMP].steady, course[LAW_REGULARISED].steady, course[LAW_CONTROLLER].worst,
            course->settled < 0 ? (double)NAN : course->settled, course->step_limit_ticks);
    }
    put(page->file, PUT_TABLE_END);
}

static void write_counts(const page *page)
{
    static const char *const law_name[LAWS] = {"Controller", "Clipped least squares",
                                               "Regularised, then clipped"};
    put(page->file,
        PUT_TABLE("Ticks of all laws",
                  "^Law^%ss beyond limit or step limit^Limits between amplifiers violated^Not "
                  "finite^Missed ticks^Held^A sensor rejected^Out of iterations^Most iterations"),
        page->inputs.title);
    for (int law = 0; law < LAWS; law++) {
        const simulate_count *count = &page->simulation->count[law];
        put(page->file, PUT_ROW("%s|%d|%d|%d|%d|%d|%d|%d|%d"), law_name[law],
            (int)count->beyond_limits, (int)count->beyond_rows, (int)count->not_finite,
            (int)count->missed_ticks, (int)count->status[PZS_W_HELD],
            (int)count->status[PZS_W_SENSOR], (int)count->status[PZS_W_ITERATIONS],
            count->iterations_most);
    }
    put(page->file, PUT_TABLE_END);
}

static void write_plant(const page *page)
{
    FILE *file = page->file;
    const certificate *certificate = &page->simulation->nominal->certificate;
    char text[SIMULATE_TEXT], stability[CERTIFICATE_TEXT];
    simulate_words_plant(page->simulation, text);
    put(file, "<p class=\"lines\">%t</p>\n", text);
    if (!certificate->is_made)
        return;
    simulate_words_inertia(&page->simulation->plant, text);
    certificate_text(certificate, stability);
    put(file, "<p class=\"lines\">%t. ", text);
    if (certificate->has_modes)
        put(file, "First natural frequency %q. %t</p>\n", certificate_first(certificate), "Hz",
            stability);
    else
        put(file, "Vibration is not known: %t</p>\n", certificate->reason);
}

/*
 * Position of the rectangle of a diagram over time in its picture (pixels): TOP, BOTTOM, LEFT and
 * RIGHT are the coordinates of its sides; FOOT is the height of the text below it.
 */
enum { TOP = 8, BOTTOM = 250, FOOT = 34, LEFT = 64, RIGHT = 1150 };

/* Draw the frame of a diagram over time, the phases, and the numbers of the axis. */
static void draw_time(const page *page, const draw_diagram *diagram)
{
    FILE *file = page->file;
    const double bottom = diagram->y.from;
    put(file, "<rect class=\"frame\" x=\"%d\" y=\"%d\" width=\"%d\" height=\"%f\"/>\n", LEFT, TOP,
        RIGHT - LEFT, bottom - TOP);
    draw_grid(file, diagram, true);
    put(file, DRAW_PATH, "rest ghost");
    for (int k = 1; k < page->simulation->phases; k++)
        put(file, "M%f %dV%f", draw_on(&diagram->x, page->simulation->phase[k].from), TOP, bottom);
    put(file, DRAW_PATH_END);
    put(file, PUT_TEXT("tick, of %q in all"), "end", (double)RIGHT, bottom + 28,
        page->record->ticks / page->design->control.rate, "s");
}

/* Return the diagram over time whose rectangle ends at y = bottom (pixels). */
static draw_diagram diagram_of(const page *page, double bottom)
{
    return (draw_diagram){.x = {0, page->record->ticks, LEFT, RIGHT, false, {1, ""}},
                          .y = {HUGE_VAL, 0, bottom, TOP, true, {100, "%"}}};
}

static void draw_errors(const page *page)
{
    FILE *file = page->file;
    const simulation *simulation = page->simulation;
    const simulate_record *record = page->record;
    const int estimated = simulation->estimates ? record->bins : 0;
    const int vibrating = simulation->plant.has_inertia ? record->bins : 0;
    const draw_series curve[4] = {
        {"rest bold", NULL, record->error[LAW_CLAMP], record->bins, NULL, 0},
        {"wire bold", NULL, record->error[LAW_CONTROLLER], record->bins, NULL, 0},
        {"wire", NULL, record->measurement_error, estimated, NULL, 0},
        {"rest", NULL, record->vibration, vibrating, NULL, 0}};
    draw_diagram diagram = diagram_of(page, BOTTOM);
    draw_axis *axis = &diagram.y;
    diagram.series = curve;
    diagram.count = 4;
    draw_fit(&diagram);
    for (int k = 0; k < simulation->phases; k++)
        draw_widen(axis, &simulation->phase[k].optimum, 1);
    axis->high = axis->high > 0 ? axis->high : 1;
    axis->low = 0.8 * fmin(fmax(axis->low, 1e-6 * axis->high), axis->high / 2);
    draw_grid(file, &diagram, false);
    draw_time(page, &diagram);
    draw_curves(file, &diagram);
    for (int k = 0; k < simulation->phases; k++) {
        const simulate_phase *phase = &simulation->phase[k];
        const double ends[2] = {phase->from, phase->until};
        const double optimum[2] = {phase->optimum, phase->optimum};
        draw_curve(file, &diagram, &(draw_series){"outline", ends, optimum, 2, NULL, 0});
    }
}

static void write_errors(const page *page)
{
    const simulate_record *record = page->record;
    fputs("<figure>\n", page->file);
    draw_begin(page->file, DRAW_CHART, RIGHT + 10, BOTTOM + FOOT, "Relative RMS error over time",
               "Of the controller and of clipped least squares, with the optimum of each phase");
    draw_errors(page);
    draw_end(page->file, DRAW_CHART);
    put(page->file,
        PAGE_CAPTION(
            "<span class=\"keys\">%s</span> Relative RMS error, logarithmic, the largest of "
            "every %d ticks; thin: error of the estimate; thin grey: vibration, the "
            "distance from the equilibrium."),
        PAGE_KEY("line", "controller") PAGE_KEY("gone", "clipped")
            PAGE_KEY("dash", "optimum of the plant"),
        (record->ticks + record->bins - 1) / record->bins);
}

/* Whether the voltage of an amplifier is at a limit at the end of a bin of recorded ticks. */
static bool is_active(const simulate_record *record, int amplifier, int bin)
{
    const double voltage = record->voltage[bin * record->amplifiers + amplifier];
    return voltage <= record->lower[amplifier] || voltage >= record->upper[amplifier];
}

/* Draw the voltage of an amplifier over time as a row of colours, height pixels high. */
static void draw_row(const page *page, int amplifier, const draw_axis *time,
                     const draw_scale *scale, double y, double height)
{
    const simulate_record *record = page->record;
    const double *voltage = record->voltage + amplifier;
    const double part = (double)record->ticks / record->bins;
    for (int i = 0, end; i < record->bins; i = end) {
        const char *colour = draw_colour(scale, voltage[i * record->amplifiers]);
        const bool has_line = is_active(record, amplifier, i);
        for (end = i + 1; end < record->bins; end++)
            if (draw_colour(scale, voltage[end * record->amplifiers]) != colour ||
                is_active(record, amplifier, end) != has_line)
                break;
        const double from = draw_on(time, i * part), to = draw_on(time, end * part);
        put(page->file, "<path class=\"%s\" d=\"M%f %fH%fv%fH%fz\"/>", colour, from, y, to, height,
            from);
        if (has_line)
            put(page->file, "<path class=\"at\" d=\"M%f %fH%f\"/>", from, y + height / 2, to);
    }
}

static void write_voltages(const page *page)
{
    FILE *file = page->file;
    const int rows = page->record->amplifiers;
    const double height = fmax(4, fmin(14, 420.0 / rows)), bottom = TOP + height * rows;
    const draw_diagram diagram = diagram_of(page, bottom);
    draw_scale scale = {true, 0, page->inputs.unit};
    for (int k = 0; k < page->record->bins; k++)
        shell_extend(&scale, page->design, page->record->voltage + k * rows);
    char title[64];
    snprintf(title, sizeof title, "%ss of the amplifiers over time", page->inputs.title);
    fputs("<figure>\n", file);
    draw_begin(file, DRAW_CHART, RIGHT + 10, bottom + FOOT, title,
               "A row for each amplifier, with a line where a limit is active");
    fputs("<g class=\"flat\">\n", file);
    for (int k = 0; k < rows; k++) {
        draw_row(page, k, &diagram.x, &scale, TOP + height * k, height);
        draw_name(file, LEFT - 6, TOP + height * k, height, page->design->amplifier_name[k]);
    }
    fputs("</g>\n", file);
    draw_time(page, &diagram);
    draw_end(file, DRAW_CHART);
    put(file,
        "<figcaption>%ss of the amplifiers under the controller, a row each; the line within marks "
        "active limits.",
        page->inputs.title);
    page_legend(page, &scale);
}

static const simulate_phase *last_phase(const page *page)
{
    return &page->simulation->phase[page->simulation->phases - 1];
}

static void fit_shape(page *page)
{
    page->scale = page_shape(page, page->result, last_phase(page)->target);
    page->space.factor = view_magnification(page->mesh, page->largest, 0.3);
    page_include(page);
    view_fit(&page->space.view, 600, 400, 180);
}

static void write_shape(const page *page)
{
    page_keys(page, "");
    fputs("<figure class=\"chart\">\n", page->file);
    page_draw_shape(page, &page->scale);
    put(page->file,
        "<figcaption>Reached shape and <b>target</b> at the last tick, displacement <b>× %n</b>, "
        "relative RMS error <b>%p</b>. Misfit, reached minus target:",
        page->space.factor, last_phase(page)->course[LAW_CONTROLLER].steady);
    page_legend(page, &page->scale);
}

static void write_page(page *page)
{
    page_begin(page, "The controller in closed loop", page->analysis->model.info.residual);
    write_verdict(page);
    fputs("<h2>Over time</h2>\n", page->file);
    write_plant(page);
    write_errors(page);
    write_voltages(page);
    page_voltages(page, page->result, 1);
    fputs("<h2>Phases</h2>\n", page->file);
    write_phases(page);
    write_counts(page);
    fputs("<h2>Shape</h2>\n", page->file);
    write_shape(page);
}

static void write_picture(page *page)
{
    page_begin_picture(page,
                       "relative RMS error over time: controller bold, clipped grey, optimum of "
                       "the plant dashed",
                       RIGHT, BOTTOM + FOOT);
    draw_errors(page);
}

int report_simulate(const report_job *job, const simulation *simulation,
                    const simulate_record *record)
{
    const simulate_course *course =
        &simulation->phase[simulation->phases - 1].course[LAW_CONTROLLER];
    const voltages last = {.name = "At the last tick",
                           .voltage = course->voltage,
                           .displacement = course->displacement,
                           .shape = course->shape};
    page page = {.result = &last, .simulation = simulation, .record = record};
    return page_write(&page, job, simulation->nominal, fit_shape, write_page, write_picture);
}
