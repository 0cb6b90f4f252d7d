/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Operations on the tableau of the voltage optimiser, which is the Hessian after pivot exchanges. A
 * pivot exchange moves an input between the set of free voltages and the set of voltages at a
 * bound. Exchanges are collected and applied to the matrix together; from time to time the tableau
 * is computed anew from the Hessian.
 */
#include <string.h>
#include "boxls_tableau.h"
#include "../core/lane.h"
#include "../core/numbers.h"
#include "../core/product.h"
#include "../core/product_wide.h"
#include "../core/unrolled.h"

/*
 * Number of rows and of columns of the square blocks in which the optimiser's pivoted Hessian
 * (tableau) is updated.
 */
#define BLOCK 4u
/*
 * Largest number of pivot exchanges that are collected, before they are applied together, while the
 * optimiser's pivoted Hessian (tableau) is computed.
 */
#define MANY 32u
/*
 * Number of rank-one updates that are subtracted together from a row of the optimiser's pivoted
 * Hessian (tableau).
 */
#define TOGETHER (PZS_WIDE ? 8u : 1u)

/*
 * Number of columns of the wide blocks in which the optimiser's pivoted Hessian (tableau) is
 * updated.
 */
#define BLOCK_WIDE PZS_BY_TILE(4u, 16u, 32u)

pzs_real pzs_tableau_independence(const pzs_optimiser *optimiser, uint32_t k)
{
    return optimiser->diagonal[k] > 0 ? optimiser->pivot[k] / optimiser->diagonal[k] : 0;
}

void pzs_tableau_read_pivots(pzs_optimiser *optimiser)
{
    const pzs_real *entry = optimiser->tableau;
    pzs_real *pivot = optimiser->pivot;
    const size_t step = (size_t)optimiser->width + 1u;
    if (optimiser->pending_count > 0)
        return;
    for (uint32_t i = 0, inputs = optimiser->inputs; i < inputs; i++, entry += step)
        pivot[i] = *entry;
}

static void set_multiple(pzs_real *restrict to, const pzs_real *restrict from, pzs_real factor,
                         size_t span)
{
    for (size_t i = 0; i < span; i++)
        to[i] = factor * from[i];
}

/* ---- collection of pivot exchanges ----------------------------------- */

void pzs_tableau_collect(pzs_optimiser *optimiser, pzs_real *pending)
{
    optimiser->pending = pending;
    optimiser->exchange = optimiser->collected;
    optimiser->pending_most = PZS_PENDING;
}

/*
 * For many inputs, let the optimiser collect more pivot exchanges before it applies them to its
 * tableau, which is then read and written less often. The collected exchanges are stored in arrays
 * of the dual active-set method, which are not needed while the tableau is computed:
 *   factor       three equal parts: the rank-one updates of the exchanges, and two copies of them
 *                that apply_wide makes
 *   side, order  input, sign, scale and pivot of each exchange
 */
static void collect_many(pzs_optimiser *optimiser)
{
    const uint32_t reals = optimiser->inputs * (optimiser->inputs + 1u) / 2u;
    const uint32_t fit = reals / (3u * (optimiser->width + WIDE_BLOCK));
    if (optimiser->inputs < PZS_DUAL_INPUTS || fit <= PZS_PENDING)
        return;
    optimiser->pending = optimiser->factor;
    optimiser->exchange = (void *)optimiser->side;
    optimiser->pending_most = fit < MANY ? fit : MANY;
}

/* ---- pivot exchanges ------------------------------------------------- */

/*
 * Return whether only the entries up to the diagonal of the tableau (the optimiser's pivoted
 * Hessian) are kept up to date: on a host with the vector unit AVX2, while the tableau is computed.
 */
static inline bool keeps_half(const pzs_optimiser *optimiser)
{
    return optimiser->inputs >= WIDE_HALF && product_is_wide(optimiser->width) &&
           optimiser->is_rebuilding;
}

/*
 * Read row k of the tableau (the optimiser's pivoted Hessian), without the pivot exchanges that are
 * collected but not yet applied.
 *   row [width] out  row k; its entries beyond the number of inputs may stay unchanged
 */
static inline void read_row(const pzs_optimiser *optimiser, uint32_t k, pzs_real *restrict row)
{
    const size_t width = optimiser->width, count = keeps_half(optimiser) ? k + 1u : width;
    memcpy(row, optimiser->tableau + k * width, count * sizeof *row);
    for (uint32_t j = k + 1u; keeps_half(optimiser) && j < optimiser->inputs; j++)
        row[j] = optimiser->tableau[j * width + k];
}

