/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * YAML documents as trees (yaml_tree.h): construction from the events of libyaml, changes from the
 * command line, and error messages.
 */
#define _POSIX_C_SOURCE 200809L
#include "yaml_tree.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <yaml.h>

/* ---- error messages ---- */

static void make_one_line(char *text)
{
    size_t length = strlen(text);
    char *character;
    for (character = text; *character; character++)
        if ((unsigned char)*character < 32 || *character == 127)
            *character = '?';
    if (length < SCENE_ERROR - 1)
        return;
    while (length > 0 && ((unsigned char)text[length - 1] & 0xC0) == 0x80)
        text[--length] = 0; /* a long error message that is cut off may end inside a UTF-8
                               character; the bytes of the incomplete character are removed */
    if (length > 0 && ((unsigned char)text[length - 1] & 0x80))
        text[--length] = 0;
}

int tree_message(char *error, const char *path, const char *const *set, scene_at at,
                 const char *format, va_list list)
{
    size_t length = strlen(path);
    int prefix;
    if (length > 200)
        path += length - 200;
    if (at.line < 0) {
        const char *change = set[-at.line - 1];
        const size_t name = strcspn(change, "=");
        prefix = snprintf(error, SCENE_ERROR, "--set %.*s: ", name < 200 ? (int)name : 200, change);
    } else if (at.line == 0) {
        prefix = snprintf(error, SCENE_ERROR, "%s: ", path);
    } else {
        prefix = snprintf(error, SCENE_ERROR, "%s:%d:%d: ", path, at.line, at.column);
    }
    vsnprintf(error + prefix, (size_t)(SCENE_ERROR - prefix), format, list);
    make_one_line(error);
    return -1;
}

int tree_fault_at(const tree *tree, scene_at at, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    tree_message(tree->error, tree->path, tree->set, at, format, list);
    va_end(list);
    return -1;
}

int tree_fault(const tree *tree, int node, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    tree_message(tree->error, tree->path, tree->set, tree->node[node].at, format, list);
    va_end(list);
    return -1;
}

/* ---- nodes of the tree ---- */

static int new_node(tree *tree, tree_kind kind, scene_at at)
{
    if (tree->nodes + 1 >= tree->room) {
        int room = tree->room ? 2 * tree->room : 256;
        tree_node *node = realloc(tree->node, (size_t)room * sizeof *node);
        if (!node)
            return tree_fault_at(tree, at, "out of memory"), 0;
        tree->node = node;
        tree->room = room;
    }
    if (tree->nodes >= TREE_NODES)
        return tree_fault_at(tree, at, "more than %d values; a scene is smaller", TREE_NODES), 0;
    tree->nodes++;
    memset(&tree->node[tree->nodes], 0, sizeof *tree->node);
    tree->node[tree->nodes].kind = kind;
    tree->node[tree->nodes].at = at;
    return tree->nodes;
}

static char *copy_text(const char *text, size_t length)
{
    char *copy = malloc(length + 1);
    if (!copy)
        return NULL;
    memcpy(copy, text, length);
    copy[length] = 0;
    return copy;
}

static int new_scalar(tree *tree, const char *text, size_t length, scene_at at)
{
    int node = new_node(tree, TREE_SCALAR, at);
    if (!node)
        return 0;
    tree->node[node].text = copy_text(text, length);
    return tree->node[node].text ? node : (tree_fault_at(tree, at, "out of memory"), 0);
}

static void append(tree *tree, int parent, int child)
{
    tree_node *owner = &tree->node[parent];
    if (owner->last)
        tree->node[owner->last].next = child;
    else
        owner->first = child;
    owner->last = child;
    owner->count++;
    tree->node[child].parent = parent;
}

static int append_key(tree *tree, int map, int child, const char *key, size_t length, scene_at at)
{
    tree->node[child].key = copy_text(key, length);
    if (!tree->node[child].key)
        return tree_fault_at(tree, at, "out of memory");
    tree->node[child].key_at = at;
    append(tree, map, child);
    return 0;
}

