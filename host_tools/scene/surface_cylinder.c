/* SPDX-License-Identifier: BSD-2-Clause */
/* Cylinders over a circle and over a spiral (surface_types.h). */
#include <math.h>
#include <string.h>
#include "surface_types.h"

static const double full_turn = 6.283185307179586;

static void set(double v[3], double x, double y, double z)
{
    v[0] = x;
    v[1] = y;
    v[2] = z;
}

/*
 * Compute a point of a cylinder over a curve of radius r at the angle phi, whose radius grows by
 * `rise` per radian. The coordinate along the axis is theta1 (axis along x; phi = 0 on top,
 * increasing towards +y) or theta2 (axis along z; phi = 0 on +x, increasing towards +y).
 */
static surface_point round_at(int axis, double along, double phi, double r, double rise)
{
    surface_point p;
    memset(&p, 0, sizeof p);
    const int round = 1 - axis;
    const double c = cos(phi), q = sin(phi), length = hypot(r, rise);
    const double tangent[2] = {(rise * c - r * q) / length, (rise * q + r * c) / length};
    if (axis == 0) {
        set(p.x, along, r * q, r * c);
        set(p.e[0], 1, 0, 0);
        set(p.e[1], 0, tangent[1], tangent[0]);
        set(p.e[2], 0, -tangent[0], tangent[1]);
    } else {
        set(p.x, r * c, r * q, along);
        set(p.e[0], tangent[0], tangent[1], 0);
        set(p.e[1], 0, 0, 1);
        set(p.e[2], tangent[1], -tangent[0], 0);
    }
    p.a[axis] = 1;
    p.a[round] = length;
    p.k[round] = (r * r + 2 * rise * rise) / (length * length * length);
    return p;
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
