/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stuck monitor of the supervisor. Where a converter, its memory access or its bus stops, every
 * reading of a tick has the bits of the tick before. Readings of a structure that stands still may
 * repeat, too, because converters round. They are stuck if since their last change
 *
 *     |predicted shape - predicted shape at that change|  >  min(load, 64 noise)
 *
 * (RMS over the outputs) for longer than the readings are old plus an eighth of the period of the
 * first vibration mode, and at least 8 ticks. The predicted shape is that under the voltages alone.
 * By then the structure has moved by many steps of its converters, also where hysteresis takes nine
 * tenths of the motion. A load may keep it where it is, but not to the bit.
 *
 * Not found are sensors that stick while neither target nor controller moves the voltages, and an
 * offset of all sensors, which is like a load. Readings that stay where they are but for noise are
 * found only after a jump of the target (polarity.h).
 *
 * A tick compares a quarter of the outputs, in turn, and only if all readings repeat. The work of
 * such a tick is 2 operations for each output.
 */
#include "stuck.h"

/*
 * Factor of the noise of the measured shape in the largest motion of the predicted shape under
 * which all readings may repeat.
 */
#define NOISE_MARGIN 64
/* Smallest number of ticks for which readings must repeat after such a motion. */
#define LEAST_TICKS 8u
/* Part of a period of the first vibration mode for which they must, as a reciprocal. */
#define PERIOD_PART 8u
/* A tick compares one in STRIDE outputs, if there are LEAST_OUTPUTS or more. */
#define STRIDE 4u
#define LEAST_OUTPUTS 32u

/* Remember the predicted shape at every `stride`-th output, beginning with the first one. */
static void store(pzs_real *reference, const pzs_real *predicted, uint32_t first, uint32_t outputs,
                  uint32_t stride)
{
    for (uint32_t i = first; i < outputs; i += stride)
        reference[i] = predicted[i];
}

/* Mean square of the motion since then (m2), at the same outputs. */
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
 * Largest motion of the predicted shape under which all readings may repeat (m, RMS over the
 * outputs).
 */
static pzs_real tolerance(const pzs_supervision *tables)
{
    const pzs_real noise = NOISE_MARGIN * tables->noise;
    return noise < tables->load ? noise : tables->load;
}

/* Number of ticks for which readings must repeat after a motion until they count as stuck. */
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
