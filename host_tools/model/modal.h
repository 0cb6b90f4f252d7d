/* SPDX-License-Identifier: BSD-2-Clause */
/* Modal description of a structure, made from its vibration modes (modal_tables.h). */
#ifndef MODAL_H
#define MODAL_H

#include "modal_tables.h"
#include "propagator.h"
#include "vibration.h"

/*
 * Return the damping ratio of a vibration mode from the scene's section `dynamics`: one ratio for
 * all modes, a list whose last entry also applies to all later modes, or Rayleigh damping a/(2 w) +
 * b w/2 with the angular frequency w.
 *   mode      in  0 for the first mode that is not a rigid motion
 *   frequency in  angular frequency (rad/s)
 */
double modal_damping(const scene_dynamics *dynamics, int mode, double frequency);

/* Return the damping ratio of a computed vibration mode; NAN for a rigid motion. */
double vibration_damping(const vibration *vibration, const design *design, int mode);

/*
 * Fill the modal description of a structure from its computed vibration modes. Rigid motions are
 * left out.
 *   inputs in  number of inputs of the structure to include, counted from the first one
 * Returns whether memory sufficed; call modal_close in either case.
 */
bool modal_open(modal *modal, const design *design, const vibration *vibration, size_t inputs);

/*
 * Copy the modal description of a structure. Returns whether memory sufficed; call modal_close in
 * either case.
 */
bool modal_copy(modal *to, const modal *from);
void modal_close(modal *modal);

#endif
