/* SPDX-License-Identifier: BSD-2-Clause */
/* What every function that reads a part of a scene gets: the tree of the file and the scene read so
 * far. */
#ifndef SCENE_READER_H
#define SCENE_READER_H

#include "scene.h"
#include "yaml_tree.h"

typedef struct reader {
    tree *t;
    scene *s;
} reader;

/* The text of a scalar node. */
const char *node_text(const reader *reader, int node);

/* The place of a node in the scene file. */
scene_at node_at(const reader *reader, int node);

/* Index of the item with a name among count items [size bytes each] whose first member is their
 * name; -1 if none has that name. */
int find_named(const void *items, int count, size_t size, const char *name);

#endif
