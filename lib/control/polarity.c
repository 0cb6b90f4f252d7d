/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Polarity monitor of the supervisor: detects a structure that moves against the prediction of its
 * model, for example because amplifiers have the wrong polarity. With the last jump u of the target
 * [outputs] and the changes of the shape since this jump, a structure moves against the prediction
 * if
 *
 *     u . (change of the predicted shape)  >   |u| least
 *     u . (change of the measured shape)   <  -|u| least
 *     least = 2 load + 6 noise + shaken    (for the RMS over the outputs)
 *
 *   load    change of the shape by the largest expected sudden load
 *   noise   noise of the measured shape
 *   slack   motion of the predicted shape that hysteresis of the actuators may take
 *   shaken  vibration that earlier jumps explain, of which a part remains in the measured shape if
 *           the structure vibrates only roughly like its model
 *
 * It does not follow the prediction, as if all sensors were stuck, if
 *
 *     u . (change of the predicted shape)  >   |u| max(2 least, slack)
 *     u . (change of the measured shape)   <   u . (change of the predicted shape) / 10
 *
 * If the structure responds with at least half of the predicted motion, only sudden loads of more
 * than 3 `load` together can turn the motion, and of more than 1.6 `load` suppress it, until the
 * loop has rejected them.
 *
 * Each tick computes one of the two scalar products, in turn. The work of a tick is 2 operations
 * for each output for some periods of the first vibration mode after a jump, and 0 later.
 */
#include <string.h>
#include "polarity.h"
#include "../core/product.h"

/*
 * Smallest motion of the shape that the polarity monitor judges: LOADS times the effect of the
 * largest expected sudden load plus NOISE_MARGIN times the noise of the measured shape.
 */
#define LOADS 2
#define NOISE_MARGIN 6
/*
 * The structure does not follow its prediction if it makes less than LEAST_ANSWER of the predicted
 * motion. This is judged only where the predicted motion exceeds the smallest judged motion by the
 * factor LONG_WAY, and exceeds what hysteresis may take.
 */
#define LONG_WAY 2
#define LEAST_ANSWER PZS_R(0.1)
/*
 * The polarity monitor judges the motion for this number of periods of the first vibration mode
 * after a jump of the target (a period has alarm_ticks ticks). Later, slow loads such as heat may
 * have moved the structure further than the smallest motion that is judged.
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
    const pzs_real unit = PZS_SQRT(square * (pzs_real)outputs);
    polarity->least = (pzs_polarity_least(tables) + shaken) * unit;
    polarity->most_idle = LONG_WAY * polarity->least;
    if (polarity->most_idle < tables->slack * unit)
        polarity->most_idle = tables->slack * unit;
    memset(polarity->before, 0, sizeof polarity->before);
    memset(polarity->now, 0, sizeof polarity->now);
    polarity->first = PERIODS * tables->alarm_ticks + 2u;
    polarity->remaining = polarity->first;
}

void pzs_polarity_pass(pzs_polarity_state *polarity)
{
    const bool has_begun = polarity->first - polarity->remaining >= 2u;
    polarity->remaining -= has_begun && polarity->remaining > 0 ? 1u : 0u;
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
    const pzs_real predicted_way = now[0] - before[0], measured_way = now[1] - before[1];
    const bool moves_back = predicted_way > polarity->least && measured_way < -polarity->least;
    return moves_back ||
           (predicted_way > polarity->most_idle && measured_way < LEAST_ANSWER * predicted_way);
}
