/* SPDX-License-Identifier: BSD-2-Clause */
/* A load path (equilibria from zero to full load) on standard output (print_path.h). */
#include "print_path.h"
#include <stdio.h>
#include "../model/output_calls.h"
#include "../model/path_cause.h"
#include "print_outputs.h"

/*
 * Whether the printed table of equilibria from zero to full load has a column for the output with
 * index k. It has one for each output with a single value, apart from strains and stresses: these
 * are computed at full load only.
 */
static int is_listed(const analysis *analysis, int k)
{
    return !output_is_recovered(&analysis->design.output[k]) && analysis_outputs(analysis, k) == 1;
}

static const double *values_of(const load_path *path, int point)
{
    return path->value + (size_t)point * (size_t)path->outputs;
}

/* ---- text ------------------------------------------------------------- */

static void print_head_of_points(const analysis *analysis)
{
    const design *design = &analysis->design;
    printf("\n  %6s %12s %16s", "point", "load factor", "negative pivots");
    for (int k = 0; k < design->outputs; k++)
        if (is_listed(analysis, k))
            printf(" %15.15s", design->output[k].name);
    putchar('\n');
}

/*
 * Print why a load path that has reached the full load has critical points, if one of two causes is
 * known: the material law has softened; or the shell has turned so far that the seventh degree of
 * freedom of a node (displacement of the middle surface relative to both faces) has no stiffness
 * left.
 */
static void print_cause(const analysis *analysis, const load_path *path)
{
    const bool is_known =
        path_is_softened(path) || path_has_lost_normal(path, &analysis->design.mesh);
    char cause[PATH_CAUSE_BYTES];
    if (!path->is_complete || path->events == 0 || path->has_equal_steps || !is_known)
        return;
    path_cause(path, analysis, cause);
    printf("  %s\n", cause);
}

/*
 * Print a line for each output with a single value (except strains and stresses): its value at a
 * critical point.
 */
static void print_values(const analysis *analysis, const double *value)
{
    const design *design = &analysis->design;
    for (int k = 0; k < design->outputs; k++)
        if (is_listed(analysis, k))
            printf("    %-20s %15.7e\n", design->output[k].name, value[k]);
}

/*
 * Print the critical points of the load path, with the values of the outputs there. For a
 * bifurcation, also print the command-line option (--branch) with which pzs follows its branch.
 */
static void print_events(const analysis *analysis, const load_path *path)
{
    int bifurcation = 0;
    for (int i = 0; i < path->events; i++) {
        const load_path_event *event = &path->event[i];
        printf("  %s at load factor %.6g, between points %d and %d",
               load_path_event_name(event->type), event->load_factor, event->point + 1,
               event->point + 2);
        if (event->type == LOAD_PATH_BIFURCATION && path->branch_point == 0)
            printf("; --branch %d follows its branch", ++bifurcation);
        putchar('\n');
        print_values(analysis, path->event_value + (size_t)i * (size_t)path->outputs);
    }
    if (path->branch_point > 0)
        printf("  branch of a bifurcation from point %d on\n", path->branch_point + 1);
}

void print_load_path(const analysis *analysis, const load_path *path)
{
    const bool is_at_full_load = path->point[path->points - 1].load_factor >= 1;
    const char *reach = is_at_full_load ? "" : "; it does not reach the full load";
    printf("  load path: %d points%s, %d linear solves%s\n", path->points,
           path->has_equal_steps ? " in equal load steps" : "", path->linear_solves, reach);
    print_events(analysis, path);
    if (path->events == 0)
        puts(path->has_equal_steps ? "  no change of stability"
                                   : "  no limit point and no bifurcation");
    print_cause(analysis, path);
    print_head_of_points(analysis);
    for (int i = 0; i < path->points; i++) {
        printf("  %6d %12.6f %16d", i + 1, path->point[i].load_factor,
               path->point[i].negative_pivots);
        for (int k = 0; k < analysis->design.outputs; k++)
            if (is_listed(analysis, k))
                printf(" %15.7e", values_of(path, i)[k]);
        putchar('\n');
    }
    putchar('\n');
}

/* ---- JSON ------------------------------------------------------------- */

/*
 * Write the values of the outputs at one point of a load path as JSON; only of outputs with a
 * single value, without strains and stresses.
 */
static void json_outputs(json *json, const analysis *analysis, const double *value)
{
    const design *design = &analysis->design;
    json_open(json, "outputs", '{');
    for (int k = 0; k < design->outputs; k++)
        if (is_listed(analysis, k))
            json_number(json, design->output[k].name, value[k]);
    json_close(json, '}');
}

static void json_event(json *json, const analysis *analysis, const load_path *path, int i)
{
    const load_path_event *event = &path->event[i];
    json_open(json, NULL, '{');
    json_string(json, "type", load_path_event_name(event->type));
    json_number(json, "load_factor", event->load_factor);
    json_number(json, "after_point", event->point + 1);
    json_outputs(json, analysis, path->event_value + (size_t)i * (size_t)path->outputs);
    json_close(json, '}');
}

static void json_point(json *json, const analysis *analysis, const load_path *path, int i)
{
    json_open(json, NULL, '{');
    json_number(json, "load_factor", path->point[i].load_factor);
    json_number(json, "negative_pivots", path->point[i].negative_pivots);
    json_number(json, "lowest_face_strain", path->point[i].compression.strain);
    json_outputs(json, analysis, values_of(path, i));
    json_close(json, '}');
}

void print_load_path_json(json *json, const analysis *analysis, const load_path *path)
{
    json_open(json, "path", '{');
    json_bool(json, "complete", path->is_complete);
    json_bool(json, "equal_load_steps", path->has_equal_steps);
    json_number(json, "linear_solves", path->linear_solves);
    if (path->branch_point > 0)
        json_number(json, "branch_from_point", path->branch_point + 1);
    json_open(json, "events", '[');
    for (int i = 0; i < path->events; i++)
        json_event(json, analysis, path, i);
    json_close(json, ']');
    json_open(json, "points", '[');
    for (int i = 0; i < path->points; i++)
        json_point(json, analysis, path, i);
    json_close(json, ']');
    json_close(json, '}');
}

void print_ended_path_json(const analysis *analysis, const load_path *path)
{
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    print_load_path_json(&json, analysis, path);
    json_close(&json, '}');
}
