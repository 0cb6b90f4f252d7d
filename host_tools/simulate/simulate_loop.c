/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * One closed loop of a simulation, run tick by tick: events, sensors, controller, amplifiers and
 * structure.
 */
#include "simulate_loop.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../../lib/control/limit_rows.h"
#include "../tables/loop_blocks.h"
#include "amplifier.h"
#include "random.h"

static const double two_pi = 6.283185307179586;

/* ---- electrode states of which the controller knows ---------------------------- */

static void hold_electrode(loop *loop, int amplifier, double voltage)
{
    (void)pzs_hold(loop->controller.info.control, (uint16_t)amplifier, voltage);
    device_hold(&loop->board, amplifier, voltage);
    device_hold(&loop->twin, amplifier, voltage);
}

static void release_electrode(loop *loop, int amplifier)
{
    (void)pzs_release(loop->controller.info.control, (uint16_t)amplifier);
    device_release(&loop->board, amplifier);
    device_release(&loop->twin, amplifier);
}

/* ---- events of the simulation ----------------------------------------- */

static void set_target(loop *loop, const scene_event *event)
{
    char error[SCENE_ERROR];
    if (design_target_values(loop->design, event->value, event->at, loop->scratch, error) == 0)
        memcpy(loop->goal, loop->scratch, (size_t)loop->design->targets * sizeof *loop->goal);
}

static void set_load(loop *loop, int load, double value)
{
    loop->load[load] = value;
    if (load < loop->design->loads)
        plant_load(&loop->simulation->plant, load, value);
    else
        plant_warm(&loop->simulation->plant, value);
}

static void fail_electrodes(loop *loop, const scene_event *event, int tick)
{
    for (int i = 0; i < event->amplifiers; i++) {
        electrode *electrode = &loop->electrode[event->amplifier[i]];
        if (event->type == EVENT_DEAD)
            electrode->fault_voltage = 0;
        else if (electrode->fault == ELECTRODE_GOOD)
            electrode->fault_voltage = loop->output[event->amplifier[i]];
        electrode->failed_at = tick;
        electrode->fault = event->type == EVENT_DEAD ? ELECTRODE_DEAD : ELECTRODE_STUCK;
        electrode->announced_at = event->announced_after >= 0 ? tick + event->announced_after : -1;
        electrode->repaired_at = event->ticks > 0 ? tick + event->ticks : -1;
    }
}

static void repair_electrode(loop *loop, int amplifier)
{
    electrode *electrode = &loop->electrode[amplifier];
    if (electrode->is_held)
        release_electrode(loop, amplifier);
    electrode->fault = ELECTRODE_GOOD;
    electrode->announced_at = electrode->repaired_at = -1;
    electrode->is_held = false;
}

/*
 * Let sensors read too much: a random fraction of them, at least one.
 */
static void falsify_sensors(loop *loop, const scene_event *event, int tick)
{
    const int one = random_int(&loop->random, loop->sensors);
    for (int i = 0; i < loop->sensors; i++) {
        if (i != one && !(random_uniform(&loop->random) < event->size))
            continue;
        loop->sensor[i].error = event->error;
        loop->sensor[i].wrong_until = tick + event->ticks;
    }
}

static void fail_sensors(loop *loop, const scene_event *event, int tick)
{
    for (int i = 0; i < loop->sensors; i++) {
        if (!(random_uniform(&loop->random) < event->size))
            continue;
        if (event->type == EVENT_MISSING_SENSORS)
            loop->sensor[i].nan_until = tick + event->ticks;
        else
            loop->sensor[i].stuck_until = tick + event->ticks;
    }
}

/*
 * Begin a temporary disturbance of the control ticks, such as late voltages or late readings, which
 * lasts for the number of ticks that its event states.
 */
static void begin_disturbance(disturbance *disturbance, const scene_event *event, int tick)
{
    *disturbance = (struct disturbance){event->size, tick + event->ticks};
}

static void apply_event(loop *loop, const scene_event *event, int tick)
{
    switch (event->type) {
    case EVENT_TARGET: loop->factor = event->size; break;
    case EVENT_VALUE: set_target(loop, event); break;
    case EVENT_LOAD: set_load(loop, event->load, event->size); break;
    case EVENT_TEMPERATURE: set_load(loop, loop->design->loads, event->size); break;
    case EVENT_ALIVE:
        for (int i = 0; i < event->amplifiers; i++)
            repair_electrode(loop, event->amplifier[i]);
        break;
    case EVENT_MISSING_SENSORS:
    case EVENT_STUCK_SENSORS:
        if (tick > 0 || !loop->has_failed_sensors)
            fail_sensors(loop, event, tick);
        break;
    case EVENT_WRONG_SENSORS: falsify_sensors(loop, event, tick); break;
    case EVENT_MISSED_TICKS: loop->missed_until = tick + event->ticks; break;
    case EVENT_IMPULSE: plant_kick(&loop->simulation->plant, event->load, event->size); break;
    case EVENT_SINE:
        loop->wave[event->load] =
            (wave){event->size, event->frequency, loop->time, tick + event->ticks};
        break;
    case EVENT_LATE: begin_disturbance(&loop->late, event, tick); break;
    case EVENT_JITTER: begin_disturbance(&loop->jitter, event, tick); break;
    case EVENT_DELAY: begin_disturbance(&loop->delay, event, tick); break;
    default: fail_electrodes(loop, event, tick);
    }
}

