/* SPDX-License-Identifier: BSD-2-Clause */
/* Output of JSON documents (json.h). */
#include "json.h"
#include <math.h>
#include <stdlib.h>

static void quoted(FILE *file, const char *text)
{
    fputc('"', file);
    for (; *text; text++) {
        const unsigned char character = (unsigned char)*text;
        if (character == '"' || character == '\\')
            fprintf(file, "\\%c", character);
        else if (character < 32)
            fprintf(file, "\\u%04x", character);
        else
            fputc(character, file);
    }
    fputc('"', file);
}

static void begin(json *json, const char *key)
{
    if (json->filled[json->depth]++)
        fputc(',', json->file);
    if (json->line && json->filled[json->depth] > 1)
        fputc(' ', json->file);
    if (json->depth > 0 && !json->line)
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

void json_open_line(json *json, const char *key, char bracket)
{
    json_open(json, key, bracket);
    if (!json->line)
        json->line = json->depth;
}

void json_close(json *json, char bracket)
{
    const int is_on_line = json->line != 0;
    if (json->line == json->depth)
        json->line = 0;
    json->depth--;
    if (!is_on_line)
        fprintf(json->file, "\n%*s", 2 * json->depth, "");
    fputc(bracket, json->file);
    if (json->depth == 0)
        fputc('\n', json->file);
}

static void number(FILE *file, double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.15g", value);
    if (strtod(text, NULL) != value)
        snprintf(text, sizeof text, "%.17g", value);
    fputs(isfinite(value) ? text : "null", file);
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
