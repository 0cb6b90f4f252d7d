/* SPDX-License-Identifier: BSD-2-Clause */
/* Area fraction of each element that each electrode covers (outline_shares.h). */
#include "outline_shares.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "outline_cover.h"
#include "outline_formula.h"

/*
 * A part of an element's area that an electrode covers counts as 0 below ROUNDING, and as 1 above 1
 * - ROUNDING. An outline along the sides of elements therefore gives exactly 0 and 1.
 */
static const double ROUNDING = 1e-12;

/* ---- shares of all elements ------------------------------------------- */

typedef struct share_entry {
    int element, electrode;
    double share;
} share_entry;

typedef struct share_list {
    share_entry *entry;
    size_t count, room;
    bool is_full; /* whether memory ran out while area fractions were appended to the list */
} share_list;

static void append(share_list *list, int element, int electrode, double share)
{
    if (list->count == list->room) {
        const size_t room = 2 * list->room + 256;
        share_entry *bigger = realloc(list->entry, room * sizeof *bigger);
        list->is_full |= !bigger;
        if (!bigger)
            return;
        list->entry = bigger;
        list->room = room;
    }
    list->entry[list->count++] = (share_entry){element, electrode, share};
}

/*
 * Arguments and work memory for one item of the section `patches`, while the area fraction of each
 * element that each of its electrodes covers is computed.
 */
typedef struct outline_work {
    const scene *scene;
    scene_patches *patches;
    outline_cell *cell; /* [elements] quadrilateral of each element in the plane of the electrode
                           outlines */
    int elements;
    share_list list;
    char *error;
} outline_work;

/* Return whether the layer on which the electrodes lie exists in an element. */
static bool has_layer(const outline_work *work, int element)
{
    const scene_layer *layer = &work->scene->layer[work->patches->layer];
    return !layer->present || layer->present[element];
}

/*
 * Area and orientation of one electrode, found from all elements that it covers. is_mirrored,
 * is_direct: whether the inner, or the outer, face of the surface is seen along the normal of the
 * plane in which outlines are drawn. Both are true if the outline lies over two parts of the
 * surface, such as both halves of a cylinder.
 */
typedef struct electrode_sums {
    double plane_area; /* area of that part of the electrode which lies on the surface, measured in
                          the plane in which the outlines are drawn */
    bool is_mirrored, is_direct;
} electrode_sums;

static int refuse_steep(const outline_work *work, int electrode, const outline_cell *cell)
{
    return scene_fault(work->patches->outlines->electrode[electrode].at, work->error,
                       "electrode %d of patches '%s' reaches an element near x = %g, y = %g, z = "
                       "%g that stands upright on the plane of the outline or is folded there; "
                       "choose another 'plane'",
                       electrode + 1, work->patches->name, cell->at[0][0], cell->at[0][1],
                       cell->at[0][2]);
}

/*
 * Append the area fraction of one element that an electrode covers to the list of these fractions.
 * Returns 0, or -1 with error filled.
 */
static int add_share(outline_work *work, int electrode, int element, clip_room *room,
                     electrode_sums *sums)
{
    const scene_outline *outline = &work->patches->outlines->electrode[electrode];
    const outline_cell *cell = &work->cell[element];
    double share;
    if (outline->inside) {
        formula_grid value;
        if (formula_sample(work->scene, cell, outline, value, work->error) != 0)
            return -1;
        share = formula_share(cell, value);
    } else {
        const outline_area part =
            outline_cover(work->scene, work->patches->plane, cell, outline, room);
        if (part.plane_area > ROUNDING * cell->plane_area && cell->is_steep)
            return refuse_steep(work, electrode, cell);
        share = part.area / cell->area;
        sums->plane_area += part.plane_area;
    }
    if (!(share > ROUNDING))
        return 0;
    sums->is_mirrored |= cell->is_mirrored;
    sums->is_direct |= !cell->is_mirrored;
    append(&work->list, element, electrode, share > 1 - ROUNDING ? 1 : share);
    return 0;
}

