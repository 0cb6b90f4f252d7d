/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables of the damped tick (pzs_vibration) of a scene: which modes it observes, how the sensors
 * and the outputs move in them, and the gains (damper_gains.h).
 *
 * Observed are the modes that turn by at most 2 rad in a tick and that the outputs show, from the
 * lowest on; no more than there are amplifiers that move, and fewer than sensors. Coordinates are
 * scaled so that a mode moves the outputs by an RMS value of 1.
 */
#ifndef DAMPER_H
#define DAMPER_H

#include <stdbool.h>
#include "damper_gains.h"
#include "estimator.h"

typedef struct damper {
    bool is_used; /* the control loop needs the damped tick; the members below are set */
    char reason[SCENE_ERROR]; /* why a loop that needs the damped tick has none; else empty */
    int modes;                /* number of observed modes */
    double *frequency;        /* [modes] natural frequencies (Hz) */
    double rate;              /* ticks per second */
    double *memory;           /* memory of all arrays */
    pzs_vibration tables;
} damper;

/* What the tables of a damped tick are made for. */
typedef struct damper_options {
    double rate; /* ticks per second */
    int delay;   /* age of the readings (ticks) */
    damper_settings settings;
} damper_options;

/* The scene's rate and delay, and the settings that its certificate has chosen. */
damper_options damper_options_of(const analysis *analysis);

/*
 * Make the tables for given options, whether the loop needs them or not. The arguments are those of
 * damper_open. Returns 0, or -1 with error filled and the damper unused.
 */
int damper_make(damper *damper, const analysis *analysis, const estimator *estimator,
                const damper_options *options, char *error);

/*
 * Make the tables where the scene has a tick rate and densities and its control step alone would be
 * unstable (certificate_refuses); otherwise leave the damper unused. The option `quasi_static` of
 * the analysis leaves it unused too.
 *   analysis   in  after certificate_make and design_control; must outlive the damper
 *   estimator  in  sensors of the controller; must outlive the damper; NULL: every target node is
 *                  measured
 * Returns 0, or -1 with error filled and the damper unused.
 */
int damper_open(damper *damper, const analysis *analysis, const estimator *estimator, char *error);
void damper_close(damper *damper);

/* One sentence on the observed modes, the rate and the delay. */
void damper_text(const damper *damper, char text[SCENE_ERROR]);

#endif
