/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Equilibrium solver of a scene (equilibrium.h): tables of the stress resultants that voltages and
 * temperatures cause at zero strain (prescribed resultants), of follower loads and of contact.
 */
#include "equilibrium.h"
#include "../../lib/nonlinear/face.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/electrode.h"
#include "../../lib/model/model.h"
#include "../../lib/nonlinear/nonlinear.h"
#include "../../lib/model/shell.h"
#include "../mesh/corner_weight.h"
#include "load_forces.h"

/* ---- prescribed resultants -------------------------------------------- */

typedef struct resultant_builder {
    uint32_t *start;
    uint16_t *element, *which;
    double (*value)[LAMINATE_STRAINS];
    size_t entries, room, values, room_values;
    bool is_full; /* true after memory for the stress resultants that voltages and temperatures
                     cause at zero strains could not be allocated */
} resultant_builder;

/*
 * Return the index of the row of builder->value that equals the stress resultants h0 [10]; elements
 * with equal resultants share one row. Where no row is equal, h0 is appended.
 */
static size_t row_of_resultants(resultant_builder *builder, const double h0[LAMINATE_STRAINS])
{
    for (size_t i = builder->values; i > 0; i--)
        if (memcmp(builder->value[i - 1], h0, sizeof *builder->value) == 0)
            return i - 1;
    if (builder->values == builder->room_values) {
        builder->room_values = 2 * builder->room_values + 16;
        builder->value = design_grow(builder->value, builder->room_values, sizeof *builder->value,
                                     &builder->is_full);
    }
    if (!builder->is_full)
        memcpy(builder->value[builder->values], h0, sizeof *builder->value);
    return builder->is_full ? 0 : builder->values++;
}

static void append(resultant_builder *builder, int element, const double h0[LAMINATE_STRAINS])
{
    const size_t row = row_of_resultants(builder, h0);
    if (builder->entries == builder->room) {
        builder->room = 2 * builder->room + 64;
        builder->element = design_grow(builder->element, builder->room, sizeof *builder->element,
                                       &builder->is_full);
        builder->which =
            design_grow(builder->which, builder->room, sizeof *builder->which, &builder->is_full);
    }
    if (builder->is_full)
        return;
    builder->element[builder->entries] = (uint16_t)element;
    builder->which[builder->entries++] = (uint16_t)row;
}

/*
 * Append the stress resultants that the amplifiers of one actuator or the electrodes of one sensor
 * prescribe per unit of their inputs. `first` is the index of the first of these inputs.
 */
static void append_actuator(resultant_builder *builder, const mesh *mesh,
                            const scene_actuator *actuator, int first)
{
    double h0[LAMINATE_STRAINS];
    for (int cell = 0; cell < actuator->grid[0] * actuator->grid[1]; cell++) {
        for (int element = 0; element < mesh->elements; element++)
            if (design_actuation(mesh, actuator, cell, element, h0))
                append(builder, element, h0);
        builder->start[first + cell + 1] = (uint32_t)builder->entries;
    }
}

/*
 * Append, for each node of a bare face (face of a layer without electrodes), the stress resultants
 * that 1 V at this node causes at zero strain to the tables of prescribed resultants.
 */
static void append_potentials(resultant_builder *builder, const design *design)
{
    double h0[LAMINATE_STRAINS];
    for (int k = 0; k < design->bare.count; k++) {
        for (int element = 0; element < design->mesh.elements; element++)
            if (bare_faces_resultants(&design->bare, k, element, h0))
                append(builder, element, h0);
        builder->start[design->bare.first_input + k + 1] = (uint32_t)builder->entries;
    }
}

