/*
 * Measurements of a control loop on a modal plant: storms (simulations in which targets jump faster
 * than the voltages can follow), steps of target and load, an impulse, a moving target. Each starts
 * or ends with the loop of damped_loop.h in static equilibrium.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef LOOP_TESTS_H
#define LOOP_TESTS_H

#include "damped_loop.h"

/* Number of ticks of one period of the first mode, rounded down. */
int loop_period(const modal_structure *structure, double interval);

/*
 * Set one of the targets of a storm at random: the goal, its opposite, or a shape of voltages of up
 * to twice the limits.
 *   seed             in/out  state of the random numbers
 *   wanted [outputs] out     target (m)
 */
void loop_throw_target(const modal_structure *structure, unsigned *seed, double *wanted);

/*
 * Run one storm: ten targets, one every 0.6 periods of the first mode, then the goal. Returns the
 * largest distance from the bounded optimum of the plant in the last period, relative to the goal.
 *   error in  differences between the plant and its model
 *   seed  in  seed of the random targets
 *   rest  in  number of ticks with the goal as target
 */
double loop_storm(damped_loop *loop, plant_error error, unsigned seed, int rest);

#define LOOP_SEED 3u /* seed of the storms' targets, unless another one is asked for */

enum { LOOP_PLANTS = 5 }; /* number of plants on which each loop has its storms */

/* Storms of one or several loops. A storm fails that does not end within 5 % of the goal. */
typedef struct storm_tally {
    int storms, failed;
    double worst; /* largest end of a storm: distance from the optimum, relative to the goal */
} storm_tally;

/*
 * Add the storms of a loop on five plants, the model and four with gains of 0.8 and 1.33 and
 * frequencies of 0.9 and 1.1 of the model's, with 12 periods of rest (at least 1200 ticks, at most
 * 1500).
 *   delay  in      age of the readings on the plants (ticks)
 *   enough in      number of failed storms in the tally after which no more storms are run
 *   tally  in/out  storms of this loop and of others before
 */
void loop_storms(damped_loop *loop, int delay, unsigned seed, int enough, storm_tally *tally);

/*
 * Run the loop with a target from its present state. Returns the number of ticks until the distance
 * from the bounded optimum stays below 5 % of the goal; `ticks` or less.
 *   wanted [outputs] in  target (m)
 *   ticks            in  length of the run
 */
int loop_settle(damped_loop *loop, const double *wanted, int ticks);

/* Factor of the structure's load whose static shape has 0.3 times the norm of the goal. */
double loop_moderate_load(const modal_structure *structure);

/*
 * Number of ticks until 5 % of the effect of a load are left that appears at once on the loop at
 * rest, with no target; `ticks`, the length of the run, or less.
 */
int loop_load_step(damped_loop *loop, int ticks);

/*
 * Number of ticks until 5 % of the vibration of the first mode after an impulse are left, with no
 * target; `ticks`, the length of the run, or less.
 */
int loop_impulse(damped_loop *loop, int ticks);

/*
 * Number of ticks until 5 % of a vibration of the first mode are left by the structure's own
 * damping, under constant voltages.
 */
int loop_undamped_ticks(const modal_structure *structure, double interval);

/*
 * RMS distance from a target that moves as a sine of `periods` periods of the first mode, with half
 * the goal as amplitude, over the RMS of the target; after the first of three periods of the sine.
 */
double loop_tracking_error(damped_loop *loop, double periods);

/*
 * RMS voltage, over the voltage limit, that noise of the sensors causes, of about 0.001 times the
 * largest entry of the goal, with no target.
 */
double loop_noise(damped_loop *loop);

#endif
