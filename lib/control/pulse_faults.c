/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Fault detector for a loop that damps vibration (pzs_loop.h): finds dead, stuck and reversed
 * electrodes from the readings of the sensors, while the loop goes on.
 *
 * Suspicion: the mean readings and the mean voltages during a standstill of the target are compared
 * with those of an earlier standstill. Let du be the change of the voltages, dy that of the
 * readings, D the static readings per volt, and S the scales of the sensors. The lost voltages f
 * minimise |S (dy - D (du + f))|^2 + ridge |f|^2. A structure whose gain differs from the model
 * loses a common part c of all voltage changes, f = c du, which is taken out. The electrode whose
 * remaining loss explains most of the difference is suspected, if it lost about its own voltage (as
 * a dead electrode) or its own change of voltage (as a stuck or reversed one).
 *
 * Proof: the suspected electrode makes a slow test pulse (test_pulse.h), during which the loop
 * damps vibration, but does not follow the target. Readings and voltages are multiplied by the even
 * weights of the pulse and summed, so that constant loads, drift and vibration drop out. The
 * response is fitted by the modelled responses to this electrode and to all others; the factor of
 * the first one is the gain of the electrode. Then a reference electrode makes a pulse of its own,
 * then the suspected one again. The suspected electrode is faulty if both its gains are small or
 * negative in comparison with the gain of the reference electrode. Whatever else hides responses
 * (hysteresis, a wrong model, missing readings, lost control) hides that of the reference electrode
 * too.
 *
 * A motion of the target interrupts standstill and pulse, which are repeated later.
 *
 * The work of a tick is outputs + 6 (inputs + sensors) operations. At the end of a standstill 2
 * inputs sensors + inputs^2 multiply-adds are added, and at the end of a pulse inputs sensors.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "test_pulse.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../core/numbers.h"
#include "../core/product.h"

/* A reading that is larger than this counts as missing, so that no sum of squares overflows. */
#define READING_LIMIT PZS_R(1e12)
/*
 * Regularisation in the least-squares estimate of the voltages that electrodes have lost, relative
 * to the mean diagonal entry of its matrix.
 */
#define RIDGE PZS_R(1e-4)
/*
 * Smallest part of the difference between two standstills of the target that a lost voltage of one
 * electrode must explain for this electrode to be suspected.
 */
#define LEAST_SHARE PZS_R(0.2)
/*
 * Smallest and largest voltage that an electrode must seem to have lost to be suspected, relative
 * to the voltage or to the voltage change that it would lose if it were dead, stuck or reversed.
 */
#define LEAST_LOSS PZS_R(0.5)
#define LARGEST_LOSS PZS_R(4)
/*
 * Smallest voltage that an electrode must seem to have lost to be suspected, relative to the height
 * of its test pulse.
 */
#define NOTICED PZS_R(0.05)
/*
 * Largest part of their voltage changes that all electrodes may seem to have lost together. A
 * structure whose gain differs from the model causes such a loss.
 */
#define COMMON_LOSS PZS_R(0.5)
/*
 * Gain (response to a test pulse, divided by the modelled response) from which on a suspected
 * electrode has passed its test.
 */
#define PASSED PZS_R(0.35)
/*
 * Smallest gain (response to a test pulse, divided by the modelled response) of the reference
 * electrode, a healthy one with which a suspected electrode is compared.
 */
#define LEAST_REFERENCE PZS_R(0.4)
/*
 * A suspected electrode is faulty if the gains of both its test pulses are smaller than SILENT
 * times the gain of the reference electrode, a healthy one. It is reversed if the first of these
 * gains is below the negative of REVERSED times the gain of the reference electrode. A gain is a
 * response divided by the modelled response.
 */
#define SILENT PZS_R(0.5)
#define REVERSED PZS_R(0.3)
/*
 * Largest energy of the part of a measured response to a test pulse that has another shape than the
 * modelled response, relative to the energy of the modelled response. A larger part means that
 * something else has disturbed the test pulse.
 */
#define DISTURBED PZS_R(0.25)
/*
 * The evaluation of a test pulse expects that the gain of all other electrodes (response divided by
 * modelled response) is 1. This is the weight of the expectation, relative to the energy of the
 * modelled response to the pulse.
 */
#define EXPECTED PZS_R(0.05)
/*
 * Number of unsuccessful test pulses after which the test of a suspected electrode ends without a
 * result: disturbed ones, and those to which the reference electrode did not respond.
 */
#define MOST_TRIES 4u
/*
 * Number of standstills of the target during which an electrode that has passed its test is not
 * suspected.
 */
#define CLEARED_RESTS 32u
/*
 * Input number that means: no electrode is suspected, or there is no healthy electrode with which a
 * suspected one could be compared.
 */
