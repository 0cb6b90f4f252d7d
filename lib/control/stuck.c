/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stuck monitor of the supervisor: detects that sensors repeat their readings bit by bit, as where
 * a converter, its memory access or its bus stops. Readings of a structure that stands still may
 * repeat, too, because converters round. Readings count as stuck if all of them repeat while the
 * structure should have moved, that is, if
 *
 *     |predicted shape - predicted shape when the last reading changed|  >  min(load, 64 noise)
 *
 * (RMS over the outputs; load and noise: members of pzs_supervision) holds for more ticks than the
 * delay of the readings plus an eighth of the period of the first vibration mode, and at least 8.
 * The predicted shape is that under the voltages alone. A structure that has moved so far has
 * passed many converter steps, even if hysteresis takes nine tenths of the motion. A load may
 * balance the voltages, but not so exactly that every bit stays the same.
 *
 * Not found are sensors that are stuck while the voltages do not change, and a constant offset of
 * all sensors, which is like a load. Sensors that are stuck except for noise are found only after a
 * jump of the target (polarity.h).
 *
 * A tick compares every fourth output, others in the next tick, and only if all readings repeat.
 * The work of such a tick is 2 operations for each output.
 */
#include "stuck.h"

/*
 * Largest motion of the predicted shape during which all readings may repeat, divided by the noise
 * of the measured shape.
 */
#define NOISE_MARGIN 64
/*
 * Readings count as stuck if they repeat for more ticks after a motion of the predicted shape than
 * the sum of the delay of the readings and this number. For slow structures PERIOD_PART gives a
 * larger number.
 */
#define LEAST_TICKS 8u
/*
 * For slow structures, a period of the first vibration mode divided by PERIOD_PART replaces
 * LEAST_TICKS, if it is longer.
 */
#define PERIOD_PART 8u
/*
 * With LEAST_OUTPUTS outputs or more, a tick compares only every STRIDE-th output of the shape; the
 * next ticks compare the others in turn.
 */
#define STRIDE 4u
#define LEAST_OUTPUTS 32u

/*
 * Store the predicted shape (m) at every `stride`-th output from `first` on, with which later
 * shapes are compared.
 */
static void store(pzs_real *reference, const pzs_real *predicted, uint32_t first, uint32_t outputs,
                  uint32_t stride)
{
    for (uint32_t i = first; i < outputs; i += stride)
        reference[i] = predicted[i];
}

/*
 * Return the mean square of the change of the predicted shape since the function `store` has stored
 * it (m2), at every `stride`-th output from `first` on.
 */
static pzs_real motion(const pzs_real *reference, const pzs_real *predicted, uint32_t first,
                       uint32_t outputs, uint32_t stride)
{
    pzs_real sum = 0;
    for (uint32_t i = first; i < outputs; i += stride) {
        const pzs_real moved = predicted[i] - reference[i];
        sum += moved * moved;
    }
    return sum / (pzs_real)((outputs - first + stride - 1u) / stride);
}

/*
 * Return the largest motion of the predicted shape during which all readings may repeat without
 * counting as stuck (m, RMS over the outputs).
 */
static pzs_real tolerance(const pzs_supervision *tables)
{
    const pzs_real noise = NOISE_MARGIN * tables->noise;
    return noise < tables->load ? noise : tables->load;
}

/*
 * Return the number of ticks after a motion of the predicted shape in which all readings may repeat
 * before they count as stuck.
 */
static uint32_t patience(const pzs_supervision *tables, const pzs_loop_signals *signals)
{
    const uint32_t part = tables->alarm_ticks / PERIOD_PART;
    return signals->delay + (part > LEAST_TICKS ? part : LEAST_TICKS);
}

bool pzs_stuck_judge(pzs_stuck_state *stuck, const pzs_supervision *tables,
                     const pzs_loop_signals *signals, bool has_jumped)
{
    const uint32_t outputs = signals->control->state.problem->outputs;
    const uint32_t stride = outputs < LEAST_OUTPUTS ? 1u : STRIDE, first = stuck->repeats % stride;
    const pzs_real *predicted = signals->control->info.predicted;
    const pzs_real most = tolerance(tables);
    if (!signals->is_repeated) {
        stuck->repeats = 0;
        stuck->moved = 0;
        return false;
    }
    if (has_jumped)
        return stuck->moved > patience(tables, signals);
    if (stuck->repeats < stride)
        store(stuck->reference, predicted, first, outputs, stride);
    else if (motion(stuck->reference, predicted, first, outputs, stride) > most * most)
        stuck->moved++;
    stuck->repeats += stuck->repeats < 2u * stride - 1u ? 1u : 1u - stride;
    return stuck->moved > patience(tables, signals);
}
