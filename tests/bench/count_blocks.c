/*
 * Instructions of each block of a control loop on a Cortex-M under QEMU, or on the host to compare
 * the bits. The loop is the list of blocks in the generated header DEMO_TABLES, whatever blocks it
 * holds, so that one program counts every loop.
 *
 * The plant responds more weakly than the tables say, and vibrates in the modes of the tables. In
 * the calm ticks the target moves slowly; the last hundred of them are the warm ticks. The
 * following SEARCHED ticks search for the longest tick: targets jump between the shapes of random
 * voltages, sensors fall silent or repeat their readings, ticks are missed, and amplifiers are held
 * and released.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <string.h>
#include "pzs.h"
#include "../../firmware_demo/boards/board.h"
#include "../../firmware_demo/demos/print.h"
#include "../../lib/core/guard.h"
#include DEMO_TABLES

#ifndef SEARCHED
#define SEARCHED 2000
#endif
#ifndef DEMO_MODES
#define DEMO_MODES 0
#endif

#define GAIN PZS_R(0.9) /* response of the plant to a voltage, divided by that of the tables */
#define MODE_COUNT (DEMO_MODES + 1) /* number of modes plus 1, because an array needs an entry */

enum { CALM = 300, WARM = 200, EPISODE = 64, COMMISSIONED = 20000 };

/* Numbers of instructions: sums over all ticks and over the warm ticks, and the most of a tick. */
typedef struct cost {
    uint64_t total;
    uint32_t warm, most;
} cost;

static cost block_cost[DEMO_BLOCKS], rest_cost, loop_cost, led_cost;
static pzs_block_type counted_type[DEMO_BLOCKS];
static pzs_block counted[DEMO_BLOCKS];
static uint32_t next_block; /* first block of the list that has not run yet in this tick */
static uint32_t spent_in[DEMO_BLOCKS]; /* instructions of each block in this tick */
static int tick_number;

static uint64_t loop_work[DEMO_LOOP_BYTES / sizeof(uint64_t) + 2u];
static pzs_real wanted[DEMO_OUTPUTS], readings[DEMO_READINGS];
static pzs_real position[MODE_COUNT], velocity[MODE_COUNT], deviation[MODE_COUNT];
static pzs_loop loop;
static uint32_t seed = 1;

/* Random number from 0 to 1. */
static pzs_real uniform(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (pzs_real)(seed >> 8) / PZS_R(16777216.0);
}

/* ---- counting ---------------------------------------------------------- */

static void add(cost *sum, uint32_t spent)
{
    const bool is_warm = tick_number >= WARM && tick_number < CALM;
    sum->total += spent;
    sum->warm += is_warm ? spent : 0;
    sum->most = spent > sum->most ? spent : sum->most;
}

/*
 * Run and count a block of the list: the first one that has not run yet in this tick and whose
 * tables are those of the running block.
 */
static pzs_status counted_tick(void *self, pzs_loop_signals *signals)
{
    while (demo_blocks[next_block].tables != signals->tables)
        next_block++;
    const uint32_t block = next_block++;
    const uint32_t from = board_count();
    const pzs_status status = demo_blocks[block].type->block_tick(self, signals);
    spent_in[block] = board_instructions(from, board_count());
    return status;
}

static void wrap_blocks(void)
{
    for (uint32_t k = 0; k < DEMO_BLOCKS; k++) {
        counted_type[k] = *demo_blocks[k].type;
        counted_type[k].block_tick = counted_tick;
        counted[k] = (pzs_block){&counted_type[k], demo_blocks[k].tables};
    }
}

static void print_cost(const char *name, const cost *sum)
{
    print_text("count ");
    print_text(name);
    print_count("mean", (uint32_t)(sum->total / (CALM + SEARCHED)));
    print_count("worst", sum->most);
    print_count("warm", sum->warm / (CALM - WARM));
    print_text("\n");
}

/* ---- plant ------------------------------------------------------------- */

/* Shape, or readings of a few sensors, per voltage and per mode. */
#ifdef DEMO_SENSORS
#define READING_PER_VOLT demo_direct
#define READING_PER_MODE demo_mode_reading
#else
#define READING_PER_VOLT demo_influence
#define READING_PER_MODE demo_mode_shape
#endif

