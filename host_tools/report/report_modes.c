/* SPDX-License-Identifier: BSD-2-Clause */
/* Section of a page about the modes of a target (report_page.h). */
#include <math.h>
#include "report_page.h"

enum { ROW = 22, MARGIN = 150, WIDTH = 560, FOOT = 28 };

/*
 * Logarithmic axis in whole powers of ten that contains the errors of all modes, but nothing below
 * 0.01 % or above 1000 %.
 */
static draw_axis axis_of(const modes *modes, int l)
{
    double low = 0.1, high = 1;
    for (int k = 0; k < modes->count; k++) {
        const mode_left *left = &modes->left[k * modes->limits + l];
        low = fmin(low, fmin(left->optimum, modes->mode[k].unconstrained_error));
        high = fmax(high, fmax(left->optimum, left->clipped));
    }
    low = pow(10, floor(log10(fmax(low, 1e-4))));
    high = pow(10, ceil(log10(fmin(high, 10))));
    return (draw_axis){low, high, MARGIN, MARGIN + WIDTH, true, "%p", {1, ""}};
}

/*
 * Draw one mode at height y: a disc at the error of the optimum within the limits, a dot at that of
 * clipped least squares, a line between these two, and a tick at the error without voltage limits
 * (open).
 */
static void draw_mode(FILE *file, const draw_axis *x, const char *name, double open,
                      const mode_left *left, double y)
{
    const double best[2] = {draw_on(x, left->optimum), y},
                 clipped[2] = {draw_on(x, left->clipped), y};
    put(file, "<text x=\"0\" y=\"%f\">%t</text>", y + 4, name);
    draw_path(file, "rest");
    draw_line(file, best, clipped);
    put(file, "\"/><path class=\"axis\" d=\"M%f %fv12\"/>", draw_on(x, open), y - 6);
    draw_disc(file, "force", clipped, 3);
    draw_disc(file, "best", best, 4.5);
}

static void draw_modes(FILE *file, const scene *scene, const modes *modes, int l)
{
    const draw_axis x = axis_of(modes, l), y = {0, 1, ROW * modes->count, 0, false, "", {1, ""}};
    fputs("<figure style=\"max-width:860px\">\n", file);
    draw_begin(file, DRAW_CHART, MARGIN + WIDTH + 20, y.from + FOOT,
               "Relative RMS error of each mode",
               "From the optimum within limits to clipped least squares, on a logarithmic axis");
    draw_grid(file, &x, &y, true);
    for (int k = 0; k < modes->count; k++)
        draw_mode(file, &x, scene->target.mode[k].name, modes->mode[k].unconstrained_error,
                  &modes->left[k * modes->limits + l], ROW * (k + 0.5));
    draw_end(file, DRAW_CHART);
    put(file,
        "<figcaption>Relative RMS error: <b>disc</b> optimum within limits, <b>dot</b> clipped "
        "least squares, "
        "<b>tick</b> unconstrained. At 100\xc2\xa0%% nothing is gained.</figcaption></figure>\n");
}

static void write_modes(FILE *file, const scene *scene, const modes *modes, int l)
{
    double size = 0, voltage = 0;
    for (int k = 0; k < modes->count; k++) {
        size = fmax(size, modes->mode[k].size);
        voltage = fmax(voltage, modes->mode[k].largest_voltage);
    }
    put_table(file, "",
              "Mode|Target, RMS|Unconstrained|Its largest voltage|Optimum within "
              "limits|Limit active|Clipped least squares");
    for (int k = 0; k < modes->count; k++) {
        const mode_left *left = &modes->left[k * modes->limits + l];
        put_row(file, "%t|%a|%p|%a|%p|%d|%p", scene->target.mode[k].name, modes->mode[k].size, size,
                scene->unit_length, modes->mode[k].unconstrained_error,
                modes->mode[k].largest_voltage, voltage, scene->unit_voltage, left->optimum,
                left->active_limits, left->clipped);
    }
    put_table_end(file);
}

void page_modes(FILE *file, const scene *scene, const modes *modes)
{
    for (int l = 0; modes->count > 0 && l < modes->limits; l++) {
        put(file, "<section>\n<h2>Mode by mode within %n to %q</h2>\n", modes->left[l].limit[0],
            modes->left[l].limit[1], scene->unit_voltage);
        draw_modes(file, scene, modes, l);
        write_modes(file, scene, modes, l);
        fputs("</section>\n", file);
    }
}
