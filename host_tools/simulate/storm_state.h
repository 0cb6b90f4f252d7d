/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * State of one simulation of a control loop on a structure with mass, and its ticks: for storms
 * (simulations with fast target jumps), the growth of small vibrations, and load steps. Only the
 * files of these simulations include this header.
 */
#ifndef STORM_STATE_H
#define STORM_STATE_H

#include "storm_rig.h"

/* State of one storm: simulation of a control loop with fast jumps of the target. */
typedef struct storm {
    const storm_rig *rig;
    const storm_plant *plant;
    pzs_problem problem;   /* voltage optimisation problem of the loop with the voltage and step
                              limits of the simulation in place of the scene's */
    pzs_problem *replaced; /* problem in the tables of a control law for comparison, whose limits
                              are those of the simulation until it ends; NULL: there is none */
    pzs_problem original;  /* the problem in those tables before and after the simulation */
    pzs_supervision supervision; /* tables of the loop's supervisor, changed so that it starts
                                    without a command */
    pzs_block block[PZS_BLOCK_LIMIT];
    int blocks;
    pzs_loop loop;
    void *work;
    inertia inertia;
    uint64_t random;
    int tick, history_ticks; /* number of the present tick; number of ticks whose readings are
                                stored */
    bool has_shape;          /* true while `shape` holds the present shape of the structure */
    bool has_vibration; /* true while the array `part` holds the displacements of the target nodes
                           by vibration in this tick */
    int missed_ticks; /* number of missed ticks since the last tick in which the control loop ran */
    int wrong; /* sensor that reads `wrong_value` (unit of the sensor) in place of its measurement;
                  -1: no sensor is wrong */
    double wrong_value;
    double noise;   /* standard deviation of the noise of a reading, in the unit of the reading */
    double *memory; /* one allocation that holds `limits` and all arrays of this struct that follow
                       it */
    double *limits; /* [3][amplifiers] lower voltage limits, upper voltage limits and step limits of
                       the simulation (V) */
    double *voltage; /* [amplifiers] voltages of the amplifiers in the present tick (V) */
    double *output;  /* [amplifiers] output voltages of the amplifiers, which follow the voltages of
                        the control loop with a first-order lag where the scene file states their
                        bandwidth (V) */
    double *driven;  /* [amplifiers] mean output voltages of the amplifiers from this tick to the
                        next (V) */
    double *acting;  /* [amplifiers] voltages that act on the ceramic of the electrodes, after
                        hysteresis and creep (V) */
    double *stroke;  /* [2][amplifiers] lowest and highest voltages that can act on the ceramic of
                        the electrodes (V). They differ from the voltage limits of the amplifiers
                        because of hysteresis. */
    double *play;    /* [amplifiers][PZS_PLAY_LIMIT] outputs of the play operators of the hysteresis
                        model (V); without compensation the first PLAYS of them are those of the
                        simulated plant (imperfections.h) */
    double *creep;   /* [amplifiers][PZS_CREEP_LIMIT] outputs of the first-order lags of the creep
                        model (V) */
    const pzs_hysteresis *hysteresis; /* hysteresis and creep of the ceramic as the scene file
                                         describes them; NULL where the loop does not compensate
                                         them */
    double width; /* width of the hysteresis loop of the ceramic relative to the voltage range, in a
                     loop that does not compensate hysteresis; 0: no hysteresis */
    double *previous_voltage; /* [amplifiers] voltages of the amplifiers before the last control
                                 tick (V) */
    double *target;           /* [targets] target shape in the present tick */
    double *last_target; /* [targets] target displacements (m) at the end of the simulation: the
                        target of the scene file */
    double *best_shape;  /* [targets] best shape for the last target that the limits allow on the
                            simulated structure */
    double *shape;       /* [targets] shape of the simulated structure in the present tick */
    double *part; /* [targets] work array for the displacements of the target nodes by vibration */
    double *sensed; /* [sensors] readings that the control loop receives in the present tick */
    double *load; /* [rows] displacement of each output row of the structure in equilibrium under a
                     load that appears at once (load_step.h); zero before it appears, and in
                     simulations without such a load */
    double *vibrating; /* [sensors] work array for the readings that the present vibration causes */
    double *reading;   /* [history_ticks][sensors] noise-free readings of the last ticks */
} storm;

