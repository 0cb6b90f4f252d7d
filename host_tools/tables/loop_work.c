/* SPDX-License-Identifier: BSD-2-Clause */
/* Upper bounds of the instructions of each block (stage) of the control tick (loop_work.h). */
#include "loop_work.h"
#include <math.h>
#include "pzs_loop.h"

const loop_processor loop_processor_table[LOOP_PROCESSORS] = {
    {"Cortex-M4F, float, -Os", "cortex_m4f", 1, 6, 15, 16, 5.9, 1},
    {"Cortex-M7, double, -O2", "cortex_m7", 2.4, 12, 12, 16, 6.8, 1.05},
};

/*
 * Number of instructions of the product of a matrix [rows][cols] with a vector, on the left or on
 * the right.
 */
static double product(const loop_processor *on, size_t rows, size_t cols)
{
    const double groups = ceil((double)cols / on->columns);
    return (double)rows * (on->entry * (double)cols + on->row * groups + 1.5) + 150 * groups;
}

/*
 * Return the number of instructions of those program loops of a control tick that do not multiply
 * matrices: `per_output` for each output, `per_input` for each input, and `once` in addition.
 */
static double loops(const block_counts *of, const loop_processor *on, double per_output,
                    double per_input, double once)
{
    return on->other * (per_output * (double)of->outputs + per_input * (double)of->inputs + once);
}

/*
 * Number of instructions of the product of the influence matrix with a vector, on the left or on
 * the right.
 */
static double influence_product(const block_counts *of, const loop_processor *on)
{
    if (of->entries == 0)
        return product(on, of->outputs, of->inputs);
    return on->sparse * (double)of->entries + loops(of, on, 110, 4, 100);
}

/*
 * Return the number of instructions that predict the shape in a control tick, after the voltages
 * have changed.
 */
static double prediction(const block_counts *of, const loop_processor *on)
{
    return influence_product(of, on) + loops(of, on, 9, 30, 100);
}

/*
 * Return the number of instructions that a control tick needs to predict the shape a second time.
 * This is necessary if a block (stage) after the optimiser may change the voltages; otherwise the
 * result is 0.
 */
static double second_prediction(const block_counts *of, const loop_processor *on)
{
    return of->moves_outside ? prediction(of, on) : 0;
}

double loop_work_rest(const block_counts *of, const loop_processor *on)
{
    const double blocks = 150 * (double)of->blocks;
    const double rows = 60 * (double)of->rows + 120 * (double)of->row_entries;
    return loops(of, on, 5, 159, 3680) + on->other * (blocks + rows);
}

/*
 * Upper bound of the instructions of the self-test in one tick. The longest ticks are those of the
 * evaluation (PZS_SELFTEST_WORK entries of measured responses are compared with the model, plus the
 * rest of the last response) and those of the pulses (all readings are added to weighted sums).
 */
double loop_work_selftest(const block_counts *of, const loop_processor *on)
{
    const double inputs = (double)of->inputs, readings = (double)of->readings;
    const double most = PZS_SELFTEST_WORK + PZS_SELFTEST_STEP_WORK + fmax(inputs, readings);
    const double measured = 130 * readings + 70 * inputs;
    return on->other * (fmax(60 * most, measured) + 10000);
}

/*
 * Upper bound of the instructions that one tick needs to correct late readings: it adds to them the
 * effect of the voltage changes since they were taken. Changes on faulty electrodes have no effect
 * and are left out.
 */
double loop_work_delay(const block_counts *of, const loop_processor *on)
{
    const double held = of->detects_faults ? 9 * (double)of->inputs * (double)of->readings : 0;
    const double pushed = LOOP_WORK_MISSED + 1;
    return pushed * product(on, of->readings, of->inputs) +
           on->other * (held + 100 * (double)of->readings + 4 * pushed * (double)of->inputs + 300);
}

/*
 * Upper bound of the instructions of the sensor gate: values of the parity relations, search for
 * the next suspect, and errors of all sensors that are missing, gated or suspected.
 */
double loop_work_gate(const block_counts *of, const loop_processor *on)
{
    const size_t sensors = of->readings, relations = of->gate_relations;
    const double most = (double)of->gate_most, readings = (double)sensors;
    if (relations == 0)
        return on->other * (30 * readings + 200);
    const double errors = most * (most + 3) * (8 * (double)relations + 80);
    return product(on, sensors, of->gate_quick) + product(on, sensors, relations - of->gate_quick) +
           product(on, sensors, relations) + on->other * (46 * readings + errors + 900);
}

