/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Linear quadratic Gaussian control: the vibration damper's Kalman filter with feedback of the
 * estimated state. State x of the regulator, as deviations from the static optimum: positions and
 * velocities (over angular frequency) of the modes, and voltages v; input: voltage changes u. Cost:
 *   sum over ticks of |shape|^2 + regularisation |v|^2 + weight |u|^2,  shape = C q + Y v,
 * with the mode shapes C, the positions q, and the static shape Y of the modes left out. Because
 * the feedback gives changes of the voltages that were given last, clipping does not wind it up.
 * With a governor the static optimum moves with reference voltages, whose moves are added.
 */
#include "rival_lqg.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/dense.h"
#include "../../host_tools/model/riccati.h"

/*
 * Transition matrix a [states][states] of the state, and input matrix b [states][inputs]: a voltage
 * change acts from the present tick on.
 */
static void fill_dynamics(const damped_loop *loop, double *a, double *b)
{
    const size_t modes = loop->modes, inputs = loop->problem.inputs, states = 2 * modes + inputs;
    for (size_t k = 0; k < modes; k++) {
        const double *turn = loop->gains.turn + k, *modal = loop->structure->modal + k * inputs;
        a[k * states + k] = turn[0];
        a[k * states + modes + k] = turn[modes];
        a[(modes + k) * states + k] = turn[2 * modes];
        a[(modes + k) * states + modes + k] = turn[3 * modes];
        for (size_t j = 0; j < inputs; j++) {
            b[k * inputs + j] = (1 - turn[0]) * modal[j];
            b[(modes + k) * inputs + j] = -turn[2 * modes] * modal[j];
        }
    }
    for (size_t j = 0; j < inputs; j++)
        b[(2 * modes + j) * inputs + j] = 1;
    for (size_t i = 0; i < states; i++)
        for (size_t j = 0; j < inputs; j++)
            a[i * states + 2 * modes + j] = b[i * inputs + j];
}

/* Cost [states][states] of the state. */
static void fill_cost(const damped_loop *loop, double *cost)
{
    const modal_structure *structure = loop->structure;
    const size_t modes = loop->modes, inputs = loop->problem.inputs, states = 2 * modes + inputs;
    double *row = calloc(states, sizeof *row);
    assert_non_null(row);
    for (size_t i = 0; i < structure->outputs; i++) {
        const double *shape = structure->shape + i * structure->modes;
        memcpy(row, shape, modes * sizeof *row);
        for (size_t j = 0; j < inputs; j++) {
            row[2 * modes + j] = structure->influence[i * inputs + j];
            for (size_t k = 0; k < modes; k++)
                row[2 * modes + j] -= shape[k] * loop->structure->modal[k * inputs + j];
        }
        for (size_t k = 0; k < states; k++)
            for (size_t j = 0; j < states; j++)
                cost[k * states + j] += row[k] * row[j];
    }
    for (size_t j = 2 * modes; j < states; j++)
        cost[j * states + j] += (double)loop->problem.regularisation;
    free(row);
}

/*
 * Feedback (weight + b' x b)^-1 b' x a [inputs][states] of the cost to go x.
 *   weight in  weight of the squared voltage changes
 */
static void fill_feedback(double *feedback, const double *x, const double *a, const double *b,
                          double weight, size_t inputs, size_t states)
{
    double *product =
               calloc(states * inputs + 2 * inputs * inputs + inputs * states, sizeof *product),
           *matrix = product + states * inputs, *inverse = matrix + inputs * inputs,
           *right = inverse + inputs * inputs;
    assert_non_null(product);
    for (size_t j = 0; j < inputs; j++) {
        matrix[j * inputs + j] = weight;
        for (size_t i = 0; i < states; i++)
            for (size_t k = 0; k < states; k++)
                product[i * inputs + j] += x[i * states + k] * b[k * inputs + j];
    }
    for (size_t i = 0; i < states; i++)
        for (size_t j = 0; j < inputs; j++) {
            for (size_t l = 0; l < inputs; l++)
                matrix[j * inputs + l] += b[i * inputs + j] * product[i * inputs + l];
            for (size_t k = 0; k < states; k++)
                right[j * states + k] += product[i * inputs + j] * a[i * states + k];
        }
    assert_int_equal(dense_invert(matrix, inverse, inputs), 0);
    memset(feedback, 0, inputs * states * sizeof *feedback);
    for (size_t j = 0; j < inputs; j++)
        for (size_t l = 0; l < inputs; l++)
            for (size_t k = 0; k < states; k++)
                feedback[j * states + k] += inverse[j * inputs + l] * right[l * states + k];
    free(product);
}

