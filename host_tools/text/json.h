/* SPDX-License-Identifier: BSD-2-Clause */
/* JSON output: objects, arrays, numbers and strings, commas in the right places. */
#ifndef JSON_H
#define JSON_H

#include <stdio.h>

typedef struct json {
    FILE *file;
    int depth;
    int filled[16]; /* something was already written at this depth */
} json;

/* key is NULL inside arrays. A number that is not finite is written as null. */
void json_open(json *json, const char *key, char bracket);
void json_close(json *json, char bracket);
void json_number(json *json, const char *key, double value);
void json_bool(json *json, const char *key, int is_true);
void json_string(json *json, const char *key, const char *text);
void json_numbers(json *json, const char *key, const double *value, int count);

#endif
