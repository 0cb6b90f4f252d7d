/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Drift and memory of a structure in pokes (shapes measured under known voltages). With more pokes
 * than actuators, least squares fit
 *   s_k = B (v_k + h v_(k-1)) + c + d k + noise,  k = 0, 1, ...,  v_(-1) = 0.
 *   s_k [outputs]             measured shape of poke k
 *   v_k [actuators]           its voltages
 *   B   [outputs][actuators]  influence matrix
 *   h                         memory: what hysteresis and creep leave of the voltages before
 *   c, d [outputs]            offset of the shapes, and drift a poke
 */
#ifndef POKE_DRIFT_H
#define POKE_DRIFT_H

#include "calibrate.h"

typedef struct poke_drift {
    double *offset; /* [outputs] offset c of the shapes at the first poke; 0 where `drifts` is false
                     */
    double *slope;  /* [outputs] drift d of the shapes a poke; 0 where `drifts` is false */
    double drift, drift_error; /* root mean square of the drift over the outputs, in the unit of the
                                  outputs a poke, and the standard error of the drift of an output;
                                  NAN where the pokes do not determine them */
    double memory, memory_error; /* memory h and its standard error; NAN where the pokes do not
                                    determine them */
    size_t trends;   /* number of trends that the pokes determine: 2 with offset and drift */
    bool drifts;     /* whether offset and drift exceed the noise by POKE_DRIFT_SIGMAS */
    bool has_memory; /* whether the memory exceeds POKE_DRIFT_SIGMAS standard errors */
} poke_drift;

/* Number of standard errors above which drift and memory count. */
#define POKE_DRIFT_SIGMAS 5

/*
 * Estimate drift and memory from pokes, and subtract offset and drift from the shapes if they
 * exceed the noise. Nothing is known, and the shapes are kept, where the pokes do not determine
 * every actuator or are at most three more than the actuators.
 *   shape [pokes][outputs] out  measured shapes without offset and drift
 * Returns 0, or -1 where memory runs out. Call poke_drift_free in either case.
 */
int poke_drift_remove(poke_drift *drift, const pokes *pokes, double *shape);
void poke_drift_free(poke_drift *drift);

#endif
