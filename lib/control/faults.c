/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Fault detector for structures that do not vibrate: finds, from the measured shape, electrodes
 * whose voltage does not follow their amplifier.
 *
 * Between two measured shapes the commanded voltages change by x, and the disturbance (measured
 * minus predicted shape) changes by
 *   B f + load
 *   B  influence matrix
 *   f  voltages by which the effects of the electrodes exceed their commands, estimated by least
 *      squares; x + f is about x if an electrode follows, otherwise about 0
 *
 * Work of a tick for m outputs and n inputs: (m + n) n multiply-adds and less than 40 (m + n) other
 * operations; m n^2 / 16 + n^3 / 6 more where measurements become missing or return.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../core/product.h"
#include "sensor_check.h"
#include "../core/numbers.h"

#define READY 1u
/*
 * Factor by which a new measured shape multiplies the fault detector's old sums of squared voltage
 * changes of each electrode, so that old changes are gradually forgotten. The changes are those
 * that were commanded and those that the shape indicates.
 */
#define FADING PZS_R(0.75)
/*
 * An electrode counts as not responding if this number times the sum of squares of the voltage
 * changes that the measured shape indicates is below the sum of squares of its commanded changes.
 */
#define NO_RESPONSE 16
/*
 * Smallest regularisation weight when electrode voltages are estimated from the measured shape by
 * least squares, relative to the diagonal of the normal matrix (dimensionless).
 */
#define LEAST_RIDGE PZS_R(1e-5)
/*
 * An electrode is observable if the least-squares estimate of electrode voltages finds more than
 * this part of 1 V on it in the shape that 1 V on this electrode alone makes.
 */
#define OBSERVABLE PZS_R(0.75)
/* Number of voltage changes by which the fault detector tests an electrode. */
#define TEST_MOVES 8u
/*
 * Largest number of measured shapes in a test of an electrode, after which the test ends even if
 * not all its voltage changes were made.
 */
#define TEST_SHAPES 24u
/* Number of measured shapes for which an electrode that has passed a test is not tested again. */
#define CLEARED_SHAPES 100u

/* Input number of a test signal that marks the test signal as unused. */
#define NO_INPUT 0xFFFFu

/*
 * The fault detector works only while at most a fixed part (1/MISSING_LIMIT) of all outputs have no
 * measurement.
 */
#define MISSING_LIMIT 8u

/*
 * Bits of state.missing, which has an entry for each output. NOT_MEASURED: the last measured shape
 * has no value of the output. EXCLUDED: the least-squares estimate of electrode voltages does not
 * use the output.
 */
enum { NOT_MEASURED = 1, EXCLUDED = 2 };

static pzs_real square(pzs_real number)
{
    return number * number;
}

/* ---- initialisation -------------------------------------------------- */

/*
 * Return the default amplitude of a test signal of electrode j (V): just below half the step limit,
 * but at most 1/32 of the voltage range. The factor 0.49 instead of 0.5 leaves room for rounding
 * errors.
 */
static pzs_real default_amplitude(const pzs_problem *problem, uint32_t j)
{
    const pzs_real range = (problem->upper[j] - problem->lower[j]) / 16,
                   whole = problem->step_limit[j] < range ? problem->step_limit[j] : range;
    return PZS_R(0.49) * whole;
}

/*
 * Reserve memory for `count` real numbers in the workspace of the fault detector and return its
 * address. `next` is the address of the free memory.
 */
static pzs_real *take_reals(pzs_real **next, size_t count)
{
    pzs_real *const taken = *next;
    *next += count;
    return taken;
}

