/* SPDX-License-Identifier: BSD-2-Clause */
/* Reading of a mesh file into a checked mesh with directors and an order of the nodes. */
#ifndef QUAD_READ_H
#define QUAD_READ_H

#include "quad_file.h"
#include "quad_mesh.h"
#include "quad_options.h"

/*
 * Read a mesh file, check it, give its elements a common orientation, and determine the directors
 * (unit normals) and axes of the nodes, the sets and the order of the nodes. A director inside the
 * mesh is the mean of the normals of the elements at the node, weighted with their angles there and
 * corrected by the fit of a quadric. On a free edge the director is extrapolated from the directors
 * inside, so that spheres and cylinders keep their exact normals. The first local axis of a node is
 * the projection of a global axis. All elements belong to one region.
 *   error [QUAD_ERROR] out  message
 * Returns 0, or -1 with error filled and the mesh empty.
 */
int quad_read(quad_mesh *mesh, const char *path, const quad_options *options,
              quad_warnings *warnings, char *error);

#endif
