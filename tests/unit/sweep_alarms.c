/*
 * Alarms of the supervisor of a loop that damps vibration (lib/control/monitor.c), on structures
 * with mass that differ from their model and have hysteresis.
 *
 *   alarms [RUNS [NAME [ends]]]   number of runs of each kind on each structure, default 2 on two
 *                                 structures; NAME: only structures whose name contains this word;
 *                                 ends: print also how each run with reversed amplifiers has ended
 *
 * The structures respond 0.8 to 1.33 times as strongly as their models, with frequencies of 0.9 to
 * 1.1 of theirs and hysteresis of 0 to 30 %. Prints for amplifiers whose polarity is wrong from the
 * start, or from a tick in service on, how many ticks pass until the alarm; and for healthy loops
 * the alarms under targets, loads (in units of the smaller of the target and the shape under half
 * the voltage range), impulses and missed ticks; and in how many of the healthy runs without large
 * loads and stuck electrodes the structure would seem to stand still, if the supervisor's slack
 * were smaller or larger than it is. The structures whose names begin with "slack" were made after
 * the slack was chosen. Returns 0 where healthy loops that observe vibration modes raise no alarm
 * without large loads, no polarity test takes control away from any healthy loop, and, with at most
 * 8 runs on five of the structures, alarms are neither missing nor much later, nor healthy loops
 * parked more often, than the rows of the table state.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/simulate/random.h"
#include "../rigs/damped_plant.h"
#include "../rigs/storm_structures.h"

enum { MODES = 40, HISTORY = 16, RUNS_MOST = 1000 };

static const storm_structure structures[] = {
    STORM_STRUCTURES(true, false),
    {"few sensors", "plate-few-sensors", LINEAR "control={rate: 1000}", false},
    {"springs, free functions", RIGS "storm-springs.yaml", "control={rate: 800}", false},
    {"twisted strip", RIGS "storm-twisted.yaml", "", false},
    {"soft beam", RIGS "slow-beam.yaml", "simulate.events=[]", false},
    {"blade", RIGS "twisted-blade.yaml", "simulate.events=[]", false},
    {"tube", RIGS "tube-mass.yaml", "simulate.events=[]", false},
    {"dish, free piston", RIGS "free-dish.yaml", "simulate.events=[]", false},
    {"three sensors", RIGS "three-sensors.yaml", "simulate.events=[]", false},
    {"slack: propped strip", RIGS "slack-bridge.yaml", "", false},
    {"slack: plate clamped on two edges", RIGS "slack-frame.yaml", "", false},
    {"slack: arch", RIGS "slack-arch.yaml", "", false},
    {"slack: cantilever of two actuators", RIGS "slack-pair.yaml", "", false},
};
enum { STRUCTURES = sizeof structures / sizeof *structures };

/* Slacks that are tried: 0.05, 0.1, ... of the RMS of the shape under half the voltage range. */
enum { SLACKS = 30 };
static const double slack_step = 0.05;

/*
 * Count of the supervisor for structures that do not follow the voltages (lib/control/polarity.c),
 * as it would be with another slack.
 */
typedef struct idle_count {
    uint32_t over; /* present value */
    int alarms;    /* number of runs in which the value has exceeded polarity_ticks */
    bool is_alarm; /* whether the present run is one of them */
} idle_count;

/* A loop with a supervisor around a structure. */
typedef struct rig {
    damped_plant plant;
    double unit, period;
    double reach; /* RMS of the shape under half the voltage range of every amplifier */
    double noise, missed;
    double *memory, *static_reading, *readings, *load, *wire;
    int stuck; /* electrode whose voltage stays; -1: none */
    int delay;
    uint64_t noises;
    bool was_missed;
    idle_count idle[SLACKS]; /* for each slack of the supervisor that is tried */
} rig;

/* Target of the scene. */
static const double *goal_of(const rig *r)
{
    return r->plant.run.analysis.design.target;
}

/* RMS over the targets of the shape under half the voltage range of every amplifier. */
static double reachable(const rig *r)
{
    const design *design = &r->plant.run.analysis.design;
    double sum = 0;
    for (size_t j = 0; j < r->plant.inputs; j++)
        for (size_t i = 0; i < r->plant.outputs; i++)
            sum += pow(r->plant.run.analysis.influence[i * r->plant.all + j] *
                           (design->upper[j] - design->lower[j]) / 2,
                       2) /
                   (double)r->plant.outputs;
    return sqrt(sum);
}

static bool open_memory(rig *r)
{
    const damped_plant *plant = &r->plant;
    r->memory = calloc(plant->inputs + (HISTORY + 1) * plant->sensors + plant->modal.modes,
                       sizeof *r->memory);
    r->wire = r->memory;
    r->static_reading = r->wire + plant->inputs;
    r->readings = r->static_reading + HISTORY * plant->sensors;
    r->load = r->readings + plant->sensors;
    return r->memory;
}

