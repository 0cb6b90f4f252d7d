/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Keys and words of the scene language that have been replaced. The reader answers them with the
 * new name, and scene_migrate rewrites them.
 */
#ifndef SCENE_RETIRED_H
#define SCENE_RETIRED_H

#include "yaml_tree.h"

/* What the migration of a scene does with a retired name. */
typedef enum retired_type {
    RETIRED_KEY,  /* the key is renamed */
    RETIRED_WORD, /* the word, a value of the key, is replaced */
    RETIRED_SLEW, /* a step limit (V a tick) becomes a rate limit (V/s) if the tick rate is given */
    RETIRED_RATE  /* the key moves to the section `control` */
} retired_type;

typedef struct retired {
    retired_type type;
    const char *path; /* path of the retired key, or of the key whose value is a retired word; '.'
                         separates keys, and the items of lists have no key */
    const char *old_name, *new_name;
    const char *remark; /* end of the error message, or "" */
} retired;

/* Return the row for the key of a node, or NULL if the key is not retired. */
const retired *retired_key(const tree *tree, int node);

/* Return the row for the value of a node, or NULL if the value is not a retired word. */
const retired *retired_word(const tree *tree, int node);

#endif
