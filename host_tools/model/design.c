/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Inputs (columns) and outputs (rows) of a scene as sparse vectors over the degrees of freedom of
 * its mesh.
 */
#include "design.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/guard.h"
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"
#include "../mesh/corner_weight.h"
#include "../mesh/springs.h"
#include "../quads/vector.h"
#include "../scene/outline_shares.h"
#include "load_forces.h"
#include "node_forces.h"
#include "output_calls.h"

/* ---- sparse rows under construction ----------------------------------- */

typedef struct row_builder {
    uint32_t *start;
    uint16_t *dof;
    double *value;
    size_t rows, terms, room_rows, room_terms;
    bool is_full; /* true if an allocation of memory for the sparse rows has failed */
} row_builder;

void *design_grow(void *old, size_t count, size_t size, bool *full)
{
    void *bigger = realloc(old, count * size);
    if (!bigger)
        *full = true;
    return bigger ? bigger : old;
}

void design_release(const void *table)
{
    union {
        const void *table;
        void *memory;
    } owned = {table};
    free(owned.memory);
}

/* Append a dense row [dof] to a sparse matrix, as a list of the nonzero entries of the row. */
static void append_row(row_builder *builder, const double *dense, int dof)
{
    if (builder->rows + 2 > builder->room_rows) {
        builder->room_rows = 2 * builder->room_rows + 64;
        builder->start = design_grow(builder->start, builder->room_rows, sizeof *builder->start,
                                     &builder->is_full);
    }
    if (builder->terms + (size_t)dof > builder->room_terms) {
        builder->room_terms = 2 * builder->room_terms + (size_t)dof;
        builder->dof =
            design_grow(builder->dof, builder->room_terms, sizeof *builder->dof, &builder->is_full);
        builder->value = design_grow(builder->value, builder->room_terms, sizeof *builder->value,
                                     &builder->is_full);
    }
    if (builder->is_full)
        return;
    builder->start[builder->rows++] = (uint32_t)builder->terms;
    for (int i = 0; i < dof; i++)
        if (dense[i] != 0) {
            builder->dof[builder->terms] = (uint16_t)i;
            builder->value[builder->terms++] = dense[i];
        }
    builder->start[builder->rows] = (uint32_t)builder->terms;
}

static void rows_of(const row_builder *builder, pzs_rows *rows)
{
    rows->count = (uint16_t)builder->rows;
    rows->start = builder->start;
    rows->dof = builder->dof;
    rows->value = builder->value;
}

/* ---- outputs ---------------------------------------------------------- */

/*
 * Weights of the dof of a node in a displacement component (design.h). The displacement of the
 * middle surface also depends on the seventh dof, its displacement along the thickness direction
 * relative to the faces.
 */
void design_output_weights(const mesh *mesh, int node, scene_component component, scene_face face,
                           double weight[7])
{
    double unit[3];
    node_direction(&mesh->point[node], component, unit);
    node_face_weights(mesh, face, unit, weight);
    if (face == FACE_MIDDLE)
        weight[6] = mesh->laminate.thickness * unit[2];
}

double design_displacement(const mesh *mesh, const double *displacement, int node,
                           scene_component component, scene_face face)
{
    double weight[7];
    design_output_weights(mesh, node, component, face, weight);
    return node_sum(mesh, node, weight, displacement);
}

void design_vectors(const mesh *mesh, const double *displacement, double *vector)
{
    for (int i = 0; i < 3 * mesh->nodes; i++) {
        const scene_component component = (scene_component)((int)COMPONENT_X + i % 3);
        vector[i] = design_displacement(mesh, displacement, i / 3, component, FACE_MIDDLE);
    }
}

/*
 * Append the sparse row (output per unit of each free dof) of an output that is a linear function
 * of the displacement, at one node.
 */
static void append_output(const mesh *mesh, const scene_output *output, int node, row_builder *rows,
                          double *dense)
{
    memset(dense, 0, (size_t)mesh->free_dof * sizeof *dense);
    output_calls_of(output)->add_row(mesh, output, node, dense);
    append_row(rows, dense, mesh->free_dof);
}

