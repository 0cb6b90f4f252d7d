/* SPDX-License-Identifier: BSD-2-Clause */
/* Output of JSON documents: objects, arrays, numbers and strings, with the commas between them. */
#ifndef JSON_H
#define JSON_H

#include <stdio.h>

typedef struct json {
    FILE *file;
    int depth;
    int line; /* nesting depth of the outermost array or object that is written on one line; 0:
                 every one has several lines */
    int filled[48]; /* whether the open array or object at each nesting depth already has an element
                     */
} json;

/*
 * Write an opening or closing bracket, a member or an element of a JSON document. `key` is the name
 * of a member of an object, NULL for an element of an array. A number that is not finite is written
 * as null.
 */
void json_open(json *json, const char *key, char bracket);
void json_open_line(json *json, const char *key,
                    char bracket); /* Begin an array or object of a JSON document that is written on
                                      one line with all its contents. */
void json_close(json *json, char bracket);
void json_number(json *json, const char *key, double value);
void json_bool(json *json, const char *key, int is_true);
void json_string(json *json, const char *key, const char *text);
void json_numbers(json *json, const char *key, const double *value, int count);

#endif
