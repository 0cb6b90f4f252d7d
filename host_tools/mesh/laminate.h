/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * From a package of plies to the resultants and charges of an element.
 *
 * The resultants are H = D E + H0 in the ten strains E = 11m 11d 22m 22d 33m 33d 12m 12d 13 23,
 * with m the mean and d the difference of the two faces. H0 are the prescribed resultants of
 * voltages and temperatures. The charge of an electrode is -H0 E for a unit of its voltage, plus
 * the charge drawn while the strains are zero.
 */
#ifndef LAMINATE_H
#define LAMINATE_H

#include <stdbool.h>
#include "../scene/scene.h"
#include "natural_base.h"

enum { LAMINATE_STRAINS = 10, LAMINATE_PACKED = 55, LAMINATE_LAYERS = 32 };

typedef struct laminate_ply {
    double z[2];                  /* lower and upper face, height above the reference surface */
    double c[6][6];               /* stiffness in the shell's axes, Voigt order 11 22 33 23 13 12 */
    double stress_per_voltage[6]; /* prescribed stress per volt across the ply */
    double stress_per_kelvin[6];  /* prescribed stress per kelvin: the negative of the stress of a
                                     ply whose expansion is prevented */
    double capacitance;         /* charge of the upper electrode per volt and area, strains zero */
    double pyroelectric_charge; /* charge of the upper electrode per kelvin and area, strains zero
                                 */
    double density;             /* mass per volume */
} laminate_ply;

typedef struct laminate {
    int plies;
    laminate_ply ply[LAMINATE_LAYERS];
    double z[2]; /* heights of the two faces of the package */
    double thickness;
} laminate;

/*
 * Position of a package: the plies present there, and the geometry of the element.
 *
 * On an element along lines of curvature the base vectors are (1 + k_a z) e_a, and the plies' axes
 * are those of the surface. Any other quadrilateral has a natural_base.
 */
typedef struct laminate_place {
    uint32_t present_plies; /* bit i is set where ply i is present */
    double k[2];            /* principal curvatures, for the exact metric */
    double chord[2]; /* lengths of the element along theta1, theta2, for the shear flexibility */
    double area;
    double bubble_share; /* part of the element option rho that is used; 1 along lines of curvature
                          */
    double skew[2];  /* alpha_1, alpha_2: the area varies as 1 + alpha_1 xi2 + alpha_2 xi1; 0 along
                        lines of curvature */
    bool is_general; /* not along lines of curvature */
    natural_base natural; /* base vectors of such an element */
} laminate_place;

/*
 * Build the plies of a scene. Returns 0, or -1 with error filled where a stiffness is not positive
 * definite.
 */
int laminate_build(const scene *scene, laminate *laminate, char *error);

/*
 * Area at height z over that of the reference surface; 1 where the scene's element has no metric.
 */
double laminate_area_ratio(const scene_element *element, const laminate_place *place, double z);

/*
 * Stiffness D of the four modes times area {1, 1/(3 - alpha_1^2), 1/(3 - alpha_2^2), 1/9}, as
 * packed lower triangles. d [4][55] out. Returns 0, or -1 where no ply is present.
 */
int laminate_modes(const laminate *laminate, const scene_element *element,
                   const laminate_place *place, double packed[4][LAMINATE_PACKED]);

/*
 * A prescribed field: one volt across a ply, or where ply < 0 a temperature that is linear between
 * the faces.
 */
typedef struct laminate_field {
    int ply;
    double temperature[2]; /* temperature of the inner and outer face, K */
} laminate_field;

/* Resultants H0 of the stresses of a field, times the element's area. h0 [10] out. */
void laminate_resultants(const laminate *laminate, const scene_element *element,
                         const laminate_place *place, const laminate_field *field,
                         double h0[LAMINATE_STRAINS]);

/*
 * Resultants H0, times the element's area, of one volt across a ply, or of a uniform temperature of
 * 1 K where ply < 0. h0 [10] out.
 */
void laminate_unit_resultants(const laminate *laminate, const scene_element *element,
                              const laminate_place *place, int ply, double h0[LAMINATE_STRAINS]);

/*
 * Charge, times the element's area, that a field draws to the upper electrode of a ply while the
 * strains are zero. The charge of an electrode is this less the product of H0 of its voltage and
 * the strains of mode 00.
 */
double laminate_charge(const laminate *laminate, const scene_element *element,
                       const laminate_place *place, int ply, const laminate_field *field);

#endif
