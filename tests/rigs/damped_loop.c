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

static double *zeros(size_t n)
{
    double *x = calloc(n + 1, sizeof *x);
    assert_non_null(x);
    return x;
}

/* ---- structures ------------------------------------------------------- */

void structure_open(modal_structure *s, size_t modes, size_t outputs, size_t inputs)
{
    *s = (modal_structure){.modes = modes, .outputs = outputs, .inputs = inputs};
    s->omega = zeros(modes);
    s->ratio = zeros(modes);
    s->shape = zeros(outputs * modes);
    s->modal = zeros(modes * inputs);
    s->load = zeros(modes);
    s->influence = zeros(outputs * inputs);
    s->load_shape = zeros(outputs);
    s->goal = zeros(outputs);
}

void structure_close(modal_structure *s)
{
    free(s->omega);
    free(s->ratio);
    free(s->shape);
    free(s->modal);
    free(s->load);
    free(s->influence);
    free(s->load_shape);
    free(s->goal);
}

/* influence and load_shape = those of the modes alone. */
static void add_up_modes(modal_structure *s)
{
    for (size_t i = 0; i < s->outputs; i++)
        for (size_t k = 0; k < s->modes; k++) {
            const double c = s->shape[i * s->modes + k];
            s->load_shape[i] += c * s->load[k];
            for (size_t j = 0; j < s->inputs; j++)
                s->influence[i * s->inputs + j] += c * s->modal[k * s->inputs + j];
        }
}

void structure_scale(modal_structure *s)
{
    for (size_t k = 0; k < s->modes; k++) {
        double sum = 0;
        for (size_t i = 0; i < s->outputs; i++)
            sum += pow(s->shape[i * s->modes + k], 2);
        const double size = sqrt(sum / (double)s->outputs);
        for (size_t i = 0; i < s->outputs; i++)
            s->shape[i * s->modes + k] /= size;
        for (size_t j = 0; j < s->inputs; j++)
            s->modal[k * s->inputs + j] *= size;
        s->load[k] *= size;
    }
}

/* A goal within reach: the shape of random voltages of about a third of the limit. */
static void set_goal(modal_structure *s, unsigned seed)
{
    for (size_t j = 0; j < s->inputs; j++) {
        double sum = 0;
        for (int i = 0; i < 12; i++)
            sum += uniform(&seed, -0.5, 0.5);
        for (size_t i = 0; i < s->outputs; i++)
            s->goal[i] += s->influence[i * s->inputs + j] * 0.35 * s->limit * sum;
    }
}

void structure_of_plate(modal_structure *s, size_t modes)
{
    bridge b;
    bridge_modes m;
    char error[400];
    assert_int_equal(bridge_open(&b, "plate-50-patches",
                                 (const char *[]){"loads=[{face: outer, pressure: 20}]"}, 1, error),
                     0);
    assert_int_equal(bridge_modes_open(&m, &b, (int)modes, error), 0);
    structure_open(s, modes, (size_t)b.targets, (size_t)b.amplifiers);
    const size_t inputs = (size_t)b.input.count;
    memcpy(s->omega, m.frequency, modes * sizeof *s->omega);
    memcpy(s->shape, m.shape, s->outputs * modes * sizeof *s->shape);
    memcpy(s->modal, m.modal, modes * s->inputs * sizeof *s->modal);
    memcpy(s->load, m.load, modes * sizeof *s->load);
    memcpy(s->load_shape, m.load_shape, s->outputs * sizeof *s->load_shape);
    for (size_t i = 0; i < s->outputs; i++) {
        s->goal[i] = b.target[i] / 2;
        for (size_t j = 0; j < s->inputs; j++)
            s->influence[i * s->inputs + j] = b.influence[i * inputs + j];
    }
    for (size_t k = 0; k < modes; k++)
        s->ratio[k] = 0.005;
    s->limit = 300;
    structure_scale(s);
    bridge_modes_close(&m);
    bridge_close(&b);
}

