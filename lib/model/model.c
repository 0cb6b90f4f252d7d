/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The linear model: assembly and factorisation of the stiffness matrix, refined solution, and
 * influence matrix (pzs_model.h).
 */
#include "model.h"
#include "compact.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "shell.h"
#include "spring.h"
#include <string.h>

/*
 * Largest number of iterations that refine the solution of the stiffness equations. Conjugate
 * gradients that are preconditioned by the factors of the stiffness matrix need 1 to 8.
 */
enum { REFINEMENT_LIMIT = 16 };

static pzs_status fail(pzs_model *model, pzs_status status, int32_t where)
{
    model->info.where = where;
    return status;
}

/* ---- init ------------------------------------------------------------- */

static bool rows_complete(const pzs_rows *rows)
{
    return rows->count == 0 || (rows->start && rows->dof && rows->value);
}

/*
 * Whether all arrays in the tables of a structure are present and its counts agree. Otherwise a
 * damaged count could lead the checksum beyond the tables.
 */
static bool structure_complete(const pzs_structure *structure)
{
    const bool counts_fit =
        structure->types <= structure->elements && structure->nodes <= 4u * structure->elements &&
        structure->free_dof <= (uint32_t)structure->nodes * structure->dof_per_node;
    return structure->nodes > 0 && structure->elements > 0 && structure->types > 0 &&
           structure->free_dof > 0 && structure->free_dof < PZS_CONSTRAINED && counts_fit &&
           (structure->dof_per_node == 6 || structure->dof_per_node == 7) && structure->element &&
           structure->element_type && structure->node_dof && structure->first_column &&
           (structure->stiffness || pzs_structure_has_types(structure)) &&
           rows_complete(&structure->input) && rows_complete(&structure->output) &&
           rows_complete(&structure->spring) &&
           (structure->spring.count == 0 || structure->spring_stiffness) &&
           (structure->compact == NULL) == (structure->node == NULL) &&
           structure->turns <= structure->nodes &&
           (structure->turns == 0 || (structure->node_turn && structure->turn));
}

/*
 * Whether the indices of the first entries of sparse rows ascend from row to row, and every column
 * index is below `dof`.
 */
static bool rows_in_range(const pzs_rows *rows, uint32_t dof)
{
    for (uint32_t row = 0; row < rows->count; row++)
        if (rows->start[row] > rows->start[row + 1])
            return false;
    for (uint32_t entry = rows->count ? rows->start[0] : 0;
         rows->count && entry < rows->start[rows->count]; entry++)
        if (rows->dof[entry] >= dof)
            return false;
    return true;
}

/*
 * Whether the stiffness entries of an element lie inside the envelope of the stiffness matrix (its
 * stored entries). Each free degree of freedom of the element has a row; in this row the first
 * stored column must not be right of the element's lowest degree of freedom.
 */
static bool element_in_envelope(const pzs_structure *structure, const uint16_t node[4])
{
    uint32_t least = PZS_CONSTRAINED;
    for (int scan = 0; scan < 2; scan++)
        for (unsigned i = 0; i < SHELL_NODES * (unsigned)structure->dof_per_node; i++) {
            const size_t first =
                (size_t)node[i / structure->dof_per_node] * structure->dof_per_node;
            const uint16_t dof = structure->node_dof[first + i % structure->dof_per_node];
            if (dof == PZS_CONSTRAINED)
                continue;
            if (scan == 0)
                least = dof < least ? dof : least;
            else if (structure->first_column[dof] > least)
                return false;
        }
    return true;
}

/*
 * Whether the index of the rotated axes of each node (nodes at oblique supports have such axes) is
 * below the number of rotated axes in the tables.
 */
static bool turns_in_range(const pzs_structure *structure)
{
    for (uint32_t node = 0; structure->turns > 0 && node < structure->nodes; node++)
        if (structure->node_turn[node] != PZS_UNTURNED &&
            structure->node_turn[node] >= structure->turns)
            return false;
    return true;
}

/*
 * Whether the node indices at the corners of all element types that the library completes from
 * nodes (pzs_compact_type) are below the number of nodes of the structure.
 */
