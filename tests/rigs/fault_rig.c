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
#include "ceramic_sweep.h"
#include "../../host_tools/simulate/random.h"

enum { MODES = 20 };

/*
 * Write the changes of a scene that make its loop compensate hysteresis.
 *   width in  width of the hysteresis loop relative to the voltage range
 *   limit in  largest voltage of each electrode, in both directions (V)
 */
static int write_hysteresis(char *change, size_t bytes, double width, double limit)
{
    const double share = width * 16 / 5, slope = 1 - share, weight = share / DAMPED_PLANT_PLAYS;
    const double slack = limit / (2 * DAMPED_PLANT_PLAYS);
    return snprintf(change, bytes,
                    "hysteresis={range: [%g, %g], slopes: [%g, %g, %g, %g], slack: [%g, %g, %g, "
                    "%g], above: [%g, %g, %g, %g]};",
                    -limit, limit, slope, slope, slope, slope, slack, 2 * slack, 3 * slack,
                    4 * slack, weight, weight, weight, weight);
}

/*
 * Write the changes of a scene that make its loop compensate the hysteresis and creep that a sweep
 * of a ceramic shows, at 1 kHz. Returns 0, or -1 with error filled.
 */
static int write_identified(char *change, size_t bytes, const test_ceramic *resting, char *error)
{
    enum { PLAYS = 8 };
    const double interval = 1e-3;
    static ceramic_sweep record;
    static test_ceramic swept;
    identification found;
    swept = *resting;
    ceramic_sweep_measure(&record, &swept, interval, 1);
    if (identify(&found, &record.sweep, PLAYS, 1, error) < 0)
        return -1;
    ceramic_sweep_section(&found.hysteresis, change, bytes);
    return 0;
}

/* Write all changes of the scene of a structure. Returns 0, or -1 with error filled. */
static int write_changes(char *change, size_t bytes, const fault_structure *structure,
                         double compensated, const test_ceramic *resting, char *error)
{
    int used = snprintf(change, bytes, "%s", structure->changes);
    if (*structure->readings)
        used += snprintf(change + used, bytes - (size_t)used,
                         "estimate={readings: [%s], tolerance: 0.9};", structure->readings);
    if (resting)
        return write_identified(change + used, bytes - (size_t)used, resting, error);
    if (compensated > 0)
        (void)write_hysteresis(change + used, bytes - (size_t)used, compensated, structure->limit);
    return 0;
}

/* Make a ceramic at rest. Returns whether there is memory for it. */
static bool open_ceramic(fault_rig *rig, const fault_structure *structure,
                         const fault_ceramic *ceramic)
{
    rig->resting = calloc(1, sizeof *rig->resting);
    if (!rig->resting)
        return false;
    open_test_ceramic(rig->resting, ceramic->family, structure->limit, ceramic->width,
                      ceramic->creep);
    rig->rest = ceramic_act(rig->resting, 0, 0);
    return true;
}

int fault_rig_open(fault_rig *rig, const fault_structure *structure, double compensated,
                   const fault_ceramic *ceramic)
{
    char change[20000];
    damped_plant *plant = &rig->plant;
    memset(rig, 0, sizeof *rig);
    if (ceramic && !open_ceramic(rig, structure, ceramic))
        return damped_plant_complain(plant, "out of memory");
    if (write_changes(change, sizeof change, structure, compensated, rig->resting,
                      plant->run.error) < 0)
        return damped_plant_complain(plant, plant->run.error);
    if (damped_plant_open_loop(plant, structure->scene, change) < 0 ||
        damped_plant_open_structure(plant, &plant->run.analysis, MODES) < 0)
        return -1;
    if (plant->inputs > FAULT_RIG_INPUTS)
        return damped_plant_complain(plant, "too many inputs");
    rig->load = calloc(plant->inputs, sizeof *rig->load);
    rig->sum = calloc(plant->all, sizeof *rig->sum);
    rig->readings = calloc(plant->sensors, sizeof *rig->readings);
    rig->ceramic = ceramic ? calloc(plant->inputs, sizeof *rig->ceramic) : NULL;
    const bool has_memory = rig->load && rig->sum && rig->readings && (rig->ceramic || !ceramic);
    return has_memory ? 0 : damped_plant_complain(plant, "out of memory");
}

void fault_rig_close(fault_rig *rig)
{
    free(rig->load);
    free(rig->sum);
    free(rig->readings);
    free(rig->resting);
    free(rig->ceramic);
    damped_plant_close(&rig->plant);
}