/*
 * Bring row k of the tableau (the optimiser's pivoted Hessian) up to date: subtract the rank-one
 * updates of up to TOGETHER collected pivot exchanges, from number `first` on.
 *   row [width] in/out  row k of the tableau
 */
static inline void subtract_updates(const pzs_optimiser *optimiser, uint32_t first, uint32_t k,
                                    pzs_real *restrict row)
{
    static const uint16_t index[] = {0, 1, 2, 3, 4, 5, 6, 7};
    const size_t width = optimiser->width;
    const pzs_real *update = optimiser->pending + first * width;
    pzs_real factor[TOGETHER];
    uint32_t count = 0;
    for (; count < TOGETHER && first + count < optimiser->pending_count; count++)
        factor[count] = optimiser->exchange[first + count].sign * update[count * width + k];
    pzs_product_subtract_rows(row, update, width, index, factor, count, optimiser_span(optimiser));
}

/*
 * Compute row k of the tableau T, the pivoted Hessian, including the pivot exchanges that are
 * collected but not yet applied. With row r of T, which belongs to input c, and its diagonal entry
 * p, the exchange of input c changes T as follows, for other inputs i and j:
 *   T_ij  becomes  T_ij - sign(p) u_i u_j,  u_i = r_i / sqrt |p|
 *   T_ic  becomes  r_i / |p|
 *   T_cc  becomes  -1 / p
 * The stored vector u has the entry u_c = -sign(p) / sqrt |p|.
 */
static void correct_row(const pzs_optimiser *optimiser, uint32_t k, pzs_real *restrict row)
{
    const size_t width = optimiser->width, span = optimiser_span(optimiser);
    uint32_t j = optimiser->pending_count;
    while (j > 0 && optimiser->exchange[j - 1u].input != k)
        j--;
    if (j > 0) {
        // If input k itself was exchanged, its row after its last exchange is a multiple of the
        // update vector of this exchange. Exchanges before that do not matter for the row.
        const pzs_exchange *own = &optimiser->exchange[j - 1u];
        set_multiple(row, optimiser->pending + (j - 1u) * width, own->scale, span);
        row[k] = own->pivot;
    } else {
        read_row(optimiser, k, row);
    }
    // The entry of row k that belongs to another input is set to zero if this input was exchanged
    // later: subtracting the update of its exchange then gives the new value of the entry.
    for (uint32_t later = j; later < optimiser->pending_count; later++)
        row[optimiser->exchange[later].input] = 0;
    for (; j < optimiser->pending_count; j += TOGETHER)
        subtract_updates(optimiser, j, k, row);
}

void pzs_tableau_row(pzs_optimiser *optimiser, uint32_t k, pzs_real *restrict row)
{
    correct_row(optimiser, k, row);
    optimiser->work += optimiser->pending_count * optimiser->width;
}

/*
 * Compute the effect of a pivot exchange on the row of the exchanged input and on the diagonal of
 * the tableau (pivoted Hessian). The caller sets the two entries of the exchanged input itself.
 *   row    [width] in/out  row of the exchanged input in the tableau before and after the exchange
 *   update [width] out     vector of the rank-one update of the tableau
 *   pivot  [width] in/out  diagonal of the tableau
 *   scale          in      1 / square root of the absolute value of the pivot (V/m)
 *   sign           in      sign of the pivot, 1 or -1
 */
static void scale_row(pzs_real *restrict row, pzs_real *restrict update, pzs_real *restrict pivot,
                      pzs_real scale, pzs_real sign, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real entry = scale * row[i];
        update[i] = entry;
        pivot[i] -= sign * entry * entry;
        row[i] = scale * entry;
    }
}

void pzs_tableau_exchange(pzs_optimiser *optimiser, uint32_t k, pzs_real *restrict row)
{
    if (optimiser->pending_count == optimiser->pending_most)
        pzs_tableau_apply(optimiser);
    const size_t width = optimiser->width, span = optimiser_span(optimiser);
    const pzs_real pivot = row[k], scale = 1 / PZS_SQRT(number_absolute(pivot));
    const pzs_real sign = pivot < 0 ? (pzs_real)-1 : (pzs_real)1;
    pzs_real *update = optimiser->pending + optimiser->pending_count * width;
    for (uint32_t j = 0; j < optimiser->pending_count; j++)
        optimiser->pending[j * width + k] = 0;
    scale_row(row, update, optimiser->pivot, scale, sign, span);
    update[k] = -sign * scale;
    row[k] = optimiser->pivot[k] = -1 / pivot;
    optimiser->exchange[optimiser->pending_count++] = (pzs_exchange){k, sign, scale, row[k]};
    // Not 1 - free_set[k], which keeps a number between 0 and 1 of damaged memory above 0.
    optimiser->free_set[k] = optimiser->free_set[k] > 0 ? 0 : 1;
    optimiser->active_count += optimiser->free_set[k] > 0 ? UINT32_MAX : 1u;
    optimiser->exchanges++;
    optimiser->inverse_trace = 0;
    optimiser->is_verified = false;
    optimiser->work += PZS_EXCHANGE_WORK(optimiser->inputs);
}

