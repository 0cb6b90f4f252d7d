/*
 * A scene run as a user runs it: read with changes, prepared and solved. For test programs.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef SCENE_RUN_H
#define SCENE_RUN_H

#include <math.h>
#include "../../host_tools/model/analysis.h"

typedef struct scene_run {
    scene scene;
    analysis analysis;
    double *u, *output; /* [free_dof] displacement, and [outputs] outputs of this displacement */
    char error[SCENE_ERROR]; /* message of the last call that failed */
} scene_run;

/*
 * Read a scene.
 *   name    in  name of a shipped scene, or a path with a '/'
 *   changes in  "key=value;key=value", as after --set on the command line
 * Returns 0, or -1 with a message in error.
 */
int scene_run_read(scene *scene, const char *name, const char *changes, char error[SCENE_ERROR]);

/*
 * Read and prepare a scene, whose name and changes are those of scene_run_read.
 * Returns 0, or -1 with a message in error. The run must be closed in either case.
 */
int scene_run_open(scene_run *run, const char *name, const char *changes);

/*
 * Compute displacement and outputs under the loads and voltages of the scene, from the undeformed
 * state. Returns 0, or -1 with a message in error.
 */
int scene_run_solve(scene_run *run);

/* Compute the outputs of a displacement [free_dof]. */
void scene_run_observe(scene_run *run, const double *displacement);

/* Return the first value of the output with index k in the scene. */
double scene_run_value(const scene_run *run, int k);

void scene_run_close(scene_run *run);

/*
 * Common voltage limits: none, those of the scene, or from -most to most; an infinite `most` means
 * no limits.
 */
static inline common_limits no_limits(void)
{
    return (common_limits){.source = LIMITS_NONE};
}

static inline common_limits scene_limits_alone(void)
{
    return (common_limits){.source = LIMITS_SCENE};
}

static inline common_limits within(double most)
{
    return isinf(most) ? no_limits()
                       : (common_limits){.source = LIMITS_GIVEN, .lower = -most, .upper = most};
}

#endif
