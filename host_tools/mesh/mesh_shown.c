/* SPDX-License-Identifier: BSD-2-Clause */
/* Coordinates of nodes in texts (mesh_shown.h). */
#include "mesh_shown.h"
#include <float.h>
#include <math.h>

/*
 * Rounding error of a coordinate, relative to the size of the mesh: programs that write mesh files
 * leave errors of some hundred machine epsilons. It is far below the last digit that is printed.
 */
static const double rounding = 4096 * DBL_EPSILON;

mesh_size mesh_size_of(const mesh *mesh)
{
    mesh_size size = {0, {0, 0}};
    for (int node = 0; node < mesh->nodes; node++) {
        for (int i = 0; i < 3; i++)
            size.position = fmax(size.position, fabs(mesh->point[node].position[i]));
        for (int i = 0; i < 2 && !mesh->quads; i++)
            size.theta[i] = fmax(size.theta[i], fabs(mesh->theta[node][i]));
    }
    return size;
}

double mesh_shown(double coordinate, double size)
{
    return fabs(coordinate) <= rounding * size ? 0 : coordinate;
}
