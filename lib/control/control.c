/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Controller (pzs_control.h): initialisation, optimisation of the voltages, control tick. Half of
 * the gradient of the objective at the voltages v is, for any base voltages,
 *
 *   H (v - base) + regularisation (base - v0) - B'W^2 (e - B base)
 *   H      Hessian B'W^2 B + regularisation I
 *   B, W   influence matrix, output weights
 *   e, v0  target error, reference voltages
 *
 * Near the base this expression is as accurate as the residual e - B base. The predicted shape B v
 * of a tick makes v the next base at no cost; pzs_step renews its base only where rounding errors
 * would matter.
 */
#include <string.h>
#include "boxls.h"
#include "boxls_dual.h"
#include "boxls_tableau.h"
#include "control.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"
#include "limit_rows.h"
#include "sensor_check.h"
#include "sparse_influence.h"
#include "step_bounds.h"

/*
 * In a tick that also damps vibration, the optimiser may stop before the exact optimum: when the
 * violation of the optimality (KKT) conditions is this part of the gradient at the start of the
 * tick. The next tick corrects the rest; in static equilibrium there is none.
 */
#define DAMPED_TOLERANCE PZS_R(1e-3)

/*
 * Smallest square of displacements that is safe from underflow (m2). It is added under the root in
 * the rounding-error bound of the gradient; without it, squares that underflow could make the bound
 * too small.
 */
#define SMALLEST_SQUARE PZS_BY_BITS(1e-31f, 1e-292)

/* ---- optimisation step ---------------------------------------------------- */

/*
 * Compute the bounds of the voltages in a tick: the step limits around the last voltages, clamped
 * to the voltage limits. Returns the number of inputs whose step limit and voltage limits do not
 * overlap.
 */
static uint32_t set_step_bounds(pzs_real *restrict lo, pzs_real *restrict hi,
                                const pzs_real *restrict voltage,
                                const pzs_real *restrict step_limit, const pzs_real *restrict lower,
                                const pzs_real *restrict upper, size_t width)
{
    uint32_t clashes = 0;
    for (size_t i = 0; i < width; i++) {
        const pzs_real from = step_down(voltage[i], step_limit[i]),
                       to = step_up(voltage[i], step_limit[i]);
        const pzs_real low = from > lower[i] ? from : lower[i];
        const pzs_real high = to < upper[i] ? to : upper[i];
        clashes += low > high ? 1u : 0u;
        lo[i] = low;
        hi[i] = high;
    }
    return clashes;
}

/*
 * Where step limit and voltage limits of an input do not overlap, use the voltage limit nearer to
 * its last voltage as both bounds. Returns the first such input, or -1.
 */
static int32_t prefer_voltage_limits(pzs_optimiser *optimiser, const pzs_control *control)
{
    int32_t clash = -1;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        if (optimiser->lower[i] > optimiser->upper[i]) {
            optimiser->lower[i] = optimiser->upper[i] =
                optimiser->voltage[i] < control->state.lower[i] ? control->state.lower[i]
                                                                : control->state.upper[i];
            clash = clash < 0 ? (int32_t)i : clash;
        }
    }
    return clash;
}

/*
 * Set the bounds of the voltages in a tick if step limits are used. Returns the first input
 * whose step limit and voltage limits do not overlap, or -1.
 */
static int32_t start_step(pzs_optimiser *optimiser, const pzs_control *control)
{
    if (!control->state.has_step_limits ||
        set_step_bounds(optimiser->lower, optimiser->upper, optimiser->voltage,
                        control->state.step_limit, control->state.lower, control->state.upper,
                        optimiser_span(optimiser)) == 0)
        return -1;
    return prefer_voltage_limits(optimiser, control);
}

/*
 * Compute the part B'W^2 (wanted - shape) of the objective's gradient and return the square |W
 * (wanted - shape)|^2, with the influence matrix B and the output weights W.
 *   out [inputs] out  part of the gradient (m2/V)
 */
