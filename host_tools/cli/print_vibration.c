/* Natural frequencies on standard output (print_vibration.h). */
#include "print_vibration.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "words.h"

/* ---- modes ------------------------------------------------------------ */

/* Largest displacement of a node in a mode by a unit of an input; NAN in a rigid motion. */
static double moved_by(const design *d, const vibration *v, int mode, int input)
{
    return v->largest[mode] * vibration_static(v, d, mode, input);
}

/* The amplifier that moves a mode most, or -1. */
static int strongest(const design *d, const vibration *v, int mode)
{
    int best = -1;
    double most = 0;
    for (int k = 0; k < d->amplifiers; k++) {
        const double size = fabs(moved_by(d, v, mode, k));
        if (size > most) {
            most = size;
            best = k;
        }
    }
    return best;
}

static void print_mode(const design *d, const vibration *v, int mode)
{
    const int input = strongest(d, v, mode);
    printf("  %4d %16.6g", mode + 1, v->frequency[mode]);
    for (int axis = 0; axis < 3; axis++)
        printf(" %8.2f%%", 100 * v->effective[mode][axis] / v->mass);
    if (input >= 0) {
        char name[SCENE_LABEL];
        scene_amplifier_name(d->scene, input, name);
        printf("   %-16s %12.4e", name, fabs(moved_by(d, v, mode, input)));
    }
    putchar('\n');
}

void print_vibration(const design *d, const vibration *v)
{
    const scene *s = d->scene;
    char unit[WORDS_UNIT];
    double sum[3] = {0, 0, 0};
    words_unit(s, QUANTITY_LENGTH, unit);
    printf("%s: natural frequencies in the reference state, electrodes short-circuited\n", s->name);
    printf("  mass %.6g; damping ratio %g, %s; %d linear solves, no mode missed\n", v->mass,
           s->dynamics.damping,
           s->dynamics.damping_given ? "given" : "assumed: the scene gives none", v->solves);
    printf("\n  %4s %16s %9s %9s %9s", "mode", "frequency (Hz)", "mass x", "mass y", "mass z");
    if (d->amplifiers > 0)
        printf("   %-16s largest displacement by 1 V%s%s%s", "strongest input", *unit ? " (" : "",
               unit, *unit ? ")" : "");
    putchar('\n');
    for (int i = 0; i < v->count; i++) {
        print_mode(d, v, i);
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += v->effective[i][axis] / v->mass;
    }
    printf("  %-21s %8.2f%% %8.2f%% %8.2f%%\n", "together", 100 * sum[0], 100 * sum[1],
           100 * sum[2]);
}

static void json_mode(json *j, const design *d, const vibration *v, int mode)
{
    json_open(j, NULL, '{');
    json_number(j, "frequency", v->frequency[mode]);
    json_numbers(j, "effective_mass", v->effective[mode], 3);
    json_open(j, "controllability", '{');
    for (int k = 0; k < d->amplifiers; k++) {
        char name[SCENE_LABEL];
        scene_amplifier_name(d->scene, k, name);
        json_number(j, name, moved_by(d, v, mode, k));
    }
    json_close(j, '}');
    json_close(j, '}');
}

void print_vibration_json(const design *d, const vibration *v)
{
    json j = {stdout, 0, {0}};
    json_open(&j, NULL, '{');
    json_string(&j, "scene", d->scene->name);
    json_number(&j, "mass", v->mass);
    json_number(&j, "rigid", v->rigid);
    json_number(&j, "damping", d->scene->dynamics.damping);
    json_string(&j, "damping_from", d->scene->dynamics.damping_given ? "scene" : "assumed");
    json_number(&j, "linear_solves", v->solves);
    json_numbers(&j, "frequency", v->frequency, v->count);
    json_open(&j, "modes", '[');
    for (int i = 0; i < v->count; i++)
        json_mode(&j, d, v, i);
    json_close(&j, ']');
    json_close(&j, '}');
}

/* ---- certificate ------------------------------------------------------ */

/* Lines of a text, each behind two blanks. */
static void print_lines(const char *text)
{
    fputs(*text ? "  " : "", stdout);
    for (const char *p = text; *p; p++)
        fputs(*p == '\n' ? "\n  " : (char[2]){*p, '\0'}, stdout);
    fputs(*text ? "\n" : "", stdout);
}

void print_certificate(const certificate *c)
{
    char text[3 * SCENE_ERROR];
    if (!c->made)
        return;
    if (!c->vibrates) {
        printf("  vibration not known: %s\n", c->why_not);
        return;
    }
    printf("  first natural frequency %.4g Hz; damping ratio %g, %s\n", certificate_first(c),
           c->damping, c->damping_given ? "given" : "assumed");
    certificate_text(c, text);
    print_lines(text);
}

void print_certificate_json(json *j, const certificate *c)
{
    if (!c->made)
        return;
    json_open(j, "vibration", '{');
    if (c->vibrates)
        json_numbers(j, "frequency", c->vibration.frequency, c->vibration.count);
    else
        json_string(j, "missing", c->why_not);
    if (c->vibrates && c->why_not[0])
        json_string(j, "not_judged", c->why_not);
    if (c->is_judged) {
        json_number(j, "damping", c->damping);
        json_number(j, "modes", c->modes);
        json_number(j, "radius", c->radius);
        if (c->rate > 0)
            json_bool(j, "stable", !certificate_refuses(c));
        json_number(j, "rate_to", c->rate_to);
    }
    json_close(j, '}');
}
