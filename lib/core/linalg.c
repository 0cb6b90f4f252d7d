/* SPDX-License-Identifier: BSD-2-Clause */
/* Symmetric linear systems in envelope storage (linalg.h): left-looking L D L', tile by tile. */
#include "linalg.h"
#include "unrolled.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define REAL_MOST PZS_BY_BITS(FLT_MAX, DBL_MAX)

/*
 * Columns of a tile that are computed together: STRIP x PZS_TILE sums fit into the registers. Only
 * the speed depends on it.
 */
#define STRIP PZS_BY_TILE(4, 8, 8)

/* Copies between memory and registers: entry by entry, or in whole vectors on wide hosts. */
#if PZS_TILE == 4
#define MOVE(to, from, count) UNROLLED for (int m = 0; m < (count); m++)(to)[m] = (from)[m]
#else
#define MOVE(to, from, count) memcpy(to, from, (count) * sizeof(pzs_real))
#endif

/*
 * 2^-23: a larger pivot never counts as zero. In float, n epsilon would refuse thin shells that
 * refinement still solves.
 */
#define SMALL_PIVOT ((pzs_real)1.1920928955078125e-7)

/* ---- storage ---------------------------------------------------------- */

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static pzs_real most(pzs_real a, pzs_real b)
{
    return a > b ? a : b;
}

static uint32_t panels_of(uint32_t n)
{
    return n / PZS_TILE + (n % PZS_TILE != 0u ? 1u : 0u);
}

/*
 * Entries of one panel: from its leftmost column, rounded down to a tile, to the end of its
 * diagonal tile.
 */
static uint32_t panel_reals(const uint16_t *first, uint32_t n, uint32_t panel)
{
    const uint32_t end = smaller((panel + 1u) * PZS_TILE, n);
    uint32_t left = panel * PZS_TILE;

    for (uint32_t i = panel * PZS_TILE; i < end; i++)
        left = smaller(left, first[i]);
    return ((panel + 1u) * PZS_TILE - left / PZS_TILE * PZS_TILE) * PZS_TILE;
}

size_t pzs_linalg_reals(const uint16_t *first, uint32_t n)
{
    size_t reals = 0;

    for (uint32_t p = 0; p < panels_of(n); p++)
        reals += panel_reals(first, n, p);
    return reals;
}

void pzs_linalg_layout(pzs_envelope *matrix)
{
    matrix->start[0] = 0;
    for (uint32_t p = 0; p < panels_of(matrix->n); p++)
        matrix->start[p + 1u] = matrix->start[p] + panel_reals(matrix->first, matrix->n, p);
}

/*
 * Rows beyond n in the last panel stay zero through all operations, and no result depends on them.
 */
void pzs_linalg_dense_layout(pzs_envelope *dense, uint32_t n, pzs_real *work, void *index)
{
    uint32_t *start = index;
    uint16_t *first = (uint16_t *)(start + n / PZS_TILE + 2);
    memset(first, 0, n * sizeof *first);
    dense->n = n;
    dense->first = first;
    dense->start = start;
    dense->inverse = work;
    dense->value = work + n;
    pzs_linalg_layout(dense);
}

void pzs_linalg_clear(pzs_envelope *matrix)
{
    memset(matrix->value, 0, matrix->start[panels_of(matrix->n)] * sizeof *matrix->value);
}

/* Leftmost column of a panel, from its number of entries. */
static uint32_t left_of(const pzs_envelope *matrix, uint32_t panel)
{
    return (panel + 1u) * PZS_TILE - (matrix->start[panel + 1u] - matrix->start[panel]) / PZS_TILE;
}

/* The PZS_TILE entries of column k in a panel; those of the next column follow directly. */
static pzs_real *column(const pzs_envelope *matrix, uint32_t panel, uint32_t k)
{
    return matrix->value + matrix->start[panel] + (size_t)(k - left_of(matrix, panel)) * PZS_TILE;
}

