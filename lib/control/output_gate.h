/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The last check before the amplifiers, which no voltage of a loop can avoid. The check
 * relies neither on the controller nor on its memory: it compares each voltage with the limits in
 * flash and with the voltage of the last tick, which is stored in three copies.
 */
#ifndef PZS_LIB_OUTPUT_GATE_H
#define PZS_LIB_OUTPUT_GATE_H

#include "pzs_control.h"

typedef struct output_gate {
    const pzs_problem *problem;
    pzs_real *const *held;    /* [3][inputs] three copies of the voltage at which pzs_hold keeps an
                                 input (V); NaN: it keeps none */
    pzs_real *last[3];        /* [inputs] three copies of the voltages of the last tick (V) */
    volatile pzs_real *frame; /* [inputs] array to fill with the checked voltages of this tick (V).
                                 Until the tick ends, the program reads the voltages of the last
                                 tick from another array */
} output_gate;

/* Return the checksum of the voltage limits and step limits in the tables of the controller. */
uint32_t pzs_output_limit_sum(const pzs_problem *problem);

/*
 * Correct voltages that may not be applied to the amplifiers, and fill gate->frame with all
 * voltages. A voltage is clamped to the step limit (unless pzs_hold fixes it), then to the voltage
 * limits. One that is not finite becomes the last voltage.
 *   voltage [inputs] in/out  voltages of the controller (V)
 *   limit_sum        in      checksum of the limits while the tables were last known to be intact
 *   where            out     first corrected input, or -1
 * Returns PZS_OK, or
 *   PZS_W_OUTPUT  a voltage was corrected
 *   PZS_E_CRC     limits are damaged: the last voltages are unchanged, gate->frame must not be used
 */
pzs_status pzs_output_gate(const output_gate *gate, pzs_real *voltage, uint32_t limit_sum,
                           int32_t *where);

#endif
