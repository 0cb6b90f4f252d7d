/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tangent stiffness of the four-node shell element at a deformed shape (shell.h), in closed form.
 * The four strain modes depend on the nodal displacements in the same way, apart from a sign for
 * each node and mode. One array A of nodal strains (strains per unit of each nodal degree of
 * freedom) therefore serves all modes. With nodes p, r = 0 to 3 and strain modes m:
 *   strains of mode m            s_m(r) A_r, per unit of each degree of freedom of node r
 *   stresses at node p           Y_pr = sum over m of s_m(p) s_m(r) D_m A_r
 *   block p, r of the tangent    K_pr = A_p^T Y_pr + geometric part
 *   m       strain mode ab = 00, 01, 10 or 11, which varies as xi1^a xi2^b with the element
 *           coordinates
 *   s_m(p)  value (1 or -1) of mode m at node p
 *   D_m     stiffness of mode m
 *   A_r     columns of A for node r
 *
 * Columns of A: six degrees of freedom of each of the four nodes, then the seventh one, q, of the
 * four nodes.
 */
#include "../model/shell.h"
#include "../model/shell_corner.h"
#include "../model/shell_skew.h"
#include "../core/unrolled.h"
#include <string.h>

#if PZS_NONLINEAR

enum { NODE_DOF = 6, HALF = 12, FIRST_Q = 24, COLUMNS = 28 };

/*
 * Order of the ten strains in the rows of the array of nodal strains (strains per unit of each
 * nodal degree of freedom). 33 is the change of thickness, 13 and 23 are the transverse shear
 * strains, 11, 22 and 12 the in-plane strains. The suffix M stands for the mean of the two faces, D
 * for their difference. Mean displacements of the two faces do not contribute to A33M and A33D.
 */
enum { A33M, A33D, A13, A23, A11M, A11D, A22M, A22D, A12M, A12D };
enum { ROWS = SHELL_STRAINS, WITH_Q = 5, WITHOUT_MEAN = 2 };
static const uint8_t in_d[ROWS] = {E33M, E33D, E13, E23, E11M, E11D, E22M, E22D, E12M, E12D};

/*
 * Rows of the array of nodal strains (strains per unit of each nodal degree of freedom) to which
 * the seventh degree of freedom q of a node contributes. The mean shear strain A12M is one of them
 * because the correction for warp adds transverse shear strains to it.
 */
static const uint8_t q_row[WITH_Q] = {A33M, A33D, A13, A23, A12M};

/*
 * Strains that the element takes into account in one strain mode (constant, linear or bilinear over
 * the element), with their places in the arrays of this file.
 *   count   number of strains of the mode
 *   with_q  number of these strains that depend on the seventh degree of freedom q of a node
 *   start   row of stress_row_of (stresses per unit of each nodal degree of freedom) for the first
 *           strain; the others follow
 *   strain  for each strain its index in the array of nodal strains (A33M to A12D)
 *   kept    for each strain its place in the packed stiffness of the mode (pzs_element_type.d)
 */
typedef struct mode_rows {
    uint8_t count, with_q, start, strain[ROWS], kept[ROWS];
} mode_rows;
static const mode_rows rows_of_mode[4] = {
    {10,
     5,
     0,
     {A33M, A33D, A13, A23, A11M, A11D, A22M, A22D, A12M, A12D},
     {4, 5, 8, 9, 0, 1, 2, 3, 6, 7}},
    {5, 3, 10, {A33M, A33D, A13, A11M, A11D}, {2, 3, 4, 0, 1}},
    {5, 3, 15, {A33M, A33D, A23, A22M, A22D}, {2, 3, 4, 0, 1}},
    {2, 2, 20, {A33M, A33D}, {0, 1}},
};

/*
 * One step of the fast Walsh-Hadamard transform by which modes_to_nodes turns the stresses of the
 * four strain modes into the stresses at the four nodes. A step combines two rows of stress_row_of
 * that hold stresses for the same strain, by adding and subtracting a strain mode s, which is 1 or
 * -1 at each node. In the columns of node r,
 *   row `second` becomes  first + s_r second, a part of the stress at the nodes where s is 1
 *   row `first` becomes   first - s_r second, a part of the stress at the nodes where s is -1
 *   mode  index (0 to 3) in mode_sign of the strain mode s
 *   s_r   value (1 or -1) of this strain mode at node r
 */
