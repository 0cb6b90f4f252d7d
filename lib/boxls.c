/*
 * The voltage optimiser: a primal active-set method on one symmetric matrix, the tableau (boxls_tableau.h): F are the inputs
 * free to move together, S those that stand still.
 *
 * A round starts from the true gradient and makes passes; each pass goes as far as limits allow:
 *   descend  along move; an input that meets a limit stays there and leaves F;
 *   release  at a minimum over F: one standing input k with a wrong multiplier moves along its ray
 *            (F follows, keeping its gradient zero) to the ray's minimum, where k joins F, or to
 *            k's other limit, or until an input of F meets a limit and leaves F.
 * The round ends with the true gradient from H, so errors of the tableau do not reach the volts:
 * they only cost a further round, and a poor tableau is swept anew.
 *
 * It ends at the optimum. Descending shrinks F at every pass but the last. A release
 * prefers inputs that stand strictly between their limits; each such pass lowers
 * 2 (number of those) + (size of F), so at most 3n of them lead to a point where every input
 * between its limits has gradient zero: the minimum of its face, whose value depends only on which
 * inputs stand at which limit. Only there is an input released from a limit. Passes of
 * zero length only shrink F; the next of positive length lowers the objective strictly. So
 * the objective of successive faces falls strictly, no face comes twice, and there are finitely many.
 *
 * An input whose pivot is below n epsilon of its diagonal depends on F: it is not swept, its
 * multiplier is zero at a minimum over F up to rounding, and its ray costs nothing: it goes
 * to a limit, where either it or an input of F stops; both only shrink the sets above.
 *
 * A tableau whose round ended at the optimum is proven until it is swept: where nothing is in the way, one
 * pass goes straight there. Of the gradient at its end only two inputs are measured, in turn: one that is not as
 * foreseen ends the proof, and the pass is a round. So an error of the tableau may last until its input is
 * measured, at most n/2 + 1 passes.
 *
 * In rounding: only multipliers above a noise level count, a round that neither ends at the optimum nor lowers the
 * objective (by the true gradients at both ends) is undone, and passes and rounds are counted. Volts
 * are feasible after every pass because they are only ever cut, or taken where every one compares as inside.
 */
#include <string.h>
#include "boxls.h"
#include "boxls_tableau.h"
#include "product.h"

#define ROUNDS 8u     /* most rounds of one call */
#define NOISE 4       /* multipliers below NOISE times the rounding of a gradient are zero */
#define NEAR PZS_BY_BITS(256, 2048) /* how far above the noise gradients of free inputs may be, where that costs nothing */
#define OTHERS 8      /* gradients not measured may be so much farther from what was foreseen than those that are */
#define SURE 16       /* a gain so many times what its rounding may be is one */
#define POOR 16       /* a round that lowers the violation less than this asks for a fresh tableau */

void boxls_place(boxls *b, pzs_real *work)
{
    pzs_real **const vector[BOXLS_VECTORS] = {&b->lo, &b->hi, &b->free, &b->base, &b->bias, &b->want, &b->pull,
                                              &b->grad, &b->move, &b->diag, &b->start, &b->start_grad, &b->next,
                                              &b->spare};
    for (uint32_t k = 0; k < BOXLS_VECTORS; k++)
        *vector[k] = work + (size_t)k * b->width;
}

/* ---- gradients ------------------------------------------------------------------ */

/* y = A x, A [n][width] symmetric. */
static void symmetric(const boxls *b, pzs_real *restrict y, const pzs_real *restrict a, const pzs_real *restrict x)
{
    product_sum_rows(y, a, b->width, x, b->n, boxls_span(b));
}

/* grad = pull - want; where inputs are free, next is the same, elsewhere 0. */
static void combine(pzs_real *restrict grad, pzs_real *restrict next, const pzs_real *restrict pull,
                    const pzs_real *restrict want, const pzs_real *restrict free, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real g = pull[i] - want[i];
        grad[i] = g;
        next[i] = free[i] > 0 ? g : 0;
    }
}

void boxls_gradient(boxls *b)
{
    combine(b->grad, b->next, b->pull, b->want, b->free, boxls_span(b));
}

