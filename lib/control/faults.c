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
static pzs_real default_swing(const pzs_problem *problem, uint32_t j)
{
    const pzs_real range = (problem->upper[j] - problem->lower[j]) / 16,
                   whole = problem->step_limit[j] < range ? problem->step_limit[j] : range;
    return PZS_R(0.49) * whole;
}

static void lay_out(pzs_fault_detector *detector, void *work)
{
    const uint32_t n = detector->state.control->state.problem->inputs,
                   m = detector->state.control->state.problem->outputs;
    pzs_real *at = work, *const columns = at;
    at += PZS_DENSE(n);
    detector->settings.amplitude = at, at += n;
    detector->state.diagonal = at, at += n;
    detector->state.voltage = at, at += (size_t)(detector->state.delay + 1u) * n;
    detector->state.voltage_before = at, at += n;
    detector->state.deviation = at, at += n;
    detector->state.moved = at, at += n;
    detector->state.response = at, at += n;
    detector->state.lost_voltage = at, at += n;
    detector->state.disturbance = at, at += m;
    detector->state.change = at, at += m;
    pzs_linalg_dense_layout(&detector->state.columns, n, columns, at);
    detector->state.electrode =
        (uint8_t *)at + sizeof(uint32_t) * (n / PZS_TILE + 2u) + sizeof(uint16_t) * n;
    detector->state.rest = detector->state.electrode + n;
    detector->state.missing = detector->state.rest + n;
    detector->info.electrode = detector->state.electrode;
}

/* Diagonal of B'W^2 B, 1 where an electrode does nothing; the Hessian's holds the effort besides.
 */
static void take_diagonal(pzs_fault_detector *detector)
{
    const pzs_control *control = detector->state.control;
    const uint32_t n = control->state.problem->inputs;
    for (uint32_t j = 0; j < n; j++) {
        pzs_real sum = 0;
        for (uint32_t i = 0; i < control->state.problem->outputs; i++)
            sum += square(control->state.problem->weight[i] *
                          control->state.influence[(size_t)i * n + j]);
        detector->state.diagonal[j] = sum > 0 ? sum : 1;
        detector->state.electrode[j] = sum > 0 &&
                                               number_is_finite(detector->settings.amplitude[j]) &&
                                               detector->settings.amplitude[j] > 0
                                           ? PZS_ELECTRODE_OBSERVED
                                           : PZS_ELECTRODE_UNOBSERVABLE;
    }
}

/* row [j + 1] = row j of B'W^2 B over the outputs that are not left out, a ridge on its diagonal.
 */
static void form_row(const pzs_fault_detector *detector, uint32_t j, pzs_real *row)
{
    const pzs_control *control = detector->state.control;
    const uint32_t n = control->state.problem->inputs;
    memcpy(row, control->state.optimiser.hessian + (size_t)j * control->state.optimiser.width,
           j * sizeof *row);
    row[j] = detector->state.diagonal[j] * (1 + detector->state.ridge);
    for (uint32_t i = 0; i < control->state.problem->outputs; i++) {
        if (!(detector->state.missing[i] & LEFT_OUT))
            continue;
        const pzs_real *b = control->state.influence + (size_t)i * n,
                       part = square(control->state.problem->weight[i]) * b[j];
        for (uint32_t k = 0; k <= j; k++)
            row[k] -= part * b[k];
    }
}

/* Factor it. Returns whether that can be done. */
static int factor(pzs_fault_detector *detector)
{
    for (uint32_t j = 0; j < detector->state.columns.n; j++) {
        form_row(detector, j, detector->state.deviation);
        for (uint32_t k = 0; k <= j; k++)
            *pzs_linalg_entry(&detector->state.columns, j, k) = detector->state.deviation[k];
    }
    detector->state.is_stale = pzs_linalg_factor(&detector->state.columns).zero >= 0;
    return !detector->state.is_stale;
}

