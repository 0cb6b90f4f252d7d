/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Part of the in-plane strains of an element that is quadratic in the height.
 *
 * The directors of a shell are straight, so that an in-plane strain at height z above the middle of
 * all plies is e + z k + z^2 m. An element has two numbers for each strain: the mean of its values
 * at both faces, and the difference between them. A straight line a + b z/thickness replaces z^2.
 * With the element option `quadratic` it is the line that deviates least from z^2, as a mean over
 * the thickness weighted with the stiffness of the plies in the direction of the strain: membrane
 * force and bending moment are then the integrals of the stresses. One homogeneous ply has a =
 * thickness^2/12 and stiff faces on a soft core have a = thickness^2/4. Without this option a =
 * thickness^2/4 and b = 0, which is exact at the faces.
 */
#ifndef LAMINATE_HEIGHT_H
#define LAMINATE_HEIGHT_H

enum { HEIGHT_ROWS = 3 }; /* number of in-plane strains: 11, 22 and 12 */

/*
 * Strains of an element over the height. In a curved element that is not deformed much, the part of
 * the strains that is quadratic in the height follows from two numbers for each strain, the mean of
 * its values at both faces and the difference between them: m = of_mean mean + of_difference
 * difference, in the order 11, 22, 12.
 */
typedef struct laminate_heights {
    double middle;                            /* height of the middle of all plies above the
                                                 reference surface (m) */
    double thickness;                         /* thickness of all plies (m) */
    double line[2][HEIGHT_ROWS];              /* factors a and b of the straight line that replaces
                                                 z^2 in each strain (m2) */
    double of_mean[HEIGHT_ROWS][HEIGHT_ROWS]; /* quadratic part per mean strain (1/m2); 0 where the
                                                 element is flat or lacks the option */
    double of_difference[HEIGHT_ROWS][HEIGHT_ROWS]; /* quadratic part per difference of the strain
                                                       between the faces (1/m2) */
} laminate_heights;

/* A ply: its heights and its stiffness against the in-plane strains. */
typedef struct height_ply {
    double z[2];                   /* heights of the two faces above the reference surface (m) */
    double stiffness[HEIGHT_ROWS]; /* stiffness against the strains 11, 22 and 12 while the normal
                                      stress 33 is 0 (Pa) */
} height_ply;

/*
 * Compute the straight lines that replace the squared height. The members `middle` and `thickness`
 * must be set. Without plies the lines stay as they are.
 */
void height_fit_lines(const height_ply *ply, int plies, laminate_heights *heights);

/*
 * Compute the quadratic part of the strains of a curved element; the straight lines must be set.
 *   change [2][2] in  change of the base vectors with the height (1/m), in terms of the base
 *                     vectors in the middle of all plies: base vector a changes by the sum over c
 *                     of change[c][a] times base vector c
 */
void height_quadratic_part(double change[2][2], laminate_heights *heights);

/*
 * Return the difference between the square of a height z above the middle of all plies and the
 * straight line that replaces it in strain 11, 22 or 12 (row 0, 1 or 2; m2).
 */
double laminate_height_excess(const laminate_heights *heights, double z, int row);

#endif
