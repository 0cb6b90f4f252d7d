/*
 * Controller set-up, voltage step and control tick (pzs_control.h).
 *
 *   min |W (B v - e)|^2 + regularisation |v - v0|^2,  lower <= v <= upper,  |v - v_last| <= step
 * limit
 *
 * With H = B'W^2 B + regularisation I, half the gradient at v is
 *
 *   H (v - base) + regularisation (base - v0) - B'W^2 (e - B base)
 *
 * for any base voltages. Near the base it is as accurate as the residual e - B base itself. A tick
 * predicts B v after each step, which makes v the next base at no cost; pzs_step alone renews its
 * base where rounding errors would show.
 */
#include <string.h>
#include "boxls.h"
#include "boxls_tableau.h"
#include "control.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"
#include "sense.h"

#define SMALLEST_SQUARE                                                                            \
    PZS_BY_BITS(1e-31f, 1e-292) /* smallest square without loss of digits by underflow (m2) */

/* ---- step ------------------------------------------------------------ */

/*
 * Bounds of this step: step limits cut by voltage limits. Rounding may narrow the range of a step
 * limit, never widen it. Returns the number of inputs whose step limit and voltage limits do not
 * overlap.
 */
static uint32_t set_step_bounds(pzs_real *restrict lo, pzs_real *restrict hi,
                                const pzs_real *restrict v, const pzs_real *restrict slew,
                                const pzs_real *restrict lower, const pzs_real *restrict upper,
                                size_t width)
{
    uint32_t clashes = 0;
    for (size_t i = 0; i < width; i++) {
        const pzs_real last = v[i], most = slew[i], down = last - most, up = last + most;
        const pzs_real inner =
            last - down > most ? down + PZS_EPSILON * number_absolute(down) : down;
        const pzs_real outer = up - last > most ? up - PZS_EPSILON * number_absolute(up) : up;
        const pzs_real from = inner < last ? inner : last, to = outer > last ? outer : last;
        const pzs_real low = from > lower[i] ? from : lower[i],
                       high = to < upper[i] ? to : upper[i];
        clashes += low > high ? 1u : 0u;
        lo[i] = low;
        hi[i] = high;
    }
    return clashes;
}

/*
 * Where step limit and voltage limits do not overlap, use the voltage limit. Returns the first such
 * input, or -1.
 */
static int32_t prefer_voltage_limits(pzs_optimiser *b, const pzs_control *c)
{
    int32_t clash = -1;
    for (uint32_t i = 0; i < b->inputs; i++) {
        if (b->lower[i] > b->upper[i]) {
            b->lower[i] = b->upper[i] =
                b->voltage[i] < c->state.lower[i] ? c->state.lower[i] : c->state.upper[i];
            clash = clash < 0 ? (int32_t)i : clash;
        }
    }
    return clash;
}

/*
 * Start a step: gradient, and bounds if step limits are in force. Returns the first input whose
 * step limit and voltage limits do not overlap, or -1.
 */
static int32_t start_step(pzs_optimiser *b, const pzs_control *c)
{
    pzs_boxls_gradient(b);
    if (!c->state.has_step_limits ||
        set_step_bounds(b->lower, b->upper, b->voltage, c->state.step_limit, c->state.lower,
                        c->state.upper, optimiser_span(b)) == 0)
        return -1;
    return prefer_voltage_limits(b, c);
}

/* out [inputs] = B'W^2 (e - y). Returns |W (e - y)|^2. */
static pzs_real project_misfit(const pzs_control *c, pzs_real *out, const pzs_real *e,
                               const pzs_real *y)
{
    const uint32_t m = c->state.problem->outputs, n = c->state.problem->inputs;
    const pzs_real square = pzs_product_weigh(c->state.weighted, c->state.problem->weight, e, y, m);
    pzs_product_sum_rows(out, c->state.influence, n, c->state.weighted, m, n);
    return square;
}

/*
 * Target gradient B'W^2 (e - B base), with shown = B base + disturbance. Returns |W (e - B
 * base)|^2. The target energy |W e|^2 is this value + |W B base|^2 + 2 base . target gradient, and
 * not below what rounding leaves of it. Both are finite only if the target gradient is.
 */
