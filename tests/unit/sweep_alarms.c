/*
 * Alarms of the supervisor of a loop that damps vibration (lib/control/monitor.c), on structures
 * with mass that differ from their model and have hysteresis.
 *
 *   alarms [RUNS [NAME]]   number of runs of each kind on each structure, default 2 on two
 *                          structures; NAME: only structures whose name contains this word
 *
 * The structures respond 0.8 to 1.33 times as strongly as their models, with frequencies of 0.9 to
 * 1.1 of theirs and hysteresis of 0 to 30 %. Prints for amplifiers whose polarity is wrong from the
 * start, or from a tick in service on, how many ticks pass until the alarm; and for healthy loops
 * the alarms under targets, loads (in units of the smaller of the target and the shape under half
 * the voltage range), impulses and missed ticks; and in how many of the healthy runs without large
 * loads and stuck electrodes the structure would seem to stand still, if the supervisor's slack
 * were smaller or larger than it is. The structures whose names begin with "slack" were made after
 * the slack was chosen. Returns 0 where healthy loops that observe vibration modes raise no alarm
 * without large loads.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/estimator.h"
#include "../../host_tools/model/modal.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/inertia.h"
#include "../../host_tools/simulate/random.h"
#include "../../host_tools/tables/loop_blocks.h"
#include "../rigs/scene_run.h"
#include "../rigs/storm_structures.h"

enum { PLAYS = 4, MODES = 40, HISTORY = 16, RUNS_MOST = 1000 };

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

typedef struct rig {
    const storm_structure *structure;
    scene_run run;
    estimator estimator;
    damper damper;
    loop_blocks blocks;
    vibration vibration;
    modal modal;
    inertia inertia;
    pzs_loop loop;
    void *work;
    size_t bytes, inputs, outputs, sensors, all;
    size_t *row;
    double unit, period;
    double reach; /* RMS of the shape under half the voltage range of every amplifier */
    double gain, hysteresis, noise, missed;
    double *memory, *acting, *play, *static_reading, *readings, *wanted, *goal, *load, *wire;
    int stuck; /* electrode whose voltage stays; -1: none */
    int delay;
    uint64_t random, noises;
    int tick;
    bool was_missed;
    idle_count idle[SLACKS]; /* for each slack of the supervisor that is tried */
} rig;

static int complain(const char *name, const char *error)
{
    printf("not ok - %s: %s\n", name, error);
    return -1;
}

static double uniform(uint64_t *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}

static int open_tables(rig *r)
{
    analysis *analysis = &r->run.analysis;
    const bool is_few = analysis->design.estimate.readings > 0;
    certificate_make(&analysis->certificate, analysis);
    if (certify_loop(analysis, r->run.error) < 0)
        return -1;
    const damper_options options = damper_options_of(analysis);
    if (is_few && estimator_open(&r->estimator, analysis, r->run.error) < 0)
        return -1;
    const estimator *few = is_few ? &r->estimator : NULL;
    if (damper_make(&r->damper, analysis, few, &options, r->run.error) < 0)
        return -1;
    loop_blocks_fill(&r->blocks, &analysis->design, &r->estimator, &r->damper);
    return 0;
}

static void list_sensors(rig *r)
{
    const design *design = &r->run.analysis.design;
    const bool is_few = design->estimate.readings > 0;
    r->sensors = is_few ? (size_t)design->estimate.readings : r->outputs;
    r->row = calloc(r->sensors, sizeof *r->row);
    for (size_t i = 0; i < r->sensors; i++)
        r->row[i] = is_few ? (size_t)design->named_first[design->estimate.reading[i].output] : i;
}

/* RMS over the targets of the shape under half the voltage range of every amplifier. */
static double reachable(const rig *r)
{
    const design *design = &r->run.analysis.design;
    double sum = 0;
    for (size_t j = 0; j < r->inputs; j++)
        for (size_t i = 0; i < r->outputs; i++)
            sum += pow(r->run.analysis.influence[i * r->all + j] *
                           (design->upper[j] - design->lower[j]) / 2,
                       2) /
                   (double)r->outputs;
    return sqrt(sum);
}

