/*
 * A voltage optimisation problem with its own arrays and workspace, and a certificate in long
 * double, independent of the arithmetic of the library, of how far its voltages are from the
 * optimum. Include it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef CONTROL_BENCH_H
#define CONTROL_BENCH_H

#include "pzs.h"
#include <math.h>
#include <string.h>
#include "../../lib/core/guard.h"
#include "../../lib/control/control.h"

enum { MOST_INPUTS = 64, MOST_OUTPUTS = 160 };

#include "problem_rig.h"

#define TOLERANCE PZS_BY_BITS(1e-6L, 1e-12L) /* tolerance of the objective, relative to |W e|^2 */

typedef long double wide;

/* ---- a bench: one problem with its own arrays and workspace ------------------- */

typedef struct bench {
    uint64_t seed;
    problem_rig problem;
    pzs_control control;
    pzs_real error[MOST_OUTPUTS];
    /* voltages before the last step, and limits of the last step (V) */
    pzs_real last[MOST_INPUTS], lower_bound[MOST_INPUTS], upper_bound[MOST_INPUTS];
    double work[(PZS_CONTROL_BYTES(MOST_INPUTS, MOST_OUTPUTS) + 7) / 8];
} bench;

static uint64_t bits(bench *trial)
{
    uint64_t word = (trial->seed += 0x9E3779B97F4A7C15u);
    word = (word ^ (word >> 30)) * 0xBF58476D1CE4E5B9u;
    word = (word ^ (word >> 27)) * 0x94D049BB133111EBu;
    return word ^ (word >> 31);
}

static double draw(bench *trial, double lo, double hi)
{
    return lo + (hi - lo) * (double)(bits(trial) >> 11) * 0x1p-53;
}

static inline int chance(bench *trial, double probability)
{
    return draw(trial, 0, 1) < probability;
}

static unsigned below(bench *trial, unsigned count)
{
    return (unsigned)(bits(trial) % count);
}

static inline pzs_status start(bench *trial)
{
    pzs_problem *tables = &trial->problem.tables;
    const pzs_real *influence = tables->influence;
    problem_connect(&trial->problem, tables->inputs, tables->outputs);
    tables->influence = influence;
    tables->format = PZS_TABLE_FORMAT;
    tables->dual_method = PZS_DUAL_METHOD(tables->inputs);
    tables->crc = pzs_problem_crc(tables);
    return pzs_control_init(&trial->control, tables,
                            influence != NULL ? NULL : trial->problem.influence, trial->work,
                            sizeof trial->work);
}

/*
 * A problem with a full-rank influence matrix and limits +-limit, without step limits and
 * regularisation.
 */
static inline void plain(bench *trial, uint64_t seed, unsigned inputs, unsigned outputs,
                         double limit)
{
    memset(trial, 0, sizeof *trial);
    trial->seed = seed;
    problem_open(&trial->problem, inputs, outputs, -limit, limit, HUGE_VAL);
    for (unsigned i = 0; i < outputs * inputs; i++)
        trial->problem.influence[i] = (pzs_real)draw(trial, -1, 1);
    for (unsigned i = 0; i < outputs; i++)
        trial->error[i] = (pzs_real)draw(trial, -1, 1);
}

static wide energy(const bench *trial)
{
    wide sum = 0;
    for (unsigned i = 0; i < trial->problem.tables.outputs; i++)
        sum += (wide)trial->problem.weight[i] * trial->problem.weight[i] * trial->error[i] *
               trial->error[i];
    return sum;
}

/*
 * Objective |W (B v - e)|^2 + regularisation |v - reference voltage|^2 and half of its gradient, in
 * long double, from the influence matrix B itself.
 */
static wide objective(const bench *trial, const wide *voltage, wide *gradient)
{
    const unsigned inputs = trial->problem.tables.inputs;
    wide sum = 0;
    for (unsigned j = 0; j < inputs; j++) {
        const wide away = voltage[j] - (wide)trial->problem.reference_voltage[j];
        gradient[j] = (wide)trial->problem.tables.regularisation * away;
        sum += gradient[j] * away;
    }
    for (unsigned i = 0; i < trial->problem.tables.outputs; i++) {
        const wide weight = (wide)trial->problem.weight[i] * trial->problem.weight[i];
        wide miss = -(wide)trial->error[i];
        for (unsigned j = 0; j < inputs; j++)
            miss += (wide)trial->problem.influence[i * inputs + j] * voltage[j];
        sum += weight * miss * miss;
        for (unsigned j = 0; j < inputs; j++)
            gradient[j] += weight * miss * (wide)trial->problem.influence[i * inputs + j];
    }
    return sum;
}

