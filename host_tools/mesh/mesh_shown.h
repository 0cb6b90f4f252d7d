/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Coordinates of nodes in texts. A coordinate that should be 0 is printed as 0, not as the rounding
 * error of its computation, or of the program that wrote the mesh file.
 */
#ifndef MESH_SHOWN_H
#define MESH_SHOWN_H

#include "mesh.h"

/* Sizes of a mesh, relative to which a coordinate counts as 0. */
typedef struct mesh_size {
    double position; /* largest magnitude of a coordinate x, y or z of a node (length unit of the
                        scene) */
    double theta[2]; /* largest magnitudes of the surface coordinates theta1 and theta2 of a node */
} mesh_size;

mesh_size mesh_size_of(const mesh *mesh);

/*
 * Return a coordinate for a text: 0 where its magnitude is a rounding error of the size of the
 * mesh.
 *   size in  member of mesh_size that belongs to the coordinate
 */
double mesh_shown(double coordinate, double size);

#endif
