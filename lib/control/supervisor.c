/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Supervisor of the control loop: a table of transitions between operating modes, a monitor that
 * detects a diverging loop, and ramps of the voltages. Each tick of a ramp goes 1 / (remaining
 * ticks) of the way, so that a corrected ramp still ends in time unless a step limit prevents it.
 */
#include <string.h>
#include "control.h"
#include "effect_range.h"
#include "limit_rows.h"
#include "monitor.h"
#include "polarity_test.h"
#include "pzs_loop.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"

/* ---- tables ----------------------------------------------------------- */

/* List the arrays that the checksum of the supervisor tables covers. Returns their number. */
static uint32_t list_parts(const pzs_supervision *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    part[0] = (pzs_table_part){&tables->inputs, 6u * sizeof tables->inputs};
    part[1] = scrub_reals(tables->park, tables->inputs);
    part[2] = scrub_reals(&tables->fading, 4);
    return 3;
}

static uint32_t checksum(const pzs_supervision *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

pzs_status pzs_supervision_seal(pzs_supervision *tables)
{
    if (tables == NULL || tables->park == NULL || tables->inputs == 0)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = checksum(tables);
    return PZS_OK;
}

static bool are_in_range(const pzs_supervision *tables)
{
    return tables->ramp_ticks > 0 && tables->polarity_ticks > 0 && tables->waits <= 1 &&
           tables->fading > 0 && tables->fading < 1 && tables->noise >= 0 && tables->load >= 0 &&
           tables->slack >= 0 && number_is_finite(tables->noise + tables->load + tables->slack);
}

/*
 * Return the first input whose park voltage, the safe voltage at which its amplifier rests, is
 * outside its voltage limits, or -1.
 */
static int32_t first_outside(const pzs_supervision *tables, const pzs_problem *problem)
{
    uint32_t i = 0;
    while (i < problem->inputs && tables->park[i] >= problem->lower[i] &&
           tables->park[i] <= problem->upper[i])
        i++;
    return i < problem->inputs ? (int32_t)i : -1;
}

/*
 * Whether the park voltages, the safe voltages at which the amplifiers rest, violate no limit of a
 * weighted sum of voltages.
 */
static bool obeys_rows(const pzs_supervision *tables, const pzs_problem *problem)
{
    const pzs_limit_rows *rows = problem->limit_rows;
    return rows == NULL || rows->call->satisfy(rows, tables->park);
}

static pzs_status check(const pzs_supervision *tables, const pzs_problem *problem, int32_t *where)
{
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != problem->scene)
        return PZS_E_FORMAT;
    if (tables->park == NULL || tables->inputs != problem->inputs)
        return PZS_E_ARGUMENT;
    if (checksum(tables) != tables->crc)
        return PZS_E_CRC;
    *where = pzs_guard_nonfinite(tables->park, tables->inputs);
    if (*where >= 0)
        return PZS_E_NONFINITE;
    *where = first_outside(tables, problem);
    if (*where >= 0 || !obeys_rows(tables, problem))
        return PZS_E_LIMITS;
    return are_in_range(tables) ? PZS_OK : PZS_E_ARGUMENT;
}

/* ---- transitions -------------------------------------------------------- */

/*
 * Entry of the supervisor's table of transitions for an event that does not change the operating
 * mode.
 */
#define STAY PZS_SUPERVISOR_MODES

/*
 * Transition table of the supervisor: the next operating mode for each operating mode (row) and
 * each event (column).
 */
