/* SPDX-License-Identifier: BSD-2-Clause */
#include "flip_rig.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define GAIN 0.9 /* response of the plant to a voltage, divided by that of the tables */
#define HISTORY (PZS_DELAY_LIMIT + 1u)

/* Largest difference of the shape at the end of a window, relative to the target. */
#define HARMLESS 1e-3

static size_t modes_of(const flip_plant *plant)
{
    return plant->vibration != NULL ? plant->vibration->modes : 0;
}

static void *zeros(size_t count, size_t size)
{
    void *memory = calloc(count + 1, size);
    assert_non_null(memory);
    return memory;
}

/* ---- plant ----------------------------------------------------------------- */

/* Coordinate of mode k in static equilibrium under the voltages. */
static double rest_of(const flip_rig *rig, size_t k)
{
    const size_t inputs = rig->plant->problem->inputs;
    double rest = 0;
    for (size_t j = 0; j < inputs; j++)
        rest += GAIN * (double)(rig->plant->vibration->modal[k * inputs + j] * rig->given[j]);
    return rest;
}

/* Displacement of output i: static response, load, and deviation of the modes (m). */
static double displacement_of(const flip_rig *rig, size_t i)
{
    const flip_plant *plant = rig->plant;
    const size_t inputs = plant->problem->inputs, modes = modes_of(plant);
    double sum = plant->load != NULL ? (double)(rig->known * plant->load[i]) : 0;
    for (size_t j = 0; j < inputs; j++)
        sum += GAIN * (double)(plant->problem->influence[i * inputs + j] * rig->given[j]);
    for (size_t k = 0; k < modes; k++)
        sum += (double)plant->vibration->shape[i * modes + k] * rig->deviation[k];
    return sum;
}

/* Keep the present shape as a row of the history. */
static void keep_shape(flip_rig *rig)
{
    const size_t outputs = rig->plant->problem->outputs, modes = modes_of(rig->plant);
    double *row = rig->history + rig->tick % HISTORY * outputs;
    for (size_t k = 0; k < modes; k++)
        rig->deviation[k] = rig->position[k] - rest_of(rig, k);
    for (size_t i = 0; i < outputs; i++)
        row[i] = displacement_of(rig, i);
}

/* Move the modes of the plant by one tick. */
static void move_plant(flip_rig *rig)
{
    const size_t modes = modes_of(rig->plant);
    for (size_t k = 0; k < modes; k++) {
        const pzs_real *turn = rig->plant->vibration->turn;
        const double rest = rest_of(rig, k), away = rig->position[k] - rest,
                     speed = rig->velocity[k];
        rig->position[k] = rest + (double)turn[k] * away + (double)turn[modes + k] * speed;
        rig->velocity[k] = (double)turn[2 * modes + k] * away + (double)turn[3 * modes + k] * speed;
    }
    rig->tick++;
    keep_shape(rig);
}

/* ---- rig ----------------------------------------------------------------- */

static void init(flip_rig *rig)
{
    const pzs_problem *problem = rig->plant->problem;
    rig->damage = (flip_damage){.bytes = PZS_CONTROL_BYTES(problem->inputs, problem->outputs)};
    assert_int_equal(pzs_loop_init(&rig->loop, rig->block, rig->count, NULL, rig->work, rig->bytes),
                     PZS_OK);
    if (rig->plant->load != NULL)
        assert_int_equal(pzs_loop_know(&rig->loop, &rig->known, &rig->known), PZS_OK);
}

/* Copy the list of blocks, with the block that damages memory behind the control step. */
static void list_blocks(flip_rig *rig, const pzs_block *blocks, size_t count)
{
    assert_true(count < PZS_BLOCK_LIMIT);
    for (size_t i = 0; i < count; i++) {
        rig->block[rig->count++] = blocks[i];
        if (blocks[i].type == &pzs_step_block)
            rig->block[rig->count++] = (pzs_block){&flip_block, &rig->damage};
    }
}

