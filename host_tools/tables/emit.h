/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Writes arrays of numbers as C source for a firmware, and accumulates their size and their
 * checksum in single precision.
 */
#ifndef EMIT_H
#define EMIT_H

#include <stdint.h>
#include <stdio.h>

typedef struct emitter {
    FILE *file;
    const char *prefix;
    char upper[64]; /* first part of the names of all macros in the generated tables: the member
                       `prefix` in capital letters */
    uint32_t crc32; /* checksum of the data of the tables written so far, with reals rounded to
                       single precision */
    size_t reals, bytes; /* size of the data of the tables written so far: number of reals, and
                            bytes of other data */
} emitter;

/*
 * Write a number to a file in decimal, with enough digits that a program reads the same bits. This
 * function does not add the number to the checksum and the size in the emitter: for the array that
 * contains the number, call emit_count_reals or emit_count_bytes first.
 */
void emit_real(FILE *file, double value);
uint32_t emit_crc_reals(uint32_t crc, const double *value, size_t count);
void emit_count_reals(emitter *emitter, const double *value, size_t count);
void emit_count_bytes(emitter *emitter, const void *value, size_t bytes);

/*
 * Write a comment on one line. Where the text contains the two characters that begin or end a
 * comment, a blank is inserted between them, so that texts of a scene cannot end the comment.
 */
void emit_comment(const emitter *emitter, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Begin and end a comment of several lines, which emit_comment_lines writes. */
void emit_comment_begin(const emitter *emitter);
void emit_comment_end(const emitter *emitter);

/*
 * Write the lines of a text into a comment of several lines; an empty text gives no line. Where the
 * text contains the two characters that begin or end a comment, a blank is inserted between them.
 */
void emit_comment_lines(const emitter *emitter, const char *text);

/*
 * Write the definition `static const TYPE PREFIX_NAME[count]` of an array, preceded by a comment
 * with the meaning of the array. An array without entries gets one entry of 0.
 */
void emit_reals(emitter *emitter, const char *name, const double *value, size_t count,
                const char *meaning);
void emit_shorts(emitter *emitter, const char *name, const uint16_t *value, size_t count,
                 const char *meaning);
void emit_longs(emitter *emitter, const char *name, const uint32_t *value, size_t count);
void emit_bytes(emitter *emitter, const char *name, const uint8_t *value, size_t count,
                const char *meaning);

/*
 * Write voltage limits (V). In single precision they are rounded inwards, so that no voltage
 * exceeds the limits of the scene.
 */
void emit_limits(emitter *emitter, const char *name, const double *value, size_t count, int upper,
                 const char *meaning);

/*
 * Write voltages inside limits (V). In single precision they are clamped to the limits that
 * emit_limits writes.
 *   lower, upper [count] in  voltage limits (V)
 */
void emit_inside(emitter *emitter, const char *name, const double *value, const double *lower,
                 const double *upper, size_t count, const char *meaning);

/*
 * Write an array PREFIX_NAME[count] whose entries are blocks of reals, such as matrices, all of the
 * same dimensions.
 *   length [depth] in  dimensions of one block
 */
void emit_blocks(emitter *emitter, const char *name, const double *value, size_t count,
                 const int *length, int depth, const char *meaning);

/*
 * Write the initialiser of an array of up to four dimensions with nested braces.
 *   length [depth] in  dimensions of the array
 * Returns the position in `value` behind the array.
 */
const double *emit_nested(FILE *file, const double *value, const int *length, int depth);
void emit_vector(emitter *emitter, const double value[3]);

/*
 * Write the first members of a C struct of the library's tables: table format, checksum of the
 * scene, checksums of the data in single and in double precision.
 */
void emit_begin(const emitter *emitter, const char *type, const char *name, uint32_t scene,
                uint32_t crc);

#endif
