/* SPDX-License-Identifier: BSD-2-Clause */
/* Texts that describe the phases and events of a simulation (simulate_words.h). */
#include "simulate_words.h"
#include <stdio.h>
#include <string.h>
#include "imperfections_scene.h"
#include "plant_motion.h"
#include "../text/append.h"
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
 * Write the value to which an event of the simulation sets a load: a number with its unit for a
 * uniform load, otherwise the factor relative to the load of the scene.
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
 * Write the name of a load and the value to which an event of the simulation sets it, with the
 * number of the load where the scene has several loads.
 */
static void name_load(const design *design, const scene_event *event, char *text, size_t room)
{
    char value[2 * WORDS_UNIT], number[24] = "";
    name_value(design, event, value, sizeof value);
    if (design->loads > 1)
        snprintf(number, sizeof number, " (load %d)", event->load);
    snprintf(text, room, "%s%s %s%s", name_of_load(&design->load[event->load]), number, value,
             event->feed_forward ? ", fed forward" : "");
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
    case EVENT_MISSING_SENSORS:
    case EVENT_STUCK_SENSORS:
        snprintf(text, room, "%g%% of the sensors %s, %d ticks", 100 * event->size,
                 event->type == EVENT_MISSING_SENSORS ? "missing" : "stuck", event->ticks);
        break;
    case EVENT_WRONG_SENSORS:
        snprintf(text, room, "a sensor and %g%% of them wrong by %g, %d ticks", 100 * event->size,
                 event->error, event->ticks);
        break;
    case EVENT_MISSED_TICKS: snprintf(text, room, "%d ticks missed", event->ticks); break;
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

/*
 * Append the time steps of a nonlinear motion: their number in a tick, and the mean numbers of
 * linear solves and of factorisations of the effective stiffness matrix in a time step.
 */
static void append_steps(const plant *plant, char text[SIMULATE_TEXT])
{
    const shell_motion *motion = &plant->shell_motion;
    const double steps = motion->steps > 0 ? (double)motion->steps : 1;
    text_append(
        text, SIMULATE_TEXT,
        "\n  nonlinear motion of %d free dof at large rotation: %.3g time steps a tick; %.2f linear"
        " solves with %.2f factorisations a step\n  damping ratios of %zu modes as stated, of "
        "faster motions %.3g s times half their angular frequency",
        plant->analysis.design.mesh.free_dof,
        1 / (motion->step_most * plant->analysis.design.control.rate),
        (double)motion->linear_solves / steps, (double)motion->factorisations / steps,
        motion->modes, motion->viscosity);
}

void simulate_words_inertia(const plant *plant, char text[SIMULATE_TEXT])
{
    const double two_pi = 6.283185307179586;
    const double *frequency = plant->modal.frequency;
    if (plant->has_inertia)
        snprintf(text, SIMULATE_TEXT,
                 "plant with inertia: %zu modes from %.4g to %.4g Hz, damping ratio of the first "
                 "%.3g",
                 plant->modal.modes, frequency[0] / two_pi,
                 frequency[plant->modal.modes - 1] / two_pi, plant->modal.damping[0]);
    else
        snprintf(text, SIMULATE_TEXT,
                 "quasi-static plant, no inertia (%s): each shape is an equilibrium",
                 plant->reason);
    if (plant->shell_motion.step_most > 0)
        append_steps(plant, text);
}

/* Append the sentence on the sensors of the controller, their noise and delay. */
static void append_sensors(const simulation *simulation, char text[SIMULATE_TEXT])
{
    const design *design = &simulation->nominal->design;
    const char *unit = design->units.length;
    if (simulation->estimates)
        text_append(text, SIMULATE_TEXT, "%d, with the noise of their readings",
                    simulation->estimator.sensors);
    else
        text_append(text, SIMULATE_TEXT, "%d, noise %g%s%s", design->targets,
                    design->simulate.noise, *unit ? " " : "", unit);
    text_append(text, SIMULATE_TEXT, ", delay %d ticks", design->simulate.delay);
}

void simulate_words_plant(const simulation *simulation, char text[SIMULATE_TEXT])
{
    const design *design = &simulation->nominal->design;
    const scene_simulate *simulate = &design->simulate;
    const char *unit = design_inputs_of(design).unit, *space = *unit ? " " : "";
    char imperfections[400];
    imperfections_text(design, imperfections, sizeof imperfections);
    snprintf(text, SIMULATE_TEXT, "plant: %s",
             simulation->plant.analysis.is_nonlinear ? "nonlinear" : "linear");
    for (int i = 0; i < design->materials; i++) {
        const double stiffness = simulate->stiffness ? simulate->stiffness[i] : 1;
        const double piezo = simulate->d ? simulate->d[i] : 1;
        text_append(text, SIMULATE_TEXT, "%s %s stiffness x %g, d x %g", i ? ";" : ",",
                    design->material[i].name, stiffness, piezo);
    }
    text_append(text, SIMULATE_TEXT,
                "\n  imperfections: %s\n  sensors: ", *imperfections ? imperfections : "none");
    append_sensors(simulation, text);
    text_append(text, SIMULATE_TEXT,
                "; amplifiers: steps of %g%s%s, dead band %g%s%s\n  controller: tables of the "
                "scene, influence %s; %d ticks at %g a second",
                simulate->step, space, unit, simulate->dead_band, space, unit,
                simulate_words_influence(design), simulate->ticks, design->control.rate);
}

void simulate_words_columns(const simulation *simulation, char text[SIMULATE_TEXT])
{
    snprintf(
        text, SIMULATE_TEXT,
        "vibration: root mean square distance from the static equilibrium, in the last ticks;\n"
        "  optimum: best shape within the stroke that voltage limits and hysteresis leave to "
        "the electrodes;\n"
        "  errors of the shape over %s; settled: ticks until within 5%% of the way; step "
        "limit: ticks the step limit alone needs;\n"
        "  clipped: least squares without limits, cut to limits and step limit; regularised: "
        "the same with the\n"
        "  one parameter that is best for the scene's target on the controller's model, "
        "chosen knowing\n"
        "  the answer",
        simulation->has_target ? "the scene's target"
                               : "the shape without voltages, because the target is zero");
}
