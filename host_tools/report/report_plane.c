/* SPDX-License-Identifier: BSD-2-Clause */
/* Pictures over the parameter plane of a shell: maps and voltages (report_shell.h). */
#include "report_shell.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "report_outlines.h"
#include "report_quads.h"
#include "../text/words.h"

static const double full_turn = 6.283185307179586, left_margin = 34, top_margin = 6;

/* ---- plane ------------------------------------------------------------ */

void plane_at(const shell_plane *p, double theta1, double theta2, double at[2])
{
    if (p->is_polar) {
        at[0] = p->x0 + p->centre[0] + p->zoom * theta1 * cos(theta2);
        at[1] = p->y0 + p->centre[1] - p->zoom * theta1 * sin(theta2);
    } else {
        at[0] = p->x0 + (theta2 - p->low[1]) / p->range[1] * p->width;
        at[1] = p->y0 + (theta1 - p->low[0]) / p->range[0] * p->height;
    }
}

double plane_theta(const mesh *mesh, int a, double line)
{
    const scene_line *points = &mesh->scene->line[a];
    const int below = (int)fmin(line, points->elements - 1);
    return points->point[below] +
           (line - below) * (points->point[below + 1] - points->point[below]);
}

/* Scale a polar plate, a disc or a sector, to fit into a square of side `room` pixels. */
static void fit_polar(shell_plane *p, double room)
{
    enum { POINTS = 65 };
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    p->zoom = 1;
    for (int k = 0; k < 2 * POINTS; k++) {
        double at[2];
        plane_at(p, p->low[0] + k % 2 * p->range[0],
                 p->low[1] + p->range[1] * (k / 2) / (POINTS - 1), at);
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], at[i]);
            high[i] = fmax(high[i], at[i]);
        }
    }
    p->zoom = room / fmax(high[0] - low[0], high[1] - low[1]);
    p->width = p->zoom * (high[0] - low[0]);
    p->height = p->zoom * (high[1] - low[1]);
    p->centre[0] = p->zoom * (p->x0 - low[0]);
    p->centre[1] = p->zoom * (p->y0 - low[1]);
    p->x0 = (SHELL_PLANE_WIDTH - p->width) / 2;
}

/*
 * Set the size of the rectangle of all other surfaces: its aspect ratio is that of the mean lengths
 * of the shell along theta1 and theta2, within 0.3 and 3.
 */
static void fit_rectangle(shell_plane *p, const mesh *mesh, double room)
{
    double length[2];
    for (int a = 0; a < 2; a++) {
        double metric = 0;
        for (int n = 0; n < mesh->nodes; n++)
            metric += mesh->point[n].a[a] / mesh->nodes;
        length[a] = metric * p->range[a];
    }
    const double aspect = fmin(fmax(length[0] / length[1], 0.3), 3);
    p->width = room / fmax(aspect, 1);
    p->height = room * fmin(aspect, 1);
    p->x0 += (room - p->width) / 2;
}

/*
 * Whether an axis is too short for its name to stand between the numbers at its ends; the name is
 * then written on a line below.
 */
static bool is_short(double length)
{
    return length < 150;
}

/*
 * Set range and size of the picture of a mesh of points: x to the right and y upwards, at the same
 * scale.
 */
static void fit_points(shell_plane *p, const mesh *mesh, double room)
{
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int n = 0; n < mesh->nodes; n++)
        for (int a = 0; a < 2; a++) {
            low[a] = fmin(low[a], mesh->point[n].x[a]);
            high[a] = fmax(high[a], mesh->point[n].x[a]);
        }
    const double most = fmax(fmax(high[0] - low[0], high[1] - low[1]), 1e-300);
    for (int a = 0; a < 2; a++) {
        const double edge = 0.04 * most + (high[a] - low[a] < 0.1 * most ? 0.1 * most : 0);
        low[a] -= edge;
        high[a] += edge;
    }
    const double zoom = room / fmax(high[0] - low[0], high[1] - low[1]);
    p->low[0] = high[1];
    p->range[0] = low[1] - high[1];
    p->low[1] = low[0];
    p->range[1] = high[0] - low[0];
    p->width = zoom * (high[0] - low[0]);
    p->height = zoom * (high[1] - low[1]);
    p->x0 += (room - p->width) / 2;
}

