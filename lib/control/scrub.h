/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Scrub of constant tables: their checksum is computed in slices, one in each tick, so that damage
 * of flash memory is found while the loop runs.
 */
#ifndef PZS_LIB_SCRUB_H
#define PZS_LIB_SCRUB_H

#include "pzs_control_state.h"

/*
 * Size of a slice of constant tables (bytes). One slice is checked in each tick, so the tables are
 * checked completely in as many ticks as they have slices.
 */
#define SCRUB_BYTES 64u

/*
 * Describe an array of `count` reals, which may be absent (NULL), as one of the arrays that the
 * checksum of a table covers.
 */
static inline pzs_table_part scrub_reals(const pzs_real *value, size_t count)
{
    const pzs_table_part part = {value, value != NULL ? count * sizeof *value : 0};
    return part;
}

/* Return the checksum of tables that consist of several arrays, in the order of the arrays. */
uint32_t pzs_scrub_crc(const pzs_table_part *part, uint32_t parts);

/*
 * Continue the checksum of constant tables, which consist of several arrays, with the next slice of
 * their bytes.
 *   crc in  expected checksum of all arrays in this order
 * Returns false if the tables are damaged: the checksum was wrong twice in succession. A single
 * wrong one may come from damage of *scrub itself.
 */
bool pzs_scrub_slice(pzs_scrub *scrub, const pzs_table_part *part, uint32_t parts, uint32_t crc);

#endif
