/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Open electrodes of a vibrating structure: no charge comes to them, so that their voltages follow
 * the displacement u and stiffen the structure,
 *   charge = B'u + C v = 0,   stiffness with open electrodes = K + B C^-1 B'.
 *   B  forces per volt on each open electrode     C  capacitances while the shell cannot deform
 *   v  voltages of the open electrodes            K  stiffness at prescribed voltages
 * Linear solves use the factors of K and the matrix S = C + B' K^-1 B (Woodbury's identity). The
 * negative eigenvalues of the stiffness with open electrodes are those of K less those of S.
 */
#ifndef OPEN_ELECTRODES_H
#define OPEN_ELECTRODES_H

#include "linearised.h"

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
    size_t count;            /* number of open electrodes and of potentials of bare faces */
    size_t bare;             /* number of potentials of bare faces among them */
    size_t inputs, free_dof;
    int *number;         /* [inputs] index of each input among the open electrodes, or -1 */
    uint16_t *input;     /* [count] index of the input that is the voltage of each open electrode */
    double *charge;      /* [count][inputs] charge of each open electrode per unit of each input
                            while the shell cannot deform */
    double *response;    /* [count][free_dof] displacement K^-1 B per volt on each open electrode */
    double *voltage;     /* [count] work array */
    pzs_envelope held;   /* factors L D L^T of C */
    pzs_envelope moving; /* factors L D L^T of S */
    void *memory[4];     /* memory of the entries and of the indices of both matrices */
} open_electrodes;

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
 * Prepare linear solves for the factors of a matrix K, and count the negative pivots of S.
 *   factor           in  factors of the scaled matrix K
 *   scale [free_dof] in  factors by which rows and columns of K were multiplied
 * Returns the number of negative pivots, or -1 where S is singular.
 */
int open_electrodes_factor(open_electrodes *open, const pzs_envelope *factor, const double *scale);

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

/*
 * Compute the voltages of the open electrodes without charge under a displacement [free_dof], while
 * all inputs are 0; the result is open->voltage.
 */
void open_electrodes_follow(const open_electrodes *open, const double *displacement);

/*
 * Return the work on a displacement [free_dof] of the force per unit of an input, which is a charge
 * where the input is an open electrode. open->voltage must hold the voltages at this displacement.
 */
double open_electrodes_work(const open_electrodes *open, uint32_t input,
                            const double *displacement);

#endif
