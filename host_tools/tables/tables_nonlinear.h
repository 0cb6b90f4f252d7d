/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Generated C tables of the equilibrium solver: stress resultants that actuators and temperatures
 * prescribe, follower loads, contact, settings, and the equilibrium that the host computed.
 */
#ifndef TABLES_NONLINEAR_H
#define TABLES_NONLINEAR_H

#include "../model/analysis.h"
#include "emit.h"

/*
 * Write the constants of the nonlinear equilibrium solver into the generated C header, behind those
 * of the structure. Returns 0, or -1 where memory runs out.
 */
int tables_nonlinear(emitter *emitter, const analysis *analysis);

#endif
