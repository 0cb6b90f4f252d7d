/* SPDX-License-Identifier: BSD-2-Clause */
#include "pzs.h"
#include "bridge.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/mesh/compact_types.h"
#include "../../host_tools/model/analysis.h"
#include "../../host_tools/model/calibrate.h"
#include "../../host_tools/model/design_build.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/vibration.h"
#include "../../host_tools/tables/mass_tables.h"
#include "../../host_tools/tables/open_tables.h"

typedef struct inside {
    scene scene;
    analysis analysis;
    bool is_unsolved; /* only the design of the analysis is there */
} inside;

static bridge_rows rows_of(const pzs_rows *rows)
{
    const bridge_rows result = {rows->count, rows->start, rows->dof, rows->value};
    return result;
}

static void fill_path(bridge *tables, const equilibrium *equilibrium)
{
    const pzs_prescribed_resultants *resultants = &equilibrium->tables.resultants;
    tables->full_input = equilibrium->full_input;
    tables->given_values = resultants->values;
    tables->given_start = resultants->start;
    tables->given_element = resultants->element;
    tables->given_which = resultants->which;
    tables->given_value = (const double *)resultants->value;
    tables->motions = equilibrium->tables.prescribed.count;
    tables->motion_input = equilibrium->tables.prescribed.input;
    tables->motion_dof = equilibrium->tables.prescribed.dof;
    tables->motion_value = equilibrium->tables.prescribed.value;
    tables->tolerance = equilibrium->solver.settings.tolerance;
    tables->linear_solves = equilibrium->solver.info.linear_solves;
}

/*
 * Copy the compact element types of the mesh, if it has any. Returns 0, or -1 where memory is
 * lacking.
 */
static int fill_compact(bridge *tables, const mesh *mesh)
{
    compact_types compact;
    compact_types_make(&compact, mesh);
    if (!compact.type)
        return 0;
    const size_t types = (size_t)mesh->types, nodes = (size_t)mesh->nodes;
    tables->compact_types = mesh->types;
    tables->compact_value = calloc(types * BRIDGE_COMPACT, sizeof *tables->compact_value);
    tables->compact_corner = calloc(types * 4, sizeof *tables->compact_corner);
    tables->node_value = calloc(nodes * 12, sizeof *tables->node_value);
    const bool is_whole = tables->compact_value && tables->compact_corner && tables->node_value;
    for (size_t k = 0; k < types && is_whole; k++) {
        memcpy(tables->compact_value + k * BRIDGE_COMPACT, &compact.type[k],
               BRIDGE_COMPACT * sizeof(double));
        memcpy(tables->compact_corner + 4 * k, compact.type[k].corner,
               sizeof compact.type[k].corner);
    }
    if (is_whole)
        memcpy(tables->node_value, compact.node, nodes * sizeof *compact.node);
    compact_types_free(&compact);
    return is_whole ? 0 : -1;
}

/* Copy what the scene says of the structure, without a solution. */
static int fill_structure(bridge *tables, const design *design)
{
    const mesh *mesh = &design->mesh;
    tables->nodes = mesh->nodes;
    tables->elements = mesh->elements;
    tables->types = mesh->types;
    tables->dof_per_node = (int)mesh->dof_per_node;
    tables->dof = mesh->free_dof;
    tables->element = mesh->element[0];
    tables->element_type = mesh->element_type;
    tables->node_dof = mesh->node_dof;
    tables->first_column = mesh->first_column;
    tables->stiffness = mesh->stiffness;
    tables->type_values = (const double *)mesh->type;
    tables->type_reals = sizeof *mesh->type / sizeof(double);
    tables->input = rows_of(&design->structure.input);
    tables->output = rows_of(&design->structure.output);
    tables->spring = rows_of(&design->structure.spring);
    tables->spring_stiffness = mesh->springs.stiffness;
    tables->turns = mesh->turns;
    tables->node_turn = mesh->node_turn;
    tables->turn = mesh->turns > 0 ? mesh->turn[0][0] : NULL;
    tables->electrodes = design->electrodes.count;
    tables->electrode_input = design->electrodes.input;
    tables->electrode_open = design->electrodes.open;
    tables->direct = rows_of(&design->electrodes.direct);
    tables->amplifiers = design->amplifiers;
    tables->targets = design->targets;
    return fill_compact(tables, mesh);
}

