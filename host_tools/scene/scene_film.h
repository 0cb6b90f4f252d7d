/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Thin actuators, such as macro fibre composites, by the numbers of their data sheet: free strains
 * at a voltage, and the blocking force.
 */
#ifndef SCENE_FILM_H
#define SCENE_FILM_H

#include "scene_fields.h"

/* Data sheet of a film, a thin actuator with fibres; thickness = 0: the material is no film. */
typedef struct scene_film {
    double voltage; /* voltage of the data sheet at which strains and force of the film actuator are
                       given (V) */
    double strain[2]; /* free strains of the film along and across its fibres at the given voltage
                         (dimensionless) */
    double thickness; /* thickness of the film actuator (m) */
    double force, width; /* blocking force (N) of a film of the given width (m); 0: the data sheet
                            gives no force */
} scene_film;

field_read read_film;
extern const form film_form;

/*
 * Return the piezoelectric constant d31 (direction 0) or d32 (direction 1) of a film (m/V), strain
 * per electric field along its poling direction +3. A voltage V causes the field -V/thickness, so
 * that the constant is -strain thickness/V with the numbers of the data sheet.
 */
double scene_film_constant(const scene_film *film, int direction);

/*
 * Return Young's modulus E1 of a film along its fibres (N/m2): the blocking force divided by free
 * strain, width and thickness.
 */
double scene_film_modulus(const scene_film *film);

#endif
