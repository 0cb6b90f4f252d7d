/* SPDX-License-Identifier: BSD-2-Clause */
/* Drawing layer of the report (report_draw.h). */
#include "report_draw.h"
#include <float.h>
#include <math.h>

/* ---- pictures --------------------------------------------------------- */

void draw_begin(FILE *file, draw_type type, double width, double height, const char *title,
                const char *description)
{
    const double least = type == DRAW_CHART ? 0.8 * width : 0;
    fputs(type == DRAW_CHART ? "<div class=\"wide\" tabindex=\"0\">" : "", file);
    put(file, "<svg viewBox=\"0 0 %f %f\" role=\"%s\" style=\"min-width:%fpx\" aria-label=\"%t\">",
        width, height, type == DRAW_IMAGE ? "img" : "group", least, title);
    put(file, "<title>%t</title><desc>%t</desc>\n", title, description);
}

void draw_end(FILE *file, draw_type type)
{
    fputs(type == DRAW_CHART ? "</svg></div>\n" : "</svg>\n", file);
}

/* ---- lines and discs -------------------------------------------------- */

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

void draw_line(FILE *file, const double from[2], const double to[2])
{
    if (is_place(from) && is_place(to))
        put(file, "M%f %fL%f %f", from[0], from[1], to[0], to[1]);
}

