/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Fault detector for a loop that damps vibration (pzs_loop.h): finds dead, stuck and reversed
 * electrodes from the readings of the sensors, while the loop goes on. An electrode whose voltage
 * the readings do not show is suspected; test pulses of this and of a healthy electrode then prove
 * the fault.
 *
 * Work in operations: outputs + 8 (inputs + sensors) in a tick, and about 3 for each play of each
 * electrode where hysteresis is compensated. In addition:
 *   end of a window                  3 inputs sensors + 2 inputs^2
 *   choice of a reference electrode  inputs sensors
 *   end of a pulse                   2 inputs sensors
 * Where memory was damaged, its constants are derived again, in 2 inputs + 2 ticks: inputs sensors
 * in most of them, inputs^3 / 6 in one, inputs (outputs + sensors) in the last one.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "hysteresis.h"
#include "pulse_course.h"
#include "pulse_fit.h"
#include "test_pulse.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * A sensor reading whose absolute value exceeds this limit counts as missing, so that no sum of
 * squares overflows.
 */
#define READING_LIMIT PZS_R(1e12)
/*
 * Regularisation weight of the least-squares estimate of the electrodes' voltage errors from the
 * readings, relative to the mean diagonal entry of the normal matrix. The voltage error of an
 * electrode is the voltage that the readings show minus the one that its amplifier gave.
 */
#define RIDGE PZS_R(1e-4)
/*
 * An electrode is suspected only if its fault would explain at least this part of the change of the
 * readings since an earlier interval in which the target stood still. While the target moves, the
 * larger LEAST_MOVING_SHARE holds, because vibration and damping add to the change.
 */
#define LEAST_SHARE PZS_R(0.2)
#define LEAST_MOVING_SHARE PZS_R(0.3)
/*
 * An electrode whose fault would explain at least this part of what the fault of the suspected
 * electrode explains is tested together with the suspected one, or after it.
 */
#define NEXT_SHARE PZS_R(0.3)
/*
 * Number of independent readings from which on LEAST_SHARE and LEAST_MOVING_SHARE are used
 * unchanged. With fewer readings some electrode explains a large part of any change by chance; both
 * thresholds are then multiplied by
 *   (2 + MANY_READINGS / t) / 3
 *   t  effective number of independent readings: trace of the resolution matrix (LEAST_RESOLUTION)
 */
#define MANY_READINGS PZS_R(24)
/*
 * Smallest resolution of an electrode whose faults can be found. The resolution is the part of a
 * missing voltage that the least-squares estimate assigns to the electrode that really lacks it, 0
 * to 1. In single precision it has an error of about 0.003.
 */
#define LEAST_RESOLUTION PZS_R(0.01)
/*
 * An electrode is suspected of a fault only if the voltage that it seems to lack is LEAST_LOSS to
 * LARGEST_LOSS times the loss that such a fault would cause: the whole voltage of a dead electrode,
 * the change of the voltage of a stuck or reversed one.
 */
#define LEAST_LOSS PZS_R(0.5)
#define LARGEST_LOSS PZS_R(4)
/*
 * Smallest voltage that an electrode must seem to lack to be suspected of a fault, relative to the
 * height of its test pulse.
 */
#define NOTICED PZS_R(0.025)
/*
 * If the gain of the structure differs from the model, all electrodes seem to lack the same part of
 * their voltage change. This is the largest such part that the fault detector subtracts from the
 * voltage errors.
 */
#define COMMON_LOSS PZS_R(0.5)
/*
 * Gain (response to a test pulse, divided by the modelled response) from which on a suspected
 * electrode has passed its test.
 */
#define PASSED PZS_R(0.35)
/*
 * Smallest gain (response to a test pulse, divided by the modelled response) of the reference
 * electrode, a healthy one with which a suspected electrode is compared. A pulse with a smaller
 * gain proves nothing and is repeated, higher or with another reference electrode.
 */
#define LEAST_REFERENCE PZS_R(0.5)
/*
 * Conditions under which test pulses prove a fault of a suspected electrode. Its gain (response
 * divided by modelled response) is compared with that of the reference electrode, a healthy one
 * that is tested at the same time:
 *   SILENT    The electrode is faulty if its gain was below SILENT times the reference gain in
 *             SILENT_PULSES pulses. WEAK_PULSES pulses are needed if hysteresis is not compensated
 *             and the last reference gain is below WEAK.
 *   REVERSED  The fault is a reversed sign if the last gain is below -REVERSED times the reference
 *             gain.
 */
#define SILENT PZS_R(0.35)
#define SILENT_PULSES 2u
#define WEAK_PULSES 3u
#define WEAK PZS_R(0.75)
#define REVERSED PZS_R(0.3)
/*
 * Largest size of the negative gain of a reversed electrode, as a fraction of the reference gain. A
 * larger one shows that a load has disturbed the test pulse.
 */
#define LARGEST_REVERSED PZS_R(1.7)
/*
 * Largest jumps of the readings during a test pulse that may prove a fault, divided by a modelled
 * response.
 *   JUMPED            by that of the suspected electrode; if its gain is negative, times 1 plus the
 *                     size of the gain, as a load must be so much larger to cause it
 *   REFERENCE_JUMPED  by that of the reference electrode, a healthy one; larger, because its gain
 *                     need not be accurate
 */
#define JUMPED PZS_R(0.1)
#define REFERENCE_JUMPED PZS_R(0.2)
/*
 * Largest course error (pulse_course.h) of the suspected electrode in a test pulse that may prove a
 * fault, as a fraction of the reference gain plus the size of a negative gain. A load that hides a
 * healthy response and is constant before and after a jump leaves 0.3 or more.
 */
#define LARGEST_COURSE PZS_R(0.3)
/*
 * Largest error of a gain (measured divided by modelled response) that a load causes which jumps
 * once during a test pulse, divided by `jumped` (pzs_pulse_response): 2.31 wherever it jumps.
 */
#define JUMP_ERROR PZS_R(2.4)
/*
 * Conditions under which one test pulse proves a fault of the suspected electrode, so that no
 * second pulse is needed. A load that jumps once cannot meet them, because the error that it may
 * have caused is added to the gain; loads that jump twice in the pulse hardly do. With these
 * numbers the simulations of tests/unit/sweep_faults.c find no healthy electrode faulty. The
 * reference electrode is a healthy one that is tested at the same time.
 *   SURE              largest size of the gain of the suspected electrode, as a fraction of the
 *                     reference gain
 *   SURE_REVERSED     if that gain is negative: its smallest size, as a fraction of the reference
 *                     gain
 *   SURE_COURSE       largest course error (pulse_course.h), as a fraction of the reference gain,
 *                     plus the size of a negative gain: a load that hides a healthy response has to
 *                     follow the pulse that closely
 *   SURE_UNEXPLAINED  largest unexplained sum of squares of the measured response, divided by the
 *                     sum of squares of the modelled response
 *   SURE_STRONG       largest gain of the reference electrode; a larger one shows that a load has
 *                     jumped twice. Structures have gains up to 1.33, vibration of the first mode
 *                     with the pulse adds up to 18 %, and one jump adds below 0.12
 */
#define SURE PZS_R(0.2)
#define SURE_REVERSED PZS_R(0.6)
#define SURE_COURSE PZS_R(0.115)
#define SURE_UNEXPLAINED PZS_R(0.1)
#define SURE_STRONG PZS_R(1.65)
/*
 * Two suspected electrodes are tested together if the sensors tell them apart and show both: the
 * squared sine of the angle between their responses, and the ratio of the squared norms of these
 * responses, must exceed this number.
 */
#define PARTNER PZS_R(0.2)
/*
 * Number of unsuccessful test pulses after which the test of a suspected electrode ends without a
 * result: disturbed ones, and those to which the reference electrode did not respond.
 */
#define MOST_TRIES 4u
/*
 * Number of half windows (windows are times over which readings are averaged) during which an
 * electrode that has passed its test is not suspected.
 */
#define CLEARED_HALVES 64u
/*
 * Values of the member `pause` that repeat the state of an electrode, so that a flipped bit of
 * either is noticed:
 *   UNDER_TEST    the fault detector fixes its voltage for a test
 *   UNOBSERVABLE  its faults cannot be found
 */
#define UNDER_TEST 0xFEu
#define UNOBSERVABLE 0xFFu
/*
 * An electrode that has passed its test is suspected again if the voltage that it seems to lack
 * exceeds this multiple of the voltage that it seemed to lack before the test.
 */
#define WORSE 2
/*
 * Input number that means: no electrode is suspected, or there is no healthy electrode with which a
 * suspected one could be compared.
 */
#define NO_INPUT 0xFFFFu
/*
 * At most this fraction (1/MISSING_LIMIT) of the sensors may give no reading during a window, in
 * which readings are averaged, or a test pulse.
 */
#define MISSING_LIMIT 8u
/*
 * The target shape counts as unmoved while its squared change is below 1/STILL of the smallest
 * squared response of the shape to the test pulse of an electrode (sums of squares over the
 * weighted outputs, m2). The change is counted from the target of the last tick in which the target
 * moved.
 */
#define STILL PZS_R(256)

/*
 * Activities of the fault detector:
 *   WAITING    it averages readings in a window
 *   COMPARING  it compares the means with earlier ones, a part of the work in each of three ticks,
 *              and chooses electrodes that are suspected
 *   CHOOSING   one tick in which it chooses an electrode with which the suspected one is compared
 *   PULSING    it applies a test pulse
 *   JUDGING    some ticks in which it evaluates the pulse, a part of the work in each
 *   DERIVING   some ticks in which it derives its constants again, because memory was damaged
 */
enum { WAITING = 0, COMPARING, CHOOSING, PULSING, JUDGING, DERIVING };
/* Number of ticks in which the fault detector compares means. */
#define COMPARING_TICKS 3u
/*
 * Marks of a sensor without a usable reading: in the present half window, pause or test pulse, and
 * in the half window before.
 */
#define MISSING_NOW 1u
#define MISSING_BEFORE 2u

static pzs_real square(pzs_real number)
{
    return number * number;
}

/*
 * Where neither the suspected electrode nor the healthy one with which it is compared responds to
 * test pulses, as with strong hysteresis, the pulses are repeated with this multiple of their
 * heights.
 */
#define GROWTH PZS_R(4)
/*
 * Smallest motion of an electrode that the hysteresis model predicts for a test pulse, relative to
 * the motion without hysteresis. Where a loop compensates hysteresis and one of the two electrodes
 * under test would move less, the pulses of both are made higher (GROWTH).
 */
