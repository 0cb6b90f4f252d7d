/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Geometry of one quadrilateral element at its centre, from the positions and directors (unit
 * normals) of its four nodes alone: the mesh needs no surface coordinates and no formula of the
 * surface. The natural coordinates xi1 and xi2 are -1 or 1 at the corners.
 */
#ifndef QUAD_GEOMETRY_H
#define QUAD_GEOMETRY_H

#include "../quads/quad_mesh.h"

typedef struct quad_geometry {
    double base[2][3];  /* base vectors g_a of the element (m), a = 1, 2: derivative of the position
                           with respect to the natural coordinate xi_a at the centre, 1/4 of the sum
                           of xi_a times the corner positions */
    double turn[2][3];  /* derivatives d_a of the director (unit normal of the surface) with respect
                           to the natural coordinate xi_a at the centre (dimensionless), 1/4 of the
                           sum of xi_a times the directors of the corners */
    double director[3]; /* unit vector along the sum of the directors (unit normals) of the corners
                         */
    double normal[3]; /* unit normal of the element, along the cross product of its base vectors */
    double length[2]; /* lengths of the element along its directions 1 and 2, twice the lengths of
                         the base vectors (m) */
    double skew[2];   /* skew coefficients alpha_1, alpha_2 of the element (dimensionless):
                         components, along its base vectors, of the hourglass vector. This vector is
                         1/4 of the sum of xi1 xi2 times the corner positions */
    double curvature[3]; /* curvatures B_11, B_22, B_12 of the element along its two directions
                            (1/m): B_ab = 2 (g_a . d_b + g_b . d_a)/(L_a L_b), where g_a is `base`,
                            d_a is `turn` and L_a is `length`, which is 2 |g_a| */
    double principal[2]; /* principal curvatures of the element (1/m) */
    double area;         /* area of the element (m2) */
    double jacobian; /* area of the element per unit of the natural coordinates at a corner, over
                        that at the centre: the smallest of the four ratios; 1 for a parallelogram
                      */
    double upright;  /* smallest cosine of the angle between a corner's director and the normal of
                        the element */
} quad_geometry;

/*
 * Compute the geometry of an element. Returns 0, or -1 if the element has no extent or a number is
 * not finite.
 */
int quad_geometry_fill(const quad_mesh *mesh, size_t element, quad_geometry *geometry);

#endif