typedef struct row_pair {
    uint8_t first, second, mode;
} row_pair;
// Number of steps of modes_to_nodes, and number of steps that are also made in the columns of q,
// the seventh degree of freedom of a node. The last four steps combine stresses for the strains 11
// and 22, which do not depend on q.
enum { PAIRS = 14, PAIRS_WITH_Q = 10 };
static const row_pair row_pairs[PAIRS] = {
    {A33M, 10, 1}, {A33D, 11, 1}, {A13, 12, 1},  {15, 20, 1},   {16, 21, 1},
    {A33M, 15, 2}, {A33D, 16, 2}, {A23, 17, 2},  {10, 20, 2},   {11, 21, 2},
    {A11M, 13, 1}, {A11D, 14, 1}, {A22M, 18, 2}, {A22D, 19, 2},
};

/*
 * stress_row[p][k]: where the stress at node p for strain k is found after modes_to_nodes, as the
 * index of a row of stress_row_of [22][COLUMNS]. Strains k: 33 mean, 33 difference, 13, 23, then
 * 11, 22 and 12, each mean and difference of the two faces.
 */
static const uint8_t stress_row[4][ROWS] = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9},
    {15, 16, 2, 17, 4, 5, 18, 19, 8, 9},
    {20, 21, 12, 17, 13, 14, 18, 19, 8, 9},
    {10, 11, 12, 3, 13, 14, 6, 7, 8, 9},
};

/* ---- nodal strains ---------------------------------------------------- */

/* Compute the product y of a transposed 3 x 3 matrix and a vector x. */
static void multiply_transposed(pzs_real y[3], const pzs_real matrix[3][3], const pzs_real x[3])
{
    for (int j = 0; j < 3; j++)
        y[j] = matrix[0][j] * x[0] + matrix[1][j] * x[1] + matrix[2][j] * x[2];
}

/*
 * Compute the derivative, with respect to the displacement of one node, of the sum of b . w over
 * the four corners of an element. b is a given vector at each corner, w the derivative of the
 * displacement at the corner in the direction `direction`. The displacement of the node enters w at
 * two corners: at its own, and at the neighbouring corner in this direction.
 *   own   [3] in   vector b at the corner of the node
 *   other [3] in   vector b at the neighbouring corner
 *   row   [3] out  the derivative
 */
static void transpose_derivative(const pzs_element_type *type, int node, int direction,
                                 const pzs_real own[3], const pzs_real other[3], pzs_real row[3])
{
    pzs_real from_other[3];
    multiply_transposed(row, type->s[node][direction], own);
    multiply_transposed(from_other, type->t[neighbour[node][direction]][direction], other);
    for (int i = 0; i < 3; i++)
        row[i] += from_other[i];
}

/*
 * Write two rows of the array of nodal strains (strains per unit of each nodal degree of freedom)
 * for one node: mean and difference over both faces of an in-plane strain b . w, with a base vector
 * b and the derivative w of the displacement along the surface.
 *   strain   in  0 for strain 11, 1 for strain 22, 2 for strain 12
 *   mean [3] in  derivative of b . w by the displacement of the node, if b is the mean of the base
 *                vectors of both faces (1/m)
 *   diff [3] in  the same derivative, if b is the difference of the base vectors of both faces
 *                divided by the thickness (1/m2)
 */
static void write_mean_and_difference(const pzs_element_type *type, int strain,
                                      const pzs_real mean[3], const pzs_real diff[3],
                                      pzs_real *row_mean, pzs_real *row_diff)
{
    const pzs_real quarter = (pzs_real)0.25, h4 = type->thickness / 4,
                   square = quarter * type->height_squared[0][strain],
                   slope = quarter * type->height_squared[1][strain];
    for (int i = 0; i < 3; i++) {
        row_mean[i] = quarter * mean[i];
        row_mean[i + 3] = square * diff[i];
        row_diff[i] = h4 * diff[i];
        row_diff[i + 3] = h4 * mean[i] + slope * diff[i];
    }
}

/*
 * Compute the rows of the in-plane strains of one node in the array of nodal strains (strains per
 * unit of each nodal degree of freedom): strains 11 and 22 from one direction each, strain 12 from
 * both directions.
 */
