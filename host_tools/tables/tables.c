/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Generated C tables of a firmware with the control, linear or nonlinear part of the library
 * (tables.h).
 */
#include "tables.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/electrode.h"
#include "../../lib/control/control.h"
#include "../../lib/model/model.h"
#include "../../lib/core/guard.h"
#include "../../lib/model/shell.h"
#include "../mesh/compact_types.h"
#include "../model/curves.h"
#include "../text/words.h"
#include "loop_blocks.h"
#include "tables_modes.h"
#include "tables_nonlinear.h"

const char *const tables_image_name[TABLES_IMAGES] = {
    [TABLES_CONTROL] = "control", [TABLES_LINEAR] = "linear", [TABLES_NONLINEAR] = "nonlinear"};

/* ---- mechanical structure --------------------------------------------- */

static void write_elements(emitter *emitter, const mesh *mesh)
{
    emit_comment(emitter, "nodes of each element, at the corners (-,-), (+,-), (+,+), (-,+)");
    fprintf(emitter->file, "static const uint16_t %s_element[%d][4] = {", emitter->prefix,
            mesh->elements);
    for (int element = 0; element < mesh->elements; element++)
        fprintf(emitter->file, "%s{%u, %u, %u, %u},", element % 4 == 0 ? "\n    " : " ",
                mesh->element[element][0], mesh->element[element][1], mesh->element[element][2],
                mesh->element[element][3]);
    fputs("\n};\n", emitter->file);
    emit_count_bytes(emitter, mesh->element, (size_t)mesh->elements * sizeof *mesh->element);
}

/*
 * Write the element types: constants at the four corners of an element, member by member in the
 * order of pzs_element_type.
 */
static void write_element_types(emitter *emitter, const mesh *mesh)
{
    static const int coupling[4] = {4, 2, 3, 3}, base[3] = {4, 2, 3};
    static const int modes[1] = {88}, squares[2] = {2, 3}, warps[1] = {9}, skews[1] = {3};
    emit_comment(emitter, "corner tables of each element type");
    fprintf(emitter->file, "static const pzs_element_type %s_element_types[%d] = {",
            emitter->prefix, mesh->types);
    for (int k = 0; k < mesh->types; k++) {
        const pzs_element_type *type = &mesh->type[k];
        fputs("{\n    ", emitter->file);
        emit_nested(emitter->file, &type->s[0][0][0][0], coupling, 4);
        fputs(",\n    ", emitter->file);
        emit_nested(emitter->file, &type->t[0][0][0][0], coupling, 4);
        fputs(",\n    ", emitter->file);
        emit_nested(emitter->file, &type->g_mean[0][0][0], base, 3);
        fputs(",\n    ", emitter->file);
        emit_nested(emitter->file, &type->g_diff[0][0][0], base, 3);
        fputs(",\n    ", emitter->file);
        emit_nested(emitter->file, type->d, modes, 1);
        fputs(", PZS_R(", emitter->file);
        emit_real(emitter->file, type->thickness);
        fputs("), ", emitter->file);
        emit_nested(emitter->file, &type->height_squared[0][0], squares, 2);
        fputs(",\n    ", emitter->file);
        emit_nested(emitter->file, type->warp, warps, 1);
        fputs(",\n    ", emitter->file);
        emit_nested(emitter->file, type->skew, skews, 1);
        fputs("\n}, ", emitter->file);
        emit_count_reals(emitter, (const double *)type, sizeof *type / sizeof(double));
    }
    fputs("\n};\n", emitter->file);
}

/*
 * Write an array of reals as a value in braces, and add it to the size and the checksum of the
 * tables.
 */
static void write_group(emitter *emitter, const double *value, int count)
{
    emit_nested(emitter->file, value, &count, 1);
    fputs(",\n    ", emitter->file);
    emit_count_reals(emitter, value, (size_t)count);
}

/*
 * Write two rows of three reals as a nested value in braces, and add them to the size and the
 * checksum of the tables.
 */
static void write_lines(emitter *emitter, const double value[2][3])
{
    static const int size[2] = {2, 3};
    emit_nested(emitter->file, &value[0][0], size, 2);
    fputs(",\n    ", emitter->file);
    emit_count_reals(emitter, &value[0][0], 6);
}

/* Write a real, and add it to the size and the checksum of the tables. */
static void write_single(emitter *emitter, double value)
{
    fputs("PZS_R(", emitter->file);
    emit_real(emitter->file, value);
    fputs("), ", emitter->file);
    emit_count_reals(emitter, &value, 1);
}

/*
 * Write the compact element types (pzs_compact_type), member by member in the order of the struct.
 * They lack the matrices that the firmware computes from the nodes.
 */
static void write_compact_types(emitter *emitter, const compact_types *compact, int types)
{
    emit_comment(emitter, "element types in compact form");
    fprintf(emitter->file, "static const pzs_compact_type %s_compact_types[%d] = {",
            emitter->prefix, types);
    for (int k = 0; k < types; k++) {
        const pzs_compact_type *type = &compact->type[k];
        fputs("{\n    ", emitter->file);
        write_group(emitter, type->d, 88);
        write_single(emitter, type->thickness);
        write_lines(emitter, type->height_squared);
        write_single(emitter, type->middle);
        write_group(emitter, type->warp, 9);
        write_group(emitter, type->skew, 3);
        write_group(emitter, type->inverse_length, 2);
        fprintf(emitter->file, "{%u, %u, %u, %u}\n}, ", type->corner[0], type->corner[1],
                type->corner[2], type->corner[3]);
        emit_count_bytes(emitter, type->corner, sizeof type->corner);
    }
    fputs("\n};\n", emitter->file);
}

