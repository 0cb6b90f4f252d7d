/*
 * Electrodes that do not follow their amplifiers, found from what the shape does and does not do.
 *
 * Between two shapes the commanded volts change by x and the disturbance, measured - predicted, by
 * d = B f + load: f_j is what electrode j did beyond its command. Least squares give f, x + f is
 * the response. An electrode that follows responds with x times what the model is wrong by; one
 * that does not, with nothing. Two things make a suspect:
 *
 *   it was moved by a full swing and hardly responded (a stuck one, or a dead one called for), or
 *   the shape jumped as if its volts had gone, and mainly its (one that has just died).
 *
 * A load may look like either. So a suspect is probed: held at two volts in turn, a swing to either
 * side of where it was, inside limits and slew, while the step compensates with the others. It is
 * found where the response to its moves is the same every time, as if there were none; what a load
 * does does not move with the probe.
 *
 * Work of a tick: (m + n) n multiply-adds, and less than 40 (m + n) other operations; where
 * measurements are lost or come back, m n^2 / 16 + n^3 / 6 besides. Nothing else depends on the
 * data.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../core/product.h"
#include "sense.h"
#include "../core/numbers.h"

#define READY 1u
#define KEPT PZS_R(0.75)  /* of the sums over past ticks, a tick */
#define SILENT 16         /* a response whose square is below 1/SILENT of the move's is none */
#define RIDGE PZS_R(1e-5) /* of the diagonal, added to it */
#define CLEAR                                                                                      \
    PZS_R(0.75)      /* least part of an electrode's own volts that least squares must give back */
#define MOVES 8u     /* of a probe, */
#define PATIENCE 24u /* within so many shapes */
#define REST 100u    /* shapes before an electrode that was cleared is suspected again */
#define NOBODY 0xFFFFu
#define MISSING 8u /* one output in so many may be without measurement */

enum {
    LOST = 1,
    LEFT_OUT = 2
}; /* of an output: without measurement at the shape before; not among the columns */

static pzs_real square(pzs_real x)
{
    return x * x;
}

/* ---- init ------------------------------------------------------------- */

/* Half the volts of a probe: half the slew, at most 1/32 of the limits, and a little less, for
 * rounding. */
static pzs_real default_swing(const pzs_problem *p, uint32_t j)
{
    const pzs_real range = (p->upper[j] - p->lower[j]) / 16,
                   whole = p->step_limit[j] < range ? p->step_limit[j] : range;
    return PZS_R(0.49) * whole;
}

static void lay_out(pzs_fault_detector *w, void *work)
{
    const uint32_t n = w->state.control->state.problem->inputs,
                   m = w->state.control->state.problem->outputs;
    pzs_real *at = work, *const columns = at;
    at += PZS_DENSE(n);
    w->settings.amplitude = at, at += n;
    w->state.diagonal = at, at += n;
    w->state.voltage = at, at += (size_t)(w->state.delay + 1u) * n;
    w->state.voltage_before = at, at += n;
    w->state.deviation = at, at += n;
    w->state.moved = at, at += n;
    w->state.response = at, at += n;
    w->state.lost_voltage = at, at += n;
    w->state.disturbance = at, at += m;
    w->state.change = at, at += m;
    pzs_linalg_dense_layout(&w->state.columns, n, columns, at);
    w->state.electrode =
        (uint8_t *)at + sizeof(uint32_t) * (n / PZS_TILE + 2u) + sizeof(uint16_t) * n;
    w->state.rest = w->state.electrode + n;
    w->state.missing = w->state.rest + n;
    w->info.electrode = w->state.electrode;
}

/* Diagonal of B'W^2 B, 1 where an electrode does nothing; the Hessian's holds the effort besides.
 */
static void take_diagonal(pzs_fault_detector *w)
{
    const pzs_control *c = w->state.control;
    const uint32_t n = c->state.problem->inputs;
    for (uint32_t j = 0; j < n; j++) {
        pzs_real sum = 0;
        for (uint32_t i = 0; i < c->state.problem->outputs; i++)
            sum += square(c->state.problem->weight[i] * c->state.influence[(size_t)i * n + j]);
        w->state.diagonal[j] = sum > 0 ? sum : 1;
        w->state.electrode[j] =
            sum > 0 && number_is_finite(w->settings.amplitude[j]) && w->settings.amplitude[j] > 0
                ? PZS_ELECTRODE_OBSERVED
                : PZS_ELECTRODE_UNOBSERVABLE;
    }
}

