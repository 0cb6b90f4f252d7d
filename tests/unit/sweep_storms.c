/*
 * Storms on structures with mass (rigs/storm_sweep.h), with the controller in the precision of this
 * program; the structures, and the tables before they are rounded, are in double.
 *
 *   storms             the damped tick on three structures with one delay
 *   storms full        all structures, as a table
 *   storms full NAME   the structures whose names begin like this
 *
 * In double the controller is the one of the host tools: clipped least squares and other laws run
 * beside the damped tick, and in the short run the storms of the controller of this file have the
 * same bits.
 *
 * Returns 0 where the damped tick settles in every storm, and in the short run clipped least
 * squares in none.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <stdlib.h>
#include <string.h>
#include "pzs.h"
#include "../rigs/storm_sweep.h"

/* The controller: tables rounded to the precision of this program, and their loop. */
static struct own {
    pzs_problem problem;
    pzs_vibration vibration;
    pzs_block block[2];
    pzs_loop loop;
    pzs_real *memory, *at; /* all arrays, and the first one that is still free */
    pzs_real *wanted, *measured;
    void *work;
} own;

static void close_controller(void)
{
    free(own.memory);
    free(own.work);
    memset(&own, 0, sizeof own);
}

static pzs_real *put(const double *value, size_t count)
{
    pzs_real *first = own.at;
    for (size_t i = 0; i < count; i++)
        first[i] = (pzs_real)value[i];
    own.at += count;
    return first;
}

static bool fill_problem(const storm_tables *from)
{
    const size_t inputs = from->inputs, outputs = from->outputs;
    own.problem = (pzs_problem){.inputs = from->inputs, .outputs = from->outputs};
    own.problem.work_limit = from->work_limit;
    own.problem.influence = put(from->influence, outputs * inputs);
    own.problem.hessian = put(from->hessian, inputs * inputs);
    own.problem.weight = put(from->weight, outputs);
    own.problem.lower = put(from->lower, inputs);
    own.problem.upper = put(from->upper, inputs);
    own.problem.step_limit = put(from->step_limit, inputs);
    own.problem.reference_voltage = put(from->reference_voltage, inputs);
    own.problem.regularisation = (pzs_real)from->regularisation;
    own.problem.dual_method = PZS_DUAL_METHOD(from->inputs);
    return pzs_problem_seal(&own.problem) == PZS_OK;
}

static bool fill_vibration(const storm_tables *from)
{
    const size_t inputs = from->inputs, outputs = from->outputs, modes = from->modes,
                 sensors = from->sensors;
    own.vibration = (pzs_vibration){.inputs = from->inputs,
                                    .outputs = from->outputs,
                                    .sensors = from->sensors,
                                    .modes = from->modes,
                                    .delay = from->delay};
    own.vibration.shape = put(from->shape, outputs * modes);
    own.vibration.modal = put(from->modal, modes * inputs);
    own.vibration.turn = put(from->turn, 4 * modes);
    own.vibration.observer = put(from->observer, 3 * modes * modes);
    own.vibration.explain = put(from->explain, modes * modes);
    own.vibration.damping = put(from->damping, modes * inputs);
    own.vibration.inverse_angle = put(from->inverse_angle, modes);
    if (from->reading != NULL) {
        own.vibration.reading = put(from->reading, sensors * modes);
        own.vibration.direct = put(from->direct, sensors * inputs);
        own.vibration.gain = put(from->gain, outputs * sensors);
    }
    if (from->precision != NULL)
        own.vibration.precision = put(from->precision, sensors);
    own.vibration.share = (pzs_real)from->share;
    own.vibration.mix = (pzs_real)from->mix;
    own.vibration.slow = (pzs_real)from->slow;
    return pzs_vibration_seal(&own.vibration) == PZS_OK;
}

static bool take_memory(const storm_tables *from)
{
    const size_t inputs = from->inputs, outputs = from->outputs, modes = from->modes,
                 sensors = from->sensors;
    const size_t reals = inputs * (outputs + inputs + sensors + 4) + outputs * (sensors + 2) +
                         2 * sensors + modes * (outputs + sensors + 2 * inputs + 4 * modes + 5);
    own.at = own.memory = calloc(reals, sizeof *own.memory);
    if (own.memory == NULL)
        return false;
    own.wanted = own.at;
    own.measured = own.wanted + outputs;
    own.at = own.measured + sensors;
    return true;
}

static bool start_loop(void)
{
    double none;
    own.block[0] = (pzs_block){&pzs_vibration_block, &own.vibration};
    own.block[1] = (pzs_block){&pzs_step_block, &own.problem};
    if (pzs_loop_init(&own.loop, own.block, 2, NULL, &none, 0) != PZS_E_WORKSPACE)
        return false;
    const size_t bytes = (size_t)own.loop.info.where;
    own.work = malloc(bytes);
    return own.work != NULL &&
           pzs_loop_init(&own.loop, own.block, 2, NULL, own.work, bytes) == PZS_OK;
}

static bool start(const storm_tables *tables)
{
    close_controller();
    return take_memory(tables) && fill_problem(tables) && fill_vibration(tables) && start_loop();
}

static bool tick(const double *wanted, const double *measured, double *voltage)
{
    for (size_t i = 0; i < own.problem.outputs; i++)
        own.wanted[i] = (pzs_real)wanted[i];
    for (size_t i = 0; i < own.vibration.sensors; i++)
        own.measured[i] = (pzs_real)measured[i];
    const pzs_status status = pzs_loop_tick(&own.loop, own.wanted, own.measured);
    for (size_t k = 0; k < own.problem.inputs; k++)
        voltage[k] = (double)own.loop.info.voltage[k];
    return !PZS_IS_ERROR(status);
}

int main(int argc, char **argv)
{
    static const storm_controller controller = {" in float", start, tick};
    const bool is_full = argc > 1 && strcmp(argv[1], "full") == 0;
    const char *only = argc > 2 ? argv[2] : "";
    const bool is_float = sizeof(pzs_real) < sizeof(double);
    const storm_controller *same = is_full || is_float ? NULL : &controller;
    const int failed = bridge_storms(is_full, only, is_float ? &controller : NULL, same);
    close_controller();
    return failed;
}
