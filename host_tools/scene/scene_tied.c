/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Key `tied` of the section `influence` of a scene: groups of actuators of a measured influence
 * matrix that one amplifier drives with the same voltage.
 */
#include "scene_fields.h"
#include "scene_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const form names_form = {.type = FORM_LIST, .item = &label_form, .least = 1};
const form tied_form = {.type = FORM_NAMED, .item = &names_form};

/*
 * Mark one actuator as a member of a group.
 *   node          in                   YAML node of the actuator's name
 *   group         in                   YAML node of the group
 *   group_of      [actuators] in/out   YAML node of the group of each actuator; 0: none
 * Returns 0, or -1 after writing an error message about the scene file.
 */
static int add_member(reader *reader, int node, int group, int *group_of)
{
    const tree *tree = reader->t;
    if (require_kind(reader, node, TREE_SCALAR) != 0)
        return -1;
    const char *name = node_text(reader, node);
    const int actuator =
        find_named(reader->s->actuator, reader->s->actuators, sizeof *reader->s->actuator, name);
    if (actuator < 0)
        return refuse_amplifier(reader, node_at(reader, node), name);
    if (group_of[actuator] == group)
        return tree_fault(reader->t, node, "'%.60s' is named twice in '%.60s'; name it once", name,
                          tree->node[group].key);
    if (group_of[actuator])
        return tree_fault(reader->t, node,
                          "'%.60s' is in the groups '%.60s' and '%.60s'; an actuator has one "
                          "amplifier: remove it from one of them",
                          name, tree->node[group_of[actuator]].key, tree->node[group].key);
    group_of[actuator] = group;
    return 0;
}

static int read_group(reader *reader, int group, int *group_of)
{
    if (require_kind(reader, group, TREE_LIST) != 0)
        return -1;
    if (reader->t->node[group].count == 0)
        return tree_fault(reader->t, group,
                          "the group '%.60s' is empty; name the actuators that its amplifier "
                          "drives, or remove it",
                          reader->t->node[group].key);
    for (int i = reader->t->node[group].first; i; i = reader->t->node[i].next)
        if (add_member(reader, i, group, group_of) != 0)
            return -1;
    return 0;
}

/*
 * Refuse a group with the name of an actuator outside the group. Returns 0, or -1 after writing an
 * error message about the scene file.
 */
static int check_group_name(reader *reader, int group, const int *group_of)
{
    char name[SCENE_NAME];
    const tree_node *node = &reader->t->node[group];
    const int actuator = find_named(reader->s->actuator, reader->s->actuators,
                                    sizeof *reader->s->actuator, node->key);
    if (check_name(reader, node->key, node->key_at, name) != 0)
        return -1;
    if (actuator < 0 || group_of[actuator] == group)
        return 0;
    return tree_fault_at(reader->t, node->key_at,
                         "'%.60s' is also the name of an actuator outside the group; rename the "
                         "group",
                         node->key);
}

/*
 * Return the number of the amplifier that drives an earlier actuator of the same group, or -1 if
 * the actuator is the first of its group or has no group.
 */
static int amplifier_before(const int *group_of, const int *amplifier_of, int actuator)
{
    for (int k = 0; k < actuator && group_of[actuator]; k++)
        if (group_of[k] == group_of[actuator])
            return amplifier_of[k];
    return -1;
}

/*
 * Replace the actuators of each group by one actuator with the name of the group, at the place of
 * the first of them. The names that the actuators have in the file of the influence matrix are kept
 * in influence.tied_name.
 */
static void join(reader *reader, const int *group_of)
{
    scene *scene = reader->s;
    scene_influence *influence = &scene->influence;
    int amplifiers = 0;
    for (int k = 0; k < influence->tied; k++) {
        memcpy(influence->tied_name[k], scene->actuator[k].name, sizeof *influence->tied_name);
        influence->amplifier_of[k] = amplifier_before(group_of, influence->amplifier_of, k);
        if (influence->amplifier_of[k] >= 0)
            continue;
        scene_actuator *actuator = &scene->actuator[amplifiers];
        *actuator = scene->actuator[k];
        actuator->first = influence->amplifier_of[k] = amplifiers++;
        if (group_of[k])
            (void)check_name(reader, reader->t->node[group_of[k]].key,
                             reader->t->node[group_of[k]].key_at, actuator->name);
    }
    memset(scene->actuator + amplifiers, 0,
           (size_t)(influence->tied - amplifiers) * sizeof *scene->actuator);
    scene->actuators = scene->amplifiers = amplifiers;
}

