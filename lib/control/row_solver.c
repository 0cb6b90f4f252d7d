/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Optimiser for voltages inside bounds and limit rows, which are limits of weighted sums of
 * voltages (limit_rows.h). It solves
 *
 *   minimise   (v - base)' H (v - base) / 2 + (r - t)' (v - base)
 *   subject to lower <= v <= upper,  row_lower <= A v <= row_upper
 *   v, base  voltages; voltages around which the gradient is computed
 *   H        Hessian
 *   r, t     gradients of the regularisation and of the target at the base voltages
 *   A        matrix of the limit rows
 *
 * A quantity is the voltage of an input, or the sum of a limit row divided by its largest absolute
 * coefficient. It is either free, or active: kept at a bound by its multiplier, the derivative of
 * the objective with respect to it. The dual active-set method (boxls_dual.h) treats limit rows
 * like further inputs.
 */
#include <string.h>
#include "row_solver.h"
#include "boxls.h"
#include "boxls_dual.h"
#include "boxls_tableau.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * Largest number of times in a tick that the optimiser for limited sums of voltages computes its
 * tableau anew. The tableau T gives the changes -T dm of all voltages and limited sums when their
 * multipliers change by dm.
 */
#define REBUILDS 3u
/*
 * Largest number of rounds in one call of the optimiser for limited sums of voltages. A round is a
 * sequence of iterations that ends with a gradient computed from the Hessian.
 */
#define ROUNDS 40u
/*
 * Upper bound of the work with which the signs of the voltages in one limited sum of absolute
 * values are chosen anew, in products of a vector with the optimiser's tableau. The tableau is the
 * matrix that gives changes of voltages and sums from changes of multipliers.
 */
#define SIGN_PRODUCTS 8u
/*
 * A violation of the optimality (KKT) conditions counts as zero if it is below this multiple of its
 * rounding-error bound.
 */
#define ROUNDING_FACTOR 4
/*
 * The voltages are accepted as optimal if further iterations no longer reduce the duality gap and
 * the violation of the optimality (KKT) conditions is below this multiple of its rounding-error
 * bound.
 */
#define TOLERATED PZS_BY_BITS(256, 2048)
/*
 * Size of the first shift of a Hessian that is singular or nearly so. A shift is a number that the
 * optimiser adds to all diagonal entries, and raises if iterations fail. Its size is
 * (regularisation weight + shift) / (largest diagonal entry). A Hessian whose pivots all exceed
 * this fraction of its largest diagonal entry is not shifted.
 */
#define LEAST_CURVATURE PZS_BY_BITS(PZS_R(1e-3), PZS_R(3e-9))
/*
 * Size of the largest shift of a Hessian that is singular or nearly so. A shift is a number that
 * the optimiser adds to all diagonal entries, and raises if iterations fail. Its size is
 * (regularisation weight + shift) / (largest diagonal entry of the Hessian).
 */
#define MOST_CURVATURE PZS_BY_BITS(PZS_R(3e-1), PZS_R(1e-5))
/*
 * The voltages are accepted as optimal if the objective exceeds a lower bound of its minimum by no
 * more than this fraction of target_energy, the scale of the objective.
 */
#define GAP PZS_BY_BITS(PZS_R(1e-7), PZS_R(1e-11))
/*
 * Factor by which the shift of the diagonal of the Hessian is raised after iterations that failed:
 * RAISE in general. Where sums of absolute values are limited it is ABSOLUTE_RAISE, because more
 * limits then meet at the optimum and rounding errors matter more.
 */
#define RAISE 10
#define ABSOLUTE_RAISE 30
/*
 * The duality gap counts as no longer reduced if a round (sequence of iterations) does not divide
 * it by at least this number: STUCK in general, ABSOLUTE_STUCK where sums of absolute values are
 * limited. There the shift of the Hessian is often larger, which makes rounds converge more slowly.
 */
#define STUCK PZS_R(4.0)
#define ABSOLUTE_STUCK PZS_R(1.25)
/*
 * Weaker bound for accepting voltages as optimal, used if further iterations no longer reduce the
 * duality gap: the objective then exceeds a lower bound of its minimum by no more than this
 * fraction of target_energy, the scale of the objective.
 */
#define LOOSE_GAP (PZS_BY_BITS(100, 5) * GAP)
/*
 * Largest number of times that the optimiser, after a sequence of iterations, projects the voltages
 * on the limits of all weighted sums of voltages.
 */
#define SWEEPS 4u
/*
 * Largest number of times that the optimiser, after a sequence of iterations, moves the active
 * voltages and limited sums of voltages back to their bounds to correct rounding errors.
 */
#define CORRECTIONS 2u

/*
 * Largest finite duality gap that is stored (m2). Larger gaps are replaced by it. An infinite gap
 * has another meaning: the last round (sequence of iterations) has lowered the objective.
 */
#define LARGEST_GAP PZS_BY_BITS(PZS_R(1e37), PZS_R(1e307))

/* Whether sums of absolute values of voltages are limited. */
static bool has_absolute(const rows_run *run)
{
    return run->rows->absolute_count > 0;
}

static uint32_t entry_count(const rows_run *run)
{
    return run->rows->sums.start[run->rows->sums.count];
}