static void lay_out(pzs_fault_detector *detector, void *work)
{
    const uint32_t inputs = detector->state.control->state.problem->inputs,
                   outputs = detector->state.control->state.problem->outputs;
    pzs_real *next = work;
    pzs_real *const columns = take_reals(&next, PZS_DENSE(inputs));
    detector->settings.amplitude = take_reals(&next, inputs);
    detector->state.diagonal = take_reals(&next, inputs);
    detector->state.voltage = take_reals(&next, (size_t)(detector->state.delay + 1u) * inputs);
    detector->state.voltage_before = take_reals(&next, inputs);
    detector->state.deviation = take_reals(&next, inputs);
    detector->state.moved = take_reals(&next, inputs);
    detector->state.response = take_reals(&next, inputs);
    detector->state.lost_voltage = take_reals(&next, inputs);
    detector->state.disturbance = take_reals(&next, outputs);
    detector->state.change = take_reals(&next, outputs);
    pzs_linalg_dense_layout(&detector->state.columns, inputs, columns, next);
    detector->state.electrode =
        (uint8_t *)next + sizeof(uint32_t) * (inputs / PZS_TILE + 2u) + sizeof(uint16_t) * inputs;
    detector->state.pause = detector->state.electrode + inputs;
    detector->state.missing = detector->state.pause + inputs;
    detector->info.electrode = detector->state.electrode;
}

/* Set the pointers of the fault detector to its controller and to its arrays in the workspace. */
static void place(pzs_fault_detector *detector, pzs_control *control, uint16_t delay, void *work)
{
    detector->state.control = control;
    detector->state.delay = delay;
    if (detector->state.oldest > delay)
        detector->state.oldest = 0;
    lay_out(detector, work);
    guard_repair_bool(&detector->state.is_stale);
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_test_signal *test = &detector->state.test[k];
        test->input = test->input < control->state.problem->inputs ? test->input : NO_INPUT;
        guard_repair_bool(&test->is_upper);
        guard_repair_bool(&test->is_dead);
    }
}

/*
 * Compute the diagonal entry of the matrix B'W^2 B for each electrode, with the influence matrix B
 * and the output weights W; for an electrode that has no effect on the shape, set it to 1. The
 * diagonal of the Hessian cannot be used instead because it contains the regularisation.
 */
static void find_diagonal(pzs_fault_detector *detector)
{
    const pzs_control *control = detector->state.control;
    const uint32_t inputs = control->state.problem->inputs;
    for (uint32_t j = 0; j < inputs; j++) {
        pzs_real sum = 0;
        for (uint32_t i = 0; i < control->state.problem->outputs; i++)
            sum += square(control->state.problem->weight[i] *
                          control->state.influence[(size_t)i * inputs + j]);
        detector->state.diagonal[j] = sum > 0 ? sum : 1;
        const pzs_real amplitude = detector->settings.amplitude[j];
        const bool can_move = number_is_finite(amplitude) && amplitude > 0;
        detector->state.electrode[j] =
            sum > 0 && can_move ? PZS_ELECTRODE_OBSERVED : PZS_ELECTRODE_UNOBSERVABLE;
    }
}

/*
 * Compute the entries 0 to j in row j of the matrix by which the fault detector estimates electrode
 * voltages from the measured shape (least squares). It is B'W^2 B over the outputs that are not
 * excluded, plus the regularisation of the diagonal, with the influence matrix B and the output
 * weights W.
 */
static void form_row(const pzs_fault_detector *detector, uint32_t j, pzs_real *row)
{
    const pzs_control *control = detector->state.control;
    const uint32_t inputs = control->state.problem->inputs;
    memcpy(row, control->state.optimiser.hessian + (size_t)j * control->state.optimiser.width,
           j * sizeof *row);
    row[j] = detector->state.diagonal[j] * (1 + detector->state.ridge);
    for (uint32_t i = 0; i < control->state.problem->outputs; i++) {
        if (!(detector->state.missing[i] & EXCLUDED))
            continue;
        const pzs_real *column = control->state.influence + (size_t)i * inputs,
                       part = square(control->state.problem->weight[i]) * column[j];
        for (uint32_t k = 0; k <= j; k++)
            row[k] -= part * column[k];
    }
}

