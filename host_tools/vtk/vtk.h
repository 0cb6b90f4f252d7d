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

/* A solution of a scene that is written to a VTK file. */
typedef struct vtk_solution {
    const analysis *analysis;
    const double *displacement;   /* [free_dof] displacement vector */
    const double *voltage;        /* [amplifiers] voltages of the amplifiers (V) */
    const double *shape, *target; /* [targets] displacements reached and target displacements; NULL:
                                     without target */
    const stress_field *stress;   /* recovered stresses; NULL: without */
} vtk_solution;

/*
 * Write a VTK file for ParaView with the results of one solution. With stresses, a node on the
 * border of a patch is two points in the file, one for each side. Of a measured influence matrix,
 * which has no mesh, the cells are the outputs. Contents:
 *   nodes               displacement of the middle surface, target, shape reached and misfit,
 *                       potentials of bare faces (without electrodes), forces and moments of the
 *                       supports, forces of a contact body
 *   elements            element type, layers that are present, patches and their voltages
 *   layers and heights  stress and strain in material axes, at element centres and averaged at
 *                       nodes
 *   elements            reserve factors, resultants and electric fields
 */
int vtk_write_solution(FILE *file, const vtk_solution *solution);

/* Write a VTK file for ParaView with one displacement field for each vibration mode. */
int vtk_write_modes(FILE *file, const mesh *mesh, const vibration *vibration);

#endif
