/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Optimiser for voltages inside bounds and limit rows (limit_rows.h): a primal active-set method
 * whose every iterate is feasible. It solves
 *
 *   minimise   (v - base)' H (v - base) / 2 + (r - t)' (v - base)
 *   subject to lower <= v <= upper,  row_lower <= A v <= row_upper
 *
 * for the voltages v, with Hessian H, base voltages, regularisation gradient r and target gradient
 * t as in boxls.h, and with the matrix A of the limit rows.
 *
 * Quantities. A quantity is the voltage of an input or the sum of a limit row. It either moves, or
 * it stays at its bound (or, for now, between its bounds) and has a multiplier: the derivative of
 * the objective by this quantity, while all moving voltages follow so that the objective is
 * minimal.
 *
 * Tableau. The symmetric matrix K = [H, -A'; -A, 0] is pivoted on the moving inputs and on the rows
 * that stay, with the exchanges of boxls_tableau.h. One row of the tableau tells how all moving
 * quantities and all multipliers respond when one quantity that stays is moved.
 *
 * Round. A round begins with the gradient computed from H and with sums computed from A.
 *   descent  go to the minimum over the moving quantities; one that meets a bound stays there.
 *   release  move a quantity whose multiplier has the wrong sign, until its multiplier is zero (the
 *            quantity then moves freely), or it meets its other bound; a moving quantity that meets
 *            its bound before stays there, and the release goes on. Where that one depends linearly
 *            on the quantities that stay, the two change their roles.
 *   end      correct the rows that stay for rounding errors of the tableau. If a sum has left its
 *            limits nevertheless, scale the step of the round back. A round that does not lower the
 *            objective is undone, but the quantities that stay are kept; after a second one in a
 *            step the tableau is computed anew.
 * Rounds repeat until the multipliers prove the voltages optimal up to rounding errors.
 *
 * Termination. This is Keller's method for quadratic programs. Each release that moves voltages
 * lowers the objective; while none moves them, released and blocking quantities are those of the
 * least index, which excludes cycles (Chang and Cottle 1980). Iterations are limited besides.
 *
 * Singular Hessian. The diagonal of H in the tableau is raised by a small shift, so that K is
 * always regular. As each round starts from the true gradient, a round is a proximal-point step:
 * the shift changes the way to the optimum and not the optimum.
 *
 * Rounding. Limit rows are narrowed by their margin, so that a sum at a narrowed limit is inside
 * the true limit whatever its rounding error.
 */
#include <string.h>
#include "limit_rows.h"
#include "boxls.h"
#include "boxls_tableau.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"

#define REBUILDS 3u /* largest number of times that the tableau is computed anew in a step */
#define ROUNDS 20u  /* largest number of rounds in one call of the optimiser */
/*
 * A violation of the optimality (KKT) conditions below this multiple of its rounding-error bound
 * counts as zero.
 */
#define ROUNDING_FACTOR 4
/* Factor by which a violation may exceed its rounding-error bound where no round lowers it. */
#define TOLERATED PZS_BY_BITS(256, 2048)
/*
 * Smallest diagonal entry that regularisation and shift together give the Hessian, relative to its
 * largest diagonal entry.
 */
#define LEAST_CURVATURE PZS_BY_BITS(PZS_R(3e-4), PZS_R(1e-9))
/*
 * Smallest pivot of a quantity that is pivoted while the tableau is computed anew, relative to that
 * of an independent one.
 */
#define LEAST_INDEPENDENCE PZS_BY_BITS(PZS_R(1e-2), PZS_R(1e-6))
/* Factor of the rounding error by which a pivot must exceed it. */
#define CERTAIN PZS_BY_BITS(16, 64)
/*
 * A quantity that stops a release stays there, and the release goes on, if at least this part of
 * its pivot is its own.
 */
#define OWN_PART PZS_R(0.01)
/* Part of the scale of the objective by which it may be above its lower bound at the end. */
#define GAP PZS_BY_BITS(PZS_R(1e-7), PZS_R(1e-11))
#define LOOSE_GAP (100 * GAP) /* the same where the rounds are used up */
/*
 * A row that stays within this multiple of its margin from a bound counts as at the bound; the next
 * step moves it there.
 */
#define NEAR_BOUND PZS_BY_BITS(2, 64)
#define SWEEPS 4u      /* largest number of projections on all rows at the end of a round */
#define CORRECTIONS 2u /* largest number of corrections of the rows at the end of a round */
/* Number of exchanges for each quantity after which the tableau is computed anew. */
#define WORN 64u

/* Optimiser with limit rows: the parts of the controller on which its functions work. */
typedef struct rows_run {
    const pzs_problem *problem;
    const pzs_limit_rows *rows;
    pzs_row_solver *solver;
    pzs_optimiser *tableau;   /* active set and vectors of inputs and limit rows */
    pzs_optimiser *optimiser; /* voltages, bounds and gradients of the inputs */
    uint32_t inputs, count;   /* number of inputs, and of inputs and limit rows */
} rows_run;

static rows_run run_of(const pzs_control *control)
{
    pzs_row_solver *solver = control->state.row_solver;
    return (rows_run){.problem = control->state.problem,
                      .rows = control->state.problem->limit_rows,
                      .solver = solver,
                      .tableau = &solver->extended,
                      .optimiser = (pzs_optimiser *)&control->state.optimiser,
                      .inputs = control->state.problem->inputs,
                      .count = solver->extended.inputs};
}

/* Whether a quantity moves: the voltage of an input in the free set, or the sum of a free row. */
static inline bool is_moving(const rows_run *run, uint32_t k)
{
    return (run->tableau->free_set[k] > 0) == (k < run->inputs);
}

static uint32_t entry_count(const rows_run *run)
{
    return run->rows->sums.start[run->rows->sums.count];
}

/*
 * Whether work of `cost` multiply-adds is within the work limit, together with the end of the
 * round: corrections, sums and true gradient.
 */
static bool affords(const rows_run *run, uint64_t cost)
{
    const uint64_t end = (CORRECTIONS + 1u) * PZS_PRODUCT_WORK(run->count) +
                         (CORRECTIONS + SWEEPS + 3u) * (uint64_t)entry_count(run);
    const uint64_t spent = run->optimiser->work + run->tableau->work;
    return spent + cost + end <= run->optimiser->work_limit;
}

/* ---- tableau -------------------------------------------------------------- */

/*
 * Return the number by which the diagonal of the Hessian is raised in the tableau (m2/V2). A
 * Hessian of zeros gets a positive diagonal, too.
 */
static pzs_real shift_of(const rows_run *run)
{
    const pzs_real stiffest = pzs_product_largest(run->optimiser->diagonal, run->optimiser->width);
    const pzs_real shift = LEAST_CURVATURE * stiffest - run->problem->regularisation;
    if (!(stiffest > 0))
        return 1;
    return shift > 0 ? shift : 0;
}

/* Begin to compute the tableau anew: nothing is pivoted, what was pivoted waits for it. */
static void reset_tableau(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    const size_t width = tableau->width, own = run->optimiser->width;
    const pzs_real shift = shift_of(run);
    memset(tableau->tableau, 0, run->count * width * sizeof(pzs_real));
    run->solver->largest_size = 0;
    for (uint32_t i = 0; i < run->inputs; i++) {
        memcpy(tableau->tableau + i * width, run->optimiser->hessian + i * own,
               run->inputs * sizeof(pzs_real));
        tableau->tableau[i * width + i] += shift;
    }
    for (uint32_t k = 0; k < run->rows->sums.count; k++)
        for (uint32_t at = run->rows->sums.start[k]; at < run->rows->sums.start[k + 1u]; at++) {
            const size_t row = run->inputs + k, input = run->rows->sums.dof[at];
            tableau->tableau[row * width + input] = -run->rows->sums.value[at];
            tableau->tableau[input * width + row] = -run->rows->sums.value[at];
        }
    for (uint32_t k = 0; k < run->count; k++) {
        const bool waits = tableau->is_rebuilding && tableau->waiting[k] > 0;
        tableau->waiting[k] = waits || tableau->free_set[k] > 0 ? 1 : 0;
        tableau->free_set[k] = 0;
    }
    tableau->pending_count = 0;
    tableau->exchanges = 0;
    tableau->is_rebuilding = true;
    tableau->work += (uint64_t)run->count * width;
    pzs_tableau_read_pivots(tableau);
}

/* Update the largest pivot of a moving quantity since the tableau was computed. */
static void note_size(const rows_run *run)
{
    pzs_real largest = run->solver->largest_size;
    for (uint32_t k = 0; k < run->count; k++) {
        const pzs_real size = number_absolute(run->tableau->pivot[k]);
        if (is_moving(run, k) && size > largest)
            largest = size;
    }
    run->solver->largest_size = largest;
}

/*
 * Return the absolute value of a pivot of a moving quantity that rounding errors may explain: the
 * quantity then depends linearly on those that stay (V2/m2).
 */
static pzs_real least_pivot(const rows_run *run)
{
    return CERTAIN * (pzs_real)run->count * PZS_EPSILON * run->solver->largest_size;
}

/* Move quantity k between those that move and those that stay. The response vector is overwritten.
 */
static void exchange(const rows_run *run, uint32_t k)
{
    pzs_tableau_row(run->tableau, k, run->tableau->next_voltage);
    pzs_tableau_exchange_side(run->tableau, k, run->tableau->next_voltage,
                              k < run->inputs ? (pzs_real)1 : (pzs_real)-1);
    note_size(run);
}

/* Return the largest diagonal entry of the Hessian in the tableau (m2/V2). */
static pzs_real stiffest_of(const rows_run *run)
{
    return pzs_product_largest(run->optimiser->diagonal, run->optimiser->width) + shift_of(run);
}

/*
 * Return the pivot of quantity k, which is not pivoted, divided by that of a stiff independent
 * quantity (1).
 */
static pzs_real independence_of(const rows_run *run, uint32_t k, pzs_real stiffest)
{
    const pzs_rows *sums = &run->rows->sums;
    pzs_real square = 0;
    if (k < run->inputs)
        return run->tableau->pivot[k] / stiffest;
    for (uint32_t at = sums->start[k - run->inputs]; at < sums->start[k - run->inputs + 1u]; at++)
        square += sums->value[at] * sums->value[at];
    return square > 0 ? -run->tableau->pivot[k] * stiffest / square : 0;
}

/*
 * Return the next quantity to pivot of those that wait, the most independent first, or the number
 * of quantities. Those that depend on the pivoted ones are left out.
 */
static uint32_t next_pivot(const rows_run *run, pzs_real stiffest)
{
    pzs_real most = LEAST_INDEPENDENCE;
    uint32_t next = run->count;
    for (uint32_t k = 0; k < run->count; k++) {
        if (!(run->tableau->waiting[k] > 0))
            continue;
        const pzs_real independence = independence_of(run, k, stiffest);
        if (independence > most) {
            most = independence;
            next = k;
        }
    }
    return next;
}

/* Continue to compute the tableau, as far as the work limit allows. Returns whether it is complete.
 */
static bool complete_tableau(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real stiffest = stiffest_of(run);
    while (tableau->is_rebuilding && affords(run, PZS_ITERATION_WORK(run->count))) {
        const uint32_t k = next_pivot(run, stiffest);
        tableau->is_rebuilding = k < run->count;
        if (tableau->is_rebuilding) {
            exchange(run, k);
            tableau->waiting[k] = 0;
        }
        tableau->work += tableau->width;
    }
    pzs_tableau_apply(tableau);
    return !tableau->is_rebuilding;
}

/*
 * Compute the response of all quantities to quantity k, which stays: by how much each moving
 * quantity and each multiplier change when quantity k rises by 1 V, into next_voltage. Returns the
 * change of the multiplier of k itself.
 */
static pzs_real find_response(const rows_run *run, uint32_t k)
{
    pzs_real *response = run->tableau->next_voltage;
    pzs_tableau_row(run->tableau, k, response);
    for (uint32_t j = 0; j < run->count; j++) {
        const bool is_active_input = j < run->inputs && !(run->tableau->free_set[j] > 0);
        if (is_active_input != (k < run->inputs))
            response[j] = -response[j];
    }
    return response[k];
}

/* ---- start of a round ------------------------------------------------------ */

/*
 * Compute present value, bounds and margin of all quantities. The margin of an input is the largest
 * one of a row, because rows at their narrowed limits may have to move it by so much, but at most
 * an eighth of the distance of its bounds.
 */
static void load_quantities(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    const size_t bytes = run->inputs * sizeof(pzs_real);
    memcpy(tableau->voltage, run->optimiser->voltage, bytes);
    memcpy(tableau->lower, run->optimiser->lower, bytes);
    memcpy(tableau->upper, run->optimiser->upper, bytes);
    pzs_real largest = 0;
    for (uint32_t k = 0; k < run->rows->sums.count; k++) {
        const uint32_t row = run->inputs + k;
        const pzs_real margin = pzs_limit_rows_margin(run->problem, k);
        run->solver->margin[row] = margin;
        tableau->lower[row] = run->rows->lower[k] + margin;
        tableau->upper[row] = run->rows->upper[k] - margin;
        tableau->voltage[row] = pzs_limit_rows_sum(run->rows, k, run->optimiser->voltage);
        largest = margin > largest ? margin : largest;
    }
    for (uint32_t i = 0; i < run->inputs; i++) {
        const pzs_real most = (tableau->upper[i] - tableau->lower[i]) / 8;
        run->solver->margin[i] = largest < most ? largest : most;
    }
    tableau->work += 2u * (uint64_t)entry_count(run);
}

/*
 * Return the bound at which a row stays whose sum differs from the bound by rounding errors only;
 * otherwise its sum (V).
 */
static pzs_real place_of_row(const rows_run *run, uint32_t row)
{
    const pzs_optimiser *tableau = run->tableau;
    const pzs_real sum = tableau->voltage[row], most = NEAR_BOUND * run->solver->margin[row];
    if (number_absolute(sum - tableau->upper[row]) <= most)
        return tableau->upper[row];
    if (number_absolute(sum - tableau->lower[row]) <= most)
        return tableau->lower[row];
    return sum;
}

/*
 * Subtract from a gradient [inputs] the forces of the rows that stay: coefficients times
 * multiplier. Returns the largest force, which scales the rounding error (m2/V).
 *   multiplier [quantities] in  (m2/V)
 */
static pzs_real subtract_rows(const rows_run *run, const pzs_real *multiplier, pzs_real *gradient)
{
    const pzs_rows *sums = &run->rows->sums;
    pzs_real largest = 0;
    for (uint32_t k = 0; k < sums->count; k++) {
        const uint32_t row = run->inputs + k;
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u] && !is_moving(run, row); at++) {
            const pzs_real force = sums->value[at] * multiplier[row];
            gradient[sums->dof[at]] -= force;
            if (!(number_absolute(force) <= largest))
                largest = number_absolute(force);
        }
    }
    return largest;
}

