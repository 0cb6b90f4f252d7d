/* SPDX-License-Identifier: BSD-2-Clause */
/* Forces and moments of the supports on the shell (reactions.h). */
#include "reactions.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"
#include "../../lib/nonlinear/face.h"
#include "../../lib/nonlinear/nonlinear.h"
#include "../mesh/springs.h"
#include "../quads/vector.h"
#include "load_forces.h"
#include "spring_forces.h"

/*
 * Copy of a structure in which the constrained dof have numbers, too, which follow those of the
 * free dof; and forces as vectors over all these dof.
 */
typedef struct all_dof {
    const reaction_state *state;
    mesh mesh; /* copy of the mesh in which the constrained dof are numbered, too; only its array
                  node_dof has own memory */
    pzs_structure structure; /* copy of the structure in which the constrained dof are numbered, too
                              */
    pzs_model model;
    pzs_solver solver;
    mesh_springs springs;
    double *memory;
    double *displacement; /* [free and constrained dof] displacement, 0 at the constrained dof */
    double *internal; /* [free and constrained dof] internal forces of the elements (N and N m) */
    double *load;     /* [free and constrained dof] forces of the loads (N and N m) */
    double *spring; /* [free and constrained dof] forces of springs and stacks on the shell (N and N
                       m) */
    double *contact; /* [free and constrained dof] forces of a contact body on the shell (N and N m)
                      */
    double *unit;    /* [free and constrained dof] force per unit of one load */
    double *value;   /* [nodes] value of one load at each node */
    double (*prescribed)[LAMINATE_STRAINS]; /* [elements] stress resultants that voltages and
                                               temperatures cause in each element at zero strain,
                                               times the area of the element: work per unit of each
                                               strain (N m), or of each curvature (N m2) */
} all_dof;

static double *dof_vector(const all_dof *all, int k)
{
    return all->memory + (size_t)k * (size_t)all->mesh.free_dof;
}

/* ---- numbers for all dof --------------------------------------------------- */

/* Whether the dof of all nodes, with the constrained ones, can be numbered in 16 bits. */
static bool are_numbered(const design *design)
{
    return (size_t)design->mesh.nodes * design->mesh.dof_per_node < PZS_CONSTRAINED;
}

/* Number the constrained dof after the free dof. Returns 0, or -1 where memory runs out. */
static int number_all(all_dof *all)
{
    const mesh *own = &all->state->design->mesh;
    const size_t count = (size_t)own->nodes * own->dof_per_node;
    all->mesh = *own;
    all->mesh.node_dof = malloc(count * sizeof *all->mesh.node_dof);
    if (!all->mesh.node_dof)
        return -1;
    for (size_t i = 0; i < count; i++)
        all->mesh.node_dof[i] = own->node_dof[i] == PZS_CONSTRAINED
                                    ? (uint16_t)(all->mesh.free_dof++ & 0xFFFF)
                                    : own->node_dof[i];
    return 0;
}

/*
 * Allocate the vectors of forces and displacements over all dof, free and constrained. Returns 0,
 * or -1 where memory runs out.
 */
static int allocate(all_dof *all)
{
    double **const vector[] = {&all->displacement, &all->internal, &all->load,
                               &all->spring,       &all->contact,  &all->unit};
    const size_t vectors = sizeof vector / sizeof *vector;
    const mesh *mesh = &all->state->design->mesh;
    all->memory = calloc(vectors * (size_t)all->mesh.free_dof, sizeof *all->memory);
    all->value = calloc((size_t)mesh->nodes, sizeof *all->value);
    all->prescribed = calloc((size_t)mesh->elements, sizeof *all->prescribed);
    if (!all->memory || !all->value || !all->prescribed)
        return -1;
    for (size_t i = 0; i < vectors; i++)
        *vector[i] = dof_vector(all, (int)i);
    memcpy(all->displacement, all->state->displacement,
           (size_t)mesh->free_dof * sizeof *all->displacement);
    return 0;
}

