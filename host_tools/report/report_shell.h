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
 * A parallel projection, scaled so that all included points fit into the picture. Points have three
 * coordinates: x, y, z in space, or the surface coordinates theta1, theta2 and 0 on a map.
 */
typedef struct view {
    double axis[3][3]; /* unit vectors to the right, up and towards the viewer of the picture */
    double low[2], high[2]; /* smallest and largest coordinates, to the right and up, of the points
                               that the picture must show (length unit of the scene file, or surface
                               coordinates on a map) */
    double zoom;            /* number of pixels per length unit in the picture */
    double width, height;   /* width and height of the picture in pixels */
} view;

/*
 * Begin a view that includes no points yet: a view in space of the outer side of a shell, or a map.
 *
 * The map of a mesh along lines of curvature shows theta1 downwards and theta2 to the right, like
 * the rows and columns of a printed table of voltages. A polar plate and a mesh of points are seen
 * with x to the right and y upwards. A mesh from a file is seen along its mean normal; a closed
 * surface, which has no mean normal, from above.
 */
void view_begin(view *view, const mesh *mesh, bool is_map);

/*
 * Compute the axes of a view from the direction towards the viewer; the axis `up` of space points
 * upwards in the picture.
 */
void view_axes(const double towards[3], int up, double axis[3][3]);

/* Whether the map of a mesh shows the surface coordinates theta1 and theta2. */
bool view_has_parameters(const mesh *mesh);

/*
 * view_include extends a view so that a point is visible; view_fit fits the included points into a
 * picture of a size in pixels, at least `least` pixels high; view_project computes the pixel
 * coordinates of a point.
 */
void view_include(view *view, const double point[3]);
void view_fit(view *view, double width, double height, double least);
void view_project(const view *view, const double point[3], double at[2]);

/*
 * Return a round factor of magnification with which a displacement of the size `most` is drawn
 * about `share` times as long as the largest extent of the mesh.
 */
double view_magnification(const mesh *mesh, double most, double share);

/* A point of a drawn mesh: the node of the mesh that is drawn there, and its place. */
typedef struct shell_point {
    double place[3]; /* coordinates of the undeformed mesh: x, y, z in a picture in space, the
                        surface coordinates theta1, theta2 and 0 on a map */
    int node;
    bool is_held; /* whether a support includes the node; only in a picture in space */
} shell_point;

/*
 * A mesh as it is drawn: points, and cells (quadrilaterals) between them. They are the nodes and
 * elements of the mesh, but on the map of a closed surface the first and the last mesh line are
 * separate points of the same nodes. A part of a mesh is a copy with fewer cells.
 */
typedef struct shell {
    FILE *file;
    const design *design;
    const mesh *mesh;
    view view;
    bool is_map;
    int points, cells;
    shell_point *point; /* [points] */
    int (*cell)[4]; /* [2 cells] point indices of the corners of each cell, in the first half. The
                       second half is work memory for the cells that one electrode covers, while
                       they are drawn */
    int *plan;  /* [actuators] index of the map on which the patches of each actuator are drawn, so
                   that no patches overlap on a map; -1: the actuator has no patches or stacks */
    int plans;  /* number of maps (plane drawings of the mesh) on which the patches of all actuators
                   are drawn */
    void *work; /* work memory in which the cells (quadrilaterals) of the mesh, or their sides, are
                   sorted */
    const double *vector; /* [nodes][3] displacement along x, y and z that is drawn; NULL: the
                             undeformed mesh is drawn */
    double factor;        /* factor by which the drawn displacement is magnified */
} shell;

/*
 * Prepare a picture of a mesh without displacement. Returns 0, or -1 if memory runs out;
 * shell_close is called in both cases.
 */
int shell_open(shell *shell, FILE *file, const design *design, bool is_map);
void shell_close(shell *shell);

/*
 * shell_place computes the coordinates of a point with its displacement, and shell_at its pixel
 * coordinates. In a picture of the shell in space the points are the nodes of the mesh.
 * shell_inside computes the pixel coordinates of a point inside a cell (quadrilateral).
 *   share [2] in  from 0 to 1; the first increases from corner 0 to corner 1, the second from
 *       corner 0 to corner 3
 */
void shell_place(const shell *shell, int point, double place[3]);
void shell_at(const shell *shell, int point, double at[2]);
void shell_inside(const shell *shell, int cell, const double share[2], double at[2]);

/* Include the undeformed mesh and the displaced mesh in the view in space. */
void shell_include(shell *shell);

/*
 * Draw the surface coloured by value [nodes], or discs at the points if no cell (quadrilateral) has
 * values at all corners. In a picture in space, closer cells cover distant ones, and the supports
 * are drawn too.
 */
void shell_surface(const shell *shell, const double *value, const draw_scale *scale);

/*
 * Draw mesh lines with a style class. shell_lines draws the sides of all cells (quadrilaterals), or
 * of a very fine mesh only its outer edges; shell_edges draws only the outer edges, which are sides
 * of a single cell. Cells with a displacement of NaN are left out.
 */
void shell_lines(const shell *shell, const char *style);
void shell_edges(const shell *shell, const char *style);

/* Draw a disc with a radius in pixels at a displaced node. */
void shell_node(const shell *shell, int node, const char *style, double radius);

/*
 * shell_loads draws the point loads as arrows, shell_outputs the places and names of the outputs at
 * single nodes, and shell_directions the directions of x, y and z in a corner of the picture.
 */
void shell_loads(const shell *shell);
void shell_outputs(const shell *shell);
void shell_directions(const shell *shell);

/* Number of points along each side of the grid that draws a rigid body near the shell. */
enum { SHELL_NET = 13 };
typedef struct shell_body {
    bool is_given;
    double normal[3]; /* outward unit normal of the rigid body at the point nearest to the shell */
    double place[SHELL_NET][SHELL_NET][3];
} shell_body;

/*
 * Find the part of a rigid body's surface near the shell in the last equilibrium, for a picture of
 * the body that the shell may touch.
 */
void shell_find_body(shell_body *body, const analysis *analysis, shell *shell);

/*
 * Draw the rigid body of a contact, but only if it lies on the given side of the shell for the
 * viewer: in front of it (is_in_front), or behind it.
 */
void shell_draw_body(const shell *shell, const shell_body *body, bool is_in_front);

/* Draw a map of values [nodes] in colours, with frame, mesh lines and ranges of coordinates. */
void shell_map(const shell *map, const double *value, const draw_scale *scale, const char *title);

/* Voltages of all amplifiers, with the colour scale in which pictures show them. */
typedef struct shell_voltage_set {
    const voltages *result;
    const draw_scale *scale;
} shell_voltage_set;

/*
 * Extend a colour scale to contain the inputs of those amplifiers that have the unit of the scale.
 *   value [amplifiers] in  voltages, or temperatures of heaters
 */
void shell_extend(draw_scale *scale, const design *design, const double *value);

/* Return whether the voltage of an amplifier is beyond the voltage limits of the scene. */
bool shell_is_beyond(const design *design, const voltages *result, int amplifier);

/*
 * Distribute the actuators over flat maps of the surface so that patches on one map do not overlap.
 * The members `plan` (map of each actuator) and `plans` (number of maps) are filled.
 */
void shell_find_plans(shell *map);

/*
 * Draw one map of the surface with the patches of some actuators, and in each patch its voltage.
 * Patches of actuators that overlap are on different maps (shell_find_plans). If the scene has no
 * patches, draw the voltages of all amplifiers as bars.
 *   which  in  index of the map, 0 to map->plans - 1
 */
void shell_voltages(const shell *map, int which, const shell_voltage_set *set);

#endif
