/* SPDX-License-Identifier: BSD-2-Clause */
/* Migration of scene files (scene_migrate.h). */
#include "scene_migrate.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "scene.h"
#include "scene_retired.h"

/* Replacement of `length` bytes of a text by another text. */
typedef struct edit {
    size_t from, length;
    char *insert; /* owned */
} edit;

/* A text with its tree and the edits that are collected for it. */
typedef struct migration {
    const char *text;
    size_t bytes;
    tree tree;
    edit *edits;
    int count, room;
} migration;

/* ---- edits ------------------------------------------------------------ */

static int out_of_memory(const migration *m)
{
    const scene_at whole = {0, 0};
    return tree_fault_at(&m->tree, whole, "out of memory");
}

/* Add an edit that inserts the first `insert_length` bytes of a text. */
static int add_edit(migration *m, size_t from, size_t length, const char *insert,
                    size_t insert_length)
{
    char *const copy = malloc(insert_length + 1);
    if (m->count == m->room) {
        const int room = 2 * m->room + 16;
        edit *const edits = realloc(m->edits, (size_t)room * sizeof *edits);
        if (edits) {
            m->edits = edits;
            m->room = room;
        }
    }
    if (!copy || m->count == m->room) {
        free(copy);
        return out_of_memory(m);
    }
    memcpy(copy, insert, insert_length);
    copy[insert_length] = 0;
    const edit added = {from, length, copy};
    m->edits[m->count++] = added;
    return 0;
}

static int compare_edits(const void *a, const void *b)
{
    const edit *const p = a, *const q = b;
    if (p->from != q->from)
        return p->from < q->from ? -1 : 1;
    return (p->length > q->length) - (p->length < q->length);
}

/* Write the text with all edits applied; an edit that repeats the previous one is skipped. */
static void write_edited(const migration *m, char *to, size_t *bytes)
{
    size_t at = 0, n = 0;
    for (int i = 0; i < m->count; i++) {
        const edit *const e = &m->edits[i];
        if (e->from < at) /* the place has been edited through another alias of the same node */
            continue;
        memcpy(to + n, m->text + at, e->from - at);
        n += e->from - at;
        memcpy(to + n, e->insert, strlen(e->insert));
        n += strlen(e->insert);
        at = e->from + e->length;
    }
    memcpy(to + n, m->text + at, m->bytes - at);
    *bytes = n + m->bytes - at;
}

static int apply_edits(migration *m, char **text, size_t *bytes)
{
    size_t room = m->bytes + 1;
    for (int i = 0; i < m->count; i++)
        room += strlen(m->edits[i].insert);
    if (m->count)
        qsort(m->edits, (size_t)m->count, sizeof *m->edits, compare_edits);
    *text = malloc(room);
    if (!*text)
        return out_of_memory(m);
    write_edited(m, *text, bytes);
    (*text)[*bytes] = 0;
    return 0;
}

static int open_migration(migration *m, const char *path, const char *text, size_t bytes,
                          char *error)
{
    memset(m, 0, sizeof *m);
    m->text = text;
    m->bytes = bytes;
    return tree_read_text(&m->tree, path, text, bytes, error);
}

static void close_migration(migration *m)
{
    for (int i = 0; i < m->count; i++)
        free(m->edits[i].insert);
    free(m->edits);
    tree_free(&m->tree);
}

/* ---- places in the text ----------------------------------------------- */

