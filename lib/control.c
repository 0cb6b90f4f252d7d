/*
 * Control: a target shape to voltages inside hard limits, in bounded time.
 *
 *   min |W (B v - e)|^2 + effort |v - prefer|^2,   lower <= v <= upper, |v - v_last| <= slew
 *
 * With H = B'W^2 B + effort I and pull = H v - effort prefer the gradient is pull - B'W^2 e.
 * The optimiser is a primal active-set method on one symmetric matrix, the tableau.
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
#include <math.h>
#include <string.h>
#include "guard.h"

#define READY 1u
#define ROUNDS 8u        /* most rounds of one step */
#define NOISE 4          /* multipliers below NOISE epsilon |gradient terms| are zero */
#define POOR 16          /* a round that lowers the KKT violation less than this asks for a fresh tableau */
#define FROZEN_TICKS 8u  /* a measurement that repeats so often while its output moves is frozen */
#define FROZEN_PART 64   /* "moves": by more than 1/FROZEN_PART of |measured| + |predicted| in a tick */
#define VECTORS 15u      /* in control->work */

/* The optimiser's arrays, each [width]; entries from n to width stay zero. */
typedef struct desk {
    uint32_t n, width;
    const pzs_real *h;   /* [n][width] Hessian (m2/V2) */
    pzs_real *m;         /* [n][width] tableau */
    pzs_real *v;         /* volts */
    pzs_real *lo, *hi;   /* limits of this step: limits in force and slew window (V) */
    pzs_real *side;      /* +1 swept, -1 standing */
    pzs_real *base;      /* volts whose shape B base is `predicted` */
    pzs_real *bias;      /* effort (base - prefer) */
    pzs_real *full;      /* B'W^2 B base */
    pzs_real *pull;      /* H (v - base) */
    pzs_real *want;      /* B'W^2 (e - B base) */
    pzs_real *grad;      /* pull + bias - want, the gradient at v */
    pzs_real *move;      /* swept: way to go (V); standing: gradient after it */
    pzs_real *diag;      /* of H */
    pzs_real *start;     /* volts at the start of the round */
    pzs_real *start_grad;
    pzs_real *undo;
    pzs_real *spare;
    pzs_real *floor;     /* [1] pivots below this part of their diagonal count as dependent */
} desk;

static uint32_t width_of(uint32_t n)
{
    return (n + PZS_TILE - 1u) & ~(PZS_TILE - 1u);
}

static desk desk_of(pzs_control *c)
{
    const uint32_t n = c->problem->inputs, width = width_of(n);
    pzs_real *w = c->work;
    const desk d = {
        n, width, c->hessian, c->tableau, c->volt, w, w + width, w + 2u * width, w + 3u * width,
        w + 4u * width, w + 5u * width, w + 6u * width, w + 7u * width, w + 8u * width, w + 9u * width,
        w + 10u * width, w + 11u * width, w + 12u * width, w + 13u * width, w + 14u * width, &c->dependence,
    };
    return d;
}

/* ---- small arithmetic --------------------------------------------------- */

static pzs_real size(pzs_real x)
{
    return x < 0 ? -x : x;
}

static int finite(pzs_real x)
{
    const pzs_real none = x - x;
    return none <= 0;
}

static pzs_real root(pzs_real x)
{
    return PZS_BY_BITS(sqrtf((float)x), sqrt((double)x));
}

