/* SPDX-License-Identifier: BSD-2-Clause */
/* Maps of a surface, coloured by values at the nodes or by the voltages of the electrodes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../data/polygon.h"
#include "../mesh/mesh_spot.h"
#include "report_shell.h"

/* Height of the lines of text below a map, in pixels. */
enum { FOOT = 25 };

/*
 * Write the ranges of both coordinates below a map; on a map that is a view from one direction,
 * write this direction.
 */
static void write_ranges(const shell *map)
{
    static const char *const names[2][2] = {{"x to the right", "y upwards"},
                                            {"θ₁ downwards", "θ₂ to the right"}};
    const bool has_parameters = view_has_parameters(map->mesh);
    const double *normal = map->view.axis[2], foot = map->view.height + 5;
    const double middle = SHELL_MAP_WIDTH / 2.0;
    if (map->mesh->quads)
        put(map->file, PUT_TEXT("seen along (%n, %n, %n)"), "value", middle, foot, normal[0],
            normal[1], normal[2]);
    for (int a = 0; a < 2 && !map->mesh->quads; a++) {
        const scene_line *line = &map->mesh->line[a];
        const bool is_angle = has_parameters && map->mesh->is_angle[a];
        const double low = has_parameters ? line->point[0] : map->view.low[a];
        const double high = has_parameters ? line->point[line->elements] : map->view.high[a];
        const put_unit unit =
            put_unit_of(fmax(fabs(low), fabs(high)), is_angle ? "rad" : map->design->units.length);
        put(map->file, PUT_TEXT("%s from %n to %n%u"), "value", middle, foot + 14 * a,
            names[has_parameters][a], low * unit.factor, high * unit.factor, unit.name);
    }
}

void shell_map(const shell *map, const double *value, const draw_scale *scale, const char *title)
{
    draw_begin(map->file, DRAW_IMAGE, SHELL_MAP_WIDTH, map->view.height + FOOT, title,
               "Map over the coordinates of the surface");
    shell_surface(map, value, scale);
    shell_lines(map, "grid");
    shell_edges(map, "frame");
    write_ranges(map);
    draw_end(map->file, DRAW_IMAGE);
}

/*
 * Return whether patches of two actuators may overlap on a map of the surface: an actuator has a
 * patch on another layer than a patch of the other actuator, or both drive the same patch.
 */
static bool do_overlap(const design *design, const scene_actuator *one, const scene_actuator *other)
{
    for (int k = 0; k < one->drives * other->drives; k++) {
        const int first = one->drive[k / other->drives].patches;
        const int second = other->drive[k % other->drives].patches;
        if (first == second || design->patches[first].layer != design->patches[second].layer)
            return true;
    }
    return false;
}

void shell_find_plans(shell *map)
{
    const design *design = map->design;
    const scene_actuator *actuator = design->actuator;
    int *plan = map->plan;
    for (int k = 0; k < design->actuators; k++) {
        plan[k] = actuator[k].drives > 0 || actuator[k].stacks ? 0 : -1;
        for (int other = 0; other < k; other++)
            if (plan[other] == plan[k] && do_overlap(design, &actuator[k], &actuator[other])) {
                plan[k]++;
                other = -1;
            }
        map->plans = plan[k] >= map->plans ? plan[k] + 1 : map->plans;
    }
}

/* Margin on both sides of the text of a voltage, together, in pixels. */
enum { MARGIN = 6 };

/* Space for the text of a voltage in the picture: middle, width and height in pixels. */
typedef struct text_room {
    double middle[2], width, height;
} text_room;

/* Lines of a picture in pixels, with a point NAN after each; a polygon ends where it begins. */
typedef struct trace {
    double (*at)[2];
    int count, room; /* number of points, and number for which there is memory */
} trace;

/* An electrode that is drawn on a map: a patch of whole elements, or one of arbitrary outline. */
typedef struct electrode {
    const shell *map;
    trace area, border; /* polygons of its parts in the elements, and lines of its border */
    polygon_box box;
    bool is_hollow; /* whether the middle of the box lies outside the electrode, as of a ring */
    text_room room;
} electrode;