/* Name of the direction downwards (a = 0) or to the right (a = 1). */
static const char *axis_name(const shell *s, int a)
{
    static const char *const of_points[2] = {"y", "x"};
    return s->m->elements == 0 ? of_points[a] : SHELL_THETA(a);
}

shell shell_in_plane(FILE *file, const mesh *mesh)
{
    shell s = {.file = file, .m = mesh, .plane = {.x0 = left_margin, .y0 = top_margin}};
    shell_plane *p = &s.plane;
    const double room = SHELL_PLANE_WIDTH - left_margin - 2;
    if (mesh->quads) {
        quads_plane(p, mesh);
        return s;
    }
    for (int a = 0; a < 2 && mesh->elements > 0; a++) {
        const scene_line *line = &mesh->scene->line[a];
        p->low[a] = line->point[0];
        p->range[a] = line->point[line->elements] - line->point[0];
    }
    p->is_polar = mesh->scene->surface.type == SURFACE_POLAR;
    if (mesh->elements == 0)
        fit_points(p, mesh, room);
    else if (p->is_polar)
        fit_polar(p, room);
    else
        fit_rectangle(p, mesh, room);
    p->picture_height = p->y0 + p->height + (p->is_polar || is_short(p->width) ? 34 : 20);
    return s;
}

/* ---- axes ------------------------------------------------------------- */

/*
 * Most readable unit of theta1 (a = 0) or theta2 (a = 1).
 *   unit [WORDS_UNIT]  work  memory for the name of the unit
 */
static put_unit theta_unit(const shell *s, int a, char *unit)
{
    const shell_plane *p = &s->plane;
    words_unit(s->m->scene, words_of_theta(s->m->scene, a), unit);
    return put_unit_of(fmax(fabs(p->low[a]), fabs(p->low[a] + p->range[a])), unit);
}

/* Write the ranges of theta1 and theta2 of a polar plate, one line each. */
static void polar_words(const shell *s)
{
    static const char *const way[2] = {", from the centre", ", anticlockwise from the right"};
    const shell_plane *p = &s->plane;
    for (int a = 0; a < 2; a++) {
        char room[WORDS_UNIT];
        const put_unit unit = theta_unit(s, a, room);
        put(s->file, "<text class=\"value\" x=\"160\" y=\"%f\">%s from %n to %n%u%s</text>\n",
            p->y0 + p->height + 16 + 14 * a, SHELL_THETA(a), p->low[a] * unit.factor,
            (p->low[a] + p->range[a]) * unit.factor, unit.name, way[a]);
    }
}

/* Write the numbers at both ends of a horizontal axis, and its name between them. */
static void axis_words(const shell *s, int a, double length)
{
    const shell_plane *p = &s->plane;
    char room[WORDS_UNIT];
    const put_unit unit = theta_unit(s, a, room);
    put(s->file, "<text>%n</text><text class=\"value\" x=\"%f\" y=\"%f\">%s",
        p->low[a] * unit.factor, length / 2, is_short(length) ? 13.0 : 0.0, axis_name(s, a));
    put(s->file, *unit.name ? " (%t)" : "", unit.name);
    put(s->file, "</text><text class=\"end\" x=\"%f\">%n</text></g>\n", length,
        (p->low[a] + p->range[a]) * unit.factor);
}

static void plane_end(const shell *s, draw_type type)
{
    shell_edges(s, "frame");
    if (s->m->quads) {
        quads_words(s);
    } else if (s->plane.is_polar) {
        polar_words(s);
    } else {
        put(s->file, "<g transform=\"translate(%f %f) rotate(90)\">", s->plane.x0 - 14,
            s->plane.y0);
        axis_words(s, 0, s->plane.height);
        put(s->file, "<g transform=\"translate(%f %f)\">", s->plane.x0,
            s->plane.y0 + s->plane.height + 14);
        axis_words(s, 1, s->plane.width);
    }
    draw_end(s->file, type);
}

