/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of the voltage problem (control.h). */
#include "control.h"
#include "../core/guard.h"

uint32_t pzs_problem_crc(const pzs_problem *problem)
{
    const size_t n = problem->inputs, m = problem->outputs;
    const uint16_t counts[2] = {problem->inputs, problem->outputs};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    crc = pzs_guard_array_crc(crc, problem->influence, m * n, sizeof(pzs_real));
    crc = pzs_guard_array_crc(crc, problem->hessian, n * n, sizeof(pzs_real));
    crc = pzs_guard_array_crc(crc, problem->weight, m, sizeof(pzs_real));
    crc = pzs_guard_array_crc(crc, problem->lower, n, sizeof(pzs_real));
    crc = pzs_guard_array_crc(crc, problem->upper, n, sizeof(pzs_real));
    crc = pzs_guard_array_crc(crc, problem->step_limit, n, sizeof(pzs_real));
    crc = pzs_guard_array_crc(crc, problem->reference_voltage, n, sizeof(pzs_real));
    return ~pzs_guard_crc(crc, &problem->regularisation, sizeof problem->regularisation);
}

pzs_status pzs_problem_seal(pzs_problem *problem)
{
    if (problem == NULL || problem->inputs == 0 || problem->outputs == 0)
        return PZS_E_ARGUMENT;
    problem->format = PZS_TABLE_FORMAT;
    problem->crc = pzs_problem_crc(problem);
    return PZS_OK;
}
