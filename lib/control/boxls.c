/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The voltage optimiser (boxls.h): a primal active-set method on one symmetric matrix, the tableau
 * (boxls_tableau.h). F is the free set, A the active set.
 *
 * A round starts from the true gradient and makes iterations of two kinds:
 *   descent  go along the direction to the minimum over F; an input that meets a bound stays there
 * and leaves F; release  at a minimum over F: an active input k with a KKT violation moves, while F
 * follows so that its gradient stays zero. It stops at the minimum of this ray, where k joins F, at
 * the other bound of k, or where an input of F meets a bound and leaves F. A round ends with the
 * true gradient computed from H, so rounding errors of the tableau never reach the voltages: they
 * only cost another round, and a tableau that has become inaccurate is recomputed.
 *
 * Termination. A descent that is stopped shrinks F. A release prefers inputs strictly between their
 * bounds; each such iteration lowers 2 (number of these) + (size of F), so at most 3 inputs
 * iterations lead to a point where every input strictly between its bounds has zero gradient: the
 * minimum of its face, whose objective depends only on which inputs stand at which bound. Only
 * there an input at a bound is released. Iterations of zero length only shrink F; the next one of
 * positive length strictly lowers the objective. So the objective of successive faces falls
 * strictly, no face occurs twice, and there are finitely many.
 *
 * An input whose pivot is below inputs * epsilon of its diagonal entry depends linearly on F. It is
 * not swept into F. At a minimum over F its gradient is zero up to rounding; if it is released, its
 * ray has no curvature and ends at a bound.
 *
 * Verified tableau. A tableau whose round ended at the optimum is verified until the next sweep.
 * With it, a descent that nothing blocks takes one direct iteration, after which only two entries
 * of the gradient are measured, in turn. An entry that differs from its prediction ends the
 * verification, and a normal round follows. An error of the tableau can thus last until its input
 * is measured, at most inputs/2 + 1 steps.
 *
 * Rounding. Only KKT violations above their rounding bound count. A round that neither ends at the
 * optimum nor lowers the objective (by the true gradients at both ends) is undone. Iterations and
 * rounds are limited. The voltages are feasible after every iteration: they are only ever clamped,
 * or accepted where every one compares as inside its bounds.
 */
#include <string.h>
#include "boxls.h"
#include "boxls_tableau.h"
#include "../core/numbers.h"
#include "../core/product.h"

#define ROUNDS 8u /* largest number of rounds in one call */
/* KKT violations below ROUNDING_FACTOR times the rounding bounds count as zero. */
#define ROUNDING_FACTOR 4
/*
 * Factor by which a gradient of an input in F may exceed its rounding bound, if this hardly raises
 * the objective.
 */
#define TOLERATED PZS_BY_BITS(256, 2048)
/*
 * Assumed largest ratio between the gradient prediction errors of inputs that are not measured and
 * of those that are.
 */
#define UNMEASURED_FACTOR 8
/* A decrease of the objective counts only if it exceeds SIGNIFICANT times its rounding error. */
#define SIGNIFICANT 16
/*
 * The tableau is recomputed after a round that reduces the KKT violation by less than this factor.
 */
#define LEAST_PROGRESS 16

void pzs_boxls_place(pzs_optimiser *optimiser, pzs_real *work)
{
    pzs_real **const vector[BOXLS_VECTORS] = {&optimiser->lower,
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
                                              &optimiser->scratch};
    for (uint32_t k = 0; k < BOXLS_VECTORS; k++)
        *vector[k] = work + (size_t)k * optimiser->width;
}

/* ---- gradients ------------------------------------------------------ */

/* y = A x, A [n][width] symmetric. */
static void symmetric(const pzs_optimiser *optimiser, pzs_real *restrict y,
                      const pzs_real *restrict a, const pzs_real *restrict x)
{
    pzs_product_sum_rows(y, a, optimiser->width, x, optimiser->inputs, optimiser_span(optimiser));
}

/* gradient = model gradient - target gradient; next = this gradient on F, 0 on A. */
static void combine(pzs_real *restrict gradient, pzs_real *restrict next,
                    const pzs_real *restrict model_gradient,
                    const pzs_real *restrict target_gradient, const pzs_real *restrict free_set,
                    size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real g = model_gradient[i] - target_gradient[i];
        gradient[i] = g;
        next[i] = free_set[i] > 0 ? g : 0;
    }
}

