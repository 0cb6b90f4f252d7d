/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check and checksum of the tables of limit rows (limits of weighted sums of voltages), and
 * corrections of voltages that violate such a limit. A correction moves the voltages along a
 * straight line: limit rows are convex, so no point of the line violates a row more than both ends
 * do.
 */
#include "limit_rows.h"
#include "scrub.h"
#include "boxls.h"
#include "step_bounds.h"
#include "../core/guard.h"
#include "../core/numbers.h"

/*
 * Distance by which the optimiser narrows a limit row (limit of a weighted sum of voltages), as a
 * multiple of the rounding error of the sum. The distance also covers the rounding errors of rows
 * that are linear combinations of other rows.
 */
#define MARGIN 16

pzs_real pzs_limit_rows_sum(const pzs_limit_rows *rows, uint32_t k, const pzs_real *voltage)
{
    const pzs_rows *sums = &rows->sums;
    const bool is_absolute = limit_row_is_absolute(rows, k);
    pzs_real sum = 0;
    for (uint32_t entry = sums->start[k]; entry < sums->start[k + 1u]; entry++) {
        const pzs_real one = voltage[sums->dof[entry]];
        sum += sums->value[entry] * (is_absolute ? number_absolute(one) : one);
    }
    return sum;
}

pzs_real pzs_limit_rows_margin(const pzs_problem *problem, uint32_t k)
{
    const pzs_rows *sums = &problem->limit_rows->sums;
    pzs_real most = 0;
    for (uint32_t entry = sums->start[k]; entry < sums->start[k + 1u]; entry++) {
        const uint16_t input = sums->dof[entry];
        const pzs_real lower = number_absolute(problem->lower[input]);
        const pzs_real upper = number_absolute(problem->upper[input]);
        most += number_absolute(sums->value[entry]) * (lower > upper ? lower : upper);
    }
    return MARGIN * (pzs_real)(sums->start[k + 1u] - sums->start[k]) * PZS_EPSILON * most;
}

/*
 * Return by how much voltages violate limit row k (limit of a sum of voltages), or 0 if they do not
 * (V).
 */
static pzs_real excess(const pzs_limit_rows *rows, uint32_t k, const pzs_real *voltage)
{
    const pzs_real sum = pzs_limit_rows_sum(rows, k, voltage);
    const pzs_real below = rows->lower[k] - sum, above = sum - rows->upper[k];
    const pzs_real most = below > above ? below : above;
    return most > 0 ? most : 0;
}

/* Whether voltages [inputs] violate no limit row (limit of a sum of voltages). */
static bool satisfy(const pzs_limit_rows *rows, const pzs_real *voltage)
{
    uint32_t k = 0;
    while (k < rows->sums.count && excess(rows, k, voltage) <= 0)
        k++;
    return k == rows->sums.count;
}

/* ---- check of the limit rows -------------------------------------------- */

/*
 * Whether the coefficients of limit row k (limit of a sum of voltages) are finite numbers, and
 * refer to inputs with finite voltage limits, each at most once.
 */
static bool is_row_usable(const pzs_problem *problem, uint32_t k)
{
    const pzs_rows *sums = &problem->limit_rows->sums;
    if (sums->start[k + 1u] < sums->start[k])
        return false;
    for (uint32_t entry = sums->start[k]; entry < sums->start[k + 1u]; entry++) {
        const uint16_t input = sums->dof[entry];
        if (input >= problem->inputs || !number_is_finite(sums->value[entry]) ||
            !number_is_finite(problem->lower[input]) || !number_is_finite(problem->upper[input]))
            return false;
        for (uint32_t other = sums->start[k]; other < entry; other++)
            if (sums->dof[other] == input)
                return false;
    }
    return true;
}

/*
 * Whether limit row k, the limit of a weighted sum of absolute values of voltages, has no negative
 * coefficient, no lower limit, and an upper limit above the rounding errors of the sum.
 */
static bool is_absolute_usable(const pzs_problem *problem, uint32_t k)
{
    const pzs_limit_rows *rows = problem->limit_rows;
    const pzs_rows *sums = &rows->sums;
    for (uint32_t entry = sums->start[k]; entry < sums->start[k + 1u]; entry++)
        if (!(sums->value[entry] >= 0))
            return false;
    return !number_is_finite(rows->lower[k]) &&
           rows->upper[k] > 2 * pzs_limit_rows_margin(problem, k);
}

/*
 * Whether the safe voltages, to which the controller can always return, are inside the limits of
 * all voltages and of all their sums.
 */
static bool is_safe(const pzs_problem *problem)
{
    const pzs_limit_rows *rows = problem->limit_rows;
    uint32_t i = 0;
    while (i < problem->inputs && rows->safe[i] >= problem->lower[i] &&
           rows->safe[i] <= problem->upper[i] && number_is_finite(rows->safe[i]))
        i++;
    return i == problem->inputs && satisfy(rows, rows->safe);
}

