/* SPDX-License-Identifier: BSD-2-Clause */
/* Stiffness that open electrodes add to a structure (open_electrodes.h). */
#include "open_electrodes.h"
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/linalg.h"
#include "electrodes.h"

/* ---- electrodes and capacitances --------------------------------------- */

/* Return whether electrode k of a table is open in a circuit. */
static bool is_open(const design *design, const pzs_electrodes *tables, int k,
                    electrode_circuit circuit)
{
    if (electrodes_is_bare(design, tables->input[k]) || circuit == CIRCUIT_OPEN)
        return true;
    return circuit == CIRCUIT_SCENE && tables->open[k];
}

/* Initialise a dense symmetric matrix of `rows` rows. Returns whether memory sufficed. */
static bool make_dense(pzs_envelope *matrix, size_t rows, void *memory[2])
{
    memory[0] = calloc(PZS_DENSE(rows) + 1, sizeof(double));
    memory[1] = calloc(rows / PZS_TILE + 2 + rows, sizeof(uint32_t));
    if (!memory[0] || !memory[1])
        return false;
    pzs_linalg_dense_layout(matrix, (uint32_t)rows, memory[0], memory[1]);
    return true;
}

static bool allocate(open_electrodes *open)
{
    open->input = calloc(open->count, sizeof *open->input);
    open->charge = calloc(open->count * open->inputs, sizeof *open->charge);
    open->response = calloc(open->count * open->free_dof, sizeof *open->response);
    open->voltage = calloc(open->count, sizeof *open->voltage);
    return open->input && open->charge && open->response && open->voltage &&
           make_dense(&open->held, open->count, open->memory) &&
           make_dense(&open->moving, open->count, open->memory + 2);
}

/*
 * Copy the charges of the open electrodes per unit of each input from the tables of all electrodes.
 */
static void take_charges(open_electrodes *open, const pzs_electrodes *tables)
{
    const pzs_rows *direct = &tables->direct;
    for (int k = 0; k < tables->count; k++) {
        const int number = open->number[tables->input[k]];
        if (number < 0)
            continue;
        open->input[number] = tables->input[k];
        double *row = open->charge + (size_t)number * open->inputs;
        for (uint32_t i = direct->start[k]; i < direct->start[k + 1]; i++)
            row[direct->dof[i]] += direct->value[i];
    }
}

/* Capacitance between two open electrodes while the shell cannot deform. */
static double capacitance(const open_electrodes *open, size_t i, size_t j)
{
    return open->charge[i * open->inputs + open->input[j]];
}

/*
 * Factor the matrix of the capacitances between open electrodes while the shell cannot deform.
 * Returns 0, or -1 with error filled.
 */
static int factor_held(open_electrodes *open, char *error)
{
    for (uint32_t i = 0; i < open->count; i++)
        for (uint32_t j = 0; j <= i; j++)
            *pzs_linalg_entry(&open->held, i, j) = capacitance(open, i, j);
    const linalg_inertia inertia = pzs_linalg_factor(&open->held);
    const int32_t bad = inertia.zero >= 0 ? inertia.zero : inertia.first_negative;
    if (bad < 0)
        return 0;
    return scene_fault(open->design->at, error,
                       "open electrode %s has no capacitance; give its material a permittivity",
                       electrodes_name(open->design, open->input[bad]));
}

/* Number the electrodes of a table that are open in a circuit. Returns whether memory sufficed. */
static bool number_open(open_electrodes *open, const pzs_electrodes *tables,
                        electrode_circuit circuit)
{
    open->number = malloc((open->inputs + 1) * sizeof *open->number);
    for (size_t k = 0; open->number && k < open->inputs; k++)
        open->number[k] = -1;
    for (int k = 0; open->number && k < tables->count; k++) {
        if (!is_open(open->design, tables, k, circuit))
            continue;
        open->number[tables->input[k]] = (int)open->count;
        open->count++;
        open->bare += electrodes_is_bare(open->design, tables->input[k]);
    }
    return open->number != NULL;
}

static int build_from(open_electrodes *open, const pzs_electrodes *tables,
                      electrode_circuit circuit, char *error)
{
    if (!number_open(open, tables, circuit))
        return scene_fault(open->design->at, error, "out of memory");
    if (open->count == 0)
        return 0;
    if (!allocate(open))
        return scene_fault(open->design->at, error, "%zu open electrodes do not fit into memory",
                           open->count);
    take_charges(open, tables);
    return factor_held(open, error);
}

