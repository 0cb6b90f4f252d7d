/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Springs and stack actuators of a scene: for each one, the factors by which the free dof of the
 * mesh give its elongation (springs.h).
 */
#include "springs.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/shell.h"
#include "../quads/vector.h"
#include "corner_weight.h"
#include "mesh_spot.h"

/*
 * Largest number of dof that enter the elongation of one spring: two ends of four nodes each. Each
 * node has the mean and the difference of both faces' displacements in three components.
 */
enum { MOST_ENTRIES = 2 * 4 * 6 };

/*
 * Elongation of one spring as a function of the free dof: their numbers, and the elongation per
 * unit of each.
 */
typedef struct spring_row {
    int entries;
    uint16_t dof[MOST_ENTRIES];
    double value[MOST_ENTRIES];
} spring_row;

/* The springs of a mesh while they are built, and two work arrays, `node` and `weight` [nodes]. */
typedef struct spring_builder {
    mesh *mesh;
    mesh_springs *springs;
    const scene_spring *item;
    char *error;
    int *node;
    double *weight;
    size_t room_rows, room_entries;
    double largest[2]; /* largest diagonal entries of the stiffness matrices of the elements: for
                          the mean displacement of both faces of the shell (N/m), and for the
                          difference of their displacements divided by the thickness (N m) */
} spring_builder;

static int fault_of_memory(const spring_builder *builder)
{
    return scene_fault(builder->item->at, builder->error,
                       "the springs do not fit into memory; use fewer");
}

/* ---- one row ------------------------------------------------------------ */

/*
 * Add a value to the factor by which one dof of a node enters the elongation of a spring (row); a
 * constrained dof has no factor.
 */
static void add_entry(const mesh *mesh, int node, int i, double value, spring_row *row)
{
    const uint16_t dof = mesh->node_dof[(size_t)node * mesh->dof_per_node + (size_t)i];
    int k = 0;
    if (dof == PZS_CONSTRAINED || value == 0)
        return;
    while (k < row->entries && row->dof[k] != dof)
        k++;
    if (k == row->entries) {
        row->dof[row->entries] = dof;
        row->value[row->entries++] = 0;
    }
    row->value[k] += value;
}

void springs_direction(const surface_point *point, const scene_direction *direction,
                       double vector[3])
{
    const bool is_vector = vector_length(direction->vector) > 0;
    for (int i = 0; i < 3; i++) {
        vector[i] = direction->component - COMPONENT_X == (unsigned)i;
        if (direction->component <= COMPONENT_U3)
            vector[i] = point->triad[direction->component - COMPONENT_U1][i];
        if (is_vector)
            vector[i] = direction->vector[i];
    }
}

/* Return the height of a face of the shell above the middle of the laminate (m). */
static double face_height(const mesh *mesh, scene_face face)
{
    if (face == FACE_OUTER)
        return mesh->laminate.thickness / 2;
    return face == FACE_INNER ? -mesh->laminate.thickness / 2 : 0;
}

/*
 * Add to the elongation of a spring the displacement of one face of the shell at a node: its
 * component along a vector in space, times a factor. The elongation is stored as a factor for each
 * dof (row).
 */
static void add_node(const spring_builder *builder, int node, double factor, const double vector[3],
                     spring_row *row)
{
    const surface_point *point = &builder->mesh->point[node];
    const double height = face_height(builder->mesh, builder->item->face);
    double mean[3];
    for (int axis = 0; axis < 3; axis++) {
        mean[axis] = factor * vector_dot(point->triad[axis], vector);
        add_entry(builder->mesh, node, 3 + axis, height * mean[axis], row);
    }
    mesh_turn_to_dof(builder->mesh, node, mean);
    for (int axis = 0; axis < 3; axis++)
        add_entry(builder->mesh, node, axis, mean[axis], row);
}

int springs_rotation(const surface_point *point, const scene_direction *axis, double weight[7])
{
    double along[3], lever[3];
    springs_direction(point, axis, along);
    vector_cross(along, point->triad[2], lever);
    memset(weight, 0, 7 * sizeof *weight);
    for (int component = 0; component < 3; component++)
        weight[3 + component] = vector_dot(point->triad[component], lever);
    return vector_length(lever) < 0.01 ? -1 : 0;
}

/* ---- two ends ------------------------------------------------------------ */

/*
 * Compute the vector from the node at the other end of a spring to the point where the spring is
 * attached. Returns its length (m).
 */