static int open_rig(rig *r, const storm_structure *structure)
{
    memset(r, 0, sizeof *r);
    damped_plant *plant = &r->plant;
    const design *design = &plant->run.analysis.design;
    const damper *damper = &plant->parts.damper;
    pzs_supervision *supervision = &plant->parts.blocks.supervision;
    if (damped_plant_open_loop(plant, structure->scene, structure->changes) < 0 ||
        damped_plant_open_structure(plant, &plant->run.analysis, MODES) < 0)
        return -1;
    if (!open_memory(r))
        return damped_plant_complain(plant, "out of memory");
    r->delay = design->simulate.delay;
    supervision->waits = 0;
    (void)pzs_supervision_seal(supervision);
    const double target = design_target_rms(design), reach = reachable(r);
    r->reach = reach;
    r->unit = target > 0 ? fmin(target, reach) : reach;
    r->period = damper->modes > 0 ? damper->rate / damper->frequency[0] : 20;
    printf("%s: period %.1f ticks, %d modes observed, %zu inputs %zu sensors %zu outputs, target "
           "%.3g reach %.3g, alarm_ticks %u polarity %u load %.3g W, slack %.3g W\n",
           structure->name, r->period, (int)damper->modes, plant->inputs, plant->sensors,
           plant->outputs, target, reach, supervision->alarm_ticks, supervision->polarity_ticks,
           (double)supervision->load / r->unit, (double)supervision->slack / r->unit);
    return 0;
}

static void close_rig(rig *r)
{
    free(r->memory);
    damped_plant_close(&r->plant);
}

/*
 * Return loop and structure to rest, with the target of the scene. Gain, frequencies and hysteresis
 * of the structure are random, in the box of the certificate.
 */
static void start(rig *r, uint64_t seed)
{
    static const double gains[] = {1, 0.8, 1.33}, frequencies[] = {1, 0.9, 1.1},
                        widths[] = {0, 0.1, 0.3};
    damped_plant *plant = &r->plant;
    plant->random = seed;
    r->noises = seed + 1;
    r->stuck = -1;
    r->missed = 0;
    r->noise = 1e-4 * r->unit;
    const double gain = gains[random_int(&plant->random, 3)];
    const double frequency = frequencies[random_int(&plant->random, 3)];
    damped_plant_start(plant, gain, frequency, widths[random_int(&plant->random, 3)]);
    for (size_t j = 0; j < plant->inputs; j++)
        r->wire[j] = 1;
    memset(r->load, 0, plant->modal.modes * sizeof *r->load);
    memcpy(plant->wanted, goal_of(r), plant->outputs * sizeof *plant->wanted);
}

/* Change the load of the plant, given by the static coordinates of its modes. */
static void set_load(rig *r, const double *load)
{
    for (size_t k = 0; k < r->plant.modal.modes; k++) {
        r->plant.inertia.deviation[k] -= load[k] - r->load[k];
        r->load[k] = load[k];
    }
}

static void observe(rig *r, size_t row, double *reading)
{
    *reading = damped_plant_observe(&r->plant, row, r->plant.acting);
    for (size_t k = 0; k < r->plant.modal.modes; k++)
        *reading += r->plant.modal.shape[row * r->plant.modal.modes + k] * r->load[k];
}

static pzs_status run_tick(rig *r)
{
    pzs_status status = PZS_OK;
    double *now = r->static_reading + (size_t)(r->plant.tick % HISTORY) * r->plant.sensors;
    const int then = r->plant.tick > r->delay ? r->plant.tick - r->delay : 0;
    const double *seen = r->static_reading + (size_t)(then % HISTORY) * r->plant.sensors;
    for (size_t i = 0; i < r->plant.sensors; i++)
        observe(r, r->plant.sensor_row[i], &now[i]);
    for (size_t i = 0; i < r->plant.sensors; i++)
        r->readings[i] = seen[i] + r->noise * random_noise(&r->noises);
    r->was_missed =
        r->plant.tick > 0 && r->missed > 0 && damped_plant_uniform(&r->plant, 0, 1) < r->missed;
    if (r->was_missed)
        (void)pzs_loop_skip(&r->plant.loop, 1);
    else
        status = pzs_loop_tick(&r->plant.loop, r->plant.wanted, r->readings);
    for (size_t j = 0; j < r->plant.inputs; j++)
        if ((int)j != r->stuck)
            r->plant.acting[j] =
                damped_plant_act(&r->plant, j, r->wire[j] * r->plant.loop.info.voltage[j]);
    damped_plant_advance(&r->plant, r->plant.acting);
    return status;
}

