/* SPDX-License-Identifier: BSD-2-Clause */
/* Storms against a control loop (storm.h). */
#include "storm.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../../lib/core/product.h"
#include "random.h"
#include "../model/mass.h"

enum {
    TARGETS = 10,      /* targets thrown in a storm */
    REST_PERIODS = 12, /* periods of the first mode that the last target stands */
    EVERY_LEAST = 10,  /* fewest and most ticks between two targets */
    EVERY_MOST = 1200,
    REST_LEAST = 1200, /* fewest ticks of rest: six time constants of what the modes do not explain
                        */
    REST_MOST = 20000,
    END_LEAST = 20, /* fewest and most ticks that count as the end */
    END_MOST = 500
};

static const double two_pi = 6.283185307179586;

/* Standard deviation of the noise over the largest reading of the best shape. */
static const double noise_share = 1e-4;

/* A shape that is farther from the target than this many times its size has diverged. */
static const double diverged = 1e6;

/* ---- the rig ---------------------------------------------------------- */

static int no_memory(const analysis *analysis, char *error)
{
    return scene_fault(analysis->design.scene, analysis->design.scene->simulate.at, error,
                       "out of memory");
}

/* Output rows of the sensors: all target rows, or those of the readings of the estimate. */
static void list_rows(storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    const scene_estimate *estimate = &design->scene->estimate;
    size_t at = 0;
    if (!rig->estimator) {
        for (size_t i = 0; i < rig->sensors; i++)
            rig->row[i] = (uint32_t)i;
        return;
    }
    for (int r = 0; r < estimate->readings; r++) {
        const int output = estimate->reading[r].output;
        for (int row = design->named_first[output]; row < design->named_first[output + 1]; row++)
            if (at < rig->sensors)
                rig->row[at++] = (uint32_t)row;
    }
}

/* Static responses of targets and sensors, from the influence matrix of the tables. */
static void fill_static(storm_rig *rig)
{
    const size_t inputs = rig->analysis->design.structure.input.count, n = rig->amplifiers;
    for (size_t i = 0; i < rig->targets; i++)
        memcpy(rig->influence + i * n, rig->analysis->influence + i * inputs, n * sizeof(double));
    for (size_t i = 0; i < rig->sensors; i++)
        memcpy(rig->direct + i * n, rig->analysis->influence + rig->row[i] * inputs,
               n * sizeof(double));
}

/* Limits from which random voltages are drawn; an amplifier without limits is left at 0 V. */
static void fill_limits(storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    for (size_t k = 0; k < rig->amplifiers; k++) {
        const bool is_finite = isfinite(design->lower[k]) && isfinite(design->upper[k]);
        rig->lower[k] = is_finite ? design->lower[k] : 0;
        rig->upper[k] = is_finite ? design->upper[k] : 0;
    }
}

static bool take_memory(storm_rig *rig)
{
    const size_t n = rig->amplifiers, s = rig->sensors, m = rig->targets;
    rig->memory = calloc(s * n + m * n + 2 * n + 1, sizeof *rig->memory);
    rig->row = calloc(s + 1, sizeof *rig->row);
    if (!rig->memory || !rig->row)
        return false;
    rig->direct = rig->memory;
    rig->influence = rig->direct + s * n;
    rig->lower = rig->influence + m * n;
    rig->upper = rig->lower + n;
    return true;
}

void storm_use(storm_rig *rig, const pzs_block *block, int blocks, int delay)
{
    memcpy(rig->block, block, (size_t)blocks * sizeof *block);
    rig->blocks = blocks;
    rig->delay = delay;
}

int storm_open(storm_rig *rig, const analysis *analysis, const estimator *estimator, char *error)
{
    const design *design = &analysis->design;
    memset(rig, 0, sizeof *rig);
    rig->analysis = analysis;
    rig->estimator = estimator;
    rig->is_corrected = true;
    rig->interval = 1 / design->scene->control.rate;
    rig->targets = (size_t)design->targets;
    rig->amplifiers = (size_t)design->amplifiers;
    rig->sensors = estimator ? (size_t)estimator->sensors : rig->targets;
    if (vibration_solve(&rig->vibration, design,
                        design->scene->simulate.given ? design->scene->simulate.modes : 100,
                        MASS_LUMPED, error) < 0)
        return -1;
    if (!take_memory(rig) || !modal_open(&rig->modal, design, &rig->vibration, rig->amplifiers))
        return no_memory(analysis, error);
    list_rows(rig);
    fill_static(rig);
    fill_limits(rig);
    return 0;
}