/*
 * Set the right side of the equations for the step: the gradient of the moving inputs without the
 * forces of the present multipliers, and the distances of the rows that stay from their places.
 */
static void set_right_side(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    pzs_real *right_side = tableau->scratch;
    for (uint32_t row = run->inputs; row < run->count; row++)
        if (is_moving(run, row) || !number_is_finite(tableau->direction[row]))
            tableau->direction[row] = 0;
    memset(right_side, 0, tableau->width * sizeof *right_side);
    memcpy(right_side, run->optimiser->gradient, run->inputs * sizeof *right_side);
    (void)subtract_rows(run, tableau->direction, right_side);
    for (uint32_t i = 0; i < run->inputs; i++) {
        tableau->direction[i] = right_side[i];
        right_side[i] = is_moving(run, i) ? right_side[i] : 0;
    }
    for (uint32_t row = run->inputs; row < run->count; row++) {
        if (is_moving(run, row))
            continue;
        const pzs_real place = place_of_row(run, row);
        right_side[row] = place - tableau->voltage[row];
        tableau->voltage[row] = place;
    }
    tableau->work += entry_count(run);
}

/*
 * Compute the step to the minimum over the moving quantities: for those the step itself (V), for
 * the others the multiplier after the step (m2/V), into `direction`. Rows that stay are moved to
 * their bounds exactly. The step is a correction of the present multipliers, so that rounding
 * errors of the tableau vanish from round to round.
 */
