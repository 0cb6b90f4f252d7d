/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Voltages by least squares without limits, with or without regularisation, each then clipped to
 * its limits (clipped.h).
 */
#include "clipped.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Grid of the search for the regularisation parameter lambda with the smallest shape error after
 * clipping. The values are 10^(LOWEST + k / PER_DECADE) for k = 0 to GRID - 1, thus 1e-9 to 10.
 * SECTIONS is the number of steps of the search between two grid values.
 */
enum { LOWEST = -9, PER_DECADE = 3, GRID = 10 * PER_DECADE + 1, SECTIONS = 16 };

static bool is_held(const clipped *clipped, size_t k)
{
    return clipped->lower[k] == clipped->upper[k];
}

/*
 * Copy the influence matrix without the columns of amplifiers that are held at one voltage, and
 * subtract the effect of these amplifiers from the wanted displacements. Returns the mean diagonal
 * entry of B'W^2 B, with influence matrix B and weights W (m2/V2).
 */
static double prepare_arrays(clipped *clipped)
{
    const design *design = clipped->design;
    const size_t amplifiers = (size_t)design->amplifiers;
    double trace = 0;
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        const double *row = design->influence + i * amplifiers;
        clipped->required[i] = clipped->wanted[i];
        for (size_t k = 0; k < amplifiers; k++) {
            trace += pow(design->weight[i] * row[k], 2) / (double)amplifiers;
            clipped->influence[i * amplifiers + k] = is_held(clipped, k) ? 0 : row[k];
            clipped->required[i] -= is_held(clipped, k) ? row[k] * clipped->lower[k] : 0;
        }
    }
    return trace;
}

int clipped_open(clipped *clipped, const design *design, const double *lower, const double *upper,
                 const double *wanted)
{
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets;
    *clipped = (struct clipped){.design = design,
                                .lower = lower,
                                .upper = upper,
                                .wanted = wanted,
                                .problem = design->problem};
    clipped->arrays = calloc(targets * amplifiers + 2 * targets, sizeof *clipped->arrays);
    if (!clipped->arrays)
        return -1;
    clipped->influence = clipped->arrays;
    clipped->required = clipped->influence + targets * amplifiers;
    clipped->shape = clipped->required + targets;
    clipped->scale = prepare_arrays(clipped);
    clipped->problem.influence = clipped->influence;
    return unconstrained_open(&clipped->solver, &clipped->problem) ? 0 : -1;
}

void clipped_close(clipped *clipped)
{
    unconstrained_close(&clipped->solver);
    free(clipped->arrays);
    memset(clipped, 0, sizeof *clipped);
}

bool clipped_solve(clipped *clipped, double lambda, double *voltage)
{
    unconstrained_factor(&clipped->solver,
                         clipped->design->problem.regularisation + lambda * clipped->scale);
    const bool is_finite = unconstrained_solve(&clipped->solver, clipped->required, voltage);
    for (int k = 0; is_finite && k < clipped->design->amplifiers; k++)
        voltage[k] = fmin(fmax(voltage[k], clipped->lower[k]), clipped->upper[k]);
    return is_finite;
}

/*
 * State of the search for the regularisation parameter with which voltages that are clipped to
 * their limits leave the smallest weighted shape error: parameter, error and voltages of the best
 * trial so far.
 */
typedef struct tuning {
    clipped *clipped;
    double *trial, *best_voltage; /* [amplifiers] clipped voltages for the present regularisation
                                     parameter in a search, and for the one with the smallest shape
                                     error so far (V) */
    double best, best_lambda;
} tuning;

static double clipped_misfit(tuning *tuning, double lambda)
{
    const clipped *clipped = tuning->clipped;
    const size_t amplifiers = (size_t)clipped->design->amplifiers;
    if (!clipped_solve(tuning->clipped, lambda, tuning->trial))
        return HUGE_VAL;
    for (size_t i = 0; i < (size_t)clipped->design->targets; i++) {
        clipped->shape[i] = 0;
        for (size_t k = 0; k < amplifiers; k++)
            clipped->shape[i] += clipped->design->influence[i * amplifiers + k] * tuning->trial[k];
    }
    const double error = sqrt(design_squares(clipped->design, clipped->shape, clipped->wanted));
    if (error < tuning->best) {
        tuning->best = error;
        tuning->best_lambda = lambda;
        memcpy(tuning->best_voltage, tuning->trial, amplifiers * sizeof *tuning->best_voltage);
    }
    return error;
}

/*
 * Regularisation parameter 10^exponent, rounded to three digits. At the parameter with the smallest
 * shape error, a voltage often just reaches its limit, and rounding errors must not decide whether
 * this voltage counts as clipped.
 */
static double lambda_of(double exponent)
{
    const double unit = pow(10, floor(exponent) - 2);
    return unit * floor(pow(10, exponent) / unit + 0.5);
}

/*
 * Golden-section search for the regularisation parameter 10^x, with x between two given exponents,
 * whose clipped voltages leave the smallest shape error.
 */
static void golden_section(tuning *tuning, double from, double to)
{
    const double ratio = (sqrt(5) - 1) / 2;
    double x[2] = {to - ratio * (to - from), from + ratio * (to - from)};
    double y[2] = {clipped_misfit(tuning, lambda_of(x[0])),
                   clipped_misfit(tuning, lambda_of(x[1]))};
    for (int k = 0; k < SECTIONS; k++) {
        if (y[0] <= y[1]) {
            to = x[1];
            x[1] = x[0];
            y[1] = y[0];
            x[0] = to - ratio * (to - from);
            y[0] = clipped_misfit(tuning, lambda_of(x[0]));
        } else {
            from = x[0];
            x[0] = x[1];
            y[0] = y[1];
            x[1] = from + ratio * (to - from);
            y[1] = clipped_misfit(tuning, lambda_of(x[1]));
        }
    }
}

pzs_status clipped_tune(clipped *clipped, double *voltage, double *lambda)
{
    const double step = 1.0 / PER_DECADE;
    double least = HUGE_VAL, at = LOWEST;
    tuning tuning = {.clipped = clipped, .best_voltage = voltage, .best = HUGE_VAL};
    tuning.trial = calloc((size_t)clipped->design->amplifiers, sizeof *tuning.trial);
    if (!tuning.trial)
        return PZS_E_WORKSPACE;
    (void)clipped_misfit(&tuning, 0);
    for (int k = 0; k < GRID; k++) {
        const double exponent = LOWEST + k * step,
                     error = clipped_misfit(&tuning, lambda_of(exponent));
        if (error < least) {
            least = error;
            at = exponent;
        }
    }
    golden_section(&tuning, at - step, at + step);
    free(tuning.trial);
    *lambda = tuning.best_lambda;
    return isfinite(tuning.best) ? PZS_OK : PZS_E_NONFINITE;
}
