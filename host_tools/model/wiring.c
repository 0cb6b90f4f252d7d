/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Faults of electrodes and cables (wiring_find of calibrate.h).
 *
 * Each electrode e has a gain g_e and hangs on an amplifier a(e), so that the shapes are
 * S = sum_e g_e V_a(e) B_e'. For any wiring a, the gains are a linear least-squares problem whose
 * matrix has the entries (V'V)_a(e)a(f) (B'B)_ef. Two cables are swapped where exchanging them
 * lowers the squares that remain; afterwards a gain near 0 is a dead electrode and a negative one a
 * reversed wire.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "calibrate.h"

/* Largest number of actuators for which swapped cables are looked for. */
enum { SWAP_ACTUATORS = 128 };

/*
 * Gains below this part of the median are those of dead electrodes, below its negative those of
 * reversed wires; the standard error of the gain must be smaller than half of this part.
 */
static const double dead_gain = 0.3;

/* Standard deviation of gains relative to their common mean, before anything is measured. */
static const double gain_spread = 1;

/* Arrays of one search; one allocation, at `voltages`. */
typedef struct wiring {
    size_t n;
    double *voltages;  /* [n][n] V'V of the amplifiers */
    double *shapes;    /* [n][n] B'B of the electrodes */
    double *products;  /* [n][n] V'S B: amplifier, electrode */
    double *matrix;    /* [n][n] normal equations, then their Cholesky factor */
    double *gain;      /* [n] right-hand side, then the gains */
    double *work;      /* [n] */
    size_t *amplifier; /* [n] a(e) */
    double squares;    /* of the shapes */
    double entries;    /* number of the shapes' values */
    double variance;   /* of the noise */
} wiring;

/* ---- sums ------------------------------------------------------------- */

static int wiring_open(wiring *w, const pokes *pokes)
{
    const size_t n = pokes->actuators;
    memset(w, 0, sizeof *w);
    w->n = n;
    w->entries = (double)(pokes->count * pokes->outputs);
    w->voltages = calloc(4 * n * n + 2 * n + 1, sizeof *w->voltages);
    w->amplifier = calloc(n + 1, sizeof *w->amplifier);
    if (!w->voltages || !w->amplifier)
        return -1;
    w->shapes = w->voltages + n * n;
    w->products = w->shapes + n * n;
    w->matrix = w->products + n * n;
    w->gain = w->matrix + n * n;
    w->work = w->gain + n;
    for (size_t e = 0; e < n; e++)
        w->amplifier[e] = e;
    return 0;
}

static void wiring_close(wiring *w)
{
    free(w->voltages);
    free(w->amplifier);
}

static void fill_sums(wiring *w, const pokes *pokes, const double *model)
{
    const size_t n = w->n, m = pokes->outputs;
    for (size_t i = 0; i < m; i++)
        for (size_t e = 0; e < n; e++)
            for (size_t f = 0; f < n; f++)
                w->shapes[e * n + f] += model[i * n + e] * model[i * n + f];
    for (size_t p = 0; p < pokes->count; p++) {
        const double *v = pokes->voltage + p * n, *s = pokes->shape + p * m;
        for (size_t e = 0; e < n; e++) {
            double along = 0;
            for (size_t i = 0; i < m; i++)
                along += model[i * n + e] * s[i];
            for (size_t a = 0; a < n; a++) {
                w->products[a * n + e] += v[a] * along;
                w->voltages[a * n + e] += v[a] * v[e];
            }
        }
        for (size_t i = 0; i < m; i++)
            w->squares += s[i] * s[i];
    }
}

/* ---- gains ------------------------------------------------------------ */

/* Cholesky factor of `matrix` in its lower triangle; `matrix` is positive definite. */
static void factor(wiring *w)
{
    const size_t n = w->n;
    for (size_t j = 0; j < n; j++)
        for (size_t i = j; i < n; i++) {
            double sum = w->matrix[i * n + j];
            for (size_t k = 0; k < j; k++)
                sum -= w->matrix[i * n + k] * w->matrix[j * n + k];
            w->matrix[i * n + j] = i == j ? sqrt(fmax(sum, 1e-300)) : sum / w->matrix[j * n + j];
        }
}

static void substitute(const wiring *w, double *x)
{
    const size_t n = w->n;
    for (size_t j = 0; j < n; j++) {
        for (size_t k = 0; k < j; k++)
            x[j] -= w->matrix[j * n + k] * x[k];
        x[j] /= w->matrix[j * n + j];
    }
    for (size_t j = n; j-- > 0;) {
        for (size_t k = j + 1; k < n; k++)
            x[j] -= w->matrix[k * n + j] * x[k];
        x[j] /= w->matrix[j * n + j];
    }
}

static double normal_entry(const wiring *w, size_t e, size_t f)
{
    return w->voltages[w->amplifier[e] * w->n + w->amplifier[f]] * w->shapes[e * w->n + f];
}

static double right_side(const wiring *w, size_t e)
{
    return w->products[w->amplifier[e] * w->n + e];
}

/* Common gain of all electrodes that fits best. */
static double common_gain(const wiring *w)
{
    double with_shape = 0, size = 0;
    for (size_t e = 0; e < w->n; e++) {
        with_shape += right_side(w, e);
        for (size_t f = 0; f < w->n; f++)
            size += normal_entry(w, e, f);
    }
    return size > 0 ? with_shape / size : 1;
}

