/* SPDX-License-Identifier: BSD-2-Clause */
/* Shells on general meshes (quad_shell.h). */
#include "quad_shell.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/mesh/corner_weight.h"
#include "../../host_tools/quads/vector.h"
#include "../../lib/core/linalg.h"
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"

static void *grow(void *old, size_t count, size_t size)
{
    void *bigger = realloc(old, count * size);
    if (!bigger)
        abort();
    return bigger;
}

void quad_shell_init(quad_shell *shell, double thickness, double young, double poisson)
{
    memset(shell, 0, sizeof *shell);
    scene_material *material = &shell->material[0];
    for (int i = 0; i < 3; i++)
        material->e[i] = young;
    material->nu12 = material->nu13 = material->nu23 = poisson;
    material->g12 = material->g13 = material->g23 = young / (2 * (1 + poisson));
    shell->layer[0].thickness = thickness;
    shell->layer[0].poling = 3;
    shell->scene.layer = shell->layer;
    shell->scene.material = shell->material;
    shell->scene.layers = shell->scene.materials = 1;
    shell->scene.reference_is_middle = 1;
    shell->scene.path = (char *)(uintptr_t) "quads";
    shell->scene.element = (scene_element){1, 1, 0.09, 1, 1, 1, 1, 7, 0};
    shell->quads.regions = 1;
    shell->quads.region = grow(NULL, 1, sizeof *shell->quads.region);
    shell->quads.region[0] = (quad_region){~0u, {0, 0, 0}};
}

/* ---- mesh ---------------------------------------------------------------- */

/* Node at a position, added if there is none. */
static uint32_t add_node(quad_mesh *quads, const double x[3], const double d[3])
{
    for (size_t n = 0; n < quads->nodes; n++) {
        const double step[3] = {x[0] - quads->position[n][0], x[1] - quads->position[n][1],
                                x[2] - quads->position[n][2]};
        if (vector_length(step) < 1e-9) {
            for (int i = 0; i < 3; i++)
                quads->director[n][i] += d[i];
            vector_normalise(quads->director[n]);
            return (uint32_t)n;
        }
    }
    const size_t room = quads->nodes + 1;
    quads->position = grow(quads->position, room, sizeof *quads->position);
    quads->director = grow(quads->director, room, sizeof *quads->director);
    quads->axis = grow(quads->axis, room, sizeof *quads->axis);
    quads->constrained = grow(quads->constrained, room, 1);
    memcpy(quads->position[quads->nodes], x, sizeof *quads->position);
    memcpy(quads->director[quads->nodes], d, sizeof *quads->director);
    memset(quads->axis[quads->nodes], 0, sizeof *quads->axis);
    quads->constrained[quads->nodes] = 0;
    return (uint32_t)quads->nodes++;
}

static double random_part(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 8388608.0 - 1;
}

void quad_shell_block(quad_shell *shell, int n1, int n2, quad_map *map, const void *data,
                      double distortion, unsigned seed)
{
    quad_mesh *quads = &shell->quads;
    uint32_t *node = grow(NULL, (size_t)(n1 + 1) * (size_t)(n2 + 1), sizeof *node);
    for (int i = 0; i <= n1; i++)
        for (int j = 0; j <= n2; j++) {
            const int inner = i > 0 && i < n1 && j > 0 && j < n2;
            const double shift[2] = {random_part(&seed), random_part(&seed)};
            double x[3], d[3];
            map(data, (i + inner * distortion * shift[0]) / n1,
                (j + inner * distortion * shift[1]) / n2, x, d);
            node[i * (n2 + 1) + j] = add_node(quads, x, d);
        }
    const size_t elements = (size_t)n1 * (size_t)n2;
    quads->element = grow(quads->element, quads->elements + elements, sizeof *quads->element);
    for (int i = 0; i < n1; i++)
        for (int j = 0; j < n2; j++) {
            const uint32_t *corner = node + i * (n2 + 1) + j;
            const uint32_t nodes[4] = {corner[0], corner[n2 + 1], corner[n2 + 2], corner[1]};
            memcpy(quads->element[quads->elements++], nodes, sizeof nodes);
        }
    free(node);
}

