/*
 * Control: a target shape to voltages inside hard limits, in bounded time.
 *
 *   min |W (B v - e)|^2 + effort |v - prefer|^2,   lower <= v <= upper, |v - v_last| <= slew
 *
 * With H = B'W^2 B + effort I, half the gradient at v is
 *
 *   H (v - base) + effort (base - prefer) - B'W^2 (e - B base)
 *
 * for any base. Near the base it is as exact as the residual e - B base itself. A tick predicts B v
 * after each step, which makes v the next base for free; a lone step renews its base where
 * rounding would show.
 */
#include <string.h>
#include "boxls.h"
#include "guard.h"
#include "unrolled.h"

#define READY 1u
#define PART 12u         /* inputs multiplied together: what the registers hold */
#define FROZEN_TICKS 8u  /* a measurement that repeats so often while its output moves is frozen */
#define FROZEN_PART 64   /* "moves": by more than 1/FROZEN_PART of |measured| + |predicted| in a tick */

static uint32_t width_of(uint32_t n)
{
    return (uint32_t)PZS_CONTROL_WIDTH(n);
}

/* The optimiser's view of a controller. */
static boxls view(pzs_control *c)
{
    boxls b = { .n = c->problem->inputs, .width = width_of(c->problem->inputs), .h = c->hessian, .m = c->tableau,
                .v = c->volt, .floor = c->dependence, .rough = c->rounding, .soft = c->softness };
    boxls_place(&b, c->work);
    return b;
}

/* Behind the optimiser's vectors: the padded slew, B'W^2 B base, and two vectors of outputs. */
static pzs_real *slew_of(const pzs_control *c)
{
    return c->work + BOXLS_VECTORS * width_of(c->problem->inputs);
}

static pzs_real *full_of(const pzs_control *c)
{
    return slew_of(c) + width_of(c->problem->inputs);
}

static pzs_real *weighted_of(const pzs_control *c)
{
    return full_of(c) + width_of(c->problem->inputs);
}

/* y_i += PART entries of row i times x, the x held in registers. */
static void multiply_part(pzs_real *restrict y, const pzs_real *restrict a, size_t stride, const pzs_real *restrict x,
                          size_t rows)
{
    pzs_real part[PART];
    UNROLLED
    for (unsigned k = 0; k < PART; k++)
        part[k] = x[k];
    for (size_t i = 0; i < rows; i++, a += stride) {
        pzs_real sum = y[i];
        UNROLLED
        for (unsigned k = 0; k < PART; k++)
            sum += a[k] * part[k];
        y[i] = sum;
    }
}

/* y [rows] = a x, a [rows][cols]; each sum in ascending order. */
static void multiply(pzs_real *restrict y, const pzs_real *restrict a, const pzs_real *restrict x, size_t rows, size_t cols)
{
    size_t j = 0;
    memset(y, 0, rows * sizeof *y);
    for (; j + PART <= cols; j += PART)
        multiply_part(y, a + j, cols, x + j, rows);
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = j; k < cols; k++)
            y[i] += a[i * cols + k] * x[k];
    }
}

/* ---- step ---------------------------------------------------------------------- */

typedef struct window {
    pzs_real lo, hi;
    uint32_t clash; /* 1 where slew and limit do not meet */
} window;

/* What an input may reach in this step; rounding may narrow the slew window, never widen it. */
static inline window window_of(pzs_real last, pzs_real slew, pzs_real lower, pzs_real upper)
{
    const pzs_real limit = last < lower ? lower : upper;
    pzs_real lo = last - slew, hi = last + slew;
    lo += last - lo > slew ? PZS_EPSILON * boxls_size(lo) : 0;
    hi -= hi - last > slew ? PZS_EPSILON * boxls_size(hi) : 0;
    lo = lo > lower ? lo : lower;
    hi = hi < upper ? hi : upper;
    const window w = { lo > hi ? limit : lo, lo > hi ? limit : hi, lo > hi };
    return w;
}

