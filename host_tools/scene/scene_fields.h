/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Table-driven reading of YAML mappings: each row of a table holds a key, the function that reads
 * its value, and the rule (such as a permitted range) that the value must satisfy.
 */
#ifndef SCENE_FIELDS_H
#define SCENE_FIELDS_H

#include "scene_reader.h"

/*
 * Function that reads the value of a YAML node into the C object at `to`. The argument `rule` holds
 * what the row of the table of keys states for this function, such as a permitted range. Returns 0,
 * or -1 after writing an error message about the scene file.
 */
typedef int field_read(reader *reader, int node, void *to, const void *rule);

/*
 * Permitted range of a number, from low to high; if strict is true, the two limits themselves are
 * refused.
 */
typedef struct range {
    double low, high;
    bool strict;
    const char *must; /* end of the error message for a number outside the range, such as "must be
                         above 0" */
} range;

extern const range above_zero, not_negative;

typedef struct choice {
    const char *word;
    int value;
} choice; /* Word of a scene file and the value for which it stands; an array of such choices ends
             with word = NULL. */

/* Type of the value that a key of a scene accepts. */
typedef enum form_type {
    FORM_NUMBER,  /* FORM_NUMBER: the value is a number: plain (2.5), a formula without variables
                     (pi/4), or a number with a unit (2.5 mm) */
    FORM_WHOLE,   /* FORM_WHOLE: value that is an integer number */
    FORM_FORMULA, /* FORM_FORMULA: value that is a formula in the coordinates of a point */
    FORM_NAME,    /* FORM_NAME: value that is a name of at most SCENE_NAME - 1 bytes */
    FORM_TEXT,
    FORM_WORD,  /* FORM_WORD: value that is one word of an array of permitted words */
    FORM_LIST,  /* FORM_LIST: value that is a list whose items all have one form */
    FORM_MAP,   /* FORM_MAP: value that is a mapping whose keys are the rows of a table */
    FORM_NAMED, /* FORM_NAMED: mapping of names that the user chooses to values of one form */
    FORM_ANY /* FORM_ANY: value that may have any one of several forms, such as a number or a list
              */
} form_type;

/*
 * One of the permitted combinations of keys in a mapping. `keys` lists keys, separated by blanks;
 * keys of the table that no combination mentions are always permitted.
 *   a      required
 *   ?a     optional
 *   a|b    exactly one is required
 *   a=w/v  required, with the word w or v
 */
typedef struct form_case {
    const char *keys;
    const char *help; /* sentence that explains to users the combination of keys listed in `keys`,
                         or NULL */
} form_case;

/*
 * Form of the value of a key in a scene file; the JSON schema and the help texts are made from it.
 */
typedef struct form {
    form_type type;
    const range *range;  /* permitted range of the number, for a value that is a number, an integer
                            or a constant formula (FORM_NUMBER, FORM_WHOLE, FORM_FORMULA); NULL: any
                            number */
    const choice *words; /* array of the permitted words, for a value that is a word (FORM_WORD) */
    const struct form *item; /* description of each item, for a value that is a list or a mapping of
                                names (FORM_LIST, FORM_NAMED) */
    const struct form *first; /* description (form) of the first item of a list (FORM_LIST) where it
                                 differs from that of the other items, else NULL */
    int least, most; /* FORM_LIST, FORM_NAMED: smallest and largest number of items; most = 0: any
                        number */
    const struct field *fields; /* table of the permitted keys, for a value that is a mapping
                                   (FORM_MAP) */
    const form_case *cases; /* permitted combinations of the keys of a mapping (FORM_MAP); NULL: any
                               combination */
    const struct form *const *any; /* array of descriptions (forms), ended by NULL, for a value that
                                      may be of several types, such as a number or a list
                                      (FORM_ANY): the value must satisfy one of them */
} form;

/*
 * Row of a table of keys, the only place where a key is defined: the reader, the JSON schema (pzs
 * schema), the help (pzs keys) and the conversion of units are made from it.
 */
typedef struct field {
    const char *key; /* key of the mapping; NULL ends the table; the rows are read in the order of
                        the table */
    field_read *read;
    size_t offset;    /* offset of the member that receives the value of a key, in the C struct that
                         the mapping fills (bytes) */
    const void *rule; /* argument `rule` of the function that reads the value of a key: a permitted
                         range, an array of permitted words, or what else that function needs */
    bool required;
    dimension of;     /* physical dimension of the numbers in the value of the key */
    const form *form; /* form: description of the values that a key accepts; NULL where the function
                         that reads the value (member `read`) implies it, as for plain numbers */
    const char *help; /* sentence that explains the key to users */
} field;

/*
 * A combination of keys that a YAML mapping may have is described by a text of items separated by
 * blanks, such as "a ?b c|d" (form_case.keys). This is one item: a required key, an optional key
 * (?b), or alternatives of which exactly one is required (c|d).
 */
