/*
 * Fault detector of electrodes in a loop that damps vibration (lib/control/pulse_faults.c), on
 * plates with mass that differ from their model, with hysteresis of the ceramic.
 *
 *   detector [TICKS [NAME]]   number of ticks without a fault for each row of the table, default
 *                             3000, of which only a part of the runs with faults is made; NAME:
 *                             only rows whose name contains this word
 *
 * Prints for healthy plates how many electrodes the detector suspects and holds, while the target
 * jumps, and while loads jump during its test pulses; and for plates on which one electrode fails
 * during a storm (jumps of the target that the voltages cannot follow) how many dead, stuck and
 * reversed electrodes it names after the storm. Most plates are measured at every node, some by six
 * or eight sensors. Returns 0 where no healthy electrode is held, the supervisor takes control away
 * from no healthy plate, and the part of the faults that its row demands is named.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/estimator.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/modal.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/imperfections.h"
#include "../../host_tools/simulate/inertia.h"
#include "../../host_tools/simulate/random.h"
#include "../../host_tools/tables/detection.h"
#include "../../host_tools/tables/loop_blocks.h"
#include "../../host_tools/model/wiring_test.h"
#include "../rigs/scene_run.h"

#define LINEAR                                                                                     \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;"            \
    "simulate.amplifiers.step=0;"                                                                  \
    "simulate.events=[{at: 9, dead: [v_1_1], announced: detected}]"

/* Readings of six and of eight sensors in the scene plate-few-sensors. */
#define READING(name) "{output: " #name ", noise: 1e-6}"
#define SIX_READINGS                                                                               \
    READING(tip_left)                                                                              \
    ", " READING(tip) ", " READING(tip_right) ", " READING(half_left) ", " READING(                \
        half) ", " READING(half_right)
#define EIGHT_READINGS SIX_READINGS ", " READING(inner_left) ", " READING(inner_right)

enum { CERAMIC_PLAYS = 4, MODES = 20, INPUTS = 64, OUTPUTS = 128 };

/* A damped loop with a fault detector, around a plate. */
typedef struct rig {
    scene_run run;
    estimator estimator;
    damper damper;
    wiring_test pulses;
    loop_blocks blocks;
    vibration vibration;
    modal modal;
    inertia inertia;
    pzs_loop loop;
    void *work;
    size_t bytes; /* memory of the loop */
    size_t inputs, outputs;
    size_t sensors;
    size_t sensor_row[OUTPUTS]; /* [sensors] output that each sensor measures */
    double noise, missed;       /* RMS noise of a reading (m), and chance that a tick is missed */
    double gain, hysteresis; /* static response relative to the model; width of the hysteresis loop
                                relative to the voltage range */
    double *memory;          /* one allocation that holds the arrays from `acting` on */
    double *acting;          /* [inputs] voltages that act on the ceramic (V) */
    double *load; /* [inputs] constant load, as the voltages that would move the plate as far (V) */
    double *sum;  /* [inputs] sums of the voltages that act and of the load (V) */
    double *play; /* [inputs][CERAMIC_PLAYS] plays of the hysteresis (V) */
    double *readings; /* [sensors] readings (m) */
    double *wanted;   /* [outputs] target shape (m) */
    electrode_fault fault[INPUTS];
    double wire[INPUTS]; /* 1, or -1 for an electrode with exchanged wires */
    uint64_t random;
    int next_jump, every, tick; /* tick of the next target; mean number of ticks between targets;
                                   present tick */
} rig;

static int complain(const char *error)
{
    printf("not ok - %s\n", error);
    return -1;
}

/* List the outputs that the sensors measure: all target nodes, or those of the estimator. */
static void list_sensors(rig *r)
{
    const design *design = &r->run.analysis.design;
    r->sensors = 0;
    for (int k = 0; k < design->estimate.readings; k++)
        r->sensor_row[r->sensors++] =
            (size_t)design->named_first[design->estimate.reading[k].output];
    for (size_t i = 0; i < r->outputs && design->estimate.readings == 0; i++)
        r->sensor_row[r->sensors++] = i;
}