int tree_find(const tree *tree, int map, const char *key)
{
    int i;
    for (i = tree->node[map].first; i; i = tree->node[i].next)
        if (tree->node[i].key && strcmp(tree->node[i].key, key) == 0)
            return i;
    return 0;
}

const char *tree_name(const tree *tree, int node)
{
    while (node && !tree->node[node].key)
        node = tree->node[node].parent;
    return node ? tree->node[node].key : "scene";
}

void tree_free(tree *tree)
{
    int i;
    for (i = 1; i <= tree->nodes; i++) {
        free(tree->node[i].key);
        free(tree->node[i].text);
    }
    free(tree->node);
    tree->node = NULL;
    tree->nodes = tree->room = tree->root = 0;
}

/* ---- tree from libyaml's events ---- */

typedef struct anchor {
    char *name;
    int node;
} anchor;

typedef struct builder {
    tree *tree;
    yaml_parser_t yaml;
    const char *text;
    size_t bytes;
    int line; /* line number of all YAML nodes while a change from the command line is read; 0: the
                 nodes take their lines from the file */
    int depth;
    int open[TREE_DEPTH];  /* indices of the lists and mappings of the YAML text that are still open
                            */
    char *key[TREE_DEPTH]; /* key that was read in an open mapping and whose value follows, or NULL
                            */
    scene_at key_at[TREE_DEPTH];
    anchor anchors[TREE_ANCHORS];
    int anchor_count, documents, root;
} builder;

static scene_at mark_at(const builder *builder, yaml_mark_t mark)
{
    scene_at at;
    at.line = builder->line ? builder->line : (int)mark.line + 1;
    at.column = (int)mark.column + 1;
    return at;
}

/*
 * Return the line and column of a byte of the file by counting; libyaml gives no position for bytes
 * that are no valid text.
 */
static scene_at byte_at(const builder *builder, size_t offset)
{
    scene_at at = {.line = 1, .column = 1};
    size_t i;
    for (i = 0; i < offset && i < builder->bytes; i++) {
        at.column = builder->text[i] == '\n' ? 1 : at.column + 1;
        at.line += builder->text[i] == '\n';
    }
    if (builder->line)
        at.line = builder->line;
    return at;
}

static int syntax_fault(builder *builder)
{
    const yaml_parser_t *parser = &builder->yaml;
    const char *problem = parser->problem ? parser->problem : "the text cannot be read";
    if (parser->error == YAML_MEMORY_ERROR)
        return tree_fault_at(builder->tree, byte_at(builder, 0), "out of memory");
    if (parser->error == YAML_READER_ERROR)
        return tree_fault_at(builder->tree, byte_at(builder, parser->problem_offset),
                             "not text (%s); save the scene as UTF-8", problem);
    const scene_at at = mark_at(builder, parser->problem_mark);
    if (parser->context)
        return tree_fault_at(builder->tree, at,
                             "not YAML: %s, %s; check brackets, quotes and indentation",
                             parser->context, problem);
    return tree_fault_at(builder->tree, at, "not YAML: %s; check brackets, quotes and indentation",
                         problem);
}

static int copy_tree(tree *tree, int from);

static int copy_children(tree *tree, int from, int to)
{
    int i;
    for (i = tree->node[from].first; i; i = tree->node[i].next) {
        int child = copy_tree(tree, i);
        if (!child)
            return -1;
        if (!tree->node[i].key)
            append(tree, to, child);
        else if (append_key(tree, to, child, tree->node[i].key, strlen(tree->node[i].key),
                            tree->node[i].key_at) != 0)
            return -1;
    }
    return 0;
}

/*
 * Return the index of a new copy of a part of the YAML tree, or 0 on a fault. A copy that would
 * make the tree too deep or too large is a fault.
 */
static int copy_tree(tree *tree, int from)
{
    tree_node copied = tree->node[from];
    int to = copied.kind == TREE_SCALAR
                 ? new_scalar(tree, copied.text, strlen(copied.text), copied.at)
                 : new_node(tree, copied.kind, copied.at);
    if (!to || copy_children(tree, from, to) != 0)
        return 0;
    return to;
}