/*
 * Apply an event that the scene file lists, and store its target and load factors, which are
 * restored when the random faults of the simulation end.
 */
static void apply_scheduled_event(loop *loop, const scene_event *event, int tick)
{
    apply_event(loop, event, tick);
    if (event->feed_forward)
        loop->known_load[event->load] = event->size;
    if (event->type == EVENT_TARGET)
        loop->scheduled_factor = event->size;
    if (event->type == EVENT_LOAD || event->type == EVENT_TEMPERATURE)
        loop->scheduled_load[event->type == EVENT_LOAD ? event->load : loop->design->loads] =
            event->size;
}

/*
 * Apply one random event: a fault of a sensor or an electrode, a missed tick, or a change of target
 * or load.
 */
static void random_fault(loop *loop, int tick)
{
    static const scene_event_type kinds[] = {EVENT_MISSING_SENSORS,
                                             EVENT_MISSING_SENSORS,
                                             EVENT_STUCK_SENSORS,
                                             EVENT_MISSED_TICKS,
                                             EVENT_DEAD,
                                             EVENT_STUCK,
                                             EVENT_TARGET,
                                             EVENT_LOAD};
    int amplifier[2];
    scene_event event = {.type = kinds[random_int(&loop->random, 8)],
                         .amplifier = amplifier,
                         .announced_after = ANNOUNCED_NEVER};
    event.size = random_uniform(&loop->random);
    event.ticks = 1 + random_int(&loop->random, 50);
    event.amplifiers = 1 + random_int(&loop->random, 2);
    for (int i = 0; i < 2; i++)
        amplifier[i] = random_int(&loop->random, loop->design->amplifiers);
    if (event.type == EVENT_DEAD || event.type == EVENT_STUCK)
        event.announced_after =
            random_int(&loop->random, 2) ? random_int(&loop->random, event.ticks) : ANNOUNCED_NEVER;
    if (event.type == EVENT_MISSING_SENSORS && random_int(&loop->random, 4) == 0)
        event.size = 1; /* a random fault of the sensors makes the readings of all of them NaN */
    if (event.type == EVENT_TARGET || event.type == EVENT_LOAD)
        event.size = 2 * event.size - 1;
    event.load = random_int(&loop->random, loop->design->loads + 1);
    if (event.type != EVENT_LOAD || event.load < loop->design->loads)
        apply_event(loop, &event, tick);
}

static void end_faults(loop *loop)
{
    loop->factor = loop->scheduled_factor;
    loop->missed_until = 0;
    memset(loop->sensor, 0, (size_t)loop->sensors * sizeof *loop->sensor);
    for (int k = 0; k <= loop->design->loads; k++)
        set_load(loop, k, loop->scheduled_load[k]);
    for (int k = 0; k < loop->design->amplifiers; k++)
        repair_electrode(loop, k);
}

/*
 * Set the factors of the known loads that are passed to the controller for the next tick. The
 * controller knows these factors one tick in advance.
 */
static void set_next_loads(loop *loop, int tick)
{
    const scene_simulate *simulate = &loop->design->simulate;
    memcpy(loop->next_load, loop->known_load,
           (size_t)loop->design->loads * sizeof *loop->known_load);
    for (int k = loop->next_event; k < simulate->events && simulate->event[k].tick == tick + 1; k++)
        if (simulate->event[k].feed_forward)
            loop->next_load[simulate->event[k].load] = simulate->event[k].size;
}

static void run_events(loop *loop, int tick)
{
    const scene_simulate *simulate = &loop->design->simulate;
    if (simulate->fault_chance > 0 && tick < simulate->fault_until &&
        random_uniform(&loop->random) < simulate->fault_chance)
        random_fault(loop, tick);
    if (simulate->fault_chance > 0 && tick == simulate->fault_until)
        end_faults(loop);
    for (; loop->next_event < simulate->events && simulate->event[loop->next_event].tick == tick;
         loop->next_event++)
        apply_scheduled_event(loop, &simulate->event[loop->next_event], tick);
    set_next_loads(loop, tick);
    for (int k = 0; k < loop->design->amplifiers; k++) {
        electrode *electrode = &loop->electrode[k];
        if (electrode->repaired_at == tick)
            repair_electrode(loop, k);
        if (electrode->announced_at == tick) {
            hold_electrode(loop, k, electrode->fault_voltage);
            electrode->is_held = true;
        }
    }
    for (int i = 0; i < loop->design->targets; i++)
        loop->wanted[i] = loop->factor * loop->goal[i];
}

