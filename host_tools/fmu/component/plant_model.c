/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The plant of a scene as the model in an FMU: amplifiers, cables, ceramic, linear structure with
 * or without vibration, and sensors. It makes the same calls in the same order as simulate_loop.c,
 * so that results are equal bit by bit. The readings after a step are those of the controller's
 * next tick. A load that is set before a step acts from the end of that step on.
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

/*
 * FMI value reference (number) of the first variable of each group of real variables, and of the
 * seed among the integer variables.
 */
enum {
    VOLTAGE = 0, /* FMU variables: commands of the controller to the amplifiers (V) */
    LOAD = VOLTAGE + PLANT_AMPLIFIERS, /* FMU variables: load factors, followed by the temperature
                                          change of the structure (K) */
    READING = LOAD + PLANT_LOADS,      /* FMU variables: readings of the sensors that the controller
                                          receives */
    SHAPE = READING + PLANT_SENSORS,   /* FMU variables: true displacements of the target nodes */
    OUTPUT = SHAPE + PLANT_TARGETS,    /* FMU variables: output voltages of the amplifiers (V) */
    REALS = OUTPUT + PLANT_AMPLIFIERS, /* number of real variables of the FMU */
    INPUTS = PLANT_AMPLIFIERS + PLANT_LOADS,
    SEED = 0 /* FMU variable: seed of the random numbers for the sensor noise */
};

/*
 * This declaration fails to compile if the numbers of variables differ from those in
 * modelDescription.xml.
 */
typedef char sizes_agree[REALS == FMU_REALS_USED && INPUTS == FMU_REAL_INPUTS ? 1 : -1];

typedef struct plant {
    uint64_t random; /* state of the generator of the random numbers in the sensor noise */
    double time;     /* simulated time since the start (s) */
    int tick;        /* number of steps of the FMU since the start */
    electrode electrode[PLANT_AMPLIFIERS];
    sensor sensor[PLANT_SENSORS];
    double output[PLANT_AMPLIFIERS]; /* output voltages of the amplifiers (V) */
    double input[INPUTS];    /* inputs of the structure: voltages that act on the ceramic (V), load
                                factors, temperature change (K) */
    double rows[PLANT_ROWS]; /* displacements of the target nodes, then those at the sensors (length
                                unit of the scene) */
    double deviation[PLANT_ROWS]; /* part of each displacement of the target nodes and at the
                                     sensors (member `rows`) that is vibration: the displacement
                                     less its value in static equilibrium (length unit of the scene)
                                   */
    double history[(PLANT_DELAY + 1) * PLANT_SENSORS]; /* sensor readings without noise of the last
                                                          PLANT_DELAY + 1 ticks, as a ring buffer:
                                                          the controller receives readings that are
                                                          at most PLANT_DELAY ticks old */
    double reading[PLANT_SENSORS],
        sensed[PLANT_SENSORS]; /* reading: readings of the latest tick, with noise; sensed: readings
                                  that the controller receives, late by the delay of the sensors */
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

/*
 * Replace the static equilibrium of the plant by the equilibrium under the present inputs. The
 * displacement of each vibration mode stays the same at this instant, so its deviation from the
 * equilibrium changes.
 */
static void jump(plant *plant)
{
    inertia_jump(&plant->inertia, plant->input);
}

/*
 * Advance the plant by one tick period, with constant output voltages of the amplifiers and
 * constant loads.
 */
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

/*
 * Set the inputs of the structure at the present time: the voltages that act on the ceramic, and
 * the load factors that the simulator has set.
 */
static void set_inputs(plant *plant, const fmu_values *values)
{
    const imperfections wiring = imperfections_of(plant);
    for (int k = 0; k < PLANT_LOADS; k++)
        plant->input[PLANT_AMPLIFIERS + k] = values->real[LOAD + k];
    imperfections_actuate(&wiring, plant->output, 0, plant->input);
}

/*
 * Compute the displacements of the target nodes and at the sensors under the present inputs,
 * including the vibration.
 */
static void compute_rows(plant *plant)
{
    influence_sum(plant_influence, plant->input, PLANT_ROWS, INPUTS, plant->rows);
    inertia_observe(&plant->inertia, 0, PLANT_ROWS, plant->deviation);
    for (int i = 0; i < PLANT_ROWS && PLANT_MODES > 0; i++)
        plant->rows[i] += plant->deviation[i];
}

/*
 * Compute the readings that the controller receives at the present tick. They were taken
 * some ticks before, by the delay of the sensors (PLANT_DELAY).
 */
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

/*
 * Check the commands to the amplifiers against the voltage limits. Returns fmi2OK, or fmi2Warning
 * with a message on the first command beyond its limits.
 */
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

/*
 * Set the output voltages of the amplifiers at the start: the commands of the controller, clamped
 * to the voltage limits.
 */
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
