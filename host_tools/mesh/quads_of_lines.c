/* SPDX-License-Identifier: BSD-2-Clause */
/* General mesh of coordinate lines (quads_of_lines.h). */
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

/* Number of the region with these plies, added if it is new. */
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
    for (size_t n = 0; n < lines->nodes; n++) {
        memcpy(quads->position[n], lines->point[n].x, sizeof *quads->position);
        memcpy(quads->axis[n], lines->point[n].e[0], sizeof *quads->axis);
        memcpy(quads->director[n], lines->point[n].e[2], sizeof *quads->director);
    }
    for (size_t e = 0; e < lines->elements; e++) {
        for (int r = 0; r < 4; r++)
            quads->element[e][r] = lines->element[e][r];
        quads->area[e] = lines->area[e];
        quads->element_region[e] = region_of(quads, lines->present_plies[e]);
    }
    return 0;
}
