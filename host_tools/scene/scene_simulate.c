/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Section `simulate` of a scene file: plant, sensors, amplifiers and events of the closed-loop
 * simulation.
 */
#include "scene_file.h"
#include "scene_parts.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const range share = {0, 1, 0, "must lie between 0 and 1"};
static const range later = {0, 1e7, 0, "must be a tick from 0"};
static const range load_number = {0, 1e6, 0, "must be the number of a load, the first is 0"};
static const range tick_count = {1, 10000000, 0, "must be from 1 to 10000000 ticks"};

/* ---- simulated plant ---- */

static const form named_factors_form = {.type = FORM_NAMED, .item = &above_zero_form};
static const form *const factors_forms[] = {&above_zero_form, &named_factors_form, NULL};
static const form factors_form = {.type = FORM_ANY, .any = factors_forms};

/*
 * Read factors of material constants: one factor for all materials, or a mapping of material names
 * to their factors.
 */
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

static const choice plant_kinematics[] = {
    {"linear", KINEMATICS_LINEAR}, {"nonlinear", KINEMATICS_NONLINEAR}, {NULL, 0}};
static const form plant_kinematics_form = {.type = FORM_WORD, .words = plant_kinematics};

static int read_plant_kinematics(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    int kind = 0;
    (void)rule;
    if (read_choice(reader, node, &kind, plant_kinematics) != 0)
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
    simulate->inertia_given = true;
    return read_flag(reader, node, &simulate->inertia, rule);
}

static const choice motions[] = {
    {"modal", MOTION_MODAL}, {"nonlinear", MOTION_NONLINEAR}, {NULL, 0}};
static const form motion_form = {.type = FORM_WORD, .words = motions};

static int read_motion(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    int motion = 0;
    (void)rule;
    simulate->motion_given = true;
    if (read_choice(reader, node, &motion, motions) != 0)
        return -1;
    simulate->motion = (scene_motion)motion;
    return 0;
}

static int read_hysteresis(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    simulate->hysteresis_given = true;
    return read_real(reader, node, &simulate->hysteresis, rule);
}

static const range mode_count = {1, 200, 0, "must be from 1 to 200"};
static const range step_count = {1, 1000, 0, "must be from 1 to 1000"};
static const range creep_part = {
    0, 0.2, 0, "must lie between 0 and 0.2; it is the creep a decade of time over the voltage"};
static const range loop_width = {
    0, 0.3, 0,
    "must lie between 0 and 0.3; it is the width of the loop over the range of voltages"};

static const range curve_part = {
    -0.2, 0.2, 0, "must lie between -0.2 and 0.2; it is a part of the range of effects"};

static const form loop_width_form = {.type = FORM_NUMBER, .range = &loop_width};

/*
 * Rows of the key table for hysteresis and creep, shared by plants with a structural model and
 * plants with a measured influence matrix.
 */
#define HYSTERESIS_ROWS                                                                            \
    {"hysteresis",                                                                                 \
     read_hysteresis,                                                                              \
     0,                                                                                            \
     &loop_width,                                                                                  \
     0,                                                                                            \
     OF_NUMBER,                                                                                    \
     &loop_width_form,                                                                             \
     "Width of the hysteresis loop of a full cycle over the range of the voltages; default 0.1 "   \
     "for a piezoceramic between finite limits, otherwise 0."},                                    \
    {                                                                                              \
        "creep", read_real, offsetof(scene_simulate, imperfections.creep), &creep_part, 0,         \
            OF_NUMBER, NULL,                                                                       \
            "Creep of the ceramic a decade of time over the voltage, with the time constants "     \
            "0.1, 1 and 10 s; default 0."                                                          \
    }

