/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Material directions on a mesh of quadrilaterals. The angles of layers are measured from a vector
 * on each element, projected on the element. The key `direction` in the section `mesh` gives one
 * vector, three formulas of the position, or the name of a set of edges, which the direction
 * follows.
 */
#include "scene_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/quad_side.h"
#include "../quads/vector.h"
#include "scene_file.h"

/* ---- the key ------------------------------------------------------------- */

static const form formulas_form = {.type = FORM_LIST, .item = &formula_form, .least = 3, .most = 3};
static const form *const direction_forms[] = {&formulas_form, &name_form, NULL};
const form ply_direction_form = {.type = FORM_ANY, .any = direction_forms};

/* Refuse a constant direction of length 0. */
static int check_constant(reader *reader, int node, const scene_ply_direction *direction)
{
    static const expr_point origin;
    double length = 0;
    for (int i = 0; i < 3; i++) {
        if (!expr_is_constant(direction->formula[i]))
            return 0;
        length = hypot(length, expr_value(direction->formula[i], &origin));
    }
    if (length > 0)
        return 0;
    return tree_fault(reader->t, node, "'%.60s: [0, 0, 0]' has no direction; give one",
                      tree_name(reader->t, node));
}

static int read_formulas(reader *reader, int node, scene_ply_direction *direction)
{
    if (reader->t->node[node].count != 3)
        return tree_fault(reader->t, node, "'%.60s' has %d values; give three, [x, y, z]",
                          tree_name(reader->t, node), reader->t->node[node].count);
    int axis = 0;
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        if (read_expr(reader, i, &direction->formula[axis], NULL) != 0)
            return -1;
        if (expr_uses_theta(direction->formula[axis++]))
            return tree_fault(reader->t, i,
                              "a mesh from a file has no theta1 and theta2; use x, y and z");
    }
    return check_constant(reader, node, direction);
}

int read_ply_direction(reader *reader, int node, void *to, const void *rule)
{
    scene_ply_direction *direction = &reader->s->ply_direction;
    (void)to;
    direction->given = true;
    direction->at = node_at(reader, node);
    if (reader->t->node[node].kind == TREE_LIST)
        return read_formulas(reader, node, direction);
    return read_name(reader, node, direction->set, rule);
}

/* ---- materials ------------------------------------------------------------- */

/*
 * Return whether two material constants differ by more than 1 percent, a tolerance for rounded
 * values of data sheets.
 */
static bool differ(double first, double second)
{
    return fabs(first - second) > 0.01 * fmax(fabs(first), fabs(second));
}

/* Return whether a material has the same constants in all directions across its axis 3. */
static bool is_alike_across(const scene_material *material)
{
    const double shear = material->e[0] / (2 * (1 + material->nu12));
    const double *e = material->piezo_e;
    const bool elastic = !differ(material->e[0], material->e[1]) && !differ(material->g12, shear) &&
                         !differ(material->g13, material->g23) &&
                         !differ(material->nu13, material->nu23);
    const bool piezo = !differ(material->d31, material->d32) &&
                       !differ(material->d15, material->d24) && !differ(e[0], e[1]) &&
                       !differ(e[3], e[4]);
    return elastic && piezo && !differ(material->alpha[0], material->alpha[1]);
}

/*
 * Return the first layer whose properties depend on the direction in the surface, or NULL if there
 * is none.
 */
static const scene_layer *directed_layer(const scene *scene)
{
    for (int i = 0; i < scene->layers; i++) {
        const scene_layer *layer = &scene->layer[i];
        if (!is_alike_across(&scene->material[layer->material]) || abs(layer->poling) < 3)
            return layer;
    }
    return NULL;
}

/* Return the number that an element has in the mesh file. */
static long long label_of(const quad_mesh *mesh, size_t element)
{
    return mesh->element_label ? mesh->element_label[element] : (long long)element;
}

/* ---- no direction ------------------------------------------------------------ */

