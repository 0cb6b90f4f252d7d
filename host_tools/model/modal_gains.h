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
 * Return the factor by which the error of a mode grows in each tick, on a structure that follows
 * its voltages without vibration. It is the largest factor over three structures, whose response to
 * the voltages is 0.8, 1 and 1.33 times that of the model.
 *   delay  in  age of the readings (ticks), which the loop takes into account
 */
double modal_gains_growth(double gain, double leak, int delay);

/*
 * Refuse gains with which the error of a mode grows from tick to tick on a structure without
 * vibration. Returns 0, or -1 with error filled: the mode, and the largest gain that is stable.
 */
int modal_gains_check(const design *design, char *error);

#endif