/* Modes (a, b) of a plate, in the order of their frequencies. */
typedef struct plate_mode {
    double square;
    size_t a, b;
} plate_mode;

static int compare_modes(const void *x, const void *y)
{
    const plate_mode *first = x, *second = y;
    return (first->square > second->square) - (first->square < second->square);
}

/* Integral of sin(a pi x / length) over patch k of n, a little narrower than its cell. */
static double over_patch(size_t a, size_t k, size_t n, double length)
{
    const double cell = length / (double)n, from = cell * ((double)k + 0.04),
                 to = cell * ((double)k + 0.96), wave = (double)a * pi / length;
    return (cos(wave * from) - cos(wave * to)) / wave;
}

static void fill_plate_mode(modal_structure *s, const supported_plate *p, size_t k, plate_mode mode)
{
    const double wave_a = (double)mode.a * pi / p->length, wave_b = (double)mode.b * pi;
    const double squares = s->omega[k] * s->omega[k];
    for (size_t x = 0; x < p->points_x; x++)
        for (size_t y = 0; y < p->points_y; y++)
            s->shape[(x * p->points_y + y) * s->modes + k] =
                sin(wave_a * p->length * ((double)x + 0.5) / (double)p->points_x) *
                sin(wave_b * ((double)y + 0.5) / (double)p->points_y);
    for (size_t i = 0; i < p->columns; i++)
        for (size_t j = 0; j < p->rows; j++)
            s->modal[k * s->inputs + i * p->rows + j] =
                -(wave_a * wave_a + wave_b * wave_b) *
                over_patch(mode.a, i, p->columns, p->length) * over_patch(mode.b, j, p->rows, 1) /
                squares;
    s->load[k] = over_patch(mode.a, 0, 1, p->length) * over_patch(mode.b, 0, 1, 1) / squares;
}

void structure_of_supported_plate(modal_structure *s, const supported_plate *p)
{
    enum { HALF_WAVES = 40 };
    static plate_mode mode[HALF_WAVES * HALF_WAVES];
    structure_open(s, p->modes, p->points_x * p->points_y, p->columns * p->rows);
    for (size_t a = 0; a < HALF_WAVES; a++)
        for (size_t b = 0; b < HALF_WAVES; b++)
            mode[a * HALF_WAVES + b] = (plate_mode){
                pow(((double)a + 1) / p->length, 2) + pow((double)b + 1, 2), a + 1, b + 1};
    qsort(mode, HALF_WAVES * HALF_WAVES, sizeof *mode, compare_modes);
    for (size_t k = 0; k < p->modes; k++) {
        s->omega[k] = 2 * pi * p->first * mode[k].square / mode[0].square;
        s->ratio[k] = p->ratio;
        fill_plate_mode(s, p, k, mode[k]);
    }
    structure_scale(s);
    s->limit = 100;
    add_up_modes(s);
    double largest = 0;
    for (size_t i = 0; i < s->outputs * s->inputs; i++)
        largest = fmax(largest, fabs(s->influence[i]));
    const double scale = 1e-5 / largest; /* 10 um a volt at most */
    for (size_t i = 0; i < s->outputs * s->inputs; i++)
        s->influence[i] *= scale;
    for (size_t i = 0; i < s->modes * s->inputs; i++)
        s->modal[i] *= scale;
    set_goal(s, 5);
}

/* ---- tables ----------------------------------------------------------- */

static pzs_real *put(pzs_real **at, const double *x, size_t n)
{
    pzs_real *first = *at;
    for (size_t i = 0; i < n; i++)
        first[i] = (pzs_real)x[i];
    *at += n;
    return first;
}

static size_t output_of(const damped_loop *d, size_t sensor)
{
    return d->sensor ? d->sensor[sensor] : sensor;
}