int design_pieces(const design *design, const scene_patches *patches, int electrode, int element,
                  bool draws_outline, outline_draw *draw, void *context)
{
    return outline_pieces(design->scene, patches, electrode, element, draws_outline, draw, context);
}

int design_row(const design *design, int target)
{
    const scene_influence *influence = &design->scene->influence;
    return influence->given ? influence->row[target] : target;
}

double design_target_rms(const design *design)
{
    double squares = 0;
    for (int i = 0; i < design->targets; i++)
        squares += design->target[i] * design->target[i] / design->targets;
    return sqrt(squares);
}

double design_target_gap(const design *design)
{
    double most = 0;
    for (int i = 0; i < design->targets; i++) {
        const expr_point place = mesh_place(&design->mesh, design->target_node[i]);
        most = fmax(most, expr_gap(design->scene->target.value, &place));
    }
    return most;
}

/*
 * Write to `error` that the target value of a controlled displacement is not a finite number.
 * Returns -1.
 */
static int refuse_value(const design *design, int target, scene_at at, char *error)
{
    const expr_point place = mesh_place(&design->mesh, design->target_node[target]);
    if (isnan(place.theta1))
        return scene_fault(at, error,
                           "the target value or free function is not a finite number at output "
                           "%d, x = %g, y = %g; correct its formula",
                           design_row(design, target) + 1, place.x, place.y);
    return scene_fault(at, error,
                       "the target value or free function is not a finite number at %s; correct "
                       "its formula",
                       mesh_node_text(&design->mesh, design->target_node[target]).text);
}

int design_target_values(const design *design, const expr *wanted, scene_at at, double *value,
                         char *error)
{
    const mesh *mesh = &design->mesh;
    const int rows = expr_rows(wanted);
    if (rows >= 0 && !design->scene->influence.given && rows != design->targets)
        return scene_fault(at, error,
                           "%d values for %d target nodes; give one for each, in the order of the "
                           "tables, or coordinates beside the values",
                           rows, design->targets);
    for (int i = 0; i < design->targets; i++) {
        const expr_point place = mesh_place(mesh, design->target_node[i]);
        value[i] = expr_row_value(wanted, &place, design_row(design, i));
        if (!isfinite(value[i]))
            return refuse_value(design, i, at, error);
    }
    design_take_free(design, value);
    return 0;
}

/*
 * Build output rows, target values and weights of the target nodes. Weights by area are scaled to a
 * mean square of 1. Returns 0, or -1 with error filled.
 */
static int build_targets(design *design, row_builder *rows, double *dense, int *node, char *error)
{
    const scene_target *target = &design->scene->target;
    if (!target->given)
        return 0;
    const mesh *mesh = &design->mesh;
    design->targets = mesh_select(mesh, &target->what.where, node);
    design->target = calloc((size_t)design->targets, sizeof *design->target);
    design->weight = calloc((size_t)design->targets, sizeof *design->weight);
    design->target_node = calloc((size_t)design->targets, sizeof *design->target_node);
    double *area = calloc((size_t)mesh->nodes, sizeof *area), sum = 0;
    if (!design->target || !design->weight || !design->target_node || !area) {
        free(area);
        return scene_fault(target->what.at, error, "%d target nodes do not fit into memory",
                           design->targets);
    }
    mesh_node_areas(mesh, area);
    for (int i = 0; i < design->targets; i++)
        sum += area[node[i]];
    for (int i = 0; i < design->targets; i++) {
        design->target_node[i] = node[i];
        design->weight[i] = target->weight_area ? sqrt(area[node[i]] * design->targets / sum) : 1;
        append_output(mesh, &target->what, node[i], rows, dense);
    }
    free(area);
    return 0;
}

/*
 * Whether a named output belongs to mesh nodes; voltages and charges of electrodes do not, nor does
 * the resultant contact force on the whole shell.
 */
static bool has_place(const scene_output *output)
{
    return output->where.at.column > 0;
}

/*
 * List the mesh nodes of the named outputs of the scene.
 *   node [nodes] out  work array
 */
