/* SPDX-License-Identifier: BSD-2-Clause */
/* Results as named arrays, written for other programs: one .npz file, or a CSV file for each. */
#ifndef NAMED_ARRAY_H
#define NAMED_ARRAY_H

#include <stddef.h>
#include <stdio.h>

enum { NAMED_ARRAY_NAME = 64, NAMED_ARRAY_MOST = 64 };

/* A matrix of numbers, or a vector where `columns` is 0. */
typedef struct named_array {
    char name[NAMED_ARRAY_NAME]; /* identifier */
    const char *unit;            /* unit of the numbers; "" for pure numbers */
    size_t rows, columns;
    const double *value; /* [rows][columns], or [rows] */
} named_array;

/*
 * Write arrays as an .npz file, which numpy.load reads: a ZIP archive without compression that
 * holds a .npy file for each array, and `units`, a list of texts "NAME: UNIT" in the order of the
 * arrays. Returns 0, or -1 where writing fails, memory runs out, or the arrays exceed 4 GB.
 */
int named_array_npz(FILE *file, const named_array *array, size_t count);

/*
 * Write one array as text, with 17 significant digits and a first line of column names: the name of
 * the array and its unit, with the number of the column from 1 where there are several. Returns 0,
 * or -1 where writing fails.
 */
int named_array_csv(FILE *file, const named_array *array);

#endif
