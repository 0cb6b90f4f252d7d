/* Reference surfaces in orthogonal lines of curvature: position, triad, metric, curvatures. */
#ifndef SURFACE_H
#define SURFACE_H

#include "scene.h"

typedef struct surface_point {
    double x[3];    /* position */
    double e[3][3]; /* rows e1, e2, e3 = e1 x e2: the outer side */
    double a[2];    /* A1, A2: length per theta1, theta2 */
    double k[2];    /* principal curvatures, e3,a = A_a k_a e_a */
    double b[2];    /* B1 = A2,1/(A1 A2), B2 = A1,2/(A1 A2) */
} surface_point;

surface_point surface_at(const scene_surface *surface, double theta1, double theta2);

/* Area of the reference surface over a rectangle of the parameters, to rounding where its pieces
 * are smooth. */
double surface_area(const scene_surface *surface, const double theta1[2], const double theta2[2]);

/* Does theta1 (direction 1) or theta2 (2) come back to the same points after 2 pi? */
int surface_closes(const scene_surface *surface, int direction);

/* Is theta1 (direction 1) or theta2 (2) an angle in radians? Else a length. */
int surface_is_angle(const scene_surface *surface, int direction);

/* Is it a surface of revolution: theta2 the azimuth, A2 the radius? */
int surface_revolves(const scene_surface *surface);

/* The range of theta1 or theta2 that a surface has of itself; returns 0 where it has none. range
 * [2] out */
int surface_range(const scene_surface *surface, int direction, double range[2]);

#endif