static pzs_real project_misfit(const pzs_control *control, pzs_real *out, const pzs_real *wanted,
                               const pzs_real *shape)
{
    const uint32_t outputs = control->state.problem->outputs,
                   inputs = control->state.problem->inputs;
    const pzs_real square = pzs_product_weigh(
        control->state.weighted, control->state.problem->weight, wanted, shape, outputs);
    if (control->state.influence != NULL)
        pzs_product_sum_rows(out, control->state.influence, inputs, control->state.weighted,
                             outputs, inputs);
    else
        control->state.problem->sparse->call->project(control->state.problem, out,
                                                      control->state.weighted);
    return square;
}

void pzs_control_multiply(const pzs_control *control, pzs_real *product, const pzs_real *voltage)
{
    const pzs_problem *problem = control->state.problem;
    if (control->state.influence != NULL)
        pzs_product_matrix(product, control->state.influence, voltage, problem->outputs,
                           problem->inputs);
    else
        problem->sparse->call->multiply(problem, product, voltage);
}

/*
 * Compute the target part of the gradient, B'W^2 (wanted - shown), with the influence matrix B and
 * the output weights W.
 *   wanted [outputs] in  target shape (m)
 *   shown  [outputs] in  shape of the base voltages plus the disturbance (m)
 * Returns |W (wanted - shown)|^2 (m2), finite only if the gradient is finite.
 */
static pzs_real project_target(pzs_optimiser *optimiser, const pzs_control *control,
                               const pzs_real *wanted, const pzs_real *shown)
{
    const pzs_real missed = project_misfit(control, optimiser->target_gradient, wanted, shown);
    // Scale of the objective: weighted sum of the squared differences (m2) between the wanted shape
    // and the shape without voltages.
    optimiser->target_energy =
        missed + control->state.base_energy +
        2 * pzs_product_dot(optimiser->base, optimiser->target_gradient, optimiser->width);
    optimiser->target_energy = optimiser->target_energy < PZS_EPSILON * missed
                                   ? PZS_EPSILON * missed
                                   : optimiser->target_energy;
    return missed;
}

/*
 * Make the present voltages the base voltages, around which the gradient of the objective is
 * computed. Their shape must be the predicted one.
 */
static void set_base(pzs_optimiser *optimiser, const pzs_control *control)
{
    const pzs_real regularisation = control->state.problem->regularisation;
    const pzs_real *restrict voltage = optimiser->voltage, *restrict reference =
                                                               control->state.problem
                                                                   ->reference_voltage;
    pzs_real *restrict base = optimiser->base, *restrict model = optimiser->model_gradient,
                       *restrict gradient = optimiser->regularisation_gradient;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        base[i] = voltage[i];
        gradient[i] = model[i] = regularisation * (voltage[i] - reference[i]);
    }
    optimiser->model_rounding = 0;
    optimiser->is_predicted = false;
}

/* Predict the shape of the present voltages, which are to become the base voltages. */
static void predict(pzs_optimiser *optimiser, pzs_control *control)
{
    const size_t bytes = optimiser->inputs * sizeof *optimiser->base;
    pzs_control_multiply(control, control->state.predicted, optimiser->voltage);
    memcpy(optimiser->base, optimiser->voltage, bytes);
    control->state.base_energy = pzs_product_energy(
        control->state.problem->weight, control->state.predicted, control->state.problem->outputs);
    control->state.predicted_sum = pzs_control_predicted_sum(control);
    control->state.behind = PZS_BEHIND_NOTHING;
}

/* Make the present voltages the base voltages, and predict their shape. */
static void rebase(pzs_optimiser *optimiser, pzs_control *control)
{
    predict(optimiser, control);
    set_base(optimiser, control);
}

static pzs_status finish(pzs_control *control, pzs_status status, int32_t where)
{
    control->info.where = where;
    return status;
}

static pzs_status check_ready(const pzs_control *control, const void *argument)
{
    if (control == NULL || argument == NULL)
        return PZS_E_ARGUMENT;
    return control->state.stage == CONTROL_READY ? PZS_OK : PZS_E_STAGE;
}

/*
 * Return the measurements to expect: the predicted shape plus the disturbance, which is the
 * measured minus the predicted shape of the last tick (m).
 */
static const pzs_real *expected_measurements(const pzs_control *control)
{
    const uint32_t outputs = control->state.problem->outputs;
    pzs_real *sum = control->state.weighted + outputs;
    for (uint32_t i = 0; i < outputs; i++)
        sum[i] = control->state.predicted[i] + control->state.disturbance[i];
    return sum;
}

