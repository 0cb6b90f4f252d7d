/* SPDX-License-Identifier: BSD-2-Clause */
/* Geometry of one quadrilateral (quad_geometry.h). */
#include "quad_geometry.h"
#include <math.h>
#include <string.h>
#include "../quads/vector.h"

static const double xi[2][4] = {{-1, 1, 1, -1}, {-1, -1, 1, 1}};

/* Sum over the corners of xi_1^p xi_2^q times the vectors, divided by 4. */
static void corner_sum(const double (*vector)[3], const uint32_t node[4], int p, int q,
                       double sum[3])
{
    for (int i = 0; i < 3; i++) {
        sum[i] = 0;
        for (int r = 0; r < 4; r++)
            sum[i] += (p ? xi[0][r] : 1) * (q ? xi[1][r] : 1) * vector[node[r]][i] / 4;
    }
}

/* alpha from [g_a . g_b] alpha = [g_a . g_h]. Returns the determinant of [g_a . g_b]. */
static double fill_skew(const double base[2][3], const double hourglass[3], double skew[2])
{
    const double a11 = vector_dot(base[0], base[0]), a22 = vector_dot(base[1], base[1]);
    const double a12 = vector_dot(base[0], base[1]);
    const double b1 = vector_dot(base[0], hourglass), b2 = vector_dot(base[1], hourglass);
    const double size = a11 * a22 - a12 * a12;
    skew[0] = (a22 * b1 - a12 * b2) / size;
    skew[1] = (a11 * b2 - a12 * b1) / size;
    return size;
}

/* Curvatures along the element's directions, and the principal ones. size: of fill_skew */
static void fill_curvature(quad_geometry *g, double size)
{
    const double a11 = vector_dot(g->base[0], g->base[0]), a22 = vector_dot(g->base[1], g->base[1]);
    const double a12 = vector_dot(g->base[0], g->base[1]);
    const double b11 = vector_dot(g->base[0], g->turn[0]), b22 = vector_dot(g->base[1], g->turn[1]);
    const double b12 =
        (vector_dot(g->base[0], g->turn[1]) + vector_dot(g->base[1], g->turn[0])) / 2;
    const double mean = (a22 * b11 + a11 * b22 - 2 * a12 * b12) / (2 * size);
    const double gauss = (b11 * b22 - b12 * b12) / size;
    const double half_difference = sqrt(fmax(0, mean * mean - gauss));
    g->curvature[0] = 4 * b11 / (g->length[0] * g->length[0]);
    g->curvature[1] = 4 * b22 / (g->length[1] * g->length[1]);
    g->curvature[2] = 4 * b12 / (g->length[0] * g->length[1]);
    g->principal[0] = mean + half_difference;
    g->principal[1] = mean - half_difference;
}

/* ---- area -------------------------------------------------------------- */

/*
 * Middle of side s of the curved element: the chord bent so that it is tangent to the surface at
 * both ends, (X_r + X_r')/2 + (t_r - t_r')/8, with t the chord projected on the tangent planes.
 */
static void side_middle(const quad_mesh *mesh, const uint32_t node[4], int s, double middle[3])
{
    const uint32_t from = node[s], to = node[(s + 1) % 4];
    const double *x = mesh->position[from], *y = mesh->position[to];
    const double *d = mesh->director[from], *e = mesh->director[to];
    const double chord[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
    const double lean_from = vector_dot(chord, d), lean_to = vector_dot(chord, e);
    for (int i = 0; i < 3; i++)
        middle[i] = (x[i] + y[i]) / 2 + (lean_to * e[i] - lean_from * d[i]) / 8;
}

/* Derivatives along xi1 and xi2 of the eight-node shape functions: four corners, then sides 0 to 3.
 */
static void shape_slopes(double s, double t, double slope[2][8])
{
    for (int r = 0; r < 4; r++) {
        const double a = xi[0][r], b = xi[1][r];
        slope[0][r] = a * (1 + b * t) * (2 * a * s + b * t) / 4;
        slope[1][r] = b * (1 + a * s) * (a * s + 2 * b * t) / 4;
    }
    for (int side = 0; side < 4; side++) {
        const int along1 = side % 2 == 0;
        const double end = side == 1 || side == 2 ? 1 : -1;
        slope[0][4 + side] = along1 ? -s * (1 + end * t) : end * (1 - t * t) / 2;
        slope[1][4 + side] = along1 ? end * (1 - s * s) / 2 : -t * (1 + end * s);
    }
}

/* Area of the surface through the corners and the bent sides; exact where the element is flat. */
static double curved_area(const quad_mesh *mesh, const uint32_t node[4])
{
    static const double point[3] = {-0.7745966692414834, 0, 0.7745966692414834};
    static const double weight[3] = {5 / 9.0, 8 / 9.0, 5 / 9.0};
    double x[8][3], area = 0;
    for (int r = 0; r < 4; r++) {
        memcpy(x[r], mesh->position[node[r]], sizeof x[r]);
        side_middle(mesh, node, r, x[4 + r]);
    }
    for (int k = 0; k < 9; k++) {
        double slope[2][8], tangent[2][3] = {{0}}, normal[3];
        shape_slopes(point[k / 3], point[k % 3], slope);
        for (int a = 0; a < 2; a++)
            for (int r = 0; r < 8; r++)
                for (int i = 0; i < 3; i++)
                    tangent[a][i] += slope[a][r] * x[r][i];
        vector_cross(tangent[0], tangent[1], normal);
        area += weight[k / 3] * weight[k % 3] * vector_length(normal);
    }
    return area;
}

/* ---- geometry ---------------------------------------------------------- */

int quad_geometry_fill(const quad_mesh *mesh, size_t element, quad_geometry *g)
{
    const uint32_t *node = mesh->element[element];
    const double(*x)[3] = (const double(*)[3])mesh->position;
    const double(*d)[3] = (const double(*)[3])mesh->director;
    double hourglass[3];
    memset(g, 0, sizeof *g);
    for (int a = 0; a < 2; a++) {
        corner_sum(x, node, a == 0, a == 1, g->base[a]);
        corner_sum(d, node, a == 0, a == 1, g->turn[a]);
        g->length[a] = 2 * vector_length(g->base[a]);
    }
    corner_sum(x, node, 1, 1, hourglass);
    corner_sum(d, node, 0, 0, g->director);
    vector_cross(g->base[0], g->base[1], g->normal);
    const double size = fill_skew((const double(*)[3])g->base, hourglass, g->skew);
    const double product = g->length[0] * g->length[1];
    if (vector_normalise(g->director) == 0 || vector_normalise(g->normal) == 0 ||
        !(size > 1e-20 * product * product))
        return -1;
    fill_curvature(g, size);
    g->area = mesh->area ? mesh->area[element] : curved_area(mesh, node);
    g->jacobian = 1 - fabs(g->skew[0]) - fabs(g->skew[1]);
    g->upright = 1;
    for (int r = 0; r < 4; r++)
        g->upright = fmin(g->upright, vector_dot(d[node[r]], g->normal));
    return isfinite(g->area) && g->area > 0 && isfinite(g->jacobian) && isfinite(g->upright) ? 0
                                                                                             : -1;
}
