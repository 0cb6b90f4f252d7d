/*
 * Helpers of tests of the equilibrium solver: changes of scenes, the equilibrium of a scene,
 * comparison of vectors. Include it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef PATH_RUN_H
#define PATH_RUN_H

#include "pzs.h"
#include "scene_assert.h"

/* Changes of a scene, each ended by a semicolon. */
#define MESH(n1, n2) "mesh.theta1.elements=" #n1 ";mesh.theta2.elements=" #n2 ";"
#define HALF_TURN "actuators.v.applied=4*0.05^2*(pi/10)/(3*1e-6);"
/* The way of the drum of the scene torus-contact at which a second program made its references, and
 * the mesh and the dof of that program.
 */
#define TORUS_17 "contact.move=[-17, 0, 0];"
#define TORUS_36                                                                                   \
    TORUS_17 "dof_per_node=7;mesh.theta2={from: -pi, to: pi, elements: 36, centre: 0.3};"
#define BASE_100                                                                                   \
    "contact.body={type: cylinder, point: [200.5, 0, 0], axis: [0, 0, 1], radius: 100};"
#define BASE_FLAT "contact.body={type: plane, point: [100.5, 0, 0], normal: [-1, 0, 0]};"

#define COUNT(a) (sizeof(a) / sizeof *(a))

static inline pzs_solver *path_of(scene_run *run)
{
    return &run->analysis.equilibrium.solver;
}

static inline size_t dof_of(const scene_run *run)
{
    return (size_t)run->analysis.design.mesh.free_dof;
}

static inline double largest(const double *vector, size_t count)
{
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs(vector[i]));
    return most;
}

/*
 * Largest difference of two vectors, relative to the largest entry of the second; infinite if an
 * entry of the first is.
 */
static inline double apart(const double *found, const double *expected, size_t count)
{
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = isfinite(found[i]) ? fmax(most, fabs(found[i] - expected[i])) : HUGE_VAL;
    return most / largest(expected, count);
}

#endif
