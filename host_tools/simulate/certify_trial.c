/* SPDX-License-Identifier: BSD-2-Clause */
/* Tables and simulated structures of a control loop on trial (certify_trial.h). */
#include "certify_trial.h"
#include <string.h>

int trial_use(trial *trial, const damper_options *options, char *error)
{
    damper_close(&trial->damper);
    if (damper_make(&trial->damper, trial->analysis, trial->few, options, error) < 0)
        return -1;
    loop_blocks_fill(&trial->blocks, &trial->analysis->design, &trial->estimator, &trial->damper);
    sensor_gate_close(&trial->gate);
    if (!loop_gate_open(&trial->gate, trial->analysis, &trial->estimator, &trial->damper))
        return storm_no_memory(trial->analysis, error);
    loop_blocks_gate(&trial->blocks, &trial->gate);
    storm_rig *const rig[] = {&trial->rig, &trial->at_target};
    for (int i = 0; i < 1 + trial->has_target; i++) {
        storm_use(rig[i], trial->blocks.block, trial->blocks.count,
                  options->delay - options->settings.later);
        rig[i]->interval = 1 / options->rate;
    }
    return 0;
}

int trial_open(trial *trial, analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    memset(trial, 0, sizeof *trial);
    trial->analysis = analysis;
    const bool needs_estimator =
        loop_estimates(design) || loop_feeds(design) || sensor_gate_is_asked(design);
    if (needs_estimator && estimator_open(&trial->estimator, analysis, error) < 0)
        return -1;
    trial->few = loop_estimates(design) ? &trial->estimator : NULL;
    return storm_open(&trial->rig, analysis, trial->few, error);
}

int trial_open_target(trial *trial, char *error)
{
    const design *design = &trial->analysis->design;
    if (design->kinematics == KINEMATICS_LINEAR)
        return 0;
    const int modes = (int)trial->rig.modal.modes;
    if (deformed_open(&trial->deformed, trial->analysis, modes, trial->no_target) < 0)
        return 0;
    if (storm_open(&trial->at_target, trial->analysis, trial->few, error) < 0)
        return -1;
    if (!storm_deform(&trial->at_target, &trial->deformed))
        return scene_fault(design->simulate.at, error, "out of memory");
    trial->has_target = true;
    return 0;
}

void trial_close(trial *trial)
{
    storm_close(&trial->at_target);
    deformed_close(&trial->deformed);
    storm_close(&trial->rig);
    sensor_gate_close(&trial->gate);
    damper_close(&trial->damper);
    estimator_close(&trial->estimator);
}
