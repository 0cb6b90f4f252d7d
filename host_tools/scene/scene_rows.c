/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Limits that combine the voltages of several amplifiers: their differences (key
 * limits.difference), their sums (limits.sum), and weighted sums of their absolute values
 * (limits.absolute_sum).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "scene_fields.h"
#include "scene_parts.h"

/*
 * Append a limit of a weighted sum of voltages to the scene, before the limits of sums of absolute
 * values.
 *   count  in  number of voltages in the sum
 * Returns the limit with coefficients of 1, whose amplifiers the caller has to fill in, or NULL
 * after writing an error message about the scene file.
 */
static scene_limit_row *add_row(reader *reader, int node, int count, double lower, double upper)
{
    scene_limits *limits = &reader->s->limits;
    scene_limit_row *rows = realloc(limits->row, ((size_t)limits->rows + 1) * sizeof *limits->row);
    limits->row = rows ? rows : limits->row;
    const int place = limits->rows - limits->absolute_rows;
    scene_limit_row *row = rows ? &rows[place] : NULL;
    int *amplifier = malloc(((size_t)count + 1) * sizeof *amplifier);
    double *factor = malloc(((size_t)count + 1) * sizeof *factor);
    if (!row || !amplifier || !factor) {
        free(amplifier);
        free(factor);
        (void)tree_fault(reader->t, node, "out of memory");
        return NULL;
    }
    for (int i = 0; i < count; i++)
        factor[i] = 1;
    memmove(row + 1, row, (size_t)limits->absolute_rows * sizeof *row);
    *row = (scene_limit_row){.count = count,
                             .amplifier = amplifier,
                             .factor = factor,
                             .lower = lower,
                             .upper = upper,
                             .at = node_at(reader, node)};
    limits->rows++;
    return row;
}

/*
 * Limit the difference of the voltages of two amplifiers. Returns 0, or -1 after writing the error
 * message.
 */
static int add_difference(reader *reader, int node, int left, int right, double limit)
{
    if (left == right)
        return tree_fault(reader->t, node, "a difference needs two different amplifiers");
    scene_limit_row *row = add_row(reader, node, 2, -limit, limit);
    if (!row)
        return -1;
    row->amplifier[0] = left;
    row->amplifier[1] = right;
    row->factor[1] = -1;
    return 0;
}

/* ---- limits of differences of voltages ------------------------------------- */

typedef struct difference_text {
    double limit;
    int *list; /* [count] indices of amplifiers in the order of the scene file; the difference of
                  the voltages of each two successive ones is limited */
    int count, neighbours;
} difference_text;

static int read_chain_names(reader *reader, int node, void *to, const void *rule)
{
    difference_text *text = to;
    (void)rule;
    return read_amplifier_names(reader, node, &text->list, &text->count);
}

static int read_neighbours(reader *reader, int node, void *to, const void *rule)
{
    difference_text *text = to;
    (void)rule;
    text->neighbours = node;
    if (reader->t->node[node].kind != TREE_SCALAR || strcmp(node_text(reader, node), "chain") == 0)
        return 0;
    return tree_fault(reader->t, node,
                      "neighbours: '%.60s' is neither the word chain nor a list of pairs "
                      "[[a, b], ...]",
                      node_text(reader, node));
}

static const range above_nothing = {0, HUGE_VAL, 1, "must be above 0"};
static const form limit_form = {.type = FORM_NUMBER, .range = &above_nothing};
static const choice chain_words[] = {{"chain", 0}, {NULL, 0}};
static const form chain_form = {.type = FORM_WORD, .words = chain_words};
static const form pair_form = {.type = FORM_LIST, .item = &label_form, .least = 2, .most = 2};
static const form pairs_form = {.type = FORM_LIST, .item = &pair_form};
static const form *const neighbours_forms[] = {&chain_form, &pairs_form, NULL};
static const form neighbours_form = {.type = FORM_ANY, .any = neighbours_forms};

static const field difference_fields[] = {
    {"limit", read_real, offsetof(difference_text, limit), &above_nothing, 1, .of = OF_VOLTAGE,
     .form = &limit_form, .help = "Largest difference of the voltages of two neighbours."},
    {"neighbours", read_neighbours, .form = &neighbours_form,
     .help = "chain: each amplifier and the next one (default); or pairs of names [[a, b], ...]."},
    {"actuators", read_chain_names, .form = &labels_form,
     .help = "Actuators or amplifiers of the chain, in its order; default: all."},
    {.key = NULL}};
const form difference_form = {.type = FORM_MAP, .fields = difference_fields};

