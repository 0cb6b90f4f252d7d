/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Polarity test of the supervisor. With amplifiers of the wrong polarity the voltages run to their
 * limits, often without a vibration or a motion along a jump of the target that the other monitors
 * could find. The shape is then opposite to the prediction:
 *
 *     p . m  <  -t^2        (means of products over the outputs)
 *
 *   p  predicted shape under the voltages alone (m)
 *   m  measured shape (m)
 *   t  largest of: shape under the largest sudden load plus 6 times the noise; slack, the motion
 *      that hysteresis may take, half of the shape under half the voltage range (m, RMS)
 *
 * A healthy structure of gain g has m = g p + load, and p . m < -t^2 only under a load of more than
 * 2 sqrt(g) t, larger than all loads that the supervisor tolerates and as large as the effect of
 * the voltages. If this lasts for some periods of the first vibration mode, the supervisor tests
 * which of the two it is. It takes control away, keeps the voltages for a period, and moves them
 * along a straight line by 7/8 of their way to the park voltages, back, and so on, with a pause of
 * a period after each ramp. The mean measurements in two pauses tell by how much the structure has
 * moved in between, without vibration. A structure whose motion has the predicted sign, and at
 * least LEAST_ANSWER of the predicted size, after one of the ramps is healthy, and control goes on.
 * The polarity is wrong if the structure has answered three successive ramps by the same motion
 * against the prediction. A load that makes a healthy structure look reversed would have to follow
 * all ramps, each time against the voltages, and three of them by the same way. The next test of a
 * healthy structure comes after REST_PERIODS periods at the earliest, and this time doubles with
 * each test.
 *
 * The work of a tick is 2 operations for each output, in one of POLARITY_STRIDE ticks, and for each
 * measurement in the pauses of a test.
 */
#include <string.h>
#include "polarity_test.h"
#include "../core/numbers.h"
#include "../core/product.h"

/* One tick in POLARITY_STRIDE compares the measured with the predicted shape. */
#define POLARITY_STRIDE 8u
/*
 * The structure is tested if its shape has been opposite to the prediction for SUSPECT_PERIODS
 * periods of the first vibration mode. While another monitor counts, which gives its alarm without
 * a test, the structure is tested after LATEST_PERIODS. The counter does not exceed MOST_PERIODS.
 */
#define SUSPECT_PERIODS 2u
#define LATEST_PERIODS 8u
#define MOST_PERIODS 16u
/* Noise of the measured shape times this number is part of the smallest shape that is compared. */
#define NOISE_MARGIN 6
/*
 * Smallest part of the predicted motion with which a healthy structure answers a ramp. With 30 %
 * hysteresis and a gain of 0.8 it answers with 0.28 of the motion, because the ramp turns the
 * voltages back.
 */
#define LEAST_ANSWER PZS_R(0.1)
/*
 * Largest size of the answer of a reversed structure, whose gain is at most 1.33; a larger one is
 * the motion of a load.
 */
#define MOST_ANSWER PZS_R(1.6)
/*
 * Answers of a reversed structure repeat, also with hysteresis, from the second ramp on: two that
 * differ by less than this part of their size are the same. The polarity is
 * wrong if CONFIRMATIONS successive answers are the same as the one before. A test with MOST_RAMPS
 * ramps whose answers differ ends without result.
 */
#define SAME_ANSWER PZS_R(0.25)
#define CONFIRMATIONS 2u
#define MOST_RAMPS 12u
/*
 * A ramp tells something if it changes the product of the predicted shape with `direction` by at
 * least this part of the square of `direction`.
 */
#define LEAST_WAY PZS_R(0.25)
/*
 * Number of periods without a test after the first test of a healthy structure; each further test
 * doubles it, up to MOST_DOUBLED times.
 */
#define REST_PERIODS 64u
#define MOST_DOUBLED 4u
/*
 * The vibration of a healthy structure at the end of a test is tolerated VIBRATION_MARGIN times,
 * and falls by e in FADING_PERIODS periods, as with a damping ratio of 0.25 %: voltages at their
 * limits cannot damp it.
 */
#define VIBRATION_MARGIN 2
#define FADING_PERIODS 64

bool pzs_polarity_test_has_turn(pzs_polarity_test_state *test)
{
    test->turn++;
    return test->turn % POLARITY_STRIDE == 0;
}

/* Return the smallest RMS of the shape that is compared with the prediction (m). */
static pzs_real least_shape(const pzs_supervision *tables)
{
    const pzs_real load = tables->load + NOISE_MARGIN * tables->noise;
    return load > tables->slack ? load : tables->slack;
}

/* Return the number of ticks until the next test of a healthy structure. */
static uint32_t rest_of(const pzs_supervision *tables, uint32_t tests)
{
    return (REST_PERIODS * tables->polarity_ticks) << (tests < MOST_DOUBLED ? tests : MOST_DOUBLED);
}

/* Return a counter that has been raised or lowered, in one of POLARITY_STRIDE ticks. */
static uint32_t counted(uint32_t opposed, bool is_opposed, uint32_t most)
{
    const uint32_t fall = 2 * POLARITY_STRIDE;
    if (is_opposed)
        return opposed < most ? opposed + POLARITY_STRIDE : most;
    return opposed > fall ? opposed - fall : 0;
}

