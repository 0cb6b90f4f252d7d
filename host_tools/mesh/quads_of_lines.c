/* SPDX-License-Identifier: BSD-2-Clause */
/* Mesh of quadrilaterals between the coordinate lines of a surface (quads_of_lines.h). */
#include "quads_of_lines.h"
#include <stdlib.h>
#include <string.h>

static int allocate(const line_mesh *lines, quad_mesh *quads)
{
    memset(quads, 0, sizeof *quads);
    quads->nodes = lines->nodes;
    quads->elements = lines->elements;
    quads->position = calloc(lines->nodes, sizeof *quads->position);
    quads->director = calloc(lines->nodes, sizeof *quads->director);
    quads->axis = calloc(lines->nodes, sizeof *quads->axis);
    quads->element = calloc(lines->elements, sizeof *quads->element);
    quads->area = calloc(lines->elements, sizeof *quads->area);
    quads->element_region = calloc(lines->elements, sizeof *quads->element_region);
    quads->region = calloc(lines->elements, sizeof *quads->region);
    return quads->position && quads->director && quads->axis && quads->element && quads->area &&
           quads->element_region && quads->region;
}

/*
 * Return the number of the region of a mesh whose present plies are given by the bits of
 * `present_plies`; a new region is added if there is none.
 */
static uint32_t region_of(quad_mesh *quads, uint32_t present_plies)
{
    size_t k = 0;
    while (k < quads->regions && quads->region[k].present_plies != present_plies)
        k++;
    if (k == quads->regions)
        quads->region[quads->regions++].present_plies = present_plies;
    return (uint32_t)k;
}

int quads_of_lines(const line_mesh *lines, quad_mesh *quads)
{
    if (!allocate(lines, quads)) {
        quad_mesh_free(quads);
        return -1;
    }
    for (size_t node = 0; node < lines->nodes; node++) {
        memcpy(quads->position[node], lines->point[node].position, sizeof *quads->position);
        memcpy(quads->axis[node], lines->point[node].triad[0], sizeof *quads->axis);
        memcpy(quads->director[node], lines->point[node].triad[2], sizeof *quads->director);
    }
    for (size_t element = 0; element < lines->elements; element++) {
        for (int corner = 0; corner < 4; corner++)
            quads->element[element][corner] = lines->element[element][corner];
        quads->area[element] = lines->area[element];
        quads->element_region[element] = region_of(quads, lines->present_plies[element]);
    }
    return 0;
}
