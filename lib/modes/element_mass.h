/* SPDX-License-Identifier: BSD-2-Clause */
/* Mass tables of a structure: checks, and products with the mass matrix. */
#ifndef PZS_LIB_ELEMENT_MASS_H
#define PZS_LIB_ELEMENT_MASS_H

#include "pzs_modes.h"

#if PZS_MODES

/*
 * Multiply a symmetric matrix, a packed lower triangle of `count` rows, with a vector.
 *   vector, product [count] in, out  different arrays
 */
void pzs_packed_multiply(const pzs_real *entry, uint32_t count, const pzs_real *vector,
                         pzs_real *product);

/*
 * Check that mass tables are complete, undamaged, finite and made for a structure.
 *   where out  element or type of mass to which the status refers, or -1
 * Returns PZS_OK, PZS_E_ARGUMENT, PZS_E_FORMAT, PZS_E_CRC or PZS_E_NONFINITE.
 */
pzs_status pzs_mass_check(const pzs_mass *mass, const pzs_structure *structure, int32_t *where);

/*
 * Add the product of the mass matrix with a vector, times a factor, to a vector over the free
 * degrees of freedom of a model. Entries at constrained degrees of freedom do not change.
 *   vector  [free_dof] in      vector, another array than the product
 *   product [free_dof] in/out  sum
 */
void pzs_mass_add_product(const pzs_mass *mass, const pzs_model *model, pzs_real factor,
                          const pzs_real *vector, pzs_real *product);

/* Add the mass matrix, times a factor, to the stiffness matrix of a model, which is not scaled. */
void pzs_mass_add(const pzs_mass *mass, pzs_model *model, pzs_real factor);

/*
 * Add up the diagonal entries of the element mass matrices for each free degree of freedom. At
 * nodes of oblique supports the entries belong to the triad of the node.
 *   diagonal [free_dof] out
 */
void pzs_mass_diagonal(const pzs_mass *mass, const pzs_structure *structure, pzs_real *diagonal);

#endif
#endif
