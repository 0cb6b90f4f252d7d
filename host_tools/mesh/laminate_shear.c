/* SPDX-License-Identifier: BSD-2-Clause */
/* Transverse shear stiffness of a laminate from equilibrium (laminate_shear.h). */
#include "laminate_shear.h"
#include <math.h>
#include <string.h>
#include "invert.h"

/*
 * Voigt components (order 11 22 33 23 13 12) of the in-plane strains 11, 22, 12 and of the
 * transverse shears 13, 23.
 */
static const int plane[3] = {0, 1, 5}, transverse[2] = {4, 3};

/*
 * Compute the plane stress stiffness of a ply for the strains 11, 22 and 12: the normal stress 33
 * is 0.
 */
static void plane_stress(const shear_ply *ply, double plane_stiffness[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            plane_stiffness[i][j] = ply->c[plane[i]][plane[j]] -
                                    ply->c[plane[i]][2] * ply->c[2][plane[j]] / ply->c[2][2];
}

int laminate_flexure(const shear_ply *ply, int plies, double flex[6][6])
{
    memset(flex, 0, 36 * sizeof(double));
    for (int layer = 0; layer < plies; layer++) {
        const double *z = ply[layer].z, power[3] = {z[1] - z[0], (z[1] * z[1] - z[0] * z[0]) / 2,
                                                    (pow(z[1], 3) - pow(z[0], 3)) / 3};
        double plane_stiffness[3][3];
        plane_stress(&ply[layer], plane_stiffness);
        for (int i = 0; i < 6; i++)
            for (int j = 0; j < 6; j++)
                flex[i][j] += plane_stiffness[i % 3][j % 3] * power[i / 3 + j / 3];
    }
    return invert(&flex[0][0], 6, 6);
}

/*
 * Integrate the in-plane stresses of a ply under unit bending moments from height z0 to height z
 * (sum [3][3] out: one row for each stress 11, 22, 12, one column for each moment 11, 22, 12).
 */
static void integrated_stress(double plane_stiffness[3][3], double flex[6][6], double z0, double z,
                              double sum[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            sum[i][j] = 0;
            for (int k = 0; k < 3; k++)
                sum[i][j] += plane_stiffness[i][k] * (flex[k][3 + j] * (z - z0) +
                                                      flex[3 + k][3 + j] * (z * z - z0 * z0) / 2);
        }
}

/*
 * Add the work of the transverse shear stresses at one height, work += weight P^T compliance P. P
 * is the matrix of shear stresses per unit transverse force.
 *   stress     [3][3] in      in-plane stresses 11, 22, 12 (rows) under unit bending moments 11,
 *       22, 12 (columns), integrated from the lowest face to this height (1/m)
 *   compliance [2][2] in      shear strains 13 and 23 per shear stress (1/Pa)
 *   weight            in      weight of the height in an integral over the thickness (m)
 *   work       [2][2] in/out  work per area for each pair of unit transverse forces 13, 23 (m/N)
 */
static void add_work(double stress[3][3], double compliance[2][2], double weight, double work[2][2])
{
    /* P: shear stresses 13 and 23 (rows) under the unit transverse forces 13 and 23 (columns) */
    const double shear[2][2] = {{stress[0][0], stress[2][1]}, {stress[2][0], stress[1][1]}};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            for (int row = 0; row < 2; row++)
                for (int column = 0; column < 2; column++)
                    work[i][j] +=
                        weight * shear[row][i] * compliance[row][column] * shear[column][j];
}

/*
 * Add one ply to two integrals over the thickness. Plies are added from the lowest to the highest.
 *   below [3][3] in/out  in-plane stresses 11, 22, 12 (rows) under unit bending moments 11, 22, 12
 *       (columns), integrated up to the lower (in) or upper (out) face of the ply (1/m)
 *   work  [2][2] in/out  work of the transverse shear stresses per area, for unit transverse forces
 *       13 and 23 (m/N)
 * Returns 0, or -1 if the ply has no shear stiffness.
 */
static int add_ply(const shear_ply *ply, double flex[6][6], double below[3][3], double work[2][2])
{
    static const double point[3] = {-0.7745966692414834, 0, 0.7745966692414834};
    static const double weight[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
    const double z0 = ply->z[0], thickness = ply->z[1] - z0;
    double plane_stiffness[3][3], compliance[2][2], stress[3][3];
    plane_stress(ply, plane_stiffness);
    for (int row = 0; row < 2; row++)
        for (int column = 0; column < 2; column++)
            compliance[row][column] = ply->c[transverse[row]][transverse[column]];
    if (invert(&compliance[0][0], 2, 2) < 0)
        return -1;
    for (int k = 0; k < 3; k++) { /* the work of the transverse shear stresses is a polynomial of
                                     degree 4 in the height within a ply, for which three Gauss
                                     points are exact */
        integrated_stress(plane_stiffness, flex, z0, z0 + thickness * (1 + point[k]) / 2, stress);
        for (int i = 0; i < 9; i++)
            stress[i / 3][i % 3] += below[i / 3][i % 3];
        add_work(stress, compliance, thickness * weight[k], work);
    }
    integrated_stress(plane_stiffness, flex, z0, ply->z[1], stress);
    for (int i = 0; i < 9; i++)
        below[i / 3][i % 3] += stress[i / 3][i % 3];
    return 0;
}

int laminate_shear(const shear_ply *ply, int plies, double k[2][2])
{
    double flex[6][6], below[3][3] = {{0}}, work[2][2] = {{0}};
    if (laminate_flexure(ply, plies, flex) < 0)
        return -1;
    for (int layer = 0; layer < plies; layer++)
        if (add_ply(&ply[layer], flex, below, work) < 0)
            return -1;
    if (invert(&work[0][0], 2, 2) < 0)
        return -1;
    memcpy(k, work, sizeof work);
    return 0;
}
