/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbers of a scene that are written with a unit, as "0.3 mm": the physical dimension of each key,
 * and the conversion to the units of the scene. Times are in seconds, and angles are in the unit of
 * their key; the unit of mass follows from the units of force and length.
 */
#ifndef SCENE_UNITS_H
#define SCENE_UNITS_H

#include "scene_reader.h"
#include "units.h"

enum { SCENE_UNITS_TEXT = UNITS_NUMBER + 8 };

/*
 * Convert the text of a number or formula to the units of the scene and remove its unit.
 *   node   in   a scalar
 *   text   out  used where the number has a unit
 *   plain  out  text, or the text of the node where the number has no unit
 * Returns 0, or -1 with the error of the tree filled: an unknown unit, a unit of another dimension,
 * or a scene without units.
 */
int scene_units_text(reader *reader, int node, char text[SCENE_UNITS_TEXT], const char **plain);

/*
 * Find the power of ten that converts a value in the given unit to the units of the scene. Returns
 * -1, or the index in units_base of the base unit for which the scene has no SI unit.
 */
int scene_units_ten(const scene *scene, const units_unit *unit, int *ten);

/* Return a unit of a dimension as an example for help texts, or NULL where there is none. */
const char *scene_units_example(dimension of);

#endif