static const field plant_fields[] = {
    {"kinematics", read_plant_kinematics, .form = &plant_kinematics_form,
     .help = "Kinematics of the plant; default that of the scene."},
    {"stiffness", read_factors, offsetof(scene_simulate, stiffness), .of = OF_NUMBER,
     .form = &factors_form,
     .help = "Stiffness of the plant over that of the scene, of all materials or of some by name."},
    {"d", read_factors, offsetof(scene_simulate, d), .of = OF_NUMBER, .form = &factors_form,
     .help = "Piezoelectric constants of the plant over those of the scene, of all materials or of "
             "some by name."},
    HYSTERESIS_ROWS,
    {"inertia", read_inertia, .form = &flag_form,
     .help = "Whether the plant vibrates; default true where all densities are given."},
    {"modes", read_int, offsetof(scene_simulate, modes), &mode_count, .of = OF_NUMBER,
     .help = "Largest number of modes that vibrate; the others follow without delay; default "
             "100."},
    {"motion", read_motion, .form = &motion_form,
     .help =
         "Motion of a plant that vibrates; nonlinear: all degrees of freedom at large rotation, "
         "the default for a nonlinear plant; modal: the modes of the undeformed state about the "
         "static equilibrium, the default for a linear one."},
    {"steps", read_int, offsetof(scene_simulate, steps), &step_count, .of = OF_NUMBER,
     .help = "Fewest time steps of a nonlinear motion in a tick; default so many that the fastest "
             "mode which the controller can follow takes 12 steps a period or more."},
    {.key = NULL}};

/* Read factors of the columns of a measured influence matrix; a column without a factor has 1. */
static int read_gain(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    return read_amplifier_numbers(reader, node, 1, to);
}

/*
 * Keys of the simulated plant in a scene file with a measured influence matrix. The response of the
 * plant is this matrix with errors in its entries.
 */
static const field measured_plant_fields[] = {
    {"gain", read_gain, offsetof(scene_simulate, gain), .of = OF_NUMBER,
     .form = &amplifier_numbers_form,
     .help = "Measured matrix: factor of its columns in the plant, of all or of some actuators by "
             "name."},
    {"scatter", read_real, offsetof(scene_simulate, scatter), &share, .of = OF_NUMBER,
     .help = "Measured matrix: standard deviation of the relative error of its entries; default "
             "0."},
    {"curve_error", read_real, offsetof(scene_simulate, curve_error), &curve_part, .of = OF_NUMBER,
     .help = "Deviation of the plant's actuator curves from influence.curve in the middle of the "
             "range of effects, over this range, towards larger effects; default 0."},
    HYSTERESIS_ROWS,
    {"inertia", read_inertia, .form = &flag_form,
     .help = "Whether the plant vibrates; default true where influence.modes are given."},
    {.key = NULL}};

static const form structure_plant_form = {.type = FORM_MAP, .fields = plant_fields};
static const form measured_plant_form = {.type = FORM_MAP, .fields = measured_plant_fields};
static const form *const plant_forms[] = {&structure_plant_form, &measured_plant_form, NULL};
static const form plant_form = {.type = FORM_ANY, .any = plant_forms};

static int read_plant(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    return read_map(reader, node, reader->s->influence.given ? measured_plant_fields : plant_fields,
                    to);
}

/* ---- sensors, amplifiers, faults ---- */

static const choice sights[] = {
    {"estimated", SIGHT_ESTIMATED}, {"measured", SIGHT_MEASURED}, {NULL, 0}};
static const form sight_form = {.type = FORM_WORD, .words = sights};

