/* Primitives of the drawings (report_draw.h). */
#include "report_draw.h"
#include <float.h>
#include <math.h>
#include "report_html.h"

static const double edge_room = 18;

double draw_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void draw_direction(const surface_point *p, scene_component component, double along[3])
{
    for (int i = 0; i < 3; i++)
        along[i] = component <= COMPONENT_U3 ? p->e[component - COMPONENT_U1][i]
                                             : (unsigned)i == component - COMPONENT_X;
}

int draw_stride(int elements, int most)
{
    return (elements + most - 1) / most;
}

int draw_next(int k, int step, int last)
{
    return k + step < last ? k + step : last;
}

double draw_between(const double corner[4], double s, double t)
{
    return (1 - t) * ((1 - s) * corner[0] + s * corner[1]) +
           t * ((1 - s) * corner[3] + s * corner[2]);
}

/* Do all corners of the element from line i, j on have a value? */
static int is_whole(const mesh *mesh, const double *value, int i, int j)
{
    return !isnan(value[mesh_node(mesh, i, j)]) && !isnan(value[mesh_node(mesh, i + 1, j)]) &&
           !isnan(value[mesh_node(mesh, i, j + 1)]) && !isnan(value[mesh_node(mesh, i + 1, j + 1)]);
}

int draw_is_lone(const mesh *mesh, const double *value, int i, int j)
{
    const scene_line *line = mesh->scene->line;
    const int closed[2] = {mesh->lines[0] == line[0].elements, mesh->lines[1] == line[1].elements};
    if (isnan(value[mesh_node(mesh, i, j)]))
        return 0;
    for (int k = 0; k < 4; k++) {
        int at[2] = {i - k % 2, j - k / 2};
        for (int a = 0; a < 2; a++)
            if (at[a] < 0 && closed[a])
                at[a] += line[a].elements;
        if (at[0] >= 0 && at[1] >= 0 && at[0] < line[0].elements && at[1] < line[1].elements &&
            is_whole(mesh, value, at[0], at[1]))
            return 0;
    }
    return 1;
}

/* ---- pictures and colours --------------------------------------------- */

/* least: of its width on a page (px), 0: none. */
static void begin(FILE *file, double width, double height, double least, const char *role,
                  const char *title)
{
    fprintf(file, "<svg viewBox=\"0 0 %.0f %.0f\" role=\"%s\" ", width, height, role);
    if (least > 0)
        fprintf(file, "style=\"min-width:%.0fpx\" ", least);
    fputs("aria-label=\"", file);
    html_text(file, title);
    fputs("\"><title>", file);
    html_text(file, title);
    fputs("</title>\n", file);
}

void draw_begin(FILE *file, double width, double height, const char *title)
{
    begin(file, width, height, 0, "img", title);
}

void draw_begin_group(FILE *file, double width, double height, const char *title)
{
    begin(file, width, height, 0, "group", title);
}

void draw_end(FILE *file)
{
    fputs("</svg>\n", file);
}

void draw_begin_chart(FILE *file, double width, double height, const char *title)
{
    fputs("<div class=\"wide\" tabindex=\"0\">", file);
    begin(file, width, height, 0.8 * width, "group", title);
}

void draw_end_chart(FILE *file)
{
    draw_end(file);
    fputs("</div>\n", file);
}

int draw_level(const draw_scale *scale, double value)
{
    if (isnan(value))
        return -1;
    double share = scale->most > 0 ? value / scale->most : 0;
    if (scale->is_signed)
        share = (share + 1) / 2;
    return (int)lround(fmin(fmax(share, 0), 1) * (HTML_LEVELS - 1));
}

void draw_path(FILE *file, const draw_scale *scale, int level)
{
    if (level < 0)
        fputs("<path class=\"none\" d=\"", file);
    else
        fprintf(file, "<path class=\"%c%d\" d=\"", scale->is_signed ? 's' : 'v', level);
}

void draw_disc(FILE *file, const draw_scale *scale, double value, const double at[2])
{
    draw_path(file, scale, draw_level(scale, value));
    fprintf(file, "M%.1f %.1fm-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0z\"/>", at[0], at[1]);
}

void draw_legend(FILE *file, const draw_scale *scale)
{
    if (!(scale->most > 0)) {
        fputs("<p class=\"keys\">Zero everywhere.</p>\n", file);
        return;
    }
    const double width = 330, bar = width / HTML_LEVELS;
    fputs("<div class=\"scale\">", file);
    draw_begin(file, width, 32, "Colour scale");
    fputs("<g class=\"flat\">", file);
    for (int i = 0; i < HTML_LEVELS; i++) {
        draw_path(file, scale, i);
        fprintf(file, "M%.1f 2h%.1fv10H%.1fz\"/>", i * bar, bar, i * bar);
    }
    fputs("</g>\n<text x=\"0\" y=\"26\">", file);
    html_quantity(file, scale->is_signed ? -scale->most : 0, scale->unit);
    fprintf(file, "</text><text x=\"%.0f\" y=\"26\" text-anchor=\"middle\">", width / 2);
    html_quantity(file, scale->is_signed ? 0 : scale->most / 2, scale->unit);
    fprintf(file, "</text><text x=\"%.0f\" y=\"26\" text-anchor=\"end\">", width);
    html_quantity(file, scale->most, scale->unit);
    fputs("</text>\n", file);
    draw_end(file);
    fputs("</div>\n", file);
}

/* ---- projection ------------------------------------------------------- */

/* Axes of a view from an azimuth and elevation in degrees. */
static void look_from(draw_view *view, double azimuth, double elevation)
{
    const double degree = 0.017453292519943295;
    const double c = cos(azimuth * degree), s = sin(azimuth * degree), ce = cos(elevation * degree),
                 se = sin(elevation * degree);
    const double axis[3][3] = {{-s, c, 0}, {-se * c, -se * s, ce}, {ce * c, ce * s, se}};
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++)
            view->axis[a][i] = axis[a][i];
}

void draw_view_begin(draw_view *view, const mesh *mesh)
{
    static const double azimuth[4] = {-58, 32, 122, 212};
    double normal[3] = {0, 0, 0}, best = -2;
    int chosen = 0;
    for (int n = 0; n < mesh->nodes; n++)
        for (int i = 0; i < 3; i++)
            normal[i] += mesh->point[n].e[2][i] / mesh->nodes;
    for (int k = 0; k < 4; k++) {
        look_from(view, azimuth[k], 30);
        const double shown = draw_dot3(normal, view->axis[2]);
        if (shown > best + 1e-6) {
            best = shown;
            chosen = k;
        }
    }
    look_from(view, azimuth[chosen], 30);
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
    const double wide = fmax(view->high[0] - view->low[0], 1e-300),
                 tall = fmax(view->high[1] - view->low[1], 1e-300);
    view->zoom = fmin((width - 2 * edge_room) / wide, (height - 2 * edge_room) / tall);
    view->width = width;
    view->height = fmax(view->zoom * tall + 2 * edge_room, 180);
}

void draw_project(const draw_view *view, const double x[3], double at[2])
{
    at[0] = view->width / 2 +
            view->zoom * (draw_dot3(view->axis[0], x) - (view->low[0] + view->high[0]) / 2);
    at[1] = view->height / 2 -
            view->zoom * (draw_dot3(view->axis[1], x) - (view->low[1] + view->high[1]) / 2);
}

void draw_place(const mesh *mesh, int node, const double *vector, double factor, double x[3])
{
    for (int i = 0; i < 3; i++)
        x[i] = mesh->point[node].x[i] + (vector ? factor * vector[3 * node + i] : 0);
}
