/* SPDX-License-Identifier: BSD-2-Clause */
/* Named outputs of a scene on standard output, as text and as JSON (print_outputs.h). */
#include "print_outputs.h"
#include <math.h>
#include <stdlib.h>
#include "../mesh/mesh_shown.h"
#include "../text/words.h"

/* ---- text ------------------------------------------------------------- */

static void print_node_row(const mesh *mesh, const mesh_size *size, int node, double value)
{
    fputs("   ", stdout);
    for (int i = 0; i < 2 && !mesh->quads; i++)
        printf(" %13.6e", mesh_shown(mesh->theta[node][i], size->theta[i]));
    fputs(mesh->quads ? "" : " ", stdout);
    for (int i = 0; i < 3; i++)
        printf(" %13.6e", mesh_shown(mesh->point[node].position[i], size->position));
    printf("  %16.9e\n", value);
}

void print_output_table(const analysis *analysis, int k, const double *value)
{
    const int count = analysis_outputs(analysis, k);
    const mesh *mesh = &analysis->design.mesh;
    const mesh_size size = mesh_size_of(mesh);
    if (analysis_output_node(analysis, k, 0) >= 0)
        printf("    %s%13s %13s %13s  %16s\n", mesh->quads ? "" : "       theta1        theta2  ",
               "x", "y", "z", analysis->design.output[k].name);
    for (int i = 0; i < count; i++) {
        const int node = analysis_output_node(analysis, k, i);
        const double of_place = analysis_output(analysis, k, i, value);
        if (node >= 0)
            print_node_row(mesh, &size, node, of_place);
        else
            printf("    %-20s %16.9e\n", analysis_output_electrode(analysis, k, i), of_place);
    }
}

static void print_reference(const scene_output *output, double first, const char *of)
{
    if (isfinite(output->reference))
        printf("   reference %.6e, ratio %.4f%s", output->reference, first / output->reference, of);
    putchar('\n');
}

void print_output(const analysis *analysis, int k, const double *value)
{
    const scene_output *output = &analysis->design.output[k];
    const int count = analysis_outputs(analysis, k);
    const double first = analysis_output(analysis, k, 0, value);
    const char *places = analysis_output_node(analysis, k, 0) >= 0 ? "nodes" : "electrodes";
    double least = HUGE_VAL, most = -HUGE_VAL;
    char name[WORDS_UNIT], unit[WORDS_UNIT + 1];
    words_unit(&analysis->design.units, words_of_output(output), name);
    snprintf(unit, sizeof unit, "%s%s", *name ? " " : "", name);
    for (int i = 0; i < count; i++) {
        least = fmin(least, analysis_output(analysis, k, i, value));
        most = fmax(most, analysis_output(analysis, k, i, value));
    }
    if (count == 1) {
        printf("  %-20s %16.9e%s", output->name, first, unit);
        print_reference(output, first, "");
        return;
    }
    printf("  %-20s %16.9e .. %.9e%s on %d %s", output->name, least, most, unit, count, places);
    print_reference(output, first, " of the first one");
    print_output_table(analysis, k, value);
}

/* ---- JSON ------------------------------------------------------------- */

static void json_output(json *json, const analysis *analysis, int k, const double *value)
{
    const int count = analysis_outputs(analysis, k);
    const char *name = analysis->design.output[k].name;
    if (count == 1) {
        json_number(json, name, analysis_output(analysis, k, 0, value));
        return;
    }
    double *all = calloc((size_t)count, sizeof *all);
    for (int i = 0; all && i < count; i++)
        all[i] = analysis_output(analysis, k, i, value);
    json_numbers(json, name, all, all ? count : 0);
    free(all);
}

void print_outputs_json(json *json, const analysis *analysis, const double *value, int only_rows)
{
    json_open(json, "outputs", '{');
    for (int k = 0; k < analysis->design.outputs; k++)
        if (!only_rows || analysis_output_is_row(analysis, k))
            json_output(json, analysis, k, value);
    json_close(json, '}');
}

static void json_place(json *json, const analysis *analysis, int k, int i, double value)
{
    static const char *const axis[3] = {"x", "y", "z"};
    const mesh *mesh = &analysis->design.mesh;
    const int node = analysis_output_node(analysis, k, i);
    json_open(json, NULL, '{');
    if (node >= 0) {
        if (!mesh->quads) {
            json_number(json, "theta1", mesh->theta[node][0]);
            json_number(json, "theta2", mesh->theta[node][1]);
        }
        for (int component = 0; component < 3; component++)
            json_number(json, axis[component], mesh->point[node].position[component]);
    } else {
        json_string(json, "electrode", analysis_output_electrode(analysis, k, i));
    }
    json_number(json, "value", value);
    json_close(json, '}');
}

void print_output_places_json(json *json, const analysis *analysis, const double *value,
                              int only_rows)
{
    json_open(json, "output_places", '{');
    for (int k = 0; k < analysis->design.outputs; k++) {
        const int count = analysis_outputs(analysis, k);
        if (count == 1 || (only_rows && !analysis_output_is_row(analysis, k)))
            continue;
        json_open(json, analysis->design.output[k].name, '[');
        for (int i = 0; i < count; i++)
            json_place(json, analysis, k, i, analysis_output(analysis, k, i, value));
        json_close(json, ']');
    }
    json_close(json, '}');
}
