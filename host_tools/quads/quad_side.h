/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sides of the elements of a mesh of quadrilaterals in any arrangement, sorted so that sides with
 * the same nodes are adjacent in the list.
 */
#ifndef QUAD_SIDE_H
#define QUAD_SIDE_H

#include <stdbool.h>
#include "quad_mesh.h"

/* Side of an element: its two nodes in ascending order, and the edge number 4 element + side. */
typedef struct quad_side {
    uint32_t low, high, edge;
} quad_side;

quad_side quad_side_between(uint32_t from, uint32_t to, uint32_t edge);

/* Compare two quad_side for qsort: by their nodes, then by their edge numbers. */
int quad_side_compare(const void *left, const void *right);

/* Return whether two sides of elements have the same nodes. */
bool quad_side_is_same(const quad_side *first, const quad_side *second);

/* List the sides of all elements, sorted by quad_side_compare (list [4 elements] out). */
void quad_sides(const quad_mesh *mesh, quad_side *list);

#endif
