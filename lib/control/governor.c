/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reference governor: slows a moving target shape down, so that the controller can follow it
 * without lag. A control tick that also damps vibration makes only the part `share` (0 to 1) of the
 * change of the voltages that its target demands.
 *
 * When the target changes, the governor computes the voltages v_t that are optimal for it within
 * the limits, without disturbances. Each tick moves the reference voltages v_ref by dr towards v_t,
 * at most by a fixed part of the step limits, and replaces the target shape z by
 *   z - B (v_t - v_ref) + B dr / share
 *   B  influence matrix
 *
 * The tick then adds the whole dr to the voltages. Once v_ref = v_t, the target is passed on
 * unchanged.
 *
 * Work of a tick: none at a constant target with v_ref = v_t; otherwise outputs * inputs
 * multiply-adds, and an optimisation of the voltages when the target has changed.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "../core/guard.h"
#include "../core/numbers.h"

/* ---- memory of the governor ------------------------------------------ */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    const size_t rows =
        pzs_control_bytes(problem) - PZS_CONTROL_BYTES(problem->inputs, problem->outputs);
    return PZS_GOVERNOR_BLOCK_BYTES(problem->inputs, problem->outputs) + PZS_ALIGNED(rows);
}

static void *work_of(pzs_governor_state *state)
{
    return (uint8_t *)state + PZS_ALIGNED(sizeof *state);
}

/*
 * Set the pointers of the governor (which slows targets down) to its tables, to the controller of
 * the loop and to its arrays.
 */
static void place(pzs_governor_state *state, const pzs_governor *tables, pzs_control *control)
{
    const pzs_problem *problem = control->state.problem;
    const size_t width = PZS_FOURS(problem->inputs);
    state->tables = tables;
    state->control = control;
    state->reference =
        (void *)((uint8_t *)work_of(state) + PZS_ALIGNED(pzs_control_bytes(problem)));
    state->optimal = state->reference + 3 * width;
    state->ahead = state->optimal + 3 * width;
    state->target = state->ahead + width;
    state->wanted = state->target + problem->outputs;
}

/*
 * Make the second and third copy of a voltage vector [3][width], which protect it against damaged
 * memory, equal to the first one. The width is the number of inputs rounded up to a multiple of 4.
 */
static void copy_voltages(pzs_real *copies, size_t width)
{
    memcpy(copies + width, copies, width * sizeof *copies);
    memcpy(copies + 2 * width, copies, width * sizeof *copies);
}

/* Replace the three copies [3][width] of a voltage vector by their majority. */
static void vote(pzs_real *copies, size_t width)
{
    pzs_guard_vote(copies, copies + width, copies + 2 * width, width * sizeof *copies);
}

/*
 * Return the influence matrix with which the governor must initialise its own controller, so that
 * this and the controller of the loop use the same matrix: the one passed to pzs_loop_init. NULL:
 * the loop uses the matrix of its tables.
 */
static const pzs_real *influence_of(const pzs_control *control)
{
    const pzs_real *influence = control->state.influence;
    return influence == control->state.problem->influence ? NULL : influence;
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_governor *governor = tables;
    pzs_governor_state *state = self;
    const pzs_problem *problem = signals->control->state.problem;
    if (!(governor->share > 0) || !(governor->share <= 1) || !(governor->part > 0) ||
        !(governor->part <= 1))
        return PZS_E_ARGUMENT;
    /*
     * The governor is refused where actuators have curves: it limits how fast voltages change, but
     * the loop then optimises effects (values to which the displacements of the actuators are
     * proportional) instead of voltages.
     */
    if (signals->curves != NULL)
        return PZS_E_STAGE;
    memset(state, 0, sizeof *state);
    place(state, governor, signals->control);
    const size_t width = PZS_FOURS(problem->inputs);
    memset(state->reference, 0, 6 * width * sizeof *state->reference);
    memcpy(state->reference, signals->control->state.voltage,
           problem->inputs * sizeof *state->reference);
    copy_voltages(state->reference, width);
    memcpy(state->optimal, state->reference, 3 * width * sizeof *state->optimal);
    return pzs_control_init(&state->optimum, problem, influence_of(signals->control),
                            work_of(state), pzs_control_bytes(problem));
}

/* ---- tick of the governor -------------------------------------------- */

static bool are_equal(const pzs_real *left, const pzs_real *right, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && left[i] >= right[i] && left[i] <= right[i])
        i++;
    return i == count;
}

/*
 * Whether pzs_hold keeps the same inputs at the same voltages in two controllers.
 *   left, right [count] in  for each controller the voltages at which inputs are kept (V), NaN: not
 *                           kept
 */
static bool are_held_alike(const pzs_real *left, const pzs_real *right, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && (number_is_finite(left[i]) ? left[i] >= right[i] && left[i] <= right[i]
                                                   : !number_is_finite(right[i])))
        i++;
    return i == count;
}

/*
 * Whether the target shape and the inputs that pzs_hold keeps at a fixed voltage are the same as
 * when the governor last computed the optimal voltages. The inputs that a fault detector keeps
 * fixed during a test pulse do not count: otherwise the reference would follow the pulse, and the
 * fault detector would end each pulse because the target moves.
 */
static bool is_known(const pzs_governor_state *state, const pzs_real *wanted)
{
    const pzs_problem *problem = state->control->state.problem;
    const pzs_real *own = state->optimum.state.held[0], *loop = state->control->state.held[0];
    return state->has_target && are_equal(state->target, wanted, problem->outputs) &&
           (state->control->state.is_paused || are_held_alike(own, loop, problem->inputs));
}

