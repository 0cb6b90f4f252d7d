/* SPDX-License-Identifier: BSD-2-Clause */
#include "damped_loop.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/propagator.h"
#include <cmocka.h>
#include "bridge.h"
#include "uniform.h"

static const double pi = 3.14159265358979323846;

static double *zeros(size_t count)
{
    double *zero = calloc(count + 1, sizeof *zero);
    assert_non_null(zero);
    return zero;
}

/* ---- structures ------------------------------------------------------- */

void structure_open(modal_structure *structure, size_t modes, size_t outputs, size_t inputs)
{
    *structure = (modal_structure){.modes = modes, .outputs = outputs, .inputs = inputs};
    structure->omega = zeros(modes);
    structure->ratio = zeros(modes);
    structure->shape = zeros(outputs * modes);
    structure->modal = zeros(modes * inputs);
    structure->load = zeros(modes);
    structure->influence = zeros(outputs * inputs);
    structure->load_shape = zeros(outputs);
    structure->goal = zeros(outputs);
}

void structure_close(modal_structure *structure)
{
    free(structure->omega);
    free(structure->ratio);
    free(structure->shape);
    free(structure->modal);
    free(structure->load);
    free(structure->influence);
    free(structure->load_shape);
    free(structure->goal);
}

/* Set influence and load_shape to the sums over the modes. */
static void add_up_modes(modal_structure *structure)
{
    for (size_t i = 0; i < structure->outputs; i++)
        for (size_t k = 0; k < structure->modes; k++) {
            const double coordinate = structure->shape[i * structure->modes + k];
            structure->load_shape[i] += coordinate * structure->load[k];
            for (size_t j = 0; j < structure->inputs; j++)
                structure->influence[i * structure->inputs + j] +=
                    coordinate * structure->modal[k * structure->inputs + j];
        }
}

void structure_scale(modal_structure *structure)
{
    for (size_t k = 0; k < structure->modes; k++) {
        double sum = 0;
        for (size_t i = 0; i < structure->outputs; i++)
            sum += pow(structure->shape[i * structure->modes + k], 2);
        const double size = sqrt(sum / (double)structure->outputs);
        for (size_t i = 0; i < structure->outputs; i++)
            structure->shape[i * structure->modes + k] /= size;
        for (size_t j = 0; j < structure->inputs; j++)
            structure->modal[k * structure->inputs + j] *= size;
        structure->load[k] *= size;
    }
}

/* Set a target that can be reached: the shape of random voltages of about a third of the limit. */
static void set_goal(modal_structure *structure, unsigned seed)
{
    for (size_t j = 0; j < structure->inputs; j++) {
        double sum = 0;
        for (int i = 0; i < 12; i++)
            sum += uniform(&seed, -0.5, 0.5);
        for (size_t i = 0; i < structure->outputs; i++)
            structure->goal[i] +=
                structure->influence[i * structure->inputs + j] * 0.35 * structure->limit * sum;
    }
}

void structure_of_plate(modal_structure *structure, size_t modes)
{
    bridge tables;
    bridge_modes mode_tables;
    char error[400];
    assert_int_equal(bridge_open(&tables, "plate-50-patches",
                                 (const char *[]){"loads=[{face: outer, pressure: 20}]"}, 1, error),
                     0);
    assert_int_equal(bridge_modes_open(&mode_tables, &tables, (int)modes, error), 0);
    structure_open(structure, modes, (size_t)tables.targets, (size_t)tables.amplifiers);
    const size_t inputs = (size_t)tables.input.count;
    memcpy(structure->omega, mode_tables.frequency, modes * sizeof *structure->omega);
    memcpy(structure->shape, mode_tables.shape,
           structure->outputs * modes * sizeof *structure->shape);
    memcpy(structure->modal, mode_tables.modal,
           modes * structure->inputs * sizeof *structure->modal);
    memcpy(structure->load, mode_tables.load, modes * sizeof *structure->load);
    memcpy(structure->load_shape, mode_tables.load_shape,
           structure->outputs * sizeof *structure->load_shape);
    for (size_t i = 0; i < structure->outputs; i++) {
        structure->goal[i] = tables.target[i] / 2;
        for (size_t j = 0; j < structure->inputs; j++)
            structure->influence[i * structure->inputs + j] = tables.influence[i * inputs + j];
    }
    for (size_t k = 0; k < modes; k++)
        structure->ratio[k] = 0.005;
    structure->limit = 300;
    structure_scale(structure);
    bridge_modes_close(&mode_tables);
    bridge_close(&tables);
}