static int height(const tree *tree, int node)
{
    int i, most = 0;
    for (i = tree->node[node].first; i; i = tree->node[i].next) {
        int tallest = height(tree, i);
        if (tallest > most)
            most = tallest;
    }
    return most + 1;
}

static int is_open(const builder *builder, int node)
{
    int i;
    for (i = 0; i < builder->depth; i++)
        if (builder->open[i] == node)
            return 1;
    return 0;
}

static int take_alias(builder *builder, const char *name, scene_at at)
{
    int i;
    for (i = builder->anchor_count - 1; i >= 0; i--)
        if (strcmp(builder->anchors[i].name, name) == 0)
            break;
    if (i < 0)
        return tree_fault_at(
                   builder->tree, at,
                   "*%s stands for nothing; define it before with &%s, or quote an expression that "
                   "starts with *",
                   name, name),
               0;
    if (is_open(builder, builder->anchors[i].node))
        return tree_fault_at(builder->tree, at, "*%s contains itself; write its value out", name),
               0;
    if (builder->depth + height(builder->tree, builder->anchors[i].node) > TREE_DEPTH)
        return tree_fault_at(builder->tree, at, "nested more than %d deep; a scene is flatter",
                             TREE_DEPTH),
               0;
    return copy_tree(builder->tree, builder->anchors[i].node);
}

static int keep_anchor(builder *builder, const yaml_char_t *name, int node, scene_at at)
{
    anchor *kept = &builder->anchors[builder->anchor_count];
    if (!name)
        return 0;
    if (builder->anchor_count == TREE_ANCHORS)
        return tree_fault_at(builder->tree, at, "more than %d anchors; write the values out",
                             TREE_ANCHORS);
    kept->name = copy_text((const char *)name, strlen((const char *)name));
    if (!kept->name)
        return tree_fault_at(builder->tree, at, "out of memory");
    kept->node = node;
    builder->anchor_count++;
    return 0;
}

static int take_key(builder *builder, const yaml_event_t *event, scene_at at)
{
    int top = builder->depth - 1, map = builder->open[top];
    const char *text;
    int twin;
    if (event->type != YAML_SCALAR_EVENT)
        return tree_fault_at(builder->tree, at, "a key must be a plain word");
    text = (const char *)event->data.scalar.value;
    if (strlen(text) != event->data.scalar.length)
        return tree_fault_at(builder->tree, at, "a NUL character in a key; remove it");
    twin = tree_find(builder->tree, map, text);
    if (twin)
        return tree_fault_at(builder->tree, at,
                             "'%.60s' is given twice (first on line %d); keep one", text,
                             builder->tree->node[twin].key_at.line);
    if (builder->tree->node[map].count >= TREE_KEYS)
        return tree_fault_at(builder->tree, at, "more than %d keys; a scene is smaller", TREE_KEYS);
    builder->key[top] = copy_text(text, strlen(text));
    builder->key_at[top] = at;
    return builder->key[top] ? 0 : tree_fault_at(builder->tree, at, "out of memory");
}

/*
 * Insert a new YAML node at the position that has been reached in the tree: as the value of the key
 * just read, at the end of the list being read, or as the root.
 */
static int place(builder *builder, int node)
{
    int top = builder->depth - 1, status;
    if (top < 0) {
        builder->root = node;
        return 0;
    }
    if (!builder->key[top]) {
        append(builder->tree, builder->open[top], node);
        return 0;
    }
    status = append_key(builder->tree, builder->open[top], node, builder->key[top],
                        strlen(builder->key[top]), builder->key_at[top]);
    free(builder->key[top]);
    builder->key[top] = NULL;
    return status;
}

