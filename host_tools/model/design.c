/* Columns and rows of a scene (design.h). */
#include "design.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "electrodes.h"
#include "../../lib/core/guard.h"
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"

/* ---- sparse rows under construction ----------------------------------- */

typedef struct builder {
    uint32_t *start;
    uint16_t *dof;
    double *value;
    size_t rows, terms, room_rows, room_terms;
    int full; /* memory ran out */
} builder;

void *design_grow(void *old, size_t count, size_t size, int *full)
{
    void *bigger = realloc(old, count * size);
    if (!bigger)
        *full = 1;
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

/* Append a dense row [dof]: its nonzero entries. */
static void append_row(builder *b, const double *dense, int dof)
{
    if (b->rows + 2 > b->room_rows) {
        b->room_rows = 2 * b->room_rows + 64;
        b->start = design_grow(b->start, b->room_rows, sizeof *b->start, &b->full);
    }
    if (b->terms + (size_t)dof > b->room_terms) {
        b->room_terms = 2 * b->room_terms + (size_t)dof;
        b->dof = design_grow(b->dof, b->room_terms, sizeof *b->dof, &b->full);
        b->value = design_grow(b->value, b->room_terms, sizeof *b->value, &b->full);
    }
    if (b->full)
        return;
    b->start[b->rows++] = (uint32_t)b->terms;
    for (int i = 0; i < dof; i++)
        if (dense[i] != 0) {
            b->dof[b->terms] = (uint16_t)i;
            b->value[b->terms++] = dense[i];
        }
    b->start[b->rows] = (uint32_t)b->terms;
}

static void rows_of(const builder *b, pzs_rows *rows)
{
    rows->count = (uint16_t)b->rows;
    rows->start = b->start;
    rows->dof = b->dof;
    rows->value = b->value;
}

/* ---- outputs ---------------------------------------------------------- */

/* Unit direction of a component in the local triad of a node. */
static void direction(const surface_point *p, scene_component component, double c[3])
{
    for (int a = 0; a < 3; a++)
        c[a] = component <= COMPONENT_U3 ? component - COMPONENT_U1 == (unsigned)a
                                         : p->e[a][component - COMPONENT_X];
}

/* Height of a face above the middle of a thickness h. */
static double pzs_face_height(scene_face face, double h)
{
    return face == FACE_OUTER ? h / 2 : face == FACE_INNER ? -h / 2 : 0;
}

/* Mean and difference weights of components c on a face, without the seventh unknown. */
static void face_weights(const mesh *m, scene_face face, const double c[3], double weight[7])
{
    for (int a = 0; a < 3; a++) {
        weight[a] = c[a];
        weight[3 + a] = pzs_face_height(face, m->laminate.h) * c[a];
    }
    weight[6] = 0;
}

/* The middle also has the seventh unknown along e3. */
void design_output_weights(const mesh *m, int node, scene_component component, scene_face face,
                           double weight[7])
{
    double c[3];
    direction(&m->point[node], component, c);
    face_weights(m, face, c, weight);
    if (face == FACE_MIDDLE)
        weight[6] = m->laminate.h * c[2];
}

/* dense += factor times weights on the free unknowns of a node */
static void add_node(const mesh *m, int node, double factor, const double weight[7], double *dense)
{
    for (unsigned i = 0; i < m->unknowns; i++) {
        const uint16_t dof = m->node_dof[(size_t)node * m->unknowns + i];
        if (dof != PZS_CONSTRAINED)
            dense[dof] += factor * weight[i];
    }
}

static void append_output(const mesh *m, const scene_output *output, int node, builder *rows,
                          double *dense)
{
    double weight[7];
    memset(dense, 0, (size_t)m->dof * sizeof *dense);
    design_output_weights(m, node, output->component, output->face, weight);
    add_node(m, node, 1, weight, dense);
    append_row(rows, dense, m->dof);
}

void design_node_areas(const mesh *m, double *area)
{
    memset(area, 0, (size_t)m->nodes * sizeof *area);
    for (int e = 0; e < m->elements; e++)
        for (int r = 0; r < 4; r++)
            area[m->element[e][r]] += m->place[m->element_kind[e]].area / 4;
}

int design_target_values(const design *d, const expr *wanted, scene_at at, double *value,
                         char *error)
{
    const mesh *m = &d->mesh;
    for (int i = 0; i < d->targets; i++) {
        const expr_point place = mesh_place(m, d->target_node[i]);
        value[i] = expr_value(wanted, &place);
        if (!isfinite(value[i]))
            return scene_fault(d->scene, at, error,
                               "the wanted displacement or free function is not a finite number at "
                               "theta1 = %g, theta2 = %g",
                               m->theta[d->target_node[i]][0], m->theta[d->target_node[i]][1]);
    }
    design_take_free(d, value);
    return 0;
}

/* Target rows, wanted values and weights; weights by area have mean square 1. */
static int build_targets(design *d, builder *rows, double *dense, int *node, char *error)
{
    const scene_target *target = &d->scene->target;
    if (!target->given)
        return 0;
    const mesh *m = &d->mesh;
    d->targets = mesh_select(m, &target->what.where, node);
    d->target = calloc((size_t)d->targets, sizeof *d->target);
    d->weight = calloc((size_t)d->targets, sizeof *d->weight);
    d->target_node = calloc((size_t)d->targets, sizeof *d->target_node);
    double *area = calloc((size_t)m->nodes, sizeof *area), sum = 0;
    if (!d->target || !d->weight || !d->target_node || !area) {
        free(area);
        return scene_fault(d->scene, target->what.at, error,
                           "%d target nodes do not fit into memory", d->targets);
    }
    design_node_areas(m, area);
    for (int i = 0; i < d->targets; i++)
        sum += area[node[i]];
    for (int i = 0; i < d->targets; i++) {
        d->target_node[i] = node[i];
        d->weight[i] = target->weight_area ? sqrt(area[node[i]] * d->targets / sum) : 1;
        append_output(m, &target->what, node[i], rows, dense);
    }
    free(area);
    return 0;
}

/* An output of displacements or of contact pressures has a place; one of electrodes or of the whole
 * contact has none. */
static int has_place(const scene_output *output)
{
    return output->electric == ELECTRIC_NONE &&
           (output->contact == CONTACT_NONE || output->contact == CONTACT_PRESSURE);
}

/* Nodes of the named outputs. node [nodes] is used as room. */
static int build_places(design *d, int *node)
{
    int entries = 0;
    d->place_first = calloc((size_t)d->scene->outputs + 1, sizeof *d->place_first);
    if (!d->place_first)
        return -1;
    for (int k = 0; k < d->scene->outputs; k++) {
        const scene_output *output = &d->scene->output[k];
        d->place_first[k] = entries;
        entries += has_place(output) ? mesh_select(&d->mesh, &output->where, node) : 0;
    }
    d->place_first[d->scene->outputs] = entries;
    d->place_node = calloc((size_t)entries + 1, sizeof *d->place_node);
    for (int k = 0; d->place_node && k < d->scene->outputs; k++)
        if (has_place(&d->scene->output[k]))
            mesh_select(&d->mesh, &d->scene->output[k].where, d->place_node + d->place_first[k]);
    return d->place_node ? 0 : -1;
}

static int build_named(design *d, builder *rows, double *dense, int *node, char *error)
{
    d->named_first = calloc((size_t)d->scene->outputs + 1, sizeof *d->named_first);
    if (!d->named_first || build_places(d, node) < 0)
        return scene_fault(d->scene, d->scene->at_surface, error, "outputs do not fit into memory");
    for (int k = 0; k < d->scene->outputs; k++) {
        const scene_output *output = &d->scene->output[k];
        const int moves = output->contact == CONTACT_NONE && output->electric == ELECTRIC_NONE;
        d->named_first[k] = (int)rows->rows;
        for (int i = d->place_first[k]; moves && i < d->place_first[k + 1]; i++)
            append_output(&d->mesh, output, d->place_node[i], rows, dense);
    }
    d->named_first[d->scene->outputs] = (int)rows->rows;
    return 0;
}

/* ---- inputs ----------------------------------------------------------- */

static void scatter(const mesh *m, int element, double factor, const double *f, double *dense)
{
    for (int r = 0; r < 4; r++)
        for (unsigned i = 0; i < m->unknowns; i++) {
            const uint16_t dof = m->node_dof[m->element[element][r] * m->unknowns + i];
            if (dof != PZS_CONSTRAINED)
                dense[dof] += factor * f[(unsigned)r * m->unknowns + i];
        }
}

/* h0 += factor times the resultants of a volt across ply, or of a kelvin when ply < 0 */
static void add_given(const mesh *m, int element, int ply, double factor,
                      double h0[LAMINATE_STRAINS])
{
    double one[LAMINATE_STRAINS];
    laminate_given(&m->laminate, &m->scene->element, &m->place[m->element_kind[element]], ply, one);
    for (int i = 0; i < LAMINATE_STRAINS; i++)
        h0[i] += factor * one[i];
}

int design_patch(const mesh *m, int element, const scene_patches *p)
{
    double t[2][2];
    const double *range[2] = {p->theta1, p->theta2};
    int patch = 0;
    mesh_cell(m, element, t[0], t[1]);
    for (int a = 0; a < 2; a++) {
        const double share =
            ((t[a][0] + t[a][1]) / 2 - range[a][0]) / (range[a][1] - range[a][0]) * p->grid[a];
        if (!(share > 0 && share < p->grid[a]))
            return -1;
        patch = patch * p->grid[a] + (int)share;
    }
    return patch;
}

int design_actuation(const mesh *m, const scene_actuator *actuator, int cell, int element,
                     double h0[LAMINATE_STRAINS])
{
    int acts = actuator->is_temperature;
    memset(h0, 0, LAMINATE_STRAINS * sizeof *h0);
    if (actuator->is_temperature)
        add_given(m, element, -1, 1, h0);
    for (int k = 0; k < actuator->drives; k++) {
        const scene_patches *patches = &m->scene->patches[actuator->drive[k].patches];
        if (design_patch(m, element, patches) != cell)
            continue;
        add_given(m, element, patches->layer, actuator->drive[k].factor, h0);
        acts = 1;
    }
    return acts;
}

laminate_field design_kelvin(const scene_load *load)
{
    const expr_point anywhere = {0, 0, 0, 0, 0};
    laminate_field field = {-1, {0, 0}};
    field.kelvin[0] = expr_value(load->value, &anywhere);
    field.kelvin[1] = load->outer ? expr_value(load->outer, &anywhere) : field.kelvin[0];
    return field;
}

void design_warming(const mesh *m, const scene_load *load, int element, double h0[LAMINATE_STRAINS])
{
    const laminate_field field = design_kelvin(load);
    laminate_resultants(&m->laminate, &m->scene->element, &m->place[m->element_kind[element]],
                        &field, h0);
}

/* dense += force at rest of given resultants */
static void add_resultants(const mesh *m, int element, const double h0[LAMINATE_STRAINS],
                           double *dense)
{
    double f[SHELL_MAX];
    pzs_shell_given(&m->kind[m->element_kind[element]], m->unknowns, h0, f);
    scatter(m, element, 1, f, dense);
}

/* Columns of the amplifiers of an actuator or of a sensor's electrodes: their patches, tied with
 * their factors. */
static void amplifier_columns(const mesh *m, const scene_actuator *actuator, builder *columns,
                              double *dense)
{
    double h0[LAMINATE_STRAINS];
    for (int cell = 0; cell < actuator->grid[0] * actuator->grid[1]; cell++) {
        memset(dense, 0, (size_t)m->dof * sizeof *dense);
        for (int e = 0; e < m->elements; e++)
            if (design_actuation(m, actuator, cell, e, h0))
                add_resultants(m, e, h0, dense);
        append_row(columns, dense, m->dof);
    }
}

/* Force per unit of load at a node, components in its triad; pressure acts along e3. */
static void load_vector(const mesh *m, const scene_load *load, int node, double value, double c[3])
{
    const surface_point *p = &m->point[node];
    const double z = m->laminate.z[load->face == FACE_OUTER];
    const double stretch = load->true_area ? (1 + p->k[0] * z) * (1 + p->k[1] * z) : 1;
    direction(p, load->component, c);
    for (int a = 0; a < 3; a++)
        c[a] *= value * stretch;
}

/* Nodal force of components c on the chosen face (half on each where it is the middle): virtual
 * work of F.u. */
static void add_force(const mesh *m, const scene_load *load, int node, double factor,
                      const double c[3], double *dense)
{
    double weight[7];
    face_weights(m, load->face, c, weight);
    add_node(m, node, factor, weight, dense);
}

/*
 * Components at node `to` of a load given at node `from`. A pressure keeps its components, because
 * vectors interpolated along a chord lose angle^2/6 of it; a load of fixed direction is carried as
 * a vector by the Cartesian element and by components in the published one.
 */
static void carry(const mesh *m, const scene_load *load, int from, int to, const double c[3],
                  double out[3])
{
    for (int a = 0; a < 3; a++) {
        out[a] = c[a];
        if (!m->scene->element.cartesian || load->component <= COMPONENT_U3)
            continue;
        out[a] = 0;
        for (int b = 0; b < 3; b++)
            for (int i = 0; i < 3; i++)
                out[a] += m->point[to].e[a][i] * m->point[from].e[b][i] * c[b];
    }
}

double design_chords(const mesh *m, int element, int r, scene_face face, double flat[2][2],
                     double lean[2])
{
    const pzs_element_type *kind = &m->kind[m->element_kind[element]];
    const double half = pzs_face_height(face, kind->thickness);
    for (int a = 0; a < 2; a++) {
        for (int i = 0; i < 2; i++)
            flat[a][i] = kind->g_mean[r][a][i] + half * kind->g_diff[r][a][i];
        const double length = hypot(flat[a][0], flat[a][1]),
                     x = atan2(kind->g_mean[r][a][2] + half * kind->g_diff[r][a][2], length);
        lean[a] = length * (fabs(x) > 1e-3 ? 1 / x - 1 / tan(x) : x / 3);
    }
    return flat[0][0] * flat[1][1] - flat[0][1] * flat[1][0];
}

/* What a pressure on a corner of a chord pushes along the surface, on its middle. c [3] in the
 * pressure there. */
static void add_lean(const mesh *m, const scene_load *load, int element, int r, double size,
                     const double c[3], double *dense)
{
    double flat[2][2], lean[2], weight[7] = {0};
    const double part = c[2] * size / design_chords(m, element, r, load->face, flat, lean);
    weight[0] = part * (lean[1] * flat[0][1] - lean[0] * flat[1][1]);
    weight[1] = part * (lean[0] * flat[1][0] - lean[1] * flat[0][0]);
    add_node(m, m->element[element][r], 1, weight, dense);
}

/* A distributed load on a patch of nodes with consistent weights: out_r += size sum_s weight(r, s)
 * p_s. */
static void add_distributed(const mesh *m, const scene_load *load, const int *node,
                            const double *value, int count, double size, double *dense)
{
    for (int r = 0; r < count; r++)
        for (int s = 0; s < count; s++) {
            const int apart = r == s ? 0 : count == 4 && (r ^ s) == 2 ? 2 : 1;
            double c[3], carried[3];
            load_vector(m, load, node[s], value[s], c);
            carry(m, load, node[s], node[r], c, carried);
            add_force(m, load, node[r],
                      size * (count == 4 ? 4 >> apart : 2 >> apart) / (count == 4 ? 36 : 6),
                      carried, dense);
        }
}

static void face_column(const mesh *m, const scene_load *load, const double *value, double density,
                        double *dense)
{
    for (int e = 0; e < m->elements; e++) {
        const laminate_place *place = &m->place[m->element_kind[e]];
        double weight = density;
        int node[4];
        double corner[4];
        for (int p = 0; load->type == LOAD_WEIGHT && p < m->laminate.plies; p++)
            if (place->present >> p & 1u)
                weight +=
                    m->laminate.ply[p].weight * (m->laminate.ply[p].z[1] - m->laminate.ply[p].z[0]);
        for (int r = 0; r < 4; r++) {
            node[r] = m->element[e][r];
            corner[r] = value[node[r]];
        }
        add_distributed(m, load, node, corner, 4, place->area * weight, dense);
        for (int r = 0; r < 4 && m->scene->element.cartesian && load->component == COMPONENT_U3;
             r++) {
            double c[3];
            load_vector(m, load, node[r], corner[r], c);
            add_lean(m, load, e, r, place->area / 4, c, dense);
        }
    }
}

static void line_column(const mesh *m, const scene_load *load, const double *value, double *dense)
{
    const scene_edge edge = load->where.edge;
    const int along = edge == EDGE_THETA1_MINUS || edge == EDGE_THETA1_PLUS ? 1 : 0;
    const scene_line *line = &m->scene->line[along];
    const int across = edge == EDGE_THETA1_PLUS || edge == EDGE_THETA2_PLUS
                           ? m->scene->line[1 - along].elements
                           : 0;
    for (int k = 0; k < line->elements; k++) {
        int node[2];
        for (int r = 0; r < 2; r++)
            node[r] = along == 1 ? mesh_node(m, across, k + r) : mesh_node(m, k + r, across);
        const double corner[2] = {value[node[0]], value[node[1]]};
        const double length = m->point[node[0]].a[along] * (line->point[k + 1] - line->point[k]);
        add_distributed(m, load, node, corner, 2, length, dense);
    }
}

static void load_column(const mesh *m, const scene_load *load, const double *value, int *node,
                        double *dense)
{
    double c[3];
    switch (load->type) {
    case LOAD_POINT:
        mesh_select(m, &load->where, node);
        load_vector(m, load, node[0], value[node[0]], c);
        add_force(m, load, node[0], 1, c, dense);
        break;
    case LOAD_LINE: line_column(m, load, value, dense); break;
    case LOAD_FACE: face_column(m, load, value, 1, dense); break;
    case LOAD_WEIGHT: face_column(m, load, value, 0, dense); break;
    case LOAD_TEMPERATURE:
        for (int e = 0; e < m->elements; e++) {
            double h0[LAMINATE_STRAINS];
            design_warming(m, load, e, h0);
            add_resultants(m, e, h0, dense);
        }
        break;
    }
}

int design_load_values(const mesh *m, const scene_load *load, double *value, char *error)
{
    for (int n = 0; n < m->nodes; n++) {
        const expr_point at = mesh_place(m, n);
        value[n] = expr_value(load->value, &at);
        if (!isfinite(value[n]))
            return scene_fault(m->scene, load->at, error,
                               "load is not a finite number at theta1 = %g, theta2 = %g",
                               m->theta[n][0], m->theta[n][1]);
    }
    return 0;
}

/* Number of inputs that only the nonlinear path has. */
static int extras_of(const design *d)
{
    const scene *s = d->scene;
    int extras = (d->mesh.prescribed_count > 0) + s->contact.given;
    for (int k = 0; k < s->loads; k++)
        extras += s->load[k].follower != FOLLOWER_NONE;
    return s->kinematics == KINEMATICS_LINEAR ? 0 : extras;
}

static int build_inputs(design *d, builder *columns, double *dense, int *node, double *value,
                        char *error)
{
    const scene *s = d->scene;
    const mesh *m = &d->mesh;
    for (int k = 0; k < s->actuators; k++)
        amplifier_columns(m, &s->actuator[k], columns, dense);
    d->amplifiers = (int)columns->rows;
    for (int k = 0; k < s->loads; k++) {
        if (design_load_values(m, &s->load[k], value, error) < 0)
            return -1;
        memset(dense, 0, (size_t)m->dof * sizeof *dense);
        load_column(m, &s->load[k], value, node, dense);
        append_row(columns, dense, m->dof);
    }
    d->loads = s->loads;
    memset(dense, 0, (size_t)m->dof * sizeof *dense);
    for (int k = 0; k < extras_of(d); k++)
        append_row(columns, dense, m->dof);
    d->sensor_first = (int)columns->rows;
    for (int k = 0; k < s->sensors; k++)
        amplifier_columns(m, &s->sensor[k], columns, dense);
    return 0;
}

/* ---- structure -------------------------------------------------------- */

static void fill_structure(design *d, const builder *columns, const builder *rows)
{
    const mesh *m = &d->mesh;
    pzs_structure *s = &d->structure;
    s->format = PZS_TABLE_FORMAT;
    s->scene = d->scene->hash;
    s->nodes = (uint16_t)m->nodes;
    s->elements = (uint16_t)m->elements;
    s->types = (uint16_t)m->kinds;
    s->dof_per_node = (uint16_t)m->unknowns;
    s->free_dof = (uint16_t)m->dof;
    s->element = (const uint16_t(*)[4])m->element;
    s->element_type = m->element_kind;
    s->node_dof = m->node_dof;
    s->first_column = m->first;
    s->stiffness = m->stiffness;
    s->type = m->kind;
    rows_of(columns, &s->input);
    rows_of(rows, &s->output);
    s->crc = pzs_structure_crc(s);
}

static int build_rows(design *d, char *error)
{
    const size_t nodes = (size_t)d->mesh.nodes;
    builder columns = {0}, rows = {0};
    double *dense = calloc((size_t)d->mesh.dof, sizeof *dense),
           *value = calloc(nodes, sizeof *value);
    int *node = calloc(nodes, sizeof *node), status = -1;
    if (!dense || !value || !node)
        scene_fault(d->scene, d->scene->at_surface, error, "columns do not fit into memory");
    else
        status = build_inputs(d, &columns, dense, node, value, error) < 0 ||
                         build_targets(d, &rows, dense, node, error) < 0 ||
                         build_named(d, &rows, dense, node, error) < 0
                     ? -1
                     : 0;
    if (status == 0 &&
        (columns.full || rows.full || columns.rows > UINT16_MAX || rows.rows > UINT16_MAX))
        status = scene_fault(d->scene, d->scene->at_surface, error,
                             "too many inputs or outputs (%zu, %zu); at most %u each", columns.rows,
                             rows.rows, (unsigned)UINT16_MAX);
    fill_structure(d, &columns, &rows);
    free(dense);
    free(value);
    free(node);
    return status;
}

int design_build(design *d, const scene *s, char *error)
{
    memset(d, 0, sizeof *d);
    d->scene = s;
    if (mesh_build(&d->mesh, s, error) == 0 && build_rows(d, error) == 0 &&
        design_target_rows(d, error) == 0 && electrodes_build(d, error) == 0)
        return 0;
    design_free(d);
    return -1;
}

/* ---- shapes ----------------------------------------------------------- */

void design_applied(const design *d, double *voltage)
{
    for (int k = 0; k < d->scene->actuators; k++) {
        const scene_actuator *actuator = &d->scene->actuator[k];
        for (int c = 0; c < actuator->grid[0] * actuator->grid[1]; c++)
            voltage[actuator->first + c] = actuator->applied;
    }
}

void design_shape(const design *d, const double *u, double *shape)
{
    for (int i = 0; i < d->targets; i++)
        shape[i] = pzs_model_observe_row(&d->structure, u, (uint32_t)i);
}

void design_free(design *d)
{
    design_release(d->structure.input.start);
    design_release(d->structure.input.dof);
    design_release(d->structure.input.value);
    design_release(d->structure.output.start);
    design_release(d->structure.output.dof);
    design_release(d->structure.output.value);
    electrodes_free(d);
    free(d->target_node);
    free(d->named_first);
    free(d->place_first);
    free(d->place_node);
    free(d->target);
    free(d->wanted);
    free(d->weight);
    free(d->fixed_weight);
    free(d->free_value);
    free(d->influence);
    free(d->hessian);
    free(d->lower);
    free(d->upper);
    free(d->slew);
    free(d->prefer);
    mesh_free(&d->mesh);
    memset(d, 0, sizeof *d);
}
