/* SPDX-License-Identifier: BSD-2-Clause */
/* Section `safety` of a scene file: self-test and supervisor of the control loop. */
#include <math.h>
#include "scene_parts.h"

static const choice arming[] = {{"automatic", 0}, {"command", 1}, {NULL, 0}};
static const form arming_form = {.type = FORM_WORD, .words = arming};
static const range waited = {0, 60000, 0, "must be from 0 to 60000 ticks"};
static const range ramped = {1, 60000, 0, "must be from 1 to 60000 ticks"};
static const form waited_form = {.type = FORM_WHOLE, .range = &waited};
static const form ramped_form = {.type = FORM_WHOLE, .range = &ramped};

static const range tolerated = {0, 10, 1, "must be above 0 and below 10"};
static const form tolerated_form = {.type = FORM_NUMBER, .range = &tolerated};
static const range pulsed = {16, 60000, 0, "must be from 16 to 60000 ticks"};
static const form pulsed_form = {.type = FORM_WHOLE, .range = &pulsed};

static const field selftest_fields[] = {
    {"amplitude", read_real, offsetof(scene_safety, amplitude), &above_zero, 1, OF_VOLTAGE, NULL,
     "Height of the pulse by which each amplifier in turn is moved."},
    {"gain_tolerance", read_real, offsetof(scene_safety, gain_tolerance), &tolerated,
     .of = OF_NUMBER, .form = &tolerated_form,
     .help = "Largest deviation of an amplifier's gain from the mean gain that is no finding, "
             "relative to the mean; default 0.5."},
    {"pulse_ticks", read_int, offsetof(scene_safety, pulse_ticks), &pulsed, .of = OF_NUMBER,
     .form = &pulsed_form,
     .help = "Duration of a pulse in ticks, which step limits may lengthen; default six periods of "
             "the first mode, and 64 where the modes are not known."},
    {.key = NULL}};
static const form selftest_form = {.type = FORM_MAP, .fields = selftest_fields};

static int read_selftest(reader *reader, int node, void *to, const void *rule)
{
    static const double default_gain = 0.5;
    scene_safety *safety = to;
    (void)rule;
    safety->gain_tolerance = default_gain;
    return read_map(reader, node, selftest_fields, safety);
}

static int read_arming(reader *reader, int node, void *to, const void *rule)
{
    scene_safety *safety = to;
    (void)rule;
    return read_either(reader, node, &safety->waits, arming);
}

static int read_park(reader *reader, int node, void *to, const void *rule)
{
    scene_safety *safety = to;
    (void)rule;
    safety->park_is_common = reader->t->node[node].kind != TREE_MAP;
    return read_amplifier_numbers(reader, node, (double)NAN, &safety->park);
}

static const field safety_fields[] = {
    {"park", read_park, .of = OF_VOLTAGE, .form = &amplifier_numbers_form,
     .help = "Park voltage of all amplifiers, or of some actuators or amplifiers by name, inside "
             "the limits of each; default the voltage nearest to 0 that the limits of each allow."},
    {"timeout", read_int, offsetof(scene_safety, timeout), &waited, .of = OF_NUMBER,
     .form = &waited_form,
     .help = "Ticks without usable readings after which control is taken away; 0: never; default "
             "100."},
    {"ramp_ticks", read_int, offsetof(scene_safety, ramp_ticks), &ramped, .of = OF_NUMBER,
     .form = &ramped_form,
     .help = "Shortest ramp to the park voltages in ticks, which step limits may lengthen; default "
             "50."},
    {"arm", read_arming, .form = &arming_form,
     .help =
         "automatic: the loop takes control after the first whole frame of readings (default); "
         "command: it waits for the command of the firmware as well, which a simulation gives."},
    {"selftest", read_selftest, .form = &selftest_form,
     .help = "Test of all amplifiers, cables and sensors before the loop takes control."},
    {.key = NULL}};

static const choice without[] = {{"none", 1}, {NULL, 0}};
static const form without_form = {.type = FORM_WORD, .words = without};
static const form settings_form = {.type = FORM_MAP, .fields = safety_fields};
static const form *const safety_forms[] = {&without_form, &settings_form, NULL};
const form safety_form = {.type = FORM_ANY, .any = safety_forms};

int read_safety(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    if (reader->t->node[node].kind == TREE_SCALAR)
        return read_either(reader, node, &scene->safety.left_out, without);
    scene->safety.given = true;
    scene->safety.at = node_at(reader, node);
    return read_map(reader, node, safety_fields, &scene->safety);
}
