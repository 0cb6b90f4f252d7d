/* SPDX-License-Identifier: BSD-2-Clause */
/* Forces of springs and stack actuators on standard output, as text and as JSON. */
#ifndef PRINT_SPRINGS_H
#define PRINT_SPRINGS_H

#include "../model/analysis.h"
#include "../text/json.h"

/*
 * Print the forces of springs and stack actuators on the structure, along their directions, if
 * there are any. The JSON member `springs` has, for each spring entry or stack actuator of the
 * scene, an array with the force of each of its springs.
 *   displacement [free_dof] in  displacement vector of the structure
 */
void print_springs(const analysis *analysis, const double *displacement);
void print_springs_json(json *json, const analysis *analysis, const double *displacement);

#endif