void flip_rig_open(flip_rig *rig, const flip_plant *plant, const pzs_block *blocks, size_t count)
{
    const size_t outputs = plant->problem->outputs, modes = modes_of(plant);
    pzs_real none;
    memset(rig, 0, sizeof *rig);
    rig->plant = plant;
    rig->seed = 1;
    list_blocks(rig, blocks, count);
    assert_int_equal(pzs_loop_init(&rig->loop, rig->block, rig->count, NULL, &none, 0),
                     PZS_E_WORKSPACE);
    rig->bytes = (size_t)rig->loop.info.where;
    rig->work = zeros(rig->bytes, 1);
    rig->given = zeros(plant->problem->inputs, sizeof *rig->given);
    rig->position = zeros(modes, sizeof *rig->position);
    rig->velocity = zeros(modes, sizeof *rig->velocity);
    rig->deviation = zeros(modes, sizeof *rig->deviation);
    rig->history = zeros(HISTORY * outputs, sizeof *rig->history);
    rig->readings = zeros(outputs, sizeof *rig->readings);
    rig->wanted = zeros(outputs, sizeof *rig->wanted);
    flip_rig_begin(rig);
}

void flip_rig_close(flip_rig *rig)
{
    free(rig->work);
    free(rig->given);
    free(rig->position);
    free(rig->velocity);
    free(rig->deviation);
    free(rig->history);
    free(rig->readings);
    free(rig->wanted);
}

void flip_rig_begin(flip_rig *rig)
{
    const pzs_problem *problem = rig->plant->problem;
    init(rig);
    memcpy(rig->given, rig->loop.info.voltage, problem->inputs * sizeof *rig->given);
    rig->known = 0;
    for (size_t k = 0; k < modes_of(rig->plant); k++) {
        rig->position[k] = rest_of(rig, k);
        rig->velocity[k] = 0;
    }
    for (rig->tick = 0; rig->tick + 1 < HISTORY; rig->tick++)
        keep_shape(rig);
    keep_shape(rig);
}

void flip_rig_restart(flip_rig *rig)
{
    init(rig);
    assert_int_equal(pzs_loop_start(&rig->loop, rig->given), PZS_OK);
}

