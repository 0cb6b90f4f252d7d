/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Section `simulate` of a scene: plant, sensors, amplifiers and events of the closed-loop
 * simulation.
 */
#include "scene_file.h"
#include "scene_parts.h"

#include <stdlib.h>
#include <string.h>

static const range share = {0, 1, 0, "must lie between 0 and 1"};
static const range tick_count = {1, 10000000, 0, "must be from 1 to 10000000 ticks"};

/* ---- plant ---- */

/* Read one factor for all materials, or a mapping of materials to their factors. */
static int read_factors(reader *reader, int node, void *to, const void *rule)
{
    double **factor = to, all = 1;
    const int is_map = reader->t->node[node].kind == TREE_MAP;
    int i, k;
    (void)rule;
    if (!is_map && read_real(reader, node, &all, &above_zero) != 0)
        return -1;
    *factor = malloc(((size_t)reader->s->materials + 1) * sizeof **factor);
    if (!*factor)
        return tree_fault(reader->t, node, "out of memory");
    for (i = 0; i < reader->s->materials; i++)
        (*factor)[i] = all;
    for (i = is_map ? reader->t->node[node].first : 0; i; i = reader->t->node[i].next) {
        k = find_named(reader->s->material, reader->s->materials, sizeof *reader->s->material,
                       reader->t->node[i].key);
        if (k < 0)
            return tree_fault_at(reader->t, reader->t->node[i].key_at,
                                 "there is no material '%.60s'; give a name of materials",
                                 reader->t->node[i].key);
        if (read_real(reader, i, *factor + k, &above_zero) != 0)
            return -1;
    }
    return 0;
}

static int read_plant_kinematics(reader *reader, int node, void *to, const void *rule)
{
    static const choice kinds[] = {
        {"linear", KINEMATICS_LINEAR}, {"nonlinear", KINEMATICS_NONLINEAR}, {NULL, 0}};
    scene_simulate *simulate = to;
    int kind = 0;
    (void)rule;
    if (read_choice(reader, node, &kind, kinds) != 0)
        return -1;
    simulate->kinematics = (scene_kinematics)kind;
    if (kind == KINEMATICS_NONLINEAR || !reader->s->contact.given)
        return 0;
    return tree_fault(reader->t, node,
                      "a plant with a contact is nonlinear; write kinematics: nonlinear");
}

static int read_inertia(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    simulate->inertia_given = 1;
    return read_flag(reader, node, &simulate->inertia, rule);
}

static int read_hysteresis(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    simulate->hysteresis_given = 1;
    return read_real(reader, node, &simulate->hysteresis, rule);
}

/* Read one factor for all columns of the matrix, or a mapping of actuators to their factors. */
static int read_gain(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    double **gain = to, all = 1;
    const int is_map = reader->t->node[node].kind == TREE_MAP;
    int first, count;
    (void)rule;
    if (!is_map && read_real(reader, node, &all, NULL) != 0)
        return -1;
    *gain = malloc(((size_t)scene->amplifiers + 1) * sizeof **gain);
    if (!*gain)
        return tree_fault(reader->t, node, "out of memory");
    for (int k = 0; k < scene->amplifiers; k++)
        (*gain)[k] = all;
    for (int i = is_map ? reader->t->node[node].first : 0; i; i = reader->t->node[i].next) {
        if (!scene_find_amplifier(scene, reader->t->node[i].key, &first, &count))
            return tree_fault_at(reader->t, reader->t->node[i].key_at,
                                 "there is no actuator '%.60s'; the first one is '%s'",
                                 reader->t->node[i].key, scene->actuator[0].name);
        if (read_real(reader, i, *gain + first, NULL) != 0)
            return -1;
    }
    return 0;
}

/* The plant of a measured matrix: the matrix with errors. */
static int read_measured_plant(reader *reader, int node, void *to, const range *loop)
{
    const field fields[] = {{"gain", read_gain, offsetof(scene_simulate, gain), NULL, 0},
                            {"scatter", read_real, offsetof(scene_simulate, scatter), &share, 0},
                            {"hysteresis", read_hysteresis, 0, loop, 0},
                            {"creep", read_creep, 0, NULL, 0},
                            {NULL, NULL, 0, NULL, 0}};
    return read_map(reader, node, fields, to);
}