/* Half waves (a, b) of a vibration mode of a plate; modes are sorted by frequency. */
typedef struct plate_mode {
    double square;
    size_t a, b;
} plate_mode;

static int compare_modes(const void *left, const void *right)
{
    const plate_mode *first = left, *second = right;
    return (first->square > second->square) - (first->square < second->square);
}

/* Integral of sin(a pi x / length) over patch k of n, which is a little narrower than its cell. */
static double over_patch(size_t half_wave, size_t k, size_t patches, double length)
{
    const double cell = length / (double)patches, from = cell * ((double)k + 0.04),
                 to = cell * ((double)k + 0.96), wave = (double)half_wave * pi / length;
    return (cos(wave * from) - cos(wave * to)) / wave;
}

static void fill_plate_mode(modal_structure *structure, const supported_plate *plate, size_t k,
                            plate_mode mode)
{
    const double wave_a = (double)mode.a * pi / plate->length, wave_b = (double)mode.b * pi;
    const double squares = structure->omega[k] * structure->omega[k];
    for (size_t column = 0; column < plate->points_x; column++)
        for (size_t row = 0; row < plate->points_y; row++)
            structure->shape[(column * plate->points_y + row) * structure->modes + k] =
                sin(wave_a * plate->length * ((double)column + 0.5) / (double)plate->points_x) *
                sin(wave_b * ((double)row + 0.5) / (double)plate->points_y);
    for (size_t i = 0; i < plate->columns; i++)
        for (size_t j = 0; j < plate->rows; j++)
            structure->modal[k * structure->inputs + i * plate->rows + j] =
                -(wave_a * wave_a + wave_b * wave_b) *
                over_patch(mode.a, i, plate->columns, plate->length) *
                over_patch(mode.b, j, plate->rows, 1) / squares;
    structure->load[k] =
        over_patch(mode.a, 0, 1, plate->length) * over_patch(mode.b, 0, 1, 1) / squares;
}

void structure_of_supported_plate(modal_structure *structure, const supported_plate *plate)
{
    enum { HALF_WAVES = 40 };
    static plate_mode mode[HALF_WAVES * HALF_WAVES];
    structure_open(structure, plate->modes, plate->points_x * plate->points_y,
                   plate->columns * plate->rows);
    for (size_t half_waves_x = 0; half_waves_x < HALF_WAVES; half_waves_x++)
        for (size_t half_waves_y = 0; half_waves_y < HALF_WAVES; half_waves_y++)
            mode[half_waves_x * HALF_WAVES + half_waves_y] =
                (plate_mode){pow(((double)half_waves_x + 1) / plate->length, 2) +
                                 pow((double)half_waves_y + 1, 2),
                             half_waves_x + 1, half_waves_y + 1};
    qsort(mode, HALF_WAVES * HALF_WAVES, sizeof *mode, compare_modes);
    for (size_t k = 0; k < plate->modes; k++) {
        structure->omega[k] = 2 * pi * plate->first * mode[k].square / mode[0].square;
        structure->ratio[k] = plate->ratio;
        fill_plate_mode(structure, plate, k, mode[k]);
    }
    structure_scale(structure);
    structure->limit = 100;
    add_up_modes(structure);
    double largest = 0;
    for (size_t i = 0; i < structure->outputs * structure->inputs; i++)
        largest = fmax(largest, fabs(structure->influence[i]));
    const double scale = 1e-5 / largest; /* at most 10 um for each volt */
    for (size_t i = 0; i < structure->outputs * structure->inputs; i++)
        structure->influence[i] *= scale;
    for (size_t i = 0; i < structure->modes * structure->inputs; i++)
        structure->modal[i] *= scale;
    set_goal(structure, 5);
}

/* ---- tables ----------------------------------------------------------- */

static pzs_real *put(pzs_real **at, const double *value, size_t count)
{
    pzs_real *first = *at;
    for (size_t i = 0; i < count; i++)
        first[i] = (pzs_real)value[i];
    *at += count;
    return first;
}

static size_t output_of(const damped_loop *loop, size_t sensor)
{
    return loop->sensor ? loop->sensor[sensor] : sensor;
}

/*
 * Number of modes that turn by at most settings.observed in a tick, limited by the number of inputs
 * and of sensors.
 */
static size_t count_modes(const damped_loop *loop)
{
    const modal_structure *structure = loop->structure;
    size_t count = 0;
    while (count < structure->modes && count < structure->inputs && count + 1 < loop->sensors &&
           structure->omega[count] * loop->interval <= loop->settings.observed)
        count++;
    return count;
}

