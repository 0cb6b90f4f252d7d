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
 *     amplitude: with a vibration damper, size of the estimated vibration and of readings that the
 *     estimate does not explain; without one, RMS of measured minus predicted shape, without the
 *     slow part of this difference.
 *     envelope: rises by the RMS of each change of the target, then decays.
 *   - In a loop without a vibration damper, the shape does not respond: its measured changes have
 *     less than a tenth of the predicted size in the predicted direction.
 *
 * In a loop with a vibration damper, an implausible amplitude is an alarm only if it lasts for two
 * periods of the first mode and does not fall from one half period to the next, because several
 * shocks by loads may follow each other. A wrong polarity and sensors that are all stuck have
 * monitors of their own (polarity.h, polarity_gain.h, polarity_test.h, stuck.h).
 */
#include <string.h>
#include "monitor.h"
#include "polarity.h"
#include "polarity_gain.h"
#include "polarity_test.h"
#include "stuck.h"
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
 * Factor of the RMS noise of the measured shape in the threshold of the divergence monitor (formula
 * at MARGIN). A tick is implausible if the measured shape deviates from the predicted one by more.
 */
#define NOISE_MARGIN 6
/*
 * Factor by which the divergence monitor multiplies its largest recent deviation (measured minus
 * predicted shape) in each tick, so that the effect of a single large deviation ends.
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

/*
 * A vibration counts as not falling if its largest amplitude in a half period is at least this part
 * of that in the half period before. Without damping the ratio is 1. With the weakest damping that
 * the envelope assumes, which divides the amplitude by e in two periods, it is exp(-1/4) = 0.78.
 */
#define STEADY PZS_R(0.9)
/*
 * An implausible vibration is an alarm if it lasts for more than this number of half periods
 * without falling from one half period to the next. The vibration after a single shock falls within
 * one or two half periods.
 */
#define LOST_HALVES 4u

/*
 * Return half a period of the first vibration mode (ticks), in a loop with a vibration damper,
 * where alarm_ticks of the tables is the whole period.
 */
static uint32_t half_period(const pzs_supervision *tables)
{
    return tables->alarm_ticks > 1 ? tables->alarm_ticks / 2u : 1u;
}

void pzs_monitor_place(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs)
{
    monitor->slow = memory;
    monitor->disturbance = memory + outputs;
    monitor->predicted = memory + 2u * (size_t)outputs;
    monitor->move = memory + 3u * (size_t)outputs;
    monitor->wanted = memory + 4u * (size_t)outputs;
    monitor->polarity.direction = monitor->move;
    monitor->stuck.reference = monitor->predicted;
    guard_repair_bool(&monitor->is_started);
    guard_repair_bool(&monitor->is_first);
    guard_repair_bool(&monitor->is_opposed);
    guard_repair_bool(&monitor->is_stuck);
}

void pzs_monitor_init(pzs_monitor_state *monitor, pzs_real *memory, uint32_t outputs)
{
    memset(monitor, 0, sizeof *monitor);
    memset(memory, 0, 5u * (size_t)outputs * sizeof *memory);
    pzs_polarity_test_forget(&monitor->test);
    pzs_monitor_place(monitor, memory, outputs);
}

/*
 * Numbers of the three work arrays for shapes whose components along the free functions (shapes
 * that may be added to the target at no cost) are removed: disturbance, predicted shape and target
 * (pzs_loop_signals.without_free).
 */
#define DISTURBANCE_PLACE 0u
#define PREDICTED_PLACE 1u
#define WANTED_PLACE 2u

/*
 * Return a shape as the divergence monitor compares it: without its components along the free
 * functions of the target, shapes along which the structure may move without a prediction of the
 * model.
 *   shape [outputs] in
 */
