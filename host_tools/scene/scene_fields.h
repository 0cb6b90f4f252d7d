/* SPDX-License-Identifier: BSD-2-Clause */
/* Mappings of a scene read by tables: one row a key, with the reader of its value and the value's
 * rule. */
#ifndef SCENE_FIELDS_H
#define SCENE_FIELDS_H

#include "scene_reader.h"

/* Read a node into *to; 0, or -1 with the tree's error filled. */
typedef int field_read(reader *r, int node, void *to, const void *rule);

typedef struct field {
    const char *key; /* NULL ends a table; rows are read in their order */
    field_read *read;
    size_t offset;    /* of what is read within its structure */
    const void *rule; /* of the reader: range, choices, or its own */
    int required;
} field;

/* Numbers from low to high; strict leaves the ends out. */
typedef struct range {
    double low, high;
    int strict;
    const char *must; /* "must be above 0" */
} range;

extern const range above_zero, not_negative;

typedef struct choice {
    const char *word;
    int value;
} choice; /* NULL word ends */

/* Read a mapping into the structure at `to`: unknown keys, then each row, then what is missing. */
int read_map(reader *reader, int node, const field *fields, void *to);

field_read read_real;   /* double; rule: range or NULL */
field_read read_int;    /* int; rule: range */
field_read read_pair;   /* double[2]; rule: range or NULL */
field_read read_name;   /* char[SCENE_NAME] */
field_read read_text;   /* char *, allocated */
field_read read_choice; /* int; rule: choices */
field_read read_flag;   /* int; true false on off yes no */
field_read read_expr;   /* expr *, allocated */

/* Fault unless a node is of this kind; returns 0 or -1. */
int require_kind(reader *reader, int node, tree_kind kind);

/* Zeroed items for a list or mapping node of moderate length; NULL on a fault. *count is 0 for an
 * empty one. */
void *new_items(reader *reader, int node, tree_kind kind, size_t size, int *count);

int check_name(reader *reader, const char *name, scene_at at, char *to);

#endif
