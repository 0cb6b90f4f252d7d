/*
 * The sensor gate of a generated header DEMO_TABLES in either precision, in its damped loop, around
 * a plant that responds more weakly than the tables say and vibrates in their modes.
 *
 *   sweep_gate_tables [TICKS]   default 40000
 *
 * Runs episodes of 500 ticks: the target jumps, then one random sensor is wrong for 80 ticks, then
 * right again. Prints how many wrong sensors were found, in which tick, and how many were trusted
 * again. Returns 0 where no healthy reading is gated, every error of twice the threshold is found
 * in its first tick, a drift before it ends, and every sensor is trusted again.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "pzs.h"
#include DEMO_TABLES

enum { EPISODE = 500, WRONG_FROM = 200, WRONG_UNTIL = 280 };

/* How a sensor is wrong. */
typedef enum fault { OFFSET, STUCK, REVERSED, NOISY, DRIFTING, BROKEN, FAULTS } fault;

static const char *const fault_name[FAULTS] = {
    "offset", "stuck at a value", "sign reversed", "noisy", "drifting", "now silent, now wrong"};

/*
 * Numbers of faults of one kind: all whose error is twice the threshold of the sensor in their last
 * tick and, but for a drift, in their first one; found in the first tick; found in the last one.
 * `others` had smaller errors. `trusted`: sensors that were trusted again, of all and others.
 */
typedef struct tally {
    int all, at_once, found, others, trusted;
} tally;

static uint64_t loop_work[DEMO_LOOP_BYTES / sizeof(uint64_t) + 2u];
static pzs_real wanted[DEMO_OUTPUTS], readings[DEMO_READINGS];
static double position[DEMO_MODES], velocity[DEMO_MODES];
static pzs_loop loop;
static uint64_t random_state = 1;

/* Random number between two others. */
static double uniform(double low, double high)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(random_state >> 40) / 16777216.0;
}

/* Move the plant by one tick under the present voltages, and read its sensors with noise. */
static void vibrate(void)
{
    const double gain = 0.9;
    double deviation[DEMO_MODES];
    for (int k = 0; k < DEMO_MODES; k++) {
        double rest = 0;
        for (int j = 0; j < DEMO_INPUTS; j++)
            rest += gain * (double)demo_modal[k * DEMO_INPUTS + j] * (double)loop.info.voltage[j];
        const double d = position[k] - rest, speed = velocity[k];
        deviation[k] = (double)demo_turn[k] * d + (double)demo_turn[DEMO_MODES + k] * speed;
        position[k] = rest + deviation[k];
        velocity[k] = (double)demo_turn[2 * DEMO_MODES + k] * d +
                      (double)demo_turn[3 * DEMO_MODES + k] * speed;
    }
    for (int i = 0; i < DEMO_READINGS; i++) {
        double sum = uniform(-1e-7, 1e-7);
        for (int j = 0; j < DEMO_INPUTS; j++)
            sum +=
                gain * (double)demo_influence[i * DEMO_INPUTS + j] * (double)loop.info.voltage[j];
        for (int k = 0; k < DEMO_MODES; k++)
            sum += (double)demo_mode_shape[i * DEMO_MODES + k] * deviation[k];
        readings[i] = (pzs_real)sum;
    }
}

/* Let the target be the shape of random voltages inside the limits. */
static void jump(void)
{
    memset(wanted, 0, sizeof wanted);
    for (int j = 0; j < DEMO_INPUTS; j++) {
        const pzs_real voltage = demo_upper[j] * (pzs_real)uniform(-1, 1);
        for (int i = 0; i < DEMO_OUTPUTS; i++)
            wanted[i] += voltage * demo_influence[i * DEMO_INPUTS + j];
    }
}

/*
 * Make the reading of a sensor wrong, `since` ticks after the fault began. Returns whether the
 * error is at least twice the threshold of the sensor, or the reading is missing.
 */
