/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The voltage optimiser: a primal active-set method that works on one symmetric matrix, the
 * tableau. All voltages that it computes on the way are inside their bounds.
 *
 *   H        Hessian
 *   F        free set: inputs whose voltages may change
 *   A        active set: all others; their voltages are kept, most at a bound, some between the
 *            bounds
 *   tableau  H after one pivot exchange for each input of F
 *   round    the full step to the minimum over F if all conditions allow it, otherwise a sequence
 *            of iterations; it ends with the gradient computed from H
 *
 *   - Rounding errors of the tableau do not make the result wrong, because every round ends with a
 *     gradient computed from H; they only cause more rounds.
 *   - The optimiser begins no work that could exceed the work limit (multiply-adds) together with
 *     the matrix product at the end of the round. The next tick continues from the voltages and the
 *     free set reached.
 *   - From PZS_DUAL_INPUTS inputs on, if no input depends linearly on the others, the iterations
 *     are those of the dual active-set method (boxls_dual.h).
 */
#include <string.h>
#include "boxls.h"
#include "boxls_dual.h"
#include "boxls_tableau.h"
#include "../core/numbers.h"
#include "../core/product.h"
#include "../core/product_wide.h"

/*
 * Largest number of rounds (sequences of iterations, each followed by the gradient computed from
 * the Hessian) in one call of the optimiser.
 */
#define ROUNDS 8u
/*
 * Number of pivot exchanges per input after which the optimiser recomputes its pivoted Hessian (the
 * tableau) if the tableau has predicted a wrong gradient.
 */
#define WORN 2u
/*
 * Largest number of iterations in which several inputs leave their bounds together, in one round. A
 * round is a sequence of iterations that ends with a gradient computed from the Hessian.
 */
#define TOGETHER 8u
/*
 * Smallest number of inputs that leave their bounds together in one iteration of the optimiser;
 * fewer inputs leave them one after the other.
 */
#define LEAST_TOGETHER 3u
/*
 * A violation of the optimality (KKT) conditions below this multiple of its rounding-error bound
 * counts as zero.
 */
#define ROUNDING_FACTOR 4
/*
 * The voltages are accepted as optimal although a violation of the optimality (KKT) conditions
 * exceeds its rounding-error bound, if it is at most this multiple of the bound. Before the end of
 * the optimisation its effect on the objective must be negligible, too (is_negligible).
 */
#define TOLERATED PZS_BY_BITS(256, 2048)
/*
 * Safety factor for errors of the gradient that the tableau (pivoted Hessian) predicts after a
 * step. The optimiser computes two entries of the gradient from the Hessian for comparison. It
 * assumes that no other entry has an error above this factor times the error of these two.
 */
#define UNMEASURED_FACTOR 8
/* A decrease of the objective counts only if it exceeds this multiple of its rounding error. */
#define SIGNIFICANT 16
/*
 * Smallest factor by which a round (sequence of iterations) must divide the violation of the
 * optimality (KKT) conditions. After less progress the optimiser recomputes its pivoted Hessian
 * (the tableau).
 */
#define LEAST_PROGRESS 16

void pzs_boxls_place(pzs_optimiser *optimiser, pzs_real *work)
{
    pzs_real **const vector[] = {&optimiser->lower,
                                 &optimiser->upper,
                                 &optimiser->free_set,
                                 &optimiser->base,
                                 &optimiser->regularisation_gradient,
                                 &optimiser->target_gradient,
                                 &optimiser->model_gradient,
                                 &optimiser->gradient,
                                 &optimiser->direction,
                                 &optimiser->diagonal,
                                 &optimiser->start_voltage,
                                 &optimiser->start_gradient,
                                 &optimiser->next_voltage,
                                 &optimiser->scratch,
                                 &optimiser->pivot,
                                 &optimiser->waiting,
                                 &optimiser->pending};
    for (uint32_t k = 0; k < sizeof vector / sizeof *vector; k++)
        *vector[k] = work + (size_t)k * optimiser->width;
    pzs_tableau_collect(optimiser, optimiser->pending);
}

/* ---- gradient of the objective --------------------------------------- */

/*
 * Multiply a symmetric matrix [inputs][width] by a vector [width], and count the multiply-adds. The
 * width is the number of inputs rounded up to whole vectors of the processor.
 */
static void multiply_symmetric(pzs_optimiser *optimiser, pzs_real *restrict product,
                               const pzs_real *restrict matrix, const pzs_real *restrict vector)
{
    pzs_product_sum_rows(product, matrix, optimiser->width, vector, optimiser->inputs,
                         optimiser_span(optimiser));
    optimiser->work += PZS_PRODUCT_WORK(optimiser->inputs);
}

/*
 * Compute half the gradient of the objective for all inputs: its part that depends on the voltages
 * minus its part that depends on the target shape. The array `next` receives the entries of the
 * inputs whose voltages are free, and 0 for the others.
 */
static void combine_gradients(pzs_real *restrict gradient, pzs_real *restrict next,
                              const pzs_real *restrict model_gradient,
                              const pzs_real *restrict target_gradient,
                              const pzs_real *restrict free_set, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real difference = model_gradient[i] - target_gradient[i];
        gradient[i] = difference;
        next[i] = free_set[i] > 0 ? difference : 0;
    }
}

void pzs_boxls_gradient(pzs_optimiser *optimiser)
{
    combine_gradients(optimiser->gradient, optimiser->next_voltage, optimiser->model_gradient,
                      optimiser->target_gradient, optimiser->free_set, optimiser_span(optimiser));
}

static void set_difference(pzs_real *restrict difference, const pzs_real *restrict left,
                           const pzs_real *restrict right, size_t span)
{
    for (size_t i = 0; i < span; i++)
        difference[i] = left[i] - right[i];
}

static void add_vector(pzs_real *restrict sum, const pzs_real *restrict vector, size_t span)
{
    for (size_t i = 0; i < span; i++)
        sum[i] += vector[i];
}

/*
 * Return the rounding-error bound of the product of the Hessian with `offset`, the voltages minus
 * the base voltages around which the gradient is computed (m2/V).
 */
