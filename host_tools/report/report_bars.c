/* SPDX-License-Identifier: BSD-2-Clause */
/* Voltages of amplifiers as bars, for scenes without patches (report_page.h). */
#include <math.h>
#include "report_page.h"

enum { WIDTH = SHELL_PLANE_WIDTH, NAMES = 74, ROOM = 330, MOST_NAMES = 48 };

/* Draw the bar of one amplifier from the middle of the picture to its voltage. */
static void draw_bar(FILE *file, const scene *scene, int k, double voltage, shell_mark mark,
                     const draw_scale *scale, double height)
{
    static const char *const style[] = {"", "limit", "beyond"};
    const double half = (WIDTH - NAMES) / 2.0, middle = NAMES + half, y = height * k;
    const double end = middle + (scale->most > 0 ? half * voltage / scale->most : 0);
    const double corner[4][2] = {
        {middle, y + 1}, {end, y + 1}, {end, y + height - 1}, {middle, y + height - 1}};
    char name[SCENE_LABEL];
    scene_amplifier_name(scene, k, name);
    put(file, "<g><title>%t: %q</title>", name, voltage, scale->unit);
    draw_path(file, draw_class(scale, draw_level(scale, voltage)));
    draw_polygon(file, corner, 4);
    draw_path_end(file);
    if (mark != SHELL_FREE) {
        draw_path(file, style[mark]);
        draw_polygon(file, corner, 4);
        draw_path_end(file);
    }
    if (scene->amplifiers <= MOST_NAMES)
        put(file, "<text class=\"end\" style=\"font-size:%fpx\" x=\"%d\" y=\"%f\">%t</text>",
            fmin(height, 11), NAMES - 6, y + 0.8 * height, name);
    fputs("</g>\n", file);
}

void page_bars(FILE *file, const scene *scene, const double *voltage, const shell_mark *mark,
               const draw_scale *scale)
{
    const double height = fmin(fmax((double)ROOM / scene->amplifiers, 2), 18);
    const double top[2] = {NAMES + (WIDTH - NAMES) / 2.0, 0},
                 bottom[2] = {top[0], height * scene->amplifiers};
    draw_begin(file, DRAW_GROUP, WIDTH, bottom[1] + 4, "Voltages of the amplifiers",
               "A bar for each amplifier, to the right for positive voltages");
    for (int k = 0; k < scene->amplifiers; k++)
        draw_bar(file, scene, k, voltage[k], mark[k], scale, height);
    draw_path(file, "grid");
    draw_line(file, top, bottom);
    draw_path_end(file);
    draw_end(file, DRAW_GROUP);
}