/*
 * Return the largest number of multiply-adds of the work at the end of a round (sequence of
 * iterations): corrections of the voltages, weighted sums of voltages, and the gradient, which is
 * computed from the Hessian up to two times.
 */
static uint64_t end_work(const rows_run *run)
{
    const uint64_t n = run->inputs, width = run->tableau->width;
    return 2u * PZS_PRODUCT_WORK(n) + CORRECTIONS * n * (n + width) +
           (SWEEPS + CORRECTIONS + 16u) * (uint64_t)entry_count(run);
}

/*
 * Return the number of multiply-adds that are left for iterations within the optimiser's work
 * limit. The work at the end of a round of iterations (end_work) is already subtracted: corrections
 * of the voltages for rounding errors, and a gradient computed from the Hessian.
 */
static uint64_t remaining_work(const rows_run *run)
{
    const uint64_t spent = run->optimiser->work + run->tableau->work + end_work(run);
    return spent < run->optimiser->work_limit ? run->optimiser->work_limit - spent : 0;
}

/* ---- tableau: changes of voltages and limited sums per change of multipliers ----- */

/*
 * Tableau T of the optimiser: if the multipliers of the quantities (voltages and scaled sums of
 * limit rows) change by the vector dm, the quantities change by -T dm:
 *   T = -C P C'
 *   C  identity matrix with the scaled limit rows below it
 *   P  inverse of the Hessian; of a singular Hessian, or one that is nearly so, with a shift of its
 *      diagonal
 * The shift is a number added to the diagonal. With it, one round (sequence of iterations) does not
 * reach the optimum, but repeated rounds (proximal-point steps) do. After rounds that fail because
 * of rounding errors, the shift is raised.
 */

/* Return the largest diagonal entry of the Hessian (m2/V2). */
static pzs_real stiffest_of(const rows_run *run)
{
    return pzs_product_largest(run->optimiser->diagonal, run->optimiser->width);
}

/*
 * Return the number that the optimiser adds to each diagonal entry of the Hessian (m2/V2), so that
 * the inverse exists even if the Hessian is singular or zero.
 */
static pzs_real shift_of(const rows_run *run)
{
    const pzs_real stiffest = stiffest_of(run);
    const pzs_real shift = run->solver->least_curvature * stiffest - run->problem->regularisation;
    if (!(stiffest > 0))
        return 1;
    return shift > 0 ? shift : 0;
}

/*
 * Set the scale factor of each limit row (limit of a sum of voltages): the reciprocal of its
 * largest absolute coefficient, or 1 for a row of zeros.
 */
static void set_scales(const rows_run *run)
{
    const pzs_rows *sums = &run->rows->sums;
    for (uint32_t k = 0; k < sums->count; k++) {
        pzs_real most = 0;
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++)
            most =
                number_absolute(sums->value[at]) > most ? number_absolute(sums->value[at]) : most;
        run->solver->scale[run->inputs + k] = most > 0 ? 1 / most : 1;
    }
}

/*
 * Begin to compute the optimiser's tableau anew: set its start matrix and mark all voltages and
 * limited sums of voltages as active. Pivot exchanges of all inputs (complete_tableau) then give
 * the tableau.
 *   upper left              Hessian with the shift of its diagonal
 *   lower left, upper right negative scaled coefficients of the limited sums
 *   lower right             zero
 */
static void reset_tableau(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_rows *sums = &run->rows->sums;
    const size_t width = tableau->width, own = run->optimiser->width;
    const pzs_real shift = shift_of(run);
    memset(tableau->tableau, 0, run->count * width * sizeof(pzs_real));
    for (uint32_t i = 0; i < run->inputs; i++) {
        memcpy(tableau->tableau + i * width, run->optimiser->hessian + i * own,
               run->inputs * sizeof(pzs_real));
        tableau->tableau[i * width + i] += shift;
    }
    for (uint32_t k = 0; k < sums->count; k++)
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++) {
            const size_t row = run->inputs + k, input = sums->dof[at];
            const pzs_real value = -run->solver->scale[row] * rows_coefficient(run, k, at);
            tableau->tableau[row * width + input] = tableau->tableau[input * width + row] = value;
        }
    for (uint32_t k = 0; k < run->count; k++)
        tableau->free_set[k] = 0;
    tableau->active_count = run->count;
    tableau->pending_count = 0;
    tableau->exchanges = 0;
    tableau->is_rebuilding = true;
    tableau->work += (uint64_t)run->count * width;
    pzs_tableau_read_pivots(tableau);
}

/*
 * Choose the next pivot exchange (elimination step) in the computation of the optimiser's tableau:
 * return the input with the largest pivot among those not yet exchanged. Returns the number of
 * inputs if all are exchanged, or if the largest pivot is so small that the diagonal of the Hessian
 * must be shifted.
 */
static uint32_t next_pivot(const rows_run *run)
{
    pzs_real most = run->solver->least_curvature > 0 ? 0 : LEAST_CURVATURE * stiffest_of(run);
    uint32_t next = run->inputs;
    for (uint32_t i = 0; i < run->inputs; i++) {
        if (rows_is_free(run, i) || !(run->tableau->pivot[i] > most))
            continue;
        most = run->tableau->pivot[i];
        next = i;
    }
    return next;
}

