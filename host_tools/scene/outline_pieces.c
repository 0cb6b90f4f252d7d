/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Pictures of electrodes, drawn element by element: the part of an electrode, or of its outline,
 * that lies in each element (outline_pieces.h).
 */
#include "outline_pieces.h"

#include <string.h>
#include "outline_cover.h"
#include "outline_formula.h"
#include "outline_shares.h"

/*
 * Picture of one electrode in one element: the element, the electrode, and the function that draws
 * each piece (the part of the electrode, or of its outline, in the element).
 */
typedef struct piece_drawing {
    outline_plane plane;
    outline_cell cell;  /* quadrilateral of the element in the plane of the electrode outlines */
    outline_cell moved; /* quadrilateral of the element in the plane of the electrode outlines
                           (`cell`) after the displacement `shift` */
    double shift[2];    /* displacement of the quadrilateral of the element in the plane of the
                           electrode outlines: 0, 2 pi or -2 pi along a coordinate that is an angle.
                           An outline may extend beyond the range of this angle in the mesh; it then
                           covers the element after a full turn */
    int element;
    outline_draw *draw;
    void *context;
    clip_room room;
} piece_drawing;

/*
 * Replace points of the plane of the electrode outlines by their natural coordinates in the element
 * that is being drawn.
 */
static void to_natural(const piece_drawing *drawing, double (*point)[2], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const double at[2] = {point[i][0] - drawing->shift[0], point[i][1] - drawing->shift[1]};
        outline_cell_natural(&drawing->cell, drawing->plane, at, point[i]);
    }
}

static void draw_area(const piece_drawing *drawing, const polygon *polygon)
{
    const size_t count = polygon_clip((const double(*)[2])polygon->point, polygon->count,
                                      (const double(*)[2])drawing->moved.quad, drawing->room.work,
                                      drawing->room.out);
    to_natural(drawing, drawing->room.out, count);
    if (count >= 3)
        drawing->draw(drawing->context, drawing->element, (const double(*)[2])drawing->room.out,
                      count);
}

/*
 * Cut a line segment to its part on the left of the straight line from a to b. Returns whether a
 * part remains.
 */
static bool cut_line(const double a[2], const double b[2], double (*line)[2])
{
    double left[2];
    for (int i = 0; i < 2; i++)
        left[i] = (b[0] - a[0]) * (line[i][1] - a[1]) - (b[1] - a[1]) * (line[i][0] - a[0]);
    if (left[0] < 0 && left[1] < 0)
        return false;
    for (int i = 0; i < 2; i++) {
        if (left[i] >= 0)
            continue;
        const double part = left[i] / (left[i] - left[1 - i]);
        for (int k = 0; k < 2; k++)
            line[i][k] += part * (line[1 - i][k] - line[i][k]);
    }
    return true;
}

/*
 * Pass those parts of the sides of an electrode's polygon that lie in the element
 * `drawing->element` to the drawing function.
 */
static void draw_sides(const piece_drawing *drawing, const polygon *polygon)
{
    for (size_t i = 0; i < polygon->count; i++) {
        double line[2][2];
        bool is_inside = true;
        memcpy(line[0], polygon->point[i], sizeof *line);
        memcpy(line[1], polygon->point[(i + 1) % polygon->count], sizeof *line);
        for (int k = 0; k < 4 && is_inside; k++)
            is_inside = cut_line(drawing->moved.quad[k], drawing->moved.quad[(k + 1) % 4], line);
        if (!is_inside)
            continue;
        to_natural(drawing, line, 2);
        drawing->draw(drawing->context, drawing->element, (const double(*)[2])line, 2);
    }
}

static void draw_polygons(piece_drawing *drawing, const scene *scene, const scene_outline *outline,
                          bool draws_outline)
{
    for (int k = 0; k < OUTLINE_MOVES; k++) {
        if (!outline_cell_move(scene, drawing->plane, k, drawing->shift))
            continue;
        drawing->moved = drawing->cell;
        outline_cell_shift(&drawing->moved, drawing->shift);
        for (int i = 0; i < outline->polygons; i++) {
            const polygon *polygon = &outline->polygon[i];
            const polygon_box box =
                polygon_box_of((const double(*)[2])polygon->point, polygon->count);
            if (polygon_boxes_meet(&box, &drawing->moved.box))
                (draws_outline ? draw_sides : draw_area)(drawing, polygon);
        }
    }
}

int outline_pieces(const scene *scene, const scene_patches *patches, int electrode, int element,
                   bool draws_outline, outline_draw *draw, void *context)
{
    const scene_outline *outline = &patches->outlines->electrode[electrode];
    char error[SCENE_ERROR];
    piece_drawing drawing = {
        .plane = patches->plane, .element = element, .draw = draw, .context = context};
    if (!(outline_share(patches->outlines, electrode, element) > 0))
        return 0;
    outline_cell_of(scene, patches->plane, element, &drawing.cell);
    if (outline->inside) {
        formula_grid value;
        const int status = formula_sample(scene, &drawing.cell, outline, value, error);
        if (status == 0)
            formula_pieces(value, element, draws_outline, draw, context);
        return status;
    }
    const int status = clip_room_open(&drawing.room, outline_most_points(outline));
    if (status == 0)
        draw_polygons(&drawing, scene, outline, draws_outline);
    clip_room_close(&drawing.room);
    return status;
}