/* First input, at the volts before the step, whose slew window does not meet its limits. */
static int32_t first_clash(const pzs_control *c, const pzs_real *last)
{
    for (uint32_t i = 0; i < c->problem->inputs; i++) {
        if (window_of(last[i], c->problem->slew[i], c->lower[i], c->upper[i]).clash)
            return (int32_t)i;
    }
    return -1;
}

/* Limits of this step, lo and hi. Returns how many volts stand outside. */
static uint32_t open_windows(pzs_real *restrict lo, pzs_real *restrict hi, const pzs_real *restrict v,
                             const pzs_real *restrict slew, const pzs_real *restrict lower,
                             const pzs_real *restrict upper, size_t width)
{
    uint32_t outside = 0;
    for (size_t i = 0; i < width; i++) {
        const window w = window_of(v[i], slew[i], lower[i], upper[i]);
        outside += (v[i] < w.lo ? 1u : 0u) + (v[i] > w.hi ? 1u : 0u);
        lo[i] = w.lo;
        hi[i] = w.hi;
    }
    return outside;
}

/* Start a step: windows, volts cut to them, their gradient. Returns the first clash of slew and limit, or -1. */
static int32_t enter(boxls *b, const pzs_control *c)
{
    const size_t width = b->width & ~(PZS_TILE - 1u);
    int32_t clash = -1;
    if (open_windows(b->lo, b->hi, b->v, slew_of(c), c->lower, c->upper, width) != 0) {
        clash = first_clash(c, b->v);
        for (uint32_t i = 0; i < b->n; i++)
            b->v[i] = boxls_cut(b->v[i], b->lo[i], b->hi[i]);
        boxls_true_gradient(b);
    } else {
        boxls_gradient(b);
    }
    return clash;
}

/* miss = e - y, weighted = w^2 miss. */
static void weigh(pzs_real *restrict weighted, pzs_real *restrict miss, const pzs_real *restrict w,
                  const pzs_real *restrict e, const pzs_real *restrict y, size_t m)
{
    for (size_t i = 0; i < m; i++) {
        miss[i] = e[i] - y[i];
        weighted[i] = w[i] * w[i] * miss[i];
    }
}

/* sum = x + 2 y */
static void add_twice(pzs_real *restrict sum, const pzs_real *restrict x, const pzs_real *restrict y, size_t width)
{
    for (size_t i = 0; i < width; i++)
        sum[i] = x[i] + 2 * y[i];
}

/*
 * want = B'W^2 (e - B base); returns missed = |W (e - B base)|^2. With full = B'W^2 B base,
 * energy = |W e|^2 = missed + base . (full + 2 want), not below what rounding leaves of it.
 */
static pzs_real project(boxls *b, const pzs_control *c, const pzs_real *error)
{
    const uint32_t m = c->problem->outputs;
    pzs_real *weighted = weighted_of(c), *miss = weighted + m;
    weigh(weighted, miss, c->problem->weight, error, c->predicted, m);
    memset(b->want, 0, b->width * sizeof(pzs_real));
    boxls_add_rows(b->want, c->influence, b->n, weighted, m, b->n);
    add_twice(b->spare, full_of(c), b->want, b->width & ~(PZS_TILE - 1u));
    const pzs_real missed = boxls_dot(weighted, miss, m), energy = missed + boxls_dot(b->base, b->spare, b->n);
    b->energy = energy > PZS_EPSILON * missed ? energy : PZS_EPSILON * missed;
    return missed;
}

/* away = v - base, slope = pull - effort away - 2 want. */
static void shape_terms(pzs_real *restrict away, pzs_real *restrict slope, const pzs_real *restrict v,
                        const pzs_real *restrict base, const pzs_real *restrict pull, const pzs_real *restrict want,
                        pzs_real effort, size_t width)
{
    for (size_t i = 0; i < width; i++) {
        away[i] = v[i] - base[i];
        slope[i] = pull[i] - effort * away[i] - 2 * want[i];
    }
}

