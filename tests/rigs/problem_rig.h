/*
 * A voltage optimisation problem with arrays of its own, and the start of a control loop in a
 * workspace of exactly the size that the loop asks for. The test states the size of its largest
 * problem as constants MOST_INPUTS and MOST_OUTPUTS before it includes this header, and includes
 * cmocka.h before.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef PROBLEM_RIG_H
#define PROBLEM_RIG_H

#include "pzs.h"
#include <stdlib.h>
#include "uniform.h"

/* Scene number of all tables of a test; the library refuses tables of different scenes. */
enum { SCENE = 41 };

typedef struct problem_rig {
    pzs_problem tables;                             /* the problem, which refers to the arrays */
    pzs_real influence[MOST_OUTPUTS * MOST_INPUTS]; /* [outputs][inputs] influence matrix (m/V) */
    pzs_real weight[MOST_OUTPUTS]; /* [outputs] weight of each output in the error of the shape */
    pzs_real lower[MOST_INPUTS], upper[MOST_INPUTS]; /* [inputs] voltage limits (V) */
    pzs_real step_limit[MOST_INPUTS]; /* [inputs] largest change of a voltage in a tick (V) */
    pzs_real reference_voltage[MOST_INPUTS]; /* [inputs] voltages of the regularisation (V) */
} problem_rig;

/* Set all numbers of an array to one value. */
static inline void fill_reals(pzs_real *to, size_t count, double value)
{
    for (size_t i = 0; i < count; i++)
        to[i] = (pzs_real)value;
}

/* Fill an array with random numbers between -size and size. */
static inline void fill_random(unsigned *seed, pzs_real *to, size_t count, double size)
{
    for (size_t i = 0; i < count; i++)
        to[i] = (pzs_real)uniform(seed, -size, size);
}

/*
 * Write the size of a problem and the addresses of the rig's arrays into the problem. The arrays,
 * and the other members of the problem, stay as they are.
 */
static inline void problem_connect(problem_rig *rig, unsigned inputs, unsigned outputs)
{
    pzs_problem *problem = &rig->tables;
    problem->scene = SCENE;
    problem->inputs = (uint16_t)inputs;
    problem->outputs = (uint16_t)outputs;
    problem->influence = rig->influence;
    problem->weight = rig->weight;
    problem->lower = rig->lower;
    problem->upper = rig->upper;
    problem->step_limit = rig->step_limit;
    problem->reference_voltage = rig->reference_voltage;
}

/*
 * Make a problem whose weights are 1 and whose inputs have equal voltage limits and step limits
 * (V). The caller fills the influence matrix and computes the checksum by problem_seal.
 */
static inline void problem_open(problem_rig *rig, unsigned inputs, unsigned outputs, double lower,
                                double upper, double step_limit)
{
    problem_connect(rig, inputs, outputs);
    fill_reals(rig->weight, outputs, 1);
    fill_reals(rig->lower, inputs, lower);
    fill_reals(rig->upper, inputs, upper);
    fill_reals(rig->step_limit, inputs, step_limit);
}

/* Write the checksum of a problem, after each change of its arrays. */
static inline void problem_seal(problem_rig *rig)
{
    assert_int_equal(pzs_problem_seal(&rig->tables), PZS_OK);
}

/*
 * Start a loop of `count` blocks in a new workspace of exactly the bytes that the loop asks for.
 *   work in/out  earlier workspace, which is released, or NULL; new workspace
 */
static inline pzs_status start_loop(pzs_loop *loop, const pzs_block *block, size_t count,
                                    void **work)
{
    pzs_real none;
    const pzs_status status = pzs_loop_init(loop, block, count, NULL, &none, 0);
    if (status != PZS_E_WORKSPACE)
        return status;
    const size_t bytes = (size_t)loop->info.where;
    free(*work);
    *work = malloc(bytes);
    assert_non_null(*work);
    return pzs_loop_init(loop, block, count, NULL, *work, bytes);
}

/* Memory and start of a block of a test whose only data are its tables. */
static inline size_t no_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    (void)problem;
    return 0;
}

static inline pzs_status no_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    (void)self;
    (void)tables;
    (void)signals;
    return PZS_OK;
}

#endif
