/* SPDX-License-Identifier: BSD-2-Clause */
/* Nodal forces of the load types (load_forces.h). */
#include "load_forces.h"
#include <math.h>
#include <string.h>
#include "../mesh/corner_weight.h"
#include "../mesh/springs.h"
#include "../quads/vector.h"
#include "node_forces.h"

/*
 * Return whether a load acts along a vector that the scene file gives. Otherwise the load acts
 * along a displacement component.
 */
static bool has_vector(const scene_load *load)
{
    return vector_length(load->vector) > 0;
}

/*
 * Compute the vector of a load at a node, in its local axes: the direction of the load (thickness
 * direction for a pressure) times the value. A load per area of the loaded face is multiplied by
 * the ratio of this area to that of the reference surface.
 */
static void load_vector(const mesh *mesh, const scene_load *load, int node, double value,
                        double vector[3])
{
    const surface_point *point = &mesh->point[node];
    const double z = mesh->laminate.z[load->face == FACE_OUTER];
    const double stretch =
        load->true_area ? (1 + point->curvature[0] * z) * (1 + point->curvature[1] * z) : 1;
    node_direction(point, load->component, vector);
    for (int axis = 0; axis < 3 && has_vector(load); axis++)
        vector[axis] = vector_dot(point->triad[axis], load->vector);
    for (int axis = 0; axis < 3; axis++)
        vector[axis] *= value * stretch;
}

/*
 * Add the nodal forces of a concentrated force to a vector [free_dof]. The force acts on the face
 * that the load names; the nodal forces do the same virtual work. A force on the middle surface is
 * divided equally between both faces.
 */
static void add_force(const mesh *mesh, const scene_load *load, int node, double factor,
                      const double direction[3], double *dense)
{
    double weight[7];
    node_face_weights(mesh, load->face, direction, weight);
    node_add(mesh, node, factor, weight, dense);
}

/*
 * Carry a load vector from the local axes of one node to those of another, for interpolation
 * between nodes. With Cartesian kinematics, a load of fixed direction in space keeps its direction.
 * All other loads keep their components in the local axes: if pressures along two different normals
 * were added as vectors, their sum would be too small.
 */
static void carry(const mesh *mesh, const scene_load *load, int from, int to,
                  const double direction[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = direction[axis];
        if (!mesh->formulation.cartesian || load->component <= COMPONENT_U3)
            continue;
        out[axis] = 0;
        for (int other = 0; other < 3; other++)
            for (int i = 0; i < 3; i++)
                out[axis] += mesh->point[to].triad[axis][i] * mesh->point[from].triad[other][i] *
                             direction[other];
    }
}

double load_chords(const mesh *mesh, int element, int corner, scene_face face, double flat[2][2],
                   double lean[2])
{
    const pzs_element_type *type = &mesh->type[mesh->element_type[element]];
    const double half = node_face_height(face, type->thickness);
    for (int axis = 0; axis < 2; axis++) {
        for (int i = 0; i < 2; i++)
            flat[axis][i] = type->g_mean[corner][axis][i] + half * type->g_diff[corner][axis][i];
        const double length = hypot(flat[axis][0], flat[axis][1]),
                     x = atan2(type->g_mean[corner][axis][2] + half * type->g_diff[corner][axis][2],
                               length);
        lean[axis] = length * (fabs(x) > 1e-3 ? 1 / x - 1 / tan(x) : x / 3);
    }
    return flat[0][0] * flat[1][1] - flat[0][1] * flat[1][0];
}

/*
 * Add the in-plane nodal force that a pressure causes at a corner of an element. The force arises
 * because the straight sides of the element are inclined to the plane tangent to the curved surface
 * at the corner.
 *   direction [3] in  pressure at the corner as a vector in the local axes of the corner
 */
