/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Storms. A storm is a simulation of a control loop with a structure with mass that differs from
 * its model, while the target jumps so fast that the voltage and step limits are always active. A
 * loop that is stable without limits may end such a storm in a limit cycle.
 *
 * A storm sets 10 targets, one every 0.6 periods of the first vibration mode: the scene's target,
 * its negative, or the shape under random voltages of up to twice the limits. Then the scene's
 * target stays for 12 periods. A storm settles where the shape ends within 5 % (of the norm of the
 * target) of the best shape that the limits allow on that structure.
 */
#ifndef STORM_H
#define STORM_H

#include "../model/deformed.h"
#include "../model/modal.h"
#include "../tables/loop_blocks.h"
#include "inertia.h"
#include "laws.h"
#include "tick_matrix.h"

/*
 * Ceramic of the electrodes of a simulated structure, which may differ from the ceramic that the
 * controller's tables describe.
 */
typedef struct storm_ceramic {
    /*
     * Compute the voltages that act on the ceramic from this tick to the next.
     *   voltage  [amplifiers] in  voltages of the amplifiers (V)
     *   acting   [amplifiers] out  voltages that act (V)
     */
    void (*act)(void *state, const double *voltage, double *acting);
    void *state;
    const double *lowest, *highest; /* [amplifiers] lowest and highest voltages that can act on the
                                       ceramic of the electrodes (V) */
} storm_ceramic;

/*
 * Structure in a storm (a simulation with fast target jumps), relative to the controller's model,
 * and step limits of the voltages.
 */
typedef struct storm_plant {
    double gain; /* static response of the structure to voltages, relative to the controller's model
                  */
    double frequency; /* natural frequencies of the structure, relative to the controller's model */
    double step_limit;   /* ratio of the step limits to those of the scene; HUGE_VAL: neither step
                            limits nor voltage limits, to measure the growth of small vibrations */
    int more_delay;      /* number of ticks by which readings are older than the scene file states;
                            negative: newer */
    uint64_t seed;       /* seed of the random sequence of target jumps */
    double missed_share; /* part of the ticks that the controller misses, from 0 to 1 */
    const storm_ceramic *ceramic; /* ceramic of the simulated structure. NULL: with the hysteresis
                                     and creep of the scene file if the loop compensates them,
                                     otherwise without */
    double less_hysteresis; /* part, from 0 to 1, by which the ceramic has less hysteresis and creep
                               than the scene file describes */
    bool is_uninformed;     /* true: the loop is not informed of missed ticks by pzs_loop_skip */
} storm_plant;

/*
 * Data that all storms (simulations with fast target jumps) of one control loop share: structure,
 * sensors, and the blocks (stages) of the control tick.
 */
typedef struct storm_rig {
    const analysis *analysis;
    const estimator *estimator; /* estimator of the controller; NULL: the target rows (controlled
                                   displacements) are measured */
    pzs_block block[PZS_BLOCK_LIMIT];
    int blocks;
    int delay; /* delay of the sensor readings between measurement and use, as the scene file states
                  it (ticks) */
    double interval;  /* time between control ticks (s) */
    double bandwidth; /* corner frequency of the first-order lag of the amplifiers (Hz); 0: no lag
                       */
    size_t sensors, targets, amplifiers;
    compensation ceramic; /* hysteresis and creep of the ceramic as the scene file describes them */
    vibration vibration;
    modal modal;
    const double *offset; /* [outputs] displacement of each output row at 0 V, on a structure
                             linearised about the equilibrium at its target; NULL: zero */
    double *memory; /* one allocation that holds `direct` and all arrays of this struct that follow
                       it */
    double *direct; /* [sensors][amplifiers] static reading of each sensor per volt of each
                       amplifier */
    double *influence; /* [targets][amplifiers] static displacement of each target row (controlled
                          displacement) per volt of each amplifier */
    tick_matrix static_shape;      /* [targets][amplifiers] copy of `influence` for the ticks */
    tick_matrix static_reading;    /* [sensors][amplifiers] copy of `direct` for the ticks */
    tick_matrix vibration_shape;   /* [targets][modes] displacement of each target row per unit of
                                      the coordinate of each vibration mode */
    tick_matrix vibration_reading; /* [sensors][modes] reading of each sensor per unit of the
                                      coordinate of each vibration mode */
    double scale;  /* unit in which shape errors are measured (m): norm of the target, or a fiftieth
                      of a reference norm if that is larger. The reference norm is the root mean
                      square norm of the shapes under half the voltage range of all amplifiers with
                      random signs. */
    uint32_t *row; /* [sensors] index of the structure's output row that each sensor measures */
    double *lower, *upper; /* [amplifiers] finite limits within which random voltages are drawn (V)
                            */
} storm_rig;

