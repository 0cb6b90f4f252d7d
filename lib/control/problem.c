/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Checksum of the tables of the controller (pzs_problem), and order of their arrays in the
 * checksum.
 */
#include <string.h>
#include "control.h"
#include "problem.h"
#include "../core/guard.h"

/* Number of reals of an array that enter the checksum and are searched for NaN at a time. */
#define SLICE 4096u

/*
 * Bit mask of the parts of the controller's tables that must consist of finite numbers: bit k
 * belongs to part k in pzs_problem_parts. These parts are influence matrix, Hessian, output
 * weights, reference voltages, regularisation, and the entries of the sparse influence matrix.
 */
#define FINITE_PARTS (1u << 2 | 1u << 3 | 1u << 4 | 1u << 8 | 1u << 9 | 1u << (PROBLEM_PARTS - 1u))

void pzs_problem_parts(const pzs_problem *problem, pzs_table_part part[PROBLEM_PARTS])
{
    const size_t inputs = problem->inputs, outputs = problem->outputs;
    const pzs_sparse_influence *sparse = problem->sparse;
    const pzs_limit_rows *rows = problem->limit_rows;
    memset(part, 0, PROBLEM_PARTS * sizeof *part);
    part[0] = (pzs_table_part){&problem->inputs, sizeof problem->inputs};
    part[1] = (pzs_table_part){&problem->outputs, sizeof problem->outputs};
    part[2] = scrub_reals(problem->influence, outputs * inputs);
    part[3] = scrub_reals(problem->hessian, inputs * inputs);
    part[4] = scrub_reals(problem->weight, outputs);
    part[5] = scrub_reals(problem->lower, inputs);
    part[6] = scrub_reals(problem->upper, inputs);
    part[7] = scrub_reals(problem->step_limit, inputs);
    part[8] = scrub_reals(problem->reference_voltage, inputs);
    part[9] = scrub_reals(&problem->regularisation, 1);
    part[10] = (pzs_table_part){&problem->work_limit, sizeof problem->work_limit};
    if (rows != NULL && rows->call != NULL)
        rows->call->list_parts(problem, part + 11);
    if (sparse != NULL && sparse->call != NULL)
        sparse->call->list_parts(problem, part + 11 + LIMIT_ROW_PARTS);
}

/*
 * Continue a CRC-32 over an array of reals, and find its first entry that is not finite. Both are
 * done slice by slice, so that the array is read from memory only once.
 *   bad in/out  index of the first number that is not finite, or -1; an index already found stays
 */
static uint32_t check_reals(uint32_t crc, const pzs_table_part *part, int32_t *bad)
{
    const pzs_real *value = part->data;
    const size_t count = part->bytes / sizeof *value;
    for (size_t i = 0; i < count; i += SLICE) {
        const size_t some = count - i < SLICE ? count - i : SLICE;
        crc = pzs_guard_crc(crc, value + i, some * sizeof *value);
        const int32_t found = pzs_guard_nonfinite(value + i, (uint32_t)some);
        if (*bad < 0 && found >= 0)
            *bad = (int32_t)i + found;
    }
    return crc;
}

uint32_t pzs_problem_check(const pzs_problem *problem, int32_t *bad)
{
    pzs_table_part part[PROBLEM_PARTS];
    uint32_t crc = GUARD_CRC_START;
    *bad = -1;
    pzs_problem_parts(problem, part);
    for (uint32_t k = 0; k < PROBLEM_PARTS; k++) {
        if (FINITE_PARTS >> k & 1u)
            crc = check_reals(crc, &part[k], bad);
        else
            crc = pzs_guard_array_crc(crc, part[k].data, part[k].bytes, 1);
    }
    return ~crc;
}

uint32_t pzs_problem_crc(const pzs_problem *problem)
{
    int32_t bad;
    return pzs_problem_check(problem, &bad);
}

pzs_status pzs_problem_seal(pzs_problem *problem)
{
    if (problem == NULL || problem->inputs == 0 || problem->outputs == 0)
        return PZS_E_ARGUMENT;
    problem->format = PZS_TABLE_FORMAT;
    problem->dual_method = PZS_DUAL_METHOD(problem->inputs);
    problem->crc = pzs_problem_crc(problem);
    return PZS_OK;
}