#define WEAK_PULSE PZS_R(0.25)

/* ---- memory ------------------------------------------------------------- */

/*
 * Reserve the next `count` real numbers of the memory of the fault detector and return their
 * address.
 */
static pzs_real *take_reals(pzs_real **next, size_t count)
{
    pzs_real *const taken = *next;
    *next += count;
    return taken;
}

/* Set the pointers of the fault detector to its arrays, which follow the struct in memory. */
static void lay_out(pzs_pulse_detector *detector, uint32_t inputs, uint32_t sensors,
                    uint32_t outputs)
{
    pzs_pulse_detector_state *state = &detector->state;
    pzs_real *next = (void *)((uint8_t *)detector + PZS_ALIGNED(sizeof *detector));
    pzs_real *const columns = take_reals(&next, PZS_DENSE(inputs));
    state->diagonal = take_reals(&next, inputs);
    state->first_voltage = take_reals(&next, inputs);
    state->voltage = take_reals(&next, inputs);
    state->base_voltage = take_reals(&next, inputs);
    state->late_voltage = take_reals(&next, inputs);
    state->effect = take_reals(&next, inputs);
    state->cleared_loss = take_reals(&next, inputs);
    state->move = take_reals(&next, PZS_FOURS(inputs));
    state->loss = take_reals(&next, PZS_FOURS(inputs));
    state->resolved = take_reals(&next, PZS_FOURS(inputs));
    state->product[SUSPECT] = take_reals(&next, PZS_FOURS(inputs));
    state->product[REFERENCE] = take_reals(&next, PZS_FOURS(inputs));
    state->resolution = take_reals(&next, inputs);
    state->vibrating = take_reals(&next, inputs);
    state->still_voltage = take_reals(&next, inputs);
    state->last_reading = take_reals(&next, sensors);
    state->first_reading = take_reals(&next, sensors);
    state->reading = take_reals(&next, sensors);
    state->late_reading = take_reals(&next, sensors);
    state->base_reading = take_reals(&next, sensors);
    state->difference = take_reals(&next, sensors);
    state->wanted = take_reals(&next, outputs);
    pzs_linalg_dense_layout(&state->columns, inputs, columns, next);
    state->electrode =
        (uint8_t *)next + sizeof(uint32_t) * (inputs / PZS_TILE + 2u) + sizeof(uint16_t) * inputs;
    state->fault = state->electrode + inputs;
    state->pause = state->fault + inputs;
    state->is_missing = state->pause + inputs;
    detector->info.electrode = state->electrode;
    detector->info.fault = state->fault;
}

/*
 * Set the pointer of the fault detector to the readings of the first vibration mode in the tables
 * of the damper, or to NULL if the loop has no damper or one with other sensors.
 */
static void find_mode(pzs_pulse_detector_state *state, const pzs_vibration *vibration)
{
    const bool is_known =
        vibration != NULL && vibration->sensors == state->tables->sensors && vibration->modes > 0;
    state->mode = NULL;
    if (!is_known)
        return;
    state->mode = vibration->reading != NULL ? vibration->reading : vibration->shape;
    state->mode_step = vibration->modes;
}

/*
 * Set the pointers of the fault detector to its tables, its controller and its arrays, and restore
 * flags that damaged memory has made invalid.
 */
static void place(pzs_pulse_detector *detector, const pzs_loop_signals *signals)
{
    const pzs_selftest_tables *tables = signals->tables;
    const pzs_problem *problem = signals->control->state.problem;
    pzs_pulse_detector_state *state = &detector->state;
    state->tables = tables;
    state->control = signals->control;
    state->direct = tables->direct != NULL ? tables->direct : signals->control->state.influence;
    find_mode(state, signals->vibration);
    lay_out(detector, tables->inputs, tables->sensors, problem->outputs);
    guard_repair_bool(&state->has_base);
    guard_repair_bool(&state->has_taken);
    guard_repair_bool(&state->is_grown);
    guard_repair_bool(&state->is_moving);
    guard_repair_bool(&state->has_half);
    guard_repair_bool(&state->half_moved);
    guard_repair_bool(&state->was_moving);
    guard_repair_bool(&state->response.is_measured);
    state->silent = state->silent < WEAK_PULSES ? state->silent : 0;
}

/*
 * Let the fault detector begin an activity: averaging of readings, or a test pulse. What it has
 * averaged before is lost, except during a comparison.
 */
static void begin(pzs_pulse_detector_state *state, uint32_t phase)
{
    state->phase = (uint8_t)phase;
    state->position = 0;
    state->is_moving = false;
    state->has_half = state->has_half && phase == COMPARING;
}

/*
 * Go on with the second half of a window, which is the first half of the next window.
 *   is_moving in  whether the target has moved since the first half
 */
static void begin_half(pzs_pulse_detector_state *state, bool is_moving)
{
    begin(state, WAITING);
    state->has_half = true;
    state->is_moving = is_moving;
}

/* ---- readings and voltages ------------------------------------------------ */

/*
 * Return the voltages [inputs] with which the model predicts the readings of the sensors (V): those
 * of the last tick or, in a loop that compensates hysteresis, their effects (voltages that would
 * move the structure as far without hysteresis) by the measured model. With the model of the
 * compensation, which assumes less hysteresis, healthy electrodes would seem to miss voltage.
 */
static const pzs_real *acting_voltages(const pzs_pulse_detector_state *state,
                                       const pzs_loop_signals *signals)
{
    const pzs_real *voltage = state->control->state.voltage;
    if (signals->compensator == NULL)
        return voltage;
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        state->effect[j] = pzs_hysteresis_identified(signals->compensator, j, voltage[j]);
    return state->effect;
}

/*
 * Take over the readings of a tick: store each finite reading of plausible size (READING_LIMIT) as
 * the newest one of its sensor, and mark the sensors without one as missing.
 */
static void take_readings(pzs_pulse_detector_state *state, const pzs_real *readings)
{
    for (uint32_t i = 0; i < state->tables->sensors; i++) {
        const pzs_real reading = readings != NULL ? readings[i] : (pzs_real)NAN;
        const bool is_usable =
            number_is_finite(reading) && number_absolute(reading) <= READING_LIMIT;
        if (is_usable)
            state->last_reading[i] = reading;
        else if (state->phase == WAITING || state->phase == PULSING)
            state->is_missing[i] |= MISSING_NOW;
    }
}

/*
 * Return the duration of the pause before the test pulses of a suspected electrode, in which
 * vibration decays, and of half a window in which readings are averaged (ticks).
 */
static uint32_t half_ticks(const pzs_pulse_detector_state *state)
{
    return state->tables->pulse_ticks / 4u;
}

/*
 * Return the number of ticks between the two halves of a window in which readings are averaged: the
 * last readings of the first half arrive, and COMPARING_TICKS compare the means of the last window.
 */
static uint32_t gap_ticks(const pzs_pulse_detector_state *state)
{
    return state->tables->delay + 1u + COMPARING_TICKS;
}

/* Return the duration of the present half window, pause or test pulse (ticks). */
static uint32_t activity_ticks(const pzs_pulse_detector_state *state)
{
    return state->phase == WAITING ? half_ticks(state) : state->tables->pulse_ticks;
}

/*
 * Weights of the voltages and readings of a tick in the sums of the fault detector over a test
 * pulse or a window, a time over which readings are averaged (dimensionless).
 */
typedef struct weights {
    pzs_real mean; /* weight of a tick in a mean of readings or voltages; during a test pulse,
                      weight in the sum that measures the response to the pulse (dimensionless) */
    pzs_real late; /* weight of a tick in the mean over the next window; during a test pulse, weight
                      in the sum that measures a sudden step of the readings (dimensionless) */
} weights;

/*
 * Return the sum of the weights of the ticks between the two halves of a window in its mean
 * (dimensionless). The first tick of the second half has their weights in addition to its own.
 */
static pzs_real gap_weight(const pzs_pulse_detector_state *state)
{
    const uint32_t gap = gap_ticks(state), ticks = 2u * half_ticks(state) + gap;
    return test_pulse_mean(0) * (pzs_real)gap / (pzs_real)ticks;
}

/*
 * Return the weights of a tick of half a window: in the mean over the window of which it is the
 * second half, and in the mean over the next window.
 */
static weights half_weights(const pzs_pulse_detector_state *state, uint32_t tick)
{
    const uint32_t later = half_ticks(state) + gap_ticks(state), ticks = later + half_ticks(state);
    const pzs_real second = test_pulse_mean(test_pulse_place(later + tick, ticks));
    const pzs_real first = test_pulse_mean(test_pulse_place(tick, ticks));
    const pzs_real gap = tick == 0 ? gap_weight(state) : 0;
    return (weights){second / (pzs_real)ticks + gap, first / (pzs_real)ticks};
}

static weights weights_of(const pzs_pulse_detector_state *state, uint32_t tick)
{
    const uint32_t ticks = activity_ticks(state);
    const pzs_real place = test_pulse_place(tick, ticks);
    if (state->phase == WAITING && state->suspect == NO_INPUT)
        return half_weights(state, tick);
    if (state->phase == WAITING)
        return (weights){test_pulse_mean(place) / (pzs_real)ticks, 0};
    return (weights){test_pulse_even(place), test_pulse_late(place)};
}

/*
 * Begin weighted sums of `count` voltages or readings over the present half window, pause or test
 * pulse. In the second half of a window the sums over the first half are continued.
 *   value [count] in      values of the first tick
 *   first [count] in/out  values that will be subtracted
 *   sum [count]   out     sums with the weight of the mean
 *   late [count]  in/out  sums with the second weight
 */
static void begin_sums(const pzs_real *value, uint32_t count, bool has_half, pzs_real *first,
                       pzs_real *sum, pzs_real *late)
{
    if (has_half) {
        memcpy(sum, late, count * sizeof *sum);
    } else {
        memcpy(first, value, count * sizeof *first);
        memset(sum, 0, count * sizeof *sum);
    }
    memset(late, 0, count * sizeof *late);
}

/*
 * Add a tick to weighted sums of `count` voltages or readings over the present half window, pause
 * or test pulse: its values minus those of the first tick, times the weights.
 *   first [count] in      values that are subtracted
 *   sum [count]   in/out  sums with the weight of the mean
 *   late [count]  in/out  sums with the second weight
 */
static void add_tick(const pzs_real *value, uint32_t count, weights weight, const pzs_real *first,
                     pzs_real *sum, pzs_real *late)
{
    for (uint32_t i = 0; i < count; i++) {
        const pzs_real change = value[i] - first[i];
        sum[i] += weight.mean * change;
        late[i] += weight.late * change;
    }
}

