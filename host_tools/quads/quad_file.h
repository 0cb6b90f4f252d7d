/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A mesh file in memory, a reading position in it, and messages that name the place of a fault: the
 * line of a text file, the byte of a binary one.
 */
#ifndef QUAD_FILE_H
#define QUAD_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Size in bytes of an error message including the terminating NUL. */
enum { QUAD_ERROR = 300 };

typedef struct quad_file {
    const char *path;
    char *text; /* [bytes + 1] contents, followed by a NUL */
    size_t bytes;
    size_t at;      /* reading position, 0 to bytes */
    bool is_binary; /* numbers are binary, and faults are placed by byte */
    char *error;    /* buffer of the error message [QUAD_ERROR] */
} quad_file;

/*
 * Read a regular file. The first bytes are examined before the rest is read: a file that is neither
 * Gmsh's MSH nor Abaqus' INP is refused whatever its size. Returns 0, or -1 with error filled.
 *   error [QUAD_ERROR] out
 */
int quad_file_open(quad_file *file, const char *path, char *error);
void quad_file_close(quad_file *file);

/* Write the message "path:line: ..." or "path: byte n: ..." for the place `at`. Both return -1. */
int quad_fault(const quad_file *file, const char *format, ...);
int quad_fault_at(const quad_file *file, size_t at, const char *format, ...);

/* FNV-1a hash of the contents. */
uint32_t quad_file_hash(const quad_file *file);

/* ---- text -------------------------------------------------------------- */

/* Skip blanks, tabs and line ends. */
void quad_skip(quad_file *file);

/* Go to the start of the next line. Returns whether there is one. */
bool quad_next_line(quad_file *file);

/*
 * Whether the text at the reading position is `word`, ended by a blank, a line end or the end of
 * the file; the reading position then moves behind it.
 */
bool quad_take_word(quad_file *file, const char *word);

/* ---- numbers ----------------------------------------------------------- */

/*
 * Read numbers, in text or in binary form. `what` names a number in the message of a fault. The
 * binary forms are a 4-byte int, an 8-byte unsigned size and an 8-byte double; a text real may be
 * any finite number. Each returns 0, or -1 with error filled.
 */
int quad_read_int(quad_file *file, const char *what, int *value);
int quad_read_size(quad_file *file, const char *what, int64_t *value);
int quad_read_real(quad_file *file, const char *what, double *value);

/* Refuse a count of items of at least `bytes` each that the rest of the file cannot hold. */
int quad_check_count(const quad_file *file, const char *what, int64_t count, size_t bytes);

#endif
