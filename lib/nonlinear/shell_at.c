/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tangent of the GEX7P4 element at a deformed shape (shell.h), in closed form.
 *
 * A strain has the same sum over the nodes in all modes 00, 01, 10, 11, apart from the signs xi1^r1
 * xi2^r2. So one array A of nodal strains serves every mode m: L_m = A sign_m. The signs of the
 * row's node and of the column's node combine the four products D_m A into the stresses of each
 * node p,
 *   Y_p = sum_m sign_m(p) sign_m D_m A,
 * and the rows of node p are
 *   K_p = A_p^T Y_p + geometric part,  p = 0..3.
 * The columns are ordered as four nodes of 6 dof (mean, difference/h), then the four q; q
 * contributes to five strains only.
 */
#include "../model/shell.h"
#include "../model/shell_corner.h"
#include "../model/shell_skew.h"
#include "../core/unrolled.h"
#include <string.h>

#if PZS_NONLINEAR

enum { NODE_DOF = 6, HALF = 12, FIRST_Q = 24, COLUMNS = 28 };

/*
 * Strains in the order of the rows of A. The mean displacements do not contribute to the first two.
 */
enum { A33M, A33D, A13, A23, A11M, A11D, A22M, A22D, A12M, A12D };
enum { ROWS = SHELL_STRAINS, WITH_Q = 5, WITHOUT_MEAN = 2 };
static const uint8_t in_d[ROWS] = {E33M, E33D, E13, E23, E11M, E11D, E22M, E22D, E12M, E12D};

/*
 * Rows of A to which q contributes. The row of the mean strain 12 is one of them because the warp
 * adds transverse shears to it. In the list of each mode below, the rows of q come first, or are at
 * the same positions as here.
 */
static const uint8_t q_row[WITH_Q] = {A33M, A33D, A13, A23, A12M};

/*
 * Rows of each mode: their number, how many of them contain q, the first row of D_m A, and which
 * strains they are.
 */
typedef struct mode_rows {
    uint8_t count, with_q, start, strain[ROWS];
} mode_rows;
static const mode_rows rows_of_mode[4] = {
    {10, 5, 0, {A33M, A33D, A13, A23, A11M, A11D, A22M, A22D, A12M, A12D}},
    {5, 3, 10, {A33M, A33D, A13, A11M, A11D}},
    {5, 3, 15, {A33M, A33D, A23, A22M, A22D}},
    {2, 2, 20, {A33M, A33D}},
};

/*
 * Pairs of stress rows Y1 and Y2 of different modes. The rows of every node need only the sum or
 * the difference of a pair, so these two replace the pair. Which of them a node needs depends on
 * the product of two signs of mode `mode`: that of the node itself and that of the node of the
 * column. In each column the sum is stored in the first row if the column's sign is negative, else
 * in the second. Then the first row belongs to all nodes of negative sign, and the second to all
 * nodes of positive sign. The first PAIRS_WITH_Q pairs are replaced in the columns of q too.
 */
typedef struct row_pair {
    uint8_t first, second, mode;
} row_pair;
enum { PAIRS = 14, PAIRS_WITH_Q = 10 };
static const row_pair row_pairs[PAIRS] = {
    {A33M, 10, 1}, {A33D, 11, 1}, {A13, 12, 1},  {15, 20, 1},   {16, 21, 1},
    {A33M, 15, 2}, {A33D, 16, 2}, {A23, 17, 2},  {10, 20, 2},   {11, 21, 2},
    {A11M, 13, 1}, {A11D, 14, 1}, {A22M, 18, 2}, {A22D, 19, 2},
};

/*
 * For each node, the rows that contain its ten stresses after all pairs have been combined, in the
 * order of the rows of A.
 */
static const uint8_t stress_row[4][ROWS] = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9},
    {15, 16, 2, 17, 4, 5, 18, 19, 8, 9},
    {20, 21, 12, 17, 13, 14, 18, 19, 8, 9},
    {10, 11, 12, 3, 13, 14, 6, 7, 8, 9},
};

/* ---- nodal strains ---------------------------------------------------- */

