/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of NumPy arrays (number_table.h): versions 1, 2 and 3 of the .npy format, real numbers of
 * 1 to 8 bytes in both byte orders, C and Fortran order, one to three dimensions. An array of one
 * dimension becomes one column. One of three becomes a table with a row for each first index, in
 * which the last index runs fastest, as a cube of influence functions with one plane for each
 * actuator.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "number_table.h"

/* Contents of the header of a .npy file. */
typedef struct npy_header {
    char type; /* type of the numbers: 'f' floating point, 'i' signed integer, 'u' unsigned integer,
                  'b' boolean */
    size_t size;        /* size of a number in the .npy file (bytes) */
    bool is_big_endian; /* whether the most significant byte of a number comes first */
    bool is_fortran;    /* whether the first index of the array runs fastest in the file (Fortran
                           order) */
    int dimensions;     /* number of dimensions in the file, 1 to 3; the member `shape` has three
                           entries in any case, 1 where the file has no such dimension */
    size_t shape[3];
} npy_header;

static int fault(char *error, const char *message)
{
    snprintf(error, NUMBER_ERROR, "%s", message);
    return -1;
}

/* ---- header ----------------------------------------------------------- */

/*
 * Return the text after a key and its colon in the dictionary of a .npy header, or NULL if there is
 * no such key.
 */
static const char *value_of(const char *header, const char *key)
{
    const char *at = strstr(header, key);
    at = at ? strchr(at + strlen(key), ':') : NULL;
    if (!at)
        return NULL;
    at++;
    while (*at == ' ')
        at++;
    return at;
}

/* Read the type of the numbers from a text such as '<f8'. Returns 0, or -1 with error filled. */
static int read_type(npy_header *header, const char *text, char *error)
{
    static const char known[][3] = {"f4", "f8", "i1", "i2", "i4", "i8",
                                    "u1", "u2", "u4", "u8", "b1"};
    const char quote = text ? *text : '\0';
    if ((quote == '\'' || quote == '"') && strchr("<>|=", text[1]) && text[1])
        for (size_t k = 0; k < sizeof known / sizeof *known; k++)
            if (text[2] == known[k][0] && text[3] == known[k][1] && text[4] == quote) {
                header->type = text[2];
                header->size = (size_t)(text[3] - '0');
                header->is_big_endian = text[1] == '>';
                return 0;
            }
    const size_t named = quote == '\'' || quote == '"' ? strcspn(text + 1, "'\"") + 2 : 12;
    const int shown = named < 12 ? (int)named : 12;
    snprintf(error, NUMBER_ERROR,
             "its numbers are of type %.*s; save the array as float64, with astype(float)", shown,
             text ? text : "nothing");
    return -1;
}

/*
 * Read the shape of the array from a text such as (121, 25) or (121,). Returns 0, or -1 with error
 * filled.
 */
static int read_shape(npy_header *header, const char *text, char *error)
{
    header->shape[0] = header->shape[1] = header->shape[2] = 1;
    if (!text || *text != '(')
        return fault(error, "its header names no shape; save the array again");
    for (text++; *text && *text != ')';) {
        char *end;
        const unsigned long long length = strtoull(text, &end, 10);
        if (end == text || *text == '-')
            return fault(error, "the shape in its header is not a list of numbers; save it again");
        if (header->dimensions == 3)
            return fault(error, "it has more than three dimensions; save it with reshape(outputs, "
                                "actuators)");
        if (length == 0 || length > NUMBER_VALUES)
            return fault(error, "the shape in its header is empty or above 8 million numbers; "
                                "save a smaller array");
        header->shape[header->dimensions++] = (size_t)length;
        for (text = end; *text == ' ' || *text == ',';)
            text++;
    }
    return *text == ')' ? 0 : fault(error, "its header ends within the shape; save it again");
}

