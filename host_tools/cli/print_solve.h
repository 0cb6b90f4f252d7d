/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of `pzs solve`. */
#ifndef PRINT_SOLVE_H
#define PRINT_SOLVE_H

#include "../model/analysis.h"
#include "../model/stress.h"

/*
 * Print the outputs of the scene under a displacement, then the forces of springs and the voltages
 * and charges of electrodes.
 *   displacement [free_dof] in  displacement vector of the structure
 *   value                   in  values of all outputs of the scene, output after output
 *   stress                  in  stresses, or NULL where they are not asked for
 */
void print_solve(analysis *analysis, const double *displacement, const double *value,
                 const stress_field *stress);
void print_solve_json(analysis *analysis, const double *displacement, const double *value,
                      const stress_field *stress);

#endif
