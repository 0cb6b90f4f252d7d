/* SPDX-License-Identifier: BSD-2-Clause */
/* Geometry of one quadrilateral element at its centre (quad_geometry.h). */
#include "quad_geometry.h"
#include <math.h>
#include <string.h>
#include "../quads/vector.h"

static const double xi[2][4] = {{-1, 1, 1, -1}, {-1, -1, 1, 1}};

/*
 * Compute one of the four coefficients of a vector that varies bilinearly over an element: the mean
 * of the corner vectors (has_xi1 = has_xi2 = 0), or the factor of xi1 (1, 0), of xi2 (0, 1) or of
 * xi1 xi2 (1, 1).
 */
static void corner_sum(const double (*vector)[3], const uint32_t node[4], int has_xi1, int has_xi2,
                       double sum[3])
{
    for (int i = 0; i < 3; i++) {
        sum[i] = 0;
        for (int corner = 0; corner < 4; corner++) {
            const double along = has_xi1 ? xi[0][corner] : 1;
            const double across = has_xi2 ? xi[1][corner] : 1;
            sum[i] += along * across * vector[node[corner]][i] / 4;
        }
    }
}

/*
 * Compute the skew coefficients alpha_1 and alpha_2 of an element: the hourglass vector (a quarter
 * of the sum of xi1 xi2 times the corner positions) is alpha_1 g_1 + alpha_2 g_2 plus a part normal
 * to the base vectors g_1, g_2. Returns the determinant of the matrix of products g_a . g_b.
 */
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

/*
 * Compute the curvatures of an element along its directions, and its principal curvatures (1/m);
 * `size` is the determinant of the products of the element's base vectors.
 */
static void fill_curvature(quad_geometry *geometry, double size)
{
    const double a11 = vector_dot(geometry->base[0], geometry->base[0]),
                 a22 = vector_dot(geometry->base[1], geometry->base[1]);
    const double a12 = vector_dot(geometry->base[0], geometry->base[1]);
    const double b11 = vector_dot(geometry->base[0], geometry->turn[0]),
                 b22 = vector_dot(geometry->base[1], geometry->turn[1]);
    const double b12 = (vector_dot(geometry->base[0], geometry->turn[1]) +
                        vector_dot(geometry->base[1], geometry->turn[0])) /
                       2;
    const double mean = (a22 * b11 + a11 * b22 - 2 * a12 * b12) / (2 * size);
    const double gauss = (b11 * b22 - b12 * b12) / size;
    const double half_difference = sqrt(fmax(0, mean * mean - gauss));
    geometry->curvature[0] = 4 * b11 / (geometry->length[0] * geometry->length[0]);
    geometry->curvature[1] = 4 * b22 / (geometry->length[1] * geometry->length[1]);
    geometry->curvature[2] = 4 * b12 / (geometry->length[0] * geometry->length[1]);
    geometry->principal[0] = mean + half_difference;
    geometry->principal[1] = mean - half_difference;
}

/* ---- area -------------------------------------------------------------- */

/*
 * Compute the middle of one side of the curved element. The side is bent so that it is tangent to
 * the surface at both ends: (X + X')/2 + (t - t')/8, with X, X' the positions of the ends of the
 * side and t, t' its chord projected on the tangent planes there.
 */
static void side_middle(const quad_mesh *mesh, const uint32_t node[4], int side, double middle[3])
{
    const uint32_t from = node[side], to = node[(side + 1) % 4];
    const double *position_from = mesh->position[from], *position_to = mesh->position[to];
    const double *director_from = mesh->director[from], *director_to = mesh->director[to];
    const double chord[3] = {position_to[0] - position_from[0], position_to[1] - position_from[1],
                             position_to[2] - position_from[2]};
    const double lean_from = vector_dot(chord, director_from),
                 lean_to = vector_dot(chord, director_to);
    for (int i = 0; i < 3; i++)
        middle[i] = (position_from[i] + position_to[i]) / 2 +
                    (lean_to * director_to[i] - lean_from * director_from[i]) / 8;
}