int scene_tie(reader *reader, int node)
{
    scene_influence *influence = &reader->s->influence;
    const size_t count = (size_t)reader->s->actuators;
    int failed = 0, *group_of = calloc(count + 1, sizeof *group_of);
    influence->amplifier_of = calloc(count + 1, sizeof *influence->amplifier_of);
    influence->tied_name = calloc(count + 1, sizeof *influence->tied_name);
    if (!group_of || !influence->amplifier_of || !influence->tied_name)
        failed = tree_fault(reader->t, node, "out of memory");
    if (!failed)
        failed = require_kind(reader, node, TREE_MAP);
    const int first = failed ? 0 : reader->t->node[node].first;
    for (int i = first; i && !failed; i = reader->t->node[i].next)
        failed = read_group(reader, i, group_of);
    for (int i = first; i && !failed; i = reader->t->node[i].next)
        failed = check_group_name(reader, i, group_of);
    if (!failed) {
        influence->tied = (int)count;
        join(reader, group_of);
    }
    free(group_of);
    return failed;
}

int scene_tied_amplifier(const scene_influence *influence, int actuator)
{
    return influence->tied > 0 ? influence->amplifier_of[actuator] : actuator;
}

int scene_tied_count(const scene_influence *influence, int amplifier)
{
    int count = 0;
    for (int k = 0; k < influence->tied; k++)
        count += influence->amplifier_of[k] == amplifier;
    return count;
}

int scene_find_tied(const scene_influence *influence, const char *name)
{
    for (int k = 0; k < influence->tied; k++)
        if (strcmp(influence->tied_name[k], name) == 0)
            return k;
    return -1;
}

void scene_tied_sum(const scene_influence *influence, double *value)
{
    int amplifiers = 0;
    for (int k = 0; k < influence->tied; k++) {
        const int amplifier = influence->amplifier_of[k];
        if (amplifier < amplifiers)
            value[amplifier] += value[k];
        else
            value[amplifiers++] = value[k];
    }
}

/*
 * Replace the voltage limits of an amplifier by the narrowest of the entries of limits.each that
 * apply to it. If the amplifier drives several actuators together, an entry may name only one of
 * them. Such an entry applies only if it names the actuator `tied` (index in the file of the
 * influence matrix; -1: no actuator). If no entry applies, the limits remain unchanged.
 */
static void take_entries(const scene_limits *limits, int amplifier, int tied, double *lower,
                         double *upper)
{
    bool has_entry = false;
    for (int i = 0; i < limits->each_count; i++) {
        const scene_limit *each = &limits->each[i];
        const bool is_meant = amplifier >= each->first && amplifier < each->first + each->count;
        if (!is_meant || !each->has_voltage || (each->is_tied && each->tied != tied))
            continue;
        *lower = has_entry ? fmax(*lower, each->lower) : each->lower;
        *upper = has_entry ? fmin(*upper, each->upper) : each->upper;
        has_entry = true;
    }
}

void scene_own_limits(const scene *scene, int amplifier, double *lower, double *upper)
{
    const scene_influence *influence = &scene->influence;
    const double common_lower = *lower, common_upper = *upper;
    if (influence->tied == 0) {
        take_entries(&scene->limits, amplifier, -1, lower, upper);
        return;
    }
    *lower = -HUGE_VAL;
    *upper = HUGE_VAL;
    for (int k = 0; k < influence->tied; k++) {
        double low = common_lower, high = common_upper;
        if (influence->amplifier_of[k] != amplifier)
            continue;
        take_entries(&scene->limits, amplifier, k, &low, &high);
        *lower = fmax(*lower, low);
        *upper = fmin(*upper, high);
    }
}
