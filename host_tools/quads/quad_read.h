/* SPDX-License-Identifier: BSD-2-Clause */
/* From a mesh file to a checked mesh with directors and a numbering. */
#ifndef QUAD_READ_H
#define QUAD_READ_H

#include "quad_file.h"
#include "quad_mesh.h"
#include "quad_options.h"

/*
 * Read a mesh file, check it, orient its elements, and fill directors, axes, sets and order.
 *
 * A director is the mean of the normals of its elements, weighted with their angles. On a free edge
 * it continues the directors inside, so that a sphere and a cylinder keep theirs. Axes are those of
 * quad_default_axis. There is one region.
 *   error [QUAD_ERROR] out
 * Returns 0, or -1 with error filled and the mesh empty.
 */
int quad_read(quad_mesh *mesh, const char *path, const quad_options *options,
              quad_warnings *warnings, char *error);

#endif
