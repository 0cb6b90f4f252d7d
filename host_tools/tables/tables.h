/* Generated C tables: the arrays of a design as const data for a firmware. */
#ifndef TABLES_H
#define TABLES_H

#include <stdio.h>
#include "../model/analysis.h"

typedef enum tables_image {
    TABLES_CONTROL,
    TABLES_LINEAR,
    TABLES_NONLINEAR,
    TABLES_IMAGES
} tables_image;
extern const char *const tables_image_name[TABLES_IMAGES];

/* The nonlinear path has no refinement: float carries it while the scaled stiffness is conditioned
 * better than this. */
#define TABLES_FLOAT_CONDITION 1e7
int tables_allow_float(const analysis *analysis);

/* What tables take: numbers and bytes besides in flash. */
typedef struct tables_size {
    size_t reals, bytes;
} tables_size;

/*
 * Bytes of workspace and of stack that an image asks for on a device, in float and in double. The
 * stack is the library's own, held to by `make test`.
 */
typedef struct tables_memory {
    size_t work[2], stack[2];
} tables_memory;
tables_memory tables_need(const analysis *analysis, tables_image image);

/*
 * Write the tables of an image as a C header.
 *   a       in  after analysis_influence; a nonlinear image: after analysis_solve, and where the
 * scene has a target after analysis_influence (without one there is no voltage problem in the
 * tables) prefix  in  of every name, a C identifier size    out The same scene gives the same
 * bytes: no dates, no paths. Returns 0, or -1 when writing failed.
 */
int tables_write(FILE *file, const analysis *analysis, tables_image image, const char *prefix,
                 tables_size *size);

#endif
