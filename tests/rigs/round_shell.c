/*
 * A cylinder between diaphragms in closed form (round_shell.h).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "round_shell.h"
#include <math.h>

/* Amplitudes u v w and the changes t1 t2 of the director. */
enum { U, V, W, T1, T2, DOF };

static const double nu = 0.3, pi = 3.141592653589793;

/* Plane stress of unit modulus: x' C y of the strains 11 22 12. */
static double plane_product(const double x[3], const double y[3])
{
    const double c = 1 / (1 - nu * nu), g = 1 / (2 * (1 + nu));
    return c * (x[0] * y[0] + x[1] * y[1] + nu * (x[0] * y[1] + x[1] * y[0])) + g * x[2] * y[2];
}

/*
 * Strains e11 e22 g12 g13 g23 at height z of amplitude i; w = cos cos, u = sin cos, v = cos sin
 * along x and theta2.
 */
static void cylinder_strain(int i, double wave, double harmonic, double z, double e[5])
{
    const double radius = 1 + z, height = i >= T1 ? z : 1;
    const int along = i == U || i == T1, around = i == V || i == T2;
    e[0] = along ? wave * height : 0;
    e[1] = ((around ? harmonic * height : 0) + (i == W ? 1 : 0)) / radius;
    e[2] = (along ? -harmonic * height / radius : 0) + (around ? -wave * height : 0);
    e[3] = (i == W ? -wave : 0) + (i == T1 ? 1 : 0);
    e[4] = ((i == V ? -1 : 0) + (i == W ? -harmonic : 0) + (i == T2 ? 1 : 0)) / radius;
}

static void add_height(double k[DOF][DOF], double wave, double harmonic, double z, double weight)
{
    double e[DOF][5];
    for (int i = 0; i < DOF; i++)
        cylinder_strain(i, wave, harmonic, z, e[i]);
    for (int i = 0; i < DOF; i++)
        for (int j = 0; j < DOF; j++)
            k[i][j] += weight * (1 + z) *
                       (plane_product(e[i], e[j]) +
                        (e[i][3] * e[j][3] + e[i][4] * e[j][4]) / (2 * (1 + nu)));
}

double round_shell_crest(int harmonic, double length, double h)
{
    static const double gauss[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                    0.8611363115940526};
    static const double weight[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                     0.3478548451374538};
    static const int order[DOF] = {T1, T2, U, V, W}; /* w last: its pivot is the stiffness */
    double k[DOF][DOF] = {{0}};
    for (int g = 0; g < 4; g++)
        add_height(k, pi / length, harmonic, h / 2 * gauss[g], h / 2 * weight[g]);
    for (int p = 0; p < DOF - 1; p++)
        for (int i = p + 1; i < DOF; i++)
            for (int j = DOF - 1; j >= p; j--) {
                const double *row = k[order[p]];
                k[order[i]][order[j]] -= k[order[i]][order[p]] * row[order[j]] / row[order[p]];
            }
    return 1 / k[W][W];
}