static void subtract(pzs_real *restrict z, const pzs_real *restrict x, const pzs_real *restrict y, size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] = x[i] - y[i];
}

static void add(pzs_real *restrict z, const pzs_real *restrict x, size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] += x[i];
}

/* epsilon times what rounding of H away is made of. */
static pzs_real roughness(const boxls *b, const pzs_real *away)
{
    return PZS_EPSILON * product_dot_size(b->diag, away, b->width);
}

void boxls_true_gradient(boxls *b)
{
    subtract(b->spare, b->v, b->base, boxls_span(b));
    b->rough = roughness(b, b->spare);
    symmetric(b, b->pull, b->h, b->spare);
    add(b->pull, b->bias, boxls_span(b));
    boxls_gradient(b);
}

/* How far gradient g is wrong at v: its size where the volts could follow it downhill, else at most 0. */
static inline pzs_real wrong(pzs_real g, pzs_real v, pzs_real lo, pzs_real hi)
{
    const pzs_real falls = v < hi ? boxls_size(g) : g, stays = v < hi ? -g : 0;
    return v > lo ? falls : stays;
}

/*
 * move = the way where free, the gradient after it elsewhere; next = v after the way, away = next - base. Returns how many
 * would not stay within their limits or, standing, not have a gradient below noise: 0 ends the round.
 */
static uint32_t look_ahead(pzs_real *restrict move, pzs_real *restrict next, pzs_real *restrict away,
                           const pzs_real *restrict free, const pzs_real *restrict grad, const pzs_real *restrict v,
                           const pzs_real *restrict lo, const pzs_real *restrict hi, const pzs_real *restrict base,
                           pzs_real noise, size_t span)
{
    uint32_t open = 0;
    for (size_t i = 0; i < span; i++) {
        if (!BOXLS_WIDE && free[i] > 0) { /* the same with fewer instructions, where there are no vectors */
            const pzs_real x = v[i] + move[i];
            next[i] = x;
            away[i] = x - base[i];
            open += !(x >= lo[i] && x <= hi[i]);
            continue;
        }
        const pzs_real way = free[i] > 0 ? move[i] : 0, slope = free[i] > 0 ? 0 : grad[i] - move[i];
        const pzs_real x = v[i] + way, most = wrong(slope, x, lo[i], hi[i]);
        move[i] = way + slope;
        next[i] = x;
        away[i] = x - base[i];
        open += (x >= lo[i] ? 0u : 1u) + (x <= hi[i] ? 0u : 1u) + (most <= noise ? 0u : 1u);
    }
    return open;
}

uint32_t boxls_aim(boxls *b, pzs_real noise)
{
    symmetric(b, b->move, b->m, b->next);
    return look_ahead(b->move, b->next, b->spare, b->free, b->grad, b->v, b->lo, b->hi, b->base, noise, boxls_span(b));
}

static void all_wrong(pzs_real *restrict out, const pzs_real *restrict v, const pzs_real *restrict lo,
                      const pzs_real *restrict hi, const pzs_real *restrict grad, size_t span)
{
    for (size_t i = 0; i < span; i++)
        out[i] = wrong(grad[i], v[i], lo[i], hi[i]);
}

pzs_real boxls_violation(const boxls *b, const pzs_real *v, const pzs_real *grad)
{
    all_wrong(b->spare, v, b->lo, b->hi, grad, boxls_span(b));
    return product_largest(b->spare, b->width);
}

/* Whether a gradient of that size (m2/V) on F costs less than epsilon of the energy: its square times the inverse of H. */
static int costs_nothing(boxls *b, pzs_real size)
{
    const pzs_real square = size * size, most = PZS_EPSILON * b->energy;
    if (b->soft_most > 0 && square * b->soft_most <= most)
        return 1;
    const pzs_real soft = tableau_softness(b);
    return soft >= 0 && square * soft <= most;
}

int boxls_coarse(boxls *b)
{
    return !costs_nothing(b, b->rough);
}

