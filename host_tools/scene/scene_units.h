/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbers of a scene that carry units, as "0.3 mm": what each key measures, and the conversion to
 * the scene's units. Times are in seconds, angles in the unit of their key; the unit of mass
 * follows from those of force and length.
 */
#ifndef SCENE_UNITS_H
#define SCENE_UNITS_H

#include "scene_reader.h"
#include "units.h"

enum { SCENE_UNITS_TEXT = UNITS_NUMBER + 8 };

/*
 * The text of a number or formula without its unit, converted.
 *   node   in   a scalar
 *   text   out  used where there is a unit
 *   plain  out  text, or the node's own where it has no unit
 * Returns 0, or -1 with the tree's error filled: no unit, one of another dimension, or a scene
 * without units.
 */
int scene_units_text(reader *reader, int node, char text[SCENE_UNITS_TEXT], const char **plain);

/*
 * The power of ten that a value in a unit is multiplied by to be in the scene's units.
 * Returns -1, or the base (of units_base) that the scene has no SI unit for.
 */
int scene_units_ten(const scene *scene, const units_unit *unit, int *ten);

/* Is the dimension of a key known? key [keys] in: its path from the root, without the items of
 * lists. For tests. */
int scene_units_known(const char *const *key, int keys);

#endif