/*
 * Estimate the rounding error of the pivots in the dual active-set method, in proportion to the
 * largest absolute diagonal entry of the optimiser's tableau. The tableau is the matrix that gives
 * changes of voltages, and of limited sums of voltages, from changes of the multipliers of their
 * limits.
 */
static void measure_pivots(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    pzs_real largest = 0;
    pzs_tableau_read_pivots(tableau);
    for (uint32_t k = 0; k < run->count; k++)
        largest = -tableau->pivot[k] > largest ? -tableau->pivot[k] : largest;
    tableau->pivot_floor = 0;
    tableau->pivot_rounding = (pzs_real)run->count * PZS_EPSILON * largest;
}

/*
 * Begin to compute the optimiser's tableau anew with a larger number (shift) added to the diagonal
 * of the Hessian. The shift is a multiple of the last one, between LEAST_CURVATURE and
 * MOST_CURVATURE. The tableau is the matrix that gives changes of voltages, and of limited sums of
 * voltages, from changes of multipliers.
 */
static void raise_shift(const rows_run *run)
{
    pzs_real *curvature = &run->solver->least_curvature;
    *curvature = number_clamp((has_absolute(run) ? ABSOLUTE_RAISE : RAISE) * *curvature,
                              LEAST_CURVATURE, MOST_CURVATURE);
    reset_tableau(run);
}

/*
 * Continue to compute the optimiser's tableau (matrix that gives changes of voltages, and of
 * limited sums of voltages, from changes of multipliers) anew, as far as the work limit of the
 * optimiser allows. The diagonal of the Hessian is shifted if one of its pivots is too small.
 * Returns whether the tableau is complete.
 */
static bool complete_tableau(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    bool is_complete = !tableau->is_rebuilding;
    while (!is_complete && remaining_work(run) >= PZS_ITERATION_WORK(run->count)) {
        const uint32_t k = next_pivot(run);
        tableau->work += tableau->width;
        is_complete = tableau->exchanges == run->inputs;
        if (k < run->inputs) {
            pzs_tableau_row(tableau, k, tableau->next_voltage);
            pzs_tableau_exchange(tableau, k, tableau->next_voltage);
        } else if (!is_complete && run->solver->least_curvature < MOST_CURVATURE) {
            raise_shift(run);
        } else if (!is_complete) {
            reset_tableau(run);
            return false;
        }
    }
    pzs_tableau_apply(tableau);
    if (!is_complete)
        return false;
    pzs_tableau_complete(tableau);
    pzs_dual_free_all(tableau);
    measure_pivots(run);
    return true;
}

/* ---- start of a round ------------------------------------------------------ */

/*
 * Compute bounds and margin of all voltages and of all scaled limit rows (limits of weighted sums
 * of voltages).
 *   margin of a row      distance by which both its limits are narrowed, for rounding errors
 *   margin of a voltage  distance from a bound up to which it counts as at this bound: the largest
 *                        margin of a row, at most an eighth of the distance between its bounds
 */
static void load_bounds(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    const size_t bytes = run->inputs * sizeof(pzs_real);
    memcpy(tableau->lower, run->optimiser->lower, bytes);
    memcpy(tableau->upper, run->optimiser->upper, bytes);
    pzs_real largest = 0;
    for (uint32_t k = 0; k < run->rows->sums.count; k++) {
        const uint32_t row = run->inputs + k;
        const pzs_real margin = pzs_limit_rows_margin(run->problem, k);
        const pzs_real scale = run->solver->scale[row];
        tableau->lower[row] = scale * (run->rows->lower[k] + margin);
        tableau->upper[row] = scale * (run->rows->upper[k] - margin);
        run->solver->margin[row] = scale * margin;
        largest = run->solver->margin[row] > largest ? run->solver->margin[row] : largest;
    }
    for (uint32_t i = 0; i < run->inputs; i++) {
        const pzs_real most = (tableau->upper[i] - tableau->lower[i]) / 8;
        run->solver->margin[i] = largest < most ? largest : most;
    }
    tableau->work += 2u * (uint64_t)entry_count(run);
}

/*
 * Compute the present values of all voltages and scaled sums of limit rows (limits of sums of
 * voltages).
 */
static void load_values(const rows_run *run)
{
    pzs_real *value = run->tableau->voltage;
    memcpy(value, run->optimiser->voltage, run->inputs * sizeof *value);
    for (uint32_t k = 0; k < run->rows->sums.count; k++) {
        const uint32_t row = run->inputs + k;
        value[row] =
            run->solver->scale[row] * pzs_limit_rows_sum(run->rows, k, run->optimiser->voltage);
    }
    run->tableau->work += entry_count(run);
}

/*
 * Subtract from a gradient [inputs] what the active limit rows (limits of sums of voltages)
 * contribute to it: scaled coefficients times multiplier. Returns the largest absolute contribution
 * (m2/V), from which the rounding error is estimated.
 */
pzs_real pzs_rows_subtract(const rows_run *run, pzs_real *gradient)
{
    const pzs_rows *sums = &run->rows->sums;
    pzs_real largest = 0;
    for (uint32_t k = 0; k < sums->count; k++) {
        const uint32_t row = run->inputs + k;
        const pzs_real multiplier = run->solver->scale[row] * run->tableau->direction[row];
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u] && !rows_is_free(run, row);
             at++) {
            const pzs_real force = rows_coefficient(run, k, at) * multiplier;
            gradient[sums->dof[at]] -= force;
            if (!(number_absolute(force) <= largest))
                largest = number_absolute(force);
        }
    }
    return largest;
}

