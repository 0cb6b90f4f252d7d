/* SPDX-License-Identifier: BSD-2-Clause */
/* Tables of the equilibrium solver: prescribed resultants, follower loads, contact, settings, and
 * the equilibrium that the host computed. */
#ifndef TABLES_NONLINEAR_H
#define TABLES_NONLINEAR_H

#include "../model/analysis.h"
#include "emit.h"

/* Write these tables, after the tables of the structure. Returns 0, or -1 when memory ran out. */
int tables_nonlinear(emitter *emitter, const analysis *analysis);

#endif
