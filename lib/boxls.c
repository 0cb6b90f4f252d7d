/*
 * The voltage optimiser: a primal active-set method on one symmetric matrix, the tableau.
 * "Swept" inputs F are those free to move together, the others S stand still:
 *
 *   tableau on F, S:   [ -H_FF^-1         H_FF^-1 H_FS                ]
 *                      [ H_SF H_FF^-1     H_SS - H_SF H_FF^-1 H_FS    ]
 *
 * One symmetric rank-1 change (sweep) moves an input between F and S. One product with the
 * gradient gives `move`: on F the way to the minimum over F, on S the gradient once there.
 *
 * A round starts from the true gradient and makes passes; each pass goes as far as limits allow:
 *   descend  along move; an input that meets a limit stays there and leaves F;
 *   release  at a minimum over F: one standing input k with a wrong multiplier moves along its ray
 *            (F follows, keeping its gradient zero) to the ray's minimum, where k joins F, or to
 *            k's other limit, or until an input of F meets a limit and leaves F.
 * The round ends with the true gradient from H, so errors of the tableau never reach the volts:
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
 * In rounding: only multipliers above a noise level count, a round whose objective does not fall
 * (by the true gradients at both ends) is undone, and passes and rounds are counted. Volts
 * are feasible after every pass because they are only ever cut by comparison.
 */
#include <string.h>
#include "boxls.h"
#include "unrolled.h"

#define ROUNDS 8u     /* most rounds of one call */
#define NOISE 4       /* multipliers below NOISE times the rounding of a gradient are zero */
#define NEAR 256      /* how far above the noise gradients of free inputs may be, where that costs nothing */
#define POOR 16       /* a round that lowers the violation less than this asks for a fresh tableau */
#define DEPENDENT 256 /* most that floor may grow, over its start 4 n epsilon */

/* Tiles of columns taken in one go: as many as the registers hold, and what fills up. */
#define MANY PZS_BY_BITS(7, PZS_BY_TILE(3, 7, 7))
#define SOME PZS_BY_TILE(2, 4, 4)
#define LANES 8u /* sums side by side in a dot product */

/* ---- sums ------------------------------------------------------------------ */

