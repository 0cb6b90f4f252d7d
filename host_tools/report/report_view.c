/* SPDX-License-Identifier: BSD-2-Clause */
/* Parallel projections of a mesh to a picture. */
#include "report_shell.h"
#include <float.h>
#include <math.h>
#include <string.h>
#include "../quads/vector.h"

/* Smallest distance of the drawn points from the edges of a picture, in pixels. */
enum { EDGE = 18 };

void view_axes(const double towards[3], int up, double axis[3][3])
{
    memcpy(axis[2], towards, sizeof axis[2]);
    vector_normalise(axis[2]);
    for (int i = 0; i < 3; i++)
        axis[1][i] = (i == up) - axis[2][up] * axis[2][i];
    vector_normalise(axis[1]);
    vector_cross(axis[1], axis[2], axis[0]);
}

/* Choose the view from 30 degrees above the horizon that shows most of the outer side. */
static void look_at(view *view, const double normal[3])
{
    const double degree = 0.017453292519943295, up = sin(30 * degree), out = cos(30 * degree);
    double best = -2;
    for (int azimuth = -58; azimuth < 300; azimuth += 90) {
        const double angle = azimuth * degree;
        const double towards[3] = {out * cos(angle), out * sin(angle), up};
        const double shown = vector_dot(normal, towards);
        if (shown > best + 1e-6)
            view_axes(towards, 2, view->axis);
        best = fmax(best, shown);
    }
}

/* Map theta1 downwards and theta2 to the right, in the mean proportions of the shell, 0.3 to 3. */
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
    view->axis[0][1] = 1 / range[1];
    view->axis[1][0] = -fmin(fmax(aspect, 0.3), 3) / range[0];
}

bool view_has_parameters(const mesh *mesh)
{
    return mesh->elements > 0 && !mesh->quads && !mesh->is_polar;
}

void view_begin(view *view, const mesh *mesh, bool is_map)
{
    static const double upwards[3] = {0, 0, 1};
    double normal[3] = {0, 0, 0}; /* mean of the unit normals of the surface at all nodes, whose
                                     length is 1 for a plate and 0 for a closed surface */
    for (int k = 0; k < 3 * mesh->nodes; k++)
        normal[k % 3] += mesh->point[k / 3].triad[2][k % 3] / mesh->nodes;
    const double *towards = mesh->quads ? normal : upwards;
    *view = (struct view){.low = {DBL_MAX, DBL_MAX}, .high = {-DBL_MAX, -DBL_MAX}};
    if (!is_map || (mesh->quads && vector_length(normal) <= 0.3))
        look_at(view, normal);
    else if (view_has_parameters(mesh))
        look_at_parameters(view, mesh);
    else
        view_axes(towards, fabs(towards[1]) > 0.9 * vector_length(towards) ? 2 : 1, view->axis);
}

void view_include(view *view, const double point[3])
{
    for (int a = 0; a < 2; a++) {
        const double along = vector_dot(view->axis[a], point);
        if (isfinite(along)) {
            view->low[a] = fmin(view->low[a], along);
            view->high[a] = fmax(view->high[a], along);
        }
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
    double off[2];
    for (int a = 0; a < 2; a++)
        off[a] = vector_dot(view->axis[a], point) - (view->low[a] + view->high[a]) / 2;
    at[0] = view->width / 2 + view->zoom * off[0];
    at[1] = view->height / 2 - view->zoom * off[1];
}

double view_magnification(const mesh *mesh, double most, double share)
{
    double extent[3];
    mesh_extent(mesh, extent);
    const double wanted = share * fmax(extent[0], fmax(extent[1], extent[2])) / most;
    return most > 0 && isfinite(wanted) && wanted > 0 ? draw_round(wanted) : 1;
}