/*
 * Add the present voltages [inputs] to their weighted sums over the present test pulse, or over the
 * present window, a time over which the fault detector averages.
 */
static void add_voltages(pzs_pulse_detector_state *state, const pzs_real *voltage)
{
    const uint32_t tick = state->position, inputs = state->tables->inputs;
    if (tick == 0)
        begin_sums(voltage, inputs, state->has_half, state->first_voltage, state->voltage,
                   state->late_voltage);
    add_tick(voltage, inputs, weights_of(state, tick), state->first_voltage, state->voltage,
             state->late_voltage);
    if (state->phase == PULSING)
        pzs_pulse_course_voltages(state, tick, voltage);
}

/*
 * Add the present readings to their weighted sums over the present test pulse, or over the present
 * window, a time over which the fault detector averages.
 *   tick in  number of the tick, within the window or pulse, whose voltages the readings show
 */
static void add_readings(pzs_pulse_detector_state *state, uint32_t tick)
{
    const uint32_t sensors = state->tables->sensors;
    if (tick == 0)
        begin_sums(state->last_reading, sensors, state->has_half, state->first_reading,
                   state->reading, state->late_reading);
    add_tick(state->last_reading, sensors, weights_of(state, tick), state->first_reading,
             state->reading, state->late_reading);
    if (state->phase == PULSING)
        pzs_pulse_course_readings(state, tick);
}

/* Begin to mark the sensors without a usable reading in the present half window or test pulse. */
static void begin_marks(pzs_pulse_detector_state *state)
{
    for (uint32_t i = 0; i < state->tables->sensors; i++) {
        const bool was_missing = state->has_half && (state->is_missing[i] & MISSING_NOW) != 0;
        state->is_missing[i] = was_missing ? MISSING_BEFORE : 0;
    }
}

/*
 * Make one tick of half a window in which readings are averaged, of a pause, or of a test pulse.
 * The readings show the voltages that were set `delay` + 1 ticks ago. Returns whether the half
 * window, pause or pulse has ended.
 */
static bool measure(pzs_pulse_detector_state *state, const pzs_real *voltage)
{
    const uint32_t ticks = activity_ticks(state), late = state->tables->delay + 1u;
    if (state->position == 0)
        begin_marks(state);
    if (state->position < ticks)
        add_voltages(state, voltage);
    if (state->position >= late)
        add_readings(state, state->position - late);
    return state->position + 1u >= ticks + late;
}

/*
 * Whether enough sensors gave usable readings in the present test pulse, or in the present window,
 * a time over which the fault detector averages readings.
 */
static bool has_enough(const pzs_pulse_detector_state *state)
{
    uint32_t missing = 0;
    for (uint32_t i = 0; i < state->tables->sensors; i++)
        missing += state->is_missing[i] ? 1u : 0u;
    return MISSING_LIMIT * missing <= state->tables->sensors;
}

/*
 * Whether the target shape [outputs] has moved since the fault detector stored it; if so, the new
 * target is stored.
 */
static bool has_target_moved(pzs_pulse_detector_state *state, const pzs_real *wanted)
{
    const pzs_problem *problem = state->control->state.problem;
    pzs_real energy = 0;
    for (uint32_t i = 0; i < problem->outputs; i++)
        energy += square(problem->weight[i] * (wanted[i] - state->wanted[i]));
    if (STILL * energy <= state->least_energy)
        return false;
    memcpy(state->wanted, wanted, problem->outputs * sizeof *wanted);
    return true;
}

/* ---- test voltages -------------------------------------------------------- */

static bool is_held(const pzs_control *control, uint32_t j)
{
    return !(control->state.lower[j] < control->state.upper[j]);
}

/*
 * Fix the voltage of electrode j in the next tick (V): both its voltage limits become this voltage.
 */
static void set_voltage(pzs_control *control, uint32_t j, pzs_real voltage)
{
    control->state.lower[j] = voltage;
    control->state.upper[j] = voltage;
    pzs_control_set_held(control, j, voltage);
}

/*
 * Fix the voltage of an electrode under test in the next tick (V).
 *   number in  SUSPECT or REFERENCE
 */
static void set_test_voltage(pzs_pulse_detector_state *state, uint32_t number, pzs_real voltage)
{
    state->set[number] = voltage;
    state->set_copy[number] = voltage;
    set_voltage(state->control, tested_input(state, number), voltage);
}

/*
 * Return the height of the test pulse of input j (V), negative if the voltage `start` is nearer to
 * the upper voltage limit. It is the height in the tables or, while state->is_grown because of
 * hysteresis, GROWTH times that, limited by half the voltage range and by the step limit.
 */
static pzs_real height_of(const pzs_pulse_detector_state *state, uint32_t j, pzs_real start)
{
    const pzs_problem *problem = state->control->state.problem;
    const pzs_real range = (problem->upper[j] - problem->lower[j]) / 2;
    const pzs_real steps = (pzs_real)state->tables->pulse_ticks / 4 * problem->step_limit[j];
    const pzs_real most = range < steps ? range : steps, height = state->tables->amplitude[j];
    const pzs_real grown = GROWTH * height < most ? GROWTH * height : most;
    const bool is_upwards = problem->upper[j] - start >= start - problem->lower[j];
    const pzs_real size = state->is_grown ? grown : height;
    return is_upwards ? size : -size;
}

/*
 * Whether a test pulse of normal height would hardly move one of the electrodes under test,
 * according to the measured hysteresis model. After a reversal of the voltage the ceramic follows a
 * small change only in part.
 */
static bool is_pulse_weak(const pzs_pulse_detector_state *state)
{
    for (uint32_t k = 0; k < 2 && state->compensator != NULL; k++) {
        const uint32_t j = tested_input(state, k);
        const pzs_real start = state->control->state.voltage[j];
        const pzs_real height = height_of(state, j, start);
        const pzs_real rise = pzs_hysteresis_identified(state->compensator, j, start + height) -
                              pzs_hysteresis_identified(state->compensator, j, start);
        if (number_absolute(rise) < WEAK_PULSE * number_absolute(height))
            return true;
    }
    return false;
}

/*
 * Begin the test pulses of the suspected electrode and of the reference electrode (a healthy one)
 * at their present voltages.
 */
static void begin_pulses(pzs_pulse_detector_state *state)
{
    begin(state, PULSING);
    state->is_grown = state->is_grown || is_pulse_weak(state);
    for (uint32_t k = 0; k < 2; k++) {
        const uint32_t j = tested_input(state, k);
        state->start[k] = state->control->state.voltage[j];
        state->height[k] = height_of(state, j, state->start[k]);
        set_test_voltage(state, k, state->start[k]);
        state->electrode[j] = PZS_ELECTRODE_TESTED;
        state->pause[j] = UNDER_TEST;
    }
    state->silent = 0;
    state->has_taken = true;
}

/*
 * Give the next test pulses of both electrodes under test the opposite sign: a load that has hidden
 * the response to one pulse, by chance or because it returns with the period of the pulses, does
 * not hide that to the next one as well. Where the voltage limits do not allow the full height, the
 * pulse is lower, but at least as high as in the tables; otherwise it keeps its sign.
 */
static void turn_pulses(pzs_pulse_detector_state *state)
{
    const pzs_problem *problem = state->control->state.problem;
    for (uint32_t k = 0; k < 2; k++) {
        const uint32_t j = tested_input(state, k);
        const pzs_real start = state->start[k];
        const pzs_real top =
            number_clamp(start - state->height[k], problem->lower[j], problem->upper[j]);
        if (number_absolute(top - start) >= state->tables->amplitude[j])
            state->height[k] = top - start;
    }
}

/* Whether the controller keeps input j at this voltage (V). */
static bool is_kept_at(const pzs_control *control, uint32_t j, pzs_real voltage)
{
    const pzs_real lower = control->state.lower[j], upper = control->state.upper[j];
    return lower >= voltage && lower <= voltage && upper <= lower;
}

/*
 * Whether an electrode under test still has the voltage that the fault detector has set, so that
 * the program has not called pzs_hold or pzs_release for it. Damaged memory may have changed this
 * voltage or its copy.
 *   number in  SUSPECT or REFERENCE
 */
static bool is_as_set(const pzs_pulse_detector_state *state, uint32_t number)
{
    const uint32_t j = tested_input(state, number);
    return is_kept_at(state->control, j, state->set[number]) ||
           is_kept_at(state->control, j, state->set_copy[number]);
}

/* Let the controller choose the voltage of electrode j again. */
static void free_electrode(pzs_control *control, uint32_t j)
{
    control->state.lower[j] = control->state.problem->lower[j];
    control->state.upper[j] = control->state.problem->upper[j];
    pzs_control_set_held(control, j, (pzs_real)NAN);
}

/*
 * End the test voltage of an electrode under test, unless the program has called pzs_hold or
 * pzs_release for it meanwhile.
 *   number in  0: suspected electrode; 1: healthy electrode with which it is compared
 */
static void release_electrode(pzs_pulse_detector_state *state, uint32_t number)
{
    const uint32_t j = tested_input(state, number);
    state->electrode[j] = PZS_ELECTRODE_OBSERVED;
    state->pause[j] = 0;
    if (is_as_set(state, number))
        free_electrode(state->control, j);
}

/*
 * Release the electrodes that are still marked as under test after the end of the test, because
 * damaged memory has changed the inputs of the electrodes under test.
 */
static void release_marked(pzs_pulse_detector_state *state)
{
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        if (state->electrode[j] != PZS_ELECTRODE_TESTED || state->pause[j] != UNDER_TEST)
            continue;
        state->electrode[j] = PZS_ELECTRODE_OBSERVED;
        state->pause[j] = 0;
        free_electrode(state->control, j);
    }
}

/*
 * End the test voltages of the suspected electrode and of the healthy one that is tested at the
 * same time: the controller chooses both voltages again.
 */
static void release_electrodes(pzs_pulse_detector_state *state)
{
    if (!state->has_taken)
        return;
    for (uint32_t k = 0; k < 2; k++)
        release_electrode(state, k);
    release_marked(state);
    state->has_taken = false;
}

/*
 * Let the fault detector begin anew if damaged memory has made its phase or the indices of the
 * electrodes under test invalid.
 */
