/* SPDX-License-Identifier: BSD-2-Clause */
/* Simulation of a control loop with a vibrating structure while the target jumps (storm.h). */
#include "storm.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../../lib/control/hysteresis.h"
#include "../../lib/core/product.h"
#include "imperfections.h"
#include "random.h"
#include "../model/mass.h"

enum {
    TARGETS = 10, /* number of targets in a storm (a simulation with fast target jumps) before the
                     last target */
    REST_PERIODS = 12, /* periods of the first vibration mode during which the last target stays */
    EVERY_LEAST = 10,  /* fewest and most ticks between two jumps of the target */
    EVERY_MOST = 1200,
    REST_LEAST = 1200, /* fewest ticks at the end of a storm (simulation with fast jumps of the
                          target) during which the target stays the same: six time constants of the
                          controller's low-pass filter */
    REST_MOST = 20000,
    REST_STEPS = 200, /* largest number of control steps, computed with static responses only, that
                         find the voltages at which a control loop comes to rest */
    END_LEAST = 20, /* smallest and largest number of ticks, at the end of a storm (simulation with
                       fast jumps of the target), over which the results are averaged */
    END_MOST = 500
};

static const double two_pi = 6.283185307179586;

/*
 * Standard deviation of the sensors' noise, relative to the largest displacement in the best shape
 * that the voltage limits allow.
 */
static const double noise_share = 1e-4;

/*
 * Distance of the shape from the target, relative to the norm of the target, above which the loop
 * counts as diverged.
 */
static const double diverged = 1e6;

/* ---- data that all storms of a loop share ----------------------------- */

static int no_memory(const analysis *analysis, char *error)
{
    return scene_fault(analysis->design.simulate.at, error, "out of memory");
}

/*
 * Set the index of the structure's output row that each sensor measures: all target rows
 * (controlled displacements), or the outputs that the scene's `estimate` section names.
 */
static void list_rows(storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    const scene_estimate *estimate = &design->estimate;
    size_t at = 0;
    if (!rig->estimator) {
        for (size_t i = 0; i < rig->sensors; i++)
            rig->row[i] = (uint32_t)i;
        return;
    }
    for (int reading = 0; reading < estimate->readings; reading++) {
        const int output = estimate->reading[reading].output;
        for (int row = design->named_first[output]; row < design->named_first[output + 1]; row++)
            if (at < rig->sensors)
                rig->row[at++] = (uint32_t)row;
    }
}

/*
 * Set the static displacements of the targets and static readings of the sensors per volt of each
 * amplifier.
 *   influence [outputs][inputs] in  influence matrix of the structure
 */
static void fill_static(storm_rig *rig, const double *influence)
{
    const size_t inputs = rig->analysis->design.structure.input.count, amplifiers = rig->amplifiers;
    for (size_t i = 0; i < rig->targets; i++)
        memcpy(rig->influence + i * amplifiers, influence + i * inputs,
               amplifiers * sizeof(double));
    for (size_t i = 0; i < rig->sensors; i++)
        memcpy(rig->direct + i * amplifiers, influence + rig->row[i] * inputs,
               amplifiers * sizeof(double));
}

/*
 * Set the voltage limits within which random voltages for targets are drawn; an amplifier without
 * finite limits stays at 0 V.
 */
static void fill_limits(storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    for (size_t k = 0; k < rig->amplifiers; k++) {
        const bool is_finite = isfinite(design->lower[k]) && isfinite(design->upper[k]);
        rig->lower[k] = is_finite ? design->lower[k] : 0;
        rig->upper[k] = is_finite ? design->upper[k] : 0;
    }
}

/*
 * Lower limit of the divisor of shape errors, which otherwise is the norm of the target. The limit
 * is relative to the root mean square norm of the shapes under half the voltage range of all
 * amplifiers with random signs.
 */
static const double least_scale = 0.02;

/*
 * Set the unit in which shape errors are measured: the norm of the target. Where the target is
 * nearly zero, as in a loop that only damps vibration, a small part of the shapes that the voltages
 * reach is the unit. Returns whether memory sufficed.
 */
static bool fill_scale(storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    double squares = 0;
    double *column = calloc(rig->targets + 1, sizeof *column);
    for (size_t k = 0; k < rig->amplifiers && column; k++) {
        const double half = (rig->upper[k] - rig->lower[k]) / 2;
        for (size_t i = 0; i < rig->targets; i++)
            column[i] = half * rig->influence[i * rig->amplifiers + k];
        squares += design_squares(design, column, NULL);
    }
    rig->scale = fmax(sqrt(design_squares(design, design->target, NULL)),
                      fmax(least_scale * sqrt(squares), 1e-300));
    free(column);
    return column != NULL;
}

static bool take_memory(storm_rig *rig)
{
    const size_t amplifiers = rig->amplifiers, sensors = rig->sensors, targets = rig->targets;
    rig->memory = calloc(sensors * amplifiers + targets * amplifiers + 2 * amplifiers + 1,
                         sizeof *rig->memory);
    rig->row = calloc(sensors + 1, sizeof *rig->row);
    if (!rig->memory || !rig->row)
        return false;
    rig->direct = rig->memory;
    rig->influence = rig->direct + sensors * amplifiers;
    rig->lower = rig->influence + targets * amplifiers;
    rig->upper = rig->lower + amplifiers;
    return true;
}

static void close_ticks(storm_rig *rig)
{
    tick_matrix_close(&rig->static_shape);
    tick_matrix_close(&rig->static_reading);
    tick_matrix_close(&rig->vibration_shape);
    tick_matrix_close(&rig->vibration_reading);
}

/*
 * Fill the matrices that every tick of a storm uses, from the static responses and the vibration
 * modes. Returns whether memory sufficed.
 */
static bool fill_ticks(storm_rig *rig)
{
    const modal *modal = &rig->modal;
    const size_t targets = rig->targets, sensors = rig->sensors, amplifiers = rig->amplifiers,
                 modes = modal->modes;
    close_ticks(rig);
    return tick_matrix_open(&rig->static_shape, rig->influence, amplifiers, NULL, targets,
                            amplifiers) &&
           tick_matrix_open(&rig->static_reading, rig->direct, amplifiers, NULL, sensors,
                            amplifiers) &&
           tick_matrix_open(&rig->vibration_shape, modal->shape, modes, NULL, targets, modes) &&
           tick_matrix_open(&rig->vibration_reading, modal->shape, modes, rig->row, sensors, modes);
}

