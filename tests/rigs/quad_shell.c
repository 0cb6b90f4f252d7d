/* SPDX-License-Identifier: BSD-2-Clause */
/* Shells on general meshes, without scenes (quad_shell.h). */
#include "quad_shell.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/mesh/corner_weight.h"
#include "../../host_tools/quads/vector.h"
#include "../../lib/core/linalg.h"
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"
#include "uniform.h"

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
    shell->scene.reference_is_middle = true;
    shell->scene.element = (scene_element){1, 1, 0.09, 1, 1, 1, 1, 7, 0, 1};
    shell->quads.regions = 1;
    shell->quads.region = grow(NULL, 1, sizeof *shell->quads.region);
    shell->quads.region[0] = (quad_region){~0u, {0, 0, 0}};
}

/* ---- mesh ---------------------------------------------------------------- */

/* Return the node at a position, after adding it if there is none. */
static uint32_t add_node(quad_mesh *quads, const double position[3], const double director[3])
{
    for (size_t node = 0; node < quads->nodes; node++) {
        const double step[3] = {position[0] - quads->position[node][0],
                                position[1] - quads->position[node][1],
                                position[2] - quads->position[node][2]};
        if (vector_length(step) < 1e-9) {
            for (int i = 0; i < 3; i++)
                quads->director[node][i] += director[i];
            vector_normalise(quads->director[node]);
            return (uint32_t)node;
        }
    }
    const size_t room = quads->nodes + 1;
    quads->position = grow(quads->position, room, sizeof *quads->position);
    quads->director = grow(quads->director, room, sizeof *quads->director);
    quads->axis = grow(quads->axis, room, sizeof *quads->axis);
    quads->constrained = grow(quads->constrained, room, 1);
    memcpy(quads->position[quads->nodes], position, sizeof *quads->position);
    memcpy(quads->director[quads->nodes], director, sizeof *quads->director);
    memset(quads->axis[quads->nodes], 0, sizeof *quads->axis);
    quads->constrained[quads->nodes] = 0;
    return (uint32_t)quads->nodes++;
}

