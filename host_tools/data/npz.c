/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Output of named arrays as .npz and as CSV files (named_array.h). An .npz file is a ZIP archive
 * whose members are stored without compression; each has a CRC-32 checksum.
 */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include "named_array.h"
#include "../../lib/core/guard.h"

enum {
    NPY_HEADER = 128, /* size of the header of a .npy file, a multiple of 64 (bytes) */
    NPY_VERSION = 10, /* offset of the text in the header of a .npy file (bytes) */
    TEXT = 96         /* size of each text in the array `units` (bytes) */
};

/*
 * Member of the ZIP archive: what its own header and the directory at the end of the archive state.
 */
typedef struct member {
    char name[NAMED_ARRAY_NAME + 8];
    uint32_t crc, bytes, offset;
} member;

typedef struct archive {
    FILE *file;
    member member[NAMED_ARRAY_MOST + 1];
    size_t members;
    uint64_t offset; /* number of bytes of the archive written so far */
} archive;

/* ---- bytes ------------------------------------------------------------ */

static void put_bytes(archive *archive, const void *bytes, size_t count)
{
    fwrite(bytes, 1, count, archive->file);
    archive->offset += count;
}

/* Write an integer of 2 or 4 bytes, least significant byte first. */
static void put_number(archive *archive, uint32_t number, int bytes)
{
    unsigned char text[4];
    for (int i = 0; i < bytes; i++)
        text[i] = (unsigned char)(number >> 8 * i);
    put_bytes(archive, text, (size_t)bytes);
}

/*
 * Write the fields of a member that its own header and the directory of the archive have in common.
 */
static void put_member(archive *archive, const member *member)
{
    put_number(archive, 20, 2); /* version of the ZIP format that is needed to read the member */
    put_number(archive, 0, 2);  /* flags of the archive's member: none */
    put_number(archive, 0, 2);  /* compression method of the member: none */
    put_number(archive, 0, 2);  /* modification time of the member: midnight */
    put_number(archive, 33, 2); /* modification date: 1 January 1980, so that equal arrays give
                                   equal files */
    put_number(archive, member->crc, 4);
    put_number(archive, member->bytes, 4);
    put_number(archive, member->bytes, 4);
    put_number(archive, (uint32_t)strlen(member->name), 2);
    put_number(archive, 0, 2); /* length of the member's extra field: 0 bytes */
}

/* ---- members ---------------------------------------------------------- */

/*
 * Write the header of a .npy file of version 1.
 *   header   [NPY_HEADER] out
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
static int put_npy(archive *archive, const char *name, const char *header, const void *data,
                   size_t bytes)
{
    member *member = &archive->member[archive->members];
    const uint64_t all = (uint64_t)bytes + NPY_HEADER;
    if (archive->members > NAMED_ARRAY_MOST || archive->offset + all > UINT32_MAX - (1u << 20))
        return -1;
    snprintf(member->name, sizeof member->name, "%s.npy", name);
    member->crc = pzs_guard_crc(GUARD_CRC_START, header, NPY_HEADER);
    member->crc = ~pzs_guard_crc(member->crc, data, bytes);
    member->bytes = (uint32_t)all;
    member->offset = (uint32_t)archive->offset;
    archive->members++;
    put_bytes(archive, "PK\3\4", 4);
    put_member(archive, member);
    put_bytes(archive, member->name, strlen(member->name));
    put_bytes(archive, header, NPY_HEADER);
    put_bytes(archive, data, bytes);
    return 0;
}

static bool is_big_endian(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 0;
}

static int put_array(archive *archive, const named_array *array)
{
    char header[NPY_HEADER];
    const size_t columns = array->columns > 0 ? array->columns : 1;
    npy_header(header, is_big_endian() ? ">f8" : "<f8", array->rows, array->columns);
    return put_npy(archive, array->name, header, array->value,
                   array->rows * columns * sizeof *array->value);
}

/*
 * Write the array `units`, a list of texts "NAME: UNIT". Returns 0, or -1 if memory runs out or the
 * archive is full.
 */
static int put_units(archive *archive, const named_array *array, size_t count)
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

/* Write the directory at the end of the ZIP archive. */
static void put_directory(archive *archive)
{
    const uint32_t begin = (uint32_t)archive->offset;
    for (size_t k = 0; k < archive->members; k++) {
        const member *member = &archive->member[k];
        put_bytes(archive, "PK\1\2", 4);
        put_number(archive, 20, 2); /* version of the ZIP format that the writer of the archive uses
                                     */
        put_member(archive, member);
        put_number(archive, 0, 2); /* length of the member's comment: 0 bytes */
        put_number(archive, 0, 4); /* number of the disk on which the member starts, and internal
                                      attributes of the member */
        put_number(archive, 0, 4); /* external attributes of the member */
        put_number(archive, member->offset, 4);
        put_bytes(archive, member->name, strlen(member->name));
    }
    const uint32_t end = (uint32_t)archive->offset;
    put_bytes(archive, "PK\5\6", 4);
    put_number(archive, 0, 4); /* numbers of this disk and of the disk on which the archive's
                                  directory starts */
    put_number(archive, (uint32_t)archive->members, 2);
    put_number(archive, (uint32_t)archive->members, 2);
    put_number(archive, end - begin, 4);
    put_number(archive, begin, 4);
    put_number(archive, 0, 2); /* length of the ZIP archive's comment: 0 bytes */
}

int named_array_npz(FILE *file, const named_array *array, size_t count)
{
    archive *archive = calloc(1, sizeof *archive);
    int failed = !archive || count > NAMED_ARRAY_MOST;
    if (!failed)
        archive->file = file;
    for (size_t k = 0; k < count && !failed; k++)
        failed = put_array(archive, &array[k]) < 0;
    failed = failed || put_units(archive, array, count) < 0;
    if (!failed)
        put_directory(archive);
    free(archive);
    return failed || ferror(file) ? -1 : 0;
}

/* ---- CSV -------------------------------------------------------------- */

int named_array_csv(FILE *file, const named_array *array)
{
    const size_t columns = array->columns > 0 ? array->columns : 1;
    for (size_t k = 0; k < columns; k++) {
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