/* y = M^T x */
static void transposed(pzs_real y[3], const pzs_real m[3][3], const pzs_real x[3])
{
    for (int j = 0; j < 3; j++)
        y[j] = m[0][j] * x[0] + m[1][j] * x[1] + m[2][j] * x[2];
}

/*
 * Derivative of node p's strain with respect to its displacement: y = S_a^T own + T_a^T other. The
 * tangent vector lam_a has the factor `own` at node p and the factor `other` at its neighbour in
 * direction a.
 */
static void transpose_derivative(const pzs_element_type *type, int p, int a, const pzs_real own[3],
                                 const pzs_real other[3], pzs_real y[3])
{
    pzs_real t[3];
    transposed(y, type->s[p][a], own);
    transposed(t, type->t[neighbour[p][a]][a], other);
    for (int i = 0; i < 3; i++)
        y[i] += t[i];
}

/*
 * Rows of a mean strain and of its difference at one node, from the derivatives of the mean and
 * difference vectors.
 */
static void write_mean_and_difference(pzs_real h, const pzs_real mean[3], const pzs_real diff[3],
                                      pzs_real *row_mean, pzs_real *row_diff)
{
    const pzs_real quarter = (pzs_real)0.25, h4 = h / 4, hh16 = h * h / 16;
    for (int i = 0; i < 3; i++) {
        row_mean[i] = quarter * mean[i];
        row_mean[i + 3] = hh16 * diff[i];
        row_diff[i] = h4 * diff[i];
        row_diff[i + 3] = h4 * mean[i];
    }
}

/* In-plane strains of node p: 11 and 22 along one direction each, 12 along both. */
static void in_plane(const pzs_element_type *type, const shell_corner shape[4], int p,
                     pzs_real a[ROWS][COLUMNS])
{
    const shell_corner *own = &shape[p];
    pzs_real mean[3], diff[3], more[3];
    for (int d = 0; d < 2; d++) {
        const shell_corner *other = &shape[neighbour[p][d]];
        transpose_derivative(type, p, d, own->mean[d], other->mean[d], mean);
        transpose_derivative(type, p, d, own->diff[d], other->diff[d], diff);
        write_mean_and_difference(type->thickness, mean, diff, a[A11M + 2 * d] + NODE_DOF * p,
                                  a[A11D + 2 * d] + NODE_DOF * p);
    }
    const shell_corner *along1 = &shape[neighbour[p][0]], *along2 = &shape[neighbour[p][1]];
    transpose_derivative(type, p, 0, own->mean[1], along1->mean[1], mean);
    transpose_derivative(type, p, 1, own->mean[0], along2->mean[0], more);
    for (int i = 0; i < 3; i++)
        mean[i] += more[i];
    transpose_derivative(type, p, 0, own->diff[1], along1->diff[1], diff);
    transpose_derivative(type, p, 1, own->diff[0], along2->diff[0], more);
    for (int i = 0; i < 3; i++)
        diff[i] += more[i];
    write_mean_and_difference(type->thickness, mean, diff, a[A12M] + NODE_DOF * p,
                              a[A12D] + NODE_DOF * p);
}

/* Transverse strains 33, 13 and 23 of node p. */
static void transverse(const pzs_element_type *type, const shell_corner shape[4], int p,
                       pzs_real a[ROWS][COLUMNS])
{
    const shell_corner *own = &shape[p];
    const pzs_real quarter = (pzs_real)0.25, h2 = type->thickness / 2;
    for (int d = 0; d < 2; d++) {
        const int n = neighbour[p][d];
        pzs_real *row = a[A13 + d] + NODE_DOF * p, y[3];
        transpose_derivative(type, p, d, own->beta, shape[n].beta, y);
        for (int i = 0; i < 3; i++) {
            row[i] = quarter * y[i];
            row[i + 3] = quarter * own->mean[d][i] -
                         h2 * (own->q * type->s[p][d][2][i] + shape[n].q * type->t[n][d][2][i]);
        }
        a[A13 + d][FIRST_Q + p] = -h2 * own->diff[d][2];
    }
    for (int i = 0; i < 3; i++) {
        a[A33M][NODE_DOF * p + i] = 0;
        a[A33D][NODE_DOF * p + i] = 0;
        a[A33D][NODE_DOF * p + 3 + i] = 0;
        a[A33M][NODE_DOF * p + 3 + i] = quarter * own->beta[i];
    }
    a[A33D][NODE_DOF * p + 5] = -2 * own->q;
    a[A33M][FIRST_Q + p] = 4 * own->q;
    a[A33D][FIRST_Q + p] = -2 * own->beta[2];
}