void storm_close(storm_rig *rig)
{
    modal_close(&rig->modal);
    vibration_free(&rig->vibration);
    free(rig->memory);
    free(rig->row);
    memset(rig, 0, sizeof *rig);
}

/* ---- one run ---------------------------------------------------------- */

/* State of one run. */
typedef struct storm {
    const storm_rig *rig;
    const storm_plant *plant;
    pzs_problem problem; /* with the step limits of the run */
    pzs_block block[PZS_BLOCK_LIMIT];
    int blocks;
    pzs_loop loop;
    void *work;
    inertia inertia;
    uint64_t random;
    int tick, kept;  /* present tick; number of ticks whose readings are kept */
    double noise;    /* standard deviation of the noise of a reading */
    double *memory;  /* memory of the arrays below */
    double *limits;  /* [3][amplifiers] lower and upper limits, step limits of the run (V) */
    double *voltage; /* [amplifiers] present voltages (V) */
    double *before;  /* [amplifiers] voltages before the last tick (V) */
    double *thrown;  /* [targets] present target */
    double *goal;    /* [targets] target at the end, z */
    double *best;    /* [targets] best shape for z on this structure */
    double *shape;   /* [targets] present shape */
    double *part;    /* [targets] work */
    double *sensed;  /* [sensors] readings passed to the loop */
    double *reading; /* [kept][sensors] true readings of the last ticks */
    double *command; /* [kept][amplifiers] voltages of the last ticks (V) */
} storm;

static bool take_run_memory(storm *s)
{
    const size_t n = s->rig->amplifiers, m = s->rig->targets, k = s->rig->sensors;
    const size_t kept = (size_t)s->kept;
    double *at = s->memory = calloc(5 * n + 5 * m + k + kept * (k + n) + 1, sizeof *s->memory);
    if (!at || !inertia_open(&s->inertia, &s->rig->modal))
        return false;
    s->limits = at, at += 3 * n;
    s->voltage = at, at += n;
    s->before = at, at += n;
    s->thrown = at, at += m;
    s->goal = at, at += m;
    s->best = at, at += m;
    s->shape = at, at += m;
    s->part = at, at += m;
    s->sensed = at, at += k;
    s->reading = at, at += kept * k;
    s->command = at;
    return true;
}

/* y [rows] = factor a [rows][columns] x */
static void multiply(double *y, const double *a, const double *x, size_t rows, size_t columns,
                     double factor)
{
    pzs_product_matrix(y, a, x, rows, columns);
    for (size_t i = 0; i < rows; i++)
        y[i] *= factor;
}

/* Give the problem the limits of the run. */
static void set_limits(storm *s)
{
    const size_t n = s->rig->amplifiers;
    const design *design = &s->rig->analysis->design;
    const double factor = s->plant->step_limit;
    const bool is_free = !isfinite(factor);
    for (size_t k = 0; k < n; k++) {
        const bool is_held = !(design->lower[k] < design->upper[k]);
        const bool is_limited = !is_free || is_held;
        s->limits[k] = is_limited ? s->problem.lower[k] : -HUGE_VAL;
        s->limits[n + k] = is_limited ? s->problem.upper[k] : HUGE_VAL;
        s->limits[2 * n + k] = is_free ? HUGE_VAL : s->problem.step_limit[k] * factor;
    }
    s->problem.lower = s->limits;
    s->problem.upper = s->limits + n;
    s->problem.step_limit = s->limits + 2 * n;
    s->problem.crc = pzs_problem_crc(&s->problem);
}

/*
 * Tables of the step block with the limits of the run. A law for comparison keeps its memory beside
 * its problem, so the problem is replaced in place. A run without limits omits the blocks behind
 * the step, because converter steps and held electrodes would hide the growth.
 */