/* Write the error of a control loop in a simulation as a message. Returns -1. */
int storm_explain(const storm *storm, pzs_status status, char *error);

/*
 * Start a simulation: its control loop, and its structure at rest under the first voltages of the
 * loop. Returns 0, or -1 with error filled; call storm_end in either case.
 */
int storm_begin(storm *storm, const storm_rig *rig, const storm_plant *plant, char *error);
void storm_end(storm *storm);

/*
 * Whether a simulation has neither voltage limits nor step limits, because it measures the growth
 * of small vibrations.
 */
bool storm_is_free(const storm *storm);

/*
 * Run one tick of a simulated control loop: take readings, compute voltages, and advance the
 * structure to the next tick. Returns the status of the loop.
 */
pzs_status storm_tick(storm *storm);

/*
 * Compute the present displacements of the targets by vibration into storm->part, if this has not
 * been done in this tick. These sums over all modes are most of the work of a simulation.
 */
void storm_observe_vibration(storm *storm);

/* Compute the present shape of the simulated structure, unless it is known already. */
void storm_compute_shape(storm *storm);

/*
 * Weighted norm of the difference of two shapes, or of the first shape where the second is NULL.
 *   first, second [targets] in  displacements of the two shapes
 */
double storm_distance(const storm *storm, const double *first, const double *second);

/*
 * Return the slope of the straight line that fits values best (least squares), as a function of
 * their indices.
 *   value [count] in  values, one for each index
 */
double storm_slope(const double *value, int count);

/*
 * Return the static displacement of an output of the structure at 0 V (m). It has two parts: the
 * displacement by a load step and, on a structure linearised about a deformed state, the
 * displacement extrapolated from there to 0 V. Simulations of the growth of small vibrations leave
 * out the second part, because it does not affect the growth.
 */
double storm_offset(const storm *storm, size_t row);

/*
 * Compute the static shape of the simulated structure under given voltages, and store it as the
 * shape with which storms (simulations with fast target jumps) compare the present one
 * (`best_shape`).
 */
void storm_compute_rest(storm *storm, const double *voltage);

/*
 * Compute the shape with which the shape at the end of a storm (simulation with fast jumps of the
 * target) is compared. It is the best approximation of the last target that the voltages on the
 * ceramic allow, by the influence matrix of the simulated structure. On a structure linearised
 * about a deformed state it is the shape at which the loop comes to rest with the influence matrix
 * of the controller.
 *   voltage [amplifiers] out  voltages of this shape (V)
 */
pzs_status storm_find_best(storm *storm, double *voltage);

/*
 * Choose the hysteresis model of the ceramic: that of the section `hysteresis` of the scene file if
 * the loop compensates hysteresis; otherwise that of the simulated plant, or none. Then compute
 * from it the lowest and highest equivalent voltages of the ceramic, those at the voltage limits
 * after rest at 0 V. The equivalent voltage would cause the same strain without hysteresis.
 */
void storm_start_ceramic(storm *storm);

/*
 * Compute the lowest and highest equivalent voltages of a ceramic whose hysteresis the loop does
 * not compensate, from its present state. Where the voltage limits are not symmetric they depend on
 * the largest voltages so far. Returns whether any of them has changed.
 */
bool storm_renew_stroke(storm *storm);

/*
 * Advance the amplifiers, and the hysteresis and creep of the ceramic, by one tick interval under
 * the present voltages.
 */
void storm_advance_ceramic(storm *storm);

#endif
