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
 * Hysteresis tables for the library's blocks pzs_effect_block (effects of the present voltages) and
 * pzs_inverse_block (voltages with given effects). All amplifiers use the same numbers.
 */
typedef struct compensation {
    bool is_used; /* true where the scene has a section `hysteresis`; otherwise all other members
                     are zero */
    pzs_hysteresis tables;
    double middle, half_range, offset;
    double slope[PZS_HYSTERESIS_SEGMENTS];
    double slack[SCENE_PLAYS], above[SCENE_PLAYS], below[SCENE_PLAYS];
    double creep[SCENE_CREEPS], creep_rate[SCENE_CREEPS];
} compensation;

/*
 * Make the tables of the compensation. The tables contain pointers to other members, so
 * *compensation must not be moved in memory.
 *   rate in  tick rate (1/s); 0: not known, and 1000 is used
 */
void compensation_fill(compensation *compensation, const scene_hysteresis *hysteresis,
                       const pzs_problem *problem, double rate);

#endif