/* Entry i of a full group is summed in lane i: independent chains, and the same bits at any vector width. */
pzs_real boxls_dot(const pzs_real *x, const pzs_real *y, size_t n)
{
    pzs_real sum[LANES] = {0};
    size_t i = 0;
    for (; i + LANES <= n; i += LANES) {
        UNROLLED
        for (unsigned k = 0; k < LANES; k++)
            sum[k] += x[i + k] * y[i + k];
    }
    for (; i + 4u <= n; i += 4u) { /* the lanes they have in a full group: zeros that fill a tile change nothing */
        UNROLLED
        for (unsigned k = 0; k < 4u; k++)
            sum[k] += x[i + k] * y[i + k];
    }
    for (; i < n; i++)
        sum[0] += x[i] * y[i];
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

pzs_real boxls_largest(const pzs_real *x, size_t n)
{
    pzs_real s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    for (size_t i = 0; i < n; i += 4u) {
        s0 = x[i] > s0 ? x[i] : s0;
        s1 = x[i + 1u] > s1 ? x[i + 1u] : s1;
        s2 = x[i + 2u] > s2 ? x[i + 2u] : s2;
        s3 = x[i + 3u] > s3 ? x[i + 3u] : s3;
    }
    s0 = s1 > s0 ? s1 : s0;
    s2 = s3 > s2 ? s3 : s2;
    return s2 > s0 ? s2 : s0;
}

#define EACH_ENTRY(COUNT) UNROLLED for (int t = 0; t < (COUNT); t++) UNROLLED for (int j = 0; j < PZS_TILE; j++)

/*
 * y = sum of x_i times row i, over COUNT tiles of columns side by side, the last of them at column `last`: where it
 * overlaps the one before, both form the same sums.
 */
#define SUM_TILES(name, COUNT) \
    static void name(pzs_real *restrict y, const pzs_real *restrict a, size_t stride, const pzs_real *restrict x, \
                     size_t rows, size_t last) \
    { \
        pzs_real sum[COUNT][PZS_TILE]; \
        const pzs_real *b = a + last; \
        EACH_ENTRY(COUNT) \
            sum[t][j] = 0; \
        for (size_t i = 0; i < rows; i++, a += stride, b += stride) { \
            const pzs_real xi = x[i]; \
            EACH_ENTRY(COUNT) \
                sum[t][j] += xi * (t + 1 < (COUNT) ? a[t * PZS_TILE + j] : b[j]); \
        } \
        for (int t = 0; PZS_TILE > 4 && t < (COUNT); t++) \
            memcpy(y + (t + 1 < (COUNT) ? (size_t)t * PZS_TILE : last), sum[t], sizeof sum[t]); \
        EACH_ENTRY(PZS_TILE > 4 ? 0 : (COUNT)) \
            y[(t + 1 < (COUNT) ? (size_t)t * PZS_TILE : last) + (size_t)j] = sum[t][j]; \
    }

SUM_TILES(sum_many, MANY)
SUM_TILES(sum_some, SOME)
SUM_TILES(sum_one, 1)

/* Fewer columns than a tile. */
static void sum_few(pzs_real *restrict y, const pzs_real *restrict a, size_t stride, const pzs_real *restrict x,
                    size_t rows, size_t cols)
{
    for (size_t j = 0; j < cols; j++) {
        y[j] = 0;
        for (size_t i = 0; i < rows; i++)
            y[j] += x[i] * a[i * stride + j];
    }
}

void boxls_sum_rows(pzs_real *restrict y, const pzs_real *restrict a, size_t stride, const pzs_real *restrict x, size_t rows,
                    size_t cols)
{
    if (cols < PZS_TILE)
        sum_few(y, a, stride, x, rows, cols);
    for (size_t j = 0; cols >= PZS_TILE && j < cols;) {
        const size_t tiles = (cols - j + PZS_TILE - 1u) / PZS_TILE;
        const size_t now = tiles >= MANY ? MANY : tiles >= SOME ? SOME : 1, end = j + now * PZS_TILE;
        const size_t last = (end < cols ? end : cols) - PZS_TILE, from = now > 1u ? j : last;
        if (now == MANY)
            sum_many(y + from, a + from, stride, x, rows, last - from);
        else if (now == SOME)
            sum_some(y + from, a + from, stride, x, rows, last - from);
        else
            sum_one(y + from, a + from, stride, x, rows, 0);
        j = end;
    }
}

/* y = A x, A [n][width] symmetric. */
static void symmetric(pzs_real *restrict y, const pzs_real *restrict a, const pzs_real *restrict x, uint32_t n,
                      uint32_t padded)
{
    const size_t width = boxls_whole(padded);
    boxls_sum_rows(y, a, width, x, n, width);
}

void boxls_place(boxls *b, pzs_real *work)
{
    pzs_real **const vector[BOXLS_VECTORS] = {&b->lo, &b->hi, &b->free, &b->base, &b->bias, &b->want, &b->pull,
                                              &b->grad, &b->move, &b->diag, &b->start, &b->start_grad, &b->next,
                                              &b->spare};
    for (uint32_t k = 0; k < BOXLS_VECTORS; k++)
        *vector[k] = work + (size_t)k * b->width;
}

/* ---- tableau ------------------------------------------------------------------ */

/* Pivot of a standing input over its diagonal: what is left of it beside the swept ones, 0 to 1. */
static pzs_real own_part(const boxls *b, uint32_t k)
{
    return b->diag[k] > 0 ? b->m[(size_t)k * b->width + k] / b->diag[k] : 0;
}

/* m -= sign s s', all rows: symmetric to the last bit. */
static void rank_one(pzs_real *restrict m, const pzs_real *restrict s, pzs_real sign, uint32_t n, uint32_t padded)
{
    const size_t width = boxls_whole(padded);
    for (uint32_t i = 0; i < n; i++) {
        pzs_real *restrict row = m + i * width;
        const pzs_real f = sign * s[i];
        for (size_t j = 0; j < width; j++)
            row[j] -= f * s[j];
    }
}

/* Move input k into F (its pivot is positive) or out of it (negative). */
static void sweep(boxls *b, uint32_t k)
{
    pzs_real *row = b->m + (size_t)k * b->width, *s = b->spare;
    const pzs_real pivot = row[k], scale = 1 / PZS_SQRT(boxls_size(pivot));
    for (uint32_t j = 0; j < b->width; j++)
        s[j] = row[j] * scale;
    rank_one(b->m, s, pivot < 0 ? (pzs_real)-1 : (pzs_real)1, b->n, b->width);
    for (uint32_t j = 0; j < b->n; j++) {
        row[j] = s[j] * scale;
        b->m[(size_t)j * b->width + k] = row[j];
    }
    row[k] = -1 / pivot;
    b->free[k] = 1 - b->free[k];
    b->soft = 0;
}

/* The most independent standing input whose move is marked, or n. */
static uint32_t next_pivot(const boxls *b)
{
    pzs_real most = b->floor;
    uint32_t next = b->n;
    for (uint32_t k = 0; k < b->n; k++) {
        const pzs_real part = b->move[k] > 0 ? own_part(b, k) : 0;
        next = part > most ? k : next;
        most = part > most ? part : most;
    }
    return next;
}

/* The most independent first; those that depend on the ones before stand. */
void boxls_rebuild(boxls *b)
{
    memcpy(b->m, b->h, (size_t)b->n * b->width * sizeof(pzs_real));
    memcpy(b->move, b->free, b->width * sizeof(pzs_real));
    memset(b->free, 0, b->width * sizeof(pzs_real));
    b->soft = 0;
    uint32_t k = next_pivot(b);
    for (uint32_t count = 0; count < b->n && k < b->n; count++) {
        sweep(b, k);
        b->move[k] = 0;
        k = next_pivot(b);
    }
}

/* Take input j out of F where `left` of its way to the minimum over F is not gone. */
static void drop(boxls *b, uint32_t j, pzs_real left)
{
    const pzs_real *row = b->m + (size_t)j * b->width;
    sweep(b, j);
    for (uint32_t i = 0; i < b->n; i++) {
        const pzs_real part = left * row[i];
        b->move[i] += b->free[i] > 0 ? part : -part;
    }
    b->move[j] = -left * row[j];
}

/* ---- gradients ------------------------------------------------------------------ */

/* grad = pull + bias - want; where inputs are free, next is the same, elsewhere 0. */
static void combine(pzs_real *restrict grad, pzs_real *restrict next, const pzs_real *restrict pull,
                    const pzs_real *restrict bias, const pzs_real *restrict want, const pzs_real *restrict free,
                    size_t width)
{
    for (size_t i = 0; i < width; i++) {
        const pzs_real g = (pull[i] + bias[i]) - want[i];
        grad[i] = g;
        next[i] = free[i] > 0 ? g : 0;
    }
}

void boxls_gradient(boxls *b)
{
    combine(b->grad, b->next, b->pull, b->bias, b->want, b->free, boxls_whole(b->width));
}

/* away = v - base, far = |v - base|. */
static void distance(pzs_real *restrict away, pzs_real *restrict far, const pzs_real *restrict v,
                     const pzs_real *restrict base, size_t width)
{
    for (size_t i = 0; i < width; i++) {
        away[i] = v[i] - base[i];
        far[i] = boxls_size(away[i]);
    }
}

void boxls_true_gradient(boxls *b)
{
    distance(b->spare, b->next, b->v, b->base, boxls_whole(b->width));
    b->rough = PZS_EPSILON * boxls_dot(b->diag, b->next, b->width);
    symmetric(b->pull, b->h, b->spare, b->n, b->width);
    boxls_gradient(b);
}

/*
 * move = the way where free, the gradient after it elsewhere; next = v after the way. Returns how many
 * would leave their limits or, standing, have a gradient above noise: 0 ends the round.
 */
static uint32_t look_ahead(pzs_real *restrict move, pzs_real *restrict next, const pzs_real *restrict free,
                           const pzs_real *restrict grad, const pzs_real *restrict v, const pzs_real *restrict lo,
                           const pzs_real *restrict hi, pzs_real noise, size_t width)
{
    uint32_t open = 0;
    for (size_t i = 0; i < width; i++) {
        if (PZS_TILE == 4 && free[i] > 0) { /* the same with fewer instructions, where there are no vectors */
            const pzs_real x = v[i] + move[i];
            next[i] = x;
            open += x < lo[i] || x > hi[i];
            continue;
        }
        const pzs_real way = free[i] > 0 ? move[i] : 0, slope = free[i] > 0 ? 0 : grad[i] - move[i];
        const pzs_real x = v[i] + way, down = x > lo[i] ? slope : 0, up = x < hi[i] ? -slope : 0;
        const pzs_real most = down > up ? down : up;
        move[i] = way + slope;
        next[i] = x;
        open += (x < lo[i] ? 1u : 0u) + (x > hi[i] ? 1u : 0u) + (most > noise ? 1u : 0u);
    }
    return open;
}

uint32_t boxls_aim(boxls *b, pzs_real noise)
{
    symmetric(b->move, b->m, b->next, b->n, b->width);
    return look_ahead(b->move, b->next, b->free, b->grad, b->v, b->lo, b->hi, noise, boxls_whole(b->width));
}

/* out = the size of the gradient where the volts could follow it downhill, else at most 0. */
static void downhill(pzs_real *restrict out, const pzs_real *restrict v, const pzs_real *restrict lo,
                     const pzs_real *restrict hi, const pzs_real *restrict grad, size_t width)
{
    for (size_t i = 0; i < width; i++) {
        const pzs_real g = grad[i], down = v[i] > lo[i] ? g : 0, up = v[i] < hi[i] ? -g : 0;
        out[i] = down > up ? down : up;
    }
}

/* Largest violated optimality condition at v, where the gradient is grad. */
static pzs_real violation(const boxls *b, const pzs_real *v, const pzs_real *grad)
{
    downhill(b->spare, v, b->lo, b->hi, grad, boxls_whole(b->width));
    return boxls_largest(b->spare, b->width);
}

/* Trace of the inverse of H on F; dependent inputs count with the most it can be (V2/m2). */
static pzs_real softness(boxls *b)
{
    if (b->soft > 0)
        return b->soft;
    pzs_real soft = 0;
    for (uint32_t i = 0; i < b->n; i++) {
        const pzs_real pivot = b->m[(size_t)i * b->width + i], least = b->floor * b->diag[i];
        soft += b->free[i] > 0 ? -pivot : pivot < least ? 1 / least : 0;
    }
    b->soft = soft;
    return soft;
}

int boxls_coarse(boxls *b)
{
    return b->rough * b->rough * softness(b) > PZS_EPSILON * b->energy;
}

/*
 * Whether the volts of the round may stand: no violation above the noise; or one on F alone, not far above
 * it, that costs less than epsilon of the energy (its square times the inverse of H) and is too small to turn
 * the multiplier of a standing input.
 */
static int settled(boxls *b)
{
    if (!(b->left > b->noise))
        return 1;
    const pzs_real turn = (pzs_real)b->n * b->left;
    downhill(b->spare, b->v, b->lo, b->hi, b->grad, boxls_whole(b->width));
    for (uint32_t i = 0; i < b->n; i++) {
        const int small = b->lo[i] < b->hi[i] && boxls_size(b->grad[i]) <= turn;
        if (!(b->free[i] > 0) && (small || b->spare[i] > b->noise))
            return 0;
    }
    return b->left <= NEAR * b->noise && b->left * b->left * softness(b) <= PZS_EPSILON * b->energy;
}

/* ---- passes ----------------------------------------------------------------------- */

typedef struct block {
    pzs_real part;  /* of the way that is free */
    uint32_t input; /* the first to meet a limit, or n */
} block;

/* Shorten the way `part * step[i]` of swept inputs to the first limit met. */
static block first_block(const boxls *b, const pzs_real *step, pzs_real part)
{
    block first = { part, b->n };
    for (uint32_t i = 0; i < b->n; i++) {
        const pzs_real room = step[i] < 0 ? b->v[i] - b->lo[i] : b->hi[i] - b->v[i];
        if (room < first.part * boxls_size(step[i]) && b->free[i] > 0) {
            first.part = room / boxls_size(step[i]);
            first.input = i;
        }
    }
    return first;
}

/* Go along step; the input that met its limit stands on it exactly. */
static void go(boxls *b, const pzs_real *step, block first)
{
    for (uint32_t i = 0; i < b->n; i++) {
        const pzs_real there = boxls_cut(b->v[i] + first.part * step[i], b->lo[i], b->hi[i]);
        b->v[i] = b->free[i] > 0 ? there : b->v[i];
    }
    if (first.input < b->n)
        b->v[first.input] = step[first.input] < 0 ? b->lo[first.input] : b->hi[first.input];
}

/* One pass along move. Returns nonzero where a limit stopped it. */
static int descend(boxls *b)
{
    const block first = first_block(b, b->move, 1);
    go(b, b->move, first);
    if (first.input == b->n)
        return 0;
    for (uint32_t i = 0; i < b->n; i++)
        b->move[i] *= b->free[i] > 0 ? 1 - first.part : 1;
    drop(b, first.input, b->move[first.input]);
    return 1;
}

/* The standing input to release: the worst between its limits, else the worst at one, else n. */
static uint32_t worst_standing(const boxls *b, pzs_real noise)
{
    pzs_real most[2] = { noise, noise };
    uint32_t input[2] = { b->n, b->n };
    for (uint32_t i = 0; i < b->n; i++) {
        const pzs_real pull = boxls_size(b->move[i]);
        if (pull > noise && !(b->free[i] > 0)) {
            const int low = !(b->v[i] > b->lo[i]), high = !(b->v[i] < b->hi[i]);
            const int kept = b->move[i] > 0 ? low : high, at = low | high;
            if (pull > most[at] && !kept) {
                most[at] = pull;
                input[at] = i;
            }
        }
    }
    return input[0] < b->n ? input[0] : input[1];
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
        for (uint32_t i = 0; i < b->n; i++)
            b->move[i] += far * row[i];
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
        if (!to_limit && own_part(b, k) > b->floor)
            sweep(b, k);
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

/* Passes from the true gradient to where the tableau sees no violation; returns those used, 0 at the optimum. */
static uint32_t run_passes(boxls *b, pzs_real noise, uint32_t allowed)
{
    const uint32_t most = 2u * b->n + 8u < allowed ? 2u * b->n + 8u : allowed;
    uint32_t used = 0, k = 0;
    int blocked = 1;
    const int rest = at_rest(b);
    if (boxls_aim(b, noise) == 0) {
        if (rest)
            return 0;
        memcpy(b->v, b->next, b->width * sizeof(pzs_real));
        return 1;
    }
    for (; blocked && used < most; used++)
        blocked = descend(b);
    for (; used < most && (k = worst_standing(b, noise)) < b->n; used++)
        release(b, k);
    return used;
}

/* ---- rounds ------------------------------------------------------------------------- */

/* way = v - start, slope = grad + start_grad. */
static void difference(pzs_real *restrict way, pzs_real *restrict slope, const pzs_real *restrict v,
                       const pzs_real *restrict start, const pzs_real *restrict grad, const pzs_real *restrict start_grad,
                       size_t width)
{
    for (size_t i = 0; i < width; i++) {
        way[i] = v[i] - start[i];
        slope[i] = grad[i] + start_grad[i];
    }
}

/*
 * Whether the round lowered the objective: it changed by (v - start) . (sum of the gradients at both
 * ends), exactly. A round that went so far that rounding hides the change counts as not having.
 */
static int fell(const boxls *b)
{
    difference(b->spare, b->move, b->v, b->start, b->grad, b->start_grad, boxls_whole(b->width));
    const pzs_real change = boxls_dot(b->spare, b->move, b->width);
    const pzs_real far = boxls_dot(b->spare, b->spare, b->width);
    return change < 0 && far * (b->rough * b->rough) < b->energy * b->energy;
}

/* One round; one that gained nothing leaves volts and gradient as they were. */
static void run_round(boxls *b)
{
    const size_t bytes = b->width * sizeof(pzs_real);
    memcpy(b->start, b->v, bytes);
    memcpy(b->start_grad, b->grad, bytes);
    const uint32_t passes = run_passes(b, b->noise / 2, b->allowed - b->used);
    b->used += passes;
    if (passes != 0)
        boxls_true_gradient(b);
    if (passes != 0 && !fell(b)) {
        memcpy(b->v, b->start, bytes);
        boxls_true_gradient(b);
    }
}

/* What is left at v, and how much of it may be rounding. */
static void judge(boxls *b)
{
    b->left = violation(b, b->v, b->grad);
    b->noise = NOISE * (b->exact + b->rough);
}

/* Sweep anew after a round that gained little; a tableau that is fresh already takes more inputs as dependent. */
static void renew(boxls *b, int fresh)
{
    const pzs_real most = DEPENDENT * 4 * (pzs_real)b->n * PZS_EPSILON;
    b->floor = fresh ? boxls_cut(b->floor * 16, 0, most) : b->floor;
    boxls_rebuild(b);
    boxls_gradient(b);
}

void boxls_optimise(boxls *b)
{
    int fresh = 0;
    b->noise = NOISE * (b->exact + b->rough);
    b->done = 0;
    if (b->used >= b->allowed) {
        judge(b);
        b->done = !(b->left > b->noise);
    }
    for (uint32_t round = 0; round < ROUNDS && !b->done && b->used < b->allowed; round++) {
        run_round(b);
        judge(b);
        b->done = settled(b);
        if (!b->done && b->used < b->allowed && b->left * POOR > violation(b, b->start, b->start_grad)) {
            renew(b, fresh);
            fresh = 1;
        }
    }
    b->done |= b->used < b->allowed && b->left <= NEAR * b->noise; /* as far as rounding lets it */
}
