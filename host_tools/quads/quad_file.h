/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A mesh file in memory with a reading position, and error messages that name the position of a
 * fault: the line of a text file, or the byte of a binary file.
 */
#ifndef QUAD_FILE_H
#define QUAD_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Size of an error message including the terminating NUL (bytes). */
enum { QUAD_ERROR = 300 };

typedef struct quad_file {
    const char *path;
    char *text; /* [bytes + 1] contents of the mesh file, followed by a NUL */
    size_t bytes;
    size_t at;      /* reading position in the mesh file, from 0 to `bytes` */
    bool is_binary; /* whether the numbers in the mesh file are binary; the position of a fault is
                       then given as a byte, otherwise as a line */
    char *error;    /* [QUAD_ERROR] memory of the error message about the mesh file */
} quad_file;

/*
 * Read a mesh file into memory. Its first bytes are examined before the rest is read, so that a
 * file that is neither Gmsh's MSH nor Abaqus' INP format is refused whatever its size.
 *   error  [QUAD_ERROR] out  message
 * Returns 0, or -1 with error filled.
 */
int quad_file_open(quad_file *file, const char *path, char *error);
void quad_file_close(quad_file *file);

/*
 * Write an error message "path:line: ..." or "path: byte n: ..." for the reading position
 * (quad_fault) or for byte number `at` (quad_fault_at). Both return -1.
 */
int quad_fault(const quad_file *file, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
int quad_fault_at(const quad_file *file, size_t at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Return the FNV-1a hash of the contents of a mesh file. */
uint32_t quad_file_hash(const quad_file *file);

/* ---- text -------------------------------------------------------------- */

/* Move the reading position of a mesh file past blanks, tabs and line ends. */
void quad_skip(quad_file *file);

/* Move the reading position to the start of the next line. Returns whether there is a next line. */
bool quad_next_line(quad_file *file);

/*
 * Return whether the text at the reading position is `word`, followed by a blank, a line end or the
 * end of the file; if so, the reading position moves past the word.
 */
bool quad_take_word(quad_file *file, const char *word);

/* ---- numbers ----------------------------------------------------------- */

/*
 * Read an integer, size or real number, in text or binary form (4-byte int, 8-byte unsigned size,
 * 8-byte double). In text a real number must be finite. `what` names it in messages. Each returns
 * 0, or -1 after writing an error message about the mesh file.
 */
int quad_read_int(quad_file *file, const char *what, int *value);
int quad_read_size(quad_file *file, const char *what, int64_t *value);
int quad_read_real(quad_file *file, const char *what, double *value);

/*
 * Check that the rest of the mesh file, from the reading position on, can hold `count` items of at
 * least `bytes` bytes each. Returns 0, or -1 after writing an error message about the mesh file.
 */
int quad_check_count(const quad_file *file, const char *what, int64_t count, size_t bytes);

#endif