static int read_sight(reader *reader, int node, void *to, const void *rule)
{
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

static const range late = {
    0, 16, 0, "must be from 0 to 16 ticks; lower control.rate where readings are older"};

static const field outlier_fields[] = {
    {"chance", read_real, offsetof(scene_imperfections, outlier_chance), &share, 1, .of = OF_NUMBER,
     .help = "Probability that a reading is an outlier."},
    {"size", read_real, offsetof(scene_imperfections, outlier_size), &above_zero, 1,
     .of = OF_NUMBER, .help = "Largest error of an outlier, in the unit of the reading."},
    {.key = NULL}};
static const form outliers_form = {.type = FORM_MAP, .fields = outlier_fields};

static int read_outliers(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    return read_map(reader, node, outlier_fields, &((scene_simulate *)to)->imperfections);
}

static const field measurement_fields[] = {
    {"shape", read_sight, .form = &sight_form,
     .help = "estimated: from the readings of estimate, the default where there are some; "
             "measured: at every target node."},
    {"noise", read_real, offsetof(scene_simulate, noise), &not_negative, .of = OF_LENGTH,
     .help = "Standard deviation of the noise of measured shapes; the readings of estimate have "
             "their own; default 0."},
    {"range", read_real, offsetof(scene_simulate, range), &above_zero, .of = OF_LENGTH,
     .help = "Largest believable size of a measured displacement; the loop takes a larger one as "
             "missing. Default: four times what voltages and loads can make, where the scene has "
             "control.sensor_gate; otherwise none."},
    {"delay", read_int, offsetof(scene_simulate, delay), &late, .of = OF_NUMBER,
     .help = "Delay of the readings in ticks, which the controller knows; default 0."},
    {"drift", read_real, offsetof(scene_simulate, imperfections.drift), &not_negative,
     .of = OF_NUMBER,
     .help = "Largest drift of a sensor, of random size and sign, in the unit of the reading a "
             "second; default 0."},
    {"quantum", read_real, offsetof(scene_simulate, imperfections.quantum), &not_negative,
     .of = OF_NUMBER,
     .help = "Step of the converters of the sensors, in the unit of the reading; default 0."},
    {"outliers", read_outliers, .of = OF_NUMBER, .form = &outliers_form,
     .help = "Wrong readings at random."},
    {.key = NULL}};
static const form measurement_form = {.type = FORM_MAP, .fields = measurement_fields};

static int read_measurement(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    return read_map(reader, node, measurement_fields, to);
}

static const field amplification_fields[] = {
    {"step", read_real, offsetof(scene_simulate, step), &not_negative, .of = OF_VOLTAGE,
     .help = "Voltage resolution of the converters; default 0."},
    {"dead_band", read_real, offsetof(scene_simulate, dead_band), &not_negative, .of = OF_VOLTAGE,
     .help = "Largest change of a voltage that an amplifier does not follow; default 0."},
    {"bandwidth", read_real, offsetof(scene_simulate, imperfections.bandwidth), &above_zero,
     .of = OF_RATE,
     .help = "Corner frequency of the amplifiers, a lag of first order, of which a damped tick "
             "knows where it is longer than a tick; default no lag."},
    {"reversed", read_reversed, .form = &labels_form,
     .help = "Amplifiers whose wires are reversed."},
    {"swapped", read_swapped, .form = &labels_form,
     .help = "Amplifiers whose cables are swapped: the first with the second, the third with the "
             "fourth."},
    {.key = NULL}};
static const form amplification_form = {.type = FORM_MAP, .fields = amplification_fields};

static int read_amplification(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    return read_map(reader, node, amplification_fields, to);
}

static const field faults_fields[] = {
    {"chance", read_real, offsetof(scene_simulate, fault_chance), &share, 1, .of = OF_NUMBER,
     .help = "Probability of a random fault in a tick."},
    {"until", read_int, offsetof(scene_simulate, fault_until), &tick_count, .of = OF_NUMBER,
     .help = "Tick from which no random faults occur and all faults have ended; default the end."},
    {.key = NULL}};
static const form faults_form = {.type = FORM_MAP, .fields = faults_fields};

static int read_faults(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    (void)rule;
    simulate->fault_until = simulate->ticks;
    return read_map(reader, node, faults_fields, to);
}

/* ---- events of the simulation ---- */

typedef struct event_text {
    scene_event *event;
    int kinds;
    bool factor_given, ticks_given, announced_given, feed_forward_given, impulse_given,
        frequency_given, error_given;
} event_text;

static int read_load_number(reader *reader, int node, scene_event *event)
{
    if (read_int(reader, node, &event->load, &load_number) != 0)
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

static const int event_types[] = {
    EVENT_TARGET,        EVENT_VALUE,        EVENT_LOAD,  EVENT_TEMPERATURE,
    EVENT_DEAD,          EVENT_STUCK,        EVENT_ALIVE, EVENT_MISSING_SENSORS,
    EVENT_STUCK_SENSORS, EVENT_MISSED_TICKS, EVENT_LATE,  EVENT_JITTER,
    EVENT_DELAY,         EVENT_WRONG_SENSORS};

/*
 * Permitted range of two keys, both fractions of a tick interval: by how much voltages may be late,
 * and by how much the interval may vary.
 */
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
    case EVENT_TARGET: return read_real(reader, node, &event->size, NULL);
    case EVENT_VALUE: return read_row_function(reader, node, &event->value, NULL);
    case EVENT_LOAD: return read_load_number(reader, node, event);
    case EVENT_MISSING_SENSORS:
    case EVENT_STUCK_SENSORS:
    case EVENT_WRONG_SENSORS: return read_real(reader, node, &event->size, &share);
    case EVENT_MISSED_TICKS: return read_int(reader, node, &event->ticks, &tick_count);
    case EVENT_LATE:
    case EVENT_JITTER: return read_real(reader, node, &event->size, &part);
    case EVENT_DELAY: return read_real(reader, node, &event->size, &later_by);
    case EVENT_TEMPERATURE: break;
    default: return read_electrodes(reader, node, event);
    }
    if (!scene_expands(reader->s))
        return tree_fault(reader->t, node,
                          "a temperature moves nothing; give a layer's material 'alpha'");
    return read_real(reader, node, &event->size, NULL);
}

