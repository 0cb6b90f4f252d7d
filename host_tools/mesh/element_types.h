/* SPDX-License-Identifier: BSD-2-Clause */
/* List of the element types of a mesh: equal elements share one type. */
#ifndef ELEMENT_TYPES_H
#define ELEMENT_TYPES_H

#include "laminate.h"
#include "pzs.h"

typedef struct type_list {
    const scene *scene;
    const laminate *laminate;
    pzs_element_type *type; /* [room for every element] */
    laminate_place *place;  /* [room for every element] plies and geometry of each type */
    int count;              /* types in the list */
} type_list;

/*
 * Number of the element type with these tables and this place, added if it is new; or -1 with error
 * filled. The corner tables, thickness and skew of the type must be filled; d and warp are filled
 * here.
 *   warp_share in  share of the warp in the membrane shear (warp.h)
 */
int type_list_add(type_list *list, pzs_element_type *type, const laminate_place *place,
                  double warp_share, char *error);

#endif
