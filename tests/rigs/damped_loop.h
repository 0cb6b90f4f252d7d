/*
 * A modal structure in double, the tables of a damped loop for it, and the loop closed around a
 * plant that differs from its model. For test programs of either precision.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef DAMPED_LOOP_H
#define DAMPED_LOOP_H

#include <stdbool.h>
#include "pzs.h"
#include "../../host_tools/model/damper_gains.h"

/* Modal model of a structure: modes scaled to an RMS shape of 1, the lowest frequency first. */
typedef struct modal_structure {
    size_t modes, outputs, inputs;
    double *omega;     /* [modes] angular frequencies (rad/s) */
    double *ratio;     /* [modes] damping ratios */
    double *shape;     /* [outputs][modes] displacement of each output per modal coordinate */
    double *modal;     /* [modes][inputs] static modal coordinate per volt */
    double *load;      /* [modes] static modal coordinate under the load */
    double *influence; /* [outputs][inputs] static shape per volt, of the modes and of the neglected
                          modes */
    double *load_shape; /* [outputs] static shape under the load */
    double *goal;       /* [outputs] target shape */
    double limit;       /* voltage limits are -limit and limit */
    double bandwidth;   /* corner frequency of the first-order lag of the amplifiers (Hz), of which
                           the damper knows where it is longer than a tick; 0: no lag */
} modal_structure;

/* Allocate a structure with all arrays zero. */
void structure_open(modal_structure *structure, size_t modes, size_t outputs, size_t inputs);
void structure_close(modal_structure *structure);

/*
 * Scale the modes to an RMS shape of 1, and the influence matrix so that the target is about as
 * large as the voltage limits allow. The product of shape and modal stays the same.
 */
void structure_scale(modal_structure *structure);

/* The plate of the demonstration scene, with `modes` modes and a damping ratio of 0.005. */
void structure_of_plate(modal_structure *structure, size_t modes);

/*
 * Simply supported plate of size length times 1, with columns x rows of patches and a grid of
 * points as outputs.
 */
typedef struct supported_plate {
    double length, first; /* length of the plate, and first natural frequency (Hz) */
    size_t modes, columns, rows, points_x, points_y;
    double ratio;
} supported_plate;
void structure_of_supported_plate(modal_structure *structure, const supported_plate *plate);

/* Differences between the plant and its model. */
typedef struct plant_error {
    double gain;      /* factor of all static responses */
    double frequency; /* factor of all frequencies */
    double ratio;     /* factor of all damping ratios */
    int delay;        /* true age of the readings (ticks) */
    double play;      /* half width of the play of every electrode, relative to the limit */
    double cubic;     /* relative increase of the static response at the limit, proportional to the
                         square of the voltage */
    double noise;     /* noise of the readings, relative to the largest entry of the target */
} plant_error;

#define EXACT_PLANT ((plant_error){.gain = 1, .frequency = 1, .ratio = 1})

