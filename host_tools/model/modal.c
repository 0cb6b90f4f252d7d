/* SPDX-License-Identifier: BSD-2-Clause */
/* Modal description of a structure from its mode shapes (modal.h). */
#include "modal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"

double modal_damping(const scene_dynamics *dynamics, int mode, double frequency)
{
    if (dynamics->is_rayleigh)
        return dynamics->rayleigh[0] / (2 * frequency) + dynamics->rayleigh[1] * frequency / 2;
    if (dynamics->dampings == 0)
        return dynamics->damping;
    return dynamics->damping_of_mode[mode < dynamics->dampings ? mode : dynamics->dampings - 1];
}

double vibration_damping(const vibration *vibration, const design *design, int mode)
{
    if (mode < vibration->rigid)
        return (double)NAN;
    return modal_damping(&design->dynamics, mode - vibration->rigid, sqrt(vibration->square[mode]));
}

/*
 * Fill the data of one vibration mode: angular frequency, damping ratio, displacements of the
 * outputs, and static response to the inputs.
 */
static void fill_mode(modal *modal, const design *design, const vibration *vibration, size_t mode)
{
    const int of = vibration->rigid + (int)mode;
    const double *vector = vibration->shape + (size_t)of * (size_t)design->mesh.free_dof;
    modal->frequency[mode] = sqrt(vibration->square[of]);
    modal->damping[mode] = modal_damping(&design->dynamics, (int)mode, modal->frequency[mode]);
    for (size_t row = 0; row < modal->rows; row++)
        modal->shape[row * modal->modes + mode] =
            pzs_model_observe_row(&design->structure, vector, (uint32_t)row);
    for (size_t k = 0; k < modal->inputs; k++)
        modal->response[mode * modal->inputs + k] = vibration_static(vibration, design, of, (int)k);
}

/* Allocate the modal description of all vibration modes that are no rigid motions. */
static bool allocate(modal *modal, const design *design, const vibration *vibration, size_t inputs)
{
    memset(modal, 0, sizeof *modal);
    modal->modes = (size_t)(vibration->count - vibration->rigid);
    modal->rows = design->structure.output.count;
    modal->inputs = inputs;
    modal->frequency = calloc(modal->modes + 1, sizeof *modal->frequency);
    modal->damping = calloc(modal->modes + 1, sizeof *modal->damping);
    modal->shape = calloc(modal->rows * modal->modes + 1, sizeof *modal->shape);
    modal->response = calloc(modal->modes * inputs + 1, sizeof *modal->response);
    return modal->frequency && modal->damping && modal->shape && modal->response;
}

bool modal_open(modal *modal, const design *design, const vibration *vibration, size_t inputs)
{
    if (!allocate(modal, design, vibration, inputs))
        return false;
    for (size_t mode = 0; mode < modal->modes; mode++)
        fill_mode(modal, design, vibration, mode);
    return true;
}

/* Allocate a copy of an array; NULL where memory runs out. */
static double *copy_of(const double *value, size_t count)
{
    double *copy = malloc((count + 1) * sizeof *copy);
    return copy ? memcpy(copy, value, count * sizeof *copy) : NULL;
}

bool modal_copy(modal *to, const modal *from)
{
    *to = *from;
    to->frequency = copy_of(from->frequency, from->modes);
    to->damping = copy_of(from->damping, from->modes);
    to->shape = copy_of(from->shape, from->rows * from->modes);
    to->response = copy_of(from->response, from->modes * from->inputs);
    return to->frequency && to->damping && to->shape && to->response;
}

void modal_close(modal *modal)
{
    free(modal->frequency);
    free(modal->damping);
    free(modal->shape);
    free(modal->response);
    memset(modal, 0, sizeof *modal);
}