static const uint8_t transition[PZS_SUPERVISOR_MODES][PZS_EVENTS] = {
    [PZS_MODE_INITIALISE] = {STAY, STAY, PZS_MODE_ARMED, PZS_MODE_PARKING, STAY, PZS_MODE_STOPPING,
                             STAY, STAY, PZS_MODE_STOPPING, STAY},
    [PZS_MODE_ARMED] = {PZS_MODE_RUNNING, STAY, STAY, PZS_MODE_PARKING, STAY, PZS_MODE_STOPPING,
                        STAY, STAY, PZS_MODE_STOPPING, STAY},
    [PZS_MODE_RUNNING] = {STAY, PZS_MODE_HOLDING, STAY, PZS_MODE_PARKING, STAY, PZS_MODE_STOPPING,
                          PZS_MODE_STOPPING, PZS_MODE_STOPPING, PZS_MODE_STOPPING, STAY},
    [PZS_MODE_HOLDING] = {PZS_MODE_RUNNING, STAY, STAY, PZS_MODE_PARKING, STAY, PZS_MODE_STOPPING,
                          PZS_MODE_STOPPING, PZS_MODE_STOPPING, PZS_MODE_STOPPING, STAY},
    [PZS_MODE_PARKING] = {STAY, STAY, STAY, PZS_MODE_PARKING, PZS_MODE_ARMED, PZS_MODE_STOPPING,
                          STAY, STAY, PZS_MODE_STOPPING, PZS_MODE_PARKED},
    [PZS_MODE_PARKED] = {STAY, STAY, STAY, PZS_MODE_PARKING, PZS_MODE_ARMED, PZS_MODE_STOPPING,
                         STAY, STAY, PZS_MODE_STOPPING, STAY},
    [PZS_MODE_STOPPING] = {STAY, STAY, STAY, STAY, STAY, STAY, STAY, STAY, STAY, PZS_MODE_LATCHED},
    [PZS_MODE_LATCHED] = {STAY, STAY, STAY, STAY, STAY, STAY, STAY, STAY, STAY, STAY},
    [PZS_MODE_TESTING] = {STAY, STAY, STAY, PZS_MODE_PARKING, STAY, PZS_MODE_STOPPING,
                          PZS_MODE_STOPPING, PZS_MODE_STOPPING, PZS_MODE_STOPPING, STAY}};

pzs_supervisor_mode pzs_supervisor_next(pzs_supervisor_mode mode, pzs_supervisor_event event)
{
    const bool is_known = (unsigned)mode < PZS_SUPERVISOR_MODES && (unsigned)event < PZS_EVENTS;
    const uint8_t next = is_known ? transition[mode][event] : (uint8_t)STAY;
    return next == STAY ? mode : (pzs_supervisor_mode)next;
}

static bool is_in_control(uint32_t mode)
{
    return mode == PZS_MODE_RUNNING || mode == PZS_MODE_HOLDING;
}

/* Whether the supervisor moves the voltages in this mode. */
static bool is_moving(uint32_t mode)
{
    return mode == PZS_MODE_PARKING || mode == PZS_MODE_STOPPING || mode == PZS_MODE_TESTING;
}

/* ---- ramps -------------------------------------------------------------- */

/*
 * Largest number of ticks that a ramp of the voltages may take; a ramp that would take more ticks
 * is treated as one that never ends.
 */
#define MOST_TICKS 4e9f

/*
 * Return the smallest number of ticks in which a voltage changes by `way` (V) if it may change by
 * at most `step_limit` (V) in each tick.
 */
static uint32_t ticks_of(pzs_real way, pzs_real step_limit)
{
    const pzs_real ticks = way / step_limit;
    if (!(step_limit > 0) || !(way > 0))
        return 0;
    if (!(ticks < (pzs_real)MOST_TICKS))
        return UINT32_MAX;
    /*
     * The result is one tick more than the change of the voltage needs at its step limit (largest
     * change in a tick), because rounding errors may shorten the changes.
     */
    return (uint32_t)(ticks * (1 + 16 * PZS_EPSILON)) + 1u;
}

/*
 * Return the number of ticks that the voltage of input i needs from the start to the end of a ramp
 * of the supervisor, or `most` if that is larger.
 */
static uint32_t longer_duration(uint32_t most, const pzs_problem *problem, uint32_t i,
                                pzs_real from, pzs_real to)
{
    const uint32_t ticks = ticks_of(number_absolute(to - from), problem->step_limit[i]);
    return ticks > most ? ticks : most;
}