static double span(const mesh *mesh, const mesh_spot *spot, int other, double vector[3])
{
    mesh_spot_place(mesh, spot, vector);
    for (int i = 0; i < 3; i++)
        vector[i] -= mesh->point[other].position[i];
    return vector_length(vector);
}

/*
 * Add the second end of a spring, at a node, to the row of factors that give its elongation from
 * the dof. Find the direction of the spring at its first end (vector [3] out): as the scene states,
 * else along the line between both ends. Returns 0, or -1 with error filled if both ends coincide.
 */
static int add_other_end(const spring_builder *builder, const mesh_spot *spot, double vector[3],
                         spring_row *row)
{
    const mesh *mesh = builder->mesh;
    const scene_spring *item = builder->item;
    const int other = mesh_point_node(mesh, &item->to);
    double line[3];
    const double length = span(mesh, spot, other, line);
    if (!(length > 1e-12 * vector_length(mesh->point[other].position)) || length == 0)
        return scene_fault(item->at, builder->error,
                           "both ends of the spring are at %s; name two places",
                           mesh_node_text(mesh, other).text);
    springs_direction(&mesh->point[spot->node[0]], &item->along, vector);
    for (int i = 0; i < 3 && !item->along.given; i++)
        vector[i] = line[i] / length;
    add_node(builder, other, -1, vector, row);
    return 0;
}

static int refuse_axis(const spring_builder *builder, int node)
{
    return scene_fault(builder->item->at, builder->error,
                       "the axis of the torsional spring is normal to the surface at %s, where a "
                       "shell has no rotation; choose an axis in the surface",
                       mesh_node_text(builder->mesh, node).text);
}

/*
 * Compute the factors by which the free dof give the elongation of a spring that is attached at a
 * point of the mesh.
 *   row out  numbers of these dof, and the elongation per unit of each
 * Returns 0, or -1 with error filled.
 */
static int fill_row(const spring_builder *builder, const mesh_spot *spot, spring_row *row)
{
    const mesh *mesh = builder->mesh;
    const scene_spring *item = builder->item;
    double vector[3] = {0, 0, 0};
    row->entries = 0;
    if (item->to.at.column && add_other_end(builder, spot, vector, row) < 0)
        return -1;
    for (int corner = 0; corner < spot->count; corner++) {
        const surface_point *point = &mesh->point[spot->node[corner]];
        if (item->about.given) {
            double weight[7];
            if (springs_rotation(point, &item->about, weight) < 0)
                return refuse_axis(builder, spot->node[corner]);
            for (int i = 3; i < 6; i++)
                add_entry(mesh, spot->node[corner], i, spot->weight[corner] * weight[i], row);
            continue;
        }
        if (item->along.given)
            springs_direction(point, &item->along, vector);
        add_node(builder, spot->node[corner], spot->weight[corner], vector, row);
    }
    return 0;
}

/* ---- list of rows -------------------------------------------------------- */

/*
 * Make room for one more spring in the list of springs, with the factors by which the dof of the
 * mesh give its elongation. Returns 0, or -1 when memory runs out.
 */
static int grow(spring_builder *builder)
{
    mesh_springs *springs = builder->springs;
    const size_t rows = (size_t)springs->count, entries = springs->start ? springs->start[rows] : 0;
    if (!springs->start || rows + 2 > builder->room_rows) {
        builder->room_rows = 2 * rows + 64;
        uint32_t *start = realloc(springs->start, builder->room_rows * sizeof *start);
        springs->start = start ? start : springs->start;
        double *stiffness = realloc(springs->stiffness, builder->room_rows * sizeof *stiffness);
        springs->stiffness = stiffness ? stiffness : springs->stiffness;
        if (!start || !stiffness)
            return -1;
        springs->start[0] = 0;
    }
    if (!springs->dof || entries + MOST_ENTRIES > builder->room_entries) {
        builder->room_entries = 2 * entries + 16 * MOST_ENTRIES;
        uint16_t *dof = realloc(springs->dof, builder->room_entries * sizeof *dof);
        springs->dof = dof ? dof : springs->dof;
        double *value = realloc(springs->value, builder->room_entries * sizeof *value);
        springs->value = value ? value : springs->value;
        if (!dof || !value)
            return -1;
    }
    return 0;
}

/*
 * Refuse a spring that is so much stiffer than the elements that rounding errors of the stiffness
 * matrix would hide the stiffness of the elements. Returns 0, or -1 with error filled.
 */