double loop_work_feed_forward(const block_counts *of, const loop_processor *on)
{
    const double changed = (double)(of->readings + of->outputs);
    return on->other * (changed * (20 + 10 * (double)of->loads) + 300);
}

double loop_work_estimator(const block_counts *of, const loop_processor *on)
{
    return product(on, of->readings, of->inputs) + product(on, of->outputs, of->readings) +
           loops(of, on, 10, 0, 300) + on->other * 90 * (double)of->readings +
           second_prediction(of, on);
}

/*
 * Return the number of instructions in one control tick of two parts: the optimiser of the
 * voltages, and the program loops around it that run over the inputs.
 */
static double optimisation(const block_counts *of, const loop_processor *on)
{
    return on->optimiser * (double)of->work_limit + loops(of, on, 0, 150, 900);
}

/*
 * Upper bound of the instructions of the reference governor, which limits how fast the target
 * moves: it solves a second least-squares problem for voltages and predicts a shape.
 */
double loop_work_governor(const block_counts *of, const loop_processor *on)
{
    return 3 * influence_product(of, on) + loops(of, on, 75, 300, 2500) + optimisation(of, on);
}

/*
 * Upper bound of the instructions of the block pzs_modal_gains_block, which only tells the control
 * step to give each mode a gain and a leak of its own.
 */
double loop_work_modal_gains(const block_counts *of, const loop_processor *on)
{
    (void)of;
    return on->other * 120;
}

/*
 * Upper bound of the instructions of the block of free functions (shapes that may be added to the
 * target at no cost), which only tells the supervisor to remove them from shapes.
 */
double loop_work_free_functions(const block_counts *of, const loop_processor *on)
{
    (void)of;
    return on->other * 120;
}

double loop_work_vibration(const block_counts *of, const loop_processor *on)
{
    const size_t modes = of->modes, sensors = of->readings;
    const double few = sensors < of->outputs
                           ? product(on, of->outputs, sensors) + product(on, sensors, of->inputs) +
                                 product(on, of->outputs, modes) + loops(of, on, 12, 0, 0)
                           : 0;
    const double predicted = LOOP_WORK_MISSED + 1 + (double)of->damper_delay * 3;
    const double protected_rows =
        of->damper_delay > 0
            ? (LOOP_WORK_MISSED + 2 + (double)of->damper_delay) * 6 * (double)(sensors + modes)
            : 0;
    const double weighed = of->free_functions > 0 ? on->other * 8 * (double)sensors : 0;
    const double filtered = modes == 0 ? 4 * (double)sensors : 0; /* low-pass filter of readings */
    return weighed + 4 * product(on, sensors, modes) + 2 * product(on, modes, of->inputs) +
           4 * product(on, modes, modes) + few + second_prediction(of, on) +
           on->other * (81 * (double)sensors + 60 * (double)modes +
                        predicted * (22 * (double)modes + 80) + protected_rows + filtered + 1030);
}

/*
 * Upper bound of the instructions of the block that damps vibration with amplifiers that lag. Their
 * output changes in each missed tick as well, so that the static positions and readings are
 * computed anew there.
 */
double loop_work_lag_vibration(const block_counts *of, const loop_processor *on)
{
    const size_t modes = of->modes, sensors = of->readings;
    const double few = sensors < of->outputs ? product(on, sensors, of->inputs) : 0;
    const double missed = LOOP_WORK_MISSED * (few + product(on, modes, of->inputs));
    return loop_work_vibration(of, on) + missed +
           on->other * (LOOP_WORK_MISSED + 2) * (22 * (double)sensors + 44 * (double)modes + 200);
}

double loop_work_effect(const block_counts *of, const loop_processor *on)
{
    const double plays = (double)of->plays, moved = plays + (double)of->near_plays;
    return loops(of, on, 0, 380 + 32 * plays + 45 * (double)of->creeps + 32 * moved, 600);
}

double loop_work_inverse(const block_counts *of, const loop_processor *on)
{
    const double pieces = (double)of->near_plays + 2;
    return loops(of, on, 0, 250 + 50 * (double)of->plays + 60 * pieces, 300);
}

/*
 * Upper bounds of the instructions of the two blocks of actuator curves (effect, to which the
 * displacement of an actuator is proportional, over the voltage). For each input, the block before
 * the control step looks up the effects of three voltages. The block after the step looks up two
 * effects, and the voltage of a third one, which needs a square root.
 */
double loop_work_curve(const block_counts *of, const loop_processor *on)
{
    return loops(of, on, 0, 700, 600);
}

double loop_work_curve_inverse(const block_counts *of, const loop_processor *on)
{
    return loops(of, on, 0, 700, 300);
}

