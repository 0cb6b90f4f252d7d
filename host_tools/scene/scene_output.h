/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of a displacement, or of another quantity at a place, for the sections `outputs` and
 * `target` of a scene file.
 */
#ifndef SCENE_OUTPUT_H
#define SCENE_OUTPUT_H

#include "scene_parts.h"

/* Keys of an output, or of a target, while they are read. */
typedef struct output_text {
    scene_output output;
    expr *value;      /* target: wanted displacement */
    bool weight_area; /* target: whether nodes are weighted with their areas */
    int quantities;   /* number of keys that name the quantity of the output */
} output_text;

/*
 * Function that reads the face of a key such as `u3` or `x`, which makes the output the
 * displacement of this face along the direction of the key (DIRECTIONS in scene_parts.h).
 */
field_read read_displacement;

/* Function that decides whether the name of a type of outputs belongs in a list of names. */
typedef bool output_test(const scene_output_info *info, const char *key);

/*
 * Write the words of the types of outputs that a function accepts, such as "strain, stress or
 * potential", to `text` of `size` bytes.
 *   key in  argument of the function
 */
enum { SCENE_OUTPUT_WORDS = 256 };
void scene_output_words(output_test *is_named, const char *key, char *text, size_t size);

/*
 * Complete an output or a target after all its keys have been read, and check it. Returns 0, or -1
 * after writing an error message about the scene file.
 */
int finish_output(reader *reader, int node, output_text *text);

#endif
