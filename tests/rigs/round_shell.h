/*
 * A thin cylinder in closed form, for tests of the element.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef ROUND_SHELL_H
#define ROUND_SHELL_H

/*
 * Deflection at the crest of a cylinder, radius 1, Young's modulus 1, Poisson's ratio .3, between
 * diaphragms `length` apart under the pressure cos(pi x/length) cos(n theta2), x from the middle:
 * a straight director and plane stress, exact through the thickness h. n >= 1
 */
double round_shell_crest(int harmonic, double length, double thickness);

#endif
