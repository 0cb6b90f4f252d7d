/*
 * The control loop: a list of blocks around the control step, run by one call in each tick. The
 * blocks of the library: feed-forward of known loads, a shape estimator, the control step,
 * converter steps of the amplifiers, a fault detector for electrodes.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 *     static pzs_real work[MIRROR_LOOP_BYTES / sizeof(pzs_real) + 1];
 *     static pzs_loop loop;
 *
 *     int main(void)
 *     {
 *         pzs_status status =
 *             pzs_loop_init(&loop, mirror_blocks, MIRROR_BLOCKS, NULL, work, sizeof work);
 *         while (!PZS_IS_ERROR(status)) {
 *             read_target(wanted);    // [outputs] m
 *             read_sensors(readings); // [sensors]; NaN where a sensor gives nothing
 *             status = pzs_loop_tick(&loop, wanted, readings);
 *             write_amplifiers(loop.info.voltage); // [inputs] V, inside every limit, always
 *         }
 *     }
 *
 * `pzs tables` writes the list, mirror_blocks; an image links only the blocks of its list. The
 * options can also be called one by one around pzs_tick: pzs_feed_forward on the readings (present
 * loads) and on the target (coming loads), pzs_estimate_tick, pzs_tick, pzs_quantise,
 * pzs_fault_detector_tick. A list of the same blocks gives the same bits.
 */
#ifndef PZS_LOOP_H
#define PZS_LOOP_H

#include "pzs_control.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- the loop: a list of blocks (lib/control/loop.c) -------------------- */

/* Where in a tick a block acts. The blocks of a list are in the order of their phases. */
typedef enum pzs_block_phase {
    PZS_PHASE_READINGS, /* changes the readings or the target */
    PZS_PHASE_SHAPE,    /* computes the measured shape from the readings; at most one block */
    PZS_PHASE_STEP,    /* chooses the voltages; exactly one block, whose tables are a pzs_problem */
    PZS_PHASE_VOLTAGE, /* changes the voltages as the amplifiers will */
    PZS_PHASE_OBSERVE, /* compares voltages and shape; may hold electrodes */
    PZS_PHASE_SUPERVISE /* runs in every tick, also after an error; has the last word on voltages
                           and status; at most one block */
} pzs_block_phase;

/*
 * The signals that the blocks pass on in one tick. All arrays are read-only: a block that changes a
 * signal lets its pointer point to an array of its own.
 */
typedef struct pzs_loop_signals {
    pzs_control *control;      /* the controller; NULL until the step block is initialised */
    const pzs_real *influence; /* [outputs][inputs] as passed to pzs_loop_init, for the init of the
                                  step block, or NULL */
    const pzs_real *wanted;    /* [outputs] target shape (m) */
    const pzs_real *readings; /* [sensors] readings (unit of each sensor), or NULL: no frame in this
                                 tick */
    const pzs_real *measured; /* [outputs] measured shape (m), or NULL: no frame in this tick; equal
                                 to the readings until a block of PZS_PHASE_SHAPE has run */
    const pzs_real *known_now; /* [loads] values of the known loads when the readings were taken (1:
                                  as in the scene), or NULL: no load is known */
    const pzs_real *known_next; /* [loads] values of the known loads under the next voltages, or
                                   NULL */
    const uint8_t *electrode;   /* [inputs] pzs_electrode_state, or NULL: no block has set it */
    const void *tables;         /* tables of the block that runs, from the list */
    const pzs_real *given;      /* [inputs] voltages that the last tick has given out (V) */
    pzs_real deviation;         /* RMS amplitude by which the structure deviates from what the model
                                   predicts         (m); negative: no block has set it */
    uint32_t warnings;          /* bit 1 << status for each warning of a block in this tick */
    pzs_status status;          /* status of the tick so far, for PZS_PHASE_SUPERVISE */
    uint16_t sensors; /* number of readings that the blocks after this one need, which is the length
                         of `readings` */
    int32_t where;    /* out: index of the input, output or reading that the status of the block is
                         about, or -1 */
} pzs_loop_signals;

/* A type of block: const, in flash. Its functions return a status like every public function. */
typedef struct pzs_block_type {
    const char *name; /* name of the block in messages */
    pzs_block_phase phase;
    /* Bytes of memory of a block, from the counts of its tables and of the problem alone. */
    size_t (*block_bytes)(const void *tables, const pzs_problem *problem);
    /*
     * Check the tables and lay out the block in `self`: block_bytes of memory, aligned for pointers
     * and double. The step block is initialised first, then the others from the last to the first.
     */
    pzs_status (*block_init)(void *self, const void *tables, pzs_loop_signals *signals);
    /* Run the block in one tick. An error ends the tick. */
    pzs_status (*block_tick)(void *self, pzs_loop_signals *signals);
} pzs_block_type;

