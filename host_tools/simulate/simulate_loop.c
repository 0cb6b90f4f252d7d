/* One closed loop, tick by tick (simulate_loop.h). */
#include "simulate_loop.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../tables/loop_blocks.h"

/* ---- random numbers --------------------------------------------------- */

/* splitmix64: the same bits everywhere. */
static uint64_t draw(loop *l)
{
    uint64_t z = l->random += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* From 0 to 1, 1 left out. */
double loop_draw(loop *l)
{
    return (double)(draw(l) >> 11) * 0x1p-53;
}

/* From 0 to count - 1. */
static int draw_int(loop *l, int count)
{
    return (int)(loop_draw(l) * count);
}

/* ---- what the controller is told -------------------------------------- */

static void hold(loop *l, int amplifier, double voltage)
{
    (void)pzs_hold(l->controller.info.control, (uint16_t)amplifier, voltage);
    device_hold(&l->board, amplifier, voltage);
    device_hold(&l->twin, amplifier, voltage);
}

static void release(loop *l, int amplifier)
{
    (void)pzs_release(l->controller.info.control, (uint16_t)amplifier);
    device_release(&l->board, amplifier);
    device_release(&l->twin, amplifier);
}

/* ---- events ----------------------------------------------------------- */

static void set_target(loop *l, const scene_event *event)
{
    for (int i = 0; i < l->design->targets; i++) {
        const expr_point at = mesh_place(&l->design->mesh, l->design->target_node[i]);
        l->goal[i] = expr_value(event->value, &at);
    }
    design_take_free(l->design, l->goal);
}

static void set_load(loop *l, int load, double amount)
{
    l->load[load] = amount;
    if (load < l->design->loads)
        plant_load(&l->simulation->plant, load, amount);
    else
        plant_warm(&l->simulation->plant, amount);
}

static void fail_electrodes(loop *l, const scene_event *event, int tick)
{
    for (int i = 0; i < event->amplifiers; i++) {
        electrode *e = &l->electrode[event->amplifier[i]];
        e->held = event->type == EVENT_DEAD    ? 0
                  : e->fault == ELECTRODE_GOOD ? l->given[event->amplifier[i]]
                                               : e->held;
        e->failed_at = tick;
        e->fault = event->type == EVENT_DEAD ? ELECTRODE_DEAD : ELECTRODE_STUCK;
        e->told_at = event->told >= 0 ? tick + event->told : -1;
        e->good_at = event->ticks > 0 ? tick + event->ticks : -1;
    }
}

static void revive(loop *l, int amplifier)
{
    electrode *e = &l->electrode[amplifier];
    if (e->is_told)
        release(l, amplifier);
    e->fault = ELECTRODE_GOOD;
    e->told_at = e->good_at = -1;
    e->is_told = 0;
}

static void fail_sensors(loop *l, const scene_event *event, int tick)
{
    for (int i = 0; i < l->sensors; i++) {
        if (!(loop_draw(l) < event->amount))
            continue;
        if (event->type == EVENT_NAN)
            l->sensor[i].nan_until = tick + event->ticks;
        else
            l->sensor[i].frozen_until = tick + event->ticks;
    }
}

static void happen(loop *l, const scene_event *event, int tick)
{
    switch (event->type) {
    case EVENT_TARGET: l->factor = event->amount; break;
    case EVENT_VALUE: set_target(l, event); break;
    case EVENT_LOAD: set_load(l, event->load, event->amount); break;
    case EVENT_TEMPERATURE: set_load(l, l->design->loads, event->amount); break;
    case EVENT_ALIVE:
        for (int i = 0; i < event->amplifiers; i++)
            revive(l, event->amplifier[i]);
        break;
    case EVENT_NAN:
    case EVENT_FROZEN: fail_sensors(l, event, tick); break;
    case EVENT_LOST: l->lost_until = tick + event->ticks; break;
    default: fail_electrodes(l, event, tick);
    }
}

/* What the schedule says stands again after the random faults. */
static void schedule(loop *l, const scene_event *event, int tick)
{
    happen(l, event, tick);
    if (event->known)
        l->known[event->load] = event->amount;
    if (event->type == EVENT_TARGET)
        l->scheduled_factor = event->amount;
    if (event->type == EVENT_LOAD || event->type == EVENT_TEMPERATURE)
        l->scheduled_load[event->type == EVENT_LOAD ? event->load : l->design->loads] =
            event->amount;
}

/* One fault of any kind, with sizes and durations that a day's work may bring. */
static void random_fault(loop *l, int tick)
{
    static const scene_event_type kinds[] = {EVENT_NAN,  EVENT_NAN,   EVENT_FROZEN, EVENT_LOST,
                                             EVENT_DEAD, EVENT_STUCK, EVENT_TARGET, EVENT_LOAD};
    int amplifier[2];
    scene_event event = {.type = kinds[draw_int(l, 8)], .amplifier = amplifier, .told = TOLD_NEVER};
    event.amount = loop_draw(l);
    event.ticks = 1 + draw_int(l, 50);
    event.amplifiers = 1 + draw_int(l, 2);
    for (int i = 0; i < 2; i++)
        amplifier[i] = draw_int(l, l->design->amplifiers);
    if (event.type == EVENT_DEAD || event.type == EVENT_STUCK)
        event.told = draw_int(l, 2) ? draw_int(l, event.ticks) : TOLD_NEVER;
    if (event.type == EVENT_NAN && draw_int(l, 4) == 0)
        event.amount = 1; /* every sensor */
    if (event.type == EVENT_TARGET || event.type == EVENT_LOAD)
        event.amount = 2 * event.amount - 1;
    event.load = draw_int(l, l->design->loads + 1);
    if (event.type != EVENT_LOAD || event.load < l->design->loads)
        happen(l, &event, tick);
}

static void end_faults(loop *l)
{
    l->factor = l->scheduled_factor;
    l->lost_until = 0;
    memset(l->sensor, 0, (size_t)l->sensors * sizeof *l->sensor);
    for (int k = 0; k <= l->design->loads; k++)
        set_load(l, k, l->scheduled_load[k]);
    for (int k = 0; k < l->design->amplifiers; k++)
        revive(l, k);
}

/* Known loads are known a tick before they come. */
static void look_ahead(loop *l, int tick)
{
    const scene_simulate *simulate = &l->design->scene->simulate;
    memcpy(l->coming, l->known, (size_t)l->design->loads * sizeof *l->known);
    for (int k = l->next_event; k < simulate->events && simulate->event[k].tick == tick + 1; k++)
        if (simulate->event[k].known)
            l->coming[simulate->event[k].load] = simulate->event[k].amount;
}

static void run_events(loop *l, int tick)
{
    const scene_simulate *simulate = &l->design->scene->simulate;
    if (simulate->fault_chance > 0 && tick < simulate->fault_until &&
        loop_draw(l) < simulate->fault_chance)
        random_fault(l, tick);
    if (simulate->fault_chance > 0 && tick == simulate->fault_until)
        end_faults(l);
    for (; l->next_event < simulate->events && simulate->event[l->next_event].tick == tick;
         l->next_event++)
        schedule(l, &simulate->event[l->next_event], tick);
    look_ahead(l, tick);
    for (int k = 0; k < l->design->amplifiers; k++) {
        electrode *e = &l->electrode[k];
        if (e->good_at == tick)
            revive(l, k);
        if (e->told_at == tick) {
            hold(l, k, e->held);
            e->is_told = 1;
            e->out_since = e->failed_at;
        }
    }
    for (int i = 0; i < l->design->targets; i++)
        l->wanted[i] = l->factor * l->goal[i];
}

/* ---- electrodes ------------------------------------------------------- */

static double through_play(electrode *e, double voltage, double half_range, double share)
{
    double mean = 0;
    for (int i = 0; i < PLAYS; i++) {
        const double slack = half_range * (i + 1) / (2 * PLAYS);
        e->play[i] = fmin(fmax(e->play[i], voltage - slack), voltage + slack);
        mean += e->play[i] / PLAYS;
    }
    return voltage + share * (mean - voltage);
}

/* The share of the plays: a full cycle leaves their mean 5/16 of the range wide. */
static void drive(loop *l)
{
    const design *d = l->design;
    const double hysteresis = d->scene->simulate.hysteresis;
    for (int k = 0; k < d->amplifiers; k++) {
        electrode *e = &l->electrode[k];
        const double voltage = e->fault == ELECTRODE_GOOD ? l->given[k] : e->held;
        l->effect[k] = hysteresis > 0 ? through_play(e, voltage, (d->upper[k] - d->lower[k]) / 2,
                                                     hysteresis * 16 / 5)
                                      : voltage;
    }
}

/* ---- slew ------------------------------------------------------------- */

/* Does the slew allow this change, to the last bit? */
static int may_move(double from, double to, double slew)
{
    return to - from <= slew && from - to <= slew;
}

/* The nearest volt to `to` that the slew allows. */
static double slewed(double from, double to, double slew)
{
    to = fmin(fmax(to, from - slew), from + slew);
    while (!may_move(from, to, slew))
        to = nextafter(to, from);
    return to;
}

/* An electrode whose failure the controller was told of jumps to where it is held. */
static double slew_of(const loop *l, int amplifier)
{
    return l->electrode[amplifier].is_told ? HUGE_VAL : l->design->slew[amplifier];
}

/* ---- laws: step blocks of the simulation -------------------------------- */

static size_t law_bytes(const void *tables, const pzs_problem *problem)
{
    return pzs_step_block.block_bytes(tables, problem);
}

static pzs_status law_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    return pzs_step_block.block_init(self, tables, signals);
}

