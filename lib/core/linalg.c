/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Factorisation and solution of symmetric linear equations in envelope storage (linalg.h). The
 * factorisation L D L^T is left-looking and works on tiles of PZS_TILE x PZS_TILE entries.
 */
#include "linalg.h"
#include "linalg_wide.h"
#include "unrolled.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define REAL_MOST PZS_BY_BITS(FLT_MAX, DBL_MAX)

/*
 * Number of columns of a tile (PZS_TILE x PZS_TILE matrix entries) that are computed together, so
 * that their STRIP x PZS_TILE sums fit into the registers. The number affects only the speed.
 */
#define STRIP PZS_BY_TILE(4, 8, 8)

/*
 * Number of panels (PZS_TILE matrix rows each) in a group. The columns left of the first panel of a
 * group are eliminated from all panels of the group together. The number affects only the speed.
 */
#define GROUP 16u

/*
 * The macro MOVE copies `count` matrix entries between memory and local variables: one by one, or
 * with memcpy where the processor has wide vector registers.
 */
#if PZS_TILE == 4
#define MOVE(to, from, count) UNROLLED for (int m = 0; m < (count); m++)(to)[m] = (from)[m]
#else
#define MOVE(to, from, count) memcpy(to, from, (count) * sizeof(pzs_real))
#endif

/*
 * A pivot counts as zero only if it is below 2^-23 times its diagonal entry. In float the usual
 * bound, number of rows times machine epsilon, would reject thin shells that iterative refinement
 * still solves.
 */
#define SMALL_PIVOT ((pzs_real)1.1920928955078125e-7)

/* ---- storage ---------------------------------------------------------- */

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static pzs_real larger(pzs_real a, pzs_real b)
{
    return a > b ? a : b;
}

static uint32_t panel_count(uint32_t rows)
{
    return rows / PZS_TILE + (rows % PZS_TILE != 0u ? 1u : 0u);
}

/*
 * Return the number of stored entries of one panel (a group of PZS_TILE rows): its columns from the
 * leftmost one, rounded down to a multiple of PZS_TILE, to the end of its diagonal tile.
 */
static uint32_t panel_reals(const uint16_t *first, uint32_t rows, uint32_t panel)
{
    const uint32_t end = smaller((panel + 1u) * PZS_TILE, rows);
    uint32_t left = panel * PZS_TILE;

    for (uint32_t i = panel * PZS_TILE; i < end; i++)
        left = smaller(left, first[i]);
    return ((panel + 1u) * PZS_TILE - left / PZS_TILE * PZS_TILE) * PZS_TILE;
}

size_t pzs_linalg_reals(const uint16_t *first, uint32_t rows)
{
    size_t reals = 0;

    for (uint32_t panel = 0; panel < panel_count(rows); panel++)
        reals += panel_reals(first, rows, panel);
    return reals;
}

void pzs_linalg_layout(pzs_envelope *matrix)
{
    matrix->start[0] = 0;
    for (uint32_t panel = 0; panel < panel_count(matrix->n); panel++)
        matrix->start[panel + 1u] =
            matrix->start[panel] + panel_reals(matrix->first, matrix->n, panel);
}

/*
 * The last panel of PZS_TILE rows may extend beyond the matrix. The entries in these additional
 * rows stay zero in all operations and affect no result.
 */
void pzs_linalg_dense_layout(pzs_envelope *dense, uint32_t rows, pzs_real *work, void *index)
{
    uint32_t *start = index;
    uint16_t *first = (uint16_t *)(start + rows / PZS_TILE + 2);
    memset(first, 0, rows * sizeof *first);
    dense->n = rows;
    dense->first = first;
    dense->start = start;
    dense->inverse = work;
    dense->value = work + rows;
    pzs_linalg_layout(dense);
}

void pzs_linalg_clear(pzs_envelope *matrix)
{
    memset(matrix->value, 0, matrix->start[panel_count(matrix->n)] * sizeof *matrix->value);
}

/*
 * Return the leftmost stored column of a panel (PZS_TILE rows of a matrix in envelope storage),
 * which follows from the number of stored entries of the panel.
 */
static uint32_t leftmost_column(const pzs_envelope *matrix, uint32_t panel)
{
    return (panel + 1u) * PZS_TILE - (matrix->start[panel + 1u] - matrix->start[panel]) / PZS_TILE;
}

/*
 * Return the address of column k in a panel of a matrix: PZS_TILE entries, one for each row,
 * directly followed by those of the next column.
 */
