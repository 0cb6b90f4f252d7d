/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mesh of a scene: nodes, elements, element types and numbers of the free dof. On mesh lines, nodes
 * are numbered fastest along theta2. Free dof are numbered fastest along the direction that gives
 * the stiffness matrix the narrower band. If the mesh is closed in the other direction, as around a
 * cylinder, its n mesh lines follow in the order 0, n-1, 1, n-2...
 */
#ifndef MESH_H
#define MESH_H

#include "laminate.h"
#include "pzs.h"
#include "../scene/surface.h"
#include "quad_types.h"

/*
 * Springs and stack actuators of a mesh. The elongation of each one is a linear function of the
 * free dof, stored as the numbers of the dof that enter and the elongation per unit of each (its
 * sparse row). All arrays are NULL if there are no springs.
 */
typedef struct mesh_springs {
    int count;       /* number of springs and stack actuators */
    int *first;      /* [springs of the scene file + actuators + 1] index of the first spring that
                        belongs to each entry of the scene's list `springs`, then of the first
                        stack of each actuator; the last element is the number of all springs and
                        stacks */
    uint32_t *start; /* [count + 1] index, in `dof` and `value`, of the first dof of each spring;
                        the last element is the number of all entries */
    uint16_t *dof;   /* [entries of all springs] index of a free dof on which the elongation of the
                        spring depends */
    double *value;   /* [entries of all springs] for each entry of a spring's row: elongation of the
                        spring per unit of the entry's dof (dimensionless) */
    double *stiffness;       /* [count] stiffness of each spring or stack (N/m) */
    double envelope_without; /* number of entries that the factor L of the stiffness matrix (L D
                                L^T) would have without springs */
} mesh_springs;

/* A concentrated mass of a mesh, at a point in an element. */
typedef struct mesh_mass {
    int element;      /* element to which the mass belongs */
    double weight[4]; /* weights of the element's corners in the displacement of the mass; their sum
                         is 1 */
    double mass;      /* mass (mass unit of the scene file) */
    double inertia;   /* moment of inertia about the centre of the mass (units of the scene file) */
    scene_face face;  /* face of the shell with which the mass moves */
} mesh_mass;

typedef struct mesh {
    const scene *scene; /* scene from which the mesh is built; no function uses it after the mesh
                           and the numerical model of the scene are built */
    scene_element formulation; /* options that choose the formulation of the finite element */
    scene_line line[2];    /* values of the surface coordinates theta1 and theta2 at the mesh lines;
                              the memory of these values belongs to the scene */
    bool is_from_file;     /* whether the mesh comes from a mesh file, in place of lines of constant
                              surface coordinates */
    const bicubic *fitted; /* function z(x, y) of a surface that is fitted to measured points, the
                              height of the surface over the x-y plane; NULL for other surfaces */
    bool is_polar;         /* whether the surface is a plane in polar coordinates */
    bool is_angle[2]; /* whether the surface coordinates theta1 and theta2 are angles (rad) instead
                         of lengths */
    const quad_mesh *quads; /* mesh of quadrilaterals in any arrangement from which this mesh was
                               built; NULL for a mesh along lines of curvature */
    bool accept_irregular;  /* treatment of elements that are too thin for the irregular mesh around
                               them, so that they bend too little (quad_rule.lock above QUAD_LOCK).
                               true: they are accepted, and counted in quad_report; false: they are
                               an error */
    quad_report quad_report;
    laminate laminate;
    int lines[2]; /* number of node lines along the surface coordinates theta1 and theta2; along a
                     closed direction the last line equals the first and is not counted. On a mesh
                     from a file: number of nodes, and 1 */
    int nodes, elements, types, free_dof;
    unsigned dof_per_node;
    surface_point *point; /* [nodes] point of the surface at each node: position, local axes
                             (triad), metric and curvatures */
    double (*theta)[2]; /* [nodes] surface coordinates theta1, theta2 of each node (m or rad); on a
                           mesh from a file, x and y of the node (m) */
    uint16_t (*element)[4]; /* [elements] numbers of the four corner nodes in the order (-,-) (+,-)
                               (+,+) (-,+) */
    uint16_t *element_type; /* [elements] index of the element type of each element */
    pzs_element_type *type; /* [types] element types: stiffness, and corner tables (displacements of
                               the corners to strains) */
    laminate_place *place;  /* [types] plies, curvatures and lengths of each element type */
    double *stiffness;  /* [types][entries of a lower triangle] element stiffness matrices, lower
                           triangles packed by rows */
    uint16_t *node_dof; /* [nodes][dof_per_node] index of each dof of a node among the free dof, or
                           PZS_CONSTRAINED for a constrained dof */
    int *holder; /* [nodes][dof_per_node] index, among the supports of the scene, of the support
                    that holds each dof or prescribes its displacement; -1 for a dof that no support
                    holds
                  */
    int turns; /* number of nodes at oblique supports, whose mean displacements (of both faces) act
                  along other axes than those of their triads (local axes) */
    uint16_t *node_turn; /* [nodes] index of each node's rotated axes in `turn`, or PZS_UNTURNED for
                            a node without rotated axes; NULL: no node has rotated axes */
    double (*turn)[3][3];   /* [turns] axes along which the mean displacements (of both faces) of a
                               node at an oblique support act: unit vectors (rows) in the triad
                               (local axes) of the node */
    uint16_t *first_column; /* [free_dof] column of the first stored entry in each row of the factor
                               L of the stiffness matrix (L D L^T) */
    int prescribed_count; /* number of dof whose displacement is prescribed and grows with the load
                             steps; they belong to the free dof, because the equations of the solver
                             contain them */
    uint16_t *prescribed_dof; /* [prescribed_count] numbers of the dof with prescribed displacement
                                 among the free dof, ascending */
    double *prescribed_value; /* [prescribed_count] prescribed displacements at full load (length
                                 unit of the scene file) */
    mesh_springs springs;
    int masses;
    mesh_mass *mass; /* [masses] concentrated masses of the scene */
} mesh;

