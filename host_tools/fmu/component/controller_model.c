/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The controller of a scene as the model in an FMU (functional mock-up unit): the control loop of
 * the library with the tables that `pzs tables` writes. Each step of the FMU runs one tick of the
 * loop, with the target and the sensor readings that the simulator has set before the step.
 */
#include <stdio.h>
#include <string.h>
#include "pzs.h"
#include "fmu_model.h"
#include "fmu_tables.h"

enum {
    LOADS = CONTROLLER_KNOWN_LOADS
}; /* number of loads whose factors the simulator gives to the controller (known loads) */

/*
 * FMI value reference (number) of the first variable of each group of variables of the FMU, counted
 * separately for real, integer and text variables.
 */
enum {
    TARGET = 0, /* FMU variables: wanted displacements of the target nodes */
    READING = TARGET + CONTROLLER_OUTPUTS, /* FMU variables: readings of the sensors; NaN where a
                                              sensor gives no reading */
    NOW = READING + CONTROLLER_READINGS,   /* FMU variables: factors of the known loads, which the
                                              simulator tells the controller, at the time of the
                                              readings */
    NEXT = NOW + LOADS, /* FMU variables: factors of the known loads, which the simulator tells the
                           controller, at the time when the next voltages act */
    VOLTAGE = NEXT + LOADS, /* FMU variables: voltages that the amplifiers are to output (V) */
    REALS = VOLTAGE + CONTROLLER_INPUTS, /* number of real variables of the FMU */
    COMMAND = 0, /* FMU variable: command to the supervisor, which switches the control loop between
                    its operating modes; only in an FMU with a supervisor */
    STATUS = CONTROLLER_SUPERVISED, /* FMU variable: status of the latest tick of the control loop,
                                       a value of pzs_status */
    ITERATIONS = STATUS + 1, /* FMU variable: number of iterations of the optimiser in the latest
                                tick */
    MODE = ITERATIONS + CONTROLLER_SUPERVISED, /* FMU variable: operating mode of the supervisor;
                                                  only in an FMU of a supervised control loop */
    STATUS_TEXT = 0                            /* FMU variable: text of the latest tick's status */
};

/*
 * This declaration fails to compile if the numbers of variables differ from those in
 * modelDescription.xml.
 */
typedef char sizes_agree[REALS == FMU_REALS_USED && VOLTAGE == FMU_REAL_INPUTS &&
                                 MODE + 1 == FMU_INTEGERS_USED
                             ? 1
                             : -1];

typedef struct controller {
    pzs_loop loop;
    pzs_real known[2][LOADS + 1]; /* factors of the loads that the simulator tells the controller:
                                     known[0] at the time of the readings, known[1] at the time when
                                     the next voltages act */
    pzs_real work[CONTROLLER_LOOP_BYTES / sizeof(pzs_real) + 1];
} controller;

size_t fmu_model_bytes(void)
{
    return sizeof(controller);
}

static void publish(const controller *controller, pzs_status status, fmu_values *values)
{
    memcpy(values->real + VOLTAGE, controller->loop.info.voltage,
           CONTROLLER_INPUTS * sizeof *values->real);
    values->integer[STATUS] = (fmi2Integer)status;
    values->integer[ITERATIONS] = controller->loop.info.control->info.iterations;
    values->text[STATUS_TEXT] = pzs_status_text(status);
    const pzs_supervisor *supervisor = pzs_loop_find(&controller->loop, &pzs_supervisor_block);
    if (supervisor)
        values->integer[MODE] = (fmi2Integer)supervisor->info.mode;
}

/*
 * Give the supervisor the command that the simulator has set; a control loop without a supervisor
 * ignores it.
 */
static void give_command(controller *controller, const fmu_values *values)
{
    pzs_supervisor *supervisor = pzs_loop_find(&controller->loop, &pzs_supervisor_block);
    if (supervisor && values->integer[COMMAND] != PZS_COMMAND_NONE)
        (void)pzs_supervisor_give(supervisor, (pzs_supervisor_command)values->integer[COMMAND]);
}

/*
 * Describe an error of the control loop in the message of the FMU: the block (stage) of the loop
 * that failed, the text of the status, and the index of the input or output concerned. Returns
 * fmi2Error.
 */
static fmi2Status refuse(const controller *controller, pzs_status status, fmu_values *values)
{
    const pzs_block_type *block = controller->loop.info.block;
    snprintf(values->message, sizeof values->message, "%s: %s (index %ld)",
             block ? block->name : "control loop", pzs_status_text(status),
             (long)controller->loop.info.where);
    return fmi2Error;
}

fmi2Status fmu_model_start(void *memory, fmu_values *values)
{
    controller *controller = memory;
    memset(controller, 0, sizeof *controller);
    const pzs_status status = pzs_loop_init(&controller->loop, controller_blocks, CONTROLLER_BLOCKS,
                                            NULL, controller->work, sizeof controller->work);
    if (PZS_IS_ERROR(status))
        return refuse(controller, status, values);
    publish(controller, status, values);
    return fmi2OK;
}

static void announce_loads(controller *controller, const fmu_values *values)
{
    if (LOADS == 0)
        return;
    memcpy(controller->known[0], values->real + NOW, LOADS * sizeof(pzs_real));
    memcpy(controller->known[1], values->real + NEXT, LOADS * sizeof(pzs_real));
    (void)pzs_loop_know(&controller->loop, controller->known[0], controller->known[1]);
}

fmi2Status fmu_model_step(void *memory, fmu_values *values)
{
    controller *controller = memory;
    if (fmu_check_finite(values, TARGET, CONTROLLER_OUTPUTS) != fmi2OK ||
        fmu_check_finite(values, NOW, 2 * LOADS) != fmi2OK)
        return fmi2Error;
    announce_loads(controller, values);
    give_command(controller, values);
    const pzs_status status =
        pzs_loop_tick(&controller->loop, values->real + TARGET, values->real + READING);
    publish(controller, status, values);
    if (PZS_IS_ERROR(status) && status != PZS_E_LATCHED)
        return refuse(controller, status, values);
    return fmi2OK; /* After the supervisor has ended the control loop (latched stop), the park
                      voltages (safe voltages at which the amplifiers rest) are valid outputs. */
}
