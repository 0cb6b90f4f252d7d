/*
 * A sweep of an actuator of test ceramic, and the section `hysteresis` of a scene that is
 * identified from it, as `pzs calibrate --hysteresis` does. For test programs.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef CERAMIC_SWEEP_H
#define CERAMIC_SWEEP_H

#include "ceramics.h"
#include "../../host_tools/model/identify.h"

enum { CERAMIC_SWEEP_SAMPLES = 4000 };

/* A sweep with its samples. */
typedef struct ceramic_sweep {
    size_t count;
    double voltage[CERAMIC_SWEEP_SAMPLES], position[CERAMIC_SWEEP_SAMPLES];
    sweep sweep;
} ceramic_sweep;

/*
 * Measure a ceramic in a fading triangle wave, then under a constant voltage, with noise of 0.2 %.
 *   interval in  time between two samples (s)
 *   gain     in  position per volt of the effect
 */
void ceramic_sweep_measure(ceramic_sweep *record, test_ceramic *ceramic, double interval,
                           double gain);

/* Write the section `hysteresis` of a scene, as after --set. */
void ceramic_sweep_section(const scene_hysteresis *hysteresis, char *text, size_t room);

#endif