static loop *loop_of(const pzs_loop_signals *signals)
{
    return ((const law_tables *)(const void *)signals->control->state.problem)->loop;
}

/*
 * As is often done: least squares without limits, regularised or not, cut to limits and step limit.
 */
static pzs_status clamp(void *self, pzs_loop_signals *signals)
{
    loop *l = loop_of(signals);
    const design *d = l->design;
    for (int i = 0; i < d->targets; i++) {
        const double measured = signals->measured[i];
        l->disturbance[i] = isfinite(measured) ? measured - l->predicted[i] : l->disturbance[i];
        l->wish[i] = signals->wanted[i] - l->disturbance[i];
    }
    const pzs_status status = pzs_clipped(self, l->wish, l->next);
    for (int k = 0; status == PZS_OK && k < d->amplifiers; k++)
        l->command[k] = slewed(l->command[k], l->next[k], slew_of(l, k));
    return status;
}

static const pzs_block_type clamp_block = {"clamp", PZS_PHASE_STEP, law_bytes, law_init, clamp};

/* The board's answer, and whether its twin's has the same bits. Returns its status, or -1 with
 * error filled. */
static int ask_board(loop *l, char *error)
{
    const size_t n = (size_t)l->design->amplifiers, loads = (size_t)l->design->loads;
    const double *now = l->controller.settings.known_now;
    if (l->simulation->feeds) {
        device_know(&l->board, now, l->coming, loads);
        device_know(&l->twin, now, l->coming, loads);
    }
    const int status =
        device_tick(&l->board, l->wanted, l->sensed, l->command, l->state, &l->passes, error);
    int passes = 0, same = -1;
    if (status < 0 || !l->twin.board)
        return status;
    same = device_tick(&l->twin, l->wanted, l->sensed, l->next, l->twin_state, &passes, error);
    l->same = same == status && passes == l->passes &&
              memcmp(l->next, l->command, n * sizeof *l->next) == 0 &&
              memcmp(l->twin_state, l->state, n) == 0;
    return same < 0 ? -1 : status;
}

