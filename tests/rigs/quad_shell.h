/*
 * Shells on general meshes, made without scenes: blocks of quadrilaterals mapped to space, supports
 * chosen node by node, loads of constant direction, and linear solution. For test programs in
 * double.
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
    double (*force)[7];                 /* [nodes] nodal forces on the seven degrees of freedom */
    double (*u)[7];                     /* [nodes] displacement in the seven degrees of freedom */
    uint32_t load_steps, linear_solves; /* of the last equilibrium */
    char error[SCENE_ERROR];
} quad_shell;

/*
 * Function that maps the point (s, t) of the unit square to a position x [3] with the unit normal d
 * [3].
 */
typedef void quad_map(const void *data, double s, double t, double x[3], double d[3]);

/*
 * Start a shell of one isotropic layer of the given thickness about the reference surface, without
 * elements.
 */
void quad_shell_init(quad_shell *shell, double thickness, double young, double poisson);

/*
 * Add a block of n1 x n2 elements. Nodes at the positions of nodes of earlier blocks are shared,
 * and their directors become the mean. The inner nodes of the block are moved at random by up to
 * `distortion` of an element in s and t.
 */
void quad_shell_block(quad_shell *shell, int n1, int n2, quad_map *map, const void *data,
                      double distortion, unsigned seed);

/* Add one element with given corners, directors and axes. */
void quad_shell_single(quad_shell *shell, const double corner[4][3], const double director[4][3],
                       const double axis[4][3]);

/*
 * Hold degrees of freedom (bits) at the nodes in a plane, where |(x - point) . normal| < 1e-9. The
 * unit vector e1 there becomes `axis`, unless it is NULL. A new axis at a node replaces an earlier
 * one and its supports.
 */
void quad_shell_hold(quad_shell *shell, const double point[3], const double normal[3],
                     const double *axis, unsigned dof);

/*
 * Make x_i = 0 a plane of symmetry: directors lie in the plane, e1 is its normal, and mean and
 * difference of displacement 1 are held.
 */
void quad_shell_symmetry(quad_shell *shell, int i);

/* Return the node nearest to a point. */
int quad_shell_nearest(const quad_shell *shell, double x, double y, double z);

/*
 * Build the mesh, with nodes numbered along the direction `sweep`. Returns 0, or -1 with a message
 * in shell->error.
 */
int quad_shell_build(quad_shell *shell, const double sweep[3]);

/*
 * After quad_shell_build, add a Cartesian force or a couple at a node, or a uniform traction of
 * constant direction.
 */
void quad_shell_force(quad_shell *shell, int node, const double force[3]);
void quad_shell_couple(quad_shell *shell, int node, const double couple[3]);
void quad_shell_traction(quad_shell *shell, const double traction[3]);

/* Add a traction along the directors, given by a function of the position at the nodes. */
void quad_shell_pressure(quad_shell *shell, double (*pressure)(const double position[3]));

/* Solve for the linear displacement under the force. Returns the status of the library. */
pzs_status quad_shell_solve(quad_shell *shell);

/*
 * Compute the equilibrium under the force at large rotation, and count its load steps and linear
 * solves. Returns the status of the library.
 */
pzs_status quad_shell_equilibrium(quad_shell *shell);

/* Cartesian displacement of the reference surface at a node. */
void quad_shell_displacement(const quad_shell *shell, int node, double displacement[3]);

/* Sum over all degrees of freedom of force times displacement. */
double quad_shell_work(const quad_shell *shell);

void quad_shell_close(quad_shell *shell);

#endif