typedef struct damped_loop {
    const modal_structure *structure;
    double interval;
    size_t modes, sensors; /* numbers of observed modes and of sensors */
    const size_t *sensor; /* [sensors] indices of the outputs that are sensors; NULL: all outputs */
    damper_settings settings;
    damper_gains gains; /* gains of the damper in double */
    double *memory;     /* memory of the gains and of the damper's model */
    pzs_real *tables;   /* memory of all tables */
    pzs_problem problem;
    pzs_vibration vibration;
    pzs_block block[6];
    pzs_loop loop;
    void *work;
    plant_error error;
    double load;                 /* factor of the load on the plant */
    double *position, *velocity; /* [modes of the structure] state of the plant */
    double *deviation;           /* [modes of the structure] distance from static equilibrium */
    double *turn;                /* [modes of the structure][4] propagators of the plant */
    pzs_block law;    /* control law in place of the control step; type NULL: the control step */
    bool is_undamped; /* the loop has no vibration damper */
    pzs_reading_delay lateness; /* correction of late readings of a loop without a damper */
    double *output;             /* [inputs] output voltages of the amplifiers (V) */
    double slower; /* part by which their corner frequency is lower than that of the structure */
    double *voltage, *played, *shape, *history;
    pzs_real *wanted, *sensed;
    int tick;
    unsigned seed;
    pzs_governor governor;       /* the loop has a governor if its member part is above 0 */
    pzs_amplifier amplifier;     /* the loop has converter steps if the member step is above 0 */
    pzs_supervision supervision; /* the loop has a supervisor if its member alarm_ticks is above 0
                                  */
    bool is_silent;              /* no readings arrive */
    bool is_blind;               /* all readings are missing */
    bool is_held;                /* damped_loop_tick does not move the plant */
    int stuck_input;             /* index of the electrode whose voltage stays; -1: none */
    int bad_sensor;              /* index of the sensor that reads bad_value; -1: none */
    double bad_value;
    double quantum;       /* step of the sensors' converters, relative to the largest entry of the
                             target; 0: none */
    size_t stuck_sensors; /* number of sensors, from the first on, whose readings stay */
    bool is_stuck_noisy;  /* their readings stay but for the noise */
    double *read;         /* [outputs] readings of the last tick without noise */
    double sensor_gain, sensor_offset; /* readings = gain * displacement + offset * largest entry of
                                          the target */
} damped_loop;

/*
 * Make the tables and the loop for a structure in static equilibrium.
 *   interval         in  time between ticks (s)
 *   step_limit       in  largest change of a voltage in one tick (V)
 *   delay            in  age of the readings for which the damper is designed (ticks)
 *   sensor [sensors] in  indices of the outputs that are sensors; NULL: all outputs
 */
void damped_loop_open(damped_loop *loop, const modal_structure *structure, double interval,
                      double step_limit, int delay, const size_t *sensor, size_t sensors,
                      const damper_settings *settings);
void damped_loop_close(damped_loop *loop);

/*
 * Put another control law in the place of the control step. All outputs are sensors.
 *   law          in  block of the phase PZS_PHASE_STEP that needs no more memory than
 *       pzs_step_block; its tables must outlive the loop
 *   is_observed  in  whether the loop keeps its vibration damper, whose estimates the law may read
 *   is_corrected in  whether a loop without damper has a correction of late readings
 */
void damped_loop_replace(damped_loop *loop, const pzs_block *law, bool is_observed,
                         bool is_corrected);

/*
 * Give the loop a supervisor, from the next reset on, with the settings that `pzs tables` gives a
 * scene with this target: it tolerates sudden loads of 0.3 times the target and noise of 0.005
 * times, and its alarm takes a period of the first mode. After 100 ticks without readings, or an
 * alarm, it parks the voltages at 0.
 */
void damped_loop_supervise(damped_loop *loop);

/* Return plant and loop to static equilibrium, with other differences between plant and model. */
void damped_loop_reset(damped_loop *loop, plant_error error);

/*
 * Run one tick: readings, controller, plant. Asserts that every voltage is inside its voltage limit
 * and step limit to the last bit. Returns the status of the tick.
 *   wanted [outputs] in  target shape (m)
 */
pzs_status damped_loop_tick(damped_loop *loop, const double *wanted);

/*
 * Move the plant alone under the present voltages, keep its shape as a reading, and count the tick.
 */
void damped_loop_move_plant(damped_loop *loop);
void damped_loop_keep(damped_loop *loop);

/*
 * Shape of the optimal voltages within the limits, for the plant and a target, computed in double.
 *   shape [outputs] out  shape (m)
 */
void damped_loop_optimum(const damped_loop *loop, const double *wanted, double *shape);

/* Distance between the shape of the plant and a given shape, relative to the norm of the target. */
double damped_loop_distance(const damped_loop *loop, const double *shape);

#endif