pzs_real *pzs_linalg_entry(const pzs_envelope *matrix, uint32_t i, uint32_t j)
{
    return column(matrix, i / PZS_TILE, j) + i % PZS_TILE;
}

/* Copy the rows of a panel that exist: all of them but in the last panel. */
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
 * Power of two s with 1/2 <= s d s < 2, for positive finite d. At most 540 iterations; 2 or 3 for
 * usual d.
 */
static pzs_real unit_scale(pzs_real d)
{
    pzs_real s = 1;

    for (; d >= 2; d *= (pzs_real)0.25)
        s *= (pzs_real)0.5;
    for (; d < (pzs_real)0.5; d *= 4)
        s *= 2;
    return s;
}

int32_t pzs_linalg_scale(pzs_envelope *matrix, pzs_real *scale)
{
    for (uint32_t i = 0; i < matrix->n; i++) {
        const pzs_real d = *pzs_linalg_entry(matrix, i, i);
        if (!(d > 0 && d <= REAL_MOST))
            return (int32_t)i;
        scale[i] = unit_scale(d);
    }
    pzs_linalg_apply_scale(matrix, scale);
    return -1;
}

/*
 * Scales panel by panel and column by column, in memory order. The padding is zero and stays zero.
 */
void pzs_linalg_apply_scale(pzs_envelope *matrix, const pzs_real *scale)
{
    pzs_real *restrict entry = matrix->value;

    for (uint32_t row = 0; row < matrix->n; row += PZS_TILE) {
        pzs_real s[PZS_TILE] = {0};
        copy_rows(s, scale + row, smaller(PZS_TILE, matrix->n - row));
        for (uint32_t k = left_of(matrix, row / PZS_TILE); k < row + PZS_TILE;
             k++, entry += PZS_TILE) {
            const pzs_real t = k < matrix->n ? scale[k] : 0;
            UNROLLED
            for (int i = 0; i < PZS_TILE; i++)
                entry[i] = entry[i] * s[i] * t;
        }
    }
}

pzs_real pzs_linalg_norm1(const pzs_envelope *matrix, pzs_real *sum)
{
    pzs_real norm = 0;

    for (uint32_t i = 0; i < matrix->n; i++) {
        const pzs_real *entry = pzs_linalg_entry(matrix, i, matrix->first[i]);
        sum[i] = 0;
        for (uint32_t j = matrix->first[i]; j < i; j++, entry += PZS_TILE) {
            sum[i] += PZS_ABS(*entry);
            sum[j] += PZS_ABS(*entry);
        }
        sum[i] += PZS_ABS(*entry);
    }
    for (uint32_t i = 0; i < matrix->n; i++) {
        if (!(sum[i] <= REAL_MOST))
            return sum[i];
        norm = most(norm, sum[i]);
    }
    return norm;
}

/* ---- factor ----------------------------------------------------------- */

/*
 * STRIP columns of a panel left of its diagonal tile: W_ij = A_ij - sum_k W_ik L_jk, k < j, with W
 * = L D. strip [STRIP][T]         in A, out W: columns of T = PZS_TILE rows w     [count][T] in the
 * columns of W before the strip l     [count + STRIP][T] in columns of L in the rows j of the
 * strip's own columns; l[k][0] is the first The last STRIP terms continue the sum with the columns
 * of W just finished.
 */
static void eliminate(pzs_real *restrict strip, const pzs_real *restrict w,
                      const pzs_real *restrict l, uint32_t count)
{
    pzs_real c[STRIP * PZS_TILE];

    MOVE(c, strip, STRIP * PZS_TILE);
    for (; count > 0; count--, w += PZS_TILE, l += PZS_TILE)
        UNROLLED
    for (int j = 0; j < STRIP; j++)
        UNROLLED
    for (int i = 0; i < PZS_TILE; i++)
        c[j * PZS_TILE + i] -= w[i] * l[j];
    UNROLLED
    for (int k = 0; k < STRIP; k++, l += PZS_TILE)
        UNROLLED
    for (int j = k + 1; j < STRIP; j++)
        UNROLLED
    for (int i = 0; i < PZS_TILE; i++)
        c[j * PZS_TILE + i] -= c[k * PZS_TILE + i] * l[j];
    MOVE(strip, c, STRIP * PZS_TILE);
}

