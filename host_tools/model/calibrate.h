/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Influence matrix from measurements: shapes S under voltages V, the pokes, of any excitation.
 *
 *   S = V B' + noise,   V [pokes][actuators], S [pokes][outputs], B [outputs][actuators]
 *
 * Without a model B is the least-squares solution, which needs as many independent pokes as
 * actuators. With a model B0 the entries of B differ from B0 by independent errors of the standard
 * deviation t, and the noise has the standard deviation s; then
 *
 *   B' = B0' + V' (V V' + q I)^-1 (S - V B0'),   q = (s/t)^2,
 *
 * with the q for which each poke is predicted best from the others. Fewer pokes suffice.
 */
#ifndef CALIBRATE_H
#define CALIBRATE_H

#include <stdbool.h>
#include "../scene/scene.h"

/* Measured pokes. */
typedef struct pokes {
    size_t count, actuators, outputs;
    const double *voltage; /* [count][actuators] V */
    const double *shape;   /* [count][outputs] */
} pokes;

typedef struct calibration {
    double *influence; /* [outputs][actuators] B */
    double *error;     /* [actuators] standard error of the entries of each column; NAN where the
                          noise is not known, with a model that of the model's part alone */
    double noise;    /* standard deviation of the measured shapes; NAN where it cannot be separated
                        from errors of the matrix: no more pokes than actuators and no model, or
                        no more pokes than actuators that are nearly orthogonal */
    double spread;   /* t, the standard deviation of the model's entries; 0 without a model */
    int rank;        /* number of actuators that the pokes can tell apart */
    double residual; /* root mean square of S - V B' */
} calibration;

/*
 * Compute the influence matrix.
 *   model [outputs][actuators]  in  B0, or NULL
 *   error [SCENE_ERROR]         out
 * Returns 0, or -1 with error filled: memory, or pokes that do not determine every actuator and no
 * model. Call calibration_free in either case.
 */
int calibrate(calibration *result, const pokes *pokes, const double *model, char *error);
void calibration_free(calibration *result);

/* ---- faults ----------------------------------------------------------- */

typedef enum wiring_fault_type {
    WIRING_DEAD,     /* the electrode does not act */
    WIRING_REVERSED, /* it acts with the opposite sign */
    WIRING_SWAPPED   /* its cable and that of `other` are exchanged */
} wiring_fault_type;

typedef struct wiring_fault {
    wiring_fault_type type;
    size_t actuator, other;
} wiring_fault;

enum { WIRING_FAULTS = 16 };

/*
 * Find faults that explain the pokes with the model: swapped cables first, each of which lowers the
 * squares that the model leaves by the part WIRING_GAIN at least; then dead electrodes and reversed
 * wires. Their numbers are those of the electrodes.
 *   model [outputs][actuators]  in
 * Returns the number of faults, or -1 without memory.
 */
#define WIRING_GAIN 0.3
int wiring_find(wiring_fault fault[WIRING_FAULTS], const pokes *pokes, const double *model);

/* Voltages that act on the electrodes with these faults. voltage [pokes][actuators] out */
void wiring_apply(const wiring_fault *fault, int faults, const pokes *pokes, double *voltage);

/*
 * Change the columns of a matrix of electrodes to those of the amplifiers as they are wired.
 *   influence [outputs][actuators]  in/out
 *   error [actuators]               in/out  its standard errors; 0 for dead electrodes
 */
void wiring_matrix(const wiring_fault *fault, int faults, const pokes *pokes, double *influence,
                   double *error);

/*
 * Whether the column of an actuator in a matrix computed without a model is that of a dead
 * electrode: below 5 % of the median column and not above four standard errors.
 */
bool calibration_is_dead(const calibration *result, const pokes *pokes, size_t actuator);

#endif