static void repair_phase(pzs_pulse_detector_state *state)
{
    const uint32_t inputs = state->tables->inputs;
    const bool has_suspect = state->suspect < inputs, has_reference = state->reference < inputs;
    const bool is_pulsing = state->phase == PULSING || state->phase == JUDGING;
    const bool is_alone = state->phase <= COMPARING || state->phase == DERIVING;
    const bool is_idle = is_alone && state->suspect == NO_INPUT && state->reference == NO_INPUT;
    const bool is_choosing = state->phase == CHOOSING && has_suspect;
    const bool is_testing = state->phase != CHOOSING && has_suspect && has_reference;
    const bool is_valid = is_idle || is_choosing || (is_testing && state->phase <= JUDGING);
    if (is_valid && state->has_taken == is_pulsing)
        return;
    release_marked(state);
    state->suspect = NO_INPUT;
    state->reference = NO_INPUT;
    state->has_taken = false;
    begin(state, WAITING);
}

/*
 * Whether the program has called pzs_hold or pzs_release for one of the electrodes under test; the
 * fault detector then ends the test and leaves the electrode alone.
 */
static bool is_overridden(const pzs_pulse_detector_state *state)
{
    return state->has_taken && !(is_as_set(state, 0) && is_as_set(state, 1));
}

/*
 * Set the voltages of both electrodes under test (the suspected one and a healthy one) for the next
 * tick of their test pulses, inside their voltage limits.
 */
static void set_test_voltages(pzs_pulse_detector_state *state)
{
    const pzs_problem *problem = state->control->state.problem;
    const uint32_t ticks = state->tables->pulse_ticks;
    for (uint32_t k = 0; k < 2 && state->has_taken; k++) {
        const uint32_t j = tested_input(state, k);
        const pzs_real place = test_pulse_place(state->position, ticks);
        const bool is_pulsing = state->phase == PULSING && state->position < ticks;
        const pzs_real pulse = is_pulsing ? test_pulse_at(place) : 0;
        const pzs_real voltage = state->start[k] + state->height[k] * pulse;
        set_test_voltage(state, k, number_clamp(voltage, problem->lower[j], problem->upper[j]));
    }
}

/* Exchange the numbers of the two electrodes under test. */
static void exchange(pzs_real pair[2])
{
    const pzs_real first = pair[0];
    pair[0] = pair[1];
    pair[1] = first;
}

/* ---- suspicion ------------------------------------------------------------ */

/*
 * How an electrode is suspected of a fault, at the end of each window (an interval of time):
 *   - The mean readings and mean voltages of the window are compared with those of an earlier
 *     interval in which the target stood still. Weights that fall to 0 at both ends of the window
 *     suppress vibration.
 *   - find_losses estimates the voltage errors of all electrodes from these changes.
 *   - find_suspect chooses the electrode whose error explains most of the change of the readings.
 */

/*
 * Compute the means of `count` voltages or readings over a window.
 *   weight in  sum of the weights of the first half of a window
 *   first [count] in/out  values that were subtracted; means
 *   sum [count]   in      weighted sums over the window
 *   late [count]  in/out  weighted sums over the first half of the next window, from which now the
 *                         means are subtracted
 */
static void add_means(uint32_t count, pzs_real weight, pzs_real *first, const pzs_real *sum,
                      pzs_real *late)
{
    for (uint32_t i = 0; i < count; i++) {
        first[i] += sum[i];
        late[i] -= weight * sum[i];
    }
}

/*
 * Compute the mean voltages and mean readings of a window, a time over which the fault detector
 * averages. The means replace the values of the first tick in the state of the detector.
 */
static void find_means(pzs_pulse_detector_state *state)
{
    const pzs_real weight = (1 - gap_weight(state)) / 2;
    add_means(state->tables->inputs, weight, state->first_voltage, state->voltage,
              state->late_voltage);
    add_means(state->tables->sensors, weight, state->first_reading, state->reading,
              state->late_reading);
}

/*
 * Compare the means of the fault detector's last window (time over which it averages) with those of
 * an earlier interval in which the target stood still. Computes the changes of the mean voltages,
 * and the part of the changes of the mean readings that the voltage changes do not explain.
 */
static void compare_means(pzs_pulse_detector_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    for (uint32_t j = 0; j < tables->inputs; j++)
        state->move[j] = state->first_voltage[j] - state->base_voltage[j];
    pzs_product_matrix(state->difference, state->direct, state->move, tables->sensors,
                       tables->inputs);
    for (uint32_t i = 0; i < tables->sensors; i++) {
        const pzs_real change = state->first_reading[i] - state->base_reading[i];
        state->difference[i] = state->is_missing[i] ? 0 : change - state->difference[i];
    }
}

/*
 * Estimate the voltage errors of all electrodes (voltages that the readings show minus those given)
 * by regularised least squares from the changes of the mean readings. Returns how much the estimate
 * leaves unexplained: the sum of squares of the remaining changes, divided by the weight of the
 * regularisation (V2).
 */
static pzs_real find_losses(pzs_pulse_detector_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    pzs_real *weighted = state->reading, energy = 0;
    for (uint32_t i = 0; i < tables->sensors; i++)
        weighted[i] = square(tables->scale[i]) * state->difference[i];
    pzs_product_sum_rows(state->loss, state->direct, tables->inputs, weighted, tables->sensors,
                         tables->inputs);
    pzs_linalg_solve(&state->columns, state->loss);
    pzs_product_matrix(weighted, state->direct, state->loss, tables->sensors, tables->inputs);
    for (uint32_t i = 0; i < tables->sensors; i++)
        energy += square(tables->scale[i] * (state->difference[i] - weighted[i]));
    return energy / state->ridge;
}

/*
 * Compute what the regularised least-squares estimate makes of the true voltage changes if the
 * readings have no noise: the resolution matrix R times the changes (V).
 *   R = 1 - r (G + r)^-1
 *   r, G + r  weight of the regularisation, matrix of the estimate
 */
static void resolve_moves(pzs_pulse_detector_state *state)
{
    const uint32_t inputs = state->tables->inputs;
    memcpy(state->resolved, state->move, inputs * sizeof *state->move);
    pzs_linalg_solve(&state->columns, state->resolved);
    for (uint32_t j = 0; j < inputs; j++)
        state->resolved[j] = state->move[j] - state->ridge * state->resolved[j];
}

/*
 * Sums over the electrodes whose voltages are not fixed, from which a wrong gain of the structure
 * in the model is found: it makes the voltage error of every electrode (voltage that the readings
 * show minus the one given) proportional to its voltage change, with the factor both / moves.
 */
typedef struct loss_sums {
    pzs_real losses; /* sum of the squared voltage errors of the electrodes (V2) */
    pzs_real moves; /* sum over the electrodes of two factors: voltage change, and what the estimate
                       finds of it in noise- free readings (resolve_moves) (V2) */
    /*
     * sum over the electrodes of two factors: voltage error (voltage that the readings show minus
     * the one given), and change of the given voltage (V2)
     */
    pzs_real both;
} loss_sums;

static loss_sums sum_losses(const pzs_pulse_detector_state *state)
{
    loss_sums sums = {0, 0, 0};
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        if (state->electrode[j] == PZS_ELECTRODE_HELD)
            continue;
        sums.losses += square(state->loss[j]);
        sums.moves += state->resolved[j] * state->move[j];
        sums.both += state->loss[j] * state->move[j];
    }
    return sums;
}

/*
 * Whether a voltage error `loss` of an electrode is that of a fault by which the electrode does not
 * receive the voltage `whole` (V), judged by sign and approximate size. A voltage error is the
 * voltage that the readings show minus the given one (V).
 */
static bool is_loss_of(pzs_real loss, pzs_real whole)
{
    const pzs_real part = -loss * whole, most = square(whole);
    return part >= LEAST_LOSS * most && part <= LARGEST_LOSS * most && most > 0;
}

/*
 * Result of a least-squares fit of the readings for one faulty electrode in a structure whose gain
 * may differ from the model. A voltage error is the voltage that the readings show minus the given
 * one.
 */
typedef struct own_loss {
    pzs_real common; /* part of every voltage change that is missing because the gain of the
                        structure differs from the model, the same for all electrodes
                        (dimensionless): voltage error divided by voltage change. Negative if the
                        structure responds less than the model; at most COMMON_LOSS in size */
    pzs_real lost;   /* voltage error of the electrode (V), the voltage that the readings show minus
                        the given one, after the part `common` is subtracted */
} own_loss;

/*
 * Estimate by least squares the voltage error of electrode j (voltage that the readings show minus
 * the given one), on the assumption that no other electrode is faulty.
 */
static own_loss own_loss_of(const pzs_pulse_detector_state *state, uint32_t j,
                            const loss_sums *sums)
{
    const pzs_real resolved = state->resolved[j], resolution = state->resolution[j];
    const pzs_real moves = sums->moves - square(resolved) / resolution;
    const pzs_real both = sums->both - state->loss[j] * resolved / resolution;
    const pzs_real ratio = moves > 0 ? both / moves : 0;
    const pzs_real common = number_clamp(ratio, -COMMON_LOSS, COMMON_LOSS);
    return (own_loss){common, (state->loss[j] - common * resolved) / resolution};
}

/*
 * Whether the voltage error of electrode j is that of a fault: of a dead electrode, of one that is
 * stuck or reversed since an earlier interval in which the target stood still, or of one that is
 * stuck since the last window in which the target stood still. Voltages may have crept between.
 */
static bool is_plausible(const pzs_pulse_detector_state *state, uint32_t j, const own_loss *own)
{
    const pzs_real gain = 1 + own->common, voltage = state->first_voltage[j];
    return is_loss_of(own->lost, gain * state->move[j]) || is_loss_of(own->lost, gain * voltage) ||
           is_loss_of(own->lost, gain * (voltage - state->still_voltage[j]));
}

/*
 * Return which part (0 to 1) of the change of the readings a fault of electrode j would explain.
 * The result is 0 if the voltage that the electrode seems to lack fits neither a dead nor a stuck
 * or reversed electrode.
 *   sums in  result of sum_losses
 *   rest in  part of the change that no voltage errors explain, the result of find_losses (V2)
 */
static pzs_real share_of(const pzs_pulse_detector_state *state, uint32_t j, const loss_sums *sums,
                         pzs_real rest)
{
    const own_loss own = own_loss_of(state, j, sums);
    const pzs_real explained = state->resolution[j] * square(own.lost);
    const pzs_real all =
        sums->losses - 2 * own.common * sums->both + square(own.common) * sums->moves + rest;
    const bool is_noticed = number_absolute(own.lost) > NOTICED * state->tables->amplitude[j];
    if (!is_noticed || !is_plausible(state, j, &own))
        return 0;
    return explained / (all > explained ? all : explained);
}

