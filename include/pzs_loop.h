/*
 * The control loop: a list of blocks, and one call that runs them in each tick. A block is a stage
 * of the tick, for example the vibration damper or the control step (optimisation of the voltages).
 *
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
 * `pzs tables` generates the list of blocks (here mirror_blocks); a program links only these
 * blocks.
 *
 * Without a list, a program may call the functions of the blocks itself, with the same results to
 * the last bit. Their order: pzs_feed_forward on the readings and on the target, pzs_estimate_tick
 * or pzs_damper_tick, pzs_tick, pzs_quantise, pzs_fault_detector_tick.
 */
#ifndef PZS_LOOP_H
#define PZS_LOOP_H

#include "pzs_control.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- the loop: a list of blocks (lib/control/loop.c) -------------------- */

/*
 * Phase of a control tick in which a block (stage of the tick) runs. The list of the blocks of a
 * loop must be in the order of their phases.
 */
typedef enum pzs_block_phase {
    PZS_PHASE_COMMISSION, /* blocks of this phase run before the control loop takes over the
                             voltages: as long as such a block returns a warning or an error, no
                             other block (stage of the tick) runs; a loop has at most one */
    PZS_PHASE_READINGS,   /* blocks (stages of a control tick) of this phase change the sensor
                             readings or the target shape before the voltages are chosen */
    PZS_PHASE_SHAPE, /* blocks (stages of a control tick) of this phase compute the measured shape
                        from the sensor readings; a loop has at most one */
    PZS_PHASE_STEP,  /* blocks (stages of a control tick) of this phase choose the voltages; a loop
                        has exactly one, with tables of type pzs_problem */
    PZS_PHASE_VOLTAGE, /* blocks (stages of a control tick) of this phase change the chosen voltages
                          in the way in which the amplifiers will change them */
    PZS_PHASE_OBSERVE, /* blocks (stages of a control tick) of this phase compare voltages and
                          measured shape to detect faulty electrodes, and may fix their voltages */
    PZS_PHASE_SUPERVISE /* blocks (stages of a control tick) of this phase run in every tick, also
                           after an error of another block, and set the final voltages and the final
                           status; a loop has at most one */
} pzs_block_phase;

/*
 * Signals that the blocks (stages of a control tick) pass on to each other. No block changes
 * the numbers in these arrays: a block that changes a signal redirects the pointer to an array of
 * its own.
 */
typedef struct pzs_loop_signals {
    pzs_control *control;      /* controller of the loop; NULL until it is initialised */
    const pzs_real *influence; /* [outputs][inputs] influence matrix that was passed to
                                  pzs_loop_init for the controller (m/V), or NULL */
    const pzs_real *wanted;    /* [outputs] target shape (m) */
    const pzs_real *readings;  /* [sensors] sensor readings (unit of each sensor); NULL: no readings
                                  arrived in this tick */
    const pzs_real *measured;  /* [outputs] measured shape (m); NULL: no readings arrived in this
                                  tick. This member points to the readings until a stage of the tick
                                  (of PZS_PHASE_SHAPE) has computed the shape */
    const pzs_real *known_now; /* [loads] values of the known loads when the readings were taken, as
                                  multiples of the loads in the scene file; NULL: no load is known
                                */
    const pzs_real *known_next; /* [loads] values of the known loads under the next voltages, as
                                   multiples of the loads in the scene file; NULL: no load is known
                                 */
    const uint8_t *electrode;   /* [inputs] state of each electrode, a value of pzs_electrode_state,
                                   for example that it was found faulty; NULL: the loop has no fault
                                   detector */
    const void *tables;    /* constant tables of the block (stage of the control tick) that runs at
                              present */
    const pzs_real *given; /* [inputs] voltages that the amplifiers have given since the last tick
                              (V) */
    struct pzs_compensator *compensator; /* memory of the compensation of hysteresis, which two
                                            stages of the control tick share; NULL: the loop does
                                            not compensate hysteresis */
    bool has_inverse; /* during the initialisation of the loop: whether pzs_inverse_block, the
                         second stage of the compensation of hysteresis, is in its list of blocks */
    /*
     * Tables of pzs_vibration_block, which damps vibration: during the initialisation of the loop
     * and in each tick from its turn on; NULL: this block is not in the list of blocks of the loop
     */
    const struct pzs_vibration *vibration;
    /*
     * Curves of the actuators: displacement as a function of the voltage, where it is not
     * proportional to it; NULL: none. During the initialisation of the loop pzs_curve_inverse_block
     * sets this pointer, during a tick pzs_curve_block.
     */
    const struct pzs_actuator_curves *curves;
    /*
     * Function that replaces voltages [inputs] by their effects: values to which the displacements
     * of the actuators are proportional. Blocks call it before they multiply voltages by the
     * influence matrix, which then holds the displacement per unit of effect. NULL: all actuators
     * are linear.
     */
    void (*take_effects)(const struct pzs_loop_signals *signals, pzs_real *voltage);
    struct pzs_free_functions_state *free_functions; /* memory of pzs_free_functions_block; NULL:
                                                        the target has no free functions (shapes
                                                        that may be added to it at no cost) */
    /*
     * Function that returns a shape [outputs] without its components along the free functions
     * (shapes that may be added to the target at no cost), and with 0 at outputs of weight 0. The
     * result stands in array number `place` (below PZS_FREE_SHAPES) of pzs_free_functions_block
     * until the next call with this number. NULL: the target has no free functions.
     */
    const pzs_real *(*without_free)(const struct pzs_loop_signals *signals, const pzs_real *shape,
                                    uint32_t place);
    uint32_t missed; /* number of ticks that were missed before this tick, at most PZS_MISSED_LIMIT
                      */
    pzs_real deviation; /* RMS amplitude by which the measured motion of the structure deviates from
                           the prediction of the model (m), for the divergence monitor of the
                           supervisor; negative: not computed in this tick */
    bool is_repeated;   /* with a vibration damper: whether no reading differs from that of the last
                           tick */
    uint16_t delay;     /* with a vibration damper: age of the readings (ticks) */
    const pzs_real *sensed;   /* [sensors] with a vibration damper: last usable reading of each
                                 sensor (unit of each sensor); NULL: without one */
    const pzs_real *expected; /* [sensors] with a vibration damper: readings in static equilibrium
                                 under the present voltages without loads (unit of each sensor) */
    const pzs_real *modal_position; /* [modes] with a vibration damper: coordinates of the vibration
                                       modes by the last usable readings alone (m); NULL: without
                                       one */
    const pzs_real *modal_rest;     /* [modes] with a vibration damper: coordinates of the vibration
                                       modes in static equilibrium without loads, under the voltages
                                       when the readings were taken (m) */
    uint32_t warnings; /* one bit, 1 << status, for each warning that a block (stage of the control
                          tick) has returned in this tick */
    pzs_status status; /* status of the tick after the stages that have run so far; the supervisor
                          reads it */
    uint16_t sensors;  /* number of sensor readings that the later stages of the control tick need,
                          which is the length of `readings` */
    int32_t where; /* index of the input, output or reading to which the status of a block (stage of
                      the control tick) refers, or -1; the block writes it */
} pzs_loop_signals;

/*
 * A type of block (stage of the control tick): a constant table, in flash, of the functions that
 * initialise, run and check such a block. The functions return the statuses of the library.
 */
typedef struct pzs_block_type {
    const char *name; /* name of this type of block (stage of the control tick) in messages to users
                       */
    pzs_block_phase phase;
    /*
     * Return the size of the memory that a block (stage of the control tick) needs (bytes); it may
     * depend only on the sizes in its tables and in pzs_problem, the tables of the controller.
     */
    size_t (*block_bytes)(const void *tables, const pzs_problem *problem);
    /*
     * Check the tables of a block (stage of the control tick) and initialise it. pzs_loop_init
     * first initialises the block that contains the controller, then all others from the last of
     * the list to the first.
     *   self in/out  memory of block_bytes bytes, aligned for pointers and doubles
     */
    pzs_status (*block_init)(void *self, const void *tables, pzs_loop_signals *signals);
    /* Run a block (stage of the control tick) in one tick. An error ends the tick. */
    pzs_status (*block_tick)(void *self, pzs_loop_signals *signals);
    /*
     * List the arrays that the checksum of a table covers, in the order of the checksum, for checks
     * of the table while the loop runs. NULL: the tables have no checksum.
     *   number in   number of the table, from 0; a block (stage of the control tick) may have
     *               several
     *   crc    out  expected checksum of the table
     * Returns the number of arrays; 0: the block has no table of this number.
     */
    uint32_t (*block_parts)(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc);
} pzs_block_type;

/* One entry in the list of blocks of a control loop; a block is a stage of the control tick. */
typedef struct pzs_block {
    const pzs_block_type *type;
    const void *tables; /* constant tables of the block (stage of the control tick), not NULL; the
                           comment on each block type of the library names their struct */
} pzs_block;

#define PZS_BLOCK_LIMIT 16 /* largest number of blocks (stages of the tick) of a control loop */
/* Largest number of missed ticks over which a control loop predicts readings and vibration. */
#define PZS_MISSED_LIMIT 64

/* Results of the loop that a program may read. */
typedef struct pzs_loop_info {
    /*
     * [inputs] the voltages to apply (V), finite and inside the limits, from the last tick without
     * an error. The loop fills two arrays in turn, so that the array to which this pointer points
     * stays unchanged during the next tick. An interrupt reads the voltages through
     * pzs_loop_voltages.
     */
    const pzs_real *volatile voltage;
    volatile uint32_t frames; /* number of ticks that have published new voltages; in such a tick
                                 the member `voltage` begins to point to the other array */
    const pzs_real *measured; /* [outputs] measured shape that the last tick used (m); NULL: it used
                                 none */
    const uint8_t *electrode; /* [inputs] state of each electrode after the last tick, a value of
                                 pzs_electrode_state; NULL: the loop has no fault detector */
    pzs_control *control;     /* controller of the loop, to be passed to pzs_hold, pzs_release and
                                 pzs_assess */
    const pzs_block_type *block; /* type of the block (stage of the control tick) that returned the
                                    last status; NULL: the status comes from the loop itself */
    int32_t where; /* index of the input, output or reading to which the last status of the loop
                      refers, or -1; if pzs_loop_init refused the list of blocks (stages of the
                      tick), index of the wrong block in the list */
} pzs_loop_info;

typedef struct pzs_loop {
    pzs_loop_info info;
    pzs_loop_state state;
} pzs_loop;

/*
 * Size of the workspace of a control loop (bytes): PZS_LOOP_BYTES plus PZS_NAME_BLOCK_BYTES for
 * each block NAME (stage of the tick) in its list. PZS_ALIGNED rounds a size up to a multiple of 8
 * bytes.
 */
#define PZS_ALIGNED(bytes) (((size_t)(bytes) + 7u) / 8u * 8u)
#define PZS_LOOP_BYTES(blocks, inputs)                                                             \
    (8u + 0u * (size_t)(blocks) + PZS_ALIGNED(5u * (size_t)(inputs) * sizeof(pzs_real)))

/*
 * Check the blocks of a control loop (the stages of its tick) and their tables, and initialise the
 * loop in the workspace.
 *   blocks [count]              in  list in the order of the phases, each type at most once; the
 *                                   list and the tables must outlive the loop
 *   influence [outputs][inputs] in  influence matrix computed on the device (m/V); NULL: that of
 *                                   the tables (pzs_problem)
 *   work                        in  memory of the caller, aligned for pzs_real; the loop uses it
 *                                   from now on
 *   bytes                       in  size of the workspace
 * Errors, after which the loop cannot be used; info.block is the type of the block concerned:
 *   PZS_E_ARGUMENT   no block or too many, no pzs_step_block, a block type twice, a block without
 *                    tables, tables of other sizes
 *   PZS_E_STAGE      a block follows one of a later phase
 *   PZS_E_WORKSPACE  info.where = bytes needed
 *   PZS_E_FORMAT     also for tables of another scene
 *   others           errors of the blocks
 */
pzs_status pzs_loop_init(pzs_loop *loop, const pzs_block *blocks, size_t count,
                         const pzs_real *influence, void *work, size_t bytes);

/*
 * Set the present voltages of a control loop to those that the amplifiers already give, clamped to
 * the limits, so that no voltage jumps after a reset. All other stages of the tick are initialised
 * again; repeat earlier calls of pzs_hold.
 *   voltage [inputs] in  voltages that the amplifiers give (V)
 * Errors, which change nothing: PZS_E_ARGUMENT, PZS_E_STAGE, PZS_E_NONFINITE.
 */
pzs_status pzs_loop_start(pzs_loop *loop, const pzs_real *voltage);

