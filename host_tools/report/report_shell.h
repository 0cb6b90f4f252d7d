/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A shell in a picture, in space or over its parameter plane: coloured surface, mesh lines,
 * marks, voltages.
 */
#ifndef REPORT_SHELL_H
#define REPORT_SHELL_H

#include "../model/analysis.h"
#include "report_draw.h"

#define SHELL_THETA(a) ((a) ? "θ₂" : "θ₁")

/*
 * The parameter plane: theta1 runs down and theta2 across, as the rows and columns of printed
 * voltages; a polar plate is the disc that it is, theta2 anticlockwise from the right.
 */
typedef struct shell_plane {
    double low[2], range[2]; /* of theta1, theta2 */
    double x0, y0, width, height, picture_height;
    bool is_polar;
    double zoom; /* pixels a length of a polar plate, centred at x0 + centre[0], y0 + centre[1] */
    double centre[2];
} shell_plane;

enum { SHELL_PLANE_WIDTH = 320 };

/*
 * Place in the picture of a point; value of theta1 (a = 0) or theta2 at a mesh line or between
 * two.
 */
void plane_at(const shell_plane *p, double theta1, double theta2, double at[2]);
double plane_theta(const mesh *mesh, int a, double line);

/*
 * The mesh in a picture: in a view, moved by factor times vector [nodes][3]; or with view NULL,
 * in a plane.
 */
typedef struct shell {
    FILE *file;
    const mesh *m;
    const draw_view *view;
    const double *vector;
    double factor;
    shell_plane plane;
} shell;

/* The shell of a mesh in its plane. */
shell shell_in_plane(FILE *file, const mesh *mesh);

/*
 * Surface coloured by value [nodes]; in space farther parts first, with supports. Returns 0, or
 * -1: out of memory.
 */
int shell_surface(const shell *s, const double *value, const draw_scale *scale);

/*
 * Mesh lines of a style, broken where a place is NaN; the four edges alone; are some lines left
 * out of pictures?
 */
void shell_lines(const shell *s, const char *style);
void shell_edges(const shell *s, const char *style);
bool shell_is_thinned(const mesh *mesh);

/* A dot at a node; in space: point loads, named points, directions of x, y, z in a corner. */
void shell_dot(const shell *s, int node);
void shell_loads(const shell *s);
void shell_outputs(const shell *s);
void shell_directions(const shell *s);

/*
 * A picture in the plane: a map of value [nodes] with frame, axes and mesh lines. Returns 0, or
 * -1: out of memory.
 */
int shell_map(FILE *file, const mesh *mesh, const double *value, const draw_scale *scale,
              const char *title);

/*
 * Lay actuators whose patches overlap on plans of their own; a whole temperature gets -1.
 *   plan [actuators] out
 * Returns the number of plans.
 */
int shell_plans(const scene *scene, int *plan);

typedef enum shell_mark { SHELL_FREE, SHELL_AT_LIMIT, SHELL_BEYOND } shell_mark;

/*
 * Voltages in the patches of the actuators with plan[actuator] == which. voltage, mark
 * [amplifiers] in
 */
void shell_voltages(FILE *file, const mesh *mesh, const int *plan, int which, const double *voltage,
                    const shell_mark *mark, const draw_scale *scale);

/* The part of the rigid body of a contact that lies along the shell, as a translucent net. */
enum { SHELL_NET = 13 };
typedef struct shell_body {
    bool is_given;
    double normal[3]; /* out of the body where the shell is nearest */
    double x[SHELL_NET][SHELL_NET][3];
} shell_body;

/*
 * Lay the net where the body stands at the last equilibrium, and include it; vector [nodes][3]:
 * displacement.
 */
void shell_body_find(shell_body *body, const analysis *analysis, const double *vector,
                     draw_view *view);

/* Draw the net if it stands between the shell and the eye (is_in_front), or if it does not. */
void shell_body_draw(FILE *file, const shell_body *body, const draw_view *view, bool is_in_front);

#endif