imperfections loop_imperfections(loop *loop)
{
    return (imperfections){imperfections_of_scene(loop->design),
                           loop->electrode,
                           loop->sensor,
                           loop->sensors,
                           &loop->random,
                           loop->time};
}

/* ---- time between ticks ----------------------------------------------- */

/* Set the factors of the loads that have a sinusoidal part to their values at a given time (s). */
static void set_waves(loop *loop, double time)
{
    for (int k = 0; k < loop->design->loads; k++) {
        const wave *wave = &loop->wave[k];
        if (wave->until > 0)
            plant_load(&loop->simulation->plant, k,
                       loop->load[k] +
                           wave->amplitude * sin(two_pi * wave->frequency * (time - wave->start)));
    }
}

/* Whether the voltages on the ceramic or the loads vary between two ticks. */
static bool varies(const loop *loop)
{
    const imperfection_tables tables = imperfections_of_scene(loop->design);
    bool is_varying = imperfections_vary(&tables);
    for (int k = 0; k < loop->design->loads; k++)
        is_varying = is_varying || loop->wave[k].until > 0;
    return is_varying;
}

/*
 * Advance the simulated plant by a time during which the amplifiers are commanded to constant
 * voltages.
 */
static int advance_plant(loop *loop, const double *output, double seconds, char *error)
{
    const int parts = varies(loop) ? IMPERFECTION_PARTS : 1;
    const imperfections wiring = loop_imperfections(loop);
    for (int i = 0; i < parts && seconds > 0; i++) {
        const double part = seconds / parts;
        imperfections_actuate(&wiring, output, part, loop->effect);
        set_waves(loop, loop->time + part / 2);
        if (plant_elapse(&loop->simulation->plant, loop->effect, part, error) < 0)
            return -1;
        loop->time += part;
    }
    return 0;
}

/*
 * Return a random fraction of the tick interval for a disturbance of the timing, from 0 to
 * disturbance->size; 0 where the disturbance has ended. The caller uses it either as a delay of the
 * voltages after the tick, or as a change of the tick interval.
 */
static double random_part(loop *loop, const disturbance *disturbance, int tick)
{
    return tick < disturbance->until ? disturbance->size * random_uniform(&loop->random) : 0;
}

/*
 * Advance the simulated plant from the last tick to the present one. Returns 0, or -1 with error
 * filled.
 */
static int elapse_interval(loop *loop, int tick, char *error)
{
    const double nominal = 1 / loop->design->control.rate;
    const double late = random_part(loop, &loop->late, tick);
    const double sign = tick < loop->jitter.until && random_int(&loop->random, 2) ? -1 : 1;
    const double interval = nominal * (1 + sign * random_part(loop, &loop->jitter, tick));
    if (advance_plant(loop, loop->previous_output, late * interval, error) < 0 ||
        advance_plant(loop, loop->output, (1 - late) * interval, error) < 0)
        return -1;
    for (int k = 0; k < loop->design->loads; k++)
        if (loop->wave[k].until == tick) {
            loop->wave[k].until = 0;
            plant_load(&loop->simulation->plant, k, loop->load[k]);
        }
    return 0;
}

/* ---- step limit ------------------------------------------------------------- */

/*
 * Step limit of an electrode (V). An electrode that the controller holds at one voltage has no step
 * limit, because its voltage is set at once.
 */
static double step_limit_of(const loop *loop, int amplifier)
{
    return loop->electrode[amplifier].is_held ? HUGE_VAL : loop->design->step_limit[amplifier];
}

/* ---- control laws: step blocks of the simulation ------------------------ */

static size_t law_bytes(const void *tables, const pzs_problem *problem)
{
    return pzs_step_block.block_bytes(tables, problem);
}

static pzs_status law_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    return pzs_step_block.block_init(self, tables, signals);
}

static loop *loop_of(const pzs_loop_signals *signals)
{
    return ((const law_tables *)(const void *)signals->control->state.problem)->loop;
}

/*
 * Run one tick of the firmware on the board and on its twin, the firmware's C code on this
 * computer, and compare their results bit by bit. Returns the status of the board, or -1 with error
 * filled.
 */
