/*
 * A control loop that damps vibration, with the tables that `pzs tables` makes from a scene, and a
 * structure with mass around which the loop is closed. The structure may differ from the loop's
 * model in its static response and natural frequencies, and its ceramic may have hysteresis. For
 * test programs.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef DAMPED_PLANT_H
#define DAMPED_PLANT_H

#include <stdint.h>
#include "../../host_tools/model/modal.h"
#include "../../host_tools/simulate/inertia.h"
#include "../../host_tools/tables/loop_blocks.h"
#include "scene_run.h"

enum { DAMPED_PLANT_PLAYS = 4 };

typedef struct damped_plant {
    scene_run run;    /* scene of the loop */
    loop_parts parts; /* tables of the loop */
    pzs_loop loop;
    void *work;
    size_t bytes;              /* memory of the loop */
    const analysis *structure; /* analysis of the structure: that of the loop, or another one */
    size_t inputs, outputs;    /* numbers of electrodes, and of target nodes */
    size_t all;                /* number of electrodes and loads of the structure */
    size_t sensors;
    size_t *sensor_row; /* [sensors] output that each sensor measures */
    vibration vibration;
    modal modal;
    inertia inertia;   /* its members gain and stretch: static response and natural frequencies
                          relative to the model */
    double hysteresis; /* width of the hysteresis loop relative to the voltage range */
    double *play;      /* [inputs][DAMPED_PLANT_PLAYS] plays of the hysteresis (V) */
    double *acting;    /* [all] voltages that act on the ceramic (V), then factors of the loads */
    double *wanted;    /* [outputs] target shape (m) */
    uint64_t random;
    int tick;
} damped_plant;

/*
 * Open the loop of a scene, whose name and changes are those of scene_run_open, with the settings
 * that its certificate chooses. Returns 0, or -1 after a message. The plant must be closed in
 * either case.
 */
int damped_plant_open_loop(damped_plant *plant, const char *scene, const char *changes);

/*
 * Open the structure around which the loop is closed.
 *   structure in  its analysis: that of the loop, or one with more loads; must outlive the plant
 *   modes     in  number of its vibration modes
 * Returns 0, or -1 after a message.
 */
int damped_plant_open_structure(damped_plant *plant, analysis *structure, int modes);
void damped_plant_close(damped_plant *plant);

/*
 * Return loop and structure to rest, without loads and with a target of 0.
 *   gain      in  static response of the structure relative to the model
 *   frequency in  natural frequencies of the structure relative to the model
 */
void damped_plant_start(damped_plant *plant, double gain, double frequency, double hysteresis);

/* Return a random number between low and high. */
double damped_plant_uniform(damped_plant *plant, double low, double high);

/*
 * Set the target to `factor` times that of the scene or, where the factor is not positive, to the
 * shape of random voltages of up to `share` times their limits.
 */
void damped_plant_aim(damped_plant *plant, double factor, double share);

/*
 * Return an output of the structure, which vibrates about its equilibrium.
 *   input [all] in  voltages on the ceramic and factors of the loads in this equilibrium
 */
double damped_plant_observe(const damped_plant *plant, size_t output, const double *input);

/* Return the voltage that acts on the ceramic of electrode j where its amplifier gives `voltage`.
 */
double damped_plant_act(damped_plant *plant, size_t j, double voltage);

/*
 * Advance the structure by a tick under constant inputs.
 *   input [all] in  voltages on the ceramic and factors of the loads
 */
void damped_plant_advance(damped_plant *plant, const double *input);

/* Whether the supervisor of the loop, if there is one, has taken control away. */
bool damped_plant_is_stopped(const damped_plant *plant);

/* Print why a test cannot run. Returns -1. */
int damped_plant_complain(const damped_plant *plant, const char *error);

#endif