uint64_t flip_rig_draw(flip_rig *rig)
{
    uint64_t z = rig->seed += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

void flip_rig_damage(flip_rig *rig)
{
    const size_t bytes = sizeof rig->loop + rig->bytes;
    const size_t bit = (size_t)(flip_rig_draw(rig) % (8 * bytes));
    rig->damage.is_due = flip_rig_draw(rig) % 4 == 0;
    rig->damage.bit = bit;
    if (rig->damage.is_due)
        return;
    if (bit < 8 * sizeof rig->loop)
        flip(&rig->loop, bit);
    else
        flip(rig->work, bit - 8 * sizeof rig->loop);
}

pzs_status flip_rig_tick(flip_rig *rig, pzs_real factor)
{
    const flip_plant *plant = rig->plant;
    const size_t outputs = plant->problem->outputs, first = plant->first_sensor;
    const size_t delay = plant->vibration != NULL ? plant->vibration->delay : 0;
    if (plant->load != NULL) {
        rig->known = factor > 0 ? 1 : 0;
        keep_shape(rig);
    }
    const double *shape = rig->history + (rig->tick - delay) % HISTORY * outputs;
    for (size_t i = 0; i < outputs; i++)
        rig->wanted[i] = factor * plant->target[i];
    for (size_t i = first; i < outputs; i++)
        rig->readings[i - first] = (pzs_real)shape[i];
    const pzs_status status = pzs_loop_tick(&rig->loop, rig->wanted, rig->readings);
    rig->damage.is_due = false;
    return status;
}

/* Whether an amplifier may take this voltage of input j. */
static bool is_allowed(const flip_rig *rig, size_t j, pzs_real voltage)
{
    const pzs_problem *problem = rig->plant->problem;
    const pzs_real held = rig->loop.info.control->state.held[0][j], last = rig->given[j];
    const pzs_real change = voltage < last ? last - voltage : voltage - last;
    const bool is_held = voltage >= held && voltage <= held;
    return isfinite(voltage) && voltage >= problem->lower[j] && voltage <= problem->upper[j] &&
           (change <= problem->step_limit[j] || is_held);
}

int flip_rig_take(flip_rig *rig)
{
    int bad = 0;
    for (size_t j = 0; j < rig->plant->problem->inputs; j++) {
        const pzs_real voltage = rig->loop.info.voltage[j];
        bad += is_allowed(rig, j, voltage) ? 0 : 1;
        rig->given[j] = voltage;
    }
    move_plant(rig);
    return bad;
}

double flip_rig_difference(const flip_plant *plant, const pzs_real *one, const pzs_real *other)
{
    const size_t inputs = plant->problem->inputs;
    double square = 0, all = 0;
    for (size_t i = 0; i < plant->problem->outputs; i++) {
        double sum = 0;
        for (size_t j = 0; j < inputs; j++)
            sum += (double)(plant->problem->influence[i * inputs + j] * (one[j] - other[j]));
        square += sum * sum;
        all += (double)plant->target[i] * (double)plant->target[i];
    }
    return sqrt(square / all);
}

/* ---- laws ------------------------------------------------------------------ */

flip_count flip_rig_limits(flip_rig *rig, long flips, pzs_real (*wave)(long tick), long renewed)
{
    flip_count count = {.flips = flips};
    for (long k = 0; k < flips; k++) {
        flip_rig_damage(rig);
        for (int after = 0; after < 2; after++) {
            const pzs_status status = flip_rig_tick(rig, wave(2 * k + after));
            count.beyond += flip_rig_take(rig);
            count.errors += PZS_IS_ERROR(status);
            if (PZS_IS_ERROR(status) || (renewed > 0 && k % renewed == renewed - 1))
                flip_rig_restart(rig);
        }
    }
    printf("# %ld flips: %ld voltages beyond a limit, %ld errors\n", flips, count.beyond,
           count.errors);
    return count;
}

pzs_real flip_rig_factor(const flip_window *window, long tick)
{
    return window->wave(tick < 2 * window->moving ? tick : 2 * window->moving);
}

flip_run flip_rig_run(flip_rig *rig, const flip_window *window)
{
    const size_t inputs = rig->plant->problem->inputs;
    flip_run run = {zeros((size_t)window->ticks, sizeof *run.status),
                    zeros((size_t)window->ticks * inputs, sizeof *run.given)};
    flip_rig_begin(rig);
    for (long t = 0; t < window->ticks; t++) {
        run.status[t] = flip_rig_tick(rig, flip_rig_factor(window, t));
        assert_int_equal(flip_rig_take(rig), 0);
        memcpy(run.given + (size_t)t * inputs, rig->given, inputs * sizeof *run.given);
    }
    return run;
}

void flip_run_close(const flip_run *run)
{
    free(run->status);
    free(run->given);
}

/* Follow one flip to the end of a window. */
static void follow_flip(flip_rig *rig, const flip_window *window, const flip_run *healthy,
                        flip_count *count)
{
    const size_t inputs = rig->plant->problem->inputs;
    const long at = (long)(flip_rig_draw(rig) % (uint64_t)window->moving);
    bool is_told = false;
    double most = 0, last = 0;
    flip_rig_begin(rig);
    for (long t = 0; t < window->ticks; t++) {
        if (t == at)
            flip_rig_damage(rig);
        is_told |= flip_rig_tick(rig, flip_rig_factor(window, t)) != healthy->status[t];
        count->beyond += flip_rig_take(rig);
        last = flip_rig_difference(rig->plant, rig->given, healthy->given + (size_t)t * inputs);
        most = fmax(most, last);
    }
    count->told += is_told;
    count->silent += !is_told && !(last < HARMLESS);
    count->largest = is_told ? count->largest : fmax(count->largest, most);
    count->last = is_told ? count->last : fmax(count->last, last);
}

flip_count flip_rig_harmless(flip_rig *rig, long flips, const flip_window *window)
{
    flip_count count = {.flips = flips};
    const flip_run healthy = flip_rig_run(rig, window);
    for (long k = 0; k < flips; k++)
        follow_flip(rig, window, &healthy, &count);
    printf(
        "# %ld flips: %ld voltages beyond a limit, %ld reported by a status, %ld silent ones end "
        "elsewhere; largest difference on the way %.1e of the target, at the end %.1e\n",
        flips, count.beyond, count.told, count.silent, count.largest, count.last);
    flip_run_close(&healthy);
    return count;
}
