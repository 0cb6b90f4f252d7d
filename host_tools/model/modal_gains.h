/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables of the gains and leaks of modes in the control loop (pzs_modal_gains), made from the
 * section control.modal_gains of a scene.
 */
#ifndef MODAL_GAINS_H
#define MODAL_GAINS_H

#include "design.h"

/*
 * Make the tables for the influence matrix, weights and regularisation of a design, or none where
 * its scene has no gains of modes. An earlier result in design->gains is released. Returns 0, or -1
 * with error filled.
 */
int modal_gains_make(design *design, char *error);

/*
 * Return the growth of the error of a mode in a tick on a structure without vibration: its largest
 * factor over responses of the structure to voltages of 0.8 to 1.33 of the model's.
 *   delay  in  age of the readings (ticks), which the loop takes into account
 */
double modal_gains_growth(double gain, double leak, int delay);

/*
 * Refuse gains with which the error of a mode grows from tick to tick on a structure without
 * vibration. Returns 0, or -1 with error filled: the mode, and the largest gain that is stable.
 */
int modal_gains_check(const design *design, char *error);

#endif