static pzs_real rounding_of_product(const pzs_optimiser *optimiser, const pzs_real *offset)
{
    return PZS_EPSILON * pzs_product_dot_size(optimiser->diagonal, offset, optimiser->width);
}

void pzs_boxls_true_gradient(pzs_optimiser *optimiser)
{
    set_difference(optimiser->scratch, optimiser->voltage, optimiser->base,
                   optimiser_span(optimiser));
    optimiser->model_rounding = rounding_of_product(optimiser, optimiser->scratch);
    multiply_symmetric(optimiser, optimiser->model_gradient, optimiser->hessian,
                       optimiser->scratch);
    add_vector(optimiser->model_gradient, optimiser->regularisation_gradient,
               optimiser_span(optimiser));
    optimiser->is_predicted = false;
    pzs_boxls_gradient(optimiser);
}

/*
 * Return by how much one voltage violates the optimality (KKT) conditions (m2/V). Between its
 * bounds the violation is the absolute value of the gradient. At a bound it is the part of the
 * negative gradient that points from the bound into the permitted range; a negative value is no
 * violation.
 */
static inline pzs_real entry_violation(pzs_real gradient, pzs_real voltage, pzs_real lower,
                                       pzs_real upper)
{
    const pzs_real falls = voltage < upper ? number_absolute(gradient) : gradient;
    const pzs_real stays = voltage < upper ? -gradient : 0;
    return voltage > lower ? falls : stays;
}

/*
 * Predict a full step along the search direction. Returns the number of inputs that prevent it:
 * free ones that would exceed a bound, and active ones that would violate the optimality (KKT)
 * conditions by more than `rounding`.
 *   move   in/out  for a free input the change of its voltage (V). For an active input in: product
 *                  of the tableau with the gradient, out: gradient after the step (m2/V)
 *   next   out     voltages after the step (V)
 *   offset out     voltages after the step minus the base voltages, around which the gradient is
 *                  computed (V)
 */
static size_t predict_step(pzs_real *restrict move, pzs_real *restrict next,
                           pzs_real *restrict offset, const pzs_real *restrict free_set,
                           const pzs_real *restrict gradient, const pzs_real *restrict voltage,
                           const pzs_real *restrict lower, const pzs_real *restrict upper,
                           const pzs_real *restrict base, pzs_real rounding, size_t span)
{
    size_t open = 0;
    for (size_t i = 0; i < span; i++) {
        const pzs_real start = voltage[i], low = lower[i], high = upper[i], way = move[i];
        const pzs_real end = start + way, slope = gradient[i] - way;
        const bool is_free = free_set[i] > 0;
        const pzs_real moved = is_free ? end : start;
        const pzs_real kept = is_free ? way : slope;
        const pzs_real violation = is_free ? 0 : entry_violation(slope, start, low, high);
        move[i] = kept;
        next[i] = moved;
        offset[i] = moved - base[i];
        open += violation <= rounding && moved >= low && moved <= high ? 0u : 1u;
    }
    return open;
}

uint32_t pzs_boxls_find_direction(pzs_optimiser *optimiser, pzs_real rounding)
{
    tableau_apply_collected(optimiser);
    multiply_symmetric(optimiser, optimiser->direction, optimiser->tableau,
                       optimiser->next_voltage);
    if (optimiser_is_dual(optimiser) && optimiser->active_count > 0)
        return optimiser->dual->predict_step(optimiser, rounding);
    return (uint32_t)predict_step(optimiser->direction, optimiser->next_voltage, optimiser->scratch,
                                  optimiser->free_set, optimiser->gradient, optimiser->voltage,
                                  optimiser->lower, optimiser->upper, optimiser->base, rounding,
                                  optimiser_span(optimiser));
}

static void entry_violations(pzs_real *restrict out, const pzs_real *restrict voltage,
                             const pzs_real *restrict lower, const pzs_real *restrict upper,
                             const pzs_real *restrict gradient, size_t span)
{
    for (size_t i = 0; i < span; i++)
        out[i] = entry_violation(gradient[i], voltage[i], lower[i], upper[i]);
}

pzs_real pzs_boxls_violation(const pzs_optimiser *optimiser, const pzs_real *voltage,
                             const pzs_real *gradient)
{
    entry_violations(optimiser->scratch, voltage, optimiser->lower, optimiser->upper, gradient,
                     optimiser_span(optimiser));
    return pzs_product_largest(optimiser->scratch, optimiser->width);
}

/*
 * Whether a gradient is negligible: the objective is then expected to lie above its minimum over
 * the free voltages by at most the machine epsilon times target_energy, the scale of the objective.
 *   size in  largest entry of the gradient for a free input (m2/V). If the entries are independent
 *            rounding errors, the objective is expected to lie above its minimum by at most half of
 *            size^2 times the trace of the inverse of the Hessian of the free inputs; for any other
 *            entries by at most the number of inputs times as much
 */
static bool is_negligible(pzs_optimiser *optimiser, pzs_real size)
{
    const pzs_real square = size * size, most = PZS_EPSILON * optimiser->target_energy;
    if (optimiser->inverse_trace_bound > 0 && square * optimiser->inverse_trace_bound <= most)
        return true;
    if (optimiser->whole_inverse_trace > 0 && square * optimiser->whole_inverse_trace <= most)
        return true;
    const pzs_real soft = pzs_tableau_inverse_trace(optimiser);
    return soft >= 0 && square * soft <= most;
}

bool pzs_boxls_needs_new_base(pzs_optimiser *optimiser)
{
    if (!IS_WIDE && product_is_wide(optimiser->inputs))
        return pzs_boxls_needs_new_base_wide(optimiser);
    return !is_negligible(optimiser, optimiser->model_rounding);
}

/*
 * Compute the violation of the optimality (KKT) conditions for each active input (whose voltage is
 * kept), and 0 for free inputs.
 *   turn in  absolute value up to which the sign of a gradient is uncertain (m2/V); a gradient
 *            within it counts as a violation of the size `turn`, unless both bounds of the input
 *            are equal
 */
