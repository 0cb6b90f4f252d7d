/* SPDX-License-Identifier: BSD-2-Clause */
/* Reading of tables of numbers from files of several formats (number_table.h). */
#include "number_table.h"
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char npy_magic[] = "\x93NUMPY", fits_magic[] = "SIMPLE  =", gzip_magic[] = "\x1f\x8b";

/* Write an error message that begins with the name of the file of a table. Returns -1. */
static int fault(const char *path, const char *message, char *error)
{
    const char *separator = *message >= '0' && *message <= '9' ? ":" : ": ";
    const char *slash = strrchr(path, '/');
    snprintf(error, NUMBER_ERROR, "%.60s%s%.170s", slash ? slash + 1 : path, separator, message);
    return -1;
}

/*
 * Read a whole file of at most NUMBER_BYTES bytes, whose size is checked first. Returns its bytes
 * followed by a NUL, to be released with free, or NULL with error filled.
 */
static char *read_bytes(const char *path, size_t *count, char *error)
{
    char message[NUMBER_ERROR];
    FILE *file = fopen(path, "rb");
    /*
     * Reading a first byte refuses folders, which can be opened like files but have no meaningful
     * size.
     */
    const bool is_readable = file && (fgetc(file) != EOF || !ferror(file));
    long size = -1;
    if (is_readable && fseek(file, 0, SEEK_END) == 0)
        size = ftell(file);
    if (size < 0) {
        snprintf(message, sizeof message, "cannot read it: %s; correct the name of the file",
                 strerror(errno));
        fault(path, message, error);
    } else if (size > NUMBER_BYTES) {
        snprintf(message, sizeof message,
                 "it has %.1f MB; a table of at most %d MB is read, give the file of the numbers",
                 (double)size / (1 << 20), NUMBER_BYTES >> 20);
        fault(path, message, error);
        size = -1;
    }
    char *bytes = size >= 0 ? malloc((size_t)size + 1) : NULL;
    *count = (size_t)size;
    if (size >= 0 &&
        (!bytes || fseek(file, 0, SEEK_SET) != 0 || fread(bytes, 1, *count, file) != *count)) {
        fault(path, "cannot read it", error);
        free(bytes);
        bytes = NULL;
    }
    if (bytes)
        bytes[*count] = '\0';
    if (file)
        fclose(file);
    return bytes;
}

static uint32_t hash_of(const char *bytes, size_t count)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ (unsigned char)bytes[i]) * 16777619u;
    return hash;
}

static int read_format(number_table *table, const char *path, const char *bytes, size_t count,
                       char *message)
{
    if (count == 0) {
        snprintf(message, NUMBER_ERROR, "the file is empty; write a table of numbers");
        return -1;
    }
    if (count >= sizeof npy_magic - 1 && memcmp(bytes, npy_magic, sizeof npy_magic - 1) == 0)
        return table_npy_read(table, bytes, count, message);
    if (count >= sizeof fits_magic - 1 && memcmp(bytes, fits_magic, sizeof fits_magic - 1) == 0)
        return table_fits_read(table, path, message);
    if (count >= sizeof gzip_magic - 1 && memcmp(bytes, gzip_magic, sizeof gzip_magic - 1) == 0) {
        if (strstr(path, ".fit"))
            return table_fits_read(table, path, message);
        snprintf(message, NUMBER_ERROR, "the file is packed by gzip; unpack it with gunzip");
        return -1;
    }
    if (count >= 3 && bytes[0] == 'P' && (bytes[1] == '2' || bytes[1] == '5') &&
        strchr(" \t\r\n#", bytes[2]))
        return table_pgm_read(table, bytes, count, message);
    if (count >= 2 && bytes[0] == 'P' && bytes[1] == 'K') {
        snprintf(message, NUMBER_ERROR,
                 "this is a ZIP or .npz archive; save one array alone, with numpy.save");
        return -1;
    }
    if (count >= 2 && (memcmp(bytes, "\xff\xfe", 2) == 0 || memcmp(bytes, "\xfe\xff", 2) == 0)) {
        snprintf(message, NUMBER_ERROR, "this is text in UTF-16; save it as UTF-8");
        return -1;
    }
    return table_text_read(table, bytes, count, message);
}

int number_table_read(number_table *table, const char *path, char *error)
{
    size_t count = 0;
    char message[NUMBER_ERROR];
    memset(table, 0, sizeof *table);
    char *bytes = read_bytes(path, &count, error);
    if (!bytes)
        return -1;
    const int failed = read_format(table, path, bytes, count, message);
    if (failed) {
        number_table_free(table);
        fault(path, message, error);
    } else {
        table->hash = hash_of(bytes, count);
    }
    free(bytes);
    return failed;
}

int number_table_check(const number_table *table, const char *path, char *error)
{
    for (size_t i = 0; i < table->rows * table->columns; i++) {
        char place[NUMBER_NAME], message[NUMBER_ERROR];
        if (!isfinite(table->value[i]) || fabs(table->value[i]) <= NUMBER_LARGEST)
            continue;
        number_table_place(table, i / table->columns, i % table->columns, place);
        snprintf(message, sizeof message,
                 "%s holds %.4g, and numbers go up to %g; the file is damaged, or its numbers have "
                 "another byte order",
                 place, table->value[i], NUMBER_LARGEST);
        return fault(path, message, error);
    }
    return 0;
}

void number_table_free(number_table *table)
{
    free(table->value);
    free(table->column_name);
    free(table->row_name);
    free(table->line);
    memset(table, 0, sizeof *table);
}

int number_table_is_named(const char *column, const char *name)
{
    const size_t length = strlen(name);
    if (strncmp(column, name, length) != 0)
        return 0;
    const char *rest = column + length;
    const bool is_unit = *rest == '[' || *rest == '(' || *rest == ' ';
    rest += strspn(rest, " ");
    return *rest == '\0' || (is_unit && (*rest == '[' || *rest == '('));
}

int number_table_column(const number_table *table, const char *name)
{
    char *end;
    for (size_t k = 0; table->column_name && k < table->columns; k++)
        if (number_table_is_named(table->column_name[k], name))
            return (int)k;
    const long number = strtol(name, &end, 10);
    const bool is_number = end > name && *end == '\0';
    return is_number && number >= 1 && number <= (long)table->columns ? (int)number - 1 : -1;
}

void number_table_place(const number_table *table, size_t row, size_t column, char *text)
{
    const unsigned long where = table->line ? table->line[row] : (unsigned long)row + 1;
    snprintf(text, NUMBER_NAME, "%s %lu, column %lu", table->line ? "line" : "row", where,
             (unsigned long)column + 1);
}