/*
 * Prepare rows i to i + most - 1 of the tableau (fewer at the end of the matrix) for the rank-one
 * updates of the collected pivot exchanges: set all entries in a row or column of an exchanged
 * input to zero. Subtracting the updates then gives these entries their new values.
 */
static void clear_exchanged(pzs_optimiser *optimiser, size_t i, size_t most)
{
    const size_t width = optimiser->width;
    const size_t rows = optimiser->inputs - i < most ? optimiser->inputs - i : most;
    pzs_real *first = optimiser->tableau + i * width;
    for (uint32_t j = 0; j < optimiser->pending_count; j++) {
        const size_t input = optimiser->exchange[j].input;
        if (input >= i && input < i + rows)
            memset(optimiser->tableau + input * width, 0, width * sizeof(pzs_real));
        // Columns from i + rows on may keep their values in the rows of other inputs, because the
        // caller updates only the columns to the left of them.
        for (size_t line = 0; input < i + rows && line < rows; line++)
            first[line * width + input] = 0;
    }
}

/*
 * Set the diagonal entries of exchanged inputs in the tableau (the optimiser's pivoted Hessian) to
 * those in the array `pivot`. The rank-one updates alone would give wrong values there.
 */
static void set_exchanged_diagonal(pzs_optimiser *optimiser)
{
    for (uint32_t j = 0; j < optimiser->pending_count; j++) {
        const size_t input = optimiser->exchange[j].input;
        optimiser->tableau[input * optimiser->width + input] = optimiser->pivot[input];
    }
}

/*
 * Copy a block of a symmetric matrix to its mirror position across the diagonal.
 *   matrix  in/out  rows of the matrix, `width` reals apart
 *   i, j    in      row and column of the first entry of the block
 *   columns in      number of columns of the block, a multiple of BLOCK
 */
static inline void mirror_block(pzs_real *matrix, size_t width, size_t i, size_t j, size_t rows,
                                size_t columns)
{
    for (size_t row = 0; row < rows; row++) {
        const pzs_real *from = matrix + (i + row) * width + j;
        pzs_real *to = matrix + j * width + i + row;
        for (size_t column = 0; column < columns; column += BLOCK) {
            UNROLLED
            for (unsigned k = 0; k < BLOCK; k++, to += width)
                *to = from[column + k];
        }
    }
}

/*
 * Define a function that applies all collected rank-one updates to one block of the tableau
 * (pivoted Hessian), kept in registers, and mirrors a block below the diagonal. The block starts at
 * row i and column j and has ROWS rows of COUNT entries of type `entry`.
 */
#define UPDATE_BLOCK(name, entry, ROWS, COUNT)                                                     \
    static void name(pzs_optimiser *optimiser, size_t i, size_t j)                                 \
    {                                                                                              \
        const size_t width = optimiser->width,                                                     \
                     columns = (COUNT) * sizeof(entry) / sizeof(pzs_real);                         \
        pzs_real *at = optimiser->tableau + i * width + j;                                         \
        entry block[ROWS][COUNT];                                                                  \
        UNROLLED                                                                                   \
        for (unsigned line = 0; line < (ROWS); line++) {                                           \
            UNROLLED                                                                               \
            for (unsigned column = 0; column < (COUNT); column++)                                  \
                block[line][column] = ((const entry *)(at + line * width))[column];                \
        }                                                                                          \
        const pzs_real *update = optimiser->pending;                                               \
        for (uint32_t k = 0; k < optimiser->pending_count; k++, update += width) {                 \
            const entry *row = (const entry *)(update + j);                                        \
            const pzs_real sign = optimiser->exchange[k].sign;                                     \
            UNROLLED                                                                               \
            for (unsigned line = 0; line < (ROWS); line++) {                                       \
                const pzs_real factor = sign * update[i + line];                                   \
                UNROLLED                                                                           \
                for (unsigned column = 0; column < (COUNT); column++)                              \
                    block[line][column] -= factor * row[column];                                   \
            }                                                                                      \
        }                                                                                          \
        UNROLLED                                                                                   \
        for (unsigned line = 0; line < (ROWS); line++) {                                           \
            UNROLLED                                                                               \
            for (unsigned column = 0; column < (COUNT); column++)                                  \
                ((entry *)(at + line * width))[column] = block[line][column];                      \
        }                                                                                          \
        if (j + columns <= i && !keeps_half(optimiser))                                            \
            mirror_block(optimiser->tableau, width, i, j, ROWS, columns);                          \
    }

