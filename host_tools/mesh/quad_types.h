/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Element types of a mesh of quadrilaterals of any shape in any arrangement. An element type holds
 * the matrices for the strains from the displacements of the corners, the stiffness, the warping
 * correction of warp.h, and the skew. Also the checks that such a mesh must pass.
 */
#ifndef QUAD_TYPES_H
#define QUAD_TYPES_H

#include "../quads/quad_mesh.h"
#include "../scene/surface.h"
#include "element_types.h"

/*
 * Warnings about elements of a mesh of quadrilaterals in any arrangement: how many have too stiff a
 * bending or a distorted shape, and the worst values among them.
 */
typedef struct quad_report {
    int locking; /* number of elements whose factor quad_rule.lock is above QUAD_LOCK: they are too
                    thin for the irregular mesh around them, so that their bending is far too stiff
                  */
    int coarse;  /* number of elements, not counted in `locking`, whose bending is too stiff: they
                    are thin, irregular, and too long for their curvature */
    int strips; /* number of thin, irregular elements whose sides follow the asymptotic lines of the
                   surface (lines with the normal curvature 0), as on a twisted strip: their
                   displacements are too small */
    int narrow; /* number of elements that are nearly triangles: at one corner the Jacobian
                   determinant (area per unit of the natural coordinates) is below 0.3 of that at
                   the centre of the element */
    double thinness;     /* largest thinness (curvature times squared length over thickness) of the
                            elements whose bending is or may be too stiff */
    double irregularity; /* largest irregularity (skew of the element, or distance of a node from
                            the mean of its neighbours relative to their distances) of the elements
                            whose bending is or may be too stiff */
    double jacobian; /* the Jacobian determinant is the area per unit of the natural coordinates:
                        smallest ratio of its value at a corner of an element to that at the centre,
                        over all elements; at most 1 */
} quad_report;

/*
 * Check that every edge of a mesh belongs to at most two elements, which run along it in opposite
 * directions. Returns 0, or -1 with error filled.
 */
int quad_check_edges(const scene *scene, const quad_mesh *quads, char *error);

/*
 * Build the element types of a mesh of quadrilaterals in any arrangement.
 *   list             in/out  receives the element types; its laminate must be filled
 *   point   [nodes]  in      positions and triads (local axes) of the nodes
 *   accept_irregular in      true: elements whose bending is too stiff (quad_rule.lock above
 *       QUAD_LOCK) are counted in `report`; false: they are an error
 *   element_type [elements] out  number of the type of each element
 *   report           out     elements whose bending may be too stiff or whose shape is distorted
 * Returns 0, or -1 with error filled: an element is degenerate, nearly a triangle, too stiff or
 * inclined too far to the directors (unit normals) of its nodes.
 */
int quad_types_build(type_list *list, const quad_mesh *quads, const surface_point *point,
                     bool accept_irregular, uint16_t *element_type, quad_report *report,
                     char *error);

#endif
