/* SPDX-License-Identifier: BSD-2-Clause */
/* Points of a mesh that need not be nodes, such as the points where springs are attached. */
#ifndef MESH_SPOT_H
#define MESH_SPOT_H

#include "mesh.h"

/*
 * Point of a mesh that need not be a node. Its displacement is the weighted sum of the
 * displacements of `count` nodes: 1, or the 4 nodes of an element.
 */
typedef struct mesh_spot {
    int count; /* number of nodes whose displacements determine that of the point: 1 for a point
                  that is a node, 4 for a point in an element */
    int node[4];
    double weight[4]; /* weights of the nodes whose displacements determine that of the point:
                         bilinear functions of its position in the element, with the sum 1 */
} mesh_spot;

/* Return the mesh point that coincides with a node. */
mesh_spot mesh_spot_of_node(int node);

/*
 * Find the mesh point at given coordinates: the surface coordinates theta1 and theta2, or on a mesh
 * from a file x, y and z, where z = NAN is not compared. Returns 0, or -1 if no element contains
 * the point.
 */
int mesh_spot_find(const mesh *mesh, const double point[3], mesh_spot *spot);

/*
 * Write an error message about a point that no element contains.
 *   at        in   line of the scene file that the message names
 *   k         in   index of the point in its list, from 0
 *   point [3] in   surface coordinates theta1 and theta2; on a mesh from a file x, y and z, NAN for
 *       a z that is not given
 * Returns -1.
 */
int mesh_spot_refuse(scene_at at, int k, const double point[3], char *error);

/*
 * Find the mesh point at which one of several equal springs or stacks is attached.
 *   spring    in   entry of the scene's list `springs`, or stacks of an actuator, which may name
 *       several points or a place with several nodes
 *   k         in   index of the point or node, from 0
 *   spot      out  the mesh point
 *   place [2] out  its surface coordinates theta1 and theta2; on a mesh from a file, x and y
 * Returns 0, or -1 if there is no such point or memory runs out.
 */
int mesh_spot_of_spring(const mesh *mesh, const scene_spring *spring, int k, mesh_spot *spot,
                        double place[2]);

/* Compute the position of a mesh point in space (x [3] out). */
void mesh_spot_place(const mesh *mesh, const mesh_spot *spot, double place[3]);

#endif