/*
 * Tick interval over the time constant of the amplifiers' lag, as the damper believes; 0: the lag
 * is shorter than a tick.
 */
static double lag_of(const damped_loop *loop)
{
    const double times = 2 * pi * loop->structure->bandwidth * loop->interval;
    return times < 1 ? times : 0;
}

static void compute_gains(damped_loop *loop)
{
    const modal_structure *structure = loop->structure;
    const size_t modes = loop->modes, inputs = structure->inputs;
    double *at = loop->memory = zeros(17 * modes * modes + 10 * modes + 4 * modes * inputs + 2);
    double *angle = at, *ratio = angle + modes, *square = ratio + modes, *modal = square + modes,
           *lift = modal + modes * inputs, *overlap = lift + modes * inputs;
    at = overlap + modes * modes;
    loop->gains.turn = at;
    loop->gains.inverse_angle = at + 4 * modes;
    loop->gains.damping = at + 5 * modes;
    loop->gains.explain = loop->gains.damping + modes * inputs;
    loop->gains.observer = loop->gains.explain + modes * modes;
    loop->gains.covariance = loop->gains.observer + 3 * modes * modes;
    loop->gains.lag = loop->gains.covariance + 9 * modes * modes;
    for (size_t k = 0; k < modes; k++) {
        angle[k] = structure->omega[k] * loop->interval;
        ratio[k] = structure->ratio[k];
        memcpy(modal + k * inputs, structure->modal + k * inputs, inputs * sizeof *modal);
        for (size_t i = 0; i < structure->outputs; i++) {
            square[k] += pow(structure->shape[i * structure->modes + k], 2);
            for (size_t j = 0; j < inputs; j++)
                lift[j * modes + k] += structure->influence[i * inputs + j] *
                                       structure->shape[i * structure->modes + k];
        }
        for (size_t i = 0; i < loop->sensors; i++)
            for (size_t other = 0; other < modes; other++)
                overlap[k * modes + other] +=
                    structure->shape[output_of(loop, i) * structure->modes + k] *
                    structure->shape[output_of(loop, i) * structure->modes + other];
    }
    const damper_model model = {modes, inputs,  loop->sensors, angle,  ratio,
                                modal, overlap, lift,          square, lag_of(loop)};
    assert_int_equal(damper_compute(&loop->gains, &model, &loop->settings), 0);
}

/*
 * gain [outputs][sensors] = G Gs' (Gs Gs' + 1e-4 mean diagonal)^-1, with the influence matrix G and
 * its rows Gs of the sensors.
 */
static void fill_gain(const damped_loop *loop, double *gain)
{
    const modal_structure *structure = loop->structure;
    const size_t sensors = loop->sensors, inputs = structure->inputs;
    double *matrix = zeros(sensors * sensors), trace = 0;
    for (size_t i = 0; i < sensors; i++)
        for (size_t other = 0; other < sensors; other++)
            for (size_t j = 0; j < inputs; j++)
                matrix[i * sensors + other] +=
                    structure->influence[output_of(loop, i) * inputs + j] *
                    structure->influence[output_of(loop, other) * inputs + j];
    for (size_t i = 0; i < sensors; i++)
        trace += matrix[i * sensors + i];
    for (size_t i = 0; i < sensors; i++)
        matrix[i * sensors + i] += 1e-4 * trace / (double)sensors;
    for (size_t output = 0; output < structure->outputs; output++)
        for (size_t i = 0; i < sensors; i++)
            for (size_t j = 0; j < inputs; j++)
                gain[output * sensors + i] += structure->influence[output * inputs + j] *
                                              structure->influence[output_of(loop, i) * inputs + j];
    for (size_t row = 0; row < sensors; row++) { /* Gauss-Jordan elimination on the columns of gain
                                                  */
        const double pivot = matrix[row * sensors + row];
        for (size_t i = 0; i < sensors; i++)
            matrix[i * sensors + row] /= pivot;
        for (size_t output = 0; output < structure->outputs; output++)
            gain[output * sensors + row] /= pivot;
        for (size_t other = 0; other < sensors; other++) {
            const double factor = other == row ? 0 : matrix[row * sensors + other];
            for (size_t i = 0; i < sensors; i++)
                matrix[i * sensors + other] -= factor * matrix[i * sensors + row];
            for (size_t output = 0; output < structure->outputs; output++)
                gain[output * sensors + other] -= factor * gain[output * sensors + row];
        }
    }
    free(matrix);
}

