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
#include "control.h"
#include "guard.h"
#include "product.h"
#include "sense.h"

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

/* ---- step ---------------------------------------------------------------------- */

/*
 * What inputs may reach in this step; rounding may narrow a slew window, never widen it. Returns how many volts
 * stand outside.
 */
static uint32_t open_windows(pzs_real *restrict lo, pzs_real *restrict hi, const pzs_real *restrict v,
                             const pzs_real *restrict slew, const pzs_real *restrict lower,
                             const pzs_real *restrict upper, size_t width)
{
    uint32_t outside = 0;
    for (size_t i = 0; i < width; i++) {
        const pzs_real last = v[i], most = slew[i], down = last - most, up = last + most;
        const pzs_real from = last - down > most ? down + PZS_EPSILON * boxls_size(down) : down;
        const pzs_real to = up - last > most ? up - PZS_EPSILON * boxls_size(up) : up;
        const pzs_real low = from > lower[i] ? from : lower[i], high = to < upper[i] ? to : upper[i];
        outside += (last < low ? 1u : 0u) + (last > high ? 1u : 0u);
        lo[i] = low;
        hi[i] = high;
    }
    return outside;
}

/* Cut the volts to their windows; where slew and limit do not meet, to the limit. Returns the first such input, or -1. */
static int32_t cut_volts(boxls *b, const pzs_control *c)
{
    int32_t clash = -1;
    for (uint32_t i = 0; i < b->n; i++) {
        if (b->lo[i] > b->hi[i]) {
            b->lo[i] = b->hi[i] = b->v[i] < c->lower[i] ? c->lower[i] : c->upper[i];
            clash = clash < 0 ? (int32_t)i : clash;
        }
        b->v[i] = boxls_cut(b->v[i], b->lo[i], b->hi[i]);
    }
    return clash;
}