#define NO_INPUT 0xFFFFu
/*
 * At most this part (1/MISSING_LIMIT) of the sensors may give no reading during a standstill of the
 * target or a test pulse.
 */
#define MISSING_LIMIT 8u
/*
 * The target counts as unmoved while the sum over the outputs of its squared weighted change is
 * below a fixed part (1/STILL) of the same sum for the shape of the weakest test pulse.
 */
#define STILL PZS_R(64)

/*
 * Phases of the fault detector: waiting until the structure has settled, averaging while the target
 * stands still, a first pulse of the suspected and of the reference electrode that is not
 * evaluated, and test pulses that are evaluated.
 */
enum { SETTLING = 0, RESTING, CONDITIONING, PULSING };
/*
 * Test pulses that are evaluated before an electrode is found faulty, in their order: suspected
 * electrode, reference electrode (a healthy one), suspected electrode again.
 */
enum { FIRST_PULSE = 0, REFERENCE_PULSE, SECOND_PULSE };

static pzs_real square(pzs_real number)
{
    return number * number;
}

/* ---- memory ------------------------------------------------------------- */

/* Reserve the next `count` real numbers of the memory and return their address. */
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
    state->rest_voltage = take_reals(&next, inputs);
    state->move = take_reals(&next, PZS_FOURS(inputs));
    state->loss = take_reals(&next, PZS_FOURS(inputs));
    state->last_reading = take_reals(&next, sensors);
    state->first_reading = take_reals(&next, sensors);
    state->reading = take_reals(&next, sensors);
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
 * Set the pointers of the fault detector to its tables, its controller and its arrays, and reset
 * indices of electrodes that damaged memory has made invalid.
 */
static void place(pzs_pulse_detector *detector, const pzs_loop_signals *signals)
{
    const pzs_selftest_tables *tables = signals->tables;
    const pzs_problem *problem = signals->control->state.problem;
    pzs_pulse_detector_state *state = &detector->state;
    state->tables = tables;
    state->control = signals->control;
    state->direct = tables->direct != NULL ? tables->direct : signals->control->state.influence;
    lay_out(detector, tables->inputs, tables->sensors, problem->outputs);
    guard_repair_bool(&state->has_base);
    guard_repair_bool(&state->has_taken);
    const bool has_pair = state->suspect < tables->inputs && state->reference < tables->inputs;
    if (!has_pair) {
        state->suspect = NO_INPUT;
        state->reference = NO_INPUT;
        state->has_taken = false;
    }
    if (state->phase > (has_pair ? PULSING : RESTING))
        state->phase = SETTLING;
}

/*
 * Return the input of an electrode under test: number 0 is the suspected electrode, number 1 the
 * healthy one with which it is compared.
 */
static uint32_t tested_input(const pzs_pulse_detector_state *state, uint32_t number)
{
    return number == 0 ? state->suspect : state->reference;
}

/* ---- readings and voltages ------------------------------------------------ */

/*
 * Return the voltages [inputs] that act on the structure according to the model (V): the effects of
 * the voltages where the loop compensates hysteresis, or the voltages.
 */
static const pzs_real *acting_voltages(const pzs_loop_signals *signals)
{
    return signals->compensator != NULL ? signals->compensator->state.effect
                                        : signals->control->state.voltage;
}

/* Keep the last usable reading of each sensor, and mark the sensors without a usable reading. */
static void take_readings(pzs_pulse_detector_state *state, const pzs_real *readings)
{
    for (uint32_t i = 0; i < state->tables->sensors; i++) {
        const pzs_real reading = readings != NULL ? readings[i] : (pzs_real)NAN;
        const bool is_usable =
            number_is_finite(reading) && number_absolute(reading) <= READING_LIMIT;
        if (is_usable)
            state->last_reading[i] = reading;
        else
            state->is_missing[i] = 1;
    }
}

/* Return the duration of the present standstill of the target or test pulse (ticks). */
static uint32_t window_ticks(const pzs_pulse_detector_state *state)
{
    const uint32_t ticks = state->tables->pulse_ticks;
    return state->phase == RESTING ? ticks / 2u : ticks;
}

/*
 * Return the weight of a tick in the sums over the present standstill of the target or test pulse.
 */
static pzs_real weight_of(const pzs_pulse_detector_state *state, uint32_t tick)
{
    const uint32_t ticks = window_ticks(state);
    if (state->phase == RESTING)
        return 1 / (pzs_real)ticks;
    return test_pulse_even(test_pulse_place(tick, ticks));
}

/*
 * Add the present voltages [inputs] to their weighted sums over the present standstill of the
 * target or test pulse.
 */