static int check_stiffness(const spring_builder *builder, double stiffness)
{
    const double largest_ratio = 1e10;
    const double of_elements = builder->largest[builder->item->about.given != 0];
    if (stiffness <= largest_ratio * of_elements)
        return 0;
    return scene_fault(builder->item->at, builder->error,
                       "a stiffness of %.3g is %.2g times that of the elements, and rounding would "
                       "lose the elements; use a support instead, or at most %.2g",
                       stiffness, stiffness / of_elements, largest_ratio * of_elements);
}

/*
 * Append a spring that is attached at a point of the mesh, with its stiffness, to the springs of
 * the mesh. Returns 0, or -1 with error filled.
 */
static int append(spring_builder *builder, const mesh_spot *spot, double stiffness)
{
    mesh_springs *springs = builder->springs;
    spring_row row;
    if (check_stiffness(builder, stiffness) < 0 || fill_row(builder, spot, &row) < 0)
        return -1;
    const int rows = springs->count;
    if (rows >= UINT16_MAX)
        return scene_fault(builder->item->at, builder->error, "more than %u springs; use fewer",
                           (unsigned)UINT16_MAX);
    if (grow(builder) < 0)
        return fault_of_memory(builder);
    const uint32_t at = springs->start[rows];
    memcpy(springs->dof + at, row.dof, (size_t)row.entries * sizeof *row.dof);
    memcpy(springs->value + at, row.value, (size_t)row.entries * sizeof *row.value);
    springs->stiffness[rows] = stiffness;
    springs->start[rows + 1] = at + (uint32_t)row.entries;
    springs->count = rows + 1;
    return 0;
}

/* ---- items ---------------------------------------------------------------- */

static int append_points(spring_builder *builder)
{
    const scene_spring *item = builder->item;
    for (int k = 0; k < item->points; k++) {
        mesh_spot spot;
        if (mesh_spot_find(builder->mesh, item->point[k], &spot) < 0)
            return mesh_spot_refuse(item->at, k, item->point[k], builder->error);
        if (append(builder, &spot, item->stiffness) < 0)
            return -1;
    }
    return 0;
}

/*
 * Compute the length of edge, or the area, that belongs to each of the `count` nodes on which a
 * distributed spring acts. Returns 0, or -1 with error filled.
 */
static int share(spring_builder *builder, int count)
{
    const mesh *mesh = builder->mesh;
    const scene_where *where = &builder->item->where;
    double sum = 0;
    memset(builder->weight, 0, (size_t)mesh->nodes * sizeof *builder->weight);
    if (builder->item->per == PER_AREA)
        mesh_area_shares(mesh, where, builder->weight);
    else if (mesh_length_shares(mesh, where, builder->weight) < 0)
        return scene_fault(where->at, builder->error,
                           "'per: length' needs an edge, or an edge set of the mesh file");
    for (int k = 0; k < count; k++)
        sum += builder->weight[builder->node[k]];
    if (sum > 0)
        return 0;
    return scene_fault(
        where->at, builder->error, "this place has no %s; choose another, or per: point",
        builder->item->per == PER_AREA ? "area: no element has all its nodes in it" : "length");
}

static int append_nodes(spring_builder *builder)
{
    const scene_spring *item = builder->item;
    const int count = mesh_select(builder->mesh, &item->where, builder->node);
    if (item->per != PER_POINT && share(builder, count) < 0)
        return -1;
    for (int k = 0; k < count; k++) {
        const mesh_spot spot = mesh_spot_of_node(builder->node[k]);
        const double size = item->per == PER_POINT ? 1 : builder->weight[builder->node[k]];
        if (size > 0 && append(builder, &spot, size * item->stiffness) < 0)
            return -1;
    }
    return 0;
}

static int append_item(spring_builder *builder, const scene_spring *item)
{
    builder->item = item;
    return item->points > 0 ? append_points(builder) : append_nodes(builder);
}

static int append_all(spring_builder *builder)
{
    const scene *scene = builder->mesh->scene;
    int *first = builder->springs->first;
    for (int k = 0; k < scene->springs; k++) {
        first[k] = builder->springs->count;
        if (append_item(builder, &scene->spring[k]) < 0)
            return -1;
    }
    for (int k = 0; k < scene->actuators; k++) {
        first[scene->springs + k] = builder->springs->count;
        if (scene->actuator[k].stacks && append_item(builder, scene->actuator[k].stacks) < 0)
            return -1;
    }
    first[scene->springs + scene->actuators] = builder->springs->count;
    return 0;
}

/* ---- envelope -------------------------------------------------------------- */

/*
 * Widen the envelope of the stiffness matrix (mesh.first_column, first stored column of each row)
 * for the springs: each dof that moves an end of a spring needs a row that begins at the lowest
 * such dof or before.
 */