/*
 * Update the counts of a structure that does not follow the voltages, for each slack that is tried.
 * The polarity monitor itself compares motions only with the slack of the tables.
 */
static void count_idle(rig *r)
{
    const pzs_supervisor *s = pzs_loop_find(&r->plant.loop, &pzs_supervisor_block);
    const pzs_polarity_state *p = &s->state.monitor.polarity;
    double square = 0;
    for (size_t i = 0; i < r->plant.outputs; i++)
        square += (double)p->direction[i] * (double)p->direction[i];
    const double unit = sqrt(square * (double)r->plant.outputs) * r->reach;
    const double predicted = (double)(p->now[0] - p->before[0]),
                 measured = (double)(p->now[1] - p->before[1]);
    const bool is_judged = p->remaining > 0 && p->first - p->remaining > 2 && unit > 0;
    for (int k = 0; k < SLACKS; k++) {
        idle_count *count = &r->idle[k];
        const bool is_idle = is_judged && predicted > 2 * (double)p->least &&
                             predicted > (k + 1) * slack_step * unit && measured < predicted / 10;
        const uint32_t lowered = count->over > 2 ? count->over - 2 : 0;
        count->over = is_idle ? count->over + 1 : lowered;
        if (count->over > r->plant.parts.blocks.supervision.polarity_ticks && !count->is_alarm) {
            count->is_alarm = true;
            count->alarms++;
        }
    }
}

/* ---- courses ------------------------------------------------------------ */

typedef enum target_kind { CONSTANT, JUMPING, MOVING, ZERO } target_kind;
typedef enum load_kind { NO_LOAD, STEPS, RAMPS, WAVES, IMPULSES, LOADS_TRIED } load_kind;

/* What happens in a run. */
typedef struct course {
    target_kind target;
    load_kind load;
    double size;  /* of the loads (units) */
    double every; /* mean time between changes (periods) */
    int reversed; /* 0: none; 1: one amplifier, 2: half of them, 3: all */
    int at;       /* tick of the reversal */
    double missed;
    bool sticks;       /* one electrode sticks half way */
    double hysteresis; /* 0: random */
    bool counts_idle;  /* whether ticks in which the structure seems not to follow are counted */
    double noise;      /* (units) */
    int ticks;
    int next_target, next_load;
    double *from, *to, rate;
    int since;
    double phase;
} course;

static void set_target(rig *r, const course *c)
{
    const design *design = &r->plant.run.analysis.design;
    const double factor = damped_plant_uniform(&r->plant, -1, 1);
    const bool is_shape = damped_plant_uniform(&r->plant, 0, 1) < 0.3;
    (void)c;
    for (size_t i = 0; i < r->plant.outputs; i++)
        r->plant.wanted[i] = is_shape ? 0 : factor * goal_of(r)[i];
    for (size_t j = 0; j < r->plant.inputs && is_shape; j++) {
        const double middle = (design->upper[j] + design->lower[j]) / 2;
        const double voltage =
            middle + damped_plant_uniform(&r->plant, -1, 1) * (design->upper[j] - middle);
        for (size_t i = 0; i < r->plant.outputs; i++)
            r->plant.wanted[i] += r->plant.run.analysis.influence[i * r->plant.all + j] * voltage;
    }
}

/* A point load, or a pressure-like load in the first modes, of `size` units. */
static void random_load(rig *r, double size, double *load)
{
    double square = 0;
    const size_t modes = r->plant.modal.modes,
                 row = (size_t)random_int(&r->plant.random, (int)r->plant.outputs);
    const int kind = random_int(&r->plant.random, 3);
    for (size_t k = 0; k < modes; k++)
        load[k] =
            kind > 0 ? r->plant.modal.shape[row * modes + k] / pow(r->plant.modal.frequency[k], 2)
                     : damped_plant_uniform(&r->plant, -1, 1) / pow(r->plant.modal.frequency[k], 2);
    for (size_t i = 0; i < r->plant.outputs; i++) {
        double value = 0;
        for (size_t k = 0; k < modes; k++)
            value += r->plant.modal.shape[i * modes + k] * load[k];
        square += value * value / (double)r->plant.outputs;
    }
    const double factor = square > 0 ? size * r->unit / sqrt(square) : 0;
    for (size_t k = 0; k < modes; k++)
        load[k] *= factor * (kind == 2 ? -1 : 1);
}

static int ticks_until(rig *r, double low, double high)
{
    return 1 + (int)(damped_plant_uniform(&r->plant, low, high) * fmax(r->period, 10));
}

