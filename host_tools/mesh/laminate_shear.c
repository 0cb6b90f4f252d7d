/* SPDX-License-Identifier: BSD-2-Clause */
/* Transverse shear stiffness of a laminate from equilibrium (laminate_shear.h). */
#include "laminate_shear.h"
#include <math.h>
#include <string.h>
#include "invert.h"

/* Voigt components of the in-plane strains 11, 22, 12 and of the transverse shears 13, 23. */
static const int plane[3] = {0, 1, 5}, transverse[2] = {4, 3};

/* Plane stress stiffness of a ply: s33 = 0. */
static void plane_stress(const shear_ply *ply, double q[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            q[i][j] = ply->c[plane[i]][plane[j]] -
                      ply->c[plane[i]][2] * ply->c[2][plane[j]] / ply->c[2][2];
}

int laminate_flexure(const shear_ply *ply, int plies, double flex[6][6])
{
    memset(flex, 0, 36 * sizeof(double));
    for (int p = 0; p < plies; p++) {
        const double *z = ply[p].z, power[3] = {z[1] - z[0], (z[1] * z[1] - z[0] * z[0]) / 2,
                                                (pow(z[1], 3) - pow(z[0], 3)) / 3};
        double q[3][3];
        plane_stress(&ply[p], q);
        for (int i = 0; i < 6; i++)
            for (int j = 0; j < 6; j++)
                flex[i][j] += q[i % 3][j % 3] * power[i / 3 + j / 3];
    }
    return invert(&flex[0][0], 6, 6);
}

/* In-plane stresses of a bending moment, integrated from z0 to z: sum [3][3] out. */
static void integrated_stress(double q[3][3], double flex[6][6], double z0, double z,
                              double sum[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            sum[i][j] = 0;
            for (int k = 0; k < 3; k++)
                sum[i][j] += q[i][k] * (flex[k][3 + j] * (z - z0) +
                                        flex[3 + k][3 + j] * (z * z - z0 * z0) / 2);
        }
}

/* work += weight P^T C_t^-1 P, with g [3][3] the integrated stresses up to this height. */
static void add_work(double g[3][3], double compliance[2][2], double weight, double work[2][2])
{
    const double p[2][2] = {{g[0][0], g[2][1]}, {g[2][0], g[1][1]}};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++)
                    work[i][j] += weight * p[a][i] * compliance[a][b] * p[b][j];
}

/* Add the work of a ply, and its integrated stresses to those of the plies below it. */
static int add_ply(const shear_ply *ply, double flex[6][6], double below[3][3], double work[2][2])
{
    static const double point[3] = {-0.7745966692414834, 0, 0.7745966692414834};
    static const double weight[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
    const double z0 = ply->z[0], h = ply->z[1] - z0;
    double q[3][3], compliance[2][2], g[3][3];
    plane_stress(ply, q);
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            compliance[a][b] = ply->c[transverse[a]][transverse[b]];
    if (invert(&compliance[0][0], 2, 2) < 0)
        return -1;
    for (int k = 0; k < 3; k++) { /* polynomials of degree 4: three points are exact */
        integrated_stress(q, flex, z0, z0 + h * (1 + point[k]) / 2, g);
        for (int i = 0; i < 9; i++)
            g[i / 3][i % 3] += below[i / 3][i % 3];
        add_work(g, compliance, h * weight[k], work);
    }
    integrated_stress(q, flex, z0, ply->z[1], g);
    for (int i = 0; i < 9; i++)
        below[i / 3][i % 3] += g[i / 3][i % 3];
    return 0;
}

int laminate_shear(const shear_ply *ply, int plies, double k[2][2])
{
    double flex[6][6], below[3][3] = {{0}}, work[2][2] = {{0}};
    if (laminate_flexure(ply, plies, flex) < 0)
        return -1;
    for (int p = 0; p < plies; p++)
        if (add_ply(&ply[p], flex, below, work) < 0)
            return -1;
    if (invert(&work[0][0], 2, 2) < 0)
        return -1;
    memcpy(k, work, sizeof work);
    return 0;
}