/* One block of a list. */
typedef struct pzs_block {
    const pzs_block_type *type;
    const void *tables; /* tables of this block type; not NULL */
} pzs_block;

#define PZS_BLOCK_LIMIT 16 /* most blocks in a list */

/* Results of the loop that a program may read. */
typedef struct pzs_loop_info {
    /*
     * [inputs] the voltages to give out (V): the frame that the last tick without an error has
     * published, finite and inside the limits. Two frames take turns, so a frame stays as it is
     * during the next tick. See pzs_loop_voltages for interrupts.
     */
    const pzs_real *volatile voltage;
    volatile uint32_t frames; /* number of frames published so far */
    const pzs_real *measured; /* [outputs] measured shape that the last tick used (m), or NULL: none
                               */
    const uint8_t *electrode; /* [inputs] pzs_electrode_state after the last tick, or NULL: no fault
                                 detector */
    pzs_control *control; /* the controller, for pzs_hold, pzs_release, pzs_assess and its info */
    const pzs_block_type *block; /* block whose status was returned last, or NULL: no block */
    int32_t where; /* index that belongs to the last status, or -1; if the list itself is refused,
                      index of the block in the list */
} pzs_loop_info;

typedef struct pzs_loop {
    pzs_loop_info info;
    pzs_loop_state state;
} pzs_loop;

/*
 * Bytes of workspace of a list: the sum of PZS_LOOP_BYTES and the PZS_..._BLOCK_BYTES of each
 * block.
 */
#define PZS_ALIGNED(bytes) (((size_t)(bytes) + 7u) / 8u * 8u)
#define PZS_LOOP_BYTES(blocks, inputs)                                                             \
    (8u + 0u * (size_t)(blocks) + PZS_ALIGNED(5u * (size_t)(inputs) * sizeof(pzs_real)))

/*
 * Check a list of blocks and their tables, and lay the loop out in the workspace.
 *   blocks [count]              in  in the order of their phases, none twice; they and their tables
 *                                   must outlive the loop
 *   influence [outputs][inputs] in  computed on the device (m/V); NULL: that of the problem
 *   work                        in  memory of the caller, aligned for pzs_real, used by the loop
 *                                   from now on
 * Errors (info.block is the block): ARGUMENT (no or too many blocks, no step block, a block twice,
 * a block without tables, tables of other counts), STAGE (a block stands before one of an earlier
 * phase), WORKSPACE (where = bytes needed), FORMAT (also tables of another scene), and those of the
 * block. After an error the loop cannot be used, even if it was valid before.
 */
pzs_status pzs_loop_init(pzs_loop *loop, const pzs_block *blocks, size_t count,
                         const pzs_real *influence, void *work, size_t bytes);

/*
 * Start from the voltages that the amplifiers already give, clamped to the limits, so that no
 * voltage jumps after a reset. The other blocks are initialised again; electrodes that were held
 * must be held again.
 *   voltage [inputs] in (V)
 * Errors: ARGUMENT, STAGE, NONFINITE (nothing is changed).
 */
pzs_status pzs_loop_start(pzs_loop *loop, const pzs_real *voltage);

/*
 * Values of the known loads in the coming ticks: when the readings were taken, and under the next
 * voltages. NULL, as after pzs_loop_init: no load is known.
 *   now, next [loads] in  read in each tick, until another call; they belong to the caller
 * Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_loop_know(pzs_loop *loop, const pzs_real *now, const pzs_real *next);

/*
 * One control tick: all blocks in the order of their list, then the last gate.
 *   wanted   [outputs] in  target shape (m)
 *   readings [sensors] in  readings of the estimator's sensors; without an estimator the measured
 *                          shape [outputs] (m). NaN where a sensor gives nothing; NULL: no frame
 *                          arrived, the last deviations from the model are kept.
 * Precedence of the status: an error ends the tick, and later blocks do not run. Otherwise the
 * warning of the step block, otherwise the first warning in the order of the list. info.block is
 * the block of the status. After an error info.voltage and the controller keep the voltages of the
 * last tick. After HELD of the step block they keep them inside the limits in force. After HELD of
 * the estimator (no usable reading) the last deviations are kept, and the step still follows the
 * target.
 *
 * The last gate compares each voltage with the limits in flash and with the voltages given in the
 * last tick. One beyond voltage limits or step limit is cut, one that is not finite is replaced by
 * the last one (warning OUTPUT, which takes precedence over other warnings): working memory was
 * damaged. A tick starts by deriving pointers, counts and limits again from the list of blocks,
 * three copies of which two outvote a damaged third; it compares a row of the Hessian with its
 * source, all of it in `inputs` ticks, and 64 bytes of the problem with its checksum, all of it in
 * bytes / 64 ticks. Error CRC: the tables of the problem are damaged, found after at most three
 * such rounds, or at once in the limits. Damage of the loop therefore never reaches the amplifiers
 * beyond limits and step limits, except between the tick and the moment at which a frame is read.
 */
