/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbers of a scene that are written with a unit, such as "0.3 mm": their physical dimension is
 * checked, and they are converted to the units of the scene. Times are in seconds, angles in the
 * unit of their key; the unit of mass follows from the units of force and length.
 */
#ifndef SCENE_UNITS_H
#define SCENE_UNITS_H

#include "scene_reader.h"
#include "units.h"

enum { SCENE_UNITS_TEXT = UNITS_NUMBER + 8 };

/*
 * Convert the text of a number or formula to the units of the scene and remove its unit.
 *   node   in   YAML node, a scalar
 *   text   out  memory for the converted text
 *   plain  out  text without a unit: `text`, or that of the node if it has no unit
 * Returns 0, or -1 after writing an error message about the scene file: unknown unit, unit of
 * another dimension, scene without units, or too many digits.
 */
int scene_units_text(reader *reader, int node, char text[SCENE_UNITS_TEXT], const char **plain);

/*
 * Find the power of ten that converts a value in a given unit to the units of the scene. Returns -1
 * on success, or the index (units_base) of a base unit, such as the metre, for which the scene
 * names no SI unit.
 */
int scene_units_ten(const scene *scene, const units_unit *unit, int *ten);

/*
 * Find the factor that converts a column of a file to the units of the scene, if the name of the
 * column states a unit in brackets, as "x [mm]" or "u3 (um)".
 *   node    in   YAML node of the key whose numbers stand in the column
 *   of      in   physical dimension of the key
 *   column  in   name of the column
 *   factor  out  factor of the numbers; 1 where the scene has no SI units
 * Returns 1 after a conversion, 0 without a unit, or -1 after writing an error message about the
 * scene file: the unit has another dimension than the key.
 */
int scene_units_column(reader *reader, int node, dimension of, const char *column, double *factor);

/*
 * Return a unit of a physical dimension as an example for help texts, or NULL where there is none.
 */
const char *scene_units_example(dimension of);

#endif