static const pzs_real *compared(const pzs_loop_signals *signals, const pzs_real *shape,
                                uint32_t place)
{
    return signals->without_free != NULL ? signals->without_free(signals, shape, place) : shape;
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
 * result is 2 times the number of fixed voltages, plus 1 during a test signal.
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
 * Start the comparison of shapes anew: store the predicted shape of this tick and its disturbance
 * (measured minus predicted shape) as the last ones. This is done in the first tick, and when a
 * voltage is fixed or released, which makes the predicted shape jump.
 */
static void store_shapes(pzs_monitor_state *monitor, const pzs_real *disturbance,
                         const pzs_real *predicted, uint32_t outputs)
{
    for (uint32_t i = 0; i < outputs; i++) {
        monitor->slow[i] = disturbance[i];
        monitor->disturbance[i] = disturbance[i];
        monitor->predicted[i] = predicted[i];
        monitor->move[i] = 0;
    }
}

/*
 * Start the divergence monitor with the measured, predicted and target shapes of this tick.
 *   has_modes in  true: a vibration damper of the loop computes how far the measured shape deviates
 *                 from the model, and the monitor stores only the target
 */
static void start(pzs_monitor_state *monitor, const pzs_loop_signals *signals, bool has_modes)
{
    const uint32_t outputs = signals->control->state.problem->outputs;
    const pzs_control_info *info = &signals->control->info;
    const pzs_real *wanted = compared(signals, signals->wanted, WANTED_PLACE),
                   *predicted = compared(signals, info->predicted, PREDICTED_PLACE),
                   *disturbance = compared(signals, info->disturbance, DISTURBANCE_PLACE);
    const pzs_real part = 1 / (pzs_real)outputs;
    pzs_real square = 0;
    for (uint32_t i = 0; i < outputs; i++) {
        const pzs_real missed = wanted[i] - predicted[i] - disturbance[i];
        square += missed * missed * part;
        monitor->wanted[i] = wanted[i];
    }
    if (signals->vibration != NULL)
        pzs_polarity_gain_begin(&monitor->gain, signals);
    if (!has_modes)
        store_shapes(monitor, disturbance, predicted, outputs);
    monitor->amplitude = 0;
    monitor->envelope = PZS_SQRT(square);
    monitor->moved = 0;
    monitor->answered = 0;
    monitor->earlier = 0;
    monitor->later = 0;
    monitor->vibrating = 0;
    monitor->polarity.remaining = 0;
    if (!number_is_finite(monitor->test.tolerated))
        monitor->test.tolerated = 0;
    monitor->stuck.repeats = 0;
    monitor->stuck.moved = 0;
    monitor->is_opposed = false;
    monitor->is_stuck = false;
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
    const pzs_real *wanted = compared(signals, signals->wanted, WANTED_PLACE),
                   *predicted = compared(signals, info->predicted, PREDICTED_PLACE),
                   *disturbance = compared(signals, info->disturbance, DISTURBANCE_PLACE);
    const pzs_real part = 1 / (pzs_real)outputs;
    squares sum = {0, 0, 0, 0};
    for (uint32_t i = 0; i < outputs; i++) {
        const pzs_real fast = disturbance[i] - monitor->slow[i];
        const pzs_real target = wanted[i] - monitor->wanted[i];
        const pzs_real change = disturbance[i] - monitor->disturbance[i];
        const pzs_real move = monitor->move[i];
        sum.deviation += part * fast * fast;
        sum.target += part * target * target;
        sum.moved += part * move * move;
        // The measured change is the change of the disturbance plus the change that the model
        // predicted one tick earlier, because a measured shape is the response to the voltages of
        // one tick earlier.
        sum.answered += part * move * (move + change);
        monitor->slow[i] += SLOW * fast;
        monitor->disturbance[i] = disturbance[i];
        monitor->wanted[i] = wanted[i];
        monitor->move[i] = predicted[i] - monitor->predicted[i];
        monitor->predicted[i] = predicted[i];
    }
    return sum;
}

/*
 * Return the root mean square of the change of the target shape in this tick (m).
 *   wanted [outputs] in  present target shape (m)
 */
static pzs_real change_of_target(const pzs_monitor_state *monitor, const pzs_real *wanted,
                                 uint32_t outputs)
{
    const pzs_real part = 1 / (pzs_real)outputs, *before = monitor->wanted;
    pzs_real sum = 0;
    for (uint32_t i = 0; i < outputs; i++) {
        const pzs_real target = wanted[i] - before[i];
        sum += part * target * target;
    }
    return PZS_SQRT(sum);
}

/*
 * Store the target shape of this tick, which has changed. After a jump the polarity monitor judges
 * the motion of the structure along it. Returns whether the target has jumped.
 *   wanted [outputs] in  present target shape (m)
 *   change           in  root mean square of the change (m)
 */
static bool store_target(pzs_monitor_state *monitor, const pzs_supervision *tables,
                         const pzs_real *wanted, uint32_t outputs, pzs_real change)
{
    const bool has_jumped = change > pzs_polarity_least(tables);
    if (has_jumped)
        pzs_polarity_begin(&monitor->polarity, tables, wanted, monitor->wanted, outputs,
                           monitor->envelope);
    memcpy(monitor->wanted, wanted, outputs * sizeof *monitor->wanted);
    return has_jumped;
}

/*
 * Update two variables of the divergence monitor in a loop with a vibration damper (m, RMS over the
 * outputs): `amplitude`, the recent peak of the amplitude of vibration, and `envelope`, the
 * amplitude that motions of the target can have caused, which decays as the vibration does. Returns
 * whether the target has jumped.
 */
static bool follow_modes(pzs_monitor_state *monitor, const pzs_supervision *tables,
                         const pzs_loop_signals *signals)
{
    const uint32_t outputs = signals->control->state.problem->outputs;
    const pzs_real now = signals->deviation, faded = PEAK_FADING * monitor->amplitude;
    const pzs_real *wanted = compared(signals, signals->wanted, WANTED_PLACE);
    monitor->amplitude = now > faded ? now : faded;
    const pzs_real change = change_of_target(monitor, wanted, outputs);
    const bool has_jumped = change > 0 && store_target(monitor, tables, wanted, outputs, change);
    monitor->envelope = tables->fading * monitor->envelope + change;
    return has_jumped;
}

pzs_real pzs_monitor_threshold(const pzs_monitor_state *monitor, const pzs_supervision *tables)
{
    return MARGIN * monitor->envelope + NOISE_MARGIN * tables->noise + tables->load +
           monitor->test.tolerated;
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

/* Whether the state of the divergence monitor shows that memory was damaged. */
static bool is_damaged(const pzs_monitor_state *monitor)
{
    const pzs_polarity_state *polarity = &monitor->polarity;
    return !number_is_finite(monitor->amplitude + monitor->envelope + monitor->moved +
                             monitor->answered + monitor->earlier + monitor->later +
                             monitor->test.tolerated + polarity->least + polarity->most_idle +
                             polarity->before[0] + polarity->before[1]);
}

/*
 * Judge one tick of a loop without a vibration damper: return whether the measured shape is
 * implausible, because it deviates too far from the predicted one or does not follow the voltages.
 */
static bool judge_shape(pzs_monitor_state *monitor, const pzs_supervision *tables,
                        const pzs_loop_signals *signals)
{
    const squares sum = compare(monitor, signals);
    const pzs_real now = PZS_SQRT(sum.deviation), faded = PEAK_FADING * monitor->amplitude;
    monitor->amplitude = now > faded ? now : faded;
    monitor->envelope = tables->fading * monitor->envelope + PZS_SQRT(sum.target);
    sum_moves(monitor, &sum, signals);
    if (pzs_polarity_test_has_turn(&monitor->test))
        pzs_polarity_test_compare(&monitor->test, tables, monitor->predicted, signals->measured,
                                  signals->control->state.problem->outputs);
    return monitor->amplitude > pzs_monitor_threshold(monitor, tables) ||
           is_unanswered(monitor, tables);
}

/*
 * Return the counter of implausible ticks after a plausible tick: lower by 2, but at least 0.
 */
static uint32_t lowered(uint32_t over)
{
    return over > 2u ? over - 2u : 0;
}

/*
 * Count a tick whose amplitude of vibration is implausible. At the end of each half period the
 * largest amplitude is compared with that of the half period before.
 */
static void count_vibration(pzs_monitor_state *monitor, const pzs_supervision *tables)
{
    const uint32_t half = half_period(tables);
    monitor->vibrating++;
    if (monitor->amplitude > monitor->later)
        monitor->later = monitor->amplitude;
    if (monitor->vibrating % half != 0)
        return;
    if (monitor->later < STEADY * monitor->earlier)
        monitor->vibrating = half;
    monitor->earlier = monitor->later;
    monitor->later = 0;
}

/*
 * Whether the vibration of a structure is implausible for so long that it is an alarm: changes of
 * the target and loads do not explain its amplitude, and it does not fall.
 */
static bool keeps_vibrating(pzs_monitor_state *monitor, const pzs_supervision *tables)
{
    if (monitor->amplitude > pzs_monitor_threshold(monitor, tables))
        count_vibration(monitor, tables);
    else
        monitor->vibrating = lowered(monitor->vibrating);
    if (monitor->vibrating == 0) {
        monitor->earlier = 0;
        monitor->later = 0;
    }
    return monitor->vibrating > LOST_HALVES * half_period(tables);
}

/*
 * Whether a structure moves against its prediction, as the polarity monitor sees it. At the second
 * tick of a loop the motion from the predicted shape to the target is judged like that after a jump
 * of the target, because the first target has no earlier one.
 *   has_jumped in  whether the target has jumped in this tick
 */
static bool moves_against(pzs_monitor_state *monitor, const pzs_supervision *tables,
                          const pzs_loop_signals *signals, bool has_jumped)
{
    const uint32_t outputs = signals->control->state.problem->outputs;
    const pzs_real *predicted = signals->control->info.predicted;
    const bool is_first = monitor->is_first;
    monitor->is_first = false;
    if (has_jumped || (signals->is_repeated && !is_first))
        return false;
    if (!is_first)
        return pzs_polarity_is_opposed(&monitor->polarity, predicted, signals->measured, outputs);
    pzs_polarity_begin(&monitor->polarity, tables, compared(signals, signals->wanted, WANTED_PLACE),
                       compared(signals, predicted, PREDICTED_PLACE), outputs, 0);
    return false;
}

/*
 * Return what the polarity test compares. In a loop with a vibration damper these are readings,
 * because its low-pass filter slows the measured shape down. The test uses the memory of all five
 * arrays of the monitor, which starts anew after it.
 */
static polarity_test_shapes tested_shapes(const pzs_monitor_state *monitor,
                                          const pzs_loop_signals *signals)
{
    const uint32_t outputs = signals->control->state.problem->outputs, most = 5u * outputs;
    if (signals->sensed == NULL)
        return (polarity_test_shapes){monitor->slow, signals->control->info.predicted,
                                      signals->measured, outputs, 0};
    return (polarity_test_shapes){monitor->slow, signals->expected, signals->sensed,
                                  signals->sensors < most ? signals->sensors : most,
                                  signals->delay};
}

bool pzs_monitor_asks_for_test(const pzs_monitor_state *monitor, const pzs_supervision *tables,
                               uint32_t over)
{
    return pzs_polarity_test_is_due(&monitor->test, tables, over > 0 || monitor->vibrating > 0);
}

void pzs_monitor_begin_test(pzs_monitor_state *monitor, const pzs_loop_signals *signals)
{
    const polarity_test_shapes shapes = tested_shapes(monitor, signals);
    monitor->is_started = false;
    pzs_polarity_test_begin(&monitor->test, shapes.direction, shapes.predicted, shapes.count);
}

bool pzs_monitor_average(pzs_monitor_state *monitor, const pzs_supervision *tables,
                         const pzs_loop_signals *signals, uint32_t tick)
{
    const polarity_test_shapes shapes = tested_shapes(monitor, signals);
    pzs_polarity_test_average(&monitor->test, &shapes, tick);
    return tick + 1u >= pzs_polarity_test_pause(tables, shapes.delay);
}

/*
 * Whether a structure moves against its prediction, as the polarity monitor sees it; in some ticks,
 * whose time the polarity test takes, the result of the tick before.
 *   has_jumped in  whether the target has jumped in this tick
 */
static bool compare_motion(pzs_monitor_state *monitor, const pzs_supervision *tables,
                           const pzs_loop_signals *signals, bool has_jumped)
{
    const bool is_free = !has_jumped && !monitor->is_first;
    if (!is_free || !pzs_polarity_test_has_turn(&monitor->test))
        return moves_against(monitor, tables, signals, has_jumped);
    pzs_polarity_test_compare(&monitor->test, tables,
                              compared(signals, signals->control->info.predicted, PREDICTED_PLACE),
                              signals->measured, signals->control->state.problem->outputs);
    pzs_polarity_pass(&monitor->polarity);
    return monitor->is_opposed;
}

/* Judge one tick of a loop with a vibration damper. Returns the number of implausible ticks. */
static uint32_t judge_modes(pzs_monitor_state *monitor, const pzs_supervision *tables,
                            const pzs_loop_signals *signals, uint32_t over)
{
    const bool has_jumped = follow_modes(monitor, tables, signals);
    monitor->is_opposed = compare_motion(monitor, tables, signals, has_jumped);
    monitor->is_stuck = pzs_stuck_judge(&monitor->stuck, tables, signals, has_jumped);
    const uint32_t next = monitor->is_opposed ? over + 1u : lowered(over);
    const bool is_vibrating = keeps_vibrating(monitor, tables);
    const bool is_reversed =
        signals->vibration != NULL &&
        pzs_polarity_gain_is_reversed(&monitor->gain, tables, signals, monitor->vibrating > 0);
    monitor->is_opposed = monitor->is_opposed || is_reversed;
    const bool is_lost = is_vibrating || is_reversed || next > tables->polarity_ticks;
    return is_lost ? tables->alarm_ticks + 1u : next;
}

uint32_t pzs_monitor_tick(pzs_monitor_state *monitor, const pzs_supervision *tables,
                          const pzs_loop_signals *signals, uint32_t over)
{
    const bool has_modes = !(signals->deviation < 0);
    const bool has_other_inputs = count_fixed(signals) / 2u != monitor->fixed / 2u;
    if (!monitor->is_started || is_damaged(monitor) || has_other_inputs) {
        monitor->is_first = !monitor->is_started;
        start(monitor, signals, has_modes);
        return lowered(over);
    }
    if (has_modes)
        return judge_modes(monitor, tables, signals, over);
    return judge_shape(monitor, tables, signals) ? over + 1u : lowered(over);
}