static void add_voltages(pzs_pulse_detector_state *state, const pzs_real *voltage)
{
    const pzs_real weight = weight_of(state, state->position);
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        if (state->position == 0) {
            state->first_voltage[j] = voltage[j];
            state->voltage[j] = 0;
        }
        state->voltage[j] += weight * (voltage[j] - state->first_voltage[j]);
    }
}

/*
 * Add the present readings to their weighted sums over the present standstill of the target or test
 * pulse.
 *   tick in  tick of the standstill or pulse whose voltages the readings show
 */
static void add_readings(pzs_pulse_detector_state *state, uint32_t tick)
{
    const pzs_real weight = weight_of(state, tick);
    for (uint32_t i = 0; i < state->tables->sensors; i++) {
        if (tick == 0) {
            state->first_reading[i] = state->last_reading[i];
            state->reading[i] = 0;
        }
        state->reading[i] += weight * (state->last_reading[i] - state->first_reading[i]);
    }
}

/*
 * Measure in one tick of a standstill of the target or of a test pulse: add the voltages, and the
 * readings, which show the voltages that were set `delay` + 1 ticks ago, to their sums. Returns
 * whether the standstill or pulse has ended.
 */
static bool measure(pzs_pulse_detector_state *state, const pzs_real *voltage)
{
    const uint32_t ticks = window_ticks(state), late = state->tables->delay + 1u;
    if (state->position == 0)
        memset(state->is_missing, 0, state->tables->sensors);
    if (state->position < ticks)
        add_voltages(state, voltage);
    if (state->position >= late)
        add_readings(state, state->position - late);
    return state->position + 1u >= ticks + late;
}

/*
 * Whether enough sensors gave usable readings in the present standstill of the target or test
 * pulse.
 */
static bool has_enough(const pzs_pulse_detector_state *state)
{
    uint32_t missing = 0;
    for (uint32_t i = 0; i < state->tables->sensors; i++)
        missing += state->is_missing[i] ? 1u : 0u;
    return MISSING_LIMIT * missing <= state->tables->sensors;
}

/* Whether the target [outputs] has moved since it was stored; then the new target is stored. */
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
 * Hold electrode j at a voltage in the next tick (V): both its voltage limits become this voltage.
 */
static void set_voltage(pzs_control *control, uint32_t j, pzs_real voltage)
{
    control->state.lower[j] = voltage;
    control->state.upper[j] = voltage;
    pzs_control_set_held(control, j, voltage);
}

/*
 * Begin to hold the two electrodes under test, the suspected one and the healthy one with which it
 * is compared, at their present voltages.
 */
static void take_electrodes(pzs_pulse_detector_state *state)
{
    for (uint32_t k = 0; k < 2; k++) {
        const uint32_t j = tested_input(state, k);
        state->start[k] = state->control->state.voltage[j];
        state->set[k] = state->start[k];
        set_voltage(state->control, j, state->start[k]);
        state->electrode[j] = PZS_ELECTRODE_TESTED;
    }
    state->has_taken = true;
}

/*
 * Let the control step choose the voltage of an electrode under test again, unless the program has
 * held or released the electrode meanwhile.
 *   number in  0: suspected electrode; 1: healthy electrode with which it is compared
 */
static void release_electrode(pzs_pulse_detector_state *state, uint32_t number)
{
    pzs_control *control = state->control;
    const uint32_t j = tested_input(state, number);
    const pzs_real lower = control->state.lower[j], upper = control->state.upper[j];
    state->electrode[j] = PZS_ELECTRODE_OBSERVED;
    if (lower < state->set[number] || lower > state->set[number] || upper > lower)
        return;
    control->state.lower[j] = control->state.problem->lower[j];
    control->state.upper[j] = control->state.problem->upper[j];
    pzs_control_set_held(control, j, (pzs_real)NAN);
}

/* Let the control step choose the voltages of both electrodes under test again. */
static void release_electrodes(pzs_pulse_detector_state *state)
{
    if (state->has_taken)
        for (uint32_t k = 0; k < 2; k++)
            release_electrode(state, k);
    state->has_taken = false;
}

/*
 * Whether the program has held or released one of the electrodes under test, which the fault
 * detector then leaves alone.
 */
static bool is_overridden(const pzs_pulse_detector_state *state)
{
    const pzs_control *control = state->control;
    for (uint32_t k = 0; k < 2 && state->has_taken; k++) {
        const uint32_t j = tested_input(state, k);
        const pzs_real lower = control->state.lower[j], upper = control->state.upper[j];
        if (lower < state->set[k] || lower > state->set[k] || upper > lower)
            return true;
    }
    return false;
}

/*
 * Return the height of the test pulse of input j (V): negative if the voltage `start` before the
 * pulse is nearer to the upper voltage limit than to the lower one.
 */
