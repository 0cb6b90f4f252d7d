/* The named outputs of a scene (print_outputs.h). */
#include "print_outputs.h"
#include <math.h>
#include <stdlib.h>
#include "words.h"

int print_is_displacement(const analysis *a, int k)
{
    const scene_output *output = &a->design.scene->output[k];
    return output->electric == ELECTRIC_NONE && output->contact == CONTACT_NONE;
}

/* ---- text ------------------------------------------------------------- */

static void print_node_row(const analysis *a, int node, double value)
{
    const mesh *m = &a->design.mesh;
    const double *theta = m->theta[node], *x = m->point[node].x;
    printf("    %13.6e %13.6e  %13.6e %13.6e %13.6e  %16.9e\n", theta[0], theta[1], x[0], x[1],
           x[2], value);
}

void print_output_table(const analysis *a, int k, const double *value)
{
    const int count = analysis_outputs(a, k);
    char name[SCENE_LABEL];
    if (analysis_output_node(a, k, 0) >= 0)
        printf("    %13s %13s  %13s %13s %13s  %16s\n", "theta1", "theta2", "x", "y", "z",
               a->design.scene->output[k].name);
    for (int i = 0; i < count; i++) {
        const int node = analysis_output_node(a, k, i);
        if (node >= 0) {
            print_node_row(a, node, analysis_output(a, k, i, value));
        } else {
            analysis_output_electrode(a, k, i, name);
            printf("    %-20s %16.9e\n", name, analysis_output(a, k, i, value));
        }
    }
}

static void print_reference(const scene_output *output, double first, const char *of)
{
    if (isfinite(output->reference))
        printf("   reference %.6e, ratio %.4f%s", output->reference, first / output->reference, of);
    putchar('\n');
}

void print_output(const analysis *a, int k, const double *value)
{
    const scene_output *output = &a->design.scene->output[k];
    const int count = analysis_outputs(a, k);
    const double first = analysis_output(a, k, 0, value);
    const char *places = output->electric == ELECTRIC_NONE ? "nodes" : "electrodes";
    double least = HUGE_VAL, most = -HUGE_VAL;
    char name[WORDS_UNIT], unit[WORDS_UNIT + 1];
    words_unit(a->design.scene, words_of_output(output), name);
    snprintf(unit, sizeof unit, "%s%s", *name ? " " : "", name);
    for (int i = 0; i < count; i++) {
        least = fmin(least, analysis_output(a, k, i, value));
        most = fmax(most, analysis_output(a, k, i, value));
    }
    if (count == 1) {
        printf("  %-20s %16.9e%s", output->name, first, unit);
        print_reference(output, first, "");
        return;
    }
    printf("  %-20s %16.9e .. %.9e%s on %d %s", output->name, least, most, unit, count, places);
    print_reference(output, first, " of the first one");
    print_output_table(a, k, value);
}

/* ---- JSON ------------------------------------------------------------- */

static void json_output(json *j, const analysis *a, int k, const double *value)
{
    const int count = analysis_outputs(a, k);
    const char *name = a->design.scene->output[k].name;
    if (count == 1) {
        json_number(j, name, analysis_output(a, k, 0, value));
        return;
    }
    double *all = calloc((size_t)count, sizeof *all);
    for (int i = 0; all && i < count; i++)
        all[i] = analysis_output(a, k, i, value);
    json_numbers(j, name, all, all ? count : 0);
    free(all);
}

void print_outputs_json(json *j, const analysis *a, const double *value, int only_displacements)
{
    json_open(j, "outputs", '{');
    for (int k = 0; k < a->design.scene->outputs; k++)
        if (!only_displacements || print_is_displacement(a, k))
            json_output(j, a, k, value);
    json_close(j, '}');
}

static void json_place(json *j, const analysis *a, int k, int i, double value)
{
    static const char *const axis[3] = {"x", "y", "z"};
    const mesh *m = &a->design.mesh;
    const int node = analysis_output_node(a, k, i);
    char name[SCENE_LABEL];
    json_open(j, NULL, '{');
    if (node >= 0) {
        json_number(j, "theta1", m->theta[node][0]);
        json_number(j, "theta2", m->theta[node][1]);
        for (int c = 0; c < 3; c++)
            json_number(j, axis[c], m->point[node].x[c]);
    } else {
        analysis_output_electrode(a, k, i, name);
        json_string(j, "electrode", name);
    }
    json_number(j, "value", value);
    json_close(j, '}');
}

void print_output_places_json(json *j, const analysis *a, const double *value,
                              int only_displacements)
{
    json_open(j, "output_places", '{');
    for (int k = 0; k < a->design.scene->outputs; k++) {
        const int count = analysis_outputs(a, k);
        if (count == 1 || (only_displacements && !print_is_displacement(a, k)))
            continue;
        json_open(j, a->design.scene->output[k].name, '[');
        for (int i = 0; i < count; i++)
            json_place(j, a, k, i, analysis_output(a, k, i, value));
        json_close(j, ']');
    }
    json_close(j, '}');
}
