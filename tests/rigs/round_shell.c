/*
 * Closed-form deflection of a cylinder between diaphragms (round_shell.h).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "round_shell.h"
#include <math.h>

/* Amplitudes of the displacements u, v, w and of the rotations t1, t2 of the director. */
enum { U, V, W, T1, T2, DOF };

static const double nu = 0.3, pi = 3.141592653589793;

/* Energy product of two in-plane strains (11, 22, 12) in plane stress, for Young's modulus 1. */
static double plane_product(const double left[3], const double right[3])
{
    const double cross = 1 / (1 - nu * nu), gain = 1 / (2 * (1 + nu));
    return cross * (left[0] * right[0] + left[1] * right[1] +
                    nu * (left[0] * right[1] + left[1] * right[0])) +
           gain * left[2] * right[2];
}

/*
 * Strains 11, 22, 12, 13, 23 at a height above the reference surface, for a unit amplitude i; w
 * varies as cos cos, u as sin cos, v as cos sin along the axis and around the circumference.
 */
static void cylinder_strain(int i, double wave, double harmonic, double offset, double strain[5])
{
    const double radius = 1 + offset, height = i >= T1 ? offset : 1;
    const int along = i == U || i == T1, around = i == V || i == T2;
    strain[0] = along ? wave * height : 0;
    strain[1] = ((around ? harmonic * height : 0) + (i == W ? 1 : 0)) / radius;
    strain[2] = (along ? -harmonic * height / radius : 0) + (around ? -wave * height : 0);
    strain[3] = (i == W ? -wave : 0) + (i == T1 ? 1 : 0);
    strain[4] = ((i == V ? -1 : 0) + (i == W ? -harmonic : 0) + (i == T2 ? 1 : 0)) / radius;
}

static void add_height(double k[DOF][DOF], double wave, double harmonic, double height,
                       double weight)
{
    double strain[DOF][5];
    for (int i = 0; i < DOF; i++)
        cylinder_strain(i, wave, harmonic, height, strain[i]);
    for (int i = 0; i < DOF; i++)
        for (int j = 0; j < DOF; j++)
            k[i][j] +=
                weight * (1 + height) *
                (plane_product(strain[i], strain[j]) +
                 (strain[i][3] * strain[j][3] + strain[i][4] * strain[j][4]) / (2 * (1 + nu)));
}

double round_shell_crest(int harmonic, double length, double thickness)
{
    static const double gauss[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                    0.8611363115940526};
    static const double weight[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                     0.3478548451374538};
    static const int order[DOF] = {T1, T2, U, V, W}; /* w comes last, so that its pivot is the
                                                        stiffness */
    double k[DOF][DOF] = {{0}};
    for (int point = 0; point < 4; point++)
        add_height(k, pi / length, harmonic, thickness / 2 * gauss[point],
                   thickness / 2 * weight[point]);
    for (int step = 0; step < DOF - 1; step++)
        for (int i = step + 1; i < DOF; i++)
            for (int j = DOF - 1; j >= step; j--) {
                const double *row = k[order[step]];
                k[order[i]][order[j]] -=
                    k[order[i]][order[step]] * row[order[j]] / row[order[step]];
            }
    return 1 / k[W][W];
}
