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
#include "boxls_tableau.h"
#include "control.h"
#include "guard.h"
#include "product.h"
#include "sense.h"

#define SMALLEST_SQUARE PZS_BY_BITS(1e-31f, 1e-292) /* m2: below, squares lose digits to underflow */

/* What is behind the volts (ahead); 0 nothing. */
enum { PREDICTION_BEHIND = 1, GRADIENT_BEHIND };

/* ---- step ---------------------------------------------------------------------- */

/*
 * What inputs may reach in this step; rounding may narrow a slew window, never widen it. Returns in how many slew and limit
 * do not meet.
 */
static uint32_t open_windows(pzs_real *restrict lo, pzs_real *restrict hi, const pzs_real *restrict v,
                             const pzs_real *restrict slew, const pzs_real *restrict lower,
                             const pzs_real *restrict upper, size_t width)
{
    uint32_t clashes = 0;
    for (size_t i = 0; i < width; i++) {
        const pzs_real last = v[i], most = slew[i], down = last - most, up = last + most;
        const pzs_real inner = last - down > most ? down + PZS_EPSILON * boxls_size(down) : down;
        const pzs_real outer = up - last > most ? up - PZS_EPSILON * boxls_size(up) : up;
        const pzs_real from = inner < last ? inner : last, to = outer > last ? outer : last;
        const pzs_real low = from > lower[i] ? from : lower[i], high = to < upper[i] ? to : upper[i];
        clashes += low > high ? 1u : 0u;
        lo[i] = low;
        hi[i] = high;
    }
    return clashes;
}

/* Where slew and limit do not meet, the limit it is. Returns the first such input. */
static int32_t take_limits(boxls *b, const pzs_control *c)
{
    int32_t clash = -1;
    for (uint32_t i = 0; i < b->n; i++) {
        if (b->lo[i] > b->hi[i]) {
            b->lo[i] = b->hi[i] = b->v[i] < c->lower[i] ? c->lower[i] : c->upper[i];
            clash = clash < 0 ? (int32_t)i : clash;
        }
    }
    return clash;
}

/* Start a step: windows where slews are in force, and the gradient. Returns the first clash of slew and limit, or -1. */
static int32_t enter(boxls *b, const pzs_control *c)
{
    boxls_gradient(b);
    if (!c->slews || open_windows(b->lo, b->hi, b->v, c->slew, c->lower, c->upper, boxls_span(b)) == 0)
        return -1;
    return take_limits(b, c);
}

/* out [inputs] = B'W^2 (e - y); returns |W (e - y)|^2. */
static pzs_real misfit(const pzs_control *c, pzs_real *out, const pzs_real *e, const pzs_real *y)
{
    const uint32_t m = c->problem->outputs, n = c->problem->inputs;
    const pzs_real square = product_weigh(c->weighted, c->problem->weight, e, y, m);
    product_sum_rows(out, c->influence, n, c->weighted, m, n);
    return square;
}

/*
 * want = B'W^2 (e - B base) with shown = B base + disturbance; returns missed = |W (e - B base)|^2.
 * energy = |W e|^2 = missed + |W B base|^2 + 2 base . want, not below what rounding leaves of it. Both are finite
 * only where want is.
 */
static pzs_real project(boxls *b, const pzs_control *c, const pzs_real *wanted, const pzs_real *shown)
{
    const pzs_real missed = misfit(c, b->want, wanted, shown);
    b->energy = missed + c->base_energy + 2 * product_dot(b->base, b->want, b->width);
    b->energy = b->energy < PZS_EPSILON * missed ? PZS_EPSILON * missed : b->energy;
    return missed;
}

/* Make the volts the new base, predicted their shape. */
static void rebase(boxls *b, pzs_control *c)
{
    const pzs_real effort = c->problem->effort;
    product(c->predicted, c->influence, b->v, c->problem->outputs, b->n);
    for (uint32_t i = 0; i < b->n; i++) {
        b->bias[i] = b->pull[i] = effort * (b->v[i] - c->problem->prefer[i]);
        b->base[i] = b->v[i];
    }
    c->base_energy = product_energy(c->problem->weight, c->predicted, c->problem->outputs);
    c->ahead = 0;
    b->rough = 0;
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
    pzs_real *sum = c->weighted + m;
    for (uint32_t i = 0; i < m; i++)
        sum[i] = c->predicted[i] + c->disturbance[i];
    return sum;
}

/* Optimise; where far from the base rounding could cost accuracy, once more from the residual. */
static void settle(boxls *b, pzs_control *c, const pzs_real *wanted, const pzs_real *shown)
{
    boxls_optimise(b);
    if (boxls_coarse(b)) {
        rebase(b, c);
        (void)project(b, c, wanted, shown == c->predicted ? shown : expected(c));
        boxls_gradient(b);
        boxls_optimise(b);
    }
}