/*
 * Warped geometry mixes other strains into the mean strain 12: add these contributions to the row
 * of the mean strain 12 at node p. Some of them depend on the signs of the modes 01 and 10 at the
 * node p. They can be included in the row, because the mean strain 12 is used in mode 00 only.
 */
static void add_warp(const pzs_element_type *type, int p, pzs_real a[ROWS][COLUMNS])
{
    const pzs_real *w = type->warp, xi2 = mode_sign[1][p], xi1 = mode_sign[2][p];
    const pzs_real of_13 = w[3] + xi2 * w[1], of_23 = w[4] + xi1 * w[2];
    const pzs_real of_11 = w[5] + xi2 * w[6], of_22 = w[7] + xi1 * w[8];
    for (int i = NODE_DOF * p; i < NODE_DOF * (p + 1); i++)
        a[A12M][i] += w[0] * a[A12D][i] + of_13 * a[A13][i] + of_23 * a[A23][i] +
                      of_11 * a[A11D][i] + of_22 * a[A22D][i];
    a[A12M][FIRST_Q + p] = of_13 * a[A13][FIRST_Q + p] + of_23 * a[A23][FIRST_Q + p];
}

static void nodal_strains(const pzs_element_type *type, const shell_corner shape[4],
                          pzs_real a[ROWS][COLUMNS])
{
    for (int p = 0; p < SHELL_NODES; p++) {
        in_plane(type, shape, p, a);
        transverse(type, shape, p, a);
        add_warp(type, p, a);
    }
}

/* ---- material part ---------------------------------------------------- */

/*
 * Innermost loop of the tangent: the 12 entries of `to` become sum over t of factor[t stride]
 * row[t][column ...]. The list of rows ends with NULL. With a known number of rows, gcc would
 * vectorise over t with slow gather instructions.
 */
static void combine(pzs_real *restrict to, const pzs_real *restrict factor, int stride,
                    const pzs_real *const *restrict row, int column)
{
    const pzs_real *first = *row + column;
    pzs_real sum[HALF];
    UNROLLED
    for (int i = 0; i < HALF; i++)
        sum[i] = *factor * first[i];
    for (row++, factor += stride; *row; row++, factor += stride) {
        const pzs_real *from = *row + column;
        const pzs_real f = *factor;
        UNROLLED
        for (int i = 0; i < HALF; i++)
            sum[i] += f * from[i];
    }
    UNROLLED
    for (int i = 0; i < HALF; i++)
        to[i] = sum[i];
}

/*
 * The sum of combine for the four columns of q. Only the `count` rows to which q contributes are
 * added.
 */
static void combine_q(pzs_real *restrict to, const pzs_real *restrict factor, int stride,
                      const pzs_real *const *row, int count)
{
    const int leading = count < WITH_Q ? count : WITH_Q - 1;
    for (int p = 0; p < SHELL_NODES; p++) {
        to[p] = factor[0] * row[0][FIRST_Q + p];
        for (int t = 1; t < leading; t++)
            to[p] += factor[t * stride] * row[t][FIRST_Q + p];
        if (count == WITH_Q)
            to[p] += factor[A12M * stride] * row[A12M][FIRST_Q + p];
    }
}

/* Whether row s in the list of a mode contains q. */
static bool has_q(const mode_rows *mode, int s)
{
    return mode->with_q == WITH_Q ? s <= A23 || s == A12M : s < mode->with_q;
}