/*
 * Announce to a control loop the values of loads that the program knows (pressures, temperatures).
 * A value of 1 is the value in the scene file. Every tick reads both arrays until the next call.
 *   now  [loads] in  values when the readings of a tick were taken; NULL: no load is known
 *   next [loads] in  values under the next voltages
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 */
pzs_status pzs_loop_know(pzs_loop *loop, const pzs_real *now, const pzs_real *next);

/*
 * Inform a control loop, before its next tick, of missed ticks, during which the amplifiers kept
 * the present voltages. Without this call the loop stays inside all limits, but takes longer to
 * reach the target.
 *   ticks in  number of missed ticks; several calls add up, to at most PZS_MISSED_LIMIT, after
 *             which the phase of a vibration is unknown
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 */
pzs_status pzs_loop_skip(pzs_loop *loop, uint32_t ticks);

/*
 * Protection of a control loop against damaged memory:
 *   - Pointers, sizes and limits are derived anew in each tick from three copies of the list of
 *     blocks, of which two outvote a damaged third.
 *   - The optimiser's Hessian is compared with the tables, one row in each tick.
 *   - Each tick adds 64 bytes of pzs_problem and 64 bytes of other tables to their checksums.
 *   - Voltages of a damaged loop stay inside voltage limits and step limits, unless the damage
 *     occurs after a tick and before the program reads info.voltage.
 */

/*
 * Run one tick of a control loop: all blocks (stages of the tick) in the order of their list, then
 * the last gate, which checks the voltages.
 *   wanted   [outputs] in  target shape (m)
 *   readings [sensors] in  sensor readings, NaN where a sensor gives nothing; in a loop without
 *                          estimator and damper the measured shape [outputs] (m); NULL: no readings
 *                          arrived, and the last disturbance (measured minus predicted shape) is
 *                          kept
 * Returns the error of a block, which ends the tick and keeps the last voltages; otherwise the
 * warning of pzs_step_block; otherwise the first warning in the order of the list. info.block is
 * the type of the block that returned the status.
 *   PZS_W_HELD    from pzs_step_block: the voltages are kept, clamped to the present limits; from
 *                 the estimator or the damper: no reading was usable, so the last disturbance is
 *                 kept, and the voltages still follow the target
 *   PZS_W_OUTPUT  the last gate clamped a voltage to its voltage limit or step limit, or replaced
 *                 one that is not finite by the last one: working memory was damaged; takes
 *                 precedence over other warnings
 *   PZS_E_CRC     tables are damaged: reported at once for limits, otherwise after at most three
 *                 complete readings of the tables; info.block is NULL for pzs_problem, otherwise
 *                 the block with the damaged tables
 */
pzs_status pzs_loop_tick(pzs_loop *loop, const pzs_real *wanted, const pzs_real *readings);

/*
 * Take the heartbeat of a control loop, with which a program kicks a hardware watchdog. A tick that
 * has published voltages and is in order makes one heartbeat; the function returns true once for
 * it, and false until the next such tick. The program calls the function after the amplifiers have
 * the voltages, so that a hang of their driver counts, too, and kicks the watchdog nowhere else:
 *
 *     status = pzs_loop_tick(&loop, wanted, readings);
 *     write_amplifiers(loop.info.voltage);
 *     if (pzs_loop_take_heartbeat(&loop))
 *         kick_watchdog();
 *
 * No heartbeat:
 *   - before the first tick, and after a refused pzs_loop_init;
 *   - a hang, a crash, or a tick that takes longer than the time-out of the watchdog;
 *   - a tick that returns an error, also PZS_E_LATCHED;
 *   - a tick that returns PZS_W_OUTPUT: the last gate had to correct a voltage;
 *   - after damaged tables were found, also during the ramp of a supervisor that follows, and also
 *     if the tables read well again: none until pzs_loop_init, which checks all tables;
 *   - without a supervisor: a tick without a usable reading or with a target that is not finite
 *     (PZS_W_HELD), because only the watchdog then limits how long this lasts. A tick without
 *     readings (NULL) is in order there: such a loop may have no sensors.
 * A heartbeat all the same:
 *   - parked voltages, a self-test, a polarity test, and the way to the park voltages
 *     (PZS_W_PARKED, PZS_W_SELFTEST, PZS_W_POLARITY, PZS_W_RAMP): these ticks work as intended, and
 *     a reset on the way would let voltages jump. A ramp after an error or an alarm ends in
 *     PZS_E_LATCHED, after at most pzs_supervisor_longest_ramp ticks without missed ones; from then
 *     on there is no heartbeat;
 *   - with a supervisor: ticks without usable readings, until its time-out starts that ramp. With a
 *     time-out of 0 ticks they last for ever.
 * A time-out of the watchdog of several tick periods tolerates single ticks that are not in order.
 * A reset by the watchdog starts the program anew: only with pzs_supervision.waits = 1 the loop
 * then stays parked until a command. The loop has one heartbeat, so only one place in a program may
 * take it. That place may be an interrupt, which then does not cover the driver of the amplifiers.
 */
bool pzs_loop_take_heartbeat(pzs_loop *loop);

/*
 * Copy the voltages that the last tick of a control loop has computed; all belong to one tick. The
 * function is for a part of the program that may interrupt a tick. On a processor that reorders
 * writes, or with DMA, place its memory barrier after the tick.
 *   voltage [inputs] out  voltages to apply (V)
 * Warning, errors: PZS_E_ARGUMENT, PZS_E_STAGE, and
 *   PZS_W_HELD  ticks kept interrupting the copy; ignore `voltage`
 */
pzs_status pzs_loop_voltages(const pzs_loop *loop, pzs_real *voltage);

/*
 * Return the memory of the block (stage of the control tick) of a given type in a control loop; the
 * comment on each block type of the library names the struct in this memory. Returns NULL if the
 * loop has no such block or is not initialised.
 */
void *pzs_loop_find(const pzs_loop *loop, const pzs_block_type *type);

/*
 * Block (stage of the control tick, in PZS_PHASE_STEP) that chooses the voltages by pzs_tick.
 * Tables: pzs_problem. Memory returned by pzs_loop_find: pzs_control.
 */
extern const pzs_block_type pzs_step_block;
#define PZS_STEP_BLOCK_BYTES(inputs, outputs)                                                      \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_control)) + PZS_CONTROL_BYTES(inputs, outputs))
#define PZS_STEP_BLOCK_ROW_BYTES(inputs, outputs, rows)                                            \
    PZS_ALIGNED(PZS_STEP_BLOCK_BYTES(inputs, outputs) + PZS_LIMIT_ROW_BYTES(inputs, rows))

/* ---- estimator: the shape from a few sensors (lib/control/estimate.c) -- */

/*
 * Tables of the shape estimator, which computes the shape from a few sensors; the host computes the
 * tables from the loads and faults that it expects. All arrays are const and may stay in flash.
 */
typedef struct pzs_estimator {
    uint32_t format, scene; /* format: format number of the estimator's tables; scene: hash of the
                               scene file from which `pzs tables` generated them, equal to the hash
                               in the controller's tables (pzs_problem) */
    uint32_t crc; /* checksum of the shape estimator's tables and their arrays, computed by
                     pzs_estimator_seal */
    uint16_t inputs, outputs, sensors;
    const pzs_real *direct; /* [sensors][inputs] reading of each sensor per volt on each input (V/V,
                               C/V or m/V) */
    const pzs_real *gain; /* [outputs][sensors] gain of the estimator: change of the estimated shape
                             per deviation of a reading from its expected value (m/V, m/C or 1) */
} pzs_estimator;

/*
 * Write the format number and the checksum into estimator tables that a firmware has built itself.
 * Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_estimator_seal(pzs_estimator *tables);

typedef struct pzs_estimate_info {
    int32_t where; /* index of the sensor reading to which the last status of the shape estimator
                      refers, or -1 */
} pzs_estimate_info;

typedef struct pzs_estimate {
    pzs_estimate_info info;
    pzs_estimate_state state;
} pzs_estimate;

/* Size of the workspace of a shape estimator (bytes). */
#define PZS_ESTIMATE_BYTES(sensors)                                                                \
    (sizeof(pzs_real) * 3u * (((size_t)(sensors) + 3u) / 4u * 4u) + (size_t)(sensors))

/*
 * Initialise a shape estimator in the workspace; control and tables must outlive it. Errors:
 * PZS_E_ARGUMENT (also for tables of other sizes), PZS_E_STAGE, PZS_E_FORMAT, PZS_E_CRC,
 * PZS_E_NONFINITE, PZS_E_WORKSPACE (info.where = bytes needed).
 */
pzs_status pzs_estimate_init(pzs_estimate *estimate, pzs_control *control,
                             const pzs_estimator *tables, void *work, size_t bytes);

/*
 * Estimate the measured shape from a few sensors, to be passed to the next pzs_tick as its
 * measurement: predicted shape plus gain times (readings minus expected readings).
 *   sensed [sensors] in   sensor readings; one that is not finite or stuck keeps its last deviation
 *   shape  [outputs] out  estimated shape (m)
 * Warnings: PZS_W_SENSOR, PZS_W_HELD (no reading is usable). Errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 */
pzs_status pzs_estimate_tick(pzs_estimate *estimate, const pzs_real *sensed, pzs_real *shape);

/*
 * Block (stage of the control tick, in PZS_PHASE_SHAPE) that estimates the shape from a few
 * sensors. Tables: pzs_estimator. Memory returned by pzs_loop_find: pzs_estimate.
 */
extern const pzs_block_type pzs_estimator_block;
#define PZS_ESTIMATOR_BLOCK_BYTES(sensors, outputs)                                                \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_estimate)) + PZS_ALIGNED(PZS_ESTIMATE_BYTES(sensors)) +     \
                (size_t)(outputs) * sizeof(pzs_real))

/* ---- late readings of a loop without a damper (lib/control/delay.c) ------ */

/*
 * Tables of the correction of late sensor readings, for a loop that does not damp vibration. All
 * arrays are const and may stay in flash.
 */
typedef struct pzs_reading_delay {
    uint32_t format, scene; /* format: format number of the tables of the correction of late
                               readings; scene: hash of the scene file from which `pzs tables`
                               generated them, equal to the hash in the controller's tables
                               (pzs_problem) */
    uint32_t crc; /* checksum of the tables of the correction of late readings and their arrays,
                     computed by pzs_reading_delay_seal */
    uint16_t inputs, sensors;
    uint16_t delay;         /* age of the sensor readings when a tick uses them (ticks), at most
                               PZS_DELAY_LIMIT */
    const pzs_real *direct; /* [sensors][inputs] reading of each sensor per volt on each input (V/V,
                               C/V or m/V); NULL: the sensors are the outputs, and the influence
                               matrix is used */
} pzs_reading_delay;

/*
 * Write the format number and the checksum into tables of the correction for late sensor readings
 * that a firmware has built itself. Errors: PZS_E_ARGUMENT (a pointer is NULL).
 */
pzs_status pzs_reading_delay_seal(pzs_reading_delay *tables);

/*
 * Block (stage of the control tick, in PZS_PHASE_READINGS) that corrects late readings: it adds to
 * each the change predicted from the voltages applied since the reading was taken. Tables:
 * pzs_reading_delay.
 *   - A missing or stuck reading becomes NaN.
 *   - The block is the first of its list except for pzs_effect_block.
 *   - A loop with the vibration damper does not need it, because the damper takes the delay into
 *     account.
 * Errors of its initialisation: PZS_E_ARGUMENT (also for tables of other sizes), PZS_E_FORMAT,
 * PZS_E_CRC, PZS_E_NONFINITE.
 */
extern const pzs_block_type pzs_reading_delay_block;
#define PZS_READING_DELAY_BLOCK_BYTES(inputs, sensors, delay)                                      \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_reading_delay_state)) +                                     \
                (((size_t)(delay) + 1u) * ((size_t)(inputs) + (size_t)(sensors)) +                 \
                 3u * (size_t)(sensors)) *                                                         \
                    sizeof(pzs_real) +                                                             \
                (size_t)(sensors))

/* ---- sensor gate (lib/control/sensor_gate.c) ----------------------------- */

/*
 * Tables of the sensor gate, which takes away readings that cannot be: those beyond their range,
 * and those that contradict the others. Readings contradict each other where parity relations are
 * violated: sums c_1 s_1 + c_2 s_2 + ... over the readings s that are 0 for all readings which
 * voltages, vibration modes and loads can make. All arrays are const and may stay in flash. Without
 * redundancy (`relations` 0) the gate has ranges only, and the arrays after `range` are NULL.
 */