static int read_event_factor(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->factor_given = true;
    return read_real(reader, node, &text->event->size, rule);
}

static int read_event_impulse(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->impulse_given = true;
    return read_real(reader, node, &text->event->size, rule);
}

static int read_event_frequency(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->frequency_given = true;
    return read_real(reader, node, &text->event->frequency, rule);
}

static int read_event_error(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->error_given = true;
    return read_real(reader, node, &text->event->error, rule);
}

static int read_event_ticks(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->ticks_given = true;
    return read_int(reader, node, &text->event->ticks, rule);
}

static int read_event_announced(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->announced_given = true;
    if (reader->t->node[node].kind == TREE_SCALAR &&
        strcmp(node_text(reader, node), "detected") == 0) {
        text->event->announced_after = ANNOUNCED_DETECTED;
        reader->s->simulate.detects_faults = true;
        return 0;
    }
    return read_int(reader, node, &text->event->announced_after, rule);
}

static int read_event_feed_forward(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    text->feed_forward_given = true;
    if (read_flag(reader, node, &text->event->feed_forward, rule) != 0)
        return -1;
    reader->s->simulate.has_feed_forward |= text->event->feed_forward;
    return 0;
}

static int read_event_at(reader *reader, int node, void *to, const void *rule)
{
    event_text *text = to;
    (void)rule;
    if (read_int(reader, node, &text->event->tick, &later) != 0)
        return -1;
    if (text->event->tick < reader->s->simulate.ticks)
        return 0;
    return tree_fault(reader->t, node, "'at: %d' is after the end; the simulation has %d ticks",
                      text->event->tick, reader->s->simulate.ticks);
}

/*
 * Change the type of a load event to an impulse if the event has the key `impulse`, or to a
 * sinusoidal load if it has the key `frequency`.
 */
static int refine_load(reader *reader, int node, event_text *text)
{
    if (!text->impulse_given && !text->frequency_given)
        return 0;
    if (text->event->type != EVENT_LOAD || text->impulse_given == text->factor_given)
        return tree_fault(reader->t, node,
                          text->impulse_given
                              ? "'impulse' is what a load does instead of its factor, as {load: 0, "
                                "impulse: 0.01}"
                              : "'frequency' belongs to a load with a factor; add the factor");
    text->event->type = text->impulse_given ? EVENT_IMPULSE : EVENT_SINE;
    return 0;
}

/*
 * Return whether events of a type, such as a sinusoidal load, last for the number of ticks that
 * their key `ticks` gives.
 */
static int lasts(scene_event_type type)
{
    return type == EVENT_MISSING_SENSORS || type == EVENT_STUCK_SENSORS ||
           type == EVENT_WRONG_SENSORS || type >= EVENT_SINE;
}

/*
 * Check that an event of the simulation has all keys that its type needs, and no key that its type
 * does not permit.
 */