static void active_violations(pzs_real *restrict out, const pzs_real *restrict voltage,
                              const pzs_real *restrict lower, const pzs_real *restrict upper,
                              const pzs_real *restrict gradient, const pzs_real *restrict free_set,
                              pzs_real turn, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real violation = entry_violation(gradient[i], voltage[i], lower[i], upper[i]);
        const bool may_turn = number_absolute(gradient[i]) <= turn && lower[i] < upper[i];
        const pzs_real counts = may_turn ? turn : violation;
        out[i] = free_set[i] > 0 ? 0 : counts;
    }
}

/*
 * Return the largest violation of the optimality (KKT) conditions by an active input (whose voltage
 * is kept). Overwrites the array scratch.
 *   turn in  absolute value up to which the sign of a gradient is uncertain (m2/V); a gradient
 *            within it counts as a violation of the size `turn`
 */
static pzs_real largest_active_violation(const pzs_optimiser *optimiser, const pzs_real *gradient,
                                         pzs_real turn)
{
    active_violations(optimiser->scratch, optimiser->voltage, optimiser->lower, optimiser->upper,
                      gradient, optimiser->free_set, turn, optimiser_span(optimiser));
    return pzs_product_largest(optimiser->scratch, optimiser->width);
}

/*
 * Whether the voltages are optimal: no violation of the KKT conditions exceeds its rounding-error
 * bound. A violation up to TOLERATED times the bound is accepted under three conditions: only free
 * inputs have it, it hardly raises the objective, and it cannot change the sign of any multiplier.
 */
static bool is_converged(pzs_optimiser *optimiser)
{
    // A voltage that is not finite makes the rounding-error bound infinite or NaN.
    if (!number_is_finite(optimiser->rounding_bound))
        return 0;
    if (optimiser->kkt_violation <= optimiser->rounding_bound)
        return 1;
    if (!(optimiser->kkt_violation <= TOLERATED * optimiser->rounding_bound) ||
        !is_negligible(optimiser, optimiser->kkt_violation))
        return 0;
    if (optimiser->active_count == 0)
        return 1;
    const pzs_real turn = (pzs_real)optimiser->inputs * optimiser->kkt_violation;
    return largest_active_violation(optimiser, optimiser->gradient, turn) <=
           optimiser->rounding_bound;
}

/* ---- iterations of the active-set method ----------------------------- */

/*
 * Iterations of the active-set method, with free set F (voltages that may change) and active set A
 * (voltages that are kept):
 *   descent           Move along the search direction to the minimum over F. An input that reaches
 *                     a bound stays there and leaves F.
 *   release together  At a minimum over F: move several inputs of A towards their opposite bounds,
 *                     those that would reach them if released alone. F follows so that its gradient
 *                     stays zero. Stop at the minimum along this line, or where an input of F
 *                     reaches a bound.
 *   release           At a minimum over F: move one input of A while F follows. If the minimum
 *                     along this line is nearer than the bound of the input, the input joins F
 *                     there.
 */

/*
 * Why the iterations end: let f be the number of inputs in the free set F, and m the number of
 * inputs outside F whose voltages lie strictly between their bounds.
 *
 *   - A descent that a bound stops lowers 2 m + f, and so does the release of an input between its
 *     bounds. This number is at most 2 n for n inputs.
 *   - After at most 3 n iterations the voltages thus minimise the objective on a face of the
 *     feasible box. Only then an input at a bound is released.
 *   - An iteration of zero length makes F smaller; one of positive length lowers the objective. No
 *     face occurs twice, and the number of faces is finite.
 *   - Releases of several inputs together never raise the objective, and their number in a round
 *     (sequence of iterations) is limited.
 */

typedef struct blocking {
    pzs_real part;  /* fraction of a change of all free voltages after which the first of them
                       reaches a bound (dimensionless) */
    uint32_t input; /* index of the first input whose voltage reaches a bound; the number of inputs
                       if no voltage does */
} blocking;

/*
 * Return the distance of a voltage from the bound towards which it changes (V): from its lower
 * bound if the change `way` is negative, otherwise from its upper bound.
 */
static inline pzs_real distance_to_bound(pzs_real way, pzs_real voltage, pzs_real lower,
                                         pzs_real upper)
{
    return way < 0 ? voltage - lower : upper - voltage;
}

/*
 * Mark the free inputs whose voltages would pass a bound if all free voltages changed by the vector
 * `move` [inputs] (V) times `sense` (1 or -1) times `part`: mark [width] receives 1 for these
 * inputs, 0 for the others. Returns the number of marked inputs.
 */
static size_t mark_blocking(pzs_real *restrict mark, const pzs_real *restrict move,
                            const pzs_real *restrict free_set, const pzs_real *restrict voltage,
                            const pzs_real *restrict lower, const pzs_real *restrict upper,
                            pzs_real sense, pzs_real part, size_t span)
{
    size_t count = 0;
    for (size_t i = 0; i < span; i++) {
        const pzs_real way = sense * move[i], size = number_absolute(way);
        const pzs_real room = distance_to_bound(way, voltage[i], lower[i], upper[i]);
        const pzs_real blocks = room < part * size ? 1 : 0;
        const pzs_real marked = free_set[i] > 0 ? blocks : 0;
        mark[i] = marked;
        count += marked > 0 ? 1u : 0u;
    }
    return count;
}

/*
 * Find the free input whose voltage reaches a bound first, if all free voltages change along the
 * line move * sense, up to the fraction `part` of `move`. Returns this input and the fraction at
 * which it reaches the bound.
 *   move [inputs] in  change of the voltages (V)
 *   sense         in  1 or -1
 */
static blocking first_blocking(const pzs_optimiser *optimiser, const pzs_real *move, pzs_real sense,
                               pzs_real part)
{
    const pzs_real *voltage = optimiser->voltage;
    const pzs_real *lower = optimiser->lower, *upper = optimiser->upper;
    const pzs_real *mark = IS_WIDE ? optimiser->waiting : optimiser->free_set;
    const uint32_t inputs = optimiser->inputs;
    blocking first = {part, inputs};
    // With vector instructions, first find out for all free inputs at once whether their voltages
    // would pass a bound; only those that would are then compared one by one.
    if (IS_WIDE && mark_blocking(optimiser->waiting, move, optimiser->free_set, voltage, lower,
                                 upper, sense, part, optimiser_span(optimiser)) == 0)
        return first;
    for (uint32_t i = 0; i < inputs; i++) {
        if (!(mark[i] > 0))
            continue;
        const pzs_real way = sense * move[i], size = number_absolute(way);
        const pzs_real room = distance_to_bound(way, voltage[i], lower[i], upper[i]);
        if (room < first.part * size) {
            first.part = room / size;
            first.input = i;
        }
    }
    return first;
}

