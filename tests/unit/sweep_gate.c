/*
 * Sensor gate (lib/control/sensor_gate.c) in a loop that damps vibration, on plates with mass that
 * differ from their model and have hysteresis, while the target jumps.
 *
 *   gate [TICKS [SENSORS]]   number of ticks without a fault, default 20000, which also sets the
 *                            number of runs with faults; SENSORS: number of sensors, spread over
 * the plate, default 0: every node
 *
 * Prints how many healthy readings are gated, without loads and under point loads that the tables
 * do not know; for wrong sensors, how often exactly these are gated, and how much farther the shape
 * is from the target than with right readings, in targets. Returns 0 where no healthy reading is
 * gated without loads, and, with every node measured, none under loads, at least 95 of 100 single
 * faults are named, and none moves the shape by more than 0.075 targets.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/estimator.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/modal.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/inertia.h"
#include "../../host_tools/simulate/random.h"
#include "../../host_tools/tables/loop_blocks.h"
#include "../rigs/scene_run.h"

enum { INPUTS = 25, OUTPUTS = 121, SIDE = 11, LOADS = OUTPUTS - SIDE, PLAYS = 4, MODES = 40 };
enum { ALL = INPUTS + LOADS };

#define SCENE                                                                                      \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;"            \
    "simulate.amplifiers.step=0;simulate.events=[];control={rate: 1000, sensor_gate: true}"

/* How a sensor is wrong. */
typedef enum wrong {
    RIGHT,
    OFFSET,   /* its reading is too large by `size` (m) */
    DRIFTING, /* its reading drifts by `size` a tick (m) */
    FULL,     /* its reading is `size` (m) */
    REVERSED, /* its reading has the wrong sign, plus `size` (m) */
    SILENT    /* its reading is NaN */
} wrong;

/* A damped loop with a sensor gate around a plate, and the plate that loads act on. */
typedef struct rig {
    scene_run run, plant; /* the loop's scene without the point loads; with them */
    estimator estimator;
    damper damper;
    sensor_gate gate;
    loop_blocks blocks;
    vibration vibration;
    modal modal;
    inertia inertia;
    pzs_loop loop;
    void *work;
    size_t bytes, sensors, row[OUTPUTS]; /* row: output that each sensor measures */
    double gain, hysteresis, noise, unit;
    double play[INPUTS][PLAYS], sum[ALL], wanted[OUTPUTS], shape[OUTPUTS], reading[OUTPUTS];
    double size[OUTPUTS];
    wrong wrong[OUTPUTS];
    int since[OUTPUTS]; /* tick in which each fault began */
    uint64_t random, noises;
    int next_jump, every, tick;
} rig;

static int complain(const char *error)
{
    printf("not ok - %s\n", error);
    return -1;
}

/* The point loads of 1 N on every node that is free, as a list of a scene. */
static void list_loads(char *text, size_t room)
{
    size_t at = (size_t)snprintf(text, room, "%s;loads=[", SCENE);
    for (int i = SIDE; i < OUTPUTS; i++)
        at +=
            (size_t)snprintf(text + at, room - at, "%s{point: {theta1: %.4g, theta2: %.4g}, u3: 1}",
                             i > SIDE ? ", " : "", 0.02 * (i / SIDE), 0.02 * (i % SIDE));
    (void)snprintf(text + at, room - at, "]");
}

/* Sensors at `count` nodes spread over the plate, or none for every node. */
static void list_sensors(rig *r, int count, char *text, size_t room)
{
    size_t at = (size_t)snprintf(text, room, "%s", SCENE);
    r->sensors = 0;
    for (int i = 0; i < count; i++) {
        const int node = SIDE + (int)((i + 0.5) * LOADS / count);
        at += (size_t)snprintf(
            text + at, room - at, "%s{name: s%d, u3: middle, at: {theta1: %.4g, theta2: %.4g}}",
            i ? ", " : ";outputs=[", i, 0.02 * (node / SIDE), 0.02 * (node % SIDE));
        r->row[r->sensors++] = (size_t)node;
    }
    if (count > 0)
        at += (size_t)snprintf(text + at, room - at, "]");
    for (int i = 0; i < count; i++)
        at += (size_t)snprintf(text + at, room - at, "%s{output: s%d, noise: 1e-6}",
                               i ? ", " : ";estimate={tolerance: 0.999, readings: [", i);
    if (count > 0)
        (void)snprintf(text + at, room - at, "]}");
    for (size_t i = 0; i < OUTPUTS && count == 0; i++)
        r->row[r->sensors++] = i;
}