void quad_shell_single(quad_shell *shell, const double corner[4][3], const double director[4][3],
                       const double axis[4][3])
{
    quad_mesh *quads = &shell->quads;
    quads->element = grow(quads->element, 1, sizeof *quads->element);
    quads->elements = 1;
    for (int r = 0; r < 4; r++) {
        quads->element[0][r] = add_node(quads, corner[r], director[r]);
        memcpy(quads->director[r], director[r], sizeof *quads->director);
        memcpy(quads->axis[r], axis[r], sizeof *quads->axis);
    }
}

void quad_shell_hold(quad_shell *shell, const double point[3], const double normal[3],
                     const double *axis, unsigned dof)
{
    quad_mesh *quads = &shell->quads;
    for (size_t n = 0; n < quads->nodes; n++) {
        const double *x = quads->position[n];
        const double step[3] = {x[0] - point[0], x[1] - point[1], x[2] - point[2]};
        if (fabs(vector_dot(step, normal)) > 1e-9)
            continue;
        if (axis && vector_length(quads->axis[n]) > 0 &&
            fabs(vector_dot(axis, quads->axis[n])) < 0.99)
            quads->constrained[n] = 0;
        quads->constrained[n] |= (uint8_t)dof;
        if (axis)
            memcpy(quads->axis[n], axis, sizeof *quads->axis);
    }
}

void quad_shell_symmetry(quad_shell *shell, int i)
{
    const double origin[3] = {0, 0, 0}, normal[3] = {i == 0, i == 1, i == 2};
    for (size_t n = 0; n < shell->quads.nodes; n++)
        if (fabs(shell->quads.position[n][i]) < 1e-9) {
            shell->quads.director[n][i] = 0;
            vector_normalise(shell->quads.director[n]);
        }
    quad_shell_hold(shell, origin, normal, normal, 1u << 0 | 1u << 3);
}

int quad_shell_nearest(const quad_shell *shell, double x, double y, double z)
{
    int best = 0;
    double least = HUGE_VAL;
    for (size_t n = 0; n < shell->quads.nodes; n++) {
        const double *p = shell->quads.position[n], step[3] = {p[0] - x, p[1] - y, p[2] - z};
        if (vector_length(step) < least) {
            least = vector_length(step);
            best = (int)n;
        }
    }
    return best;
}

/* Make the axis of a node a unit vector normal to its director; the global axis along which the
 * director is least where none was chosen. */
static void finish_axis(quad_mesh *quads, size_t n)
{
    double *axis = quads->axis[n], *d = quads->director[n];
    if (vector_length(axis) < 0.5)
        for (int i = 0, least = 0; i < 3; i++) {
            least = fabs(d[i]) < fabs(d[least]) - 1e-6 ? i : least;
            if (i == 2)
                axis[least] = 1;
        }
    const double along = vector_dot(axis, d);
    for (int i = 0; i < 3; i++)
        axis[i] -= along * d[i];
    vector_normalise(axis);
}

typedef struct swept_node {
    double at;
    uint32_t node;
} swept_node;

static int compare_swept(const void *left, const void *right)
{
    const swept_node *x = left, *y = right;
    if (x->at < y->at || x->at > y->at)
        return x->at < y->at ? -1 : 1;
    return (x->node > y->node) - (x->node < y->node);
}

int quad_shell_build(quad_shell *shell, const double sweep[3])
{
    quad_mesh *quads = &shell->quads;
    swept_node *swept = grow(NULL, quads->nodes, sizeof *swept);
    quads->order = grow(quads->order, quads->nodes, sizeof *quads->order);
    for (size_t n = 0; n < quads->nodes; n++) {
        finish_axis(quads, n);
        swept[n] = (swept_node){vector_dot(quads->position[n], sweep), (uint32_t)n};
    }
    qsort(swept, quads->nodes, sizeof *swept, compare_swept);
    for (size_t n = 0; n < quads->nodes; n++)
        quads->order[n] = swept[n].node;
    free(swept);
    shell->force = calloc(quads->nodes, sizeof *shell->force);
    shell->u = calloc(quads->nodes, sizeof *shell->u);
    shell->is_built = mesh_build_quads(&shell->mesh, &shell->scene, quads, shell->accept_irregular,
                                       shell->error) == 0;
    return shell->is_built ? 0 : -1;
}

