/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mass matrix of a mesh: element matrices from the densities of the plies that are present, for the
 * same dof as the stiffness.
 *
 * With t the height above the middle of the package and h its thickness, the displacement at a node
 * is u(t) = mean + t difference + h (1 - 4 t^2/h^2) q e3, where q is the seventh dof. Displacement
 * vectors, not components, are interpolated between the nodes, so that a rigid translation has
 * exactly the mass of the structure.
 */
#ifndef MASS_H
#define MASS_H

#include "../mesh/mesh.h"

/*
 * Share of the lumped matrix in the mean of the lumped and the consistent mass matrix. Two thirds
 * give the smallest error of the first six frequencies over plates, a disc, a panel and a cylinder;
 * 0 is the consistent matrix, 1 the lumped one.
 */
#define MASS_LUMPED (2.0 / 3)

typedef struct mass {
    const mesh *mesh;
    double *entry; /* [elements][packed lower triangle of 4 dof_per_node] mass and its moments */
} mass;

/*
 * Build the element matrices (1 - lumped) consistent + lumped lumped, with the metric of curved
 * plies and the scene's mass per area. Returns 0, or -1 with error filled: a material has no
 * density, or memory runs out.
 */
int mass_build(mass *mass, const mesh *mesh, double lumped, char *error);
void mass_free(mass *mass);

/* Matrix of an element, packed lower triangle. */
const double *mass_element(const mass *mass, int element);

/*
 * f = M u over the free dof of a model of the same mesh; entries of dof with prescribed
 * displacements are 0. u, f [free_dof]
 */
void mass_multiply(const mass *mass, const pzs_model *model, const double *vector, double *product);

/*
 * Rigid motion u = shift + spin x position of the whole mesh, constrained nodes included.
 *   force [free_dof] out  M u; NULL: not computed
 * Returns u . M u: the mass for a unit shift, the moment of inertia for a unit spin.
 */
double mass_rigid(const mass *mass, const pzs_model *model, const double shift[3],
                  const double spin[3], double *force);

/*
 * Names of the layers' materials that have no density, quoted and separated by commas. Returns
 * their number.
 */
int mass_missing(const scene *scene, char names[SCENE_ERROR]);

#endif