static void move_load(rig *r, course *c)
{
    static double load[MODES];
    const size_t modes = r->plant.modal.modes;
    if (c->load == NO_LOAD)
        return;
    if (r->plant.tick >= c->next_load) {
        memcpy(c->from, r->load, modes * sizeof *c->from);
        random_load(r, damped_plant_uniform(&r->plant, 0.1, 1) * c->size, c->to);
        if (damped_plant_uniform(&r->plant, 0, 1) < 0.3 && c->load != WAVES)
            memset(c->to, 0, modes * sizeof *c->to);
        c->since = r->plant.tick;
        c->next_load = r->plant.tick + ticks_until(r, 0.5 * c->every, 1.5 * c->every);
        c->rate = c->load == WAVES
                      ? 6.2832 / r->period * pow(10, damped_plant_uniform(&r->plant, -1, 0.5))
                      : 1 / (fmax(r->period, 10) * damped_plant_uniform(&r->plant, 0.3, 4));
        if (c->load == IMPULSES)
            for (size_t k = 0; k < modes; k++)
                r->plant.inertia.velocity[k] += c->to[k];
        if (c->load == STEPS)
            set_load(r, c->to);
    }
    const double way = fmin(1, (r->plant.tick - c->since) * c->rate);
    const double wave = sin(c->rate * (r->plant.tick - c->since));
    for (size_t k = 0; k < modes; k++)
        load[k] = c->load == RAMPS ? c->from[k] + way * (c->to[k] - c->from[k]) : c->to[k] * wave;
    if (c->load == RAMPS || c->load == WAVES)
        set_load(r, load);
}

static void move_target(rig *r, course *c)
{
    if (c->target == JUMPING && r->plant.tick >= c->next_target) {
        set_target(r, c);
        c->next_target = r->plant.tick + ticks_until(r, 0.2 * c->every, 1.8 * c->every);
    }
    if (c->target == ZERO)
        memset(r->plant.wanted, 0, r->plant.outputs * sizeof *r->plant.wanted);
    if (c->target != MOVING)
        return;
    const double wave = sin(c->phase + r->plant.tick * 6.2832 / (c->every * fmax(r->period, 10)));
    for (size_t i = 0; i < r->plant.outputs; i++)
        r->plant.wanted[i] = wave * goal_of(r)[i];
}

static void reverse(rig *r, const course *c)
{
    if (c->reversed == 0 || r->plant.tick != c->at)
        return;
    for (size_t j = 0; j < r->plant.inputs; j++)
        r->wire[j] =
            c->reversed == 3 || (c->reversed == 2 && random_int(&r->plant.random, 2)) ? -1 : 1;
    if (c->reversed == 1)
        r->wire[random_int(&r->plant.random, (int)r->plant.inputs)] = -1;
}

/* ---- ends of runs without an alarm ---------------------------------------- */

/* How a run has ended: averages over the last period. */
typedef struct run_end {
    double error;      /* RMS of shape minus target, averaged over the period (units) */
    double swing;      /* RMS of the shape about its mean in the period (units) */
    double best;       /* RMS error of the best voltages within the limits (units) */
    double at_limits;  /* part of the voltages at a limit in the last tick */
    unsigned statuses; /* one bit for each status */
} run_end;

enum { OUTPUTS_MOST = 4000, INPUTS_MOST = 200 };
static double mean_shape[OUTPUTS_MOST], square_shape[OUTPUTS_MOST];

/* Error of the best voltages for the plant as it is, by coordinate descent within the limits. */
static double best_error(const rig *r)
{
    static double rest[OUTPUTS_MOST], v[INPUTS_MOST];
    const design *design = &r->plant.run.analysis.design;
    const double *b = r->plant.run.analysis.influence;
    double sum = 0;
    for (size_t i = 0; i < r->plant.outputs; i++) {
        rest[i] = -r->plant.wanted[i];
        for (size_t k = 0; k < r->plant.modal.modes; k++)
            rest[i] += r->plant.modal.shape[i * r->plant.modal.modes + k] * r->load[k];
    }
    memset(v, 0, sizeof v);
    for (int sweep = 0; sweep < 2000; sweep++)
        for (size_t j = 0; j < r->plant.inputs; j++) {
            double slope = 0, square = 0;
            for (size_t i = 0; i < r->plant.outputs; i++) {
                const double e = r->plant.inertia.gain * r->wire[j] * b[i * r->plant.all + j];
                slope += e * rest[i];
                square += e * e;
            }
            const double next =
                fmin(fmax(v[j] - slope / square, design->lower[j]), design->upper[j]);
            for (size_t i = 0; i < r->plant.outputs; i++)
                rest[i] +=
                    (next - v[j]) * r->plant.inertia.gain * r->wire[j] * b[i * r->plant.all + j];
            v[j] = next;
        }
    for (size_t i = 0; i < r->plant.outputs; i++)
        sum += rest[i] * rest[i] / (double)r->plant.outputs;
    return sqrt(sum) / r->unit;
}