/*
 * Write position and triad (local axes) of each node, from which a device computes those numbers of
 * the element types that the tables leave out.
 */
static void write_nodes(emitter *emitter, const pzs_node *node, int nodes)
{
    static const int axes[2] = {3, 3};
    emit_comment(emitter, "position and local axes of each node");
    fprintf(emitter->file, "static const pzs_node %s_nodes[%d] = {", emitter->prefix, nodes);
    for (int i = 0; i < nodes; i++) {
        fputs("{\n    ", emitter->file);
        write_group(emitter, node[i].position, 3);
        emit_nested(emitter->file, node[i].triad[0], axes, 2);
        fputs("\n}, ", emitter->file);
        emit_count_reals(emitter, node[i].triad[0], 9);
    }
    fputs("\n};\n", emitter->file);
}

static void write_rows(emitter *emitter, const char *name, const pzs_rows *rows, uint16_t count,
                       const char *meaning)
{
    char array[64];
    if (count == 0)
        return;
    const uint32_t terms = rows->start[count];
    emit_comment(emitter, "%s", meaning);
    snprintf(array, sizeof array, "%s_start", name);
    emit_longs(emitter, array, rows->start, count + 1u);
    snprintf(array, sizeof array, "%s_dof", name);
    emit_shorts(emitter, array, rows->dof, terms, "free dof of each entry of these sparse rows");
    snprintf(array, sizeof array, "%s_value", name);
    emit_reals(emitter, array, rows->value, terms, "weight of each entry of these sparse rows");
}

static void name_rows(const emitter *emitter, const char *name, uint16_t count)
{
    if (count == 0)
        fputs("    {0, NULL, NULL, NULL},\n", emitter->file);
    else
        fprintf(emitter->file, "    {%u, %s_%s_start, %s_%s_dof, %s_%s_value},\n", count,
                emitter->prefix, name, emitter->prefix, name, emitter->prefix, name);
}

/*
 * Write the name PREFIX_name of an array to `text`, or NULL where the tables do not contain this
 * array.
 */
static void name_or_null(const emitter *emitter, int is_written, const char *name, char text[128])
{
    if (is_written)
        snprintf(text, 128, "%.100s_%s", emitter->prefix, name);
    else
        snprintf(text, 128, "NULL");
}

/*
 * Return how many numbers the triangular factor of the stiffness matrix takes in memory. It is
 * stored in panels of `tile` rows. All rows of a panel begin at the same column, a multiple of
 * `tile`, so that the panels contain zeros, which are counted.
 */
static size_t padded_entries(const mesh *mesh, int tile)
{
    size_t entries = 0;
    for (int row = 0; row < mesh->free_dof; row += tile) {
        int left = row;
        for (int i = row; i < mesh->free_dof && i < row + tile; i++)
            if (mesh->first_column[i] < left)
                left = mesh->first_column[i];
        entries += (size_t)(row + tile - left / tile * tile) * (size_t)tile;
    }
    return entries;
}

/*
 * Return the structure with only those inputs and outputs that the controller uses: the voltages of
 * the amplifiers and the displacements of the target nodes.
 */
static pzs_structure controlled(const analysis *analysis)
{
    pzs_structure structure = analysis->design.structure;
    structure.input.count = (uint16_t)analysis->design.amplifiers;
    structure.output.count = (uint16_t)analysis->design.targets;
    structure.crc = pzs_structure_crc(&structure);
    return structure;
}

/*
 * Return the structure that the tables contain. With the option --compact it has no element
 * stiffness matrices.
 *   whole in  true: with all inputs and outputs; false: with those of the controller alone
 */
static pzs_structure structure_of_tables(const analysis *analysis, int whole,
                                         const compact_types *compact)
{
    pzs_structure structure = whole ? analysis->design.structure : controlled(analysis);
    if (!analysis->is_compact)
        return structure;
    structure.stiffness = NULL;
    structure.compact = compact->type;
    structure.node = compact->node;
    /*
     * If nearly every element has its own type, compact types replace the full ones, without the
     * matrices that the firmware computes from the nodes.
     */
    if (compact->type)
        structure.type = NULL;
    structure.crc = pzs_structure_crc(&structure);
    return structure;
}

/*
 * Write the mesh and the element types of the structure, with their stiffness matrices unless the
 * option --compact leaves these out.
 */
static void write_mesh(emitter *emitter, const mesh *mesh, const pzs_structure *structure,
                       const compact_types *compact)
{
    const size_t packed = SHELL_PACKED(4 * (size_t)mesh->dof_per_node);
    write_elements(emitter, mesh);
    emit_shorts(emitter, "element_type", mesh->element_type, (size_t)mesh->elements,
                "element type of each element");
    emit_shorts(emitter, "node_dof", mesh->node_dof, (size_t)mesh->nodes * mesh->dof_per_node,
                "free dof of each dof of each node, or PZS_CONSTRAINED");
    emit_shorts(emitter, "first_column", mesh->first_column, (size_t)mesh->free_dof,
                "first column of each row of the stiffness factor");
    if (structure->stiffness)
        emit_reals(emitter, "stiffness", mesh->stiffness, (size_t)mesh->types * packed,
                   "stiffness matrix of each element type, packed lower triangle (N/m, N)");
    if (structure->type) {
        write_element_types(emitter, mesh);
    } else {
        write_compact_types(emitter, compact, mesh->types);
        write_nodes(emitter, compact->node, mesh->nodes);
    }
}