void storm_use(storm_rig *rig, const pzs_block *block, int blocks, int delay)
{
    rig->blocks = 0;
    for (int k = 0; k < blocks; k++)
        if (block[k].type->phase != PZS_PHASE_SUPERVISE)
            rig->block[rig->blocks++] = block[k];
    rig->delay = delay;
}

int storm_open(storm_rig *rig, const analysis *analysis, const estimator *estimator, char *error)
{
    const design *design = &analysis->design;
    memset(rig, 0, sizeof *rig);
    rig->analysis = analysis;
    rig->estimator = estimator;
    rig->interval = 1 / design->control.rate;
    rig->bandwidth = design->simulate.imperfections.bandwidth;
    rig->targets = (size_t)design->targets;
    rig->amplifiers = (size_t)design->amplifiers;
    rig->sensors = estimator ? (size_t)estimator->sensors : rig->targets;
    if (analysis_vibration(analysis, &rig->vibration,
                           design->simulate.given ? design->simulate.modes : 100, error) < 0)
        return -1;
    if (!take_memory(rig) || !modal_open(&rig->modal, design, &rig->vibration, rig->amplifiers))
        return no_memory(analysis, error);
    list_rows(rig);
    fill_static(rig, analysis->influence);
    fill_limits(rig);
    if (!fill_ticks(rig) || !fill_scale(rig))
        return no_memory(analysis, error);
    compensation_fill(&rig->ceramic, &design->hysteresis, &design->problem, design->control.rate);
    return 0;
}

bool storm_deform(storm_rig *rig, const deformed *deformed)
{
    fill_static(rig, deformed->analysis.influence);
    rig->offset = deformed->offset;
    modal_close(&rig->modal);
    return modal_copy(&rig->modal, &deformed->modal) && fill_ticks(rig);
}

void storm_close(storm_rig *rig)
{
    close_ticks(rig);
    modal_close(&rig->modal);
    vibration_free(&rig->vibration);
    free(rig->memory);
    free(rig->row);
    memset(rig, 0, sizeof *rig);
}

/* ---- state of one storm ----------------------------------------------- */

/* State of one storm: simulation of a control loop with fast jumps of the target. */
typedef struct storm {
    const storm_rig *rig;
    const storm_plant *plant;
    pzs_problem problem; /* voltage optimisation problem of the loop with the voltage and step
                            limits of the simulation in place of the scene's */
    pzs_block block[PZS_BLOCK_LIMIT];
    int blocks;
    pzs_loop loop;
    void *work;
    inertia inertia;
    uint64_t random;
    int tick, history_ticks; /* number of the present tick; number of ticks whose readings are
                                stored */
    bool has_shape;          /* true while `shape` holds the present shape of the structure */
    bool has_vibration; /* true while the array `part` holds the displacements of the target nodes
                           by vibration in this tick */
    int missed_ticks; /* number of missed ticks since the last tick in which the control loop ran */
    double noise;     /* standard deviation of the noise of a reading, in the unit of the reading */
    double *memory; /* one allocation that holds `limits` and all arrays of this struct that follow
                       it */
    double *limits; /* [3][amplifiers] lower voltage limits, upper voltage limits and step limits of
                       the simulation (V) */
    double *voltage; /* [amplifiers] voltages of the amplifiers in the present tick (V) */
    double *output;  /* [amplifiers] output voltages of the amplifiers, which follow the voltages of
                        the control loop with a first-order lag where the scene file states their
                        bandwidth (V) */
    double *driven;  /* [amplifiers] mean output voltages of the amplifiers from this tick to the
                        next (V) */
    double *acting;  /* [amplifiers] voltages that act on the ceramic of the electrodes, after
                        hysteresis and creep (V) */
    double *stroke;  /* [2][amplifiers] lowest and highest voltages that can act on the ceramic of
                        the electrodes (V). They differ from the voltage limits of the amplifiers
                        because of hysteresis. */
    double *play;    /* [amplifiers][PZS_PLAY_LIMIT] outputs of the play operators of the hysteresis
                        model (V) */
    double *creep;   /* [amplifiers][PZS_CREEP_LIMIT] outputs of the first-order lags of the creep
                        model (V) */
    const pzs_hysteresis *hysteresis; /* hysteresis and creep of the ceramic as the scene file
                                         describes them; NULL where the loop does not compensate
                                         them */
    double *previous_voltage; /* [amplifiers] voltages of the amplifiers before the last control
                                 tick (V) */
    double *target;           /* [targets] target shape in the present tick */
    double *last_target; /* [targets] target displacements (m) at the end of the simulation: the
                        target of the scene file */
    double *best_shape;  /* [targets] best shape for the last target that the limits allow on the
                            simulated structure */
    double *shape;       /* [targets] shape of the simulated structure in the present tick */
    double *part; /* [targets] work array for the displacements of the target nodes by vibration */
    double *sensed;    /* [sensors] readings that the control loop receives in the present tick */
    double *load;      /* [rows] static displacement of each output row of the structure under the
                          load of a load step; zero before the step, and in storms */
    double *vibrating; /* [sensors] work array for the readings that the present vibration causes */
    double *reading;   /* [history_ticks][sensors] noise-free readings of the last ticks */
} storm;

static bool take_run_memory(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers, targets = storm->rig->targets,
                 k = storm->rig->sensors;
    const size_t kept = (size_t)storm->history_ticks;
    double *at = storm->memory =
        calloc((10 + PZS_PLAY_LIMIT + PZS_CREEP_LIMIT) * amplifiers + 5 * targets + 2 * k +
                   kept * k + storm->rig->modal.rows + 1,
               sizeof *storm->memory);
    if (!at || !inertia_open(&storm->inertia, &storm->rig->modal))
        return false;
    storm->limits = at, at += 3 * amplifiers;
    storm->voltage = at, at += amplifiers;
    storm->previous_voltage = at, at += amplifiers;
    storm->output = at, at += amplifiers;
    storm->driven = at, at += amplifiers;
    storm->acting = at, at += amplifiers;
    storm->stroke = at, at += 2 * amplifiers;
    storm->play = at, at += PZS_PLAY_LIMIT * amplifiers;
    storm->creep = at, at += PZS_CREEP_LIMIT * amplifiers;
    storm->target = at, at += targets;
    storm->last_target = at, at += targets;
    storm->best_shape = at, at += targets;
    storm->shape = at, at += targets;
    storm->part = at, at += targets;
    storm->sensed = at, at += k;
    storm->vibrating = at, at += k;
    storm->load = at, at += storm->rig->modal.rows;
    storm->reading = at;
    return true;
}

