/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Polarity monitor of the supervisor. Without other loads a structure moves in proportion to the
 * motion that its model predicts, with a positive factor. It moves against the prediction if, since
 * the last jump u of the target,
 *
 *     u . (predicted shape - predicted shape at the jump)  >   |u| least
 *     u . (measured shape - measured shape at the jump)    <  -|u| least
 *
 *     least = 2 load + 6 noise + shaken, for the RMS over the outputs
 *
 * `shaken` is the vibration that earlier jumps explain: where a structure vibrates like its model
 * only roughly, a part of its vibration remains in the measured shape. On a structure that responds
 * with at least half of the predicted motion, only loads of more than 3 `load` together can turn
 * the motion, and only until the loop has rejected them.
 *
 * Each tick computes one of the two products, in turn. The work of a tick is 2 operations for each
 * output for some periods of the first vibration mode after a jump, and 0 later.
 */
#include <string.h>
#include "polarity.h"
#include "../core/product.h"

/*
 * Factors of the effect of the largest expected sudden load, and of the noise of the measured
 * shape, in the smallest motion of the shape that the polarity monitor judges after a rest.
 */
#define LOADS 2
#define NOISE_MARGIN 6
/*
 * Number of ticks for which the polarity monitor judges the motion after a jump of the target,
 * divided by the number of implausible ticks that raise an alarm (a period of the first vibration
 * mode). Slow loads, as by heat, may move the structure further than `least` later.
 */
#define PERIODS 4

pzs_real pzs_polarity_least(const pzs_supervision *tables)
{
    return LOADS * tables->load + NOISE_MARGIN * tables->noise;
}

void pzs_polarity_begin(pzs_polarity_state *polarity, const pzs_supervision *tables,
                        const pzs_real *wanted, const pzs_real *before, uint32_t outputs,
                        pzs_real shaken)
{
    pzs_real square = 0;
    for (uint32_t i = 0; i < outputs; i++) {
        const pzs_real change = wanted[i] - before[i];
        polarity->direction[i] = change;
        square += change * change;
    }
    polarity->least = (pzs_polarity_least(tables) + shaken) * PZS_SQRT(square * (pzs_real)outputs);
    memset(polarity->before, 0, sizeof polarity->before);
    memset(polarity->now, 0, sizeof polarity->now);
    polarity->first = PERIODS * tables->alarm_ticks + 2u;
    polarity->remaining = polarity->first;
}

bool pzs_polarity_is_opposed(pzs_polarity_state *polarity, const pzs_real *predicted,
                             const pzs_real *measured, uint32_t outputs)
{
    const uint32_t age = polarity->first - polarity->remaining, which = age % 2u;
    const pzs_real *now = polarity->now, *before = polarity->before;
    if (polarity->remaining == 0)
        return false;
    polarity->remaining--;
    polarity->now[which] =
        pzs_product_dot(polarity->direction, which == 0 ? predicted : measured, outputs);
    if (age < 2)
        polarity->before[which] = now[which];
    return now[0] - before[0] > polarity->least && now[1] - before[1] < -polarity->least;
}
