/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stress resultants and electric charges of an element from its plies. The resultants are
 *   H = D E + H0.
 *   E   the ten strains 11m 11d 22m 22d 33m 33d 12m 12d 13 23 (m: mean of both faces, d:
 *       difference)
 *   D   stiffness of the element
 *   H0  prescribed resultants of voltages and temperatures
 * The charge of an electrode is its charge at zero strains minus H1^T E, where H1 are the
 * prescribed resultants of 1 V at this electrode.
 */
#ifndef LAMINATE_H
#define LAMINATE_H

#include <stdbool.h>
#include "../scene/scene.h"
#include "laminate_height.h"
#include "natural_base.h"

enum { LAMINATE_STRAINS = 10, LAMINATE_PACKED = 55, LAMINATE_LAYERS = 32 };

typedef struct laminate_ply {
    double z[2]; /* heights of the lower and the upper face of a ply above the reference surface (m)
                  */
    double c[6][6]; /* stiffness of a ply in the axes of the shell, Voigt order 11 22 33 23 13 12
                       (Pa) */
    double stress_per_voltage[6]; /* stress in a ply per volt across it, while its strains are zero
                                     (Pa/V), Voigt order 11 22 33 23 13 12 */
    double stress_per_kelvin[6];  /* stress in a ply per kelvin of temperature change, while its
                                     strains are zero (Pa/K), Voigt order 11 22 33 23 13 12 */
    double capacitance; /* charge of the upper electrode per volt and area while the strains are
                           zero (F/m2) */
    double pyroelectric_charge;  /* charge of the upper electrode per kelvin and area while the
                                    strains are zero (C/(m2 K)) */
    double density;              /* mass of a ply per volume (kg/m3) */
    double electrode_distance;   /* distance of the electrodes (m): thickness of the ply, or that
                                    of interdigitated electrodes on its faces */
    bool is_field_along_surface; /* whether the field of a voltage is along the surface
                                    (interdigitated electrodes) rather than along the normal */
    double stress_along[2][6]; /* stress in a ply of zero strains per electric field along axis 1 or
                                  2 of the shell (C/m2), Voigt order 11 22 33 23 13 12 */
    double permittivity_along[2][2]; /* permittivity tensor of a ply for electric fields along the
                                        axes 1 and 2 of the shell, at constant strain (F/m) */
    double pyroelectric_along[2];    /* electric displacement of a ply along the axes 1 and 2 of the
                                        shell per kelvin while the strains are zero (C/(m2 K)) */
} laminate_ply;

typedef struct laminate {
    int plies;
    laminate_ply ply[LAMINATE_LAYERS];
    double z[2]; /* heights of the lower and the upper face of all plies together above the
                    reference surface (m) */
    double thickness;
} laminate;

/*
 * Plies that are present in an element, and its geometry for the stiffness. Along lines of
 * curvature, a base vector at height z is (1 + k z) times that of the reference surface, with the
 * principal curvature k along it; for other elements the member `natural` gives the base vectors.
 */
typedef struct laminate_place {
    uint32_t present_plies; /* plies that are present in the element, at least in a part of it: bit
                               i is set for ply i */
    double absent[LAMINATE_LAYERS]; /* for each present ply the fraction of the area of the element
                                       that it does not cover (smeared_plies.h): above 0 where a
                                       patch with smeared stiffness ends within the element */
    double curvature[2]; /* principal curvatures of the element along its directions 1 and 2 (1/m)
                          */
    double chord[2]; /* lengths of the element along its directions 1 and 2 (m), used for the shear
                        flexibility */
    double area;
    double bubble_share; /* factor (0 to 1) of the flexibility that the element option `rho` adds to
                            the transverse shears: 1 on an element along lines of curvature, smaller
                            on thin elements of an irregular mesh */
    double skew[2];      /* skew alpha_1, alpha_2 of the element: its area per unit of the natural
                            coordinates varies as 1 + alpha_1 xi2 + alpha_2 xi1 */
    bool is_general;     /* true: the element does not lie along lines of curvature */
    natural_base natural; /* base vectors at any height of an element that does not lie along lines
                             of curvature */
} laminate_place;

/*
 * Return the fraction of the area of an element in which a ply is present: 0 where it is absent, 1
 * where it is present everywhere.
 */
double laminate_cover(const laminate_place *place, int ply);

/*
 * Build the plies of a scene's layers. Returns 0, or -1 with error filled if the stiffness of a
 * material is not positive definite.
 */
int laminate_build(const scene *scene, laminate *laminate, char *error);

/* Compute how the in-plane strains of an element depend on the height (laminate_height.h). */
void laminate_heights_of(const laminate *laminate, const scene_element *element,
                         const laminate_place *place, laminate_heights *heights);

/*
 * Return the area of an element at height z over its area in the reference surface; 1 if the
 * scene's element option `metric` is off.
 */
double laminate_area_ratio(const scene_element *element, const laminate_place *place, double z);