static bool corners_in_range(const pzs_structure *structure)
{
    for (uint32_t type = 0; structure->compact != NULL && type < structure->types; type++)
        for (int corner = 0; corner < SHELL_NODES; corner++)
            if (structure->compact[type].corner[corner] >= structure->nodes)
                return false;
    return true;
}

/*
 * Whether every index in the tables of a structure is in range. This is checked in addition to the
 * checksum, which shows only that the tables have not changed since they were generated.
 */
static bool indices_in_range(const pzs_structure *structure)
{
    for (uint32_t i = 0; i < (uint32_t)structure->nodes * structure->dof_per_node; i++)
        if (structure->node_dof[i] != PZS_CONSTRAINED &&
            structure->node_dof[i] >= structure->free_dof)
            return false;
    for (uint32_t i = 0; i < structure->free_dof; i++)
        if (structure->first_column[i] > i)
            return false;
    for (uint32_t element = 0; element < structure->elements; element++) {
        if (structure->element_type[element] >= structure->types)
            return false;
        for (int corner = 0; corner < SHELL_NODES; corner++)
            if (structure->element[element][corner] >= structure->nodes)
                return false;
        if (!element_in_envelope(structure, structure->element[element]))
            return false;
    }
    return rows_in_range(&structure->input, structure->free_dof) &&
           rows_in_range(&structure->output, structure->free_dof) &&
           rows_in_range(&structure->spring, structure->free_dof) &&
           pzs_springs_in_range(structure) && turns_in_range(structure) &&
           corners_in_range(structure);
}

/*
 * Return the size of the workspace of a model of the structure (bytes), if the envelope of its
 * stiffness matrix stores `entries` entries.
 */
static size_t workspace_bytes(const pzs_structure *structure, uint32_t free_dof, size_t entries)
{
    const size_t rebuilt = structure->compact != NULL ? PZS_COMPACT_BYTES : 0;
    return PZS_MODEL_BYTES(free_dof, entries) + rebuilt;
}

pzs_status pzs_model_init(pzs_model *model, const pzs_structure *structure, void *work,
                          size_t bytes)
{
    if (!model || !structure || !work)
        return PZS_E_ARGUMENT;
    memset(model, 0, sizeof *model);
    model->info.where = -1;
    if (structure->format != PZS_TABLE_FORMAT)
        return PZS_E_FORMAT;
    if (!structure_complete(structure))
        return PZS_E_ARGUMENT;
    if (!pzs_structure_rows_fit(structure) || pzs_structure_crc(structure) != structure->crc)
        return PZS_E_CRC;
    if (!indices_in_range(structure))
        return PZS_E_ARGUMENT;

    const uint32_t free_dof = structure->free_dof;
    const size_t entries = pzs_linalg_reals(structure->first_column, free_dof);
    if (entries > SIZE_MAX / 2 / sizeof(pzs_real))
        return fail(model, PZS_E_WORKSPACE, INT32_MAX);
    const int32_t missing =
        guard_missing_bytes(work, bytes, workspace_bytes(structure, free_dof, entries));
    if (missing >= 0)
        return fail(model, PZS_E_WORKSPACE, missing);

    pzs_real *real = work;
    model->state.structure = structure;
    model->state.stiffness.n = free_dof;
    model->state.stiffness.first = structure->first_column;
    model->state.stiffness.value = real;
    model->state.stiffness.inverse = real + entries;
    model->state.scale = model->state.stiffness.inverse + free_dof;
    model->state.work = model->state.scale + free_dof;
    real = model->state.work + 6 * (size_t)free_dof;
    if (structure->compact != NULL) {
        model->state.rebuilt = (pzs_element_type *)(void *)real;
        real += sizeof(pzs_element_type) / sizeof *real;
    }
    model->state.stiffness.start = (uint32_t *)(void *)real;
    pzs_linalg_layout(&model->state.stiffness);
    model->info.residual = -1;
    model->state.stage = STAGE_READY;
    return PZS_OK;
}

/* ---- assemble --------------------------------------------------------- */

