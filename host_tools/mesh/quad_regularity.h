/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Irregularity of a mesh of quadrilaterals in any arrangement, and its consequences for thin
 * shells. The irregularity of a node or an element tells how far the elements there deviate from
 * equal parallelograms.
 *
 * A thin shell bends nearly without membrane strains. Each element has three of them, and a mesh
 * has about as many elements as nodes, with three displacements each. Without regularity, hardly
 * any bending satisfies all these conditions: the mesh behaves like a polyhedron, whose bending is
 * far too stiff. The functions of this file find such elements, and compute factors by which the
 * formulation of the element keeps its membrane strains correct.
 */
#ifndef QUAD_REGULARITY_H
#define QUAD_REGULARITY_H

#include "../quads/quad_side.h"
#include "quad_geometry.h"

/*
 * Compute the irregularity of each node: the distance of an inner node from the mean of its
 * neighbours along the surface, |sum of edge vectors|/sum of edge lengths. It is 0 on tilings of
 * parallelograms, of order 1/n on smooth meshes of n x n elements, and about 0.3 if nodes are moved
 * at random by 0.3 of a side. Nodes on the border of the mesh have the irregularity 0.
 *   side          [4 elements] in  sides of all elements, as listed by quad_sides
 *   irregularity  [nodes] out  irregularity of each node
 * Returns 0, or -1 when memory runs out.
 */
int quad_irregularity(const quad_mesh *mesh, const quad_side *side, double *irregularity);

/*
 * Thinness and irregularity of an element in a mesh of quadrilaterals, and three numbers that
 * follow from both. bubble_share reduces the shear flexibility of the element, and asymptotic
 * corrects its shear strain 12. A mesh with an element whose lock is too large is refused.
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
    double lock; /* estimate of how much too stiff the bending of the element is (dimensionless): (c
                    thinness/70)^2, with the member `thinness`. The factor c rises linearly from 0
                    where the member `irregularity` is 0.2 to 1 where it is 0.3 or more. A mesh with
                    an element above QUAD_LOCK is refused unless the scene accepts irregular meshes
                  */
    double asymptotic; /* weight, 0 to 1, of a correction of the mean shear strain 12 of an element
                          by multiples of its bending strains (quad_types.c). It is 0 unless the
                          directions of the element are asymptotic lines of the surface (lines with
                          the normal curvature 0), as on twisted strips */
} quad_rule;

#define QUAD_LOCK 1.5

/*
 * Return the thinness and irregularity of an element, and three numbers that follow from them: a
 * factor of its shear flexibility (bubble_share), an estimate of its excess bending stiffness
 * (lock), and the weight of a correction of its shear strain (asymptotic).
 *   thickness    in  thickness of the laminate (m)
 *   irregularity in  largest irregularity of the four nodes (quad_irregularity)
 */
quad_rule quad_rule_of(const quad_geometry *geometry, double thickness, double irregularity);

#endif
