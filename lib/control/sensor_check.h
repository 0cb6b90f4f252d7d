/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sensor check: computes the differences between measurements and the values that the model
 * predicts, and rejects measurements that are missing or stuck.
 */
#ifndef PZS_LIB_SENSOR_CHECK_H
#define PZS_LIB_SENSOR_CHECK_H

#include "pzs_base.h"

/*
 * Number of ticks after which a measurement counts as stuck, if it repeated in all of them although
 * it should have moved.
 */
#define SENSOR_STUCK_TICKS 8u

/* Mark of a sensor whose measurement is missing, in sensor_check.repeats. */
#define SENSOR_MISSING 128u

/*
 * The measurements of one tick, the values expected for them, and what the check for missing and
 * stuck sensors remembers of earlier ticks. All arrays have one entry for each sensor.
 */
typedef struct sensor_check {
    uint32_t count;
    const pzs_real *expected; /* values that the model predicts (unit of each sensor) */
    pzs_real *last;           /* measurements of the last tick (unit of each sensor) */
    pzs_real *difference; /* measured minus expected value; a rejected measurement keeps its last
                             difference (unit of each sensor) */
    uint8_t *repeats; /* for each sensor, number of ticks in which its measurement repeated although
                         its expected value moved, plus SENSOR_MISSING while it is missing */
} sensor_check;

/*
 * Update the differences between the measurements of a tick and the values that the model predicts.
 * Returns the number of rejected (missing or stuck) measurements; *where receives the index of the
 * first one, and stays unchanged if there is none.
 *   is_repeated out  false if a measurement differs from that of the last tick; otherwise unchanged
 */
uint32_t pzs_sensor_check(const sensor_check *sensors, const pzs_real *measured, int32_t *where,
                          bool *is_repeated);

/*
 * Return whether the last call of pzs_sensor_check rejected a measurement.
 *   repeats in  entry of the sensor in sensor_check.repeats
 */
static inline bool sensor_is_unusable(uint8_t repeats)
{
    return repeats >= SENSOR_STUCK_TICKS;
}

#endif