/* Make the tables of the loop, with the settings that its certificate chooses. */
static int open_tables(rig *r)
{
    analysis *analysis = &r->run.analysis;
    const bool is_few = analysis->design.estimate.readings > 0;
    if (certify_loop(analysis, r->run.error) < 0)
        return complain(r->run.error);
    const damper_options options = damper_options_of(analysis);
    if (is_few && estimator_open(&r->estimator, analysis, r->run.error) < 0)
        return complain(r->run.error);
    const estimator *few = is_few ? &r->estimator : NULL;
    if (damper_make(&r->damper, analysis, few, &options, r->run.error) < 0)
        return complain(r->run.error);
    if (!wiring_test_detector_open(&r->pulses, analysis, few))
        return complain("out of memory");
    loop_blocks_fill(&r->blocks, &analysis->design, &r->estimator, &r->damper);
    loop_blocks_test(&r->blocks, NULL, &r->pulses);
    return 0;
}

/* Make the tables of the loop, and the modal model of the plate. */
static int open_structure(rig *r, const char *scene, const char *change)
{
    analysis *analysis = &r->run.analysis;
    if (scene_run_open(&r->run, scene, change) < 0 ||
        analysis_influence(analysis, r->run.error) < 0)
        return complain(r->run.error);
    certificate_make(&analysis->certificate, analysis);
    analysis->design.simulate.delay = 0;
    if (open_tables(r) < 0)
        return -1;
    if (vibration_solve(&r->vibration, &analysis->design, MODES, MASS_LUMPED, r->run.error) < 0)
        return complain(r->run.error);
    r->inputs = (size_t)analysis->design.amplifiers;
    r->outputs = (size_t)analysis->design.targets;
    list_sensors(r);
    const bool has_memory = modal_open(&r->modal, &analysis->design, &r->vibration, r->inputs) &&
                            inertia_open(&r->inertia, &r->modal);
    return has_memory && r->inputs <= INPUTS && r->outputs <= OUTPUTS ? 0
                                                                      : complain("out of memory");
}

/* Number of reals in the memory of a rig. */
static size_t count_reals(const rig *r)
{
    return (3 + CERAMIC_PLAYS) * r->inputs + 2 * r->outputs;
}

/*
 * Open a rig.
 *   compensated in  width, relative to the voltage range, of the hysteresis loop that the control
 *                   loop compensates; 0: no compensation
 *   readings    in  list of the sensors as in the key `estimate.readings` of a scene; empty: every
 *                   node is measured
 */
static int open_rig(rig *r, double compensated, const char *readings)
{
    double too_small;
    char change[2000];
    const double share = compensated * 16 / 5, slope = 1 - share, weight = share / CERAMIC_PLAYS;
    memset(r, 0, sizeof *r);
    const int used = *readings
                         ? snprintf(change, sizeof change,
                                    "estimate.readings=[%s];estimate.tolerance=0.9;", readings)
                         : 0;
    snprintf(change + used, sizeof change - (size_t)used,
             compensated > 0 ? LINEAR ";hysteresis={range: [-300, 300], slopes: [%g, %g, %g, %g], "
                                      "slack: [37.5, 75, 112.5, 150], above: [%g, %g, %g, %g]}"
                             : LINEAR,
             slope, slope, slope, slope, weight, weight, weight, weight);
    if (open_structure(r, *readings ? "plate-few-sensors" : "plate-closed-loop", change) < 0)
        return -1;
    (void)pzs_loop_init(&r->loop, r->blocks.block, (size_t)r->blocks.count, NULL, &too_small, 0);
    r->bytes = (size_t)r->loop.info.where;
    r->work = malloc(r->bytes);
    r->memory = calloc(count_reals(r), sizeof *r->memory);
    if (!r->work || !r->memory)
        return complain("out of memory");
    r->acting = r->memory;
    r->load = r->acting + r->inputs;
    r->sum = r->load + r->inputs;
    r->play = r->sum + r->inputs;
    r->readings = r->play + CERAMIC_PLAYS * r->inputs;
    r->wanted = r->readings + r->outputs;
    return 0;
}