static void find_direction(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    pzs_real *direction = tableau->direction, *change = tableau->next_voltage;
    set_right_side(run);
    pzs_product_sum_rows(change, tableau->tableau, tableau->width, tableau->scratch, run->count,
                         optimiser_span(tableau));
    tableau->work += PZS_PRODUCT_WORK(run->count);
    pzs_real slope = 0;
    for (uint32_t k = 0; k < run->count; k++) {
        const bool is_input = k < run->inputs;
        if (is_input && is_moving(run, k))
            slope += tableau->scratch[k] * change[k];
        if (is_moving(run, k))
            direction[k] = change[k];
        else
            direction[k] += is_input ? -change[k] : change[k];
    }
    run->solver->predicted_decrease = -slope / 2;
}

/*
 * Return the violation of the KKT conditions by the multiplier of quantity k, which stays (m2/V);
 * it is zero or negative where they hold. A quantity within its margin from a bound counts as at
 * the bound.
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

/* Return the largest absolute coefficient of a limit row, which scales its multiplier. */
static pzs_real coefficient_of(const rows_run *run, uint32_t row)
{
    const pzs_rows *sums = &run->rows->sums;
    const uint32_t k = row - run->inputs;
    pzs_real most = 0;
    for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++)
        most = number_absolute(sums->value[at]) > most ? number_absolute(sums->value[at]) : most;
    return most;
}

