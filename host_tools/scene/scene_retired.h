/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Keys and words of the scene language that newer names have replaced. The scene reader refuses
 * each of them with an error message that states the new name; scene_migrate replaces it in a file.
 */
#ifndef SCENE_RETIRED_H
#define SCENE_RETIRED_H

#include "yaml_tree.h"

/* Way in which the migration of a scene file replaces a retired name. */
typedef enum retired_type {
    RETIRED_KEY,  /* a retired key of a scene (a key that is no longer read) is replaced by its new
                     name */
    RETIRED_WORD, /* a retired word that is the value of a key is replaced by its new word */
    RETIRED_SLEW, /* a step limit (V a tick) becomes a rate limit (V/s) if the scene file gives the
                     tick rate */
    RETIRED_RATE  /* a retired key is moved to the section `control` */
} retired_type;

typedef struct retired {
    retired_type type;
    const char *path; /* path of the retired key, or of the key whose value is a retired word: keys
                         joined by '.', where the items of lists have no key */
    const char *old_name, *new_name;
    const char *remark; /* remark that ends the error message about a retired name, or an empty
                           string */
} retired;

/*
 * Return the row of the table of retired names for the key of a YAML node, or NULL if the key is
 * not retired.
 */
const retired *retired_key(const tree *tree, int node);

/*
 * Return the row of the table of retired names for the value of a YAML node, or NULL if the value
 * is not a retired word.
 */
const retired *retired_word(const tree *tree, int node);

#endif