/* Change the free voltages by the vector `move` [span] (V) times `far`, clamped to their bounds. */
static void move_free(pzs_real *restrict voltage, const pzs_real *restrict move,
                      const pzs_real *restrict free_set, const pzs_real *restrict lower,
                      const pzs_real *restrict upper, pzs_real far, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        pzs_real end = voltage[i];
        if (free_set[i] > 0)
            end = number_clamp(end + far * move[i], lower[i], upper[i]);
        voltage[i] = end;
    }
}

/*
 * Change the free voltages by the vector `move` [inputs] (V) times `sense` (1 or -1) times the
 * fraction first.part, clamped to their bounds. The voltage of input first.input, which reaches its
 * bound there, is set to the bound exactly.
 */
static void move_along(pzs_optimiser *optimiser, const pzs_real *move, pzs_real sense,
                       blocking first)
{
    move_free(optimiser->voltage, move, optimiser->free_set, optimiser->lower, optimiser->upper,
              sense * first.part, optimiser_span(optimiser));
    if (first.input < optimiser->inputs) {
        const bool down = sense * move[first.input] < 0;
        optimiser->voltage[first.input] =
            down ? optimiser->lower[first.input] : optimiser->upper[first.input];
    }
}

/*
 * Move input j, whose voltage has reached a bound, from the free set to the active set of the
 * optimiser, in which voltages are kept constant. The array next_voltage is overwritten.
 */
static void leave_free_set(pzs_optimiser *optimiser, uint32_t j)
{
    pzs_tableau_row(optimiser, j, optimiser->next_voltage);
    pzs_tableau_exchange(optimiser, j, optimiser->next_voltage);
    optimiser->direction[j] = 0;
}

/*
 * Update the prediction of a step after one input has reached a bound and become active: the search
 * direction of the free inputs, and the gradient of the active inputs, whose voltages are kept.
 *   row [width] in  row of the input at the bound in the tableau (pivoted Hessian)
 *   rest        in  part of the step that is left, as a fraction of the whole step (dimensionless)
 *   remaining   in  part of its own step that the input at the bound cannot make (V)
 */
static void update_direction(pzs_real *restrict direction, const pzs_real *restrict row,
                             const pzs_real *restrict free_set, pzs_real rest, pzs_real remaining,
                             size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real left = free_set[i] > 0 ? rest : 1;
        const pzs_real factor = free_set[i] > 0 ? remaining : -remaining;
        direction[i] = direction[i] * left + factor * row[i];
    }
}

/*
 * Make one descent iteration: change the free voltages along the search direction to its end, or
 * until the first of them reaches a bound and becomes active. Returns whether a bound ended the
 * change.
 */
static bool descend(pzs_optimiser *optimiser)
{
    pzs_real *direction = optimiser->direction;
    const blocking first = first_blocking(optimiser, direction, 1, 1);
    move_along(optimiser, direction, 1, first);
    if (first.input == optimiser->inputs)
        return false;
    const pzs_real rest = 1 - first.part, remaining = direction[first.input] * rest;
    leave_free_set(optimiser, first.input);
    update_direction(direction, optimiser->next_voltage, optimiser->free_set, rest, remaining,
                     optimiser_span(optimiser));
    return true;
}

/* Add a vector [span] times a factor to the vector `sum` [span]. */
static void add_multiple(pzs_real *restrict sum, const pzs_real *restrict vector, pzs_real factor,
                         size_t span)
{
    for (size_t i = 0; i < span; i++)
        sum[i] += factor * vector[i];
}

/*
 * Choose an active input (whose voltage is kept) to be released: the one that violates the
 * optimality (KKT) conditions most, by more than `rounding` (m2/V). Inputs whose voltages lie
 * between their bounds take precedence over those at a bound. Returns the number of inputs if there
 * is no violation.
 */
static uint32_t input_to_release(const pzs_optimiser *optimiser, pzs_real rounding)
{
    const pzs_real *free_set = optimiser->free_set, *voltage = optimiser->voltage;
    const pzs_real *lower = optimiser->lower, *upper = optimiser->upper;
    const uint32_t inputs = optimiser->inputs;
    uint32_t between = inputs, at_bound = inputs;
    pzs_real most_between = rounding, most_at_bound = rounding;
    for (uint32_t i = 0; i < inputs; i++) {
        const pzs_real slope = optimiser->direction[i], size = number_absolute(slope);
        if (free_set[i] > 0 || !(size > most_at_bound || size > most_between))
            continue;
        if (!(distance_to_bound(-slope, voltage[i], lower[i], upper[i]) > 0))
            continue;
        if (voltage[i] > lower[i] && voltage[i] < upper[i]) {
            most_between = size > most_between ? size : most_between;
            between = size >= most_between ? i : between;
        } else if (size > most_at_bound) {
            most_at_bound = size;
            at_bound = i;
        }
    }
    return between < optimiser->inputs ? between : at_bound;
}

/*
 * Return how far the voltage of input k can move away from the bound at which it was kept (V). The
 * free voltages follow so that their gradient stays zero. The motion ends at the minimum of the
 * objective on this straight line, or at the other bound of input k.
 */
static pzs_real ray_length(const pzs_optimiser *optimiser, uint32_t k, pzs_real pivot,
                           bool *to_limit)
{
    const pzs_real slope = number_absolute(optimiser->direction[k]);
    const pzs_real room = distance_to_bound(-optimiser->direction[k], optimiser->voltage[k],
                                            optimiser->lower[k], optimiser->upper[k]);
    // Where the voltage of input k depends linearly on the free ones, the curvature along the line
    // is about 0. A small positive curvature then lets the motion end at the bound of input k.
    const pzs_real floor = number_is_finite(room) ? PZS_EPSILON : optimiser->pivot_floor;
    const pzs_real least = floor * optimiser->diagonal[k];
    const pzs_real curvature = pivot > least ? pivot : least;
    *to_limit = !(slope < room * curvature);
    return *to_limit ? room : slope / curvature;
}

