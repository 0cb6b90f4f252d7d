/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Blocks of the control loop that a scene needs, with the conditions for them and their tables
 * (loop_blocks.h). A block does one task in every tick of the loop, such as estimating the shape.
 */
#include "loop_blocks.h"
#include "sparse_tables.h"
#include <ctype.h>
#include <math.h>
#include <string.h>
#include "../mesh/mesh_shown.h"
#include "../model/curves.h"
#include "../../lib/control/control.h"
#include "../../lib/control/limit_rows.h"
#include "../../lib/core/guard.h"

/*
 * Part of the step limits (largest voltage changes of the amplifiers in one tick) that the motion
 * of the target to a new shape may use; the rest is left for the damping of vibration.
 */
static const double governor_part = 0.5;

/* ---- conditions for blocks of the control loop ------------------------- */

int loop_estimates(const design *design)
{
    return design->estimate.given && design->simulate.sight != SIGHT_MEASURED;
}

int loop_feeds(const design *design)
{
    return design->simulate.has_feed_forward;
}

bool loop_supervises(const design *design, bool is_damped)
{
    return design->safety.given || (is_damped && !design->safety.left_out);
}

static bool has_selftest(const loop_blocks *blocks)
{
    return blocks->wiring && blocks->wiring->is_used;
}

static bool has_rows(const loop_blocks *blocks)
{
    return blocks->design->limits.rows > 0;
}

static bool has_no_rows(const loop_blocks *blocks)
{
    return !has_rows(blocks);
}

static bool has_delay(const loop_blocks *blocks)
{
    return blocks->design->simulate.delay > 0 && !blocks->damper->is_used;
}

static bool has_feed_forward(const loop_blocks *blocks)
{
    return loop_feeds(blocks->design);
}

static bool has_modal_gains(const loop_blocks *blocks)
{
    return blocks->design->gains.is_used && !blocks->damper->is_used;
}

/*
 * Return whether the supervisor of the loop has to compare shapes without the free functions of the
 * target (shapes that may be added to it at no cost).
 */
static bool has_free_functions(const loop_blocks *blocks)
{
    return blocks->design->free_functions > 0 &&
           loop_supervises(blocks->design, blocks->damper->is_used);
}

/*
 * Return whether the scene needs the block (stage of the control tick) that estimates the shape
 * from sensor readings. The block that damps vibration estimates the shape itself and replaces that
 * block.
 */
static bool has_estimator(const loop_blocks *blocks)
{
    return loop_estimates(blocks->design) && !blocks->damper->is_used;
}

static bool has_damper(const loop_blocks *blocks)
{
    return blocks->damper->is_used;
}

/* Whether the block that damps vibration models the lag of the amplifiers. */
static bool has_lag(const loop_blocks *blocks)
{
    return has_damper(blocks) && blocks->damper->tables.lag != NULL;
}

static bool has_no_lag(const loop_blocks *blocks)
{
    return has_damper(blocks) && !has_lag(blocks);
}

static bool has_governor(const loop_blocks *blocks)
{
    return blocks->damper->is_used && blocks->design->control.moving_target;
}

static bool has_compensation(const loop_blocks *blocks)
{
    return blocks->compensation.is_used;
}

static bool has_curves(const loop_blocks *blocks)
{
    return curves_are_used(blocks->design);
}

static bool has_amplifier(const loop_blocks *blocks)
{
    return blocks->design->simulate.step > 0 || blocks->design->simulate.dead_band > 0;
}

static bool has_detector(const loop_blocks *blocks)
{
    return blocks->design->simulate.detects_faults && !blocks->damper->is_used;
}

static bool has_pulse_detector(const loop_blocks *blocks)
{
    return blocks->pulses && blocks->pulses->is_used && blocks->damper->is_used;
}

static bool has_gate(const loop_blocks *blocks)
{
    return blocks->gate && blocks->gate->is_used;
}

static bool has_supervisor(const loop_blocks *blocks)
{
    return loop_supervises(blocks->design, blocks->damper->is_used);
}

/* ---- tables of the blocks for the host -------------------------------- */

static const void *selftest_tables(loop_blocks *blocks)
{
    return &blocks->wiring->tables;
}

static const void *pulse_tables(loop_blocks *blocks)
{
    return &blocks->pulses->tables;
}

static const void *delay_tables(loop_blocks *blocks)
{
    const design *design = blocks->design;
    const bool is_few = loop_estimates(design);
    blocks->delay = (pzs_reading_delay){.scene = design->problem.scene,
                                        .inputs = design->problem.inputs,
                                        .sensors = design->problem.outputs,
                                        .delay = (uint16_t)design->simulate.delay,
                                        .direct = NULL};
    if (is_few) {
        blocks->delay.sensors = blocks->estimator->tables.sensors;
        blocks->delay.direct = blocks->estimator->tables.direct;
    }
    (void)pzs_reading_delay_seal(&blocks->delay);
    return &blocks->delay;
}

static const void *known_tables(loop_blocks *blocks)
{
    const int few = loop_estimates(blocks->design);
    blocks->known_loads.shape = &blocks->estimator->shape_table;
    blocks->known_loads.readings = few ? &blocks->estimator->reading_table : NULL;
    return &blocks->known_loads;
}

static const void *estimator_tables(loop_blocks *blocks)
{
    return &blocks->estimator->tables;
}

static const void *gate_tables(loop_blocks *blocks)
{
    return &blocks->gate->tables;
}

static const void *damper_tables(loop_blocks *blocks)
{
    return &blocks->damper->tables;
}

static const void *governor_tables(loop_blocks *blocks)
{
    blocks->governor.share = blocks->damper->tables.share;
    blocks->governor.part = governor_part;
    return &blocks->governor;
}

static const void *free_functions_tables(loop_blocks *blocks)
{
    const design *design = blocks->design;
    blocks->free_functions = (pzs_free_functions){.scene = design->problem.scene,
                                                  .outputs = design->problem.outputs,
                                                  .count = (uint16_t)design->free_functions,
                                                  .value = design->free_basis};
    (void)pzs_free_functions_seal(&blocks->free_functions);
    return &blocks->free_functions;
}

static const void *modal_gains_tables(loop_blocks *blocks)
{
    return &blocks->design->gains.tables;
}

static uint64_t work_limit(const loop_blocks *blocks);

/*
 * Return the voltage optimisation problem (least squares for the voltages within their limits) with
 * a limit of the optimiser's work that the processor clock of the scene file allows.
 */
static const void *problem_tables(loop_blocks *blocks)
{
    blocks->problem = blocks->design->problem;
    blocks->problem.work_limit = work_limit(blocks);
    blocks->problem.crc = pzs_problem_crc(&blocks->problem);
    return &blocks->problem;
}

static const void *compensation_tables(loop_blocks *blocks)
{
    return &blocks->compensation.tables;
}

static const void *curve_tables(loop_blocks *blocks)
{
    return &blocks->design->curves;
}

static const void *amplifier_tables(loop_blocks *blocks)
{
    blocks->amplifier.step = blocks->design->simulate.step;
    blocks->amplifier.dead_band = blocks->design->simulate.dead_band;
    return &blocks->amplifier;
}

static const void *detection_tables(loop_blocks *blocks)
{
    blocks->detection.delay = (uint16_t)blocks->design->simulate.delay;
    return &blocks->detection;
}

