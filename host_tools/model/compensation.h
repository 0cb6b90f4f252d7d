/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables with which the controller compensates hysteresis and creep of the ceramic, from the
 * section `hysteresis` of a scene file.
 */
#ifndef COMPENSATION_H
#define COMPENSATION_H

#include "../scene/scene.h"
#include "pzs.h"

/*
 * Hysteresis tables for two blocks (stages of a control tick): one replaces the present voltages by
 * effects, the other replaces effects by voltages. An effect is the equivalent voltage that would
 * cause the same strain in a ceramic without hysteresis. All amplifiers use the same numbers.
 */
typedef struct compensation {
    bool is_used; /* true where the scene has a section `hysteresis`; otherwise all other members
                     are zero */
    pzs_hysteresis tables;
    double middle, half_range, offset;
    double slope[PZS_HYSTERESIS_SEGMENTS];
    double slack[SCENE_PLAYS], above[SCENE_PLAYS], below[SCENE_PLAYS];
    double creep[SCENE_CREEPS], creep_rate[SCENE_CREEPS];
    double identified_offset, identified_slope[PZS_HYSTERESIS_SEGMENTS];
    double identified_above[SCENE_PLAYS], identified_below[SCENE_PLAYS];
} compensation;

/*
 * Make the tables with which the controller compensates hysteresis and creep. The tables contain
 * pointers to other members, so *compensation must not be moved in memory.
 *   rate in  tick rate (1/s); 0: it is not known, and 1000 is used
 */
void compensation_fill(compensation *compensation, const scene_hysteresis *hysteresis,
                       const pzs_problem *problem, double rate);

/*
 * Add the identified hysteresis model to the tables of a control loop. The tables already hold a
 * model with less hysteresis (compensation_weaken), whose inverse the loop uses. The fault detector
 * predicts the sensor readings with the identified model.
 */
void compensation_identify(compensation *compensation, const scene_hysteresis *identified);

/*
 * Weaken the hysteresis model that a control loop inverts: larger slopes replace play operators,
 * until a volt just after a reversal of the voltage causes at least 0.6 times the strain that a
 * volt causes far from a reversal. Otherwise the inverse would raise the loop gain on a ceramic
 * with less hysteresis.
 */
void compensation_weaken(scene_hysteresis *hysteresis);

#endif
