/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of a voltage problem and order of its arrays in the checksum (control.h, problem.h). */
#include "control.h"
#include "problem.h"
#include "../core/guard.h"

/* Describe an array of `count` reals, which may be absent (NULL), as a part of a checksum. */
static scrub_part array_part(const pzs_real *value, size_t count)
{
    const scrub_part part = {value, value != NULL ? count * sizeof *value : 0};
    return part;
}

void pzs_problem_parts(const pzs_problem *problem, scrub_part part[PROBLEM_PARTS])
{
    const size_t inputs = problem->inputs, outputs = problem->outputs;
    part[0] = (scrub_part){&problem->inputs, sizeof problem->inputs};
    part[1] = (scrub_part){&problem->outputs, sizeof problem->outputs};
    part[2] = array_part(problem->influence, outputs * inputs);
    part[3] = array_part(problem->hessian, inputs * inputs);
    part[4] = array_part(problem->weight, outputs);
    part[5] = array_part(problem->lower, inputs);
    part[6] = array_part(problem->upper, inputs);
    part[7] = array_part(problem->step_limit, inputs);
    part[8] = array_part(problem->reference_voltage, inputs);
    part[9] = array_part(&problem->regularisation, 1);
    part[10] = (scrub_part){&problem->work_limit, sizeof problem->work_limit};
}

uint32_t pzs_problem_crc(const pzs_problem *problem)
{
    scrub_part part[PROBLEM_PARTS];
    uint32_t crc = GUARD_CRC_START;
    pzs_problem_parts(problem, part);
    for (uint32_t k = 0; k < PROBLEM_PARTS; k++)
        crc = pzs_guard_crc(crc, part[k].data, part[k].bytes);
    return ~crc;
}

pzs_status pzs_problem_seal(pzs_problem *problem)
{
    if (problem == NULL || problem->inputs == 0 || problem->outputs == 0)
        return PZS_E_ARGUMENT;
    problem->format = PZS_TABLE_FORMAT;
    problem->crc = pzs_problem_crc(problem);
    return PZS_OK;
}