uint32_t pzs_supervisor_ramp(const pzs_supervision *tables, const pzs_problem *problem,
                             const pzs_real *from, const pzs_real *to)
{
    uint32_t most = tables->ramp_ticks;
    for (uint32_t i = 0; i < problem->inputs; i++)
        most = longer_duration(most, problem, i, from[i], to[i]);
    return most;
}

/* Return a voltage of input i clamped to its limits (V). */
static pzs_real clamped_to_limits(const pzs_problem *problem, uint32_t i, pzs_real voltage)
{
    return number_clamp(voltage, problem->lower[i], problem->upper[i]);
}

uint32_t pzs_supervisor_longest_ramp(const pzs_supervision *tables, const pzs_problem *problem)
{
    uint32_t most = tables->ramp_ticks;
    for (uint32_t i = 0; i < problem->inputs; i++) {
        const pzs_real park = clamped_to_limits(problem, i, tables->park[i]);
        const pzs_real flat = clamped_to_limits(problem, i, problem->reference_voltage[i]);
        most = longer_duration(most, problem, i, problem->lower[i], park);
        most = longer_duration(most, problem, i, problem->upper[i], park);
        most = longer_duration(most, problem, i, problem->lower[i], flat);
        most = longer_duration(most, problem, i, problem->upper[i], flat);
    }
    return most;
}

/*
 * Return the voltage of input i at the end of the present ramp of the supervisor (V): its reference
 * voltage in the optimisation (pzs_problem), or its park voltage, the safe voltage at which the
 * amplifier rests, as the last command demands.
 */
static pzs_real target_of(const pzs_supervisor *supervisor, uint32_t i)
{
    const pzs_problem *problem = supervisor->state.problem;
    const bool is_flat = supervisor->state.core[0].is_flat != 0;
    return clamped_to_limits(
        problem, i, is_flat ? problem->reference_voltage[i] : supervisor->state.tables->park[i]);
}

/*
 * Start a ramp of the voltages from those of the last tick to the reference voltages of the
 * optimisation (pzs_problem), or to the park voltages, the safe voltages at which the amplifiers
 * rest.
 *   given [inputs] in  voltages of the last tick (V)
 */
static void start_ramp(pzs_supervisor *supervisor, const pzs_real *given)
{
    const pzs_problem *problem = supervisor->state.problem;
    uint32_t most = supervisor->state.tables->ramp_ticks;
    for (uint32_t i = 0; i < problem->inputs; i++)
        most = longer_duration(most, problem, i, given[i], target_of(supervisor, i));
    supervisor->state.core[0].remaining = most;
}

/*
 * Whether the voltage of every input is already at the end of the ramp on which the supervisor
 * moves the voltages to safe ones or to reference voltages.
 *   given [inputs] in  voltages of the last tick (V)
 */
static bool has_arrived(const pzs_supervisor *supervisor, const pzs_real *given)
{
    uint32_t i = 0;
    while (i < supervisor->state.problem->inputs && !(given[i] < target_of(supervisor, i)) &&
           !(given[i] > target_of(supervisor, i)))
        i++;
    return i == supervisor->state.problem->inputs;
}

/*
 * Set the voltages of the next tick of the ramp on which the supervisor moves the voltages. After
 * the end of the ramp the voltages stay constant.
 */
static void follow_ramp(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    pzs_real *voltage = signals->control->state.voltage;
    const pzs_real part = core->remaining > 1 ? 1 / (pzs_real)core->remaining : 1;
    for (uint32_t i = 0; i < supervisor->state.problem->inputs; i++) {
        const pzs_real target = target_of(supervisor, i), given = signals->given[i];
        const bool can_move = supervisor->state.problem->step_limit[i] > 0;
        const pzs_real next = core->remaining > 1 ? given + part * (target - given) : target;
        voltage[i] = can_move ? next : given;
    }
    core->remaining -= core->remaining > 0 ? 1u : 0u;
    pzs_control_moved(signals->control);
    /*
     * The shape is predicted in every tick of a ramp. Otherwise the first tick in which the loop
     * controls the voltages would have to make this prediction, and would take longer than others.
     */
    effect_predict(signals);
}

/* ---- events ------------------------------------------------------------- */

