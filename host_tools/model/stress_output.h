/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Outputs of a scene that are strains or stresses at nodes. The value at a node is the mean over
 * the elements at the node in which the layer of the output is present, weighted with the areas of
 * the elements.
 */
#ifndef STRESS_OUTPUT_H
#define STRESS_OUTPUT_H

#include "stress.h"

/*
 * Compute the values of all outputs of a scene that are strains or stresses from its recovered
 * stresses.
 *   value in/out  one value for each node of each output, output after output in the order of the
 *       scene file; values of outputs of other types are left unchanged
 */
void stress_outputs(const stress_field *field, double *value);

#endif
