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

surface_point surface_at(const scene_surface *s, double theta1, double theta2);

/* Exact area of the reference surface over a rectangle of the parameters. */
double surface_area(const scene_surface *s, const double theta1[2], const double theta2[2]);

/* Direction (1 or 2) in which the surface closes on itself after 2 pi, or 0. */
int surface_periodic(const scene_surface *s);

#endif
