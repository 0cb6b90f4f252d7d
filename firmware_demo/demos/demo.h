/*
 * Interfaces of the demonstration programs:
 *
 *   demo_control.c or demo_linear.c  tables, memory and influence matrix of an image
 *   main.c                           control loop and its results
 *   demo_modes.c                     linear image: natural frequencies and mode shapes
 *   demo_modes_at.c                  nonlinear image: the same about an equilibrium
 *   modes_lines.c                    functions that these two demonstrations share
 *   demo_loads.c or demo_reshape.c   nonlinear image: large rotation under loads, or under voltages
 *   demo_path.c                      functions that the two nonlinear demonstrations share
 *   drill.c                          faults that must end in a status, not in a crash
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef DEMO_H
#define DEMO_H

#include "pzs.h"

typedef struct demo_image {
    const pzs_problem *problem;
    const pzs_real *target;    /* [outputs] target shape of the scene (m) */
    const pzs_real *influence; /* [outputs][inputs] influence matrix (m/V) */
    void *work;                /* workspace of the controller */
    size_t bytes;              /* size of the workspace (bytes) */
    pzs_real *wanted;          /* [outputs] memory for the target shape of a tick (m) */
    pzs_real *measured;        /* [outputs] memory for a measured shape (m) */
} demo_image;

/*
 * Fill in the image. A linear image computes the influence matrix here and prints one line about
 * it.
 */
pzs_status demo_open(demo_image *image);

/* Print one line "drill NAME ok" or "drill NAME FAILED: status N". Returns 0 if `ok`, else 1. */
int drill_line(const char *name, int ok, pzs_status status);

/*
 * Provoke faults in the stages of a model; called in a linear image only. Returns the number of
 * wrong results.
 */
int drill_model(const pzs_structure *structure, void *work, size_t bytes);

#if PZS_NONLINEAR
/* Tables and memory of a nonlinear image, and the solver settings of its scene. */
typedef struct demo_nonlinear_image {
    const pzs_structure *structure;
    const pzs_nonlinear *nonlinear;
    void *model_work, *path_work;
    size_t model_bytes, path_bytes;
    pzs_real tolerance;
    uint16_t load_steps, extrapolated_iterations, ramp_solves;
    uint32_t solve_limit;
} demo_nonlinear_image;

/*
 * Initialiser of a demo_nonlinear_image from the generated header and from arrays model_work and
 * path_work of the including file.
 */
#define DEMO_NONLINEAR_IMAGE                                                                       \
    {                                                                                              \
        &demo_structure, &demo_nonlinear, model_work, path_work, sizeof model_work,                \
            sizeof path_work, DEMO_TOLERANCE, DEMO_LOAD_STEPS, DEMO_EXTRAPOLATED_ITERATIONS,       \
            DEMO_RAMP_SOLVES, DEMO_SOLVE_LIMIT                                                     \
    }

/* Initialise a model and an equilibrium solver in the undeformed state. */
pzs_status demo_open_path(pzs_model *model, pzs_solver *solver, const demo_nonlinear_image *image);

/* Call pzs_equilibrium and print two lines: one about the result, one about the work. */
pzs_status demo_equilibrium(const char *name, pzs_solver *solver, const pzs_real *amount);

/* Provoke faults in the stages of an equilibrium solver. Returns the number of wrong results. */
int drill_path(const demo_nonlinear_image *image);
#endif

#if PZS_MODES
/*
 * Print two lines about a search for vibration modes: one about the result, with checksums of the
 * mode shapes and of the static responses, and one about the work.
 *   spent     in  instructions of the search
 *   response  in  [responses] static responses (pzs_modes_response)
 */
void demo_modes_lines(const char *name, const pzs_modes *modes, pzs_status status, uint32_t spent,
                      const pzs_real *response, size_t responses);

/*
 * Whether the frequencies of the modes are those given, times the root of a factor of the
 * stiffness. Squared frequencies may differ by the relative difference; squares are compared so
 * that no root is taken.
 */
int demo_modes_are(const pzs_modes *modes, const pzs_real *frequency, pzs_real stiffness,
                   pzs_real difference);
#endif

/*
 * Provoke faults in a running control loop, which stays usable. Returns the number of wrong
 * results.
 */
int drill_control(pzs_control *control, const demo_image *image);

#endif