/* ---- loads --------------------------------------------------------------- */

void quad_shell_force(quad_shell *shell, int node, const double force[3])
{
    for (int a = 0; a < 3; a++)
        shell->force[node][a] += vector_dot(shell->mesh.point[node].e[a], force);
}

void quad_shell_couple(quad_shell *shell, int node, const double couple[3])
{
    double turned[3];
    vector_cross(couple, shell->mesh.point[node].e[2], turned);
    for (int a = 0; a < 3; a++)
        shell->force[node][3 + a] += vector_dot(shell->mesh.point[node].e[a], turned);
}

/* Integral of N_r N_s over an element. */
static double pair_weight(const laminate_place *place, int r, int s)
{
    const double plain[3] = {4 / 36.0, 2 / 36.0, 1 / 36.0};
    const int is_opposite = (r ^ s) == 2, steps = is_opposite ? 2 : r != s;
    return place->area * (plain[steps] + corner_pair_excess(place, r, s));
}

/* Add the force of a traction given at all nodes. traction [nodes][3] */
static void add_traction(quad_shell *shell, const double (*traction)[3])
{
    for (int e = 0; e < shell->mesh.elements; e++) {
        const laminate_place *place = &shell->mesh.place[shell->mesh.element_type[e]];
        for (int r = 0; r < 4; r++)
            for (int s = 0; s < 4; s++) {
                const double weight = pair_weight(place, r, s);
                const double *p = traction[shell->mesh.element[e][s]],
                             part[3] = {weight * p[0], weight * p[1], weight * p[2]};
                quad_shell_force(shell, shell->mesh.element[e][r], part);
            }
    }
}

void quad_shell_traction(quad_shell *shell, const double traction[3])
{
    double(*all)[3] = calloc(shell->quads.nodes, sizeof *all);
    for (size_t n = 0; n < shell->quads.nodes; n++)
        memcpy(all[n], traction, sizeof *all);
    add_traction(shell, (const double(*)[3])all);
    free(all);
}

void quad_shell_pressure(quad_shell *shell, double (*pressure)(const double x[3]))
{
    double(*all)[3] = calloc(shell->quads.nodes, sizeof *all);
    for (size_t n = 0; n < shell->quads.nodes; n++)
        for (int i = 0; i < 3; i++)
            all[n][i] = pressure(shell->quads.position[n]) * shell->quads.director[n][i];
    add_traction(shell, (const double(*)[3])all);
    free(all);
}

/* ---- solution ------------------------------------------------------------ */

/* The shell as a structure with one input, its force, and the memory of its rows. */
typedef struct loaded_shell {
    pzs_structure structure;
    uint32_t start[2], none[1];
    uint16_t *index;
    double *value;
} loaded_shell;

static pzs_status load_shell(const quad_shell *shell, loaded_shell *loaded)
{
    const mesh *mesh = &shell->mesh;
    memset(loaded, 0, sizeof *loaded);
    loaded->index = calloc((size_t)mesh->free_dof, sizeof *loaded->index);
    loaded->value = calloc((size_t)mesh->free_dof, sizeof *loaded->value);
    for (int n = 0; n < mesh->nodes; n++)
        for (unsigned i = 0; i < mesh->dof_per_node; i++) {
            const uint16_t d = mesh->node_dof[(unsigned)n * mesh->dof_per_node + i];
            if (d == PZS_CONSTRAINED || !(fabs(shell->force[n][i]) > 0))
                continue;
            loaded->index[loaded->start[1]] = d;
            loaded->value[loaded->start[1]++] = shell->force[n][i];
        }
    const pzs_structure structure = {.format = PZS_TABLE_FORMAT,
                                     .nodes = (uint16_t)mesh->nodes,
                                     .elements = (uint16_t)mesh->elements,
                                     .types = (uint16_t)mesh->types,
                                     .dof_per_node = (uint16_t)mesh->dof_per_node,
                                     .free_dof = (uint16_t)mesh->free_dof,
                                     .element = (const uint16_t(*)[4])mesh->element,
                                     .element_type = mesh->element_type,
                                     .node_dof = mesh->node_dof,
                                     .first_column = mesh->first_column,
                                     .stiffness = mesh->stiffness,
                                     .type = mesh->type,
                                     .input = {1, loaded->start, loaded->index, loaded->value},
                                     .output = {0, loaded->none, loaded->index, loaded->value}};
    loaded->structure = structure;
    return pzs_structure_seal(&loaded->structure);
}

