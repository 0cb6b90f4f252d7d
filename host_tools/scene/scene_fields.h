/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Table-driven reading of YAML mappings: each row of a table has a key, the function that reads its
 * value, and the rule that the value must satisfy.
 */
#ifndef SCENE_FIELDS_H
#define SCENE_FIELDS_H

#include "scene_reader.h"

/*
 * Function that reads the value of a node into *to. Returns 0, or -1 with the error of the tree
 * filled.
 */
typedef int field_read(reader *r, int node, void *to, const void *rule);

typedef struct field {
    const char *key; /* key of the mapping; NULL ends a table; rows are read in their order */
    field_read *read;
    size_t offset;    /* offset in bytes of the destination within its structure */
    const void *rule; /* argument of the read function: range, choices, or another rule */
    int required;
} field;

/* Permitted range of a number, from low to high; strict excludes the two limits. */
typedef struct range {
    double low, high;
    int strict;
    const char *must; /* text of the error message, such as "must be above 0" */
} range;

extern const range above_zero, not_negative;

typedef struct choice {
    const char *word;
    int value;
} choice; /* a list of choices ends with word = NULL */

/*
 * Read a mapping into the structure at `to`: reject unknown keys, read the rows of the table in
 * order, then report missing required keys.
 */
int read_map(reader *reader, int node, const field *fields, void *to);

field_read read_real;   /* reads a double; rule: range or NULL */
field_read read_int;    /* reads an int; rule: range */
field_read read_pair;   /* reads a double[2]; rule: range or NULL */
field_read read_name;   /* reads a char[SCENE_NAME] */
field_read read_text;   /* reads an allocated char * */
field_read read_choice; /* reads an int; rule: choices */
field_read read_flag;   /* reads an int from true, false, on, off, yes or no */
field_read read_expr;   /* reads an allocated expr * */

/* Check that a node has the given kind. Returns 0, or -1 with the error of the tree filled. */
int require_kind(reader *reader, int node, tree_kind kind);

/*
 * Allocate zeroed items, one for each child of a list or mapping node. Returns NULL with the error
 * of the tree filled if the node is of another kind or has too many children; *count is 0 for an
 * empty node.
 */
void *new_items(reader *reader, int node, tree_kind kind, size_t size, int *count);

int check_name(reader *reader, const char *name, scene_at at, char *to);

#endif
