/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Open electrodes of a vibrating structure: no charge comes to them, so that their voltages follow
 * the displacement and stiffen the structure. The equations and the matrices C and S of the
 * electrodes are those of the library (lib/modes/open_matrix.h); here are the choice of the
 * electrodes and the linear solves of many right-hand sides, K being the matrix at prescribed
 * voltages.
 */
#ifndef OPEN_ELECTRODES_H
#define OPEN_ELECTRODES_H

#include "pzs_modes.h"
#include "linearised.h"

struct linalg_inertia;

/*
 * Circuits of the electrodes. CIRCUIT_SCENE: electrodes of sensors are open unless the scene says
 * `circuit: short`, those of amplifiers are at a prescribed voltage. CIRCUIT_SHORT: all electrodes
 * are at a prescribed voltage. CIRCUIT_OPEN: all electrodes are open; those of one amplifier, which
 * are tied by factors, have one common charge. Potentials of bare faces (without electrodes) are
 * free in each circuit.
 */
typedef enum electrode_circuit { CIRCUIT_SCENE, CIRCUIT_SHORT, CIRCUIT_OPEN } electrode_circuit;

typedef struct open_electrodes {
    const design *design;
    const linearised *about; /* forces of the inputs at a deformed shape; NULL: reference state */
    pzs_electrodes all; /* tables of all electrodes; empty where those of the design are used */
    pzs_modes_electrodes matrix; /* open electrodes, with potentials of bare faces, and their
                                    matrices */
    size_t bare;                 /* number of potentials of bare faces among them */
    size_t free_dof;
    double *response; /* [matrix.count][free_dof] displacements K^-1 B, per volt on each electrode
                       */
    void *memory;     /* memory of the matrices */
} open_electrodes;

/*
 * Mark the electrodes of a table that are open in a circuit.
 *   is_open [tables->count] out  1: open, 0: at a prescribed voltage
 * Returns the number of open electrodes.
 */
uint32_t open_electrodes_mark(const design *design, const pzs_electrodes *tables,
                              electrode_circuit circuit, uint8_t *is_open);

/*
 * Find the open electrodes of a circuit and factor their capacitances.
 *   about in  forces of the inputs at a deformed shape; NULL: reference (undeformed) state
 * Returns 0, or -1 with error filled where an open electrode has no capacitance or memory runs out;
 * call open_electrodes_free in either case.
 */
int open_electrodes_build(open_electrodes *open, const design *design, const linearised *about,
                          electrode_circuit circuit, char *error);
void open_electrodes_free(open_electrodes *open);

/*
 * Prepare linear solves for the factors of a matrix K.
 *   factor           in      factors of the scaled matrix K
 *   scale [free_dof] in      factors by which rows and columns of K were multiplied
 *   inertia          in/out  pivots of K; out: of the matrix with open electrodes. inertia->zero is
 *                            0 where S is singular
 */
void open_electrodes_factor(open_electrodes *open, const pzs_envelope *factor, const double *scale,
                            struct linalg_inertia *inertia);

/*
 * Turn solutions of linear systems for prescribed voltages (stiffness K) into solutions of the same
 * systems with open electrodes, whose voltages follow the displacement.
 *   vector [count][free_dof] in/out  solutions
 */
void open_electrodes_correct(const open_electrodes *open, double *vector, size_t count);

/*
 * Return twice the electric energy u'B C^-1 B'u that a displacement vector u [free_dof] stores in
 * open electrodes: B holds the forces per volt on each of them, C their capacitances.
 */
double open_electrodes_energy(const open_electrodes *open, const double *displacement);

#endif
