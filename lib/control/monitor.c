/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Divergence monitor of the supervisor: finds ticks whose measured shape the model cannot explain.
 * A tick is implausible in two cases:
 *
 *   - The structure deviates from the model by more than changes of the target, noise and the
 *     largest sudden load explain:
 *
 *         amplitude > 4 envelope + 6 noise + load
 *
 *     The envelope rises by the RMS of each change of the target, and decays. The amplitude is
 *     that of the vibration which the damper estimates, and of readings that it did not predict;
 *     without a damper the RMS of the disturbance. Readings and disturbance count less their
 *     low-passed values, so that steady loads and errors of the model do not.
 *   - The shape does not respond: over the last moves its measured changes had less than a tenth of
 *     the predicted size in the predicted direction. Causes: a wrong polarity, an amplifier that is
 *     switched off, or vibration in a loop without a vibration damper.
 *
 * The work of a tick is about 20 operations for each output; with a vibration damper, 5.
 */
#include <string.h>
#include "monitor.h"
#include "../core/guard.h"
#include "../core/numbers.h"

/*
 * Factor of `envelope` in the threshold of the divergence monitor (m, RMS over the outputs). A tick
 * is implausible if the measured shape deviates from the predicted one by more than
 *   envelope * MARGIN + noise * NOISE_MARGIN + load
 *   envelope  deviation that changes of the target explain
 *   noise     expected noise of the measured shape
 *   load      change of the shape by the largest expected sudden load
 */
#define MARGIN 4
/*
 * Factor of the RMS noise of the measured shape in the threshold of the divergence monitor: a tick
 * is implausible if the measured shape deviates from the predicted one by more than this threshold.
 */
#define NOISE_MARGIN 6
/*
 * Factor by which the divergence monitor multiplies its largest recent deviation of the measured
 * from the predicted shape in each tick, so that a single deviation is forgotten.
 */
#define PEAK_FADING PZS_R(0.9)
/*
 * Fraction by which the low-passed values of the divergence monitor approach their present values
 * in one tick, and by which its sums over the last changes of the shape decay in one tick.
 */
#define SLOW PZS_R(0.02)
/*
 * Smallest ratio of measured to predicted changes of the shape at which the structure counts as
 * responding to its voltages.
 */
#define LEAST_ANSWER PZS_R(0.1)
/*
 * The divergence monitor judges the response of the structure only if the predicted changes of the
 * shape are large enough: the root of their exponentially decaying sum of squares must exceed this
 * fraction of the shape change that the largest sudden load causes.
 */
#define LEAST_MOVE PZS_R(0.25)

void pzs_monitor_place(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs)
{
    monitor->slow = memory;
    monitor->disturbance = memory + outputs;
    monitor->predicted = memory + 2u * (size_t)outputs;
    monitor->move = memory + 3u * (size_t)outputs;
    monitor->wanted = memory + 4u * (size_t)outputs;
}

void pzs_monitor_init(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs)
{
    memset(monitor, 0, sizeof *monitor);
    memset(memory, 0, 5u * (size_t)outputs * sizeof *memory);
    pzs_monitor_place(monitor, memory, outputs);
}

/*
 * Results of the comparison of the measured and the predicted shape by the divergence monitor in
 * one tick: means over all outputs of squares or products of displacements (m2).
 */
typedef struct squares {
    pzs_real deviation; /* mean square over the outputs of the sudden deviation (m2): measured minus
                           predicted shape, minus the low-passed value of this difference */
    pzs_real target;    /* mean square of the change of the target shape in one tick (m2) */
    pzs_real moved;     /* mean square of the predicted change of the shape in one tick (m2) */
    pzs_real answered;  /* mean product of predicted and measured change of the shape in one tick
                           (m2) */
} squares;

/*
 * Return a number that changes if voltages are fixed (pzs_hold) or released, or if a test signal
 * begins or ends: the predicted shape may then have jumped without a motion of the structure. The
 * number is twice that of the fixed voltages, plus 1 during a test signal.
 */
