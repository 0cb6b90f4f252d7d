/* SPDX-License-Identifier: BSD-2-Clause */
/* Electrodes of any outline in the map of a surface (report_outlines.h). */
#include "report_outlines.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include "../scene/outline_pieces.h"
#include "report_quads.h"
#include "report_shell.h"

/*
 * Compute the place in the picture of a point of an element. natural [2] in: natural coordinates of
 * the point
 */
static void place(const shell *s, int element, const double natural[2], double at[2])
{
    double theta[2][2], point[2];
    if (s->m->quads) {
        quads_inside(s, element, natural, at);
        return;
    }
    mesh_cell(s->m, element, theta[0], theta[1]);
    for (int a = 0; a < 2; a++)
        point[a] = theta[a][0] + (natural[a] + 1) / 2 * (theta[a][1] - theta[a][0]);
    plane_at(&s->plane, point[0], point[1], at);
}

/* ---- drawing ---------------------------------------------------------- */

static void draw_piece(void *context, int element, const double (*natural)[2], size_t count)
{
    const shell *s = context;
    double(*at)[2] = calloc(count, sizeof *at);
    for (size_t i = 0; at && i < count; i++)
        place(s, element, natural[i], at[i]);
    if (at && count == 2)
        draw_line(s->file, at[0], at[1]);
    else if (at)
        draw_polygon(s->file, (const double(*)[2])at, (int)count);
    free(at);
}

static void draw_pieces(const shell *s, const scene_patches *patches, int electrode,
                        bool draws_outline)
{
    shell picture = *s;
    for (int element = 0; element < s->m->elements; element++)
        outline_pieces(s->m->scene, patches, electrode, element, draws_outline, draw_piece,
                       &picture);
}

void outlines_area(const shell *s, const scene_patches *patches, int electrode)
{
    draw_pieces(s, patches, electrode, false);
}

void outlines_border(const shell *s, const scene_patches *patches, int electrode)
{
    draw_pieces(s, patches, electrode, true);
}

/* ---- room for text ---------------------------------------------------- */

/*
 * Area in the picture of the pieces of an electrode, and the integral of the place over this area.
 */
typedef struct piece_sums {
    const shell *s;
    double area, sum[2];
} piece_sums;

static void sum_piece(void *context, int element, const double (*natural)[2], size_t count)
{
    piece_sums *sums = context;
    double first[2], last[2], here[2];
    place(sums->s, element, natural[0], first);
    place(sums->s, element, natural[1], last);
    for (size_t i = 2; i < count; i++) {
        place(sums->s, element, natural[i], here);
        const double area = ((last[0] - first[0]) * (here[1] - first[1]) -
                             (last[1] - first[1]) * (here[0] - first[0])) /
                            2;
        sums->area += area;
        for (int a = 0; a < 2; a++) {
            sums->sum[a] += area * (first[a] + last[a] + here[a]) / 3;
            last[a] = here[a];
        }
    }
}

void outlines_room(const shell *s, const scene_patches *patches, int electrode, double at[2],
                   double *size)
{
    piece_sums sums = {s, 0, {0, 0}};
    for (int element = 0; element < s->m->elements; element++)
        outline_pieces(s->m->scene, patches, electrode, element, false, sum_piece, &sums);
    const double area = fabs(sums.area) > DBL_MIN ? sums.area : DBL_MIN;
    for (int a = 0; a < 2; a++)
        at[a] = sums.sum[a] / area;
    *size = sqrt(fabs(area));
}

bool outlines_meet(const scene_patches *one, const scene_patches *other)
{
    if (one->layer == other->layer)
        return false; /* The check of the scene has refused electrodes of one layer that overlap. */
    if (!one->outlines || !other->outlines)
        return true;
    for (int element = 0; element < one->outlines->elements; element++)
        if (one->outlines->start[element + 1] > one->outlines->start[element] &&
            other->outlines->start[element + 1] > other->outlines->start[element])
            return true;
    return false;
}
