/* SPDX-License-Identifier: BSD-2-Clause */
/* Maps of a surface, coloured by values at the nodes or by the voltages of the electrodes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../mesh/mesh_spot.h"
#include "../scene/outline_pieces.h"
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
    if (map->mesh->quads)
        draw_text(map->file, "value", SHELL_MAP_WIDTH / 2, foot, "seen along (%n, %n, %n)",
                  normal[0], normal[1], normal[2]);
    for (int a = 0; a < 2 && !map->mesh->quads; a++) {
        const scene_line *line = &map->mesh->line[a];
        const bool is_angle = has_parameters && map->mesh->is_angle[a];
        const double low = has_parameters ? line->point[0] : map->view.low[a];
        const double high = has_parameters ? line->point[line->elements] : map->view.high[a];
        const put_unit unit =
            put_unit_of(fmax(fabs(low), fabs(high)), is_angle ? "rad" : map->design->units.length);
        draw_text(map->file, "value", SHELL_MAP_WIDTH / 2, foot + 14 * a, "%s from %n to %n%u",
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

/*
 * An electrode that is drawn on a map: a patch of whole elements, or an electrode of arbitrary
 * outline.
 */
typedef struct electrode {
    shell part; /* picture of the elements that the electrode covers; for an electrode of arbitrary
                   outline, of the whole mesh */
    const scene_patches *patches;
    int index; /* index of the electrode in its grid of patches or in its list of outlines */
    double low[2], high[2], area; /* bounding box (low, high) and area of the electrode in pixels */
    bool is_hollow;   /* whether the middle of the bounding box lies outside the electrode, as of a
                         ring */
    int sides;        /* number of outer sides of a hollow patch of whole elements */
    int pieces;       /* number of the electrode's parts, each of which lies in one element */
    int tried;        /* number of parts that the search for the space of a text has passed */
    double place[2];  /* a point of the picture (pixels) */
    double clearance; /* its distance from the border of the electrode (pixels) */
    double radius;    /* largest of these distances so far (pixels) */
    text_room room;
} electrode;

/*
 * Function that does something with the part of an electrode that lies in one element.
 *   natural [count][2]  in  corners of the part in natural coordinates of the element, -1 to 1; two
 *                           are a line
 */
typedef void piece_function(void *context, int element, const double (*natural)[2], size_t count);

/* Compute the pixel coordinates of a corner of the part of an electrode in one element. */
static void corner_at(const electrode *electrode, int element, const double natural[2],
                      double at[2])
{
    const double share[2] = {(natural[0] + 1) / 2, (natural[1] + 1) / 2};
    shell_inside(&electrode->part, element, share, at);
}

/* Draw the part of an electrode that lies in one element, as an area or as a line. */
static void draw_piece(void *context, int element, const double (*natural)[2], size_t count)
{
    const electrode *electrode = context;
    bool is_drawing = false;
    for (size_t k = 0; k < count; k++) {
        double at[2];
        corner_at(electrode, element, natural[k], at);
        draw_step(electrode->part.file, &is_drawing, at);
    }
    fputs(count > 2 ? "z" : "", electrode->part.file);
}

/* Add the part of an electrode that lies in one element to its bounding box and area. */
static void measure_piece(void *context, int element, const double (*natural)[2], size_t count)
{
    electrode *electrode = context;
    double before[2] = {0, 0}, at[2], twice = 0;
    for (size_t k = 0; k <= count; k++) {
        corner_at(electrode, element, natural[k % count], at);
        twice += k > 0 ? before[0] * at[1] - before[1] * at[0] : 0;
        for (int i = 0; i < 2; i++) {
            electrode->low[i] = fmin(electrode->low[i], at[i]);
            electrode->high[i] = fmax(electrode->high[i], at[i]);
            before[i] = at[i];
        }
    }
    electrode->area += fabs(twice) / 2;
    electrode->pieces++;
}

/* Call a function for all parts of an electrode, or of its border (is_border). */
static void each_piece(electrode *electrode, bool is_border, piece_function *function)
{
    static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const shell *part = &electrode->part;
    for (int k = 0; k < part->cells; k++)
        if (electrode->patches->outlines)
            design_pieces(part->design, electrode->patches, electrode->index, k, is_border,
                          function, electrode);
        else
            function(electrode, k, square, 4);
}

/* Note that an electrode is not hollow if its part in one element contains the point `place`. */
static void find_inside(void *context, int element, const double (*natural)[2], size_t count)
{
    electrode *electrode = context;
    const double *place = electrode->place;
    bool is_inside = false;
    for (size_t k = 0; k < count; k++) {
        double from[2], to[2];
        corner_at(electrode, element, natural[k], from);
        corner_at(electrode, element, natural[(k + 1) % count], to);
        const double rise = to[1] - from[1], run = to[0] - from[0];
        if ((from[1] > place[1]) != (to[1] > place[1]) &&
            place[0] - from[0] < (place[1] - from[1]) * run / rise)
            is_inside = !is_inside;
    }
    electrode->is_hollow = electrode->is_hollow && !is_inside;
}

/* Lower the clearance of an electrode to the distance of `place` from a part of its border. */
static void approach(electrode *electrode, const double from[2], const double to[2])
{
    const double along[2] = {to[0] - from[0], to[1] - from[1]};
    const double reach[2] = {electrode->place[0] - from[0], electrode->place[1] - from[1]};
    const double square = along[0] * along[0] + along[1] * along[1];
    const double dot = reach[0] * along[0] + reach[1] * along[1];
    const double share = square > 0 ? fmin(fmax(dot / square, 0), 1) : 0;
    electrode->clearance =
        fmin(electrode->clearance, hypot(reach[0] - share * along[0], reach[1] - share * along[1]));
}

