/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Electric potentials of bare faces: faces of piezoelectric layers without an electrode. Each node
 * on a bare face has a potential, an input of the structure like the voltage of an open electrode,
 * with zero charge. The other face of a layer with one bare face is an electrode at 0 V.
 */
#ifndef BARE_FACES_H
#define BARE_FACES_H

#include "../mesh/mesh.h"
#include "../mesh/potential_element.h"

/*
 * Largest number of unknown electric potentials: one for each node of the bare faces (faces of a
 * layer without electrodes). Each potential costs a linear solve, and the matrix of their charges
 * per volt is dense.
 */
enum { BARE_POTENTIALS = 2000 };

/*
 * Potentials of the bare faces (faces of a layer without electrode) of a mesh, with tables for its
 * element types. A slot is a node on an interface between layers. Interface i lies between the
 * layers i - 1 and i; its slot at a node has the index i * nodes + node.
 */
typedef struct bare_faces {
    const mesh *mesh;
    int layers;
    const scene_layer *layer; /* [layers] layers of the scene */
    int first_input; /* index of the first of the structure's inputs that are electric potentials of
                        bare faces (without electrodes); these are the last inputs */
    int count;       /* number of potentials; 0: the scene has no bare faces (without electrodes) */
    int *number;  /* [(layers + 1) nodes] number of the potential of each slot (node on an interface
                     between layers), or -1 where the potential is 0 */
    size_t *slot; /* [count] slot (node on an interface between layers) of each electric potential
                   */
    double (*resultants)[POTENTIAL_NODES][LAMINATE_STRAINS]; /* [types][layers] stress resultants in
                                                                each element type per volt of each
                                                                potential of a layer; a layer has
                                                                eight potentials in an element, at
                                                                four corners of two faces */
    double (*capacitance)[POTENTIAL_NODES][POTENTIAL_NODES]; /* [types][layers][layers] capacitance
                                                                matrices [8][8] (C/V), one for each
                                                                element type and pair of layers:
                                                                charge at a nodal potential of the
                                                                first layer per volt of one of the
                                                                second. The eight potentials are
                                                                those of four corners on two faces
                                                              */
} bare_faces;

/*
 * Number the potentials of the bare faces (without electrodes) of a scene's layers. Where all faces
 * of a connected part are bare, the potential of its first node is 0. The mesh and the scene must
 * exist as long as the result. Returns 0, or -1 with error filled.
 */
int bare_faces_build(bare_faces *bare, const mesh *mesh, const scene *scene, char *error);

void bare_faces_free(bare_faces *bare);

/* Return whether a layer has a bare face (without electrode) and is present in an element. */
bool bare_faces_has(const bare_faces *bare, int layer, int element);

/*
 * Compute the stress resultants that 1 V of a potential at one node of a bare face (without
 * electrode) causes in an element, times the area of the element.
 *   h0 [10] out  resultants (N m), in the order of the ten strains (laminate.h)
 * Returns whether the potential acts in the element.
 */
bool bare_faces_resultants(const bare_faces *bare, int potential, int element,
                           double h0[LAMINATE_STRAINS]);

/*
 * List the eight electric potentials of a layer in an element (four corners on two faces), in the
 * order of potential_element.h.
 *   number [8] out  index of each potential among all unknown potentials of bare faces (without
 *       electrodes), counted from 0; -1 where the potential is 0
 */
void bare_faces_numbers(const bare_faces *bare, int layer, int element,
                        int number[POTENTIAL_NODES]);

/*
 * Return the capacitance matrix [8][8] of the bare faces (without electrodes) of two layers in one
 * element, at zero strain (C/V): charge at a node of `layer` (row) per volt at a node of `other`
 * (column). The eight nodes are four corners on each of two faces.
 */
const double (*bare_faces_capacitance(const bare_faces *bare, int layer, int other,
                                      int element))[POTENTIAL_NODES];

/*
 * Return the electric potential at a node on a face of a layer (V), 0 where the face has no
 * potential there.
 *   value [inputs] in  values of all inputs of the structure, including the potentials of its
 *       faces without electrodes (V)
 *   face           in  0: inner face of the layer; 1: outer face
 */
double bare_faces_potential(const bare_faces *bare, const double *value, int layer, int face,
                            int node);

/*
 * Compute the electric field of a layer with bare faces (without electrodes), as mean over an
 * element.
 *   value [inputs] in   input values, with the computed potentials
 *   voltage        out  voltage across the layer (V)
 *   along [2][2]   out  field along the axes 1 and 2 of the shell, at the inner and outer face
 *       (V/m)
 * Returns false, with a field of 0, where the layer has no bare face or is not present.
 */
bool bare_faces_field(const bare_faces *bare, const double *value, int layer, int element,
                      double *voltage, double along[2][2]);

#endif