/*
 * Change the operating mode of the supervisor after an event, and start a ramp of the voltages to
 * safe ones or to reference voltages if the new mode needs one.
 */
static void process_event(pzs_supervisor *supervisor, pzs_supervisor_event event,
                          const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    const uint32_t before = core->mode;
    const bool restarts = before == PZS_MODE_PARKING && event == PZS_EVENT_PARK;
    core->mode = pzs_supervisor_next((pzs_supervisor_mode)before, event);
    if (core->mode == before && !restarts)
        return;
    if (before == PZS_MODE_TESTING || before == PZS_MODE_ARMED)
        pzs_polarity_test_forget(&supervisor->state.monitor.test);
    if (before == PZS_MODE_TESTING)
        core->remaining = 0;
    if (core->mode == PZS_MODE_STOPPING) {
        core->cause = event;
        core->is_flat = 0;
    }
    if (core->mode == PZS_MODE_STOPPING || core->mode == PZS_MODE_PARKING)
        start_ramp(supervisor, signals->given);
    if (core->mode == PZS_MODE_RUNNING && before == PZS_MODE_ARMED) {
        core->over = 0;
        supervisor->state.monitor.is_started = false;
    }
}

/*
 * A command to the supervisor is stored as this number times a command counter, plus the command.
 */
#define COMMAND_STEP 256u

/*
 * Return the last command to the supervisor with its command counter, after a majority vote over
 * three copies of both.
 */
static uint32_t command_word(const pzs_supervisor *supervisor)
{
    const uint32_t first = supervisor->state.command[0], second = supervisor->state.command[1],
                   third = supervisor->state.command[2];
    return (first & second) | (first & third) | (second & third);
}

/* Carry out the command that the program has given to the supervisor since the last tick. */
static void carry_out_command(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    const uint32_t word = command_word(supervisor);
    const uint32_t command = word != core->obeyed ? word % COMMAND_STEP : PZS_COMMAND_NONE;
    core->obeyed = word;
    if (core->mode == PZS_MODE_INITIALISE && supervisor->state.tables->waits == 0)
        process_event(supervisor, PZS_EVENT_ARM, signals);
    switch (command) {
    case PZS_COMMAND_ARM: process_event(supervisor, PZS_EVENT_ARM, signals); break;
    case PZS_COMMAND_RESUME: process_event(supervisor, PZS_EVENT_RESUME, signals); break;
    case PZS_COMMAND_STOP: process_event(supervisor, PZS_EVENT_STOP, signals); break;
    case PZS_COMMAND_PARK:
    case PZS_COMMAND_FLAT:
        if (core->mode != PZS_MODE_STOPPING && core->mode != PZS_MODE_LATCHED)
            core->is_flat = command == PZS_COMMAND_FLAT ? 1 : 0;
        process_event(supervisor, PZS_EVENT_PARK, signals);
        break;
    default: break;
    }
}

/* ---- polarity test ------------------------------------------------------ */

/*
 * A ramp of the polarity test ends where this part of the way to the park voltages remains. The way
 * back is then known from the voltages at this point, without a copy of those at the start.
 */
#define REST_PART PZS_R(0.125)
/* Longest way to the park voltages at the step limits in a polarity test (ticks). */
#define LONGEST_TEST_RAMP 100000u

/*
 * Return the part of the way to the park voltages that remains after `tick` ticks of a ramp of the
 * polarity test. The speed rises and falls linearly: with a length of two periods of the first mode
 * the ramp leaves a hundredth of its way as vibration where a ramp of constant speed leaves a tenth
 * (for a frequency wrong by 10 %).
 */
static pzs_real remaining_part(const pzs_supervisor_core *core, uint32_t tick)
{
    const pzs_real at = (pzs_real)tick / (pzs_real)core->test_length, rest = 1 - at;
    const pzs_real gone = tick < core->test_length / 2u ? 2 * at * at : 1 - 2 * rest * rest;
    return 1 - (1 - REST_PART) * gone;
}