static wide objective_at(const bench *trial, const pzs_real *voltage)
{
    wide v[MOST_INPUTS] = {0}, gradient[MOST_INPUTS];
    for (unsigned i = 0; i < trial->problem.tables.inputs; i++)
        v[i] = voltage[i];
    return objective(trial, v, gradient);
}

/* Relative error of the shape, |W (B v - e)| / |W e|. */
static inline wide shape_error_of(const bench *trial)
{
    wide voltage[MOST_INPUTS] = {0}, gradient[MOST_INPUTS], effort = 0;
    for (unsigned i = 0; i < trial->problem.tables.inputs; i++) {
        voltage[i] = trial->control.info.voltage[i];
        effort += (wide)trial->problem.tables.regularisation *
                  (voltage[i] - (wide)trial->problem.reference_voltage[i]) *
                  (voltage[i] - (wide)trial->problem.reference_voltage[i]);
    }
    return sqrtl((objective(trial, voltage, gradient) - effort) / energy(trial));
}

/* ---- limits -------------------------------------------------------------------- */

/* Compute the limits of the coming step from their definition. */
static void note_limits(bench *trial)
{
    for (unsigned i = 0; i < trial->problem.tables.inputs; i++) {
        const pzs_real last = trial->last[i] = trial->control.info.voltage[i];
        const pzs_real lo = last - trial->problem.step_limit[i],
                       hi = last + trial->problem.step_limit[i];
        trial->lower_bound[i] =
            lo > trial->control.info.lower[i] ? lo : trial->control.info.lower[i];
        trial->upper_bound[i] =
            hi < trial->control.info.upper[i] ? hi : trial->control.info.upper[i];
        if (trial->lower_bound[i] > trial->upper_bound[i])
            trial->lower_bound[i] = trial->upper_bound[i] = last < trial->control.info.lower[i]
                                                                ? trial->control.info.lower[i]
                                                                : trial->control.info.upper[i];
    }
}

static void assert_feasible(const bench *trial)
{
    for (unsigned i = 0; i < trial->problem.tables.inputs; i++) {
        const pzs_real voltage = trial->control.info.voltage[i],
                       change = voltage < trial->last[i] ? trial->last[i] - voltage
                                                         : voltage - trial->last[i];
        assert_true(voltage >= trial->control.info.lower[i] &&
                    voltage <= trial->control.info.upper[i]);
        assert_true(isfinite(voltage));
        if (change > trial->problem.step_limit[i]) /* allowed only where step limit and voltage
                                                    * limits do not overlap
                                                    */
            assert_true(trial->lower_bound[i] >= trial->upper_bound[i] &&
                        voltage >= trial->lower_bound[i] && voltage <= trial->upper_bound[i]);
    }
}

/* ---- certificate ----------------------------------------------------------------- */

static wide clip(wide number, wide lo, wide hi)
{
    const wide raised = number < lo ? lo : number;
    return raised > hi ? hi : raised;
}

/*
 * Upper bound of the distance from the optimum, by convexity: objective - optimum <= 2 max over the
 * box of gradient . (v - x). An unbounded box is cut at ten times the largest voltage.
 */
static wide gap_of(const bench *trial, const wide *voltage, const wide *gradient)
{
    wide gap = 0, most = 1;
    for (unsigned i = 0; i < trial->problem.tables.inputs; i++)
        most = fabsl(voltage[i]) > most ? fabsl(voltage[i]) : most;
    for (unsigned i = 0; i < trial->problem.tables.inputs; i++) {
        const wide room = gradient[i] > 0 ? voltage[i] - (wide)trial->lower_bound[i]
                                          : (wide)trial->upper_bound[i] - voltage[i];
        const wide way = room < 10 * most || isfinite(room) ? room : 10 * most;
        if (room > 0 && gradient[i] != 0)
            gap += 2 * fabsl(gradient[i]) * way;
    }
    return gap;
}

/*
 * Newton direction over the inputs marked free, by a dense L D L^T in long double. Linearly
 * dependent inputs do not move.
 */
