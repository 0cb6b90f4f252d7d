/* SPDX-License-Identifier: BSD-2-Clause */
/* Estimation of the discretisation error from coarser meshes (mesh_error.h). */
#include "mesh_error.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- estimate --------------------------------------------------------- */

/*
 * Smallest uncertainty of a result, relative to the result. It covers the rounding errors of the
 * linear solves. Some results, such as the reaction of a statically determinate support, have no
 * discretisation error, only these rounding errors.
 */
static const double LEAST_UNCERTAINTY = 1e-9;

/*
 * Return the expected error of an extrapolated result if it converges more slowly than with second
 * order, which the extrapolation assumes. Differences between further and further meshes would form
 * a geometric series with the sum last/(ratio - 1). The extrapolation has added last/3; the error
 * is the difference of both numbers.
 *   last  in  difference between the results on the two finest meshes
 *   ratio in  difference between the second and the third finest, divided by `last`; 4 for second
 *       order; values below SLOWEST count as SLOWEST
 */
static double remaining_error(double last, double ratio)
{
    const double SLOWEST = 1.25, second_order = 1.0 / 3;
    return fabs(last) * (1 / (fmax(ratio, SLOWEST) - 1) - second_order);
}

/*
 * Return the error of the extrapolated value of results that first rise and then fall with finer
 * meshes, or the reverse. Such results behave as limit + a h - b h^2 with element size h and a, b
 * of the same sign. Second-order extrapolation then has the error 2/3 a h.
 *   last   in  difference between the results on the two finest meshes
 *   before in  difference between the results on the second and the third finest mesh
 */
static double error_after_turn(double last, double before)
{
    return (4 * fabs(last) + fabs(before)) / 3;
}

mesh_estimate mesh_estimate_from(const double *value, int meshes)
{
    const double last = value[0] - value[1], rounding = LEAST_UNCERTAINTY * fabs(value[0]);
    mesh_estimate result = {value[0], value[0] + last / 3, fmax(1.5 * fabs(last), rounding),
                            (double)NAN};
    if (meshes < 3)
        return result;
    const double before = value[1] - value[2];
    const double ratio = before / last;
    result.uncertainty = fmax(fabs(last), fabs(before) / 4);
    if (ratio > 0 && ratio < 4)
        result.uncertainty += remaining_error(last, ratio);
    if (ratio < 0)
        result.uncertainty = error_after_turn(last, before);
    result.uncertainty = fmax(result.uncertainty, rounding);
    if (ratio > 1 && fabs(last) > rounding)
        result.order = log2(ratio);
    return result;
}

/* ---- coarser meshes --------------------------------------------------- */

/* Half the number of elements in one direction; 0 where the number cannot be halved. */
static int half_of(int elements)
{
    if (elements == 1)
        return 1;
    return elements % 2 == 0 ? elements / 2 : 0;
}

/*
 * Compute the numbers of elements of the next coarser mesh, half as many in each direction. Returns
 * 0, or -1 with the reason in error.
 */
static int halve(const int fine[2], int coarse[2], char *error)
{
    for (int i = 0; i < 2; i++) {
        coarse[i] = half_of(fine[i]);
        if (coarse[i] == 0) {
            snprintf(error, SCENE_ERROR,
                     "mesh.theta%d has %d elements, which cannot be halved: choose an even number",
                     i + 1, fine[i]);
            return -1;
        }
    }
    if (coarse[0] == fine[0] && coarse[1] == fine[1]) {
        snprintf(error, SCENE_ERROR, "a mesh of %d x %d elements cannot be halved", fine[0],
                 fine[1]);
        return -1;
    }
    return 0;
}

