/* SPDX-License-Identifier: BSD-2-Clause */
/* Units of the numbers of a scene, for reports, terminal and JSON alike. */
#ifndef WORDS_H
#define WORDS_H

#include <stdbool.h>
#include "../scene/scene.h"

typedef enum words_quantity {
    QUANTITY_LENGTH,
    QUANTITY_ANGLE,
    QUANTITY_FORCE,
    QUANTITY_LINE_FORCE,
    QUANTITY_PRESSURE,
    QUANTITY_VOLTAGE,
    QUANTITY_CHARGE,
    QUANTITY_TEMPERATURE,
    QUANTITY_NODES,
    QUANTITY_OTHER
} words_quantity;

/* Characters of a unit's text, the terminating zero included. */
enum { WORDS_UNIT = 3 * SCENE_NAME };

/*
 * Write the unit of a quantity, made from the units of the scene; empty where the scene leaves one
 * of them out. Returns text.
 */
const char *words_unit(const scene *scene, words_quantity quantity, char text[WORDS_UNIT]);

/* Whether the scene names no unit at all; its numbers are then in any consistent units. */
bool words_unitless(const scene *scene);

/* Quantity that theta1 (direction 0) or theta2 (direction 1) measures on the scene's surface. */
words_quantity words_of_theta(const scene *scene, int direction);

/* Quantity of a load's value, and of an output's values. */
words_quantity words_of_load(const scene_load *load);
words_quantity words_of_output(const scene_output *output);

#endif
