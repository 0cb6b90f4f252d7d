/* SPDX-License-Identifier: BSD-2-Clause */
/* Nodes, elements, element types, supports and dof numbers of the mesh of a scene (mesh.h). */
#include "mesh.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/shell.h"
#include "corner_tables.h"
#include "element_types.h"
#include "quads_of_lines.h"
#include "smeared_plies.h"
#include "../scene/surface_formula.h"
#include "../quads/vector.h"
#include "warp.h"

static const double full_turn = 6.283185307179586;

/* ---- nodes and elements ----------------------------------------------- */

static int is_closed(const scene *scene, int direction)
{
    const scene_line *line = &scene->line[direction];
    const double range = line->point[line->elements] - line->point[0];
    return surface_closes(&scene->surface, direction + 1) && !line->slit &&
           fabs(range - full_turn) < 1e-6;
}

int mesh_node(const mesh *mesh, int i, int j)
{
    return i % mesh->lines[0] * mesh->lines[1] + j % mesh->lines[1];
}

void mesh_extent(const mesh *mesh, double extent[3])
{
    for (int i = 0; i < 3; i++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int node = 0; node < mesh->nodes; node++) {
            low = fmin(low, mesh->point[node].position[i]);
            high = fmax(high, mesh->point[node].position[i]);
        }
        extent[i] = high - low;
    }
}

expr_point mesh_place(const mesh *mesh, int node)
{
    const double *position = mesh->point[node].position, *theta = mesh->theta[node];
    const expr_point place = {position[0], position[1], position[2], theta[0], theta[1]};
    return place;
}

/*
 * Return the text by which messages name a node or an element of a mesh from a file: its position,
 * and its number in the mesh file.
 *   what  in  the word "node" or "element"
 *   label in  number in the mesh file; 0: the mesh was made without a file
 */
static mesh_text place_text(const double position[3], const char *what, long long label)
{
    mesh_text place;
    const int length = snprintf(place.text, sizeof place.text, "x = %g, y = %g, z = %g",
                                position[0], position[1], position[2]);
    if (label != 0)
        snprintf(place.text + length, sizeof place.text - (size_t)length, " (%s %lld)", what,
                 label);
    return place;
}

mesh_text mesh_node_text(const mesh *mesh, int node)
{
    mesh_text place;
    if (mesh->quads)
        return place_text(mesh->point[node].position, "node",
                          mesh->quads->node_label ? mesh->quads->node_label[node] : 0);
    snprintf(place.text, sizeof place.text, "theta1 = %g, theta2 = %g", mesh->theta[node][0],
             mesh->theta[node][1]);
    return place;
}

mesh_text mesh_element_text(const mesh *mesh, int element)
{
    double position[3] = {0, 0, 0}, theta[2][2];
    mesh_text place;
    if (mesh->quads) {
        for (int i = 0; i < 12; i++)
            position[i % 3] += mesh->point[mesh->element[element][i / 3]].position[i % 3] / 4;
        return place_text(position, "element",
                          mesh->quads->element_label ? mesh->quads->element_label[element] : 0);
    }
    mesh_cell(mesh, element, theta[0], theta[1]);
    snprintf(place.text, sizeof place.text, "theta1 = %.4g to %.4g, theta2 = %.4g to %.4g",
             theta[0][0], theta[0][1], theta[1][0], theta[1][1]);
    return place;
}

static void cell_lines(const mesh *mesh, int element, int *i, int *j)
{
    *i = element / mesh->scene->line[1].elements;
    *j = element % mesh->scene->line[1].elements;
}

/*
 * Find the smallest range of a surface coordinate (direction 0: theta1, 1: theta2) that contains
 * the nodes of an element.
 */
static void node_range(const mesh *mesh, int element, int direction, double range[2])
{
    range[0] = HUGE_VAL;
    range[1] = -HUGE_VAL;
    for (int corner = 0; corner < 4; corner++) {
        const double theta = mesh->theta[mesh->element[element][corner]][direction];
        range[0] = fmin(range[0], theta);
        range[1] = fmax(range[1], theta);
    }
}

void mesh_cell(const mesh *mesh, int element, double theta1[2], double theta2[2])
{
    int i, j;
    if (mesh->quads) {
        node_range(mesh, element, 0, theta1);
        node_range(mesh, element, 1, theta2);
        return;
    }
    cell_lines(mesh, element, &i, &j);
    for (int k = 0; k < 2; k++) {
        theta1[k] = mesh->scene->line[0].point[i + k];
        theta2[k] = mesh->scene->line[1].point[j + k];
    }
}

