/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gains of the control tick that damps vibration (damper_gains.h). The Riccati equation of the
 * observer is solved by structured doubling. The damping gradient is the term that the tick
 * subtracts from the gradient of its objective to damp vibration.
 */
#include "damper_gains.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "propagator.h"

enum { DOUBLINGS = 60 };

/*
 * Relative change of the solution of the vibration observer's Riccati equation at which the
 * doubling iteration has converged.
 */
static const double converged = 1e-14;

/*
 * Variance of the process noise that the vibration observer, a Kalman filter, assumes for the
 * position of a vibration mode in one tick; it keeps the Riccati equation regular.
 */
static const double position_noise = 1e-12;

/*
 * Regularisation of the least-squares fit of modal coordinates to readings, relative to the mean
 * diagonal entry of the normal matrix: the resolution of single precision.
 */
static const double ridge = 1e-7;

damper_settings damper_default_settings(void)
{
    return (damper_settings){.damping = 0.75,
                             .cut = 0.6,
                             .observed = 2,
                             .follow = 0.317,
                             .follow_limit = 0.15,
                             .mix = 0.75,
                             .kick = 0.25,
                             .drift = 0.21,
                             .slow = 0.005,
                             .fading_periods = 2,
                             .later = 0,
                             .is_gradient = false};
}

/* ---- dense matrices --------------------------------------------------- */

/*
 * Multiply two matrices: out = a b, or the transpose of a times b if `transposed` is true.
 *   a, b [order][order] in   factors
 *   out  [order][order] out  product, in other memory than a and b
 */
static void multiply(double *out, const double *a, const double *b, size_t order, bool transposed)
{
    memset(out, 0, order * order * sizeof *out);
    for (size_t i = 0; i < order; i++)
        for (size_t k = 0; k < order; k++) {
            const double factor = transposed ? a[k * order + i] : a[i * order + k];
            for (size_t j = 0; j < order && factor != 0; j++)
                out[i * order + j] += factor * b[k * order + j];
        }
}

static void symmetrise(double *a, size_t order)
{
    for (size_t i = 0; i < order; i++)
        for (size_t j = 0; j < i; j++)
            a[i * order + j] = a[j * order + i] = (a[i * order + j] + a[j * order + i]) / 2;
}

static void exchange_rows(double *a, size_t order, size_t i, size_t k)
{
    for (size_t j = 0; j < order && i != k; j++) {
        const double kept = a[i * order + j];
        a[i * order + j] = a[k * order + j];
        a[k * order + j] = kept;
    }
}

static size_t pivot_row(const double *a, size_t order, size_t column)
{
    size_t best = column;
    for (size_t i = column + 1; i < order; i++)
        if (fabs(a[i * order + column]) > fabs(a[best * order + column]))
            best = i;
    return best;
}

/*
 * Invert a matrix by Gauss-Jordan elimination with partial pivoting: x = inverse of a.
 *   a [order][order] in   overwritten
 *   x [order][order] out  inverse
 * Returns 0, or -1 where the matrix is singular.
 */
static int invert(double *a, double *x, size_t order)
{
    memset(x, 0, order * order * sizeof *x);
    for (size_t i = 0; i < order; i++)
        x[i * order + i] = 1;
    for (size_t p = 0; p < order; p++) {
        const size_t row = pivot_row(a, order, p);
        exchange_rows(a, order, p, row);
        exchange_rows(x, order, p, row);
        const double pivot = a[p * order + p];
        if (!(fabs(pivot) > 0) || !isfinite(pivot))
            return -1;
        for (size_t j = 0; j < order; j++) {
            a[p * order + j] /= pivot;
            x[p * order + j] /= pivot;
        }
        for (size_t i = 0; i < order; i++) {
            const double factor = i == p ? 0 : a[i * order + p];
            for (size_t j = 0; j < order && factor != 0; j++) {
                a[i * order + j] -= factor * a[p * order + j];
                x[i * order + j] -= factor * x[p * order + j];
            }
        }
    }
    return 0;
}

/* ---- Riccati equation ------------------------------------------------- */

/*
 * Work matrices [n][n] of the structured doubling iteration that solves the Riccati equation of the
 * vibration observer, with n = 3 states for each mode.
 */
typedef struct doubling {
    size_t n;
    double *a, *g, *h; /* [n][n] matrices that each iteration of the structured doubling replaces; h
                          converges to the solution of the vibration observer's Riccati equation */
    double *w, *work, *aw, *other; /* [n][n] work matrices of one iteration of the structured
                                      doubling algorithm. w: inverse of (unit matrix + g h), with
                                      the present iterates g and h; aw: product of the present
                                      iterate a and w */
    double *memory;
} doubling;