static int check_event(reader *reader, int node, const event_text *text)
{
    const scene_event_type type = text->event->type;
    const int electrodes = type == EVENT_DEAD || type == EVENT_STUCK;
    if (text->kinds == 0)
        return tree_fault(
            reader->t, node,
            "an event needs one of target, value, load, temperature, dead, stuck, alive, "
            "missing_sensors, stuck_sensors, wrong_sensors, missed_ticks, late, jitter, delay");
    if (text->factor_given != (type == EVENT_LOAD || type == EVENT_SINE) && type != EVENT_IMPULSE)
        return tree_fault(reader->t, node,
                          text->factor_given
                              ? "'factor' belongs to a load; remove it"
                              : "a load needs a factor, as factor: 0 to take it off");
    if (text->ticks_given != lasts(type))
        return tree_fault(reader->t, node,
                          text->ticks_given
                              ? "'ticks' belongs to missing_sensors, stuck_sensors, wrong_sensors, "
                                "late, jitter, "
                                "delay and a load with a frequency; remove it"
                              : "this event lasts for some ticks; add ticks: 20");
    if (text->error_given != (type == EVENT_WRONG_SENSORS))
        return tree_fault(reader->t, node,
                          text->error_given
                              ? "'error' belongs to wrong_sensors; remove it"
                              : "wrong sensors need an error, as error: 0.001, in the unit of the "
                                "reading");
    if (text->announced_given && !electrodes)
        return tree_fault(reader->t, node,
                          "'announced' belongs to dead and stuck electrodes; remove it");
    if (text->feed_forward_given && type == EVENT_TEMPERATURE)
        return tree_fault(
            reader->t, node,
            "a temperature that is fed forward is a load of the scene; add {temperature: 1} to "
            "loads, write its number and "
            "the kelvin as load and factor");
    if (text->feed_forward_given && type != EVENT_LOAD)
        return tree_fault(reader->t, node, "'feed_forward' belongs to a load; remove it");
    return 0;
}

static const range waits = {0, 1e7, 0,
                            "must be ticks from 0, or detected: the fault detector finds it; leave "
                            "it out and it is never announced"};
static const form tick_form = {.type = FORM_WHOLE, .range = &later};
static const form duration_form = {.type = FORM_WHOLE, .range = &tick_count};
static const form share_form = {.type = FORM_NUMBER, .range = &share};
static const form load_number_form = {.type = FORM_WHOLE, .range = &load_number};
static const choice detected[] = {{"detected", ANNOUNCED_DETECTED}, {NULL, 0}};
static const form detected_form = {.type = FORM_WORD, .words = detected};
static const form waits_form = {.type = FORM_WHOLE, .range = &waits};
static const form *const announced_forms[] = {&detected_form, &waits_form, NULL};
static const form announced_form = {.type = FORM_ANY, .any = announced_forms};
static const form part_form = {.type = FORM_NUMBER, .range = &part};
static const form later_by_form = {.type = FORM_NUMBER, .range = &later_by};
static const form frequency_form = {.type = FORM_NUMBER, .range = &above_zero};