static void write_in_plane_strains(const pzs_element_type *type, const shell_corner shape[4],
                                   int node, pzs_real nodal[ROWS][COLUMNS])
{
    const shell_corner *own = &shape[node];
    pzs_real mean[3], diff[3], more[3];
    for (int direction = 0; direction < 2; direction++) {
        const shell_corner *other = &shape[neighbour[node][direction]];
        transpose_derivative(type, node, direction, own->mean[direction], other->mean[direction],
                             mean);
        transpose_derivative(type, node, direction, own->diff[direction], other->diff[direction],
                             diff);
        write_mean_and_difference(type, direction, mean, diff,
                                  nodal[A11M + 2 * direction] + NODE_DOF * node,
                                  nodal[A11D + 2 * direction] + NODE_DOF * node);
    }
    const shell_corner *along1 = &shape[neighbour[node][0]], *along2 = &shape[neighbour[node][1]];
    transpose_derivative(type, node, 0, own->mean[1], along1->mean[1], mean);
    transpose_derivative(type, node, 1, own->mean[0], along2->mean[0], more);
    for (int i = 0; i < 3; i++)
        mean[i] += more[i];
    transpose_derivative(type, node, 0, own->diff[1], along1->diff[1], diff);
    transpose_derivative(type, node, 1, own->diff[0], along2->diff[0], more);
    for (int i = 0; i < 3; i++)
        diff[i] += more[i];
    write_mean_and_difference(type, 2, mean, diff, nodal[A12M] + NODE_DOF * node,
                              nodal[A12D] + NODE_DOF * node);
}

/*
 * Compute the rows of the transverse strains 33, 13 and 23 of one node in the array of nodal
 * strains (strains per unit of each nodal degree of freedom).
 */
static void write_transverse_strains(const pzs_element_type *type, const shell_corner shape[4],
                                     int node, pzs_real nodal[ROWS][COLUMNS])
{
    const shell_corner *own = &shape[node];
    const pzs_real quarter = (pzs_real)0.25, h2 = type->thickness / 2;
    for (int direction = 0; direction < 2; direction++) {
        const int other = neighbour[node][direction];
        pzs_real *row = nodal[A13 + direction] + NODE_DOF * node, with_beta[3];
        transpose_derivative(type, node, direction, own->beta, shape[other].beta, with_beta);
        for (int i = 0; i < 3; i++) {
            row[i] = quarter * with_beta[i];
            row[i + 3] = quarter * own->mean[direction][i] -
                         h2 * (own->q * type->s[node][direction][2][i] +
                               shape[other].q * type->t[other][direction][2][i]);
        }
        nodal[A13 + direction][FIRST_Q + node] = -h2 * own->diff[direction][2];
    }
    for (int i = 0; i < 3; i++) {
        nodal[A33M][NODE_DOF * node + i] = 0;
        nodal[A33D][NODE_DOF * node + i] = 0;
        nodal[A33D][NODE_DOF * node + 3 + i] = 0;
        nodal[A33M][NODE_DOF * node + 3 + i] = quarter * own->beta[i];
    }
    nodal[A33D][NODE_DOF * node + 5] = -2 * own->q;
    nodal[A33M][FIRST_Q + node] = 4 * own->q;
    nodal[A33D][FIRST_Q + node] = -2 * own->beta[2];
}

/*
 * Correct the mean strain 12 of one node for the warp of the element, its distance from a plane, in
 * the array of nodal strains (strains per unit of each nodal degree of freedom). Five other strains
 * of the node are added, each times a factor that follows from the shape of the element
 * (type->warp): 13, 23, and the differences of 12, 11 and 22.
 */
static void add_warp(const pzs_element_type *type, int node, pzs_real nodal[ROWS][COLUMNS])
{
    const pzs_real *w = type->warp, xi2 = mode_sign[1][node], xi1 = mode_sign[2][node];
    // Four of the factors (w[1], w[2], w[6], w[8]) multiply strains that vary linearly over the
    // element. In such a strain the entries of a node have the sign of the element coordinate xi1
    // or xi2 at the node.
    const pzs_real of_13 = w[3] + xi2 * w[1], of_23 = w[4] + xi1 * w[2];
    const pzs_real of_11 = w[5] + xi2 * w[6], of_22 = w[7] + xi1 * w[8];
    for (int i = NODE_DOF * node; i < NODE_DOF * (node + 1); i++)
        nodal[A12M][i] += w[0] * nodal[A12D][i] + of_13 * nodal[A13][i] + of_23 * nodal[A23][i] +
                          of_11 * nodal[A11D][i] + of_22 * nodal[A22D][i];
    nodal[A12M][FIRST_Q + node] =
        of_13 * nodal[A13][FIRST_Q + node] + of_23 * nodal[A23][FIRST_Q + node];
}

