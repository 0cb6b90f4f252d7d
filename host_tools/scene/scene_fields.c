/* SPDX-License-Identifier: BSD-2-Clause */
/* Table-driven reading of YAML mappings, and readers of the basic kinds of values. */
#include "scene_fields.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "scene_retired.h"
#include "scene_units.h"

enum { LONGEST = 32, LIST_ROOM = 400, MOST_ITEMS = 5000 };

/*
 * Permitted magnitudes of nonzero numbers in a scene file. Numbers outside are typing errors, and
 * their products could leave the range of a double.
 */
static const double smallest = 1e-60, largest = 1e60;

const range above_zero = {0, HUGE_VAL, 1, "must be above 0"};
const range not_negative = {0, HUGE_VAL, 0, "must not be below 0"};

static const char *const kind_names[TREE_MAP + 1] = {[TREE_SCALAR] = "a single value",
                                                     [TREE_LIST] = "a list [...]",
                                                     [TREE_MAP] = "a mapping {key: value}"};

/*
 * Return the edit distance between two words; it is INT_MAX if one of them is too long to be
 * compared.
 */
static int distance(const char *first, const char *second)
{
    int row[LONGEST + 1], i, j, first_length = (int)strlen(first),
                                second_length = (int)strlen(second);
    if (first_length > LONGEST || second_length > LONGEST)
        return INT_MAX;
    for (j = 0; j <= second_length; j++)
        row[j] = j;
    for (i = 1; i <= first_length; i++) {
        int corner = row[0];
        row[0] = i;
        for (j = 1; j <= second_length; j++) {
            int best = corner + (first[i - 1] != second[j - 1]);
            corner = row[j];
            if (row[j] + 1 < best)
                best = row[j] + 1;
            if (row[j - 1] + 1 < best)
                best = row[j - 1] + 1;
            row[j] = best;
        }
    }
    return row[second_length];
}

/*
 * Return the largest edit distance at which a mistyped word of a given length is taken for a known
 * word.
 */
static int most_mistakes(int length)
{
    if (length < 3)
        return 0;
    return length < 9 ? length / 3 + 1 : 3;
}

/*
 * Write "did you mean 'thickness'?" or "known: a, b, c" for a list of known words, which lie
 * `stride` bytes apart and end with NULL.
 */
static void suggest(const char *text, const char *const *first, size_t stride, char *out)
{
    const char *const *word;
    const char *nearest = NULL;
    int least = most_mistakes((int)strlen(text)), length = 0;
    for (word = first; *word;
         word = (const char *const *)(const void *)((const char *)word + stride)) {
        int mistakes = distance(text, *word);
        if (mistakes <= least) {
            least = mistakes - 1;
            nearest = *word;
        }
    }
    if (nearest) {
        snprintf(out, LIST_ROOM, "did you mean '%s'?", nearest);
        return;
    }
    length = snprintf(out, LIST_ROOM, "known:");
    for (word = first; *word && length < LIST_ROOM;
         word = (const char *const *)(const void *)((const char *)word + stride))
        length += snprintf(out + length, (size_t)(LIST_ROOM - length), "%s %s",
                           word == first ? "" : ",", *word);
}

int require_kind(reader *reader, int node, tree_kind kind)
{
    const tree_node *found = &reader->t->node[node];
    const bool is_item = !found->key && found->parent;
    if (found->kind == kind)
        return 0;
    const bool is_empty = found->kind == TREE_SCALAR && !*found->text;
    const char *is_now = is_empty ? "empty" : kind_names[found->kind];
    return tree_fault(reader->t, node, "%s'%.60s' must be %s, not %s", is_item ? "an item of " : "",
                      tree_name(reader->t, node), kind_names[kind], is_now);
}

/*
 * Search for a key at a given depth below a mapping, in the tables of keys of the scene file.
 *   form   in               table of the mapping, or of a list of mappings
 *   depth  in               1: keys of the mapping itself; 2: keys of the mappings in it; and so on
 *   path   [LIST_ROOM] out  names of the enclosing keys, joined by points, such as simulate.sensors
 *   length in               number of characters that the path has already
 *   left   in/out           in: number of places with the key that the search skips before it
 *                           reports one; out: the same less the places skipped by this call
 * Returns whether there is such a key.
 */