static const field event_fields[] = {
    {"at", read_event_at, .required = 1, .of = OF_NUMBER, .form = &tick_form,
     .help = "Tick of the event, from 0."},
    {"target", read_event_type, 0, &event_types[0], .of = OF_NUMBER, .form = &number_form,
     .help = "Factor of the target from this tick on."},
    {"value", read_event_type, 0, &event_types[1], .of = OF_LENGTH, .form = &row_function_form,
     .help = "New target from this tick on; the factor of the target stays."},
    {"load", read_event_type, 0, &event_types[2], .of = OF_NUMBER, .form = &load_number_form,
     .help = "Number of a load of the scene, the first is 0, whose factor changes."},
    {"temperature", read_event_type, 0, &event_types[3], .of = OF_TEMPERATURE, .form = &number_form,
     .help = "Uniform temperature above that of the stress-free shape."},
    {"dead", read_event_type, 0, &event_types[4], .form = &labels_form,
     .help = "Amplifiers whose electrodes are at 0 V from this tick on."},
    {"stuck", read_event_type, 0, &event_types[5], .form = &labels_form,
     .help = "Amplifiers whose electrodes keep their voltage from this tick on."},
    {"alive", read_event_type, 0, &event_types[6], .form = &labels_form,
     .help = "Amplifiers that work again; the controller is informed at once."},
    {"missing_sensors", read_event_type, 0, &event_types[7], .of = OF_NUMBER, .form = &share_form,
     .help = "Fraction of the sensors whose reading is NaN for some ticks."},
    {"stuck_sensors", read_event_type, 0, &event_types[8], .of = OF_NUMBER, .form = &share_form,
     .help = "Fraction of the sensors that keep their last reading for some ticks."},
    {"wrong_sensors", read_event_type, 0, &event_types[13], .of = OF_NUMBER, .form = &share_form,
     .help = "Fraction of the sensors, at least one, whose reading is wrong by the error for some "
             "ticks."},
    {"error", read_event_error, .of = OF_NUMBER, .form = &number_form,
     .help = "What is added to the readings of wrong sensors, in the unit of the reading."},
    {"missed_ticks", read_event_type, 0, &event_types[9], .of = OF_NUMBER, .form = &duration_form,
     .help = "Number of ticks in which the controller does not run."},
    {"late", read_event_type, 0, &event_types[10], .of = OF_NUMBER, .form = &part_form,
     .help = "For some ticks the voltages act a random part of the interval late, up to this "
             "part."},
    {"jitter", read_event_type, 0, &event_types[11], .of = OF_NUMBER, .form = &part_form,
     .help = "For some ticks the interval is longer or shorter by a random part, up to this part."},
    {"delay", read_event_type, 0, &event_types[12], .of = OF_NUMBER, .form = &later_by_form,
     .help = "For some ticks the readings arrive so many ticks later than the controller "
             "believes."},
    {"impulse", read_event_impulse, .of = OF_NUMBER, .form = &number_form,
     .help = "The load acts like a hammer: its force of the scene during so many seconds, at one "
             "instant."},
    {"frequency", read_event_frequency, 0, &above_zero, .of = OF_RATE, .form = &frequency_form,
     .help = "The load varies by factor sin(2 pi frequency t) for some ticks."},
    {"factor", read_event_factor, .of = OF_NUMBER, .form = &number_form,
     .help = "Factor of the load from this tick on."},
    {"ticks", read_event_ticks, 0, &tick_count, .of = OF_NUMBER, .form = &duration_form,
     .help = "Duration in ticks of an event that lasts."},
    {"announced", read_event_announced, 0, &waits, .of = OF_NUMBER, .form = &announced_form,
     .help = "Ticks until the controller is informed of dead or stuck electrodes; detected: the "
             "fault detector finds them; never announced if not given."},
    {"feed_forward", read_event_feed_forward, .form = &flag_form,
     .help = "The controller is given the factor of the load one tick in advance; default false."},
    {.key = NULL}};

static const form_case event_cases[] = {{"target", NULL},
                                        {"value", NULL},
                                        {"load factor ?feed_forward", NULL},
                                        {"load factor frequency ticks", NULL},
                                        {"load impulse", NULL},
                                        {"temperature", NULL},
                                        {"dead ?announced", NULL},
                                        {"stuck ?announced", NULL},
                                        {"alive", NULL},
                                        {"missing_sensors ticks", NULL},
                                        {"stuck_sensors ticks", NULL},
                                        {"wrong_sensors error ticks", NULL},
                                        {"missed_ticks", NULL},
                                        {"late ticks", NULL},
                                        {"jitter ticks", NULL},
                                        {"delay ticks", NULL},
                                        {NULL, NULL}};
static const form event_form = {.type = FORM_MAP, .fields = event_fields, .cases = event_cases};
/* Add the event that one row of a schedule file (table of events of the simulation) describes. */
static int read_scheduled(reader *reader, int node, const number_table *table, size_t row,
                          const int column[2], scene_event *event)
{
    const double *values = table->value + row * table->columns;
    const double tick = values[column[0]], factor = values[column[1]];
    char place[NUMBER_NAME];
    number_table_place(table, row, (size_t)column[0], place);
    if (!(tick >= 0 && tick < reader->s->simulate.ticks && tick == floor(tick)))
        return tree_fault(reader->t, node, "%.80s: %s is %g; a tick is a whole number from 0 to %d",
                          node_text(reader, node), place, tick, reader->s->simulate.ticks - 1);
    if (row > 0 && tick < table->value[(row - 1) * table->columns + (size_t)column[0]])
        return tree_fault(reader->t, node,
                          "%.80s: %s: tick %g comes after a later one; sort the "
                          "lines by their ticks",
                          node_text(reader, node), place, tick);
    if (!isfinite(factor))
        return tree_fault(reader->t, node, "%.80s: %s has the factor %g; write a finite number",
                          node_text(reader, node), place, factor);
    event->type = EVENT_TARGET;
    event->tick = (int)tick;
    event->size = factor;
    event->announced_after = ANNOUNCED_NEVER;
    event->at = node_at(reader, node);
    return 0;
}

