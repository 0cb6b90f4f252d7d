/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * One tick of a storm, a simulation of a control loop on a structure with mass: readings, voltages,
 * motion of the structure (storm_state.h).
 */
#include <string.h>
#include "random.h"
#include "storm_state.h"

/*
 * Return the address of the vector of a tick in a ring buffer, which holds one vector, such as the
 * sensor readings, for each of the last ticks. Ticks before the start have the vector of the start.
 *   length in  number of entries of a vector
 */
static double *ring_entry(const storm *storm, double *ring, int tick, size_t length)
{
    return ring + (size_t)((tick > 0 ? tick : 0) % storm->history_ticks) * length;
}

void storm_observe_vibration(storm *storm)
{
    if (!storm->has_vibration)
        tick_matrix_multiply(&storm->rig->vibration_shape, storm->inertia.deviation, storm->part);
    storm->has_vibration = true;
}

void storm_compute_shape(storm *storm)
{
    const storm_rig *rig = storm->rig;
    if (storm->has_shape)
        return;
    storm->has_shape = true;
    tick_matrix_multiply(&rig->static_shape, storm->acting, storm->shape);
    storm_observe_vibration(storm);
    for (size_t i = 0; i < rig->targets; i++)
        storm->shape[i] =
            storm->shape[i] * storm->plant->gain + (storm->part[i] + storm_offset(storm, i));
}

/*
 * Compute the present noise-free readings of the sensors, and store them until the control loop
 * receives them some ticks later.
 */
static void store_readings(storm *storm)
{
    const storm_rig *rig = storm->rig;
    double *reading = ring_entry(storm, storm->reading, storm->tick, rig->sensors);
    if (!rig->estimator) {
        storm_compute_shape(storm);
        memcpy(reading, storm->shape, rig->sensors * sizeof *reading);
        return;
    }
    tick_matrix_multiply(&rig->static_reading, storm->acting, reading);
    tick_matrix_multiply(&rig->vibration_reading, storm->inertia.deviation, storm->vibrating);
    for (size_t i = 0; i < rig->sensors; i++)
        reading[i] = reading[i] * storm->plant->gain +
                     (storm->vibrating[i] + storm_offset(storm, rig->row[i]));
}

/*
 * Compute the readings that the control loop receives in the present tick: those of some ticks
 * before, with noise.
 */
static void sense_readings(storm *storm)
{
    const storm_rig *rig = storm->rig;
    const double *shown = ring_entry(
        storm, storm->reading, storm->tick - rig->delay - storm->plant->more_delay, rig->sensors);
    for (size_t i = 0; i < rig->sensors; i++)
        storm->sensed[i] =
            shown[i] + (storm->noise > 0 ? storm->noise * random_noise(&storm->random) : 0);
    if (storm->wrong >= 0)
        storm->sensed[storm->wrong] = storm->wrong_value;
}

/*
 * Decide by a random number whether the present tick is missed, with the probability that the
 * simulation states.
 */
static bool misses(storm *storm)
{
    return storm->plant->missed_share > 0 &&
           random_uniform(&storm->random) < storm->plant->missed_share;
}

/*
 * Inform the control loop of missed ticks, and let it compute the voltages of the present tick.
 * Returns the status of the control loop.
 */
static pzs_status choose_voltages(storm *storm)
{
    if (storm->missed_ticks > 0 && !storm->plant->is_uninformed)
        (void)pzs_loop_skip(&storm->loop, (uint32_t)storm->missed_ticks);
    storm->missed_ticks = 0;
    return pzs_loop_tick(&storm->loop, storm->target, storm->sensed);
}

pzs_status storm_tick(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const bool is_missed = misses(storm);
    store_readings(storm);
    sense_readings(storm);
    memcpy(storm->previous_voltage, storm->voltage, amplifiers * sizeof *storm->voltage);
    const pzs_status status = is_missed ? PZS_OK : choose_voltages(storm);
    storm->missed_ticks += is_missed;
    memcpy(storm->voltage, storm->loop.info.voltage, amplifiers * sizeof *storm->voltage);
    storm_advance_ceramic(storm);
    inertia_jump(&storm->inertia, storm->acting);
    inertia_advance(&storm->inertia, storm->rig->interval);
    storm->has_vibration = storm->has_shape = false;
    storm->tick++;
    return status;
}
