/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The electrodes of a scene as the library's table: amplifiers of voltages and sensors, with the
 * charge that each input draws while the shell does not deform.
 */
#ifndef ELECTRODES_H
#define ELECTRODES_H

#include "design.h"

/*
 * Fill design->electrodes where the scene has sensors or asks for a charge. Returns 0, or -1 with
 * error filled.
 */
int electrodes_build(design *design, char *error);

/* Index of the electrode of an input, or -1. */
int electrodes_of(const design *design, int input);

/* Input of the i-th electrode of an electric output. */
int electrodes_input(const design *design, const scene_output *output, int i);

#endif