/* Copy the nodes and elements of a mesh of quadrilaterals in any arrangement. */
static void place_quads(mesh *mesh)
{
    const quad_mesh *quads = mesh->quads;
    for (int node = 0; node < mesh->nodes; node++) {
        surface_point *point = &mesh->point[node];
        memset(point, 0, sizeof *point);
        memcpy(point->position, quads->position[node], sizeof point->position);
        memcpy(point->triad[0], quads->axis[node], sizeof point->triad[0]);
        memcpy(point->triad[2], quads->director[node], sizeof point->triad[2]);
        vector_cross(point->triad[2], point->triad[0], point->triad[1]);
        point->lame[0] = point->lame[1] = 1;
        memcpy(mesh->theta[node], point->position, sizeof mesh->theta[node]);
    }
    for (int element = 0; element < mesh->elements; element++)
        for (int corner = 0; corner < 4; corner++)
            mesh->element[element][corner] = (uint16_t)quads->element[element][corner];
}

/*
 * Return whether mesh line i of the surface coordinate theta1 (all points of one value of theta1)
 * is an edge of the mesh.
 */
static int is_edge_of_theta1(const mesh *mesh, int i)
{
    return !is_closed(mesh->scene, 0) && (i == 0 || i == mesh->lines[0] - 1);
}

static void place_nodes(mesh *mesh)
{
    const int is_general = surface_is_general(&mesh->scene->surface);
    for (int i = 0; i < mesh->lines[0]; i++)
        for (int j = 0; j < mesh->lines[1]; j++) {
            const int node = mesh_node(mesh, i, j);
            mesh->theta[node][0] = mesh->scene->line[0].point[i];
            mesh->theta[node][1] = mesh->scene->line[1].point[j];
            mesh->point[node] =
                surface_at(&mesh->scene->surface, mesh->theta[node][0], mesh->theta[node][1]);
            if (is_general && is_edge_of_theta1(mesh, i))
                surface_formula_turn(&mesh->scene->surface, mesh->theta[node], &mesh->point[node]);
        }
    for (int element = 0; element < mesh->elements; element++) {
        int i, j;
        cell_lines(mesh, element, &i, &j);
        mesh->element[element][0] = (uint16_t)mesh_node(mesh, i, j);
        mesh->element[element][1] = (uint16_t)mesh_node(mesh, i + 1, j);
        mesh->element[element][2] = (uint16_t)mesh_node(mesh, i + 1, j + 1);
        mesh->element[element][3] = (uint16_t)mesh_node(mesh, i, j + 1);
    }
}

static int in_span(const double span[2], double theta)
{
    return theta >= span[0] && theta <= span[1];
}

/*
 * Return whether mesh line i of a direction lies within the limits of a rectangular region. The
 * first line of a closed direction is also its last line.
 */
static int line_in_region(const mesh *mesh, const scene_where *where, int direction, int i)
{
    const scene_line *line = &mesh->scene->line[direction];
    const double *span = where->span[direction];
    const int is_seam = i == 0 && mesh->lines[direction] == line->elements;
    return in_span(span, line->point[i]) || (is_seam && in_span(span, line->point[line->elements]));
}

static int in_region(const mesh *mesh, const scene_where *where, int i, int j)
{
    return line_in_region(mesh, where, 0, i) && line_in_region(mesh, where, 1, j);
}

/*
 * List the nodes of a place (`where`) of a scene whose mesh is read from a file. The place is a
 * point, which is one node, or a named set of nodes of the mesh file.
 *   node [nodes] out  indices of these nodes, ascending
 * Returns their number.
 */
static int select_marked(const mesh *mesh, const scene_where *where, int *node)
{
    unsigned char *in_set = calloc((size_t)mesh->nodes, 1);
    int count = 0;
    if (in_set)
        scene_mark_nodes(mesh->scene, where, in_set);
    for (int candidate = 0; in_set && candidate < mesh->nodes; candidate++)
        if (in_set[candidate])
            node[count++] = candidate;
    free(in_set);
    return count;
}

int mesh_select(const mesh *mesh, const scene_where *where, int *node)
{
    int count = 0;
    if (mesh->scene->quads)
        return select_marked(mesh, where, node);
    for (int i = 0; i < mesh->lines[0]; i++)
        for (int j = 0; j < mesh->lines[1]; j++) {
            const int chosen =
                where->type == WHERE_NODES ||
                (where->type == WHERE_REGION && in_region(mesh, where, i, j)) ||
                (where->type == WHERE_POINT &&
                 mesh_node(mesh, where->node[0], where->node[1]) == mesh_node(mesh, i, j)) ||
                (where->type == WHERE_EDGE && where->edge == EDGE_THETA1_MINUS && i == 0) ||
                (where->type == WHERE_EDGE && where->edge == EDGE_THETA1_PLUS &&
                 i == mesh->scene->line[0].elements % mesh->lines[0]) ||
                (where->type == WHERE_EDGE && where->edge == EDGE_THETA2_MINUS && j == 0) ||
                (where->type == WHERE_EDGE && where->edge == EDGE_THETA2_PLUS &&
                 j == mesh->scene->line[1].elements % mesh->lines[1]);
            if (chosen)
                node[count++] = mesh_node(mesh, i, j);
        }
    return count;
}