void lqg_open(rival *rival)
{
    const damped_loop *loop = &rival->loop;
    const size_t inputs = loop->problem.inputs, states = 2 * loop->modes + inputs;
    double *a = calloc(states * (states + inputs), sizeof *a), *b = a + states * states;
    riccati riccati;
    assert_non_null(a);
    assert_int_equal(riccati_open(&riccati, states), 0);
    const double weight = rival->settings.weight * rival_scale(rival);
    fill_dynamics(loop, a, b);
    fill_cost(loop, riccati.h);
    memcpy(riccati.a, a, states * states * sizeof *a);
    for (size_t i = 0; i < states; i++)
        for (size_t k = 0; k < states; k++)
            for (size_t j = 0; j < inputs; j++)
                riccati.g[i * states + k] += b[i * inputs + j] * b[k * inputs + j] / weight;
    assert_int_equal(riccati_solve(&riccati), 0);
    fill_feedback(rival->feedback, riccati.h, a, b, weight, inputs, states);
    riccati_close(&riccati);
    free(a);
}

/*
 * Set the deviations of the state from the static optimum.
 *   optimum [inputs] in  voltages of the static optimum
 */
static void fill_state(rival *rival, const double *optimum, const double *voltage)
{
    const size_t modes = rival->loop.modes, inputs = rival->loop.problem.inputs;
    const pzs_damper_info *info = rival_estimates(rival);
    for (size_t k = 0; k < modes; k++) {
        double rest = info->load[k];
        for (size_t j = 0; j < inputs; j++)
            rest += rival->loop.structure->modal[k * inputs + j] * optimum[j];
        rival->state[k] = info->position[k] - rest;
        rival->state[modes + k] = info->velocity[k];
    }
    for (size_t j = 0; j < inputs; j++)
        rival->state[2 * modes + j] = voltage[j] - optimum[j];
}

void lqg_reset(rival *rival)
{
    memset(rival->reference, 0, rival->loop.problem.inputs * sizeof *rival->reference);
}

/*
 * Governor: factor by which the reference voltages approach the optimum of the target alone, so
 * that none moves by more than the part `governor` of its step limit.
 */
static double reference_step(rival *rival, const pzs_real *wanted)
{
    const size_t inputs = rival->loop.problem.inputs;
    double factor = 1;
    memcpy(rival->law.required, wanted, rival->law.problem.outputs * sizeof *wanted);
    memcpy(rival->aim, rival_solve_bounded(rival), inputs * sizeof *rival->aim);
    for (size_t j = 0; j < inputs; j++) {
        const double way = fabs(rival->aim[j] - rival->reference[j]),
                     most = rival->settings.governor * rival->loop.problem.step_limit[j];
        factor = way > most ? fmin(factor, most / way) : factor;
    }
    return factor;
}

/*
 * Change the static optimum, which is in `fixed`, to that of the reference, and let the reference
 * move; law.next: the move, which the voltages follow beside the feedback.
 */
static void govern(rival *rival, const pzs_real *wanted)
{
    const double factor = reference_step(rival, wanted);
    for (size_t j = 0; j < rival->loop.problem.inputs; j++) {
        const double way = rival->aim[j] - rival->reference[j];
        rival->fixed[j] -= way;
        rival->law.next[j] = factor * way;
        rival->reference[j] += factor * way;
    }
}

/* Set `fixed` to the static optimum for the target and the estimated disturbance. */
static void find_optimum(rival *rival, const pzs_loop_signals *signals)
{
    const double *optimum = rival->law.next;
    for (size_t i = 0; i < rival->law.problem.outputs; i++)
        rival->law.required[i] =
            signals->wanted[i] - (signals->measured[i] - signals->control->state.predicted[i]);
    if (rival->settings.kind == RIVAL_LQG)
        rival_solve(rival);
    else
        optimum = rival_solve_bounded(rival);
    memcpy(rival->fixed, optimum, rival->loop.problem.inputs * sizeof *rival->fixed);
}

void lqg_choose(rival *rival, const pzs_loop_signals *signals)
{
    const size_t inputs = rival->loop.problem.inputs, states = 2 * rival->loop.modes + inputs;
    const double *last = signals->control->info.voltage;
    find_optimum(rival, signals);
    memset(rival->law.next, 0, inputs * sizeof *rival->law.next);
    if (rival->settings.governor > 0)
        govern(rival, signals->wanted);
    fill_state(rival, rival->fixed, last);
    for (size_t j = 0; j < inputs; j++) {
        rival->law.next[j] += last[j];
        for (size_t k = 0; k < states; k++)
            rival->law.next[j] -= rival->feedback[j * states + k] * rival->state[k];
    }
}
