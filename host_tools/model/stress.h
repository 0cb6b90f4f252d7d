/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stresses and strains of a solved structure, in which the transverse stresses follow from the
 * equilibrium of stresses.
 */
#ifndef STRESS_H
#define STRESS_H

#include "stress_field.h"

/*
 * Recover the stresses of a structure from its displacement and input values (the state). The field
 * points to the numerical model and the arrays of the state, which must remain valid. Returns 0, or
 * -1 if memory runs out; call stress_free in both cases.
 */
int stress_recover(stress_field *field, const stress_state *state);

/*
 * Recover the stresses of a structure whose displacement has been corrected (stress_corrected.h).
 *   correction in  correction of the displacement, whose arrays the field then owns
 * Returns 0, or -1 if memory runs out; call stress_free in both cases.
 */
int stress_recover_with(stress_field *field, const stress_state *state,
                        const stress_correction *correction);

#endif
