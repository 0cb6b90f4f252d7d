/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Optimiser for voltages inside bounds and limit rows, which are limits of weighted sums of
 * voltages (limit_rows.h): a primal active-set method whose every iterate is feasible. It solves
 *
 *   minimise   (v - base)' H (v - base) / 2 + (r - t)' (v - base)
 *   subject to lower <= v <= upper,  row_lower <= A v <= row_upper
 *
 * for the voltages v. H is the Hessian, `base` are the voltages around which the gradient is
 * computed, r is the gradient of the regularisation there, t that of the target, and A is the
 * matrix of the limit rows.
 *
 * Quantities. A quantity is the voltage of an input or the sum of a limit row. A quantity is either
 * free, or active: kept at its bound (or, until the next release, between its bounds). An active
 * quantity has a multiplier: the derivative of the objective with respect to this quantity, if all
 * free voltages follow so that the objective is minimal.
 *
 * Tableau. The tableau (pivoted matrix) is the symmetric matrix K = [H, -A'; -A, 0] after a pivot
 * exchange (boxls_tableau.h) for each free input and each active row. One row of the tableau states
 * how all free quantities and all multipliers respond to a change of one active quantity.
 *
 * Round. A round is a sequence of iterations. At its start the gradient is computed from H and the
 * sums of the limit rows from A. Then follow
 *
 *   descents    steps to the minimum over the free quantities; a quantity that reaches a bound
 *               becomes active, and the descent continues;
 *   releases    changes of an active quantity whose multiplier has the wrong sign, until its
 *               multiplier is zero (the quantity is then free), or until it reaches its other
 *               bound. A free quantity that reaches a bound before becomes active, and the release
 *               continues. If this quantity depends linearly on the active ones, the released
 *               quantity becomes free at the same time;
 *   correction  of the active rows for rounding errors of the tableau. If a sum is outside its
 *               limits nevertheless, the step of the round is shortened. A round that does not
 *               lower the objective is undone, but its active set is kept; after a second such
 *               round in a control step the tableau is computed anew.
 *
 * Rounds are repeated until the multipliers prove the voltages optimal up to rounding errors.
 *
 * Termination. This is Keller's method for quadratic programs. Each release that changes voltages
 * lowers the objective. While releases change no voltage, the released and the blocking quantity
 * are those of the least index, which excludes cycles (Chang and Cottle 1980). The number of
 * iterations is limited, too.
 *
 * Singular Hessian. The diagonal of H in the tableau is raised by a small shift, so that K is
 * always regular. As each round starts from the true gradient, a round is a proximal-point step:
 * the shift changes the iterates but not the optimum.
 *
 * Rounding. The optimiser narrows the limits of each row by a margin for rounding errors, so that a
 * sum at a narrowed limit is inside the true limit.
 */
#include <string.h>
#include "limit_rows.h"
#include "boxls.h"
#include "boxls_tableau.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * Largest number of times that the optimiser for limit rows (limits of sums of voltages) computes
 * its pivoted matrix (tableau) anew in a control step.
 */
#define REBUILDS 3u
/*
 * Largest number of rounds (sequences of iterations) in one call of the optimiser for limit rows
 * (limits of sums of voltages).
 */
#define ROUNDS 20u
/*
 * A violation of the optimality (KKT) conditions counts as zero if it is below this multiple of its
 * rounding-error bound.
 */
#define ROUNDING_FACTOR 4
/*
 * The voltages are accepted as optimal if no round of iterations lowers the violation of the
 * optimality (KKT) conditions any more and it is below this multiple of its rounding-error bound.
 */
#define TOLERATED PZS_BY_BITS(256, 2048)
/*
 * Smallest diagonal entry that the Hessian, including regularisation and a shift of the whole
 * diagonal by the optimiser, may have, relative to its largest diagonal entry.
 */
#define LEAST_CURVATURE PZS_BY_BITS(PZS_R(3e-4), PZS_R(1e-9))
/*
 * While the tableau (matrix of the optimiser) is computed anew, a voltage or limit row (limit of a
 * sum of voltages) is left out if it depends almost linearly on those that were already eliminated:
 * its pivot must exceed this fraction of the pivot that a linearly independent voltage or row of
 * high stiffness would have.
 */
#define LEAST_INDEPENDENCE PZS_BY_BITS(PZS_R(1e-2), PZS_R(1e-6))
/* A pivot counts as different from zero only if it exceeds this multiple of its rounding error. */
#define CERTAIN PZS_BY_BITS(16, 64)
/*
 * While the optimiser moves a voltage, or a limited sum of voltages (limit row), away from its
 * bound, another one may reach a bound. If the other one is linearly independent of the moved one,
 * it is kept at its bound, and the move goes on. It counts as independent if the part of its pivot
 * that does not come from the moved one exceeds this fraction of the part that does.
 */
#define OWN_PART PZS_R(0.01)
/*
 * The voltages are accepted as optimal if the objective exceeds a lower bound of its minimum by no
 * more than this fraction of target_energy, the scale of the objective.
 */
#define GAP PZS_BY_BITS(PZS_R(1e-7), PZS_R(1e-11))
/*
 * Bound for a complete step to the minimum: the fraction of target_energy, the scale of the
 * objective, by which the objective may then exceed a lower bound of its minimum.
 */
#define LOOSE_GAP (100 * GAP)
/*
 * An active limit row (limit of a sum of voltages) counts as at its bound if its distance from the
 * bound is below this multiple of the margin by which rows are narrowed against rounding errors.
 * The next step then moves the row to its bound.
 */
#define NEAR_BOUND PZS_BY_BITS(2, 64)
/*
 * Largest number of projections of the voltages on all limit rows (limits of sums of voltages) at
 * the end of a round of iterations.
 */
#define SWEEPS 4u
/*
 * Largest number of corrections of the active limit rows (limits of sums of voltages) at the end of
 * a round of iterations.
 */
#define CORRECTIONS 2u
/*
 * The optimiser computes its pivoted matrix (tableau) anew after this number of pivot exchanges,
 * multiplied by the number of inputs and limit rows (limits of sums of voltages), because each
 * exchange adds rounding errors.
 */
#define WORN 64u

/*
 * The parts of the controller on which the optimiser with limit rows (limits of sums of voltages)
 * works.
 */
typedef struct rows_run {
    const pzs_problem *problem;
    const pzs_limit_rows *rows;
    pzs_row_solver *solver;
    pzs_optimiser *tableau; /* tableau (pivoted matrix), active set, bounds and search direction of
                               the inputs and limit rows (limits of sums of voltages) */
    pzs_optimiser *optimiser; /* voltages of the inputs, with their bounds and gradients, without
                                 the sums of voltages */
    uint32_t inputs, count; /* `inputs`: number of inputs; `count`: number of inputs plus number of
                               limit rows (limits of sums of voltages) */
} rows_run;

static rows_run run_of(pzs_control *control)
{
    pzs_row_solver *solver = control->state.row_solver;
    return (rows_run){.problem = control->state.problem,
                      .rows = control->state.problem->limit_rows,
                      .solver = solver,
                      .tableau = &solver->extended,
                      .optimiser = &control->state.optimiser,
                      .inputs = control->state.problem->inputs,
                      .count = solver->extended.inputs};
}

/*
 * Whether quantity k, the voltage of an input or the sum of voltages that a limit row limits, is
 * free, that is, not kept at a bound.
 */
static inline bool is_free(const rows_run *run, uint32_t k)
{
    return (run->tableau->free_set[k] > 0) == (k < run->inputs);
}

static uint32_t entry_count(const rows_run *run)
{
    return run->rows->sums.start[run->rows->sums.count];
}

/*
 * Whether the work limit of the optimiser allows another `cost` multiply-adds and, after them, the
 * end of the round of iterations: corrections of limit rows (limits of sums of voltages), sums of
 * limit rows and the gradient computed from the Hessian.
 */
static bool affords(const rows_run *run, uint64_t cost)
{
    const uint64_t end = (CORRECTIONS + 1u) * PZS_PRODUCT_WORK(run->count) +
                         (CORRECTIONS + SWEEPS + 3u) * (uint64_t)entry_count(run);
    const uint64_t spent = run->optimiser->work + run->tableau->work;
    return spent + cost + end <= run->optimiser->work_limit;
}

/* ---- tableau (pivoted KKT matrix) --------------------------------------- */

/*
 * Return the number that the optimiser adds to each diagonal entry of the Hessian (m2/V2), so that
 * its pivoted matrix is regular even if the Hessian is singular or zero.
 */
static pzs_real shift_of(const rows_run *run)
{
    const pzs_real stiffest = pzs_product_largest(run->optimiser->diagonal, run->optimiser->width);
    const pzs_real shift = LEAST_CURVATURE * stiffest - run->problem->regularisation;
    if (!(stiffest > 0))
        return 1;
    return shift > 0 ? shift : 0;
}

/*
 * Begin to compute the tableau (pivoted matrix of the optimiser) anew from Hessian and limit rows
 * (limits of sums of voltages). No voltage or limit row is pivoted yet; all that were pivoted
 * before wait to be pivoted again.
 */
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

/*
 * Update the largest absolute pivot among the free voltages and limit rows (limits of sums of
 * voltages) since the tableau (pivoted matrix) was last computed anew. This number scales the
 * rounding errors of all pivots.
 */
static void note_size(const rows_run *run)
{
    pzs_real largest = run->solver->largest_size;
    for (uint32_t k = 0; k < run->count; k++) {
        const pzs_real size = number_absolute(run->tableau->pivot[k]);
        if (is_free(run, k) && size > largest)
            largest = size;
    }
    run->solver->largest_size = largest;
}

/*
 * Return the size of a pivot of a free voltage or limit row (limit of a sum of voltages) below
 * which rounding errors may explain the pivot. The voltage or row then depends linearly on the
 * active ones (V2/m2).
 */
static pzs_real least_pivot(const rows_run *run)
{
    return CERTAIN * (pzs_real)run->count * PZS_EPSILON * run->solver->largest_size;
}

/*
 * Make free quantity k active, or active quantity k free, by a pivot exchange in the tableau, the
 * optimiser's matrix. A quantity is a voltage, or the sum of voltages that a limit row limits. The
 * array tableau->next_voltage is overwritten.
 */
static void exchange(const rows_run *run, uint32_t k)
{
    pzs_tableau_row(run->tableau, k, run->tableau->next_voltage);
    pzs_tableau_exchange_side(run->tableau, k, run->tableau->next_voltage,
                              k < run->inputs ? (pzs_real)1 : (pzs_real)-1);
    note_size(run);
}

/*
 * Return the largest diagonal entry of the Hessian, including the shift that the tableau (pivoted
 * matrix) adds to the diagonal (m2/V2).
 */
static pzs_real stiffest_of(const rows_run *run)
{
    return pzs_product_largest(run->optimiser->diagonal, run->optimiser->width) + shift_of(run);
}

/*
 * Return how far quantity k, a voltage or limit row (limit of a sum of voltages) that waits to be
 * pivoted, is linearly independent of the pivoted ones: its pivot divided by the pivot of a stiff
 * and independent quantity (1).
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
 * Return the next voltage or limit row (limit of a sum of voltages) to be pivoted while the tableau
 * (pivoted matrix) is computed anew: of those that wait, the one that is most independent of the
 * pivoted ones. If all waiting ones depend linearly on the pivoted ones, return the number of
 * quantities.
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

/*
 * Continue to compute the tableau (pivoted matrix of the optimiser) anew, as far as the work limit
 * allows. Returns whether the tableau is complete.
 */
static bool complete_tableau(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real stiffest = stiffest_of(run);
    bool is_complete = !tableau->is_rebuilding;
    while (!is_complete && affords(run, PZS_ITERATION_WORK(run->count))) {
        const uint32_t k = next_pivot(run, stiffest);
        is_complete = k == run->count;
        if (!is_complete) {
            exchange(run, k);
            tableau->waiting[k] = 0;
        }
        tableau->work += tableau->width;
    }
    pzs_tableau_apply(tableau);
    if (is_complete && tableau->is_rebuilding)
        pzs_tableau_complete(tableau);
    return is_complete;
}

/*
 * Compute, into tableau->next_voltage, by how much the value of each free quantity (V) and the
 * multiplier of each active one (m2/V) change when the value of active quantity k rises by 1 V.
 * Returns the change of the multiplier of quantity k. A quantity is a voltage or the sum of a limit
 * row (limit of a sum of voltages).
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
 * Compute present value, bounds and margin of all voltages and limit rows (limits of sums of
 * voltages). The margin of a voltage is the largest margin of a limit row, because a row at its
 * narrowed limit may change a voltage by so much, but at most an eighth of the distance between the
 * bounds of the voltage.
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
 * Return the value at which an active limit row (limit of a sum of voltages) is to be kept (V): its
 * bound if the present sum differs from the bound by rounding errors only, otherwise the present
 * sum.
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
 * Subtract from a gradient [inputs] the contributions of the active limit rows (limits of sums of
 * voltages): coefficients times multiplier. Returns the largest absolute contribution, which scales
 * the rounding error (m2/V).
 *   multiplier [inputs + limit rows] in  multipliers, of which those of the rows are used (m2/V)
 */
static pzs_real subtract_rows(const rows_run *run, const pzs_real *multiplier, pzs_real *gradient)
{
    const pzs_rows *sums = &run->rows->sums;
    pzs_real largest = 0;
    for (uint32_t k = 0; k < sums->count; k++) {
        const uint32_t row = run->inputs + k;
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u] && !is_free(run, row); at++) {
            const pzs_real force = sums->value[at] * multiplier[row];
            gradient[sums->dof[at]] -= force;
            if (!(number_absolute(force) <= largest))
                largest = number_absolute(force);
        }
    }
    return largest;
}

