/*
 * A control loop with a fault detector that damps the vibration of a structure with mass. The
 * structure differs from the model of the loop, its ceramic has hysteresis, and electrodes fail.
 * For test programs.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef FAULT_RIG_H
#define FAULT_RIG_H

#include "ceramics.h"
#include "damped_plant.h"

enum { FAULT_RIG_INPUTS = 80 };

/* A structure and its sensors. */
typedef struct fault_structure {
    const char *name;
    const char *scene;    /* name of a shipped scene, or a path */
    const char *changes;  /* changes of the scene, each followed by a semicolon */
    double limit;         /* largest voltage of each electrode, in both directions (V) */
    const char *readings; /* sensors, as in the key `estimate.readings` of a scene; empty: every
                             node is measured */
} fault_structure;

/* Ceramic of a family of its own, with creep. The loop compensates what a sweep has shown of it. */
typedef struct fault_ceramic {
    ceramic_family family;
    double width; /* width of the hysteresis loop, relative to the voltage range */
    double creep; /* final creep of each time constant, relative to the voltage */
} fault_ceramic;

typedef struct fault_rig {
    damped_plant plant;
    double noise, missed; /* RMS noise of a reading (m), and chance that a tick is missed */
    double *load;         /* [inputs] constant load, as the voltages that would move the structure
                             as far (V) */
    double *sum;          /* [all inputs of the structure] sums of the voltages that act and of the
                             load (V) */
    double *readings;     /* [sensors] readings (m) */
    pzs_electrode_fault fault[FAULT_RIG_INPUTS];
    test_ceramic *resting, *ceramic; /* ceramic at rest, and [inputs] that of each electrode; NULL:
                                        the plays of the plant */
    double given[FAULT_RIG_INPUTS];  /* last voltage of the ceramic of each electrode (V) */
    double rest;                     /* effect of the ceramic at rest, from which the structure
                                        is measured (V) */
    int next_jump, every; /* tick of the next target; mean number of ticks between targets */
} fault_rig;

/*
 * Open a rig.
 *   compensated in  width, relative to the voltage range, of the hysteresis loop that the control
 *                   loop compensates; 0: no compensation
 *   ceramic     in  ceramic of all electrodes, of which the loop compensates what `pzs calibrate
 *                   --hysteresis` would identify from a sweep; NULL: plays, compensated as
 *                   `compensated` says
 * Returns 0, or -1 after a message; the rig must be closed in either case.
 */
int fault_rig_open(fault_rig *rig, const fault_structure *structure, double compensated,
                   const fault_ceramic *ceramic);
void fault_rig_close(fault_rig *rig);

/*
 * Return loop and structure to rest at zero voltages, without faults.
 *   gain      in  static response of the structure relative to the model
 *   frequency in  natural frequencies of the structure relative to the model
 *   hysteresis in  width of the hysteresis loop of the plays, relative to the voltage range
 *   every     in  mean number of ticks between jumps of the target
 */
void fault_rig_start(fault_rig *rig, uint64_t seed, double gain, double frequency,
                     double hysteresis, int every);

/* Set a new target: a part of the scene's, or the shape of random voltages. */
void fault_rig_jump(fault_rig *rig);

/* Run one tick: readings, loop, structure. */
pzs_status fault_rig_tick(fault_rig *rig);

/*
 * Run some ticks.
 *   every in  mean number of ticks between jumps of the target; 0: the target stands still
 */
void fault_rig_run(fault_rig *rig, int ticks, int every);

/* Return the fault detector of the loop. */
const pzs_pulse_detector *fault_rig_detector(const fault_rig *rig);

/* Whether the fault detector holds electrode j as faulty. */
bool fault_rig_is_held(const fault_rig *rig, size_t j);

/* Release all electrodes that the fault detector holds. */
void fault_rig_release(fault_rig *rig);

#endif