/* |W (B v - e)| / |W e|, where B v - e = (B base - e) + B (v - base). */
static pzs_real shape_error(const boxls *b, pzs_real effort, pzs_real missed)
{
    shape_terms(b->spare, b->next, b->v, b->base, b->pull, b->want, effort, b->width & ~(PZS_TILE - 1u));
    const pzs_real rest = missed + boxls_dot(b->spare, b->next, b->n);
    return rest > 0 && b->energy > 0 ? PZS_SQRT(rest / b->energy) : 0;
}

static void sum_size(pzs_real *restrict z, const pzs_real *restrict x, const pzs_real *restrict y, size_t width)
{
    for (size_t i = 0; i < width; i++)
        z[i] = boxls_size(x[i] + y[i]);
}

/* Largest |B'W^2 e|. */
static pzs_real most_wanted(const boxls *b, const pzs_real *full)
{
    sum_size(b->spare, b->want, full, b->width & ~(PZS_TILE - 1u));
    return boxls_largest(b->spare, b->width);
}

/* Make the volts the new base, predicted their shape. */
static void rebase(boxls *b, const pzs_control *c)
{
    const pzs_real effort = c->problem->effort;
    pzs_real *full = full_of(c);
    multiply(c->predicted, c->influence, b->v, c->problem->outputs, b->n);
    for (uint32_t i = 0; i < b->n; i++) {
        full[i] += b->pull[i] - effort * (b->v[i] - b->base[i]);
        b->bias[i] = effort * (b->v[i] - c->problem->prefer[i]);
        b->base[i] = b->v[i];
        b->pull[i] = 0;
    }
    b->rough = 0;
}

/* state: 1 at the lower limit, 2 at the upper, else 0. Returns how many are at one. */
static uint32_t note_active(uint8_t *restrict state, const pzs_real *restrict v, const pzs_real *restrict lo,
                            const pzs_real *restrict hi, size_t n)
{
    uint32_t active = 0;
    for (size_t i = 0; i < n; i++) {
        const uint8_t at = v[i] > lo[i] ? (v[i] < hi[i] ? 0 : 2) : 1;
        state[i] = at;
        active += at != 0;
    }
    return active;
}

static pzs_status finish(pzs_control *c, pzs_status status, int32_t where)
{
    c->where = where;
    return status;
}

static pzs_status ready(const pzs_control *c, const void *argument)
{
    if (c == NULL || argument == NULL)
        return PZS_E_ARGUMENT;
    return c->stage == READY ? PZS_OK : PZS_E_STAGE;
}

/* Optimise; where far from the base rounding could cost accuracy, once more from the residual. Returns missed. */
static pzs_real settle(boxls *b, const pzs_control *c, const pzs_real *error, pzs_real missed)
{
    boxls_optimise(b);
    if (boxls_coarse(b)) {
        rebase(b, c);
        missed = project(b, c, error);
        boxls_gradient(b);
        boxls_optimise(b);
    }
    return missed;
}

/* The step itself, once want, missed and energy are there. */
static pzs_status step_to(boxls *b, pzs_control *c, const pzs_real *error, pzs_real missed)
{
    const pzs_real effort = c->problem->effort;
    const int32_t clash = enter(b, c);
    b->allowed = c->passes_allowed < PZS_STEP_PASSES ? c->passes_allowed : PZS_STEP_PASSES;
    b->exact = PZS_EPSILON * PZS_SQRT(b->energy + missed) * PZS_SQRT(c->stiffest);
    c->error_before = shape_error(b, effort, missed);
    missed = settle(b, c, error, missed);
    const pzs_real most = most_wanted(b, full_of(c));
    c->error_after = shape_error(b, effort, missed);
    c->optimality = b->left > 0 && most > 0 ? b->left / most : 0;
    c->dependence = b->floor;
    c->rounding = b->rough;
    c->softness = b->soft;
    c->passes = (uint16_t)b->used;
    c->passes_most = c->passes > c->passes_most ? c->passes : c->passes_most;
    c->active = (uint16_t)note_active(c->state, b->v, b->lo, b->hi, b->n);
    if (!b->done)
        return finish(c, PZS_W_PASSES, -1);
    return finish(c, clash < 0 ? PZS_OK : PZS_W_SLEW, clash);
}