/* Read the events of a schedule file, a table with the columns `at` and `target`. */
static int read_schedule_file(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    number_table table;
    (void)rule;
    if (scene_table_read(reader, node, &table) != 0)
        return -1;
    const int column[2] = {number_table_column(&table, "at"),
                           number_table_column(&table, "target")};
    int failed = 0;
    simulate->event = calloc(table.rows + 1, sizeof *simulate->event);
    if (!table.column_name || column[0] < 0 || column[1] < 0)
        failed = tree_fault(reader->t, node,
                            "%.80s needs a first line with the names at and target of its columns",
                            node_text(reader, node));
    else if (!simulate->event)
        failed = tree_fault(reader->t, node, "out of memory");
    for (size_t row = 0; row < table.rows && !failed; row++) {
        failed = read_scheduled(reader, node, &table, row, column, &simulate->event[row]);
        simulate->events += !failed;
    }
    number_table_free(&table);
    return failed;
}

static const form event_list_form = {.type = FORM_LIST, .item = &event_form};
static const field schedule_fields[] = {
    {"file", read_schedule_file, .required = 1, .form = &label_form,
     .help = "Table with a line for each event: columns at (tick) and target (factor)."},
    {.key = NULL}};
static const form schedule_form = {.type = FORM_MAP, .fields = schedule_fields};
static const form *const events_forms[] = {&event_list_form, &schedule_form, NULL};
static const form events_form = {.type = FORM_ANY, .any = events_forms};

static int read_event(reader *reader, int node, scene_event *event)
{
    event_text text = {0};
    text.event = event;
    event->announced_after = ANNOUNCED_NEVER;
    event->at = node_at(reader, node);
    if (read_map(reader, node, event_fields, &text) != 0 || refine_load(reader, node, &text) != 0)
        return -1;
    return check_event(reader, node, &text);
}

