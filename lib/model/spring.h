/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Springs of a structure. Spring s has the elongation n_s . u, with u the displacement over the
 * free dof and n_s its row in structure.spring, and the stiffness k_s >= 0. Its stiffness matrix is
 * k_s n_s n_s'. The rows do not turn with the deformed shell.
 */
#ifndef PZS_LIB_SPRING_H
#define PZS_LIB_SPRING_H

#include "pzs_model.h"

/*
 * Whether all dof of each spring lie inside the envelope of the stiffness matrix, and every
 * stiffness is finite and not negative.
 */
bool pzs_springs_in_range(const pzs_structure *structure);

/* Add the stiffness matrices of all springs to the envelope of the model. */
void pzs_model_add_springs(pzs_model *model);

/*
 * f [free_dof] += factor times the forces that displace the springs by p [free_dof], except at
 * constrained dof.
 */
void pzs_model_add_spring_force(const pzs_model *model, pzs_real factor, const pzs_real *p,
                                pzs_real *f);

#endif
