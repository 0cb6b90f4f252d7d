/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Quadratic part of the in-plane strains e + z k + z^2 m of an element, at height z above the
 * middle of all plies. An element has only two numbers for each strain, its values at both faces,
 * so that a line a + b z/thickness replaces z^2. The element option `quadratic` chooses the line:
 *   on       least deviation from z^2, weighted with the stiffness of the plies: resultants are
 *       integrals of the stresses; one ply: a = thickness^2/12, b = 0
 *   off      a = thickness^2/4 and b = 0, exact at the faces
 *   omitted  a = b = 0: products of displacements have no part in m. The part of m that the
 *       curvature of the undeformed shell causes follows from e and k; z^2 times this part enters
 *       stiffness and prescribed stresses with `on`, too, less the line
 */
#ifndef LAMINATE_HEIGHT_H
#define LAMINATE_HEIGHT_H

enum { HEIGHT_ROWS = 3 }; /* number of in-plane strains: 11, 22 and 12 */

/*
 * Coefficients of the quadratic part m of the in-plane strains e + z k + z^2 m of a curved element,
 * at height z above the middle of all plies:
 *   m = of_mean mean + of_difference difference
 * with the mean of each strain over both faces and the difference between them. Valid while
 * directors stay nearly normal.
 */
typedef struct laminate_heights {
    double middle;               /* height of the middle of all plies above the
                                    reference surface (m) */
    double thickness;            /* thickness of all plies (m) */
    double line[2][HEIGHT_ROWS]; /* coefficients a and b (m2) of the straight line a + b z/thickness
                                    by which the element replaces z^2 in the strains 11, 22 and 12,
                                    because it has only two numbers for each strain */
    double of_mean[HEIGHT_ROWS][HEIGHT_ROWS]; /* coefficients m of z^2 in the strains 11, 22, 12
                                                 (rows) per mean strain of both faces (columns;
                                                 1/m2). They are 0 in a flat element. They are also
                                                 0 if one of the element options `quadratic` and
                                                 `metric` is off */
    double of_difference[HEIGHT_ROWS][HEIGHT_ROWS]; /* coefficients m of z^2 in the strains 11, 22,
                                                       12 (rows) per difference of the strain
                                                       between both faces (columns; 1/m2) */
} laminate_heights;

/* A ply: its heights and its stiffness against the in-plane strains. */
typedef struct height_ply {
    double z[2];                   /* heights of the two faces above the reference surface (m) */
    double stiffness[HEIGHT_ROWS]; /* stiffness against the strains 11, 22 and 12 while the normal
                                      stress 33 is 0 (Pa) */
} height_ply;

/*
 * The strains 11, 22 and 12 have a part proportional to the square of the height z. Compute for
 * each of them the straight line a + b z/thickness that comes closest to z^2 over the plies,
 * weighted by their stiffness (member `line`; element option `quadratic: on`). The members `middle`
 * and `thickness` must be set. Without plies `line` does not change.
 */
void height_fit_lines(const height_ply *ply, int plies, laminate_heights *heights);

/*
 * Compute the members of_mean and of_difference of laminate_heights. They give the coefficients of
 * z^2 in the in-plane strains (1/m2), per mean strain of both faces and per difference between
 * them. The member `line` must be set (height_fit_lines).
 *   change [2][2] in  change of the base vectors per height (1/m) in the middle of all plies: base
 *                     vector a changes by sum over c of change[c][a] times base vector c
 */
void height_quadratic_part(double change[2][2], laminate_heights *heights);

/*
 * Return z^2 less the straight line a + b z/thickness by which an element replaces z^2 in one of
 * its in-plane strains (m2). An element has only two numbers for each strain and cannot represent
 * z^2.
 *   z   in  height above the middle of all plies (m)
 *   row in  0, 1 or 2: strain 11, 22 or 12
 */
double laminate_height_excess(const laminate_heights *heights, double z, int row);

#endif
