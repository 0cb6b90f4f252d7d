/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tools for the recovery of stresses: derivatives along the surface, formed from values at the
 * centres of neighbouring elements, and integrals through the thickness of an element.
 */
#ifndef STRESS_STENCIL_H
#define STRESS_STENCIL_H

#include "stress_field.h"

/* Largest number of heights at which an element has recovered stresses. */
enum { STENCIL_SAMPLES = LAMINATE_LAYERS * STRESS_HEIGHTS };

/*
 * Directions of principal curvature at the centre of an element, and the neighbouring elements from
 * which the gradients of the stresses along these directions are formed.
 */
typedef struct stencil {
    int element;
    double axis[2][3]; /* unit vectors along the two directions of principal curvature */
    double angle;      /* angle from shell axis 1 of the element to the first direction of principal
                          curvature (rad) */
    double k[2];       /* principal curvatures of the surface along their two directions (1/m) */
    int count; /* number of neighbouring elements from which the gradients of stresses are formed */
    int neighbour[STRESS_NEIGHBOURS];
    double turn[STRESS_NEIGHBOURS]; /* angle from the first direction of principal curvature to the
                                       shell axis 1 of each neighbouring element (rad) */
    double weight[STRESS_NEIGHBOURS][2]; /* [neighbouring element][direction] weights (1/m) that
                                            approximate the derivative of a quantity along a
                                            direction of principal curvature: the derivative is the
                                            sum of weight x (value at the neighbour - value at the
                                            element) */
} stencil;

/* Find the directions of principal curvature of an element, its neighbours and their weights. */
void stencil_find(const stress_field *field, int element, stencil *stencil);

/* Return the stresses of an element at all heights of all layers. */
stress_sample *stencil_samples(const stress_field *field, int element);

/*
 * Compute the factors c_1 and c_2 at a sample height: lengths along the two directions of principal
 * curvature at this height relative to lengths on the reference surface.
 */
void stencil_stretches(const stress_field *field, const stencil *stencil, int sample, double c[2]);

/*
 * Integrate values at the sample heights over the thickness of the laminate, from its inner face.
 * The integral is exact where the values are quadratic within each layer. Absent layers add
 * nothing.
 *   rate [samples] in   values to be integrated
 *   sum  [samples] out  integral from the inner face to each sample height
 */
void stencil_integrate(const stress_field *field, int element, const double *rate, double *sum);

/*
 * Compute the in-plane stresses 11, 22 and 12 of a ply at height z from the membrane strains and
 * curvatures of the laminate. The normal stress 33 is zero.
 *   bent [6] in  membrane strains 11 22 12, then curvatures 11 22 12 (1/m)
 */
void stencil_plane_stress(const laminate_ply *ply, const double bent[6], double z,
                          double stress[3]);

/*
 * Compute the membrane strains and curvatures that a unit of each force and moment causes in the
 * plies of an element. Returns 0, or -1 if the plies have no bending stiffness.
 */
int stencil_flexure(const stress_field *field, int element, double flex[6][6]);

/*
 * Compute the components 11, 22 and 12 of an in-plane stress in axes that are turned by an angle
 * (rad) against the axes of the given components.
 */
void stencil_turn_plane(const double stress[3], double angle, double turned[3]);

/*
 * Compute the components of an in-plane vector in axes that are turned by an angle (rad) against
 * the axes of the given components.
 */
void stencil_turn_vector(const double vector[2], double angle, double turned[2]);

/*
 * Compute in-plane strains 11, 22 and 12 (twice the tensor's) in the shell axes of an element from
 * those along its directions of principal curvature.
 */
void stencil_to_shell_axes(const stencil *stencil, const double principal[3], double own[3]);

#endif
