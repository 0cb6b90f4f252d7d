/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * JSON schema of scenes (schema.h). A `form` describes the values that a key of the scene file
 * accepts, such as numbers in a range, one of several words, or a mapping. Each form becomes a JSON
 * schema of these values.
 */
#include "schema.h"
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include "../scene/scene_fields.h"
#include "../scene/scene_units.h"
#include "../text/json.h"

/*
 * Largest magnitude of a number that the scene reader accepts, where the key of the scene sets no
 * narrower limit.
 */
static const double largest_number = 1e60;

static void write_form(json *json, const form *form);

/* ---- numbers and words ------------------------------------------------ */

static void write_limit(json *json, bool is_low, const range *range)
{
    const double limit = is_low ? range->low : range->high;
    const char *const name = is_low ? "minimum" : "maximum";
    const char *const strict_name = is_low ? "exclusiveMinimum" : "exclusiveMaximum";
    const bool is_open = fabs(limit) > largest_number;
    const double bound = is_low ? -largest_number : largest_number;
    const double value = is_open ? bound : limit;
    json_number(json, range->strict && !is_open ? strict_name : name, value);
}

/* Write the schema of a number: either a plain number, or a text that is a formula. */
static void write_number(json *json, const char *type, const range *rule)
{
    static const range any = {-HUGE_VAL, HUGE_VAL, 0, NULL};
    json_open_line(json, "anyOf", '[');
    json_open(json, NULL, '{');
    json_string(json, "type", type);
    write_limit(json, true, rule ? rule : &any);
    write_limit(json, false, rule ? rule : &any);
    json_close(json, '}');
    json_open(json, NULL, '{');
    json_string(json, "type", "string");
    json_number(json, "minLength", 1);
    json_close(json, '}');
    json_close(json, ']');
}

/* Write the schema of a text, which YAML may also take for a number or a boolean. */
static void write_text(json *json, bool is_name)
{
    json_open_line(json, "type", '[');
    json_string(json, NULL, "string");
    json_string(json, NULL, "number");
    json_string(json, NULL, "boolean");
    json_close(json, ']');
    if (!is_name)
        return;
    json_number(json, "minLength", 1);
    json_number(json, "maxLength", SCENE_NAME - 1);
}

/*
 * Write a permitted word to the schema, also as the number or boolean for which YAML may take the
 * word.
 */
static void write_word(json *json, const char *word)
{
    static const char *const yes[] = {"true", "on", "yes", NULL};
    static const char *const no[] = {"false", "off", "no", NULL};
    char *end;
    const double value = strtod(word, &end);
    json_string(json, NULL, word);
    if (end != word && !*end && *word != '+')
        json_number(json, NULL, value);
    if (strcmp(word, yes[0]) == 0)
        json_bool(json, NULL, 1);
    if (strcmp(word, no[0]) == 0)
        json_bool(json, NULL, 0);
}

/* ---- mappings --------------------------------------------------------- */

/*
 * Whether a permitted combination of keys mentions a certain key.
 *   item out  entry of the combination that mentions the key
 */
static bool find_item(const form_case *one, const char *key, case_item *item)
{
    const char *keys = one->keys;
    while (case_next(&keys, item))
        if (case_item_has(item, key))
            return true;
    return false;
}

static bool is_mentioned(const form_case *cases, const char *key)
{
    case_item item;
    for (; cases && cases->keys; cases++)
        if (find_item(cases, key, &item))
            return true;
    return false;
}

/*
 * Whether a group of keys in a scene file may contain a certain key.
 *   one in  permitted combination of keys; NULL where the group has no such combinations
 */
static bool is_permitted(const form *form, const form_case *one, const char *key)
{
    case_item item;
    return !one || find_item(one, key, &item) || !is_mentioned(form->cases, key);
}

static bool is_required(const field *field, const form_case *one)
{
    case_item item;
    if (field->required || !one)
        return field->required;
    return find_item(one, field->key, &item) && !item.is_optional &&
           !memchr(item.text, '|', item.length);
}