/*
 * Return the largest number of multiply-adds that the optimiser may use in a tick. Where the
 * supervisor moves the voltages, its prediction of the shape takes the time of the optimiser.
 */
static uint64_t work_limit(const pzs_control *control)
{
    const pzs_problem *problem = control->state.problem;
    const uint64_t least = problem->limit_rows != NULL
                               ? problem->limit_rows->call->least_work(problem)
                               : PZS_WORK_LEAST(problem->inputs);
    const uint64_t most = control->state.is_led ? 0 : control->settings.work_limit;
    return most > least ? most : least;
}

/*
 * Optimise the voltages inside their bounds and, where sums of voltages are limited, inside these
 * limits.
 */
static void optimise_within(pzs_optimiser *optimiser, pzs_control *control)
{
    const pzs_limit_rows *rows = control->state.problem->limit_rows;
    if (rows != NULL)
        rows->call->optimise(control);
    else
        pzs_boxls_optimise(optimiser);
}

/*
 * Bring the voltages inside the limits of weighted sums of voltages, if there are any. Returns
 * whether they are inside. If not, *where is the first input whose voltage is outside its own
 * present voltage limits, for example because pzs_hold has fixed it at another voltage; -1: none.
 */
static bool enter_rows(pzs_control *control, int32_t *where)
{
    const pzs_limit_rows *rows = control->state.problem->limit_rows;
    return rows == NULL || rows->call->bring_inside(control, where);
}

/*
 * Find the optimal voltages. If the voltages are so far from the base voltages, around which the
 * gradient is computed, that rounding errors could cost accuracy, and if the remaining work allows
 * it, optimise again from new base voltages.
 */
static void optimise(pzs_optimiser *optimiser, pzs_control *control, const pzs_real *wanted,
                     const pzs_real *shown)
{
    const uint64_t products = 2u * (uint64_t)control->state.problem->outputs * optimiser->inputs;
    optimise_within(optimiser, control);
    if (!pzs_boxls_needs_new_base(optimiser) ||
        !optimiser_affords(optimiser, products + PZS_ROUND_WORK(optimiser->inputs)))
        return;
    optimiser->work += products;
    rebase(optimiser, control);
    (void)project_target(optimiser, control, wanted,
                         shown == control->state.predicted ? shown
                                                           : expected_measurements(control));
    optimise_within(optimiser, control);
}

/*
 * Set the work limit of the optimiser in a tick and the rounding-error bound of target_gradient,
 * B'W^2 (wanted - shape), with influence matrix B and output weights W.
 *   missed in  squared norm |W (wanted - shape)|^2 for the shape of the base voltages (m2)
 */
static void set_work_limits(pzs_optimiser *optimiser, const pzs_control *control, pzs_real missed)
{
    optimiser->iterations = optimiser->rebuilds = 0;
    optimiser->work = 0;
    optimiser->work_limit = work_limit(control);
    optimiser->target_rounding = PZS_EPSILON *
                                 PZS_SQRT(optimiser->target_energy + missed + SMALLEST_SQUARE) *
                                 control->state.largest_column;
}

/*
 * Return the largest absolute value of half the gradient of the objective over the inputs of the
 * free set, whose voltages the optimiser may change (m2/V).
 */
static pzs_real largest_free_gradient(const pzs_optimiser *optimiser)
{
    pzs_real largest = 0;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        const pzs_real size =
            number_absolute(optimiser->model_gradient[i] - optimiser->target_gradient[i]);
        largest = optimiser->free_set[i] > 0 && size > largest ? size : largest;
    }
    return largest;
}

/*
 * Store the number of multiply-adds and of iterations that the optimiser has used in a tick in the
 * results of the controller.
 */
static void note_work(const pzs_optimiser *optimiser, pzs_control *control)
{
    control->state.behind = PZS_BEHIND_PREDICTION;
    control->info.work = optimiser->work;
    control->info.work_most =
        control->info.work > control->info.work_most ? control->info.work : control->info.work_most;
    control->info.iterations = (uint16_t)optimiser->iterations;
    control->info.iterations_most = control->info.iterations > control->info.iterations_most
                                        ? control->info.iterations
                                        : control->info.iterations_most;
}

