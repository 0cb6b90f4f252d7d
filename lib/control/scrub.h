/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Scrub of tables: their checksum is computed in slices, one in each tick, so that damage of flash
 * is found while the loop runs.
 */
#ifndef PZS_LIB_SCRUB_H
#define PZS_LIB_SCRUB_H

#include "pzs_control_state.h"

#define SCRUB_BYTES 64u /* bytes of a slice: a table of b bytes takes b / SCRUB_BYTES ticks */

/* One array of some tables; an absent one has no bytes. */
typedef struct scrub_part {
    const void *data;
    size_t bytes;
} scrub_part;

/*
 * Read the next slice of tables that consist of some parts.
 *   crc in  checksum of all parts in this order
 * Returns false at the end of the second pass in a row with a wrong checksum: the tables are
 * damaged. One pass alone with a wrong checksum may be damage of *scrub itself.
 */
bool pzs_scrub_slice(pzs_scrub *scrub, const scrub_part *part, uint32_t parts, uint32_t crc);

#endif