static int value_node(builder *builder, const yaml_event_t *event, scene_at at)
{
    if (event->type == YAML_ALIAS_EVENT)
        return take_alias(builder, (const char *)event->data.alias.anchor, at);
    if (event->type != YAML_SCALAR_EVENT)
        return new_node(builder->tree,
                        event->type == YAML_MAPPING_START_EVENT ? TREE_MAP : TREE_LIST, at);
    if (memchr(event->data.scalar.value, 0, event->data.scalar.length))
        return tree_fault_at(builder->tree, at, "a NUL character; remove it"), 0;
    return new_scalar(builder->tree, (const char *)event->data.scalar.value,
                      event->data.scalar.length, at);
}

static int take_value(builder *builder, const yaml_event_t *event, scene_at at)
{
    const yaml_char_t *name = NULL;
    int node = value_node(builder, event, at);
    if (!node || place(builder, node) != 0)
        return -1;
    if (event->type == YAML_SCALAR_EVENT)
        name = event->data.scalar.anchor;
    if (event->type == YAML_SEQUENCE_START_EVENT)
        name = event->data.sequence_start.anchor;
    if (event->type == YAML_MAPPING_START_EVENT)
        name = event->data.mapping_start.anchor;
    if (keep_anchor(builder, name, node, at) != 0)
        return -1;
    if (event->type != YAML_SEQUENCE_START_EVENT && event->type != YAML_MAPPING_START_EVENT)
        return 0;
    if (builder->depth == TREE_DEPTH)
        return tree_fault_at(builder->tree, at, "nested more than %d deep; a scene is flatter",
                             TREE_DEPTH);
    builder->open[builder->depth] = node;
    builder->key[builder->depth] = NULL;
    builder->depth++;
    return 0;
}

static int take_event(builder *builder, const yaml_event_t *event)
{
    scene_at at = mark_at(builder, event->start_mark);
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        if (builder->documents++)
            return tree_fault_at(builder->tree, at,
                                 "a second document; a file holds one scene, remove '---'");
        return 0;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT: builder->depth--; return 0;
    case YAML_ALIAS_EVENT:
    case YAML_SCALAR_EVENT:
    case YAML_SEQUENCE_START_EVENT:
    case YAML_MAPPING_START_EVENT: break;
    default: return 0;
    }
    if (builder->depth && builder->tree->node[builder->open[builder->depth - 1]].kind == TREE_MAP &&
        !builder->key[builder->depth - 1])
        return take_key(builder, event, at);
    return take_value(builder, event, at);
}

static int take_events(builder *builder)
{
    yaml_event_t event;
    int status, ended;
    do {
        if (!yaml_parser_parse(&builder->yaml, &event))
            return syntax_fault(builder);
        ended = event.type == YAML_STREAM_END_EVENT;
        status = take_event(builder, &event);
        yaml_event_delete(&event);
    } while (status == 0 && !ended);
    return status;
}

/*
 * Build the nodes of a tree from a YAML text. Returns the index of the root, 0 on a fault, or -1 if
 * the text is empty.
 */
static int build(tree *tree, const char *text, size_t bytes, int line)
{
    builder builder;
    int i, status;
    memset(&builder, 0, sizeof builder);
    builder.tree = tree;
    builder.text = text;
    builder.bytes = bytes;
    builder.line = line;
    if (!yaml_parser_initialize(&builder.yaml))
        return tree_fault_at(tree, byte_at(&builder, 0), "out of memory"), 0;
    yaml_parser_set_input_string(&builder.yaml, (const unsigned char *)text, bytes);
    status = take_events(&builder);
    yaml_parser_delete(&builder.yaml);
    for (i = 0; i < builder.depth; i++)
        free(builder.key[i]);
    for (i = 0; i < builder.anchor_count; i++)
        free(builder.anchors[i].name);
    if (status != 0)
        return 0;
    return builder.root ? builder.root : -1;
}

/* ---- changes from the command line ---- */

static int is_number(const char *text, size_t length)
{
    return length > 0 && length < 7 && strspn(text, "0123456789") >= length;
}