/*
 * Return by how much the multiplier of quantity k (voltage or limited sum of voltages) violates the
 * optimality (KKT) conditions (m2/V); zero or negative if it does not. The permitted sign depends
 * on the bounds at which the quantity is, to within solver->margin:
 *   lower bound  positive or zero
 *   upper bound  negative or zero
 *   both bounds  any
 *   between      zero
 */
static pzs_real wrong_sign(const rows_run *run, uint32_t k, pzs_real multiplier)
{
    const pzs_real place = run->tableau->voltage[k], margin = run->solver->margin[k];
    const pzs_real lower = run->tableau->lower[k], upper = run->tableau->upper[k];
    const bool is_low = place <= lower + margin, is_high = place >= upper - margin;
    if (is_low && is_high)
        return 0;
    if (is_low)
        return -multiplier;
    return is_high ? multiplier : number_absolute(multiplier);
}

/*
 * Return the largest violation of the optimality (KKT) conditions (m2/V) by the present voltages,
 * limited sums of voltages and multipliers. Where a sum of absolute values is limited, the
 * conditions are those of voltages that keep their signs.
 *   reduced [inputs] in  gradient minus the contributions of the active limits of sums (m2/V)
 * Also stores in solver->gap the duality gap, an upper bound of the distance of half the objective
 * from its minimum (m2).
 */
static pzs_real largest_violation(const rows_run *run, const pzs_real *reduced)
{
    const pzs_optimiser *tableau = run->tableau;
    pzs_real largest = 0, gap = 0;
    for (uint32_t k = 0; k < run->count; k++) {
        if (k >= run->inputs && rows_is_free(run, k))
            continue;
        const pzs_real multiplier = k < run->inputs ? reduced[k] : tableau->direction[k];
        const pzs_real room = multiplier > 0 ? tableau->voltage[k] - tableau->lower[k]
                                             : tableau->upper[k] - tableau->voltage[k];
        const pzs_real size = wrong_sign(run, k, multiplier);
        if (number_absolute(multiplier) > 0 && room > 0)
            gap += room * number_absolute(multiplier);
        if (!(size <= largest))
            largest = size;
    }
    run->solver->gap = gap;
    return largest;
}

/*
 * Return the largest violation of the optimality (KKT) conditions (m2/V), and store the duality gap
 * in solver->gap. It includes violations by voltages at 0 V in sums of absolute values, whose other
 * sign would lower the objective.
 *   reduced [inputs] in  gradient minus the contributions of the active limits of sums (m2/V)
 */
static pzs_real total_violation(const rows_run *run, const pzs_real *reduced)
{
    const pzs_real largest = largest_violation(run, reduced);
    if (!has_absolute(run))
        return largest;
    const pzs_real crossing = run->rows->absolute_call->crossing_violation(run->control, reduced);
    return crossing > largest ? crossing : largest;
}

/*
 * Compute the violation of the optimality (KKT) conditions at the start of a round (sequence of
 * iterations), and its rounding-error bound. The array `scratch` of the optimiser receives the
 * gradient minus the contributions of the active limits of sums of voltages (m2/V).
 */
static void measure_violation(const rows_run *run)
{
    pzs_optimiser *optimiser = run->optimiser;
    pzs_real *reduced = optimiser->scratch;
    memcpy(reduced, optimiser->gradient, optimiser->width * sizeof *reduced);
    const pzs_real forces = pzs_rows_subtract(run, reduced);
    optimiser->kkt_violation = total_violation(run, reduced);
    const pzs_real bound = ROUNDING_FACTOR * (optimiser->target_rounding +
                                              optimiser->model_rounding + 4 * PZS_EPSILON * forces);
    // The gradient may nearly vanish, and with it its rounding-error bound; rounding errors alone
    // would then count as a violation of the optimality conditions. The bound is therefore at least
    // that of the first sequence of iterations (round) in the tick.
    run->solver->least_rounding =
        run->solver->least_rounding > 0 ? run->solver->least_rounding : bound;
    optimiser->rounding_bound =
        bound > run->solver->least_rounding ? bound : run->solver->least_rounding;
    run->tableau->work += entry_count(run);
}

static pzs_real largest_of(const pzs_real *vector, uint32_t count)
{
    pzs_real largest = 0;
    for (uint32_t i = 0; i < count; i++)
        largest = number_absolute(vector[i]) > largest ? number_absolute(vector[i]) : largest;
    return largest;
}

/*
 * Predict the step to the minimum of the objective over the free voltages and limited sums of
 * voltages, while the active ones are kept at their bounds. Rounding errors of the tableau affect
 * only the changes from the present values, and decay with repeated steps.
 *   scratch [inputs]        in   of run->optimiser: gradient minus the contributions of the active
 *                                limits of sums (measure_violation); overwritten
 *   next_voltage, direction out  of run->tableau: voltages and sums after the step; multipliers of
 *                                the active ones
 */
