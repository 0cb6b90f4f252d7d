/* SPDX-License-Identifier: BSD-2-Clause */
/* Forces of springs and stack actuators (spring_forces.h). */
#include "spring_forces.h"
#include <stdio.h>
#include "../mesh/springs.h"

double spring_force(const design *design, int row, const double *u, const double *value)
{
    const scene *scene = design->scene;
    const mesh_springs *springs = &design->mesh.springs;
    double force = -springs->stiffness[row] * springs_elongation(springs, row, u);
    for (int k = 0; k < scene->actuators; k++) {
        const scene_actuator *actuator = &scene->actuator[k];
        const int cell = row - springs->first[springs_item(scene, k)];
        if (actuator->stacks && cell >= 0 && cell < actuator->grid[0])
            force += actuator->stacks->force * value[actuator->first + cell];
    }
    return force;
}

void spring_item_name(const scene *scene, int item, char name[SCENE_LABEL])
{
    const char *own = item < scene->springs ? scene->spring[item].name
                                            : scene->actuator[item - scene->springs].name;
    if (*own)
        snprintf(name, SCENE_LABEL, "%s", own);
    else
        snprintf(name, SCENE_LABEL, "spring %d", item + 1);
}
