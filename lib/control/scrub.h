/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Scrub of constant tables: their checksum is computed in slices, one in each tick, so that damage
 * of flash memory is found while the loop runs.
 */
#ifndef PZS_LIB_SCRUB_H
#define PZS_LIB_SCRUB_H

#include "pzs_control_state.h"

#define SCRUB_BYTES                                                                                \
    64u /* size of a slice (bytes): tables of b bytes are checked once in b / SCRUB_BYTES ticks */

/* One array of the tables under a scrub; an absent array has 0 bytes. */
typedef struct scrub_part {
    const void *data;
    size_t bytes;
} scrub_part;

/*
 * Read the next slice of tables that consist of several parts.
 *   crc in  checksum of all parts in this order
 * Returns false if the checksum was wrong twice in succession: the tables are damaged. A single
 * wrong checksum may come from damage of *scrub itself.
 */
bool pzs_scrub_slice(pzs_scrub *scrub, const scrub_part *part, uint32_t parts, uint32_t crc);

#endif
