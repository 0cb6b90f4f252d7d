/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Search for faults of electrodes and cables (wiring_find in calibrate.h). For any wiring a, the
 * gains g_e are the linear least-squares fit to the measured shapes
 *   S = sum over electrodes e of g_e V_a(e) B_e'.
 *   a(e)    amplifier to which electrode e is connected
 *   V_a(e)  voltages of this amplifier in all measurements
 *   B_e     column of the model's influence matrix
 * Cables are swapped where that lowers the sum of squares. Then a gain near 0 shows a dead
 * electrode, a negative gain a reversed wire.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "calibrate.h"

/* Largest number of actuators for which swapped cables are searched. */
enum { SWAP_ACTUATORS = 128 };

/*
 * Fraction of the median gain of the electrodes (ratio of actual to model influence): smaller gains
 * are those of dead electrodes, gains below the negative of this value those of reversed wires. The
 * standard error of such a gain must be smaller than half of this value.
 */
static const double dead_gain = 0.3;

/*
 * Prior standard deviation of the electrodes' gains (ratios of actual to model influence) relative
 * to their common mean.
 */
static const double gain_spread = 1;

/*
 * Arrays of one search for wiring faults: which amplifier drives which electrode. There are as many
 * electrodes as amplifiers. All arrays are parts of one allocation that begins at `voltages`.
 */
typedef struct wiring {
    size_t amplifiers;
    double *voltages; /* [amplifiers][amplifiers] scalar products of the voltages of each pair of
                         amplifiers, summed over all pokes (shapes measured under known voltages)
                         (V2) */
    double *shapes;   /* [amplifiers][amplifiers] scalar products of each pair of columns of the
                         model's influence matrix */
    double *products; /* [amplifiers][amplifiers] right-hand sides of the normal equations for the
                         gains, if electrode k is connected to amplifier i: entry (i, k) is a sum
                         over all measured shapes, of the voltage of amplifier i times the scalar
                         product of the shape and column k of the model */
    double *matrix; /* [amplifiers][amplifiers] matrix of the normal equations for the gains of the
                       electrodes, which its Cholesky factor replaces */
    double *gain;   /* [amplifiers] right-hand side of the normal equations, then gain of each
                       electrode (ratio of its actual to its model influence) */
    double *work;   /* [amplifiers] work vector for one column of the normal equations for the
                       electrodes' gains (ratios of actual to model influence) */
    size_t *amplifier; /* [amplifiers] index of the amplifier to which each electrode is connected
                        */
    double squares;    /* sum of the squares of all displacements in the shapes measured under known
                          voltages */
    double entries;    /* number of all measured displacements: outputs times measured shapes */
    double variance;   /* estimated variance of the measurement noise of one displacement */
} wiring;

/* ---- sums ------------------------------------------------------------- */

static int wiring_open(wiring *wiring, const pokes *pokes)
{
    const size_t actuators = pokes->actuators;
    memset(wiring, 0, sizeof *wiring);
    wiring->amplifiers = actuators;
    wiring->entries = (double)(pokes->count * pokes->outputs);
    wiring->voltages =
        calloc(4 * actuators * actuators + 2 * actuators + 1, sizeof *wiring->voltages);
    wiring->amplifier = calloc(actuators + 1, sizeof *wiring->amplifier);
    if (!wiring->voltages || !wiring->amplifier)
        return -1;
    wiring->shapes = wiring->voltages + actuators * actuators;
    wiring->products = wiring->shapes + actuators * actuators;
    wiring->matrix = wiring->products + actuators * actuators;
    wiring->gain = wiring->matrix + actuators * actuators;
    wiring->work = wiring->gain + actuators;
    for (size_t actuator = 0; actuator < actuators; actuator++)
        wiring->amplifier[actuator] = actuator;
    return 0;
}

static void wiring_close(wiring *wiring)
{
    free(wiring->voltages);
    free(wiring->amplifier);
}

static void fill_sums(wiring *wiring, const pokes *pokes, const double *model)
{
    const size_t actuators = wiring->amplifiers, outputs = pokes->outputs;
    for (size_t i = 0; i < outputs; i++)
        for (size_t row = 0; row < actuators; row++)
            for (size_t column = 0; column < actuators; column++)
                wiring->shapes[row * actuators + column] +=
                    model[i * actuators + row] * model[i * actuators + column];
    for (size_t poke = 0; poke < pokes->count; poke++) {
        const double *voltage = pokes->voltage + poke * actuators,
                     *shape = pokes->shape + poke * outputs;
        for (size_t row = 0; row < actuators; row++) {
            double along = 0;
            for (size_t i = 0; i < outputs; i++)
                along += model[i * actuators + row] * shape[i];
            for (size_t other = 0; other < actuators; other++) {
                wiring->products[other * actuators + row] += voltage[other] * along;
                wiring->voltages[other * actuators + row] += voltage[other] * voltage[row];
            }
        }
        for (size_t i = 0; i < outputs; i++)
            wiring->squares += shape[i] * shape[i];
    }
}

