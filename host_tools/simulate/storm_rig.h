/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Data that all simulations of a control loop on a structure with mass share (storms, the growth of
 * small vibrations, load steps); and the deviations of the simulated structure from the model,
 * which differ from one simulation to the next.
 */
#ifndef STORM_RIG_H
#define STORM_RIG_H

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
    const storm_ceramic *ceramic; /* ceramic of the electrodes of the simulated structure, if it is
                                     not that of the scene file. NULL: the hysteresis and creep of
                                     the scene file are simulated if the loop compensates them;
                                     otherwise `has_hysteresis` says whether there is any */
    bool has_hysteresis; /* true: where the loop does not compensate hysteresis, the ceramic has the
                            hysteresis of the simulated plant of the scene file (storm_rig.play);
                            false: it has none there */
    double less_hysteresis; /* part, from 0 to 1, by which the ceramic has less hysteresis and creep
                               than the scene file describes */
    double less_bandwidth; /* part by which the corner frequency of the amplifiers is lower than the
                              scene file states; negative: higher */
    bool is_uninformed;    /* true: the loop is not informed of missed ticks by pzs_loop_skip */
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
    const pzs_supervision *supervision; /* tables of the loop's supervisor; NULL: it has none */
    bool is_supervised; /* true: the simulations run with the supervisor, and end where it takes
                           control away from the loop */
    int delay; /* delay of the sensor readings between measurement and use, as the scene file states
                  it (ticks) */
    double interval;  /* time between control ticks (s) */
    double bandwidth; /* corner frequency of the first-order lag of the amplifiers (Hz); 0: no lag
                       */
    size_t sensors, targets, amplifiers;
    compensation ceramic; /* hysteresis and creep of the ceramic that the scene file describes */
    double play; /* width of the hysteresis loop of the simulated plant relative to the voltage
                    range, where the loop does not compensate hysteresis; otherwise 0 */
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
    tick_matrix static_shape;    /* [targets][amplifiers] copy of `influence` in the layout in which
                                    products with a vector, which every tick needs, are fastest */
    tick_matrix static_reading;  /* [sensors][amplifiers] copy of `direct` (static reading of each
                                    sensor per volt of each amplifier) in the layout in which
                                    products with a vector, which every tick needs, are fastest */
    tick_matrix vibration_shape; /* [targets][modes] displacement of each target row per unit of
                                    the coordinate of each vibration mode */
    tick_matrix vibration_reading; /* [sensors][modes] reading of each sensor per unit of the
                                      coordinate of each vibration mode */
    double scale;  /* unit in which shape errors are measured (m): norm of the target, or a fiftieth
                      of a reference norm if that is larger. The reference norm is the root mean
                      square, over random signs, of the norm of the shape under plus or minus half
                      the voltage range of every amplifier. */
    uint32_t *row; /* [sensors] index of the structure's output row that each sensor measures */
    double *lower, *upper; /* [amplifiers] finite limits within which random voltages are drawn (V)
                            */
} storm_rig;

/*
 * Prepare the data that all storms (simulations with fast target jumps) of an analysis share.
 *   analysis  in  analysis whose influence matrix is computed; its scene has a target, and the
 *                 densities of all materials
 *   estimator in  NULL: every target row (controlled displacement) is measured
 * Returns 0, or -1 with error filled; call storm_close in either case.
 */
int storm_open(storm_rig *rig, const analysis *analysis, const estimator *estimator, char *error);
void storm_close(storm_rig *rig);

/*
 * Prepare the same data for a structure without mass: it is in equilibrium in every tick. The scene
 * needs neither densities nor a tick rate.
 */
int storm_open_static(storm_rig *rig, const analysis *analysis, const estimator *estimator,
                      char *error);

/*
 * Let the following storms (simulations with fast target jumps) move the structure linearised about
 * its equilibrium at the target. The controller keeps its tables.
 *   deformed in  data of the structure in that equilibrium; must outlive `rig`
 * Returns whether memory sufficed.
 */
bool storm_deform(storm_rig *rig, const deformed *deformed);

/*
 * Set the control loop of the next storms (simulations with fast target jumps).
 *   rig            in/out  data that all storms share
 *   block [blocks] in      blocks (stages) of the control tick, copied; their tables must outlive
 *       the rig. The supervisor runs only while rig->is_supervised is true
 *   delay          in      age of the readings that the scene file states (ticks)
 */
void storm_use(storm_rig *rig, const pzs_block *block, int blocks, int delay);

/*
 * Return the factor from errors relative to rig->scale, the unit of shape errors, to errors
 * relative to the norm of the target: rig->scale divided by that norm. It is 1, or more for a
 * target that is small beside the shapes that the voltages reach; infinite for a zero target.
 */
double storm_unit(const storm_rig *rig);

/* Write the error message "out of memory". Returns -1. */
int storm_no_memory(const analysis *analysis, char *error);

#endif