int mesh_point_node(const mesh *mesh, const scene_where *where)
{
    int first = 0;
    if (where->type == WHERE_PLACE)
        return where->node[0];
    if (where->type != WHERE_SET)
        return mesh_node(mesh, where->node[0], where->node[1]);
    unsigned char *in_set = calloc((size_t)mesh->nodes, 1);
    if (in_set)
        scene_mark_nodes(mesh->scene, where, in_set);
    while (in_set && first < mesh->nodes - 1 && !in_set[first])
        first++;
    free(in_set);
    return first;
}

/* ---- element types --------------------------------------------------- */

static void corner_tables(const mesh *mesh, int element, pzs_element_type *type)
{
    corner_data data = {.is_cartesian = mesh->scene->element.cartesian != 0,
                        .middle = (mesh->laminate.z[0] + mesh->laminate.z[1]) / 2};
    double range[2][2];
    mesh_cell(mesh, element, range[0], range[1]);
    for (int direction = 0; direction < 2; direction++)
        data.range[direction] = range[direction][1] - range[direction][0];
    for (int corner = 0; corner < 4; corner++)
        data.point[corner] = &mesh->point[mesh->element[element][corner]];
    corner_tables_fill(&data, type);
}

/*
 * Compute the distances between the midpoints of opposite sides of an element, along its directions
 * 1 and 2 (m).
 */
static void centre_chords(const mesh *mesh, const uint16_t node[4], double chord[2])
{
    static const int high[2][2] = {{1, 2}, {2, 3}}, low[2][2] = {{0, 3}, {0, 1}};
    for (int direction = 0; direction < 2; direction++) {
        double middle[2][3];
        for (int i = 0; i < 3; i++) {
            middle[0][i] = (mesh->point[node[low[direction][0]]].position[i] +
                            mesh->point[node[low[direction][1]]].position[i]) /
                           2;
            middle[1][i] = (mesh->point[node[high[direction][0]]].position[i] +
                            mesh->point[node[high[direction][1]]].position[i]) /
                           2;
        }
        chord[direction] = vector_distance(middle[0], middle[1]);
    }
}

/* Return the plies that are present at the centre of an element: bit i is set for ply i. */
static uint32_t present_plies(const mesh *mesh, const double middle[2])
{
    const scene *scene = mesh->scene;
    uint32_t present = 0;
    for (int i = 0; i < scene->layers; i++)
        if (!scene->layer[i].patched)
            present |= 1u << i;
    for (int grid = 0; grid < scene->patch_grids; grid++) {
        const scene_patches *patches = &scene->patches[grid];
        if (middle[0] > patches->theta1[0] && middle[0] < patches->theta1[1] &&
            middle[1] > patches->theta2[0] && middle[1] < patches->theta2[1])
            present |= 1u << patches->layer;
    }
    return present;
}

/*
 * Return the plies that are present in an element between mesh lines, and the geometry on which its
 * stiffness depends: curvatures and lengths, from the surface at the centre of the element.
 */
static laminate_place element_place(const mesh *mesh, int element)
{
    const scene *scene = mesh->scene;
    double range[2][2], middle[2];
    laminate_place place;
    memset(&place, 0, sizeof place);
    mesh_cell(mesh, element, range[0], range[1]);
    for (int direction = 0; direction < 2; direction++)
        middle[direction] = (range[direction][0] + range[direction][1]) / 2;
    const surface_point centre = surface_at(&scene->surface, middle[0], middle[1]);
    for (int direction = 0; direction < 2; direction++)
        place.curvature[direction] = centre.curvature[direction];
    centre_chords(mesh, mesh->element[element], place.chord);
    place.bubble_share = 1;
    place.area = scene->element.exact_area
                     ? surface_area(&scene->surface, range[0], range[1])
                     : centre.lame[0] * centre.lame[1] * (range[0][1] - range[0][0]) *
                           (range[1][1] - range[1][0]);
    place.present_plies = present_plies(mesh, middle);
    smeared_plies_set(&place, scene, element);
    return place;
}

