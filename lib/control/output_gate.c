/* SPDX-License-Identifier: BSD-2-Clause */
/* The last gate before the amplifiers (output_gate.h). */
#include "output_gate.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "step_bounds.h"

uint32_t pzs_output_limit_sum(const pzs_problem *problem)
{
    uint32_t sum = pzs_guard_sum(0, problem->lower, problem->inputs);
    sum = pzs_guard_sum(sum, problem->upper, problem->inputs);
    return pzs_guard_sum(sum, problem->step_limit, problem->inputs);
}

/* The voltage of input i that may be given out (V). */
static pzs_real allowed(const output_gate *gate, uint32_t i, pzs_real voltage)
{
    const pzs_problem *problem = gate->problem;
    const pzs_real last = gate->last[0][i], held = gate->held[0][i];
    const pzs_real lower = problem->lower[i], upper = problem->upper[i];
    if (voltage >= held && voltage <= held)
        return number_clamp(held, lower, upper);
    const pzs_real down = step_down(last, problem->step_limit[i]);
    const pzs_real up = step_up(last, problem->step_limit[i]);
    const pzs_real least = down > lower ? down : lower, most = up < upper ? up : upper;
    if (least > most)
        return last < lower ? lower : upper;
    return number_clamp(number_is_finite(voltage) ? voltage : last, least, most);
}

pzs_status pzs_output_gate(const output_gate *gate, pzs_real *voltage, uint32_t limit_sum,
                           int32_t *where)
{
    const uint32_t n = gate->problem->inputs;
    *where = -1;
    if (pzs_output_limit_sum(gate->problem) != limit_sum)
        return PZS_E_CRC;
    pzs_guard_vote(gate->last[0], gate->last[1], gate->last[2], n * sizeof *voltage);
    pzs_guard_vote(gate->held[0], gate->held[1], gate->held[2], n * sizeof *voltage);
    for (uint32_t i = 0; i < n; i++) {
        const pzs_real given = allowed(gate, i, voltage[i]);
        if (*where < 0 && !(voltage[i] >= given && voltage[i] <= given))
            *where = (int32_t)i;
        voltage[i] = given;
        gate->frame[i] = given;
        for (int copy = 0; copy < 3; copy++)
            gate->last[copy][i] = given;
    }
    return *where < 0 ? PZS_OK : PZS_W_OUTPUT;
}
