/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Simulation of a control loop with a sensor gate (block that takes wrong readings away) on a
 * structure with mass, while one sensor after the other reads the end of its range.
 */
#ifndef WRONG_SENSOR_H
#define WRONG_SENSOR_H

#include "storm_rig.h"

typedef struct wrong_sensor {
    int tried;       /* number of sensors that were wrong, one after the other */
    int sensor;      /* the one that moved the shape most, from 0 */
    double error;    /* what it read: the end of its range (unit of the sensor) */
    double moved;    /* largest distance of the shape from that before, in two periods of the first
                        observed mode, divided by rig->scale */
    bool is_stopped; /* whether the supervisor took control away from the loop, which then ends */
} wrong_sensor;

/*
 * Let one sensor after the other read the end of its range for two periods, while the target of the
 * scene stands. Of more than 64 sensors, 64 are tried. The loop is that of storm_use.
 *   gate  in  tables of the sensor gate of this loop
 *   first in  frequency of the first vibration mode that the loop observes (Hz); 0: none
 * Returns 0, or -1 with error filled.
 */
int wrong_sensor_run(const storm_rig *rig, const pzs_sensor_gate *gate, double first,
                     wrong_sensor *result, char *error);

#endif
