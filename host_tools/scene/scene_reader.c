/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Access to the YAML nodes of a scene, and search for materials, layers and other things by their
 * names (scene_reader.h).
 */
#include "scene_reader.h"

#include <string.h>

const char *node_text(const reader *reader, int node)
{
    return reader->t->node[node].text;
}

scene_at node_at(const reader *reader, int node)
{
    scene_at at = reader->t->node[node].at;
    at.origin = reader->s->origin;
    return at;
}

int find_named(const void *items, int count, size_t size, const char *name)
{
    int i;
    for (i = 0; i < count; i++)
        if (strcmp((const char *)items + (size_t)i * size, name) == 0)
            return i;
    return -1;
}