/* Compute y [22][columns], the products D_m A of all modes. */
static void stress_rows(const pzs_element_type *type, unsigned dof_per_node,
                        pzs_real a[ROWS][COLUMNS], pzs_real y[22][COLUMNS])
{
    for (int m = 0; m < SHELL_MODES; m++) {
        const mode_rows *mode = &rows_of_mode[m];
        const pzs_real *row[ROWS + 1];
        for (int t = 0; t < mode->count; t++)
            row[t] = a[mode->strain[t]];
        row[mode->count] = NULL;
        for (int s = 0; s < mode->count; s++) {
            const int i = in_d[mode->strain[s]];
            pzs_real factor[ROWS], *to = y[mode->start + s];
            for (int t = 0; t < mode->count; t++) {
                const int j = in_d[mode->strain[t]];
                factor[t] = type->d[m][i > j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
            }
            combine(to, factor, 1, row, 0);
            combine(to + HALF, factor, 1, row, HALF);
            if (dof_per_node == 7 && has_q(mode, s))
                combine_q(to + FIRST_Q, factor, 1, row, mode->with_q);
        }
    }
}

/*
 * Strains of the modes in one column of A, of node p. Rows without q have no entry in the columns
 * of q.
 */
static void gather_column(pzs_real a[ROWS][COLUMNS], int column, int p, pzs_real e[4][10])
{
    for (int m = 0; m < SHELL_MODES; m++)
        for (int s = 0; s < rows_of_mode[m].count; s++) {
            const int strain = rows_of_mode[m].strain[s];
            const bool is_empty = column >= FIRST_Q && !has_q(&rows_of_mode[0], strain);
            e[m][in_d[strain]] = is_empty ? 0 : mode_sign[m][p] * a[strain][column];
        }
}

/* Write the resultants of one column as entries of the stress rows, without the signs of node p. */
static void scatter_column(pzs_real e[4][10], int column, int p, pzs_real y[22][COLUMNS])
{
    for (int m = 0; m < SHELL_MODES; m++)
        for (int s = 0; s < rows_of_mode[m].count; s++)
            y[rows_of_mode[m].start + s][column] =
                mode_sign[m][p] * e[m][in_d[rows_of_mode[m].strain[s]]];
}

/* The rows of stress_rows for a skewed element, whose modes are coupled, column by column. */
static void skewed_stress_rows(const pzs_element_type *type, unsigned dof_per_node,
                               pzs_real a[ROWS][COLUMNS], pzs_real y[22][COLUMNS])
{
    const int columns = dof_per_node == 7 ? COLUMNS : FIRST_Q;
    for (int column = 0; column < columns; column++) {
        const int p = column < FIRST_Q ? column / NODE_DOF : column - FIRST_Q;
        pzs_real e[4][10];
        gather_column(a, column, p, e);
        pzs_shell_skewed_resultants(type, e);
        scatter_column(e, column, p, y);
    }
}

/*
 * Replace x and y by their sum and their difference in `count` columns. The sum is stored in x if
 * sum_in_x, else in y.
 */
static void sum_and_difference(pzs_real *restrict x, pzs_real *restrict y, int sum_in_x, int count)
{
    for (int i = 0; i < count; i++) {
        const pzs_real sum = x[i] + y[i], difference = x[i] - y[i];
        x[i] = sum_in_x ? sum : difference;
        y[i] = sum_in_x ? difference : sum;
    }
}

/* Combine the stress rows of the modes into the stress rows of the nodes, in place. */
static void modes_to_nodes(unsigned dof_per_node, pzs_real y[22][COLUMNS])
{
    for (int i = 0; i < PAIRS; i++) {
        pzs_real *first = y[row_pairs[i].first], *second = y[row_pairs[i].second];
        const pzs_real *sign = mode_sign[row_pairs[i].mode];
        for (int p = 0; p < SHELL_NODES; p++) {
            sum_and_difference(first + NODE_DOF * p, second + NODE_DOF * p, sign[p] < 0, NODE_DOF);
            if (dof_per_node == 7 && i < PAIRS_WITH_Q)
                sum_and_difference(first + FIRST_Q + p, second + FIRST_Q + p, sign[p] < 0, 1);
        }
    }
}

/* ---- geometric part --------------------------------------------------- */

/*
 * Geometric stiffness between two nodes: mean with mean, and mean with difference. Difference with
 * difference is mean with mean times h^2/4.
 */
typedef struct block {
    pzs_real mean[9];
    pzs_real cross[9];
} block;

/* Index of the pair of nodes p >= other. */
static int pair_of(int p, int other)
{
    return p * (p + 1) / 2 + other;
}

/* z += L' R, times a mean stress and times a stress difference. */
static void add_product(block *restrict z, const pzs_real *restrict l, const pzs_real *restrict r,
                        pzs_real mean, pzs_real cross)
{
    UNROLLED
    for (int i = 0; i < 9; i++) {
        const pzs_real *left = l + i / 3, *right = r + i % 3;
        const pzs_real product = left[0] * right[0] + left[3] * right[3] + left[6] * right[6];
        z->mean[i] += mean * product;
        z->cross[i] += cross * product;
    }
}

/*
 * Contribution of corner r: sum over a and b of t_ab lam_a . lam_b, with lam_a = S_a u_r + T_a
 * u_r'.  t [10] stresses at the corner
 */
static void add_in_plane(const pzs_element_type *type, int r, const pzs_real t[10], block pair[10])
{
    const pzs_real *const map[4] = {type->s[r][0][0], type->s[r][1][0], type->t[r][0][0],
                                    type->t[r][1][0]};
    const int node[4] = {r, r, neighbour[r][0], neighbour[r][1]};
    const pzs_real h = type->thickness;
    const pzs_real mean[3] = {t[E11M], t[E12M], t[E22M]},
                   cross[3] = {h * t[E11D], h * t[E12D], h * t[E22D]};
    for (int x = 0; x < 4; x++)
        for (int y = 0; y < 4; y++)
            if (node[x] >= node[y])
                add_product(&pair[pair_of(node[x], node[y])], map[x], map[y], mean[x % 2 + y % 2],
                            cross[x % 2 + y % 2]);
}

/* Entry of a packed lower triangle, for a row and a column on either side of the diagonal. */
static pzs_real *entry(pzs_real *k, unsigned row, unsigned column)
{
    return row >= column ? k + row * (row + 1) / 2 + column : k + column * (column + 1) / 2 + row;
}

/*
 * Contribution of the transverse stresses at corner r: products of beta and q with the other
 * derivatives.
 */
static void add_transverse(const pzs_element_type *type, unsigned dof_per_node, int r,
                           const pzs_real t[10], pzs_real *k)
{
    const unsigned beta = (unsigned)r * dof_per_node + 3, q = beta + 3;
    for (int a = 0; a < 2; a++) {
        const pzs_real shear = t[E13 + a], h2 = -2 * type->thickness * shear;
        const unsigned own = (unsigned)r * dof_per_node, other = neighbour[r][a] * dof_per_node;
        for (unsigned j = 0; j < 3; j++) {
            for (unsigned i = 0; i < 3; i++) {
                *entry(k, beta + i, own + j) += shear * type->s[r][a][i][j];
                *entry(k, beta + i, other + j) += shear * type->t[r][a][i][j];
            }
            if (dof_per_node == 7) {
                *entry(k, q, own + 3 + j) += h2 * type->s[r][a][2][j];
                *entry(k, q, other + 3 + j) += h2 * type->t[r][a][2][j];
            }
        }
    }
    for (unsigned i = 0; i < 3; i++)
        *entry(k, beta + i, beta + i) += t[E33M];
    if (dof_per_node == 7) {
        *entry(k, q, beta + 2) -= 8 * t[E33D];
        *entry(k, q, q) += 16 * t[E33M];
    }
}

/* ---- the tangent ------------------------------------------------------ */

/*
 * Write row i of node p, up to its diagonal, to its place in k: products A' Y plus the geometric
 * stiffness.
 */
static void write_row(const pzs_real *restrict sum, const block pair[10], pzs_real hh4,
                      unsigned dof_per_node, int p, int i, pzs_real *restrict k)
{
    const unsigned row = (unsigned)p * dof_per_node + (unsigned)i;
    k += row * (row + 1) / 2;
    for (int other = 0; other <= p; other++, k += dof_per_node, sum += NODE_DOF) {
        const block *z = &pair[pair_of(p, other)];
        const pzs_real *with_mean = (i < 3 ? z->mean : z->cross) + i % 3 * 3;
        const pzs_real *with_diff = (i < 3 ? z->cross : z->mean) + i % 3 * 3;
        const pzs_real factor = i < 3 ? 1 : hh4;
        const int last = other < p ? NODE_DOF : i + 1;
        for (int j = 0; j < 3 && j < last; j++)
            k[j] = sum[j] + with_mean[j];
        for (int j = 3; j < last; j++)
            k[j] = sum[j] + factor * with_diff[j - 3];
    }
}

/*
 * Write the rows of node p except that of q.  stress [11] stress rows of the node, the last one
 * NULL
 */
static void write_node(const pzs_element_type *type, unsigned dof_per_node, int p,
                       pzs_real a[ROWS][COLUMNS], const pzs_real *const *stress,
                       const block pair[10], pzs_real *k)
{
    const pzs_real hh4 = type->thickness * type->thickness / 4;
    for (int i = 0; i < NODE_DOF; i++) {
        pzs_real sum[2 * HALF];
        const int first = i < 3 ? WITHOUT_MEAN : 0;
        combine(sum, &a[first][NODE_DOF * p + i], COLUMNS, stress + first, 0);
        if (p >= 2)
            combine(sum + HALF, &a[first][NODE_DOF * p + i], COLUMNS, stress + first, HALF);
        write_row(sum, pair, hh4, dof_per_node, p, i, k);
    }
}

/* Write row and column of the dof q of node p. */
static void write_q(int p, pzs_real a[ROWS][COLUMNS], const pzs_real *const *stress, pzs_real *k)
{
    const pzs_real *row[WITH_Q + 1];
    const unsigned q = 7 * (unsigned)p + 6;
    pzs_real sum[COLUMNS], factor[WITH_Q];
    for (int t = 0; t < WITH_Q; t++) {
        row[t] = stress[q_row[t]];
        factor[t] = a[q_row[t]][FIRST_Q + p];
    }
    row[WITH_Q] = NULL;
    combine(sum, factor, 1, row, 0);
    combine(sum + HALF, factor, 1, row, HALF);
    combine_q(sum + FIRST_Q, &a[0][FIRST_Q + p], COLUMNS, stress, WITH_Q);
    for (unsigned other = 0; other < SHELL_NODES; other++) {
        for (unsigned j = 0; j < NODE_DOF; j++)
            *entry(k, q, 7 * other + j) = sum[NODE_DOF * other + j];
        *entry(k, q, 7 * other + 6) = sum[FIRST_Q + other];
    }
}

/* k from the deformed corners and the stresses t [4][10] at them. */
static void tangent(const pzs_element_type *type, unsigned dof_per_node,
                    const shell_corner shape[4], pzs_real t[4][10], pzs_real *k)
{
    pzs_real a[ROWS][COLUMNS], y[22][COLUMNS];
    block pair[10];
    nodal_strains(type, shape, a);
    if (shell_is_skewed(type))
        skewed_stress_rows(type, dof_per_node, a, y);
    else
        stress_rows(type, dof_per_node, a, y);
    modes_to_nodes(dof_per_node, y);
    memset(pair, 0, sizeof pair);
    for (int r = 0; r < SHELL_NODES; r++)
        add_in_plane(type, r, t[r], pair);
    for (int p = 0; p < SHELL_NODES; p++) {
        const pzs_real *stress[ROWS + 1];
        for (int s = 0; s < ROWS; s++)
            stress[s] = y[stress_row[p][s]];
        stress[ROWS] = NULL;
        write_node(type, dof_per_node, p, a, stress, pair, k);
        if (dof_per_node == 7)
            write_q(p, a, stress, k);
    }
    for (int r = 0; r < SHELL_NODES; r++)
        add_transverse(type, dof_per_node, r, t[r], k);
}

void pzs_shell_system(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                      const pzs_real *given, const pzs_real *resultant, pzs_real *f, pzs_real *k)
{
    pzs_real own[SHELL_RESULTANTS], t[4][10];
    shell_corner shape[4];
    pzs_shell_resultants(type, dof_per_node, u, NULL, given, own);
    pzs_shell_corners(type, dof_per_node, u, shape);
    pzs_shell_stresses(type, own, t);
    pzs_shell_corner_force(type, dof_per_node, shape, t, f);
    if (resultant)
        pzs_shell_stresses(type, resultant, t);
    tangent(type, dof_per_node, shape, t, k);
}

#endif
