/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stresses and strains of a solved structure at the centres of its elements, recovered from its
 * displacement on the host. At large rotations they are Green's strains and second Piola-Kirchhoff
 * stresses, in the directions of the undeformed shell.
 *   in-plane strains   linear through the thickness, with the exact lengths at each height of a
 *       curved shell. Strains of cross-sections that shear bends are added (stress_warp.h). With
 *       linear kinematics, the displacement is corrected for them (stress_corrected.h)
 *   thickness strain   linear; with the element option lin33 the one of each ply under a normal
 *       stress 33 that all plies share
 *   shear and normal stresses 13, 23, 33   from equilibrium (stress_equilibrium.c)
 */
#ifndef STRESS_FIELD_H
#define STRESS_FIELD_H

#include <stdbool.h>
#include "design.h"
#include "strain.h"

/*
 * Number of heights in a layer at which stresses are recovered: its inner face, its middle and its
 * outer face.
 */
enum { STRESS_HEIGHTS = 3 };
extern const char *const stress_height_name[STRESS_HEIGHTS];

/*
 * Number of components of a stress or strain, and their names in the Voigt order 11 22 33 23 13 12.
 */
enum { STRESS_COMPONENTS = 6 };
extern const char *const stress_component_name[STRESS_COMPONENTS];

/* Displacement of a solved structure, and the input values that belong to this displacement. */
typedef struct stress_state {
    const design *design;
    const double *displacement; /* [free_dof] displacement vector of the structure */
    const double *input_value;  /* [inputs] voltages (V), load factors and temperatures (K) under
                                   which the displacement was computed */
    bool is_nonlinear; /* true: strains are those of Green and Lagrange; false: strains are linear
                          in the displacement */
} stress_state;

/* State of one element at its centre: position, shell axes, strains and stress resultants. */
typedef struct stress_element {
    double place[3]; /* position of the centre of the element on the reference surface (length unit
                        of the scene file) */
    double axis[3][3]; /* unit vectors of the shell axes 1, 2 and 3 as rows; ply angles count from
                          axis 1 */
    double strain[STRAIN_COUNT]; /* strains of the element at its centre, in the order of
                                    STRAIN_COUNT */
    double resultant[10];  /* stress resultants conjugate to the strains of the element (mean and
                              difference of both faces for the strains 11, 22, 33 and 12; then the
                              strains 13 and 23), per area of the element (N/m) */
    double normal_stress;  /* normal stress 33 that all plies of the element share (Pa) */
    double temperature[2]; /* temperature changes of the inner and of the outer face of the laminate
                              (K) */
} stress_element;

/* Stress and strain at one height of a layer, in the material axes of the layer. */
typedef struct stress_point {
    double strain[STRESS_COMPONENTS]; /* engineering strains of the layer in the order 11 22 33 23
                                         13 12 (dimensionless) */
    double stress[STRESS_COMPONENTS]; /* stresses of the layer in the order 11 22 33 23 13 12 (Pa)
                                       */
} stress_point;

/* Stresses, strains and electric quantities of one layer at the centre of one element. */
typedef struct stress_layer {
    stress_point at[STRESS_HEIGHTS];
    double field; /* electric field at the middle of the layer (V/m): along the normal, or along the
                     poling between interdigitated electrodes */
    double displacement; /* electric displacement along the electric field at the middle of the
                            layer (C/m2) */
} stress_layer;

/*
 * Stresses at one height of a layer in the shell axes of the element: in-plane stresses 11 22 12,
 * transverse shear stresses 13 23, normal stress 33 (Pa).
 */
typedef struct stress_sample {
    double plane[3], shear[2], normal;
    double warp[3];    /* in-plane strains 11 22 12 (twice the tensor's) of bent cross-sections,
                          which `plane` contains (stress_warp.h) */
    double squeeze[3]; /* part of the in-plane stresses 11 22 12 in `plane` that exists because the
                          recovered normal stress 33 differs from `own_normal`, that of the element
                          (stress_warp.h; Pa) */
    /*
     * in-plane stresses 11 22 12 (Pa) that the elements cannot represent. They arise because
     * cross-sections do not stay straight and the normal stress 33 varies over the thickness. The
     * displacement is not yet corrected for them
     */
    double lacking[3];
    double balanced[3]; /* in-plane stresses 11 22 12 (Pa) that the elements cannot represent, as an
                           earlier computation of the stresses found them (its member `lacking`).
                           The displacement of the structure has been corrected for them since
                           (stress_corrected.h) */
    double own_normal;  /* normal stress 33 of the element at this height (Pa) */
    double thickening;  /* thickness strain 33 at this height while the normal stress 33 is
                           `own_normal` and the strains `warp` of bent cross-sections are 0 */
} stress_sample;

