/* SPDX-License-Identifier: BSD-2-Clause */
/* Nonlinear equilibrium with an automatic choice of how slowly the loads of a load step rise. */
#ifndef RAMP_H
#define RAMP_H

#include "equilibrium.h"

/*
 * Solve for the equilibrium at given input values, from the reference state. Where the scene leaves
 * the choice of ramp_solves to the program and the solver had to shorten load steps or found no
 * equilibrium, the loads are tried once more rising over more linear solves. The number that needs
 * fewer load steps is left in the settings of the solver.
 *   value [inputs] in  input values (V, K, Pa or load factors)
 * Returns the status of the solver.
 */
pzs_status ramp_equilibrium(equilibrium *equilibrium, const double *value);

#endif
