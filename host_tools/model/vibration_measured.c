/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration modes of a structure that is known by its measured influence matrix (vibration.h), with
 * the outputs as dof. The static response is the sum over the modes of shape times modal coordinate
 * in equilibrium, plus the response of modes that are left out.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "matrix_modes.h"
#include "vibration.h"

static const double two_pi = 6.283185307179586;

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
 * Fit, by least squares, the modal coordinates of all vibration modes in equilibrium under 1 V at
 * each amplifier to the columns of the measured influence matrix. Returns 0, or -1 with error
 * filled.
 */
static int fit_responses(vibration *vibration, const design *design, char *error)
{
    const scene_influence *measured = &design->measured;
    const size_t outputs = (size_t)measured->outputs, modes = (size_t)measured->modes,
                 inputs = design->structure.input.count;
    double *basis = calloc(modes * (outputs + modes + 1) + 1, sizeof *basis);
    if (!basis)
        return scene_fault(measured->at, error, "out of memory");
    double *triangle = basis + modes * outputs, *fitted = triangle + modes * modes;
    (void)matrix_modes_basis(measured, basis, triangle);
    for (size_t input = 0; input < inputs; input++) {
        matrix_modes_response(measured, (size_t)design->amplifiers, input, basis, triangle, fitted);
        for (size_t k = 0; k < (size_t)vibration->count; k++)
            vibration->response[k * inputs + input] = fitted[k];
    }
    free(basis);
    return 0;
}

/*
 * Whether two measured modes are one and the same: equal frequencies, and shapes that differ by a
 * factor alone.
 */
static bool are_same(const scene_influence *measured, size_t one, size_t other)
{
    static const double equal = 1e-6;
    const scene_measured_mode *first = &measured->mode[one], *second = &measured->mode[other];
    double product = 0, sizes[2] = {0, 0};
    for (int i = 0; i < measured->outputs; i++) {
        product += first->shape[i] * second->shape[i];
        sizes[0] += first->shape[i] * first->shape[i];
        sizes[1] += second->shape[i] * second->shape[i];
    }
    return fabs(first->frequency - second->frequency) < equal * first->frequency &&
           product * product > (1 - equal * equal) * sizes[0] * sizes[1];
}

/* Refuse a mode that is given twice. Returns 0, or -1 with error filled. */
static int check_repeated(const scene_influence *measured, char *error)
{
    for (size_t k = 1; k < (size_t)measured->modes; k++)
        for (size_t j = 0; j < k; j++)
            if (are_same(measured, j, k))
                return scene_fault(measured->at, error,
                                   "modes %zu and %zu have the same frequency and the same shape, "
                                   "but for a factor; remove one of them, or give the other shape "
                                   "of the pair",
                                   j + 1, k + 1);
    return 0;
}

int vibration_check_measured(const scene_influence *measured, char *error)
{
    const size_t outputs = (size_t)measured->outputs, modes = (size_t)measured->modes;
    if (check_repeated(measured, error) < 0)
        return -1;
    if (modes == 0 || measured->mode[0].response)
        return 0;
    double *basis = calloc(modes * (outputs + modes) + 1, sizeof *basis);
    if (!basis)
        return scene_fault(measured->at, error, "out of memory");
    const int same = matrix_modes_basis(measured, basis, basis + modes * outputs);
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