static void close_rig(rig *r)
{
    free(r->work);
    free(r->memory);
    inertia_close(&r->inertia);
    modal_close(&r->modal);
    vibration_free(&r->vibration);
    damper_close(&r->damper);
    estimator_close(&r->estimator);
    wiring_test_close(&r->pulses);
    scene_run_close(&r->run);
}

static double uniform(rig *r, double low, double high)
{
    return low + (high - low) * random_uniform(&r->random);
}

/* Return loop and plate to rest at zero voltages. */
static void start(rig *r, uint64_t seed, double gain, double frequency, double hysteresis,
                  int every)
{
    (void)pzs_loop_init(&r->loop, r->blocks.block, (size_t)r->blocks.count, NULL, r->work,
                        r->bytes);
    memset(r->memory, 0, count_reals(r) * sizeof *r->memory);
    memset(r->fault, 0, sizeof r->fault);
    for (size_t j = 0; j < INPUTS; j++)
        r->wire[j] = 1;
    inertia_rest(&r->inertia, r->acting);
    r->inertia.gain = gain;
    r->inertia.stretch = frequency;
    r->inertia.interval = 0;
    r->gain = gain;
    r->hysteresis = hysteresis;
    r->every = every;
    r->next_jump = 0;
    r->tick = 0;
    r->random = seed;
}

/* Set a new target: a part of the scene's, or the shape of random voltages. */
static void jump(rig *r)
{
    const design *design = &r->run.analysis.design;
    const size_t all = design->structure.input.count;
    r->next_jump = r->tick + (int)uniform(r, 0.5 * r->every, 1.5 * r->every);
    const double factor = uniform(r, -1, 1);
    double voltage[INPUTS];
    for (size_t j = 0; j < r->inputs; j++)
        voltage[j] = 0.5 * uniform(r, design->lower[j], design->upper[j]);
    for (size_t i = 0; i < r->outputs; i++) {
        double random_shape = 0;
        for (size_t j = 0; j < r->inputs; j++)
            random_shape += r->run.analysis.influence[i * all + j] * voltage[j];
        r->wanted[i] = factor > 0 ? factor * design->target[i] : random_shape;
    }
}

/* Voltage that acts on the ceramic of electrode j (V). */
static double act(rig *r, size_t j, double voltage)
{
    const design *design = &r->run.analysis.design;
    double mean = 0;
    for (int i = 0; i < CERAMIC_PLAYS; i++) {
        const double slack =
            (design->upper[j] - design->lower[j]) / 2 * (i + 1) / (2 * CERAMIC_PLAYS);
        double *play = &r->play[j * CERAMIC_PLAYS + (size_t)i];
        *play = fmin(fmax(*play, voltage - slack), voltage + slack);
        mean += *play / CERAMIC_PLAYS;
    }
    return voltage + r->hysteresis * 16 / 5 * (mean - voltage);
}

/* Run one tick: readings, loop, plate. */
static pzs_status run_tick(rig *r)
{
    const size_t all = r->run.analysis.design.structure.input.count;
    double next[INPUTS];
    pzs_status status = PZS_OK;
    if (r->tick >= r->next_jump)
        jump(r);
    for (size_t i = 0; i < r->sensors; i++) {
        const size_t row = r->sensor_row[i];
        inertia_observe(&r->inertia, row, 1, &r->readings[i]);
        for (size_t j = 0; j < r->inputs; j++)
            r->readings[i] += r->gain * r->run.analysis.influence[row * all + j] * r->sum[j];
        r->readings[i] += r->noise * random_noise(&r->random);
    }
    if (r->tick > 0 && uniform(r, 0, 1) < r->missed)
        (void)pzs_loop_skip(&r->loop, 1);
    else
        status = pzs_loop_tick(&r->loop, r->wanted, r->readings);
    for (size_t j = 0; j < r->inputs; j++) {
        if (r->fault[j] == ELECTRODE_DEAD)
            next[j] = 0;
        else if (r->fault[j] == ELECTRODE_STUCK)
            next[j] = r->acting[j];
        else
            next[j] = act(r, j, r->wire[j] * r->loop.info.voltage[j]);
    }
    memcpy(r->acting, next, r->inputs * sizeof *next);
    for (size_t j = 0; j < r->inputs; j++)
        r->sum[j] = r->acting[j] + r->load[j];
    inertia_jump(&r->inertia, r->sum);
    inertia_advance(&r->inertia, 1 / r->run.analysis.design.control.rate);
    r->tick++;
    return status;
}