static bool find_key(const form *form, const char *key, int depth, char *path, int length,
                     int *left)
{
    if (!form || depth == 0)
        return false;
    for (const struct form *const *any = form->type == FORM_ANY ? form->any : NULL; any && *any;
         any++)
        if (find_key(*any, key, depth, path, length, left))
            return true;
    if (form->type == FORM_LIST || form->type == FORM_NAMED)
        return find_key(form->item, key, depth, path, length, left);
    for (const field *field = form->type == FORM_MAP ? form->fields : NULL; field && field->key;
         field++) {
        if (depth == 1 && strcmp(field->key, key) == 0 && (*left)-- == 0) {
            path[length] = '\0';
            return true;
        }
        const int more = snprintf(path + length, (size_t)(LIST_ROOM - length), "%s%s",
                                  length ? "." : "", field->key);
        if (length + more < LIST_ROOM &&
            find_key(field->form, key, depth - 1, path, length + more, left))
            return true;
    }
    return false;
}

/*
 * Write a hint at the section in which a key is valid, for a key in the wrong mapping, such as "it
 * is a key of simulate.sensors; ".
 *   section             in   name of the mapping with the key
 *   advice  [LIST_ROOM] out  the hint; empty where there is none
 */
static void point_to_section(const char *key, const char *section, char advice[LIST_ROOM])
{
    enum { DEEPEST = 4, FRAME = 30 };
    char first[LIST_ROOM] = "", path[LIST_ROOM];
    *advice = '\0';
    for (int depth = 2; depth <= DEEPEST; depth++)
        for (int k = 0; find_key(&scene_form, key, depth, path, 0, &(int){k}); k++) {
            const char *last = strrchr(path, '.');
            if (strcmp(last ? last + 1 : path, section) == 0)
                /*
                 * No hint is given if a mapping named `section` accepts the key: the user has
                 * chosen the right section, at a wrong place.
                 */
                return;
            if (!*first)
                memcpy(first, path, sizeof path);
        }
    if (*first)
        snprintf(advice, LIST_ROOM, "it is a key of %.*s; ", LIST_ROOM - FRAME, first);
}

/*
 * Report a key that is not in the table of its mapping, and propose the key that was meant. Returns
 * -1.
 */
static int refuse_key(reader *reader, int node, const field *fields)
{
    char cure[LIST_ROOM], place[LIST_ROOM];
    const tree_node *const refused = &reader->t->node[node];
    const retired *const row = retired_key(reader->t, node);
    const char *const section = tree_name(reader->t, refused->parent);
    if (row)
        return tree_fault_at(reader->t, refused->key_at,
                             "'%s' in %.60s is now called '%s'%s; write the new name, or let pzs "
                             "migrate rewrite the file",
                             row->old_name, section, row->new_name, row->remark);
    suggest(refused->key, &fields->key, sizeof *fields, cure);
    *place = '\0';
    if (strncmp(cure, "known:", 6) == 0)
        point_to_section(refused->key, section, place);
    return tree_fault_at(reader->t, refused->key_at, "unknown key '%.60s' in %.60s; %s%s",
                         refused->key, section, place, cure);
}

static int check_keys(reader *reader, int node, const field *fields)
{
    const tree_node *nodes = reader->t->node;
    const field *field;
    int i;
    for (i = nodes[node].first; i; i = nodes[i].next) {
        for (field = fields; field->key; field++)
            if (strcmp(field->key, nodes[i].key) == 0)
                break;
        if (!field->key)
            return refuse_key(reader, i, fields);
    }
    return 0;
}

/*
 * Read the value of a key with the function that its row of the table of keys names, after refusing
 * words that the scene language no longer has. Returns 0, or -1 after writing an error message
 * about the scene file.
 */
static int read_child(reader *reader, int node, const field *field, void *to)
{
    const retired *const row = retired_word(reader->t, node);
    const dimension outer = reader->of;
    int status;
    if (row)
        return tree_fault(reader->t, node, "'%.60s: %s' is now called '%s'; write '%s'",
                          tree_name(reader->t, node), row->old_name, row->new_name, row->new_name);
    reader->of = field->of;
    status = field->read(reader, node, (char *)to + field->offset, field->rule);
    reader->of = outer;
    return status;
}

int read_map(reader *reader, int node, const field *fields, void *to)
{
    const field *field;
    if (require_kind(reader, node, TREE_MAP) != 0 || check_keys(reader, node, fields) != 0)
        return -1;
    for (field = fields; field->key; field++) {
        int child = tree_find(reader->t, node, field->key);
        if (!child && field->required)
            return tree_fault(reader->t, node, "'%s' is missing in %.60s; add it", field->key,
                              tree_name(reader->t, node));
        if (child && read_child(reader, child, field, to) != 0)
            return -1;
    }
    return 0;
}

