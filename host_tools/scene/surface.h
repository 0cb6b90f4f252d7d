/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reference surfaces with coordinates along orthogonal lines of curvature: position, local triad,
 * metric and curvatures.
 */
#ifndef SURFACE_H
#define SURFACE_H

#include "surface_point.h"

surface_point surface_at(const scene_surface *surface, double theta1, double theta2);

/*
 * Return the area of the reference surface over a rectangle of the coordinates, to rounding
 * accuracy where the surface is piecewise smooth.
 */
double surface_area(const scene_surface *surface, const double theta1[2], const double theta2[2]);

/* Return whether theta1 (direction 1) or theta2 (direction 2) is periodic with the period 2 pi. */
int surface_closes(const scene_surface *surface, int direction);

/*
 * Return whether theta1 (direction 1) or theta2 (direction 2) is an angle in radians; otherwise the
 * coordinate is a length.
 */
int surface_is_angle(const scene_surface *surface, int direction);

/*
 * Return whether the surface is a surface of revolution: theta2 is the azimuth and A2 the radius.
 */
int surface_revolves(const scene_surface *surface);

/*
 * Find the natural range of theta1 (direction 1) or theta2 (direction 2): the chord length of a
 * meridian, or the angle of a spiral.
 *   range  [2] out
 * Returns 0 if the surface has no natural range in this direction.
 */
int surface_range(const scene_surface *surface, int direction, double range[2]);

#endif