/* row [j + 1] = row j of B'W^2 B over the outputs that are not left out, a ridge on its diagonal.
 */
static void form_row(const pzs_fault_detector *w, uint32_t j, pzs_real *row)
{
    const pzs_control *c = w->state.control;
    const uint32_t n = c->state.problem->inputs;
    memcpy(row, c->state.optimiser.hessian + (size_t)j * c->state.optimiser.width, j * sizeof *row);
    row[j] = w->state.diagonal[j] * (1 + w->state.ridge);
    for (uint32_t i = 0; i < c->state.problem->outputs; i++) {
        if (!(w->state.missing[i] & LEFT_OUT))
            continue;
        const pzs_real *b = c->state.influence + (size_t)i * n,
                       part = square(c->state.problem->weight[i]) * b[j];
        for (uint32_t k = 0; k <= j; k++)
            row[k] -= part * b[k];
    }
}

/* Factor it. Returns whether that can be done. */
static int factor(pzs_fault_detector *w)
{
    for (uint32_t j = 0; j < w->state.columns.n; j++) {
        form_row(w, j, w->state.deviation);
        for (uint32_t k = 0; k <= j; k++)
            *pzs_linalg_entry(&w->state.columns, j, k) = w->state.deviation[k];
    }
    w->state.is_stale = pzs_linalg_factor(&w->state.columns).zero >= 0;
    return !w->state.is_stale;
}

/* An electrode whose volts least squares do not give back is not watched. */
static void find_blind(pzs_fault_detector *w)
{
    const uint32_t n = w->state.columns.n;
    for (uint32_t j = 0; j < n; j++) {
        memset(w->state.deviation, 0, n * sizeof *w->state.deviation);
        w->state.deviation[j] = 1;
        pzs_linalg_solve(&w->state.columns, w->state.deviation);
        if (!(1 - w->state.ridge * w->state.diagonal[j] * w->state.deviation[j] > CLEAR))
            w->state.electrode[j] = PZS_ELECTRODE_UNOBSERVABLE;
        w->info.unobservable = (uint16_t)(w->info.unobservable +
                                          (w->state.electrode[j] == PZS_ELECTRODE_UNOBSERVABLE));
    }
    memset(w->state.deviation, 0, n * sizeof *w->state.deviation);
}

static pzs_status finish(pzs_fault_detector *w, pzs_status status, int32_t where)
{
    w->info.where = where;
    return status;
}

pzs_status pzs_fault_detector_init(pzs_fault_detector *watch, pzs_control *control, uint16_t delay,
                                   void *work, size_t bytes)
{
    if (watch == NULL)
        return PZS_E_ARGUMENT;
    memset(watch, 0, sizeof *watch);
    const pzs_status status = control == NULL || work == NULL || delay > PZS_DELAY_LIMIT
                                  ? PZS_E_ARGUMENT
                              : control->state.stage != CONTROL_READY ? PZS_E_STAGE
                                                                      : PZS_OK;
    if (status != PZS_OK)
        return finish(watch, status, -1);
    const pzs_problem *p = control->state.problem;
    const size_t need = PZS_FAULT_DETECTOR_BYTES(p->inputs, p->outputs, delay);
    const int32_t lacking = guard_missing_bytes(work, bytes, need);
    if (lacking >= 0)
        return finish(watch, PZS_E_WORKSPACE, lacking);
    memset(work, 0, need);
    watch->state.control = control;
    watch->state.delay = delay;
    lay_out(watch, work);
    for (uint32_t j = 0; j < p->inputs; j++)
        watch->settings.amplitude[j] = default_swing(p, j);
    const pzs_real least = 4 * (pzs_real)p->inputs * PZS_EPSILON;
    watch->state.ridge = least > RIDGE ? least : RIDGE;
    take_diagonal(watch);
    if (!factor(watch))
        return finish(watch, PZS_E_NONFINITE, -1);
    find_blind(watch);
    for (uint32_t k = 0; k <= delay; k++)
        memcpy(watch->state.voltage + (size_t)k * p->inputs, control->state.voltage,
               p->inputs * sizeof(pzs_real));
    memcpy(watch->state.voltage_before, control->state.voltage, p->inputs * sizeof(pzs_real));
    memset(watch->state.missing, LOST, p->outputs);
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++)
        watch->state.test[k].input = NOBODY;
    watch->state.stage = READY;
    return finish(watch, PZS_OK, -1);
}

/* ---- response --------------------------------------------------------- */

/*
 * Take the new disturbance; change = W^2 times what it changed by since the last shape, zero where
 * either has no measurement. Returns whether both have enough to tell electrodes apart.
 */
