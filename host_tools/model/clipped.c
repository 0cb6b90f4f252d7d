/* Clipped least squares, regularised or not (clipped.h). */
#include "clipped.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * The grid: 10^(LOWEST + k / PER_DECADE), k < GRID, to 10, where every voltage is far below its
 * size.
 */
enum { LOWEST = -9, PER_DECADE = 3, GRID = 10 * PER_DECADE + 1, SECTIONS = 16 };

static bool is_held(const clipped *c, size_t k)
{
    return c->lower[k] == c->upper[k];
}

/*
 * Copy B without the columns of held amplifiers, and take what those do off the target. Returns
 * tr(B'W^2 B)/n.
 */
static double part(clipped *c)
{
    const design *design = c->design;
    const size_t n = (size_t)design->amplifiers;
    double trace = 0;
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        const double *row = design->influence + i * n;
        c->left[i] = c->wanted[i];
        for (size_t k = 0; k < n; k++) {
            trace += pow(design->weight[i] * row[k], 2) / (double)n;
            c->influence[i * n + k] = is_held(c, k) ? 0 : row[k];
            c->left[i] -= is_held(c, k) ? row[k] * c->lower[k] : 0;
        }
    }
    return trace;
}

int clipped_open(clipped *c, const design *design, const double *lower, const double *upper,
                 const double *wanted)
{
    const size_t n = (size_t)design->amplifiers, m = (size_t)design->targets;
    *c = (clipped){.design = design,
                   .lower = lower,
                   .upper = upper,
                   .wanted = wanted,
                   .problem = design->problem};
    c->arrays = calloc(m * n + 2 * m, sizeof *c->arrays);
    if (!c->arrays)
        return -1;
    c->influence = c->arrays;
    c->left = c->influence + m * n;
    c->shape = c->left + m;
    c->scale = part(c);
    c->problem.influence = c->influence;
    return unconstrained_open(&c->solver, &c->problem) ? 0 : -1;
}

void clipped_close(clipped *c)
{
    unconstrained_close(&c->solver);
    free(c->arrays);
    memset(c, 0, sizeof *c);
}

bool clipped_solve(clipped *c, double lambda, double *voltage)
{
    unconstrained_factor(&c->solver, c->design->problem.regularisation + lambda * c->scale);
    const bool is_finite = unconstrained_solve(&c->solver, c->left, voltage);
    for (int k = 0; is_finite && k < c->design->amplifiers; k++)
        voltage[k] = fmin(fmax(voltage[k], c->lower[k]), c->upper[k]);
    return is_finite;
}

/*
 * |W (B v - wanted)| of the voltages for lambda, infinite where there are none; best, best_at,
 * volt: the smallest so far.
 */
typedef struct search {
    clipped *c;
    double *trial, *volt; /* [amplifiers] */
    double best, best_at;
} search;

static double missed(search *s, double lambda)
{
    const clipped *c = s->c;
    const size_t n = (size_t)c->design->amplifiers;
    if (!clipped_solve(s->c, lambda, s->trial))
        return HUGE_VAL;
    for (size_t i = 0; i < (size_t)c->design->targets; i++) {
        c->shape[i] = 0;
        for (size_t k = 0; k < n; k++)
            c->shape[i] += c->design->influence[i * n + k] * s->trial[k];
    }
    const double error = sqrt(design_squares(c->design, c->shape, c->wanted));
    if (error < s->best) {
        s->best = error;
        s->best_at = lambda;
        memcpy(s->volt, s->trial, n * sizeof *s->volt);
    }
    return error;
}

/*
 * lambda of a decimal exponent, to three digits: the best one is where a voltage just reaches its
 * limit, and rounding must not decide whether that voltage counts as cut.
 */
static double lambda_of(double exponent)
{
    const double unit = pow(10, floor(exponent) - 2);
    return unit * floor(pow(10, exponent) / unit + 0.5);
}

/* Shrink [from, to], decimal exponents, around a minimum. */
static void golden_section(search *s, double from, double to)
{
    const double ratio = (sqrt(5) - 1) / 2;
    double x[2] = {to - ratio * (to - from), from + ratio * (to - from)};
    double y[2] = {missed(s, lambda_of(x[0])), missed(s, lambda_of(x[1]))};
    for (int k = 0; k < SECTIONS; k++) {
        if (y[0] <= y[1]) {
            to = x[1];
            x[1] = x[0];
            y[1] = y[0];
            x[0] = to - ratio * (to - from);
            y[0] = missed(s, lambda_of(x[0]));
        } else {
            from = x[0];
            x[0] = x[1];
            y[0] = y[1];
            x[1] = from + ratio * (to - from);
            y[1] = missed(s, lambda_of(x[1]));
        }
    }
}

pzs_status clipped_tune(clipped *c, double *voltage, double *lambda)
{
    const double step = 1.0 / PER_DECADE;
    double least = HUGE_VAL, at = LOWEST;
    search s = {.c = c, .volt = voltage, .best = HUGE_VAL};
    s.trial = calloc((size_t)c->design->amplifiers, sizeof *s.trial);
    if (!s.trial)
        return PZS_E_WORKSPACE;
    (void)missed(&s, 0);
    for (int k = 0; k < GRID; k++) {
        const double exponent = LOWEST + k * step, error = missed(&s, lambda_of(exponent));
        if (error < least) {
            least = error;
            at = exponent;
        }
    }
    golden_section(&s, at - step, at + step);
    free(s.trial);
    *lambda = s.best_at;
    return isfinite(s.best) ? PZS_OK : PZS_E_NONFINITE;
}