static int read_plant(reader *reader, int node, void *to, const void *rule)
{
    static const range counted = {1, 200, 0, "must be from 1 to 200"};
    static const range loop = {
        0, 0.3, 0,
        "must lie between 0 and 0.3; it is the width of the loop over the range of voltages"};
    static const field fields[] = {
        {"kinematics", read_plant_kinematics, 0, NULL, 0},
        {"stiffness", read_factors, offsetof(scene_simulate, stiffness), NULL, 0},
        {"d", read_factors, offsetof(scene_simulate, d), NULL, 0},
        {"hysteresis", read_hysteresis, 0, &loop, 0},
        {"creep", read_creep, 0, NULL, 0},
        {"inertia", read_inertia, 0, NULL, 0},
        {"modes", read_int, offsetof(scene_simulate, modes), &counted, 0},
        {NULL, NULL, 0, NULL, 0}};
    (void)rule;
    if (reader->s->influence.given)
        return read_measured_plant(reader, node, to, &loop);
    return read_map(reader, node, fields, to);
}

/* ---- sensors, amplifiers, faults ---- */

static int read_sight(reader *reader, int node, void *to, const void *rule)
{
    static const choice sights[] = {
        {"estimated", SIGHT_ESTIMATED}, {"measured", SIGHT_MEASURED}, {NULL, 0}};
    scene_simulate *simulate = to;
    int sight = 0;
    (void)rule;
    if (read_choice(reader, node, &sight, sights) != 0)
        return -1;
    simulate->sight = (scene_sight)sight;
    if (sight == SIGHT_MEASURED || reader->s->estimate.given)
        return 0;
    return tree_fault(reader->t, node,
                      "an estimated shape needs readings; add estimate: {readings: [{output: name, "
                      "noise: 1e-6}]}");
}

