/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * One closed loop of a simulation, run tick by tick: schedule of events, sensors, controller,
 * amplifiers, electrodes.
 */
#ifndef SIMULATE_LOOP_H
#define SIMULATE_LOOP_H

#include "imperfections_scene.h"
#include "laws.h"
#include "simulation.h"

/*
 * Sinusoidal part of a load factor, the factor by which a load of the scene is multiplied over
 * time.
 */
typedef struct wave {
    double amplitude, frequency; /* amplitude of the sinusoidal part of a load factor
                                    (dimensionless), and its frequency (Hz) */
    double start; /* time at which the sinusoidal part of a load is 0 and rising (s) */
    int until;    /* number of the tick at which the sinusoidal part of the load ends */
} wave;

/*
 * Temporary disturbance of the control ticks.
 *   size   late voltages or varying intervals: largest deviation as a fraction of the tick
 *       interval; late readings: additional age (ticks)
 *   until  number of the tick at which the disturbance ends
 */
typedef struct disturbance {
    double size;
    int until;
} disturbance;

/*
 * Tables of the block (stage of the control tick) with which the simulation replaces the library's
 * step block, which computes the voltages. The problem must be the first member: the library keeps
 * a pointer to it, which loop_of converts to the whole structure.
 */
typedef struct law_tables {
    pzs_problem problem;
    struct loop *loop;
} law_tables;

typedef struct loop {
    const design *design; /* numerical model of the scene's structure, from which the controller is
                             made; the simulated plant may differ from it */
    simulation *simulation;
    simulate_law law;
    bool is_damped;   /* true: the controller has a stage that damps vibration */
    int missed_ticks; /* number of ticks missed since the last tick in which the controller ran */
    pzs_block block[PZS_BLOCK_LIMIT]; /* blocks (stages) of the control law, run in this order in
                                         each tick */
    law_tables tables; /* tables of the stage of the control tick with which the simulation computes
                          voltages in place of the library's optimiser; unused where the library
                          computes them */
    law compared; /* tables of the stage of the control tick that computes the voltages by a control
                     law for comparison with the library's controller */
    pzs_loop controller; /* the library's control loop, in double precision */
    device board, twin;  /* where a board runs the controller: its firmware, and its twin, which is
                            the firmware's C code as a program on this computer. Both replace the
                            step block of the library (the stage of a tick that computes the
                            voltages) */
    char *message;       /* [SCENE_ERROR] text of the error message where the board that runs the
                            controller's firmware does not answer */
    bool is_silent; /* whether the board that runs the firmware failed to answer in the last tick */
    uint64_t random; /* state of the random number generator of the simulated loop */
    int next_event, missed_until;
    double factor, scheduled_factor; /* factor by which the target is multiplied (dimensionless):
                                        present value, and value that the scene's schedule alone
                                        would give, without random events */
    double *memory; /* one allocation that holds the arrays of this struct from `goal` to
                       `last_voltage` */
    double *goal; /* [targets] wanted displacements of the scene's target or of the last event that
                     replaces it, before multiplication by the factor that other events give to the
                     target */
    double *wanted; /* [targets] wanted displacements: those of the scene's target or of the last
                       event that replaces it, multiplied by the factor that other events give to
                       the target */
    double *load, *scheduled_load; /* [loads + 1] factors of the loads; the last entry is a
                                      temperature change (K). load: present values. scheduled_load:
                                      values that result from the events of the scene file alone,
                                      without random events; they are restored when random events
                                      end. */
    double *shape; /* [targets] present displacements of the target nodes of the simulated structure
                    */
    double *scratch; /* [targets] work array for displacements of the target nodes */
    double *command; /* [amplifiers] voltages that the controller commands (V) */
    double *output;  /* [amplifiers] output voltages of the amplifiers (V) */
    double *effect;  /* [amplifiers] voltages that act on the ceramic, after faults and hysteresis
                        (V) */
    double *previous_output; /* [amplifiers] output voltages of the amplifiers before the last
                                change (V) */
    double time;             /* time since the start of the simulation (s) */
    wave *wave; /* [loads] sinusoidal part of the factor by which each load is multiplied:
                   amplitude, frequency, start and end */
    disturbance late, jitter, delay; /* temporary disturbances: late: voltages are set later than
                                        the tick (fraction of the tick interval); jitter: the
                                        interval between ticks varies (fraction of the tick
                                        interval); delay: readings arrive later (ticks) */
    double vibration; /* weighted norm of the deviation of the shape from the static equilibrium,
                         relative to the weighted norm of the scene's target; 0 for a quasi-static
                         plant */
    double *twin_command, *last_voltage; /* [amplifiers] twin_command: voltages (V) that the
                                            firmware's C code computes on this computer, for
                                            comparison with those of the board. last_voltage:
                                            voltages (V) before the present tick, from which their
                                            changes are checked against the step limits */
    electrode *electrode; /* [amplifiers] state of the electrode of each amplifier: faults, outputs
                             of amplifier lag, hysteresis and creep */
    int sensors;    /* number of sensors: one for each target, or those of the scene's `estimate`
                       section */
    sensor *sensor; /* [sensors] state of each sensor: its faults and its drift */
    double *sense_memory; /* one allocation that holds the arrays of this struct from `noise` to
                             `next_load` */
    double *noise;   /* [sensors] standard deviation of the noise of each sensor, in the unit of its
                        reading */
    double *reading; /* [sensors] latest reading of each sensor, with noise and faults */
    double *sensed;  /* [sensors] readings passed to the controller, delayed as the scene and its
                        events state */
    bool has_failed_sensors; /* true: the sensor failures of tick 0 in the scene file have already
                                begun, before the self-test */
    int history_ticks;       /* number of ticks whose readings are stored: the delay, plus
                                the largest additional delay of an event, plus 1 */
    double *late_reading; /* [history_ticks][sensors] noise-free readings of the last ticks, which
                             the controller receives later */
    double *late_load;    /* [history_ticks][loads] load factors known to the controller in the last
                             ticks */
    double *known_load, *next_load; /* [loads] load factors known to the controller, of the present
                                       tick and of the next one */
    const double *load_when_read;   /* [loads] load factors known to the controller for the time at
                                       which the readings were taken */
    double measurement_error;    /* weighted norm of the difference between true and measured shape,
                                    relative to the weighted norm of the scene's target */
    uint8_t *state, *twin_state; /* [amplifiers] state of each electrode as the fault detector sees
                                    it: that of the loop, and that of the board's twin (the
                                    firmware's C code on this computer) */
    void *controller_memory;     /* workspace of the library's control loop */
    double error; /* relative shape error at the start of the last tick: weighted norm of (shape
                     minus wanted shape) divided by the weighted norm of the scene's target */
    pzs_status status; /* status that the controller returned in the last tick */
    int iterations;
    bool twin_agrees; /* true: the board and its twin (the firmware's C code on this computer) gave
                         bit-identical results in the last tick */
    int detected, falsely_detected,
        detection_ticks; /* number of electrodes that the fault detector reported in the last tick;
                            number of reported electrodes without a fault; longest time from a fault
                            to its detection (ticks) */
    bool is_missed;      /* whether the last tick was missed */
    int beyond_limits, not_finite; /* for the last tick: number of voltages or steps beyond their
                                      limits; number of voltages that are not finite */
    int beyond_rows; /* number of limits on differences or sums of voltages that were violated in
                        the last tick. A limit counts once if the commanded voltages violate it, and
                        once more if the output voltages do */
} loop;

