/* SPDX-License-Identifier: BSD-2-Clause */
/* Gram-Schmidt orthogonalisation in the scalar product with a mass matrix. */
#ifndef PZS_LIB_ORTHOGONAL_H
#define PZS_LIB_ORTHOGONAL_H

#include "pzs_base.h"

/*
 * Subtract from a vector its components along the rows of a basis that is orthonormal in the scalar
 * product with a mass matrix M.
 *   basis    [rows][length] in      the basis
 *   weighted [length]       in      M times the vector before this call
 *   vector   [length]       in/out  the vector
 *   part     [rows]         in/out  the components are added to these numbers; NULL: not needed
 */
void pzs_orthogonalise(const pzs_real *basis, uint32_t rows, uint32_t length,
                       const pzs_real *weighted, pzs_real *vector, pzs_real *part);

#endif
