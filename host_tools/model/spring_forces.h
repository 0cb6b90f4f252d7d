/* SPDX-License-Identifier: BSD-2-Clause */
/* Forces of springs and stack actuators on the structure. */
#ifndef SPRING_FORCES_H
#define SPRING_FORCES_H

#include "design.h"

/*
 * Return the force with which a spring pushes the structure in the direction of its elongation (N;
 * N m for a torsional spring): minus stiffness times elongation, plus the voltage force of a stack.
 *   row              in  number of the spring
 *   u     [free_dof] in  displacement vector of the structure
 *   value [inputs]   in  input values that belong to u
 */
double spring_force(const design *design, int row, const double *u, const double *value);

/*
 * Name of a spring entry or stack actuator of the scene (springs.h): the name that the scene file
 * gives, or a number counted from 1.
 */
void spring_item_name(const design *design, int item, char name[SCENE_LABEL]);

#endif