static int read_measurement(reader *reader, int node, void *to, const void *rule)
{
    static const range late = {0, 16, 0, "must be from 0 to 16 ticks"};
    static const field fields[] = {
        {"shape", read_sight, 0, NULL, 0},
        {"noise", read_real, offsetof(scene_simulate, noise), &not_negative, 0},
        {"delay", read_int, offsetof(scene_simulate, delay), &late, 0},
        {"drift", read_drift, 0, NULL, 0},
        {"quantum", read_quantum, 0, NULL, 0},
        {"outliers", read_outliers, 0, NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    (void)rule;
    return read_map(reader, node, fields, to);
}

static int read_amplification(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {
        {"step", read_real, offsetof(scene_simulate, step), &not_negative, 0},
        {"dead_band", read_real, offsetof(scene_simulate, dead_band), &not_negative, 0},
        {"bandwidth", read_bandwidth, 0, NULL, 0},
        {"reversed", read_reversed, 0, NULL, 0},
        {"swapped", read_swapped, 0, NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    (void)rule;
    return read_map(reader, node, fields, to);
}

static int read_faults(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {
        {"chance", read_real, offsetof(scene_simulate, fault_chance), &share, 1},
        {"until", read_int, offsetof(scene_simulate, fault_until), &tick_count, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene_simulate *simulate = to;
    (void)rule;
    simulate->fault_until = simulate->ticks;
    return read_map(reader, node, fields, to);
}

/* ---- events ---- */

typedef struct event_text {
    scene_event *event;
    int kinds, amount_given, ticks_given, told_given, known_given, impulse_given, frequency_given;
} event_text;

static int read_load_number(reader *reader, int node, scene_event *event)
{
    static const range number = {0, 1e6, 0, "must be the number of a load, the first is 0"};
    if (read_int(reader, node, &event->load, &number) != 0)
        return -1;
    if (event->load < reader->s->loads)
        return 0;
    return tree_fault(reader->t, node, "there is no load %d; the scene has %d, the first is 0",
                      event->load, reader->s->loads);
}

static int read_electrodes(reader *reader, int node, scene_event *event)
{
    return read_amplifier_names(reader, node, &event->amplifier, &event->amplifiers);
}

static const int event_types[] = {EVENT_TARGET, EVENT_VALUE, EVENT_LOAD,  EVENT_TEMPERATURE,
                                  EVENT_DEAD,   EVENT_STUCK, EVENT_ALIVE, EVENT_NAN,
                                  EVENT_FROZEN, EVENT_LOST,  EVENT_LATE,  EVENT_JITTER,
                                  EVENT_DELAY};

/* Largest part of an interval by which a tick may be late or an interval vary. */
static const range part = {0, 0.9, 0,
                           "must lie between 0 and 0.9; it is a part of the interval "
                           "between ticks"};
static const range later_by = {0, 16, 0, "must be from 0 to 16 ticks"};

static int read_event_type(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    scene_event *event = text->event;
    if (text->kinds++)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "an event is one thing; write a second item for '%s'",
                             reader->t->node[node].key);
    event->type = (scene_event_type) * (const int *)rule;
    switch (event->type) {
    case EVENT_TARGET: return read_real(reader, node, &event->amount, NULL);
    case EVENT_VALUE: return read_row_function(reader, node, &event->value, NULL);
    case EVENT_LOAD: return read_load_number(reader, node, event);
    case EVENT_NAN:
    case EVENT_FROZEN: return read_real(reader, node, &event->amount, &share);
    case EVENT_LOST: return read_int(reader, node, &event->ticks, &tick_count);
    case EVENT_LATE:
    case EVENT_JITTER: return read_real(reader, node, &event->amount, &part);
    case EVENT_DELAY: return read_real(reader, node, &event->amount, &later_by);
    case EVENT_TEMPERATURE: break;
    default: return read_electrodes(reader, node, event);
    }
    if (!scene_expands(reader->s))
        return tree_fault(reader->t, node,
                          "a temperature moves nothing; give a layer's material 'alpha'");
    return read_real(reader, node, &event->amount, NULL);
}

static int read_event_amount(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->amount_given = 1;
    return read_real(reader, node, &text->event->amount, rule);
}

static int read_event_impulse(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->impulse_given = 1;
    return read_real(reader, node, &text->event->amount, rule);
}

static int read_event_frequency(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->frequency_given = 1;
    return read_real(reader, node, &text->event->frequency, rule);
}

static int read_event_ticks(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->ticks_given = 1;
    return read_int(reader, node, &text->event->ticks, rule);
}

static int read_event_told(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->told_given = 1;
    if (reader->t->node[node].kind == TREE_SCALAR &&
        strcmp(node_text(reader, node), "detected") == 0) {
        text->event->told = TOLD_FOUND;
        reader->s->simulate.finds = 1;
        return 0;
    }
    return read_int(reader, node, &text->event->told, rule);
}

static int read_event_known(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->known_given = 1;
    if (read_flag(reader, node, &text->event->known, rule) != 0)
        return -1;
    reader->s->simulate.feeds |= text->event->known;
    return 0;
}

static int read_event_at(reader *reader, int node, void *to, const void *rule)
{
    static const range later = {0, 1e7, 0, "must be a tick from 0"};
    event_text *text = to;
    (void)rule;
    if (read_int(reader, node, &text->event->tick, &later) != 0)
        return -1;
    if (text->event->tick < reader->s->simulate.ticks)
        return 0;
    return tree_fault(reader->t, node, "'at: %d' is after the end; the simulation has %d ticks",
                      text->event->tick, reader->s->simulate.ticks);
}

/* Turn the event of a load with an impulse or a frequency into an event of that type. */
static int refine_load(reader *reader, int node, event_text *text)
{
    if (!text->impulse_given && !text->frequency_given)
        return 0;
    if (text->event->type != EVENT_LOAD || text->impulse_given == text->amount_given)
        return tree_fault(reader->t, node,
                          text->impulse_given
                              ? "'impulse' is what a load does instead of its factor, as {load: 0, "
                                "impulse: 0.01}"
                              : "'frequency' belongs to a load with a factor");
    text->event->type = text->impulse_given ? EVENT_IMPULSE : EVENT_SINE;
    return 0;
}

/* Whether an event type lasts for a number of ticks that the key 'ticks' gives. */
static int lasts(scene_event_type type)
{
    return type == EVENT_NAN || type == EVENT_FROZEN || type >= EVENT_SINE;
}

/* Check that the given keys belong to the kind of the event. */
static int check_event(reader *reader, int node, const event_text *text)
{
    const scene_event_type type = text->event->type;
    const int electrodes = type == EVENT_DEAD || type == EVENT_STUCK;
    if (text->kinds == 0)
        return tree_fault(
            reader->t, node,
            "an event needs one of target, value, load, temperature, dead, stuck, alive, "
            "missing_sensors, stuck_sensors, missed_ticks, late, jitter, delay");
    if (text->amount_given != (type == EVENT_LOAD || type == EVENT_SINE) && type != EVENT_IMPULSE)
        return tree_fault(reader->t, node,
                          text->amount_given
                              ? "'factor' belongs to a load; remove it"
                              : "a load needs a factor, as factor: 0 to take it off");
    if (text->ticks_given != lasts(type))
        return tree_fault(reader->t, node,
                          text->ticks_given
                              ? "'ticks' belongs to missing_sensors, stuck_sensors, late, jitter, "
                                "delay and a load with a frequency; remove it"
                              : "this event lasts for some ticks; add ticks: 20");
    if (text->told_given && !electrodes)
        return tree_fault(reader->t, node,
                          "'announced' belongs to dead and stuck electrodes; remove it");
    if (text->known_given && type == EVENT_TEMPERATURE)
        return tree_fault(
            reader->t, node,
            "a temperature that is fed forward is a load of the scene; add {temperature: 1} to "
            "loads, write its number and "
            "the kelvin as load and amount");
    if (text->known_given && type != EVENT_LOAD)
        return tree_fault(reader->t, node, "'feed_forward' belongs to a load; remove it");
    return 0;
}

static int read_event(reader *reader, int node, scene_event *event)
{
    static const range waits = {0, 1e7, 0,
                                "must be ticks from 0, or detected: the fault detector finds it; "
                                "leave it out and it is never announced"};
    static const field fields[] = {{"at", read_event_at, 0, NULL, 1},
                                   {"target", read_event_type, 0, &event_types[0], 0},
                                   {"value", read_event_type, 0, &event_types[1], 0},
                                   {"load", read_event_type, 0, &event_types[2], 0},
                                   {"temperature", read_event_type, 0, &event_types[3], 0},
                                   {"dead", read_event_type, 0, &event_types[4], 0},
                                   {"stuck", read_event_type, 0, &event_types[5], 0},
                                   {"alive", read_event_type, 0, &event_types[6], 0},
                                   {"missing_sensors", read_event_type, 0, &event_types[7], 0},
                                   {"stuck_sensors", read_event_type, 0, &event_types[8], 0},
                                   {"missed_ticks", read_event_type, 0, &event_types[9], 0},
                                   {"late", read_event_type, 0, &event_types[10], 0},
                                   {"jitter", read_event_type, 0, &event_types[11], 0},
                                   {"delay", read_event_type, 0, &event_types[12], 0},
                                   {"impulse", read_event_impulse, 0, NULL, 0},
                                   {"frequency", read_event_frequency, 0, &above_zero, 0},
                                   {"factor", read_event_amount, 0, NULL, 0},
                                   {"ticks", read_event_ticks, 0, &tick_count, 0},
                                   {"announced", read_event_told, 0, &waits, 0},
                                   {"feed_forward", read_event_known, 0, NULL, 0},
                                   {NULL, NULL, 0, NULL, 0}};
    event_text text = {0};
    text.event = event;
    event->told = TOLD_NEVER;
    event->at = node_at(reader, node);
    if (read_map(reader, node, fields, &text) != 0 || refine_load(reader, node, &text) != 0)
        return -1;
    return check_event(reader, node, &text);
}

static int read_events(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    int i, k = 0;
    (void)rule;
    simulate->event =
        new_items(reader, node, TREE_LIST, sizeof *simulate->event, &simulate->events);
    if (!simulate->event)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++) {
        if (read_event(reader, i, &simulate->event[k]) != 0)
            return -1;
        if (k > 0 && simulate->event[k].tick < simulate->event[k - 1].tick)
            return tree_fault(reader->t, i,
                              "tick %d comes after tick %d; write the events in their order",
                              simulate->event[k].tick, simulate->event[k - 1].tick);
    }
    return 0;
}

/* ---- the section ---- */

int read_simulate(reader *reader, int node, void *to, const void *rule)
{
    static const range seeds = {0, 1e9, 0, "must be from 0 to 1e9"};
    static const choice places[] = {{"undeformed", 0}, {"target", 1}, {NULL, 0}};
    static const double default_rate = 1000;
    static const field fields[] = {
        {"ticks", read_int, offsetof(scene_simulate, ticks), &tick_count, 1},
        {"seed", read_int, offsetof(scene_simulate, seed), &seeds, 0},
        {"influence", read_choice, offsetof(scene_simulate, at_target), places, 0},
        {"plant", read_plant, 0, NULL, 0},
        {"sensors", read_measurement, 0, NULL, 0},
        {"amplifiers", read_amplification, 0, NULL, 0},
        {"faults", read_faults, 0, NULL, 0},
        {"events", read_events, 0, NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    (void)rule;
    scene->simulate.at = node_at(reader, node);
    if (scene->control.rate == 0)
        scene->control.rate = default_rate;
    scene->simulate.seed = 1;
    scene->simulate.modes = 100;
    scene->simulate.kinematics =
        scene->kinematics == KINEMATICS_LINEAR ? KINEMATICS_LINEAR : KINEMATICS_NONLINEAR;
    if (!scene->target.given)
        return tree_fault(
            reader->t, node,
            "a simulation needs a target; add target: {u3: middle, at: nodes, value: ...}");
    if (read_map(reader, node, fields, &scene->simulate) != 0)
        return -1;
    scene->simulate.given = 1;
    if (!scene->simulate.at_target || scene->kinematics != KINEMATICS_LINEAR)
        return 0;
    return tree_fault(reader->t, tree_find(reader->t, node, "influence"),
                      "'influence: target' needs the nonlinear structure; write "
                      "kinematics: nonlinear");
}
