/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Simulation of a closed loop on the host: the library's controller, a plant that differs from its
 * model (plant.h), faulty sensors and amplifiers, and the events of the scene. Every run of a scene
 * gives bit-identical results. Order of a tick:
 *   1. time since the last tick, and events
 *   2. shape under the voltages of the previous tick, and its measurement
 *   3. controller, on the host or as firmware on a board (simulate_device)
 *   4. amplifiers
 *
 * For comparison the loop also runs with clipped unconstrained least squares, without
 * regularisation and with the parameter that is best for the scene's target on the controller's
 * model.
 */
#ifndef SIMULATION_H
#define SIMULATION_H

#include "device.h"
#include "../model/damper.h"
#include "../model/wiring_test.h"
#include "plant.h"

struct loop_blocks;
struct sensor_gate;

/*
 * Control laws of a simulation: LAW_CONTROLLER is the library's controller, and LAW_CLAMP (clipped
 * least squares) and LAW_REGULARISED (clipped regularised least squares) are simulated for
 * comparison with it.
 */
typedef enum simulate_law { LAW_CONTROLLER, LAW_CLAMP, LAW_REGULARISED, LAWS } simulate_law;

/* Results of one tick of a simulation, passed to the callback of simulate_run. */
typedef struct simulate_sample {
    simulate_law law;
    int tick;
    double error; /* relative shape error at the start of the tick: weighted norm of shape minus
                     wanted shape divided by the weighted norm of the scene's target */
    double measurement_error; /* relative measurement error: weighted norm of true shape minus shape
                                 measured by the controller, divided by the weighted norm of the
                                 scene's target */
    double vibration; /* relative vibration: weighted norm of shape minus static equilibrium of the
                         plant, divided by the weighted norm of the scene's target; 0 for a
                         quasi-static plant */
    const double *command;  /* [amplifiers] voltages that the controller has commanded (V) */
    const double *voltage;  /* [amplifiers] output voltages of the amplifiers (V) */
    int active, iterations; /* for one tick of a simulation: number of commanded voltages at a
                               limit; number of iterations of the optimiser */
    pzs_status status;
    bool is_missed; /* true: the tick was missed, and the controller did not run */
} simulate_sample;

typedef void simulate_tick_callback(void *context, const simulate_sample *sample);

/*
 * Results of one control law in one phase of a simulation (interval between events of the scene).
 */
typedef struct simulate_course {
    double steady; /* relative shape error, root mean square over the last ticks of the phase
                      (interval between events); infinite where a control law for comparison has
                      diverged */
    double worst;  /* largest relative shape error in the phase (interval between events) of the
                      simulation */
    double measurement_error; /* error of the shape that the controller measures, relative to the
                                 norm of the scene's target: root mean square over the last ticks of
                                 the phase (interval between events) */
    double vibration; /* deviation of the shape from the static equilibrium, relative to the norm of
                         the scene's target: root mean square over the last ticks of the phase
                         (interval between events) */
    double vibration_worst; /* largest deviation of the shape from the static equilibrium in the
                               phase (interval between events), relative to the norm of the scene's
                               target */
    int settled; /* settling time (ticks) from the start of the phase (interval between events):
                    afterwards the shape stays within 5 % of its largest distance from its final
                    value; -1: never settled */
    int step_limit_ticks; /* smallest number of ticks in which the step limit lets the voltages
                             change from those at the start of the phase (interval between events)
                             to those at its end */
    double *voltage;      /* [amplifiers] output voltages at the end of the phase (interval between
                             events) of the simulation (V) */
    double *shape; /* [targets] displacements of the target rows (controlled displacements) at the
                      end of the phase (interval between events) */
    double *displacement; /* [free_dof] displacement vector of the plant at the end of the phase
                             (interval between events) */
} simulate_course;

/* Phase of a simulation: the ticks from one tick at which events happen to the next such tick. */
typedef struct simulate_phase {
    int from, until;
    int first, events; /* first: index of the first of the scene's events at the beginning of this
                          phase; events: number of these events. A phase lasts until the next
                          events. */
    double optimum;    /* relative shape error of the best shape that the plant can reach with the
                          voltages that can act on its ceramic; NAN until it is computed */
    simulate_course course[LAWS];
    double *target; /* [targets] wanted displacements at the end of the phase (interval between
                       events) */
    double *load; /* [loads + 1] load factors of the plant at the end of the phase (interval between
                     events); the last entry is the temperature change (K) */
    double *lowest;  /* [amplifiers] lowest voltages that can act on the ceramic at the end of the
                        phase (interval between events), after hysteresis and creep, if all
                        amplifiers move to their lower limits; for a faulty electrode its present
                        voltage (V) */
    double *highest; /* [amplifiers] voltages that would act on the ceramic at the end of the phase
                        (interval between events) if all amplifiers moved to their upper limits (V)
                      */
} simulate_phase;

/* Number of status values below the first error: PZS_OK and all warnings. */
enum { SIMULATE_STATUSES = PZS_E_ARGUMENT };