/*
 * Gains for the present wiring. They are drawn to the common gain by the variance of the noise, so
 * that a gain that the pokes leave open keeps the common one. Returns the squares that remain.
 */
static double find_gains(wiring *w)
{
    const size_t n = w->n;
    const double common = common_gain(w),
                 pull = w->variance / (gain_spread * gain_spread * common * common);
    double left = w->squares, size = 0;
    for (size_t e = 0; e < n; e++)
        size = fmax(size, normal_entry(w, e, e));
    for (size_t e = 0; e < n; e++) {
        for (size_t f = 0; f < n; f++)
            w->matrix[e * n + f] = normal_entry(w, e, f);
        w->matrix[e * n + e] += pull + 1e-12 * size;
        w->gain[e] = right_side(w, e) + (pull + 1e-12 * size) * common;
    }
    factor(w);
    substitute(w, w->gain);
    for (size_t e = 0; e < n; e++) {
        double sum = 0;
        for (size_t f = 0; f < n; f++)
            sum += normal_entry(w, e, f) * w->gain[f];
        left += w->gain[e] * (sum - 2 * right_side(w, e));
    }
    return fmax(left, 0);
}

/* ---- faults ----------------------------------------------------------- */

static void exchange(wiring *w, size_t e, size_t f)
{
    const size_t kept = w->amplifier[e];
    w->amplifier[e] = w->amplifier[f];
    w->amplifier[f] = kept;
}

/* Find the best exchange of two cables. Returns whether it lowers the squares enough. */
static bool find_swap(wiring *w, wiring_fault *fault)
{
    const double before = find_gains(w);
    double least = before;
    for (size_t e = 0; e < w->n; e++)
        for (size_t f = e + 1; f < w->n; f++) {
            exchange(w, e, f);
            const double left = find_gains(w);
            exchange(w, e, f);
            if (left < least) {
                least = left;
                *fault = (wiring_fault){WIRING_SWAPPED, e, f};
            }
        }
    return least < (1 - WIRING_GAIN) * before;
}

static int ascending(const void *left, const void *right)
{
    const double x = *(const double *)left, y = *(const double *)right;
    return (x > y) - (x < y);
}

static double median_gain(wiring *w)
{
    memcpy(w->work, w->gain, w->n * sizeof *w->work);
    qsort(w->work, w->n, sizeof *w->work, ascending);
    return w->work[w->n / 2];
}

/* Standard error of a gain, by the factor of the last find_gains. */
static double gain_error(wiring *w, size_t e)
{
    memset(w->work, 0, w->n * sizeof *w->work);
    w->work[e] = 1;
    substitute(w, w->work);
    return sqrt(fmax(w->variance * w->work[e], 0));
}

/* Dead electrodes and reversed wires by their gains. Returns the number of all faults. */
static int find_gain_faults(wiring *w, wiring_fault *fault, int faults)
{
    (void)find_gains(w);
    const double median = median_gain(w);
    for (size_t e = 0; e < w->n && faults < WIRING_FAULTS; e++) {
        const double gain = w->gain[e] / median;
        if (gain > dead_gain || gain_error(w, e) > dead_gain / 2 * fabs(median))
            continue;
        const wiring_fault_type type = gain < -dead_gain ? WIRING_REVERSED : WIRING_DEAD;
        fault[faults++] = (wiring_fault){type, e, e};
    }
    return faults;
}

/* Apply a fault to the columns of a matrix. matrix [rows][n] in/out */
static void change_columns(const wiring_fault *fault, size_t rows, size_t n, double *matrix)
{
    for (size_t i = 0; i < rows; i++) {
        double *own = matrix + i * n + fault->actuator, *other = matrix + i * n + fault->other;
        const double kept = *own;
        if (fault->type == WIRING_SWAPPED) {
            *own = *other;
            *other = kept;
        } else {
            *own = fault->type == WIRING_DEAD ? 0 : -kept;
        }
    }
}

void wiring_apply(const wiring_fault *fault, int faults, const pokes *pokes, double *voltage)
{
    memcpy(voltage, pokes->voltage, pokes->count * pokes->actuators * sizeof *voltage);
    for (int f = 0; f < faults; f++)
        change_columns(&fault[f], pokes->count, pokes->actuators, voltage);
}

int wiring_find(wiring_fault fault[WIRING_FAULTS], const pokes *pokes, const double *model)
{
    wiring w;
    int faults = 0;
    if (wiring_open(&w, pokes) < 0) {
        wiring_close(&w);
        return -1;
    }
    fill_sums(&w, pokes, model);
    while (faults < WIRING_FAULTS && w.n <= SWAP_ACTUATORS && find_swap(&w, &fault[faults])) {
        exchange(&w, fault[faults].actuator, fault[faults].other);
        faults++;
    }
    const double free_values = fmax(w.entries - (double)w.n, 1);
    w.variance = find_gains(&w) / free_values;
    faults = find_gain_faults(&w, fault, faults);
    wiring_close(&w);
    return faults;
}

void wiring_matrix(const wiring_fault *fault, int faults, const pokes *pokes, double *influence,
                   double *error)
{
    for (int f = faults - 1; f >= 0; f--) {
        change_columns(&fault[f], pokes->outputs, pokes->actuators, influence);
        change_columns(&fault[f], 1, pokes->actuators, error);
    }
    for (size_t k = 0; k < pokes->actuators; k++)
        error[k] = fabs(error[k]);
}