static pzs_status build_prescribed_resultants(equilibrium *equilibrium, double *value)
{
    const design *design = equilibrium->design;
    const int inputs = design->structure.input.count;
    resultant_builder builder;
    memset(&builder, 0, sizeof builder);
    builder.start = calloc((size_t)inputs + 1, sizeof *builder.start);
    if (!builder.start)
        return PZS_E_WORKSPACE;
    for (int k = 0; k < design->actuators; k++)
        append_actuator(&builder, &design->mesh, &design->actuator[k], design->actuator[k].first);
    for (int k = 0; k < design->sensor_first - design->amplifiers; k++) {
        double h0[LAMINATE_STRAINS];
        char error[SCENE_ERROR];
        if (k < design->loads && design->load[k].type == LOAD_TEMPERATURE &&
            design_load_values(&design->mesh, &design->load[k], value, error) == 0)
            for (int element = 0; element < design->mesh.elements; element++) {
                load_temperature_resultants(&design->mesh, &design->load[k], element, h0);
                append(&builder, element, h0);
            }
        builder.start[design->amplifiers + k + 1] = (uint32_t)builder.entries;
    }
    for (int k = 0; k < design->sensors; k++)
        append_actuator(&builder, &design->mesh, &design->sensor[k],
                        design->sensor_first + design->sensor[k].first);
    append_potentials(&builder, design);
    equilibrium->tables.resultants.start = builder.start;
    equilibrium->tables.resultants.element = builder.element;
    equilibrium->tables.resultants.which = builder.which;
    equilibrium->tables.resultants.value = (const double(*)[LAMINATE_STRAINS])builder.value;
    equilibrium->tables.resultants.values = (uint16_t)builder.values;
    return builder.is_full || builder.values > UINT16_MAX ? PZS_E_WORKSPACE : PZS_OK;
}

/* ---- follower loads --------------------------------------------------- */

static void set_corner(const mesh *mesh, int element, int corner, const pzs_follower *follower,
                       double *area, double lean[2])
{
    const surface_point *point = &mesh->point[mesh->element[element][corner]];
    const double z = mesh->laminate.z[follower->normal_face];
    double flat[2][2];
    const double size = load_chords(mesh, element, corner,
                                    follower->normal_face ? FACE_OUTER : FACE_INNER, flat, lean);
    if (follower->true_area)
        *area *= (1 + point->curvature[0] * z) * (1 + point->curvature[1] * z) / size;
}

/*
 * Set how a follower load (pressure that turns with the shell) is distributed over the corners of
 * an element. The force of pressure times area at a corner acts with the fraction share[0] on this
 * corner, share[1] on each neighbouring corner and share[2] on the opposite one.
 */
static void set_shares(pzs_follower *follower, int is_cartesian)
{
    for (int i = 0; i < 3; i++)
        follower->share[i] = (double)(4 >> i) / 36;
    if (!is_cartesian)
        return;
    follower->share[0] = 0.25;
    follower->share[1] = follower->share[2] = 0;
}

static pzs_status build_follower(equilibrium *equilibrium, const scene_load *load, uint16_t input)
{
    const mesh *mesh = &equilibrium->design->mesh;
    pzs_follower *follower = &equilibrium->follower[equilibrium->followers++];
    double *pressure = calloc((size_t)mesh->nodes, sizeof *pressure);
    double(*area)[4] = calloc((size_t)mesh->types, sizeof *area), (*lean)[4][2] = NULL;
    char error[SCENE_ERROR];
    follower->pressure = pressure;
    follower->area = (const double(*)[4])area;
    if (mesh->formulation.cartesian)
        lean = calloc((size_t)mesh->types, sizeof *lean);
    follower->lean = (const double(*)[4][2])lean;
    if (!pressure || !area || (mesh->formulation.cartesian && !lean))
        return PZS_E_WORKSPACE;
    if (design_load_values(mesh, load, pressure, error) < 0)
        return PZS_E_NONFINITE;
    follower->input = input;
    follower->load_face = 2; /* face on which the load acts: 0 inner, 1 outer, 2 middle surface */
    if (load->face == FACE_INNER || load->face == FACE_OUTER)
        follower->load_face = load->face == FACE_OUTER;
    follower->normal_face = load->follower == FOLLOWER_PRESSURE && load->face == FACE_INNER ? 0 : 1;
    follower->true_area = load->follower == FOLLOWER_PRESSURE;
    set_shares(follower, mesh->formulation.cartesian);
    for (int element = 0; element < mesh->elements; element++)
        for (int corner = 0; corner < 4; corner++) {
            const uint16_t type = mesh->element_type[element];
            area[type][corner] =
                mesh->place[type].area * corner_jacobian(&mesh->place[type], corner);
            if (lean)
                set_corner(mesh, element, corner, follower, &area[type][corner],
                           lean[type][corner]);
        }
    follower->format = PZS_TABLE_FORMAT;
    follower->scene = equilibrium->design->structure.scene;
    follower->crc = pzs_follower_crc(follower, &equilibrium->design->structure);
    return pzs_attach_follower(&equilibrium->solver,
                               &equilibrium->follower_load[equilibrium->followers - 1], follower);
}

