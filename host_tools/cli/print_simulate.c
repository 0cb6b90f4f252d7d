/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of a simulation as text, JSON and CSV (print_simulate.h). */
#include "print_simulate.h"
#include <math.h>
#include "print_head.h"
#include "print_vibration.h"
#include "../system/progress.h"
#include "../simulate/imperfections_scene.h"
#include "../simulate/plant_motion.h"
#include "../simulate/simulate_words.h"
#include "../text/words.h"

static const double two_pi = 6.283185307179586;

static const char *const law_name[LAWS] = {"controller", "clipped", "regularised"};

/* ---- CSV -------------------------------------------------------------- */

static void print_csv_head(FILE *file, const design *design, int estimates)
{
    fprintf(file, "tick,time,error,vibration,active,iterations,status,missed_tick%s",
            estimates ? ",measurement_error" : "");
    for (int k = 0; k < design->amplifiers; k++)
        fprintf(file, ",%s", design->amplifier_name[k]);
    fputc('\n', file);
}

static void print_csv_tick(FILE *file, const design *design, int estimates,
                           const simulate_sample *sample)
{
    fprintf(file, "%d,%.9g,%.17g,%.17g,%d,%d,%d,%d", sample->tick,
            sample->tick / design->control.rate, sample->error, sample->vibration, sample->active,
            sample->iterations, (int)sample->status, sample->is_missed);
    if (estimates)
        fprintf(file, ",%.17g", sample->measurement_error);
    for (int k = 0; k < design->amplifiers; k++)
        fprintf(file, ",%.17g", sample->voltage[k]);
    fputc('\n', file);
}

/* ---- output during the run --------------------------------------------- */

typedef struct receivers {
    const design *design;
    const simulate_sinks *sinks;
    bool estimates;
} receivers;

static void receive_tick(void *context, const simulate_sample *sample)
{
    receivers *receivers = context;
    record_tick(receivers->sinks->record, sample);
    if (receivers->sinks->history && sample->law == LAW_CONTROLLER)
        history_add(receivers->sinks->history, receivers->design, sample);
    if (receivers->sinks->csv && sample->law == LAW_CONTROLLER)
        print_csv_tick(receivers->sinks->csv, receivers->design, receivers->estimates, sample);
    progress_count(sample->tick + 1, receivers->design->simulate.ticks);
}

int print_run(simulation *simulation, const simulate_sinks *sinks, char *error)
{
    receivers receivers = {&simulation->nominal->design, sinks, simulation->estimates};
    if (sinks->csv)
        print_csv_head(sinks->csv, receivers.design, simulation->estimates);
    progress_stage("simulating the controller");
    if (simulate_run(simulation, LAW_CONTROLLER, receive_tick, &receivers, error) < 0)
        return -1;
    progress_stage("simulating clipped voltages");
    if (simulate_run(simulation, LAW_CLAMP, receive_tick, &receivers, error) < 0)
        return -1;
    progress_stage("simulating regularised, then clipped voltages");
    if (simulate_run(simulation, LAW_REGULARISED, receive_tick, &receivers, error) < 0)
        return -1;
    progress_stage("optimum of each phase");
    return simulate_optima(simulation, error);
}

/* ---- text ------------------------------------------------------------- */

static void print_plant(const simulation *simulation)
{
    char text[SIMULATE_TEXT];
    simulate_words_inertia(&simulation->plant, text);
    printf("  %s\n", text);
    print_certificate(&simulation->nominal->certificate);
    simulate_words_plant(simulation, text);
    printf("  %s\n\n", text);
}

static void print_settled(const simulate_phase *phase)
{
    const simulate_course *course = &phase->course[LAW_CONTROLLER];
    if (course->settled < 0)
        printf("%9s", "-");
    else
        printf("%9d", course->settled);
    printf(" %6d", course->step_limit_ticks);
}

/* Print a relative error (%) in a column of a table, or that the control law has diverged. */
static void print_share(int width, double value)
{
    if (isinf(value))
        printf(" %*s", width + 1, "diverges");
    else
        printf(" %*.3f%%", width, 100 * value);
}

