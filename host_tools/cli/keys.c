/* SPDX-License-Identifier: BSD-2-Clause */
/* List of the keys of a scene file with types and help sentences (keys.h). */
#include "keys.h"
#include <math.h>
#include <string.h>
#include "../scene/scene_fields.h"
#include "../scene/scene_units.h"
#include "../text/wrap.h"

enum { KEY_COLUMN = 32, KIND_TEXT = 600 };

/*
 * Description of the type of a value in a scene file, composed piece by piece; what exceeds the
 * size of the text is cut off.
 */
typedef struct kind_text {
    char text[KIND_TEXT];
    size_t length;
} kind_text;

static void append(kind_text *to, const char *text)
{
    to->length += (size_t)snprintf(to->text + to->length, KIND_TEXT - to->length, "%s", text);
    if (to->length >= KIND_TEXT)
        to->length = KIND_TEXT - 1;
}

static void append_range(kind_text *to, const range *range)
{
    char text[80] = "";
    if (!range)
        return;
    if (isfinite(range->high))
        snprintf(text, sizeof text, range->strict ? " between %.7g and %.7g" : " from %.7g to %.7g",
                 range->low, range->high);
    else if (isfinite(range->low))
        snprintf(text, sizeof text, range->strict ? " above %.7g" : " of at least %.7g",
                 range->low);
    append(to, text);
}

static void append_words(kind_text *to, const choice *words)
{
    for (int i = 0; words[i].word; i++) {
        if (i)
            append(to, " | ");
        append(to, words[i].word);
    }
}

static void append_kind(kind_text *to, const form *form);

/* Return how many of the forms that a value may have (members of FORM_ANY) are mappings of keys. */
static int mappings_of(const form *form)
{
    int mappings = 0;
    for (int i = 0; form->any[i]; i++)
        mappings += form->any[i]->type == FORM_MAP;
    return mappings;
}

/*
 * Append to the description of a value the forms that it may have (FORM_ANY), as alternatives. If
 * more than one of them is a mapping, they appear as "one of N mappings", and their keys are listed
 * below.
 */
static void append_any(kind_text *to, const form *form)
{
    const int mappings = mappings_of(form);
    bool is_named = false;
    for (int i = 0; form->any[i]; i++) {
        const bool is_one_of_several = mappings > 1 && form->any[i]->type == FORM_MAP;
        char text[40];
        if (is_one_of_several && is_named)
            continue;
        append(to, i ? ", or " : "");
        snprintf(text, sizeof text, "one of %d mappings", mappings);
        if (is_one_of_several)
            append(to, text);
        else
            append_kind(to, form->any[i]);
        is_named = is_named || is_one_of_several;
    }
}

/*
 * Append the type of a list to the description of a value: "[number, number]" for a list of fixed
 * length, otherwise "list of number".
 */
static void append_list(kind_text *to, const form *form)
{
    if (form->most == 0 || form->most != form->least) {
        append(to, "list of ");
        append_kind(to, form->item);
        return;
    }
    for (int i = 0; i < form->most; i++) {
        append(to, i ? ", " : "[");
        append_kind(to, i == 0 && form->first ? form->first : form->item);
    }
    append(to, "]");
}

static void append_kind(kind_text *to, const form *form)
{
    switch (form->type) {
    case FORM_NUMBER: append(to, "number"); break;
    case FORM_WHOLE: append(to, "whole number"); break;
    case FORM_FORMULA: append(to, "formula"); break;
    case FORM_NAME: append(to, "name"); break;
    case FORM_TEXT: append(to, "text"); break;
    case FORM_WORD: append_words(to, form->words); break;
    case FORM_MAP: append(to, "mapping"); break;
    case FORM_LIST: append_list(to, form); break;
    case FORM_NAMED:
        append(to, "mapping of names to ");
        append_kind(to, form->item);
        break;
    case FORM_ANY: append_any(to, form); break;
    }
    append_range(to, form->range);
}

static void print_form(FILE *file, const form *form, int depth);

static void print_field(FILE *file, const field *field, int depth)
{
    const form own = field_form(field);
    const char *const unit = scene_units_example(field->of);
    kind_text kind = {"", 0};
    append_kind(&kind, &own);
    if (field->required)
        append(&kind, ", required");
    if (unit) {
        append(&kind, ", unit as ");
        append(&kind, unit);
    }
    const int width = fprintf(file, "%*s%s ", 2 * depth, "", field->key);
    fprintf(file, "%*s", width < KEY_COLUMN ? KEY_COLUMN - width : 0, "");
    wrap_print(file, kind.text, width < KEY_COLUMN ? KEY_COLUMN : width, KEY_COLUMN);
    fprintf(file, "%*s", KEY_COLUMN, "");
    wrap_print(file, field->help ? field->help : "", KEY_COLUMN, KEY_COLUMN);
    print_form(file, &own, depth + 1);
}

/* Print the keys that the value of a key may contain, where the value is itself a group of keys. */
static void print_form(FILE *file, const form *form, int depth)
{
    for (const field *field = form->type == FORM_MAP ? form->fields : NULL; field && field->key;
         field++)
        print_field(file, field, depth);
    if (form->type == FORM_LIST || form->type == FORM_NAMED)
        print_form(file, form->item, depth);
    if (form->type != FORM_ANY)
        return;
    const bool has_choice = mappings_of(form) > 1;
    const char *word = "either";
    for (int i = 0; form->any[i]; i++) {
        if (has_choice && form->any[i]->type == FORM_MAP) {
            fprintf(file, "%*s%s\n", 2 * depth, "", word);
            word = "or";
        }
        print_form(file, form->any[i], depth + has_choice);
    }
}

/*
 * Return the section of a scene file with index k, or NULL behind the last section. A scene file
 * has two forms, with a structure or with a measured influence matrix; the index counts the
 * sections of both.
 */
static const field *section_of(int k)
{
    for (int i = 0; scene_form.any[i]; i++)
        for (const field *field = scene_form.any[i]->fields; field->key; field++)
            if (k-- == 0)
                return field;
    return NULL;
}

/*
 * Return whether section number k of the list of all sections occurs earlier in the list. Reason:
 * the list holds the sections of scenes with a structure and of scenes with a measured influence
 * matrix; those of both occur twice but are printed once.
 */
static bool is_repeated(int k)
{
    const field *const own = section_of(k);
    for (int i = 0; i < k; i++)
        if (section_of(i)->read == own->read && strcmp(section_of(i)->key, own->key) == 0)
            return true;
    return false;
}

void keys_print(FILE *file, const char *section)
{
    for (int k = 0; section_of(k); k++)
        if (!is_repeated(k) && (!section || strcmp(section, section_of(k)->key) == 0))
            print_field(file, section_of(k), 0);
}

bool keys_has(const char *section)
{
    for (int k = 0; section_of(k); k++)
        if (strcmp(section_of(k)->key, section) == 0)
            return true;
    return false;
}

void keys_suggest(suggestion *near)
{
    for (int k = 0; section_of(k); k++)
        suggest_consider(near, section_of(k)->key);
}

void keys_names(FILE *file)
{
    for (int k = 0; section_of(k); k++)
        if (!is_repeated(k))
            fprintf(file, "%s%s", k ? " " : "", section_of(k)->key);
}
