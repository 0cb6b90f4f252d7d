/*
 * Fault detector of electrodes in a loop that damps vibration, on plates with mass that differ from
 * their model, with hysteresis of the ceramic, while the target jumps.
 *
 *   faults [TICKS]   number of ticks without a fault for each row of the table, default 9000
 *
 * Prints how many healthy electrodes the detector tests and holds, and how many dead and stuck
 * electrodes it names. pzs tables refuses this combination of blocks, because the detector reads
 * changes of the static shape from tick to tick, and the static shape that the observer of the
 * modes gives changes too slowly. Returns 0 where no healthy electrode is held.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/modal.h"
#include "../../host_tools/simulate/imperfections.h"
#include "../../host_tools/simulate/inertia.h"
#include "../../host_tools/simulate/random.h"
#include "../../host_tools/tables/loop_blocks.h"
#include "../rigs/scene_run.h"

#define LINEAR                                                                                     \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;"            \
    "simulate.amplifiers.step=0;"                                                                  \
    "simulate.events=[{at: 9, dead: [v_1_1], announced: detected}]"

enum { CERAMIC_PLAYS = 4, MODES = 20, INPUTS = 64 };

/* A damped loop with a fault detector, around a plate. */
typedef struct rig {
    scene_run run;
    damper damper;
    loop_blocks blocks;
    vibration vibration;
    modal modal;
    inertia inertia;
    pzs_loop loop;
    void *work;
    size_t bytes; /* memory of the loop */
    size_t inputs, outputs;
    double gain, hysteresis; /* static response relative to the model; width of the hysteresis loop
                                relative to the voltage range */
    double *memory;          /* one allocation that holds the arrays from `acting` on */
    double *acting;          /* [inputs] voltages that act on the ceramic (V) */
    double *play;            /* [inputs][CERAMIC_PLAYS] plays of the hysteresis (V) */
    double *readings;        /* [outputs] readings (m) */
    double *wanted;          /* [outputs] target shape (m) */
    electrode_fault fault[INPUTS];
    uint64_t random;
    int next_jump, every, tick; /* tick of the next target; mean number of ticks between targets;
                                   present tick */
} rig;

static int complain(const char *error)
{
    printf("not ok - %s\n", error);
    return -1;
}

/* Make the tables of the loop, and the modal model of the plate. */
static int open_structure(rig *r)
{
    const estimator none = {0};
    analysis *analysis = &r->run.analysis;
    if (scene_run_open(&r->run, "plate-closed-loop", LINEAR) < 0 ||
        analysis_influence(analysis, r->run.error) < 0)
        return complain(r->run.error);
    certificate_make(&analysis->certificate, analysis);
    analysis->design.simulate.delay = 0;
    const damper_options options = {analysis->design.control.rate, 0, damper_default_settings()};
    if (damper_make(&r->damper, analysis, NULL, &options, r->run.error) < 0 ||
        vibration_solve(&r->vibration, &analysis->design, MODES, MASS_LUMPED, r->run.error) < 0)
        return complain(r->run.error);
    loop_blocks_fill(&r->blocks, &analysis->design, &none, &r->damper);
    r->inputs = (size_t)analysis->design.amplifiers;
    r->outputs = (size_t)analysis->design.targets;
    const bool has_memory = modal_open(&r->modal, &analysis->design, &r->vibration, r->inputs) &&
                            inertia_open(&r->inertia, &r->modal);
    return has_memory && r->inputs <= INPUTS ? 0 : complain("out of memory");
}

/* Number of reals in the memory of a rig. */
static size_t count_reals(const rig *r)
{
    return (1 + CERAMIC_PLAYS) * r->inputs + 2 * r->outputs;
}

