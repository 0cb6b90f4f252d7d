/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stuck monitor of the supervisor, for loops with a vibration damper: detects that all readings
 * repeat although the voltages should have moved the structure.
 */
#ifndef PZS_LIB_STUCK_H
#define PZS_LIB_STUCK_H

#include "pzs_loop.h"

/*
 * Judge a tick. Returns whether the readings are stuck. Once they are, this stays so until a
 * reading changes.
 *   has_jumped in  the target has jumped, so that the supervisor has other work in this tick: only
 *                  look whether a reading has changed
 */
bool pzs_stuck_judge(pzs_stuck_state *stuck, const pzs_supervision *tables,
                     const pzs_loop_signals *signals, bool has_jumped);

#endif
