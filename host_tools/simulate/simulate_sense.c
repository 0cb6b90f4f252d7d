/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Inputs of the controller in a simulated closed loop: the sensors, the shape that is estimated
 * from their readings, and the known loads (simulate_loop.h).
 */
#include "simulate_loop.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- preparation of the sensors --------------------------------------- */

/* Set the standard deviation of the noise of every sensor from the scene file. */
static void take_noise(loop *loop)
{
    const simulation *simulation = loop->simulation;
    const design *design = loop->design;
    double *deviation = loop->noise;
    for (int i = 0; i < loop->sensors && !simulation->estimates; i++)
        deviation[i] = design->simulate.noise;
    for (int reading = 0; reading < design->estimate.readings && simulation->estimates; reading++)
        for (int i = 0;
             i < analysis_outputs(simulation->nominal, design->estimate.reading[reading].output);
             i++)
            *deviation++ = design->estimate.reading[reading].noise;
}

/*
 * Return the number of ticks whose readings must be stored because the controller may receive them
 * later.
 */
static int kept_ticks(const scene_simulate *simulate)
{
    int most = 0;
    for (int i = 0; i < simulate->events; i++)
        if (simulate->event[i].type == EVENT_DELAY && simulate->event[i].size > most)
            most = (int)simulate->event[i].size;
    return simulate->delay + most + 1;
}

int sense_open(loop *loop)
{
    const simulation *simulation = loop->simulation;
    const design *design = loop->design;
    loop->sensors = simulation->estimates ? simulation->estimator.sensors : design->targets;
    const size_t loads = (size_t)design->loads, k = (size_t)loop->sensors;
    loop->history_ticks = kept_ticks(&design->simulate);
    const size_t kept = (size_t)loop->history_ticks;
    double *at = loop->sense_memory = calloc((3 + kept) * k + (kept + 2) * loads + 1, sizeof *at);
    loop->sensor = calloc(k + 1, sizeof *loop->sensor);
    if (!at || !loop->sensor)
        return 0;
    double **const of_sensors[] = {&loop->noise, &loop->reading, &loop->sensed};
    for (int i = 0; i < 3; i++, at += k)
        *of_sensors[i] = at;
    loop->late_reading = at, at += kept * k;
    loop->late_load = at, at += kept * loads;
    loop->known_load = at, at += loads;
    loop->next_load = at;
    take_noise(loop);
    return 1;
}

void sense_close(loop *loop)
{
    free(loop->sense_memory);
    free(loop->sensor);
}

/* ---- sensor readings -------------------------------------------------- */

/*
 * Return the address of the vector that belongs to a tick in a ring buffer; the buffer holds one
 * vector, of readings or of load factors, for each of the last ticks.
 *   length in  number of entries of a vector
 */
static double *ring_entry(const loop *loop, double *history, int tick, int length)
{
    return history + (size_t)(tick % loop->history_ticks) * (size_t)length;
}

/*
 * Store the noise-free readings and the known load factors of a tick until the readings arrive at
 * the controller.
 */
static int store_tick(loop *loop, int tick, char *error)
{
    const design *design = loop->design;
    double *reading = ring_entry(loop, loop->late_reading, tick, loop->sensors);
    memcpy(ring_entry(loop, loop->late_load, tick, design->loads), loop->known_load,
           (size_t)design->loads * sizeof *loop->known_load);
    if (loop->simulation->estimates)
        return plant_readings(&loop->simulation->plant, reading, error);
    memcpy(reading, loop->shape, (size_t)loop->sensors * sizeof *reading);
    return 0;
}

/*
 * Compute the readings that the controller receives in a tick: those of `delay` ticks before, with
 * noise and faults of the sensors.
 */
static void read_sensors(loop *loop, int tick)
{
    const int delay = loop->design->simulate.delay, then = tick > delay ? tick - delay : 0;
    const int extra = tick < loop->delay.until ? (int)loop->delay.size : 0;
    const double *delayed =
        ring_entry(loop, loop->late_reading, then > extra ? then - extra : 0, loop->sensors);
    const imperfections wiring = loop_imperfections(loop);
    imperfections_read(&wiring, tick, loop->noise, delayed, loop->reading, loop->sensed);
}

int sense_tick(loop *loop, int tick, char *error)
{
    if (store_tick(loop, tick, error) < 0)
        return -1;
    read_sensors(loop, tick);
    return 0;
}

/* ---- measured shape --------------------------------------------------- */

const double *sense_known_loads(const loop *loop, int tick)
{
    const int delay = loop->design->simulate.delay;
    return ring_entry(loop, loop->late_load, tick > delay ? tick - delay : 0, loop->design->loads);
}

/*
 * Compute the measurement error of the simulated loop: weighted norm of the true minus the measured
 * shape, over that of the scene's target. The controller's measured shape leaves out displacements
 * by known loads; they are added here. Targets without a measurement contribute zero.
 */
void sense_measurement_error(loop *loop)
{
    const design *design = loop->design;
    const simulation *simulation = loop->simulation;
    for (int i = 0; i < design->targets; i++) {
        double left = loop->shape[i] - loop->controller.info.measured[i];
        for (int k = 0; k < design->loads && simulation->feeds; k++)
            left -=
                simulation->estimator.shape_per_load[i * design->loads + k] * loop->known_load[k];
        loop->scratch[i] = isnan(left) ? 0 : left;
    }
    loop->measurement_error =
        sqrt(design_squares(design, loop->scratch, NULL)) / simulation->reference;
}