/*
 * Write the axes of the displacements at nodes on oblique supports; without such nodes nothing is
 * written.
 */
static void write_turns(emitter *emitter, const mesh *mesh)
{
    static const int size[2] = {3, 3};
    if (mesh->turns == 0)
        return;
    emit_shorts(emitter, "node_turn", mesh->node_turn, (size_t)mesh->nodes,
                "rotation of the mean displacements of each node, or PZS_UNTURNED");
    emit_blocks(emitter, "turn", mesh->turn[0][0], (size_t)mesh->turns, size, 2,
                "axes of the mean displacements of each rotation in the triad of its node");
}

/*
 * Write the C struct of the mechanical structure (pzs_structure), after the arrays to which it
 * points.
 */
static void write_structure_struct(const emitter *emitter, const pzs_structure *structure)
{
    const char *prefix = emitter->prefix;
    char stiffness[128], type[128], compact[128], node[128];
    name_or_null(emitter, structure->stiffness != NULL, "stiffness", stiffness);
    name_or_null(emitter, structure->type != NULL, "element_types", type);
    name_or_null(emitter, structure->compact != NULL, "compact_types", compact);
    name_or_null(emitter, structure->node != NULL, "nodes", node);
    emit_begin(emitter, "structure", "structure", structure->scene, structure->crc);
    fprintf(emitter->file,
            " %u, %u, %u, %u, %u,\n    %s_element, %s_element_type, %s_node_dof, %s_first_column, "
            "%s, %s, %s, %s,\n",
            structure->nodes, structure->elements, structure->types, structure->dof_per_node,
            structure->free_dof, prefix, prefix, prefix, prefix, stiffness, type, compact, node);
    name_rows(emitter, "input", structure->input.count);
    name_rows(emitter, "output", structure->output.count);
    name_rows(emitter, "spring", structure->spring.count);
    if (structure->spring.count > 0)
        fprintf(emitter->file, "    %s_spring_stiffness,\n", prefix);
    else
        fputs("    NULL,\n", emitter->file);
    if (structure->turns > 0)
        fprintf(emitter->file, "    %u, %s_node_turn, %s_turn\n", structure->turns, prefix, prefix);
    else
        fputs("    0, NULL, NULL\n", emitter->file);
    fputs("};\n\n", emitter->file);
}

/*
 * Return the tables of the electrodes that a linear or nonlinear image contains; their count is 0
 * where it needs none.
 */
static const pzs_electrodes *table_electrodes(const analysis *analysis)
{
    const tables_modes *modes = analysis->device_modes;
    return modes && modes->open.count > 0 ? modes->open.electrodes : &analysis->design.electrodes;
}

static void write_structure(emitter *emitter, const analysis *analysis, tables_image image)
{
    const mesh *mesh = &analysis->design.mesh;
    const int whole = image == TABLES_NONLINEAR || table_electrodes(analysis)->count > 0;
    compact_types compact = {NULL, NULL};
    if (analysis->is_compact)
        compact_types_make(&compact, mesh);
    const pzs_structure structure = structure_of_tables(analysis, whole, &compact);
    const uint16_t counts[5] = {structure.nodes, structure.elements, structure.types,
                                structure.dof_per_node, structure.free_dof};
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    write_mesh(emitter, mesh, &structure, &compact);
    write_rows(emitter, "input", &structure.input, structure.input.count,
               whole ? "nodal forces per unit of each amplifier, load and extra input"
                     : "nodal forces per volt of each amplifier");
    write_rows(emitter, "output", &structure.output, structure.output.count,
               whole ? "weights of the free dof in each target node's displacement and each output"
                     : "weights of the free dof in each target node's displacement");
    write_rows(emitter, "spring", &structure.spring, structure.spring.count,
               "elongation of each spring per unit of the free dof");
    if (structure.spring.count > 0)
        emit_reals(emitter, "spring_stiffness", structure.spring_stiffness, structure.spring.count,
                   "stiffness of each spring (N/m)");
    write_turns(emitter, mesh);
    fprintf(emitter->file,
            "#define %s_FREE_DOF %d\n"
            "#define %s_MODEL_BYTES (PZS_MODEL_BYTES(%d, PZS_BY_TILE(%zu, %zu, %zu))%s)\n",
            emitter->upper, mesh->free_dof, emitter->upper, mesh->free_dof, padded_entries(mesh, 4),
            padded_entries(mesh, 8), padded_entries(mesh, 16),
            structure.compact ? " + PZS_COMPACT_BYTES" : "");
    write_structure_struct(emitter, &structure);
    compact_types_free(&compact);
}

/* ---- electrodes ------------------------------------------------------- */

/*
 * Write the tables of the electrodes, and the sizes of the workspaces that compute their charges in
 * the undeformed state and at an equilibrium. Nothing is written where the scene has no sensors and
 * asks for no charge, and no electrode is open while the structure vibrates.
 */
