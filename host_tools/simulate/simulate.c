/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Simulation of the closed loop: its phases (time between events of the scene), its control laws
 * and its results (simulation.h).
 */
#include "simulation.h"
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../model/certificate_make.h"
#include "../model/clipped.h"
#include "../model/modal_gains.h"
#include "../model/output_calls.h"
#include "certify.h"
#include "../../lib/core/guard.h"
#include "../tables/loop_blocks.h"
#include "simulate_loop.h"
#include "../tables/tables.h"

enum {
    LAST = 20,       /* smallest number of ticks over which the results at the end of a phase (time
                        between events of the scene) are averaged */
    LAST_MOST = 500, /* largest number of ticks over which the results at the end of a phase (time
                        between events of the scene) are averaged. The number is one period of the
                        first vibration mode, between LAST and LAST_MOST */
    WINDOW = 1000    /* number of ticks after an event in which the settling time is measured */
};

static const double settled_part = 0.05;

/*
 * Shape error, relative to the norm of the target, above which the simulation of a control law for
 * comparison is stopped.
 */
static const double diverged = 4;

static int no_memory(const analysis *nominal, char *error)
{
    return scene_fault(nominal->design.simulate.at, error, "out of memory");
}

/* ---- preparation of the simulation ------------------------------------ */

static int allocate_course(simulate_course *course, const design *design)
{
    course->voltage = calloc((size_t)design->amplifiers, sizeof *course->voltage);
    course->shape = calloc((size_t)design->targets, sizeof *course->shape);
    course->displacement = calloc((size_t)design->mesh.free_dof, sizeof *course->displacement);
    return course->voltage && course->shape && course->displacement;
}

/*
 * Add a phase (interval between events of the scene) that lasts from a tick to the end of the
 * simulation. Returns whether memory was available.
 */
static int begin_phase(simulation *simulation, int tick, int first)
{
    const design *design = &simulation->plant.analysis.design;
    simulate_phase *phase = &simulation->phase[simulation->phases++];
    if (simulation->phases > 1)
        phase[-1].until = tick;
    phase->from = tick;
    phase->until = design->simulate.ticks;
    phase->first = first;
    phase->optimum = (double)NAN;
    bool rooms = true;
    for (int law = 0; law < LAWS; law++)
        rooms = allocate_course(&phase->course[law], design) && rooms;
    phase->target = calloc((size_t)design->targets, sizeof *phase->target);
    phase->load = calloc((size_t)design->loads + 1, sizeof *phase->load);
    phase->lowest = calloc(2 * (size_t)design->amplifiers, sizeof *phase->lowest);
    phase->highest = phase->lowest ? phase->lowest + design->amplifiers : NULL;
    return rooms && phase->target && phase->load && phase->lowest;
}

/*
 * Divide the simulation into phases (time intervals between events). A phase begins at the first
 * tick, at every tick with events of the scene, and after the last tick in which electrodes may
 * fail at random. Returns whether memory was available.
 */
static int lay_out_phases(simulation *simulation)
{
    const scene_simulate *simulate = &simulation->nominal->design.simulate;
    int faults_end = simulate->fault_chance > 0 && simulate->fault_until < simulate->ticks
                         ? simulate->fault_until
                         : -1,
        good;
    simulation->phase = calloc((size_t)simulate->events + 2, sizeof *simulation->phase);
    good = simulation->phase != NULL && begin_phase(simulation, 0, 0);
    for (int k = 0; good && k < simulate->events; k++) {
        const int tick = simulate->event[k].tick;
        if (faults_end >= 0 && tick >= faults_end) {
            good = tick == faults_end || begin_phase(simulation, faults_end, k);
            faults_end = -1;
        }
        if (good && tick > simulation->phase[simulation->phases - 1].from)
            good = begin_phase(simulation, tick, k);
        simulation->phase[simulation->phases - 1].events++;
    }
    return good && faults_end >= 0 ? begin_phase(simulation, faults_end, simulate->events) : good;
}

/*
 * Refuse sensors that measure voltages or charges of electrodes, because at a deformed shape there
 * are no influence coefficients for these readings. Returns 0, or -1 with error filled.
 */
static int check_readings(const design *design, char *error)
{
    const scene_estimate *estimate = &design->estimate;
    for (int reading = 0; reading < estimate->readings; reading++)
        if (!output_has_rows(&design->output[estimate->reading[reading].output]))
            return scene_fault(estimate->reading[reading].at, error,
                               "'%s' is read by an electrode, whose gains are made in the "
                               "undeformed state; write influence: undeformed in simulate",
                               design->output[estimate->reading[reading].output].name);
    return 0;
}

