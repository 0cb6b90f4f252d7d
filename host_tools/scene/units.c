/* SPDX-License-Identifier: BSD-2-Clause */
/* Parsing and conversion of units of measurement (units.h). */
#include "units.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_EXPONENT = 9999 };

/*
 * Symbol of a unit of measurement, such as m or Pa; `prefixed` tells whether it may have an SI
 * prefix.
 */
typedef struct symbol {
    const char *text;
    units_unit unit;
    bool prefixed;
} symbol;

/*
 * Symbols of units, each with its powers of the base units m, N, V, K, s and rad, its power of ten,
 * and its power of pi/180 (1 for the degree).
 */
static const symbol symbols[] = {
    {"m", {{1, 0, 0, 0, 0, 0}, 0, 0}, 1},   {"N", {{0, 1, 0, 0, 0, 0}, 0, 0}, 1},
    {"V", {{0, 0, 1, 0, 0, 0}, 0, 0}, 1},   {"K", {{0, 0, 0, 1, 0, 0}, 0, 0}, 1},
    {"s", {{0, 0, 0, 0, 1, 0}, 0, 0}, 1},   {"rad", {{0, 0, 0, 0, 0, 1}, 0, 0}, 1},
    {"deg", {{0, 0, 0, 0, 0, 1}, 0, 1}, 0}, {"Hz", {{0, 0, 0, 0, -1, 0}, 0, 0}, 1},
    {"Pa", {{-2, 1, 0, 0, 0, 0}, 0, 0}, 1}, {"C", {{1, 1, -1, 0, 0, 0}, 0, 0}, 1},
    {"F", {{1, 1, -2, 0, 0, 0}, 0, 0}, 1},  {"g", {{-1, 1, 0, 0, 2, 0}, -3, 0}, 1},
    {"t", {{-1, 1, 0, 0, 2, 0}, 3, 0}, 0},
};

typedef struct prefix {
    const char *text;
    int ten;
} prefix;

static const prefix prefixes[] = {
    {"f", -15}, {"p", -12}, {"n", -9}, {"u", -6}, {"\xc2\xb5", -6}, {"\xce\xbc", -6}, {"m", -3},
    {"c", -2},  {"d", -1},  {"k", 3},  {"M", 6},  {"G", 9},         {"T", 12},
};

typedef struct parser {
    const char *at;
    const char *why;
    units_unit unit;
} parser;

static int fault(parser *parser, const char *why)
{
    parser->why = why;
    return -1;
}

static void skip_blanks(parser *parser)
{
    while (*parser->at == ' ')
        parser->at++;
}

/* ---- factors of a unit ------------------------------------------------ */

static const symbol *find_symbol(const char *text, size_t length)
{
    for (size_t i = 0; i < sizeof symbols / sizeof *symbols; i++)
        if (strlen(symbols[i].text) == length && strncmp(symbols[i].text, text, length) == 0)
            return &symbols[i];
    return NULL;
}

/*
 * Find the symbol of a unit with or without an SI prefix, and write the power of ten of the prefix
 * to *ten. A symbol without a prefix has priority, so that m is the metre and not a prefix. Returns
 * NULL if there is none.
 */
static const symbol *find_unit(const char *text, size_t length, int *ten)
{
    const symbol *found = find_symbol(text, length);
    *ten = 0;
    for (size_t i = 0; !found && i < sizeof prefixes / sizeof *prefixes; i++) {
        const size_t head = strlen(prefixes[i].text);
        if (head >= length || strncmp(prefixes[i].text, text, head) != 0)
            continue;
        found = find_symbol(text + head, length - head);
        if (found && !found->prefixed)
            found = NULL;
        *ten = prefixes[i].ten;
    }
    return found;
}

/*
 * Read the integer power of a unit: digits, or '^' and an integer with an optional sign; without
 * either, the power is 1.
 */
static int take_power(parser *parser, int *power)
{
    int sign = 1;
    *power = 1;
    if (*parser->at == '^') {
        parser->at++;
        if (*parser->at == '-')
            sign = -1;
        if (*parser->at == '-' || *parser->at == '+')
            parser->at++;
        if (!isdigit((unsigned char)*parser->at))
            return fault(parser, "a power is a whole number, as m^2");
    }
    if (!isdigit((unsigned char)*parser->at))
        return 0;
    *power = sign * (*parser->at - '0');
    parser->at++;
    if (*power == 0 || isdigit((unsigned char)*parser->at))
        return fault(parser, "a power of a unit runs from 1 to 9");
    return 0;
}

/*
 * Read one factor of a unit and multiply the unit read so far by it; `sign` is -1 for a factor
 * after a '/', else 1.
 */