/*
 * The diagonal tile of a panel before its own pivots: A - sum_k w_k l_k^T, with l_k = w_k
 * inverse_k. tile    [T][T]     in A, out; entries above the diagonal are not used w [count][T] in
 * columns of L D, out columns of L inverse [count]    in inverse pivots of these columns
 */
static void eliminate_diagonal(pzs_real *restrict tile, pzs_real *restrict w,
                               const pzs_real *restrict inverse, uint32_t count)
{
    pzs_real c[PZS_TILE * PZS_TILE];
    pzs_real l[PZS_TILE];

    MOVE(c, tile, PZS_TILE * PZS_TILE);
    for (; count > 0; count--, w += PZS_TILE, inverse++) {
        UNROLLED
        for (int j = 0; j < PZS_TILE; j++)
            l[j] = w[j] * *inverse;
        UNROLLED
        for (int j = 0; j < PZS_TILE; j++)
            UNROLLED
        for (int i = PZS_BY_TILE(j, 0, 0); i < PZS_TILE; i++) /* with wide vectors, whole columns
                                                                 are faster */
            c[j * PZS_TILE + i] -= w[i] * l[j];
        MOVE(w, l, PZS_TILE);
    }
    MOVE(tile, c, PZS_TILE * PZS_TILE);
}

/*
 * Factor the diagonal tile itself, of which `rows` rows are used.
 *   tile    [T][T] in result of eliminate_diagonal; out L, with the pivots on the diagonal
 *   least   [rows] in a pivot that is not larger counts as zero
 *   inverse [rows] out inverse pivots
 * Returns the number of usable pivots: rows, or the row of the first zero pivot.
 */
static uint32_t factor_tile(pzs_real *restrict tile, const pzs_real *restrict least,
                            pzs_real *restrict inverse, uint32_t rows)
{
    for (uint32_t k = 0; k < rows; k++) {
        pzs_real *w = tile + k * PZS_TILE;
        inverse[k] = 1 / w[k];
        if (!(PZS_ABS(w[k]) > least[k] && PZS_ABS(inverse[k]) > 0 &&
              PZS_ABS(inverse[k]) <= REAL_MOST))
            return k;
        for (uint32_t j = k + 1u; j < rows; j++) {
            const pzs_real l = w[j] * inverse[k];
            for (uint32_t i = j; i < PZS_TILE; i++)
                tile[j * PZS_TILE + i] -= w[i] * l;
            w[j] = l;
        }
    }
    return rows;
}

/*
 * All of a panel except the pivots of its diagonal tile: left-looking, tile by tile from its
 * leftmost column.
 */
static void eliminate_panel(const pzs_envelope *matrix, uint32_t panel)
{
    const uint32_t left = left_of(matrix, panel);

    for (uint32_t q = left; q < panel * PZS_TILE; q += STRIP) {
        const uint32_t from =
            left_of(matrix, q / PZS_TILE) > left ? left_of(matrix, q / PZS_TILE) : left;
        eliminate(column(matrix, panel, q), column(matrix, panel, from),
                  column(matrix, q / PZS_TILE, from) + q % PZS_TILE, q - from);
    }
    eliminate_diagonal(column(matrix, panel, panel * PZS_TILE), column(matrix, panel, left),
                       matrix->inverse + left, panel * PZS_TILE - left);
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
        pzs_real *tile = column(matrix, row / PZS_TILE, row);
        pzs_real least[PZS_TILE];
        uint32_t usable;

        for (uint32_t r = 0; r < rows; r++) {
            least[r] = tolerance * PZS_ABS(tile[r * PZS_TILE + r]);
            diagonal = most(diagonal, PZS_ABS(tile[r * PZS_TILE + r]));
        }
        eliminate_panel(matrix, row / PZS_TILE);
        usable = factor_tile(tile, least, matrix->inverse + row, rows);
        for (uint32_t r = 0; r < usable; r++) {
            pivot = most(pivot, PZS_ABS(tile[r * PZS_TILE + r]));
            if (tile[r * PZS_TILE + r] < 0 && found.negative++ == 0)
                found.first_negative = (int32_t)(row + r);
        }
        if (usable < rows)
            found.zero = (int32_t)(row + usable);
    }
    if (diagonal > 0)
        found.growth = pivot / diagonal;
    return found;
}