static void print_phases(const simulation *simulation)
{
    printf("  %-7s %-46s %9s %9s %9s %9s %11s %9s %9s %6s\n", "tick", "phase", "optimum", "steady",
           "vibration", "clipped", "regularised", "worst", "settled", "limit");
    for (int k = 0; k < simulation->phases; k++) {
        const simulate_phase *phase = &simulation->phase[k];
        char name[SIMULATE_PHASE_TEXT];
        simulate_words_phase(simulation, phase, name);
        const simulate_course *course = phase->course;
        printf("  %-7d %-46.46s", phase->from, name);
        print_share(8, phase->optimum);
        print_share(8, course[LAW_CONTROLLER].steady);
        print_share(8, course[LAW_CONTROLLER].vibration);
        print_share(8, course[LAW_CLAMP].steady);
        print_share(10, course[LAW_REGULARISED].steady);
        print_share(8, course[LAW_CONTROLLER].worst);
        putchar(' ');
        print_settled(phase);
        putchar('\n');
    }
    char text[SIMULATE_TEXT];
    simulate_words_columns(simulation, text);
    printf("\n  %s\n", text);
}

/*
 * Return the largest value of a recorded quantity in one of `parts` equal parts of the simulated
 * time.
 */
static double largest(const simulate_record *record, const double *value, int part, int parts)
{
    double most = 0;
    for (int i = part * record->bins / parts; i < (part + 1) * record->bins / parts; i++)
        most = fmax(most, value[i]);
    return most;
}

/*
 * Print the largest shape error and the largest vibration of the structure under the controller in
 * each part of the simulated time.
 */
static void print_history(const simulate_record *record, double rate)
{
    enum { COLUMNS = 12 };
    const int parts = record->bins < COLUMNS ? record->bins : COLUMNS;
    const double *const row[] = {record->error[LAW_CONTROLLER], record->vibration};
    static const char *const name[] = {"error", "vibration"};
    printf("\n  %-14s", "until (s)");
    for (int i = 0; i < parts; i++)
        printf(" %7.3g", (double)record->ticks * (i + 1) / parts / rate);
    for (int k = 0; k < 2; k++) {
        printf("\n  %-9s (%%) ", name[k]);
        for (int i = 0; i < parts; i++)
            printf(" %7.3g", 100 * largest(record, row[k], i, parts));
    }
    puts("\n  largest of the controller in each part of the time\n");
}

static void print_count(const simulation *simulation, simulate_law law)
{
    const simulate_count *count = &simulation->count[law];
    const long run = simulate_ran(count);
    printf("  %-11s %ld voltages beyond a limit or the step limit, %ld not finite; %ld ticks run, "
           "%ld missed, %ld held, %ld with a rejected sensor, "
           "%ld at the work limit\n",
           law_name[law], count->beyond_limits, count->not_finite, run, count->missed_ticks,
           count->status[PZS_W_HELD], count->status[PZS_W_SENSOR], count->status[PZS_W_ITERATIONS]);
    if (simulation->nominal->design.limits.rows > 0)
        printf("  %-11s %ld limits between amplifiers violated\n", "", count->beyond_rows);
    if (law == LAW_CONTROLLER)
        printf("  %-10s iterations of the optimiser: %.2f a tick, %d at most\n", "",
               run ? (double)count->iterations / (double)run : 0, count->iterations_most);
}

/*
 * Print that the self-test of amplifiers, cables and sensors, which runs before the first tick of
 * the simulation, has found no faults, and which amplifiers and sensors it could not test.
 */
static void print_selftest(const simulation *simulation)
{
    char text[SCENE_ERROR];
    if (!simulation->wiring.is_used)
        return;
    const int amplifiers = simulation->nominal->design.amplifiers;
    const int tested = wiring_test_tested(&simulation->wiring);
    wiring_test_text(&simulation->wiring, simulation->nominal, text);
    printf("  %s: passed", text);
    if (tested < amplifiers)
        printf(" by %d of %d amplifiers, the others not tested", tested, amplifiers);
    wiring_test_remarks(&simulation->wiring, simulation->nominal, text);
    putchar('\n');
    if (*text)
        printf("  warning: self-test: %s\n", text);
}

/*
 * Write the results of the self-test of amplifiers, cables and sensors, which runs before the first
 * tick of the simulation, as JSON.
 */
