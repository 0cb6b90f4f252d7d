/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Bending and transverse shear stiffnesses by which the influence of shear on a laminate is judged
 * (laminate_bending.h).
 */
#include "laminate_bending.h"
#include <math.h>
#include <string.h>
#include "laminate_shear.h"

/*
 * Largest ratio of a ply's transverse shear modulus to the largest shear modulus in the laminate at
 * which the ply counts as a soft core.
 */
static const double soft_part = 0.1;

/*
 * Return the plane stress modulus of a ply along its axis 1 while the strain along axis 2 is 0
 * (Pa).
 */
static double plane_modulus(const laminate_ply *ply)
{
    return ply->c[0][0] - ply->c[0][2] * ply->c[0][2] / ply->c[2][2];
}

static void add_plies(const laminate *laminate, laminate_bending *bending)
{
    double largest = 0, faces = 0;
    int has_core = 0;
    for (int layer = 0; layer < laminate->plies; layer++)
        largest = fmax(largest, laminate->ply[layer].c[4][4]);
    for (int layer = 0; layer < laminate->plies; layer++) {
        const laminate_ply *ply = &laminate->ply[layer];
        const double thickness = ply->z[1] - ply->z[0];
        const int is_soft = ply->c[4][4] < soft_part * largest;
        bending->constant += ply->c[4][4] * thickness;
        has_core |= is_soft;
        if (!is_soft)
            faces += plane_modulus(ply) * thickness * thickness * thickness / 12;
    }
    bending->faces = has_core ? faces : 0;
}

int laminate_bending_fill(const laminate *laminate, laminate_bending *bending)
{
    shear_ply ply[LAMINATE_LAYERS];
    double k[2][2], flex[6][6];
    memset(bending, 0, sizeof *bending);
    for (int layer = 0; layer < laminate->plies; layer++) {
        memcpy(ply[layer].z, laminate->ply[layer].z, sizeof ply[layer].z);
        ply[layer].c = laminate->ply[layer].c;
    }
    if (laminate_flexure(ply, laminate->plies, flex) < 0 ||
        laminate_shear(ply, laminate->plies, k) < 0)
        return -1;
    add_plies(laminate, bending);
    bending->bending = 1 / flex[3][3];
    bending->shear = k[0][0];
    return 0;
}
