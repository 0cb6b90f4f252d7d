/* SPDX-License-Identifier: BSD-2-Clause */
/* Measured vibration modes compared with a measured influence matrix (matrix_modes.h). */
#include "matrix_modes.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/linalg.h"

/*
 * Largest number of swaps of two rows of the influence matrix, in the search for outputs that stand
 * in another order in the matrix than in the mode shapes.
 */
enum { SWAPS = 40 };

/*
 * Smallest norm of what remains of a mode shape after its parts along all lower mode shapes are
 * removed, relative to the norm of the shape. Below it, the outputs cannot distinguish the mode
 * from the lower modes.
 */
static const double distinct = 1e-6;

/*
 * Limits for the search of swapped outputs (rows of the influence matrix). The search goes on while
 * a swap lowers the fraction that the mode shapes leave unexplained by more than `least_gain` times
 * this fraction, or by more than MATRIX_SWAP_BAR times what they leave of an average pair of
 * outputs (swap_gain), and by more than `rounding`.
 */
static const double least_gain = 0.05, rounding = 1e-9;

/* ---- responses ------------------------------------------------------------ */

int matrix_modes_basis(const scene_influence *measured, double *basis, double *triangle)
{
    const size_t outputs = (size_t)measured->outputs, modes = (size_t)measured->modes;
    for (size_t k = 0; k < modes; k++) {
        double *vector = basis + k * outputs;
        memcpy(vector, measured->mode[k].shape, outputs * sizeof *vector);
        const double before = sqrt(pzs_linalg_inner(vector, vector, (uint32_t)outputs));
        for (int repeat = 0; repeat < 2; repeat++)
            for (size_t j = 0; j < k; j++) {
                const double part =
                    pzs_linalg_inner(basis + j * outputs, vector, (uint32_t)outputs);
                triangle[j * modes + k] += part;
                for (size_t i = 0; i < outputs; i++)
                    vector[i] -= part * basis[j * outputs + i];
            }
        const double size = sqrt(pzs_linalg_inner(vector, vector, (uint32_t)outputs));
        if (!(size > distinct * before))
            return (int)k;
        triangle[k * modes + k] = size;
        for (size_t i = 0; i < outputs; i++)
            vector[i] /= size;
    }
    return -1;
}

/*
 * Scalar product of one mode shape vector of the orthonormal basis with one column of the influence
 * matrix.
 *   vector [outputs] in  vector of the basis
 */
static double along_basis(const scene_influence *measured, size_t amplifiers, size_t amplifier,
                          const double *vector)
{
    double sum = 0;
    for (size_t i = 0; i < (size_t)measured->outputs; i++)
        sum += vector[i] * measured->matrix[i * amplifiers + amplifier];
    return sum;
}

void matrix_modes_response(const scene_influence *measured, size_t amplifiers, size_t amplifier,
                           const double *basis, const double *triangle, double *response)
{
    const size_t outputs = (size_t)measured->outputs, modes = (size_t)measured->modes;
    for (size_t k = modes; k-- > 0;) {
        if (measured->mode[k].response) {
            response[k] = measured->mode[k].response[amplifier];
            continue;
        }
        response[k] = along_basis(measured, amplifiers, amplifier, basis + k * outputs);
        for (size_t j = k + 1; j < modes; j++)
            response[k] -= triangle[k * modes + j] * response[j];
        response[k] /= triangle[k * modes + k];
    }
}

/* ---- shares --------------------------------------------------------------- */

/*
 * Influence matrix and orthonormal basis of the mode shapes, with the work arrays of their
 * comparison.
 */
typedef struct comparison {
    const scene_influence *measured;
    size_t outputs, modes, amplifiers;
    double size;      /* sum of the squares of all entries of the influence matrix */
    double *matrix;   /* [outputs][amplifiers] copy of the influence matrix, in which the search for
                         outputs in the wrong order swaps pairs of rows */
    double *basis;    /* [modes][outputs] orthonormal basis of the mode shapes */
    double *triangle; /* [modes][modes] coefficients of the mode shapes in an orthonormal basis of
                         their span */
    double *part; /* [modes][amplifiers] orthonormal basis of the mode shapes times influence matrix
                   */
    double *seen; /* [outputs][modes] product B (Q B)' of the influence matrix B
                     [outputs][amplifiers] and the orthonormal basis Q [modes][outputs] of the mode
                     shapes */
    double *response; /* [modes] work vector for the static responses of the vibration modes to one
                         amplifier */
} comparison;

