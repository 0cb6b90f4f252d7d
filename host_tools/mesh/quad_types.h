/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Element types of a general mesh: corner tables, stiffness, warp and skew of quadrilaterals in any
 * arrangement, and the checks that such a mesh must pass.
 */
#ifndef QUAD_TYPES_H
#define QUAD_TYPES_H

#include "../quads/quad_mesh.h"
#include "../scene/surface.h"
#include "element_types.h"

/* What is to be reported about a general mesh: numbers of elements, and the worst of them. */
typedef struct quad_report {
    int locking; /* too thin for the irregular mesh around them, and accepted: bending is far too
                    stiff, free edges and inextensional motions most of all */
    int coarse;  /* thin, irregular and curved over their length: bending is too stiff, as without
                    the shear flexibility of coarse meshes */
    int strips;  /* distorted elements along the straight lines of a thin twisted strip */
    int narrow;  /* one corner is wide: the area at the corner is below 0.3 of that at the centre */
    double thinness; /* largest curvature times length^2/thickness of the locking or coarse ones */
    double irregularity; /* largest irregularity of these (quad_regularity.h) */
    double jacobian;     /* smallest area at a corner over that at the centre, all elements */
} quad_report;

/*
 * Check that every edge belongs to at most two elements, which pass it in opposite directions.
 * Returns 0, or -1 with error filled.
 */
int quad_check_edges(const scene *scene, const quad_mesh *quads, char *error);

/*
 * Build the element types of a general mesh.
 *   list         in/out   types are added; its laminate must be filled
 *   point        [nodes]    in  positions and triads
 *   accept_irregular        in  elements that are too thin for an irregular mesh are reported, not
 *                               refused
 *   element_type [elements] out number of the type of each element
 *   report                  out
 * Returns 0, or -1 with error filled: an element is degenerate, nearly a triangle or stands against
 * its directors, or elements are too thin for the irregular mesh around them.
 */
int quad_types_build(type_list *list, const quad_mesh *quads, const surface_point *point,
                     bool accept_irregular, uint16_t *element_type, quad_report *report,
                     char *error);

#endif