/*
 * Compute and factor the matrix by which the fault detector estimates electrode voltages from the
 * measured shape (least squares). Returns whether the matrix is regular.
 */
static bool factor_matrix(pzs_fault_detector *detector)
{
    for (uint32_t j = 0; j < detector->state.columns.n; j++) {
        form_row(detector, j, detector->state.deviation);
        for (uint32_t k = 0; k <= j; k++)
            *pzs_linalg_entry(&detector->state.columns, j, k) = detector->state.deviation[k];
    }
    detector->state.is_stale = pzs_linalg_factor(&detector->state.columns).zero >= 0;
    return !detector->state.is_stale;
}

/*
 * Mark the electrodes that are not observable: those for which the least-squares estimate of
 * electrode voltages returns at most a fixed part (OBSERVABLE) of a volt from the shape that 1 V on
 * this electrode alone makes.
 */
static void find_unobservable(pzs_fault_detector *detector)
{
    const uint32_t inputs = detector->state.columns.n;
    for (uint32_t j = 0; j < inputs; j++) {
        memset(detector->state.deviation, 0, inputs * sizeof *detector->state.deviation);
        detector->state.deviation[j] = 1;
        pzs_linalg_solve(&detector->state.columns, detector->state.deviation);
        if (!(1 - detector->state.ridge * detector->state.diagonal[j] *
                      detector->state.deviation[j] >
              OBSERVABLE))
            detector->state.electrode[j] = PZS_ELECTRODE_UNOBSERVABLE;
        detector->info.unobservable =
            (uint16_t)(detector->info.unobservable +
                       (detector->state.electrode[j] == PZS_ELECTRODE_UNOBSERVABLE));
    }
    memset(detector->state.deviation, 0, inputs * sizeof *detector->state.deviation);
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
    if (control == NULL || work == NULL || delay > PZS_DELAY_LIMIT)
        return finish(detector, PZS_E_ARGUMENT, -1);
    if (control->state.stage != CONTROL_READY)
        return finish(detector, PZS_E_STAGE, -1);
    const pzs_problem *problem = control->state.problem;
    /*
     * The fault detector is refused where weighted sums of voltages are limited: a test signal
     * changes the voltage of one input alone and could violate such a limit.
     */
    if (problem->limit_rows != NULL)
        return finish(detector, PZS_E_ARGUMENT, -1);
    /*
     * The fault detector is refused for a sparse influence matrix, because it reads columns of the
     * full matrix.
     */
    if (control->state.influence == NULL)
        return finish(detector, PZS_E_ARGUMENT, -1);
    const size_t need = PZS_FAULT_DETECTOR_BYTES(problem->inputs, problem->outputs, delay);
    const int32_t missing = guard_missing_bytes(work, bytes, need);
    if (missing >= 0)
        return finish(detector, PZS_E_WORKSPACE, missing);
    memset(work, 0, need);
    place(detector, control, delay, work);
    for (uint32_t j = 0; j < problem->inputs; j++)
        detector->settings.amplitude[j] = default_amplitude(problem, j);
    const pzs_real least = 4 * (pzs_real)problem->inputs * PZS_EPSILON;
    detector->state.ridge = least > LEAST_RIDGE ? least : LEAST_RIDGE;
    find_diagonal(detector);
    if (!factor_matrix(detector))
        return finish(detector, PZS_E_NONFINITE, -1);
    find_unobservable(detector);
    for (uint32_t k = 0; k <= delay; k++)
        memcpy(detector->state.voltage + (size_t)k * problem->inputs, control->state.voltage,
               problem->inputs * sizeof(pzs_real));
    memcpy(detector->state.voltage_before, control->state.voltage,
           problem->inputs * sizeof(pzs_real));
    memset(detector->state.missing, NOT_MEASURED, problem->outputs);
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++)
        detector->state.test[k].input = NO_INPUT;
    detector->state.stage = READY;
    return finish(detector, PZS_OK, -1);
}

