/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Store of computed vibration modes of one structure, because stability tests ask for the same
 * numbers of modes repeatedly. A request for n modes is answered only by a computation of exactly n
 * modes, so that results do not depend on earlier requests.
 */
#ifndef KEPT_MODES_H
#define KEPT_MODES_H

#include "vibration.h"

/* Largest number of sets of vibration modes that are kept, each from one computation. */
enum { KEPT_MODES_LIMIT = 12 };

typedef struct kept_modes {
    int count; /* number of sets of vibration modes that are kept, each from one computation */
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
 * Store a copy of computed vibration modes. If there is no room, the stored sets with the fewest
 * modes are deleted until there is. A set that exceeds the memory of the store by itself is not
 * stored.
 */
void kept_modes_add(kept_modes *kept, const design *design, const vibration *result);
void kept_modes_free(kept_modes *kept);

#endif
