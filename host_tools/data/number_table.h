/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A table of numbers read from a file: text with commas, semicolons, tabs or blanks between the
 * numbers, a NumPy array (.npy), the image of a FITS file, or the grey values of a picture (.pgm),
 * whose rows run from top to bottom. The first bytes of the file tell its format.
 *
 * Text: lines that begin with # are comments, and empty lines are skipped. The first line may hold
 * the names of the columns, and the first column the names of the rows.
 */
#ifndef NUMBER_TABLE_H
#define NUMBER_TABLE_H

#include <stddef.h>
#include <stdint.h>

/*
 * Limits: bytes of an error message (NUMBER_ERROR), bytes of a name with its NUL (NUMBER_NAME),
 * bytes of a file (NUMBER_BYTES), numbers of a table (NUMBER_VALUES).
 */
enum { NUMBER_ERROR = 240, NUMBER_NAME = 64, NUMBER_BYTES = 64 << 20, NUMBER_VALUES = 1 << 23 };

typedef char number_name[NUMBER_NAME];

typedef struct number_table {
    size_t rows, columns;
    double *value;            /* [rows][columns], may contain NAN and infinities */
    number_name *column_name; /* [columns], or NULL where the file names none */
    number_name *row_name;    /* [rows], or NULL where the file names none */
    uint32_t *line;           /* [rows] line of the file, from 1; NULL for binary files */
    uint32_t hash;            /* FNV-1a hash of the bytes of the file */
} number_table;

/*
 * Read a table.
 *   error [NUMBER_ERROR] out  "FILE:LINE: what was found; what to do"
 * Returns 0, or -1 with error filled and the table empty.
 */
int number_table_read(number_table *table, const char *path, char *error);
void number_table_free(number_table *table);

/*
 * Index of a column by its name, or by its number from 1 where it has no such name; -1 where there
 * is none.
 */
int number_table_column(const number_table *table, const char *name);

/* Place of an entry in words, "line 3, column 2" or "row 3, column 2". text [NUMBER_NAME] out */
void number_table_place(const number_table *table, size_t row, size_t column, char *text);

/* ---- formats ---------------------------------------------------------- */

/*
 * Read a table from the bytes of a file; `bytes` is followed by a NUL. Each returns 0, or -1 with
 * error filled: what was found and what to do, after "LINE: " in text files. The caller releases
 * the table in either case.
 */
int table_text_read(number_table *table, const char *bytes, size_t count, char *error);
int table_npy_read(number_table *table, const char *bytes, size_t count, char *error);
int table_pgm_read(number_table *table, const char *bytes, size_t count, char *error);
/* Read a table from a FITS file; without the library cfitsio, every FITS file is refused. */
int table_fits_read(number_table *table, const char *path, char *error);

#endif
