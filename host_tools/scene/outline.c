/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Lists of electrodes with outlines of any shape, and of the polygons that they cover (outline.h).
 */
#include "outline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../data/polygon.h"

scene_outline *outline_append(scene_outlines *outlines, scene_at at)
{
    const size_t count = (size_t)outlines->electrodes;
    scene_outline *bigger = outlines->electrode;
    if ((count & (count - 1)) == 0) /* the memory of a list of electrodes or polygons is doubled
                                       whenever its length is a power of two */
        bigger = realloc(bigger, (count ? 2 * count : 1) * sizeof *bigger);
    if (!bigger)
        return NULL;
    outlines->electrode = bigger;
    memset(&bigger[count], 0, sizeof *bigger);
    bigger[count].at = at;
    outlines->electrodes++;
    return &bigger[count];
}

double (*outline_polygon(scene_outline *outline, size_t count))[2]
{
    const size_t had = (size_t)outline->polygons;
    polygon *bigger = outline->polygon;
    double(*point)[2] = calloc(count, sizeof *point);
    if ((had & (had - 1)) == 0)
        bigger = realloc(bigger, (had ? 2 * had : 1) * sizeof *bigger);
    if (bigger)
        outline->polygon = bigger;
    if (!point || !bigger) {
        free(point);
        return NULL;
    }
    bigger[had].count = count;
    bigger[had].point = point;
    outline->polygons++;
    return point;
}

static void find_box(scene_outline *outline)
{
    for (int a = 0; a < 2; a++) {
        outline->low[a] = HUGE_VAL;
        outline->high[a] = -HUGE_VAL;
    }
    for (int i = 0; i < outline->polygons; i++) {
        const polygon *own = &outline->polygon[i];
        const polygon_box box = polygon_box_of((const double(*)[2])own->point, own->count);
        for (int a = 0; a < 2; a++) {
            outline->low[a] = fmin(outline->low[a], box.low[a]);
            outline->high[a] = fmax(outline->high[a], box.high[a]);
        }
    }
}

void outlines_find_boxes(scene_outlines *outlines)
{
    for (int k = 0; k < outlines->electrodes; k++)
        find_box(&outlines->electrode[k]);
}

void outlines_free(scene_outlines *outlines)
{
    if (!outlines)
        return;
    for (int k = 0; k < outlines->electrodes; k++) {
        for (int i = 0; i < outlines->electrode[k].polygons; i++)
            free(outlines->electrode[k].polygon[i].point);
        free(outlines->electrode[k].polygon);
        expr_free(outlines->electrode[k].inside);
    }
    free(outlines->electrode);
    free(outlines->start);
    free(outlines->electrode_of);
    free(outlines->share);
    free(outlines);
}
