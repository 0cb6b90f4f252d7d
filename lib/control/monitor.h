/* SPDX-License-Identifier: BSD-2-Clause */
/* Divergence monitor: whether the measured shape still follows the model (monitor.c). */
#ifndef PZS_LIB_MONITOR_H
#define PZS_LIB_MONITOR_H

#include "pzs_loop.h"

/* Start to observe a loop of `outputs` outputs, with memory [5][outputs]. */
void pzs_monitor_init(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs);

/* Let the monitor point to its arrays again. */
void pzs_monitor_place(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs);

/* Deviation above which a tick counts as implausible (m). */
pzs_real pzs_monitor_threshold(const pzs_monitor_state *monitor, const pzs_supervision *tables);

/* Observe one tick. Returns whether it is implausible. */
bool pzs_monitor_tick(pzs_monitor_state *monitor, const pzs_supervision *tables,
                      const pzs_loop_signals *signals);

#endif
