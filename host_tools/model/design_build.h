/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Construction of the design, the numerical model of a scene that the library needs: mesh, inputs,
 * outputs, targets and electrodes.
 */
#ifndef DESIGN_BUILD_H
#define DESIGN_BUILD_H

#include "design.h"

/*
 * Build the design (numerical model) of a checked scene: mesh, inputs, outputs, targets and
 * electrodes. The scene must outlive the design. Returns 0, or -1 with error filled and nothing to
 * free.
 */
int design_build(design *design, const scene *scene, char *error);

#endif