/*
 * Return the factor of the warping correction of an element (argument `share` of warp_fill):
 *   tau (L1^2 k1 + L2^2 k2)/(12 h).
 *   tau     element option of this name
 *   L1, L2  lengths of the element along its directions (m)
 *   k1, k2  principal curvatures of the element (1/m)
 *   h       thickness of the laminate (m)
 */
static double warp_share(const mesh *mesh, const laminate_place *place)
{
    double sum = 0;
    for (int direction = 0; direction < 2; direction++)
        sum += place->chord[direction] * place->chord[direction] * place->curvature[direction];
    return mesh->scene->element.tau * sum / (12 * mesh->laminate.thickness);
}

static int build_types(mesh *mesh, type_list *list, char *error)
{
    for (int element = 0; element < mesh->elements; element++) {
        pzs_element_type type;
        memset(&type, 0, sizeof type);
        corner_tables(mesh, element, &type);
        const laminate_place place = element_place(mesh, element);
        type.thickness = mesh->laminate.thickness;
        type.skew[2] = place.chord[1] / place.chord[0];
        const int k = type_list_add(list, &type, &place, warp_share(mesh, &place), error);
        if (k < 0)
            return -1;
        mesh->element_type[element] = (uint16_t)k;
    }
    return 0;
}

/*
 * Set the curvatures of the nodes of a mesh from a file to the means of the curvatures of their
 * elements.
 */
static void set_node_curvatures(mesh *mesh)
{
    int *elements_at = calloc((size_t)mesh->nodes, sizeof *elements_at);
    for (int element = 0; element < mesh->elements && elements_at; element++)
        for (int corner = 0; corner < 4; corner++) {
            const int node = mesh->element[element][corner];
            const double *k = mesh->place[mesh->element_type[element]].curvature;
            elements_at[node]++;
            for (int direction = 0; direction < 2; direction++)
                mesh->point[node].curvature[direction] +=
                    (k[direction] - mesh->point[node].curvature[direction]) / elements_at[node];
        }
    free(elements_at);
}

/*
 * Compute the exact area of every element between mesh lines, and the plies that are present in it.
 */
static void measure_elements(const mesh *mesh, double *area, uint32_t *present)
{
    for (int element = 0; element < mesh->elements; element++) {
        double range[2][2], middle[2];
        mesh_cell(mesh, element, range[0], range[1]);
        for (int direction = 0; direction < 2; direction++)
            middle[direction] = (range[direction][0] + range[direction][1]) / 2;
        area[element] = surface_area(&mesh->scene->surface, range[0], range[1]);
        present[element] = present_plies(mesh, middle);
    }
}

static int build_quad_types(mesh *mesh, const quad_mesh *quads, type_list *list, char *error)
{
    return quad_types_build(list, quads, mesh->point, mesh->accept_irregular, mesh->element_type,
                            &mesh->quad_report, error);
}

/*
 * Build the element types of a surface whose coordinate lines are no lines of curvature. Returns 0,
 * or -1 with error filled.
 */
static int build_general_types(mesh *mesh, type_list *list, char *error)
{
    const size_t elements = (size_t)mesh->elements;
    double *area = calloc(elements, sizeof *area);
    uint32_t *present = calloc(elements, sizeof *present);
    const line_mesh lines = {mesh->point, (size_t)mesh->nodes, elements, mesh->element, area,
                             present};
    quad_mesh quads;
    int status = -1;
    scene_fault(mesh->scene->line[0].at, error, "%d elements do not fit into memory; use fewer",
                mesh->elements);
    if (area && present) {
        measure_elements(mesh, area, present);
        status = quads_of_lines(&lines, &quads);
        if (status == 0) {
            status = build_quad_types(mesh, &quads, list, error);
            quad_mesh_free(&quads);
        }
    }
    free(area);
    free(present);
    return status;
}

static int build_all_types(mesh *mesh, char *error)
{
    type_list list = {mesh->scene, &mesh->laminate, mesh->type, mesh->place, 0};
    int status;
    if (mesh->quads)
        status = build_quad_types(mesh, mesh->quads, &list, error);
    else if (surface_is_general(&mesh->scene->surface))
        status = build_general_types(mesh, &list, error);
    else
        status = build_types(mesh, &list, error);
    mesh->types = list.count;
    if (status == 0 && mesh->quads)
        set_node_curvatures(mesh);
    return status;
}

/* ---- supports of skewed corners --------------------------------------- */

/*
 * Refuse a support that acts only along or only across an edge of constant theta2 with a corner
 * that is not a right angle. Reason: the triad (local axes) of the corner node follows the other
 * edge, so that the support would act in wrong directions.
 */