/*
 * Set the right-hand side of the linear equations for the search direction: the gradient at the
 * free voltages minus the contributions of the present multipliers of active limit rows (limits of
 * sums of voltages), and, for each active row, the distance from its present sum to the value at
 * which it is to be kept.
 */
static void set_right_side(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    pzs_real *right_side = tableau->scratch;
    for (uint32_t row = run->inputs; row < run->count; row++)
        if (is_free(run, row) || !number_is_finite(tableau->direction[row]))
            tableau->direction[row] = 0;
    memset(right_side, 0, tableau->width * sizeof *right_side);
    memcpy(right_side, run->optimiser->gradient, run->inputs * sizeof *right_side);
    (void)subtract_rows(run, tableau->direction, right_side);
    for (uint32_t i = 0; i < run->inputs; i++) {
        tableau->direction[i] = right_side[i];
        right_side[i] = is_free(run, i) ? right_side[i] : 0;
    }
    for (uint32_t row = run->inputs; row < run->count; row++) {
        if (is_free(run, row))
            continue;
        const pzs_real place = place_of_row(run, row);
        right_side[row] = place - tableau->voltage[row];
        tableau->voltage[row] = place;
    }
    tableau->work += entry_count(run);
}

/*
 * Compute the step to the minimum of the objective over the free quantities, with the active ones
 * kept, into tableau->direction: for a free voltage or limit row (limit of a sum of voltages) its
 * change (V), for an active one its multiplier after the step (m2/V). The sums of active rows are
 * set to their bounds exactly. The equations are solved for the change of the present multipliers,
 * so that rounding errors of the tableau (pivoted matrix) decay from round of iterations to round.
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
        if (is_input && is_free(run, k))
            slope += tableau->scratch[k] * change[k];
        if (is_free(run, k))
            direction[k] = change[k];
        else
            direction[k] += is_input ? -change[k] : change[k];
    }
    run->solver->predicted_decrease = -slope / 2;
}

/*
 * Return by how much a multiplier (m2/V) of active quantity k, a voltage or limit row (limit of a
 * sum of voltages), violates the optimality (KKT) conditions: zero or negative where its sign is
 * right for the bound at which the quantity is kept. A quantity within its margin from a bound
 * counts as at the bound; one between its bounds must have the multiplier zero.
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
 * Return the largest absolute coefficient of a limit row (limit of a sum of voltages). Times the
 * multiplier of the row it is the largest contribution of the row to a gradient.
 */
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
 * Return the largest violation of the optimality (KKT) conditions (m2/V) from gradient, limit rows
 * (limits of sums of voltages) and the multipliers in tableau->direction, without the rounding
 * errors of the tableau (pivoted matrix). Also stores an upper bound of the distance of the
 * objective from its minimum in solver->gap.
 *   reduced [inputs] in  gradient minus the contributions of the active limit rows (m2/V)
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
        if (k >= run->inputs && !is_free(run, k))
            size = wrong_sign(run, k, tableau->direction[k]) * coefficient_of(run, k);
        if (!(size <= largest))
            largest = size;
    }
    run->solver->gap = gap;
    return largest;
}