/* An electrode whose volts least squares do not give back is not watched. */
static void find_blind(pzs_fault_detector *detector)
{
    const uint32_t n = detector->state.columns.n;
    for (uint32_t j = 0; j < n; j++) {
        memset(detector->state.deviation, 0, n * sizeof *detector->state.deviation);
        detector->state.deviation[j] = 1;
        pzs_linalg_solve(&detector->state.columns, detector->state.deviation);
        if (!(1 - detector->state.ridge * detector->state.diagonal[j] *
                      detector->state.deviation[j] >
              CLEAR))
            detector->state.electrode[j] = PZS_ELECTRODE_UNOBSERVABLE;
        detector->info.unobservable =
            (uint16_t)(detector->info.unobservable +
                       (detector->state.electrode[j] == PZS_ELECTRODE_UNOBSERVABLE));
    }
    memset(detector->state.deviation, 0, n * sizeof *detector->state.deviation);
}

static pzs_status finish(pzs_fault_detector *detector, pzs_status status, int32_t where)
{
    detector->info.where = where;
    return status;
}

pzs_status pzs_fault_detector_init(pzs_fault_detector *detector, pzs_control *control,
                                   uint16_t delay, void *work, size_t bytes)
{
    if (detector == NULL)
        return PZS_E_ARGUMENT;
    memset(detector, 0, sizeof *detector);
    const pzs_status status = control == NULL || work == NULL || delay > PZS_DELAY_LIMIT
                                  ? PZS_E_ARGUMENT
                              : control->state.stage != CONTROL_READY ? PZS_E_STAGE
                                                                      : PZS_OK;
    if (status != PZS_OK)
        return finish(detector, status, -1);
    const pzs_problem *problem = control->state.problem;
    const size_t need = PZS_FAULT_DETECTOR_BYTES(problem->inputs, problem->outputs, delay);
    const int32_t lacking = guard_missing_bytes(work, bytes, need);
    if (lacking >= 0)
        return finish(detector, PZS_E_WORKSPACE, lacking);
    memset(work, 0, need);
    detector->state.control = control;
    detector->state.delay = delay;
    lay_out(detector, work);
    for (uint32_t j = 0; j < problem->inputs; j++)
        detector->settings.amplitude[j] = default_swing(problem, j);
    const pzs_real least = 4 * (pzs_real)problem->inputs * PZS_EPSILON;
    detector->state.ridge = least > RIDGE ? least : RIDGE;
    take_diagonal(detector);
    if (!factor(detector))
        return finish(detector, PZS_E_NONFINITE, -1);
    find_blind(detector);
    for (uint32_t k = 0; k <= delay; k++)
        memcpy(detector->state.voltage + (size_t)k * problem->inputs, control->state.voltage,
               problem->inputs * sizeof(pzs_real));
    memcpy(detector->state.voltage_before, control->state.voltage,
           problem->inputs * sizeof(pzs_real));
    memset(detector->state.missing, LOST, problem->outputs);
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++)
        detector->state.test[k].input = NOBODY;
    detector->state.stage = READY;
    return finish(detector, PZS_OK, -1);
}

/* ---- response --------------------------------------------------------- */

/*
 * Take the new disturbance; change = W^2 times what it changed by since the last shape, zero where
 * either has no measurement. Returns whether both have enough to tell electrodes apart.
 */
static int compare(pzs_fault_detector *detector, const pzs_real *measured)
{
    const pzs_control *control = detector->state.control;
    const uint32_t m = control->state.problem->outputs;
    uint32_t out = 0;
    for (uint32_t i = 0; i < m; i++) {
        const int lost = sense_lost(&control->state.repeats[i], measured[i]),
                  left_out = lost || (detector->state.missing[i] & LOST);
        const pzs_real change = control->state.disturbance[i] - detector->state.disturbance[i];
        detector->state.change[i] =
            left_out ? 0 : square(control->state.problem->weight[i]) * change;
        detector->state.disturbance[i] = control->state.disturbance[i];
        detector->state.is_stale |= !left_out != !(detector->state.missing[i] & LEFT_OUT);
        detector->state.missing[i] = (uint8_t)((lost ? LOST : 0) | (left_out ? LEFT_OUT : 0));
        out += left_out ? 1u : 0u;
    }
    return MISSING * out <= m && (!detector->state.is_stale || factor(detector));
}