static int take_factor(parser *parser, int sign)
{
    const char *const start = parser->at;
    int ten, power;
    while (isalpha((unsigned char)*parser->at) || (unsigned char)*parser->at >= 0x80)
        parser->at++;
    if (parser->at == start)
        return fault(parser, "the name of a unit is missing");
    const symbol *found = find_unit(start, (size_t)(parser->at - start), &ten);
    if (!found)
        return fault(parser,
                     strncmp(start, "degC", 4) == 0
                         ? "a temperature is a difference to the undeformed state; give it in K"
                         : "known are m N V K Pa C F s Hz kg g t rad deg, with SI prefixes, "
                           "powers and quotients");
    if (take_power(parser, &power) < 0)
        return -1;
    power *= sign;
    for (int i = 0; i < UNITS_BASES; i++)
        parser->unit.power[i] += power * found->unit.power[i];
    parser->unit.ten += power * (found->unit.ten + ten);
    parser->unit.degrees += power * found->unit.degrees;
    return 0;
}

/* ---- products and quotients of units ---------------------------------- */

/*
 * Return whether another factor follows in the text of a product of units, and skip the
 * multiplication sign before it.
 */
static int another(parser *parser)
{
    skip_blanks(parser);
    if (*parser->at == '*' || *parser->at == '.') {
        parser->at++;
        skip_blanks(parser);
        return 1;
    }
    return isalpha((unsigned char)*parser->at) || (unsigned char)*parser->at >= 0x80;
}

static int take_product(parser *parser, int sign)
{
    do {
        if (take_factor(parser, sign) < 0)
            return -1;
    } while (another(parser));
    return 0;
}

/* Read a divisor, the part of a unit after a '/': one factor, or a product in parentheses. */
static int take_divisor(parser *parser)
{
    if (*parser->at != '(') {
        if (take_factor(parser, -1) < 0)
            return -1;
        return another(parser) ? fault(parser, "a product after '/' needs brackets, as C/(m2 K)")
                               : 0;
    }
    parser->at++;
    if (take_product(parser, -1) < 0)
        return -1;
    if (*parser->at != ')')
        return fault(parser, "a ')' is missing");
    parser->at++;
    skip_blanks(parser);
    return 0;
}

int units_parse(const char *text, units_unit *unit, const char **why)
{
    parser parser;
    memset(&parser, 0, sizeof parser);
    parser.at = text;
    int failed = 0;
    if (parser.at[0] == '1' && strchr(" /", parser.at[1])) {
        parser.at++;
        skip_blanks(&parser);
        failed = *parser.at == '/' ? 0 : fault(&parser, "a '/' is missing after 1");
    } else if (*parser.at != '/') {
        failed = take_product(&parser, 1);
    }
    while (!failed && *parser.at == '/') {
        parser.at++;
        skip_blanks(&parser);
        failed = take_divisor(&parser);
    }
    if (!failed && *parser.at)
        failed = fault(&parser, "a unit reads as N, mm2, N/m2 or C/(m2 K)");
    if (failed)
        *why = parser.why;
    else
        *unit = parser.unit;
    return failed;
}

int units_alike(const units_unit *first, const units_unit *second)
{
    return memcmp(first->power, second->power, sizeof first->power) == 0;
}

/* ---- numbers in front of a unit --------------------------------------- */

static const char *skip_digits(const char *at)
{
    while (isdigit((unsigned char)*at))
        at++;
    return at;
}

/*
 * Return the end of the mantissa of a plain number that starts at `at`, or `at` itself if there is
 * no number.
 */
static const char *skip_mantissa(const char *at)
{
    const char *const first = *at == '-' || *at == '+' ? at + 1 : at;
    const char *const whole = skip_digits(first);
    const char *const end = *whole == '.' ? skip_digits(whole + 1) : whole;
    const int digits = (int)(end - first) - (*whole == '.');
    return digits > 0 ? end : at;
}

/*
 * Return the end of a decimal exponent that starts at `at`, or `at` itself if there is none; in "3
 * e" the e is the name of a unit.
 */
static const char *skip_exponent(const char *at)
{
    if (*at != 'e' && *at != 'E')
        return at;
    const char *const first = at[1] == '-' || at[1] == '+' ? at + 2 : at + 1;
    return isdigit((unsigned char)*first) ? skip_digits(first) : at;
}

const char *units_suffix(const char *text, size_t *length)
{
    const char *const mantissa = skip_mantissa(text);
    if (mantissa == text)
        return NULL;
    const char *const end = skip_exponent(mantissa);
    const char *at = end;
    while (*at == ' ')
        at++;
    *length = (size_t)(end - text);
    if (strncmp(text, "0x", 2) == 0 || strncmp(text, "0X", 2) == 0)
        return NULL;
    if (at > end && at[0] == '1' && at[1] == '/')
        return at;
    return isalpha((unsigned char)*at) || (unsigned char)*at >= 0x80 ? at : NULL;
}

int units_shift(const char *number, size_t length, int ten, char text[UNITS_NUMBER])
{
    const size_t mantissa = (size_t)(skip_mantissa(number) - number);
    const long written = mantissa < length ? strtol(number + mantissa + 1, NULL, 10) : 0;
    if (length > UNITS_NUMBER / 2 || written < -MOST_EXPONENT || written > MOST_EXPONENT)
        return -1;
    if (written + ten == 0)
        snprintf(text, UNITS_NUMBER, "%.*s", (int)mantissa, number);
    else
        snprintf(text, UNITS_NUMBER, "%.*se%ld", (int)mantissa, number, written + ten);
    return 0;
}
