/* Pictures over the parameter plane (report_plane.h). */
#include "report_plane.h"
#include <math.h>
#include <stdlib.h>
#include "report_html.h"

enum { MOST_LINES = 24, MAP_CELLS = 96, MAP_FINE = 64 };

static const double plane_width = 320;

/* ---- parameter plane -------------------------------------------------- */

/* theta1 to the right, theta2 up, at the shell's mean proportions. */
typedef struct plane {
    double low[2], range[2], x0, y0, width, height;
} plane;

static plane plane_of(const mesh *m)
{
    plane p = {.x0 = 30, .y0 = 6};
    double length[2];
    for (int a = 0; a < 2; a++) {
        const scene_line *line = &m->scene->line[a];
        double metric = 0;
        for (int n = 0; n < m->nodes; n++)
            metric += m->point[n].a[a] / m->nodes;
        p.low[a] = line->point[0];
        p.range[a] = line->point[line->elements] - line->point[0];
        length[a] = metric * p.range[a];
    }
    const double aspect = fmin(fmax(length[1] / length[0], 0.3), 3), room = plane_width - p.x0 - 2;
    p.width = room / fmax(aspect, 1);
    p.height = room * fmin(aspect, 1);
    p.x0 += (room - p.width) / 2;
    return p;
}

/* Height of the picture, with room for the numbers below. */
static double plane_room(const plane *p)
{
    return p->y0 + p->height + 20;
}

static double plane_x(const plane *p, double theta1)
{
    return p->x0 + (theta1 - p->low[0]) / p->range[0] * p->width;
}

static double plane_y(const plane *p, double theta2)
{
    return p->y0 + p->height - (theta2 - p->low[1]) / p->range[1] * p->height;
}

static void plane_end(FILE *file, const plane *p)
{
    const double right = p->x0 + p->width, bottom = p->y0 + p->height;
    fprintf(file, "<rect class=\"frame\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n", p->x0, p->y0, p->width, p->height);
    fprintf(file, "<text x=\"%.1f\" y=\"%.1f\">", p->x0, bottom + 14);
    html_number(file, p->low[0]);
    fprintf(file, "</text><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">&theta;&#8321;</text><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">",
            p->x0 + p->width / 2, bottom + 14, right, bottom + 14);
    html_number(file, p->low[0] + p->range[0]);
    fprintf(file, "</text>\n<g text-anchor=\"end\" transform=\"translate(%.1f 0) rotate(-90)\"><text x=\"%.1f\" y=\"0\" text-anchor=\"start\">", p->x0 - 6, -bottom);
    html_number(file, p->low[1]);
    fprintf(file, "</text><text x=\"%.1f\" y=\"%.0f\" text-anchor=\"middle\">&theta;&#8322;</text><text x=\"%.1f\" y=\"0\">",
            -(p->y0 + p->height / 2), p->height < 110 ? -12.0 : 0.0, -p->y0);
    html_number(file, p->low[1] + p->range[1]);
    fputs("</text></g>\n", file);
    draw_end(file);
}

/* Mesh lines of the plane. */
static void plane_grid(FILE *file, const plane *p, const mesh *m)
{
    fputs("<path class=\"grid\" d=\"", file);
    for (int a = 0; a < 2; a++)
        for (int k = 1, step = draw_stride(m->scene->line[a].elements, MOST_LINES); k < m->scene->line[a].elements; k += step) {
            const double at = m->scene->line[a].point[k];
            if (a == 0)
                fprintf(file, "M%.1f %.1fv%.1f", plane_x(p, at), p->y0, p->height);
            else
                fprintf(file, "M%.1f %.1fh%.1f", p->x0, plane_y(p, at), p->width);
        }
    fputs("\"/>\n", file);
}

/* Pieces of one direction of the map: every cell is cut into `fine`, or spans `step` elements. */
typedef struct cuts { int step, fine, count; } cuts;

static cuts cuts_of(const scene_line *line)
{
    cuts c;
    c.step = draw_stride(line->elements, MAP_CELLS);
    c.fine = line->elements >= MAP_FINE ? 1 : (MAP_FINE + line->elements - 1) / line->elements;
    c.count = (line->elements + c.step - 1) / c.step * c.fine;
    return c;
}

