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
 * reversed electrodes it names after the storm, and how long each phase of the search takes. Most
 * structures are measured at every node, some by few sensors. Returns 0 where no healthy electrode
 * is held (at most TIMED_LIMIT of 1000 while loads follow the test pulses), the supervisor takes
 * control away from no healthy structure, and the part of the faults that its row demands is named.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/tables/detection.h"
#include "../rigs/fault_rig.h"

#define DETECTED "events: [{at: 9, dead: [v_1_1], announced: detected}]"
#define LINEAR                                                                                     \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;"            \
    "simulate.sensors.delay=0;simulate.amplifiers.step=0;"                                         \
    "simulate.events=[{at: 9, dead: [v_1_1], announced: detected}];"
#define SIMPLE(noise) "simulate={ticks: 10, sensors: {noise: " #noise "}, " DETECTED "};"
#define SOFT                                                                                       \
    "materials.AS4/3501.density=1440000;materials.G1195.density=6840000;control.rate=100;"         \
    "limits={voltage: [-300, 300], step_limit: 20};"
#define RIGS "tests/rigs/scenes/"

/* Readings of six and of eight sensors in the scene plate-few-sensors. */
#define READING(name) "{output: " #name ", noise: 1e-6}"
#define SIX_READINGS                                                                               \
    READING(tip_left)                                                                              \
    ", " READING(tip) ", " READING(tip_right) ", " READING(half_left) ", " READING(                \
        half) ", " READING(half_right)
#define EIGHT_READINGS SIX_READINGS ", " READING(inner_left) ", " READING(inner_right)

/* Sensors of the mirror, on four circles: outputs and readings of each circle, of given radius. */
#define PLACE(ring, radius, eighth)                                                                \
    "{name: r" #ring #eighth ", u3: outer, at: {theta1: " #radius ", theta2: " #eighth "*pi/4}}"
#define PLACES(ring, radius)                                                                       \
    PLACE(ring, radius, 0)                                                                         \
    ", " PLACE(ring, radius, 1) ", " PLACE(ring, radius, 2) ", " PLACE(                            \
        ring, radius, 3) ", " PLACE(ring, radius,                                                  \
                                    4) ", " PLACE(ring, radius,                                    \
                                                  5) ", " PLACE(ring, radius,                      \
                                                                6) ", " PLACE(ring, radius, 7)
#define GAUGE(ring, eighth) "{output: r" #ring #eighth ", noise: 1e-9}"
#define GAUGES(ring)                                                                               \
    GAUGE(ring, 0)                                                                                 \
    ", " GAUGE(ring, 1) ", " GAUGE(ring, 2) ", " GAUGE(ring, 3) ", " GAUGE(ring, 4) ", " GAUGE(    \
        ring, 5) ", " GAUGE(ring, 6) ", " GAUGE(ring, 7)
#define MIRROR                                                                                     \
    "dynamics={damping: 0.01};limits={voltage: [-50, 50], step_limit: 3.3};"                       \
    "control={rate: 10000};" SIMPLE(1e-9) "outputs=[" PLACES(1, 12.6e-3) ", " PLACES(              \
        2, 22.2e-3) ", " PLACES(3, 31.8e-3) ", " PLACES(4, 41.4e-3) "];"

static const fault_structure plate = {"plate, 15 Hz, 1 kHz", "plate-closed-loop", LINEAR, 300, ""};
static const fault_structure six = {"plate", "plate-few-sensors", LINEAR, 300, SIX_READINGS};
static const fault_structure eight = {"plate", "plate-few-sensors", LINEAR, 300, EIGHT_READINGS};
static const fault_structure panel = {"panel", RIGS "storm-panel.yaml", SIMPLE(1e-8), 150, ""};
static const fault_structure twins = {"twins", RIGS "storm-twins.yaml", SIMPLE(1e-8), 200, ""};
static const fault_structure soft = {"soft plate", "plate-closed-loop", LINEAR SOFT, 300, ""};
static const fault_structure mirror = {"mirror", "mirror", MIRROR, 50,
                                       GAUGES(1) ", " GAUGES(2) ", " GAUGES(3) ", " GAUGES(4)};

