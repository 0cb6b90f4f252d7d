/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Hysteresis and creep of one electrode: the effect of a voltage, the voltage of an effect, and the
 * memory by which earlier voltages still act. The effect is the voltage that would move the
 * structure as far without hysteresis and creep.
 */
#ifndef PZS_LIB_HYSTERESIS_H
#define PZS_LIB_HYSTERESIS_H

#include "pzs_loop.h"

/*
 * Memory of one electrode with hysteresis and creep, through which its effect (voltage that would
 * move the structure as far without hysteresis) depends on earlier voltages.
 */
typedef struct hysteresis_memory {
    pzs_real *play; /* [plays] position of each play (element with backlash), relative to the middle
                       of the voltage range (V) */
    pzs_real *creep; /* [creeps] present value of each creep term in the effect of the electrode
                        (voltage that would move the structure as far without hysteresis) (V) */
} hysteresis_memory;

/*
 * Set the memory of the hysteresis model of electrode `input` to the state that it reaches when a
 * voltage has been applied for a long time.
 */
void pzs_hysteresis_rest(const pzs_hysteresis *tables, uint32_t input, hysteresis_memory memory,
                         pzs_real voltage);

/*
 * Update the memory of the hysteresis model of an electrode after a voltage has been applied. A
 * damaged memory becomes the nearest possible state.
 *   ticks in  number of ticks with this voltage, at least 1
 * Returns the effect in the first of these ticks (V): the voltage that would move the structure as
 * far without hysteresis and creep.
 */
pzs_real pzs_hysteresis_remember(const pzs_hysteresis *tables, uint32_t input,
                                 hysteresis_memory memory, pzs_real voltage, uint32_t ticks);

/*
 * Return the effect of electrode `input`, the voltage that would move the structure as far without
 * hysteresis, when its voltage changes to `voltage` (V). The effect never falls while the voltage
 * rises.
 */
pzs_real pzs_hysteresis_effect(const pzs_hysteresis *tables, uint32_t input,
                               hysteresis_memory memory, pzs_real voltage);

/*
 * Return the effect of electrode `input`, the voltage that would move the structure as far without
 * hysteresis, at a voltage that the loop gives in this tick, by the model of the electrode as it
 * was measured (V). The compensation may use a model with less hysteresis.
 */
pzs_real pzs_hysteresis_identified(const pzs_compensator *compensator, uint32_t input,
                                   pzs_real voltage);

/*
 * Return the voltage (V) at which electrode `input` has a wanted effect (voltage that would move
 * the structure as far without hysteresis), exact up to rounding. The search visits at most 2 n + 4
 * linear pieces, with n plays (elements with backlash).
 *   from   in  present voltage of the electrode (V)
 *   effect in  wanted effect (V)
 */
pzs_real pzs_hysteresis_voltage(const pzs_hysteresis *tables, uint32_t input,
                                hysteresis_memory memory, pzs_real from, pzs_real effect);

#endif
