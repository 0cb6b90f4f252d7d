/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stuck monitor of the supervisor, for loops with a vibration damper: detects that all readings
 * repeat although the voltages should have moved the structure.
 */
#ifndef PZS_LIB_STUCK_H
#define PZS_LIB_STUCK_H

#include "pzs_loop.h"

/*
 * Check in one tick whether all readings are stuck, and return the result. After true it remains
 * true until a reading changes.
 *   has_jumped in  whether the target has jumped: the shapes are then not compared, because the
 *                  supervisor needs the time of this tick for the jump
 */
bool pzs_stuck_judge(pzs_stuck_state *stuck, const pzs_supervision *tables,
                     const pzs_loop_signals *signals, bool has_jumped);

#endif