/* Modes that turn by at most settings.observed, no more than inputs and fewer than sensors. */
static size_t count_modes(const damped_loop *d)
{
    const modal_structure *s = d->structure;
    size_t n = 0;
    while (n < s->modes && n < s->inputs && n + 1 < d->sensors &&
           s->omega[n] * d->interval <= d->settings.observed)
        n++;
    return n;
}

static void compute_gains(damped_loop *d)
{
    const modal_structure *s = d->structure;
    const size_t n = d->modes, inputs = s->inputs;
    double *at = d->memory = zeros(17 * n * n + 8 * n + 4 * n * inputs);
    double *angle = at, *ratio = angle + n, *square = ratio + n, *modal = square + n,
           *lift = modal + n * inputs, *overlap = lift + n * inputs;
    at = overlap + n * n;
    d->gains.turn = at;
    d->gains.inverse_angle = at + 4 * n;
    d->gains.damping = at + 5 * n;
    d->gains.explain = d->gains.damping + n * inputs;
    d->gains.observer = d->gains.explain + n * n;
    d->gains.covariance = d->gains.observer + 3 * n * n;
    for (size_t k = 0; k < n; k++) {
        angle[k] = s->omega[k] * d->interval;
        ratio[k] = s->ratio[k];
        memcpy(modal + k * inputs, s->modal + k * inputs, inputs * sizeof *modal);
        for (size_t i = 0; i < s->outputs; i++) {
            square[k] += pow(s->shape[i * s->modes + k], 2);
            for (size_t j = 0; j < inputs; j++)
                lift[j * n + k] += s->influence[i * inputs + j] * s->shape[i * s->modes + k];
        }
        for (size_t i = 0; i < d->sensors; i++)
            for (size_t l = 0; l < n; l++)
                overlap[k * n + l] += s->shape[output_of(d, i) * s->modes + k] *
                                      s->shape[output_of(d, i) * s->modes + l];
    }
    const damper_model model = {n, inputs, d->sensors, angle, ratio, modal, overlap, lift, square};
    assert_int_equal(damper_compute(&d->gains, &model, &d->settings), 0);
}

/* gain [outputs][sensors] = G Gs' (Gs Gs' + 1e-4 mean diagonal)^-1, Gs the rows of the sensors. */
static void fill_gain(const damped_loop *d, double *gain)
{
    const modal_structure *s = d->structure;
    const size_t m = d->sensors, inputs = s->inputs;
    double *a = zeros(m * m), trace = 0;
    for (size_t i = 0; i < m; i++)
        for (size_t l = 0; l < m; l++)
            for (size_t j = 0; j < inputs; j++)
                a[i * m + l] += s->influence[output_of(d, i) * inputs + j] *
                                s->influence[output_of(d, l) * inputs + j];
    for (size_t i = 0; i < m; i++)
        trace += a[i * m + i];
    for (size_t i = 0; i < m; i++)
        a[i * m + i] += 1e-4 * trace / (double)m;
    for (size_t o = 0; o < s->outputs; o++)
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < inputs; j++)
                gain[o * m + i] +=
                    s->influence[o * inputs + j] * s->influence[output_of(d, i) * inputs + j];
    for (size_t p = 0; p < m; p++) { /* Gauss-Jordan on the columns of gain */
        const double pivot = a[p * m + p];
        for (size_t i = 0; i < m; i++)
            a[i * m + p] /= pivot;
        for (size_t o = 0; o < s->outputs; o++)
            gain[o * m + p] /= pivot;
        for (size_t l = 0; l < m; l++) {
            const double factor = l == p ? 0 : a[p * m + l];
            for (size_t i = 0; i < m; i++)
                a[i * m + l] -= factor * a[i * m + p];
            for (size_t o = 0; o < s->outputs; o++)
                gain[o * m + l] -= factor * gain[o * m + p];
        }
    }
    free(a);
}

