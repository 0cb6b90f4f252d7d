/* SPDX-License-Identifier: BSD-2-Clause */
/* Base vectors of any quadrilateral at a height (natural_base.h). */
#include "natural_base.h"

static double determinant(double j[3][3])
{
    return j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) -
           j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
           j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
}

/* b = inverse of j [3][3] */
static void inverse_base(double j[3][3], double b[3][3])
{
    const double size = determinant(j);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, a1 = (a + 1) % 3, a2 = (a + 2) % 3;
            b[a][i] = (j[i1][a1] * j[i2][a2] - j[i1][a2] * j[i2][a1]) / size;
        }
}

/* Base vectors at height z, the columns of j [3][3]. */
static void base_at(const natural_base *natural, double z, double j[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
            j[i][a] = natural->base[i][a] + z * natural->slope[i][a];
}

double natural_area_ratio(const natural_base *natural, double z)
{
    double at_z[3][3], at_0[3][3];
    base_at(natural, z, at_z);
    base_at(natural, 0, at_0);
    return determinant(at_z) / determinant(at_0);
}

void natural_strain_map(const natural_base *natural, double z, double t[6][6])
{
    static const int first[6] = {0, 1, 2, 1, 0, 0}, second[6] = {0, 1, 2, 2, 2, 1};
    double base[3][3], b[3][3];
    base_at(natural, z, base);
    inverse_base(base, b);
    for (int m = 0; m < 6; m++)
        for (int n = 0; n < 6; n++) {
            const int i = first[m], j = second[m], p = first[n], q = second[n];
            const double same = b[p][i] * b[q][j], crossed = b[q][i] * b[p][j];
            t[m][n] = (p == q ? same : (same + crossed) / 2) * (i == j ? 1 : 2);
        }
}