/* Append a point to lines of a picture, which fails where memory runs out. */
static void add_point(const shell *map, trace *trace, const double at[2])
{
    if (trace->count == trace->room) {
        const size_t room = 2 * (size_t)trace->room + 64;
        double(*point)[2] = realloc(trace->at, room * sizeof *point);
        if (!point) {
            *map->has_failed = true;
            return;
        }
        trace->at = point;
        trace->room = (int)room;
    }
    memcpy(trace->at[trace->count++], at, sizeof *trace->at);
}

/* Append the part of an electrode in one element to its area, or a line to its border. */
static void add_piece(void *context, int element, const double (*natural)[2], size_t count)
{
    static const double end[2] = {(double)NAN, (double)NAN};
    electrode *electrode = context;
    trace *trace = count > 2 ? &electrode->area : &electrode->border;
    for (size_t k = 0; k < (count > 2 ? count + 1 : count); k++) {
        const double *corner = natural[k % count];
        const double share[2] = {(corner[0] + 1) / 2, (corner[1] + 1) / 2};
        double at[2];
        shell_inside(electrode->map, element, share, at);
        add_point(electrode->map, trace, at);
    }
    add_point(electrode->map, trace, end);
}

/* Find the parts of an electrode of whole elements, and its border. */
static void add_elements(electrode *electrode, const scene_patches *patches, int index)
{
    static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    static const double end[2] = {(double)NAN, (double)NAN};
    const shell *map = electrode->map;
    shell part = *map;
    design_part found;
    part.cell = map->cell + map->cells;
    part.cells = 0;
    for (int e = 0; e < map->cells; e++)
        if (design_patches_in(map->mesh, e, patches, &found) > 0 && found.patch == index) {
            memcpy(part.cell[part.cells++], map->cell[e], sizeof *map->cell);
            add_piece(electrode, e, square, 4);
        }
    const int sides = shell_outer_sides(&part);
    for (int k = 0; k < sides; k++) {
        double ends[2][2];
        shell_outer_side(&part, k, ends);
        add_point(map, &electrode->border, ends[0]);
        add_point(map, &electrode->border, ends[1]);
        add_point(map, &electrode->border, end);
    }
}

/* Return the sum of the areas of polygons in square pixels. */
static double area_of(const trace *area)
{
    double sum = 0, twice = 0;
    for (int k = 0; k + 1 < area->count; k++) {
        const double *from = area->at[k], *to = area->at[k + 1];
        const double part = from[0] * to[1] - from[1] * to[0];
        sum += isnan(part) ? fabs(twice) / 2 : 0;
        twice = isnan(part) ? 0 : twice + part;
    }
    return sum;
}

/* Return whether a point lies in one of some polygons that do not overlap. */
static bool is_inside(const trace *area, const double place[2])
{
    bool is_in = false;
    for (int k = 0; k + 1 < area->count; k++) {
        const double *from = area->at[k], *to = area->at[k + 1];
        const double share = (place[1] - from[1]) / (to[1] - from[1]);
        if ((from[1] > place[1]) != (to[1] > place[1]) &&
            place[0] < from[0] + share * (to[0] - from[0]))
            is_in = !is_in;
    }
    return is_in;
}

/* Return the distance of a point from the border of an electrode in pixels. */
static double clearance_of(const trace *border, const double place[2])
{
    double least = HUGE_VAL;
    for (int k = 0; k + 1 < border->count; k++) {
        const double *from = border->at[k], *to = border->at[k + 1];
        const double along[2] = {to[0] - from[0], to[1] - from[1]};
        const double reach[2] = {place[0] - from[0], place[1] - from[1]};
        const double square = along[0] * along[0] + along[1] * along[1];
        const double dot = reach[0] * along[0] + reach[1] * along[1];
        const double share = square > 0 ? fmin(fmax(dot / square, 0), 1) : square;
        least = fmin(least, hypot(reach[0] - share * along[0], reach[1] - share * along[1]));
    }
    return least;
}

/*
 * Make the circle around a point the space for the text of an electrode, if it is larger than the
 * space so far. A text of five digits, whose width is three times its font size, fits into it.
 */
