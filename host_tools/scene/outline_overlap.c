/* SPDX-License-Identifier: BSD-2-Clause */
/* Check that electrodes on one layer do not overlap (outline_overlap.h). */
#include "outline_overlap.h"

#include <math.h>
#include "outline_cover.h"

/*
 * Overlaps of electrodes that are given by formulas are found on a grid of OVERLAP_GRID x
 * OVERLAP_GRID squares in each element.
 */
enum { OVERLAP_GRID = 8 };

/* Two electrodes of one layer whose areas are compared. */
typedef struct electrode_pair {
    const scene *scene;
    const scene_patches *patches[2];
    int electrode[2];
} electrode_pair;

static const scene_outline *outline_of(const electrode_pair *pair, int k)
{
    return &pair->patches[k]->outlines->electrode[pair->electrode[k]];
}

/*
 * Return the area that two electrodes of polygons have in common, divided by the area of the
 * smaller electrode.
 */
static double polygon_overlap(const electrode_pair *pair)
{
    const scene_outline *one = outline_of(pair, 0), *other = outline_of(pair, 1);
    const polygon_box box = outline_box(one), other_box = outline_box(other);
    double common = 0;
    if (!polygon_boxes_meet(&box, &other_box))
        return 0;
    for (int i = 0; i < one->polygons; i++)
        for (int j = 0; j < other->polygons; j++)
            common += polygon_common_area(&one->polygon[i], &other->polygon[j]);
    return common / fmin(outline_plane_area(one), outline_plane_area(other));
}

/* Return whether an electrode covers the whole of a cell, which is an element or a part of one. */
static bool fills(const scene *scene, const scene_patches *patches, const scene_outline *outline,
                  const outline_cell *cell, clip_room *room)
{
    static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    bool is_inside = true;
    if (!outline->inside)
        return outline_cover(scene, patches->plane, cell, outline, room).plane_area >
               (1 - 1e-9) * cell->plane_area;
    for (int vertex = 0; vertex < 4; vertex++) {
        const expr_point point = outline_cell_point(scene, cell, corner[vertex]);
        is_inside = is_inside && expr_value(outline->inside, &point) > 0;
    }
    return is_inside;
}

/*
 * Return whether both electrodes of a pair cover a whole square of the OVERLAP_GRID x OVERLAP_GRID
 * squares into which an element is divided.
 */
static bool both_fill(const electrode_pair *pair, int element, clip_room *room)
{
    for (int i = 0; i < OVERLAP_GRID; i++)
        for (int j = 0; j < OVERLAP_GRID; j++) {
            const double size = 2.0 / OVERLAP_GRID;
            const double low[2] = {i * size - 1, j * size - 1},
                         high[2] = {(i + 1) * size - 1, (j + 1) * size - 1};
            bool is_filled = true;
            for (int k = 0; k < 2 && is_filled; k++) {
                outline_cell whole, part;
                outline_cell_of(pair->scene, pair->patches[k]->plane, element, &whole);
                outline_cell_part(&whole, pair->patches[k]->plane, low, high, &part);
                is_filled = fills(pair->scene, pair->patches[k], outline_of(pair, k), &part, room);
            }
            if (is_filled)
                return true;
        }
    return false;
}

/*
 * Return whether two electrodes overlap in some element: together they cover more than the element,
 * or both cover the same one of the squares into which it is divided.
 */
static bool do_share_elements(const electrode_pair *pair, clip_room *room)
{
    const double most = 1 + 1e-3;
    for (int element = 0; element < pair->patches[0]->outlines->elements; element++) {
        const double one = outline_share(pair->patches[0]->outlines, pair->electrode[0], element),
                     other = outline_share(pair->patches[1]->outlines, pair->electrode[1], element);
        if (one > 0 && other > 0 && (one + other > most || both_fill(pair, element, room)))
            return true;
    }
    return false;
}

static int refuse_overlap(const electrode_pair *pair, char *error)
{
    return scene_fault(outline_of(pair, 1)->at, error,
                       "electrode %d of patches '%s' and electrode %d of patches '%s' overlap on "
                       "one layer; move one, or cut it back to its part",
                       pair->electrode[0] + 1, pair->patches[0]->name, pair->electrode[1] + 1,
                       pair->patches[1]->name);
}

/*
 * Refuse two electrodes of one layer whose common area is more than a thousandth of the smaller
 * electrode.
 */
static int check_pair(const electrode_pair *pair, char *error)
{
    const scene_outline *one = outline_of(pair, 0), *other = outline_of(pair, 1);
    clip_room room = {NULL, NULL};
    bool is_bad;
    if (!one->inside && !other->inside && pair->patches[0]->plane == pair->patches[1]->plane)
        is_bad = !(polygon_overlap(pair) < 1e-3);
    else {
        const size_t points = outline_most_points(one) + outline_most_points(other);
        is_bad = clip_room_open(&room, points) < 0 || do_share_elements(pair, &room);
    }
    clip_room_close(&room);
    return is_bad ? refuse_overlap(pair, error) : 0;
}

/* Return whether an element belongs to a patch that consists of whole elements. */
static bool has_patch(const scene *scene, const scene_patches *patches, int element)
{
    outline_cell cell;
    if (patches->patch)
        return patches->patch[element] >= 0;
    outline_cell_of(scene, OUTLINE_THETA, element, &cell);
    return cell.centre[0] > patches->theta1[0] && cell.centre[0] < patches->theta1[1] &&
           cell.centre[1] > patches->theta2[0] && cell.centre[1] < patches->theta2[1];
}

/* Refuse electrodes with outlines that lie on elements of patches on the same layer. */
static int check_whole(const scene *scene, const scene_patches *outlined,
                       const scene_patches *whole, char *error)
{
    const scene_outlines *outlines = outlined->outlines;
    for (int element = 0; element < outlines->elements; element++)
        for (size_t i = outlines->start[element]; i < outlines->start[element + 1]; i++)
            if (outlines->share[i] > 1e-3 && has_patch(scene, whole, element))
                return scene_fault(outlines->electrode[outlines->electrode_of[i]].at, error,
                                   "electrode %d of patches '%s' and patches '%s' overlap on one "
                                   "layer; move one",
                                   outlines->electrode_of[i] + 1, outlined->name, whole->name);
    return 0;
}

/*
 * Refuse overlaps between any electrode of one item of the section `patches` and any electrode of
 * another, or between any two of the same item. Returns 0, or a negative number with error filled.
 */
static int check_items(const scene *scene, const scene_patches *one, const scene_patches *other,
                       char *error)
{
    int status = 0;
    for (int j = 0; j < other->outlines->electrodes && status == 0; j++) {
        const int end = one == other ? j : one->outlines->electrodes;
        for (int i = 0; i < end && status == 0; i++) {
            const electrode_pair pair = {scene, {one, other}, {i, j}};
            status = check_pair(&pair, error);
        }
    }
    return status;
}

int outline_check_overlaps(const scene *scene, int item, char *error)
{
    const scene_patches *own = &scene->patches[item];
    int status = 0;
    for (int k = 0; k < scene->patch_grids && status == 0; k++) {
        const scene_patches *other = &scene->patches[k];
        if (other->layer != own->layer)
            continue;
        if (!other->outlines)
            status = check_whole(scene, own, other, error);
        else if (k <= item)
            status = check_items(scene, other, own, error);
    }
    return status;
}