static int run_board_tick(loop *loop, char *error)
{
    const size_t amplifiers = (size_t)loop->design->amplifiers, loads = (size_t)loop->design->loads;
    if (loop->simulation->feeds) {
        device_know(&loop->board, loop->load_when_read, loop->next_load, loads);
        device_know(&loop->twin, loop->load_when_read, loop->next_load, loads);
    }
    const int status = device_tick(&loop->board, loop->wanted, loop->sensed, loop->command,
                                   loop->state, &loop->iterations, error);
    int iterations = 0, same = -1;
    if (status < 0 || !loop->twin.board)
        return status;
    same = device_tick(&loop->twin, loop->wanted, loop->sensed, loop->twin_command,
                       loop->twin_state, &iterations, error);
    loop->twin_agrees =
        same == status && iterations == loop->iterations &&
        memcmp(loop->twin_command, loop->command, amplifiers * sizeof *loop->twin_command) == 0 &&
        memcmp(loop->twin_state, loop->state, amplifiers) == 0;
    return same < 0 ? -1 : status;
}

/*
 * Tick of the block (stage) that runs the firmware on a board in place of the library's step block.
 * The board gets the readings of the sensors, not the output of preceding blocks, which the
 * firmware contains itself.
 */
static pzs_status board_tick(void *self, pzs_loop_signals *signals)
{
    loop *loop = loop_of(signals);
    const int status = run_board_tick(loop, loop->message);
    (void)self;
    loop->is_silent = status < 0;
    if (loop->is_silent)
        return PZS_E_STAGE;
    memcpy(signals->control->state.voltage, loop->command,
           (size_t)loop->design->amplifiers * sizeof *loop->command);
    pzs_control_moved(signals->control);
    return (pzs_status)status;
}

static const pzs_block_type board_block = {"board",  PZS_PHASE_STEP, law_bytes,
                                           law_init, board_tick,     NULL};

/*
 * Whether a block of the scene that comes before the step block also runs on the host, in two
 * cases: in front of a control law for comparison, and beside a board that runs the controller.
 */
static bool is_kept(const pzs_block_type *type, int is_board)
{
    return type != &pzs_effect_block && type != &pzs_selftest_block &&
           !(is_board && type == &pzs_curve_block);
}

/*
 * Complete the list of blocks (stages of the control tick) of a control law that is simulated for
 * comparison with the library's controller. Where actuators have curves, the laws choose effects
 * (values proportional to the displacements of the actuators); the block appended here converts
 * these to voltages. Returns the new number of blocks.
 */
static size_t add_curve_inverse(loop *loop, const loop_blocks *all, size_t count)
{
    for (int k = 0; k < all->count; k++)
        if (all->block[k].type == &pzs_curve_inverse_block)
            loop->block[count++] = all->block[k];
    return count;
}

/*
 * List the blocks (stages of the control tick) that the simulated loop runs on the host: all blocks
 * of the scene for the library's controller. A control law for comparison, or a controller on a
 * board, has a step block of its own; self-test, compensation of hysteresis and all blocks after
 * the step are then left out, except that a law for comparison keeps the blocks of actuator curves.
 * Returns their number.
 */
static size_t list_blocks(loop *loop)
{
    const loop_blocks *all =
        loop->law == LAW_CONTROLLER ? loop->simulation->blocks : loop->simulation->undamped_blocks;
    const int is_board = loop->simulation->board && loop->law == LAW_CONTROLLER;
    size_t count = 0;
    memcpy(loop->block, all->block, sizeof loop->block);
    if (loop->law == LAW_CONTROLLER && !is_board)
        return (size_t)all->count;
    for (int k = 0; all->block[k].type->phase != PZS_PHASE_STEP; k++)
        if (is_kept(all->block[k].type, is_board))
            loop->block[count++] = all->block[k];
    loop->tables = (law_tables){*loop->simulation->problem, loop};
    loop->block[count] = is_board ? (pzs_block){&board_block, &loop->tables}
                                  : (pzs_block){&law_clipped_block, &loop->compared};
    count++;
    return is_board ? count : add_curve_inverse(loop, all, count);
}

/*
 * Initialise the library's control loop with the blocks (stages of a tick) of the simulated control
 * law. Returns the status of the library.
 */
static pzs_status open_controller(loop *loop)
{
    const size_t count = list_blocks(loop);
    double none;
    pzs_status status = pzs_loop_init(&loop->controller, loop->block, count, NULL, &none, 0);
    if (status != PZS_E_WORKSPACE)
        return status;
    const size_t need = (size_t)loop->controller.info.where;
    loop->controller_memory = malloc(need);
    return pzs_loop_init(&loop->controller, loop->block, count, NULL, loop->controller_memory,
                         need);
}

/*
 * Count the electrodes that the fault detector has reported in this tick, and mark them as held at
 * one voltage.
 */
static void count_detections(loop *loop, int tick)
{
    loop->detected = loop->falsely_detected = 0;
    for (int k = 0; k < loop->design->amplifiers; k++) {
        electrode *electrode = &loop->electrode[k];
        if (loop->state[k] != PZS_ELECTRODE_HELD || electrode->is_held)
            continue;
        electrode->is_held = true;
        loop->detected++;
        if (electrode->fault == ELECTRODE_GOOD)
            loop->falsely_detected++;
        else if (tick - electrode->failed_at > loop->detection_ticks)
            loop->detection_ticks = tick - electrode->failed_at;
    }
}