/* Fewer measurements than can be left out: the last shape still stands. */
static int too_few(const pzs_fault_detector *detector, const pzs_real *measured)
{
    const pzs_control *control = detector->state.control;
    uint32_t lost = 0;
    for (uint32_t i = 0; i < control->state.problem->outputs; i++)
        lost += sense_lost(&control->state.repeats[i], measured[i]) ? 1u : 0u;
    return MISSING * lost > control->state.problem->outputs;
}

/* The volts that made the shape now looked at: the oldest kept. */
static pzs_real *oldest_volts(const pzs_fault_detector *detector)
{
    return detector->state.voltage +
           (size_t)detector->state.oldest * detector->state.control->state.problem->inputs;
}

/* Those of this tick take their place. */
static void keep_volts(pzs_fault_detector *detector)
{
    memcpy(oldest_volts(detector), detector->state.control->state.voltage,
           detector->state.control->state.problem->inputs * sizeof(pzs_real));
    detector->state.oldest =
        (uint16_t)(detector->state.oldest < detector->state.delay ? detector->state.oldest + 1u
                                                                  : 0);
}

/* answer = f; sums of moves and responses, and what each electrode has lost. Returns |f|^2. */
static pzs_real respond(pzs_fault_detector *detector, const pzs_real *voltage)
{
    const pzs_control *control = detector->state.control;
    const uint32_t n = control->state.problem->inputs;
    pzs_real all = 0;
    pzs_product_sum_rows(detector->state.deviation, control->state.influence, n,
                         detector->state.change, control->state.problem->outputs, n);
    pzs_linalg_solve(&detector->state.columns, detector->state.deviation);
    for (uint32_t j = 0; j < n; j++) {
        const pzs_real move = voltage[j] - detector->state.voltage_before[j],
                       most = 2 * number_absolute(move);
        all += square(detector->state.deviation[j]);
        detector->state.moved[j] = KEPT * detector->state.moved[j] + square(move);
        detector->state.response[j] =
            KEPT * detector->state.response[j] +
            square(number_clamp(move + detector->state.deviation[j], -most, most));
        detector->state.lost_voltage[j] =
            KEPT * detector->state.lost_voltage[j] + detector->state.deviation[j];
    }
    return all;
}

/* ---- probes ----------------------------------------------------------- */

static int held(const pzs_control *control, uint32_t j)
{
    return !(control->state.lower[j] < control->state.upper[j]);
}

/* Most of its volts gone in one tick, and no other lost as much: all = |f|^2. */
static int just_died(const pzs_fault_detector *detector, uint32_t j, pzs_real voltage, pzs_real all)
{
    const pzs_real gone =
                       voltage < 0 ? detector->state.deviation[j] : -detector->state.deviation[j],
                   most = number_absolute(voltage);
    return gone > 2 * detector->settings.amplitude[j] && gone > PZS_R(0.4) * most &&
           gone < PZS_R(1.6) * most && 4 * square(gone) >= all;
}

/* How suspicious an electrode is (V^2), 0 where not. */
static pzs_real suspicion(const pzs_fault_detector *detector, uint32_t j, pzs_real voltage,
                          pzs_real all)
{
    if (detector->state.electrode[j] != PZS_ELECTRODE_OBSERVED || held(detector->state.control, j))
        return 0;
    if (just_died(detector, j, voltage, all))
        return square(detector->state.deviation[j]);
    return detector->state.moved[j] >= 4 * square(detector->settings.amplitude[j]) &&
                   SILENT * detector->state.response[j] < detector->state.moved[j]
               ? detector->state.moved[j]
               : 0;
}

/* Begin a probe of input j around its volts, far enough from its limits. */
static void begin(pzs_fault_detector *detector, pzs_test_signal *test, uint32_t j,
                  const pzs_real *voltage)
{
    const pzs_control *control = detector->state.control;
    const pzs_test_signal fresh = {
        .input = (uint16_t)j, .lower = control->state.lower[j], .upper = control->state.upper[j]};
    *test = fresh;
    test->middle = number_clamp(control->state.voltage[j],
                                control->state.lower[j] + detector->settings.amplitude[j],
                                control->state.upper[j] - detector->settings.amplitude[j]);
    test->is_dead =
        voltage[j] * detector->state.lost_voltage[j] < 0 &&
        2 * number_absolute(detector->state.lost_voltage[j]) > number_absolute(voltage[j]);
    detector->state.electrode[j] = PZS_ELECTRODE_TESTED;
}

