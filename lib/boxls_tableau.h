/*
 * The tableau of the voltage optimiser: one symmetric matrix in the place of the Hessian H.
 * "Swept" inputs F are those free to move together, the others S stand still:
 *
 *   tableau on F, S:   [ -H_FF^-1         H_FF^-1 H_FS                ]
 *                      [ H_SF H_FF^-1     H_SS - H_SF H_FF^-1 H_FS    ]
 *
 * One symmetric rank-1 change (sweep) moves an input between F and S. One product with the
 * gradient gives `move`: on F the way to the minimum over F, on S the gradient once there.
 */
#ifndef PZS_BOXLS_TABLEAU_H
#define PZS_BOXLS_TABLEAU_H

#include "boxls.h"

/* Pivot of a standing input over its diagonal: what is left of it beside the swept ones, 0 to 1. */
pzs_real tableau_own_part(const boxls *b, uint32_t k);

/* Move input k into F (its pivot is positive) or out of it (negative); uses spare. */
void tableau_sweep(boxls *b, uint32_t k);

/* Sweep anew from H every input marked as swept, the most independent first; those that depend on the ones before stand. */
void tableau_rebuild(boxls *b);

/* Trace of the inverse of H on F; dependent inputs count with the most it can be (V2/m2). Uses spare. */
pzs_real tableau_softness(boxls *b);

#endif