/*
 * Return `dof`, the index of a free degree of freedom, or PZS_CONSTRAINED if the degree of freedom
 * is constrained: by a support, where the argument is PZS_CONSTRAINED already, or by the array
 * `constrained` of the last call of pzs_assemble.
 */
static uint16_t unconstrained_dof(const pzs_model *model, uint16_t dof)
{
    return dof != PZS_CONSTRAINED && model->state.constrained && model->state.constrained[dof]
               ? PZS_CONSTRAINED
               : dof;
}

/* Return the indices of the free degrees of freedom of a node, an array of dof_per_node indices. */
static const uint16_t *node_dofs(const pzs_model *model, uint16_t node)
{
    return model->state.structure->node_dof + (size_t)node * model->state.structure->dof_per_node;
}

const pzs_real (*pzs_model_turn(const pzs_structure *structure, uint16_t node))[3]
{
    if (structure->turns == 0 || structure->node_turn[node] == PZS_UNTURNED)
        return NULL;
    return structure->turn[structure->node_turn[node]];
}

/*
 * Direction in which a rotation converts the displacements of a node at an oblique support (mean of
 * both faces of the shell): into components in the triad (local axes), or from them.
 */
typedef enum turn_way { OUT_OF_TRIAD, INTO_TRIAD } turn_way;

/*
 * Convert displacements of some nodes, or forces on them, between the triads (local axes) of the
 * nodes and the axes of their degrees of freedom. Only the first three of each node change (mean of
 * both faces of the shell), and only at oblique supports.
 *   gathered [count dof_per_node] in/out  degrees of freedom of the nodes
 */
static void turn_nodes(const pzs_structure *structure, const uint16_t *node, unsigned count,
                       turn_way way, pzs_real *gathered)
{
    for (unsigned at = 0; at < count && structure->turns > 0; at++) {
        const pzs_real(*turn)[3] = pzs_model_turn(structure, node[at]);
        pzs_real *own = gathered + (size_t)at * structure->dof_per_node;
        if (!turn)
            continue;
        const pzs_real before[3] = {own[0], own[1], own[2]};
        for (int i = 0; i < 3; i++) {
            own[i] = 0;
            for (int j = 0; j < 3; j++)
                own[i] += before[j] * (way == INTO_TRIAD ? turn[j][i] : turn[i][j]);
        }
    }
}

pzs_real pzs_model_type_factor(const pzs_model *model, uint32_t element)
{
    return model->state.stiffness_factor
               ? model->state.stiffness_factor[model->state.structure->element_type[element]]
               : 1;
}

/*
 * Place of one degree of freedom of an element in the stored stiffness matrix, both as a row and as
 * a column. The entry in row a and column b has the index (base of a) + (step of b).
 *   base  index of column 0 in the row of this degree of freedom; as an unsigned number it may wrap
 *         round where column 0 is not stored, but the sum is correct
 *   step  number of reals from column 0 to the column of this degree of freedom: PZS_TILE times the
 *         number of the column, because PZS_TILE rows are stored together, column after column
 */
typedef struct add_place {
    uint16_t dof;
    uint8_t local;
    size_t base, step;
} add_place;

/*
 * Find, for the unconstrained degrees of freedom of `count` nodes, where their rows and columns are
 * stored in the stiffness matrix (envelope form).
 *   place [count dof_per_node] out  storage position of each of these degrees of freedom
 * Returns the number of these degrees of freedom.
 */
static unsigned free_places(const pzs_model *model, const uint16_t *node, unsigned count,
                            add_place *place)
{
    const unsigned dof_per_node = model->state.structure->dof_per_node;
    unsigned found = 0;
    for (unsigned i = 0; i < count * dof_per_node; i++) {
        const uint16_t dof =
            unconstrained_dof(model, node_dofs(model, node[i / dof_per_node])[i % dof_per_node]);
        if (dof == PZS_CONSTRAINED)
            continue;
        const size_t step = (size_t)dof * PZS_TILE,
                     diagonal = (size_t)(pzs_linalg_entry(&model->state.stiffness, dof, dof) -
                                         model->state.stiffness.value);
        place[found++] = (add_place){dof, (uint8_t)i, diagonal - step, step};
    }
    return found;
}