static void write_electrodes(emitter *emitter, const analysis *analysis)
{
    const pzs_electrodes *tables = table_electrodes(analysis);
    if (tables->count == 0)
        return;
    const uint32_t entries = tables->direct.start[tables->count],
                   open = pzs_electrode_open_count(tables);
    emitter->crc32 = GUARD_CRC_START;
    emit_shorts(emitter, "electrode_input", tables->input, tables->count,
                "input whose value is the voltage of each electrode");
    emit_bytes(emitter, "electrode_open", tables->open, tables->count,
               "1 where the electrode is open, 0 where its voltage is prescribed");
    emit_longs(emitter, "electrode_start", tables->direct.start, tables->count + 1u);
    emit_shorts(emitter, "electrode_dof", tables->direct.dof, entries,
                "inputs that draw charge to each electrode while the shell does not deform");
    emit_reals(emitter, "electrode_value", tables->direct.value, entries,
               "charge on each electrode per unit of each of its inputs (C/V, C/K)");
    fprintf(emitter->file,
            "#define %s_ELECTRODES %u\n#define %s_ELECTRIC_BYTES PZS_ELECTRIC_BYTES(%u, %u, %u)\n"
            "#define %s_CIRCUIT_BYTES PZS_CIRCUIT_BYTES(%u, %u)\n",
            emitter->upper, tables->count, emitter->upper, tables->count, (unsigned)open,
            analysis->design.structure.input.count, emitter->upper, tables->count, (unsigned)open);
    emit_begin(emitter, "electrodes", "electrodes", tables->scene, tables->crc);
    fprintf(emitter->file,
            " %u, %s_electrode_input, %s_electrode_open,\n"
            "    {%u, %s_electrode_start, %s_electrode_dof, %s_electrode_value},\n};\n\n",
            tables->count, emitter->prefix, emitter->prefix, tables->count, emitter->prefix,
            emitter->prefix, emitter->prefix);
}

/* ---- tables for large rotations --------------------------------------- */

static int write_nonlinear(emitter *emitter, const analysis *analysis)
{
    write_structure(emitter, analysis, TABLES_NONLINEAR);
    write_electrodes(emitter, analysis);
    if (analysis->device_modes)
        tables_modes_write(emitter, analysis->device_modes, &analysis->design);
    return tables_nonlinear(emitter, analysis);
}

/* ---- voltage optimisation problem -------------------------------------------------- */

/*
 * Write the influence matrix, unless the tables hold it as sparse rows, and the Hessian of the
 * voltage optimisation problem.
 */
static void write_influence(emitter *emitter, const design *design, const pzs_problem *problem)
{
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets;
    if (problem->influence)
        emit_reals(emitter, "influence", problem->influence, targets * amplifiers,
                   design->free_functions > 0
                       ? "influence matrix: displacement of each target node (row) per volt of "
                         "each amplifier (column), without the free functions of the target"
                       : "influence matrix: displacement of each target node (row) per volt of "
                         "each amplifier (column)");
    if (problem->hessian)
        emit_reals(emitter, "hessian", design->problem.hessian, amplifiers * amplifiers,
                   "Hessian B'W^2 B of the voltage optimisation problem, with influence matrix B "
                   "and weights W");
}

/*
 * Write the weights, limits and reference voltages (to which the regularisation draws the voltages)
 * of the least-squares problem for the voltages.
 */
static void write_limits(emitter *emitter, const design *design)
{
    const size_t amplifiers = (size_t)design->amplifiers;
    emit_reals(emitter, "weight", design->weight, (size_t)design->targets,
               "weight of each target node in the error of the shape");
    emit_limits(emitter, "lower", design->lower, amplifiers, 0,
                "lowest voltage of each amplifier (V)");
    emit_limits(emitter, "upper", design->upper, amplifiers, 1,
                "highest voltage of each amplifier (V)");
    emit_limits(emitter, "step_limit", design->step_limit, amplifiers, 1,
                "step limit: largest change of each amplifier's voltage in one tick (V)");
    emit_reals(emitter, "reference_voltage", design->reference_voltage, amplifiers,
               "voltage to which the regularisation draws each amplifier (V)");
}

/*
 * Write the limits of sums and differences of voltages, if there are any, in the order in which the
 * checksum covers them.
 */
static void write_limit_rows(emitter *emitter, const design *design)
{
    const uint16_t count = (uint16_t)design->limits.rows;
    const pzs_limit_rows *rows = &design->rows.tables;
    if (count == 0)
        return;
    emitter->crc32 = pzs_guard_crc(emitter->crc32, &count, sizeof count);
    write_rows(emitter, "limit_row", &rows->sums, count,
               "limits between amplifiers: factors of the voltages in each sum");
    emit_limits(emitter, "row_lower", rows->lower, count, 0, "lowest value of each sum (V)");
    emit_limits(emitter, "row_upper", rows->upper, count, 1, "highest value of each sum (V)");
    emit_reals(emitter, "safe", rows->safe, (size_t)design->amplifiers,
               "voltages inside all limits (V)");
    emitter->crc32 =
        pzs_guard_crc(emitter->crc32, &rows->absolute_count, sizeof rows->absolute_count);
    emit_comment(emitter, "limits between amplifiers; the number before the last member counts "
                          "those of sums of absolute values, which are the last ones");
    fprintf(emitter->file,
            "static const pzs_limit_rows %s_limit_rows = {\n    &pzs_limit_rows_calls,\n",
            emitter->prefix);
    name_rows(emitter, "limit_row", count);
    fprintf(emitter->file, "    %s_row_lower, %s_row_upper, %s_safe, %u, %s,\n};\n\n",
            emitter->prefix, emitter->prefix, emitter->prefix, rows->absolute_count,
            rows->absolute_count > 0 ? "&pzs_absolute_rows_calls" : "NULL");
}

/* Write the C struct of the voltage optimisation problem (pzs_problem), after the arrays to which
 * it points. */
