/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables of the sensor gate (pzs_sensor_gate): ranges of the readings, and parity relations, sums
 * over all readings that are 0 for what voltages, observed vibration modes and loads of the scene
 * can make together.
 *
 * Where the sensors outnumber these causes twice, the relations hold for all of them, and a healthy
 * loop violates none. Otherwise they hold for those directions in which the readings move most, as
 * many as make the errors that the gate may miss least harmful; thresholds are then above what the
 * other directions can feign at the limits of the voltages. Of all relations, random sums are
 * taken: what a load that the scene does not name adds to them hardly ever looks like one sensor.
 */
#ifndef SENSOR_GATE_H
#define SENSOR_GATE_H

#include "../model/damper.h"
#include "../model/estimator.h"

/* Range of a reading for which nothing tells how large it may be. */
#define SENSOR_GATE_NO_RANGE 1e30

typedef struct sensor_gate {
    bool is_used;   /* true where the scene asks for a sensor gate or states a range */
    int judged;     /* number of sensors whose errors inside their ranges are found; 0: the gate has
                       ranges only */
    double certain; /* part of its range from which on the error of a single sensor is found for
                       certain: largest one of the judged sensors */
    double moved;   /* largest motion of the shape (RMS over the outputs, in units of the target, or
                       of what half the voltage range moves where that is less) by an error of one
                       reading that the gate does not find */
    double *memory; /* one allocation that holds all arrays of the tables */
    pzs_sensor_gate tables;
} sensor_gate;

/*
 * Make the tables of the sensor gate of a scene, which is unused where the scene does not ask for
 * it.
 *   analysis   in  analysis whose influence matrix is computed
 *   estimator  in  shape estimator, with the effects of the loads; `is_few` tells whether its
 *                  sensors are the readings, which otherwise are all target displacements
 *   damper     in  tables of the vibration damper
 *   unit       in  unit of the motion of the shape (RMS over the outputs)
 * Returns whether memory sufficed; call sensor_gate_close in either case.
 */
bool sensor_gate_open(sensor_gate *gate, const analysis *analysis, const estimator *estimator,
                      bool is_few, const damper *damper, double unit);
void sensor_gate_close(sensor_gate *gate);

/* Return whether the control loop of a scene has a sensor gate. */
bool sensor_gate_is_asked(const design *design);

/* Write sentences on what the sensor gate can find. */
void sensor_gate_text(const sensor_gate *gate, char text[SCENE_ERROR]);

#endif
