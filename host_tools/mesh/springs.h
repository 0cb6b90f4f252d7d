/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Springs of a scene and stacks of its actuators as rows over the free dof. The elongation of a
 * spring is the displacement of its place along its direction, less that of its other end; the
 * displacement of a place is the mean of both faces unless a face is named. Distributed springs are
 * lumped at the nodes.
 *
 * Items: the springs of the scene in its order, then one item for each actuator, which is empty
 * where the actuator has no stacks.
 */
#ifndef SPRINGS_H
#define SPRINGS_H

#include "mesh.h"

/* Item of the stacks of an actuator. */
int springs_item(const scene *scene, int actuator);

/* Elongation of spring `row` under a displacement u [free_dof]. */
double springs_elongation(const mesh_springs *springs, int row, const double *u);

/* dense [free_dof] += factor times the row of a spring */
void springs_add(const mesh_springs *springs, int row, double factor, double *dense);

#endif
