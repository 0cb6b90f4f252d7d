/* Pictures over the parameter plane (report_plane.h). */
#include "report_plane.h"
#include <math.h>
#include <stdlib.h>
#include "report_html.h"
#include "../text/words.h"

enum { MOST_LINES = 24, MAP_CELLS = 96, MAP_FINE = 64, ROUND_FINE = 160 };

static const double plane_width = 320, full_turn = 6.283185307179586;

/* ---- parameter plane -------------------------------------------------- */

/* A rectangle at the shell's mean proportions, or of a polar plate its disc: centre, pixels per
 * length. */
typedef struct plane {
    const scene *scene;
    double low[2], range[2], x0, y0, width, height;
    int polar;
    double centre[2], zoom;
} plane;

/* Places in the picture of a point. */
static void plane_at(const plane *p, double theta1, double theta2, double at[2])
{
    if (p->polar) {
        at[0] = p->centre[0] + p->zoom * theta1 * cos(theta2);
        at[1] = p->centre[1] - p->zoom * theta1 * sin(theta2);
    } else {
        at[0] = p->x0 + (theta2 - p->low[1]) / p->range[1] * p->width;
        at[1] = p->y0 + (theta1 - p->low[0]) / p->range[0] * p->height;
    }
}

/* Fit a disc or a sector into a width and at most the same height. */
static void fit_round(plane *p, double room)
{
    enum { POINTS = 65 };
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    p->zoom = 1;
    for (int k = 0; k < 2 * POINTS; k++) {
        double at[2];
        plane_at(p, p->low[0] + (k % 2) * p->range[0],
                 p->low[1] + p->range[1] * (k / 2) / (POINTS - 1), at);
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], at[i]);
            high[i] = fmax(high[i], at[i]);
        }
    }
    p->zoom = room / fmax(high[0] - low[0], high[1] - low[1]);
    p->width = p->zoom * (high[0] - low[0]);
    p->height = p->zoom * (high[1] - low[1]);
    p->x0 = (plane_width - p->width) / 2;
    p->centre[0] = p->x0 - p->zoom * low[0];
    p->centre[1] = p->y0 - p->zoom * low[1];
}

static plane plane_of(const mesh *mesh)
{
    plane p = {.scene = mesh->scene,
               .x0 = 34,
               .y0 = 6,
               .polar = mesh->scene->surface.type == SURFACE_POLAR};
    double length[2];
    for (int a = 0; a < 2; a++) {
        const scene_line *line = &mesh->scene->line[a];
        double metric = 0;
        for (int n = 0; n < mesh->nodes; n++)
            metric += mesh->point[n].a[a] / mesh->nodes;
        p.low[a] = line->point[0];
        p.range[a] = line->point[line->elements] - line->point[0];
        length[a] = metric * p.range[a];
    }
    const double aspect = fmin(fmax(length[0] / length[1], 0.3), 3), room = plane_width - p.x0 - 2;
    if (p.polar) {
        fit_round(&p, room);
        return p;
    }
    p.width = room / fmax(aspect, 1);
    p.height = room * fmin(aspect, 1);
    p.x0 += (room - p.width) / 2;
    return p;
}

/* On an axis too short for its ends and its name the name takes a line of its own. */
static int is_short(double length)
{
    return length < 150;
}

/* Height of the picture, with room for the words below. */
static double plane_room(const plane *p)
{
    return p->y0 + p->height + (p->polar || is_short(p->width) ? 34 : 20);
}

/* Path along a line of the parameters: theta of direction a at a value. */
static void trace(FILE *file, const plane *p, int a, double value)
{
    double at[3][2];
    for (int k = 0; k < 3; k++) {
        const double other = p->low[1 - a] + p->range[1 - a] * k / 2;
        plane_at(p, a == 0 ? value : other, a == 0 ? other : value, at[k]);
    }
    fprintf(file, "M%.2f %.2f", at[0][0], at[0][1]);
    for (int k = 1; k < 3; k++)
        if (p->polar && a == 0)
            fprintf(file, "A%.2f %.2f 0 0 0 %.2f %.2f", p->zoom * value, p->zoom * value, at[k][0],
                    at[k][1]);
        else
            fprintf(file, "L%.2f %.2f", at[k][0], at[k][1]);
}

/* Path around the cell between two values of each parameter, smaller by `inset` pixels all round.
 */