static void add_lean(const mesh *mesh, const scene_load *load, int element, int corner, double size,
                     const double direction[3], double *dense)
{
    double flat[2][2], lean[2], weight[7] = {0};
    const double part =
        direction[2] * size / load_chords(mesh, element, corner, load->face, flat, lean);
    weight[0] = part * (lean[1] * flat[0][1] - lean[0] * flat[1][1]);
    weight[1] = part * (lean[0] * flat[1][0] - lean[1] * flat[0][0]);
    node_add(mesh, mesh->element[element][corner], 1, weight, dense);
}

/*
 * Return the entry (row, column), an integer, of the matrix from a distributed load at the nodes to
 * its consistent nodal forces. Unit: 1/36 of the area of an element with four nodes (count = 4), or
 * 1/6 of the length of an edge with two (count = 2).
 */
static double consistent_weight(int count, int row, int column)
{
    const int is_opposite = count == 4 && (row ^ column) == 2;
    int weight = count == 4 ? 4 : 2;
    if (is_opposite)
        weight /= 4;
    else if (row != column)
        weight /= 2;
    return weight;
}

/*
 * Add the consistent nodal forces of a distributed load on an edge or on an element.
 *   place  in  geometry of the element at its corners, or NULL for an edge
 *   value  in  value of the load at each of the `count` nodes
 *   size   in  length of the edge (m) or area of the element (m2)
 */
static void add_distributed(const mesh *mesh, const scene_load *load, const laminate_place *place,
                            const int *node, const double *value, int count, double size,
                            double *dense)
{
    const int whole = count == 4 ? 36 : 6;
    for (int row = 0; row < count; row++)
        for (int column = 0; column < count; column++) {
            double direction[3], carried[3];
            load_vector(mesh, load, node[column], value[column], direction);
            carry(mesh, load, node[column], node[row], direction, carried);
            const double excess = place ? corner_pair_excess(place, row, column) : 0;
            const double weight =
                size * consistent_weight(count, row, column) / whole + size * excess;
            add_force(mesh, load, node[row], weight, carried, dense);
        }
}

/*
 * Return whether a load on a face acts on an element. A load without an element set acts on all
 * elements, otherwise only on the elements of its set.
 */
static bool is_loaded(const mesh *mesh, const scene_load *load, uint32_t element)
{
    const quad_mesh *quads = mesh->quads;
    if (!quads || load->where.type != WHERE_SET)
        return true;
    return quad_set_has(quad_set_find(quads->element_set, quads->element_sets, load->where.set),
                        element);
}

/*
 * Return the mass of an element per area of its middle surface (kg/m2), from the densities of its
 * plies.
 */
static double mass_per_area(const mesh *mesh, const laminate_place *place)
{
    double mass = 0;
    for (int k = 0; k < mesh->laminate.plies; k++) {
        const laminate_ply *ply = &mesh->laminate.ply[k];
        mass += ply->density * (ply->z[1] - ply->z[0]) * laminate_cover(place, k);
    }
    return mass;
}

/*
 * Add the nodal forces of a load on one element.
 *   factor in  factor by which the value of the load is multiplied: 1 for a force per area, the
 *       mass per area for a weight
 */
static void add_element(const mesh *mesh, const scene_load *load, int element, const double *value,
                        double factor, double *dense)
{
    const laminate_place *place = &mesh->place[mesh->element_type[element]];
    int node[4];
    double corner[4], direction[3];
    for (int i = 0; i < 4; i++) {
        node[i] = mesh->element[element][i];
        corner[i] = value[node[i]];
    }
    add_distributed(mesh, load, place, node, corner, 4, place->area * factor, dense);
    if (!mesh->formulation.cartesian || load->component != COMPONENT_U3)
        return;
    for (int i = 0; i < 4; i++) {
        load_vector(mesh, load, node[i], corner[i], direction);
        add_lean(mesh, load, element, i, place->area / 4 * corner_jacobian(place, i), direction,
                 dense);
    }
}