/* Structures around the model: static gain and natural frequencies. */
static const double gains[] = {1, 0.8, 1.33}, frequencies[] = {1, 0.9, 1.1};

/* Return the fault detector of the loop. */
static const pzs_pulse_detector *detector_of(const rig *r)
{
    return pzs_loop_find(&r->loop, &pzs_pulse_detector_block);
}

/*
 * Numbers of ticks, of electrodes that were suspected, of electrodes that were held, and of runs in
 * which the supervisor took control away.
 */
typedef struct tally {
    long ticks, tests, held, alarms;
} tally;

/* Whether the supervisor has taken control away. */
static bool is_stopped(const rig *r)
{
    const pzs_supervisor *supervisor = pzs_loop_find(&r->loop, &pzs_supervisor_block);
    return supervisor->info.mode == PZS_MODE_STOPPING || supervisor->info.mode == PZS_MODE_LATCHED;
}

/* Release all electrodes that the detector holds. */
static void release_held(rig *r)
{
    for (size_t j = 0; j < r->inputs; j++)
        if (r->loop.info.electrode[j] == PZS_ELECTRODE_HELD)
            (void)pzs_release(r->loop.info.control, (uint16_t)j);
}

/* Run healthy electrodes on nine structures; an electrode that is held is released. */
static tally run_healthy(rig *r, int ticks, int every, double hysteresis)
{
    tally tally = {0};
    for (unsigned k = 0; k < 9; k++) {
        start(r, k + 1, gains[k % 3], frequencies[k / 3], hysteresis, every);
        for (int tick = 0; tick < ticks / 9; tick++, tally.ticks++) {
            (void)run_tick(r);
            release_held(r);
        }
        tally.held += detector_of(r)->info.found;
        tally.tests += detector_of(r)->info.tests;
        tally.alarms += is_stopped(r);
    }
    return tally;
}

/*
 * Runs with loads, in ticks: time between two motions of the target, time from a motion until one
 * electrode seems to be dead, time from then until the load jumps again, and mean time between its
 * jumps.
 */
enum { LOAD_EPISODE = 1250, LOAD_DELAY = 60, LOAD_CALM = 200, LOAD_EVERY = 150 };

/* Return the electrode that makes the test pulses of a proof, or one at random. */
static size_t tested_electrode(rig *r)
{
    size_t tested = (size_t)uniform(r, 0, (double)r->inputs) % r->inputs, first = tested;
    for (size_t k = 0; k < r->inputs; k++) {
        const size_t j = (first + k) % r->inputs;
        if (r->loop.info.electrode[j] == PZS_ELECTRODE_TESTED)
            tested = j;
    }
    return tested;
}

/*
 * Let the load jump. The new load has the shape of an electrode under test, or that of voltages at
 * all electrodes.
 */
static void jump_load(rig *r)
{
    const design *design = &r->run.analysis.design;
    const size_t tested = tested_electrode(r);
    const bool is_single = uniform(r, 0, 1) < 0.7;
    for (size_t j = 0; j < r->inputs; j++) {
        const double size = 0.15 * (design->upper[j] - design->lower[j]);
        if (!is_single || j == tested)
            r->load[j] += (is_single ? 1 : 0.3) * uniform(r, -size, size);
    }
}