static pzs_real *column(const pzs_envelope *matrix, uint32_t panel, uint32_t k)
{
    return matrix->value + matrix->start[panel] +
           (size_t)(k - leftmost_column(matrix, panel)) * PZS_TILE;
}

pzs_real *pzs_linalg_entry(const pzs_envelope *matrix, uint32_t i, uint32_t j)
{
    return column(matrix, i / PZS_TILE, j) + i % PZS_TILE;
}

/*
 * Copy the entries of one column of a panel (PZS_TILE matrix rows): PZS_TILE entries, or fewer in
 * the last panel, where the matrix has no more rows.
 */
static void copy_rows(pzs_real *restrict to, const pzs_real *restrict from, uint32_t rows)
{
    if (rows == PZS_TILE)
        memcpy(to, from, PZS_TILE * sizeof *to);
    else
        for (uint32_t i = 0; i < rows; i++)
            to[i] = from[i];
}

/* ---- scale and norm --------------------------------------------------- */

/*
 * Return the power of two s that scales a diagonal entry of a matrix, so that s * diagonal * s lies
 * between 1/2 and 2. `diagonal` must be positive and finite. The loops take at most 540 iterations,
 * 2 or 3 for usual numbers.
 */
static pzs_real unit_scale(pzs_real diagonal)
{
    pzs_real scale = 1;

    for (; diagonal >= 2; diagonal *= (pzs_real)0.25)
        scale *= (pzs_real)0.5;
    for (; diagonal < (pzs_real)0.5; diagonal *= 4)
        scale *= 2;
    return scale;
}

int32_t pzs_linalg_scale(pzs_envelope *matrix, pzs_real *scale)
{
    for (uint32_t i = 0; i < matrix->n; i++) {
        const pzs_real diagonal = *pzs_linalg_entry(matrix, i, i);
        if (!(diagonal > 0 && diagonal <= REAL_MOST))
            return (int32_t)i;
        scale[i] = unit_scale(diagonal);
    }
    pzs_linalg_apply_scale(matrix, scale);
    return -1;
}

/*
 * The entries of the matrix are scaled in the order in which they lie in memory, which is the
 * fastest: panel by panel (PZS_TILE rows each) and column by column. Padding entries are zero and
 * stay zero.
 */
void pzs_linalg_apply_scale(pzs_envelope *matrix, const pzs_real *scale)
{
    pzs_real *restrict entry = matrix->value;

    for (uint32_t row = 0; row < matrix->n; row += PZS_TILE) {
        pzs_real row_scale[PZS_TILE] = {0};
        copy_rows(row_scale, scale + row, smaller(PZS_TILE, matrix->n - row));
        for (uint32_t k = leftmost_column(matrix, row / PZS_TILE); k < row + PZS_TILE;
             k++, entry += PZS_TILE) {
            const pzs_real column_scale = k < matrix->n ? scale[k] : 0;
            UNROLLED
            for (int i = 0; i < PZS_TILE; i++)
                entry[i] = entry[i] * row_scale[i] * column_scale;
        }
    }
}

/*
 * Add the absolute values of the entries in column k of a panel to the sums of their rows and of
 * their column; an entry on the diagonal counts once.
 *   entry [PZS_TILE]           in      the entries, of which those above the diagonal are not used
 *   sum   [rows of the matrix] in/out  sums
 */
static void add_sizes(const pzs_real *entry, uint32_t row, uint32_t past, uint32_t k, pzs_real *sum)
{
    for (uint32_t i = k > row ? k : row; i < past; i++) {
        const pzs_real size = PZS_ABS(entry[i - row]);
        sum[i] += size;
        if (i != k)
            sum[k] += size;
    }
}

/*
 * The absolute values of the entries are added to the row and column sums of the matrix in the
 * order in which the entries lie in memory, which is the fastest: panel by panel (PZS_TILE rows
 * each) and column by column.
 */
pzs_real pzs_linalg_norm1(const pzs_envelope *matrix, pzs_real *sum)
{
    const pzs_real *entry = matrix->value;
    pzs_real norm = 0;

    memset(sum, 0, matrix->n * sizeof *sum);
    for (uint32_t row = 0; row < matrix->n; row += PZS_TILE) {
        const uint32_t past = smaller(row + PZS_TILE, matrix->n);
        for (uint32_t k = leftmost_column(matrix, row / PZS_TILE); k < row + PZS_TILE;
             k++, entry += PZS_TILE)
            add_sizes(entry, row, past, k, sum);
    }
    for (uint32_t i = 0; i < matrix->n; i++) {
        if (!(sum[i] <= REAL_MOST))
            return sum[i];
        norm = larger(norm, sum[i]);
    }
    return norm;
}