static void cell_path(FILE *file, const plane *p, const double theta1[2], const double theta2[2],
                      double inset)
{
    if (!p->polar) {
        double from[2], to[2];
        plane_at(p, theta1[0], theta2[0], from);
        plane_at(p, theta1[1], theta2[1], to);
        fprintf(file, "M%.2f %.2fH%.2fV%.2fH%.2fz", from[0] + inset, from[1] + inset, to[0] - inset,
                to[1] - inset, from[0] + inset);
        return;
    }
    double at[2][2][2], radius[2];
    for (int i = 0; i < 2; i++) {
        radius[i] = p->zoom * theta1[i] + (i ? -inset : inset);
        const double turn = radius[i] > inset ? inset / radius[i] : 0;
        for (int j = 0; j < 2; j++)
            plane_at(p, radius[i] / p->zoom, theta2[j] + (j ? -turn : turn), at[i][j]);
    }
    const int large = theta2[1] - theta2[0] > full_turn / 2;
    fprintf(file, "M%.2f %.2fL%.2f %.2fA%.2f %.2f 0 %d 0 %.2f %.2f", at[0][0][0], at[0][0][1],
            at[1][0][0], at[1][0][1], radius[1], radius[1], large, at[1][1][0], at[1][1][1]);
    fprintf(file, "L%.2f %.2fA%.2f %.2f 0 %d 1 %.2f %.2fz", at[0][1][0], at[0][1][1], radius[0],
            radius[0], large, at[0][0][0], at[0][0][1]);
}

static void write_axis(FILE *file, const plane *p, int a)
{
    char unit[WORDS_UNIT];
    words_unit(p->scene, words_of_theta(p->scene, a), unit);
    fputs(a ? "&theta;&#8322;" : "&theta;&#8321;", file);
    if (*unit) {
        fputs(" (", file);
        html_text(file, unit);
        fputc(')', file);
    }
}

/* Ranges of a disc in words, a line each. */
static void round_words(FILE *file, const plane *p)
{
    static const char *const way[2] = {", from the centre", ", anticlockwise from the right"};
    for (int a = 0; a < 2; a++) {
        fprintf(file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">", plane_width / 2,
                p->y0 + p->height + 16 + 14 * a);
        write_axis(file, p, a);
        fputs(" from ", file);
        html_number(file, p->low[a]);
        fputs(" to ", file);
        html_number(file, p->low[a] + p->range[a]);
        fprintf(file, "%s</text>\n", way[a]);
    }
}

/* Numbers at both ends of an axis that is that long, its name between them. */
static void axis_words(FILE *file, const plane *p, int a, double length)
{
    fputs("<text>", file);
    html_number(file, p->low[a]);
    fprintf(file, "</text><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">", length / 2,
            is_short(length) ? 13.0 : 0.0);
    write_axis(file, p, a);
    fprintf(file, "</text><text x=\"%.1f\" text-anchor=\"end\">", length);
    html_number(file, p->low[a] + p->range[a]);
    fputs("</text></g>\n", file);
}

static void plane_end(FILE *file, const plane *p)
{
    fputs("<path class=\"frame\" d=\"", file);
    for (int a = 0; a < 2; a++) {
        trace(file, p, a, p->low[a]);
        trace(file, p, a, p->low[a] + p->range[a]);
    }
    fputs("\"/>\n", file);
    if (p->polar) {
        round_words(file, p);
    } else {
        fprintf(file, "<g transform=\"translate(%.1f %.1f)\">", p->x0, p->y0 + p->height + 14);
        axis_words(file, p, 1, p->width);
        fprintf(file, "<g transform=\"translate(%.1f %.1f) rotate(90)\">", p->x0 - 14, p->y0);
        axis_words(file, p, 0, p->height);
    }
    draw_end(file);
}

/* Mesh lines of the plane. */
static void plane_grid(FILE *file, const plane *p)
{
    fputs("<path class=\"grid\" d=\"", file);
    for (int a = 0; a < 2; a++) {
        const scene_line *line = &p->scene->line[a];
        for (int k = 1, step = draw_stride(line->elements, MOST_LINES); k < line->elements;
             k += step)
            trace(file, p, a, line->point[k]);
    }
    fputs("\"/>\n", file);
}

/* Pieces of one direction of the map: every cell is cut into `fine`, or spans `step` elements. */
typedef struct cuts {
    int step, fine, count;
} cuts;