/*
 * Copy the results of the step block, the stage of a tick that computes the voltages, into the
 * simulated loop: voltages, iterations of the optimiser and electrode states.
 */
static void take_command(loop *loop)
{
    const size_t amplifiers = (size_t)loop->design->amplifiers;
    loop->iterations = loop->controller.info.control->info.iterations;
    memcpy(loop->command, loop->controller.info.voltage, amplifiers * sizeof *loop->command);
    if (loop->controller.info.electrode)
        memcpy(loop->state, loop->controller.info.electrode, amplifiers);
}

/*
 * Return the status of a tick for the counts of warnings in the results: that of the stage that
 * computes the voltages. The status by which the fault detector reports an electrode does not count
 * here, because reported electrodes are counted separately.
 */
static pzs_status counted_status(const loop *loop, pzs_status status)
{
    const pzs_block_type *block = loop->controller.info.block;
    const int is_other = loop->law != LAW_CONTROLLER || loop->board.board;
    if (PZS_IS_ERROR(status))
        return status;
    if (is_other && (!block || block->phase != PZS_PHASE_STEP))
        return PZS_OK;
    return status == PZS_W_ELECTRODE ? PZS_OK : status;
}

/*
 * Inform the controller of the ticks missed since the last one; in a simulation with a board, also
 * the firmware on the board and its twin (the firmware's C code on this computer).
 */
static void report_missed_ticks(loop *loop)
{
    if (loop->missed_ticks == 0)
        return;
    (void)pzs_loop_skip(&loop->controller, (uint32_t)loop->missed_ticks);
    device_skip(&loop->board, loop->missed_ticks);
    device_skip(&loop->twin, loop->missed_ticks);
    loop->missed_ticks = 0;
}

static int run_controller(loop *loop, int tick, char *error)
{
    report_missed_ticks(loop);
    if (loop->simulation->feeds) {
        loop->load_when_read = sense_known_loads(loop, tick);
        (void)pzs_loop_know(&loop->controller, loop->load_when_read, loop->next_load);
    }
    loop->message = error;
    const pzs_status status = pzs_loop_tick(&loop->controller, loop->wanted, loop->sensed);
    if (loop->is_silent)
        return -1;
    loop->status = counted_status(loop, status);
    if (PZS_IS_ERROR(status))
        return 0;
    sense_measurement_error(loop);
    if (!loop->board.board)
        take_command(loop);
    count_detections(loop, tick);
    return 0;
}

/* ---- amplifiers ------------------------------------------------------- */

/*
 * Compute the output voltages of all amplifiers from the commanded voltages: the amplifiers limit
 * the voltages and their changes, round them, and ignore small changes.
 */
static void set_outputs(loop *loop)
{
    const design *design = loop->design;
    const scene_simulate *simulate = &design->simulate;
    for (int k = 0; k < design->amplifiers; k++) {
        const amplifier amplifier = {design->lower[k], design->upper[k], step_limit_of(loop, k),
                                     simulate->step, simulate->dead_band};
        loop->output[k] = amplifier_output(&amplifier, loop->output[k], loop->command[k]);
    }
}

/*
 * Return the number of voltages beyond their voltage limits plus the number of voltage changes
 * beyond the step limit. The change is computed with 32 or 64 bits, the precision in which the
 * voltages were computed.
 */
static int count_beyond_limits(const loop *loop, const double *voltage, const double *before,
                               int bits)
{
    const design *design = loop->design;
    int count = 0;
    for (int k = 0; k < design->amplifiers; k++) {
        const double change =
            bits == 32 ? (double)((float)voltage[k] - (float)before[k]) : voltage[k] - before[k];
        count += !(voltage[k] >= design->lower[k] && voltage[k] <= design->upper[k]);
        count += !amplifier_may_move(0, change, step_limit_of(loop, k));
    }
    return count;
}

/*
 * Whether the limit of a sum of voltages with index k contains an amplifier that is held at a fixed
 * voltage. The controller does not choose this voltage.
 */
static bool has_held_amplifier(const loop *loop, const pzs_rows *sums, uint32_t k)
{
    for (uint32_t entry = sums->start[k]; entry < sums->start[k + 1]; entry++)
        if (loop->electrode[sums->dof[entry]].is_held)
            return true;
    return false;
}