static int open_rig(rig *r, const storm_structure *structure)
{
    double too_small;
    memset(r, 0, sizeof *r);
    r->structure = structure;
    analysis *analysis = &r->run.analysis;
    const design *design = &analysis->design;
    if (scene_run_open(&r->run, structure->scene, structure->changes) < 0 ||
        analysis_influence(analysis, r->run.error) < 0 || open_tables(r) < 0 ||
        analysis_vibration(analysis, &r->vibration, MODES, r->run.error) < 0)
        return complain(structure->name, r->run.error);
    r->inputs = (size_t)design->amplifiers;
    r->outputs = (size_t)design->targets;
    r->all = design->structure.input.count;
    r->delay = design->simulate.delay;
    list_sensors(r);
    if (!modal_open(&r->modal, design, &r->vibration, r->inputs) ||
        !inertia_open(&r->inertia, &r->modal))
        return complain(structure->name, "out of memory");
    r->blocks.supervision.waits = 0;
    (void)pzs_supervision_seal(&r->blocks.supervision);
    (void)pzs_loop_init(&r->loop, r->blocks.block, (size_t)r->blocks.count, NULL, &too_small, 0);
    r->bytes = (size_t)r->loop.info.where;
    r->work = malloc(r->bytes);
    r->memory = calloc((4 + PLAYS) * r->inputs + (HISTORY + 1) * r->sensors + 2 * r->outputs +
                           r->modal.modes,
                       sizeof *r->memory);
    r->acting = r->memory;
    r->wire = r->acting + r->inputs;
    r->play = r->wire + r->inputs;
    r->static_reading = r->play + PLAYS * r->inputs;
    r->readings = r->static_reading + HISTORY * r->sensors;
    r->wanted = r->readings + r->sensors;
    r->goal = r->wanted + r->outputs;
    r->load = r->goal + r->outputs;
    for (size_t i = 0; i < r->outputs; i++)
        r->goal[i] = design->target[i];
    const double target = design_target_rms(design), reach = reachable(r);
    r->reach = reach;
    r->unit = target > 0 ? fmin(target, reach) : reach;
    r->period = r->damper.modes > 0 ? r->damper.rate / r->damper.frequency[0] : 20;
    printf("%s: period %.1f ticks, %d modes observed, %zu inputs %zu sensors %zu outputs, target "
           "%.3g reach %.3g, alarm_ticks %u polarity %u load %.3g W, slack %.3g W\n",
           structure->name, r->period, (int)r->damper.modes, r->inputs, r->sensors, r->outputs,
           target, reach, r->blocks.supervision.alarm_ticks, r->blocks.supervision.polarity_ticks,
           (double)r->blocks.supervision.load / r->unit,
           (double)r->blocks.supervision.slack / r->unit);
    return 0;
}

static void close_rig(rig *r)
{
    free(r->work);
    free(r->memory);
    free(r->row);
    inertia_close(&r->inertia);
    modal_close(&r->modal);
    vibration_free(&r->vibration);
    damper_close(&r->damper);
    if (r->run.analysis.design.estimate.readings > 0)
        estimator_close(&r->estimator);
    scene_run_close(&r->run);
}

static void start(rig *r, uint64_t seed)
{
    (void)pzs_loop_init(&r->loop, r->blocks.block, (size_t)r->blocks.count, NULL, r->work,
                        r->bytes);
    r->random = seed;
    r->noises = seed + 1;
    r->tick = 0;
    r->stuck = -1;
    r->missed = 0;
    r->noise = 1e-4 * r->unit;
    r->gain = 1;
    r->hysteresis = 0;
    r->inertia.stretch = 1;
    r->inertia.interval = 0;
    for (size_t j = 0; j < r->inputs; j++) {
        r->wire[j] = 1;
        r->acting[j] = r->loop.info.voltage[j];
        for (int i = 0; i < PLAYS; i++)
            r->play[j * PLAYS + (size_t)i] = r->acting[j];
    }
    memset(r->load, 0, r->modal.modes * sizeof *r->load);
    memcpy(r->wanted, r->goal, r->outputs * sizeof *r->wanted);
}

/* After the gain is chosen. */
static void settle(rig *r)
{
    r->inertia.gain = r->gain;
    inertia_rest(&r->inertia, r->acting);
}

/* Random gain, frequencies and hysteresis in the box of the certificate. */
static void choose_plant(rig *r)
{
    static const double gains[] = {1, 0.8, 1.33}, frequencies[] = {1, 0.9, 1.1},
                        widths[] = {0, 0.1, 0.3};
    r->gain = gains[random_int(&r->random, 3)];
    r->inertia.stretch = frequencies[random_int(&r->random, 3)];
    r->hysteresis = widths[random_int(&r->random, 3)];
    settle(r);
}

