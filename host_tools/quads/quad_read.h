/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of a mesh file into a checked mesh with directors (unit normals) and an order of the
 * nodes.
 */
#ifndef QUAD_READ_H
#define QUAD_READ_H

#include "quad_file.h"
#include "quad_mesh.h"
#include "quad_options.h"

/*
 * Read a mesh file and check it. Elements get a common orientation; nodes get directors (unit
 * normals, on free edges extrapolated from the inside), axes and an order. All elements belong to
 * one region.
 *   error [QUAD_ERROR] out  message
 * Returns 0, or -1 with error filled and the mesh empty.
 */
int quad_read(quad_mesh *mesh, const char *path, const quad_options *options,
              quad_warnings *warnings, char *error);

#endif
