/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Irregularity of a mesh of quadrilaterals in any arrangement around each element, and its
 * consequences for thin shells.
 *
 * On a thin shell, the three membrane constraints of each node leave no freedom to a mesh without
 * order: it behaves like a polyhedron, whose bending is far too stiff. The functions of this file
 * adapt the formulation of such elements so that their membrane strains stay correct, and identify
 * the elements whose bending is too stiff.
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
 * Thinness and irregularity of an element of a general mesh, and the factors by which its
 * formulation is adapted to them.
 */
typedef struct quad_rule {
    double thinness;     /* thinness of the element (1): largest of its curvatures times squared
                            lengths, over the thickness of the laminate */
    double irregularity; /* irregularity (1), the larger one of two deviations from a regular mesh:
                            sum of both absolute skew coefficients (0 on a parallelogram), and
                            largest distance of a node from the mean of its neighbours, relative to
                            their distances */
    double bubble_share; /* factor, 0 to 1, by which the element multiplies the transverse shear
                            flexibility that is added on coarse meshes: 1 on regular meshes, smaller
                            where thin elements are irregular */
    double lock; /* factor by which the bending of the element would have to be stiffened to keep
                    stresses smooth, from the members thinness and irregularity: [thinness
                    clip((irregularity - 0.2)/0.1, 0, 1)/70]^2. No bending is actually stiffened; a
                    mesh with a factor above the limit QUAD_LOCK is refused unless the scene accepts
                    irregular meshes. */
    double asymptotic; /* weight, 0 to 1, of additional terms by which bending strains enter the
                          mean shear strain 12 of an element along asymptotic lines (twisted
                          strips); 0 on elements along lines of curvature */
} quad_rule;

#define QUAD_LOCK 1.5

/*
 * Return how the formulation of an element is adapted to its thinness and irregularity.
 *   thickness    in  thickness of the laminate (m)
 *   irregularity in  largest irregularity of the four nodes: distance of a node from the mean of
 *                    its neighbours, relative to their distances
 */
quad_rule quad_rule_of(const quad_geometry *geometry, double thickness, double irregularity);

#endif
