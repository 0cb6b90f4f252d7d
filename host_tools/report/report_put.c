/* SPDX-License-Identifier: BSD-2-Clause */
/* Writing of formatted text, numbers and tables into HTML and SVG reports. */
#include "report_put.h"
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Number of bytes of the UTF-8 character at the start of a text, or 0 if it is invalid. */
static int character_bytes(const unsigned char *text)
{
    static const unsigned char lead[5] = {0, 0, 0xc2, 0xe0, 0xf0};
    int bytes = 4;
    while (bytes > 1 && *text < lead[bytes])
        bytes--;
    for (int i = 1; i < bytes; i++)
        if ((text[i] & 0xc0) != 0x80)
            return 0;
    return (bytes == 1 && *text >= 0x80) || *text > 0xf4 ? 0 : bytes;
}

/*
 * Write text, which may come from the user, escaped for XML. If is_raised is true, digits and minus
 * signs are written as superscripts.
 */
static void put_text(FILE *file, const char *text, bool is_raised)
{
    static const char *const escaped[] = {['&'] = "&amp;",  ['<'] = "&lt;",   ['>'] = "&gt;",
                                          ['"'] = "&quot;", ['\''] = "&#39;", ['\n'] = "\n"};
    static const char *const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    while (*text) {
        const unsigned char first = (unsigned char)*text;
        const int bytes = character_bytes((const unsigned char *)text);
        if (is_raised && first >= '0' && first <= '9')
            fputs(raised[first - '0'], file);
        else if (is_raised && first == '-')
            fputs("⁻", file);
        else if (first < sizeof escaped / sizeof *escaped && escaped[first])
            fputs(escaped[first], file);
        else if (bytes == 0)
            fputc('?', file);
        else if (first >= ' ' && first != 127)
            fwrite(text, 1, (size_t)bytes, file);
        text += bytes > 0 ? bytes : 1;
    }
}

static void put_number(FILE *file, double value, int digits)
{
    const double size = fabs(value);
    const int power = size > 0 && isfinite(size) ? (int)floor(log10(size)) : 0;
    const char *sign = value < 0 ? "−" : "";
    char text[40];
    if (!isfinite(value)) {
        put(file, "%s%s", sign, isnan(value) ? "–" : "∞");
        return;
    }
    snprintf(text, sizeof text, "%.*g", power == digits ? digits + 1 : digits, size);
    const int mantissa = (int)strcspn(text, "e");
    fprintf(file, "%s%.*s", sign, mantissa, text);
    if (text[mantissa] != 'e')
        return;
    fputs("×10", file);
    snprintf(text, sizeof text, "%d", atoi(text + mantissa + 1));
    put_text(file, text, true);
}

put_unit put_unit_of(double most, const char *unit)
{
    static const struct {
        const char *name, *written;
        double metres;
    } length[] = {{"m", "m", 1},      {"mm", "mm", 1e-3}, {"um", "µm", 1e-6}, {"nm", "nm", 1e-9},
                  {"µm", "µm", 1e-6}, {"cm", "cm", 1e-2}, {"dm", "dm", 1e-1}, {"km", "km", 1e3}};
    enum { READABLE = 4, LENGTHS = sizeof length / sizeof *length };
    int known = 0, best = 0;
    while (known < LENGTHS && strcmp(unit, length[known].name) != 0)
        known++;
    if (known == LENGTHS || !(fabs(most) > 0) || !isfinite(most))
        return (put_unit){1, unit};
    const double metres = fabs(most) * length[known].metres * (1 + 1e-9);
    while (best < READABLE - 1 && metres < length[best].metres)
        best++;
    return (put_unit){length[known].metres / length[best].metres, length[best].written};
}

/* Write a space at which lines are not broken, and the name of a unit. */
static void put_unit_name(FILE *file, const char *unit)
{
    fputs(*unit ? "\xc2\xa0" : "", file);
    put_text(file, unit, true);
}

static void put_quantity(FILE *file, double value, double most, const char *name)
{
    const put_unit unit = put_unit_of(most, name);
    const bool is_zero = fabs(value) < 1e-6 * fabs(most);
    put_number(file, is_zero ? 0 : value * unit.factor, 4);
    if (!isnan(value))
        put_unit_name(file, unit.name);
}

static void put_limits(FILE *file, const double limit[2], const char *unit)
{
    if (!isfinite(limit[0]) && !isfinite(limit[1]))
        fputs("–", file);
    else if (limit[0] == -limit[1])
        put(file, "±\xc2\xa0%q", limit[1], unit);
    else
        put(file, "%n to %q", limit[0], limit[1], unit);
}

static void put_directive(FILE *file, char directive, va_list *more)
{
    const bool has_limits = directive == 'l', has_value = strchr("fnrpbqa", directive) != NULL;
    const double *limit = has_limits ? va_arg(*more, const double *) : NULL;
    const double value = has_value ? va_arg(*more, double) : 0;
    const bool has_most = directive == 'a' || directive == 'b';
    const double most = has_most ? va_arg(*more, double) : value;
    switch (directive) {
    case 't': put_text(file, va_arg(*more, const char *), false); break;
    case 's': fputs(va_arg(*more, const char *), file); break;
    case 'd': fprintf(file, "%d", va_arg(*more, int)); break;
    case 'f': fprintf(file, "%.1f", isfinite(value) ? value : 0); break;
    case 'n': put_number(file, value, 4); break;
    case 'r': put_number(file, value < 0 ? (double)NAN : value, 2); break;
    case 'p':
        put_number(file, 100 * value, 3);
        fputs(isnan(value) ? "" : "\xc2\xa0%", file);
        break;
    case 'b':
        put(file, "%p<span class=\"bar\" aria-hidden=\"true\"><i style=\"width:%f%%\"></i></span>",
            value, fmin(100 * value / most, 100));
        break;
    case 'q':
    case 'a': put_quantity(file, value, most, va_arg(*more, const char *)); break;
    case 'u': put_unit_name(file, va_arg(*more, const char *)); break;
    case 'l': put_limits(file, limit, va_arg(*more, const char *)); break;
    default: fputc(directive, file);
    }
}

void put(FILE *file, const char *format, ...)
{
    va_list more;
    va_start(more, format);
    for (; *format; format++) {
        const char mark = format[1];
        if (*format == '%') {
            put_directive(file, *++format, &more);
        } else if (*format == '|' || *format == '^') {
            fputs(*format == '^' ? "<th scope=\"col\"" : "<td", file);
            fputs(mark == '<' ? " class=\"word\"" : "", file);
            fputs(mark == '~' ? " class=\"note\">" : ">", file);
            format += mark == '<' || mark == '~';
        } else {
            fputc(*format, file);
        }
    }
    va_end(more);
}