/*
 * Whether the fault detector may suspect electrode j: its voltage is not fixed, and it is not under
 * test. An electrode that has passed a test is suspected again only if it seems to lack WORSE times
 * the voltage that it seemed to lack before that test.
 */
static bool may_be_suspected(const pzs_pulse_detector_state *state, uint32_t j)
{
    const bool is_worse = number_absolute(state->loss[j]) > WORSE * state->cleared_loss[j];
    const bool is_cleared = state->electrode[j] == PZS_ELECTRODE_CLEARED;
    const bool is_observed = state->electrode[j] == PZS_ELECTRODE_OBSERVED;
    return (is_observed || (is_cleared && is_worse)) && !is_held(state->control, j);
}

/* Forget all candidates for a test. */
static void clear_candidates(pzs_pulse_detector_state *state)
{
    for (uint32_t k = 0; k < PZS_PULSE_CANDIDATES; k++)
        state->candidate[k] = NO_INPUT;
}

/*
 * Insert electrode j into the list of candidates for a test, which is sorted by the part of the
 * change of the readings that their faults would explain.
 *   share [PZS_PULSE_CANDIDATES] in/out  these parts; 0: no candidate
 */
static void insert_candidate(pzs_pulse_detector_state *state, uint32_t j, pzs_real part,
                             pzs_real *share)
{
    uint32_t k = PZS_PULSE_CANDIDATES;
    for (; k > 0 && part > share[k - 1u]; k--) {
        if (k == PZS_PULSE_CANDIDATES)
            continue;
        share[k] = share[k - 1u];
        state->candidate[k] = state->candidate[k - 1u];
    }
    if (k == PZS_PULSE_CANDIDATES)
        return;
    share[k] = part;
    state->candidate[k] = (uint16_t)j;
}

/*
 * Store three numbers of each candidate that distinguish a dead from a stuck electrode: voltage,
 * change of the voltage, and voltage error (voltage that the readings show minus the given one).
 */
static void store_losses(pzs_pulse_detector_state *state, const loss_sums *sums)
{
    for (uint32_t k = 0; k < PZS_PULSE_CANDIDATES; k++) {
        const uint32_t j = state->candidate[k];
        if (j >= state->tables->inputs)
            continue;
        const own_loss own = own_loss_of(state, j, sums);
        state->mean_voltage[k] = (1 + own.common) * state->first_voltage[j];
        state->mean_move[k] = (1 + own.common) * state->move[j];
        state->mean_loss[k] = own.lost;
        state->common = k == 0 ? own.common : state->common;
    }
}

/*
 * Find the electrode whose fault explains the largest part of the change of the readings
 * (share_of), and others whose faults explain nearly as much: the candidates for a test. Returns
 * the first one, or NO_INPUT if no electrode is suspected.
 *   least in  smallest part that makes an electrode suspected (dimensionless)
 */
static uint32_t find_suspects(pzs_pulse_detector_state *state, pzs_real least)
{
    const loss_sums sums = sum_losses(state);
    pzs_real share[PZS_PULSE_CANDIDATES] = {0};
    clear_candidates(state);
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        if (may_be_suspected(state, j))
            insert_candidate(state, j, share_of(state, j, &sums, state->rest), share);
    for (uint32_t k = 0; k < PZS_PULSE_CANDIDATES; k++)
        if (!(share[0] > least) || !(share[k] > NEXT_SHARE * share[0]))
            state->candidate[k] = NO_INPUT;
    store_losses(state, &sums);
    return state->candidate[0];
}

/*
 * Compute, for each electrode, a scalar product of two vectors of scaled readings that the model
 * predicts (1/V2): for 1 V on this electrode, and for 1 V on electrode `input`.
 *   number in  row of state->product for the results: SUSPECT or REFERENCE
 */
static void compare_shapes(pzs_pulse_detector_state *state, uint32_t number, uint32_t input)
{
    const pzs_selftest_tables *tables = state->tables;
    pzs_real *weighted = state->reading;
    for (uint32_t i = 0; i < tables->sensors; i++)
        weighted[i] = square(tables->scale[i]) * state->direct[(size_t)i * tables->inputs + input];
    pzs_product_sum_rows(state->product[number], state->direct, tables->inputs, weighted,
                         tables->sensors, tables->inputs);
}

/*
 * Leave the part in the shape of the first vibration mode out of the scalar products that
 * compare_shapes has computed for both electrodes under test.
 */
static void leave_vibration_out(pzs_pulse_detector_state *state)
{
    for (uint32_t k = 0; k < 2; k++) {
        const pzs_real part = state->mode_square * state->vibrating[tested_input(state, k)];
        for (uint32_t j = 0; j < state->tables->inputs; j++)
            state->product[k][j] -= part * state->vibrating[j];
    }
}

/*
 * Return the squared sine of the angle between the sensor readings that the model predicts for
 * electrode j and for electrode `suspect` (0 to 1), from the scalar products that compare_shapes
 * has computed.
 */
static pzs_real distinctness(const pzs_pulse_detector_state *state, uint32_t j, uint32_t suspect)
{
    const pzs_real product = state->product[SUSPECT][j];
    return 1 - square(product) / (state->diagonal[j] * state->diagonal[suspect]);
}

/*
 * Choose the reference electrode, a healthy one with which the suspected electrode is compared.
 * Returns NO_INPUT if there is none.
 *   but in  electrode that must not be chosen; NO_INPUT: any may be chosen
 */
static uint32_t find_reference(pzs_pulse_detector_state *state, uint32_t but)
{
    const uint32_t suspect = state->suspect;
    const pzs_real own = state->diagonal[suspect] * square(state->tables->amplitude[suspect]);
    pzs_real largest = 0;
    uint32_t reference = NO_INPUT;
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        const bool is_healthy = state->electrode[j] == PZS_ELECTRODE_OBSERVED ||
                                state->electrode[j] == PZS_ELECTRODE_CLEARED;
        if (j == suspect || j == but || !is_healthy || is_held(state->control, j))
            continue;
        // An electrode that seems to have followed its voltage is probably healthy, and is
        // preferred as reference.
        const bool has_followed =
            2 * number_absolute(state->loss[j]) < number_absolute(state->move[j]);
        // The suspected and the reference electrode should move the sensors by similar amounts,
        // because errors of the larger response would hide the smaller one.
        const pzs_real ratio = state->diagonal[j] * square(state->tables->amplitude[j]) / own;
        const pzs_real likeness = ratio > 1 ? 1 / ratio : ratio;
        const pzs_real preference = has_followed ? 100 : 1;
        const pzs_real merit = preference * square(distinctness(state, j, suspect)) * likeness;
        if (merit > largest) {
            largest = merit;
            reference = j;
        }
    }
    return reference;
}

/*
 * Return another candidate that can be tested together with the suspected electrode, or NO_INPUT:
 * the sensors must tell both apart, and show both about equally well.
 */
static uint32_t find_partner(pzs_pulse_detector_state *state)
{
    const uint32_t suspect = state->suspect;
    const pzs_real own = state->diagonal[suspect] * square(state->tables->amplitude[suspect]);
    for (uint32_t k = 0; k < PZS_PULSE_CANDIDATES; k++) {
        const uint32_t j = state->candidate[k];
        if (j >= state->tables->inputs || j == suspect || !may_be_suspected(state, j))
            continue;
        const pzs_real ratio = state->diagonal[j] * square(state->tables->amplitude[j]) / own;
        const pzs_real likeness = ratio > 1 ? 1 / ratio : ratio;
        if (distinctness(state, j, suspect) > PARTNER && likeness > PARTNER)
            return j;
    }
    return NO_INPUT;
}

/*
 * Whether the voltage of any electrode has moved away from its base voltage by more than the height
 * of its test pulse. Base voltages are the mean voltages of an earlier interval in which the
 * target stood still; set_base stores them.
 */
static bool has_moved(const pzs_pulse_detector_state *state)
{
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        if (number_absolute(state->move[j]) > state->tables->amplitude[j])
            return true;
    return false;
}

/*
 * Store the mean voltages and readings of the fault detector's last window (averaging time), in
 * which the target stood still, for comparison with those of later windows.
 */
static void set_base(pzs_pulse_detector_state *state)
{
    memcpy(state->base_voltage, state->first_voltage,
           state->tables->inputs * sizeof *state->base_voltage);
    for (uint32_t i = 0; i < state->tables->sensors; i++)
        if (!state->is_missing[i])
            state->base_reading[i] = state->first_reading[i];
    state->has_base = true;
}

/* ---- proof ---------------------------------------------------------------- */

/*
 * How the fault of a suspected electrode is proved:
 *   - The suspected electrode and a reference electrode, which seems healthy, make slow test pulses
 *     (test_pulse.h) at the same time. Meanwhile the loop damps vibration, but does not follow the
 *     target.
 *   - The gain of each of them (measured divided by modelled response) follows from a fit of
 *     modelled responses to weighted sums of the readings (pulse_fit.h). The weights suppress
 *     constant loads, drift and vibration.
 *   - The suspected electrode is faulty if its gain is small or negative compared with that of the
 *     reference electrode. Hysteresis, a wrong model or missing readings change both gains alike.
 *   - A pulse during which a load has jumped proves nothing.
 *   - A motion of the target interrupts the test, which begins anew after a pause of the target.
 */

/*
 * End the test of a suspected electrode: the controller again chooses its voltage and that of the
 * healthy electrode that was tested with it.
 */
static void end_proof(pzs_pulse_detector_state *state)
{
    release_electrodes(state);
    state->suspect = NO_INPUT;
    state->reference = NO_INPUT;
    clear_candidates(state);
    begin(state, WAITING);
}

/*
 * Suspect an electrode of a fault. The next tick chooses an electrode with which the responses to
 * test pulses are compared.
 *   is_moving in  whether the target has moved, so that vibration must decay before the test
 */
static void begin_suspicion(pzs_pulse_detector_state *state, uint32_t suspect, bool is_moving)
{
    begin(state, CHOOSING);
    state->is_moving = is_moving;
    state->suspect = (uint16_t)suspect;
    state->reference = NO_INPUT;
    state->tries = 0;
    state->is_grown = false;
}

/*
 * Remove an electrode from the candidates for a test. The electrode is not suspected during a fixed
 * number of further windows, in which readings are averaged, unless it seems to lack much more.
 */