/* ---- response of the electrodes -------------------------------------- */

/*
 * Update the disturbance (measured minus predicted shape) and state.change, its change since the
 * last measured shape times the squared output weights. The change is zero for an output that was
 * not measured in both shapes. Returns whether enough outputs were measured in both shapes.
 */
static bool update_disturbance(pzs_fault_detector *detector)
{
    const pzs_control *control = detector->state.control;
    const uint32_t outputs = control->state.problem->outputs;
    uint32_t excluded = 0;
    for (uint32_t i = 0; i < outputs; i++) {
        const bool is_missing = sensor_is_unusable(control->state.repeats[i]);
        const bool is_excluded = is_missing || (detector->state.missing[i] & NOT_MEASURED);
        const pzs_real change = control->state.disturbance[i] - detector->state.disturbance[i];
        detector->state.change[i] =
            is_excluded ? 0 : square(control->state.problem->weight[i]) * change;
        detector->state.disturbance[i] = control->state.disturbance[i];
        const bool was_excluded = (detector->state.missing[i] & EXCLUDED) != 0;
        detector->state.is_stale |= is_excluded != was_excluded;
        const unsigned missing_bit = is_missing ? NOT_MEASURED : 0u;
        const unsigned excluded_bit = is_excluded ? EXCLUDED : 0u;
        detector->state.missing[i] = (uint8_t)(missing_bit | excluded_bit);
        excluded += is_excluded ? 1u : 0u;
    }
    return MISSING_LIMIT * excluded <= outputs &&
           (!detector->state.is_stale || factor_matrix(detector));
}

/*
 * Whether too few outputs (displacements) of the structure have a measurement in this tick. The
 * fault detector then ignores the measured shape, and compares the next one with the last shape
 * that it used.
 */
static bool has_too_few(const pzs_fault_detector *detector)
{
    const pzs_control *control = detector->state.control;
    uint32_t missing = 0;
    for (uint32_t i = 0; i < control->state.problem->outputs; i++)
        missing += sensor_is_unusable(control->state.repeats[i]) ? 1u : 0u;
    return MISSING_LIMIT * missing > control->state.problem->outputs;
}

/*
 * Return the voltages [inputs] that were applied when the measured shape was taken, `delay` ticks
 * ago: the oldest of the stored voltages.
 */
static pzs_real *oldest_voltages(const pzs_fault_detector *detector)
{
    return detector->state.voltage +
           (size_t)detector->state.oldest * detector->state.control->state.problem->inputs;
}

/*
 * Store the voltages of one tick in the ring buffer of the voltages of the last ticks, in place of
 * the oldest voltages.
 *   voltage [inputs] in  voltages of the tick (V)
 */
static void store_voltages(pzs_fault_detector *detector, const pzs_real *voltage)
{
    memcpy(oldest_voltages(detector), voltage,
           detector->state.control->state.problem->inputs * sizeof(pzs_real));
    detector->state.oldest =
        (uint16_t)(detector->state.oldest < detector->state.delay ? detector->state.oldest + 1u
                                                                  : 0);
}

/*
 * Return an exponentially decaying sum of the fault detector after it has decayed once and a new
 * term was added. If damaged memory has made the sum infinite or NaN, it starts anew with the term.
 */
static pzs_real faded_sum(pzs_real sum, pzs_real term)
{
    const pzs_real next = FADING * sum + term;
    return number_is_finite(next) ? next : term;
}

/*
 * Estimate by least squares, into state.deviation, the voltage change of each electrode that the
 * shape indicates minus its commanded change (V). Also update three exponentially decaying sums for
 * each electrode: of its squared commanded changes (state.moved), of its squared indicated changes
 * (state.response), and of its deviations (state.lost_voltage). Returns the sum of the squared
 * deviations (V2).
 */
