/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Dual active-set method of the voltage optimiser. Active inputs are kept at a bound; all others
 * are free.
 *
 *   - An iteration takes the free input whose voltage is farthest outside its bounds, and changes
 *     the multiplier of this input until the voltage reaches its bound. The other multipliers
 *     follow, so that active inputs stay at their bounds.
 *   - If the multiplier of an active input becomes zero before that, this active input becomes
 *     free, and the next iteration continues with the input taken.
 *   - The minimum over the free inputs rises with each iteration of positive length. No active set
 *     thus occurs twice, and their number is finite.
 *   - Between iterations voltages may be outside their bounds; they are clamped to the bounds
 *     before they become the present voltages of the controller.
 *   - An iteration takes two triangular solutions with the Cholesky factor of the inverse Hessian
 *     restricted to the active inputs, and a product with the columns of the inverse that belong to
 *     the active inputs. This is little work while few inputs are active.
 */
#include <string.h>
#include "boxls_dual.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * Voltages count as inside their bounds if they are outside by no more than this multiple of their
 * rounding error.
 */
#define ROUNDING_FACTOR 8
/*
 * A voltage or limited sum of voltages counts as linearly independent of those that are kept at a
 * bound if its pivot exceeds CERTAIN times pivot_rounding, the estimated rounding error of the
 * pivots.
 */
#define CERTAIN PZS_BY_BITS(4, 16)
/*
 * A voltage that is a linear combination of active voltages may seem to be outside its bounds by a
 * distance d (V) that is only a rounding error. It counts as such an error if
 *   PIVOT_TO_VALUE * d <= pivot_rounding * multiplier_change
 *   pivot_rounding     estimated rounding error of a pivot (V2/m2)
 *   multiplier_change  sum of the sizes of all changes of multipliers in the present sequence of
 *                      iterations (m2/V)
 */
#define PIVOT_TO_VALUE 16
/*
 * A triangular solver subtracts a row with fewer entries than this by a plain loop, which is then
 * faster than a call of subtract_multiple.
 */
#define SHORT_ROW 16u

/*
 * The dual active-set method replaces its active set by an estimate if at least 1 in WRONG_PART
 * inputs is wrong: free with its voltage outside its bounds, or active (kept at a bound) with a
 * multiplier of the wrong sign.
 */
#define WRONG_PART 3u
/*
 * Number of sweeps over all inputs in an estimate of the optimal voltages. A sweep moves one
 * voltage after the other to the minimum of the objective within its bounds, while the other
 * voltages stay. The dual active-set method chooses a new active set by this estimate.
 */
#define SWEEPS 6u
/*
 * Before the dual active-set method replaces its active set (inputs at a bound) by an estimate, it
 * makes ordinary iterations: up to (number of inputs) / TRIAL_PART. They often suffice if few
 * inputs end at their bounds.
 */
#define TRIAL_PART 4u
/*
 * Where at most 1 in FEW_RIGHT inputs is right, the dual active-set method estimates a new active
 * set at once, without the ordinary iterations that come first otherwise (TRIAL_PART). An input is
 * right if it is free with its voltage inside its bounds, or active (kept at a bound) with a
 * multiplier of the right sign.
 */
#define FEW_RIGHT 5u

void pzs_dual_place(pzs_optimiser *optimiser, pzs_real *work)
{
    const size_t inputs = optimiser->inputs;
    optimiser->factor = work;
    optimiser->side = work + inputs * (inputs + 1u) / 2u;
    optimiser->order = (uint16_t *)(optimiser->side + inputs);
    optimiser->active_most = optimiser->inputs;
}

/* ---- Cholesky factor ------------------------------------------------- */

/*
 * Return row k of the Cholesky factor of the inverse Hessian restricted to the active inputs
 * (voltages at a bound). The row has k + 1 entries.
 */
static pzs_real *factor_row(const pzs_optimiser *optimiser, uint32_t k)
{
    return optimiser->factor + (size_t)k * (k + 1u) / 2u;
}

/*
 * Solve L x = b for the Cholesky factor L of the inverse Hessian restricted to the active inputs
 * (voltages at a bound); x replaces b in `vector`.
 */
