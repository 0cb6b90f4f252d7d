/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Natural frequencies and mode shapes of a structure in its reference state or about a deformed
 * equilibrium, or those of the scene with a measured influence matrix (vibration_measured.c). They
 * are the lowest solutions of
 *   K x = w^2 M x.
 *   K, M  stiffness, with that of open electrodes (open_electrodes.h), and mass matrix
 *   w     angular frequency
 * Method: band Lanczos on (K + shift M)^-1 M; the shift is 0 unless rigid motions are possible. The
 * negative pivots of K - s M, with s just above the last w^2, prove that no mode is missing.
 */
#ifndef VIBRATION_H
#define VIBRATION_H

#include "open_electrodes.h"

typedef struct vibration {
    int count;   /* number of computed natural frequencies and mode shapes */
    int rigid;   /* number of rigid motions, which are the first vibration modes and have the
                    frequency 0 */
    int solves;  /* number of linear solves with the shifted stiffness matrix that were needed */
    int open;    /* number of open electrodes and of free potentials of bare faces */
    int bare;    /* number of free potentials of bare faces among them */
    double mass; /* mass of the whole structure, constrained nodes included */
    double *frequency; /* [count] natural frequencies (Hz where the unit of time is the second) */
    double *square;    /* [count] squares of the angular frequencies (rad^2/s^2) */
    double *shape; /* [count][free_dof] mode shapes, scaled to unit modal mass; measured mode shapes
                      that the scene file gives keep the unit of the file */
    double *response; /* [count][inputs] static value of each modal coordinate under a constant unit
                         of each input of the structure, which is a unit of charge where the input
                        is an open electrode; NAN for rigid motions */
    double *largest;  /* [count] largest displacement of a node in each mode shape */
    double (*effective)[3]; /* [count] effective modal mass of each vibration mode for motions along
                               x, y and z */
} vibration;

/*
 * Return the number of vibration modes that a structure has: the number of its free dof, or of the
 * measured modes that the scene file gives.
 */
int vibration_most(const design *design);

/*
 * Compute the lowest vibration modes in the reference state, with the circuits of the scene
 * (CIRCUIT_SCENE).
 *   number in  number of modes, reduced to the number that the structure has
 *   lumped in  part of the lumped mass matrix in the mass matrix, 0 to 1, usually MASS_LUMPED (2/3)
 * Returns 0, or -1 with error filled and the result empty: no density, no convergence, a mode
 * missing, or a measured influence matrix without modes.
 */
int vibration_solve(vibration *vibration, const design *design, int number, double lumped,
                    char *error);
void vibration_free(vibration *vibration);

/*
 * Copy computed vibration modes of a structure. Returns whether memory sufficed; if not, `to` is
 * empty.
 */
bool vibration_copy(vibration *to, const vibration *from, const design *design);

/*
 * Allocate the arrays of frequencies, mode shapes and responses for a number of vibration modes,
 * filled with zeros. Returns whether memory sufficed; call vibration_free in either case.
 */
bool vibration_allocate(vibration *vibration, const design *design, size_t count);

/*
 * Take the measured vibration modes of a scene with a measured influence matrix. Static responses
 * that the scene file does not give are fitted by least squares: the sum over all modes of shape
 * times static response shall equal the matrix. Returns 0, or -1 with error filled; call
 * vibration_free in either case.
 */
int vibration_take_measured(vibration *vibration, const design *design, size_t number, char *error);

/*
 * Compute the lowest modes of small vibrations about a deformed equilibrium.
 *   about   in  tangent stiffness matrix there, with the prestress, and forces of the inputs; NULL:
 *               reference state
 *   circuit in  circuits of the electrodes; not read for measured vibration modes
 *   number  in  number of modes, reduced to the number that the structure has
 *   lumped  in  part of the lumped mass matrix in the mass matrix, from 0 to 1
 * Returns 0, or -1 with error filled and the result empty.
 */
int vibration_solve_at(vibration *vibration, const design *design, const linearised *about,
                       electrode_circuit circuit, int number, double lumped, char *error);

/*
 * Check that the static responses of the measured vibration modes can be fitted to the measured
 * influence matrix. The fit is unique if no mode shape is a linear combination of the shapes
 * before it. Returns 0, or -1 with error filled.
 */
int vibration_check_measured(const scene_influence *measured, char *error);

/*
 * Index of the first vibration mode that is not a rigid motion; the number of modes where there is
 * none.
 */
int vibration_first(const vibration *vibration);

/*
 * Return the modal coordinate of a vibration mode in static equilibrium under one unit of an input:
 * the work of the input's forces on the mode shape over the squared angular frequency; NAN for a
 * rigid motion.
 *   input in  index of an input of the structure
 */
double vibration_static(const vibration *vibration, const design *design, int mode, int input);

#endif