enum { HINT = 200 };

/*
 * Write the end of an error message: the range of the coordinates of all electrodes, and that of
 * the surface. Their comparison reveals a pitch or a centre in a wrong unit.
 *   hint [HINT] out  empty where an electrode has a formula in place of polygons
 */
static void write_place_hint(const outline_work *work, char hint[HINT])
{
    const scene_outlines *outlines = work->patches->outlines;
    polygon_box surface = work->cell[0].box, all = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    bool has_formula = false;
    for (int axis = 0; axis < 2; axis++) {
        for (int element = 0; element < work->elements; element++) {
            surface.low[axis] = fmin(surface.low[axis], work->cell[element].box.low[axis]);
            surface.high[axis] = fmax(surface.high[axis], work->cell[element].box.high[axis]);
        }
        for (int k = 0; k < outlines->electrodes; k++) {
            has_formula |= outlines->electrode[k].inside != NULL;
            all.low[axis] = fmin(all.low[axis], outlines->electrode[k].low[axis]);
            all.high[axis] = fmax(all.high[axis], outlines->electrode[k].high[axis]);
        }
    }
    snprintf(hint, HINT,
             "; all electrodes lie within [%.3g, %.3g] to [%.3g, %.3g], the surface within [%.3g, "
             "%.3g] to [%.3g, %.3g]: compare their units and centres",
             all.low[0], all.low[1], all.high[0], all.high[1], surface.low[0], surface.low[1],
             surface.high[0], surface.high[1]);
    if (has_formula)
        hint[0] = '\0';
}

/*
 * Refuse an electrode given by polygons if a part of its area lies outside the surface. Refuse it
 * too if its outline lies over two parts of the surface, such as both halves of a cylinder seen
 * from the side. Returns 0, or -1 with error filled.
 */
static int check_place(const outline_work *work, int electrode, const electrode_sums *sums)
{
    const double theta_most = 1e-9,
                 space_most = 0.05; /* largest fraction of an electrode's area that may lie outside
                                       the surface. theta_most: for outlines over the surface
                                       coordinates theta1 and theta2. space_most: for outlines in a
                                       plane of space, where the rim of a mesh has straight sides in
                                       place of the true curve */
    const scene_outline *outline = &work->patches->outlines->electrode[electrode];
    const double outside = 1 - sums->plane_area / outline_plane_area(outline);
    const bool is_folded = sums->is_mirrored && sums->is_direct;
    char hint[HINT];
    if (is_folded || outside < -0.01)
        return scene_fault(outline->at, work->error,
                           "electrode %d of patches '%s' meets the surface twice in the plane of "
                           "the outlines; choose another 'plane', or give the layer 'sets' on one "
                           "side alone",
                           electrode + 1, work->patches->name);
    if (work->patches->cut ||
        outside <= (work->patches->plane == OUTLINE_THETA ? theta_most : space_most))
        return 0;
    write_place_hint(work, hint);
    return scene_fault(outline->at, work->error,
                       "%.3g %% of electrode %d of patches '%s' lie outside the surface or the "
                       "layer; move or shrink it, or keep the part inside by 'cut: true'%s",
                       100 * outside, electrode + 1, work->patches->name, hint);
}

/*
 * Compute the area fraction of every element that one electrode covers, and append the fractions
 * above 0 to the list. Returns 0, or -1 with error filled.
 */
static int add_electrode(outline_work *work, int electrode)
{
    const scene_outline *outline = &work->patches->outlines->electrode[electrode];
    const size_t before = work->list.count;
    electrode_sums sums = {0, false, false};
    clip_room room;
    char hint[HINT];
    int status = clip_room_open(&room, outline_most_points(outline));
    if (status < 0)
        scene_fault(outline->at, work->error, "the outlines do not fit into memory");
    for (int element = 0; element < work->elements && status == 0; element++)
        if (has_layer(work, element))
            status = add_share(work, electrode, element, &room, &sums);
    clip_room_close(&room);
    if (status == 0 && work->list.count == before) {
        write_place_hint(work, hint);
        return scene_fault(outline->at, work->error,
                           "electrode %d of patches '%s' lies outside the surface or its layer; "
                           "move it%s",
                           electrode + 1, work->patches->name, hint);
    }
    if (status == 0 && !outline->inside)
        status = check_place(work, electrode, &sums);
    return status;
}