static void solve_lower(const pzs_optimiser *optimiser, pzs_real *vector)
{
    for (uint32_t k = 0; k < optimiser->active_count; k++) {
        const pzs_real *row = factor_row(optimiser, k);
        vector[k] = (vector[k] - pzs_product_dot(row, vector, k)) / row[k];
    }
}

static void subtract_multiple(pzs_real *restrict vector, const pzs_real *restrict row,
                              pzs_real factor, uint32_t count)
{
    static const uint16_t only = 0;
    pzs_product_subtract_rows(vector, row, 0, &only, &factor, 1, count);
}

/*
 * Solve L' x = b for the Cholesky factor L of the inverse Hessian restricted to the active inputs
 * (voltages at a bound); x replaces b in `vector`.
 */
static void solve_upper(const pzs_optimiser *optimiser, pzs_real *vector)
{
    for (uint32_t k = optimiser->active_count; k-- > 0;) {
        const pzs_real *row = factor_row(optimiser, k);
        const pzs_real entry = vector[k] / row[k];
        vector[k] = entry;
        if (k < SHORT_ROW) {
            for (uint32_t j = 0; j < k; j++)
                vector[j] -= entry * row[j];
        } else {
            subtract_multiple(vector, row, entry, k);
        }
    }
}

/*
 * Make free input i active, so that its voltage is kept at a bound, and append its row to the
 * Cholesky factor of the inverse Hessian restricted to the active inputs (voltages at a bound).
 *   solution [active_count] in  the new row of the factor without its last entry (V/m)
 *   pivot                   in  square of the last entry (V2/m2)
 */
static void join_active_set(pzs_optimiser *optimiser, uint32_t i, const pzs_real *solution,
                            pzs_real pivot)
{
    const uint32_t count = optimiser->active_count;
    pzs_real *row = factor_row(optimiser, count);
    memcpy(row, solution, count * sizeof *row);
    row[count] = PZS_SQRT(pivot);
    optimiser->order[count] = (uint16_t)i;
    optimiser->active_count = count + 1u;
    optimiser->free_set[i] = 0;
    optimiser->inverse_trace = 0;
}

/*
 * One step in removing row `removed` from the Cholesky factor of the inverse Hessian restricted to
 * the active inputs (voltages at a bound): move row k + 1 to row k. Plane rotations of the columns
 * keep the factor triangular: those of the earlier steps are applied to the row, and a new one
 * removes its entry behind the diagonal.
 */
static void rotate_row(const pzs_optimiser *optimiser, uint32_t removed, uint32_t k)
{
    const pzs_real *from = factor_row(optimiser, k + 1u);
    pzs_real *to = factor_row(optimiser, k), *cosine = dual_array(optimiser, DUAL_COSINE),
             *sine = optimiser->scratch, carried = from[removed];
    memmove(to, from, removed * sizeof *to);
    for (uint32_t j = removed; j < k; j++) {
        const pzs_real next = from[j + 1u];
        to[j] = cosine[j] * carried + sine[j] * next;
        carried = cosine[j] * next - sine[j] * carried;
    }
    const pzs_real last = from[k + 1u], length = PZS_SQRT(carried * carried + last * last);
    cosine[k] = carried / length;
    sine[k] = last / length;
    to[k] = length;
}

/*
 * Make an active input (kept at a bound) free, and remove its row k from the Cholesky factor of the
 * inverse Hessian restricted to the active inputs.
 */
static void leave_active_set(pzs_optimiser *optimiser, uint32_t k)
{
    const uint32_t last = optimiser->active_count - 1u;
    optimiser->free_set[optimiser->order[k]] = 1;
    for (uint32_t row = k; row < last; row++) {
        rotate_row(optimiser, k, row);
        optimiser->order[row] = optimiser->order[row + 1u];
    }
    optimiser->active_count = last;
    optimiser->inverse_trace = 0;
    optimiser->work += 2u * (uint64_t)last * (last - k);
}

void pzs_dual_free(pzs_optimiser *optimiser, uint32_t i)
{
    uint32_t k = 0;
    while (k < optimiser->active_count && optimiser->order[k] != i)
        k++;
    if (k < optimiser->active_count)
        leave_active_set(optimiser, k);
}