/* ---- contact ---------------------------------------------------------- */

/*
 * Distance function of a rigid body whose surface is given by a formula psi = 0. The distance is
 * psi divided by the norm of its gradient, which is formed by finite differences with a step of
 * 1e-4 of the mesh size.
 */
static double psi_gap(const pzs_body *body, const double x[3], double normal[3],
                      double hessian[3][3])
{
    const expr *psi = body->own;
    const double step = body->radius * 1e-4;
    double value[27], slope = 0;
    for (int i = 0; i < 27; i++) {
        const expr_point at = {x[0] + step * (i / 9 - 1), x[1] + step * (i / 3 % 3 - 1),
                               x[2] + step * (i % 3 - 1), 0, 0};
        value[i] = expr_value(psi, &at);
    }
    const double *v = &value[13];
    const int offset[3] = {9, 3, 1};
    for (int i = 0; i < 3; i++) {
        normal[i] = (v[offset[i]] - v[-offset[i]]) / (2 * step);
        slope += normal[i] * normal[i];
    }
    slope = slope > 0 ? sqrt(slope) : 1;
    for (int i = 0; i < 3; i++) {
        normal[i] /= slope;
        for (int j = 0; j < 3; j++)
            hessian[i][j] = (i == j ? v[offset[i]] - 2 * v[0] + v[-offset[i]]
                                    : (v[offset[i] + offset[j]] - v[offset[i] - offset[j]] -
                                       v[offset[j] - offset[i]] + v[-offset[i] - offset[j]]) /
                                          4) /
                            (step * step * slope);
    }
    return *v / slope;
}

static void build_body(equilibrium *equilibrium, double size)
{
    const scene_body *from = &equilibrium->design->contact.body;
    pzs_body *body = &equilibrium->body;
    memcpy(body->point, from->point, sizeof body->point);
    memcpy(body->axis, from->type == BODY_PLANE ? from->normal : from->axis, sizeof body->axis);
    body->radius = from->type == BODY_PSI ? size : from->radius;
    body->own = from->value;
    switch (from->type) {
    case BODY_PLANE: body->gap = pzs_gap_plane; break;
    case BODY_CYLINDER: body->gap = pzs_gap_cylinder; break;
    case BODY_SPHERE: body->gap = pzs_gap_sphere; break;
    default: body->gap = psi_gap;
    }
    body->crc = pzs_body_crc(body);
}

static pzs_status build_contact(equilibrium *equilibrium, uint16_t input)
{
    const mesh *mesh = &equilibrium->design->mesh;
    const scene_contact *contact = &equilibrium->design->contact;
    const size_t nodes = (size_t)mesh->nodes, bytes = PZS_CONTACT_BYTES(nodes);
    double(*place)[3] = calloc(nodes, sizeof *place), (*triad)[3][3] = calloc(nodes, sizeof *triad);
    double *area = calloc(nodes, sizeof *area), low[3], high[3];
    equilibrium->contact_face.place = (const double(*)[3])place;
    equilibrium->contact_face.triad = (const double(*)[3][3])triad;
    equilibrium->contact_face.area = area;
    equilibrium->contact_work = malloc(bytes);
    equilibrium->contact_bytes = bytes;
    if (!place || !triad || !area || !equilibrium->contact_work)
        return PZS_E_WORKSPACE;
    equilibrium->contact_face.face = contact->face == FACE_OUTER;
    equilibrium->contact_face.input = input;
    memcpy(equilibrium->contact_face.motion, contact->move,
           sizeof equilibrium->contact_face.motion);
    mesh_node_areas(mesh, area);
    for (size_t node = 0; node < nodes; node++)
        for (int i = 0; i < 3; i++) {
            place[node][i] =
                mesh->point[node].position[i] +
                mesh->laminate.z[equilibrium->contact_face.face] * mesh->point[node].triad[2][i];
            memcpy(triad[node][i], mesh->point[node].triad[i], sizeof triad[node][i]);
            low[i] = node ? fmin(low[i], place[node][i]) : place[node][i];
            high[i] = node ? fmax(high[i], place[node][i]) : place[node][i];
        }
    for (int i = 0; i < 3; i++)
        equilibrium->contact_face.size = fmax(equilibrium->contact_face.size, high[i] - low[i]);
    build_body(equilibrium, equilibrium->contact_face.size);
    equilibrium->contact_face.format = PZS_TABLE_FORMAT;
    equilibrium->contact_face.scene = equilibrium->design->structure.scene;
    equilibrium->contact_face.crc =
        pzs_contact_crc(&equilibrium->contact_face, &equilibrium->design->structure);
    const pzs_status status =
        pzs_attach_contact(&equilibrium->solver, &equilibrium->contact, &equilibrium->contact_face,
                           &equilibrium->body, equilibrium->contact_work, bytes);
    equilibrium->contact.settings.stiffness = contact->stiffness;
    return status;
}