static int is_wide(const pzs_fault_detector *detector, uint32_t j)
{
    return detector->state.control->state.upper[j] - detector->state.control->state.lower[j] >
           4 * detector->settings.amplitude[j];
}

/* The most suspicious electrodes into the places that are free. */
static void suspect(pzs_fault_detector *detector, const pzs_real *voltage, pzs_real all)
{
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_real most = 0;
        uint32_t who = NOBODY;
        for (uint32_t j = 0; detector->state.test[k].input == NOBODY &&
                             j < detector->state.control->state.problem->inputs;
             j++) {
            const pzs_real now = suspicion(detector, j, voltage[j], all);
            who = now > most && is_wide(detector, j) ? j : who;
            most = now > most && is_wide(detector, j) ? now : most;
        }
        if (who != NOBODY)
            begin(detector, &detector->state.test[k], who, voltage);
    }
}

/* Hold the suspects at their next volts, inside their limits whatever the swing was changed to. */
static void swing_all(pzs_fault_detector *detector)
{
    pzs_control *control = detector->state.control;
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_test_signal *test = &detector->state.test[k];
        const uint32_t j = test->input;
        if (j == NOBODY)
            continue;
        test->is_upper = !test->is_upper;
        const pzs_real wish = test->middle + (test->is_upper ? detector->settings.amplitude[j]
                                                             : -detector->settings.amplitude[j]);
        test->set = number_clamp(number_is_finite(wish) ? wish : control->state.voltage[j],
                                 test->lower, test->upper);
        control->state.lower[j] = control->state.upper[j] = test->set;
    }
}

/* Leave an electrode alone for a while. */
static void clear(pzs_fault_detector *detector, uint32_t j)
{
    detector->state.electrode[j] = PZS_ELECTRODE_CLEARED;
    detector->state.rest[j] = REST;
}

/* End a test: the electrode gets its limits back. */
static void release(pzs_fault_detector *detector, pzs_test_signal *test)
{
    const uint32_t j = test->input;
    detector->state.control->state.lower[j] = test->lower;
    detector->state.control->state.upper[j] = test->upper;
    clear(detector, j);
    test->input = NOBODY;
}

/*
 * Held from now on where it is believed to be, dead at 0 V: volts and prediction agree with what
 * the structure has, so that the next step has nothing to make up for but what the electrode no
 * longer does.
 */
static void remove(pzs_fault_detector *detector, pzs_test_signal *test)
{
    pzs_control *control = detector->state.control;
    const uint32_t j = test->input;
    control->state.voltage[j] =
        test->is_dead ? number_clamp(0, test->lower, test->upper) : control->state.voltage[j];
    control->state.lower[j] = control->state.upper[j] = control->state.voltage[j];
    pzs_control_moved(control);
    detector->state.electrode[j] = PZS_ELECTRODE_HELD;
    detector->info.found++;
    test->input = NOBODY;
}

/* Moves of the probe and responses to them, about their means: was there any response? */
static int silent(const pzs_test_signal *test)
{
    const pzs_real n = (pzs_real)test->moves;
    const pzs_real moves = test->square - square(test->sum) / n;
    const pzs_real responses = test->response_square - square(test->response_sum) / n;
    return SILENT * responses <= moves;
}

/* One more shape for a probe: go on, or come to an end. Returns whether the electrode was found. */
static int examine(pzs_fault_detector *detector, pzs_test_signal *test, const pzs_real *voltage)
{
    const uint32_t j = test->input;
    const pzs_real move = voltage[j] - detector->state.voltage_before[j],
                   response = move + detector->state.deviation[j];
    test->shapes++;
    if (number_absolute(move) >= detector->settings.amplitude[j]) {
        test->moves++;
        test->sum += move;
        test->square += square(move);
        test->response_sum += response;
        test->response_square += square(response);
    }
    const int ends = test->moves == MOVES, found = ends && silent(test);
    if (found)
        remove(detector, test);
    else if (ends || test->shapes == PATIENCE)
        release(detector, test);
    return found;
}