static void nodal_strains(const pzs_element_type *type, const shell_corner shape[4],
                          pzs_real nodal[ROWS][COLUMNS])
{
    for (int node = 0; node < SHELL_NODES; node++) {
        write_in_plane_strains(type, shape, node, nodal);
        write_transverse_strains(type, shape, node, nodal);
        add_warp(type, node, nodal);
    }
}

/* ---- material part ---------------------------------------------------- */

/*
 * Compute 12 entries, from index `column` on, of a linear combination of rows: the sum over i of
 * factor[i * stride] times row[i]. This is the innermost loop of the tangent stiffness. The list of
 * rows ends with NULL: with a known number of rows gcc would use slow gather instructions.
 */
static void sum_rows(pzs_real *restrict to, const pzs_real *restrict factor, int stride,
                     const pzs_real *const *restrict row, int column)
{
    const pzs_real *first = *row + column;
    pzs_real sum[HALF];
    UNROLLED
    for (int i = 0; i < HALF; i++)
        sum[i] = *factor * first[i];
    for (row++, factor += stride; *row; row++, factor += stride) {
        const pzs_real *from = *row + column;
        const pzs_real multiplier = *factor;
        UNROLLED
        for (int i = 0; i < HALF; i++)
            sum[i] += multiplier * from[i];
    }
    UNROLLED
    for (int i = 0; i < HALF; i++)
        to[i] = sum[i];
}

/*
 * Compute the sum over i of factor[i * stride] times row[i], in the four columns that belong to the
 * seventh degree of freedom q of the four nodes (displacement of the middle surface minus the mean
 * of both faces).
 *   to    [4] out  result
 *   row       in   rows of strains or stresses per unit of each nodal degree of freedom
 *   count     in   number of rows that are not zero in these columns: rows 0 to count - 1, or rows
 *                  0 to 3 and row A12M (mean strain 12) if count is WITH_Q
 */
static void sum_q_rows(pzs_real *restrict to, const pzs_real *restrict factor, int stride,
                       const pzs_real *const *row, int count)
{
    const int leading = count < WITH_Q ? count : WITH_Q - 1;
    for (int node = 0; node < SHELL_NODES; node++) {
        to[node] = factor[0] * row[0][FIRST_Q + node];
        for (int index = 1; index < leading; index++)
            to[node] += factor[index * stride] * row[index][FIRST_Q + node];
        if (count == WITH_Q)
            to[node] += factor[A12M * stride] * row[A12M][FIRST_Q + node];
    }
}

/*
 * Whether a strain of a strain mode (constant, linear or bilinear over the element) depends on the
 * seventh degree of freedom q of the nodes, the displacement of the middle surface minus the mean
 * of both faces. `row` is the index of the strain in mode->strain, which lists the strains of the
 * mode.
 */
static bool has_q(const mode_rows *mode, int row)
{
    return mode->with_q == WITH_Q ? row <= A23 || row == A12M : row < mode->with_q;
}

/*
 * Compute the stresses of an element per unit of each nodal degree of freedom: the stiffness of
 * each strain mode times the nodal strains.
 *   nodal         [10][28] in   ten strains per unit of each of the 28 nodal degrees of freedom
 *   stress_row_of [22][28] out  stresses: ten rows for strain mode 00, five for 01, five for 10,
 *                               two for 11 (rows_of_mode); mode ab varies as xi1^a xi2^b
 */