static bool has_turned_node(const pzs_structure *structure, const uint16_t *node, unsigned count)
{
    bool found = false;
    for (unsigned at = 0; at < count; at++)
        found |= pzs_model_turn(structure, node[at]) != NULL;
    return found;
}

/*
 * Compute one row of a symmetric matrix over the degrees of freedom of some nodes from the matrix
 * in the triads (local axes) of these nodes.
 *   entry [SHELL_PACKED(count dof_per_node)] in   packed lower triangle of the matrix in the triads
 *   i                                        in   index of the row
 *   row   [count dof_per_node]               out  row along the axes of the degrees of freedom
 */
static void turned_row(const pzs_structure *structure, const uint16_t *node, unsigned count,
                       const pzs_real *entry, unsigned i, pzs_real *row)
{
    const unsigned dof_per_node = structure->dof_per_node, first = i - i % dof_per_node;
    pzs_real unit[SHELL_MAX] = {0};
    unit[i] = 1;
    turn_nodes(structure, node, count, INTO_TRIAD, unit);
    for (unsigned j = 0; j < count * dof_per_node; j++) {
        row[j] = 0;
        for (unsigned k = first; k < first + dof_per_node; k++)
            row[j] += unit[k] * entry[k > j ? SHELL_PACKED(k) + j : SHELL_PACKED(j) + k];
    }
    turn_nodes(structure, node, count, OUT_OF_TRIAD, row);
}

void pzs_model_add_matrix(pzs_model *model, const uint16_t *node, unsigned count, pzs_real factor,
                          const pzs_real *entry)
{
    add_place place[SHELL_MAX];
    pzs_real turned[SHELL_MAX];
    const pzs_structure *structure = model->state.structure;
    const unsigned found = free_places(model, node, count, place);
    const bool is_turned = structure->turns > 0 && has_turned_node(structure, node, count);
    pzs_real *value = model->state.stiffness.value;
    for (const add_place *row_place = place; row_place < place + found; row_place++) {
        const pzs_real *row = entry + SHELL_PACKED((unsigned)row_place->local);
        if (is_turned) {
            turned_row(structure, node, count, entry, row_place->local, turned);
            row = turned;
        }
        for (const add_place *column_place = place; column_place <= row_place; column_place++)
            value[row_place->dof > column_place->dof ? row_place->base + column_place->step
                                                     : column_place->base + row_place->step] +=
                factor * row[column_place->local];
    }
}

/*
 * Return the number, among the free degrees of freedom of the structure, of degree of freedom i of
 * an element. The result is PZS_CONSTRAINED if a support or the last assembly of the stiffness
 * matrix constrains it.
 */
static uint16_t element_dof(const pzs_model *model, uint32_t element, unsigned i)
{
    const pzs_structure *structure = model->state.structure;
    const uint16_t node = structure->element[element][i / structure->dof_per_node];
    return unconstrained_dof(model, node_dofs(model, node)[i % structure->dof_per_node]);
}

/*
 * Add the stiffness matrix of an element, if the tables do not contain this matrix, to the
 * stiffness matrix of the structure. Each row is computed as the force of a unit displacement of
 * one degree of freedom.
 */
static void add_computed_matrix(pzs_model *model, uint32_t element)
{
    const pzs_structure *structure = model->state.structure;
    const pzs_element_type *type = pzs_model_element_type(model, element);
    for (unsigned i = 0; i < SHELL_NODES * (unsigned)structure->dof_per_node; i++) {
        const uint16_t row = element_dof(model, element, i);
        pzs_real force[SHELL_MAX] = {0}; /* in: nodal displacement of the element; out: nodal force
                                            that the stiffness of the element causes */
        if (row == PZS_CONSTRAINED)
            continue;
        force[i] = 1;
        turn_nodes(structure, structure->element[element], SHELL_NODES, INTO_TRIAD, force);
        pzs_shell_force(type, structure->dof_per_node, force, force);
        turn_nodes(structure, structure->element[element], SHELL_NODES, OUT_OF_TRIAD, force);
        for (unsigned j = 0; j <= i; j++) {
            const uint16_t column = element_dof(model, element, j);
            if (column == PZS_CONSTRAINED)
                continue;
            const uint16_t larger = row > column ? row : column;
            const uint16_t smaller = row > column ? column : row;
            *pzs_linalg_entry(&model->state.stiffness, larger, smaller) +=
                pzs_model_type_factor(model, element) * force[j];
        }
    }
}

