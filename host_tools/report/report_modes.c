/* Modes of a target on a page (report_modes.h). */
#include "report_modes.h"
#include <math.h>
#include "report_draw.h"
#include "report_html.h"

/* Of the picture: a row's height, the left margin of the names, the width of the scale. */
enum { ROW = 22, MARGIN = 150, WIDTH = 560, FOOT = 28 };

/* Decades of the scale: whole powers of ten around every error. */
typedef struct decades {
    int low, high;
} decades;

static void include(decades *d, double error)
{
    const double place = log10(error);
    if (!isfinite(place))
        return;
    if (floor(place) < d->low)
        d->low = (int)floor(place);
    if (ceil(place) > d->high)
        d->high = (int)ceil(place);
}

/* From a hundredth of a percent at the least, below which nobody looks, to a thousand percent at
 * the most. */
static decades scale_of(const modes *modes, int l)
{
    decades d = {0, 0};
    for (int k = 0; k < modes->count; k++) {
        include(&d, modes->mode[k].unconstrained_error);
        include(&d, modes->left[k * modes->limits + l].optimum);
        include(&d, modes->left[k * modes->limits + l].clipped);
    }
    d.low = d.low < -4 ? -4 : d.low < -1 ? d.low : -1;
    d.high = d.high > 1 ? 1 : d.high;
    return d;
}

static double place_of(const decades *d, double error)
{
    const double share = (log10(error) - d->low) / (d->high - d->low);
    return MARGIN + WIDTH * (isfinite(share) ? fmin(fmax(share, 0), 1) : 0);
}

static void draw_scale_lines(FILE *file, const decades *d, int height)
{
    for (int power = d->low; power <= d->high; power++) {
        const double x = place_of(d, pow(10, power));
        fprintf(
            file,
            "<path class=\"grid\" d=\"M%.1f 0V%d\"/><text class=\"value\" x=\"%.1f\" y=\"%d\">%g%%</text>\n",
            x, height, x, height + 16, 100 * pow(10, power));
    }
}

/* A line from the optimum to where clipping lands, a tick without limits. */
static void draw_mode(FILE *file, const decades *d, const char *name, const mode *one,
                      const mode_left *left, int row)
{
    const double y = ROW * (row + 0.5), best = place_of(d, left->optimum),
                 cut = place_of(d, left->clipped), open = place_of(d, one->unconstrained_error);
    fprintf(file, "<text x=\"0\" y=\"%.1f\">", y + 4);
    html_text(file, name);
    fprintf(
        file,
        "</text><path class=\"rest\" d=\"M%.1f %.1fH%.1f\"/><path class=\"axis\" d=\"M%.1f %.1fv12\"/>",
        best, y, cut, open, y - 6);
    fprintf(
        file,
        "<circle class=\"force\" cx=\"%.1f\" cy=\"%.1f\" r=\"3\"/><circle class=\"best\" cx=\"%.1f\" cy=\"%.1f\" r=\"4.5\"/>\n",
        cut, y, best, y);
}

static void draw_modes(FILE *file, const scene *scene, const modes *modes, int l)
{
    const decades d = scale_of(modes, l);
    const int height = ROW * modes->count;
    fputs("<figure style=\"max-width:860px\">\n", file);
    draw_begin_chart(file, MARGIN + WIDTH + 20, height + FOOT,
                     "Shape error of each mode, from the best within limits to clipping");
    draw_scale_lines(file, &d, height);
    for (int k = 0; k < modes->count; k++)
        draw_mode(file, &d, scene->target.mode[k].name, &modes->mode[k],
                  &modes->left[k * modes->limits + l], k);
    draw_end_chart(file);
    fputs(
        "<figcaption>Shape error, each decade alike: <b>disc</b> best within limits, <b>dot</b> volts without limits then clipped, <b>tick</b> "
        "without limits. 100&nbsp;%: nothing gained; beyond, worse than doing nothing.</figcaption></figure>\n",
        file);
}

static void table_modes(FILE *file, const scene *scene, const modes *modes, int l)
{
    double size = 0, voltage = 0;
    for (int k = 0; k < modes->count; k++) {
        size = fmax(size, modes->mode[k].size);
        voltage = fmax(voltage, modes->mode[k].largest_voltage);
    }
    html_table_begin(
        file, NULL,
        "<th scope=\"col\">Mode</th><th scope=\"col\">Wanted, rms</th><th scope=\"col\">No limits</th>"
        "<th scope=\"col\">takes</th><th scope=\"col\">Best within limits</th><th scope=\"col\">At a limit</th><th scope=\"col\">Clipped</th>");
    for (int k = 0; k < modes->count; k++) {
        const mode_left *left = &modes->left[k * modes->limits + l];
        fputs("<tr><th scope=\"row\">", file);
        html_text(file, scene->target.mode[k].name);
        fputs("</th><td>", file);
        html_alike(file, modes->mode[k].size, size, scene->unit_length);
        fputs("</td><td>", file);
        html_percent(file, modes->mode[k].unconstrained_error);
        fputs("</td><td>", file);
        html_alike(file, modes->mode[k].largest_voltage, voltage, scene->unit_voltage);
        fputs("</td><td>", file);
        html_percent(file, left->optimum);
        fprintf(file, "</td><td>%d</td><td>", left->active_limits);
        html_percent(file, left->clipped);
        fputs("</td></tr>\n", file);
    }
    html_table_end(file);
}

void modes_section(FILE *file, const scene *scene, const modes *modes)
{
    for (int l = 0; modes->count > 0 && l < modes->limits; l++) {
        fputs("<section>\n<h2>Mode by mode within ", file);
        html_number(file, modes->left[l].limit[0]);
        fputs(" to ", file);
        html_quantity(file, modes->left[l].limit[1], scene->unit_voltage);
        fputs("</h2>\n", file);
        draw_modes(file, scene, modes, l);
        table_modes(file, scene, modes, l);
        fputs("</section>\n", file);
    }
}
