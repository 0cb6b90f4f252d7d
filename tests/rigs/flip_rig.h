/*
 * A control loop whose working memory is damaged by flipped bits, closed around a plant that
 * responds more weakly than the tables say. For test programs of either precision.
 *
 * A flip is harmless if the loop ends where a loop without the flip ends.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef FLIP_RIG_H
#define FLIP_RIG_H

#include "damage_block.h"
#include "pzs.h"

/* Tables of the loop, and the plant that follows from them. */
typedef struct flip_plant {
    const pzs_problem *problem;
    const pzs_real *target;         /* [outputs] (m) */
    const pzs_vibration *vibration; /* modes of a plant that vibrates; NULL: it follows its voltages
                                       at once */
    const pzs_real *load; /* [outputs] shape under a known load, which acts while the target is not
                             negative (m); NULL: there is none */
    size_t first_sensor;  /* the readings are the outputs from this one on */
    size_t dead_inputs;   /* number of electrodes, from the first on, that have no effect */
    size_t bad_sensors;   /* number of sensors, from the first on, whose readings are half of the
                             largest target too high from tick FLIP_BAD on */
    double push;          /* shape under an unknown load, as a multiple of the target */
    double push_ticks;    /* ticks in which the load grows to that */
    bool is_reversed;     /* whether the amplifiers have the wrong polarity */
} flip_plant;

enum {
    FLIP_BAD = 20,
    FLIP_AIMS = 4 /* largest number of parts of the memory that are hit more often */
};

/* Part of the working memory. */
typedef struct flip_region {
    void *memory;
    size_t bytes;
} flip_region;

typedef struct flip_rig {
    const flip_plant *plant;
    flip_damage damage;
    pzs_block block[PZS_BLOCK_LIMIT];
    size_t count;
    pzs_loop loop;
    void *work;
    size_t bytes;
    pzs_real *given;             /* [inputs] what the amplifiers received last (V) */
    double *position, *velocity; /* [modes] (m); velocities divided by the angular frequency */
    double *deviation;           /* [modes] positions minus those in static equilibrium (m) */
    double *history;             /* [PZS_DELAY_LIMIT + 1][outputs] shapes of the last ticks (m) */
    size_t tick;
    pzs_real known;     /* value of the known load */
    pzs_real *readings; /* [outputs] */
    pzs_real *wanted;   /* [outputs] (m) */
    uint64_t seed;
    flip_region aim[FLIP_AIMS]; /* parts of the memory that half of the flips hit */
    size_t aims;
} flip_rig;

/*
 * Open a loop with these blocks. In a quarter of the flips a block behind the control step damages
 * the memory of the controller.
 */
void flip_rig_open(flip_rig *rig, const flip_plant *plant, const pzs_block *blocks, size_t count);
void flip_rig_close(flip_rig *rig);

/*
 * Let half of the flips hit the first `bytes` of a block's memory, or one of those of earlier
 * calls.
 */
void flip_rig_aim(flip_rig *rig, const pzs_block_type *type, size_t bytes);

/* Begin with the plant in static equilibrium and the first tick before control begins. */
void flip_rig_begin(flip_rig *rig);

/* Start the loop anew from the voltages that the amplifiers give. */
void flip_rig_restart(flip_rig *rig);

/* Random 64-bit number. */
uint64_t flip_rig_draw(flip_rig *rig);

/* Flip a random bit of the loop or its workspace, now or inside the next tick. */
void flip_rig_damage(flip_rig *rig);

/* One tick with the target times `factor`. */
pzs_status flip_rig_tick(flip_rig *rig, pzs_real factor);

/*
 * Take the voltages as an amplifier does, and move the plant. Returns how many voltages are not
 * finite, beyond their limits or beyond their step limit; a held input may go to its held voltage.
 */
int flip_rig_take(flip_rig *rig);

/*
 * Difference of the shapes that two sets of voltages make, relative to the target. Dead electrodes
 * make none.
 */
double flip_rig_difference(const flip_plant *plant, const pzs_real *one, const pzs_real *other);

/* ---- laws ------------------------------------------------------------------ */

/* What a sweep of flips has found. */
typedef struct flip_count {
    long flips, beyond, errors, told, silent;
    long lost;      /* windows after which other electrodes are held as faulty for good, and the
                       loop runs as without damage */
    long latest;    /* most ticks after a window until the same electrodes are held as faulty */
    double largest; /* largest difference of the shape on the way, without a status that tells of it
                     */
    double last;    /* the same at the end of the windows */
} flip_count;

/*
 * Law: after each flip, two ticks whose voltages are finite and inside limits and step limits.
 *   wave     in  factor of the target in a tick
 *   renewed  in  flips after which the loop starts anew; 0: only after an error
 */
flip_count flip_rig_limits(flip_rig *rig, long flips, pzs_real (*wave)(long tick), long renewed);

/* Windows in which flips are followed. */
typedef struct flip_window {
    long first;  /* first tick in which a bit may flip */
    long moving; /* first tick after those in which a bit may flip; the target moves in twice as
                    many ticks */
    long ticks;  /* length of a window */
    pzs_real (*wave)(long tick); /* factor of the target in a tick */
} flip_window;

/* Factor of the target in a tick of a window. */
pzs_real flip_rig_factor(const flip_window *window, long tick);

/*
 * Law: in the states that a window passes through, each flip leaves the voltages of the next three
 * ticks finite and inside limits and step limits. After each flip the state of loop and plant is
 * that before the flip again.
 */
flip_count flip_rig_states(flip_rig *rig, long flips, const flip_window *window);

/* What a loop without damage does in the ticks of a window. */
typedef struct flip_run {
    pzs_status *status; /* [ticks] */
    pzs_real *given;    /* [ticks][inputs] (V) */
    bool *held;         /* [inputs] electrodes that are held as faulty at the end */
} flip_run;
flip_run flip_rig_run(flip_rig *rig, const flip_window *window);
void flip_run_close(const flip_run *run);

/*
 * Law: a loop with a flipped bit ends where a loop without one ends, within a thousandth of the
 * target, or its status in some tick is another one. `silent` counts the other flips.
 */
flip_count flip_rig_harmless(flip_rig *rig, long flips, const flip_window *window);

#endif