typedef struct storm_result {
    double end;  /* largest distance of the shape from the best shape that the voltage limits allow,
                    at the end of a storm (simulation with fast target jumps): over about one period
                    of the first vibration mode; relative to the norm of the target */
    double peak; /* largest distance of the shape from the best shape that the voltage limits allow,
                    at any time of a storm (simulation with fast target jumps); relative to the norm
                    of the target */
    double growth; /* growth factor per tick of the amplitude of small vibrations of the structure,
                      mean over the second half of the simulation; only for simulations without
                      voltage limits */
    int ticks;
    bool passed;
} storm_result;

/*
 * Prepare the data that all storms (simulations with fast target jumps) of an analysis share.
 *   analysis  in  analysis whose influence matrix is computed, with a target and all densities
 *   estimator in  NULL: every target row (controlled displacement) is measured
 * Returns 0, or -1 with error filled; call storm_close in either case.
 */
int storm_open(storm_rig *rig, const analysis *analysis, const estimator *estimator, char *error);
void storm_close(storm_rig *rig);

/*
 * Let the following storms (simulations with fast target jumps) move another structure: the one
 * linearised about its equilibrium at the target, in place of the undeformed one. The controller
 * keeps its tables.
 *   deformed in  data of the structure in that equilibrium; must outlive `rig`
 * Returns whether memory sufficed.
 */
bool storm_deform(storm_rig *rig, const deformed *deformed);

/*
 * Set the control loop of the next storms (simulations with fast target jumps).
 *   rig            in/out  data that all storms share
 *   block [blocks] in blocks (stages) of the control tick, copied; their tables must outlive the
 *       rig. The supervisor is left out: it would take control away where targets jump beyond all
 *       limits or a small vibration begins without a cause
 *   delay          in      age of the readings that the scene file states (ticks)
 */
void storm_use(storm_rig *rig, const pzs_block *block, int blocks, int delay);

/* Run one storm, a simulation with fast target jumps. Returns 0, or -1 with error filled. */
int storm_run(const storm_rig *rig, const storm_plant *plant, storm_result *result, char *error);

/*
 * Measure the growth factor per tick of a small vibration without any limits, which is the spectral
 * radius of the loop. The simulation starts from random positions and velocities of all vibration
 * modes and ends when the vibration has grown or decayed by a factor of 1e6, or after `ticks`.
 * Returns 0, or -1 with error filled.
 */
int storm_growth(const storm_rig *rig, const storm_plant *plant, int ticks, storm_result *result,
                 char *error);

/*
 * Simulate load steps: a load that the voltages can compensate appears at once on a structure at
 * rest, as the model has it. Measure the time until the shape stays within 5 % of the effect of the
 * load (its displacements without compensation) from the best shape under the load.
 *
 * The loads are a uniform pressure, two forces at single outputs, and loads that move the first or
 * third vibration mode only, without their parts in vibration modes that turn by more than 0.6 rad
 * in a tick: the control tick does not damp those in full. They need 30 % of the voltage range from
 * the middle to a limit. Loads of which the best voltages leave more than a fifth are left out.
 *   rig     in   data that all storms share, with the control loop (storm_use)
 *   first   in   natural frequency of the first vibration mode that the loop observes (Hz)
 *   periods out  longest time of all loads, in periods of this mode, at most 8; NAN where the
 *                voltages can compensate none of the loads
 * Returns 0, or -1 with error filled.
 */
int storm_load_step(const storm_rig *rig, double first, double *periods, char *error);

#endif