static void predict_step(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    pzs_real *reduced = run->optimiser->scratch, *next = tableau->next_voltage;
    for (uint32_t i = 0; i < run->inputs; i++) {
        if (rows_is_free(run, i))
            continue;
        tableau->direction[i] = reduced[i];
        reduced[i] = 0;
    }
    tableau->multiplier_change = largest_of(reduced, run->inputs);
    pzs_product_sum_rows(next, tableau->tableau, tableau->width, reduced, run->inputs,
                         optimiser_span(tableau));
    tableau->work += (uint64_t)run->inputs * tableau->width;
    for (uint32_t k = 0; k < run->count; k++)
        next[k] += tableau->voltage[k];
    pzs_dual_move_to_bounds(tableau);
}

/* ---- end of a round -------------------------------------------------------- */

/*
 * Bring the sum of limit row k (limit of a sum of voltages) inside its limits, which the optimiser
 * narrows by a margin for rounding errors. A sum that is outside the narrowed limits by more than
 * half of the margin is moved to the nearer one. The voltages of the row change as little as
 * possible (sum of squares) and are clamped to their bounds. Returns whether the sum was moved.
 */
static bool project_row(const rows_run *run, uint32_t k)
{
    const pzs_rows *sums = &run->rows->sums;
    const pzs_optimiser *tableau = run->tableau, *optimiser = run->optimiser;
    const uint32_t row = run->inputs + k;
    const pzs_real scale = run->solver->scale[row];
    const pzs_real sum = scale * pzs_limit_rows_sum(run->rows, k, optimiser->voltage);
    const pzs_real off = sum - number_clamp(sum, tableau->lower[row], tableau->upper[row]);
    if (!(number_absolute(off) > run->solver->margin[row] / 2))
        return false;
    pzs_real square = 0;
    for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++)
        square += scale * sums->value[at] * scale * sums->value[at];
    for (uint32_t at = sums->start[k]; square > 0 && at < sums->start[k + 1u]; at++) {
        const uint16_t input = sums->dof[at];
        const pzs_real next =
            optimiser->voltage[input] - off * scale * rows_coefficient(run, k, at) / square;
        optimiser->voltage[input] =
            number_clamp(next, tableau->lower[input], tableau->upper[input]);
    }
    return true;
}

/*
 * Correct the voltages for one limit row (limit of a sum of voltages) after the other, until every
 * sum is inside its limits. These are narrowed by a margin, so that a sum that a later correction
 * moves beyond them by rounding errors is still inside the true limits.
 */
static void project_rows(const rows_run *run)
{
    bool is_outside = true;
    for (uint32_t sweep = 0; sweep < SWEEPS && is_outside; sweep++) {
        is_outside = false;
        for (uint32_t k = 0; k < run->rows->sums.count; k++)
            is_outside |= project_row(run, k);
        run->tableau->work += entry_count(run);
    }
}

/*
 * Whether any voltage or limited sum of voltages that the optimiser keeps at a bound is away from
 * this bound by more than a sixteenth of its margin for rounding errors.
 */
static bool is_away_from_bound(const rows_run *run)
{
    const pzs_optimiser *tableau = run->tableau;
    bool is_away = false;
    for (uint32_t k = 0; k < tableau->active_count; k++) {
        const uint32_t i = tableau->order[k];
        const pzs_real bound = tableau->side[i] < 0 ? tableau->lower[i] : tableau->upper[i];
        is_away |= number_absolute(tableau->voltage[i] - bound) > run->solver->margin[i] / 16;
    }
    return is_away;
}

/*
 * Whether the sums of all limit rows (limits of sums of voltages), which load_values has
 * computed, are inside their true limits. The optimiser narrows these limits by a margin for
 * rounding errors; a sum may exceed the narrowed limits by half of this margin.
 */
static bool are_rows_inside(const rows_run *run)
{
    const pzs_optimiser *tableau = run->tableau;
    uint32_t row = run->inputs;
    while (row < run->count &&
           tableau->voltage[row] >= tableau->lower[row] - run->solver->margin[row] / 2 &&
           tableau->voltage[row] <= tableau->upper[row] + run->solver->margin[row] / 2)
        row++;
    return row == run->count;
}

/*
 * Correct the voltages for the rounding errors of the iterations, so that the active voltages and
 * limited sums of voltages are at their bounds.
 */
static void correct_active(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau, *optimiser = run->optimiser;
    memcpy(tableau->next_voltage, tableau->voltage, tableau->width * sizeof(pzs_real));
    pzs_dual_move_to_bounds(tableau);
    for (uint32_t i = 0; i < run->inputs; i++)
        if (number_is_finite(tableau->next_voltage[i]))
            optimiser->voltage[i] =
                number_clamp(tableau->next_voltage[i], tableau->lower[i], tableau->upper[i]);
    load_values(run);
}

/*
 * Move the voltages back along the straight line to those before the last iterations, as far as the
 * limits of their weighted sums require it, and compute the gradient there.
 */
static void return_inside(const rows_run *run)
{
    (void)pzs_scale_back_rows(run->problem, run->optimiser->start_voltage, run->optimiser->voltage);
    run->tableau->work += 8u * (uint64_t)entry_count(run);
    pzs_boxls_true_gradient(run->optimiser);
}

/*
 * Take the result of the iterations as the new voltages of the controller, corrected so that they
 * obey all bounds and limit rows (limits of sums of voltages) exactly. Returns false if this was
 * possible only by moving the voltages back towards those at the start of the iterations.
 */
