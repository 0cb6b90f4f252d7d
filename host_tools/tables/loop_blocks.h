/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Blocks of the control loop that a scene needs, each of which does one task in every tick of the
 * loop: with tables for the simulated loop on the host, and as C source for a firmware. The list in
 * loop_blocks.c is the only list of block types.
 */
#ifndef LOOP_BLOCKS_H
#define LOOP_BLOCKS_H

#include "../model/compensation.h"
#include "../model/damper.h"
#include "../model/wiring_test.h"
#include "emit.h"
#include "loop_work.h"
#include "sensor_gate.h"

typedef struct loop_blocks {
    const design *design;
    const estimator *estimator;
    const damper *damper;
    const wiring_test *wiring; /* tables of the self-test that runs before the control loop takes
                                  control; NULL: the loop has no self-test */
    const wiring_test *pulses; /* tables of the test pulses (slow, smooth pulses of an amplifier's
                                  voltage) of the fault detector in a loop that damps vibration;
                                  NULL: the loop has no such detector */
    const sensor_gate *gate;   /* tables of the sensor gate, which takes wrong readings away; NULL:
                                  the loop has none */
    /*
     * Tables of those blocks (stages of a control tick) whose data are neither in the numerical
     * model of the scene (struct design) nor in the shape estimator nor in the vibration damper.
     */
    pzs_reading_delay delay;
    pzs_known_loads known_loads;
    pzs_governor governor;
    pzs_free_functions free_functions;
    pzs_amplifier amplifier;
    pzs_fault_detection detection;
    pzs_supervision supervision;
    compensation compensation;
    pzs_problem problem; /* voltage optimisation problem (least squares for the voltages within
                            their limits), with the limit of the optimiser's work that the clock of
                            the scene's processor allows */
    pzs_block block[PZS_BLOCK_LIMIT];
    int count;
} loop_blocks;

/* Upper bounds of the instructions of one tick on a processor. */
typedef struct loop_bounds {
    struct {
        const pzs_block_type *type;
        double most; /* upper bound of the instructions of a block (stage) of the control loop in
                        one tick */
    } block[PZS_BLOCK_LIMIT];
    int count;
    double rest; /* upper bound of the instructions of one tick outside of its blocks (stages):
                    repair of working memory from the constant tables, checksums of the tables, last
                    check of the voltages */
    double all;  /* upper bound of the instructions of one tick in which the loop is in control; the
                    self-test, which runs before, does not count */
} loop_bounds;

/*
 * Everything to which the list of the blocks of a control loop refers by pointers. A struct of this
 * type must therefore not be moved in memory.
 */
typedef struct loop_parts {
    estimator estimator;
    damper damper;
    wiring_test wiring; /* tables of the self-test of amplifiers, cables and sensors */
    wiring_test pulses; /* tables of the test pulses (slow, smooth pulses of an amplifier's voltage)
                           of the fault detector, in a loop that damps vibration */
    sensor_gate gate;
    loop_blocks blocks;
} loop_parts;

/*
 * Whether the controller of a scene estimates the shape from the readings of sensors
 * (loop_estimates), and compensates known loads by feed-forward (loop_feeds).
 */
int loop_estimates(const design *design);
int loop_feeds(const design *design);

/*
 * Return whether the control loop of a scene has a supervisor: where the scene asks for it by the
 * section `safety`, and where the loop damps vibration, unless the scene says `safety: none`.
 */
bool loop_supervises(const design *design, bool is_damped);

/*
 * Root mean square, over the target nodes, of the displacements under the loads of the scene
 * (length unit of the scene). The supervisor tolerates them as sudden loads.
 */
double loop_loaded_rms(const design *design);

/*
 * Root mean square, over the target nodes, of the displacements when each amplifier applies half
 * its voltage range with a random sign (length unit of the scene): the root of the sum of the
 * squares for single amplifiers. Amplifiers without finite limits do not count.
 */
