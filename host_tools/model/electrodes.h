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
 * Fill tables of all electrodes of a design, also where the scene has neither sensors nor bare
 * faces nor charges. Returns 0, or -1 with error filled; call electrodes_free in either case.
 */
int electrodes_build_all(const design *design, pzs_electrodes *tables, char *error);
void electrodes_free(pzs_electrodes *tables);

/* Whether an input is the electric potential at a node of a bare face (without electrode). */
bool electrodes_is_bare(const design *design, int input);

/* Name of the amplifier or sensor electrode of an input; "of a bare face" for a potential there. */
const char *electrodes_name(const design *design, int input);

/*
 * Index of an input's electrode in the library's table of electrodes; -1 where the input is no
 * electrode.
 */
int electrodes_of(const design *design, int input);

/* Index of the input that is the i-th electrode of a voltage or charge output of the scene. */
int electrodes_input(const design *design, const scene_output *output, int i);

#endif
