/* SPDX-License-Identifier: BSD-2-Clause */
/* Sides of the elements of a mesh of quadrilaterals in any arrangement (quad_side.h). */
#include "quad_side.h"
#include <stdlib.h>

quad_side quad_side_between(uint32_t from, uint32_t to, uint32_t edge)
{
    if (from < to)
        return (quad_side){from, to, edge};
    return (quad_side){to, from, edge};
}

int quad_side_compare(const void *left, const void *right)
{
    const quad_side *first = left, *second = right;
    if (first->low != second->low)
        return first->low > second->low ? 1 : -1;
    if (first->high != second->high)
        return first->high > second->high ? 1 : -1;
    return (first->edge > second->edge) - (first->edge < second->edge);
}

bool quad_side_is_same(const quad_side *first, const quad_side *second)
{
    return first->low == second->low && first->high == second->high;
}

void quad_sides(const quad_mesh *mesh, quad_side *list)
{
    const size_t count = 4 * mesh->elements;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *node = mesh->element[i / 4];
        list[i] = quad_side_between(node[i % 4], node[(i + 1) % 4], (uint32_t)i);
    }
    qsort(list, count, sizeof *list, quad_side_compare);
}