/* The board gets what the sensors say, not what the blocks before made of it: it has them too. */
static pzs_status answer(void *self, pzs_loop_signals *signals)
{
    loop *l = loop_of(signals);
    const int status = ask_board(l, l->message);
    (void)self;
    l->is_silent = status < 0;
    return status < 0 ? PZS_E_STAGE : (pzs_status)status;
}

static const pzs_block_type board_block = {"board", PZS_PHASE_STEP, law_bytes, law_init, answer};

/* The list of the scene; under another law than the library's its own step, and nothing behind. */
static size_t list_blocks(loop *l)
{
    const loop_blocks *all = l->simulation->blocks;
    const int is_board = l->simulation->board && l->law == LAW_CONTROLLER;
    const pzs_block_type *step = is_board ? &board_block : &clamp_block;
    size_t count = 0;
    memcpy(l->block, all->block, sizeof l->block);
    if (l->law == LAW_CONTROLLER && !is_board)
        return (size_t)all->count;
    const simulation *s = l->simulation;
    l->tables = (law_tables){l->law == LAW_REGULARISED ? s->regularised : *s->problem, l};
    while (l->block[count].type->phase != PZS_PHASE_STEP)
        count++;
    l->block[count] = (pzs_block){step, &l->tables};
    return count + 1;
}

