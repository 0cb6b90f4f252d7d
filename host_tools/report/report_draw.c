/* SPDX-License-Identifier: BSD-2-Clause */
/* Functions that draw diagrams, axes and colour scales of reports as SVG. */
#include "report_draw.h"
#include <math.h>

void draw_begin(FILE *file, draw_type type, double width, double height, const char *title,
                const char *description)
{
    const double least = type == DRAW_CHART ? 0.8 * width : 0;
    fputs(type == DRAW_CHART ? "<div class=\"wide\" tabindex=\"0\">" : "", file);
    put(file,
        "<svg viewBox=\"0 0 %f %f\" role=\"%s\" style=\"min-width:%fpx\" aria-label=\"%t\">"
        "<title>%t</title><desc>%t</desc>\n",
        width, height, type == DRAW_IMAGE ? "img" : "group", least, title, title, description);
}

void draw_end(FILE *file, draw_type type)
{
    fputs(type == DRAW_CHART ? "</svg></div>\n" : "</svg>\n", file);
}

static bool is_place(const double at[2])
{
    return isfinite(at[0]) && isfinite(at[1]);
}

void draw_path(FILE *file, const char *style)
{
    put(file, "<path class=\"%s\" d=\"", style);
}

void draw_step(FILE *file, bool *is_drawing, const double at[2])
{
    if (is_place(at))
        put(file, *is_drawing ? "L%f %f" : "M%f %f", at[0], at[1]);
    *is_drawing = is_place(at);
}

void draw_polygon(FILE *file, const double (*at)[2], int count)
{
    bool is_drawing = false;
    for (int k = 0; k < count; k++)
        if (!is_place(at[k]))
            return;
    for (int k = 0; k < count; k++)
        draw_step(file, &is_drawing, at[k]);
    fputs(count > 2 ? "z" : "", file);
}

void draw_path_end(FILE *file)
{
    fputs("\"/>\n", file);
}

void draw_disc(FILE *file, const char *style, const double at[2], double radius)
{
    if (is_place(at))
        put(file, "<circle class=\"%s\" cx=\"%f\" cy=\"%f\" r=\"%f\"/>\n", style, at[0], at[1],
            radius);
}

void draw_text(FILE *file, const char *style, double x, double y, const char *format, ...)
{
    va_list more;
    va_start(more, format);
    put(file, "<text class=\"%s\" x=\"%f\" y=\"%f\">", style, x, y);
    put_list(file, format, NULL, &more);
    fputs("</text>\n", file);
    va_end(more);
}

void draw_name(FILE *file, double x, double top, double height, const char *name)
{
    put(file, "<text class=\"end\" style=\"font-size:%fpx\" x=\"%f\" y=\"%f\">%t</text>\n",
        fmin(height, 11), x, top + 0.8 * height, name);
}

void draw_extend(draw_scale *scale, const double *value, int count)
{
    for (int i = 0; i < count; i++)
        scale->most = fmax(scale->most, fabs(value[i]));
}

draw_scale draw_scale_of(bool is_signed, const char *unit, const double *value, int count)
{
    draw_scale scale = {is_signed, 0, unit};
    draw_extend(&scale, value, count);
    return scale;
}

int draw_level(const draw_scale *scale, double value)
{
    if (!isfinite(value))
        return -1;
    double share = scale->most > 0 ? value / scale->most : 0;
    if (scale->is_signed)
        share = (share + 1) / 2;
    return (int)lround(fmin(fmax(share, 0), 1) * (DRAW_LEVELS - 1));
}

const char *draw_class(const draw_scale *scale, int level)
{
    static char name[2][DRAW_LEVELS][16];
    if (level < 0)
        return "none";
    char *text = name[scale->is_signed][level];
    snprintf(text, sizeof name[0][0], "%c%d", scale->is_signed ? 's' : 'v', level);
    return text;
}

const char *draw_colour(const draw_scale *scale, double value)
{
    return draw_class(scale, draw_level(scale, value));
}

const char *draw_tone(const draw_scale *scale, double value)
{
    const double middle = (DRAW_LEVELS - 1) / 2.0;
    return fabs(draw_level(scale, value) - middle) > 0.53 * middle ? "strong" : "mild";
}

