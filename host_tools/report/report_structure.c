/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables that describe the structure (report_page.h): layers, materials, supports, loads, contact,
 * actuators and target.
 */
#include <math.h>
#include <string.h>
#include "../model/matrix_facts.h"
#include "report_page.h"
#include "../text/words.h"

static const char *const component_word[] = {"u₁", "u₂", "u₃", "x", "y", "z"};
static const char *const face_word[] = {"middle", "inner face", "outer face", "mean of the faces"};
static const char *const end_cell = "</td></tr>\n";

/* Begin a table row with a heading and one wrapped cell for a description. */
static void begin_row(FILE *file, const char *kind, const char *name)
{
    put(file, "<tr><th scope=\"row\">%s%t</th><td class=\"note\">", kind, name);
}

static void write_where(FILE *file, const scene *scene, const scene_where *where)
{
    static const char *const edge[] = {"", "edge θ₁−", "edge θ₁+", "edge θ₂−", "edge θ₂+"};
    static const char *const set[] = {"", "all nodes", "", "nodes of a rectangle"};
    char unit[2][WORDS_UNIT];
    for (int a = 0; a < 2; a++)
        words_unit(scene, words_of_theta(scene, a), unit[a]);
    if (where->type == WHERE_SET)
        put(file, "set %t", where->set);
    else if (where->type == WHERE_PLACE)
        put(file, "the node nearest to (%n, %n, %n)%u", where->x[0], where->x[1], where->x[2],
            scene->unit_length);
    else if (where->type == WHERE_POINT)
        put(file, "point θ₁ = %q, θ₂ = %q", where->theta[0], unit[0], where->theta[1], unit[1]);
    else
        fputs(where->type == WHERE_EDGE ? edge[where->edge] : set[where->type], file);
}

static const char *layer_place(const scene_layer *layer)
{
    if (layer->patched)
        return "in patches";
    return layer->present ? "in its sets" : "everywhere";
}

static void write_layers(FILE *file, const scene *scene)
{
    double most = 0;
    for (int k = 0; k < scene->layers; k++)
        most = fmax(most, scene->layer[k].thickness);
    put_table(file, "Layers from the inner face to the outer face",
              "Layer|<Material|Thickness|Angle|<Where");
    for (int k = 0; k < scene->layers; k++) {
        const scene_layer *layer = &scene->layer[k];
        put_row(file, "%d %t|<%t|%a|%n°|<%s", k + 1, layer->name,
                scene->material[layer->material].name, layer->thickness, most, scene->unit_length,
                layer->angle, layer_place(layer));
    }
    put_table_end(file);
}

/*
 * Write the table of the material constants. The piezoelectric ones are given as strain per field
 * or as stress per field, whichever the scene contains.
 */
static void write_materials(FILE *file, const scene *scene)
{
    char unit[WORDS_UNIT];
    words_unit(scene, QUANTITY_PRESSURE, unit);
    put_table(file, "Materials", "Material|E₁|E₂|ν₁₂|G₁₂|d₃₁|e₃₁");
    for (int k = 0; k < scene->materials; k++) {
        const scene_material *material = &scene->material[k];
        const double d31 = material->has_d ? material->d31 : (double)NAN;
        const double e31 = material->has_e ? material->piezo_e[0] : (double)NAN;
        put_row(file, "%t|%q|%q|%n|%q|%n|%n", material->name, material->e[0], unit, material->e[1],
                unit, material->nu12, material->g12, unit, d31, e31);
    }
    put_table_end(file);
}

/*
 * Write the displacements that a support constrains. If both the mean over the thickness and the
 * difference of the faces are constrained, only the component is named.
 */
static void write_support(FILE *file, const scene *scene, const scene_support *support,
                          unsigned dof_per_node)
{
    static const struct {
        unsigned bits;
        const char *word;
    } held[] = {{0x09, "u₁"},
                {0x12, "u₂"},
                {0x64, "u₃"},
                {0x01, "u₁ mean"},
                {0x02, "u₂ mean"},
                {0x04, "u₃ mean"},
                {0x08, "u₁ difference"},
                {0x10, "u₂ difference"},
                {0x20, "u₃ difference"},
                {0x40, "u₃ middle"}};
    static const char *const words[] = {"simple", "symmetric", "x constrained", "y constrained",
                                        "z constrained"};
    const unsigned all = (1u << dof_per_node) - 1;
    unsigned left = support->fix & all;
    const unsigned special = support->fix & ~127u;
    const char *comma = ": ";
    begin_row(file, "Support", "");
    write_where(file, scene, &support->where);
    for (unsigned i = 0; i < 5 && special; i++)
        if (special >> (7 + i) & 1u) {
            put(file, "%s%s", comma, words[i]);
            comma = ", ";
        }
    if (special) {
        fputs(end_cell, file);
        return;
    }
    if (left == all) {
        put(file, ": clamped%s", end_cell);
        return;
    }
    for (size_t k = 0; k < sizeof held / sizeof *held; k++) {
        const unsigned bits = held[k].bits & all;
        if (bits == 0 || (left & bits) != bits)
            continue;
        put(file, "%s%s", comma, held[k].word);
        left &= ~bits;
        comma = ", ";
    }
    put(file, " constrained%s", end_cell);
}