/* Start a step: windows, volts cut to them, their gradient. Returns the first clash of slew and limit, or -1. */
static int32_t enter(boxls *b, const pzs_control *c)
{
    const size_t width = boxls_whole(b->width);
    int32_t clash = -1;
    if (open_windows(b->lo, b->hi, b->v, slew_of(c), c->lower, c->upper, width) != 0) {
        clash = cut_volts(b, c);
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

/*
 * want = B'W^2 (e - B base) with shown = B base + disturbance; returns missed = |W (e - B base)|^2. With
 * full = B'W^2 B base, energy = |W e|^2 = missed + base . (full + 2 want), not below what rounding leaves of it.
 * Both are finite only where want is.
 */
static pzs_real project(boxls *b, const pzs_control *c, const pzs_real *wanted, const pzs_real *shown)
{
    const uint32_t m = c->problem->outputs;
    pzs_real *weighted = weighted_of(c), *miss = weighted + m;
    weigh(weighted, miss, c->problem->weight, wanted, shown, m);
    boxls_sum_rows(b->want, c->influence, b->n, weighted, m, b->n);
    const pzs_real missed = boxls_dot(weighted, miss, m);
    b->energy = missed + boxls_dot(b->base, full_of(c), b->width) + 2 * boxls_dot(b->base, b->want, b->width);
    b->energy = b->energy < PZS_EPSILON * missed ? PZS_EPSILON * missed : b->energy;
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
    pzs_real rest = missed;
    if (b->rough > 0) { /* off the base */
        shape_terms(b->spare, b->move, b->v, b->base, b->pull, b->want, effort, boxls_whole(b->width));
        rest += boxls_dot(b->spare, b->move, b->width);
    }
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
    sum_size(b->spare, b->want, full, boxls_whole(b->width));
    return boxls_largest(b->spare, b->width);
}

/* Make the volts the new base, predicted their shape. */
static void rebase(boxls *b, const pzs_control *c)
{
    const pzs_real effort = c->problem->effort;
    pzs_real *full = full_of(c);
    product(c->predicted, c->influence, b->v, c->problem->outputs, b->n);
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
    return c->stage == CONTROL_READY ? PZS_OK : PZS_E_STAGE;
}

/* What measurements should show: predicted + disturbance. */
static const pzs_real *expected(const pzs_control *c)
{
    const uint32_t m = c->problem->outputs;
    pzs_real *sum = weighted_of(c) + 2u * m;
    for (uint32_t i = 0; i < m; i++)
        sum[i] = c->predicted[i] + c->disturbance[i];
    return sum;
}

/* Optimise; where far from the base rounding could cost accuracy, once more from the residual. Returns missed. */
static pzs_real settle(boxls *b, const pzs_control *c, const pzs_real *wanted, const pzs_real *shown, pzs_real missed)
{
    boxls_optimise(b);
    if (boxls_coarse(b)) {
        rebase(b, c);
        missed = project(b, c, wanted, shown == c->predicted ? shown : expected(c));
        boxls_gradient(b);
        boxls_optimise(b);
    }
    return missed;
}

/* The step itself, once want, missed and energy are there. */
static pzs_status step_to(boxls *b, pzs_control *c, const pzs_real *wanted, const pzs_real *shown, pzs_real missed)
{
    const pzs_real effort = c->problem->effort;
    const int32_t clash = enter(b, c);
    b->allowed = c->passes_allowed < PZS_STEP_PASSES ? c->passes_allowed : PZS_STEP_PASSES;
    b->exact = PZS_EPSILON * PZS_SQRT(b->energy + missed) * c->stiffest;
    c->error_before = shape_error(b, effort, missed);
    missed = settle(b, c, wanted, shown, missed);
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
static pzs_status step(boxls *b, pzs_control *c, const pzs_real *wanted, const pzs_real *shown)
{
    const pzs_real missed = project(b, c, wanted, shown);
    if (!boxls_finite(b->energy + missed))
        return finish(c, PZS_E_NONFINITE, guard_nonfinite(wanted, c->problem->outputs));
    return step_to(b, c, wanted, shown, missed);
}

pzs_status pzs_step(pzs_control *c, const pzs_real *error)
{
    const pzs_status status = ready(c, error);
    if (status != PZS_OK)
        return status;
    boxls b = view(c);
    return step(&b, c, error, c->predicted);
}

/* ---- tick ------------------------------------------------------------------------ */

/* predicted = B volt again, where volts have changed since. */
static void catch_up(boxls *b, const pzs_control *c)
{
    uint32_t i = 0;
    while (i < b->n && !(b->v[i] != b->base[i]))
        i++;
    if (i < b->n)
        rebase(b, c);
}

void control_predict(pzs_control *c)
{
    boxls b = view(c);
    catch_up(&b, c);
}

void control_moved(pzs_control *c)
{
    boxls b = view(c);
    boxls_true_gradient(&b);
    c->rounding = b.rough;
}

/* Volts as they were, but inside the limits now in force. */
static pzs_status hold_last(boxls *b, pzs_control *c, int32_t where)
{
    enter(b, c);
    catch_up(b, c);
    return finish(c, PZS_W_HELD, where);
}

pzs_status pzs_tick(pzs_control *c, const pzs_real *wanted, const pzs_real *measured)
{
    const pzs_status status = ready(c, wanted);
    if (status != PZS_OK)
        return status;
    boxls b = view(c);
    const uint32_t m = c->problem->outputs;
    int32_t where = -1;
    catch_up(&b, c);
    const senses all = { m, c->predicted, c->measured, c->disturbance, c->frozen };
    const uint32_t lost = measured != NULL ? sense(&all, measured, &where) : 0;
    if (lost == m)
        return hold_last(&b, c, where);
    const pzs_status stepped = step(&b, c, wanted, measured != NULL && lost == 0 ? measured : expected(c));
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
        boxls_sum_rows(row, c->influence, n, column, m, n);
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
    c->stiffest = PZS_SQRT(boxls_largest(b->diag, b->width));
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
    pzs_control c = { .problem = problem, .influence = use, .where = -1, .stage = CONTROL_READY };
    const pzs_status status = check(problem, use, &c.where);
    if (status != PZS_OK)
        return finish(control, status, c.where);
    const int32_t lacking = guard_short(work, bytes, need);
    if (lacking >= 0)
        return finish(control, PZS_E_WORKSPACE, lacking);
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

pzs_status pzs_control_start(pzs_control *c, const pzs_real *volt)
{
    const pzs_status status = ready(c, volt);
    if (status != PZS_OK)
        return status;
    const int32_t bad = guard_nonfinite(volt, c->problem->inputs);
    if (bad >= 0)
        return finish(c, PZS_E_NONFINITE, bad);
    for (uint32_t i = 0; i < c->problem->inputs; i++)
        c->volt[i] = boxls_cut(volt[i], c->lower[i], c->upper[i]);
    control_moved(c);
    control_predict(c);
    return finish(c, PZS_OK, -1);
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
    (void)project(&b, c, error, c->predicted);
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