/* ---- gains ------------------------------------------------------------ */

/*
 * Replace the lower triangle of `matrix`, the positive definite matrix of the normal equations for
 * the gains of the electrodes, by its Cholesky factor.
 */
static void factor(wiring *wiring)
{
    const size_t actuators = wiring->amplifiers;
    for (size_t j = 0; j < actuators; j++)
        for (size_t i = j; i < actuators; i++) {
            double sum = wiring->matrix[i * actuators + j];
            for (size_t k = 0; k < j; k++)
                sum -= wiring->matrix[i * actuators + k] * wiring->matrix[j * actuators + k];
            wiring->matrix[i * actuators + j] =
                i == j ? sqrt(fmax(sum, 1e-300)) : sum / wiring->matrix[j * actuators + j];
        }
}

static void substitute(const wiring *wiring, double *vector)
{
    const size_t actuators = wiring->amplifiers;
    for (size_t j = 0; j < actuators; j++) {
        for (size_t k = 0; k < j; k++)
            vector[j] -= wiring->matrix[j * actuators + k] * vector[k];
        vector[j] /= wiring->matrix[j * actuators + j];
    }
    for (size_t j = actuators; j-- > 0;) {
        for (size_t k = j + 1; k < actuators; k++)
            vector[j] -= wiring->matrix[k * actuators + j] * vector[k];
        vector[j] /= wiring->matrix[j * actuators + j];
    }
}

static double normal_entry(const wiring *wiring, size_t row, size_t column)
{
    return wiring
               ->voltages[wiring->amplifier[row] * wiring->amplifiers + wiring->amplifier[column]] *
           wiring->shapes[row * wiring->amplifiers + column];
}

static double right_side(const wiring *wiring, size_t actuator)
{
    return wiring->products[wiring->amplifier[actuator] * wiring->amplifiers + actuator];
}

/*
 * Common gain of all electrodes (ratio of actual to model influence) that fits the measured shapes
 * best in the least-squares sense.
 */
static double common_gain(const wiring *wiring)
{
    double with_shape = 0, size = 0;
    for (size_t row = 0; row < wiring->amplifiers; row++) {
        with_shape += right_side(wiring, row);
        for (size_t column = 0; column < wiring->amplifiers; column++)
            size += normal_entry(wiring, row, column);
    }
    return size > 0 ? with_shape / size : 1;
}

/*
 * Compute the gain of every electrode (ratio of its actual to its model influence) for the wiring
 * assumed at present. A prior draws each gain slightly to the common gain, the single gain of all
 * electrodes that fits the measured shapes best. Gains that the measurements do not determine thus
 * become the common gain. Returns the remaining sum of squared differences between measured and
 * model shapes.
 */
static double find_gains(wiring *wiring)
{
    const size_t actuators = wiring->amplifiers;
    const double common = common_gain(wiring),
                 pull = wiring->variance / (gain_spread * gain_spread * common * common);
    double left = wiring->squares, size = 0;
    for (size_t row = 0; row < actuators; row++)
        size = fmax(size, normal_entry(wiring, row, row));
    for (size_t row = 0; row < actuators; row++) {
        for (size_t column = 0; column < actuators; column++)
            wiring->matrix[row * actuators + column] = normal_entry(wiring, row, column);
        wiring->matrix[row * actuators + row] += pull + 1e-12 * size;
        wiring->gain[row] = right_side(wiring, row) + (pull + 1e-12 * size) * common;
    }
    factor(wiring);
    substitute(wiring, wiring->gain);
    for (size_t row = 0; row < actuators; row++) {
        double sum = 0;
        for (size_t column = 0; column < actuators; column++)
            sum += normal_entry(wiring, row, column) * wiring->gain[column];
        left += wiring->gain[row] * (sum - 2 * right_side(wiring, row));
    }
    return fmax(left, 0);
}

/* ---- faults ----------------------------------------------------------- */

static void exchange(wiring *wiring, size_t first, size_t second)
{
    const size_t kept = wiring->amplifier[first];
    wiring->amplifier[first] = wiring->amplifier[second];
    wiring->amplifier[second] = kept;
}

