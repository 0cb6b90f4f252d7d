/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration modes of a scene with a measured influence matrix (vibration.h). The dof are the
 * outputs of the matrix. The static response of the structure is the sum over the modes of shape
 * times static modal coordinate, plus a residual of all modes that are left out.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/linalg.h"
#include "vibration.h"

static const double two_pi = 6.283185307179586;

/*
 * Smallest norm of the part of a mode shape that is orthogonal to the shapes of all lower modes,
 * relative to the norm of the shape. Below it, the outputs cannot distinguish the mode from the
 * lower modes.
 */
static const double distinct = 1e-6;

static void fill_modes(vibration *vibration, const design *design)
{
    const size_t outputs = (size_t)design->mesh.free_dof, inputs = design->structure.input.count;
    for (int k = 0; k < vibration->count; k++) {
        const scene_measured_mode *mode = &design->measured.mode[k];
        vibration->frequency[k] = mode->frequency;
        vibration->square[k] = pow(two_pi * mode->frequency, 2);
        memcpy(vibration->shape + (size_t)k * outputs, mode->shape, outputs * sizeof(double));
        for (size_t i = 0; i < outputs; i++)
            vibration->largest[k] = fmax(vibration->largest[k], fabs(mode->shape[i]));
        if (mode->response)
            memcpy(vibration->response + (size_t)k * inputs, mode->response,
                   inputs * sizeof(double));
    }
}

/* ---- static response from the influence matrix --------------------------- */

/*
 * Compute an orthonormal basis of the shapes of all modes, by Gram-Schmidt orthogonalisation.
 *   basis    [modes][outputs] out  orthonormal vectors
 *   triangle [modes][modes]   out  the shape of mode k is the sum over j <= k of triangle[j][k]
 *                                  times vector j of the basis
 *
 * Returns the number of the first mode whose shape is a combination of the shapes before it, or -1
 * if there is none.
 */
static int make_basis(const scene_influence *measured, double *basis, double *triangle)
{
    const size_t outputs = (size_t)measured->outputs, modes = (size_t)measured->modes;
    for (size_t k = 0; k < modes; k++) {
        double *vector = basis + k * outputs;
        memcpy(vector, measured->mode[k].shape, outputs * sizeof *vector);
        const double before = sqrt(pzs_linalg_inner(vector, vector, (uint32_t)outputs));
        for (int repeat = 0; repeat < 2; repeat++)
            for (size_t j = 0; j < k; j++) {
                const double part =
                    pzs_linalg_inner(basis + j * outputs, vector, (uint32_t)outputs);
                triangle[j * modes + k] += part;
                for (size_t i = 0; i < outputs; i++)
                    vector[i] -= part * basis[j * outputs + i];
            }
        const double size = sqrt(pzs_linalg_inner(vector, vector, (uint32_t)outputs));
        if (!(size > distinct * before))
            return (int)k;
        triangle[k * modes + k] = size;
        for (size_t i = 0; i < outputs; i++)
            vector[i] /= size;
    }
    return -1;
}

/*
 * Compute the static modal coordinates per volt of one amplifier: the least-squares fit of all mode
 * shapes to its column of the influence matrix.
 *   basis [modes][outputs]  in   orthonormal basis of the mode shapes
 *   triangle [modes][modes] in   coefficients of the mode shapes in this basis, from make_basis
 *   column [outputs]        out  work array: column of the influence matrix
 *   fitted [modes]          out  static modal coordinates per volt
 */
static void fit_column(const design *design, size_t amplifier, const double *basis,
                       const double *triangle, double *column, double *fitted)
{
    const scene_influence *measured = &design->measured;
    const size_t outputs = (size_t)measured->outputs, modes = (size_t)measured->modes;
    for (size_t i = 0; i < outputs; i++)
        column[i] = measured->matrix[i * (size_t)design->amplifiers + amplifier];
    for (size_t k = modes; k-- > 0;) {
        fitted[k] = pzs_linalg_inner(basis + k * outputs, column, (uint32_t)outputs);
        for (size_t j = k + 1; j < modes; j++)
            fitted[k] -= triangle[k * modes + j] * fitted[j];
        fitted[k] /= triangle[k * modes + k];
    }
}

/*
 * Fit the static modal coordinates per volt of all modes and amplifiers to the influence matrix.
 * Returns 0, or -1 with error filled.
 */
static int fit_responses(vibration *vibration, const design *design, char *error)
{
    const scene_influence *measured = &design->measured;
    const size_t outputs = (size_t)measured->outputs, modes = (size_t)measured->modes,
                 inputs = design->structure.input.count;
    double *basis = calloc(modes * (outputs + modes + 1) + outputs + 1, sizeof *basis);
    if (!basis)
        return scene_fault(measured->at, error, "out of memory");
    double *triangle = basis + modes * outputs, *fitted = triangle + modes * modes,
           *column = fitted + modes;
    (void)make_basis(measured, basis, triangle);
    for (size_t input = 0; input < inputs; input++) {
        fit_column(design, input, basis, triangle, column, fitted);
        for (size_t k = 0; k < (size_t)vibration->count; k++)
            vibration->response[k * inputs + input] = fitted[k];
    }
    free(basis);
    return 0;
}

int vibration_check_measured(const scene_influence *measured, char *error)
{
    const size_t outputs = (size_t)measured->outputs, modes = (size_t)measured->modes;
    if (modes == 0 || measured->mode[0].response)
        return 0;
    double *basis = calloc(modes * (outputs + modes) + 1, sizeof *basis);
    if (!basis)
        return scene_fault(measured->at, error, "out of memory");
    const int same = make_basis(measured, basis, basis + modes * outputs);
    free(basis);
    return same < 0 ? 0
                    : scene_fault(measured->at, error,
                                  "the shape of mode %d is a combination of the shapes before it; "
                                  "correct it, measure more outputs, or give fewer modes",
                                  same + 1);
}

int vibration_take_measured(vibration *vibration, const design *design, size_t number, char *error)
{
    if (design->measured.modes == 0)
        return scene_fault(design->measured.at, error,
                           "natural frequencies need a structure, and this scene has none: a "
                           "measured influence matrix tells nothing of mass; give the measured "
                           "modes, influence: {modes: [{frequency: ..., shape: ...}]}");
    if (!vibration_allocate(vibration, design, number))
        return scene_fault(design->measured.at, error, "%zu modes do not fit into memory", number);
    fill_modes(vibration, design);
    return design->measured.mode[0].response ? 0 : fit_responses(vibration, design, error);
}
