/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Output of named arrays as .npz and as CSV files (named_array.h). An .npz file is a ZIP archive
 * (zip_archive.h) with one .npy file for each array.
 */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include "named_array.h"
#include "zip_archive.h"

enum {
    NPY_HEADER = 128, /* size of the header of a .npy file, a multiple of 64 (bytes) */
    NPY_VERSION = 10, /* offset, in the header of a .npy file, of the text that describes the array
                         (bytes) */
    TEXT = 96         /* size of each text in the array `units` (bytes) */
};

/* ---- members ---------------------------------------------------------- */

/*
 * Write the header of a .npy file of version 1.
 *   header   [NPY_HEADER] out  text of the header
 *   type     in  type of the numbers, such as '<f8'
 *   columns  in  0 for a vector
 */
static void npy_header(char *header, const char *type, size_t rows, size_t columns)
{
    char shape[64];
    if (columns > 0)
        snprintf(shape, sizeof shape, "(%lu, %lu)", (unsigned long)rows, (unsigned long)columns);
    else
        snprintf(shape, sizeof shape, "(%lu,)", (unsigned long)rows);
    memset(header, ' ', NPY_HEADER);
    memcpy(header, "\x93NUMPY\x01\x00", 8);
    header[8] = (char)(NPY_HEADER - NPY_VERSION);
    header[9] = 0;
    const int length =
        snprintf(header + NPY_VERSION, NPY_HEADER - NPY_VERSION,
                 "{'descr': '%s', 'fortran_order': False, 'shape': %s, }", type, shape);
    header[NPY_VERSION + length] = ' ';
    header[NPY_HEADER - 1] = '\n';
}

/* Write one .npy file as a member of the archive. Returns 0, or -1 if the archive is full. */
static int put_npy(zip_archive *archive, const char *name, const char *header, const void *data,
                   size_t bytes)
{
    char file[NAMED_ARRAY_NAME + 8];
    const zip_part part[] = {{header, NPY_HEADER}, {data, bytes}};
    snprintf(file, sizeof file, "%s.npy", name);
    return zip_add(archive, file, part, 2);
}

static bool is_big_endian(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 0;
}

static int put_array(zip_archive *archive, const named_array *array)
{
    char header[NPY_HEADER];
    const size_t columns = array->columns > 0 ? array->columns : 1;
    npy_header(header, is_big_endian() ? ">f8" : "<f8", array->rows, array->columns);
    return put_npy(archive, array->name, header, array->value,
                   array->rows * columns * sizeof *array->value);
}

/*
 * Write the array `units` of an .npz file: texts "NAME: UNIT" with the unit of each array. Returns
 * 0, or -1 if memory runs out or the archive is full.
 */
static int put_units(zip_archive *archive, const named_array *array, size_t count)
{
    char header[NPY_HEADER], type[16];
    char(*text)[TEXT] = calloc(count + 1, sizeof *text);
    if (!text)
        return -1;
    for (size_t k = 0; k < count; k++)
        snprintf(text[k], sizeof *text, "%s: %.24s", array[k].name, array[k].unit);
    snprintf(type, sizeof type, "|S%d", TEXT);
    npy_header(header, type, count, 0);
    const int failed = put_npy(archive, "units", header, text, count * sizeof *text);
    free(text);
    return failed;
}

int named_array_npz(FILE *file, const named_array *array, size_t count)
{
    zip_archive *archive = malloc(sizeof *archive);
    int failed = !archive || count > NAMED_ARRAY_MOST;
    if (!failed)
        zip_begin(archive, file);
    for (size_t k = 0; k < count && !failed; k++)
        failed = put_array(archive, &array[k]) < 0;
    failed = failed || put_units(archive, array, count) < 0;
    failed = failed || zip_end(archive) < 0;
    free(archive);
    return failed ? -1 : 0;
}

/* ---- CSV -------------------------------------------------------------- */

int named_array_csv(FILE *file, const named_array *array)
{
    const size_t columns = array->columns > 0 ? array->columns : 1;
    if (array->head)
        fputs(array->head, file);
    for (size_t k = 0; k < columns && !array->head; k++) {
        fprintf(file, "%s%s", k ? "," : "", array->name);
        if (columns > 1)
            fprintf(file, "_%lu", (unsigned long)k + 1);
        if (*array->unit)
            fprintf(file, " (%s)", array->unit);
    }
    fputc('\n', file);
    for (size_t i = 0; i < array->rows; i++)
        for (size_t k = 0; k < columns; k++)
            fprintf(file, "%.17g%c", array->value[i * columns + k], k + 1 < columns ? ',' : '\n');
    return ferror(file) ? -1 : 0;
}
