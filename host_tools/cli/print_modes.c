/* The modes of a target on standard output (print.h). */
#include <stdio.h>
#include "print.h"

/* A table for each pair of limits. */
void print_modes(const scene *s, const modes *m)
{
    for (int l = 0; m->count > 0 && l < m->limits; l++) {
        const double *limit = m->left[l].limit;
        printf("\n  mode by mode, shape error within %g .. %g V:\n", limit[0], limit[1]);
        printf("  %-20s %12s %11s %12s %11s %7s %11s %12s\n", "mode", "rms wanted", "no limits",
               "largest (V)", "in limits", "active", "clipped", "regularised");
        for (int k = 0; k < m->count; k++) {
            const mode_left *left = &m->left[k * m->limits + l];
            printf("  %-20s %12.3e %10.3f%% %12.2f %10.3f%% %7d %10.3f%% %11.3f%%\n",
                   s->target.mode[k].name, m->mode[k].size, 100 * m->mode[k].unlimited,
                   m->mode[k].volt, 100 * left->optimum, left->active, 100 * left->clipped,
                   100 * left->regularised);
        }
    }
}

void print_modes_json(json *j, const scene *s, const modes *m)
{
    json_open(j, "modes", '[');
    for (int k = 0; k < m->count; k++) {
        json_open(j, NULL, '{');
        json_string(j, "name", s->target.mode[k].name);
        json_number(j, "rms", m->mode[k].size);
        json_number(j, "unlimited_error", m->mode[k].unlimited);
        json_number(j, "largest_volt", m->mode[k].volt);
        json_open(j, "limits", '[');
        for (int l = 0; l < m->limits; l++) {
            const mode_left *left = &m->left[k * m->limits + l];
            json_open(j, NULL, '{');
            json_numbers(j, "limits", left->limit, 2);
            json_number(j, "shape_error", left->optimum);
            json_number(j, "active", left->active);
            json_number(j, "clipped_error", left->clipped);
            json_number(j, "regularised_error", left->regularised);
            json_close(j, '}');
        }
        json_close(j, ']');
        json_close(j, '}');
    }
    json_close(j, ']');
}