static void fill_problem(damped_loop *d, pzs_real **at, double slew)
{
    const modal_structure *s = d->structure;
    const size_t inputs = s->inputs;
    double *row = zeros(s->outputs + inputs);
    d->problem = (pzs_problem){.inputs = (uint16_t)inputs, .outputs = (uint16_t)s->outputs};
    d->problem.influence = put(at, s->influence, s->outputs * inputs);
    for (size_t i = 0; i < s->outputs + inputs; i++)
        row[i] = 1;
    d->problem.weight = put(at, row, s->outputs);
    for (size_t i = 0; i < inputs; i++)
        row[i] = s->limit;
    d->problem.upper = put(at, row, inputs);
    for (size_t i = 0; i < inputs; i++)
        row[i] = -s->limit;
    d->problem.lower = put(at, row, inputs);
    for (size_t i = 0; i < inputs; i++)
        row[i] = slew;
    d->problem.step_limit = put(at, row, inputs);
    memset(row, 0, inputs * sizeof *row);
    d->problem.reference_voltage = put(at, row, inputs);
    double trace = 0;
    for (size_t i = 0; i < s->outputs * inputs; i++)
        trace += s->influence[i] * s->influence[i];
    d->problem.regularisation = (pzs_real)(1e-6 * trace / (double)inputs);
    free(row);
    assert_int_equal(pzs_problem_seal(&d->problem), PZS_OK);
}

static void fill_vibration(damped_loop *d, pzs_real **at, int delay)
{
    const modal_structure *s = d->structure;
    const size_t n = d->modes, inputs = s->inputs, m = d->sensors;
    double *row = zeros(s->outputs * (n + m) + m * inputs);
    pzs_vibration *v = &d->vibration;
    *v = (pzs_vibration){.inputs = (uint16_t)inputs,
                         .outputs = (uint16_t)s->outputs,
                         .sensors = (uint16_t)m,
                         .modes = (uint16_t)n,
                         .delay = (uint16_t)delay};
    for (size_t i = 0; i < s->outputs; i++)
        memcpy(row + i * n, s->shape + i * s->modes, n * sizeof *row);
    v->shape = put(at, row, s->outputs * n);
    if (d->sensor) {
        for (size_t i = 0; i < m; i++)
            memcpy(row + i * n, s->shape + d->sensor[i] * s->modes, n * sizeof *row);
        v->reading = put(at, row, m * n);
        for (size_t i = 0; i < m; i++)
            memcpy(row + i * inputs, s->influence + d->sensor[i] * inputs, inputs * sizeof *row);
        v->direct = put(at, row, m * inputs);
        memset(row, 0, s->outputs * m * sizeof *row);
        fill_gain(d, row);
        v->gain = put(at, row, s->outputs * m);
    }
    v->modal = put(at, s->modal, n * inputs);
    v->turn = put(at, d->gains.turn, 4 * n);
    v->observer = put(at, d->gains.observer, 3 * n * n);
    v->explain = put(at, d->gains.explain, n * n);
    v->damping = put(at, d->gains.damping, n * inputs);
    v->inverse_angle = put(at, d->gains.inverse_angle, n);
    v->share = (pzs_real)d->gains.share;
    v->mix = (pzs_real)d->gains.mix;
    v->slow = (pzs_real)d->gains.slow;
    free(row);
    assert_int_equal(pzs_vibration_seal(v), PZS_OK);
}

/* ---- loop ------------------------------------------------------------- */

enum { HISTORY = 16 }; /* ticks of readings kept */