int shell_map(FILE *file, const mesh *mesh, const double *value, const draw_scale *scale,
              const char *title)
{
    const shell s = shell_in_plane(file, mesh);
    draw_begin(file, DRAW_IMAGE, SHELL_PLANE_WIDTH, s.plane.picture_height, title,
               mesh->quads ? "Map of the surface, seen along its mean normal"
                           : "Map over the parameters theta1 and theta2 of the surface");
    const int failed = shell_surface(&s, value, scale);
    shell_lines(&s, "grid");
    plane_end(&s, DRAW_IMAGE);
    return failed;
}

/* ---- voltages on the patches ------------------------------------------ */

/* Whether any patches of two actuators overlap in the parameter plane. */
static bool do_overlap(const scene *scene, const scene_actuator *x, const scene_actuator *y)
{
    for (int k = 0; k < x->drives * y->drives; k++) {
        const scene_patches *patches = &scene->patches[x->drive[k / y->drives].patches];
        const scene_patches *q = &scene->patches[y->drive[k % y->drives].patches];
        bool is_over;
        if (patches->outlines || q->outlines)
            is_over = outlines_meet(patches, q);
        else if (patches->patch)
            is_over = quads_overlap(scene, patches, q);
        else
            is_over = patches->theta1[0] < q->theta1[1] && q->theta1[0] < patches->theta1[1] &&
                      patches->theta2[0] < q->theta2[1] && q->theta2[0] < patches->theta2[1];
        if (is_over)
            return true;
    }
    return false;
}

/* Whether actuator k overlaps one of the earlier actuators on the same plan. */
static bool is_taken(const scene *scene, const int *plan, int k)
{
    for (int other = 0; other < k; other++)
        if (plan[other] == plan[k] &&
            do_overlap(scene, &scene->actuator[k], &scene->actuator[other]))
            return true;
    return false;
}

int shell_plans(const scene *scene, int *plan)
{
    int plans = 0;
    for (int k = 0; k < scene->actuators; k++) {
        plan[k] = scene->actuator[k].is_temperature || scene->actuator[k].drives == 0 ? -1 : 0;
        while (plan[k] >= 0 && is_taken(scene, plan, k))
            plan[k]++;
        plans = plan[k] >= plans ? plan[k] + 1 : plans;
    }
    return plans;
}

/*
 * One patch in the picture: its range of theta1 and theta2, the centre of its text, and the width
 * and height available for this text (pixels).
 */
typedef struct tile {
    double theta[2][2], at[2], width, height;
    bool is_ring;
} tile;

/*
 * Compute the centre and the available size of the text on a sector, from its radial and tangential
 * extent and its direction in the picture.
 */
static void polar_room(const shell_plane *p, tile *t)
{
    double angle = (t->theta[1][0] + t->theta[1][1]) / 2;
    if (t->is_ring)
        angle = full_turn / 4;
    const double radius = p->zoom * (t->theta[0][0] + t->theta[0][1]) / 2;
    const double radial = p->zoom * (t->theta[0][1] - t->theta[0][0]);
    const double tangential = fmin(radius * (t->theta[1][1] - t->theta[1][0]), radius);
    const double c = fabs(cos(angle)) + 1e-9, s = fabs(sin(angle)) + 1e-9;
    plane_at(p, (t->theta[0][0] + t->theta[0][1]) / 2, angle, t->at);
    t->width = fmin(radial / c, tangential / s);
    t->height = fmin(radial / s, tangential / c);
}

