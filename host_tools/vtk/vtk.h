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
    const double *displacement;   /* [free_dof] displacement vector of the structure */
    const double *voltage;        /* [amplifiers] voltages of the amplifiers (V) */
    const double *shape, *target; /* [targets] displacements that are reached, and displacements
                                     that are wanted, at the target nodes; NULL: the scene has no
                                     target */
    const stress_field *stress; /* stresses and strains of the layers; NULL: the file contains none
                                 */
} vtk_solution;

/*
 * Write a VTK file for ParaView with the results of one solution. If the file contains stresses, a
 * node on the border of a patch is written as two points, one for each side of the border. A scene
 * with a measured influence matrix has no mesh; the cells are then its output points. Contents:
 *   nodes               displacement of the middle surface, target, shape reached and misfit,
 *                       potentials of bare faces (without electrodes), forces and moments of the
 *                       supports, forces of a contact body
 *   elements            element type, layers that are present, patches and their voltages
 *   layers and heights  stress and strain in material axes, at element centres and averaged at
 *                       nodes
 *   elements            reserve factors, resultants and electric fields
 */
int vtk_write_solution(FILE *file, const vtk_solution *solution);

/*
 * Write a VTK file for ParaView with one displacement field for each vibration mode, and with
 * element types, layers and patches of the elements.
 */
int vtk_write_modes(FILE *file, const design *design, const vibration *vibration);

#endif
