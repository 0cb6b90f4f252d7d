/* SPDX-License-Identifier: BSD-2-Clause */
/* Check of constant tables in slices, one slice in each tick of the loop. */
#include "scrub.h"
#include "../core/guard.h"

uint32_t pzs_scrub_crc(const pzs_table_part *part, uint32_t parts)
{
    uint32_t crc = GUARD_CRC_START;
    for (uint32_t k = 0; k < parts; k++)
        crc = part[k].bytes > 0 ? pzs_guard_crc(crc, part[k].data, part[k].bytes) : crc;
    return ~crc;
}

/*
 * Compare the checksum computed from all slices of the tables with the expected checksum, and start
 * again at the first slice. Returns false if the checksum was wrong both this time and the time
 * before.
 */
static bool compare_checksum(pzs_scrub *scrub, uint32_t crc)
{
    guard_repair_bool(&scrub->has_failed);
    const bool is_wrong = ~scrub->crc != crc;
    const bool is_intact = !is_wrong || !scrub->has_failed;
    scrub->has_failed = is_wrong;
    scrub->position = 0;
    return is_intact;
}

bool pzs_scrub_slice(pzs_scrub *scrub, const pzs_table_part *part, uint32_t parts, uint32_t crc)
{
    size_t room = SCRUB_BYTES, before = 0;
    if (scrub->position == 0)
        scrub->crc = GUARD_CRC_START;
    for (uint32_t k = 0; k < parts && room > 0; k++) {
        const size_t skipped = scrub->position > before ? scrub->position - before : 0;
        before += part[k].bytes;
        if (skipped >= part[k].bytes)
            continue;
        const size_t rest = part[k].bytes - skipped, count = rest < room ? rest : room;
        scrub->crc = pzs_guard_crc(scrub->crc, (const uint8_t *)part[k].data + skipped, count);
        scrub->position += (uint32_t)count;
        room -= count;
    }
    return room == 0 || compare_checksum(scrub, crc);
}