/*
 * If the scene file asks for it, replace the influence matrix of the controller's model by that of
 * the structure deformed by the optimal voltages. Returns 0, or -1 with error filled.
 */
int simulate_tables(analysis *nominal, char *error)
{
    design *design = &nominal->design;
    voltages best;
    if (design->simulate.influence_at == INFLUENCE_UNDEFORMED)
        return 0;
    if (check_readings(design, error) < 0)
        return -1;
    if (design->simulate.influence_at == INFLUENCE_LOADED)
        return 0; /* nothing to do, because the matrix was computed at the equilibrium under the
                     scene's loads */
    memset(&best, 0, sizeof best);
    nominal->is_nonlinear = true;
    int failed =
        voltages_optimum(nominal, (common_limits){.source = LIMITS_SCENE}, &best, error) < 0 ||
        voltages_influence_at(nominal, &best, nominal->influence, error) < 0;
    double *column = calloc((size_t)design->targets, sizeof *column);
    if (!failed && !column)
        failed = no_memory(nominal, error);
    if (!failed)
        design_influence_free(design, nominal->influence, design->structure.input.count, column,
                              design->influence);
    free(column);
    design->problem.hessian = NULL;
    design->problem.crc = pzs_problem_crc(&design->problem);
    voltages_free(&best);
    failed = failed || modal_gains_make(design, error) < 0;
    return failed ? -1 : 0;
}

/*
 * Refuse a fault detector for a target with free functions (shapes that may be added to it at no
 * cost). The detector compares measured with predicted displacements, which lack these functions.
 * Returns 0, or -1 with error filled.
 */
static int check_free(const design *design, char *error)
{
    if (design->free_functions == 0 || !design->simulate.detects_faults)
        return 0;
    return scene_fault(
        design->simulate.at, error,
        "announced: detected does not work with target.free: the fault detector needs the whole "
        "predicted displacement; write announced: TICKS or remove target.free");
}

/*
 * Refuse events that have an effect only on a plant with inertia, where the plant has none. Returns
 * 0, or -1 with error filled.
 */
static int check_inertia(const simulation *simulation, char *error)
{
    const design *design = &simulation->nominal->design;
    for (int i = 0; i < design->simulate.events && !simulation->plant.has_inertia; i++) {
        const scene_event *event = &design->simulate.event[i];
        if (event->type == EVENT_IMPULSE || event->type == EVENT_LATE ||
            event->type == EVENT_JITTER)
            return scene_fault(event->at, error,
                               "this event needs a plant with inertia, which this one has not: %s",
                               simulation->plant.reason);
    }
    return 0;
}

/*
 * Prepare what the simulated controller consists of: shape estimator, feed-forward of known loads,
 * vibration damper, and the list of the blocks (stages) that each tick runs. Returns 0, or -1 with
 * error filled.
 */
static int prepare_controller(simulation *simulation, char *error)
{
    const design *design = &simulation->nominal->design;
    simulation->problem = &simulation->nominal->design.problem;
    simulation->estimates = loop_estimates(design);
    simulation->feeds = loop_feeds(design);
    const bool has_gate = sensor_gate_is_asked(design);
    if ((simulation->estimates || simulation->feeds || has_gate) &&
        estimator_open(&simulation->estimator, simulation->nominal, error) < 0)
        return -1;
    const estimator *few = simulation->estimates ? &simulation->estimator : NULL;
    if (damper_open(&simulation->damper, simulation->nominal, few, error) < 0)
        return -1;
    simulation->blocks = calloc(1, sizeof *simulation->blocks);
    if (!simulation->blocks)
        return no_memory(simulation->nominal, error);
    if (!wiring_test_open(&simulation->wiring, simulation->nominal, few) ||
        !wiring_test_detector_open(&simulation->pulses, simulation->nominal, few))
        return no_memory(simulation->nominal, error);
    simulation->gate = calloc(1, sizeof *simulation->gate);
    if (!simulation->gate || !loop_gate_open(simulation->gate, simulation->nominal,
                                             &simulation->estimator, &simulation->damper))
        return no_memory(simulation->nominal, error);
    loop_blocks_fill(simulation->blocks, &simulation->nominal->design, &simulation->estimator,
                     &simulation->damper);
    loop_blocks_test(simulation->blocks, &simulation->wiring, &simulation->pulses);
    loop_blocks_gate(simulation->blocks, simulation->gate);
    simulation->undamped_blocks = calloc(1, sizeof *simulation->undamped_blocks);
    if (!simulation->undamped_blocks)
        return no_memory(simulation->nominal, error);
    loop_blocks_fill(simulation->undamped_blocks, &simulation->nominal->design,
                     &simulation->estimator, &simulation->unused_damper);
    return 0;
}