void pzs_dual_free_all(pzs_optimiser *optimiser)
{
    for (uint32_t i = 0; i < optimiser->inputs; i++)
        optimiser->free_set[i] = 1;
    optimiser->active_count = 0;
    optimiser->inverse_trace = 0;
}

/*
 * Whether the list `order` of the inputs in the Cholesky factor is intact: it contains each active
 * input (voltage at a bound) once and no free input. Otherwise memory was damaged.
 */
static bool is_order_valid(const pzs_optimiser *optimiser)
{
    pzs_real *seen = dual_array(optimiser, DUAL_SOLUTION);
    if (optimiser->active_count > optimiser->active_most)
        return false;
    memset(seen, 0, optimiser->width * sizeof *seen);
    for (uint32_t k = 0; k < optimiser->active_count; k++) {
        const uint32_t i = optimiser->order[k];
        if (i >= optimiser->inputs || optimiser->free_set[i] > 0 || seen[i] > 0)
            return false;
        seen[i] = 1;
    }
    return true;
}

void pzs_check_active_dual(pzs_optimiser *optimiser)
{
    bool is_valid = is_order_valid(optimiser);
    for (uint32_t k = 0; is_valid && k < optimiser->active_count; k++)
        is_valid = number_is_finite(dual_bound(optimiser, optimiser->order[k]));
    if (!is_valid)
        pzs_dual_free_all(optimiser);
}

uint64_t pzs_dual_round_work(const pzs_optimiser *optimiser)
{
    const uint64_t count = optimiser->active_count;
    return count * (count + optimiser->width) + PZS_PRODUCT_WORK(optimiser->inputs);
}

bool pzs_is_at_bounds_dual(const pzs_optimiser *optimiser)
{
    for (uint32_t k = 0; k < optimiser->active_count; k++) {
        const uint32_t i = optimiser->order[k];
        const pzs_real bound = dual_bound(optimiser, i);
        if (optimiser->voltage[i] < bound || optimiser->voltage[i] > bound)
            return false;
    }
    return true;
}

/* ---- step of the free inputs to their minimum ------------------------ */

/*
 * Add columns of the inverse Hessian to a vector [width]: those of the active inputs (voltages at a
 * bound), each multiplied by its entry of `factor`. They are subtracted as rows of the tableau,
 * which is the negative inverse of the Hessian.
 */
static void add_columns(pzs_optimiser *optimiser, pzs_real *vector, const pzs_real *factor)
{
    pzs_product_subtract_rows(vector, optimiser->tableau, optimiser->width, optimiser->order,
                              factor, optimiser->active_count, optimiser_span(optimiser));
    optimiser->work += (uint64_t)optimiser->active_count * optimiser->width;
}

void pzs_dual_move_to_bounds(pzs_optimiser *optimiser)
{
    pzs_real *next = optimiser->next_voltage, *change = dual_array(optimiser, DUAL_CHANGE);
    const uint32_t count = optimiser->active_count;
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t i = optimiser->order[k];
        change[k] = dual_bound(optimiser, i) - next[i];
    }
    solve_lower(optimiser, change);
    solve_upper(optimiser, change);
    optimiser->work += (uint64_t)count * count;
    add_columns(optimiser, next, change);
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t i = optimiser->order[k];
        optimiser->direction[i] += change[k];
        next[i] = dual_bound(optimiser, i);
    }
}

/*
 * Whether active input i (voltage at a bound) should become free. This is so if its two bounds
 * differ and its Lagrange multiplier has the wrong sign by more than `rounding` (m2/V): the
 * objective then falls if the voltage leaves the bound.
 */
static bool is_wrong(const pzs_optimiser *optimiser, uint32_t i, pzs_real rounding)
{
    return optimiser->side[i] * optimiser->direction[i] > rounding &&
           optimiser->lower[i] < optimiser->upper[i];
}