static pzs_real project_target(pzs_optimiser *b, const pzs_control *c, const pzs_real *wanted,
                               const pzs_real *shown)
{
    const pzs_real missed = project_misfit(c, b->target_gradient, wanted, shown);
    b->target_energy =
        missed + c->state.base_energy + 2 * pzs_product_dot(b->base, b->target_gradient, b->width);
    b->target_energy =
        b->target_energy < PZS_EPSILON * missed ? PZS_EPSILON * missed : b->target_energy;
    return missed;
}

/* Make the present voltages the base and predict their shape. */
static void rebase(pzs_optimiser *b, pzs_control *c)
{
    const pzs_real effort = c->state.problem->regularisation;
    pzs_product_matrix(c->state.predicted, c->state.influence, b->voltage,
                       c->state.problem->outputs, b->inputs);
    for (uint32_t i = 0; i < b->inputs; i++) {
        b->regularisation_gradient[i] = b->model_gradient[i] =
            effort * (b->voltage[i] - c->state.problem->reference_voltage[i]);
        b->base[i] = b->voltage[i];
    }
    c->state.base_energy =
        pzs_product_energy(c->state.problem->weight, c->state.predicted, c->state.problem->outputs);
    c->state.behind = PZS_BEHIND_NOTHING;
    b->model_rounding = 0;
}

static pzs_status finish(pzs_control *c, pzs_status status, int32_t where)
{
    c->info.where = where;
    return status;
}

static pzs_status ready(const pzs_control *c, const void *argument)
{
    if (c == NULL || argument == NULL)
        return PZS_E_ARGUMENT;
    return c->state.stage == CONTROL_READY ? PZS_OK : PZS_E_STAGE;
}

/* Measurements to expect: predicted + disturbance. */
static const pzs_real *expected(const pzs_control *c)
{
    const uint32_t m = c->state.problem->outputs;
    pzs_real *sum = c->state.weighted + m;
    for (uint32_t i = 0; i < m; i++)
        sum[i] = c->state.predicted[i] + c->state.disturbance[i];
    return sum;
}

/*
 * Optimise. If the base is so far away that rounding errors could cost accuracy, optimise again
 * from a new base.
 */
static void optimise(pzs_optimiser *b, pzs_control *c, const pzs_real *wanted,
                     const pzs_real *shown)
{
    pzs_boxls_optimise(b);
    if (pzs_boxls_needs_new_base(b)) {
        rebase(b, c);
        (void)project_target(b, c, wanted, shown == c->state.predicted ? shown : expected(c));
        pzs_boxls_gradient(b);
        pzs_boxls_optimise(b);
    }
}

/* The step, once target gradient and target energy are known; missed = |W (e - B base)|^2. */
static pzs_status solve_step(pzs_optimiser *b, pzs_control *c, const pzs_real *wanted,
                             const pzs_real *shown, pzs_real missed)
{
    const int32_t clash = start_step(b, c);
    b->iterations = 0;
    b->iteration_limit = c->settings.iteration_limit < PZS_STEP_ITERATIONS
                             ? c->settings.iteration_limit
                             : PZS_STEP_ITERATIONS;
    b->target_rounding = PZS_EPSILON * PZS_SQRT(b->target_energy + missed + SMALLEST_SQUARE) *
                         c->state.largest_column;
    optimise(b, c, wanted, shown);
    c->state.behind = PZS_BEHIND_PREDICTION;
    c->info.iterations = (uint16_t)b->iterations;
    c->info.iterations_most =
        c->info.iterations > c->info.iterations_most ? c->info.iterations : c->info.iterations_most;
    if (!b->is_optimal)
        return finish(c, PZS_W_ITERATIONS, -1);
    return finish(c, clash < 0 ? PZS_OK : PZS_W_STEP_LIMIT, clash);
}