/*
 * Compute the violation of the optimality (KKT) conditions at the start of a round of iterations,
 * and its rounding-error bound. The bound never falls below the bound in the first round of the
 * control step, so that an optimum with zero gradient counts as found.
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

/* ---- descent and release iterations ------------------------------------- */

typedef struct blocking_bound {
    pzs_real part; /* step length, as a fraction of the search direction, at which the first free
                      voltage or limited sum of voltages reaches a bound (1) */
    uint32_t quantity; /* index of this first free quantity, a voltage or limit row (limit of a sum
                          of voltages); number of quantities if no quantity reaches a bound */
} blocking_bound;

/*
 * Whether free quantity k, a voltage or limit row (limit of a sum of voltages), is linearly
 * independent of the active ones, so that its bound may end a step.
 *   change     in  entry of the search direction for the quantity (V)
 *   curvature  in  second derivative of the objective along the search direction (m2/V2), or 0
 */
static inline bool may_block(const rows_run *run, uint32_t k, pzs_real change, pzs_real curvature)
{
    const pzs_real own = number_absolute(run->tableau->pivot[k]);
    const pzs_real added = curvature > 0 ? change * change / curvature : 0;
    return own + added > least_pivot(run);
}

/*
 * Find the first free voltage or limit row (limit of a sum of voltages) that reaches a bound on a
 * step along sense * search, with a step length of at most `most`. search [inputs + limit rows] is
 * a search direction (V), and `sense` is 1 or -1.
 */