/*
 * Return the largest KKT violation with the multipliers in `direction`, from the gradient and the
 * rows alone (m2/V).
 *   reduced [inputs] in  gradient minus the forces of the rows that stay
 */
static pzs_real largest_violation(const rows_run *run, const pzs_real *reduced)
{
    const pzs_optimiser *tableau = run->tableau, *optimiser = run->optimiser;
    pzs_real largest = 0, gap = 0;
    for (uint32_t k = 0; k < run->count; k++) {
        pzs_real size = 0;
        if (k < run->inputs) {
            const bool falls = reduced[k] > 0;
            const pzs_real room = falls ? optimiser->voltage[k] - optimiser->lower[k]
                                        : optimiser->upper[k] - optimiser->voltage[k];
            gap += room > 0 ? room * number_absolute(reduced[k]) : 0;
            size = wrong_sign(run, k, reduced[k]);
        }
        if (k >= run->inputs && !is_moving(run, k))
            size = wrong_sign(run, k, tableau->direction[k]) * coefficient_of(run, k);
        if (!(size <= largest))
            largest = size;
    }
    run->solver->gap = gap;
    return largest;
}

/*
 * Compute KKT violation and rounding-error bound of the optimiser at the start of a round. The
 * bound is not below that at the start of the step, so that an optimum at zero counts as found.
 */
static void measure_violation(const rows_run *run)
{
    pzs_optimiser *optimiser = run->optimiser;
    pzs_real *reduced = optimiser->scratch;
    memcpy(reduced, optimiser->gradient, optimiser->width * sizeof *reduced);
    const pzs_real forces = subtract_rows(run, run->tableau->direction, reduced);
    optimiser->kkt_violation = largest_violation(run, reduced);
    const pzs_real bound = ROUNDING_FACTOR * (optimiser->target_rounding +
                                              optimiser->model_rounding + 4 * PZS_EPSILON * forces);
    run->solver->least_rounding =
        run->solver->least_rounding > 0 ? run->solver->least_rounding : bound;
    optimiser->rounding_bound =
        bound > run->solver->least_rounding ? bound : run->solver->least_rounding;
    run->tableau->work += 2u * (uint64_t)entry_count(run);
}

/* ---- iterations ------------------------------------------------------------ */

typedef struct stop {
    pzs_real part;     /* part of a way after which the first moving quantity meets a bound */
    uint32_t quantity; /* this quantity; the number of quantities if none meets a bound */
} stop;