static int fill(bridge *tables, inside *in, char *error)
{
    const design *design = &in->analysis.design;
    if (fill_structure(tables, design) < 0)
        return -1;
    tables->input_value = in->analysis.input_value;
    tables->displacement = calloc((size_t)tables->dof, sizeof *tables->displacement);
    if (!tables->displacement || analysis_solve(&in->analysis, tables->displacement, error) < 0)
        return -1;
    fill_path(tables, &in->analysis.equilibrium);
    tables->condition = in->analysis.model.info.condition;
    tables->error = in->analysis.model.info.error_estimate;
    if (design->targets && analysis_influence(&in->analysis, error) < 0)
        return -1;
    tables->influence = in->analysis.influence;
    tables->target = design->target;
    return 0;
}

/* Read a scene. Returns its memory, or NULL with error filled. */
static inside *read_scene(const char *scene_name, const char *const *set, int sets, char *error)
{
    char path[4096];
    inside *in = calloc(1, sizeof *in);
    snprintf(path, sizeof path, strchr(scene_name, '/') ? "%s" : SCENE_FOLDER "/%s.yaml",
             scene_name);
    if (in && scene_read(&in->scene, path, set, sets, error) == 0)
        return in;
    free(in);
    return NULL;
}

int bridge_open(bridge *tables, const char *scene_name, const char *const *set, int sets,
                char *error)
{
    memset(tables, 0, sizeof *tables);
    inside *in = read_scene(scene_name, set, sets, error);
    if (!in)
        return -1;
    tables->inside = in;
    if (analysis_prepare(&in->analysis, &in->scene, error) == 0 && fill(tables, in, error) == 0)
        return 0;
    bridge_close(tables);
    return -1;
}

int bridge_open_unsolved(bridge *tables, const char *scene_name, const char *const *set, int sets,
                         char *error)
{
    memset(tables, 0, sizeof *tables);
    inside *in = read_scene(scene_name, set, sets, error);
    if (!in)
        return -1;
    tables->inside = in;
    in->is_unsolved = true;
    if (design_build(&in->analysis.design, &in->scene, error) == 0 &&
        fill_structure(tables, &in->analysis.design) == 0)
        return 0;
    bridge_close(tables);
    return -1;
}

void bridge_close(bridge *tables)
{
    inside *in = tables->inside;
    if (in && in->is_unsolved)
        design_free(&in->analysis.design);
    else if (in)
        analysis_free(&in->analysis);
    if (in)
        scene_free(&in->scene);
    free(in);
    free(tables->displacement);
    free(tables->compact_value);
    free(tables->compact_corner);
    free(tables->node_value);
    memset(tables, 0, sizeof *tables);
}

static void fill_modes(bridge_modes *modes, const bridge *tables, const vibration *vibration)
{
    const inside *in = tables->inside;
    const design *design = &in->analysis.design;
    const size_t inputs = design->structure.input.count;
    double *column = calloc((size_t)tables->targets, sizeof *column);
    for (int k = 0; k < modes->modes && column; k++) {
        design_shape(design, vibration->shape + (size_t)k * (size_t)tables->dof, column);
        modes->frequency[k] = sqrt(vibration->square[k]);
        for (int i = 0; i < tables->targets; i++)
            modes->shape[i * modes->modes + k] = column[i];
        for (int j = 0; j < tables->amplifiers; j++)
            modes->modal[k * tables->amplifiers + j] = vibration_static(vibration, design, k, j);
        modes->load[k] =
            design->loads ? vibration_static(vibration, design, k, tables->amplifiers) : 0;
    }
    for (int i = 0; i < tables->targets && design->loads; i++)
        modes->load_shape[i] = tables->influence[(size_t)i * inputs + (size_t)tables->amplifiers];
    free(column);
}

