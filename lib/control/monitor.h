/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Divergence monitor of the supervisor: detects a measured shape that no longer follows the model.
 */
#ifndef PZS_LIB_MONITOR_H
#define PZS_LIB_MONITOR_H

#include "pzs_loop.h"

/* Initialise the monitor of a loop of `outputs` outputs, with memory [5][outputs]. */
void pzs_monitor_init(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs);

/* Let the arrays of the monitor point into its memory again. */
void pzs_monitor_place(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs);

/* Return the deviation above which a tick counts as implausible (m). */
pzs_real pzs_monitor_threshold(const pzs_monitor_state *monitor, const pzs_supervision *tables);

/* Observe one tick. Returns whether it is implausible. */
bool pzs_monitor_tick(pzs_monitor_state *monitor, const pzs_supervision *tables,
                      const pzs_loop_signals *signals);

#endif
