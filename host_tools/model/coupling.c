/* SPDX-License-Identifier: BSD-2-Clause */
/* Effective coupling factors of vibration modes (coupling.h). */
#include "coupling.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/linalg.h"
#include "mass.h"

/*
 * Number of short-circuited modes beyond that of the open ones among which each open mode is looked
 * for, because open electrodes may raise a mode above others.
 */
enum { FURTHER = 10 };

/* Largest relative difference of the frequencies of modes that count as one. */
static const double equal_within = 1e-4;

/*
 * Compute the products of the mass matrix of a design and the shapes of modes.
 *   product [count][free_dof] out  products
 * Returns 0, or -1 with error filled.
 */
static int multiply(const design *design, const vibration *modes, double *product, char *error)
{
    mass mass;
    pzs_model model;
    const pzs_structure *structure = &design->structure;
    const size_t bytes = PZS_MODEL_BYTES(
        structure->free_dof, pzs_linalg_reals(structure->first_column, structure->free_dof));
    void *work = malloc(bytes);
    int failed = mass_build(&mass, design, MASS_LUMPED, error);
    if (!failed && (!work || pzs_model_init(&model, structure, work, bytes) != PZS_OK))
        failed = scene_fault(design->at, error, "out of memory");
    if (!failed)
        mass_multiply(&mass, &model, modes->shape, (size_t)modes->count, product);
    mass_free(&mass);
    free(work);
    return failed;
}

/* Squared product of a short-circuited mode shape with the mass matrix times an open one. */
static double share_of(const vibration *shorted, int mode, const double *product, size_t free_dof)
{
    const double part =
        pzs_linalg_inner(shorted->shape + (size_t)mode * free_dof, product, (uint32_t)free_dof);
    return part * part;
}

/* Return whether two modes have equal frequencies. */
static bool are_equal(const vibration *modes, int i, int j)
{
    return fabs(modes->frequency[i] - modes->frequency[j]) <= equal_within * modes->frequency[i];
}

/*
 * Find the frequency with short-circuited electrodes of the mode that has the shape of an open one.
 *   product [free_dof] in  product of the mass matrix and the open mode shape
 * Returns NAN where no mode has it.
 */
static double partner_frequency(const vibration *shorted, const double *product, size_t free_dof)
{
    int best = 0;
    double most = 0, sum = 0;
    for (int mode = 0; mode < shorted->count; mode++) {
        const double share = share_of(shorted, mode, product, free_dof);
        if (share > most) {
            most = share;
            best = mode;
        }
    }
    for (int mode = 0; mode < shorted->count; mode++)
        if (are_equal(shorted, best, mode))
            sum += share_of(shorted, mode, product, free_dof);
    return sum > 0.5 ? shorted->frequency[best] : (double)NAN;
}

static void compare(coupling *coupling, const vibration *open, const vibration *shorted,
                    const double *product, size_t free_dof)
{
    for (int mode = 0; mode < open->count; mode++) {
        const double before =
            partner_frequency(shorted, product + (size_t)mode * free_dof, free_dof);
        const double ratio = before / open->frequency[mode];
        coupling->short_frequency[mode] = before;
        coupling->squared[mode] = mode < open->rigid ? (double)NAN : 1 - ratio * ratio;
    }
}

int coupling_find(coupling *coupling, const analysis *analysis, const vibration *open, char *error)
{
    const design *design = &analysis->design;
    const size_t free_dof = design->structure.free_dof, count = (size_t)open->count;
    vibration shorted;
    memset(coupling, 0, sizeof *coupling);
    if (analysis_vibration_of(analysis, CIRCUIT_SHORT, &shorted, open->count + FURTHER, error) < 0)
        return -1;
    double *product = malloc(count * free_dof * sizeof *product);
    coupling->short_frequency = calloc(count, sizeof *coupling->short_frequency);
    coupling->squared = calloc(count, sizeof *coupling->squared);
    int failed = -1;
    if (!product || !coupling->short_frequency || !coupling->squared)
        scene_fault(design->at, error, "%zu modes do not fit into memory", count);
    else
        failed = multiply(design, open, product, error);
    if (!failed) {
        coupling->count = open->count;
        compare(coupling, open, &shorted, product, free_dof);
    }
    free(product);
    vibration_free(&shorted);
    return failed;
}

void coupling_free(coupling *coupling)
{
    free(coupling->short_frequency);
    free(coupling->squared);
    memset(coupling, 0, sizeof *coupling);
}
