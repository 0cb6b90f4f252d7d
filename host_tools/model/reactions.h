/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reactions: forces and moments of the supports on the shell, at the deformed shell under nonlinear
 * kinematics. The reaction on a constrained dof is the internal force of the elements minus the
 * forces of loads, springs and contact. Host only: device tables have no constrained dof.
 */
#ifndef REACTIONS_H
#define REACTIONS_H

#include <stdbool.h>
#include "design.h"
#include "equilibrium.h"

/* Resultant of several forces, and its moment about a point that the user of this type chooses. */
typedef struct total_force {
    double force[3];  /* components of the resultant force along x, y and z (N) */
    double moment[3]; /* components of the resultant moment about x, y and z (N m) */
} total_force;

/* Force and moment by which all supports of the same name hold the shell. */
typedef struct support_reaction {
    const char *name;
    int nodes; /* number of nodes at which the supports of one name hold or prescribe a dof */
    double centre[3]; /* mean of the undeformed positions of the nodes that the supports of one name
                         hold (m) */
    total_force total; /* force of the supports on the shell, and its moment about `centre` */
} support_reaction;

/* Reactions of a solved structure; empty (nodes = 0) where none are computed. */
typedef struct reactions {
    int nodes;          /* number of nodes of the mesh */
    double (*node)[6];  /* [nodes] force of the supports on the shell at each node along x, y and z
                           (N), and their moment about the node (N m) */
    double (*place)[3]; /* [nodes] positions of the nodes at which the forces act (m) */
    int supports;       /* number of different names of supports that hold a dof */
    support_reaction *support; /* [supports] reactions of the supports of each name */
    total_force held;    /* resultant force (N) of all supports on the shell, and its moment about
                            the origin (N m) */
    total_force load;    /* resultant force (N) of all loads on the shell, and its moment about the
                            origin (N m) */
    total_force spring;  /* resultant force (N) of all springs and stack actuators on the shell, and
                            its moment about the origin (N m) */
    total_force contact; /* resultant force (N) of the contact body on the shell, and its moment
                            about the origin (N m) */
    total_force sum; /* sum of the forces of supports, loads, springs and contact body, and of their
                        moments, which vanishes at equilibrium */
    double internal; /* sum of the magnitudes of all elements' internal forces at their corners (N),
                        a measure of the rounding error of `sum` */
} reactions;

/* Solved structure: displacement, and the input values under which it was computed. */
typedef struct reaction_state {
    const design *design;
    const double *displacement; /* [free_dof] displacement vector of the structure */
    const double *input_value;  /* [inputs] voltages (V), load factors and temperatures (K) under
                                   which the displacement was computed */
    const equilibrium *equilibrium; /* equilibrium solver in whose present state the reactions are
                                       computed; NULL: the structure is linear */
} reaction_state;

/*
 * Compute the reactions of a solved structure. The result is empty if the dof of all nodes, with
 * the constrained ones, cannot be numbered in 16 bits. The names of supports in the result belong
 * to the scene. Returns 0, or -1 where memory runs out.
 */
int reactions_compute(reactions *reactions, const reaction_state *state);

void reactions_free(reactions *reactions);

/*
 * Return a component of the force or moment of all supports on some nodes. The moment is about the
 * mean of their undeformed positions.
 *   node [count] in  node numbers
 *   component    in  0 to 2: force along x, y, z; 3 to 5: moment about x, y, z
 * Returns NAN where no reactions are computed.
 */
double reactions_at(const reactions *reactions, const mesh *mesh, const int *node, int count,
                    int component);

/*
 * Return a component of the force (0 to 2) or of the moment about the centre (3 to 5) of the
 * supports of one name. Where several supports hold a dof, its reaction counts for the first one
 * alone. The result is 0 for supports without such a dof, NAN where no reactions are computed.
 */
double reactions_of(const reactions *reactions, const char *name, int component);

#endif