static bool take_memory(comparison *c)
{
    const size_t count = c->outputs * c->amplifiers + 2 * c->modes * c->outputs +
                         c->modes * (c->modes + c->amplifiers + 1);
    c->matrix = calloc(count + 1, sizeof *c->matrix);
    if (!c->matrix)
        return false;
    memcpy(c->matrix, c->measured->matrix, c->outputs * c->amplifiers * sizeof *c->matrix);
    c->basis = c->matrix + c->outputs * c->amplifiers;
    c->seen = c->basis + c->modes * c->outputs;
    c->triangle = c->seen + c->modes * c->outputs;
    c->part = c->triangle + c->modes * c->modes;
    c->response = c->part + c->modes * c->amplifiers;
    return true;
}

/*
 * Compute the shares of the influence matrix (of the sum of its squared entries) that each
 * vibration mode and all modes together explain, and whether each of its columns agrees with them.
 */
static void find_shares(const comparison *c, matrix_modes *found)
{
    double left = 0;
    for (size_t amplifier = 0; amplifier < c->amplifiers; amplifier++) {
        double product = 0, column = 0, modes = 0;
        matrix_modes_response(c->measured, c->amplifiers, amplifier, c->basis, c->triangle,
                              c->response);
        for (size_t i = 0; i < c->outputs; i++) {
            const double entry = c->matrix[i * c->amplifiers + amplifier];
            double sum = 0;
            for (size_t k = 0; k < c->modes; k++) {
                const double part = c->measured->mode[k].shape[i] * c->response[k];
                found->of_mode[k] += part * part / c->size;
                sum += part;
            }
            left += (entry - sum) * (entry - sum);
            product += entry * sum;
            column += entry * entry;
            modes += sum * sum;
        }
        found->cosine[amplifier] = product / (sqrt(column) * sqrt(modes));
    }
    found->share = 1 - left / c->size;
}

/* ---- swapped outputs ------------------------------------------------------ */

/*
 * Compute the products of the orthonormal basis of the mode shapes with the influence matrix.
 * Returns the fraction of the squared entries of the influence matrix that no combination of the
 * mode shapes represents.
 */
static double find_rest(const comparison *c)
{
    double explained = 0;
    memset(c->part, 0, c->modes * c->amplifiers * sizeof *c->part);
    for (size_t k = 0; k < c->modes; k++)
        for (size_t i = 0; i < c->outputs; i++)
            for (size_t j = 0; j < c->amplifiers; j++)
                c->part[k * c->amplifiers + j] +=
                    c->basis[k * c->outputs + i] * c->matrix[i * c->amplifiers + j];
    for (size_t k = 0; k < c->modes * c->amplifiers; k++)
        explained += c->part[k] * c->part[k];
    for (size_t i = 0; i < c->outputs; i++)
        for (size_t k = 0; k < c->modes; k++)
            c->seen[i * c->modes + k] =
                pzs_linalg_inner(c->part + k * c->amplifiers, c->matrix + i * c->amplifiers,
                                 (uint32_t)c->amplifiers);
    return fmax(1 - explained / c->size, 0);
}

/*
 * Return by how much the explained fraction |Q B|^2/|B|^2 of the influence matrix B
 * [outputs][amplifiers] grows if its rows i and j are swapped, with the orthonormal basis Q
 * [modes][outputs] of the mode shapes. The swap adds (column i - column j of Q)(row j - row i of B)
 * to Q B.
 */
static double gain_of_swap(const comparison *c, size_t i, size_t j)
{
    const double *first = c->matrix + i * c->amplifiers, *second = c->matrix + j * c->amplifiers;
    double turned = 0, product = 0, square = 0;
    for (size_t k = 0; k < c->modes; k++) {
        const double difference = c->basis[k * c->outputs + i] - c->basis[k * c->outputs + j];
        turned += difference * difference;
        product += difference * (c->seen[j * c->modes + k] - c->seen[i * c->modes + k]);
    }
    for (size_t k = 0; k < c->amplifiers; k++)
        square += (second[k] - first[k]) * (second[k] - first[k]);
    return (2 * product + turned * square) / c->size;
}

/*
 * Find the pair of outputs (rows of the influence matrix) whose swap lets the mode shapes explain
 * most of the influence matrix. Returns the growth of the explained share.
 */
static double best_swap(const comparison *c, size_t pair[2])
{
    double most = 0;
    for (size_t i = 0; i < c->outputs; i++)
        for (size_t j = 0; j < i; j++) {
            const double gain = gain_of_swap(c, i, j);
            if (!(gain > most))
                continue;
            most = gain;
            pair[0] = j;
            pair[1] = i;
        }
    return most;
}

