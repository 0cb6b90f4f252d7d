/* SPDX-License-Identifier: BSD-2-Clause */
/* Output of JSON: objects, arrays, numbers and strings, with the separating commas. */
#ifndef JSON_H
#define JSON_H

#include <stdio.h>

typedef struct json {
    FILE *file;
    int depth;
    int line;       /* depth of the outermost container that is written on one line; 0: none */
    int filled[48]; /* whether an element was already written at each nesting depth */
} json;

/*
 * Write brackets, members and elements. key is the name of a member, NULL inside arrays. A number
 * that is not finite is written as null.
 */
void json_open(json *json, const char *key, char bracket);
void json_open_line(json *json, const char *key, char bracket); /* all of it on one line */
void json_close(json *json, char bracket);
void json_number(json *json, const char *key, double value);
void json_bool(json *json, const char *key, int is_true);
void json_string(json *json, const char *key, const char *text);
void json_numbers(json *json, const char *key, const double *value, int count);

#endif