void pzs_boxls_gradient(pzs_optimiser *optimiser)
{
    combine(optimiser->gradient, optimiser->next_voltage, optimiser->model_gradient,
            optimiser->target_gradient, optimiser->free_set, optimiser_span(optimiser));
}

static void subtract(pzs_real *restrict z, const pzs_real *restrict x, const pzs_real *restrict y,
                     size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] = x[i] - y[i];
}

static void add(pzs_real *restrict z, const pzs_real *restrict x, size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] += x[i];
}

/* Rounding-error bound of the product H offset (m2/V). */
static pzs_real rounding_of_product(const pzs_optimiser *optimiser, const pzs_real *offset)
{
    return PZS_EPSILON * pzs_product_dot_size(optimiser->diagonal, offset, optimiser->width);
}

void pzs_boxls_true_gradient(pzs_optimiser *optimiser)
{
    subtract(optimiser->scratch, optimiser->voltage, optimiser->base, optimiser_span(optimiser));
    optimiser->model_rounding = rounding_of_product(optimiser, optimiser->scratch);
    symmetric(optimiser, optimiser->model_gradient, optimiser->hessian, optimiser->scratch);
    add(optimiser->model_gradient, optimiser->regularisation_gradient, optimiser_span(optimiser));
    pzs_boxls_gradient(optimiser);
}

/*
 * KKT violation of one voltage v with gradient g. Between the bounds it is |g|. At a bound it is
 * the component of -g that points to the inside, which is negative where the KKT condition is
 * satisfied.
 */
static inline pzs_real entry_violation(pzs_real g, pzs_real v, pzs_real lower, pzs_real upper)
{
    const pzs_real falls = v < upper ? number_absolute(g) : g;
    const pzs_real stays = v < upper ? -g : 0;
    return v > lower ? falls : stays;
}

/*
 * Direction of the free inputs, gradient after the step of the active ones; voltages after the
 * step, and their offset from the base. Returns how many inputs would leave their bounds or, in the
 * active set, have a KKT violation above `rounding`; 0 ends the round.
 */
static uint32_t predict_step(pzs_real *restrict move, pzs_real *restrict next,
                             pzs_real *restrict offset, const pzs_real *restrict free_set,
                             const pzs_real *restrict gradient, const pzs_real *restrict v,
                             const pzs_real *restrict lower, const pzs_real *restrict upper,
                             const pzs_real *restrict base, pzs_real rounding, size_t span)
{
    uint32_t open = 0;
    for (size_t i = 0; i < span; i++) {
        if (!OPTIMISER_WIDE && free_set[i] > 0) { /* shortcut with the same result for processors
                                                     without vector instructions */
            const pzs_real x = v[i] + move[i];
            next[i] = x;
            offset[i] = x - base[i];
            open += !(x >= lower[i] && x <= upper[i]);
            continue;
        }
        const pzs_real way = free_set[i] > 0 ? move[i] : 0;
        const pzs_real slope = free_set[i] > 0 ? 0 : gradient[i] - move[i];
        const pzs_real x = v[i] + way, most = entry_violation(slope, x, lower[i], upper[i]);
        move[i] = way + slope;
        next[i] = x;
        offset[i] = x - base[i];
        open +=
            (x >= lower[i] ? 0u : 1u) + (x <= upper[i] ? 0u : 1u) + (most <= rounding ? 0u : 1u);
    }
    return open;
}

uint32_t pzs_boxls_find_direction(pzs_optimiser *optimiser, pzs_real rounding)
{
    symmetric(optimiser, optimiser->direction, optimiser->tableau, optimiser->next_voltage);
    return predict_step(optimiser->direction, optimiser->next_voltage, optimiser->scratch,
                        optimiser->free_set, optimiser->gradient, optimiser->voltage,
                        optimiser->lower, optimiser->upper, optimiser->base, rounding,
                        optimiser_span(optimiser));
}

static void entry_violations(pzs_real *restrict out, const pzs_real *restrict v,
                             const pzs_real *restrict lower, const pzs_real *restrict upper,
                             const pzs_real *restrict gradient, size_t span)
{
    for (size_t i = 0; i < span; i++)
        out[i] = entry_violation(gradient[i], v[i], lower[i], upper[i]);
}