/*
 * Number of instructions with which the control step gives each mode (pattern of voltages) a gain
 * and a leak of its own: three products with the matrices of the modes, and one with the Hessian if
 * voltages outside their span have a leak.
 */
static double gains_work(const block_counts *of, const loop_processor *on)
{
    const size_t modes = of->gain_modes, inputs = of->inputs;
    const double products = 3 * product(on, modes, inputs) + on->other * 40 * (double)modes;
    const double hessian = of->has_other_leak ? product(on, inputs, inputs) : 0;
    return of->has_gains ? products + hessian + loops(of, on, 0, 100, 500) : 0;
}

/*
 * Upper bound of the instructions of the control step. A step without vibration damping also checks
 * the measurements.
 */
double loop_work_step(const block_counts *of, const loop_processor *on)
{
    const double common =
        influence_product(of, on) + prediction(of, on) + optimisation(of, on) + gains_work(of, on);
    if (of->is_damped)
        return common + loops(of, on, 22, 0, 0);
    return common + loops(of, on, 85, 0, 0) + second_prediction(of, on);
}

/*
 * Upper bound of the instructions of the control step with limit rows (limits of weighted sums of
 * voltages). Voltages are brought inside limit rows before the optimiser runs, and its loops over
 * limit rows take more instructions for each counted multiply-add.
 */
double loop_work_row_step(const block_counts *of, const loop_processor *on)
{
    const double all = (double)(of->inputs + of->rows);
    return loop_work_step(of, on) + on->other * (4 * (double)of->work_limit + 400 * all);
}

/*
 * Upper bound of the instructions of one tick that round the voltages to the steps of the
 * amplifiers' digital-to-analogue converters. In the worst case rounded voltages violate the limit
 * of every sum of voltages; each time the rounding is undone and all sums are computed again.
 */
double loop_work_amplifier(const block_counts *of, const loop_processor *on)
{
    const size_t most = of->rows < of->inputs ? of->rows : of->inputs;
    const double sums = 60 * (double)of->rows + 30 * (double)of->row_entries;
    return loops(of, on, 0, 150, 250) + on->other * (double)(most + 1) * sums;
}

/*
 * Upper bound of the instructions of the fault detector. In its longest tick, measurements become
 * missing or return, and the matrix of its least-squares estimate of the electrodes' voltages is
 * computed and factored anew.
 */
double loop_work_detector(const block_counts *of, const loop_processor *on)
{
    const double inputs = (double)of->inputs, outputs = (double)of->outputs;
    return product(on, of->outputs, of->inputs) + product(on, of->inputs, of->inputs) +
           loops(of, on, 100, 300, 2000) +
           on->other * 8 * (outputs * inputs * inputs / 16 + inputs * inputs * inputs / 6);
}

/*
 * Upper bound of the instructions of the fault detector of a loop that damps vibration. In one of
 * its longest ticks it estimates the voltage errors of all electrodes from the changes of the
 * readings: a sum of the rows of the influence matrix, a solution, and a product with the matrix.
 * In others it measures a test pulse: a product and scalar products over the readings, or a product
 * and the course of the pulse, whose work does not depend on the size of the loop.
 */
double loop_work_pulse_detector(const block_counts *of, const loop_processor *on)
{
    const double inputs = (double)of->inputs, readings = (double)of->readings;
    const double effects =
        of->plays > 0 ? inputs * (200 + 32 * (double)of->plays + 10 * (double)of->creeps) : 0;
    return product(on, of->readings, of->inputs) + product(on, of->inputs, of->inputs) +
           on->other * (9 * inputs * readings + 160 * readings + 300 * inputs +
                        20 * (double)of->outputs + effects + 9000);
}

/*
 * Number of instructions with which the supervisor removes the free functions (shapes that may be
 * added to the target at no cost) from the shapes that it compares.
 */
static double free_functions_work(const block_counts *of, const loop_processor *on)
{
    const double functions = (double)of->free_functions;
    const double each = 2 * product(on, of->free_functions, of->outputs) +
                        loops(of, on, 12, 0, 60 + 60 * functions);
    return of->free_functions > 0 ? PZS_FREE_SHAPES * each : 0;
}

double loop_work_supervisor(const block_counts *of, const loop_processor *on)
{
    const double both = second_prediction(of, on) + free_functions_work(of, on);
    const size_t modes = of->modes < PZS_GAIN_MODES ? of->modes : PZS_GAIN_MODES;
    const double gain = on->other * (35 * (double)modes);
    return of->is_damped ? loops(of, on, 13.5, 45, 1320) + gain + both
                         : loops(of, on, 45, 60, 1200) + both;
}