static pzs_real height_of(const pzs_pulse_detector_state *state, uint32_t j, pzs_real start)
{
    const pzs_problem *problem = state->control->state.problem;
    const pzs_real height = state->tables->amplitude[j];
    const bool is_upwards = problem->upper[j] - start >= start - problem->lower[j];
    return is_upwards ? height : -height;
}

/* Set the voltages of both electrodes under test for the next tick, inside their voltage limits. */
static void set_test_voltages(pzs_pulse_detector_state *state)
{
    const pzs_problem *problem = state->control->state.problem;
    const uint32_t ticks = state->tables->pulse_ticks;
    const uint32_t pulsing = state->stage == REFERENCE_PULSE ? 1u : 0u;
    for (uint32_t k = 0; k < 2 && state->has_taken; k++) {
        const uint32_t j = tested_input(state, k);
        const bool moves = state->phase == CONDITIONING || pulsing == k;
        pzs_real voltage = state->start[k];
        if (moves && state->position < ticks)
            voltage += height_of(state, j, voltage) *
                       test_pulse_at(test_pulse_place(state->position, ticks));
        state->set[k] = number_clamp(voltage, problem->lower[j], problem->upper[j]);
        set_voltage(state->control, j, state->set[k]);
    }
}

/* ---- suspicion ------------------------------------------------------------ */

/*
 * Compute the mean voltages and mean readings of a standstill of the target from the weighted sums
 * over it; the mean readings replace first_reading.
 */
static void find_means(pzs_pulse_detector_state *state)
{
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        state->rest_voltage[j] = state->first_voltage[j] + state->voltage[j];
    for (uint32_t i = 0; i < state->tables->sensors; i++)
        state->first_reading[i] += state->reading[i];
}

/*
 * Compute the difference between the last standstill of the target and an earlier one: the changes
 * of the voltages, and the changes of the readings that the model does not explain by them.
 */
static void compare_rests(pzs_pulse_detector_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    for (uint32_t j = 0; j < tables->inputs; j++)
        state->move[j] = state->rest_voltage[j] - state->base_voltage[j];
    pzs_product_matrix(state->difference, state->direct, state->move, tables->sensors,
                       tables->inputs);
    for (uint32_t i = 0; i < tables->sensors; i++) {
        const pzs_real change = state->first_reading[i] - state->base_reading[i];
        state->difference[i] = state->is_missing[i] ? 0 : change - state->difference[i];
    }
}

/*
 * Estimate, by regularised least squares, the voltages that all electrodes have lost between two
 * standstills of the target, from the changes of the readings that the model does not explain.
 * Returns the energy of the changes that no lost voltage explains, divided by the regularisation
 * (V2).
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
 * Sums over the electrodes that are not held, from which the part that all electrodes have lost
 * together is computed. A lost voltage is one that an electrode seems not to have received.
 */
typedef struct loss_sums {
    pzs_real losses, moves, both; /* sums over electrodes of squared lost voltages, of squared
                                     voltage changes, and of their products (V2) */
} loss_sums;

static loss_sums sum_losses(const pzs_pulse_detector_state *state)
{
    loss_sums sums = {0, 0, 0};
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        if (state->electrode[j] == PZS_ELECTRODE_HELD)
            continue;
        sums.losses += square(state->loss[j]);
        sums.moves += square(state->move[j]);
        sums.both += state->loss[j] * state->move[j];
    }
    return sums;
}

/*
 * Whether the voltage `loss` that an electrode seems to have lost has about the size and the sign
 * of a fault in which the electrode loses the voltage `whole` (V).
 */
static bool is_loss_of(pzs_real loss, pzs_real whole)
{
    const pzs_real part = -loss * whole, most = square(whole);
    return part >= LEAST_LOSS * most && part <= LARGEST_LOSS * most && most > 0;
}

/*
 * Return the part (0 to 1) of the difference between two standstills of the target that the lost
 * voltage of electrode j explains, or 0 where the loss is not that of a faulty electrode.
 *   sums in  sums over all electrodes that are not held
 *   rest in  energy of the readings that no lost voltage explains, divided by the regularisation
 *            (V2)
 */
static pzs_real share_of(const pzs_pulse_detector_state *state, uint32_t j, const loss_sums *sums,
                         pzs_real rest)
{
    const pzs_real move = state->move[j], loss = state->loss[j];
    const pzs_real moves = sums->moves - square(move), both = sums->both - loss * move;
    const pzs_real ratio = moves > 0 ? both / moves : 0;
    const pzs_real common = number_clamp(ratio, -COMMON_LOSS, COMMON_LOSS);
    const pzs_real own = loss - common * move;
    const pzs_real others =
        sums->losses - square(loss) - 2 * common * both + square(common) * moves + rest;
    const bool is_plausible = is_loss_of(own, (1 + common) * move) ||
                              is_loss_of(own, (1 + common) * state->rest_voltage[j]);
    if (!is_plausible || !(number_absolute(own) > NOTICED * state->tables->amplitude[j]))
        return 0;
    return square(own) / (square(own) + (others > 0 ? others : 0));
}