/*
 * Add the stiffness matrix of an element to the stiffness matrix of the structure. The element's
 * matrix is taken from the tables if they contain it, otherwise computed.
 */
static void add_element(pzs_model *model, uint32_t element)
{
    const pzs_structure *structure = model->state.structure;
    const size_t packed = SHELL_PACKED(SHELL_NODES * (size_t)structure->dof_per_node);
    if (structure->stiffness)
        pzs_model_add_matrix(model, structure->element[element], SHELL_NODES,
                             pzs_model_type_factor(model, element),
                             structure->stiffness + structure->element_type[element] * packed);
    else
        add_computed_matrix(model, element);
}

static pzs_status check_factors(pzs_model *model, const pzs_real *stiffness_factor)
{
    if (!stiffness_factor)
        return PZS_OK;
    const int32_t bad = pzs_guard_nonfinite(stiffness_factor, model->state.structure->types);
    if (bad >= 0)
        return fail(model, PZS_E_NONFINITE, bad);
    for (int32_t k = 0; k < model->state.structure->types; k++)
        if (stiffness_factor[k] < 0)
            return fail(model, PZS_E_ARGUMENT, k);
    return PZS_OK;
}

pzs_status pzs_assemble(pzs_model *model, const pzs_real *stiffness_factor,
                        const uint8_t *constrained)
{
    if (!model)
        return PZS_E_ARGUMENT;
    if (model->state.stage < STAGE_READY)
        return fail(model, PZS_E_STAGE, -1);
    const pzs_status status = check_factors(model, stiffness_factor);
    if (status != PZS_OK)
        return status;

    model->state.stiffness_factor = stiffness_factor;
    model->state.constrained = constrained;
    pzs_linalg_clear(&model->state.stiffness);
    const pzs_structure *structure = model->state.structure;
    for (uint32_t element = 0; element < structure->elements; element++)
        add_element(model, element);
    pzs_model_add_springs(model);
    for (uint32_t i = 0; constrained && i < model->state.stiffness.n; i++)
        if (constrained[i])
            *pzs_linalg_entry(&model->state.stiffness, i, i) = 1;
    model->state.stage = STAGE_ASSEMBLED;
    return fail(model, PZS_OK, -1);
}

/* ---- factor ----------------------------------------------------------- */

/*
 * Largest condition number of the stiffness matrix that pzs_factor accepts; no well-supported
 * structure reaches 1e14. The relative error of a solve is about the condition number times the
 * machine epsilon. Refined solutions allow more, because the factors are only their preconditioner.
 */
static pzs_real condition_limit(const pzs_model *model)
{
    const pzs_real limit =
        (pzs_structure_has_types(model->state.structure) ? (pzs_real)600 : (pzs_real)1.2) /
        PZS_EPSILON;
    return limit < (pzs_real)1e14 ? limit : (pzs_real)1e14;
}

pzs_status pzs_factor(pzs_model *model)
{
    if (!model)
        return PZS_E_ARGUMENT;
    if (model->state.stage != STAGE_ASSEMBLED)
        return fail(model, PZS_E_STAGE, -1);
    model->state.stage = STAGE_READY; /* From here on, the memory of the stiffness matrix is
                                         overwritten by its factors, even if an error follows. */

    const int32_t unsupported = pzs_linalg_scale(&model->state.stiffness, model->state.scale);
    if (unsupported >= 0)
        return fail(model, PZS_E_LOOSE, unsupported);
    const pzs_real norm = pzs_linalg_norm1(&model->state.stiffness, model->state.work);
    const linalg_inertia inertia = pzs_linalg_factor(&model->state.stiffness);
    model->info.negative_pivots = (uint16_t)inertia.negative;
    if (inertia.zero >= 0)
        return fail(model, PZS_E_LOOSE, inertia.zero);
    if (inertia.negative > 0)
        return fail(model, PZS_E_NEGATIVE, inertia.first_negative);
    model->info.condition = pzs_linalg_condition(&model->state.stiffness, norm, model->state.work);
    if (!(model->info.condition <= condition_limit(model)))
        return fail(model, PZS_E_CONDITION, -1);
    model->state.stage = STAGE_FACTORED;
    return fail(model, PZS_OK, -1);
}

