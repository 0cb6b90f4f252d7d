/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Element types of a mesh of quadrilaterals in any arrangement, and the checks of its elements
 * (quad_types.h).
 */
#include "quad_types.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "corner_tables.h"
#include "quad_regularity.h"
#include "smeared_plies.h"
#include "../quads/vector.h"

/* ---- topology ----------------------------------------------------------- */

static uint32_t element_of(const quad_side *side)
{
    return side->edge / 4;
}

/*
 * Return whether the element of a side has the two nodes of this side in descending order, when its
 * corners are visited in the order 0, 1, 2, 3, 0.
 */
static bool is_reversed(const quad_mesh *quads, const quad_side *side)
{
    return quads->element[element_of(side)][side->edge % 4] != side->low;
}

/*
 * Check that two elements run along their common side in opposite directions (side [2] in). Returns
 * 0, or -1 with error filled.
 */
static int check_pair(const scene *scene, const quad_mesh *quads, const quad_side *side,
                      char *error)
{
    if (is_reversed(quads, &side[0]) != is_reversed(quads, &side[1]))
        return 0;
    return scene_fault(scene->at_surface, error,
                       "the elements %u and %u have their outer faces on different sides of the "
                       "edge from node %u to node %u; orient all elements alike",
                       element_of(&side[0]), element_of(&side[1]), side[0].low, side[0].high);
}

/*
 * Check that the two elements which share a side run along it in opposite directions, and that no
 * side belongs to three elements. Returns 0, or -1 with error filled.
 *   side [count] in  sides of all elements, sorted so that those of one common side are adjacent
 *       (quad_sides)
 */
static int check_sorted(const scene *scene, const quad_mesh *quads, const quad_side *side,
                        size_t count, char *error)
{
    for (size_t k = 0; k + 1 < count; k++) {
        if (!quad_side_is_same(&side[k], &side[k + 1]))
            continue;
        if (k + 2 < count && quad_side_is_same(&side[k], &side[k + 2]))
            return scene_fault(
                scene->at_surface, error,
                "the edge from node %u to node %u belongs to the elements %u, %u and "
                "%u; at most two may share an edge",
                side[k].low, side[k].high, element_of(&side[k]), element_of(&side[k + 1]),
                element_of(&side[k + 2]));
        if (check_pair(scene, quads, &side[k], error) < 0)
            return -1;
    }
    return 0;
}

int quad_check_edges(const scene *scene, const quad_mesh *quads, char *error)
{
    quad_side *side = calloc(4 * quads->elements, sizeof *side);
    if (!side)
        return scene_fault(scene->at_surface, error,
                           "%zu elements do not fit into memory; use fewer", quads->elements);
    quad_sides(quads, side);
    const int status = check_sorted(scene, quads, side, 4 * quads->elements, error);
    free(side);
    return status;
}

/* ---- one element -------------------------------------------------------- */

/*
 * Compute the unit vectors of an element's material axes, as rows: the given direction projected on
 * the element, the axis normal to it in the element, and the normal of the element.
 */
static void material_axes(const quad_geometry *geometry, const double direction[3],
                          double axes[3][3])
{
    const double along = vector_dot(direction, geometry->normal);
    for (int i = 0; i < 3; i++) {
        axes[0][i] = direction[i] - along * geometry->normal[i];
        axes[2][i] = geometry->normal[i];
    }
    if (!(vector_length(axes[0]) > 1e-6 * vector_length(direction)))
        memcpy(axes[0], geometry->base[0], sizeof axes[0]);
    vector_normalise(axes[0]);
    vector_cross(axes[2], axes[0], axes[1]);
}

/*
 * Copy the skew coefficients of an element (deviations from a parallelogram); values that are
 * rounding error of the node positions become 0.
 */
static void set_skew(const quad_geometry *geometry, double skew[2])
{
    for (int direction = 0; direction < 2; direction++)
        skew[direction] = fabs(geometry->skew[direction]) > 1e-13 ? geometry->skew[direction] : 0;
}

static laminate_place quad_place(const quad_geometry *geometry, const quad_region *region,
                                 const double direction[3], const quad_rule *rule)
{
    laminate_place place = {.present_plies = region->present_plies,
                            .area = geometry->area,
                            .bubble_share = rule->bubble_share,
                            .is_general = true};
    double axes[3][3];
    material_axes(geometry, direction, axes);
    set_skew(geometry, place.skew);
    memcpy(place.curvature, geometry->principal, sizeof place.curvature);
    memcpy(place.chord, geometry->length, sizeof place.chord);
    for (int i = 0; i < 3; i++) {
        for (int direction = 0; direction < 2; direction++) {
            place.natural.base[i][direction] =
                2 * vector_dot(axes[i], geometry->base[direction]) / geometry->length[direction];
            place.natural.slope[i][direction] =
                2 * vector_dot(axes[i], geometry->turn[direction]) / geometry->length[direction];
        }
        place.natural.base[i][2] = vector_dot(axes[i], geometry->director);
    }
    return place;
}

