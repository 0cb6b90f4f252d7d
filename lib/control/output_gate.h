/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The last gate before the amplifiers: every voltage of a loop leaves through pzs_output_gate. The
 * gate trusts neither the controller nor its memory. It compares with the limits in flash and with
 * the voltages given last, of which it keeps three copies.
 */
#ifndef PZS_LIB_OUTPUT_GATE_H
#define PZS_LIB_OUTPUT_GATE_H

#include "pzs_control.h"

typedef struct output_gate {
    const pzs_problem *problem;
    pzs_real *const *held;    /* [3][inputs] voltage at which an input is held (V), NaN: not held */
    pzs_real *last[3];        /* [inputs] three copies of the voltages given last (V) */
    volatile pzs_real *frame; /* [inputs] the frame to fill, which nobody reads yet (V) */
} output_gate;

/* Checksum of the limits of a problem, for pzs_output_gate. */
uint32_t pzs_output_limit_sum(const pzs_problem *problem);

/*
 * Cut voltages to what may be given out and fill the frame with them.
 *   voltage [inputs] in/out  (V)
 *   limit_sum        in      checksum of the limits when the tables were last known to be intact
 *   where            out     first corrected input, or -1
 * A voltage is cut to the step limit around the voltage given last, and to the voltage limits,
 * which take precedence. The voltage of pzs_hold is exempt from the step limit: a held input may go
 * there at once. A voltage that is not finite becomes the last one. Warning: OUTPUT (a voltage was
 * corrected). Error: CRC (limits damaged: the voltages given last do not change and the frame must
 * not be used).
 */
pzs_status pzs_output_gate(const output_gate *gate, pzs_real *voltage, uint32_t limit_sum,
                           int32_t *where);

#endif