/* Piece k: mesh lines around it, where it begins and ends between them. */
static void cut_at(const scene_line *line, const cuts *c, int k, int around[2], double share[2])
{
    around[0] = k / c->fine * c->step;
    around[1] = draw_next(around[0], c->step, line->elements);
    share[0] = (double)(k % c->fine) / c->fine;
    share[1] = (double)(k % c->fine + 1) / c->fine;
}

static double theta_at(const scene_line *line, const int around[2], double share)
{
    return line->point[around[0]] + share * (line->point[around[1]] - line->point[around[0]]);
}

static int map_level(const mesh *m, const double *value, const draw_scale *scale, const int i[2], const int j[2], double s, double t)
{
    const double corner[4] = {value[mesh_node(m, i[0], j[0])], value[mesh_node(m, i[1], j[0])], value[mesh_node(m, i[1], j[1])],
                              value[mesh_node(m, i[0], j[1])]};
    return draw_level(scale, draw_between(corner, s, t));
}

/* One row of the map, equal neighbours joined. */
static void map_row(FILE *file, const plane *p, const mesh *m, const double *value, const draw_scale *scale, const cuts *c, int row)
{
    const scene_line *line = m->scene->line;
    int j[2];
    double t[2], start = p->x0;
    cut_at(&line[1], &c[1], row, j, t);
    const double top = plane_y(p, theta_at(&line[1], j, t[1])), bottom = plane_y(p, theta_at(&line[1], j, t[0]));
    int level = -2;
    for (int k = 0; k <= c[0].count; k++) {
        int i[2], next = -2;
        double s[2], x = p->x0 + p->width;
        if (k < c[0].count) {
            cut_at(&line[0], &c[0], k, i, s);
            x = plane_x(p, theta_at(&line[0], i, s[0]));
            next = map_level(m, value, scale, i, j, (s[0] + s[1]) / 2, (t[0] + t[1]) / 2);
        }
        if (next == level && k < c[0].count)
            continue;
        if (level != -2) {
            draw_path(file, scale, level);
            fprintf(file, "M%.2f %.2fH%.2fV%.2fH%.2fz\"/>", start, top, x, bottom, start);
        }
        level = next;
        start = x;
    }
    fputc('\n', file);
}

/* Nodes with a value where the map could not show it. */
static void lone_values(FILE *file, const plane *p, const mesh *m, const double *value, const draw_scale *scale)
{
    int none = 0;
    for (int n = 0; n < m->nodes; n++)
        none += isnan(value[n]) != 0;
    for (int n = 0; none > 0 && n < m->nodes; n++)
        if (!isnan(value[n])) {
            const double at[2] = {plane_x(p, m->theta[n][0]), plane_y(p, m->theta[n][1])};
            draw_disc(file, scale, value[n], at);
        }
}

void plane_map(FILE *file, const mesh *m, const double *value, const draw_scale *scale, const char *title)
{
    const plane p = plane_of(m);
    const cuts c[2] = {cuts_of(&m->scene->line[0]), cuts_of(&m->scene->line[1])};
    draw_begin(file, plane_width, plane_room(&p), title);
    fputs("<g class=\"flat\">\n", file);
    for (int row = 0; row < c[1].count; row++)
        map_row(file, &p, m, value, scale, c, row);
    lone_values(file, &p, m, value, scale);
    fputs("</g>\n", file);
    plane_grid(file, &p, m);
    plane_end(file, &p);
}

/* ---- volts on the patches --------------------------------------------- */

static int overlap(const scene_patches *p, const scene_patches *q)
{
    return p->theta1[0] < q->theta1[1] && q->theta1[0] < p->theta1[1] && p->theta2[0] < q->theta2[1] && q->theta2[0] < p->theta2[1];
}

/* Do the patches of two actuators lie over each other in the plane? */
static int actuators_overlap(const scene *s, const scene_actuator *x, const scene_actuator *y)
{
    for (int i = 0; i < x->drives; i++)
        for (int j = 0; j < y->drives; j++)
            if (overlap(&s->patches[x->drive[i].patches], &s->patches[y->drive[j].patches]))
                return 1;
    return 0;
}

