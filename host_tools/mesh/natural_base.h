/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Base vectors of an element that does not lie along lines of curvature, in material axes (axis 3
 * normal to the element): at height z, the columns of base + z slope. Columns 1 and 2 belong to the
 * element's two directions, per unit of its length along them; column 3 is the director.
 */
#ifndef NATURAL_BASE_H
#define NATURAL_BASE_H

typedef struct natural_base {
    double base[3][3];  /* base vectors in the reference surface (1) */
    double slope[3][3]; /* their change with the height (1/m) */
} natural_base;

/* Area at height z over that of the reference surface. */
double natural_area_ratio(const natural_base *natural, double z);

/*
 * Strains in material axes from strains in the base vectors at height z: t [6][6], Voigt order 11
 * 22 33 23 13 12, engineering shears. With b the inverse of the base, e_ij = sum_ab b_ai b_bj E_ab.
 */
void natural_strain_map(const natural_base *natural, double z, double map[6][6]);

#endif