static double act(rig *r, size_t j, double voltage)
{
    const design *design = &r->run.analysis.design;
    double mean = 0;
    for (int i = 0; i < PLAYS; i++) {
        const double slack = (design->upper[j] - design->lower[j]) / 2 * (i + 1) / (2 * PLAYS);
        double *play = &r->play[j * PLAYS + (size_t)i];
        *play = fmin(fmax(*play, voltage - slack), voltage + slack);
        mean += *play / PLAYS;
    }
    return voltage + r->hysteresis * 16 / 5 * (mean - voltage);
}

/* Change the load of the plant, given by the static coordinates of its modes. */
static void set_load(rig *r, const double *load)
{
    for (size_t k = 0; k < r->modal.modes; k++) {
        r->inertia.deviation[k] -= load[k] - r->load[k];
        r->load[k] = load[k];
    }
}

static void observe(rig *r, size_t row, double *reading)
{
    inertia_observe(&r->inertia, row, 1, reading);
    for (size_t j = 0; j < r->inputs; j++)
        *reading += r->gain * r->run.analysis.influence[row * r->all + j] * r->acting[j];
    for (size_t k = 0; k < r->modal.modes; k++)
        *reading += r->modal.shape[row * r->modal.modes + k] * r->load[k];
}

static pzs_status run_tick(rig *r)
{
    pzs_status status = PZS_OK;
    double *now = r->static_reading + (size_t)(r->tick % HISTORY) * r->sensors;
    const int then = r->tick > r->delay ? r->tick - r->delay : 0;
    const double *seen = r->static_reading + (size_t)(then % HISTORY) * r->sensors;
    for (size_t i = 0; i < r->sensors; i++)
        observe(r, r->row[i], &now[i]);
    for (size_t i = 0; i < r->sensors; i++)
        r->readings[i] = seen[i] + r->noise * random_noise(&r->noises);
    r->was_missed = r->tick > 0 && r->missed > 0 && uniform(&r->random, 0, 1) < r->missed;
    if (r->was_missed)
        (void)pzs_loop_skip(&r->loop, 1);
    else
        status = pzs_loop_tick(&r->loop, r->wanted, r->readings);
    for (size_t j = 0; j < r->inputs; j++)
        if ((int)j != r->stuck)
            r->acting[j] = act(r, j, r->wire[j] * r->loop.info.voltage[j]);
    inertia_jump(&r->inertia, r->acting);
    inertia_advance(&r->inertia, 1 / r->run.analysis.design.control.rate);
    r->tick++;
    return status;
}

/*
 * Update the counts of a structure that does not follow the voltages, for each slack that is tried.
 * The polarity monitor itself compares motions only with the slack of the tables.
 */
static void count_idle(rig *r)
{
    const pzs_supervisor *s = pzs_loop_find(&r->loop, &pzs_supervisor_block);
    const pzs_polarity_state *p = &s->state.monitor.polarity;
    double square = 0;
    for (size_t i = 0; i < r->outputs; i++)
        square += (double)p->direction[i] * (double)p->direction[i];
    const double unit = sqrt(square * (double)r->outputs) * r->reach;
    const double predicted = (double)(p->now[0] - p->before[0]),
                 measured = (double)(p->now[1] - p->before[1]);
    const bool is_judged = p->remaining > 0 && p->first - p->remaining > 2 && unit > 0;
    for (int k = 0; k < SLACKS; k++) {
        idle_count *count = &r->idle[k];
        const bool is_idle = is_judged && predicted > 2 * (double)p->least &&
                             predicted > (k + 1) * slack_step * unit && measured < predicted / 10;
        const uint32_t lowered = count->over > 2 ? count->over - 2 : 0;
        count->over = is_idle ? count->over + 1 : lowered;
        if (count->over > r->blocks.supervision.polarity_ticks && !count->is_alarm) {
            count->is_alarm = true;
            count->alarms++;
        }
    }
}