static void stress_rows(const pzs_element_type *type, unsigned dof_per_node,
                        pzs_real nodal[ROWS][COLUMNS], pzs_real stress_row_of[22][COLUMNS])
{
    for (int number = 0; number < SHELL_MODES; number++) {
        const mode_rows *mode = &rows_of_mode[number];
        const pzs_real *row[ROWS + 1];
        for (int index = 0; index < mode->count; index++)
            row[index] = nodal[mode->strain[index]];
        row[mode->count] = NULL;
        const pzs_real *stiffness = type->d + first_entry[number];
        for (int stress = 0; stress < mode->count; stress++) {
            const int i = mode->kept[stress];
            pzs_real factor[ROWS], *to = stress_row_of[mode->start + stress];
            for (int index = 0; index < mode->count; index++) {
                const int j = mode->kept[index];
                factor[index] = stiffness[i > j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
            }
            sum_rows(to, factor, 1, row, 0);
            sum_rows(to + HALF, factor, 1, row, HALF);
            if (dof_per_node == 7 && has_q(mode, stress))
                sum_q_rows(to + FIRST_Q, factor, 1, row, mode->with_q);
        }
    }
}

/*
 * Collect the strains that a unit displacement of one degree of freedom causes in the four strain
 * modes of an element, from its column of the array of nodal strains.
 *   column  in   index of the degree of freedom, the column in the array of nodal strains
 *   node    in   node to which the degree of freedom belongs
 *   strains out  strains of each mode, in the order of pzs_element_type.d; a column of the seventh
 *                degree of freedom q has zeros for strains that do not depend on q
 */
static void gather_column(pzs_real nodal[ROWS][COLUMNS], int column, int node,
                          pzs_real strains[4][10])
{
    for (int mode = 0; mode < SHELL_MODES; mode++)
        for (int row = 0; row < rows_of_mode[mode].count; row++) {
            const int strain = rows_of_mode[mode].strain[row];
            const bool is_empty = column >= FIRST_Q && !has_q(&rows_of_mode[0], strain);
            strains[mode][in_d[strain]] =
                is_empty ? 0 : mode_sign[mode][node] * nodal[strain][column];
        }
}

/*
 * Write one column of stress_row_of [22][COLUMNS]: the stress resultants that a unit displacement
 * of one degree of freedom of `node` causes in the four strain modes. Each resultant is divided by
 * the value (1 or -1) of its mode at the node, because modes_to_nodes multiplies it by this value.
 */
static void scatter_column(pzs_real resultant[4][10], int column, int node,
                           pzs_real stress_row_of[22][COLUMNS])
{
    for (int mode = 0; mode < SHELL_MODES; mode++)
        for (int row = 0; row < rows_of_mode[mode].count; row++)
            stress_row_of[rows_of_mode[mode].start + row][column] =
                mode_sign[mode][node] * resultant[mode][in_d[rows_of_mode[mode].strain[row]]];
}

/*
 * Compute the stresses per unit of each nodal degree of freedom for a skewed element, column by
 * column, because its strain modes (constant, linear and bilinear over the element) are coupled.
 *   nodal         [ROWS][COLUMNS] in   strains per unit of each nodal degree of freedom
 *   stress_row_of [22][COLUMNS]   out  stresses, in the order of rows_of_mode
 */
static void skewed_stress_rows(const pzs_element_type *type, unsigned dof_per_node,
                               pzs_real nodal[ROWS][COLUMNS], pzs_real stress_row_of[22][COLUMNS])
{
    const int columns = dof_per_node == 7 ? COLUMNS : FIRST_Q;
    for (int column = 0; column < columns; column++) {
        const int node = column < FIRST_Q ? column / NODE_DOF : column - FIRST_Q;
        pzs_real strains[4][10];
        gather_column(nodal, column, node, strains);
        pzs_shell_skewed_resultants(type, strains);
        scatter_column(strains, column, node, stress_row_of);
    }
}

/*
 * Replace two rows of `count` numbers by their sum and their difference. The first row receives the
 * sum if sum_in_first is true, otherwise the second row does.
 */
static void sum_and_difference(pzs_real *restrict first, pzs_real *restrict second,
                               int sum_in_first, int count)
{
    for (int i = 0; i < count; i++) {
        const pzs_real sum = first[i] + second[i], difference = first[i] - second[i];
        first[i] = sum_in_first ? sum : difference;
        second[i] = sum_in_first ? difference : sum;
    }
}

/*
 * Turn the stresses of an element in its four strain modes into the stresses at its four nodes, in
 * place, by a fast Walsh-Hadamard transform. All are stresses per unit of each of the 28 nodal
 * degrees of freedom. In the columns of node r,
 *   stress at node p = sum over m of s_m(p) s_m(r) (row of mode m)
 *   m       strain mode ab = 00, 01, 10 or 11, which varies over the element as xi1^a xi2^b
 *   s_m(p)  value (1 or -1) of mode m at node p
 *   s_m(r)  sign with which node r contributes to the strains of mode m; the rows of the modes do
 *           not contain it
 *   stress_row_of [22][28] in/out  in: rows of the four modes, one for each of the 10 + 5 + 5 + 2
 *                                  stresses of the modes (rows_of_mode); out: rows of the nodes,
 *                                  listed in stress_row
 */
static void modes_to_nodes(unsigned dof_per_node, pzs_real stress_row_of[22][COLUMNS])
{
    // Each step of the transform combines two rows into their sum and their difference; the sign of
    // the strain mode at the node decides which row receives the sum (row_pair).
    for (int i = 0; i < PAIRS; i++) {
        pzs_real *first = stress_row_of[row_pairs[i].first],
                 *second = stress_row_of[row_pairs[i].second];
        const pzs_real *sign = mode_sign[row_pairs[i].mode];
        for (int node = 0; node < SHELL_NODES; node++) {
            sum_and_difference(first + NODE_DOF * node, second + NODE_DOF * node, sign[node] < 0,
                               NODE_DOF);
            if (dof_per_node == 7 && i < PAIRS_WITH_Q)
                sum_and_difference(first + FIRST_Q + node, second + FIRST_Q + node, sign[node] < 0,
                                   1);
        }
    }
}

/* ---- geometric part --------------------------------------------------- */

/*
 * Geometric stiffness between two nodes of an element, as three 3 x 3 matrices:
 *   mean   couples the mean displacements of both faces at both nodes
 *   cross  couples the mean displacement at one node with the difference over the thickness at the
 *          other
 *   diff   couples the differences over the thickness at both nodes
 */
typedef struct block {
    pzs_real mean[9];
    pzs_real cross[9];
    pzs_real diff[9];
} block;

/*
 * Factors with which one in-plane stress at a corner enters the geometric stiffness. The nonlinear
 * part of the corresponding strain is a product of two displacement derivatives. Each derivative
 * has a mean over both faces and a difference, which is divided by the thickness.
 *   mean   factor of mean times mean (N m)
 *   cross  factor of mean times difference (N m2)
 *   diff   factor of difference times difference (N m3)
 */
typedef struct conjugate {
    pzs_real mean, cross, diff;
} conjugate;

/*
 * Return the index of the pair of corners (node, other), for node >= other, among the ten pairs of
 * corners of an element.
 */
static int pair_of(int node, int other)
{
    return node * (node + 1) / 2 + other;
}

/*
 * Add to the geometric stiffness between two nodes of an element what one in-plane stress (11, 22
 * or 12) at a corner contributes. With P = left_map^T right_map, it adds stress.mean * P to
 * pair->mean, stress.cross * P to pair->cross, and stress.diff * P to pair->diff.
 *   left_map  [3][3] in  derivative of the displacement at the corner along the first direction of
 *                        the stress (1 for stress 12), per unit displacement of the first node
 *   right_map [3][3] in  derivative along the second direction (2 for stress 12), per unit
 *                        displacement of the second node
 */
static void add_product(block *restrict pair, const pzs_real *restrict left_map,
                        const pzs_real *restrict right_map, conjugate stress)
{
    UNROLLED
    for (int i = 0; i < 9; i++) {
        const pzs_real *left = left_map + i / 3, *right = right_map + i % 3;
        const pzs_real product = left[0] * right[0] + left[3] * right[3] + left[6] * right[6];
        pair->mean[i] += stress.mean * product;
        pair->cross[i] += stress.cross * product;
        pair->diff[i] += stress.diff * product;
    }
}

/*
 * Add the geometric stiffness of the in-plane stresses at one corner of an element, the second
 * derivative of
 *   sum over the directions a and b of stress_ab * (w_a . w_b) / 2
 *   a, b  direction: 1 along the surface coordinate theta1, 2 along theta2
 *   w_a   derivative of the displacement in direction a, from the displacements of the corner and
 *         of the next corner in direction a
 *   stress [10]  in      stresses at the corner, in the strain order of pzs_element_type.d
 *   pair   [10]  in/out  geometric stiffness between two nodes, for each pair (pair_of)
 */
static void add_in_plane(const pzs_element_type *type, int corner, const pzs_real stress[10],
                         block pair[10])
{
    const pzs_real *const map[4] = {type->s[corner][0][0], type->s[corner][1][0],
                                    type->t[corner][0][0], type->t[corner][1][0]};
    const int node[4] = {corner, corner, neighbour[corner][0], neighbour[corner][1]};
    const pzs_real thickness = type->thickness;
    pzs_real quadratic[3];
    shell_quadratic_stresses(type, stress, quadratic);
    const conjugate of_sum[3] = {{stress[E11M], thickness * stress[E11D], quadratic[0]},
                                 {stress[E12M], thickness * stress[E12D], quadratic[2]},
                                 {stress[E22M], thickness * stress[E22D], quadratic[1]}};
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            if (node[row] >= node[column])
                add_product(&pair[pair_of(node[row], node[column])], map[row], map[column],
                            of_sum[row % 2 + column % 2]);
}

/*
 * Return the address of an entry in a packed lower triangle of a symmetric matrix, for a row and a
 * column on either side of the diagonal.
 */
static pzs_real *packed_entry(pzs_real *stiffness, unsigned row, unsigned column)
{
    return row >= column ? stiffness + row * (row + 1) / 2 + column
                         : stiffness + column * (column + 1) / 2 + row;
}

/*
 * Add the geometric stiffness by the transverse stresses 33, 13 and 23 at one corner of an element:
 * the second derivative of (stress times strain) by the degrees of freedom. It follows from the
 * quadratic terms of the strains at the corner, which are, apart from constant factors,
 *   13 (a = 1), 23 (a = 2)  beta . w_a  and  q d_a
 *   33, mean of both faces  beta . beta  and  q^2
 *   33, difference of both  q beta_3
 *   beta  change of the director (degrees of freedom 3 to 5 of the node); beta_3: its third
 *         component
 *   q     displacement of the middle surface minus the mean of both faces, divided by the thickness
 *         (degree of freedom 6)
 *   w_a   derivative of the mean displacement of both faces along surface coordinate theta_a
 *   d_a   third component of the derivative of beta along theta_a
 */
static void add_transverse(const pzs_element_type *type, unsigned dof_per_node, int corner,
                           const pzs_real stress[10], pzs_real *stiffness)
{
    const unsigned beta = (unsigned)corner * dof_per_node + 3, q = beta + 3;
    for (int direction = 0; direction < 2; direction++) {
        const pzs_real shear = stress[E13 + direction], h2 = -2 * type->thickness * shear;
        const unsigned own = (unsigned)corner * dof_per_node,
                       other = neighbour[corner][direction] * dof_per_node;
        for (unsigned j = 0; j < 3; j++) {
            for (unsigned i = 0; i < 3; i++) {
                *packed_entry(stiffness, beta + i, own + j) +=
                    shear * type->s[corner][direction][i][j];
                *packed_entry(stiffness, beta + i, other + j) +=
                    shear * type->t[corner][direction][i][j];
            }
            if (dof_per_node == 7) {
                *packed_entry(stiffness, q, own + 3 + j) += h2 * type->s[corner][direction][2][j];
                *packed_entry(stiffness, q, other + 3 + j) += h2 * type->t[corner][direction][2][j];
            }
        }
    }
    for (unsigned i = 0; i < 3; i++)
        *packed_entry(stiffness, beta + i, beta + i) += stress[E33M];
    if (dof_per_node == 7) {
        *packed_entry(stiffness, q, beta + 2) -= 8 * stress[E33D];
        *packed_entry(stiffness, q, q) += 16 * stress[E33M];
    }
}

/* ---- the tangent ------------------------------------------------------ */

/*
 * Write row i (0 to 5) of one node into the packed lower triangle of an element's tangent
 * stiffness, up to the diagonal entry: material part plus geometric part.
 *   sum  [6 (node + 1)] in  material part: entries in the columns of the nodes 0 to `node`
 *   pair [10]           in  geometric stiffness between two nodes, for each pair (pair_of)
 */
static void write_row(const pzs_real *restrict sum, const block pair[10], unsigned dof_per_node,
                      int node, int i, pzs_real *restrict stiffness)
{
    const unsigned row = (unsigned)node * dof_per_node + (unsigned)i;
    stiffness += row * (row + 1) / 2;
    for (int other = 0; other <= node; other++, stiffness += dof_per_node, sum += NODE_DOF) {
        const block *between = &pair[pair_of(node, other)];
        const pzs_real *with_mean = (i < 3 ? between->mean : between->cross) + i % 3 * 3;
        const pzs_real *with_diff = (i < 3 ? between->cross : between->diff) + i % 3 * 3;
        const int last = other < node ? NODE_DOF : i + 1;
        for (int j = 0; j < 3 && j < last; j++)
            stiffness[j] = sum[j] + with_mean[j];
        for (int j = 3; j < last; j++)
            stiffness[j] = sum[j] + with_diff[j - 3];
    }
}

/*
 * Write the rows of the first six degrees of freedom of one node into the packed tangent stiffness
 * of an element: products of strains and stresses, plus the geometric stiffness.
 *   nodal  [ROWS][COLUMNS] in  strains per unit of each nodal degree of freedom
 *   stress [ROWS + 1]      in  pointers to the stresses at the node per unit of each nodal degree
 *                              of freedom, [COLUMNS] for each strain in the order of `nodal`; then
 *                              NULL
 *   pair   [10]            in  geometric stiffness between two nodes, for each pair (pair_of)
 */
static void write_node(unsigned dof_per_node, int node, pzs_real nodal[ROWS][COLUMNS],
                       const pzs_real *const *stress, const block pair[10], pzs_real *stiffness)
{
    for (int i = 0; i < NODE_DOF; i++) {
        pzs_real sum[2 * HALF];
        const int first = i < 3 ? WITHOUT_MEAN : 0;
        sum_rows(sum, &nodal[first][NODE_DOF * node + i], COLUMNS, stress + first, 0);
        if (node >= 2)
            sum_rows(sum + HALF, &nodal[first][NODE_DOF * node + i], COLUMNS, stress + first, HALF);
        write_row(sum, pair, dof_per_node, node, i, stiffness);
    }
}

/*
 * Write the row and the column that belong to the degree of freedom q of one node into the packed
 * tangent stiffness of an element. q, the seventh degree of freedom, is the displacement of the
 * middle surface minus the mean of both faces.
 */
static void write_q(int node, pzs_real nodal[ROWS][COLUMNS], const pzs_real *const *stress,
                    pzs_real *stiffness)
{
    const pzs_real *row[WITH_Q + 1];
    const unsigned row_of_q = 7 * (unsigned)node + 6;
    pzs_real sum[COLUMNS], factor[WITH_Q];
    for (int index = 0; index < WITH_Q; index++) {
        row[index] = stress[q_row[index]];
        factor[index] = nodal[q_row[index]][FIRST_Q + node];
    }
    row[WITH_Q] = NULL;
    sum_rows(sum, factor, 1, row, 0);
    sum_rows(sum + HALF, factor, 1, row, HALF);
    sum_q_rows(sum + FIRST_Q, &nodal[0][FIRST_Q + node], COLUMNS, stress, WITH_Q);
    for (unsigned other = 0; other < SHELL_NODES; other++) {
        for (unsigned j = 0; j < NODE_DOF; j++)
            *packed_entry(stiffness, row_of_q, 7 * other + j) = sum[NODE_DOF * other + j];
        *packed_entry(stiffness, row_of_q, 7 * other + 6) = sum[FIRST_Q + other];
    }
}

/*
 * Compute the packed tangent stiffness of an element from the deformed base vectors and the ten
 * stresses (in the strain order of pzs_element_type.d) at each of its four corners.
 */
static void compute_tangent(const pzs_element_type *type, unsigned dof_per_node,
                            const shell_corner shape[4], pzs_real corner_stress[4][10],
                            pzs_real *stiffness)
{
    pzs_real nodal[ROWS][COLUMNS], stress_row_of[22][COLUMNS];
    block pair[10];
    nodal_strains(type, shape, nodal);
    if (shell_is_skewed(type))
        skewed_stress_rows(type, dof_per_node, nodal, stress_row_of);
    else
        stress_rows(type, dof_per_node, nodal, stress_row_of);
    modes_to_nodes(dof_per_node, stress_row_of);
    memset(pair, 0, sizeof pair);
    for (int corner = 0; corner < SHELL_NODES; corner++)
        add_in_plane(type, corner, corner_stress[corner], pair);
    for (int node = 0; node < SHELL_NODES; node++) {
        const pzs_real *stress[ROWS + 1];
        for (int index = 0; index < ROWS; index++)
            stress[index] = stress_row_of[stress_row[node][index]];
        stress[ROWS] = NULL;
        write_node(dof_per_node, node, nodal, stress, pair, stiffness);
        if (dof_per_node == 7)
            write_q(node, nodal, stress, stiffness);
    }
    for (int corner = 0; corner < SHELL_NODES; corner++)
        add_transverse(type, dof_per_node, corner, corner_stress[corner], stiffness);
}

void pzs_shell_system(const pzs_element_type *type, unsigned dof_per_node,
                      const pzs_real *displacement, const pzs_real *given,
                      const pzs_real *resultant, pzs_real *force, pzs_real *stiffness)
{
    pzs_real own[SHELL_RESULTANTS], stress[4][10];
    shell_corner shape[4];
    pzs_shell_resultants(type, dof_per_node, displacement, NULL, given, own);
    pzs_shell_corners(type, dof_per_node, displacement, shape);
    pzs_shell_stresses(type, own, stress);
    pzs_shell_corner_force(type, dof_per_node, shape, stress, force);
    if (resultant)
        pzs_shell_stresses(type, resultant, stress);
    compute_tangent(type, dof_per_node, shape, stress, stiffness);
}

#endif
