/*
 * A control loop that damps vibration, and a structure with mass that differs from its model
 * (damped_plant.h).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "damped_plant.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/random.h"

int damped_plant_complain(const damped_plant *plant, const char *error)
{
    printf("not ok - %s: %s\n", plant->run.scene.name, error);
    return -1;
}

/* Initialise the loop in the given memory. */
static void start_loop(damped_plant *plant, void *work, size_t bytes)
{
    const loop_blocks *blocks = &plant->parts.blocks;
    (void)pzs_loop_init(&plant->loop, blocks->block, (size_t)blocks->count, NULL, work, bytes);
}

int damped_plant_open_loop(damped_plant *plant, const char *scene, const char *changes)
{
    analysis *analysis = &plant->run.analysis;
    char *error = plant->run.error;
    double too_small;
    memset(plant, 0, sizeof *plant);
    if (scene_run_open(&plant->run, scene, changes) < 0 || analysis_influence(analysis, error) < 0)
        return damped_plant_complain(plant, error);
    certificate_make(&analysis->certificate, analysis);
    if (certify_loop(analysis, error) < 0 || loop_parts_open(&plant->parts, analysis, error) < 0)
        return damped_plant_complain(plant, error);
    start_loop(plant, &too_small, 0);
    plant->bytes = (size_t)plant->loop.info.where;
    plant->work = malloc(plant->bytes);
    return plant->work ? 0 : damped_plant_complain(plant, "out of memory");
}

/* List the outputs that the sensors measure: those of the estimator, or all target nodes. */
static bool list_sensors(damped_plant *plant)
{
    const design *design = &plant->run.analysis.design;
    const bool is_few = design->estimate.readings > 0;
    plant->sensors = is_few ? (size_t)design->estimate.readings : plant->outputs;
    plant->sensor_row = calloc(plant->sensors, sizeof *plant->sensor_row);
    for (size_t i = 0; i < plant->sensors && plant->sensor_row; i++)
        plant->sensor_row[i] =
            is_few ? (size_t)design->named_first[design->estimate.reading[i].output] : i;
    return plant->sensor_row;
}

static bool open_memory(damped_plant *plant)
{
    plant->play = calloc(DAMPED_PLANT_PLAYS * plant->inputs, sizeof *plant->play);
    plant->acting = calloc(plant->all, sizeof *plant->acting);
    plant->wanted = calloc(plant->outputs, sizeof *plant->wanted);
    return plant->play && plant->acting && plant->wanted;
}

int damped_plant_open_structure(damped_plant *plant, analysis *structure, int modes)
{
    const design *design = &structure->design;
    plant->structure = structure;
    plant->inputs = (size_t)design->amplifiers;
    plant->outputs = (size_t)design->targets;
    plant->all = design->structure.input.count;
    if (analysis_vibration(structure, &plant->vibration, modes, plant->run.error) < 0)
        return damped_plant_complain(plant, plant->run.error);
    const bool has_memory = list_sensors(plant) && open_memory(plant) &&
                            modal_open(&plant->modal, design, &plant->vibration, plant->all) &&
                            inertia_open(&plant->inertia, &plant->modal);
    return has_memory ? 0 : damped_plant_complain(plant, "out of memory");
}

void damped_plant_close(damped_plant *plant)
{
    free(plant->work);
    free(plant->sensor_row);
    free(plant->play);
    free(plant->acting);
    free(plant->wanted);
    inertia_close(&plant->inertia);
    modal_close(&plant->modal);
    vibration_free(&plant->vibration);
    loop_parts_close(&plant->parts);
    scene_run_close(&plant->run);
}

void damped_plant_start(damped_plant *plant, double gain, double frequency, double hysteresis)
{
    start_loop(plant, plant->work, plant->bytes);
    memset(plant->acting, 0, plant->all * sizeof *plant->acting);
    memset(plant->wanted, 0, plant->outputs * sizeof *plant->wanted);
    for (size_t j = 0; j < plant->inputs; j++) {
        plant->acting[j] = plant->loop.info.voltage[j];
        for (size_t i = 0; i < DAMPED_PLANT_PLAYS; i++)
            plant->play[j * DAMPED_PLANT_PLAYS + i] = plant->acting[j];
    }
    plant->inertia.gain = gain;
    plant->inertia.stretch = frequency;
    plant->inertia.interval = 0;
    inertia_rest(&plant->inertia, plant->acting);
    plant->hysteresis = hysteresis;
    plant->tick = 0;
}

double damped_plant_uniform(damped_plant *plant, double low, double high)
{
    return low + (high - low) * random_uniform(&plant->random);
}

void damped_plant_aim(damped_plant *plant, double factor, double share)
{
    const design *design = &plant->run.analysis.design;
    memset(plant->wanted, 0, plant->outputs * sizeof *plant->wanted);
    for (size_t j = 0; j < plant->inputs; j++) {
        const double voltage =
            share * damped_plant_uniform(plant, design->lower[j], design->upper[j]);
        for (size_t i = 0; i < plant->outputs; i++)
            plant->wanted[i] += plant->structure->influence[i * plant->all + j] * voltage;
    }
    for (size_t i = 0; i < plant->outputs && factor > 0; i++)
        plant->wanted[i] = factor * design->target[i];
}

double damped_plant_observe(const damped_plant *plant, size_t output, const double *input)
{
    double value;
    inertia_observe(&plant->inertia, output, 1, &value);
    for (size_t j = 0; j < plant->all; j++)
        value +=
            plant->inertia.gain * plant->structure->influence[output * plant->all + j] * input[j];
    return value;
}

double damped_plant_act(damped_plant *plant, size_t j, double voltage)
{
    const design *design = &plant->run.analysis.design;
    const double half = (design->upper[j] - design->lower[j]) / 2;
    double mean = 0;
    for (size_t i = 0; i < DAMPED_PLANT_PLAYS; i++) {
        const double slack = half * ((double)i + 1) / (2 * DAMPED_PLANT_PLAYS);
        double *play = &plant->play[j * DAMPED_PLANT_PLAYS + i];
        *play = fmin(fmax(*play, voltage - slack), voltage + slack);
        mean += *play / DAMPED_PLANT_PLAYS;
    }
    return voltage + plant->hysteresis * 16 / 5 * (mean - voltage);
}

void damped_plant_advance(damped_plant *plant, const double *input)
{
    inertia_jump(&plant->inertia, input);
    inertia_advance(&plant->inertia, 1 / plant->run.analysis.design.control.rate);
    plant->tick++;
}

bool damped_plant_is_stopped(const damped_plant *plant)
{
    const pzs_supervisor *supervisor = pzs_loop_find(&plant->loop, &pzs_supervisor_block);
    return supervisor && (supervisor->info.mode == PZS_MODE_STOPPING ||
                          supervisor->info.mode == PZS_MODE_LATCHED);
}