/*
 * Write to the JSON schema the list `enum` of the words that a key may have as its value.
 *   item in  entry of a list of permitted keys, such as "a=w/v": key a must have the value w or v
 */
static void write_item_words(json *json, const case_item *item)
{
    size_t start = 0;
    json_open_line(json, "enum", '[');
    while (start < item->words_length) {
        char word[SCENE_NAME];
        size_t end = start;
        while (end < item->words_length && item->words[end] != '/')
            end++;
        snprintf(word, sizeof word, "%.*s", (int)(end - start), item->words + start);
        write_word(json, word);
        start = end + 1;
    }
    json_close(json, ']');
}

/*
 * Write the description of a key to the JSON schema: the sentence that explains the key, and for a
 * physical quantity an example of a unit, such as "Unit as mm."
 */
static void write_description(json *json, const field *field)
{
    const char *const unit = scene_units_example(field->of);
    char text[1000];
    if (!field->help)
        return;
    snprintf(text, sizeof text, "%s", field->help);
    if (unit)
        snprintf(text, sizeof text, "%s Unit as %s.", field->help, unit);
    json_string(json, "description", text);
}

static void write_field(json *json, const field *field, const form_case *one)
{
    const form own = field_form(field);
    case_item item;
    json_open(json, field->key, '{');
    write_description(json, field);
    if (one && find_item(one, field->key, &item) && item.words)
        write_item_words(json, &item);
    else
        write_form(json, &own);
    json_close(json, '}');
}

/* Write to the schema that exactly one of the keys a, b and c of an entry "a|b|c" is required. */
static void write_alternatives(json *json, const case_item *item)
{
    size_t start = 0;
    json_open(json, NULL, '{');
    json_open_line(json, "oneOf", '[');
    while (start < item->length) {
        char key[SCENE_NAME];
        size_t end = start;
        while (end < item->length && item->text[end] != '|')
            end++;
        snprintf(key, sizeof key, "%.*s", (int)(end - start), item->text + start);
        json_open(json, NULL, '{');
        json_open_line(json, "required", '[');
        json_string(json, NULL, key);
        json_close(json, ']');
        json_close(json, '}');
        start = end + 1;
    }
    json_close(json, ']');
    json_close(json, '}');
}

static void write_required(json *json, const form *form, const form_case *one)
{
    const char *keys = one ? one->keys : "";
    case_item item;
    bool has_alternatives = false;
    int count = 0;
    for (const field *field = form->fields; field->key; field++) {
        if (!is_permitted(form, one, field->key) || !is_required(field, one))
            continue;
        if (!count++)
            json_open_line(json, "required", '[');
        json_string(json, NULL, field->key);
    }
    if (count)
        json_close(json, ']');
    while (case_next(&keys, &item)) {
        if (!memchr(item.text, '|', item.length))
            continue;
        if (!has_alternatives)
            json_open(json, "allOf", '[');
        has_alternatives = true;
        write_alternatives(json, &item);
    }
    if (has_alternatives)
        json_close(json, ']');
}

/*
 * Write the JSON schema of a YAML mapping: its permitted keys, and those of them that are required.
 *   one in  the combination of keys that is described, where a mapping has several permitted
 *       combinations, such as one for each value of the key `type`; NULL: all keys are permitted
 */
static void write_object(json *json, const form *form, const form_case *one)
{
    json_string(json, "type", "object");
    if (one && one->help)
        json_string(json, "description", one->help);
    json_open(json, "properties", '{');
    for (const field *field = form->fields; field->key; field++)
        if (is_permitted(form, one, field->key))
            write_field(json, field, one);
    json_close(json, '}');
    json_bool(json, "additionalProperties", 0);
    write_required(json, form, one);
}

