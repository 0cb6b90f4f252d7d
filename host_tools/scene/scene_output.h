/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of outputs (displacements and other quantities at a place) for the sections `outputs` and
 * `target` of a scene file.
 */
#ifndef SCENE_OUTPUT_H
#define SCENE_OUTPUT_H

#include "scene_parts.h"

/* An output, or the target of a control task, while its keys are read. */
typedef struct output_text {
    scene_output output;
    expr *value;      /* formula of the wanted displacement; used for a target only */
    bool weight_area; /* whether the nodes of a target are weighted with their areas */
    int quantities;   /* number of keys read so far that name the quantity of the output */
} output_text;

/*
 * Function that reads a key such as `u3` or `x`, whose value is a face of the shell. The output
 * becomes the displacement of this face along the direction that the key names (DIRECTIONS in
 * scene_parts.h).
 */
field_read read_displacement;

/*
 * Function that decides whether the name of a type of outputs is to be listed in a text.
 *   key in  key of the scene file for which the list is made
 */
typedef bool output_test(const scene_output_info *info, const char *key);

/*
 * Write the names of those types of outputs that a function accepts, such as "strain, stress or
 * potential", to `text` of `size` bytes.
 *   key in  argument of the function
 */
enum { SCENE_OUTPUT_WORDS = 256 };
void scene_output_words(output_test *is_named, const char *key, char *text, size_t size);

/*
 * Complete an output or a target after all its keys have been read, and check it: refuse keys that
 * belong to other types of outputs, then apply the rules of its own type. Returns 0, or -1 after
 * writing an error message about the scene file.
 */
int finish_output(reader *reader, int node, output_text *text);

#endif
