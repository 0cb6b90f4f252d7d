/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Comparison of the electrodes of one layer, which must not overlap. The areas of polygons are
 * compared exactly; a common area of a thousandth of the smaller electrode is allowed, for rounding
 * and for arcs that are drawn by straight sides. An electrode that is given by a formula overlaps
 * another one where both cover a whole square of an 8 x 8 grid in an element, or where both cover
 * more than the element together.
 */
#ifndef OUTLINE_OVERLAP_H
#define OUTLINE_OVERLAP_H

#include "outline_shares.h"

/*
 * Compare the electrodes of item number `item` of the section `patches` with each other, with those
 * of the earlier items, and with patches of whole elements. Returns 0, or -1 with error filled.
 */
int outline_check_overlaps(const scene *scene, int item, char *error);

#endif