void face_forces(const mesh *mesh, const scene_load *load, const double *value, double *dense)
{
    for (int element = 0; element < mesh->elements; element++)
        if (is_loaded(mesh, load, (uint32_t)element))
            add_element(mesh, load, element, value, 1, dense);
}

/* Add the nodal forces of the weight of a concentrated mass, which act at the face it moves with.
 */
static void add_mass_weight(const mesh *mesh, const scene_load *load, const mesh_mass *mass,
                            const double *value, double *dense)
{
    const uint16_t *node = mesh->element[mass->element];
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++) {
            double direction[3], carried[3], weight[7];
            load_vector(mesh, load, node[column], value[node[column]], direction);
            carry(mesh, load, node[column], node[row], direction, carried);
            node_face_weights(mesh, mass->face, carried, weight);
            node_add(mesh, node[row], mass->mass * mass->weight[row] * mass->weight[column], weight,
                     dense);
        }
}

void weight_forces(const mesh *mesh, const scene_load *load, const double *value, double *dense)
{
    for (int element = 0; element < mesh->elements; element++)
        add_element(mesh, load, element, value,
                    mass_per_area(mesh, &mesh->place[mesh->element_type[element]]), dense);
    for (int k = 0; k < mesh->masses; k++)
        add_mass_weight(mesh, load, &mesh->mass[k], value, dense);
}

/*
 * Add the nodal forces of a load on an edge of the mesh, or on an edge set of a mesh from a file.
 * The length of a side of an element is the straight distance between its two nodes.
 */
void line_forces(const mesh *mesh, const scene_load *load, const double *value, double *dense)
{
    const int sides = mesh_sides(mesh, &load->where);
    for (int k = 0; k < sides; k++) {
        const mesh_side side = mesh_side_at(mesh, &load->where, k);
        const double corner[2] = {value[side.node[0]], value[side.node[1]]};
        add_distributed(mesh, load, NULL, side.node, corner, 2, side.length, dense);
    }
}

laminate_field load_temperatures(const scene_load *load)
{
    const expr_point anywhere = {0, 0, 0, 0, 0};
    laminate_field field = {.ply = -1};
    field.temperature[0] = expr_value(load->value, &anywhere);
    field.temperature[1] = load->outer ? expr_value(load->outer, &anywhere) : field.temperature[0];
    return field;
}

void load_temperature_resultants(const mesh *mesh, const scene_load *load, int element,
                                 double h0[LAMINATE_STRAINS])
{
    const laminate_field field = load_temperatures(load);
    laminate_resultants(&mesh->laminate, &mesh->formulation,
                        &mesh->place[mesh->element_type[element]], &field, h0);
}

void temperature_forces(const mesh *mesh, const scene_load *load, const double *value,
                        double *dense)
{
    double h0[LAMINATE_STRAINS];
    (void)value;
    for (int element = 0; element < mesh->elements; element++) {
        load_temperature_resultants(mesh, load, element, h0);
        node_add_resultants(mesh, element, h0, dense);
    }
}

void point_forces(const mesh *mesh, const scene_load *load, const double *value, double *dense)
{
    const int node = mesh_point_node(mesh, &load->where);
    double direction[3];
    load_vector(mesh, load, node, value[node], direction);
    add_force(mesh, load, node, 1, direction, dense);
}

void moment_forces(const mesh *mesh, const scene_load *load, const double *value, double *dense)
{
    const int node = mesh_point_node(mesh, &load->where);
    double weight[7];
    (void)springs_rotation(&mesh->point[node], &load->about, weight);
    node_add(mesh, node, value[node], weight, dense);
}

void load_forces_add(const mesh *mesh, const scene_load *load, const double *value, double *dense)
{
#define FORCES_OF(type, words, quantity, forces) [type] = forces,
    static load_forces *const forces[LOAD_TYPE_COUNT] = {LOAD_TYPES(FORCES_OF)};
    forces[load->type](mesh, load, value, dense);
}
