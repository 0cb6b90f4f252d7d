/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Element types of a mesh of quadrilaterals of any shape in any arrangement: strains from the
 * displacements of the corners, stiffness, warping correction and skew. Also the checks that such a
 * mesh must pass.
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
    int locking; /* number of elements that are too thin for the irregular mesh around them and were
                    accepted: their bending is far too stiff, most of all at free edges and in
                    inextensional motions */
    int coarse;  /* number of thin, irregular elements that are curved over their length: their
                    bending is too stiff, as if the shear flexibility of coarse meshes were missing
                  */
    int strips;  /* number of distorted elements on thin twisted strips whose sides run along the
                    straight lines of the strip (asymptotic lines of the surface) */
    int narrow;  /* number of elements with an obtuse corner: the area per unit of the natural
                    coordinates is below 0.3 of that at the centre */
    double thinness;     /* largest thinness (curvature times squared length over thickness) of the
                            elements whose bending is or may be too stiff */
    double irregularity; /* largest irregularity (skew of the element, or distance of a node from
                            the mean of its neighbours relative to their distances) of the elements
                            whose bending is or may be too stiff */
    double jacobian;     /* area of an element per unit of the natural coordinates at a corner, over
                            that at its centre: the smallest ratio in the mesh */
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
 *   accept_irregular in      true: elements that are too thin for an irregular mesh are reported;
 *       false: they are refused
 *   element_type [elements] out  number of the type of each element
 *   report           out     elements whose bending may be too stiff or whose shape is distorted
 * Returns 0, or -1 with error filled: an element is degenerate or nearly a triangle, the directors
 * (unit normals) of its nodes are inclined too far to it, or elements are too thin for the
 * irregular mesh around them.
 */
int quad_types_build(type_list *list, const quad_mesh *quads, const surface_point *point,
                     bool accept_irregular, uint16_t *element_type, quad_report *report,
                     char *error);

#endif