/*
 * Arguments of quad_types_build, which builds the element types of a mesh of quadrilaterals in any
 * arrangement.
 */
typedef struct quad_build {
    type_list *list;
    const quad_mesh *quads;
    const surface_point *point;
    const double *irregularity; /* [nodes] irregularity of the mesh at each node (dimensionless):
                                   length of the sum of its edge vectors over the sum of their
                                   lengths, 0 at nodes on the border */
    uint16_t *element_type;
    quad_report *report;
} quad_build;

/*
 * Start the type of an element: fill its corner tables (displacements of the corners to strains),
 * its thickness, its skew coefficients alpha_1 and alpha_2 (0 on a parallelogram) and its length
 * ratio; all other members are 0.
 */
static void start_type(const quad_build *build, int element, const quad_geometry *geometry,
                       pzs_element_type *type)
{
    const laminate *laminate = build->list->laminate;
    corner_data data = {.is_cartesian = true,
                        .length = {geometry->length[0], geometry->length[1]},
                        .middle = (laminate->z[0] + laminate->z[1]) / 2};
    for (int corner = 0; corner < 4; corner++)
        data.point[corner] = &build->point[build->quads->element[element][corner]];
    memset(type, 0, sizeof *type);
    corner_tables_fill(&data, type);
    type->thickness = laminate->thickness;
    set_skew(geometry, type->skew);
    type->skew[2] = geometry->length[1] / geometry->length[0];
}

static int add_quad(quad_build *build, int element, const quad_geometry *geometry,
                    const quad_rule *rule, char *error)
{
    const quad_mesh *quads = build->quads;
    const uint32_t region = quads->element_region ? quads->element_region[element] : 0;
    const double tau = build->list->scene->element.tau,
                 thickness = build->list->laminate->thickness;
    const double *curvature = geometry->curvature, *length = geometry->length;
    const double *direction =
        quads->material_axis ? quads->material_axis[element] : quads->region[region].direction;
    laminate_place place = quad_place(geometry, &quads->region[region], direction, rule);
    const double sum = length[0] * length[0] * curvature[0] + length[1] * length[1] * curvature[1];
    pzs_element_type type;
    start_type(build, element, geometry, &type);
    smeared_plies_set(&place, build->list->scene, element);
    const int before = build->list->count;
    const int k = type_list_add(build->list, &type, &place, tau * sum / (12 * thickness), error);
    if (k < 0)
        return -1;
    build->element_type[element] = (uint16_t)k;
    for (int direction = 0; direction < 2 && k == before; direction++)
        build->list->type[k].warp[5 + 2 * direction] += tau * rule->asymptotic * curvature[2] *
                                                        length[direction] * length[direction] /
                                                        (6 * thickness);
    return 0;
}

/* ---- checks ------------------------------------------------------------- */

enum { NAMED = 4 }; /* largest number of elements that an error message lists */

static int check_shape(const scene *scene, int element, int status, const quad_geometry *geometry,
                       char *error)
{
    if (status < 0)
        return scene_fault(scene->at_surface, error,
                           "element %d has no extent, or a number in it is not finite", element);
    if (geometry->jacobian < 0.1)
        return scene_fault(scene->at_surface, error,
                           "element %d is nearly a triangle: at a corner its area falls to %.3g of "
                           "that at its centre, at least 0.1 is needed; use other quadrilaterals",
                           element, geometry->jacobian);
    if (geometry->upright < 0.5)
        return scene_fault(scene->at_surface, error,
                           "a director of element %d is %.0f degrees off its normal, at most 60 "
                           "are possible; use smaller elements, or orient the element like its "
                           "neighbours",
                           element, acos(fmax(-1, geometry->upright)) * 57.29577951308232);
    return 0;
}

/*
 * Return whether an element is too long for its curvature in a thin shell with an irregular mesh:
 * its largest curvature times squared length is above 8 times the thickness, its thickness below
 * 1/1000 of its length, and its irregularity above 0.1.
 */
static int is_coarse(const quad_rule *rule, const quad_geometry *geometry, double thickness)
{
    return rule->thinness > 8 &&
           thickness < 1e-3 * fmax(geometry->length[0], geometry->length[1]) &&
           rule->irregularity > 0.1;
}

