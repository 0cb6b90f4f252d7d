/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of the voltage problem (control.h, problem.h). */
#include "control.h"
#include "problem.h"
#include "../core/guard.h"

void pzs_problem_parts(const pzs_problem *problem, scrub_part part[PROBLEM_PARTS])
{
    const size_t n = problem->inputs, m = problem->outputs, real = sizeof(pzs_real);
    const scrub_part all[PROBLEM_PARTS] = {
        {&problem->inputs, sizeof problem->inputs},
        {&problem->outputs, sizeof problem->outputs},
        {problem->influence, problem->influence != NULL ? m * n * real : 0},
        {problem->hessian, problem->hessian != NULL ? n * n * real : 0},
        {problem->weight, problem->weight != NULL ? m * real : 0},
        {problem->lower, problem->lower != NULL ? n * real : 0},
        {problem->upper, problem->upper != NULL ? n * real : 0},
        {problem->step_limit, problem->step_limit != NULL ? n * real : 0},
        {problem->reference_voltage, problem->reference_voltage != NULL ? n * real : 0},
        {&problem->regularisation, real}};
    for (uint32_t k = 0; k < PROBLEM_PARTS; k++)
        part[k] = all[k];
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