/*
 * Multiply a matrix by a vector and by a factor.
 *   matrix  [rows][columns] in  matrix
 *   vector  [columns]       in  vector
 *   product [rows]          out  product
 */
static void multiply(double *product, const double *matrix, const double *vector, size_t rows,
                     size_t columns, double factor)
{
    pzs_product_matrix(product, matrix, vector, rows, columns);
    for (size_t i = 0; i < rows; i++)
        product[i] *= factor;
}

/*
 * Set the voltage and step limits of the voltage optimisation problem, which the controller solves,
 * to the limits of the simulation.
 */
static void set_limits(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const design *design = &storm->rig->analysis->design;
    const double factor = storm->plant->step_limit;
    const bool is_free = !isfinite(factor);
    for (size_t k = 0; k < amplifiers; k++) {
        const bool is_held = !(design->lower[k] < design->upper[k]);
        const bool is_limited = !is_free || is_held;
        storm->limits[k] = is_limited ? storm->problem.lower[k] : -HUGE_VAL;
        storm->limits[amplifiers + k] = is_limited ? storm->problem.upper[k] : HUGE_VAL;
        storm->limits[2 * amplifiers + k] =
            is_free ? HUGE_VAL : storm->problem.step_limit[k] * factor;
    }
    storm->problem.lower = storm->limits;
    storm->problem.upper = storm->limits + amplifiers;
    storm->problem.step_limit = storm->limits + 2 * amplifiers;
    if (is_free) /* without voltage limits, the limits of sums of voltages are left out, too,
                    because they need finite voltage limits */
        storm->problem.limit_rows = NULL;
    storm->problem.crc = pzs_problem_crc(&storm->problem);
}

/* ---- hysteresis and creep of the ceramic ------------------------------ */

/*
 * State of the ceramic of electrode k in the hysteresis model of the scene file: the outputs of its
 * play operators (hysteresis) and of its lags (creep).
 */
static hysteresis_memory memory_of(const storm *storm, size_t k)
{
    const hysteresis_memory memory = {storm->play + k * PZS_PLAY_LIMIT,
                                      storm->creep + k * PZS_CREEP_LIMIT};
    return memory;
}

/*
 * Choose the hysteresis model of the ceramic: that of the scene file if the loop compensates
 * hysteresis, otherwise none. Compute the lowest and highest voltages that can act on the ceramic:
 * the effects of the lower and the upper voltage limit after a state of rest at 0 V.
 */
static void start_ceramic(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const storm_ceramic *ceramic = storm->plant->ceramic;
    const double *lower = storm->rig->analysis->design.problem.lower,
                 *upper = storm->rig->analysis->design.problem.upper;
    for (int k = 0; k < storm->blocks; k++)
        if (storm->block[k].type == &pzs_effect_block)
            storm->hysteresis = &storm->rig->ceramic.tables;
    for (size_t k = 0; k < amplifiers; k++) {
        double *stroke = storm->stroke + k;
        stroke[0] = ceramic ? ceramic->lowest[k] : lower[k];
        stroke[amplifiers] = ceramic ? ceramic->highest[k] : upper[k];
        if (ceramic || !storm->hysteresis)
            continue;
        const hysteresis_memory memory = memory_of(storm, k);
        pzs_hysteresis_rest(storm->hysteresis, (uint32_t)k, memory, 0);
        stroke[0] = pzs_hysteresis_effect(storm->hysteresis, (uint32_t)k, memory, lower[k]);
        stroke[amplifiers] =
            pzs_hysteresis_effect(storm->hysteresis, (uint32_t)k, memory, upper[k]);
    }
}

/*
 * Advance the output voltages of the amplifiers, which follow their commands with a lag, by one
 * tick interval.
 */
static void drive_amplifiers(storm *storm)
{
    const double bandwidth = storm->rig->bandwidth;
    for (size_t k = 0; k < storm->rig->amplifiers; k++)
        storm->driven[k] = bandwidth > 0 ? amplifier_lag(&storm->output[k], storm->voltage[k],
                                                         bandwidth, storm->rig->interval)
                                         : storm->voltage[k];
}

/*
 * Return the voltage (V) that would act on the ceramic of electrode k without hysteresis: a linear
 * function of the mean output voltage of its amplifier. At the lower and the upper voltage limit it
 * has the same values as with hysteresis.
 */
static double straight_effect(const storm *storm, size_t k)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const pzs_problem *problem = &storm->rig->analysis->design.problem;
    const double low = storm->stroke[k], high = storm->stroke[amplifiers + k];
    const double range = problem->upper[k] - problem->lower[k];
    const double part = range > 0 ? (storm->driven[k] - problem->lower[k]) / range : 0;
    return low + part * (high - low);
}

/*
 * Advance the amplifiers, and the hysteresis and creep of the ceramic, by one tick interval under
 * the present voltages.
 */
static void advance_ceramic(storm *storm)
{
    const storm_ceramic *ceramic = storm->plant->ceramic;
    drive_amplifiers(storm);
    memcpy(storm->acting, storm->driven, storm->rig->amplifiers * sizeof *storm->acting);
    if (ceramic) {
        ceramic->act(ceramic->state, storm->driven, storm->acting);
        return;
    }
    for (size_t k = 0; k < storm->rig->amplifiers && storm->hysteresis; k++) {
        const hysteresis_memory memory = memory_of(storm, k);
        const double straight = straight_effect(storm, k);
        const double bent =
            pzs_hysteresis_effect(storm->hysteresis, (uint32_t)k, memory, storm->driven[k]);
        storm->acting[k] = bent + storm->plant->less_hysteresis * (straight - bent);
        pzs_hysteresis_remember(storm->hysteresis, (uint32_t)k, memory, storm->driven[k], 1);
    }
}

/* ---- control loop of a storm ------------------------------------------ */

