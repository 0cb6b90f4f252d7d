/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A YAML document as a tree of plain nodes that remember where they were written, and the fault
 * messages that say so. Bounded in size and depth; one document; aliases are copied in.
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
    char *key;  /* the key it stands under, NULL in a list */
    char *text; /* of a scalar */
    scene_at key_at, at;
    int parent, first, last, next, count; /* nodes; 0 is none */
} tree_node;

typedef struct tree {
    const char *path;
    const char *const *set;
    int sets;
    char *error;     /* [SCENE_ERROR] */
    tree_node *node; /* from 1 */
    int nodes, room, root;
    uint32_t hash; /* FNV-1a of the file and the set strings */
} tree;

/* Read a file and apply the changes "a.b.c=value". Returns 0, or -1 with error filled; tree_free in
 * both cases. */
int tree_read(tree *tree, const char *path, const char *const *set, int sets, char *error);
void tree_free(tree *tree);

/* The child of a mapping under a key, or 0. */
int tree_find(const tree *tree, int map, const char *key);

/* The nearest key at or above a node: what a reader would call it. */
const char *tree_name(const tree *tree, int node);

/* Fill the tree's error for a fault at a node, or at its key; both return -1. */
int tree_fault(const tree *tree, int node, const char *format, ...);
int tree_fault_at(const tree *tree, scene_at at, const char *format, ...);

/*
 * Write "file:line:column: message" on one line; returns -1.
 * A line of -(k+1) stands for set[k], 0 for the file as a whole.
 */
int tree_message(char *error, const char *path, const char *const *set, scene_at at,
                 const char *format, va_list list);

#endif