static blocking_bound first_bound(const rows_run *run, const pzs_real *search, pzs_real sense,
                                  pzs_real most, pzs_real curvature)
{
    const pzs_optimiser *tableau = run->tableau;
    blocking_bound first = {most, run->count};
    for (uint32_t k = 0; k < run->count; k++) {
        if (!is_free(run, k))
            continue;
        const pzs_real step = sense * search[k], size = number_absolute(step);
        const pzs_real to_bound = step < 0 ? tableau->voltage[k] - tableau->lower[k]
                                           : tableau->upper[k] - tableau->voltage[k];
        const pzs_real room = to_bound > 0 ? to_bound : 0;
        if (room < first.part * size && may_block(run, k, search[k], curvature)) {
            first.part = room / size;
            first.quantity = k;
        }
    }
    return first;
}

/*
 * Change all free voltages and limit rows (limits of sums of voltages) by `part` times the search
 * direction `search` [inputs + limit rows] (V). The quantity that limits the step is set to its
 * bound exactly.
 */
static void move_along(const rows_run *run, const pzs_real *search, pzs_real part,
                       blocking_bound first)
{
    pzs_optimiser *tableau = run->tableau;
    for (uint32_t k = 0; k < run->count; k++) {
        if (!is_free(run, k))
            continue;
        const pzs_real next = tableau->voltage[k] + part * search[k];
        tableau->voltage[k] = number_clamp(next, tableau->lower[k], tableau->upper[k]);
    }
    if (first.quantity < run->count) {
        const bool falls = part * search[first.quantity] < 0 ||
                           (!(part * search[first.quantity] > 0) &&
                            tableau->voltage[first.quantity] <= tableau->lower[first.quantity]);
        tableau->voltage[first.quantity] =
            falls ? tableau->lower[first.quantity] : tableau->upper[first.quantity];
    }
}