pzs_real pzs_boxls_violation(const pzs_optimiser *optimiser, const pzs_real *v,
                             const pzs_real *gradient)
{
    entry_violations(optimiser->scratch, v, optimiser->lower, optimiser->upper, gradient,
                     optimiser_span(optimiser));
    return pzs_product_largest(optimiser->scratch, optimiser->width);
}

/*
 * Whether gradients of this size (m2/V) on F raise the objective by less than epsilon times the
 * target energy. The bound is size^2 times the trace of the inverse of H on F.
 */
static int is_negligible(pzs_optimiser *optimiser, pzs_real size)
{
    const pzs_real square = size * size, most = PZS_EPSILON * optimiser->target_energy;
    if (optimiser->inverse_trace_bound > 0 && square * optimiser->inverse_trace_bound <= most)
        return 1;
    const pzs_real soft = pzs_tableau_inverse_trace(optimiser);
    return soft >= 0 && square * soft <= most;
}

int pzs_boxls_needs_new_base(pzs_optimiser *optimiser)
{
    return !is_negligible(optimiser, optimiser->model_rounding);
}

/*
 * out = KKT violation of each active input; `turn` instead, if the gradient is at most `turn` in
 * size and the bounds differ; 0 on F.
 */
static void active_violations(pzs_real *restrict out, const pzs_real *restrict v,
                              const pzs_real *restrict lower, const pzs_real *restrict upper,
                              const pzs_real *restrict gradient, const pzs_real *restrict free_set,
                              pzs_real turn, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real known = entry_violation(gradient[i], v[i], lower[i], upper[i]),
                       any = number_absolute(gradient[i]) > turn ? known : turn;
        const pzs_real at = lower[i] < upper[i] ? any : known;
        out[i] = free_set[i] > 0 ? 0 : at;
    }
}

/*
 * Whether the round has converged: no KKT violation above its rounding bound; or a violation on F
 * alone that is not far above it, costs nothing, and is too small to change the sign of an active
 * input's multiplier. Never where a voltage is not finite, because then the rounding bound is not
 * finite either.
 */
static int is_converged(pzs_optimiser *optimiser)
{
    if (!number_is_finite(optimiser->rounding_bound))
        return 0;
    if (optimiser->kkt_violation <= optimiser->rounding_bound)
        return 1;
    if (!(optimiser->kkt_violation <= TOLERATED * optimiser->rounding_bound) ||
        !is_negligible(optimiser, optimiser->kkt_violation))
        return 0;
    if (optimiser->active_count == 0)
        return 1;
    active_violations(optimiser->scratch, optimiser->voltage, optimiser->lower, optimiser->upper,
                      optimiser->gradient, optimiser->free_set,
                      (pzs_real)optimiser->inputs * optimiser->kkt_violation,
                      optimiser_span(optimiser));
    return pzs_product_largest(optimiser->scratch, optimiser->width) <= optimiser->rounding_bound;
}

/* ---- iterations ------------------------------------------------------ */

typedef struct blocking {
    pzs_real part;  /* fraction of the direction up to the first bound */
    uint32_t input; /* first input to meet a bound, or the number of inputs if none does */
} blocking;

/* urgency = |direction| / room where `part` of the direction of a free input leads beyond its
 * bound, else 0. */
static void rank_blocking(pzs_real *restrict urgency, const pzs_real *restrict direction,
                          const pzs_real *restrict v, const pzs_real *restrict lower,
                          const pzs_real *restrict upper, const pzs_real *restrict free_set,
                          pzs_real part, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real down = v[i] - lower[i], up = upper[i] - v[i],
                       room = direction[i] < 0 ? down : up, size = number_absolute(direction[i]);
        const int meets = (room < part * size) & (free_set[i] > 0);
        urgency[i] = (meets ? size : 0) / (meets ? room : 1);
    }
}

/* First input with the largest entry of x, or the number of inputs if none is above `least`. */
static uint32_t find_largest(const pzs_optimiser *optimiser, const pzs_real *x, pzs_real least)
{
    const pzs_real most = pzs_product_largest(x, optimiser->width);
    uint32_t i = most > least ? 0 : optimiser->inputs;
    while (i < optimiser->inputs && !(x[i] >= most))
        i++;
    return i;
}

