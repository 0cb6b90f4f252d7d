/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Hysteresis and creep of one electrode (pzs_hysteresis): the effect of a voltage, the voltage of
 * an effect, and what the electrode remembers.
 */
#ifndef PZS_LIB_HYSTERESIS_H
#define PZS_LIB_HYSTERESIS_H

#include "pzs_loop.h"

/* Checksum of the counts and arrays of the tables, as stored in their crc field. */
uint32_t pzs_hysteresis_crc(const pzs_hysteresis *tables);

/* What one electrode remembers. */
typedef struct hysteresis_memory {
    pzs_real *play;  /* [plays] positions of the plays, relative to the middle of the range (V) */
    pzs_real *creep; /* [creeps] effects of the creep (V) */
} hysteresis_memory;

/* Set the memory of electrode `input` to that of a voltage that has been there for long. */
void pzs_hysteresis_rest(const pzs_hysteresis *tables, uint32_t input, hysteresis_memory memory,
                         pzs_real voltage);

/*
 * Let electrode `input` stand at a voltage for some ticks, at least one. A memory that no voltages
 * can have left, as after damage, becomes the nearest one that they can; a number that is NaN does
 * so too.
 */
void pzs_hysteresis_remember(const pzs_hysteresis *tables, uint32_t input, hysteresis_memory memory,
                             pzs_real voltage, uint32_t ticks);

/* Effect (V) that electrode `input` has when it moves to a voltage. It does not fall as the voltage
 * rises. */
pzs_real pzs_hysteresis_effect(const pzs_hysteresis *tables, uint32_t input,
                               hysteresis_memory memory, pzs_real voltage);

/*
 * Voltage (V) by which electrode `input` gets a wanted effect, from the voltage `from`, at which
 * the electrode stands. Exact up to rounding; at most 2 plays + 4 pieces of a straight line are
 * walked.
 */
pzs_real pzs_hysteresis_voltage(const pzs_hysteresis *tables, uint32_t input,
                                hysteresis_memory memory, pzs_real from, pzs_real effect);

#endif