/*
 * For regularised clipped least squares, a control law for comparison, find the regularisation
 * parameter that gives the least shape error for the scene's target. Returns 0, or -1 with error
 * filled.
 */
static int regularise(simulation *simulation, char *error)
{
    const design *design = &simulation->nominal->design;
    clipped clipped;
    double *voltage = calloc((size_t)design->amplifiers, sizeof *voltage);
    int failed =
        clipped_open(&clipped, design, design->lower, design->upper, design->wanted) < 0 || !voltage
            ? no_memory(simulation->nominal, error)
            : 0;
    const pzs_status status =
        failed ? PZS_OK : clipped_tune(&clipped, voltage, &simulation->regularisation);
    if (status != PZS_OK)
        failed = scene_fault(design->limits.at, error, "%s", pzs_status_text(status));
    simulation->compared_regularisation = simulation->regularisation * clipped.scale;
    clipped_close(&clipped);
    free(voltage);
    return failed;
}

/*
 * Make the tables of the controller for a simulation. As in `pzs tables`, they contain a vibration
 * model where the loop needs one, but never for a quasi-static plant. The loop starts by itself,
 * also where firmware would wait for a start command.
 */
static int make_tables(const simulation *simulation, analysis *nominal, char *error)
{
    nominal->design.safety.waits = false;
    if (!simulation->plant.has_inertia)
        nominal->quasi_static = true;
    if (!nominal->quasi_static)
        certificate_make(&nominal->certificate, nominal);
    return simulate_tables(nominal, error) < 0 || certify_loop(nominal, error) < 0 ? -1 : 0;
}

/*
 * Set the denominator of all relative errors: the weighted norm of the scene's target, or, where
 * the target is zero, that of the shape without voltages; 1 where both are zero.
 */
static void set_reference(simulation *simulation, const design *design)
{
    const double target = design_squares(design, design->target, NULL);
    const double squares = target > 0 ? target : design_squares(design, design->wanted, NULL);
    simulation->has_target = target > 0;
    simulation->reference = squares > 0 ? sqrt(squares) : 1;
}

int simulate_open(simulation *simulation, analysis *nominal, char *error)
{
    const design *design = &nominal->design;
    memset(simulation, 0, sizeof *simulation);
    simulation->nominal = nominal;
    if (imperfections_check(design, error) < 0 || check_free(design, error) < 0 ||
        plant_open(&simulation->plant, design, error) < 0)
        return -1;
    set_reference(simulation, design);
    int failed = lay_out_phases(simulation) ? 0 : no_memory(nominal, error);
    failed = failed || check_inertia(simulation, error) < 0 ||
             make_tables(simulation, nominal, error) < 0 ||
             prepare_controller(simulation, error) < 0 || regularise(simulation, error) < 0;
    if (failed)
        simulate_close(simulation);
    return failed ? -1 : 0;
}

static int write_tables(const simulation *simulation, char *error)
{
    char path[DEVICE_PATH + 16];
    tables_size size;
    snprintf(path, sizeof path, "%s/loop.h", simulation->folder);
    FILE *file = fopen(path, "w");
    int failed =
        !file || tables_write(file, simulation->nominal, TABLES_CONTROL, "demo", &size) < 0;
    failed |= file && fclose(file) != 0;
    if (failed)
        snprintf(error, SCENE_ERROR, "cannot write %.300s", path);
    return failed ? -1 : 0;
}

int simulate_device(simulation *simulation, const device_board *board, char *error)
{
    if (device_folder(simulation->folder, error) < 0 || write_tables(simulation, error) < 0 ||
        device_build(board, simulation->folder, error) < 0)
        return -1;
    simulation->board = board;
    return 0;
}