/* Return the byte at which a line starts, behind a byte order mark; lines are counted from 1. */
static size_t line_start(const migration *m, int line)
{
    size_t at = strncmp(m->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    for (; line > 1 && at < m->bytes; at++)
        line -= m->text[at] == '\n';
    return at;
}

/* Return the byte behind the line that contains a byte. */
static size_t line_end(const migration *m, size_t at)
{
    while (at < m->bytes && m->text[at] != '\n')
        at++;
    return at < m->bytes ? at + 1 : at;
}

/* Return the byte of a position, whose column counts characters of UTF-8. */
static size_t byte_of(const migration *m, scene_at place)
{
    size_t at = line_start(m, place.line);
    for (int column = 1; column < place.column && at < m->bytes; column++)
        do
            at++;
        while (at < m->bytes && ((unsigned char)m->text[at] & 0xC0) == 0x80);
    return at;
}

/*
 * Find the first byte of a name at a position of the text, behind a quotation mark if there is one.
 * Returns 0, or -1 with the error filled if the text there is written in another way.
 */
static int locate(const migration *m, scene_at place, const char *name, size_t *at)
{
    *at = byte_of(m, place);
    if (*at < m->bytes && (m->text[*at] == '"' || m->text[*at] == '\''))
        ++*at;
    if (m->bytes - *at >= strlen(name) && memcmp(m->text + *at, name, strlen(name)) == 0)
        return 0;
    return tree_fault_at(&m->tree, place,
                         "'%.60s' is not written plainly here and cannot be replaced; change this "
                         "line by hand",
                         name);
}

static int replace_name(migration *m, scene_at place, const char *old_name, const char *new_name)
{
    size_t at;
    if (locate(m, place, old_name, &at) != 0)
        return -1;
    return add_edit(m, at, strlen(old_name), new_name, strlen(new_name));
}

/* ---- the tick rate: from `simulate` to `control` ---------------------- */

static int refuse_move(const migration *m, int node)
{
    return tree_fault_at(&m->tree, m->tree.node[node].key_at,
                         "'rate' cannot be moved by itself here; write it as control: {rate: ...}");
}

/* Return the byte behind the value of a node, including its quotation mark; 0 on an error. */
static size_t value_end(const migration *m, int node)
{
    const tree_node *const n = &m->tree.node[node];
    size_t at;
    if (n->kind != TREE_SCALAR || locate(m, n->at, n->text, &at) != 0)
        return 0;
    const bool is_quoted = at > byte_of(m, n->at);
    return at + strlen(n->text) + is_quoted;
}

/* Return the byte of a key, including its quotation mark. */
static size_t key_start(const migration *m, int node)
{
    return byte_of(m, m->tree.node[node].key_at);
}

/* Move an item of {ticks: 9, rate: 1000} in front of `simulate`. */
static int move_flow_rate(migration *m, int node, int section)
{
    size_t from = key_start(m, node), end = value_end(m, node);
    const bool is_flow = m->text[byte_of(m, m->tree.node[m->tree.root].at)] == '{';
    char item[200];
    const int length = snprintf(item, sizeof item, "control: {%.*s}%s", (int)(end - from),
                                m->text + from, is_flow ? ", " : "\n");
    if (length >= (int)sizeof item)
        return refuse_move(m, node);
    while (end < m->bytes && m->text[end] == ' ')
        end++;
    if (m->text[end] == ',') {
        end++;
        while (m->text[end] == ' ')
            end++;
    } else {
        while (from > 0 && strchr(" ,", m->text[from - 1]))
            from--;
    }
    return add_edit(m, from, end - from, "", 0) == 0
               ? add_edit(m, key_start(m, section), 0, item, (size_t)length)
               : -1;
}

/* Move a line of its own under a new key `control`, above the comment in front of `simulate`. */
static int move_block_rate(migration *m, int node, int section)
{
    const size_t from = line_start(m, m->tree.node[node].key_at.line), end = line_end(m, from);
    int line = m->tree.node[section].key_at.line;
    char item[400];
    if (strspn(m->text + from, " ") != key_start(m, node) - from ||
        m->tree.node[section].key_at.column != 1)
        return refuse_move(m, node);
    while (line > 1 && m->text[line_start(m, line - 1)] == '#')
        line--;
    const int length = snprintf(item, sizeof item, "control:\n%.*s%s", (int)(end - from),
                                m->text + from, m->text[end - 1] == '\n' ? "" : "\n");
    if (length >= (int)sizeof item)
        return refuse_move(m, node);
    return add_edit(m, from, end - from, "", 0) == 0
               ? add_edit(m, line_start(m, line), 0, item, (size_t)length)
               : -1;
}

static int move_rate(migration *m, int node)
{
    const int section = m->tree.node[node].parent;
    const char first = m->text[byte_of(m, m->tree.node[section].at)];
    if (value_end(m, node) == 0 || tree_find(&m->tree, m->tree.root, "control"))
        return refuse_move(m, node);
    if (first == '{')
        return move_flow_rate(m, node, section);
    return first == '&' || first == '!' ? refuse_move(m, node) : move_block_rate(m, node, section);
}

/* ---- the step limit as a rate limit ----------------------------------- */

/*
 * Write the shortest decimal number whose quotient by the tick rate is exactly the step limit.
 * Returns whether there is one that the reader accepts.
 */
static bool rate_limit_text(double step_limit, double rate, char text[32])
{
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, step_limit * rate);
        if (strtod(text, NULL) / rate == step_limit)
            return strtod(text, NULL) < 1e60;
    }
    return false;
}