pzs_status pzs_loop_tick(pzs_loop *loop, const pzs_real *wanted, const pzs_real *readings);

/*
 * Copy the frame published last, for a part of the program that does not wait for the tick: an
 * interrupt that feeds converters, or a task of lower priority.
 *   voltage [inputs] out (V)
 * The frame is whole: the tick fills the other one and then moves info.voltage and info.frames,
 * which are volatile, as are its writes to a frame. On a processor that reorders writes, or with a
 * DMA, put the barrier of the processor behind the tick. Warning: HELD (ticks kept interrupting the
 * copy: `voltage` is to be ignored). Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_loop_voltages(const pzs_loop *loop, pzs_real *voltage);

/*
 * The memory of the block of one type in the list: for the blocks of the library the object named
 * at each of them below. Returns NULL if the list has no such block or the loop is not initialised.
 */
void *pzs_loop_find(const pzs_loop *loop, const pzs_block_type *type);

/* The control step, pzs_tick (lib/control/step.c). Tables: pzs_problem. Object: pzs_control. */
extern const pzs_block_type pzs_step_block;
#define PZS_STEP_BLOCK_BYTES(inputs, outputs)                                                      \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_control)) + PZS_CONTROL_BYTES(inputs, outputs))

/* ---- estimator: the shape from a few sensors (lib/control/estimate.c) -- */

/*
 * Gains of the estimator, computed by the host from the expected disturbances. All arrays are
 * const, in flash.
 */
typedef struct pzs_estimator {
    uint32_t format, scene; /* format and scene of the problem */
    uint32_t crc;           /* checksum of everything below; see pzs_estimator_seal */
    uint16_t inputs, outputs, sensors;
    const pzs_real *direct; /* S [sensors][inputs] reading per volt (V/V, C/V, m/V) */
    const pzs_real *gain; /* G [outputs][sensors] shape per deviation of a reading (m/V, m/C, 1) */
} pzs_estimator;

/* Set format and checksum of tables that a firmware has built itself. Errors: ARGUMENT. */
pzs_status pzs_estimator_seal(pzs_estimator *tables);

typedef struct pzs_estimate_info {
    int32_t where; /* index that belongs to the last status, or -1 */
} pzs_estimate_info;

typedef struct pzs_estimate {
    pzs_estimate_info info;
    pzs_estimate_state state;
} pzs_estimate;

/* Bytes of workspace for an estimate. */
#define PZS_ESTIMATE_BYTES(sensors)                                                                \
    (sizeof(pzs_real) * 3u * (((size_t)(sensors) + 3u) / 4u * 4u) + (size_t)(sensors))

/*
 * Lay out an estimate in the workspace; control and tables must outlive it.
 * Errors: ARGUMENT (also tables of other counts), STAGE, FORMAT, CRC, NONFINITE, WORKSPACE (where =
 * bytes needed).
 */
pzs_status pzs_estimate_init(pzs_estimate *estimate, pzs_control *control,
                             const pzs_estimator *tables, void *work, size_t bytes);

/*
 * Before each pzs_tick: estimate the shape from the readings under the present voltages, B v + G (s
 * - S v). The shape is then passed to pzs_tick as the measurement.
 *   sensed [sensors] in  readings s
 *   shape  [outputs] out (m)
 * A reading that is missing (not finite) or stuck keeps its last deviation. Warnings: SENSOR, HELD
 * (no reading is usable). Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_estimate_tick(pzs_estimate *estimate, const pzs_real *sensed, pzs_real *shape);

/* The estimator as a block of PZS_PHASE_SHAPE. Tables: pzs_estimator. Object: pzs_estimate. */
extern const pzs_block_type pzs_estimator_block;
#define PZS_ESTIMATOR_BLOCK_BYTES(sensors, outputs)                                                \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_estimate)) + PZS_ALIGNED(PZS_ESTIMATE_BYTES(sensors)) +     \
                (size_t)(outputs) * sizeof(pzs_real))

/* ---- supervisor (lib/control/supervisor.c) -------------------------------- */

