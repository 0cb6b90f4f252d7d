/* SPDX-License-Identifier: BSD-2-Clause */
/* Section of a load path on the page of `pzs solve`: load over each output (report_page.h). */
#include <math.h>
#include "report_page.h"
#include "../model/output_calls.h"

/* Return whether point i of a load path, or a point beside it, is unstable. */
static bool touches_unstable(const load_path *path, int i)
{
    return path->point[i].negative_pivots > 0 ||
           (i > 0 && path->point[i - 1].negative_pivots > 0) ||
           (i + 1 < path->points && path->point[i + 1].negative_pivots > 0);
}

/* Make the marks of the critical points of a load path in a diagram over output k. */
static void mark_events(const load_path *path, int k, draw_mark mark[LOAD_PATH_EVENTS])
{
    for (int i = 0; i < path->events; i++)
        mark[i] = (draw_mark){path->event_value[i * path->outputs + k], path->event[i].load_factor,
                              load_path_event_name(path->event[i].type)};
}

/* Draw a diagram of the load factor over output k. */
static void draw_output(const page *page, const load_path *path, int k)
{
    const scene_output *output = &page->design->output[k];
    double value[LOAD_PATH_POINTS], stable[LOAD_PATH_POINTS], unstable[LOAD_PATH_POINTS];
    draw_mark mark[LOAD_PATH_EVENTS];
    const draw_series series[2] = {{"rest bold", value, unstable, path->points, NULL, 0},
                                   {"wire bold", value, stable, path->points, NULL, 0}};
    draw_diagram diagram = {.series = series, .count = 2, .mark = mark, .marks = path->events};
    char unit[WORDS_UNIT];
    for (int i = 0; i < path->points; i++) {
        const load_path_point *point = &path->point[i];
        value[i] = path->value[i * path->outputs + k];
        stable[i] = point->negative_pivots == 0 ? point->load_factor : (double)NAN;
        unstable[i] = touches_unstable(path, i) ? point->load_factor : (double)NAN;
    }
    mark_events(path, k, mark);
    words_unit(&page->design->units, words_of_output(output), unit);
    if (page_diagram(page, &diagram, "", "Load factor over an output", unit, ""))
        put(page->file, PAGE_CAPTION("Load factor over %t (%t)."), output->name,
            diagram.x.unit.name);
}

void page_path(const page *page)
{
    const load_path *path = &page->analysis->load_path;
    if (path->points < 2)
        return;
    put(page->file,
        "<h2>Load path</h2>\n<p>%d equilibria%s; %d critical points. <span class=\"keys\">%s</span>"
        "</p>\n",
        path->points, path->has_equal_steps ? " in equal load steps" : "", path->events,
        PAGE_KEY("line", "stable") PAGE_KEY("gone", "unstable"));
    for (int k = 0; k < path->outputs; k++)
        if (!output_is_recovered(&page->design->output[k]) &&
            analysis_outputs(page->analysis, k) == 1)
            draw_output(page, path, k);
}
