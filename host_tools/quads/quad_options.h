/* SPDX-License-Identifier: BSD-2-Clause */
/* Options for reading a mesh file, and warnings about a valid one. */
#ifndef QUAD_OPTIONS_H
#define QUAD_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "quad_mesh.h"

typedef struct quad_options {
    double unit; /* unit of length of the mesh file, given as its size in the unit of length of the
                    scene file */
    bool is_flipped;   /* order in which the mesh file lists the corners of most elements, seen from
                          the outer face of the shell. true: clockwise; false: counterclockwise */
    size_t most_nodes; /* largest number of nodes that a mesh file may have */
} quad_options;

/* Warnings about a valid mesh. Elements and nodes are given by their numbers in the mesh file. */
typedef struct quad_warnings {
    double sharp_angle; /* angle of the sharpest edge between two elements (degrees); 0: no edge is
                           sharp */
    int64_t sharp[2];   /* numbers of the two elements at the sharpest edge */
    size_t slits;     /* number of pairs of nodes at nearly the same position, in elements that are
                         not connected there */
    int64_t slit[2];  /* numbers of two nodes at nearly the same position in elements that are not
                         connected there: the first such pair that was found */
    quad_loose loose; /* nodes of the file that belong to no quadrilateral */
} quad_warnings;

#endif