/*
 * Return the electrode whose lost voltage explains the largest part of the difference between two
 * standstills of the target, or NO_INPUT if no electrode is to be suspected of a fault.
 *   rest in  energy of the readings that no lost voltage explains, divided by the regularisation
 *            (V2)
 */
static uint32_t find_suspect(const pzs_pulse_detector_state *state, pzs_real rest)
{
    const loss_sums sums = sum_losses(state);
    pzs_real largest = LEAST_SHARE;
    uint32_t suspect = NO_INPUT;
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        const bool is_observed =
            state->electrode[j] == PZS_ELECTRODE_OBSERVED && !is_held(state->control, j);
        const pzs_real share = is_observed ? share_of(state, j, &sums, rest) : 0;
        if (share > largest) {
            largest = share;
            suspect = j;
        }
    }
    return suspect;
}

/*
 * Return the healthy electrode with which the suspected one is compared: the one with the strongest
 * test pulse among those that seem to have followed their voltages, or else among all. Returns
 * NO_INPUT if there is none.
 *   but in  electrode that must not be chosen; NO_INPUT: every electrode may be
 */
static uint32_t find_reference(const pzs_pulse_detector_state *state, uint32_t but)
{
    pzs_real largest = 0;
    uint32_t reference = NO_INPUT;
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        const bool is_healthy = state->electrode[j] == PZS_ELECTRODE_OBSERVED ||
                                state->electrode[j] == PZS_ELECTRODE_CLEARED;
        if (j == state->suspect || j == but || !is_healthy || is_held(state->control, j))
            continue;
        const bool has_followed =
            2 * number_absolute(state->loss[j]) < number_absolute(state->move[j]);
        const pzs_real pulse = state->diagonal[j] * square(state->tables->amplitude[j]);
        const pzs_real merit = has_followed ? 100 * pulse : pulse;
        if (merit > largest) {
            largest = merit;
            reference = j;
        }
    }
    return reference;
}

/*
 * Whether the voltage of any electrode has changed by twice the height of its test pulse or more
 * between the earlier and the last standstill of the target.
 */
static bool has_moved(const pzs_pulse_detector_state *state)
{
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        if (number_absolute(state->move[j]) > 2 * state->tables->amplitude[j])
            return true;
    return false;
}

/*
 * Store the mean voltages and readings of the last standstill of the target, with which later
 * standstills are compared.
 */
static void set_base(pzs_pulse_detector_state *state)
{
    memcpy(state->base_voltage, state->rest_voltage,
           state->tables->inputs * sizeof *state->base_voltage);
    for (uint32_t i = 0; i < state->tables->sensors; i++)
        if (!state->is_missing[i])
            state->base_reading[i] = state->first_reading[i];
    state->has_base = true;
}

/* ---- proof ---------------------------------------------------------------- */

/* Start a phase of the fault detector, such as a standstill of the target or a test pulse. */
static void begin(pzs_pulse_detector_state *state, uint32_t phase)
{
    state->phase = (uint8_t)phase;
    state->position = 0;
}

/*
 * End the test of a suspected electrode, and let the control step choose the voltages of both
 * electrodes under test again.
 */
static void end_proof(pzs_pulse_detector_state *state)
{
    release_electrodes(state);
    state->suspect = NO_INPUT;
    state->reference = NO_INPUT;
    begin(state, SETTLING);
}

/*
 * End the test of a suspected electrode that is not faulty, or whose test gave no result. The
 * electrode is not suspected during a fixed number of further standstills of the target
 * (CLEARED_RESTS).
 */
static void clear_suspect(pzs_pulse_detector_state *state)
{
    const uint32_t suspect = state->suspect;
    end_proof(state);
    state->electrode[suspect] = PZS_ELECTRODE_CLEARED;
    state->pause[suspect] = CLEARED_RESTS;
}

/*
 * Begin to test a suspected electrode: choose the healthy electrode with which it is compared, and
 * let both make a first pulse.
 */
static void begin_proof(pzs_pulse_detector *detector, uint32_t suspect)
{
    pzs_pulse_detector_state *state = &detector->state;
    state->suspect = (uint16_t)suspect;
    state->reference = (uint16_t)find_reference(state, NO_INPUT);
    state->stage = FIRST_PULSE;
    state->tries = 0;
    if (state->reference == NO_INPUT) {
        state->suspect = NO_INPUT;
        return;
    }
    detector->info.tests++;
    begin(state, CONDITIONING);
    take_electrodes(state);
}