void simulate_close(simulation *simulation)
{
    for (int k = 0; k < simulation->phases; k++) {
        for (int law = 0; law < LAWS; law++) {
            free(simulation->phase[k].course[law].voltage);
            free(simulation->phase[k].course[law].shape);
            free(simulation->phase[k].course[law].displacement);
        }
        free(simulation->phase[k].target);
        free(simulation->phase[k].load);
        free(simulation->phase[k].lowest);
    }
    free(simulation->phase);
    estimator_close(&simulation->estimator);
    damper_close(&simulation->damper);
    wiring_test_close(&simulation->wiring);
    wiring_test_close(&simulation->pulses);
    if (simulation->gate)
        sensor_gate_close(simulation->gate);
    free(simulation->gate);
    free(simulation->blocks);
    free(simulation->undamped_blocks);
    device_remove(simulation->folder);
    plant_close(&simulation->plant);
    memset(simulation, 0, sizeof *simulation);
}

/* ---- results of a phase ------------------------------------------------ */

typedef struct course_log {
    double *window; /* [WINDOW][targets] shapes of the plant in the first WINDOW ticks of the phase
                       (interval between events) */
    double *last;   /* [end_ticks][targets] ring buffer of the shapes of the plant in the last ticks
                       of the phase (interval between events) */
    double *mean;  /* [targets] mean of the shapes at the end of the phase (interval between events)
                    */
    int end_ticks; /* number of ticks at the end of a phase (interval between events) over which the
                      results are averaged */
    double error[LAST_MOST], measurement_error[LAST_MOST], vibration[LAST_MOST];
    double *initial_voltage; /* [amplifiers] output voltages before the phase (interval between
                                events) of the simulation (V) */
    int ticks;
} course_log;

/*
 * Number of ticks at the end of a phase (interval between events) over which the results are
 * averaged. It covers at least one period of the first vibration mode, up to a limit, so that the
 * mean shape is the one about which the structure vibrates.
 */
static int ticks_of_end(const simulation *simulation)
{
    const double period =
        plant_period(&simulation->plant) * simulation->nominal->design.control.rate;
    return (int)fmin(fmax(ceil(period), LAST), LAST_MOST);
}

static int log_open(course_log *record, const simulation *simulation)
{
    const design *design = &simulation->nominal->design;
    const size_t targets = (size_t)design->targets;
    memset(record, 0, sizeof *record);
    record->end_ticks = ticks_of_end(simulation);
    record->window = calloc(WINDOW * targets, sizeof *record->window);
    record->last = calloc((size_t)record->end_ticks * targets, sizeof *record->last);
    record->mean = calloc(targets, sizeof *record->mean);
    record->initial_voltage = calloc((size_t)design->amplifiers, sizeof *record->initial_voltage);
    return record->window && record->last && record->mean && record->initial_voltage;
}

static void log_close(course_log *record)
{
    free(record->window);
    free(record->last);
    free(record->mean);
    free(record->initial_voltage);
}

static void log_tick(course_log *record, const loop *loop, simulate_course *course)
{
    const size_t targets = (size_t)loop->design->targets;
    if (record->ticks < WINDOW)
        memcpy(record->window + (size_t)record->ticks * targets, loop->shape,
               targets * sizeof *record->window);
    memcpy(record->last + (size_t)(record->ticks % record->end_ticks) * targets, loop->shape,
           targets * sizeof *record->last);
    record->error[record->ticks % record->end_ticks] = loop->error;
    record->measurement_error[record->ticks % record->end_ticks] = loop->measurement_error;
    record->vibration[record->ticks % record->end_ticks] = loop->vibration;
    course->vibration_worst = fmax(course->vibration_worst, loop->vibration);
    course->worst = fmax(course->worst, loop->error);
    record->ticks++;
}

/*
 * Return the norm, weighted with the output weights of the target, of the difference of two shapes.
 *   first, second [targets] in  displacements of the two shapes
 */
static double weighted_distance(const design *design, const double *first, const double *second)
{
    return sqrt(design_squares(design, first, second));
}

/*
 * Return the number of ticks after an event from which on the distance of the shape from the final
 * shape stays below a fraction of its largest value; -1 if it never does.
 */
static int settled_after(const course_log *record, const design *design)
{
    const size_t targets = (size_t)design->targets;
    const int ticks = record->ticks < WINDOW ? record->ticks : WINDOW;
    double most = 0;
    int after = 0;
    for (int k = 0; k < ticks; k++)
        most = fmax(most,
                    weighted_distance(design, record->window + (size_t)k * targets, record->mean));
    for (int k = 0; k < ticks; k++)
        if (weighted_distance(design, record->window + (size_t)k * targets, record->mean) >
            settled_part * most)
            after = k + 1;
    return after < ticks ? after : -1;
}

/*
 * Compute the mean errors, mean vibration and mean shape over the last ticks of a phase (interval
 * between events), which are at most a quarter of the phase.
 */