typedef struct pzs_sensor_gate {
    uint32_t format, scene; /* format: format number of the tables of the sensor gate; scene: hash
                               of the scene file from which `pzs tables` generated them, equal to
                               the hash in the controller's tables (pzs_problem) */
    uint32_t crc;           /* checksum of the tables of the sensor gate and their arrays,
                               computed by pzs_sensor_gate_seal */
    uint16_t sensors;       /* number of readings */
    uint16_t relations;     /* number of parity relations, below that of the sensors */
    uint16_t quick;         /* number of parity relations that every tick computes, from 1; the
                               others follow only where these show that a sensor may be wrong */
    uint16_t most;          /* largest number of sensors that are gated (found wrong) or missing
                               at once, at most `relations`; if more are missing, the sensor gate
                               compares no readings */
    uint16_t patience;      /* number of ticks in which a gated sensor must agree with the others
                               until it is trusted again, from 1 */
    uint16_t replaces; /* 1: the parity relations determine gated and missing readings, where these
                          are not more than `most`; 0: they become NaN */
    const pzs_real *range;  /* [sensors] largest believable size of each reading, above 0 (unit of
                               the sensor) */
    const pzs_real *parity; /* [sensors][relations] coefficients of the parity relations
                               (columns), for each reading (1 / unit of the sensor) */
    const pzs_real *scale;  /* [sensors] 1 / norm of each row of `parity` (unit of the sensor);
                               0: the sensor is never gated */
    const pzs_real *threshold; /* [sensors] smallest error of each reading for which the sensor is
                                  gated, above 0 (unit of the sensor) */
    pzs_real quiet; /* norm of the values of the first `quick` relations below which no single
                       sensor can be suspected: at most the threshold of each sensor times the norm
                       of these entries of its row of `parity` */
    pzs_real ratio; /* smallest ratio of what the error of a gated sensor adds to the parity
                       relations to what remains in them without the gated sensors (norms), from 1
                     */
} pzs_sensor_gate;

/*
 * Write the format number and the checksum into tables of the sensor gate that a firmware has built
 * itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_sensor_gate_seal(pzs_sensor_gate *tables);

/*
 * Block (stage of the control tick, in PZS_PHASE_READINGS) that takes wrong readings away: the next
 * blocks get their fit to the other readings, or NaN, as for a sensor that is silent. In the list
 * of blocks it comes before all others that use readings. Tables: pzs_sensor_gate. Memory returned
 * by pzs_loop_find: pzs_sensor_gate_state, whose member `info` tells which readings are gated.
 * Warnings of its tick: PZS_W_GATED, info.where of the loop = first gated reading; without one
 * PZS_W_CONTRADICTION, info.where = the sensor that would explain most of it, and without that
 * PZS_W_SENSOR, info.where = first missing reading, if the gate has replaced a missing one.
 * Errors of its initialisation: PZS_E_FORMAT, PZS_E_CRC, PZS_E_NONFINITE, and PZS_E_ARGUMENT (also
 * for tables of other sizes; for a range or threshold that is not above 0, or a scale below 0,
 * info.where = the sensor).
 */
extern const pzs_block_type pzs_sensor_gate_block;
#define PZS_SENSOR_GATE_BLOCK_BYTES(sensors, relations, most)                                      \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_sensor_gate_state)) +                                       \
                (2u * PZS_FOURS(sensors) + (1u + (size_t)(most)) * PZS_FOURS(relations) +          \
                 PZS_FOURS((size_t)(most) * (most))) *                                             \
                    sizeof(pzs_real) +                                                             \
                PZS_FOURS(sensors))

/* ---- gains and leaks of modes (lib/control/modal_gains.c) ----------------- */

/*
 * Tables of a leaky integrator for each mode, in the place of ticks that go all the way to the
 * optimum. A mode is a pattern of voltages; modes are orthonormal in the Hessian H of the
 * optimisation, p_i'H p_k = 1 for i = k and else 0, so that 1 m of a mode moves the shape by a
 * weighted norm of 1 m. A tick whose voltages meet no limit changes the coordinate c_k of mode k,
 * counted from the reference voltages, to
 *   c_k (1 - leak_k) + gain_k d_k
 *   d_k  change of the coordinate in a tick without gains and leaks: that of the least-squares
 *        voltages for target shape minus measured shape
 *
 * `other_gain` and `other_leak` hold for all voltages outside the span of the modes. With gain 1
 * and leak 0 everywhere a tick is the same as without gains and leaks.
 *
 *   - Where limits are met, the voltages are the ones inside all limits that are nearest to the
 *     voltages of this formula, in the norm of H. The next tick starts from the voltages inside the
 *     limits, so that there is no integrator windup.
 *   - At rest, the voltages inside the limits minimise the sum over the modes of gain_k (c_k -
 *     o_k)^2 + leak_k c_k^2, where o_k are the coordinates of the least-squares voltages; equal
 *     gains without leak give the optimum of the tick without gains.
 *   - White noise of the measured shape with the variance s2 in a mode gives its coordinate the
 *     variance gain^2 s2 / ((gain + leak) (2 - gain - leak)).
 *
 * All arrays are const and may stay in flash.
 */
typedef struct pzs_modal_gains {
    uint32_t format, scene; /* format: format number of these tables of gains and leaks of modes;
                               scene: hash of the scene file from which `pzs tables` generated them,
                               equal to the hash in the controller's tables (pzs_problem) */
    uint32_t crc; /* checksum of these tables of gains and leaks of modes with their arrays,
                     computed by pzs_modal_gains_seal */
    uint16_t inputs, modes;  /* number of inputs, and number of modes, which may be 0 */
    const pzs_real *pattern; /* [modes][inputs] voltages that make up 1 m of each mode (V/m). This
                                array and the next three may be NULL if there are no modes */
    const pzs_real *effect;  /* [modes][inputs] `pattern` of each mode multiplied by the Hessian of
                                the optimisation (m/V). The Hessian is B'W^2 B + regularisation I
                                (m2/V2), with influence matrix B and output weights W */
    const pzs_real *gain; /* [modes] gain of each mode: part of the wanted change that a tick makes
                             (dimensionless), at least 0; gain plus leak of a mode must be below 2
                           */
    const pzs_real *leak; /* [modes] leak of each mode: part of its coordinate that is lost in a
                             tick, from 0 to 1 */
    pzs_real other_gain; /* gain of all voltages outside the span of the modes: part of their wanted
                            change that a tick makes, at least 0; other_gain plus other_leak must be
                            below 2 */
    pzs_real other_leak; /* leak of the patterns of voltages that are no combination of the modes:
                            part of such a pattern that a tick removes, from 0 to 1; if it is above
                            0, a tick takes (inputs)^2 more multiply-adds */
} pzs_modal_gains;

/*
 * Write the format number and the checksum into tables of gains and leaks of modes
 * (pzs_modal_gains) that a firmware has built itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_modal_gains_seal(pzs_modal_gains *tables);

/*
 * Block (stage of the control tick, in PZS_PHASE_READINGS) that gives each mode (a pattern of
 * voltages) a gain, the part of its wanted change that a tick makes, and a leak, the part of its
 * coordinate that a tick removes. Tables: pzs_modal_gains. Work of a tick: 3 * modes * inputs
 * multiply-adds. Errors of its initialisation: PZS_E_FORMAT, PZS_E_CRC, PZS_E_NONFINITE, and
 *   PZS_E_ARGUMENT  also for tables of other sizes, and for a gain or leak out of range; info.where
 *                   is then the index of the mode, or the number of modes for other_gain or
 *                   other_leak
 *   PZS_E_STAGE     the loop damps vibration (pzs_vibration_block), with gains of its own
 */
extern const pzs_block_type pzs_modal_gains_block;
#define PZS_MODAL_GAINS_BLOCK_BYTES(inputs, modes)                                                 \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_modal_gains_state)) +                                       \
                (3u * PZS_CONTROL_WIDTH(inputs) + 2u * PZS_FOURS(modes)) * sizeof(pzs_real))

/* ---- free functions of the target (lib/control/free_functions.c) ---------- */

/*
 * Tables of the free functions of a target: shapes, such as a piston or a tilt, that may be added
 * to it at no cost. The influence matrix of the controller lacks them, so that a structure moves
 * along them without a prediction of the model. The arrays are const and may stay in flash.
 */
typedef struct pzs_free_functions {
    uint32_t format, scene; /* format: format number of the tables of free functions (shapes that
                               may be added to the target at no cost); scene: hash of the scene file
                               from which `pzs tables` generated them, equal to the hash in the
                               controller's tables (pzs_problem) */
    uint32_t crc; /* checksum of the tables of free functions (shapes that may be added to the
                     target at no cost) and their array, computed by pzs_free_functions_seal */
    uint16_t outputs, count; /* number of outputs, and number of free functions (shapes that may be
                                added to the target at no cost), at least 1 */
    const pzs_real *value;   /* [count][outputs] displacement of each output in each free function
                                (shape that may be added to the target at no cost), 0 at outputs of
                                weight 0. The functions are orthonormal: the sum over the outputs of
                                the product of two is 1 for the same, otherwise 0 */
} pzs_free_functions;

/*
 * Write the format number and the checksum into tables of free functions (shapes that may be added
 * to the target at no cost) that a firmware has built itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_free_functions_seal(pzs_free_functions *tables);

/*
 * Block (stage of the control tick, in PZS_PHASE_READINGS) by which the supervisor compares shapes
 * without their components along the free functions, shapes that may be added to the target at no
 * cost. Tables: pzs_free_functions. Work of a tick, in multiply-adds of the supervisor: at most 2 *
 * PZS_FREE_SHAPES * count * outputs. Errors of its initialisation: PZS_E_FORMAT, PZS_E_CRC,
 * PZS_E_NONFINITE, and PZS_E_ARGUMENT for tables of other sizes.
 */
extern const pzs_block_type pzs_free_functions_block;
/*
 * Number of work arrays for shapes whose components along the free functions (shapes that may be
 * added to the target at no cost) are removed.
 */
#define PZS_FREE_SHAPES 3
#define PZS_FREE_FUNCTIONS_BLOCK_BYTES(outputs, count)                                             \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_free_functions_state)) +                                    \
                (PZS_FOURS(count) + PZS_FREE_SHAPES * (size_t)(outputs)) * sizeof(pzs_real))

/* ---- supervisor (lib/control/supervisor.c) --------------------------- */

/*
 * Operating modes of the supervisor, which decides in each tick whether the loop controls the
 * voltages. Where it does not, the supervisor ramps the voltages to the park voltages, the safe
 * voltages in its tables, on a straight line inside voltage limits and step limits.
 *
 *   mode        voltages                             event: next mode
 *   INITIALISE  ramp to the park voltages            command ARM: ARMED
 *   ARMED       ramp continues or has ended          ramp ended, all readings usable: RUNNING
 *   RUNNING     controlled from target and readings  no usable reading: HOLDING
 *   HOLDING     controlled from target and model     usable readings: RUNNING
 *   PARKING     ramp by the command PARK or FLAT     ramp ended: PARKED; command RESUME: ARMED
 *   PARKED      kept where this ramp has ended       command RESUME: ARMED
 *   STOPPING    ramp to the park voltages            ramp ended: LATCHED
 *   LATCHED     kept at the park voltages            none
 *   TESTING     ramps of the polarity test           test passed: RUNNING; failed: STOPPING
 *                                                    no usable reading: HOLDING
 */
typedef enum pzs_supervisor_mode {
    PZS_MODE_INITIALISE = 0, /* operating mode of the supervisor before the command PZS_COMMAND_ARM:
                                the voltages are at the park voltages (safe voltages of the
                                amplifiers) or on their way there */
    PZS_MODE_ARMED,   /* operating mode of the supervisor in which it waits until its ramp of the
                         voltages has ended and every reading of a tick is usable */
    PZS_MODE_RUNNING, /* operating mode of the supervisor in which the loop controls the voltages
                         from target and readings */
    PZS_MODE_HOLDING, /* operating mode of the supervisor in which the loop controls the voltages
                         from target and model alone, because no reading of this tick is usable */
    PZS_MODE_PARKING, /* operating mode of the supervisor in which, by command, the voltages ramp to
                         the park voltages (safe voltages of the amplifiers) or to the reference
                         voltages of the optimisation */
    PZS_MODE_PARKED,  /* operating mode of the supervisor in which, by command, the voltages stay at
                         the park voltages (safe voltages of the amplifiers) or at the reference
                         voltages of the optimisation */
    PZS_MODE_STOPPING, /* operating mode of the supervisor in which the voltages ramp to the park
                          voltages (safe voltages of the amplifiers) after an error or an alarm */
    PZS_MODE_LATCHED,  /* operating mode of the supervisor in which the voltages stay at the park
                          voltages (safe voltages of the amplifiers) after an error or an alarm,
                          until the next initialisation */
    /*
     * operating mode of the supervisor in which the voltages ramp towards the park voltages and
     * back, because the shape is opposite to the prediction: the answer of the structure tells
     * whether amplifiers have the wrong polarity or a load is the cause
     */
    PZS_MODE_TESTING,
    PZS_SUPERVISOR_MODES
} pzs_supervisor_mode;