/*
 * Move the voltage of input k, which was kept at a bound, by up to `length` (V), and update the
 * gradients of the other inputs at bounds. The free voltages follow so that their gradient stays
 * zero; the first of them that reaches a bound ends the motion. Returns this input and the length
 * of the motion.
 */
static blocking move_along_ray(pzs_optimiser *optimiser, uint32_t k, const pzs_real *row,
                               pzs_real length)
{
    const pzs_real sense = optimiser->direction[k] > 0 ? (pzs_real)1 : (pzs_real)-1;
    const blocking first = first_blocking(optimiser, row, sense, length);
    if (!number_is_finite(first.part))
        return first;
    const pzs_real far = -sense * first.part;
    move_along(optimiser, row, sense, first);
    optimiser->voltage[k] =
        number_clamp(optimiser->voltage[k] + far, optimiser->lower[k], optimiser->upper[k]);
    add_multiple(optimiser->direction, row, far, optimiser_span(optimiser));
    return first;
}

/*
 * Make one release iteration: change the voltage of input k, which was kept at a bound but violates
 * the optimality (KKT) conditions, while the free voltages follow so that their gradient stays
 * zero.
 */
static void release_input(pzs_optimiser *optimiser, uint32_t k)
{
    pzs_real *row = optimiser->next_voltage;
    const bool down = optimiser->direction[k] > 0;
    bool to_limit;
    pzs_tableau_row(optimiser, k, row);
    const pzs_real length = ray_length(optimiser, k, row[k], &to_limit);
    const blocking first = move_along_ray(optimiser, k, row, length);
    if (first.input < optimiser->inputs) {
        leave_free_set(optimiser, first.input);
    } else if (to_limit && number_is_finite(first.part)) {
        optimiser->voltage[k] = down ? optimiser->lower[k] : optimiser->upper[k];
    } else {
        optimiser->direction[k] = 0; /* set the gradient with respect to input k to exactly zero, so
                                        that its voltage is not changed again: the motion has
                                        reached the minimum of the objective, or nothing limits it,
                                        neither a finite bound nor a curvature */
        // The pivot exchange, which makes an input free, is left out for an input whose effect on
        // the shape is a linear combination of the effects of the free inputs.
        if (!to_limit && pzs_tableau_independence(optimiser, k) > optimiser->pivot_floor)
            pzs_tableau_exchange(optimiser, k, row);
    }
}

/*
 * Count one more iteration of the optimiser, if the work limit allows the multiply-adds of an
 * iteration plus `more`. Otherwise set is_cut: the work limit has stopped the optimiser. Returns
 * whether the iteration may be made.
 */
static bool may_iterate(pzs_optimiser *optimiser, uint64_t more)
{
    const uint64_t work = PZS_ITERATION_WORK(optimiser->inputs);
    optimiser->is_cut = !optimiser_affords(optimiser, work + more);
    if (optimiser->is_cut)
        return false;
    optimiser->iterations++;
    optimiser->work += PZS_ITERATION_LOOPS * optimiser->width;
    return true;
}

/*
 * Find the active inputs (whose voltages are kept) that can be released together. Such an input
 * violates the optimality (KKT) conditions by more than `rounding`, and released alone it would
 * move to its opposite bound.
 *   way [width] out  for each of these inputs the distance to that bound, with sign; 0 for all
 *                    others (V)
 * Returns the number of these inputs.
 */
static uint32_t collect_releases(const pzs_optimiser *optimiser, pzs_real rounding, pzs_real *way)
{
    const pzs_real *free_set = optimiser->free_set, *voltage = optimiser->voltage;
    const pzs_real *lower = optimiser->lower, *upper = optimiser->upper;
    uint32_t count = 0;
    memset(way, 0, optimiser->width * sizeof *way);
    for (uint32_t i = 0, inputs = optimiser->inputs; i < inputs; i++) {
        const pzs_real slope = optimiser->direction[i], size = number_absolute(slope);
        if (free_set[i] > 0 || !(size > rounding))
            continue;
        const pzs_real room = distance_to_bound(-slope, voltage[i], lower[i], upper[i]);
        if (number_is_finite(room) && room > 0 && size > room * optimiser->pivot[i]) {
            way[i] = slope > 0 ? -room : room;
            count++;
        }
    }
    return count;
}

/*
 * Release together the inputs that collect_releases finds: each moves towards its other bound,
 * while the free voltages follow so that their gradient stays zero. The change ends at the minimum
 * of the objective, or where a free input reaches a bound. Returns whether any voltage has changed.
 */
static bool release_together(pzs_optimiser *optimiser, pzs_real rounding)
{
    pzs_real *way = optimiser->next_voltage, *change = optimiser->scratch;
    if (collect_releases(optimiser, rounding, way) < LEAST_TOGETHER ||
        !may_iterate(optimiser, PZS_PRODUCT_WORK(optimiser->inputs)))
        return false;
    pzs_tableau_apply(optimiser);
    multiply_symmetric(optimiser, change, optimiser->tableau, way);
    const pzs_real slope = pzs_product_dot(optimiser->direction, way, optimiser->width);
    const pzs_real curvature = pzs_product_dot(change, way, optimiser->width);
    const pzs_real most = -slope < curvature ? -slope / curvature : 1;
    const blocking first = first_blocking(optimiser, change, -1, most);
    if (!number_is_finite(first.part) || !(slope < 0))
        return false;
    move_along(optimiser, change, -1, first);
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        const pzs_real end = way[i] < 0 ? optimiser->lower[i] : optimiser->upper[i];
        const pzs_real stop = first.part < 1 ? optimiser->voltage[i] + first.part * way[i] : end;
        if (number_absolute(way[i]) > 0)
            optimiser->voltage[i] = number_clamp(stop, optimiser->lower[i], optimiser->upper[i]);
        optimiser->direction[i] += first.part * change[i];
    }
    if (first.input < optimiser->inputs)
        leave_free_set(optimiser, first.input);
    return true;
}

