/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbers of a scene that stand in files of their own. A path is relative to the folder of the
 * scene file, and the bytes of every file that is read are part of the scene's hash.
 */
#ifndef SCENE_FILE_H
#define SCENE_FILE_H

#include "../data/number_table.h"
#include "scene_fields.h"

/*
 * Path of a file that a scene names: beside the scene file unless it is absolute. To be released
 * with free; NULL: out of memory.
 */
char *scene_file_path(const reader *reader, const char *name);

/*
 * Read the table that the text of a node names. Returns 0, or -1 with the error of the tree filled:
 * the place in the scene, then the place in the file.
 */
int scene_table_read(reader *reader, int node, number_table *table);

/*
 * Coordinate that a column of a file is, by its name with a small or a capital first letter.
 * Returns the index of x, y, z, theta1, theta2, or -1.
 */
int scene_file_axis(const char *name);

/*
 * Read a function: a formula, or a mapping {file: FILE, columns: [x, y, value], column: NAME,
 * scale: 1}, which is a function through scattered points where the table has coordinates, and else
 * a list in the order of its rows. read_row_function also accepts a list of values, and lists are
 * values in the order of the rows of a target; read_place_function refuses them.
 */
field_read read_row_function, read_place_function;
extern const form row_function_form, place_function_form, list_form, list_file_form;

/*
 * Read numbers, as a list or as {file: FILE, column: NAME}, all finite. The values are allocated.
 */
typedef struct scene_numbers {
    int count;
    double *value; /* [count] */
} scene_numbers;
int scene_numbers_read(reader *reader, int node, scene_numbers *numbers);
extern const form numbers_form;

#endif
