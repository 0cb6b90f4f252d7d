/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Modal description of a structure in its reference state, with modes of unit modal mass:
 * frequencies, damping ratios, mode shapes, and the static response of every mode to every input.
 * The output rows are
 *   y = y_static + C d.
 *   y_static  static displacement under the present inputs, also of modes that are left out
 *   C         mode shapes
 *   d         deviation of the modal coordinates from their equilibrium
 */
#ifndef MODAL_TABLES_H
#define MODAL_TABLES_H

#include <stddef.h>

typedef struct modal {
    size_t modes, rows, inputs;
    double *frequency; /* [modes] angular frequencies of the vibration modes (rad/s) */
    double *damping;   /* [modes] damping ratios of the vibration modes */
    double *shape;     /* [rows][modes] displacement of each output (of the target, or named in the
                          scene) per unit of the coordinate of each vibration mode */
    double *response;  /* [modes][inputs] coordinate of each vibration mode in equilibrium per unit
                          of each input */
} modal;

#endif
