/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Modal description of a structure in its reference state: natural frequencies, damping ratios,
 * mode shapes at the output rows, and the static response of every mode to every input. The output
 * rows are y = y_static + C d, where y_static is their static displacement under the present
 * inputs, C holds the mode shapes, and d is the deviation of the modal coordinates from their
 * equilibrium. Modes that are left out thus respond statically. The modes are scaled to unit modal
 * mass.
 */
#ifndef MODAL_H
#define MODAL_H

#include "propagator.h"
#include "vibration.h"

typedef struct modal {
    size_t modes, rows, inputs;
    double *frequency; /* [modes] angular frequencies of the modes (rad/s) */
    double *damping;   /* [modes] damping ratios of the modes */
    double *shape; /* [rows][modes] displacement of each output row per unit of a modal coordinate
                    */
    double *response; /* [modes][inputs] static modal coordinate per unit of each input */
} modal;

/*
 * Damping ratio of a mode by the scene's section `dynamics`: one ratio for all modes; or the entry
 * of a list, whose last entry also applies to all later modes; or Rayleigh damping a/(2 w) + b w/2
 * with the angular frequency w.
 *   mode      in  0 for the first mode that is not a rigid motion
 *   frequency in  angular frequency (rad/s)
 */
double modal_damping(const scene_dynamics *dynamics, int mode, double frequency);

/*
 * Fill the modal description from computed modes of the design. Rigid motions are left out.
 *   inputs in  number of inputs of the structure to include, counted from the first one
 * Returns whether memory sufficed; call modal_close in either case.
 */
bool modal_open(modal *modal, const design *design, const vibration *vibration, size_t inputs);
void modal_close(modal *modal);

#endif
