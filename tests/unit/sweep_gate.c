/*
 * Sensor gate (lib/control/sensor_gate.c) in a loop that damps vibration, on plates with mass that
 * differ from their model and have hysteresis, while the target jumps.
 *
 *   gate [TICKS [SENSORS]]   number of ticks without a fault, default 20000, which also sets the
 *                            number of runs with faults
 *                            SENSORS: number of sensors, spread over the plate, default 0: every
 *                            node
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
#include "../../host_tools/simulate/random.h"
#include "../rigs/damped_plant.h"

enum { INPUTS = 25, OUTPUTS = 121, SIDE = 11, LOADS = OUTPUTS - SIDE, MODES = 40 };
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

/* A damped loop with a sensor gate around a plate that point loads act on. */
typedef struct rig {
    damped_plant plant;
    scene_run loaded; /* the loop's scene with the point loads */
    double noise, unit;
    double shape[OUTPUTS], reading[OUTPUTS], size[OUTPUTS];
    wrong wrong[OUTPUTS];
    int since[OUTPUTS]; /* tick in which each fault began */
    uint64_t noises;
    int next_jump, every;
} rig;

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

/* Node of sensor i of `count` sensors spread over the plate; of every node where count is 0. */
static int node_of(int i, int count)
{
    return count > 0 ? SIDE + (int)((i + 0.5) * LOADS / count) : i;
}

/* Sensors at `count` nodes spread over the plate, as changes of the scene; 0: every node. */
static void list_sensors(int count, char *text, size_t room)
{
    size_t at = (size_t)snprintf(text, room, "%s", SCENE);
    for (int i = 0; i < count; i++) {
        const int node = node_of(i, count);
        at += (size_t)snprintf(
            text + at, room - at, "%s{name: s%d, u3: middle, at: {theta1: %.4g, theta2: %.4g}}",
            i ? ", " : ";outputs=[", i, 0.02 * (node / SIDE), 0.02 * (node % SIDE));
    }
    if (count > 0)
        at += (size_t)snprintf(text + at, room - at, "]");
    for (int i = 0; i < count; i++)
        at += (size_t)snprintf(text + at, room - at, "%s{output: s%d, noise: 1e-6}",
                               i ? ", " : ";estimate={tolerance: 0.999, readings: [", i);
    if (count > 0)
        (void)snprintf(text + at, room - at, "]}");
}

static int open_rig(rig *r, int sensors)
{
    static char change[20000];
    char text[SCENE_ERROR];
    damped_plant *plant = &r->plant;
    list_sensors(sensors, change, sizeof change);
    if (damped_plant_open_loop(plant, "plate-closed-loop", change) < 0)
        return -1;
    list_loads(change, sizeof change);
    if (scene_run_open(&r->loaded, "plate-closed-loop", change) < 0 ||
        analysis_influence(&r->loaded.analysis, r->loaded.error) < 0)
        return damped_plant_complain(plant, r->loaded.error);
    if (damped_plant_open_structure(plant, &r->loaded.analysis, MODES) < 0)
        return -1;
    if (plant->outputs != OUTPUTS || plant->inputs != INPUTS || plant->all != ALL)
        return damped_plant_complain(plant, "the plate is another one");
    for (size_t i = 0; i < plant->sensors; i++)
        plant->sensor_row[i] = (size_t)node_of((int)i, sensors);
    r->unit = design_target_rms(&plant->run.analysis.design);
    sensor_gate_text(&plant->parts.gate, text);
    printf("%s\n", text);
    return 0;
}

/* Return loop and plate to rest at zero voltages, with right sensors. */
static void start(rig *r, uint64_t seed, double gain, double frequency, double hysteresis,
                  double noise, int every)
{
    damped_plant_start(&r->plant, gain, frequency, hysteresis);
    memset(r->wrong, 0, sizeof r->wrong);
    r->noise = noise;
    r->every = every;
    r->next_jump = 0;
    r->plant.random = seed;
    r->noises = seed + 1;
}

/* Set a new target: a part of the scene's, or the shape of random voltages up to their limits. */
static void jump(rig *r)
{
    damped_plant *plant = &r->plant;
    const double factor = damped_plant_uniform(plant, -1, 1);
    r->next_jump = plant->tick + (int)damped_plant_uniform(plant, 0.5 * r->every, 1.5 * r->every);
    damped_plant_aim(plant, factor, 1);
}

static double read_sensor(rig *r, size_t sensor, double value)
{
    value += r->noise * random_noise(&r->noises);
    switch (r->wrong[sensor]) {
    case OFFSET: return value + r->size[sensor];
    case DRIFTING: return value + r->size[sensor] * (r->plant.tick - r->since[sensor]);
    case FULL: return r->size[sensor];
    case REVERSED: return r->size[sensor] - value;
    case SILENT: return (double)NAN;
    default: return value;
    }
}

/* Run one tick: readings, loop, plate. */
static pzs_status run_tick(rig *r)
{
    damped_plant *plant = &r->plant;
    if (plant->tick >= r->next_jump)
        jump(r);
    for (size_t i = 0; i < OUTPUTS; i++)
        r->shape[i] = damped_plant_observe(plant, i, plant->acting);
    for (size_t i = 0; i < plant->sensors; i++)
        r->reading[i] = read_sensor(r, i, r->shape[plant->sensor_row[i]]);
    const pzs_status status = pzs_loop_tick(&plant->loop, plant->wanted, r->reading);
    for (size_t j = 0; j < INPUTS; j++)
        plant->acting[j] = damped_plant_act(plant, j, plant->loop.info.voltage[j]);
    damped_plant_advance(plant, plant->acting);
    return status;
}

static const pzs_sensor_gate_info *info_of(const rig *r)
{
    const pzs_sensor_gate_state *gate = pzs_loop_find(&r->plant.loop, &pzs_sensor_gate_block);
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
        sum += pow(r->loaded.analysis.influence[i * ALL + input], 2) / OUTPUTS;
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
        r->plant.acting[load] = targets * r->unit / column_rms(r, load);
        for (int t = 0; t < ticks; t++)
            count_tick(&all, r, run_tick(r));
        gated_loads += all.gated > before;
        r->plant.acting[load] = 0;
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
        sum += pow(r->shape[i] - r->plant.wanted[i], 2) / OUTPUTS;
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
    const int count = fault->sensors > 0 ? fault->sensors : (int)r->plant.sensors;
    for (int k = 0; k < count; k++) {
        size_t i =
            fault->sensors > 0 ? (size_t)random_int(random, (int)r->plant.sensors) : (size_t)k;
        while (r->wrong[i] != RIGHT)
            i = (i + 1) % r->plant.sensors;
        r->wrong[i] = fault->wrong;
        r->since[i] = r->plant.tick;
        r->size[i] = fault->size * (random_int(random, 2) ? 1 : -1) *
                     (count > 1 ? (0.3 + 0.7 * random_uniform(random)) : 1);
    }
}

/* Whether exactly the wrong sensors are gated or missing. */
static bool is_named(const rig *r)
{
    for (size_t i = 0; i < r->plant.sensors; i++)
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