static int compile(reader *reader, int node, expr **expression)
{
    char converted[SCENE_UNITS_TEXT];
    const char *why, *text;
    int column;
    if (require_kind(reader, node, TREE_SCALAR) != 0 ||
        scene_units_text(reader, node, converted, &text) != 0)
        return -1;
    if (!*text)
        return tree_fault(reader->t, node, "'%.60s' is empty; give a number",
                          tree_name(reader->t, node));
    *expression = expr_compile(text, &column, &why);
    if (*expression && (!reader->s->quads || !expr_uses_theta(*expression)))
        return 0;
    if (*expression) {
        expr_free(*expression);
        *expression = NULL;
        return tree_fault(reader->t, node,
                          "'%.60s: %.60s' uses theta1 or theta2; a mesh from a file has x, y, z",
                          tree_name(reader->t, node), text);
    }
    return tree_fault(reader->t, node,
                      "'%.60s: %.60s' is no number or formula, at its character %d: %s",
                      tree_name(reader->t, node), text, column, why);
}

static int check_range(reader *reader, int node, double value, const range *rule)
{
    const char *name = tree_name(reader->t, node), *text = node_text(reader, node);
    if (!isfinite(value))
        return tree_fault(reader->t, node, "'%.60s: %.60s' is not finite; give a number", name,
                          text);
    if (fabs(value) > largest || (value != 0 && fabs(value) < smallest))
        return tree_fault(
            reader->t, node,
            "'%.60s: %.60s' is out of range; magnitudes run from %g to %g, choose other units",
            name, text, smallest, largest);
    if (!rule)
        return 0;
    if (rule->strict ? value > rule->low && value < rule->high
                     : value >= rule->low && value <= rule->high)
        return 0;
    return tree_fault(reader->t, node, "'%.60s: %.60s' %s", name, text, rule->must);
}

int read_real(reader *reader, int node, void *to, const void *rule)
{
    static const expr_point origin;
    expr *expression = NULL;
    double value;
    int constant;
    if (compile(reader, node, &expression) != 0)
        return -1;
    value = expr_value(expression, &origin);
    constant = expr_is_constant(expression);
    expr_free(expression);
    if (!constant)
        return tree_fault(reader->t, node,
                          "'%.60s: %.60s' varies over the surface; a constant is wanted here",
                          tree_name(reader->t, node), node_text(reader, node));
    if (check_range(reader, node, value, rule) != 0)
        return -1;
    *(double *)to = value;
    return 0;
}

int read_int(reader *reader, int node, void *to, const void *rule)
{
    double value = 0;
    if (read_real(reader, node, &value, rule) != 0)
        return -1;
    if (value != floor(value) || fabs(value) > 1e9)
        return tree_fault(reader->t, node, "'%.60s: %.60s' must be a whole number",
                          tree_name(reader->t, node), node_text(reader, node));
    *(int *)to = (int)value;
    return 0;
}

/*
 * Check that a node of a YAML tree is a list of two values; `what` names them in the error message.
 */
static int require_two(reader *reader, int node, const char *what)
{
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    if (reader->t->node[node].count != 2)
        return tree_fault(reader->t, node, "'%.60s' has %d values; give two%s",
                          tree_name(reader->t, node), reader->t->node[node].count, what);
    return 0;
}

int read_int_pair(reader *reader, int node, void *to, const void *rule)
{
    int *pair = to;
    const int first = reader->t->node[node].first;
    if (require_two(reader, node, "") != 0 || read_int(reader, first, &pair[0], rule) != 0)
        return -1;
    return read_int(reader, reader->t->node[first].next, &pair[1], rule);
}

int read_node(reader *reader, int node, void *to, const void *rule)
{
    (void)reader;
    (void)rule;
    *(int *)to = node;
    return 0;
}

int read_scalar_node(reader *reader, int node, void *to, const void *rule)
{
    read_node(reader, node, to, rule);
    return require_kind(reader, node, TREE_SCALAR);
}

int read_pair(reader *reader, int node, void *to, const void *rule)
{
    double *pair = to;
    const int first = reader->t->node[node].first;
    if (require_two(reader, node, ", as [0, 1]") != 0)
        return -1;
    if (read_real(reader, first, &pair[0], rule) != 0)
        return -1;
    return read_real(reader, reader->t->node[first].next, &pair[1], rule);
}

/*
 * Texts that begin and end a comment in C; each is written in two parts, so that programs that
 * search sources for comments do not find one here.
 */
static const char comment_start[] = "/"
                                    "*",
                  comment_end[] = "*"
                                  "/";

/*
 * Return whether a text contains the beginning or the end of a comment in C. Such a text is
 * refused, because it would begin or end a comment in the C tables that are generated from the
 * scene file.
 */
