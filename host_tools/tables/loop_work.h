/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Upper bounds of the processor instructions in a control tick, for each of its blocks (stages):
 * operations by the sizes of the tables, times the instructions of gcc for one. The script
 * tests/target/bound.sh compares them with QEMU. Not covered are ticks that repair damaged
 * memory, or that follow more than LOOP_WORK_MISSED missed ticks.
 */
#ifndef LOOP_WORK_H
#define LOOP_WORK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LOOP_WORK_CYCLES 2.0 /* assumed number of clock cycles per instruction of the processor */
/*
 * Number of missed ticks for which the upper bound of the instructions of a tick holds. After more
 * missed ticks the next tick may take longer, because it makes up for each of them.
 */
#define LOOP_WORK_MISSED 2

/*
 * Numbers on which memory and work of the blocks (stages) of the control tick depend, such as the
 * numbers of inputs, sensors and vibration modes.
 */
typedef struct block_counts {
    size_t inputs, outputs, rows, readings, modes, plays, creeps, loads;
    size_t row_entries; /* number of coefficients in all limits of sums of voltages */
    size_t entries; /* number of entries of the influence matrix in the tables, if it is stored as
                   sparse rows; 0: it is stored as a full matrix */
    size_t gate_relations, gate_quick; /* number of parity relations of the sensor gate, and of
                                          those among them that every tick computes */
    size_t gate_most; /* largest number of sensors whose errors the sensor gate estimates */
    bool has_gains;   /* whether modes (patterns of voltages) have a gain and a leak of their own in
                         the loop */
    size_t gain_modes;   /* number of modes (patterns of voltages) with gains and leaks of their own
                          */
    bool has_other_leak; /* whether a tick also removes a part (leak) of the voltages outside the
                            span of the modes, which takes a product with the Hessian in each tick
                          */
    size_t free_functions; /* number of free functions of the target (shapes that may be added to it
                              at no cost) */
    size_t blocks;         /* number of blocks (stages) of a control tick */
    size_t delay, damper_delay; /* delay: age of the sensor readings that the scene file states
                                   (ticks); damper_delay: age that the stage of the tick that damps
                                   vibration assumes (ticks) */
    /*
     * largest number of plays (elements with backlash) of the hysteresis compensation that begin to
     * move, or change their direction, when a voltage changes by its step limit
     */
    size_t near_plays;
    bool is_damped;      /* whether a control tick has a block (stage) that damps vibration */
    bool detects_faults; /* whether a control tick has a block (stage) that detects faults of
                            electrodes */
    bool moves_outside; /* whether a block (stage of the tick) after the control step may change the
                           voltages. The shape that the control step has predicted for its voltages
                           must then be predicted again */
    uint64_t work_limit; /* limit of the optimiser's work in one tick (multiply-adds) */
} block_counts;

/* A processor for which the instructions of a control tick are bounded. */
typedef struct loop_processor {
    const char *name, *key; /* name: processor with precision and compiler optimisation, for printed
                               results; key: member under which the instructions on this processor
                               are written to JSON output */
    double entry; /* number of instructions for each matrix entry in a product of matrix and vector
                   */
    double row;   /* number of instructions for each row and group of columns in a product of matrix
                     and vector, in addition to those for each entry */
    double columns; /* number of matrix columns that a product of matrix and vector processes
                       together */
    double sparse;  /* number of instructions for each stored entry in a product of a sparse matrix
                       and a vector, if the matrix has at least PRODUCT_LONG_ROW columns */
    double optimiser; /* number of instructions for each counted multiply-add of the optimiser */
    /*
     * number of instructions of a program loop on the processor, divided by that on a Cortex-M4F
     * (dimensionless); for loops other than products of matrix and vector and the optimiser
     */
    double other;
} loop_processor;

/*
 * LOOP_PROCESSORS: number of types of processor for which the instructions of a control tick are
 * bounded; a scene states the clock rate of the first type.
 */
enum { LOOP_PROCESSORS = 2 };
extern const loop_processor loop_processor_table[LOOP_PROCESSORS];

/*
 * Function that returns an upper bound of the number of instructions in one tick: of one type of
 * block, or of everything outside the blocks (repair of memory, checksums, last check of the
 * voltages).
 */
typedef double loop_work_bound(const block_counts *of, const loop_processor *on);
loop_work_bound loop_work_rest, loop_work_selftest, loop_work_delay, loop_work_feed_forward,
    loop_work_governor, loop_work_gate, loop_work_modal_gains, loop_work_free_functions,
    loop_work_estimator, loop_work_vibration, loop_work_lag_vibration, loop_work_effect,
    loop_work_step, loop_work_row_step, loop_work_inverse, loop_work_curve, loop_work_curve_inverse,
    loop_work_amplifier, loop_work_detector, loop_work_pulse_detector, loop_work_supervisor;

#endif