/* Lower the clearance of an electrode to the distance of `place` from its border in an element. */
static void approach_piece(void *context, int element, const double (*natural)[2], size_t count)
{
    double from[2], to[2];
    for (size_t k = 0; k + 1 < count; k++) {
        corner_at(context, element, natural[k], from);
        corner_at(context, element, natural[k + 1], to);
        approach(context, from, to);
    }
}

/*
 * Make the circle around a point the space for the text of an electrode, if no circle inside the
 * electrode was larger so far.
 */
static void try_place(electrode *electrode, int element, const double natural[2])
{
    corner_at(electrode, element, natural, electrode->place);
    electrode->clearance = HUGE_VAL;
    for (int k = 0; k < electrode->sides; k++) {
        double end[2][2];
        shell_outer_side(&electrode->part, k, end);
        approach(electrode, end[0], end[1]);
    }
    if (electrode->patches->outlines)
        each_piece(electrode, true, approach_piece);
    const double radius = electrode->clearance;
    if (!isfinite(radius) || radius <= electrode->radius)
        return;
    electrode->radius = radius;
    /* A text of five digits, whose width is three times its font size, fits into the circle. */
    electrode->room = (text_room){
        {electrode->place[0], electrode->place[1]}, 1.9 * radius + MARGIN, 2 * 0.63 * radius};
}

/* Try the middle and the first corner of one of some parts of an electrode (try_place). */
static void try_piece(void *context, int element, const double (*natural)[2], size_t count)
{
    enum { PLACES = 100 };
    electrode *electrode = context;
    double middle[2] = {0, 0};
    if (electrode->tried++ % (1 + electrode->pieces / PLACES) != 0)
        return;
    for (size_t k = 0; k < 2 * count; k++)
        middle[k % 2] += natural[k / 2][k % 2] / (double)count;
    try_place(electrode, element, middle);
    try_place(electrode, element, natural[0]);
}

/*
 * Find the space for text in an electrode: its mean width and height, around the middle of its
 * bounding box. In a hollow electrode, such as a ring, the space is the largest circle, around the
 * middle or a corner of the electrode's part in an element, that its border does not cross.
 */
static void find_room(electrode *electrode)
{
    const double *low = electrode->low, *high = electrode->high;
    for (int i = 0; i < 2; i++)
        electrode->place[i] = electrode->room.middle[i] = (low[i] + high[i]) / 2;
    electrode->room.width = electrode->area / (high[1] - low[1]);
    electrode->room.height = electrode->area / (high[0] - low[0]);
    electrode->is_hollow = true;
    each_piece(electrode, false, find_inside);
    if (!electrode->is_hollow)
        return;
    electrode->sides = electrode->patches->outlines ? 0 : shell_outer_sides(&electrode->part);
    each_piece(electrode, false, try_piece);
}

/* Prepare the drawing of an electrode: find its elements, bounding box, and space for text. */
static electrode open_electrode(const shell *map, const scene_patches *patches, int index)
{
    electrode electrode = {.part = *map,
                           .patches = patches,
                           .index = index,
                           .low = {HUGE_VAL, HUGE_VAL},
                           .high = {-HUGE_VAL, -HUGE_VAL}};
    design_part found;
    if (!patches->outlines) {
        electrode.part.cell = map->cell + map->cells;
        electrode.part.cells = 0;
        for (int e = 0; e < map->cells; e++)
            if (design_patches_in(map->mesh, e, patches, &found) > 0 && found.patch == index)
                memcpy(electrode.part.cell[electrode.part.cells++], map->cell[e],
                       sizeof *map->cell);
    }
    each_piece(&electrode, false, measure_piece);
    find_room(&electrode);
    return electrode;
}

/* Draw the border (is_border) or the area of an electrode on a map, with an SVG style class. */
static void draw_pieces(electrode *electrode, bool is_border, const char *style)
{
    if (is_border && !electrode->patches->outlines) {
        shell_edges(&electrode->part, style);
        return;
    }
    draw_path(electrode->part.file, style);
    each_piece(electrode, is_border, draw_piece);
    draw_path_end(electrode->part.file);
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

static void draw_electrode(electrode *electrode, const drawn *drawn)
{
    FILE *file = drawn->file;
    const double shrink = electrode->is_hollow ? 1 : 0.86, rest = (1 - shrink) / 2;
    fputs("<g>", file);
    put_title(drawn);
    draw_pieces(electrode, false, drawn->colour);
    draw_pieces(electrode, true, electrode->patches->outlines ? "frame" : "patch");
    if (drawn->is_marked) {
        put(file, "<g class=\"%s %s\" transform=\"translate(%f %f) scale(%n)\">", drawn->outline,
            draw_tone(drawn->scale, drawn->value), rest * (electrode->low[0] + electrode->high[0]),
            rest * (electrode->low[1] + electrode->high[1]), shrink);
        draw_pieces(electrode, true, "");
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
        const scene_drive *drive = &actuator->drive[k / count];
        electrode electrode = open_electrode(map, &map->design->patches[drive->patches], k % count);
        const drawn drawn = drawn_of(map->file, map->design, set, actuator->first + k % count);
        if (is_text)
            write_voltage(&drawn, &electrode.room);
        else
            draw_electrode(&electrode, &drawn);
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