static int doubling_open(doubling *doubling, size_t order)
{
    double **const all[] = {&doubling->a,    &doubling->g,  &doubling->h,    &doubling->w,
                            &doubling->work, &doubling->aw, &doubling->other};
    const size_t count = sizeof all / sizeof *all;
    doubling->n = order;
    doubling->memory = calloc(count * order * order + 1, sizeof *doubling->memory);
    for (size_t i = 0; i < count && doubling->memory; i++)
        *all[i] = doubling->memory + i * order * order;
    return doubling->memory ? 0 : -1;
}

/*
 * Add the increment `next` to the matrix h, the iterate of the Riccati equation's doubling
 * iteration. Returns the largest entry of the increment relative to the largest entry of h, or NAN
 * where an entry is not finite.
 */
static double add_change(doubling *doubling, const double *next)
{
    double change = 0, size = 0;
    for (size_t i = 0; i < doubling->n * doubling->n; i++) {
        doubling->h[i] += next[i];
        change = fmax(change, fabs(next[i]));
        size = fmax(size, fabs(doubling->h[i]));
        if (!isfinite(doubling->h[i]))
            return (double)NAN;
    }
    symmetrise(doubling->h, doubling->n);
    return size > 0 ? change / size : 0;
}

/*
 * Do one iteration of the structured doubling for the discrete Riccati equation, whose solution is
 * the limit of h. Returns the relative change of h, or NAN where a matrix is singular.
 *   h becomes h + a' h w a,  g becomes g + a w g a',  a becomes a w a,  with w = (1 + g h)^-1.
 *   a  at first the transposed transition matrix; a' is its transpose
 *   g  at first the information of the measurement
 *   h  at first the process noise
 */
static double double_once(doubling *doubling)
{
    const size_t order = doubling->n;
    multiply(doubling->work, doubling->g, doubling->h, order, false);
    for (size_t i = 0; i < order; i++)
        doubling->work[i * order + i] += 1;
    if (invert(doubling->work, doubling->w, order) != 0)
        return (double)NAN;
    multiply(doubling->aw, doubling->a, doubling->w, order, false);
    multiply(doubling->work, doubling->w, doubling->a, order, false);
    multiply(doubling->other, doubling->h, doubling->work, order, false);
    multiply(doubling->work, doubling->a, doubling->other, order, true);
    const double change = add_change(doubling, doubling->work);
    multiply(doubling->work, doubling->aw, doubling->g, order, false);
    for (size_t i = 0; i < order; i++)
        for (size_t j = 0; j < order; j++)
            for (size_t k = 0; k < order; k++)
                doubling->g[i * order + j] +=
                    doubling->work[i * order + k] * doubling->a[j * order + k];
    symmetrise(doubling->g, order);
    multiply(doubling->work, doubling->aw, doubling->a, order, false);
    memcpy(doubling->a, doubling->work, order * order * sizeof *doubling->a);
    return change;
}

/*
 * Set the initial iterates of the doubling iteration for the vibration observer's Riccati equation:
 * transposed transition matrix, measurement information and process noise of the vibration modes.
 */
static void start_doubling(doubling *doubling, const damper_model *model,
                           const damper_settings *settings)
{
    const size_t modes = model->modes, all = 3 * modes;
    for (size_t i = 0; i < modes; i++) {
        double r[4];
        const double fall = model->angle[0] / model->angle[i] / sqrt((double)model->sensors);
        const double kick = settings->kick * fall, drift = settings->drift * fall;
        modal_propagator(model->angle[i], model->ratio[i], 1, r);
        doubling->a[i * all + i] = r[0];
        doubling->a[(modes + i) * all + i] = r[1];
        doubling->a[(2 * modes + i) * all + i] = 1 - r[0];
        doubling->a[i * all + modes + i] = r[2];
        doubling->a[(modes + i) * all + modes + i] = r[3];
        doubling->a[(2 * modes + i) * all + modes + i] = -r[2];
        doubling->a[(2 * modes + i) * all + 2 * modes + i] = 1;
        doubling->h[i * all + i] = position_noise;
        doubling->h[(modes + i) * all + modes + i] = kick * kick;
        doubling->h[(2 * modes + i) * all + 2 * modes + i] = drift * drift;
        for (size_t j = 0; j < modes; j++)
            doubling->g[i * all + j] = model->overlap[i * modes + j];
    }
}

