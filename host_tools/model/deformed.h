/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A structure linearised about the equilibrium at its target, with influence matrix B and vibration
 * modes of the deformed, prestressed structure. There the output rows have the displacements y0 and
 * the voltages are v0; near it the displacements are y = offset + B v with offset = y0 - B v0.
 */
#ifndef DEFORMED_H
#define DEFORMED_H

#include "analysis.h"
#include "modal_tables.h"

typedef struct deformed {
    linearised about; /* tangent stiffness matrix and forces of the inputs at the equilibrium at the
                         target shape */
    analysis analysis; /* analysis of the scene; its influence matrix [outputs][inputs] is that of
                          the structure linearised about the equilibrium at the target shape */
    vibration vibration;
    modal modal; /* vibration modes about the equilibrium at the target shape, with the amplifiers
                    as inputs */
    double *offset; /* [outputs] displacement of each output (of the target, or named in the scene)
                       at 0 V, extrapolated linearly from the equilibrium with the influence matrix
                     */
    double amplitude; /* largest displacement of a target node at the equilibrium at the target
                         shape, divided by the thickness of the shell */
} deformed;

/*
 * Compute the equilibrium at the voltages with the smallest shape error for the scene's target, and
 * linearise the structure there.
 *   nominal in  analysis of a scene with a target and all densities, whose kinematics is not linear
 *   modes   in  number of vibration modes
 * Returns 0, or -1 with error filled; call deformed_close in either case.
 */
int deformed_open(deformed *deformed, const analysis *nominal, int modes, char *error);
void deformed_close(deformed *deformed);

#endif
