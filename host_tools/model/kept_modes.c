/* SPDX-License-Identifier: BSD-2-Clause */
/* Store of the vibration modes of one structure that have been computed so far (kept_modes.h). */
#include "kept_modes.h"
#include <string.h>

/*
 * Largest number of values (doubles) in all mode shapes that are kept together: 256 MiB of memory.
 */
static const size_t reals_limit = (size_t)1 << 25;

static size_t reals_of(const design *design, const vibration *result)
{
    return (size_t)result->count * (size_t)design->mesh.free_dof;
}

static size_t reals_kept(const kept_modes *kept, const design *design)
{
    size_t sum = 0;
    for (int i = 0; i < kept->count; i++)
        sum += reals_of(design, &kept->result[i]);
    return sum;
}

bool kept_modes_copy(const kept_modes *kept, const design *design, int number, vibration *result)
{
    for (int i = 0; i < kept->count; i++)
        if (kept->result[i].count == number)
            return vibration_copy(result, &kept->result[i], design);
    return false;
}

/*
 * Remove the set with the fewest vibration modes from the kept ones, because it is the cheapest to
 * compute again.
 */
static void remove_fewest(kept_modes *kept)
{
    int fewest = 0;
    for (int i = 1; i < kept->count; i++)
        if (kept->result[i].count < kept->result[fewest].count)
            fewest = i;
    vibration_free(&kept->result[fewest]);
    kept->count--;
    memmove(&kept->result[fewest], &kept->result[fewest + 1],
            (size_t)(kept->count - fewest) * sizeof *kept->result);
}

void kept_modes_add(kept_modes *kept, const design *design, const vibration *result)
{
    const size_t reals = reals_of(design, result);
    if (reals > reals_limit)
        return;
    while (kept->count == KEPT_MODES_LIMIT || reals_kept(kept, design) + reals > reals_limit)
        remove_fewest(kept);
    if (vibration_copy(&kept->result[kept->count], result, design))
        kept->count++;
}

void kept_modes_free(kept_modes *kept)
{
    for (int i = 0; i < kept->count; i++)
        vibration_free(&kept->result[i]);
    kept->count = 0;
}