UPDATE_BLOCK(update_square, pzs_real, BLOCK, BLOCK)
UPDATE_BLOCK(update_row, pzs_real, 1u, BLOCK)
#if PZS_TILE > 4
UPDATE_BLOCK(update_wide, lane, BLOCK, BLOCK_WIDE / IN_LANE)
#else
#define update_wide update_square
#endif

/*
 * On a host with AVX2, apply all collected rank-one updates to the lower triangle and the diagonal
 * of the tableau (pivoted Hessian) of an optimiser with many inputs, while the tableau is computed.
 * Returns false, without a change, on other processors, and if the updates are not stored where
 * collect_many stores them.
 */
static bool apply_wide(pzs_optimiser *optimiser)
{
    const size_t width = optimiser->width, count = optimiser->pending_count;
    if (optimiser->pending != optimiser->factor || !product_is_wide(width))
        return false;
    pzs_real *groups = optimiser->factor + optimiser->pending_most * width;
    pzs_real *factors = groups + optimiser->pending_most * (width + WIDE_BLOCK);
    // Copy the update vectors of the collected exchanges in groups of WIDE_BLOCK entries, once
    // unchanged and once multiplied by their signs.
    pzs_wide_group(groups, factors, optimiser->pending, width, &optimiser->exchange->sign,
                   sizeof *optimiser->exchange / sizeof(pzs_real), count, optimiser->inputs);
    for (size_t i = 0; i < optimiser->inputs; i += WIDE_BLOCK) {
        clear_exchanged(optimiser, i, WIDE_BLOCK);
        pzs_wide_update_rows(optimiser->tableau, width, optimiser->inputs, i, factors, groups,
                             count);
    }
    return true;
}

/*
 * On a host with the vector unit AVX2, apply all collected rank-one updates to the whole tableau
 * (pivoted Hessian) of an optimiser with few inputs. Returns whether this was done.
 */
static bool apply_whole(pzs_optimiser *optimiser)
{
    pzs_real scaled[PZS_PENDING * PZS_DUAL_INPUTS];
    long long zero[PZS_PENDING];
    const size_t inputs = optimiser->inputs, width = optimiser->width;
    if (inputs >= PZS_DUAL_INPUTS || keeps_half(optimiser) || !product_is_wide(inputs))
        return false;
    for (uint32_t j = 0; j < optimiser->pending_count; j++) {
        const pzs_exchange *exchange = &optimiser->exchange[j];
        set_multiple(scaled + j * width, optimiser->pending + j * width, exchange->sign,
                     optimiser_span(optimiser));
        memset(optimiser->tableau + exchange->input * width, 0, width * sizeof(pzs_real));
        zero[j] = exchange->input;
    }
    pzs_wide_update_whole(optimiser->tableau, width, inputs, scaled, optimiser->pending, zero,
                          optimiser->pending_count);
    return true;
}

/*
 * Apply all collected rank-one updates to the tableau (pivoted Hessian), with C code for any
 * processor. The lower triangle is updated block by block and copied to the upper one, unless only
 * half of the tableau is kept up to date. Blocks on the diagonal are computed as a whole; the last
 * rows, fewer than a block has, one by one.
 */
static void apply_to_all(pzs_optimiser *optimiser)
{
    const size_t inputs = optimiser->inputs, even = inputs & ~(size_t)(BLOCK - 1u);
    clear_exchanged(optimiser, 0, inputs);
    for (size_t i = 0; i < even; i += BLOCK) {
        size_t j = 0;
        for (; BLOCK_WIDE > BLOCK && j + BLOCK_WIDE <= i; j += BLOCK_WIDE)
            update_wide(optimiser, i, j);
        for (; j <= i; j += BLOCK)
            update_square(optimiser, i, j);
    }
    for (size_t i = even; i < inputs; i++)
        for (size_t j = 0; j <= even; j += BLOCK)
            update_row(optimiser, i, j);
}