void draw_polygon(FILE *file, const double (*at)[2], int count)
{
    bool is_drawing = false;
    for (int k = 0; k < count; k++)
        if (!is_place(at[k]))
            return;
    for (int k = 0; k < count; k++)
        draw_step(file, &is_drawing, at[k]);
    fputc('z', file);
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

/* ---- colour scales ---------------------------------------------------- */

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

const char *draw_tone(const draw_scale *scale, double value)
{
    const double middle = (DRAW_LEVELS - 1) / 2.0;
    return fabs(draw_level(scale, value) - middle) > 0.53 * middle ? "strong" : "mild";
}

void draw_legend_at(FILE *file, const draw_scale *scale, double x, double y)
{
    const double width = DRAW_LEGEND_WIDTH, bar = width / DRAW_LEVELS;
    const double low = scale->is_signed ? -scale->most : 0;
    put(file, "<g transform=\"translate(%f %f)\"><g class=\"flat\">", x, y);
    for (int i = 0; i < DRAW_LEVELS; i++)
        put(file, "<path class=\"%s\" d=\"M%f 2h%fv10h-%fz\"/>", draw_class(scale, i), i * bar, bar,
            bar);
    put(file, "</g>\n<text y=\"26\">%a</text>", low, scale->most, scale->unit);
    put(file, "<text class=\"value\" x=\"%f\" y=\"26\">%a</text>", width / 2,
        low / 2 + scale->most / 2, scale->most, scale->unit);
    put(file, "<text class=\"end\" x=\"%f\" y=\"26\">%q</text></g>\n", width, scale->most,
        scale->unit);
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

/* ---- axes ------------------------------------------------------------- */

double draw_on(const draw_axis *axis, double value)
{
    double share = (value - axis->low) / (axis->high - axis->low);
    if (axis->is_log)
        share = log(value / axis->low) / log(axis->high / axis->low);
    if (axis->is_log)
        share = fmin(fmax(share, 0), 1);
    return axis->from + (axis->to - axis->from) * share;
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

static void draw_tick(FILE *file, const draw_axis *x, const draw_axis *y, bool is_x, double value)
{
    const draw_axis *axis = is_x ? x : y;
    const double at = draw_on(axis, value);
    if (is_x)
        put(file, "<path class=\"grid\" d=\"M%f %fV%f\"/><text class=\"value\" x=\"%f\" y=\"%f\">",
            at, y->to, y->from, at, y->from + 15);
    else
        put(file, "<path class=\"grid\" d=\"M%f %fH%f\"/><text class=\"end\" x=\"%f\" y=\"%f\">",
            x->from, at, x->to, x->from - 6, at + 4);
    put(file, axis->format, value * axis->unit.factor);
    fputs("</text>\n", file);
}

void draw_grid(FILE *file, const draw_axis *x, const draw_axis *y, bool is_x)
{
    static const double number[3] = {1, 2, 5};
    const draw_axis *axis = is_x ? x : y;
    const double rounding = 1e-9 * (axis->high - axis->low), factor = axis->unit.factor;
    const int numbers = axis->high / axis->low > 1e3 ? 1 : 3; /* numbers per power of ten on a
                                                                 logarithmic axis */
    double step = 0, value = axis->low;
    if (!axis->is_log)
        step = draw_round((axis->high - axis->low) * factor / 4) / factor;
    for (int k = 0; k < 60 && value <= axis->high + rounding; k++) {
        value = (ceil(axis->low / step - 1e-9) + k) * step;
        if (axis->is_log)
            value = number[k % numbers] * pow(10, floor(log10(axis->low)) + k / numbers);
        if (value >= axis->low - rounding && value <= axis->high + rounding)
            draw_tick(file, x, y, is_x, value);
    }
}

/* ---- space ------------------------------------------------------------ */

double draw_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void draw_component(const surface_point *p, scene_component component, double along[3])
{
    for (int i = 0; i < 3; i++) {
        along[i] = (int)component - (int)COMPONENT_X == i;
        if (component <= COMPONENT_U3)
            along[i] = p->e[component - COMPONENT_U1][i];
    }
}

/*
 * Set the axes of a view from a horizontal direction (azimuth in degrees), 30 degrees above the
 * horizon.
 */
static void look_from(draw_view *view, double azimuth)
{
    const double degree = 0.017453292519943295, up = sin(30 * degree), out = cos(30 * degree);
    const double c = cos(azimuth * degree), s = sin(azimuth * degree);
    const double axis[3][3] = {{-s, c, 0}, {-up * c, -up * s, out}, {out * c, out * s, up}};
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++)
            view->axis[a][i] = axis[a][i];
}

void draw_view_begin(draw_view *view, const mesh *mesh)
{
    static const double azimuth[4] = {-58, 32, 122, 212};
    double normal[3] = {0, 0, 0}, best = -2, chosen = azimuth[0];
    for (int n = 0; n < mesh->nodes; n++)
        for (int i = 0; i < 3; i++)
            normal[i] += mesh->point[n].e[2][i] / mesh->nodes;
    for (int k = 0; k < 4; k++) {
        look_from(view, azimuth[k]);
        const double shown = draw_dot3(normal, view->axis[2]);
        if (shown <= best + 1e-6)
            continue;
        best = shown;
        chosen = azimuth[k];
    }
    look_from(view, chosen);
    for (int a = 0; a < 2; a++) {
        view->low[a] = DBL_MAX;
        view->high[a] = -DBL_MAX;
    }
}

void draw_view_include(draw_view *view, const double x[3])
{
    for (int a = 0; a < 2; a++) {
        const double place = draw_dot3(view->axis[a], x);
        if (!isfinite(place))
            continue;
        view->low[a] = fmin(view->low[a], place);
        view->high[a] = fmax(view->high[a], place);
    }
}

void draw_view_fit(draw_view *view, double width, double height)
{
    const double edge = 18;
    const double wide = fmax(view->high[0] - view->low[0], 1e-300);
    const double tall = fmax(view->high[1] - view->low[1], 1e-300);
    view->zoom = fmin((width - 2 * edge) / wide, (height - 2 * edge) / tall);
    view->width = width;
    view->height = fmax(view->zoom * tall + 2 * edge, 180);
}

void draw_project(const draw_view *view, const double x[3], double at[2])
{
    const double right = draw_dot3(view->axis[0], x) - (view->low[0] + view->high[0]) / 2;
    const double up = draw_dot3(view->axis[1], x) - (view->low[1] + view->high[1]) / 2;
    at[0] = view->width / 2 + view->zoom * right;
    at[1] = view->height / 2 - view->zoom * up;
}

void draw_place(const mesh *mesh, int node, const double *vector, double factor, double x[3])
{
    for (int i = 0; i < 3; i++)
        x[i] = mesh->point[node].x[i] + (vector ? factor * vector[3 * node + i] : 0);
}

void draw_view_mesh(draw_view *view, const mesh *mesh, const double *vector, double factor)
{
    for (int n = 0; n < mesh->nodes; n++) {
        double x[3];
        draw_view_include(view, mesh->point[n].x);
        draw_place(mesh, n, vector, factor, x);
        draw_view_include(view, x);
    }
}

double draw_magnification(const mesh *mesh, double most, double share)
{
    double size = 0;
    for (int i = 0; i < 3; i++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int n = 0; n < mesh->nodes; n++) {
            low = fmin(low, mesh->point[n].x[i]);
            high = fmax(high, mesh->point[n].x[i]);
        }
        size = fmax(size, high - low);
    }
    const double wanted = share * size / most;
    return most > 0 && isfinite(wanted) && wanted > 0 ? draw_round(wanted) : 1;
}

/* ---- meshes ----------------------------------------------------------- */

int draw_stride(int elements, int most)
{
    return (elements + most - 1) / most;
}

int draw_next(int line, int stride, int last)
{
    return line + stride < last ? line + stride : last;
}