static int edit_step_limit(migration *m, const scene *scene)
{
    const int limits = tree_find(&m->tree, m->tree.root, "limits");
    const int node = limits ? tree_find(&m->tree, limits, "step_limit") : 0;
    const int control = tree_find(&m->tree, m->tree.root, "control");
    char text[32];
    if (!node || !control || !tree_find(&m->tree, control, "rate") ||
        !rate_limit_text(scene->limits.step_limit, scene->control.rate, text))
        return 0;
    const size_t end = value_end(m, node), from = byte_of(m, m->tree.node[node].at);
    if (end == 0 || replace_name(m, m->tree.node[node].key_at, "step_limit", "rate_limit") != 0)
        return -1;
    return add_edit(m, from, end - from, text, strlen(text));
}

/* Replace the step limit of a text by a rate limit if the scene gives a tick rate. */
static int use_rate_limit(const char *path, char **text, size_t *bytes, char *error)
{
    scene scene;
    migration m;
    char *edited = NULL;
    if (scene_read_text(&scene, path, *text, *bytes, error) != 0)
        return -1;
    int status = open_migration(&m, path, *text, *bytes, error);
    if (status == 0)
        status = edit_step_limit(&m, &scene);
    if (status == 0)
        status = apply_edits(&m, &edited, bytes);
    close_migration(&m);
    scene_free(&scene);
    if (status != 0)
        return -1;
    free(*text);
    *text = edited;
    return 0;
}

/* ---- the whole -------------------------------------------------------- */

static int edit_node(migration *m, int node, bool *has_slew)
{
    const tree_node *const n = &m->tree.node[node];
    const retired *const key = n->key ? retired_key(&m->tree, node) : NULL;
    const retired *const word = retired_word(&m->tree, node);
    if (word && replace_name(m, n->at, word->old_name, word->new_name) != 0)
        return -1;
    if (!key)
        return 0;
    *has_slew |= key->type == RETIRED_SLEW;
    if (key->type == RETIRED_RATE)
        return move_rate(m, node);
    return replace_name(m, n->key_at, key->old_name, key->new_name);
}

/* Replace all retired names of a text; *text is the new text. */
static int replace_retired(const char *path, char **text, size_t *bytes, bool *has_slew,
                           char *error)
{
    migration m;
    char *edited = NULL;
    int status = open_migration(&m, path, *text, *bytes, error);
    for (int node = 1; status == 0 && node <= m.tree.nodes; node++)
        status = edit_node(&m, node, has_slew);
    if (status == 0)
        status = apply_edits(&m, &edited, bytes);
    close_migration(&m);
    if (status != 0)
        return -1;
    free(*text);
    *text = edited;
    return 0;
}

static int check_scene(const char *path, const char *text, size_t bytes, char *error)
{
    scene scene;
    if (scene_read_text(&scene, path, text, bytes, error) != 0)
        return -1;
    scene_free(&scene);
    return 0;
}

int scene_migrate(const char *path, char **text, size_t *bytes, char *error)
{
    bool has_slew = false;
    int status = tree_load(path, text, bytes, error);
    if (status == 0)
        status = replace_retired(path, text, bytes, &has_slew, error);
    if (status == 0 && has_slew)
        status = use_rate_limit(path, text, bytes, error);
    if (status == 0)
        status = check_scene(path, *text, *bytes, error);
    if (status == 0)
        return 0;
    free(*text);
    *text = NULL;
    return -1;
}