static pzs_real update_responses(pzs_fault_detector *detector, const pzs_real *voltage)
{
    const pzs_control *control = detector->state.control;
    const uint32_t inputs = control->state.problem->inputs;
    pzs_real deviation2 = 0;
    pzs_product_sum_rows(detector->state.deviation, control->state.influence, inputs,
                         detector->state.change, control->state.problem->outputs, inputs);
    pzs_linalg_solve(&detector->state.columns, detector->state.deviation);
    for (uint32_t j = 0; j < inputs; j++) {
        const pzs_real move = voltage[j] - detector->state.voltage_before[j],
                       limit = 2 * number_absolute(move);
        deviation2 += square(detector->state.deviation[j]);
        detector->state.moved[j] = faded_sum(detector->state.moved[j], square(move));
        detector->state.response[j] =
            faded_sum(detector->state.response[j],
                      square(number_clamp(move + detector->state.deviation[j], -limit, limit)));
        detector->state.lost_voltage[j] =
            faded_sum(detector->state.lost_voltage[j], detector->state.deviation[j]);
    }
    return deviation2;
}

/* ---- test signals of suspected electrodes ---------------------------- */

/*
 * An electrode is suspected of not following its amplifier in two cases:
 *   - Its voltage was changed by at least the amplitude of a test signal, and the shape hardly
 *     responded: it is stuck, or was dead before.
 *   - The shape jumped as if the voltage of this electrode, more than that of any other, had
 *     vanished: it has just died.
 *
 * A load may look like either case. The suspected electrode is therefore set to two voltages in
 * turn, one amplitude above and below its voltage, inside all limits. It is faulty if the shape
 * does not respond; a load does not change in the rhythm of this test.
 */

static bool is_held(const pzs_control *control, uint32_t j)
{
    return !(control->state.lower[j] < control->state.upper[j]);
}

/*
 * Whether electrode j seems to have lost about all of its voltage since the last shape. The loss
 * that the least-squares estimate finds must be 40 % to 160 % of the voltage, and at least half of
 * the norm of the deviations of all electrodes.
 *   deviation2 in  sum over all electrodes of the squared differences between indicated and
 *                  commanded voltage changes (V2)
 */
static bool has_just_failed(const pzs_fault_detector *detector, uint32_t j, pzs_real voltage,
                            pzs_real deviation2)
{
    const pzs_real loss =
                       voltage < 0 ? detector->state.deviation[j] : -detector->state.deviation[j],
                   limit = number_absolute(voltage);
    return loss > 2 * detector->settings.amplitude[j] && loss > PZS_R(0.4) * limit &&
           loss < PZS_R(1.6) * limit && 4 * square(loss) >= deviation2;
}

/*
 * Return how strongly electrode j is suspected of a fault (V2); the electrode with the largest
 * value is tested first.
 *   0                                             not suspected
 *   squared voltage that seems to be lost         if it is about the whole voltage
 *   sum of the squared commanded voltage changes  otherwise, if the electrode hardly responds
 */
static pzs_real suspicion(const pzs_fault_detector *detector, uint32_t j, pzs_real voltage,
                          pzs_real deviation2)
{
    if (detector->state.electrode[j] != PZS_ELECTRODE_OBSERVED ||
        is_held(detector->state.control, j))
        return 0;
    if (has_just_failed(detector, j, voltage, deviation2))
        return square(detector->state.deviation[j]);
    const bool has_moved = detector->state.moved[j] >= 4 * square(detector->settings.amplitude[j]);
    const bool is_silent = NO_RESPONSE * detector->state.response[j] < detector->state.moved[j];
    return has_moved && is_silent ? detector->state.moved[j] : 0;
}

/*
 * Start a test of electrode j, in which its voltage alternates by one amplitude above and below a
 * mean voltage. The mean is the present voltage or, if that is nearer to a limit than the
 * amplitude, the nearest voltage that is far enough from the limit.
 */