double loop_loaded_rms(const design *design)
{
    double sum = 0;
    for (int i = 0; i < design->targets; i++) {
        const double by_loads = design->target[i] - design->wanted[i];
        sum += by_loads * by_loads / design->targets;
    }
    return sqrt(sum);
}

double loop_reachable_rms(const design *design)
{
    double sum = 0;
    for (int k = 0; k < design->amplifiers; k++) {
        const double half = curves_half_range(design, k);
        for (int i = 0; i < design->targets && isfinite(half); i++) {
            const double moved =
                half * design->influence[(size_t)i * (size_t)design->amplifiers + (size_t)k];
            sum += moved * moved / design->targets;
        }
    }
    return sqrt(sum);
}

/*
 * Return the displacement in which the supervisor's tolerances are measured (m, RMS over the target
 * nodes): that of the target, or that of the shape under half the voltage range if the target is
 * zero or larger. A structure hardly moves towards a target out of its reach; with tolerances in
 * units of such a target, the supervisor could not tell that amplifiers are reversed.
 */
static double tolerated_unit(const design *design)
{
    const double target = design_target_rms(design), reachable = loop_reachable_rms(design);
    if (!(target > 0))
        return reachable;
    return reachable > 0 ? fmin(target, reachable) : target;
}

bool loop_gate_open(sensor_gate *gate, const analysis *analysis, const estimator *estimator,
                    const damper *damper)
{
    const design *design = &analysis->design;
    return sensor_gate_open(gate, analysis, estimator, loop_estimates(design), damper,
                            tolerated_unit(design));
}

/*
 * Largest factor by which a tick multiplies the deviation that the supervisor tolerates after
 * changes of the target.
 */
static const double slowest_fading = 0.99999;

/*
 * Part of the shape under half the voltage range by which the predicted shape may move while the
 * structure stands still: hysteresis takes the first part of every way back. On structures that
 * this number was not chosen on, with a hysteresis of up to 30 %, no healthy run needed more than
 * 0.35 (tests/unit/sweep_alarms.c).
 */
static const double idle_part = 0.5;

/*
 * Make the tables of the supervisor, the block (stage of a control tick) that monitors the loop.
 * Its unit of displacement W is tolerated_unit.
 *   load         tolerated effect of a sudden load: that of the scene's loads, at least 0.3 W
 *   noise        tolerated noise of the readings: that of the scene, at least 0.005 W
 *   fading       factor by which the tolerated effect of target changes decays in a tick. With
 *                observed modes: 1/e in two periods of the first mode, or in more periods if a
 *                stability test with fast jumps of the target would otherwise raise an alarm.
 *                Without an observed mode: as slowly as the damper corrects static errors of the
 *                model, which until then look like a vibration. Without a vibration model: 1/e in
 *                50 ticks
 *   alarm_ticks  number of implausible ticks until an alarm: half the time of `fading`, in general
 *                a period of the first vibration mode, at least 20 (for vibration twice as many)
 *   slack        motion of the predicted shape that hysteresis may take: idle_part times the shape
 *                under half the voltage range
 *   polarity_ticks  as alarm_ticks, for motions against the prediction: a period of the first
 *                vibration mode, at least 20
 */
static const void *supervision_tables(loop_blocks *blocks)
{
    const design *design = blocks->design;
    const double wanted = tolerated_unit(design);
    pzs_supervision *tables = &blocks->supervision;
    *tables = (pzs_supervision){.scene = design->problem.scene,
                                .inputs = design->problem.inputs,
                                .timeout = (uint16_t)design->safety.timeout,
                                .ramp_ticks = (uint16_t)design->safety.ramp_ticks,
                                .alarm_ticks = 20,
                                .polarity_ticks = 20,
                                .waits = (uint16_t)design->safety.waits,
                                .park = design->park,
                                .fading = 0.98,
                                .noise = fmax(design->simulate.noise, 0.005 * wanted),
                                .load = fmax(0.3 * wanted, loop_loaded_rms(design)),
                                .slack = idle_part * loop_reachable_rms(design)};
    if (blocks->damper->is_used && blocks->damper->modes == 0)
        tables->fading = fmin(1 - (double)blocks->damper->tables.slow, slowest_fading);
    if (blocks->damper->is_used && blocks->damper->modes > 0) {
        const double period = blocks->damper->rate / blocks->damper->frequency[0];
        tables->fading = exp(-1 / (blocks->damper->fading_periods * period));
        tables->alarm_ticks =
            (uint16_t)fmin(fmax(20, ceil(blocks->damper->fading_periods / 2 * period)), 60000);
        tables->polarity_ticks =
            (uint16_t)fmin(fmax(20, ceil(period)), (double)tables->alarm_ticks);
    }
    (void)pzs_supervision_seal(tables);
    return tables;
}

/* ---- tables of the blocks as C source --------------------------------- */

/*
 * Write the name of an array of the shape estimator that several blocks (stages) of the control
 * tick use, with a comma, or NULL where the scene has no shape estimator.
 */
static void write_shared(const emitter *emitter, const void *table, const char *name)
{
    if (table)
        fprintf(emitter->file, "%s_%s, ", emitter->prefix, name);
    else
        fputs("NULL, ", emitter->file);
}

/*
 * Write tables of test pulses: slow, smooth pulses of one amplifier's voltage, to which the sensors
 * have to respond.
 *   name in  name of the tables in the generated header, after the prefix
 */