/*
 * Prepare copies of the model and of the equilibrium solver that compute forces on the constrained
 * dof, too. The copies use a copy of the structure in which all dof have a number.
 */
static void attach(all_dof *all)
{
    all->structure = all->state->design->structure;
    all->structure.node_dof = all->mesh.node_dof;
    all->structure.free_dof = (uint16_t)all->mesh.free_dof;
    all->model.state.structure = &all->structure;
    if (!all->state->equilibrium)
        return;
    all->solver = all->state->equilibrium->solver;
    all->solver.state.model = &all->model;
    all->solver.state.displacement = all->displacement;
}

static void close_all(all_dof *all)
{
    free(all->mesh.node_dof);
    free(all->memory);
    free(all->value);
    free(all->prescribed);
    mesh_springs_free(&all->springs);
}

/* ---- internal forces ------------------------------------------------------- */

/*
 * For an actuator or a sensor, add the stress resultants that its voltages or temperatures cause at
 * zero strains to those of each element (all->prescribed).
 *   value [amplifiers or electrodes] in  voltages (V) or temperatures (K)
 */
static void add_actuator(all_dof *all, const scene_actuator *actuator, const double *value)
{
    double h0[LAMINATE_STRAINS];
    for (int cell = 0; cell < actuator->grid[0] * actuator->grid[1]; cell++)
        for (int element = 0; value[cell] != 0 && element < all->mesh.elements; element++) {
            if (!design_actuation(&all->mesh, actuator, cell, element, h0))
                continue;
            for (int i = 0; i < LAMINATE_STRAINS; i++)
                all->prescribed[element][i] += value[cell] * h0[i];
        }
}

/*
 * Add the stress resultants that a temperature load causes at zero strains to those of each element
 * (all->prescribed).
 */
static void add_temperature(all_dof *all, const scene_load *load, double factor)
{
    double h0[LAMINATE_STRAINS];
    for (int element = 0; element < all->mesh.elements; element++) {
        load_temperature_resultants(&all->mesh, load, element, h0);
        for (int i = 0; i < LAMINATE_STRAINS; i++)
            all->prescribed[element][i] += factor * h0[i];
    }
}

/*
 * Add the stress resultants that the electric potentials of bare faces (without electrodes) cause
 * at zero strains to those of each element (all->prescribed).
 */
static void add_potentials(all_dof *all)
{
    const bare_faces *bare = &all->state->design->bare;
    double h0[LAMINATE_STRAINS];
    for (int k = 0; k < bare->count; k++) {
        const double value = all->state->input_value[bare->first_input + k];
        for (int element = 0; value != 0 && element < all->mesh.elements; element++) {
            if (!bare_faces_resultants(bare, k, element, h0))
                continue;
            for (int i = 0; i < LAMINATE_STRAINS; i++)
                all->prescribed[element][i] += value * h0[i];
        }
    }
}

/*
 * Compute for each element the stress resultants at zero strains under all voltages and
 * temperatures.
 */
static void fill_prescribed(all_dof *all)
{
    const design *design = all->state->design;
    const double *value = all->state->input_value;
    for (int k = 0; k < design->actuators; k++)
        if (!design->actuator[k].stacks)
            add_actuator(all, &design->actuator[k], value + design->actuator[k].first);
    for (int k = 0; k < design->loads; k++)
        if (design->load[k].type == LOAD_TEMPERATURE)
            add_temperature(all, &design->load[k], value[design->amplifiers + k]);
    for (int k = 0; k < design->sensors; k++)
        add_actuator(all, &design->sensor[k],
                     value + design->sensor_first + design->sensor[k].first);
    add_potentials(all);
}

/*
 * Compute the internal force of an element at the displacement of its nodes.
 *   u     [4 dof_per_node] in   displacement in the triads (local axes) of the nodes
 *   force [4 dof_per_node] out  internal force
 */