/*
 * Correction of a displacement for stresses that the elements cannot represent, such as those of
 * bent cross-sections (stress_corrected.h). All members are 0 if there is no correction.
 */
typedef struct stress_correction {
    double *displacement;    /* [free_dof] corrected displacement, to which the stresses belong */
    double (*resultant)[10]; /* [elements] stress resultants that the correction adds to those of
                                each element, in the order of its ten strains (N/m) */
    double (*lacking)[3]; /* [elements][layers][STRESS_HEIGHTS] in-plane stresses 11 22 12 that an
                             earlier recovery found the elements to leave out, and for which the
                             displacement was corrected (Pa) */
    double *electric;     /* [elements][layers] electric displacement of the layers before the
                             correction; the charges of the electrodes are its integrals (C/m2)
                           */
} stress_correction;

/*
 * Recovered stresses of a structure. Two elements are neighbours if they share a node, have equal
 * plies under equal voltages and heaters, and no fold lies between them. Gradients of stresses, and
 * averages at nodes, are formed only among neighbours.
 */
typedef struct stress_field {
    stress_state state;
    int elements, layers;
    stress_element *element; /* [elements] position, axes, strains and stress resultants of each
                                element at its centre */
    double *voltage; /* [elements][layers] voltage of the electrodes across each layer (V): mean
                        over the part of the element in which the layer is present, with 0 V where
                        no electrode covers it */
    double *heat; /* [elements][layers] temperature change of each layer by heaters on its patches
                     (K): mean over the part of the element in which the layer is present, with 0 K
                     where no heater covers it */
    stress_sample *sample; /* [elements][layers][STRESS_HEIGHTS] stresses in the shell axes; zero in
                              layers that are absent in the element */
    int *node_start; /* [nodes + 1] index in node_element at which the list of elements of each node
                        begins */
    int *node_element;  /* numbers of the elements that have a node as a corner: the list of node 0,
                           then that of node 1, and so on */
    double bend_share;  /* ratio of in-plane stresses: change of the stresses when bent
                           cross-sections are computed for the first time, over the stresses of
                           straight cross-sections (stress_warp.h) */
    double bend_change; /* ratio of two changes of the in-plane stresses, when bent cross-sections
                           are computed twice: the change by the second computation over the change
                           by the first (stress_warp.h) */
    bool is_straight;   /* whether the stresses are those of straight cross-sections, because the
                           strains of bent ones did not converge (stress_warp.h) */
    bool has_squeeze; /* whether the in-plane stresses contain what the recovered normal stress 33,
                         which varies over the thickness, adds to them by Poisson's effect */
    stress_correction correction; /* correction of the displacement for assumptions of the elements,
                                     such as straight cross-sections; all members are 0 if there is
                                     no correction */
    double theory_error; /* estimated error of the displacement from assumptions of the elements,
                            such as straight cross-sections: largest change of the displacement at a
                            node by the correction, over the largest displacement; 0 where the
                            correction was not computed */
} stress_field;

/*
 * Compute the strains and resultants of all elements and the in-plane stresses of their layers
 * (stress_equilibrium computes the other stresses). The field keeps pointers into `state`.
 *   correction in  correction of the displacement, whose arrays the field then owns; NULL: none
 * Returns 0, or -1 if memory runs out; call stress_free in both cases.
 */
int stress_field_fill(stress_field *field, const stress_state *state,
                      const stress_correction *correction);
void stress_free(stress_field *field);

/* Return whether a layer is present in an element. */
bool stress_is_present(const stress_field *field, int element, int layer);

/*
 * Compute the stresses, strains and electric quantities of a layer that is present in an element,
 * at the centre of the element.
 */
void stress_layer_of(const stress_field *field, int element, int layer, stress_layer *result);

/*
 * Compute the transverse shear strains 13 and 23 (twice the tensor's) of a layer that is present in
 * an element at one of its heights, in the shell axes, from the shear stresses there.
 */
void stress_shear_strains(const stress_field *field, int element, int layer, int height,
                          double strain[2]);

/*
 * Return the height of a point of a layer above the reference surface (m); `height` is 0 at the
 * inner face, 1 at the middle and 2 at the outer face of the layer.
 */
double stress_height(const stress_field *field, int layer, int height);

/*
 * Return whether two elements that share a node are neighbours: they have equal plies under equal
 * voltages, and no fold lies between them.
 */
bool stress_are_neighbours(const stress_field *field, int first, int second);

/*
 * List the neighbours of an element: the elements that share a node with it, have equal plies under
 * equal voltages, and are not separated from it by a fold.
 *   list [STRESS_NEIGHBOURS] out  numbers of the neighbouring elements
 * Returns the number of neighbours.
 */
enum { STRESS_NEIGHBOURS = 64 };
int stress_neighbours(const stress_field *field, int element, int list[STRESS_NEIGHBOURS]);

#endif