static bool is_stopped(const rig *r)
{
    const pzs_supervisor *s = pzs_loop_find(&r->loop, &pzs_supervisor_block);
    return s && (s->info.mode == PZS_MODE_STOPPING || s->info.mode == PZS_MODE_LATCHED);
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
    const design *design = &r->run.analysis.design;
    const double factor = uniform(&r->random, -1, 1);
    const bool is_shape = uniform(&r->random, 0, 1) < 0.3;
    (void)c;
    for (size_t i = 0; i < r->outputs; i++)
        r->wanted[i] = is_shape ? 0 : factor * r->goal[i];
    for (size_t j = 0; j < r->inputs && is_shape; j++) {
        const double middle = (design->upper[j] + design->lower[j]) / 2;
        const double voltage = middle + uniform(&r->random, -1, 1) * (design->upper[j] - middle);
        for (size_t i = 0; i < r->outputs; i++)
            r->wanted[i] += r->run.analysis.influence[i * r->all + j] * voltage;
    }
}

/* A point load, or a pressure-like load in the first modes, of `size` units. */
static void random_load(rig *r, double size, double *load)
{
    double square = 0;
    const size_t modes = r->modal.modes, row = (size_t)random_int(&r->random, (int)r->outputs);
    const int kind = random_int(&r->random, 3);
    for (size_t k = 0; k < modes; k++)
        load[k] = kind > 0 ? r->modal.shape[row * modes + k] / pow(r->modal.frequency[k], 2)
                           : uniform(&r->random, -1, 1) / pow(r->modal.frequency[k], 2);
    for (size_t i = 0; i < r->outputs; i++) {
        double value = 0;
        for (size_t k = 0; k < modes; k++)
            value += r->modal.shape[i * modes + k] * load[k];
        square += value * value / (double)r->outputs;
    }
    const double factor = square > 0 ? size * r->unit / sqrt(square) : 0;
    for (size_t k = 0; k < modes; k++)
        load[k] *= factor * (kind == 2 ? -1 : 1);
}

static int ticks_until(rig *r, double low, double high)
{
    return 1 + (int)(uniform(&r->random, low, high) * fmax(r->period, 10));
}

static void move_load(rig *r, course *c)
{
    static double load[MODES];
    const size_t modes = r->modal.modes;
    if (c->load == NO_LOAD)
        return;
    if (r->tick >= c->next_load) {
        memcpy(c->from, r->load, modes * sizeof *c->from);
        random_load(r, uniform(&r->random, 0.1, 1) * c->size, c->to);
        if (uniform(&r->random, 0, 1) < 0.3 && c->load != WAVES)
            memset(c->to, 0, modes * sizeof *c->to);
        c->since = r->tick;
        c->next_load = r->tick + ticks_until(r, 0.5 * c->every, 1.5 * c->every);
        c->rate = c->load == WAVES ? 6.2832 / r->period * pow(10, uniform(&r->random, -1, 0.5))
                                   : 1 / (fmax(r->period, 10) * uniform(&r->random, 0.3, 4));
        if (c->load == IMPULSES)
            for (size_t k = 0; k < modes; k++)
                r->inertia.velocity[k] += c->to[k];
        if (c->load == STEPS)
            set_load(r, c->to);
    }
    const double way = fmin(1, (r->tick - c->since) * c->rate);
    const double wave = sin(c->rate * (r->tick - c->since));
    for (size_t k = 0; k < modes; k++)
        load[k] = c->load == RAMPS ? c->from[k] + way * (c->to[k] - c->from[k]) : c->to[k] * wave;
    if (c->load == RAMPS || c->load == WAVES)
        set_load(r, load);
}

static void move_target(rig *r, course *c)
{
    if (c->target == JUMPING && r->tick >= c->next_target) {
        set_target(r, c);
        c->next_target = r->tick + ticks_until(r, 0.2 * c->every, 1.8 * c->every);
    }
    if (c->target == ZERO)
        memset(r->wanted, 0, r->outputs * sizeof *r->wanted);
    if (c->target != MOVING)
        return;
    const double wave = sin(c->phase + r->tick * 6.2832 / (c->every * fmax(r->period, 10)));
    for (size_t i = 0; i < r->outputs; i++)
        r->wanted[i] = wave * r->goal[i];
}

static void reverse(rig *r, const course *c)
{
    if (c->reversed == 0 || r->tick != c->at)
        return;
    for (size_t j = 0; j < r->inputs; j++)
        r->wire[j] = c->reversed == 3 || (c->reversed == 2 && random_int(&r->random, 2)) ? -1 : 1;
    if (c->reversed == 1)
        r->wire[random_int(&r->random, (int)r->inputs)] = -1;
}