/* Numbers that are summed over all ticks of the simulation of one control law. */
typedef struct simulate_count {
    long beyond_limits; /* number of voltages, commanded by the controller or put out by the
                           amplifiers, that violate a voltage limit or the step limit */
    long beyond_rows;   /* number of violated limits on differences or sums of voltages, added
                           over all ticks. In a tick a limit counts once if the commanded
                           voltages violate it, and once more if the output voltages do */
    long not_finite;    /* number of commanded or output voltages that are not finite */
    long iterations;    /* number of iterations of the optimiser in all ticks of the simulation */
    int iterations_most;
    long status[SIMULATE_STATUSES]; /* number of ticks with each warning of the controller; ticks
                                       without a warning at index 0 */
    long missed_ticks;
    long detected, falsely_detected; /* number of electrodes that the fault detector reported, and
                                        number of reported electrodes without a fault */
    int detection_ticks; /* longest time from a fault of an electrode to its detection (ticks) */
    long agreeing_ticks; /* number of ticks in which the board and its twin (the firmware's C code
                            on this computer) gave bit-identical results */
    double seconds;
} simulate_count;

typedef struct simulation {
    const analysis *nominal;
    plant plant;
    const pzs_problem *problem; /* least-squares problem for the voltages that the controller
                                   solves, from the model of the scene's structure and not of the
                                   simulated plant, which differs from it */
    struct loop_blocks *blocks; /* list of the blocks (stages) of a control tick; the firmware of
                                   the scene has the same list */
    estimator estimator; /* gains of the shape estimator, and feed-forward tables of the known
                            loads; empty unless `estimates` or `feeds` is set */
    damper damper; /* tables of the stage of the control tick that damps vibration; unused for a
                      quasi-static plant */
    struct sensor_gate *gate; /* tables of the sensor gate, which takes wrong readings away */
    wiring_test pulses; /* tables of the test pulses (slow, smooth pulses of an amplifier's voltage)
                           of the fault detector in a loop that damps vibration; unused unless the
                           scene lets the controller itself detect electrode faults */
    wiring_test wiring; /* self-test of amplifiers, cables and sensors, which the controller makes
                           before the first tick of the simulation; unused where the scene has none
                         */
    pzs_selftest_verdict verdict; /* result of the controller's self-test of amplifiers, cables and
                                     sensors, if it did not pass */
    char findings[SCENE_ERROR]; /* text of what the controller's self-test of amplifiers, cables and
                                   sensors has found; empty: it has passed or has not ended */
    damper unused_damper; /* empty tables of a vibration damper, for control laws that do not damp
                             vibration */
    struct loop_blocks *undamped_blocks; /* list of the blocks (stages) of a control tick without
                                            the one that damps vibration, for the control laws with
                                            which the controller is compared */
    bool estimates;   /* whether the controller estimates the shape from few sensors */
    bool feeds;       /* whether the controller compensates known loads by feed-forward voltages */
    bool has_target;  /* whether the scene's target differs from zero at some target node */
    double reference; /* denominator of all relative errors: the weighted norm of the scene's target
                         or, where the target is zero, of the shape without voltages (m) */
    double compared_regularisation; /* regularisation that the control law for comparison
                                       LAW_REGULARISED (least squares, then clipped) adds to that of
                                       the scene (m2/V2) */
    double regularisation;     /* regularisation of the control law for comparison LAW_REGULARISED,
                                  relative to the mean diagonal entry of the Hessian of the voltage
                                  optimisation problem (dimensionless) */
    const device_board *board; /* microcontroller board, emulated by QEMU, that runs the controller;
                                  NULL: the controller runs on the host */
    char folder[DEVICE_PATH];  /* path of the temporary folder in which the firmware of the
                                  controller is built, where a board runs the controller */
    int phases;
    simulate_phase *phase;
    simulate_count count[LAWS];
} simulation;

/*
 * Build the simulated structure and the phases of the simulation, each from one tick with events to
 * the next.
 *   nominal in/out  analysis of a scene with a `simulate` section and a computed influence matrix;
 *       must outlive the simulation. For a quasi-static plant its member quasi_static is set: no
 *       vibration model
 * Returns 0, or -1 with error filled and the simulation empty.
 */
int simulate_open(simulation *simulation, analysis *nominal, char *error);
void simulate_close(simulation *simulation);

/*
 * Prepare the influence matrix of an analysis for the controller of its scene: where the scene asks
 * for it, replace the matrix of the undeformed structure by that at the optimal voltages. Returns
 * 0, or -1 with error filled.
 */
int simulate_tables(analysis *nominal, char *error);

/*
 * Replace the controller by the firmware of a board: build it now, and run it in QEMU during
 * simulate_run. A twin, the same C code and precision on this computer, computes every tick too and
 * is compared bit by bit. Returns 0, or -1 with error filled.
 */
int simulate_device(simulation *simulation, const device_board *board, char *error);

/*
 * Run all ticks of the simulation under one control law.
 *   callback in  function called after each tick; may be NULL
 *   context  in  pointer passed on to the callback
 * Returns 0, or -1 with error filled.
 */
int simulate_run(simulation *simulation, simulate_law law, simulate_tick_callback *callback,
                 void *context, char *error);

/*
 * Compute for each phase of the simulation (time between events of the scene) the best shape that
 * the voltages could reach. The phases must have been simulated before. Returns 0, or -1 with error
 * filled.
 */
int simulate_optima(simulation *simulation, char *error);

/*
 * Return the relative shape error at the end of the simulation of the controller, divided by the
 * largest error that any phase would have without voltages or at its optimum (at least 1: the norm
 * of the target). Voltages that obey a stable loop can double this error, when the target jumps; a
 * larger number is that of a loop that has diverged. simulate_optima must have run before.
 */
double simulate_divergence(simulation *simulation);

/*
 * Return the number of ticks of the simulation in which the controller ran, that is, which were not
 * missed.
 */
long simulate_ran(const simulate_count *count);

#endif
