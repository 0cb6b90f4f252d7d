/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Construction of the design of a scene, the data that the library needs, from its mesh, inputs,
 * outputs, targets and electrodes.
 */
#ifndef DESIGN_BUILD_H
#define DESIGN_BUILD_H

#include "design.h"

/*
 * Build mesh, inputs, outputs, targets and electrodes of a checked scene, which must outlive the
 * design. Returns 0, or -1 with error filled and nothing to free.
 */
int design_build(design *design, const scene *scene, char *error);

#endif