/*
 * Sums over the sensors by which the test pulse of one electrode is evaluated. A response is the
 * weighted sum of the readings of a sensor over the pulse, times the scale of the sensor (1).
 */
typedef struct pulse_sums {
    pzs_real own, others, both; /* sums over the sensors of the squared modelled responses to the
                                   electrode under test (own), of those to all other electrodes
                                   (others), and of the products of the two responses (both) */
    pzs_real own_response, other_response; /* sums over the sensors of the measured response times
                                              the modelled response to the electrode under test
                                              (own_response), and times that to all other electrodes
                                              (other_response) */
    pzs_real response; /* sum over the sensors of the squared measured responses */
} pulse_sums;

/*
 * Compare the weighted sums of the readings over the test pulse of electrode j with those that the
 * model predicts from the voltage of electrode j and from the voltages of all other electrodes.
 */
static pulse_sums compare_pulse(pzs_pulse_detector_state *state, uint32_t j)
{
    const pzs_selftest_tables *tables = state->tables;
    pulse_sums sums = {0, 0, 0, 0, 0, 0};
    memcpy(state->move, state->voltage, tables->inputs * sizeof *state->move);
    state->move[j] = 0;
    pzs_product_matrix(state->difference, state->direct, state->move, tables->sensors,
                       tables->inputs);
    for (uint32_t i = 0; i < tables->sensors; i++) {
        const pzs_real scale = state->is_missing[i] ? 0 : tables->scale[i];
        const pzs_real response = scale * state->reading[i], others = scale * state->difference[i];
        const pzs_real own =
            scale * state->direct[(size_t)i * tables->inputs + j] * state->voltage[j];
        sums.own += square(own);
        sums.others += square(others);
        sums.both += own * others;
        sums.own_response += own * response;
        sums.other_response += others * response;
        sums.response += square(response);
    }
    return sums;
}

/* Result of one test pulse. */
typedef struct pulse_response {
    pzs_real gain; /* measured response of the electrode to the test pulse, divided by the modelled
                      response (1) */
    bool is_measured; /* false: other influences than the test pulse have changed the readings, so
                         that the gain means nothing */
} pulse_response;

/*
 * Evaluate the test pulse of electrode j. The measured response is fitted by two modelled
 * responses, that to electrode j and that to all other electrodes, each times an unknown gain. The
 * gain of the other electrodes is expected to be near 1, so that the fit stays unique if they have
 * moved in the shape of electrode j.
 */
static pulse_response evaluate_pulse(pzs_pulse_detector_state *state, uint32_t j)
{
    const pulse_sums sums = compare_pulse(state, j);
    const pzs_real prior = EXPECTED * sums.own, others = sums.others + prior;
    const pzs_real determinant = others * sums.own - square(sums.both);
    pulse_response result = {0, false};
    if (!(determinant > 0) || !has_enough(state))
        return result;
    const pzs_real expected = sums.other_response + prior;
    const pzs_real common = (expected * sums.own - sums.own_response * sums.both) / determinant;
    result.gain = (sums.own_response - common * sums.both) / sums.own;
    const pzs_real rest = sums.response + square(common) * sums.others +
                          square(result.gain) * sums.own - 2 * common * sums.other_response -
                          2 * result.gain * sums.own_response +
                          2 * common * result.gain * sums.both;
    result.is_measured = rest <= DISTURBED * sums.own;
    return result;
}

/*
 * Hold the suspected electrode, which is faulty, at its present voltage, for which the model goes
 * on to predict the shape.
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
 * Return the fault of the suspected electrode, from the gain of its first test pulse and from the
 * voltage that it seemed to have lost before.
 */
static pzs_electrode_fault fault_of(const pzs_pulse_detector_state *state)
{
    if (-state->first_gain > REVERSED * state->reference_gain)
        return PZS_FAULT_REVERSED;
    const pzs_real dead = number_absolute(state->suspect_loss + state->suspect_voltage);
    const pzs_real stuck = number_absolute(state->suspect_loss + state->suspect_move);
    return dead < stuck ? PZS_FAULT_DEAD : PZS_FAULT_STUCK;
}

/*
 * Continue the test of a suspected electrode after the test pulse of the reference electrode, a
 * healthy one. If the reference electrode has hardly responded, so that a small response of the
 * suspected one would mean nothing, another reference electrode is tried.
 *   gain in  response of the reference electrode, divided by the modelled response (1)
 */
