/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Area that the polygons of an electrode cover in a cell, which is an element or a part of one
 * (outline_cover.h).
 */
#include "outline_cover.h"

#include <stdlib.h>

polygon_box outline_box(const scene_outline *outline)
{
    return (polygon_box){{outline->low[0], outline->low[1]}, {outline->high[0], outline->high[1]}};
}

size_t outline_most_points(const scene_outline *outline)
{
    size_t most = 4;
    for (int i = 0; i < outline->polygons; i++)
        most = outline->polygon[i].count > most ? outline->polygon[i].count : most;
    return most;
}

int clip_room_open(clip_room *room, size_t points)
{
    room->work = calloc(POLYGON_ROOM(points), sizeof *room->work);
    room->out = calloc(POLYGON_ROOM(points), sizeof *room->out);
    return room->work && room->out ? 0 : -1;
}

void clip_room_close(clip_room *room)
{
    free(room->work);
    free(room->out);
}

static void add_polygon(const outline_cell *cell, const polygon *polygon, clip_room *room,
                        outline_area *sum)
{
    const polygon_box box = polygon_box_of((const double(*)[2])polygon->point, polygon->count);
    if (!polygon_boxes_meet(&box, &cell->box))
        return;
    const size_t count = polygon_clip((const double(*)[2])polygon->point, polygon->count,
                                      (const double(*)[2])cell->quad, room->work, room->out);
    const polygon_sums sums = polygon_sums_of((const double(*)[2])room->out, count, cell->centre);
    sum->plane_area += sums.area;
    sum->area += outline_cell_area(cell, &sums);
}

outline_area outline_cover(const scene *scene, outline_plane plane, const outline_cell *cell,
                           const scene_outline *outline, clip_room *room)
{
    outline_area sum = {0, 0};
    const polygon_box box = outline_box(outline);
    for (int k = 0; k < OUTLINE_MOVES; k++) {
        outline_cell moved = *cell;
        double shift[2];
        if (!outline_cell_move(scene, plane, k, shift))
            continue;
        outline_cell_shift(&moved, shift);
        if (!polygon_boxes_meet(&box, &moved.box))
            continue;
        for (int i = 0; i < outline->polygons; i++)
            add_polygon(&moved, &outline->polygon[i], room, &sum);
    }
    return sum;
}

double outline_plane_area(const scene_outline *outline)
{
    double area = 0;
    for (int i = 0; i < outline->polygons; i++) {
        const polygon *own = &outline->polygon[i];
        const double(*point)[2] = (const double(*)[2])own->point;
        area += polygon_sums_of(point, own->count, point[0]).area;
    }
    return area;
}