/*
 * Whether the gradient of every free input (whose voltage may change) is within its rounding-error
 * bound, and, in the dual active-set method, every other voltage is at its bound.
 */
static bool is_stationary(const pzs_optimiser *optimiser)
{
    if (optimiser_is_dual(optimiser) && !optimiser->dual->is_at_bounds(optimiser))
        return false;
    uint32_t i = 0;
    // The array next_voltage holds the gradients of the free inputs here (m2/V), before it receives
    // voltages.
    while (i < optimiser->inputs &&
           number_absolute(optimiser->next_voltage[i]) <= optimiser->rounding_bound)
        i++;
    return i == optimiser->inputs;
}

/*
 * Iterate, after a bound has blocked the full step along the search direction, until no voltage
 * violates the optimality (KKT) conditions. First come descent iterations, until no bound blocks
 * the free voltages; then active inputs, whose voltages were kept, are released. May be called
 * before the collected pivot exchanges are applied to the tableau (pivoted Hessian).
 */
static void iterate(pzs_optimiser *optimiser, pzs_real rounding)
{
    const uint32_t most = optimiser->iterations + 4u * optimiser->inputs + 8u;
    bool blocked = true;
    pzs_tableau_read_pivots(optimiser);
    // A descent takes an input out of the free set, so that there are no more descents than inputs.
    // Damaged memory, which may put inputs back and raise the work limit, could make them endless.
    while (blocked && optimiser->iterations < most && may_iterate(optimiser, 0))
        blocked = descend(optimiser);
    blocked = blocked || !(largest_active_violation(optimiser, optimiser->direction, 0) > rounding);
    for (uint32_t k = 0; !blocked && k < TOGETHER && release_together(optimiser, rounding); k++)
        continue;
    while (!blocked && optimiser->iterations < most) {
        const uint32_t k = input_to_release(optimiser, rounding);
        if (k == optimiser->inputs || !may_iterate(optimiser, 0))
            break;
        release_input(optimiser, k);
    }
}

/* ---- whole step as one iteration ------------------------------------- */

/*
 * Compute from the Hessian, for input k after a predicted step, the part of the gradient that
 * depends on the voltages, into *model_gradient (m2/V). Returns the error of the predicted gradient
 * of this input: its absolute difference from the computed one (m2/V).
 */
static pzs_real measure_gradient(const pzs_optimiser *optimiser, uint32_t k, const pzs_real *offset,
                                 pzs_real *model_gradient)
{
    *model_gradient = pzs_product_dot(optimiser->hessian + (size_t)k * optimiser->width, offset,
                                      optimiser->width) +
                      optimiser->regularisation_gradient[k];
    const pzs_real seen = *model_gradient - optimiser->target_gradient[k];
    return number_absolute(optimiser->free_set[k] > 0 ? seen : seen - optimiser->direction[k]);
}

/*
 * Set the gradient [inputs] to the one predicted for the end of a full step along the search
 * direction (m2/V): 0 for a free input, because the step ends at the minimum over the free
 * voltages; for an active input its entry of `move`, computed by predict_step.
 */
static void predict_gradient(pzs_real *restrict gradient, const pzs_real *restrict move,
                             const pzs_real *restrict free_set, size_t span)
{
    for (size_t i = 0; i < span; i++)
        gradient[i] = free_set[i] > 0 ? 0 : move[i];
}

/*
 * Accept the full step along the search direction that the tableau (pivoted Hessian) has predicted:
 * set the voltages and model_gradient, the part of the gradient that depends on them, to the
 * predicted values.
 */
static void accept_prediction(pzs_real *restrict voltage, pzs_real *restrict model_gradient,
                              const pzs_real *restrict next, const pzs_real *restrict move,
                              const pzs_real *restrict free_set,
                              const pzs_real *restrict target_gradient, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        voltage[i] = next[i];
        model_gradient[i] = target_gradient[i] + (free_set[i] > 0 ? 0 : move[i]);
    }
}

/*
 * Make the full step along the search direction, which no bound blocks, as one iteration, if the
 * gradient that the tableau (pivoted Hessian) predicts is right. It is compared at two inputs with
 * the gradient computed from the Hessian. Returns false, with unchanged voltages, if they differ
 * too much.
 */
static bool take_direct_iteration(pzs_optimiser *optimiser)
{
    const pzs_real *offset = optimiser->scratch, rough = rounding_of_product(optimiser, offset);
    const uint32_t one = optimiser->checked_next, two = one + 1u < optimiser->inputs ? one + 1u : 0;
    const pzs_real near = TOLERATED * optimiser->rounding_bound;
    pzs_real model_gradient[2];
    optimiser->kkt_violation = measure_gradient(optimiser, one, offset, &model_gradient[0]) +
                               measure_gradient(optimiser, two, offset, &model_gradient[1]);
    optimiser->rounding_bound = ROUNDING_FACTOR * (optimiser->target_rounding + rough);
    if (optimiser->kkt_violation > optimiser->rounding_bound)
        predict_gradient(optimiser->gradient, optimiser->direction, optimiser->free_set,
                         optimiser_span(optimiser));
    if (!is_converged(optimiser) || !(optimiser->kkt_violation <= near) ||
        (optimiser->kkt_violation > optimiser->rounding_bound &&
         !is_negligible(optimiser, UNMEASURED_FACTOR * optimiser->kkt_violation))) {
        optimiser->is_verified = false;
        set_difference(optimiser->gradient, optimiser->model_gradient, optimiser->target_gradient,
                       optimiser_span(optimiser));
        return false;
    }
    optimiser->model_rounding = rough;
    // Each tick compares the predicted with the computed gradient at the next two inputs, so that
    // an error of the tableau (pivoted Hessian) is found after at most inputs/2 + 1 ticks.
    optimiser->checked_next = two + 1u < optimiser->inputs ? two + 1u : 0;
    optimiser->iterations++;
    accept_prediction(optimiser->voltage, optimiser->model_gradient, optimiser->next_voltage,
                      optimiser->direction, optimiser->free_set, optimiser->target_gradient,
                      optimiser_span(optimiser));
    optimiser->is_predicted = true;
    optimiser->model_gradient[one] = model_gradient[0];
    optimiser->model_gradient[two] = model_gradient[1];
    return true;
}

