/* Measurements against what is expected of them (sense.h). */
#include "sense.h"
#include "boxls.h"

#define FROZEN_PART 64 /* "moves": by more than 1/FROZEN_PART of |measured| + |expected| in a tick */

static pzs_real largest_size(const pzs_real *x, uint32_t n)
{
    pzs_real most = 0;
    for (uint32_t i = 0; i < n; i++)
        most = boxls_size(x[i]) > most ? boxls_size(x[i]) : most;
    return most;
}

/*
 * A measurement that is not finite, or has the same bits as before. Returns nonzero where the sensor is not to be
 * trusted: not finite, or the same bits for SENSE_FROZEN ticks in which what is expected moved
 * (seen as a change of measured - expected while measured stands still). It moves when it does so
 * by more than 1/FROZEN_PART of `most`, the largest expected of any, found when first asked for: below that lies
 * the resolution of sensors.
 */
static int doubtful(const senses *s, uint32_t i, pzs_real measured, pzs_real *most)
{
    const pzs_real difference = measured - s->expected[i];
    if (!boxls_finite(difference))
        return 1;
    const pzs_real moved = FROZEN_PART * boxls_size(difference - s->difference[i]) - boxls_size(measured);
    if (moved > 0 && *most < 0)
        *most = largest_size(s->expected, s->n);
    if (moved > 0 && moved > *most)
        s->frozen[i] = (uint8_t)(s->frozen[i] + (s->frozen[i] < SENSE_FROZEN));
    if (s->frozen[i] >= SENSE_FROZEN)
        return 1;
    s->difference[i] = difference;
    return 0;
}

/* The differences of measurements that are finite and new, from i < n on. Returns the first that is not, or n. */
static uint32_t sense_new(const senses *s, const pzs_real *measured, uint32_t i)
{
    const uint32_t n = s->n;
    const pzs_real *expected = s->expected;
    pzs_real *before = s->before, *all = s->difference;
    uint8_t *frozen = s->frozen;
    do {
        const pzs_real seen = measured[i], difference = seen - expected[i];
        if (!(seen != before[i]) || !boxls_finite(difference))
            return i;
        before[i] = seen;
        all[i] = difference;
        frozen[i] = 0;
    } while (++i < n);
    return n;
}

uint32_t sense(const senses *s, const pzs_real *measured, int32_t *where)
{
    pzs_real most = -1;
    uint32_t lost = 0;
    for (uint32_t i = 0; i < s->n; i++) {
        i = sense_new(s, measured, i);
        if (i < s->n && doubtful(s, i, measured[i], &most))
            *where = lost++ == 0 ? (int32_t)i : *where;
    }
    return lost;
}