/*
 * Move the target and change the load in one tick of a run with loads. At every second motion of
 * the target one electrode is made to look dead by a load that takes its voltage away, so that it
 * is tested; during the test the load jumps.
 *   next_load in/out  tick of the next jump of the load
 */
static void disturb(rig *r, int *next_load)
{
    const int tick = r->tick % (2 * LOAD_EPISODE);
    if (tick % LOAD_EPISODE == 0)
        jump(r);
    if (tick == LOAD_EPISODE)
        memset(r->load, 0, r->inputs * sizeof *r->load);
    if (tick == LOAD_DELAY) {
        const size_t j = tested_electrode(r);
        r->load[j] = -uniform(r, 0.7, 1.4) * r->loop.info.voltage[j];
        *next_load = r->tick + LOAD_CALM;
    }
    if (r->tick >= *next_load && tick > LOAD_DELAY) {
        jump_load(r);
        *next_load = r->tick + (int)uniform(r, 0.2 * LOAD_EVERY, 1.8 * LOAD_EVERY);
    }
}

/*
 * Run healthy electrodes on nine structures under loads that jump during test pulses; an electrode
 * that is held is released.
 */
static tally run_loads(rig *r, int ticks, double hysteresis)
{
    tally tally = {0};
    for (unsigned k = 0; k < 9; k++) {
        int next_load = LOAD_EPISODE;
        start(r, 1000 + k, gains[k % 3], frequencies[k / 3], hysteresis, INT_MAX / 2);
        for (int tick = 0; tick < ticks / 9; tick++, tally.ticks++) {
            disturb(r, &next_load);
            (void)run_tick(r);
            release_held(r);
        }
        tally.held += detector_of(r)->info.found;
        tally.tests += detector_of(r)->info.tests;
        tally.alarms += is_stopped(r);
    }
    return tally;
}

/* Results of runs in each of which one electrode fails. */
typedef struct named {
    int runs, right, exact; /* right: the electrode is held; exact: its fault is named, too */
    int wrong;              /* healthy electrodes that are held */
    int slight;             /* faulty electrodes that are not held, and lack at most 5 % of their
                               voltage range */
    int slowest;            /* longest time from the end of the storm until the electrode is held */
    double sum;             /* sum of these times */
} named;

enum {
    RUNS_OF_EACH = 4,
    STORM_TICKS = 200,
    REST_TICKS = 700,
    PROOF_TICKS = 3000,
    STORM_EVERY = 40
};

/* Let electrode j fail. */
static void fail(rig *r, size_t j, pzs_electrode_fault fault)
{
    if (fault == PZS_FAULT_REVERSED)
        r->wire[j] = -1;
    else
        r->fault[j] = fault == PZS_FAULT_DEAD ? ELECTRODE_DEAD : ELECTRODE_STUCK;
}

/* Run some ticks, with a mean number of ticks between jumps of the target; 0: without jumps. */
static void run_ticks(rig *r, int ticks, int every)
{
    r->every = every > 0 ? every : r->every;
    r->next_jump = every > 0 ? r->tick : INT_MAX;
    for (int tick = 0; tick < ticks; tick++)
        (void)run_tick(r);
}

static bool is_held(const rig *r, size_t j)
{
    return r->loop.info.electrode[j] == PZS_ELECTRODE_HELD;
}

/* Whether electrode j lacks at most 5 % of its voltage range. */
static bool lacks_little(const rig *r, size_t j)
{
    const design *design = &r->run.analysis.design;
    const double lacking = fabs(r->loop.info.voltage[j] - r->acting[j]);
    return lacking <= 0.05 * (design->upper[j] - design->lower[j]);
}

/*
 * Let electrodes j and k fail in a storm that follows a rest, and run until both are held, or for
 * PROOF_TICKS after the storm. Without a second fault both numbers are equal.
 */