/* Begin a polarity test with the next tick, if one is due. */
static void begin_test(pzs_supervisor *supervisor)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    if (core->mode != PZS_MODE_RUNNING || core->silent > 0 ||
        !pzs_monitor_asks_for_test(&supervisor->state.monitor, supervisor->state.tables,
                                   core->over))
        return;
    core->mode = PZS_MODE_TESTING;
    core->is_flat = 0;
    core->test_ramp = 0;
    core->test_tick = 0;
    core->remaining = 0;
}

/*
 * Choose the length of the ramps and the direction of a polarity test in its first tick. Returns
 * whether the step limits allow the ramps.
 */
static bool prepare_test(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    const uint32_t period = supervisor->state.tables->polarity_ticks;
    start_ramp(supervisor, signals->given);
    const uint32_t longest = core->remaining > period ? core->remaining : period;
    core->remaining = 0;
    core->test_length = longest < LONGEST_TEST_RAMP ? 2u * longest : 0;
    pzs_monitor_begin_test(&supervisor->state.monitor, signals);
    return core->test_length > 0;
}

/*
 * Return the voltage of input i in the next tick of a polarity test, within its limits and step
 * limit (V).
 */
static pzs_real limited_step(const pzs_problem *problem, uint32_t i, pzs_real given, pzs_real next)
{
    const pzs_real step = problem->step_limit[i];
    return clamped_to_limits(problem, i, number_clamp(next, given - step, given + step));
}

/*
 * Move the voltages by one tick of a ramp of the polarity test, or keep them. Inputs that pzs_hold
 * or a fault detector keeps at a voltage stay there.
 *   factor in  distance from the park voltages after the tick, divided by that before
 */
static void move_test(pzs_supervisor *supervisor, const pzs_loop_signals *signals, pzs_real factor)
{
    const pzs_control *control = signals->control;
    pzs_real *voltage = signals->control->state.voltage;
    for (uint32_t i = 0; i < supervisor->state.problem->inputs; i++) {
        const bool is_held = number_is_finite(control->state.held[0][i]);
        const pzs_real park = target_of(supervisor, i), given = signals->given[i];
        const pzs_real next = park + factor * (given - park);
        if (!is_held)
            voltage[i] = limited_step(supervisor->state.problem, i, given, next);
    }
    pzs_control_moved(signals->control);
    effect_predict(signals);
}

/* Number of the ramp by which the voltages return after a test that was passed; it is even. */
#define RETURN_RAMP 1000u

/* Begin a ramp of the polarity test: an even one leads back. */
static void begin_test_ramp(pzs_supervisor_core *core, uint32_t ramp)
{
    core->test_ramp = ramp;
    core->remaining = core->test_length;
}

/* Give control back to the loop after a polarity test that the structure has passed. */
static void resume_control(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_polarity_test_tolerate(&supervisor->state.monitor.test, signals->deviation);
    supervisor->state.core[0].mode = PZS_MODE_RUNNING;
    supervisor->state.core[0].over = 0;
}

/*
 * End a polarity test that the structure has passed. Voltages near the park voltages first return
 * to those before the test, because the way back at the step limits would make the structure
 * vibrate.
 */
static void pass_test(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    const pzs_supervision *tables = supervisor->state.tables;
    const uint32_t lasted = core->test_ramp * (core->test_length + tables->polarity_ticks);
    pzs_polarity_test_end(&supervisor->state.monitor.test, tables, lasted);
    if (core->test_ramp % 2u == 0)
        resume_control(supervisor, signals);
    else
        begin_test_ramp(core, RETURN_RAMP);
}

/* Begin the next ramp of the polarity test after a pause, or end the test. */
static void end_pause(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    pzs_monitor_state *monitor = &supervisor->state.monitor;
    const polarity_verdict verdict =
        pzs_polarity_test_judge(&monitor->test, supervisor->state.tables, core->test_ramp);
    if (verdict == POLARITY_RIGHT) {
        pass_test(supervisor, signals);
        return;
    }
    if (verdict == POLARITY_WRONG) {
        monitor->is_opposed = true;
        process_event(supervisor, PZS_EVENT_ALARM, signals);
        return;
    }
    begin_test_ramp(core, core->test_ramp + 1u);
}