static uint32_t count_fixed(const pzs_loop_signals *signals)
{
    const pzs_control_info *info = &signals->control->info;
    uint32_t fixed = 0, is_tested = 0;
    for (uint32_t i = 0; i < signals->control->state.problem->inputs; i++) {
        fixed += info->lower[i] < info->upper[i] ? 0u : 1u;
        if (signals->electrode != NULL && signals->electrode[i] == PZS_ELECTRODE_TESTED)
            is_tested = 1;
    }
    return 2u * fixed + is_tested;
}

/*
 * Store the predicted shape of a tick and its disturbance (measured minus predicted shape), with
 * which those of the next tick are compared. The divergence monitor thus starts anew in its first
 * tick, and when a voltage is fixed or released, which makes the predicted shape jump.
 */
static void store_shapes(pzs_monitor_state *monitor, const pzs_loop_signals *signals)
{
    const pzs_control_info *info = &signals->control->info;
    for (uint32_t i = 0; i < signals->control->state.problem->outputs; i++) {
        monitor->slow[i] = info->disturbance[i];
        monitor->disturbance[i] = info->disturbance[i];
        monitor->predicted[i] = info->predicted[i];
        monitor->move[i] = 0;
    }
}

/*
 * Start the divergence monitor with the measured, predicted and target shapes of this tick.
 *   has_modes in  true: a vibration damper computes the amplitude by which the measured shape
 *                 deviates from the model, so only the target is stored
 */
static void start(pzs_monitor_state *monitor, const pzs_loop_signals *signals, bool has_modes)
{
    const uint32_t outputs = signals->control->state.problem->outputs;
    const pzs_real part = 1 / (pzs_real)outputs, *wanted = signals->wanted;
    const pzs_real *predicted = signals->control->info.predicted,
                   *disturbance = signals->control->info.disturbance;
    pzs_real square = 0;
    for (uint32_t i = 0; i < outputs; i++) {
        const pzs_real missed = wanted[i] - predicted[i] - disturbance[i];
        square += missed * missed * part;
        monitor->wanted[i] = wanted[i];
    }
    if (!has_modes)
        store_shapes(monitor, signals);
    monitor->amplitude = 0;
    monitor->envelope = PZS_SQRT(square);
    monitor->moved = 0;
    monitor->answered = 0;
    monitor->fixed = count_fixed(signals);
    monitor->is_started = true;
}

/*
 * Compare the measured, predicted and target shapes of this tick with those of the last one, and
 * store those of this tick.
 */
static squares compare(pzs_monitor_state *monitor, const pzs_loop_signals *signals)
{
    const uint32_t outputs = signals->control->state.problem->outputs;
    const pzs_control_info *info = &signals->control->info;
    const pzs_real part = 1 / (pzs_real)outputs;
    squares sum = {0, 0, 0, 0};
    for (uint32_t i = 0; i < outputs; i++) {
        const pzs_real fast = info->disturbance[i] - monitor->slow[i];
        const pzs_real target = signals->wanted[i] - monitor->wanted[i];
        const pzs_real change = info->disturbance[i] - monitor->disturbance[i];
        const pzs_real move = monitor->move[i];
        sum.deviation += part * fast * fast;
        sum.target += part * target * target;
        sum.moved += part * move * move;
        // The measured change is that of the disturbance plus the predicted one of a tick earlier,
        // because a measured shape is the response to the voltages of one tick earlier.
        sum.answered += part * move * (move + change);
        monitor->slow[i] += SLOW * fast;
        monitor->disturbance[i] = info->disturbance[i];
        monitor->wanted[i] = signals->wanted[i];
        monitor->move[i] = info->predicted[i] - monitor->predicted[i];
        monitor->predicted[i] = info->predicted[i];
    }
    return sum;
}

/*
 * Return the root mean square of the change of the target shape in this tick (m), and store the
 * target shape.
 */