static void unload_shell(loaded_shell *loaded)
{
    free(loaded->index);
    free(loaded->value);
}

static void keep_displacement(quad_shell *shell, const double *u)
{
    const mesh *mesh = &shell->mesh;
    for (int n = 0; n < mesh->nodes; n++)
        for (unsigned i = 0; i < mesh->dof_per_node; i++) {
            const uint16_t d = mesh->node_dof[(unsigned)n * mesh->dof_per_node + i];
            shell->u[n][i] = d == PZS_CONSTRAINED ? 0 : u[d];
        }
}

static size_t model_bytes(const mesh *mesh)
{
    const uint32_t dof = (uint32_t)mesh->free_dof;
    return PZS_MODEL_BYTES(dof, pzs_linalg_reals(mesh->first_column, dof));
}

pzs_status quad_shell_solve(quad_shell *shell)
{
    double *u = calloc((size_t)shell->mesh.free_dof, sizeof *u), one = 1;
    const size_t bytes = model_bytes(&shell->mesh);
    void *work = malloc(bytes);
    loaded_shell loaded;
    pzs_model model;
    pzs_status status = load_shell(shell, &loaded);
    if (!PZS_IS_ERROR(status))
        status = pzs_model_init(&model, &loaded.structure, work, bytes);
    if (!PZS_IS_ERROR(status))
        status = pzs_assemble(&model, NULL, NULL);
    if (!PZS_IS_ERROR(status))
        status = pzs_factor(&model);
    if (!PZS_IS_ERROR(status))
        status = pzs_solve(&model, &one, u);
    keep_displacement(shell, u);
    unload_shell(&loaded);
    free(work);
    free(u);
    return status;
}

pzs_status quad_shell_equilibrium(quad_shell *shell, uint32_t *linear_solves)
{
    const size_t bytes = model_bytes(&shell->mesh),
                 solver_bytes = PZS_SOLVER_BYTES(shell->mesh.free_dof, shell->mesh.elements, 1);
    void *work = malloc(bytes), *solver_work = malloc(solver_bytes);
    const double one = 1;
    loaded_shell loaded;
    pzs_nonlinear tables = {0};
    pzs_solver solver;
    pzs_model model;
    pzs_status status = load_shell(shell, &loaded);
    pzs_nonlinear_seal(&tables, &loaded.structure);
    if (!PZS_IS_ERROR(status))
        status = pzs_model_init(&model, &loaded.structure, work, bytes);
    if (!PZS_IS_ERROR(status))
        status = pzs_solver_init(&solver, &model, &tables, solver_work, solver_bytes);
    if (!PZS_IS_ERROR(status)) {
        status = pzs_equilibrium(&solver, &one);
        keep_displacement(shell, solver.info.displacement);
        *linear_solves = solver.info.linear_solves;
    }
    unload_shell(&loaded);
    free(work);
    free(solver_work);
    return status;
}

void quad_shell_displacement(const quad_shell *shell, int node, double u[3])
{
    for (int i = 0; i < 3; i++) {
        u[i] = 0;
        for (int a = 0; a < 3; a++)
            u[i] += shell->mesh.point[node].e[a][i] * shell->u[node][a];
    }
}

double quad_shell_work(const quad_shell *shell)
{
    double work = 0;
    for (int n = 0; n < shell->mesh.nodes; n++)
        for (unsigned i = 0; i < 7; i++)
            work += shell->force[n][i] * shell->u[n][i];
    return work;
}

void quad_shell_close(quad_shell *shell)
{
    if (shell->is_built)
        mesh_free(&shell->mesh);
    quad_mesh_free(&shell->quads);
    free(shell->force);
    free(shell->u);
    memset(shell, 0, sizeof *shell);
}
