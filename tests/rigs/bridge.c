/* SPDX-License-Identifier: BSD-2-Clause */
#include "pzs.h"
#include "bridge.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/analysis.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/vibration.h"

typedef struct inside {
    scene scene;
    analysis analysis;
} inside;

static bridge_rows rows_of(const pzs_rows *rows)
{
    const bridge_rows r = {rows->count, rows->start, rows->dof, rows->value};
    return r;
}

static void fill_path(bridge *b, const equilibrium *equilibrium)
{
    const pzs_prescribed_resultants *g = &equilibrium->tables.given;
    b->full = equilibrium->full_input;
    b->given_values = g->values;
    b->given_start = g->start;
    b->given_element = g->element;
    b->given_which = g->which;
    b->given_value = (const double *)g->value;
    b->change = equilibrium->solver.settings.tolerance;
    b->systems = equilibrium->solver.info.linear_solves;
}

static int fill(bridge *b, inside *in, char *error)
{
    const design *design = &in->analysis.design;
    const mesh *mesh = &design->mesh;
    b->nodes = mesh->nodes;
    b->elements = mesh->elements;
    b->kinds = mesh->types;
    b->unknowns = (int)mesh->dof_per_node;
    b->dof = mesh->free_dof;
    b->element = mesh->element[0];
    b->element_kind = mesh->element_type;
    b->node_dof = mesh->node_dof;
    b->first = mesh->first_column;
    b->stiffness = mesh->stiffness;
    b->kind = (const double *)mesh->type;
    b->kind_reals = sizeof *mesh->type / sizeof(double);
    b->input = rows_of(&design->structure.input);
    b->output = rows_of(&design->structure.output);
    b->electrodes = design->electrodes.count;
    b->electrode_input = design->electrodes.input;
    b->pzs_electrode_open = design->electrodes.open;
    b->direct = rows_of(&design->electrodes.direct);
    b->amount = in->analysis.input_value;
    b->amplifiers = design->amplifiers;
    b->targets = design->targets;
    b->u = calloc((size_t)mesh->free_dof, sizeof *b->u);
    if (!b->u || analysis_solve(&in->analysis, b->u, error) < 0)
        return -1;
    fill_path(b, &in->analysis.equilibrium);
    b->condition = in->analysis.model.info.condition;
    b->error = in->analysis.model.info.error_estimate;
    if (design->targets && analysis_influence(&in->analysis, error) < 0)
        return -1;
    b->influence = in->analysis.influence;
    b->target = design->target;
    return 0;
}

int bridge_open(bridge *b, const char *scene_name, const char *const *set, int sets, char *error)
{
    char path[4096];
    inside *in = calloc(1, sizeof *in);
    memset(b, 0, sizeof *b);
    snprintf(path, sizeof path, strchr(scene_name, '/') ? "%s" : SCENE_FOLDER "/%s.yaml",
             scene_name);
    if (!in || scene_read(&in->scene, path, set, sets, error) < 0) {
        free(in);
        return -1;
    }
    b->inside = in;
    if (analysis_prepare(&in->analysis, &in->scene, error) == 0 && fill(b, in, error) == 0)
        return 0;
    bridge_close(b);
    return -1;
}

void bridge_close(bridge *b)
{
    inside *in = b->inside;
    if (in) {
        analysis_free(&in->analysis);
        scene_free(&in->scene);
    }
    free(in);
    free(b->u);
    memset(b, 0, sizeof *b);
}

static void fill_modes(bridge_modes *m, const bridge *b, const vibration *vibration)
{
    const inside *in = b->inside;
    const design *design = &in->analysis.design;
    const size_t inputs = design->structure.input.count;
    double *column = calloc((size_t)b->targets, sizeof *column);
    for (int k = 0; k < m->modes && column; k++) {
        design_shape(design, vibration->shape + (size_t)k * (size_t)b->dof, column);
        m->frequency[k] = sqrt(vibration->square[k]);
        for (int i = 0; i < b->targets; i++)
            m->shape[i * m->modes + k] = column[i];
        for (int j = 0; j < b->amplifiers; j++)
            m->modal[k * b->amplifiers + j] = vibration_static(vibration, design, k, j);
        m->load[k] = design->loads ? vibration_static(vibration, design, k, b->amplifiers) : 0;
    }
    for (int i = 0; i < b->targets && design->loads; i++)
        m->load_shape[i] = b->influence[(size_t)i * inputs + (size_t)b->amplifiers];
    free(column);
}

int bridge_modes_open(bridge_modes *m, const bridge *b, int modes, char *error)
{
    const inside *in = b->inside;
    vibration vibration;
    memset(m, 0, sizeof *m);
    if (vibration_solve(&vibration, &in->analysis.design, modes, MASS_LUMPED, error) < 0)
        return -1;
    m->modes = vibration.count;
    const size_t n = (size_t)m->modes, targets = (size_t)b->targets;
    m->frequency = calloc(n, sizeof *m->frequency);
    m->shape = calloc(n * targets, sizeof *m->shape);
    m->modal = calloc(n * (size_t)b->amplifiers, sizeof *m->modal);
    m->load = calloc(n, sizeof *m->load);
    m->load_shape = calloc(targets, sizeof *m->load_shape);
    if (m->frequency && m->shape && m->modal && m->load && m->load_shape)
        fill_modes(m, b, &vibration);
    vibration_free(&vibration);
    return 0;
}

void bridge_modes_close(bridge_modes *m)
{
    free(m->frequency);
    free(m->shape);
    free(m->modal);
    free(m->load);
    free(m->load_shape);
    memset(m, 0, sizeof *m);
}
