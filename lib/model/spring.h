/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Springs of a structure. The elongation of a spring is the scalar product of a vector n, its row
 * in pzs_structure.spring, with the displacement over the free degrees of freedom. A spring of
 * stiffness k >= 0 has the stiffness matrix k n n^T. The vector n stays constant while the shell
 * deforms.
 */
#ifndef PZS_LIB_SPRING_H
#define PZS_LIB_SPRING_H

#include "pzs_model.h"

/*
 * Return whether all degrees of freedom of each spring lie among the stored entries (the envelope)
 * of the stiffness matrix, and every spring stiffness is finite and not negative.
 */
bool pzs_springs_in_range(const pzs_structure *structure);

/* Add the stiffness matrices of all springs to the stiffness matrix of the model. */
void pzs_model_add_springs(pzs_model *model);

/*
 * Add `factor` times the forces k n (n . u) that elongate the springs at a displacement u
 * [free_dof] to a force [free_dof], except at constrained degrees of freedom. k is the stiffness of
 * a spring; n . u is its elongation.
 */
void pzs_model_add_spring_force(const pzs_model *model, pzs_real factor,
                                const pzs_real *displacement, pzs_real *force);

#endif