static void widen_envelope(mesh *mesh)
{
    const mesh_springs *springs = &mesh->springs;
    for (int row = 0; row < springs->count; row++) {
        uint16_t least = PZS_CONSTRAINED;
        for (uint32_t i = springs->start[row]; i < springs->start[row + 1]; i++)
            least = springs->dof[i] < least ? springs->dof[i] : least;
        for (uint32_t i = springs->start[row]; i < springs->start[row + 1]; i++)
            if (least < mesh->first_column[springs->dof[i]])
                mesh->first_column[springs->dof[i]] = least;
    }
}

/*
 * Refuse springs between distant nodes if the triangular factor of the stiffness matrix would have
 * too many entries with them. Returns 0, or -1 with error filled.
 */
static int check_envelope(mesh *mesh, char *error)
{
    const double largest = 4e8;
    mesh->springs.envelope_without = mesh_envelope(mesh);
    widen_envelope(mesh);
    const double with = mesh_envelope(mesh);
    if (with <= fmax(largest, mesh->springs.envelope_without))
        return 0;
    return scene_fault(mesh->scene->at_surface, error,
                       "springs between distant nodes widen the stiffness factor from %.3g to %.3g "
                       "numbers, and %.3g fit; use fewer elements or fewer of these springs",
                       mesh->springs.envelope_without, with, largest);
}

/* ---- build ------------------------------------------------------------------ */

/*
 * Find the largest diagonal entries of the stiffness matrices of the shell elements, for two groups
 * of dof with different units.
 *   largest [2] out  entry for the mean displacement of both faces of the shell (N/m), and entry
 *       for the difference of their displacements divided by the thickness (N m)
 */
static void find_largest(const mesh *mesh, double largest[2])
{
    const size_t count = 4 * (size_t)mesh->dof_per_node, packed = SHELL_PACKED(count);
    largest[0] = largest[1] = 0;
    for (size_t type = 0; type < (size_t)mesh->types; type++)
        for (size_t i = 0; i < count; i++) {
            const size_t own = i % mesh->dof_per_node;
            const double entry = mesh->stiffness[type * packed + SHELL_PACKED(i) + i];
            if (own < 6)
                largest[own / 3] = fmax(largest[own / 3], entry);
        }
}

static bool has_springs(const scene *scene)
{
    bool found = scene->springs > 0;
    for (int k = 0; k < scene->actuators; k++)
        found |= scene->actuator[k].stacks != NULL;
    return found;
}

int springs_list(mesh *mesh, mesh_springs *springs, char *error)
{
    const scene *scene = mesh->scene;
    const size_t items = (size_t)scene->springs + (size_t)scene->actuators;
    spring_builder builder = {.mesh = mesh, .springs = springs, .error = error};
    int status = -1;
    if (!has_springs(scene))
        return 0;
    find_largest(mesh, builder.largest);
    springs->first = calloc(items + 1, sizeof *springs->first);
    builder.node = calloc((size_t)mesh->nodes, sizeof *builder.node);
    builder.weight = calloc((size_t)mesh->nodes, sizeof *builder.weight);
    if (springs->first && builder.node && builder.weight)
        status = append_all(&builder);
    else
        scene_fault(scene->at_surface, error, "the springs do not fit into memory");
    free(builder.node);
    free(builder.weight);
    return status;
}

int mesh_springs_build(mesh *mesh, char *error)
{
    if (springs_list(mesh, &mesh->springs, error) < 0)
        return -1;
    return mesh->springs.count > 0 ? check_envelope(mesh, error) : 0;
}

void mesh_springs_free(mesh_springs *springs)
{
    free(springs->first);
    free(springs->start);
    free(springs->dof);
    free(springs->value);
    free(springs->stiffness);
    memset(springs, 0, sizeof *springs);
}

/* ---- use ----------------------------------------------------------------------- */

int springs_item(const scene *scene, int actuator)
{
    return scene->springs + actuator;
}

double springs_elongation(const mesh_springs *springs, int row, const double *displacement)
{
    double sum = 0;
    for (uint32_t i = springs->start[row]; i < springs->start[row + 1]; i++)
        sum += springs->value[i] * displacement[springs->dof[i]];
    return sum;
}

void springs_add(const mesh_springs *springs, int row, double factor, double *dense)
{
    for (uint32_t i = springs->start[row]; i < springs->start[row + 1]; i++)
        dense[springs->dof[i]] += factor * springs->value[i];
}