static void finish_course(course_log *record, const loop *loop, simulate_course *course)
{
    const design *design = loop->design;
    const int quarter = (record->ticks + 3) / 4,
              count = quarter < record->end_ticks ? quarter : record->end_ticks;
    double squares = 0, measurement_error = 0, vibration = 0, limit_ticks = 0;
    memset(record->mean, 0, (size_t)design->targets * sizeof *record->mean);
    for (int k = record->ticks - count; k < record->ticks; k++) {
        const int at = k % record->end_ticks;
        squares += record->error[at] * record->error[at] / count;
        measurement_error += record->measurement_error[at] * record->measurement_error[at] / count;
        vibration += record->vibration[at] * record->vibration[at] / count;
        for (int i = 0; i < design->targets; i++)
            record->mean[i] += record->last[at * design->targets + i] / count;
    }
    for (int k = 0; k < design->amplifiers; k++)
        limit_ticks = fmax(limit_ticks, fabs(loop->output[k] - record->initial_voltage[k]) /
                                            design->step_limit[k]);
    course->steady = sqrt(squares);
    course->measurement_error = sqrt(measurement_error);
    course->vibration = sqrt(vibration);
    course->settled = settled_after(record, design);
    course->step_limit_ticks = (int)fmin(ceil(limit_ticks), 1e9);
    memcpy(course->voltage, loop->output, (size_t)design->amplifiers * sizeof *course->voltage);
    memcpy(course->shape, loop->shape, (size_t)design->targets * sizeof *course->shape);
    memcpy(record->initial_voltage, loop->output,
           (size_t)design->amplifiers * sizeof *record->initial_voltage);
    record->ticks = 0;
}

/*
 * Store the target, the loads, and the lowest and highest voltages that can act on the ceramic, as
 * they are at the end of a phase (interval between events). From these the best possible shape is
 * computed later. Returns whether memory was available.
 */
static bool keep_conditions(loop *loop, simulate_phase *phase)
{
    const design *design = loop->design;
    const imperfections wiring = loop_imperfections(loop);
    memcpy(phase->target, loop->wanted, (size_t)design->targets * sizeof *phase->target);
    memcpy(phase->load, loop->load, ((size_t)design->loads + 1) * sizeof *phase->load);
    return imperfections_stroke(&wiring, phase->lowest, phase->highest);
}

/* ---- ticks of a control law ------------------------------------------- */

static void report_tick(const loop *loop, simulate_law law, int tick,
                        simulate_tick_callback *callback, void *context)
{
    const simulate_sample sample = {.law = law,
                                    .tick = tick,
                                    .error = loop->error,
                                    .measurement_error = loop->measurement_error,
                                    .vibration = loop->vibration,
                                    .command = loop->command,
                                    .voltage = loop->output,
                                    .active = loop_active(loop),
                                    .iterations = loop->iterations,
                                    .status = loop->status,
                                    .is_missed = loop->is_missed};
    if (callback)
        callback(context, &sample);
}

static void count_tick(const loop *loop, simulate_count *count)
{
    count->beyond_limits += loop->beyond_limits;
    count->beyond_rows += loop->beyond_rows;
    count->not_finite += loop->not_finite;
    count->missed_ticks += loop->is_missed;
    if (loop->is_missed)
        return;
    count->agreeing_ticks += loop->twin_agrees;
    count->detected += loop->detected;
    count->falsely_detected += loop->falsely_detected;
    count->detection_ticks = loop->detection_ticks > count->detection_ticks
                                 ? loop->detection_ticks
                                 : count->detection_ticks;
    count->iterations += loop->iterations;
    count->iterations_most =
        loop->iterations > count->iterations_most ? loop->iterations : count->iterations_most;
    count->status[PZS_IS_ERROR(loop->status) ? PZS_OK : loop->status]++;
}

/*
 * Whether a control law for comparison has diverged, so that its further ticks are not simulated.
 * On a plant with inertia a control law without a vibration model may diverge.
 */
static bool has_diverged(const loop *loop, simulate_law law)
{
    return law != LAW_CONTROLLER && !(loop->error < diverged);
}

/* Mark a phase (interval between events) and all later phases of a control law as diverged. */
static void mark_diverged(simulation *simulation, const simulate_phase *from, simulate_law law)
{
    for (int k = (int)(from - simulation->phase); k < simulation->phases; k++) {
        simulate_course *course = &simulation->phase[k].course[law];
        course->steady = course->worst = HUGE_VAL;
        course->vibration = course->vibration_worst = HUGE_VAL;
        course->settled = -1;
    }
}

