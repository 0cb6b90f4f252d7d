/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Electric potentials at the corners of one layer of an element whose faces need not be electrodes:
 * eight potentials, four on the inner and four on the outer face. The potential is bilinear over
 * the element and linear through the layer.
 */
#ifndef POTENTIAL_ELEMENT_H
#define POTENTIAL_ELEMENT_H

#include "laminate.h"

enum { POTENTIAL_NODES = 8 };

/*
 * Compute the stress resultants of an element, times its area, at zero strains while one potential
 * of a ply is 1 V (the others 0 V). The ply must be present in the element.
 *   resultants [8][10] out  resultants (N m): row 2 c + f for corner c (0 to 3) of face f (0:
 *       inner, 1: outer); columns: the ten strains (laminate.h)
 */
void potential_element_resultants(const laminate *laminate, const scene_element *element,
                                  const laminate_place *place, int ply,
                                  double resultants[POTENTIAL_NODES][LAMINATE_STRAINS]);

/*
 * Compute the capacitances at zero strains between the eight potentials of one ply (four corners on
 * two faces) and those of the same or another ply. Plies are coupled by the element's thickness and
 * shear strains.
 *   capacitance [8][8] out  charge at each potential of `ply` (row) per volt of each potential of
 *       `other` (column) (C/V)
 */
void potential_element_capacitance(const laminate *laminate, const scene_element *element,
                                   const laminate_place *place, int ply, int other,
                                   double capacitance[POTENTIAL_NODES][POTENTIAL_NODES]);

/*
 * Compute the charges at the eight electric potentials of a ply in an element (four corners on two
 * faces) while the strains and the potentials are zero.
 *   uniform     in   cause of the charges, constant over the element: a temperature, or the voltage
 *       of an electrode on another ply
 *   charge  [8] out  charges (C)
 */
void potential_element_charges(const laminate *laminate, const scene_element *element,
                               const laminate_place *place, int ply, const laminate_field *uniform,
                               double charge[POTENTIAL_NODES]);

/*
 * Compute the mean electric field in an element that the eight electric potentials of a ply (four
 * corners on two faces) cause: the voltage across the ply (V), and the field along the axes 1 and 2
 * of the shell at the inner and at the outer face (V/m).
 *   potential [8] in  potentials (V)
 */
void potential_element_field(const laminate *laminate, const scene_element *element,
                             const laminate_place *place, int ply,
                             const double potential[POTENTIAL_NODES], double *voltage,
                             double along[2][2]);

#endif
