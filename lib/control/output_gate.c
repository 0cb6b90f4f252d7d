/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The last check before the amplifiers: all voltages are compared with limits in flash and
 * corrected where necessary.
 */
#include <string.h>
#include "output_gate.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "limit_rows.h"
#include "step_bounds.h"

/* Continue a checksum with the voltage limits and the step limit of input i. */
static inline uint32_t add_limits(uint32_t sum, const pzs_problem *problem, uint32_t i)
{
    sum = guard_add(sum, problem->lower[i]);
    sum = guard_add(sum, problem->upper[i]);
    return guard_add(sum, problem->step_limit[i]);
}

uint32_t pzs_output_limit_sum(const pzs_problem *problem)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < problem->inputs; i++)
        sum = add_limits(sum, problem, i);
    if (problem->limit_rows != NULL)
        sum = problem->limit_rows->call->add_row_limits(sum, problem);
    return sum;
}

/* Whether a voltage is finite, inside the voltage limits of input i and inside its step limit. */
static inline bool is_allowed(const pzs_problem *problem, uint32_t i, pzs_real voltage,
                              pzs_real last)
{
    return voltage >= problem->lower[i] && voltage <= problem->upper[i] &&
           number_absolute(voltage - last) <= problem->step_limit[i];
}

/*
 * Return the voltage that replaces a voltage of input i that is not finite or is outside its
 * voltage limits or step limit (V).
 */
static pzs_real corrected(const output_gate *gate, uint32_t i, pzs_real voltage, pzs_real last)
{
    const pzs_problem *problem = gate->problem;
    const pzs_real lower = problem->lower[i], upper = problem->upper[i];
    const pzs_real down = step_down(last, problem->step_limit[i]);
    const pzs_real up = step_up(last, problem->step_limit[i]);
    const pzs_real least = down > lower ? down : lower;
    const pzs_real most = up < upper ? up : upper;
    pzs_guard_vote(&gate->held[0][i], &gate->held[1][i], &gate->held[2][i], sizeof voltage);
    const pzs_real held = gate->held[0][i];
    if (voltage >= held && voltage <= held)
        return number_clamp(held, lower, upper);
    if (least > most)
        return last < lower ? lower : upper;
    return number_clamp(number_is_finite(voltage) ? voltage : last, least, most);
}

/*
 * Where voltages violate a limit row (limit of a weighted sum of voltages), scale them back towards
 * the voltages of the last tick, and fill gate->frame, the array of checked voltages, again.
 *   sum in  checksum of the voltage limits and step limits of all inputs
 * Returns this checksum, continued over the limit rows.
 */
static uint32_t keep_rows(const output_gate *gate, pzs_real *voltage, uint32_t sum, int32_t *where)
{
    const pzs_problem *problem = gate->problem;
    const struct pzs_limit_row_calls *call = problem->limit_rows->call;
    const int32_t first = call->scale_back(problem, gate->last[0], voltage);
    *where = *where < 0 ? first : *where;
    for (uint32_t i = 0; i < problem->inputs; i++)
        gate->frame[i] = voltage[i];
    return call->add_row_limits(sum, problem);
}

pzs_status pzs_output_gate(const output_gate *gate, pzs_real *voltage, uint32_t limit_sum,
                           int32_t *where)
{
    const pzs_problem *problem = gate->problem;
    const uint32_t inputs = problem->inputs;
    uint32_t sum = 0;
    *where = -1;
    pzs_guard_vote(gate->last[0], gate->last[1], gate->last[2], inputs * sizeof *voltage);
    for (uint32_t i = 0; i < inputs; i++) {
        const pzs_real last = gate->last[0][i];
        pzs_real given = voltage[i];
        sum = add_limits(sum, problem, i);
        if (!is_allowed(problem, i, given, last))
            given = corrected(gate, i, given, last);
        if (*where < 0 && !(voltage[i] >= given && voltage[i] <= given))
            *where = (int32_t)i;
        voltage[i] = given;
        gate->frame[i] = given;
    }
    if (problem->limit_rows != NULL)
        sum = keep_rows(gate, voltage, sum, where);
    if (sum != limit_sum)
        return PZS_E_CRC;
    for (int copy = 0; copy < 3; copy++)
        memcpy(gate->last[copy], voltage, inputs * sizeof *voltage);
    return *where < 0 ? PZS_OK : PZS_W_OUTPUT;
}
