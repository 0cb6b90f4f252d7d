/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Limits of weighted sums of absolute values of voltages, for example of the current that a common
 * supply gives:
 *
 *   sum over the inputs of (weight * |voltage|) <= upper limit.
 *
 * While no voltage changes its sign, such a limit is a limit of a weighted sum of voltages, whose
 * coefficients are the weights with the signs of the voltages. Therefore this file chooses a sign
 * for each input and bounds each voltage at 0 V as well; row_solver.c optimises the voltages with
 * these signs. At the optimum some voltages are at 0 V. Where a reversal of the sign chosen for
 * such a voltage lowers the objective, the sign is reversed, and row_solver.c optimises again. The
 * voltages always obey the bounds of the next optimisation, so that the objective never rises. It
 * falls each time, so that no choice of signs occurs twice and their number is finite.
 *
 * The tableau of row_solver.c has a row for each input and a row for each limited sum. When signs
 * change, only the rows of the sums of absolute values must be computed again. Such a row is the
 * sum of the rows of the inputs, each times its weight with the chosen sign.
 */
#include <string.h>
#include "row_solver.h"
#include "boxls_dual.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * Factor, odd and near 2^32 divided by the golden ratio, that makes the start of a pseudo-random
 * sequence from the number of the iteration. A bit of this sequence decides for each input whether
 * the sign chosen for its voltage is reversed.
 */
#define SPREAD 2654435769u

/* Return the index of the first limited sum that is a sum of absolute values of voltages. */
static uint32_t first_absolute(const rows_run *run)
{
    return run->rows->sums.count - run->rows->absolute_count;
}

/*
 * For each input, compute the slope (m2/V) that the active limits of sums of absolute values of
 * voltages add to the objective on each side of 0 V, in the direction away from 0 V. It is the sum
 * over these limits of the weight of the input times the absolute value of the limit's multiplier.
 *   force [inputs] out  these slopes (m2/V); -1 for an input in no such sum
 */
static void add_forces(const rows_run *run, pzs_real *force)
{
    const pzs_rows *sums = &run->rows->sums;
    for (uint32_t i = 0; i < run->inputs; i++)
        force[i] = -1;
    for (uint32_t k = first_absolute(run); k < sums->count; k++) {
        const uint32_t row = run->inputs + k;
        const pzs_real multiplier = run->solver->scale[row] * run->tableau->direction[row];
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++) {
            const uint16_t i = sums->dof[at];
            const pzs_real own = rows_is_free(run, row) ? 0 : -multiplier * sums->value[at];
            force[i] = (force[i] > 0 ? force[i] : 0) + own;
        }
    }
}

/*
 * Return by how much input i, whose voltage is 0 V in a sum of absolute values, violates the
 * optimality (KKT) conditions because the sign chosen for its voltage could be reversed (m2/V). The
 * result is positive if the reversal lowers the objective. Let s = 1 or -1 be the chosen sign, g
 * the gradient without the limits of sums of absolute values, and f the slope that these limits add
 * on each side of 0 V. A step from 0 V in the direction s changes the objective at the rate s g +
 * f, which is s times the reduced gradient. A step in the direction -s changes it at the rate -s g
 * + f; the function returns the negative of this rate.
 *   reduced in  gradient of the input minus the contributions of all active limits of sums (m2/V)
 *   force   in  slope f (m2/V), which add_forces computes
 */
static pzs_real slope_across(const rows_run *run, uint32_t i, pzs_real reduced, pzs_real force)
{
    return run->solver->scale[i] * reduced - 2 * force;
}

/*
 * Return how far the voltage of input i may go beyond 0 V if the sign chosen for it is reversed
 * (V), zero or negative if its bounds exclude this.
 */
static pzs_real room_across(const rows_run *run, uint32_t i)
{
    return run->solver->scale[i] > 0 ? -run->optimiser->lower[i] : run->optimiser->upper[i];
}

/* ---- choice of the signs ------------------------------------------------- */

/*
 * Set the sign, 1 or -1, that the voltage of input i may have in a sum of absolute values. A
 * voltage that is kept at the bound 0 V stays there.
 */
static void set_sign(const rows_run *run, uint32_t i, pzs_real sign)
{
    run->solver->scale[i] = sign;
    if (!rows_is_free(run, i))
        run->tableau->side[i] = -sign;
}

/*
 * Make the chosen sign of each input in a sum of absolute values that of its voltage. Returns
 * whether a chosen sign has changed. Signs that damaged memory has changed become 1 or -1 again.
 */
static bool follow_voltages(const rows_run *run)
{
    bool has_changed = false;
    for (uint32_t i = 0; i < run->inputs; i++) {
        const pzs_real sign = run->solver->scale[i] < 0 ? (pzs_real)-1 : (pzs_real)1;
        const bool is_wrong = run->optimiser->voltage[i] * sign < -run->solver->margin[i];
        run->solver->scale[i] = sign;
        if (is_wrong)
            set_sign(run, i, -sign);
        has_changed |= is_wrong;
    }
    return has_changed;
}

/*
 * Reverse the chosen sign of each input at 0 V (in a sum of absolute values of voltages) if its
 * voltage with the other sign may lower the objective by more than solver->gap. This duality gap
 * bounds how much the objective can fall with the present signs. After iterations that have not
 * lowered the objective, only a pseudo-random half of these signs is reversed. This happens where
 * the voltages are at several limits at once: no voltage may then be able to move, whether its sign
 * is reversed or not, and the same choices of signs could alternate for ever. Returns whether any
 * input met the condition.
 */