/* Write the value of a load at its nodes: a single number, or the range of its values. */
static void write_value(FILE *file, const mesh *mesh, const scene_load *load)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    char unit[WORDS_UNIT];
    for (int n = 0; n < mesh->nodes; n++) {
        const expr_point at = mesh_place(mesh, n);
        if ((load->type == LOAD_POINT || load->type == LOAD_MOMENT) &&
            n != mesh_point_node(mesh, &load->where))
            continue;
        low = fmin(low, expr_value(load->value, &at));
        high = fmax(high, expr_value(load->value, &at));
    }
    put(file, low < high ? "%n to %n" : "%n", low, high);
    put(file, "%u", words_unit(mesh->scene, words_of_load(load), unit));
}

/* Write a direction: the word of a component, or a vector in its place. */
static void write_direction(FILE *file, const char *what, scene_component component,
                            const double vector[3])
{
    if (vector[0] != 0 || vector[1] != 0 || vector[2] != 0)
        put(file, "%s(%n, %n, %n)", what, vector[0], vector[1], vector[2]);
    else
        put(file, "%s%s", what, component_word[component]);
}

static void write_load(FILE *file, const mesh *mesh, const scene_load *load)
{
    static const char *const type[] = {"point", "line", "face", "weight", "temperature", "moment"};
    static const char *const follows[] = {"", " of the undeformed face; turns with the surface",
                                          " of the deformed face; turns with the surface"};
    const bool is_on_nodes =
        load->type == LOAD_POINT || load->type == LOAD_LINE || load->type == LOAD_MOMENT;
    begin_row(file, "Load: ", type[load->type]);
    write_value(file, mesh, load);
    if (load->type == LOAD_FACE && load->follower != FOLLOWER_NONE)
        put(file, " along the normal, per area%s", follows[load->follower]);
    else if (load->type == LOAD_MOMENT)
        write_direction(file, " about ", load->about.component, load->about.vector);
    else if (load->type != LOAD_TEMPERATURE)
        write_direction(file, load->type == LOAD_WEIGHT ? " as gravity along " : " along ",
                        load->component, load->vector);
    if (is_on_nodes) {
        fputs(", ", file);
        write_where(file, mesh->scene, &load->where);
    }
    if (load->type == LOAD_POINT || load->type == LOAD_LINE || load->type == LOAD_FACE)
        put(file, ", %s", face_word[load->face]);
    fputs(end_cell, file);
}

static void write_vector(FILE *file, const char *what, const double x[3], const char *unit)
{
    put(file, "%s(%n, %n, %n)%u", what, x[0], x[1], x[2], unit);
}

/* Write the position and the type of the rigid body that the shell may touch. */
static void write_contact(FILE *file, const scene *scene)
{
    static const char *const name[] = {"plane", "cylinder", "sphere", "body ψ(x, y, z) &lt; 0"};
    static const char *const place[] = {" through ", " around ", " around "};
    const scene_body *body = &scene->contact.body;
    begin_row(file, "Contact", "");
    put(file, "%s on a rigid %s", face_word[scene->contact.face], name[body->type]);
    if (body->type != BODY_PSI)
        write_vector(file, place[body->type], body->point, scene->unit_length);
    if (body->type == BODY_PLANE)
        write_vector(file, ", normal ", body->normal, "");
    if (body->type == BODY_CYLINDER)
        write_vector(file, ", along ", body->axis, "");
    if (body->type == BODY_CYLINDER || body->type == BODY_SPHERE)
        put(file, ", radius %q", body->radius, scene->unit_length);
    if (scene->contact.move[0] != 0 || scene->contact.move[1] != 0 || scene->contact.move[2] != 0)
        write_vector(file, "; moved by ", scene->contact.move, scene->unit_length);
    fputs(end_cell, file);
}