/*
 * Whether a moving quantity is linearly independent of those that stay, so that it can stop a way.
 *   way        in  change of this quantity on the way
 *   curvature  in  second derivative of the objective along the way (m2/V2), or 0
 */
static inline bool may_stop(const rows_run *run, uint32_t k, pzs_real way, pzs_real curvature)
{
    const pzs_real own = number_absolute(run->tableau->pivot[k]);
    const pzs_real added = curvature > 0 ? way * way / curvature : 0;
    return own + added > least_pivot(run);
}

/* Find the first moving quantity that meets a bound within `most` times sense * way (V). */
static stop first_stop(const rows_run *run, const pzs_real *way, pzs_real sense, pzs_real most,
                       pzs_real curvature)
{
    const pzs_optimiser *tableau = run->tableau;
    stop first = {most, run->count};
    for (uint32_t k = 0; k < run->count; k++) {
        if (!is_moving(run, k))
            continue;
        const pzs_real step = sense * way[k], size = number_absolute(step);
        const pzs_real to_bound = step < 0 ? tableau->voltage[k] - tableau->lower[k]
                                           : tableau->upper[k] - tableau->voltage[k];
        const pzs_real room = to_bound > 0 ? to_bound : 0;
        if (room < first.part * size && may_stop(run, k, way[k], curvature)) {
            first.part = room / size;
            first.quantity = k;
        }
    }
    return first;
}

/* Move all moving quantities by `part` times a way; the one that meets its bound arrives there. */
static void move_along(const rows_run *run, const pzs_real *way, pzs_real part, stop first)
{
    pzs_optimiser *tableau = run->tableau;
    for (uint32_t k = 0; k < run->count; k++) {
        if (!is_moving(run, k))
            continue;
        const pzs_real next = tableau->voltage[k] + part * way[k];
        tableau->voltage[k] = number_clamp(next, tableau->lower[k], tableau->upper[k]);
    }
    if (first.quantity < run->count) {
        const bool falls = part * way[first.quantity] < 0 ||
                           (!(part * way[first.quantity] > 0) &&
                            tableau->voltage[first.quantity] <= tableau->lower[first.quantity]);
        tableau->voltage[first.quantity] =
            falls ? tableau->lower[first.quantity] : tableau->upper[first.quantity];
    }
}

/* Let a moving quantity stay where it is; the rest of its step is taken out of the direction. */
static void stop_moving(const rows_run *run, uint32_t k)
{
    pzs_real *direction = run->tableau->direction;
    const pzs_real *response = run->tableau->next_voltage;
    const pzs_real remaining = direction[k];
    exchange(run, k);
    (void)find_response(run, k);
    direction[k] = 0;
    for (uint32_t j = 0; j < run->count; j++)
        direction[j] -= remaining * response[j];
}

/* Count one more iteration if the work limit allows it. Returns whether it may be made. */
static bool may_iterate(const rows_run *run)
{
    run->optimiser->is_cut = !affords(run, 2u * PZS_ITERATION_WORK(run->count));
    if (run->optimiser->is_cut)
        return false;
    run->optimiser->iterations++;
    run->tableau->work += PZS_ITERATION_LOOPS * run->tableau->width;
    return true;
}

/*
 * Make one descent iteration: move along the direction to its end or to the first bound. Returns
 * whether a bound stopped the move.
 */
static bool descend(const rows_run *run)
{
    pzs_real *direction = run->tableau->direction;
    const stop first = first_stop(run, direction, 1, 1, 0);
    move_along(run, direction, first.part, first);
    if (first.quantity == run->count)
        return false;
    for (uint32_t k = 0; k < run->count; k++)
        if (is_moving(run, k))
            direction[k] *= 1 - first.part;
    stop_moving(run, first.quantity);
    return true;
}

/*
 * Choose the quantity to release: the one with the largest KKT violation, or, where iterations have
 * moved nothing, the first one. Returns the number of quantities if none violates the KKT
 * conditions.
 */
static uint32_t next_release(const rows_run *run, pzs_real rounding)
{
    const pzs_optimiser *tableau = run->tableau;
    pzs_real most = rounding;
    uint32_t next = run->count;
    for (uint32_t k = 0; k < run->count; k++) {
        if (is_moving(run, k))
            continue;
        const pzs_real scale = k < run->inputs ? 1 : coefficient_of(run, k);
        const pzs_real size = scale * wrong_sign(run, k, tableau->direction[k]);
        if (!(size > most))
            continue;
        most = size;
        next = k;
        if (run->solver->is_least_index)
            break;
    }
    return next;
}

/*
 * Let quantity k, which stays, move, and the moving quantity `other`, which has met its bound,
 * stay. The direction becomes the step to the minimum over the quantities that move then.
 */
static void change_roles(const rows_run *run, uint32_t k, uint32_t other, pzs_real curvature)
{
    pzs_real *direction = run->tableau->direction;
    const pzs_real *response = run->tableau->next_voltage;
    const pzs_real rest = -direction[k] / curvature;
    for (uint32_t j = 0; j < run->count; j++)
        direction[j] = is_moving(run, j) ? rest * response[j] : direction[j] + rest * response[j];
    direction[k] = rest;
    exchange(run, k);
    stop_moving(run, other);
}

