/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Generated C tables of the vibration modes on the device: element mass matrices, sizes, and the
 * natural frequencies that the host computed.
 */
#ifndef TABLES_MODES_H
#define TABLES_MODES_H

#include "../model/analysis.h"
#include "emit.h"
#include "mass_tables.h"
#include "open_tables.h"

/* What the tables hold for vibration modes on the device (analysis.device_modes). */
typedef struct tables_modes {
    mass_tables mass;
    open_tables open;    /* electrodes that are open while the structure vibrates */
    vibration vibration; /* lowest vibration modes in the reference state */
    vibration reached;   /* lowest vibration modes about the stable equilibrium of a nonlinear
                            image; otherwise empty */
    int vectors;         /* number of Lanczos vectors of the search on the device */
    double shift;        /* squared angular frequency that the search adds to the stiffness: 0 for
                            a structure whose supports prevent rigid motions */
} tables_modes;

/*
 * Prepare the tables of a number of vibration modes, reduced to the number that the structure has.
 *   circuit        in  circuits of the electrodes while the structure vibrates
 *   at_equilibrium in  also compute the modes about the equilibrium that the nonlinear solver has
 *                      reached, which overwrites the factors of the tangent stiffness
 * Returns 0, or -1 with error filled: no density, no convergence, or no memory. Call
 * tables_modes_free in either case.
 */
int tables_modes_make(tables_modes *modes, analysis *analysis, electrode_circuit circuit,
                      bool at_equilibrium, int number, char *error);
void tables_modes_free(tables_modes *modes);

/* Write the mass tables and the sizes, settings and frequencies of the modes. */
void tables_modes_write(emitter *emitter, const tables_modes *modes, const design *design);

#endif