static double limited_part(const rig *r)
{
    const design *design = &r->plant.run.analysis.design;
    double count = 0;
    for (size_t j = 0; j < r->plant.inputs; j++) {
        const double margin = 1e-3 * (design->upper[j] - design->lower[j]);
        const double v = r->plant.loop.info.voltage[j];
        count += v < design->lower[j] + margin || v > design->upper[j] - margin;
    }
    return count / (double)r->plant.inputs;
}

/* Add the shape of this tick to the sums of the last period. */
static void sum_end(rig *r, run_end *end, pzs_status status, int ticks)
{
    double sum = 0;
    for (size_t i = 0; i < r->plant.outputs; i++) {
        double y;
        observe(r, i, &y);
        mean_shape[i] += y / ticks;
        square_shape[i] += y * y / ticks;
        sum += pow(y - r->plant.wanted[i], 2) / (double)r->plant.outputs;
    }
    end->error += sqrt(sum) / ticks / r->unit;
    end->statuses |= 1u << ((unsigned)status & 31u);
}

static void finish_end(rig *r, run_end *end)
{
    double sum = 0;
    for (size_t i = 0; i < r->plant.outputs; i++)
        sum += fmax(square_shape[i] - mean_shape[i] * mean_shape[i], 0) / (double)r->plant.outputs;
    end->swing = sqrt(sum) / r->unit;
    end->best = best_error(r);
    end->at_limits = limited_part(r);
}

/* What the last run has shown besides its alarm. */
static struct {
    run_end end;     /* of a run without alarm */
    int tested;      /* number of ticks of polarity tests */
    bool is_by_test; /* whether a polarity test raised the alarm */
    pzs_status last;
} seen;

static void see(rig *r, pzs_status status, const course *c, int window)
{
    seen.tested += status == PZS_W_POLARITY;
    seen.is_by_test = status == PZS_W_RAMP && seen.last == PZS_W_POLARITY;
    seen.last = status;
    if (r->plant.tick > c->ticks - window)
        sum_end(r, &seen.end, status, window);
}

static void start_seeing(void)
{
    memset(&seen, 0, sizeof seen);
    memset(mean_shape, 0, sizeof mean_shape);
    memset(square_shape, 0, sizeof square_shape);
}

/* Run a course. Returns the tick of the alarm, or -1. */
static int run_course(rig *r, course c)
{
    static double from[MODES], to[MODES];
    const int which = random_int(&r->plant.random, (int)r->plant.inputs);
    c.from = from;
    c.to = to;
    c.phase = damped_plant_uniform(&r->plant, 0, 6);
    memset(from, 0, sizeof from);
    memset(to, 0, sizeof to);
    c.next_load = ticks_until(r, 0.5, 3);
    c.next_target = c.target == JUMPING && c.reversed == 0 ? 0 : ticks_until(r, 1, 4);
    r->missed = c.missed;
    if (c.hysteresis > 0)
        r->plant.hysteresis = c.hysteresis;
    for (int k = 0; k < SLACKS; k++) {
        r->idle[k].over = 0;
        r->idle[k].is_alarm = false;
    }
    if (c.noise > 0)
        r->noise = c.noise * r->unit;
    const int window = (int)fmax(r->period, 20);
    start_seeing();
    while (r->plant.tick < c.ticks) {
        reverse(r, &c);
        move_target(r, &c);
        move_load(r, &c);
        r->stuck = c.sticks && r->plant.tick > c.ticks / 2 ? which : -1;
        see(r, run_tick(r), &c, window);
        if (c.counts_idle)
            count_idle(r);
        if (damped_plant_is_stopped(&r->plant))
            return r->plant.tick;
    }
    finish_end(r, &seen.end);
    return -1;
}

/* ---- table ------------------------------------------------------------- */

/* What a row of the table demands, besides its bounds. */
typedef enum demand {
    SHOWN,   /* nothing: the alarms are counted */
    FOUND,   /* nothing, of reversed amplifiers: the ticks to the alarm are printed */
    NO_ALARM /* of healthy loops: no alarm, except as many as measured */
} demand;

/*
 * Names of the structures on which the alarms of the rows were measured, each in MEASURED_RUNS
 * runs. At most as many runs start from the same seeds and must not do worse: later alarms by more
 * than the factor `later`, missed ones, or more healthy loops that are parked, are failures.
 */
static const char *const measured[] = {"plate, 15 Hz, 1 kHz", "panel, 1 kHz",
                                       "soft plate, 0.5 Hz, 100 Hz", "soft beam", "blade"};
enum { MEASURED = sizeof measured / sizeof *measured, MEASURED_RUNS = 8 };
static const double later = 1.25;

/* Measured alarms of reversed amplifiers: number of runs that have one, and ticks to the alarm. */
typedef struct bound {
    int alarms, median, slowest;
} bound;