/*
 * Return the exclusive or of the words of what the governor's controller keeps from target to
 * target: the base voltages and three gradients, which follow each other in its workspace.
 */
static uint32_t gradient_sum(const pzs_optimiser *optimiser)
{
    return pzs_guard_word_sum(optimiser->base, 4u * optimiser->width * sizeof *optimiser->base);
}

/*
 * Compute the optimal voltages for the target shape, without step limits and with the inputs fixed
 * that the control loop keeps fixed. The voltage limits are those of the tables: where hysteresis
 * is compensated, those in the loop's controller have been replaced by limits of the equivalent
 * voltages, which would cause the same strain without hysteresis.
 */
static void find_optimum(pzs_governor_state *state, const pzs_real *wanted)
{
    const pzs_problem *problem = state->control->state.problem;
    const size_t bytes = problem->inputs * sizeof(pzs_real);
    pzs_control *optimum = &state->optimum;
    for (int copy = 0; copy < 3; copy++)
        memcpy(optimum->state.held[copy], state->control->state.held[copy], bytes);
    pzs_control_restore_limits(optimum);
    optimum->state.has_step_limits = false;
    pzs_control_share_bounds(&optimum->state.optimiser, optimum);
    memcpy(state->target, wanted, problem->outputs * sizeof *wanted);
    if (gradient_sum(&optimum->state.optimiser) != state->gradient_sum)
        pzs_control_moved(optimum);
    state->has_target = !PZS_IS_ERROR(pzs_step(optimum, wanted));
    pzs_control_complete(optimum);
    state->gradient_sum = gradient_sum(&optimum->state.optimiser);
    memcpy(state->optimal, optimum->state.voltage, bytes);
    copy_voltages(state->optimal, PZS_FOURS(problem->inputs));
}

/*
 * Return the largest fraction of the way from the governor's slowed-down voltages (`reference`) to
 * the optimal voltages for which no input exceeds pzs_governor.part of its step limit.
 */
static pzs_real largest_part(const pzs_governor_state *state)
{
    pzs_real part = 1;
    for (uint32_t j = 0; j < state->control->state.problem->inputs; j++) {
        const pzs_real way = number_absolute(state->optimal[j] - state->reference[j]);
        const pzs_real most = state->tables->part * state->control->state.step_limit[j];
        part = part * way > most ? most / way : part;
    }
    return part;
}

/*
 * Move the governor's reference voltages by one tick towards the optimal voltages. Compute the
 * voltages `ahead` (V); the governor then subtracts the shape that they cause from the target:
 *   ahead = (optimal voltages - reference) - r / pzs_governor.share
 *   r  change of the reference voltages in this tick, divided by `share` because a control tick
 *      makes only this part of what the target demands
 * Returns whether the reference voltages still differed from the optimal ones at the start of the
 * tick.
 */
static bool move_reference(pzs_governor_state *state)
{
    const pzs_real part = largest_part(state);
    bool is_moving = false;
    for (uint32_t j = 0; j < state->control->state.problem->inputs; j++) {
        const pzs_real way = state->optimal[j] - state->reference[j];
        const pzs_real move = part * way;
        state->reference[j] = part < 1 ? state->reference[j] + move : state->optimal[j];
        state->ahead[j] = state->optimal[j] - state->reference[j] - move / state->tables->share;
        is_moving |= !(way >= 0 && way <= 0);
    }
    copy_voltages(state->reference, PZS_FOURS(state->control->state.problem->inputs));
    return is_moving;
}

/*
 * Repair what damaged memory may have changed in the governor. As in the controller of the loop,
 * pointers, sizes and one row of the Hessian in each tick are compared with the tables; voltages
 * that stay from tick to tick are replaced by the majority of their three copies.
 */
static void repair(pzs_governor_state *state)
{
    const pzs_problem *problem = state->control->state.problem;
    const size_t width = PZS_FOURS(problem->inputs), bytes = problem->inputs * sizeof(pzs_real);
    pzs_control *optimum = &state->optimum;
    pzs_control_restore(optimum, problem, influence_of(state->control), work_of(state));
    guard_repair_bool(&state->has_target);
    vote(state->reference, width);
    vote(state->optimal, width);
    if (are_equal(optimum->state.voltage, state->optimal, problem->inputs))
        return;
    memcpy(optimum->state.voltage, state->optimal, bytes);
    pzs_control_moved(optimum);
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_governor_state *state = self;
    const pzs_problem *problem = signals->control->state.problem;
    place(state, signals->tables, signals->control);
    repair(state);
    if (pzs_guard_nonfinite(signals->wanted, problem->outputs) >= 0)
        return PZS_OK; /* If the target shape is not finite, the governor leaves it unchanged. The
                          controller then keeps the last voltages and returns a warning. */
    if (!is_known(state, signals->wanted))
        find_optimum(state, signals->wanted);
    if (!state->has_target || !move_reference(state))
        return PZS_OK;
    pzs_control_multiply(signals->control, state->wanted, state->ahead);
    for (uint32_t i = 0; i < problem->outputs; i++)
        state->wanted[i] = signals->wanted[i] - state->wanted[i];
    signals->wanted = state->wanted;
    return PZS_OK;
}

const pzs_block_type pzs_governor_block = {"governor", PZS_PHASE_READINGS, block_bytes,
                                           block_init, block_tick,         NULL};