/*
 * Build the mesh of a checked scene, which must exist as long as the mesh. Returns 0, or -1 with
 * error filled and the mesh empty.
 */
int mesh_build(mesh *mesh, const scene *scene, char *error);

/*
 * Build the mesh of a scene from a mesh of quadrilaterals, in place of the scene's surface and mesh
 * lines. Scene and quads must exist as long as the mesh.
 *   accept_irregular in  true: elements whose bending is too stiff (quad_rule.lock above QUAD_LOCK)
 *       are counted in quad_report; false: they are an error
 * Returns 0, or -1 with error filled and the mesh empty.
 */
int mesh_build_quads(mesh *mesh, const scene *scene, const quad_mesh *quads, bool accept_irregular,
                     char *error);

void mesh_free(mesh *mesh);

/*
 * Make an empty mesh of a scene, and copy from the scene file what describes the mesh as a whole.
 */
void mesh_begin(mesh *mesh, const scene *scene);

/*
 * Turn the triads (local axes) of nodes at supports with the key `direction`: e1 becomes this
 * direction, projected on the surface. Not for meshes from a file. Returns 0, or -1 with error
 * filled if the direction is normal to the surface, or other supports or distributed loads need
 * other axes.
 */
int mesh_turn_axes(mesh *mesh, char *error);

/*
 * Return whether the effect of a support depends on the directions of the tangential axes e1 and e2
 * of its nodes: whether it constrains one of the displacements along them and not the other.
 */
bool mesh_depends_on_axes(const scene_support *support);

/*
 * Apply the oblique supports of a scene: hold mean displacements (of both faces) along directions
 * that are no axes of the triads (local axes), by turning the dof of the node. Call it after all
 * other supports are marked in node_dof, and before the dof are numbered.
 *   values [nodes][dof_per_node] in/out  prescribed displacement of each dof, NAN where none
 *   node   [nodes]               out     work array
 * Returns 0, or -1 with error filled if directions or values at a node contradict each other.
 */
int mesh_hold_oblique(mesh *mesh, double *values, int *node, char *error);

/*
 * Convert the three components of a vector at a node between two sets of axes. The first is the
 * triad (local axes) of the node. The second holds the axes along which the first three dof of the
 * node act, the mean displacements of both faces. They differ only at oblique supports.
 * mesh_turn_to_dof converts from the triad to the dof, mesh_turn_to_triad back.
 *   mean [3] in/out  mean displacement, force, or weights of the mean displacements
 */