static void add_to_report(quad_report *report, const quad_rule *rule, const quad_geometry *geometry,
                          double thickness)
{
    const int locks = rule->lock > QUAD_LOCK;
    const int coarse = !locks && (rule->bubble_share < 0.5 || is_coarse(rule, geometry, thickness));
    report->locking += locks;
    report->coarse += coarse;
    report->strips += rule->asymptotic > 0 && rule->thinness > 5 && rule->irregularity > 0.1;
    report->narrow += geometry->jacobian < 0.3;
    report->jacobian = fmin(report->jacobian, geometry->jacobian);
    if (locks || coarse) {
        report->thinness = fmax(report->thinness, rule->thinness);
        report->irregularity = fmax(report->irregularity, rule->irregularity);
    }
}

/*
 * Write the numbers of the first elements that are too stiff in bending as a text, for an error
 * message.
 *   named [NAMED] in  numbers of these elements
 *   count         in  number of all elements that are too stiff, which may be above NAMED
 */
static void name_elements(const int *named, int count, char *text, size_t size)
{
    size_t at = 0;
    for (int i = 0; i < count && i < NAMED && at < size; i++)
        at += (size_t)snprintf(text + at, size - at, "%s%d", i ? ", " : "", named[i]);
    if (count > NAMED && at < size)
        snprintf(text + at, size - at, " and %d more", count - NAMED);
}

static int refuse_locking(const quad_build *build, const int *named, double lock, char *error)
{
    const scene *scene = build->list->scene;
    const quad_report *report = build->report;
    char list[80];
    name_elements(named, report->locking, list, sizeof list);
    return scene_fault(
        scene->at_surface, error,
        "elements %s are too thin for an irregular mesh (curvature x length^2/thickness up to "
        "%.3g, irregularity up to %.2g), bending would be far too stiff; mesh along lines of "
        "curvature, use a smoother mesh or elements of %.2g of the length, or accept the error by "
        "`accept_irregular: true`",
        list, report->thinness, report->irregularity, pow(QUAD_LOCK / lock, 0.25));
}

/* ---- all elements ------------------------------------------------------- */

/*
 * Return the largest irregularity of the four nodes of an element. The irregularity of a node is
 * its distance from the mean of its neighbours, relative to their distances.
 */
static double of_nodes(const quad_build *build, int element)
{
    double largest = 0;
    for (int corner = 0; corner < 4; corner++)
        largest = fmax(largest, build->irregularity[build->quads->element[element][corner]]);
    return largest;
}

/* Return the number of an element for messages: its number in the mesh file, or else its index. */
static int label_of(const quad_mesh *quads, int element)
{
    const int64_t label = quads->element_label ? quads->element_label[element] : element;
    return label >= 0 && label < INT32_MAX ? (int)label : element;
}

static int build_all(quad_build *build, bool accept_irregular, char *error)
{
    const double thickness = build->list->laminate->thickness;
    quad_report *report = build->report;
    int named[NAMED];
    double lock = 0;
    for (int element = 0; element < (int)build->quads->elements; element++) {
        quad_geometry geometry;
        const int status = quad_geometry_fill(build->quads, (size_t)element, &geometry);
        if (check_shape(build->list->scene, label_of(build->quads, element), status, &geometry,
                        error) < 0)
            return -1;
        const quad_rule rule = quad_rule_of(&geometry, thickness, of_nodes(build, element));
        if (rule.lock > QUAD_LOCK && report->locking < NAMED)
            named[report->locking] = label_of(build->quads, element);
        lock = fmax(lock, rule.lock);
        add_to_report(report, &rule, &geometry, thickness);
        if (add_quad(build, element, &geometry, &rule, error) < 0)
            return -1;
    }
    if (report->locking > 0 && !accept_irregular)
        return refuse_locking(build, named, lock, error);
    return 0;
}

int quad_types_build(type_list *list, const quad_mesh *quads, const surface_point *point,
                     bool accept_irregular, uint16_t *element_type, quad_report *report,
                     char *error)
{
    quad_side *side = calloc(4 * quads->elements, sizeof *side);
    double *irregularity = calloc(quads->nodes, sizeof *irregularity);
    quad_build build = {list, quads, point, irregularity, element_type, report};
    int status = -1;
    memset(report, 0, sizeof *report);
    report->jacobian = 1;
    if (side && irregularity) {
        quad_sides(quads, side);
        status = quad_irregularity(quads, side, irregularity);
    }
    if (status < 0)
        scene_fault(list->scene->at_surface, error,
                    "%zu elements do not fit into memory; use fewer", quads->elements);
    else
        status = build_all(&build, accept_irregular, error);
    free(side);
    free(irregularity);
    return status;
}