/*
 * Open a loop with the plant at rest and with the initial voltages of the controller. Returns 0, or
 * -1 with error filled; call loop_close in either case.
 */
int loop_open(loop *loop, simulation *simulation, simulate_law law, char *error);
void loop_close(loop *loop);

/*
 * Run the self-test of amplifiers, cables and sensors, where the scene has one, before the first
 * tick. Electrodes that an event of the scene file makes dead or stuck at tick 0 are so during the
 * self-test already. Returns 0, or -1 with error filled where the test has findings.
 */
int loop_selftest(loop *loop, char *error);

/*
 * Run one tick of the simulated control loop. Returns 0, or -1 with error filled where the
 * simulated structure has no equilibrium, the controller returns an error, or a board with the
 * controller's firmware does not answer.
 */
int loop_tick(loop *loop, int tick, char *error);

/*
 * Return how many limits on a difference or sum of voltages are violated by more than rounding
 * errors. A limit does not count if one of its amplifiers is held at a fixed voltage.
 *   voltage [amplifiers] in  voltages
 *   bits                 in  32 or 64: precision in which the voltages were computed
 */
int loop_beyond_rows(const loop *loop, const double *voltage, int bits);

/* Return the number of commanded voltages that are at one of their limits. */
int loop_active(const loop *loop);

/* ---- simulate_sense.c: inputs of the controller ------------------------- */

/*
 * Prepare the simulated sensors and their memory. Returns whether memory was available; call
 * sense_close in either case.
 */
int sense_open(loop *loop);
void sense_close(loop *loop);

/*
 * Take the readings of the plant in its present shape, with delay, noise and faults, and store them
 * in the array `sensed` of the loop. Returns 0, or -1 with error filled.
 */
int sense_tick(loop *loop, int tick, char *error);

/*
 * Compute the measurement error of the loop: the norm of the difference between the true shape and
 * the shape that the controller measures, relative to the norm of the scene's target.
 */
void sense_measurement_error(loop *loop);

/*
 * Return the load factors [loads] that the controller knows for the time at which the readings of a
 * tick were taken.
 */
const double *sense_known_loads(const loop *loop, int tick);

/*
 * Imperfections of amplifiers, cables, ceramic and sensors at the present time of the simulation,
 * with references to the electrodes, the sensors and the random number generator of the loop.
 */
imperfections loop_imperfections(loop *loop);

#endif
