/*
 * A control block that damages the controller between the control step and the last gate.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef DAMAGE_BLOCK_H
#define DAMAGE_BLOCK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "pzs.h"

/* A bit to flip in the working memory of the controller. */
typedef struct flip_damage {
    bool is_due;  /* whether the block flips the bit in this tick */
    uint64_t bit; /* number of the bit, taken modulo the number of bits */
    size_t bytes; /* size of the part of the memory that may be damaged */
} flip_damage;

/* Flip one bit of a memory. */
static inline void flip(void *memory, size_t bit)
{
    ((uint8_t *)memory)[bit / 8] ^= (uint8_t)(1u << bit % 8);
}

/* Size and start of a block that has no memory of its own. */
static inline size_t damage_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    (void)problem;
    return 0;
}

static inline pzs_status damage_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    (void)self;
    (void)tables;
    (void)signals;
    return PZS_OK;
}

static inline pzs_status flip_tick(void *self, pzs_loop_signals *signals)
{
    const flip_damage *damage = signals->tables;
    (void)self;
    if (damage->is_due)
        flip(signals->control->state.work, (size_t)(damage->bit % (8 * damage->bytes)));
    return PZS_OK;
}

/* Block whose tables are a flip_damage. */
static const pzs_block_type flip_block = {"flip",      PZS_PHASE_VOLTAGE, damage_bytes,
                                          damage_init, flip_tick,         NULL};

#endif