static void try_fault(rig *r, size_t j, size_t k, pzs_electrode_fault fault, named *result)
{
    int tick = 0;
    run_ticks(r, STORM_TICKS, STORM_EVERY);
    run_ticks(r, REST_TICKS, 0);
    fail(r, j, fault);
    if (k != j)
        fail(r, k, fault);
    run_ticks(r, STORM_TICKS, STORM_EVERY);
    r->next_jump = INT_MAX;
    const int most = k != j ? 2 * PROOF_TICKS : PROOF_TICKS;
    while (tick < most && !(is_held(r, j) && is_held(r, k))) {
        (void)run_tick(r);
        tick++;
    }
    result->runs++;
    result->right += is_held(r, j);
    result->exact += is_held(r, j) && detector_of(r)->info.fault[j] == fault;
    result->slight += !is_held(r, j) && lacks_little(r, j);
    result->slowest = tick < most && tick > result->slowest ? tick : result->slowest;
    result->sum += tick < most ? tick : 0;
    for (size_t other = 0; other < r->inputs; other++)
        result->wrong += other != j && other != k && is_held(r, other);
}

/* One row of the measurement. */
typedef struct row {
    const char *name;
    double ceramic, compensated; /* width of the hysteresis loop of the ceramic, and of the one that
                                    the loop compensates, relative to the voltage range */
    double noise, missed;        /* RMS noise of a reading (m), and chance that a tick is missed */
    size_t second; /* distance from the faulty electrode to a second one that fails at the same
                      time; 0: there is none */
    int least;     /* smallest part of the faulty electrodes that must be held (%) */
    const char *readings; /* sensors, as in the key `estimate.readings` of a scene; empty: every
                             node is measured */
} row;

static const row rows[] = {
    {"no hysteresis", 0, 0, 1e-7, 0, 0, 95, ""},
    {"20 % hysteresis, compensated", 0.2, 0.2, 1e-7, 0, 0, 95, ""},
    {"6 sensors, 20 % hysteresis, compensated", 0.2, 0.2, 1e-6, 0, 0, 90, SIX_READINGS},
    {"20 % hysteresis, 15 % compensated", 0.2, 0.15, 1e-7, 0, 0, 90, ""},
    {"10 % hysteresis, not compensated", 0.1, 0, 1e-7, 0, 0, 90, ""},
    {"30 % hysteresis, compensated", 0.3, 0.3, 1e-7, 0, 0, 95, ""},
    {"30 % hysteresis, not compensated", 0.3, 0, 1e-7, 0, 0, 0, ""},
    {"20 % hysteresis, ten times the noise", 0.2, 0.2, 1e-6, 0, 0, 95, ""},
    {"20 % hysteresis, 5 % of the ticks missed", 0.2, 0.2, 1e-7, 0.05, 0, 85, ""},
    {"20 % hysteresis, two electrodes at once", 0.2, 0.2, 1e-7, 0, 7, 85, ""},
    {"8 sensors, no hysteresis", 0, 0, 1e-6, 0, 0, 90, EIGHT_READINGS},
    {"6 sensors, no hysteresis", 0, 0, 1e-6, 0, 0, 80, SIX_READINGS},
    {"8 sensors, 20 % hysteresis, compensated", 0.2, 0.2, 1e-6, 0, 0, 90, EIGHT_READINGS},
};
enum { ROWS = sizeof rows / sizeof *rows, QUICK_ROWS = 3 };

/*
 * Let electrodes fail one after the other, RUNS_OF_EACH times each, on structures around the model.
 *   stride in  only every `stride`-th of these runs is made
 */
static named run_faults(rig *r, const row *row, pzs_electrode_fault fault, size_t stride)
{
    named result = {0};
    for (size_t k = 0; k < RUNS_OF_EACH * r->inputs; k += stride) {
        const size_t j = k % r->inputs, seed = 100 + j + 1000 * (k / r->inputs);
        start(r, seed, gains[k % 3], frequencies[k / 3 % 3], row->ceramic, STORM_EVERY);
        try_fault(r, j, (j + row->second) % r->inputs, fault, &result);
    }
    return result;
}