/* Shorten `part` of the direction of the free inputs to the first bound that it meets. */
static blocking first_blocking(const pzs_optimiser *optimiser, const pzs_real *direction,
                               pzs_real part)
{
    rank_blocking(optimiser->scratch, direction, optimiser->voltage, optimiser->lower,
                  optimiser->upper, optimiser->free_set, part, optimiser_span(optimiser));
    blocking first = {part, find_largest(optimiser, optimiser->scratch, 0)};
    if (first.input < optimiser->inputs) {
        const uint32_t i = first.input;
        first.part = (direction[i] < 0 ? optimiser->voltage[i] - optimiser->lower[i]
                                       : optimiser->upper[i] - optimiser->voltage[i]) /
                     number_absolute(direction[i]);
    }
    return first;
}

/* v += part * direction on F, clamped to the bounds. */
static void advance(pzs_real *restrict v, const pzs_real *restrict direction,
                    const pzs_real *restrict lower, const pzs_real *restrict upper,
                    const pzs_real *restrict free_set, pzs_real part, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real there = number_clamp(v[i] + part * direction[i], lower[i], upper[i]);
        v[i] = free_set[i] > 0 ? there : v[i];
    }
}

/* Move along the direction; an input that meets its bound is set to exactly that bound. */
static void move_along(pzs_optimiser *optimiser, const pzs_real *direction, blocking first)
{
    advance(optimiser->voltage, direction, optimiser->lower, optimiser->upper, optimiser->free_set,
            first.part, optimiser_span(optimiser));
    if (first.input < optimiser->inputs)
        optimiser->voltage[first.input] = direction[first.input] < 0
                                              ? optimiser->lower[first.input]
                                              : optimiser->upper[first.input];
}

/* direction *= remaining on F. */
static void scale_direction(pzs_real *restrict move, const pzs_real *restrict free_set,
                            pzs_real remaining, size_t span)
{
    for (size_t i = 0; i < span; i++)
        move[i] *= free_set[i] > 0 ? remaining : 1;
}

/* z += inside * x on F, z += outside * x on A. */
static void add_multiples(pzs_real *restrict z, const pzs_real *restrict x,
                          const pzs_real *restrict free_set, pzs_real inside, pzs_real outside,
                          size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] += (free_set[i] > 0 ? inside : outside) * x[i];
}

/* Move input j from F to A, when the fraction `remaining` of the direction is still to be taken. */
static void leave_free_set(pzs_optimiser *optimiser, uint32_t j, pzs_real remaining)
{
    const pzs_real *row = optimiser->tableau + (size_t)j * optimiser->width;
    pzs_tableau_sweep(optimiser, j);
    add_multiples(optimiser->direction, row, optimiser->free_set, remaining, -remaining,
                  optimiser_span(optimiser));
    optimiser->direction[j] = -remaining * row[j];
}

/* Make one descent iteration. Returns nonzero if a bound stopped it. */
static int descend(pzs_optimiser *optimiser)
{
    const blocking first = first_blocking(optimiser, optimiser->direction, 1);
    move_along(optimiser, optimiser->direction, first);
    if (first.input == optimiser->inputs)
        return 0;
    scale_direction(optimiser->direction, optimiser->free_set, 1 - first.part,
                    optimiser_span(optimiser));
    leave_free_set(optimiser, first.input, optimiser->direction[first.input]);
    return 1;
}

/*
 * Split the KKT violations of the active inputs into two arrays: of inputs strictly between their
 * bounds, and of inputs at a bound. All other entries are 0.
 */
static void sort_active(pzs_real *restrict between, pzs_real *restrict at,
                        const pzs_real *restrict v, const pzs_real *restrict lower,
                        const pzs_real *restrict upper, const pzs_real *restrict move,
                        const pzs_real *restrict free_set, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real most =
            free_set[i] > 0 ? 0 : entry_violation(move[i], v[i], lower[i], upper[i]);
        const int inside = (v[i] > lower[i]) & (v[i] < upper[i]);
        between[i] = inside ? most : 0;
        at[i] = inside ? 0 : most;
    }
}

/*
 * Choose the active input to release: the one with the largest KKT violation strictly between its
 * bounds; if there is none, the one with the largest at a bound. Returns the number of inputs if no
 * input violates the conditions.
 */
static uint32_t input_to_release(const pzs_optimiser *optimiser, pzs_real rounding)
{
    sort_active(optimiser->scratch, optimiser->next_voltage, optimiser->voltage, optimiser->lower,
                optimiser->upper, optimiser->direction, optimiser->free_set,
                optimiser_span(optimiser));
    const uint32_t between = find_largest(optimiser, optimiser->scratch, rounding);
    return between < optimiser->inputs ? between
                                       : find_largest(optimiser, optimiser->next_voltage, rounding);
}