static void element_force(const all_dof *all, int element, const double *u, double *force)
{
    const pzs_element_type *type = &all->mesh.type[all->mesh.element_type[element]];
    const unsigned dof_per_node = all->mesh.dof_per_node;
    if (all->state->equilibrium) {
        double resultant[SHELL_RESULTANTS];
        pzs_shell_resultants(type, dof_per_node, u, NULL, all->prescribed[element], resultant);
        pzs_shell_force_at(type, dof_per_node, u, resultant, force);
        return;
    }
    double given[SHELL_MAX];
    pzs_shell_force(type, dof_per_node, u, force);
    pzs_shell_prescribed_force(type, dof_per_node, all->prescribed[element], given);
    for (unsigned i = 0; i < 4 * dof_per_node; i++)
        force[i] -= given[i];
}

/*
 * Sum the internal forces of all elements. Returns the sum of the magnitudes of the forces at their
 * corners (N).
 */
static double add_internal(all_dof *all)
{
    double u[SHELL_MAX], force[SHELL_MAX], sum = 0;
    for (int element = 0; element < all->mesh.elements; element++) {
        const uint16_t *node = all->mesh.element[element];
        pzs_model_gather(&all->model, node, SHELL_NODES, all->displacement, u);
        element_force(all, element, u, force);
        pzs_model_scatter(&all->model, node, SHELL_NODES, 1, force, all->internal);
        for (unsigned corner = 0; corner < SHELL_NODES; corner++)
            sum += vector_length(force + corner * all->mesh.dof_per_node);
    }
    return sum;
}

/* ---- forces on the shell --------------------------------------------------- */

/* Add the forces of a load of constant direction, times a factor, to those of all loads. */
static void add_load(all_dof *all, const scene_load *load, double factor)
{
    char error[SCENE_ERROR];
    const size_t dof = (size_t)all->mesh.free_dof;
    if (factor == 0 || load->type == LOAD_TEMPERATURE ||
        design_load_values(&all->mesh, load, all->value, error) < 0)
        return;
    memset(all->unit, 0, dof * sizeof *all->unit);
    load_forces_add(&all->mesh, load, all->value, all->unit);
    for (size_t i = 0; i < dof; i++)
        all->load[i] += factor * all->unit[i];
}

/* Add the forces of the pressures that turn with the shell to those of all loads. */
static void add_followers(all_dof *all)
{
    const equilibrium *equilibrium = all->state->equilibrium;
    const size_t dof = (size_t)all->mesh.free_dof;
    for (int k = 0; equilibrium && k < equilibrium->followers; k++) {
        pzs_follower_load load = equilibrium->follower_load[k];
        const uint16_t input = equilibrium->follower[k].input;
        memset(all->unit, 0, dof * sizeof *all->unit);
        load.option.call->add_unit_force(&load.option, &all->solver, input, all->unit);
        for (size_t i = 0; i < dof; i++)
            all->load[i] += all->state->input_value[input] * all->unit[i];
    }
}

/*
 * Add the forces of all springs and piezoelectric stacks to the vector of spring forces over all
 * dof. Returns 0, or -1 where memory runs out.
 */
static int add_springs(all_dof *all)
{
    const reaction_state *state = all->state;
    char error[SCENE_ERROR];
    if (state->design->mesh.springs.count == 0)
        return 0;
    if (springs_list(&all->mesh, &all->springs, error) < 0)
        return -1;
    for (int row = 0; row < all->springs.count; row++)
        springs_add(&all->springs, row,
                    spring_force(state->design, row, state->displacement, state->input_value),
                    all->spring);
    return 0;
}

/* Add the forces of the contact pressure, which act along the normal of the contact body. */
static void add_contact(all_dof *all)
{
    const equilibrium *equilibrium = all->state->equilibrium;
    if (!equilibrium || !all->state->design->contact.given)
        return;
    const pzs_contact_face *face = &equilibrium->contact_face;
    const double height = pzs_face_height(&all->structure, face->face);
    for (int node = 0; node < all->mesh.nodes; node++) {
        const uint16_t own = (uint16_t)node;
        double global[3], force[1][3];
        equilibrium_contact_force(equilibrium, node, global);
        for (int axis = 0; axis < 3; axis++)
            force[0][axis] = vector_dot(face->triad[node][axis], global);
        pzs_face_scatter(&all->model, &own, 1, height, (const double(*)[3])force, all->contact);
    }
}