static bool falsify(fault fault, int sensor, double size, int since)
{
    const double right = (double)readings[sensor];
    double wrong = right + size;
    switch (fault) {
    case STUCK: wrong = size; break;
    case REVERSED: wrong = size - right; break;
    case NOISY: wrong = right + size * (uniform(0, 1) < 0.5 ? 1 : -1) * uniform(0.5, 1); break;
    case DRIFTING: wrong = right + 1e-5 * since; break;
    case BROKEN: wrong = uniform(0, 1) < 0.5 ? (double)NAN : right + size; break;
    default: break;
    }
    readings[sensor] = (pzs_real)wrong;
    return !(fabs(wrong - right) < 2 * (double)demo_gate_threshold[sensor]);
}

static const pzs_sensor_gate_state *gate(void)
{
    return pzs_loop_find(&loop, &pzs_sensor_gate_block);
}

/* Whether exactly one sensor is gated or missing. */
static bool is_found(int sensor)
{
    for (int i = 0; i < DEMO_READINGS; i++)
        if ((gate()->reading[i] != PZS_READING_USED) != (i == sensor))
            return false;
    return true;
}

/* Run one episode. Returns the number of ticks that gated a healthy reading or ended in an error.
 */
static int run_episode(tally *tally, fault fault)
{
    const int sensor = (int)uniform(0, DEMO_READINGS);
    const double size = pow(10, uniform(-3, -1.1)) * (uniform(0, 1) < 0.5 ? 1 : -1);
    bool is_large = true, is_at_once = false, is_at_end = false;
    int bad = 0;
    jump();
    for (int tick = 0; tick < EPISODE; tick++) {
        const bool is_first = tick == WRONG_FROM, is_last = tick == WRONG_UNTIL - 1;
        vibrate();
        if (tick >= WRONG_FROM && tick < WRONG_UNTIL) {
            const bool is_now = falsify(fault, sensor, size, tick - WRONG_FROM);
            const bool counts = (is_first && fault != DRIFTING) || is_last;
            is_large = is_large && (is_now || !counts);
        }
        bad += PZS_IS_ERROR(pzs_loop_tick(&loop, wanted, readings));
        const int others = gate()->info.count - (gate()->reading[sensor] > PZS_READING_MISSING);
        bad += others > 0 || (tick < WRONG_FROM && gate()->info.count > 0);
        is_at_once = is_at_once || (is_first && is_found(sensor));
        is_at_end = is_at_end || (is_last && is_found(sensor));
    }
    tally->all += is_large;
    tally->others += !is_large;
    tally->at_once += is_large && is_at_once;
    tally->found += is_large && is_at_end;
    tally->trusted += gate()->info.count == 0;
    return bad;
}

int main(int argc, char **argv)
{
    const int ticks = argc > 1 ? atoi(argv[1]) : 40000;
    tally of[FAULTS];
    int bad = 0, missed = 0;
    memset(of, 0, sizeof of);
    if (pzs_loop_init(&loop, demo_blocks, DEMO_BLOCKS, NULL, loop_work, sizeof loop_work) != PZS_OK)
        return 1;
    for (int episode = 0; episode < ticks / EPISODE; episode++)
        bad += run_episode(&of[episode % FAULTS], (fault)(episode % FAULTS));
    for (int k = 0; k < FAULTS; k++) {
        const bool is_at_once = k != DRIFTING;
        printf("# %-22s %5d faults, %5d found in the first tick, %5d at the end; %d smaller "
               "ones; %5d trusted again\n",
               fault_name[k], of[k].all, of[k].at_once, of[k].found, of[k].others, of[k].trusted);
        missed += of[k].all - of[k].found + of[k].all + of[k].others - of[k].trusted;
        missed += is_at_once ? of[k].all - of[k].at_once : 0;
    }
    printf("# %d ticks gated a healthy reading or ended in an error; %d faults missed\n", bad,
           missed);
    return bad > 0 || missed > 0;
}
