/* SPDX-License-Identifier: BSD-2-Clause */
/* Largest stresses and strains of a structure, and reserve factors against its strengths. */
#ifndef STRESS_SUMMARY_H
#define STRESS_SUMMARY_H

#include "stress_field.h"

/* A value and the place where it was found; the member `element` is -1 where there is no value. */
typedef struct stress_extreme {
    double value;
    int element, layer, height; /* height in the layer: 0 inner face, 1 middle, 2 outer face */
} stress_extreme;

typedef struct stress_summary {
    stress_extreme stress[STRESS_COMPONENTS]; /* stress of largest magnitude of each component (Pa)
                                               */
    stress_extreme strain[STRESS_COMPONENTS]; /* strain of largest magnitude of each component (1)
                                               */
    stress_extreme mises[LAMINATE_LAYERS];    /* largest von Mises stress of each layer (Pa) */
    stress_extreme reserve[LAMINATE_LAYERS]; /* smallest reserve factor of each layer whose material
                                                has strengths (1) */
    stress_extreme field[LAMINATE_LAYERS];   /* electric field of largest magnitude in each layer
                                              * (V/m)
                                              */
    stress_extreme field_reserve[LAMINATE_LAYERS]; /* smallest reserve factor of each layer against
                                                      the depolarisation field of its material (1)
                                                    */
} stress_summary;

/* Find the extremes over all elements, layers and heights. */
void stress_summarise(const stress_field *field, stress_summary *summary);

/* Von Mises stress of six stresses in Voigt order, as a measure of the load on isotropic layers. */
double stress_mises(const double stress[STRESS_COMPONENTS]);

/*
 * Reserve factor: the number by which all stresses of a ply may be multiplied before the criterion
 * of its material is met, from its in-plane stresses in material axes. Infinite without stress.
 * With X, Y the strengths under tension or compression along 1 and 2 and S that under shear:
 *   Tsai-Hill       1/sqrt((s_11/X)^2 - s_11 s_22/X^2 + (s_22/Y)^2 + (s_12/S)^2)
 *   maximum stress  the least of X/|s_11|, Y/|s_22|, S/|s_12|
 */
double stress_reserve(const scene_strength *strength, const double stress[STRESS_COMPONENTS]);

/*
 * Reserve factor against depolarisation: depolarisation field over the field against the poling.
 * Infinite for a field along the poling, and for a material without a limit.
 *   field in  electric field along e3 (V/m)
 */
double stress_field_reserve(const design *design, int layer, double field);

/*
 * Load on each element in the picture of a report: with strengths one over the smallest reserve
 * factor of its layers, else the largest von Mises stress (value [elements] out). Returns whether a
 * material has strengths.
 */
bool stress_load(const stress_field *field, double *value);

/*
 * Resultants of an element in the shell axes: forces 11 22 12 (N/m), moments 11 22 12 about the
 * middle of the package (N), transverse forces 13 23 (N/m).
 */
enum { STRESS_RESULTANTS = 8 };
void stress_resultants(const stress_field *field, int element, double value[STRESS_RESULTANTS]);

#endif