/* ---- totals ---------------------------------------------------------------- */

/*
 * Geometry of a deformed shell at a node, to sum nodal forces and moments. A force acts at `point`.
 * A nodal force f that is conjugate to the difference of both faces' displacements, divided by the
 * thickness, acts as the moment `director` x f.
 */
typedef struct force_place {
    double point[3];    /* mean position of both faces of the shell at the node (m) */
    double director[3]; /* vector from the inner to the outer face, divided by the thickness
                           (dimensionless) */
} force_place;

/* Transform a vector from the triad (local axes) of a node to the axes x, y and z. */
static void to_global(const surface_point *point, const double in_triad[3], double vector[3])
{
    for (int i = 0; i < 3; i++)
        vector[i] = in_triad[0] * point->triad[0][i] + in_triad[1] * point->triad[1][i] +
                    in_triad[2] * point->triad[2][i];
}

static force_place place_of(const all_dof *all, int node)
{
    const surface_point *point = &all->mesh.point[node];
    const double middle = (all->mesh.laminate.z[0] + all->mesh.laminate.z[1]) / 2;
    const uint16_t own = (uint16_t)node;
    double u[SHELL_MAX], mean[3], difference[3];
    force_place place;
    pzs_model_gather(&all->model, &own, 1, all->displacement, u);
    to_global(point, u, mean);
    to_global(point, u + 3, difference);
    for (int i = 0; i < 3; i++) {
        const double moves = all->state->equilibrium ? 1 : 0;
        place.point[i] = point->position[i] + middle * point->triad[2][i] + moves * mean[i];
        place.director[i] = point->triad[2][i] + moves * difference[i];
    }
    return place;
}

/*
 * Add the force and the moment of forces on the dof of one node to a total.
 *   force [dof_per_node] in  forces on the dof of the node (N and N m)
 *   about [3]            in  point about which the moment is taken (m)
 */
static void add_total(const all_dof *all, int node, const double *force, const force_place *place,
                      const double about[3], total_force *total)
{
    double own[SHELL_MAX], global[3], pair[3], arm[3], moment[2][3];
    memcpy(own, force, all->mesh.dof_per_node * sizeof *own);
    mesh_turn_to_triad(&all->mesh, node, own);
    to_global(&all->mesh.point[node], own, global);
    to_global(&all->mesh.point[node], own + 3, pair);
    for (int i = 0; i < 3; i++)
        arm[i] = place->point[i] - about[i];
    vector_cross(arm, global, moment[0]);
    vector_cross(place->director, pair, moment[1]);
    for (int i = 0; i < 3; i++) {
        total->force[i] += global[i];
        total->moment[i] += moment[0][i] + moment[1][i];
    }
}

/* Return the sum of a vector of forces over all dof, with moments about the origin. */
static total_force total_of(const all_dof *all, const double *force)
{
    const double origin[3] = {0, 0, 0};
    total_force total = {{0}, {0}};
    for (int node = 0; node < all->mesh.nodes; node++) {
        const force_place place = place_of(all, node);
        double own[SHELL_MAX];
        for (unsigned i = 0; i < all->mesh.dof_per_node; i++)
            own[i] = force[all->mesh.node_dof[(size_t)node * all->mesh.dof_per_node + i]];
        add_total(all, node, own, &place, origin, &total);
    }
    return total;
}

/* ---- supports -------------------------------------------------------------- */

/*
 * Return the index of the first of all supports of the scene that have the same name as a given
 * support. Supports of one name are counted together under this index.
 *   support in  index of the given support
 */
