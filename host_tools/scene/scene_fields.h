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
typedef int field_read(reader *reader, int node, void *to, const void *rule);

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

/* Kind of value that a key accepts. */
typedef enum form_type {
    FORM_NUMBER,  /* number: a constant formula, or a plain number with a unit */
    FORM_WHOLE,   /* whole number */
    FORM_FORMULA, /* formula of the coordinates */
    FORM_NAME,    /* name of at most SCENE_NAME - 1 bytes */
    FORM_TEXT,
    FORM_WORD,  /* one of the given words */
    FORM_LIST,  /* list of values of one form */
    FORM_MAP,   /* mapping with the keys of a table */
    FORM_NAMED, /* mapping of names to values of one form */
    FORM_ANY    /* one of several forms */
} form_type;

/*
 * One of the permitted combinations of keys in a mapping. `keys` lists the keys, separated by
 * blanks: "a" is required, "?a" is optional, of "a|b" exactly one is required, and "a=w" is
 * required with the word w (or one of the words "a=w/v"). Keys of the table that no combination
 * mentions are permitted in all of them.
 */
typedef struct form_case {
    const char *keys;
    const char *help; /* sentence, or NULL */
} form_case;          /* a list of combinations ends with keys = NULL */

/* Form of the value of a key, from which schema and help are made. */
typedef struct form {
    form_type type;
    const range *range;            /* FORM_NUMBER, FORM_WHOLE, FORM_FORMULA: range, or NULL */
    const choice *words;           /* FORM_WORD */
    const struct form *item;       /* FORM_LIST, FORM_NAMED: form of each item */
    const struct form *first;      /* FORM_LIST: form of the first item if it differs, or NULL */
    int least, most;               /* FORM_LIST, FORM_NAMED: number of items; most 0: any */
    const struct field *fields;    /* FORM_MAP */
    const form_case *cases;        /* FORM_MAP: permitted combinations of keys, or NULL for any */
    const struct form *const *any; /* FORM_ANY: list of forms, ended by NULL */
} form;

/*
 * Row of a table of keys, which defines a key once: the reader, the schema (pzs schema), the help
 * (pzs help keys) and the conversion of units are made from it.
 */
typedef struct field {
    const char *key; /* key of the mapping; NULL ends a table; rows are read in their order */
    field_read *read;
    size_t offset;    /* offset in bytes of the destination within its structure */
    const void *rule; /* argument of the read function: range, choices, or another rule */
    int required;
    dimension of;     /* dimension of the numbers of the value */
    const form *form; /* form of the value; NULL where it follows from a basic read function */
    const char *help; /* one sentence for users */
} field;

/* Item of the keys of a form_case: a key, or several of which exactly one is required. */
typedef struct case_item {
    const char *text; /* key, or keys separated by '|' */
    size_t length;
    int is_optional;
    const char *words; /* permitted words, separated by '/', or NULL */
    size_t words_length;
} case_item;

/* Find the next item of a list of keys, and move *keys behind it. Returns 0 at the end. */
int case_next(const char **keys, case_item *item);

/* Return whether an item of a form_case is, or has among its alternatives, a key. */
int case_item_has(const case_item *item, const char *key);

/*
 * Check the keys of a mapping against the form_case that requires "type=word" with the given word.
 * Returns 0, or -1 with the error of the tree filled.
 */
int check_type_case(reader *reader, int node, const form_case *cases, const char *word);

/* Find the form of the value of a key: that of its row, or that of its basic read function. */
form field_form(const field *field);

/* Form of a complete scene (scene_read.c). */
extern const form scene_form;

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
field_read read_expr;   /* reads an allocated expr *; rule: range or NULL */

/* Forms of values that several keys share. */
extern const form number_form, above_zero_form, not_negative_form, formula_form, name_form,
    label_form, labels_form, triple_form, flag_form;

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