static int open_tables(rig *r)
{
    analysis *analysis = &r->run.analysis;
    certificate_make(&analysis->certificate, analysis);
    if (certify_loop(analysis, r->run.error) < 0 ||
        estimator_open(&r->estimator, analysis, r->run.error) < 0)
        return complain(r->run.error);
    const damper_options options = damper_options_of(analysis);
    const estimator *few = r->estimator.sensors > 0 ? &r->estimator : NULL;
    if (damper_make(&r->damper, analysis, few, &options, r->run.error) < 0)
        return complain(r->run.error);
    if (!loop_gate_open(&r->gate, analysis, &r->estimator, &r->damper))
        return complain("out of memory");
    loop_blocks_fill(&r->blocks, &analysis->design, &r->estimator, &r->damper);
    loop_blocks_gate(&r->blocks, &r->gate);
    return 0;
}

static int open_rig(rig *r, int sensors)
{
    static char change[20000];
    char text[SCENE_ERROR];
    double too_small;
    list_sensors(r, sensors, change, sizeof change);
    if (scene_run_open(&r->run, "plate-closed-loop", change) < 0 ||
        analysis_influence(&r->run.analysis, r->run.error) < 0 || open_tables(r) < 0)
        return complain(r->run.error);
    list_loads(change, sizeof change);
    analysis *plant = &r->plant.analysis;
    if (scene_run_open(&r->plant, "plate-closed-loop", change) < 0 ||
        analysis_influence(plant, r->plant.error) < 0 ||
        vibration_solve(&r->vibration, &plant->design, MODES, MASS_LUMPED, r->plant.error) < 0)
        return complain(r->plant.error);
    if (plant->design.targets != OUTPUTS || plant->design.structure.input.count != ALL)
        return complain("the plate is another one");
    if (!modal_open(&r->modal, &plant->design, &r->vibration, ALL) ||
        !inertia_open(&r->inertia, &r->modal))
        return complain("out of memory");
    (void)pzs_loop_init(&r->loop, r->blocks.block, (size_t)r->blocks.count, NULL, &too_small, 0);
    r->bytes = (size_t)r->loop.info.where;
    r->work = malloc(r->bytes);
    r->unit = design_target_rms(&r->run.analysis.design);
    sensor_gate_text(&r->gate, text);
    printf("%s\n", text);
    return r->work ? 0 : complain("out of memory");
}