typedef struct case_item {
    const char *text; /* text of an item in a list of permitted keys: one key, or several keys
                         separated by '|'; not terminated by NUL */
    size_t length;
    bool is_optional;
    const char *words; /* words that the key may have as its value, separated by '/', or NULL for
                          any value */
    size_t words_length;
} case_item;

/*
 * Find the next item in a list of keys (form_case.keys), and move *keys past it. Returns 1, or 0 at
 * the end of the list.
 */
int case_next(const char **keys, case_item *item);

/*
 * Return whether an item of a list of permitted keys (form_case) contains a given key, alone or
 * among its alternatives.
 */
int case_item_has(const case_item *item, const char *key);

/*
 * Check that a YAML mapping whose key `type` has the value `word` has the keys that this type
 * permits and requires.
 *   cases in  permitted combinations of keys, one for each word of `type`; the one for `word`
 *       contains the item "type=word"
 * Returns 0, or -1 after writing an error message about the scene file.
 */
int check_type_case(reader *reader, int node, const form_case *cases, const char *word);

/*
 * Return the form (number, formula, word, list, ...) of the values that a key of the scene file
 * takes: the form in the row of the table of keys, or, if the row names none, the form that the
 * read function of the row accepts.
 */
form field_form(const field *field);

/* Description (form) of a complete scene, which is a mapping (scene_read.c). */
extern const form scene_form;

/*
 * Read a YAML mapping into the C struct at `to`: unknown keys are rejected, the values are read in
 * the order of the table `fields`, and missing required keys are reported. Returns 0, or -1 after
 * writing an error message about the scene file.
 */
int read_map(reader *reader, int node, const field *fields, void *to);

field_read read_real;     /* function that reads a number into a double; argument `rule`: permitted
                             range, or NULL */
field_read read_int;      /* function that reads an integer number into an int; argument `rule`:
                             permitted range */
field_read read_pair;     /* function that reads a list of two numbers into a double[2]; argument
                             `rule`: permitted range of both, or NULL */
field_read read_int_pair; /* function that reads a list of two integer numbers into an int[2];
                             argument `rule`: permitted range of both */
field_read read_name;     /* function that reads a name into a char[SCENE_NAME] */
field_read read_text;     /* function that reads a text into an allocated char * */
field_read read_choice;   /* function that reads a word into an int; argument `rule`: array of the
                             permitted words with their values */
field_read read_flag; /* function that reads one of the words true, false, on, off, yes and no into
                         a bool */
field_read read_either; /* function that reads one of two words into a bool; argument `rule`: array
                           of both words with the values 1 (true) and 0 (false) */
field_read read_expr;   /* function that reads a formula into an allocated expr *; argument `rule`:
                           permitted range of a constant formula, or NULL */

/*
 * Functions that store the index of the YAML node of a value in an int, so that the value can be
 * read later. read_scalar_node refuses lists and mappings.
 */
field_read read_node, read_scalar_node;

/*
 * Descriptions of values (struct form) that keys of several sections accept, such as a positive
 * number.
 */
extern const form number_form, above_zero_form, not_negative_form, formula_form, name_form,
    label_form, labels_form, triple_form, flag_form;

/*
 * Check the kind of a YAML node: scalar, list or mapping, as `kind` demands. Returns 0, or -1 after
 * writing an error message about the scene file.
 */
int require_kind(reader *reader, int node, tree_kind kind);

/*
 * Allocate zeroed items of `size` bytes, one for each child of a YAML list or mapping. Returns NULL
 * after writing an error message about the scene file if the node is of another kind or has too
 * many children; *count is 0 for an empty node.
 */
void *new_items(reader *reader, int node, tree_kind kind, size_t size, int *count);

/*
 * Function that reads a YAML node into one zeroed item of a list. Returns 0, or -1 after writing an
 * error message about the scene file.
 */
typedef int item_read(reader *reader, int node, void *item);

/*
 * Read the children of a YAML list or mapping, in order, into an array that new_items has allocated
 * for them.
 *   items  in   items of `size` bytes; NULL where new_items has failed
 *   begun  out  number of items that are read or being read; may be NULL
 * Returns 0, or -1 where `items` is NULL or an item cannot be read.
 */
int read_items(reader *reader, int node, void *items, size_t size, item_read *read, int *begun);

/*
 * Read a name from a YAML node, and find the index of the item with this name in an array whose
 * items begin with their names.
 *   missing in  format of the error message where no item has the name; %s is the name
 * Returns 0, or -1 after writing an error message about the scene file.
 */
int read_index(reader *reader, int node, const void *items, int count, size_t size,
               const char *missing, int *index);

int check_name(reader *reader, const char *name, scene_at at, char *to);

#endif