/* out = how far the gradient of a standing input is wrong, `turn` where it may be rounding alone; elsewhere 0. */
static void standing_wrong(pzs_real *restrict out, const pzs_real *restrict v, const pzs_real *restrict lo,
                           const pzs_real *restrict hi, const pzs_real *restrict grad, const pzs_real *restrict free,
                           pzs_real turn, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real known = wrong(grad[i], v[i], lo[i], hi[i]), any = boxls_size(grad[i]) > turn ? known : turn;
        const pzs_real at = lo[i] < hi[i] ? any : known;
        out[i] = free[i] > 0 ? 0 : at;
    }
}

/*
 * Whether the volts of the round may stand: no violation above the noise; or one on F alone, not far above it, that
 * costs nothing and is too small to turn the multiplier of a standing input. Never where a volt is not finite: the noise
 * then is not either.
 */
static int settled(boxls *b)
{
    if (!boxls_finite(b->noise))
        return 0;
    if (b->left <= b->noise)
        return 1;
    if (!(b->left <= NEAR * b->noise) || !costs_nothing(b, b->left))
        return 0;
    if (b->standing == 0)
        return 1;
    standing_wrong(b->spare, b->v, b->lo, b->hi, b->grad, b->free, (pzs_real)b->n * b->left, boxls_span(b));
    return product_largest(b->spare, b->width) <= b->noise;
}

/* ---- passes ----------------------------------------------------------------------- */

typedef struct block {
    pzs_real part;  /* of the way that is free */
    uint32_t input; /* the first to meet a limit, or n */
} block;

/* urgency = |step| / room where `part` of the step of a swept input is beyond its limit, else 0. */
static void find_urgency(pzs_real *restrict urgency, const pzs_real *restrict step, const pzs_real *restrict v,
                         const pzs_real *restrict lo, const pzs_real *restrict hi, const pzs_real *restrict free,
                         pzs_real part, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real down = v[i] - lo[i], up = hi[i] - v[i], room = step[i] < 0 ? down : up, size = boxls_size(step[i]);
        const int meets = (room < part * size) & (free[i] > 0);
        urgency[i] = (meets ? size : 0) / (meets ? room : 1);
    }
}

/* The first input whose entry is the largest of x, or n where none is above `least`. */
static uint32_t find_largest(const boxls *b, const pzs_real *x, pzs_real least)
{
    const pzs_real most = product_largest(x, b->width);
    uint32_t i = most > least ? 0 : b->n;
    while (i < b->n && !(x[i] >= most))
        i++;
    return i;
}

/* Shorten the way `part * step[i]` of swept inputs to the first limit met. */
static block first_block(const boxls *b, const pzs_real *step, pzs_real part)
{
    find_urgency(b->spare, step, b->v, b->lo, b->hi, b->free, part, boxls_span(b));
    block first = { part, find_largest(b, b->spare, 0) };
    if (first.input < b->n) {
        const uint32_t i = first.input;
        first.part = (step[i] < 0 ? b->v[i] - b->lo[i] : b->hi[i] - b->v[i]) / boxls_size(step[i]);
    }
    return first;
}

/* v += part step where free, cut to the limits. */
static void advance(pzs_real *restrict v, const pzs_real *restrict step, const pzs_real *restrict lo,
                    const pzs_real *restrict hi, const pzs_real *restrict free, pzs_real part, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real there = boxls_cut(v[i] + part * step[i], lo[i], hi[i]);
        v[i] = free[i] > 0 ? there : v[i];
    }
}

/* Go along step; the input that met its limit stands on it exactly. */
static void go(boxls *b, const pzs_real *step, block first)
{
    advance(b->v, step, b->lo, b->hi, b->free, first.part, boxls_span(b));
    if (first.input < b->n)
        b->v[first.input] = step[first.input] < 0 ? b->lo[first.input] : b->hi[first.input];
}

/* move = left move where free. */
static void shorten(pzs_real *restrict move, const pzs_real *restrict free, pzs_real left, size_t span)
{
    for (size_t i = 0; i < span; i++)
        move[i] *= free[i] > 0 ? left : 1;
}