/* Move the modes of the plant by one tick under the present voltages. */
static void vibrate(const pzs_real *voltage)
{
#if DEMO_MODES > 0
    for (int k = 0; k < DEMO_MODES; k++) {
        pzs_real rest = 0;
        for (int j = 0; j < DEMO_INPUTS; j++)
            rest += GAIN * demo_modal[k * DEMO_INPUTS + j] * voltage[j];
        const pzs_real d = position[k] - rest, speed = velocity[k];
        deviation[k] = demo_turn[k] * d + demo_turn[DEMO_MODES + k] * speed;
        position[k] = rest + deviation[k];
        velocity[k] = demo_turn[2 * DEMO_MODES + k] * d + demo_turn[3 * DEMO_MODES + k] * speed;
    }
#endif
    for (int i = 0; i < DEMO_READINGS; i++) {
        readings[i] = 0;
        for (int j = 0; j < DEMO_INPUTS; j++)
            readings[i] += GAIN * READING_PER_VOLT[i * DEMO_INPUTS + j] * voltage[j];
#if DEMO_MODES > 0
        for (int k = 0; k < DEMO_MODES; k++)
            readings[i] += READING_PER_MODE[i * DEMO_MODES + k] * deviation[k];
#endif
    }
}

/* Let the target be the shape of random voltages up to `size` times the limits. */
static void jump(pzs_real size)
{
    for (int i = 0; i < DEMO_OUTPUTS; i++)
        wanted[i] = 0;
    for (int j = 0; j < DEMO_INPUTS; j++) {
        const pzs_real voltage = size * demo_upper[j] * (2 * uniform() - 1);
        for (int i = 0; i < DEMO_OUTPUTS; i++)
            wanted[i] += voltage * demo_influence[i * DEMO_INPUTS + j];
    }
}

/*
 * Run and count one tick of the loop. Ticks in which the supervisor ramps, tests or keeps the
 * voltages are counted apart (led): its block takes longer, and the optimiser less. A loop that the
 * supervisor has stopped starts again.
 */
static pzs_status count_tick(void)
{
    uint32_t in_blocks = 0;
    memset(spent_in, 0, sizeof spent_in);
    next_block = 0;
    const uint32_t from = board_count();
    const pzs_status status = pzs_loop_tick(&loop, wanted, readings);
    const uint32_t spent = board_instructions(from, board_count());
    if (status == PZS_E_LATCHED) {
        (void)pzs_loop_start(&loop, loop.info.voltage);
        return PZS_W_PARKED;
    }
    if (status == PZS_W_RAMP || status == PZS_W_PARKED || status == PZS_W_POLARITY) {
        add(&led_cost, spent);
        return status;
    }
    for (uint32_t k = 0; k < DEMO_BLOCKS; k++) {
        add(&block_cost[k], spent_in[k]);
        in_blocks += spent_in[k];
    }
    add(&rest_cost, spent - in_blocks);
    if (status != PZS_W_SELFTEST)
        add(&loop_cost, spent);
    return status;
}

/* ---- start ---------------------------------------------------------------- */

/*
 * Pass the values of the known loads to the loop, which are constant. They matter only to a loop
 * with a feed-forward block.
 */
static void tell_loads(void)
{
#ifdef DEMO_LOADS
    static pzs_real load[DEMO_LOADS];
    for (int i = 0; i < DEMO_LOADS; i++)
        load[i] = PZS_R(0.5);
    (void)pzs_loop_know(&loop, load, load);
#endif
}

/* Run the self-test, if the loop has one, and let the loop run whatever its findings are. */
static pzs_status commission(void)
{
    pzs_status status = PZS_W_SELFTEST;
    tick_number = CALM;
    for (int tick = 0; tick < COMMISSIONED && status == PZS_W_SELFTEST; tick++) {
        vibrate(loop.info.voltage);
        status = count_tick();
    }
    if (status != PZS_E_SELFTEST)
        return status;
    for (uint32_t k = 0; k < DEMO_BLOCKS; k++)
        if (demo_blocks[k].type == &pzs_selftest_block)
            (void)pzs_selftest_accept(pzs_loop_find(&loop, &counted_type[k]));
    return PZS_OK;
}

/* ---- search for the longest tick ---------------------------------------- */