static void fill_problem(damped_loop *loop, pzs_real **at, double step_limit)
{
    const modal_structure *structure = loop->structure;
    const size_t inputs = structure->inputs;
    double *row = zeros(structure->outputs + inputs);
    loop->problem =
        (pzs_problem){.inputs = (uint16_t)inputs, .outputs = (uint16_t)structure->outputs};
    loop->problem.influence = put(at, structure->influence, structure->outputs * inputs);
    for (size_t i = 0; i < structure->outputs + inputs; i++)
        row[i] = 1;
    loop->problem.weight = put(at, row, structure->outputs);
    for (size_t i = 0; i < inputs; i++)
        row[i] = structure->limit;
    loop->problem.upper = put(at, row, inputs);
    for (size_t i = 0; i < inputs; i++)
        row[i] = -structure->limit;
    loop->problem.lower = put(at, row, inputs);
    for (size_t i = 0; i < inputs; i++)
        row[i] = step_limit;
    loop->problem.step_limit = put(at, row, inputs);
    memset(row, 0, inputs * sizeof *row);
    loop->problem.reference_voltage = put(at, row, inputs);
    double trace = 0;
    for (size_t i = 0; i < structure->outputs * inputs; i++)
        trace += structure->influence[i] * structure->influence[i];
    loop->problem.regularisation = (pzs_real)(1e-6 * trace / (double)inputs);
    free(row);
    assert_int_equal(pzs_problem_seal(&loop->problem), PZS_OK);
}

static void fill_vibration(damped_loop *loop, pzs_real **at, int delay)
{
    const modal_structure *structure = loop->structure;
    const size_t modes = loop->modes, inputs = structure->inputs, sensors = loop->sensors;
    double *row = zeros(structure->outputs * (modes + sensors) + sensors * inputs);
    pzs_vibration *tables = &loop->vibration;
    *tables = (pzs_vibration){.inputs = (uint16_t)inputs,
                              .outputs = (uint16_t)structure->outputs,
                              .sensors = (uint16_t)sensors,
                              .modes = (uint16_t)modes,
                              .delay = (uint16_t)delay};
    for (size_t i = 0; i < structure->outputs; i++)
        memcpy(row + i * modes, structure->shape + i * structure->modes, modes * sizeof *row);
    tables->shape = put(at, row, structure->outputs * modes);
    if (loop->sensor) {
        for (size_t i = 0; i < sensors; i++)
            memcpy(row + i * modes, structure->shape + loop->sensor[i] * structure->modes,
                   modes * sizeof *row);
        tables->reading = put(at, row, sensors * modes);
        for (size_t i = 0; i < sensors; i++)
            memcpy(row + i * inputs, structure->influence + loop->sensor[i] * inputs,
                   inputs * sizeof *row);
        tables->direct = put(at, row, sensors * inputs);
        memset(row, 0, structure->outputs * sensors * sizeof *row);
        fill_gain(loop, row);
        tables->gain = put(at, row, structure->outputs * sensors);
    }
    tables->modal = put(at, structure->modal, modes * inputs);
    tables->turn = put(at, loop->gains.turn, 4 * modes);
    tables->observer = put(at, loop->gains.observer, 3 * modes * modes);
    tables->explain = put(at, loop->gains.explain, modes * modes);
    tables->damping = put(at, loop->gains.damping, modes * inputs);
    tables->inverse_angle = put(at, loop->gains.inverse_angle, modes);
    if (lag_of(loop) > 0)
        tables->lag = put(at, loop->gains.lag, 2 + 2 * modes);
    tables->share = (pzs_real)loop->gains.share;
    tables->mix = (pzs_real)loop->gains.mix;
    tables->slow = (pzs_real)loop->gains.slow;
    free(row);
    assert_int_equal(pzs_vibration_seal(tables), PZS_OK);
}

/* ---- loop ------------------------------------------------------------- */

enum { HISTORY = 16 }; /* number of ticks whose readings are kept */