/* Someone else held or released the electrode meanwhile. */
static int taken(const pzs_fault_detector *detector, const pzs_test_signal *test)
{
    const pzs_control *control = detector->state.control;
    const uint32_t j = test->input;
    return control->state.lower[j] < test->set || control->state.lower[j] > test->set ||
           control->state.upper[j] > test->set;
}

/* All probes, by one shape. Returns the first input found, or -1. */
static int32_t run_probes(pzs_fault_detector *detector, const pzs_real *voltage)
{
    int32_t first = -1;
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_test_signal *test = &detector->state.test[k];
        const uint32_t j = test->input;
        if (j == NOBODY)
            continue;
        if (taken(detector, test)) {
            clear(detector, j);
            test->input = NOBODY;
        } else if (examine(detector, test, voltage) && first < 0) {
            first = (int32_t)j;
        }
    }
    return first;
}

static void rest(pzs_fault_detector *detector)
{
    for (uint32_t j = 0; j < detector->state.control->state.problem->inputs; j++) {
        if (detector->state.electrode[j] == PZS_ELECTRODE_CLEARED && --detector->state.rest[j] == 0)
            detector->state.electrode[j] = PZS_ELECTRODE_OBSERVED;
        if (detector->state.electrode[j] == PZS_ELECTRODE_HELD && !held(detector->state.control, j))
            detector->state.electrode[j] = PZS_ELECTRODE_OBSERVED; /* released: another chance */
    }
}

/* All that one shape tells. Returns the first input found, or -1. */
static int32_t judge(pzs_fault_detector *detector, const pzs_real *voltage)
{
    const pzs_real all = respond(detector, voltage);
    const int32_t first = run_probes(detector, voltage);
    suspect(detector, voltage, all);
    rest(detector);
    swing_all(detector);
    return first;
}

pzs_status pzs_fault_detector_tick(pzs_fault_detector *detector, const pzs_real *measured)
{
    if (detector == NULL)
        return PZS_E_ARGUMENT;
    if (detector->state.stage != READY)
        return PZS_E_STAGE;
    const pzs_real *voltage = oldest_volts(detector);
    int32_t first = -1;
    if (measured != NULL && !too_few(detector, measured)) {
        if (compare(detector, measured))
            first = judge(detector, voltage);
        memcpy(detector->state.voltage_before, voltage,
               detector->state.columns.n * sizeof(pzs_real));
    }
    keep_volts(detector);
    return first >= 0 ? finish(detector, PZS_W_ELECTRODE, first) : finish(detector, PZS_OK, -1);
}

/* ---- block ------------------------------------------------------------ */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_fault_detection *t = tables;
    return PZS_FAULT_DETECTOR_BLOCK_BYTES(problem->inputs, problem->outputs, t->delay);
}

/* The amplitude of the tables, cut as the default is; electrodes that cannot be moved keep 0. */
static void set_amplitude(pzs_fault_detector *detector, pzs_real amplitude)
{
    const pzs_problem *problem = detector->state.control->state.problem;
    for (uint32_t j = 0; j < problem->inputs; j++) {
        const pzs_real most = PZS_R(0.49) * problem->step_limit[j];
        detector->settings.amplitude[j] = amplitude < most ? amplitude : most;
    }
}

/* In `self`: the detector, its workspace. */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_fault_detection *t = tables;
    const pzs_problem *problem = signals->control->state.problem;
    pzs_fault_detector *detector = self;
    void *work = (uint8_t *)self + PZS_ALIGNED(sizeof *detector);
    if (!(t->amplitude >= 0) || !number_is_finite(t->amplitude))
        return PZS_E_ARGUMENT;
    const pzs_status status = pzs_fault_detector_init(
        detector, signals->control, t->delay, work,
        PZS_FAULT_DETECTOR_BYTES(problem->inputs, problem->outputs, t->delay));
    signals->where = detector->info.where;
    if (status == PZS_OK && t->amplitude > 0)
        set_amplitude(detector, t->amplitude);
    return status;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_fault_detector *detector = self;
    const pzs_status status = pzs_fault_detector_tick(detector, signals->measured);
    signals->electrode = detector->info.electrode;
    signals->where = detector->info.where;
    return status;
}

const pzs_block_type pzs_fault_detector_block = {"fault_detector", PZS_PHASE_OBSERVE, block_bytes,
                                                 block_init, block_tick};