static pzs_real cut(pzs_real x, pzs_real lo, pzs_real hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

/* Sum of x_i y_i in four interleaved sums: the same order, so the same bits, at any vector width. */
static pzs_real dot(const pzs_real *x, const pzs_real *y, uint32_t n)
{
    pzs_real sum[4] = { 0, 0, 0, 0 };
    uint32_t i = 0;
    for (; i + 4u <= n; i += 4u) {
        sum[0] += x[i] * y[i];
        sum[1] += x[i + 1u] * y[i + 1u];
        sum[2] += x[i + 2u] * y[i + 2u];
        sum[3] += x[i + 3u] * y[i + 3u];
    }
    for (; i < n; ++i) {
        sum[0] += x[i] * y[i];
    }
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

static pzs_real sum(const pzs_real *x, uint32_t n)
{
    pzs_real part[4] = { 0, 0, 0, 0 };
    for (uint32_t i = 0; i < n; i += 4u) {
        part[0] += x[i];
        part[1] += x[i + 1u];
        part[2] += x[i + 2u];
        part[3] += x[i + 3u];
    }
    return (part[0] + part[1]) + (part[2] + part[3]);
}

/* Largest of x [n], not below zero; n a multiple of 4. */
static pzs_real largest(const pzs_real *x, uint32_t n)
{
    pzs_real top[4] = { 0, 0, 0, 0 };
    for (uint32_t i = 0; i < n; i += 4u) {
        top[0] = x[i] > top[0] ? x[i] : top[0];
        top[1] = x[i + 1u] > top[1] ? x[i + 1u] : top[1];
        top[2] = x[i + 2u] > top[2] ? x[i + 2u] : top[2];
        top[3] = x[i + 3u] > top[3] ? x[i + 3u] : top[3];
    }
    top[0] = top[1] > top[0] ? top[1] : top[0];
    top[2] = top[3] > top[2] ? top[3] : top[2];
    return top[2] > top[0] ? top[2] : top[0];
}

/* y += x_0 a_0 + ... + x_7 a_7, in this order, for eight rows of a. */
static void add_eight(pzs_real *restrict y, const pzs_real *restrict a, uint32_t stride,
                      const pzs_real *restrict x, uint32_t cols)
{
    const pzs_real *a1 = a + stride, *a2 = a1 + stride, *a3 = a2 + stride;
    const pzs_real *a4 = a3 + stride, *a5 = a4 + stride, *a6 = a5 + stride, *a7 = a6 + stride;
    const pzs_real x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3], x4 = x[4], x5 = x[5], x6 = x[6], x7 = x[7];
    for (uint32_t j = 0; j < cols; ++j) {
        y[j] = (((((((y[j] + x0 * a[j]) + x1 * a1[j]) + x2 * a2[j]) + x3 * a3[j]) + x4 * a4[j]) + x5 * a5[j])
                + x6 * a6[j]) + x7 * a7[j];
    }
}

/* y [cols] += sum over the rows of x_i times row i of a [rows][stride]. */
static void add_rows(pzs_real *restrict y, const pzs_real *restrict a, uint32_t stride,
                     const pzs_real *restrict x, uint32_t rows, uint32_t cols)
{
    uint32_t i = 0;
    for (; i + 8u <= rows; i += 8u) {
        add_eight(y, a + (size_t)i * stride, stride, x + i, cols);
    }
    for (; i < rows; ++i) {
        const pzs_real *row = a + (size_t)i * stride, xi = x[i];
        for (uint32_t j = 0; j < cols; ++j) {
            y[j] += xi * row[j];
        }
    }
}

/* y [rows] = a x, a [rows][cols]: eight rows at a time, each summed in ascending order. */
static void multiply(pzs_real *restrict y, const pzs_real *restrict a, const pzs_real *restrict x,
                     uint32_t rows, uint32_t cols)
{
    uint32_t i = 0;
    for (; i + 4u <= rows; i += 4u) {
        const pzs_real *a0 = a + (size_t)i * cols, *a1 = a0 + cols, *a2 = a1 + cols, *a3 = a2 + cols;
        pzs_real y0 = 0, y1 = 0, y2 = 0, y3 = 0;
        for (uint32_t j = 0; j < cols; ++j) {
            const pzs_real xj = x[j];
            y0 += a0[j] * xj;
            y1 += a1[j] * xj;
            y2 += a2[j] * xj;
            y3 += a3[j] * xj;
        }
        y[i] = y0;
        y[i + 1u] = y1;
        y[i + 2u] = y2;
        y[i + 3u] = y3;
    }
    for (; i < rows; ++i) {
        y[i] = 0;
        for (uint32_t j = 0; j < cols; ++j) {
            y[i] += a[(size_t)i * cols + j] * x[j];
        }
    }
}

/* ---- tableau -------------------------------------------------------------- */

/* Pivot of a standing input over its diagonal: what is left of it beside the swept ones, 0 to 1. */
static pzs_real own_part(const desk *d, uint32_t k)
{
    return d->diag[k] > 0 ? d->m[(size_t)k * d->width + k] / d->diag[k] : 0;
}

/* a -= sign s s', all rows: symmetric to the last bit. */
static void rank_one(const desk *d, const pzs_real *restrict s, pzs_real sign)
{
    const uint32_t width = d->width & ~(PZS_TILE - 1u);
    for (uint32_t i = 0; i < d->n; ++i) {
        pzs_real *restrict row = d->m + (size_t)i * width;
        const pzs_real f = sign * s[i];
        for (uint32_t j = 0; j < width; ++j) {
            row[j] -= f * s[j];
        }
    }
}

/* Move input k into F (its pivot is positive) or out of it (negative). */
static void sweep(const desk *d, uint32_t k)
{
    pzs_real *row = d->m + (size_t)k * d->width, *s = d->spare;
    const pzs_real pivot = row[k], scale = 1 / root(size(pivot));
    for (uint32_t j = 0; j < d->width; ++j) {
        s[j] = row[j] * scale;
    }
    rank_one(d, s, pivot < 0 ? (pzs_real)-1 : (pzs_real)1);
    for (uint32_t j = 0; j < d->n; ++j) {
        row[j] = s[j] * scale;
        d->m[(size_t)j * d->width + k] = row[j];
    }
    row[k] = -1 / pivot;
    d->side[k] = -d->side[k];
}

/* Sweep anew from H every input marked as swept, the most independent first; those that depend on them stand. */
static void rebuild(const desk *d)
{
    memcpy(d->m, d->h, (size_t)d->n * d->width * sizeof(pzs_real));
    for (uint32_t i = 0; i < d->width; ++i) {
        d->move[i] = d->side[i];
        d->side[i] = -1;
    }
    for (uint32_t count = 0; count < d->n; ++count) {
        uint32_t next = d->n;
        pzs_real most = *d->floor;
        for (uint32_t k = 0; k < d->n; ++k) {
            const pzs_real part = d->move[k] > 0 ? own_part(d, k) : 0;
            next = part > most ? k : next;
            most = part > most ? part : most;
        }
        if (next == d->n) {
            return;
        }
        d->move[next] = -1;
        sweep(d, next);
    }
}

/* Take input j out of F where `left` of its way to the minimum over F is not gone. */
static void drop(const desk *d, uint32_t j, pzs_real left)
{
    const pzs_real *row = d->m + (size_t)j * d->width;
    sweep(d, j);
    for (uint32_t i = 0; i < d->n; ++i) {
        d->move[i] += d->side[i] * left * row[i];
    }
    d->move[j] = -left * row[j];
}

/* ---- passes ---------------------------------------------------------------- */

static void gradient_from_pull(const desk *d)
{
    for (uint32_t i = 0; i < d->width; ++i) {
        d->grad[i] = (d->pull[i] + d->bias[i]) - d->want[i];
    }
}

/* pull and gradient from H itself. */
static void true_gradient(const desk *d)
{
    const uint32_t width = d->width & ~(PZS_TILE - 1u);
    for (uint32_t i = 0; i < width; ++i) {
        d->spare[i] = d->v[i] - d->base[i];
        d->pull[i] = 0;
    }
    add_rows(d->pull, d->h, width, d->spare, d->n, width);
    gradient_from_pull(d);
}

/* move from the gradient and the tableau. */
static void aim(const desk *d)
{
    const uint32_t width = d->width & ~(PZS_TILE - 1u);
    for (uint32_t i = 0; i < width; ++i) {
        d->spare[i] = d->side[i] > 0 ? d->grad[i] : 0;
        d->move[i] = 0;
    }
    add_rows(d->move, d->m, width, d->spare, d->n, width);
    for (uint32_t i = 0; i < width; ++i) {
        d->move[i] = d->side[i] > 0 ? d->move[i] : d->grad[i] - d->move[i];
    }
}

/* Largest violated optimality condition: a gradient not zero where the volts could follow it. */
static pzs_real violation(const desk *d)
{
    const uint32_t width = d->width & ~(PZS_TILE - 1u);
    for (uint32_t i = 0; i < width; ++i) {
        const pzs_real down = d->v[i] > d->lo[i] ? d->grad[i] : 0;
        const pzs_real up = d->v[i] < d->hi[i] ? -d->grad[i] : 0;
        d->spare[i] = down > up ? down : up;
    }
    return largest(d->spare, width);
}

typedef struct block {
    pzs_real part; /* of the way that is free */
    uint32_t input; /* the first to meet a limit, or n */
} block;

/* Shorten the way `part * step[i]` of swept inputs to the first limit met. */
static block first_block(const desk *d, const pzs_real *step, pzs_real part)
{
    block b = { part, d->n };
    for (uint32_t i = 0; i < d->n; ++i) {
        if (d->side[i] > 0) {
            const pzs_real room = step[i] < 0 ? d->v[i] - d->lo[i] : d->hi[i] - d->v[i];
            if (room < b.part * size(step[i])) {
                b.part = room / size(step[i]);
                b.input = i;
            }
        }
    }
    return b;
}

/* Go along step; the input that met its limit stands on it exactly. */
static void go(const desk *d, const pzs_real *step, block b)
{
    for (uint32_t i = 0; i < d->n; ++i) {
        if (d->side[i] > 0) {
            d->v[i] = cut(d->v[i] + b.part * step[i], d->lo[i], d->hi[i]);
        }
    }
    if (b.input < d->n) {
        d->v[b.input] = step[b.input] < 0 ? d->lo[b.input] : d->hi[b.input];
    }
}

/* One pass along move. Returns nonzero where a limit stopped it. */
static int descend(const desk *d)
{
    const uint32_t width = d->width & ~(PZS_TILE - 1u);
    uint32_t outside = 0;
    for (uint32_t i = 0; i < width; ++i) {
        const pzs_real next = d->v[i] + (d->side[i] > 0 ? d->move[i] : 0);
        d->spare[i] = next;
        outside += (uint32_t)(next < d->lo[i]) | (uint32_t)(next > d->hi[i]);
    }
    if (outside == 0) {
        memcpy(d->v, d->spare, width * sizeof(pzs_real));
        return 0;
    }
    const block b = first_block(d, d->move, 1);
    go(d, d->move, b);
    if (b.input == d->n) {
        return 0;
    }
    for (uint32_t i = 0; i < d->n; ++i) {
        d->move[i] *= d->side[i] > 0 ? 1 - b.part : 1;
    }
    drop(d, b.input, d->move[b.input]);
    return 1;
}

/* The standing input to release: the worst between its limits, else the worst at one, else n. */
static uint32_t worst_standing(const desk *d, pzs_real noise)
{
    pzs_real most[2] = { noise, noise };
    uint32_t input[2] = { d->n, d->n };
    for (uint32_t i = 0; i < d->n; ++i) {
        const pzs_real pull = d->side[i] > 0 ? 0 : size(d->move[i]);
        const int low = !(d->v[i] > d->lo[i]), high = !(d->v[i] < d->hi[i]);
        const int kept = d->move[i] > 0 ? low : high, at = low | high;
        if (pull > most[at] && !kept) {
            most[at] = pull;
            input[at] = i;
        }
    }
    return input[0] < d->n ? input[0] : input[1];
}

/* How far input k may go along its ray (V): to the ray's minimum, or its own limit. */
static pzs_real ray_length(const desk *d, uint32_t k, pzs_real pivot, int *to_limit)
{
    const pzs_real room = d->move[k] > 0 ? d->v[k] - d->lo[k] : d->hi[k] - d->v[k];
    const pzs_real floor = (finite(room) ? PZS_EPSILON : *d->floor) * d->diag[k];
    const pzs_real curvature = pivot > floor ? pivot : floor;
    *to_limit = !(size(d->move[k]) < room * curvature);
    return *to_limit ? room : size(d->move[k]) / curvature;
}

/* One pass along the ray of standing input k, at a minimum over F. */
static void release(const desk *d, uint32_t k)
{
    const pzs_real *row = d->m + (size_t)k * d->width;
    const pzs_real pivot = row[k], sign = d->move[k] > 0 ? (pzs_real)-1 : (pzs_real)1;
    int to_limit;
    const pzs_real length = ray_length(d, k, pivot, &to_limit);
    for (uint32_t i = 0; i < d->n; ++i) {
        d->spare[i] = -sign * row[i];
    }
    const block b = first_block(d, d->spare, length);
    if (!finite(b.part)) { /* no limit and no curvature: nothing to gain but rounding */
        d->move[k] = 0;
        return;
    }
    go(d, d->spare, b);
    const pzs_real far = sign * b.part;
    d->v[k] = cut(d->v[k] + far, d->lo[k], d->hi[k]);
    for (uint32_t i = 0; i < d->n; ++i) {
        d->move[i] += far * row[i];
    }
    if (b.input < d->n) {
        drop(d, b.input, 0);
    } else if (to_limit) {
        d->v[k] = sign < 0 ? d->lo[k] : d->hi[k];
    } else {
        d->move[k] = 0;
        if (own_part(d, k) > *d->floor) {
            sweep(d, k);
        }
    }
}

/* Passes from the true gradient to where the tableau sees no violation; returns those used. */
static uint32_t run_passes(const desk *d, pzs_real noise, uint32_t allowed)
{
    const uint32_t most = 2u * d->n + 8u;
    uint32_t used = 0, k = 0;
    int blocked = 1;
    allowed = allowed < most ? allowed : most;
    aim(d);
    for (; blocked && used < allowed; ++used) {
        blocked = descend(d);
    }
    for (; used < allowed && (k = worst_standing(d, noise)) < d->n; ++used) {
        release(d, k);
    }
    return used;
}

/* What a step has to do and what became of it. */
typedef struct search {
    uint32_t allowed, used; /* passes */
    pzs_real wanted;        /* |W e|^2 (m2) */
    pzs_real missed;        /* |W (e - B base)|^2 (m2) */
    pzs_real left;          /* largest violation (m2/V) */
    pzs_real noise;         /* what of it may be rounding */
} search;

/* ---- rounds ------------------------------------------------------------------ */

/* Rounding of a gradient (m2/V): of want, at most that of |B| |W (e - B base)|, and of pull. */
static pzs_real noise_level(const desk *d, pzs_real missed)
{
    for (uint32_t i = 0; i < d->width; ++i) {
        d->spare[i] = size(d->v[i] - d->base[i]);
    }
    return PZS_EPSILON * (root(missed * largest(d->diag, d->width)) + dot(d->diag, d->spare, d->width));
}

/*
 * Whether the round lowered the objective: its change is half of (v - start) . (sum of the gradients at both
 * ends), exactly. A round that went so far that rounding hides the change counts as not having.
 */
static int fell(const desk *d, pzs_real energy)
{
    const pzs_real noise = noise_level(d, 0);
    for (uint32_t i = 0; i < d->width; ++i) {
        d->start[i] = d->v[i] - d->start[i];
        d->start_grad[i] += d->grad[i];
        d->spare[i] = size(d->start[i]);
    }
    return dot(d->start, d->start_grad, d->width) < 0 && noise * sum(d->spare, d->width) < energy;
}

/* One round. Returns the violation after it, or -1 where it was undone. */
static pzs_real run_round(const desk *d, search *s)
{
    const size_t bytes = d->width * sizeof(pzs_real);
    memcpy(d->start, d->v, bytes);
    memcpy(d->start_grad, d->grad, bytes);
    memcpy(d->undo, d->v, bytes);
    s->used += run_passes(d, s->noise / 2, s->allowed - s->used);
    true_gradient(d);
    if (fell(d, s->wanted + s->missed)) {
        return violation(d);
    }
    memcpy(d->v, d->undo, bytes);
    true_gradient(d);
    return -1;
}

/* Rounds from a true gradient until no violation exceeds noise. */
static void optimise(const desk *d, search *s)
{
    int fresh = 0;
    s->left = violation(d);
    s->noise = NOISE * noise_level(d, s->wanted + s->missed);
    for (uint32_t round = 0; round < ROUNDS && s->left > s->noise && s->used < s->allowed; ++round) {
        const pzs_real before = s->left, after = run_round(d, s);
        s->left = after < 0 ? before : after;
        s->noise = NOISE * noise_level(d, s->wanted + s->missed);
        if (s->left > s->noise && s->left * POOR > before && s->used < s->allowed) {
            *d->floor = fresh ? cut(*d->floor * 16, 0, 1024 * (pzs_real)d->n * PZS_EPSILON) : *d->floor;
            rebuild(d);
            fresh = 1;
        }
    }
}

/* ---- step ---------------------------------------------------------------------- */

typedef struct window {
    pzs_real lo, hi;
    uint32_t clash; /* 1 where slew and limit do not meet */
} window;

/* What an input may reach in this step; rounding may narrow the slew window, never widen it. */
static window window_of(pzs_real last, pzs_real slew, pzs_real lower, pzs_real upper)
{
    window w = { last - slew, last + slew, 0 };
    const pzs_real limit = last < lower ? lower : upper;
    w.lo += last - w.lo > slew ? PZS_EPSILON * size(w.lo) : 0;
    w.hi -= w.hi - last > slew ? PZS_EPSILON * size(w.hi) : 0;
    w.lo = w.lo > lower ? w.lo : lower;
    w.hi = w.hi < upper ? w.hi : upper;
    w.clash = w.lo > w.hi;
    w.lo = w.clash ? limit : w.lo;
    w.hi = w.clash ? limit : w.hi;
    return w;
}

/* First input, at the volts before the step, whose slew window does not meet its limits. */
static int32_t first_clash(const desk *d, const pzs_control *c, const pzs_real *last)
{
    for (uint32_t i = 0; i < d->n; ++i) {
        if (window_of(last[i], c->problem->slew[i], c->lower[i], c->upper[i]).clash) {
            return (int32_t)i;
        }
    }
    return -1;
}

/* Limits of this step, and the volts and their gradient cut to them. Returns the first clash, or -1. */
static int32_t enter(const desk *d, const pzs_control *c)
{
    uint32_t clashes = 0, moved = 0;
    memcpy(d->start, d->v, d->width * sizeof(pzs_real));
    for (uint32_t i = 0; i < d->n; ++i) {
        const pzs_real last = d->start[i];
        const window w = window_of(last, c->problem->slew[i], c->lower[i], c->upper[i]);
        d->lo[i] = w.lo;
        d->hi[i] = w.hi;
        d->v[i] = cut(last, w.lo, w.hi);
        clashes += w.clash;
        moved += (uint32_t)(last < w.lo) | (uint32_t)(last > w.hi);
    }
    if (moved != 0) {
        true_gradient(d);
    } else {
        gradient_from_pull(d);
    }
    return clashes != 0 ? first_clash(d, c, d->start) : -1;
}

/* want = B'W^2 (e - B base), and the two energies. */
static void project(const desk *d, const pzs_control *c, const pzs_real *error, search *s)
{
    const uint32_t m = c->problem->outputs;
    const pzs_real *weight = c->problem->weight;
    pzs_real *weighted = c->work + VECTORS * d->width;
    pzs_real wanted = 0, missed = 0;
    for (uint32_t i = 0; i < m; ++i) {
        const pzs_real square = weight[i] * weight[i], miss = error[i] - c->predicted[i];
        weighted[i] = square * miss;
        wanted += square * error[i] * error[i];
        missed += weighted[i] * miss;
    }
    s->wanted = wanted;
    s->missed = missed;
    memset(d->want, 0, d->width * sizeof(pzs_real));
    add_rows(d->want, c->influence, d->n, weighted, m, d->n);
}

/* |W (B v - e)| / |W e| = |W (B base - e) + W B (v - base)| / |W e|. */
static pzs_real shape_error(const desk *d, pzs_real effort, const search *s)
{
    for (uint32_t i = 0; i < d->width; ++i) {
        const pzs_real away = d->v[i] - d->base[i];
        d->spare[i] = away * (d->pull[i] - effort * away - 2 * d->want[i]);
    }
    const pzs_real rest = s->missed + sum(d->spare, d->width);
    return rest > 0 && s->wanted > 0 ? root(rest / s->wanted) : 0;
}

/* Largest |B'W^2 e|. */
static pzs_real most_wanted(const desk *d)
{
    for (uint32_t i = 0; i < d->width; ++i) {
        d->spare[i] = size(d->want[i] + d->full[i]);
    }
    return largest(d->spare, d->width);
}

/* Make the volts the new base: from here on gradients come from the residual e - B v itself. */
static void rebase(const desk *d, const pzs_control *c)
{
    const pzs_real effort = c->problem->effort;
    multiply(c->predicted, c->influence, d->v, c->problem->outputs, d->n);
    for (uint32_t i = 0; i < d->n; ++i) {
        d->full[i] += d->pull[i] - effort * (d->v[i] - d->base[i]);
        d->bias[i] = effort * (d->v[i] - c->problem->prefer[i]);
        d->base[i] = d->v[i];
        d->pull[i] = 0;
    }
}

/*
 * Whether rounding in H (v - base) may cost more than epsilon |W e|^2: the error of a gradient,
 * squared, times the inverse of H on F (for dependent inputs the most it can be).
 */
static int coarse(const desk *d, const search *s)
{
    const pzs_real noise = noise_level(d, 0);
    pzs_real soft = 0;
    for (uint32_t i = 0; i < d->n; ++i) {
        const pzs_real pivot = d->m[(size_t)i * d->width + i], least = *d->floor * d->diag[i];
        if (d->side[i] > 0) {
            soft -= pivot;
        } else if (pivot < least && d->lo[i] < d->hi[i]) {
            soft += 1 / least;
        }
    }
    return noise * noise * soft > PZS_EPSILON * s->wanted;
}

static void note_active(const desk *d, pzs_control *c)
{
    uint32_t active = 0;
    for (uint32_t i = 0; i < d->n; ++i) {
        const uint32_t low = !(d->v[i] > d->lo[i]), high = !(d->v[i] < d->hi[i]);
        c->state[i] = (uint8_t)(low + 2u * (high & ~low));
        active += low | high;
    }
    c->active = (uint16_t)active;
}

static pzs_status finish(pzs_control *c, pzs_status status, int32_t where)
{
    c->where = where;
    return status;
}

static pzs_status ready(const pzs_control *c, const void *argument)
{
    if (c == NULL || argument == NULL) {
        return PZS_E_ARGUMENT;
    }
    return c->stage == READY ? PZS_OK : PZS_E_STAGE;
}

/* Optimise; where far from the base rounding could cost accuracy, from the residual once more. */
static void settle(const desk *d, const pzs_control *c, const pzs_real *error, search *s)
{
    optimise(d, s);
    if (s->used < s->allowed && coarse(d, s)) {
        rebase(d, c);
        project(d, c, error, s);
        gradient_from_pull(d);
        optimise(d, s);
    }
}

/* The step itself, once want and the energies are there. */
static pzs_status step_to(const desk *d, pzs_control *c, const pzs_real *error, search *s)
{
    const pzs_real effort = c->problem->effort;
    const int32_t clash = enter(d, c);
    s->allowed = c->passes_allowed < PZS_STEP_PASSES ? c->passes_allowed : PZS_STEP_PASSES;
    c->error_before = shape_error(d, effort, s);
    settle(d, c, error, s);
    const pzs_real most = most_wanted(d);
    c->error_after = shape_error(d, effort, s);
    c->optimality = s->left > 0 && most > 0 ? s->left / most : 0;
    c->passes = (uint16_t)s->used;
    c->passes_most = c->passes > c->passes_most ? c->passes : c->passes_most;
    note_active(d, c);
    if (s->left > s->noise && s->used >= s->allowed) {
        return finish(c, PZS_W_PASSES, -1);
    }
    return finish(c, clash < 0 ? PZS_OK : PZS_W_SLEW, clash);
}

pzs_status pzs_step(pzs_control *c, const pzs_real *error)
{
    const pzs_status status = ready(c, error);
    if (status != PZS_OK) {
        return status;
    }
    const desk d = desk_of(c);
    search s = { 0, 0, 0, 0, 0, 0 };
    project(&d, c, error, &s);
    if (!finite(s.wanted + s.missed) || guard_nonfinite(d.want, d.n) >= 0) {
        return finish(c, PZS_E_NONFINITE, guard_nonfinite(error, c->problem->outputs));
    }
    return step_to(&d, c, error, &s);
}

/* ---- tick ------------------------------------------------------------------------ */

/*
 * Disturbance of output i from its measurement. Returns nonzero where the sensor is not to be
 * trusted: not finite, or the same bits for FROZEN_TICKS ticks in which the prediction moved
 * (seen as a change of measured - predicted while measured stands still).
 */
static int sense(pzs_control *c, uint32_t i, pzs_real measured)
{
    const pzs_real difference = measured - c->predicted[i];
    if (!finite(difference)) {
        return 1;
    }
    if (measured < c->measured[i] || measured > c->measured[i]) {
        c->measured[i] = measured;
        c->frozen[i] = 0;
    } else if (FROZEN_PART * size(difference - c->disturbance[i]) > size(measured) + size(c->predicted[i])) {
        c->frozen[i] = (uint8_t)(c->frozen[i] + (c->frozen[i] < FROZEN_TICKS));
    }
    if (c->frozen[i] >= FROZEN_TICKS) {
        return 1;
    }
    c->disturbance[i] = difference;
    return 0;
}

/* All disturbances. Returns the number of outputs without a usable measurement, the first in where. */
static uint32_t sense_all(pzs_control *c, const pzs_real *measured, int32_t *where)
{
    uint32_t lost = 0;
    for (uint32_t i = 0; measured != NULL && i < c->problem->outputs; ++i) {
        if (sense(c, i, measured[i])) {
            *where = lost++ == 0 ? (int32_t)i : *where;
        }
    }
    return lost;
}

pzs_status pzs_tick(pzs_control *c, const pzs_real *wanted, const pzs_real *measured)
{
    const pzs_status status = ready(c, wanted);
    if (status != PZS_OK) {
        return status;
    }
    const desk d = desk_of(c);
    const uint32_t m = c->problem->outputs;
    pzs_real *error = c->work + VECTORS * d.width + m;
    int32_t where = -1;
    const uint32_t lost = sense_all(c, measured, &where);
    if (lost == m) {
        return finish(c, PZS_W_HELD, where);
    }
    for (uint32_t i = 0; i < m; ++i) {
        error[i] = wanted[i] - c->disturbance[i];
    }
    const pzs_status stepped = pzs_step(c, error);
    if (stepped == PZS_E_NONFINITE) {
        return finish(c, PZS_W_HELD, c->where);
    }
    rebase(&d, c);
    return stepped == PZS_OK && lost != 0 ? finish(c, PZS_W_SENSOR, where) : stepped;
}

/* ---- init and limits ---------------------------------------------------------------- */

/* First input whose limits hold no finite voltage or whose slew is negative or not a number, or -1. */
static int32_t bad_limit(const pzs_problem *p)
{
    for (uint32_t i = 0; i < p->inputs; ++i) {
        const pzs_real lower = p->lower[i], upper = p->upper[i];
        const int some = lower <= upper && (finite(lower) || finite(upper) || lower < upper);
        if (!some || !(p->slew[i] >= 0)) {
            return (int32_t)i;
        }
    }
    return -1;
}

/* First entry of any table that is not finite, or -1. */
static int32_t bad_number(const pzs_problem *p, const pzs_real *influence)
{
    const uint32_t n = p->inputs, m = p->outputs;
    int32_t bad = guard_nonfinite(influence, m * n);
    bad = bad >= 0 ? bad : guard_nonfinite(p->weight, m);
    bad = bad >= 0 ? bad : guard_nonfinite(p->prefer, n);
    bad = bad >= 0 || p->hessian == NULL ? bad : guard_nonfinite(p->hessian, n * n);
    return bad;
}

static pzs_status check(const pzs_problem *p, const pzs_real *influence, int32_t *where)
{
    const int missing = p->weight == NULL || p->lower == NULL || p->upper == NULL || p->slew == NULL
                        || p->prefer == NULL || influence == NULL;
    *where = -1;
    if (p->format != PZS_TABLE_FORMAT) {
        return PZS_E_FORMAT;
    }
    if (missing || p->inputs == 0 || p->outputs == 0 || !(p->effort >= 0)) {
        return PZS_E_ARGUMENT;
    }
    if (guard_problem_crc(p) != p->crc) {
        return PZS_E_CRC;
    }
    *where = bad_limit(p);
    if (*where >= 0) {
        return PZS_E_LIMITS;
    }
    *where = bad_number(p, influence);
    return *where >= 0 || !finite(p->effort) ? PZS_E_NONFINITE : PZS_OK;
}

/* Point the controller's arrays into the workspace. */
static void lay_out(pzs_control *c, pzs_real *at)
{
    const uint32_t n = c->problem->inputs, m = c->problem->outputs, width = width_of(n);
    c->hessian = at, at += (size_t)n * width;
    c->tableau = at, at += (size_t)n * width;
    c->lower = at, at += width;
    c->upper = at, at += width;
    c->volt = at, at += width;
    c->predicted = at, at += m;
    c->disturbance = at, at += m;
    c->measured = at, at += m;
    c->work = at, at += VECTORS * width + 2u * m;
    c->frozen = (uint8_t *)at;
    c->state = c->frozen + m;
}

/* Row k of H: from the table, or the sum over outputs of W^2 B_ik B_i, kept symmetric to the last bit. */
static void form_row(const pzs_control *c, const pzs_real *table, uint32_t k)
{
    const uint32_t n = c->problem->inputs, m = c->problem->outputs, width = width_of(n);
    const pzs_real *weight = c->problem->weight;
    pzs_real *row = c->hessian + (size_t)k * width, *column = c->work + VECTORS * width;
    if (table != NULL) {
        memcpy(row, table + (size_t)k * n, n * sizeof(pzs_real));
    } else {
        for (uint32_t i = 0; i < m; ++i) {
            column[i] = weight[i] * weight[i] * c->influence[(size_t)i * n + k];
        }
        add_rows(row, c->influence, n, column, m, n);
        for (uint32_t j = 0; j < k; ++j) {
            row[j] = c->hessian[(size_t)j * width + k];
        }
    }
    row[k] += c->problem->effort;
}

/* Fill what a step starts from: volts at prefer inside the limits, all inputs swept that can be. */
static void set_out(const desk *d, const pzs_control *c)
{
    const pzs_problem *p = c->problem;
    for (uint32_t i = 0; i < d->width; ++i) {
        d->side[i] = -1;
    }
    for (uint32_t i = 0; i < d->n; ++i) {
        c->lower[i] = p->lower[i];
        c->upper[i] = p->upper[i];
        d->v[i] = cut(p->prefer[i], p->lower[i], p->upper[i]);
        d->diag[i] = d->h[(size_t)i * d->width + i];
        d->side[i] = 1;
    }
    true_gradient(d); /* pull = H v, from the base zero */
    rebase(d, c);
    rebuild(d);
}

pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem, const pzs_real *influence,
                            void *work, size_t bytes)
{
    if (control == NULL || problem == NULL || work == NULL) {
        return PZS_E_ARGUMENT;
    }
    const pzs_real *use = influence != NULL ? influence : problem->influence;
    const size_t need = PZS_CONTROL_BYTES(problem->inputs, problem->outputs);
    pzs_control c = { .problem = problem, .influence = use, .where = -1, .stage = READY };
    const pzs_status status = check(problem, use, &c.where);
    if (status != PZS_OK) {
        return finish(control, status, c.where);
    }
    if (bytes < need || (uintptr_t)work % sizeof(pzs_real) != 0) {
        return finish(control, PZS_E_WORKSPACE, (int32_t)need);
    }
    memset(work, 0, need);
    lay_out(&c, work);
    for (uint32_t k = 0; k < problem->inputs; ++k) {
        form_row(&c, influence == NULL ? problem->hessian : NULL, k);
    }
    c.dependence = 4 * (pzs_real)problem->inputs * PZS_EPSILON;
    const desk d = desk_of(&c);
    const int32_t overflow = guard_nonfinite(c.hessian, d.n * d.width);
    if (overflow >= 0) {
        return finish(control, PZS_E_NONFINITE, overflow);
    }
    set_out(&d, &c);
    c.passes_allowed = PZS_STEP_PASSES;
    *control = c;
    return PZS_OK;
}