/*
 * Append a block (stage of the control tick) to those that the simulation runs. The limits of the
 * simulation replace those in the least-squares problem of the step block, which computes the
 * voltages. The library's step block gets a pointer to the new problem. The tables of a control law
 * for comparison begin with a problem, which is overwritten; their other members stay.
 */
static void append_block(storm *storm, const pzs_block *given)
{
    pzs_block *block = &storm->block[storm->blocks++];
    *block = *given;
    if (block->type->phase != PZS_PHASE_STEP)
        return;
    storm->problem = *(const pzs_problem *)block->tables;
    set_limits(storm);
    if (block->type == &pzs_step_block)
        block->tables = &storm->problem;
    else
        *(pzs_problem *)(uintptr_t)block->tables = storm->problem;
}

/*
 * Copy the blocks (stages of the control tick) that the simulation runs. A simulation without
 * limits measures the growth of vibrations. It omits the blocks after the one that computes the
 * voltages, because converter steps and held electrodes would hide the growth. It also omits the
 * compensation of hysteresis, which has no inverse without limits.
 */
static void set_tables(storm *storm)
{
    const bool is_free = !isfinite(storm->plant->step_limit);
    for (int k = 0; k < storm->rig->blocks; k++) {
        const pzs_block *given = &storm->rig->block[k];
        const bool is_behind = given->type->phase > PZS_PHASE_STEP;
        if (!is_free || !(is_behind || given->type == &pzs_effect_block))
            append_block(storm, given);
    }
}

static pzs_status open_loop(storm *storm)
{
    double none;
    const size_t count = (size_t)storm->blocks;
    pzs_status status = pzs_loop_init(&storm->loop, storm->block, count, NULL, &none, 0);
    if (status != PZS_E_WORKSPACE)
        return status;
    const size_t need = (size_t)storm->loop.info.where;
    storm->work = malloc(need);
    return storm->work ? pzs_loop_init(&storm->loop, storm->block, count, NULL, storm->work, need)
                       : PZS_E_WORKSPACE;
}

/*
 * Static displacement of an output of the structure at 0 V (m). It is the sum of the displacement
 * that the output has at 0 V without the load of a load step, and of the displacement by this load.
 * Simulations without voltage limits, which measure the growth of small vibrations, leave out the
 * first term: the voltages would only move to compensate it.
 */
static double offset_of(const storm *storm, size_t row)
{
    const bool is_free = !isfinite(storm->plant->step_limit);
    const double offset = storm->rig->offset && !is_free ? storm->rig->offset[row] : 0;
    return offset + storm->load[row];
}

/*
 * Compute the static shape of the simulated structure under given voltages, and store it as the
 * best shape that the voltage limits allow for the present target of the storm (simulation with
 * fast target jumps).
 */
static void compute_rest(storm *storm, const double *voltage)
{
    multiply(storm->best_shape, storm->rig->influence, voltage, storm->rig->targets,
             storm->rig->amplifiers, storm->plant->gain);
    for (size_t i = 0; i < storm->rig->targets; i++)
        storm->best_shape[i] += offset_of(storm, i);
}

/*
 * Find the voltages at which a control loop comes to rest on a structure whose influence matrix
 * differs from the controller's. Static control steps are repeated, each of which corrects half of
 * the shape error. The result differs from the best voltages for the structure, because the
 * controller computes voltages with its own influence matrix.
 *   control  in/out  with the controller's influence matrix, and with the voltages that can act on
 *            the ceramic as voltage limits
 */
static pzs_status find_rest(storm *storm, pzs_control *control)
{
    const size_t amplifiers = storm->rig->amplifiers, targets = storm->rig->targets;
    const double *tables = storm->rig->analysis->design.problem.influence;
    pzs_status status = PZS_OK;
    for (int step = 0; step < REST_STEPS && !PZS_IS_ERROR(status); step++) {
        compute_rest(storm, control->info.voltage);
        pzs_product_matrix(storm->part, tables, control->info.voltage, targets, amplifiers);
        for (size_t i = 0; i < targets; i++)
            storm->part[i] += (storm->last_target[i] - storm->best_shape[i]) / 2;
        status = pzs_step(control, storm->part);
    }
    return status;
}

/*
 * Make the influence matrix of the simulated structure as the least-squares problem of the voltages
 * has it: all entries, without the free functions of the target.
 *   column    [targets]             out  work array
 *   influence [targets][amplifiers] out  displacement per volt (length unit/V)
 */
static void take_plant_influence(const storm *storm, double *column, double *influence)
{
    const storm_rig *rig = storm->rig;
    design_influence_free(&rig->analysis->design, rig->influence, rig->amplifiers, column,
                          influence);
    for (size_t i = 0; i < rig->targets * rig->amplifiers; i++)
        influence[i] *= storm->plant->gain;
}

/*
 * Compute the best shape of the simulated structure for the last target, with voltages on the
 * ceramic between the lowest and highest that can act there. The influence matrix is the
 * structure's, of which the controller may leave out small entries. On a deformed structure,
 * compute the shape at which the loop comes to rest instead, with the controller's matrix.
 */
static pzs_status find_best(storm *storm, double *voltage)
{
    const size_t amplifiers = storm->rig->amplifiers, targets = storm->rig->targets;
    const pzs_problem *given = &storm->rig->analysis->design.problem;
    const bool is_deformed = storm->rig->offset != NULL;
    pzs_problem problem = *given;
    pzs_control control;
    double *influence = malloc((targets * amplifiers + amplifiers + targets) * sizeof *influence);
    void *work = malloc(pzs_control_bytes(given));
    pzs_status status = PZS_E_WORKSPACE;
    if (influence && work) {
        double *wide = influence + targets * amplifiers;
        if (is_deformed)
            memcpy(influence, given->influence, targets * amplifiers * sizeof *influence);
        else
            take_plant_influence(storm, wide + amplifiers, influence);
        for (size_t k = 0; k < amplifiers; k++)
            wide[k] = HUGE_VAL;
        problem.step_limit = wide;
        problem.lower = storm->stroke;
        problem.upper = storm->stroke + amplifiers;
        problem.hessian = NULL;
        problem.crc = pzs_problem_crc(&problem);
        status = pzs_control_init(&control, &problem, influence, work, pzs_control_bytes(given));
        if (!PZS_IS_ERROR(status))
            status =
                is_deformed ? find_rest(storm, &control) : pzs_step(&control, storm->last_target);
        if (!PZS_IS_ERROR(status)) {
            compute_rest(storm, control.info.voltage);
            memcpy(voltage, control.info.voltage, amplifiers * sizeof *voltage);
        }
    }
    free(influence);
    free(work);
    return status;
}

