/* SPDX-License-Identifier: BSD-2-Clause */
/* Warping correction of the membrane shear strain of an element (warp.h). */
#include "warp.h"
#include "../quads/vector.h"
#include <math.h>
#include <string.h>

/*
 * Size of the linear system for the factors c_i of the warping correction (warp.h). ROWS: number of
 * factors. TILTS: number of equations, one for the tilt of each corner's director (thickness
 * direction) about each of two local axes, which must not change the correction.
 */
enum { ROWS = 8, TILTS = 8 };

/*
 * Linear system a c = y for the eight factors c_i of the warping correction (warp.h). Row j belongs
 * to a unit tilt of the director (thickness direction) of one corner along its local axis e1 or e2.
 * This tilt causes eight strains e_i, the entries a_ji, and the difference y_j of the shear strain
 * 12 between both faces.
 */
typedef struct tilt_system {
    double matrix[TILTS][ROWS], right_side[TILTS];
} tilt_system;

static const int neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};

/* Natural coordinates xi2 and xi1 of the four corners of an element. */
static const double xi2[4] = {-1, -1, 1, 1}, xi1[4] = {-1, 1, 1, -1};

/*
 * Compute the derivative of the director at a corner along direction 1 or 2 of the element, when
 * the unit vector of a local axis of one node is added to the director of that node (a tilt).
 *   direction in   0: direction 1, 1: direction 2
 *   j         in   local axis of the node, 0: e1, 1: e2
 *   out   [3] out  derivative (1/m)
 */
static void tilt_derivative(const pzs_element_type *type, int corner, int direction, int node,
                            int j, double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = corner == node ? type->s[corner][direction][i][j] : 0;
        if (neighbour[corner][direction] == node)
            out[i] += type->t[corner][direction][i][j];
    }
}

/*
 * Compute the vector whose product with the director's derivative along a direction is the
 * difference of an in-plane strain between the faces, at a corner of an element.
 *   strain in  0 for strain 11, 1 for strain 22, 2 for strain 12
 */
static void slope_base(const pzs_element_type *type, int corner, int direction, int strain,
                       double out[3])
{
    /*
     * thickness times mean base vector; the second term belongs to strains with a part quadratic in
     * the height
     */
    for (int i = 0; i < 3; i++)
        out[i] = type->thickness * type->g_mean[corner][direction][i] +
                 type->height_squared[1][strain] * type->g_diff[corner][direction][i];
}

/*
 * Add the share of one corner to eight strains e_i of an element (warp_fill), caused by a unit tilt
 * of a node's director (thickness direction). Each e_i is the mean over the four corners of a
 * strain times a factor:
 *   strain  13    23    13  23  11  11    22  22
 *   factor  xi2   xi1   1   1   1   xi2   1   xi1
 *   xi1, xi2     natural coordinates of the corner; strains 11 and 22: difference of both faces
 *   node, j      in      tilted node, and axis of the tilt: 0 for local axis e1, 1 for e2
 *   row  [8]     in/out  the strains e_i, in this order
 *   shear        in/out  difference of the shear strain 12 between both faces, mean over corners
 */
static void add_corner(const pzs_element_type *type, int corner, int node, int j, double row[ROWS],
                       double *shear)
{
    const double *g1 = type->g_mean[corner][0], *g2 = type->g_mean[corner][1];
    double along1[3], along2[3], base[2][3], shear_base[2][3];
    for (int direction = 0; direction < 2; direction++) {
        slope_base(type, corner, direction, direction, base[direction]);
        slope_base(type, corner, direction, 2, shear_base[direction]);
    }
    tilt_derivative(type, corner, 0, node, j, along1);
    tilt_derivative(type, corner, 1, node, j, along2);
    const double e11 = vector_dot(base[0], along1), e22 = vector_dot(base[1], along2);
    const double e13 = corner == node ? g1[j] : 0;
    const double e23 = corner == node ? g2[j] : 0;
    const double strain[ROWS] = {
        xi2[corner] * e13, xi1[corner] * e23, e13, e23, e11, xi2[corner] * e11, e22,
        xi1[corner] * e22};
    for (int k = 0; k < ROWS; k++)
        row[k] += strain[k] / 4;
    *shear += (vector_dot(shear_base[0], along2) + vector_dot(shear_base[1], along1)) / 4;
}

static void fill_system(const pzs_element_type *type, tilt_system *equations)
{
    memset(equations, 0, sizeof *equations);
    for (int node = 0; node < 4; node++)
        for (int j = 0; j < 2; j++)
            for (int corner = 0; corner < 4; corner++)
                add_corner(type, corner, node, j, equations->matrix[2 * node + j],
                           &equations->right_side[2 * node + j]);
}