/* Run a course. Returns the tick of the alarm, or -1. */
static int run_course(rig *r, course c)
{
    static double from[MODES], to[MODES];
    const int which = random_int(&r->random, (int)r->inputs);
    c.from = from;
    c.to = to;
    c.phase = uniform(&r->random, 0, 6);
    memset(from, 0, sizeof from);
    memset(to, 0, sizeof to);
    c.next_load = ticks_until(r, 0.5, 3);
    c.next_target = c.target == JUMPING && c.reversed == 0 ? 0 : ticks_until(r, 1, 4);
    r->missed = c.missed;
    if (c.hysteresis > 0)
        r->hysteresis = c.hysteresis;
    for (int k = 0; k < SLACKS; k++) {
        r->idle[k].over = 0;
        r->idle[k].is_alarm = false;
    }
    if (c.noise > 0)
        r->noise = c.noise * r->unit;
    while (r->tick < c.ticks) {
        reverse(r, &c);
        move_target(r, &c);
        move_load(r, &c);
        r->stuck = c.sticks && r->tick > c.ticks / 2 ? which : -1;
        (void)run_tick(r);
        if (c.counts_idle)
            count_idle(r);
        if (is_stopped(r))
            return r->tick;
    }
    return -1;
}

/* ---- table ------------------------------------------------------------- */

/* What a row of the table demands. */
typedef enum demand {
    SHOWN,   /* nothing: the alarms are counted */
    FOUND,   /* nothing, of reversed amplifiers: the ticks to the alarm are printed */
    NO_ALARM /* of healthy loops: no alarm */
} demand;

typedef struct row {
    const char *name;
    course course;
    demand demand;
} row;

static const row rows[] = {
    {"reversed from the start, constant", {.target = CONSTANT, .reversed = 3}, FOUND},
    {"reversed from the start, zero target, load",
     {.target = ZERO, .load = STEPS, .size = 1, .every = 100, .reversed = 3},
     FOUND},
    {"reversed from the start, jumping", {.target = JUMPING, .every = 2, .reversed = 3}, FOUND},
    {"reversed from the start, moving", {.target = MOVING, .every = 10, .reversed = 3}, FOUND},
    {"reversed in service, constant", {.target = CONSTANT, .reversed = 3, .at = 1}, FOUND},
    {"reversed in service, jumping",
     {.target = JUMPING, .every = 2, .reversed = 3, .at = 1},
     FOUND},
    {"reversed in service, moving", {.target = MOVING, .every = 10, .reversed = 3, .at = 1}, FOUND},
    {"half reversed from the start, constant", {.target = CONSTANT, .reversed = 2}, FOUND},
    {"one reversed from the start, constant", {.target = CONSTANT, .reversed = 1}, FOUND},
    {"healthy, constant", {.target = CONSTANT}, NO_ALARM},
    {"healthy, jumping", {.target = JUMPING, .every = 2}, NO_ALARM},
    {"healthy, jumping, stuck electrode",
     {.target = JUMPING, .every = 3, .sticks = true},
     NO_ALARM},
    {"healthy, jumping, missed ticks", {.target = JUMPING, .every = 3, .missed = 0.1}, NO_ALARM},
    {"healthy, jumping, noise 0.005", {.target = JUMPING, .every = 3, .noise = 0.005}, NO_ALARM},
    {"healthy, storm", {.target = JUMPING, .every = 0.6}, NO_ALARM},
    {"healthy, moving", {.target = MOVING, .every = 6}, NO_ALARM},
    {"healthy, steps of load 0.3",
     {.target = JUMPING, .load = STEPS, .size = 0.3, .every = 3},
     NO_ALARM},
    {"healthy, steps of load 2", {.target = CONSTANT, .load = STEPS, .size = 2, .every = 4}, SHOWN},
    {"healthy, steps of load 5", {.target = CONSTANT, .load = STEPS, .size = 5, .every = 6}, SHOWN},
    {"healthy, steps of load 15",
     {.target = CONSTANT, .load = STEPS, .size = 15, .every = 6},
     SHOWN},
    {"healthy, jumping, steps of load 15",
     {.target = JUMPING, .load = STEPS, .size = 15, .every = 3},
     SHOWN},
    {"healthy, ramps of load 3", {.target = CONSTANT, .load = RAMPS, .size = 3, .every = 3}, SHOWN},
    {"healthy, ramps of load 15",
     {.target = CONSTANT, .load = RAMPS, .size = 15, .every = 4},
     SHOWN},
    {"healthy, waves of load 1", {.target = CONSTANT, .load = WAVES, .size = 1, .every = 8}, SHOWN},
    {"healthy, waves of load 5", {.target = CONSTANT, .load = WAVES, .size = 5, .every = 8}, SHOWN},
    {"healthy, impulses 1", {.target = CONSTANT, .load = IMPULSES, .size = 1, .every = 4}, SHOWN},
    {"healthy, impulses 5", {.target = JUMPING, .load = IMPULSES, .size = 5, .every = 4}, SHOWN},
    {"healthy, jumping, 30 % hysteresis",
     {.target = JUMPING, .every = 6, .hysteresis = 0.3},
     NO_ALARM},
};
enum { ROWS = sizeof rows / sizeof *rows };

