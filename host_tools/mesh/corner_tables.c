/* SPDX-License-Identifier: BSD-2-Clause */
/* Corner tables of an element type (corner_tables.h). */
#include "corner_tables.h"
#include <math.h>
#include <string.h>
#include "../quads/vector.h"

/*
 * One corner of an element: its surface point, the neighbouring corner along theta_a, and the sign
 * of the way there towards increasing theta_a.
 */
typedef struct corner_pair {
    const surface_point *own, *other;
    int a;
    double sign, range, length, middle;
} corner_pair;

/*
 * Corner tables of local kinematics: components are interpolated in the triad that turns with the
 * surface; derivatives use A, k and B of the corner.
 */
static void local_tables(const corner_pair *c, double s[3][3], double t[3][3], double g_mean[3],
                         double g_diff[3])
{
    const double slope = c->sign / (c->own->a[c->a] * c->range), k = c->own->k[c->a];
    const double turn = c->a == 0 ? c->own->b[1] : c->own->b[0];
    const int a = c->a, b = 1 - a;
    for (int i = 0; i < 3; i++) {
        t[i][i] = slope;
        s[i][i] = -slope;
    }
    s[a][b] += turn;
    s[b][a] -= turn;
    s[a][2] += k;
    s[2][a] -= k;
    g_mean[a] = 1 + k * c->middle;
    g_diff[a] = k;
}

/*
 * Corner tables of Cartesian kinematics: differences of vectors between the corners, in the
 * corner's own triad, divided by the length of the chord or of the element.
 */
static void cartesian_tables(const corner_pair *c, double s[3][3], double t[3][3], double g_mean[3],
                             double g_diff[3])
{
    const double length = c->length > 0 ? c->length : vector_distance(c->own->x, c->other->x);
    const double slope = c->sign / length;
    double step[3], turn[3];
    for (int i = 0; i < 3; i++) {
        turn[i] = c->other->e[2][i] - c->own->e[2][i];
        step[i] = c->other->x[i] - c->own->x[i] + c->middle * turn[i];
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            t[i][j] = slope * vector_dot(c->own->e[i], c->other->e[j]);
        s[i][i] = -slope;
        g_mean[i] = slope * vector_dot(c->own->e[i], step);
        g_diff[i] = slope * vector_dot(c->own->e[i], turn);
    }
}

void corner_tables_fill(const corner_data *data, pzs_element_type *type)
{
    static const int neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};
    static const double sign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    memset(type->s, 0, sizeof type->s);
    memset(type->t, 0, sizeof type->t);
    memset(type->g_mean, 0, sizeof type->g_mean);
    memset(type->g_diff, 0, sizeof type->g_diff);
    for (int r = 0; r < 4; r++)
        for (int a = 0; a < 2; a++) {
            const corner_pair pair = {data->point[r],
                                      data->point[neighbour[r][a]],
                                      a,
                                      sign[r][a],
                                      data->range[a],
                                      data->length[a],
                                      data->middle};
            (data->is_cartesian ? cartesian_tables : local_tables)(
                &pair, type->s[r][a], type->t[r][a], type->g_mean[r][a], type->g_diff[r][a]);
        }
}