static int check_corners(const scene *scene, char *error)
{
    const double right_angle = 1e-6;
    for (int k = 0; k < scene->supports; k++) {
        const scene_where *where = &scene->support[k].where;
        const int is_edge = where->type == WHERE_EDGE &&
                            (where->edge == EDGE_THETA2_MINUS || where->edge == EDGE_THETA2_PLUS);
        const int line = where->edge == EDGE_THETA2_PLUS ? scene->line[1].elements : 0;
        for (int end = 0; end < 2 && is_edge && mesh_depends_on_axes(&scene->support[k]); end++) {
            const double theta1 = scene->line[0].point[end ? scene->line[0].elements : 0];
            const double theta2 = scene->line[1].point[line];
            const double cosine = surface_formula_cosine(&scene->surface, theta1, theta2);
            if (fabs(cosine) > right_angle)
                return scene_fault(scene->support[k].at, error,
                                   "this support acts along or across its edge, which meets the "
                                   "next edge at %.4g degrees at theta1 = %g, theta2 = %g; clamp "
                                   "the edge, hold u3 alone, or let the edges meet at 90 degrees",
                                   acos(cosine) * 57.29577951308232, theta1, theta2);
        }
    }
    return 0;
}

/* ---- numbering -------------------------------------------------------- */

/*
 * Return the number of the mesh line at a position in the order 0, n-1, 1, n-2, ... of the n lines
 * along a closed direction of the surface (as around a cylinder); in this order neighbouring lines
 * are at most two positions apart.
 */
static int folded(int position, int lines)
{
    return position % 2 ? lines - 1 - position / 2 : position / 2;
}

/*
 * Compute the value that a support prescribes at a node: a displacement, or an angle (rad). Returns
 * 0, or -1 with error filled.
 */
static int value_at(const mesh *mesh, const scene_support *support, int node, double *value,
                    char *error)
{
    const double quarter_turn = full_turn / 4;
    const expr_point at = mesh_place(mesh, node);
    *value = support->value ? expr_value(support->value, &at) : 0;
    if (!isfinite(*value))
        return scene_fault(
            support->at, error,
            "the value of the support is not a finite number at %s; correct its formula",
            mesh_node_text(mesh, node).text);
    if (support->turn == 0 || fabs(*value) < quarter_turn)
        return 0;
    return scene_fault(support->at, error,
                       "a rotation of %g rad at %s; a support turns by less than 90 degrees",
                       *value, mesh_node_text(mesh, node).text);
}

/*
 * Return the displacement that a support with a value prescribes for dof i of a node. A rotation by
 * an angle moves the director, a unit vector, by the sine of the angle along the surface, and by
 * its cosine less 1 along the normal.
 */
static double value_of_dof(const scene_support *support, unsigned i, double value)
{
    const unsigned along_normal = 5;
    if (!(support->move >> i & 1u))
        return 0;
    if (support->turn == 0)
        return value;
    return i == along_normal ? cos(value) - 1 : support->turn * sin(value);
}

/*
 * Apply a support to the dof of one node.
 *   values  [nodes][dof_per_node] in/out  prescribed displacement of each dof, NAN where none is
 *                                         prescribed
 * Returns 0, or -1 with error filled if another support prescribes another value.
 */
static int apply_support(mesh *mesh, const scene_support *support, int node, double *values,
                         char *error)
{
    double value;
    if (value_at(mesh, support, node, &value, error) < 0)
        return -1;
    for (unsigned i = 0; i < mesh->dof_per_node; i++) {
        const size_t dof = (size_t)node * mesh->dof_per_node + i;
        const int moved = (support->move >> i & 1u) != 0,
                  fixed = mesh->node_dof[dof] == PZS_CONSTRAINED;
        const double before = fixed ? 0 : values[dof];
        const double wanted = value_of_dof(support, i, value);
        if (!(support->fix >> i & 1u))
            continue;
        if (!isnan(before) && fabs(before - wanted) > 1e-12 * fmax(fabs(before), fabs(wanted)))
            return scene_fault(support->at, error,
                               "at %s another support prescribes %g and this one %g; remove one",
                               mesh_node_text(mesh, node).text, before, wanted);
        if (!fixed && isnan(values[dof]))
            mesh->holder[dof] = (int)(support - mesh->scene->support);
        if (moved && !fixed)
            values[dof] = wanted;
        else
            mesh->node_dof[dof] = PZS_CONSTRAINED;
    }
    return 0;
}

/*
 * Apply all supports: degrees of freedom that they keep at 0 are marked as constrained.
 *   values  [nodes][dof_per_node] out  prescribed displacement of each dof, NAN where none is
 *                                      prescribed
 * Returns 0, or -1 with error filled.
 */
