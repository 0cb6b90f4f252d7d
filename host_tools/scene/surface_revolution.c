/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Surfaces of revolution about the z axis (surface_types.h): the shapes of their meridians, and
 * surface points from a point of the meridian.
 */
#include <math.h>
#include <string.h>
#include "surface_types.h"

static const double degree = 0.017453292519943295;

static void set(double vector[3], double x, double y, double z)
{
    vector[0] = x;
    vector[1] = y;
    vector[2] = z;
}

/*
 * Return the point of a surface of revolution about the z axis; the surface coordinate theta2 is
 * the azimuth. The normal points to the left of the meridian when height is plotted over radius and
 * the surface coordinate theta1 increases.
 */
surface_point revolution_at(const scene_surface *surface, double theta1, double theta2)
{
    const surface_meridian meridian = surface_type_of(surface)->meridian(surface, theta1);
    const double cosine = cos(theta2), sine = sin(theta2),
                 length = hypot(meridian.d1[0], meridian.d1[1]);
    const double dr = meridian.d1[0] / length, dz = meridian.d1[1] / length;
    surface_point point;
    memset(&point, 0, sizeof point);
    set(point.position, meridian.x[0] * cosine, meridian.x[0] * sine, meridian.x[1]);
    set(point.triad[0], dr * cosine, dr * sine, dz);
    set(point.triad[1], -sine, cosine, 0);
    set(point.triad[2], -dz * cosine, -dz * sine, dr);
    point.lame[0] = length;
    point.lame[1] = meridian.x[0];
    point.curvature[0] = (dz * meridian.d2[0] - dr * meridian.d2[1]) / (length * length);
    point.curvature[1] = -dz / meridian.x[0];
    point.geodesic[0] = dr / meridian.x[0];
    return point;
}

/* ---- polar coordinates of a plane ------------------------------------- */

surface_meridian polar_meridian(const scene_surface *surface, double theta1)
{
    const surface_meridian meridian = {{theta1, 0}, {1, 0}, {0, 0}};
    (void)surface;
    return meridian;
}

double polar_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    (void)surface;
    return (t1[0] + t1[1]) / 2 * (t1[1] - t1[0]) * (t2[1] - t2[0]);
}

/* ---- cone ------------------------------------------------------------- */

surface_meridian cone_meridian(const scene_surface *surface, double theta1)
{
    const double slope = surface->angle * degree;
    const surface_meridian meridian = {
        {surface->radius + theta1 * sin(slope), -theta1 * cos(slope)},
        {sin(slope), -cos(slope)},
        {0, 0}};
    return meridian;
}

double cone_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    const double middle = (t1[0] + t1[1]) / 2;
    return (surface->radius + middle * sin(surface->angle * degree)) * (t1[1] - t1[0]) *
           (t2[1] - t2[0]);
}

/* ---- sphere ----------------------------------------------------------- */

surface_meridian sphere_meridian(const scene_surface *surface, double theta1)
{
    const double radius = surface->radius, cosine = cos(theta1), sine = sin(theta1);
    const surface_meridian meridian = {{radius * sine, radius * cosine},
                                       {radius * cosine, -radius * sine},
                                       {-radius * sine, -radius * cosine}};
    return meridian;
}

double sphere_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    const double middle = (t1[0] + t1[1]) / 2, d1 = t1[1] - t1[0], d2 = t2[1] - t2[0];
    return surface->radius * surface->radius * 2 * sin(middle) * sin(d1 / 2) * d2;
}

/* ---- hyperboloid ------------------------------------------------------ */

surface_meridian hyperboloid_meridian(const scene_surface *surface, double theta1)
{
    const double waist = surface->waist, relative_height = theta1 / surface->height,
                 root = sqrt(1 + relative_height * relative_height);
    const surface_meridian meridian = {
        {waist * root, -theta1},
        {waist * relative_height / (root * surface->height), -1},
        {waist / (root * root * root * surface->height * surface->height), 0}};
    return meridian;
}

/* ---- torus ------------------------------------------------------------ */

surface_meridian torus_meridian(const scene_surface *surface, double theta1)
{
    const double radius = surface->tube, cosine = cos(theta1), sine = sin(theta1);
    const surface_meridian meridian = {{surface->radius + radius * cosine, -radius * sine},
                                       {-radius * sine, -radius * cosine},
                                       {-radius * cosine, radius * sine}};
    return meridian;
}

double torus_area(const scene_surface *surface, const double t1[2], const double t2[2])
{
    const double middle = (t1[0] + t1[1]) / 2, d1 = t1[1] - t1[0], d2 = t2[1] - t2[0];
    return surface->tube * (surface->radius * d1 + 2 * surface->tube * cos(middle) * sin(d1 / 2)) *
           d2;
}

/* ---- meridian through points ------------------------------------------ */

surface_meridian spline_meridian(const scene_surface *surface, double theta1)
{
    surface_meridian meridian;
    spline_at(surface->meridian, theta1, meridian.x, meridian.d1, meridian.d2);
    return meridian;
}
