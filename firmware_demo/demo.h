/*
 * The parts of the demonstration.
 *
 *   demo_control.c or demo_linear.c   what an image brings: tables, memory, influence
 *   main.c                            the control loop and its report
 *   drill.c                           faults that must end in a status, not in a crash
 */
#ifndef DEMO_H
#define DEMO_H

#include "pzs.h"

typedef struct demo_image {
    const pzs_problem *problem;
    const pzs_real *target; /* [outputs] the scene's target (m) */
    const pzs_real *influence; /* [outputs][inputs] (m/V) */
    void *work;             /* of the controller */
    size_t bytes;           /* size of work */
    pzs_real *wanted;       /* [outputs] room for the target of a tick (m) */
    pzs_real *measured;     /* [outputs] room for a measured shape (m) */
} demo_image;

/* Fill in the image; a linear image computes the influence here and prints a line about it. */
pzs_status demo_open(demo_image *image);

/* One line "drill NAME ok" or "drill NAME FAILED: status N". Returns whether all is well. */
int drill_line(const char *name, int ok, pzs_status status);

/* Faults of the structure's stages; only in a linear image. Returns the number that failed. */
int drill_model(const pzs_structure *structure, void *work, size_t bytes);

/* Faults of a running loop; leaves the controller usable. Returns the number that failed. */
int drill_control(pzs_control *control, const demo_image *image);

#endif