/*
 * Decides in each tick whether the loop is in control. Where it is not, the supervisor sets the
 * voltages: it keeps them at the park voltages, or ramps them there along a straight line inside
 * limits and step limits.
 *
 *     pzs_loop_init
 *     INITIALISE --ARM--> ARMED --whole frame, parked--> RUNNING <--frame, none--> HOLDING
 *     RUNNING, HOLDING --PARK, FLAT--> PARKING --arrived--> PARKED --RESUME--> ARMED
 *     any --STOP, alarm, time-out, error of a block--> STOPPING --arrived--> LATCHED
 *
 * The status tells the program what to do. In control: that of the other blocks. PARKED (a
 * warning): the output is parked by command. RAMP (a warning): control is lost and the output is on
 * its way to the park voltages; keep calling pzs_loop_tick. LATCHED (an error): the park voltages
 * have been published; the loop is over. So a program that ticks as long as the status is no error,
 * and writes info.voltage to the amplifiers after each tick, ends with parked amplifiers after at
 * most pzs_supervisor_longest_ramp ticks:
 *
 *     while (!PZS_IS_ERROR(status)) {
 *         read_target(wanted);
 *         read_sensors(readings);
 *         status = pzs_loop_tick(&loop, wanted, readings);
 *         write_amplifiers(loop.info.voltage);
 *     }
 *
 * Without a supervisor in the list an error of a block ends that loop at once, at the voltages
 * given last. Damaged limits (CRC without a block) end it at once in either case, because no
 * voltage can be checked then.
 */
typedef enum pzs_supervisor_mode {
    PZS_MODE_INITIALISE = 0, /* not armed; parked, or on the way there */
    PZS_MODE_ARMED,          /* waits for the output to be parked and for a whole frame */
    PZS_MODE_RUNNING,        /* in control */
    PZS_MODE_HOLDING,        /* in control by the model alone: no usable frame in this tick */
    PZS_MODE_PARKING,        /* ramp by command */
    PZS_MODE_PARKED,         /* parked by command */
    PZS_MODE_STOPPING,       /* ramp after control was lost */
    PZS_MODE_LATCHED,        /* parked after control was lost, until the next init */
    PZS_MODES
} pzs_supervisor_mode;

typedef enum pzs_supervisor_command {
    PZS_COMMAND_NONE = 0,
    PZS_COMMAND_ARM,    /* leave INITIALISE */
    PZS_COMMAND_PARK,   /* ramp to the park voltages */
    PZS_COMMAND_FLAT,   /* ramp to the reference voltages of the problem */
    PZS_COMMAND_RESUME, /* from PARKING or PARKED back to control */
    PZS_COMMAND_STOP    /* emergency stop: ramp to the park voltages and latch */
} pzs_supervisor_command;

/* What changes the mode. The events of one tick act in this order, so the later ones prevail. */
typedef enum pzs_supervisor_event {
    PZS_EVENT_FRAME = 0, /* a usable frame; in ARMED a whole one, with the output parked */
    PZS_EVENT_NO_FRAME,  /* no usable frame of readings, or no usable target */
    PZS_EVENT_ARM,       /* commands */
    PZS_EVENT_PARK,      /* PARK or FLAT */
    PZS_EVENT_RESUME,
    PZS_EVENT_STOP,
    PZS_EVENT_TIMEOUT, /* no usable frame for `timeout` ticks */
    PZS_EVENT_ALARM,   /* the divergence monitor */
    PZS_EVENT_ERROR,   /* an error of another block, or damaged tables */
    PZS_EVENT_ARRIVED, /* the ramp has ended */
    PZS_EVENTS
} pzs_supervisor_event;

/* Tables of the supervisor. All arrays are const, in flash. */
typedef struct pzs_supervision {
    uint32_t format, scene; /* format and scene of the problem */
    uint32_t crc;           /* checksum of everything below; see pzs_supervision_seal */
    uint16_t inputs;
    uint16_t timeout;     /* ticks without a usable frame until control is lost; 0: never */
    uint16_t ramp_ticks;  /* shortest ramp (ticks), at least 1; step limits may make it longer */
    uint16_t alarm_ticks; /* the alarm comes after this many implausible ticks, which count one up,
                             plausible ones two down */
    uint16_t waits;       /* 1: INITIALISE is left by the command ARM; 0: by itself */
    const pzs_real *park; /* [inputs] park voltages (V); clamped to the limits */
    pzs_real fading; /* factor of one tick by which the explained deviation fades, 0 < fading < 1 */
    pzs_real noise;  /* RMS noise of the measured shape (m) */
    pzs_real load;   /* RMS change of the shape by the largest sudden load (m) */
} pzs_supervision;

