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

/* Write below a map the ranges of its coordinates, or the direction from which it is seen. */
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
    shell_lines(map, NULL, "grid");
    shell_edges(map, NULL, "frame");
    write_ranges(map);
    draw_end(map->file, DRAW_IMAGE);
}

/* Return whether two actuators have patches on different layers, or drive the same patch. */
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

/*
 * Rectangle of a picture (centre, width and height in pixels) in which the number of a voltage is
 * written. The text is at most as wide as the rectangle less MARGIN.
 */
enum { MARGIN = 6 };
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
    trace area, border; /* polygons of the parts of the electrode in the elements, and lines of its
                           border */
    const char *frame;  /* style class of the border */
    double middle[2];   /* middle of the bounding box */
    bool is_hollow;     /* whether the middle lies outside the electrode, as of a ring */
    text_room room;
} electrode;

/*
 * Append a line of `count` points to lines of a picture. Returns its points for the caller to fill
 * in, or NULL, with the drawing marked as failed, where memory runs out.
 */
static double (*add_line(const shell *map, trace *trace, int count))[2]
{
    const int total = trace->count + count + 1;
    if (total > trace->room) {
        double(*more)[2] = realloc(trace->at, 2 * (size_t)total * sizeof *more);
        if (!more) {
            *map->has_failed = true;
            return NULL;
        }
        trace->at = more;
        trace->room = 2 * total;
    }
    double(*line)[2] = trace->at + trace->count;
    line[count][0] = line[count][1] = (double)NAN;
    trace->count = total;
    return line;
}

