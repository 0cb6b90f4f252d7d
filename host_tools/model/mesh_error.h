/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Discretisation error of results, estimated by repeating the analysis on meshes with a half and,
 * where possible, a quarter of the elements in each direction (Richardson extrapolation).
 */
#ifndef MESH_ERROR_H
#define MESH_ERROR_H

#include "../scene/scene.h"

enum { MESH_VALUES = 64, MESH_LEVELS = 3 };

/* Named results of one analysis whose dependence on the mesh is examined. */
typedef struct mesh_values {
    int count;
    struct {
        char name[SCENE_LABEL];
        double value;
    } item[MESH_VALUES];
} mesh_values;

/* Estimated discretisation error of one result of an analysis. */
typedef struct mesh_estimate {
    double value; /* value of a result of the analysis, such as a displacement, on the mesh of the
                     scene */
    double extrapolated; /* value that the result would have with infinitely many elements, by
                            extrapolation */
    double uncertainty;  /* half width of the interval around the extrapolated value in which the
                            exact result is expected */
    double order; /* observed order of convergence. NAN where no order can be observed, because
                     there are only two meshes or the results do not converge monotonically */
} mesh_estimate;

typedef struct mesh_error {
    int meshes; /* number of meshes that were analysed, 2 or 3; 0: no estimate was asked for */
    int elements[MESH_LEVELS][2]; /* number of elements along the surface coordinates theta1 and
                                     theta2 on each mesh, the scene's mesh first */
    mesh_values values;           /* all results of the analysis on the mesh of the scene */
    mesh_estimate estimate[MESH_VALUES];
    char why_two[SCENE_ERROR]; /* where only two meshes were analysed, the reason why there is no
                                  third one */
} mesh_error;

/*
 * Estimate the discretisation error from the results on two or three meshes, the element size of
 * which halves from one to the next. The result is extrapolated with second order. The uncertainty,
 * at least 1e-9 of the result, is
 *   1.5 |d|                                      for two meshes
 *   max(|d|, |c|/4)                              for three meshes
 *   max(|d|, |c|/4) + |d|/(c/d - 1) - |d|/3      for three meshes, convergence below second order
 *   (4 |d| + |c|)/3                              for results that rise and then fall, or the
 *       reverse
 * with the difference d between the two finest meshes and c between the second and the third
 * finest.
 *   value [meshes] in  results, that of the finest mesh first
 *   meshes         in  2 or 3
 */
mesh_estimate mesh_estimate_from(const double *value, int meshes);

/*
 * Append a named result to those whose discretisation error is estimated. A result beyond the
 * largest number of results (MESH_VALUES) is ignored.
 */
void mesh_values_add(mesh_values *values, const char *name, double value);

/*
 * Function that computes the results of one scene, called for every mesh. `context` is passed on
 * unchanged. Returns 0, or -1 with error filled.
 */
typedef int mesh_measure(const scene *scene, const void *context, mesh_values *values, char *error);

/*
 * Repeat an analysis on coarser meshes and estimate the discretisation error of its results by
 * extrapolation.
 */
int mesh_error_make(mesh_error *result, const scene *scene, const mesh_values *values,
                    mesh_measure *measure, const void *context, char *error);

#endif