/*
 * Divide every column of the linear system for the warping correction by its largest absolute
 * entry, because the columns differ in size: strains of bending contain the thickness, those of
 * transverse shear do not.
 *   scale [8] out  largest absolute entry of each column
 */
static void scale_columns(tilt_system *equations, double scale[ROWS])
{
    for (int k = 0; k < ROWS; k++) {
        scale[k] = 0;
        for (int i = 0; i < TILTS; i++)
            scale[k] = fmax(scale[k], fabs(equations->matrix[i][k]));
        for (int i = 0; i < TILTS && scale[k] > 0; i++)
            equations->matrix[i][k] /= scale[k];
    }
}

static void swap(double *first, double *second)
{
    const double kept = *first;
    *first = *second;
    *second = kept;
}

/*
 * Find the largest entry of the linear system for the warping correction among the rows and columns
 * with index `from` and above. Returns its absolute value.
 */
static double find_pivot(const tilt_system *equations, int from, int *row, int *column)
{
    double largest = -1;
    for (int i = from; i < TILTS; i++)
        for (int k = from; k < ROWS; k++)
            if (fabs(equations->matrix[i][k]) > largest) {
                largest = fabs(equations->matrix[i][k]);
                *row = i;
                *column = k;
            }
    return largest;
}

/*
 * Eliminate column `step` of the linear system for the warping correction of an element from all
 * equations except equation number `step`.
 */
static void eliminate(tilt_system *equations, int step)
{
    for (int i = 0; i < TILTS; i++) {
        const double factor = equations->matrix[i][step] / equations->matrix[step][step];
        if (i == step)
            continue;
        for (int k = step; k < ROWS; k++)
            equations->matrix[i][k] -= factor * equations->matrix[step][k];
        equations->right_side[i] -= factor * equations->right_side[step];
    }
}

/*
 * Bring the linear system for the warping correction of an element to diagonal form, by
 * Gauss-Jordan elimination with complete pivoting.
 *   order [8] out  index of the unknown that belongs to each column after the column exchanges
 * Returns the rank.
 */
static int reduce(tilt_system *equations, int order[ROWS])
{
    for (int k = 0; k < ROWS; k++)
        order[k] = k;
    for (int step = 0; step < ROWS; step++) {
        int row = step, column = step;
        if (!(find_pivot(equations, step, &row, &column) > 1e-10))
            return step;
        for (int k = 0; k < ROWS; k++)
            swap(&equations->matrix[step][k], &equations->matrix[row][k]);
        swap(&equations->right_side[step], &equations->right_side[row]);
        for (int i = 0; i < TILTS; i++)
            swap(&equations->matrix[i][step], &equations->matrix[i][column]);
        const int kept = order[step];
        order[step] = order[column];
        order[column] = kept;
        eliminate(equations, step);
    }
    return ROWS;
}

/*
 * Solve eight linear equations by elimination, also of a rank r < 8: the last 8 - r unknowns in
 * pivot order are then 0. Unknowns as small as a rounding error become 0 too.
 *   factors [8] out  unknowns: factors c_k of the warping correction (warp_fill)
 * Returns 0, or -1 if one of the last 8 - r equations is not satisfied up to rounding errors, or a
 * number is not finite.
 */
static int solve(tilt_system *equations, double factors[ROWS])
{
    double scale[ROWS], size = 0, value[ROWS] = {0};
    int order[ROWS];
    scale_columns(equations, scale);
    for (int i = 0; i < TILTS; i++)
        size = fmax(size, fabs(equations->right_side[i]));
    const int rank = reduce(equations, order);
    for (int i = rank; i < TILTS; i++)
        if (!(fabs(equations->right_side[i]) <= 1e-8 * size))
            return -1;
    for (int k = 0; k < rank; k++)
        value[order[k]] = equations->right_side[k] / equations->matrix[k][k];
    for (int k = 0; k < ROWS; k++) {
        factors[k] = fabs(value[k]) <= 1e-13 * size ? 0 : value[k] / scale[k];
        if (!isfinite(factors[k]) || !isfinite(size))
            return -1;
    }
    return 0;
}

int warp_fill(pzs_element_type *type, double share)
{
    tilt_system equations;
    double factors[ROWS];
    memset(type->warp, 0, sizeof type->warp);
    if (!(fabs(share) > 0))
        return 0;
    fill_system(type, &equations);
    if (solve(&equations, factors) < 0)
        return -1;
    type->warp[0] = share;
    for (int k = 0; k < ROWS; k++)
        type->warp[1 + k] = 0 - share * factors[k]; /* a coefficient of the warping correction is
                                                       subtracted from 0 rather than negated, so
                                                       that 0 has no sign */
    return 0;
}
