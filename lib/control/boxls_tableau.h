/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The tableau of the voltage optimiser: one symmetric matrix that takes the place of the Hessian H.
 * F is the free set (inputs that may move together), A the active set (inputs that stay):
 *
 *   tableau on F, A:   [ -H_FF^-1         H_FF^-1 H_FA                ]
 *                      [ H_AF H_FF^-1     H_AA - H_AF H_FF^-1 H_FA    ]
 *
 * One symmetric rank-one update (a sweep) moves an input between F and A. One product of the
 * tableau with the gradient of F gives the direction: on F the step to the minimum over F, on A the
 * change of the gradient by this step.
 */
#ifndef PZS_LIB_BOXLS_TABLEAU_H
#define PZS_LIB_BOXLS_TABLEAU_H

#include "optimiser.h"

/* Pivot of an active input divided by its diagonal entry of H: 1 if independent of the free inputs,
 * 0 if dependent. */
pzs_real pzs_tableau_independence(const pzs_optimiser *optimiser, uint32_t k);

/* Move input k into F (positive pivot) or out of F (negative pivot). Uses scratch. */
void pzs_tableau_sweep(pzs_optimiser *optimiser, uint32_t k);

/*
 * Recompute the tableau from H with the inputs marked as free, the most independent first. Inputs
 * that depend linearly on those before them end in the active set.
 */
void pzs_tableau_rebuild(pzs_optimiser *optimiser);

/* Trace of the inverse of H on F; dependent inputs count with the largest value possible (V2/m2).
 * Uses scratch. */
pzs_real pzs_tableau_inverse_trace(pzs_optimiser *optimiser);

#endif
