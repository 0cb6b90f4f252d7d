/* SPDX-License-Identifier: BSD-2-Clause */
/* Report page of `pzs shape` (report.h). */
#include <math.h>
#include <string.h>
#include "../model/voltages_words.h"
#include "report_page.h"

static bool is_limited(const voltages *result)
{
    return isfinite(result->limit[0]) || isfinite(result->limit[1]);
}

/* Return the largest input in one set of voltages, or of temperatures of heaters, by magnitude. */
static double largest_voltage(const page *page, const voltages *result)
{
    draw_scale scale = {.unit = page->voltage.unit};
    shell_extend(&scale, page->design, result->voltage);
    return scale.most;
}

/* Choose colour scales, magnification and view, which all results on the page have in common. */
static void fit_page(page *page)
{
    draw_scale displacement = {.most = 0};
    page->scale = (draw_scale){true, 0, page->design->units.length};
    page->voltage = (draw_scale){true, 0, page->inputs.unit};
    draw_extend(&displacement, page->design->target, page->design->targets);
    for (int k = 0; k < page->results; k++) {
        const draw_scale misfit = page_shape(page, &page->result[k], page->design->target);
        draw_extend(&displacement, &page->largest, 1);
        draw_extend(&page->scale, &misfit.most, 1);
        shell_extend(&page->voltage, page->design, page->result[k].voltage);
    }
    if (!page->analysis->is_nonlinear)
        page->space.factor = view_magnification(page->mesh, displacement.most, 0.2);
    for (int k = 0; k < page->results; k++) {
        (void)page_shape(page, &page->result[k], page->design->target);
        page_include(page);
    }
    view_fit(&page->space.view, 420, 420, 180);
}

static void write_row(const page *page, const voltages *result, double worst)
{
    const char *length = page->design->units.length;
    int beyond = 0;
    for (int k = 0; k < result->amplifiers; k++)
        beyond += shell_is_beyond(page->design, result, k);
    const double active = is_limited(result) ? result->active_limits : (double)NAN;
    put(page->file, PUT_ROW("%t|%l|%b|%q|%q|%n|%a"), result->name, result->limit,
        page->voltage.unit, result->error, worst, result->rms, length, result->valley, length,
        active, largest_voltage(page, result), page->voltage.most, page->voltage.unit);
    put(page->file, beyond ? "| <b>%d</b>|%r\n" : "|%d|%r\n", beyond, result->optimality);
}

static void write_table(const page *page)
{
    const char *input = page->inputs.name;
    double worst = 0;
    for (int k = 0; k < page->results; k++)
        worst = fmax(worst, page->result[k].error);
    put(page->file,
        PUT_TABLE("Relative RMS error: root of the weighted squares of the misfit over those of "
                  "what is wanted (target less the shape without %ss). PV: peak to valley. Clipped "
                  "least squares: %ss without limits, cut to the limits. Regularised, then "
                  "clipped: the same with the one parameter that leaves the smallest error, chosen "
                  "knowing the answer. KKT violation: largest violated optimality condition, "
                  "relative.",
                  "^%ss^Limits^Relative RMS error^Misfit, RMS^Misfit, PV^Limit active^Largest %s"
                  "^Beyond the<br>scene’s limits^KKT violation"),
        input, input, page->inputs.title, input);
    for (int k = 0; k < page->results; k++)
        write_row(page, &page->result[k], worst);
    put(page->file, PUT_TABLE_END);
}

static void draw_levels(const page *page, const voltages *result)
{
    draw_scale scale = {true, 0, page->design->units.length};
    draw_extend(&scale, result->aligned_target, page->design->targets);
    draw_extend(&scale, result->shape, page->design->targets);
    page_map(page, result->aligned_target, scale, "Target", ". One scale with reached:");
    page_map(page, result->shape, scale, "Reached", ". One scale with target:");
}

static void draw_voltages(const page *page, const voltages *result)
{
    const design *design = page->design;
    fputs("<figure>\n", page->file);
    for (int which = 0; which < page->map.plans || which == 0; which++)
        shell_voltages(&page->map, which, result, &page->voltage);
    for (int k = 0; k < design->actuators; k++)
        if (scene_heats_all(&design->actuator[k]))
            put(page->file, "<p class=\"keys\">%t: %q</p>\n", design->actuator[k].name,
                result->voltage[design->actuator[k].first], design->units.temperature);
    put(page->file,
        "<figcaption>%ss: largest <b>%q</b>. One scale for all results:", page->inputs.title,
        largest_voltage(page, result), page->voltage.unit);
    page_legend(page, &page->voltage);
}

static void draw_result(page *page, const voltages *result)
{
    const draw_scale own = page_shape(page, result, page->design->target);
    put(page->file,
        is_limited(result) ? "<article class=\"set\">\n<h3>%t, %l"
                           : "<article class=\"set\">\n<h3>%t",
        result->name, result->limit, page->voltage.unit);
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
    page_map(page, page->value, own, "Misfit, reached minus target",
             page->design->targets < page->mesh->nodes
                 ? "; grey where there is no target. Scale of this result:"
                 : ". Scale of this result:");
    draw_voltages(page, result);
    fputs("</div>\n</article>\n", page->file);
}

static void write_page(page *page)
{
    const voltages *best = &page->result[1];
    double residual = 0;
    char title[64], notes[VOLTAGES_TEXT];
    for (int k = 0; k < page->results; k++)
        residual = fmax(residual, page->result[k].residual);
    snprintf(title, sizeof title, "%ss for a wanted shape", page->inputs.title);
    page_begin(page, title, residual);
    put(page->file,
        "<p class=\"verdict\"><b>Relative RMS error %p</b>: %t, %l, limit active at %d of %d "
        "amplifiers.</p>\n<h2>%ss</h2>\n",
        best->error, best->name, best->limit, page->voltage.unit, best->active_limits,
        best->amplifiers, page->inputs.title);
    write_table(page);
    voltages_words(page->design, best, notes);
    if (*notes)
        put(page->file, "<p class=\"lines\">%t</p>\n", notes + strspn(notes, " \n"));
    page_voltages(page, page->result, page->results);
    fputs("<h2>Shapes</h2>\n", page->file);
    page_keys(page, PAGE_KEY("stop", "limit active") PAGE_KEY("over", "beyond the scene’s limits"));
    for (int k = 0; k < page->results; k++)
        draw_result(page, &page->result[k]);
    page_modes(page);
}

static void write_picture(page *page)
{
    const double width = 760, height = fmax(page->space.view.height, 350) + 44;
    const voltages *result = &page->result[1];
    char title[160];
    const draw_scale own = page_shape(page, result, page->design->target);
    snprintf(title, sizeof title,
             "%.60s: relative RMS error %.3g %%. Colour: misfit, lines: target", result->name,
             100 * result->error);
    page_begin_picture(page, title, width, height);
    put(page->file, "<svg width=\"420\" height=\"%f\">", page->space.view.height);
    page_draw_shape(page, &own);
    fputs("</svg>\n<svg x=\"436\" width=\"320\" height=\"350\">", page->file);
    shell_voltages(&page->map, 0, result, &page->voltage);
    fputs("</svg>\n", page->file);
    draw_legend(page->file, &own, 0, height - 32);
    draw_legend(page->file, &page->voltage, 430, height - 32);
}

int report_shape(const report_job *job, const analysis *analysis, const voltages *result,
                 int results, const modes *modes)
{
    page page = {.result = result, .results = results, .modes = modes};
    return page_write(&page, job, analysis, fit_page, write_page, write_picture);
}