/* ---- solve ------------------------------------------------------------ */

void pzs_model_gather(const pzs_model *model, const uint16_t *node, unsigned count,
                      const pzs_real *vector, pzs_real *gathered)
{
    const unsigned dof_per_node = model->state.structure->dof_per_node;
    pzs_real *next = gathered;
    for (unsigned at = 0; at < count; at++)
        for (unsigned i = 0; i < dof_per_node; i++) {
            const uint16_t dof = unconstrained_dof(model, node_dofs(model, node[at])[i]);
            *next++ = dof == PZS_CONSTRAINED ? 0 : vector[dof];
        }
    turn_nodes(model->state.structure, node, count, INTO_TRIAD, gathered);
}

void pzs_model_scatter(const pzs_model *model, const uint16_t *node, unsigned count,
                       pzs_real factor, const pzs_real *gathered, pzs_real *vector)
{
    const unsigned dof_per_node = model->state.structure->dof_per_node;
    for (unsigned at = 0; at < count; at++) {
        pzs_real own[SHELL_MAX / SHELL_NODES];
        memcpy(own, gathered + (size_t)at * dof_per_node, dof_per_node * sizeof *own);
        turn_nodes(model->state.structure, node + at, 1, OUT_OF_TRIAD, own);
        for (unsigned i = 0; i < dof_per_node; i++) {
            const uint16_t dof = unconstrained_dof(model, node_dofs(model, node[at])[i]);
            if (dof != PZS_CONSTRAINED)
                vector[dof] += factor * own[i];
        }
    }
}

/*
 * Add the product of the stiffness matrix, and of state.term, with `vector` to `force`, both
 * [free_dof], summed over the elements from their strains, and over the springs.
 */
static void add_force(const pzs_model *model, const pzs_real *vector, pzs_real *force)
{
    const pzs_structure *structure = model->state.structure;
    for (uint32_t element = 0; element < structure->elements; element++) {
        pzs_real element_vector[SHELL_MAX]; /* in: nodal displacement of the element; out: nodal
                                               force that the stiffness of the element causes */
        pzs_model_gather(model, structure->element[element], SHELL_NODES, vector, element_vector);
        pzs_shell_force(pzs_model_element_type(model, element), structure->dof_per_node,
                        element_vector, element_vector);
        pzs_model_scatter(model, structure->element[element], SHELL_NODES,
                          pzs_model_type_factor(model, element), element_vector, force);
    }
    pzs_model_add_spring_force(model, 1, vector, force);
    if (model->state.term)
        model->state.term->add_term_product(model->state.term, vector, force);
}

void pzs_model_backsolve(const pzs_model *model, const pzs_real *force, pzs_real *displacement)
{
    for (uint32_t i = 0; i < model->state.stiffness.n; i++)
        displacement[i] = model->state.scale[i] * force[i];
    pzs_linalg_solve(&model->state.stiffness, displacement);
    for (uint32_t i = 0; i < model->state.stiffness.n; i++)
        displacement[i] *= model->state.scale[i];
}

pzs_real pzs_model_scaled_norm2(const pzs_model *model, const pzs_real *force)
{
    pzs_real sum = 0;
    for (uint32_t i = 0; i < model->state.stiffness.n; i++)
        sum += model->state.scale[i] * force[i] * (model->state.scale[i] * force[i]);
    return sum;
}

/*
 * Solve K u = r with the stiffness matrix K by conjugate gradients, in at most REFINEMENT_LIMIT
 * iterations. The factors of K are the preconditioner; products with K are computed from the
 * strains of the elements, which is more accurate.
 *   r [free_dof] in/out  in: force; out: residual force
 *   u [free_dof] out     displacement
 */
