/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check that the electrodes of one layer do not overlap.
 *
 * The areas of two polygons are compared exactly. They may have a common area of a thousandth of
 * the smaller electrode, for rounding and for arcs that are drawn by straight sides. For an
 * electrode that is given by a formula, each element is divided into 8 x 8 squares. The electrode
 * overlaps another one where both cover the whole of one square, or where they cover together more
 * than an element.
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