typedef struct row {
    const char *name;
    course course;
    demand demand;
    bound found[MEASURED]; /* of reversed amplifiers, for each structure of `measured` */
    int parked[MEASURED];  /* number of runs of healthy loops that are parked, the same */
} row;

static const row rows[] = {
    {"reversed from the start, constant",
     {.target = CONSTANT, .reversed = 3},
     FOUND,
     .found = {{8, 129, 133}, {8, 37, 84}, {8, 409, 410}, {8, 590, 3290}, {8, 140, 187}}},
    {"reversed from the start, zero target, load",
     {.target = ZERO, .load = STEPS, .size = 1, .every = 100, .reversed = 3},
     FOUND,
     .found = {{8, 580, 737}, {8, 210, 481}, {8, 1386, 1650}, {7, 2102, 2813}, {8, 519, 1075}}},
    {"reversed from the start, jumping",
     {.target = JUMPING, .every = 2, .reversed = 3},
     FOUND,
     .found = {{8, 129, 130}, {8, 37, 65}, {8, 411, 705}, {8, 586, 932}, {8, 121, 614}}},
    {"reversed from the start, moving",
     {.target = MOVING, .every = 10, .reversed = 3},
     FOUND,
     .found = {{8, 138, 436}, {8, 41, 357}, {8, 440, 1025}, {5, 596, 643}, {8, 213, 785}}},
    {"reversed in service, constant",
     {.target = CONSTANT, .reversed = 3, .at = 1},
     FOUND,
     .found = {{8, 138, 139}, {8, 51, 58}, {8, 414, 420}, {8, 663, 1920}, {8, 650, 670}}},
    {"reversed in service, jumping",
     {.target = JUMPING, .every = 2, .reversed = 3, .at = 1},
     FOUND,
     .found = {{8, 232, 417}, {8, 737, 1177}, {8, 611, 1009}, {8, 1298, 4883}, {8, 221, 691}}},
    {"reversed in service, moving",
     {.target = MOVING, .every = 10, .reversed = 3, .at = 1},
     FOUND,
     .found = {{8, 254, 1135}, {8, 86, 267}, {8, 637, 807}, {7, 1107, 1420}, {8, 188, 658}}},
    {"half reversed from the start, constant",
     {.target = CONSTANT, .reversed = 2},
     FOUND,
     .found = {{2, 165, 165}, {6, 92, 120}, {4, 1539, 1880}, {8, 3287, 4164}, {7, 614, 718}}},
    {"one reversed from the start, constant",
     {.target = CONSTANT, .reversed = 1},
     FOUND,
     .found = {{0, 0, 0}, {1, 104, 104}, {0, 0, 0}, {8, 4021, 5459}, {4, 102, 598}}},
    {"healthy, constant", {.target = CONSTANT}, .demand = NO_ALARM},
    {"healthy, jumping", {.target = JUMPING, .every = 2}, .demand = NO_ALARM},
    {"healthy, jumping, stuck electrode",
     {.target = JUMPING, .every = 3, .sticks = true},
     NO_ALARM,
     .parked = {0, 0, 0, 1, 0}},
    {"healthy, jumping, missed ticks",
     {.target = JUMPING, .every = 3, .missed = 0.1},
     .demand = NO_ALARM},
    {"healthy, jumping, noise 0.005",
     {.target = JUMPING, .every = 3, .noise = 0.005},
     .demand = NO_ALARM},
    {"healthy, storm", {.target = JUMPING, .every = 0.6}, .demand = NO_ALARM},
    {"healthy, moving", {.target = MOVING, .every = 6}, .demand = NO_ALARM},
    {"healthy, steps of load 0.3",
     {.target = JUMPING, .load = STEPS, .size = 0.3, .every = 3},
     .demand = NO_ALARM},
    {"healthy, steps of load 2",
     {.target = CONSTANT, .load = STEPS, .size = 2, .every = 4},
     SHOWN,
     .parked = {0, 1, 0, 4, 0}},
    {"healthy, steps of load 5",
     {.target = CONSTANT, .load = STEPS, .size = 5, .every = 6},
     SHOWN,
     .parked = {1, 1, 1, 2, 0}},
    {"healthy, steps of load 15",
     {.target = CONSTANT, .load = STEPS, .size = 15, .every = 6},
     SHOWN,
     .parked = {4, 5, 5, 1, 0}},
    {"healthy, jumping, steps of load 15",
     {.target = JUMPING, .load = STEPS, .size = 15, .every = 3},
     SHOWN,
     .parked = {4, 2, 5, 3, 0}},
    {"healthy, steps of load 40",
     {.target = CONSTANT, .load = STEPS, .size = 40, .every = 6},
     SHOWN,
     .parked = {8, 4, 8, 5, 0}},
    {"healthy, slow steps of load 40",
     {.target = CONSTANT, .load = STEPS, .size = 40, .every = 12},
     SHOWN,
     .parked = {6, 4, 6, 4, 0}},
    {"healthy, ramps of load 40",
     {.target = CONSTANT, .load = RAMPS, .size = 40, .every = 8},
     SHOWN,
     .parked = {7, 2, 4, 7, 0}},
    {"healthy, waves of load 15",
     {.target = CONSTANT, .load = WAVES, .size = 15, .every = 20},
     SHOWN,
     .parked = {8, 8, 8, 8, 1}},
    {"healthy, ramps of load 3",
     {.target = CONSTANT, .load = RAMPS, .size = 3, .every = 3},
     SHOWN,
     .parked = {1, 0, 0, 1, 0}},
    {"healthy, ramps of load 15",
     {.target = CONSTANT, .load = RAMPS, .size = 15, .every = 4},
     SHOWN,
     .parked = {6, 4, 3, 8, 0}},
    {"healthy, waves of load 1",
     {.target = CONSTANT, .load = WAVES, .size = 1, .every = 8},
     SHOWN,
     .parked = {6, 7, 6, 7, 0}},
    {"healthy, waves of load 5",
     {.target = CONSTANT, .load = WAVES, .size = 5, .every = 8},
     SHOWN,
     .parked = {8, 8, 8, 8, 0}},
    {"healthy, impulses 1",
     {.target = CONSTANT, .load = IMPULSES, .size = 1, .every = 4},
     SHOWN,
     .parked = {0, 0, 0, 3, 0}},
    {"healthy, impulses 5",
     {.target = JUMPING, .load = IMPULSES, .size = 5, .every = 4},
     SHOWN,
     .parked = {0, 0, 0, 1, 0}},
    {"healthy, jumping, 30 % hysteresis",
     {.target = JUMPING, .every = 6, .hysteresis = 0.3},
     .demand = NO_ALARM},
};
enum { ROWS = sizeof rows / sizeof *rows };