static void refine(pzs_model *model, pzs_real *r, pzs_real *u)
{
    const uint32_t n = model->state.stiffness.n;
    pzs_real *z = model->state.work + 2 * (size_t)n, *p = z + n, *kp = p + n;
    pzs_real energy = 0;
    pzs_model_backsolve(model, r, z);
    memcpy(p, z, n * sizeof *p);
    memset(u, 0, n * sizeof *u);
    pzs_real residual_energy = pzs_linalg_inner(r, z, n);
    // Iterate until the squared error of the displacement u in the energy norm is below the
    // rounding error of the strain energy of u.
    for (model->info.refinements = 0; model->info.refinements < REFINEMENT_LIMIT &&
                                      residual_energy > energy * PZS_EPSILON * PZS_EPSILON;) {
        memset(kp, 0, n * sizeof *kp);
        add_force(model, p, kp);
        const pzs_real curvature = pzs_linalg_inner(p, kp, n);
        if (!(curvature > 0))
            return;
        const pzs_real step = residual_energy / curvature;
        for (uint32_t i = 0; i < n; i++) {
            u[i] += step * p[i];
            r[i] -= step * kp[i];
        }
        energy += step * residual_energy;
        model->info.refinements++;
        pzs_model_backsolve(model, r, z);
        const pzs_real next = pzs_linalg_inner(r, z, n);
        const pzs_real ratio = next / residual_energy;
        for (uint32_t i = 0; i < n; i++)
            p[i] = z[i] + ratio * p[i];
        residual_energy = next;
    }
}

void pzs_model_add_input(const pzs_model *model, uint32_t j, pzs_real value, pzs_real *force)
{
    const pzs_rows *in = &model->state.structure->input;
    for (uint32_t entry = in->start[j]; entry < in->start[j + 1]; entry++)
        if (!(model->state.constrained && model->state.constrained[in->dof[entry]]))
            force[in->dof[entry]] += value * in->value[entry];
}

/*
 * Write two measures of the error of a displacement into model->info: `residual`, the relative
 * residual of the stiffness equations, and `error_estimate`, the relative error in the energy norm.
 *   residual, correction [free_dof] out  work arrays
 */
static void estimate_error(pzs_model *model, const pzs_real *force, const pzs_real *displacement,
                           pzs_real *residual, pzs_real *correction)
{
    const uint32_t free_dof = model->state.stiffness.n;
    const pzs_real load = pzs_model_scaled_norm2(model, force),
                   energy = pzs_linalg_inner(force, displacement, free_dof);
    memset(residual, 0, free_dof * sizeof *residual);
    add_force(model, displacement, residual);
    for (uint32_t i = 0; i < free_dof; i++)
        residual[i] = force[i] - residual[i];
    pzs_model_backsolve(model, residual, correction);
    const pzs_real error = pzs_linalg_inner(residual, correction, free_dof);
    /*
     * Rounding errors may make a tiny squared error of the displacement negative; it then counts as
     * 0. A NaN must stay NaN.
     */
    model->info.residual = load <= 0 ? 0 : PZS_SQRT(pzs_model_scaled_norm2(model, residual) / load);
    const pzs_real error2 = error < 0 ? 0 : error;
    model->info.error_estimate = load <= 0 ? 0 : PZS_SQRT(error2 / energy);
}

/*
 * Multiply a force by a power of two that brings its largest scaled entry near 1, so that the
 * squares of its entries neither overflow nor underflow. Returns the power of two.
 */
static pzs_real scale_force(const pzs_model *model, pzs_real *force)
{
    pzs_real largest = 0, unit = 1;
    for (uint32_t i = 0; i < model->state.stiffness.n; i++) {
        const pzs_real size = model->state.scale[i] * (force[i] < 0 ? -force[i] : force[i]);
        largest = size > largest ? size : largest;
    }
    for (int i = 0; i < 100 && largest > 0 && largest < (pzs_real)0.5; i++) {
        largest *= 2;
        unit *= 2;
    }
    for (int i = 0; i < 100 && largest > 1; i++) {
        largest /= 2;
        unit /= 2;
    }
    for (uint32_t i = 0; i < model->state.stiffness.n; i++)
        force[i] *= unit;
    return unit;
}