static int apply_supports(mesh *mesh, int *node, double *values, char *error)
{
    for (size_t i = 0; i < (size_t)mesh->nodes * mesh->dof_per_node; i++)
        values[i] = (double)NAN;
    for (int k = 0; k < mesh->scene->supports; k++) {
        const scene_support *support = &mesh->scene->support[k];
        if (mesh->scene->quads && !support->value)
            continue; /* Supports without a prescribed value are skipped on a mesh from a file:
                         constrain_quads has marked the dof that they constrain in mesh.node_dof. */
        const int count = mesh_select(mesh, &support->where, node);
        for (int member = 0; member < count; member++)
            if (apply_support(mesh, support, node[member], values, error) < 0)
                return -1;
    }
    return 0;
}

/*
 * List the dof with prescribed displacements in the order of their numbers. Returns 0, or -1 when
 * memory runs out.
 */
static int list_prescribed(mesh *mesh, const double *values)
{
    const size_t all = (size_t)mesh->nodes * mesh->dof_per_node;
    double *of_dof = malloc((size_t)mesh->free_dof * sizeof *of_dof);
    mesh->prescribed_dof = calloc((size_t)mesh->free_dof, sizeof *mesh->prescribed_dof);
    mesh->prescribed_value = calloc((size_t)mesh->free_dof, sizeof *mesh->prescribed_value);
    if (of_dof && mesh->prescribed_dof && mesh->prescribed_value) {
        for (size_t dof = 0; dof < all; dof++)
            if (mesh->node_dof[dof] != PZS_CONSTRAINED)
                of_dof[mesh->node_dof[dof]] = values[dof];
        for (int i = 0; i < mesh->free_dof; i++)
            if (!isnan(of_dof[i])) {
                mesh->prescribed_dof[mesh->prescribed_count] = (uint16_t)i;
                mesh->prescribed_value[mesh->prescribed_count++] = of_dof[i];
            }
    }
    free(of_dof);
    return of_dof && mesh->prescribed_dof && mesh->prescribed_value ? 0 : -1;
}

/*
 * Give each free dof of a node the next free number; the caller visits the nodes in the order in
 * which their dof are to be numbered.
 */
static void number_node(mesh *mesh, int node)
{
    uint16_t *dof = mesh->node_dof + (size_t)node * mesh->dof_per_node;
    for (unsigned i = 0; i < mesh->dof_per_node; i++)
        if (dof[i] != PZS_CONSTRAINED)
            dof[i] = (uint16_t)(mesh->free_dof++ & 0xFFFF);
}

static void number_quads(mesh *mesh)
{
    for (int node = 0; node < mesh->nodes; node++)
        number_node(mesh, mesh->quads->order ? (int)mesh->quads->order[node] : node);
}

/* Mark the degrees of freedom that the data of a mesh from a file constrain to 0. */
static void constrain_quads(mesh *mesh)
{
    for (int node = 0; node < mesh->nodes && mesh->quads->constrained; node++)
        for (unsigned i = 0; i < mesh->dof_per_node; i++)
            if ((unsigned)mesh->quads->constrained[node] >> i & 1u) {
                const size_t dof = (size_t)node * mesh->dof_per_node + i;
                mesh->node_dof[dof] = PZS_CONSTRAINED;
                mesh->holder[dof] = mesh->quads->holder ? mesh->quads->holder[node][i] : -1;
            }
}

static void number_lines(mesh *mesh)
{
    const int closed[2] = {is_closed(mesh->scene, 0), is_closed(mesh->scene, 1)};
    const int width_2_fast = mesh->lines[1] * (1 + closed[0]),
              width_1_fast = mesh->lines[0] * (1 + closed[1]);
    const int fast = width_2_fast <= width_1_fast ? 1 : 0, slow = 1 - fast;
    for (int outer = 0; outer < mesh->lines[slow]; outer++)
        for (int inner = 0; inner < mesh->lines[fast]; inner++) {
            const int line = closed[slow] ? folded(outer, mesh->lines[slow]) : outer;
            number_node(mesh,
                        fast == 1 ? mesh_node(mesh, line, inner) : mesh_node(mesh, inner, line));
        }
}

static void number_dof(mesh *mesh)
{
    mesh->free_dof = 0;
    (mesh->quads ? number_quads : number_lines)(mesh);
}