uint32_t pzs_predict_step_dual(pzs_optimiser *optimiser, pzs_real rounding)
{
    pzs_real *next = optimiser->next_voltage;
    uint32_t open = 0;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        next[i] = optimiser->voltage[i] + optimiser->direction[i];
        if (!(optimiser->free_set[i] > 0))
            optimiser->direction[i] = optimiser->gradient[i];
    }
    pzs_dual_move_to_bounds(optimiser);
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        if (optimiser->free_set[i] > 0)
            optimiser->direction[i] = next[i] - optimiser->voltage[i];
        else
            open += is_wrong(optimiser, i, rounding) ? 1u : 0u;
        optimiser->scratch[i] = next[i] - optimiser->base[i];
        open += next[i] >= optimiser->lower[i] && next[i] <= optimiser->upper[i] ? 0u : 1u;
    }
    return open;
}

/* ---- iterations of the dual method ----------------------------------- */

bool pzs_dual_affords(const pzs_optimiser *optimiser, uint64_t cost)
{
    return optimiser_affords(optimiser, cost + PZS_PRODUCT_WORK(optimiser->inputs));
}

/*
 * Choose the active inputs (voltages kept at a bound) that become free because their multipliers
 * have the wrong sign, as many as the work limit allows.
 *   change [active_count] out  for each chosen input the change that makes its multiplier zero, 0
 *                              for all others (m2/V)
 * Returns the number of chosen inputs.
 */
static uint32_t choose_wrong(pzs_optimiser *optimiser, pzs_real rounding, pzs_real *change)
{
    const uint64_t count = optimiser->active_count, each = 2u * count * count;
    const uint64_t once = count * (count + 2u * optimiser->width);
    uint32_t chosen = 0;
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t i = optimiser->order[k];
        change[k] = 0;
        if (!is_wrong(optimiser, i, rounding))
            continue;
        optimiser->is_cut = !pzs_dual_affords(optimiser, once + (chosen + 1u) * each);
        if (optimiser->is_cut)
            return chosen;
        change[k] = -optimiser->direction[i];
        chosen++;
    }
    return chosen;
}

void pzs_dual_drop_wrong(pzs_optimiser *optimiser, pzs_real rounding)
{
    pzs_real *next = optimiser->next_voltage, *change = dual_array(optimiser, DUAL_CHANGE);
    while (choose_wrong(optimiser, rounding, change) > 0) {
        add_columns(optimiser, next, change);
        for (uint32_t k = optimiser->active_count; k-- > 0;)
            if (number_absolute(change[k]) > 0)
                leave_active_set(optimiser, k);
        pzs_dual_move_to_bounds(optimiser);
    }
}

uint32_t pzs_dual_choose_outside(const pzs_optimiser *optimiser)
{
    const pzs_real *next = optimiser->next_voltage;
    pzs_real largest = 0, most = 0;
    uint32_t farthest = optimiser->inputs;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        const pzs_real size = number_absolute(next[i]);
        const pzs_real below = optimiser->lower[i] - next[i], above = next[i] - optimiser->upper[i];
        const pzs_real counts = optimiser->free_set[i] - optimiser->waiting[i];
        const pzs_real outside = (below > above ? below : above) * counts;
        largest = size > largest ? size : largest;
        farthest = outside > most ? i : farthest;
        most = outside > most ? outside : most;
    }
    if (!(most > ROUNDING_FACTOR * PZS_EPSILON * largest))
        return optimiser->inputs;
    optimiser->direction[farthest] = 0;
    optimiser->side[farthest] =
        next[farthest] > optimiser->upper[farthest] ? (pzs_real)1 : (pzs_real)-1;
    return farthest;
}

/*
 * Compute the row that free input i gets in the Cholesky factor if it becomes active, into the work
 * array DUAL_SOLUTION [active_count] (V/m). The factor is that of the inverse Hessian restricted to
 * the active inputs (voltages at a bound). Returns the square of the last entry of the row (V2/m2).
 */
static pzs_real find_factor_row(pzs_optimiser *optimiser, uint32_t i)
{
    const pzs_real *row = optimiser->tableau + i * optimiser->width;
    pzs_real *solution = dual_array(optimiser, DUAL_SOLUTION);
    const uint32_t count = optimiser->active_count;
    for (uint32_t k = 0; k < count; k++)
        solution[k] = -row[optimiser->order[k]];
    solve_lower(optimiser, solution);
    optimiser->work += (uint64_t)count * count / 2u;
    return -row[i] - pzs_product_dot(solution, solution, count);
}