/*
 * Solve for the displacement under the force in the first row of the work array of the model. If
 * the structure has stored element matrices (element types), the solution is refined by iterations
 * with residuals that are computed from the strains of the elements. displacement [free_dof] out
 * solution
 */
static void solve_scaled(pzs_model *model, pzs_real *displacement)
{
    pzs_real *force = model->state.work, *residual = force + model->state.stiffness.n;
    model->info.refinements = 0;
    model->info.residual = -1;
    model->info.error_estimate = -1;
    if (!pzs_structure_has_types(model->state.structure)) {
        pzs_model_backsolve(model, force, displacement);
        return;
    }
    memcpy(residual, force, model->state.stiffness.n * sizeof *residual);
    refine(model, residual, displacement);
    estimate_error(model, force, displacement, residual, residual + model->state.stiffness.n);
}

pzs_status pzs_model_solve_force(pzs_model *model, pzs_real *displacement)
{
    const pzs_real unit = scale_force(model, model->state.work);
    solve_scaled(model, displacement);
    for (uint32_t i = 0; i < model->state.stiffness.n; i++)
        displacement[i] /= unit;
    /*
     * With an estimated error of NaN the comparison is false, so that PZS_E_RESIDUAL is returned.
     */
    return model->info.error_estimate < PZS_SQRT(PZS_EPSILON) &&
                   pzs_guard_nonfinite(displacement, model->state.stiffness.n) < 0
               ? PZS_OK
               : PZS_E_RESIDUAL;
}

pzs_status pzs_solve(pzs_model *model, const pzs_real *value, pzs_real *displacement)
{
    if (!model || !value || !displacement)
        return PZS_E_ARGUMENT;
    if (model->state.stage != STAGE_FACTORED)
        return fail(model, PZS_E_STAGE, -1);
    const uint32_t inputs = model->state.structure->input.count;
    const int32_t bad = pzs_guard_nonfinite(value, inputs);
    if (bad >= 0)
        return fail(model, PZS_E_NONFINITE, bad);
    memset(model->state.work, 0, model->state.stiffness.n * sizeof *model->state.work);
    for (uint32_t j = 0; j < inputs; j++)
        if (value[j] != 0)
            pzs_model_add_input(model, j, value[j], model->state.work);
    return fail(model, pzs_model_solve_force(model, displacement), -1);
}

/* ---- influence -------------------------------------------------------- */

pzs_real pzs_model_observe_row(const pzs_structure *structure, const pzs_real *displacement,
                               uint32_t row)
{
    pzs_real sum = 0;
    for (uint32_t entry = structure->output.start[row]; entry < structure->output.start[row + 1];
         entry++)
        sum += structure->output.value[entry] * displacement[structure->output.dof[entry]];
    return sum;
}

void pzs_observe(const pzs_structure *structure, const pzs_real *displacement, pzs_real *output)
{
    for (uint32_t row = 0; row < structure->output.count; row++)
        output[row] = pzs_model_observe_row(structure, displacement, row);
}

pzs_status pzs_influence(pzs_model *model, pzs_real *influence)
{
    if (!model || !influence)
        return PZS_E_ARGUMENT;
    if (model->state.stage != STAGE_FACTORED)
        return fail(model, PZS_E_STAGE, -1);
    const pzs_structure *structure = model->state.structure;
    pzs_real *displacement = model->state.work + 5 * (size_t)model->state.stiffness.n;
    for (uint32_t j = 0; j < structure->input.count; j++) {
        memset(model->state.work, 0, model->state.stiffness.n * sizeof *model->state.work);
        pzs_model_add_input(model, j, 1, model->state.work);
        const pzs_status status = pzs_model_solve_force(model, displacement);
        if (status != PZS_OK)
            return fail(model, status, (int32_t)j);
        for (uint32_t i = 0; i < structure->output.count; i++)
            influence[(size_t)i * structure->input.count + j] =
                pzs_model_observe_row(structure, displacement, i);
    }
    return fail(model, PZS_OK, -1);
}