static pzs_status check_rows(const pzs_problem *problem, int32_t *where)
{
    const pzs_limit_rows *rows = problem->limit_rows;
    const pzs_rows *sums = &rows->sums;
    if (sums->count == 0 || sums->count > PZS_LIMIT_ROW_LIMIT || sums->start == NULL ||
        sums->dof == NULL || sums->value == NULL || rows->lower == NULL || rows->upper == NULL ||
        rows->safe == NULL || sums->start[0] != 0 || !pzs_guard_rows_fit(sums, problem->inputs) ||
        rows->absolute_count > sums->count ||
        (rows->absolute_count > 0 && rows->absolute_call == NULL))
        return PZS_E_ARGUMENT;
    for (uint32_t k = 0; k < sums->count; k++) {
        *where = (int32_t)(problem->inputs + k);
        if (!is_row_usable(problem, k))
            return PZS_E_LIMITS;
        const pzs_real narrowed = 2 * pzs_limit_rows_margin(problem, k);
        if (!(rows->upper[k] - rows->lower[k] >= narrowed))
            return PZS_E_LIMITS;
        if (limit_row_is_absolute(rows, k) && !is_absolute_usable(problem, k))
            return PZS_E_LIMITS;
    }
    *where = -1;
    return is_safe(problem) ? PZS_OK : PZS_E_LIMITS;
}

static void list_parts(const pzs_problem *problem, pzs_table_part part[LIMIT_ROW_PARTS])
{
    const pzs_limit_rows *rows = problem->limit_rows;
    if (rows->sums.start == NULL || !pzs_guard_rows_fit(&rows->sums, problem->inputs))
        return;
    const size_t count = rows->sums.count, entries = rows->sums.start[count];
    const size_t dof_bytes = rows->sums.dof != NULL ? entries * sizeof *rows->sums.dof : 0;
    part[0] = (pzs_table_part){&rows->sums.count, sizeof rows->sums.count};
    part[1] = (pzs_table_part){rows->sums.start, (count + 1u) * sizeof *rows->sums.start};
    part[2] = (pzs_table_part){rows->sums.dof, dof_bytes};
    part[3] = scrub_reals(rows->sums.value, entries);
    part[4] = scrub_reals(rows->lower, count);
    part[5] = scrub_reals(rows->upper, count);
    part[6] = scrub_reals(rows->safe, problem->inputs);
    part[7] = (pzs_table_part){&rows->absolute_count, sizeof rows->absolute_count};
}

static uint32_t add_row_limits(uint32_t sum, const pzs_problem *problem)
{
    const pzs_limit_rows *rows = problem->limit_rows;
    const uint32_t count = rows->sums.count;
    sum = guard_add(sum, (pzs_real)rows->absolute_count);
    for (uint32_t k = 0; k < count; k++)
        sum = guard_add(guard_add(sum, rows->lower[k]), rows->upper[k]);
    for (uint32_t entry = 0; entry < rows->sums.start[count]; entry++)
        sum = guard_add(sum, rows->sums.value[entry]);
    return sum;
}

/*
 * Return how many multiply-adds more the optimiser must be allowed at least in a tick if sums of
 * absolute values of voltages are limited.
 */
static uint64_t absolute_work(const pzs_problem *problem)
{
    return PZS_ABSOLUTE_ROW_WORK(problem->inputs, limit_row_count(problem),
                                 problem->limit_rows->absolute_count);
}

static uint64_t least_work(const pzs_problem *problem)
{
    return PZS_LIMIT_ROW_WORK_LEAST(problem->inputs, limit_row_count(problem)) +
           absolute_work(problem);
}

static uint64_t usual_work(const pzs_problem *problem)
{
    return PZS_LIMIT_ROW_WORK_LIMIT(problem->inputs, limit_row_count(problem)) +
           2u * absolute_work(problem);
}

/* ---- return of voltages to the limits ----------------------------------- */

/*
 * Return the first input that has a coefficient in limit row k (limit of a sum of voltages), or -1
 * if the row has no coefficients.
 */
static int32_t first_input(const pzs_limit_rows *rows, uint32_t k)
{
    const uint32_t entry = rows->sums.start[k];
    return entry < rows->sums.start[k + 1u] ? (int32_t)rows->sums.dof[entry] : -1;
}

/*
 * Return the first limit row (limit of a sum of voltages) that `voltage` violates more than the
 * voltages `inside` do, or the number of rows if there is none. A sum that is not a number counts
 * as a violation.
 */
static uint32_t first_violated(const pzs_limit_rows *rows, const pzs_real *inside,
                               const pzs_real *voltage)
{
    uint32_t k = 0;
    while (k < rows->sums.count && excess(rows, k, voltage) <= excess(rows, k, inside) &&
           number_is_finite(pzs_limit_rows_sum(rows, k, voltage)))
        k++;
    return k;
}

/*
 * Return where the straight line from the voltages `inside` to `voltage` leaves the limits of row k
 * (limit of a sum of voltages), as a fraction of the line (0 to 1). The limits are narrowed by the
 * margin for rounding errors.
 */
