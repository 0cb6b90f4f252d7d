/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Matrices of the electrodes that are open while a structure vibrates. No charge comes to them, so
 * that their voltages follow the displacement u and stiffen the structure,
 *   charge = B'u + C v = 0,   stiffness with open electrodes = K + B C^-1 B'.
 *   B  forces per volt on each open electrode     C  capacitances while the shell cannot deform
 *   v  voltages of the open electrodes            K  stiffness at prescribed voltages
 * A linear solve with the stiffness of the open electrodes, plus a multiple of the mass matrix M,
 * uses the factors of A = K + shift M and S = C + B' A^-1 B (Woodbury's identity),
 *   u = A^-1 (f - B v),   S v = B' A^-1 f.
 * By the block matrix of A, B and -C, the matrix with open electrodes has as many negative
 * eigenvalues as A has more than S.
 */
#ifndef PZS_LIB_OPEN_MATRIX_H
#define PZS_LIB_OPEN_MATRIX_H

#include "pzs_modes.h"
#include "../core/linalg.h"

#if PZS_MODES

/*
 * Take the open electrodes from electrode tables and divide the memory of their matrices.
 *   is_open [tables->count]  in  nonzero: the electrode is open; NULL: as tables->open says
 *   work                     in  memory of PZS_OPEN_MATRIX_BYTES, aligned for pzs_real; not read
 *                                where no electrode is open
 */
void pzs_open_matrix_begin(pzs_modes_electrodes *open, const pzs_electrodes *tables,
                           const uint8_t *is_open, void *work);

/* Return the number of open electrodes; `is_open` as in pzs_open_matrix_begin. */
uint16_t pzs_open_matrix_count(const pzs_electrodes *tables, const uint8_t *is_open);

/* Return the input of the structure that is the voltage of open electrode number i. */
uint16_t pzs_open_matrix_input(const pzs_modes_electrodes *open, uint32_t i);

/*
 * Factor the capacitances C into open->held.
 *   where out  electrode, by its index in the tables, to which the status refers, or -1
 * Returns PZS_OK, PZS_E_NONFINITE (a charge in the tables is NaN or infinite) or PZS_E_CAPACITANCE.
 */
pzs_status pzs_open_matrix_hold(pzs_modes_electrodes *open, int32_t *where);

/*
 * Set the entry (i, j) of S, j <= i, in a matrix of the open electrodes.
 *   work in  work of the force per volt on electrode j on the displacement A^-1 B per volt on i
 */
void pzs_open_matrix_set(const pzs_modes_electrodes *open, pzs_envelope *matrix, uint32_t i,
                         uint32_t j, pzs_real work);

/*
 * Factor the matrix S.
 *   inertia in/out  pivots of A; out: of the matrix with open electrodes. inertia->zero is 0 where
 * S is singular
 */
void pzs_open_matrix_factor(pzs_envelope *matrix, linalg_inertia *inertia);

/*
 * Compute the voltages of the open electrodes without charge under a displacement u, while the
 * other electrodes are at 0 V. open->held must hold the factors of C. open->work    [count] in
 * works B'u of the forces per volt open->voltage [count] out  voltages -C^-1 B'u Returns twice the
 * electric energy u'B C^-1 B'u.
 */
pzs_real pzs_open_matrix_follow(const pzs_modes_electrodes *open);

/*
 * Turn the works of the forces per unit of every input on a displacement into those with open
 * electrodes, whose inputs become charges. open->held must hold the factors of C. A common factor
 * of the works remains.
 *   row [inputs] in/out  works
 */
void pzs_open_matrix_respond(const pzs_modes_electrodes *open, pzs_real *row);

#endif
#endif