/*
 * Return the smallest pivot with which input i may become active, so that its voltage is kept at a
 * bound (V2/m2). With a smaller pivot its voltage counts as linearly dependent on those of the
 * active inputs.
 */
static pzs_real least_pivot(const pzs_optimiser *optimiser, uint32_t i)
{
    return optimiser->pivot_floor * -optimiser->tableau[i * (size_t)optimiser->width + i] +
           CERTAIN * optimiser->pivot_rounding;
}

bool pzs_dual_may_join(const pzs_optimiser *optimiser, uint32_t i, pzs_real pivot)
{
    return pivot > least_pivot(optimiser, i) && optimiser->active_count < optimiser->active_most;
}

pzs_real pzs_dual_find_response(pzs_optimiser *optimiser, uint32_t i)
{
    const pzs_real *row = optimiser->tableau + i * optimiser->width;
    pzs_real *solution = dual_array(optimiser, DUAL_SOLUTION),
             *change = dual_array(optimiser, DUAL_CHANGE),
             *response = dual_array(optimiser, DUAL_RESPONSE);
    const uint32_t count = optimiser->active_count;
    const pzs_real pivot = find_factor_row(optimiser, i);
    for (uint32_t k = 0; k < count; k++)
        change[k] = -solution[k];
    solve_upper(optimiser, change);
    optimiser->work += (uint64_t)count * count / 2u;
    for (uint32_t k = 0; k < optimiser->inputs; k++)
        response[k] = -row[k];
    add_columns(optimiser, response, change);
    return pivot;
}

uint32_t pzs_dual_first_zero(const pzs_optimiser *optimiser, pzs_real sense, pzs_real *part)
{
    const pzs_real *change = dual_array(optimiser, DUAL_CHANGE);
    uint32_t first = optimiser->active_count;
    for (uint32_t k = 0; k < optimiser->active_count; k++) {
        const uint32_t i = optimiser->order[k];
        const pzs_real falls = optimiser->side[i] * sense * change[k];
        const pzs_real size = -optimiser->side[i] * optimiser->direction[i];
        if (falls > 0 && size < *part * falls && optimiser->lower[i] < optimiser->upper[i]) {
            *part = size > 0 ? size / falls : 0;
            first = k;
        }
    }
    return first;
}

void pzs_dual_advance(pzs_optimiser *optimiser, uint32_t i, pzs_real change)
{
    const pzs_real *others = dual_array(optimiser, DUAL_CHANGE);
    optimiser->multiplier_change += number_absolute(change);
    subtract_multiple(optimiser->next_voltage, dual_array(optimiser, DUAL_RESPONSE), -change,
                      optimiser->inputs);
    for (uint32_t k = 0; k < optimiser->active_count; k++)
        optimiser->direction[optimiser->order[k]] += change * others[k];
    optimiser->direction[i] += change;
}

bool pzs_dual_is_rounding(const pzs_optimiser *optimiser, pzs_real outside)
{
    return PIVOT_TO_VALUE * outside <= optimiser->pivot_rounding * optimiser->multiplier_change;
}

/*
 * Make one iteration of the dual active-set method: change the multiplier of free input i until the
 * voltage of this input reaches its bound (array `side`). The input then becomes active. If the
 * multiplier of an active input becomes zero before, the iteration ends there, and that input
 * becomes free. Returns false if neither happens.
 */
static bool pull_inside(pzs_optimiser *optimiser, uint32_t i)
{
    pzs_real *next = optimiser->next_voltage;
    const pzs_real sense = -optimiser->side[i], pivot = pzs_dual_find_response(optimiser, i);
    const pzs_real bound = dual_bound(optimiser, i);
    const pzs_real outside = sense * (bound - next[i]);
    const bool may_join = pzs_dual_may_join(optimiser, i, pivot);
    pzs_real part = outside > 0 ? outside / pivot : 0;
    if (!may_join)
        part = (pzs_real)HUGE_VAL;
    if (!may_join && pzs_dual_is_rounding(optimiser, outside)) {
        optimiser->waiting[i] = 1;
        return true;
    }
    const uint32_t zero = pzs_dual_first_zero(optimiser, sense, &part);
    if (!number_is_finite(part))
        return false;
    pzs_dual_advance(optimiser, i, sense * part);
    if (zero < optimiser->active_count) {
        leave_active_set(optimiser, zero);
    } else {
        join_active_set(optimiser, i, dual_array(optimiser, DUAL_SOLUTION), pivot);
        next[i] = bound;
    }
    return true;
}

