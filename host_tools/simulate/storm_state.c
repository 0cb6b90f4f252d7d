/* SPDX-License-Identifier: BSD-2-Clause */
/* State of one storm, a simulation of a control loop on a structure with mass (storm_state.h). */
#include "storm_state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"

/* ---- errors ------------------------------------------------------------ */

int storm_explain(const storm *run, pzs_status status, char *error)
{
    const design *design = &run->rig->analysis->design;
    return scene_fault(design->simulate.at, error, "storm: %s", pzs_status_text(status));
}

/* ---- memory ------------------------------------------------------------ */

static bool take_run_memory(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers, targets = storm->rig->targets,
                 k = storm->rig->sensors;
    const size_t kept = (size_t)storm->history_ticks;
    double *at = storm->memory =
        calloc((10 + PZS_PLAY_LIMIT + PZS_CREEP_LIMIT) * amplifiers + 5 * targets + 2 * k +
                   kept * k + storm->rig->modal.rows + 1,
               sizeof *storm->memory);
    if (!at || !inertia_open(&storm->inertia, &storm->rig->modal))
        return false;
    storm->limits = at, at += 3 * amplifiers;
    storm->voltage = at, at += amplifiers;
    storm->previous_voltage = at, at += amplifiers;
    storm->output = at, at += amplifiers;
    storm->driven = at, at += amplifiers;
    storm->acting = at, at += amplifiers;
    storm->stroke = at, at += 2 * amplifiers;
    storm->play = at, at += PZS_PLAY_LIMIT * amplifiers;
    storm->creep = at, at += PZS_CREEP_LIMIT * amplifiers;
    storm->target = at, at += targets;
    storm->last_target = at, at += targets;
    storm->best_shape = at, at += targets;
    storm->shape = at, at += targets;
    storm->part = at, at += targets;
    storm->sensed = at, at += k;
    storm->vibrating = at, at += k;
    storm->load = at, at += storm->rig->modal.rows;
    storm->reading = at;
    return true;
}

void storm_end(storm *storm)
{
    if (storm->replaced)
        *storm->replaced = storm->original;
    inertia_close(&storm->inertia);
    free(storm->memory);
    free(storm->work);
}

/* ---- control loop ------------------------------------------------------ */

bool storm_is_free(const storm *storm)
{
    return !isfinite(storm->plant->step_limit);
}

/*
 * Set the voltage and step limits of the voltage optimisation problem, which the controller solves,
 * to the limits of the simulation.
 */
static void set_limits(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const design *design = &storm->rig->analysis->design;
    const double factor = storm->plant->step_limit;
    const bool is_free = storm_is_free(storm);
    for (size_t k = 0; k < amplifiers; k++) {
        const bool is_held = !(design->lower[k] < design->upper[k]);
        const bool is_limited = !is_free || is_held;
        storm->limits[k] = is_limited ? storm->problem.lower[k] : -HUGE_VAL;
        storm->limits[amplifiers + k] = is_limited ? storm->problem.upper[k] : HUGE_VAL;
        storm->limits[2 * amplifiers + k] =
            is_free ? HUGE_VAL : storm->problem.step_limit[k] * factor;
    }
    storm->problem.lower = storm->limits;
    storm->problem.upper = storm->limits + amplifiers;
    storm->problem.step_limit = storm->limits + 2 * amplifiers;
    if (is_free) /* without voltage limits, the limits of sums of voltages are left out, too,
                    because they need finite voltage limits */
        storm->problem.limit_rows = NULL;
    storm->problem.crc = pzs_problem_crc(&storm->problem);
}

/*
 * Append a block (stage of the control tick) to those that the simulation runs. In the block that
 * computes the voltages, voltage limits and step limits are replaced by those of the simulation.
 */