int loop_beyond_rows(const loop *loop, const double *voltage, int bits)
{
    const pzs_problem *problem = &loop->design->problem;
    const pzs_limit_rows *rows = problem->limit_rows;
    const double unit = bits == 32 ? (double)FLT_EPSILON / DBL_EPSILON : 1;
    int count = 0;
    for (uint32_t k = 0; rows && k < rows->sums.count; k++) {
        const double sum = pzs_limit_rows_sum(rows, k, voltage);
        const double error = unit * pzs_limit_rows_margin(problem, k);
        const bool is_inside = sum >= rows->lower[k] - error && sum <= rows->upper[k] + error;
        count += !is_inside && !has_held_amplifier(loop, &rows->sums, k);
    }
    return count;
}

static int count_not_finite(const loop *loop)
{
    int count = 0;
    for (int k = 0; k < loop->design->amplifiers; k++)
        count += !isfinite(loop->command[k]) + !isfinite(loop->output[k]);
    return count;
}

int loop_active(const loop *loop)
{
    int count = 0;
    for (int k = 0; k < loop->design->amplifiers; k++)
        count += loop->command[k] <= loop->design->lower[k] ||
                 loop->command[k] >= loop->design->upper[k];
    return count;
}

/* ---- one tick of the loop --------------------------------------------- */

/*
 * Return the end of an error message: why the supervisor has ended control, and what the user can
 * do. The text is empty where the supervisor runs in a firmware on a board or has not ended
 * control.
 */
static const char *latch_cause(const loop *loop)
{
    static const char *const text[PZS_EVENTS] = {
        [PZS_EVENT_STOP] = "; cause: the command for an emergency stop",
        [PZS_EVENT_TIMEOUT] =
            "; cause: no usable readings, or no finite target, for safety.timeout ticks; shorten "
            "the events without readings, or write a longer timeout",
        [PZS_EVENT_ALARM] =
            "; cause: the readings stayed too far from the shapes that the tables predict; name "
            "expected loads in loads, bring plant, delay and noise of simulate nearer to what the "
            "tables hold, write a rate that pzs check calls stable, or let safety.selftest find "
            "reversed and swapped amplifiers",
        [PZS_EVENT_ERROR] =
            "; cause: a block of the loop returned an error, as for a target that is not finite; "
            "safety: none shows the error"};
    const pzs_supervisor *supervisor = pzs_loop_find(&loop->controller, &pzs_supervisor_block);
    if (loop->status != PZS_E_LATCHED || !supervisor || supervisor->info.cause >= PZS_EVENTS)
        return "";
    if (supervisor->info.cause == PZS_EVENT_ALARM && supervisor->info.is_opposed)
        return "; cause: the structure moved against the shapes that the tables predict, or not at "
               "all, as with reversed amplifiers or stuck sensors; safety.selftest names reversed "
               "and swapped amplifiers";
    if (supervisor->info.cause == PZS_EVENT_TIMEOUT && supervisor->info.is_stuck)
        return "; cause: all readings repeated, although the voltages should have moved the "
               "structure, for safety.timeout ticks and more; shorten the events with stuck "
               "sensors, or write a longer timeout";
    const char *cause = text[supervisor->info.cause];
    return cause ? cause : "";
}

int loop_tick(loop *loop, int tick, char *error)
{
    const size_t amplifiers = (size_t)loop->design->amplifiers;
    if (tick > 0 && elapse_interval(loop, tick, error) < 0)
        return -1;
    run_events(loop, tick);
    set_waves(loop, loop->time);
    const imperfections wiring = loop_imperfections(loop);
    imperfections_actuate(&wiring, loop->output, 0, loop->effect);
    memcpy(loop->previous_output, loop->output, amplifiers * sizeof *loop->previous_output);
    if (plant_shape(&loop->simulation->plant, loop->effect, loop->shape, error) < 0)
        return -1;
    loop->error =
        sqrt(design_squares(loop->design, loop->shape, loop->wanted)) / loop->simulation->reference;
    loop->vibration = plant_vibration(&loop->simulation->plant) / loop->simulation->reference;
    if (sense_tick(loop, tick, error) < 0)
        return -1;
    loop->is_missed = tick < loop->missed_until;
    loop->beyond_limits = loop->beyond_rows = loop->not_finite = 0;
    loop->missed_ticks += loop->is_missed;
    if (loop->is_missed)
        return 0;
    memcpy(loop->last_voltage, loop->command, amplifiers * sizeof *loop->last_voltage);
    if (run_controller(loop, tick, error) < 0)
        return -1;
    const int bits = loop->board.board ? loop->board.board->bits : 64;
    loop->beyond_limits = count_beyond_limits(loop, loop->command, loop->last_voltage, bits);
    memcpy(loop->last_voltage, loop->output, amplifiers * sizeof *loop->last_voltage);
    set_outputs(loop);
    loop->beyond_limits += count_beyond_limits(loop, loop->output, loop->last_voltage, 64);
    loop->beyond_rows =
        loop_beyond_rows(loop, loop->command, bits) + loop_beyond_rows(loop, loop->output, bits);
    loop->not_finite = count_not_finite(loop);
    if (!PZS_IS_ERROR(loop->status))
        return 0;
    return scene_fault(loop->design->simulate.at, error, "tick %d: %s%s", tick,
                       pzs_status_text(loop->status), latch_cause(loop));
}

