/* SPDX-License-Identifier: BSD-2-Clause */
/* Table of the retired keys and words of the scene language (scene_retired.h). */
#include "scene_retired.h"

#include <stdbool.h>
#include <string.h>

static const retired rows[] = {
    {RETIRED_KEY, "unknowns", "unknowns", "dof_per_node", ""},
    {RETIRED_KEY, "equilibrium.steps", "steps", "load_steps", ""},
    {RETIRED_KEY, "equilibrium.change", "change", "tolerance", ""},
    {RETIRED_KEY, "equilibrium.mixed", "mixed", "extrapolated_iterations", ""},
    {RETIRED_KEY, "equilibrium.systems", "systems", "linear_solves", ""},
    {RETIRED_SLEW, "limits.slew", "slew", "step_limit",
     " in volts a tick, or 'rate_limit' in volts per second"},
    {RETIRED_KEY, "limits.effort", "effort", "regularisation", ""},
    {RETIRED_KEY, "estimate.volts", "volts", "voltages", ""},
    {RETIRED_RATE, "simulate.rate", "rate", "control: {rate: ...}", ""},
    {RETIRED_KEY, "simulate.events.nan", "nan", "missing_sensors", ""},
    {RETIRED_KEY, "simulate.events.frozen", "frozen", "stuck_sensors", ""},
    {RETIRED_KEY, "simulate.events.lost", "lost", "missed_ticks", ""},
    {RETIRED_KEY, "simulate.events.amount", "amount", "factor", ""},
    {RETIRED_KEY, "simulate.events.told", "told", "announced", ""},
    {RETIRED_KEY, "simulate.events.known", "known", "feed_forward", ""},
    {RETIRED_WORD, "element", "corrected", "improved", ""},
    {RETIRED_WORD, "element", "source", "published", ""},
    {RETIRED_WORD, "element.preset", "corrected", "improved", ""},
    {RETIRED_WORD, "element.preset", "source", "published", ""},
    {RETIRED_WORD, "simulate.influence", "rest", "undeformed", ""},
    {RETIRED_WORD, "simulate.events.told", "found", "detected", ""},
    {RETIRED_WORD, "simulate.events.announced", "found", "detected", ""},
};
enum { ROWS = sizeof rows / sizeof *rows };

/*
 * Return the start of the last key in a path of keys joined by '.'; `length` is the length of the
 * path, and *key_length becomes the length of the key.
 */
static const char *last_key(const char *path, size_t length, size_t *key_length)
{
    size_t start = length;
    while (start > 0 && path[start - 1] != '.')
        start--;
    *key_length = length - start;
    return path + start;
}

/*
 * Return whether the keys from the root of the YAML tree to a node are those that a list of keys
 * names, in the same order.
 */
static bool is_at(const tree *tree, int node, const char *path)
{
    size_t length = strlen(path), key_length;
    for (; node; node = tree->node[node].parent) {
        const char *const key = tree->node[node].key;
        if (!key)
            continue;
        const char *const last = last_key(path, length, &key_length);
        if (strlen(key) != key_length || strncmp(key, last, key_length) != 0)
            return false;
        length = last == path ? 0 : length - key_length - 1;
        if (length == 0)
            return tree->node[node].parent == tree->root;
    }
    return false;
}

const retired *retired_key(const tree *tree, int node)
{
    for (int i = 0; i < ROWS; i++)
        if (rows[i].type != RETIRED_WORD && is_at(tree, node, rows[i].path))
            return &rows[i];
    return NULL;
}

const retired *retired_word(const tree *tree, int node)
{
    const char *const text = tree->node[node].text;
    for (int i = 0; text && i < ROWS; i++)
        if (rows[i].type == RETIRED_WORD && strcmp(text, rows[i].old_name) == 0 &&
            is_at(tree, node, rows[i].path))
            return &rows[i];
    return NULL;
}
