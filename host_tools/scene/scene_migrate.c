/* SPDX-License-Identifier: BSD-2-Clause */
/* Migration of scene files to the present scene language (scene_migrate.h). */
#include "scene_migrate.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "scene.h"
#include "scene_retired.h"

/*
 * Edit of the text of a scene file: `length` bytes from the byte `from` on are replaced by another
 * text.
 */
typedef struct edit {
    size_t from, length;
    char *insert; /* text that replaces a part of the scene file, allocated by this program;
                     released with the list of replacements */
} edit;

/* Text of a scene file with its YAML tree and the edits that are collected for it. */
typedef struct migration {
    const char *text;
    size_t bytes;
    tree tree;
    edit *edits;
    int count, room;
} migration;

/* ---- edits ------------------------------------------------------------ */

static int out_of_memory(const migration *migration)
{
    const scene_at whole = {.line = 0};
    return tree_fault_at(&migration->tree, whole, "out of memory");
}

/*
 * Add a replacement to the migration of a scene file: `length` bytes of the file become the first
 * `insert_length` bytes of a text. Returns 0, or -1 when memory runs out.
 */
static int add_edit(migration *migration, size_t from, size_t length, const char *insert,
                    size_t insert_length)
{
    char *const copy = malloc(insert_length + 1);
    if (migration->count == migration->room) {
        const int room = 2 * migration->room + 16;
        edit *const edits = realloc(migration->edits, (size_t)room * sizeof *edits);
        if (edits) {
            migration->edits = edits;
            migration->room = room;
        }
    }
    if (!copy || migration->count == migration->room) {
        free(copy);
        return out_of_memory(migration);
    }
    memcpy(copy, insert, insert_length);
    copy[insert_length] = 0;
    const edit added = {from, length, copy};
    migration->edits[migration->count++] = added;
    return 0;
}

static int compare_edits(const void *left, const void *right)
{
    const edit *const first = left, *const second = right;
    if (first->from != second->from)
        return first->from < second->from ? -1 : 1;
    return (first->length > second->length) - (first->length < second->length);
}

/*
 * Write the text of the scene file with all edits applied to the memory at `to`; an edit that
 * repeats the one before it is skipped.
 */
static void write_edited(const migration *migration, char *to, size_t *bytes)
{
    size_t at = 0, length = 0;
    for (int i = 0; i < migration->count; i++) {
        const edit *const edit = &migration->edits[i];
        if (edit->from < at) /* a YAML node is reached once for each alias (*name) that stands for
                                it; the repeated edits of its text are left out */
            continue;
        memcpy(to + length, migration->text + at, edit->from - at);
        length += edit->from - at;
        memcpy(to + length, edit->insert, strlen(edit->insert));
        length += strlen(edit->insert);
        at = edit->from + edit->length;
    }
    memcpy(to + length, migration->text + at, migration->bytes - at);
    *bytes = length + migration->bytes - at;
}

static int apply_edits(migration *migration, char **text, size_t *bytes)
{
    size_t room = migration->bytes + 1;
    for (int i = 0; i < migration->count; i++)
        room += strlen(migration->edits[i].insert);
    if (migration->count)
        qsort(migration->edits, (size_t)migration->count, sizeof *migration->edits, compare_edits);
    *text = malloc(room);
    if (!*text)
        return out_of_memory(migration);
    write_edited(migration, *text, bytes);
    (*text)[*bytes] = 0;
    return 0;
}

static int open_migration(migration *migration, const char *path, const char *text, size_t bytes,
                          char *error)
{
    memset(migration, 0, sizeof *migration);
    migration->text = text;
    migration->bytes = bytes;
    return tree_read_text(&migration->tree, path, text, bytes, error);
}

static void close_migration(migration *migration)
{
    for (int i = 0; i < migration->count; i++)
        free(migration->edits[i].insert);
    free(migration->edits);
    tree_free(&migration->tree);
}

/* ---- places in the text ----------------------------------------------- */

/*
 * Return the offset of the byte at which a line starts, from the start of the text of the scene
 * file. A byte order mark is counted in the offset, but does not belong to line 1, the first line.
 */