/* One step towards `wanted` from the shape `shown`. */
static pzs_status step(pzs_optimiser *b, pzs_control *c, const pzs_real *wanted,
                       const pzs_real *shown)
{
    const pzs_real missed = project_target(b, c, wanted, shown);
    if (!number_is_finite(b->target_energy + missed))
        return finish(c, PZS_E_NONFINITE, pzs_guard_nonfinite(wanted, c->state.problem->outputs));
    return solve_step(b, c, wanted, shown, missed);
}

pzs_status pzs_step(pzs_control *c, const pzs_real *error)
{
    const pzs_status status = ready(c, error);
    if (status != PZS_OK)
        return status;
    pzs_optimiser *b = &c->state.optimiser;
    if (c->state.behind == PZS_BEHIND_GRADIENT)
        rebase(b, c);
    return step(b, c, error, c->state.predicted);
}

/* ---- tick ------------------------------------------------------------ */

/* Renew the prediction if voltages have changed since the last one. */
static void renew_prediction(pzs_optimiser *b, pzs_control *c)
{
    if (c->state.behind != PZS_BEHIND_NOTHING)
        rebase(b, c);
}

void pzs_control_predict(pzs_control *c)
{
    renew_prediction(&c->state.optimiser, c);
}

void pzs_control_moved(pzs_control *c)
{
    c->state.behind = PZS_BEHIND_GRADIENT;
}

/* Keep the last voltages, clamped to the limits now in force. */
static pzs_status hold_voltages(pzs_optimiser *b, pzs_control *c, int32_t where)
{
    (void)start_step(b, c);
    if (pzs_boxls_enforce_limits(b))
        rebase(b, c);
    return finish(c, PZS_W_HELD, where);
}

pzs_status pzs_tick(pzs_control *c, const pzs_real *wanted, const pzs_real *measured)
{
    const pzs_status status = ready(c, wanted);
    if (status != PZS_OK)
        return status;
    pzs_optimiser *b = &c->state.optimiser;
    const uint32_t m = c->state.problem->outputs;
    int32_t where = -1;
    renew_prediction(b, c);
    const sensor_set all = {m, c->state.predicted, c->state.measured, c->state.disturbance,
                            c->state.repeats};
    const uint32_t lost = measured != NULL ? pzs_sensor_check(&all, measured, &where) : 0;
    if (lost == m)
        return hold_voltages(b, c, where);
    const pzs_status stepped =
        step(b, c, wanted, measured != NULL && lost == 0 ? measured : expected(c));
    if (stepped == PZS_E_NONFINITE)
        return hold_voltages(b, c, c->info.where);
    rebase(b, c);
    return stepped == PZS_OK && lost != 0 ? finish(c, PZS_W_SENSOR, where) : stepped;
}

/* ---- init and limits ------------------------------------------------- */

/*
 * First input whose limits contain no finite voltage or whose step limit is negative or not a
 * number, or -1.
 */
static int32_t bad_limit(const pzs_problem *p)
{
    for (uint32_t i = 0; i < p->inputs; i++) {
        const pzs_real lower = p->lower[i], upper = p->upper[i];
        const int some =
            lower <= upper && (number_is_finite(lower) || number_is_finite(upper) || lower < upper);
        if (!some || !(p->step_limit[i] >= 0))
            return (int32_t)i;
    }
    return -1;
}

/* Index of the first table entry that is not finite, or -1. */
static int32_t bad_number(const pzs_problem *p, const pzs_real *influence)
{
    const uint32_t n = p->inputs, m = p->outputs;
    int32_t bad = pzs_guard_nonfinite(influence, m * n);
    bad = bad >= 0 ? bad : pzs_guard_nonfinite(p->weight, m);
    bad = bad >= 0 ? bad : pzs_guard_nonfinite(p->reference_voltage, n);
    bad = bad >= 0 || p->hessian == NULL ? bad : pzs_guard_nonfinite(p->hessian, n * n);
    return bad;
}

