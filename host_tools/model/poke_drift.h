/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Drift and memory of a structure in pokes (shapes measured under known voltages, one after the
 * other). If there are more pokes than actuators, the unknowns of this model are fitted by least
 * squares:
 *   s_k = B (v_k + h v_(k-1)) + c + d k + noise,  k = 0, 1, ...,  v_(-1) = 0.
 *   s_k [outputs]             measured shape of poke k
 *   v_k [actuators]           voltages of poke k
 *   B   [outputs][actuators]  influence matrix
 *   h                         memory: fraction of the voltages of the preceding poke that still
 *                             acts, by hysteresis and creep
 *   c, d [outputs]            offset of the shapes, and drift from one poke to the next
 */
#ifndef POKE_DRIFT_H
#define POKE_DRIFT_H

#include "calibrate.h"

typedef struct poke_drift {
    double *offset; /* [outputs] offset c of the shapes, their value at the first poke (measured
                       shape) without voltages; 0 where `drifts` is false */
    double *slope;  /* [outputs] drift d of the shapes from one poke (measured shape) to the next; 0
                       where `drifts` is false */
    /*
     * drift: root mean square over the outputs of the drift from one poke (measured shape) to the
     * next. drift_error: standard error of the drift of an output. Both are in the unit of the
     * outputs, and NAN where the pokes do not determine them
     */
    double drift, drift_error;
    double memory, memory_error; /* fraction of the voltages of the preceding poke (measured shape)
                                    that still acts, by hysteresis and creep, and its standard
                                    error; NAN where the pokes do not determine them */
    size_t trends;   /* number of trends, constant offset and linear drift, that the pokes (measured
                        shapes) determine: 0 to 2 */
    bool drifts;     /* whether offset and drift are significant: larger than the noise explains, by
                        POKE_DRIFT_SIGMAS standard deviations */
    bool has_memory; /* whether the member `memory` is significant: larger in size than
                        POKE_DRIFT_SIGMAS of its standard errors */
} poke_drift;

/*
 * Number of standard errors above which a drift of the measured shapes, or an effect of earlier
 * voltages on them, counts as significant.
 */
#define POKE_DRIFT_SIGMAS 5

/*
 * Estimate drift and memory from pokes (measured shapes), and subtract offset and drift from the
 * shapes if they are significant. If the pokes do not determine the effect of every actuator, or
 * are at most three more than the actuators, nothing is estimated and the shapes are copied
 * unchanged.
 *   shape [pokes][outputs] out  measured shapes without offset and drift
 * Returns 0, or -1 where memory runs out. Call poke_drift_free in either case.
 */
int poke_drift_remove(poke_drift *drift, const pokes *pokes, double *shape);
void poke_drift_free(poke_drift *drift);

#endif
