/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Simulation of a closed loop on the host: the library's controller with the tables of the scene,
 * a plant that differs from the controller's model, sensors and amplifiers with faults, and the
 * schedule of the scene. The plant vibrates where the densities of the scene are known, and is
 * quasi-static otherwise or where the scene says so (plant.h). Each tick runs in this order:
 *
 *   time since the last tick, events, shape under the voltages of the previous tick, measurement,
 * controller, amplifiers
 *
 * The controller runs on the host, or as a firmware with the same tables on a board
 * (simulate_device). The same scene gives bit-identical results in every run. The same loop also
 * runs with two common alternatives to the controller, for comparison: unconstrained least squares
 * whose voltages are clipped to the voltage limits and the step limit, and the same with
 * regularisation. The regularisation parameter is the best one for the scene's target and limits
 * on the controller's own model.
 */
#ifndef SIMULATION_H
#define SIMULATION_H

#include "device.h"
#include "../model/damper.h"
#include "plant.h"

struct loop_blocks;

/*
 * LAW_CONTROLLER: the library's controller; LAW_CLAMP: clipped least squares; LAW_REGULARISED:
 * clipped regularised least squares.
 */
typedef enum simulate_law { LAW_CONTROLLER, LAW_CLAMP, LAW_REGULARISED, LAWS } simulate_law;

/* Results of one tick. */
typedef struct simulate_sample {
    simulate_law law;
    int tick;
    double error; /* relative shape error at the start of the tick: |W (shape - wanted)| / |W target
                     of the scene| */
    double measurement_error; /* relative measurement error: |W (shape - shape measured by the
                      controller)| / |W target of the scene| */
    double vibration; /* |W (shape - static equilibrium of the plant)| / |W target of the scene|; 0
                         for a quasi-static plant */
    const double *command;  /* [amplifiers] commanded voltages (V) */
    const double *voltage;  /* [amplifiers] output voltages of the amplifiers (V) */
    int active, iterations; /* number of commanded voltages at a limit; iterations of the optimiser
                             */
    pzs_status status;
    int is_missed; /* missed tick: the controller did not run */
} simulate_sample;

typedef void simulate_tick_callback(void *context, const simulate_sample *sample);

/* Results of one control law in one phase. */
typedef struct simulate_course {
    double steady; /* relative shape error: root mean square over the last ticks; infinite for a
                      law for comparison that has diverged */
    double worst;  /* largest relative shape error */
    double measurement_error; /* relative measurement error: root mean square over the last ticks */
    double vibration; /* relative deviation from the static equilibrium: root mean square over the
                         last ticks */
    double vibration_worst; /* largest relative deviation from the static equilibrium */
    int settled; /* ticks until the distance of the shape from its final value stays within 5 % of
                    the largest distance; -1: never */
    int step_limit_ticks; /* ticks that the step limit alone requires from the initial to the final
                             voltages */
    double *voltage;      /* [amplifiers] voltages at the end of the phase (V) */
    double *shape;        /* [targets] target displacements at the end */
    double *displacement; /* [dof] displacement vector of the plant at the end */
} simulate_course;

/* Phase of a simulation: the ticks from one tick with events to the next. */
typedef struct simulate_phase {
    int from, until;
    int first, events; /* first event of the scene that begins the phase, and number of these events
                        */
    double optimum;    /* relative shape error of the best shape that this plant reaches within the
                          stroke of its electrodes; NAN before simulate_optima */
    simulate_course course[LAWS];
    double *target;  /* [targets] wanted displacements at the end of the phase */
    double *load;    /* [loads + 1] load factors of the plant at the end; the last entry is the
                          temperature change (K) */
    double *lowest;  /* [amplifiers] voltages that act on the ceramic at the end, if all amplifiers
                        moved to their lower limits: their stroke with hysteresis and creep, or the
                        voltage of a faulty electrode (V) */
    double *highest; /* [amplifiers] voltages that act on the ceramic at the end, if all amplifiers
                        moved to their upper limits (V) */
} simulate_phase;

/* Sums over all ticks of one control law. */
typedef struct simulate_count {
    long beyond_limits; /* commanded or output voltages beyond a voltage limit or the step limit */
    long not_finite;    /* voltages that are not finite */
    long iterations;    /* iterations of the optimiser, in all ticks */
    int iterations_most;
    long status[PZS_W_OUTPUT + 1]; /* number of ticks with each status */
    long missed_ticks;
    long detected, falsely_detected; /* electrodes that the fault detector found; number of those
                                      * without a fault
                                      */
    int detection_ticks;             /* longest time from a fault to its detection (ticks) */
    long agreeing_ticks;             /* ticks in which the board and its twin gave the same bits */
    double seconds;
} simulate_count;

typedef struct simulation {
    const analysis *nominal;
    plant plant;
    const pzs_problem *problem; /* tables of the controller, made from the nominal design */
    struct loop_blocks *blocks; /* block list, the same as in a firmware of the scene */
    estimator estimator;  /* estimator gains and known loads; empty unless `estimates` or `feeds` is
                             set */
    damper damper;        /* tables of the damped tick; unused for a quasi-static plant */
    damper unused_damper; /* never used */
    struct loop_blocks *undamped_blocks; /* block list without a vibration block, for the other laws
                                          */
    int estimates, feeds, quantises; /* flags: the shape is estimated from few sensors; known loads
                                        are fed forward; the amplifiers have a resolution or a dead
                                        band */
    double reference; /* |W target of the scene|, the denominator of all relative errors */
    double compared_regularisation; /* regularisation of LAW_REGULARISED beside that of the scene
                                       (m2/V2) */
    double regularisation;     /* regularisation parameter of LAW_REGULARISED, over tr(B'W^2 B)/n */
    const device_board *board; /* board that runs the controller; NULL: the controller runs on the
                                  host */
    char folder[DEVICE_PATH];  /* folder of the firmware */
    int phases;
    simulate_phase *phase;
    simulate_count count[LAWS];
} simulation;

/*
 * Read the plant and set up the phases.
 *   nominal in  design of a scene with a simulate section, after analysis_influence; must outlive
 *       the simulation. Its option quasi_static leaves out the vibration model of the controller,
 *       and is set for a quasi-static plant
 * Returns 0, or -1 with error filled and the simulation empty.
 */
int simulate_open(simulation *simulation, analysis *nominal, char *error);
void simulate_close(simulation *simulation);

/*
 * Prepare the tables of an analysis for the controller of its scene. Where the scene asks for it,
 * replace the influence matrix by the linearised influence of all inputs at the nonlinear optimum
 * of the nominal model; otherwise do nothing. Returns 0, or -1 with error filled.
 */
int simulate_tables(analysis *nominal, char *error);

/*
 * Replace the controller by the firmware of a board: build the firmware now, and run it in QEMU
 * during simulate_run. A twin, the same C code in the same precision on this computer, computes the
 * same ticks, and the results are compared bit by bit. Returns 0, or -1 with error filled.
 */
int simulate_device(simulation *simulation, const device_board *board, char *error);

/* Run all ticks under a control law. watch may be NULL. Returns 0, or -1 with error filled. */
int simulate_run(simulation *simulation, simulate_law law, simulate_tick_callback *callback,
                 void *context, char *error);

/* Compute the optimum of each phase, after simulate_run. Returns 0, or -1 with error filled. */
int simulate_optima(simulation *simulation, char *error);

/* Number of ticks in which the control law ran. */
long simulate_ran(const simulate_count *count);

#endif