static void try_place(electrode *electrode, const double place[2])
{
    const double radius = clearance_of(&electrode->border, place);
    if (isfinite(radius) && 2 * 0.63 * radius > electrode->room.height)
        electrode->room =
            (text_room){{place[0], place[1]}, 1.9 * radius + MARGIN, 2 * 0.63 * radius};
}

/*
 * Find the space for text in an electrode: its mean width and height, around the middle of its
 * bounding box. In a hollow electrode, such as a ring, the space is the largest circle, around a
 * corner or the middle of a diagonal of its parts, that its border does not cross.
 */
static void find_room(electrode *electrode)
{
    enum { PLACES = 500 };
    const trace *area = &electrode->area;
    const double *low = electrode->box.low, *high = electrode->box.high, sum = area_of(area);
    const double middle[2] = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
    const double beside[2] = {middle[0] + 0.01, middle[1] + 0.017}; /* the middle itself may lie on
                                                                       a side of a polygon */
    electrode->is_hollow = !is_inside(area, beside);
    if (!electrode->is_hollow)
        electrode->room =
            (text_room){{middle[0], middle[1]}, sum / (high[1] - low[1]), sum / (high[0] - low[0])};
    for (int k = 0; electrode->is_hollow && k + 2 < area->count; k += 1 + area->count / PLACES) {
        const double *corner = area->at[k], *other = area->at[k + 2];
        try_place(electrode, corner);
        try_place(electrode,
                  (const double[2]){(corner[0] + other[0]) / 2, (corner[1] + other[1]) / 2});
    }
}

/* Find the parts of an electrode, its border, and the space for text. */
static electrode open_electrode(const shell *map, const scene_patches *patches, int index)
{
    electrode electrode = {.map = map};
    for (int k = 0; patches->outlines && k < 2 * map->cells; k++)
        if (design_pieces(map->design, patches, index, k / 2, k % 2, add_piece, &electrode) < 0)
            *map->has_failed = true;
    if (!patches->outlines)
        add_elements(&electrode, patches, index);
    electrode.box =
        polygon_box_of((const double(*)[2])electrode.area.at, (size_t)electrode.area.count);
    find_room(&electrode);
    return electrode;
}

static void close_electrode(electrode *electrode)
{
    free(electrode->area.at);
    free(electrode->border.at);
}

static void draw_trace(FILE *file, const char *style, const trace *trace)
{
    draw_path(file, style);
    draw_line(file, (const double(*)[2])trace->at, trace->count);
    draw_path_end(file);
}

void shell_extend(draw_scale *scale, const design *design, const double *value)
{
    for (int k = 0; k < design->amplifiers; k++)
        if (design_unit(design, k) == scale->unit)
            draw_extend(scale, &value[k], 1);
}

bool shell_is_beyond(const design *design, const voltages *result, int amplifier)
{
    return result->voltage[amplifier] < design->lower[amplifier] ||
           result->voltage[amplifier] > design->upper[amplifier];
}

/* An amplifier in a picture of voltages, which shows it as a patch, a stack or a bar. */
typedef struct drawn {
    FILE *file;
    const draw_scale *scale;
    const char *name, *unit; /* name of the amplifier, and unit of its value */
    double value;            /* voltage of the amplifier (V), or temperature of its heaters (K) */
    const char *colour;  /* SVG style class of the colour that shows the value; "none" if the value
                            has another unit than the colour scale */
    const char *outline; /* SVG style class of the outline: "patch" for a voltage within its limits,
                            "limit" at a limit, "beyond" for one beyond its limits */
    const char *words;   /* remark in the title on a voltage at or beyond a limit, else empty */
    bool is_marked; /* whether the voltage of the amplifier is at or beyond one of its limits */
} drawn;

static drawn drawn_of(FILE *file, const design *design, const shell_voltage_set *set, int amplifier)
{
    static const char *const words[] = {"", ", limit active", ", beyond the limits of the scene"};
    static const char *const outline[] = {"patch", "limit", "beyond"};
    const double value = set->result->voltage[amplifier];
    const char *unit = design_unit(design, amplifier);
    const int beyond = shell_is_beyond(design, set->result, amplifier) ? 2 : 0;
    const int mark = set->result->at_limit[amplifier] ? 1 : beyond;
    const char *colour = unit == set->scale->unit ? draw_colour(set->scale, value) : "none";
    return (drawn){file,          set->scale,  design->amplifier_name[amplifier],
                   unit,          value,       colour,
                   outline[mark], words[mark], mark > 0};
}

