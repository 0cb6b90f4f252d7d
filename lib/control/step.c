/* SPDX-License-Identifier: BSD-2-Clause */
/* The stage of the control tick that computes the voltages (pzs_step_block). */
#include "pzs_loop.h"

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    return PZS_ALIGNED(sizeof(pzs_control)) + PZS_ALIGNED(pzs_control_bytes(problem));
}

/*
 * Initialise the stage of the control tick that computes the voltages. Its memory holds the struct
 * pzs_control, followed by the workspace of the controller.
 */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_problem *problem = tables;
    pzs_control *control = self;
    void *work = (uint8_t *)self + PZS_ALIGNED(sizeof *control);
    const pzs_status status =
        pzs_control_init(control, problem, signals->influence, work, pzs_control_bytes(problem));
    signals->control = control;
    signals->where = control->info.where;
    return status;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_control *control = self;
    const pzs_status status = pzs_tick(control, signals->wanted, signals->measured);
    signals->where = control->info.where;
    return status;
}

const pzs_block_type pzs_step_block = {"step",     PZS_PHASE_STEP, block_bytes,
                                       block_init, block_tick,     NULL};