pzs_status pzs_hold(pzs_control *c, uint16_t input, pzs_real volt)
{
    const pzs_status status = ready(c, c);
    if (status != PZS_OK) {
        return status;
    }
    const pzs_problem *p = c->problem;
    if (input >= p->inputs) {
        return finish(c, PZS_E_ARGUMENT, input);
    }
    if (!finite(volt)) {
        return finish(c, PZS_E_NONFINITE, input);
    }
    c->lower[input] = c->upper[input] = cut(volt, p->lower[input], p->upper[input]);
    return finish(c, PZS_OK, -1);
}

pzs_status pzs_release(pzs_control *c, uint16_t input)
{
    const pzs_status status = ready(c, c);
    if (status != PZS_OK) {
        return status;
    }
    if (input >= c->problem->inputs) {
        return finish(c, PZS_E_ARGUMENT, input);
    }
    c->lower[input] = c->problem->lower[input];
    c->upper[input] = c->problem->upper[input];
    return finish(c, PZS_OK, -1);
}

/* ---- for comparison -------------------------------------------------------------------- */

/* The optimum without limits into d->v; needs want, uses up side and the tableau. */
static void solve_free(const desk *d)
{
    memset(d->v, 0, d->width * sizeof(pzs_real));
    for (uint32_t i = 0; i < d->n; ++i) {
        d->side[i] = 1;
    }
    rebuild(d);
    for (uint32_t round = 0; round < 3u; ++round) {
        true_gradient(d);
        aim(d);
        for (uint32_t i = 0; i < d->n; ++i) {
            d->v[i] += d->side[i] > 0 ? d->move[i] : 0;
        }
    }
}

