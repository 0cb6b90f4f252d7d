/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Input of every function that reads a section of a scene: the YAML tree of the file, and the scene
 * as it has been read so far.
 */
#ifndef SCENE_READER_H
#define SCENE_READER_H

#include "scene.h"
#include "scene_dimension.h"
#include "yaml_tree.h"

typedef struct reader {
    tree *t;
    scene *s;
    dimension of; /* physical dimension that the key of the value being read requires */
} reader;

/* Return the text of a YAML node that is a scalar, or NULL for a list or mapping. */
const char *node_text(const reader *reader, int node);

/*
 * Return the position of a YAML node for error messages: line, column, and the scene file or the
 * option --set that it comes from.
 */
scene_at node_at(const reader *reader, int node);

/*
 * Return the index of the item (such as a material or a layer) with a given name in an array, or -1
 * if there is none. The array has count items of size bytes each, and the first member of every
 * item is its name.
 */
int find_named(const void *items, int count, size_t size, const char *name);

#endif
