/*
 * The parts of the demonstration.
 *
 *   demo_control.c or demo_linear.c   what an image brings: tables, memory, influence
 *   main.c                            the control loop and its report
 *   demo_loads.c or demo_reshape.c    a nonlinear image: large rotation under loads, or under
 * voltages demo_path.c                       what these two have in common drill.c faults that must
 * end in a status, not in a crash
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef DEMO_H
#define DEMO_H

#include "pzs.h"

typedef struct demo_image {
    const pzs_problem *problem;
    const pzs_real *target;    /* [outputs] the scene's target (m) */
    const pzs_real *influence; /* [outputs][inputs] (m/V) */
    void *work;                /* of the controller */
    size_t bytes;              /* size of work */
    pzs_real *wanted;          /* [outputs] room for the target of a tick (m) */
    pzs_real *measured;        /* [outputs] room for a measured shape (m) */
} demo_image;

/* Fill in the image; a linear image computes the influence here and prints a line about it. */
pzs_status demo_open(demo_image *image);

/* One line "drill NAME ok" or "drill NAME FAILED: status N". Returns whether all is well. */
int drill_line(const char *name, int ok, pzs_status status);

/* Faults of the structure's stages; only in a linear image. Returns the number that failed. */
int drill_model(const pzs_structure *structure, void *work, size_t bytes);

#if PZS_NONLINEAR
/* Tables and memory of a nonlinear image, and the scene's solver settings. */
typedef struct demo_nonlinear_image {
    const pzs_structure *structure;
    const pzs_nonlinear *nonlinear;
    void *model_work, *path_work;
    size_t model_bytes, path_bytes;
    pzs_real tolerance;
    uint16_t load_steps, extrapolated_iterations;
    uint32_t solve_limit;
} demo_nonlinear_image;

/* Those of the generated header, with arrays model_work and path_work beside it. */
#define DEMO_NONLINEAR_IMAGE                                                                       \
    {                                                                                              \
        &demo_structure, &demo_nonlinear, model_work, path_work, sizeof model_work,                \
            sizeof path_work, DEMO_TOLERANCE, DEMO_LOAD_STEPS, DEMO_EXTRAPOLATED_ITERATIONS,       \
            DEMO_SOLVE_LIMIT                                                                       \
    }

/* A model and a path at rest. */
pzs_status demo_open_path(pzs_model *model, pzs_solver *solver, const demo_nonlinear_image *image);

/* pzs_equilibrium, with two lines about what was found and what it cost. */
pzs_status demo_equilibrium(const char *name, pzs_solver *solver, const pzs_real *amount);

/* Faults of the path's stages. Returns the number that failed. */
int drill_path(const demo_nonlinear_image *image);
#endif

/* Faults of a running loop; leaves the controller usable. Returns the number that failed. */
int drill_control(pzs_control *control, const demo_image *image);

#endif