/*
 * Compute the position of a node of the contact face relative to the contact body before its motion
 * (m).
 */
static void contact_place(const equilibrium *equilibrium, int node, double place[3])
{
    const pzs_contact_face *face = &equilibrium->contact_face;
    const pzs_solver *solver = &equilibrium->solver;
    const double height = pzs_face_height(solver->state.model->state.structure, face->face);
    const uint16_t own = (uint16_t)node;
    double moved[1][3];
    pzs_face_gather(solver->state.model, &own, 1, height, solver->info.displacement, moved);
    for (int i = 0; i < 3; i++) {
        place[i] = face->place[node][i] - solver->info.input_value[face->input] * face->motion[i];
        for (int axis = 0; axis < 3; axis++)
            place[i] += moved[0][axis] * face->triad[node][axis][i];
    }
}

void equilibrium_contact_force(const equilibrium *equilibrium, int node, double force[3])
{
    const double push =
        equilibrium->contact_face.area[node] * equilibrium->contact.info.pressure[node];
    double place[3], normal[3] = {0, 0, 0}, hessian[3][3];
    contact_place(equilibrium, node, place);
    if (push != 0)
        (void)equilibrium->body.gap(&equilibrium->body, place, normal, hessian);
    for (int i = 0; i < 3; i++)
        force[i] = push * normal[i];
}

/* Advice to the user on how to prevent the rigid body of a contact from penetrating the shell. */
static const char *penetration_cure(const pzs_contact *contact, pzs_status status)
{
    if (status == PZS_W_BEHIND)
        return "the shell has passed through itself, or both of its faces would touch";
    if (contact->info.side != contact->state.face->face)
        return "it comes from behind: let contact.face be the face that it meets, or move the body";
    if (contact->info.penetration == PZS_PENETRATION_BETWEEN_NODES)
        return "refine the mesh there, or enlarge the body";
    if (contact->info.penetration == PZS_PENETRATION_PASSED)
        return "raise equilibrium.load_steps, or refine the mesh there";
    return "the node is held or faces away: start the body clear of the shell";
}

void equilibrium_penetration_text(const equilibrium *equilibrium, pzs_status status, char *text)
{
    const mesh *mesh = &equilibrium->design->mesh;
    const pzs_contact *contact = &equilibrium->contact;
    const char *face = contact->info.side ? "outer" : "inner";
    char unit[SCENE_NAME + 1];
    char what[SCENE_NAME + 128];
    const char *length_unit = equilibrium->design->units.length;
    snprintf(unit, sizeof unit, "%s%s", *length_unit ? " " : "", length_unit);
    if (contact->info.penetration == PZS_PENETRATION_PASSED)
        snprintf(what, sizeof what, "it passes through the %s face in one load step", face);
    else if (contact->info.penetration == PZS_PENETRATION_BETWEEN_NODES)
        snprintf(what, sizeof what, "between the nodes, %.3g%s deep in the %s face",
                 contact->info.depth, unit, face);
    else
        snprintf(what, sizeof what, "%.3g%s deep at node %u of the %s face", contact->info.depth,
                 unit, contact->info.node, face);
    const int length = snprintf(
        text, SCENE_ERROR, "element %u (%s), at (%.4g, %.4g, %.4g): %s; %s", contact->info.element,
        mesh_element_text(mesh, contact->info.element).text, contact->info.spot[0],
        contact->info.spot[1], contact->info.spot[2], what, penetration_cure(contact, status));
    if (length >= SCENE_ERROR)
        memcpy(&text[SCENE_ERROR - 4], "...", 4);
}