static void start(damped_loop *loop)
{
    const size_t inputs = loop->problem.inputs, outputs = loop->problem.outputs;
    size_t count = 0, bytes = PZS_STEP_BLOCK_BYTES(inputs, outputs) +
                              PZS_VIBRATION_BLOCK_LAG_BYTES(loop->modes, inputs, outputs,
                                                            loop->sensors, loop->vibration.delay);
    if (loop->governor.part > 0) {
        loop->governor.share = loop->vibration.share;
        loop->block[count++] = (pzs_block){&pzs_governor_block, &loop->governor};
        bytes += PZS_GOVERNOR_BLOCK_BYTES(inputs, outputs);
    }
    if (!loop->is_undamped) {
        loop->block[count++] = (pzs_block){&pzs_vibration_block, &loop->vibration};
    } else if (loop->lateness.delay > 0) {
        loop->block[count++] = (pzs_block){&pzs_reading_delay_block, &loop->lateness};
        bytes += PZS_READING_DELAY_BLOCK_BYTES(inputs, loop->sensors, loop->lateness.delay);
    }
    loop->block[count++] =
        loop->law.type ? loop->law : (pzs_block){&pzs_step_block, &loop->problem};
    if (loop->amplifier.step > 0) {
        loop->block[count++] = (pzs_block){&pzs_amplifier_block, &loop->amplifier};
        bytes += PZS_AMPLIFIER_BLOCK_BYTES(inputs);
    }
    if (loop->supervision.alarm_ticks > 0) {
        loop->block[count++] = (pzs_block){&pzs_supervisor_block, &loop->supervision};
        bytes += PZS_SUPERVISOR_BLOCK_BYTES(outputs);
    }
    bytes += PZS_LOOP_BYTES(count, inputs);
    free(loop->work);
    loop->work = malloc(bytes);
    assert_non_null(loop->work);
    assert_int_equal(pzs_loop_init(&loop->loop, loop->block, count, NULL, loop->work, bytes),
                     PZS_OK);
}

void damped_loop_open(damped_loop *loop, const modal_structure *structure, double interval,
                      double step_limit, int delay, const size_t *sensor, size_t sensors,
                      const damper_settings *settings)
{
    memset(loop, 0, sizeof *loop);
    loop->structure = structure;
    loop->interval = interval;
    loop->settings = *settings;
    loop->sensor = sensor;
    loop->sensors = sensor ? sensors : structure->outputs;
    loop->modes = count_modes(loop);
    compute_gains(loop);
    const size_t modes = loop->modes, outputs = structure->outputs, inputs = structure->inputs,
                 few = sensor ? sensors : 0;
    const size_t reals = outputs * inputs + outputs + 4 * inputs + outputs * modes +
                         few * (modes + inputs + outputs) + 2 * modes * inputs + 5 * modes +
                         4 * modes * modes + (lag_of(loop) > 0 ? 2 + 2 * modes : 0);
    loop->tables = calloc(reals, sizeof *loop->tables);
    loop->voltage = zeros(inputs);
    loop->played = zeros(inputs);
    loop->output = zeros(inputs);
    loop->shape = zeros(outputs);
    loop->history = zeros(HISTORY * outputs);
    loop->read = zeros(outputs);
    loop->position = zeros(structure->modes);
    loop->deviation = zeros(structure->modes);
    loop->turn = zeros(4 * structure->modes);
    loop->velocity = zeros(structure->modes);
    loop->wanted = calloc(outputs, sizeof *loop->wanted);
    loop->sensed = calloc(outputs, sizeof *loop->sensed);
    assert_true(loop->tables && loop->wanted && loop->sensed);
    pzs_real *at = loop->tables;
    fill_problem(loop, &at, step_limit);
    fill_vibration(loop, &at, delay);
    assert_int_equal(at - loop->tables, reals);
    damped_loop_reset(loop, EXACT_PLANT);
}

void damped_loop_replace(damped_loop *loop, const pzs_block *law, bool is_observed,
                         bool is_corrected)
{
    const int delay = is_corrected ? loop->vibration.delay : 0;
    assert_true(loop->sensors == loop->structure->outputs);
    loop->law = *law;
    loop->is_undamped = !is_observed;
    loop->lateness = (pzs_reading_delay){.inputs = loop->problem.inputs,
                                         .sensors = (uint16_t)loop->sensors,
                                         .delay = (uint16_t)delay};
    assert_int_equal(pzs_reading_delay_seal(&loop->lateness), PZS_OK);
    damped_loop_reset(loop, loop->error);
}