static void start(damped_loop *d)
{
    const size_t inputs = d->problem.inputs, outputs = d->problem.outputs;
    size_t count = 0, bytes = PZS_STEP_BLOCK_BYTES(inputs, outputs) +
                              PZS_VIBRATION_BLOCK_BYTES(d->modes, inputs, outputs, d->sensors,
                                                        d->vibration.delay);
    if (d->governor.part > 0) {
        d->governor.share = d->vibration.share;
        d->block[count++] = (pzs_block){&pzs_governor_block, &d->governor};
        bytes += PZS_GOVERNOR_BLOCK_BYTES(inputs, outputs);
    }
    d->block[count++] = (pzs_block){&pzs_vibration_block, &d->vibration};
    d->block[count++] = (pzs_block){&pzs_step_block, &d->problem};
    if (d->amplifier.step > 0) {
        d->block[count++] = (pzs_block){&pzs_amplifier_block, &d->amplifier};
        bytes += PZS_AMPLIFIER_BLOCK_BYTES(inputs);
    }
    bytes += PZS_LOOP_BYTES(count, inputs);
    free(d->work);
    d->work = malloc(bytes);
    assert_non_null(d->work);
    assert_int_equal(pzs_loop_init(&d->loop, d->block, count, NULL, d->work, bytes), PZS_OK);
}

void damped_loop_open(damped_loop *d, const modal_structure *s, double interval, double slew,
                      int delay, const size_t *sensor, size_t sensors,
                      const damper_settings *settings)
{
    memset(d, 0, sizeof *d);
    d->structure = s;
    d->interval = interval;
    d->settings = *settings;
    d->sensor = sensor;
    d->sensors = sensor ? sensors : s->outputs;
    d->modes = count_modes(d);
    compute_gains(d);
    const size_t n = d->modes, m = s->outputs, inputs = s->inputs, few = sensor ? sensors : 0;
    const size_t reals = m * inputs + m + 4 * inputs + m * n + few * (n + inputs + m) +
                         2 * n * inputs + 5 * n + 4 * n * n;
    d->tables = calloc(reals, sizeof *d->tables);
    d->voltage = zeros(inputs);
    d->played = zeros(inputs);
    d->shape = zeros(m);
    d->history = zeros(HISTORY * m);
    d->position = zeros(s->modes);
    d->velocity = zeros(s->modes);
    d->wanted = calloc(m, sizeof *d->wanted);
    d->sensed = calloc(m, sizeof *d->sensed);
    assert_true(d->tables && d->wanted && d->sensed);
    pzs_real *at = d->tables;
    fill_problem(d, &at, slew);
    fill_vibration(d, &at, delay);
    assert_int_equal(at - d->tables, reals);
    damped_loop_reset(d, EXACT_PLANT);
}

void damped_loop_close(damped_loop *d)
{
    free(d->memory);
    free(d->tables);
    free(d->work);
    free(d->voltage);
    free(d->played);
    free(d->shape);
    free(d->history);
    free(d->position);
    free(d->velocity);
    free(d->wanted);
    free(d->sensed);
}

void damped_loop_reset(damped_loop *d, plant_error error)
{
    const modal_structure *s = d->structure;
    d->error = error;
    d->load = 0;
    d->tick = 0;
    d->seed = 1;
    d->is_silent = d->is_blind = d->is_held = false;
    d->bad_sensor = -1;
    memset(d->position, 0, s->modes * sizeof *d->position);
    memset(d->velocity, 0, s->modes * sizeof *d->velocity);
    memset(d->shape, 0, s->outputs * sizeof *d->shape);
    memset(d->voltage, 0, s->inputs * sizeof *d->voltage);
    memset(d->played, 0, s->inputs * sizeof *d->played);
    memset(d->history, 0, HISTORY * s->outputs * sizeof *d->history);
    start(d);
}

/* Voltages that act, after play and nonlinear gain. */
static void act(damped_loop *d)
{
    const double limit = d->structure->limit, half = d->error.play * limit;
    for (size_t j = 0; j < d->structure->inputs; j++) {
        const double v = (double)d->loop.info.voltage[j];
        d->played[j] = fmin(fmax(d->played[j], v - half), v + half);
        d->voltage[j] = d->played[j] * (1 + d->error.cubic * pow(d->played[j] / limit, 2));
    }
}

