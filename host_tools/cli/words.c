/* Words that the report pages and the terminal share (words.h). */
#include "words.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- units ------------------------------------------------------------ */

/* Work over voltage. */
static void charge_unit(const scene *scene, char text[WORDS_UNIT])
{
    const int usual = strcmp(scene->unit_force, "N") == 0 && strcmp(scene->unit_voltage, "V") == 0;
    if (usual && strcmp(scene->unit_length, "m") == 0)
        strcpy(text, "C");
    else if (usual && strcmp(scene->unit_length, "mm") == 0)
        strcpy(text, "mC");
    else if (scene->unit_force[0] && scene->unit_length[0] && scene->unit_voltage[0])
        snprintf(text, WORDS_UNIT, "%.63s %.63s/%.63s", scene->unit_force, scene->unit_length,
                 scene->unit_voltage);
}

const char *words_unit(const scene *scene, words_quantity quantity, char text[WORDS_UNIT])
{
    const char *length = scene->unit_length, *force = scene->unit_force;
    const char *const plain[] = {
        length,  "rad", force, "", "", scene->unit_voltage, "", scene->unit_temperature,
        "nodes", ""};
    snprintf(text, WORDS_UNIT, "%s", plain[quantity]);
    if (quantity == QUANTITY_CHARGE)
        charge_unit(scene, text);
    if ((quantity == QUANTITY_LINE_FORCE || quantity == QUANTITY_PRESSURE) && *length && *force)
        snprintf(text, WORDS_UNIT, "%s/%s%s", force, length,
                 quantity == QUANTITY_PRESSURE ? "2" : "");
    return text;
}

int words_unitless(const scene *scene)
{
    return !scene->unit_length[0] && !scene->unit_force[0] && !scene->unit_voltage[0] &&
           !scene->unit_temperature[0];
}

words_quantity words_of_theta(const scene *scene, int direction)
{
    return surface_is_angle(&scene->surface, direction + 1) ? QUANTITY_ANGLE : QUANTITY_LENGTH;
}

words_quantity words_of_load(const scene_load *load)
{
    static const words_quantity quantity[] = {QUANTITY_FORCE, QUANTITY_LINE_FORCE,
                                              QUANTITY_PRESSURE, QUANTITY_OTHER,
                                              QUANTITY_TEMPERATURE};
    return quantity[load->type];
}

words_quantity words_of_output(const scene_output *output)
{
    if (output->electric != ELECTRIC_NONE)
        return output->electric == ELECTRIC_VOLTAGE ? QUANTITY_VOLTAGE : QUANTITY_CHARGE;
    switch (output->contact) {
    case CONTACT_NONE: return QUANTITY_LENGTH;
    case CONTACT_NODES: return QUANTITY_NODES;
    case CONTACT_PRESSURE: return QUANTITY_PRESSURE;
    default: return QUANTITY_FORCE;
    }
}

/* ---- simulations ------------------------------------------------------ */

const char *words_influence(const scene *scene)
{
    return scene->simulate.at_target ? "at the target" : "at rest";
}

/* A load at a part of what the scene says; its number where there are others. */
static void name_load(const scene *scene, const scene_event *event, char *text, size_t room)
{
    static const char *const word[] = {"point force", "line force", "pressure", "weight",
                                       "temperature load"};
    const scene_load *load = &scene->load[event->load];
    const expr_point anywhere = {0, 0, 0, 0, 0};
    char unit[WORDS_UNIT], amount[2 * WORDS_UNIT] = "off", number[24] = "";
    const char *kind =
        load->type == LOAD_FACE && load->component != COMPONENT_U3 ? "face load" : word[load->type];
    words_unit(scene, words_of_load(load), unit);
    if (event->amount != 0 && expr_is_constant(load->value) && !load->outer &&
        load->type != LOAD_WEIGHT)
        snprintf(amount, sizeof amount, "%g%s%s",
                 event->amount * expr_value(load->value, &anywhere), *unit ? " " : "", unit);
    else if (event->amount != 0)
        snprintf(amount, sizeof amount, "x %g", event->amount);
    if (scene->loads > 1)
        snprintf(number, sizeof number, " (load %d)", event->load);
    snprintf(text, room, "%s%s %s%s", kind, number, amount, event->known ? ", known" : "");
}

static void name_electrodes(const scene *scene, const scene_event *event, const char *word,
                            char *text, size_t room)
{
    char name[SCENE_LABEL] = "";
    if (event->amplifiers > 0)
        scene_amplifier_name(scene, event->amplifier[0], name);
    if (event->amplifiers > 1)
        snprintf(text, room, "%.60s and %d more %s", name, event->amplifiers - 1, word);
    else
        snprintf(text, room, "%.60s %s", name, word);
}

static void name_event(const scene *scene, const scene_event *event, char *text, size_t room)
{
    char unit[WORDS_UNIT];
    switch (event->type) {
    case EVENT_TARGET: snprintf(text, room, "target x %g", event->amount); break;
    case EVENT_VALUE: snprintf(text, room, "another target"); break;
    case EVENT_LOAD: name_load(scene, event, text, room); break;
    case EVENT_TEMPERATURE:
        snprintf(text, room, "temperature %g %s", event->amount,
                 words_unit(scene, QUANTITY_TEMPERATURE, unit));
        break;
    case EVENT_NAN:
    case EVENT_FROZEN:
        snprintf(text, room, "%g%% of the sensors %s, %d ticks", 100 * event->amount,
                 event->type == EVENT_NAN ? "NaN" : "frozen", event->ticks);
        break;
    case EVENT_LOST: snprintf(text, room, "%d ticks lost", event->ticks); break;
    default:
        name_electrodes(scene, event,
                        event->type == EVENT_DEAD    ? "dead"
                        : event->type == EVENT_STUCK ? "stuck"
                                                     : "alive",
                        text, room);
    }
}

void words_phase(const simulation *simulation, const simulate_phase *phase, char text[WORDS_PHASE])
{
    const scene_simulate *simulate = &simulation->nominal->design.scene->simulate;
    const int quiet = simulate->fault_chance > 0 && phase->from == simulate->fault_until;
    size_t n = 0;
    snprintf(text, WORDS_PHASE, "%s",
             phase->from == 0 ? "start"
             : quiet          ? "random faults end"
                              : "");
    for (int k = phase->first; k < phase->first + phase->events && n + 70 < WORDS_PHASE; k++) {
        if (k > phase->first)
            n += (size_t)snprintf(text + n, WORDS_PHASE - n, ", ");
        name_event(simulation->nominal->design.scene, &simulate->event[k], text + n,
                   WORDS_PHASE - n);
        n += strlen(text + n);
    }
}
