/* SPDX-License-Identifier: BSD-2-Clause */
/* Part of the in-plane strains that is quadratic in the height (laminate_height.h). */
#include "laminate_height.h"
#include <math.h>
#include <string.h>
#include "invert.h"

/*
 * Compute the straight line a + b x that deviates least from x^2, where x is the height over the
 * thickness: s_0 a + s_1 b = s_2 and s_1 a + s_2 b = s_3 with the moments s_n, the integrals of
 * stiffness times x^n over the thickness.
 */
static void fit_line(const double moment[4], double *a, double *b)
{
    const double size = moment[0] * moment[2] - moment[1] * moment[1];
    *a = (moment[2] * moment[2] - moment[1] * moment[3]) / size;
    *b = (moment[0] * moment[3] - moment[1] * moment[2]) / size;
}

void height_fit_lines(const height_ply *ply, int plies, laminate_heights *heights)
{
    double moment[HEIGHT_ROWS][4] = {{0}};
    const double square = heights->thickness * heights->thickness;
    for (int layer = 0; layer < plies; layer++) {
        const double low = (ply[layer].z[0] - heights->middle) / heights->thickness,
                     high = (ply[layer].z[1] - heights->middle) / heights->thickness;
        for (int row = 0; row < HEIGHT_ROWS; row++)
            for (int n = 0; n < 4; n++)
                moment[row][n] +=
                    ply[layer].stiffness[row] * (pow(high, n + 1) - pow(low, n + 1)) / (n + 1);
    }
    for (int row = 0; row < HEIGHT_ROWS && plies > 0; row++) {
        fit_line(moment[row], &heights->line[0][row], &heights->line[1][row]);
        heights->line[0][row] *= square;
        heights->line[1][row] *= square;
    }
}

/*
 * Compute the matrices that give the quadratic part m of the in-plane strains e + z k + z^2 m at
 * height z from the strains e in the middle (z = 0) and their slopes k:
 *   m = with_slope k - with_mean e (vectors of the strains 11, 22, 12);
 *   m = (c' k + k c)/2 - c' e c (as symmetric 2 x 2 matrices).
 *   c           [2][2] in   change of the base vectors with the height (1/m); c' is its transpose
 *   with_slope  [3][3] out  factors of k
 *   with_mean   [3][3] out  factors of e
 * Valid for straight directors that stay normal to the surface.
 */
static void quadratic_of_middle(double c[2][2], double with_slope[3][3], double with_mean[3][3])
{
    const double slope[3][3] = {
        {c[0][0], 0, c[1][0] / 2},
        {0, c[1][1], c[0][1] / 2},
        {c[0][1], c[1][0], (c[0][0] + c[1][1]) / 2},
    };
    const double mean[3][3] = {
        {c[0][0] * c[0][0], c[1][0] * c[1][0], c[0][0] * c[1][0]},
        {c[0][1] * c[0][1], c[1][1] * c[1][1], c[0][1] * c[1][1]},
        {2 * c[0][0] * c[0][1], 2 * c[1][0] * c[1][1], c[0][0] * c[1][1] + c[1][0] * c[0][1]},
    };
    memcpy(with_slope, slope, sizeof slope);
    memcpy(with_mean, mean, sizeof mean);
}

/*
 * Compute the quadratic part m of the in-plane strains e + z k + z^2 m at height z (e: strains in
 * the middle, k: their slopes) from the mean and the difference of each strain at both faces. In
 * the middle m = S k - M e (quadratic_of_middle). As the line a + b z/thickness replaces z^2, mean
 * = e + a m and difference = thickness k + b m. This gives
 *   (1 + S b/thickness - M a) m = S difference/thickness - M mean
 *   with_slope [3][3] in  S (1/m)
 *   with_mean  [3][3] in  M (1/m2)
 */
static void solve_quadratic(laminate_heights *heights, double with_slope[3][3],
                            double with_mean[3][3])
{
    const double thickness = heights->thickness;
    double matrix[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix[i][j] = (i == j) + with_slope[i][j] * heights->line[1][j] / thickness -
                           with_mean[i][j] * heights->line[0][j];
    /*
     * The matrix to be inverted is nearly the unit matrix unless the shell is as thick as its
     * radius of curvature, so the inversion succeeds.
     */
    if (invert(&matrix[0][0], 3, 3) < 0)
        return;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) {
                heights->of_difference[i][j] += matrix[i][k] * with_slope[k][j] / thickness;
                heights->of_mean[i][j] -= matrix[i][k] * with_mean[k][j];
            }
}

void height_quadratic_part(double change[2][2], laminate_heights *heights)
{
    double with_slope[3][3], with_mean[3][3];
    quadratic_of_middle(change, with_slope, with_mean);
    solve_quadratic(heights, with_slope, with_mean);
}

double laminate_height_excess(const laminate_heights *heights, double z, int row)
{
    return z * z - heights->line[0][row] - heights->line[1][row] * z / heights->thickness;
}
