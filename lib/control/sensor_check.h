/* SPDX-License-Identifier: BSD-2-Clause */
/* Sensor check: differences between measurements and the values expected of them. Measurements that
 * are missing or stuck are rejected. */
#ifndef PZS_LIB_SENSOR_CHECK_H
#define PZS_LIB_SENSOR_CHECK_H

#include "pzs_base.h"

/* A measurement is stuck once it has repeated in this many ticks in which it should have moved. */
#define SENSOR_STUCK_TICKS 8u

/* The measurements of one tick and what the check remembers of earlier ticks. */
typedef struct sensor_check {
    uint32_t n;
    const pzs_real *expected; /* [n] values that the model predicts */
    pzs_real *last;           /* [n] last measurements */
    pzs_real *difference; /* [n] measured - expected; a rejected measurement keeps its last one */
    uint8_t *repeats;     /* [n] ticks in which a measurement repeated although it should have
                             moved */
} sensor_check;

/*
 * Update all differences from measured [n].
 * Returns the number of rejected measurements; *where is the index of the first one, and is left
 * unchanged if there is none.
 */
uint32_t pzs_sensor_check(const sensor_check *sensors, const pzs_real *measured, int32_t *where);

/* Whether the last call of pzs_sensor_check rejected this measurement. */
static inline bool sensor_is_unusable(const uint8_t *repeats, pzs_real measured)
{
    const pzs_real none = measured - measured;
    return !(none <= 0) || *repeats >= SENSOR_STUCK_TICKS;
}

#endif
