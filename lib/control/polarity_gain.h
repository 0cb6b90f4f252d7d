/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gain monitor of the supervisor, for loops with a vibration damper: estimates from the motion of
 * the vibration modes how strongly, and with which sign, the structure follows the voltages.
 */
#ifndef PZS_LIB_POLARITY_GAIN_H
#define PZS_LIB_POLARITY_GAIN_H

#include "pzs_loop.h"

/* Start the estimate in a tick with usable readings. */
void pzs_polarity_gain_begin(pzs_gain_state *gain, const pzs_loop_signals *signals);

/*
 * Update the estimate in a tick with usable readings. Returns whether the gain has been that of
 * amplifiers of the wrong polarity for so long that it is an alarm.
 *   is_shaken in  whether the amplitude of vibration is larger than targets and loads explain; the
 *                 gain is then not judged
 */
bool pzs_polarity_gain_is_reversed(pzs_gain_state *gain, const pzs_supervision *tables,
                                   const pzs_loop_signals *signals, bool is_shaken);

#endif
