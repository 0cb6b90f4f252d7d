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

/* Response of the plant to a voltage of input j, divided by that of the tables. */
static double gain_of(const flip_plant *plant, size_t j)
{
    const double gain = j < plant->dead_inputs ? 0 : GAIN;
    return plant->is_reversed ? -gain : gain;
}

/* Coordinate of mode k in static equilibrium under the voltages. */
static double rest_of(const flip_rig *rig, size_t k)
{
    const size_t inputs = rig->plant->problem->inputs;
    double rest = 0;
    for (size_t j = 0; j < inputs; j++)
        rest += gain_of(rig->plant, j) *
                (double)(rig->plant->vibration->modal[k * inputs + j] * rig->given[j]);
    return rest;
}

/* Shape under the unknown load, as a multiple of the target. */
static double push_of(const flip_rig *rig)
{
    const flip_plant *plant = rig->plant;
    const double tick = rig->tick > HISTORY ? (double)(rig->tick - HISTORY) : 0;
    return plant->push * (tick < plant->push_ticks ? tick / plant->push_ticks : 1);
}

/* Displacement of output i: static response, load, and deviation of the modes (m). */
static double displacement_of(const flip_rig *rig, size_t i)
{
    const flip_plant *plant = rig->plant;
    const size_t inputs = plant->problem->inputs, modes = modes_of(plant);
    double sum = plant->load != NULL ? (double)(rig->known * plant->load[i]) : 0;
    sum += push_of(rig) * (double)plant->target[i];
    for (size_t j = 0; j < inputs; j++)
        sum +=
            gain_of(plant, j) * (double)(plant->problem->influence[i * inputs + j] * rig->given[j]);
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

void flip_rig_aim(flip_rig *rig, const pzs_block_type *type, size_t bytes)
{
    void *memory = pzs_loop_find(&rig->loop, type);
    assert_non_null(memory);
    assert_true(rig->aims < FLIP_AIMS);
    rig->aim[rig->aims++] = (flip_region){memory, bytes};
}

uint64_t flip_rig_draw(flip_rig *rig)
{
    uint64_t z = rig->seed += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Flip a bit of one of the parts of the memory that flips are aimed at. */
static void damage_aim(flip_rig *rig)
{
    const flip_region *aim = &rig->aim[flip_rig_draw(rig) % rig->aims];
    flip(aim->memory, (size_t)(flip_rig_draw(rig) % (8 * aim->bytes)));
}

void flip_rig_damage(flip_rig *rig)
{
    if (rig->aims > 0 && flip_rig_draw(rig) % 2 == 0) {
        damage_aim(rig);
        return;
    }
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

/* Largest size of an entry of the target (m). */
static pzs_real largest_target(const flip_plant *plant)
{
    pzs_real largest = 0;
    for (size_t i = 0; i < plant->problem->outputs; i++) {
        const pzs_real size = plant->target[i] < 0 ? -plant->target[i] : plant->target[i];
        largest = size > largest ? size : largest;
    }
    return largest;
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
    for (size_t i = 0; i < plant->bad_sensors && rig->tick >= HISTORY + FLIP_BAD; i++)
        rig->readings[i] += largest_target(plant) / 2;
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
        for (size_t j = plant->dead_inputs; j < inputs; j++)
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

/* State of loop and plant. */
typedef struct flip_state {
    pzs_loop loop;
    flip_damage damage;
    uint8_t *work;
    pzs_real *given;
    double *position, *velocity, *history;
    size_t tick;
} flip_state;

static flip_state open_state(const flip_rig *rig)
{
    const flip_plant *plant = rig->plant;
    return (flip_state){.work = zeros(rig->bytes, 1),
                        .given = zeros(plant->problem->inputs, sizeof *rig->given),
                        .position = zeros(modes_of(plant), sizeof *rig->position),
                        .velocity = zeros(modes_of(plant), sizeof *rig->velocity),
                        .history = zeros(HISTORY * plant->problem->outputs, sizeof *rig->history)};
}

static void close_state(const flip_state *state)
{
    free(state->work);
    free(state->given);
    free(state->position);
    free(state->velocity);
    free(state->history);
}

static void keep_state(const flip_rig *rig, flip_state *state)
{
    const flip_plant *plant = rig->plant;
    state->loop = rig->loop;
    state->damage = rig->damage;
    state->tick = rig->tick;
    memcpy(state->work, rig->work, rig->bytes);
    memcpy(state->given, rig->given, plant->problem->inputs * sizeof *rig->given);
    memcpy(state->position, rig->position, modes_of(plant) * sizeof *rig->position);
    memcpy(state->velocity, rig->velocity, modes_of(plant) * sizeof *rig->velocity);
    memcpy(state->history, rig->history, HISTORY * plant->problem->outputs * sizeof *rig->history);
}

static void restore_state(flip_rig *rig, const flip_state *state)
{
    const flip_plant *plant = rig->plant;
    rig->loop = state->loop;
    rig->damage = state->damage;
    rig->tick = state->tick;
    memcpy(rig->work, state->work, rig->bytes);
    memcpy(rig->given, state->given, plant->problem->inputs * sizeof *rig->given);
    memcpy(rig->position, state->position, modes_of(plant) * sizeof *rig->position);
    memcpy(rig->velocity, state->velocity, modes_of(plant) * sizeof *rig->velocity);
    memcpy(rig->history, state->history, HISTORY * plant->problem->outputs * sizeof *rig->history);
}

/* Flip bits in the present state, each followed by three ticks from tick `at` of the window on. */
static void flip_in_state(flip_rig *rig, long flips, const flip_window *window, long at,
                          flip_state *state, flip_count *count)
{
    keep_state(rig, state);
    for (long k = 0; k < flips; k++) {
        flip_rig_damage(rig);
        for (long t = at; t < at + 3; t++) {
            count->errors += PZS_IS_ERROR(flip_rig_tick(rig, flip_rig_factor(window, t)));
            count->beyond += flip_rig_take(rig);
        }
        restore_state(rig, state);
    }
}

flip_count flip_rig_states(flip_rig *rig, long flips, const flip_window *window)
{
    enum { STATES = 50 };
    const long ticks = window->moving - window->first;
    flip_count count = {.flips = flips};
    flip_state state = open_state(rig);
    long done = 0;
    flip_rig_begin(rig);
    for (long t = 0; t < window->moving; t++) {
        const long due = t >= window->first ? flips * (t - window->first + 1) / ticks : 0;
        if (due - done >= flips / STATES || t == window->moving - 1) {
            flip_in_state(rig, due - done, window, t, &state, &count);
            done = due;
        }
        (void)flip_rig_tick(rig, flip_rig_factor(window, t));
        count.beyond += flip_rig_take(rig);
    }
    printf("# %ld flips in ticks %ld to %ld: %ld voltages beyond a limit, %ld errors\n", done,
           window->first, window->moving, count.beyond, count.errors);
    close_state(&state);
    return count;
}

pzs_real flip_rig_factor(const flip_window *window, long tick)
{
    return window->wave(tick < 2 * window->moving ? tick : 2 * window->moving);
}

/* Whether a fault detector holds electrode j as faulty. */
static bool is_held(const flip_rig *rig, size_t j)
{
    const uint8_t *electrode = rig->loop.info.electrode;
    return electrode != NULL && electrode[j] == PZS_ELECTRODE_HELD;
}

flip_run flip_rig_run(flip_rig *rig, const flip_window *window)
{
    const size_t inputs = rig->plant->problem->inputs;
    flip_run run = {zeros((size_t)window->ticks, sizeof *run.status),
                    zeros((size_t)window->ticks * inputs, sizeof *run.given),
                    zeros(inputs, sizeof *run.held)};
    flip_rig_begin(rig);
    for (long t = 0; t < window->ticks; t++) {
        run.status[t] = flip_rig_tick(rig, flip_rig_factor(window, t));
        assert_int_equal(flip_rig_take(rig), 0);
        memcpy(run.given + (size_t)t * inputs, rig->given, inputs * sizeof *run.given);
    }
    for (size_t j = 0; j < inputs; j++)
        run.held[j] = is_held(rig, j);
    return run;
}

void flip_run_close(const flip_run *run)
{
    free(run->status);
    free(run->given);
    free(run->held);
}

/* Whether the same electrodes are held as faulty as without damage. */
static bool has_same_held(const flip_rig *rig, const flip_run *healthy)
{
    size_t j = 0;
    while (j < rig->plant->problem->inputs && is_held(rig, j) == healthy->held[j])
        j++;
    return j == rig->plant->problem->inputs;
}

/*
 * Run the loop after the end of a window, with a target that moves from time to time, until the
 * same electrodes are held as faulty as without damage. A flip in the mean readings may let the
 * fault detector take a dead electrode for a healthy one, which is then not suspected for a while.
 * Returns the number of ticks, or LATEST if the electrodes still differ then.
 */
enum { LATEST = 40000, STILL = 700 };
static long ticks_to_same_held(flip_rig *rig, const flip_run *healthy, flip_count *count)
{
    long t = 0;
    while (t < LATEST && !has_same_held(rig, healthy)) {
        (void)flip_rig_tick(rig, t / STILL % 2 == 0 ? 1 : PZS_R(-0.5));
        count->beyond += flip_rig_take(rig);
        t++;
    }
    return t;
}

/* Follow one flip to the end of a window. */
static void follow_flip(flip_rig *rig, const flip_window *window, const flip_state *first,
                        const flip_run *healthy, flip_count *count)
{
    const size_t inputs = rig->plant->problem->inputs;
    const uint64_t ticks = (uint64_t)(window->moving - window->first);
    const long at = window->first + (long)(flip_rig_draw(rig) % ticks);
    bool is_told = false;
    pzs_status status = PZS_OK;
    double most = 0, last = 0;
    restore_state(rig, first);
    for (long t = window->first; t < window->ticks; t++) {
        if (t == at)
            flip_rig_damage(rig);
        status = flip_rig_tick(rig, flip_rig_factor(window, t));
        is_told |= status != healthy->status[t];
        count->beyond += flip_rig_take(rig);
        last = flip_rig_difference(rig->plant, rig->given, healthy->given + (size_t)t * inputs);
        most = fmax(most, last);
    }
    count->told += is_told;
    const bool runs_on = status == healthy->status[window->ticks - 1];
    const long late = runs_on ? ticks_to_same_held(rig, healthy, count) : 0;
    count->lost += late == LATEST;
    count->latest = late > count->latest ? late : count->latest;
    count->silent += !is_told && !(last < HARMLESS);
    count->largest = is_told ? count->largest : fmax(count->largest, most);
    count->last = is_told ? count->last : fmax(count->last, last);
}

flip_count flip_rig_harmless(flip_rig *rig, long flips, const flip_window *window)
{
    flip_count count = {.flips = flips};
    const flip_run healthy = flip_rig_run(rig, window);
    flip_state first = open_state(rig);
    flip_rig_begin(rig);
    for (long t = 0; t < window->first; t++) {
        (void)flip_rig_tick(rig, flip_rig_factor(window, t));
        (void)flip_rig_take(rig);
    }
    keep_state(rig, &first);
    for (long k = 0; k < flips; k++)
        follow_flip(rig, window, &first, &healthy, &count);
    close_state(&first);
    printf(
        "# %ld flips: %ld voltages beyond a limit, %ld reported by a status, %ld silent ones end "
        "elsewhere, %ld end with other faulty electrodes, at most %ld ticks late; "
        "largest difference on the way %.1e of the target, at the end %.1e\n",
        flips, count.beyond, count.told, count.silent, count.lost, count.latest, count.largest,
        count.last);
    flip_run_close(&healthy);
    return count;
}