void damped_loop_supervise(damped_loop *loop)
{
    const modal_structure *structure = loop->structure;
    const double period = 2 * pi / (structure->omega[0] * loop->interval);
    double squares = 0;
    for (size_t i = 0; i < structure->outputs; i++)
        squares += pow(structure->goal[i], 2);
    const double goal = sqrt(squares / (double)structure->outputs);
    squares = 0;
    for (size_t i = 0; i < structure->outputs * structure->inputs; i++)
        squares += pow(structure->limit * structure->influence[i], 2);
    const double reach = sqrt(squares / (double)structure->outputs);
    loop->supervision = (pzs_supervision){.inputs = loop->problem.inputs,
                                          .scene = loop->problem.scene,
                                          .timeout = 100,
                                          .ramp_ticks = 50,
                                          .alarm_ticks = (uint16_t)fmax(20, ceil(period)),
                                          .polarity_ticks = (uint16_t)fmax(20, ceil(period)),
                                          .park = loop->problem.reference_voltage,
                                          .fading = (pzs_real)exp(-1 / (2 * period)),
                                          .noise = (pzs_real)(0.005 * goal),
                                          .load = (pzs_real)(0.3 * goal),
                                          .slack = (pzs_real)(0.5 * reach)};
    assert_int_equal(pzs_supervision_seal(&loop->supervision), PZS_OK);
}

void damped_loop_close(damped_loop *loop)
{
    free(loop->memory);
    free(loop->tables);
    free(loop->work);
    free(loop->voltage);
    free(loop->played);
    free(loop->output);
    free(loop->shape);
    free(loop->history);
    free(loop->read);
    free(loop->position);
    free(loop->deviation);
    free(loop->turn);
    free(loop->velocity);
    free(loop->wanted);
    free(loop->sensed);
}

void damped_loop_reset(damped_loop *loop, plant_error error)
{
    const modal_structure *structure = loop->structure;
    loop->error = error;
    loop->load = 0;
    loop->tick = 0;
    loop->seed = 1;
    loop->is_silent = loop->is_blind = loop->is_held = false;
    loop->stuck_input = -1;
    loop->bad_sensor = -1;
    loop->quantum = 0;
    loop->stuck_sensors = 0;
    loop->is_stuck_noisy = false;
    loop->sensor_gain = 1;
    loop->sensor_offset = 0;
    for (size_t k = 0; k < structure->modes; k++)
        modal_propagator(structure->omega[k] * error.frequency, structure->ratio[k] * error.ratio,
                         loop->interval, loop->turn + 4 * k);
    memset(loop->position, 0, structure->modes * sizeof *loop->position);
    memset(loop->velocity, 0, structure->modes * sizeof *loop->velocity);
    memset(loop->shape, 0, structure->outputs * sizeof *loop->shape);
    memset(loop->voltage, 0, structure->inputs * sizeof *loop->voltage);
    memset(loop->played, 0, structure->inputs * sizeof *loop->played);
    memset(loop->output, 0, structure->inputs * sizeof *loop->output);
    memset(loop->history, 0, HISTORY * structure->outputs * sizeof *loop->history);
    start(loop);
}

/*
 * Advance the output voltage of an amplifier by a tick, in which its command is constant. Returns
 * the mean output voltage in this tick.
 */
static double amplify(const damped_loop *loop, double *output, double command)
{
    const double times = 2 * pi * loop->structure->bandwidth * (1 - loop->slower) * loop->interval;
    const double behind = *output - command;
    if (!(times > 0))
        return command;
    *output = command + behind * exp(-times);
    return command - behind * expm1(-times) / times;
}

/* Compute the voltages that act on the plant, with lag, play and nonlinear gain. */
static void act(damped_loop *loop)
{
    const double limit = loop->structure->limit, half = loop->error.play * limit;
    for (size_t j = 0; j < loop->structure->inputs; j++) {
        const double voltage = amplify(loop, &loop->output[j], (double)loop->loop.info.voltage[j]);
        if ((int)j == loop->stuck_input)
            continue;
        loop->played[j] = fmin(fmax(loop->played[j], voltage - half), voltage + half);
        loop->voltage[j] =
            loop->played[j] * (1 + loop->error.cubic * pow(loop->played[j] / limit, 2));
    }
}

/* Advance the modes of the plant by one tick; deviation [modes]: distances from their rest. */
static void move_modes(damped_loop *loop)
{
    const modal_structure *structure = loop->structure;
    for (size_t k = 0; k < structure->modes; k++) {
        const double *turn = loop->turn + 4 * k, *modal = structure->modal + k * structure->inputs;
        double rest = loop->load * structure->load[k];
        for (size_t j = 0; j < structure->inputs; j++)
            rest += loop->error.gain * modal[j] * loop->voltage[j];
        const double deviation = loop->position[k] - rest, speed = loop->velocity[k];
        loop->deviation[k] = turn[0] * deviation + turn[1] * speed;
        loop->velocity[k] = turn[2] * deviation + turn[3] * speed;
        loop->position[k] = rest + loop->deviation[k];
    }
}