/* Structures around the model: static gain and natural frequencies. */
static const double gains[] = {1, 0.8, 1.33}, frequencies[] = {1, 0.9, 1.1};

/*
 * Numbers of ticks, of electrodes that were suspected, of electrodes that were held, and of runs in
 * which the supervisor took control away.
 */
typedef struct tally {
    long ticks, tests, held, alarms;
} tally;

/* Add a run of healthy electrodes, whose ticks are counted already. */
static void add_run(tally *tally, const fault_rig *rig)
{
    tally->held += fault_rig_detector(rig)->info.found;
    tally->tests += fault_rig_detector(rig)->info.tests;
    tally->alarms += damped_plant_is_stopped(&rig->plant);
}

/*
 * Return a duration that is given for a test pulse of 213 ticks, in ticks of this structure, with
 * its shorter or longer pulses.
 */
static int scaled(const fault_rig *rig, int ticks)
{
    return (int)((long)ticks * rig->plant.parts.pulses.tables.pulse_ticks / 213);
}

/* Run healthy electrodes on nine structures; an electrode that is held is released. */
static tally run_healthy(fault_rig *rig, int ticks, int every, double hysteresis)
{
    tally tally = {0};
    for (unsigned k = 0; k < 9; k++) {
        fault_rig_start(rig, k + 1, gains[k % 3], frequencies[k / 3], hysteresis, every);
        for (int tick = 0; tick < ticks / 9; tick++, tally.ticks++) {
            (void)fault_rig_tick(rig);
            fault_rig_release(rig);
        }
        add_run(&tally, rig);
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
static size_t tested_electrode(fault_rig *rig)
{
    damped_plant *plant = &rig->plant;
    size_t tested = (size_t)damped_plant_uniform(plant, 0, (double)plant->inputs) % plant->inputs,
           first = tested;
    for (size_t k = 0; k < plant->inputs; k++) {
        const size_t j = (first + k) % plant->inputs;
        if (plant->loop.info.electrode[j] == PZS_ELECTRODE_TESTED)
            tested = j;
    }
    return tested;
}

/*
 * Let the load jump. The new load has the shape of an electrode under test, or that of voltages at
 * all electrodes.
 */
static void jump_load(fault_rig *rig)
{
    damped_plant *plant = &rig->plant;
    const design *design = &plant->run.analysis.design;
    const size_t tested = tested_electrode(rig);
    const bool is_single = damped_plant_uniform(plant, 0, 1) < 0.7;
    for (size_t j = 0; j < plant->inputs; j++) {
        const double size = 0.15 * (design->upper[j] - design->lower[j]);
        if (!is_single || j == tested)
            rig->load[j] += (is_single ? 1 : 0.3) * damped_plant_uniform(plant, -size, size);
    }
}

/*
 * Move the target and change the load in one tick of a run with loads. At every second motion of
 * the target one electrode is made to look dead by a load that takes its voltage away, so that it
 * is tested; during the test the load jumps.
 *   next_load in/out  tick of the next jump of the load
 */
static void disturb(fault_rig *rig, int *next_load)
{
    damped_plant *plant = &rig->plant;
    const int episode = scaled(rig, LOAD_EPISODE), delay = scaled(rig, LOAD_DELAY);
    const int every = scaled(rig, LOAD_EVERY), tick = plant->tick % (2 * episode);
    if (tick % episode == 0)
        fault_rig_jump(rig);
    if (tick == episode)
        memset(rig->load, 0, plant->inputs * sizeof *rig->load);
    if (tick == delay) {
        const size_t j = tested_electrode(rig);
        rig->load[j] = -damped_plant_uniform(plant, 0.7, 1.4) * plant->loop.info.voltage[j];
        *next_load = plant->tick + scaled(rig, LOAD_CALM);
    }
    if (plant->tick >= *next_load && tick > delay) {
        jump_load(rig);
        *next_load = plant->tick + (int)damped_plant_uniform(plant, 0.2 * every, 1.8 * every);
    }
}

/*
 * Run healthy electrodes on nine structures under loads that jump during test pulses; an electrode
 * that is held is released.
 */
static tally run_loads(fault_rig *rig, int ticks, double hysteresis)
{
    tally tally = {0};
    for (unsigned k = 0; k < 9; k++) {
        int next_load = scaled(rig, LOAD_EPISODE);
        fault_rig_start(rig, 1000 + k, gains[k % 3], frequencies[k / 3], hysteresis, INT_MAX / 2);
        for (int tick = 0; tick < ticks / 9; tick++, tally.ticks++) {
            disturb(rig, &next_load);
            (void)fault_rig_tick(rig);
            fault_rig_release(rig);
        }
        add_run(&tally, rig);
    }
    return tally;
}

/*
 * Loads that are timed to test pulses, in ticks: time from one motion of the target to the next,
 * and from a motion until an electrode seems to be dead.
 */
enum { TIMED_EPISODE = 1100, TIMED_DELAY = 60 };

/* Courses in time of a load in the shape of an electrode under test. */
typedef enum course { STEPS, RAMPS, SINE, COURSES } course;
static const char *const course_name[COURSES] = {"come and go", "rise and fall", "oscillate"};

/* A load in the shape of one electrode, from the first test pulse of this electrode on. */
typedef struct timed_load {
    course course;
    bool has_begun;
    size_t j;
    int first;                /* tick in which the pulse began */
    double base, size;        /* load before the pulse, and its largest change (V) */
    double from, peak, until; /* begin, turning point and end of the load, in pulses */
    double period, phase;     /* period of an oscillation, in pulses, and its phase (rad) */
} timed_load;

/*
 * Choose a load that may hide the response to the pulse that electrode j begins.
 *   height in  height of the pulse (V)
 */
static void begin_load(fault_rig *rig, timed_load *load, size_t j, double height)
{
    damped_plant *plant = &rig->plant;
    load->has_begun = true;
    load->j = j;
    load->first = plant->tick;
    load->base = rig->load[j];
    load->size = -height * damped_plant_uniform(plant, 0.5, 1.6);
    load->from = damped_plant_uniform(plant, 0, 0.6);
    load->peak = load->from + damped_plant_uniform(plant, 0.1, 0.8);
    load->until = load->peak + damped_plant_uniform(plant, 0.05, 0.8);
    load->period = damped_plant_uniform(plant, 0.5, 3);
    load->phase = damped_plant_uniform(plant, 0, 2 * acos(-1));
}

/*
 * Return the change of the load at a time since the first pulse began, in pulses (V). Loads that
 * come and go, and those that rise and fall, do so in every pulse.
 */
static double load_at(const timed_load *load, double time)
{
    const double angle = 2 * acos(-1) * time / load->period + load->phase;
    const double place = time - floor(time);
    if (load->course == SINE)
        return load->size / 2 * (sin(angle) - sin(load->phase));
    if (place < load->from || place > load->until)
        return 0;
    if (load->course == STEPS)
        return place < load->peak ? load->size : 0;
    const double rise = (place - load->from) / (load->peak - load->from);
    const double fall = (load->until - place) / (load->until - load->peak);
    return load->size * fmin(rise, fall);
}

/* Move the target and change the load in one tick of a run with loads timed to test pulses. */
static void hide_pulse(fault_rig *rig, timed_load *load)
{
    damped_plant *plant = &rig->plant;
    const pzs_pulse_detector_state *state = &fault_rig_detector(rig)->state;
    const int tick = plant->tick % scaled(rig, TIMED_EPISODE);
    if (tick == 0) {
        fault_rig_jump(rig);
        memset(rig->load, 0, plant->inputs * sizeof *rig->load);
        load->has_begun = false;
    }
    if (tick == scaled(rig, TIMED_DELAY)) {
        const size_t j = tested_electrode(rig);
        rig->load[j] = -damped_plant_uniform(plant, 0.7, 1.4) * plant->loop.info.voltage[j];
    }
    if (state->has_taken && !load->has_begun)
        begin_load(rig, load, state->suspect, state->height[0]);
    if (load->has_begun) {
        const double time =
            (double)(plant->tick - load->first) / plant->parts.pulses.tables.pulse_ticks;
        rig->load[load->j] = load->base + load_at(load, time);
    }
}

/*
 * Run healthy electrodes on nine structures under loads in the shape of an electrode under test
 * that are timed to its test pulses; an electrode that is held is released.
 */
static tally run_timed_loads(fault_rig *rig, course course, int ticks, double hysteresis)
{
    tally tally = {0};
    for (unsigned k = 0; k < 9; k++) {
        timed_load load = {.course = course};
        fault_rig_start(rig, 2000 + k, gains[k % 3], frequencies[k / 3], hysteresis, INT_MAX / 2);
        for (int tick = 0; tick < ticks / 9; tick++, tally.ticks++) {
            hide_pulse(rig, &load);
            (void)fault_rig_tick(rig);
            fault_rig_release(rig);
        }
        add_run(&tally, rig);
    }
    return tally;
}

/* Durations in a run with faults (ticks). STORM_EVERY: mean time between jumps of the target. */
enum {
    RUNS_OF_EACH = 4,
    STORM_TICKS = 200,
    REST_TICKS = 700,
    PROOF_TICKS = 3000,
    STORM_EVERY = 40
};

/* Phases of the search for a faulty electrode, from the fault until the electrode is held. */
typedef enum phase {
    MOTION, /* the target moves, and no electrode is suspected */
    REST,   /* the target stands still, and no electrode is suspected */
    OTHERS, /* a healthy electrode is suspected or tested */
    READY,  /* the faulty electrode is suspected, and the target moves */
    PAUSE,  /* the faulty electrode is suspected; vibration decays before its first test pulse */
    PULSES, /* the faulty electrode is tested */
    AFTER,  /* all phases from the end of the storm on */
    PHASES
} phase;
static const char *const phase_name[PHASES] = {"motion", "rest",   "others",         "ready",
                                               "pause",  "pulses", "after the storm"};

/* Results of runs in each of which one electrode fails. */
typedef struct named {
    int runs, right, exact; /* right: the electrode is held; exact: its fault is named, too */
    int wrong;              /* healthy electrodes that are held */
    int slight;             /* faulty electrodes that are not held, and lack at most 5 % of their
                               voltage range */
    int early;              /* runs in which the storm and one proof suffice */
    int unmoved; /* other runs, in which the storm moves the voltage of the electrode by at
                    most 5 % of its range: hardly a motion by which it could be found */
    int ticks[PHASES][RUNS_OF_EACH * FAULT_RIG_INPUTS]; /* [phase][right] duration of each phase */
} named;

/* Duration of a proof (ticks). */
static int proof_ticks(const fault_rig *rig)
{
    const pzs_selftest_tables *tables = &rig->plant.parts.pulses.tables;
    return (int)PZS_PROOF_TICKS(tables->pulse_ticks, tables->delay);
}

/* Return the phase of the search for the faulty electrode j, while the target moves or not. */
static phase phase_of(const fault_rig *rig, size_t j, bool is_moving)
{
    const pzs_pulse_detector_state *state = &fault_rig_detector(rig)->state;
    if (state->suspect == 0xFFFF)
        return is_moving ? MOTION : REST;
    if (state->suspect != j)
        return OTHERS;
    if (is_moving)
        return READY;
    return rig->plant.loop.info.electrode[j] == PZS_ELECTRODE_TESTED ? PULSES : PAUSE;
}

/* Whether electrode j lacks at most 5 % of its voltage range. */
static bool lacks_little(const fault_rig *rig, size_t j)
{
    const damped_plant *plant = &rig->plant;
    const design *design = &plant->run.analysis.design;
    const double lacking = fabs(plant->loop.info.voltage[j] - plant->acting[j]);
    return lacking <= 0.05 * (design->upper[j] - design->lower[j]);
}

/*
 * Let electrodes j and k fail in a storm that follows a rest, and run until both are held, or for
 * PROOF_TICKS after the storm. Without a second fault both numbers are equal. The motion begins
 * with the fault: the target jumps in this tick, and then every 20 to 60 ticks, until STORM_TICKS
 * have passed.
 *   ticks [PHASES] out  durations of the phases of the search for electrode j
 * Returns the largest change of the voltage of electrode j in the storm (V).
 */
static double try_fault(fault_rig *rig, size_t j, size_t k, pzs_electrode_fault fault,
                        int ticks[PHASES])
{
    double moved = 0;
    const int most = STORM_TICKS + (k != j ? 2 : 1) * scaled(rig, PROOF_TICKS);
    fault_rig_run(rig, STORM_TICKS, STORM_EVERY);
    fault_rig_run(rig, scaled(rig, REST_TICKS), 0);
    rig->fault[j] = fault;
    rig->fault[k] = fault;
    memset(ticks, 0, PHASES * sizeof *ticks);
    rig->next_jump = rig->plant.tick;
    const double start = rig->plant.loop.info.voltage[j];
    for (int tick = 0; tick < most; tick++) {
        if (fault_rig_is_held(rig, j) && fault_rig_is_held(rig, k))
            break;
        if (tick == STORM_TICKS)
            rig->next_jump = INT_MAX;
        ticks[phase_of(rig, j, tick < STORM_TICKS)]++;
        ticks[AFTER] += tick >= STORM_TICKS;
        (void)fault_rig_tick(rig);
        if (tick < STORM_TICKS)
            moved = fmax(moved, fabs(rig->plant.loop.info.voltage[j] - start));
    }
    return moved;
}

/*
 * Count the findings of a run in which electrodes j and k have failed.
 *   moved in  largest change of the voltage of electrode j in the storm (V)
 */
static void count_findings(const fault_rig *rig, size_t j, size_t k, pzs_electrode_fault fault,
                           const int ticks[PHASES], double moved, named *result)
{
    const design *design = &rig->plant.run.analysis.design;
    const bool is_right = fault_rig_is_held(rig, j);
    const bool is_early = is_right && ticks[AFTER] <= proof_ticks(rig);
    for (int phase = 0; phase < PHASES && is_right; phase++)
        result->ticks[phase][result->right] = ticks[phase];
    result->runs++;
    result->right += is_right;
    result->early += is_early;
    result->unmoved += !is_early && moved <= 0.05 * (design->upper[j] - design->lower[j]);
    result->exact += is_right && fault_rig_detector(rig)->info.fault[j] == fault;
    result->slight += !is_right && lacks_little(rig, j);
    for (size_t other = 0; other < rig->plant.inputs; other++)
        result->wrong += other != j && other != k && fault_rig_is_held(rig, other);
}

/* One row of the measurement. */
typedef struct row {
    const char *name;
    const fault_structure *structure;
    double ceramic, compensated; /* width of the hysteresis loop of the ceramic, and of the one that
                                    the loop compensates, relative to the voltage range */
    double noise, missed;        /* RMS noise of a reading (m), and chance that a tick is missed */
    size_t second;   /* distance from the faulty electrode to a second one that fails at the same
                        time; 0: there is none */
    int least;       /* smallest part of the faulty electrodes that must be held (%) */
    int soon;        /* smallest part of them for which the storm and one proof must suffice (%) */
    bool is_stopped; /* whether the supervisor takes control away from healthy structures: there
                        are more tracking errors than it accepts, with any fault detector */
    const fault_ceramic *other; /* ceramic of another family, of which the loop compensates what a
                                   sweep has shown; NULL: plays, and the two widths above */
} row;

/* Ceramics of other families, with creep of three time constants. */
static const fault_ceramic plays_creep = {PLAYS_FAMILY, 0.2, 0.03};
static const fault_ceramic preisach_creep = {PREISACH, 0.2, 0.03};
static const fault_ceramic bouc_wen_creep = {BOUC_WEN, 0.2, 0.03};

static const row rows[] = {
    {"plate, no hysteresis", &plate, 0, 0, 1e-7, 0, 0, 95, 95, false, NULL},
    {"plate, 20 % hysteresis, compensated", &plate, 0.2, 0.2, 1e-7, 0, 0, 95, 95, false, NULL},
    {"6 sensors, 20 % hysteresis, compensated", &six, 0.2, 0.2, 1e-6, 0, 0, 90, 65, false, NULL},
    {"20 % hysteresis, 15 % compensated", &plate, 0.2, 0.15, 1e-7, 0, 0, 90, 0, false, NULL},
    {"10 % hysteresis, not compensated", &plate, 0.1, 0, 1e-7, 0, 0, 90, 0, false, NULL},
    {"plate, 30 % hysteresis, compensated", &plate, 0.3, 0.3, 1e-7, 0, 0, 95, 80, false, NULL},
    {"30 % hysteresis, not compensated", &plate, 0.3, 0, 1e-7, 0, 0, 0, 0, false, NULL},
    {"20 % hysteresis, ten times the noise", &plate, 0.2, 0.2, 1e-6, 0, 0, 95, 85, false, NULL},
    {"20 % hysteresis, 5 % of the ticks missed", &plate, 0.2, 0.2, 1e-7, 0.05, 0, 85, 0, false,
     NULL},
    {"20 % hysteresis, two electrodes at once", &plate, 0.2, 0.2, 1e-7, 0, 7, 85, 0, false, NULL},
    {"8 sensors, no hysteresis", &eight, 0, 0, 1e-6, 0, 0, 90, 0, false, NULL},
    {"6 sensors, no hysteresis", &six, 0, 0, 1e-6, 0, 0, 80, 0, false, NULL},
    {"8 sensors, 20 % hysteresis, compensated", &eight, 0.2, 0.2, 1e-6, 0, 0, 90, 0, false, NULL},
    {"panel, no hysteresis", &panel, 0, 0, 1e-8, 0, 0, 95, 90, false, NULL},
    {"panel, 20 % hysteresis, compensated", &panel, 0.2, 0.2, 1e-8, 0, 0, 95, 0, false, NULL},
    {"panel, 30 % hysteresis, compensated", &panel, 0.3, 0.3, 1e-8, 0, 0, 95, 0, false, NULL},
    {"near-equal modes, no hysteresis", &twins, 0, 0, 1e-8, 0, 0, 95, 90, false, NULL},
    {"near-equal modes, 20 % hysteresis, compensated", &twins, 0.2, 0.2, 1e-8, 0, 0, 95, 0, false,
     NULL},
    {"near-equal modes, 30 % hysteresis, compensated", &twins, 0.3, 0.3, 1e-8, 0, 0, 95, 0, false,
     NULL},
    {"soft, no hysteresis", &soft, 0, 0, 1e-7, 0, 0, 95, 70, false, NULL},
    {"soft, 20 % hysteresis, compensated", &soft, 0.2, 0.2, 1e-7, 0, 0, 95, 0, false, NULL},
    {"soft, 30 % hysteresis, compensated", &soft, 0.3, 0.3, 1e-7, 0, 0, 95, 0, false, NULL},
    {"mirror, 32 sensors, no hysteresis", &mirror, 0, 0, 1e-9, 0, 0, 95, 0, false, NULL},
    {"mirror, 32 sensors, 20 % hysteresis, compensated", &mirror, 0.2, 0.2, 1e-9, 0, 0, 95, 0,
     false, NULL},
    {"mirror, 32 sensors, 30 % hysteresis, compensated", &mirror, 0.3, 0.3, 1e-9, 0, 0, 75, 0, true,
     NULL},
    {"plays of 20 % and creep, identified", &plate, 0, 0, 1e-7, 0, 0, 95, 85, false, &plays_creep},
    {"Preisach ceramic of 20 % and creep, identified", &plate, 0, 0, 1e-7, 0, 0, 95, 80, false,
     &preisach_creep},
    {"Bouc-Wen ceramic of 20 % and creep, identified", &plate, 0, 0, 1e-7, 0, 0, 95, 50, false,
     &bouc_wen_creep},
};
/*
 * Largest number of healthy electrodes that may be held in 1000 tests under loads timed to test
 * pulses. Such loads know when a pulse begins, and no detector can tell one that follows the pulse
 * from a silent electrode; the limit holds the detector to its measured state.
 */
enum { TIMED_LIMIT = 20 };
enum { ROWS = sizeof rows / sizeof *rows, QUICK_ROWS = 3 };

/*
 * Let electrodes fail one after the other, RUNS_OF_EACH times each, on structures around the model.
 *   stride in  only every `stride`-th of these runs is made
 */
static void run_faults(fault_rig *rig, const row *row, pzs_electrode_fault fault, size_t stride,
                       named *result)
{
    memset(result, 0, sizeof *result);
    for (size_t k = 0; k < RUNS_OF_EACH * rig->plant.inputs; k += stride) {
        int ticks[PHASES];
        const size_t j = k % rig->plant.inputs, second = (j + row->second) % rig->plant.inputs;
        const size_t seed = 100 + j + 1000 * (k / rig->plant.inputs);
        fault_rig_start(rig, seed, gains[k % 3], frequencies[k / 3 % 3], row->ceramic, STORM_EVERY);
        const double moved = try_fault(rig, j, second, fault, ticks);
        count_findings(rig, j, second, fault, ticks, moved, result);
    }
}

/*
 * Compare what `pzs check` says of the fault detector with the law: the ratio of response to noise
 * is inversely proportional to the stated noise, and above 17 every electrode is said to be
 * detectable, below it none. Returns the number of failures.
 */
static long check_detection(fault_rig *rig)
{
    damped_plant *plant = &rig->plant;
    static const double factors[] = {1, 10, 1e6};
    double ratio[3] = {0};
    long failures = 0;
    for (int k = 0; k < 3; k++) {
        detection detection;
        char text[SCENE_ERROR];
        for (size_t i = 0; i < plant->sensors; i++)
            plant->parts.pulses.stated[i] *= factors[k];
        (void)detection_of(&detection, &plant->parts.blocks);
        for (size_t i = 0; i < plant->sensors; i++)
            plant->parts.pulses.stated[i] /= factors[k];
        detection_text(&detection, &plant->run.analysis.design, text);
        if (k == 0)
            printf("  %s\n", text);
        ratio[k] = detection.ratio * factors[k];
        failures += detection.detectable != (k < 2 ? (int)plant->inputs : 0);
        failures += fabs(ratio[k] - ratio[0]) > 1e-9 * ratio[0];
        detection_close(&detection);
    }
    return failures;
}

static int compare_ticks(const void *first, const void *second)
{
    return *(const int *)first - *(const int *)second;
}

/* Print mean, nine tenths and largest of the durations of a phase. */
static void print_phase(const char *name, int *ticks, int count)
{
    double sum = 0;
    for (int k = 0; k < count; k++)
        sum += ticks[k];
    qsort(ticks, (size_t)count, sizeof *ticks, compare_ticks);
    printf(" %s %.0f / %d / %d;", name, count > 0 ? sum / count : 0,
           count > 0 ? ticks[(count * 9 + 9) / 10 - 1] : 0, count > 0 ? ticks[count - 1] : 0);
}

/* Print the findings of the runs with one kind of fault, and the durations of their phases. */
static void print_named(const fault_rig *rig, const char *fault, named *n)
{
    printf("  %-8s: %d of %d held, %d others lack at most 5 %% of their range, %d named exactly, "
           "%d healthy ones held; in %d %d ticks of motion and a proof of %d suffice, in %d "
           "others the electrode moved by at most 5 %% of its range\n"
           "           ticks (mean / 90 %% / slowest):",
           fault, n->right, n->runs, n->slight, n->exact, n->wrong, n->early, STORM_TICKS,
           proof_ticks(rig), n->unmoved);
    for (int phase = 0; phase < PHASES; phase++)
        print_phase(phase_name[phase], n->ticks[phase], n->right);
    printf("\n");
}

/*
 * Measure one row.
 *   ticks  in  number of ticks without a fault for each mean time between jumps of the target
 *   stride in  only every `stride`-th of the runs with a fault is made
 *   total  in/out  tests under loads timed to test pulses, and healthy electrodes held in them
 * Returns the number of failures: healthy electrodes that are held, and kinds of faults of which
 * too few are held, or too few soon.
 */
static long measure(fault_rig *rig, const row *row, int ticks, size_t stride, tally *total)
{
    static const int every[] = {40, 600, 2500};
    static const char *const word[] = {"none", "dead", "stuck", "reversed"};
    long failures = 0;
    printf("%s\n", row->name);
    rig->noise = row->noise;
    rig->missed = row->missed;
    failures += check_detection(rig);
    for (int i = 0; i < 3; i++) {
        const tally tally = run_healthy(rig, ticks, every[i], row->ceramic);
        printf("  jumps every %5d ticks: %ld healthy ticks, %ld suspected, %ld held, %ld alarms\n",
               every[i], tally.ticks, tally.tests, tally.held, tally.alarms);
        failures += tally.held + (row->is_stopped ? 0 : tally.alarms);
    }
    const tally loaded = run_loads(rig, 2 * ticks, row->ceramic);
    printf(
        "  loads that jump during tests: %ld healthy ticks, %ld suspected, %ld held, %ld alarms\n",
        loaded.ticks, loaded.tests, loaded.held, loaded.alarms);
    failures += loaded.held;
    failures += row->is_stopped ? 0 : loaded.alarms;
    for (int k = 0; k < COURSES; k++) {
        const tally timed = run_timed_loads(rig, (course)k, 2 * ticks, row->ceramic);
        printf("  loads that %s with test pulses: %ld suspected, %ld held, %ld alarms\n",
               course_name[k], timed.tests, timed.held, timed.alarms);
        total->tests += timed.tests;
        total->held += timed.held;
    }
    for (int fault = PZS_FAULT_DEAD; fault <= PZS_FAULT_REVERSED; fault++) {
        static named n;
        run_faults(rig, row, (pzs_electrode_fault)fault, stride, &n);
        print_named(rig, word[fault], &n);
        failures += n.wrong + (100 * n.right < row->least * n.runs);
        failures += 100 * n.early < row->soon * n.runs;
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
    static fault_rig rig;
    tally total = {0};
    long failures = 0;
    for (int k = 0; k < measured; k++) {
        if (*name && !strstr(rows[k].name, name))
            continue;
        if (fault_rig_open(&rig, rows[k].structure, rows[k].compensated, rows[k].other) < 0)
            return 1;
        failures += measure(&rig, &rows[k], ticks, is_full ? 1 : 7, &total);
        fault_rig_close(&rig);
    }
    printf("loads timed to test pulses: %ld healthy electrodes held in %ld tests\n", total.held,
           total.tests);
    failures += 1000 * total.held > TIMED_LIMIT * total.tests;
    printf("%s - %ld failures\n", failures ? "not ok" : "ok", failures);
    return failures > 0;
}