static int names_item(const tree *tree, int item, const char *text, size_t length)
{
    int name = tree->node[item].kind == TREE_MAP ? tree_find(tree, item, "name") : 0;
    return name && tree->node[name].kind == TREE_SCALAR &&
           strlen(tree->node[name].text) == length &&
           strncmp(tree->node[name].text, text, length) == 0;
}

/*
 * Return the child of a YAML node that the first part of a path such as a.b.c stands for: a key or
 * item name (which may contain dots), or an index in a list. *used becomes the length of that part
 * (bytes).
 */
static int step(const tree *tree, int node, const char *path, size_t *used)
{
    size_t left = strlen(path), dot = strcspn(path, ".");
    int i, k, found = 0;
    *used = dot;
    if (tree->node[node].kind == TREE_LIST && is_number(path, dot)) {
        k = atoi(path);
        for (i = tree->node[node].first; i && k; i = tree->node[i].next)
            k--;
        return i;
    }
    for (i = tree->node[node].first; i; i = tree->node[i].next) {
        size_t length;
        for (length = dot; length <= left; length += 1 + strcspn(path + length + 1, ".")) {
            int same = tree->node[i].key ? strlen(tree->node[i].key) == length &&
                                               strncmp(tree->node[i].key, path, length) == 0
                                         : names_item(tree, i, path, length);
            if (same && (!found || length > *used)) {
                found = i;
                *used = length;
            }
            if (length == left)
                break;
        }
    }
    return found;
}

static int replace(tree *tree, int old, int value)
{
    tree_node *replacement = &tree->node[value];
    int parent = tree->node[old].parent, i, before = 0;
    for (i = tree->node[parent].first; i != old; i = tree->node[i].next)
        before = i;
    replacement->key = tree->node[old].key;
    replacement->key_at = tree->node[old].key_at;
    replacement->parent = parent;
    replacement->next = tree->node[old].next;
    tree->node[old].key = NULL;
    if (before)
        tree->node[before].next = value;
    else
        tree->node[parent].first = value;
    if (tree->node[parent].last == old)
        tree->node[parent].last = value;
    return 0;
}

static int missing(const tree *tree, int node, const char *path, size_t length, scene_at at)
{
    const char *name = tree_name(tree, node);
    if (tree->node[node].kind == TREE_SCALAR)
        return tree_fault_at(tree, at,
                             "'%.60s' is a single value; set the whole of it, as {%.*s: ...}", name,
                             (int)length, path);
    if (tree->node[node].kind == TREE_MAP)
        return tree_fault_at(tree, at, "there is no '%.*s' in %.60s; set the whole of it, as {...}",
                             (int)length, path, name);
    return tree_fault_at(
        tree, at, "'%.60s' has no item '%.*s'; it has %d, numbered from 0, or use an item's name",
        name, (int)length, path, tree->node[node].count);
}

static int put(tree *tree, const char *path, size_t length, int value, scene_at at)
{
    char where[SCENE_ERROR];
    size_t used = 0;
    int node = tree->root, child;
    if (length == 0 || length >= sizeof where)
        return tree_fault_at(tree, at, "write --set a.b.c=value");
    memcpy(where, path, length);
    where[length] = 0;
    for (path = where;; path += used + 1) {
        child = step(tree, node, path, &used);
        if (!path[used])
            break;
        if (!child)
            return missing(tree, node, path, used, at);
        node = child;
    }
    if (child)
        return replace(tree, child, value);
    if (tree->node[node].kind == TREE_MAP && used > 0)
        return append_key(tree, node, value, path, used, at);
    if (tree->node[node].kind == TREE_LIST && is_number(path, used) &&
        atoi(path) == tree->node[node].count) {
        append(tree, node, value);
        return 0;
    }
    return missing(tree, node, path, used, at);
}

