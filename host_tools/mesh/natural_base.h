/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Base vectors of an element that does not lie along lines of curvature, in material axes whose
 * axis 3 is normal to the element. At height z they are the columns of base + z slope: 1 and 2
 * along the directions of the element, per unit of length; 3 is the director.
 */
#ifndef NATURAL_BASE_H
#define NATURAL_BASE_H

typedef struct natural_base {
    double base[3][3];  /* base vectors of the element in the reference surface, as columns
                           (dimensionless) */
    double slope[3][3]; /* change of the element's base vectors per unit of height, as columns (1/m)
                         */
} natural_base;

/* Return the area of an element at height z over its area in the reference surface. */
double natural_area_ratio(const natural_base *natural, double z);

/*
 * Compute the dual base vectors at height z, whose scalar products with the base vectors are 0 or 1
 * (dual [3][3] out, one vector in each row, in material axes). A gradient is the sum of its
 * derivatives along the base vectors times the dual vectors.
 */
void natural_dual_base(const natural_base *natural, double z, double dual[3][3]);

/*
 * Compute the matrix that maps strains E_ab in the base vectors a and b at height z to strains E_ij
 * in material axes:
 *   E_ij = sum over a and b of B_ai B_bj E_ab.
 *   B              inverse of the matrix of base vectors
 *   map [6][6] out  the matrix, Voigt order 11 22 33 23 13 12, engineering shears
 */
void natural_strain_map(const natural_base *natural, double z, double map[6][6]);

#endif
