/* SPDX-License-Identifier: BSD-2-Clause */
/* Points and areas of cylinders over a circle and over a spiral (surface_types.h). */
#include <math.h>
#include <string.h>
#include "surface_types.h"

static const double full_turn = 6.283185307179586;

static void set(double vector[3], double x, double y, double z)
{
    vector[0] = x;
    vector[1] = y;
    vector[2] = z;
}

/*
 * Return the point of a cylinder whose cross-section is a radius as function of the polar angle
 * phi.
 *   axis   in  0: axis x, with the coordinate theta1; 1: axis z, with the coordinate theta2
 *   along  in  coordinate along the axis
 *   phi    in  polar angle (rad), from +z towards +y for axis x, from +x towards +y for axis z
 *   radius in  radius of the curve at phi
 *   rise   in  derivative of the radius with respect to phi
 */
static surface_point round_at(int axis, double along, double phi, double radius, double rise)
{
    surface_point point;
    memset(&point, 0, sizeof point);
    const int round = 1 - axis;
    const double cosine = cos(phi), sine = sin(phi), length = hypot(radius, rise);
    const double tangent[2] = {(rise * cosine - radius * sine) / length,
                               (rise * sine + radius * cosine) / length};
    if (axis == 0) {
        set(point.position, along, radius * sine, radius * cosine);
        set(point.triad[0], 1, 0, 0);
        set(point.triad[1], 0, tangent[1], tangent[0]);
        set(point.triad[2], 0, -tangent[0], tangent[1]);
    } else {
        set(point.position, radius * cosine, radius * sine, along);
        set(point.triad[0], tangent[0], tangent[1], 0);
        set(point.triad[1], 0, 0, 1);
        set(point.triad[2], tangent[1], -tangent[0], 0);
    }
    point.lame[axis] = 1;
    point.lame[round] = length;
    point.curvature[round] = (radius * radius + 2 * rise * rise) / (length * length * length);
    return point;
}

surface_point cylinder_at(const scene_surface *surface, double theta1, double theta2)
{
    if (surface->axial == 1)
        return round_at(0, theta1, theta2, surface->radius, 0);
    return round_at(1, theta2, theta1, surface->radius, 0);
}

double cylinder_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    return surface->radius * (t1[1] - t1[0]) * (t2[1] - t2[0]);
}

surface_point spiral_at(const scene_surface *surface, double theta1, double theta2)
{
    const double rise = (surface->outer - surface->inner) / (full_turn * surface->turns);
    if (surface->axial == 1)
        return round_at(0, theta1, theta2, surface->inner + rise * theta2, rise);
    return round_at(1, theta2, theta1, surface->inner + rise * theta1, rise);
}