/* Set format and checksum of tables that a firmware has built itself. Errors: ARGUMENT. */
pzs_status pzs_supervision_seal(pzs_supervision *tables);

/* Results of the supervisor that a program may read. */
typedef struct pzs_supervisor_info {
    pzs_supervisor_mode mode;
    pzs_supervisor_event cause; /* event that has taken control away; meaningful in STOPPING and
                                   LATCHED */
    uint32_t remaining;         /* ticks until the end of the ramp */
    pzs_real amplitude;         /* deviation that the divergence monitor sees (m) */
    pzs_real threshold;         /* deviation above which a tick counts as implausible (m) */
} pzs_supervisor_info;

typedef struct pzs_supervisor {
    pzs_supervisor_info info;
    pzs_supervisor_state state;
} pzs_supervisor;

/*
 * Give a command, which the next tick carries out; a later command replaces it, except that STOP
 * stays. May be called from an interrupt. A command that the mode does not know is ignored.
 *   supervisor  in/out  from pzs_loop_find(&loop, &pzs_supervisor_block)
 * Errors: ARGUMENT.
 */
pzs_status pzs_supervisor_give(pzs_supervisor *supervisor, pzs_supervisor_command command);

/*
 * Number of ticks of a ramp between two sets of voltages, and of the longest ramp to the park
 * voltages or to the reference voltages from anywhere inside the limits. An input with a step limit
 * of 0 cannot move and does not count. UINT32_MAX: there is no bound (a limit is infinite).
 *   from, to [inputs] in (V)
 */
uint32_t pzs_supervisor_ramp(const pzs_supervision *tables, const pzs_problem *problem,
                             const pzs_real *from, const pzs_real *to);
uint32_t pzs_supervisor_longest_ramp(const pzs_supervision *tables, const pzs_problem *problem);

/* The mode that follows a mode on an event, from the table of transitions. */
pzs_supervisor_mode pzs_supervisor_next(pzs_supervisor_mode mode, pzs_supervisor_event event);

/*
 * The supervisor as a block of PZS_PHASE_SUPERVISE. Tables: pzs_supervision. Object:
 * pzs_supervisor. Its init returns ARGUMENT (also tables of other counts), FORMAT, CRC, NONFINITE.
 */
extern const pzs_block_type pzs_supervisor_block;
#define PZS_SUPERVISOR_BLOCK_BYTES(outputs)                                                        \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_supervisor)) + 5u * (size_t)(outputs) * sizeof(pzs_real))

/* ---- vibration: modes observed and damped by the tick (lib/control/vibration.c) */

/*
 * Vibration modes of the structure and the gains of the damped tick, computed by the host for one
 * tick rate. The coordinate of a mode is in metres: a mode of coordinate 1 moves the outputs by an
 * RMS value of 1. All arrays are const, in flash.
 */
typedef struct pzs_vibration {
    uint32_t format, scene; /* format and scene of the problem */
    uint32_t crc;           /* checksum of everything below; see pzs_vibration_seal */
    uint16_t inputs, outputs, sensors, modes;
    uint16_t delay;          /* age of the readings (ticks) */
    const pzs_real *shape;   /* [outputs][modes] displacement of the outputs in each mode (1) */
    const pzs_real *reading; /* [sensors][modes] reading of the sensors in each mode; NULL: the
                                sensors are the outputs */
    const pzs_real *direct;  /* [sensors][inputs] static reading per volt; NULL: the sensors are
                                the outputs */
    const pzs_real *gain;    /* [outputs][sensors] shape per reading that the modes do not explain;
                                NULL: the sensors are the outputs */
    const pzs_real *precision; /* [sensors] inverse variance of the sensors' noise over that of the
                                  observer's design; NULL: 1 */
    const pzs_real *modal;     /* [modes][inputs] static coordinate of each mode per volt (m/V) */
    const pzs_real *turn;     /* [4][modes] propagators of the deviation from the equilibrium and of
                                 the velocity over one tick, by rows */
    const pzs_real *observer; /* [3][modes][modes] gains for position, velocity and load */
    const pzs_real *explain;  /* [modes][modes] coordinates that fit readings by least squares */
    const pzs_real *damping;  /* [modes][inputs] damping gradient per deviation of a mode (m/V) */
    const pzs_real *inverse_angle; /* [modes] 1 / (angular frequency times tick) */
    pzs_real share; /* part of the way to the static optimum in one tick, 0 < share <= 1 */
    pzs_real mix;   /* part of the deviation that is taken from the change of the velocity, 0 to 1;
                       the rest is position minus equilibrium */
    pzs_real slow;  /* gain of the low-pass filter of what the modes do not explain, 0 to 1 */
} pzs_vibration;