/* The patch in row i and column j of a grid of patches. */
static tile tile_of(const shell_plane *p, const scene_patches *patches, int i, int j)
{
    const double *theta[2] = {patches->theta1, patches->theta2};
    const int at[2] = {i, j};
    tile t;
    for (int a = 0; a < 2; a++) {
        const double size = (theta[a][1] - theta[a][0]) / patches->grid[a];
        t.theta[a][0] = theta[a][0] + at[a] * size;
        t.theta[a][1] = t.theta[a][0] + size;
    }
    plane_at(p, (t.theta[0][0] + t.theta[0][1]) / 2, (t.theta[1][0] + t.theta[1][1]) / 2, t.at);
    t.is_ring = p->is_polar && t.theta[1][1] - t.theta[1][0] > full_turn * (1 - 1e-9);
    t.width = (t.theta[1][1] - t.theta[1][0]) / p->range[1] * p->width;
    t.height = (t.theta[0][1] - t.theta[0][0]) / p->range[0] * p->height;
    if (p->is_polar)
        polar_room(p, &t);
    return t;
}

/*
 * Compute the points of one side of a tile, at constant theta1, with theta2 going from `from` to
 * `to`. Returns their number.
 */
static int tile_side(const shell_plane *p, double theta1, double from, double to, double (*at)[2])
{
    const int steps = p->is_polar ? 2 + (int)(fabs(to - from) / 0.06) : 1;
    for (int k = 0; k <= steps; k++)
        plane_at(p, theta1, from + (to - from) * k / steps, at[k]);
    return steps + 1;
}

/*
 * Draw the outline of a tile, made smaller by `inset` pixels on all sides. A full ring is drawn as
 * two closed curves.
 */
static void tile_path(FILE *file, const shell_plane *p, const tile *t, double inset)
{
    enum { MOST = 2 * (3 + 105) };
    double at[MOST][2], low[2], high[2];
    const double radius = fmax(p->zoom * (t->theta[0][0] + t->theta[0][1]) / 2, 2 * inset + 1e-9);
    double pixel[2] = {p->range[0] / p->height, p->range[1] / p->width};
    if (p->is_polar) {
        pixel[0] = 1 / p->zoom;
        pixel[1] = t->is_ring ? 0 : 1 / radius;
    }
    for (int a = 0; a < 2; a++) {
        low[a] = t->theta[a][0] + inset * pixel[a];
        high[a] = t->theta[a][1] - inset * pixel[a];
    }
    const int first = tile_side(p, low[0], low[1], high[1], at);
    const int count = first + tile_side(p, high[0], high[1], low[1], at + first);
    draw_polygon(file, (const double(*)[2])at, t->is_ring ? first : count);
    if (t->is_ring)
        draw_polygon(file, (const double(*)[2])(at + first), count - first);
}

/*
 * Write the voltage in its tile, as large as it fits. If it does not fit at a readable size, it is
 * left out, except at a limit, where it is written over the neighbouring tiles.
 */
static void write_voltage(FILE *file, const draw_scale *scale, const tile *t, double voltage,
                          shell_mark mark)
{
    const double digit = 0.6, smallest = 4.5, readable = 9; /* digit: width over font size;
                                                               smallest, readable: font sizes in
                                                               pixels */
    int decimals = 0;
    char text[40];
    while (decimals < 2 && scale->most < (decimals ? 10 : 100))
        decimals++;
    snprintf(text, sizeof text, "%.*f", decimals, voltage);
    double size = fmin(fmin(t->height * 0.5, (t->width - 6) / (digit * (double)strlen(text))), 14);
    const bool is_over = mark != SHELL_FREE && size < smallest;
    const char *tone = is_over ? "tag" : draw_tone(scale, voltage);
    const char *sign = strtod(text, NULL) < 0 ? "−" : "";
    size = is_over ? readable : size;
    if (size >= smallest)
        put(file, "<text class=\"value %s\" style=\"font-size:%fpx\" x=\"%f\" y=\"%f\">%s%s</text>",
            tone, size, t->at[0], t->at[1] + size * 0.36, sign, text + (*text == '-'));
}

/* What the title of a patch says of a voltage, for each shell_mark. */
static const char *const limit_words[] = {"", ", limit active", ", beyond the limits of the scene"};