static void clear_electrode(pzs_pulse_detector_state *state, uint32_t j)
{
    state->electrode[j] = PZS_ELECTRODE_CLEARED;
    state->pause[j] = CLEARED_HALVES;
    state->cleared_loss[j] = number_absolute(state->loss[j]);
    for (uint32_t k = 0; k < PZS_PULSE_CANDIDATES; k++)
        if (state->candidate[k] == j)
            state->candidate[k] = NO_INPUT;
}

/* Return the number of a candidate that may still be tested; PZS_PULSE_CANDIDATES if there is none.
 */
static uint32_t next_candidate(const pzs_pulse_detector_state *state)
{
    uint32_t k = 0;
    for (; k < PZS_PULSE_CANDIDATES; k++) {
        const uint32_t j = state->candidate[k];
        if (j < state->tables->inputs && may_be_suspected(state, j))
            break;
    }
    return k;
}

/*
 * End the test of a suspected electrode that is not faulty, or whose test gave no result. If there
 * is another candidate, its test follows.
 *   is_healthy in  whether the test has shown that both electrodes under test respond
 */
static void clear_suspect(pzs_pulse_detector_state *state, bool is_healthy)
{
    const uint32_t suspect = state->suspect, reference = state->reference;
    release_electrodes(state);
    clear_electrode(state, suspect);
    for (uint32_t k = 0; k < PZS_PULSE_CANDIDATES && is_healthy; k++)
        if (state->candidate[k] == reference)
            clear_electrode(state, reference);
    const uint32_t next = next_candidate(state);
    const uint32_t candidate = next < PZS_PULSE_CANDIDATES ? state->candidate[next] : NO_INPUT;
    end_proof(state);
    if (candidate == NO_INPUT)
        return;
    state->candidate[next] = (uint16_t)candidate;
    begin_suspicion(state, candidate, false);
}

/*
 * Store the three numbers of the reference electrode that distinguish a dead from a stuck electrode
 * (store_losses): it may turn out to be the faulty one of the two.
 */
static void store_reference(pzs_pulse_detector_state *state)
{
    const uint32_t j = state->reference, last = PZS_PULSE_CANDIDATES;
    const pzs_real common = state->common;
    state->mean_voltage[last] = (1 + common) * state->first_voltage[j];
    state->mean_move[last] = (1 + common) * state->move[j];
    state->mean_loss[last] = state->loss[j] / state->resolution[j] - common * state->move[j];
}

/*
 * Choose the reference electrode, with which the suspected electrode is compared; if there was one
 * before, another one. Preferred is another candidate, so that one pulse tests two of them. If
 * there is none, the test ends. Otherwise the test pulses begin: at once, or if the target is
 * moving, when it stands still.
 */
static void choose_reference(pzs_pulse_detector *detector)
{
    pzs_pulse_detector_state *state = &detector->state;
    const uint32_t before = state->reference;
    compare_shapes(state, SUSPECT, state->suspect);
    const uint32_t partner = before == NO_INPUT ? find_partner(state) : NO_INPUT;
    const uint32_t next = partner != NO_INPUT ? partner : find_reference(state, before);
    const bool is_moving = state->is_moving;
    if (next != NO_INPUT)
        state->reference = (uint16_t)next;
    // The program may have called pzs_hold for an electrode during the pause.
    if (state->reference == NO_INPUT ||
        (!state->has_taken &&
         (is_held(state->control, state->suspect) || is_held(state->control, state->reference)))) {
        end_proof(state);
        return;
    }
    if (before == NO_INPUT)
        store_reference(state);
    if (is_moving) {
        begin(state, WAITING);
        return;
    }
    compare_shapes(state, REFERENCE, state->reference);
    leave_vibration_out(state);
    detector->info.tests = (uint16_t)(detector->info.tests + (before == NO_INPUT ? 1u : 0u));
    begin_pulses(state);
}

/*
 * Fix the voltage of the suspected electrode, whose fault is proved, at its present value, so that
 * the controller no longer uses the electrode.
 */
static void hold_electrode(pzs_pulse_detector *detector, pzs_electrode_fault fault)
{
    pzs_pulse_detector_state *state = &detector->state;
    pzs_control *control = state->control;
    const uint32_t j = state->suspect;
    end_proof(state);
    set_voltage(control, j, control->state.voltage[j]);
    control->state.faulty[j] = 1;
    state->electrode[j] = PZS_ELECTRODE_HELD;
    state->fault[j] = (uint8_t)fault;
    detector->info.found++;
}

/*
 * Return the number of the suspected electrode in the list of candidates; PZS_PULSE_CANDIDATES if
 * it was the reference electrode of another one that has responded.
 */
static uint32_t candidate_number(const pzs_pulse_detector_state *state)
{
    uint32_t k = 0;
    while (k < PZS_PULSE_CANDIDATES && state->candidate[k] != state->suspect)
        k++;
    return k;
}

/*
 * Return whether the suspected electrode is dead, stuck or reversed. This follows from its gain
 * (measured divided by modelled response) and from its voltage error before the test, which is the
 * voltage that the readings showed minus the given one.
 */
static pzs_electrode_fault fault_of(const pzs_pulse_detector_state *state,
                                    const pzs_pulse_response *response)
{
    if (-response->gain[SUSPECT] > REVERSED * response->gain[REFERENCE])
        return PZS_FAULT_REVERSED;
    const uint32_t k = candidate_number(state);
    const pzs_real dead = number_absolute(state->mean_loss[k] + state->mean_voltage[k]);
    const pzs_real stuck = number_absolute(state->mean_loss[k] + state->mean_move[k]);
    return dead < stuck ? PZS_FAULT_DEAD : PZS_FAULT_STUCK;
}

/*
 * The reference electrode has not responded to its test pulse: release both electrodes under test,
 * and let the next tick choose another reference electrode for the suspected one.
 */
static void change_reference(pzs_pulse_detector_state *state)
{
    release_electrodes(state);
    begin(state, CHOOSING);
}

/*
 * Return how many test pulses without a response of the suspected electrode prove a fault.
 *   reference in  gain (measured divided by modelled response) of the reference electrode, a
 *                 healthy one
 */
static uint32_t silent_pulses(const pzs_pulse_detector_state *state, pzs_real reference)
{
    // If the loop has no model of hysteresis, a small gain of the reference electrode means that
    // even a healthy electrode may hardly respond to one pulse; more pulses are then needed.
    return state->compensator == NULL && reference < WEAK ? WEAK_PULSES : SILENT_PULSES;
}

/* Whether a disturbance of a test pulse shows that could have hidden a healthy response. */
static bool is_disturbed(const pzs_pulse_response *response)
{
    const pzs_real gain = response->gain[SUSPECT], reference = response->gain[REFERENCE];
    const pzs_real negative = gain < 0 ? -gain : 0;
    const bool is_steady =
        negative <= LARGEST_REVERSED * reference &&
        number_absolute(response->jumped[SUSPECT]) <= JUMPED * (1 + negative) &&
        number_absolute(response->jumped[REFERENCE]) <= REFERENCE_JUMPED &&
        response->course_error[SUSPECT] <= LARGEST_COURSE * (reference + negative);
    return !is_steady;
}

/*
 * Whether one test pulse alone proves that the suspected electrode is faulty: the readings had led
 * to the suspicion, the reference electrode (a healthy one) has responded in full and not too much,
 * the suspected electrode not at all or with the wrong sign, and no disturbance shows that could
 * have hidden its response.
 */
static bool is_sure(const pzs_pulse_detector_state *state, const pzs_pulse_response *response)
{
    const pzs_real gain = response->gain[SUSPECT], reference = response->gain[REFERENCE];
    const pzs_real jumped = number_absolute(response->jumped[SUSPECT]);
    const pzs_real shaken = number_absolute(response->jumped[REFERENCE]);
    const pzs_real negative = gain < 0 ? -gain : 0;
    const bool is_calm = response->course_error[SUSPECT] <= SURE_COURSE * (reference + negative) &&
                         shaken <= REFERENCE_JUMPED / 2 &&
                         response->unexplained <= SURE_UNEXPLAINED;
    const bool is_silent = number_absolute(gain) < SURE * reference;
    const bool is_reversed =
        -gain > SURE_REVERSED * reference && -gain <= LARGEST_REVERSED * reference;
    const bool is_clear =
        (is_silent || is_reversed) && gain + JUMP_ERROR * jumped < SILENT * reference;
    const bool was_suspected = candidate_number(state) < PZS_PULSE_CANDIDATES;
    return was_suspected && is_calm && is_clear && reference >= WEAK && reference <= SURE_STRONG;
}

/* Whether the suspected electrode has responded in a test pulse, and the reference electrode not.
 */
static bool is_reference_silent(const pzs_pulse_response *response)
{
    const pzs_real gain = response->gain[SUSPECT], reference = response->gain[REFERENCE];
    return gain >= LEAST_REFERENCE && reference < SILENT * gain;
}

/*
 * Exchange the electrodes under test: the reference electrode has not responded, unlike the
 * suspected one, which takes its place.
 */
static void exchange_electrodes(pzs_pulse_detector_state *state)
{
    pzs_pulse_response *response = &state->response;
    const uint16_t suspect = state->suspect;
    state->suspect = state->reference;
    state->reference = suspect;
    exchange(state->start);
    exchange(state->set);
    exchange(state->set_copy);
    exchange(state->height);
    exchange(response->gain);
    exchange(response->jumped);
    exchange(response->course_error);
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        const pzs_real product = state->product[SUSPECT][j];
        state->product[SUSPECT][j] = state->product[REFERENCE][j];
        state->product[REFERENCE][j] = product;
    }
    state->silent = 0;
}

/* ---- constants ------------------------------------------------------------ */

/*
 * What the fault detector derives once from its tables: the matrix of the least-squares estimate
 * (columns), and `diagonal`, `resolution`, `vibrating` and four numbers. Their checksum is compared
 * at the end of each window and pulse. Where memory was damaged they are derived again, a part in
 * each tick: otherwise a single flipped bit could hide all faults for ever.
 */

/* Return the checksum of the constants. It changes with each single flipped bit. */
static uint32_t sum_of_constants(const pzs_pulse_detector_state *state)
{
    const uint32_t inputs = state->tables->inputs;
    const pzs_real number[] = {state->ridge, state->share_factor, state->least_energy,
                               state->mode_square};
    // The diagonal follows the matrix in memory.
    const size_t matrix = (PZS_DENSE(inputs) + inputs) * sizeof(pzs_real);
    return pzs_guard_word_sum(state->columns.inverse, matrix) ^
           pzs_guard_word_sum(state->resolution, inputs * sizeof *state->resolution) ^
           pzs_guard_word_sum(state->vibrating, inputs * sizeof *state->vibrating) ^
           pzs_guard_word_sum(number, sizeof number);
}

