/* SPDX-License-Identifier: BSD-2-Clause */
/* Writes arrays as C source and accumulates their checksum in float and their size. */
#ifndef EMIT_H
#define EMIT_H

#include <stdint.h>
#include <stdio.h>

typedef struct emitter {
    FILE *file;
    const char *prefix;
    char upper[64];      /* the prefix in capitals, for macros */
    uint32_t crc32;      /* checksum of the written data, reals rounded to float */
    size_t reals, bytes; /* written so far: number of reals, and bytes of other data */
} emitter;

/*
 * Write a number exactly. Values of an array are added to the checksum and the size by
 * emit_count_reals or emit_count_bytes.
 */
void emit_real(FILE *file, double value);
uint32_t emit_crc_reals(uint32_t crc, const double *value, size_t count);
void emit_count_reals(emitter *emitter, const double *value, size_t count);
void emit_count_bytes(emitter *emitter, const void *value, size_t bytes);

/*
 * Write `static const ... PREFIX_NAME[n]` with its meaning as a comment before it. An array without
 * entries gets one entry of 0.
 */
void emit_reals(emitter *emitter, const char *name, const double *value, size_t count,
                const char *meaning);
void emit_shorts(emitter *emitter, const char *name, const uint16_t *value, size_t count,
                 const char *meaning);
void emit_longs(emitter *emitter, const char *name, const uint32_t *value, size_t count);

/*
 * Write voltage limits. In float they are rounded inwards, so that no voltage exceeds the scene's
 * limit.
 */
void emit_limits(emitter *emitter, const char *name, const double *value, size_t count, int upper,
                 const char *meaning);

/* Write PREFIX_NAME[n] of blocks of reals. length [depth] in: dimensions of one block */
void emit_blocks(emitter *emitter, const char *name, const double *value, size_t count,
                 const int *length, int depth, const char *meaning);

/*
 * Write the initialiser of an array of up to four dimensions with nested braces. Returns the
 * position in x after the array.
 */
const double *emit_nested(FILE *file, const double *value, const int *length, int depth);
void emit_vector(emitter *emitter, const double value[3]);

/*
 * Write the first members of a structure of the library: format, scene, checksums in float and in
 * double.
 */
void emit_begin(const emitter *emitter, const char *type, const char *name, uint32_t scene,
                uint32_t crc);

#endif
