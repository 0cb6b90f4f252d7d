/*
 * Mesh of a scene: nodes, elements, element kinds and the numbering of the free unknowns.
 *
 * Nodes run with theta2 fastest. Free unknowns are renumbered for the factor: the direction
 * that gives the narrower band runs fastest, a closed slow direction is folded.
 */
#ifndef MESH_H
#define MESH_H

#include "laminate.h"
#include "pzs.h"
#include "../scene/surface.h"

typedef struct mesh {
    const scene *scene;
    laminate laminate;
    int lines[2]; /* node lines along theta1, theta2; a closed direction has no last line */
    int nodes, elements, kinds, dof;
    unsigned unknowns;
    surface_point *point;   /* [nodes] */
    double (*theta)[2];     /* [nodes] */
    uint16_t (*element)[4]; /* [elements] nodes, corner order; elements with theta2 fastest */
    uint16_t *element_kind; /* [elements] */
    pzs_element_type *kind; /* [kinds] corner tables */
    laminate_place *place;  /* [kinds] */
    double *stiffness;      /* [kinds][packed] */
    uint16_t *node_dof;     /* [nodes][unknowns] */
    uint16_t *first;        /* [dof] */
    int prescribed_count; /* unknowns with a value of their own; they are numbered like free ones */
    uint16_t *prescribed_dof; /* [prescribed_count] ascending */
    double *prescribed_value; /* [prescribed_count] at full load */
} mesh;

/* Build from a checked scene, which must outlive the mesh. Returns 0, or -1 with error filled and
 * *m empty. */
int mesh_build(mesh *mesh, const scene *scene, char *error);
void mesh_free(mesh *mesh);

/* Node at line i of theta1 and line j of theta2; closed directions wrap. */
int mesh_node(const mesh *mesh, int i, int j);

/* A node's place, for the value of an expression there. */
expr_point mesh_place(const mesh *mesh, int node);

/* Nodes of a set, in node order. node [nodes] out. Returns their number. */
int mesh_select(const mesh *mesh, const scene_where *where, int *node);

/* Parameters of an element's corners: theta1[2], theta2[2]. */
void mesh_cell(const mesh *mesh, int element, double theta1[2], double theta2[2]);

/* Widest row of the factor below the diagonal. */
int mesh_half_bandwidth(const mesh *mesh);

#endif
