/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration modes of one structure that were computed before, kept because the stability tests of a
 * loop ask for the same numbers of modes again and again. The modes of a number are those of a
 * computation of exactly this number, so that results do not depend on what was asked before.
 */
#ifndef KEPT_MODES_H
#define KEPT_MODES_H

#include "vibration.h"

enum { KEPT_MODES_LIMIT = 12 }; /* largest number of results that are kept */

typedef struct kept_modes {
    int count; /* number of results that are kept */
    vibration result[KEPT_MODES_LIMIT];
} kept_modes;

/*
 * Copy the vibration modes of a former computation.
 *   number in  number of modes that the computation was asked for, at most vibration_most
 * Returns whether such a result is kept and memory sufficed for its copy; if not, `result` is
 * empty.
 */
bool kept_modes_copy(const kept_modes *kept, const design *design, int number, vibration *result);

/*
 * Keep a copy of vibration modes, in place of the fewest modes kept where there is no room. Modes
 * that take too much memory are not kept.
 */
void kept_modes_add(kept_modes *kept, const design *design, const vibration *result);
void kept_modes_free(kept_modes *kept);

#endif
