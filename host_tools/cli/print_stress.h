/* SPDX-License-Identifier: BSD-2-Clause */
/* Recovered stresses and strains on standard output, as text and as JSON. */
#ifndef PRINT_STRESS_H
#define PRINT_STRESS_H

#include "../model/stress.h"
#include "../text/json.h"

/*
 * Print the largest stresses and strains of a structure with element, layer and height, then for
 * each layer the largest von Mises stress, smallest reserve factor and largest electric field; in
 * JSON as member `stress`. Print nothing if `field` is NULL.
 */
void print_stress(const stress_field *field);
void print_stress_json(json *json, const stress_field *field);

#endif