/* ---- rounds of iterations -------------------------------------------- */

static void find_way_and_slope(pzs_real *restrict way, pzs_real *restrict slope,
                               const pzs_real *restrict voltage, const pzs_real *restrict start,
                               const pzs_real *restrict gradient,
                               const pzs_real *restrict start_gradient, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        way[i] = voltage[i] - start[i];
        slope[i] = gradient[i] + start_gradient[i];
    }
}

/*
 * Return whether the last round (sequence of iterations) lowered the objective. The change of a
 * quadratic objective is proportional to (voltages - start voltages) times the sum of the gradients
 * at both ends.
 */
bool pzs_boxls_has_decreased(const pzs_optimiser *optimiser)
{
    find_way_and_slope(optimiser->scratch, optimiser->direction, optimiser->voltage,
                       optimiser->start_voltage, optimiser->gradient, optimiser->start_gradient,
                       optimiser_span(optimiser));
    const pzs_real change =
                       pzs_product_dot(optimiser->scratch, optimiser->direction, optimiser->width),
                   sure = -change / SIGNIFICANT;
    const pzs_real far =
        PZS_SQRT(pzs_product_dot(optimiser->scratch, optimiser->scratch, optimiser->width));
    // The rounding error of `change`, the computed change of the objective, must be far below the
    // change itself, or below the scale of the objective.
    return change < 0 && far * optimiser->model_rounding <
                             (sure > optimiser->target_energy ? sure : optimiser->target_energy);
}

/*
 * Return to the voltages and gradients at the start of the last round (sequence of iterations). If
 * the optimiser had only predicted the gradient there by its tableau (pivoted Hessian), the
 * gradient is now computed from the Hessian.
 */
static void undo_round(pzs_optimiser *optimiser)
{
    const size_t bytes = optimiser->width * sizeof(pzs_real);
    memcpy(optimiser->voltage, optimiser->start_voltage, bytes);
    memcpy(optimiser->gradient, optimiser->start_gradient, bytes);
    memcpy(optimiser->model_gradient, optimiser->start_gradient, bytes);
    add_vector(optimiser->model_gradient, optimiser->target_gradient, optimiser_span(optimiser));
    optimiser->model_rounding = optimiser->start_rounding;
    if (optimiser->is_predicted)
        pzs_boxls_true_gradient(optimiser);
}

bool pzs_boxls_shorten(pzs_optimiser *optimiser)
{
    pzs_real *way = optimiser->scratch, *change = optimiser->direction;
    const size_t span = optimiser_span(optimiser);
    set_difference(way, optimiser->voltage, optimiser->start_voltage, span);
    set_difference(change, optimiser->gradient, optimiser->start_gradient, span);
    const pzs_real slope = pzs_product_dot(optimiser->start_gradient, way, optimiser->width);
    const pzs_real curvature = pzs_product_dot(change, way, optimiser->width);
    if (!(slope < 0 && -slope < curvature))
        return false;
    for (uint32_t i = 0; i < optimiser->inputs; i++)
        optimiser->voltage[i] =
            number_clamp(optimiser->start_voltage[i] - slope / curvature * way[i],
                         optimiser->lower[i], optimiser->upper[i]);
    return true;
}

/*
 * Run one round of the optimiser (a sequence of iterations): make the full step along the search
 * direction or, if a bound blocks it, iterations of the active-set method; then compute the
 * gradient from the Hessian.
 */
static void run_round(pzs_optimiser *optimiser, bool blocked)
{
    const size_t bytes = optimiser->width * sizeof(pzs_real);
    memcpy(optimiser->start_voltage, optimiser->voltage, bytes);
    memcpy(optimiser->start_gradient, optimiser->gradient, bytes);
    optimiser->start_rounding = optimiser->model_rounding;
    bool complete = true;
    if (blocked && optimiser_is_dual(optimiser)) {
        complete = optimiser->dual->run_round(optimiser, optimiser->rounding_bound / 2);
    } else if (blocked) {
        iterate(optimiser, optimiser->rounding_bound / 2);
    } else {
        memcpy(optimiser->voltage, optimiser->next_voltage, bytes);
        optimiser->iterations++;
    }
    const bool was_predicted = optimiser->is_predicted;
    pzs_boxls_true_gradient(optimiser);
    /*
     * The work limit may stop the dual active-set method at voltages whose objective is larger than
     * at the start of its round (sequence of iterations). The round then ends at the minimum of the
     * objective on the straight line between both voltage vectors.
     */
    if (!complete && pzs_boxls_shorten(optimiser))
        pzs_boxls_true_gradient(optimiser);
    optimiser->is_predicted = was_predicted;
}

/*
 * Compute the violation of the optimality (KKT) conditions by the present voltages, and its
 * rounding-error bound (m2/V).
 */
static void measure_violation(pzs_optimiser *optimiser)
{
    optimiser->kkt_violation =
        pzs_boxls_violation(optimiser, optimiser->voltage, optimiser->gradient);
    optimiser->rounding_bound =
        ROUNDING_FACTOR * (optimiser->target_rounding + optimiser->model_rounding);
}

/* Clamp voltages to their bounds. Returns the number of voltages that were outside. */
static uint32_t clamp_voltages(pzs_real *restrict voltage, const pzs_real *restrict lower,
                               const pzs_real *restrict upper, size_t span)
{
    uint32_t outside = 0;
    for (size_t i = 0; i < span; i++) {
        const uint32_t below = voltage[i] < lower[i] ? 1u : 0u;
        const uint32_t above = voltage[i] > upper[i] ? 1u : 0u;
        outside += below + above;
        voltage[i] = number_clamp(voltage[i], lower[i], upper[i]);
    }
    return outside;
}

bool pzs_boxls_enforce_limits(pzs_optimiser *optimiser)
{
    const bool moved = clamp_voltages(optimiser->voltage, optimiser->lower, optimiser->upper,
                                      optimiser_span(optimiser)) != 0;
    if (moved)
        pzs_boxls_true_gradient(optimiser);
    return moved;
}