/* z += inside x where free, outside x elsewhere. */
static void add_multiples(pzs_real *restrict z, const pzs_real *restrict x, const pzs_real *restrict free, pzs_real inside,
                          pzs_real outside, size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] += (free[i] > 0 ? inside : outside) * x[i];
}

/* Take input j out of F where `left` of its way to the minimum over F is not gone. */
static void drop(boxls *b, uint32_t j, pzs_real left)
{
    const pzs_real *row = b->m + (size_t)j * b->width;
    tableau_sweep(b, j);
    add_multiples(b->move, row, b->free, left, -left, boxls_span(b));
    b->move[j] = -left * row[j];
}

/* One pass along move. Returns nonzero where a limit stopped it. */
static int descend(boxls *b)
{
    const block first = first_block(b, b->move, 1);
    go(b, b->move, first);
    if (first.input == b->n)
        return 0;
    shorten(b->move, b->free, 1 - first.part, boxls_span(b));
    drop(b, first.input, b->move[first.input]);
    return 1;
}

/* Wrong gradients of standing inputs: of those between their limits, and of those at one; elsewhere 0. */
static void sort_standing(pzs_real *restrict between, pzs_real *restrict at, const pzs_real *restrict v,
                          const pzs_real *restrict lo, const pzs_real *restrict hi, const pzs_real *restrict move,
                          const pzs_real *restrict free, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        const pzs_real most = free[i] > 0 ? 0 : wrong(move[i], v[i], lo[i], hi[i]);
        const int inside = (v[i] > lo[i]) & (v[i] < hi[i]);
        between[i] = inside ? most : 0;
        at[i] = inside ? 0 : most;
    }
}

/* The standing input to release: the worst between its limits, else the worst at one, else n. */
static uint32_t worst_standing(const boxls *b, pzs_real noise)
{
    sort_standing(b->spare, b->next, b->v, b->lo, b->hi, b->move, b->free, boxls_span(b));
    const uint32_t between = find_largest(b, b->spare, noise);
    return between < b->n ? between : find_largest(b, b->next, noise);
}

/* How far input k may go along its ray (V): to the ray's minimum, or its own limit. */
static pzs_real ray_length(const boxls *b, uint32_t k, int *to_limit)
{
    const pzs_real slope = boxls_size(b->move[k]), pivot = b->m[(size_t)k * b->width + k];
    const pzs_real room = b->move[k] > 0 ? b->v[k] - b->lo[k] : b->hi[k] - b->v[k];
    const pzs_real least = (boxls_finite(room) ? PZS_EPSILON : b->floor) * b->diag[k];
    const pzs_real curvature = pivot > least ? pivot : least;
    *to_limit = !(slope < room * curvature);
    return *to_limit ? room : slope / curvature;
}

/* Go along the ray of k, v_F -= row_F far, and let the gradients of standing inputs follow. Returns what stopped it. */
static block follow(boxls *b, uint32_t k, pzs_real length)
{
    const pzs_real *row = b->m + (size_t)k * b->width, sign = b->move[k] > 0 ? (pzs_real)-1 : (pzs_real)1;
    for (uint32_t i = 0; i < b->n; i++)
        b->next[i] = -sign * row[i];
    const block first = first_block(b, b->next, length);
    if (boxls_finite(first.part)) {
        const pzs_real far = sign * first.part;
        go(b, b->next, first);
        b->v[k] = boxls_cut(b->v[k] + far, b->lo[k], b->hi[k]);
        add_multiples(b->move, row, b->free, far, far, boxls_span(b));
    }
    return first;
}

/* One pass along the ray of standing input k, at a minimum over F. */
static void release(boxls *b, uint32_t k)
{
    const int down = b->move[k] > 0;
    int to_limit;
    const pzs_real length = ray_length(b, k, &to_limit);
    const block first = follow(b, k, length);
    if (first.input < b->n) {
        drop(b, first.input, 0);
    } else if (to_limit && boxls_finite(first.part)) {
        b->v[k] = down ? b->lo[k] : b->hi[k];
    } else {
        b->move[k] = 0; /* done with it; an endless ray without curvature gains nothing but rounding */
        if (!to_limit && tableau_own_part(b, k) > b->floor)
            tableau_sweep(b, k);
    }
}