void mesh_turn_to_dof(const mesh *mesh, int node, double mean[3]);
void mesh_turn_to_triad(const mesh *mesh, int node, double mean[3]);

/*
 * Build the springs of a mesh whose dof are numbered and whose element types are built, and widen
 * the envelope of the stiffness matrix's factor by them (springs.h). Returns 0, or -1 with error
 * filled.
 */
int mesh_springs_build(mesh *mesh, char *error);

/*
 * List the concentrated masses of the scene (mesh_masses.c). Returns 0, or -1 with error filled;
 * mesh_free releases the list in either case.
 */
int mesh_masses_build(mesh *mesh, char *error);

void mesh_springs_free(mesh_springs *springs);

/*
 * Build a mesh of points for a measured influence matrix: one point for each output, with one dof
 * along z, and no elements. Points without coordinates in the scene file lie along x in the order
 * of the outputs, for pictures only. Returns 0, or -1 with error filled and the mesh empty.
 */
int mesh_points(mesh *mesh, const scene *scene, char *error);

/*
 * Return the number of the node on mesh line i of the surface coordinate theta1 and line j of
 * theta2; line numbers wrap around in closed directions.
 */
int mesh_node(const mesh *mesh, int i, int j);

/* Compute the extent of the nodes along x, y and z (length unit of the scene). */
void mesh_extent(const mesh *mesh, double extent[3]);

/* Return the coordinates of a node as the variables of a formula. */
expr_point mesh_place(const mesh *mesh, int node);

/*
 * Text that tells the user where a node or element lies. On a surface with coordinates, the text
 * holds theta1 and theta2 of the node, or their ranges in the element. On a mesh from a file, it
 * holds the number in the file and x, y, z of the node or of the element's centre.
 */
typedef struct mesh_text {
    char text[112];
} mesh_text;
mesh_text mesh_node_text(const mesh *mesh, int node);
mesh_text mesh_element_text(const mesh *mesh, int element);

/*
 * Return the node of a point or of a node set that the scene file names; of a node set, the first
 * node.
 */
int mesh_point_node(const mesh *mesh, const scene_where *where);

/*
 * List the nodes of a place (point, edge, region or set) in ascending order (node [nodes] out).
 * Returns their number.
 */
int mesh_select(const mesh *mesh, const scene_where *where, int *node);

/* One side of an element: the numbers of its two nodes, and its length (m). */
typedef struct mesh_side {
    int node[2];
    double length;
} mesh_side;

/*
 * Return the number of element sides on an edge of the mesh, or in an edge set of a mesh file; -1
 * if `where` is no edge and no edge set.
 */
int mesh_sides(const mesh *mesh, const scene_where *where);

/*
 * Return the k-th element side, counted from 0, along an edge of the mesh, or in a set of element
 * sides that a mesh file names.
 */
mesh_side mesh_side_at(const mesh *mesh, const scene_where *where, int k);

/*
 * Compute the area that belongs to each node, the sum of its shares in the areas of its elements
 * (area [nodes] out, m2).
 */
void mesh_node_areas(const mesh *mesh, double *area);

/*
 * Add to each node its share of a length or area: of the element sides that lie in a place of the
 * scene file (mesh_length_shares), or of the elements whose nodes all lie in it (mesh_area_shares).
 *   share  [nodes] in/out  length (m) or area (m2) of each node
 * mesh_length_shares returns the number of sides, or -1 if the place has no sides.
 */
int mesh_length_shares(const mesh *mesh, const scene_where *where, double *share);
void mesh_area_shares(const mesh *mesh, const scene_where *where, double *share);

/*
 * Find the ranges of the surface coordinates theta1 and theta2 in an element (theta1 [2] out,
 * theta2 [2] out).
 */
void mesh_cell(const mesh *mesh, int element, double theta1[2], double theta2[2]);

/*
 * Return the half bandwidth of the stiffness matrix's factor: the largest number of entries left of
 * the diagonal in a row.
 */
int mesh_half_bandwidth(const mesh *mesh);

/*
 * Return the number of stored entries of the factor L of the stiffness matrix (L D L^T): in each
 * row, those from the first stored column to the diagonal.
 */
double mesh_envelope(const mesh *mesh);

#endif
