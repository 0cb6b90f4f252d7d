/* SPDX-License-Identifier: BSD-2-Clause */
/* Surfaces of revolution about z (surface_types.h): meridians, and points made from them. */
#include <math.h>
#include <string.h>
#include "surface_types.h"

static const double degree = 0.017453292519943295;

static void set(double v[3], double x, double y, double z)
{
    v[0] = x;
    v[1] = y;
    v[2] = z;
}

/*
 * Compute a point of a surface of revolution about z with theta2 as the azimuth. e3 points to the
 * left of the meridian in a plot of height over radius.
 */
surface_point revolution_at(const scene_surface *surface, double theta1, double theta2)
{
    const surface_meridian m = surface_type_of(surface)->meridian(surface, theta1);
    const double c = cos(theta2), q = sin(theta2), length = hypot(m.d1[0], m.d1[1]);
    const double dr = m.d1[0] / length, dz = m.d1[1] / length;
    surface_point p;
    memset(&p, 0, sizeof p);
    set(p.x, m.x[0] * c, m.x[0] * q, m.x[1]);
    set(p.e[0], dr * c, dr * q, dz);
    set(p.e[1], -q, c, 0);
    set(p.e[2], -dz * c, -dz * q, dr);
    p.a[0] = length;
    p.a[1] = m.x[0];
    p.k[0] = (dz * m.d2[0] - dr * m.d2[1]) / (length * length);
    p.k[1] = -dz / m.x[0];
    p.b[0] = dr / m.x[0];
    return p;
}

/* ---- polar coordinates of a plane ------------------------------------- */

surface_meridian polar_meridian(const scene_surface *surface, double t)
{
    const surface_meridian m = {{t, 0}, {1, 0}, {0, 0}};
    (void)surface;
    return m;
}

double polar_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    (void)surface;
    return (t1[0] + t1[1]) / 2 * (t1[1] - t1[0]) * (t2[1] - t2[0]);
}

/* ---- cone ------------------------------------------------------------- */

surface_meridian cone_meridian(const scene_surface *surface, double t)
{
    const double slope = surface->angle * degree;
    const surface_meridian m = {
        {surface->radius + t * sin(slope), -t * cos(slope)}, {sin(slope), -cos(slope)}, {0, 0}};
    return m;
}

double cone_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    const double middle = (t1[0] + t1[1]) / 2;
    return (surface->radius + middle * sin(surface->angle * degree)) * (t1[1] - t1[0]) *
           (t2[1] - t2[0]);
}

/* ---- sphere ----------------------------------------------------------- */

surface_meridian sphere_meridian(const scene_surface *surface, double t)
{
    const double r = surface->radius, c = cos(t), q = sin(t);
    const surface_meridian m = {{r * q, r * c}, {r * c, -r * q}, {-r * q, -r * c}};
    return m;
}

double sphere_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    const double middle = (t1[0] + t1[1]) / 2, d1 = t1[1] - t1[0], d2 = t2[1] - t2[0];
    return surface->radius * surface->radius * 2 * sin(middle) * sin(d1 / 2) * d2;
}

/* ---- hyperboloid ------------------------------------------------------ */

surface_meridian hyperboloid_meridian(const scene_surface *surface, double t)
{
    const double w = surface->waist, z = t / surface->height, root = sqrt(1 + z * z);
    const surface_meridian m = {{w * root, -t},
                                {w * z / (root * surface->height), -1},
                                {w / (root * root * root * surface->height * surface->height), 0}};
    return m;
}

/* ---- torus ------------------------------------------------------------ */

surface_meridian torus_meridian(const scene_surface *surface, double t)
{
    const double r = surface->tube, c = cos(t), q = sin(t);
    const surface_meridian m = {
        {surface->radius + r * c, -r * q}, {-r * q, -r * c}, {-r * c, r * q}};
    return m;
}

double torus_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    const double middle = (t1[0] + t1[1]) / 2, d1 = t1[1] - t1[0], d2 = t2[1] - t2[0];
    return surface->tube * (surface->radius * d1 + 2 * surface->tube * cos(middle) * sin(d1 / 2)) *
           d2;
}

/* ---- meridian through points ------------------------------------------ */

surface_meridian spline_meridian(const scene_surface *surface, double t)
{
    surface_meridian m;
    spline_at(surface->meridian, t, m.x, m.d1, m.d2);
    return m;
}
