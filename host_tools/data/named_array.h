/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Output of results as named arrays for other programs: one .npz file, or one CSV file for each
 * array.
 */
#ifndef NAMED_ARRAY_H
#define NAMED_ARRAY_H

#include <stddef.h>
#include <stdio.h>

enum { NAMED_ARRAY_NAME = 64, NAMED_ARRAY_MOST = 256 };

/* Named array of numbers: a matrix, or a vector if `columns` is 0. */
typedef struct named_array {
    char name[NAMED_ARRAY_NAME]; /* name of the array: letters, digits and underscores */
    const char *unit;            /* unit of the numbers; an empty text for dimensionless numbers */
    const char *head; /* names of the columns for a CSV file, separated by commas; NULL: those of
                         named_array_csv */
    size_t rows, columns;
    const double *value; /* [rows][columns] numbers of a matrix, or [rows] numbers of a vector */
} named_array;

/*
 * Write arrays as an .npz file, which numpy.load reads: a ZIP archive without compression with one
 * .npy file for each array, and an array `units` of texts "NAME: UNIT". Returns 0, or -1 if writing
 * fails, memory runs out, or the arrays exceed 4 GB.
 */
int named_array_npz(FILE *file, const named_array *array, size_t count);

/*
 * Write one array as CSV text with 17 significant digits. The first line holds the names of the
 * columns: `head`, otherwise name and unit of the array, and the number of the column, counted from
 * 1, if there are several. Returns 0, or -1 if writing fails.
 */
int named_array_csv(FILE *file, const named_array *array);

#endif
