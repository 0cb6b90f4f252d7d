/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Hysteresis and creep of one electrode (pzs_hysteresis): effect of a voltage, voltage of an
 * effect, and memory of the electrode.
 */
#ifndef PZS_LIB_HYSTERESIS_H
#define PZS_LIB_HYSTERESIS_H

#include "pzs_loop.h"

/*
 * Return the checksum of the counts and arrays of hysteresis tables, as stored in their member crc.
 */
uint32_t pzs_hysteresis_crc(const pzs_hysteresis *tables);

/* Memory of one electrode, by which its effect depends on earlier voltages. */
typedef struct hysteresis_memory {
    pzs_real *play; /* [plays] position of each play (element with backlash), relative to the middle
                       of the voltage range (V) */
    pzs_real *creep; /* [creeps] present value of each creep term in the effect (V) */
} hysteresis_memory;

/*
 * Set the memory of electrode `input` to the state after a voltage has been applied for a long
 * time.
 */
void pzs_hysteresis_rest(const pzs_hysteresis *tables, uint32_t input, hysteresis_memory memory,
                         pzs_real voltage);

/*
 * Update the memory of electrode `input` after a voltage has been applied for some ticks, at least
 * one. A memory that cannot result from any voltages (damage, NaN) becomes the nearest possible
 * one. Return the effect in the first of these ticks (V).
 */
pzs_real pzs_hysteresis_remember(const pzs_hysteresis *tables, uint32_t input,
                                 hysteresis_memory memory, pzs_real voltage, uint32_t ticks);

/*
 * Return the effect (V) of electrode `input` when its voltage changes to `voltage`. The effect
 * never falls while the voltage rises.
 */
pzs_real pzs_hysteresis_effect(const pzs_hysteresis *tables, uint32_t input,
                               hysteresis_memory memory, pzs_real voltage);

/*
 * Return the voltage (V) at which electrode `input` has a wanted effect, starting from its present
 * voltage `from`. The result is exact up to rounding; the search visits at most 2 plays + 4
 * straight pieces of the characteristic.
 */
pzs_real pzs_hysteresis_voltage(const pzs_hysteresis *tables, uint32_t input,
                                hysteresis_memory memory, pzs_real from, pzs_real effect);

#endif
