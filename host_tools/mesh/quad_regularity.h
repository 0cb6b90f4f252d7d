/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Irregularity of a mesh of quadrilaterals: how far the elements at a node deviate from equal
 * parallelograms. On an irregular mesh a thin shell is far too stiff in bending, like a polyhedron.
 * The functions find such elements, and compute factors that keep their membrane strains correct.
 */
#ifndef QUAD_REGULARITY_H
#define QUAD_REGULARITY_H

#include "../quads/quad_side.h"
#include "quad_geometry.h"

/*
 * Compute the irregularity of each node, |sum of edge vectors|/(sum of edge lengths). It is 0 on
 * parallelograms and at the border, of order 1/n on smooth meshes of n x n elements, and about 0.3
 * after random shifts of the nodes by 0.3 of a side.
 *   side          [4 elements] in   sides of all elements, as listed by quad_sides
 *   irregularity  [nodes]      out  irregularity of each node (dimensionless)
 * Returns 0, or -1 when memory runs out.
 */
int quad_irregularity(const quad_mesh *mesh, const quad_side *side, double *irregularity);

/*
 * Thinness and irregularity of an element in a mesh of quadrilaterals, and three numbers that
 * follow from both: two of them change the stiffness of the element, and one estimates how much too
 * stiff it is.
 */
typedef struct quad_rule {
    double thinness;     /* thinness of the element (dimensionless): largest of its curvatures times
                            squared lengths, over the thickness of the laminate */
    double irregularity; /* irregularity (dimensionless) of the element, the larger one of two
                            numbers: the sum of the absolute values of quad_geometry.skew (0 on a
                            parallelogram), and the largest irregularity of its four nodes
                            (quad_irregularity) */
    double bubble_share; /* factor, 0 to 1, of a flexibility that the element option `rho` adds to
                            the transverse shears, so that coarse meshes bend easily enough: 1 on
                            regular meshes, smaller on thin elements of an irregular mesh */
    double lock; /* estimate of how much too stiff the element is in bending, relative to the exact
                    stiffness: (c thinness/70)^2, with the member `thinness`. c rises linearly from
                    0 to 1 where the member `irregularity` rises from 0.2 to 0.3. Above QUAD_LOCK
                    the mesh is refused unless the scene accepts irregular meshes */
    double asymptotic; /* weight, 0 to 1, of a correction of the mean shear strain 12 of an element
                          by multiples of its bending strains (quad_types.c). It is 0 unless the
                          directions of the element are asymptotic lines of the surface (lines with
                          the normal curvature 0), as on twisted strips */
} quad_rule;

#define QUAD_LOCK 1.5

/*
 * Return the thinness and irregularity of an element, and the three numbers of quad_rule that
 * follow.
 *   thickness    in  thickness of the laminate (m)
 *   irregularity in  largest irregularity of the four nodes (quad_irregularity)
 */
quad_rule quad_rule_of(const quad_geometry *geometry, double thickness, double irregularity);

#endif
