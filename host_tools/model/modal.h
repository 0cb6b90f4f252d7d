/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Modal description of a structure in its reference state: natural frequencies, damping ratios,
 * mode shapes at the output rows, and the static response of every mode to every input.
 *
 * With y_static the static displacement of the output rows under the present inputs,
 *
 *   y = y_static + C d,   d = q - q_eq,   q_eq = g x input,
 *
 * so that the modes left out respond statically. Modes are scaled to unit modal mass.
 */
#ifndef MODAL_H
#define MODAL_H

#include "propagator.h"
#include "vibration.h"

typedef struct modal {
    size_t modes, rows, inputs;
    double *frequency; /* [modes] angular frequency w (rad/s) */
    double *damping;   /* [modes] damping ratio */
    double *shape;     /* [rows][modes] C: output rows per unit of a modal coordinate */
    double *response;  /* [modes][inputs] g: static modal coordinate per unit of an input */
} modal;

/*
 * Damping ratio of a mode by the scene's section `dynamics`: one ratio, an entry of its list (the
 * last entry also for all later modes), or a/(2 w) + b w/2 of Rayleigh damping.
 *   mode      in  0 for the first mode that is not a rigid motion
 *   frequency in  w (rad/s)
 */
double modal_damping(const scene_dynamics *dynamics, int mode, double frequency);

/*
 * Fill the description from modes of the design. Rigid motions are left out.
 *   inputs in  number of inputs of the structure, counted from the first one
 * Returns whether memory sufficed; call modal_close in either case.
 */
bool modal_open(modal *modal, const design *design, const vibration *vibration, size_t inputs);
void modal_close(modal *modal);

#endif