static bool take_voltages(const rows_run *run, bool is_complete)
{
    pzs_optimiser *optimiser = run->optimiser;
    for (uint32_t i = 0; i < run->inputs; i++) {
        const pzs_real next = run->tableau->voltage[i];
        optimiser->voltage[i] = number_is_finite(next)
                                    ? number_clamp(next, optimiser->lower[i], optimiser->upper[i])
                                    : optimiser->start_voltage[i];
    }
    load_values(run);
    for (uint32_t k = 0; k < CORRECTIONS && is_complete && is_away_from_bound(run); k++)
        correct_active(run);
    if (are_rows_inside(run)) {
        pzs_boxls_true_gradient(optimiser);
        return true;
    }
    if (is_complete)
        project_rows(run);
    return_inside(run);
    return false;
}

/*
 * Shorten a round (sequence of iterations) that the work limit has stopped: move the voltages to
 * the minimum of the objective on the straight line from the voltages before the round to the
 * present ones.
 */
static void shorten_round(const rows_run *run)
{
    if (pzs_boxls_shorten(run->optimiser))
        return_inside(run);
}

/*
 * Restore the voltages and gradients that the optimiser had at the start of the present round
 * (sequence of iterations).
 */
static void undo_round(const rows_run *run)
{
    pzs_optimiser *optimiser = run->optimiser;
    const size_t bytes = optimiser->width * sizeof(pzs_real);
    memcpy(optimiser->voltage, optimiser->start_voltage, bytes);
    memcpy(optimiser->gradient, optimiser->start_gradient, bytes);
    for (uint32_t i = 0; i < run->inputs; i++)
        optimiser->model_gradient[i] = optimiser->gradient[i] + optimiser->target_gradient[i];
    optimiser->model_rounding = optimiser->start_rounding;
}

/* ---- rounds ------------------------------------------------------------------ */

/*
 * Voltages inside limit rows (limits of weighted sums of voltages) are found in rounds, until the
 * multipliers prove the voltages optimal up to rounding errors. A round starts with the gradient
 * computed from the Hessian and the sums computed from the limit rows, and ends with voltages
 * inside all bounds and limit rows:
 *   step        to the minimum over the free quantities (voltages and limited sums), with the
 *               active ones at their bounds;
 *   iterations  of the dual active-set method, until all quantities are inside their bounds and all
 *               multipliers have the right sign;
 *   correction  for rounding errors: the step is shortened if a sum is outside its limits. If the
 *               work limit has stopped the iterations, the round ends at the minimum on the part of
 *               its step that is inside all limits. A round that raises the objective is undone.
 */

/*
 * After iterations that no longer reduce the duality gap, start again with another active set or
 * with a larger shift of the Hessian. Returns whether further iterations may help.
 */
static bool start_anew(const rows_run *run)
{
    run->solver->failures++;
    run->solver->last_gap = (pzs_real)HUGE_VAL;
    // Without limited sums of absolute values, the first remedy is to free all voltages and limited
    // sums from their bounds. The shift is raised only if this has not helped in the call before.
    if (!has_absolute(run) && run->solver->failures % 2u != 0) {
        pzs_dual_free_all(run->tableau);
        return true;
    }
    // Compute the tableau (matrix of the optimiser) anew, with a larger number (shift) added to the
    // diagonal of the Hessian.
    if (run->optimiser->rebuilds >= REBUILDS || remaining_work(run) < PZS_PRODUCT_WORK(run->count))
        return false;
    run->optimiser->rebuilds++;
    raise_shift(run);
    return true;
}

/*
 * Whether the present voltages are optimal. The duality gap bounds how far half the objective is
 * above its minimum. It must be at most GAP times the scale of the objective; LOOSE_GAP suffices if
 * the violation of the optimality (KKT) conditions is below its rounding-error bound.
 */
static bool is_converged(const rows_run *run)
{
    const pzs_optimiser *optimiser = run->optimiser;
    if (!number_is_finite(optimiser->rounding_bound))
        return false;
    const pzs_real gap = run->solver->gap, energy = optimiser->target_energy;
    return gap <= GAP * energy ||
           (optimiser->kkt_violation <= optimiser->rounding_bound && gap <= LOOSE_GAP * energy);
}

/*
 * Whether the present voltages may be accepted as optimal when the optimiser makes no more
 * progress: the violation of the optimality (KKT) conditions or the duality gap is as small as
 * rounding errors permit.
 */
static bool is_acceptable(const rows_run *run)
{
    const pzs_optimiser *optimiser = run->optimiser;
    return optimiser->kkt_violation <= TOLERATED * optimiser->rounding_bound ||
           run->solver->gap <= LOOSE_GAP * optimiser->target_energy;
}

/*
 * For limited sums of absolute values, choose the signs of the voltages for the round (sequence of
 * iterations) that begins: the signs that the voltages have now.
 */
static void follow_signs(const rows_run *run)
{
    if (has_absolute(run))
        run->rows->absolute_call->follow_signs(run->control);
}

/*
 * Make the iterations of the dual active-set method until every quantity (voltage or limited sum of
 * voltages) is inside its bounds and every multiplier has a permitted value. Returns false if the
 * iterations end earlier, for example at the work limit.
 */
static bool iterate(const rows_run *run)
{
    const pzs_real rounding = run->optimiser->rounding_bound / 2;
    if (has_absolute(run))
        return run->rows->absolute_call->iterate(run->control, rounding);
    return pzs_iterate_dual(run->tableau, rounding);
}

