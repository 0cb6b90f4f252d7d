/*
 * Shells on general meshes, made without scenes: blocks of quadrilaterals mapped to space, supports
 * chosen node by node, dead loads, and linear solution. For test programs in double.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef QUAD_SHELL_H
#define QUAD_SHELL_H

#include "../../host_tools/mesh/mesh.h"

enum { QUAD_SHELL_LAYERS = 8 };

typedef struct quad_shell {
    scene scene;
    scene_layer layer[QUAD_SHELL_LAYERS];
    scene_material material[QUAD_SHELL_LAYERS];
    quad_mesh quads;
    mesh mesh;
    bool is_built, accept_irregular;
    double (*force)[7]; /* [nodes] nodal forces on the seven dof */
    double (*u)[7];     /* [nodes] displacement */
    char error[SCENE_ERROR];
} quad_shell;

/* Position x [3] and unit normal d [3] at (s, t) in the unit square. */
typedef void quad_map(const void *data, double s, double t, double x[3], double d[3]);

/* One isotropic layer of thickness h about the reference surface; nothing else is set. */
void quad_shell_init(quad_shell *shell, double thickness, double young, double poisson);

/*
 * Add a block of n1 x n2 elements. Nodes that lie on nodes of earlier blocks are shared; their
 * directors become the mean. The inner nodes of the block are moved at random by up to `distortion`
 * of an element in s and t.
 */
void quad_shell_block(quad_shell *shell, int n1, int n2, quad_map *map, const void *data,
                      double distortion, unsigned seed);

/* One element from given corners, directors and axes. */
void quad_shell_single(quad_shell *shell, const double corner[4][3], const double director[4][3],
                       const double axis[4][3]);

/*
 * Hold dof (bits) at the nodes where |(x - point) . normal| < 1e-9; e1 there becomes `axis`, if
 * any. A new axis at a node takes the place of an earlier one and of its supports.
 */
void quad_shell_hold(quad_shell *shell, const double point[3], const double normal[3],
                     const double *axis, unsigned dof);

/* Symmetry about the plane x_i = 0: directors into the plane, e1 = normal, mean 1 and difference 1.
 */
void quad_shell_symmetry(quad_shell *shell, int i);

/* Node nearest to a point. */
int quad_shell_nearest(const quad_shell *shell, double x, double y, double z);

/* Build the mesh; nodes are numbered along `sweep`. Returns 0, or -1 with shell->error filled. */
int quad_shell_build(quad_shell *shell, const double sweep[3]);

/* Add a Cartesian force, or a couple, at a node; a uniform dead traction; after the build. */
void quad_shell_force(quad_shell *shell, int node, const double force[3]);
void quad_shell_couple(quad_shell *shell, int node, const double couple[3]);
void quad_shell_traction(quad_shell *shell, const double traction[3]);

/* Traction p(x) d along the directors, p given at the nodes. */
void quad_shell_pressure(quad_shell *shell, double (*pressure)(const double position[3]));

/* Solve K u = force. Returns a pzs_status. */
pzs_status quad_shell_solve(quad_shell *shell);

/* Equilibrium under the force at large rotation; linear_solves out. Returns a pzs_status. */
pzs_status quad_shell_equilibrium(quad_shell *shell, uint32_t *linear_solves);

/* Cartesian displacement of the reference surface at a node. */
void quad_shell_displacement(const quad_shell *shell, int node, double displacement[3]);

/* Sum of force times displacement over all dof. */
double quad_shell_work(const quad_shell *shell);

void quad_shell_close(quad_shell *shell);

#endif