/*
 * Write the results of the optimisation in a tick to the controller. `clash` is the first input
 * whose step limit and voltage limits do not overlap, or -1. Returns the status of the tick.
 */
static pzs_status finish_step(const pzs_optimiser *optimiser, pzs_control *control, int32_t clash)
{
    note_work(optimiser, control);
    if (!optimiser->is_optimal)
        return finish(control, PZS_W_ITERATIONS, -1);
    return finish(control, clash < 0 ? PZS_OK : PZS_W_STEP_LIMIT, clash);
}

/*
 * Change the gradient of a tick so that the tick also damps vibration: multiply the gradient by
 * state.share, which slows the approach to the static optimum, and subtract the damping gradient.
 * The gradient is that at the base voltages; the optimiser adds the Hessian times the change of the
 * voltages.
 *   damping [inputs] in  damping gradient, which takes energy out of the vibration (m2/V)
 *   missed           in  weighted squared norm of the target error (m2)
 * Returns the new scale of the gradient's rounding errors (m2): `missed`, plus the square of the
 * target error that would cause a gradient as large as `damping`.
 */
static pzs_real damp_target(pzs_optimiser *optimiser, const pzs_control *control,
                            const pzs_real *damping, pzs_real missed)
{
    const pzs_real share = control->state.share, column = control->state.largest_column;
    pzs_real largest = 0;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        const pzs_real size = number_absolute(damping[i]);
        largest = size > largest ? size : largest;
        optimiser->target_gradient[i] = share * optimiser->target_gradient[i] +
                                        (1 - share) * optimiser->regularisation_gradient[i] +
                                        damping[i];
    }
    // A target error (m) of this norm could cause the largest entry of `damping` in the gradient.
    const pzs_real height = column > 0 ? largest / column : 0;
    return missed + height * height;
}

/*
 * Add to target_gradient the gradient that arises because pzs_hold has just fixed voltages, which
 * thereby move the shape. A tick that damps vibration resists every change of the shape; without
 * this term it would move the free voltages to compensate the motion.
 */
static void ignore_held_moves(pzs_optimiser *optimiser, const pzs_control *control)
{
    for (uint32_t j = 0; j < optimiser->inputs; j++) {
        const pzs_real lower = control->state.lower[j], move = lower - optimiser->base[j];
        if (lower < control->state.upper[j])
            continue;
        for (uint32_t i = 0; i < optimiser->inputs; i++)
            optimiser->target_gradient[i] +=
                optimiser->hessian[(size_t)i * optimiser->width + j] * move;
    }
}

/*
 * Make one control step: optimise the voltages to change the shape `shown` towards the shape
 * `wanted`.
 *   damping [inputs] in  term that damps vibration in half the gradient of the objective (m2/V);
 *                        NULL: no damping
 */
static pzs_status step(pzs_optimiser *optimiser, pzs_control *control, const pzs_real *wanted,
                       const pzs_real *shown, const pzs_real *damping)
{
    pzs_real missed = project_target(optimiser, control, wanted, shown);
    if (!number_is_finite(optimiser->target_energy + missed))
        return finish(control, PZS_E_NONFINITE,
                      pzs_guard_nonfinite(wanted, control->state.problem->outputs));
    if (control->state.filter != NULL)
        missed = control->state.filter->filter_step(control, control->state.filter, missed);
    if (damping != NULL)
        missed = damp_target(optimiser, control, damping, missed);
    if (damping != NULL && control->state.is_paused)
        ignore_held_moves(optimiser, control);
    control->state.is_paused = false; /* While is_paused is set, the loop does not follow target and
                                         loads, because the fault detector measures the response to
                                         a test pulse. The flag is cleared in each tick and set
                                         again by a running detector, so that the loop does not stay
                                         paused when the detector stops. */
    const int32_t clash = start_step(optimiser, control);
    set_work_limits(optimiser, control, missed);
    int32_t where = -1;
    if (!enter_rows(control, &where)) {
        note_work(optimiser, control);
        return finish(control, PZS_W_LIMIT_ROWS, where);
    }
    if (damping != NULL) {
        optimiser->target_rounding += DAMPED_TOLERANCE * largest_free_gradient(optimiser);
        optimise_within(optimiser, control);
    } else if (control->state.filter != NULL) {
        optimise_within(optimiser, control);
    } else {
        optimise(optimiser, control, wanted, shown);
    }
    return finish_step(optimiser, control, clash);
}