/*
 * Run all ticks of the simulation under one control law. A control law for comparison counts as
 * diverged where the motion or the equilibrium of the plant under its voltages could not be
 * computed. Returns 0, or -1 with error filled.
 */
static int run_ticks(simulation *simulation, loop *loop, course_log *record, simulate_law law,
                     simulate_tick_callback *callback, void *context, char *error)
{
    const int ticks = loop->design->simulate.ticks;
    simulate_phase *phase = simulation->phase;
    for (int tick = 0; tick < ticks; tick++) {
        if (loop_tick(loop, tick, error) < 0) {
            mark_diverged(simulation, phase, law);
            return law == LAW_CONTROLLER ? -1 : 0;
        }
        log_tick(record, loop, &phase->course[law]);
        report_tick(loop, law, tick, callback, context);
        count_tick(loop, &simulation->count[law]);
        if (has_diverged(loop, law)) {
            mark_diverged(simulation, phase, law);
            return 0;
        }
        if (tick + 1 < phase->until)
            continue;
        finish_course(record, loop, &phase->course[law]);
        if (law == LAW_CONTROLLER && !keep_conditions(loop, phase))
            return no_memory(simulation->nominal, error);
        if (plant_displacement(&simulation->plant, phase->course[law].displacement, error) < 0)
            return -1;
        phase++;
    }
    return 0;
}

int simulate_run(simulation *simulation, simulate_law law, simulate_tick_callback *callback,
                 void *context, char *error)
{
    course_log record;
    loop loop;
    const double begin = analysis_now();
    memset(&simulation->count[law], 0, sizeof simulation->count[law]);
    for (int k = 0; k < simulation->phases; k++)
        simulation->phase[k].course[law].worst = simulation->phase[k].course[law].vibration_worst =
            0;
    int failed = log_open(&record, simulation) ? 0 : no_memory(simulation->nominal, error);
    failed = loop_open(&loop, simulation, law, error) < 0 || failed ||
             loop_selftest(&loop, error) < 0 ||
             run_ticks(simulation, &loop, &record, law, callback, context, error) < 0;
    loop_close(&loop);
    log_close(&record);
    simulation->count[law].seconds = analysis_now() - begin;
    return failed ? -1 : 0;
}

long simulate_ran(const simulate_count *count)
{
    long run = 0;
    for (int k = 0; k < SIMULATE_STATUSES; k++)
        run += count->status[k];
    return run;
}

/* ---- best shape of each phase ----------------------------------------- */

static int same_conditions(const simulation *simulation, const simulate_phase *first,
                           const simulate_phase *second)
{
    const design *design = &simulation->nominal->design;
    const size_t targets = (size_t)design->targets, loads = (size_t)design->loads + 1,
                 ends = 2 * (size_t)design->amplifiers;
    return memcmp(first->target, second->target, targets * sizeof *first->target) == 0 &&
           memcmp(first->load, second->load, loads * sizeof *first->load) == 0 &&
           memcmp(first->lowest, second->lowest, ends * sizeof *first->lowest) == 0;
}

static int find_optimum(simulation *simulation, simulate_phase *phase, double *shape, char *error)
{
    const design *design = &simulation->nominal->design;
    voltages best;
    memset(&best, 0, sizeof best);
    plant_rest(&simulation->plant);
    for (int k = 0; k < design->loads; k++)
        plant_load(&simulation->plant, k, phase->load[k]);
    plant_warm(&simulation->plant, phase->load[design->loads]);
    const int failed = plant_optimum(&simulation->plant, phase->target, phase->lowest,
                                     phase->highest, &best, shape, error) < 0;
    phase->optimum = failed
                         ? (double)NAN
                         : weighted_distance(design, shape, phase->target) / simulation->reference;
    voltages_free(&best);
    return failed ? -1 : 0;
}

int simulate_optima(simulation *simulation, char *error)
{
    double *shape = calloc((size_t)simulation->plant.analysis.design.targets, sizeof *shape);
    int failed = shape ? 0 : no_memory(simulation->nominal, error);
    for (int k = 0; k < simulation->phases && !failed; k++) {
        if (k > 0 && same_conditions(simulation, &simulation->phase[k], &simulation->phase[k - 1]))
            simulation->phase[k].optimum = simulation->phase[k - 1].optimum;
        else
            failed = find_optimum(simulation, &simulation->phase[k], shape, error) < 0;
    }
    free(shape);
    return failed ? -1 : 0;
}
