/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stresses and strains of a solved structure, recovered from its displacement on the host.
 *
 * Strains and in-plane stresses are those of the element at its centre. The in-plane strains vary
 * linearly through the package (exactly in the metric of the shell). With the element option lin33
 * each ply thickens freely under one normal stress s; without the option the thickness strain is
 * linear, too. The transverse shear stresses and the normal stress 33 follow from the equilibrium
 * of the in-plane stresses through the thickness (stress_equilibrium.c). At large rotation the
 * strains are those of Green and Lagrange and the stresses the second ones of Piola and Kirchhoff,
 * in the directions of the undeformed shell.
 */
#ifndef STRESS_FIELD_H
#define STRESS_FIELD_H

#include <stdbool.h>
#include "design.h"

/* Heights in a layer at which stresses are recovered: its inner face, its middle, its outer face.
 */
enum { STRESS_HEIGHTS = 3 };
extern const char *const stress_height_name[STRESS_HEIGHTS];

/* Names of the six components of a stress or strain in the Voigt order: 11 22 33 23 13 12. */
enum { STRESS_COMPONENTS = 6 };
extern const char *const stress_component_name[STRESS_COMPONENTS];

/* Displacement of a solved structure, and the input values that belong to it. */
typedef struct stress_state {
    const design *design;
    const double *displacement; /* [free_dof] displacement vector of the structure */
    const double *input_value;  /* [inputs] voltages (V), load factors and temperatures (K) under
                                   which the displacement was computed */
    bool is_nonlinear; /* true: Green-Lagrange strains; false: strains linear in the displacement */
} stress_state;

/* State of one element at its centre. */
typedef struct stress_element {
    double place[3];   /* position of the centre on the reference surface (scene unit of length) */
    double axis[3][3]; /* unit vectors of the shell axes 1, 2, 3, from which ply angles count */
    double strain[10]; /* strains in the order of pzs_element_type.d (1) */
    double resultant[10];  /* stress resultants conjugate to the strains, per area (N/m) */
    double normal_stress;  /* normal stress 33 that all plies share (Pa) */
    double temperature[2]; /* temperatures of the inner and of the outer face of the package (K) */
} stress_element;

/* Stress and strain at one height of a layer, in the axes of the layer's material. */
typedef struct stress_point {
    double strain[STRESS_COMPONENTS]; /* engineering strains in Voigt order (1) */
    double stress[STRESS_COMPONENTS]; /* stresses in Voigt order (Pa) */
} stress_point;

/* Results of one layer at the centre of one element. */
typedef struct stress_layer {
    stress_point at[STRESS_HEIGHTS];
    double field;        /* electric field along e3 at the middle of the layer (V/m) */
    double displacement; /* electric displacement along e3 at the middle of the layer (C/m2) */
} stress_layer;

/* In-plane stresses 11 22 12 in the shell axes, shears 13 23 and normal stress 33 at one height. */
typedef struct stress_sample {
    double plane[3], shear[2], normal;
} stress_sample;

/*
 * Recovered stresses of a structure. Neighbours of an element are those that share a node with it,
 * have the same plies under the same voltages, and lie in about the same plane; gradients and
 * averages at nodes are formed among neighbours alone.
 */
typedef struct stress_field {
    stress_state state;
    int elements, layers;
    stress_element *element; /* [elements] state of each element at its centre */
    double *voltage;         /* [elements][layers] voltage across each layer (V); an electrode that
                                covers a part of an element counts by this part */
    stress_sample *sample; /* [elements][layers][STRESS_HEIGHTS] stresses in the shell axes; zero in
                              layers that are absent in an element */
    int *node_start;       /* [nodes + 1] first entry of each node in node_element */
    int *node_element;     /* elements that have each node as a corner, one node after the other */
} stress_field;

/*
 * Compute the states of the elements and their in-plane stresses; the transverse stresses of the
 * samples are not filled. The design and the arrays of the state must outlive the field. Returns 0,
 * or -1 if memory runs out; the field must be freed in both cases.
 */
int stress_field_fill(stress_field *field, const stress_state *state);
void stress_free(stress_field *field);

/* Whether a layer is present in an element. */
bool stress_is_present(const stress_field *field, int element, int layer);

/* Results of a layer that is present at the centre of an element. */
void stress_layer_of(const stress_field *field, int element, int layer, stress_layer *result);

/* Height of a point of a layer above the reference surface; `height` is 0 (inner face) to 2. */
double stress_height(const stress_field *field, int layer, int height);

/* Whether two elements that share a node are neighbours (see stress_field). */
bool stress_are_neighbours(const stress_field *field, int first, int second);

/*
 * List the neighbours of an element, without the element itself.
 *   list [STRESS_NEIGHBOURS] out
 * Returns their number.
 */
enum { STRESS_NEIGHBOURS = 64 };
int stress_neighbours(const stress_field *field, int element, int list[STRESS_NEIGHBOURS]);

/* Position of the centre and shell axes (rows 1, 2, 3) of an element. */
void stress_axes(const mesh *mesh, int element, double place[3], double axis[3][3]);

#endif
