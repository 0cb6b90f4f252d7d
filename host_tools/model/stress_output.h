/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Outputs of a scene that are strains or stresses at nodes: the mean over those elements at a node
 * in which the layer is present, weighted with their areas.
 */
#ifndef STRESS_OUTPUT_H
#define STRESS_OUTPUT_H

#include "stress.h"

/*
 * Compute the values of all outputs of strains and stresses in a solved state.
 *   value [entries of design.place_node] in/out  values of the other outputs are left unchanged
 * Returns 0, or -1 if memory runs out.
 */
int stress_outputs(const stress_state *state, double *value);

#endif
