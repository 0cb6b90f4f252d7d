/*
 * Laws of the voltage controller. Arguments (both optional): a file to which problems and
 * answers are written for tests/oracle/boxls.py, and how many of the random problems.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "guard.h"
#include "testdata.h"

#define MOST_INPUTS 64
#define MOST_OUTPUTS 160
#define RANDOM_PROBLEMS 10000
#define TOLERANCE PZS_BY_BITS(1e-6L, 1e-12L) /* objective over |W e|^2 */
#define KKT_TOLERANCE PZS_BY_BITS(1e-3, 1e-9)

typedef long double wide;

/* ---- a bench: one problem with its own arrays and workspace ------------------- */

typedef struct bench {
    uint64_t seed;
    pzs_problem p;
    pzs_control c;
    pzs_real b[MOST_OUTPUTS * MOST_INPUTS], weight[MOST_OUTPUTS], error[MOST_OUTPUTS];
    pzs_real lower[MOST_INPUTS], upper[MOST_INPUTS], slew[MOST_INPUTS], prefer[MOST_INPUTS];
    pzs_real last[MOST_INPUTS], lo[MOST_INPUTS], hi[MOST_INPUTS]; /* volts before, limits of the last step */
    double work[(PZS_CONTROL_BYTES(MOST_INPUTS, MOST_OUTPUTS) + 7) / 8];
} bench;

static bench desk, other;
static FILE *dump;
static long dump_count;

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

static int chance(bench *t, double p)
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
    t->p.slew = t->slew;
    t->p.prefer = t->prefer;
    t->p.crc = guard_problem_crc(&t->p);
    return pzs_control_init(&t->c, &t->p, b != NULL ? NULL : t->b, t->work, sizeof t->work);
}

/* A plain problem: full-rank B, limits +-limit, no slew, no effort. */
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

