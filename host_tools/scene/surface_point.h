/* SPDX-License-Identifier: BSD-2-Clause */
/* Point of a reference surface. */
#ifndef SURFACE_POINT_H
#define SURFACE_POINT_H

#include "scene.h"

typedef struct surface_point {
    double x[3];    /* position in space */
    double e[3][3]; /* unit vectors e1, e2, e3 = e1 x e2 as rows; e3 is the outer side */
    double a[2];    /* Lame parameters A1, A2: length per unit of theta1, theta2 */
    double k[2];    /* principal curvatures, defined by e3,a = A_a k_a e_a */
    double b[2];    /* geodesic terms B1 = A2,1/(A1 A2), B2 = A1,2/(A1 A2) */
} surface_point;

#endif
