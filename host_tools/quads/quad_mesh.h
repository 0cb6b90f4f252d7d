/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * General mesh of quadrilaterals in any arrangement: mesh files and mesh generators produce it;
 * element types, loads and dof numbers are built from it. Indices start at 0. The mesh owns all
 * arrays; quad_mesh_free releases them.
 */
#ifndef QUAD_MESH_H
#define QUAD_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Largest number of dof of a node of the shell. */
enum { QUAD_DOF = 7 };

/* Nodes of a mesh file that belong to no quadrilateral; the mesh does without them. */
enum { QUAD_LOOSE = 4 };
typedef struct quad_loose {
    size_t count;
    int64_t label[QUAD_LOOSE]; /* smallest numbers, in the mesh file, of nodes that belong to no
                                  element, ascending; at most QUAD_LOOSE of them */
} quad_loose;

/*
 * Named set of nodes, elements or edges. An edge is the number 4 element + side, where a side s
 * joins the corners s and (s + 1) % 4 of the element.
 */
typedef struct quad_set {
    char *name;       /* name of the set of nodes, elements or edges, as the mesh file or the mesh
                         generator gives it */
    size_t count;     /* number of nodes, elements or edges in this named set of the mesh */
    uint32_t *index;  /* [count] numbers of the nodes, elements or edges, ascending, without
                         repetition */
    quad_loose loose; /* nodes that the mesh file lists in this set and that belong to no
                         quadrilateral; none in a set of edges or elements */
} quad_set;

/* Properties that the elements of a region of the mesh have in common: plies and material axis. */
typedef struct quad_region {
    uint32_t present_plies; /* bit i is set if ply i of the laminate is present in the elements of
                               the region */
    double direction[3]; /* vector whose projection on an element is material axis 1; zero vector:
                            direction 1 of each element */
} quad_region;

typedef struct quad_mesh {
    size_t nodes, elements, regions;
    double (*position)[3]; /* [nodes] position of each node, a point of the reference surface (m) */
    double (*director)[3]; /* [nodes] unit normals towards the outer face, third axis of each node's
                              triad (local axes) */
    double (*axis)[3]; /* [nodes] first axes of the triads (local axes), unit vectors normal to the
                          directors; the second axis is director x first axis */
    uint8_t *constrained; /* [nodes] bit i is set if dof i of the node is constrained to 0; NULL: no
                             dof is constrained */
    int (*holder)[QUAD_DOF]; /* [nodes][QUAD_DOF] index of the support that constrains each dof;
                                entries of dof that are not constrained have no meaning; NULL:
                                unknown */
    uint32_t *order;     /* [nodes] nodes in the order in which their dof are numbered; NULL: in the
                            order of their indices */
    int64_t *node_label; /* [nodes] numbers of the nodes in the mesh file; NULL: they have none */
    int64_t *element_label; /* [elements] numbers of the elements in the mesh file; NULL: they have
                               none */
    uint32_t (*element)[4]; /* [elements] nodes of the corners (-,-) (+,-) (+,+) (-,+),
                               counterclockwise as seen from the outer face */
    double *area; /* [elements] exact area of each element (m2); NULL: areas are computed from the
                     positions and directors (unit normals) of the nodes */
    uint32_t *element_region; /* [elements] number of each element's region; NULL: all belong to
                                 region 0 */
    quad_region *region; /* [regions] plies and material axis of each region; there is at least one
                            region */
    double (*material_axis)[3]; /* [elements] vector whose projection on each element is material
                                   axis 1; NULL: that of its region */
    size_t node_sets, element_sets, edge_sets;
    quad_set *node_set;    /* [node_sets] named sets of nodes of the mesh */
    quad_set *element_set; /* [element_sets] named sets of elements of the mesh */
    quad_set *edge_set;    /* [edge_sets] named sets of edges of the mesh */
    uint32_t hash;         /* hash of the mesh file; 0: the mesh comes from no file */
} quad_mesh;

/* Release the arrays of a mesh; the mesh is empty afterwards. */
void quad_mesh_free(quad_mesh *mesh);

/*
 * Allocate the arrays of the nodes, the elements and one region, for the numbers of nodes and
 * elements that `mesh` states. All entries are 0. Returns 0, or -1 if memory is short.
 */
int quad_mesh_allocate(quad_mesh *mesh);

/*
 * Sort the members (nodes, elements or edges) of a set in ascending order and remove repetitions.
 */
void quad_set_sort(quad_set *set);

/*
 * Give an empty set of nodes, elements or edges a name and memory for `count` members. Returns
 * whether memory sufficed.
 */
bool quad_set_begin(quad_set *set, const char *name, size_t count);

/*
 * Return the set of nodes, elements or edges with a given name among `count` sets, or NULL if there
 * is none.
 */
const quad_set *quad_set_find(const quad_set *set, size_t count, const char *name);

/* Return whether a set contains the node, element or edge with a given number. */
bool quad_set_has(const quad_set *set, uint32_t index);

/*
 * Return the global axis (0, 1 or 2) whose projections on the surface are suitable as first local
 * axes of all nodes: the axis whose smallest angle to any director (unit normal) is largest.
 * Returns -1 if some director is nearly parallel to each axis, as on half a sphere.
 */
int quad_common_axis(const quad_mesh *mesh);

/*
 * Compute the first local axis of a node at which no support prescribes this axis: the projection
 * of the global axis `common` on the surface, or for common = -1 of the global axis that is least
 * aligned with the director (unit normal).
 */
void quad_default_axis(const double director[3], int common, double axis[3]);

#endif
