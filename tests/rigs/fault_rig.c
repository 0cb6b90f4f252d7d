/*
 * A loop with a fault detector that damps the vibration of a structure with mass (fault_rig.h).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "fault_rig.h"
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/imperfections.h"
#include "../../host_tools/simulate/random.h"

enum { MODES = 20 };

static int complain(const char *error)
{
    printf("not ok - %s\n", error);
    return -1;
}

/* List the outputs that the sensors measure: all target nodes, or those of the estimator. */
static void list_sensors(fault_rig *rig)
{
    const design *design = &rig->run.analysis.design;
    rig->sensors = 0;
    for (int k = 0; k < design->estimate.readings; k++)
        rig->sensor_row[rig->sensors++] =
            (size_t)design->named_first[design->estimate.reading[k].output];
    for (size_t i = 0; i < rig->outputs && design->estimate.readings == 0; i++)
        rig->sensor_row[rig->sensors++] = i;
}

/* Make the tables of the loop, with the settings that its certificate chooses. */
static int open_tables(fault_rig *rig)
{
    analysis *analysis = &rig->run.analysis;
    const bool is_few = analysis->design.estimate.readings > 0;
    if (certify_loop(analysis, rig->run.error) < 0)
        return complain(rig->run.error);
    const damper_options options = damper_options_of(analysis);
    if (is_few && estimator_open(&rig->estimator, analysis, rig->run.error) < 0)
        return complain(rig->run.error);
    const estimator *few = is_few ? &rig->estimator : NULL;
    if (damper_make(&rig->damper, analysis, few, &options, rig->run.error) < 0)
        return complain(rig->run.error);
    if (!wiring_test_detector_open(&rig->pulses, analysis, few))
        return complain("out of memory");
    loop_blocks_fill(&rig->blocks, &analysis->design, &rig->estimator, &rig->damper);
    loop_blocks_test(&rig->blocks, NULL, &rig->pulses);
    return 0;
}

/* Make the tables of the loop, and the modal model of the structure. */
static int open_structure(fault_rig *rig, const char *scene, const char *change)
{
    analysis *analysis = &rig->run.analysis;
    if (scene_run_open(&rig->run, scene, change) < 0 ||
        analysis_influence(analysis, rig->run.error) < 0)
        return complain(rig->run.error);
    certificate_make(&analysis->certificate, analysis);
    analysis->design.simulate.delay = 0;
    if (open_tables(rig) < 0)
        return -1;
    if (vibration_solve(&rig->vibration, &analysis->design, MODES, MASS_LUMPED, rig->run.error) < 0)
        return complain(rig->run.error);
    rig->inputs = (size_t)analysis->design.amplifiers;
    rig->outputs = (size_t)analysis->design.targets;
    if (rig->inputs > FAULT_RIG_INPUTS || rig->outputs > FAULT_RIG_OUTPUTS)
        return complain("too many inputs or outputs");
    list_sensors(rig);
    const bool has_memory =
        modal_open(&rig->modal, &analysis->design, &rig->vibration, rig->inputs) &&
        inertia_open(&rig->inertia, &rig->modal);
    return has_memory ? 0 : complain("out of memory");
}

/* Number of reals in the memory of a rig. */
static size_t count_reals(const fault_rig *rig)
{
    return (3 + FAULT_RIG_PLAYS) * rig->inputs + 2 * rig->outputs;
}

/*
 * Write the changes of a scene that make its loop compensate hysteresis.
 *   width in  width of the hysteresis loop relative to the voltage range
 *   limit in  largest voltage of each electrode, in both directions (V)
 */
static int write_hysteresis(char *change, size_t bytes, double width, double limit)
{
    const double share = width * 16 / 5, slope = 1 - share, weight = share / FAULT_RIG_PLAYS;
    const double slack = limit / (2 * FAULT_RIG_PLAYS);
    return snprintf(change, bytes,
                    "hysteresis={range: [%g, %g], slopes: [%g, %g, %g, %g], slack: [%g, %g, %g, "
                    "%g], above: [%g, %g, %g, %g]};",
                    -limit, limit, slope, slope, slope, slope, slack, 2 * slack, 3 * slack,
                    4 * slack, weight, weight, weight, weight);
}