static void set_tables(storm *s)
{
    for (int k = 0; k < s->rig->blocks; k++) {
        s->block[k] = s->rig->block[k];
        if (s->block[k].type->phase > PZS_PHASE_STEP && !isfinite(s->plant->step_limit))
            return;
        s->blocks = k + 1;
        if (s->block[k].type->phase != PZS_PHASE_STEP)
            continue;
        s->problem = *(const pzs_problem *)s->block[k].tables;
        set_limits(s);
        if (s->block[k].type == &pzs_step_block)
            s->block[k].tables = &s->problem;
        else
            *(pzs_problem *)(uintptr_t)s->block[k].tables = s->problem;
    }
}

static pzs_status open_loop(storm *s)
{
    double none;
    const size_t count = (size_t)s->blocks;
    pzs_status status = pzs_loop_init(&s->loop, s->block, count, NULL, &none, 0);
    if (status != PZS_E_WORKSPACE)
        return status;
    const size_t need = (size_t)s->loop.info.where;
    s->work = malloc(need);
    return s->work ? pzs_loop_init(&s->loop, s->block, count, NULL, s->work, need)
                   : PZS_E_WORKSPACE;
}

/* Best shape for the goal within the voltage limits, on the structure of the run. */
static pzs_status find_best(storm *s)
{
    const size_t n = s->rig->amplifiers, m = s->rig->targets;
    const pzs_problem *given = &s->rig->analysis->design.problem;
    pzs_problem problem = *given;
    pzs_control control;
    double *influence = malloc((m * n + n) * sizeof *influence);
    void *work = malloc(PZS_CONTROL_BYTES(n, m));
    pzs_status status = PZS_E_WORKSPACE;
    if (influence && work) {
        double *wide = influence + m * n;
        for (size_t i = 0; i < m * n; i++)
            influence[i] = s->plant->gain * given->influence[i];
        for (size_t k = 0; k < n; k++)
            wide[k] = HUGE_VAL;
        problem.step_limit = wide;
        problem.hessian = NULL;
        problem.crc = pzs_problem_crc(&problem);
        status = pzs_control_init(&control, &problem, influence, work, PZS_CONTROL_BYTES(n, m));
        if (!PZS_IS_ERROR(status))
            status = pzs_step(&control, s->goal);
        if (!PZS_IS_ERROR(status))
            multiply(s->best, s->rig->influence, control.info.voltage, m, n, s->plant->gain);
    }
    free(influence);
    free(work);
    return status;
}

static int explain(const storm *s, pzs_status status, char *error)
{
    const scene *scene = s->rig->analysis->design.scene;
    return scene_fault(scene, scene->simulate.at, error, "storm: %s", pzs_status_text(status));
}

static void close_storm(storm *s)
{
    inertia_close(&s->inertia);
    free(s->memory);
    free(s->work);
}

/* Weighted distance of two shapes; y NULL: weighted size of x. */
static double apart(const storm *s, const double *x, const double *y)
{
    return sqrt(design_squares(&s->rig->analysis->design, x, y));
}

static int open_storm(storm *s, const storm_rig *rig, const storm_plant *plant, char *error)
{
    memset(s, 0, sizeof *s);
    s->rig = rig;
    s->plant = plant;
    s->random = plant->seed;
    s->kept = rig->delay + plant->more_delay + 1;
    if (!take_run_memory(s))
        return no_memory(rig->analysis, error);
    s->inertia.gain = plant->gain;
    s->inertia.stretch = plant->frequency;
    set_tables(s);
    memcpy(s->goal, rig->analysis->design.target, rig->targets * sizeof *s->goal);
    pzs_status status = open_loop(s);
    if (!PZS_IS_ERROR(status))
        status = find_best(s);
    if (PZS_IS_ERROR(status))
        return explain(s, status, error);
    memcpy(s->voltage, s->loop.info.voltage, rig->amplifiers * sizeof *s->voltage);
    inertia_rest(&s->inertia, s->voltage);
    return 0;
}

/* ---- ticks ------------------------------------------------------------ */

/* Address of the vector of a tick, of length n, in a ring of the last ticks; ticks before the start
 * are those of the start. */
static double *late(const storm *s, double *ring, int tick, size_t n)
{
    return ring + (size_t)((tick > 0 ? tick : 0) % s->kept) * n;
}