/* Average the shape in one tick of a pause of the polarity test, in which the voltages stay. */
static void run_pause(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    const bool is_first = core->test_ramp == 0 && core->test_tick == 0;
    move_test(supervisor, signals, 1);
    if (is_first && !prepare_test(supervisor, signals)) {
        pass_test(supervisor, signals);
        return;
    }
    if (pzs_monitor_average(&supervisor->state.monitor, supervisor->state.tables, signals,
                            core->test_tick++))
        end_pause(supervisor, signals);
}

/* Run one tick of a ramp of the polarity test: away from the start, or back. */
static void run_test_ramp(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    const bool is_back = core->test_ramp % 2u == 0;
    const uint32_t rest = core->remaining, gone = core->test_length - rest;
    const pzs_real before = remaining_part(core, is_back ? rest : gone);
    const pzs_real after = remaining_part(core, is_back ? rest - 1u : gone + 1u);
    move_test(supervisor, signals, after / before);
    core->remaining--;
    if (core->remaining > 0)
        return;
    core->test_tick = 0;
    if (core->test_ramp >= RETURN_RAMP)
        resume_control(supervisor, signals);
}

/* Run one tick of a polarity test. The test waits while readings are missing. */
static void run_test(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    if (supervisor->state.core[0].silent > 0)
        move_test(supervisor, signals, 1);
    else if (supervisor->state.core[0].remaining > 0)
        run_test_ramp(supervisor, signals);
    else
        run_pause(supervisor, signals);
}

#define WARNED(signals, status) (((signals)->warnings >> (status)&1u) != 0)

/*
 * Count the ticks without usable readings, and change the operating mode of the supervisor when
 * readings arrive or are missing.
 */
static void judge_readings(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    const bool is_usable =
        signals->readings != NULL && !WARNED(signals, PZS_W_HELD) && !PZS_IS_ERROR(signals->status);
    const bool is_doubtful = WARNED(signals, PZS_W_SENSOR) || WARNED(signals, PZS_W_GATED);
    const bool is_whole = is_usable && !is_doubtful && core->remaining == 0;
    core->silent = is_usable ? 0 : core->silent + 1u + signals->missed;
    if (!is_usable)
        process_event(supervisor, PZS_EVENT_NO_FRAME, signals);
    else if (is_whole || core->mode != PZS_MODE_ARMED)
        process_event(supervisor, PZS_EVENT_FRAME, signals);
}

/*
 * Change the operating mode of the supervisor after one of these events: the readings are missing
 * for too long, the divergence monitor gives an alarm, or another stage of the control tick returns
 * an error.
 */
static void judge_health(pzs_supervisor *supervisor, const pzs_loop_signals *signals)
{
    pzs_supervisor_core *core = &supervisor->state.core[0];
    const pzs_supervision *tables = supervisor->state.tables;
    if (core->mode == PZS_MODE_RUNNING && core->silent == 0)
        core->over = pzs_monitor_tick(&supervisor->state.monitor, tables, signals, core->over);
    if (tables->timeout > 0 && core->silent >= tables->timeout)
        process_event(supervisor, PZS_EVENT_TIMEOUT, signals);
    if (core->over > tables->alarm_ticks)
        process_event(supervisor, PZS_EVENT_ALARM, signals);
    if (PZS_IS_ERROR(signals->status))
        process_event(supervisor, PZS_EVENT_ERROR, signals);
}

pzs_status pzs_supervisor_give(pzs_supervisor *supervisor, pzs_supervisor_command command)
{
    if (supervisor == NULL || (unsigned)command > PZS_COMMAND_STOP)
        return PZS_E_ARGUMENT;
    const uint32_t word = command_word(supervisor);
    const bool is_pending = word != supervisor->state.core[0].obeyed;
    if (is_pending && word % COMMAND_STEP == PZS_COMMAND_STOP)
        return PZS_OK;
    const uint32_t next = (word / COMMAND_STEP + 1u) * COMMAND_STEP + (uint32_t)command;
    for (int copy = 0; copy < 3; copy++)
        supervisor->state.command[copy] = next;
    return PZS_OK;
}