/* The step, on a view that the caller keeps. */
static pzs_status step(boxls *b, pzs_control *c, const pzs_real *error)
{
    const pzs_real missed = project(b, c, error);
    if (!boxls_finite(b->energy + missed) || guard_nonfinite(b->want, b->n) >= 0)
        return finish(c, PZS_E_NONFINITE, guard_nonfinite(error, c->problem->outputs));
    return step_to(b, c, error, missed);
}

pzs_status pzs_step(pzs_control *c, const pzs_real *error)
{
    const pzs_status status = ready(c, error);
    if (status != PZS_OK)
        return status;
    boxls b = view(c);
    return step(&b, c, error);
}

/* ---- tick ------------------------------------------------------------------------ */

/* predicted = B volt again, after a pzs_step or a cut. */
static void catch_up(boxls *b, const pzs_control *c)
{
    uint32_t moved = 0;
    for (uint32_t i = 0; i < b->n; i++)
        moved += b->v[i] < b->base[i] || b->v[i] > b->base[i];
    if (moved != 0)
        rebase(b, c);
}

/* Volts as they were, but inside the limits now in force. */
static pzs_status hold_last(boxls *b, pzs_control *c, int32_t where)
{
    enter(b, c);
    catch_up(b, c);
    return finish(c, PZS_W_HELD, where);
}

/*
 * A measurement that is not finite, or has the same bits as before. Returns nonzero where the sensor is not to be
 * trusted: not finite, or the same bits for FROZEN_TICKS ticks in which the prediction moved
 * (seen as a change of measured - predicted while measured stands still). An output moves when it does so
 * by more than 1/FROZEN_PART of `most`, the largest prediction of any: below that lies the resolution of sensors.
 */
static int doubtful(pzs_control *c, uint32_t i, pzs_real measured, pzs_real difference, pzs_real most)
{
    if (!boxls_finite(difference))
        return 1;
    if (FROZEN_PART * boxls_size(difference - c->disturbance[i]) > boxls_size(measured) + most)
        c->frozen[i] = (uint8_t)(c->frozen[i] + (c->frozen[i] < FROZEN_TICKS));
    if (c->frozen[i] >= FROZEN_TICKS)
        return 1;
    c->disturbance[i] = difference;
    return 0;
}

static pzs_real largest_size(const pzs_real *x, uint32_t n)
{
    pzs_real most = 0;
    for (uint32_t i = 0; i < n; i++)
        most = boxls_size(x[i]) > most ? boxls_size(x[i]) : most;
    return most;
}

/* All disturbances. Returns the number of outputs without a usable measurement, the first in where. */
static uint32_t sense(pzs_control *c, const pzs_real *measured, int32_t *where)
{
    const uint32_t m = c->problem->outputs;
    pzs_real most = -1; /* found when first asked for */
    uint32_t lost = 0;
    for (uint32_t i = 0; i < m; i++) {
        const pzs_real difference = measured[i] - c->predicted[i];
        const int changed = measured[i] < c->measured[i] || measured[i] > c->measured[i];
        if (changed && boxls_finite(difference)) {
            c->measured[i] = measured[i];
            c->disturbance[i] = difference;
            c->frozen[i] = 0;
            continue;
        }
        most = most < 0 ? largest_size(c->predicted, m) : most;
        if (doubtful(c, i, measured[i], difference, most))
            *where = lost++ == 0 ? (int32_t)i : *where;
    }
    return lost;
}

