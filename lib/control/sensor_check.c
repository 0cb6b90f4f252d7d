/* Measurements against what is expected of them (sense.h). */
#include "sense.h"
#include "../core/numbers.h"

#define FROZEN_PART                                                                                \
    64 /* an output moves if it changes by more than 1/FROZEN_PART of |measured| + |expected| in a \
          tick */

static pzs_real largest_size(const pzs_real *x, uint32_t n)
{
    pzs_real most = 0;
    for (uint32_t i = 0; i < n; i++)
        most = number_absolute(x[i]) > most ? number_absolute(x[i]) : most;
    return most;
}

/*
 * Judge a measurement that is not finite or has the same bits as before. Returns nonzero if it is
 * rejected: it is missing (not finite), or it is stuck, that is it had the same bits for
 * SENSE_FROZEN ticks in which its expected value moved. The expected value moves if measured -
 * expected changes, while measured stands still, by more than 1/FROZEN_PART of `most`, the largest
 * expected value of all outputs (computed when first needed): smaller changes are below the
 * resolution of sensors.
 */
static int doubtful(const sensor_set *sensors, uint32_t i, pzs_real measured, pzs_real *most)
{
    const pzs_real difference = measured - sensors->expected[i];
    if (!number_is_finite(difference))
        return 1;
    const pzs_real moved = FROZEN_PART * number_absolute(difference - sensors->difference[i]) -
                           number_absolute(measured);
    if (moved > 0 && *most < 0)
        *most = largest_size(sensors->expected, sensors->n);
    if (moved > 0 && moved > *most)
        sensors->frozen[i] = (uint8_t)(sensors->frozen[i] + (sensors->frozen[i] < SENSE_FROZEN));
    if (sensors->frozen[i] >= SENSE_FROZEN)
        return 1;
    sensors->difference[i] = difference;
    return 0;
}

/*
 * Differences of measurements that are finite and new, starting at i < n. Returns the first that is
 * neither, or n.
 */
static uint32_t sense_new(const sensor_set *sensors, const pzs_real *measured, uint32_t i)
{
    const uint32_t n = sensors->n;
    const pzs_real *expected = sensors->expected;
    pzs_real *before = sensors->before, *all = sensors->difference;
    uint8_t *frozen = sensors->frozen;
    do {
        const pzs_real seen = measured[i], difference = seen - expected[i];
        if (!(seen != before[i]) || !number_is_finite(difference))
            return i;
        before[i] = seen;
        all[i] = difference;
        frozen[i] = 0;
    } while (++i < n);
    return n;
}

uint32_t pzs_sensor_check(const sensor_set *sensors, const pzs_real *measured, int32_t *where)
{
    pzs_real most = -1;
    uint32_t lost = 0;
    for (uint32_t i = 0; i < sensors->n; i++) {
        i = sense_new(sensors, measured, i);
        if (i < sensors->n && doubtful(sensors, i, measured[i], &most))
            *where = lost++ == 0 ? (int32_t)i : *where;
    }
    return lost;
}