static int is_comment(const char *text)
{
    return strstr(text, comment_end) != NULL || strstr(text, comment_start) != NULL;
}

int check_name(reader *reader, const char *name, scene_at at, char *to)
{
    if (!*name)
        return tree_fault_at(reader->t, at, "an empty name; give one");
    if (strlen(name) >= SCENE_NAME)
        return tree_fault_at(reader->t, at, "the name '%.30s...' is too long; use at most %d bytes",
                             name, SCENE_NAME - 1);
    if (strpbrk(name, "\n\r\t\"\\") || is_comment(name))
        return tree_fault_at(
            reader->t, at,
            "the name '%.60s' holds a quote, backslash, comment or line break; leave them out",
            name);
    strcpy(to, name);
    return 0;
}

int read_name(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    if (require_kind(reader, node, TREE_SCALAR) != 0)
        return -1;
    return check_name(reader, node_text(reader, node), node_at(reader, node), to);
}

int read_text(reader *reader, int node, void *to, const void *rule)
{
    char **text = to;
    (void)rule;
    if (require_kind(reader, node, TREE_SCALAR) != 0)
        return -1;
    if (is_comment(node_text(reader, node)))
        return tree_fault(reader->t, node, "'%.60s' holds %s or %s; leave them out",
                          tree_name(reader->t, node), comment_start, comment_end);
    *text = malloc(strlen(node_text(reader, node)) + 1);
    if (!*text)
        return tree_fault(reader->t, node, "out of memory");
    strcpy(*text, node_text(reader, node));
    return 0;
}

/* Return the value that a word stands for in an array of choices, or -1 if it is not among them. */
static int find_choice(const choice *choices, const char *text)
{
    for (; choices->word; choices++)
        if (strcmp(choices->word, text) == 0)
            return choices->value;
    return -1;
}

int read_choice(reader *reader, int node, void *to, const void *rule)
{
    const choice *choices = rule;
    char cure[LIST_ROOM];
    int value;
    if (require_kind(reader, node, TREE_SCALAR) != 0)
        return -1;
    value = find_choice(choices, node_text(reader, node));
    if (value < 0) {
        suggest(node_text(reader, node), &choices->word, sizeof *choices, cure);
        return tree_fault(reader->t, node, "'%.60s: %.60s' is not known; %s",
                          tree_name(reader->t, node), node_text(reader, node), cure);
    }
    *(int *)to = value;
    return 0;
}

int read_either(reader *reader, int node, void *to, const void *rule)
{
    int value = 0;
    if (read_choice(reader, node, &value, rule) != 0)
        return -1;
    *(bool *)to = value != 0;
    return 0;
}

static const choice flags[] = {{"true", 1}, {"false", 0}, {"on", 1}, {"off", 0},
                               {"yes", 1},  {"no", 0},    {NULL, 0}};

int read_flag(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    return read_either(reader, node, to, flags);
}

int read_expr(reader *reader, int node, void *to, const void *rule)
{
    static const expr_point origin;
    expr *expression = NULL;
    if (compile(reader, node, &expression) != 0)
        return -1;
    *(expr **)to = expression;
    return expr_is_constant(expression)
               ? check_range(reader, node, expr_value(expression, &origin), rule)
               : 0;
}

void *new_items(reader *reader, int node, tree_kind kind, size_t size, int *count)
{
    void *items;
    int length;
    *count = 0;
    if (require_kind(reader, node, kind) != 0)
        return NULL;
    length = reader->t->node[node].count;
    if (length > MOST_ITEMS)
        return tree_fault(reader->t, node, "'%.60s' has %d items; at most %d are read",
                          tree_name(reader->t, node), length, MOST_ITEMS),
               NULL;
    items = calloc((size_t)length + 1, size);
    if (!items)
        return tree_fault(reader->t, node, "out of memory"), NULL;
    *count = length;
    return items;
}

int read_items(reader *reader, int node, void *items, size_t size, item_read *read, int *begun)
{
    char *item = items;
    int unused = 0, *number = begun ? begun : &unused;
    if (!items)
        return -1;
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next, item += size) {
        ++*number;
        if (read(reader, i, item) != 0)
            return -1;
    }
    return 0;
}

int read_index(reader *reader, int node, const void *items, int count, size_t size,
               const char *missing, int *index)
{
    char name[SCENE_NAME];
    if (read_name(reader, node, name, NULL) != 0)
        return -1;
    *index = find_named(items, count, size, name);
    return *index < 0 ? tree_fault(reader->t, node, missing, name) : 0;
}

/* ---- forms ------------------------------------------------------------ */