/*
 * Sort the list of the area fractions that electrodes cover: by elements, and in each element by
 * electrodes. Returns 0, or -1 where memory runs out.
 */
static int sort_entries(const share_list *list, int elements, scene_outlines *outlines)
{
    outlines->elements = elements;
    outlines->start = calloc((size_t)elements + 2, sizeof *outlines->start);
    outlines->electrode_of = calloc(list->count + 1, sizeof *outlines->electrode_of);
    outlines->share = calloc(list->count + 1, sizeof *outlines->share);
    if (!outlines->start || !outlines->electrode_of || !outlines->share || list->is_full)
        return -1;
    for (size_t i = 0; i < list->count; i++)
        outlines->start[list->entry[i].element + 2]++;
    for (int element = 0; element < elements; element++)
        outlines->start[element + 2] += outlines->start[element + 1];
    for (size_t i = 0; i < list->count; i++) { /* the list is sorted by electrodes, so that the
                                                  entries of each element keep the order of the
                                                  electrodes */
        const size_t to = outlines->start[list->entry[i].element + 1]++;
        outlines->electrode_of[to] = list->entry[i].electrode;
        outlines->share[to] = list->entry[i].share;
    }
    return 0;
}

int outline_find_shares(const scene *scene, scene_patches *patches, char *error)
{
    outline_work work = {scene, patches, NULL, outline_elements(scene), {NULL, 0, 0, false}, error};
    int status = 0;
    work.cell = calloc((size_t)work.elements, sizeof *work.cell);
    if (!work.cell)
        return scene_fault(patches->at, error, "the outlines do not fit into memory");
    for (int element = 0; element < work.elements; element++)
        outline_cell_of(scene, patches->plane, element, &work.cell[element]);
    for (int k = 0; k < patches->outlines->electrodes && status == 0; k++)
        status = add_electrode(&work, k);
    if (status == 0 && sort_entries(&work.list, work.elements, patches->outlines) < 0)
        status = scene_fault(patches->at, error, "the outlines do not fit into memory");
    free(work.cell);
    free(work.list.entry);
    return status;
}

/* Return the fraction of the area of an element that all electrodes of a list cover. */
static double share_of_all(const scene_outlines *outlines, int element)
{
    double sum = 0;
    for (size_t i = outlines->start[element]; i < outlines->start[element + 1]; i++)
        sum += outlines->share[i];
    return sum;
}

double outline_smeared_share(const scene *scene, int layer, int element)
{
    double sum = 0;
    for (int k = 0; k < scene->patch_grids; k++)
        if (scene->patches[k].is_smeared && scene->patches[k].layer == layer)
            sum += share_of_all(scene->patches[k].outlines, element);
    return sum > 1 - ROUNDING ? 1 : sum;
}

bool outline_is_smeared(const scene *scene, int layer)
{
    for (int k = 0; k < scene->patch_grids; k++)
        if (scene->patches[k].is_smeared && scene->patches[k].layer == layer)
            return true;
    return false;
}

outline_cuts outline_cuts_of(const scene *scene, int layer, int elements)
{
    outline_cuts cuts = {0, 1, 0};
    for (int element = 0; element < elements; element++) {
        const double share = outline_smeared_share(scene, layer, element);
        if (!(share > 0 && share < 1))
            continue;
        cuts.elements++;
        cuts.least = fmin(cuts.least, share);
        cuts.most = fmax(cuts.most, share);
    }
    return cuts;
}

double outline_share(const scene_outlines *outlines, int electrode, int element)
{
    for (size_t i = outlines->start[element]; i < outlines->start[element + 1]; i++)
        if (outlines->electrode_of[i] == electrode)
            return outlines->share[i];
    return 0;
}
