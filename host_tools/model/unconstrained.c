/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Weighted least squares without voltage limits by a pivoted Cholesky factorisation
 * (unconstrained.h).
 */
#include "unconstrained.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Number of times that the normal equations are solved: once, then for each iteration of iterative
 * refinement.
 */
enum { SOLUTIONS = 3 };

/*
 * Compute the normal matrix B'W^2 B of influence matrix B and weights W; each pair of columns is
 * computed once.
 */
static void form_normal_matrix(unconstrained *solver)
{
    const pzs_problem *problem = solver->problem;
    const size_t inputs = problem->inputs;
    for (size_t i = 0; i < problem->outputs; i++) {
        const double square = problem->weight[i] * problem->weight[i];
        const double *row = problem->influence + i * inputs;
        for (size_t j = 0; j < inputs; j++)
            for (size_t k = 0; k <= j; k++)
                solver->normal[j * inputs + k] += square * row[j] * row[k];
    }
}

bool unconstrained_open(unconstrained *solver, const pzs_problem *problem)
{
    const size_t inputs = problem->inputs;
    *solver = (unconstrained){.problem = problem};
    solver->normal = calloc(inputs * inputs, sizeof *solver->normal);
    solver->factor = calloc(inputs * inputs, sizeof *solver->factor);
    solver->remaining = calloc(inputs, sizeof *solver->remaining);
    solver->gradient = calloc(inputs, sizeof *solver->gradient);
    solver->pivot = calloc(inputs, sizeof *solver->pivot);
    if (!solver->normal || !solver->factor || !solver->remaining || !solver->gradient ||
        !solver->pivot)
        return false;
    form_normal_matrix(solver);
    unconstrained_factor(solver, problem->regularisation);
    return true;
}

void unconstrained_close(unconstrained *solver)
{
    free(solver->normal);
    free(solver->factor);
    free(solver->remaining);
    free(solver->gradient);
    free(solver->pivot);
    memset(solver, 0, sizeof *solver);
}

/*
 * Diagonal entry, for input k, of the regularised normal matrix B'W^2 B + r I with influence matrix
 * B, weights W and regularisation r.
 */
static double diagonal(const unconstrained *solver, size_t k)
{
    return solver->normal[k * solver->problem->inputs + k] + solver->regularisation;
}

/*
 * Return the input that the Cholesky factorisation eliminates next: the one that depends least on
 * those eliminated, by the largest ratio of its remaining to its original diagonal entry of the
 * normal matrix. Where all ratios are rounding errors, return the number of inputs.
 */
static size_t next_pivot(const unconstrained *solver)
{
    const size_t inputs = solver->problem->inputs;
    double largest = 4 * (double)inputs * DBL_EPSILON;
    size_t next = inputs;
    for (size_t k = 0; k < inputs; k++) {
        const double share = solver->remaining[k] / diagonal(solver, k);
        if (share > largest) {
            largest = share;
            next = k;
        }
    }
    return next;
}

/*
 * Compute column `step` of the Cholesky factor of the regularised normal matrix, with input `pivot`
 * as its pivot.
 */
static void eliminate(unconstrained *solver, size_t pivot, size_t step)
{
    const size_t inputs = solver->problem->inputs;
    double *own = solver->factor + pivot * inputs;
    own[step] = sqrt(solver->remaining[pivot]);
    solver->remaining[pivot] = 0;
    for (size_t j = 0; j < inputs; j++) {
        double *row = solver->factor + j * inputs;
        if (!(solver->remaining[j] > 0))
            continue;
        double sum = solver->normal[j > pivot ? j * inputs + pivot : pivot * inputs + j];
        for (size_t t = 0; t < step; t++)
            sum -= row[t] * own[t];
        row[step] = sum / own[step];
        solver->remaining[j] -= row[step] * row[step];
    }
}

void unconstrained_factor(unconstrained *solver, double regularisation)
{
    const size_t inputs = solver->problem->inputs;
    solver->regularisation = regularisation;
    solver->rank = 0;
    memset(solver->factor, 0, inputs * inputs * sizeof *solver->factor);
    for (size_t k = 0; k < inputs; k++)
        solver->remaining[k] = diagonal(solver, k);
    for (size_t k = next_pivot(solver); k < inputs; k = next_pivot(solver)) {
        eliminate(solver, k, (size_t)solver->rank);
        solver->pivot[solver->rank++] = (uint16_t)k;
    }
}

/*
 * Compute the negative gradient of half the objective at the present voltages v: B'W^2 (e - B v) +
 * r (v0 - v). B is the influence matrix, W the weights, e the target error, r the regularisation
 * and v0 the reference voltages.
 */
static void renew_gradient(unconstrained *solver, const double *error, const double *voltage)
{
    const pzs_problem *problem = solver->problem;
    const size_t inputs = problem->inputs;
    for (size_t k = 0; k < inputs; k++)
        solver->gradient[k] = solver->regularisation * (problem->reference_voltage[k] - voltage[k]);
    for (size_t i = 0; i < problem->outputs; i++) {
        const double *row = problem->influence + i * inputs;
        double misfit = error[i];
        for (size_t k = 0; k < inputs; k++)
            misfit -= row[k] * voltage[k];
        for (size_t k = 0; k < inputs; k++)
            solver->gradient[k] += problem->weight[i] * problem->weight[i] * row[k] * misfit;
    }
}

/*
 * Add a correction to the voltages: the solution of the normal equations with the present gradient,
 * which it overwrites, as right-hand side. Inputs that depend linearly on others (no pivot in the
 * Cholesky factor) keep their voltage.
 */
static void add_solution(unconstrained *solver, double *voltage)
{
    const size_t inputs = solver->problem->inputs, rank = (size_t)solver->rank;
    const uint16_t *pivot = solver->pivot;
    double *x = solver->gradient;
    for (size_t s = 0; s < rank; s++) {
        const double *row = solver->factor + pivot[s] * inputs;
        for (size_t t = 0; t < s; t++)
            x[pivot[s]] -= row[t] * x[pivot[t]];
        x[pivot[s]] /= row[s];
    }
    for (size_t s = rank; s-- > 0;) {
        for (size_t t = s + 1; t < rank; t++)
            x[pivot[s]] -= solver->factor[pivot[t] * inputs + s] * x[pivot[t]];
        x[pivot[s]] /= solver->factor[pivot[s] * inputs + s];
        voltage[pivot[s]] += x[pivot[s]];
    }
}

bool unconstrained_solve(unconstrained *solver, const double *error, double *voltage)
{
    const size_t inputs = solver->problem->inputs;
    bool is_finite = true;
    memset(voltage, 0, inputs * sizeof *voltage);
    for (int k = 0; k < SOLUTIONS; k++) {
        renew_gradient(solver, error, voltage);
        add_solution(solver, voltage);
    }
    for (size_t k = 0; k < inputs; k++)
        is_finite = is_finite && isfinite(voltage[k]);
    return is_finite;
}