/* ---- saved states ----------------------------------------------------- */

enum { PIECES = 6 };

typedef struct piece {
    void *at;
    size_t bytes;
} piece;

static void list_pieces(const equilibrium *p, piece piece[PIECES])
{
    equilibrium *q = (equilibrium *)p;
    piece[0].at = &q->solver, piece[0].bytes = sizeof q->solver;
    piece[1].at = &q->contact, piece[1].bytes = sizeof q->contact;
    piece[2].at = &q->circuit, piece[2].bytes = sizeof q->circuit;
    piece[3].at = q->work, piece[3].bytes = q->work_bytes;
    piece[4].at = q->contact_work, piece[4].bytes = q->contact_bytes;
    piece[5].at = q->circuit_work, piece[5].bytes = q->circuit_bytes;
}

size_t equilibrium_state_bytes(const equilibrium *equilibrium)
{
    piece piece[PIECES];
    size_t all = 0;
    list_pieces(equilibrium, piece);
    for (int i = 0; i < PIECES; i++)
        all += piece[i].bytes;
    return all;
}

void equilibrium_save(const equilibrium *equilibrium, void *state)
{
    piece piece[PIECES];
    unsigned char *to = state;
    list_pieces(equilibrium, piece);
    for (int i = 0; i < PIECES; to += piece[i++].bytes)
        if (piece[i].bytes > 0)
            memcpy(to, piece[i].at, piece[i].bytes);
}

/*
 * Restore a saved state of the equilibrium solver. The factored stiffness matrix is not restored,
 * because it belongs to another deformed shape; the computation of the next equilibrium factors its
 * own.
 */
void equilibrium_restore(equilibrium *equilibrium, const void *state)
{
    piece piece[PIECES];
    const unsigned char *from = state;
    list_pieces(equilibrium, piece);
    for (int i = 0; i < PIECES; from += piece[i++].bytes)
        if (piece[i].bytes > 0)
            memcpy(piece[i].at, from, piece[i].bytes);
    equilibrium->solver.state.model->state.stage = STAGE_READY;
}

bool equilibrium_is_factored(const equilibrium *equilibrium)
{
    return equilibrium->solver.state.model->state.stage == STAGE_AT_SHAPE;
}

/* ---- open ------------------------------------------------------------- */

/*
 * Set full_input, the input values of the scene at full load: applied voltages (V), and load
 * factors of 1. A follower load, which turns with the shell, has two inputs: the one in the list of
 * loads, which would not turn, stays 0; the one among the extra inputs is 1.
 */
static void set_full(equilibrium *equilibrium)
{
    const design *design = equilibrium->design;
    design_applied(design, equilibrium->full_input);
    for (int k = 0; k < design->loads; k++)
        equilibrium->full_input[design->amplifiers + k] = design->load[k].follower == FOLLOWER_NONE;
    for (int k = design->amplifiers + design->loads; k < design->sensor_first; k++)
        equilibrium->full_input[k] = 1;
}