void damped_loop_move_plant(damped_loop *loop)
{
    const modal_structure *structure = loop->structure;
    act(loop);
    move_modes(loop);
    for (size_t i = 0; i < structure->outputs; i++) {
        const double *influence = structure->influence + i * structure->inputs,
                     *shape = structure->shape + i * structure->modes;
        double sum = 0;
        for (size_t j = 0; j < structure->inputs; j++)
            sum += influence[j] * loop->voltage[j];
        sum = loop->error.gain * sum + loop->load * structure->load_shape[i];
        for (size_t k = 0; k < structure->modes; k++)
            sum += shape[k] * loop->deviation[k];
        loop->shape[i] = sum;
    }
}

static double largest_goal(const modal_structure *structure)
{
    double most = 0;
    for (size_t i = 0; i < structure->outputs; i++)
        most = fmax(most, fabs(structure->goal[i]));
    return most;
}

void damped_loop_keep(damped_loop *loop)
{
    const size_t outputs = loop->structure->outputs;
    loop->tick++;
    memcpy(loop->history + (size_t)(loop->tick % HISTORY) * outputs, loop->shape,
           outputs * sizeof *loop->history);
}

/* Reading of a sensor that measures a displacement: with noise, converter steps and offset. */
static double read_sensor(damped_loop *loop, double displacement, double goal)
{
    const double noise = loop->error.noise * goal * uniform(&loop->seed, -1.7, 1.7);
    const double reading = loop->sensor_gain * displacement + loop->sensor_offset * goal + noise;
    const double step = loop->quantum * goal;
    return step > 0 ? step * floor(reading / step + 0.5) : reading;
}

/* Readings of `error.delay` ticks ago, with noise and faults. */
static void read_plant(damped_loop *loop)
{
    const size_t outputs = loop->structure->outputs;
    const int then = loop->tick > loop->error.delay ? loop->tick - loop->error.delay : 0;
    const double *old = loop->history + (size_t)(then % HISTORY) * outputs;
    const double goal = largest_goal(loop->structure);
    for (size_t i = 0; i < loop->sensors; i++) {
        if (i >= loop->stuck_sensors)
            loop->read[i] = old[output_of(loop, i)];
        const double reading = read_sensor(loop, loop->read[i], goal);
        if (i >= loop->stuck_sensors || loop->is_stuck_noisy)
            loop->sensed[i] = (pzs_real)reading;
        if (loop->is_blind)
            loop->sensed[i] = (pzs_real)NAN;
        else if ((int)i == loop->bad_sensor)
            loop->sensed[i] = (pzs_real)loop->bad_value;
    }
}

/* Assert that the new voltages are inside their voltage limits and step limits. */
static void assert_limits(const damped_loop *loop, const pzs_real *last)
{
    const pzs_control_info *info = &loop->loop.info.control->info;
    for (size_t j = 0; j < loop->problem.inputs; j++) {
        const pzs_real voltage = loop->loop.info.voltage[j];
        assert_true(voltage >= loop->problem.lower[j] && voltage <= loop->problem.upper[j]);
        if (info->lower[j] < info->upper[j])
            assert_true(fabs((double)voltage - (double)last[j]) <=
                        (double)loop->problem.step_limit[j] * (1 + 4 * (double)PZS_EPSILON));
    }
}

pzs_status damped_loop_tick(damped_loop *loop, const double *wanted)
{
    pzs_real last[256];
    assert_true(loop->problem.inputs <= 256);
    memcpy(last, loop->loop.info.voltage, loop->problem.inputs * sizeof *last);
    read_plant(loop);
    for (size_t i = 0; i < loop->structure->outputs; i++)
        loop->wanted[i] = (pzs_real)wanted[i];
    const pzs_status status =
        pzs_loop_tick(&loop->loop, loop->wanted, loop->is_silent ? NULL : loop->sensed);
    assert_limits(loop, last);
    if (loop->is_held)
        return status;
    damped_loop_move_plant(loop);
    damped_loop_keep(loop);
    return status;
}

/* ---- judgement -------------------------------------------------------- */

/* Whether a voltage is at a limit towards which its slope drives it. */
static bool is_active(double voltage, double slope, double limit)
{
    return (voltage <= -limit && slope > 0) || (voltage >= limit && slope < 0);
}

/*
 * Solve the linear equations of a positive definite matrix for the entries that are free, by
 * elimination; the other entries of the solution are 0.
 *   matrix     [count][count] in  matrix
 *   right_side [count]        in  right-hand side
 */