/* Append the part of an electrode in one element to its area, or a line to its border. */
static void add_piece(void *context, int element, const double (*natural)[2], size_t count)
{
    electrode *electrode = context;
    const int points = (int)(count > 2 ? count + 1 : count);
    double(*line)[2] =
        add_line(electrode->map, count > 2 ? &electrode->area : &electrode->border, points);
    for (int k = 0; line && k < points; k++) {
        const double *corner = natural[(size_t)k % count];
        const double share[2] = {(corner[0] + 1) / 2, (corner[1] + 1) / 2};
        shell_inside(electrode->map, element, share, line[k]);
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

/* Return the distance of a point from a border in pixels, negative if the point is outside it. */
static double clearance_of(const trace *border, const double place[2])
{
    double least = HUGE_VAL;
    bool is_inside = false;
    for (int k = 0; k + 1 < border->count; k++) {
        const double *from = border->at[k], *to = border->at[k + 1];
        const double along[2] = {to[0] - from[0], to[1] - from[1]};
        const double reach[2] = {place[0] - from[0], place[1] - from[1]};
        const double square = along[0] * along[0] + along[1] * along[1];
        const double dot = reach[0] * along[0] + reach[1] * along[1];
        const double share = square > 0 ? fmin(fmax(dot / square, 0), 1) : square;
        least = fmin(least, hypot(reach[0] - share * along[0], reach[1] - share * along[1]));
        if ((from[1] > place[1]) != (to[1] > place[1]) &&
            reach[0] < reach[1] / along[1] * along[0] && !isnan(square))
            is_inside = !is_inside;
    }
    return is_inside ? least : -least;
}

/*
 * Find the space for text in a hollow electrode, such as a ring: the largest circle, around a
 * corner or the middle of a diagonal of its parts, that its border does not cross. A text of five
 * digits, whose width is three times its font size, fits into the circle.
 */
static void find_circle(electrode *electrode)
{
    enum { PLACES = 500 };
    const trace *area = &electrode->area;
    text_room *room = &electrode->room;
    for (int k = 0; k + 2 < area->count; k += 1 + area->count / PLACES)
        for (int other = k; other <= k + 2; other += 2) {
            const double place[2] = {(area->at[k][0] + area->at[other][0]) / 2,
                                     (area->at[k][1] + area->at[other][1]) / 2};
            const double radius = clearance_of(&electrode->border, place);
            if (isfinite(radius) && 2 * 0.63 * radius > room->height)
                *room = (text_room){{place[0], place[1]}, 1.9 * radius + MARGIN, 2 * 0.63 * radius};
        }
}

/* Find the space for text in an electrode: its mean width and height, or a circle (find_circle). */
static void find_room(electrode *electrode)
{
    const trace *area = &electrode->area;
    const polygon_box box = polygon_box_of((const double(*)[2])area->at, (size_t)area->count);
    const double x = (box.low[0] + box.high[0]) / 2, y = (box.low[1] + box.high[1]) / 2;
    /*
     * The test whether a point lies inside the border uses a point beside the middle, because the
     * middle itself may lie at the height of a corner of the border.
     */
    const double beside[2] = {x + 0.01, y + 0.017};
    electrode->middle[0] = x;
    electrode->middle[1] = y;
    electrode->is_hollow = clearance_of(&electrode->border, beside) < 0;
    if (electrode->is_hollow)
        find_circle(electrode);
    else
        electrode->room = (text_room){{x, y},
                                      area_of(area) / (box.high[1] - box.low[1]),
                                      area_of(area) / (box.high[0] - box.low[0])};
}

/* Find the parts of a patch in the elements, and its border. */
static void add_patch(electrode *electrode, const scene_patches *patches, int index)
{
    static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const shell *map = electrode->map;
    shell part = *map;
    design_part found;
    electrode->frame = patches->outlines ? "frame" : "patch";
    for (int k = 0; patches->outlines && k < 2 * map->cells; k++)
        if (design_pieces(map->design, patches, index, k / 2, k % 2, add_piece, electrode) < 0)
            *map->has_failed = true;
    part.cell = map->cell + map->cells;
    part.cells = 0;
    for (int e = 0; !patches->outlines && e < map->cells; e++)
        if (design_patches_in(map->mesh, e, patches, &found) > 0 && found.patch == index) {
            memcpy(part.cell[part.cells++], map->cell[e], sizeof *map->cell);
            add_piece(electrode, e, square, 4);
        }
    for (int k = 0, sides = shell_outer_sides(&part); k < sides; k++) {
        double(*ends)[2] = add_line(map, &electrode->border, 2);
        if (ends)
            shell_outer_side(&part, k, ends);
    }
    find_room(electrode);
}

/* Compute the pixel coordinates of piezoelectric stack k of an actuator. */
static void stack_at(const shell *map, const scene_actuator *actuator, int k, double at[2])
{
    mesh_spot spot;
    double place[3] = {0, 0, 0};
    at[0] = at[1] = (double)NAN;
    if (mesh_spot_of_spring(map->mesh, actuator->stacks, k, &spot, place) < 0) {
        *map->has_failed = true;
        return;
    }
    if (!view_has_parameters(map->mesh))
        mesh_spot_place(map->mesh, &spot, place);
    view_project(&map->view, place, at);
}

/* Find the disc that stands for stack k of an actuator; no two discs touch. */
static void add_stack(electrode *electrode, const scene_actuator *actuator, int k)
{
    enum { CORNERS = 36 };
    const double largest = 16, share = 0.45, turn = 6.283185307179586 / CORNERS;
    double radius = largest, middle[2], other[2];
    stack_at(electrode->map, actuator, k, middle);
    for (int i = 0; i < actuator->grid[0]; i++) {
        stack_at(electrode->map, actuator, i, other);
        if (i != k)
            radius = fmin(radius, share * hypot(middle[0] - other[0], middle[1] - other[1]));
    }
    double(*area)[2] = add_line(electrode->map, &electrode->area, CORNERS + 1);
    double(*border)[2] = add_line(electrode->map, &electrode->border, CORNERS + 1);
    for (int i = 0; area && border && i <= CORNERS; i++) {
        area[i][0] = border[i][0] = middle[0] + radius * cos(i % CORNERS * turn);
        area[i][1] = border[i][1] = middle[1] + radius * sin(i % CORNERS * turn);
    }
    electrode->frame = "patch";
    find_room(electrode);
    electrode->room.width = electrode->room.height = 1.8 * radius;
}

static void draw_trace(FILE *file, const char *style, const trace *trace)
{
    put(file, DRAW_PATH, style);
    draw_line(file, (const double(*)[2])trace->at, trace->count);
    put(file, DRAW_PATH_END);
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
    const char *colour;  /* style class that colours the amplifier by its value; "none" if the value
                            has another unit than the colour scale */
    const char *outline; /* style class: "limit" at a limit, "beyond" beyond one, else "patch" */
    const char *words;   /* remark in the title on a voltage at or beyond a limit, else empty */
    bool is_marked;      /* whether the voltage is at or beyond one of its limits */
} drawn;

static drawn drawn_of(const shell *map, const voltages *result, const draw_scale *scale,
                      int amplifier)
{
    const design *design = map->design;
    static const char *const words[] = {"", ", limit active", ", beyond the limits of the scene"};
    static const char *const outline[] = {"patch", "limit", "beyond"};
    const double value = result->voltage[amplifier];
    const char *unit = design_unit(design, amplifier);
    const int beyond = shell_is_beyond(design, result, amplifier) ? 2 : 0;
    const int mark = result->at_limit[amplifier] ? 1 : beyond;
    const char *colour = unit == scale->unit ? draw_colour(scale, value) : "none";
    return (drawn){map->file,     scale,       design->amplifier_name[amplifier],
                   unit,          value,       colour,
                   outline[mark], words[mark], mark > 0};
}

/* Write the title of an amplifier's SVG element: its name and voltage. */
static void put_title(const drawn *drawn)
{
    put(drawn->file, "<title>%t: %q%s</title>", drawn->name, drawn->value, drawn->unit,
        drawn->words);
}

/* Write a voltage in the largest font that fits, if it can be read or is at a limit. */
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

static void draw_electrode(const electrode *electrode, const drawn *drawn)
{
    FILE *file = drawn->file;
    const double shrink = electrode->is_hollow ? 1 : 0.86, rest = 1 - shrink;
    fputs("<g>", file);
    put_title(drawn);
    draw_trace(file, drawn->colour, &electrode->area);
    draw_trace(file, electrode->frame, &electrode->border);
    if (drawn->is_marked) {
        put(file, "<g class=\"%s %s\" transform=\"translate(%f %f) scale(%n)\">", drawn->outline,
            draw_tone(drawn->scale, drawn->value), rest * electrode->middle[0],
            rest * electrode->middle[1], shrink);
        draw_trace(file, "", &electrode->border);
        fputs("</g>", file);
    }
    fputs("</g>\n", file);
}

/* Draw the electrodes of an actuator, or write their voltages (is_text). */
static void draw_actuator(const shell *map, const scene_actuator *actuator, const voltages *result,
                          const draw_scale *scale, bool is_text)
{
    const int count = actuator->grid[0] * actuator->grid[1];
    const int copies = actuator->stacks ? 1 : actuator->drives;
    for (int k = copies * count - 1; k >= 0; k--) {
        electrode electrode = {.map = map};
        const drawn drawn = drawn_of(map, result, scale, actuator->first + k % count);
        if (actuator->stacks)
            add_stack(&electrode, actuator, k);
        else
            add_patch(&electrode, &map->design->patches[actuator->drive[k / count].patches],
                      k % count);
        if (is_text)
            write_voltage(&drawn, &electrode.room);
        else
            draw_electrode(&electrode, &drawn);
        free(electrode.area.at);
        free(electrode.border.at);
    }
}

/* Draw all patches and stacks of a map, then their voltages, so that none lies under a patch. */
static void draw_patches(const shell *map, int which, const voltages *result,
                         const draw_scale *scale)
{
    const int actuators = map->design->actuators;
    for (int k = 0; k < 2 * actuators; k++) {
        const bool is_text = k >= actuators;
        if (map->plan[k % actuators] == which)
            draw_actuator(map, &map->design->actuator[k % actuators], result, scale, is_text);
        if (k == actuators - 1)
            shell_edges(map, NULL, "frame");
    }
    write_ranges(map);
}

static void draw_bars(const shell *map, double height, const voltages *result,
                      const draw_scale *scale)
{
    enum { NAMES = 74 };
    const double half = (SHELL_MAP_WIDTH - NAMES) / 2.0, middle = NAMES + half;
    FILE *file = map->file;
    for (int k = 0; k < map->design->amplifiers; k++) {
        const drawn drawn = drawn_of(map, result, scale, k);
        const double share = scale->most > 0 ? drawn.value / scale->most : 0;
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

void shell_voltages(const shell *map, int which, const voltages *result, const draw_scale *scale)
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
        draw_bars(map, bar, result, scale);
    else
        draw_patches(map, which, result, scale);
    draw_end(map->file, DRAW_GROUP);
}
