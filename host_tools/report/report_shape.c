/* SPDX-License-Identifier: BSD-2-Clause */
/* Report page of `pzs shape` (report.h). */
#include <math.h>
#include <string.h>
#include "../model/voltages_words.h"
#include "report_page.h"

/*
 * Contents of the report page of `pzs shape`. On pictures of the misfit (reached minus target
 * value), all results have one colour scale, page.scale.
 */
typedef struct shape_page {
    page page;
    const voltages *result; /* [results] optimal voltages, one result for each pair of voltage
                               limits */
    int results;
    const voltages *best; /* the result with the limits that the scene states, or with the first
                             limit of the command */
    draw_scale voltage;
} shape_page;

static bool is_limited(const voltages *result)
{
    return isfinite(result->limit[0]) || isfinite(result->limit[1]);
}

/* Return the largest input in one set of voltages, or of temperatures of heaters, by magnitude. */
static double largest_voltage(const shape_page *shape, const voltages *result)
{
    draw_scale scale = {.unit = shape->voltage.unit};
    shell_extend(&scale, shape->page.design, result->voltage);
    return scale.most;
}

/* Choose colour scales, magnification and view, which all results on the page have in common. */
static void fit_page(shape_page *shape)
{
    page *page = &shape->page;
    draw_scale displacement = {.most = 0};
    page->scale = (draw_scale){true, 0, page->design->units.length};
    shape->voltage = (draw_scale){true, 0, page->inputs.unit};
    draw_extend(&displacement, page->design->target, page->design->targets);
    for (int k = 0; k < shape->results; k++) {
        const draw_scale misfit = page_shape(page, &shape->result[k], page->design->target);
        draw_extend(&displacement, &page->largest, 1);
        draw_extend(&page->scale, &misfit.most, 1);
        shell_extend(&shape->voltage, page->design, shape->result[k].voltage);
    }
    if (!page->analysis->is_nonlinear)
        page->space.factor = view_magnification(page->mesh, displacement.most, 0.2);
    for (int k = 0; k < shape->results; k++) {
        (void)page_shape(page, &shape->result[k], page->design->target);
        page_include(page, true);
    }
    view_fit(&page->space.view, 420, 420, 180);
}

static void write_verdict(const shape_page *shape)
{
    const voltages *best = shape->best;
    put(shape->page.file,
        "<p class=\"verdict\"><b>Relative RMS error %p</b>: %t, %l, limit active at %d of %d "
        "amplifiers.</p>\n",
        best->error, best->name, best->limit, shape->voltage.unit, best->active_limits,
        best->amplifiers);
}

static void write_row(const shape_page *shape, const voltages *result, double worst)
{
    const char *length = shape->page.design->units.length;
    int beyond = 0;
    for (int k = 0; k < result->amplifiers; k++)
        beyond += shell_is_beyond(shape->page.design, result, k);
    const double active = is_limited(result) ? result->active_limits : (double)NAN;
    put(shape->page.file, PUT_ROW("%t|%l|%b|%q|%q|%n|%a|%s%d%s|%r"), result->name, result->limit,
        shape->voltage.unit, result->error, worst, result->rms, length, result->valley, length,
        active, largest_voltage(shape, result), shape->voltage.most, shape->voltage.unit,
        beyond ? "<b>" : "", beyond, beyond ? "</b>" : "", result->optimality);
}

static void write_table(const shape_page *shape)
{
    const char *input = shape->page.inputs.name;
    double worst = 0;
    for (int k = 0; k < shape->results; k++)
        worst = fmax(worst, shape->result[k].error);
    put(shape->page.file,
        PUT_TABLE("Relative RMS error: root of the weighted squares of the misfit over those of "
                  "what is wanted (target less the shape without %ss). PV: peak to valley. Clipped "
                  "least squares: %ss without limits, cut to the limits. Regularised, then "
                  "clipped: the same with the one parameter that leaves the smallest error, chosen "
                  "knowing the answer. KKT violation: largest violated optimality condition, "
                  "relative.",
                  "^%ss^Limits^Relative RMS error^Misfit, RMS^Misfit, PV^Limit active^Largest %s"
                  "^Beyond the<br>scene’s limits^KKT violation"),
        input, input, shape->page.inputs.title, input);
    for (int k = 0; k < shape->results; k++)
        write_row(shape, &shape->result[k], worst);
    put(shape->page.file, PUT_TABLE_END);
}

static void draw_levels(const page *page, const voltages *result)
{
    draw_scale scale = {true, 0, page->design->units.length};
    draw_extend(&scale, result->aligned_target, page->design->targets);
    draw_extend(&scale, result->shape, page->design->targets);
    page_map(page, result->aligned_target, &scale, "Target", ". One scale with reached:");
    page_map(page, result->shape, &scale, "Reached", ". One scale with target:");
}

