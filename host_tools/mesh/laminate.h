/*
 * A package of plies to the element's resultants: H = D E + H0 in the ten strains
 * 11m 11d 22m 22d 33m 33d 12m 12d 13 23, m the mean and d the difference of the faces; and the
 * charge of its electrodes: -H0 E of a volt, and what flows while the strains E are held.
 */
#ifndef LAMINATE_H
#define LAMINATE_H

#include "../scene/scene.h"

enum { LAMINATE_STRAINS = 10, LAMINATE_PACKED = 55, LAMINATE_LAYERS = 32 };

typedef struct laminate_ply {
    double z[2];                  /* lower and upper face above the reference surface */
    double c[6][6];               /* stiffness in the shell's axes, Voigt order 11 22 33 23 13 12 */
    double stress_per_voltage[6]; /* given stress per volt across the ply */
    double stress_per_kelvin[6];  /* given stress per kelvin (negative of the stress of a held ply's
                                   * expansion)
                                   */
    double capacitance;           /* charge of the held ply's upper electrode per volt and area */
    double pyroelectric_charge;   /* and per kelvin and area */
    double density;               /* density */
} laminate_ply;

typedef struct laminate {
    int plies;
    laminate_ply ply[LAMINATE_LAYERS];
    double z[2]; /* faces of the package */
    double thickness;
} laminate;

/* Where a package lies: which of its plies are there, and how the surface bends. */
typedef struct laminate_place {
    uint32_t present_plies; /* bit i: ply i is there, else void */
    double k[2];            /* curvatures, for the exact metric */
    double chord[2];        /* element's lengths along theta1, theta2, for the shear flexibility */
    double area;
} laminate_place;

/* Plies of a scene. Returns 0, or -1 with error filled (stiffness not positive definite). */
int laminate_build(const scene *scene, laminate *laminate, char *error);

/*
 * D of the four modes times area/3^(r1+r2), packed lower triangles. d [4][55] out.
 * Returns 0, or -1 where nothing is present.
 */
int laminate_modes(const laminate *laminate, const scene_element *element,
                   const laminate_place *place, double d[4][LAMINATE_PACKED]);

/* A field that is given: a volt across a ply, or where ply < 0 a temperature, linear between the
 * faces. */
typedef struct laminate_field {
    int ply;
    double temperature[2]; /* inner, outer face */
} laminate_field;

/* H0 of the stresses of a field, times area. h0 [10] out. */
void laminate_resultants(const laminate *laminate, const scene_element *element,
                         const laminate_place *place, const laminate_field *field,
                         double h0[LAMINATE_STRAINS]);

/* The same for a volt across a ply, or a uniform kelvin where ply < 0. */
void laminate_unit_resultants(const laminate *laminate, const scene_element *element,
                              const laminate_place *place, int ply, double h0[LAMINATE_STRAINS]);

/*
 * Charge that a field draws to the upper electrode of a ply while the strains are held, times area.
 * The charge of an electrode is this less H0 of its volt times the strains of mode 00.
 */
double laminate_charge(const laminate *laminate, const scene_element *element,
                       const laminate_place *place, int ply, const laminate_field *field);

#endif
