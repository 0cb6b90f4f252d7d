/* SPDX-License-Identifier: BSD-2-Clause */
/* Texts that describe the phases and events of a simulation (simulate_words.h). */
#include "simulate_words.h"
#include <stdio.h>
#include <string.h>
#include "../text/words.h"

const char *simulate_words_influence(const design *design)
{
    static const char *const name[] = {[INFLUENCE_UNDEFORMED] = "in the undeformed state",
                                       [INFLUENCE_LOADED] = "about the equilibrium under the loads",
                                       [INFLUENCE_TARGET] = "at the nonlinear optimum"};
    return name[design->simulate.influence_at];
}

/* Return the name of the type of a load, for texts that describe events of a simulation. */
static const char *name_of_load(const scene_load *load)
{
#define WORDS_OF(type, words, quantity, forces) [type] = words,
    static const char *const word[LOAD_TYPE_COUNT] = {LOAD_TYPES(WORDS_OF)};
    const bool is_along = load->type == LOAD_FACE && load->component != COMPONENT_U3;
    return is_along ? "face load" : word[load->type];
}

/*
 * Write the value of a load after an event: a number with its unit for a uniform load, otherwise
 * the factor relative to the load of the scene.
 */
static void name_value(const design *design, const scene_event *event, char *text, size_t room)
{
    const scene_load *load = &design->load[event->load];
    const expr_point anywhere = {0, 0, 0, 0, 0};
    const bool is_uniform =
        expr_is_constant(load->value) && !load->outer && load->type != LOAD_WEIGHT;
    char unit[WORDS_UNIT];
    words_unit(&design->units, words_of_load(load), unit);
    if (event->size == 0)
        snprintf(text, room, "off");
    else if (is_uniform)
        snprintf(text, room, "%g%s%s", event->size * expr_value(load->value, &anywhere),
                 *unit ? " " : "", unit);
    else
        snprintf(text, room, "x %g", event->size);
}

/*
 * Write the name and the value of a load after an event, with the number of the load where the
 * scene has several loads.
 */
static void name_load(const design *design, const scene_event *event, char *text, size_t room)
{
    char value[2 * WORDS_UNIT], number[24] = "";
    name_value(design, event, value, sizeof value);
    if (design->loads > 1)
        snprintf(number, sizeof number, " (load %d)", event->load);
    snprintf(text, room, "%s%s %s%s", name_of_load(&design->load[event->load]), number, value,
             event->feed_forward ? ", known" : "");
}

static void name_electrodes(const design *design, const scene_event *event, const char *word,
                            char *text, size_t room)
{
    const char *name = event->amplifiers > 0 ? design->amplifier_name[event->amplifier[0]] : "";
    if (event->amplifiers > 1)
        snprintf(text, room, "%.60s and %d more %s", name, event->amplifiers - 1, word);
    else
        snprintf(text, room, "%.60s %s", name, word);
}

/* Describe in a text an event that applies an impulse of a load or gives it a sinusoidal part. */
static void name_motion(const design *design, const scene_event *event, char *text, size_t room)
{
    const char *name = name_of_load(&design->load[event->load]);
    if (event->type == EVENT_IMPULSE)
        snprintf(text, room, "impulse of the %s during %g s", name, event->size);
    else
        snprintf(text, room, "%s varies by %g at %g Hz, %d ticks", name, event->size,
                 event->frequency, event->ticks);
}

static void name_event(const design *design, const scene_event *event, char *text, size_t room)
{
    char unit[WORDS_UNIT];
    switch (event->type) {
    case EVENT_TARGET: snprintf(text, room, "target x %g", event->size); break;
    case EVENT_VALUE: snprintf(text, room, "another target"); break;
    case EVENT_LOAD: name_load(design, event, text, room); break;
    case EVENT_TEMPERATURE:
        snprintf(text, room, "temperature %g %s", event->size,
                 words_unit(&design->units, QUANTITY_TEMPERATURE, unit));
        break;
    case EVENT_NAN:
    case EVENT_FROZEN:
        snprintf(text, room, "%g%% of the sensors %s, %d ticks", 100 * event->size,
                 event->type == EVENT_NAN ? "NaN" : "frozen", event->ticks);
        break;
    case EVENT_LOST: snprintf(text, room, "%d ticks lost", event->ticks); break;
    case EVENT_IMPULSE:
    case EVENT_SINE: name_motion(design, event, text, room); break;
    case EVENT_LATE:
        snprintf(text, room, "voltages up to %g of a tick late, %d ticks", event->size,
                 event->ticks);
        break;
    case EVENT_JITTER:
        snprintf(text, room, "ticks vary by %g, %d ticks", event->size, event->ticks);
        break;
    case EVENT_DELAY:
        snprintf(text, room, "readings %g ticks later, %d ticks", event->size, event->ticks);
        break;
    case EVENT_DEAD: name_electrodes(design, event, "dead", text, room); break;
    case EVENT_STUCK: name_electrodes(design, event, "stuck", text, room); break;
    default: name_electrodes(design, event, "alive", text, room);
    }
}

void simulate_words_phase(const simulation *simulation, const simulate_phase *phase,
                          char text[SIMULATE_PHASE_TEXT])
{
    const scene_simulate *simulate = &simulation->nominal->design.simulate;
    const bool ends_faults = simulate->fault_chance > 0 && phase->from == simulate->fault_until;
    const char *begin = "";
    size_t used = 0;
    if (phase->from == 0)
        begin = "start";
    else if (ends_faults)
        begin = "random faults end";
    snprintf(text, SIMULATE_PHASE_TEXT, "%s", begin);
    for (int k = phase->first; k < phase->first + phase->events && used + 70 < SIMULATE_PHASE_TEXT;
         k++) {
        if (k > phase->first)
            used += (size_t)snprintf(text + used, SIMULATE_PHASE_TEXT - used, ", ");
        name_event(&simulation->nominal->design, &simulate->event[k], text + used,
                   SIMULATE_PHASE_TEXT - used);
        used += strlen(text + used);
    }
}