static void write_problem_struct(const emitter *emitter, const pzs_problem *problem)
{
    char influence_name[128], hessian_name[128], rows_name[128], sparse_name[128];
    const char *rows_of = problem->limit_rows ? "&" : "";
    const char *sparse_of = problem->sparse ? "&" : "";
    name_or_null(emitter, problem->limit_rows != NULL, "limit_rows", rows_name);
    name_or_null(emitter, problem->influence != NULL, "influence", influence_name);
    name_or_null(emitter, problem->hessian != NULL, "hessian", hessian_name);
    name_or_null(emitter, problem->sparse != NULL, "sparse_influence", sparse_name);
    emit_comment(
        emitter,
        "voltage optimisation problem: least squares for the voltages within their limits; "
        "its member work_limit is the largest work of the optimiser in a tick (multiply-adds; 0: "
        "default)");
    emit_begin(emitter, "problem", "problem", problem->scene, pzs_problem_crc(problem));
    fprintf(emitter->file,
            " %u, %u,\n    %s, %s, %s_weight, %s_lower, %s_upper, %s_step_limit, "
            "%s_reference_voltage, PZS_R(%.17g),\n"
            "    %lluu /* work_limit */, %s%s, PZS_DUAL_METHOD(%u), %s%s,\n};\n\n",
            problem->inputs, problem->outputs, influence_name, hessian_name, emitter->prefix,
            emitter->prefix, emitter->prefix, emitter->prefix, emitter->prefix,
            problem->regularisation, (unsigned long long)problem->work_limit, rows_of, rows_name,
            problem->inputs, sparse_of, sparse_name);
}

/*
 * Write the sparse influence matrix of the least-squares problem for the voltages, if there is one.
 * It must be written after all other arrays of the problem, because the checksum runs over the
 * arrays in this order.
 */
static void write_sparse(emitter *emitter, const pzs_sparse_influence *sparse)
{
    if (sparse == NULL)
        return;
    write_rows(emitter, "influence", &sparse->rows, sparse->rows.count,
               "influence matrix: displacement of each target node (row) per volt of each "
               "amplifier (column), sparse rows of the entries that are not zero");
    fprintf(emitter->file,
            "static const pzs_sparse_influence %s_sparse_influence = {\n"
            "    &pzs_sparse_influence_calls,\n",
            emitter->prefix);
    name_rows(emitter, "influence", sparse->rows.count);
    fputs("};\n\n", emitter->file);
}

/*
 * Where the actuators have curves, state in a comment and by a macro of the tables that the
 * unknowns of the least-squares problem are not voltages but effects, values to which the
 * displacements of the actuators are proportional. The controller must then not be used without the
 * blocks of these curves.
 */
static void write_curve_note(const emitter *emitter, const design *design)
{
    if (!curves_are_used(design))
        return;
    emit_comment(emitter,
                 "The actuators have curves: the influence matrix is the displacement per volt of "
                 "effect. Use %s_blocks; pzs_step and pzs_tick alone would take effects for "
                 "voltages.",
                 emitter->prefix);
    fprintf(emitter->file, "#define %s_CURVES 1\n", emitter->upper);
}

/*
 * Write the arrays and the C struct of the least-squares problem for the voltages.
 *   problem  in  problem with the arrays that the tables are to hold
 */
static void write_voltage_problem(emitter *emitter, const design *design,
                                  const pzs_problem *problem)
{
    const uint16_t counts[2] = {problem->inputs, problem->outputs};
    write_curve_note(emitter, design);
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    write_influence(emitter, design, problem);
    write_limits(emitter, design);
    emitter->crc32 = emit_crc_reals(emitter->crc32, &problem->regularisation, 1);
    emitter->crc32 =
        pzs_guard_crc(emitter->crc32, &problem->work_limit, sizeof problem->work_limit);
    write_limit_rows(emitter, design);
    write_sparse(emitter, problem->sparse);
    write_problem_struct(emitter, problem);
}

/*
 * Write the voltage optimisation problem and its target.
 *   image  in      part of the library that the firmware uses: control, linear or nonlinear
 *   blocks in      blocks (stages) of the control tick, with the problem to be written
 *   facts  in/out  whether the influence matrix is written as sparse rows, and the numbers of its
 *                  entries. With the image TABLES_CONTROL this function determines them; otherwise
 *                  it uses those that the caller passes
 * Returns 0, or -1 where memory runs out.
 */
static int write_problem(emitter *emitter, const analysis *analysis, tables_image image,
                         const loop_blocks *blocks, sparse_facts *facts)
{
    const design *design = &analysis->design;
    pzs_problem problem = blocks->problem;
    pzs_sparse_influence sparse = {0};
    int failed = 0;
    if (image == TABLES_CONTROL)
        *facts = sparse_tables_count(design, loop_blocks_read_entries(blocks));
    if (facts->is_used) {
        failed = sparse_tables_make(&sparse, design);
        problem.sparse = &sparse;
    }
    if (facts->is_used || image != TABLES_CONTROL)
        problem.influence = NULL;
    if (image != TABLES_CONTROL)
        problem.hessian = NULL;
    if (!failed)
        write_voltage_problem(emitter, design, &problem);
    sparse_tables_free(&sparse);
    if (image == TABLES_NONLINEAR)
        emit_reals(emitter, "target", design->target, (size_t)design->targets,
                   "target displacement of each target node, the effect of the loads included");
    else
        emit_reals(emitter, "target", design->wanted, (size_t)design->targets,
                   "displacement of each target node that the voltages must cause");
    return failed;
}

/* ---- memory of the device --------------------------------------------- */

/*
 * Compute the bytes of workspace and stack of a firmware by the macros that the firmware uses;
 * `real` is the type of pzs_real on the device. A linear firmware with a controller also needs
 * memory for the influence matrix that it computes.
 */
