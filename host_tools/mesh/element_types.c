/* SPDX-License-Identifier: BSD-2-Clause */
/* List of the element types of a mesh, in which equal elements share one type (element_types.h). */
#include "../../lib/model/shell.h"
#include "../../lib/model/shell_corner.h"
#include "element_types.h"
#include <math.h>
#include <string.h>
#include "warp.h"

/*
 * Largest relative difference between the matrices of two elements that count as equal, so that
 * both elements share them in the tables (element type). The limit is `computed` where this program
 * computed the node positions and rounded their last digits, and `in_file` where the positions were
 * read from a mesh file.
 */
static const double computed = 1e-12, in_file = 1e-9;

/*
 * Return whether two arrays of an element type are equal up to the rounding of node positions:
 * their differences are at most `near` times their largest entry, or times `scale` if all entries
 * are smaller.
 */
static int alike(double near, const double *first, const double *second, size_t count, double scale)
{
    double largest = scale, difference = 0;
    for (size_t i = 0; i < count; i++) {
        largest = fmax(largest, fabs(first[i]));
        difference = fmax(difference, fabs(first[i] - second[i]));
    }
    return difference <= near * largest;
}

static int same_place(double near, const laminate_place *first, const laminate_place *second)
{
    const double flat = 1 / first->chord[0];
    return alike(near, &first->area, &second->area, 1, 0) &&
           first->present_plies == second->present_plies &&
           alike(near, first->absent, second->absent, LAMINATE_LAYERS, 1) &&
           alike(near, first->chord, second->chord, 2, 0) &&
           alike(near, first->curvature, second->curvature, 2, flat) &&
           alike(near, &first->bubble_share, &second->bubble_share, 1, 0) &&
           alike(near, first->skew, second->skew, 2, 1) &&
           alike(near, &first->natural.base[0][0], &second->natural.base[0][0], 9, 1) &&
           alike(near, &first->natural.slope[0][0], &second->natural.slope[0][0], 9, flat);
}

static int same_type(double near, const pzs_element_type *first, const laminate_place *first_place,
                     const pzs_element_type *second, const laminate_place *second_place)
{
    return same_place(near, first_place, second_place) &&
           alike(near, &first->s[0][0][0][0], &second->s[0][0][0][0], 72, 0) &&
           alike(near, &first->t[0][0][0][0], &second->t[0][0][0][0], 72, 0) &&
           alike(near, &first->g_mean[0][0][0], &second->g_mean[0][0][0], 24, 0) &&
           alike(near, &first->g_diff[0][0][0], &second->g_diff[0][0][0], 24,
                 1 / first_place->chord[0]);
}

static int find_type(const type_list *list, const pzs_element_type *type,
                     const laminate_place *place)
{
    const double near = list->scene->quads ? in_file : computed;
    for (int k = list->count - 1; k >= 0; k--)
        if (same_type(near, type, place, &list->type[k], &list->place[k]))
            return k;
    return -1;
}

/*
 * Copy the stiffness matrices of an element in its four strain modes without rows and columns of
 * strains that a mode does not contain. The modes contain 10, 5, 5 and 2 strains.
 *   full [4][55] in   lower triangles for all ten strains, packed by rows
 *   kept [88]    out  lower triangles for the strains of each mode, 55 + 15 + 15 + 3 entries
 */
static void keep_entries(const double (*full)[LAMINATE_PACKED], double *kept)
{
    for (int mode = 0; mode < SHELL_MODES; mode++)
        for (int i = 0; i < kept_strains[mode]; i++)
            for (int j = 0; j <= i; j++)
                *kept++ = full[mode][SHELL_PACKED(kept_strain[mode][i]) + kept_strain[mode][j]];
}

int type_list_add(type_list *list, pzs_element_type *type, const laminate_place *place,
                  double warp_share, char *error)
{
    const scene *scene = list->scene;
    const int known = find_type(list, type, place);
    if (known >= 0)
        return known;
    double full[4][LAMINATE_PACKED];
    laminate_heights heights;
    if (laminate_modes(list->laminate, &scene->element, place, full) < 0)
        return scene_fault(
            scene->at_layers, error,
            "no layer is present outside the patches, so the stiffness is 0 there; add a layer "
            "without patches");
    keep_entries((const double(*)[LAMINATE_PACKED])full, type->d);
    laminate_heights_of(list->laminate, &scene->element, place, &heights);
    memcpy(type->height_squared, heights.line, sizeof type->height_squared);
    if (warp_fill(type, warp_share) < 0)
        return scene_fault(scene->at_surface, error,
                           "an element of %g x %g is degenerate; use other mesh lines",
                           place->chord[0], place->chord[1]);
    list->type[list->count] = *type;
    list->place[list->count] = *place;
    return list->count++;
}
