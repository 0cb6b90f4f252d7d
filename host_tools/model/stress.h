/* SPDX-License-Identifier: BSD-2-Clause */
/* Stresses and strains of a solved structure, with the transverse stresses from equilibrium. */
#ifndef STRESS_H
#define STRESS_H

#include "stress_field.h"

/*
 * Recover the stresses of a structure. The design and the arrays of the state must outlive the
 * field. Returns 0, or -1 if memory runs out; the field must be freed in both cases (stress_free).
 */
int stress_recover(stress_field *field, const stress_state *state);

#endif