static void append_block(storm *storm, const pzs_block *given)
{
    pzs_block *block = &storm->block[storm->blocks++];
    *block = *given;
    if (block->type->phase != PZS_PHASE_STEP)
        return;
    storm->problem = storm->original = *(const pzs_problem *)block->tables;
    set_limits(storm);
    /*
     * The changed problem is passed to the step block by a pointer in the library's own step block.
     * The tables of a control law for comparison (laws.h) begin with a problem, which is
     * overwritten until the simulation ends.
     */
    if (block->type == &pzs_step_block) {
        block->tables = &storm->problem;
        return;
    }
    storm->replaced = (pzs_problem *)(uintptr_t)block->tables;
    *storm->replaced = storm->problem;
}

/*
 * Copy the blocks (stages of the control tick) that the simulation runs. A simulation without
 * limits, for the growth of vibrations, leaves out three kinds: the blocks behind the step block,
 * because converter steps and fixed voltages would hide the growth; and two that need voltage
 * limits, the compensation of hysteresis and the sensor gate, whose ranges follow from them.
 */
static void set_tables(storm *storm)
{
    const bool is_free = storm_is_free(storm);
    for (int k = 0; k < storm->rig->blocks; k++) {
        const pzs_block *given = &storm->rig->block[k];
        const bool is_behind = given->type->phase > PZS_PHASE_STEP;
        const bool needs_limits =
            given->type == &pzs_effect_block || given->type == &pzs_sensor_gate_block;
        if (!is_free || !(is_behind || needs_limits))
            append_block(storm, given);
    }
}

/* Append the supervisor of the loop, if the simulation is to run it. */
static void append_supervisor(storm *storm)
{
    const storm_rig *rig = storm->rig;
    if (!rig->is_supervised || rig->supervision == NULL || storm_is_free(storm))
        return;
    storm->supervision = *rig->supervision;
    storm->supervision.waits = 0;
    (void)pzs_supervision_seal(&storm->supervision);
    storm->block[storm->blocks++] = (pzs_block){&pzs_supervisor_block, &storm->supervision};
}

static pzs_status open_loop(storm *storm)
{
    double none;
    const size_t count = (size_t)storm->blocks;
    pzs_status status = pzs_loop_init(&storm->loop, storm->block, count, NULL, &none, 0);
    if (status != PZS_E_WORKSPACE)
        return status;
    const size_t need = (size_t)storm->loop.info.where;
    storm->work = malloc(need);
    return storm->work ? pzs_loop_init(&storm->loop, storm->block, count, NULL, storm->work, need)
                       : PZS_E_WORKSPACE;
}

/* ---- start of a storm -------------------------------------------------- */

int storm_begin(storm *storm, const storm_rig *rig, const storm_plant *plant, char *error)
{
    memset(storm, 0, sizeof *storm);
    storm->rig = rig;
    storm->plant = plant;
    storm->wrong = -1;
    storm->random = plant->seed;
    storm->history_ticks = rig->delay + (plant->more_delay > 0 ? plant->more_delay : 0) + 1;
    if (!take_run_memory(storm))
        return storm_no_memory(rig->analysis, error);
    storm->inertia.gain = plant->gain;
    storm->inertia.stretch = plant->frequency;
    set_tables(storm);
    append_supervisor(storm);
    storm_start_ceramic(storm);
    memcpy(storm->last_target, rig->analysis->design.target,
           rig->targets * sizeof *storm->last_target);
    pzs_status status = open_loop(storm);
    if (!PZS_IS_ERROR(status) && !storm_is_free(storm)) /* A simulation of small vibrations without
                                                           limits needs no best shape: it is zero.
                                                         */
        status = storm_find_best(storm, storm->previous_voltage);
    if (PZS_IS_ERROR(status))
        return storm_explain(storm, status, error);
    memcpy(storm->voltage, storm->loop.info.voltage, rig->amplifiers * sizeof *storm->voltage);
    memcpy(storm->output, storm->voltage, rig->amplifiers * sizeof *storm->output);
    storm_advance_ceramic(storm);
    inertia_rest(&storm->inertia, storm->acting);
    return 0;
}