void damped_loop_move_plant(damped_loop *d)
{
    const modal_structure *s = d->structure;
    const size_t n = s->modes, inputs = s->inputs;
    act(d);
    for (size_t i = 0; i < s->outputs; i++) {
        d->shape[i] = d->load * s->load_shape[i];
        for (size_t j = 0; j < inputs; j++)
            d->shape[i] += d->error.gain * s->influence[i * inputs + j] * d->voltage[j];
    }
    for (size_t k = 0; k < n; k++) {
        double r[4], rest = d->load * s->load[k];
        for (size_t j = 0; j < inputs; j++)
            rest += d->error.gain * s->modal[k * inputs + j] * d->voltage[j];
        modal_propagator(s->omega[k] * d->error.frequency, s->ratio[k] * d->error.ratio,
                         d->interval, r);
        const double deviation = d->position[k] - rest, speed = d->velocity[k];
        d->position[k] = rest + r[0] * deviation + r[1] * speed;
        d->velocity[k] = r[2] * deviation + r[3] * speed;
        for (size_t i = 0; i < s->outputs; i++)
            d->shape[i] += s->shape[i * n + k] * (d->position[k] - rest);
    }
}

static double largest_goal(const modal_structure *s)
{
    double most = 0;
    for (size_t i = 0; i < s->outputs; i++)
        most = fmax(most, fabs(s->goal[i]));
    return most;
}

void damped_loop_keep(damped_loop *d)
{
    const size_t m = d->structure->outputs;
    d->tick++;
    memcpy(d->history + (size_t)(d->tick % HISTORY) * m, d->shape, m * sizeof *d->history);
}

/* Readings of `error.delay` ticks ago, with noise and faults. */
static void read_plant(damped_loop *d)
{
    const size_t m = d->structure->outputs;
    const int then = d->tick > d->error.delay ? d->tick - d->error.delay : 0;
    const double *old = d->history + (size_t)(then % HISTORY) * m;
    const double noise = d->error.noise * largest_goal(d->structure);
    for (size_t i = 0; i < d->sensors; i++) {
        d->sensed[i] = (pzs_real)(old[output_of(d, i)] + noise * uniform(&d->seed, -1.7, 1.7));
        if (d->is_blind)
            d->sensed[i] = (pzs_real)NAN;
        else if ((int)i == d->bad_sensor)
            d->sensed[i] = (pzs_real)d->bad_value;
    }
}

/* The new voltages are inside their limits and step limits. */
static void assert_limits(const damped_loop *d, const pzs_real *last)
{
    const pzs_control_info *info = &d->loop.info.control->info;
    for (size_t j = 0; j < d->problem.inputs; j++) {
        const pzs_real v = d->loop.info.voltage[j];
        assert_true(v >= d->problem.lower[j] && v <= d->problem.upper[j]);
        if (info->lower[j] < info->upper[j])
            assert_true(fabs((double)v - (double)last[j]) <=
                        (double)d->problem.step_limit[j] * (1 + 4 * (double)PZS_EPSILON));
    }
}

pzs_status damped_loop_tick(damped_loop *d, const double *wanted)
{
    pzs_real last[256];
    assert_true(d->problem.inputs <= 256);
    memcpy(last, d->loop.info.voltage, d->problem.inputs * sizeof *last);
    read_plant(d);
    for (size_t i = 0; i < d->structure->outputs; i++)
        d->wanted[i] = (pzs_real)wanted[i];
    const pzs_status status = pzs_loop_tick(&d->loop, d->wanted, d->is_silent ? NULL : d->sensed);
    assert_limits(d, last);
    if (d->is_held)
        return status;
    damped_loop_move_plant(d);
    damped_loop_keep(d);
    return status;
}

/* ---- judgement -------------------------------------------------------- */

/* Whether v_j stands at a limit that its slope pushes it against. */
static bool is_active(double v, double slope, double limit)
{
    return (v <= -limit && slope > 0) || (v >= limit && slope < 0);
}

/*
 * Solve a x = b for the entries that are free, x 0 elsewhere; a positive definite, by elimination.
 *   a [n][n], b [n]  in
 */