/* Whether no free input has a gradient above the noise; next holds these gradients. */
static int at_rest(const boxls *b)
{
    uint32_t i = 0;
    while (i < b->n && boxls_size(b->next[i]) <= b->noise)
        i++;
    return i == b->n;
}

/* Passes along move, from where something is in the way, to where the tableau sees no violation; returns those used. */
static uint32_t run_passes(boxls *b, pzs_real noise, uint32_t allowed)
{
    const uint32_t most = 2u * b->n + 8u < allowed ? 2u * b->n + 8u : allowed;
    uint32_t used = 0, k = 0;
    int blocked = 1;
    for (; blocked && used < most; used++)
        blocked = descend(b);
    for (; used < most && (k = worst_standing(b, noise)) < b->n; used++)
        release(b, k);
    return used;
}

/* ---- the straight pass ------------------------------------------------------------------ */

/* Measure the pull of input k at the end of the way; returns how far its gradient is from what the tableau foresees. */
static pzs_real measure(const boxls *b, uint32_t k, const pzs_real *away, pzs_real *pull)
{
    *pull = product_dot(b->h + (size_t)k * b->width, away, b->width) + b->bias[k];
    const pzs_real seen = *pull - b->want[k];
    return boxls_size(b->free[k] > 0 ? seen : seen - b->move[k]);
}

/* The gradient foreseen: 0 on F. */
static void foresee(pzs_real *restrict grad, const pzs_real *restrict move, const pzs_real *restrict free, size_t span)
{
    for (size_t i = 0; i < span; i++)
        grad[i] = free[i] > 0 ? 0 : move[i];
}

/* Stand at next, with the pull that goes with the gradient foreseen there. */
static void arrive(pzs_real *restrict v, pzs_real *restrict pull, const pzs_real *restrict next,
                   const pzs_real *restrict move, const pzs_real *restrict free, const pzs_real *restrict want, size_t span)
{
    for (size_t i = 0; i < span; i++) {
        v[i] = next[i];
        pull[i] = want[i] + (free[i] > 0 ? 0 : move[i]);
    }
}

/*
 * Go all the way in one pass, nothing being in the way. Returns 0, the tableau no longer proven and the volts
 * where they were, where the gradients measured at the end are not as foreseen.
 */
static int go_straight(boxls *b)
{
    const pzs_real *away = b->spare, rough = roughness(b, away);
    const uint32_t one = b->proven - 1u, two = one + 1u < b->n ? one + 1u : 0;
    const pzs_real near = NEAR * b->noise;
    pzs_real pull[2];
    b->left = measure(b, one, away, &pull[0]) + measure(b, two, away, &pull[1]);
    b->noise = NOISE * (b->rough_want + rough);
    if (b->left > b->noise)
        foresee(b->grad, b->move, b->free, boxls_span(b));
    if (!settled(b) || !(b->left <= near) || (b->left > b->noise && !costs_nothing(b, OTHERS * b->left))) {
        b->proven = 0;
        boxls_gradient(b);
        return 0;
    }
    b->rough = rough;
    b->proven = two + 1u < b->n ? two + 2u : 1u;
    b->used++;
    arrive(b->v, b->pull, b->next, b->move, b->free, b->want, boxls_span(b));
    b->pull[one] = pull[0];
    b->pull[two] = pull[1];
    return 1;
}

/* ---- rounds ------------------------------------------------------------------------- */

/* way = v - start, slope = grad + start_grad. */
static void difference(pzs_real *restrict way, pzs_real *restrict slope, const pzs_real *restrict v,
                       const pzs_real *restrict start, const pzs_real *restrict grad, const pzs_real *restrict start_grad,
                       size_t span)
{
    for (size_t i = 0; i < span; i++) {
        way[i] = v[i] - start[i];
        slope[i] = grad[i] + start_grad[i];
    }
}

/*
 * Whether the round lowered the objective: it changed by (v - start) . (sum of the gradients at both
 * ends), exactly. Rounding of so long a way must be less than the energy, or much less than the gain.
 */