/*
 * Make free quantity k, a voltage or limit row (limit of a sum of voltages), active at its present
 * value. The search direction of the other free quantities is corrected for the part of the step
 * that quantity k does not make.
 */
static void make_active(const rows_run *run, uint32_t k)
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

/*
 * Count one more iteration of the optimiser if the work limit allows it. Returns whether the
 * iteration may be made.
 */
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
 * Make one descent iteration: change the free voltages along the search direction to the minimum or
 * to the first bound; the voltage or limit row (limit of a sum of voltages) that reaches this bound
 * becomes active. Returns whether a bound ended the step.
 */
static bool descend(const rows_run *run)
{
    pzs_real *direction = run->tableau->direction;
    const blocking_bound first = first_bound(run, direction, 1, 1, 0);
    move_along(run, direction, first.part, first);
    if (first.quantity == run->count)
        return false;
    for (uint32_t k = 0; k < run->count; k++)
        if (is_free(run, k))
            direction[k] *= 1 - first.part;
    make_active(run, first.quantity);
    return true;
}

/*
 * Choose the active voltage or limit row (limit of a sum of voltages) to be released from its
 * bound: the one whose multiplier violates the optimality (KKT) conditions most, or, if the last
 * iterations changed no voltage, the first one whose multiplier violates them. Returns the number
 * of quantities if no multiplier violates them by more than `rounding` (m2/V).
 */