#define NEED(real, k)                                                                              \
    {                                                                                              \
        typedef real pzs_real;                                                                     \
        need.work[k] += size->loop[k];                                                             \
        if (image != TABLES_CONTROL)                                                               \
            need.work[k] +=                                                                        \
                PZS_MODEL_BYTES(structure->free_dof, padded_entries(&design->mesh, PZS_TILE)) +    \
                (is_compact ? PZS_COMPACT_BYTES : 0);                                              \
        if (image == TABLES_LINEAR && controlled)                                                  \
            need.work[k] +=                                                                        \
                sizeof(pzs_real) * (size_t)design->amplifiers * (size_t)design->targets;           \
        if (image == TABLES_NONLINEAR)                                                             \
            need.work[k] +=                                                                        \
                PZS_SOLVER_BYTES(structure->free_dof, structure->elements,                         \
                                 structure->input.count) +                                         \
                sizeof(pzs_real) * (size_t)structure->input.count * structure->output.count +      \
                (design->contact.given ? PZS_CONTACT_BYTES(structure->nodes) : 0);                 \
        if (image == TABLES_LINEAR && design->electrodes.count > 0)                                \
            need.work[k] +=                                                                        \
                PZS_ELECTRIC_BYTES(design->electrodes.count, open, structure->input.count);        \
        if (image == TABLES_NONLINEAR && design->electrodes.count > 0)                             \
            need.work[k] += PZS_CIRCUIT_BYTES(design->electrodes.count, open);                     \
        if (modes)                                                                                 \
            need.work[k] += PZS_MODES_BYTES(structure->free_dof, modes->vectors);                  \
        if (modes && modes->open.count > 0)                                                        \
            need.work[k] += PZS_MODES_OPEN_BYTES(structure->free_dof, modes->open.count);          \
        need.stack[k] = PZS_STACK_LINEAR;                                                          \
        if (modes)                                                                                 \
            need.stack[k] = PZS_STACK_MODES;                                                       \
        if (image == TABLES_NONLINEAR)                                                             \
            need.stack[k] = PZS_STACK_NONLINEAR;                                                   \
    }

bool tables_are_compact(const analysis *analysis)
{
    compact_types compact = {NULL, NULL};
    if (analysis->source->has_structure)
        compact_types_make(&compact, &analysis->design.mesh);
    const bool has_types = compact.type != NULL;
    compact_types_free(&compact);
    return has_types;
}

tables_memory tables_need(const analysis *analysis, tables_image image, const tables_size *size)
{
    const design *design = &analysis->design;
    const pzs_structure *structure = &design->structure;
    const int controlled = design->problem.inputs > 0;
    const uint32_t open = pzs_electrode_open_count(&design->electrodes);
    const bool is_compact = analysis->is_compact && tables_are_compact(analysis);
    const tables_modes *modes = image == TABLES_CONTROL ? NULL : analysis->device_modes;
    tables_memory need = {{0, 0}, {0, 0}};
    NEED(float, 0)
    NEED(double, 1)
    return need;
}

/* ---- estimator, feed-forward, blocks ---------------------------------- */

/* Write the tables of the estimator, which computes the shape from few sensors. */
static void write_estimator(emitter *emitter, const estimator *estimator)
{
    const pzs_estimator *tables = &estimator->tables;
    const uint16_t counts[3] = {tables->inputs, tables->outputs, tables->sensors};
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emit_reals(emitter, "direct", estimator->direct, (size_t)tables->sensors * tables->inputs,
               "change of each reading (row) per volt of each amplifier (column)");
    emit_reals(
        emitter, "gain", estimator->gain, (size_t)tables->outputs * tables->sensors,
        "gain of the estimate of each target node (row) for the part of each reading (column) "
        "that the voltages do not explain");
    fprintf(emitter->file, "#define %s_SENSORS %u\n", emitter->upper, tables->sensors);
    emit_begin(emitter, "estimator", "estimator", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %u, %s_direct, %s_gain,\n};\n\n", tables->inputs,
            tables->outputs, tables->sensors, emitter->prefix, emitter->prefix);
}

/*
 * Write a feed-forward table: the shape, or the readings of the sensors, that each load of the
 * scene causes.
 */
static void write_feed_forward(emitter *emitter, const char *what,
                               const pzs_feed_forward_table *table, const char *meaning)
{
    char array[64], whole[64];
    const uint16_t counts[2] = {table->inputs, table->outputs};
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    snprintf(array, sizeof array, "%s_per_load", what);
    emit_reals(emitter, array, table->sensitivity, (size_t)table->outputs * table->inputs, meaning);
    snprintf(whole, sizeof whole, "%s_feed_forward", what);
    emit_begin(emitter, "feed_forward_table", whole, table->scene, table->crc);
    fprintf(emitter->file, " %u, %u, %s_%s,\n};\n\n", table->inputs, table->outputs,
            emitter->prefix, array);
}

/*
 * Write the results of the stability tests of a control loop with a vibration model as macros: how
 * the simulations with fast jumps of the target end, and how small vibrations grow or decay.
 */
