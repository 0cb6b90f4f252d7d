/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Plant of a scene as the model of an FMU: amplifiers, cables, ceramic, linear structure with or
 * without vibration, sensors. It runs the functions of `pzs simulate` in the order of a tick of
 * that simulation (simulate_loop.c), so that both give the same bits.
 *
 * At the end of each step the plant has its readings for the next tick of the controller. Loads
 * that a tool sets before a step act from the end of that step.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "pzs_base.h"
#include "../../simulate/amplifier.h"
#include "../../simulate/imperfections.h"
#include "../../simulate/inertia.h"
#include "../../simulate/influence_sum.h"
#include "fmu_model.h"
#include "fmu_tables.h"

/* Value references of the first variable of each kind. */
enum {
    VOLTAGE = 0,                       /* commands to the amplifiers (V) */
    LOAD = VOLTAGE + PLANT_AMPLIFIERS, /* load factors, then the temperature change (K) */
    READING = LOAD + PLANT_LOADS,      /* readings of the sensors */
    SHAPE = READING + PLANT_SENSORS,   /* true displacements of the target nodes */
    OUTPUT = SHAPE + PLANT_TARGETS,    /* output voltages of the amplifiers (V) */
    REALS = OUTPUT + PLANT_AMPLIFIERS, /* number of real variables */
    INPUTS = PLANT_AMPLIFIERS + PLANT_LOADS,
    SEED = 0 /* value reference of the seed of the noise, an integer */
};

/* Sizes of this file and of modelDescription.xml are equal, or this declaration does not compile.
 */
typedef char sizes_agree[REALS == FMU_REALS_USED && INPUTS == FMU_REAL_INPUTS ? 1 : -1];

typedef struct plant {
    uint64_t random; /* state of the random number generator */
    double time;     /* time since the start (s) */
    int tick;        /* number of steps since the start */
    electrode electrode[PLANT_AMPLIFIERS];
    sensor sensor[PLANT_SENSORS];
    double output[PLANT_AMPLIFIERS]; /* output voltages of the amplifiers (V) */
    double input[INPUTS]; /* voltages that act on the ceramic (V), load factors, temperature (K) */
    double rows[PLANT_ROWS];      /* displacements of the target nodes, then of the sensors */
    double deviation[PLANT_ROWS]; /* deviation of these displacements from the equilibrium */
    double history[(PLANT_DELAY + 1) * PLANT_SENSORS]; /* noise-free readings of the last ticks */
    double reading[PLANT_SENSORS], sensed[PLANT_SENSORS]; /* latest readings with noise, and those
                                                             that the controller receives */
    modal modal;
    inertia inertia;
    double modal_memory[INERTIA_REALS(PLANT_MODES, INPUTS)];
} plant;

size_t fmu_model_bytes(void)
{
    return sizeof(plant);
}

/* ---- parts of a tick -------------------------------------------------- */

static imperfections imperfections_of(plant *plant)
{
    return (imperfections){plant_imperfections, plant->electrode, plant->sensor,
                           PLANT_SENSORS,       &plant->random,   plant->time};
}

/* Let the vibration know that the inputs have jumped to their present values. */
static void jump(plant *plant)
{
    inertia_jump(&plant->inertia, plant->input);
}

/* Let a tick period pass under the present output voltages and loads. */
static void elapse(plant *plant)
{
    const int parts = imperfections_vary(&plant_imperfections) ? IMPERFECTION_PARTS : 1;
    for (int i = 0; i < parts; i++) {
        const double part = FMU_PERIOD / parts;
        const imperfections wiring = imperfections_of(plant);
        imperfections_actuate(&wiring, plant->output, part, plant->input);
        jump(plant);
        inertia_advance(&plant->inertia, part);
        plant->time += part;
    }
}

/* Set the load factors and compute the voltages that act on the ceramic at this instant. */
static void set_inputs(plant *plant, const fmu_values *values)
{
    const imperfections wiring = imperfections_of(plant);
    for (int k = 0; k < PLANT_LOADS; k++)
        plant->input[PLANT_AMPLIFIERS + k] = values->real[LOAD + k];
    imperfections_actuate(&wiring, plant->output, 0, plant->input);
}

