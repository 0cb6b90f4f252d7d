/* SPDX-License-Identifier: BSD-2-Clause */
/* Principal strains of both faces of a shell at the centres of its elements. */
#ifndef FACE_STRAIN_H
#define FACE_STRAIN_H

#include <stdbool.h>
#include "../mesh/mesh.h"

/* A principal strain of one face of the shell at the centre of an element. */
typedef struct face_strain {
    double strain; /* principal strain in the plane of the face (dimensionless) */
    int element;   /* index of the element at whose centre the principal strain occurs */
    int face;      /* face of the shell on which the principal strain occurs (0: inner, 1: outer) */
} face_strain;

/*
 * Extreme principal strains of both faces of a shell: linear strains, or Green's strains, by which
 * a length changes from l to l sqrt(1 + 2 strain).
 */
typedef struct face_strains {
    face_strain largest; /* largest absolute principal strain of all elements, without its sign */
    face_strain lowest;  /* lowest principal strain of all elements: the strongest compression where
                            it is negative */
} face_strains;

/*
 * Find the extreme principal strains of both faces of a shell. Rigid motions cause no
 * Green's strain, and no linear strain to first order in the angle of rotation.
 *   displacement [free_dof] in   displacement vector of the structure
 *   is_linear               in   true: linear strains; false: Green's strains
 *   found                   out  the extreme strains
 * Returns false where memory runs out; `found` is then not written.
 */
bool face_strains_find(const mesh *mesh, const double *displacement, bool is_linear,
                       face_strains *found);

/*
 * Green's strain along the line through the thickness of the shell, as the mean over the four
 * corners of an element.
 *   displacement [free_dof] in  displacement vector of the structure
 */
double face_strain_of_thickness(const mesh *mesh, const double *displacement, int element);

#endif