static int explain(const storm *run, pzs_status status, char *error)
{
    const design *design = &run->rig->analysis->design;
    return scene_fault(design->simulate.at, error, "storm: %s", pzs_status_text(status));
}

static void close_storm(storm *storm)
{
    inertia_close(&storm->inertia);
    free(storm->memory);
    free(storm->work);
}

/*
 * Weighted norm of the difference of two shapes, or of the first shape where the second is NULL.
 *   first, second [targets] in  displacements of the two shapes
 */
static double weighted_distance(const storm *storm, const double *first, const double *second)
{
    return sqrt(design_squares(&storm->rig->analysis->design, first, second));
}

static int open_storm(storm *storm, const storm_rig *rig, const storm_plant *plant, char *error)
{
    memset(storm, 0, sizeof *storm);
    storm->rig = rig;
    storm->plant = plant;
    storm->random = plant->seed;
    storm->history_ticks = rig->delay + (plant->more_delay > 0 ? plant->more_delay : 0) + 1;
    if (!take_run_memory(storm))
        return no_memory(rig->analysis, error);
    storm->inertia.gain = plant->gain;
    storm->inertia.stretch = plant->frequency;
    set_tables(storm);
    start_ceramic(storm);
    memcpy(storm->last_target, rig->analysis->design.target,
           rig->targets * sizeof *storm->last_target);
    pzs_status status = open_loop(storm);
    const bool is_free = !isfinite(plant->step_limit);
    if (!PZS_IS_ERROR(status) && !is_free) /* small vibrations without limits grow or decay about
                                              zero, not about the best shape */
        status = find_best(storm, storm->previous_voltage);
    if (PZS_IS_ERROR(status))
        return explain(storm, status, error);
    memcpy(storm->voltage, storm->loop.info.voltage, rig->amplifiers * sizeof *storm->voltage);
    memcpy(storm->output, storm->voltage, rig->amplifiers * sizeof *storm->output);
    advance_ceramic(storm);
    inertia_rest(&storm->inertia, storm->acting);
    return 0;
}

/* ---- ticks of a storm ------------------------------------------------- */

/*
 * Return the address of the vector of a tick in a ring buffer, which holds one vector, such as the
 * sensor readings, for each of the last ticks. Ticks before the start have the vector of the start.
 *   length in  number of entries of a vector
 */
static double *ring_entry(const storm *storm, double *ring, int tick, size_t length)
{
    return ring + (size_t)((tick > 0 ? tick : 0) % storm->history_ticks) * length;
}

/*
 * Compute the present displacements of the targets by vibration in storm->part, unless they are
 * there already. These sums over all modes are most of the work of a storm.
 */
static void observe_vibration(storm *storm)
{
    if (!storm->has_vibration)
        tick_matrix_multiply(&storm->rig->vibration_shape, storm->inertia.deviation, storm->part);
    storm->has_vibration = true;
}

/* Compute the present shape of the simulated structure, unless it is known already. */
static void compute_shape(storm *storm)
{
    const storm_rig *rig = storm->rig;
    if (storm->has_shape)
        return;
    storm->has_shape = true;
    tick_matrix_multiply(&rig->static_shape, storm->acting, storm->shape);
    observe_vibration(storm);
    for (size_t i = 0; i < rig->targets; i++)
        storm->shape[i] =
            storm->shape[i] * storm->plant->gain + (storm->part[i] + offset_of(storm, i));
}

/*
 * Compute the present noise-free readings of the sensors, and store them until the control loop
 * receives them some ticks later.
 */
static void store_readings(storm *storm)
{
    const storm_rig *rig = storm->rig;
    double *reading = ring_entry(storm, storm->reading, storm->tick, rig->sensors);
    if (!rig->estimator) {
        compute_shape(storm);
        memcpy(reading, storm->shape, rig->sensors * sizeof *reading);
        return;
    }
    tick_matrix_multiply(&rig->static_reading, storm->acting, reading);
    tick_matrix_multiply(&rig->vibration_reading, storm->inertia.deviation, storm->vibrating);
    for (size_t i = 0; i < rig->sensors; i++)
        reading[i] =
            reading[i] * storm->plant->gain + (storm->vibrating[i] + offset_of(storm, rig->row[i]));
}

/*
 * Compute the readings that the control loop receives in the present tick: those of some ticks
 * before, with noise.
 */
static void sense_readings(storm *storm)
{
    const storm_rig *rig = storm->rig;
    const double *shown = ring_entry(
        storm, storm->reading, storm->tick - rig->delay - storm->plant->more_delay, rig->sensors);
    for (size_t i = 0; i < rig->sensors; i++)
        storm->sensed[i] =
            shown[i] + (storm->noise > 0 ? storm->noise * random_noise(&storm->random) : 0);
}

/*
 * Decide by a random number whether the present tick is missed, with the probability that the
 * simulation states.
 */
static bool misses(storm *storm)
{
    return storm->plant->missed_share > 0 &&
           random_uniform(&storm->random) < storm->plant->missed_share;
}

/*
 * Inform the control loop of missed ticks, and let it compute the voltages of the present tick.
 * Returns the status of the control loop.
 */
static pzs_status choose_voltages(storm *storm)
{
    if (storm->missed_ticks > 0 && !storm->plant->is_uninformed)
        (void)pzs_loop_skip(&storm->loop, (uint32_t)storm->missed_ticks);
    storm->missed_ticks = 0;
    return pzs_loop_tick(&storm->loop, storm->target, storm->sensed);
}

/*
 * Run one tick of a simulated control loop: take readings, compute voltages, and advance the
 * structure to the next tick. Returns the status of the loop.
 */
static pzs_status run_tick(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const bool is_missed = misses(storm);
    store_readings(storm);
    sense_readings(storm);
    memcpy(storm->previous_voltage, storm->voltage, amplifiers * sizeof *storm->voltage);
    const pzs_status status = is_missed ? PZS_OK : choose_voltages(storm);
    storm->missed_ticks += is_missed;
    memcpy(storm->voltage, storm->loop.info.voltage, amplifiers * sizeof *storm->voltage);
    advance_ceramic(storm);
    inertia_jump(&storm->inertia, storm->acting);
    inertia_advance(&storm->inertia, storm->rig->interval);
    storm->has_vibration = storm->has_shape = false;
    storm->tick++;
    return status;
}

