/* SPDX-License-Identifier: BSD-2-Clause */
/* JSON output (json.h). */
#include "json.h"
#include <math.h>

static void quoted(FILE *file, const char *text)
{
    fputc('"', file);
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            fprintf(file, "\\%c", c);
        else if (c < 32)
            fprintf(file, "\\u%04x", c);
        else
            fputc(c, file);
    }
    fputc('"', file);
}

static void begin(json *json, const char *key)
{
    if (json->filled[json->depth]++)
        fputc(',', json->file);
    if (json->depth > 0)
        fprintf(json->file, "\n%*s", 2 * json->depth, "");
    if (key) {
        quoted(json->file, key);
        fputs(": ", json->file);
    }
}

void json_open(json *json, const char *key, char bracket)
{
    begin(json, key);
    fputc(bracket, json->file);
    json->filled[++json->depth] = 0;
}

void json_close(json *json, char bracket)
{
    json->depth--;
    fprintf(json->file, "\n%*s%c", 2 * json->depth, "", bracket);
    if (json->depth == 0)
        fputc('\n', json->file);
}

static void number(FILE *file, double value)
{
    if (isfinite(value))
        fprintf(file, "%.17g", value);
    else
        fputs("null", file);
}

void json_bool(json *json, const char *key, int is_true)
{
    begin(json, key);
    fputs(is_true ? "true" : "false", json->file);
}

void json_number(json *json, const char *key, double value)
{
    begin(json, key);
    number(json->file, value);
}

void json_string(json *json, const char *key, const char *text)
{
    begin(json, key);
    quoted(json->file, text);
}

void json_numbers(json *json, const char *key, const double *value, int count)
{
    begin(json, key);
    fputc('[', json->file);
    for (int i = 0; i < count; i++) {
        if (i)
            fputs(", ", json->file);
        number(json->file, value[i]);
    }
    fputc(']', json->file);
}
