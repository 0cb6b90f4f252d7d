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

static void begin(json *j, const char *key)
{
    if (j->filled[j->depth]++)
        fputc(',', j->file);
    if (j->depth > 0)
        fprintf(j->file, "\n%*s", 2 * j->depth, "");
    if (key) {
        quoted(j->file, key);
        fputs(": ", j->file);
    }
}

void json_open(json *j, const char *key, char bracket)
{
    begin(j, key);
    fputc(bracket, j->file);
    j->filled[++j->depth] = 0;
}

void json_close(json *j, char bracket)
{
    j->depth--;
    fprintf(j->file, "\n%*s%c", 2 * j->depth, "", bracket);
    if (j->depth == 0)
        fputc('\n', j->file);
}

static void number(FILE *file, double value)
{
    if (isfinite(value))
        fprintf(file, "%.17g", value);
    else
        fputs("null", file);
}

void json_bool(json *j, const char *key, int is_true)
{
    begin(j, key);
    fputs(is_true ? "true" : "false", j->file);
}

void json_number(json *j, const char *key, double value)
{
    begin(j, key);
    number(j->file, value);
}

void json_string(json *j, const char *key, const char *text)
{
    begin(j, key);
    quoted(j->file, text);
}

void json_numbers(json *j, const char *key, const double *value, int count)
{
    begin(j, key);
    fputc('[', j->file);
    for (int i = 0; i < count; i++) {
        if (i)
            fputs(", ", j->file);
        number(j->file, value[i]);
    }
    fputc(']', j->file);
}
