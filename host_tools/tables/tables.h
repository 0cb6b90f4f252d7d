/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Writes generated C tables: the arrays that the library needs for a scene, such as influence
 * matrix, limits and element matrices, as constant data for a firmware.
 */
#ifndef TABLES_H
#define TABLES_H

#include <stdio.h>
#include "../model/analysis.h"
#include "sparse_tables.h"

typedef enum tables_image {
    TABLES_CONTROL,
    TABLES_LINEAR,
    TABLES_NONLINEAR,
    TABLES_IMAGES
} tables_image;
extern const char *const tables_image_name[TABLES_IMAGES];

/*
 * Largest condition number of the scaled stiffness matrix with which a firmware may compute
 * equilibria in single precision, because its solver does not refine the solutions of linear
 * equations.
 */
#define TABLES_FLOAT_CONDITION 1e7
int tables_allow_float(const analysis *analysis);

/* Size of tables in flash memory: number of reals, and bytes of other data. */
typedef struct tables_size {
    size_t reals, bytes;
    size_t loop[2]; /* memory of the control loop on the device, in single [0] and in double [1]
                       precision (bytes); 0 where the firmware has no controller */
    sparse_facts influence; /* form of the influence matrix in the tables: as full matrix or as
                               sparse rows, with the numbers of entries from which this was decided
                             */
} tables_size;

/*
 * Bytes of workspace and of stack that a firmware needs on a device, in single precision [0] and
 * double precision [1]. The stack is that of the library alone, without the caller's.
 *   size in  sizes of the tables, which tables_write has determined
 */
typedef struct tables_memory {
    size_t work[2], stack[2];
} tables_memory;
tables_memory tables_need(const analysis *analysis, tables_image image, const tables_size *size);

/*
 * Return whether, with the option --compact, the tables of the structure hold compact element types
 * (pzs_compact_type), without the matrices that the firmware computes from the nodes. They do on
 * meshes where nearly every element is a type of its own.
 */
bool tables_are_compact(const analysis *analysis);

/*
 * Write the tables of a firmware as a C header. A scene always gives identical bytes: the header
 * contains no dates and no paths.
 *   analysis in   analysis of the scene. If the scene has a target, its influence matrix must be
 *       computed; for image nonlinear, its displacement too
 *   image    in   part of the library that the firmware uses: control, linear or nonlinear
 *   prefix   in   start of every name, a C identifier
 *   size     out  size of the tables
 * Returns 0, or -1 when writing failed.
 */
int tables_write(FILE *file, const analysis *analysis, tables_image image, const char *prefix,
                 tables_size *size);

#endif
