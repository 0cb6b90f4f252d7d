/* SPDX-License-Identifier: BSD-2-Clause */
/* Units of the quantities of a scene, for reports, terminal output and JSON. */
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

/* Size of the text of a unit (characters), with the terminating zero. */
enum { WORDS_UNIT = 3 * SCENE_NAME };

/*
 * Write the unit of a quantity, composed of the units of the scene; empty where the scene omits one
 * of these units. Returns text.
 */
const char *words_unit(const scene *scene, words_quantity quantity, char text[WORDS_UNIT]);

/* Whether the scene names no unit at all, so that its numbers are in arbitrary consistent units. */
bool words_unitless(const scene *scene);

/* Quantity of the surface coordinate theta1 (direction 0) or theta2 (direction 1). */
words_quantity words_of_theta(const scene *scene, int direction);

/* Quantity of the value of a load, and of the values of an output. */
words_quantity words_of_load(const scene_load *load);
words_quantity words_of_output(const scene_output *output);

#endif