/* Write place, direction and stiffness of springs or stacks. */
static void write_spring(FILE *file, const scene *scene, const scene_spring *spring)
{
    static const char *const per[] = {"", " per length", " per area"};
    put(file, "stiffness %n%s", spring->stiffness, per[spring->per]);
    if (spring->about.given)
        write_direction(file, " about ", spring->about.component, spring->about.vector);
    else if (spring->along.given)
        write_direction(file, " along ", spring->along.component, spring->along.vector);
    if (spring->points > 0)
        put(file, ", %d point%s", spring->points, spring->points == 1 ? "" : "s");
    else
        fputs(", ", file);
    if (spring->points == 0)
        write_where(file, scene, &spring->where);
    if (!spring->to.at.column)
        return;
    fputs(", from ", file);
    write_where(file, scene, &spring->to);
}

static void write_springs(FILE *file, const scene *scene)
{
    for (int k = 0; k < scene->springs; k++) {
        begin_row(file, "Spring ", scene->spring[k].name);
        write_spring(file, scene, &scene->spring[k]);
        fputs(end_cell, file);
    }
}

static void write_actuator(FILE *file, const scene *scene, const scene_actuator *actuator)
{
    const int count = actuator->grid[0] * actuator->grid[1];
    const char *unit = actuator->is_temperature ? scene->unit_temperature : scene->unit_voltage;
    begin_row(file, "Actuator: ", actuator->name);
    if (actuator->is_temperature)
        fputs("temperature of the whole", file);
    else
        put(file, "%d amplifier%s on %s", count, count == 1 ? "" : "s",
            actuator->stacks ? "stacks, " : "patches ");
    if (actuator->stacks)
        write_spring(file, scene, actuator->stacks);
    for (int k = 0; k < actuator->drives; k++)
        put(file, "%s%t × %n", k ? ", " : "", scene->patches[actuator->drive[k].patches].name,
            actuator->drive[k].factor);
    if (actuator->applied != 0)
        put(file, "; applied %q", actuator->applied, unit);
    fputs(end_cell, file);
}

/* Write the table of a measured influence matrix. */
static void write_matrix(FILE *file, const scene *scene)
{
    const scene_influence *influence = &scene->influence;
    matrix_facts facts;
    put_table(file, "Measured influence matrix", "");
    put_row(file, "File|<%t", influence->file);
    put_row(file, "Outputs|<%d of %d rows", influence->outputs, influence->file_outputs);
    put_row(file, "Actuators|<%d", scene->amplifiers);
    if (matrix_facts_find(&facts, scene) == 0) {
        put_row(file, "Largest entry|<%n", facts.entry);
        if (facts.rank >= 0)
            put_row(file, "Rank|<%d; singular values from %n to %n", facts.rank, facts.most,
                    facts.least);
    }
    put_table_end(file);
}

void page_source(FILE *file, const analysis *analysis, const char *title)
{
    const design *design = &analysis->design;
    put(file, "<section>\n<h2>%s</h2>\n", title);
    if (analysis->source->has_structure) {
        page_conditions(file, design);
        page_layers(file, design->scene);
    } else {
        write_matrix(file, design->scene);
    }
    fputs("</section>\n", file);
}

void page_conditions(FILE *file, const design *design)
{
    const scene *scene = design->scene;
    put_table(file, "Supports, loads and actuators", "");
    for (int k = 0; k < scene->supports; k++)
        write_support(file, scene, &scene->support[k], design->mesh.dof_per_node);
    write_springs(file, scene);
    for (int k = 0; k < scene->loads; k++)
        write_load(file, &design->mesh, &scene->load[k]);
    if (scene->contact.given)
        write_contact(file, scene);
    for (int k = 0; k < scene->actuators; k++)
        write_actuator(file, scene, &scene->actuator[k]);
    put_table_end(file);
}

void page_layers(FILE *file, const scene *scene)
{
    fputs("<div class=\"row uneven\">\n", file);
    write_layers(file, scene);
    write_materials(file, scene);
    fputs("</div>\n", file);
}

void page_voltages(FILE *file, const design *design, int count, page_voltage_set *set,
                   const void *context)
{
    if (design->amplifiers == 0)
        return;
    fputs("<details><summary>Voltages by amplifier</summary>\n", file);
    put_table(file, "", "");
    for (int k = -1; k < design->amplifiers; k++) {
        char name[SCENE_LABEL] = "Amplifier";
        if (k >= 0)
            scene_amplifier_name(design->scene, k, name);
        put(file, "<tr><th scope=\"row\">%t</th>", name);
        for (int i = 0; i < count; i++) {
            const page_set one = set(context, i);
            if (k < 0)
                put(file, "<th scope=\"col\">%t</th>", one.name);
            else
                put(file, "<td>%q</td>", one.voltage[k], design->scene->unit_voltage);
        }
        fputs("</tr>\n", file);
    }
    put_table_end(file);
    fputs("</details>\n", file);
}
