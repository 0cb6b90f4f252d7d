/* SPDX-License-Identifier: BSD-2-Clause */
/* List of the element types of a mesh (element_types.h). */
#include "element_types.h"
#include <math.h>
#include "warp.h"

/*
 * Largest difference of equal element types, relative: positions that are computed are rounded in
 * their last digits, those of a mesh file by the program that wrote it.
 */
static const double computed = 1e-12, in_file = 1e-9;

/*
 * Whether two arrays are equal up to the rounding of node positions: within `near` of their largest
 * entry, or of `scale` where all entries are smaller.
 */
static int alike(double near, const double *x, const double *y, size_t n, double scale)
{
    double largest = scale, difference = 0;
    for (size_t i = 0; i < n; i++) {
        largest = fmax(largest, fabs(x[i]));
        difference = fmax(difference, fabs(x[i] - y[i]));
    }
    return difference <= near * largest;
}

static int same_place(double near, const laminate_place *x, const laminate_place *y)
{
    const double flat = 1 / x->chord[0];
    return alike(near, &x->area, &y->area, 1, 0) && x->present_plies == y->present_plies &&
           alike(near, x->chord, y->chord, 2, 0) && alike(near, x->k, y->k, 2, flat) &&
           alike(near, &x->bubble_share, &y->bubble_share, 1, 0) &&
           alike(near, x->skew, y->skew, 2, 1) &&
           alike(near, &x->natural.base[0][0], &y->natural.base[0][0], 9, 1) &&
           alike(near, &x->natural.slope[0][0], &y->natural.slope[0][0], 9, flat);
}

static int same_type(double near, const pzs_element_type *x, const laminate_place *at_x,
                     const pzs_element_type *y, const laminate_place *at_y)
{
    return same_place(near, at_x, at_y) &&
           alike(near, &x->s[0][0][0][0], &y->s[0][0][0][0], 72, 0) &&
           alike(near, &x->t[0][0][0][0], &y->t[0][0][0][0], 72, 0) &&
           alike(near, &x->g_mean[0][0][0], &y->g_mean[0][0][0], 24, 0) &&
           alike(near, &x->g_diff[0][0][0], &y->g_diff[0][0][0], 24, 1 / at_x->chord[0]);
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

int type_list_add(type_list *list, pzs_element_type *type, const laminate_place *place,
                  double warp_share, char *error)
{
    const scene *scene = list->scene;
    const int known = find_type(list, type, place);
    if (known >= 0)
        return known;
    if (laminate_modes(list->laminate, &scene->element, place, type->d) < 0)
        return scene_fault(
            scene, scene->at_layers, error,
            "no layer is present outside the patches, so the stiffness is 0 there; add a layer "
            "without patches");
    if (warp_fill(type, warp_share) < 0)
        return scene_fault(scene, scene->at_surface, error,
                           "an element of %g x %g is degenerate; use other mesh lines",
                           place->chord[0], place->chord[1]);
    list->type[list->count] = *type;
    list->place[list->count] = *place;
    return list->count++;
}