static pzs_status check(const pzs_problem *p, const pzs_real *influence, int32_t *where)
{
    const int missing = p->weight == NULL || p->lower == NULL || p->upper == NULL ||
                        p->step_limit == NULL || p->reference_voltage == NULL || influence == NULL;
    *where = -1;
    if (p->format != PZS_TABLE_FORMAT)
        return PZS_E_FORMAT;
    if (missing || p->inputs == 0 || p->inputs > PZS_INPUT_LIMIT || p->outputs == 0 ||
        !(p->regularisation >= 0))
        return PZS_E_ARGUMENT;
    if (pzs_problem_crc(p) != p->crc)
        return PZS_E_CRC;
    *where = bad_limit(p);
    if (*where >= 0)
        return PZS_E_LIMITS;
    *where = bad_number(p, influence);
    return *where >= 0 || !number_is_finite(p->regularisation) ? PZS_E_NONFINITE : PZS_OK;
}

/* Point the arrays of the controller into the workspace. */
static void lay_out(pzs_control *c, pzs_real *at)
{
    const uint32_t n = c->state.problem->inputs, m = c->state.problem->outputs,
                   width = (uint32_t)PZS_CONTROL_WIDTH(n);
    pzs_optimiser *b = &c->state.optimiser;
    b->inputs = n;
    b->width = width;
    b->hessian = at, at += (size_t)n * width;
    b->tableau = at, at += (size_t)n * width;
    pzs_boxls_place(b, at);
    at += BOXLS_VECTORS * width;
    c->state.voltage = b->voltage = at, at += width;
    c->state.lower = at, at += width;
    c->state.upper = at, at += width;
    c->state.step_limit = at, at += width;
    c->state.predicted = at, at += m;
    c->state.disturbance = at, at += m;
    c->state.measured = at, at += m;
    c->state.weighted = at, at += 2u * m;
    c->state.repeats = (uint8_t *)at;
    c->info.voltage = c->state.voltage;
    c->info.predicted = c->state.predicted;
    c->info.disturbance = c->state.disturbance;
    c->info.lower = c->state.lower;
    c->info.upper = c->state.upper;
}

/*
 * Row k of H: from the table, or the sum over the outputs of W^2 B_ik B_i; symmetric to the last
 * bit.
 */
static void form_row(const pzs_control *c, const pzs_real *table, uint32_t k)
{
    const uint32_t n = c->state.problem->inputs, m = c->state.problem->outputs,
                   width = c->state.optimiser.width;
    const pzs_real *weight = c->state.problem->weight;
    pzs_real *h = c->state.optimiser.hessian, *row = h + (size_t)k * width,
             *column = c->state.weighted;
    if (table != NULL) {
        memcpy(row, table + (size_t)k * n, n * sizeof(pzs_real));
    } else {
        for (uint32_t i = 0; i < m; i++)
            column[i] = weight[i] * weight[i] * c->state.influence[(size_t)i * n + k];
        pzs_product_sum_rows(row, c->state.influence, n, column, m, n);
        for (uint32_t j = 0; j < k; j++)
            row[j] = h[(size_t)j * width + k];
    }
    row[k] += c->state.problem->regularisation;
}

/* Bounds before the first step. Without step limits they are always the voltage limits. */
static void set_initial_bounds(pzs_optimiser *b, const pzs_control *c)
{
    if (c->state.has_step_limits) {
        memcpy(b->lower, c->state.lower, b->inputs * sizeof *b->lower);
        memcpy(b->upper, c->state.upper, b->inputs * sizeof *b->upper);
    } else {
        b->lower = c->state.lower;
        b->upper = c->state.upper;
    }
}

/*
 * State before the first step: reference voltages inside the limits, every independent input in the
 * free set.
 */
