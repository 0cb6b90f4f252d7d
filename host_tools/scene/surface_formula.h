/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reference surface given by formulas of x, y and z in the surface coordinates theta1 and theta2,
 * or fitted to points, with x = theta1 and y = theta2. Its coordinate lines need not be lines of
 * curvature and need not meet at right angles.
 */
#ifndef SURFACE_FORMULA_H
#define SURFACE_FORMULA_H

#include "surface_point.h"

/*
 * Return whether a surface is given by formulas or fitted to points; the functions of this file are
 * for such surfaces alone. Their axis e1 is along the theta1 line, e3 is the cross product of the
 * tangents with length 1, and e2 = e3 x e1. In surface_point, `lame` holds the lengths of the
 * tangents, `curvature` the normal curvatures of the coordinate lines, and `geodesic` 0.
 */
int surface_is_general(const scene_surface *surface);

/*
 * Turn the triad (local axes) of a surface point about its normal so that the axis e2 is tangent to
 * the line along which the surface coordinate theta2 varies (theta [2] in: coordinates of the
 * point).
 */
void surface_formula_turn(const scene_surface *surface, const double theta[2],
                          surface_point *point);

/*
 * Return the cosine of the angle between the coordinate lines of a surface at a point, or NAN where
 * the surface has no normal.
 */
double surface_formula_cosine(const scene_surface *surface, double theta1, double theta2);

#endif
