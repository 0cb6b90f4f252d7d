/* SPDX-License-Identifier: BSD-2-Clause */
/* Parallel projections of a mesh to a picture. */
#include "report_shell.h"
#include <float.h>
#include <math.h>
#include <string.h>
#include "../quads/vector.h"

/* Smallest distance of the drawn points from the edges of a picture, in pixels. */
enum { EDGE = 18 };

/*
 * Set the axes of a view along a normal; the axis y of space, or z if the normal is y, is upwards.
 */
static void look_along(view *view, const double normal[3])
{
    double(*axis)[3] = view->axis;
    memcpy(axis[2], normal, sizeof axis[2]);
    vector_normalise(axis[2]);
    const int up = fabs(axis[2][1]) > 0.9 ? 2 : 1;
    for (int i = 0; i < 3; i++)
        axis[1][i] = (i == up) - axis[2][up] * axis[2][i];
    vector_normalise(axis[1]);
    vector_cross(axis[1], axis[2], axis[0]);
}

/*
 * Choose a view in space, 30 degrees above the horizon, that shows most of the outer side of the
 * shell.
 *   normal [3] in  mean normal of the surface
 */
static void look_at(view *view, const double normal[3])
{
    static const double degree = 0.017453292519943295, azimuth[4] = {-58, 32, 122, 212};
    const double up = sin(30 * degree), out = cos(30 * degree);
    double best = -2;
    for (int k = 0; k < 4; k++) {
        const double east = cos(azimuth[k] * degree), north = sin(azimuth[k] * degree);
        const double axis[3][3] = {
            {-north, east, 0}, {-up * east, -up * north, out}, {out * east, out * north, up}};
        const double shown = vector_dot(normal, axis[2]);
        if (shown <= best + 1e-6)
            continue;
        best = shown;
        memcpy(view->axis, axis, sizeof axis);
    }
}

/*
 * Set the axes of a map over the surface coordinates: theta1 downwards, theta2 to the right. The
 * aspect ratio is that of the mean lengths of the shell along both coordinates, within 0.3 and 3.
 */
static void look_at_parameters(view *view, const mesh *mesh)
{
    double metric[2] = {0, 0}, range[2];
    for (int a = 0; a < 2; a++) {
        const scene_line *line = &mesh->line[a];
        range[a] = line->point[line->elements] - line->point[0];
        for (int n = 0; n < mesh->nodes; n++)
            metric[a] += mesh->point[n].lame[a] / mesh->nodes;
    }
    const double aspect = metric[0] * range[0] / (metric[1] * range[1]);
    memset(view->axis, 0, sizeof view->axis);
    view->axis[0][1] = 1 / range[1];
    view->axis[1][0] = -fmin(fmax(aspect, 0.3), 3) / range[0];
}

/*
 * Compute the mean of the unit normals of the surface at all nodes, along which a picture is
 * viewed. Returns the length of the mean: 1 for a plate, 0 for a closed surface.
 */
static double mean_normal(const mesh *mesh, double normal[3])
{
    normal[0] = normal[1] = normal[2] = 0;
    for (int n = 0; n < mesh->nodes; n++)
        for (int i = 0; i < 3; i++)
            normal[i] += mesh->point[n].triad[2][i] / mesh->nodes;
    return vector_length(normal);
}

bool view_has_parameters(const mesh *mesh)
{
    return mesh->elements > 0 && !mesh->quads && !mesh->is_polar;
}

void view_begin(view *view, const mesh *mesh, bool is_map)
{
    static const double upwards[3] = {0, 0, 1};
    double normal[3];
    const double length = mean_normal(mesh, normal);
    memset(view, 0, sizeof *view);
    if (!is_map || (mesh->quads && length <= 0.3))
        look_at(view, normal);
    else if (view_has_parameters(mesh))
        look_at_parameters(view, mesh);
    else
        look_along(view, mesh->quads ? normal : upwards);
    for (int a = 0; a < 2; a++) {
        view->low[a] = DBL_MAX;
        view->high[a] = -DBL_MAX;
    }
}

void view_include(view *view, const double point[3])
{
    for (int a = 0; a < 2; a++) {
        const double along = vector_dot(view->axis[a], point);
        if (!isfinite(along))
            continue;
        view->low[a] = fmin(view->low[a], along);
        view->high[a] = fmax(view->high[a], along);
    }
}

void view_fit(view *view, double width, double height, double least)
{
    const double wide = fmax(view->high[0] - view->low[0], 1e-300);
    const double tall = fmax(view->high[1] - view->low[1], 1e-300);
    view->zoom = fmin((width - 2 * EDGE) / wide, (height - 2 * EDGE) / tall);
    view->width = width;
    view->height = fmax(view->zoom * tall + 2 * EDGE, least);
}

void view_project(const view *view, const double point[3], double at[2])
{
    const double right = vector_dot(view->axis[0], point) - (view->low[0] + view->high[0]) / 2;
    const double up = vector_dot(view->axis[1], point) - (view->low[1] + view->high[1]) / 2;
    at[0] = view->width / 2 + view->zoom * right;
    at[1] = view->height / 2 - view->zoom * up;
}

double view_magnification(const mesh *mesh, double most, double share)
{
    double extent[3];
    mesh_extent(mesh, extent);
    const double wanted = share * fmax(extent[0], fmax(extent[1], extent[2])) / most;
    return most > 0 && isfinite(wanted) && wanted > 0 ? draw_round(wanted) : 1;
}