static void judge_reference(pzs_pulse_detector_state *state, pzs_real gain)
{
    const uint32_t failed = state->reference;
    state->reference_gain = gain;
    state->stage = SECOND_PULSE;
    if (gain >= LEAST_REFERENCE)
        return;
    state->stage = REFERENCE_PULSE;
    state->tries++;
    release_electrodes(state);
    const uint32_t next = find_reference(state, failed);
    state->reference = (uint16_t)(next != NO_INPUT ? next : failed);
    begin(state, SETTLING);
}

/*
 * Whether the suspected electrode is faulty according to its two test pulses and to that of the
 * reference electrode, a healthy one.
 *   gain in  response to its second test pulse, divided by the modelled response (1)
 */
static bool is_faulty(const pzs_pulse_detector_state *state, pzs_real gain)
{
    const pzs_real least = SILENT * state->reference_gain;
    return gain < least && state->first_gain < least;
}

/*
 * Evaluate a test pulse, and decide what follows: the next pulse, or the end of the test of the
 * suspected electrode. Returns the input that was found faulty, or NO_INPUT.
 */
static uint32_t judge(pzs_pulse_detector *detector)
{
    pzs_pulse_detector_state *state = &detector->state;
    const uint32_t suspect = state->suspect;
    const bool is_reference = state->stage == REFERENCE_PULSE;
    const pulse_response response =
        evaluate_pulse(state, is_reference ? state->reference : suspect);
    detector->info.gain = response.gain;
    begin(state, PULSING);
    if (!response.is_measured) {
        state->tries++;
    } else if (is_reference) {
        judge_reference(state, response.gain);
    } else if (!(response.gain < PASSED)) {
        state->tries = MOST_TRIES;
    } else if (state->stage == FIRST_PULSE) {
        state->first_gain = response.gain;
        state->stage = REFERENCE_PULSE;
    } else if (is_faulty(state, response.gain)) {
        hold_electrode(detector, fault_of(state));
        return suspect;
    } else {
        state->tries = MOST_TRIES;
    }
    if (state->tries >= MOST_TRIES)
        clear_suspect(state);
    return NO_INPUT;
}

/* ---- tick ----------------------------------------------------------------- */

/*
 * After a standstill of the target, count down the time for which electrodes that have passed a
 * test are not suspected, and observe electrodes again that the program has released.
 */
static void update_states(pzs_pulse_detector_state *state)
{
    for (uint32_t j = 0; j < state->tables->inputs; j++) {
        const bool was_held = state->electrode[j] == PZS_ELECTRODE_HELD;
        if (state->electrode[j] == PZS_ELECTRODE_CLEARED && --state->pause[j] == 0)
            state->electrode[j] = PZS_ELECTRODE_OBSERVED;
        if (was_held && !is_held(state->control, j)) {
            state->electrode[j] = PZS_ELECTRODE_OBSERVED;
            state->fault[j] = PZS_FAULT_NONE;
        }
    }
}

/*
 * Evaluate a standstill of the target, and begin to test an electrode if its voltage seems to be
 * lost.
 */
static void end_rest(pzs_pulse_detector *detector)
{
    pzs_pulse_detector_state *state = &detector->state;
    begin(state, RESTING);
    if (!has_enough(state))
        return;
    find_means(state);
    update_states(state);
    if (!state->has_base) {
        set_base(state);
        return;
    }
    compare_rests(state);
    const pzs_real rest = find_losses(state);
    const uint32_t suspect = find_suspect(state, rest);
    if (suspect == NO_INPUT) {
        if (has_moved(state) || !number_is_finite(rest)) /* Sums that damaged memory has made
                                                            infinite or NaN are replaced by those of
                                                            the last standstill of the target. */
            set_base(state);
        return;
    }
    state->suspect_voltage = state->rest_voltage[suspect];
    state->suspect_move = state->move[suspect];
    state->suspect_loss = state->loss[suspect];
    begin_proof(detector, suspect);
}

/*
 * After the structure has settled, begin to average voltages and readings over a standstill of the
 * target, or begin the test pulses of an electrode that is suspected already.
 */
static void end_settling(pzs_pulse_detector_state *state)
{
    if (state->suspect == NO_INPUT) {
        begin(state, RESTING);
        return;
    }
    begin(state, CONDITIONING);
    take_electrodes(state);
}

/*
 * Return the number of ticks without a motion of the target after which the structure has settled.
 */
static uint32_t settling_ticks(const pzs_pulse_detector_state *state)
{
    return state->tables->pulse_ticks / 2u;
}

/*
 * Run one tick of the fault detector.
 *   voltage [inputs] in  voltages that act on the structure in this tick (V)
 * Returns the input that was found faulty, or NO_INPUT.
 */