static bool cross_zero(const rows_run *run)
{
    const pzs_optimiser *optimiser = run->optimiser;
    const pzs_real *reduced = optimiser->scratch, gap = run->solver->gap;
    pzs_real *force = run->tableau->scratch;
    const bool may_change_all = !number_is_finite(run->solver->last_gap);
    uint32_t random = SPREAD * optimiser->iterations;
    bool has_changed = false;
    (void)pzs_rows_violation(run, reduced);
    add_forces(run, force);
    for (uint32_t i = 0; i < run->inputs; i++) {
        random = 1664525u * random + 1013904223u;
        const pzs_real slope = slope_across(run, i, reduced[i], force[i]);
        if (force[i] < 0 || number_absolute(optimiser->voltage[i]) > run->solver->margin[i] ||
            !(slope > optimiser->rounding_bound && slope * room_across(run, i) > run->solver->gap))
            continue;
        if (may_change_all || random >> 31 == 0)
            set_sign(run, i, -run->solver->scale[i]);
        has_changed = true;
    }
    run->solver->gap = gap;
    return has_changed;
}

/*
 * Set the bounds of the voltages of all inputs in limited sums of absolute values, and the lower
 * bounds of these sums. A voltage whose chosen sign is 1 gets a lower bound of at least 0 V, and
 * one whose chosen sign is -1 an upper bound of at most 0 V. Otherwise the bounds of the present
 * tick hold. A sum with the chosen signs is then never negative and needs no lower bound. It still
 * gets a finite one, the negative of its upper bound, because an infinite bound would make the
 * duality gap infinite.
 */
static void split_bounds(const rows_run *run)
{
    const pzs_rows *sums = &run->rows->sums;
    const pzs_optimiser *optimiser = run->optimiser;
    for (uint32_t at = sums->start[first_absolute(run)]; at < sums->start[sums->count]; at++) {
        const uint16_t i = sums->dof[at];
        const bool is_positive = run->solver->scale[i] > 0;
        const pzs_real lower = optimiser->lower[i], upper = optimiser->upper[i];
        run->tableau->lower[i] = is_positive && lower < 0 ? 0 : lower;
        run->tableau->upper[i] = !is_positive && upper > 0 ? 0 : upper;
    }
    for (uint32_t row = run->inputs + first_absolute(run); row < run->count; row++)
        run->tableau->lower[row] = -run->tableau->upper[row];
}

/* ---- response matrix ------------------------------------------------------- */

/*
 * Compute anew the row and the column of a limited sum of absolute values of voltages (number k) in
 * the optimiser's tableau, the matrix that gives changes of voltages and sums from changes of
 * multipliers. The row is a sum of the rows that belong to inputs, each multiplied by its
 * coefficient with the chosen sign.
 */
static void renew_row(const rows_run *run, uint32_t k)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_rows *sums = &run->rows->sums;
    const size_t width = tableau->width, row = run->inputs + k;
    pzs_real *sum = tableau->tableau + row * width, *factor = tableau->scratch;
    memset(factor, 0, width * sizeof *factor);
    for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++)
        factor[sums->dof[at]] = run->solver->scale[row] * rows_coefficient(run, k, at);
    pzs_product_sum_rows(sum, tableau->tableau, width, factor, run->inputs,
                         optimiser_span(tableau));
    sum[row] = pzs_product_dot(factor, sum, run->inputs);
    for (uint32_t other = 0; other < run->count; other++)
        tableau->tableau[other * width + row] = sum[other];
    tableau->work += (uint64_t)run->inputs * width;
}

/*
 * After the chosen signs of some voltages have changed, compute two rows for each limited sum of
 * absolute values of voltages: its row in the optimiser's tableau, the matrix that gives changes of
 * voltages and sums from changes of multipliers; and, if its limit is active, its row in the
 * Cholesky factor of the active limits. Active limits keep their multipliers. They stay active,
 * unless they now depend linearly on other active limits.
 */
static void renew_rows(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    const uint32_t first = run->inputs + first_absolute(run);
    for (uint32_t row = first; row < run->count; row++) {
        tableau->waiting[row] = rows_is_free(run, row) ? 0 : 1;
        pzs_dual_free(tableau, row);
    }
    for (uint32_t row = first; row < run->count; row++)
        renew_row(run, row - run->inputs);
    for (uint32_t row = first; row < run->count; row++) {
        const pzs_real multiplier = tableau->direction[row];
        if (!(tableau->waiting[row] > 0))
            continue;
        pzs_dual_join(tableau, row, 1);
        tableau->direction[row] = multiplier;
    }
}

static bool choose_signs(pzs_control *control, bool may_cross)
{
    const rows_run run = rows_run_of(control);
    const bool has_changed = may_cross ? cross_zero(&run) : follow_voltages(&run);
    split_bounds(&run);
    if (has_changed)
        renew_rows(&run);
    return has_changed;
}

/* ---- optimality -------------------------------------------------------------- */

static pzs_real crossing_violation(pzs_control *control, const pzs_real *reduced)
{
    const rows_run run = rows_run_of(control);
    pzs_real *force = run.tableau->scratch, largest = 0;
    add_forces(&run, force);
    for (uint32_t i = 0; i < run.inputs; i++) {
        const pzs_real room = room_across(&run, i);
        const pzs_real slope = slope_across(&run, i, reduced[i], force[i]);
        if (force[i] < 0 || !(room > 0) || !(slope > 0))
            continue;
        run.solver->gap += room * slope;
        if (number_absolute(run.optimiser->voltage[i]) <= run.solver->margin[i])
            largest = slope > largest ? slope : largest;
    }
    return largest;
}

const struct pzs_absolute_row_calls pzs_absolute_rows_calls = {choose_signs, crossing_violation};