/*
 * Commands of the program to the supervisor of a control loop. Events that change the operating
 * mode from many modes:
 *   event                                 from                             next mode
 *   pzs_loop_init                                                          INITIALISE
 *   command PARK (ramp to the park        all but STOPPING and LATCHED     PARKING
 *   voltages), FLAT (ramp to the
 *   reference voltages)
 *   command STOP, error of a block        all but LATCHED                  STOPPING
 *   time-out without readings, alarm of   RUNNING, HOLDING, TESTING        STOPPING
 *   the divergence monitor
 */
typedef enum pzs_supervisor_command {
    PZS_COMMAND_NONE = 0,
    PZS_COMMAND_ARM,    /* supervisor command: begin to control the voltages as soon as all readings
                           are usable */
    PZS_COMMAND_PARK,   /* supervisor command: ramp to the park voltages (safe voltages of the
                           amplifiers, set in the tables) and stay there */
    PZS_COMMAND_FLAT,   /* supervisor command: ramp to the reference voltages of the optimisation
                           (pzs_problem) and stay there */
    PZS_COMMAND_RESUME, /* supervisor command: control the voltages again after PZS_COMMAND_PARK or
                           PZS_COMMAND_FLAT */
    PZS_COMMAND_STOP /* supervisor command: emergency stop, which ramps to the park voltages (safe
                        voltages of the amplifiers) and ends the loop */
} pzs_supervisor_command;

/*
 * Events that change the operating mode of the supervisor. The events of one tick are processed in
 * the order of this enum, so that a later one prevails.
 */
typedef enum pzs_supervisor_event {
    PZS_EVENT_FRAME = 0, /* supervisor event: usable readings arrived; in PZS_MODE_ARMED: all
                            readings were usable, and the ramp of the voltages had ended */
    PZS_EVENT_NO_FRAME,  /* supervisor event: no reading was usable, or the target was not finite */
    PZS_EVENT_ARM, /* supervisor event: the program gave the command PZS_COMMAND_ARM, to let the
                      loop control the voltages */
    /*
     * supervisor event: the program gave the command PZS_COMMAND_PARK or PZS_COMMAND_FLAT, to ramp
     * the voltages to safe ones or to reference voltages and keep them there
     */
    PZS_EVENT_PARK,
    PZS_EVENT_RESUME,
    PZS_EVENT_STOP,
    PZS_EVENT_TIMEOUT, /* supervisor event: no reading was usable for pzs_supervision.timeout ticks
                        */
    PZS_EVENT_ALARM,   /* supervisor event: the divergence monitor found the measured shape
                          implausible for too long */
    PZS_EVENT_ERROR,   /* supervisor event: a stage of the control tick returned an error, or tables
                          are damaged */
    PZS_EVENT_ARRIVED, /* supervisor event: the ramp of the voltages to safe ones or to reference
                          voltages has ended */
    PZS_EVENTS
} pzs_supervisor_event;

/* Tables of the supervisor. All arrays are const and may stay in flash. */
typedef struct pzs_supervision {
    uint32_t format, scene; /* format: format number of the supervisor's tables; scene: hash of the
                               scene file from which `pzs tables` generated them, equal to the hash
                               in the controller's tables (pzs_problem) */
    uint32_t crc;           /* checksum of the supervisor's tables and their arrays, computed by
                               pzs_supervision_seal */
    uint16_t inputs;
    /*
     * number of consecutive ticks without usable readings after which the supervisor ends control
     * and ramps the voltages to the park voltages (safe voltages); 0: no time-out
     */
    uint16_t timeout;
    uint16_t ramp_ticks; /* shortest duration of a ramp of the voltages when the loop does not
                            control them (ticks), at least 1; step limits may make a ramp longer */
    /*
     * without a vibration damper: alarm threshold of the counter of implausible shapes. A tick with
     * an implausible measured shape raises this counter by one, any other tick lowers it by two;
     * above this value the supervisor gives an alarm. With a vibration damper: a period of the
     * first vibration mode (ticks); no shape is counted then, and a vibration that is implausible
     * for two such periods without falling gives the alarm. `pzs tables` writes 20, and with
     * observed modes the period or, where it tolerates vibration for longer, more; at least 20
     */
    uint16_t alarm_ticks;
    /*
     * with a vibration damper: alarm threshold of the same counter for a structure that moves
     * against its prediction, as with reversed amplifiers; a period of the first vibration mode
     * (ticks), at least 1
     */
    uint16_t polarity_ticks;
    uint16_t waits;       /* 1: the loop begins to control the voltages only after the command
                             PZS_COMMAND_ARM; 0: it begins without a command */
    const pzs_real *park; /* [inputs] park voltages: safe voltages to which the loop ramps when
                             control ends (V); they obey the limits of all voltages and of all sums
                             of voltages */
    pzs_real fading; /* factor, between 0 and 1, by which the tolerated deviation (measured minus
                        predicted shape) decays in each tick after a target change */
    pzs_real noise;  /* expected RMS noise of the measured shape (m), from which the divergence
                        monitor computes the deviation that it tolerates */
    pzs_real load;   /* RMS change of the shape that the largest expected sudden load causes (m) */
    pzs_real slack;  /* RMS motion of the predicted shape that hysteresis of the actuators may take
                        when they turn back, so that the structure does not move (m) */
} pzs_supervision;

/*
 * Write the format number and the checksum into supervisor tables that a firmware has built itself.
 * Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_supervision_seal(pzs_supervision *tables);

/* Results of the supervisor that a program may read. */
typedef struct pzs_supervisor_info {
    pzs_supervisor_mode mode;
    pzs_supervisor_event cause; /* event that made the supervisor end control; valid in
                                   PZS_MODE_STOPPING and PZS_MODE_LATCHED */
    uint32_t remaining; /* number of ticks until the end of the present ramp of the voltages to safe
                           ones or to reference voltages; 0: no ramp */
    pzs_real amplitude; /* amplitude (m) by which the measured shape deviates from the shape that
                           the model predicts; the divergence monitor of the supervisor compares it
                           with `threshold` */
    pzs_real threshold; /* amplitude of the deviation (measured minus predicted shape) above which
                           the divergence monitor of the supervisor counts a tick as implausible (m)
                         */
    bool is_opposed; /* whether the structure of a loop that damps vibration has moved against its
                        prediction since the last jump of the target, or not at all, as with
                        amplifiers of the wrong polarity */
    bool is_stuck;   /* whether all readings of a loop that damps vibration repeat although the
                        voltages should have moved the structure, because sensors or amplifiers have
                        stopped; the damper then ignores them (PZS_W_HELD) until one changes */
} pzs_supervisor_info;

typedef struct pzs_supervisor {
    pzs_supervisor_info info;
    pzs_supervisor_state state;
} pzs_supervisor;

/*
 * Give the supervisor of a control loop a command, which the next tick carries out; also from an
 * interrupt. A later command replaces it, except that PZS_COMMAND_STOP stays. A command that does
 * not apply to the present operating mode is ignored.
 *   supervisor in/out  returned by pzs_loop_find(&loop, &pzs_supervisor_block)
 * Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_supervisor_give(pzs_supervisor *supervisor, pzs_supervisor_command command);

/*
 * Return the duration (ticks) of a ramp of the supervisor, UINT32_MAX if a limit is infinite.
 * Inputs whose step limit is 0 do not count.
 *   pzs_supervisor_ramp          between two voltage vectors
 *   pzs_supervisor_longest_ramp  from anywhere inside the limits to the park voltages or to the
 *                                reference voltages of the optimisation
 *   from, to [inputs] in  voltages at the start and at the end (V)
 */
uint32_t pzs_supervisor_ramp(const pzs_supervision *tables, const pzs_problem *problem,
                             const pzs_real *from, const pzs_real *to);
uint32_t pzs_supervisor_longest_ramp(const pzs_supervision *tables, const pzs_problem *problem);

/*
 * Return the operating mode that follows `mode` after `event`, from the transition table of the
 * supervisor.
 */
pzs_supervisor_mode pzs_supervisor_next(pzs_supervisor_mode mode, pzs_supervisor_event event);

/*
 * Status of pzs_loop_tick in a loop with a supervisor:
 *   PZS_W_PARKED   before control begins, or by command: the voltages are parked or on their way
 *   PZS_W_RAMP     control is lost, the voltages are on their way to the park voltages; the program
 *                  must keep calling pzs_loop_tick
 *   PZS_E_LATCHED  the park voltages are published and the loop is over
 *   PZS_W_POLARITY the polarity test moves the voltages; control goes on after it, or ends
 *   others         the loop controls the voltages: status of the other stages of the tick
 *
 * A program that ticks until an error (top of this file) thus ends with the amplifiers at the park
 * voltages, after at most pzs_supervisor_longest_ramp ticks. Damaged limits (PZS_E_CRC with
 * info.block NULL) end the program at once, at the last voltages, which cannot be checked without
 * limits. So does any error in a loop without a supervisor.
 */

/*
 * Block (stage of the control tick, in PZS_PHASE_SUPERVISE) that decides whether the loop controls
 * the voltages or ramps them to the park voltages, which are safe.
 *   tables                             pzs_supervision
 *   memory returned by pzs_loop_find   pzs_supervisor
 * Errors of its initialisation: PZS_E_FORMAT, PZS_E_CRC, PZS_E_NONFINITE, and
 *   PZS_E_ARGUMENT  also for tables of other sizes
 *   PZS_E_LIMITS    the park voltage of input info.where is outside its voltage limits, or the park
 *                   voltages violate a limit of a sum of voltages
 */
extern const pzs_block_type pzs_supervisor_block;
#define PZS_SUPERVISOR_BLOCK_BYTES(outputs)                                                        \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_supervisor)) + 5u * (size_t)(outputs) * sizeof(pzs_real))

/* ---- vibration: modes observed and damped by the tick (lib/control/vibration.c) */

/*
 * Tables of the vibration damper: vibration modes of the structure and gains for one tick rate,
 * computed by the host. A modal coordinate is measured in metres: a vibration mode of coordinate 1
 * m moves the outputs by 1 m RMS. All arrays are const and may stay in flash.
 */
typedef struct pzs_vibration {
    uint32_t format, scene; /* format: format number of the vibration damper's tables; scene: hash
                               of the scene file from which `pzs tables` generated them, equal to
                               the hash in the controller's tables (pzs_problem) */
    uint32_t crc; /* checksum of the vibration damper's tables and their arrays, computed by
                     pzs_vibration_seal */
    uint16_t inputs, outputs, sensors, modes;
    uint16_t delay;          /* age of the sensor readings when a tick uses them (ticks) */
    const pzs_real *shape;   /* [outputs][modes] displacement of each output per coordinate of each
                                vibration mode (dimensionless) */
    const pzs_real *reading; /* [sensors][modes] reading of each sensor per coordinate of each
                                vibration mode (unit of the sensor per m); NULL: the sensors are the
                                outputs */
    const pzs_real *direct;  /* [sensors][inputs] static reading of each sensor per volt on each
                                input; NULL: the sensors are the outputs */
    const pzs_real *gain; /* [outputs][sensors] gain of the estimator of the static shape: change of
                             the shape (m) per residual of a reading (unit of the sensor); the
                             residual is the part of the deviation from the predicted reading that
                             vibration modes do not explain; NULL: the sensors are the outputs */
    const pzs_real *precision; /* [sensors] weight of each sensor in the observer: inverse variance
                                  of its noise, relative to the noise for which the observer was
                                  designed (dimensionless); NULL: all 1 */
    const pzs_real *modal; /* [modes][inputs] static coordinate of each vibration mode per volt on
                              each input (m/V) */
    /*
     * [4][modes] entries 11, 12, 21, 22 of a 2 x 2 matrix for each vibration mode (dimensionless).
     * By one tick the matrix advances a pair of numbers: the deviation of the modal coordinate from
     * static equilibrium, and the modal velocity divided by the angular frequency
     */
    const pzs_real *turn;
    /*
     * [3][modes][modes] observer gains, matrices that correct the estimated state of the vibration
     * modes: [0] modal coordinates, [1] modal velocities divided by angular frequencies, [2] static
     * modal coordinates under loads. Each multiplies the innovations (reading minus predicted
     * reading) projected on the mode shapes
     */
    const pzs_real *observer;
    const pzs_real *explain; /* [modes][modes] inverse of the normal matrix of the least-squares fit
                                that determines the coordinates of the vibration modes from sensor
                                readings */
    const pzs_real *damping; /* [modes][inputs] damping gradient of each input per deviation of a
                                vibration mode from static equilibrium (m/V). A tick that damps
                                vibration subtracts the damping gradient from half the gradient of
                                its objective */
    const pzs_real *inverse_angle; /* [modes] 1 / (angular frequency of each vibration mode times
                                      the duration of a tick) (1) */
    pzs_real share; /* factor, above 0 and at most 1, by which a tick that damps vibration
                       multiplies the gradient of its objective: the smaller, the more slowly the
                       voltages approach the static optimum */
    /*
     * weight (0 to 1) of the first of two estimates in their weighted mean. Each estimates how far
     * a vibration mode deviates from static equilibrium: the first from the change of the modal
     * velocity in a tick, the second from the modal coordinate
     */
    pzs_real mix;
    pzs_real slow; /* gain (0 to 1) of the low-pass filter of the residual readings, the part of the
                      readings that the vibration modes do not explain */
    /*
     * [2 + 2 modes] first-order lag of the amplifiers (dimensionless). [0]: part of its distance
     * from the commanded voltage that the output of an amplifier keeps over a tick; [1]: mean of
     * this part in the tick. Then for each mode the weight of its velocity, and for each mode that
     * of the distance [0], in the deviation that the voltages damp: the voltages change earlier by
     * the phase of the lag. NULL: the amplifiers follow within a tick
     */
    const pzs_real *lag;
} pzs_vibration;

