/* SPDX-License-Identifier: BSD-2-Clause */
/* Tables of the compensation of hysteresis and creep, from the section `hysteresis` of a scene. */
#ifndef COMPENSATION_H
#define COMPENSATION_H

#include "../scene/scene.h"
#include "pzs.h"

/* Tables of pzs_effect_block and pzs_inverse_block with one set of numbers for all amplifiers. */
typedef struct compensation {
    bool is_used; /* the scene has the section; otherwise the rest is zero */
    pzs_hysteresis tables;
    double middle, half_range, offset;
    double slope[PZS_HYSTERESIS_SEGMENTS];
    double slack[SCENE_PLAYS], above[SCENE_PLAYS], below[SCENE_PLAYS];
    double creep[SCENE_CREEPS], creep_rate[SCENE_CREEPS];
} compensation;

/*
 * Make the tables; *compensation points into itself, so it must not be moved.
 *   rate  in  ticks a second; 0: not known, then 1000
 */
void compensation_fill(compensation *compensation, const scene_hysteresis *hysteresis,
                       const pzs_problem *problem, double rate);

#endif