static void write_verdict(const emitter *emitter, const certificate_loop *loop)
{
    const char *prefix = emitter->upper;
    if (!loop->is_made)
        return;
    emit_comment(emitter, "storms (stress tests: simulations with fast jumps of the target), and "
                          "those of them that did not settle");
    fprintf(emitter->file, "#define %s_STORMS %d\n#define %s_STORMS_FAILED %d\n", prefix,
            loop->storms, prefix, loop->failed);
    emit_comment(emitter, "largest growth factor of small vibrations in a tick");
    fprintf(emitter->file, "#define %s_RADIUS PZS_R(%.6g)\n", prefix, loop->radius);
    if (isfinite(loop->load_step)) {
        emit_comment(
            emitter,
            loop->load_step < CERTIFICATE_LOAD_MOST
                ? "time until 5 %% of the effect of a suddenly applied load are left, in "
                  "periods of the first observed vibration mode"
                : "periods of the first observed vibration mode after which more than 5 %% "
                  "of the effect of a suddenly applied load are left");
        fprintf(emitter->file, "#define %s_LOAD_STEP_PERIODS PZS_R(%.3g)\n", prefix,
                loop->load_step);
    }
    emit_comment(
        emitter,
        "ticks by which readings may be older and newer than %s_DELAY: every storm settles",
        prefix);
    fprintf(emitter->file, "#define %s_READINGS_OLDER %d\n#define %s_READINGS_NEWER %d\n", prefix,
            certificate_older(loop), prefix, certificate_newer(loop));
    if (!loop->has_margins)
        return;
    emit_comment(emitter, "relative to the model: largest stable gain of the structure, and lowest "
                          "and highest stable natural frequencies");
    fprintf(emitter->file,
            "#define %s_MARGIN_GAIN PZS_R(%.4g)\n#define %s_MARGIN_SLOW PZS_R(%.4g)\n"
            "#define %s_MARGIN_FAST PZS_R(%.4g)\n",
            prefix, loop->margin_gain, prefix, loop->margin_slow, prefix, loop->margin_fast);
}

/*
 * Write a comment on stability into the generated header: which vibration modes the loop damps, or,
 * without a vibration model, up to which tick rate it is stable. If such a loop is unstable at the
 * scene's tick rate, or the scene gives no tick rate, also write the macro PREFIX_QUASI_STATIC.
 */
static void write_stability(const emitter *emitter, const certificate *certificate,
                            const damper *damper)
{
    char text[CERTIFICATE_TEXT], observed[SCENE_ERROR] = "";
    certificate_text(certificate, text);
    if (damper->is_used)
        damper_text(damper, observed);
    if (!text[0] && !observed[0])
        return;
    emit_comment_begin(emitter);
    emit_comment_lines(emitter, observed);
    emit_comment_lines(emitter, text);
    emit_comment_end(emitter);
    write_verdict(emitter, &certificate->loop);
    if (!damper->is_used &&
        (certificate_refuses(certificate) || certificate_lacks_rate(certificate))) {
        emit_comment(emitter, "written with --quasi-static: the tick damps no vibration, and the "
                              "structure must have settled when the next tick reads its sensors");
        fprintf(emitter->file, "#define %s_QUASI_STATIC 1\n", emitter->upper);
    }
    fputs("\n", emitter->file);
}

/*
 * Write the tables of all blocks (stages) of the control tick, and the names of amplifiers and
 * sensors that the source of a firmware uses.
 *   size  out  memory that the control loop needs on the device (bytes)
 */
static void write_blocks(emitter *emitter, const analysis *analysis, const loop_parts *parts,
                         tables_size *size)
{
    const estimator *estimator = &parts->estimator;
    if (estimator->shape_table.inputs > 0) {
        fprintf(emitter->file, "#define %s_LOADS %u\n", emitter->upper,
                estimator->shape_table.inputs);
        write_feed_forward(
            emitter, "shape", &estimator->shape_table,
            "displacement of each target node (row) under each load of the scene (column)");
    }
    if (estimator->shape_table.inputs > 0 && estimator->sensors > 0)
        write_feed_forward(emitter, "reading", &estimator->reading_table,
                           "change of each reading (row) under each load of the scene (column)");
    if (estimator->sensors > 0)
        write_estimator(emitter, estimator);
    write_stability(emitter, &analysis->certificate, &parts->damper);
    loop_blocks_write(emitter, &parts->blocks);
    loop_names_write(emitter, analysis);
    for (int k = 0; k < 2; k++)
        size->loop[k] = loop_blocks_bytes(&parts->blocks, k == 0);
}

/*
 * Write the least-squares problem for the voltages and the blocks (stages) of the control tick.
 * Returns 0, or -1 where the estimator or the damping of vibration cannot be set up.
 */
static int write_loop(emitter *emitter, const analysis *analysis, tables_image image,
                      tables_size *size)
{
    loop_parts parts;
    char error[SCENE_ERROR];
    if (loop_parts_open(&parts, analysis, error) < 0)
        return -1;
    const int failed = write_problem(emitter, analysis, image, &parts.blocks, &size->influence);
    write_blocks(emitter, analysis, &parts, size);
    loop_parts_close(&parts);
    return failed;
}

/* ---- the generated header --------------------------------------------- */

/*
 * Write the comment at the top of the tables: name and purpose of the scene, part of the library
 * that the tables are for, and units.
 */
static void write_title(const emitter *emitter, const design *design, const char *image)
{
    char line[4 * SCENE_NAME + 80];
    emit_comment_begin(emitter);
    snprintf(line, sizeof line,
             "Tables of scene %s for a firmware with the %s part of the library. Generated by `pzs "
             "tables`; do not edit.",
             design->name, image);
    emit_comment_lines(emitter, line);
    emit_comment_lines(emitter, design->about ? design->about : "");
    snprintf(line, sizeof line, "Any consistent units.");
    if (!words_unitless(&design->units))
        snprintf(line, sizeof line, "Lengths in %s, forces in %s, voltages in %s.",
                 design->units.length, design->units.force, design->units.voltage);
    emit_comment_lines(emitter, line);
    emit_comment_end(emitter);
}

