/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbers of a scene that are read from files of their own. A path is relative to the folder of the
 * scene file, and the bytes of every file that is read enter the hash of the scene.
 */
#ifndef SCENE_FILE_H
#define SCENE_FILE_H

#include "../data/number_table.h"
#include "scene_fields.h"

/* Number of coordinates x, y, z of a point in space. */
enum { SCENE_AXES = 3 };

/*
 * Return the path of a file that a scene names: relative names are taken from the folder of the
 * scene file. The caller releases it with free. Returns NULL when memory runs out.
 */
char *scene_file_path(const reader *reader, const char *name);

/*
 * Read the table of numbers whose file name is the text of a YAML node. Returns 0, or -1 after
 * writing an error message about the scene file, with the position in the scene file and the
 * position in the file.
 */
int scene_table_read(reader *reader, int node, number_table *table);

/*
 * Return which coordinate a column of a file holds, according to its name: the index among x, y, z
 * (in space), theta1 and theta2 (on the surface), or -1 for any other name. The name may begin with
 * a capital, and a unit in brackets may follow it.
 */
int scene_file_axis(const char *name);

/*
 * Read the value of a scene key that is a function: a formula, or a mapping {file: FILE, columns:
 * [x, y, value], column: NAME, scale: 1}. The file has values at points, between which they are
 * interpolated; or it has no coordinates and gives one value for each target node, in their order.
 * For a target, read_row_function also accepts such a list of values in the scene file itself.
 */
field_read read_row_function, read_place_function;
extern const form row_function_form, place_function_form, list_form, list_file_form;

/*
 * Numbers that a scene gives as a list or as {file: FILE, column: NAME}. All are finite; the array
 * is allocated.
 */
typedef struct scene_numbers {
    int count;
    double *value; /* [count] numbers that a scene gives as a list, or as a column of another file,
                      in the units that the scene file states */
} scene_numbers;
int scene_numbers_read(reader *reader, int node, scene_numbers *numbers);
extern const form numbers_form;

#endif
