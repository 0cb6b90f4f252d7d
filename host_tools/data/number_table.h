/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A table of numbers that is read from a file. The first bytes determine the format:
 * - text with commas, semicolons, tabs or blanks; lines that begin with # and empty lines are
 *   skipped; the first line may name the columns, and the first column the rows;
 * - a NumPy array (.npy);
 * - an image in a FITS file;
 * - the grey values of a picture (.pgm), rows from top to bottom.
 */
#ifndef NUMBER_TABLE_H
#define NUMBER_TABLE_H

#include <stddef.h>
#include <stdint.h>

/*
 * Sizes: an error message (NUMBER_ERROR) and a name with its NUL (NUMBER_NAME) in bytes, largest
 * file in bytes (NUMBER_BYTES), and largest number of entries of a table (NUMBER_VALUES).
 */
enum { NUMBER_ERROR = 240, NUMBER_NAME = 64, NUMBER_BYTES = 64 << 20, NUMBER_VALUES = 1 << 23 };

/*
 * Largest magnitude of a measured number in a table, so that squares and products are finite; it is
 * also the largest magnitude of a number in a scene file.
 */
#define NUMBER_LARGEST 1e60

typedef char number_name[NUMBER_NAME];

typedef struct number_table {
    size_t rows, columns;
    double *value;            /* [rows][columns] numbers of the table, possibly NAN or infinite */
    number_name *column_name; /* [columns] names of the columns, or NULL if the file has no column
                                 names */
    number_name *row_name;    /* [rows] names of the rows, or NULL if the file has no row names */
    uint32_t *line; /* [rows] line of each row in a text file, counted from 1; NULL for binary files
                     */
    uint32_t hash;  /* FNV-1a hash of the bytes of the file from which the table was read */
} number_table;

/*
 * Read a table of numbers from a file.
 *   error  [NUMBER_ERROR] out  "FILE:LINE: what was found; what to do"
 * Returns 0, or -1 with error filled and the table empty.
 */
int number_table_read(number_table *table, const char *path, char *error);
void number_table_free(number_table *table);

/*
 * Check that no finite number of a table exceeds NUMBER_LARGEST, as the numbers of a file with
 * damaged bytes or another byte order do.
 *   path                 in   file of the table, for the message
 *   error [NUMBER_ERROR] out  message with the value of the number and its row and column in the
 *                             table
 * Returns 0, or -1 with error filled.
 */
int number_table_check(const number_table *table, const char *path, char *error);

/*
 * Return whether a column of a table has a name, with or without a unit in brackets after it: the
 * column "u3 [um]" is named u3.
 */
int number_table_is_named(const char *column, const char *name);

/*
 * Return the index of a column that is given by its name, or by its number counted from 1 if no
 * column has this name; -1 if there is no such column.
 */
int number_table_column(const number_table *table, const char *name);

/*
 * Write the position of an entry of a table in words, such as "line 3, column 2" (text
 * [NUMBER_NAME] out).
 */
void number_table_place(const number_table *table, size_t row, size_t column, char *text);

/* ---- formats ---------------------------------------------------------- */

/*
 * Functions that read a table from the bytes of a file in one format: text, NumPy (npy) or image
 * (pgm). The bytes are followed by a NUL.
 *   error [NUMBER_ERROR] out  error message: what was found, and what to do; in text files it
 *       begins with the number of the line, as "3: "
 * Each returns 0, or -1 with error filled. The caller releases the table in both cases.
 */
int table_text_read(number_table *table, const char *bytes, size_t count, char *error);
int table_npy_read(number_table *table, const char *bytes, size_t count, char *error);
int table_pgm_read(number_table *table, const char *bytes, size_t count, char *error);
/*
 * Read a table from an image in a FITS file. Without the library cfitsio every FITS file is
 * refused. Returns 0, or -1 with error filled.
 */
int table_fits_read(number_table *table, const char *path, char *error);

#endif