/* ---- new choice of the active set ------------------------------------ */

/*
 * Return how many inputs contradict the optimality conditions: free inputs with a voltage outside
 * its bounds, and active inputs (voltages at a bound) whose multipliers have the wrong sign by more
 * than `rounding` (m2/V).
 */
static uint32_t count_errors(const pzs_optimiser *optimiser, pzs_real rounding)
{
    const pzs_real *next = optimiser->next_voltage;
    uint32_t errors = 0;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        const bool is_inside = next[i] >= optimiser->lower[i] && next[i] <= optimiser->upper[i];
        const bool is_free = optimiser->free_set[i] > 0;
        const bool is_error = is_free ? !is_inside : is_wrong(optimiser, i, rounding);
        errors += is_error ? 1u : 0u;
    }
    return errors;
}

/*
 * Make the voltages of all inputs free: set the multipliers of the active inputs (voltages at a
 * bound) to zero, and let the voltages next_voltage follow to the unconstrained optimum.
 */
static void release_all(pzs_optimiser *optimiser)
{
    pzs_real *change = dual_array(optimiser, DUAL_CHANGE);
    for (uint32_t k = 0; k < optimiser->active_count; k++) {
        change[k] = -optimiser->direction[optimiser->order[k]];
        optimiser->direction[optimiser->order[k]] = 0;
    }
    add_columns(optimiser, optimiser->next_voltage, change);
    pzs_dual_free_all(optimiser);
}

/*
 * Estimate the optimal voltages by SWEEPS sweeps over the inputs. In a sweep each input in turn
 * goes to the minimum of the objective over its own voltage within its bounds.
 *   voltage  [width] out  estimated voltages (V)
 *   gradient [width] out  half the gradient of the objective at these voltages (m2/V)
 */
static void estimate_voltages(pzs_optimiser *optimiser, pzs_real *restrict voltage,
                              pzs_real *restrict gradient)
{
    const size_t width = optimiser->width;
    memcpy(voltage, optimiser->voltage, width * sizeof *voltage);
    memcpy(gradient, optimiser->gradient, width * sizeof *gradient);
    for (uint32_t k = 0; k < SWEEPS * optimiser->inputs; k++) {
        const uint32_t i = k % optimiser->inputs;
        const pzs_real from = voltage[i];
        voltage[i] = number_clamp(from - gradient[i] / optimiser->diagonal[i], optimiser->lower[i],
                                  optimiser->upper[i]);
        if (voltage[i] < from || voltage[i] > from)
            subtract_multiple(gradient, optimiser->hessian + i * width, from - voltage[i],
                              (uint32_t)width);
    }
    optimiser->work += SWEEPS * (PZS_PRODUCT_WORK(optimiser->inputs) + width);
}

void pzs_dual_join(pzs_optimiser *optimiser, uint32_t i, pzs_real side)
{
    const pzs_real pivot = find_factor_row(optimiser, i);
    if (!(pivot > least_pivot(optimiser, i)))
        return;
    optimiser->side[i] = side;
    optimiser->direction[i] = 0;
    join_active_set(optimiser, i, dual_array(optimiser, DUAL_SOLUTION), pivot);
}

/*
 * Replace the active set (inputs kept at a bound) by an estimate, if the work limit allows this. An
 * input becomes active if its estimated optimal voltage is at a bound and the gradient would drive
 * it beyond.
 */
static void choose_anew(pzs_optimiser *optimiser)
{
    pzs_real *voltage = dual_array(optimiser, DUAL_RESPONSE),
             *gradient = dual_array(optimiser, DUAL_COSINE);
    const uint64_t products = SWEEPS + 6u + optimiser->inputs / 6u;
    if (!pzs_dual_affords(optimiser, products * PZS_PRODUCT_WORK(optimiser->inputs)))
        return;
    release_all(optimiser);
    estimate_voltages(optimiser, voltage, gradient);
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        if (!number_is_finite(voltage[i]))
            continue;
        if (voltage[i] <= optimiser->lower[i] && gradient[i] > 0)
            pzs_dual_join(optimiser, i, -1);
        else if (voltage[i] >= optimiser->upper[i] && gradient[i] < 0)
            pzs_dual_join(optimiser, i, 1);
    }
    optimiser->iterations++;
    pzs_dual_move_to_bounds(optimiser);
}

