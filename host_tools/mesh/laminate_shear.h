/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Transverse shear stiffness of a laminate from equilibrium.
 *
 * The plies are in plane stress and bend; the transverse shear stresses follow from the change of
 * the in-plane stresses along the plate, and the stiffness from their work:
 *   G(z) = -integral from z- to z of Q (S_b + zeta S_d) dzeta,
 *   tau(z) = P(z) (Q13, Q23),  P = [[G_11,11, G_12,22], [G_12,11, G_22,22]],
 *   K^-1 = integral of P^T C_t^-1 P dz,
 * with Q the plane stress stiffness of a ply, C_t its transverse shear stiffness, and S_b, S_d the
 * blocks of the inverse of [[A, B], [B, D]] that give the strains of a bending moment. One
 * isotropic ply has K = 5/6 G h. A soft core between stiff faces has the stiffness of its own
 * shear, where a shear strain that is constant through the thickness gives the mean of the moduli.
 */
#ifndef LAMINATE_SHEAR_H
#define LAMINATE_SHEAR_H

/* One ply that is present. */
typedef struct shear_ply {
    double z[2];          /* lower and upper face */
    const double (*c)[6]; /* [6] stiffness, Voigt order 11 22 33 23 13 12 */
} shear_ply;

/*
 * Strains and curvatures per force and moment, the inverse of [[A, B], [B, D]], order 11 22 12.
 *   flex [6][6] out
 * Returns 0, or -1 where the laminate has no bending stiffness.
 */
int laminate_flexure(const shear_ply *ply, int plies, double flex[6][6]);

/*
 * Shear stiffness k of 13 and 23 (N/m) of plies listed from the lower face on. Returns 0, or -1
 * where the laminate has no bending or shear stiffness.
 */
int laminate_shear(const shear_ply *ply, int plies, double k[2][2]);

#endif
