/* SPDX-License-Identifier: BSD-2-Clause */
/* What the laws of the rivals share (rival_base.h). */
#include "rival_base.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <cmocka.h>

const pzs_damper_info *rival_estimates(const rival *rival)
{
    const pzs_damper *damper = pzs_loop_find(&rival->loop.loop, &pzs_vibration_block);
    assert_non_null(damper);
    return &damper->info;
}

void rival_solve(rival *rival)
{
    assert_true(unconstrained_solve(&rival->law.solver, rival->law.required, rival->law.next));
}

const double *rival_solve_bounded(rival *rival)
{
    assert_false(PZS_IS_ERROR(pzs_step(&rival->bounded, rival->law.required)));
    rival->work += (double)rival->bounded.info.work;
    return rival->bounded.info.voltage;
}

double rival_scale(const rival *rival)
{
    const modal_structure *structure = rival->loop.structure;
    double sum = 0;
    for (size_t i = 0; i < structure->outputs * structure->inputs; i++)
        sum += structure->influence[i] * structure->influence[i];
    return sum / (double)structure->inputs;
}