/*
 * Compute the gains of the observer of vibration modes from the covariance of the observer's error.
 *   observer [3 modes][modes] out  gains by which the position, the velocity and the static
 *                                  position under loads of each mode are corrected
 */
static int fill_observer(double *observer, doubling *doubling, const damper_model *model)
{
    const size_t modes = model->modes, all = 3 * modes;
    for (size_t i = 0; i < modes; i++)
        for (size_t j = 0; j < modes; j++) {
            double sum = i == j ? 1 : 0;
            for (size_t k = 0; k < modes; k++)
                sum += model->overlap[i * modes + k] * doubling->h[k * all + j];
            doubling->work[i * modes + j] = sum;
        }
    if (invert(doubling->work, doubling->w, modes) != 0)
        return -1;
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < modes; j++) {
            observer[i * modes + j] = 0;
            for (size_t k = 0; k < modes; k++)
                observer[i * modes + j] += doubling->h[i * all + k] * doubling->w[k * modes + j];
        }
    return 0;
}

static int solve_observer(damper_gains *gains, const damper_model *model,
                          const damper_settings *settings)
{
    doubling doubling;
    double change = 1;
    if (doubling_open(&doubling, 3 * model->modes) != 0)
        return -1;
    start_doubling(&doubling, model, settings);
    for (int i = 0; i < DOUBLINGS && change > converged; i++)
        change = double_once(&doubling);
    const int failed =
        change <= 100 * converged ? fill_observer(gains->observer, &doubling, model) : -1;
    if (!failed && gains->covariance)
        memcpy(gains->covariance, doubling.h, doubling.n * doubling.n * sizeof *doubling.h);
    free(doubling.memory);
    return failed;
}

/*
 * Compute the matrix that fits modal coordinates to readings by least squares: the inverse of the
 * slightly regularised normal matrix model->overlap.
 *   explain [modes][modes] out  this matrix
 */
static int fill_explain(double *explain, const damper_model *model)
{
    const size_t modes = model->modes;
    double *copy = malloc((modes * modes + 1) * sizeof *copy), trace = 0;
    if (!copy)
        return -1;
    memcpy(copy, model->overlap, modes * modes * sizeof *copy);
    for (size_t i = 0; i < modes; i++)
        trace += copy[i * modes + i];
    for (size_t i = 0; i < modes; i++)
        copy[i * modes + i] += ridge * trace / (double)modes;
    const int failed = invert(copy, explain, modes);
    free(copy);
    return failed;
}

/* ---- damping ---------------------------------------------------------- */

/*
 * Change of a vibration mode's static equilibrium that the control tick commands to damp the mode,
 * per unit of the mode's deviation from its equilibrium.
 *   angle in  phase angle of the mode in a tick, angular frequency times tick interval (rad)
 */
static double damping_of(double angle, const damper_settings *settings)
{
    const double fade = fmin(fmax(2 - angle / settings->cut, 0), 1);
    return settings->damping * angle * fade;
}

static void fill_damping(double *damping, const damper_model *model,
                         const damper_settings *settings)
{
    for (size_t i = 0; i < model->modes; i++) {
        const double part = damping_of(model->angle[i], settings);
        for (size_t j = 0; j < model->inputs; j++) {
            const double gradient = settings->is_gradient
                                        ? model->square[i] * model->modal[i * model->inputs + j]
                                        : model->lift[j * model->modes + i];
            damping[i * model->inputs + j] = part * gradient;
        }
    }
}

int damper_compute(damper_gains *gains, const damper_model *model, const damper_settings *settings)
{
    const size_t modes = model->modes;
    for (size_t i = 0; i < modes; i++) {
        double r[4];
        modal_propagator(model->angle[i], model->ratio[i], 1, r);
        for (size_t k = 0; k < 4; k++)
            gains->turn[k * modes + i] = r[k];
        gains->inverse_angle[i] = 1 / model->angle[i];
    }
    fill_damping(gains->damping, model, settings);
    gains->share = settings->follow_limit;
    if (modes > 0)
        gains->share = fmin(settings->follow * model->angle[0], settings->follow_limit);
    gains->mix = settings->mix;
    gains->slow = settings->slow;
    if (modes == 0)
        return 0;
    return solve_observer(gains, model, settings) == 0 ? fill_explain(gains->explain, model) : -1;
}
