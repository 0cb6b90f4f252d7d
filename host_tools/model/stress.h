/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stresses and strains of a solved structure, in which the transverse stresses follow from the
 * equilibrium of stresses.
 */
#ifndef STRESS_H
#define STRESS_H

#include "stress_field.h"

/*
 * Recover the stresses of a structure from its computed displacement and input values (the state).
 * The recovered stress field points to the numerical model and to the arrays of the state, which
 * must remain valid until the field is freed. Returns 0, or -1 if memory runs out; the field must
 * be freed with stress_free in both cases.
 */
int stress_recover(stress_field *field, const stress_state *state);

#endif
