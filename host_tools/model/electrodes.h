/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Table of the library for the electrodes of a scene, with rows for the electrodes of amplifiers
 * and sensors and for the nodes of bare faces (without electrodes), whose potentials are unknown.
 * Entries: charge that each input causes there while the shell does not deform.
 */
#ifndef ELECTRODES_H
#define ELECTRODES_H

#include "design.h"

/*
 * Fill design->electrodes where the scene has sensors or bare faces (without electrodes) or asks
 * for a charge; otherwise leave it empty. Returns 0, or -1 with error filled.
 */
int electrodes_build(design *design, char *error);

/*
 * Index of an input's electrode in the library's table of electrodes; -1 where the input is no
 * electrode.
 */
int electrodes_of(const design *design, int input);

/* Index of the input that is the i-th electrode of a voltage or charge output of the scene. */
int electrodes_input(const design *design, const scene_output *output, int i);

#endif