static int compare_ints(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* Numbers of alarms, by cause, of the runs of one row. */
typedef struct tally {
    int alarms, opposed, vibrating;
    int tested;           /* number of runs with a polarity test */
    int by_test;          /* number of alarms that it raised */
    int ticks[RUNS_MOST]; /* [alarms] ticks from the reversal to the alarm */
} tally;

static bool is_detailed; /* whether each run with reversed amplifiers is printed */

/* Print how a run with reversed amplifiers has ended. */
static void print_end(const rig *r, int ticks)
{
    size_t reversed = 0;
    for (size_t j = 0; j < r->plant.inputs; j++)
        reversed += r->wire[j] < 0;
    printf("    %zu/%zu reversed, gain %.2f frequency %.1f hysteresis %.1f: ", reversed,
           r->plant.inputs, r->plant.inertia.gain, r->plant.inertia.stretch, r->plant.hysteresis);
    if (ticks >= 0)
        printf("alarm after %d ticks\n", ticks);
    else
        printf(
            "no alarm; error %.3g, best %.3g, swing %.3g targets, %.2f of the voltages at limits, "
            "statuses %x\n",
            seen.end.error, seen.end.best, seen.end.swing, seen.end.at_limits, seen.end.statuses);
}

/* Run one row of the table once on a random structure. */
static void run_once(rig *r, const row *row, uint64_t seed, tally *tally)
{
    const double period = fmax(r->period, 20);
    course c = row->course;
    c.counts_idle = row->demand == NO_ALARM && !c.sticks;
    start(r, seed);
    if (c.at > 0)
        c.at = (int)(damped_plant_uniform(&r->plant, 5, 12) * period);
    c.ticks =
        row->demand == FOUND ? c.at + (int)fmax(20 * period, 1200) : (int)fmax(40 * period, 1000);
    const int tick = run_course(r, c);
    if (is_detailed && row->demand == FOUND)
        print_end(r, tick < 0 ? -1 : tick - c.at);
    tally->tested += seen.tested > 0;
    tally->by_test += tick >= 0 && seen.is_by_test;
    if (tick < 0)
        return;
    const pzs_supervisor *supervisor = pzs_loop_find(&r->plant.loop, &pzs_supervisor_block);
    const bool is_alarm = supervisor->info.cause == PZS_EVENT_ALARM;
    tally->ticks[tally->alarms++] = tick - c.at;
    tally->opposed += is_alarm && supervisor->info.is_opposed;
    tally->vibrating += is_alarm && !supervisor->info.is_opposed;
}

/* Number of the structure in the list `measured`, or -1. */
static int number_of(const char *name)
{
    int k = MEASURED - 1;
    while (k >= 0 && strcmp(name, measured[k]) != 0)
        k--;
    return k;
}

/* Whether more runs of healthy loops are parked than were measured before. */
static bool are_more_parked(const row *row, int parked, const tally *tally)
{
    if (tally->alarms <= parked)
        return false;
    printf("  not ok - %s: %d alarms, at most %d expected\n", row->name, tally->alarms, parked);
    return true;
}

/*
 * Whether alarms of reversed amplifiers are missing, or come later than measured before. More
 * alarms than before may be later ones.
 */
static bool are_fewer_found(const row *row, const bound *bound, const tally *tally, int runs)
{
    const int missed = runs - tally->alarms, most = MEASURED_RUNS - bound->alarms;
    const int slowest = tally->alarms > 0 ? tally->ticks[tally->alarms - 1] : 0;
    const int median = tally->alarms > 0 ? tally->ticks[tally->alarms / 2] : 0;
    const bool is_complete = runs == MEASURED_RUNS, is_more = is_complete && missed < most;
    const bool is_late =
        slowest > later * bound->slowest || (is_complete && median > later * bound->median);
    if (missed <= most && (!is_late || is_more))
        return false;
    printf("  not ok - %s: %d alarms missing, median %d, slowest %d ticks; measured before: %d, "
           "%d, %d\n",
           row->name, missed, median, slowest, most, bound->median, bound->slowest);
    return true;
}

static void print_row(const row *row, const tally *tally, int runs)
{
    printf("  %-44s %d of %d alarms, %d opposed, %d by test, %d vibrating, %d tested; median %d, "
           "slowest %d ticks\n",
           row->name, tally->alarms, runs, tally->opposed, tally->by_test, tally->vibrating,
           tally->tested, tally->alarms ? tally->ticks[tally->alarms / 2] : 0,
           tally->alarms ? tally->ticks[tally->alarms - 1] : 0);
}

/*
 * Run and print one row of the table.
 *   number in  number of the structure in the list `measured`, or -1
 * Returns the number of failures.
 */
static int run_row(rig *r, const row *row, uint64_t seed, int runs, int number)
{
    static tally tally;
    memset(&tally, 0, sizeof tally);
    for (int run = 0; run < runs; run++)
        run_once(r, row, seed + (uint64_t)run, &tally);
    qsort(tally.ticks, (size_t)tally.alarms, sizeof *tally.ticks, compare_ints);
    if (row->demand == FOUND || tally.alarms + tally.tested > 0)
        print_row(row, &tally, runs);
    fflush(stdout);
    const int by_test = row->demand == FOUND ? 0 : tally.by_test;
    if (number >= 0 && runs <= MEASURED_RUNS) {
        const bool is_worse = row->demand == FOUND
                                  ? are_fewer_found(row, &row->found[number], &tally, runs)
                                  : are_more_parked(row, row->parked[number], &tally);
        return by_test + (is_worse ? 1 : 0);
    }
    // One of two electrodes that sticks is half of the structure, not a healthy loop.
    const bool is_healthy = row->demand == NO_ALARM && !(row->course.sticks && r->plant.inputs < 3);
    return is_healthy ? tally.alarms : by_test;
}

/*
 * Print how often a structure would seem not to follow the voltages, with smaller and larger slacks
 * than that of the tables, in parts of the shape under half the voltage range.
 */
static void print_idle(const rig *r)
{
    printf("  healthy runs that seem idle, by slack:");
    for (int k = 0; k < SLACKS; k++)
        if (r->idle[k].alarms > 0)
            printf(" %.2f: %d", (k + 1) * slack_step, r->idle[k].alarms);
    printf("\n");
}

/*
 * Run all rows of the table on one structure. Returns the number of failures; a loop that observes
 * no mode is only shown.
 */
static int run_structure(const storm_structure *structure, int runs)
{
    static rig r;
    const int number = number_of(structure->name);
    int bad = 0;
    if (open_rig(&r, structure) < 0)
        return 1;
    for (int k = 0; k < ROWS; k++)
        bad += run_row(&r, &rows[k], 1000 * (uint64_t)k, runs, number);
    print_idle(&r);
    const bool has_modes = r.plant.parts.damper.modes > 0;
    close_rig(&r);
    return has_modes ? bad : 0;
}

int main(int argc, char **argv)
{
    const bool is_full = argc > 1;
    const int runs = is_full ? atoi(argv[1]) : 2;
    const char *name = argc > 2 ? argv[2] : "";
    is_detailed = argc > 3;
    int bad = 0;
    for (int k = 0; k < STRUCTURES && runs <= RUNS_MOST; k++)
        if ((is_full || structures[k].is_quick) && strstr(structures[k].name, name))
            bad += run_structure(&structures[k], runs);
    printf("%s - %d rows or runs in which the supervisor fails\n", bad ? "not ok" : "ok", bad);
    return bad > 0;
}