static void find_envelope(mesh *mesh)
{
    for (int i = 0; i < mesh->free_dof; i++)
        mesh->first_column[i] = (uint16_t)i;
    for (int element = 0; element < mesh->elements; element++) {
        uint16_t least = PZS_CONSTRAINED;
        for (int pass = 0; pass < 2; pass++)
            for (int corner = 0; corner < 4; corner++)
                for (unsigned i = 0; i < mesh->dof_per_node; i++) {
                    const uint16_t dof =
                        mesh->node_dof[mesh->element[element][corner] * mesh->dof_per_node + i];
                    if (dof == PZS_CONSTRAINED)
                        continue;
                    if (pass == 0 && dof < least)
                        least = dof;
                    if (pass == 1 && least < mesh->first_column[dof])
                        mesh->first_column[dof] = least;
                }
    }
}

double mesh_envelope(const mesh *mesh)
{
    double sum = 0;
    for (int i = 0; i < mesh->free_dof; i++)
        sum += i - mesh->first_column[i] + 1;
    return sum;
}

int mesh_half_bandwidth(const mesh *mesh)
{
    int widest = 0;
    for (int i = 0; i < mesh->free_dof; i++)
        if (i - mesh->first_column[i] > widest)
            widest = i - mesh->first_column[i];
    return widest;
}

/* ---- build ------------------------------------------------------------ */

static int allocate(mesh *mesh)
{
    const size_t nodes = (size_t)mesh->nodes, elements = (size_t)mesh->elements;
    mesh->point = calloc(nodes, sizeof *mesh->point);
    mesh->theta = calloc(nodes, sizeof *mesh->theta);
    mesh->element = calloc(elements, sizeof *mesh->element);
    mesh->element_type = calloc(elements, sizeof *mesh->element_type);
    mesh->type = calloc(elements, sizeof *mesh->type);
    mesh->place = calloc(elements, sizeof *mesh->place);
    mesh->node_dof = calloc(nodes * mesh->dof_per_node, sizeof *mesh->node_dof);
    mesh->first_column = calloc(nodes * mesh->dof_per_node, sizeof *mesh->first_column);
    mesh->holder = malloc(nodes * mesh->dof_per_node * sizeof *mesh->holder);
    for (size_t i = 0; mesh->holder && i < nodes * mesh->dof_per_node; i++)
        mesh->holder[i] = -1;
    return mesh->point && mesh->theta && mesh->element && mesh->element_type && mesh->type &&
           mesh->place && mesh->node_dof && mesh->first_column && mesh->holder;
}

static int build_stiffness(mesh *mesh)
{
    const size_t packed = SHELL_PACKED(4 * (size_t)mesh->dof_per_node);
    mesh->stiffness = malloc((size_t)mesh->types * packed * sizeof *mesh->stiffness);
    if (!mesh->stiffness)
        return -1;
    for (int k = 0; k < mesh->types; k++)
        pzs_shell_stiffness(&mesh->type[k], mesh->dof_per_node,
                            mesh->stiffness + (size_t)k * packed);
    return 0;
}

static int build_numbers(mesh *mesh, char *error)
{
    const scene *scene = mesh->scene;
    int *node = calloc((size_t)mesh->nodes, sizeof *node), status = -1;
    double *values = calloc((size_t)mesh->nodes * mesh->dof_per_node, sizeof *values);
    if (mesh->quads)
        constrain_quads(mesh);
    if (!node || !values)
        scene_fault(scene->line[0].at, error, "%d nodes do not fit into memory; use fewer elements",
                    mesh->nodes);
    else if (apply_supports(mesh, node, values, error) == 0 &&
             mesh_hold_oblique(mesh, values, node, error) == 0) {
        number_dof(mesh);
        if (mesh->free_dof == 0)
            scene_fault(scene->at_surface, error,
                        "0 free dof: the supports constrain every node; remove a support");
        else if (mesh->free_dof >= (int)PZS_CONSTRAINED)
            scene_fault(scene->line[0].at, error,
                        "%d free dof; the tables hold at most %u; use fewer elements%s",
                        mesh->free_dof, PZS_CONSTRAINED - 1u,
                        mesh->dof_per_node > 6 ? ", or dof_per_node: 6" : "");
        else if ((status = list_prescribed(mesh, values)) < 0)
            scene_fault(scene->line[0].at, error,
                        "%d dof do not fit into memory; use fewer elements", mesh->free_dof);
    }
    free(node);
    free(values);
    return status;
}

/* Refuse a closed direction of the mesh with fewer than three elements around it. */
static int check_lines(const scene *scene, char *error)
{
    for (int direction = 0; direction < 2; direction++)
        if (is_closed(scene, direction) && scene->line[direction].elements < 3)
            return scene_fault(
                scene->line[direction].at, error,
                "%d elements around a closed direction are too few; use at least 3, better 12",
                scene->line[direction].elements);
    return 0;
}