/*
 * Compute the derivatives, with respect to the natural coordinates xi1 and xi2, of the shape
 * functions at xi1 = s and xi2 = t of a quadrilateral with eight nodes: four corners, then the
 * middles of sides 0 to 3.
 */
static void shape_slopes(double s, double t, double slope[2][8])
{
    for (int corner = 0; corner < 4; corner++) {
        const double a = xi[0][corner], b = xi[1][corner];
        slope[0][corner] = a * (1 + b * t) * (2 * a * s + b * t) / 4;
        slope[1][corner] = b * (1 + a * s) * (a * s + 2 * b * t) / 4;
    }
    for (int side = 0; side < 4; side++) {
        const int along1 = side % 2 == 0;
        const double end = side == 1 || side == 2 ? 1 : -1;
        slope[0][4 + side] = along1 ? -s * (1 + end * t) : end * (1 - t * t) / 2;
        slope[1][4 + side] = along1 ? end * (1 - s * s) / 2 : -t * (1 + end * s);
    }
}

/*
 * Return the area of the surface through the corners and the bent sides of an element (m2); it is
 * exact if the element is flat.
 */
static double curved_area(const quad_mesh *mesh, const uint32_t node[4])
{
    static const double point[3] = {-0.7745966692414834, 0, 0.7745966692414834};
    static const double weight[3] = {5 / 9.0, 8 / 9.0, 5 / 9.0};
    double position[8][3], area = 0;
    for (int corner = 0; corner < 4; corner++) {
        memcpy(position[corner], mesh->position[node[corner]], sizeof position[corner]);
        side_middle(mesh, node, corner, position[4 + corner]);
    }
    for (int k = 0; k < 9; k++) {
        double slope[2][8], tangent[2][3] = {{0}}, normal[3];
        shape_slopes(point[k / 3], point[k % 3], slope);
        for (int direction = 0; direction < 2; direction++)
            for (int corner = 0; corner < 8; corner++)
                for (int i = 0; i < 3; i++)
                    tangent[direction][i] += slope[direction][corner] * position[corner][i];
        vector_cross(tangent[0], tangent[1], normal);
        area += weight[k / 3] * weight[k % 3] * vector_length(normal);
    }
    return area;
}

/* ---- geometry ---------------------------------------------------------- */

int quad_geometry_fill(const quad_mesh *mesh, size_t element, quad_geometry *geometry)
{
    const uint32_t *node = mesh->element[element];
    const double(*position)[3] = (const double(*)[3])mesh->position;
    const double(*director)[3] = (const double(*)[3])mesh->director;
    double hourglass[3];
    memset(geometry, 0, sizeof *geometry);
    for (int direction = 0; direction < 2; direction++) {
        corner_sum(position, node, direction == 0, direction == 1, geometry->base[direction]);
        corner_sum(director, node, direction == 0, direction == 1, geometry->turn[direction]);
        geometry->length[direction] = 2 * vector_length(geometry->base[direction]);
    }
    corner_sum(position, node, 1, 1, hourglass);
    corner_sum(director, node, 0, 0, geometry->director);
    vector_cross(geometry->base[0], geometry->base[1], geometry->normal);
    const double size = fill_skew((const double(*)[3])geometry->base, hourglass, geometry->skew);
    const double product = geometry->length[0] * geometry->length[1];
    if (vector_normalise(geometry->director) == 0 || vector_normalise(geometry->normal) == 0 ||
        !(size > 1e-20 * product * product))
        return -1;
    fill_curvature(geometry, size);
    geometry->area = mesh->area ? mesh->area[element] : curved_area(mesh, node);
    geometry->jacobian = 1 - fabs(geometry->skew[0]) - fabs(geometry->skew[1]);
    geometry->upright = 1;
    for (int corner = 0; corner < 4; corner++)
        geometry->upright =
            fmin(geometry->upright, vector_dot(director[node[corner]], geometry->normal));
    return isfinite(geometry->area) && geometry->area > 0 && isfinite(geometry->jacobian) &&
                   isfinite(geometry->upright)
               ? 0
               : -1;
}
