/*
 * A scene run as a user runs it: read with changes, prepared, solved. For test programs.
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
    double *u, *output;      /* displacement and its output rows */
    char error[SCENE_ERROR]; /* of the last call that failed */
} scene_run;

/*
 * Read and prepare.
 *   name    in  of a shipped scene, or a path with a '/'
 *   changes in  "key=value;key=value", as the command line's --set
 * Returns 0, or -1 with error filled; close it in either case.
 */
int scene_run_open(scene_run *run, const char *name, const char *changes);

/* Displacement under the scene's loads and volts, from rest; u and output hold what was reached.
 * Returns 0, or -1 with error filled. */
int scene_run_solve(scene_run *run);

/* Put a displacement's output rows into output. displacement [dof] in */
void scene_run_observe(scene_run *run, const double *displacement);

/* First value of the scene's k-th output. */
double scene_run_value(const scene_run *run, int k);

void scene_run_close(scene_run *run);

/*
 * Common voltage limits: none, those of the scene, or from -most to most; an infinite `most` is
 * none.
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
