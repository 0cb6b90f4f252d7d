/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Nodal charges of bare faces: faces of piezoelectric layers without electrodes. The electric
 * potential of such a face is an unknown at each of its nodes. The nodal charge (C) is conjugate to
 * this potential: the work of a change of the potential is the charge times the change. The charges
 * are rows of the charge matrix [electrodes and potentials][inputs] (charge per unit of each
 * input). Its first rows belong to the electrodes of amplifiers and sensors, the following ones to
 * the potentials.
 */
#ifndef BARE_CHARGES_H
#define BARE_CHARGES_H

#include "design.h"

/*
 * Bare faces (faces of a layer without electrodes) have an unknown electric potential at each node.
 * Add the charges at these nodes of one element to the matrix of charges, at zero strain: the
 * charges by 1 V at each of these nodes, and those by 1 K of each temperature input.
 *   dense [electrodes][inputs] in/out  matrix of charges: each row is the charge on an electrode,
 *                                      or at a node of a bare face (C); each column is for one volt
 *                                      (or other unit) of an input. The potentials of bare faces
 *                                      count as inputs
 */
void bare_charges_add(const design *design, int element, double *dense);

/*
 * Add the capacitances between an electrode and the nodes of one element on bare faces (without
 * electrodes) to the matrix of charges, at zero strain. They enter two blocks of the matrix: the
 * charge at each node per volt of the electrode, and the charge of the electrode per volt at each
 * node.
 *   ply    in     ply on which the electrode lies
 *   factor in     voltage across the ply per volt of the electrode, times the part of the element
 *       that the electrode covers
 *   row    in     row of the electrode in `dense`
 *   dense [electrodes][inputs] in/out  matrix of charges: each row is the charge on an electrode,
 *                                      or at a node of a bare face (C); each column is for one volt
 *                                      (or other unit) of an input. The potentials of bare faces
 *                                      count as inputs
 */
void bare_charges_add_electrode(const design *design, int element, int ply, double factor, int row,
                                double *dense);

/*
 * Add the charges that 1 K of a heater causes at the bare faces (without electrodes) of one element
 * to the matrix of charges, at zero strain.
 *   factor in  temperature of the ply per kelvin of the heater, times the part of the element that
 *       the heater covers
 *   input  in  index of the heater's temperature among the inputs of the structure
 *   dense [electrodes][inputs] in/out  matrix of charges: each row is the charge on an electrode,
 *                                      or at a node of a bare face (C); each column is for one volt
 *                                      (or other unit) of an input. The potentials of bare faces
 *                                      count as inputs
 */
void bare_charges_add_heater(const design *design, int element, int ply, double factor, int input,
                             double *dense);

#endif
