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
    QUANTITY_MOMENT,
    QUANTITY_LINE_FORCE,
    QUANTITY_PRESSURE,
    QUANTITY_VOLTAGE,
    QUANTITY_CHARGE,
    QUANTITY_TEMPERATURE,
    QUANTITY_NODES,
    QUANTITY_INFLUENCE, /* unit of an entry of an influence matrix: length per voltage */
    QUANTITY_FIELD,     /* unit of an electric field: voltage per length */
    QUANTITY_OTHER
} words_quantity;

/* Size of the text of a unit, including its NUL (characters). */
enum { WORDS_UNIT = 3 * SCENE_NAME };

/*
 * Write the unit of a quantity, composed of the units of the scene; the text is empty if the scene
 * file does not name one of these units. Returns `text`.
 */
const char *words_unit(const scene_unit_names *units, words_quantity quantity,
                       char text[WORDS_UNIT]);

/*
 * Size of the text that words_bare_face writes, such as "potential of layer 1 upper, inner face",
 * including its NUL (characters).
 */
enum { WORDS_FACE = SCENE_NAME + 48 };

/*
 * Write the name of the electric potentials on a face of a layer, such as "potential of layer 1
 * upper, inner face" for a layer named upper. Returns whether the face is bare (has no electrode),
 * so that its potential varies from node to node.
 *   layer [layers] in   layers of the scene
 *   k              in   number of the face: 2 i for the inner and 2 i + 1 for the outer face of
 *       layer i, counted from 0
 */
bool words_bare_face(const scene_layer *layer, int k, char text[WORDS_FACE]);

/*
 * Return whether the scene file names no units at all, so that its numbers are in arbitrary
 * consistent units.
 */
bool words_unitless(const scene_unit_names *units);

/*
 * Return the physical quantity, such as force or voltage, that the value of a load (words_of_load)
 * or the values of an output (words_of_output) measure.
 */
words_quantity words_of_load(const scene_load *load);
words_quantity words_of_output(const scene_output *output);

#endif
