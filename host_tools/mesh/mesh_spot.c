/* SPDX-License-Identifier: BSD-2-Clause */
/* Points of a mesh that need not be nodes (mesh_spot.h). */
#include "mesh_spot.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/vector.h"

/* Natural coordinates xi1 and xi2 of the four corners of an element. */
static const int corner_xi[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

/*
 * Largest distance outside an element, in natural coordinates, at which a point still counts as
 * inside.
 */
static const double slack = 1e-6;

/*
 * Largest distance outside an element of a general mesh, in natural coordinates, at which a point
 * is still accepted and moved to the element's side; the sides of elements are straight where the
 * rim of a structure is curved.
 */
static const double rim_slack = 0.25;

mesh_spot mesh_spot_of_node(int node)
{
    const mesh_spot spot = {1, {node, 0, 0, 0}, {1, 0, 0, 0}};
    return spot;
}

/* Return the mesh point at natural coordinates xi [2] of an element. */
static mesh_spot spot_in(const mesh *mesh, int element, const double xi[2])
{
    mesh_spot spot = {.count = 4};
    for (int corner = 0; corner < 4; corner++) {
        spot.node[corner] = mesh->element[element][corner];
        spot.weight[corner] =
            (1 + corner_xi[corner][0] * xi[0]) * (1 + corner_xi[corner][1] * xi[1]) / 4;
    }
    return spot;
}

void mesh_spot_place(const mesh *mesh, const mesh_spot *spot, double place[3])
{
    for (int i = 0; i < 3; i++) {
        place[i] = 0;
        for (int corner = 0; corner < spot->count; corner++)
            place[i] += spot->weight[corner] * mesh->point[spot->node[corner]].position[i];
    }
}

/* ---- mesh lines --------------------------------------------------------- */

/*
 * Return the number of the interval between mesh lines that contains a coordinate, or -1 if it lies
 * outside all intervals; *xi becomes the natural coordinate (-1 to 1) within the interval.
 */
static int interval(const scene_line *line, double theta, double *xi)
{
    int i = 0;
    while (i < line->elements - 1 && theta > line->point[i + 1])
        i++;
    *xi = 2 * (theta - line->point[i]) / (line->point[i + 1] - line->point[i]) - 1;
    return fabs(*xi) <= 1 + slack ? i : -1;
}

static int find_on_lines(const mesh *mesh, const double point[3], mesh_spot *spot)
{
    double xi[2];
    const int i = interval(&mesh->scene->line[0], point[0], &xi[0]);
    const int j = interval(&mesh->scene->line[1], point[1], &xi[1]);
    if (i < 0 || j < 0)
        return -1;
    *spot = spot_in(mesh, i * mesh->scene->line[1].elements + j, xi);
    return 0;
}

/* ---- general meshes ------------------------------------------------------ */

/*
 * Compute the position at natural coordinates xi [2] of an element, and its derivatives with
 * respect to them.
 */
static void position(const mesh *mesh, int element, const double xi[2], double place[3],
                     double base[2][3])
{
    for (int i = 0; i < 3; i++) {
        place[i] = base[0][i] = base[1][i] = 0;
        for (int corner = 0; corner < 4; corner++) {
            const double at = mesh->point[mesh->element[element][corner]].position[i] / 4;
            const double along = 1 + corner_xi[corner][0] * xi[0],
                         across = 1 + corner_xi[corner][1] * xi[1];
            place[i] += along * across * at;
            base[0][i] += corner_xi[corner][0] * across * at;
            base[1][i] += corner_xi[corner][1] * along * at;
        }
    }
}

/*
 * Find the natural coordinates of the point of an element's surface that is nearest to a given
 * point, by the Gauss-Newton method from the start values given in `xi`. Returns the distance
 * between both points (m).
 */
static double find_foot(const mesh *mesh, int element, const double point[3], double xi[2])
{
    enum { ITERATIONS = 20 };
    const int axes = isnan(point[2]) ? 2 : 3;
    double x[3], base[2][3], away[3] = {0, 0, 0};
    xi[0] = xi[1] = 0;
    for (int k = 0; k < ITERATIONS; k++) {
        position(mesh, element, xi, x, base);
        for (int i = 0; i < 3; i++) {
            away[i] = i < axes ? point[i] - x[i] : 0;
            base[0][i] = i < axes ? base[0][i] : 0;
            base[1][i] = i < axes ? base[1][i] : 0;
        }
        const double a = vector_dot(base[0], base[0]), b = vector_dot(base[0], base[1]),
                     c = vector_dot(base[1], base[1]), p = vector_dot(base[0], away),
                     q = vector_dot(base[1], away), det = a * c - b * b;
        if (!(det > 0))
            return HUGE_VAL;
        xi[0] += (c * p - b * q) / det;
        xi[1] += (a * q - b * p) / det;
    }
    return vector_length(away);
}

/*
 * Return whether a point is so near to an element that its nearest point on the mesh may lie in
 * this element.
 */
static bool is_near(const mesh *mesh, int element, const double point[3])
{
    const double middle[2] = {0, 0};
    double x[3], base[2][3], size = 0;
    position(mesh, element, middle, x, base);
    for (int corner = 0; corner < 4; corner++)
        size = fmax(size, vector_distance(x, mesh->point[mesh->element[element][corner]].position));
    const double height = isnan(point[2]) ? x[2] : point[2];
    const double at[3] = {point[0], point[1], height};
    return vector_distance(at, x) <= 1.5 * size;
}

/*
 * Move natural coordinates that lie outside an element to its nearest side. Returns the largest
 * change of a coordinate.
 */
static double clamp_to_element(double xi[2])
{
    double moved = 0;
    for (int i = 0; i < 2; i++) {
        const double inside = fmax(-1, fmin(1, xi[i]));
        moved = fmax(moved, fabs(xi[i] - inside));
        xi[i] = inside;
    }
    return moved;
}

/*
 * Return the distance between a given point and a mesh point (m); the coordinate z is not compared
 * if the given point has no z.
 */
static double distance_from(const mesh *mesh, const mesh_spot *spot, const double point[3])
{
    double at[3];
    mesh_spot_place(mesh, spot, at);
    const double to[3] = {point[0], point[1], isnan(point[2]) ? at[2] : point[2]};
    return vector_distance(at, to);
}

static int find_in_quads(const mesh *mesh, const double point[3], mesh_spot *spot)
{
    double least = HUGE_VAL;
    for (int element = 0; element < mesh->elements; element++) {
        double xi[2];
        if (!is_near(mesh, element, point) || !isfinite(find_foot(mesh, element, point, xi)))
            continue;
        if (!(clamp_to_element(xi) <= rim_slack))
            continue;
        const mesh_spot found = spot_in(mesh, element, xi);
        const double away = distance_from(mesh, &found, point);
        if (!(away < least))
            continue;
        least = away;
        *spot = found;
    }
    return least < HUGE_VAL ? 0 : -1;
}

int mesh_spot_find(const mesh *mesh, const double point[3], mesh_spot *spot)
{
    return (mesh->quads ? find_in_quads : find_on_lines)(mesh, point, spot);
}

int mesh_spot_refuse(scene_at at, int k, const double point[3], char *error)
{
    char height[32] = "";
    if (isfinite(point[2]))
        snprintf(height, sizeof height, ", %g", point[2]);
    return scene_fault(at, error, "point %d, [%g, %g%s], is not on the mesh; move it", k + 1,
                       point[0], point[1], height);
}

int mesh_spot_of_spring(const mesh *mesh, const scene_spring *spring, int k, mesh_spot *spot,
                        double place[2])
{
    if (spring->points > 0) {
        memcpy(place, spring->point[k], 2 * sizeof *place);
        return mesh_spot_find(mesh, spring->point[k], spot);
    }
    int *node = calloc((size_t)mesh->nodes, sizeof *node);
    const int count = node ? mesh_select(mesh, &spring->where, node) : 0;
    if (k < count) {
        *spot = mesh_spot_of_node(node[k]);
        memcpy(place, mesh->theta[node[k]], 2 * sizeof *place);
    }
    free(node);
    return k < count ? 0 : -1;
}
