/*
 * A voltage problem with its own arrays and workspace, and a certificate in long double,
 * independent of the arithmetic of the library, of how far its voltages are from the optimum.
 * Include it after cmocka.h.
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

#define MOST_INPUTS 64
#define MOST_OUTPUTS 160
#define TOLERANCE PZS_BY_BITS(1e-6L, 1e-12L) /* tolerance of the objective, relative to |W e|^2 */

typedef long double wide;

/* ---- a bench: one problem with its own arrays and workspace ------------------- */

typedef struct bench {
    uint64_t seed;
    pzs_problem p;
    pzs_control c;
    pzs_real b[MOST_OUTPUTS * MOST_INPUTS], weight[MOST_OUTPUTS], error[MOST_OUTPUTS];
    pzs_real lower[MOST_INPUTS], upper[MOST_INPUTS], slew[MOST_INPUTS], prefer[MOST_INPUTS];
    /* voltages before the last step, and limits of the last step (V) */
    pzs_real last[MOST_INPUTS], lo[MOST_INPUTS], hi[MOST_INPUTS];
    double work[(PZS_CONTROL_BYTES(MOST_INPUTS, MOST_OUTPUTS) + 7) / 8];
} bench;

static uint64_t bits(bench *t)
{
    uint64_t z = (t->seed += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static double uniform(bench *t, double lo, double hi)
{
    return lo + (hi - lo) * (double)(bits(t) >> 11) * 0x1p-53;
}

static inline int chance(bench *t, double p)
{
    return uniform(t, 0, 1) < p;
}

static unsigned below(bench *t, unsigned n)
{
    return (unsigned)(bits(t) % n);
}

static pzs_status start(bench *t)
{
    const pzs_real *b = t->p.influence;
    t->p.format = PZS_TABLE_FORMAT;
    t->p.weight = t->weight;
    t->p.lower = t->lower;
    t->p.upper = t->upper;
    t->p.step_limit = t->slew;
    t->p.reference_voltage = t->prefer;
    t->p.crc = pzs_problem_crc(&t->p);
    return pzs_control_init(&t->c, &t->p, b != NULL ? NULL : t->b, t->work, sizeof t->work);
}

/*
 * A problem with a full-rank influence matrix and limits +-limit, without step limits and
 * regularisation.
 */
static void plain(bench *t, uint64_t seed, unsigned n, unsigned m, double limit)
{
    memset(t, 0, sizeof *t);
    t->seed = seed;
    t->p.inputs = (uint16_t)n;
    t->p.outputs = (uint16_t)m;
    t->p.influence = t->b;
    for (unsigned i = 0; i < m * n; i++)
        t->b[i] = (pzs_real)uniform(t, -1, 1);
    for (unsigned i = 0; i < m; i++) {
        t->weight[i] = 1;
        t->error[i] = (pzs_real)uniform(t, -1, 1);
    }
    for (unsigned i = 0; i < n; i++) {
        t->upper[i] = (pzs_real)limit;
        t->lower[i] = (pzs_real)-limit;
        t->slew[i] = (pzs_real)HUGE_VAL;
    }
}

static wide energy(const bench *t)
{
    wide sum = 0;
    for (unsigned i = 0; i < t->p.outputs; i++)
        sum += (wide)t->weight[i] * t->weight[i] * t->error[i] * t->error[i];
    return sum;
}

/*
 * Objective |W (B v - e)|^2 + regularisation |v - reference voltage|^2 and half of its gradient, in
 * long double, from the influence matrix B itself.
 */
static wide objective(const bench *t, const wide *v, wide *gradient)
{
    const unsigned n = t->p.inputs;
    wide sum = 0;
    for (unsigned j = 0; j < n; j++) {
        const wide away = v[j] - (wide)t->prefer[j];
        gradient[j] = (wide)t->p.regularisation * away;
        sum += gradient[j] * away;
    }
    for (unsigned i = 0; i < t->p.outputs; i++) {
        const wide weight = (wide)t->weight[i] * t->weight[i];
        wide miss = -(wide)t->error[i];
        for (unsigned j = 0; j < n; j++)
            miss += (wide)t->b[i * n + j] * v[j];
        sum += weight * miss * miss;
        for (unsigned j = 0; j < n; j++)
            gradient[j] += weight * miss * (wide)t->b[i * n + j];
    }
    return sum;
}

static wide objective_at(const bench *t, const pzs_real *voltage)
{
    wide v[MOST_INPUTS] = {0}, gradient[MOST_INPUTS];
    for (unsigned i = 0; i < t->p.inputs; i++)
        v[i] = voltage[i];
    return objective(t, v, gradient);
}

/* Relative error of the shape, |W (B v - e)| / |W e|. */
static wide shape_error_of(const bench *t)
{
    wide v[MOST_INPUTS] = {0}, gradient[MOST_INPUTS], effort = 0;
    for (unsigned i = 0; i < t->p.inputs; i++) {
        v[i] = t->c.info.voltage[i];
        effort +=
            (wide)t->p.regularisation * (v[i] - (wide)t->prefer[i]) * (v[i] - (wide)t->prefer[i]);
    }
    return sqrtl((objective(t, v, gradient) - effort) / energy(t));
}

/* ---- limits -------------------------------------------------------------------- */

/* Compute the limits of the coming step from their definition. */
static void note_limits(bench *t)
{
    for (unsigned i = 0; i < t->p.inputs; i++) {
        const pzs_real last = t->last[i] = t->c.info.voltage[i];
        const pzs_real lo = last - t->slew[i], hi = last + t->slew[i];
        t->lo[i] = lo > t->c.info.lower[i] ? lo : t->c.info.lower[i];
        t->hi[i] = hi < t->c.info.upper[i] ? hi : t->c.info.upper[i];
        if (t->lo[i] > t->hi[i])
            t->lo[i] = t->hi[i] =
                last < t->c.info.lower[i] ? t->c.info.lower[i] : t->c.info.upper[i];
    }
}

static void assert_feasible(const bench *t)
{
    for (unsigned i = 0; i < t->p.inputs; i++) {
        const pzs_real v = t->c.info.voltage[i],
                       change = v < t->last[i] ? t->last[i] - v : v - t->last[i];
        assert_true(v >= t->c.info.lower[i] && v <= t->c.info.upper[i]);
        assert_true(isfinite(v));
        if (change > t->slew[i]) /* allowed only where step limit and voltage limits do not overlap
                                  */
            assert_true(t->lo[i] >= t->hi[i] && v >= t->lo[i] && v <= t->hi[i]);
    }
}

/* ---- certificate ----------------------------------------------------------------- */

static wide clip(wide x, wide lo, wide hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

/*
 * Upper bound of the distance from the optimum, by convexity: objective - optimum <= 2 max over the
 * box of gradient . (v - x). An unbounded box is cut at ten times the largest voltage.
 */
static wide gap_of(const bench *t, const wide *v, const wide *gradient)
{
    wide gap = 0, most = 1;
    for (unsigned i = 0; i < t->p.inputs; i++)
        most = fabsl(v[i]) > most ? fabsl(v[i]) : most;
    for (unsigned i = 0; i < t->p.inputs; i++) {
        const wide room = gradient[i] > 0 ? v[i] - (wide)t->lo[i] : (wide)t->hi[i] - v[i];
        gap +=
            room > 0 && gradient[i] != 0
                ? 2 * fabsl(gradient[i]) * (room < 10 * most || isfinite(room) ? room : 10 * most)
                : 0;
    }
    return gap;
}

/*
 * Newton direction over the inputs marked free, by a dense L D L^T in long double. Linearly
 * dependent inputs do not move.
 */
static void newton(const bench *t, const unsigned char *free, const wide *gradient, wide *way)
{
    static wide a[MOST_INPUTS][MOST_INPUTS], rest[MOST_INPUTS];
    const unsigned n = t->p.inputs;
    unsigned char used[MOST_INPUTS] = {0};
    for (unsigned j = 0; j < n; j++) {
        rest[j] = -gradient[j];
        for (unsigned k = 0; k <= j; k++) {
            a[j][k] = j == k ? (wide)t->p.regularisation : 0;
            for (unsigned i = 0; free[j] && free[k] && i < t->p.outputs; i++)
                a[j][k] += (wide)t->weight[i] * t->weight[i] * t->b[i * n + j] * t->b[i * n + k];
        }
    }
    for (unsigned k = 0; k < n; k++) {
        const wide diagonal = a[k][k];
        wide pivot = diagonal;
        for (unsigned j = 0; j < k; j++)
            pivot -= used[j] ? a[k][j] * a[k][j] * a[j][j] : 0;
        used[k] = free[k] && pivot > 1e-16L * diagonal;
        a[k][k] = pivot;
        for (unsigned i = k + 1; used[k] && i < n; i++) {
            for (unsigned j = 0; j < k; j++)
                a[i][k] -= used[j] ? a[i][j] * a[j][j] * a[k][j] : 0;
            a[i][k] /= pivot;
            rest[i] -= a[i][k] * rest[k];
        }
    }
    for (unsigned k = n; k-- > 0;) {
        way[k] = used[k] ? rest[k] / a[k][k] : 0;
        for (unsigned i = k + 1; used[k] && i < n; i++)
            way[k] -= used[i] ? a[i][k] * way[i] : 0;
    }
}

/* Part (0 to 1) of a way that the limits allow, and the first input to meet its limit, or n. */
static wide free_part(const bench *t, const wide *v, const wide *way, unsigned *first)
{
    wide part = 1;
    *first = t->p.inputs;
    for (unsigned i = 0; i < t->p.inputs; i++) {
        const wide room = way[i] < 0 ? v[i] - (wide)t->lo[i] : (wide)t->hi[i] - v[i];
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
static void polish(const bench *t, wide *v, const wide *gradient)
{
    unsigned char free[MOST_INPUTS];
    wide way[MOST_INPUTS], part = 0;
    const unsigned n = t->p.inputs;
    for (unsigned i = 0; i < n; i++)
        free[i] = t->lo[i] < t->hi[i] &&
                  (gradient[i] > 0 ? v[i] > (wide)t->lo[i] : v[i] < (wide)t->hi[i]);
    for (unsigned tries = 0, first = 0; tries <= n && part <= 0 && first < n; tries++) {
        newton(t, free, gradient, way);
        part = free_part(t, v, way, &first);
        if (first < n)
            free[first] = 0;
    }
    for (unsigned i = 0; i < n; i++)
        v[i] = clip(v[i] + part * way[i], t->lo[i], t->hi[i]);
}

/*
 * Allowed difference of objectives: TOLERANCE |W e|^2 (or TOLERANCE times the objective, where
 * limits or regularisation make it larger), plus the effect of one rounding of each term of B'W^2
 * e.
 */
static wide allowance(const bench *t)
{
    wide rounding = 0;
    const wide scale = fmaxl(energy(t), objective_at(t, t->c.info.voltage));
    for (unsigned j = 0; j < t->p.inputs; j++) {
        wide square = 0;
        for (unsigned i = 0; i < t->p.outputs; i++)
            square += (wide)t->weight[i] * t->weight[i] * t->b[i * t->p.inputs + j] *
                      t->b[i * t->p.inputs + j];
        rounding += (wide)PZS_EPSILON * sqrtl(square * scale) * fabsl((wide)t->c.info.voltage[j]);
    }
    return TOLERANCE * scale + rounding;
}

/*
 * Upper bound of (objective - optimum) divided by the allowed difference, from the duality gap at a
 * refined point.
 */
static wide excess(const bench *t)
{
    wide v[MOST_INPUTS] = {0}, gradient[MOST_INPUTS];
    for (unsigned i = 0; i < t->p.inputs; i++)
        v[i] = t->c.info.voltage[i];
    const wide scale = allowance(t), mine = objective(t, v, gradient);
    wide bound = gap_of(t, v, gradient);
    for (unsigned pass = 0; pass < 2 * MOST_INPUTS && bound > scale / 2; pass++) {
        polish(t, v, gradient);
        const wide now = objective(t, v, gradient), better = mine - now + gap_of(t, v, gradient);
        bound = better < bound ? better : bound;
    }
    return bound / scale;
}

#endif
