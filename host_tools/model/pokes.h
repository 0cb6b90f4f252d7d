/* SPDX-License-Identifier: BSD-2-Clause */
/* Measurements of the shape of a structure under known voltages. */
#ifndef POKES_H
#define POKES_H

#include <stddef.h>

/* Measured pokes: known voltages, and the shapes measured under them. */
typedef struct pokes {
    size_t count, actuators, outputs;
    const double *voltage; /* [count][actuators] voltages of each poke, a measurement of the shape
                              under known voltages (V) */
    const double *shape; /* [count][outputs] measured shape of each poke (a measurement of the shape
                            under known voltages), in the unit of the outputs */
    size_t trends; /* number of functions of time (such as a constant and a linear drift) that were
                      fitted to the readings of each output and subtracted from them */
} pokes;

#endif