int open_electrodes_build(open_electrodes *open, const design *design, const linearised *about,
                          electrode_circuit circuit, char *error)
{
    pzs_electrodes all;
    memset(open, 0, sizeof *open);
    open->design = design;
    open->about = about;
    open->inputs = design->structure.input.count;
    open->free_dof = design->structure.free_dof;
    if (circuit != CIRCUIT_OPEN)
        return build_from(open, &design->electrodes, circuit, error);
    int failed = electrodes_build_all(design, &all, error);
    if (!failed)
        failed = build_from(open, &all, circuit, error);
    electrodes_free(&all);
    return failed;
}

void open_electrodes_free(open_electrodes *open)
{
    free(open->number);
    free(open->input);
    free(open->charge);
    free(open->response);
    free(open->voltage);
    for (size_t i = 0; i < sizeof open->memory / sizeof *open->memory; i++)
        free(open->memory[i]);
    memset(open, 0, sizeof *open);
}

/* ---- linear solves ------------------------------------------------------ */

/* Compute the forces per volt on the open electrodes, scaled like the rows of the matrix. */
static void fill_forces(open_electrodes *open, const double *scale)
{
    for (size_t k = 0; k < open->count; k++) {
        double *force = open->response + k * open->free_dof;
        linearised_force(open->about, open->design, open->input[k], force);
        for (size_t i = 0; i < open->free_dof; i++)
            force[i] *= scale[i];
    }
}

int open_electrodes_factor(open_electrodes *open, const pzs_envelope *factor, const double *scale)
{
    const design *design = open->design;
    if (open->count == 0)
        return 0;
    fill_forces(open, scale);
    pzs_linalg_solve_many(factor, open->response, (uint32_t)open->count, open->free_dof);
    for (size_t i = 0; i < open->count * open->free_dof; i++)
        open->response[i] *= scale[i % open->free_dof];
    pzs_linalg_clear(&open->moving);
    for (uint32_t i = 0; i < open->count; i++)
        for (uint32_t j = 0; j <= i; j++)
            *pzs_linalg_entry(&open->moving, i, j) =
                capacitance(open, i, j) + linearised_work(open->about, design, open->input[j],
                                                          open->response + i * open->free_dof);
    const linalg_inertia inertia = pzs_linalg_factor(&open->moving);
    return inertia.zero < 0 ? (int)inertia.negative : -1;
}

void open_electrodes_correct(const open_electrodes *open, double *vector, size_t count)
{
    for (size_t i = 0; i < count && open->count > 0; i++) {
        double *solution = vector + i * open->free_dof;
        for (size_t k = 0; k < open->count; k++)
            open->voltage[k] = linearised_work(open->about, open->design, open->input[k], solution);
        pzs_linalg_solve(&open->moving, open->voltage);
        for (size_t k = 0; k < open->count; k++)
            for (size_t dof = 0; dof < open->free_dof; dof++)
                solution[dof] -= open->voltage[k] * open->response[k * open->free_dof + dof];
    }
}

/* ---- energy and work ---------------------------------------------------- */

void open_electrodes_follow(const open_electrodes *open, const double *displacement)
{
    if (open->count == 0)
        return;
    for (size_t k = 0; k < open->count; k++)
        open->voltage[k] =
            -linearised_work(open->about, open->design, open->input[k], displacement);
    pzs_linalg_solve(&open->held, open->voltage);
}

double open_electrodes_energy(const open_electrodes *open, const double *displacement)
{
    double sum = 0;
    open_electrodes_follow(open, displacement);
    for (size_t k = 0; k < open->count; k++)
        sum -= open->voltage[k] *
               linearised_work(open->about, open->design, open->input[k], displacement);
    return sum;
}

double open_electrodes_work(const open_electrodes *open, uint32_t input, const double *displacement)
{
    if (open->count > 0 && open->number[input] >= 0)
        return -open->voltage[open->number[input]];
    double sum = linearised_work(open->about, open->design, input, displacement);
    for (size_t k = 0; k < open->count; k++)
        sum += open->voltage[k] * open->charge[k * open->inputs + input];
    return sum;
}