/* Hold or release a random amplifier. */
static void hold_some(void)
{
    const uint16_t input = (uint16_t)(uniform() * DEMO_INPUTS) % DEMO_INPUTS;
    if (uniform() < PZS_R(0.5))
        (void)pzs_hold(loop.info.control, input, (2 * uniform() - 1) * demo_upper[input]);
    else
        (void)pzs_release(loop.info.control, input);
}

/* Let readings of some sensors be missing. */
static void silence(void)
{
    const pzs_real part = uniform();
    for (int i = 0; i < DEMO_READINGS; i++)
        readings[i] = uniform() < part ? (pzs_real)NAN : readings[i];
}

/*
 * Let a random part of the sensors, in half of the cases all of them, repeat their readings, while
 * one other reading is missing in every second tick.
 *   tick in  number of the tick; the readings of every 32nd tick are those that are repeated
 */
static void freeze(int tick)
{
    static pzs_real frozen[DEMO_READINGS];
    static bool is_frozen[DEMO_READINGS];
    const bool is_first = tick % (EPISODE / 2) == 0;
    const pzs_real part = is_first ? 2 * uniform() : 0;
    for (int i = 0; i < DEMO_READINGS; i++) {
        is_frozen[i] = is_first ? uniform() < part : is_frozen[i];
        frozen[i] = is_first ? readings[i] : frozen[i];
        readings[i] = is_frozen[i] ? frozen[i] : readings[i];
    }
    if (tick % 2 == 1)
        readings[tick % DEMO_READINGS] = (pzs_real)NAN;
}

/* Whether the loop has a block of this type. */
static bool has_block(const pzs_block_type *type)
{
    bool is_there = false;
    for (uint32_t k = 0; k < DEMO_BLOCKS; k++)
        is_there = is_there || demo_blocks[k].type == type;
    return is_there;
}

/* Let up to six sensors be wrong, the same ones for 16 ticks; not those that read 0 on supports. */
static void falsify(int tick)
{
    int sensor = tick / 16;
    for (int i = 0; i < tick / 16 % 7; i++) {
        sensor = (sensor * 31 + 17) % DEMO_READINGS;
        if (PZS_ABS(readings[sensor]) > 0)
            readings[sensor] += PZS_R(0.01) * ((pzs_real)(i + 1) + PZS_R(0.01) * uniform());
    }
}

/*
 * Return the number of ticks with the same kinds of disturbances. A fault detector that makes test
 * pulses needs long ones, because it ends its pulses only while the target stands still.
 */
static int episode_ticks(void)
{
    return has_block(&pzs_pulse_detector_block) ? 8 * EPISODE : EPISODE;
}

/*
 * Whether a tick of the search for the longest tick is in its second half, and the loop has a fault
 * detector that takes repeated readings for faulty electrodes. It finds most electrodes faulty if
 * readings repeat in all episodes, and the corrections for faulty electrodes take longest then.
 */
static bool is_misled(int tick)
{
    return has_block(&pzs_fault_detector_block) && tick >= SEARCHED / 2;
}

/*
 * Whether a tick of the search for the longest tick is in one of the episodes in which the target
 * stands still and nothing else is disturbed, so that a fault detector can complete test pulses
 * on the dead electrode.
 */
static bool stands_still(int tick)
{
    const int episode = episode_ticks();
    return has_block(&pzs_pulse_detector_block) && tick % (4 * episode) >= 3 * episode;
}

/* Targets and disturbances of one tick of the search; each episode has its own kinds of them. */
static void disturb(int tick)
{
    static int hold;
    static pzs_real size;
    static bool is_silent, is_late, is_frozen;
    const int episode = episode_ticks();
    if (tick % episode == 0) {
        hold = 1 << 2 * (int)(uniform() * (episode > EPISODE ? 6 : 4));
        size = PZS_R(0.2) + PZS_R(1.8) * uniform();
        is_silent = uniform() < PZS_R(0.2);
        is_late = uniform() < PZS_R(0.2);
        is_frozen = uniform() < (is_misled(tick) ? 1 : PZS_R(0.3));
    }
    if (stands_still(tick)) {
        if (tick % episode == 0)
            jump(PZS_R(0.5));
        return;
    }
    if (is_frozen)
        freeze(tick);
    if (tick % hold == 0)
        jump(size);
    if (has_block(&pzs_sensor_gate_block))
        falsify(tick);
    if (is_silent && tick % 4 == 0)
        silence();
    if (is_late && tick % 8 == 0)
        (void)pzs_loop_skip(&loop, 1u + (uint32_t)(uniform() * 2));
    if (tick % EPISODE == EPISODE / 2)
        hold_some();
}