/* Write the title of an amplifier's SVG element: its name and voltage. */
static void put_title(const drawn *drawn)
{
    put(drawn->file, "<title>%t: %q%s</title>", drawn->name, drawn->value, drawn->unit,
        drawn->words);
}

/*
 * Write the voltage of an amplifier on the map in the largest font that fits into the electrode. A
 * voltage at a limit is written in any case, all other voltages only if the font is large enough to
 * be read.
 */
static void write_voltage(const drawn *drawn, const text_room *room)
{
    const double digit = 0.6; /* width of a digit as a fraction of the font size */
    const double smallest = 4.5, readable = 9, largest = 14; /* font sizes of the voltages on a map
                                                                (pixels) */
    const double most = drawn->scale->most;
    char text[40];
    snprintf(text, sizeof text, "%.*f", (most < 100) + (most < 10), drawn->value);
    double size = fmin(room->height * 0.5, (room->width - MARGIN) / (digit * (double)strlen(text)));
    const bool is_over = drawn->is_marked && size < smallest;
    const char *tone = is_over ? "tag" : draw_tone(drawn->scale, drawn->value);
    const char *sign = strtod(text, NULL) < 0 ? "−" : "";
    size = is_over ? readable : fmin(size, largest);
    if (size < smallest || !isfinite(drawn->value))
        return;
    put(drawn->file, "<text class=\"value %s\" style=\"font-size:%fpx\" x=\"%f\" y=\"%f\">%s%s",
        tone, size, room->middle[0], room->middle[1] + size * 0.36, sign, text + (*text == '-'));
    put_title(drawn);
    fputs("</text>\n", drawn->file);
}

static void draw_electrode(const electrode *electrode, const drawn *drawn, const char *frame)
{
    FILE *file = drawn->file;
    const double shrink = electrode->is_hollow ? 1 : 0.86, rest = (1 - shrink) / 2;
    const polygon_box *box = &electrode->box;
    fputs("<g>", file);
    put_title(drawn);
    draw_trace(file, drawn->colour, &electrode->area);
    draw_trace(file, frame, &electrode->border);
    if (drawn->is_marked) {
        put(file, "<g class=\"%s %s\" transform=\"translate(%f %f) scale(%n)\">", drawn->outline,
            draw_tone(drawn->scale, drawn->value), rest * (box->low[0] + box->high[0]),
            rest * (box->low[1] + box->high[1]), shrink);
        draw_trace(file, "", &electrode->border);
        fputs("</g>", file);
    }
    fputs("</g>\n", file);
}

/* Draw the electrodes of an actuator, or write their voltages (is_text). */
static void draw_actuator(const shell *map, const scene_actuator *actuator,
                          const shell_voltage_set *set, bool is_text)
{
    const int count = actuator->grid[0] * actuator->grid[1];
    for (int k = actuator->drives * count - 1; k >= 0; k--) {
        const scene_patches *patches = &map->design->patches[actuator->drive[k / count].patches];
        electrode electrode = open_electrode(map, patches, k % count);
        const drawn drawn = drawn_of(map->file, map->design, set, actuator->first + k % count);
        if (is_text)
            write_voltage(&drawn, &electrode.room);
        else
            draw_electrode(&electrode, &drawn, patches->outlines ? "frame" : "patch");
        close_electrode(&electrode);
    }
}

/* Compute the pixel coordinates of piezoelectric stack k of an actuator; NAN if memory runs out. */
static void stack_at(const shell *map, const scene_actuator *actuator, int k, double at[2])
{
    mesh_spot spot;
    double place[3] = {0, 0, 0};
    at[0] = at[1] = (double)NAN;
    if (mesh_spot_of_spring(map->mesh, actuator->stacks, k, &spot, place) < 0)
        return;
    if (!view_has_parameters(map->mesh))
        mesh_spot_place(map->mesh, &spot, place);
    view_project(&map->view, place, at);
}