static void json_selftest(json *json, const simulation *simulation)
{
    char text[SCENE_ERROR];
    const bool is_disturbed = simulation->verdict == PZS_SELFTEST_DISTURBED;
    const char *refused = is_disturbed ? "disturbed" : "faulty";
    if (!simulation->wiring.is_used)
        return;
    wiring_test_remarks(&simulation->wiring, simulation->nominal, text);
    json_open(json, "selftest", '{');
    json_string(json, "verdict", *simulation->findings ? refused : "passed");
    json_string(json, "findings", simulation->findings);
    json_number(json, "tested", wiring_test_tested(&simulation->wiring));
    json_number(json, "ticks", wiring_test_ticks(&simulation->wiring));
    json_number(json, "pulse_ticks", simulation->wiring.tables.pulse_ticks);
    json_string(json, "remarks", text);
    json_close(json, '}');
}

/* Print the largest error of the shape that the controller estimates from few sensors. */
static void print_estimated(const simulation *simulation)
{
    const simulate_phase *worst = simulation->phase;
    if (!simulation->estimates)
        return;
    for (int k = 1; k < simulation->phases; k++)
        worst = simulation->phase[k].course[LAW_CONTROLLER].measurement_error >
                        worst->course[LAW_CONTROLLER].measurement_error
                    ? &simulation->phase[k]
                    : worst;
    printf("  %-10s %d nodes estimated from %d sensors: off by %.3f%% of the target at the end of "
           "the phase from tick %d, less in the "
           "others\n",
           "", simulation->nominal->design.targets, simulation->estimator.sensors,
           100 * worst->course[LAW_CONTROLLER].measurement_error, worst->from);
}

static void print_detected(const simulation *simulation)
{
    const simulate_count *count = &simulation->count[LAW_CONTROLLER];
    if (simulation->nominal->design.simulate.detects_faults)
        printf("  %-10s electrodes found not to follow: %ld, the slowest after %d ticks; %ld of "
               "them in good order\n",
               "", count->detected, count->detection_ticks, count->falsely_detected);
}

static void print_board(const simulation *simulation)
{
    const simulate_count *count = &simulation->count[LAW_CONTROLLER];
    if (!simulation->board)
        return;
    printf("  %-10s the firmware of %s, %s", "", simulation->board->name,
           simulation->board->bits == 32 ? "float" : "double");
    if (simulation->board->twin)
        printf(", under QEMU: %ld of %ld ticks with the bits of the same C on this computer",
               count->agreeing_ticks, simulate_ran(count));
    putchar('\n');
}

void print_simulation(const simulation *simulation, const simulate_record *record)
{
    print_head(simulation->nominal, simulate_words_influence(&simulation->nominal->design));
    print_plant(simulation);
    print_phases(simulation);
    if (simulation->plant.has_inertia)
        print_history(record, simulation->nominal->design.control.rate);
    print_selftest(simulation);
    print_count(simulation, LAW_CONTROLLER);
    print_estimated(simulation);
    print_detected(simulation);
    print_board(simulation);
    print_count(simulation, LAW_CLAMP);
    print_count(simulation, LAW_REGULARISED);
    double seconds = 0;
    for (int law = 0; law < LAWS; law++)
        seconds += simulation->count[law].seconds;
    printf("  %.2f s, %ld linear solves of the plant\n", seconds,
           simulation->plant.linear_solves + simulation->plant.shell_motion.linear_solves);
}

/* ---- JSON ------------------------------------------------------------- */

static void json_course(json *json, const simulation *simulation, const simulate_course *course,
                        simulate_law law)
{
    json_open(json, law_name[law], '{');
    json_number(json, "steady", course->steady);
    json_number(json, "worst", course->worst);
    json_number(json, "vibration", course->vibration);
    json_number(json, "vibration_worst", course->vibration_worst);
    if (simulation->estimates)
        json_number(json, "measurement_error", course->measurement_error);
    json_number(json, "settled", course->settled);
    json_number(json, "step_limit_ticks", course->step_limit_ticks);
    json_numbers(json, "voltages", course->voltage, simulation->nominal->design.amplifiers);
    json_close(json, '}');
}

static void json_phase(json *json, const simulation *simulation, const simulate_phase *phase)
{
    char name[SIMULATE_PHASE_TEXT];
    simulate_words_phase(simulation, phase, name);
    json_open(json, NULL, '{');
    json_string(json, "phase", name);
    json_number(json, "from", phase->from);
    json_number(json, "until", phase->until);
    json_number(json, "optimum", phase->optimum);
    for (int law = 0; law < LAWS; law++)
        json_course(json, simulation, &phase->course[law], (simulate_law)law);
    json_close(json, '}');
}