/*
 * Write the format number and the checksum into vibration tables that a firmware has built itself.
 * Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_vibration_seal(pzs_vibration *tables);

/* Results of the vibration damper that a program may read. */
typedef struct pzs_damper_info {
    const pzs_real *position; /* [modes] estimated coordinate of each vibration mode at the present
                                 tick (m) */
    const pzs_real *velocity; /* [modes] estimated velocity of each vibration mode divided by its
                                 angular frequency (m) */
    const pzs_real *load; /* [modes] estimated static coordinate of each vibration mode due to loads
                             (m) */
    /*
     * amplitude of the vibration (m, RMS over the outputs): root of the sum over the vibration
     * modes of d^2 + (v / w)^2. Here d is the deviation of the modal coordinate from static
     * equilibrium, v the modal velocity and w the angular frequency
     */
    pzs_real deviation;
    /*
     * RMS over the sensors of the innovations (reading minus predicted reading) in the last tick,
     * less their low-passed values (m); 0 where no reading was usable.
     *
     * Another value is reported if every target node is measured and the target has free functions:
     * shapes, such as a tilt, that may be added to it at no cost. It is the RMS, weighted by
     * `precision`, of the part of the innovations that the observed vibration modes explain.
     */
    pzs_real innovation;
    int32_t where; /* index of the reading to which the last status of the vibration damper refers,
                      or -1 */
    bool is_repeated; /* whether no usable reading differed from that of the last tick */
} pzs_damper_info;

typedef struct pzs_damper {
    pzs_damper_info info;
    pzs_damper_state state;
} pzs_damper;

/*
 * PZS_DAMPER_BYTES: size of the workspace of a vibration damper (bytes). PZS_FOURS rounds a number
 * up to a multiple of 4.
 */
#define PZS_FOURS(n) (((size_t)(n) + 3u) / 4u * 4u)
#define PZS_DAMPER_BYTES(modes, inputs, sensors, delay)                                            \
    (sizeof(pzs_real) * (((size_t)(delay) + 15u) * PZS_FOURS(modes) +                              \
                         ((size_t)(delay) + 5u) * PZS_FOURS(sensors) + 2u * PZS_FOURS(inputs)) +   \
     (size_t)(sensors))
/* Size that the lag of amplifiers (pzs_vibration.lag) adds to this workspace (bytes). */
#define PZS_LAG_BYTES(modes, sensors)                                                              \
    (sizeof(pzs_real) * (3u * PZS_FOURS(modes) + 2u * PZS_FOURS(sensors)))

/*
 * Initialise a vibration damper in the workspace, for a structure in static equilibrium under the
 * present voltages. Control and tables must outlive it.
 * Errors: PZS_E_ARGUMENT (also for tables of other sizes), PZS_E_STAGE, PZS_E_FORMAT, PZS_E_CRC,
 * PZS_E_NONFINITE, PZS_E_WORKSPACE (info.where = bytes needed).
 */
pzs_status pzs_damper_init(pzs_damper *damper, pzs_control *control, const pzs_vibration *tables,
                           void *work, size_t bytes);

/*
 * Observe the vibration modes from the readings, estimate the static shape under the present
 * voltages and loads, and make the next pzs_tick damp the vibration. Pass the shape to that tick as
 * its measurement.
 *   readings [sensors] in   readings that were taken pzs_vibration.delay ticks ago; NULL: none
 *                           arrived; one that is stuck, not finite, or off by more than 1e12 is
 *                           replaced by its prediction plus the low-passed earlier deviation
 *   shape    [outputs] out  estimated static shape (m)
 * Warnings: PZS_W_SENSOR, PZS_W_HELD (no reading usable, modes only predicted). Errors:
 * PZS_E_ARGUMENT, PZS_E_STAGE.
 */
pzs_status pzs_damper_tick(pzs_damper *damper, const pzs_real *readings, pzs_real *shape);

/*
 * Predict the vibration modes over missed ticks, during which the amplifiers kept the present
 * voltages. To be called before the next tick; in a loop pzs_loop_skip does it. Errors:
 * PZS_E_ARGUMENT, PZS_E_STAGE.
 */
pzs_status pzs_damper_skip(pzs_damper *damper, uint16_t ticks);

/*
 * Block (stage of the control tick, in PZS_PHASE_SHAPE) that estimates and damps vibration; it
 * replaces the shape estimator. Tables: pzs_vibration. Memory returned by pzs_loop_find:
 * pzs_damper.
 */
extern const pzs_block_type pzs_vibration_block;
#define PZS_VIBRATION_BLOCK_BYTES(modes, inputs, outputs, sensors, delay)                          \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_damper)) +                                                  \
                PZS_ALIGNED(PZS_DAMPER_BYTES(modes, inputs, sensors, delay)) +                     \
                (size_t)(outputs) * sizeof(pzs_real))
/* Size of the same block where the tables have a lag of the amplifiers (bytes). */
#define PZS_VIBRATION_BLOCK_LAG_BYTES(modes, inputs, outputs, sensors, delay)                      \
    PZS_ALIGNED(PZS_VIBRATION_BLOCK_BYTES(modes, inputs, outputs, sensors, delay) +                \
                PZS_LAG_BYTES(modes, sensors) + 8u)

/* ---- governor: slows targets down in a loop that damps vibration (lib/control/governor.c) */

/*
 * Tables of the governor, a stage of the control tick that slows a moving target down so that the
 * vibration damper can follow it: in each tick the governor moves all voltages by the same fraction
 * of the way to their static optimum. In the list of blocks it comes after the feed-forward and
 * before the damper.
 */
typedef struct pzs_governor {
    pzs_real share; /* factor, above 0 and at most 1, by which a tick that damps vibration
                       multiplies the gradient of its objective, so that the voltages approach the
                       optimum slowly; equal to pzs_vibration.share */
    pzs_real part; /* limit of the speed at which the governor moves the target: largest change of a
                      voltage in a tick, divided by the step limit of the input, above 0 and at most
                      1 */
} pzs_governor;

/*
 * Memory of the governor, a stage of the control tick that slows a moving target down so that the
 * vibration damper can follow it.
 */
typedef struct pzs_governor_state {
    const pzs_governor *tables;
    pzs_control *control; /* controller of the loop, which computes the voltages of each tick; from
                             it the governor (which slows targets down) learns which voltages
                             pzs_hold keeps constant */
    /*
     * second controller, in which the governor (which slows targets down) computes the voltages
     * that are optimal for the target in static equilibrium
     */
    pzs_control optimum;
    /*
     * [3][inputs rounded up to a multiple of 4] three copies, against damaged memory, of the
     * voltages that the governor (which slows targets down) moves gradually to those that are
     * optimal for the target in static equilibrium (V)
     */
    pzs_real *reference;
    pzs_real *optimal; /* [3][inputs rounded up to a multiple of 4] three copies, against damaged
                          memory, of the voltages that are optimal for the target in static
                          equilibrium (V) */
    /*
     * [inputs] voltages (V) by which the governor, which slows targets down, corrects the target:
     * it subtracts the shape that the controller predicts for them. They are
     *   optimal voltages - r - (change of r in this tick) / share
     *   r      member `reference`, voltages that move gradually to the optimal ones
     *   share  part of the way to its target that a tick goes (pzs_governor.share)
     * With this correction the voltages of the loop follow r.
     */
    pzs_real *ahead;
    pzs_real *target; /* [outputs] target shape for which the voltages that are optimal in static
                         equilibrium were computed (m) */
    pzs_real *wanted; /* [outputs] target shape that the governor has slowed down for the vibration
                         damper (m) */
    uint32_t gradient_sum; /* exclusive or of the words of the gradients that the second controller
                              keeps from target to target */
    bool has_target;       /* whether the optimal voltages belong to the target shape in the array
                              `target` */
} pzs_governor_state;

/*
 * Block (stage of the control tick, in PZS_PHASE_READINGS) that slows a moving target down so that
 * the vibration damper can follow it: the governor. Tables: pzs_governor. Memory returned by
 * pzs_loop_find: pzs_governor_state.
 */
extern const pzs_block_type pzs_governor_block;
#define PZS_GOVERNOR_BLOCK_BYTES(inputs, outputs)                                                  \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_governor_state)) +                                          \
                PZS_ALIGNED(PZS_CONTROL_BYTES(inputs, outputs)) +                                  \
                sizeof(pzs_real) * (7u * PZS_FOURS(inputs) + 2u * (size_t)(outputs)))

/* ---- feed-forward of known loads and temperatures (lib/control/feed_forward.c) */

/*
 * Table of the feed-forward, which compensates known loads: change of the shape, or of the
 * readings, per unit of loads and temperatures whose values the firmware knows. All arrays are
 * const and may stay in flash.
 */
typedef struct pzs_feed_forward_table {
    uint32_t format, scene; /* format: format number of the feed-forward table; scene: hash of the
                               scene file from which `pzs tables` generated it, to be compared with
                               the hash in other tables */
    uint32_t crc;           /* checksum of the feed-forward table and its array, computed by
                               pzs_feed_forward_seal */
    uint16_t inputs, outputs;
    const pzs_real *sensitivity; /* [outputs][inputs] change of the shape per unit of each known
                                    load or temperature (m/N, m/Pa or m/K) */
} pzs_feed_forward_table;

/*
 * Write the format number and the checksum into a feed-forward table that a firmware has built
 * itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_feed_forward_seal(pzs_feed_forward_table *table);

/*
 * Check a table that holds the effects of known loads, pzs_feed_forward_table, once at start-up.
 * Errors: PZS_E_ARGUMENT, PZS_E_FORMAT, PZS_E_CRC, PZS_E_NONFINITE.
 */
pzs_status pzs_feed_forward_check(const pzs_feed_forward_table *table);

/*
 * Subtract the effect of known loads from a shape or from readings, so that the controller
 * compensates them before they act. Call the function before each tick for the measured shape (with
 * a shape estimator: for the readings) and for the target shape.
 *   table           in      one row for each output; for readings one for each sensor
 *   value [inputs]  in      values of the known loads (unit of each load): for a measurement at its
 *                           time, for the target the coming ones
 *   shape [outputs] in/out  shape, or readings (m, or unit of each sensor)
 * Errors: PZS_E_ARGUMENT, PZS_E_NONFINITE (the shape is unchanged).
 */
pzs_status pzs_feed_forward(const pzs_feed_forward_table *table, const pzs_real *value,
                            pzs_real *shape);

/*
 * Tables of the stage of the control tick that compensates known loads: one table with the effect
 * of the loads on the shape, and one with their effect on the sensor readings.
 */
typedef struct pzs_known_loads {
    const pzs_feed_forward_table *shape;    /* [outputs][loads] change of the shape (m) per unit of
                                               each known load */
    const pzs_feed_forward_table *readings; /* [sensors][loads] change of each reading (unit of the
                                               sensor) per unit of each known load; NULL: the
                                               readings are the measured shape */
} pzs_known_loads;

/*
 * Block (stage of the control tick, in PZS_PHASE_READINGS) that subtracts the effects of known
 * loads from readings and target. Tables: pzs_known_loads. Its tick returns PZS_E_NONFINITE for a
 * load value that is not finite.
 */
extern const pzs_block_type pzs_feed_forward_block;
#define PZS_FEED_FORWARD_BLOCK_BYTES(sensors, outputs)                                             \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_feed_forward_state)) +                                      \
                ((size_t)(sensors) + (size_t)(outputs)) * sizeof(pzs_real))

/* ---- hysteresis and creep of the actuators (lib/control/hysteresis.c) --- */