static void draw_tile(const shell *s, int amplifier, const tile *t, double voltage, shell_mark mark,
                      const draw_scale *scale)
{
    static const char *const style[] = {"", "limit", "beyond"};
    char name[SCENE_LABEL];
    scene_amplifier_name(s->m->scene, amplifier, name);
    put(s->file, "<g><title>%t: %q%s</title><path class=\"%s patch\" d=\"", name, voltage,
        scale->unit, limit_words[mark], draw_class(scale, draw_level(scale, voltage)));
    tile_path(s->file, &s->plane, t, 0);
    fputs("\"/>", s->file);
    if (mark != SHELL_FREE) {
        const char *tone = draw_tone(scale, voltage);
        const double inset = *tone == 's' ? fmin(t->height / 4, 4) : 2;
        put(s->file, "<path class=\"%s %s\" d=\"", style[mark], tone);
        tile_path(s->file, &s->plane, t, inset);
        fputs("\"/>", s->file);
    }
    if (isfinite(voltage))
        write_voltage(s->file, scale, t, voltage, mark);
    fputs("</g>\n", s->file);
}

/* Draw one patch of a mesh from a file, or one electrode of any outline, with its voltage. */
static void draw_set(const shell *s, const scene_patches *patches, int patch, int amplifier,
                     double voltage, shell_mark mark, const draw_scale *scale)
{
    static const char *const style[] = {"frame", "limit", "beyond"};
    char name[SCENE_LABEL];
    tile t;
    memset(&t, 0, sizeof t);
    (patches->outlines ? outlines_room : quads_patch_room)(s, patches, patch, t.at, &t.width);
    t.height = t.width;
    scene_amplifier_name(s->m->scene, amplifier, name);
    put(s->file, "<g><title>%t: %q%s</title><path class=\"%s\" d=\"", name, voltage, scale->unit,
        limit_words[mark], draw_class(scale, draw_level(scale, voltage)));
    (patches->outlines ? outlines_area : quads_patch)(s, patches, patch);
    put(s->file, "\"/><path class=\"%s %s\" d=\"", style[mark], draw_tone(scale, voltage));
    (patches->outlines ? outlines_border : quads_patch_outline)(s, patches, patch);
    fputs("\"/>", s->file);
    if (isfinite(voltage))
        write_voltage(s->file, scale, &t, voltage, mark);
    fputs("</g>\n", s->file);
}

/* Draw all patches of an actuator with their voltages. */
static void draw_actuator(const shell *s, const scene_actuator *actuator, const double *voltage,
                          const shell_mark *mark, const draw_scale *scale)
{
    const int cells = actuator->grid[0] * actuator->grid[1];
    for (int k = actuator->drives * cells - 1; k >= 0; k--) {
        const int cell = k % cells, amplifier = actuator->first + cell;
        const scene_patches *patches = &s->m->scene->patches[actuator->drive[k / cells].patches];
        if (patches->patch || patches->outlines) {
            draw_set(s, patches, cell, amplifier, voltage[amplifier], mark[amplifier], scale);
            continue;
        }
        const tile t =
            tile_of(&s->plane, patches, cell / actuator->grid[1], cell % actuator->grid[1]);
        draw_tile(s, amplifier, &t, voltage[amplifier], mark[amplifier], scale);
    }
}

void shell_voltages(FILE *file, const mesh *mesh, const int *plan, int which, const double *voltage,
                    const shell_mark *mark, const draw_scale *scale)
{
    const shell s = shell_in_plane(file, mesh);
    draw_begin(file, DRAW_GROUP, SHELL_PLANE_WIDTH, s.plane.picture_height,
               "Voltages of the amplifiers",
               "Every patch in the colour of its voltage, its value written where there is room");
    for (int k = 0; k < mesh->scene->actuators; k++)
        if (plan[k] == which)
            draw_actuator(&s, &mesh->scene->actuator[k], voltage, mark, scale);
    plane_end(&s, DRAW_GROUP);
}
