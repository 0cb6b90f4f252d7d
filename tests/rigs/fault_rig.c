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

int fault_rig_open(fault_rig *rig, const fault_structure *structure, double compensated)
{
    char change[20000];
    damped_plant *plant = &rig->plant;
    memset(rig, 0, sizeof *rig);
    write_changes(change, sizeof change, structure, compensated);
    if (damped_plant_open_loop(plant, structure->scene, change) < 0 ||
        damped_plant_open_structure(plant, &plant->run.analysis, MODES) < 0)
        return -1;
    if (plant->inputs > FAULT_RIG_INPUTS)
        return damped_plant_complain(plant, "too many inputs");
    rig->load = calloc(plant->inputs, sizeof *rig->load);
    rig->sum = calloc(plant->all, sizeof *rig->sum);
    rig->readings = calloc(plant->sensors, sizeof *rig->readings);
    const bool has_memory = rig->load && rig->sum && rig->readings;
    return has_memory ? 0 : damped_plant_complain(plant, "out of memory");
}

void fault_rig_close(fault_rig *rig)
{
    free(rig->load);
    free(rig->sum);
    free(rig->readings);
    damped_plant_close(&rig->plant);
}

void fault_rig_start(fault_rig *rig, uint64_t seed, double gain, double frequency,
                     double hysteresis, int every)
{
    damped_plant_start(&rig->plant, gain, frequency, hysteresis);
    memset(rig->load, 0, rig->plant.inputs * sizeof *rig->load);
    memset(rig->sum, 0, rig->plant.all * sizeof *rig->sum);
    memset(rig->fault, 0, sizeof rig->fault);
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

/* Let the voltages of the loop act on the electrodes, some of which are faulty. */
static void actuate(fault_rig *rig)
{
    damped_plant *plant = &rig->plant;
    for (size_t j = 0; j < plant->inputs; j++) {
        const double sign = rig->fault[j] == PZS_FAULT_REVERSED ? -1 : 1;
        if (rig->fault[j] == PZS_FAULT_DEAD)
            plant->acting[j] = 0;
        else if (rig->fault[j] != PZS_FAULT_STUCK)
            plant->acting[j] = damped_plant_act(plant, j, sign * plant->loop.info.voltage[j]);
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