static void write_head(const emitter *emitter, const analysis *analysis, const char *image)
{
    write_title(emitter, &analysis->design, image);
    fprintf(emitter->file,
            "#ifndef %s_TABLES_H\n#define %s_TABLES_H\n\n#include \"pzs.h\"\n\n"
            "#if PZS_TABLE_FORMAT != %u\n#error \"these tables are of another format than the "
            "library reads: run this library's `pzs tables` again\"\n#endif\n",
            emitter->upper, emitter->upper, PZS_TABLE_FORMAT);
    emit_comment(emitter,
                 "A program that needs one precision defines %s_REAL_BITS as 32 or 64 before it "
                 "includes the tables.",
                 emitter->upper);
    fprintf(emitter->file,
            "#if defined(%s_REAL_BITS) && %s_REAL_BITS != PZS_REAL_BITS\n"
            "#error \"the program needs another precision: compile it and the library with its "
            "-DPZS_REAL_BITS\"\n#endif\n\n",
            emitter->upper, emitter->upper);
}

/*
 * Write preprocessor checks into the header, so that a firmware with the nonlinear solver compiles
 * only with options that suit the tables, such as the precision.
 */
static void write_demands(const emitter *emitter, const analysis *analysis)
{
    fputs("#if !PZS_NONLINEAR\n#error \"nonlinear image: compile library and firmware with "
          "-DPZS_NONLINEAR=1\"\n#endif\n",
          emitter->file);
    if (!tables_allow_float(analysis))
        fprintf(emitter->file,
                "#if PZS_REAL_BITS == 32\n#error \"condition %.1e: above %.0e the equilibrium "
                "solver needs double, -DPZS_REAL_BITS=64\"\n"
                "#endif\n",
                analysis->model.info.condition, TABLES_FLOAT_CONDITION);
    fputs("\n", emitter->file);
}

int tables_allow_float(const analysis *analysis)
{
    return analysis->model.info.condition < TABLES_FLOAT_CONDITION;
}

/*
 * Write the macros with the numbers of inputs, outputs and limit rows (limits of sums of voltages)
 * and with the size of the workspace of the controller.
 */
static void write_sizes(const emitter *emitter, const design *design)
{
    FILE *file = emitter->file;
    const char *upper = emitter->upper;
    const int inputs = design->amplifiers, outputs = design->targets, rows = design->limits.rows;
    fprintf(file, "#define %s_INPUTS %d\n#define %s_OUTPUTS %d\n", upper, inputs, upper, outputs);
    if (rows > 0)
        fprintf(file,
                "#define %s_ROWS %d\n#define %s_CONTROL_BYTES (PZS_CONTROL_BYTES(%d, %d) + "
                "PZS_LIMIT_ROW_BYTES(%d, %d))\n\n",
                upper, rows, upper, inputs, outputs, inputs, rows);
    else
        fprintf(file, "#define %s_CONTROL_BYTES PZS_CONTROL_BYTES(%d, %d)\n\n", upper, inputs,
                outputs);
}

/*
 * Write the numbers of rows and columns of the influence matrix that a device computes from the
 * tables of a linear structure. With sensors or charges the matrix has all inputs and outputs of
 * the structure, otherwise amplifiers and target nodes alone.
 */
static void write_influence_size(const emitter *emitter, const analysis *analysis)
{
    const design *design = &analysis->design;
    const pzs_structure structure =
        table_electrodes(analysis)->count > 0 ? design->structure : controlled(analysis);
    const char *upper = emitter->upper;
    emit_comment(emitter,
                 "size of the matrix that pzs_influence writes: %s_ALL_OUTPUTS rows of "
                 "%s_ALL_INPUTS columns; the first %s_INPUTS columns are amplifiers, the first "
                 "%s_OUTPUTS rows target nodes",
                 upper, upper, upper, upper);
    if (pzs_electrode_open_count(&design->electrodes) > 0)
        emit_comment(emitter, "some electrodes are open: pzs_influence_open must follow "
                              "pzs_influence");
    fprintf(emitter->file, "#define %s_ALL_INPUTS %u\n#define %s_ALL_OUTPUTS %u\n\n", upper,
            structure.input.count, upper, structure.output.count);
}

int tables_write(FILE *file, const analysis *analysis, tables_image image, const char *prefix,
                 tables_size *size)
{
    const int controlled = analysis->design.problem.inputs > 0;
    emitter emitter = {file, prefix, "", 0, 0, 0};
    int status = 0;
    memset(size, 0, sizeof *size);
    for (size_t i = 0; prefix[i] && i + 1 < sizeof emitter.upper; i++)
        emitter.upper[i] = (char)toupper((unsigned char)prefix[i]);
    write_head(&emitter, analysis, tables_image_name[image]);
    if (image == TABLES_NONLINEAR)
        write_demands(&emitter, analysis);
    if (controlled)
        write_sizes(&emitter, &analysis->design);
    if (image == TABLES_NONLINEAR) {
        status = write_nonlinear(&emitter, analysis);
    } else if (image == TABLES_LINEAR) {
        write_structure(&emitter, analysis, image);
        write_electrodes(&emitter, analysis);
        if (analysis->device_modes)
            tables_modes_write(&emitter, analysis->device_modes, &analysis->design);
        fprintf(file, "#define %s_LINEAR 1\n", emitter.upper);
        write_influence_size(&emitter, analysis);
    }
    if (controlled && write_loop(&emitter, analysis, image, size) < 0)
        status = -1;
    fputs("#endif\n", file);
    size->reals = emitter.reals;
    size->bytes = emitter.bytes;
    return ferror(file) ? -1 : status;
}
