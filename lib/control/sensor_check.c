/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check of measurements against expected values, by which missing and stuck sensors are found
 * (sensor_check.h).
 */
#include "sensor_check.h"
#include "../core/numbers.h"

/*
 * Assumed resolution of the sensors: an expected value counts as moving if it changes in one tick
 * by more than 1/RESOLUTION of |measured| plus the largest |expected| of all sensors.
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
 * Whether to reject measurement i, which is not finite or has the same bits as in the last tick. A
 * measurement that is not finite is missing. It is stuck if it kept the same bits for
 * SENSOR_STUCK_TICKS ticks in which its expected value moved by more than the resolution of the
 * sensors.
 *   most in/out  largest |expected| of all sensors; negative: not yet computed
 */
static bool is_unusable(const sensor_check *sensors, uint32_t i, pzs_real measured, pzs_real *most)
{
    const pzs_real difference = measured - sensors->expected[i];
    if (!number_is_finite(difference))
        return true;
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

/*
 * Update the differences of measurements that are finite and differ from the last tick, from index
 * i on. Returns the index of the first other measurement, or the number of measurements.
 */
static uint32_t skip_usable(const sensor_check *sensors, const pzs_real *measured, uint32_t i)
{
    const uint32_t count = sensors->count;
    const pzs_real *expected = sensors->expected;
    pzs_real *last = sensors->last, *all = sensors->difference;
    uint8_t *repeats = sensors->repeats;
    do {
        const pzs_real seen = measured[i], difference = seen - expected[i];
        if (!(seen != last[i]) || !number_is_finite(difference))
            return i;
        last[i] = seen;
        all[i] = difference;
        repeats[i] = 0;
    } while (++i < count);
    return count;
}

uint32_t pzs_sensor_check(const sensor_check *sensors, const pzs_real *measured, int32_t *where)
{
    pzs_real most = -1;
    uint32_t unusable = 0;
    for (uint32_t i = 0; i < sensors->count; i++) {
        i = skip_usable(sensors, measured, i);
        if (i < sensors->count && is_unusable(sensors, i, measured[i], &most))
            *where = unusable++ == 0 ? (int32_t)i : *where;
    }
    return unusable;
}
