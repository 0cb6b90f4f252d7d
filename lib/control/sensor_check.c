/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check of measurements against expected values, by which missing and stuck sensors are found
 * (sensor_check.h).
 */
#include "sensor_check.h"
#include "../core/numbers.h"

/*
 * Assumed resolution of the sensors, as a reciprocal. The expected reading of a sensor counts as
 * moving if it changes in one tick by more than (|measured reading| + largest |expected reading| of
 * all sensors) / RESOLUTION.
 */
#define RESOLUTION 64

/* Return the largest absolute value among `count` numbers. */
static pzs_real largest_size(const pzs_real *vector, uint32_t count)
{
    pzs_real most = 0;
    for (uint32_t i = 0; i < count; i++)
        most = number_absolute(vector[i]) > most ? number_absolute(vector[i]) : most;
    return most;
}

/*
 * Whether to reject a finite measurement because the sensor is stuck: the measurement has had the
 * same bits in SENSOR_STUCK_TICKS ticks in which its expected value moved by more than the
 * resolution of the sensors.
 *   difference in      measurement minus expected value (unit of the sensor)
 *   most       in/out  largest |expected| of all sensors; negative: not yet computed
 */
static bool is_stuck(const sensor_check *sensors, uint32_t i, pzs_real measured,
                     pzs_real difference, pzs_real *most)
{
    const pzs_real moved = RESOLUTION * number_absolute(difference - sensors->difference[i]) -
                           number_absolute(measured);
    if (moved > 0 && *most < 0)
        *most = largest_size(sensors->expected, sensors->count);
    if (moved > 0 && moved > *most)
        sensors->repeats[i] =
            (uint8_t)(sensors->repeats[i] + (sensors->repeats[i] < SENSOR_STUCK_TICKS));
    if (sensors->repeats[i] >= SENSOR_STUCK_TICKS)
        return true;
    sensors->difference[i] = difference;
    return false;
}

uint32_t pzs_sensor_check(const sensor_check *sensors, const pzs_real *measured, int32_t *where,
                          bool *is_repeated)
{
    const uint32_t count = sensors->count;
    const pzs_real *expected = sensors->expected;
    pzs_real *last = sensors->last, *all = sensors->difference, most = -1;
    uint8_t *repeats = sensors->repeats;
    uint32_t unusable = 0;
    for (uint32_t i = 0; i < count; i++) {
        const pzs_real seen = measured[i], difference = seen - expected[i];
        const bool is_missing = !number_is_finite(difference);
        if (!is_missing && seen != last[i]) {
            last[i] = seen;
            all[i] = difference;
            repeats[i] = 0;
            *is_repeated = false;
            continue;
        }
        if (is_missing || is_stuck(sensors, i, seen, difference, &most))
            *where = unusable++ == 0 ? (int32_t)i : *where;
    }
    return unusable;
}