/* Write all changes of the scene of a structure. */
static void write_changes(char *change, size_t bytes, const fault_structure *structure,
                          double compensated)
{
    int used = snprintf(change, bytes, "%s", structure->changes);
    if (*structure->readings)
        used += snprintf(change + used, bytes - (size_t)used,
                         "estimate={readings: [%s], tolerance: 0.9};", structure->readings);
    if (compensated > 0)
        (void)write_hysteresis(change + used, bytes - (size_t)used, compensated, structure->limit);
}

/* Allocate the memory of loop and arrays. */
static int open_memory(fault_rig *rig)
{
    double too_small;
    (void)pzs_loop_init(&rig->loop, rig->blocks.block, (size_t)rig->blocks.count, NULL, &too_small,
                        0);
    rig->bytes = (size_t)rig->loop.info.where;
    rig->work = malloc(rig->bytes);
    rig->memory = calloc(count_reals(rig), sizeof *rig->memory);
    if (!rig->work || !rig->memory)
        return complain("out of memory");
    rig->acting = rig->memory;
    rig->load = rig->acting + rig->inputs;
    rig->sum = rig->load + rig->inputs;
    rig->play = rig->sum + rig->inputs;
    rig->readings = rig->play + FAULT_RIG_PLAYS * rig->inputs;
    rig->wanted = rig->readings + rig->outputs;
    return 0;
}

int fault_rig_open(fault_rig *rig, const fault_structure *structure, double compensated)
{
    char change[20000];
    memset(rig, 0, sizeof *rig);
    write_changes(change, sizeof change, structure, compensated);
    return open_structure(rig, structure->scene, change) < 0 ? -1 : open_memory(rig);
}

void fault_rig_close(fault_rig *rig)
{
    free(rig->work);
    free(rig->memory);
    inertia_close(&rig->inertia);
    modal_close(&rig->modal);
    vibration_free(&rig->vibration);
    damper_close(&rig->damper);
    estimator_close(&rig->estimator);
    wiring_test_close(&rig->pulses);
    scene_run_close(&rig->run);
}

double fault_rig_uniform(fault_rig *rig, double low, double high)
{
    return low + (high - low) * random_uniform(&rig->random);
}

void fault_rig_start(fault_rig *rig, uint64_t seed, double gain, double frequency,
                     double hysteresis, int every)
{
    (void)pzs_loop_init(&rig->loop, rig->blocks.block, (size_t)rig->blocks.count, NULL, rig->work,
                        rig->bytes);
    memset(rig->memory, 0, count_reals(rig) * sizeof *rig->memory);
    memset(rig->fault, 0, sizeof rig->fault);
    inertia_rest(&rig->inertia, rig->acting);
    rig->inertia.gain = gain;
    rig->inertia.stretch = frequency;
    rig->inertia.interval = 0;
    rig->gain = gain;
    rig->hysteresis = hysteresis;
    rig->every = every;
    rig->next_jump = 0;
    rig->tick = 0;
    rig->random = seed;
}

void fault_rig_jump(fault_rig *rig)
{
    const design *design = &rig->run.analysis.design;
    const size_t all = design->structure.input.count;
    rig->next_jump = rig->tick + (int)fault_rig_uniform(rig, 0.5 * rig->every, 1.5 * rig->every);
    const double factor = fault_rig_uniform(rig, -1, 1);
    double voltage[FAULT_RIG_INPUTS];
    for (size_t j = 0; j < rig->inputs; j++)
        voltage[j] = 0.5 * fault_rig_uniform(rig, design->lower[j], design->upper[j]);
    for (size_t i = 0; i < rig->outputs; i++) {
        double random_shape = 0;
        for (size_t j = 0; j < rig->inputs; j++)
            random_shape += rig->run.analysis.influence[i * all + j] * voltage[j];
        rig->wanted[i] = factor > 0 ? factor * design->target[i] : random_shape;
    }
}