static int fell(const boxls *b)
{
    difference(b->spare, b->move, b->v, b->start, b->grad, b->start_grad, boxls_span(b));
    const pzs_real change = product_dot(b->spare, b->move, b->width), sure = -change / SURE;
    const pzs_real far = PZS_SQRT(product_dot(b->spare, b->spare, b->width));
    return change < 0 && far * b->rough < (sure > b->energy ? sure : b->energy);
}

/* One round from where aim left it, to the true gradient where it ends. */
static void run_round(boxls *b, int blocked)
{
    const size_t bytes = b->width * sizeof(pzs_real);
    memcpy(b->start, b->v, bytes);
    memcpy(b->start_grad, b->grad, bytes);
    if (blocked)
        b->used += run_passes(b, b->noise / 2, b->allowed - b->used);
    else
        memcpy(b->v, b->next, bytes);
    b->used += !blocked;
    boxls_true_gradient(b);
}

/* What is left at v, and how much of it may be rounding. */
static void judge(boxls *b)
{
    b->left = boxls_violation(b, b->v, b->grad);
    b->noise = NOISE * (b->rough_want + b->rough);
}

/* Cut v to the limits; returns how many were outside. */
static uint32_t cut_volts(pzs_real *restrict v, const pzs_real *restrict lo, const pzs_real *restrict hi, size_t span)
{
    uint32_t outside = 0;
    for (size_t i = 0; i < span; i++) {
        outside += (v[i] < lo[i] ? 1u : 0u) + (v[i] > hi[i] ? 1u : 0u);
        v[i] = boxls_cut(v[i], lo[i], hi[i]);
    }
    return outside;
}

int boxls_come_inside(boxls *b)
{
    const int moved = cut_volts(b->v, b->lo, b->hi, boxls_span(b)) != 0;
    if (moved)
        boxls_true_gradient(b);
    return moved;
}

/*
 * Where the round ended: at the optimum, which proves the tableau; or with a gain; or it is undone. One that went so
 * far that only the rounding of its own way makes it look settled must have gained.
 */
static void conclude(boxls *b, int moved)
{
    const pzs_real noise = b->noise;
    judge(b);
    b->done = settled(b);
    if (b->done && moved && b->proven == 0)
        b->proven = 1;
    if (!moved || (b->done && b->left <= noise) || fell(b))
        return;
    memcpy(b->v, b->start, b->width * sizeof(pzs_real));
    (void)cut_volts(b->v, b->lo, b->hi, boxls_span(b));
    boxls_true_gradient(b);
    b->proven = 0;
    judge(b);
    b->done = settled(b);
}

/* Sweep anew after a round that gained little; a tableau that is fresh already takes more inputs as dependent. */
static void renew(boxls *b, int fresh)
{
    const pzs_real most = BOXLS_DEPENDENT * 4 * (pzs_real)b->n * PZS_EPSILON;
    b->floor = fresh ? boxls_cut(b->floor * 16, 0, most) : b->floor;
    tableau_rebuild(b);
    boxls_gradient(b);
}

void boxls_optimise(boxls *b)
{
    int fresh = 0;
    b->noise = NOISE * (b->rough_want + b->rough);
    b->done = 0;
    if (b->used >= b->allowed) {
        (void)boxls_come_inside(b);
        judge(b);
        b->done = b->left <= b->noise;
    }
    for (uint32_t round = 0; round < ROUNDS && !b->done && b->used < b->allowed; round++) {
        const int rest = at_rest(b), blocked = boxls_aim(b, b->noise / 2) != 0, moves = blocked || !rest;
        if ((blocked || rest) && boxls_come_inside(b))
            continue;
        if (moves && !blocked && b->proven > 0) {
            b->done = go_straight(b);
            continue;
        }
        if (moves)
            run_round(b, blocked);
        conclude(b, moves);
        if (!b->done && b->used < b->allowed && (!moves || b->left * POOR > boxls_violation(b, b->start, b->start_grad))) {
            renew(b, fresh);
            fresh = 1;
        }
    }
    b->done |= b->used < b->allowed && b->left <= NEAR * b->noise; /* as far as rounding lets it */
}