/* Radius at which the discs that stand for the stacks of an actuator do not touch (pixels). */
static double stack_radius(const shell *map, const scene_actuator *actuator)
{
    const double largest = 16, share = 0.45;
    double radius = largest, own[2], other[2];
    for (int k = 0; k < actuator->grid[0]; k++)
        for (int i = 0; i < k; i++) {
            stack_at(map, actuator, k, own);
            stack_at(map, actuator, i, other);
            radius = fmin(radius, share * hypot(own[0] - other[0], own[1] - other[1]));
        }
    return radius;
}

/* Draw the stacks of an actuator as discs, or write their voltages (is_text). */
static void draw_stacks(const shell *map, const scene_actuator *actuator,
                        const shell_voltage_set *set, bool is_text)
{
    const double radius = stack_radius(map, actuator);
    for (int k = 0; k < actuator->grid[0]; k++) {
        text_room room = {.width = 1.8 * radius, .height = 1.8 * radius};
        stack_at(map, actuator, k, room.middle);
        const drawn drawn = drawn_of(map->file, map->design, set, actuator->first + k);
        if (is_text) {
            write_voltage(&drawn, &room);
            continue;
        }
        fputs("<g>", map->file);
        put_title(&drawn);
        draw_disc(map->file, drawn.colour, room.middle, radius);
        if (drawn.is_marked)
            draw_disc(map->file, drawn.outline, room.middle, radius - 1);
        fputs("</g>\n", map->file);
    }
}

/* Draw all patches and stacks of a map, then their voltages, so that none lies under a patch. */
static void draw_patches(const shell *map, int which, const shell_voltage_set *set)
{
    const int actuators = map->design->actuators;
    for (int k = 0; k < 2 * actuators; k++) {
        const scene_actuator *actuator = &map->design->actuator[k % actuators];
        if (map->plan[k % actuators] == which)
            (actuator->stacks ? draw_stacks : draw_actuator)(map, actuator, set, k >= actuators);
        if (k == actuators - 1)
            shell_edges(map, "frame");
    }
    write_ranges(map);
}

static void draw_bars(const shell *map, double height, const shell_voltage_set *set)
{
    enum { NAMES = 74 };
    const double half = (SHELL_MAP_WIDTH - NAMES) / 2.0, middle = NAMES + half;
    FILE *file = map->file;
    for (int k = 0; k < map->design->amplifiers; k++) {
        const drawn drawn = drawn_of(file, map->design, set, k);
        const double share = set->scale->most > 0 ? drawn.value / set->scale->most : 0;
        const char *const style[2] = {drawn.colour, drawn.outline};
        fputs("<g>", file);
        put_title(&drawn);
        for (int i = 0; i < 2; i++)
            put(file, "<path class=\"%s\" d=\"M%f %fh%fv%fH%fz\"/>", style[i], middle,
                height * k + 1, half * share, height - 2, middle);
        draw_name(file, NAMES - 6, height * k, height, map->design->amplifier_name[k]);
        fputs("</g>\n", file);
    }
    put(file, "<path class=\"grid\" d=\"M%f 0V%f\"/>", middle, height * map->design->amplifiers);
}

void shell_voltages(const shell *map, int which, const shell_voltage_set *set)
{
    const int bars = map->plans > 0 ? 0 : map->design->amplifiers;
    const double bar = fmin(fmax(330.0 / bars, 2), 18);
    const double height = bars ? bar * bars + 4 : map->view.height + FOOT;
    const design_inputs inputs = design_inputs_of(map->design);
    char title[64], description[80];
    snprintf(title, sizeof title, "%ss of the amplifiers", inputs.title);
    snprintf(description, sizeof description,
             bars ? "A bar for each amplifier, to the right for positive %ss"
                  : "Every patch in the colour of its %s",
             inputs.name);
    draw_begin(map->file, DRAW_GROUP, SHELL_MAP_WIDTH, height, title, description);
    if (bars)
        draw_bars(map, bar, set);
    else
        draw_patches(map, which, set);
    draw_end(map->file, DRAW_GROUP);
}
