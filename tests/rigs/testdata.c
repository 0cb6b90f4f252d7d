/* SPDX-License-Identifier: BSD-2-Clause */
#include "testdata.h"
#include <stdlib.h>
#include <string.h>

static void give_up(const char *what, const char *name)
{
    fprintf(stderr, "test data: %s in %s\n", what, name);
    abort();
}

/* Next token that is not in a comment line. */
static int token(FILE *file, char text[64])
{
    while (fscanf(file, "%63s", text) == 1) {
        if (text[0] != '#')
            return 1;
        for (int c = fgetc(file); c != '\n' && c != EOF;)
            c = fgetc(file);
    }
    return 0;
}

static void read_array(FILE *file, testdata *d)
{
    testdata_array *a = &d->array[d->arrays++];
    if (d->arrays > 32 || fscanf(file, "%31s %d %d", a->key, &a->rows, &a->columns) != 3)
        give_up("an array's head", d->name);
    const size_t n = (size_t)a->rows * (size_t)a->columns;
    a->value = calloc(n + 1, sizeof *a->value);
    for (size_t i = 0; i < n; i++)
        if (!a->value || fscanf(file, "%lf", &a->value[i]) != 1)
            give_up(a->key, d->name);
}

int testdata_next(FILE *file, testdata *d)
{
    char text[64];
    memset(d, 0, sizeof *d);
    if (!token(file, text))
        return 0;
    if (strcmp(text, "case") != 0 || !token(file, d->name))
        give_up("no case", text);
    for (long here = ftell(file); token(file, text); here = ftell(file)) {
        if (strcmp(text, "case") == 0) {
            fseek(file, here, SEEK_SET);
            break;
        }
        if (strcmp(text, "array") == 0)
            read_array(file, d);
        else if (strcmp(text, "word") == 0 && d->words < 16 && token(file, d->key[d->words]) &&
                 token(file, d->word[d->words]))
            d->words++;
        else
            give_up(text, d->name);
    }
    return 1;
}

void testdata_free(testdata *d)
{
    for (int i = 0; i < d->arrays; i++)
        free(d->array[i].value);
    d->arrays = 0;
}

const testdata_array *testdata_find(const testdata *d, const char *key)
{
    for (int i = 0; i < d->arrays; i++)
        if (strcmp(d->array[i].key, key) == 0)
            return &d->array[i];
    return NULL;
}

const double *testdata_values(const testdata *d, const char *key)
{
    const testdata_array *a = testdata_find(d, key);
    if (!a)
        give_up(key, d->name);
    return a->value;
}

const char *testdata_word(const testdata *d, const char *key)
{
    for (int i = 0; i < d->words; i++)
        if (strcmp(d->key[i], key) == 0)
            return d->word[i];
    give_up(key, d->name);
    return NULL;
}