/* ---- a storm, targets that jump --------------------------------------- */

static int clamp_ticks(double ticks, int least, int most)
{
    return (int)fmin(fmax(ceil(ticks), least), most);
}

/*
 * Set the next target: the target of the scene, its negative, or the shape under random voltages.
 */
static void set_next_target(storm *storm)
{
    const storm_rig *rig = storm->rig;
    const size_t amplifiers = rig->amplifiers;
    const int kind = random_int(&storm->random, 4);
    if (kind < 2) {
        for (size_t i = 0; i < rig->targets; i++)
            storm->target[i] = kind == 0 ? storm->last_target[i] : -storm->last_target[i];
        return;
    }
    for (size_t k = 0; k < amplifiers; k++) {
        const double part = 2 * random_uniform(&storm->random) - 1, sign = part < 0 ? -1 : 1;
        const double middle = (rig->lower[k] + rig->upper[k]) / 2,
                     half = (rig->upper[k] - rig->lower[k]) / 2;
        storm->previous_voltage[k] = middle + 2 * half * (kind == 2 ? part : sign);
    }
    multiply(storm->target, rig->influence, storm->previous_voltage, rig->targets, amplifiers, 1);
    for (size_t i = 0; i < rig->targets; i++)
        storm->target[i] += offset_of(storm, i);
}

/*
 * Set the noise of the sensors in proportion to the largest displacement of the best shape that the
 * limits allow.
 */
static void set_noise(storm *storm)
{
    double largest = 0;
    for (size_t i = 0; i < storm->rig->targets; i++)
        largest = fmax(largest, fabs(storm->best_shape[i]));
    storm->noise = noise_share * largest;
}

static pzs_status run_storm(storm *storm, storm_result *result)
{
    const double period = two_pi / (storm->rig->modal.frequency[0] * storm->rig->interval);
    const int every = clamp_ticks(0.6 * period, EVERY_LEAST, EVERY_MOST),
              rest = clamp_ticks(REST_PERIODS * period, REST_LEAST, REST_MOST),
              end = clamp_ticks(period, END_LEAST, END_MOST);
    const double size = storm->rig->scale;
    int quiet = 0;
    result->ticks = TARGETS * every + rest;
    for (int k = 0; k < result->ticks; k++) {
        if (k == TARGETS * every)
            memcpy(storm->target, storm->last_target, storm->rig->targets * sizeof *storm->target);
        else if (k < TARGETS * every && k % every == 0)
            set_next_target(storm);
        const pzs_status status = run_tick(storm);
        if (PZS_IS_ERROR(status))
            return status;
        if (k < TARGETS * every && k % 8 != 0)
            continue;
        compute_shape(storm);
        const double distance = weighted_distance(storm, storm->shape, storm->best_shape) / size;
        result->peak = fmax(result->peak, distance);
        if (k + end >= result->ticks)
            result->end = fmax(result->end, distance);
        quiet = distance < CERTIFICATE_TOLERANCE / 2 && k >= TARGETS * every ? quiet + 1 : 0;
        if (quiet > end) {
            result->end = distance;
            result->ticks = k + 1;
        }
        if (!(distance < diverged)) {
            result->end = HUGE_VAL;
            break;
        }
    }
    result->passed = result->end <= CERTIFICATE_TOLERANCE;
    return PZS_OK;
}

int storm_run(const storm_rig *rig, const storm_plant *plant, storm_result *result, char *error)
{
    storm storm;
    memset(result, 0, sizeof *result);
    int failed = open_storm(&storm, rig, plant, error);
    if (!failed) {
        set_noise(&storm);
        const pzs_status status = run_storm(&storm, result);
        if (PZS_IS_ERROR(status))
            failed = explain(&storm, status, error);
    }
    close_storm(&storm);
    return failed;
}

/* ---- growth of small vibrations --------------------------------------- */

/*
 * Return the amplitude of small vibrations of a control loop as one number: the root of the sum of
 * two squared norms, weighted with the target weights. One norm is that of the vibration
 * displacements. The other is that of the static displacements by the last change of the voltages,
 * because an unstable loop can also make the voltages oscillate.
 */
static double amplitude(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    double *moved = storm->best_shape;
    for (size_t k = 0; k < amplifiers; k++)
        storm->previous_voltage[k] = storm->voltage[k] - storm->previous_voltage[k];
    tick_matrix_multiply(&storm->rig->static_shape, storm->previous_voltage, moved);
    observe_vibration(storm);
    return hypot(weighted_distance(storm, moved, NULL),
                 weighted_distance(storm, storm->part, NULL));
}

/*
 * Return the slope of the straight line that fits values over their indices in the least-squares
 * sense.
 *   value [count] in  values, one for each index
 */
static double slope(const double *value, int count)
{
    const double middle = (count - 1) / 2.0;
    double product = 0, square = 0;
    for (int i = 0; i < count; i++) {
        product += (i - middle) * value[i];
        square += (i - middle) * (i - middle);
    }
    return square > 0 ? product / square : 0;
}

static pzs_status run_free(storm *storm, int ticks, double *size, storm_result *result)
{
    const modal *modal = &storm->rig->modal;
    const double scale = storm->rig->scale;
    for (size_t i = 0; i < modal->modes; i++) {
        storm->inertia.deviation[i] = 2 * random_uniform(&storm->random) - 1;
        storm->inertia.velocity[i] = 2 * random_uniform(&storm->random) - 1;
    }
    const double unit = 1e-3 * scale / fmax(amplitude(storm), 1e-300);
    for (size_t i = 0; i < modal->modes; i++) {
        storm->inertia.deviation[i] *= unit;
        storm->inertia.velocity[i] *= unit;
    }
    storm->has_vibration = storm->has_shape = false;
    memset(storm->target, 0, storm->rig->targets * sizeof *storm->target);
    int k = 0;
    for (; k < ticks; k++) {
        const pzs_status status = run_tick(storm);
        if (PZS_IS_ERROR(status))
            return status;
        size[k] = log(fmax(amplitude(storm), 1e-300));
        if (fabs(size[k] - log(1e-3 * scale)) > log(1e6))
            break;
    }
    result->ticks = k < ticks ? k + 1 : ticks;
    result->growth = exp(slope(size + result->ticks / 2, result->ticks - result->ticks / 2));
    result->passed = result->growth < 1;
    return PZS_OK;
}