void fault_rig_start(fault_rig *rig, uint64_t seed, double gain, double frequency,
                     double hysteresis, int every)
{
    damped_plant_start(&rig->plant, gain, frequency, hysteresis);
    memset(rig->load, 0, rig->plant.inputs * sizeof *rig->load);
    memset(rig->sum, 0, rig->plant.all * sizeof *rig->sum);
    memset(rig->fault, 0, sizeof rig->fault);
    for (size_t j = 0; j < rig->plant.inputs && rig->ceramic; j++)
        rig->ceramic[j] = *rig->resting;
    rig->every = every;
    rig->next_jump = 0;
    rig->plant.random = seed;
}

void fault_rig_jump(fault_rig *rig)
{
    damped_plant *plant = &rig->plant;
    rig->next_jump =
        plant->tick + (int)damped_plant_uniform(plant, 0.5 * rig->every, 1.5 * rig->every);
    damped_plant_aim(plant, damped_plant_uniform(plant, -1, 1), 0.5);
}

static void read_sensors(fault_rig *rig)
{
    damped_plant *plant = &rig->plant;
    for (size_t i = 0; i < plant->sensors; i++)
        rig->readings[i] = damped_plant_observe(plant, plant->sensor_row[i], rig->sum) +
                           rig->noise * random_noise(&plant->random);
}

/* Set the voltage of the ceramic of electrode j, which may be faulty. */
static void give_voltage(fault_rig *rig, size_t j)
{
    const double voltage = rig->plant.loop.info.voltage[j];
    switch (rig->fault[j]) {
    case PZS_FAULT_NONE: rig->given[j] = voltage; break;
    case PZS_FAULT_DEAD: rig->given[j] = 0; break;
    case PZS_FAULT_STUCK: break;
    case PZS_FAULT_REVERSED: rig->given[j] = -voltage; break;
    }
}

/*
 * Effect of electrode j (V). The ceramic of a dead or stuck electrode creeps on; plays do not
 * creep, and a dead electrode with plays has no effect.
 */
static double effect_of(fault_rig *rig, size_t j)
{
    damped_plant *plant = &rig->plant;
    const double interval = 1 / plant->run.analysis.design.control.rate;
    if (rig->ceramic)
        return ceramic_act(&rig->ceramic[j], rig->given[j], interval) - rig->rest;
    if (rig->fault[j] == PZS_FAULT_DEAD)
        return 0;
    return damped_plant_act(plant, j, rig->given[j]);
}

/* Let the voltages of the loop act on the electrodes, some of which are faulty. */
static void actuate(fault_rig *rig)
{
    damped_plant *plant = &rig->plant;
    for (size_t j = 0; j < plant->inputs; j++) {
        give_voltage(rig, j);
        plant->acting[j] = effect_of(rig, j);
        rig->sum[j] = plant->acting[j] + rig->load[j];
    }
}

pzs_status fault_rig_tick(fault_rig *rig)
{
    damped_plant *plant = &rig->plant;
    pzs_status status = PZS_OK;
    if (plant->tick >= rig->next_jump)
        fault_rig_jump(rig);
    read_sensors(rig);
    if (plant->tick > 0 && damped_plant_uniform(plant, 0, 1) < rig->missed)
        (void)pzs_loop_skip(&plant->loop, 1);
    else
        status = pzs_loop_tick(&plant->loop, plant->wanted, rig->readings);
    actuate(rig);
    damped_plant_advance(plant, rig->sum);
    return status;
}

void fault_rig_run(fault_rig *rig, int ticks, int every)
{
    rig->every = every > 0 ? every : rig->every;
    rig->next_jump = every > 0 ? rig->plant.tick : INT_MAX;
    for (int tick = 0; tick < ticks; tick++)
        (void)fault_rig_tick(rig);
}

const pzs_pulse_detector *fault_rig_detector(const fault_rig *rig)
{
    return pzs_loop_find(&rig->plant.loop, &pzs_pulse_detector_block);
}

bool fault_rig_is_held(const fault_rig *rig, size_t j)
{
    return rig->plant.loop.info.electrode[j] == PZS_ELECTRODE_HELD;
}

void fault_rig_release(fault_rig *rig)
{
    for (size_t j = 0; j < rig->plant.inputs; j++)
        if (fault_rig_is_held(rig, j))
            (void)pzs_release(rig->plant.loop.info.control, (uint16_t)j);
}
