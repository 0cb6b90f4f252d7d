/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Electrodes of one layer must not overlap. Polygons are compared exactly; what rounding and the
 * sides of arcs may have in common, a thousandth of the smaller electrode, is allowed. A formula
 * overlaps another electrode where both cover a square of an 8 x 8 grid in an element, or more than
 * the element together.
 */
#ifndef OUTLINE_OVERLAP_H
#define OUTLINE_OVERLAP_H

#include "outline_shares.h"

/*
 * Compare the electrodes of one item of `patches` with each other, with those of the items before
 * it, and with patches of whole elements. Returns 0, or -1 with error filled.
 */
int outline_check_overlaps(const scene *scene, int item, char *error);

#endif
