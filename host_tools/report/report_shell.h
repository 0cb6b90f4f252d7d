/* SPDX-License-Identifier: BSD-2-Clause */
/* Pictures of a mesh, in space or as a flat map, with supports, loads and voltages. */
#ifndef REPORT_SHELL_H
#define REPORT_SHELL_H

#include "../model/voltages.h"
#include "../quads/quad_side.h"
#include "report_draw.h"

/* Width of a flat map of a surface in a report, in pixels. */
enum { SHELL_MAP_WIDTH = 320 };

/*
 * A parallel projection to a picture, into which all included points fit. Points are x, y, z in
 * space, or theta1, theta2, 0 on a map. The rows of `axis` point right, up and towards the viewer;
 * `low` and `high` bound the points along the first two. Sizes and zoom are in pixels.
 */
typedef struct view {
    double axis[3][3], low[2], high[2];
    double zoom, width, height;
} view;

/*
 * Views:
 *   view_begin    begins a view without points: the outer side of a shell in space, from 30 degrees
 *       above the horizon, or a map. On a map of a mesh along lines of curvature
 *       (view_has_parameters), theta1 points downwards and theta2 to the right, like a printed
 *       table of voltages. A mesh from a file is seen along its mean normal, a closed surface as in
 *       space; of polar plates and meshes of points, x points to the right and y upwards
 *   view_axes     computes the axes of a view from the direction towards the viewer; the axis
 *       `up` of space points upwards in the picture
 *   view_include  extends a view so that a point is visible
 *   view_fit      fits the included points into a picture, at least `least` pixels high
 *   view_project  computes the pixel coordinates of a point
 *   view_magnification  returns a round factor with which a displacement of the size `most` is
 *       drawn about `share` times as long as the largest extent of the mesh
 */
void view_begin(view *view, const mesh *mesh, bool is_map);
bool view_has_parameters(const mesh *mesh);
void view_axes(const double towards[3], int up, double axis[3][3]);
void view_include(view *view, const double point[3]);
void view_fit(view *view, double width, double height, double least);
void view_project(const view *view, const double point[3], double at[2]);
double view_magnification(const mesh *mesh, double most, double share);

/* A point of a drawn mesh: its coordinates without displacement, its node, has it a support. */
typedef struct shell_point {
    double place[3];
    int node;
    bool is_held;
} shell_point;

/*
 * A mesh as it is drawn: points, and cells (quadrilaterals) between them. On the map of a closed
 * surface, the first and the last mesh line are separate points of the same nodes. A part of a mesh
 * is a copy with fewer cells.
 */
typedef struct shell {
    FILE *file;
    const design *design;
    const mesh *mesh;
    view view;
    bool is_map;
    int points, cells, plans;
    shell_point *point; /* [points] points of the picture */
    /*
     * [2 * cells][4] indices, in `point`, of the corners of each cell (quadrilateral of the
     * picture); the second `cells` rows are work memory for the cells of one electrode
     */
    int (*cell)[4];
    int *plan;  /* [actuators] index of the map on which each actuator is drawn (there are several
                   maps if patches overlap); -1: the actuator has no patches or stacks */
    void *work; /* work memory to sort cells (quadrilaterals of the picture) or their sides */
    const double *vector; /* [nodes][3] displacements of the nodes along x, y and z; NULL: the mesh
                             is drawn without displacement */
    double factor;        /* factor by which the drawn displacement is magnified */
    bool *has_failed;     /* set where memory runs out while the picture is drawn */
} shell;

/*
 * Prepare a picture of a mesh without displacement. Returns 0, or -1 if memory runs out;
 * shell_close is called in both cases.
 */
int shell_open(shell *shell, FILE *file, const design *design, bool is_map);
void shell_close(shell *shell);

/*
 * Places in the picture of a mesh:
 *   shell_place    computes the coordinates of a point with its displacement
 *   shell_at       computes its pixel coordinates
 *   shell_inside   computes the pixel coordinates of a point inside a cell (quadrilateral): share
 *       [2], from 0 to 1, increases from corner 0 to corner 1, and from corner 0 to corner 3
 *   shell_include  includes the undeformed mesh and the displaced mesh in the view
 *   shell_outer_sides  finds the sides of single cells and returns their number
 *   shell_outer_side   computes the pixel coordinates of the ends of one of them, until the next
 *       call of another function that uses the work memory
 */
void shell_place(const shell *shell, int point, double place[3]);
void shell_at(const shell *shell, int point, double at[2]);
void shell_inside(const shell *shell, int cell, const double share[2], double at[2]);
void shell_include(shell *shell);
int shell_outer_sides(const shell *shell);
void shell_outer_side(const shell *shell, int index, double ends[2][2]);

/*
 * Parts of the picture of a mesh:
 *   shell_surface     the surface coloured by value [nodes], or discs at the points if no cell has
 *       values at all corners. In space, closer cells cover distant ones, and supports are drawn
 *   shell_lines       all sides of the cells with the displacements `vector` (NULL: undeformed);
 *       cells with a displacement of NaN are left out
 *   shell_edges       the outer edges, sides of a single cell, with the displacements `vector`
 *   shell_node        a disc with a radius in pixels at a node, with the displacements `vector`
 *   shell_marks       point loads as arrows, and the places and names of outputs at single nodes
 *   shell_directions  the directions of x, y and z in a corner of the picture
 */
void shell_surface(const shell *shell, const double *value, const draw_scale *scale);
void shell_lines(const shell *shell, const double *vector, const char *style);
void shell_edges(const shell *shell, const double *vector, const char *style);
void shell_node(const shell *shell, const double *vector, int node, const char *style,
                double radius);
void shell_marks(const shell *shell);
void shell_directions(const shell *shell);

/*
 * A net of points on a rigid body that the shell may touch, in the part near the shell.
 * shell_find_body finds the body in the last equilibrium, and includes it in the view;
 * shell_draw_body draws the body, but only if it lies on the given side of the shell for the
 * viewer: in front of it (is_in_front), or behind it.
 */
enum { SHELL_NET = 13 };
typedef struct shell_body {
    bool is_given;
    double normal[3]; /* outward unit normal of the rigid body at the point nearest to the shell */
    double place[SHELL_NET][SHELL_NET][3];
} shell_body;
void shell_find_body(shell_body *body, const analysis *analysis, shell *shell);
void shell_draw_body(const shell *shell, const shell_body *body, bool is_in_front);

/* Draw a map of values [nodes] in colours, with frame, mesh lines and ranges of coordinates. */
void shell_map(const shell *map, const double *value, const draw_scale *scale, const char *title);

/*
 * Voltages of the amplifiers, or temperatures of heaters, in pictures:
 *   shell_find_plans  distributes the actuators over several maps (map->plan, map->plans), so that
 *       patches on the same map do not overlap
 *   shell_voltages    draws map `which` (0 to map->plans - 1) with a voltage in each patch; if the
 *       scene has no patches, the voltages of all amplifiers as bars
 *   shell_extend      extends a colour scale to contain the values [amplifiers] that have its unit
 *   shell_is_beyond   returns whether the voltage of an amplifier is beyond the limits of the scene
 */
void shell_find_plans(shell *map);
void shell_extend(draw_scale *scale, const design *design, const double *value);
bool shell_is_beyond(const design *design, const voltages *result, int amplifier);
void shell_voltages(const shell *map, int which, const voltages *result, const draw_scale *scale);

#endif