/*
 * Length of the ray of input k (V): the distance to the minimum along the ray, or to the bound of k
 * if this is nearer.
 */
static pzs_real ray_length(const pzs_optimiser *optimiser, uint32_t k, int *to_limit)
{
    const pzs_real slope = number_absolute(optimiser->direction[k]),
                   pivot = optimiser->tableau[(size_t)k * optimiser->width + k];
    const pzs_real room = optimiser->direction[k] > 0 ? optimiser->voltage[k] - optimiser->lower[k]
                                                      : optimiser->upper[k] - optimiser->voltage[k];
    const pzs_real least =
        (number_is_finite(room) ? PZS_EPSILON : optimiser->pivot_floor) * optimiser->diagonal[k];
    const pzs_real curvature = pivot > least ? pivot : least;
    *to_limit = !(slope < room * curvature);
    return *to_limit ? room : slope / curvature;
}

/*
 * Move input k along its ray, with v_F -= row_F * length, and update the gradients of A. Returns
 * what stopped the move.
 */
static blocking follow_ray(pzs_optimiser *optimiser, uint32_t k, pzs_real length)
{
    const pzs_real *row = optimiser->tableau + (size_t)k * optimiser->width,
                   sign = optimiser->direction[k] > 0 ? (pzs_real)-1 : (pzs_real)1;
    for (uint32_t i = 0; i < optimiser->inputs; i++)
        optimiser->next_voltage[i] = -sign * row[i];
    const blocking first = first_blocking(optimiser, optimiser->next_voltage, length);
    if (number_is_finite(first.part)) {
        const pzs_real far = sign * first.part;
        move_along(optimiser, optimiser->next_voltage, first);
        optimiser->voltage[k] =
            number_clamp(optimiser->voltage[k] + far, optimiser->lower[k], optimiser->upper[k]);
        add_multiples(optimiser->direction, row, optimiser->free_set, far, far,
                      optimiser_span(optimiser));
    }
    return first;
}

/* Make one release iteration from a minimum over F: input k moves along its ray. */
static void release_input(pzs_optimiser *optimiser, uint32_t k)
{
    const int down = optimiser->direction[k] > 0;
    int to_limit;
    const pzs_real length = ray_length(optimiser, k, &to_limit);
    const blocking first = follow_ray(optimiser, k, length);
    if (first.input < optimiser->inputs) {
        leave_free_set(optimiser, first.input, 0);
    } else if (to_limit && number_is_finite(first.part)) {
        optimiser->voltage[k] = down ? optimiser->lower[k] : optimiser->upper[k];
    } else {
        optimiser->direction[k] = 0; /* zero at the minimum of the ray; along a ray without bound or
                                        curvature, any decrease would be rounding only */
        if (!to_limit && pzs_tableau_independence(optimiser, k) > optimiser->pivot_floor)
            pzs_tableau_sweep(optimiser, k);
    }
}

/* Whether no free input has a gradient above the rounding bound; next_voltage holds these
 * gradients. */
static int is_stationary(const pzs_optimiser *optimiser)
{
    uint32_t i = 0;
    while (i < optimiser->inputs &&
           number_absolute(optimiser->next_voltage[i]) <= optimiser->rounding_bound)
        i++;
    return i == optimiser->inputs;
}

/*
 * Make iterations, starting where a bound blocks the full direction, until the tableau predicts no
 * KKT violation: first descent iterations until no bound stops them, then release iterations.
 * Returns the number of iterations, at most `allowed`.
 */
static uint32_t iterate(pzs_optimiser *optimiser, pzs_real rounding, uint32_t allowed)
{
    const uint32_t most =
        2u * optimiser->inputs + 8u < allowed ? 2u * optimiser->inputs + 8u : allowed;
    uint32_t used = 0, k = 0;
    int blocked = 1;
    for (; blocked && used < most; used++)
        blocked = descend(optimiser);
    for (; used < most && (k = input_to_release(optimiser, rounding)) < optimiser->inputs; used++)
        release_input(optimiser, k);
    return used;
}

/* ---- direct iteration ----------------------------------------------- */

