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
 * A face of a layer without electrodes (bare face) has an unknown electric potential at each node.
 * For the nodes of one element on bare faces, add to a matrix the charges there at zero strain,
 * caused by 1 V at each of these nodes and by 1 K of each temperature input.
 *   dense [electrodes][inputs] in/out  charges (C) per unit of each input. Rows: first the
 *       electrodes, then the nodes of bare faces. Columns: the inputs of the structure, which
 *       include the potentials of bare faces
 */
void bare_charges_add(const design *design, int element, double *dense);

/*
 * Add to a matrix the capacitances, at zero strain, between an electrode and the nodes of one
 * element on bare faces (without electrodes). They enter two blocks of the matrix: the charge at
 * each node per volt of the electrode, and the charge of the electrode per volt at each node.
 *   ply    in     ply on which the electrode lies
 *   factor in     voltage across the ply per volt of the electrode, times the fraction of the
 *       element's area that the electrode covers
 *   row    in     row of the electrode in `dense`
 *   dense [electrodes][inputs] in/out  charges (C) per unit of each input. Rows: first the
 *       electrodes, then the nodes of bare faces. Columns: the inputs of the structure, which
 *       include the potentials of bare faces
 */
void bare_charges_add_electrode(const design *design, int element, int ply, double factor, int row,
                                double *dense);

/*
 * Add to a matrix the charges, at zero strain, that 1 K of a heater causes at the nodes of one
 * element on bare faces (without electrodes).
 *   factor in  temperature of the ply per kelvin of the heater, times the fraction of the element's
 *       area that the heater covers
 *   input  in  column of the heater in `dense`
 *   dense [electrodes][inputs] in/out  charges (C) per unit of each input. Rows: first the
 *       electrodes, then the nodes of bare faces. Columns: the inputs of the structure, which
 *       include the potentials of bare faces
 */
void bare_charges_add_heater(const design *design, int element, int ply, double factor, int input,
                             double *dense);

#endif
