#include "pzs.h"
#include "bridge.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/analysis.h"

typedef struct inside {
    scene scene;
    analysis analysis;
} inside;

static bridge_rows rows_of(const pzs_rows *rows)
{
    const bridge_rows r = {rows->count, rows->start, rows->dof, rows->value};
    return r;
}

static void fill_path(bridge *b, const path *p)
{
    const pzs_prescribed_resultants *g = &p->tables.given;
    b->full = p->full;
    b->given_values = g->values;
    b->given_start = g->start;
    b->given_element = g->element;
    b->given_which = g->which;
    b->given_value = (const double *)g->value;
    b->change = p->run.settings.tolerance;
    b->systems = p->run.info.linear_solves;
}

static int fill(bridge *b, inside *in, char *error)
{
    const design *d = &in->analysis.design;
    const mesh *m = &d->mesh;
    b->nodes = m->nodes;
    b->elements = m->elements;
    b->kinds = m->kinds;
    b->unknowns = (int)m->unknowns;
    b->dof = m->dof;
    b->element = m->element[0];
    b->element_kind = m->element_kind;
    b->node_dof = m->node_dof;
    b->first = m->first;
    b->stiffness = m->stiffness;
    b->kind = (const double *)m->kind;
    b->kind_reals = sizeof *m->kind / sizeof(double);
    b->input = rows_of(&d->structure.input);
    b->output = rows_of(&d->structure.output);
    b->electrodes = d->electrodes.count;
    b->electrode_input = d->electrodes.input;
    b->pzs_electrode_open = d->electrodes.open;
    b->direct = rows_of(&d->electrodes.direct);
    b->amount = in->analysis.amount;
    b->amplifiers = d->amplifiers;
    b->targets = d->targets;
    b->u = calloc((size_t)m->dof, sizeof *b->u);
    if (!b->u || analysis_solve(&in->analysis, b->u, error) < 0)
        return -1;
    fill_path(b, &in->analysis.path);
    b->condition = in->analysis.model.info.condition;
    b->error = in->analysis.model.info.error_estimate;
    if (d->targets && analysis_influence(&in->analysis, error) < 0)
        return -1;
    b->influence = in->analysis.influence;
    b->target = d->target;
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
