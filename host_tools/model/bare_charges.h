/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Nodal charges (C) of bare faces: faces of piezoelectric layers without electrodes, whose electric
 * potential at each node is unknown. Charge matrix [electrodes and potentials][inputs]: charges per
 * unit of each input, first for the electrodes of amplifiers and sensors, last for the potentials.
 */
#ifndef BARE_CHARGES_H
#define BARE_CHARGES_H

#include "design.h"

/*
 * Add to a matrix the charges, at zero strain, at the nodes of one element on bare faces (without
 * electrodes): under 1 V at each of these nodes and 1 K of each temperature input.
 *   dense [electrodes][inputs] in/out  charges (C) per unit of each input. Rows: electrodes, then
 *       nodes of bare faces; columns include the potentials of these nodes
 */
void bare_charges_add(const design *design, int element, double *dense);

/*
 * Add to a matrix the capacitances, at zero strain, between an electrode and the nodes of one
 * element on bare faces (without electrodes): charge at each node per volt of the electrode, and
 * the reverse.
 *   ply    in     ply on which the electrode lies
 *   factor in     voltage across the ply per volt of the electrode, times the covered fraction of
 *       the element's area
 *   row    in     row of the electrode in `dense`
 *   dense [electrodes and potentials][inputs] in/out  charges (C) per unit of each input
 */
void bare_charges_add_electrode(const design *design, int element, int ply, double factor, int row,
                                double *dense);

/*
 * Add to a matrix the charges, at zero strain, that 1 K of a heater causes at the nodes of one
 * element on bare faces (without electrodes).
 *   factor in  temperature of the ply per kelvin of the heater, times the covered fraction of the
 *       element's area
 *   input  in  column of the heater in `dense`
 *   dense [electrodes and potentials][inputs] in/out  charges (C) per unit of each input
 */
void bare_charges_add_heater(const design *design, int element, int ply, double factor, int input,
                             double *dense);

#endif