static int read_events(reader *reader, int node, void *to, const void *rule)
{
    scene_simulate *simulate = to;
    int i, k = 0;
    (void)rule;
    if (reader->t->node[node].kind == TREE_MAP)
        return read_map(reader, node, schedule_fields, to);
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

/* ---- the section simulate ---- */

static const range seeds = {0, 1e9, 0, "must be from 0 to 1e9"};
static const choice influence_places[] = {{"undeformed", INFLUENCE_UNDEFORMED},
                                          {"loaded", INFLUENCE_LOADED},
                                          {"target", INFLUENCE_TARGET},
                                          {NULL, 0}};

static const field simulate_fields[] = {
    {"ticks", read_int, offsetof(scene_simulate, ticks), &tick_count, 1, .of = OF_NUMBER,
     .help = "Length of the simulation in ticks."},
    {"seed", read_int, offsetof(scene_simulate, seed), &seeds, .of = OF_NUMBER,
     .help = "Seed of noise and random faults; the same seed gives the same bits; default 1."},
    {"influence", read_choice, offsetof(scene_simulate, influence_at), influence_places,
     .help =
         "State in which the tables of the controller are made: undeformed (default); loaded: "
         "influence matrix and vibration modes about the equilibrium under the loads, whose "
         "prestress changes them; target: influence matrix at the nonlinear optimum. loaded and "
         "target need kinematics: nonlinear."},
    {"plant", read_plant, .of = OF_NUMBER, .form = &plant_form,
     .help = "Structure as it is, which the controller does not know."},
    {"sensors", read_measurement, .form = &measurement_form,
     .help = "Sensors: one for every target node, or the readings of estimate."},
    {"amplifiers", read_amplification, .form = &amplification_form,
     .help = "Amplifiers, which keep voltage and step limits by themselves."},
    {"faults", read_faults, .form = &faults_form,
     .help = "Random faults: sensors, electrodes, missed ticks, jumps of target and loads."},
    {"events", read_events, .form = &events_form,
     .help = "Events in the order of their ticks; all loads act in full from the start unless an "
             "event says otherwise."},
    {.key = NULL}};

const form simulate_form = {.type = FORM_MAP, .fields = simulate_fields};

/*
 * Write an error message if the section of the simulated plant has a given key, which another key
 * of the scene excludes; otherwise do nothing.
 */
static int refuse_beside(reader *reader, int plant, const char *key, const char *cure)
{
    const int node = plant ? tree_find(reader->t, plant, key) : 0;
    return node ? tree_fault(reader->t, node, "'%s' %s", key, cure) : 0;
}

/*
 * Refuse keys of the simulated structure (plant) that have no effect on its motion, such as `modes`
 * if the motion is nonlinear. With `inertia: false`, keys of modal motion are accepted without
 * effect, so that users can switch inertia off by this one word.
 */
static int check_motion_keys(reader *reader, int plant)
{
    static const char still[] = "belongs to a plant with inertia; remove it, or inertia: false";
    static const char modal[] = "belongs to motion: modal; remove it, or write motion: modal";
    static const char nonlinear[] =
        "belongs to motion: nonlinear of a nonlinear plant; remove it, or write kinematics: "
        "nonlinear and motion: nonlinear";
    const scene_simulate *simulate = &reader->s->simulate;
    const bool is_nonlinear = simulate->motion == MOTION_NONLINEAR;
    const bool is_still = simulate->inertia_given && !simulate->inertia;
    if (is_still)
        return is_nonlinear ? refuse_beside(reader, plant, "motion", still) : 0;
    if (is_nonlinear)
        return refuse_beside(reader, plant, "modes", modal);
    return refuse_beside(reader, plant, "steps", nonlinear);
}

/*
 * Choose how the motion of the plant is computed (in vibration modes or nonlinear) where the scene
 * file does not say. Refuse a nonlinear motion of a linear plant, and keys that have no effect on
 * the motion.
 */
static int check_motion(reader *reader, int node)
{
    scene_simulate *simulate = &reader->s->simulate;
    const bool is_linear = simulate->kinematics == KINEMATICS_LINEAR;
    const int plant = tree_find(reader->t, node, "plant");
    if (!simulate->motion_given)
        simulate->motion = is_linear ? MOTION_MODAL : MOTION_NONLINEAR;
    if (!is_linear || simulate->motion == MOTION_MODAL)
        return check_motion_keys(reader, plant);
    return tree_fault(reader->t, plant,
                      "motion: nonlinear needs a nonlinear plant; write kinematics: nonlinear");
}

/*
 * Check the key `influence` of the simulation, the state of the structure in which the influence
 * matrix is computed. Deformed states need a scene with nonlinear kinematics, `loaded` also a
 * nonlinear plant. Returns 0, or -1 after writing an error message about the scene file.
 */
static int check_influence(reader *reader, int node)
{
    const scene *scene = reader->s;
    const int at = tree_find(reader->t, node, "influence");
    const bool is_loaded = scene->simulate.influence_at == INFLUENCE_LOADED;
    if (scene->simulate.influence_at == INFLUENCE_UNDEFORMED)
        return 0;
    if (scene->kinematics == KINEMATICS_LINEAR)
        return tree_fault(reader->t, at,
                          "'influence: %s' needs the nonlinear structure; write "
                          "kinematics: nonlinear",
                          is_loaded ? "loaded" : "target");
    if (is_loaded && scene->simulate.kinematics == KINEMATICS_LINEAR)
        return tree_fault(reader->t, at,
                          "'influence: loaded' needs a nonlinear plant, which has the prestress, "
                          "too; leave kinematics out of plant");
    return 0;
}

int read_simulate(reader *reader, int node, void *to, const void *rule)
{
    static const double default_rate = 1000;
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
            scene->influence.given
                ? "a simulation needs a target; add target: {value: ...}, a formula of the "
                  "coordinates, a list or a file with a number for each output"
                : "a simulation needs a target; add target: {u3: middle, at: nodes, value: ...}");
    if (read_map(reader, node, simulate_fields, &scene->simulate) != 0)
        return -1;
    scene->simulate.given = true;
    if (check_motion(reader, node) != 0)
        return -1;
    return check_influence(reader, node);
}