static int compare_ints(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* Numbers of alarms, by cause, of the runs of one row. */
typedef struct tally {
    int alarms, opposed, vibrating;
    int ticks[RUNS_MOST]; /* [alarms] ticks from the reversal to the alarm */
} tally;

/* Run one row of the table once on a random structure. */
static void run_once(rig *r, const row *row, uint64_t seed, tally *tally)
{
    const double period = fmax(r->period, 20);
    course c = row->course;
    c.counts_idle = row->demand == NO_ALARM && !c.sticks;
    start(r, seed);
    choose_plant(r);
    if (c.at > 0)
        c.at = (int)(uniform(&r->random, 5, 12) * period);
    c.ticks =
        row->demand == FOUND ? c.at + (int)fmax(8 * period, 600) : (int)fmax(40 * period, 1000);
    const int tick = run_course(r, c);
    if (tick < 0)
        return;
    const pzs_supervisor *supervisor = pzs_loop_find(&r->loop, &pzs_supervisor_block);
    const bool is_alarm = supervisor->info.cause == PZS_EVENT_ALARM;
    tally->ticks[tally->alarms++] = tick - c.at;
    tally->opposed += is_alarm && supervisor->info.is_opposed;
    tally->vibrating += is_alarm && !supervisor->info.is_opposed;
}

/* Run and print one row of the table. Returns the number of alarms that it does not allow. */
static int run_row(rig *r, const row *row, uint64_t seed, int runs)
{
    static tally tally;
    memset(&tally, 0, sizeof tally);
    for (int run = 0; run < runs; run++)
        run_once(r, row, seed + (uint64_t)run, &tally);
    qsort(tally.ticks, (size_t)tally.alarms, sizeof *tally.ticks, compare_ints);
    if (row->demand == FOUND || tally.alarms > 0)
        printf("  %-44s %d of %d alarms, %d opposed, %d vibrating; median %d, slowest %d ticks\n",
               row->name, tally.alarms, runs, tally.opposed, tally.vibrating,
               tally.alarms ? tally.ticks[tally.alarms / 2] : 0,
               tally.alarms ? tally.ticks[tally.alarms - 1] : 0);
    fflush(stdout);
    // One of two electrodes that sticks is half of the structure, not a healthy loop.
    const bool is_healthy = row->demand == NO_ALARM && !(row->course.sticks && r->inputs < 3);
    return is_healthy ? tally.alarms : 0;
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
 * Run all rows of the table on one structure. Returns the number of alarms not allowed; a loop that
 * observes no mode is only shown.
 */
static int run_structure(const storm_structure *structure, int runs)
{
    static rig r;
    int bad = 0;
    if (open_rig(&r, structure) < 0)
        return 1;
    for (int k = 0; k < ROWS; k++)
        bad += run_row(&r, &rows[k], 1000 * (uint64_t)k, runs);
    print_idle(&r);
    const bool has_modes = r.damper.modes > 0;
    close_rig(&r);
    return has_modes ? bad : 0;
}

int main(int argc, char **argv)
{
    const bool is_full = argc > 1;
    const int runs = is_full ? atoi(argv[1]) : 2;
    const char *name = argc > 2 ? argv[2] : "";
    int bad = 0;
    for (int k = 0; k < STRUCTURES && runs <= RUNS_MOST; k++)
        if ((is_full || structures[k].is_quick) && strstr(structures[k].name, name))
            bad += run_structure(&structures[k], runs);
    printf("%s - %d alarms of the supervisor on healthy loops\n", bad ? "not ok" : "ok", bad);
    return bad > 0;
}