static void start_test(pzs_fault_detector *detector, pzs_test_signal *test, uint32_t j,
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

static bool has_room(const pzs_fault_detector *detector, uint32_t j)
{
    return detector->state.control->state.upper[j] - detector->state.control->state.lower[j] >
           4 * detector->settings.amplitude[j];
}

/*
 * Start tests of the electrodes that are most suspected of being faulty, as long as fewer than
 * PZS_TEST_SIGNALS electrodes are under test.
 */
static void start_tests(pzs_fault_detector *detector, const pzs_real *voltage, pzs_real deviation2)
{
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_real largest = 0;
        uint32_t suspect = NO_INPUT;
        for (uint32_t j = 0; detector->state.test[k].input == NO_INPUT &&
                             j < detector->state.control->state.problem->inputs;
             j++) {
            const pzs_real now = suspicion(detector, j, voltage[j], deviation2);
            if (now > largest && has_room(detector, j)) {
                suspect = j;
                largest = now;
            }
        }
        if (suspect != NO_INPUT)
            start_test(detector, &detector->state.test[k], suspect, voltage);
    }
}

/*
 * Set the voltage of each electrode under test for the next tick: both its voltage limits become
 * the test voltage. The test voltage is clamped to the voltage limits that held before the test,
 * because the program may have changed the amplitude since.
 */
static void set_test_voltages(pzs_fault_detector *detector)
{
    pzs_control *control = detector->state.control;
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_test_signal *test = &detector->state.test[k];
        const uint32_t j = test->input;
        if (j == NO_INPUT)
            continue;
        test->is_upper = !test->is_upper;
        const pzs_real amplitude = detector->settings.amplitude[j];
        const pzs_real voltage = test->middle + (test->is_upper ? amplitude : -amplitude);
        test->set = number_clamp(number_is_finite(voltage) ? voltage : control->state.voltage[j],
                                 test->lower, test->upper);
        control->state.lower[j] = test->set;
        control->state.upper[j] = test->set;
        pzs_control_set_held(control, j, test->set);
    }
}

/*
 * Mark an electrode that has passed a test, so that the fault detector does not test it again for
 * CLEARED_SHAPES measured shapes.
 */
static void mark_cleared(pzs_fault_detector *detector, uint32_t j)
{
    // The exponentially decaying sums of the electrode's voltage changes start anew. A sum that
    // damaged memory has made very large would otherwise raise suspicion, and thus start a test,
    // again and again.
    detector->state.moved[j] = 0;
    detector->state.response[j] = 0;
    detector->state.lost_voltage[j] = 0;
    detector->state.electrode[j] = PZS_ELECTRODE_CLEARED;
    detector->state.pause[j] = CLEARED_SHAPES;
}

/*
 * End the fault detector's test of an electrode that found no fault, and restore the voltage limits
 * of the electrode.
 */
static void end_test(pzs_fault_detector *detector, pzs_test_signal *test)
{
    const uint32_t j = test->input;
    detector->state.control->state.lower[j] = test->lower;
    detector->state.control->state.upper[j] = test->upper;
    pzs_control_set_held(detector->state.control, j, (pzs_real)NAN);
    mark_cleared(detector, j);
    test->input = NO_INPUT;
}

/*
 * Fix the voltage of a faulty electrode in the controller at the value that it probably has: 0 V
 * for a dead electrode, the present voltage for a stuck one. The predicted shape then agrees with
 * the structure, and the controller only has to compensate for the lost effect of the electrode.
 */
static void hold_electrode(pzs_fault_detector *detector, pzs_test_signal *test)
{
    pzs_control *control = detector->state.control;
    const uint32_t j = test->input;
    control->state.voltage[j] =
        test->is_dead ? number_clamp(0, test->lower, test->upper) : control->state.voltage[j];
    control->state.lower[j] = control->state.voltage[j];
    control->state.upper[j] = control->state.voltage[j];
    pzs_control_set_held(control, j, control->state.voltage[j]);
    control->state.faulty[j] = 1;
    pzs_control_moved(control);
    detector->state.electrode[j] = PZS_ELECTRODE_HELD;
    detector->info.found++;
    test->input = NO_INPUT;
}