static int compare(pzs_fault_detector *w, const pzs_real *measured)
{
    const pzs_control *c = w->state.control;
    const uint32_t m = c->state.problem->outputs;
    uint32_t out = 0;
    for (uint32_t i = 0; i < m; i++) {
        const int lost = sense_lost(&c->state.repeats[i], measured[i]),
                  left_out = lost || (w->state.missing[i] & LOST);
        const pzs_real change = c->state.disturbance[i] - w->state.disturbance[i];
        w->state.change[i] = left_out ? 0 : square(c->state.problem->weight[i]) * change;
        w->state.disturbance[i] = c->state.disturbance[i];
        w->state.is_stale |= !left_out != !(w->state.missing[i] & LEFT_OUT);
        w->state.missing[i] = (uint8_t)((lost ? LOST : 0) | (left_out ? LEFT_OUT : 0));
        out += left_out ? 1u : 0u;
    }
    return MISSING * out <= m && (!w->state.is_stale || factor(w));
}

/* Fewer measurements than can be left out: the last shape still stands. */
static int too_few(const pzs_fault_detector *w, const pzs_real *measured)
{
    const pzs_control *c = w->state.control;
    uint32_t lost = 0;
    for (uint32_t i = 0; i < c->state.problem->outputs; i++)
        lost += sense_lost(&c->state.repeats[i], measured[i]) ? 1u : 0u;
    return MISSING * lost > c->state.problem->outputs;
}

/* The volts that made the shape now looked at: the oldest kept. */
static pzs_real *oldest_volts(const pzs_fault_detector *w)
{
    return w->state.voltage + (size_t)w->state.oldest * w->state.control->state.problem->inputs;
}

/* Those of this tick take their place. */
static void keep_volts(pzs_fault_detector *w)
{
    memcpy(oldest_volts(w), w->state.control->state.voltage,
           w->state.control->state.problem->inputs * sizeof(pzs_real));
    w->state.oldest = (uint16_t)(w->state.oldest < w->state.delay ? w->state.oldest + 1u : 0);
}

/* answer = f; sums of moves and responses, and what each electrode has lost. Returns |f|^2. */
static pzs_real respond(pzs_fault_detector *w, const pzs_real *voltage)
{
    const pzs_control *c = w->state.control;
    const uint32_t n = c->state.problem->inputs;
    pzs_real all = 0;
    pzs_product_sum_rows(w->state.deviation, c->state.influence, n, w->state.change,
                         c->state.problem->outputs, n);
    pzs_linalg_solve(&w->state.columns, w->state.deviation);
    for (uint32_t j = 0; j < n; j++) {
        const pzs_real move = voltage[j] - w->state.voltage_before[j],
                       most = 2 * number_absolute(move);
        all += square(w->state.deviation[j]);
        w->state.moved[j] = KEPT * w->state.moved[j] + square(move);
        w->state.response[j] = KEPT * w->state.response[j] +
                               square(number_clamp(move + w->state.deviation[j], -most, most));
        w->state.lost_voltage[j] = KEPT * w->state.lost_voltage[j] + w->state.deviation[j];
    }
    return all;
}

/* ---- probes ----------------------------------------------------------- */

static int held(const pzs_control *c, uint32_t j)
{
    return !(c->state.lower[j] < c->state.upper[j]);
}

/* Most of its volts gone in one tick, and no other lost as much: all = |f|^2. */
static int just_died(const pzs_fault_detector *w, uint32_t j, pzs_real voltage, pzs_real all)
{
    const pzs_real gone = voltage < 0 ? w->state.deviation[j] : -w->state.deviation[j],
                   most = number_absolute(voltage);
    return gone > 2 * w->settings.amplitude[j] && gone > PZS_R(0.4) * most &&
           gone < PZS_R(1.6) * most && 4 * square(gone) >= all;
}

/* How suspicious an electrode is (V^2), 0 where not. */
static pzs_real suspicion(const pzs_fault_detector *w, uint32_t j, pzs_real voltage, pzs_real all)
{
    if (w->state.electrode[j] != PZS_ELECTRODE_OBSERVED || held(w->state.control, j))
        return 0;
    if (just_died(w, j, voltage, all))
        return square(w->state.deviation[j]);
    return w->state.moved[j] >= 4 * square(w->settings.amplitude[j]) &&
                   SILENT * w->state.response[j] < w->state.moved[j]
               ? w->state.moved[j]
               : 0;
}