static double uniform(uint64_t *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

/* Return loop and plate to rest at zero voltages, with right sensors. */
static void start(rig *r, uint64_t seed, double gain, double frequency, double hysteresis,
                  double noise, int every)
{
    (void)pzs_loop_init(&r->loop, r->blocks.block, (size_t)r->blocks.count, NULL, r->work,
                        r->bytes);
    memset(r->play, 0, sizeof r->play);
    memset(r->sum, 0, sizeof r->sum);
    memset(r->wrong, 0, sizeof r->wrong);
    inertia_rest(&r->inertia, r->sum);
    r->inertia.gain = gain;
    r->inertia.stretch = frequency;
    r->inertia.interval = 0;
    r->gain = gain;
    r->hysteresis = hysteresis;
    r->noise = noise;
    r->every = every;
    r->next_jump = r->tick = 0;
    r->random = seed;
    r->noises = seed + 1;
}

/* Set a new target: a part of the scene's, or the shape of random voltages up to their limits. */
static void jump(rig *r)
{
    const design *design = &r->run.analysis.design;
    const double factor = uniform(&r->random, -1, 1);
    double voltage[INPUTS];
    r->next_jump = r->tick + (int)uniform(&r->random, 0.5 * r->every, 1.5 * r->every);
    for (size_t j = 0; j < INPUTS; j++)
        voltage[j] = uniform(&r->random, design->lower[j], design->upper[j]);
    for (size_t i = 0; i < OUTPUTS; i++) {
        double random_shape = 0;
        for (size_t j = 0; j < INPUTS; j++)
            random_shape += r->plant.analysis.influence[i * ALL + j] * voltage[j];
        r->wanted[i] = factor > 0 ? factor * design->target[i] : random_shape;
    }
}

/* Voltage that acts on the ceramic of an electrode (V). */
static double act(rig *r, size_t j, double voltage)
{
    double mean = 0;
    for (int i = 0; i < PLAYS; i++) {
        const double slack = 300. * (i + 1) / (2 * PLAYS);
        double *play = &r->play[j][i];
        *play = fmin(fmax(*play, voltage - slack), voltage + slack);
        mean += *play / PLAYS;
    }
    return voltage + r->hysteresis * 16 / 5 * (mean - voltage);
}

static double read_sensor(rig *r, size_t sensor, double value)
{
    value += r->noise * random_noise(&r->noises);
    switch (r->wrong[sensor]) {
    case OFFSET: return value + r->size[sensor];
    case DRIFTING: return value + r->size[sensor] * (r->tick - r->since[sensor]);
    case FULL: return r->size[sensor];
    case REVERSED: return r->size[sensor] - value;
    case SILENT: return (double)NAN;
    default: return value;
    }
}

/* Run one tick: plate, readings, loop. */
static pzs_status run_tick(rig *r)
{
    if (r->tick >= r->next_jump)
        jump(r);
    for (size_t i = 0; i < OUTPUTS; i++) {
        inertia_observe(&r->inertia, i, 1, &r->shape[i]);
        for (size_t j = 0; j < ALL; j++)
            r->shape[i] += r->gain * r->plant.analysis.influence[i * ALL + j] * r->sum[j];
    }
    for (size_t i = 0; i < r->sensors; i++)
        r->reading[i] = read_sensor(r, i, r->shape[r->row[i]]);
    const pzs_status status = pzs_loop_tick(&r->loop, r->wanted, r->reading);
    for (size_t j = 0; j < INPUTS; j++)
        r->sum[j] = act(r, j, r->loop.info.voltage[j]);
    inertia_jump(&r->inertia, r->sum);
    inertia_advance(&r->inertia, 1 / r->run.analysis.design.control.rate);
    r->tick++;
    return status;
}

static const pzs_sensor_gate_info *info_of(const rig *r)
{
    const pzs_sensor_gate_state *gate = pzs_loop_find(&r->loop, &pzs_sensor_gate_block);
    return &gate->info;
}

/* Structures around the model: static gain and natural frequencies. */
static const double gains[] = {1, 0.8, 1.33}, frequencies[] = {1, 0.9, 1.1};

/* Numbers of ticks, of ticks with a gated reading, and of ticks that nothing explains. */
typedef struct tally {
    long ticks, gated, unexplained, alarms;
} tally;

static void count_tick(tally *tally, const rig *r, pzs_status status)
{
    tally->ticks++;
    tally->gated += info_of(r)->count > 0;
    tally->unexplained += info_of(r)->is_unexplained;
    tally->alarms += PZS_IS_ERROR(status);
}

/* Healthy sensors on nine structures. */
static long run_healthy(rig *r, const char *name, double hysteresis, double noise, int every,
                        int ticks)
{
    tally all = {0, 0, 0, 0};
    for (int plant = 0; plant < 9; plant++) {
        start(r, 77 + (uint64_t)plant, gains[plant % 3], frequencies[plant / 3], hysteresis, noise,
              every);
        for (int t = 0; t < ticks / 9; t++)
            count_tick(&all, r, run_tick(r));
    }
    printf("%-44s %8ld ticks, %ld with a gated reading, %ld unexplained, %ld after an alarm\n",
           name, all.ticks, all.gated, all.unexplained, all.alarms);
    return all.gated + all.alarms;
}

/* RMS of a column of the plant's influence matrix (m per unit). */
static double column_rms(const rig *r, size_t input)
{
    double sum = 0;
    for (size_t i = 0; i < OUTPUTS; i++)
        sum += pow(r->plant.analysis.influence[i * ALL + input], 2) / OUTPUTS;
    return sqrt(sum);
}

/*
 * Point loads that appear at once, one after the other, and stay for a while. Returns the number of
 * ticks with a gated reading, and of ticks after an alarm of the supervisor, which only loads that
 * move the shape by more than MOST_TARGETS may raise.
 */
#define MOST_TARGETS 5
static long run_loads(rig *r, double targets, int ticks)
{
    tally all = {0, 0, 0, 0};
    char name[80];
    int gated_loads = 0, gated_after = 0;
    for (size_t load = INPUTS; load < ALL; load++) {
        const long before = all.gated;
        start(r, 5 + load, 1, 1, 0.1, 1e-6, 1000000);
        for (int t = 0; t < 200; t++)
            (void)run_tick(r);
        r->sum[load] = targets * r->unit / column_rms(r, load);
        for (int t = 0; t < ticks; t++)
            count_tick(&all, r, run_tick(r));
        gated_loads += all.gated > before;
        r->sum[load] = 0;
        for (int t = 0; t < 400; t++)
            (void)run_tick(r);
        gated_after += info_of(r)->count > 0;
    }
    (void)snprintf(name, sizeof name, "unknown point loads of %g targets", targets);
    printf("%-44s %8ld ticks, %ld with a gated reading, %ld unexplained, %ld after an alarm; "
           "%d of %d loads gated something, %d still 400 ticks after their end\n",
           name, all.ticks, all.gated, all.unexplained, all.alarms, gated_loads, LOADS,
           gated_after);
    return all.gated + (targets > MOST_TARGETS ? 0 : all.alarms);
}

/* Distance of the shape from the target (targets). */
static double missed(const rig *r)
{
    double sum = 0;
    for (size_t i = 0; i < OUTPUTS; i++)
        sum += pow(r->shape[i] - r->wanted[i], 2) / OUTPUTS;
    return sqrt(sum) / r->unit;
}

/* A fault that is tried on many sensors. */
typedef struct fault {
    const char *name;
    wrong wrong;
    double size;
    int sensors; /* number of wrong sensors at once; 0: all */
    bool counts; /* whether the result is a demand */
} fault;

/* Begin a fault at random sensors. */
static void fail(rig *r, const fault *fault, uint64_t *random)
{
    const int count = fault->sensors > 0 ? fault->sensors : (int)r->sensors;
    for (int k = 0; k < count; k++) {
        size_t i = fault->sensors > 0 ? (size_t)random_int(random, (int)r->sensors) : (size_t)k;
        while (r->wrong[i] != RIGHT)
            i = (i + 1) % r->sensors;
        r->wrong[i] = fault->wrong;
        r->since[i] = r->tick;
        r->size[i] = fault->size * (random_int(random, 2) ? 1 : -1) *
                     (count > 1 ? uniform(random, 0.3, 1) : 1);
    }
}

/* Whether exactly the wrong sensors are gated or missing. */
static bool is_named(const rig *r)
{
    for (size_t i = 0; i < r->sensors; i++)
        if ((r->wrong[i] != RIGHT) != (info_of(r)->reading[i] != PZS_READING_USED))
            return false;
    return true;
}

/*
 * Run the same jumps twice, with right sensors and with wrong ones. Returns whether the faults hold
 * what is demanded.
 */
static bool run_faults(rig *r, const fault *fault, int runs)
{
    enum { BEFORE = 300, AFTER = 400 };
    double error[BEFORE + AFTER], farther = 0, square = 0;
    int named = 0, any = 0, alarms = 0;
    uint64_t random = 99;
    for (int run = 0; run < runs; run++) {
        const uint64_t seed = 1000 + (uint64_t)run;
        const int plant = run % 9;
        for (int is_wrong = 0; is_wrong < 2; is_wrong++) {
            start(r, seed, gains[plant % 3], frequencies[plant / 3], 0.1, 1e-6, 150);
            for (int t = 0; t < BEFORE + AFTER; t++) {
                if (is_wrong && t == BEFORE)
                    fail(r, fault, &random);
                const pzs_status status = run_tick(r);
                alarms += t == BEFORE + AFTER - 1 && PZS_IS_ERROR(status);
                if (is_wrong) {
                    farther = fmax(farther, missed(r) - error[t]);
                    if (t >= BEFORE)
                        square += pow(missed(r) - error[t], 2) / AFTER / runs;
                } else
                    error[t] = missed(r);
            }
        }
        named += is_named(r);
        any += info_of(r)->count > 0;
    }
    printf("%-44s %4d runs: %4d named, %4d with a gated reading, %d alarms; shape farther from the "
           "target by at most %.3g targets (RMS %.2g)\n",
           fault->name, runs, named, any, alarms, farther, sqrt(square));
    return !fault->counts || (named >= 0.95 * runs && farther <= 0.075);
}

int main(int argc, char **argv)
{
    static rig r;
    const int ticks = argc > 1 ? atoi(argv[1]) : 20000, sensors = argc > 2 ? atoi(argv[2]) : 0;
    const int runs = ticks >= 200000 ? 300 : 40;
    if (open_rig(&r, sensors) < 0)
        return 1;
    long bad = 0;
    bad += run_healthy(&r, "healthy, target jumps every 400 ticks", 0.1, 1e-7, 400, ticks / 4);
    bad += run_healthy(&r, "healthy, every 40 ticks, hysteresis 30 %", 0.3, 1e-6, 40, ticks / 4);
    bad += run_healthy(&r, "healthy, every 12 ticks, noise 10 um", 0, 1e-5, 12, ticks / 4);
    bad += run_healthy(&r, "healthy, every 100 ticks, noise 100 um", 0.1, 1e-4, 100, ticks / 4);
    const double loads[] = {1, 5, 15};
    for (int i = 0; i < 3; i++) {
        const long gated = run_loads(&r, loads[i], 400);
        bad += sensors == 0 ? gated : 0;
    }
    const bool all = sensors == 0;
    const fault faults[] = {{"1 m off", OFFSET, 1, 1, true},
                            {"30 mm off", OFFSET, 0.03, 1, all},
                            {"5 mm off", OFFSET, 0.005, 1, all},
                            {"1 mm off", OFFSET, 0.001, 1, all},
                            {"0.3 mm off", OFFSET, 0.0003, 1, false},
                            {"drift of 1 mm in 100 ticks", DRIFTING, 1e-5, 1, false},
                            {"stuck at 50 mm", FULL, 0.05, 1, all},
                            {"sign reversed, 2 mm off", REVERSED, 0.002, 1, all},
                            {"silent", SILENT, 0, 1, false},
                            {"two wrong by up to 1 m", OFFSET, 1, 2, false},
                            {"two wrong by up to 20 mm", OFFSET, 0.02, 2, false},
                            {"four wrong by up to 20 mm", OFFSET, 0.02, 4, false},
                            {"six wrong by up to 20 mm", OFFSET, 0.02, 6, false},
                            {"all wrong by up to 20 mm", OFFSET, 0.02, 0, false},
                            {"all wrong by up to 1 m", OFFSET, 1, 0, false}};
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
        bad += !run_faults(&r, &faults[i], runs);
    printf("%s - the sensor gate takes wrong readings away, and no others: %ld failures\n",
           bad == 0 ? "ok" : "not ok", bad);
    return bad != 0;
}