/* ---- solve ------------------------------------------------------------ */

pzs_real pzs_linalg_inner(const pzs_real *x, const pzs_real *y, uint32_t n)
{
    pzs_real sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += x[i] * y[i];
    return sum;
}

/*
 * L x = b, first half of a panel: subtract the known x_k left of its diagonal tile, for all rows at
 * once.
 */
static void forward_known(const pzs_envelope *matrix, uint32_t panel, pzs_real *x)
{
    const uint32_t row = panel * PZS_TILE;
    const uint32_t rows = smaller(PZS_TILE, matrix->n - row);
    const uint32_t left = left_of(matrix, panel);
    const pzs_real *restrict l = column(matrix, panel, left);
    pzs_real y[PZS_TILE] = {0};

    copy_rows(y, x + row, rows);
    for (uint32_t k = left; k < row; k += PZS_TILE)
        UNROLLED
    for (uint32_t j = 0; j < PZS_TILE; j++, l += PZS_TILE)
        UNROLLED
    for (int i = 0; i < PZS_TILE; i++)
        y[i] -= l[i] * x[k + j];
    copy_rows(x + row, y, rows);
}

/*
 * L x = b, second half: the triangle of the diagonal tile. Separate from the first half, so that
 * vectors stay whole there.
 */
static void forward_triangle(const pzs_envelope *matrix, uint32_t panel, pzs_real *x)
{
    const uint32_t row = panel * PZS_TILE;
    const uint32_t rows = smaller(PZS_TILE, matrix->n - row);
    const pzs_real *restrict l = column(matrix, panel, row);
    pzs_real y[PZS_TILE] = {0};

    copy_rows(y, x + row, rows);
    UNROLLED
    for (int k = 0; k < PZS_TILE; k++, l += PZS_TILE)
        UNROLLED
    for (int i = k + 1; i < PZS_TILE; i++)
        y[i] -= l[i] * y[k];
    copy_rows(x + row, y, rows);
}

/*
 * L^T x = b, one panel: finish its rows, then subtract them from the x_k to its left, the last row
 * first.
 */
static void backward(const pzs_envelope *matrix, uint32_t panel, pzs_real *x)
{
    const uint32_t row = panel * PZS_TILE;
    const uint32_t rows = smaller(PZS_TILE, matrix->n - row);
    const uint32_t left = left_of(matrix, panel);
    const pzs_real *restrict tile = column(matrix, panel, row);
    const pzs_real *restrict l = column(matrix, panel, left);
    pzs_real y[PZS_TILE] = {0};

    copy_rows(y, x + row, rows);
    UNROLLED
    for (int i = PZS_TILE - 1; i > 0; i--)
        UNROLLED
    for (int k = 0; k < i; k++)
        y[k] -= tile[k * PZS_TILE + i] * y[i];
    copy_rows(x + row, y, rows);
    for (uint32_t k = left; k < row; k++, l += PZS_TILE)
        UNROLLED
    for (int i = PZS_TILE - 1; i >= 0; i--)
        x[k] -= l[i] * y[i];
}