/*
 * Tables of hysteresis and creep of the electrodes, identified from a measured sweep (`pzs
 * calibrate --hysteresis`). The effect u of an electrode is the voltage that an electrode without
 * hysteresis would need for the same displacement:
 *
 *   u = offset + m(s) + sum_i a_i P_i + sum_j x_j,  s = v - middle
 *   u, v  effect and voltage (V)
 *   m     piecewise linear function through 0 with four slopes, one for each quarter of the range
 *   P_i   position of play i, an element with backlash (V): constant while |s - P_i| is less than
 *         its slack, then moving with s
 *   a_i   weight of play i: `above` for positive and `below` for negative P_i
 *   x_j   creep (V): goes the part creep_rate[j] of the way to creep[j] v in each tick
 *
 * All arrays are const and may stay in flash.
 */
#define PZS_HYSTERESIS_SEGMENTS 4u
/* Largest number of plays (elements with backlash) in the hysteresis model of an electrode. */
#define PZS_PLAY_LIMIT 32u
/* Largest number of creep terms in the hysteresis model of an electrode. */
#define PZS_CREEP_LIMIT 8u
/*
 * Smallest allowed slope of the piecewise linear part of the effect of an electrode
 * (dimensionless). The effect is the voltage that an electrode without hysteresis would need for
 * the same displacement.
 */
#define PZS_LEAST_SLOPE PZS_R(0.001)

typedef struct pzs_hysteresis {
    uint32_t format, scene; /* format: format number of the hysteresis tables; scene: hash of the
                               scene file from which `pzs tables` generated them, equal to the hash
                               in the controller's tables (pzs_problem) */
    uint32_t crc;           /* checksum of the hysteresis tables and their arrays, computed by
                               pzs_hysteresis_seal */
    uint16_t inputs;
    uint16_t sets; /* number of sets of hysteresis parameters: 1 for all electrodes together,
                      otherwise one for each input */
    uint16_t plays, creeps;
    const pzs_real *middle;     /* [parameter sets: 1 or inputs] middle of the voltage range (V) */
    const pzs_real *half_range; /* [parameter sets: 1 or inputs] half of the voltage range (V) */
    /*
     * [parameter sets: 1 or inputs] constant part of the effect of an electrode (V): the effect in
     * the middle of the voltage range while the plays (elements with backlash) and creep terms are
     * at 0. The effect is the voltage that would cause the strain without hysteresis
     */
    const pzs_real *offset;
    /*
     * [parameter sets: 1 or inputs][4] slopes of the piecewise linear part of an electrode's effect
     * (voltage that would move the structure as far without hysteresis), from the lowest quarter of
     * the voltage range to the highest, at least PZS_LEAST_SLOPE (dimensionless)
     */
    const pzs_real *slope;
    const pzs_real *slack; /* [parameter sets: 1 or inputs][plays] slack of each play (element with
                              backlash that models hysteresis) of an electrode: half the width of
                              its backlash, above 0 and ascending (V) */
    const pzs_real *above; /* [parameter sets: 1 or inputs][plays] weight of each play (element with
                              backlash) while its position is positive, at least 0 (dimensionless):
                              the weight times the position is added to the effect of the electrode
                              (voltage that would move the structure as far without hysteresis) */
    const pzs_real *below; /* [parameter sets: 1 or inputs][plays] weight of each play (element with
                              backlash) while its position is negative, at least 0 (dimensionless):
                              the weight times the position is added to the effect of the electrode
                              (voltage that would move the structure as far without hysteresis) */
    const pzs_real *creep; /* [parameter sets: 1 or inputs][creeps] final value of each creep term
                              per volt on the electrode, at least 0 (dimensionless); creep terms add
                              to the effect of the electrode (voltage that would cause its strain
                              without hysteresis) */
    const pzs_real *creep_rate; /* [creeps] part (0 to 1) of the way to its final value by which
                                   each creep term moves in a tick */
    /*
     * Measured hysteresis model of the electrodes, the members `identified_...`. The fault detector
     * uses it, because it must predict how far the ceramic really moves. The compensation uses the
     * members without this prefix, which may describe less hysteresis, so that its inverse is
     * robust. NULL: both models are equal.
     */
    const pzs_real *identified_offset; /* [parameter sets: 1 or inputs] measured hysteresis model,
                                          constant part of the effect of an electrode (V): the
                                          effect (voltage that would move the structure as far
                                          without hysteresis) in the middle of the voltage range */
    /*
     * [parameter sets: 1 or inputs][4] measured hysteresis model, slopes of the piecewise linear
     * part of the effect of an electrode (voltage that would move the structure as far without
     * hysteresis) in the four quarters of the voltage range (dimensionless)
     */
    const pzs_real *identified_slope;
    const pzs_real *identified_above; /* [parameter sets: 1 or inputs][plays] measured hysteresis
                                         model, weight of each play (element with backlash) while
                                         its position is positive (dimensionless): the weight times
                                         the position is added to the effect of the electrode
                                         (voltage that would move the structure as far without
                                         hysteresis) */
    const pzs_real *identified_below; /* [parameter sets: 1 or inputs][plays] measured hysteresis
                                         model, weight of each play (element with backlash) while
                                         its position is negative (dimensionless): the weight times
                                         the position is added to the effect of the electrode
                                         (voltage that would move the structure as far without
                                         hysteresis) */
} pzs_hysteresis;

/*
 * Write the format number and the checksum into hysteresis tables that a firmware has built itself.
 * Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_hysteresis_seal(pzs_hysteresis *tables);

/* Results of the compensation of hysteresis that a program may read. */
typedef struct pzs_compensator_info {
    const pzs_real *effect; /* [inputs] effects of the voltages of the last tick: the voltages that
                               electrodes without hysteresis would need for the same displacement
                               (V) */
} pzs_compensator_info;

typedef struct pzs_compensator {
    pzs_compensator_info info;
    pzs_compensator_state state;
} pzs_compensator;

/*
 * Compensation of hysteresis and creep by two blocks (stages of the control tick) with common
 * tables. The effect of a voltage is the voltage that an electrode without hysteresis would need;
 * the influence matrix is the displacement per volt of effect.
 *
 *   - pzs_effect_block, in PZS_PHASE_READINGS and first in the list, replaces the last voltages and
 *     the limits of this tick by effects. The blocks between these two work with effects.
 *   - pzs_inverse_block, the first one of PZS_PHASE_VOLTAGE, restores the voltages that have the
 *     chosen effects. They stay inside voltage limits and step limits to the last bit.
 *   - Without a target or readings the effects are kept, and the voltages follow the creep.
 *   - A wrong state of hysteresis is forgotten after the next large change of voltage.
 *
 * Memory of the effect block, returned by pzs_loop_find: pzs_compensator. Errors of its
 * initialisation: PZS_E_FORMAT, PZS_E_CRC, and
 *   PZS_E_ARGUMENT  also for tables of other sizes, and where sums of voltages are limited, because
 *                   such limits do not hold for effects
 *   PZS_E_STAGE     no inverse block in the list
 *   PZS_E_LIMITS    input info.where has an infinite voltage limit, or parameters outside the
 *                   ranges that pzs_hysteresis states
 */
extern const pzs_block_type pzs_effect_block, pzs_inverse_block;
#define PZS_EFFECT_BLOCK_BYTES(inputs, plays, creeps)                                              \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_compensator)) +                                             \
                (4u + (size_t)(plays) + (size_t)(creeps)) * (size_t)(inputs) * sizeof(pzs_real))
#define PZS_INVERSE_BLOCK_BYTES(inputs) (0u * (size_t)(inputs) * sizeof(pzs_real))

/* ---- actuators that are not linear (lib/control/actuator_curve.c) ------- */

/* Largest number of points of an actuator curve. */
#define PZS_CURVE_POINTS 128u

/*
 * Curves of actuators whose displacement is not proportional to their voltage v. The effect e of an
 * actuator is the function of its voltage to which its displacement is proportional, in any unit;
 * the influence matrix is the displacement per unit of effect. Between two points (v0, e0) and (v1,
 * e1) of a curve
 *
 *   e = e0 + (e1 - e0) t (1 - b (1 - t)),  t = (v - v0) / (v1 - v0),  with the bend b
 *
 * A measured curve has the bend 0, which gives straight lines. The square e = v^2 of an
 * electrostatic actuator has two points, at its voltage limits v0 >= 0 and v1, and the bend
 * (v1 - v0) / (v1 + v0). All arrays are const and may stay in flash.
 */
typedef struct pzs_actuator_curves {
    uint32_t format, scene; /* format: format number of the actuator curves; scene: hash of the
                               scene file from which `pzs tables` generated them, equal to the hash
                               in the controller's tables (pzs_problem) */
    uint32_t crc;           /* checksum of the actuator curves and their arrays, computed by
                               pzs_actuator_curves_seal */
    uint16_t inputs;
    uint16_t sets;   /* number of actuator curves: 1 for all actuators together, otherwise one for
                        each input */
    uint16_t points; /* number of points of each actuator curve, from 2 to PZS_CURVE_POINTS */
    const pzs_real *voltage; /* [curves: 1 or inputs][points] voltages of the points of an actuator
                                curve, ascending; the first is at most the lower voltage limit and
                                the last at least the upper one (V) */
    const pzs_real *effect;  /* [curves: 1 or inputs][points] effects at the points of an actuator
                                curve, ascending; the displacement of an actuator is proportional to
                                its effect */
    const pzs_real *bend; /* [curves: 1 or inputs][points - 1] bend of each segment of an actuator
                             curve, from -1 to 1 (dimensionless): 0 for a straight line, see the
                             formula above; NULL: all are 0 */
} pzs_actuator_curves;

/*
 * Write the format number and the checksum into actuator curves that a firmware has built itself.
 * Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_actuator_curves_seal(pzs_actuator_curves *tables);

/*
 * Memory of pzs_curve_block, the block (stage of the control tick) that replaces voltages by their
 * effects, values to which the displacements of the actuators are proportional; pzs_loop_find
 * returns it.
 */
typedef struct pzs_actuator_effects {
    const pzs_real *effect; /* [inputs] effects of the voltages from which the last tick started, to
                               which the displacements of the actuators are proportional */
} pzs_actuator_effects;

/*
 * Control of actuators that are not linear, by two blocks (stages of the control tick) with common
 * tables pzs_actuator_curves. They give the effect of each voltage, to which the displacement of
 * the actuator is proportional.
 *
 *   - pzs_curve_block, in PZS_PHASE_READINGS and first in the list, replaces the last voltages and
 *     the limits of this tick by effects. The blocks between these two work with effects.
 *   - pzs_curve_inverse_block, the first one of PZS_PHASE_VOLTAGE, restores the voltages that have
 *     the chosen effects. They stay inside voltage limits and step limits to the last bit, and can
 *     reach these limits exactly.
 *   - The work of a tick is bounded, for each input 7 bisections of each curve lookup.
 *
 * Errors of the initialisation, besides PZS_E_FORMAT and PZS_E_CRC:
 *
 *   - PZS_E_ARGUMENT: the tables have other sizes than the controller; or sums of voltages are
 *     limited, and such limits do not hold for effects (values to which the displacements of the
 *     actuators are proportional); or there is regularisation, and at input info.where the effect
 *     of the reference voltage differs from the reference voltage.
 *   - PZS_E_STAGE: no curve inverse block with these tables is in the list, or hysteresis is
 *     compensated beside the curves.
 *   - PZS_E_LIMITS: the curve of input info.where is not finite or not ascending, has a segment
 *     whose bend lies outside -1 to 1, or ends inside the voltage limits.
 *
 * Vibration damper, governor, self-test and both fault detectors assume linear actuators. Their
 * blocks are refused beside curves with PZS_E_STAGE.
 */
extern const pzs_block_type pzs_curve_block, pzs_curve_inverse_block;
#define PZS_CURVE_BLOCK_BYTES(inputs)                                                              \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_actuator_effects)) + (size_t)(inputs) * sizeof(pzs_real))
#define PZS_CURVE_INVERSE_BLOCK_BYTES(inputs) (0u * (size_t)(inputs) * sizeof(pzs_real))

/* ---- amplifiers with converter steps and a dead band (lib/control/amplifier.c) */

/*
 * Replace the voltages control.info.voltage, chosen by pzs_tick, by those that amplifiers with
 * converter steps and a dead band give. After a change of more than dead_band an amplifier gives
 * the last multiple of `step` on the way to the wanted voltage, inside voltage limits and step
 * limits.
 *   given [inputs] in/out  voltages that the amplifiers give (V); at the start those of
 *                          control.info.voltage, afterwards kept by this function
 *   step           in      smallest voltage step of the converter (V); 0: none
 *   dead_band      in      largest change that an amplifier does not follow (V)
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 */
pzs_status pzs_quantise(pzs_control *control, pzs_real *given, pzs_real step, pzs_real dead_band);

/* Tables of amplifiers with converter steps and a dead band. */
typedef struct pzs_amplifier {
    pzs_real step;      /* step between two voltages that the digital-to-analogue converter of the
                           amplifiers can give (V); 0: no steps */
    pzs_real dead_band; /* largest change of the wanted voltage that an amplifier does not follow,
                           its dead band (V) */
} pzs_amplifier;

