/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Which electrodes the fault detector of a loop that damps vibration (pzs_pulse_detector_block) can
 * find faulty from the sensors of a scene, and how far the responses to its test pulses stand out
 * from the noise of the readings.
 */
#ifndef DETECTION_H
#define DETECTION_H

#include "../text/json.h"
#include "loop_blocks.h"

/* Whether the fault detector can find a fault of an electrode, and if not, why. */
typedef enum detection_doubt {
    DETECTION_SURE,         /* a fault of this electrode can be found */
    DETECTION_UNOBSERVABLE, /* a fault cannot be found: the sensors cannot tell this electrode from
                               others, or it has no test pulse */
    DETECTION_HIDDEN, /* a fault cannot be found: the sensors' response to the test pulse of this
                         electrode is lost in their noise */
    DETECTION_DOUBTS
} detection_doubt;

typedef struct detection {
    bool is_used;   /* true where the loop of the scene contains a fault detector with test pulses;
                       otherwise all other members of this struct are zero */
    int electrodes; /* number of electrodes of the controller */
    int detectable; /* number of electrodes whose faults the fault detector can find */
    int sensors;    /* number of sensors whose readings the fault detector uses */
    int ticks;      /* duration of a test pulse (ticks) */
    int motion;     /* longest time in which the target must move until a fault is suspected, if the
                       readings show it well: two windows in which readings are averaged (ticks) */
    int proof;      /* time from the last motion of the target until the fault of a suspected
                       electrode is proved by one undisturbed test pulse (ticks) */
    int weakest;  /* index of the electrode whose response to its test pulse is the weakest relative
                     to noise, among the electrodes that the sensors can tell from others */
    double ratio; /* signal-to-noise ratio (dimensionless) of the electrode `weakest`: response of
                     the readings to a test pulse over the standard deviation of their noise;
                     infinite without noise, 0 if the sensors can tell no electrode from others */
    detection_doubt *doubt; /* [electrodes] whether a fault of each electrode can be found, and if
                               not, why */
} detection;

/*
 * Find out which electrodes the fault detector of the scene's control loop can find faulty. Without
 * such a detector, or where its loop cannot be made, the result is unused.
 *   analysis in  analysis with influence matrix and stability tests of the loop; must outlive
 *       `detection`
 * Returns whether memory sufficed; call detection_close in either case.
 */
bool detection_make(detection *detection, const analysis *analysis);

/*
 * Find out which electrodes a fault detector can find faulty.
 *   blocks in  blocks of a loop that damps vibration and contains the fault detector
 * Where the loop cannot be initialised, the result is unused. Returns whether memory sufficed; call
 * detection_close in either case.
 */
bool detection_of(detection *detection, const loop_blocks *blocks);
void detection_close(detection *detection);

/*
 * Describe in one line the test pulses, the number of electrodes whose faults can be found, and the
 * weakest response.
 */
void detection_text(const detection *detection, const design *design, char text[SCENE_ERROR]);

/* List as text the electrodes whose faults cannot be found, with the reason; empty without any. */
void detection_remarks(const detection *detection, const design *design, char text[SCENE_ERROR]);

/* Write as a JSON object "fault_detector" which electrodes the fault detector can find faulty. */
void detection_json(const detection *detection, const design *design, json *json);

#endif