pzs_status pzs_tick(pzs_control *c, const pzs_real *wanted, const pzs_real *measured)
{
    const pzs_status status = ready(c, wanted);
    if (status != PZS_OK)
        return status;
    boxls b = view(c);
    const uint32_t m = c->problem->outputs;
    pzs_real *error = weighted_of(c) + 2u * m;
    int32_t where = -1;
    catch_up(&b, c);
    const uint32_t lost = measured != NULL ? sense(c, measured, &where) : 0;
    if (lost == m)
        return hold_last(&b, c, where);
    for (uint32_t i = 0; i < m; i++)
        error[i] = wanted[i] - c->disturbance[i];
    const pzs_status stepped = step(&b, c, error);
    if (stepped == PZS_E_NONFINITE)
        return hold_last(&b, c, c->where);
    rebase(&b, c);
    c->rounding = 0;
    return stepped == PZS_OK && lost != 0 ? finish(c, PZS_W_SENSOR, where) : stepped;
}

/* ---- init and limits ---------------------------------------------------------------- */

/* First input whose limits hold no finite voltage or whose slew is negative or not a number, or -1. */
static int32_t bad_limit(const pzs_problem *p)
{
    for (uint32_t i = 0; i < p->inputs; i++) {
        const pzs_real lower = p->lower[i], upper = p->upper[i];
        const int some = lower <= upper && (boxls_finite(lower) || boxls_finite(upper) || lower < upper);
        if (!some || !(p->slew[i] >= 0))
            return (int32_t)i;
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
    if (p->format != PZS_TABLE_FORMAT)
        return PZS_E_FORMAT;
    if (missing || p->inputs == 0 || p->inputs > PZS_MOST_INPUTS || p->outputs == 0 || !(p->effort >= 0))
        return PZS_E_ARGUMENT;
    if (guard_problem_crc(p) != p->crc)
        return PZS_E_CRC;
    *where = bad_limit(p);
    if (*where >= 0)
        return PZS_E_LIMITS;
    *where = bad_number(p, influence);
    return *where >= 0 || !boxls_finite(p->effort) ? PZS_E_NONFINITE : PZS_OK;
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
    c->work = at, at += (BOXLS_VECTORS + 2u) * width + 3u * m;
    c->frozen = (uint8_t *)at;
    c->state = c->frozen + m;
}

/* Row k of H: from the table, or the sum over outputs of W^2 B_ik B_i, kept symmetric to the last bit. */
static void form_row(const pzs_control *c, const pzs_real *table, uint32_t k)
{
    const uint32_t n = c->problem->inputs, m = c->problem->outputs, width = width_of(n);
    const pzs_real *weight = c->problem->weight;
    pzs_real *row = c->hessian + (size_t)k * width, *column = weighted_of(c);
    if (table != NULL) {
        memcpy(row, table + (size_t)k * n, n * sizeof(pzs_real));
    } else {
        for (uint32_t i = 0; i < m; i++)
            column[i] = weight[i] * weight[i] * c->influence[(size_t)i * n + k];
        boxls_add_rows(row, c->influence, n, column, m, n);
        for (uint32_t j = 0; j < k; j++)
            row[j] = c->hessian[(size_t)j * width + k];
    }
    row[k] += c->problem->effort;
}

/* Fill what a step starts from: volts at prefer inside the limits, all inputs swept that can be. */
static void set_out(boxls *b, pzs_control *c)
{
    const pzs_problem *p = c->problem;
    for (uint32_t i = 0; i < b->n; i++) {
        c->lower[i] = p->lower[i];
        c->upper[i] = p->upper[i];
        slew_of(c)[i] = p->slew[i];
        b->v[i] = boxls_cut(p->prefer[i], p->lower[i], p->upper[i]);
        b->diag[i] = b->h[(size_t)i * b->width + i];
        b->free[i] = 1;
    }
    c->stiffest = boxls_largest(b->diag, b->width);
    b->floor = c->dependence = 4 * (pzs_real)b->n * PZS_EPSILON;
    boxls_true_gradient(b); /* pull = H v, from the base zero */
    rebase(b, c);
    boxls_rebuild(b);
}

pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem, const pzs_real *influence,
                            void *work, size_t bytes)
{
    if (control == NULL || problem == NULL || work == NULL)
        return PZS_E_ARGUMENT;
    control->stage = 0;
    const pzs_real *use = influence != NULL ? influence : problem->influence;
    const size_t need = PZS_CONTROL_BYTES(problem->inputs, problem->outputs);
    pzs_control c = { .problem = problem, .influence = use, .where = -1, .stage = READY };
    const pzs_status status = check(problem, use, &c.where);
    if (status != PZS_OK)
        return finish(control, status, c.where);
    if (bytes < need || (uintptr_t)work % sizeof(pzs_real) != 0)
        return finish(control, PZS_E_WORKSPACE, (int32_t)need);
    memset(work, 0, need);
    lay_out(&c, work);
    for (uint32_t k = 0; k < problem->inputs; k++)
        form_row(&c, influence == NULL ? problem->hessian : NULL, k);
    boxls b = view(&c);
    const int32_t overflow = guard_nonfinite(c.hessian, b.n * b.width);
    if (overflow >= 0)
        return finish(control, PZS_E_NONFINITE, overflow);
    set_out(&b, &c);
    c.passes_allowed = PZS_STEP_PASSES;
    *control = c;
    return PZS_OK;
}