/*
 * Compute the model gradient of input k after the step from H. Returns the error of its predicted
 * gradient.
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

/* Gradient after the step as the tableau predicts it: 0 on F, the entry of `direction` on A. */
static void predict_gradient(pzs_real *restrict gradient, const pzs_real *restrict move,
                             const pzs_real *restrict free_set, size_t span)
{
    for (size_t i = 0; i < span; i++)
        gradient[i] = free_set[i] > 0 ? 0 : move[i];
}

/*
 * Accept the step: set the voltages after it, and the model gradient that matches the predicted
 * gradient.
 */
static void accept_prediction(pzs_real *restrict v, pzs_real *restrict model_gradient,
                              const pzs_real *restrict next, const pzs_real *restrict move,
                              const pzs_real *restrict free_set,
                              const pzs_real *restrict target_gradient, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        v[i] = next[i];
        model_gradient[i] = target_gradient[i] + (free_set[i] > 0 ? 0 : move[i]);
    }
}

/*
 * Take the full step, which no bound blocks, as one iteration, and compute the gradients of two
 * inputs from H as a check. Returns 0 if they differ from their prediction: the voltages are then
 * unchanged, and the tableau no longer counts as verified.
 */
static int take_direct_iteration(pzs_optimiser *optimiser)
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
        pzs_boxls_gradient(optimiser);
        return 0;
    }
    optimiser->model_rounding = rough;
    optimiser->checked_next = two + 1u < optimiser->inputs ? two + 1u : 0;
    optimiser->iterations++;
    accept_prediction(optimiser->voltage, optimiser->model_gradient, optimiser->next_voltage,
                      optimiser->direction, optimiser->free_set, optimiser->target_gradient,
                      optimiser_span(optimiser));
    optimiser->model_gradient[one] = model_gradient[0];
    optimiser->model_gradient[two] = model_gradient[1];
    return 1;
}

/* ---- rounds --------------------------------------------------------- */

/* way = v - start_voltage, slope = gradient + start_gradient. */
static void difference(pzs_real *restrict way, pzs_real *restrict slope, const pzs_real *restrict v,
                       const pzs_real *restrict start, const pzs_real *restrict gradient,
                       const pzs_real *restrict start_gradient, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        way[i] = v[i] - start[i];
        slope[i] = gradient[i] + start_gradient[i];
    }
}

/*
 * Whether the round lowered the objective. Because the objective is quadratic, its change is
 * proportional to (v - start) . (sum of the gradients at both ends). The rounding error over this
 * distance must be below the target energy, or far below the decrease.
 */
static int has_decreased(const pzs_optimiser *optimiser)
{
    difference(optimiser->scratch, optimiser->direction, optimiser->voltage,
               optimiser->start_voltage, optimiser->gradient, optimiser->start_gradient,
               optimiser_span(optimiser));
    const pzs_real change =
                       pzs_product_dot(optimiser->scratch, optimiser->direction, optimiser->width),
                   sure = -change / SIGNIFICANT;
    const pzs_real far =
        PZS_SQRT(pzs_product_dot(optimiser->scratch, optimiser->scratch, optimiser->width));
    return change < 0 && far * optimiser->model_rounding <
                             (sure > optimiser->target_energy ? sure : optimiser->target_energy);
}

/* Run one round, from the direction to the true gradient at the end of the step. */
static void run_round(pzs_optimiser *optimiser, int blocked)
{
    const size_t bytes = optimiser->width * sizeof(pzs_real);
    memcpy(optimiser->start_voltage, optimiser->voltage, bytes);
    memcpy(optimiser->start_gradient, optimiser->gradient, bytes);
    if (blocked)
        optimiser->iterations += iterate(optimiser, optimiser->rounding_bound / 2,
                                         optimiser->iteration_limit - optimiser->iterations);
    else
        memcpy(optimiser->voltage, optimiser->next_voltage, bytes);
    optimiser->iterations += !blocked;
    pzs_boxls_true_gradient(optimiser);
}

/* Compute the KKT violation at v, and the bound up to which it may be caused by rounding. */
static void assess(pzs_optimiser *optimiser)
{
    optimiser->kkt_violation =
        pzs_boxls_violation(optimiser, optimiser->voltage, optimiser->gradient);
    optimiser->rounding_bound =
        ROUNDING_FACTOR * (optimiser->target_rounding + optimiser->model_rounding);
}

