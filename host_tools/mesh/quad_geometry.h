/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Geometry of one quadrilateral at its centre, from the positions and directors of its nodes alone:
 * the mesh needs no parameter plane and no formula of the surface.
 */
#ifndef QUAD_GEOMETRY_H
#define QUAD_GEOMETRY_H

#include "../quads/quad_mesh.h"

typedef struct quad_geometry {
    double base[2][3]; /* g_a = 1/4 sum_r xi_a,r X_r: position per unit of xi_a at the centre (m) */
    double turn[2][3]; /* d_a = 1/4 sum_r xi_a,r D_r: director per unit of xi_a at the centre (1) */
    double director[3];  /* unit vector along the sum of the corners' directors */
    double normal[3];    /* unit vector along g_1 x g_2 */
    double length[2];    /* L_a = 2 |g_a| (m) */
    double skew[2];      /* alpha_a = g_h . g^a, with g_h = 1/4 sum_r xi1_r xi2_r X_r (1) */
    double curvature[3]; /* B_11, B_22, B_12 along the unit vectors of g_1, g_2:
                            B_ab = 2 (g_a . d_b + g_b . d_a)/(L_a L_b) (1/m) */
    double principal[2]; /* principal curvatures (1/m) */
    double area;         /* (m2) */
    double jacobian; /* smallest corner value of 1 + alpha_1 xi2 + alpha_2 xi1; 1: parallelogram */
    double upright;  /* smallest cosine of a corner's director with the normal */
} quad_geometry;

/* Fill the geometry of an element. Returns 0, or -1 where the element has no extent. */
int quad_geometry_fill(const quad_mesh *mesh, size_t element, quad_geometry *geometry);

#endif