/* |W (B v - e)|^2 + effort |v - prefer|^2, and half its gradient; in long double from B itself. */
static wide objective(const bench *t, const wide *v, wide *gradient)
{
    const unsigned n = t->p.inputs;
    wide sum = 0;
    for (unsigned j = 0; j < n; j++) {
        const wide away = v[j] - (wide)t->prefer[j];
        gradient[j] = (wide)t->p.effort * away;
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

static wide objective_at(const bench *t, const pzs_real *volt)
{
    wide v[MOST_INPUTS], gradient[MOST_INPUTS];
    for (unsigned i = 0; i < t->p.inputs; i++)
        v[i] = volt[i];
    return objective(t, v, gradient);
}

/* ---- limits -------------------------------------------------------------------- */

/* Limits of the coming step, from the definition. */
static void note_limits(bench *t)
{
    for (unsigned i = 0; i < t->p.inputs; i++) {
        const pzs_real last = t->last[i] = t->c.volt[i];
        const pzs_real lo = last - t->slew[i], hi = last + t->slew[i];
        t->lo[i] = lo > t->c.lower[i] ? lo : t->c.lower[i];
        t->hi[i] = hi < t->c.upper[i] ? hi : t->c.upper[i];
        if (t->lo[i] > t->hi[i])
            t->lo[i] = t->hi[i] = last < t->c.lower[i] ? t->c.lower[i] : t->c.upper[i];
    }
}

static void assert_feasible(const bench *t)
{
    for (unsigned i = 0; i < t->p.inputs; i++) {
        const pzs_real v = t->c.volt[i], change = v < t->last[i] ? t->last[i] - v : v - t->last[i];
        assert_true(v >= t->c.lower[i] && v <= t->c.upper[i]);
        assert_true(isfinite(v));
        if (change > t->slew[i]) /* allowed only where slew and limit do not meet */
            assert_true(t->lo[i] >= t->hi[i] && v >= t->lo[i] && v <= t->hi[i]);
    }
}

/* ---- certificate ----------------------------------------------------------------- */

static wide clip(wide x, wide lo, wide hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

/* Convexity: objective - optimum <= 2 max over the box of gradient . (v - x). An endless box is cut at ten times the largest volts. */
static wide gap_of(const bench *t, const wide *v, const wide *gradient)
{
    wide gap = 0, most = 1;
    for (unsigned i = 0; i < t->p.inputs; i++)
        most = fabsl(v[i]) > most ? fabsl(v[i]) : most;
    for (unsigned i = 0; i < t->p.inputs; i++) {
        const wide room = gradient[i] > 0 ? v[i] - (wide)t->lo[i] : (wide)t->hi[i] - v[i];
        gap += room > 0 && gradient[i] != 0 ? 2 * fabsl(gradient[i]) * (room < 10 * most || isfinite(room) ? room : 10 * most) : 0;
    }
    return gap;
}

/* Newton direction over the inputs marked free, dense L D L^T in long double; dependent inputs stay. */
static void newton(const bench *t, const unsigned char *free, const wide *gradient, wide *way)
{
    static wide a[MOST_INPUTS][MOST_INPUTS], rest[MOST_INPUTS];
    const unsigned n = t->p.inputs;
    unsigned char used[MOST_INPUTS] = { 0 };
    for (unsigned j = 0; j < n; j++) {
        rest[j] = -gradient[j];
        for (unsigned k = 0; k <= j; k++) {
            a[j][k] = j == k ? (wide)t->p.effort : 0;
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

/* How much of a way is free, 0 to 1, and the first input to meet its limit, or n. */
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

/* One exact step of the reference: free are the inputs the gradient may move, less those that cannot follow. */
static void polish(const bench *t, wide *v, const wide *gradient)
{
    unsigned char free[MOST_INPUTS];
    wide way[MOST_INPUTS], part = 0;
    const unsigned n = t->p.inputs;
    for (unsigned i = 0; i < n; i++)
        free[i] = t->lo[i] < t->hi[i] && (gradient[i] > 0 ? v[i] > (wide)t->lo[i] : v[i] < (wide)t->hi[i]);
    for (unsigned tries = 0, first = 0; tries <= n && part <= 0 && first < n; tries++) {
        newton(t, free, gradient, way);
        part = free_part(t, v, way, &first);
        if (first < n)
            free[first] = 0;
    }
    for (unsigned i = 0; i < n; i++)
        v[i] = clip(v[i] + part * way[i], t->lo[i], t->hi[i]);
}

/* Upper bound of (objective - optimum) / |W e|^2, from the duality gap at a polished point. */
static wide excess(const bench *t)
{
    wide v[MOST_INPUTS], gradient[MOST_INPUTS];
    for (unsigned i = 0; i < t->p.inputs; i++)
        v[i] = t->c.volt[i];
    const wide scale = energy(t), mine = objective(t, v, gradient);
    wide bound = gap_of(t, v, gradient);
    for (unsigned pass = 0; pass < 2 * MOST_INPUTS && bound > TOLERANCE * scale / 2; pass++) {
        polish(t, v, gradient);
        const wide now = objective(t, v, gradient), better = mine - now + gap_of(t, v, gradient);
        bound = better < bound ? better : bound;
    }
    return bound / scale;
}

static double true_kkt(const bench *t)
{
    wide v[MOST_INPUTS] = {0}, z[MOST_INPUTS]={0},gradient[MOST_INPUTS], g0[MOST_INPUTS];
    for (unsigned i = 0; i < t->p.inputs; i++)
        v[i] = t->c.volt[i];
    objective(t,v,gradient); objective(t,z,g0);
    wide most=0, top=0;
    for (unsigned i = 0; i < t->p.inputs; i++) {
        wide g=gradient[i]; wide x = g>0? (v[i]>(wide)t->lo[i]?g:0):(v[i]<(wide)t->hi[i]?-g:0);
        if (x>most) most=x;
        if (fabsl(g0[i])>top) top=fabsl(g0[i]);
    }
    return (double)(most/top);
}
/* ---- random problems --------------------------------------------------------------- */

static int KIND; static double REACH;
static void random_influence(bench *t)
{
    const unsigned n = t->p.inputs, m = t->p.outputs, rank = 1 + below(t, n), kind = below(t, 6);KIND=(int)kind;
    for (unsigned i = 0; i < m; i++)
        for (unsigned j = 0; j < n; j++) {
            const double smooth = cos(3.1 * (double)((i + 1) * (j % rank + 1)) / m);
            const double x = kind == 0 ? smooth : uniform(t, -1, 1);
            t->b[i * n + j] = (pzs_real)(kind == 1 ? x * pow(10, -2.0 * j / n) : x);
        }
    for (unsigned i = 0; kind == 2 && i < m; i++) /* rank-deficient to the last bit: repeated columns */
        for (unsigned j = rank; j < n; j++)
            t->b[i * n + j] = (j % 3 ? -2 : 1) * t->b[i * n + j % rank];
    for (unsigned i = 0; kind == 3 && i < m; i++) /* sums of columns: to rounding */
        for (unsigned j = rank; j < n; j++)
            t->b[i * n + j] = t->b[i * n + j % rank] + t->b[i * n + (j + 1) % rank];
    for (unsigned i = 0; kind == 4 && i < m; i++) /* a zero column */
        t->b[i * n + rank - 1] = 0;
}

static void random_limits(bench *t)
{
    static const double reach[] = { .02, .1, .3, .6, 1, 3 };
    const double limit = reach[below(t, 6)], dead = chance(t, .3) ? .3 : 0, endless = chance(t, .1) && t->p.effort > 0 ? .3 : 0;
    const double slew = chance(t, .4) ? limit * uniform(t, .05, .6) : HUGE_VAL;
    REACH=limit*(endless>0?1.001:1);
    const int preferred = chance(t, .5);
    for (unsigned j = 0; j < t->p.inputs; j++) {
        t->lower[j] = (pzs_real)(chance(t, endless) ? -HUGE_VAL : -limit * uniform(t, .1, 1));
        t->upper[j] = (pzs_real)(chance(t, endless) ? HUGE_VAL : limit * uniform(t, .1, 1));
        if (chance(t, .05))
            t->lower[j] = 0;
        if (chance(t, dead))
            t->lower[j] = t->upper[j] = 0;
        t->slew[j] = (pzs_real)slew;
        t->prefer[j] = (pzs_real)(preferred ? uniform(t, -.5, .5) : 0);
    }
}

static void random_error(bench *t, double part)
{
    for (unsigned i = 0; i < t->p.outputs; i++)
        t->error[i] = (pzs_real)((1 - part) * (double)t->error[i] + part * uniform(t, -1, 1));
}

static void random_problem(bench *t, uint64_t seed)
{
    memset(t, 0, sizeof *t);
    t->seed = seed;
    const unsigned n = chance(t, .1) ? 40 + below(t, 25) : 1 + below(t, 24);
    t->p.inputs = (uint16_t)n;
    t->p.outputs = (uint16_t)(1 + below(t, 2 * n + 4));
    t->p.influence = t->b;
    random_influence(t);
    const double effort = chance(t, .5) ? pow((double)PZS_EPSILON, uniform(t, .1, .5)) : 0;
    t->p.effort = (pzs_real)(effort * t->p.outputs / 3);
    random_limits(t);
    for (unsigned i = 0; i < t->p.outputs; i++)
        t->weight[i] = (pzs_real)(chance(t, .1) ? 0 : uniform(t, .2, 2));
    t->weight[below(t, t->p.outputs)] = 1;
    random_error(t, 1);
}

/* Change the problem as a running system does: another target, a held or a released input. */
static void disturb(bench *t)
{
    random_error(t, chance(t, .5) ? .05 : .7);
    if (chance(t, .2))
        assert_int_equal(pzs_hold(&t->c, (uint16_t)below(t, t->p.inputs), (pzs_real)uniform(t, -1, 1)), PZS_OK);
    if (chance(t, .2))
        assert_int_equal(pzs_release(&t->c, (uint16_t)below(t, t->p.inputs)), PZS_OK);
}

static void put(double x)
{
    assert_int_equal(fwrite(&x, sizeof x, 1, dump), 1);
}

static void put_all(const pzs_real *x, unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        put((double)x[i]);
}

/* n m effort tolerance B W e lo hi prefer volt, all as double. */
static void write_problem(const bench *t)
{
    const unsigned n = t->p.inputs, m = t->p.outputs;
    put(n), put(m), put((double)t->p.effort), put((double)TOLERANCE);
    put_all(t->b, n * m), put_all(t->weight, m), put_all(t->error, m);
    put_all(t->lo, n), put_all(t->hi, n), put_all(t->prefer, n), put_all(t->c.volt, n);
}

/* One checked step. Returns the certified excess. */
static wide checked_step(bench *t)
{
    note_limits(t);
    const pzs_status status = pzs_step(&t->c, t->error);
    if (status != PZS_OK && status != PZS_W_SLEW) print_error("STATUS %d seed n %d m %d effort %g passes %d opt %g\n", status, t->p.inputs, t->p.outputs, (double)t->p.effort, t->c.passes, (double)t->c.optimality);
    assert_feasible(t);
    return excess(t);
}

static void random_problems_are_solved(void **state)
{
    (void)state; /* law: every step ends at the optimum, by the duality gap, cold and warm, degenerate or not */
    wide worst = 0;
    unsigned passes = 0, most = 0;
    double kkt = 0;
    for (unsigned k = 0; k < RANDOM_PROBLEMS; k++) {
        random_problem(&desk, k);
        assert_int_equal(start(&desk), PZS_OK);
        const unsigned steps = 1 + below(&desk, 4);
        for (unsigned s = 0; s < steps; s++) {
            if (s > 0)
                disturb(&desk);
            const wide here = checked_step(&desk);
            if (!(here <= TOLERANCE) || (double)desk.c.optimality > KKT_TOLERANCE)
                print_error("problem %u step %u (n %d, m %d, effort %g, kind %d reach %g): excess %Lg, true %g kkt %g, passes %d\n", k, s, desk.p.inputs,
                            desk.p.outputs, (double)desk.p.effort, KIND, REACH, here, true_kkt(&desk), (double)desk.c.optimality, desk.c.passes);
            worst = here > worst ? here : worst;
            kkt = (double)desk.c.optimality > kkt ? (double)desk.c.optimality : kkt;
            passes += desk.c.passes;
        }
        most = desk.c.passes_most > most ? desk.c.passes_most : most;
        if (dump != NULL && (long)k < dump_count)
            write_problem(&desk);
    }
    print_message("%d problems: excess at most %.2Lg of |We|^2, optimality %.2g, passes in all %u, most in a step %u\n",
                  RANDOM_PROBLEMS, worst, kkt, passes, most);
    assert_true(worst <= TOLERANCE && kkt <= KKT_TOLERANCE);
}

