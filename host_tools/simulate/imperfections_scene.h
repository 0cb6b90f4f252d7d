/* SPDX-License-Identifier: BSD-2-Clause */
/* Imperfections of amplifiers, cables, ceramic and sensors as a scene states them. */
#ifndef IMPERFECTIONS_SCENE_H
#define IMPERFECTIONS_SCENE_H

#include "../model/design.h"
#include "imperfections.h"

/*
 * Return the width of the hysteresis loop of the ceramic relative to the voltage range: the value
 * that the scene file gives; without one, 0.1 for a piezoceramic between finite voltage limits, and
 * 0 for other actuators.
 */
double imperfections_hysteresis(const design *design);

/*
 * Refuse a scene with hysteresis but without finite voltage limits, because the width of the
 * hysteresis loop is relative to the voltage range. Returns 0, or -1 with a message in `error`.
 */
int imperfections_check(const design *design, char *error);

/*
 * Return the constants of the simulated imperfections of amplifiers, cables, ceramic and sensors
 * that a scene describes. The arrays in the constants belong to
 * `design`, which must remain valid as long as the constants are used.
 */
imperfection_tables imperfections_of_scene(const design *design);

/*
 * List as text the imperfections of amplifiers, cables, ceramic and sensors that a scene simulates;
 * the text is empty where there are none.
 */
void imperfections_text(const design *design, char *text, size_t room);

#endif
