/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Storms: a control loop against a structure with mass that differs from its model, while the
 * target jumps so fast that the voltage and step limits are always in force. A loop whose linear
 * part is stable may end such a storm in a limit cycle.
 *
 * A storm throws 10 targets, one every 0.6 periods of the first mode: the scene's target z, -z, the
 * shape of random voltages of up to twice the limits, or of twice the limits with random signs.
 * Then z stands for 12 periods. A storm is passed where the shape ends within 5 % of z of the best
 * shape that the limits allow on that structure.
 */
#ifndef STORM_H
#define STORM_H

#include "../model/modal.h"
#include "../tables/loop_blocks.h"
#include "inertia.h"
#include "laws.h"

/* The structure of a storm, relative to the model, and how fast the voltages may move. */
typedef struct storm_plant {
    double gain;       /* static response to voltages over that of the model */
    double frequency;  /* natural frequencies over those of the model */
    double step_limit; /* step limits over those of the scene; HUGE_VAL: none, and no voltage
                          limits, for the growth of small vibrations */
    int more_delay;    /* ticks by which readings are older than the scene says; negative: newer */
    uint64_t seed;     /* which targets are thrown */
} storm_plant;

/* What all storms of one loop share. */
typedef struct storm_rig {
    const analysis *analysis;
    const estimator *estimator; /* sensors of the controller; NULL: the target rows are measured */
    pzs_block block[PZS_BLOCK_LIMIT];
    int blocks;
    int delay;         /* age of the readings that the scene states (ticks) */
    bool is_corrected; /* late readings are corrected by the change that the model predicts, as the
                          caller of a loop without a vibration block has to do it */
    double interval;   /* time between ticks (s) */
    size_t sensors, targets, amplifiers;
    vibration vibration;
    modal modal;
    double *memory;        /* memory of the arrays below */
    double *direct;        /* [sensors][amplifiers] static readings per volt */
    double *influence;     /* [targets][amplifiers] static displacements per volt */
    uint32_t *row;         /* [sensors] output row of each sensor */
    double *lower, *upper; /* [amplifiers] finite limits for random voltages (V) */
} storm_rig;

typedef struct storm_result {
    double end;    /* largest distance from the best shape in the last period, over |W z| */
    double peak;   /* largest distance at any time */
    double growth; /* growth of the distance a tick, mean over the second half; for runs without
                      limits */
    int ticks;
    bool passed;
} storm_result;

/*
 * Prepare storms.
 *   analysis  in  after analysis_influence, with a target and all densities
 *   estimator in  NULL where every target row is measured
 * Returns 0, or -1 with error filled; call storm_close in either case.
 */
int storm_open(storm_rig *rig, const analysis *analysis, const estimator *estimator, char *error);
void storm_close(storm_rig *rig);

/*
 * Set the loop of the next runs.
 *   block [blocks] in  copied; its tables must outlive the rig
 *   delay          in  age of the readings that the scene states (ticks)
 */
void storm_use(storm_rig *rig, const pzs_block *block, int blocks, int delay);

/* Run one storm. Returns 0, or -1 with error filled. */
int storm_run(const storm_rig *rig, const storm_plant *plant, storm_result *result, char *error);

/*
 * Growth a tick of a small vibration without any limits: the spectral radius of the loop, measured
 * with the loop itself. The run starts from random positions and velocities of all modes and ends
 * when the vibration has grown or decayed by a factor of 1e6, or after `ticks`.
 */
int storm_growth(const storm_rig *rig, const storm_plant *plant, int ticks, storm_result *result,
                 char *error);

#endif