/*
 * Find the exchange of the cables of two electrodes that lowers the remaining sum of squared
 * differences between measured and model shapes most. Returns whether the exchange lowers the sum
 * enough to count as a fault.
 */
static bool find_swap(wiring *wiring, wiring_fault *fault)
{
    const double before = find_gains(wiring);
    double least = before;
    for (size_t first = 0; first < wiring->amplifiers; first++)
        for (size_t second = first + 1; second < wiring->amplifiers; second++) {
            exchange(wiring, first, second);
            const double left = find_gains(wiring);
            exchange(wiring, first, second);
            if (left < least) {
                least = left;
                *fault = (wiring_fault){WIRING_SWAPPED, first, second};
            }
        }
    return least < (1 - WIRING_GAIN) * before;
}

static int ascending(const void *left, const void *right)
{
    const double first = *(const double *)left, second = *(const double *)right;
    return (first > second) - (first < second);
}

static double median_gain(wiring *wiring)
{
    memcpy(wiring->work, wiring->gain, wiring->amplifiers * sizeof *wiring->work);
    qsort(wiring->work, wiring->amplifiers, sizeof *wiring->work, ascending);
    return wiring->work[wiring->amplifiers / 2];
}

/*
 * Standard error of the gain of an electrode (ratio of its actual to its model influence), from the
 * Cholesky factor of the normal equations for the gains, which find_gains has computed.
 */
static double gain_error(wiring *wiring, size_t actuator)
{
    memset(wiring->work, 0, wiring->amplifiers * sizeof *wiring->work);
    wiring->work[actuator] = 1;
    substitute(wiring, wiring->work);
    return sqrt(fmax(wiring->variance * wiring->work[actuator], 0));
}

/*
 * Find dead electrodes and reversed wires by the gains of the electrodes (ratios of actual to model
 * influence), and append them to the list of faults. Returns the number of all faults.
 */
static int find_gain_faults(wiring *wiring, wiring_fault *fault, int faults)
{
    (void)find_gains(wiring);
    const double median = median_gain(wiring);
    for (size_t actuator = 0; actuator < wiring->amplifiers && faults < WIRING_FAULTS; actuator++) {
        const double gain = wiring->gain[actuator] / median;
        if (gain > dead_gain || gain_error(wiring, actuator) > dead_gain / 2 * fabs(median))
            continue;
        const wiring_fault_type type = gain < -dead_gain ? WIRING_REVERSED : WIRING_DEAD;
        fault[faults++] = (wiring_fault){type, actuator, actuator};
    }
    return faults;
}

/*
 * Apply a wiring fault to the columns of a matrix, one for each actuator: exchange two columns,
 * negate a column or set it to 0.
 *   matrix [rows][actuators] in/out  matrix before and after the change
 */
static void change_columns(const wiring_fault *fault, size_t rows, size_t actuators, double *matrix)
{
    for (size_t i = 0; i < rows; i++) {
        double *own = matrix + i * actuators + fault->actuator,
               *other = matrix + i * actuators + fault->other;
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
    for (int index = 0; index < faults; index++)
        change_columns(&fault[index], pokes->count, pokes->actuators, voltage);
}

int wiring_find(wiring_fault fault[WIRING_FAULTS], const pokes *pokes, const double *model)
{
    wiring wiring;
    int faults = 0;
    if (wiring_open(&wiring, pokes) < 0) {
        wiring_close(&wiring);
        return -1;
    }
    fill_sums(&wiring, pokes, model);
    while (faults < WIRING_FAULTS && wiring.amplifiers <= SWAP_ACTUATORS &&
           find_swap(&wiring, &fault[faults])) {
        exchange(&wiring, fault[faults].actuator, fault[faults].other);
        faults++;
    }
    const double free_values = fmax(wiring.entries - (double)wiring.amplifiers, 1);
    wiring.variance = find_gains(&wiring) / free_values;
    faults = find_gain_faults(&wiring, fault, faults);
    wiring_close(&wiring);
    return faults;
}

void wiring_matrix(const wiring_fault *fault, int faults, const pokes *pokes, double *influence,
                   double *error)
{
    for (int index = faults - 1; index >= 0; index--) {
        change_columns(&fault[index], pokes->outputs, pokes->actuators, influence);
        change_columns(&fault[index], 1, pokes->actuators, error);
    }
    for (size_t k = 0; k < pokes->actuators; k++)
        error[k] = fabs(error[k]);
}
