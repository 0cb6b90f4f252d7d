/* Outputs along mesh lines (report_lines.h). */
#include "report_lines.h"
#include <math.h>
#include <stdlib.h>
#include "report_draw.h"
#include "report_html.h"
#include "../text/words.h"

/* Of a picture, with room for the numbers to its left and the names to its right. */
enum { LEFT = 84, WIDTH = 520, RIGHT = 116, HEIGHT = 240, FOOT = 34, LINE = 13, NAMES = 64 };

/* Ranges of the coordinate and of the values in a picture. */
typedef struct frame {
    double from, to, low, high;
} frame;

/* Coordinate, 0 or 1, that an output's nodes run along, or -1; node [nodes] out. */
static int line_of(const analysis *analysis, int k, int *node)
{
    const mesh *mesh = &analysis->design.mesh;
    const scene_output *output = &analysis->design.scene->output[k];
    int differs[2] = {0, 0};
    if (output->electric != ELECTRIC_NONE || output->contact != CONTACT_NONE ||
        output->where.type == WHERE_POINT)
        return -1;
    const int count = mesh_select(mesh, &output->where, node);
    for (int i = 1; i < count; i++)
        for (int t = 0; t < 2; t++)
            differs[t] |= mesh->theta[node[i]][t] != mesh->theta[node[0]][t];
    return differs[0] == differs[1] ? -1 : differs[1];
}

static double x_of(const frame *f, double theta)
{
    return LEFT + WIDTH * (theta - f->from) / (f->to - f->from);
}

static double y_of(const frame *f, double value)
{
    return f->high > f->low ? 6 + (HEIGHT - 12) * (f->high - value) / (f->high - f->low)
                            : HEIGHT / 2.0;
}

static frame frame_of(const analysis *analysis, const double *output, int along, int *node)
{
    const scene_line *line = &analysis->design.scene->line[along];
    frame f = {line->point[0], line->point[line->elements], 0, 0};
    for (int k = 0; k < analysis->design.scene->outputs; k++)
        for (int i = 0; line_of(analysis, k, node) == along && i < analysis_outputs(analysis, k);
             i++) {
            f.low = fmin(f.low, analysis_output(analysis, k, i, output));
            f.high = fmax(f.high, analysis_output(analysis, k, i, output));
        }
    return f;
}

static void draw_axes(FILE *file, const scene *scene, const frame *f, int along)
{
    char unit[WORDS_UNIT];
    const double value[3] = {f->low, 0, f->high},
                 theta[3] = {f->from, (f->from + f->to) / 2, f->to};
    for (int i = 0; i < 3; i++) {
        const double y = y_of(f, value[i]), x = x_of(f, theta[i]);
        if (i != 1 || (f->low < 0 && f->high > 0)) {
            fprintf(
                file,
                "<path class=\"grid\" d=\"M%d %.1fH%d\"/><text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">",
                LEFT, y, LEFT + WIDTH, LEFT - 6, y + 4);
            html_number(file, value[i]);
            fputs("</text>", file);
        }
        fprintf(file,
                "<path class=\"grid\" d=\"M%.1f 0V%d\"/><text class=\"value\" x=\"%.1f\" y=\"%d\">",
                x, HEIGHT, x, HEIGHT + 15);
        html_number(file, theta[i]);
        fputs("</text>\n", file);
    }
    fprintf(file, "<text class=\"value\" x=\"%d\" y=\"%d\">&theta;%s", LEFT + WIDTH / 2,
            HEIGHT + 29, along ? "&#8322;" : "&#8321;");
    words_unit(scene, words_of_theta(scene, along), unit);
    fprintf(file, *unit ? " (%s)</text>\n" : "%s</text>\n", unit);
}

/* Names stand a line's height below one another at least: the lowest of those at or below y, or y.
 */
static double name_at(double y, const double *taken, int names)
{
    for (int again = 0; again < names; again++)
        for (int i = 0; i < names; i++)
            if (fabs(taken[i] - y) < LINE)
                y = taken[i] + LINE;
    return y;
}

static void draw_curve(FILE *file, const analysis *analysis, const frame *f, const double *output,
                       int along, int k, const int *node, double name)
{
    const mesh *mesh = &analysis->design.mesh;
    const int count = analysis_outputs(analysis, k);
    fputs("<path class=\"wire\" d=\"", file);
    for (int i = 0; i < count; i++)
        fprintf(file, "%s%.1f %.1f", i ? "L" : "M", x_of(f, mesh->theta[node[i]][along]),
                y_of(f, analysis_output(analysis, k, i, output)));
    fprintf(file, "\"/><text class=\"tag\" x=\"%d\" y=\"%.1f\">", LEFT + WIDTH + 6, name + 4);
    html_text(file, analysis->design.scene->output[k].name);
    fputs("</text>\n", file);
}

static void draw_lines(FILE *file, const analysis *analysis, const double *output, int along,
                       int *node)
{
    const frame f = frame_of(analysis, output, along, node);
    double taken[NAMES];
    int names = 0;
    fputs("<figure style=\"max-width:760px\">\n", file);
    draw_begin_chart(file, LEFT + WIDTH + RIGHT, HEIGHT + FOOT, "Outputs along lines of the mesh");
    draw_axes(file, analysis->design.scene, &f, along);
    for (int k = 0; k < analysis->design.scene->outputs; k++)
        if (line_of(analysis, k, node) == along) {
            const double name = name_at(
                y_of(&f, analysis_output(analysis, k, analysis_outputs(analysis, k) - 1, output)),
                taken, names < NAMES ? names : NAMES);
            taken[names++ % NAMES] = name;
            draw_curve(file, analysis, &f, output, along, k, node, name);
        }
    draw_end_chart(file);
    fputs("<figcaption>Displacement", file);
    if (analysis->design.scene->unit_length[0]) {
        fputs(" in ", file);
        html_text(file, analysis->design.scene->unit_length);
    }
    fputs(".</figcaption></figure>\n", file);
}

void lines_section(FILE *file, const analysis *analysis, const double *output)
{
    int *node = calloc((size_t)analysis->design.mesh.nodes, sizeof *node), found[2] = {0, 0};
    for (int k = 0; node && k < analysis->design.scene->outputs; k++) {
        const int along = line_of(analysis, k, node);
        if (along >= 0)
            found[along] = 1;
    }
    if (found[0] || found[1])
        fputs("<section>\n<h2>Along lines</h2>\n", file);
    for (int along = 0; along < 2; along++)
        if (found[along])
            draw_lines(file, analysis, output, along, node);
    if (found[0] || found[1])
        fputs("</section>\n", file);
    free(node);
}
