/* SPDX-License-Identifier: BSD-2-Clause */
/* Points of a mesh between its nodes. */
#ifndef MESH_SPOT_H
#define MESH_SPOT_H

#include "mesh.h"

/*
 * A point of the mesh: its displacement is the sum of weight times the displacement of each node.
 */
typedef struct mesh_spot {
    int count; /* 1: the point is a node; 4: the point lies in an element */
    int node[4];
    double weight[4]; /* bilinear, with the sum 1 */
} mesh_spot;

/* The spot at a node. */
mesh_spot mesh_spot_of_node(int node);

/*
 * Find a point: by theta1 and theta2, or on a mesh from a file by x, y and z, of which z may be NAN
 * and is then not compared. Returns 0, or -1 where no element contains the point.
 */
int mesh_spot_find(const mesh *mesh, const double point[3], mesh_spot *spot);

/* Position of a spot on the mesh. x [3] out */
void mesh_spot_place(const mesh *mesh, const mesh_spot *spot, double x[3]);

#endif
