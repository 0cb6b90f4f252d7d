/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * How irregular a general mesh is around each element, and what that means for thin shells.
 *
 * On a thin shell, three membrane constraints for each node leave no freedom to a mesh without
 * order: it behaves like a polyhedron, whose bending is far too stiff. The rules below keep the
 * membrane part of such a mesh right and name the elements whose bending is not.
 */
#ifndef QUAD_REGULARITY_H
#define QUAD_REGULARITY_H

#include "../quads/quad_side.h"
#include "quad_geometry.h"

/*
 * Irregularity of each node: distance of an inner node from the mean of its neighbours along the
 * surface, |sum of edge vectors|/sum of lengths. It is 0 on tilings of parallelograms, of order 1/n
 * on smooth meshes of n x n elements and about 0.3 where nodes are moved at random by 0.3 of a
 * side. It is 0 on the border of the mesh.
 *   side         [4 elements] in  as listed by quad_sides
 *   irregularity [nodes]      out
 * Returns 0, or -1 where memory ran out.
 */
int quad_irregularity(const quad_mesh *mesh, const quad_side *side, double *irregularity);

/* Thinness and irregularity of an element, and what follows from them. */
typedef struct quad_rule {
    double thinness;     /* s: largest of |B_ab| L_a L_b over the thickness */
    double irregularity; /* iota: |alpha_1| + |alpha_2| or the largest of the element's nodes */
    double bubble_share; /* g = 1/(1 + (iota s/3)^2): part of the element option rho that is used */
    double lock;         /* factor by which bending would have to be stiffened for stresses to stay
                            smooth: [s clip((iota - 0.2)/0.1, 0, 1)/70]^2; nothing is stiffened, but
                            above QUAD_LOCK the mesh is refused, unless irregular ones are
                            accepted */
    double asymptotic;   /* part of the bending strains that is added to the mean strain 12 of an
                            element along asymptotic lines (twisted strips); 0 on lines of curvature
                          */
} quad_rule;

#define QUAD_LOCK 1.5

/* irregularity: largest of the element's four nodes, from quad_irregularity */
quad_rule quad_rule_of(const quad_geometry *geometry, double thickness, double irregularity);

#endif