const form number_form = {.type = FORM_NUMBER};
const form above_zero_form = {.type = FORM_NUMBER, .range = &above_zero};
const form not_negative_form = {.type = FORM_NUMBER, .range = &not_negative};
const form formula_form = {.type = FORM_FORMULA};
const form name_form = {.type = FORM_NAME};
const form label_form = {.type = FORM_TEXT};
const form labels_form = {.type = FORM_LIST, .item = &label_form};
const form flag_form = {.type = FORM_WORD, .words = flags};
const form triple_form = {.type = FORM_LIST, .item = &number_form, .least = 3, .most = 3};

/*
 * Return the description (form) of a scene value that is a list of two numbers, both within the
 * permitted range `rule`.
 */
static form pair_form(const range *rule)
{
    form pair = {.type = FORM_LIST, .item = &number_form, .least = 2, .most = 2};
    if (rule == &above_zero)
        pair.item = &above_zero_form;
    if (rule == &not_negative)
        pair.item = &not_negative_form;
    return pair;
}

form field_form(const field *field)
{
    static const struct {
        field_read *read;
        form_type type;
    } basic[] = {{read_real, FORM_NUMBER}, {read_int, FORM_WHOLE},   {read_name, FORM_NAME},
                 {read_text, FORM_TEXT},   {read_choice, FORM_WORD}, {read_either, FORM_WORD},
                 {read_flag, FORM_WORD},   {read_expr, FORM_FORMULA}};
    form found = {.type = FORM_TEXT};
    if (field->form)
        return *field->form;
    if (field->read == read_pair)
        return pair_form(field->rule);
    for (size_t i = 0; i < sizeof basic / sizeof *basic; i++)
        if (field->read == basic[i].read)
            found.type = basic[i].type;
    if (found.type == FORM_WORD)
        found.words = field->read == read_flag ? flags : field->rule;
    else if (found.type != FORM_NAME && found.type != FORM_TEXT)
        found.range = field->rule;
    return found;
}

/* ---- combinations of keys --------------------------------------------- */

int case_next(const char **keys, case_item *item)
{
    const char *at = *keys + strspn(*keys, " ");
    memset(item, 0, sizeof *item);
    if (!*at)
        return 0;
    item->is_optional = *at == '?';
    at += item->is_optional;
    item->text = at;
    item->length = strcspn(at, " =");
    at += item->length;
    if (*at == '=') {
        item->words = at + 1;
        item->words_length = strcspn(item->words, " ");
        at = item->words + item->words_length;
    }
    *keys = at;
    return 1;
}

/* Return whether a list of words, joined by a separator, contains a word. */
static int has_word(const char *list, size_t length, char separator, const char *word)
{
    const size_t wanted = strlen(word);
    for (size_t start = 0; start < length;) {
        size_t end = start;
        while (end < length && list[end] != separator)
            end++;
        if (end - start == wanted && strncmp(list + start, word, wanted) == 0)
            return 1;
        start = end + 1;
    }
    return 0;
}

int case_item_has(const case_item *item, const char *key)
{
    return has_word(item->text, item->length, '|', key);
}

static int case_has(const form_case *one, const char *key)
{
    const char *keys = one->keys;
    case_item item;
    while (case_next(&keys, &item))
        if (case_item_has(&item, key))
            return 1;
    return 0;
}

/*
 * Return the permitted combination of the keys of a mapping whose key `type` has the given word as
 * its value. If there is none, the entry that ends the list is returned.
 */
static const form_case *case_of_type(const form_case *cases, const char *word)
{
    for (; cases->keys; cases++) {
        const char *keys = cases->keys;
        case_item item;
        if (case_next(&keys, &item) && item.words &&
            has_word(item.words, item.words_length, '/', word))
            break;
    }
    return cases;
}

int check_type_case(reader *reader, int node, const form_case *cases, const char *word)
{
    const form_case *const one = case_of_type(cases, word);
    const char *keys = one->keys;
    const tree_node *const nodes = reader->t->node;
    case_item item;
    while (case_next(&keys, &item)) {
        char key[SCENE_NAME];
        snprintf(key, sizeof key, "%.*s", (int)item.length, item.text);
        if (!item.is_optional && !tree_find(reader->t, node, key))
            return tree_fault(reader->t, node, "'%s' is missing in %.60s; a %s needs it", key,
                              tree_name(reader->t, node), word);
    }
    for (int i = nodes[node].first; i; i = nodes[i].next)
        if (!case_has(one, nodes[i].key))
            return tree_fault_at(reader->t, nodes[i].key_at,
                                 "'%s' has no meaning for a %s; remove it", nodes[i].key, word);
    return 0;
}