/* Move quantity k, which stays, by `way` (V); all moving quantities and multipliers follow. */
static void move_released(const rows_run *run, uint32_t k, pzs_real way, stop first)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real *response = tableau->next_voltage;
    move_along(run, response, way, first);
    for (uint32_t j = 0; j < run->count; j++)
        if (!is_moving(run, j))
            tableau->direction[j] += way * response[j];
    tableau->voltage[k] =
        number_clamp(tableau->voltage[k] + way, tableau->lower[k], tableau->upper[k]);
    run->solver->is_least_index = !(number_absolute(way) > 0);
}

/* What a release leaves to do. */
typedef enum release_end {
    RELEASE_DONE,    /* the moving quantities are at their minimum again */
    RELEASE_GOES_ON, /* a moving quantity met its bound and stays; the release is to be repeated */
    RELEASE_DESCENDS /* released and blocking quantity changed their roles: a descent follows */
} release_end;

/* Let a moving quantity that has stopped the release of quantity k stay at its bound. */
static release_end stop_release(const rows_run *run, uint32_t k, uint32_t other, pzs_real curvature)
{
    const pzs_real response = run->tableau->next_voltage[other];
    const pzs_real own = number_absolute(run->tableau->pivot[other]);
    if (curvature > 0 && !(own * curvature > OWN_PART * response * response)) {
        change_roles(run, k, other, curvature);
        return RELEASE_DESCENDS;
    }
    exchange(run, other);
    run->tableau->direction[other] = 0;
    return RELEASE_GOES_ON;
}

/*
 * Make one iteration of a release: move quantity k, which violates the KKT conditions, until its
 * multiplier is zero or a bound is met.
 */
static release_end release(const rows_run *run, uint32_t k)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real curvature = find_response(run, k);
    const bool falls = tableau->direction[k] > 0;
    const pzs_real room =
        falls ? tableau->voltage[k] - tableau->lower[k] : tableau->upper[k] - tableau->voltage[k];
    const pzs_real slope = number_absolute(tableau->direction[k]);
    const bool has_minimum = slope < room * curvature;
    const pzs_real sense = falls ? (pzs_real)-1 : (pzs_real)1;
    const stop first = first_stop(run, tableau->next_voltage, sense,
                                  has_minimum ? slope / curvature : room, curvature);
    if (!number_is_finite(first.part)) {
        tableau->direction[k] = 0;
        return RELEASE_DONE;
    }
    move_released(run, k, sense * first.part, first);
    if (first.quantity < run->count)
        return stop_release(run, k, first.quantity, curvature);
    if (has_minimum) {
        exchange(run, k);
        tableau->direction[k] = 0;
    } else {
        tableau->voltage[k] = falls ? tableau->lower[k] : tableau->upper[k];
    }
    return RELEASE_DONE;
}

/* Make descent iterations until no bound stops them, or the work limit does. */
static void descend_fully(const rows_run *run)
{
    bool is_blocked = true;
    while (is_blocked && may_iterate(run))
        is_blocked = descend(run);
}

/* Iterate until the tableau predicts no KKT violation: first descents, then releases. */
static void iterate(const rows_run *run)
{
    const uint32_t most = run->optimiser->iterations + 8u * run->count + 16u;
    const pzs_real rounding = run->optimiser->rounding_bound / 2;
    descend_fully(run);
    while (!run->optimiser->is_cut && run->optimiser->iterations < most) {
        const uint32_t k = next_release(run, rounding);
        release_end end = RELEASE_GOES_ON;
        if (k == run->count)
            break;
        while (end == RELEASE_GOES_ON && may_iterate(run))
            end = release(run, k);
        if (end == RELEASE_DESCENDS)
            descend_fully(run);
    }
    pzs_tableau_apply(run->tableau);
}

/* ---- end of a round -------------------------------------------------------- */

/*
 * Correct the voltages of the moving inputs so that the rows that stay have the sums at which they
 * stay. Returns false if there was nothing to correct.
 */
static bool correct_rows(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    pzs_real *right_side = tableau->scratch, *change = tableau->next_voltage;
    bool is_off = false;
    memset(right_side, 0, tableau->width * sizeof *right_side);
    for (uint32_t k = 0; k < run->rows->sums.count; k++) {
        const uint32_t row = run->inputs + k;
        if (is_moving(run, row))
            continue;
        const pzs_real sum = pzs_limit_rows_sum(run->rows, k, run->optimiser->voltage);
        right_side[row] = tableau->voltage[row] - sum;
        is_off |= number_absolute(right_side[row]) > run->solver->margin[row] / 16;
    }
    tableau->work += entry_count(run);
    if (!is_off)
        return false;
    pzs_product_sum_rows(change, tableau->tableau, tableau->width, right_side, run->count,
                         optimiser_span(tableau));
    tableau->work += PZS_PRODUCT_WORK(run->count);
    for (uint32_t i = 0; i < run->inputs; i++)
        if (tableau->free_set[i] > 0 && number_is_finite(change[i]))
            run->optimiser->voltage[i] =
                number_clamp(run->optimiser->voltage[i] + change[i], run->optimiser->lower[i],
                             run->optimiser->upper[i]);
    return true;
}