/*
 * Whether the electrode under test did not respond. The variance of the voltage changes that the
 * measured shapes indicate is compared with the variance of the commanded changes.
 */
static bool has_no_response(const pzs_test_signal *test)
{
    const pzs_real count = (pzs_real)test->moves;
    const pzs_real moves = test->square - square(test->sum) / count;
    const pzs_real responses = test->response_square - square(test->response_sum) / count;
    return NO_RESPONSE * responses <= moves;
}

/*
 * Add one measured shape to the test of an electrode. The test ends after a fixed number of
 * voltage changes (TEST_MOVES) or of shapes (TEST_SHAPES). Returns whether the electrode is faulty.
 */
static bool continue_test(pzs_fault_detector *detector, pzs_test_signal *test,
                          const pzs_real *voltage)
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
    const bool ends = test->moves == TEST_MOVES;
    const bool is_faulty = ends && has_no_response(test);
    if (is_faulty)
        hold_electrode(detector, test);
    else if (ends || test->shapes == TEST_SHAPES)
        end_test(detector, test);
    return is_faulty;
}

/*
 * Whether the program has changed the voltage limits of an electrode during the test by the fault
 * detector, by a call of pzs_hold or pzs_release.
 */
static bool is_overridden(const pzs_fault_detector *detector, const pzs_test_signal *test)
{
    const pzs_control *control = detector->state.control;
    const uint32_t j = test->input;
    return control->state.lower[j] < test->set || control->state.lower[j] > test->set ||
           control->state.upper[j] > test->set;
}

/*
 * Add one measured shape to all running tests of electrodes. Returns the first input whose
 * electrode is found faulty, or -1.
 */
static int32_t run_tests(pzs_fault_detector *detector, const pzs_real *voltage)
{
    int32_t first = -1;
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS; k++) {
        pzs_test_signal *test = &detector->state.test[k];
        const uint32_t j = test->input;
        if (j == NO_INPUT)
            continue;
        if (is_overridden(detector, test)) {
            mark_cleared(detector, j);
            test->input = NO_INPUT;
        } else if (continue_test(detector, test, voltage) && first < 0) {
            first = (int32_t)j;
        }
    }
    return first;
}

static void update_states(pzs_fault_detector *detector)
{
    for (uint32_t j = 0; j < detector->state.control->state.problem->inputs; j++) {
        if (detector->state.electrode[j] == PZS_ELECTRODE_CLEARED &&
            --detector->state.pause[j] == 0)
            detector->state.electrode[j] = PZS_ELECTRODE_OBSERVED;
        if (detector->state.electrode[j] == PZS_ELECTRODE_HELD &&
            !is_held(detector->state.control, j))
            detector->state.electrode[j] =
                PZS_ELECTRODE_OBSERVED; /* The program has called pzs_release for a faulty
                                           electrode, whose voltage was fixed; the fault detector
                                           therefore observes the electrode again. */
    }
}

/*
 * Compare one measured shape with the commanded voltages of all electrodes, and continue and start
 * tests. Returns the first input whose electrode is found faulty, or -1.
 */
static int32_t evaluate_shape(pzs_fault_detector *detector, const pzs_real *voltage)
{
    const pzs_real deviation2 = update_responses(detector, voltage);
    const int32_t first = run_tests(detector, voltage);
    start_tests(detector, voltage, deviation2);
    update_states(detector);
    set_test_voltages(detector);
    return first;
}

