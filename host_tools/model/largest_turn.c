/* SPDX-License-Identifier: BSD-2-Clause */
/* Place at which a deformed shell bends most sharply within an element (largest_turn.h). */
#include "largest_turn.h"
#include <math.h>
#include "../quads/vector.h"
#include "design.h"

/*
 * Compute the unit vector along the line through the thickness at a node of the deformed shell.
 */
static void deformed_line(const mesh *mesh, const double *displacement, int node, double line[3])
{
    for (int i = 0; i < 3; i++) {
        const scene_component axis = (scene_component)((int)COMPONENT_X + i);
        line[i] = mesh->laminate.thickness * mesh->point[node].triad[2][i] +
                  design_displacement(mesh, displacement, node, axis, FACE_OUTER) -
                  design_displacement(mesh, displacement, node, axis, FACE_INNER);
    }
    const double length = sqrt(vector_dot(line, line));
    for (int i = 0; i < 3; i++)
        line[i] /= length;
}

/* Angle between two unit vectors (degrees). */
static double angle_between(const double first[3], const double second[3])
{
    const double degrees = 57.29577951308232;
    return degrees * acos(fmax(-1, fmin(1, vector_dot(first, second))));
}

double largest_turn(const mesh *mesh, const double *displacement, int *element)
{
    double most = 0;
    *element = 0;
    for (int k = 0; k < mesh->elements; k++)
        for (int corner = 0; corner < 4; corner++) {
            const int first = mesh->element[k][corner];
            const int second = mesh->element[k][(corner + 1) % 4];
            double line[2][3];
            deformed_line(mesh, displacement, first, line[0]);
            deformed_line(mesh, displacement, second, line[1]);
            const double turn =
                fabs(angle_between(line[0], line[1]) -
                     angle_between(mesh->point[first].triad[2], mesh->point[second].triad[2]));
            if (turn > most) {
                most = turn;
                *element = k;
            }
        }
    return most;
}

double largest_tilt(const mesh *mesh, const double *displacement, int *node)
{
    double most = 0;
    *node = 0;
    for (int k = 0; k < mesh->nodes; k++) {
        double line[3];
        deformed_line(mesh, displacement, k, line);
        const double tilt = angle_between(line, mesh->point[k].triad[2]);
        if (tilt > most) {
            most = tilt;
            *node = k;
        }
    }
    return most;
}