static void swap_rows(const comparison *c, const size_t pair[2])
{
    double *first = c->matrix + pair[0] * c->amplifiers,
           *second = c->matrix + pair[1] * c->amplifiers;
    for (size_t k = 0; k < c->amplifiers; k++) {
        const double kept = first[k];
        first[k] = second[k];
        second[k] = kept;
    }
}

/*
 * Return the fraction `gain` of the squared entries of the influence matrix that a swap explains,
 * over the fraction that remains unexplained of two average outputs, in units of what chance
 * reaches with few amplifiers.
 *   rest in  fraction that the mode shapes leave unexplained of all outputs after the swap
 */
static double relative_gain(const comparison *c, double gain, double rest)
{
    const double pair = 2 * fmax(rest, rounding) / (double)c->outputs;
    return gain / pair / (1 + 8 / (double)c->amplifiers);
}

/*
 * Swap pairs of outputs (rows of the influence matrix) as long as each swap lets the mode shapes
 * explain clearly more of the influence matrix.
 */
static void find_swaps(const comparison *c, matrix_modes *found)
{
    double first = 0;
    while (found->swaps < SWAPS && c->outputs <= MATRIX_SWAPPED_OUTPUTS && c->amplifiers > 1) {
        size_t pair[2] = {0, 0};
        const double gain = best_swap(c, pair), left = found->swapped_rest - gain;
        const bool is_clear = relative_gain(c, gain, left) > MATRIX_SWAP_BAR;
        if (!(gain > rounding && (is_clear || gain > least_gain * found->swapped_rest)))
            break;
        if (found->swaps++ == 0) {
            found->swapped[0] = (int)pair[0];
            found->swapped[1] = (int)pair[1];
            first = gain;
        }
        swap_rows(c, pair);
        found->swapped_rest = find_rest(c);
    }
    found->swap_gain = relative_gain(c, first, found->swapped_rest);
}

/*
 * Compute the sum of the entries of a vector, and the sum of their squares.
 *   stride in  distance of the entries in the array
 */
static void sum_up(const double *value, size_t count, size_t stride, double *sum, double *squares)
{
    *sum = *squares = 0;
    for (size_t i = 0; i < count; i++) {
        *sum += value[i * stride];
        *squares += value[i * stride] * value[i * stride];
    }
}

/*
 * Return the fraction of the influence matrix's squared entries that the mode shapes would leave
 * unexplained on average with the outputs in random order. A vector x of their orthonormal basis
 * explains (x . y)^2 of a column y with n entries; its mean over all orders is
 *   |x|^2 |y|^2/n + (sum(x)^2 - |x|^2)(sum(y)^2 - |y|^2)/(n (n - 1)).
 */
static double random_rest(const comparison *c)
{
    const double n = (double)c->outputs;
    double explained = 0, sum, squares, column_sum, column_squares;
    for (size_t k = 0; k < c->modes; k++) {
        sum_up(c->basis + k * c->outputs, c->outputs, 1, &sum, &squares);
        for (size_t j = 0; j < c->amplifiers; j++) {
            sum_up(c->matrix + j, c->outputs, c->amplifiers, &column_sum, &column_squares);
            explained += squares * column_squares / n;
            if (c->outputs > 1)
                explained += (sum * sum - squares) * (column_sum * column_sum - column_squares) /
                             (n * (n - 1));
        }
    }
    return 1 - explained / c->size;
}

int matrix_modes_find(matrix_modes *found, const scene_influence *measured, size_t amplifiers,
                      bool with_swaps)
{
    comparison c = {.measured = measured,
                    .outputs = (size_t)measured->outputs,
                    .modes = (size_t)measured->modes,
                    .amplifiers = amplifiers};
    memset(found, 0, sizeof *found);
    found->of_mode = calloc(c.modes + 1, sizeof *found->of_mode);
    for (size_t i = 0; i < c.outputs * amplifiers; i++)
        c.size += measured->matrix[i] * measured->matrix[i];
    found->cosine = calloc(amplifiers + 1, sizeof *found->cosine);
    const bool is_ready = found->of_mode && found->cosine && take_memory(&c) && c.size > 0 &&
                          matrix_modes_basis(measured, c.basis, c.triangle) < 0;
    if (is_ready) {
        find_shares(&c, found);
        found->random_rest = random_rest(&c);
        found->rest = found->swapped_rest = find_rest(&c);
        if (with_swaps)
            find_swaps(&c, found);
    }
    free(c.matrix);
    return is_ready ? 0 : -1;
}

void matrix_modes_free(matrix_modes *found)
{
    free(found->of_mode);
    free(found->cosine);
    memset(found, 0, sizeof *found);
}
