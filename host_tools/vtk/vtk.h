/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * VTK files of results for ParaView. Each function returns 0, or -1 when memory runs out or the
 * file cannot be written.
 */
#ifndef VTK_H
#define VTK_H

#include <stdio.h>
#include "../model/analysis.h"
#include "../model/stress_field.h"
#include "../model/vibration.h"

/*
 * Write a VTK file for ParaView with the results of one solution. With stresses, a node on the
 * border of a patch is two points in the file, one for each side.
 *   u [dof]  in  displacement vector
 *   stress   in  recovered stresses; NULL: without
 * Contents:
 *   nodes               displacement of the middle surface, potentials of bare faces (without
 *       electrodes), forces and moments of the supports, forces of a contact body
 *   layers and heights  stress and strain in material axes, at element centres and averaged at
 *       nodes
 *   elements            reserve factors, resultants and electric fields
 */
int vtk_write_solution(FILE *file, const analysis *analysis, const double *u,
                       const stress_field *stress);

/* Write a VTK file for ParaView with one displacement field for each vibration mode. */
int vtk_write_modes(FILE *file, const mesh *mesh, const vibration *vibration);

#endif