static uint32_t next_release(const rows_run *run, pzs_real rounding)
{
    const pzs_optimiser *tableau = run->tableau;
    pzs_real most = rounding;
    uint32_t next = run->count;
    for (uint32_t k = 0; k < run->count; k++) {
        if (is_free(run, k))
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
 * Make active quantity k free, and free quantity `other`, which has reached its bound, active in
 * its place. A quantity is a voltage or limit row (limit of a sum of voltages). The search
 * direction becomes the step to the minimum over the quantities that are free then.
 */
static void change_roles(const rows_run *run, uint32_t k, uint32_t other, pzs_real curvature)
{
    pzs_real *direction = run->tableau->direction;
    const pzs_real *response = run->tableau->next_voltage;
    const pzs_real rest = -direction[k] / curvature;
    for (uint32_t j = 0; j < run->count; j++)
        direction[j] = is_free(run, j) ? rest * response[j] : direction[j] + rest * response[j];
    direction[k] = rest;
    exchange(run, k);
    make_active(run, other);
}

/*
 * Change the value of active quantity k, a voltage or limit row (limit of a sum of voltages), by
 * `change` (V). All free quantities and the multipliers of all active ones change with it.
 */
static void move_released(const rows_run *run, uint32_t k, pzs_real change, blocking_bound first)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real *response = tableau->next_voltage;
    move_along(run, response, change, first);
    for (uint32_t j = 0; j < run->count; j++)
        if (!is_free(run, j))
            tableau->direction[j] += change * response[j];
    tableau->voltage[k] =
        number_clamp(tableau->voltage[k] + change, tableau->lower[k], tableau->upper[k]);
    run->solver->is_least_index = !(number_absolute(change) > 0);
}

/*
 * What follows after one iteration of a release, which moves a voltage or limit row (limit of a sum
 * of voltages) away from its bound.
 */
typedef enum release_end {
    RELEASE_DONE,    /* the release is complete: the objective is minimal over the free voltages, or
                        the voltage or limit row (limit of a sum of voltages) that was released from
                        one bound has reached its other bound */
    RELEASE_GOES_ON, /* another voltage or limit row (limit of a sum of voltages) has reached its
                        bound and become active; the release needs another iteration */
    RELEASE_DESCENDS /* the voltage or limit row (limit of a sum of voltages) that was released from
                        its bound has become free, and the one that blocked it is now kept at its
                        bound; descent iterations follow */
} release_end;

/*
 * Make quantity `other` active at its bound, which it has reached while quantity k was released
 * from its own bound. If `other` depends almost linearly on quantity k, quantity k becomes free at
 * the same time. Quantities are voltages and limit rows (limits of sums of voltages).
 */
static release_end block_release(const rows_run *run, uint32_t k, uint32_t other,
                                 pzs_real curvature)
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
 * Make one iteration of the release of quantity k, an active voltage or limit row (limit of a sum
 * of voltages) whose multiplier violates the optimality (KKT) conditions: change its value until
 * its multiplier is zero, or until it or a free quantity reaches a bound.
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
    const blocking_bound first = first_bound(run, tableau->next_voltage, sense,
                                             has_minimum ? slope / curvature : room, curvature);
    if (!number_is_finite(first.part)) {
        tableau->direction[k] = 0;
        return RELEASE_DONE;
    }
    move_released(run, k, sense * first.part, first);
    if (first.quantity < run->count)
        return block_release(run, k, first.quantity, curvature);
    if (has_minimum) {
        exchange(run, k);
        tableau->direction[k] = 0;
    } else {
        tableau->voltage[k] = falls ? tableau->lower[k] : tableau->upper[k];
    }
    return RELEASE_DONE;
}

/*
 * Make descent iterations until the minimum over the free voltages is reached, or until the work
 * limit ends them.
 */
static void descend_fully(const rows_run *run)
{
    bool is_blocked = true;
    while (is_blocked && may_iterate(run))
        is_blocked = descend(run);
}

/*
 * Iterate until no multiplier violates the optimality (KKT) conditions: first descents to the
 * minimum over the free voltages, then releases of voltages and limit rows (limits of sums of
 * voltages) from their bounds.
 */
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
 * Correct the free voltages so that the sum of each active limit row (limit of a sum of voltages)
 * is exactly the value at which the row is kept. Returns false if no row needed a correction.
 */
