/* SPDX-License-Identifier: BSD-2-Clause */
/* Base vectors of a quadrilateral element at any height (natural_base.h). */
#include "natural_base.h"

static double determinant(double j[3][3])
{
    return j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) -
           j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
           j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
}

/* Compute the inverse of a 3x3 matrix whose columns are base vectors. */
static void inverse_base(double j[3][3], double inverse[3][3])
{
    const double size = determinant(j);
    for (int column = 0; column < 3; column++)
        for (int i = 0; i < 3; i++) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, a1 = (column + 1) % 3,
                      a2 = (column + 2) % 3;
            inverse[column][i] = (j[i1][a1] * j[i2][a2] - j[i1][a2] * j[i2][a1]) / size;
        }
}

/* Compute the base vectors of an element at height z, the columns of the 3x3 matrix j. */
static void base_at(const natural_base *natural, double z, double j[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int column = 0; column < 3; column++)
            j[i][column] = natural->base[i][column] + z * natural->slope[i][column];
}

double natural_area_ratio(const natural_base *natural, double z)
{
    double at_z[3][3], at_0[3][3];
    base_at(natural, z, at_z);
    base_at(natural, 0, at_0);
    return determinant(at_z) / determinant(at_0);
}

void natural_dual_base(const natural_base *natural, double z, double dual[3][3])
{
    double base[3][3];
    base_at(natural, z, base);
    inverse_base(base, dual);
}

void natural_strain_map(const natural_base *natural, double z, double map[6][6])
{
    static const int first[6] = {0, 1, 2, 1, 0, 0}, second[6] = {0, 1, 2, 2, 2, 1};
    double inverse[3][3];
    natural_dual_base(natural, z, inverse);
    for (int row = 0; row < 6; row++)
        for (int column = 0; column < 6; column++) {
            const int i = first[row], j = second[row], p = first[column], q = second[column];
            const double same = inverse[p][i] * inverse[q][j],
                         crossed = inverse[q][i] * inverse[p][j];
            const double term = p == q ? same : (same + crossed) / 2;
            map[row][column] = i == j ? term : 2 * term;
        }
}