/*
 * Compare what `pzs check` says of the fault detector with the law: the ratio of response to noise
 * is inversely proportional to the stated noise, and above 17 every electrode is said to be
 * detectable, below it none. Returns the number of failures.
 */
static long check_detection(rig *r)
{
    static const double factors[] = {1, 10, 1e6};
    double ratio[3] = {0};
    long failures = 0;
    for (int k = 0; k < 3; k++) {
        detection detection;
        char text[SCENE_ERROR];
        for (size_t i = 0; i < r->sensors; i++)
            r->pulses.stated[i] *= factors[k];
        (void)detection_of(&detection, &r->blocks);
        for (size_t i = 0; i < r->sensors; i++)
            r->pulses.stated[i] /= factors[k];
        detection_text(&detection, &r->run.analysis.design, text);
        if (k == 0)
            printf("  %s\n", text);
        ratio[k] = detection.ratio * factors[k];
        failures += detection.detectable != (k < 2 ? (int)r->inputs : 0);
        failures += fabs(ratio[k] - ratio[0]) > 1e-9 * ratio[0];
        detection_close(&detection);
    }
    return failures;
}

/*
 * Measure one row.
 *   ticks  in  number of ticks without a fault for each mean time between jumps of the target
 *   stride in  only every `stride`-th of the runs with a fault is made
 * Returns the number of failures: healthy electrodes that are held, and kinds of faults of which
 * too few are held.
 */
static long measure(rig *r, const row *row, int ticks, size_t stride)
{
    static const int every[] = {40, 600, 2500};
    static const char *const word[] = {"none", "dead", "stuck", "reversed"};
    long failures = 0;
    printf("%s\n", row->name);
    r->noise = row->noise;
    r->missed = row->missed;
    failures += check_detection(r);
    for (int i = 0; i < 3; i++) {
        const tally tally = run_healthy(r, ticks, every[i], row->ceramic);
        printf("  jumps every %5d ticks: %ld healthy ticks, %ld suspected, %ld held, %ld alarms\n",
               every[i], tally.ticks, tally.tests, tally.held, tally.alarms);
        failures += tally.held + tally.alarms;
    }
    const tally loaded = run_loads(r, 2 * ticks, row->ceramic);
    printf(
        "  loads that jump during tests: %ld healthy ticks, %ld suspected, %ld held, %ld alarms\n",
        loaded.ticks, loaded.tests, loaded.held, loaded.alarms);
    failures += loaded.held + loaded.alarms;
    for (int fault = PZS_FAULT_DEAD; fault <= PZS_FAULT_REVERSED; fault++) {
        const named n = run_faults(r, row, (pzs_electrode_fault)fault, stride);
        printf("  %-8s: %d of %d held, %d others lack at most 5 %% of their range, %d named "
               "exactly, %d healthy ones held, mean %.0f, slowest %d ticks after the storm\n",
               word[fault], n.right, n.runs, n.slight, n.exact, n.wrong, n.sum / fmax(n.right, 1),
               n.slowest);
        failures += n.wrong + (100 * n.right < row->least * n.runs);
        fflush(stdout);
    }
    return failures;
}

int main(int count, char **argument)
{
    const bool is_full = count > 1;
    const int ticks = is_full ? atoi(argument[1]) : 3000;
    const int measured = is_full ? ROWS : QUICK_ROWS;
    const char *name = count > 2 ? argument[2] : "";
    static rig rig;
    long failures = 0;
    for (int k = 0; k < measured; k++) {
        if (*name && !strstr(rows[k].name, name))
            continue;
        if (open_rig(&rig, rows[k].compensated, rows[k].readings) < 0)
            return 1;
        failures += measure(&rig, &rows[k], ticks, is_full ? 1 : 15);
        close_rig(&rig);
    }
    printf("%s - %ld failures\n", failures ? "not ok" : "ok", failures);
    return failures > 0;
}