static void draw_voltages(const shape_page *shape, const voltages *result)
{
    const design *design = shape->page.design;
    const shell_voltage_set set = {result, &shape->voltage};
    fputs("<figure>\n", shape->page.file);
    for (int which = 0; which < shape->page.map.plans || which == 0; which++)
        shell_voltages(&shape->page.map, which, &set);
    for (int k = 0; k < design->actuators; k++)
        if (scene_heats_all(&design->actuator[k]))
            put(shape->page.file, "<p class=\"keys\">%t: %q</p>\n", design->actuator[k].name,
                result->voltage[design->actuator[k].first], design->units.temperature);
    put(shape->page.file,
        "<figcaption>%ss: largest <b>%q</b>. One scale for all results:", shape->page.inputs.title,
        largest_voltage(shape, result), shape->voltage.unit);
    page_legend(&shape->page, &shape->voltage);
}

static void draw_result(shape_page *shape, const voltages *result)
{
    page *page = &shape->page;
    const draw_scale own = page_shape(&shape->page, result, shape->page.design->target);
    put(page->file,
        is_limited(result) ? "<article class=\"set\">\n<h3>%t, %l"
                           : "<article class=\"set\">\n<h3>%t",
        result->name, result->limit, shape->voltage.unit);
    put(page->file, " — relative RMS error %p</h3>\n<div class=\"row\">\n", result->error);
    if (page->analysis->source->has_structure) {
        fputs("<figure>\n", page->file);
        page_draw_shape(page, &page->scale);
        put(page->file,
            "<figcaption>Reached shape and <b>target</b> as lines, displacement <b>× %n</b>. "
            "Misfit on one scale for all results:",
            page->space.factor);
        page_legend(page, &page->scale);
    } else {
        draw_levels(page, result);
    }
    page_map(page, page->value, &own, "Misfit, reached minus target",
             page->design->targets < page->mesh->nodes
                 ? "; grey where there is no target. Scale of this result:"
                 : ". Scale of this result:");
    draw_voltages(shape, result);
    fputs("</div>\n</article>\n", page->file);
}

static void write_page(shape_page *shape, const modes *modes)
{
    const page *page = &shape->page;
    double residual = 0;
    char title[64], notes[VOLTAGES_TEXT];
    for (int k = 0; k < shape->results; k++)
        residual = fmax(residual, shape->result[k].residual);
    snprintf(title, sizeof title, "%ss for a wanted shape", page->inputs.title);
    page_begin(page, title, residual);
    write_verdict(shape);
    put(page->file, "<h2>%ss</h2>\n", page->inputs.title);
    write_table(shape);
    voltages_words(page->design, shape->best, notes);
    if (*notes)
        put(page->file, "<p class=\"lines\">%t</p>\n", notes + strspn(notes, " \n"));
    page_voltages(page, shape->result, shape->results);
    fputs("<h2>Shapes</h2>\n", page->file);
    page_keys(page, PAGE_KEY("stop", "limit active") PAGE_KEY("over", "beyond the scene’s limits"));
    for (int k = 0; k < shape->results; k++)
        draw_result(shape, &shape->result[k]);
    page_modes(page, modes);
    page_end(page);
}

static void write_picture(shape_page *shape)
{
    const page *page = &shape->page;
    const double width = 760, height = fmax(page->space.view.height, 350) + 44;
    const voltages *result = shape->best;
    char title[160];
    const draw_scale own = page_shape(&shape->page, result, shape->page.design->target);
    snprintf(title, sizeof title,
             "%.60s: relative RMS error %.3g %%. Colour: misfit, lines: target", result->name,
             100 * result->error);
    page_begin_picture(page, title, width, height);
    put(page->file, "<svg width=\"420\" height=\"%f\">", page->space.view.height);
    page_draw_shape(page, &own);
    fputs("</svg>\n<svg x=\"436\" width=\"320\" height=\"350\">", page->file);
    shell_voltages(&page->map, 0, &(shell_voltage_set){result, &shape->voltage});
    fputs("</svg>\n", page->file);
    draw_legend(page->file, &own, 0, height - 32);
    draw_legend(page->file, &shape->voltage, 430, height - 32);
    page_end_picture(page, width, height);
}

int report_shape(const report_job *job, const analysis *analysis, const voltages *result,
                 int results, const modes *modes)
{
    shape_page shape = {.result = result, .results = results, .best = result + 1};
    const bool failed = page_open(&shape.page, job, analysis) < 0;
    if (!failed) {
        fit_page(&shape);
        if (job->is_svg)
            write_picture(&shape);
        else
            write_page(&shape, modes);
    }
    return page_close(&shape.page, failed);
}
