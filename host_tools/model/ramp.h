/* SPDX-License-Identifier: BSD-2-Clause */
/* Nonlinear equilibrium with an automatic choice of how slowly the loads of a load step rise. */
#ifndef RAMP_H
#define RAMP_H

#include "equilibrium.h"

/*
 * Compute the equilibrium at given input values from the reference state. If that fails or shortens
 * load steps, try again with more slowly rising loads, unless the scene states `ramp_solves`. The
 * settings of the better try stay in the solver.
 *   value [inputs] in  input values (V, K, Pa or load factors)
 * Returns the status of the solver.
 */
pzs_status ramp_equilibrium(equilibrium *equilibrium, const double *value);

#endif