/* The step itself, once want, missed and energy are there. */
static pzs_status step_to(boxls *b, pzs_control *c, const pzs_real *wanted, const pzs_real *shown, pzs_real missed)
{
    const int32_t clash = enter(b, c);
    b->used = 0;
    b->allowed = c->passes_allowed < PZS_STEP_PASSES ? c->passes_allowed : PZS_STEP_PASSES;
    b->rough_want = PZS_EPSILON * PZS_SQRT(b->energy + missed + SMALLEST_SQUARE) * c->stiffest;
    settle(b, c, wanted, shown);
    c->ahead = PREDICTION_BEHIND;
    c->passes = (uint16_t)b->used;
    c->passes_most = c->passes > c->passes_most ? c->passes : c->passes_most;
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
    boxls *b = &c->optimiser;
    if (c->ahead == GRADIENT_BEHIND)
        rebase(b, c);
    return step(b, c, error, c->predicted);
}

/* ---- tick ------------------------------------------------------------------------ */

/* predicted = B volt again, where volts have changed since. */
static void catch_up(boxls *b, pzs_control *c)
{
    if (c->ahead != 0)
        rebase(b, c);
}

void control_predict(pzs_control *c)
{
    catch_up(&c->optimiser, c);
}

void control_moved(pzs_control *c)
{
    c->ahead = GRADIENT_BEHIND;
}

/* Volts as they were, but inside the limits now in force. */
static pzs_status hold_last(boxls *b, pzs_control *c, int32_t where)
{
    (void)enter(b, c);
    if (boxls_come_inside(b))
        rebase(b, c);
    return finish(c, PZS_W_HELD, where);
}

pzs_status pzs_tick(pzs_control *c, const pzs_real *wanted, const pzs_real *measured)
{
    const pzs_status status = ready(c, wanted);
    if (status != PZS_OK)
        return status;
    boxls *b = &c->optimiser;
    const uint32_t m = c->problem->outputs;
    int32_t where = -1;
    catch_up(b, c);
    const senses all = { m, c->predicted, c->measured, c->disturbance, c->frozen };
    const uint32_t lost = measured != NULL ? sense(&all, measured, &where) : 0;
    if (lost == m)
        return hold_last(b, c, where);
    const pzs_status stepped = step(b, c, wanted, measured != NULL && lost == 0 ? measured : expected(c));
    if (stepped == PZS_E_NONFINITE)
        return hold_last(b, c, c->where);
    rebase(b, c);
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
    const uint32_t n = c->problem->inputs, m = c->problem->outputs, width = (uint32_t)PZS_CONTROL_WIDTH(n);
    boxls *b = &c->optimiser;
    b->n = n;
    b->width = width;
    b->h = at, at += (size_t)n * width;
    b->m = at, at += (size_t)n * width;
    boxls_place(b, at);
    at += BOXLS_VECTORS * width;
    c->volt = b->v = at, at += width;
    c->lower = at, at += width;
    c->upper = at, at += width;
    c->slew = at, at += width;
    c->predicted = at, at += m;
    c->disturbance = at, at += m;
    c->measured = at, at += m;
    c->weighted = at, at += 2u * m;
    c->frozen = (uint8_t *)at;
}

/* Row k of H: from the table, or the sum over outputs of W^2 B_ik B_i, kept symmetric to the last bit. */
static void form_row(const pzs_control *c, const pzs_real *table, uint32_t k)
{
    const uint32_t n = c->problem->inputs, m = c->problem->outputs, width = c->optimiser.width;
    const pzs_real *weight = c->problem->weight;
    pzs_real *h = c->optimiser.h, *row = h + (size_t)k * width, *column = c->weighted;
    if (table != NULL) {
        memcpy(row, table + (size_t)k * n, n * sizeof(pzs_real));
    } else {
        for (uint32_t i = 0; i < m; i++)
            column[i] = weight[i] * weight[i] * c->influence[(size_t)i * n + k];
        product_sum_rows(row, c->influence, n, column, m, n);
        for (uint32_t j = 0; j < k; j++)
            row[j] = h[(size_t)j * width + k];
    }
    row[k] += c->problem->effort;
}

/* Before the first step its limits are those in force; without slews they always are. */
static void open_limits(boxls *b, const pzs_control *c)
{
    if (c->slews) {
        memcpy(b->lo, c->lower, b->n * sizeof *b->lo);
        memcpy(b->hi, c->upper, b->n * sizeof *b->hi);
    } else {
        b->lo = c->lower;
        b->hi = c->upper;
    }
}

/* Fill what a step starts from: volts at prefer inside the limits, all inputs swept that can be. */
static void set_out(boxls *b, pzs_control *c)
{
    const pzs_problem *p = c->problem;
    for (uint32_t i = 0; i < b->n; i++) {
        c->lower[i] = p->lower[i];
        c->upper[i] = p->upper[i];
        c->slew[i] = p->slew[i];
        c->slews |= p->slew[i] < p->upper[i] - p->lower[i];
        b->v[i] = boxls_cut(p->prefer[i], p->lower[i], p->upper[i]);
        b->diag[i] = b->h[(size_t)i * b->width + i];
        b->free[i] = 1;
    }
    open_limits(b, c);
    const pzs_real stiffest = product_largest(b->diag, b->width);
    c->stiffest = PZS_SQRT(stiffest);
    b->floor = 4 * (pzs_real)b->n * PZS_EPSILON;
    b->soft_most = p->effort > BOXLS_DEPENDENT * b->floor * stiffest ? (pzs_real)b->n / p->effort : 0;
    rebase(b, c);
    tableau_rebuild(b);
}

pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem, const pzs_real *influence,
                            void *work, size_t bytes)
{
    if (control == NULL)
        return PZS_E_ARGUMENT;
    control->stage = 0;
    if (problem == NULL || work == NULL)
        return PZS_E_ARGUMENT;
    const pzs_real *use = influence != NULL ? influence : problem->influence;
    const size_t need = PZS_CONTROL_BYTES(problem->inputs, problem->outputs);
    *control = (pzs_control){ .problem = problem, .influence = use, .where = -1, .passes_allowed = PZS_STEP_PASSES };
    const pzs_status status = check(problem, use, &control->where);
    if (status != PZS_OK)
        return status;
    const int32_t lacking = guard_short(work, bytes, need);
    if (lacking >= 0)
        return finish(control, PZS_E_WORKSPACE, lacking);
    memset(work, 0, need);
    lay_out(control, work);
    for (uint32_t k = 0; k < problem->inputs; k++)
        form_row(control, influence == NULL ? problem->hessian : NULL, k);
    boxls *b = &control->optimiser;
    const int32_t overflow = guard_nonfinite(b->h, b->n * b->width);
    if (overflow >= 0)
        return finish(control, PZS_E_NONFINITE, overflow);
    set_out(b, control);
    control->stage = CONTROL_READY;
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
    open_limits(&c->optimiser, c);
    rebase(&c->optimiser, c);
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

/* ---- how good it is ------------------------------------------------------------------------ */

pzs_status pzs_assess(pzs_control *c, const pzs_real *error, pzs_report *report)
{
    const pzs_status status = report != NULL ? ready(c, error) : PZS_E_ARGUMENT;
    if (status != PZS_OK)
        return status;
    const uint32_t m = c->problem->outputs;
    boxls *b = &c->optimiser;
    pzs_real *shape = c->weighted + m, most = 0;
    memset(shape, 0, m * sizeof *shape);
    const pzs_real all = PZS_SQRT(misfit(c, b->next, error, shape));
    for (uint32_t i = 0; i < b->n; i++)
        most = boxls_size(b->next[i]) > most ? boxls_size(b->next[i]) : most;
    product(shape, c->influence, b->v, m, b->n);
    const pzs_real left = PZS_SQRT(misfit(c, b->next, error, shape));
    if (!boxls_finite(all + left))
        return finish(c, PZS_E_NONFINITE, guard_nonfinite(error, m));
    pzs_report r = { .error = all > 0 ? left / all : 0 };
    for (uint32_t i = 0; i < b->n; i++) {
        b->grad[i] = c->problem->effort * (b->v[i] - c->problem->prefer[i]) - b->next[i];
        r.active = (uint16_t)(r.active + !(b->v[i] > b->lo[i] && b->v[i] < b->hi[i]));
    }
    const pzs_real wrong = boxls_violation(b, b->v, b->grad);
    r.optimality = most > 0 ? wrong / most : 0;
    *report = r;
    return PZS_OK;
}

/* ---- for comparison -------------------------------------------------------------------- */

/* The optimum without limits into b->v; needs want, uses up free and the tableau. Dependent inputs stay at 0 V. */
static void solve_free(boxls *b)
{
    memset(b->v, 0, b->width * sizeof(pzs_real));
    for (uint32_t i = 0; i < b->n; i++)
        b->free[i] = 1;
    tableau_rebuild(b);
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
    boxls *b = &c->optimiser;
    uint8_t *swept = c->frozen + c->problem->outputs;
    for (uint32_t i = 0; i < b->n; i++)
        swept[i] = b->free[i] > 0;
    (void)project(b, c, error, c->predicted);
    boxls apart = *b; /* its volts and pull apart from the controller's */
    apart.v = b->start;
    apart.pull = b->start_grad;
    solve_free(&apart);
    for (uint32_t i = 0; i < b->n; i++)
        b->free[i] = swept[i];
    tableau_rebuild(b);
    if (guard_nonfinite(apart.v, b->n) >= 0)
        return finish(c, PZS_E_NONFINITE, guard_nonfinite(error, c->problem->outputs));
    memcpy(volt, apart.v, b->n * sizeof(pzs_real));
    return finish(c, PZS_OK, -1);
}

pzs_status pzs_clipped(pzs_control *c, const pzs_real *error, pzs_real *volt)
{
    const pzs_status status = pzs_unlimited(c, error, volt);
    for (uint32_t i = 0; status == PZS_OK && i < c->problem->inputs; i++)
        volt[i] = boxls_cut(volt[i], c->lower[i], c->upper[i]);
    return status;
}