static int build_places(design *design, int *node)
{
    int entries = 0;
    design->place_first = calloc((size_t)design->scene->outputs + 1, sizeof *design->place_first);
    if (!design->place_first)
        return -1;
    for (int k = 0; k < design->scene->outputs; k++) {
        const scene_output *output = &design->scene->output[k];
        design->place_first[k] = entries;
        entries += has_place(output) ? mesh_select(&design->mesh, &output->where, node) : 0;
    }
    design->place_first[design->scene->outputs] = entries;
    design->place_node = calloc((size_t)entries + 1, sizeof *design->place_node);
    for (int k = 0; design->place_node && k < design->scene->outputs; k++)
        if (has_place(&design->scene->output[k]))
            mesh_select(&design->mesh, &design->scene->output[k].where,
                        design->place_node + design->place_first[k]);
    return design->place_node ? 0 : -1;
}

/*
 * Append the rows of a named output that is a linear function of the displacement, one for each of
 * its nodes; a row holds the output per unit of each free dof. Outputs of stresses and reactions
 * have no rows, because they also depend on voltages and loads. Returns 0, or -1 with error filled.
 */
static int append_named(const design *design, int k, row_builder *rows, double *dense, char *error)
{
    const mesh *mesh = &design->mesh;
    const scene_output *output = &design->scene->output[k];
    const output_calls *calls = output_calls_of(output);
    for (int i = design->place_first[k]; i < design->place_first[k + 1]; i++) {
        const int node = design->place_node[i];
        if (calls->check && calls->check(mesh, output, node, error) < 0)
            return -1;
        if (calls->add_row)
            append_output(mesh, output, node, rows, dense);
    }
    return 0;
}

static int build_named(design *design, row_builder *rows, double *dense, int *node, char *error)
{
    design->named_first = calloc((size_t)design->scene->outputs + 1, sizeof *design->named_first);
    if (!design->named_first || build_places(design, node) < 0)
        return scene_fault(design->scene->at_surface, error,
                           "%d outputs do not fit into memory; name fewer nodes",
                           design->scene->outputs);
    for (int k = 0; k < design->scene->outputs; k++) {
        design->named_first[k] = (int)rows->rows;
        if (append_named(design, k, rows, dense, error) < 0)
            return -1;
    }
    design->named_first[design->scene->outputs] = (int)rows->rows;
    return 0;
}

/* ---- inputs ----------------------------------------------------------- */

/*
 * Add `factor` times the stress resultants of a unit voltage or temperature in one element, times
 * the area of the element.
 *   ply     in      ply with the voltage or temperature; negative: all plies change by 1 K
 *   is_heat in      false: 1 V across the ply; true: the ply changes by 1 K
 *   h0 [10] in/out  resultants (N m), in the order of the ten strains (laminate.h)
 */
static void add_unit_resultants(const mesh *mesh, int element, int ply, bool is_heat, double factor,
                                double h0[LAMINATE_STRAINS])
{
    const laminate_field unit = {
        .ply = ply, .temperature = {1, 1}, .axis = is_heat ? LAMINATE_HEATED_PLY : LAMINATE_ACROSS};
    double one[LAMINATE_STRAINS];
    laminate_resultants(&mesh->laminate, &mesh->scene->element,
                        &mesh->place[mesh->element_type[element]], &unit, one);
    for (int i = 0; i < LAMINATE_STRAINS; i++)
        h0[i] += factor * one[i];
}

/*
 * Index of the patch that contains an element, for patches that consist of whole elements; the
 * patches of a grid are numbered with the second grid index fastest. Returns -1 where no patch
 * contains the element.
 */
static int patch_in(const mesh *mesh, int element, const scene_patches *patches)
{
    double t[2][2];
    const double *range[2] = {patches->theta1, patches->theta2};
    int patch = 0;
    if (patches->patch)
        return patches->patch[element];
    mesh_cell(mesh, element, t[0], t[1]);
    for (int axis = 0; axis < 2; axis++) {
        const double share = ((t[axis][0] + t[axis][1]) / 2 - range[axis][0]) /
                             (range[axis][1] - range[axis][0]) * patches->grid[axis];
        if (!(share > 0 && share < patches->grid[axis]))
            return -1;
        patch = patch * patches->grid[axis] + (int)share;
    }
    return patch;
}

