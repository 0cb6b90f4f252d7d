/* SPDX-License-Identifier: BSD-2-Clause */
/* Arrays of a VTK file that describe the structure and its task (vtk.h). */
#ifndef VTK_STRUCTURE_H
#define VTK_STRUCTURE_H

#include "../model/design.h"
#include "vtk_file.h"

/*
 * Add what lies in each cell to a VTK file: element type, presence of each layer (1 or 0), and for
 * each grid of patches the number of the patch from 1 (0: none) and its voltage. Where outlines cut
 * an element, it is the patch that covers most of it.
 *   voltage [amplifiers] in  voltages of the amplifiers (V); NULL: the file gets no voltages
 */
void vtk_add_cells(vtk_file *vtk, const design *design, const double *voltage);

/*
 * Add the target to a VTK file: at the target nodes the weight, the target displacement, the
 * displacement reached and their difference; 0 at other nodes.
 *   shape  [targets] in  displacements reached
 *   target [targets] in  target displacements
 */
void vtk_add_target(vtk_file *vtk, const design *design, const double *shape, const double *target);

#endif