/* ---- block ------------------------------------------------------------ */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    return PZS_SUPERVISOR_BLOCK_BYTES(problem->outputs);
}

static pzs_real *work_of(pzs_supervisor *supervisor)
{
    return (void *)((uint8_t *)supervisor + PZS_ALIGNED(sizeof *supervisor));
}

/*
 * Copy the first of the three copies of the supervisor's variables, which protect them against
 * damaged memory, over the other two.
 */
static void copy_core(pzs_supervisor *supervisor)
{
    supervisor->state.core[1] = supervisor->state.core[0];
    supervisor->state.core[2] = supervisor->state.core[0];
}

static void report(pzs_supervisor *supervisor)
{
    const pzs_supervisor_core *core = &supervisor->state.core[0];
    supervisor->info.mode = (pzs_supervisor_mode)core->mode;
    supervisor->info.cause = (pzs_supervisor_event)core->cause;
    supervisor->info.remaining = core->remaining;
    supervisor->info.amplitude = supervisor->state.monitor.amplitude;
    supervisor->info.is_opposed = supervisor->state.monitor.is_opposed;
    supervisor->info.is_stuck = supervisor->state.monitor.is_stuck;
    supervisor->info.threshold =
        pzs_monitor_threshold(&supervisor->state.monitor, supervisor->state.tables);
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    pzs_supervisor *supervisor = self;
    const pzs_problem *problem = signals->control->state.problem;
    const pzs_status status = check(tables, problem, &signals->where);
    if (status != PZS_OK)
        return status;
    memset(supervisor, 0, sizeof *supervisor);
    supervisor->state.tables = tables;
    supervisor->state.problem = problem;
    pzs_monitor_init(&supervisor->state.monitor, work_of(supervisor), problem->outputs);
    if (!has_arrived(supervisor, signals->control->state.voltage))
        start_ramp(supervisor, signals->control->state.voltage);
    copy_core(supervisor);
    report(supervisor);
    return PZS_OK;
}

/*
 * Return the status of a tick in which the supervisor, not the controller, determines the voltages.
 * The mode is RUNNING in the last tick of a polarity test.
 */
static pzs_status status_of(uint32_t mode)
{
    if (mode == PZS_MODE_STOPPING)
        return PZS_W_RAMP;
    if (mode == PZS_MODE_TESTING || mode == PZS_MODE_RUNNING)
        return PZS_W_POLARITY;
    return mode == PZS_MODE_LATCHED ? PZS_E_LATCHED : PZS_W_PARKED;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_supervisor *supervisor = self;
    pzs_supervisor_core *core = supervisor->state.core;
    supervisor->state.tables = signals->tables;
    supervisor->state.problem = signals->control->state.problem;
    pzs_guard_vote(&core[0], &core[1], &core[2], sizeof core[0]);
    pzs_monitor_place(&supervisor->state.monitor, work_of(supervisor),
                      supervisor->state.problem->outputs);
    effect_predict(signals);
    judge_readings(supervisor, signals);
    carry_out_command(supervisor, signals);
    judge_health(supervisor, signals);
    signals->control->state.is_stuck = supervisor->state.monitor.is_stuck;
    const bool is_controlled = is_in_control(core->mode);
    if (core->mode == PZS_MODE_TESTING) {
        run_test(supervisor, signals);
    } else if (!is_controlled) {
        follow_ramp(supervisor, signals);
        if (core->remaining == 0)
            process_event(supervisor, PZS_EVENT_ARRIVED, signals);
    } else {
        begin_test(supervisor);
    }
    signals->control->state.is_taken_over = !is_controlled;
    signals->control->state.is_led = is_moving(core->mode);
    copy_core(supervisor);
    report(supervisor);
    return is_controlled ? PZS_OK : status_of(core->mode);
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_supervision *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_supervisor_block = {"supervisor", PZS_PHASE_SUPERVISE, block_bytes,
                                             block_init,   block_tick,          block_parts};