int plane_plans(const scene *s, int *plan)
{
    int plans = 0;
    for (int k = 0; k < s->actuators; k++) {
        plan[k] = s->actuator[k].is_temperature || s->actuator[k].drives == 0 ? -1 : 0;
        for (int other = 0; plan[k] >= 0 && other < k; other++)
            if (plan[other] == plan[k] && actuators_overlap(s, &s->actuator[k], &s->actuator[other])) {
                plan[k]++;
                other = -1;
            }
        if (plan[k] >= plans)
            plans = plan[k] + 1;
    }
    return plans;
}

/* Rectangle x, y, width, height of patch (i, j) of a grid. */
static void patch_box(const plane *p, const scene_patches *patches, int i, int j, double box[4])
{
    const double d1 = (patches->theta1[1] - patches->theta1[0]) / patches->grid[0], d2 = (patches->theta2[1] - patches->theta2[0]) / patches->grid[1];
    box[0] = plane_x(p, patches->theta1[0] + i * d1);
    box[1] = plane_y(p, patches->theta2[0] + (j + 1) * d2);
    box[2] = d1 / p->range[0] * p->width;
    box[3] = d2 / p->range[1] * p->height;
}

/* Is the colour of a level far from that of the page's text, or near it? */
static const char *tone(int level)
{
    return abs(2 * level - HTML_LEVELS + 1) > 17 ? "strong" : "mild";
}

static void write_volt(FILE *file, const draw_scale *scale, const double box[4], double volt)
{
    char text[32];
    const int level = draw_level(scale, volt), decimals = scale->most >= 100 ? 0 : scale->most >= 10 ? 1 : 2;
    const int length = snprintf(text, sizeof text, "%.*f", decimals, fabs(volt)) + (volt < 0);
    const double size = fmin(fmin(box[3] * 0.5, box[2] * 1.3 / length), 14);
    if (size < 4.5 || level < 0)
        return;
    fprintf(file, "<text class=\"value %s\" style=\"font-size:%.1fpx\" x=\"%.1f\" y=\"%.1f\">%s%s</text>", tone(level), size, box[0] + box[2] / 2, box[1] + box[3] / 2 + size * 0.36, volt < 0 && strtod(text, NULL) > 0 ? "&minus;" : "", text);
}

static void patch(FILE *file, const scene *s, int amplifier, const double box[4], double volt, plane_outline outline, const draw_scale *scale)
{
    static const char *const said[] = {"", ", at its limit", ", beyond the limits of the scene"};
    const int level = draw_level(scale, volt);
    char name[SCENE_LABEL];
    scene_amplifier_name(s, amplifier, name);
    fputs("<g><title>", file);
    html_text(file, name);
    fputs(": ", file);
    html_quantity(file, volt, scale->unit);
    fprintf(file, "%s</title>", said[outline]);
    if (level < 0)
        fputs("<rect class=\"none", file);
    else
        fprintf(file, "<rect class=\"s%d", level);
    fprintf(file, " patch\" x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>", box[0], box[1], box[2], box[3]);
    if (outline != OUTLINE_NONE && box[2] > 5 && box[3] > 5)
        fprintf(file, "<rect class=\"%s %s\" x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>", outline == OUTLINE_LIMIT ? "limit" : "beyond",
                tone(level), box[0] + 2, box[1] + 2, box[2] - 4, box[3] - 4);
    write_volt(file, scale, box, volt);
    fputs("</g>\n", file);
}

void plane_volts(FILE *file, const mesh *m, const int *plan, int which, const double *volt, const plane_outline *outline,
                 const draw_scale *scale, const char *title)
{
    const scene *s = m->scene;
    const plane p = plane_of(m);
    draw_begin_group(file, plane_width, plane_room(&p), title);
    for (int k = 0; k < s->actuators; k++) {
        const scene_actuator *actuator = &s->actuator[k];
        for (int d = actuator->drives - 1; plan[k] == which && d >= 0; d--)
            for (int c = 0; c < actuator->grid[0] * actuator->grid[1]; c++) {
                double box[4];
                patch_box(&p, &s->patches[actuator->drive[d].patches], c / actuator->grid[1], c % actuator->grid[1], box);
                patch(file, s, actuator->first + c, box, volt[actuator->first + c], outline[actuator->first + c], scale);
            }
    }
    plane_end(file, &p);
}