pzs_status pzs_step(pzs_control *control, const pzs_real *error)
{
    const pzs_status status = check_ready(control, error);
    if (status != PZS_OK)
        return status;
    pzs_optimiser *optimiser = &control->state.optimiser;
    if (control->state.behind == PZS_BEHIND_GRADIENT)
        predict(optimiser, control);
    if (control->state.behind == PZS_BEHIND_NOTHING)
        set_base(optimiser, control);
    pzs_control_filter(control, NULL);
    return step(optimiser, control, error, control->state.predicted, NULL);
}

void pzs_control_complete(pzs_control *control)
{
    tableau_apply_collected(&control->state.optimiser);
}

/* ---- control tick ---------------------------------------------------- */

/* Predict the shape anew if the voltages have changed since the last prediction. */
static void renew_prediction(pzs_optimiser *optimiser, pzs_control *control)
{
    if (control->state.behind != PZS_BEHIND_NOTHING)
        predict(optimiser, control);
}

void pzs_control_predict(pzs_control *control)
{
    renew_prediction(&control->state.optimiser, control);
}

void pzs_control_moved(pzs_control *control)
{
    control->state.behind = PZS_BEHIND_GRADIENT;
}

void pzs_control_damp(pzs_control *control, pzs_real share, const pzs_real *damping,
                      pzs_real *carry)
{
    control->state.carry = carry;
    control->state.share = share;
    control->state.damping = damping;
}

void pzs_control_filter(pzs_control *control, pzs_step_filter *filter)
{
    control->state.filter = filter;
}

/* Keep the voltages of the last tick, clamped to the present voltage limits. */
static pzs_status hold_voltages(pzs_optimiser *optimiser, pzs_control *control, int32_t where)
{
    int32_t outside;
    (void)start_step(optimiser, control);
    if (control->state.problem->limit_rows != NULL) {
        (void)enter_rows(control, &outside);
        rebase(optimiser, control);
    } else if (pzs_boxls_enforce_limits(optimiser)) {
        rebase(optimiser, control);
    }
    return finish(control, PZS_W_HELD, where);
}

/*
 * Compute the disturbance (measured minus predicted shape). In a tick that also damps vibration the
 * measured shape comes from the vibration damper and is checked already. Returns the number of
 * rejected measurements; *where receives the index of the first one.
 */
static uint32_t compare(const pzs_control *control, const pzs_real *measured, int32_t *where)
{
    const uint32_t outputs = control->state.problem->outputs;
    bool is_repeated = true;
    const sensor_check all = {outputs, control->state.predicted, control->state.measured,
                              control->state.disturbance, control->state.repeats};
    if (control->state.damping == NULL)
        return pzs_sensor_check(&all, measured, where, &is_repeated);
    pzs_real *restrict disturbance = control->state.disturbance;
    const pzs_real *restrict predicted = control->state.predicted;
    for (uint32_t i = 0; i < outputs; i++)
        disturbance[i] = measured[i] - predicted[i];
    return 0;
}

pzs_status pzs_tick(pzs_control *control, const pzs_real *wanted, const pzs_real *measured)
{
    const pzs_status status = check_ready(control, wanted);
    if (status != PZS_OK)
        return status;
    pzs_optimiser *optimiser = &control->state.optimiser;
    const uint32_t outputs = control->state.problem->outputs;
    int32_t where = -1;
    renew_prediction(optimiser, control);
    set_base(optimiser, control); /* in each tick, because memory may be damaged */
    const uint32_t unusable = measured != NULL ? compare(control, measured, &where) : 0;
    if (unusable == outputs)
        return hold_voltages(optimiser, control, where);
    const pzs_status stepped =
        step(optimiser, control, wanted,
             measured != NULL && unusable == 0 ? measured : expected_measurements(control),
             control->state.damping);
    if (stepped == PZS_E_NONFINITE)
        return hold_voltages(optimiser, control, control->info.where);
    pzs_control_complete(control);
    predict(optimiser, control);
    return stepped == PZS_OK && unusable != 0 ? finish(control, PZS_W_SENSOR, where) : stepped;
}

/* ---- initialisation and voltage limits ------------------------------- */

