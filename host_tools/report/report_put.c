/* SPDX-License-Identifier: BSD-2-Clause */
/* Writing of formatted text, numbers and tables into HTML and SVG reports. */
#include "report_put.h"
#include <math.h>
#include <stdarg.h>
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

static const char *const raised[10] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};

/*
 * Write text, which may come from the user: escaped for XML, without control characters, and with
 * its digits as superscripts if raises_digits is true.
 */
static void put_text(FILE *file, const char *text, bool raises_digits)
{
    static const char *const escaped[] = {['&'] = "&amp;",  ['<'] = "&lt;",   ['>'] = "&gt;",
                                          ['"'] = "&quot;", ['\''] = "&#39;", ['\n'] = "\n"};
    while (*text) {
        const unsigned char first = (unsigned char)*text;
        const int bytes = character_bytes((const unsigned char *)text);
        if (raises_digits && first >= '0' && first <= '9')
            fputs(raised[first - '0'], file);
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
    char text[40];
    if (!isfinite(value)) {
        const char *infinity = value < 0 ? "−∞" : "∞";
        put(file, "%s", isnan(value) ? "–" : infinity);
        return;
    }
    snprintf(text, sizeof text, "%.*g", power == digits ? digits + 1 : digits, size);
    const char *exponent = strchr(text, 'e');
    const int written = exponent ? atoi(exponent + 1) : 0;
    text[strcspn(text, "e")] = '\0';
    put(file, "%s%s", value < 0 ? "−" : "", text);
    if (!exponent)
        return;
    fputs(written < 0 ? "×10⁻" : "×10", file);
    snprintf(text, sizeof text, "%d", abs(written));
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

/*
 * Write one number in the way that a directive of the function put demands: %n as a plain number,
 * %q with its unit, %b with a bar.
 */
static void put_value(FILE *file, char directive, double value, va_list *more)
{
    const bool has_most = directive == 'a' || directive == 'b';
    const double most = has_most ? va_arg(*more, double) : value;
    switch (directive) {
    case 'a':
    case 'q': put_quantity(file, value, most, va_arg(*more, const char *)); break;
    case 'b':
        put(file, "%p<span class=\"bar\" aria-hidden=\"true\"><i style=\"width:%f%%\"></i></span>",
            value, fmin(100 * value / most, 100));
        break;
    case 'f': fprintf(file, "%.1f", isfinite(value) ? value : 0); break;
    case 'n': put_number(file, value, 4); break;
    case 'r': put_number(file, value < 0 ? (double)NAN : value, 2); break;
    default: put_number(file, 100 * value, 3); fputs(isnan(value) ? "" : "\xc2\xa0%", file);
    }
}

static void put_directive(FILE *file, char directive, va_list *more)
{
    const double *limit = directive == 'l' ? va_arg(*more, const double *) : NULL;
    switch (directive) {
    case 't': put_text(file, va_arg(*more, const char *), false); break;
    case 's': fputs(va_arg(*more, const char *), file); break;
    case 'd': fprintf(file, "%d", va_arg(*more, int)); break;
    case 'l': put_limits(file, limit, va_arg(*more, const char *)); break;
    case 'u': put_unit_name(file, va_arg(*more, const char *)); break;
    case '%': fputc('%', file); break;
    default: put_value(file, directive, va_arg(*more, double), more);
    }
}

/*
 * Write the opening tag of a cell of an HTML table. Returns the text of the cell, without the first
 * character if that stands for the alignment of the cell.
 */
static const char *open_cell(FILE *file, const char *tag, const char *at)
{
    static const char *const style[] = {"", " class=\"word\"", " class=\"note\""};
    const int aligned = *at == '~' ? 2 : *at == '<';
    fprintf(file, "<%s%s>", tag, style[aligned]);
    return at + (aligned > 0);
}

/*
 * HTML tag of the cells in the heading row of a table, where all cells have this tag. In any other
 * row the first cell has the tag that is given, and the following cells have td.
 */
static const char *const head_cell = "th scope=\"col\"";

void put_list(FILE *file, const char *format, const char *cell, va_list *more)
{
    while (*format) {
        const char c = *format++;
        if (c == '%') {
            put_directive(file, *format++, more);
        } else if (c == '|' && cell) {
            fprintf(file, "</%.2s>", cell);
            cell = strcmp(cell, head_cell) == 0 ? head_cell : "td";
            format = open_cell(file, cell, format);
        } else {
            fputc(c, file);
        }
    }
}

void put(FILE *file, const char *format, ...)
{
    va_list more;
    va_start(more, format);
    put_list(file, format, NULL, &more);
    va_end(more);
}

void put_row(FILE *file, const char *format, ...)
{
    va_list more;
    fputs("<tr><th scope=\"row\">", file);
    va_start(more, format);
    put_list(file, format, "th", &more);
    va_end(more);
    fputs("</td></tr>\n", file);
}

void put_table(FILE *file, const char *caption, const char *head, ...)
{
    va_list more;
    va_start(more, head);
    fputs("<figure class=\"table\"><figcaption>", file);
    put_list(file, caption, NULL, &more);
    fputs("</figcaption><div class=\"wide\" tabindex=\"0\"><table><thead><tr>", file);
    if (*head) {
        put_list(file, open_cell(file, head_cell, head), head_cell, &more);
        fputs("</th>", file);
    }
    va_end(more);
    fputs("</tr></thead><tbody>\n", file);
}

void put_table_end(FILE *file)
{
    fputs("</tbody></table></div></figure>\n", file);
}