static int fill(mesh *mesh, char *error)
{
    const scene *scene = mesh->scene;
    if (laminate_build(scene, &mesh->laminate, error) < 0)
        return -1;
    if (!allocate(mesh))
        return scene_fault(scene->line[0].at, error,
                           "%d nodes do not fit into memory; use fewer elements", mesh->nodes);
    (mesh->quads ? place_quads : place_nodes)(mesh);
    if (!mesh->quads && mesh_turn_axes(mesh, error) < 0)
        return -1;
    if (build_numbers(mesh, error) < 0)
        return -1;
    find_envelope(mesh);
    if (build_all_types(mesh, error) < 0)
        return -1;
    if (build_stiffness(mesh) < 0)
        return scene_fault(scene->line[0].at, error,
                           "%d element matrices do not fit into memory; use fewer elements",
                           mesh->types);
    if (mesh_springs_build(mesh, error) < 0)
        return -1;
    return mesh_masses_build(mesh, error);
}

void mesh_begin(mesh *mesh, const scene *scene)
{
    memset(mesh, 0, sizeof *mesh);
    mesh->scene = scene;
    mesh->formulation = scene->element;
    mesh->is_from_file = scene->quads != NULL;
    mesh->fitted = scene->surface.type == SURFACE_POINTS ? &scene->surface.points : NULL;
    mesh->is_polar = scene->surface.type == SURFACE_POLAR;
    for (int direction = 0; direction < 2; direction++) {
        mesh->line[direction] = scene->line[direction];
        mesh->is_angle[direction] = surface_is_angle(&scene->surface, direction + 1);
    }
    mesh->dof_per_node = (unsigned)scene->element.dof_per_node;
}

int mesh_build(mesh *mesh, const scene *scene, char *error)
{
    if (scene->quads)
        return mesh_build_quads(mesh, scene, &scene->quads->mesh,
                                scene->quads->accept_irregular != 0, error);
    mesh_begin(mesh, scene);
    if (check_lines(scene, error) < 0 ||
        (surface_is_general(&scene->surface) && check_corners(scene, error) < 0))
        return -1;
    for (int direction = 0; direction < 2; direction++)
        mesh->lines[direction] =
            scene->line[direction].elements + (is_closed(scene, direction) ? 0 : 1);
    mesh->nodes = mesh->lines[0] * mesh->lines[1];
    mesh->elements = scene->line[0].elements * scene->line[1].elements;
    if (fill(mesh, error) == 0)
        return 0;
    mesh_free(mesh);
    return -1;
}

/*
 * Refuse a mesh of quadrilaterals on three grounds: it has more nodes or elements than the tables
 * of the library can number; the element formulation needs lines of curvature; or the sides of its
 * elements do not fit together (quad_check_edges).
 */
static int check_quads(const scene *scene, const quad_mesh *quads, char *error)
{
    if (quads->nodes >= PZS_CONSTRAINED || quads->elements >= PZS_CONSTRAINED)
        return scene_fault(scene->line[0].at, error,
                           "%zu nodes and %zu elements; the tables hold at most %u of each",
                           quads->nodes, quads->elements, PZS_CONSTRAINED - 1u);
    if (!scene->element.cartesian)
        return scene_fault(scene->at_surface, error,
                           "the published element needs a mesh along lines of curvature; use "
                           "`element: improved` for a general mesh");
    return quad_check_edges(scene, quads, error);
}

int mesh_build_quads(mesh *mesh, const scene *scene, const quad_mesh *quads, bool accept_irregular,
                     char *error)
{
    mesh_begin(mesh, scene);
    if (check_quads(scene, quads, error) < 0)
        return -1;
    mesh->quads = quads;
    mesh->accept_irregular = accept_irregular;
    mesh->nodes = mesh->lines[0] = (int)quads->nodes;
    mesh->lines[1] = 1;
    mesh->elements = (int)quads->elements;
    if (fill(mesh, error) == 0)
        return 0;
    mesh_free(mesh);
    return -1;
}

void mesh_free(mesh *mesh)
{
    free(mesh->point);
    free(mesh->theta);
    free(mesh->element);
    free(mesh->element_type);
    free(mesh->type);
    free(mesh->place);
    free(mesh->stiffness);
    free(mesh->node_dof);
    free(mesh->holder);
    free(mesh->node_turn);
    free(mesh->turn);
    free(mesh->first_column);
    free(mesh->prescribed_dof);
    free(mesh->prescribed_value);
    mesh_springs_free(&mesh->springs);
    free(mesh->mass);
    memset(mesh, 0, sizeof *mesh);
}
