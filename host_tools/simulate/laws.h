/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Control laws for comparison with the library's control step. Each is a step block (pzs_loop.h),
 * the stage of a control tick that computes the voltages. All laws clip to the voltage limits and
 * step limits. An amplifier held at one voltage has no step limit and jumps to it at once.
 */
#ifndef LAWS_H
#define LAWS_H

#include "../model/unconstrained.h"
#include "pzs_loop.h"

/*
 * Tables of a control law for comparison, such as clipped least squares, which computes the
 * voltages as a stage (pzs_block) of the control tick. Each loop needs its own tables, because they
 * contain the memory of the block.
 */
typedef struct law {
    pzs_problem problem; /* least-squares problem for the voltages; must stay the first member, as
                            the library casts a pointer to this struct to one to the problem */
    pzs_problem regularised; /* the same problem with the regularisation of the law added */
    unconstrained solver;    /* solver of the problem `regularised` */
    double gain, leak; /* leaky integrator: gain, the factor of the least-squares voltages for the
                          present error of the shape, and leak, the part of the voltages that a tick
                          removes (dimensionless) */
    double share;   /* clipped least squares: part of the way to the least-squares voltages that a
                       tick goes, 1 by default */
    double *memory; /* one allocation that holds the arrays disturbance, required and next of this
                       struct */
    double *disturbance; /* [outputs] last known difference between the measured and the predicted
                            shape (m) */
    double *required;    /* [outputs] displacements that the voltages have to produce (m) */
    double *next; /* [inputs] voltages of the control law before they are clipped to the limits (V)
                   */
} law;

/*
 * Prepare a control law for comparison. The voltage optimisation problem is copied, and
 * `regularisation` (m2/V2) is added to that of the copy. The struct must not be moved in memory
 * until law_close. law_open returns whether memory sufficed; call law_close in either case.
 */
bool law_open(law *law, const pzs_problem *problem, double regularisation);
void law_close(law *law);

/*
 * Clip the voltages `next` of a control law for comparison to voltage limits and step limits, and
 * copy them into the library's controller. Where actuators have curves, these are effects: values
 * to which the displacements of the actuators are proportional.
 */
void law_set_voltages(const law *law, const pzs_loop_signals *signals);

/*
 * Block of a control tick for clipped least squares: least-squares voltages without limits for
 * (target - last measured disturbance), or the part `share` of the way to them, then clipped to
 * their limits.
 */
extern const pzs_block_type law_clipped_block;

/*
 * Block of a control tick for the leaky integrator of adaptive optics. The new voltages are (1 -
 * leak) times the old ones plus gain times the least-squares voltages for (target - measured
 * shape). They are then clipped to the limits.
 */
extern const pzs_block_type law_leaky_block;

#endif