/* ---- factor ----------------------------------------------------------- */

/*
 * Innermost loop of the factorisation A = L D L^T: compute a strip, which is STRIP neighbouring
 * columns of W = L D in one panel of T = PZS_TILE rows:
 *   W_ij = A_ij - sum over k < j of W_ik L_jk
 *   i, j  rows of the panel, columns of the strip
 *   strip [STRIP][T] in/out  in: columns j of A; out: columns j of W; directly before them in
 *                            memory: columns k of W
 *   lower [STRIP][T] in      entries L_jk of the columns k of the strip; directly before them in
 *                            memory: L_jk of earlier columns k
 *   count            in      number of columns k before the strip for which terms are subtracted
 */
static void eliminate(pzs_real *restrict strip, const pzs_real *restrict lower, uint32_t count)
{
    const pzs_real *scaled = strip - (size_t)count * PZS_TILE;
    pzs_real sum[STRIP * PZS_TILE];

    lower -= (size_t)count * PZS_TILE;
    MOVE(sum, strip, STRIP * PZS_TILE);
    for (; count > 0; count--, scaled += PZS_TILE, lower += PZS_TILE)
        UNROLLED
    for (int j = 0; j < STRIP; j++)
        UNROLLED
    for (int i = 0; i < PZS_TILE; i++)
        sum[j * PZS_TILE + i] -= scaled[i] * lower[j];
    // Subtract the terms W_ik L_jk (factors L D L^T, W = L D) of those columns k of the strip that
    // this loop has just computed.
    UNROLLED
    for (int k = 0; k < STRIP; k++, lower += PZS_TILE)
        UNROLLED
    for (int j = k + 1; j < STRIP; j++)
        UNROLLED
    for (int i = 0; i < PZS_TILE; i++)
        sum[j * PZS_TILE + i] -= sum[k * PZS_TILE + i] * lower[j];
    MOVE(strip, sum, STRIP * PZS_TILE);
}

/*
 * Subtract from the diagonal tile of a panel the products with all columns left of it:
 *   A - sum over k of W_k L_k^T,  L_k = W_k * inverse pivot k
 *   tile    [T][T]     in/out  diagonal tile of A, T = PZS_TILE; entries above the diagonal are not
 *                              used
 *   scaled  [count][T] in/out  in: columns W_k of W = L D; out: columns L_k
 *   inverse [count]    in      reciprocals of the pivots of these columns
 */
static void eliminate_diagonal(pzs_real *restrict tile, pzs_real *restrict scaled,
                               const pzs_real *restrict inverse, uint32_t count)
{
    pzs_real sum[PZS_TILE * PZS_TILE];
    pzs_real lower[PZS_TILE];

    MOVE(sum, tile, PZS_TILE * PZS_TILE);
    for (; count > 0; count--, scaled += PZS_TILE, inverse++) {
        UNROLLED
        for (int j = 0; j < PZS_TILE; j++)
            lower[j] = scaled[j] * *inverse;
        UNROLLED
        for (int j = 0; j < PZS_TILE; j++)
            UNROLLED
        /*
         * With wide vector registers, the entries above the diagonal of a diagonal tile are
         * computed, too, although they are not used, because whole columns of the tile are faster
         * than parts.
         */
        for (int i = PZS_BY_TILE(j, 0, 0); i < PZS_TILE; i++)
            sum[j * PZS_TILE + i] -= scaled[i] * lower[j];
        MOVE(scaled, lower, PZS_TILE);
    }
    MOVE(tile, sum, PZS_TILE * PZS_TILE);
}

/*
 * Factor the diagonal tile of a panel of T = PZS_TILE matrix rows. All columns on its left must
 * have been eliminated before.
 *   tile    [T][T] in/out  in: entries to factor; out: factor L, with the pivots on the diagonal
 *   least   [rows] in      bound of each pivot; a pivot that is not above its bound counts as zero
 *   inverse [rows] out     reciprocals of the pivots
 *   rows           in      number of rows of the panel that belong to the matrix
 * Returns the number of usable pivots: `rows`, or the row of the first zero pivot.
 */