static int first_of_name(const design *design, int support)
{
    int first = 0;
    while (strcmp(design->support[first].name, design->support[support].name) != 0)
        first++;
    return first;
}

/*
 * Supports of the scene that hold a node: their number and their indices. Supports of one name
 * count as one.
 */
typedef struct node_holders {
    int count;
    int support[SHELL_MAX];
} node_holders;

/* List the supports that hold or prescribe a dof of a node. Supports of one name count as one. */
static node_holders holders_of(const all_dof *all, int node)
{
    const mesh *mesh = &all->mesh;
    node_holders holders = {0, {0}};
    for (unsigned i = 0; i < mesh->dof_per_node; i++) {
        const int holder = mesh->holder[(size_t)node * mesh->dof_per_node + i];
        const int first = holder < 0 ? -1 : first_of_name(all->state->design, holder);
        int k = 0;
        while (k < holders.count && holders.support[k] != first)
            k++;
        if (first >= 0 && k == holders.count)
            holders.support[holders.count++] = first;
    }
    return holders;
}

/*
 * Compute the centre of each support: the mean position of its nodes. Supports of one name count as
 * one, whose centre is stored at the index of the first of them.
 *   support  [supports of the scene] in/out  reactions, of which nodes and centre are set
 */
static void find_centres(const all_dof *all, support_reaction *support)
{
    for (int node = 0; node < all->mesh.nodes; node++) {
        const node_holders holders = holders_of(all, node);
        for (int k = 0; k < holders.count; k++) {
            support_reaction *own = &support[holders.support[k]];
            own->nodes++;
            for (int i = 0; i < 3; i++)
                own->centre[i] += (all->mesh.point[node].position[i] - own->centre[i]) / own->nodes;
        }
    }
}

/* Return the force of the supports on one dof (N or N m), 0 for a dof that no support holds. */
static double reaction_on(const all_dof *all, size_t dof)
{
    const uint16_t i = all->mesh.node_dof[dof];
    const bool is_constrained = all->state->design->mesh.node_dof[dof] == PZS_CONSTRAINED;
    if (!is_constrained && all->mesh.holder[dof] < 0)
        return 0;
    return all->internal[i] - all->load[i] - all->spring[i] - all->contact[i];
}

/*
 * Add the reactions on the dof of one node to three sums: that of the node, those of the supports
 * that hold it, and that of all supports.
 *   support [supports of the scene] in/out  reactions, at the index of the first support of each
 *       name
 */
static void add_node(const all_dof *all, int node, reactions *reactions, support_reaction *support)
{
    const double origin[3] = {0, 0, 0};
    const force_place place = place_of(all, node);
    total_force own = {{0}, {0}};
    memcpy(reactions->place[node], place.point, sizeof place.point);
    for (unsigned i = 0; i < all->mesh.dof_per_node; i++) {
        const size_t dof = (size_t)node * all->mesh.dof_per_node + i;
        const int holder = all->mesh.holder[dof];
        double force[SHELL_MAX] = {0};
        force[i] = reaction_on(all, dof);
        if (force[i] == 0)
            continue;
        add_total(all, node, force, &place, place.point, &own);
        add_total(all, node, force, &place, origin, &reactions->held);
        if (holder < 0)
            continue;
        support_reaction *of_name = &support[first_of_name(all->state->design, holder)];
        add_total(all, node, force, &place, of_name->centre, &of_name->total);
    }
    memcpy(reactions->node[node], own.force, sizeof own.force);
    memcpy(reactions->node[node] + 3, own.moment, sizeof own.moment);
}

/* Leave only those supports in the list of reactions that hold a dof, in the order of the scene. */
static void keep_supports(const design *design, reactions *reactions, support_reaction *support)
{
    for (int k = 0; k < design->supports; k++) {
        if (support[k].nodes == 0)
            continue;
        support[k].name = design->support[k].name;
        support[reactions->supports++] = support[k];
    }
    reactions->support = support;
}

