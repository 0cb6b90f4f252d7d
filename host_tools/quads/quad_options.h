/* SPDX-License-Identifier: BSD-2-Clause */
/* What is asked of a mesh file, and warnings on a valid one. */
#ifndef QUAD_OPTIONS_H
#define QUAD_OPTIONS_H

#include "quad_file.h"

typedef struct quad_options {
    double unit;       /* length unit of the file in the unit of the scene */
    bool is_flipped;   /* the outer face is the one that the file's elements show from behind */
    size_t most_nodes; /* largest number of nodes that is accepted */
} quad_options;

/* Warnings on a valid mesh; those that do not fit are left out. */
enum { QUAD_WARNINGS = 8 };
typedef struct quad_warnings {
    int count;
    char text[QUAD_WARNINGS][QUAD_ERROR];
} quad_warnings;

/* Add a warning. */
void quad_warn(quad_warnings *warnings, const char *format, ...);

#endif