static cuts cuts_of(const scene_line *line, int fine)
{
    cuts c;
    c.step = draw_stride(line->elements, MAP_CELLS);
    c.fine = line->elements >= fine ? 1 : (fine + line->elements - 1) / line->elements;
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

static int map_level(const mesh *mesh, const double *value, const draw_scale *scale, const int i[2],
                     const int j[2], double s, double t)
{
    const double corner[4] = {
        value[mesh_node(mesh, i[0], j[0])], value[mesh_node(mesh, i[1], j[0])],
        value[mesh_node(mesh, i[1], j[1])], value[mesh_node(mesh, i[0], j[1])]};
    return draw_level(scale, draw_between(corner, s, t));
}

/* The map between two values of theta2, equal neighbours joined. */
static void map_strip(FILE *file, const plane *p, const mesh *mesh, const double *value,
                      const draw_scale *scale, const cuts *c, int strip)
{
    const scene_line *line = mesh->scene->line;
    int j[2], level = -2;
    double t[2], theta1[2] = {p->low[0], 0};
    cut_at(&line[1], &c[1], strip, j, t);
    const double theta2[2] = {theta_at(&line[1], j, t[0]), theta_at(&line[1], j, t[1])};
    for (int k = 0; k <= c[0].count; k++) {
        int i[2], next = -2;
        double s[2];
        theta1[1] = p->low[0] + p->range[0];
        if (k < c[0].count) {
            cut_at(&line[0], &c[0], k, i, s);
            theta1[1] = theta_at(&line[0], i, s[0]);
            next = map_level(mesh, value, scale, i, j, (s[0] + s[1]) / 2, (t[0] + t[1]) / 2);
        }
        if (next == level && k < c[0].count)
            continue;
        if (level != -2) {
            draw_path(file, scale, level);
            cell_path(file, p, theta1, theta2, 0);
            fputs("\"/>", file);
        }
        level = next;
        theta1[0] = theta1[1];
    }
    fputc('\n', file);
}

/* Nodes with a value where the map cannot show it. */
static void lone_values(FILE *file, const plane *p, const mesh *mesh, const double *value,
                        const draw_scale *scale)
{
    for (int i = 0; i < mesh->lines[0]; i++)
        for (int j = 0; j < mesh->lines[1]; j++)
            if (draw_is_lone(mesh, value, i, j)) {
                double at[2];
                plane_at(p, mesh->scene->line[0].point[i], mesh->scene->line[1].point[j], at);
                draw_disc(file, scale, value[mesh_node(mesh, i, j)], at);
            }
}

void plane_map(FILE *file, const mesh *mesh, const double *value, const draw_scale *scale,
               const char *title)
{
    const plane p = plane_of(mesh);
    const cuts c[2] = {cuts_of(&mesh->scene->line[0], MAP_FINE),
                       cuts_of(&mesh->scene->line[1], p.polar ? ROUND_FINE : MAP_FINE)};
    draw_begin(file, plane_width, plane_room(&p), title);
    fprintf(file, "<g class=\"%s\">\n", p.polar ? "cells" : "flat");
    for (int strip = 0; strip < c[1].count; strip++)
        map_strip(file, &p, mesh, value, scale, c, strip);
    lone_values(file, &p, mesh, value, scale);
    fputs("</g>\n", file);
    plane_grid(file, &p);
    plane_end(file, &p);
}

/* ---- volts on the patches --------------------------------------------- */

static int overlap(const scene_patches *patches, const scene_patches *q)
{
    return patches->theta1[0] < q->theta1[1] && q->theta1[0] < patches->theta1[1] &&
           patches->theta2[0] < q->theta2[1] && q->theta2[0] < patches->theta2[1];
}

/* Do the patches of two actuators lie over each other in the plane? */
static int actuators_overlap(const scene *scene, const scene_actuator *x, const scene_actuator *y)
{
    for (int i = 0; i < x->drives; i++)
        for (int j = 0; j < y->drives; j++)
            if (overlap(&scene->patches[x->drive[i].patches], &scene->patches[y->drive[j].patches]))
                return 1;
    return 0;
}

int plane_plans(const scene *scene, int *plan)
{
    int plans = 0;
    for (int k = 0; k < scene->actuators; k++) {
        plan[k] = scene->actuator[k].is_temperature || scene->actuator[k].drives == 0 ? -1 : 0;
        for (int other = 0; plan[k] >= 0 && other < k; other++)
            if (plan[other] == plan[k] &&
                actuators_overlap(scene, &scene->actuator[k], &scene->actuator[other])) {
                plan[k]++;
                other = -1;
            }
        if (plan[k] >= plans)
            plans = plan[k] + 1;
    }
    return plans;
}

/* A patch in the picture: its range, its middle, the room for words there. */
typedef struct box {
    double theta1[2], theta2[2], at[2], width, height;
} box;

/* Patch (i, j) of a grid. */
static box box_of(const plane *p, const scene_patches *patches, int i, int j)
{
    const double d1 = (patches->theta1[1] - patches->theta1[0]) / patches->grid[0],
                 d2 = (patches->theta2[1] - patches->theta2[0]) / patches->grid[1];
    box b = {.theta1 = {patches->theta1[0] + i * d1, patches->theta1[0] + (i + 1) * d1},
             .theta2 = {patches->theta2[0] + j * d2, patches->theta2[0] + (j + 1) * d2}};
    plane_at(p, (b.theta1[0] + b.theta1[1]) / 2, (b.theta2[0] + b.theta2[1]) / 2, b.at);
    b.width = d2 / p->range[1] * p->width;
    b.height = d1 / p->range[0] * p->height;
    if (p->polar)
        b.width = b.height = fmin(p->zoom * d1, p->zoom * (b.theta1[0] + b.theta1[1]) / 2 * d2);
    return b;
}

/* Is the colour of a level far from that of the page's text, or near it? */
static const char *tone(int level)
{
    return abs(2 * level - HTML_LEVELS + 1) > 17 ? "strong" : "mild";
}

/* The number in its patch, as large as fits inside the outline; none where it would be too small to
 * read. */
static void write_volt(FILE *file, const draw_scale *scale, const box *b, double voltage)
{
    char text[32];
    const double margin = 10, digit = 0.6; /* of the outline on both sides; width of a digit over
                                              the size */
    const int level = draw_level(scale, voltage), decimals = scale->most >= 100  ? 0
                                                             : scale->most >= 10 ? 1
                                                                                 : 2;
    const int length = snprintf(text, sizeof text, "%.*f", decimals, fabs(voltage)) + (voltage < 0);
    const double size = fmin(fmin(b->height * 0.5, (b->width - margin) / (digit * length)), 14);
    if (size < 4.5 || level < 0)
        return;
    fprintf(file,
            "<text class=\"value %s\" style=\"font-size:%.1fpx\" x=\"%.1f\" y=\"%.1f\">%s%s</text>",
            tone(level), size, b->at[0], b->at[1] + size * 0.36,
            voltage < 0 && strtod(text, NULL) > 0 ? "&minus;" : "", text);
}

static void patch(FILE *file, const plane *p, int amplifier, const box *b, double voltage,
                  plane_outline outline, const draw_scale *scale)
{
    static const char *const said[] = {"", ", at its limit", ", beyond the limits of the scene"};
    const int level = draw_level(scale, voltage);
    char name[SCENE_LABEL];
    scene_amplifier_name(p->scene, amplifier, name);
    fputs("<g><title>", file);
    html_text(file, name);
    fputs(": ", file);
    html_quantity(file, voltage, scale->unit);
    fprintf(file, "%s</title>", said[outline]);
    if (level < 0)
        fputs("<path class=\"none", file);
    else
        fprintf(file, "<path class=\"s%d", level);
    fputs(" patch\" d=\"", file);
    cell_path(file, p, b->theta1, b->theta2, 0);
    fputs("\"/>", file);
    if (outline != OUTLINE_NONE && b->width > 5 && b->height > 5) {
        fprintf(file, "<path class=\"%s %s\" d=\"", outline == OUTLINE_LIMIT ? "limit" : "beyond",
                tone(level));
        cell_path(file, p, b->theta1, b->theta2, 2);
        fputs("\"/>", file);
    }
    write_volt(file, scale, b, voltage);
    fputs("</g>\n", file);
}

void plane_volts(FILE *file, const mesh *mesh, const int *plan, int which, const double *voltage,
                 const plane_outline *outline, const draw_scale *scale, const char *title)
{
    const scene *scene = mesh->scene;
    const plane p = plane_of(mesh);
    draw_begin_group(file, plane_width, plane_room(&p), title);
    for (int k = 0; k < scene->actuators; k++) {
        const scene_actuator *actuator = &scene->actuator[k];
        for (int d = actuator->drives - 1; plan[k] == which && d >= 0; d--)
            for (int c = 0; c < actuator->grid[0] * actuator->grid[1]; c++) {
                const box b = box_of(&p, &scene->patches[actuator->drive[d].patches],
                                     c / actuator->grid[1], c % actuator->grid[1]);
                patch(file, &p, actuator->first + c, &b, voltage[actuator->first + c],
                      outline[actuator->first + c], scale);
            }
    }
    plane_end(file, &p);
}
