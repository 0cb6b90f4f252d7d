/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Charges at the electric potentials of bare faces (without electrodes). They are rows of the
 * matrix of charges, which holds charges per unit of each input. The first rows of this matrix are
 * those of the electrodes of amplifiers and sensors; the rows of the potentials follow.
 */
#ifndef BARE_CHARGES_H
#define BARE_CHARGES_H

#include "design.h"

/*
 * Add the charges at the potentials of one element to the matrix of charges, at zero strain: those
 * that 1 V of each potential and 1 K of each temperature input causes. The element's potentials are
 * those of its nodes on bare faces (without electrodes).
 *   dense [electrodes][inputs] in/out  charge of each electrode or potential per unit of each input
 */
void bare_charges_add(const design *design, int element, double *dense);

/*
 * Add the capacitances between an electrode and the potentials of one element on bare faces
 * (without electrodes) to the matrix of charges, at zero strain. Both directions are added: charges
 * at the potentials per volt of the electrode, and charge of the electrode per volt of each
 * potential.
 *   ply    in     ply on which the electrode lies
 *   factor in     voltage across the ply per volt of the electrode, times the part of the element
 *       that the electrode covers
 *   row    in     row of the electrode in `dense`
 *   dense [electrodes][inputs] in/out  charge of each electrode or potential per unit of each input
 */
void bare_charges_add_electrode(const design *design, int element, int ply, double factor, int row,
                                double *dense);

/*
 * Add the charges that 1 K of a heater causes at the bare faces (without electrodes) of one element
 * to the matrix of charges, at zero strain.
 *   factor in  temperature of the ply per kelvin of the heater, times the part of the element that
 *       the heater covers
 *   input  in  index of the heater's temperature among the inputs of the structure
 *   dense [electrodes][inputs] in/out  charge of each electrode or potential per unit of each input
 */
void bare_charges_add_heater(const design *design, int element, int ply, double factor, int input,
                             double *dense);

#endif
