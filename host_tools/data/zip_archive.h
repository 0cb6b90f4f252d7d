/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Writer of ZIP archives whose members are stored without compression, each with its CRC-32
 * checksum. Archives with equal members are equal byte for byte, because their members carry a
 * fixed date.
 */
#ifndef ZIP_ARCHIVE_H
#define ZIP_ARCHIVE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { ZIP_NAME = 96, ZIP_MOST = 256 };

/*
 * Data about a member (file) of a ZIP archive, which are written before the contents of the member,
 * and again in the directory at the end of the archive.
 */
typedef struct zip_member {
    char name[ZIP_NAME]; /* path of the member inside the archive */
    uint32_t crc, bytes, offset;
} zip_member;

typedef struct zip_archive {
    FILE *file;
    zip_member member[ZIP_MOST];
    size_t members;
    uint64_t offset; /* number of bytes of the ZIP archive written so far */
} zip_archive;

/*
 * A block of memory. The contents of an archive member are one or several of these blocks, one
 * after the other.
 */
typedef struct zip_part {
    const void *data;
    size_t bytes;
} zip_part;

void zip_begin(zip_archive *archive, FILE *file);

/*
 * Write a member of a ZIP archive.
 *   name         in  path of the member inside the archive
 *   part [parts] in  blocks of memory that form the contents of the member, in their order
 * Returns 0, or -1 if the archive would exceed the largest number of members (ZIP_MOST) or 4 GB, or
 * if the name is too long.
 */
int zip_add(zip_archive *archive, const char *name, const zip_part *part, size_t parts);

/* Write the directory at the end of a ZIP archive. Returns 0, or -1 if a write has failed. */
int zip_end(zip_archive *archive);

#endif