/* Lay out the library's loop. Returns its status. */
static pzs_status open_controller(loop *l)
{
    const size_t count = list_blocks(l);
    double none;
    pzs_status status = pzs_loop_init(&l->controller, l->block, count, NULL, &none, 0);
    if (status != PZS_E_WORKSPACE)
        return status;
    const size_t need = (size_t)l->controller.info.where;
    l->work = malloc(need);
    return pzs_loop_init(&l->controller, l->block, count, NULL, l->work, need);
}

/* Electrodes that the watch has found. */
static void learn(loop *l, int tick)
{
    l->found = l->wrong = 0;
    for (int k = 0; k < l->design->amplifiers; k++) {
        electrode *e = &l->electrode[k];
        if (l->state[k] != PZS_ELECTRODE_HELD || e->is_told)
            continue;
        e->is_told = 1;
        e->out_since = 0;
        l->found++;
        if (e->fault == ELECTRODE_GOOD)
            l->wrong++;
        else if (tick - e->failed_at > l->search)
            l->search = tick - e->failed_at;
    }
}

/* A controller that others give its volts: what they are. */
static void follow(loop *l)
{
    pzs_control *control = l->controller.info.control;
    memcpy(control->state.voltage, l->command, (size_t)l->design->amplifiers * sizeof *l->command);
    pzs_control_moved(control);
}

/* What the library's own step leaves. */
static void take_command(loop *l)
{
    const size_t n = (size_t)l->design->amplifiers;
    l->passes = l->controller.info.control->info.iterations;
    memcpy(l->command, l->controller.info.voltage, n * sizeof *l->command);
    if (l->controller.info.electrode)
        memcpy(l->state, l->controller.info.electrode, n);
}

/* The status of a tick as it is counted: that of the law; electrodes found are counted apart. */
static pzs_status counted(const loop *l, pzs_status status)
{
    const pzs_block_type *block = l->controller.info.block;
    const int is_other = l->law != LAW_CONTROLLER || l->board.board;
    if (PZS_IS_ERROR(status))
        return status;
    if (is_other && block && block->phase != PZS_PHASE_STEP)
        return PZS_OK;
    return status == PZS_W_ELECTRODE ? PZS_OK : status;
}

