/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A scene with a structure as the model of a calibration: factors of its material constants are
 * fitted to shapes measured under known voltages, and faults of electrodes and cables are found.
 */
#ifndef CALIBRATE_MODEL_H
#define CALIBRATE_MODEL_H

#include "calibrate.h"

/*
 * Factor by which the fit multiplies the elastic or the piezoelectric strain constants of one
 * material of the scene.
 */
typedef struct model_factor {
    int material;
    bool is_piezo;
    double value; /* fitted factor of material constants; 1 leaves the constants of the scene */
} model_factor;

typedef struct calibration_model {
    int factors;
    model_factor *factor; /* [factors] fitted factors of the material constants of the scene */
    double *influence;    /* [outputs][amplifiers] influence matrix of the scene after its material
                             constants are multiplied by the fitted factors */
    double (*place)[3];   /* [outputs] coordinates x, y, z of the target nodes */
    double before, after; /* root mean square difference between measured shapes and those predicted
                             by the scene before and after the fit, relative to the measured shapes
                           */
    double size; /* root mean square of the measured shapes relative to that of the shapes that the
                    scene predicts before the fit */
    int faults;
    wiring_fault fault[WIRING_FAULTS]; /* faults of electrodes and cables, in the order in which
                                          they were found */
    double *voltage; /* [pokes][amplifiers] voltages that reach the electrodes in each poke (shape
                        measured under known voltages), given the faults found (V) */
} calibration_model;

/*
 * Fit the factors of the scene's materials to the pokes (shapes measured under known voltages),
 * find wiring faults, and fit again. Pokes do not determine all factors; their logarithms have the
 * prior standard deviation MODEL_SPREAD.
 *   nominal in  checked scene with a structure; its target nodes are the outputs of the pokes
 * Returns 0, or -1 with error filled; call calibration_model_free in either case.
 */
#define MODEL_SPREAD 0.25
int calibration_model_fit(calibration_model *model, const scene *nominal, const pokes *pokes,
                          char *error);
void calibration_model_free(calibration_model *model);

#endif
