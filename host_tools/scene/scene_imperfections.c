/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Lists of amplifier names and numbers of amplifiers in a scene file, and, of the section
 * `simulate`, the amplifiers whose wires are reversed or swapped.
 */
#include "scene_parts.h"

#include <stdlib.h>

int refuse_amplifier(reader *reader, scene_at at, const char *name)
{
    char first[SCENE_LABEL];
    if (reader->s->amplifiers == 0)
        return tree_fault_at(reader->t, at, "there is no actuator '%.60s'; add actuators first",
                             name);
    const int tied = scene_find_tied(&reader->s->influence, name);
    if (tied >= 0) {
        scene_amplifier_name(reader->s, reader->s->influence.amplifier_of[tied], first);
        return tree_fault_at(reader->t, at, "'%.60s' is tied to others; write the group, '%s'",
                             name, first);
    }
    scene_amplifier_name(reader->s, 0, first);
    return tree_fault_at(reader->t, at, "there is no actuator '%.60s'; the first one is '%s'%s%s",
                         name, first,
                         reader->s->influence.has_numbered_actuators
                             ? "; to name actuators whose file has no names, write the list "
                               "influence.actuators"
                             : "",
                         scene_transposed_hint(reader->s));
}

/*
 * Read a YAML list of names of amplifiers or actuators; the name of an actuator stands for all
 * amplifiers of its grid.
 */
int read_amplifier_names(reader *reader, int node, int **list, int *count)
{
    const scene *scene = reader->s;
    int i, k, items, first, found;
    void *room = new_items(reader, node, TREE_LIST, 1, &items);
    free(room);
    if (!room)
        return -1;
    *list = malloc(((size_t)scene->amplifiers + 1) * sizeof **list);
    if (!*list)
        return tree_fault(reader->t, node, "out of memory");
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        if (require_kind(reader, i, TREE_SCALAR) != 0)
            return -1;
        if (!scene_find_amplifier(scene, node_text(reader, i), &first, &found))
            return refuse_amplifier(reader, node_at(reader, i), node_text(reader, i));
        if (*count + found > scene->amplifiers)
            return tree_fault(reader->t, i,
                              "'%.60s' makes more electrodes than there are; name each once",
                              node_text(reader, i));
        for (k = 0; k < found; k++)
            (*list)[(*count)++] = first + k;
    }
    return 0;
}

static const form named_numbers_form = {.type = FORM_NAMED, .item = &number_form};
static const form *const amplifier_numbers_forms[] = {&number_form, &named_numbers_form, NULL};
const form amplifier_numbers_form = {.type = FORM_ANY, .any = amplifier_numbers_forms};

/*
 * Read the number of the amplifiers that an item of a mapping names. Returns 0, or -1 after writing
 * an error message about the scene file.
 */
static int read_named_number(reader *reader, int item, double *value)
{
    const tree *tree = reader->t;
    int first, count;
    double number;
    if (!scene_find_amplifier(reader->s, tree->node[item].key, &first, &count))
        return refuse_amplifier(reader, tree->node[item].key_at, tree->node[item].key);
    if (read_real(reader, item, &number, NULL) != 0)
        return -1;
    for (int k = first; k < first + count; k++)
        value[k] = number;
    return 0;
}

int read_amplifier_numbers(reader *reader, int node, double absent, double **value)
{
    const bool is_map = reader->t->node[node].kind == TREE_MAP;
    double all = absent;
    *value = malloc(((size_t)reader->s->amplifiers + 1) * sizeof **value);
    if (!*value)
        return tree_fault(reader->t, node, "out of memory");
    if (!is_map && read_real(reader, node, &all, NULL) != 0)
        return -1;
    for (int k = 0; k < reader->s->amplifiers; k++)
        (*value)[k] = all;
    for (int i = is_map ? reader->t->node[node].first : 0; i; i = reader->t->node[i].next)
        if (read_named_number(reader, i, *value) != 0)
            return -1;
    return 0;
}

/*
 * Refuse a list that names an amplifier twice.
 *   list in  [count] numbers of amplifiers
 */
static int refuse_repeated(reader *reader, int node, const int *list, int count)
{
    char name[SCENE_LABEL];
    for (int i = 1; i < count; i++)
        for (int k = 0; k < i; k++) {
            if (list[i] != list[k])
                continue;
            scene_amplifier_name(reader->s, list[i], name);
            return tree_fault(reader->t, node, "'%s' is named twice; name each amplifier once",
                              name);
        }
    return 0;
}

int read_reversed(reader *reader, int node, void *to, const void *rule)
{
    scene_imperfections *imperfections = &((scene_simulate *)to)->imperfections;
    (void)rule;
    if (read_amplifier_names(reader, node, &imperfections->reversed, &imperfections->reversals) !=
        0)
        return -1;
    return refuse_repeated(reader, node, imperfections->reversed, imperfections->reversals);
}

int read_swapped(reader *reader, int node, void *to, const void *rule)
{
    scene_imperfections *imperfections = &((scene_simulate *)to)->imperfections;
    (void)rule;
    if (read_amplifier_names(reader, node, &imperfections->swapped, &imperfections->swaps) != 0)
        return -1;
    if (imperfections->swaps % 2 == 0)
        return refuse_repeated(reader, node, imperfections->swapped, imperfections->swaps);
    return tree_fault(reader->t, node, "%d amplifiers are not pairs; name both ends of each swap",
                      imperfections->swaps);
}