/*
 * Return the voltages [DEMO_INPUTS] that act on the plant. In half of the search for the longest
 * tick the first electrode is dead where the loop looks for faults by test pulses.
 */
static const pzs_real *acting_voltages(int tick)
{
    static pzs_real acting[DEMO_INPUTS];
    const bool is_dead = has_block(&pzs_pulse_detector_block);
    memcpy(acting, loop.info.voltage, sizeof acting);
    if (is_dead && tick >= CALM && tick % (4 * episode_ticks()) >= 2 * episode_ticks())
        acting[0] = 0;
    return acting;
}

static pzs_status run(int tick)
{
    tick_number = tick;
    vibrate(acting_voltages(tick));
    if (tick >= CALM)
        disturb(tick - CALM);
    for (int i = 0; tick < CALM && i < DEMO_OUTPUTS; i++)
        wanted[i] = (1 - PZS_R(0.001) * (pzs_real)tick) * demo_target[i];
    return count_tick();
}

/* ---- bits --------------------------------------------------------------- */

/* Add a number to a checksum. A NaN counts as 0, because its bits depend on the processor. */
static uint32_t add_number(uint32_t crc, pzs_real number)
{
    const pzs_real added = number == number ? number : 0;
    return pzs_guard_crc(crc, &added, sizeof added);
}

/*
 * Add to a checksum what the blocks tell of the last tick beside the voltages: estimates by which
 * damper, supervisor, self-test and fault detector decide, and whose last bits hardly ever reach a
 * voltage.
 */
static uint32_t add_findings(uint32_t crc, pzs_status status)
{
    crc = add_number(crc, (pzs_real)status);
    for (uint32_t k = 0; k < DEMO_BLOCKS; k++) {
        const pzs_block_type *type = demo_blocks[k].type;
        const void *block = pzs_loop_find(&loop, &counted_type[k]);
        if (type == &pzs_vibration_block) {
            const pzs_damper *damper = block;
            crc = add_number(add_number(crc, damper->info.deviation), damper->info.innovation);
        } else if (type == &pzs_supervisor_block) {
            const pzs_supervisor *supervisor = block;
            crc = add_number(crc, supervisor->info.amplitude);
            crc = add_number(crc, supervisor->info.threshold);
        } else if (type == &pzs_selftest_block) {
            crc = add_number(crc, ((const pzs_selftest *)block)->info.gain);
        } else if (type == &pzs_pulse_detector_block) {
            crc = add_number(crc, ((const pzs_pulse_detector *)block)->info.gain);
        }
    }
    return crc;
}

int main(void)
{
    uint32_t crc = GUARD_CRC_START, findings = GUARD_CRC_START;
    board_start();
    wrap_blocks();
    pzs_status worst =
        pzs_loop_init(&loop, counted, DEMO_BLOCKS, NULL, loop_work, sizeof loop_work);
    tell_loads();
    if (worst == PZS_OK)
        worst = commission();
    for (int tick = 0; tick < CALM + SEARCHED && !PZS_IS_ERROR(worst); tick++) {
        const pzs_status status = run(tick);
        worst = status > worst ? status : worst;
        crc = pzs_guard_crc(crc, loop.info.voltage, DEMO_INPUTS * sizeof(pzs_real));
        findings = add_findings(findings, status);
    }
    for (uint32_t k = 0; k < DEMO_BLOCKS; k++)
        print_cost(demo_blocks[k].type->name, &block_cost[k]);
    print_cost("loop", &rest_cost);
    print_cost("all", &loop_cost);
    print_cost("led", &led_cost);
    print_text("count bytes");
    print_count("loop", sizeof loop_work);
    print_count("stack", board_stack_used());
    print_text("\nbits");
    print_hex("voltages", ~crc);
    print_hex("findings", ~findings);
    print_count("status", worst);
    print_text("\n");
    return PZS_IS_ERROR(worst);
}