/*
 * Return the tolerated amplitude of vibration after POLARITY_STRIDE ticks: it falls by e in
 * FADING_PERIODS periods, and is 0 to `most`, even where memory was damaged.
 */
static pzs_real faded(pzs_real tolerated, pzs_real most, const pzs_supervision *tables)
{
    const pzs_real ticks = FADING_PERIODS * (pzs_real)tables->polarity_ticks + POLARITY_STRIDE;
    return number_clamp(tolerated, 0, most) * (1 - POLARITY_STRIDE / ticks);
}

void pzs_polarity_test_compare(pzs_polarity_test_state *test, const pzs_supervision *tables,
                               const pzs_real *predicted, const pzs_real *measured,
                               uint32_t outputs)
{
    const pzs_real least = least_shape(tables);
    const pzs_real product = pzs_product_dot(predicted, measured, outputs);
    const uint32_t longest = rest_of(tables, MOST_DOUBLED);
    test->opposed = counted(test->opposed, product < -(pzs_real)outputs * least * least,
                            MOST_PERIODS * tables->polarity_ticks);
    // A flipped bit must not put the next test off for ever.
    if (test->rest > longest)
        test->rest = longest;
    test->rest -= test->rest > POLARITY_STRIDE ? POLARITY_STRIDE : test->rest;
    test->tolerated = faded(test->tolerated, least, tables);
}

bool pzs_polarity_test_is_due(const pzs_polarity_test_state *test, const pzs_supervision *tables,
                              bool is_counting)
{
    const uint32_t periods = is_counting ? LATEST_PERIODS : SUSPECT_PERIODS;
    return test->rest == 0 && test->opposed > periods * tables->polarity_ticks;
}

void pzs_polarity_test_begin(pzs_polarity_test_state *test, pzs_real *direction,
                             const pzs_real *predicted, uint32_t count)
{
    memcpy(direction, predicted, count * sizeof *direction);
    test->before[0] = test->before[1] = 0;
    test->now[0] = test->now[1] = 0;
    test->answer = 0;
    test->confirmed = 0;
    test->square = pzs_product_dot(predicted, predicted, count);
}

uint32_t pzs_polarity_test_pause(const pzs_supervision *tables, uint32_t delay)
{
    return tables->polarity_ticks + delay + 1u;
}

void pzs_polarity_test_average(pzs_polarity_test_state *test, const polarity_test_shapes *shapes,
                               uint32_t tick)
{
    if (tick == shapes->delay) {
        test->now[0] = pzs_product_dot(shapes->direction, shapes->predicted, shapes->count);
        test->now[1] = 0;
    } else if (tick > shapes->delay) {
        test->now[1] += pzs_product_dot(shapes->direction, shapes->measured, shapes->count);
    }
}

/*
 * End the averages of a pause. Returns the answer to the ramp before it: the motion of the
 * structure over the predicted one; 0 if the prediction has hardly moved.
 */
static pzs_real take_answer(pzs_polarity_test_state *test, const pzs_supervision *tables)
{
    const pzs_real mean = test->now[1] / (pzs_real)tables->polarity_ticks;
    const pzs_real predicted = test->now[0] - test->before[0], measured = mean - test->before[1];
    const bool has_moved = PZS_ABS(predicted) > LEAST_WAY * test->square;
    test->before[0] = test->now[0];
    test->before[1] = mean;
    return has_moved ? measured / predicted : 0;
}

/* Whether the answer to a ramp is that of a reversed structure, and the same as the one before. */
static bool is_confirmed(const pzs_polarity_test_state *test, pzs_real answer)
{
    const pzs_real difference = PZS_ABS(answer - test->answer);
    return answer < -LEAST_ANSWER && answer > -MOST_ANSWER && difference < -SAME_ANSWER * answer;
}

polarity_verdict pzs_polarity_test_judge(pzs_polarity_test_state *test,
                                         const pzs_supervision *tables, uint32_t ramps)
{
    const pzs_real answer = take_answer(test, tables);
    const bool is_repeated = ramps > 2 && is_confirmed(test, answer);
    test->answer = answer;
    test->confirmed = is_repeated ? test->confirmed + 1u : 0;
    if (ramps == 0)
        return POLARITY_UNDECIDED;
    if (!(answer < LEAST_ANSWER) || ramps >= MOST_RAMPS)
        return POLARITY_RIGHT;
    return test->confirmed >= CONFIRMATIONS ? POLARITY_WRONG : POLARITY_UNDECIDED;
}

void pzs_polarity_test_end(pzs_polarity_test_state *test, const pzs_supervision *tables)
{
    test->rest = rest_of(tables, test->tests);
    test->tests++;
    test->opposed = 0;
}

void pzs_polarity_test_tolerate(pzs_polarity_test_state *test, pzs_real deviation)
{
    test->tolerated = deviation > 0 ? VIBRATION_MARGIN * deviation : 0;
}