int storm_growth(const storm_rig *rig, const storm_plant *plant, int ticks, storm_result *result,
                 char *error)
{
    storm storm;
    double *size = malloc((size_t)ticks * sizeof *size);
    memset(result, 0, sizeof *result);
    int failed = open_storm(&storm, rig, plant, error);
    if (!failed && !size)
        failed = no_memory(rig->analysis, error);
    if (!failed) {
        const pzs_status status = run_free(&storm, ticks, size, result);
        if (PZS_IS_ERROR(status))
            failed = explain(&storm, status, error);
    }
    close_storm(&storm);
    free(size);
    return failed;
}

/* ---- load step -------------------------------------------------------- */

/*
 * Loads of the load steps: a uniform pressure, forces at two outputs (the output that moves most
 * under its own force, and the output in the middle of the list), and loads that move one vibration
 * mode only.
 */
typedef enum load_shape {
    LOAD_UNIFORM,
    LOAD_SOFTEST,
    LOAD_MIDDLE,
    LOAD_FIRST_MODE,
    LOAD_THIRD_MODE,
    LOAD_SHAPES
} load_shape;

enum {
    LOAD_REST = 2,     /* number of periods for which a load step that has settled is continued */
    START_PERIODS = 20 /* most periods in which the loop moves the voltages to the middle of their
                          limits before a load step, where they start near a limit */
};

/*
 * Largest phase angle in a tick (rad) of the vibration modes that a load step excites. The control
 * tick damps these modes in full; faster modes ring as long as their own damping makes them.
 */
static const double load_angle = 0.6;

/*
 * Largest change of a voltage that compensates the load, relative to half the range between its
 * limits.
 */
static const double load_share = 0.3;

/*
 * Largest part of the effect of a load that the best voltages may leave. A load of which they leave
 * more is not applied.
 */
static const double load_left = 0.2;

/*
 * Distance from the shape before a load step at which the loop counts as at rest, relative to the
 * largest distance on the way there.
 */
static const double at_rest = 1e-3;

/* A load step: its vibration modes, and the modal coordinates of the load. */
typedef struct load_step {
    storm *storm;
    size_t from, to; /* first vibration mode that the load moves, and the mode after the last */
    double period;   /* period of the first vibration mode (ticks) */
    double *modal;   /* [modes of the plant] modal coordinates of the structure in equilibrium under
                        the load */
    double *start;   /* [targets] shape before the load step (m) */
    double *voltage; /* [amplifiers] best voltages under the load (V) */
} load_step;

/* Index of the first vibration mode whose natural frequency is at least `frequency` (Hz). */
static size_t mode_from(const modal *modal, double frequency)
{
    size_t mode = 0;
    while (mode + 1 < modal->modes && modal->frequency[mode] < 0.999 * two_pi * frequency)
        mode++;
    return mode;
}

/* Static displacement of an output under a unit force at this output, in the modes of a load. */
static double compliance(const load_step *step, size_t row)
{
    const modal *modal = &step->storm->rig->modal;
    double sum = 0;
    for (size_t i = step->from; i < step->to; i++)
        sum += pow(modal->shape[row * modal->modes + i] / modal->frequency[i], 2);
    return sum;
}

/* Index of the output at which a load of a given shape exerts its force. */
static size_t loaded_row(const load_step *step, load_shape shape)
{
    const size_t targets = step->storm->rig->targets;
    size_t softest = 0;
    if (shape == LOAD_MIDDLE)
        return targets / 2;
    for (size_t row = 1; row < targets; row++)
        if (compliance(step, row) > compliance(step, softest))
            softest = row;
    return softest;
}

/* Force of a pressure or of a force at one output on vibration mode i, at unit modal mass. */
static double modal_force(const load_step *step, load_shape shape, size_t row, size_t i)
{
    const storm_rig *rig = step->storm->rig;
    const double *weight = rig->analysis->design.weight;
    double sum = 0;
    if (shape != LOAD_UNIFORM)
        return rig->modal.shape[row * rig->modal.modes + i];
    for (size_t target = 0; target < rig->targets; target++)
        sum += weight[target] * weight[target] * rig->modal.shape[target * rig->modal.modes + i];
    return sum;
}

/* Set the modal coordinates of the load, of any size. */
static void set_load(load_step *step, load_shape shape)
{
    const modal *modal = &step->storm->rig->modal;
    const size_t last = step->to - 1, third = step->from + 2 < last ? step->from + 2 : last,
                 row = loaded_row(step, shape);
    memset(step->modal, 0, modal->modes * sizeof *step->modal);
    if (shape == LOAD_FIRST_MODE || shape == LOAD_THIRD_MODE) {
        step->modal[shape == LOAD_FIRST_MODE ? step->from : third] = 1;
        return;
    }
    for (size_t i = step->from; i < step->to; i++)
        step->modal[i] = modal_force(step, shape, row, i) / pow(modal->frequency[i], 2);
}

/* Multiply the load by a factor, and compute the static displacements of all outputs under it. */
static void scale_load(load_step *step, double factor)
{
    const modal *modal = &step->storm->rig->modal;
    for (size_t i = 0; i < modal->modes; i++)
        step->modal[i] *= factor;
    pzs_product_matrix(step->storm->load, modal->shape, step->modal, modal->rows, modal->modes);
}

/* Find the best shape under the load for the shape before the load step as target. */
static pzs_status find_loaded_best(load_step *step)
{
    storm *storm = step->storm;
    for (size_t i = 0; i < storm->rig->targets; i++)
        storm->last_target[i] = step->start[i] - storm->load[i];
    return find_best(storm, step->voltage);
}

/*
 * Largest difference between the best voltages under the load and the present voltages, relative to
 * half the range between the voltage limits; 0 without limits.
 */
static double largest_change(const load_step *step)
{
    const storm_rig *rig = step->storm->rig;
    double largest = 0;
    for (size_t k = 0; k < rig->amplifiers; k++) {
        const double half = (rig->upper[k] - rig->lower[k]) / 2;
        if (half > 0)
            largest = fmax(largest, fabs(step->voltage[k] - step->storm->voltage[k]) / half);
    }
    return largest;
}

