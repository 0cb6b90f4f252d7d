/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A general mesh of quadrilaterals, in any arrangement: what a reader of mesh files or a mesh
 * generator produces, and what element types, loads and the numbering of dof are built from.
 *
 * Index numbers start at 0. All arrays are owned by the mesh; quad_mesh_free releases them.
 */
#ifndef QUAD_MESH_H
#define QUAD_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Named set of nodes, elements or edges. An edge is written as 4 element + side; side s joins the
 * corners s and (s + 1) % 4 of the element.
 */
typedef struct quad_set {
    char *name;      /* name of the group in the mesh file, or of the generator */
    size_t count;    /* members of the set */
    uint32_t *index; /* [count] node, element or edge numbers, ascending, without repetition */
} quad_set;

/* Layers of a group of elements. */
typedef struct quad_region {
    uint32_t present_plies; /* bit i is set where ply i of the laminate is present */
    double direction[3]; /* vector that becomes material axis 1 when it is projected on an element;
                            0: the element's own direction 1 */
} quad_region;

typedef struct quad_mesh {
    size_t nodes, elements, regions;
    double (*position)[3]; /* [nodes] points on the reference surface (m) */
    double (*director)[3]; /* [nodes] unit normals towards the outer face: e3 of the node's triad */
    double (*axis)[3]; /* [nodes] unit vectors e1 of the triads, normal to the director; e2 = e3 x
                          e1 */
    uint8_t *constrained; /* [nodes] bit i is set where dof i of the node is held at 0; NULL: none
                           */
    uint32_t *order;     /* [nodes] the nodes in the order in which their dof are numbered; NULL: as
                            they are */
    int64_t *node_label; /* [nodes] numbers of the nodes in the mesh file; NULL: none */
    int64_t *element_label;   /* [elements] numbers of the elements in the mesh file; NULL: none */
    uint32_t (*element)[4];   /* [elements] nodes of the corners (-,-) (+,-) (+,+) (-,+), counted
                                 counterclockwise when seen from the outer face */
    double *area;             /* [elements] exact areas (m2); NULL: from nodes and directors */
    uint32_t *element_region; /* [elements] the element's region; NULL: region 0 everywhere */
    quad_region *region;      /* [regions] layers of each region, at least one */
    size_t node_sets, element_sets, edge_sets;
    quad_set *node_set;    /* [node_sets] */
    quad_set *element_set; /* [element_sets] */
    quad_set *edge_set;    /* [edge_sets] */
    uint32_t hash;         /* hash of the mesh file; 0: the mesh comes from no file */
} quad_mesh;

/* Release the arrays of a mesh, which is empty afterwards. */
void quad_mesh_free(quad_mesh *mesh);

/* Sort the members of a set and drop repetitions. */
void quad_set_sort(quad_set *set);

/* Set of that name among `count` sets, or NULL. */
const quad_set *quad_set_find(const quad_set *set, size_t count, const char *name);

/* Whether a set contains an index. */
bool quad_set_has(const quad_set *set, uint32_t index);

/*
 * Global axis (0, 1, 2) whose projections can be the axes of all nodes, because no director comes
 * near it: the one that all directors avoid most. -1: there is none, as on half a sphere.
 */
int quad_common_axis(const quad_mesh *mesh);

/*
 * Axis of a node that nothing prescribes: the projection of the common axis, or where that is -1 of
 * the global axis least aligned with the director.
 */
void quad_default_axis(const double director[3], int common, double axis[3]);

#endif
