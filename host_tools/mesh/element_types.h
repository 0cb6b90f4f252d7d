/* SPDX-License-Identifier: BSD-2-Clause */
/* List of the element types of a mesh: elements that are equal up to rounding share one type. */
#ifndef ELEMENT_TYPES_H
#define ELEMENT_TYPES_H

#include "laminate.h"
#include "pzs.h"

typedef struct type_list {
    const scene *scene;
    const laminate *laminate;
    pzs_element_type *type; /* [elements of the mesh] element types; the first `count` entries are
                               used */
    laminate_place *place;  /* [elements of the mesh] plies and geometry of each element type; the
                               first `count` entries are used */
    int count;              /* number of element types in `type` and `place` */
} type_list;

/*
 * Add an element type to the list unless an equal one is there. Returns its number, or -1 with
 * error filled.
 *   type in/out    in: corner tables, thickness and skew; out: also stiffness and warping
 *       correction if the type is new
 *   place in       plies and geometry of the element
 *   warp_share in  factor of the warping correction (warp_fill); 0: no correction
 */
int type_list_add(type_list *list, pzs_element_type *type, const laminate_place *place,
                  double warp_share, char *error);

#endif
