/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A YAML document as a tree of nodes that know their positions in the file, and error messages that
 * state these positions. A file holds one document of limited size and depth; aliases are replaced
 * by copies of their anchors.
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
    char *key;  /* key in the YAML file whose value the node is; NULL for an item of a list */
    char *text; /* text of a YAML node that is a scalar */
    scene_at key_at, at;
    int parent, first, last, next, count; /* indices of the parent, the first and last child and the
                                             next sibling of a node, 0 for none, and its number of
                                             children */
} tree_node;

typedef struct tree {
    const char *path;
    const char *const *set;
    int sets;
    char *error;     /* [SCENE_ERROR] memory of the error message about the YAML file */
    tree_node *node; /* array of the nodes of the YAML tree; index 0 is not used */
    int nodes, room, root;
    uint32_t hash; /* FNV-1a hash of the text of the YAML file and of the texts of the changes from
                      the command line */
} tree;

/*
 * Read a YAML file as a tree and apply changes to it.
 *   set    [sets] in            changes of the form "a.b.c=value"
 *   error  [SCENE_ERROR] out    one line with the position of a fault
 * Returns 0, or -1 with error filled. tree_free must be called in both cases.
 */
int tree_read(tree *tree, const char *path, const char *const *set, int sets, char *error);

/*
 * Read a YAML text in memory as a tree; the path of its file is only named in error messages.
 * Returns 0, or -1 with error filled. tree_free must be called in both cases.
 */
int tree_read_text(tree *tree, const char *path, const char *text, size_t bytes, char *error);

/*
 * Read a whole file into allocated memory with a NUL after its bytes; the caller releases it also
 * after an error. Returns 0, or -1 with error filled.
 */
int tree_load(const char *path, char **text, size_t *bytes, char *error);
void tree_free(tree *tree);

/*
 * Return the index of the child of a YAML mapping that has a given key, or 0 if there is none; the
 * children of a YAML list have no keys.
 */
int tree_find(const tree *tree, int map, const char *key);

/* Return the key of a YAML node, or of its nearest ancestor that has a key. */
const char *tree_name(const tree *tree, int node);

/*
 * Write an error message about a YAML file, with the position of a node (tree_fault) or with a
 * given position (tree_fault_at). Both return -1.
 */
int tree_fault(const tree *tree, int node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
int tree_fault_at(const tree *tree, scene_at at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/*
 * Write an error message of the form "file:line:column: message" on one line. Line -(k + 1) stands
 * for set[k], a change of the scene by the option --set of the command line, and line 0 for the
 * file as a whole. Returns -1.
 */
int tree_message(char *error, const char *path, const char *const *set, scene_at at,
                 const char *format, va_list list);

#endif