/*
 * Return the first input whose limits contain no finite voltage, or whose step limit is negative or
 * not a number, or -1.
 */
static int32_t bad_limit(const pzs_problem *problem)
{
    for (uint32_t i = 0; i < problem->inputs; i++) {
        const pzs_real lower = problem->lower[i], upper = problem->upper[i];
        const int some =
            lower <= upper && (number_is_finite(lower) || number_is_finite(upper) || lower < upper);
        if (!some || !(problem->step_limit[i] >= 0))
            return (int32_t)i;
    }
    return -1;
}

/*
 * Check the influence matrix of a controller, whose tables have passed their checksum.
 *   influence [outputs][inputs] in   full influence matrix that is used (m/V); NULL: the sparse one
 *   bad                         in   index of the first number of the tables that is not finite, or
 *                                    -1
 *   where                       out  index of the number that is not finite, or of the faulty entry
 *                                    of the sparse matrix; -1: none
 * Errors: PZS_E_NONFINITE, and those of the check of the sparse matrix.
 */
static pzs_status check_influence(const pzs_problem *problem, const pzs_real *influence,
                                  int32_t bad, int32_t *where)
{
    if (bad < 0 && influence != problem->influence)
        bad = pzs_guard_nonfinite(influence, (uint32_t)problem->outputs * problem->inputs);
    *where = bad;
    if (bad >= 0)
        return PZS_E_NONFINITE;
    return influence == NULL ? problem->sparse->call->check(problem, where) : PZS_OK;
}

pzs_status pzs_control_check_problem(const pzs_problem *problem, const pzs_real *influence,
                                     int32_t *where)
{
    const int missing =
        problem->weight == NULL || problem->lower == NULL || problem->upper == NULL ||
        problem->step_limit == NULL || problem->reference_voltage == NULL ||
        (influence == NULL && (problem->sparse == NULL || problem->sparse->call == NULL));
    int32_t bad;
    *where = -1;
    if (problem->format != PZS_TABLE_FORMAT)
        return PZS_E_FORMAT;
    if (missing || problem->inputs == 0 || problem->inputs > PZS_INPUT_LIMIT ||
        problem->outputs == 0 || !(problem->regularisation >= 0) ||
        (problem->limit_rows != NULL && problem->limit_rows->call == NULL))
        return PZS_E_ARGUMENT;
    if (pzs_problem_check(problem, &bad) != problem->crc)
        return PZS_E_CRC;
    *where = bad_limit(problem);
    if (*where >= 0)
        return PZS_E_LIMITS;
    const pzs_status status = check_influence(problem, influence, bad, where);
    if (status != PZS_OK || problem->limit_rows == NULL)
        return status;
    return problem->limit_rows->call->check_rows(problem, where);
}

void pzs_control_place(pzs_control *control, void *work)
{
    pzs_real *at = work;
    control->state.work = work;
    const uint32_t inputs = control->state.problem->inputs,
                   outputs = control->state.problem->outputs,
                   width = (uint32_t)PZS_CONTROL_WIDTH(inputs);
    pzs_optimiser *optimiser = &control->state.optimiser;
    optimiser->inputs = inputs;
    optimiser->width = width;
    optimiser->hessian = at, at += (size_t)inputs * width;
    optimiser->tableau = at, at += (size_t)inputs * width;
    pzs_boxls_place(optimiser, at);
    at += BOXLS_VECTORS * width;
    control->state.voltage = optimiser->voltage = at, at += width;
    control->state.lower = at, at += width;
    control->state.upper = at, at += width;
    control->state.step_limit = at, at += width;
    for (int copy = 0; copy < 3; copy++)
        control->state.held[copy] = at, at += width;
    if (inputs >= PZS_DUAL_INPUTS)
        pzs_dual_place(optimiser, at);
    optimiser->dual = inputs >= PZS_DUAL_INPUTS ? control->state.problem->dual_method : NULL;
    at += PZS_DUAL_REALS(inputs);
    control->state.predicted = at, at += outputs;
    control->state.disturbance = at, at += outputs;
    control->state.measured = at, at += outputs;
    control->state.weighted = at, at += 2u * outputs;
    control->state.repeats = (uint8_t *)at;
    control->state.faulty = control->state.repeats + outputs;
    control->info.voltage = control->state.voltage;
    control->info.predicted = control->state.predicted;
    control->info.disturbance = control->state.disturbance;
    control->info.lower = control->state.lower;
    control->info.upper = control->state.upper;
    control->state.row_solver = NULL;
    if (control->state.problem->limit_rows != NULL)
        control->state.problem->limit_rows->call->arrange(
            control, (uint8_t *)work + PZS_CONTROL_BYTES(inputs, outputs));
}

