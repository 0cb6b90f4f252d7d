/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A scene with a structure as the model of a calibration: factors of its material constants, fitted
 * to the pokes, and faults of electrodes and cables.
 */
#ifndef CALIBRATE_MODEL_H
#define CALIBRATE_MODEL_H

#include "calibrate.h"

/* A factor of a scene's material: of its elastic or of its piezoelectric strain constants. */
typedef struct model_factor {
    int material;
    bool is_piezo;
    double value; /* fitted factor */
} model_factor;

typedef struct calibration_model {
    int factors;
    model_factor *factor; /* [factors] */
    double *influence;    /* [outputs][amplifiers] of the scene with these factors */
    double (*place)[3];   /* [outputs] coordinates of the target nodes */
    double before, after; /* root mean square of what the scene, and the fitted model, leave of the
                             measured shapes, relative to these shapes */
    int faults;
    wiring_fault fault[WIRING_FAULTS]; /* in the order in which they were found */
    double *voltage; /* [pokes][amplifiers] voltages that act, with these faults */
} calibration_model;

/*
 * Fit the factors of the scene's materials to the pokes, find faults, and fit again. A factor's
 * logarithm has the prior standard deviation MODEL_SPREAD, because the pokes may leave some factors
 * open: a common factor of all elastic constants changes no displacement per volt.
 *   nominal  in  checked scene with a structure; its target nodes are the outputs
 * Returns 0, or -1 with error filled; call calibration_model_free in either case.
 */
#define MODEL_SPREAD 0.25
int calibration_model_fit(calibration_model *model, const scene *nominal, const pokes *pokes,
                          char *error);
void calibration_model_free(calibration_model *model);

#endif
