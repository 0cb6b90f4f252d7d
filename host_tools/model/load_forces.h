/* SPDX-License-Identifier: BSD-2-Clause */
/* Nodal forces of the load types, one function for each row of the table in load_types.h. */
#ifndef LOAD_FORCES_H
#define LOAD_FORCES_H

#include "../mesh/mesh.h"

/*
 * Function that adds the nodal forces of a load of one type to a dense column.
 *   value [nodes]    in      value of the load at the nodes, from design_load_values
 *   dense [free_dof] in/out
 */
typedef void load_forces(const mesh *mesh, const scene_load *load, const double *value,
                         double *dense);

#define LOAD_FORCES(type, words, quantity, forces) load_forces forces;
LOAD_TYPES(LOAD_FORCES)
#undef LOAD_FORCES

/* Add the nodal forces of a load to a dense column by the function of its type. */
load_forces load_forces_add;

/*
 * load_temperatures returns the temperatures of the inner and outer face under a temperature
 * load; load_temperature_resultants computes the stress resultants of this load in one element,
 * times the area of the element.
 *   h0 [10] out
 */
laminate_field load_temperatures(const scene_load *load);
void load_temperature_resultants(const mesh *mesh, const scene_load *load, int element,
                                 double h0[LAMINATE_STRAINS]);

/*
 * Base vectors of a face at one corner of an element of the improved formulation.
 *
 * The base vectors are chords, inclined by a/2 to the tangent plane where the element spans the
 * angle a. The fraction (1 - (a/2) cot(a/2))/(a/2) of the inclination, about a third, is used for
 * pressures: the pressure's component along the surface then has the resultant and the moment that
 * it has on the arc, and balances the stretched chords of a ring at any angles.
 *   flat [2][2] out  components of the base vectors in the tangent plane
 *   lean [2]    out  inclination of each base vector that is used for pressures
 * Returns the area that the base vectors span.
 */
double load_chords(const mesh *mesh, int element, int corner, scene_face face, double flat[2][2],
                   double lean[2]);

#endif