static int command(loop *l, int tick, char *error)
{
    const int is_other = l->law != LAW_CONTROLLER || l->board.board;
    if (l->simulation->estimates && is_other)
        follow(l);
    if (l->simulation->feeds) {
        l->controller.settings.known_now = sense_known(l, tick);
        l->controller.settings.known_next = l->coming;
    }
    l->message = error;
    const pzs_status status = pzs_loop_tick(&l->controller, l->wanted, l->sensed);
    if (l->is_silent)
        return -1;
    l->status = counted(l, status);
    if (PZS_IS_ERROR(status))
        return 0;
    sense_missed(l);
    if (!is_other)
        take_command(l);
    learn(l, tick);
    for (int k = 0; k < l->design->amplifiers; k++)
        if (l->electrode[k].is_told)
            sense_taken_out(l, k, l->electrode[k].out_since, tick);
    sense_predict(l);
    return 0;
}

/* ---- amplifiers ------------------------------------------------------- */

/* The step of the converter nearest to a volt. */
static double converted(double voltage, double step)
{
    return step > 0 ? step * floor(voltage / step + 0.5) : voltage;
}

/* An amplifier obeys limits and slew by itself, gives whole steps, and leaves small changes be. */
static void amplify(loop *l)
{
    const design *d = l->design;
    const scene_simulate *simulate = &d->scene->simulate;
    for (int k = 0; k < d->amplifiers; k++) {
        const double before = l->given[k], slew = slew_of(l, k);
        const double wish =
            slewed(before, fmin(fmax(l->command[k], d->lower[k]), d->upper[k]), slew);
        double voltage = converted(wish, simulate->step);
        if (voltage < d->lower[k] || voltage > d->upper[k] || !may_move(before, voltage, slew))
            voltage += voltage > wish ? -simulate->step : simulate->step;
        const int fits =
            voltage >= d->lower[k] && voltage <= d->upper[k] && may_move(before, voltage, slew);
        if (fits && fabs(l->command[k] - before) > simulate->dead_band)
            l->given[k] = voltage;
    }
}

/* Volts beyond limits, or beyond the slew from those before, in the arithmetic of who chose them.
 */
static int beyond(const loop *l, const double *voltage, const double *before, int bits)
{
    const design *d = l->design;
    int count = 0;
    for (int k = 0; k < d->amplifiers; k++) {
        const double change =
            bits == 32 ? (double)((float)voltage[k] - (float)before[k]) : voltage[k] - before[k];
        count += !(voltage[k] >= d->lower[k] && voltage[k] <= d->upper[k]);
        count += !may_move(0, change, slew_of(l, k));
    }
    return count;
}

static int not_finite(const loop *l)
{
    int count = 0;
    for (int k = 0; k < l->design->amplifiers; k++)
        count += !isfinite(l->command[k]) + !isfinite(l->given[k]);
    return count;
}

int loop_active(const loop *l)
{
    int count = 0;
    for (int k = 0; k < l->design->amplifiers; k++)
        count += l->command[k] <= l->design->lower[k] || l->command[k] >= l->design->upper[k];
    return count;
}

/* ---- tick ------------------------------------------------------------- */

int loop_tick(loop *l, int tick, char *error)
{
    const size_t n = (size_t)l->design->amplifiers;
    run_events(l, tick);
    drive(l);
    if (plant_shape(&l->simulation->plant, l->effect, l->shape, error) < 0)
        return -1;
    l->error = sqrt(design_squares(l->design, l->shape, l->wanted)) / l->simulation->reference;
    if (sense_tick(l, tick, error) < 0)
        return -1;
    l->is_lost = tick < l->lost_until;
    l->beyond = l->not_finite = 0;
    if (l->is_lost)
        return 0;
    memcpy(l->last, l->command, n * sizeof *l->last);
    if (command(l, tick, error) < 0)
        return -1;
    l->beyond = beyond(l, l->command, l->last, l->board.board ? l->board.board->bits : 64);
    memcpy(l->last, l->given, n * sizeof *l->last);
    amplify(l);
    l->beyond += beyond(l, l->given, l->last, 64);
    l->not_finite = not_finite(l);
    if (!PZS_IS_ERROR(l->status))
        return 0;
    return scene_fault(l->design->scene, l->design->scene->simulate.at, error, "tick %d: %s", tick,
                       pzs_status_text(l->status));
}

