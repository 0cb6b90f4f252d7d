/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Pictures of a shell, either as a surface in space or as a map over its parameter plane: coloured
 * surface, mesh lines, marks and voltages.
 */
#ifndef REPORT_SHELL_H
#define REPORT_SHELL_H

#include "../model/analysis.h"
#include "report_picture.h"

#define SHELL_THETA(a) ((a) ? "θ₂" : "θ₁")

/*
 * plane_at returns the pixel coordinates of the point (theta1, theta2). plane_theta returns theta1
 * (a = 0) or theta2 (a = 1) at a mesh line; a fractional `line` lies between two mesh lines.
 */
void plane_at(const shell_plane *p, double theta1, double theta2, double at[2]);
double plane_theta(const mesh *mesh, int a, double line);

/* Prepare a picture of a mesh over its parameter plane. */
shell shell_in_plane(FILE *file, const mesh *mesh);

/*
 * Draw the surface coloured by value [nodes]; a mesh of points as coloured discs. In space, distant
 * parts are drawn first, so that closer ones cover them, and supports are included. Returns 0, or
 * -1: out of memory.
 */
int shell_surface(const shell *s, const double *value, const draw_scale *scale);

/*
 * shell_lines draws the mesh lines in a style, with gaps where a displacement is NaN. shell_edges
 * draws only the four edges. shell_is_thinned returns whether the mesh is so fine that pictures
 * show only some of its lines.
 */
void shell_lines(const shell *s, const char *style);
void shell_edges(const shell *s, const char *style);
bool shell_is_thinned(const mesh *mesh);

/*
 * shell_dot draws a dot at a node. The other three are for pictures in space: shell_loads draws the
 * point loads, shell_outputs the points of named outputs, and shell_directions the directions of x,
 * y and z in a corner.
 */
void shell_dot(const shell *s, int node);
void shell_loads(const shell *s);
void shell_outputs(const shell *s);
void shell_directions(const shell *s);

/*
 * Draw a whole picture over the parameter plane: the map of value [nodes] with frame, axes and mesh
 * lines. Returns 0, or -1: out of memory.
 */
int shell_map(FILE *file, const mesh *mesh, const double *value, const draw_scale *scale,
              const char *title);

/*
 * Distribute the actuators over several plans, pictures of the parameter plane, so that no patches
 * overlap in one plan. An actuator that is the temperature of the whole shell has no patches and
 * gets plan -1.
 *   plan [actuators] out  index of the plan of each actuator
 * Returns the number of plans.
 */
int shell_plans(const scene *scene, int *plan);

typedef enum shell_mark { SHELL_FREE, SHELL_AT_LIMIT, SHELL_BEYOND } shell_mark;

/*
 * Draw one plan: the voltages in the patches of the actuators with plan[actuator] == which.
 *   voltage, mark [amplifiers]  in
 */
void shell_voltages(FILE *file, const mesh *mesh, const int *plan, int which, const double *voltage,
                    const shell_mark *mark, const draw_scale *scale);

/*
 * The part of the rigid body of a contact that lies close to the shell. It is drawn as a
 * translucent surface through a grid of SHELL_NET x SHELL_NET points.
 */
enum { SHELL_NET = 13 };
typedef struct shell_body {
    bool is_given;
    double normal[3]; /* unit normal of the body's surface, pointing outwards, at the point nearest
                         to the shell */
    double x[SHELL_NET][SHELL_NET][3];
} shell_body;

/*
 * Compute the grid of points on the rigid body for its position at the last equilibrium, and
 * include them in the view.
 *   vector [nodes][3]  in  displacement of the shell
 */
void shell_body_find(shell_body *body, const analysis *analysis, const double *vector,
                     draw_view *view);

/*
 * Draw the rigid body if it lies between the shell and the viewer (is_in_front true), or only if it
 * lies behind the shell (is_in_front false).
 */
void shell_body_draw(FILE *file, const shell_body *body, const draw_view *view, bool is_in_front);

#endif
