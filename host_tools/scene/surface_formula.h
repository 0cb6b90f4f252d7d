/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reference surface given by formulas x, y, z of theta1 and theta2. Its coordinate lines need not
 * be lines of curvature, nor meet at right angles.
 */
#ifndef SURFACE_FORMULA_H
#define SURFACE_FORMULA_H

#include "surface_point.h"

/*
 * Whether a surface is given by formulas; the functions below are for such surfaces alone. Points
 * (formula_at of surface_types.h): e1 lies along theta1, e3 = x,1 x x,2 normalised, e2 = e3 x e1; a
 * and k are the lengths and the normal curvatures of the coordinate lines; b is 0.
 */
int surface_is_general(const scene_surface *surface);

/* Turn the triad of a point so that e2 lies along theta2. theta [2] in */
void surface_formula_turn(const scene_surface *surface, const double theta[2],
                          surface_point *point);

/* Cosine of the angle between the coordinate lines at a point; NAN where the surface has no normal.
 */
double surface_formula_cosine(const scene_surface *surface, double theta1, double theta2);

#endif