static void write_pulses(emitter *emitter, const pzs_selftest_tables *tables, const char *name)
{
    const uint16_t counts[4] = {tables->inputs, tables->sensors, tables->delay,
                                tables->pulse_ticks};
    const size_t entries = tables->direct ? (size_t)tables->sensors * tables->inputs : 0;
    char amplitude[40], scale[40], noise[40];
    snprintf(amplitude, sizeof amplitude, "%s_amplitude", name);
    snprintf(scale, sizeof scale, "%s_scale", name);
    snprintf(noise, sizeof noise, "%s_noise", name);
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emitter->crc32 = emit_crc_reals(emitter->crc32, tables->direct, entries);
    emit_reals(emitter, amplitude, tables->amplitude, tables->inputs,
               "height of the test pulse of each amplifier (V)");
    emit_reals(emitter, scale, tables->scale, tables->sensors,
               "factor that makes the readings of different sensors comparable");
    emit_reals(emitter, noise, tables->noise, tables->sensors,
               "largest plausible noise of each sensor");
    emitter->crc32 = emit_crc_reals(emitter->crc32, &tables->gain_tolerance, 1);
    emit_begin(emitter, "selftest_tables", name, tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %u, %u, ", counts[0], counts[1], counts[2], counts[3]);
    write_shared(emitter, tables->direct, "direct");
    fprintf(emitter->file, "\n    %s_%s, %s_%s, %s_%s, PZS_R(%.17g)\n};\n", emitter->prefix,
            amplitude, emitter->prefix, scale, emitter->prefix, noise, tables->gain_tolerance);
}

static void write_selftest(emitter *emitter, const loop_blocks *blocks)
{
    emit_comment(emitter, "largest number of ticks of the self-test before the loop takes control");
    fprintf(emitter->file, "#define %s_SELFTEST_TICKS %luu\n", emitter->upper,
            (unsigned long)wiring_test_ticks(blocks->wiring));
    write_pulses(emitter, &blocks->wiring->tables, "selftest");
}

static void write_pulse_detection(emitter *emitter, const loop_blocks *blocks)
{
    emit_comment(emitter,
                 "test pulses of the fault detector: number of amplifiers, number of "
                 "readings, age of a reading when a tick uses it (ticks), duration of a pulse "
                 "(ticks)");
    write_pulses(emitter, &blocks->pulses->tables, "pulse_detection");
}

static void write_delay(emitter *emitter, const loop_blocks *blocks)
{
    const pzs_reading_delay *tables = &blocks->delay;
    const uint16_t counts[3] = {tables->inputs, tables->sensors, tables->delay};
    const size_t entries = tables->direct ? (size_t)tables->sensors * tables->inputs : 0;
    emit_comment(emitter,
                 "late readings: number of amplifiers, number of readings, age of a reading "
                 "when a tick uses it (ticks), readings per volt");
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emitter->crc32 = emit_crc_reals(emitter->crc32, tables->direct, entries);
    emit_begin(emitter, "reading_delay", "reading_delay", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %u, ", counts[0], counts[1], counts[2]);
    write_shared(emitter, tables->direct, "direct");
    fputs("\n};\n", emitter->file);
}

static void write_known(emitter *emitter, const loop_blocks *blocks)
{
    emit_comment(emitter, "feed-forward tables of the shape and of the readings of the sensors");
    fprintf(emitter->file,
            "static const pzs_known_loads %s_known_loads = {&%s_shape_feed_forward, ",
            emitter->prefix, emitter->prefix);
    if (blocks->known_loads.readings)
        fprintf(emitter->file, "&%s_reading_feed_forward};\n", emitter->prefix);
    else
        fputs("NULL};\n", emitter->file);
}

static void write_gate(emitter *emitter, const loop_blocks *blocks)
{
    const pzs_sensor_gate *tables = &blocks->gate->tables;
    const size_t judged = tables->relations > 0 ? tables->sensors : 0;
    const uint16_t counts[6] = {tables->sensors, tables->relations, tables->quick,
                                tables->most,    tables->patience,  tables->replaces};
    static const char *const name[] = {"gate_parity", "gate_scale", "gate_threshold"};
    fprintf(emitter->file, "#define %s_GATE_RELATIONS %u\n#define %s_GATE_MOST %u\n",
            emitter->upper, tables->relations, emitter->upper, tables->most);
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emit_reals(emitter, "range", tables->range, tables->sensors,
               "largest believable size of each reading");
    if (judged > 0) {
        emit_reals(emitter, name[0], tables->parity, judged * tables->relations,
                   "parity relations (columns): sums over the readings (rows) that are 0 for all "
                   "that voltages, modes and loads can make");
        emit_reals(emitter, name[1], tables->scale, judged,
                   "1 / norm of each row of the parity relations; 0: the sensor is never gated");
        emit_reals(emitter, name[2], tables->threshold, judged,
                   "smallest error of each reading that is gated");
    }
    emitter->crc32 = emit_crc_reals(emitter->crc32, &tables->quiet, 2);
    emit_begin(emitter, "sensor_gate", "sensor_gate", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %u, %u, %u, %u,\n    %s_range,", counts[0], counts[1],
            counts[2], counts[3], counts[4], counts[5], emitter->prefix);
    for (size_t i = 0; i < sizeof name / sizeof *name; i++)
        if (judged > 0)
            fprintf(emitter->file, " %s_%s,", emitter->prefix, name[i]);
        else
            fputs(" NULL,", emitter->file);
    fprintf(emitter->file, " PZS_R(%.17g), PZS_R(%.17g)\n};\n", tables->quiet, tables->ratio);
}

static void write_governor(emitter *emitter, const loop_blocks *blocks)
{
    emit_comment(emitter, "governor: largest part of the way to a new target that one tick goes, "
                          "and part of the step limits that this motion may use");
    fprintf(emitter->file,
            "static const pzs_governor %s_governor = {PZS_R(%.17g), PZS_R(%.17g)};\n",
            emitter->prefix, blocks->governor.share, blocks->governor.part);
}

static void write_modal_gains(emitter *emitter, const loop_blocks *blocks)
{
    const pzs_modal_gains *tables = &blocks->design->gains.tables;
    const size_t modes = tables->modes, entries = modes * tables->inputs;
    const uint16_t counts[2] = {tables->inputs, tables->modes};
    const double others[2] = {tables->other_gain, tables->other_leak};
    static const char *const name[] = {"mode_pattern", "mode_effect", "mode_gain", "mode_leak"};
    emit_comment(emitter, "number of modes with gains and leaks of their own");
    fprintf(emitter->file, "#define %s_GAIN_MODES %u\n", emitter->upper, tables->modes);
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    if (modes > 0) {
        emit_reals(emitter, name[0], tables->pattern, entries,
                   "voltages (columns) of each mode (row), for a weighted norm of 1 of its shape");
        emit_reals(emitter, name[1], tables->effect, entries,
                   "Hessian of the optimisation times the voltages of each mode (row)");
        emit_reals(emitter, name[2], tables->gain, modes, "gain of each mode");
        emit_reals(emitter, name[3], tables->leak, modes, "leak of each mode");
    }
    emitter->crc32 = emit_crc_reals(emitter->crc32, others, 2);
    emit_begin(emitter, "modal_gains", "modal_gains", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u,\n   ", counts[0], counts[1]);
    for (size_t i = 0; i < sizeof name / sizeof *name; i++)
        if (modes > 0)
            fprintf(emitter->file, " %s_%s,", emitter->prefix, name[i]);
        else
            fputs(" NULL,", emitter->file);
    fprintf(emitter->file, " PZS_R(%.17g), PZS_R(%.17g)\n};\n", others[0], others[1]);
}

static void write_free_functions(emitter *emitter, const loop_blocks *blocks)
{
    const pzs_free_functions *tables = &blocks->free_functions;
    const uint16_t counts[2] = {tables->outputs, tables->count};
    emit_comment(emitter, "number of free functions of the target");
    fprintf(emitter->file, "#define %s_FREE_FUNCTIONS %u\n", emitter->upper, tables->count);
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emit_reals(emitter, "free_value", tables->value, (size_t)tables->count * tables->outputs,
               "orthonormal free functions of the target (rows) at its nodes (columns)");
    emit_begin(emitter, "free_functions", "free_functions", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %s_free_value,\n};\n", counts[0], counts[1], emitter->prefix);
}

static void write_amplifier(emitter *emitter, const loop_blocks *blocks)
{
    emit_comment(emitter, "voltage step of the converters, and dead band of the amplifiers (V)");
    fprintf(emitter->file,
            "static const pzs_amplifier %s_amplifier = {PZS_R(%.17g), PZS_R(%.17g)};\n",
            emitter->prefix, blocks->amplifier.step, blocks->amplifier.dead_band);
}

static void write_detection(emitter *emitter, const loop_blocks *blocks)
{
    emit_comment(emitter,
                 "fault detector: delay of the measurements (ticks), amplitude of the test "
                 "signal (V; 0: default)");
    fprintf(emitter->file,
            "static const pzs_fault_detection %s_fault_detection = {%u, PZS_R(%.17g)};\n",
            emitter->prefix, blocks->detection.delay, blocks->detection.amplitude);
}

static void write_compensation(emitter *emitter, const loop_blocks *blocks)
{
    const pzs_hysteresis *tables = &blocks->compensation.tables;
    const size_t plays = tables->plays, creeps = tables->creeps;
    const uint16_t counts[4] = {tables->inputs, tables->sets, tables->plays, tables->creeps};
    fprintf(emitter->file, "#define %s_PLAYS %u\n#define %s_CREEPS %u\n", emitter->upper,
            tables->plays, emitter->upper, tables->creeps);
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emit_reals(emitter, "middle", tables->middle, 1, "middle of the voltage range (V)");
    emit_reals(emitter, "half_range", tables->half_range, 1, "half of the voltage range (V)");
    emit_reals(emitter, "effect_offset", tables->offset, 1, "effect at the middle (V)");
    emit_reals(emitter, "effect_slope", tables->slope, PZS_HYSTERESIS_SEGMENTS,
               "slopes of the part without memory, from the lowest quarter of the range");
    emit_reals(emitter, "slack", tables->slack, plays, "slacks of the plays (V)");
    emit_reals(emitter, "above", tables->above, plays, "weights of the plays above the middle");
    emit_reals(emitter, "below", tables->below, plays, "weights of the plays below the middle");
    emit_reals(emitter, "creep", tables->creep, creeps, "final creep over the voltage");
    emit_reals(emitter, "creep_rate", tables->creep_rate, creeps,
               "part of the way that each creep goes in a tick");
    emit_reals(emitter, "identified_offset", tables->identified_offset, 1,
               "effect at the middle, as identified (V)");
    emit_reals(emitter, "identified_slope", tables->identified_slope, PZS_HYSTERESIS_SEGMENTS,
               "slopes of the part without memory, as identified");
    emit_reals(emitter, "identified_above", tables->identified_above, plays,
               "weights of the plays above the middle, as identified");
    emit_reals(emitter, "identified_below", tables->identified_below, plays,
               "weights of the plays below the middle, as identified");
    emit_begin(emitter, "hysteresis", "hysteresis", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %u, %u,\n   ", counts[0], counts[1], counts[2], counts[3]);
    static const char *const arrays[] = {"middle",
                                         "half_range",
                                         "effect_offset",
                                         "effect_slope",
                                         "slack",
                                         "above",
                                         "below",
                                         "creep",
                                         "creep_rate",
                                         "identified_offset",
                                         "identified_slope",
                                         "identified_above",
                                         "identified_below"};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        fprintf(emitter->file, " %s_%s,", emitter->prefix, arrays[i]);
    fputs("\n};\n", emitter->file);
}

static void write_curves(emitter *emitter, const loop_blocks *blocks)
{
    const pzs_actuator_curves *tables = &blocks->design->curves;
    const size_t points = (size_t)tables->sets * tables->points;
    const uint16_t counts[3] = {tables->inputs, tables->sets, tables->points};
    emit_comment(emitter,
                 "actuator curves: number of amplifiers, number of curves, points of a curve");
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emit_reals(emitter, "curve_voltage", tables->voltage, points,
               "voltages of the points of each actuator curve (V)");
    emit_reals(emitter, "curve_effect", tables->effect, points,
               "effects at these points, to which the displacements are proportional (V)");
    if (tables->bend)
        emit_reals(emitter, "curve_bend", tables->bend, points - tables->sets,
                   "bends of the segments of each actuator curve");
    emit_begin(emitter, "actuator_curves", "actuator_curves", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %u,\n    %s_curve_voltage, %s_curve_effect, ", counts[0],
            counts[1], counts[2], emitter->prefix, emitter->prefix);
    write_shared(emitter, tables->bend, "curve_bend");
    fputs("\n};\n", emitter->file);
}

static void write_supervision(emitter *emitter, const loop_blocks *blocks)
{
    const pzs_supervision *tables = &blocks->supervision;
    const uint16_t counts[6] = {tables->inputs,      tables->timeout,        tables->ramp_ticks,
                                tables->alarm_ticks, tables->polarity_ticks, tables->waits};
    const double settings[4] = {tables->fading, tables->noise, tables->load, tables->slack};
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emit_inside(emitter, "park", tables->park, blocks->design->lower, blocks->design->upper,
                tables->inputs, "voltages to which the supervisor parks the amplifiers (V)");
    emitter->crc32 = emit_crc_reals(emitter->crc32, settings, 4);
    emit_begin(emitter, "supervision", "supervision", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %u, %u, %u, %u,\n    %s_park, ", counts[0], counts[1],
            counts[2], counts[3], counts[4], counts[5], emitter->prefix);
    for (int i = 0; i < 4; i++)
        fprintf(emitter->file, "PZS_R(%.17g), ", settings[i]);
    fputs("\n};\n", emitter->file);
}

/*
 * Write the arrays of the block (stage of the tick) that damps vibration, in the order of the
 * members of their type.
 */
static void write_damper_arrays(emitter *emitter, const pzs_vibration *tables)
{
    const size_t modes = tables->modes, inputs = tables->inputs, sensors = tables->sensors;
    const size_t few = tables->reading ? sensors : 0;
    emit_reals(emitter, "mode_shape", tables->shape, tables->outputs * modes,
               "displacement of each target node (row) in each observed mode (column)");
    if (few)
        emit_reals(emitter, "mode_reading", tables->reading, few * modes,
                   "change of each reading (row) in each observed mode (column)");
    emitter->crc32 = emit_crc_reals(emitter->crc32, tables->direct, few * inputs);
    emitter->crc32 = emit_crc_reals(emitter->crc32, tables->gain, few * tables->outputs);
    if (tables->precision)
        emit_reals(emitter, "precision", tables->precision, sensors,
                   "relative inverse variance of the noise of each reading");
    emit_reals(emitter, "modal", tables->modal, modes * inputs,
               "coordinate of each mode in equilibrium (row) per volt of each amplifier (column)");
    emit_reals(emitter, "turn", tables->turn, 4 * modes, "propagator of each mode over one tick");
    emit_reals(emitter, "observer", tables->observer, 3 * modes * modes,
               "observer gains for position, velocity and load of each mode");
    emit_reals(emitter, "explain", tables->explain, modes * modes,
               "matrix that fits the observed modes to the readings by least squares");
    emit_reals(emitter, "damping", tables->damping, modes * inputs,
               "damping gradient of each amplifier (column) per deviation of each mode (row)");
    emit_reals(emitter, "inverse_angle", tables->inverse_angle, modes,
               "inverse angle that each mode turns in a tick (1/rad)");
}

static void write_damper(emitter *emitter, const loop_blocks *blocks)
{
    const pzs_vibration *tables = &blocks->damper->tables;
    const uint16_t counts[5] = {tables->inputs, tables->outputs, tables->sensors, tables->modes,
                                tables->delay};
    const double settings[3] = {tables->share, tables->mix, tables->slow};
    emit_comment_begin(emitter);
    emit_comment_lines(emitter,
                       "natural frequencies of the modes that the control tick damps (Hz):");
    for (int i = 0; i < blocks->damper->modes; i++) {
        if (i % 10 == 0)
            fputs(i == 0 ? " *" : "\n *", emitter->file);
        fprintf(emitter->file, " %.5g", blocks->damper->frequency[i]);
    }
    fputc('\n', emitter->file);
    emit_comment_end(emitter);
    fprintf(emitter->file, "#define %s_MODES %u\n", emitter->upper, tables->modes);
    emit_comment(emitter,
                 "age of a sensor reading when a tick uses it (ticks), as the vibration block "
                 "expects it");
    fprintf(emitter->file, "#define %s_DAMPER_DELAY %u\n", emitter->upper, tables->delay);
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    write_damper_arrays(emitter, tables);
    emitter->crc32 = emit_crc_reals(emitter->crc32, settings, 3);
    if (tables->lag)
        emit_reals(emitter, "lag", tables->lag, 2 + 2 * (size_t)tables->modes,
                   "lag of the amplifiers: part of the distance from its command that an output "
                   "keeps over a tick, mean of this part, weights of velocity and distance of "
                   "each mode");
    emit_begin(emitter, "vibration", "vibration", tables->scene, tables->crc);
    fprintf(emitter->file, " %u, %u, %u, %u, %u,\n    %s_mode_shape, ", tables->inputs,
            tables->outputs, tables->sensors, tables->modes, tables->delay, emitter->prefix);
    write_shared(emitter, tables->reading, "mode_reading");
    write_shared(emitter, tables->direct, "direct");
    write_shared(emitter, tables->gain, "gain");
    write_shared(emitter, tables->precision, "precision");
    static const char *const rest[] = {"modal",   "turn",    "observer",
                                       "explain", "damping", "inverse_angle"};
    for (size_t i = 0; i < sizeof rest / sizeof *rest; i++)
        fprintf(emitter->file, "%s_%s, ", emitter->prefix, rest[i]);
    for (int i = 0; i < 3; i++)
        fprintf(emitter->file, "PZS_R(%.17g), ", settings[i]);
    write_shared(emitter, tables->lag, "lag");
    fputs("\n};\n", emitter->file);
}

/* ---- memory of the blocks ---------------------------------------------- */

/*
 * Define, for the type `name` of a block of the control loop, the function name_bytes, which
 * returns the memory of such a block (bytes), and the string name_macro for the generated header.
 * In single precision the memory is an upper bound: pointers and reals in structs are counted with
 * their size on this computer.
 *   expression in  call of the library's macro for this memory, the text in name_macro
 */
#define BLOCK_BYTES(name, expression)                                                              \
    static const char name##_macro[] = #expression;                                                \
    static size_t name##_bytes(const block_counts *of, bool is_single)                             \
    {                                                                                              \
        if (is_single) {                                                                           \
            typedef float pzs_real;                                                                \
            return expression;                                                                     \
        }                                                                                          \
        return expression;                                                                         \
    }

BLOCK_BYTES(loop, PZS_LOOP_BYTES(0, of->inputs))
BLOCK_BYTES(selftest, PZS_SELFTEST_BLOCK_BYTES(of->inputs, of->readings))
BLOCK_BYTES(reading_delay, PZS_READING_DELAY_BLOCK_BYTES(of->inputs, of->readings, of->delay))
BLOCK_BYTES(sensor_gate,
            PZS_SENSOR_GATE_BLOCK_BYTES(of->readings, of->gate_relations, of->gate_most))
BLOCK_BYTES(feed_forward, PZS_FEED_FORWARD_BLOCK_BYTES(of->readings, of->outputs))
BLOCK_BYTES(governor, PZS_GOVERNOR_BLOCK_BYTES(of->inputs, of->outputs))
BLOCK_BYTES(modal_gains, PZS_MODAL_GAINS_BLOCK_BYTES(of->inputs, of->gain_modes))
BLOCK_BYTES(free_functions, PZS_FREE_FUNCTIONS_BLOCK_BYTES(of->outputs, of->free_functions))
BLOCK_BYTES(estimator, PZS_ESTIMATOR_BLOCK_BYTES(of->readings, of->outputs))
BLOCK_BYTES(vibration, PZS_VIBRATION_BLOCK_BYTES(of->modes, of->inputs, of->outputs, of->readings,
                                                 of->damper_delay))
BLOCK_BYTES(lag_vibration, PZS_VIBRATION_BLOCK_LAG_BYTES(of->modes, of->inputs, of->outputs,
                                                         of->readings, of->damper_delay))
BLOCK_BYTES(effect, PZS_EFFECT_BLOCK_BYTES(of->inputs, of->plays, of->creeps))
BLOCK_BYTES(inverse, PZS_INVERSE_BLOCK_BYTES(of->inputs))
BLOCK_BYTES(curve, PZS_CURVE_BLOCK_BYTES(of->inputs))
BLOCK_BYTES(curve_inverse, PZS_CURVE_INVERSE_BLOCK_BYTES(of->inputs))
BLOCK_BYTES(step, PZS_STEP_BLOCK_BYTES(of->inputs, of->outputs))
BLOCK_BYTES(row_step, PZS_STEP_BLOCK_ROW_BYTES(of->inputs, of->outputs, of->rows))
BLOCK_BYTES(amplifier, PZS_AMPLIFIER_BLOCK_BYTES(of->inputs))
BLOCK_BYTES(fault_detector, PZS_FAULT_DETECTOR_BLOCK_BYTES(of->inputs, of->outputs, of->delay))
BLOCK_BYTES(pulse_detector, PZS_PULSE_DETECTOR_BLOCK_BYTES(of->inputs, of->readings, of->outputs))
BLOCK_BYTES(supervisor, PZS_SUPERVISOR_BLOCK_BYTES(of->outputs))

/* ---- the table of block types ----------------------------------------- */

/*
 * Types of blocks (stages of a control tick). Members of a row:
 *   is_present   whether a scene needs the block
 *   tables       fills the tables of the block and returns their address
 *   type_name    name of the block type in generated C source: pzs_NAME_block
 *   tables_name  ending of the name of the tables in generated C source, after the common prefix
 *   bytes        memory that the block needs in the loop (bytes)
 *   bytes_macro  C source of this size, written into the generated header
 *   work         upper bound of the instructions of the block in a tick
 */
static const struct {
    const pzs_block_type *type;
    bool (*is_present)(const loop_blocks *l);
    const void *(*tables)(loop_blocks *l);
    void (*write)(emitter *w, const loop_blocks *l); /* function that writes the tables of a block
                                                        (stage of the control tick) as C source;
                                                        NULL: they are written elsewhere, together
                                                        with the arrays to which they point */
    const char *type_name, *tables_name;
    size_t (*bytes)(const block_counts *of, bool is_single);
    const char *bytes_macro;
    loop_work_bound *work;
} block_types[] = {
    {&pzs_selftest_block, has_selftest, selftest_tables, write_selftest, "selftest", "selftest",
     selftest_bytes, selftest_macro, loop_work_selftest},
    {&pzs_curve_block, has_curves, curve_tables, write_curves, "curve", "actuator_curves",
     curve_bytes, curve_macro, loop_work_curve},
    {&pzs_effect_block, has_compensation, compensation_tables, write_compensation, "effect",
     "hysteresis", effect_bytes, effect_macro, loop_work_effect},
    {&pzs_sensor_gate_block, has_gate, gate_tables, write_gate, "sensor_gate", "sensor_gate",
     sensor_gate_bytes, sensor_gate_macro, loop_work_gate},
    {&pzs_reading_delay_block, has_delay, delay_tables, write_delay, "reading_delay",
     "reading_delay", reading_delay_bytes, reading_delay_macro, loop_work_delay},
    {&pzs_feed_forward_block, has_feed_forward, known_tables, write_known, "feed_forward",
     "known_loads", feed_forward_bytes, feed_forward_macro, loop_work_feed_forward},
    {&pzs_governor_block, has_governor, governor_tables, write_governor, "governor", "governor",
     governor_bytes, governor_macro, loop_work_governor},
    {&pzs_modal_gains_block, has_modal_gains, modal_gains_tables, write_modal_gains, "modal_gains",
     "modal_gains", modal_gains_bytes, modal_gains_macro, loop_work_modal_gains},
    {&pzs_free_functions_block, has_free_functions, free_functions_tables, write_free_functions,
     "free_functions", "free_functions", free_functions_bytes, free_functions_macro,
     loop_work_free_functions},
    {&pzs_estimator_block, has_estimator, estimator_tables, NULL, "estimator", "estimator",
     estimator_bytes, estimator_macro, loop_work_estimator},
    {&pzs_vibration_block, has_no_lag, damper_tables, write_damper, "vibration", "vibration",
     vibration_bytes, vibration_macro, loop_work_vibration},
    {&pzs_vibration_block, has_lag, damper_tables, write_damper, "vibration", "vibration",
     lag_vibration_bytes, lag_vibration_macro, loop_work_lag_vibration},
    {&pzs_step_block, has_no_rows, problem_tables, NULL, "step", "problem", step_bytes, step_macro,
     loop_work_step},
    {&pzs_step_block, has_rows, problem_tables, NULL, "step", "problem", row_step_bytes,
     row_step_macro, loop_work_row_step},
    {&pzs_curve_inverse_block, has_curves, curve_tables, NULL, "curve_inverse", "actuator_curves",
     curve_inverse_bytes, curve_inverse_macro, loop_work_curve_inverse},
    {&pzs_inverse_block, has_compensation, compensation_tables, NULL, "inverse", "hysteresis",
     inverse_bytes, inverse_macro, loop_work_inverse},
    {&pzs_amplifier_block, has_amplifier, amplifier_tables, write_amplifier, "amplifier",
     "amplifier", amplifier_bytes, amplifier_macro, loop_work_amplifier},
    {&pzs_fault_detector_block, has_detector, detection_tables, write_detection, "fault_detector",
     "fault_detection", fault_detector_bytes, fault_detector_macro, loop_work_detector},
    {&pzs_pulse_detector_block, has_pulse_detector, pulse_tables, write_pulse_detection,
     "pulse_detector", "pulse_detection", pulse_detector_bytes, pulse_detector_macro,
     loop_work_pulse_detector},
    {&pzs_supervisor_block, has_supervisor, supervision_tables, write_supervision, "supervisor",
     "supervision", supervisor_bytes, supervisor_macro, loop_work_supervisor},
};
enum { BLOCK_TYPES = sizeof block_types / sizeof *block_types };

/* List the blocks of the control loop (tasks of a tick) that the scene needs, with their tables. */
static void list_blocks(loop_blocks *blocks)
{
    blocks->count = 0;
    for (int k = 0; k < BLOCK_TYPES; k++)
        if (block_types[k].is_present(blocks))
            blocks->block[blocks->count++] =
                (pzs_block){block_types[k].type, block_types[k].tables(blocks)};
}

void loop_blocks_test(loop_blocks *blocks, const wiring_test *wiring, const wiring_test *pulses)
{
    blocks->wiring = wiring;
    blocks->pulses = pulses;
    list_blocks(blocks);
}

void loop_blocks_gate(loop_blocks *blocks, const sensor_gate *gate)
{
    blocks->gate = gate;
    list_blocks(blocks);
}

void loop_blocks_fill(loop_blocks *blocks, const design *design, const estimator *estimator,
                      const damper *damper)
{
    memset(blocks, 0, sizeof *blocks);
    blocks->design = design;
    blocks->estimator = estimator;
    blocks->damper = damper;
    scene_hysteresis weaker = design->hysteresis;
    compensation_weaken(&weaker);
    compensation_fill(&blocks->compensation, &weaker, &design->problem, design->control.rate);
    compensation_identify(&blocks->compensation, &design->hysteresis);
    list_blocks(blocks);
}

static int count_readings(const loop_blocks *blocks)
{
    return loop_estimates(blocks->design) ? blocks->estimator->sensors : blocks->design->targets;
}

/*
 * Return the largest number of plays (elements with backlash of the hysteresis model) that can
 * begin to move or reverse in one tick. A change of the voltage can affect only plays whose slacks
 * (half widths of the backlash) lie within twice that change of each other.
 */
static size_t near_plays(const loop_blocks *blocks)
{
    const pzs_hysteresis *tables = &blocks->compensation.tables;
    double reach = 0;
    size_t most = 0;
    for (int k = 0; k < blocks->design->amplifiers; k++)
        reach = fmax(reach, blocks->design->step_limit[k]);
    for (size_t i = 0; i < tables->plays; i++) {
        size_t near = 0;
        for (size_t j = i; j < tables->plays; j++)
            near += tables->slack[j] - tables->slack[i] <= 2 * reach;
        most = near > most ? near : most;
    }
    return most;
}

/* Return the number of blocks (stages) of the control tick that a scene needs. */
static size_t count_blocks(const loop_blocks *blocks)
{
    size_t present = 0;
    for (int k = 0; k < BLOCK_TYPES; k++)
        present += block_types[k].is_present(blocks);
    return present;
}

bool loop_blocks_read_entries(const loop_blocks *blocks)
{
    const bool has_own_matrix = loop_estimates(blocks->design);
    return has_detector(blocks) || has_pulse_detector(blocks) ||
           (!has_own_matrix && (has_selftest(blocks) || has_delay(blocks)));
}

/* Return the number of coefficients in all limits of sums of voltages. */
static size_t count_row_entries(const loop_blocks *blocks)
{
    const pzs_limit_rows *rows = blocks->design->problem.limit_rows;
    return rows ? rows->sums.start[rows->sums.count] : 0;
}

/* Return the tables of the sensor gate, with all sizes 0 where the loop has none. */
static pzs_sensor_gate gate_sizes(const loop_blocks *blocks)
{
    const pzs_sensor_gate none = {.relations = 0};
    return has_gate(blocks) ? blocks->gate->tables : none;
}

static block_counts count(const loop_blocks *blocks)
{
    const sparse_facts sparse =
        sparse_tables_count(blocks->design, loop_blocks_read_entries(blocks));
    const size_t entries = sparse.is_used ? sparse.entries : 0;
    const pzs_sensor_gate gate = gate_sizes(blocks);
    const block_counts of = {
        .inputs = blocks->design->problem.inputs,
        .outputs = blocks->design->problem.outputs,
        .rows = (size_t)blocks->design->limits.rows,
        .row_entries = count_row_entries(blocks),
        .readings = (size_t)count_readings(blocks),
        .modes = blocks->damper->tables.modes,
        .plays = blocks->compensation.tables.plays,
        .creeps = blocks->compensation.tables.creeps,
        .loads = loop_feeds(blocks->design) ? blocks->estimator->shape_table.inputs : 0,
        .entries = entries,
        .gate_relations = gate.relations,
        .gate_quick = gate.quick,
        .gate_most = gate.most,
        .has_gains = has_modal_gains(blocks),
        .gain_modes = blocks->design->gains.tables.modes,
        .has_other_leak = blocks->design->gains.tables.other_leak > 0,
        .free_functions = (size_t)blocks->design->free_functions,
        .blocks = count_blocks(blocks),
        .delay = (size_t)blocks->design->simulate.delay,
        .damper_delay = blocks->damper->tables.delay,
        .near_plays = near_plays(blocks),
        .is_damped = blocks->damper->is_used,
        .detects_faults = has_detector(blocks),
        .moves_outside = has_amplifier(blocks) || has_compensation(blocks) || has_curves(blocks) ||
                         has_detector(blocks),
        .work_limit = blocks->problem.work_limit};
    return of;
}

size_t loop_blocks_bytes(const loop_blocks *blocks, bool is_single)
{
    const block_counts of = count(blocks);
    size_t bytes = loop_bytes(&of, is_single);
    for (int k = 0; k < BLOCK_TYPES; k++)
        bytes += block_types[k].is_present(blocks) ? block_types[k].bytes(&of, is_single) : 0;
    return bytes;
}

/* ---- instructions of the blocks ---------------------------------------- */

/*
 * Return an upper bound of the processor instructions of one tick in which the loop controls the
 * voltages. A tick of the self-test, which runs before, may take more instructions.
 */
static double tick_bound(const loop_blocks *blocks, const block_counts *of,
                         const loop_processor *on)
{
    double sum = loop_work_rest(of, on);
    for (int k = 0; k < BLOCK_TYPES; k++)
        if (block_types[k].is_present(blocks) && block_types[k].type->phase != PZS_PHASE_COMMISSION)
            sum += block_types[k].work(of, on);
    return sum;
}

/*
 * Return the smallest useful limit of the optimiser's work in one tick (multiply-adds), as the
 * controller computes it.
 */
static uint64_t least_work(const pzs_problem *problem)
{
    return problem->limit_rows ? problem->limit_rows->call->least_work(problem)
                               : PZS_WORK_LEAST(problem->inputs);
}

static uint64_t usual_work(const pzs_problem *problem)
{
    return problem->limit_rows ? problem->limit_rows->call->usual_work(problem)
                               : PZS_WORK_LIMIT(problem->inputs);
}

/*
 * Return the limit of the optimiser's work in one tick (multiply-adds) that lets all blocks
 * (stages) finish within a tick of the scene's clock and tick rate. It is at least the smallest
 * useful limit. If the scene does not state clock and tick rate, the result is 0: the library's
 * default.
 */
static uint64_t work_limit(const loop_blocks *blocks)
{
    const scene_control *control = &blocks->design->control;
    const loop_processor *on = &loop_processor_table[0];
    const uint64_t least = least_work(&blocks->design->problem);
    block_counts of = count(blocks);
    if (!(control->clock > 0) || !(control->rate > 0))
        return 0;
    of.work_limit = 0;
    const double others = tick_bound(blocks, &of, on);
    of.work_limit = 1;
    const double each = tick_bound(blocks, &of, on) - others;
    const double left = control->clock / control->rate / LOOP_WORK_CYCLES - others;
    const double most = fmin(left / each, (double)usual_work(&blocks->design->problem));
    return most > (double)least ? (uint64_t)most : least;
}

uint64_t loop_blocks_work_limit(const loop_blocks *blocks)
{
    const block_counts of = count(blocks);
    return of.work_limit > 0 ? of.work_limit : usual_work(&blocks->design->problem);
}

void loop_blocks_bound(const loop_blocks *blocks, const loop_processor *on, loop_bounds *bounds)
{
    block_counts of = count(blocks);
    of.work_limit = loop_blocks_work_limit(blocks);
    *bounds = (loop_bounds){.rest = loop_work_rest(&of, on), .all = tick_bound(blocks, &of, on)};
    for (int k = 0; k < BLOCK_TYPES; k++) {
        if (!block_types[k].is_present(blocks))
            continue;
        bounds->block[bounds->count].type = block_types[k].type;
        bounds->block[bounds->count++].most = block_types[k].work(&of, on);
    }
}

/* ---- list of blocks as C source --------------------------------------- */

/*
 * Write the text of a macro for the generated header. Each expression `of->name` in the text is
 * replaced by the macro PREFIX_NAME.
 */
static void write_macro(const emitter *emitter, const char *text)
{
    bool is_name = false;
    for (; *text; text++) {
        if (strncmp(text, "of->", 4) == 0) {
            fprintf(emitter->file, "%s_", emitter->upper);
            text += 4;
            is_name = true;
        }
        is_name = is_name && (isalnum((unsigned char)*text) || *text == '_');
        fputc(is_name ? toupper((unsigned char)*text) : *text, emitter->file);
    }
}

static void write_bytes(const emitter *emitter, const loop_blocks *blocks)
{
    fprintf(emitter->file, "#define %s_LOOP_BYTES \\\n    (", emitter->upper);
    write_macro(emitter, loop_macro);
    for (int k = 0; k < BLOCK_TYPES; k++) {
        if (!block_types[k].is_present(blocks))
            continue;
        fputs(" + \\\n     ", emitter->file);
        write_macro(emitter, block_types[k].bytes_macro);
    }
    fputs(")\n\n", emitter->file);
}

/*
 * Write the list of the blocks (stages) of the control tick as a C array, each with an upper bound
 * of its instructions in a tick.
 */
static void write_list(const emitter *emitter, const loop_blocks *blocks)
{
    loop_bounds bounds;
    loop_blocks_bound(blocks, &loop_processor_table[0], &bounds);
    fprintf(emitter->file,
            "    /* %s: at most %.0f instructions in a tick, %.0f of them outside the blocks */\n",
            loop_processor_table[0].name, bounds.all, bounds.rest);
    for (int k = 0, i = 0; k < BLOCK_TYPES; k++)
        if (block_types[k].is_present(blocks))
            fprintf(emitter->file,
                    "    {&pzs_%s_block, &%s_%s}, /* at most %.0f instructions of this block in a "
                    "tick */\n",
                    block_types[k].type_name, emitter->prefix, block_types[k].tables_name,
                    bounds.block[i++].most);
}

void loop_blocks_write(emitter *emitter, const loop_blocks *blocks)
{
    const design *design = blocks->design;
    for (int k = 0; k < BLOCK_TYPES; k++)
        if (block_types[k].write && block_types[k].is_present(blocks))
            block_types[k].write(emitter, blocks);
    const int readings = count_readings(blocks);
    emit_comment(emitter, "blocks of the control tick in the order in which they run, as in "
                          "`pzs simulate`");
    fprintf(emitter->file,
            "#define %s_BLOCKS %d\n#define %s_READINGS %d\n#define %s_DELAY %d\n"
            "static const pzs_block %s_blocks[%s_BLOCKS] = {\n",
            emitter->upper, blocks->count, emitter->upper, readings, emitter->upper,
            design->simulate.delay, emitter->prefix, emitter->upper);
    write_list(emitter, blocks);
    fputs("};\n", emitter->file);
    write_bytes(emitter, blocks);
}

/* ---- list of blocks with all it refers to -------------------------------- */

int loop_parts_open(loop_parts *parts, const analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    memset(parts, 0, sizeof *parts);
    if (estimator_open(&parts->estimator, analysis, error) < 0)
        return -1;
    const estimator *few = loop_estimates(design) ? &parts->estimator : NULL;
    if (damper_open(&parts->damper, analysis, few, error) < 0) {
        estimator_close(&parts->estimator);
        return -1;
    }
    const bool has_test = wiring_test_open(&parts->wiring, analysis, few);
    const bool has_pulses = wiring_test_detector_open(&parts->pulses, analysis, few);
    loop_blocks_fill(&parts->blocks, design, &parts->estimator, &parts->damper);
    loop_blocks_test(&parts->blocks, &parts->wiring, &parts->pulses);
    const bool has_gate = loop_gate_open(&parts->gate, analysis, &parts->estimator, &parts->damper);
    loop_blocks_gate(&parts->blocks, &parts->gate);
    if (has_test && has_pulses && has_gate)
        return 0;
    loop_parts_close(parts);
    return scene_fault(design->simulate.at, error,
                       "not enough memory for the test pulses and the sensor gate");
}

void loop_parts_close(loop_parts *parts)
{
    wiring_test_close(&parts->wiring);
    wiring_test_close(&parts->pulses);
    sensor_gate_close(&parts->gate);
    damper_close(&parts->damper);
    estimator_close(&parts->estimator);
}

/* ---- names of amplifiers and sensors ---------------------------------- */

/*
 * Write an enumeration constant PREFIX_KIND_name whose value is the index of an amplifier or of a
 * sensor reading. A name that is not a C identifier gets the index as a suffix, so that different
 * names stay different.
 */
static void write_index(const emitter *emitter, const char *kind, const char *name, int index)
{
    int changed = 0;
    fprintf(emitter->file, "    %s_%s_", emitter->upper, kind);
    for (; *name; name++) {
        const int fits = isalnum((unsigned char)*name) || *name == '_';
        fputc(fits ? *name : '_', emitter->file);
        changed |= !fits;
    }
    if (changed)
        fprintf(emitter->file, "_%d", index);
    fprintf(emitter->file, " = %d,\n", index);
}

static void write_amplifiers(const emitter *emitter, const design *design)
{
    emit_comment(emitter, "index of each amplifier in info.voltage and for pzs_hold");
    fputs("enum {\n", emitter->file);
    for (int k = 0; k < design->amplifiers; k++)
        write_index(emitter, "INPUT", design->amplifier_name[k], k);
    fputs("};\n", emitter->file);
}

/*
 * Write the indices of the readings that the shape estimator uses as enumeration constants: NAME
 * for an output with one value, or NAME_1, NAME_2 and so on for an output with several values.
 */
static void write_sensors(const emitter *emitter, const analysis *analysis)
{
    const design *design = &analysis->design;
    char name[SCENE_NAME + 16];
    int index = 0;
    if (!loop_estimates(design))
        return;
    emit_comment(emitter, "index of each reading in the array of the sensors' readings");
    fputs("enum {\n", emitter->file);
    for (int reading = 0; reading < design->estimate.readings; reading++) {
        const scene_output *output = &design->output[design->estimate.reading[reading].output];
        const int count = analysis_outputs(analysis, design->estimate.reading[reading].output);
        for (int i = 1; i <= count; i++) {
            if (count == 1)
                snprintf(name, sizeof name, "%s", output->name);
            else
                snprintf(name, sizeof name, "%s_%d", output->name, i);
            write_index(emitter, "SENSOR", name, index++);
        }
    }
    fputs("};\n", emitter->file);
}

/*
 * Write a comment that lists the outputs of a measured influence matrix: their rows in the file of
 * the matrix, counted from 1, names and coordinates.
 */
static void write_rows(const emitter *emitter, const design *design)
{
    const scene_influence *influence = &design->measured;
    emit_comment_begin(emitter);
    emit_comment_lines(emitter, "Outputs: rows of the file with the measured influence matrix");
    emit_comment_lines(emitter, influence->file);
    fprintf(emitter->file, " * output  row  x  y  z (%s)\n", design->units.length);
    for (int i = 0; i < design->targets; i++) {
        const int row = influence->row[i];
        char line[SCENE_LABEL + 120];
        int at = snprintf(line, sizeof line, "%6d %5d", i, row + 1);
        for (int axis = 0; axis < 3 && influence->place; axis++)
            at +=
                snprintf(line + at, sizeof line - (size_t)at, "  %.6g", influence->place[i][axis]);
        if (influence->output_name)
            snprintf(line + at, sizeof line - (size_t)at, "  %s", influence->output_name[row]);
        emit_comment_lines(emitter, line);
    }
    emit_comment_end(emitter);
}

static void write_nodes(const emitter *emitter, const design *design)
{
    static const char *const component[COMPONENT_Z + 1] = {
        [COMPONENT_U1] = "u1", [COMPONENT_U2] = "u2", [COMPONENT_U3] = "u3",
        [COMPONENT_X] = "x",   [COMPONENT_Y] = "y",   [COMPONENT_Z] = "z"};
    static const char *const face[] = {[FACE_OUTER] = "outer face",
                                       [FACE_INNER] = "inner face",
                                       [FACE_MIDDLE] = "middle surface",
                                       [FACE_MEAN] = "mean of both faces"};
    const scene_output *what = &design->goal.what;
    const mesh_size size = mesh_size_of(&design->mesh);
    emit_comment_begin(emitter);
    fprintf(emitter->file,
            " * Outputs of the controller: displacement %s (%s) of the %s at these mesh nodes.\n"
            " * output  node  %s\n",
            component[what->component], design->units.length, face[what->face],
            design->quads ? "x  y  z" : "surface coordinates theta1  theta2");
    for (int i = 0; i < design->targets; i++) {
        const int node = design->target_node[i];
        const double *theta = design->mesh.theta[node], *place = design->mesh.point[node].position;
        fprintf(emitter->file, " * %6d %5d", i, node);
        for (int axis = 0; axis < 3 && design->quads; axis++)
            fprintf(emitter->file, "  %.6g", mesh_shown(place[axis], size.position));
        for (int axis = 0; axis < 2 && !design->quads; axis++)
            fprintf(emitter->file, "  %.6g", mesh_shown(theta[axis], size.theta[axis]));
        fputc('\n', emitter->file);
    }
    emit_comment_end(emitter);
}

void loop_names_write(emitter *emitter, const analysis *analysis)
{
    const design *design = &analysis->design;
    if (design->control.rate > 0) {
        emit_comment(emitter, "tick rate (1/s)");
        fprintf(emitter->file, "#define %s_TICK_RATE PZS_R(", emitter->upper);
        emit_real(emitter->file, design->control.rate);
        fputs(")\n", emitter->file);
    }
    write_amplifiers(emitter, design);
    write_sensors(emitter, analysis);
    (design->measured.given ? write_rows : write_nodes)(emitter, design);
    fputs("\n", emitter->file);
}