static int apply_change(tree *tree, int k)
{
    const char *change = tree->set[k], *equals = strchr(change, '=');
    scene_at at = {.line = -(k + 1), .column = 1};
    int value;
    if (!equals)
        return tree_fault_at(tree, at, "no '='; write --set a.b.c=value");
    if (tree->node[tree->root].kind != TREE_MAP)
        return tree_fault(tree, tree->root,
                          "a scene is a mapping of keys to values; start with name: ...");
    value = build(tree, equals + 1, strlen(equals + 1), at.line);
    if (value == 0)
        return -1;
    if (value < 0)
        return tree_fault_at(tree, at, "no value; write --set a.b.c=value");
    return put(tree, change, (size_t)(equals - change), value, at);
}

/* ---- reading of files ---- */

static uint32_t hash_more(uint32_t hash, const char *bytes, size_t count)
{
    size_t i;
    for (i = 0; i < count; i++)
        hash = (hash ^ (unsigned char)bytes[i]) * 16777619u;
    return hash;
}

static int read_bytes(tree *tree, FILE *file, char **text, size_t *bytes)
{
    scene_at whole = {.line = 0};
    *text = malloc(TREE_BYTES + 1);
    if (!*text)
        return tree_fault_at(tree, whole, "out of memory");
    *bytes = fread(*text, 1, TREE_BYTES + 1, file);
    if (ferror(file))
        return tree_fault_at(tree, whole, "cannot be read: %s", strerror(errno));
    if (*bytes > TREE_BYTES)
        return tree_fault_at(tree, whole, "larger than %d MB; a scene is smaller",
                             TREE_BYTES >> 20);
    return 0;
}

static int read_file(tree *tree, char **text, size_t *bytes)
{
    scene_at whole = {.line = 0};
    struct stat info;
    FILE *file;
    int status;
    if (stat(tree->path, &info) != 0)
        return tree_fault_at(tree, whole, "cannot be opened: %s; give the path of a scene file",
                             strerror(errno));
    if (!S_ISREG(info.st_mode))
        return tree_fault_at(tree, whole, "is not a file; give the path of a scene file");
    if (info.st_size > TREE_BYTES)
        return tree_fault_at(tree, whole, "larger than %d MB; a scene is smaller",
                             TREE_BYTES >> 20);
    file = fopen(tree->path, "rb");
    if (!file)
        return tree_fault_at(tree, whole, "cannot be opened: %s", strerror(errno));
    status = read_bytes(tree, file, text, bytes);
    fclose(file);
    return status;
}

/*
 * Build the tree of a YAML text and apply the changes of the command line. Returns 0, or -1 with
 * error filled.
 */
static int read_tree(tree *tree, const char *text, size_t bytes)
{
    scene_at start = {.line = 1, .column = 1};
    int i;
    tree->hash = hash_more(2166136261u, text, bytes);
    tree->root = build(tree, text, bytes, 0);
    if (tree->root < 0)
        return tree_fault_at(tree, start, "the file is empty; start with name: ...");
    if (tree->root == 0)
        return -1;
    for (i = 0; i < tree->sets; i++) {
        tree->hash = hash_more(tree->hash, tree->set[i], strlen(tree->set[i]) + 1);
        if (apply_change(tree, i) != 0)
            return -1;
    }
    return 0;
}

static void start_tree(tree *tree, const char *path, char *error)
{
    memset(tree, 0, sizeof *tree);
    tree->path = path;
    tree->error = error;
    error[0] = 0;
}

int tree_read(tree *tree, const char *path, const char *const *set, int sets, char *error)
{
    char *text = NULL;
    size_t bytes = 0;
    int status;
    start_tree(tree, path, error);
    tree->set = set;
    tree->sets = sets;
    status = read_file(tree, &text, &bytes);
    if (status == 0)
        status = read_tree(tree, text, bytes);
    free(text);
    return status;
}

int tree_read_text(tree *tree, const char *path, const char *text, size_t bytes, char *error)
{
    start_tree(tree, path, error);
    return read_tree(tree, text, bytes);
}

int tree_load(const char *path, char **text, size_t *bytes, char *error)
{
    tree tree;
    start_tree(&tree, path, error);
    *text = NULL;
    *bytes = 0;
    if (read_file(&tree, text, bytes) != 0)
        return -1;
    (*text)[*bytes] = 0;
    return 0;
}