pzs_status pzs_fault_detector_tick(pzs_fault_detector *detector, const pzs_real *measured)
{
    if (detector == NULL)
        return PZS_E_ARGUMENT;
    if (detector->state.stage != READY)
        return PZS_E_STAGE;
    const pzs_real *voltage = oldest_voltages(detector);
    int32_t first = -1;
    if (measured != NULL && !has_too_few(detector)) {
        if (update_disturbance(detector))
            first = evaluate_shape(detector, voltage);
        memcpy(detector->state.voltage_before, voltage,
               detector->state.columns.n * sizeof(pzs_real));
    }
    store_voltages(detector, detector->state.control->state.voltage);
    return first >= 0 ? finish(detector, PZS_W_ELECTRODE, first) : finish(detector, PZS_OK, -1);
}

/* ---- block of the control loop --------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_fault_detection *detection = tables;
    return PZS_FAULT_DETECTOR_BLOCK_BYTES(problem->inputs, problem->outputs, detection->delay);
}

/*
 * Set the amplitude of the test signals of all electrodes to `amplitude` (V), reduced to just below
 * half the step limit. The amplitude is 0 for an electrode whose voltage limits leave no room for a
 * test.
 */
static void set_amplitude(pzs_fault_detector *detector, pzs_real amplitude)
{
    const pzs_problem *problem = detector->state.control->state.problem;
    for (uint32_t j = 0; j < problem->inputs; j++) {
        const pzs_real limit = PZS_R(0.49) * problem->step_limit[j];
        detector->settings.amplitude[j] = amplitude < limit ? amplitude : limit;
    }
}

static void *work_of(pzs_fault_detector *detector)
{
    return (uint8_t *)detector + PZS_ALIGNED(sizeof *detector);
}

/*
 * Initialise the fault detector as a block (stage of the control tick). Its memory holds the struct
 * pzs_fault_detector, followed by the detector's workspace.
 */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_fault_detection *detection = tables;
    const pzs_problem *problem = signals->control->state.problem;
    pzs_fault_detector *detector = self;
    if (!(detection->amplitude >= 0) || !number_is_finite(detection->amplitude))
        return PZS_E_ARGUMENT;
    /*
     * The fault detector is refused where actuators have curves: it predicts shapes from voltages,
     * not from the effects to which the displacements are proportional.
     */
    if (signals->curves != NULL)
        return PZS_E_STAGE;
    const pzs_status status = pzs_fault_detector_init(
        detector, signals->control, detection->delay, work_of(detector),
        PZS_FAULT_DETECTOR_BYTES(problem->inputs, problem->outputs, detection->delay));
    signals->where = detector->info.where;
    if (status == PZS_OK && detection->amplitude > 0)
        set_amplitude(detector, detection->amplitude);
    return status;
}

/*
 * End all running tests without a result if the supervisor has determined the voltages of the last
 * tick, because the test voltages were then not given. Returns whether the supervisor has
 * determined the voltages.
 */
static bool end_overruled_tests(pzs_fault_detector *detector, const pzs_control *control)
{
    const bool was_taken_over = control->state.is_taken_over;
    for (uint32_t k = 0; k < PZS_TEST_SIGNALS && was_taken_over; k++)
        if (detector->state.test[k].input != NO_INPUT)
            end_test(detector, &detector->state.test[k]);
    return was_taken_over;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_fault_detector *detector = self;
    const pzs_fault_detection *detection = signals->tables;
    place(detector, signals->control, detection->delay, work_of(detector));
    detector->state.stage = READY;
    for (uint32_t i = 0; i < signals->missed && i < detection->delay; i++)
        store_voltages(detector, signals->given);
    const bool is_overruled = end_overruled_tests(detector, signals->control);
    const pzs_status status =
        pzs_fault_detector_tick(detector, is_overruled ? NULL : signals->measured);
    signals->electrode = detector->info.electrode;
    signals->where = detector->info.where;
    return status;
}

const pzs_block_type pzs_fault_detector_block = {"fault_detector", PZS_PHASE_OBSERVE, block_bytes,
                                                 block_init,       block_tick,        NULL};