pzs_status pzs_hold(pzs_control *c, uint16_t input, pzs_real volt)
{
    const pzs_status status = ready(c, c);
    if (status != PZS_OK)
        return status;
    const pzs_problem *p = c->problem;
    if (input >= p->inputs)
        return finish(c, PZS_E_ARGUMENT, input);
    if (!boxls_finite(volt))
        return finish(c, PZS_E_NONFINITE, input);
    c->lower[input] = c->upper[input] = boxls_cut(volt, p->lower[input], p->upper[input]);
    return finish(c, PZS_OK, -1);
}

pzs_status pzs_release(pzs_control *c, uint16_t input)
{
    const pzs_status status = ready(c, c);
    if (status != PZS_OK)
        return status;
    if (input >= c->problem->inputs)
        return finish(c, PZS_E_ARGUMENT, input);
    c->lower[input] = c->problem->lower[input];
    c->upper[input] = c->problem->upper[input];
    return finish(c, PZS_OK, -1);
}

/* ---- for comparison -------------------------------------------------------------------- */

/* The optimum without limits into b->v; needs want, uses up free and the tableau. Dependent inputs stay at 0 V. */
static void solve_free(boxls *b)
{
    memset(b->v, 0, b->width * sizeof(pzs_real));
    for (uint32_t i = 0; i < b->n; i++)
        b->free[i] = 1;
    boxls_rebuild(b);
    for (uint32_t round = 0; round < 3u; round++) {
        boxls_true_gradient(b);
        (void)boxls_aim(b, 0);
        for (uint32_t i = 0; i < b->n; i++)
            b->v[i] += b->free[i] > 0 ? b->move[i] : 0;
    }
}

pzs_status pzs_unlimited(pzs_control *c, const pzs_real *error, pzs_real *volt)
{
    const pzs_status status = volt != NULL ? ready(c, error) : PZS_E_ARGUMENT;
    if (status != PZS_OK)
        return status;
    boxls b = view(c);
    const size_t bytes = b.width * sizeof(pzs_real);
    (void)project(&b, c, error);
    memcpy(b.hi, b.free, bytes);
    boxls apart = b; /* its volts and pull apart from the controller's */
    apart.v = b.start;
    apart.pull = b.start_grad;
    solve_free(&apart);
    memcpy(b.free, b.hi, bytes);
    boxls_rebuild(&b);
    c->softness = 0;
    if (guard_nonfinite(apart.v, b.n) >= 0)
        return finish(c, PZS_E_NONFINITE, guard_nonfinite(error, c->problem->outputs));
    memcpy(volt, apart.v, b.n * sizeof(pzs_real));
    return finish(c, PZS_OK, -1);
}

pzs_status pzs_clipped(pzs_control *c, const pzs_real *error, pzs_real *volt)
{
    const pzs_status status = pzs_unlimited(c, error, volt);
    for (uint32_t i = 0; status == PZS_OK && i < c->problem->inputs; i++)
        volt[i] = boxls_cut(volt[i], c->lower[i], c->upper[i]);
    return status;
}
