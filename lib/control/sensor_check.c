/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check of measurements against expected values, by which missing and stuck sensors are found
 * (sensor_check.h).
 */
#include "sensor_check.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * Assumed resolution of the sensors, as a reciprocal. The expected reading of a sensor counts as
 * moving if it changes in one tick by more than (|measured reading| + PEAK times the root mean
 * square (RMS) of the expected readings of all sensors) / RESOLUTION.
 *   PEAK  assumed ratio of the largest expected reading to their RMS. The sum of squares takes a
 *         quarter of the instructions of a search for the largest.
 */
#define RESOLUTION 64
#define PEAK 3

/*
 * Return PEAK times the root mean square of the expected readings of all sensors, at least a tiny
 * positive number.
 */
static pzs_real expected_size(const sensor_check *sensors)
{
    const pzs_real energy = pzs_product_dot(sensors->expected, sensors->expected, sensors->count);
    return PEAK * PZS_SQRT(energy / (pzs_real)sensors->count) + PZS_R(1e-30);
}

/*
 * Whether to reject a finite measurement because the sensor is stuck: the measurement has had the
 * same bits in SENSOR_STUCK_TICKS ticks in which its expected value moved by more than the
 * resolution of the sensors.
 *   measured    in      measurement (unit of the sensor)
 *   now         in      measurement minus expected value (unit of the sensor)
 *   difference  in/out  the same of the last tick in which it was not rejected; out: `now`, unless
 *                       it is rejected
 *   repeats     in/out  number of ticks in which the measurement repeated although its expected
 *                       value moved
 *   size        in/out  result of expected_size; 0: not yet computed
 */
static bool is_stuck(const sensor_check *sensors, pzs_real measured, pzs_real now,
                     pzs_real *difference, uint8_t *repeats, pzs_real *size)
{
    uint32_t count = *repeats & ~SENSOR_MISSING;
    if (count < SENSOR_STUCK_TICKS) {
        const pzs_real moved =
            RESOLUTION * number_absolute(now - *difference) - number_absolute(measured);
        if (moved > *size && *size <= 0)
            *size = expected_size(sensors);
        count += moved > *size ? 1u : 0u;
    }
    *repeats = (uint8_t)count;
    if (count >= SENSOR_STUCK_TICKS)
        return true;
    *difference = now;
    return false;
}

uint32_t pzs_sensor_check(const sensor_check *sensors, const pzs_real *measured, int32_t *where,
                          bool *is_repeated)
{
    const pzs_real *expected = sensors->expected;
    pzs_real *last = sensors->last, *difference = sensors->difference, size = 0;
    uint8_t *repeats = sensors->repeats;
    uint32_t unusable = 0, changed = 0;
    const uint8_t *const end = repeats + sensors->count;
    for (; repeats < end; repeats++) {
        const pzs_real seen = *measured++, now = seen - *expected++;
        bool is_usable = true;
        if (!number_is_finite(now)) {
            *repeats |= SENSOR_MISSING;
            is_usable = false;
        } else if (seen != *last) {
            *last = seen;
            *difference = now;
            *repeats = 0;
            changed++;
        } else {
            is_usable = !is_stuck(sensors, seen, now, difference, repeats, &size);
        }
        if (!is_usable && unusable++ == 0)
            *where = (int32_t)(repeats - sensors->repeats);
        last++;
        difference++;
    }
    *is_repeated = *is_repeated && changed == 0;
    return unusable;
}
