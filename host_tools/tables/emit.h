/* Arrays as C source: initialisers, their checksum in float, their size. */
#ifndef EMIT_H
#define EMIT_H

#include <stdint.h>
#include <stdio.h>

typedef struct emitter {
    FILE *file;
    const char *prefix;
    char upper[64];      /* the prefix in capitals, for macros */
    uint32_t crc32;      /* over what was written, reals rounded to float */
    size_t reals, bytes; /* written: numbers, and bytes besides */
} emitter;

/* A number, exactly; values of an array enter the checksum and the size by one of the two below. */
void emit_real(FILE *file, double x);
uint32_t emit_crc_reals(uint32_t crc, const double *x, size_t n);
void emit_count_reals(emitter *emitter, const double *x, size_t n);
void emit_count_bytes(emitter *emitter, const void *x, size_t bytes);

/* static const NAME[n], its meaning in a comment before it; of no entries: one that is 0. */
void emit_reals(emitter *emitter, const char *name, const double *x, size_t n, const char *meaning);
void emit_shorts(emitter *emitter, const char *name, const uint16_t *x, size_t n,
                 const char *meaning);
void emit_longs(emitter *emitter, const char *name, const uint32_t *x, size_t n);

/* Limits: in float rounded towards the inside, so that no voltage passes the scene's own limit. */
void emit_limits(emitter *emitter, const char *name, const double *x, size_t n, int upper,
                 const char *meaning);

/* NAME[n] of blocks of reals. length [depth] in: those of one block. */
void emit_blocks(emitter *emitter, const char *name, const double *x, size_t n, const int *length,
                 int depth, const char *meaning);

/* Initialiser of an array with up to four lengths, every value in braces of its place. Returns what
 * follows it in x. */
const double *emit_nested(FILE *file, const double *x, const int *length, int depth);
void emit_vector(emitter *emitter, const double x[3]);

/* Head of a structure of the library: format, scene, checksums in float and in double. */
void emit_begin(const emitter *emitter, const char *type, const char *name, uint32_t scene,
                uint32_t crc);

#endif