/*
 * Make the iterations of a round: the step to the minimum over the free quantities (voltages and
 * limited sums of voltages), then the dual active-set method. The voltages that they reach become
 * the new ones; if limits of sums are violated, they are moved back towards the start as far as
 * necessary. Returns whether no voltage had to be moved back.
 */
static bool run_round(const rows_run *run)
{
    pzs_optimiser *optimiser = run->optimiser, *tableau = run->tableau;
    const size_t bytes = optimiser->width * sizeof(pzs_real);
    memcpy(optimiser->start_voltage, optimiser->voltage, bytes);
    memcpy(optimiser->start_gradient, optimiser->gradient, bytes);
    optimiser->start_rounding = optimiser->model_rounding;
    optimiser->iterations++;
    if (has_absolute(run))
        run->rows->absolute_call->resume(run->control);
    predict_step(run);
    /*
     * remaining_work has already subtracted the work of two products of the Hessian with a vector,
     * for the end of the round (sequence of iterations). The dual active-set method subtracts the
     * same work again, so it is added here.
     */
    tableau->work_limit = tableau->work + remaining_work(run) + 2u * PZS_PRODUCT_WORK(run->count);
    const bool is_complete = iterate(run);
    optimiser->is_cut = tableau->is_cut;
    const bool is_whole = take_voltages(run, is_complete);
    if (!is_complete)
        shorten_round(run);
    return is_whole;
}

/*
 * Return the largest change of the objective (m2) in the last iterations that counts as rounding.
 * It has two sources: rounding errors, and sums of voltages that move within the margins by which
 * their limits are narrowed because of rounding errors.
 */
static pzs_real change_by_rounding(const rows_run *run)
{
    const pzs_optimiser *optimiser = run->optimiser;
    const pzs_real *way = optimiser->scratch;
    const pzs_real length = PZS_SQRT(pzs_product_dot(way, way, optimiser->width));
    pzs_real allowed = 16 * PZS_EPSILON * optimiser->target_energy;
    for (uint32_t row = run->inputs; row < run->count; row++)
        if (!rows_is_free(run, row))
            allowed += 4 * run->solver->margin[row] * number_absolute(run->tableau->direction[row]);
    return allowed + length * optimiser->rounding_bound;
}

/*
 * Undo the last round (sequence of iterations) if it raised the objective by more than rounding
 * errors explain. Store for the next round whether this one made progress: last_gap becomes
 * infinite if it did, otherwise the duality gap.
 *   is_whole in  whether the voltages reached were inside all limits. If they were not, and sums of
 *                absolute values are limited, a decrease counts only if rounding errors do not
 *                explain it
 */
static void judge_round(const rows_run *run, bool is_whole)
{
    pzs_optimiser *optimiser = run->optimiser;
    const bool has_decreased = pzs_boxls_has_decreased(optimiser);
    const pzs_real change =
        pzs_product_dot(optimiser->scratch, optimiser->direction, optimiser->width);
    const pzs_real explained = change_by_rounding(run);
    const pzs_real least =
        has_absolute(run) && !is_whole ? explained : 16 * PZS_EPSILON * optimiser->target_energy;
    const pzs_real gap = run->solver->gap < LARGEST_GAP ? run->solver->gap : LARGEST_GAP;
    run->solver->last_gap = has_decreased && change < -least ? (pzs_real)HUGE_VAL : gap;
    if (!has_decreased && !(change <= explained))
        undo_round(run);
}

/*
 * Make one round (sequence of iterations) of the optimiser and keep the new voltages unless they
 * raise the objective. The tableau (matrix that gives changes of voltages, and of limited sums of
 * voltages, from changes of multipliers) must be complete. Returns whether another round may lower
 * the objective.
 */
static bool make_round(const rows_run *run)
{
    pzs_optimiser *optimiser = run->optimiser;
    follow_signs(run);
    load_values(run);
    measure_violation(run);
    optimiser->is_optimal = is_converged(run);
    if (optimiser->is_optimal)
        return false;
    const pzs_real stuck = has_absolute(run) ? ABSOLUTE_STUCK : STUCK;
    const bool is_stuck = run->solver->gap * stuck > run->solver->last_gap;
    optimiser->is_optimal = is_stuck && is_acceptable(run);
    if (optimiser->is_optimal)
        return false;
    if (is_stuck)
        return start_anew(run);
    const bool is_whole = run_round(run);
    judge_round(run, is_whole);
    return !optimiser->is_cut;
}

/*
 * Compute the rest of the optimiser's tableau (matrix that gives changes of voltages, and of
 * limited sums of voltages, from changes of multipliers) if it is incomplete. Returns whether the
 * work limit then allows another round (sequence of iterations).
 */
static bool may_make_round(const rows_run *run)
{
    const uint64_t active = run->tableau->active_count, width = run->tableau->width;
    const uint64_t work = (run->inputs + active + PZS_ROUND_LOOPS) * width + active * active +
                          SIGN_PRODUCTS * run->rows->absolute_count * PZS_PRODUCT_WORK(run->count);
    const bool is_complete = !run->tableau->is_rebuilding || complete_tableau(run);
    run->optimiser->is_cut = !is_complete || remaining_work(run) < work;
    if (run->optimiser->is_cut)
        return false;
    run->tableau->work += PZS_ROUND_LOOPS * width;
    return true;
}

