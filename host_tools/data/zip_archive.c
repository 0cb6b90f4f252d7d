/* SPDX-License-Identifier: BSD-2-Clause */
/* Writer of ZIP archives without compression (zip_archive.h). */
#include "zip_archive.h"
#include <string.h>
#include "../../lib/core/guard.h"

/* ---- bytes ------------------------------------------------------------ */

static void put_bytes(zip_archive *archive, const void *bytes, size_t count)
{
    fwrite(bytes, 1, count, archive->file);
    archive->offset += count;
}

/* Write an integer of 2 or 4 bytes, least significant byte first. */
static void put_number(zip_archive *archive, uint32_t number, int bytes)
{
    unsigned char text[4];
    for (int i = 0; i < bytes; i++)
        text[i] = (unsigned char)(number >> 8 * i);
    put_bytes(archive, text, (size_t)bytes);
}

/*
 * Write the fields that occur both in the header of an archive member and in the entry of the
 * member in the archive's directory.
 */
static void put_member(zip_archive *archive, const zip_member *member)
{
    put_number(archive, 20, 2); /* version of the ZIP format that is needed to read the archive's
                                   member */
    put_number(archive, 0, 2);  /* flags of the archive's member: none is set */
    put_number(archive, 0, 2);  /* compression method of the archive's member: stored without
                                   compression */
    put_number(archive, 0, 2);  /* modification time of the archive's member: midnight */
    put_number(archive, 33, 2); /* modification date: 1 January 1980, so that equal members give
                                   equal archives */
    put_number(archive, member->crc, 4);
    put_number(archive, member->bytes, 4);
    put_number(archive, member->bytes, 4);
    put_number(archive, (uint32_t)strlen(member->name), 2);
    put_number(archive, 0, 2); /* length of the extra field of the archive's member: 0 bytes */
}

/* ---- archive ---------------------------------------------------------- */

void zip_begin(zip_archive *archive, FILE *file)
{
    memset(archive, 0, sizeof *archive);
    archive->file = file;
}

int zip_add(zip_archive *archive, const char *name, const zip_part *part, size_t parts)
{
    uint64_t bytes = 0;
    uint32_t crc = GUARD_CRC_START;
    for (size_t i = 0; i < parts; i++) {
        bytes += part[i].bytes;
        crc = pzs_guard_crc(crc, part[i].data, part[i].bytes);
    }
    if (archive->members == ZIP_MOST || strlen(name) >= ZIP_NAME ||
        archive->offset + bytes > UINT32_MAX - (1u << 20))
        return -1;
    zip_member *member = &archive->member[archive->members++];
    memcpy(member->name, name, strlen(name) + 1);
    member->crc = ~crc;
    member->bytes = (uint32_t)bytes;
    member->offset = (uint32_t)archive->offset;
    put_bytes(archive, "PK\3\4", 4);
    put_member(archive, member);
    put_bytes(archive, member->name, strlen(member->name));
    for (size_t i = 0; i < parts; i++)
        put_bytes(archive, part[i].data, part[i].bytes);
    return 0;
}

/* Write the entry of a member in the directory of the ZIP archive. */
static void put_entry(zip_archive *archive, const zip_member *member)
{
    put_bytes(archive, "PK\1\2", 4);
    put_number(archive, 20, 2); /* version of the ZIP format with which the archive is written */
    put_member(archive, member);
    put_number(archive, 0, 2); /* length of the comment on the archive's member: 0 bytes */
    put_number(archive, 0, 4); /* number of the disk on which the archive's member starts, then the
                                  internal attributes of the member: all 0 */
    put_number(archive, 0, 4); /* external attributes of the archive's member: none is set */
    put_number(archive, member->offset, 4);
    put_bytes(archive, member->name, strlen(member->name));
}

int zip_end(zip_archive *archive)
{
    const uint32_t begin = (uint32_t)archive->offset;
    for (size_t k = 0; k < archive->members; k++)
        put_entry(archive, &archive->member[k]);
    const uint32_t end = (uint32_t)archive->offset;
    put_bytes(archive, "PK\5\6", 4);
    put_number(archive, 0, 4); /* numbers of this disk and of the disk on which the archive's
                                  directory starts: both 0 */
    put_number(archive, (uint32_t)archive->members, 2);
    put_number(archive, (uint32_t)archive->members, 2);
    put_number(archive, end - begin, 4);
    put_number(archive, begin, 4);
    put_number(archive, 0, 2); /* length of the ZIP archive's comment: 0 bytes */
    return ferror(archive->file) ? -1 : 0;
}
