/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Largest stresses and strains of a structure, and reserve factors against the strengths of its
 * materials.
 */
#ifndef STRESS_SUMMARY_H
#define STRESS_SUMMARY_H

#include "stress_field.h"

/*
 * An extreme value, with the element, the layer and the height in the layer where it occurs. If no
 * value has been found, the member `element` is -1.
 */
typedef struct stress_extreme {
    double value;
    int element, layer, height; /* height in the layer at which the extreme value occurs: 0 inner
                                   face, 1 middle, 2 outer face */
} stress_extreme;

typedef struct stress_summary {
    stress_extreme stress[STRESS_COMPONENTS]; /* in the whole structure, the stress of largest
                                                 magnitude of each stress component (Pa) */
    stress_extreme strain[STRESS_COMPONENTS]; /* in the whole structure, the strain of largest
                                                 magnitude of each strain component (dimensionless)
                                               */
    stress_extreme mises[LAMINATE_LAYERS];    /* largest von Mises stress of each layer (Pa) */
    stress_extreme reserve[LAMINATE_LAYERS];  /* smallest reserve factor of each layer against the
                                                 strengths of its material, if the scene file gives
                                                 them (dimensionless) */
    stress_extreme field[LAMINATE_LAYERS];    /* largest electric field in each layer, by magnitude
                                                 (V/m) */
    stress_extreme field_reserve[LAMINATE_LAYERS]; /* smallest reserve factor of each layer against
                                                      the depolarisation field of its material
                                                      (dimensionless) */
} stress_summary;

/*
 * Find the extreme stresses, strains, electric fields and reserve factors over all elements, layers
 * and heights.
 */
void stress_summarise(const stress_field *field, stress_summary *summary);

/* Return whether every stress is 0, as in a structure that nothing loads. */
bool stress_is_zero(const stress_summary *summary);

/*
 * Return the von Mises stress of six stress components in Voigt order, a measure of the load on
 * layers of isotropic material (Pa).
 */
double stress_mises(const double stress[STRESS_COMPONENTS]);

/*
 * Return the reserve factor of a ply: multiplied by this factor, its in-plane stresses s would just
 * meet the strength criterion of its material. The factor is infinite without stress.
 *   Tsai-Hill       1/sqrt((s_11/X)^2 - s_11 s_22/X^2 + (s_22/Y)^2 + (s_12/S)^2)
 *   maximum stress  the least of X/|s_11|, Y/|s_22|, S/|s_12|
 *   X, Y            strengths along the material axes 1 and 2: in tension where the stress along
 *       the axis is positive, else in compression
 *   S               strength in shear
 */
double stress_reserve(const scene_strength *strength, const double stress[STRESS_COMPONENTS]);

/*
 * Compute how far each element is loaded, for the picture in a report: 1 over the smallest reserve
 * factor of its layers if a material of the scene has strengths, otherwise the largest von Mises
 * stress.
 *   value [elements] out  utilisation (dimensionless) or stress (Pa) of each element
 * Returns whether a material has strengths.
 */
bool stress_load(const stress_field *field, double *value);

/*
 * Stress resultants of an element in its shell axes: forces 11 22 12 (N/m), moments 11 22 12 about
 * the middle of the laminate (N), transverse shear forces 13 23 (N/m).
 */
enum { STRESS_RESULTANTS = 8 };
void stress_resultants(const stress_field *field, int element, double value[STRESS_RESULTANTS]);

#endif