static void add_sums(const all_dof *all, reactions *reactions)
{
    reactions->load = total_of(all, all->load);
    reactions->spring = total_of(all, all->spring);
    reactions->contact = total_of(all, all->contact);
    const total_force *const part[4] = {&reactions->held, &reactions->load, &reactions->spring,
                                        &reactions->contact};
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++) {
            reactions->sum.force[i] += part[k]->force[i];
            reactions->sum.moment[i] += part[k]->moment[i];
        }
}

/* ---- computation ----------------------------------------------------------- */

/*
 * Compute the internal forces of the elements and the forces of loads, springs and contact on all
 * dof, free and constrained. Returns 0, or -1 where memory runs out.
 */
static int open_all(all_dof *all, const reaction_state *state, double *internal)
{
    const design *design = state->design;
    memset(all, 0, sizeof *all);
    all->state = state;
    if (number_all(all) < 0 || allocate(all) < 0)
        return -1;
    attach(all);
    fill_prescribed(all);
    *internal = add_internal(all);
    for (int k = 0; k < design->loads; k++)
        add_load(all, &design->load[k], state->input_value[design->amplifiers + k]);
    add_followers(all);
    add_contact(all);
    return add_springs(all);
}

/*
 * Compute the reaction at every node, the force and moment of every support, and their sum over all
 * supports. Returns 0, or -1 where memory runs out.
 */
static int add_reactions(const all_dof *all, reactions *reactions)
{
    const design *design = all->state->design;
    const size_t nodes = (size_t)design->mesh.nodes;
    support_reaction *support = calloc((size_t)design->supports + 1, sizeof *support);
    reactions->node = calloc(nodes, sizeof *reactions->node);
    reactions->place = calloc(nodes, sizeof *reactions->place);
    if (!support || !reactions->node || !reactions->place) {
        free(support);
        return -1;
    }
    reactions->nodes = design->mesh.nodes;
    find_centres(all, support);
    for (int node = 0; node < reactions->nodes; node++)
        add_node(all, node, reactions, support);
    keep_supports(design, reactions, support);
    add_sums(all, reactions);
    return 0;
}

int reactions_compute(reactions *reactions, const reaction_state *state)
{
    all_dof all;
    double internal = 0;
    memset(reactions, 0, sizeof *reactions);
    if (!are_numbered(state->design))
        return 0;
    int status = open_all(&all, state, &internal);
    if (status == 0)
        status = add_reactions(&all, reactions);
    reactions->internal = internal;
    close_all(&all);
    if (status < 0)
        reactions_free(reactions);
    return status;
}

void reactions_free(reactions *reactions)
{
    free(reactions->node);
    free(reactions->place);
    free(reactions->support);
    memset(reactions, 0, sizeof *reactions);
}

/* ---- use --------------------------------------------------------------------- */

double reactions_at(const reactions *reactions, const mesh *mesh, const int *node, int count,
                    int component)
{
    double centre[3] = {0, 0, 0}, total[6] = {0};
    for (int k = 0; k < count; k++)
        for (int i = 0; i < 3; i++)
            centre[i] += mesh->point[node[k]].position[i] / count;
    for (int k = 0; k < count && reactions->nodes > 0; k++) {
        const double *own = reactions->node[node[k]];
        double arm[3], moment[3];
        for (int i = 0; i < 3; i++)
            arm[i] = reactions->place[node[k]][i] - centre[i];
        vector_cross(arm, own, moment);
        for (int i = 0; i < 6; i++)
            total[i] += own[i] + (i < 3 ? 0 : moment[i - 3]);
    }
    return reactions->nodes > 0 ? total[component] : (double)NAN;
}

double reactions_of(const reactions *reactions, const char *name, int component)
{
    for (int k = 0; k < reactions->supports; k++) {
        const total_force *total = &reactions->support[k].total;
        if (strcmp(reactions->support[k].name, name) == 0)
            return component < 3 ? total->force[component] : total->moment[component - 3];
    }
    return reactions->nodes > 0 ? 0 : (double)NAN;
}