static void newton(const bench *trial, const unsigned char *free, const wide *gradient, wide *way)
{
    static wide matrix[MOST_INPUTS][MOST_INPUTS], rest[MOST_INPUTS];
    const unsigned inputs = trial->problem.tables.inputs;
    unsigned char used[MOST_INPUTS] = {0};
    for (unsigned j = 0; j < inputs; j++) {
        rest[j] = -gradient[j];
        for (unsigned k = 0; k <= j; k++) {
            matrix[j][k] = j == k ? (wide)trial->problem.tables.regularisation : 0;
            for (unsigned i = 0; free[j] && free[k] && i < trial->problem.tables.outputs; i++)
                matrix[j][k] += (wide)trial->problem.weight[i] * trial->problem.weight[i] *
                                trial->problem.influence[i * inputs + j] *
                                trial->problem.influence[i * inputs + k];
        }
    }
    for (unsigned k = 0; k < inputs; k++) {
        const wide diagonal = matrix[k][k];
        wide pivot = diagonal;
        for (unsigned j = 0; j < k; j++)
            pivot -= used[j] ? matrix[k][j] * matrix[k][j] * matrix[j][j] : 0;
        used[k] = free[k] && pivot > 1e-16L * diagonal;
        matrix[k][k] = pivot;
        for (unsigned i = k + 1; used[k] && i < inputs; i++) {
            for (unsigned j = 0; j < k; j++)
                matrix[i][k] -= used[j] ? matrix[i][j] * matrix[j][j] * matrix[k][j] : 0;
            matrix[i][k] /= pivot;
            rest[i] -= matrix[i][k] * rest[k];
        }
    }
    for (unsigned k = inputs; k-- > 0;) {
        way[k] = used[k] ? rest[k] / matrix[k][k] : 0;
        for (unsigned i = k + 1; used[k] && i < inputs; i++)
            way[k] -= used[i] ? matrix[i][k] * way[i] : 0;
    }
}

/* Part (0 to 1) of a way that the limits allow, and the first input to meet its limit, or n. */
static wide free_part(const bench *trial, const wide *voltage, const wide *way, unsigned *first)
{
    wide part = 1;
    *first = trial->problem.tables.inputs;
    for (unsigned i = 0; i < trial->problem.tables.inputs; i++) {
        const wide room = way[i] < 0 ? voltage[i] - (wide)trial->lower_bound[i]
                                     : (wide)trial->upper_bound[i] - voltage[i];
        if (room < part * fabsl(way[i])) {
            part = room > 0 ? room / fabsl(way[i]) : 0;
            *first = i;
        }
    }
    return part;
}

/*
 * One exact step of the reference solution: free are the inputs that the gradient may move, except
 * those that cannot follow.
 */
static void polish(const bench *trial, wide *voltage, const wide *gradient)
{
    unsigned char free[MOST_INPUTS];
    wide way[MOST_INPUTS], part = 0;
    const unsigned inputs = trial->problem.tables.inputs;
    for (unsigned i = 0; i < inputs; i++)
        free[i] = trial->lower_bound[i] < trial->upper_bound[i] &&
                  (gradient[i] > 0 ? voltage[i] > (wide)trial->lower_bound[i]
                                   : voltage[i] < (wide)trial->upper_bound[i]);
    for (unsigned tries = 0, first = 0; tries <= inputs && part <= 0 && first < inputs; tries++) {
        newton(trial, free, gradient, way);
        part = free_part(trial, voltage, way, &first);
        if (first < inputs)
            free[first] = 0;
    }
    for (unsigned i = 0; i < inputs; i++)
        voltage[i] = clip(voltage[i] + part * way[i], trial->lower_bound[i], trial->upper_bound[i]);
}

/*
 * Allowed difference of objectives: TOLERANCE |W e|^2 (or TOLERANCE times the objective, where
 * limits or regularisation make it larger), plus the effect of one rounding of each term of B'W^2
 * e.
 */
static wide allowance(const bench *trial)
{
    wide rounding = 0;
    const wide scale = fmaxl(energy(trial), objective_at(trial, trial->control.info.voltage));
    for (unsigned j = 0; j < trial->problem.tables.inputs; j++) {
        wide square = 0;
        for (unsigned i = 0; i < trial->problem.tables.outputs; i++)
            square += (wide)trial->problem.weight[i] * trial->problem.weight[i] *
                      trial->problem.influence[i * trial->problem.tables.inputs + j] *
                      trial->problem.influence[i * trial->problem.tables.inputs + j];
        rounding +=
            (wide)PZS_EPSILON * sqrtl(square * scale) * fabsl((wide)trial->control.info.voltage[j]);
    }
    return TOLERANCE * scale + rounding;
}

/*
 * Upper bound of (objective - optimum) divided by the allowed difference, from the duality gap at a
 * refined point.
 */
static inline wide excess(const bench *trial)
{
    wide voltage[MOST_INPUTS] = {0}, gradient[MOST_INPUTS];
    for (unsigned i = 0; i < trial->problem.tables.inputs; i++)
        voltage[i] = trial->control.info.voltage[i];
    const wide scale = allowance(trial), mine = objective(trial, voltage, gradient);
    wide bound = gap_of(trial, voltage, gradient);
    for (unsigned pass = 0; pass < 2 * MOST_INPUTS && bound > scale / 2; pass++) {
        polish(trial, voltage, gradient);
        const wide now = objective(trial, voltage, gradient),
                   better = mine - now + gap_of(trial, voltage, gradient);
        bound = better < bound ? better : bound;
    }
    return bound / scale;
}

#endif