static uint32_t factor_tile(pzs_real *restrict tile, const pzs_real *restrict least,
                            pzs_real *restrict inverse, uint32_t rows)
{
    for (uint32_t k = 0; k < rows; k++) {
        pzs_real *scaled = tile + k * PZS_TILE;
        inverse[k] = 1 / scaled[k];
        if (!(PZS_ABS(scaled[k]) > least[k] && PZS_ABS(inverse[k]) > 0 &&
              PZS_ABS(inverse[k]) <= REAL_MOST))
            return k;
        for (uint32_t j = k + 1u; j < rows; j++) {
            const pzs_real lower = scaled[j] * inverse[k];
            for (uint32_t i = j; i < PZS_TILE; i++)
                tile[j * PZS_TILE + i] -= scaled[i] * lower;
            scaled[j] = lower;
        }
    }
    return rows;
}

/*
 * Eliminate a strip, the STRIP columns from column `at` on, in the panels `panel` to `past` - 1
 * (PZS_TILE matrix rows each). The strip lies left of the diagonal tiles of all these panels. With
 * wide vectors, panels are eliminated in pairs.
 */
static void eliminate_strip(const pzs_envelope *matrix, uint32_t at, uint32_t panel, uint32_t past)
{
    const uint32_t first = leftmost_column(matrix, at / PZS_TILE);
    const pzs_real *lower = column(matrix, at / PZS_TILE, at) + at % PZS_TILE;
    wide_strip pair[2];
    uint32_t waiting = 0;

    for (; panel < past; panel++) {
        const uint32_t own_first = leftmost_column(matrix, panel);
        if (own_first > at)
            continue;
        pair[waiting].entry = column(matrix, panel, at);
        pair[waiting].count = at - (own_first > first ? own_first : first);
        if (!pzs_linalg_has_wide())
            eliminate(pair[0].entry, lower, pair[0].count);
        else if (++waiting == 2u) {
            pzs_linalg_wide(pair, lower);
            waiting = 0;
        }
    }
    if (waiting > 0)
        eliminate(pair[0].entry, lower, pair[0].count);
}

/*
 * Return the first of the columns left of a diagonal tile that have not yet been eliminated from
 * its panel; the factorisation must eliminate them before it factors the tile. Columns left of a
 * group of GROUP panels are eliminated in the whole group, before its first panel. Later panels of
 * the group lack only the columns of the diagonal tile before.
 */
static uint32_t first_of_columns(const pzs_envelope *matrix, uint32_t panel, uint32_t past)
{
    uint32_t left = panel * PZS_TILE;

    if (panel % GROUP != 0)
        return left - PZS_TILE;
    for (; panel < past; panel++)
        left = smaller(left, leftmost_column(matrix, panel));
    return left;
}

/*
 * Eliminate the columns on the left of a diagonal tile from its panel and the next panels (of
 * PZS_TILE rows), before the tile is factored.
 *   panel  in  panel of the tile
 *   past   in  index after the last panel
 */
static void eliminate_columns(const pzs_envelope *matrix, uint32_t panel, uint32_t past)
{
    // The outer loop runs over strips of columns, so that a strip stays in the cache while all
    // panels use it.
    for (uint32_t at = first_of_columns(matrix, panel, past); at < panel * PZS_TILE; at += STRIP)
        eliminate_strip(matrix, at, panel, past);
}

linalg_inertia pzs_linalg_factor(pzs_envelope *matrix)
{
    const pzs_real tolerance = (pzs_real)matrix->n * PZS_EPSILON < SMALL_PIVOT
                                   ? (pzs_real)matrix->n * PZS_EPSILON
                                   : SMALL_PIVOT;
    linalg_inertia found = {0, -1, -1, 0};
    pzs_real diagonal = 0;
    pzs_real pivot = 0;

    for (uint32_t row = 0; row < matrix->n && found.zero < 0; row += PZS_TILE) {
        const uint32_t rows = smaller(PZS_TILE, matrix->n - row);
        const uint32_t panel = row / PZS_TILE, left = leftmost_column(matrix, panel);
        const uint32_t past = smaller(panel - panel % GROUP + GROUP, panel_count(matrix->n));
        pzs_real *tile = column(matrix, panel, row);
        pzs_real least[PZS_TILE];
        uint32_t usable;

        for (uint32_t local = 0; local < rows; local++) {
            least[local] = tolerance * PZS_ABS(tile[local * PZS_TILE + local]);
            diagonal = larger(diagonal, PZS_ABS(tile[local * PZS_TILE + local]));
        }
        eliminate_columns(matrix, panel, past);
        eliminate_diagonal(tile, matrix->value + matrix->start[panel], matrix->inverse + left,
                           row - left);
        usable = factor_tile(tile, least, matrix->inverse + row, rows);
        for (uint32_t local = 0; local < usable; local++) {
            pivot = larger(pivot, PZS_ABS(tile[local * PZS_TILE + local]));
            if (tile[local * PZS_TILE + local] < 0 && found.negative++ == 0)
                found.first_negative = (int32_t)(row + local);
        }
        if (usable < rows)
            found.zero = (int32_t)(row + usable);
    }
    if (diagonal > 0)
        found.growth = pivot / diagonal;
    return found;
}

