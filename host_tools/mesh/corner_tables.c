/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Corner tables of an element type, which map the displacements of the corners to strains
 * (corner_tables.h).
 */
#include "corner_tables.h"
#include <math.h>
#include <string.h>
#include "../../lib/model/compact.h"
#include "../quads/vector.h"

/*
 * One corner of an element with its neighbour along one coordinate: their surface points, the
 * number of the coordinate (0: surface coordinate theta1, 1: theta2), and the sign of the step to
 * the neighbour along that coordinate.
 */
typedef struct corner_pair {
    const surface_point *own, *other;
    int a;
    double sign, range, length, middle;
} corner_pair;

/*
 * Compute the tables for one corner of an element and its neighbour along one coordinate, without
 * the element option `cartesian`. Displacements have components in local axes (triads) that turn
 * with the surface, so that their derivatives contain curvature and geodesic curvature.
 *   own, other [3][3] out  derivative of the displacement along the coordinate = own times the
 *                          displacement of the corner + other times the displacement of the
 *                          neighbour (1/m)
 *   g_mean     [3]    out  base vector along the coordinate at the middle of all plies
 *   g_diff     [3] out change of this base vector with the height (1/m)
 */
static void local_tables(const corner_pair *pair, double own[3][3], double other[3][3],
                         double g_mean[3], double g_diff[3])
{
    const double slope = pair->sign / (pair->own->lame[pair->a] * pair->range),
                 k = pair->own->curvature[pair->a];
    const double turn = pair->a == 0 ? pair->own->geodesic[1] : pair->own->geodesic[0];
    const int along = pair->a, across = 1 - along;
    for (int i = 0; i < 3; i++) {
        other[i][i] = slope;
        own[i][i] = -slope;
    }
    own[along][across] += turn;
    own[across][along] -= turn;
    own[along][2] += k;
    own[2][along] -= k;
    g_mean[along] = 1 + k * pair->middle;
    g_diff[along] = k;
}

/*
 * Return a node of the library (pzs_node) with the position and the triad (local axes) of a surface
 * point.
 */
static pzs_node node_of(const surface_point *point)
{
    pzs_node node;
    memcpy(node.position, point->position, sizeof node.position);
    memcpy(node.triad, point->triad, sizeof node.triad);
    return node;
}

/*
 * Compute the corner tables with the element option `cartesian`: a derivative is the difference of
 * the displacement vectors of two corners over the length of their side, in the triad (local axes)
 * of the corner. Firmware calls the same library function and gets equal numbers.
 */
static void cartesian_tables(const corner_pair *pair, double own[3][3], double other[3][3],
                             double g_mean[3], double g_diff[3])
{
    /*
     * length between both corners along the coordinate: the given length of the element if there is
     * one, otherwise the straight distance of the corners
     */
    const double length = pair->length > 0
                              ? pair->length
                              : vector_distance(pair->own->position, pair->other->position);
    const pzs_node corner = node_of(pair->own), neighbour = node_of(pair->other);
    pzs_corner_tables(&corner, &neighbour, pair->sign / length, pair->middle, own, other, g_mean,
                      g_diff);
}

void corner_tables_fill(const corner_data *data, pzs_element_type *type)
{
    static const int neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};
    static const double sign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    memset(type->s, 0, sizeof type->s);
    memset(type->t, 0, sizeof type->t);
    memset(type->g_mean, 0, sizeof type->g_mean);
    memset(type->g_diff, 0, sizeof type->g_diff);
    for (int corner = 0; corner < 4; corner++)
        for (int direction = 0; direction < 2; direction++) {
            const corner_pair pair = {data->point[corner],
                                      data->point[neighbour[corner][direction]],
                                      direction,
                                      sign[corner][direction],
                                      data->range[direction],
                                      data->length[direction],
                                      data->middle};
            (data->is_cartesian ? cartesian_tables : local_tables)(
                &pair, type->s[corner][direction], type->t[corner][direction],
                type->g_mean[corner][direction], type->g_diff[corner][direction]);
        }
}
