/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reference surfaces of shells: position, local axes (triad), metric and curvatures at the
 * coordinates theta1 and theta2.
 */
#ifndef SURFACE_H
#define SURFACE_H

#include "surface_point.h"

surface_point surface_at(const scene_surface *surface, double theta1, double theta2);

/*
 * Return the area of the reference surface over the rectangle theta1[0] to theta1[1], theta2[0] to
 * theta2[1] of its surface coordinates, to rounding accuracy where the surface is piecewise smooth.
 */
double surface_area(const scene_surface *surface, const double theta1[2], const double theta2[2]);

/*
 * Return whether the surface coordinate theta1 (direction 1) or theta2 (direction 2) is periodic
 * with the period 2 pi.
 */
int surface_closes(const scene_surface *surface, int direction);

/*
 * Return whether the surface coordinate theta1 (direction 1) or theta2 (direction 2) is an angle in
 * radians; otherwise it is a length.
 */
int surface_is_angle(const scene_surface *surface, int direction);

/*
 * Return whether a surface is a surface of revolution; its coordinate theta2 is then the azimuth,
 * and its Lame parameter A2 the radius.
 */
int surface_revolves(const scene_surface *surface);

/*
 * Find the range of theta1 (direction 1) or theta2 (direction 2) beyond which the surface does not
 * exist: chord length of a meridian through points, or angle of a spiral.
 *   range  [2] out  lowest and highest value
 * Returns 1, or 0 if the surface does not limit the coordinate.
 */
int surface_range(const scene_surface *surface, int direction, double range[2]);

#endif