static size_t line_start(const migration *migration, int line)
{
    size_t at = strncmp(migration->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    for (; line > 1 && at < migration->bytes; at++)
        line -= migration->text[at] == '\n';
    return at;
}

/*
 * Return the offset, in the text of the scene file, of the byte after the line that contains a
 * given byte.
 */
static size_t line_end(const migration *migration, size_t at)
{
    while (at < migration->bytes && migration->text[at] != '\n')
        at++;
    return at < migration->bytes ? at + 1 : at;
}

/*
 * Return the offset of the byte at a line and column in the text of the scene file; columns count
 * characters of UTF-8.
 */
static size_t byte_of(const migration *migration, scene_at place)
{
    size_t at = line_start(migration, place.line);
    for (int column = 1; column < place.column && at < migration->bytes; column++)
        do
            at++;
        while (at < migration->bytes && ((unsigned char)migration->text[at] & 0xC0) == 0x80);
    return at;
}

/*
 * Find the first byte of a name at a position in the text of the scene file, after a quotation mark
 * if there is one. Returns 0, or -1 with the error filled if the name is written with escapes or in
 * several lines.
 */
static int locate(const migration *migration, scene_at place, const char *name, size_t *at)
{
    *at = byte_of(migration, place);
    if (*at < migration->bytes && (migration->text[*at] == '"' || migration->text[*at] == '\''))
        ++*at;
    if (migration->bytes - *at >= strlen(name) &&
        memcmp(migration->text + *at, name, strlen(name)) == 0)
        return 0;
    return tree_fault_at(&migration->tree, place,
                         "'%.60s' is not written plainly here and cannot be replaced; change this "
                         "line by hand",
                         name);
}

static int replace_name(migration *migration, scene_at place, const char *old_name,
                        const char *new_name)
{
    size_t at;
    if (locate(migration, place, old_name, &at) != 0)
        return -1;
    return add_edit(migration, at, strlen(old_name), new_name, strlen(new_name));
}

/* ---- the tick rate: from `simulate` to `control` ---------------------- */

static int refuse_move(const migration *migration, int node)
{
    return tree_fault_at(&migration->tree, migration->tree.node[node].key_at,
                         "'rate' cannot be moved by itself here; write it as control: {rate: ...}");
}

/*
 * Return the offset of the byte after the value of a YAML node, its quotation mark included, or 0
 * after an error.
 */
static size_t value_end(const migration *migration, int node)
{
    const tree_node *const value = &migration->tree.node[node];
    size_t at;
    if (value->kind != TREE_SCALAR || locate(migration, value->at, value->text, &at) != 0)
        return 0;
    const bool is_quoted = at > byte_of(migration, value->at);
    return at + strlen(value->text) + is_quoted;
}

/*
 * Return the offset of the first byte of a YAML key in the text of the scene file, its quotation
 * mark included.
 */
static size_t key_start(const migration *migration, int node)
{
    return byte_of(migration, migration->tree.node[node].key_at);
}

/*
 * Move the item `rate` of a section in flow style, simulate: {ticks: 9, rate: 1000}, to a new
 * section `control` before `simulate`.
 */
static int move_flow_rate(migration *migration, int node, int section)
{
    size_t from = key_start(migration, node), end = value_end(migration, node);
    const bool is_flow =
        migration->text[byte_of(migration, migration->tree.node[migration->tree.root].at)] == '{';
    char item[200];
    const int length = snprintf(item, sizeof item, "control: {%.*s}%s", (int)(end - from),
                                migration->text + from, is_flow ? ", " : "\n");
    if (length >= (int)sizeof item)
        return refuse_move(migration, node);
    while (end < migration->bytes && migration->text[end] == ' ')
        end++;
    if (migration->text[end] == ',') {
        end++;
        while (migration->text[end] == ' ')
            end++;
    } else {
        while (from > 0 && strchr(" ,", migration->text[from - 1]))
            from--;
    }
    return add_edit(migration, from, end - from, "", 0) == 0
               ? add_edit(migration, key_start(migration, section), 0, item, (size_t)length)
               : -1;
}

/*
 * Move the line of the key `rate` in the section `simulate` of a scene file to a new section
 * `control` above it, before the comment that belongs to `simulate`.
 */
static int move_block_rate(migration *migration, int node, int section)
{
    const size_t from = line_start(migration, migration->tree.node[node].key_at.line),
                 end = line_end(migration, from);
    int line = migration->tree.node[section].key_at.line;
    char item[400];
    if (strspn(migration->text + from, " ") != key_start(migration, node) - from ||
        migration->tree.node[section].key_at.column != 1)
        return refuse_move(migration, node);
    while (line > 1 && migration->text[line_start(migration, line - 1)] == '#')
        line--;
    const int length =
        snprintf(item, sizeof item, "control:\n%.*s%s", (int)(end - from), migration->text + from,
                 migration->text[end - 1] == '\n' ? "" : "\n");
    if (length >= (int)sizeof item)
        return refuse_move(migration, node);
    return add_edit(migration, from, end - from, "", 0) == 0
               ? add_edit(migration, line_start(migration, line), 0, item, (size_t)length)
               : -1;
}

static int move_rate(migration *migration, int node)
{
    const int section = migration->tree.node[node].parent;
    const char first = migration->text[byte_of(migration, migration->tree.node[section].at)];
    if (value_end(migration, node) == 0 ||
        tree_find(&migration->tree, migration->tree.root, "control"))
        return refuse_move(migration, node);
    if (first == '{')
        return move_flow_rate(migration, node, section);
    return first == '&' || first == '!' ? refuse_move(migration, node)
                                        : move_block_rate(migration, node, section);
}

/* ---- the step limit as a rate limit ----------------------------------- */

/*
 * Write the shortest decimal number for a rate limit (V/s) that, divided by the tick rate, is
 * exactly the step limit (V per tick). Returns whether such a number exists and the scene reader
 * accepts it.
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

static int edit_step_limit(migration *migration, const scene *scene)
{
    const int limits = tree_find(&migration->tree, migration->tree.root, "limits");
    const int node = limits ? tree_find(&migration->tree, limits, "step_limit") : 0;
    const int control = tree_find(&migration->tree, migration->tree.root, "control");
    char text[32];
    if (!node || !control || !tree_find(&migration->tree, control, "rate") ||
        !rate_limit_text(scene->limits.step_limit, scene->control.rate, text))
        return 0;
    const size_t end = value_end(migration, node),
                 from = byte_of(migration, migration->tree.node[node].at);
    if (end == 0 ||
        replace_name(migration, migration->tree.node[node].key_at, "step_limit", "rate_limit") != 0)
        return -1;
    return add_edit(migration, from, end - from, text, strlen(text));
}

/* Replace the step limit of a scene by a rate limit if the scene file gives a tick rate. */
static int use_rate_limit(const char *path, char **text, size_t *bytes, char *error)
{
    scene scene;
    migration migration;
    char *edited = NULL;
    if (scene_read_text(&scene, path, *text, *bytes, error) != 0)
        return -1;
    int status = open_migration(&migration, path, *text, *bytes, error);
    if (status == 0)
        status = edit_step_limit(&migration, &scene);
    if (status == 0)
        status = apply_edits(&migration, &edited, bytes);
    close_migration(&migration);
    scene_free(&scene);
    if (status != 0)
        return -1;
    free(*text);
    *text = edited;
    return 0;
}

/* ---- the whole -------------------------------------------------------- */

static int edit_node(migration *migration, int node, bool *has_slew)
{
    const tree_node *const edited = &migration->tree.node[node];
    const retired *const key = edited->key ? retired_key(&migration->tree, node) : NULL;
    const retired *const word = retired_word(&migration->tree, node);
    if (word && replace_name(migration, edited->at, word->old_name, word->new_name) != 0)
        return -1;
    if (!key)
        return 0;
    *has_slew |= key->type == RETIRED_SLEW;
    if (key->type == RETIRED_RATE)
        return move_rate(migration, node);
    return replace_name(migration, edited->key_at, key->old_name, key->new_name);
}

/*
 * Replace all retired names in the text of a scene; *text becomes the new text, and the old one is
 * released.
 */
static int replace_retired(const char *path, char **text, size_t *bytes, bool *has_slew,
                           char *error)
{
    migration migration;
    char *edited = NULL;
    int status = open_migration(&migration, path, *text, *bytes, error);
    for (int node = 1; status == 0 && node <= migration.tree.nodes; node++)
        status = edit_node(&migration, node, has_slew);
    if (status == 0)
        status = apply_edits(&migration, &edited, bytes);
    close_migration(&migration);
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
