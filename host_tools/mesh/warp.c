/* SPDX-License-Identifier: BSD-2-Clause */
/* Share of the warp in the membrane shear of an element (warp.h). */
#include "warp.h"
#include "../quads/vector.h"
#include <math.h>
#include <string.h>

/*
 * Columns are the factors c of the eight rows of warp.h. Equations are the tilts of four nodes'
 * directors about two axes.
 */
enum { ROWS = 8, TILTS = 8 };

/*
 * Linear system a c = y for c [ROWS]: the columns of a are the strains of the rows under each tilt,
 * y is the 12 difference under each tilt.
 */
typedef struct tilt_system {
    double a[TILTS][ROWS], y[TILTS];
} tilt_system;

static const int neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};

/* xi2 and xi1 at the corners: the signs of the modes 01 and 10. */
static const double xi2[4] = {-1, -1, 1, 1}, xi1[4] = {-1, 1, 1, -1};

/*
 * Derivative along direction a, at corner r, of a unit tilt along e_(j+1) of the director of node
 * p.
 */
static void tilt_derivative(const pzs_element_type *type, int r, int a, int p, int j, double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = r == p ? type->s[r][a][i][j] : 0;
        if (neighbour[r][a] == p)
            out[i] += type->t[r][a][i][j];
    }
}

/*
 * Add the strains at corner r under a tilt of node p along e_(j+1), with the weights of the modes
 * of the rows.
 */
static void add_corner(const pzs_element_type *type, int r, int p, int j, double row[ROWS],
                       double *y)
{
    const double h = type->thickness, *g1 = type->g_mean[r][0], *g2 = type->g_mean[r][1];
    double along1[3], along2[3];
    tilt_derivative(type, r, 0, p, j, along1);
    tilt_derivative(type, r, 1, p, j, along2);
    const double e11 = h * vector_dot(g1, along1), e22 = h * vector_dot(g2, along2);
    const double e13 = r == p ? g1[j] : 0;
    const double e23 = r == p ? g2[j] : 0;
    const double strain[ROWS] = {xi2[r] * e13, xi1[r] * e23, e13, e23,
                                 e11,          xi2[r] * e11, e22, xi1[r] * e22};
    for (int k = 0; k < ROWS; k++)
        row[k] += strain[k] / 4;
    *y += h * (vector_dot(g1, along2) + vector_dot(g2, along1)) / 4;
}

static void fill_system(const pzs_element_type *type, tilt_system *s)
{
    memset(s, 0, sizeof *s);
    for (int p = 0; p < 4; p++)
        for (int j = 0; j < 2; j++)
            for (int r = 0; r < 4; r++)
                add_corner(type, r, p, j, s->a[2 * p + j], &s->y[2 * p + j]);
}

/*
 * Divide every column by its largest entry, which is returned in `scale`: bending strains contain
 * the thickness, shears do not.
 */
static void scale_columns(tilt_system *s, double scale[ROWS])
{
    for (int k = 0; k < ROWS; k++) {
        scale[k] = 0;
        for (int i = 0; i < TILTS; i++)
            scale[k] = fmax(scale[k], fabs(s->a[i][k]));
        for (int i = 0; i < TILTS && scale[k] > 0; i++)
            s->a[i][k] /= scale[k];
    }
}

static void swap(double *x, double *y)
{
    const double kept = *x;
    *x = *y;
    *y = kept;
}

/* Largest entry of the matrix from row and column `from` on. */
static double find_pivot(const tilt_system *s, int from, int *row, int *column)
{
    double largest = -1;
    for (int i = from; i < TILTS; i++)
        for (int k = from; k < ROWS; k++)
            if (fabs(s->a[i][k]) > largest) {
                largest = fabs(s->a[i][k]);
                *row = i;
                *column = k;
            }
    return largest;
}

/* Eliminate column `step` from all equations but its own. */
static void eliminate(tilt_system *s, int step)
{
    for (int i = 0; i < TILTS; i++) {
        const double factor = s->a[i][step] / s->a[step][step];
        if (i == step)
            continue;
        for (int k = step; k < ROWS; k++)
            s->a[i][k] -= factor * s->a[step][k];
        s->y[i] -= factor * s->y[step];
    }
}

/*
 * Gauss-Jordan elimination with complete pivoting. order [ROWS] out: the variable of each column.
 * Returns the rank.
 */
static int reduce(tilt_system *s, int order[ROWS])
{
    for (int k = 0; k < ROWS; k++)
        order[k] = k;
    for (int step = 0; step < ROWS; step++) {
        int row = step, column = step;
        if (!(find_pivot(s, step, &row, &column) > 1e-10))
            return step;
        for (int k = 0; k < ROWS; k++)
            swap(&s->a[step][k], &s->a[row][k]);
        swap(&s->y[step], &s->y[row]);
        for (int i = 0; i < TILTS; i++)
            swap(&s->a[i][step], &s->a[i][column]);
        const int kept = order[step];
        order[step] = order[column];
        order[column] = kept;
        eliminate(s, step);
    }
    return ROWS;
}

/*
 * Solve for c [ROWS], with 0 for the variables beyond the rank. Entries that are rounding error,
 * relative to the scales of the columns, are set to 0. Returns -1 where an equation beyond the rank
 * is not satisfied or a number is not finite.
 */
static int solve(tilt_system *s, double c[ROWS])
{
    double scale[ROWS], size = 0, value[ROWS] = {0};
    int order[ROWS];
    scale_columns(s, scale);
    for (int i = 0; i < TILTS; i++)
        size = fmax(size, fabs(s->y[i]));
    const int rank = reduce(s, order);
    for (int i = rank; i < TILTS; i++)
        if (!(fabs(s->y[i]) <= 1e-8 * size))
            return -1;
    for (int k = 0; k < rank; k++)
        value[order[k]] = s->y[k] / s->a[k][k];
    for (int k = 0; k < ROWS; k++) {
        c[k] = fabs(value[k]) <= 1e-13 * size ? 0 : value[k] / scale[k];
        if (!isfinite(c[k]) || !isfinite(size))
            return -1;
    }
    return 0;
}

int warp_fill(pzs_element_type *type, double share)
{
    tilt_system equations;
    double c[ROWS];
    memset(type->warp, 0, sizeof type->warp);
    if (!(fabs(share) > 0))
        return 0;
    fill_system(type, &equations);
    if (solve(&equations, c) < 0)
        return -1;
    type->warp[0] = share;
    for (int k = 0; k < ROWS; k++)
        type->warp[1 + k] = 0 - share * c[k]; /* avoids -0 */
    return 0;
}
