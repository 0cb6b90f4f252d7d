/* SPDX-License-Identifier: BSD-2-Clause */
/* Nodal forces of the load types, one function for each row of the table in load_types.h. */
#ifndef LOAD_FORCES_H
#define LOAD_FORCES_H

#include "../mesh/mesh.h"

/*
 * Function that adds the nodal forces of a load of one type.
 *   value [nodes]    in      value of the load at each node, from design_load_values
 *   dense [free_dof] in/out  nodal forces on the free dof
 */
typedef void load_forces(const mesh *mesh, const scene_load *load, const double *value,
                         double *dense);

#define LOAD_FORCES(type, words, quantity, forces) load_forces forces;
LOAD_TYPES(LOAD_FORCES)
#undef LOAD_FORCES

/*
 * Add the nodal forces of a load to a vector [free_dof], by the function for the type of the load.
 */
load_forces load_forces_add;

/*
 * Temperature loads. load_temperatures returns the temperatures of both faces;
 * load_temperature_resultants computes the prescribed resultants in one element, times its area.
 *   h0  [10] out  resultants (N m) for mean and difference of both faces of the strains 11, 22, 33
 *       and 12; then the strains 13 and 23
 */
laminate_field load_temperatures(const scene_load *load);
void load_temperature_resultants(const mesh *mesh, const scene_load *load, int element,
                                 double h0[LAMINATE_STRAINS]);

/*
 * Compute two base vectors of a face at a corner of an element along the straight sides (chords)
 * that meet there, for the nodal forces of a pressure with Cartesian kinematics. A chord over an
 * arc of angle a is inclined to the tangent plane by a/2. Instead of its slope tan(a/2), the
 * smaller slope 1/(a/2) - cot(a/2) is used. The nodal forces then have the resultant and the moment
 * of the pressure on the arc.
 *   flat [2][2] out  components of the base vectors in the tangent plane
 *   lean [2]    out  component of each base vector normal to it, with this slope
 * Returns the area that the two base vectors span.
 */
double load_chords(const mesh *mesh, int element, int corner, scene_face face, double flat[2][2],
                   double lean[2]);

#endif
