/*
 * Converged references for thin shells of revolution under a pressure cos(n theta2): one
 * harmonic, one line of elements.
 */
#ifndef REVOLUTION_H
#define REVOLUTION_H

#include "scene.h"

/* What an end of the meridian lets go. */
typedef enum revolution_end { END_CLAMPED, END_DIAPHRAGM, END_SYMMETRIC, END_FREE } revolution_end;

typedef struct revolution {
    scene_surface surface;
    double theta1[2];          /* ends of the meridian */
    revolution_end end[2];
    int harmonic;              /* n >= 1 */
    double h;                  /* thickness; Young's modulus 1, Poisson's ratio .3 */
} revolution;

/*
 * Work of the pressure cos(n theta2), per reference area along e3, over the whole circle: the
 * compliance. A shell after Naghdi, shear stiffness G h, quadratic elements of reduced
 * integration. Returns 0 where memory is short.
 */
double revolution_compliance(const revolution *r);

/*
 * Deflection at the crest of a cylinder, radius 1, between diaphragms `length` apart under the
 * pressure cos(pi x/length) cos(n theta2), x from the middle: closed form, exact through the
 * thickness.
 */
double revolution_cylinder(int harmonic, double length, double h);

#endif