static void set_initial_state(pzs_optimiser *b, pzs_control *c)
{
    const pzs_problem *p = c->state.problem;
    for (uint32_t i = 0; i < b->inputs; i++) {
        c->state.lower[i] = p->lower[i];
        c->state.upper[i] = p->upper[i];
        c->state.step_limit[i] = p->step_limit[i];
        c->state.has_step_limits |= p->step_limit[i] < p->upper[i] - p->lower[i];
        b->voltage[i] = number_clamp(p->reference_voltage[i], p->lower[i], p->upper[i]);
        b->diagonal[i] = b->hessian[(size_t)i * b->width + i];
        b->free_set[i] = 1;
    }
    set_initial_bounds(b, c);
    const pzs_real stiffest = pzs_product_largest(b->diagonal, b->width);
    c->state.largest_column = PZS_SQRT(stiffest);
    b->pivot_floor = 4 * (pzs_real)b->inputs * PZS_EPSILON;
    b->inverse_trace_bound = p->regularisation > BOXLS_DEPENDENT * b->pivot_floor * stiffest
                                 ? (pzs_real)b->inputs / p->regularisation
                                 : 0;
    rebase(b, c);
    pzs_tableau_rebuild(b);
}

pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem,
                            const pzs_real *influence, void *work, size_t bytes)
{
    if (control == NULL)
        return PZS_E_ARGUMENT;
    control->state.stage = 0;
    if (problem == NULL || work == NULL)
        return PZS_E_ARGUMENT;
    const pzs_real *use = influence != NULL ? influence : problem->influence;
    const size_t need = PZS_CONTROL_BYTES(problem->inputs, problem->outputs);
    *control = (pzs_control){.state.problem = problem,
                             .state.influence = use,
                             .info.where = -1,
                             .settings.iteration_limit = PZS_STEP_ITERATIONS};
    const pzs_status status = check(problem, use, &control->info.where);
    if (status != PZS_OK)
        return status;
    const int32_t lacking = guard_missing_bytes(work, bytes, need);
    if (lacking >= 0)
        return finish(control, PZS_E_WORKSPACE, lacking);
    memset(work, 0, need);
    lay_out(control, work);
    for (uint32_t k = 0; k < problem->inputs; k++)
        form_row(control, influence == NULL ? problem->hessian : NULL, k);
    pzs_optimiser *b = &control->state.optimiser;
    const int32_t overflow = pzs_guard_nonfinite(b->hessian, b->inputs * b->width);
    if (overflow >= 0)
        return finish(control, PZS_E_NONFINITE, overflow);
    set_initial_state(b, control);
    control->state.stage = CONTROL_READY;
    return PZS_OK;
}

pzs_status pzs_control_start(pzs_control *c, const pzs_real *voltage)
{
    const pzs_status status = ready(c, voltage);
    if (status != PZS_OK)
        return status;
    const int32_t bad = pzs_guard_nonfinite(voltage, c->state.problem->inputs);
    if (bad >= 0)
        return finish(c, PZS_E_NONFINITE, bad);
    for (uint32_t i = 0; i < c->state.problem->inputs; i++)
        c->state.voltage[i] = number_clamp(voltage[i], c->state.lower[i], c->state.upper[i]);
    set_initial_bounds(&c->state.optimiser, c);
    rebase(&c->state.optimiser, c);
    return finish(c, PZS_OK, -1);
}

pzs_status pzs_hold(pzs_control *c, uint16_t input, pzs_real voltage)
{
    const pzs_status status = ready(c, c);
    if (status != PZS_OK)
        return status;
    const pzs_problem *p = c->state.problem;
    if (input >= p->inputs)
        return finish(c, PZS_E_ARGUMENT, input);
    if (!number_is_finite(voltage))
        return finish(c, PZS_E_NONFINITE, input);
    c->state.lower[input] = c->state.upper[input] =
        number_clamp(voltage, p->lower[input], p->upper[input]);
    return finish(c, PZS_OK, -1);
}

pzs_status pzs_release(pzs_control *c, uint16_t input)
{
    const pzs_status status = ready(c, c);
    if (status != PZS_OK)
        return status;
    if (input >= c->state.problem->inputs)
        return finish(c, PZS_E_ARGUMENT, input);
    c->state.lower[input] = c->state.problem->lower[input];
    c->state.upper[input] = c->state.problem->upper[input];
    return finish(c, PZS_OK, -1);
}

/* ---- certificate ----------------------------------------------------- */