/* Voltage that acts on the ceramic of electrode j (V). */
static double act(fault_rig *rig, size_t j, double voltage)
{
    const design *design = &rig->run.analysis.design;
    double mean = 0;
    for (int i = 0; i < FAULT_RIG_PLAYS; i++) {
        const double slack =
            (design->upper[j] - design->lower[j]) / 2 * (i + 1) / (2 * FAULT_RIG_PLAYS);
        double *play = &rig->play[j * FAULT_RIG_PLAYS + (size_t)i];
        *play = fmin(fmax(*play, voltage - slack), voltage + slack);
        mean += *play / FAULT_RIG_PLAYS;
    }
    return voltage + rig->hysteresis * 16 / 5 * (mean - voltage);
}

pzs_status fault_rig_tick(fault_rig *rig)
{
    const size_t all = rig->run.analysis.design.structure.input.count;
    double next[FAULT_RIG_INPUTS];
    pzs_status status = PZS_OK;
    if (rig->tick >= rig->next_jump)
        fault_rig_jump(rig);
    for (size_t i = 0; i < rig->sensors; i++) {
        const size_t row = rig->sensor_row[i];
        inertia_observe(&rig->inertia, row, 1, &rig->readings[i]);
        for (size_t j = 0; j < rig->inputs; j++)
            rig->readings[i] +=
                rig->gain * rig->run.analysis.influence[row * all + j] * rig->sum[j];
        rig->readings[i] += rig->noise * random_noise(&rig->random);
    }
    if (rig->tick > 0 && fault_rig_uniform(rig, 0, 1) < rig->missed)
        (void)pzs_loop_skip(&rig->loop, 1);
    else
        status = pzs_loop_tick(&rig->loop, rig->wanted, rig->readings);
    for (size_t j = 0; j < rig->inputs; j++) {
        const double sign = rig->fault[j] == PZS_FAULT_REVERSED ? -1 : 1;
        if (rig->fault[j] == PZS_FAULT_DEAD)
            next[j] = 0;
        else if (rig->fault[j] == PZS_FAULT_STUCK)
            next[j] = rig->acting[j];
        else
            next[j] = act(rig, j, sign * rig->loop.info.voltage[j]);
    }
    memcpy(rig->acting, next, rig->inputs * sizeof *next);
    for (size_t j = 0; j < rig->inputs; j++)
        rig->sum[j] = rig->acting[j] + rig->load[j];
    inertia_jump(&rig->inertia, rig->sum);
    inertia_advance(&rig->inertia, 1 / rig->run.analysis.design.control.rate);
    rig->tick++;
    return status;
}

void fault_rig_run(fault_rig *rig, int ticks, int every)
{
    rig->every = every > 0 ? every : rig->every;
    rig->next_jump = every > 0 ? rig->tick : INT_MAX;
    for (int tick = 0; tick < ticks; tick++)
        (void)fault_rig_tick(rig);
}

const pzs_pulse_detector *fault_rig_detector(const fault_rig *rig)
{
    return pzs_loop_find(&rig->loop, &pzs_pulse_detector_block);
}

bool fault_rig_is_held(const fault_rig *rig, size_t j)
{
    return rig->loop.info.electrode[j] == PZS_ELECTRODE_HELD;
}

bool fault_rig_is_stopped(const fault_rig *rig)
{
    const pzs_supervisor *supervisor = pzs_loop_find(&rig->loop, &pzs_supervisor_block);
    return supervisor->info.mode == PZS_MODE_STOPPING || supervisor->info.mode == PZS_MODE_LATCHED;
}

void fault_rig_release(fault_rig *rig)
{
    for (size_t j = 0; j < rig->inputs; j++)
        if (fault_rig_is_held(rig, j))
            (void)pzs_release(rig->loop.info.control, (uint16_t)j);
}