void draw_legend_at(FILE *file, const draw_scale *scale, double x, double y)
{
    const double width = DRAW_LEGEND_WIDTH, bar = width / DRAW_LEVELS, most = scale->most;
    const double low = scale->is_signed ? -most : 0;
    put(file, "<g transform=\"translate(%f %f)\"><g class=\"flat\">", x, y);
    for (int i = 0; i < DRAW_LEVELS; i++)
        put(file, "<path class=\"%s\" d=\"M%f 2h%fv10h-%fz\"/>", draw_class(scale, i), i * bar, bar,
            bar);
    fputs("</g>\n", file);
    draw_text(file, "", 0, 26, "%a", low, most, scale->unit);
    draw_text(file, "value", width / 2, 26, "%a", low / 2 + most / 2, most, scale->unit);
    draw_text(file, "end", width, 26, "%q", most, scale->unit);
    fputs("</g>\n", file);
}

void draw_legend(FILE *file, const draw_scale *scale)
{
    if (!(scale->most > 0) || !isfinite(scale->most)) {
        fputs("<p class=\"keys\">Zero everywhere.</p>\n", file);
        return;
    }
    fputs("<div class=\"scale\">", file);
    draw_begin(file, DRAW_IMAGE, DRAW_LEGEND_WIDTH, 32, "Colour scale",
               "Colours of the values of the picture");
    draw_legend_at(file, scale, 0, 0);
    draw_end(file, DRAW_IMAGE);
    fputs("</div>\n", file);
}

double draw_on(const draw_axis *axis, double value)
{
    double share = (value - axis->low) / (axis->high - axis->low);
    if (axis->is_log)
        share = fmin(fmax(log(value / axis->low) / log(axis->high / axis->low), 0), 1);
    return axis->from + (axis->to - axis->from) * share;
}

void draw_widen(draw_axis *axis, const double *value, int count)
{
    for (int i = 0; i < count; i++)
        if (!axis->is_log || value[i] > 0) {
            axis->low = fmin(axis->low, value[i]);
            axis->high = fmax(axis->high, value[i]);
        }
}

void draw_curve(FILE *file, const draw_axis *x, const draw_axis *y, const draw_series *series)
{
    const double part = (x->high - x->low) / series->count;
    bool is_drawing = false;
    draw_path(file, series->style);
    for (int i = 0; i < series->count; i++) {
        const double along = series->along ? series->along[i] : x->low + (i + 0.5) * part;
        const double at[2] = {draw_on(x, along), draw_on(y, series->value[i])};
        draw_step(file, &is_drawing, at);
    }
    draw_path_end(file);
}

double draw_round(double value)
{
    static const double number[4] = {1, 2, 5, 10};
    const double power = pow(10, floor(log10(value)));
    int k = 0;
    while (k < 3 && value / power > sqrt(number[k] * number[k + 1]))
        k++;
    return number[k] * power;
}

/* Draw a grid line of a diagram at a value of the axis x (is_x) or y, with its number. */
static void draw_tick(FILE *file, const draw_axis *x, const draw_axis *y, bool is_x, double value)
{
    const draw_axis *axis = is_x ? x : y;
    const double at = draw_on(axis, value);
    if (is_x)
        put(file, "<path class=\"grid\" d=\"M%f %fV%f\"/>", at, y->to, y->from);
    else
        put(file, "<path class=\"grid\" d=\"M%f %fH%f\"/>", x->from, at, x->to);
    if (is_x)
        draw_text(file, "value", at, y->from + 15, axis->format, value * axis->unit.factor);
    else
        draw_text(file, "end", x->from - 6, at + 4, axis->format, value * axis->unit.factor);
}

/*
 * Return the value at which the axis of a diagram has its tick mark number `index`; the first marks
 * may lie below the range of the axis.
 */
static double tick_value(const draw_axis *axis, int index)
{
    static const double number[3] = {1, 2, 5};
    const int numbers = axis->high / axis->low > 1e3 ? 1 : 3; /* number of tick marks in each power
                                                                 of ten of a logarithmic axis */
    const double factor = axis->unit.factor;
    if (axis->is_log)
        return number[index % numbers] * pow(10, floor(log10(axis->low)) + index / numbers);
    const double step = draw_round((axis->high - axis->low) * factor / 4) / factor;
    return (ceil(axis->low / step - 1e-9) + index) * step;
}

void draw_grid(FILE *file, const draw_axis *x, const draw_axis *y, bool is_x)
{
    enum { MOST_TICKS = 60 };
    const draw_axis *axis = is_x ? x : y;
    const double rounding = 1e-9 * (axis->high - axis->low);
    double value = axis->low;
    for (int k = 0; k < MOST_TICKS && value <= axis->high + rounding; k++) {
        value = tick_value(axis, k);
        if (value >= axis->low - rounding && value <= axis->high + rounding)
            draw_tick(file, x, y, is_x, value);
    }
}
