/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * In-plane stresses that the straight cross-sections and the one normal stress 33 of the elements
 * leave out.
 *   bent cross-sections  The shear strains g_a3 of the plies and the gradient of their rise w_3
 *       displace a cross-section by w_a(z), where shells with straight cross-sections have a line
 *       in z (the line that has the same work with forces and moments is subtracted):
 *         c_a (w_a/c_a),z = g_a3 - w_3,a/c_a       w_3,z = e_33
 *         e_ab = (w_a,b/c_b + w_b,a/c_a)/2, and e_aa contains k_a w_3/c_a
 *   normal stress 33     At unchanged strains it causes the stress c_ab33/c_3333 s_33.
 * Without a corrected displacement (stress_corrected.h) the second part and the rise are left out,
 * and membrane strains and curvatures are added that keep the resultants of the element. With it
 * the resultants of both parts belong to the equilibrium of the structure, and only what is left of
 * them is so removed.
 *
 * The shear stresses follow from equilibrium with the in-plane stresses (stress_equilibrium.h),
 * which change: the strains are computed, then the transverse stresses, then the strains once more
 * (Noor, Burton and Peters 1990). Further transverse stresses would contain higher derivatives than
 * a mesh has.
 *   c_a, k_a  lengths along direction a over those in the reference surface, principal curvature
 */
#ifndef STRESS_WARP_H
#define STRESS_WARP_H

#include "stress_field.h"

/*
 * Add these stresses to the recovered ones, whose transverse stresses are known, and compute the
 * transverse stresses anew. Where the second change of the in-plane stresses, relative to the first
 * one (bend_change), exceeds a limit, as in a soft core whose faces bend by themselves, the
 * stresses remain those of straight cross-sections (is_straight). Returns 0, or -1 if memory runs
 * out.
 */
int stress_warp(stress_field *field);

/*
 * Return the largest ratio of the second to the first change of the in-plane stresses with which
 * stresses of bent cross-sections are added: 1/2, or 1/3 with a corrected displacement, which
 * contains higher derivatives with larger errors at edges.
 */
double stress_bend_limit(const stress_field *field);

#endif