/* Add the limit of the difference of the voltages of one pair of amplifiers or actuators. */
static int add_pair(reader *reader, int node, double limit)
{
    int *list = NULL, count = 0;
    int failed = read_amplifier_names(reader, node, &list, &count);
    if (failed == 0 && count != 2)
        failed = tree_fault(reader->t, node,
                            "a pair names two single amplifiers, and this list has %d", count);
    if (failed == 0)
        failed = add_difference(reader, node, list[0], list[1], limit);
    free(list);
    return failed;
}

static int add_pairs(reader *reader, const difference_text *text)
{
    for (int i = reader->t->node[text->neighbours].first; i; i = reader->t->node[i].next)
        if (add_pair(reader, i, text->limit) != 0)
            return -1;
    return 0;
}

static int add_chain(reader *reader, int node, const difference_text *text)
{
    const int count = text->list ? text->count : reader->s->amplifiers;
    for (int i = 0; i + 1 < count; i++) {
        const int left = text->list ? text->list[i] : i;
        const int right = text->list ? text->list[i + 1] : i + 1;
        if (add_difference(reader, node, left, right, text->limit) != 0)
            return -1;
    }
    if (count >= 2)
        return 0;
    return tree_fault(reader->t, node, "a chain of neighbours needs two amplifiers or more");
}

int read_difference(reader *reader, int node, void *to, const void *rule)
{
    difference_text text;
    (void)to;
    (void)rule;
    memset(&text, 0, sizeof text);
    int failed = read_map(reader, node, difference_fields, &text);
    const bool has_pairs = text.neighbours && reader->t->node[text.neighbours].kind != TREE_SCALAR;
    if (failed == 0 && has_pairs && text.list)
        failed = tree_fault(reader->t, node,
                            "'actuators' gives the order of a chain; leave it out beside pairs");
    if (failed == 0)
        failed = has_pairs ? add_pairs(reader, &text) : add_chain(reader, node, &text);
    free(text.list);
    return failed;
}

/*
 * Check that no amplifier occurs twice in a list [count] of amplifiers whose voltages form a sum.
 * Returns 0, or -1 after writing the error message.
 */
static int refuse_repeated(reader *reader, int node, const int *list, int count)
{
    for (int i = 1; list && i < count; i++)
        for (int k = 0; k < i; k++)
            if (list[k] == list[i])
                return tree_fault(reader->t, node,
                                  "item %d of 'actuators' repeats an amplifier of the sum; name "
                                  "each once",
                                  i + 1);
    return 0;
}

/* ---- limits of sums of voltages ------------------------------------------------ */

typedef struct sum_text {
    double voltage[2];
    int *list; /* [count] indices of the amplifiers whose voltages are summed; the sum has a lower
                  and an upper limit */
    int count;
} sum_text;

static int read_sum_names(reader *reader, int node, void *to, const void *rule)
{
    sum_text *text = to;
    (void)rule;
    return read_amplifier_names(reader, node, &text->list, &text->count);
}

static const form range_form = {.type = FORM_LIST, .item = &number_form, .least = 2, .most = 2};

static const field sum_fields[] = {{"voltage", read_pair, offsetof(sum_text, voltage),
                                    .required = 1, .of = OF_VOLTAGE, .form = &range_form,
                                    .help = "Limits [lowest, highest] of the sum of the voltages."},
                                   {"actuators", read_sum_names, .form = &labels_form,
                                    .help = "Actuators or amplifiers of the sum; default: all."},
                                   {.key = NULL}};
const form sum_form = {.type = FORM_MAP, .fields = sum_fields};

int read_sum(reader *reader, int node, void *to, const void *rule)
{
    sum_text text;
    (void)to;
    (void)rule;
    memset(&text, 0, sizeof text);
    int failed = read_map(reader, node, sum_fields, &text);
    if (failed == 0 && text.voltage[0] >= text.voltage[1])
        failed = tree_fault(reader->t, node, "sum from %g to %g is empty; write [lowest, highest]",
                            text.voltage[0], text.voltage[1]);
    if (failed == 0)
        failed = refuse_repeated(reader, node, text.list, text.count);
    const int count = text.list ? text.count : reader->s->amplifiers;
    scene_limit_row *row =
        failed == 0 ? add_row(reader, node, count, text.voltage[0], text.voltage[1]) : NULL;
    for (int i = 0; row && i < count; i++)
        row->amplifier[i] = text.list ? text.list[i] : i;
    free(text.list);
    return row ? 0 : -1;
}

/* ---- limits of sums of absolute values of voltages ------------------------------- */

typedef struct absolute_text {
    double limit;
    int *list;      /* [count] indices of the amplifiers whose voltages enter, as absolute values, a
                       weighted sum with an upper limit */
    double *weight; /* [weights] weights of the amplifiers in a limited sum of voltages: the sum,
                       over the amplifiers in `list`, of weight times absolute voltage has the upper
                       limit `limit` */
    int count, weights;
} absolute_text;

