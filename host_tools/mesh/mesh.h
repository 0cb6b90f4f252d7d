/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mesh of a scene: nodes, elements, element types and the numbering of the free dof.
 *
 * Node numbers increase fastest along theta2. The free dof are renumbered for the factor: the
 * direction that gives the narrower band runs fastest, and a closed slow direction is folded.
 */
#ifndef MESH_H
#define MESH_H

#include "laminate.h"
#include "pzs.h"
#include "../scene/surface.h"
#include "quad_types.h"

/* Springs of a mesh as rows over its free dof (springs.h). All arrays are NULL without springs. */
typedef struct mesh_springs {
    int count;  /* number of springs and stacks */
    int *first; /* [items + 1] first spring of each item: springs of the scene, then actuators */
    uint32_t *start;         /* [count + 1] first entry of each spring */
    uint16_t *dof;           /* [start[count]] free dof of each entry */
    double *value;           /* [start[count]] elongation per unit of the dof (1) */
    double *stiffness;       /* [count] stiffness (N/m) */
    double envelope_without; /* number of entries of the factor without springs */
} mesh_springs;

typedef struct mesh {
    const scene *scene;
    const quad_mesh *quads; /* the general mesh that this mesh was built from, or NULL: a mesh along
                               lines of curvature */
    bool accept_irregular;  /* elements that are too thin for an irregular mesh are reported, not
                               refused */
    quad_report quad_report;
    laminate laminate;
    int lines[2]; /* node lines along theta1, theta2; a closed direction has no last line. General
                     mesh: all nodes, 1 */
    int nodes, elements, types, free_dof;
    unsigned dof_per_node;
    surface_point *point;     /* [nodes] position, triad, metric and curvatures */
    double (*theta)[2];       /* [nodes] parameters theta1, theta2; general mesh: x, y */
    uint16_t (*element)[4];   /* [elements] four nodes each, in corner order; theta2 fastest */
    uint16_t *element_type;   /* [elements] element type of each element */
    pzs_element_type *type;   /* [types] corner tables */
    laminate_place *place;    /* [types] plies, curvatures and size */
    double *stiffness;        /* [types][packed] element matrices, packed lower triangles */
    uint16_t *node_dof;       /* [nodes][dof_per_node] free dof, or PZS_CONSTRAINED */
    uint16_t *first_column;   /* [free_dof] first column of each row of the factor */
    int prescribed_count;     /* dof with a prescribed displacement; numbered among the free dof */
    uint16_t *prescribed_dof; /* [prescribed_count] their numbers, ascending */
    double *prescribed_value; /* [prescribed_count] their displacements at full load */
    mesh_springs springs;
} mesh;

/*
 * Build the mesh of a checked scene, which must outlive it. Returns 0, or -1 with error filled and
 * the mesh empty.
 */
int mesh_build(mesh *mesh, const scene *scene, char *error);

/*
 * Build the mesh of a scene from a general mesh of quadrilaterals in place of the scene's surface
 * and mesh lines. Scene and quads must outlive the mesh. accept_irregular  in  elements that are
 * too thin for an irregular mesh are not refused Returns 0, or -1 with error filled and the mesh
 * empty.
 */
int mesh_build_quads(mesh *mesh, const scene *scene, const quad_mesh *quads, bool accept_irregular,
                     char *error);

void mesh_free(mesh *mesh);

/*
 * Build the springs of a mesh whose dof are numbered and whose element types are built, and widen
 * the envelope by them (springs.h). Returns 0, or -1 with error filled.
 */
int mesh_springs_build(mesh *mesh, char *error);

void mesh_springs_free(mesh_springs *springs);

/*
 * Build a mesh of points without elements: the outputs of the scene's measured influence matrix,
 * with one dof each, along z. Where the scene gives no coordinates, the points stand along x in the
 * order of the outputs, for pictures alone. theta1 and theta2 are NAN.
 * Returns 0, or -1 with error filled and the mesh empty.
 */
int mesh_points(mesh *mesh, const scene *scene, char *error);

/* Node at line i of theta1 and line j of theta2; line numbers of closed directions wrap around. */
int mesh_node(const mesh *mesh, int i, int j);

/* Coordinates of a node as the variables of a formula. */
expr_point mesh_place(const mesh *mesh, int node);

/*
 * The place of a node, or the extent of an element, in words for a message: theta1 and theta2, or
 * on a mesh from a file x, y, z (of an element's middle) and the number in the file.
 */
typedef struct mesh_text {
    char text[112];
} mesh_text;
mesh_text mesh_node_text(const mesh *mesh, int node);
mesh_text mesh_element_text(const mesh *mesh, int element);

/* Node of a place that is a single node: a point, or the first node of a set. */
int mesh_point_node(const mesh *mesh, const scene_where *where);

/* List the nodes of a region in node order. node [nodes] out. Returns their number. */
int mesh_select(const mesh *mesh, const scene_where *where, int *node);

/* One side of an element: its nodes and its length. */
typedef struct mesh_side {
    int node[2];
    double length;
} mesh_side;

/* Number of sides of an edge, or of an edge set of a mesh from a file; -1 for other places. */
int mesh_sides(const mesh *mesh, const scene_where *where);

/* Side k of an edge or edge set. */
mesh_side mesh_side_at(const mesh *mesh, const scene_where *where, int k);

/* Area of each node: the shares of its elements. area [nodes] out */
void mesh_node_areas(const mesh *mesh, double *area);

/*
 * Add to each node its share of the length of the sides of a place, or of the area of the elements
 * whose nodes are all in the place. share [nodes] in/out. mesh_length_shares returns the number of
 * sides, -1 where the place has none.
 */
int mesh_length_shares(const mesh *mesh, const scene_where *where, double *share);
void mesh_area_shares(const mesh *mesh, const scene_where *where, double *share);

/* Parameter ranges of an element: theta1 [2] out, theta2 [2] out. */
void mesh_cell(const mesh *mesh, int element, double theta1[2], double theta2[2]);

/* Half bandwidth of the factor: largest number of entries left of the diagonal in a row. */
int mesh_half_bandwidth(const mesh *mesh);

/* Number of entries of the factor: of each row from its first column to the diagonal. */
double mesh_envelope(const mesh *mesh);

#endif