/* Present shape. */
static void observe_shape(storm *s)
{
    const storm_rig *rig = s->rig;
    multiply(s->shape, rig->influence, s->voltage, rig->targets, rig->amplifiers, s->plant->gain);
    inertia_observe(&s->inertia, 0, rig->targets, s->part);
    for (size_t i = 0; i < rig->targets; i++)
        s->shape[i] += s->part[i];
}

/* Present readings, kept with the voltages for the time when they arrive. */
static void observe(storm *s)
{
    const storm_rig *rig = s->rig;
    const size_t n = rig->amplifiers;
    double *reading = late(s, s->reading, s->tick, rig->sensors);
    memcpy(late(s, s->command, s->tick, n), s->voltage, n * sizeof *s->voltage);
    if (!rig->estimator) {
        observe_shape(s);
        memcpy(reading, s->shape, rig->sensors * sizeof *reading);
        return;
    }
    multiply(reading, rig->direct, s->voltage, rig->sensors, n, s->plant->gain);
    for (size_t i = 0; i < rig->sensors; i++) {
        inertia_observe(&s->inertia, rig->row[i], 1, s->part);
        reading[i] += s->part[0];
    }
}

/* Readings as they arrive at the loop: late, with noise, corrected where the caller has to. */
static void sense(storm *s)
{
    const storm_rig *rig = s->rig;
    const size_t n = rig->amplifiers;
    const double *shown =
        late(s, s->reading, s->tick - rig->delay - s->plant->more_delay, rig->sensors);
    const double *then = late(s, s->command, s->tick - rig->delay, n);
    for (size_t i = 0; i < rig->sensors; i++) {
        s->sensed[i] = shown[i] + (s->noise > 0 ? s->noise * random_noise(&s->random) : 0);
        for (size_t k = 0; k < n && rig->is_corrected && rig->delay > 0; k++)
            s->sensed[i] += rig->direct[i * n + k] * (s->voltage[k] - then[k]);
    }
}

/* One tick: measure, choose voltages, let the interval pass. Returns the status of the loop. */
static pzs_status run_tick(storm *s)
{
    const size_t n = s->rig->amplifiers;
    observe(s);
    sense(s);
    memcpy(s->before, s->voltage, n * sizeof *s->voltage);
    const pzs_status status = pzs_loop_tick(&s->loop, s->thrown, s->sensed);
    memcpy(s->voltage, s->loop.info.voltage, n * sizeof *s->voltage);
    inertia_jump(&s->inertia, s->voltage);
    inertia_advance(&s->inertia, s->rig->interval);
    s->tick++;
    return status;
}

/* ---- storm ------------------------------------------------------------ */

static int clamp_ticks(double ticks, int least, int most)
{
    return (int)fmin(fmax(ceil(ticks), least), most);
}

/* Throw a target: z, -z, or the shape of random voltages. */
static void throw_target(storm *s)
{
    const storm_rig *rig = s->rig;
    const size_t n = rig->amplifiers;
    const int kind = random_int(&s->random, 4);
    if (kind < 2) {
        for (size_t i = 0; i < rig->targets; i++)
            s->thrown[i] = kind == 0 ? s->goal[i] : -s->goal[i];
        return;
    }
    for (size_t k = 0; k < n; k++) {
        const double part = 2 * random_uniform(&s->random) - 1, sign = part < 0 ? -1 : 1;
        const double middle = (rig->lower[k] + rig->upper[k]) / 2,
                     half = (rig->upper[k] - rig->lower[k]) / 2;
        s->before[k] = middle + 2 * half * (kind == 2 ? part : sign);
    }
    multiply(s->thrown, rig->influence, s->before, rig->targets, n, 1);
}

/* Noise in proportion to the largest entry of the best shape. */
static void set_noise(storm *s)
{
    double largest = 0;
    for (size_t i = 0; i < s->rig->targets; i++)
        largest = fmax(largest, fabs(s->best[i]));
    s->noise = noise_share * largest;
}

