/* SPDX-License-Identifier: BSD-2-Clause */
/* Voltages and charges of electrodes, and potentials of bare faces. */
#ifndef PRINT_ELECTRIC_H
#define PRINT_ELECTRIC_H

#include "../model/analysis.h"
#include "../text/json.h"

/*
 * Print voltage, charge and capacitance of each electrode, and how much electrodes in open circuit
 * stiffen the shell. Without sensor electrodes nothing is printed.
 */
void print_electrodes(analysis *analysis);
void print_electrodes_json(json *json, analysis *analysis);

/*
 * Print the range of the potential of each bare face (face of a layer without electrode). Without
 * bare faces nothing is printed.
 */
void print_bare_faces(const analysis *analysis);
void print_bare_faces_json(json *json, const analysis *analysis);

#endif
