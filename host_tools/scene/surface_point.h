/* SPDX-License-Identifier: BSD-2-Clause */
/* Position, triad (local axes), metric and curvatures of a reference surface at one point. */
#ifndef SURFACE_POINT_H
#define SURFACE_POINT_H

#include "scene.h"

typedef struct surface_point {
    double position[3]; /* coordinates x, y, z of the point in space (length unit of the scene file)
                         */
    double triad[3][3]; /* unit vectors e1, e2, e3 = e1 x e2 as rows; e3 points to the outer side of
                           the shell */
    double lame[2]; /* Lame parameters A1, A2: arc length per unit of the surface coordinates theta1
                       and theta2 */
    double curvature[2]; /* principal curvatures k1, k2 along the surface coordinates theta1, theta2
                            (1/length): de3/dtheta1 = A1 k1 e1 and de3/dtheta2 = A2 k2 e2, with the
                            unit tangents e1, e2, the normal e3, and A1, A2 the arc lengths per unit
                            of the coordinates */
    double geodesic[2]; /* geodesic curvatures of the coordinate lines (1/length): (dA2/dtheta1)/(A1
                           A2) and (dA1/dtheta2)/(A1 A2) with the surface coordinates theta1, theta2
                           and the Lame parameters A1, A2 (arc length per unit of the coordinates)
                         */
} surface_point;

#endif