/*
 * Compute row j of the matrix by which the fault detector estimates the voltage errors of the
 * electrodes from the readings (least squares), without regularisation.
 */
static void derive_row(pzs_pulse_detector_state *state, uint32_t j)
{
    const pzs_selftest_tables *tables = state->tables;
    const uint32_t inputs = tables->inputs;
    if (j == 0)
        memset(state->columns.inverse, 0, PZS_DENSE(inputs) * sizeof(pzs_real));
    for (uint32_t k = 0; k <= j; k++) {
        pzs_real sum = 0;
        for (uint32_t i = 0; i < tables->sensors; i++) {
            const pzs_real *row = state->direct + (size_t)i * inputs;
            sum += square(tables->scale[i]) * row[j] * row[k];
        }
        *pzs_linalg_entry(&state->columns, j, k) = sum;
    }
    state->diagonal[j] = *pzs_linalg_entry(&state->columns, j, j);
}

/* Add the regularisation to the matrix, and factor it. Returns whether the matrix is regular. */
static bool factor_matrix(pzs_pulse_detector_state *state)
{
    const uint32_t inputs = state->tables->inputs;
    pzs_real trace = 0;
    for (uint32_t j = 0; j < inputs; j++)
        trace += state->diagonal[j];
    state->ridge = RIDGE * trace / (pzs_real)inputs;
    for (uint32_t j = 0; j < inputs; j++)
        *pzs_linalg_entry(&state->columns, j, j) += state->ridge;
    return state->ridge > 0 && pzs_linalg_factor(&state->columns).zero < 0;
}

/*
 * Compute the resolution of electrode j (0 to 1): the part of a missing voltage that the
 * least-squares estimate assigns to the electrode itself, if no other electrode lacks a voltage.
 * The estimate spreads the rest over electrodes that move the sensors in similar ways. It is an
 * entry of the diagonal of the resolution matrix.
 */
static void derive_resolution(pzs_pulse_detector_state *state, uint32_t j)
{
    memset(state->resolved, 0, state->tables->inputs * sizeof *state->resolved);
    state->resolved[j] = 1;
    pzs_linalg_solve(&state->columns, state->resolved);
    state->resolution[j] = 1 - state->ridge * state->resolved[j];
}

/* Compute the factor of the thresholds where the sensors are few. */
static void derive_share_factor(pzs_pulse_detector_state *state)
{
    pzs_real trace = 0;
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        trace += state->resolution[j];
    state->share_factor = trace < MANY_READINGS ? (2 + MANY_READINGS / trace) / 3 : 1;
}

/*
 * Compute which part of the modelled response of each electrode has the shape of the first
 * vibration mode and is left out when readings are compared with the model during test pulses.
 */
static void derive_vibrating(pzs_pulse_detector_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    state->mode_square = 0;
    for (uint32_t i = 0; i < tables->sensors; i++)
        state->mode_square += square(tables->scale[i] * mode_reading(state, i));
    state->mode_square *= 1 + PZS_PULSE_MODE_WEIGHT;
    memset(state->vibrating, 0, tables->inputs * sizeof *state->vibrating);
    for (uint32_t j = 0; j < tables->inputs && state->mode_square > 0; j++) {
        pzs_real both = 0;
        for (uint32_t i = 0; i < tables->sensors; i++)
            both += square(tables->scale[i]) * mode_reading(state, i) *
                    state->direct[(size_t)i * tables->inputs + j];
        state->vibrating[j] = both / state->mode_square;
    }
}

/*
 * Compute the sum of the squared weighted output changes that a full test pulse of an electrode
 * causes, the smallest one of all electrodes whose faults can be found. A change of the target
 * shape much smaller than this counts as no motion.
 */
static void derive_least_energy(pzs_pulse_detector_state *state)
{
    const pzs_problem *problem = state->control->state.problem;
    state->least_energy = (pzs_real)INFINITY;
    for (uint32_t j = 0; j < problem->inputs; j++) {
        pzs_real energy = 0;
        for (uint32_t i = 0; i < problem->outputs; i++)
            energy += square(problem->weight[i] *
                             state->control->state.influence[(size_t)i * problem->inputs + j]);
        energy *= square(state->tables->amplitude[j]);
        if (state->electrode[j] != PZS_ELECTRODE_UNOBSERVABLE && energy < state->least_energy)
            state->least_energy = energy;
    }
}

/* Derive the number that depends on the states of the electrodes, and the checksum. */
static void derive_last(pzs_pulse_detector_state *state)
{
    derive_least_energy(state);
    state->sum = sum_of_constants(state);
}

/*
 * Make one tick of the derivation of the constants. Returns false if the matrix of the estimate is
 * singular.
 *   tick in  0 to 2 inputs + 1
 */
static bool derive(pzs_pulse_detector_state *state, uint32_t tick)
{
    const uint32_t inputs = state->tables->inputs;
    if (tick < inputs) {
        derive_row(state, tick);
    } else if (tick == inputs) {
        return factor_matrix(state);
    } else if (tick <= 2u * inputs) {
        derive_resolution(state, tick - inputs - 1u);
    } else {
        derive_share_factor(state);
        derive_vibrating(state);
    }
    return true;
}

/* Begin to derive the constants again if memory was damaged. Returns whether it was. */
static bool repair_constants(pzs_pulse_detector_state *state)
{
    if (state->sum == sum_of_constants(state))
        return false;
    end_proof(state);
    begin(state, DERIVING);
    return true;
}

/* Make one tick in which the constants are derived again. */
static void derive_again(pzs_pulse_detector_state *state)
{
    const uint32_t tick = state->position++;
    (void)derive(state, tick);
    if (tick <= 2u * state->tables->inputs)
        return;
    derive_last(state);
    begin(state, WAITING);
}

/* ---- evaluation of test pulses -------------------------------------------- */

/*
 * Decide what a measured test pulse proves about the suspected electrode: that it is healthy, that
 * it is faulty, or nothing. A small gain (measured divided by modelled response) of this electrode
 * counts as a fault only if the gain of the reference electrode is large. Returns the input that
 * was found faulty, or NO_INPUT.
 */
static uint32_t judge_response(pzs_pulse_detector *detector, const pzs_pulse_response *response)
{
    pzs_pulse_detector_state *state = &detector->state;
    const uint32_t suspect = state->suspect;
    const pzs_real gain = response->gain[SUSPECT], reference = response->gain[REFERENCE];
    if (!(gain < PASSED)) {
        state->tries = MOST_TRIES;
    } else if (reference < LEAST_REFERENCE) {
        state->tries++;
        state->is_grown = !state->is_grown;
        if (state->is_grown)
            begin_pulses(state);
        else
            change_reference(state);
    } else if (!(gain < SILENT * reference)) {
        state->tries = MOST_TRIES;
    } else if (is_disturbed(response) && !is_sure(state, response)) {
        state->tries++;
        state->silent = 0;
    } else if (++state->silent >= silent_pulses(state, reference) || is_sure(state, response)) {
        hold_electrode(detector, fault_of(state, response));
        return suspect;
    } else {
        turn_pulses(state);
    }
    return NO_INPUT;
}

/*
 * Repeat a test pulse whose readings were disturbed. Where the loop compensates hysteresis, the
 * repeated pulse is higher: after a reversal of the voltage the ceramic hardly follows a small
 * change, so that a pulse of the usual height may have little effect.
 */
static void repeat_disturbed(pzs_pulse_detector_state *state)
{
    state->tries++;
    if (state->compensator == NULL)
        return;
    state->is_grown = true;
    begin_pulses(state);
}

/*
 * Make one tick of the measurement of a test pulse: predict the response to the other electrodes,
 * compute the gains of both electrodes under test (measured divided by modelled response), or
 * search for disturbances. Returns whether the measurement has ended.
 */
static bool has_measured(pzs_pulse_detector_state *state)
{
    const uint32_t tick = state->position++;
    if (tick == 0) {
        memset(&state->response, 0, sizeof state->response);
        pzs_pulse_predict(state);
        return false;
    }
    if (tick == 1) {
        if (has_enough(state))
            pzs_pulse_measure(state);
        return false;
    }
    if (tick > 2 || !state->response.is_measured)
        return true;
    pzs_pulse_find_jumps(state);
    pzs_pulse_course_errors(state);
    return false;
}

/*
 * Make one tick of the evaluation of a test pulse: measure its response, or decide what follows,
 * the next pulse or the end of the test of the suspected electrode. Returns the input that was
 * found faulty, or NO_INPUT if there is none.
 */
static uint32_t judge(pzs_pulse_detector *detector)
{
    pzs_pulse_detector_state *state = &detector->state;
    const pzs_pulse_response *response = &state->response;
    uint32_t found = NO_INPUT;
    if (!has_measured(state))
        return NO_INPUT;
    detector->info.gain = response->gain[SUSPECT];
    if (repair_constants(state))
        return NO_INPUT;
    begin(state, PULSING);
    if (response->is_measured && is_reference_silent(response))
        exchange_electrodes(state);
    if (response->is_measured)
        found = judge_response(detector, response);
    else
        repeat_disturbed(state);
    if (found == NO_INPUT && state->tries >= MOST_TRIES)
        clear_suspect(state,
                      response->gain[SUSPECT] >= PASSED && response->gain[REFERENCE] >= PASSED);
    return found;
}

/* ---- tick ----------------------------------------------------------------- */

/*
 * Update the state of electrode j after a window in which readings were averaged. An electrode that
 * has passed a test is suspected again after a number of windows. A faulty electrode that the
 * program has released by pzs_release is observed again. States that damaged memory has changed are
 * corrected.
 */
static void update_state(pzs_pulse_detector_state *state, uint32_t j)
{
    uint8_t *const electrode = &state->electrode[j], *const pause = &state->pause[j];
    const bool is_marked = *electrode == PZS_ELECTRODE_UNOBSERVABLE && *pause > CLEARED_HALVES;
    const bool was_held = *electrode == PZS_ELECTRODE_HELD || state->control->state.faulty[j] != 0;
    const bool is_cleared =
        *electrode == PZS_ELECTRODE_CLEARED && *pause > 1u && *pause <= CLEARED_HALVES;
    if (is_marked || *pause == UNOBSERVABLE) {
        *electrode = PZS_ELECTRODE_UNOBSERVABLE;
        *pause = UNOBSERVABLE;
    } else if (was_held && is_held(state->control, j)) {
        *electrode = PZS_ELECTRODE_HELD;
    } else if (is_cleared) {
        --*pause;
    } else {
        *electrode = PZS_ELECTRODE_OBSERVED;
        *pause = 0;
    }
    if (*electrode != PZS_ELECTRODE_HELD)
        state->fault[j] = PZS_FAULT_NONE;
}

