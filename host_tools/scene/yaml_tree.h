/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A YAML document as a tree of nodes that record their positions in the file, and error messages
 * that state these positions. A file holds one document of limited size and depth; aliases are
 * replaced by copies of their anchors.
 */
#ifndef YAML_TREE_H
#define YAML_TREE_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include "scene_error.h"

enum {
    TREE_BYTES = 4 << 20,
    TREE_NODES = 300000,
    TREE_DEPTH = 24,
    TREE_KEYS = 1000,
    TREE_ANCHORS = 100
};

typedef enum tree_kind { TREE_SCALAR, TREE_LIST, TREE_MAP } tree_kind;

typedef struct tree_node {
    tree_kind kind;
    char *key;  /* key of the node in a mapping; NULL in a list */
    char *text; /* text of a scalar */
    scene_at key_at, at;
    int parent, first, last, next, count; /* indices of related nodes, 0 for none, and number of
                                             children */
} tree_node;

typedef struct tree {
    const char *path;
    const char *const *set;
    int sets;
    char *error;     /* buffer of the error message [SCENE_ERROR] */
    tree_node *node; /* nodes with indices from 1 */
    int nodes, room, root;
    uint32_t hash; /* FNV-1a hash of the text of the file and of the set strings */
} tree;

/*
 * Read a file and apply the changes "a.b.c=value". Returns 0, or -1 with error filled; tree_free
 * must be called in both cases.
 */
int tree_read(tree *tree, const char *path, const char *const *set, int sets, char *error);

/*
 * Read a text instead of the file at the path, which is named in error messages only; otherwise as
 * tree_read without changes.
 */
int tree_read_text(tree *tree, const char *path, const char *text, size_t bytes, char *error);

/*
 * Read a whole file into a new text with a NUL behind its bytes, which the caller frees also after
 * an error. Returns 0, or -1 with error filled.
 */
int tree_load(const char *path, char **text, size_t *bytes, char *error);
void tree_free(tree *tree);

/* Return the child of a mapping with the given key, or 0. */
int tree_find(const tree *tree, int map, const char *key);

/* Return the key of a node, or of its nearest ancestor that has a key. */
const char *tree_name(const tree *tree, int node);

/*
 * Write the error message of the tree for a fault at a node (tree_fault) or at a position
 * (tree_fault_at). Both return -1.
 */
int tree_fault(const tree *tree, int node, const char *format, ...);
int tree_fault_at(const tree *tree, scene_at at, const char *format, ...);

/*
 * Write "file:line:column: message" on one line; returns -1. A line of -(k+1) refers to set[k], and
 * line 0 to the file as a whole.
 */
int tree_message(char *error, const char *path, const char *const *set, scene_at at,
                 const char *format, va_list list);

#endif