static bool correct_rows(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    pzs_real *right_side = tableau->scratch, *change = tableau->next_voltage;
    bool is_off = false;
    memset(right_side, 0, tableau->width * sizeof *right_side);
    for (uint32_t k = 0; k < run->rows->sums.count; k++) {
        const uint32_t row = run->inputs + k;
        if (is_free(run, row))
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
 * If the sum of limit row k (limit of a sum of voltages) is outside its narrowed limits by more
 * than half of its margin, change its voltages as little as possible (in the sum of squares) to
 * bring it back, and clamp them to their bounds. Returns whether the sum was outside.
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
 * Correct the voltages, one limit row (limit of a sum of voltages) after the other, until no sum is
 * outside its narrowed limits. These corrections are of the size of rounding errors, so that a row
 * at its narrowed limit stays inside its true limit.
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
 * Take the result of the iterations as the new voltages of the controller. They are corrected so
 * that they obey all bounds and limit rows (limits of sums of voltages) without any rounding error.
 */
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

/* Restore the voltages and gradients at the start of the round of iterations. */
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

/*
 * Begin to compute the tableau (pivoted matrix of the optimiser) anew, if the work limit and the
 * number of earlier computations in this control step allow it. Returns whether they do.
 */
static bool renew_tableau(const rows_run *run)
{
    if (run->optimiser->rebuilds >= REBUILDS || !affords(run, PZS_PRODUCT_WORK(run->count)))
        return false;
    run->optimiser->rebuilds++;
    reset_tableau(run);
    return true;
}

/*
 * Whether the complete step along the search direction reaches no bound, and no multiplier violates
 * the optimality (KKT) conditions after it.
 */
static bool is_open(const rows_run *run)
{
    const pzs_optimiser *tableau = run->tableau;
    const pzs_real rounding = run->optimiser->rounding_bound / 2;
    const blocking_bound first = first_bound(run, tableau->direction, 1, 1, 0);
    return first.quantity == run->count && next_release(run, rounding) == run->count;
}

/*
 * Whether the complete step along the search direction would lower the objective by no more than
 * its rounding error.
 */
static bool is_negligible(const rows_run *run)
{
    return run->solver->predicted_decrease <= 4 * PZS_EPSILON * run->optimiser->target_energy;
}

/*
 * Whether the voltages are optimal at the start of a round of iterations: either the violation of
 * the optimality (KKT) conditions is below its rounding-error bound, or the objective exceeds a
 * lower bound of its minimum by at most the fraction GAP of target_energy, the scale of the
 * objective.
 */
static bool is_converged(const rows_run *run, bool is_whole)
{
    const pzs_optimiser *optimiser = run->optimiser;
    if (!number_is_finite(optimiser->rounding_bound))
        return false;
    return optimiser->kkt_violation <= optimiser->rounding_bound ||
           (is_whole && run->solver->gap <= GAP * optimiser->target_energy);
}

/*
 * Make one round of iterations of the optimiser, whose tableau (pivoted matrix) must be complete:
 * compute the search direction, iterate, and keep the new voltages if the objective has decreased.
 * Returns whether another round may lower the objective.
 */
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
        move_along(run, run->tableau->direction, 1, (blocking_bound){1, run->count});
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

/*
 * Compute the rest of the tableau (pivoted matrix of the optimiser) if it is incomplete. Returns
 * whether the work limit then allows another round of iterations.
 */
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
     * A violation of the optimality (KKT) conditions slightly above its rounding-error bound is
     * accepted, because rounding errors prevent a smaller one.
     */
    optimiser->is_optimal |=
        !optimiser->is_cut && optimiser->kkt_violation <= TOLERATED * optimiser->rounding_bound;
    optimiser->work += run.tableau->work;
}

pzs_real pzs_violation_rows(pzs_control *control, const pzs_real *gradient, uint16_t *active)
{
    const rows_run run = run_of(control);
    pzs_real *reduced = control->state.optimiser.scratch;
    memcpy(reduced, gradient, run.inputs * sizeof *reduced);
    (void)subtract_rows(&run, run.tableau->direction, reduced);
    *active = 0;
    for (uint32_t row = run.inputs; row < run.count; row++)
        *active = (uint16_t)(*active + !is_free(&run, row));
    return largest_violation(&run, reduced);
}

/* ---- state of the optimiser --------------------------------------------- */

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
    pzs_tableau_collect(tableau, tableau->pending);
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