/* Update the states of all electrodes after a window. */
static void update_states(pzs_pulse_detector_state *state)
{
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        update_state(state, j);
}

/*
 * Whether the target has stood still for so long that a test pulse may begin: as long as a pause
 * lasts.
 */
static bool has_rested(const pzs_pulse_detector_state *state)
{
    return state->still >= half_ticks(state) + state->tables->delay + 1u;
}

/*
 * Whether the pause before the test pulses of a suspected electrode may end early, because the
 * target stood still for a part of the pause before the electrode was suspected.
 */
static bool is_pause_over(const pzs_pulse_detector_state *state)
{
    const bool is_pause = state->phase == WAITING && state->suspect != NO_INPUT;
    return is_pause && has_rested(state) && state->still > state->position + gap_ticks(state);
}

/*
 * Keep the electrode that was suspected before the last comparison, if any, among the candidates
 * for a test: as the last one, unless it is one of them.
 */
static void keep_candidate(pzs_pulse_detector_state *state, uint32_t before)
{
    uint32_t k = 0;
    while (k + 1u < PZS_PULSE_CANDIDATES && state->candidate[k] < state->tables->inputs &&
           state->candidate[k] != before)
        k++;
    if (before == NO_INPUT)
        return;
    const loss_sums sums = sum_losses(state);
    state->candidate[k] = (uint16_t)before;
    store_losses(state, &sums);
}

/*
 * Choose electrodes to be tested, after the means of a window have been compared with earlier ones.
 * If an electrode is already suspected, the window let vibration decay after a motion of the
 * target: if no electrode is suspected now, the earlier suspicion stands, and the test pulses
 * begin.
 */
static void end_comparison(pzs_pulse_detector_state *state)
{
    const bool has_moved_now = state->is_moving, was_moving = state->was_moving;
    resolve_moves(state);
    const pzs_real least = was_moving ? LEAST_MOVING_SHARE : LEAST_SHARE;
    const uint32_t before = state->suspect;
    const uint32_t suspect = find_suspects(state, least * state->share_factor);
    if (suspect != NO_INPUT) {
        keep_candidate(state, before);
        begin_suspicion(state, suspect, before == NO_INPUT && !has_rested(state));
        return;
    }
    if (before != NO_INPUT) {
        keep_candidate(state, before);
        begin_suspicion(state, before, false);
        return;
    }
    // Store the means of this window for later comparison. This also replaces stored means that
    // damaged memory has made infinite or NaN.
    if (!was_moving && (has_moved(state) || !number_is_finite(state->rest)))
        set_base(state);
    if (!was_moving)
        memcpy(state->still_voltage, state->first_voltage,
               state->tables->inputs * sizeof *state->still_voltage);
    begin_half(state, has_moved_now);
}

/*
 * Make one tick of the comparison of the means of a window with those of an earlier interval in
 * which the target stood still.
 */
static void compare(pzs_pulse_detector_state *state)
{
    switch (state->position++) {
    case 0: compare_means(state); break;
    case 1: state->rest = find_losses(state); break;
    default: end_comparison(state); /* tick COMPARING_TICKS - 1 */
    }
}

/*
 * At the end of the second half of a window, or of a pause, compute the mean readings. The
 * following ticks compare them with those of an earlier interval in which the target stood still,
 * if there is one. If an electrode is already suspected and nothing can be compared, its test
 * pulses begin.
 */
static void end_window(pzs_pulse_detector_state *state)
{
    const bool has_suspect = state->suspect != NO_INPUT, has_moved_now = state->is_moving;
    const bool is_moving = has_moved_now || (!has_suspect && state->half_moved);
    const bool is_usable = has_enough(state), is_first = !has_suspect && !state->has_half;
    if (has_suspect &&
        (is_held(state->control, state->suspect) || is_held(state->control, state->reference))) {
        end_proof(state);
        return;
    }
    state->half_moved = has_moved_now;
    if (repair_constants(state))
        return;
    if (is_first) {
        begin_half(state, false);
        return;
    }
    if (is_usable) {
        find_means(state);
        if (!has_suspect)
            update_states(state);
    }
    if (is_usable && state->has_base) {
        begin(state, COMPARING);
        state->was_moving = is_moving;
        return;
    }
    if (is_usable && !has_suspect && !is_moving)
        set_base(state);
    begin_half(state, false);
    if (has_suspect)
        begin_suspicion(state, state->suspect, false);
}

/*
 * Run one tick of the fault detector.
 *   voltage [inputs] in  voltages that act on the structure in this tick (V)
 * Returns the input that was found faulty, or NO_INPUT.
 */
static uint32_t run_phase(pzs_pulse_detector *detector, const pzs_real *voltage)
{
    pzs_pulse_detector_state *state = &detector->state;
    if (state->phase == CHOOSING) {
        choose_reference(detector);
        return NO_INPUT;
    }
    if (state->phase == JUDGING)
        return judge(detector);
    if (state->phase == COMPARING) {
        compare(state);
        return NO_INPUT;
    }
    if (state->phase == DERIVING) {
        derive_again(state);
        return NO_INPUT;
    }
    if (is_pause_over(state)) {
        begin_suspicion(state, state->suspect, false);
        return NO_INPUT;
    }
    const bool has_ended = measure(state, voltage);
    state->position++;
    if (has_ended && state->phase == PULSING)
        begin(state, JUDGING);
    else if (has_ended)
        end_window(state);
    return NO_INPUT;
}

/*
 * Interrupt the test pulses of a suspected electrode, which begin anew when the target has stood
 * still for a while.
 */
static void interrupt(pzs_pulse_detector_state *state)
{
    if (state->phase == CHOOSING)
        return;
    release_electrodes(state);
    begin(state, WAITING);
}

/* ---- block of the control loop -------------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_selftest_tables *pulses = tables;
    return PZS_PULSE_DETECTOR_BLOCK_BYTES(pulses->inputs, pulses->sensors, problem->outputs);
}

/*
 * Whether a fault of electrode j can be found. Three conditions must hold: the electrode has a test
 * pulse, the readings show which electrode lacks a voltage, and there is another electrode whose
 * response to a test pulse differs in shape.
 */
static bool can_be_tested(pzs_pulse_detector_state *state, uint32_t j)
{
    const pzs_selftest_tables *tables = state->tables;
    if (!(tables->amplitude[j] > 0) || !(state->diagonal[j] > 0) ||
        tables->sensors < PZS_PULSE_SENSORS || !(state->resolution[j] > LEAST_RESOLUTION))
        return false;
    compare_shapes(state, SUSPECT, j);
    for (uint32_t k = 0; k < tables->inputs; k++)
        if (tables->amplitude[k] > 0 && state->diagonal[k] > 0 &&
            distinctness(state, k, j) > PZS_PULSE_DEPENDENT)
            return true;
    return false;
}

/* Mark the electrodes whose faults cannot be found. */
static void find_unobservable(pzs_pulse_detector *detector)
{
    pzs_pulse_detector_state *state = &detector->state;
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        const bool is_observable = can_be_tested(state, j);
        state->electrode[j] = is_observable ? PZS_ELECTRODE_OBSERVED : PZS_ELECTRODE_UNOBSERVABLE;
        state->pause[j] = is_observable ? 0 : UNOBSERVABLE;
        detector->info.unobservable =
            (uint16_t)(detector->info.unobservable + (is_observable ? 0u : 1u));
    }
}

/*
 * Initialise the fault detector as a block (stage of the control tick). Its memory holds the struct
 * pzs_pulse_detector, followed by its arrays.
 */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    pzs_pulse_detector *detector = self;
    const pzs_problem *problem = signals->control->state.problem;
    const pzs_status status = pzs_selftest_check(tables, signals, &signals->where);
    if (status != PZS_OK)
        return status;
    /*
     * The fault detector is refused where weighted sums of voltages are limited: its test pulse on
     * a single input could violate such a limit.
     */
    if (problem->limit_rows != NULL)
        return PZS_E_ARGUMENT;
    /*
     * The fault detector is refused for a sparse influence matrix, because it reads columns of the
     * full matrix.
     */
    if (signals->control->state.influence == NULL)
        return PZS_E_ARGUMENT;
    memset(detector, 0, block_bytes(tables, problem));
    detector->state.suspect = NO_INPUT;
    detector->state.reference = NO_INPUT;
    clear_candidates(&detector->state);
    place(detector, signals);
    detector->info.where = -1;
    for (uint32_t tick = 0; tick < 2u * problem->inputs + 2u; tick++)
        if (!derive(&detector->state, tick))
            return PZS_E_NONFINITE;
    find_unobservable(detector);
    derive_last(&detector->state);
    signals->control->state.is_paused = false;
    return PZS_OK;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_pulse_detector *detector = self;
    pzs_pulse_detector_state *state = &detector->state;
    place(detector, signals);
    repair_phase(state);
    take_readings(state, signals->readings);
    state->compensator = signals->compensator;
    // While the supervisor determines the voltages, test voltages are not given.
    const bool has_moved =
        has_target_moved(state, signals->wanted) || state->control->state.is_taken_over;
    if (has_moved && state->suspect != NO_INPUT)
        interrupt(state);
    state->is_moving = state->is_moving || has_moved;
    state->still = has_moved ? 0 : state->still + (state->still < UINT32_MAX);
    if (is_overridden(state))
        end_proof(state);
    const uint32_t found = run_phase(detector, acting_voltages(state, signals));
    set_test_voltages(state);
    state->control->state.is_paused = state->has_taken;
    signals->electrode = state->electrode;
    signals->where = found != NO_INPUT ? (int32_t)found : -1;
    detector->info.where = signals->where;
    return found != NO_INPUT ? PZS_W_ELECTRODE : PZS_OK;
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_selftest_tables *table = tables;
    *crc = table->crc;
    return number == 0 ? pzs_selftest_parts(table, part) : 0;
}

const pzs_block_type pzs_pulse_detector_block = {"pulse_detector", PZS_PHASE_OBSERVE, block_bytes,
                                                 block_init,       block_tick,        block_parts};