/* ---- solve ------------------------------------------------------------ */

pzs_real pzs_linalg_inner(const pzs_real *left, const pzs_real *right, uint32_t count)
{
    pzs_real sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += left[i] * right[i];
    return sum;
}

/*
 * First half of the forward substitution L x = b for the rows of one panel (PZS_TILE rows of the
 * factor L): subtract the products with the known entries of x left of the diagonal tile, for all
 * rows of the panel together.
 *   vector [rows of the matrix] in/out  known entries of x, then entries of b
 */
static void forward_known(const pzs_envelope *matrix, uint32_t panel, pzs_real *vector)
{
    const uint32_t row = panel * PZS_TILE;
    const uint32_t rows = smaller(PZS_TILE, matrix->n - row);
    const uint32_t left = leftmost_column(matrix, panel);
    const pzs_real *restrict lower = column(matrix, panel, left);
    pzs_real part[PZS_TILE] = {0};

    copy_rows(part, vector + row, rows);
    for (uint32_t k = left; k < row; k += PZS_TILE)
        UNROLLED
    for (uint32_t j = 0; j < PZS_TILE; j++, lower += PZS_TILE)
        UNROLLED
    for (int i = 0; i < PZS_TILE; i++)
        part[i] -= lower[i] * vector[k + j];
    copy_rows(vector + row, part, rows);
}

/*
 * Second half of the forward substitution L x = b for one panel (PZS_TILE rows): solve with the
 * triangle of L on the diagonal. The first half, which subtracts the products with the known
 * entries of x, is a separate function, so that the compiler can use whole vector registers there.
 *   vector [rows of the matrix] in/out  known entries of x, then entries of b
 */
static void forward_triangle(const pzs_envelope *matrix, uint32_t panel, pzs_real *vector)
{
    const uint32_t row = panel * PZS_TILE;
    const uint32_t rows = smaller(PZS_TILE, matrix->n - row);
    const pzs_real *restrict lower = column(matrix, panel, row);
    pzs_real part[PZS_TILE] = {0};

    copy_rows(part, vector + row, rows);
    UNROLLED
    for (int k = 0; k < PZS_TILE; k++, lower += PZS_TILE)
        UNROLLED
    for (int i = k + 1; i < PZS_TILE; i++)
        part[i] -= lower[i] * part[k];
    copy_rows(vector + row, part, rows);
}

/*
 * Backward substitution L^T x = b for one panel (PZS_TILE rows of the factor L): compute the
 * entries of x of these rows, and subtract their products with L from the entries of all earlier
 * rows.
 *   vector [rows of the matrix] in/out  entries of b, then known entries of x
 */
static void backward(const pzs_envelope *matrix, uint32_t panel, pzs_real *vector)
{
    const uint32_t row = panel * PZS_TILE;
    const uint32_t rows = smaller(PZS_TILE, matrix->n - row);
    const uint32_t left = leftmost_column(matrix, panel);
    const pzs_real *restrict tile = column(matrix, panel, row);
    const pzs_real *restrict lower = column(matrix, panel, left);
    pzs_real part[PZS_TILE] = {0};

    copy_rows(part, vector + row, rows);
    UNROLLED
    for (int i = PZS_TILE - 1; i > 0; i--)
        UNROLLED
    for (int k = 0; k < i; k++)
        part[k] -= tile[k * PZS_TILE + i] * part[i];
    copy_rows(vector + row, part, rows);
    for (uint32_t k = left; k < row; k++, lower += PZS_TILE)
        UNROLLED
    for (int i = PZS_TILE - 1; i >= 0; i--)
        vector[k] -= lower[i] * part[i];
}

/*
 * Each panel (PZS_TILE rows) of the triangular factors of the matrix is applied to all right-hand
 * sides before the next panel, while the panel is in the cache.
 */