/* Clamp v to the bounds. Returns how many entries were outside. */
static uint32_t clamp_voltages(pzs_real *restrict v, const pzs_real *restrict lower,
                               const pzs_real *restrict upper, size_t span)
{
    uint32_t outside = 0;
    for (size_t i = 0; i < span; i++) {
        const uint32_t below = v[i] < lower[i] ? 1u : 0u;
        const uint32_t above = v[i] > upper[i] ? 1u : 0u;
        outside += below + above;
        v[i] = number_clamp(v[i], lower[i], upper[i]);
    }
    return outside;
}

int pzs_boxls_enforce_limits(pzs_optimiser *optimiser)
{
    const int moved = clamp_voltages(optimiser->voltage, optimiser->lower, optimiser->upper,
                                     optimiser_span(optimiser)) != 0;
    if (moved)
        pzs_boxls_true_gradient(optimiser);
    return moved;
}

/*
 * End a round in one of three ways. At the optimum, the tableau counts as verified. If the
 * objective fell, the new voltages are kept. Otherwise the round is undone. If the KKT violation is
 * below the rounding bound only because the move raised that bound, the objective must have fallen
 * too.
 */
static void conclude_round(pzs_optimiser *optimiser, int moved)
{
    const pzs_real rounding = optimiser->rounding_bound;
    assess(optimiser);
    optimiser->is_optimal = is_converged(optimiser);
    if (optimiser->is_optimal && moved && !optimiser->is_verified) {
        optimiser->is_verified = true;
        optimiser->checked_next = 0;
    }
    if (!moved || (optimiser->is_optimal && optimiser->kkt_violation <= rounding) ||
        has_decreased(optimiser))
        return;
    memcpy(optimiser->voltage, optimiser->start_voltage, optimiser->width * sizeof(pzs_real));
    (void)clamp_voltages(optimiser->voltage, optimiser->lower, optimiser->upper,
                         optimiser_span(optimiser));
    pzs_boxls_true_gradient(optimiser);
    optimiser->is_verified = false;
    assess(optimiser);
    optimiser->is_optimal = is_converged(optimiser);
}

/*
 * Recompute the tableau after a round of little progress. If the tableau was already fresh, raise
 * the pivot threshold too, so that more inputs count as linearly dependent.
 */
static void renew_tableau(pzs_optimiser *optimiser, int fresh)
{
    const pzs_real most = BOXLS_DEPENDENT * 4 * (pzs_real)optimiser->inputs * PZS_EPSILON;
    optimiser->pivot_floor =
        fresh ? number_clamp(optimiser->pivot_floor * 16, 0, most) : optimiser->pivot_floor;
    pzs_tableau_rebuild(optimiser);
    pzs_boxls_gradient(optimiser);
}

void pzs_boxls_optimise(pzs_optimiser *optimiser)
{
    int fresh = 0;
    optimiser->rounding_bound =
        ROUNDING_FACTOR * (optimiser->target_rounding + optimiser->model_rounding);
    optimiser->is_optimal = 0;
    if (optimiser->iterations >= optimiser->iteration_limit) {
        (void)pzs_boxls_enforce_limits(optimiser);
        assess(optimiser);
        optimiser->is_optimal = optimiser->kkt_violation <= optimiser->rounding_bound;
    }
    for (uint32_t round = 0; round < ROUNDS && !optimiser->is_optimal &&
                             optimiser->iterations < optimiser->iteration_limit;
         round++) {
        const int rest = is_stationary(optimiser),
                  blocked = pzs_boxls_find_direction(optimiser, optimiser->rounding_bound / 2) != 0,
                  moves = blocked || !rest;
        if ((blocked || rest) && pzs_boxls_enforce_limits(optimiser))
            continue;
        if (moves && !blocked && optimiser->is_verified) {
            optimiser->is_optimal = take_direct_iteration(optimiser);
            continue;
        }
        if (moves)
            run_round(optimiser, blocked);
        conclude_round(optimiser, moves);
        if (!optimiser->is_optimal && optimiser->iterations < optimiser->iteration_limit &&
            (!moves || optimiser->kkt_violation * LEAST_PROGRESS >
                           pzs_boxls_violation(optimiser, optimiser->start_voltage,
                                               optimiser->start_gradient))) {
            renew_tableau(optimiser, fresh);
            fresh = 1;
        }
    }
    /*
     * After the last round, a violation slightly above its rounding bound is accepted: rounding
     * errors prevent a lower one.
     */
    optimiser->is_optimal |= optimiser->iterations < optimiser->iteration_limit &&
                             optimiser->kkt_violation <= TOLERATED * optimiser->rounding_bound;
}