/*
 * Set a load of a given shape. Its size is such that the largest change of a voltage that
 * compensates the load is load_share of half the range, or, without voltage limits, such that its
 * effect is load_share of the unit of shape errors.
 *   size out  norm of the effect of the load without compensation; 0: the load is not applied,
 *             because it moves nothing, or because the voltages cannot compensate it
 */
static pzs_status size_load(load_step *step, load_shape shape, double *size)
{
    storm *storm = step->storm;
    const double small = 1e-3;
    *size = 0;
    set_load(step, shape);
    scale_load(step, 1);
    const double norm = weighted_distance(storm, storm->load, NULL);
    if (!(norm > 0))
        return PZS_OK;
    scale_load(step, small * storm->rig->scale / norm);
    pzs_status status = find_loaded_best(step);
    const double change = largest_change(step);
    if (PZS_IS_ERROR(status) || weighted_distance(storm, storm->best_shape, step->start) >
                                    load_left * small * storm->rig->scale)
        return status;
    scale_load(step, load_share / (change > 0 ? change : small));
    *size = weighted_distance(storm, storm->load, NULL);
    return find_loaded_best(step);
}

/* Whether the voltages start so near to a limit that they could not compensate any load. */
static bool starts_near_limit(const storm *storm)
{
    const storm_rig *rig = storm->rig;
    for (size_t k = 0; k < rig->amplifiers; k++) {
        const double range = rig->upper[k] - rig->lower[k], voltage = storm->voltage[k];
        if (fmin(rig->upper[k] - voltage, voltage - rig->lower[k]) < load_share / 2 * range)
            return true;
    }
    return false;
}

/*
 * Bring the loop to rest before a load step: at the voltages at which it starts, or, where these
 * are near a limit, at the middle of the limits.
 */
static pzs_status start_loop(load_step *step)
{
    storm *storm = step->storm;
    const storm_rig *rig = storm->rig;
    const bool moves = starts_near_limit(storm);
    const int ticks = moves ? (int)ceil(START_PERIODS * step->period) : 0;
    int rested = 0;
    double largest = 0;
    pzs_status status = PZS_OK;
    for (size_t k = 0; k < rig->amplifiers; k++)
        step->voltage[k] = moves ? (rig->lower[k] + rig->upper[k]) / 2 : storm->voltage[k];
    compute_rest(storm, step->voltage);
    memcpy(step->start, storm->best_shape, rig->targets * sizeof *step->start);
    memcpy(storm->target, step->start, rig->targets * sizeof *storm->target);
    for (int k = 0; k < ticks && rested < step->period && !PZS_IS_ERROR(status); k++) {
        compute_shape(storm);
        const double distance = weighted_distance(storm, storm->shape, step->start);
        largest = fmax(largest, distance);
        rested = distance < at_rest * largest ? rested + 1 : 0;
        status = run_tick(storm);
    }
    return status;
}

/*
 * Simulate the loop under a load that has just been applied, until the shape stays within 5 % of
 * the effect of the load from the best shape. Returns the status of the loop.
 *   size  in   norm of the effect of the load without compensation
 *   ticks out  last tick in which the shape is farther from the best one
 */
static pzs_status run_load(load_step *step, double size, int *ticks)
{
    storm *storm = step->storm;
    const int most = (int)ceil(CERTIFICATE_LOAD_MOST * step->period),
              rest = (int)ceil(LOAD_REST * step->period);
    *ticks = 0;
    for (int k = 0; k < most && k < *ticks + rest; k++) {
        const pzs_status status = run_tick(storm);
        if (PZS_IS_ERROR(status))
            return status;
        compute_shape(storm);
        const double distance = weighted_distance(storm, storm->shape, storm->best_shape) / size;
        if (!(distance <= CERTIFICATE_TOLERANCE))
            *ticks = k + 1;
    }
    return PZS_OK;
}

/*
 * Simulate the step of one load.
 *   ticks out  number of ticks until 5 % of the effect of the load are left; -1: not applied
 */
static pzs_status step_load(load_step *step, load_shape shape, int *ticks)
{
    storm *storm = step->storm;
    double size = 0;
    *ticks = -1;
    pzs_status status = start_loop(step);
    if (!PZS_IS_ERROR(status))
        status = size_load(step, shape, &size);
    if (PZS_IS_ERROR(status) || !(size > 0))
        return status;
    for (size_t i = 0; i < storm->rig->modal.modes; i++)
        storm->inertia.deviation[i] -= step->modal[i];
    storm->has_vibration = storm->has_shape = false;
    return run_load(step, size, ticks);
}

/*
 * Simulate the step of one load on a structure as the model has it. Returns 0, or -1 with error
 * filled.
 */
static int try_load(const storm_rig *rig, load_step *step, load_shape shape, int *ticks,
                    char *error)
{
    static const storm_plant nominal = {.gain = 1, .frequency = 1, .step_limit = 1, .seed = 1};
    storm storm;
    int failed = open_storm(&storm, rig, &nominal, error);
    step->storm = &storm;
    if (!failed) {
        const pzs_status status = step_load(step, shape, ticks);
        if (PZS_IS_ERROR(status))
            failed = explain(&storm, status, error);
    }
    close_storm(&storm);
    return failed;
}

int storm_load_step(const storm_rig *rig, double first, double *periods, char *error)
{
    const modal *modal = &rig->modal;
    load_step step = {.from = mode_from(modal, first)};
    int failed = 0;
    *periods = (double)NAN;
    step.to = step.from + 1;
    while (step.to < modal->modes && modal->frequency[step.to] * rig->interval <= load_angle)
        step.to++;
    step.period = two_pi / (modal->frequency[step.from] * rig->interval);
    step.modal = calloc(modal->modes + rig->targets + rig->amplifiers + 1, sizeof *step.modal);
    if (!step.modal)
        return no_memory(rig->analysis, error);
    step.start = step.modal + modal->modes;
    step.voltage = step.start + rig->targets;
    const int shapes = step.to == step.from + 1 ? 1 : LOAD_SHAPES;
    for (int shape = 0; shape < shapes && !failed; shape++) {
        int ticks;
        failed = try_load(rig, &step, (load_shape)shape, &ticks, error);
        if (!failed && ticks >= 0)
            *periods = fmax(*periods, ticks / step.period);
    }
    free(step.modal);
    return failed;
}