/*
 * Block (stage of the control tick, in PZS_PHASE_VOLTAGE) that changes the chosen voltages as
 * amplifiers with converter steps and a dead band do. Tables: pzs_amplifier.
 */
extern const pzs_block_type pzs_amplifier_block;
#define PZS_AMPLIFIER_BLOCK_BYTES(inputs)                                                          \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_amplifier_state)) + (size_t)(inputs) * sizeof(pzs_real))

/* ---- fault detector: dead and stuck electrodes (lib/control/faults.c) -- */

/*
 * The fault detector for structures that do not vibrate finds electrodes that do not follow their
 * amplifiers, from the measured shape alone, and keeps their voltages constant.
 *
 *   - Test: a suspected electrode is set for about ten ticks to two voltages in turn, one test
 *     amplitude above and below its voltage, inside all limits. The controller compensates with the
 *     other electrodes. At most PZS_TEST_SIGNALS electrodes are tested at a time.
 *   - Detection takes 12 ticks plus the delay of the sensors, for an electrode that loses more than
 *     two test amplitudes at once or does not follow a command of that size.
 *   - While more than an eighth of the outputs is not measured, no electrode is observed.
 *   - On a structure that vibrates, or with strong hysteresis, the detector suspects healthy
 *     electrodes, because it assumes static shapes.
 *   - In a loop with the vibration damper the detector finds nothing; use pzs_pulse_detector_block
 *     there.
 */

typedef enum pzs_electrode_state {
    PZS_ELECTRODE_OBSERVED = 0,
    PZS_ELECTRODE_TESTED,       /* electrode state: the fault detector applies a test signal to the
                                   electrode */
    PZS_ELECTRODE_CLEARED,      /* electrode state: the electrode has passed a test, and the fault
                                   detector does not suspect it again for some time */
    PZS_ELECTRODE_UNOBSERVABLE, /* electrode state: the electrode cannot be tested, because the
                                   shape does not depend on its voltage, or the effect of its
                                   voltage is a combination of the effects of other electrodes */
    PZS_ELECTRODE_HELD /* electrode state: the electrode was found faulty, and its voltage is kept
                          constant until pzs_release */
} pzs_electrode_state;

/* Settings of the fault detector that a program may change after pzs_fault_detector_init. */
typedef struct pzs_fault_detector_settings {
    /*
     * [inputs] amplitude of the test signal on each electrode (V), at most half the step limit; 0:
     * the electrode is not tested. Default: just below half the step limit, but at most 1/32 of the
     * voltage range
     */
    pzs_real *amplitude;
} pzs_fault_detector_settings;

/* Results of the fault detector that a program may read. */
typedef struct pzs_fault_detector_info {
    const uint8_t *electrode; /* [inputs] state of each electrode, a value of pzs_electrode_state */
    int32_t where;  /* index of the input to which the last status of the fault detector refers, or
                       -1 */
    uint16_t found; /* number of faulty electrodes detected since the initialisation */
    uint16_t unobservable; /* number of electrodes that the fault detector cannot test, because the
                              shape does not depend on their voltages or other electrodes have the
                              same effects */
} pzs_fault_detector_info;

typedef struct pzs_fault_detector {
    pzs_fault_detector_settings settings;
    pzs_fault_detector_info info;
    pzs_fault_detector_state state;
} pzs_fault_detector;

/* Size of the workspace of a fault detector (bytes). */
#define PZS_FAULT_DETECTOR_BYTES(inputs, outputs, delay)                                           \
    (sizeof(pzs_real) * (PZS_DENSE(inputs) + ((size_t)(delay) + 8u) * (size_t)(inputs) +           \
                         2u * (size_t)(outputs)) +                                                 \
     sizeof(uint32_t) * ((size_t)(inputs) / PZS_TILE + 2u) +                                       \
     (sizeof(uint16_t) + 2u) * (size_t)(inputs) + (size_t)(outputs))

/*
 * Initialise a fault detector, which observes the electrodes from the present voltages of the
 * controller on.
 *   control in/out  an initialised controller, which must outlive the detector
 *   delay   in      age of the measured shapes (ticks), at most PZS_DELAY_LIMIT
 *   work    in      memory of the caller, aligned for pzs_real, at least PZS_FAULT_DETECTOR_BYTES
 *
 * If `delay` is not 0, pass this corrected shape to pzs_tick and pzs_fault_detector_tick (a voltage
 * that pzs_hold keeps constant counts in both predictions):
 *   shape measured `delay` ticks ago + shape predicted for the present voltages
 *       - shape predicted for the voltages at the time of the measurement
 *
 * Errors: PZS_E_STAGE, PZS_E_NONFINITE, and
 *   PZS_E_ARGUMENT   also where sums of voltages are limited: a test signal could violate a limit
 *   PZS_E_WORKSPACE  info.where = bytes needed
 */
pzs_status pzs_fault_detector_init(pzs_fault_detector *detector, pzs_control *control,
                                   uint16_t delay, void *work, size_t bytes);

/*
 * Run the fault detector for electrodes after each pzs_tick (and pzs_quantise). Until pzs_release
 * the voltage of a dead electrode is kept at 0 V, that of any other faulty one at its last value.
 *   measured [outputs] in  measured shape that was passed to pzs_tick (m); NULL: none
 * Warning, errors: PZS_E_ARGUMENT, PZS_E_STAGE, and
 *   PZS_W_ELECTRODE  electrodes were found faulty and have the state PZS_ELECTRODE_HELD; info.where
 *                    = input of the first
 */
pzs_status pzs_fault_detector_tick(pzs_fault_detector *detector, const pzs_real *measured);

/* Tables of the fault detector for electrodes of structures that do not vibrate. */
typedef struct pzs_fault_detection {
    uint16_t delay;     /* delay of the measured shapes (ticks), at most PZS_DELAY_LIMIT */
    pzs_real amplitude; /* amplitude of the test signals (V), at most half the step limit; 0: the
                           default of pzs_fault_detector_settings */
} pzs_fault_detection;

/*
 * Block (stage of the control tick, in PZS_PHASE_OBSERVE) that finds electrodes which do not follow
 * their amplifiers, on a structure that does not vibrate. Tables: pzs_fault_detection. Memory
 * returned by pzs_loop_find: pzs_fault_detector.
 */
extern const pzs_block_type pzs_fault_detector_block;
#define PZS_FAULT_DETECTOR_BLOCK_BYTES(inputs, outputs, delay)                                     \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_fault_detector)) +                                          \
                PZS_FAULT_DETECTOR_BYTES(inputs, outputs, delay))

/* ---- self-test of the wiring before the loop starts (lib/control/selftest.c) */

/*
 * The self-test finds amplifiers and sensors that do not respond, respond with the wrong sign or a
 * wrong gain, or have exchanged cables, before the loop controls the voltages. It moves each
 * amplifier in turn by a small voltage and compares the readings with the influence matrix. A
 * program needs no call for the test.
 *
 *   - The test takes at most PZS_SELFTEST_TICKS ticks, which return PZS_W_SELFTEST. No other stage
 *     of the tick runs. Without a fault, its last tick is the first in which the loop controls the
 *     voltages.
 *   - After a fault this tick and all later ones return PZS_E_SELFTEST and keep the voltages before
 *     the test. pzs_loop_find(&loop, &pzs_selftest_block) returns the findings; pzs_selftest_accept
 *     makes the loop run despite them.
 */

/*
 * What disturbs the self-test, and what the self-test does to the structure:
 *   - If noise or vibration hides the response of an amplifier, the loop does not begin to control.
 *   - A sensor that no amplifier moves enough is not tested and does not prevent control.
 *   - The voltages obey voltage limits and step limits, and end where they began.
 *   - Let a pulse last at least 5.4 periods of a vibration mode. The vibration that it leaves in
 *     this mode is below 1 % of the static response to the height of the pulse.
 *   - A vibration of such a mode by other causes changes a measured response by less than 3 % of
 *     its amplitude. Constant loads and linear drift hardly change measured responses.
 */
typedef enum pzs_wiring_state {
    PZS_WIRING_UNTESTED = 0,
    PZS_WIRING_HEALTHY,
    PZS_WIRING_UNOBSERVABLE, /* self-test finding: the response expected from the influence matrix
                                is too small, compared with noise and vibration, to be tested */
    PZS_WIRING_SILENT,   /* self-test finding: no sensor responds to the amplifier, or the sensor
                            responds to no amplifier */
    PZS_WIRING_REVERSED, /* self-test finding: the measured response of the amplifier or sensor has
                            the wrong sign */
    PZS_WIRING_SWAPPED, /* self-test finding: cables are exchanged, because the measured response is
                           the one expected of the amplifier or sensor with the index
                           pzs_wiring.other */
    PZS_WIRING_GAIN, /* self-test finding: the gain of the amplifier or sensor differs from the mean
                        gain of all amplifiers by more than the tolerance in the tables; or the mean
                        gain is below 0.15 or above 2, and all responding amplifiers have this state
                      */
    PZS_WIRING_UNKNOWN, /* self-test finding: the measured response of the amplifier (or sensor)
                           does not resemble any modelled response, neither its own nor that of
                           another amplifier (or sensor) */
    PZS_WIRING_NOISY    /* self-test finding: the noise of the sensor exceeds the value in
                           pzs_selftest_tables.noise */
} pzs_wiring_state;

/*
 * Value that means "none" in the members `other` and `similar` of pzs_wiring, which otherwise hold
 * the index of an amplifier or sensor.
 */
#define PZS_WIRING_NONE 0xFFFFu

/* Finding of the self-test about one amplifier with its electrode, or about one sensor. */
typedef struct pzs_wiring {
    pzs_real gain; /* gain of an amplifier or sensor: measured response divided by the response that
                      the influence matrix predicts (dimensionless) */
    uint16_t other;   /* index of the other amplifier or sensor where cables are exchanged
                         (PZS_WIRING_SWAPPED): of the amplifier whose electrode this amplifier
                         drives, or of the sensor whose signal arrives as the reading of this
                         sensor */
    uint16_t similar; /* index of another amplifier (or sensor) with so similar a response that the
                         self-test would not notice if the cables of both were exchanged;
                         PZS_WIRING_NONE: there is none */
    uint8_t state;    /* finding of the self-test, a value of pzs_wiring_state */
} pzs_wiring;

/* Tables of the self-test. All arrays are const and may stay in flash. */
typedef struct pzs_selftest_tables {
    uint32_t format, scene; /* format: format number of the self-test's tables; scene: hash of the
                               scene file from which `pzs tables` generated them, equal to the hash
                               in the controller's tables (pzs_problem) */
    uint32_t crc;           /* checksum of the self-test's tables and their arrays, computed by
                               pzs_selftest_seal */
    uint16_t inputs, sensors;
    uint16_t delay;         /* age of the sensor readings when a tick uses them (ticks), at most
                               PZS_DELAY_LIMIT */
    uint16_t pulse_ticks;   /* duration of a test pulse (ticks), at least PZS_LEAST_PULSE_TICKS */
    const pzs_real *direct; /* [sensors][inputs] static reading of each sensor per volt on each
                               input; NULL: the sensors are the outputs, and the static readings
                               are the entries of the influence matrix */
    const pzs_real *amplitude; /* [inputs] height of the test pulse of each input, at most half the
                                  voltage range and at most a quarter of pulse_ticks times the step
                                  limit (V); 0: the input is not tested */
    const pzs_real *scale;   /* [sensors] factor, at least 0, that makes readings of different units
                                comparable (1 / unit of each sensor) */
    const pzs_real *noise;   /* [sensors] largest plausible RMS noise of each sensor (unit of each
                                sensor) */
    pzs_real gain_tolerance; /* largest plausible difference between the gain of an amplifier or
                                sensor and the mean gain of all amplifiers, divided by this mean
                                gain, above 0 (dimensionless) */
} pzs_selftest_tables;

#define PZS_LEAST_PULSE_TICKS 16u /* shortest duration of a test pulse of the self-test (ticks) */

/*
 * Threshold above which the self-test examines an amplifier or a sensor: sum of squares of its
 * modelled response, divided by that of noise and vibration (dimensionless). The response of an
 * amplifier has an entry for each sensor, that of a sensor an entry for each amplifier.
 */
#define PZS_SELFTEST_JUDGED PZS_R(400)
/*
 * Variance of the noise in the responses that the self-test measures. With the pulse p and weights
 * e and o of the readings, a response is
 *   (sum of reading * e) / (sum of p * e)
 * and a second sum with the weights o detects vibration. For white noise of variance 1 in the
 * readings, both sums together have this number / N as variance, divided by (sum of p * e)^2
 * (dimensionless, for large N):
 *   N * (sum of e^2 + sum of o^2) / (sum of p e)^2
 *   N     number of ticks in a pulse, over which the sums extend
 *   e, o  weights of the readings: symmetric and antisymmetric in time
 *   p     voltage of a pulse of height 1
 */
