/* SPDX-License-Identifier: BSD-2-Clause */
/* Functions that draw diagrams, axes and colour scales of reports as SVG. */
#include "report_draw.h"
#include <math.h>
#include <string.h>

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

void draw_line(FILE *file, const double (*at)[2], int count)
{
    int first = 0; /* index of the first point of the piece of the line that is being drawn; a point
                      with NAN ends a piece */
    for (int k = 0; k < count; k++) {
        const bool is_last = k + 1 == count || !is_place(at[k + 1]);
        if (!is_place(at[k]))
            first = k + 1;
        else if (is_last && k > first + 1 && memcmp(at[k], at[first], sizeof *at) == 0)
            fputs("z", file);
        else
            put(file, "%s%f %f", k > first ? "L" : "M", at[k][0], at[k][1]);
    }
}

void draw_polygon(FILE *file, const double (*at)[2], int count)
{
    for (int k = 0; k < count; k++)
        if (!is_place(at[k]))
            return;
    draw_line(file, at, count);
    fputs(count > 2 ? "z" : "", file);
}

void draw_disc(FILE *file, const char *style, const double at[2], double radius)
{
    if (is_place(at))
        put(file, "<circle class=\"%s\" cx=\"%f\" cy=\"%f\" r=\"%f\"/>\n", style, at[0], at[1],
            radius);
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

/* Return the index of the colour of a finite value on a scale. */
static int level_of(const draw_scale *scale, double value)
{
    const double share = scale->most > 0 ? value / scale->most : 0;
    const double place = scale->is_signed ? (share + 1) / 2 : share;
    return (int)lround(fmin(fmax(place, 0), 1) * (DRAW_LEVELS - 1));
}

const char *draw_colour(const draw_scale *scale, double value)
{
    static char name[2][DRAW_LEVELS][16];
    if (!isfinite(value))
        return "none";
    const int level = level_of(scale, value);
    char *text = name[scale->is_signed][level];
    snprintf(text, sizeof name[0][0], "%c%d", scale->is_signed ? 's' : 'v', level);
    return text;
}

const char *draw_tone(const draw_scale *scale, double value)
{
    const double middle = (DRAW_LEVELS - 1) / 2.0;
    return fabs(level_of(scale, value) - middle) > 0.53 * middle ? "strong" : "mild";
}

void draw_legend(FILE *file, const draw_scale *scale, double x, double y)
{
    const double width = DRAW_LEGEND_WIDTH, bar = width / DRAW_LEVELS, most = scale->most;
    const double first = scale->is_signed ? -1 : 0, low = first * most;
    const draw_scale unit = {scale->is_signed, 1, ""};
    put(file, "<g transform=\"translate(%f %f)\"><g class=\"flat\">", x, y);
    for (int i = 0; i < DRAW_LEVELS; i++)
        put(file, "<path class=\"%s\" d=\"M%f 2h%fv10h-%fz\"/>",
            draw_colour(&unit, first + (1 - first) * i / (DRAW_LEVELS - 1)), i * bar, bar, bar);
    put(file, "</g>\n" PUT_TEXT("%a") PUT_TEXT("%a") PUT_TEXT("%q") "</g>\n", "", 0.0, 26.0, low,
        most, scale->unit, "value", width / 2, 26.0, low / 2 + most / 2, most, scale->unit, "end",
        width, 26.0, most, scale->unit);
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

void draw_fit(draw_diagram *diagram)
{
    for (int k = 0; k < diagram->count; k++) {
        const draw_series *series = &diagram->series[k];
        draw_widen(&diagram->x, series->along, series->along ? series->count : 0);
        draw_widen(&diagram->y, series->value, series->count);
    }
}

void draw_curve(FILE *file, const draw_diagram *diagram, const draw_series *series)
{
    const draw_axis *x = &diagram->x, *y = &diagram->y;
    const double part = (x->high - x->low) / series->count;
    const char *step = "M";
    put(file, DRAW_PATH, series->style);
    for (int i = 0; i < series->count; i++) {
        const double along = series->along ? series->along[i] : x->low + (i + 0.5) * part;
        const double at[2] = {draw_on(x, along), draw_on(y, series->value[i])};
        if (is_place(at))
            put(file, "%s%f %f", step, at[0], at[1]);
        step = is_place(at) ? "L" : "M";
    }
    put(file, DRAW_PATH_END);
    if (series->name)
        put(file, PUT_TEXT("%t"), "tag", draw_on(x, series->along[series->named]) + 4,
            draw_on(y, series->value[series->named]) + 4, series->name);
}

void draw_curves(FILE *file, const draw_diagram *diagram)
{
    const draw_axis *x = &diagram->x;
    for (int k = 0; k < diagram->count; k++)
        draw_curve(file, diagram, &diagram->series[k]);
    for (int k = 0; k < diagram->marks; k++) {
        const draw_mark *mark = &diagram->mark[k];
        const double at[2] = {draw_on(x, mark->along), draw_on(&diagram->y, mark->value)};
        const bool is_right = at[0] > (x->from + x->to) / 2;
        draw_disc(file, "dot", at, 4);
        const char *style = is_right ? "tag end" : "tag";
        const double shift = is_right ? -7 : 7;
        if (is_place(at))
            put(file, PUT_TEXT("%s %n"), style, at[0] + shift, at[1] - 5, mark->name, mark->value);
    }
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

/* Return the value of tick mark `index` of an axis; the first marks may lie below its range. */
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

void draw_grid(FILE *file, const draw_diagram *diagram, bool is_x)
{
    enum { MOST_TICKS = 60 };
    const draw_axis *x = &diagram->x, *y = &diagram->y, *axis = is_x ? x : y;
    const double rounding = 1e-9 * (axis->high - axis->low);
    double value = axis->low;
    for (int k = 0; k < MOST_TICKS && value <= axis->high + rounding; k++) {
        value = tick_value(axis, k);
        if (value < axis->low - rounding || value > axis->high + rounding)
            continue;
        const double at = draw_on(axis, value), number = value * axis->unit.factor;
        if (is_x)
            put(file, "<path class=\"grid\" d=\"M%f %fV%f\"/>" PUT_TEXT("%n"), at, y->to, y->from,
                "value", at, y->from + 15, number);
        else
            put(file, "<path class=\"grid\" d=\"M%f %fH%f\"/>" PUT_TEXT("%n%u"), x->from, at, x->to,
                "end", x->from - 6, at + 4, number, y->is_log ? "%" : "");
    }
}