static int read_absolute_names(reader *reader, int node, void *to, const void *rule)
{
    absolute_text *text = to;
    (void)rule;
    return read_amplifier_names(reader, node, &text->list, &text->count);
}

static int read_weight(reader *reader, int node, void *item)
{
    static const range above_zero = {0, HUGE_VAL, 1, "must be above 0"};
    return read_real(reader, node, item, &above_zero);
}

static int read_weights(reader *reader, int node, void *to, const void *rule)
{
    absolute_text *text = to;
    (void)rule;
    text->weight = new_items(reader, node, TREE_LIST, sizeof *text->weight, &text->weights);
    return read_items(reader, node, text->weight, sizeof *text->weight, read_weight, NULL);
}

static const form weights_form = {.type = FORM_LIST, .item = &above_zero_form, .least = 1};

static const field absolute_fields[] = {
    {"limit", read_real, offsetof(absolute_text, limit), &above_nothing, 1, .of = OF_VOLTAGE,
     .form = &limit_form, .help = "Largest weighted sum of the absolute values of the voltages."},
    {"actuators", read_absolute_names, .form = &labels_form,
     .help = "Actuators or amplifiers of the sum; default: all."},
    {"weights", read_weights, .of = OF_NUMBER, .form = &weights_form,
     .help = "Weight of each of these amplifiers, in their order; default: 1."},
    {.key = NULL}};
static const form one_absolute_form = {.type = FORM_MAP, .fields = absolute_fields};
static const form absolutes_form = {.type = FORM_LIST, .item = &one_absolute_form, .least = 1};
static const form *const absolute_forms[] = {&one_absolute_form, &absolutes_form, NULL};
const form absolute_sum_form = {.type = FORM_ANY, .any = absolute_forms};

/*
 * Add the limit of a weighted sum of absolute values of voltages, which a YAML node describes, to
 * the scene.
 */
static int add_absolute(reader *reader, int node, const absolute_text *text)
{
    const int count = text->list ? text->count : reader->s->amplifiers;
    if (text->weight && text->weights != count)
        return tree_fault(reader->t, node, "%d weights for %d amplifiers; give one weight for each",
                          text->weights, count);
    scene_limit_row *row = add_row(reader, node, count, -HUGE_VAL, text->limit);
    if (!row)
        return -1;
    for (int i = 0; i < count; i++) {
        row->amplifier[i] = text->list ? text->list[i] : i;
        row->factor[i] = text->weight ? text->weight[i] : 1;
    }
    row->is_absolute = true;
    return 0;
}

static int read_one_absolute(reader *reader, int node)
{
    absolute_text text;
    memset(&text, 0, sizeof text);
    int failed = read_map(reader, node, absolute_fields, &text);
    if (failed == 0)
        failed = refuse_repeated(reader, node, text.list, text.count);
    if (failed == 0)
        failed = add_absolute(reader, node, &text);
    free(text.list);
    free(text.weight);
    return failed;
}

int read_absolute_sum(reader *reader, int node, void *to, const void *rule)
{
    scene_limits *limits = &reader->s->limits;
    const tree_node *item = &reader->t->node[node];
    const int before = limits->rows;
    int failed = 0;
    (void)to;
    (void)rule;
    if (item->kind != TREE_LIST)
        failed = read_one_absolute(reader, node);
    else if (!item->first)
        failed = tree_fault(reader->t, node, "an empty list; leave the key out");
    for (int i = item->kind == TREE_LIST ? item->first : 0; i && failed == 0;
         i = reader->t->node[i].next)
        failed = read_one_absolute(reader, i);
    limits->absolute_rows = limits->rows - before;
    return failed;
}

/* ---- blocks of the control loop that cannot keep limits between amplifiers ----- */

int scene_check_rows(const scene *scene, char *error)
{
    const struct {
        bool is_given;
        const char *key, *reason;
    } other[] = {
        {scene->hysteresis.given, "hysteresis", "chooses effects, not voltages"},
        {scene->simulate.detects_faults, "detected faults (simulate.events)",
         "test single amplifiers"},
        {scene->safety.amplitude > 0, "safety.selftest", "moves one amplifier after the other"},
        {scene->control.moving_target, "control.moving_target", "has no limits between amplifiers"},
    };
    for (size_t k = 0; k < sizeof other / sizeof *other && scene->limits.rows > 0; k++)
        if (other[k].is_given)
            return scene_fault(scene->limits.row[0].at, error,
                               "limits.difference, limits.sum and limits.absolute_sum do not go "
                               "together with %s, which %s; leave one of them out",
                               other[k].key, other[k].reason);
    return 0;
}