/* Set format and checksum of tables that a firmware has built itself. Errors: ARGUMENT. */
pzs_status pzs_vibration_seal(pzs_vibration *tables);

/* Results of the damper that a program may read. */
typedef struct pzs_damper_info {
    const pzs_real *position; /* [modes] estimated coordinate of each mode at the present tick (m)
                               */
    const pzs_real *velocity; /* [modes] its velocity over its angular frequency (m) */
    const pzs_real *load;     /* [modes] its static coordinate by loads (m) */
    pzs_real deviation;  /* amplitude of vibration: root of the sum over the modes of the squares of
                            deviation from the equilibrium and velocity (m, RMS over the outputs) */
    pzs_real innovation; /* RMS of reading - predicted reading in the last frame (m) */
    int32_t where;       /* index that belongs to the last status, or -1 */
} pzs_damper_info;

typedef struct pzs_damper {
    pzs_damper_info info;
    pzs_damper_state state;
} pzs_damper;

/* Bytes of workspace for a damper. */
#define PZS_FOURS(n) (((size_t)(n) + 3u) / 4u * 4u)
#define PZS_DAMPER_BYTES(modes, inputs, sensors, delay)                                            \
    (sizeof(pzs_real) * (((size_t)(delay) + 11u) * PZS_FOURS(modes) +                              \
                         ((size_t)(delay) + 5u) * PZS_FOURS(sensors) + 2u * PZS_FOURS(inputs)) +   \
     (size_t)(sensors))

/*
 * Lay out a damper in the workspace; control and tables must outlive it. The structure is taken to
 * be at rest under the present voltages.
 * Errors: ARGUMENT (also tables of other counts), STAGE, FORMAT, CRC, NONFINITE, WORKSPACE (where =
 * bytes needed).
 */
pzs_status pzs_damper_init(pzs_damper *damper, pzs_control *control, const pzs_vibration *tables,
                           void *work, size_t bytes);

/*
 * Before each pzs_tick: observe the modes from the readings, estimate the shape in which the
 * structure would rest under the present voltages and loads, and make the next pzs_tick a damped
 * one. The shape is then passed to pzs_tick as the measurement.
 *   readings [sensors]  in   taken `delay` ticks ago; NULL: no frame arrived
 *   shape    [outputs]  out  (m)
 * A reading that is missing (not finite, or off by more than 1e12) or stuck counts as its
 * low-passed residual. Without a usable reading the modes are predicted only. Warnings: SENSOR,
 * HELD (no reading is usable). Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_damper_tick(pzs_damper *damper, const pzs_real *readings, pzs_real *shape);

/*
 * To be called before the next tick where ticks were missed: predict the modes over these ticks, in
 * which the present voltages were given out. Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_damper_skip(pzs_damper *damper, uint16_t ticks);

/*
 * The damper as a block of PZS_PHASE_SHAPE, in place of the estimator. Tables: pzs_vibration.
 * Object: pzs_damper.
 */
extern const pzs_block_type pzs_vibration_block;
#define PZS_VIBRATION_BLOCK_BYTES(modes, inputs, outputs, sensors, delay)                          \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_damper)) +                                                  \
                PZS_ALIGNED(PZS_DAMPER_BYTES(modes, inputs, sensors, delay)) +                     \
                (size_t)(outputs) * sizeof(pzs_real))

/* ---- governor: moving targets of a damped tick (lib/control/governor.c) */

/*
 * Tables of the governor, which lets a damped tick follow a moving target: it computes the bounded
 * static optimum of each new target, and lets the voltages go there at a part of the step limits,
 * all in proportion. Put it behind the feed-forward and before the vibration block.
 */
typedef struct pzs_governor {
    pzs_real share; /* part of the way in one tick of the damped tick, as in pzs_vibration */
    pzs_real part;  /* largest part of the step limits, 0 < part <= 1 */
} pzs_governor;

/* State of the governor. */
typedef struct pzs_governor_state {
    const pzs_governor *tables;
    pzs_control *control; /* the controller of the loop */
    pzs_control optimum;  /* finds the bounded static optimum of the target */
    pzs_real *reference;  /* [inputs] voltages on the way to the optimum (V) */
    pzs_real *ahead;      /* [inputs] voltages by whose shape the target is moved back (V) */
    pzs_real *target;     /* [outputs] target of the optimum (m) */
    pzs_real *wanted;     /* [outputs] target that is passed on (m) */
    bool has_target;      /* `target` and its optimum are valid */
} pzs_governor_state;

