/* SPDX-License-Identifier: BSD-2-Clause */
/* Section of a load path on the report page of `pzs solve`: load over each output (report_page.h).
 */
#include <math.h>
#include <stdlib.h>
#include "report_page.h"
#include "../model/output_calls.h"

/*
 * One diagram of a load path on a report page: a curve of the load factor over the values of one
 * output.
 */
typedef struct path_chart {
    const load_path *path;
    int output;
    draw_axis x, y;
    char unit[WORDS_UNIT];                    /* unit of the output that the diagram shows */
    double *value, *load, *stable, *unstable; /* [points] value: output; load: load factor; stable,
                                                 unstable: load factor where the equilibrium is
                                                 stable or unstable, NAN elsewhere */
} path_chart;

enum { WIDTH = 720, HEIGHT = 300, LEFT = 84, RIGHT = 604, TOP = 6, BOTTOM = 262 };

static double event_value(const path_chart *chart, int event)
{
    return chart->path->event_value[event * chart->path->outputs + chart->output];
}

/*
 * Return whether point i of a load path belongs to the line of unstable equilibria: it or a point
 * beside it is unstable.
 */
static bool touches_unstable(const load_path *path, int i)
{
    return path->point[i].negative_pivots > 0 ||
           (i > 0 && path->point[i - 1].negative_pivots > 0) ||
           (i + 1 < path->points && path->point[i + 1].negative_pivots > 0);
}

static void fill_chart(path_chart *chart, const scene_unit_names *units, const scene_output *output)
{
    const load_path *path = chart->path;
    chart->x = (draw_axis){0, 0, LEFT, RIGHT, false, "%n", {1, ""}};
    chart->y = (draw_axis){0, 0, BOTTOM, TOP, false, "%n", {1, ""}};
    for (int i = 0; i < path->points; i++) {
        chart->value[i] = path->value[i * path->outputs + chart->output];
        chart->load[i] = path->point[i].load_factor;
        chart->stable[i] = path->point[i].negative_pivots == 0 ? chart->load[i] : (double)NAN;
        chart->unstable[i] = touches_unstable(path, i) ? chart->load[i] : (double)NAN;
    }
    draw_widen(&chart->x, chart->value, path->points);
    draw_widen(&chart->y, chart->load, path->points);
    chart->x.unit = put_unit_of(fmax(-chart->x.low, chart->x.high),
                                words_unit(units, words_of_output(output), chart->unit));
}

/* Mark the critical points of a load path in the diagram, with the load factor beside each. */
static void draw_events(const path_chart *chart, FILE *file)
{
    static const char *const name[] = {[LOAD_PATH_LIMIT] = "limit point",
                                       [LOAD_PATH_BIFURCATION] = "bifurcation",
                                       [LOAD_PATH_STABILITY] = "change of stability"};
    for (int i = 0; i < chart->path->events; i++) {
        const load_path_event *event = &chart->path->event[i];
        const double at[2] = {draw_on(&chart->x, event_value(chart, i)),
                              draw_on(&chart->y, event->load_factor)};
        if (!isfinite(at[0]))
            continue;
        draw_disc(file, "dot", at, 4);
        const bool is_right = at[0] > (LEFT + RIGHT) / 2;
        const char *style = is_right ? "tag end" : "tag";
        const double away = is_right ? -7 : 7;
        draw_text(file, style, at[0] + away, at[1] - 5, "%s %n", name[event->type],
                  event->load_factor);
    }
}

static void draw_chart(const page *page, const path_chart *chart)
{
    FILE *file = page->file;
    const scene_output *output = &page->design->output[chart->output];
    const int points = chart->path->points;
    put(file, "<figure class=\"chart\">\n");
    draw_begin(file, DRAW_CHART, WIDTH, HEIGHT, "Load factor over an output",
               "The load path with its critical points");
    draw_grid(file, &chart->x, &chart->y, true);
    draw_grid(file, &chart->x, &chart->y, false);
    draw_curve(file, &chart->x, &chart->y,
               &(draw_series){"rest bold", chart->value, chart->unstable, points});
    draw_curve(file, &chart->x, &chart->y,
               &(draw_series){"wire bold", chart->value, chart->stable, points});
    draw_events(chart, file);
    draw_end(file, DRAW_CHART);
    page_caption(page, NULL, "Load factor over %t (%t).", output->name, chart->x.unit.name);
}

void page_path(const page *page)
{
    const load_path *path = &page->analysis->load_path;
    const size_t points = (size_t)path->points;
    double *memory = path->points > 1 ? calloc(4 * points, sizeof *memory) : NULL;
    if (!memory)
        return;
    put(page->file,
        "<h2>Load path</h2>\n<p>%d equilibria%s; %d critical points. <span class=\"keys\">%s</span>"
        "</p>\n",
        path->points, path->has_equal_steps ? " in equal load steps" : "", path->events,
        PAGE_KEY("line", "stable") PAGE_KEY("gone", "unstable"));
    for (int k = 0; k < path->outputs; k++) {
        path_chart chart = {.path = path,
                            .output = k,
                            .value = memory,
                            .load = memory + points,
                            .stable = memory + 2 * points,
                            .unstable = memory + 3 * points};
        const scene_output *output = &page->design->output[k];
        if (output_is_recovered(output) || analysis_outputs(page->analysis, k) != 1)
            continue;
        fill_chart(&chart, &page->design->units, output);
        if (chart.x.high > chart.x.low && chart.y.high > chart.y.low)
            draw_chart(page, &chart);
    }
    free(memory);
}