void pzs_linalg_solve_many(const pzs_envelope *matrix, pzs_real *vector, uint32_t count,
                           size_t stride)
{
    const uint32_t panels = panel_count(matrix->n);

    for (uint32_t panel = 0; panel < panels; panel++) {
        for (uint32_t side = 0; side < count; side++)
            forward_known(matrix, panel, vector + side * stride);
        for (uint32_t side = 0; side < count; side++)
            forward_triangle(matrix, panel, vector + side * stride);
    }
    for (uint32_t side = 0; side < count; side++)
        for (uint32_t i = 0; i < matrix->n; i++)
            vector[side * stride + i] *= matrix->inverse[i];
    for (uint32_t panel = panels; panel-- > 0;)
        for (uint32_t side = 0; side < count; side++)
            backward(matrix, panel, vector + side * stride);
}

void pzs_linalg_solve(const pzs_envelope *matrix, pzs_real *vector)
{
    pzs_linalg_solve_many(matrix, vector, 1, 0);
}

/* ---- condition -------------------------------------------------------- */

static pzs_real norm1(const pzs_real *vector, uint32_t count)
{
    pzs_real sum = 0;

    for (uint32_t i = 0; i < count; i++)
        sum += PZS_ABS(vector[i]);
    return sum;
}

/*
 * Replace each entry of `vector` by its sign (1 for zero), for Hager's estimate of a condition
 * number. `sign` holds the signs of the last call and receives the new ones. Returns the number of
 * signs that have changed.
 */
static uint32_t take_signs(pzs_real *vector, pzs_real *sign, uint32_t count)
{
    uint32_t changed = 0;

    for (uint32_t i = 0; i < count; i++) {
        vector[i] = vector[i] < 0 ? (pzs_real)-1 : (pzs_real)1;
        changed += vector[i] * sign[i] > 0 ? 0u : 1u;
        sign[i] = vector[i];
    }
    return changed;
}

static uint32_t index_of_largest(const pzs_real *vector, uint32_t count)
{
    uint32_t at = 0;

    for (uint32_t i = 1; i < count; i++)
        if (PZS_ABS(vector[i]) > PZS_ABS(vector[at]))
            at = i;
    return at;
}

/*
 * Fill a vector b with numbers of alternating signs and growing size. The ratio |A^-1 b| / |b| in
 * the 1-norm is then a second estimate of the norm of A^-1. It serves where cancellation makes the
 * first estimate of the condition number far too small (Higham 1988, section 3).
 */
static void fill_alternating(pzs_real *vector, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const pzs_real size_of_entry = 1 + (pzs_real)i / (pzs_real)count;
        vector[i] = i % 2u != 0u ? -size_of_entry : size_of_entry;
    }
}

/*
 * Estimate the condition number in the 1-norm by Hager's method, which maximises |A^-1 x| over all
 * vectors x of norm 1. The maximum lies at a unit vector. Every x gives a lower bound, and the
 * gradient A^-1 sign(A^-1 x) of the norm shows which unit vector to try next, at most five times.
 */
pzs_real pzs_linalg_condition(const pzs_envelope *matrix, pzs_real norm_a, pzs_real *work)
{
    const uint32_t rows = matrix->n;
    pzs_real *vector = work;
    pzs_real *alternating = work + rows;
    pzs_real *sign = alternating + rows;
    pzs_real inverse = 0;
    pzs_real other;

    for (uint32_t i = 0; i < rows; i++) {
        vector[i] = 1 / (pzs_real)rows;
        sign[i] = 0;
    }
    // A vector of alternating signs gives another lower bound of the norm of the inverse matrix.
    // Both vectors are solved for in one call.
    fill_alternating(alternating, rows);
    const pzs_real size = norm1(alternating, rows);
    pzs_linalg_solve_many(matrix, work, 2, rows);
    other = norm1(alternating, rows) / size;
    for (int corner = 0; corner < 5; corner++) {
        uint32_t best;
        if (corner > 0)
            pzs_linalg_solve(matrix, vector);
        if (!(norm1(vector, rows) > inverse))
            break;
        inverse = norm1(vector, rows);
        if (take_signs(vector, sign, rows) == 0)
            break;
        pzs_linalg_solve(matrix, vector);
        best = index_of_largest(vector, rows);
        if (!(PZS_ABS(vector[best]) > inverse))
            break;
        memset(vector, 0, rows * sizeof *vector);
        vector[best] = 1;
    }
    return norm_a * (other <= inverse ? inverse : other);
}