/* ---- course of a round of iterations --------------------------------- */

bool pzs_dual_may_iterate(pzs_optimiser *optimiser, uint64_t extra)
{
    const uint64_t count = optimiser->active_count + 1u;
    const uint64_t work = count * (3u * count + optimiser->width);
    const uint64_t loops = PZS_ITERATION_LOOPS * (uint64_t)optimiser->width;
    optimiser->is_cut = !pzs_dual_affords(optimiser, work + loops + extra);
    if (optimiser->is_cut)
        return false;
    optimiser->iterations++;
    optimiser->work += loops;
    return true;
}

/*
 * Move the voltages of free inputs from outside to their bounds, one after the other, until none is
 * outside or the optimiser has made `enough` iterations. Returns false if this ends earlier, at the
 * work limit or after `most` iterations.
 */
static bool pull_all_inside(pzs_optimiser *optimiser, uint32_t enough, uint32_t most)
{
    uint32_t pulled = pzs_dual_choose_outside(optimiser);
    bool goes_on = !optimiser->is_cut;
    while (goes_on && pulled < optimiser->inputs) {
        goes_on = optimiser->iterations < most && pzs_dual_may_iterate(optimiser, 0) &&
                  pull_inside(optimiser, pulled);
        const bool is_done = !(optimiser->free_set[pulled] > 0) || optimiser->waiting[pulled] > 0;
        if (goes_on && is_done)
            pulled = optimiser->iterations < enough ? pzs_dual_choose_outside(optimiser)
                                                    : optimiser->inputs;
    }
    return goes_on;
}

uint32_t pzs_dual_begin_round(pzs_optimiser *optimiser)
{
    optimiser->is_cut = false;
    memset(optimiser->waiting, 0, optimiser->width * sizeof *optimiser->waiting);
    return optimiser->iterations + 4u * optimiser->inputs + 8u;
}

void pzs_dual_take_voltages(pzs_optimiser *optimiser)
{
    pzs_real *next = optimiser->next_voltage;
    for (uint32_t k = 0; k < optimiser->active_count; k++)
        next[optimiser->order[k]] = dual_bound(optimiser, optimiser->order[k]);
    for (uint32_t i = 0; i < optimiser->inputs; i++)
        optimiser->voltage[i] = number_clamp(next[i], optimiser->lower[i], optimiser->upper[i]);
}

bool pzs_iterate_dual(pzs_optimiser *optimiser, pzs_real rounding)
{
    const uint32_t most = pzs_dual_begin_round(optimiser);
    pzs_dual_drop_wrong(optimiser, rounding);
    const bool is_complete = pull_all_inside(optimiser, most, most);
    pzs_dual_take_voltages(optimiser);
    return is_complete;
}

bool pzs_run_round_dual(pzs_optimiser *optimiser, pzs_real rounding)
{
    const uint32_t inputs = optimiser->inputs, trial = inputs / TRIAL_PART;
    const uint32_t most = pzs_dual_begin_round(optimiser);
    uint32_t errors = count_errors(optimiser, rounding);
    if (WRONG_PART * errors >= inputs && inputs < FEW_RIGHT * (inputs - errors) &&
        optimiser->active_count <= trial) {
        pzs_dual_drop_wrong(optimiser, rounding);
        (void)pull_all_inside(optimiser, optimiser->iterations + trial, most);
        errors = count_errors(optimiser, rounding);
    }
    if (WRONG_PART * errors >= inputs)
        choose_anew(optimiser);
    return pzs_iterate_dual(optimiser, rounding);
}

const struct pzs_dual_calls pzs_dual_method = {
    .predict_step = pzs_predict_step_dual,
    .is_at_bounds = pzs_is_at_bounds_dual,
    .run_round = pzs_run_round_dual,
    .check_active = pzs_check_active_dual,
};