static pzs_real change_of_target(pzs_monitor_state *monitor, const pzs_loop_signals *signals)
{
    const uint32_t outputs = signals->control->state.problem->outputs;
    const pzs_real part = 1 / (pzs_real)outputs, *wanted = signals->wanted;
    pzs_real *before = monitor->wanted, sum = 0;
    for (uint32_t i = 0; i < outputs; i++) {
        const pzs_real target = wanted[i] - before[i];
        sum += part * target * target;
        before[i] = wanted[i];
    }
    return PZS_SQRT(sum);
}

/*
 * Update two variables of the divergence monitor in a loop with a vibration damper (m, RMS over the
 * outputs): `amplitude`, the recent peak of the amplitude of vibration, and `envelope`, the
 * amplitude that motions of the target can have caused, which decays as the vibration does.
 */
static void follow_modes(pzs_monitor_state *monitor, const pzs_supervision *tables,
                         const pzs_loop_signals *signals)
{
    const pzs_real now = signals->deviation, faded = PEAK_FADING * monitor->amplitude;
    monitor->amplitude = now > faded ? now : faded;
    monitor->envelope = tables->fading * monitor->envelope + change_of_target(monitor, signals);
}

pzs_real pzs_monitor_threshold(const pzs_monitor_state *monitor, const pzs_supervision *tables)
{
    return MARGIN * monitor->envelope + NOISE_MARGIN * tables->noise + tables->load;
}

/*
 * Whether the predicted changes of the shape in the last ticks are large enough to be compared with
 * the measured ones, and the measured shape has not followed them.
 */
static bool is_unanswered(const pzs_monitor_state *monitor, const pzs_supervision *tables)
{
    const pzs_real least = LEAST_MOVE * tables->load + NOISE_MARGIN * tables->noise;
    return monitor->moved > least * least && monitor->answered < LEAST_ANSWER * monitor->moved;
}

/*
 * Add the shape changes of this tick to the sums from which the response of the structure is
 * judged. Nothing is added while the fault detector tests electrodes or has just fixed the voltage
 * of one.
 */
static void sum_moves(pzs_monitor_state *monitor, const squares *sum,
                      const pzs_loop_signals *signals)
{
    const uint32_t fixed = count_fixed(signals);
    const bool is_judged = fixed == monitor->fixed && fixed % 2u == 0;
    monitor->fixed = fixed;
    monitor->moved = is_judged ? monitor->moved + sum->moved - SLOW * monitor->moved : 0;
    monitor->answered =
        is_judged ? monitor->answered + sum->answered - SLOW * monitor->answered : 0;
    for (uint32_t i = 0; !is_judged && i < signals->control->state.problem->outputs; i++)
        monitor->move[i] = 0;
}

bool pzs_monitor_tick(pzs_monitor_state *monitor, const pzs_supervision *tables,
                      const pzs_loop_signals *signals)
{
    guard_repair_bool(&monitor->is_started);
    const bool has_modes = !(signals->deviation < 0);
    const bool is_damaged = !number_is_finite(monitor->amplitude + monitor->envelope +
                                              monitor->moved + monitor->answered);
    const bool has_other_inputs = count_fixed(signals) / 2u != monitor->fixed / 2u;
    if (!monitor->is_started || is_damaged || has_other_inputs) {
        start(monitor, signals, has_modes);
        return false;
    }
    if (has_modes) {
        follow_modes(monitor, tables, signals);
        return monitor->amplitude > pzs_monitor_threshold(monitor, tables);
    }
    const squares sum = compare(monitor, signals);
    const pzs_real now = PZS_SQRT(sum.deviation), faded = PEAK_FADING * monitor->amplitude;
    monitor->amplitude = now > faded ? now : faded;
    monitor->envelope = tables->fading * monitor->envelope + PZS_SQRT(sum.target);
    sum_moves(monitor, &sum, signals);
    return monitor->amplitude > pzs_monitor_threshold(monitor, tables) ||
           is_unanswered(monitor, tables);
}