/* Begin a probe of input j around its volts, far enough from its limits. */
static void begin(pzs_fault_detector *w, pzs_test_signal *probe, uint32_t j,
                  const pzs_real *voltage)
{
    const pzs_control *c = w->state.control;
    const pzs_test_signal fresh = {
        .input = (uint16_t)j, .lower = c->state.lower[j], .upper = c->state.upper[j]};
    *probe = fresh;
    probe->middle = number_clamp(c->state.voltage[j], c->state.lower[j] + w->settings.amplitude[j],
                                 c->state.upper[j] - w->settings.amplitude[j]);
    probe->is_dead = voltage[j] * w->state.lost_voltage[j] < 0 &&
                     2 * number_absolute(w->state.lost_voltage[j]) > number_absolute(voltage[j]);
    w->state.electrode[j] = PZS_ELECTRODE_TESTED;
}

static int is_wide(const pzs_fault_detector *w, uint32_t j)
{
    return w->state.control->state.upper[j] - w->state.control->state.lower[j] >
           4 * w->settings.amplitude[j];
}

/* The most suspicious electrodes into the places that are free. */
static void suspect(pzs_fault_detector *w, const pzs_real *voltage, pzs_real all)
{
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_real most = 0;
        uint32_t who = NOBODY;
        for (uint32_t j = 0;
             w->state.test[k].input == NOBODY && j < w->state.control->state.problem->inputs; j++) {
            const pzs_real now = suspicion(w, j, voltage[j], all);
            who = now > most && is_wide(w, j) ? j : who;
            most = now > most && is_wide(w, j) ? now : most;
        }
        if (who != NOBODY)
            begin(w, &w->state.test[k], who, voltage);
    }
}

/* Hold the suspects at their next volts, inside their limits whatever the swing was changed to. */
static void swing_all(pzs_fault_detector *w)
{
    pzs_control *c = w->state.control;
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_test_signal *p = &w->state.test[k];
        const uint32_t j = p->input;
        if (j == NOBODY)
            continue;
        p->is_upper = !p->is_upper;
        const pzs_real wish =
            p->middle + (p->is_upper ? w->settings.amplitude[j] : -w->settings.amplitude[j]);
        p->set =
            number_clamp(number_is_finite(wish) ? wish : c->state.voltage[j], p->lower, p->upper);
        c->state.lower[j] = c->state.upper[j] = p->set;
    }
}

/* Leave an electrode alone for a while. */
static void clear(pzs_fault_detector *w, uint32_t j)
{
    w->state.electrode[j] = PZS_ELECTRODE_CLEARED;
    w->state.rest[j] = REST;
}

/* End a test: the electrode gets its limits back. */
static void release(pzs_fault_detector *w, pzs_test_signal *probe)
{
    const uint32_t j = probe->input;
    w->state.control->state.lower[j] = probe->lower;
    w->state.control->state.upper[j] = probe->upper;
    clear(w, j);
    probe->input = NOBODY;
}

/*
 * Held from now on where it is believed to be, dead at 0 V: volts and prediction agree with what
 * the structure has, so that the next step has nothing to make up for but what the electrode no
 * longer does.
 */
static void remove(pzs_fault_detector *w, pzs_test_signal *probe)
{
    pzs_control *c = w->state.control;
    const uint32_t j = probe->input;
    c->state.voltage[j] =
        probe->is_dead ? number_clamp(0, probe->lower, probe->upper) : c->state.voltage[j];
    c->state.lower[j] = c->state.upper[j] = c->state.voltage[j];
    pzs_control_moved(c);
    w->state.electrode[j] = PZS_ELECTRODE_HELD;
    w->info.found++;
    probe->input = NOBODY;
}

/* Moves of the probe and responses to them, about their means: was there any response? */
static int silent(const pzs_test_signal *p)
{
    const pzs_real n = (pzs_real)p->moves;
    const pzs_real moves = p->square - square(p->sum) / n;
    const pzs_real responses = p->response_square - square(p->response_sum) / n;
    return SILENT * responses <= moves;
}

/* One more shape for a probe: go on, or come to an end. Returns whether the electrode was found. */
static int examine(pzs_fault_detector *w, pzs_test_signal *p, const pzs_real *voltage)
{
    const uint32_t j = p->input;
    const pzs_real move = voltage[j] - w->state.voltage_before[j],
                   response = move + w->state.deviation[j];
    p->shapes++;
    if (number_absolute(move) >= w->settings.amplitude[j]) {
        p->moves++;
        p->sum += move;
        p->square += square(move);
        p->response_sum += response;
        p->response_square += square(response);
    }
    const int ends = p->moves == MOVES, found = ends && silent(p);
    if (found)
        remove(w, p);
    else if (ends || p->shapes == PATIENCE)
        release(w, p);
    return found;
}