/*
 * Compute the matrix that maps the strains of an element at height z to strains in the axes of the
 * shell. The strains of the element are measured along the directions of the element.
 *   map [6][6] out  the matrix, Voigt order 11 22 33 23 13 12, engineering shears
 */
void laminate_strain_map(const scene_element *element, const laminate_place *place, double z,
                         double map[6][6]);

/*
 * Compute the stiffness matrices of an element in its four strain modes, each times a factor from
 * the integral of the strain energy over the element (xi1, xi2: natural coordinates, -1 to 1):
 *   00  constant strains                  area
 *   01  strains proportional to xi2       area/(3 - alpha_1^2)
 *   10  strains proportional to xi1       area/(3 - alpha_2^2)
 *   11  strains proportional to xi1 xi2   area/9
 *   alpha           in   skew of the element, in laminate_place
 *   packed [4][55]  out  lower triangles of the matrices (N m) for the ten strains, packed by rows
 * Returns 0, or -1 if no ply is present.
 */
int laminate_modes(const laminate *laminate, const scene_element *element,
                   const laminate_place *place, double packed[4][LAMINATE_PACKED]);

/*
 * Type of a prescribed field in a ply: a temperature of this ply alone, one volt across the ply, or
 * an electric field along the axis 1 or 2 of the shell.
 */
typedef enum laminate_axis {
    LAMINATE_HEATED_PLY = -1,
    LAMINATE_ACROSS,
    LAMINATE_ALONG_1,
    LAMINATE_ALONG_2
} laminate_axis;

/*
 * Field that acts in a laminate. For ply >= 0 the field acts in the ply of this index alone: 1 V
 * across the ply, 1 K, or an electric field along the surface. For ply < 0 it is a temperature of
 * all plies.
 */
typedef struct laminate_field {
    int ply;
    double temperature[2]; /* temperature of the inner and of the outer face of the laminate (K),
                              for a field that is a temperature of all plies (member ply < 0) */
    int axis; /* constant of laminate_axis that tells whether the field in the ply is a temperature,
                 a voltage across it, or an electric field along axis 1 or 2 of the shell; not used
                 if `ply` is negative */
    double along[2]; /* electric field along the surface at the inner and at the outer face of the
                        ply (V/m), used if the prescribed field is an electric field along the
                        surface */
} laminate_field;

/*
 * Return the value of a field in an element at height z. For a temperature this is the temperature
 * (K), or 1 if one ply alone has it; for an electric field along the surface, the field (V/m). For
 * a voltage across a ply it is the electric field over its mean through the ply. This ratio is
 * inversely proportional to the area at height z, because the flux is constant.
 */
double laminate_field_at(const laminate *laminate, const scene_element *element,
                         const laminate_place *place, const laminate_field *field, double z);

/*
 * Compute the stress resultants that a field (voltage or temperature) prescribes in an element,
 * times the element's area. Where the field covers only a fraction of the element, the caller
 * multiplies by this fraction.
 *   h0  [10] out  resultants (N m) for the ten strains: mean and difference of both faces of 11,
 *       22, 33 and 12; then 13 and 23
 */
void laminate_resultants(const laminate *laminate, const scene_element *element,
                         const laminate_place *place, const laminate_field *field,
                         double h0[LAMINATE_STRAINS]);

/*
 * Compute the stress resultants of an element, times its area, while its strains are zero and one
 * volt acts across a ply, or for ply < 0 a uniform temperature of 1 K.
 *   h0 [10] out  resultants (N m) for the ten strains: mean and difference of both faces of 11, 22,
 *       33 and 12; then 13 and 23
 */
void laminate_unit_resultants(const laminate *laminate, const scene_element *element,
                              const laminate_place *place, int ply, double h0[LAMINATE_STRAINS]);

/*
 * Return the charge of the upper electrode of a ply in an element under a field (voltage or
 * temperature) at zero strains (C). Where the ply covers only a part of the element, the caller
 * multiplies by the fraction that electrode and field cover.
 */
double laminate_charge(const laminate *laminate, const scene_element *element,
                       const laminate_place *place, int ply, const laminate_field *field);

/*
 * Return the charge that the field `second` causes on the electrode of the field `first`, in an
 * element at zero strains: capacitance (C/V), or charge per kelvin (C/K) where `second` is a
 * temperature. Where the fields cover only a fraction of the element, the caller multiplies by the
 * fraction common to both.
 *   first      in  electric field in a ply
 *   second     in  electric field in the same or another ply, or a temperature
 *   is_uniform in  true: both fields are constant over the element. false: both vary over it with
 *                  the mean 0. The correction for an element that is softer in transverse shear
 *                  than its material, which applies to constant fields only, is then left out
 */
double laminate_capacitance(const laminate *laminate, const scene_element *element,
                            const laminate_place *place, const laminate_field *first,
                            const laminate_field *second, bool is_uniform);

#endif