static void write_map(json *json, const form *form)
{
    if (!form->cases || !form->cases[1].keys) {
        write_object(json, form, form->cases);
        return;
    }
    json_open(json, "oneOf", '[');
    for (const form_case *one = form->cases; one->keys; one++) {
        json_open(json, NULL, '{');
        write_object(json, form, one);
        json_close(json, '}');
    }
    json_close(json, ']');
}

/* ---- the whole -------------------------------------------------------- */

static void write_list(json *json, const form *form)
{
    json_string(json, "type", "array");
    if (form->first) {
        json_open(json, "prefixItems", '[');
        json_open(json, NULL, '{');
        write_form(json, form->first);
        json_close(json, '}');
        json_close(json, ']');
    }
    json_open(json, "items", '{');
    write_form(json, form->item);
    json_close(json, '}');
    if (form->least)
        json_number(json, "minItems", form->least);
    if (form->most)
        json_number(json, "maxItems", form->most);
}

static void write_named(json *json, const form *form)
{
    json_string(json, "type", "object");
    json_open(json, "additionalProperties", '{');
    write_form(json, form->item);
    json_close(json, '}');
    if (form->least)
        json_number(json, "minProperties", form->least);
}

static void write_any(json *json, const form *form)
{
    json_open(json, "anyOf", '[');
    for (int i = 0; form->any[i]; i++) {
        json_open(json, NULL, '{');
        write_form(json, form->any[i]);
        json_close(json, '}');
    }
    json_close(json, ']');
}

static void write_words(json *json, const choice *words)
{
    json_open_line(json, "enum", '[');
    for (; words->word; words++)
        write_word(json, words->word);
    json_close(json, ']');
}

/* Write the members of the JSON schema of a value in a scene file into an open JSON object. */
static void write_form(json *json, const form *form)
{
    switch (form->type) {
    case FORM_NUMBER:
        if (form->range)
            write_number(json, "number", form->range);
        else
            json_string(json, "$ref", "#/$defs/number");
        break;
    case FORM_WHOLE: write_number(json, "integer", form->range); break;
    case FORM_FORMULA:
        if (form->range)
            write_number(json, "number", form->range);
        else
            json_string(json, "$ref", "#/$defs/formula");
        break;
    case FORM_NAME: write_text(json, true); break;
    case FORM_TEXT: write_text(json, false); break;
    case FORM_WORD: write_words(json, form->words); break;
    case FORM_LIST: write_list(json, form); break;
    case FORM_MAP: write_map(json, form); break;
    case FORM_NAMED: write_named(json, form); break;
    case FORM_ANY: write_any(json, form); break;
    }
}

static void write_definition(json *json, const char *name, const char *description)
{
    json_open(json, name, '{');
    json_string(json, "description", description);
    write_number(json, "number", NULL);
    json_close(json, '}');
}

void schema_write(FILE *file)
{
    json json = {.file = file};
    json_open(&json, NULL, '{');
    json_string(&json, "$schema", "https://json-schema.org/draft/2020-12/schema");
    json_string(&json, "$comment", "Made by pzs schema from the tables of keys of the reader.");
    json_string(&json, "title", "piezoshape scene");
    json_string(&json, "description",
                "A piezoelectric shell, its loads, electrodes and target, in any consistent set of "
                "units. Coordinates that are angles are in radians, angles of plies and cones in "
                "degrees.");
    write_form(&json, &scene_form);
    json_open(&json, "$defs", '{');
    write_definition(&json, "number",
                     "A number, a constant formula with + - * / ^ ( ) pi and functions, or a plain "
                     "number with a unit (m N V K Pa C F s Hz kg g t rad deg, SI prefixes, powers, "
                     "quotients), where the scene has units.");
    write_definition(&json, "formula",
                     "A number or a formula of x, y, z, theta1, theta2 with + - * / ^ ( ) pi sin "
                     "cos tan asin acos atan sqrt exp log abs min max atan2 pow hypot, and "
                     "zernike(j, rho, phi) of Noll's number j and root mean square 1 over the unit "
                     "disc; or a plain number with a unit.");
    json_close(&json, '}');
    json_close(&json, '}');
}
