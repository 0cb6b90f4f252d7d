/* Units of measurement (units.h). */
#include "units.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_EXPONENT = 9999 };

/* A unit by its symbol; `prefixed` tells whether SI prefixes may stand before it. */
typedef struct symbol {
    const char *text;
    units_unit unit;
    int prefixed;
} symbol;

/* Powers of m, N, V, K, s, rad; power of ten; degrees. */
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

static int fault(parser *p, const char *why)
{
    p->why = why;
    return -1;
}

static void skip_blanks(parser *p)
{
    while (*p->at == ' ')
        p->at++;
}

/* ---- factors ---------------------------------------------------------- */

static const symbol *find_symbol(const char *text, size_t length)
{
    for (size_t i = 0; i < sizeof symbols / sizeof *symbols; i++)
        if (strlen(symbols[i].text) == length && strncmp(symbols[i].text, text, length) == 0)
            return &symbols[i];
    return NULL;
}

/* A symbol alone, or behind a prefix; ten out: power of ten of the prefix. A symbol alone goes
 * first: m is the metre. */
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

/* A whole power: digits, or '^' and a whole number with or without a sign; 1 where there is none.
 */
static int take_power(parser *p, int *power)
{
    int sign = 1;
    *power = 1;
    if (*p->at == '^') {
        p->at++;
        if (*p->at == '-')
            sign = -1;
        if (*p->at == '-' || *p->at == '+')
            p->at++;
        if (!isdigit((unsigned char)*p->at))
            return fault(p, "a power is a whole number, as m^2");
    }
    if (!isdigit((unsigned char)*p->at))
        return 0;
    *power = sign * (*p->at - '0');
    p->at++;
    if (*power == 0 || isdigit((unsigned char)*p->at))
        return fault(p, "a power of a unit runs from 1 to 9");
    return 0;
}

/* One factor, times the sign of its power: -1 behind a '/'. */
static int take_factor(parser *p, int sign)
{
    const char *const start = p->at;
    int ten, power;
    while (isalpha((unsigned char)*p->at) || (unsigned char)*p->at >= 0x80)
        p->at++;
    if (p->at == start)
        return fault(p, "the name of a unit is missing");
    const symbol *found = find_unit(start, (size_t)(p->at - start), &ten);
    if (!found)
        return fault(p, strncmp(start, "degC", 4) == 0
                            ? "a temperature is a difference to the undeformed state; give it in K"
                            : "known are m N V K Pa C F s Hz kg g t rad deg, with SI prefixes, "
                              "powers and quotients");
    if (take_power(p, &power) < 0)
        return -1;
    power *= sign;
    for (int i = 0; i < UNITS_BASES; i++)
        p->unit.power[i] += power * found->unit.power[i];
    p->unit.ten += power * (found->unit.ten + ten);
    p->unit.degrees += power * found->unit.degrees;
    return 0;
}

/* ---- products and quotients ------------------------------------------- */

/* Is there another factor of a product? Its sign of multiplication is taken. */
static int another(parser *p)
{
    skip_blanks(p);
    if (*p->at == '*' || *p->at == '.') {
        p->at++;
        skip_blanks(p);
        return 1;
    }
    return isalpha((unsigned char)*p->at) || (unsigned char)*p->at >= 0x80;
}

static int take_product(parser *p, int sign)
{
    do {
        if (take_factor(p, sign) < 0)
            return -1;
    } while (another(p));
    return 0;
}

/* What stands behind a '/': one factor, or a product in brackets. */
static int take_divisor(parser *p)
{
    if (*p->at != '(') {
        if (take_factor(p, -1) < 0)
            return -1;
        return another(p) ? fault(p, "a product behind '/' needs brackets, as C/(m2 K)") : 0;
    }
    p->at++;
    if (take_product(p, -1) < 0)
        return -1;
    if (*p->at != ')')
        return fault(p, "a ')' is missing");
    p->at++;
    skip_blanks(p);
    return 0;
}

int units_parse(const char *text, units_unit *unit, const char **why)
{
    parser p;
    memset(&p, 0, sizeof p);
    p.at = text;
    int failed = 0;
    if (p.at[0] == '1' && strchr(" /", p.at[1])) {
        p.at++;
        skip_blanks(&p);
        failed = *p.at == '/' ? 0 : fault(&p, "a '/' is missing behind 1");
    } else if (*p.at != '/') {
        failed = take_product(&p, 1);
    }
    while (!failed && *p.at == '/') {
        p.at++;
        skip_blanks(&p);
        failed = take_divisor(&p);
    }
    if (!failed && *p.at)
        failed = fault(&p, "a unit reads as N, mm2, N/m2 or C/(m2 K)");
    if (failed)
        *why = p.why;
    else
        *unit = p.unit;
    return failed;
}

int units_alike(const units_unit *a, const units_unit *b)
{
    return memcmp(a->power, b->power, sizeof a->power) == 0;
}

/* ---- numbers ---------------------------------------------------------- */

static const char *skip_digits(const char *at)
{
    while (isdigit((unsigned char)*at))
        at++;
    return at;
}

/* End of the mantissa of a plain number at `at`, or `at` itself where there is none. */
static const char *skip_mantissa(const char *at)
{
    const char *const first = *at == '-' || *at == '+' ? at + 1 : at;
    const char *const whole = skip_digits(first);
    const char *const end = *whole == '.' ? skip_digits(whole + 1) : whole;
    const int digits = (int)(end - first) - (*whole == '.');
    return digits > 0 ? end : at;
}

/* End of a decimal exponent at `at`, or `at` where none is there: the e of "3 e" belongs to a unit.
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