static int open_rig(rig *r)
{
    double too_small;
    memset(r, 0, sizeof *r);
    if (open_structure(r) < 0)
        return -1;
    (void)pzs_loop_init(&r->loop, r->blocks.block, (size_t)r->blocks.count, NULL, &too_small, 0);
    r->bytes = (size_t)r->loop.info.where;
    r->work = malloc(r->bytes);
    r->memory = calloc(count_reals(r), sizeof *r->memory);
    if (!r->work || !r->memory)
        return complain("out of memory");
    r->acting = r->memory;
    r->play = r->acting + r->inputs;
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
    static const double noise = 1e-7;
    double next[INPUTS];
    if (r->tick >= r->next_jump)
        jump(r);
    inertia_observe(&r->inertia, 0, r->outputs, r->readings);
    for (size_t i = 0; i < r->outputs; i++) {
        for (size_t j = 0; j < r->inputs; j++)
            r->readings[i] += r->gain * r->run.analysis.influence[i * all + j] * r->acting[j];
        r->readings[i] += noise * random_noise(&r->random);
    }
    const pzs_status status = pzs_loop_tick(&r->loop, r->wanted, r->readings);
    for (size_t j = 0; j < r->inputs; j++) {
        if (r->fault[j] == ELECTRODE_DEAD)
            next[j] = 0;
        else if (r->fault[j] == ELECTRODE_STUCK)
            next[j] = r->acting[j];
        else
            next[j] = act(r, j, r->loop.info.voltage[j]);
    }
    memcpy(r->acting, next, r->inputs * sizeof *next);
    inertia_jump(&r->inertia, next);
    inertia_advance(&r->inertia, 1 / r->run.analysis.design.control.rate);
    r->tick++;
    return status;
}

/* Structures around the model: static gain and natural frequencies. */
static const double gains[] = {1, 0.8, 1.33}, frequencies[] = {1, 0.9, 1.1};

/* Numbers of ticks, of tests, and of electrodes that were held. */
typedef struct tally {
    long ticks, tests, held;
} tally;

/* Run healthy electrodes on nine structures; an electrode that is held is released. */
static tally run_healthy(rig *r, int ticks, int every, double hysteresis)
{
    tally tally = {0};
    for (unsigned k = 0; k < 9; k++) {
        uint8_t last[INPUTS] = {0};
        start(r, k + 1, gains[k % 3], frequencies[k / 3], hysteresis, every);
        for (int tick = 0; tick < ticks / 9; tick++, tally.ticks++) {
            (void)run_tick(r);
            for (size_t j = 0; j < r->inputs; j++) {
                const uint8_t now = r->loop.info.electrode[j];
                tally.tests += now == PZS_ELECTRODE_TESTED && last[j] != now;
                last[j] = now;
                if (now != PZS_ELECTRODE_HELD)
                    continue;
                tally.held++;
                (void)pzs_release(r->loop.info.control, (uint16_t)j);
            }
        }
    }
    return tally;
}

/* Let each electrode fail once. Returns how many are named within 1000 ticks. */
static int run_faults(rig *r, int every, electrode_fault fault, double hysteresis)
{
    int named = 0;
    for (size_t j = 0; j < r->inputs; j++) {
        start(r, 100 + j, gains[j % 3], frequencies[j / 3 % 3], hysteresis, every);
        for (int tick = 0; tick < 500; tick++)
            (void)run_tick(r);
        r->fault[j] = fault;
        for (int tick = 0; tick < 1000; tick++)
            (void)run_tick(r);
        named += r->loop.info.electrode[j] == PZS_ELECTRODE_HELD;
    }
    return named;
}

int main(int count, char **argument)
{
    static const double hysteresis[] = {0, 0.15, 0.3};
    static const int every[] = {40, 200, 1000};
    const int ticks = count > 1 ? atoi(argument[1]) : 9000;
    static rig rig;
    long held = 0;
    if (open_rig(&rig) < 0)
        return 1;
    printf("  %-10s %-10s %9s %6s %13s %10s %11s\n", "jump every", "hysteresis", "ticks", "tests",
           "healthy held", "dead named", "stuck named");
    for (int k = 0; k < 9; k++) {
        const double width = hysteresis[k / 3];
        const tally tally = run_healthy(&rig, ticks, every[k % 3], width);
        held += tally.held;
        printf("  %-10d %-10g %9ld %6ld %13ld %4d of %2d %5d of %2d\n", every[k % 3], width,
               tally.ticks, tally.tests, tally.held,
               run_faults(&rig, every[k % 3], ELECTRODE_DEAD, width), (int)rig.inputs,
               run_faults(&rig, every[k % 3], ELECTRODE_STUCK, width), (int)rig.inputs);
        fflush(stdout);
    }
    printf("%s - %ld healthy electrodes held\n", held ? "not ok" : "ok", held);
    close_rig(&rig);
    return held > 0;
}
