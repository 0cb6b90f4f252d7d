/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Control laws for comparison with the library's step: step blocks for a list of blocks
 * (pzs_loop.h). All keep the voltage limits and the step limits by clipping; an amplifier that is
 * held has no step limit, because its voltage is set at once.
 */
#ifndef LAWS_H
#define LAWS_H

#include "../model/unconstrained.h"
#include "pzs_loop.h"

/* Tables of a step block for comparison; one for each loop, because it holds the block's memory. */
typedef struct law {
    pzs_problem problem; /* the library requires the problem first */
    unconstrained solver;
    double gain, leak;   /* of the leaky integrator */
    double *memory;      /* memory of the vectors below */
    double *disturbance; /* [outputs] measured minus predicted shape, as last known (m) */
    double *required;    /* [outputs] displacements that the voltages have to produce (m) */
    double *next;        /* [inputs] voltages before clipping (V) */
} law;

/*
 * Prepare a law for a problem, which is copied. `regularisation` (m2/V2) is added to that of the
 * problem. Returns whether memory sufficed; call law_close in either case. The law must not be
 * moved afterwards.
 */
bool law_open(law *law, const pzs_problem *problem, double regularisation);
void law_close(law *law);

/* Least squares for target minus disturbance, then clipped: the disturbance is the last one. */
extern const pzs_block_type law_clipped_block;

/*
 * Leaky integrator of adaptive optics: v := (1 - leak) v + gain (least-squares voltages of target
 * minus measured shape), then clipped.
 */
extern const pzs_block_type law_leaky_block;

/* Voltage nearest to `to` whose change stays within a step limit without any rounding tolerance. */
double law_limited(double from, double to, double step_limit);

/* Whether a step limit allows a change of voltage, without any rounding tolerance. */
bool law_may_move(double from, double to, double step_limit);

#endif