/* Someone else held or released the electrode meanwhile. */
static int taken(const pzs_fault_detector *w, const pzs_test_signal *p)
{
    const pzs_control *c = w->state.control;
    const uint32_t j = p->input;
    return c->state.lower[j] < p->set || c->state.lower[j] > p->set || c->state.upper[j] > p->set;
}

/* All probes, by one shape. Returns the first input found, or -1. */
static int32_t run_probes(pzs_fault_detector *w, const pzs_real *voltage)
{
    int32_t first = -1;
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_test_signal *p = &w->state.test[k];
        const uint32_t j = p->input;
        if (j == NOBODY)
            continue;
        if (taken(w, p)) {
            clear(w, j);
            p->input = NOBODY;
        } else if (examine(w, p, voltage) && first < 0) {
            first = (int32_t)j;
        }
    }
    return first;
}

static void rest(pzs_fault_detector *w)
{
    for (uint32_t j = 0; j < w->state.control->state.problem->inputs; j++) {
        if (w->state.electrode[j] == PZS_ELECTRODE_CLEARED && --w->state.rest[j] == 0)
            w->state.electrode[j] = PZS_ELECTRODE_OBSERVED;
        if (w->state.electrode[j] == PZS_ELECTRODE_HELD && !held(w->state.control, j))
            w->state.electrode[j] = PZS_ELECTRODE_OBSERVED; /* released: another chance */
    }
}

/* All that one shape tells. Returns the first input found, or -1. */
static int32_t judge(pzs_fault_detector *w, const pzs_real *voltage)
{
    const pzs_real all = respond(w, voltage);
    const int32_t first = run_probes(w, voltage);
    suspect(w, voltage, all);
    rest(w);
    swing_all(w);
    return first;
}

pzs_status pzs_fault_detector_tick(pzs_fault_detector *w, const pzs_real *measured)
{
    if (w == NULL)
        return PZS_E_ARGUMENT;
    if (w->state.stage != READY)
        return PZS_E_STAGE;
    const pzs_real *voltage = oldest_volts(w);
    int32_t first = -1;
    if (measured != NULL && !too_few(w, measured)) {
        if (compare(w, measured))
            first = judge(w, voltage);
        memcpy(w->state.voltage_before, voltage, w->state.columns.n * sizeof(pzs_real));
    }
    keep_volts(w);
    return first >= 0 ? finish(w, PZS_W_ELECTRODE, first) : finish(w, PZS_OK, -1);
}

/* ---- block ------------------------------------------------------------ */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_fault_detection *t = tables;
    return PZS_FAULT_DETECTOR_BLOCK_BYTES(problem->inputs, problem->outputs, t->delay);
}

/* The amplitude of the tables, cut as the default is; electrodes that cannot be moved keep 0. */
static void set_amplitude(pzs_fault_detector *w, pzs_real amplitude)
{
    const pzs_problem *p = w->state.control->state.problem;
    for (uint32_t j = 0; j < p->inputs; j++) {
        const pzs_real most = PZS_R(0.49) * p->step_limit[j];
        w->settings.amplitude[j] = amplitude < most ? amplitude : most;
    }
}

/* In `self`: the detector, its workspace. */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_fault_detection *t = tables;
    const pzs_problem *p = signals->control->state.problem;
    pzs_fault_detector *w = self;
    void *work = (uint8_t *)self + PZS_ALIGNED(sizeof *w);
    if (!(t->amplitude >= 0) || !number_is_finite(t->amplitude))
        return PZS_E_ARGUMENT;
    const pzs_status status =
        pzs_fault_detector_init(w, signals->control, t->delay, work,
                                PZS_FAULT_DETECTOR_BYTES(p->inputs, p->outputs, t->delay));
    signals->where = w->info.where;
    if (status == PZS_OK && t->amplitude > 0)
        set_amplitude(w, t->amplitude);
    return status;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_fault_detector *w = self;
    const pzs_status status = pzs_fault_detector_tick(w, signals->measured);
    signals->electrode = w->info.electrode;
    signals->where = w->info.where;
    return status;
}

const pzs_block_type pzs_fault_detector_block = {"fault_detector", PZS_PHASE_OBSERVE, block_bytes,
                                                 block_init, block_tick};