static int read_header(npy_header *header, const char *text, char *error)
{
    const char *order = value_of(text, "fortran_order");
    memset(header, 0, sizeof *header);
    if (read_type(header, value_of(text, "descr"), error) < 0 ||
        read_shape(header, value_of(text, "shape"), error) < 0)
        return -1;
    if (!order || (strncmp(order, "True", 4) != 0 && strncmp(order, "False", 5) != 0))
        return fault(error, "its header has no fortran_order; save the array again");
    header->is_fortran = *order == 'T' && header->dimensions > 1;
    return 0;
}

/* ---- numbers ---------------------------------------------------------- */

/*
 * Return the bits of a number as an integer, assembled from its bytes in the byte order of the
 * file.
 */
static uint64_t bits_of(const unsigned char *bytes, const npy_header *header)
{
    uint64_t bits = 0;
    for (size_t i = 0; i < header->size; i++)
        bits = bits << 8 | bytes[header->is_big_endian ? i : header->size - 1 - i];
    return bits;
}

static double number_of(const unsigned char *bytes, const npy_header *header)
{
    const uint64_t bits = bits_of(bytes, header);
    const uint32_t low = (uint32_t)bits;
    double real;
    float single;
    if (header->type == 'f' && header->size == 8) {
        memcpy(&real, &bits, sizeof real);
        return real;
    }
    if (header->type == 'f') {
        memcpy(&single, &low, sizeof single);
        return (double)single;
    }
    const uint64_t sign = (uint64_t)1 << (8 * header->size - 1);
    if (header->type != 'i' || !(bits & sign))
        return (double)bits;
    return -(double)((~bits & (sign - 1)) + 1);
}

static int read_numbers(number_table *table, const npy_header *header, const char *bytes,
                        size_t count, char *error)
{
    const size_t rows = header->shape[0], last = header->shape[2];
    const bool is_large = header->shape[1] > NUMBER_VALUES / last;
    const size_t columns = is_large ? NUMBER_VALUES : header->shape[1] * last;
    if (is_large || rows > NUMBER_VALUES / columns || rows * columns * header->size != count) {
        snprintf(error, NUMBER_ERROR,
                 "its header says %lu x %lu numbers of %lu bytes, but %lu bytes follow; the file "
                 "is cut or its header is wrong, save it again",
                 (unsigned long)rows, (unsigned long)columns, (unsigned long)header->size,
                 (unsigned long)count);
        return -1;
    }
    table->value = malloc(rows * columns * sizeof *table->value);
    if (!table->value)
        return fault(error, "out of memory");
    table->rows = rows;
    table->columns = columns;
    for (size_t i = 0; i < rows; i++)
        for (size_t k = 0; k < columns; k++) {
            const size_t turned = k % last * header->shape[1] + k / last;
            const size_t index = header->is_fortran ? turned * rows + i : i * columns + k;
            table->value[i * columns + k] =
                number_of((const unsigned char *)bytes + index * header->size, header);
        }
    return 0;
}

int table_npy_read(number_table *table, const char *bytes, size_t count, char *error)
{
    enum { HEADER = 4096 };
    const unsigned char *at = (const unsigned char *)bytes;
    char text[HEADER + 1];
    npy_header header;
    const int version = count > 8 ? at[6] : 0;
    const size_t first = version == 1 ? 10 : 12;
    if (version < 1 || version > 3 || count < first)
        return fault(error, "its header is of no known version of .npy, 1 to 3; save it again");
    size_t length = (size_t)at[8] | (size_t)at[9] << 8;
    if (version > 1)
        length |= (size_t)at[10] << 16 | (size_t)at[11] << 24;
    if (length > HEADER || length > count - first)
        return fault(error, "its header is longer than the file or 4096 bytes; save it again");
    memcpy(text, bytes + first, length);
    text[length] = '\0';
    if (read_header(&header, text, error) < 0)
        return -1;
    return read_numbers(table, &header, bytes + first + length, count - first - length, error);
}