#define PZS_SELFTEST_NOISE_ENERGY PZS_R(12.6)

/*
 * Write the format number and the checksum into tables of the self-test that a firmware has built
 * itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_selftest_seal(pzs_selftest_tables *tables);

/*
 * Work after which a tick of the self-test's evaluation ends. The work of comparing a measured with
 * a modelled response is the number of entries of one response plus PZS_SELFTEST_STEP_WORK. A
 * comparison is not interrupted, so that a tick may exceed its limit by less than one comparison.
 */
#define PZS_SELFTEST_WORK 768u
#define PZS_SELFTEST_STEP_WORK 16u

/*
 * PZS_SELFTEST_EVALUATION_WORK: work of the whole evaluation of a self-test in the worst case, in
 * which every amplifier and every sensor has a fault (in the unit of PZS_SELFTEST_WORK).
 */
#define PZS_SELFTEST_LINES(inputs, sensors) ((uint64_t)(inputs) + (uint64_t)(sensors))
#define PZS_SELFTEST_STAGE_WORK(inputs, sensors)                                                   \
    ((uint64_t)(inputs) * (uint64_t)(sensors) +                                                    \
     PZS_SELFTEST_STEP_WORK * (PZS_SELFTEST_LINES(inputs, sensors) + 1u))
#define PZS_SELFTEST_EVALUATION_WORK(inputs, sensors)                                              \
    ((6u * PZS_SELFTEST_LINES(inputs, sensors) + 7u) * PZS_SELFTEST_STAGE_WORK(inputs, sensors) +  \
     3u * PZS_SELFTEST_LINES(inputs, sensors) *                                                    \
         (PZS_SELFTEST_LINES(inputs, sensors) + PZS_SELFTEST_STEP_WORK))

/*
 * Largest number of ticks of a self-test, the sum of:
 *   - two pulse durations in which all amplifiers move together;
 *   - two pulse durations in which noise and vibration are measured without motion;
 *   - one pulse for each input, with 8 operations for each sensor and input in a tick;
 *   - the evaluation, for the case that every amplifier and sensor has a fault; without faults it
 *     takes about a third.
 */
#define PZS_SELFTEST_TICKS(inputs, sensors, pulse_ticks, delay)                                    \
    (((uint32_t)(inputs) + 4u) * (uint32_t)(pulse_ticks) + (uint32_t)(delay) + 4u +                \
     (uint32_t)(PZS_SELFTEST_EVALUATION_WORK(inputs, sensors) / PZS_SELFTEST_WORK))

typedef enum pzs_selftest_verdict {
    PZS_SELFTEST_RUNNING = 0,
    PZS_SELFTEST_PASSED,
    PZS_SELFTEST_FAULTY,    /* self-test verdict: the self-test has found a fault of at least one
                               amplifier or sensor */
    PZS_SELFTEST_DISTURBED, /* self-test verdict: vibration or noise hides the response to the test
                               pulse of at least one amplifier, whose state is
                               PZS_WIRING_UNOBSERVABLE */
    PZS_SELFTEST_ACCEPTED   /* self-test verdict: the program has ended the self-test by
                               pzs_selftest_accept, whatever its findings */
} pzs_selftest_verdict;

/* Results of the self-test that a program may read. */
typedef struct pzs_selftest_info {
    pzs_selftest_verdict verdict;
    const pzs_wiring *amplifier; /* [inputs] fault that the self-test has found at each amplifier,
                                    such as a wrong sign, or that it works */
    const pzs_wiring *sensor; /* [sensors] fault that the self-test has found at each sensor, such
                                 as a wrong sign, or that it works */
    uint32_t remaining; /* largest number of ticks that the self-test may still take; 0: it has
                           ended */
    uint32_t work;      /* work of the self-test's evaluation in the last tick: number of compared
                           entries of the measured responses, plus PZS_SELFTEST_STEP_WORK for each
                           comparison of two responses */
    uint16_t findings;  /* number of amplifiers and sensors with a fault: pzs_wiring.state is
                           PZS_WIRING_SILENT or larger */
    pzs_real gain; /* mean gain of the amplifiers that respond: measured response divided by the
                      response that the influence matrix predicts (dimensionless) */
} pzs_selftest_info;

/* Settings of the self-test that a program may change after the initialisation. */
typedef struct pzs_selftest_settings {
    uint32_t work_limit; /* work after which a tick of the self-test's evaluation ends; default:
                            PZS_SELFTEST_WORK. The work of comparing two responses is the number of
                            entries of one response plus PZS_SELFTEST_STEP_WORK. The larger the
                            limit, the fewer ticks the evaluation takes */
} pzs_selftest_settings;

typedef struct pzs_selftest {
    pzs_selftest_info info;
    pzs_selftest_settings settings;
    pzs_selftest_state state;
} pzs_selftest;

/*
 * End a self-test, whatever faults it has found, so that the loop controls the voltages from the
 * next tick on. Before the first tick, for example after a reset and pzs_loop_start, the call skips
 * the test.
 *   selftest in/out  returned by pzs_loop_find(&loop, &pzs_selftest_block)
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 *   - The voltage of a faulty amplifier is kept constant (pzs_hold) until pzs_release: at 0 V if it
 *     does not respond, otherwise at its present value.
 *   - Pass the readings of a faulty sensor as NaN.
 */
pzs_status pzs_selftest_accept(pzs_selftest *selftest);

/*
 * Repeat the self-test at the present voltages, for example once a day while the target stands
 * still, or where an electrode is suspected.
 *   selftest in/out  returned by pzs_loop_find(&loop, &pzs_selftest_block)
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 *   - Until its end the loop does not control the voltages.
 *   - After a fault the voltages stay constant until pzs_selftest_accept.
 *   - An amplifier that pzs_hold keeps constant is not tested.
 */
pzs_status pzs_selftest_repeat(pzs_selftest *selftest);

/*
 * Block (stage of the control tick, in PZS_PHASE_COMMISSION, thus first in the list) that tests
 * amplifiers, electrodes, cables and sensors before the loop controls the voltages.
 *   tables                             pzs_selftest_tables
 *   memory returned by pzs_loop_find   pzs_selftest
 * Errors of its initialisation: PZS_E_FORMAT, PZS_E_CRC, PZS_E_NONFINITE, and
 *   PZS_E_ARGUMENT  also for other numbers of inputs or sensors than those of the loop, or if sums
 *                   of voltages are limited
 *   PZS_E_LIMITS    the pulse of input info.where is too high
 */
extern const pzs_block_type pzs_selftest_block;
#define PZS_SELFTEST_BLOCK_BYTES(inputs, sensors)                                                  \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_selftest)) +                                                \
                ((size_t)(inputs) + (size_t)(sensors)) * sizeof(pzs_wiring) +                      \
                (((size_t)(inputs) + 7u) * (size_t)(sensors) + (size_t)(inputs)) *                 \
                    sizeof(pzs_real))

/* ---- fault detector of a loop that damps vibration (lib/control/pulse_faults.c) */

/*
 * The fault detector for structures that vibrate finds electrodes that are dead, stuck or reversed,
 * and keeps their voltages constant, while the loop goes on.
 *
 *   - Suspicion: the mean readings, compared with those of an earlier interval in which the target
 *     stood still, show less voltage on an electrode, or less change of it, than its amplifier
 *     gave. More than 5 % of the height of its test pulse must be missing.
 *   - Test: the electrode makes slow test pulses together with another suspected one, or with one
 *     that seems healthy. It is faulty if its response is missing although the other one responds,
 *     or has the wrong sign. One pulse is enough if its course in time excludes that a load hides
 *     the response; otherwise a second one, of opposite sign where the limits allow it, is needed.
 *   - Time: a fault is suspected within PZS_SUSPICION_TICKS, and proved PZS_PROOF_TICKS after the
 *     last motion of the target; a motion interrupts the pulses. If the target never stands still
 *     for one and a quarter pulses, no fault is found.
 */

/*
 * Conditions under which the fault detector for structures that vibrate works. It tests a suspected
 * electrode by slow voltage pulses together with a reference electrode that seems healthy:
 *   - During the pulses the loop damps vibration, but does not follow loads. If a load jumps, the
 *     pulse is repeated.
 *   - Sensors: at least four are needed. With fewer sensors than electrodes several electrodes may
 *     have to be tested one after the other.
 *   - Hysteresis: where the loop compensates it, a measured model of it predicts the readings. With
 *     30 % hysteresis that is not compensated most faults are not found.
 *   - If suspected and reference electrode respond weakly, or if hysteresis makes a pulse
 *     ineffective, the pulses grow to up to four times their height, at most half the voltage
 *     range.
 */
/*
 * Longest time until a fault that the readings show well is suspected while the target moves
 * (ticks): three halves of a window of half a test pulse in which readings are averaged. Windows
 * overlap by half, and the fault may occur at the beginning of a half.
 */
#define PZS_SUSPICION_TICKS(pulse_ticks, delay)                                                    \
    (3u * ((uint32_t)(pulse_ticks) / 4u + (uint32_t)(delay) + 1u + 3u) + 1u)
/*
 * Duration of a proof (ticks), from the last motion of the target until a suspected electrode is
 * found faulty by one undisturbed test pulse:
 *   pulse_ticks / 4 + delay + 1   pause, in which vibration decays
 *   4                             comparison of mean readings, choice of the electrodes to test
 *   pulse_ticks + delay + 1       test pulse
 *   4                             evaluation of the pulse
 */
#define PZS_PROOF_TICKS(pulse_ticks, delay)                                                        \
    ((uint32_t)(pulse_ticks) / 4u + (uint32_t)(pulse_ticks) + 2u * ((uint32_t)(delay) + 1u) + 8u)
/* Smallest number of sensors with which the fault detector can prove an electrode faulty. */
#define PZS_PULSE_SENSORS 4u

typedef enum pzs_electrode_fault {
    PZS_FAULT_NONE = 0,
    PZS_FAULT_DEAD,  /* electrode fault: the electrode is at 0 V, whatever its amplifier gives */
    PZS_FAULT_STUCK, /* electrode fault: the electrode keeps a voltage, whatever its amplifier does
                      */
    PZS_FAULT_REVERSED /* electrode fault: the electrode responds with the wrong sign */
} pzs_electrode_fault;

/* Results of the fault detector of a loop that damps vibration, which a program may read. */
typedef struct pzs_pulse_detector_info {
    const uint8_t *electrode; /* [inputs] state of each electrode, a value of pzs_electrode_state */
    const uint8_t *fault; /* [inputs] fault of each electrode, a value of pzs_electrode_fault; the
                             readings show whether a faulty electrode is at 0 V (dead) or at another
                             voltage (stuck) */
    pzs_real gain; /* gain of the electrode suspected of a fault: measured response to the last test
                      pulse divided by the modelled response (dimensionless) */
    int32_t where; /* index of the input to which the last status of the fault detector refers, or
                      -1 */
    uint16_t found;        /* number of faulty electrodes detected since the initialisation */
    uint16_t tests;        /* number of electrodes that were suspected since the initialisation */
    uint16_t unobservable; /* number of electrodes whose faults cannot be found: they have no test
                              pulse, or the sensors cannot tell them from other electrodes */
} pzs_pulse_detector_info;

typedef struct pzs_pulse_detector {
    pzs_pulse_detector_info info;
    pzs_pulse_detector_state state;
} pzs_pulse_detector;

/*
 * Block (stage of the control tick, in PZS_PHASE_OBSERVE) that finds dead, stuck and reversed
 * electrodes in a loop that damps vibration. Its tick returns PZS_W_ELECTRODE for a faulty
 * electrode, whose present voltage is kept until pzs_release.
 *   tables                             pzs_selftest_tables: heights and duration of the pulses,
 *                                      static readings, scales and delay
 *   memory returned by pzs_loop_find   pzs_pulse_detector
 * Errors of its initialisation: those of pzs_selftest_block.
 */
extern const pzs_block_type pzs_pulse_detector_block;
#define PZS_PULSE_DETECTOR_BLOCK_BYTES(inputs, sensors, outputs)                                   \
    PZS_ALIGNED(PZS_ALIGNED(sizeof(pzs_pulse_detector)) +                                          \
                sizeof(pzs_real) *                                                                 \
                    (PZS_DENSE(inputs) + 10u * (size_t)(inputs) + 5u * PZS_FOURS(inputs) +         \
                     6u * (size_t)(sensors) + (size_t)(outputs)) +                                 \
                sizeof(uint32_t) * ((size_t)(inputs) / PZS_TILE + 2u) +                            \
                (sizeof(uint16_t) + 3u) * (size_t)(inputs) + (size_t)(sensors))

#ifdef __cplusplus
}
#endif
#endif
