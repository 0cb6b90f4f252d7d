/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Transverse shear stiffness K of a laminate from equilibrium: the shear stresses tau balance the
 * change of the in-plane stresses where bending moments change along the plate.
 *   G(z) = -integral from the lower face to z of C (S_b + zeta S_d) dzeta,
 *   P = [[G(11; 11), G(12; 22)], [G(12; 11), G(22; 22)]],
 *   tau(z) = P(z) (V13, V23),
 *   K^-1 = integral over the thickness of P^T C_t^-1 P dz.
 *   K          shear stiffness (N/m); 5/6 of shear modulus times thickness for one isotropic ply
 *   V13, V23   transverse forces: change of moment 11 along direction 1, of moment 22 along 2
 *   G(i; j)    minus the stress i integrated up to z, per unit bending moment j
 *   C, C_t     plane stress stiffness and transverse shear stiffness of a ply (Pa)
 *   S_b, S_d   membrane strains and curvatures per bending moment (laminate_flexure)
 *   z, zeta    heights above the reference surface (m)
 * K of a soft core between stiff faces is that of the core alone.
 */
#ifndef LAMINATE_SHEAR_H
#define LAMINATE_SHEAR_H

/* Faces and stiffness of one ply that is present in a laminate. */
typedef struct shear_ply {
    double z[2]; /* heights of the lower and the upper face of the ply above the reference surface
                    (m) */
    const double (*c)[6]; /* [6][6] stiffness of the ply, Voigt order 11 22 33 23 13 12 (Pa) */
} shear_ply;

/*
 * Compute the membrane strains and curvatures per force and moment of a laminate: the inverse of
 * its stiffness matrix [[A, B], [B, D]] (membrane, coupling, bending) in the order 11 22 12, forces
 * before moments.
 *   flex  [6][6] out  this matrix
 * Returns 0, or -1 if the laminate has no bending stiffness.
 */
int laminate_flexure(const shear_ply *ply, int plies, double flex[6][6]);

/*
 * Compute the stiffness k of the transverse shears 13 and 23 (N/m) of plies that are listed from
 * the lower face to the upper one. Returns 0, or -1 if the laminate has no bending or shear
 * stiffness.
 */
int laminate_shear(const shear_ply *ply, int plies, double k[2][2]);

#endif