/* ---- self-test -------------------------------------------------------- */

/*
 * Let the electrodes fail that the scene's list of events declares dead or stuck at tick 0.
 */
static void fail_first_electrodes(loop *loop)
{
    const scene_simulate *simulate = &loop->design->simulate;
    for (int k = 0; k < simulate->events && simulate->event[k].tick == 0; k++)
        if (simulate->event[k].type == EVENT_DEAD || simulate->event[k].type == EVENT_STUCK)
            fail_electrodes(loop, &simulate->event[k], 0);
}

/*
 * Let the sensors fail that the scene's list of events declares missing or stuck at tick 0. They
 * fail during all ticks of the self-test, and then for the number of ticks that the event states.
 *   ticks in  number of ticks of the self-test
 */
static void fail_first_sensors(loop *loop, int ticks)
{
    const scene_simulate *simulate = &loop->design->simulate;
    for (int k = 0; k < simulate->events && simulate->event[k].tick == 0; k++)
        if (simulate->event[k].type == EVENT_MISSING_SENSORS ||
            simulate->event[k].type == EVENT_STUCK_SENSORS)
            fail_sensors(loop, &simulate->event[k], ticks);
    loop->has_failed_sensors = true;
}

/*
 * After the self-test ticks are counted from 0 again. Sensor failures of tick 0, which began before
 * the self-test, therefore end `ticks` earlier in the new count.
 *   ticks in  number of ticks of the self-test
 */
static void shift_first_sensors(loop *loop, int ticks)
{
    for (int i = 0; i < loop->sensors; i++) {
        loop->sensor[i].nan_until -= loop->sensor[i].nan_until > 0 ? ticks : 0;
        loop->sensor[i].stuck_until -= loop->sensor[i].stuck_until > 0 ? ticks : 0;
    }
}

/*
 * Run one tick of the self-test of amplifiers, cables and sensors. Returns 0, or -1 with error
 * filled.
 */
static int run_selftest_tick(loop *loop, int tick, char *error)
{
    const size_t amplifiers = (size_t)loop->design->amplifiers;
    if (tick > 0 && advance_plant(loop, loop->output, 1 / loop->design->control.rate, error) < 0)
        return -1;
    const imperfections wiring = loop_imperfections(loop);
    imperfections_actuate(&wiring, loop->output, 0, loop->effect);
    memcpy(loop->previous_output, loop->output, amplifiers * sizeof *loop->previous_output);
    if (plant_shape(&loop->simulation->plant, loop->effect, loop->shape, error) < 0 ||
        sense_tick(loop, tick, error) < 0 || run_controller(loop, tick, error) < 0)
        return -1;
    if (loop->twin.board && !loop->twin_agrees)
        return scene_fault(loop->design->simulate.at, error,
                           "self-test, tick %d: the board and this computer differ", tick);
    if (!PZS_IS_ERROR(loop->status))
        set_outputs(loop);
    return 0;
}

/*
 * Store what the self-test of amplifiers, cables and sensors has found, and write it as an error
 * message.
 */
static int refuse(const loop *loop, char *error)
{
    const pzs_selftest *selftest = pzs_loop_find(&loop->controller, &pzs_selftest_block);
    char *text = loop->simulation->findings;
    if (selftest) {
        loop->simulation->verdict = selftest->info.verdict;
        wiring_test_findings(selftest, loop->simulation->nominal, text);
    }
    if (!*text)
        snprintf(text, SCENE_ERROR, "%s", pzs_status_text(loop->status));
    return scene_fault(loop->design->simulate.at, error,
                       "self-test: %s; mend what is named, or write the amplitude and the "
                       "pulse_ticks that pzs check gives",
                       text);
}

int loop_selftest(loop *loop, char *error)
{
    const int ticks = (int)wiring_test_ticks(&loop->simulation->wiring);
    loop->status = PZS_W_SELFTEST;
    if (loop->law != LAW_CONTROLLER || !loop->simulation->wiring.is_used)
        return 0;
    fail_first_electrodes(loop);
    fail_first_sensors(loop, ticks);
    memcpy(loop->wanted, loop->goal, (size_t)loop->design->targets * sizeof *loop->wanted);
    for (int tick = 0; tick < ticks && loop->status == PZS_W_SELFTEST; tick++)
        if (run_selftest_tick(loop, tick, error) < 0)
            return -1;
    shift_first_sensors(loop, ticks);
    return PZS_IS_ERROR(loop->status) ? refuse(loop, error) : 0;
}

