/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mass tables of a structure (pzs_mass): elements whose mass matrices are equal to rounding share
 * one matrix.
 */
#ifndef MASS_TABLES_H
#define MASS_TABLES_H

#include "pzs_modes.h"
#include "../model/design.h"

typedef struct mass_tables {
    pzs_mass tables;
    uint16_t *element_type; /* [elements] memory of tables.element_type */
    double *matrix;         /* memory of tables.matrix */
} mass_tables;

/*
 * Build the mass tables of a scene.
 *   lumped in  weight of the lumped mass matrix, from 0 to 1, usually MASS_LUMPED
 * Returns 0, or -1 with error filled where a material has no density or memory runs out; call
 * mass_tables_free in either case.
 */
int mass_tables_make(mass_tables *mass, const design *design, double lumped, char *error);
void mass_tables_free(mass_tables *mass);

#endif