/*
 * If the list of active quantities (kept at a bound) is damaged, free all voltages and limit rows
 * (limits of sums of voltages) from their bounds.
 */
static void check_active_set(const rows_run *run)
{
    uint32_t active = 0;
    for (uint32_t k = 0; k < run->count; k++)
        active += rows_is_free(run, k) ? 0u : 1u;
    if (active != run->tableau->active_count)
        pzs_dual_free_all(run->tableau);
    pzs_check_active_dual(run->tableau);
}

void pzs_optimise_rows(pzs_control *control)
{
    const rows_run run = rows_run_of(control);
    pzs_optimiser *optimiser = run.optimiser;
    bool again = true;
    optimiser->is_optimal = optimiser->is_cut = false;
    run.tableau->work = 0;
    run.tableau->iterations = 0;
    run.solver->failures = 0;
    run.solver->last_gap = (pzs_real)HUGE_VAL;
    if (optimiser->iterations == 0)
        run.solver->least_rounding = 0;
    set_scales(&run);
    load_bounds(&run);
    if (run.tableau->exchanges > run.count)
        reset_tableau(&run);
    if (!run.tableau->is_rebuilding)
        check_active_set(&run);
    pzs_boxls_gradient(optimiser);
    for (uint32_t round = 0; round < ROUNDS && again; round++)
        again = may_make_round(&run) && make_round(&run);
    optimiser->is_optimal |= !optimiser->is_cut && is_acceptable(&run);
    optimiser->iterations += run.tableau->iterations;
    optimiser->work += run.tableau->work;
}

pzs_real pzs_violation_rows(pzs_control *control, const pzs_real *gradient, uint16_t *active)
{
    const rows_run run = rows_run_of(control);
    pzs_real *reduced = control->state.optimiser.scratch;
    if (!run.tableau->is_rebuilding)
        follow_signs(&run);
    memcpy(reduced, gradient, run.inputs * sizeof *reduced);
    load_values(&run);
    (void)pzs_rows_subtract(&run, reduced);
    *active = 0;
    for (uint32_t row = run.inputs; row < run.count; row++)
        *active = (uint16_t)(*active + !rows_is_free(&run, row));
    return total_violation(&run, reduced);
}

/* ---- state of the optimiser --------------------------------------------- */

void pzs_arrange_rows(pzs_control *control, uint8_t *work)
{
    const pzs_problem *problem = control->state.problem;
    const uint32_t inputs = problem->inputs, count = inputs + limit_row_count(problem);
    const size_t width = PZS_CONTROL_WIDTH(count);
    pzs_row_solver *solver = (void *)(work + (8u - (uintptr_t)work % 8u) % 8u);
    pzs_optimiser *tableau = &solver->extended;
    pzs_real *at = (void *)((uint8_t *)solver + (sizeof *solver + 7u) / 8u * 8u);
    control->state.row_solver = solver;
    tableau->inputs = count;
    tableau->width = (uint32_t)width;
    tableau->tableau = tableau->hessian = at;
    at += count * width;
    pzs_real **const vector[] = {&tableau->voltage,   &tableau->lower,        &tableau->upper,
                                 &tableau->free_set,  &solver->scale,         &solver->margin,
                                 &tableau->direction, &tableau->scratch,      &tableau->pivot,
                                 &tableau->side,      &tableau->next_voltage, &tableau->waiting,
                                 &tableau->pending};
    for (size_t k = 0; k < sizeof vector / sizeof *vector; k++)
        *vector[k] = at + k * width;
    pzs_tableau_collect(tableau, tableau->pending);
    at += PZS_LIMIT_ROW_VECTORS * width;
    tableau->factor = at;
    tableau->order = (uint16_t *)(at + (size_t)inputs * (inputs + 1u) / 2u);
    tableau->active_most = inputs;
}

void pzs_prepare_rows(pzs_control *control)
{
    const rows_run run = rows_run_of(control);
    control->state.optimiser.work = 0;
    control->state.optimiser.work_limit = UINT64_MAX;
    set_scales(&run);
    for (uint32_t i = 0; i < run.inputs; i++)
        run.solver->scale[i] = 1;
    run.solver->least_curvature = 0;
    run.tableau->is_cut = false;
    reset_tableau(&run);
    (void)complete_tableau(&run);
}

void pzs_repair_rows(pzs_control *control)
{
    const rows_run run = rows_run_of(control);
    const size_t width = run.tableau->width;
    guard_repair_bool(&run.tableau->is_rebuilding);
    if (!(run.solver->least_curvature >= 0 && run.solver->least_curvature <= MOST_CURVATURE))
        run.solver->least_curvature = 0;
    guard_repair_bool(&run.tableau->is_cut);
    run.tableau->is_predicted = false;
    run.tableau->pending_count = 0;
    for (uint32_t k = 0; k < run.count; k++)
        run.tableau->free_set[k] = run.tableau->free_set[k] > 0 ? 1 : 0;
    for (uint32_t row = 0; row < run.count + PZS_LIMIT_ROW_VECTORS; row++)
        for (size_t k = run.count; k < width; k++)
            run.tableau->tableau[row * width + k] = 0;
}
