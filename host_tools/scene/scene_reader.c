/* SPDX-License-Identifier: BSD-2-Clause */
/* Functions of scene_reader.h: text and position of nodes, and search for items by name. */
#include "scene_reader.h"

#include <string.h>

const char *node_text(const reader *reader, int node)
{
    return reader->t->node[node].text;
}

scene_at node_at(const reader *reader, int node)
{
    return reader->t->node[node].at;
}

int find_named(const void *items, int count, size_t size, const char *name)
{
    int i;
    for (i = 0; i < count; i++)
        if (strcmp((const char *)items + (size_t)i * size, name) == 0)
            return i;
    return -1;
}
