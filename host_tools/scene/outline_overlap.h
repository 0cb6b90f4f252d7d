/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check that the electrodes of one layer do not overlap.
 *
 * Of two electrodes bounded by polygons, the common area is computed exactly. It may be up to a
 * thousandth of the smaller electrode, for rounding and for arcs that are drawn by straight sides.
 *
 * If an electrode is given by a formula, the check is done in each element. Two electrodes overlap
 * if their areas in the element add up to more than the area of the element. They also overlap if
 * both of them cover one and the same of the 8 x 8 equal squares into which the element is divided.
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