/*
 * Move the inputs of a row whose sum is outside its narrowed limits by the shortest way to these,
 * inside their bounds. Returns whether the row was outside by more than half of its margin.
 */
static bool project_row(const rows_run *run, uint32_t k)
{
    const pzs_rows *sums = &run->rows->sums;
    const pzs_optimiser *tableau = run->tableau, *optimiser = run->optimiser;
    const uint32_t row = run->inputs + k;
    const pzs_real sum = pzs_limit_rows_sum(run->rows, k, optimiser->voltage);
    const pzs_real off = sum - number_clamp(sum, tableau->lower[row], tableau->upper[row]);
    if (!(number_absolute(off) > run->solver->margin[row] / 2))
        return false;
    pzs_real square = 0;
    for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++)
        square += sums->value[at] * sums->value[at];
    for (uint32_t at = sums->start[k]; square > 0 && at < sums->start[k + 1u]; at++) {
        const uint16_t input = sums->dof[at];
        const pzs_real next = optimiser->voltage[input] - off * sums->value[at] / square;
        optimiser->voltage[input] =
            number_clamp(next, optimiser->lower[input], optimiser->upper[input]);
    }
    return true;
}

/*
 * Project the voltages on the rows outside their narrowed limits, one row after the other. The ways
 * are of the size of rounding errors, so that rows at their narrowed limits stay inside the true
 * ones.
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

/* Take the voltages of the iterations over, inside all bounds and limit rows to the last bit. */
static void take_voltages(const rows_run *run)
{
    pzs_optimiser *optimiser = run->optimiser;
    for (uint32_t i = 0; i < run->inputs; i++) {
        const pzs_real next = run->tableau->voltage[i];
        optimiser->voltage[i] = number_is_finite(next)
                                    ? number_clamp(next, optimiser->lower[i], optimiser->upper[i])
                                    : optimiser->start_voltage[i];
    }
    for (uint32_t k = 0; k < CORRECTIONS && correct_rows(run); k++)
        continue;
    project_rows(run);
    (void)pzs_scale_back_rows(run->problem, optimiser->start_voltage, optimiser->voltage);
    run->tableau->work += 2u * (uint64_t)entry_count(run);
    pzs_boxls_true_gradient(optimiser);
}

/* Return to voltages and gradients at the start of the round. */
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

/* Begin to compute the tableau anew. Returns whether that is allowed once more in this step. */
static bool renew_tableau(const rows_run *run)
{
    if (run->optimiser->rebuilds >= REBUILDS || !affords(run, PZS_PRODUCT_WORK(run->count)))
        return false;
    run->optimiser->rebuilds++;
    reset_tableau(run);
    return true;
}

/* Whether the whole step along the direction violates no bound and leaves no wrong multiplier. */
static bool is_open(const rows_run *run)
{
    const pzs_optimiser *tableau = run->tableau;
    const pzs_real rounding = run->optimiser->rounding_bound / 2;
    const stop first = first_stop(run, tableau->direction, 1, 1, 0);
    return first.quantity == run->count && next_release(run, rounding) == run->count;
}

/* Whether the whole step would lower the objective by no more than rounding errors explain. */
static bool is_negligible(const rows_run *run)
{
    return run->solver->predicted_decrease <= 4 * PZS_EPSILON * run->optimiser->target_energy;
}

/*
 * Whether the voltages are optimal at the start of a round: no KKT violation exceeds its
 * rounding-error bound, or no voltages inside the bounds have an objective that is lower by more
 * than GAP times its scale, target_energy.
 */
static bool is_converged(const rows_run *run, bool is_whole)
{
    const pzs_optimiser *optimiser = run->optimiser;
    if (!number_is_finite(optimiser->rounding_bound))
        return false;
    return optimiser->kkt_violation <= optimiser->rounding_bound ||
           (is_whole && run->solver->gap <= GAP * optimiser->target_energy);
}

/* Make one round with a complete tableau. Returns whether another round may help. */
static bool make_round(const rows_run *run)
{
    pzs_optimiser *optimiser = run->optimiser;
    const size_t bytes = optimiser->width * sizeof(pzs_real);
    load_quantities(run);
    find_direction(run);
    measure_violation(run);
    pzs_tableau_read_pivots(run->tableau);
    run->solver->is_least_index = false;
    const bool is_whole = is_open(run), is_small = is_whole && is_negligible(run);
    optimiser->is_optimal = is_converged(run, is_whole);
    if (optimiser->is_optimal)
        return false;
    const bool is_stuck = is_whole && optimiser->kkt_violation * 4 > run->solver->last_violation;
    run->solver->last_violation = optimiser->kkt_violation;
    if (is_stuck && renew_tableau(run))
        return true;
    memcpy(optimiser->start_voltage, optimiser->voltage, bytes);
    memcpy(optimiser->start_gradient, optimiser->gradient, bytes);
    optimiser->start_rounding = optimiser->model_rounding;
    if (is_whole) {
        move_along(run, run->tableau->direction, 1, (stop){1, run->count});
        optimiser->iterations++;
    } else {
        iterate(run);
    }
    take_voltages(run);
    optimiser->is_optimal =
        is_small || (is_whole && run->solver->gap <= LOOSE_GAP * optimiser->target_energy);
    if (is_small || pzs_boxls_has_decreased(optimiser))
        return !optimiser->is_cut;
    undo_round(run);
    run->solver->failures++;
    if (optimiser->is_cut)
        return false;
    return run->solver->failures % 2u != 0 || renew_tableau(run);
}