void pzs_tableau_apply(pzs_optimiser *optimiser)
{
    if (optimiser->pending_count == 0)
        return;
    if (!apply_wide(optimiser) && !apply_whole(optimiser))
        apply_to_all(optimiser);
    set_exchanged_diagonal(optimiser);
    optimiser->pending_count = 0;
}

void pzs_tableau_complete(pzs_optimiser *optimiser)
{
    if (keeps_half(optimiser))
        pzs_wide_mirror(optimiser->tableau, optimiser->width, optimiser->inputs);
    optimiser->is_rebuilding = false;
}

/* ---- recomputation of the tableau ------------------------------------ */

void pzs_tableau_reset(pzs_optimiser *optimiser)
{
    const size_t bytes = optimiser->width * sizeof(pzs_real);
    memcpy(optimiser->tableau, optimiser->hessian, optimiser->inputs * bytes);
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        const bool waits = optimiser->is_rebuilding && optimiser->waiting[i] > 0;
        const bool was_free = optimiser->is_dual || optimiser->free_set[i] > 0;
        optimiser->waiting[i] = waits || was_free ? 1 : 0;
        optimiser->free_set[i] = 0;
    }
    optimiser->active_count = optimiser->inputs;
    optimiser->pending_count = 0;
    optimiser->exchanges = 0;
    optimiser->inverse_trace = 0;
    optimiser->is_verified = false;
    optimiser->is_rebuilding = true;
    optimiser->is_dual = false;
    optimiser->work += (uint64_t)optimiser->inputs * optimiser->width;
}

/*
 * Return the next input whose voltage becomes free again while the tableau (pivoted Hessian) is
 * recomputed: the waiting input whose effect on the shape is most independent of the effects of the
 * free inputs. Returns the number of inputs if every waiting input depends linearly on the free
 * ones.
 */
static uint32_t next_pivot(const pzs_optimiser *optimiser)
{
    pzs_real most = optimiser->pivot_floor;
    uint32_t next = optimiser->inputs;
    for (uint32_t k = 0; k < optimiser->inputs; k++) {
        if (!(optimiser->waiting[k] > 0))
            continue;
        const pzs_real independence = pzs_tableau_independence(optimiser, k);
        if (independence > most) {
            most = independence;
            next = k;
        }
    }
    return next;
}

bool pzs_tableau_rebuild(pzs_optimiser *optimiser)
{
    const uint64_t cost = PZS_ITERATION_WORK(optimiser->inputs) + (uint64_t)MANY * optimiser->width;
    pzs_real *pending = optimiser->pending;
    pzs_tableau_read_pivots(optimiser);
    collect_many(optimiser);
    bool is_complete = false;
    while (!is_complete && optimiser_affords(optimiser, cost)) {
        const uint32_t k = next_pivot(optimiser);
        is_complete = k == optimiser->inputs;
        if (!is_complete) {
            pzs_tableau_row(optimiser, k, optimiser->next_voltage);
            pzs_tableau_exchange(optimiser, k, optimiser->next_voltage);
            optimiser->waiting[k] = 0;
        }
    }
    pzs_tableau_apply(optimiser);
    if (is_complete)
        pzs_tableau_complete(optimiser);
    pzs_tableau_collect(optimiser, pending);
    optimiser->is_dual =
        !optimiser->is_rebuilding && optimiser->active_count == 0 && optimiser->dual != NULL;
    if (!optimiser->is_rebuilding && optimiser->active_count == 0)
        optimiser->whole_inverse_trace = pzs_tableau_inverse_trace(optimiser);
    return !optimiser->is_rebuilding;
}

pzs_real pzs_tableau_inverse_trace(pzs_optimiser *optimiser)
{
    if (optimiser->inverse_trace > 0)
        return optimiser->inverse_trace;
    pzs_tableau_read_pivots(optimiser);
    pzs_real soft = -pzs_product_dot(optimiser->free_set, optimiser->pivot, optimiser->width);
    const bool has_dependent = optimiser->active_count > 0 && !optimiser->is_dual;
    for (uint32_t i = 0; has_dependent && i < optimiser->inputs; i++) {
        const pzs_real least = optimiser->pivot_floor * optimiser->diagonal[i];
        if (optimiser->pivot[i] < least && !(optimiser->free_set[i] > 0))
            soft += 1 / least;
    }
    optimiser->inverse_trace = soft;
    return soft;
}