/*
 * Check that the first sides of all elements continue each other, as on mesh lines: where side
 * number k of an element is side number m of its neighbour, m must be (k + 2) mod 4. Returns a side
 * for which this does not hold, or NULL if it holds everywhere.
 *   side [sides] in  sides of all elements, sorted so that the two of one edge are adjacent
 */
static const quad_side *find_turn(const quad_side *side, size_t sides)
{
    for (size_t i = 0; i + 1 < sides; i++)
        if (quad_side_is_same(&side[i], &side[i + 1]) &&
            (side[i].edge % 4 + 2) % 4 != side[i + 1].edge % 4)
            return &side[i];
    return NULL;
}

static int refuse_turn(const scene *scene, const scene_layer *layer, const quad_side *turn,
                       char *error)
{
    const quad_mesh *mesh = &scene->quads->mesh;
    return scene_fault(layer->at, error,
                       "material '%s' differs along and across its axis 1, and the first sides of "
                       "the elements, which would be this axis, turn from element %lld to element "
                       "%lld; give mesh: {direction: [x, y, z]}",
                       scene->material[layer->material].name, label_of(mesh, turn[0].edge / 4),
                       label_of(mesh, turn[1].edge / 4));
}

/*
 * Refuse layers that need a direction where the scene gives none and the first sides of the
 * elements do not continue each other along mesh lines.
 */
static int check_first_sides(const scene *scene, const scene_layer *layer, char *error)
{
    const quad_mesh *mesh = &scene->quads->mesh;
    quad_side *side = calloc(4 * mesh->elements + 1, sizeof *side);
    if (!side)
        return scene_fault(scene->quads->at, error, "the mesh does not fit into memory");
    quad_sides(mesh, side);
    const quad_side *turn = find_turn(side, 4 * mesh->elements);
    const int status = turn ? refuse_turn(scene, layer, turn, error) : 0;
    free(side);
    return status;
}

/* ---- the direction on an element ------------------------------------------- */

static void find_centre(const quad_mesh *mesh, size_t element, double centre[3])
{
    memset(centre, 0, 3 * sizeof *centre);
    for (int corner = 0; corner < 4; corner++)
        for (int i = 0; i < 3; i++)
            centre[i] += mesh->position[mesh->element[element][corner]][i] / 4;
}

/* Compute the unit normal of an element, perpendicular to both of its diagonals. */
static void find_normal(const quad_mesh *mesh, size_t element, double normal[3])
{
    const uint32_t *corner = mesh->element[element];
    double diagonal[2][3];
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++)
            diagonal[k][i] = mesh->position[corner[k + 2]][i] - mesh->position[corner[k]][i];
    vector_cross(diagonal[0], diagonal[1], normal);
    vector_normalise(normal);
}

/*
 * Return the distance of a point from an edge of the mesh.
 *   along  out  vector from the first to the second node of the edge
 */
static double distance_of_edge(const quad_mesh *mesh, uint32_t edge, const double point[3],
                               double along[3])
{
    const uint32_t *corner = mesh->element[edge / 4];
    const double *from = mesh->position[corner[edge % 4]],
                 *to = mesh->position[corner[(edge + 1) % 4]];
    double step[3], foot[3];
    for (int i = 0; i < 3; i++) {
        along[i] = to[i] - from[i];
        step[i] = point[i] - from[i];
    }
    const double share = vector_dot(step, along) / vector_dot(along, along);
    for (int i = 0; i < 3; i++)
        foot[i] = from[i] + fmin(1, fmax(0, share)) * along[i];
    return vector_distance(foot, point);
}

/*
 * Among the edges of a set, find the one nearest to a point, and store its direction in
 * `direction`.
 */
static void follow_edges(const quad_mesh *mesh, const quad_set *edges, const double point[3],
                         double direction[3])
{
    double nearest = HUGE_VAL;
    for (size_t i = 0; i < edges->count; i++) {
        double along[3];
        const double distance = distance_of_edge(mesh, edges->index[i], point, along);
        if (distance < nearest) {
            nearest = distance;
            memcpy(direction, along, sizeof along);
        }
    }
}

