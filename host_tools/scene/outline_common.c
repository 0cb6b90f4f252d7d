/* SPDX-License-Identifier: BSD-2-Clause */
/* Common areas of electrodes on two layers (outline_common.h). */
#include "outline_common.h"

#include <math.h>
#include <stdlib.h>
#include "outline_cell.h"
#include "outline_shares.h"

/*
 * Clip all polygons of an electrode to a cell (element or part of one). Returns the clipped
 * polygons, or NULL where memory runs out.
 */
static polygon *clip_all(const outline_cell *cell, const scene_outline *outline)
{
    polygon *piece = calloc((size_t)outline->polygons + 1, sizeof *piece);
    for (int i = 0; piece && i < outline->polygons; i++) {
        const polygon *own = &outline->polygon[i];
        double(*work)[2] = calloc(POLYGON_ROOM(own->count), sizeof *work);
        piece[i].point = calloc(POLYGON_ROOM(own->count), sizeof *piece[i].point);
        if (work && piece[i].point)
            piece[i].count = polygon_clip((const double(*)[2])own->point, own->count,
                                          (const double(*)[2])cell->quad, work, piece[i].point);
        free(work);
    }
    return piece;
}

static void free_pieces(polygon *piece, int count)
{
    for (int i = 0; piece && i < count; i++)
        free(piece[i].point);
    free(piece);
}

double outline_common_share(const scene *scene, const scene_patches *one, int electrode,
                            const scene_patches *other, int other_electrode, int element)
{
    const scene_outline *own = &one->outlines->electrode[electrode],
                        *second = &other->outlines->electrode[other_electrode];
    const double share[2] = {outline_share(one->outlines, electrode, element),
                             outline_share(other->outlines, other_electrode, element)};
    const double least = fmin(share[0], share[1]);
    if (fmax(share[0], share[1]) >= 1)
        return least;
    if (own->inside || second->inside || one->plane != other->plane)
        return share[0] * share[1];
    outline_cell cell;
    outline_cell_of(scene, one->plane, element, &cell);
    polygon *first = clip_all(&cell, own), *last = clip_all(&cell, second);
    double area = 0;
    for (int i = 0; first && last && i < own->polygons; i++)
        for (int j = 0; j < second->polygons; j++)
            area += polygon_common_area(&first[i], &last[j]);
    free_pieces(first, own->polygons);
    free_pieces(last, second->polygons);
    const double common = area / cell.plane_area;
    return common > least * (1 - 1e-6) ? least : common;
}
