/*
 * Reader of the text files in tests/oracle/data, with the entries `case NAME`, `word KEY VALUE` and
 * `array KEY ROWS COLS numbers`.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef TESTDATA_H
#define TESTDATA_H

#include <stdio.h>

typedef struct testdata_array {
    char key[32];
    int rows, columns;
    double *value;
} testdata_array;

typedef struct testdata {
    char name[64];
    char key[16][32], word[16][32];
    int words, arrays;
    testdata_array array[32];
} testdata;

/*
 * Read the next case. Returns 1, or 0 at the end of the file; a format error aborts the test
 * program.
 */
int testdata_next(FILE *file, testdata *data);
void testdata_free(testdata *data);

/* Return the numbers under a key, or NULL if the case has none. */
const testdata_array *testdata_find(const testdata *data, const char *key);
const double *testdata_values(const testdata *data, const char *key);
const char *testdata_word(const testdata *data, const char *key);

#endif
