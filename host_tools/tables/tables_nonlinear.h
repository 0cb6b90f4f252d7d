/* Tables of the nonlinear path: actuation, followers, contact, and the equilibrium that the host
 * found. */
#ifndef TABLES_NONLINEAR_H
#define TABLES_NONLINEAR_H

#include "../model/analysis.h"
#include "emit.h"

/* Write them after the structure's. Returns 0, or -1 when memory ran out. */
int tables_nonlinear(emitter *emitter, const analysis *analysis);

#endif
