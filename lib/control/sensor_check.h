/* Measurements against what is expected of them; those not to be trusted. */
#ifndef PZS_LIB_SENSE_H
#define PZS_LIB_SENSE_H

#include "pzs_base.h"

#define SENSE_FROZEN 8u /* a measurement that repeats so often while it should move is frozen */

typedef struct sensor_set {
    uint32_t n;
    const pzs_real *expected; /* [n] */
    pzs_real *before;         /* [n] last measurements */
    pzs_real *difference;     /* [n] measured - expected; the last one where there is no usable
                                 measurement */
    uint8_t *frozen;          /* [n] ticks a moving one has stood still */
} sensor_set;

/* All differences. Returns the number of unusable measurements, the first in where. */
uint32_t pzs_sensor_check(const sensor_set *sensors, const pzs_real *measured, int32_t *where);

/* Was a measurement unusable in the last call? */
static inline int sense_lost(const uint8_t *frozen, pzs_real measured)
{
    const pzs_real none = measured - measured;
    return !(none <= 0) || *frozen >= SENSE_FROZEN;
}

#endif