/* ---- open ------------------------------------------------------------- */

static int take_memory(loop *l)
{
    const design *d = l->design;
    const size_t n = (size_t)d->amplifiers, m = (size_t)d->targets, loads = (size_t)d->loads + 1;
    double *at = l->memory = calloc(5 * m + 2 * loads + 5 * n, sizeof *l->memory);
    l->electrode = calloc(n, sizeof *l->electrode);
    l->state = calloc(2 * n, 1);
    if (!at || !l->electrode || !l->state || !sense_open(l))
        return 0;
    l->twin_state = l->state + n;
    double **const of_targets[] = {&l->goal, &l->wanted, &l->shape, &l->wish, &l->disturbance};
    double **const of_amplifiers[] = {&l->command, &l->given, &l->effect, &l->next, &l->last};
    for (int i = 0; i < 5; i++, at += m)
        *of_targets[i] = at;
    for (int i = 0; i < 5; i++, at += n)
        *of_amplifiers[i] = at;
    l->load = at, at += loads;
    l->scheduled_load = at;
    return 1;
}

static void start(loop *l)
{
    const design *d = l->design;
    l->random = (uint64_t)d->scene->simulate.seed;
    l->factor = l->scheduled_factor = 1;
    memcpy(l->goal, d->target, (size_t)d->targets * sizeof *l->goal);
    memcpy(l->command, l->controller.info.voltage, (size_t)d->amplifiers * sizeof *l->command);
    memcpy(l->given, l->command, (size_t)d->amplifiers * sizeof *l->given);
    memcpy(l->last, l->command, (size_t)d->amplifiers * sizeof *l->last);
    for (int k = 0; k < d->loads; k++)
        l->load[k] = l->scheduled_load[k] = 1;
    for (int k = 0; k < d->amplifiers; k++)
        l->electrode[k].told_at = l->electrode[k].good_at = -1;
    sense_predict(l);
    plant_rest(&l->simulation->plant);
}

/* Board and twin with their volts of the start. */
static int start_board(loop *l, char *error)
{
    const simulation *s = l->simulation;
    const device_board *twin = device_find(s->board->twin);
    if (twin &&
        device_start(&l->twin, twin, s->folder, s->problem, l->sensors, l->command, error) < 0)
        return -1;
    if (device_start(&l->board, s->board, s->folder, s->problem, l->sensors, l->command, error) < 0)
        return -1;
    memcpy(l->given, l->command, (size_t)l->design->amplifiers * sizeof *l->given);
    memcpy(l->last, l->command, (size_t)l->design->amplifiers * sizeof *l->last);
    sense_predict(l);
    return 0;
}

int loop_open(loop *l, simulation *s, simulate_law law, char *error)
{
    const scene *scene = s->nominal->design.scene;
    memset(l, 0, sizeof *l);
    l->design = &s->nominal->design;
    l->simulation = s;
    l->law = law;
    if (!take_memory(l))
        return scene_fault(scene, scene->simulate.at, error, "out of memory");
    const pzs_status status = open_controller(l);
    const pzs_block_type *block = l->controller.info.block;
    if (status != PZS_OK)
        return scene_fault(scene, scene->limits.at, error, "%s: %s",
                           block ? block->name : "control loop", pzs_status_text(status));
    start(l);
    return s->board && law == LAW_CONTROLLER ? start_board(l, error) : 0;
}

void loop_close(loop *l)
{
    free(l->memory);
    free(l->electrode);
    free(l->state);
    free(l->work);
    sense_close(l);
    device_stop(&l->board);
    device_stop(&l->twin);
    memset(l, 0, sizeof *l);
}
