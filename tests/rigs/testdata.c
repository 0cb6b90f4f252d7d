/* SPDX-License-Identifier: BSD-2-Clause */
#include "testdata.h"
#include <stdlib.h>
#include <string.h>

static void give_up(const char *what, const char *name)
{
    fprintf(stderr, "test data: %s in %s\n", what, name);
    abort();
}

/* Read the next word that is not in a comment line. */
static int token(FILE *file, char text[64])
{
    while (fscanf(file, "%63s", text) == 1) {
        if (text[0] != '#')
            return 1;
        for (int character = fgetc(file); character != '\n' && character != EOF;)
            character = fgetc(file);
    }
    return 0;
}

static void read_array(FILE *file, testdata *data)
{
    testdata_array *array = &data->array[data->arrays++];
    if (data->arrays > 32 ||
        fscanf(file, "%31s %d %d", array->key, &array->rows, &array->columns) != 3)
        give_up("an array's head", data->name);
    const size_t count = (size_t)array->rows * (size_t)array->columns;
    array->value = calloc(count + 1, sizeof *array->value);
    for (size_t i = 0; i < count; i++)
        if (!array->value || fscanf(file, "%lf", &array->value[i]) != 1)
            give_up(array->key, data->name);
}

int testdata_next(FILE *file, testdata *data)
{
    char text[64];
    memset(data, 0, sizeof *data);
    if (!token(file, text))
        return 0;
    if (strcmp(text, "case") != 0 || !token(file, data->name))
        give_up("no case", text);
    for (long here = ftell(file); token(file, text); here = ftell(file)) {
        if (strcmp(text, "case") == 0) {
            fseek(file, here, SEEK_SET);
            break;
        }
        if (strcmp(text, "array") == 0)
            read_array(file, data);
        else if (strcmp(text, "word") == 0 && data->words < 16 &&
                 token(file, data->key[data->words]) && token(file, data->word[data->words]))
            data->words++;
        else
            give_up(text, data->name);
    }
    return 1;
}

void testdata_free(testdata *data)
{
    for (int i = 0; i < data->arrays; i++)
        free(data->array[i].value);
    data->arrays = 0;
}

const testdata_array *testdata_find(const testdata *data, const char *key)
{
    for (int i = 0; i < data->arrays; i++)
        if (strcmp(data->array[i].key, key) == 0)
            return &data->array[i];
    return NULL;
}

const double *testdata_values(const testdata *data, const char *key)
{
    const testdata_array *array = testdata_find(data, key);
    if (!array)
        give_up(key, data->name);
    return array->value;
}

const char *testdata_word(const testdata *data, const char *key)
{
    for (int i = 0; i < data->words; i++)
        if (strcmp(data->key[i], key) == 0)
            return data->word[i];
    give_up(key, data->name);
    return NULL;
}
