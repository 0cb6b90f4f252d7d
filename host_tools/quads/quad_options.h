/* SPDX-License-Identifier: BSD-2-Clause */
/* What is asked of a mesh file, and warnings on a valid one. */
#ifndef QUAD_OPTIONS_H
#define QUAD_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct quad_options {
    double unit;       /* length unit of the file in the unit of the scene */
    bool is_flipped;   /* the outer face is the one that the file's elements show from behind */
    size_t most_nodes; /* largest number of nodes that is accepted */
} quad_options;

/* What is to be told about a valid mesh. Elements and nodes are given by their numbers in the file.
 */
typedef struct quad_warnings {
    double sharp_angle; /* largest angle of a sharp edge, degrees; 0: there is none */
    int64_t sharp[2];   /* the two elements there */
    size_t slits;       /* pairs of nodes at one place that are not joined */
    int64_t slit[2];    /* the first pair */
} quad_warnings;

#endif