double loop_reachable_rms(const design *design);

/*
 * Fill the list of the blocks (stages) of a scene's control loop, in the order in which a tick runs
 * them.
 *   design     in  numerical model of the scene; must outlive the list
 *   estimator  in  shape estimator; all zero where the scene has neither an estimator nor
 *                  feed-forward; must outlive the list
 *   damper     in  tables of the vibration damper; must outlive the list
 */
void loop_blocks_fill(loop_blocks *blocks, const design *design, const estimator *estimator,
                      const damper *damper);

/*
 * Add the blocks (stages of a control tick) that make test pulses to a filled list: the self-test,
 * and the fault detector of a loop that damps vibration. Blocks that the scene does not have are
 * left out.
 *   wiring in  tables of the self-test; must outlive the list
 *   pulses in  tables of the test pulses of the fault detector; must outlive the list
 */
void loop_blocks_test(loop_blocks *blocks, const wiring_test *wiring, const wiring_test *pulses);

/*
 * Make the tables of the sensor gate of a scene, which is unused where the scene does not ask for
 * it.
 *   analysis   in  analysis whose influence matrix is computed
 *   estimator  in  shape estimator with the effects of the loads
 *   damper     in  tables of the vibration damper
 * Returns whether memory sufficed; call sensor_gate_close in either case.
 */
bool loop_gate_open(sensor_gate *gate, const analysis *analysis, const estimator *estimator,
                    const damper *damper);

/*
 * Add the sensor gate to a filled list of blocks (stages of a control tick), if it is used.
 *   gate in  tables of the sensor gate; must outlive the list
 */
void loop_blocks_gate(loop_blocks *blocks, const sensor_gate *gate);

/*
 * Write the blocks (stages) of a control loop as C source: their tables, the list PREFIX_blocks and
 * the macro PREFIX_LOOP_BYTES (memory of the loop). The tables of the estimator, the feed-forward
 * and the least-squares problem for the voltages must be written before.
 */
void loop_blocks_write(emitter *emitter, const loop_blocks *blocks);

/*
 * Return whether a block (stage) of the control loop reads single entries of the influence matrix,
 * which the tables must then hold in full, not as sparse rows. Fault detectors do; with sensors as
 * outputs, also the self-test and the correction of late readings.
 */
bool loop_blocks_read_entries(const loop_blocks *blocks);

/*
 * Return the memory (bytes) of a control loop with given blocks (stages of a tick),
 * PREFIX_LOOP_BYTES in the generated header. In single precision it is an upper bound, because
 * pointers and reals in structs are counted with their larger size on this computer.
 */
size_t loop_blocks_bytes(const loop_blocks *blocks, bool is_single);

/*
 * Return the largest number of multiply-adds of the optimiser in one tick of a control loop with
 * given blocks (stages): what the processor clock of the scene file allows, or the default of the
 * library.
 */
uint64_t loop_blocks_work_limit(const loop_blocks *blocks);

/*
 * Compute upper bounds of the instructions that one tick of a control loop with given blocks
 * (stages) takes on a processor.
 */
void loop_blocks_bound(const loop_blocks *blocks, const loop_processor *on, loop_bounds *bounds);

/*
 * Make the list of the blocks (stages) of a scene's control loop with everything that it refers to.
 *   parts     out  list and tables, released by loop_parts_close
 *   analysis  in  analysis with the least-squares problem for the voltages and with the result of
 *             the stability tests; must outlive *parts
 * Returns 0, or -1 with error filled and nothing to close.
 */
int loop_parts_open(loop_parts *parts, const analysis *analysis, char *error);
void loop_parts_close(loop_parts *parts);

/*
 * Write the names that the source of a firmware uses: the macro PREFIX_TICK_RATE, constants for the
 * indices of amplifiers and sensors, and a comment that describes the outputs.
 */
void loop_names_write(emitter *emitter, const analysis *analysis);

#endif