size_t pzs_control_bytes(const pzs_problem *problem)
{
    const uint32_t rows = limit_row_count(problem);
    return PZS_CONTROL_BYTES(problem->inputs, problem->outputs) +
           (rows > 0 ? PZS_LIMIT_ROW_BYTES(problem->inputs, rows) : 0);
}

/*
 * Set the bounds of the voltages in a new controller. Without step limits the bounds are the
 * voltage limits in every tick.
 */
static void set_initial_bounds(pzs_optimiser *optimiser, const pzs_control *control)
{
    pzs_control_share_bounds(optimiser, control);
    if (control->state.has_step_limits) {
        memcpy(optimiser->lower, control->state.lower,
               optimiser->inputs * sizeof *optimiser->lower);
        memcpy(optimiser->upper, control->state.upper,
               optimiser->inputs * sizeof *optimiser->upper);
    }
}

/*
 * Set a new controller to its first voltages, the reference voltages clamped to the limits, and let
 * the optimiser begin with all inputs free whose effects on the shape are linearly independent.
 */
static void set_initial_state(pzs_optimiser *optimiser, pzs_control *control)
{
    const pzs_problem *problem = control->state.problem;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        pzs_control_set_held(control, i, (pzs_real)NAN);
        optimiser->voltage[i] =
            number_clamp(problem->reference_voltage[i], problem->lower[i], problem->upper[i]);
        optimiser->diagonal[i] = optimiser->hessian[(size_t)i * optimiser->width + i];
        optimiser->free_set[i] = 1;
    }
    pzs_control_restore_limits(control);
    set_initial_bounds(optimiser, control);
    pzs_control_set_constants(control);
    optimiser->work_limit = UINT64_MAX;
    if (problem->limit_rows != NULL) {
        const pzs_limit_rows *rows = problem->limit_rows;
        (void)rows->call->scale_back(problem, rows->safe, optimiser->voltage);
        rows->call->prepare(control);
    }
    rebase(optimiser, control);
    pzs_tableau_reset(optimiser);
    (void)pzs_tableau_rebuild(optimiser);
}

uint64_t pzs_control_usual_work(const pzs_problem *problem)
{
    if (problem->work_limit > 0)
        return problem->work_limit;
    return problem->limit_rows != NULL ? problem->limit_rows->call->usual_work(problem)
                                       : PZS_WORK_LIMIT(problem->inputs);
}

pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem,
                            const pzs_real *influence, void *work, size_t bytes)
{
    if (control == NULL)
        return PZS_E_ARGUMENT;
    control->state.stage = 0;
    if (problem == NULL || work == NULL)
        return PZS_E_ARGUMENT;
    const pzs_real *use = influence != NULL ? influence : problem->influence;
    const size_t need = pzs_control_bytes(problem);
    *control = (pzs_control){.state.problem = problem, .state.influence = use, .info.where = -1};
    const pzs_status status = pzs_control_check_problem(problem, use, &control->info.where);
    if (status != PZS_OK)
        return status;
    control->settings.work_limit = pzs_control_usual_work(problem);
    const int32_t lacking = guard_missing_bytes(work, bytes, need);
    if (lacking >= 0)
        return finish(control, PZS_E_WORKSPACE, lacking);
    /*
     * Hessian and tableau (pivoted Hessian) of the optimiser, which come first in the workspace,
     * need not be set to zero, because they are computed as a whole afterwards.
     */
    const size_t matrices =
        2u * sizeof(pzs_real) * problem->inputs * PZS_CONTROL_WIDTH(problem->inputs);
    memset((uint8_t *)work + matrices, 0, need - matrices);
    pzs_control_place(control, work);
    const int32_t overflow =
        pzs_control_form_hessian(control, influence == NULL ? problem->hessian : NULL);
    if (overflow >= 0)
        return finish(control, PZS_E_NONFINITE, overflow);
    set_initial_state(&control->state.optimiser, control);
    control->state.stage = CONTROL_READY;
    return PZS_OK;
}