/*
 * Decide whether the last round (sequence of iterations) is kept. It is kept if it made no step,
 * lowered the objective, or ended at optimal voltages; otherwise it is undone. If it ended at the
 * optimum, the tableau (pivoted Hessian) counts as verified.
 */
static void conclude_round(pzs_optimiser *optimiser, bool moved)
{
    const pzs_real rounding = optimiser->rounding_bound;
    measure_violation(optimiser);
    optimiser->is_optimal = is_converged(optimiser);
    if (optimiser->is_optimal && moved && !optimiser->is_verified) {
        optimiser->is_verified = true;
        optimiser->checked_next = 0;
    }
    // Compare the violation of the optimality (KKT) conditions with its rounding-error bound from
    // before these iterations. The present bound grows with the voltages, so that even voltages
    // that diverge could satisfy it.
    if (!moved || (optimiser->is_optimal && optimiser->kkt_violation <= rounding) ||
        pzs_boxls_has_decreased(optimiser)) {
        optimiser->is_predicted = optimiser->is_predicted && !moved;
        return;
    }
    undo_round(optimiser);
    optimiser->is_verified = false;
    measure_violation(optimiser);
    optimiser->is_optimal = is_converged(optimiser);
}

/*
 * Begin to recompute the tableau (pivoted Hessian) from the Hessian, at most once in a tick. If no
 * optimum has been found since the last recomputation, also raise the pivot threshold, so that more
 * inputs count as linearly dependent. Returns whether more iterations are needed.
 */
static bool renew_tableau(pzs_optimiser *optimiser)
{
    const pzs_real most = BOXLS_DEPENDENT * 4 * (pzs_real)optimiser->inputs * PZS_EPSILON;
    if (optimiser->rebuilds > 0 ||
        !optimiser_affords(optimiser, PZS_PRODUCT_WORK(optimiser->inputs)))
        return false;
    if (optimiser->is_fresh)
        optimiser->pivot_floor = number_clamp(optimiser->pivot_floor * 16, 0, most);
    optimiser->is_fresh = true;
    optimiser->rebuilds++;
    pzs_tableau_reset(optimiser);
    return !optimiser->is_optimal;
}

/*
 * Whether the tableau (pivoted Hessian) must be recomputed, because the last round (sequence of
 * iterations) made no step or hardly reduced the violation of the optimality (KKT) conditions.
 */
static bool is_stuck(const pzs_optimiser *optimiser, bool moves)
{
    return !moves ||
           optimiser->kkt_violation * LEAST_PROGRESS >
               pzs_boxls_violation(optimiser, optimiser->start_voltage, optimiser->start_gradient);
}

/*
 * Make one round (sequence of iterations) of the optimiser, whose tableau (pivoted Hessian) must be
 * complete. Returns whether another round may lower the objective.
 */
static bool make_round(pzs_optimiser *optimiser)
{
    const bool stationary = is_stationary(optimiser);
    const bool blocked = pzs_boxls_find_direction(optimiser, optimiser->rounding_bound / 2) != 0;
    const bool moves = blocked || !stationary, verified = optimiser->is_verified;
    if ((blocked || stationary || optimiser_is_dual(optimiser)) &&
        pzs_boxls_enforce_limits(optimiser))
        return true;
    if (moves && !blocked && verified && take_direct_iteration(optimiser)) {
        optimiser->is_optimal = true;
        return false;
    }
    if (moves)
        run_round(optimiser, blocked);
    conclude_round(optimiser, moves);
    optimiser->is_fresh = optimiser->is_fresh && !optimiser->is_optimal;
    const bool failed = moves && !blocked && verified;
    // Rounding errors accumulate in the tableau (pivoted Hessian) with each pivot exchange. If it
    // predicts a wrong gradient after many of them, it is worn and must be recomputed.
    const bool is_worn = failed && optimiser->exchanges > WORN * optimiser->inputs;
    if (is_worn || (!optimiser->is_optimal && !optimiser->is_cut && is_stuck(optimiser, moves)))
        return renew_tableau(optimiser);
    return !optimiser->is_optimal && !optimiser->is_cut;
}

/*
 * If the recomputation of the tableau (pivoted Hessian) is unfinished, go on with it. Returns
 * whether it is complete and the work limit allows a round (sequence of iterations).
 */
static bool may_make_round(pzs_optimiser *optimiser)
{
    bool complete = true;
    if (optimiser->is_rebuilding) {
        complete = pzs_tableau_rebuild(optimiser);
        pzs_boxls_gradient(optimiser);
    }
    const uint64_t dual = optimiser_is_dual(optimiser) ? pzs_dual_round_work(optimiser) : 0;
    const uint64_t work = PZS_ROUND_WORK(optimiser->inputs) + dual;
    optimiser->is_cut = !complete || !optimiser_affords(optimiser, work);
    if (optimiser->is_cut)
        return false;
    optimiser->work += PZS_ROUND_LOOPS * optimiser->width;
    return true;
}

void pzs_boxls_optimise(pzs_optimiser *optimiser)
{
    if (!IS_WIDE && product_is_wide(optimiser->inputs)) {
        pzs_boxls_optimise_wide(optimiser);
        return;
    }
    bool again = true;
    optimiser->rounding_bound =
        ROUNDING_FACTOR * (optimiser->target_rounding + optimiser->model_rounding);
    optimiser->is_optimal = false;
    if (optimiser_is_dual(optimiser))
        optimiser->dual->check_active(optimiser);
    pzs_boxls_gradient(optimiser);
    for (uint32_t round = 0; round < ROUNDS && again; round++) {
        again = may_make_round(optimiser) && make_round(optimiser);
        if (optimiser->is_cut) {
            (void)pzs_boxls_enforce_limits(optimiser);
            measure_violation(optimiser);
        }
    }
    /*
     * Unless the work limit has stopped the optimiser, accept a violation of the optimality (KKT)
     * conditions that is slightly above its rounding-error bound: rounding errors prevent a smaller
     * one.
     */
    optimiser->is_optimal |=
        !optimiser->is_cut && optimiser->kkt_violation <= TOLERATED * optimiser->rounding_bound;
}
