/* SPDX-License-Identifier: BSD-2-Clause */
/* Forces of springs and stack actuators (spring_forces.h). */
#include "spring_forces.h"
#include <stdio.h>
#include "../mesh/springs.h"

double spring_force(const design *design, int row, const double *u, const double *value)
{
    const mesh_springs *springs = &design->mesh.springs;
    double force = -springs->stiffness[row] * springs_elongation(springs, row, u);
    for (int k = 0; k < design->actuators; k++) {
        const scene_actuator *actuator = &design->actuator[k];
        const int cell = row - springs->first[design->springs + k];
        if (actuator->stacks && cell >= 0 && cell < actuator->grid[0])
            force += actuator->stacks->force * value[actuator->first + cell];
    }
    return force;
}

void spring_item_name(const design *design, int item, char name[SCENE_LABEL])
{
    const char *own = item < design->springs ? design->spring[item].name
                                             : design->actuator[item - design->springs].name;
    if (*own)
        snprintf(name, SCENE_LABEL, "%s", own);
    else
        snprintf(name, SCENE_LABEL, "spring %d", item + 1);
}
