/* SPDX-License-Identifier: BSD-2-Clause */
/* Reference surfaces in orthogonal lines of curvature: position, triad, metric, curvatures. */
#ifndef SURFACE_H
#define SURFACE_H

#include "scene.h"

typedef struct surface_point {
    double x[3];    /* position in space */
    double e[3][3]; /* unit vectors e1, e2, e3 = e1 x e2 as rows; e3 is the outer side */
    double a[2];    /* A1, A2: length per unit of theta1, theta2 */
    double k[2];    /* principal curvatures, e3,a = A_a k_a e_a */
    double b[2];    /* B1 = A2,1/(A1 A2), B2 = A1,2/(A1 A2) */
} surface_point;

surface_point surface_at(const scene_surface *surface, double theta1, double theta2);

/*
 * Area of the reference surface over a rectangle of the parameters; exact to rounding where the
 * surface is smooth in pieces.
 */
double surface_area(const scene_surface *surface, const double theta1[2], const double theta2[2]);

/* Whether theta1 (direction 1) or theta2 (direction 2) returns to the same points after 2 pi. */
int surface_closes(const scene_surface *surface, int direction);

/*
 * Whether theta1 (direction 1) or theta2 (direction 2) is an angle in radians; otherwise it is a
 * length.
 */
int surface_is_angle(const scene_surface *surface, int direction);

/* Whether the surface is one of revolution: theta2 is the azimuth and A2 the radius. */
int surface_revolves(const scene_surface *surface);

/*
 * Natural range of theta1 (direction 1) or theta2 (direction 2), as that of a closed angle. range
 * [2] out. Returns 0 where the surface has none.
 */
int surface_range(const scene_surface *surface, int direction, double range[2]);

#endif