pzs_status pzs_control_start(pzs_control *control, const pzs_real *voltage)
{
    const pzs_status status = check_ready(control, voltage);
    if (status != PZS_OK)
        return status;
    const int32_t bad = pzs_guard_nonfinite(voltage, control->state.problem->inputs);
    if (bad >= 0)
        return finish(control, PZS_E_NONFINITE, bad);
    for (uint32_t i = 0; i < control->state.problem->inputs; i++)
        control->state.voltage[i] =
            number_clamp(voltage[i], control->state.lower[i], control->state.upper[i]);
    set_initial_bounds(&control->state.optimiser, control);
    rebase(&control->state.optimiser, control);
    return finish(control, PZS_OK, -1);
}

pzs_status pzs_hold(pzs_control *control, uint16_t input, pzs_real voltage)
{
    const pzs_status status = check_ready(control, control);
    if (status != PZS_OK)
        return status;
    const pzs_problem *problem = control->state.problem;
    if (input >= problem->inputs)
        return finish(control, PZS_E_ARGUMENT, input);
    if (!number_is_finite(voltage))
        return finish(control, PZS_E_NONFINITE, input);
    control->state.lower[input] = control->state.upper[input] =
        number_clamp(voltage, problem->lower[input], problem->upper[input]);
    pzs_control_set_held(control, input, control->state.lower[input]);
    control->state.faulty[input] = 0;
    return finish(control, PZS_OK, -1);
}

pzs_status pzs_release(pzs_control *control, uint16_t input)
{
    const pzs_status status = check_ready(control, control);
    if (status != PZS_OK)
        return status;
    if (input >= control->state.problem->inputs)
        return finish(control, PZS_E_ARGUMENT, input);
    control->state.lower[input] = control->state.problem->lower[input];
    control->state.upper[input] = control->state.problem->upper[input];
    pzs_control_set_held(control, input, (pzs_real)NAN);
    control->state.faulty[input] = 0;
    return finish(control, PZS_OK, -1);
}

/* ---- certificate of optimality --------------------------------------- */

pzs_status pzs_assess(pzs_control *control, const pzs_real *error, pzs_report *report)
{
    const pzs_status status = report != NULL ? check_ready(control, error) : PZS_E_ARGUMENT;
    if (status != PZS_OK)
        return status;
    const uint32_t outputs = control->state.problem->outputs;
    pzs_optimiser *optimiser = &control->state.optimiser;
    pzs_real *shape = control->state.weighted + outputs, most = 0;
    memset(shape, 0, outputs * sizeof *shape);
    const pzs_real all = PZS_SQRT(project_misfit(control, optimiser->next_voltage, error, shape));
    for (uint32_t i = 0; i < optimiser->inputs; i++)
        most = number_absolute(optimiser->next_voltage[i]) > most
                   ? number_absolute(optimiser->next_voltage[i])
                   : most;
    pzs_control_multiply(control, shape, optimiser->voltage);
    const pzs_real left = PZS_SQRT(project_misfit(control, optimiser->next_voltage, error, shape));
    if (!number_is_finite(all + left))
        return finish(control, PZS_E_NONFINITE, pzs_guard_nonfinite(error, outputs));
    pzs_report result = {.relative_error = all > 0 ? left / all : 0};
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        optimiser->gradient[i] =
            control->state.problem->regularisation *
                (optimiser->voltage[i] - control->state.problem->reference_voltage[i]) -
            optimiser->next_voltage[i];
        result.active_limits =
            (uint16_t)(result.active_limits + !(optimiser->voltage[i] > optimiser->lower[i] &&
                                                optimiser->voltage[i] < optimiser->upper[i]));
    }
    const pzs_limit_rows *rows = control->state.problem->limit_rows;
    const pzs_real wrong =
        rows != NULL ? rows->call->violation(control, optimiser->gradient, &result.active_rows)
                     : pzs_boxls_violation(optimiser, optimiser->voltage, optimiser->gradient);
    result.kkt_violation = most > 0 ? wrong / most : 0;
    *report = result;
    return PZS_OK;
}
