/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Averages of element values at nodes, formed separately on each side of a patch border or of a
 * fold (stress_points.h).
 */
#include "stress_points.h"
#include <stdlib.h>
#include <string.h>

static double area_of(const stress_field *field, int element)
{
    const mesh *mesh = &field->state.design->mesh;
    return mesh->place[mesh->element_type[element]].area;
}

/*
 * Store the number of the averaging point (group of elements at a node whose values are averaged)
 * to which an element belongs at one of its nodes.
 */
static void set_point(stress_points *points, const stress_field *field, int element, int node,
                      int point)
{
    const uint16_t *corner = field->state.design->mesh.element[element];
    for (int k = 0; k < 4; k++)
        if (corner[k] == node)
            points->corner[element][k] = point;
}

/*
 * Return the number of the averaging point to which an element belongs at one of its nodes; -1 if
 * none has been assigned yet. An averaging point is a group of elements at a node whose values are
 * averaged.
 */
static int point_of(const stress_points *points, const stress_field *field, int element, int node)
{
    const uint16_t *corner = field->state.design->mesh.element[element];
    for (int k = 0; k < 4; k++)
        if (corner[k] == node)
            return points->corner[element][k];
    return -1;
}

/*
 * Assign the elements at a node to averaging points: one point for each group of elements that are
 * connected as neighbours (equal plies, equal voltages, no fold).
 */
static void split_node(stress_points *points, const stress_field *field, int node)
{
    const int *list = field->node_element + field->node_start[node];
    const int count = field->node_start[node + 1] - field->node_start[node];
    for (int first = 0; first < count; first++) {
        if (point_of(points, field, list[first], node) >= 0)
            continue;
        const int point = points->count++;
        points->node[point] = node;
        set_point(points, field, list[first], node, point);
        for (int grown = 1; grown > 0;) {
            grown = 0;
            for (int k = 0; k < count * count; k++) {
                const int in = list[k / count], other = list[k % count];
                if (point_of(points, field, in, node) != point ||
                    point_of(points, field, other, node) >= 0 ||
                    !stress_are_neighbours(field, in, other))
                    continue;
                set_point(points, field, other, node, point);
                grown++;
            }
        }
    }
}

int stress_points_make(stress_points *points, const stress_field *field)
{
    const size_t elements = (size_t)field->elements;
    memset(points, 0, sizeof *points);
    points->node = calloc(4 * elements, sizeof *points->node);
    points->corner = calloc(elements, sizeof *points->corner);
    points->area = calloc(4 * elements, sizeof *points->area);
    if (!points->node || !points->corner || !points->area)
        return -1;
    for (int k = 0; k < 4 * field->elements; k++)
        points->corner[k / 4][k % 4] = -1;
    for (int node = 0; node < field->state.design->mesh.nodes; node++)
        split_node(points, field, node);
    for (int k = 0; k < 4 * field->elements; k++)
        points->area[points->corner[k / 4][k % 4]] += area_of(field, k / 4);
    return 0;
}

void stress_points_free(stress_points *points)
{
    free(points->node);
    free(points->corner);
    free(points->area);
    memset(points, 0, sizeof *points);
}

void stress_points_average(const stress_points *points, const stress_field *field,
                           const double *of_element, int components, double *of_point)
{
    memset(of_point, 0, (size_t)points->count * (size_t)components * sizeof *of_point);
    for (int k = 0; k < 4 * field->elements; k++) {
        const int point = points->corner[k / 4][k % 4];
        const double share = area_of(field, k / 4) / points->area[point];
        for (int i = 0; i < components; i++)
            of_point[point * components + i] += share * of_element[k / 4 * components + i];
    }
}