static void solve_free(const double *a, const double *b, const bool *is_free, size_t n, double *x)
{
    double *copy = zeros(n * n + n), *right = copy + n * n;
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++)
            copy[i * n + j] = is_free[i] && is_free[j] ? a[i * n + j] : i == j;
        right[i] = is_free[i] ? b[i] : 0;
    }
    for (size_t p = 0; p < n; p++)
        for (size_t i = p + 1; i < n; i++) {
            const double factor = copy[i * n + p] / copy[p * n + p];
            for (size_t j = p; j < n; j++)
                copy[i * n + j] -= factor * copy[p * n + j];
            right[i] -= factor * right[p];
        }
    for (size_t i = n; i-- > 0;) {
        x[i] = right[i];
        for (size_t j = i + 1; j < n; j++)
            x[i] -= copy[i * n + j] * x[j];
        x[i] /= copy[i * n + i];
    }
    free(copy);
}

/* Minimum of v'h v/2 - f'v between the limits by projected Newton steps, halved until they descend.
 */
static void bounded_minimum(const double *h, const double *f, size_t n, double limit, double *v)
{
    double *slope = zeros(3 * n), *way = slope + n, *next = way + n;
    bool *is_free = calloc(n, sizeof *is_free);
    assert_non_null(is_free);
    for (int step = 0; step < 200; step++) {
        double part = 1, change = 0, value = 0, now;
        for (size_t i = 0; i < n; i++) {
            slope[i] = f[i];
            for (size_t j = 0; j < n; j++)
                slope[i] -= h[i * n + j] * v[j];
            value -= v[i] * (f[i] + slope[i]) / 2;
            is_free[i] = !is_active(v[i], -slope[i], limit);
        }
        solve_free(h, slope, is_free, n, way);
        do {
            now = 0;
            for (size_t i = 0; i < n; i++)
                next[i] = fmin(fmax(v[i] + part * way[i], -limit), limit);
            for (size_t i = 0; i < n; i++)
                for (size_t j = 0; j < n; j++)
                    now += next[i] * h[i * n + j] * next[j] / 2;
            for (size_t i = 0; i < n; i++)
                now -= f[i] * next[i];
            part /= 2;
        } while (now > value + 1e-15 * fabs(value) && part > 1e-9);
        for (size_t i = 0; i < n; i++) {
            change = fmax(change, fabs(next[i] - v[i]));
            v[i] = next[i];
        }
        if (change <= 1e-12 * limit)
            break;
    }
    free(slope);
    free(is_free);
}

void damped_loop_optimum(const damped_loop *d, const double *wanted, double *shape)
{
    const modal_structure *s = d->structure;
    const size_t n = s->inputs, m = s->outputs;
    double *h = zeros(n * n), *f = zeros(n), *v = zeros(n);
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < n; j++) {
            const double b = d->error.gain * s->influence[i * n + j];
            f[j] += b * (wanted[i] - d->load * s->load_shape[i]);
            for (size_t l = 0; l < n; l++)
                h[j * n + l] += b * d->error.gain * s->influence[i * n + l];
        }
    for (size_t j = 0; j < n; j++)
        h[j * n + j] += (double)d->problem.regularisation;
    bounded_minimum(h, f, n, s->limit, v);
    for (size_t i = 0; i < m; i++) {
        shape[i] = d->load * s->load_shape[i];
        for (size_t j = 0; j < n; j++)
            shape[i] += d->error.gain * s->influence[i * n + j] * v[j];
    }
    free(h);
    free(f);
    free(v);
}

double damped_loop_distance(const damped_loop *d, const double *y)
{
    double sum = 0, all = 0;
    for (size_t i = 0; i < d->structure->outputs; i++) {
        sum += pow(d->shape[i] - y[i], 2);
        all += pow(d->structure->goal[i], 2);
    }
    return sqrt(sum / all);
}