static uint32_t run_phase(pzs_pulse_detector *detector, const pzs_real *voltage)
{
    pzs_pulse_detector_state *state = &detector->state;
    const bool is_measuring = state->phase == RESTING || state->phase == PULSING;
    const bool has_ended = is_measuring && measure(state, voltage);
    state->position++;
    if (state->phase == SETTLING && state->position >= settling_ticks(state)) {
        end_settling(state);
    } else if (state->phase == CONDITIONING && state->position > state->tables->pulse_ticks) {
        begin(state, PULSING);
    } else if (state->phase == RESTING && has_ended) {
        end_rest(detector);
    } else if (state->phase == PULSING && has_ended) {
        return judge(detector);
    }
    return NO_INPUT;
}

/*
 * Interrupt the present standstill of the target and the present test pulse, which begin again
 * after the structure has settled.
 */
static void interrupt(pzs_pulse_detector_state *state)
{
    release_electrodes(state);
    begin(state, SETTLING);
}

/* ---- block of the control loop -------------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_selftest_tables *pulses = tables;
    return PZS_PULSE_DETECTOR_BLOCK_BYTES(pulses->inputs, pulses->sensors, problem->outputs);
}

/*
 * Compute and factor the matrix of the least-squares estimate of the voltages that electrodes have
 * lost. Returns whether the matrix is regular.
 */
static bool factor_matrix(pzs_pulse_detector_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    const uint32_t inputs = tables->inputs;
    pzs_real trace = 0;
    for (uint32_t j = 0; j < inputs; j++)
        for (uint32_t k = 0; k <= j; k++) {
            pzs_real sum = 0;
            for (uint32_t i = 0; i < tables->sensors; i++) {
                const pzs_real *row = state->direct + (size_t)i * inputs;
                sum += square(tables->scale[i]) * row[j] * row[k];
            }
            *pzs_linalg_entry(&state->columns, j, k) = sum;
        }
    for (uint32_t j = 0; j < inputs; j++) {
        state->diagonal[j] = *pzs_linalg_entry(&state->columns, j, j);
        trace += state->diagonal[j];
    }
    state->ridge = RIDGE * trace / (pzs_real)inputs;
    for (uint32_t j = 0; j < inputs; j++)
        *pzs_linalg_entry(&state->columns, j, j) += state->ridge;
    return state->ridge > 0 && pzs_linalg_factor(&state->columns).zero < 0;
}

/*
 * Find the electrodes that cannot be tested, because they have no test pulse or move no sensor. Of
 * all other electrodes, find the smallest sum of the squared weighted output changes that a full
 * test pulse causes.
 */
static void find_unobservable(pzs_pulse_detector *detector)
{
    pzs_pulse_detector_state *state = &detector->state;
    const pzs_problem *problem = state->control->state.problem;
    state->least_energy = (pzs_real)INFINITY;
    for (uint32_t j = 0; j < problem->inputs; j++) {
        pzs_real energy = 0;
        for (uint32_t i = 0; i < problem->outputs; i++)
            energy += square(problem->weight[i] *
                             state->control->state.influence[(size_t)i * problem->inputs + j]);
        energy *= square(state->tables->amplitude[j]);
        const bool is_observable = state->tables->amplitude[j] > 0 && state->diagonal[j] > 0;
        state->electrode[j] = is_observable ? PZS_ELECTRODE_OBSERVED : PZS_ELECTRODE_UNOBSERVABLE;
        detector->info.unobservable =
            (uint16_t)(detector->info.unobservable + (is_observable ? 0u : 1u));
        if (is_observable && energy < state->least_energy)
            state->least_energy = energy;
    }
}

/*
 * Initialise the fault detector as a block of the control loop. Its memory holds the detector,
 * followed by its arrays.
 */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    pzs_pulse_detector *detector = self;
    const pzs_problem *problem = signals->control->state.problem;
    const pzs_status status = pzs_selftest_check(tables, signals, &signals->where);
    if (status != PZS_OK)
        return status;
    if (problem->limit_rows != NULL) /* the test pulse of a single input could violate a limit row
                                        (limit of a weighted sum of voltages) */
        return PZS_E_ARGUMENT;
    memset(detector, 0, block_bytes(tables, problem));
    detector->state.suspect = NO_INPUT;
    place(detector, signals);
    detector->info.where = -1;
    if (!factor_matrix(&detector->state))
        return PZS_E_NONFINITE;
    find_unobservable(detector);
    signals->control->state.is_paused = false;
    return PZS_OK;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_pulse_detector *detector = self;
    pzs_pulse_detector_state *state = &detector->state;
    place(detector, signals);
    take_readings(state, signals->readings);
    const bool has_moved = has_target_moved(state, signals->wanted);
    if (has_moved)
        interrupt(state);
    if (is_overridden(state))
        end_proof(state);
    const uint32_t found = run_phase(detector, acting_voltages(signals));
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