pzs_status pzs_assess(pzs_control *c, const pzs_real *error, pzs_report *report)
{
    const pzs_status status = report != NULL ? ready(c, error) : PZS_E_ARGUMENT;
    if (status != PZS_OK)
        return status;
    const uint32_t m = c->state.problem->outputs;
    pzs_optimiser *b = &c->state.optimiser;
    pzs_real *shape = c->state.weighted + m, most = 0;
    memset(shape, 0, m * sizeof *shape);
    const pzs_real all = PZS_SQRT(project_misfit(c, b->next_voltage, error, shape));
    for (uint32_t i = 0; i < b->inputs; i++)
        most =
            number_absolute(b->next_voltage[i]) > most ? number_absolute(b->next_voltage[i]) : most;
    pzs_product_matrix(shape, c->state.influence, b->voltage, m, b->inputs);
    const pzs_real left = PZS_SQRT(project_misfit(c, b->next_voltage, error, shape));
    if (!number_is_finite(all + left))
        return finish(c, PZS_E_NONFINITE, pzs_guard_nonfinite(error, m));
    pzs_report r = {.relative_error = all > 0 ? left / all : 0};
    for (uint32_t i = 0; i < b->inputs; i++) {
        b->gradient[i] = c->state.problem->regularisation *
                             (b->voltage[i] - c->state.problem->reference_voltage[i]) -
                         b->next_voltage[i];
        r.active_limits = (uint16_t)(r.active_limits +
                                     !(b->voltage[i] > b->lower[i] && b->voltage[i] < b->upper[i]));
    }
    const pzs_real wrong = pzs_boxls_violation(b, b->voltage, b->gradient);
    r.kkt_violation = most > 0 ? wrong / most : 0;
    *report = r;
    return PZS_OK;
}

/* ---- comparison ------------------------------------------------------ */

/*
 * Unconstrained optimum into b->voltage. Needs the target gradient; overwrites free set and
 * tableau. Inputs that depend linearly on others stay at 0 V.
 */
static void solve_free(pzs_optimiser *b)
{
    memset(b->voltage, 0, b->width * sizeof(pzs_real));
    for (uint32_t i = 0; i < b->inputs; i++)
        b->free_set[i] = 1;
    pzs_tableau_rebuild(b);
    for (uint32_t round = 0; round < 3u; round++) {
        pzs_boxls_true_gradient(b);
        (void)pzs_boxls_find_direction(b, 0);
        for (uint32_t i = 0; i < b->inputs; i++)
            b->voltage[i] += b->free_set[i] > 0 ? b->direction[i] : 0;
    }
}

pzs_status pzs_unlimited(pzs_control *c, const pzs_real *error, pzs_real *voltage)
{
    const pzs_status status = voltage != NULL ? ready(c, error) : PZS_E_ARGUMENT;
    if (status != PZS_OK)
        return status;
    pzs_optimiser *b = &c->state.optimiser;
    uint8_t *swept = c->state.repeats + c->state.problem->outputs;
    for (uint32_t i = 0; i < b->inputs; i++)
        swept[i] = b->free_set[i] > 0;
    (void)project_target(b, c, error, c->state.predicted);
    pzs_optimiser apart = *b; /* its own voltages and model gradient */
    apart.voltage = b->start_voltage;
    apart.model_gradient = b->start_gradient;
    solve_free(&apart);
    for (uint32_t i = 0; i < b->inputs; i++)
        b->free_set[i] = swept[i];
    pzs_tableau_rebuild(b);
    if (pzs_guard_nonfinite(apart.voltage, b->inputs) >= 0)
        return finish(c, PZS_E_NONFINITE, pzs_guard_nonfinite(error, c->state.problem->outputs));
    memcpy(voltage, apart.voltage, b->inputs * sizeof(pzs_real));
    return finish(c, PZS_OK, -1);
}

pzs_status pzs_clipped(pzs_control *c, const pzs_real *error, pzs_real *voltage)
{
    const pzs_status status = pzs_unlimited(c, error, voltage);
    for (uint32_t i = 0; status == PZS_OK && i < c->state.problem->inputs; i++)
        voltage[i] = number_clamp(voltage[i], c->state.lower[i], c->state.upper[i]);
    return status;
}
