/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check that the electrodes of one layer do not overlap, with a tolerance of a thousandth for
 * rounding and for arcs drawn by straight sides. Method:
 *   polygons   the common area of two electrodes is computed exactly
 *   formula    in each element, two electrodes overlap if their areas add up to more than that of
 *       the element, or if both cover one of its 8 x 8 equal squares
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
