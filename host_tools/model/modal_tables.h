/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Modal description of a structure in its reference state: natural frequencies, damping ratios,
 * mode shapes at the output rows, and the static response of every vibration mode to every input.
 * The output rows are y = y_static + C d. Here y_static is their static displacement under the
 * present inputs, C holds the mode shapes, and d is the deviation of the modal coordinates from
 * their equilibrium. Modes that are left out thus respond statically. The modes are scaled to unit
 * modal mass.
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