int design_patches_in(const mesh *mesh, int element, const scene_patches *patches,
                      design_part *list)
{
    if (patches->outlines) {
        const scene_outlines *outlines = patches->outlines;
        const size_t first = outlines->start[element], end = outlines->start[element + 1];
        for (size_t i = first; i < end && list; i++)
            list[i - first] = (design_part){outlines->electrode_of[i], outlines->share[i]};
        return (int)(end - first);
    }
    const int patch = patch_in(mesh, element, patches);
    if (patch >= 0 && list)
        *list = (design_part){patch, 1};
    return patch >= 0;
}

/* Part of an element that a patch covers, from 0 to 1. */
static double share_of(const mesh *mesh, int element, const scene_patches *patches, int patch)
{
    if (patches->outlines)
        return outline_share(patches->outlines, patch, element);
    return patch_in(mesh, element, patches) == patch;
}

int design_actuation(const mesh *mesh, const scene_actuator *actuator, int cell, int element,
                     double h0[LAMINATE_STRAINS])
{
    int acts = scene_heats_all(actuator);
    memset(h0, 0, LAMINATE_STRAINS * sizeof *h0);
    if (scene_heats_all(actuator))
        add_unit_resultants(mesh, element, -1, true, 1, h0);
    for (int k = 0; k < actuator->drives; k++) {
        const scene_patches *patches = &mesh->scene->patches[actuator->drive[k].patches];
        const double share = share_of(mesh, element, patches, cell);
        if (!(share > 0))
            continue;
        add_unit_resultants(mesh, element, patches->layer, actuator->is_temperature,
                            share * actuator->drive[k].factor, h0);
        acts = 1;
    }
    return acts;
}

/*
 * Append columns of nodal forces per unit of input (1 V or 1 K): one for each amplifier of an
 * actuator, or electrode of a sensor. A column is the sum over the patches of the amplifier, each
 * times the factor that the scene file gives to its voltage.
 */
static void patch_columns(const mesh *mesh, const scene_actuator *actuator, row_builder *columns,
                          double *dense)
{
    double h0[LAMINATE_STRAINS];
    for (int cell = 0; cell < actuator->grid[0] * actuator->grid[1]; cell++) {
        memset(dense, 0, (size_t)mesh->free_dof * sizeof *dense);
        for (int element = 0; element < mesh->elements; element++)
            if (design_actuation(mesh, actuator, cell, element, h0))
                node_add_resultants(mesh, element, h0, dense);
        append_row(columns, dense, mesh->free_dof);
    }
}

/*
 * Append one column of nodal forces per volt for each node of the bare faces (faces of a layer
 * without electrodes).
 */
static void potential_columns(const design *design, row_builder *columns, double *dense)
{
    double h0[LAMINATE_STRAINS];
    for (int k = 0; k < design->bare.count; k++) {
        memset(dense, 0, (size_t)design->mesh.free_dof * sizeof *dense);
        for (int element = 0; element < design->mesh.elements; element++)
            if (bare_faces_resultants(&design->bare, k, element, h0))
                node_add_resultants(&design->mesh, element, h0, dense);
        append_row(columns, dense, design->mesh.free_dof);
    }
}

/*
 * Append one column of nodal forces per unit of input for each piezoelectric stack of an actuator.
 * The forces are the blocked force of the stack, along its direction.
 */
static void stack_columns(const mesh *mesh, int actuator, row_builder *columns, double *dense)
{
    const int item = springs_item(mesh->scene, actuator);
    for (int row = mesh->springs.first[item]; row < mesh->springs.first[item + 1]; row++) {
        memset(dense, 0, (size_t)mesh->free_dof * sizeof *dense);
        springs_add(&mesh->springs, row, mesh->scene->actuator[actuator].stacks->force, dense);
        append_row(columns, dense, mesh->free_dof);
    }
}

int design_load_values(const mesh *mesh, const scene_load *load, double *value, char *error)
{
    for (int node = 0; node < mesh->nodes; node++) {
        const expr_point at = mesh_place(mesh, node);
        value[node] = expr_value(load->value, &at);
        if (!isfinite(value[node]))
            return scene_fault(load->at, error,
                               "the load is not a finite number at %s; correct its formula",
                               mesh_node_text(mesh, node).text);
    }
    return 0;
}