/* Complete the tableau. Returns whether the remaining work allows a round. */
static bool may_make_round(const rows_run *run)
{
    const bool is_complete = !run->tableau->is_rebuilding || complete_tableau(run);
    run->optimiser->is_cut =
        !is_complete || !affords(run, PZS_ROUND_WORK(run->count) + 4u * (uint64_t)entry_count(run));
    if (run->optimiser->is_cut)
        return false;
    run->tableau->work += PZS_ROUND_LOOPS * run->tableau->width;
    return true;
}

void pzs_optimise_rows(pzs_control *control)
{
    const rows_run run = run_of(control);
    pzs_optimiser *optimiser = run.optimiser;
    bool again = true;
    optimiser->is_optimal = optimiser->is_cut = false;
    run.tableau->work = 0;
    run.solver->last_violation = (pzs_real)HUGE_VAL;
    run.solver->failures = 0;
    if (optimiser->iterations == 0)
        run.solver->least_rounding = 0;
    if (run.tableau->exchanges > WORN * run.count && renew_tableau(&run))
        optimiser->rebuilds = 0;
    pzs_boxls_gradient(optimiser);
    for (uint32_t round = 0; round < ROUNDS && again; round++)
        again = may_make_round(&run) && make_round(&run);
    /*
     * A violation slightly above its rounding-error bound is accepted, because rounding errors
     * prevent a lower one.
     */
    optimiser->is_optimal |=
        !optimiser->is_cut && optimiser->kkt_violation <= TOLERATED * optimiser->rounding_bound;
    optimiser->work += run.tableau->work;
}

pzs_real pzs_violation_rows(const pzs_control *control, const pzs_real *gradient, uint16_t *active)
{
    const rows_run run = run_of(control);
    pzs_real *reduced = control->state.optimiser.scratch;
    memcpy(reduced, gradient, run.inputs * sizeof *reduced);
    (void)subtract_rows(&run, run.tableau->direction, reduced);
    *active = 0;
    for (uint32_t row = run.inputs; row < run.count; row++)
        *active = (uint16_t)(*active + !is_moving(&run, row));
    return largest_violation(&run, reduced);
}

/* ---- state ------------------------------------------------------------------ */

void pzs_arrange_rows(pzs_control *control, uint8_t *work)
{
    const pzs_problem *problem = control->state.problem;
    const uint32_t count = problem->inputs + limit_row_count(problem);
    const size_t width = PZS_CONTROL_WIDTH(count);
    pzs_row_solver *solver = (void *)(work + (8u - (uintptr_t)work % 8u) % 8u);
    pzs_optimiser *tableau = &solver->extended;
    pzs_real *at = (void *)((uint8_t *)solver + (sizeof *solver + 7u) / 8u * 8u);
    control->state.row_solver = solver;
    tableau->inputs = count;
    tableau->width = (uint32_t)width;
    tableau->tableau = tableau->hessian = at;
    at += count * width;
    pzs_real **const vector[] = {&tableau->voltage,  &tableau->lower,     &tableau->upper,
                                 &tableau->free_set, &tableau->direction, &tableau->scratch,
                                 &tableau->pivot,    &tableau->waiting,   &tableau->next_voltage,
                                 &solver->margin,    &tableau->pending};
    for (size_t k = 0; k < sizeof vector / sizeof *vector; k++)
        *vector[k] = at + k * width;
}

void pzs_prepare_rows(pzs_control *control)
{
    const rows_run run = run_of(control);
    for (uint32_t k = 0; k < run.count; k++)
        run.tableau->free_set[k] = k < run.inputs ? 1 : 0;
    control->state.optimiser.work = 0;
    control->state.optimiser.work_limit = UINT64_MAX;
    reset_tableau(&run);
    (void)complete_tableau(&run);
}

void pzs_repair_rows(pzs_control *control)
{
    const rows_run run = run_of(control);
    const size_t width = run.tableau->width;
    guard_repair_bool(&run.tableau->is_rebuilding);
    guard_repair_bool(&run.solver->is_least_index);
    run.tableau->pending_count = 0;
    for (uint32_t k = 0; k < run.count; k++)
        run.tableau->free_set[k] = run.tableau->free_set[k] > 0 ? 1 : 0;
    for (uint32_t row = 0; row < run.count + PZS_LIMIT_ROW_VECTORS; row++)
        for (size_t k = run.count; k < width; k++)
            run.tableau->tableau[row * width + k] = 0;
}