static void solve_free(const double *matrix, const double *right_side, const bool *is_free,
                       size_t count, double *solution)
{
    double *copy = zeros(count * count + count), *right = copy + count * count;
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < count; j++)
            copy[i * count + j] = is_free[i] && is_free[j] ? matrix[i * count + j] : i == j;
        right[i] = is_free[i] ? right_side[i] : 0;
    }
    for (size_t pivot = 0; pivot < count; pivot++)
        for (size_t i = pivot + 1; i < count; i++) {
            const double factor = copy[i * count + pivot] / copy[pivot * count + pivot];
            for (size_t j = pivot; j < count; j++)
                copy[i * count + j] -= factor * copy[pivot * count + j];
            right[i] -= factor * right[pivot];
        }
    for (size_t i = count; i-- > 0;) {
        solution[i] = right[i];
        for (size_t j = i + 1; j < count; j++)
            solution[i] -= copy[i * count + j] * solution[j];
        solution[i] /= copy[i * count + i];
    }
    free(copy);
}

/*
 * Minimum of v'Hv/2 - f'v between the limits, by projected Newton steps that are halved until they
 * descend. H is the Hessian, f the gradient at zero.
 */
static void bounded_minimum(const double *hessian, const double *gradient, size_t count,
                            double limit, double *voltage)
{
    double *slope = zeros(3 * count), *way = slope + count, *next = way + count;
    bool *is_free = calloc(count, sizeof *is_free);
    assert_non_null(is_free);
    for (int step = 0; step < 200; step++) {
        double part = 1, change = 0, value = 0, now;
        for (size_t i = 0; i < count; i++) {
            slope[i] = gradient[i];
            for (size_t j = 0; j < count; j++)
                slope[i] -= hessian[i * count + j] * voltage[j];
            value -= voltage[i] * (gradient[i] + slope[i]) / 2;
            is_free[i] = !is_active(voltage[i], -slope[i], limit);
        }
        solve_free(hessian, slope, is_free, count, way);
        do {
            now = 0;
            for (size_t i = 0; i < count; i++)
                next[i] = fmin(fmax(voltage[i] + part * way[i], -limit), limit);
            for (size_t i = 0; i < count; i++)
                for (size_t j = 0; j < count; j++)
                    now += next[i] * hessian[i * count + j] * next[j] / 2;
            for (size_t i = 0; i < count; i++)
                now -= gradient[i] * next[i];
            part /= 2;
        } while (now > value + 1e-15 * fabs(value) && part > 1e-9);
        for (size_t i = 0; i < count; i++) {
            change = fmax(change, fabs(next[i] - voltage[i]));
            voltage[i] = next[i];
        }
        if (change <= 1e-12 * limit)
            break;
    }
    free(slope);
    free(is_free);
}

void damped_loop_optimum(const damped_loop *loop, const double *wanted, double *shape)
{
    const modal_structure *structure = loop->structure;
    const size_t inputs = structure->inputs, outputs = structure->outputs;
    double *hessian = zeros(inputs * inputs), *gradient = zeros(inputs), *voltage = zeros(inputs);
    for (size_t i = 0; i < outputs; i++)
        for (size_t j = 0; j < inputs; j++) {
            const double column = loop->error.gain * structure->influence[i * inputs + j];
            gradient[j] += column * (wanted[i] - loop->load * structure->load_shape[i]);
            for (size_t other = 0; other < inputs; other++)
                hessian[j * inputs + other] +=
                    column * loop->error.gain * structure->influence[i * inputs + other];
        }
    for (size_t j = 0; j < inputs; j++)
        hessian[j * inputs + j] += (double)loop->problem.regularisation;
    bounded_minimum(hessian, gradient, inputs, structure->limit, voltage);
    for (size_t i = 0; i < outputs; i++) {
        shape[i] = loop->load * structure->load_shape[i];
        for (size_t j = 0; j < inputs; j++)
            shape[i] += loop->error.gain * structure->influence[i * inputs + j] * voltage[j];
    }
    free(hessian);
    free(gradient);
    free(voltage);
}

double damped_loop_distance(const damped_loop *loop, const double *shape)
{
    double sum = 0, all = 0;
    for (size_t i = 0; i < loop->structure->outputs; i++) {
        sum += pow(loop->shape[i] - shape[i], 2);
        all += pow(loop->structure->goal[i], 2);
    }
    return sqrt(sum / all);
}
