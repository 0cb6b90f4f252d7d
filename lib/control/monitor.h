/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Divergence monitor of the supervisor: detects a measured shape that no longer follows the model.
 */
#ifndef PZS_LIB_MONITOR_H
#define PZS_LIB_MONITOR_H

#include "pzs_loop.h"

/*
 * Initialise the divergence monitor of a loop.
 *   memory [5][outputs] out  memory for the arrays of the monitor
 */
void pzs_monitor_init(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs);

/*
 * Set the pointers of the divergence monitor to its arrays again, because damaged memory may have
 * changed them.
 *   memory [5][outputs] in  memory for the arrays, as passed to pzs_monitor_init
 */
void pzs_monitor_place(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs);

/*
 * Return the threshold of the divergence monitor (m). A tick counts as implausible if the amplitude
 * by which the structure deviates from the model exceeds it.
 */
pzs_real pzs_monitor_threshold(const pzs_monitor_state *monitor, const pzs_supervision *tables);

/*
 * Whether the measured shape has been opposite to its prediction for so long that the polarity has
 * to be tested (polarity_test.h).
 *   over in  number of implausible ticks
 */
bool pzs_monitor_asks_for_test(const pzs_monitor_state *monitor, const pzs_supervision *tables,
                               uint32_t over);

/* Begin a polarity test along the predicted shape of this tick. */
void pzs_monitor_begin_test(pzs_monitor_state *monitor, const pzs_loop_signals *signals);

/*
 * Add the measurements of this tick to the average of a pause of the polarity test. Returns whether
 * the pause ends with this tick.
 *   tick in  number of the tick in the pause, from 0
 */
bool pzs_monitor_average(pzs_monitor_state *monitor, const pzs_supervision *tables,
                         const pzs_loop_signals *signals, uint32_t tick);

/*
 * Compare the measured shape in one tick with the shape that the model predicts. Returns the new
 * number of implausible ticks: one more if the difference is implausible, otherwise two less. An
 * alarm is due when this number exceeds alarm_ticks of the tables.
 *   over in  number of implausible ticks before
 */
uint32_t pzs_monitor_tick(pzs_monitor_state *monitor, const pzs_supervision *tables,
                          const pzs_loop_signals *signals, uint32_t over);

#endif