/* The governor as a block of PZS_PHASE_READINGS. Tables: pzs_governor. */
extern const pzs_block_type pzs_governor_block;
#define PZS_GOVERNOR_BLOCK_BYTES(inputs, outputs)                                                  \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_governor_state)) +                                          \
                PZS_ALIGNED(PZS_CONTROL_BYTES(inputs, outputs)) +                                  \
                sizeof(pzs_real) * (2u * PZS_FOURS(inputs) + 2u * (size_t)(outputs)))

/* ---- feed-forward of known loads and temperatures (lib/control/feed_forward.c) */

/*
 * Sensitivity of the shape, or of the readings, to inputs whose values the firmware knows. All
 * arrays are const, in flash.
 */
typedef struct pzs_feed_forward_table {
    uint32_t format, scene; /* format and scene of the problem; the firmware must compare the scene,
                               because a shape carries none */
    uint32_t crc;           /* checksum of everything below; see pzs_feed_forward_seal */
    uint16_t inputs, outputs;
    const pzs_real *sensitivity; /* [outputs][inputs] shape per unit of each known input (m/N, m/Pa,
                                    m/K) */
} pzs_feed_forward_table;

/* Set format and checksum of a table that a firmware has built itself. Errors: ARGUMENT. */
pzs_status pzs_feed_forward_seal(pzs_feed_forward_table *table);

/* Check a table once at start-up. Errors: ARGUMENT, FORMAT, CRC, NONFINITE. */
pzs_status pzs_feed_forward_check(const pzs_feed_forward_table *table);

/*
 * Subtract the effect of known inputs from a shape before a tick: from `measured`, with the input
 * values at the time of the measurement, and from `wanted`, with the coming values. With an
 * estimator, subtract it from the readings instead of from `measured`, by a table with one row for
 * each sensor. The controller then sees only unknown disturbances, and compensates known ones
 * before they act.
 *   value [inputs]  in
 *   shape [outputs] in/out (m)
 * Errors: ARGUMENT, NONFINITE (the shape is unchanged).
 */
pzs_status pzs_feed_forward(const pzs_feed_forward_table *table, const pzs_real *value,
                            pzs_real *shape);

/* Tables of the feed-forward block: one for each signal from which known loads are subtracted. */
typedef struct pzs_known_loads {
    const pzs_feed_forward_table *shape;    /* [outputs][loads] effect on the shape */
    const pzs_feed_forward_table *readings; /* [sensors][loads] effect on the readings; NULL: the
                                               readings are the shape */
} pzs_known_loads;

/* Feed-forward as a block of PZS_PHASE_READINGS. Tables: pzs_known_loads. Its tick returns
 * NONFINITE for a known value that is not finite. */
extern const pzs_block_type pzs_feed_forward_block;
#define PZS_FEED_FORWARD_BLOCK_BYTES(sensors, outputs)                                             \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_feed_forward_state)) +                                      \
                ((size_t)(sensors) + (size_t)(outputs)) * sizeof(pzs_real))

/* ---- amplifiers with converter steps and a dead band (lib/control/amplifier.c) */

/*
 * After pzs_tick: replace control.info.voltage by the voltages that the amplifiers will really
 * give, so that the next tick predicts with them. A change of at most dead_band is not made. Any
 * other change goes to the last multiple of `step` on the way to the wanted voltage, inside voltage
 * limits and step limits.
 *   given [inputs] in/out  voltages that the amplifiers give (V); at the start those of
 *                          control.info.voltage, then left to this function
 *   step           in      converter step (V); 0: none
 *   dead_band      in      (V)
 * Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_quantise(pzs_control *control, pzs_real *given, pzs_real step, pzs_real dead_band);

/* Tables of the amplifier block. */
typedef struct pzs_amplifier {
    pzs_real step;      /* converter step (V); 0: none */
    pzs_real dead_band; /* largest change that an amplifier does not follow (V) */
} pzs_amplifier;

/* Amplifiers as a block of PZS_PHASE_VOLTAGE. Tables: pzs_amplifier. */
extern const pzs_block_type pzs_amplifier_block;
#define PZS_AMPLIFIER_BLOCK_BYTES(inputs)                                                          \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_amplifier_state)) + (size_t)(inputs) * sizeof(pzs_real))

/* ---- fault detector: dead and stuck electrodes (lib/control/faults.c) -- */