static pzs_real part_inside(const pzs_problem *problem, uint32_t k, const pzs_real *inside,
                            const pzs_real *voltage)
{
    const pzs_limit_rows *rows = problem->limit_rows;
    const pzs_real margin = pzs_limit_rows_margin(problem, k) / 2;
    const pzs_real from = pzs_limit_rows_sum(rows, k, inside);
    const pzs_real to = pzs_limit_rows_sum(rows, k, voltage);
    const pzs_real bound = to > from ? rows->upper[k] - margin : rows->lower[k] + margin;
    return number_clamp((bound - from) / (to - from), 0, 1);
}

int32_t pzs_scale_back_rows(const pzs_problem *problem, const pzs_real *inside, pzs_real *voltage)
{
    const pzs_limit_rows *rows = problem->limit_rows;
    const uint32_t count = rows->sums.count, first = first_violated(rows, inside, voltage);
    if (first == count)
        return -1;
    pzs_real part = 1;
    for (uint32_t k = first; k < count; k++) {
        const pzs_real own = excess(rows, k, voltage) <= excess(rows, k, inside)
                                 ? part
                                 : part_inside(problem, k, inside, voltage);
        part = own < part ? own : part;
    }
    for (uint32_t i = 0; i < problem->inputs; i++) {
        const pzs_real low = inside[i] < voltage[i] ? inside[i] : voltage[i];
        const pzs_real high = inside[i] < voltage[i] ? voltage[i] : inside[i];
        voltage[i] = number_clamp(inside[i] + part * (voltage[i] - inside[i]), low, high);
    }
    const bool fails = first_violated(rows, inside, voltage) < count;
    for (uint32_t i = 0; fails && i < problem->inputs; i++)
        voltage[i] = inside[i];
    return first_input(rows, first);
}

static void take_back(const pzs_problem *problem, const pzs_real *before, pzs_real *voltage)
{
    const pzs_limit_rows *rows = problem->limit_rows;
    const pzs_rows *sums = &rows->sums;
    uint32_t violated = first_violated(rows, before, voltage);
    for (uint32_t tries = 0; tries < problem->inputs && violated < sums->count; tries++) {
        for (uint32_t entry = sums->start[violated]; entry < sums->start[violated + 1u]; entry++)
            voltage[sums->dof[entry]] = before[sums->dof[entry]];
        violated = first_violated(rows, before, voltage);
    }
}

/*
 * Return the first input whose voltage is outside the voltage limits that the controller applies in
 * this tick, or the number of inputs if there is none.
 */
static uint32_t first_outside(const pzs_control *control)
{
    const pzs_real *voltage = control->state.voltage;
    uint32_t i = 0;
    while (i < control->state.problem->inputs && voltage[i] >= control->state.lower[i] &&
           voltage[i] <= control->state.upper[i])
        i++;
    return i;
}

/*
 * Move the present voltages of all inputs along the straight line to the voltages `goal` [inputs],
 * as far as the step limits allow. Returns whether the voltages have arrived at `goal`.
 */
static bool move_towards(pzs_control *control, const pzs_real *goal)
{
    pzs_real *voltage = control->state.voltage, part = 1;
    const uint32_t inputs = control->state.problem->inputs;
    for (uint32_t i = 0; i < inputs; i++) {
        const pzs_real way = number_absolute(goal[i] - voltage[i]);
        if (part * way > control->state.step_limit[i])
            part = control->state.step_limit[i] / way;
    }
    for (uint32_t i = 0; i < inputs; i++) {
        const pzs_real down = step_down(voltage[i], control->state.step_limit[i]);
        const pzs_real up = step_up(voltage[i], control->state.step_limit[i]);
        const pzs_real next = part < 1 ? voltage[i] + part * (goal[i] - voltage[i]) : goal[i];
        voltage[i] = number_clamp(next, down, up);
    }
    return part >= 1;
}

static bool bring_inside(pzs_control *control, int32_t *where)
{
    const pzs_problem *problem = control->state.problem;
    const pzs_limit_rows *rows = problem->limit_rows;
    const uint32_t outside = first_outside(control);
    pzs_real *goal = control->state.optimiser.scratch;
    if (outside == problem->inputs && satisfy(rows, control->state.voltage))
        return true;
    *where = outside < problem->inputs ? (int32_t)outside : -1;
    for (uint32_t i = 0; i < problem->inputs; i++)
        goal[i] = number_clamp(rows->safe[i], control->state.lower[i], control->state.upper[i]);
    if (!satisfy(rows, goal))
        return false;
    const bool has_arrived = move_towards(control, goal);
    pzs_boxls_true_gradient(&control->state.optimiser);
    return has_arrived;
}

const struct pzs_limit_row_calls pzs_limit_rows_calls = {
    list_parts,      check_rows,        satisfy,      pzs_arrange_rows,   pzs_prepare_rows,
    pzs_repair_rows, pzs_optimise_rows, bring_inside, pzs_violation_rows, pzs_scale_back_rows,
    take_back,       add_row_limits,    least_work,   usual_work};