static void json_count(json *json, const simulate_count *count, simulate_law law)
{
    json_open(json, law_name[law], '{');
    json_number(json, "beyond", (double)count->beyond_limits);
    json_number(json, "beyond_rows", (double)count->beyond_rows);
    json_number(json, "not_finite", (double)count->not_finite);
    json_number(json, "ran", (double)simulate_ran(count));
    json_number(json, "missed_ticks", (double)count->missed_ticks);
    json_number(json, "held", (double)count->status[PZS_W_HELD]);
    json_number(json, "rejected", (double)count->status[PZS_W_SENSOR]);
    json_number(json, "out_of_iterations", (double)count->status[PZS_W_ITERATIONS]);
    json_number(json, "detected", (double)count->detected);
    json_number(json, "falsely_detected", (double)count->falsely_detected);
    json_number(json, "detection_ticks", count->detection_ticks);
    json_number(json, "iterations", (double)count->iterations);
    json_number(json, "iterations_most", count->iterations_most);
    json_close(json, '}');
}

/*
 * Write the vibration modes and the damping of the plant, and its deviations from the controller's
 * model, as JSON.
 */
static void json_plant(json *json, const simulation *simulation)
{
    const plant *plant = &simulation->plant;
    char imperfections[400];
    imperfections_text(&simulation->nominal->design, imperfections, sizeof imperfections);
    json_open(json, "plant_modes", '{');
    json_number(json, "count", (double)plant->modal.modes);
    if (plant->has_inertia) {
        json_number(json, "first", plant->modal.frequency[0] / two_pi);
        json_number(json, "damping", plant->modal.damping[0]);
    } else {
        json_string(json, "none_because", plant->reason);
    }
    json_close(json, '}');
    json_string(json, "motion", plant->motion->name);
    if (plant->shell_motion.step_most > 0)
        json_number(json, "steps_a_tick",
                    1 / (plant->shell_motion.step_most * plant->analysis.design.control.rate));
    json_string(json, "imperfections", imperfections);
}

/*
 * Write the largest shape error and the largest vibration of the structure under the controller, in
 * each interval of the time axis, as JSON.
 */
static void json_history(json *json, const simulate_record *record, double rate)
{
    json_open(json, "history", '{');
    json_number(json, "interval", (double)record->ticks / record->bins / rate);
    for (int law = 0; law < LAWS; law++)
        json_numbers(json, law_name[law], record->error[law], record->bins);
    json_numbers(json, "vibration", record->vibration, record->bins);
    json_close(json, '}');
}

void print_simulation_json(const simulation *simulation, const simulate_record *record)
{
    const design *design = &simulation->nominal->design;
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    json_string(&json, "scene", design->name);
    json_string(&json, "plant", simulation->plant.analysis.is_nonlinear ? "nonlinear" : "linear");
    json_string(&json, "dynamics", simulation->plant.has_inertia ? "inertia" : "quasi-static");
    json_plant(&json, simulation);
    print_certificate_json(&json, &simulation->nominal->certificate);
    json_number(&json, "ticks", design->simulate.ticks);
    if (simulation->board) {
        json_string(&json, "device", simulation->board->name);
        json_number(&json, "device_bits", simulation->board->bits);
        json_number(&json, "device_same", (double)simulation->count[LAW_CONTROLLER].agreeing_ticks);
    }
    if (simulation->estimates)
        print_estimate_json(&json, &simulation->estimator);
    json_number(&json, "amplifiers", simulation->nominal->design.amplifiers);
    json_number(&json, "targets", simulation->nominal->design.targets);
    json_number(&json, "regularisation", simulation->regularisation);
    json_selftest(&json, simulation);
    json_open(&json, "phases", '[');
    for (int k = 0; k < simulation->phases; k++)
        json_phase(&json, simulation, &simulation->phase[k]);
    json_close(&json, ']');
    json_open(&json, "counts", '{');
    for (int law = 0; law < LAWS; law++)
        json_count(&json, &simulation->count[law], (simulate_law)law);
    json_close(&json, '}');
    json_history(&json, record, design->control.rate);
    plausible_json(&json, &simulation->nominal->warnings);
    json_close(&json, '}');
}

void print_refusal_json(const simulation *simulation)
{
    json json = {.file = stdout};
    if (!*simulation->findings)
        return;
    json_open(&json, NULL, '{');
    json_string(&json, "scene", simulation->nominal->design.name);
    json_selftest(&json, simulation);
    json_close(&json, '}');
}