/* Compute the displacements under the present inputs, with the present vibration. */
static void compute_rows(plant *plant)
{
    influence_sum(plant_influence, plant->input, PLANT_ROWS, INPUTS, plant->rows);
    inertia_observe(&plant->inertia, 0, PLANT_ROWS, plant->deviation);
    for (int i = 0; i < PLANT_ROWS && PLANT_MODES > 0; i++)
        plant->rows[i] += plant->deviation[i];
}

/* Take the readings of this tick, which may be those of an earlier one. */
static void sense(plant *plant)
{
    const int then = plant->tick > PLANT_DELAY ? plant->tick - PLANT_DELAY : 0;
    double *now = plant->history + plant->tick % (PLANT_DELAY + 1) * PLANT_SENSORS;
    const double *delayed = plant->history + then % (PLANT_DELAY + 1) * PLANT_SENSORS;
    const imperfections wiring = imperfections_of(plant);
    memcpy(now, plant->rows + PLANT_FIRST_SENSOR, PLANT_SENSORS * sizeof *now);
    imperfections_read(&wiring, plant->tick, plant_noise, delayed, plant->reading, plant->sensed);
}

static void publish(const plant *plant, fmu_values *values)
{
    memcpy(values->real + READING, plant->sensed, sizeof plant->sensed);
    memcpy(values->real + SHAPE, plant->rows, PLANT_TARGETS * sizeof *plant->rows);
    memcpy(values->real + OUTPUT, plant->output, sizeof plant->output);
}

/* ---- inputs ----------------------------------------------------------- */

/* Warn of the first command that is beyond the voltage limits of its amplifier. */
static fmi2Status check_commands(fmu_values *values)
{
    for (int k = 0; k < PLANT_AMPLIFIERS; k++) {
        const double command = values->real[VOLTAGE + k];
        if (command >= plant_lower[k] && command <= plant_upper[k])
            continue;
        snprintf(values->message, sizeof values->message,
                 "%s: %.9g is beyond the limits %.9g to %.9g, which the amplifier keeps",
                 fmu_real_name[VOLTAGE + k], command, plant_lower[k], plant_upper[k]);
        return fmi2Warning;
    }
    return fmi2OK;
}

static void drive_amplifiers(plant *plant, const fmu_values *values)
{
    for (int k = 0; k < PLANT_AMPLIFIERS; k++) {
        const amplifier amplifier = {plant_lower[k], plant_upper[k], plant_step_limit[k],
                                     PLANT_RESOLUTION, PLANT_DEAD_BAND};
        plant->output[k] =
            amplifier_output(&amplifier, plant->output[k], values->real[VOLTAGE + k]);
    }
}

/* ---- model ------------------------------------------------------------ */

/* The amplifiers start at the commands, within the voltage limits. */
static void start_amplifiers(plant *plant, const fmu_values *values)
{
    for (int k = 0; k < PLANT_AMPLIFIERS; k++) {
        plant->output[k] = fmin(fmax(values->real[VOLTAGE + k], plant_lower[k]), plant_upper[k]);
        plant->electrode[k].output = plant->output[k];
    }
}

fmi2Status fmu_model_start(void *memory, fmu_values *values)
{
    plant *plant = memory;
    if (fmu_check_finite(values, 0, INPUTS) != fmi2OK)
        return fmi2Error;
    memset(plant, 0, sizeof *plant);
    plant->random = (uint64_t)values->integer[SEED];
    plant->modal = plant_modal;
    inertia_place(&plant->inertia, &plant->modal, plant->modal_memory);
    start_amplifiers(plant, values);
    const imperfections wiring = imperfections_of(plant);
    imperfections_draw(&wiring);
    set_inputs(plant, values);
    inertia_rest(&plant->inertia, plant->input);
    compute_rows(plant);
    sense(plant);
    publish(plant, values);
    return fmi2OK;
}

fmi2Status fmu_model_step(void *memory, fmu_values *values)
{
    plant *plant = memory;
    if (fmu_check_finite(values, 0, INPUTS) != fmi2OK)
        return fmi2Error;
    drive_amplifiers(plant, values);
    elapse(plant);
    plant->tick++;
    set_inputs(plant, values);
    jump(plant);
    compute_rows(plant);
    sense(plant);
    publish(plant, values);
    return check_commands(values);
}
