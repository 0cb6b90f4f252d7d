/* SPDX-License-Identifier: BSD-2-Clause */
/* Stiffness that open electrodes add to a structure (open_electrodes.h). */
#include "open_electrodes.h"
#include <stdlib.h>
#include <string.h>
#include "../../lib/modes/open_matrix.h"
#include "electrodes.h"

/* ---- electrodes and capacitances --------------------------------------- */

/* Return whether electrode k of a table is open in a circuit. */
static bool is_open_in(const design *design, const pzs_electrodes *tables, int k,
                       electrode_circuit circuit)
{
    if (electrodes_is_bare(design, tables->input[k]) || circuit == CIRCUIT_OPEN)
        return true;
    return circuit == CIRCUIT_SCENE && tables->open[k];
}

uint32_t open_electrodes_mark(const design *design, const pzs_electrodes *tables,
                              electrode_circuit circuit, uint8_t *is_open)
{
    uint32_t count = 0;
    for (int k = 0; k < tables->count; k++) {
        is_open[k] = is_open_in(design, tables, k, circuit);
        count += is_open[k];
    }
    return count;
}

/* Return the number of potentials of bare faces in a table, which are open in each circuit. */
static size_t count_bare(const design *design, const pzs_electrodes *tables)
{
    size_t count = 0;
    for (int k = 0; k < tables->count; k++)
        count += electrodes_is_bare(design, tables->input[k]);
    return count;
}

/* Factor the capacitances of the open electrodes. Returns 0, or -1 with error filled. */
static int hold(open_electrodes *open, char *error)
{
    int32_t bad;
    if (pzs_open_matrix_hold(&open->matrix, &bad) == PZS_OK)
        return 0;
    return scene_fault(open->design->at, error,
                       "open electrode %s has no capacitance; give its material a permittivity",
                       electrodes_name(open->design, open->matrix.tables->input[bad]));
}

static int build_from(open_electrodes *open, const pzs_electrodes *tables,
                      electrode_circuit circuit, char *error)
{
    uint8_t *is_open = calloc((size_t)tables->count + 1, sizeof *is_open);
    if (!is_open)
        return scene_fault(open->design->at, error, "out of memory");
    const size_t count = open_electrodes_mark(open->design, tables, circuit, is_open);
    open->bare = count_bare(open->design, tables);
    open->memory = malloc(PZS_OPEN_MATRIX_BYTES(count));
    open->response = calloc(count * open->free_dof + 1, sizeof *open->response);
    const bool has_memory = open->memory && open->response;
    if (has_memory)
        pzs_open_matrix_begin(&open->matrix, tables, is_open, open->memory);
    free(is_open);
    if (!has_memory)
        return scene_fault(open->design->at, error, "%zu open electrodes do not fit into memory",
                           count);
    return count > 0 ? hold(open, error) : 0;
}

int open_electrodes_build(open_electrodes *open, const design *design, const linearised *about,
                          electrode_circuit circuit, char *error)
{
    memset(open, 0, sizeof *open);
    open->design = design;
    open->about = about;
    open->free_dof = design->structure.free_dof;
    if (circuit != CIRCUIT_OPEN)
        return build_from(open, &design->electrodes, circuit, error);
    const int failed = electrodes_build_all(design, &open->all, error);
    return failed ? failed : build_from(open, &open->all, circuit, error);
}

void open_electrodes_free(open_electrodes *open)
{
    electrodes_free(&open->all);
    free(open->response);
    free(open->memory);
    memset(open, 0, sizeof *open);
}

/* ---- linear solves ------------------------------------------------------ */

/* Compute the forces per volt on the open electrodes, scaled like the rows of the matrix. */
static void fill_forces(open_electrodes *open, const double *scale)
{
    for (uint32_t k = 0; k < open->matrix.count; k++) {
        double *force = open->response + k * open->free_dof;
        linearised_force(open->about, open->design, pzs_open_matrix_input(&open->matrix, k), force);
        for (size_t i = 0; i < open->free_dof; i++)
            force[i] *= scale[i];
    }
}

/* Work of the force per volt on open electrode number k on a displacement [free_dof]. */
static double unit_work(const open_electrodes *open, uint32_t k, const double *displacement)
{
    return linearised_work(open->about, open->design, pzs_open_matrix_input(&open->matrix, k),
                           displacement);
}

void open_electrodes_factor(open_electrodes *open, const pzs_envelope *factor, const double *scale,
                            linalg_inertia *inertia)
{
    pzs_modes_electrodes *matrix = &open->matrix;
    if (matrix->count == 0)
        return;
    fill_forces(open, scale);
    pzs_linalg_solve_many(factor, open->response, matrix->count, open->free_dof);
    for (size_t i = 0; i < matrix->count * open->free_dof; i++)
        open->response[i] *= scale[i % open->free_dof];
    pzs_linalg_clear(&matrix->moving);
    for (uint32_t i = 0; i < matrix->count; i++)
        for (uint32_t j = 0; j <= i; j++)
            pzs_open_matrix_set(matrix, &matrix->moving, i, j,
                                unit_work(open, j, open->response + i * open->free_dof));
    pzs_open_matrix_factor(&matrix->moving, inertia);
}

void open_electrodes_correct(const open_electrodes *open, double *vector, size_t count)
{
    const pzs_modes_electrodes *matrix = &open->matrix;
    for (size_t i = 0; i < count && matrix->count > 0; i++) {
        double *solution = vector + i * open->free_dof;
        for (uint32_t k = 0; k < matrix->count; k++)
            matrix->voltage[k] = unit_work(open, k, solution);
        pzs_linalg_solve(&matrix->moving, matrix->voltage);
        for (size_t k = 0; k < matrix->count; k++)
            for (size_t dof = 0; dof < open->free_dof; dof++)
                solution[dof] -= matrix->voltage[k] * open->response[k * open->free_dof + dof];
    }
}

double open_electrodes_energy(const open_electrodes *open, const double *displacement)
{
    if (open->matrix.count == 0)
        return 0;
    for (uint32_t k = 0; k < open->matrix.count; k++)
        open->matrix.work[k] = unit_work(open, k, displacement);
    return pzs_open_matrix_follow(&open->matrix);
}