/* Each panel is applied to all right-hand sides while it is in cache. */
void pzs_linalg_solve_many(const pzs_envelope *matrix, pzs_real *x, uint32_t count, size_t stride)
{
    const uint32_t panels = panels_of(matrix->n);

    for (uint32_t p = 0; p < panels; p++) {
        for (uint32_t r = 0; r < count; r++)
            forward_known(matrix, p, x + r * stride);
        for (uint32_t r = 0; r < count; r++)
            forward_triangle(matrix, p, x + r * stride);
    }
    for (uint32_t r = 0; r < count; r++)
        for (uint32_t i = 0; i < matrix->n; i++)
            x[r * stride + i] *= matrix->inverse[i];
    for (uint32_t p = panels; p-- > 0;)
        for (uint32_t r = 0; r < count; r++)
            backward(matrix, p, x + r * stride);
}

void pzs_linalg_solve(const pzs_envelope *matrix, pzs_real *x)
{
    pzs_linalg_solve_many(matrix, x, 1, 0);
}

/* ---- condition -------------------------------------------------------- */

static pzs_real norm1(const pzs_real *x, uint32_t n)
{
    pzs_real sum = 0;

    for (uint32_t i = 0; i < n; i++)
        sum += PZS_ABS(x[i]);
    return sum;
}

/*
 * Replace y by the signs of its entries; `sign` holds the previous signs. Returns how many have
 * changed.
 */
static uint32_t take_signs(pzs_real *y, pzs_real *sign, uint32_t n)
{
    uint32_t changed = 0;

    for (uint32_t i = 0; i < n; i++) {
        y[i] = y[i] < 0 ? (pzs_real)-1 : (pzs_real)1;
        changed += y[i] * sign[i] > 0 ? 0u : 1u;
        sign[i] = y[i];
    }
    return changed;
}

static uint32_t largest(const pzs_real *x, uint32_t n)
{
    uint32_t at = 0;

    for (uint32_t i = 1; i < n; i++)
        if (PZS_ABS(x[i]) > PZS_ABS(x[at]))
            at = i;
    return at;
}

/*
 * |A^-1 b| / |b| for the b of alternating signs and growing size that defeats cancellation (Higham
 * 1988, section 3).
 */
static pzs_real alternating(const pzs_envelope *matrix, pzs_real *x)
{
    pzs_real size;

    for (uint32_t i = 0; i < matrix->n; i++) {
        const pzs_real b = 1 + (pzs_real)i / (pzs_real)matrix->n;
        x[i] = i % 2u != 0u ? -b : b;
    }
    size = norm1(x, matrix->n);
    pzs_linalg_solve(matrix, x);
    return norm1(x, matrix->n) / size;
}

/*
 * Maximise |A^-1 x| over the unit ball |x| = 1, whose corners are the unit vectors: the gradient z
 * = A^-1 sign(A^-1 x) shows the best corner to go to. Any x gives a lower bound; five corners are
 * enough in practice.
 */
pzs_real pzs_linalg_condition(const pzs_envelope *matrix, pzs_real norm_a, pzs_real *work)
{
    const uint32_t n = matrix->n;
    pzs_real *x = work;
    pzs_real *sign = work + n;
    pzs_real inverse = 0;
    pzs_real other;

    for (uint32_t i = 0; i < n; i++) {
        x[i] = 1 / (pzs_real)n;
        sign[i] = 0;
    }
    for (int corner = 0; corner < 5; corner++) {
        uint32_t best;
        pzs_linalg_solve(matrix, x);
        if (!(norm1(x, n) > inverse))
            break;
        inverse = norm1(x, n);
        if (take_signs(x, sign, n) == 0)
            break;
        pzs_linalg_solve(matrix, x);
        best = largest(x, n);
        if (!(PZS_ABS(x[best]) > inverse))
            break;
        memset(x, 0, n * sizeof *x);
        x[best] = 1;
    }
    other = alternating(matrix, x);
    return norm_a * (other <= inverse ? inverse : other);
}
