/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Section `hysteresis` of a scene file: hysteresis and creep of the ceramic, which the control loop
 * compensates.
 */
#include "scene_parts.h"

/*
 * Rule for a list of numbers: permitted range of each number, and smallest and largest number of
 * items.
 */
typedef struct list_rule {
    range range;
    int least, most; /* smallest and largest number of items of a list of numbers in the section
                        `hysteresis` */
} list_rule;

/*
 * Read a YAML list of numbers into the array `to` with its count (scene_short_list).
 *   rule  in  permitted range of the numbers, smallest and largest length of the list (list_rule)
 * Returns 0, or -1 after writing an error message about the scene file.
 */
static int read_numbers(reader *reader, int node, void *to, const void *rule)
{
    const list_rule *must = rule;
    scene_short_list *numbers = to;
    if (reader->t->node[node].kind != TREE_LIST)
        return tree_fault(reader->t, node, "write a list of %d to %d numbers here", must->least,
                          must->most);
    numbers->count = 0;
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        if (numbers->count == must->most)
            return tree_fault(reader->t, i, "the list has more than %d numbers", must->most);
        if (read_real(reader, i, &numbers->value[numbers->count], &must->range) != 0)
            return -1;
        numbers->count++;
    }
    if (numbers->count < must->least)
        return tree_fault(reader->t, node, "the list has %d numbers; it needs %d", numbers->count,
                          must->least);
    return 0;
}

static const list_rule four_slopes = {{0.001, 100, 0, "must be from 0.001 to 100"}, 4, 4};
static const list_rule slacks = {{0, 1e9, 1, "must be above 0"}, 1, SCENE_PLAYS};
static const list_rule weights = {{0, 100, 0, "must be from 0 to 100"}, 1, SCENE_PLAYS};
static const list_rule times = {{0, 1e9, 1, "must be above 0"}, 1, SCENE_CREEPS};
static const list_rule gains = {{0, 10, 0, "must be from 0 to 10"}, 1, SCENE_CREEPS};

static const form slope_form = {.type = FORM_NUMBER, .range = &four_slopes.range};
static const form slack_form = {.type = FORM_NUMBER, .range = &slacks.range};
static const form weight_form = {.type = FORM_NUMBER, .range = &weights.range};
static const form time_form = {.type = FORM_NUMBER, .range = &times.range};
static const form gain_form = {.type = FORM_NUMBER, .range = &gains.range};
static const form any_number_form = {.type = FORM_NUMBER};
static const form range_form = {.type = FORM_LIST, .item = &any_number_form, .least = 2, .most = 2};
static const form slopes_form = {.type = FORM_LIST, .item = &slope_form, .least = 4, .most = 4};
static const form slacks_form = {
    .type = FORM_LIST, .item = &slack_form, .least = 1, .most = SCENE_PLAYS};
static const form weights_form = {
    .type = FORM_LIST, .item = &weight_form, .least = 1, .most = SCENE_PLAYS};
static const form times_form = {
    .type = FORM_LIST, .item = &time_form, .least = 1, .most = SCENE_CREEPS};
static const form gains_form = {
    .type = FORM_LIST, .item = &gain_form, .least = 1, .most = SCENE_CREEPS};

static const field hysteresis_fields[] = {
    {"range", read_pair, offsetof(scene_hysteresis, range), NULL, 1, OF_VOLTAGE, &range_form,
     "Lowest and highest voltage of the sweep from which the numbers were identified."},
    {"slopes", read_numbers, offsetof(scene_hysteresis, slope), &four_slopes, 1, OF_NUMBER,
     &slopes_form,
     "Slopes of the part without memory in the four quarters of the range, from the lowest "
     "quarter."},
    {"slack", read_numbers, offsetof(scene_hysteresis, slack), &slacks, 1, OF_VOLTAGE, &slacks_form,
     "Slack of each play: by so much the voltage turns back before the play follows it. Rising."},
    {"above", read_numbers, offsetof(scene_hysteresis, above), &weights, 1, OF_NUMBER,
     &weights_form, "Weight of each play while it is above the middle of the range."},
    {"below", read_numbers, offsetof(scene_hysteresis, below), &weights, 0, OF_NUMBER,
     &weights_form, "Weight of each play while it is below the middle; default as above."},
    {"offset", read_real, offsetof(scene_hysteresis, offset), NULL, 0, OF_VOLTAGE, NULL,
     "Effect at 0 V before any other voltage; default 0. It is not 0 where the ceramic does not "
     "return to its start."},
    {"creep_time", read_numbers, offsetof(scene_hysteresis, creep_time), &times, 0, OF_NUMBER,
     &times_form, "Time constants of the creep (s)."},
    {"creep", read_numbers, offsetof(scene_hysteresis, creep), &gains, 0, OF_NUMBER, &gains_form,
     "Creep of each time constant over the voltage, after a long time."},
    {.key = NULL}};

const form hysteresis_form = {.type = FORM_MAP, .fields = hysteresis_fields};

/*
 * Check relations between numbers of the section `hysteresis`: an ascending voltage range,
 * ascending slacks of the play operators, and lists of equal lengths. Returns 0, or -1 after
 * writing an error message about the scene file.
 */
static int check_hysteresis(reader *reader, int node, const scene_hysteresis *hysteresis)
{
    const int plays = hysteresis->slack.count;
    if (!(hysteresis->range[0] < hysteresis->range[1]))
        return tree_fault(reader->t, node, "'range: [%g, %g]' must rise", hysteresis->range[0],
                          hysteresis->range[1]);
    for (int i = 1; i < plays; i++)
        if (!(hysteresis->slack.value[i] > hysteresis->slack.value[i - 1]))
            return tree_fault(reader->t, node, "'slack' must rise; %g follows %g",
                              hysteresis->slack.value[i], hysteresis->slack.value[i - 1]);
    if (hysteresis->above.count != plays || hysteresis->below.count != plays)
        return tree_fault(reader->t, node,
                          "'slack' has %d plays, 'above' %d and 'below' %d; each needs as many",
                          plays, hysteresis->above.count, hysteresis->below.count);
    if (hysteresis->creep.count != hysteresis->creep_time.count)
        return tree_fault(reader->t, node,
                          "'creep' has %d numbers, 'creep_time' %d; give one for each time",
                          hysteresis->creep.count, hysteresis->creep_time.count);
    return 0;
}

int read_hysteresis_section(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    scene_hysteresis *hysteresis = &scene->hysteresis;
    (void)rule;
    hysteresis->given = true;
    if (read_map(reader, node, hysteresis_fields, hysteresis) != 0)
        return -1;
    if (hysteresis->below.count == 0)
        hysteresis->below = hysteresis->above;
    return check_hysteresis(reader, node, hysteresis);
}
