/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Transverse shear stiffness of a laminate from equilibrium.
 *
 * The plies are in plane stress and bend. Where a bending moment changes along the plate, the
 * in-plane stresses change too, and transverse shear stresses tau = (tau13, tau23) balance this
 * change. Two changes are considered: that of the moment 11 along direction 1, which is the
 * transverse force V13, and that of the moment 22 along direction 2, which is V23. Equilibrium of
 * the stresses between the lower face and height z gives tau as a function of V = (V13, V23):
 *   G(z) = -integral from the lower face to z of C (S_b + zeta S_d) dzeta,
 *   tau(z) = P(z) V,  P = [[G(11; 11), G(12; 22)], [G(12; 11), G(22; 22)]].
 * The 3 x 3 matrix G has the in-plane stresses integrated up to z, with a changed sign, per unit
 * bending moment: G(i; j) is its entry for stress i and moment j. C is the plane stress stiffness
 * of a ply, and zeta the height. S_b and S_d (3 x 3) are the membrane strains and the curvatures
 * per bending moment: blocks of the inverse of the laminate's stiffness matrix [[A, B], [B, D]]
 * (membrane, coupling, bending). The shear stiffness K (N/m) follows from the work of tau:
 *   K^-1 = integral over the thickness of P^T C_t^-1 P dz,
 * with the transverse shear stiffness C_t of a ply.
 *
 * One isotropic ply has K = 5/6 of its shear modulus times its thickness. The stiffness of a soft
 * core between stiff faces is that of the core alone. A shear strain that is constant through the
 * thickness would give the mean of all moduli instead.
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
