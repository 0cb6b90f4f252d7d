/*
 * A modal structure in double, the tables of a damped loop for it, and the loop closed around a
 * plant that differs from its model. For test programs in either precision.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef DAMPED_LOOP_H
#define DAMPED_LOOP_H

#include <stdbool.h>
#include "pzs.h"
#include "../../host_tools/model/damper_gains.h"

/* Modes scaled to an RMS shape of 1, lowest first. */
typedef struct modal_structure {
    size_t modes, outputs, inputs;
    double *omega;      /* [modes] angular frequencies (rad/s) */
    double *ratio;      /* [modes] damping ratios */
    double *shape;      /* [outputs][modes] */
    double *modal;      /* [modes][inputs] static coordinate per volt */
    double *load;       /* [modes] static coordinate by the load */
    double *influence;  /* [outputs][inputs] static shape per volt, of all modes and of those left
                           out */
    double *load_shape; /* [outputs] static shape by the load */
    double *goal;       /* [outputs] a target */
    double limit;       /* voltages from -limit to limit */
} modal_structure;

/* All arrays zero. */
void structure_open(modal_structure *structure, size_t modes, size_t outputs, size_t inputs);
void structure_close(modal_structure *structure);

/* Scale modes to an RMS shape of 1, and the influence so that the goal is of the order of what the
 * limits reach: shapes and modal keep their product. */
void structure_scale(modal_structure *structure);

/* The plate of the demonstration with `modes` modes and damping ratio .005; from a scene. */
void structure_of_plate(modal_structure *structure, size_t modes);

/* Simply supported plate, length times 1, with columns x rows of patches and points for outputs. */
typedef struct supported_plate {
    double length, first; /* first natural frequency (Hz) */
    size_t modes, columns, rows, points_x, points_y;
    double ratio;
} supported_plate;
void structure_of_supported_plate(modal_structure *structure, const supported_plate *plate);

/* How the plant differs from the model. */
typedef struct plant_error {
    double gain;      /* factor of all static responses */
    double frequency; /* factor of all frequencies */
    double ratio;     /* factor of all damping ratios */
    int delay;        /* true age of the readings (ticks) */
    double play;      /* half width of a play in every electrode over the limit */
    double cubic;     /* part by which the static response grows at the limit, as the square */
    double noise;     /* of the readings, over the largest entry of the goal */
} plant_error;

#define EXACT_PLANT ((plant_error){.gain = 1, .frequency = 1, .ratio = 1})

typedef struct damped_loop {
    const modal_structure *structure;
    double interval;
    size_t modes, sensors; /* observed */
    const size_t *sensor;  /* [sensors] outputs that are sensors; NULL: all */
    damper_settings settings;
    damper_gains gains;                                      /* in double */
    double *memory;                                          /* of the gains and the model */
    double *angle, *ratio, *modal, *overlap, *lift, *square; /* as in damper_model */
    pzs_real *tables;                                        /* memory of all tables */
    pzs_problem problem;
    pzs_vibration vibration;
    pzs_block block[5];
    pzs_loop loop;
    void *work;
    plant_error error;
    double load;                 /* factor of the load */
    double *position, *velocity; /* [modes of the structure] state of the plant */
    double *voltage, *played, *shape, *reading, *history;
    pzs_real *wanted, *sensed;
    int tick;
    unsigned seed;
    pzs_governor governor;   /* with a part above 0 the loop has a governor */
    pzs_amplifier amplifier; /* with a step above 0 the loop has converter steps */
    bool is_silent;          /* no frame arrives */
    bool is_blind;           /* all readings are missing */
    bool is_held;            /* damped_loop_tick does not move the plant */
    int bad_sensor;          /* sensor that reads bad_value; -1: none */
    double bad_value;
} damped_loop;

/*
 * Tables and loop for a structure, at rest.
 *   interval  in  between ticks (s)
 *   slew      in  step limit (V)
 *   delay     in  age of the readings that the damper believes (ticks)
 *   sensor    in  [sensors] outputs that are sensors, or NULL
 */
void damped_loop_open(damped_loop *loop, const modal_structure *structure, double interval,
                      double slew, int delay, const size_t *sensor, size_t sensors,
                      const damper_settings *settings);
void damped_loop_close(damped_loop *loop);

/* Put plant and loop to rest, with another plant. */
void damped_loop_reset(damped_loop *loop, plant_error error);

/*
 * One tick: readings, controller, plant. Returns the status. Every voltage must be inside its limit
 * and its step limit, to the last bit. wanted [outputs] in
 */
pzs_status damped_loop_tick(damped_loop *loop, const double *wanted);

/* Plant alone under the present voltages; keep its shape as a reading and count the tick. */
void damped_loop_move_plant(damped_loop *loop);
void damped_loop_keep(damped_loop *loop);

/*
 * Shape of the bounded optimum of the plant for a target: coordinate descent in double.
 *   shape [outputs] out
 */
void damped_loop_optimum(const damped_loop *loop, const double *wanted, double *shape);

/* |shape of the plant - y| / |goal| */
double damped_loop_distance(const damped_loop *loop, const double *shape);

#endif