pzs_status pzs_unlimited(pzs_control *c, const pzs_real *error, pzs_real *volt)
{
    const pzs_status status = volt != NULL ? ready(c, error) : PZS_E_ARGUMENT;
    if (status != PZS_OK) {
        return status;
    }
    const desk d = desk_of(c);
    const size_t bytes = d.width * sizeof(pzs_real);
    search s = { 0, 0, 0, 0, 0, 0 };
    project(&d, c, error, &s);
    desk free = d; /* its volts and pull apart from the controller's */
    free.v = d.start;
    free.pull = d.start_grad;
    memcpy(d.hi, d.side, bytes);
    solve_free(&free);
    memcpy(d.side, d.hi, bytes);
    rebuild(&d);
    if (guard_nonfinite(free.v, d.n) >= 0) {
        return finish(c, PZS_E_NONFINITE, guard_nonfinite(error, c->problem->outputs));
    }
    memcpy(volt, free.v, d.n * sizeof(pzs_real));
    return finish(c, PZS_OK, -1);
}

pzs_status pzs_clipped(pzs_control *c, const pzs_real *error, pzs_real *volt)
{
    const pzs_status status = pzs_unlimited(c, error, volt);
    for (uint32_t i = 0; status == PZS_OK && i < c->problem->inputs; ++i) {
        volt[i] = cut(volt[i], c->lower[i], c->upper[i]);
    }
    return status;
}