/*
 * Finds electrodes that do not follow their amplifiers, from the measured shape alone, and holds
 * them. A suspect is tested for about ten ticks: it is held at two voltages in turn, `amplitude` to
 * either side of where it was, inside all limits, while the control step compensates with the
 * others. At most PZS_TEST_SIGNALS electrodes are tested at a time. An electrode that has lost more
 * than two amplitudes at once, or is asked to move by as much and does not, is detected within 12
 * ticks plus the delay of the sensors: 2 for the suspicion, 9 for the test, 1 to hold it. While
 * more than an eighth of the outputs have no measurement, no electrode is observed. The detector
 * reads static shapes: on a structure that vibrates, or with strong hysteresis, it suspects healthy
 * electrodes.
 */
#define PZS_DELAY_LIMIT 16 /* largest delay of the measurements (ticks) */

typedef enum pzs_electrode_state {
    PZS_ELECTRODE_OBSERVED = 0,
    PZS_ELECTRODE_TESTED,       /* a test signal is applied */
    PZS_ELECTRODE_CLEARED,      /* passed its test, and is not suspected during the next shapes */
    PZS_ELECTRODE_UNOBSERVABLE, /* the effect on the shape is zero or a combination of the effects
                                   of other electrodes */
    PZS_ELECTRODE_HELD          /* found to be faulty; held until pzs_release */
} pzs_electrode_state;

/* Settings of the fault detector that a program may change after its init. */
typedef struct pzs_fault_detector_settings {
    pzs_real *amplitude; /* [inputs] amplitude of the test signal (V), at most half the step limit.
                            Default: just below half the step limit or 1/32 of the voltage range,
                            whichever is smaller. 0: not observed. */
} pzs_fault_detector_settings;

/* Results of the fault detector that a program may read. */
typedef struct pzs_fault_detector_info {
    const uint8_t *electrode; /* [inputs] state of each electrode, a pzs_electrode_state */
    int32_t where;            /* index that belongs to the last status, or -1 */
    uint16_t found;           /* number of electrodes detected since the init */
    uint16_t unobservable;    /* number of electrodes that cannot be observed */
} pzs_fault_detector_info;

typedef struct pzs_fault_detector {
    pzs_fault_detector_settings settings;
    pzs_fault_detector_info info;
    pzs_fault_detector_state state;
} pzs_fault_detector;

/* Bytes of workspace for a fault detector. */
#define PZS_FAULT_DETECTOR_BYTES(inputs, outputs, delay)                                           \
    (sizeof(pzs_real) * (PZS_DENSE(inputs) + ((size_t)(delay) + 8u) * (size_t)(inputs) +           \
                         2u * (size_t)(outputs)) +                                                 \
     sizeof(uint32_t) * ((size_t)(inputs) / PZS_TILE + 2u) +                                       \
     (sizeof(uint16_t) + 2u) * (size_t)(inputs) + (size_t)(outputs))

/*
 * Start to observe the electrodes of a controller, from its present voltages on.
 *   control in/out  after pzs_control_init; must outlive the detector
 *   delay   in      delay of the measurements (ticks), at most PZS_DELAY_LIMIT
 * With a delay, the shape `measured` that is passed in each tick to pzs_tick and to
 * pzs_fault_detector_tick must already be corrected for the delay: the shape measured `delay`
 * ticks ago, plus the shape predicted for the present voltages, minus the shape predicted for the
 * voltages at the time of the measurement. In both predictions an electrode that is held has the
 * voltage at which it is held. Errors: ARGUMENT, STAGE, WORKSPACE (where = bytes needed),
 * NONFINITE.
 */
pzs_status pzs_fault_detector_init(pzs_fault_detector *detector, pzs_control *control,
                                   uint16_t delay, void *work, size_t bytes);

/*
 * After each pzs_tick (and pzs_quantise), with the same measurements. Warning ELECTRODE: input
 * `where` was detected (the first of several; all have state PZS_ELECTRODE_HELD). It is held until
 * pzs_release: a dead one at 0 V, another at its last voltage. Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_fault_detector_tick(pzs_fault_detector *detector, const pzs_real *measured);

/* Tables of the fault detector block. */
typedef struct pzs_fault_detection {
    uint16_t delay;     /* delay of the measurements (ticks), at most PZS_DELAY_LIMIT */
    pzs_real amplitude; /* amplitude of the test signals (V), cut to half the step limit; 0: the
                           default */
} pzs_fault_detection;

/* The fault detector as a block of PZS_PHASE_OBSERVE. Tables: pzs_fault_detection. Object:
 * pzs_fault_detector. */
extern const pzs_block_type pzs_fault_detector_block;
#define PZS_FAULT_DETECTOR_BLOCK_BYTES(inputs, outputs, delay)                                     \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_fault_detector)) +                                          \
                PZS_FAULT_DETECTOR_BYTES(inputs, outputs, delay))

#ifdef __cplusplus
}
#endif
#endif