int bridge_modes_open(bridge_modes *mode_tables, const bridge *tables, int modes, char *error)
{
    const inside *in = tables->inside;
    vibration vibration;
    memset(mode_tables, 0, sizeof *mode_tables);
    if (vibration_solve(&vibration, &in->analysis.design, modes, MASS_LUMPED, error) < 0)
        return -1;
    mode_tables->modes = vibration.count;
    const size_t nodes = (size_t)mode_tables->modes, targets = (size_t)tables->targets;
    mode_tables->frequency = calloc(nodes, sizeof *mode_tables->frequency);
    mode_tables->shape = calloc(nodes * targets, sizeof *mode_tables->shape);
    mode_tables->modal = calloc(nodes * (size_t)tables->amplifiers, sizeof *mode_tables->modal);
    mode_tables->load = calloc(nodes, sizeof *mode_tables->load);
    mode_tables->load_shape = calloc(targets, sizeof *mode_tables->load_shape);
    if (mode_tables->frequency && mode_tables->shape && mode_tables->modal && mode_tables->load &&
        mode_tables->load_shape)
        fill_modes(mode_tables, tables, &vibration);
    vibration_free(&vibration);
    return 0;
}

void bridge_modes_close(bridge_modes *modes)
{
    free(modes->frequency);
    free(modes->shape);
    free(modes->modal);
    free(modes->load);
    free(modes->load_shape);
    memset(modes, 0, sizeof *modes);
}

typedef struct inside_mass {
    mass_tables tables;
    open_tables open;
    linearised about;
    vibration vibration;
} inside_mass;

static void fill_electrodes(bridge_mass *mass, const open_tables *open)
{
    const pzs_electrodes *tables = open->electrodes;
    mass->electrodes = tables->count;
    mass->open = (int)open->count;
    mass->electrode_input = tables->input;
    mass->electrode_open = tables->open;
    mass->is_open = open->is_open;
    if (mass->electrodes > 0)
        mass->direct = (bridge_rows){tables->direct.count, tables->direct.start, tables->direct.dof,
                                     tables->direct.value};
}

int bridge_mass_open(bridge_mass *mass, const bridge *tables, bridge_circuit circuit, int modes,
                     char *error)
{
    const electrode_circuit host = (electrode_circuit)circuit;
    inside *in = tables->inside;
    inside_mass *own = calloc(1, sizeof *own);
    const bool is_loaded = in->analysis.is_nonlinear && !in->is_unsolved;
    memset(mass, 0, sizeof *mass);
    mass->inside = own;
    if (!own || mass_tables_make(&own->tables, &in->analysis.design, MASS_LUMPED, error) < 0 ||
        (is_loaded &&
         !linearised_take(&own->about, &in->analysis.design, &in->analysis.equilibrium.solver)) ||
        open_tables_make(&own->open, &in->analysis.design, host, error) < 0 ||
        vibration_solve_at(&own->vibration, &in->analysis.design, is_loaded ? &own->about : NULL,
                           host, modes, MASS_LUMPED, error) < 0)
        return -1;
    fill_electrodes(mass, &own->open);
    mass->types = own->tables.tables.types;
    mass->element_type = own->tables.element_type;
    mass->matrix = own->tables.matrix;
    mass->count = own->vibration.count;
    mass->rigid = own->vibration.rigid;
    mass->square = own->vibration.square;
    mass->shape = own->vibration.shape;
    mass->response = own->vibration.response;
    return 0;
}

void bridge_mass_close(bridge_mass *mass)
{
    inside_mass *own = mass->inside;
    if (own) {
        mass_tables_free(&own->tables);
        open_tables_free(&own->open);
        linearised_free(&own->about);
        vibration_free(&own->vibration);
    }
    free(own);
    memset(mass, 0, sizeof *mass);
}

double bridge_calibrate(size_t count, size_t inputs, size_t outputs, const double *voltage,
                        const double *shape, double *influence, double *spread)
{
    char error[SCENE_ERROR];
    calibration result;
    const pokes pokes = {count, inputs, outputs, voltage, shape, 0};
    double noise = (double)NAN;
    if (calibrate(&result, &pokes, NULL, error) == 0) {
        memcpy(influence, result.influence, outputs * inputs * sizeof *influence);
        memcpy(spread, result.error, inputs * sizeof *spread);
        noise = result.noise;
    }
    calibration_free(&result);
    return noise;
}
