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
 * Return the number of an element type, which is added to the list if no equal type is there, or -1
 * with error filled.
 *   type in/out    corner tables (displacements of the corners to strains), thickness and skew must
 *       be filled; a new type also gets its stiffness and its warping correction
 *   place in       plies and geometry of the element
 *   warp_share in  factor (dimensionless) of the warping correction, a term of the membrane shear
 *       strain of curved elements (warp_fill); 0: no correction
 */
int type_list_add(type_list *list, pzs_element_type *type, const laminate_place *place,
                  double warp_share, char *error);

#endif