/* ---- start of the loop ------------------------------------------------ */

static int take_memory(loop *loop)
{
    const design *design = loop->design;
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets,
                 loads = (size_t)design->loads + 1;
    double *at = loop->memory =
        calloc(4 * targets + 2 * loads + 6 * amplifiers, sizeof *loop->memory);
    loop->electrode = calloc(amplifiers, sizeof *loop->electrode);
    loop->wave = calloc(loads, sizeof *loop->wave);
    loop->state = calloc(2 * amplifiers, 1);
    if (!at || !loop->electrode || !loop->wave || !loop->state || !sense_open(loop))
        return 0;
    loop->twin_state = loop->state + amplifiers;
    double **const of_targets[] = {&loop->goal, &loop->wanted, &loop->shape, &loop->scratch};
    double **const of_amplifiers[] = {&loop->command,      &loop->output,
                                      &loop->effect,       &loop->twin_command,
                                      &loop->last_voltage, &loop->previous_output};
    for (int i = 0; i < 4; i++, at += targets)
        *of_targets[i] = at;
    for (int i = 0; i < 6; i++, at += amplifiers)
        *of_amplifiers[i] = at;
    loop->load = at, at += loads;
    loop->scheduled_load = at;
    return 1;
}

static void reset_loop(loop *loop)
{
    const design *design = loop->design;
    loop->random = (uint64_t)design->simulate.seed;
    loop->factor = loop->scheduled_factor = 1;
    memcpy(loop->goal, design->target, (size_t)design->targets * sizeof *loop->goal);
    memcpy(loop->command, loop->controller.info.voltage,
           (size_t)design->amplifiers * sizeof *loop->command);
    memcpy(loop->output, loop->command, (size_t)design->amplifiers * sizeof *loop->output);
    memcpy(loop->last_voltage, loop->command,
           (size_t)design->amplifiers * sizeof *loop->last_voltage);
    for (int k = 0; k < design->loads; k++)
        loop->load[k] = loop->scheduled_load[k] = 1;
    for (int k = 0; k < design->amplifiers; k++)
        loop->electrode[k].announced_at = loop->electrode[k].repaired_at = -1;
    for (int k = 0; k < design->amplifiers; k++)
        loop->electrode[k].output = loop->output[k];
    const imperfections wiring = loop_imperfections(loop);
    imperfections_draw(&wiring);
    plant_rest(&loop->simulation->plant);
}

/*
 * Start the firmware on the board and its twin, the firmware's C code on this computer, and read
 * their initial voltages. Returns 0, or -1 with error filled.
 */
static int start_board(loop *loop, char *error)
{
    const simulation *simulation = loop->simulation;
    const device_board *twin = device_find(simulation->board->twin);
    if (twin && device_start(&loop->twin, twin, simulation->folder, simulation->problem,
                             loop->sensors, loop->command, error) < 0)
        return -1;
    if (device_start(&loop->board, simulation->board, simulation->folder, simulation->problem,
                     loop->sensors, loop->command, error) < 0)
        return -1;
    memcpy(loop->output, loop->command, (size_t)loop->design->amplifiers * sizeof *loop->output);
    memcpy(loop->last_voltage, loop->command,
           (size_t)loop->design->amplifiers * sizeof *loop->last_voltage);
    for (int k = 0; k < loop->design->amplifiers; k++)
        loop->electrode[k].output = loop->output[k];
    return 0;
}

int loop_open(loop *loop, simulation *simulation, simulate_law law, char *error)
{
    const design *design = &simulation->nominal->design;
    memset(loop, 0, sizeof *loop);
    loop->design = &simulation->nominal->design;
    loop->simulation = simulation;
    loop->law = law;
    loop->is_damped = law == LAW_CONTROLLER && simulation->damper.is_used;
    if (!take_memory(loop))
        return scene_fault(design->simulate.at, error, "out of memory");
    if (law != LAW_CONTROLLER &&
        !law_open(&loop->compared, simulation->problem,
                  law == LAW_REGULARISED ? simulation->compared_regularisation : 0))
        return scene_fault(design->simulate.at, error, "out of memory");
    const pzs_status status = open_controller(loop);
    const pzs_block_type *block = loop->controller.info.block;
    if (status != PZS_OK)
        return scene_fault(design->limits.at, error, "%s: %s", block ? block->name : "control loop",
                           pzs_status_text(status));
    reset_loop(loop);
    return simulation->board && law == LAW_CONTROLLER ? start_board(loop, error) : 0;
}

void loop_close(loop *loop)
{
    free(loop->memory);
    free(loop->electrode);
    free(loop->wave);
    free(loop->state);
    free(loop->controller_memory);
    law_close(&loop->compared);
    sense_close(loop);
    device_stop(&loop->board);
    device_stop(&loop->twin);
    memset(loop, 0, sizeof *loop);
}