/*
 * Compute the unit vector of the layers' direction on an element. Returns the sine of the angle
 * between the direction and the normal of the element; 0 if the scene's direction there is zero or
 * not finite.
 */
static double direction_on(const scene *scene, const quad_set *edges, size_t element,
                           double direction[3])
{
    const scene_ply_direction *given = &scene->ply_direction;
    const quad_mesh *mesh = &scene->quads->mesh;
    double centre[3], normal[3], across[3];
    find_centre(mesh, element, centre);
    find_normal(mesh, element, normal);
    const expr_point at = {centre[0], centre[1], centre[2], 0, 0};
    for (int i = 0; i < 3 && !edges; i++)
        direction[i] = expr_value(given->formula[i], &at);
    if (edges)
        follow_edges(mesh, edges, centre, direction);
    if (!(vector_normalise(direction) > 0))
        return 0;
    vector_cross(direction, normal, across);
    return vector_length(across);
}

/* ---- all elements ---------------------------------------------------------- */

/*
 * Sine of one degree, the smallest angle between the direction of the layers and the normal of an
 * element at which the direction is accepted.
 */
static const double least_sine = 0.0174524;

static int refuse_normal(const scene *scene, size_t element, char *error)
{
    const quad_mesh *mesh = &scene->quads->mesh;
    double centre[3];
    find_centre(mesh, element, centre);
    return scene_fault(scene->ply_direction.at, error,
                       "the direction is normal to element %lld at (%g, %g, %g), or no finite "
                       "vector there, so that it has no projection; give another direction",
                       label_of(mesh, element), centre[0], centre[1], centre[2]);
}

static int set_axes(scene *scene, const quad_set *edges, bool is_needed, char *error)
{
    quad_mesh *mesh = &scene->quads->mesh;
    free(mesh->material_axis);
    mesh->material_axis = calloc(mesh->elements + 1, sizeof *mesh->material_axis);
    if (!mesh->material_axis)
        return scene_fault(scene->quads->at, error, "the mesh does not fit into memory");
    for (size_t element = 0; element < mesh->elements; element++) {
        double *axis = mesh->material_axis[element];
        if (direction_on(scene, edges, element, axis) >= least_sine)
            continue;
        if (is_needed)
            return refuse_normal(scene, element, error);
        memset(axis, 0, sizeof *mesh->material_axis);
    }
    return 0;
}

static int refuse_edges(const scene *scene, char *error)
{
    return scene_fault(scene->ply_direction.at, error,
                       "the mesh has no set of edges '%s' for the direction to follow (in Gmsh a "
                       "physical curve); name one, or give a vector [x, y, z]",
                       scene->ply_direction.set);
}

/*
 * Refuse a layer poled along the surface if the layers' direction follows edges of the mesh: it is
 * then known only up to its sign, but a poling needs the sign.
 */
static int check_sense(const scene *scene, char *error)
{
    for (int i = 0; i < scene->layers; i++)
        if (abs(scene->layer[i].poling) < 3)
            return scene_fault(scene->layer[i].at, error,
                               "this layer is poled along the surface, and the edges of set '%s' "
                               "have no sense; give mesh: {direction: [x, y, z]}, a vector or "
                               "formulas",
                               scene->ply_direction.set);
    return 0;
}

int check_directions(scene *scene, char *error)
{
    const quad_mesh *mesh = &scene->quads->mesh;
    const scene_ply_direction *given = &scene->ply_direction;
    const scene_layer *layer = directed_layer(scene);
    if (!given->given)
        return layer ? check_first_sides(scene, layer, error) : 0;
    if (!*given->set)
        return set_axes(scene, NULL, layer != NULL, error);
    const quad_set *edges = quad_set_find(mesh->edge_set, mesh->edge_sets, given->set);
    if (!edges)
        return refuse_edges(scene, error);
    return check_sense(scene, error) != 0 ? -1 : set_axes(scene, edges, layer != NULL, error);
}
