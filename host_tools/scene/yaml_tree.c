/* YAML documents as trees: building from libyaml's events, changes from the command line, messages.
 */
#define _POSIX_C_SOURCE 200809L
#include "yaml_tree.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <yaml.h>

/* ---- messages ---- */

static void make_one_line(char *text)
{
    size_t n = strlen(text);
    char *c;
    for (c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            *c = '?';
    if (n < SCENE_ERROR - 1)
        return;
    while (n > 0 && ((unsigned char)text[n - 1] & 0xC0) == 0x80)
        text[--n] = 0; /* a character cut in two */
    if (n > 0 && ((unsigned char)text[n - 1] & 0x80))
        text[--n] = 0;
}

int tree_message(char *error, const char *path, const char *const *set, scene_at at,
                 const char *format, va_list list)
{
    size_t length = strlen(path);
    int n;
    if (length > 200)
        path += length - 200;
    if (at.line < 0) {
        const char *change = set[-at.line - 1];
        const size_t name = strcspn(change, "=");
        n = snprintf(error, SCENE_ERROR, "--set %.*s: ", name < 200 ? (int)name : 200, change);
    } else if (at.line == 0) {
        n = snprintf(error, SCENE_ERROR, "%s: ", path);
    } else {
        n = snprintf(error, SCENE_ERROR, "%s:%d:%d: ", path, at.line, at.column);
    }
    vsnprintf(error + n, (size_t)(SCENE_ERROR - n), format, list);
    make_one_line(error);
    return -1;
}

int tree_fault_at(const tree *t, scene_at at, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    tree_message(t->error, t->path, t->set, at, format, list);
    va_end(list);
    return -1;
}

int tree_fault(const tree *t, int node, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    tree_message(t->error, t->path, t->set, t->node[node].at, format, list);
    va_end(list);
    return -1;
}

/* ---- nodes ---- */

static int new_node(tree *t, tree_kind kind, scene_at at)
{
    if (t->nodes + 1 >= t->room) {
        int room = t->room ? 2 * t->room : 256;
        tree_node *node = realloc(t->node, (size_t)room * sizeof *node);
        if (!node)
            return tree_fault_at(t, at, "out of memory"), 0;
        t->node = node;
        t->room = room;
    }
    if (t->nodes >= TREE_NODES)
        return tree_fault_at(t, at, "more than %d values; a scene is smaller", TREE_NODES), 0;
    t->nodes++;
    memset(&t->node[t->nodes], 0, sizeof *t->node);
    t->node[t->nodes].kind = kind;
    t->node[t->nodes].at = at;
    return t->nodes;
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

static int new_scalar(tree *t, const char *text, size_t length, scene_at at)
{
    int node = new_node(t, TREE_SCALAR, at);
    if (!node)
        return 0;
    t->node[node].text = copy_text(text, length);
    return t->node[node].text ? node : (tree_fault_at(t, at, "out of memory"), 0);
}

static void append(tree *t, int parent, int child)
{
    tree_node *p = &t->node[parent];
    if (p->last)
        t->node[p->last].next = child;
    else
        p->first = child;
    p->last = child;
    p->count++;
    t->node[child].parent = parent;
}

static int append_key(tree *t, int map, int child, const char *key, size_t length, scene_at at)
{
    t->node[child].key = copy_text(key, length);
    if (!t->node[child].key)
        return tree_fault_at(t, at, "out of memory");
    t->node[child].key_at = at;
    append(t, map, child);
    return 0;
}

int tree_find(const tree *t, int map, const char *key)
{
    int i;
    for (i = t->node[map].first; i; i = t->node[i].next)
        if (strcmp(t->node[i].key, key) == 0)
            return i;
    return 0;
}

const char *tree_name(const tree *t, int node)
{
    while (node && !t->node[node].key)
        node = t->node[node].parent;
    return node ? t->node[node].key : "scene";
}

void tree_free(tree *t)
{
    int i;
    for (i = 1; i <= t->nodes; i++) {
        free(t->node[i].key);
        free(t->node[i].text);
    }
    free(t->node);
    t->node = NULL;
    t->nodes = t->room = t->root = 0;
}

/* ---- from libyaml's events ---- */

typedef struct anchor {
    char *name;
    int node;
} anchor;

typedef struct builder {
    tree *t;
    yaml_parser_t yaml;
    const char *text;
    size_t bytes;
    int line; /* 0: positions of the file; else that of every node */
    int depth;
    int open[TREE_DEPTH];  /* lists and mappings not yet closed */
    char *key[TREE_DEPTH]; /* key read in such a mapping, waiting for its value */
    scene_at key_at[TREE_DEPTH];
    anchor anchors[TREE_ANCHORS];
    int anchor_count, documents, root;
} builder;

static scene_at mark_at(const builder *b, yaml_mark_t mark)
{
    scene_at at;
    at.line = b->line ? b->line : (int)mark.line + 1;
    at.column = (int)mark.column + 1;
    return at;
}

/* libyaml gives no position for bytes that are no text: count the lines before them. */
static scene_at byte_at(const builder *b, size_t offset)
{
    scene_at at = {1, 1};
    size_t i;
    for (i = 0; i < offset && i < b->bytes; i++) {
        at.column = b->text[i] == '\n' ? 1 : at.column + 1;
        at.line += b->text[i] == '\n';
    }
    if (b->line)
        at.line = b->line;
    return at;
}

static int syntax_fault(builder *b)
{
    const yaml_parser_t *y = &b->yaml;
    const char *problem = y->problem ? y->problem : "the text cannot be read";
    if (y->error == YAML_MEMORY_ERROR)
        return tree_fault_at(b->t, byte_at(b, 0), "out of memory");
    if (y->error == YAML_READER_ERROR)
        return tree_fault_at(b->t, byte_at(b, y->problem_offset),
                             "not text (%s); save the scene as UTF-8", problem);
    return tree_fault_at(b->t, mark_at(b, y->problem_mark),
                         "not YAML: %s%s%s; check brackets, quotes and indentation",
                         y->context ? y->context : "", y->context ? ", " : "", problem);
}

static int copy_tree(tree *t, int from);

static int copy_children(tree *t, int from, int to)
{
    int i;
    for (i = t->node[from].first; i; i = t->node[i].next) {
        int child = copy_tree(t, i);
        if (!child)
            return -1;
        if (!t->node[i].key)
            append(t, to, child);
        else if (append_key(t, to, child, t->node[i].key, strlen(t->node[i].key),
                            t->node[i].key_at) != 0)
            return -1;
    }
    return 0;
}

/* Depth is bounded by TREE_DEPTH, size by TREE_NODES. */
static int copy_tree(tree *t, int from)
{
    tree_node n = t->node[from];
    int to = n.kind == TREE_SCALAR ? new_scalar(t, n.text, strlen(n.text), n.at)
                                   : new_node(t, n.kind, n.at);
    if (!to || copy_children(t, from, to) != 0)
        return 0;
    return to;
}

static int height(const tree *t, int node)
{
    int i, most = 0;
    for (i = t->node[node].first; i; i = t->node[i].next) {
        int h = height(t, i);
        if (h > most)
            most = h;
    }
    return most + 1;
}

static int is_open(const builder *b, int node)
{
    int i;
    for (i = 0; i < b->depth; i++)
        if (b->open[i] == node)
            return 1;
    return 0;
}

static int take_alias(builder *b, const char *name, scene_at at)
{
    int i;
    for (i = b->anchor_count - 1; i >= 0; i--)
        if (strcmp(b->anchors[i].name, name) == 0)
            break;
    if (i < 0)
        return tree_fault_at(
                   b->t, at,
                   "*%s stands for nothing; define it before with &%s, or quote an expression that "
                   "starts with *",
                   name, name),
               0;
    if (is_open(b, b->anchors[i].node))
        return tree_fault_at(b->t, at, "*%s contains itself; write its value out", name), 0;
    if (b->depth + height(b->t, b->anchors[i].node) > TREE_DEPTH)
        return tree_fault_at(b->t, at, "nested more than %d deep; a scene is flatter", TREE_DEPTH),
               0;
    return copy_tree(b->t, b->anchors[i].node);
}

static int keep_anchor(builder *b, const yaml_char_t *name, int node, scene_at at)
{
    anchor *a = &b->anchors[b->anchor_count];
    if (!name)
        return 0;
    if (b->anchor_count == TREE_ANCHORS)
        return tree_fault_at(b->t, at, "more than %d anchors; write the values out", TREE_ANCHORS);
    a->name = copy_text((const char *)name, strlen((const char *)name));
    if (!a->name)
        return tree_fault_at(b->t, at, "out of memory");
    a->node = node;
    b->anchor_count++;
    return 0;
}

static int take_key(builder *b, const yaml_event_t *e, scene_at at)
{
    int top = b->depth - 1, map = b->open[top];
    const char *text;
    int twin;
    if (e->type != YAML_SCALAR_EVENT)
        return tree_fault_at(b->t, at, "a key must be a plain word");
    text = (const char *)e->data.scalar.value;
    if (strlen(text) != e->data.scalar.length)
        return tree_fault_at(b->t, at, "a NUL character in a key; remove it");
    twin = tree_find(b->t, map, text);
    if (twin)
        return tree_fault_at(b->t, at, "'%.60s' is given twice (first on line %d); keep one", text,
                             b->t->node[twin].key_at.line);
    if (b->t->node[map].count >= TREE_KEYS)
        return tree_fault_at(b->t, at, "more than %d keys; a scene is smaller", TREE_KEYS);
    b->key[top] = copy_text(text, strlen(text));
    b->key_at[top] = at;
    return b->key[top] ? 0 : tree_fault_at(b->t, at, "out of memory");
}

/* Put a node where the events are: under the waiting key, at the end of the list, or as the root.
 */
static int place(builder *b, int node)
{
    int top = b->depth - 1, status;
    if (top < 0) {
        b->root = node;
        return 0;
    }
    if (!b->key[top]) {
        append(b->t, b->open[top], node);
        return 0;
    }
    status = append_key(b->t, b->open[top], node, b->key[top], strlen(b->key[top]), b->key_at[top]);
    free(b->key[top]);
    b->key[top] = NULL;
    return status;
}

static int value_node(builder *b, const yaml_event_t *e, scene_at at)
{
    if (e->type == YAML_ALIAS_EVENT)
        return take_alias(b, (const char *)e->data.alias.anchor, at);
    if (e->type != YAML_SCALAR_EVENT)
        return new_node(b->t, e->type == YAML_MAPPING_START_EVENT ? TREE_MAP : TREE_LIST, at);
    if (memchr(e->data.scalar.value, 0, e->data.scalar.length))
        return tree_fault_at(b->t, at, "a NUL character; remove it"), 0;
    return new_scalar(b->t, (const char *)e->data.scalar.value, e->data.scalar.length, at);
}

static int take_value(builder *b, const yaml_event_t *e, scene_at at)
{
    const yaml_char_t *name = NULL;
    int node = value_node(b, e, at);
    if (!node || place(b, node) != 0)
        return -1;
    if (e->type == YAML_SCALAR_EVENT)
        name = e->data.scalar.anchor;
    if (e->type == YAML_SEQUENCE_START_EVENT)
        name = e->data.sequence_start.anchor;
    if (e->type == YAML_MAPPING_START_EVENT)
        name = e->data.mapping_start.anchor;
    if (keep_anchor(b, name, node, at) != 0)
        return -1;
    if (e->type != YAML_SEQUENCE_START_EVENT && e->type != YAML_MAPPING_START_EVENT)
        return 0;
    if (b->depth == TREE_DEPTH)
        return tree_fault_at(b->t, at, "nested more than %d deep; a scene is flatter", TREE_DEPTH);
    b->open[b->depth] = node;
    b->key[b->depth] = NULL;
    b->depth++;
    return 0;
}

static int take_event(builder *b, const yaml_event_t *e)
{
    scene_at at = mark_at(b, e->start_mark);
    switch (e->type) {
    case YAML_DOCUMENT_START_EVENT:
        if (b->documents++)
            return tree_fault_at(b->t, at,
                                 "a second document; a file holds one scene, remove '---'");
        return 0;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT: b->depth--; return 0;
    case YAML_ALIAS_EVENT:
    case YAML_SCALAR_EVENT:
    case YAML_SEQUENCE_START_EVENT:
    case YAML_MAPPING_START_EVENT: break;
    default: return 0;
    }
    if (b->depth && b->t->node[b->open[b->depth - 1]].kind == TREE_MAP && !b->key[b->depth - 1])
        return take_key(b, e, at);
    return take_value(b, e, at);
}

static int take_events(builder *b)
{
    yaml_event_t event;
    int status, ended;
    do {
        if (!yaml_parser_parse(&b->yaml, &event))
            return syntax_fault(b);
        ended = event.type == YAML_STREAM_END_EVENT;
        status = take_event(b, &event);
        yaml_event_delete(&event);
    } while (status == 0 && !ended);
    return status;
}

/* Build nodes from text; the root, 0 on a fault, or -1 if the text holds nothing. */
static int build(tree *t, const char *text, size_t bytes, int line)
{
    builder b;
    int i, status;
    memset(&b, 0, sizeof b);
    b.t = t;
    b.text = text;
    b.bytes = bytes;
    b.line = line;
    if (!yaml_parser_initialize(&b.yaml))
        return tree_fault_at(t, byte_at(&b, 0), "out of memory"), 0;
    yaml_parser_set_input_string(&b.yaml, (const unsigned char *)text, bytes);
    status = take_events(&b);
    yaml_parser_delete(&b.yaml);
    for (i = 0; i < b.depth; i++)
        free(b.key[i]);
    for (i = 0; i < b.anchor_count; i++)
        free(b.anchors[i].name);
    if (status != 0)
        return 0;
    return b.root ? b.root : -1;
}

/* ---- changes from the command line ---- */

static int is_number(const char *text, size_t length)
{
    return length > 0 && length < 7 && strspn(text, "0123456789") >= length;
}

static int names_item(const tree *t, int item, const char *text, size_t length)
{
    int name = t->node[item].kind == TREE_MAP ? tree_find(t, item, "name") : 0;
    return name && t->node[name].kind == TREE_SCALAR && strlen(t->node[name].text) == length &&
           strncmp(t->node[name].text, text, length) == 0;
}

/* The child that a path starts with: by key or item name (which may hold dots), or by number. */
static int step(const tree *t, int node, const char *path, size_t *used)
{
    size_t left = strlen(path), dot = strcspn(path, ".");
    int i, k, found = 0;
    *used = dot;
    if (t->node[node].kind == TREE_LIST && is_number(path, dot)) {
        k = atoi(path);
        for (i = t->node[node].first; i && k; i = t->node[i].next)
            k--;
        return i;
    }
    for (i = t->node[node].first; i; i = t->node[i].next) {
        size_t n;
        for (n = dot; n <= left; n += 1 + strcspn(path + n + 1, ".")) {
            int same = t->node[i].key
                           ? strlen(t->node[i].key) == n && strncmp(t->node[i].key, path, n) == 0
                           : names_item(t, i, path, n);
            if (same && (!found || n > *used)) {
                found = i;
                *used = n;
            }
            if (n == left)
                break;
        }
    }
    return found;
}

static int replace(tree *t, int old, int value)
{
    tree_node *v = &t->node[value];
    int parent = t->node[old].parent, i, before = 0;
    for (i = t->node[parent].first; i != old; i = t->node[i].next)
        before = i;
    v->key = t->node[old].key;
    v->key_at = t->node[old].key_at;
    v->parent = parent;
    v->next = t->node[old].next;
    t->node[old].key = NULL;
    if (before)
        t->node[before].next = value;
    else
        t->node[parent].first = value;
    if (t->node[parent].last == old)
        t->node[parent].last = value;
    return 0;
}

static int missing(const tree *t, int node, const char *path, size_t length, scene_at at)
{
    const char *name = tree_name(t, node);
    if (t->node[node].kind == TREE_SCALAR)
        return tree_fault_at(t, at,
                             "'%.60s' is a single value; set the whole of it, as {%.*s: ...}", name,
                             (int)length, path);
    if (t->node[node].kind == TREE_MAP)
        return tree_fault_at(t, at, "there is no '%.*s' in %.60s; set the whole of it, as {...}",
                             (int)length, path, name);
    return tree_fault_at(
        t, at, "'%.60s' has no item '%.*s'; it has %d, numbered from 0, or use an item's name",
        name, (int)length, path, t->node[node].count);
}

static int put(tree *t, const char *path, size_t length, int value, scene_at at)
{
    char where[SCENE_ERROR];
    size_t used = 0;
    int node = t->root, child;
    if (length == 0 || length >= sizeof where)
        return tree_fault_at(t, at, "write --set a.b.c=value");
    memcpy(where, path, length);
    where[length] = 0;
    for (path = where;; path += used + 1) {
        child = step(t, node, path, &used);
        if (!path[used])
            break;
        if (!child)
            return missing(t, node, path, used, at);
        node = child;
    }
    if (child)
        return replace(t, child, value);
    if (t->node[node].kind == TREE_MAP && used > 0)
        return append_key(t, node, value, path, used, at);
    if (t->node[node].kind == TREE_LIST && is_number(path, used) &&
        atoi(path) == t->node[node].count) {
        append(t, node, value);
        return 0;
    }
    return missing(t, node, path, used, at);
}

static int apply_change(tree *t, int k)
{
    const char *change = t->set[k], *equals = strchr(change, '=');
    scene_at at = {-(k + 1), 1};
    int value;
    if (!equals)
        return tree_fault_at(t, at, "no '='; write --set a.b.c=value");
    if (t->node[t->root].kind != TREE_MAP)
        return tree_fault(t, t->root,
                          "a scene is a mapping of keys to values; start with name: ...");
    value = build(t, equals + 1, strlen(equals + 1), at.line);
    if (value == 0)
        return -1;
    if (value < 0)
        return tree_fault_at(t, at, "no value; write --set a.b.c=value");
    return put(t, change, (size_t)(equals - change), value, at);
}

/* ---- files ---- */

static uint32_t hash_more(uint32_t hash, const char *bytes, size_t count)
{
    size_t i;
    for (i = 0; i < count; i++)
        hash = (hash ^ (unsigned char)bytes[i]) * 16777619u;
    return hash;
}

static int read_bytes(tree *t, FILE *file, char **text, size_t *bytes)
{
    scene_at whole = {0, 0};
    *text = malloc(TREE_BYTES + 1);
    if (!*text)
        return tree_fault_at(t, whole, "out of memory");
    *bytes = fread(*text, 1, TREE_BYTES + 1, file);
    if (ferror(file))
        return tree_fault_at(t, whole, "cannot be read: %s", strerror(errno));
    if (*bytes > TREE_BYTES)
        return tree_fault_at(t, whole, "larger than %d MB; a scene is smaller", TREE_BYTES >> 20);
    return 0;
}

static int read_file(tree *t, char **text, size_t *bytes)
{
    scene_at whole = {0, 0};
    struct stat info;
    FILE *file;
    int status;
    if (stat(t->path, &info) != 0)
        return tree_fault_at(t, whole, "cannot be opened: %s; give the path of a scene file",
                             strerror(errno));
    if (!S_ISREG(info.st_mode))
        return tree_fault_at(t, whole, "is not a file; give the path of a scene file");
    if (info.st_size > TREE_BYTES)
        return tree_fault_at(t, whole, "larger than %d MB; a scene is smaller", TREE_BYTES >> 20);
    file = fopen(t->path, "rb");
    if (!file)
        return tree_fault_at(t, whole, "cannot be opened: %s", strerror(errno));
    status = read_bytes(t, file, text, bytes);
    fclose(file);
    return status;
}

static int read_tree(tree *t, char **text)
{
    scene_at start = {1, 1};
    size_t bytes = 0;
    int i;
    if (read_file(t, text, &bytes) != 0)
        return -1;
    t->hash = hash_more(2166136261u, *text, bytes);
    t->root = build(t, *text, bytes, 0);
    if (t->root < 0)
        return tree_fault_at(t, start, "the file is empty; start with name: ...");
    if (t->root == 0)
        return -1;
    for (i = 0; i < t->sets; i++) {
        t->hash = hash_more(t->hash, t->set[i], strlen(t->set[i]) + 1);
        if (apply_change(t, i) != 0)
            return -1;
    }
    return 0;
}

int tree_read(tree *t, const char *path, const char *const *set, int sets, char *error)
{
    char *text = NULL;
    int status;
    memset(t, 0, sizeof *t);
    t->path = path;
    t->set = set;
    t->sets = sets;
    t->error = error;
    error[0] = 0;
    status = read_tree(t, &text);
    free(text);
    return status;
}