/*
 * Return the number of inputs that exist only under nonlinear kinematics: one for each follower
 * load, one for prescribed displacements and one for the motion of a contact's body.
 */
static int extras_of(const design *design)
{
    const scene *scene = design->scene;
    int extras = (design->mesh.prescribed_count > 0) + scene->contact.given;
    for (int k = 0; k < scene->loads; k++)
        extras += scene->load[k].follower != FOLLOWER_NONE;
    return scene->kinematics == KINEMATICS_LINEAR ? 0 : extras;
}

/*
 * Check that a load has no moment about the normal of the shell, about which the shell has no
 * rotation. Returns 0, or -1 with error filled.
 */
static int check_moment(const mesh *mesh, const scene_load *load, char *error)
{
    double weight[7];
    if (load->type != LOAD_MOMENT)
        return 0;
    const int node = mesh_point_node(mesh, &load->where);
    if (springs_rotation(&mesh->point[node], &load->about, weight) == 0)
        return 0;
    return scene_fault(load->at, error,
                       "the axis of the moment is normal to the surface at %s, where a shell has "
                       "no rotation; choose an axis in the surface, or use two forces",
                       mesh_node_text(mesh, node).text);
}

static int build_inputs(design *design, row_builder *columns, double *dense, double *value,
                        char *error)
{
    const scene *scene = design->scene;
    const mesh *mesh = &design->mesh;
    for (int k = 0; k < scene->actuators; k++)
        if (scene->actuator[k].stacks)
            stack_columns(mesh, k, columns, dense);
        else
            patch_columns(mesh, &scene->actuator[k], columns, dense);
    design->amplifiers = (int)columns->rows;
    for (int k = 0; k < scene->loads; k++) {
        if (design_load_values(mesh, &scene->load[k], value, error) < 0 ||
            check_moment(mesh, &scene->load[k], error) < 0)
            return -1;
        memset(dense, 0, (size_t)mesh->free_dof * sizeof *dense);
        load_forces_add(mesh, &scene->load[k], value, dense);
        append_row(columns, dense, mesh->free_dof);
    }
    design->loads = scene->loads;
    memset(dense, 0, (size_t)mesh->free_dof * sizeof *dense);
    for (int k = 0; k < extras_of(design); k++)
        append_row(columns, dense, mesh->free_dof);
    design->sensor_first = (int)columns->rows;
    for (int k = 0; k < scene->sensors; k++)
        patch_columns(mesh, &scene->sensor[k], columns, dense);
    design->bare.first_input = (int)columns->rows;
    if (bare_faces_build(&design->bare, &design->mesh, design->scene, error) < 0)
        return -1;
    potential_columns(design, columns, dense);
    return 0;
}

/* ---- structure -------------------------------------------------------- */

static void fill_springs(const mesh_springs *springs, pzs_structure *structure)
{
    structure->spring.count = (uint16_t)springs->count;
    structure->spring.start = springs->start;
    structure->spring.dof = springs->dof;
    structure->spring.value = springs->value;
    structure->spring_stiffness = springs->stiffness;
}

static void fill_structure(design *design, const row_builder *columns, const row_builder *rows)
{
    const mesh *mesh = &design->mesh;
    pzs_structure *structure = &design->structure;
    structure->format = PZS_TABLE_FORMAT;
    structure->scene = design->scene->hash;
    structure->nodes = (uint16_t)mesh->nodes;
    structure->elements = (uint16_t)mesh->elements;
    structure->types = (uint16_t)mesh->types;
    structure->dof_per_node = (uint16_t)mesh->dof_per_node;
    structure->free_dof = (uint16_t)mesh->free_dof;
    structure->element = (const uint16_t(*)[4])mesh->element;
    structure->element_type = mesh->element_type;
    structure->node_dof = mesh->node_dof;
    structure->first_column = mesh->first_column;
    structure->stiffness = mesh->stiffness;
    structure->type = mesh->type;
    rows_of(columns, &structure->input);
    rows_of(rows, &structure->output);
    fill_springs(&mesh->springs, structure);
    structure->turns = (uint16_t)mesh->turns;
    structure->node_turn = mesh->node_turn;
    structure->turn = (const double(*)[3][3])mesh->turn;
    structure->crc = pzs_structure_crc(structure);
}