static pzs_status run_storm(storm *s, storm_result *result)
{
    const double period = two_pi / (s->rig->modal.frequency[0] * s->rig->interval);
    const int every = clamp_ticks(0.6 * period, EVERY_LEAST, EVERY_MOST),
              rest = clamp_ticks(REST_PERIODS * period, REST_LEAST, REST_MOST),
              end = clamp_ticks(period, END_LEAST, END_MOST);
    const double size = fmax(apart(s, s->goal, NULL), 1e-300);
    int quiet = 0;
    result->ticks = TARGETS * every + rest;
    for (int k = 0; k < result->ticks; k++) {
        if (k == TARGETS * every)
            memcpy(s->thrown, s->goal, s->rig->targets * sizeof *s->thrown);
        else if (k < TARGETS * every && k % every == 0)
            throw_target(s);
        const pzs_status status = run_tick(s);
        if (PZS_IS_ERROR(status))
            return status;
        if (k < TARGETS * every && k % 8 != 0)
            continue;
        observe_shape(s);
        const double distance = apart(s, s->shape, s->best) / size;
        result->peak = fmax(result->peak, distance);
        if (k + end >= result->ticks)
            result->end = fmax(result->end, distance);
        quiet = distance < STORM_TOLERANCE / 2 && k >= TARGETS * every ? quiet + 1 : 0;
        if (quiet > end) {
            result->end = distance;
            result->ticks = k + 1;
        }
        if (!(distance < diverged)) {
            result->end = HUGE_VAL;
            break;
        }
    }
    result->passed = result->end <= STORM_TOLERANCE;
    return PZS_OK;
}

int storm_run(const storm_rig *rig, const storm_plant *plant, storm_result *result, char *error)
{
    storm s;
    memset(result, 0, sizeof *result);
    int failed = open_storm(&s, rig, plant, error);
    if (!failed) {
        set_noise(&s);
        const pzs_status status = run_storm(&s, result);
        if (PZS_IS_ERROR(status))
            failed = explain(&s, status, error);
    }
    close_storm(&s);
    return failed;
}

/* ---- growth ----------------------------------------------------------- */

/* Size of the vibration and of the last change of the voltages, in displacements of the targets. */
static double amplitude(storm *s)
{
    const size_t n = s->rig->amplifiers, m = s->rig->targets;
    double *moved = s->best, *vibrating = s->thrown;
    for (size_t k = 0; k < n; k++)
        s->before[k] = s->voltage[k] - s->before[k];
    multiply(moved, s->rig->influence, s->before, m, n, 1);
    inertia_observe(&s->inertia, 0, m, vibrating);
    const double size = hypot(apart(s, moved, NULL), apart(s, vibrating, NULL));
    memset(vibrating, 0, m * sizeof *vibrating);
    return size;
}

/* Slope of a straight line through y [count] over its index. */
static double slope(const double *y, int count)
{
    const double middle = (count - 1) / 2.0;
    double product = 0, square = 0;
    for (int i = 0; i < count; i++) {
        product += (i - middle) * y[i];
        square += (i - middle) * (i - middle);
    }
    return square > 0 ? product / square : 0;
}

static pzs_status run_free(storm *s, int ticks, double *size, storm_result *result)
{
    const modal *modal = &s->rig->modal;
    const double scale = fmax(apart(s, s->goal, NULL), 1e-12);
    for (size_t i = 0; i < modal->modes; i++) {
        s->inertia.deviation[i] = 2 * random_uniform(&s->random) - 1;
        s->inertia.velocity[i] = 2 * random_uniform(&s->random) - 1;
    }
    const double unit = 1e-3 * scale / fmax(amplitude(s), 1e-300);
    for (size_t i = 0; i < modal->modes; i++) {
        s->inertia.deviation[i] *= unit;
        s->inertia.velocity[i] *= unit;
    }
    memset(s->thrown, 0, s->rig->targets * sizeof *s->thrown);
    int k = 0;
    for (; k < ticks; k++) {
        const pzs_status status = run_tick(s);
        if (PZS_IS_ERROR(status))
            return status;
        size[k] = log(fmax(amplitude(s), 1e-300));
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
    storm s;
    double *size = malloc((size_t)ticks * sizeof *size);
    memset(result, 0, sizeof *result);
    int failed = open_storm(&s, rig, plant, error);
    if (!failed && !size)
        failed = no_memory(rig->analysis, error);
    if (!failed) {
        const pzs_status status = run_free(&s, ticks, size, result);
        if (PZS_IS_ERROR(status))
            failed = explain(&s, status, error);
    }
    close_storm(&s);
    free(size);
    return failed;
}
