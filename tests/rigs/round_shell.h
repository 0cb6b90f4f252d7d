/*
 * Closed-form deflection of a thin cylinder, for tests of the element.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef ROUND_SHELL_H
#define ROUND_SHELL_H

/*
 * Return the deflection at the crest of a cylinder (radius 1, Young's modulus 1, Poisson's ratio
 * 0.3) between diaphragms `length` apart, under the pressure cos(pi x/length) cos(harmonic theta2),
 * with x from the middle and harmonic >= 1. The director stays straight and the stress plane; the
 * integration over the thickness is exact.
 */
double round_shell_crest(int harmonic, double length, double thickness);

#endif