static pzs_status start(equilibrium *equilibrium, pzs_model *model)
{
    const design *design = equilibrium->design;
    const pzs_structure *structure = &design->structure;
    const size_t bytes =
        PZS_SOLVER_BYTES(structure->free_dof, structure->elements, structure->input.count);
    int input = design->amplifiers + design->loads;
    equilibrium->full_input =
        calloc((size_t)structure->input.count + 1, sizeof *equilibrium->full_input);
    equilibrium->follower = calloc((size_t)design->loads + 1, sizeof *equilibrium->follower);
    equilibrium->follower_load =
        calloc((size_t)design->loads + 1, sizeof *equilibrium->follower_load);
    equilibrium->work = malloc(bytes);
    equilibrium->work_bytes = bytes;
    double *value = calloc((size_t)structure->nodes, sizeof *value);
    pzs_status status = equilibrium->full_input && equilibrium->follower &&
                                equilibrium->follower_load && equilibrium->work && value
                            ? build_prescribed_resultants(equilibrium, value)
                            : PZS_E_WORKSPACE;
    free(value);
    equilibrium->tables.format = PZS_TABLE_FORMAT;
    equilibrium->tables.scene = structure->scene;
    for (int k = 0; k < design->loads; k++)
        input += design->load[k].follower != FOLLOWER_NONE;
    equilibrium->tables.prescribed.count = (uint16_t)design->mesh.prescribed_count;
    equilibrium->tables.prescribed.input = (uint16_t)input;
    equilibrium->tables.prescribed.dof = design->mesh.prescribed_dof;
    equilibrium->tables.prescribed.value = design->mesh.prescribed_value;
    equilibrium->tables.crc =
        status == PZS_OK ? pzs_nonlinear_crc(&equilibrium->tables, structure) : 0;
    return status == PZS_OK ? pzs_solver_init(&equilibrium->solver, model, &equilibrium->tables,
                                              equilibrium->work, bytes)
                            : status;
}

static pzs_status build_circuit(equilibrium *equilibrium)
{
    const design *design = equilibrium->design;
    const uint32_t open = pzs_electrode_open_count(&design->electrodes);
    const size_t bytes = PZS_CIRCUIT_BYTES(design->electrodes.count, open);
    if (open == 0)
        return PZS_OK;
    equilibrium->circuit_work = malloc(bytes);
    equilibrium->circuit_bytes = bytes;
    return equilibrium->circuit_work
               ? pzs_attach_circuit(&equilibrium->solver, &equilibrium->circuit,
                                    &design->electrodes, equilibrium->circuit_work, bytes)
               : PZS_E_WORKSPACE;
}

static pzs_status attach(equilibrium *equilibrium)
{
    const design *design = equilibrium->design;
    int input = design->amplifiers + design->loads;
    pzs_status status = build_circuit(equilibrium);
    for (int k = 0; k < design->loads && status == PZS_OK; k++)
        if (design->load[k].follower != FOLLOWER_NONE)
            status = build_follower(equilibrium, &design->load[k], (uint16_t)input++);
    input += design->mesh.prescribed_count > 0;
    return status == PZS_OK && design->contact.given ? build_contact(equilibrium, (uint16_t)input)
                                                     : status;
}

pzs_status equilibrium_open(equilibrium *equilibrium, const design *design, pzs_model *model)
{
    memset(equilibrium, 0, sizeof *equilibrium);
    equilibrium->design = design;
    pzs_status status = start(equilibrium, model);
    if (status == PZS_OK)
        status = attach(equilibrium);
    if (status != PZS_OK) {
        equilibrium_close(equilibrium);
        return status;
    }
    const scene_equilibrium *choice = &design->equilibrium;
    set_full(equilibrium);
    equilibrium->solver.settings.load_steps = (uint16_t)choice->load_steps;
    equilibrium->solver.settings.tolerance = choice->tolerance;
    equilibrium->solver.settings.extrapolated_iterations =
        (uint16_t)choice->extrapolated_iterations;
    if (choice->ramp_solves > 0)
        equilibrium->solver.settings.ramp_solves = (uint16_t)choice->ramp_solves;
    equilibrium->solver.settings.solve_limit = (uint32_t)choice->linear_solves;
    return PZS_OK;
}

void equilibrium_close(equilibrium *equilibrium)
{
    design_release(equilibrium->tables.resultants.start);
    design_release(equilibrium->tables.resultants.element);
    design_release(equilibrium->tables.resultants.which);
    design_release(equilibrium->tables.resultants.value);
    for (int k = 0; k < equilibrium->followers; k++) {
        design_release(equilibrium->follower[k].pressure);
        design_release(equilibrium->follower[k].area);
        design_release(equilibrium->follower[k].lean);
    }
    design_release(equilibrium->contact_face.place);
    design_release(equilibrium->contact_face.triad);
    design_release(equilibrium->contact_face.area);
    free(equilibrium->follower);
    free(equilibrium->follower_load);
    free(equilibrium->full_input);
    free(equilibrium->work);
    free(equilibrium->contact_work);
    free(equilibrium->circuit_work);
    memset(equilibrium, 0, sizeof *equilibrium);
}
