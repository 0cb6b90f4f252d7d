/*
 * Assertions for tests of whole scenes: scenes that must run, and numbers that must agree. Include
 * it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef SCENE_ASSERT_H
#define SCENE_ASSERT_H

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "scene_run.h"

#define PLATE "tests/rigs/scenes/piezo-plate.yaml"
#define PUBLISHED "element=published;"
#define IMPROVED "element=improved;"
#define METRIC_OFF "element={kinematics: cartesian, metric: off, quadratic: off};"
/* Change of the scene PLATE: its upper layer alone, with one electrode. */
#define ONE_LAYER                                                                                  \
    "layers=[{name: upper, material: ceramic, thickness: 0.5e-3}];patches=[{name: up, layer: "     \
    "upper}];"

static const char *const elements[3] = {PUBLISHED, IMPROVED, IMPROVED "dof_per_node=6;"};

static inline void open_run(scene_run *run, const char *name, const char *changes)
{
    if (scene_run_open(run, name, changes) < 0)
        fail_msg("%s", run->error);
}

static inline void solve_run(scene_run *run, const char *name, const char *changes)
{
    open_run(run, name, changes);
    if (scene_run_solve(run) < 0)
        fail_msg("%s", run->error);
}

/* Join two lists of changes of a scene. */
static inline const char *with(const char *first, const char *second)
{
    static char text[2048];
    snprintf(text, sizeof text, "%s%s", first, second);
    return text;
}

/* A change that makes a shipped scene invalid, and a part of the message that is expected. */
typedef struct refusal {
    const char *set, *expected;
} refusal;

static inline void assert_refused(const char *name, const refusal *bad, size_t count)
{
    char path[512];
    snprintf(path, sizeof path, SCENE_FOLDER "/%s.yaml", name);
    for (size_t i = 0; i < count; i++) {
        char error[SCENE_ERROR] = "no fault";
        scene scene;
        const int status = scene_read(&scene, path, &bad[i].set, 1, error);
        if (status == 0)
            scene_free(&scene);
        if (status == 0 || !strstr(error, bad[i].expected) || strchr(error, '\n'))
            fail_msg("%s: expected '%s', got '%s'", bad[i].set, bad[i].expected, error);
    }
}

static inline void assert_near(const char *what, double value, double want, double relative)
{
    if (!(fabs(value - want) <= relative * fabs(want)))
        fail_msg("%s: %.15g, should be %.15g, off by %.2g", what, value, want, value / want - 1);
}

#endif