void quad_shell_block(quad_shell *shell, int n1, int n2, quad_map *map, const void *data,
                      double distortion, unsigned seed)
{
    quad_mesh *quads = &shell->quads;
    uint32_t *node = grow(NULL, (size_t)(n1 + 1) * (size_t)(n2 + 1), sizeof *node);
    for (int i = 0; i <= n1; i++)
        for (int j = 0; j <= n2; j++) {
            const int inner = i > 0 && i < n1 && j > 0 && j < n2;
            const double shift[2] = {uniform(&seed, -1, 1), uniform(&seed, -1, 1)};
            double position[3], director[3];
            map(data, (i + inner * distortion * shift[0]) / n1,
                (j + inner * distortion * shift[1]) / n2, position, director);
            node[i * (n2 + 1) + j] = add_node(quads, position, director);
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
    for (int index = 0; index < 4; index++) {
        quads->element[0][index] = add_node(quads, corner[index], director[index]);
        memcpy(quads->director[index], director[index], sizeof *quads->director);
        memcpy(quads->axis[index], axis[index], sizeof *quads->axis);
    }
}

void quad_shell_hold(quad_shell *shell, const double point[3], const double normal[3],
                     const double *axis, unsigned dof)
{
    quad_mesh *quads = &shell->quads;
    for (size_t node = 0; node < quads->nodes; node++) {
        const double *position = quads->position[node];
        const double step[3] = {position[0] - point[0], position[1] - point[1],
                                position[2] - point[2]};
        if (fabs(vector_dot(step, normal)) > 1e-9)
            continue;
        if (axis && vector_length(quads->axis[node]) > 0 &&
            fabs(vector_dot(axis, quads->axis[node])) < 0.99)
            quads->constrained[node] = 0;
        quads->constrained[node] |= (uint8_t)dof;
        if (axis)
            memcpy(quads->axis[node], axis, sizeof *quads->axis);
    }
}

void quad_shell_symmetry(quad_shell *shell, int i)
{
    const double origin[3] = {0, 0, 0}, normal[3] = {i == 0, i == 1, i == 2};
    for (size_t node = 0; node < shell->quads.nodes; node++)
        if (fabs(shell->quads.position[node][i]) < 1e-9) {
            shell->quads.director[node][i] = 0;
            vector_normalise(shell->quads.director[node]);
        }
    quad_shell_hold(shell, origin, normal, normal, 1u << 0 | 1u << 3);
}

int quad_shell_nearest(const quad_shell *shell, double x, double y, double z)
{
    int best = 0;
    double least = HUGE_VAL;
    for (size_t node = 0; node < shell->quads.nodes; node++) {
        const double *position = shell->quads.position[node],
                     step[3] = {position[0] - x, position[1] - y, position[2] - z};
        if (vector_length(step) < least) {
            least = vector_length(step);
            best = (int)node;
        }
    }
    return best;
}

/*
 * Make the axis of a node a unit vector normal to its director. Where no axis was chosen, it
 * follows the global axis along which the director has its smallest component.
 */
static void finish_axis(quad_mesh *quads, size_t node)
{
    double *axis = quads->axis[node], *director = quads->director[node];
    if (vector_length(axis) < 0.5)
        for (int i = 0, least = 0; i < 3; i++) {
            least = fabs(director[i]) < fabs(director[least]) - 1e-6 ? i : least;
            if (i == 2)
                axis[least] = 1;
        }
    const double along = vector_dot(axis, director);
    for (int i = 0; i < 3; i++)
        axis[i] -= along * director[i];
    vector_normalise(axis);
}

typedef struct swept_node {
    double at;
    uint32_t node;
} swept_node;

static int compare_swept(const void *left, const void *right)
{
    const swept_node *one_node = left, *other_node = right;
    if (one_node->at < other_node->at || one_node->at > other_node->at)
        return one_node->at < other_node->at ? -1 : 1;
    return (one_node->node > other_node->node) - (one_node->node < other_node->node);
}

int quad_shell_build(quad_shell *shell, const double sweep[3])
{
    quad_mesh *quads = &shell->quads;
    swept_node *swept = grow(NULL, quads->nodes, sizeof *swept);
    quads->order = grow(quads->order, quads->nodes, sizeof *quads->order);
    for (size_t node = 0; node < quads->nodes; node++) {
        finish_axis(quads, node);
        swept[node] = (swept_node){vector_dot(quads->position[node], sweep), (uint32_t)node};
    }
    qsort(swept, quads->nodes, sizeof *swept, compare_swept);
    for (size_t node = 0; node < quads->nodes; node++)
        quads->order[node] = swept[node].node;
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
    for (int axis = 0; axis < 3; axis++)
        shell->force[node][axis] += vector_dot(shell->mesh.point[node].triad[axis], force);
}

void quad_shell_couple(quad_shell *shell, int node, const double couple[3])
{
    double turned[3];
    vector_cross(couple, shell->mesh.point[node].triad[2], turned);
    for (int axis = 0; axis < 3; axis++)
        shell->force[node][3 + axis] += vector_dot(shell->mesh.point[node].triad[axis], turned);
}

/* Integral over an element of the product of the shape functions of two corners. */
static double pair_weight(const laminate_place *place, int corner, int other)
{
    const double plain[3] = {4 / 36.0, 2 / 36.0, 1 / 36.0};
    const int is_opposite = (corner ^ other) == 2, steps = is_opposite ? 2 : corner != other;
    return place->area * (plain[steps] + corner_pair_excess(place, corner, other));
}

/*
 * Add the nodal forces of a traction, given at all nodes.
 *   traction [nodes][3] in  traction (N/m2)
 */
static void add_traction(quad_shell *shell, const double (*traction)[3])
{
    for (int element = 0; element < shell->mesh.elements; element++) {
        const laminate_place *place = &shell->mesh.place[shell->mesh.element_type[element]];
        for (int corner = 0; corner < 4; corner++)
            for (int other = 0; other < 4; other++) {
                const double weight = pair_weight(place, corner, other);
                const double *position = traction[shell->mesh.element[element][other]],
                             part[3] = {weight * position[0], weight * position[1],
                                        weight * position[2]};
                quad_shell_force(shell, shell->mesh.element[element][corner], part);
            }
    }
}

void quad_shell_traction(quad_shell *shell, const double traction[3])
{
    double(*all)[3] = calloc(shell->quads.nodes, sizeof *all);
    for (size_t node = 0; node < shell->quads.nodes; node++)
        memcpy(all[node], traction, sizeof *all);
    add_traction(shell, (const double(*)[3])all);
    free(all);
}

void quad_shell_pressure(quad_shell *shell, double (*pressure)(const double position[3]))
{
    double(*all)[3] = calloc(shell->quads.nodes, sizeof *all);
    for (size_t node = 0; node < shell->quads.nodes; node++)
        for (int i = 0; i < 3; i++)
            all[node][i] = pressure(shell->quads.position[node]) * shell->quads.director[node][i];
    add_traction(shell, (const double(*)[3])all);
    free(all);
}

/* ---- solution ------------------------------------------------------------ */

/* The shell as a structure whose one input is the force, and the memory of its sparse rows. */
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
    for (int node = 0; node < mesh->nodes; node++)
        for (unsigned i = 0; i < mesh->dof_per_node; i++) {
            const uint16_t dof = mesh->node_dof[(unsigned)node * mesh->dof_per_node + i];
            if (dof == PZS_CONSTRAINED || !(fabs(shell->force[node][i]) > 0))
                continue;
            loaded->index[loaded->start[1]] = dof;
            loaded->value[loaded->start[1]++] = shell->force[node][i];
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

static void keep_displacement(quad_shell *shell, const double *displacement)
{
    const mesh *mesh = &shell->mesh;
    for (int node = 0; node < mesh->nodes; node++)
        for (unsigned i = 0; i < mesh->dof_per_node; i++) {
            const uint16_t dof = mesh->node_dof[(unsigned)node * mesh->dof_per_node + i];
            shell->u[node][i] = dof == PZS_CONSTRAINED ? 0 : displacement[dof];
        }
}

static size_t model_bytes(const mesh *mesh)
{
    const uint32_t dof = (uint32_t)mesh->free_dof;
    return PZS_MODEL_BYTES(dof, pzs_linalg_reals(mesh->first_column, dof));
}

pzs_status quad_shell_solve(quad_shell *shell)
{
    double *displacement = calloc((size_t)shell->mesh.free_dof, sizeof *displacement), one = 1;
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
        status = pzs_solve(&model, &one, displacement);
    keep_displacement(shell, displacement);
    unload_shell(&loaded);
    free(work);
    free(displacement);
    return status;
}

pzs_status quad_shell_equilibrium(quad_shell *shell)
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
        shell->load_steps = solver.info.load_steps;
        shell->linear_solves = solver.info.linear_solves;
    }
    unload_shell(&loaded);
    free(work);
    free(solver_work);
    return status;
}

void quad_shell_displacement(const quad_shell *shell, int node, double displacement[3])
{
    for (int i = 0; i < 3; i++) {
        displacement[i] = 0;
        for (int axis = 0; axis < 3; axis++)
            displacement[i] += shell->mesh.point[node].triad[axis][i] * shell->u[node][axis];
    }
}

double quad_shell_work(const quad_shell *shell)
{
    double work = 0;
    for (int node = 0; node < shell->mesh.nodes; node++)
        for (unsigned i = 0; i < 7; i++)
            work += shell->force[node][i] * shell->u[node][i];
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
