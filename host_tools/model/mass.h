/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mass matrix of a mesh, for the same dof as the stiffness matrix. Displacement vectors, not
 * components, are interpolated, so that a rigid translation has exactly the mass of the structure.
 * A concentrated mass is part of one element that contains its point. At a node,
 *   u(t) = mean + t difference + h (1 - 4 t^2/h^2) q e3.
 *   t           height above the middle of a laminate of thickness h
 *   mean        mean of both faces' displacements
 *   difference  difference of both faces' displacements, divided by h
 *   q, e3       seventh dof, and thickness direction
 */
#ifndef MASS_H
#define MASS_H

#include "design.h"

/*
 * Default weight of the lumped mass matrix in the weighted mean of the lumped and the consistent
 * mass matrix. Two thirds give the smallest error of the first six natural frequencies of plates, a
 * disc, a panel and a cylinder; the weight 0 gives the consistent matrix, 1 the lumped matrix.
 */
#define MASS_LUMPED (2.0 / 3)

typedef struct mass {
    const mesh *mesh;
    double *entry; /* [elements][entries of the lower triangle of order 4 times dof_per_node] packed
                      element mass matrices */
} mass;

/*
 * Build the element mass matrices as a weighted mean of the consistent and the lumped matrix, with
 * curved plies and the scene's additional mass per area and concentrated masses.
 *   lumped in  weight of the lumped matrix, from 0 to 1
 * Returns 0, or -1 with error filled where a material has no density or memory runs out.
 */
int mass_build(mass *mass, const design *design, double lumped, char *error);
void mass_free(mass *mass);

/* Packed lower triangle of the mass matrix of one element. */
const double *mass_element(const mass *mass, int element);

/*
 * Multiply the mass matrix with `count` vectors over the free dof of a model of the same mesh;
 * entries of dof with prescribed displacements are set to 0.
 *   vector  [count][free_dof] in   vectors to be multiplied
 *   product [count][free_dof] out  products of the matrix and each vector
 */
void mass_multiply(const mass *mass, const pzs_model *model, const double *vector, size_t count,
                   double *product);

/*
 * Mass of the mesh in a rigid motion with displacement shift + spin x position, constrained nodes
 * included.
 *   shift, spin      in   translation and rotation vector
 *   force [free_dof] out  product of the mass matrix and the motion; NULL: not computed
 * Returns twice the kinetic energy at this velocity: the mass for a unit shift, the moment of
 * inertia for a unit spin.
 */
double mass_rigid(const mass *mass, const pzs_model *model, const double shift[3],
                  const double spin[3], double *force);

/*
 * List the names of the layers' materials that have no density, quoted and separated by commas.
 * Returns the number of these materials.
 */
int mass_missing(const design *design, char names[SCENE_ERROR]);

#endif