/*
 * Build all inputs and outputs of the structure.
 *   dense [free_dof], value [nodes], node [nodes] out  work arrays
 * Returns 0, or -1 with error filled.
 */
static int build_all(design *design, row_builder *columns, row_builder *rows, double *dense,
                     double *value, int *node, char *error)
{
    if (build_inputs(design, columns, dense, value, error) < 0)
        return -1;
    if (build_targets(design, rows, dense, node, error) < 0)
        return -1;
    return build_named(design, rows, dense, node, error);
}

int design_structure(design *design, char *error)
{
    const size_t nodes = (size_t)design->mesh.nodes;
    row_builder columns = {0}, rows = {0};
    double *dense = calloc((size_t)design->mesh.free_dof, sizeof *dense),
           *value = calloc(nodes, sizeof *value);
    int *node = calloc(nodes, sizeof *node), status = -1;
    if (!dense || !value || !node)
        scene_fault(design->scene->at_surface, error,
                    "the inputs of %d free dof do not fit into memory; use fewer elements",
                    design->mesh.free_dof);
    else
        status = build_all(design, &columns, &rows, dense, value, node, error);
    if (status == 0 &&
        (columns.is_full || rows.is_full || columns.rows > UINT16_MAX || rows.rows > UINT16_MAX))
        status = scene_fault(design->scene->at_surface, error,
                             "too many inputs or outputs (%zu, %zu); at most %u each", columns.rows,
                             rows.rows, (unsigned)UINT16_MAX);
    fill_structure(design, &columns, &rows);
    free(dense);
    free(value);
    free(node);
    return status;
}

/* ---- shapes ----------------------------------------------------------- */

bool design_reads_displacements(const design *design)
{
    for (int i = 0; i < design->estimate.readings; i++)
        if (!output_has_rows(&design->output[design->estimate.reading[i].output]))
            return false;
    return true;
}

void design_applied(const design *design, double *voltage)
{
    for (int k = 0; k < design->scene->actuators; k++) {
        const scene_actuator *actuator = &design->scene->actuator[k];
        for (int cell = 0; cell < actuator->grid[0] * actuator->grid[1]; cell++)
            voltage[actuator->first + cell] =
                actuator->each ? actuator->each[cell] : actuator->applied;
    }
}

void design_shape(const design *design, const double *displacement, double *shape)
{
    for (int i = 0; i < design->targets; i++)
        shape[i] = pzs_model_observe_row(&design->structure, displacement, (uint32_t)i);
}

void design_free(design *design)
{
    bare_faces_free(&design->bare);
    design_release(design->structure.input.start);
    design_release(design->structure.input.dof);
    design_release(design->structure.input.value);
    design_release(design->structure.output.start);
    design_release(design->structure.output.dof);
    design_release(design->structure.output.value);
    design_release(design->electrodes.input);
    design_release(design->electrodes.open);
    design_release(design->electrodes.direct.start);
    design_release(design->electrodes.direct.dof);
    design_release(design->electrodes.direct.value);
    free(design->target_node);
    free(design->named_first);
    free(design->place_first);
    free(design->place_node);
    free(design->target);
    free(design->wanted);
    free(design->weight);
    free(design->fixed_weight);
    free(design->free_value);
    free(design->free_basis);
    free(design->influence);
    free(design->hessian);
    free(design->lower);
    free(design->upper);
    free(design->step_limit);
    free(design->reference_voltage);
    free(design->park);
    free(design->gains.memory);
    free(design->rows.start);
    free(design->rows.input);
    free(design->rows.value);
    free(design->rows.lower);
    free(design->rows.upper);
    free(design->rows.safe);
    free(design->amplifier_name);
    free(design->electrode_name);
    mesh_free(&design->mesh);
    memset(design, 0, sizeof *design);
}