/* Read the scene again with other numbers of elements. Returns 0, or -1 with error filled. */
static int read_coarser(scene *coarse, const scene *fine, const int elements[2], char *error)
{
    enum { CHANGE = 48 };
    char change[2][CHANGE];
    const char **set = calloc((size_t)fine->origin->sets + 2, sizeof *set);
    if (!set) {
        snprintf(error, SCENE_ERROR, "out of memory");
        return -1;
    }
    for (int i = 0; i < fine->origin->sets; i++)
        set[i] = fine->origin->set[i];
    for (int i = 0; i < 2; i++) {
        snprintf(change[i], CHANGE, "mesh.theta%d.elements=%d", i + 1, elements[i]);
        set[fine->origin->sets + i] = change[i];
    }
    const int failed = scene_read(coarse, fine->origin->path, set, fine->origin->sets + 2, error);
    free(set);
    return failed;
}

/*
 * Check that the results on a coarser mesh are those on the mesh of the scene: as many, with the
 * same names in the same order. Returns 0, or -1 with error filled.
 */
static int compare_names(const mesh_values *fine, const mesh_values *coarse, char *error)
{
    if (coarse->count != fine->count) {
        snprintf(error, SCENE_ERROR, "it has %d results instead of %d", coarse->count, fine->count);
        return -1;
    }
    for (int k = 0; k < fine->count; k++)
        if (strcmp(coarse->item[k].name, fine->item[k].name) != 0) {
            snprintf(error, SCENE_ERROR, "its result %d is '%.80s' instead of '%.80s'", k + 1,
                     coarse->item[k].name, fine->item[k].name);
            return -1;
        }
    return 0;
}

/*
 * Compute, on one coarser mesh, the results whose discretisation error is estimated, and check that
 * they have the same names as on the mesh of the scene. Returns 0, or -1 with error filled.
 */
static int measure_coarser(const mesh_error *result, const scene *fine, const int elements[2],
                           mesh_measure *measure, const void *context, mesh_values *values,
                           char *error)
{
    scene coarse;
    char cause[SCENE_ERROR];
    values->count = 0;
    int failed = read_coarser(&coarse, fine, elements, cause);
    if (!failed) {
        failed = measure(&coarse, context, values, cause);
        scene_free(&coarse);
    }
    if (!failed)
        failed = compare_names(&result->values, values, cause);
    if (failed)
        snprintf(error, SCENE_ERROR, "no coarser mesh of %d x %d elements: %.300s", elements[0],
                 elements[1], cause);
    return failed;
}

static void estimate_all(mesh_error *result, const mesh_values *coarser)
{
    for (int k = 0; k < result->values.count; k++) {
        double value[MESH_LEVELS] = {result->values.item[k].value};
        for (int level = 1; level < result->meshes; level++)
            value[level] = coarser[level - 1].item[k].value;
        result->estimate[k] = mesh_estimate_from(value, result->meshes);
    }
}

int mesh_error_make(mesh_error *result, const scene *scene, const mesh_values *values,
                    mesh_measure *measure, const void *context, char *error)
{
    memset(result, 0, sizeof *result);
    if (scene->quads) {
        snprintf(error, SCENE_ERROR,
                 "--error: a mesh of a panel, of a disc or from a file has no coarser meshes: "
                 "halve the size of its elements and compare");
        return -1;
    }
    if (values->count == 0) {
        snprintf(error, SCENE_ERROR,
                 "--error: the scene has no output with a single value: add one to outputs");
        return -1;
    }
    mesh_values *coarser = calloc(MESH_LEVELS - 1, sizeof *coarser);
    int failed = coarser ? 0 : -1;
    result->values = *values;
    result->meshes = 1;
    for (int i = 0; i < 2; i++)
        result->elements[0][i] = scene->line[i].elements;
    snprintf(result->why_two, SCENE_ERROR, "out of memory");
    for (int level = 1; level < MESH_LEVELS && !failed; level++) {
        int *elements = result->elements[level];
        failed = halve(result->elements[level - 1], elements, result->why_two) < 0 ||
                 measure_coarser(result, scene, elements, measure, context, &coarser[level - 1],
                                 result->why_two) < 0;
        if (!failed)
            result->meshes++;
    }
    if (result->meshes > 1)
        estimate_all(result, coarser);
    else
        snprintf(error, SCENE_ERROR, "--error: %.360s", result->why_two);
    free(coarser);
    return result->meshes > 1 ? 0 : -1;
}
