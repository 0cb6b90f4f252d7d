/* SPDX-License-Identifier: BSD-2-Clause */
/* Plausibility rules on a measured influence matrix (plausible_parts.h). */
#include "plausible_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../scene/scene_units.h"
#include "matrix_facts.h"
#include "matrix_modes.h"

/*
 * Largest number of actuators for which the columns of a measured influence matrix are compared
 * with each other.
 */
enum { COMPARED = 512 };

/* Largest number of actuators that a warning names. */
enum { NAMED = 8 };

/*
 * Return whether the measured influence matrix has a column for actuator k. If so, the result
 * found->at is set to the position of the matrix in the scene file.
 */
static int has_column(const subject *of, int k, measured *found)
{
    if (!of->scene->influence.given || k >= of->scene->amplifiers)
        return 0;
    found->at = of->scene->influence.at;
    return 1;
}

int measure_matrix_entry(const subject *of, int k, measured *found)
{
    static const units_unit unit = {{1, 0, -1, 0, 0, 0}, 0, 0};
    matrix_facts facts;
    int ten;
    if (k > 0 || !has_column(of, k, found) ||
        matrix_facts_find(&facts, &of->scene->influence, (size_t)of->scene->amplifiers) < 0)
        return 0;
    if (scene_units_ten(of->scene, &unit, &ten) < 0)
        found->value = facts.entry * pow(10, -ten);
    snprintf(found->what, WHAT, "largest entry of the influence matrix, %g in the scene's units",
             facts.entry);
    return 1;
}

int measure_matrix_shape(const subject *of, int k, measured *found)
{
    if (k > 0 || !has_column(of, k, found))
        return 0;
    found->value = (double)of->scene->amplifiers / of->scene->influence.outputs;
    snprintf(found->what, WHAT, "actuators for each output, %d for %d", of->scene->amplifiers,
             of->scene->influence.outputs);
    return 1;
}

/*
 * Return whether the lower and the upper voltage limit of amplifier k are equal, so that its
 * voltage cannot change.
 */
static int is_held(const scene *scene, int k)
{
    double lower = -HUGE_VAL, upper = HUGE_VAL;
    scene_own_limits(scene, k, &lower, &upper);
    return lower == upper;
}

/*
 * Append the name of an actuator to a list of actuators, which shows only the first few names (at
 * most NAMED).
 *   names [WHAT] in/out  text of the list
 *   count        in      number of actuators that are already in the list
 */
static void name_actuator(const char *name, int count, char *names)
{
    const size_t used = strlen(names);
    if (count < NAMED)
        snprintf(names + used, WHAT - used, "%s '%s'", count > 0 ? "," : "", name);
    else if (count == NAMED)
        snprintf(names + used, WHAT - used, " and others");
}

/*
 * Find the actuators of weak effect: their voltage can change, and the norm of their column of the
 * influence matrix over `reference` is at least `from` and less than `to`. Store the smallest of
 * these ratios and a text with the names in *found.
 *   reference in  norm of the influence matrix column of the strongest or of the median actuator
 */
static void name_weak(const scene *scene, double reference, double from, double to,
                      const char *reference_name, measured *found)
{
    char names[WHAT] = "";
    double least = HUGE_VAL;
    int count = 0;
    for (int i = 0; i < scene->amplifiers; i++) {
        const double size = matrix_column_size(scene, i) / reference;
        if (is_held(scene, i) || !(size >= from && size < to))
            continue;
        name_actuator(scene->actuator[i].name, count++, names);
        least = fmin(least, size);
    }
    if (count > 0)
        found->value = least;
    const char *form = count > 1 ? "effect of actuators%.200s over that of %s, the least"
                                 : "effect of actuator%.200s over that of %s";
    snprintf(found->what, WHAT, form, names, reference_name);
}

static double strongest_column(const scene *scene)
{
    double most = 0;
    for (int i = 0; i < scene->amplifiers; i++)
        most = fmax(most, matrix_column_size(scene, i));
    return most;
}

int measure_dead_column(const subject *of, int k, measured *found)
{
    if (k > 0 || !has_column(of, k, found))
        return 0;
    name_weak(of->scene, strongest_column(of->scene), 0, MATRIX_DEAD, "the strongest", found);
    return 1;
}

static int ascending(const void *x, const void *y)
{
    const double *a = x, *b = y;
    return (*a > *b) - (*a < *b);
}

/*
 * Return the median norm of the columns of the influence matrix, one for each actuator; 0 where
 * there are fewer than three or more than COMPARED actuators.
 */
static double median_column(const scene *scene)
{
    const int amplifiers = scene->amplifiers;
    double size[COMPARED];
    if (amplifiers > COMPARED || amplifiers < 3)
        return 0;
    for (int i = 0; i < amplifiers; i++)
        size[i] = matrix_column_size(scene, i);
    qsort(size, (size_t)amplifiers, sizeof *size, ascending);
    return size[amplifiers / 2];
}

int measure_weak_column(const subject *of, int k, measured *found)
{
    if (k > 0 || !has_column(of, k, found))
        return 0;
    const double median = median_column(of->scene);
    const double dead = MATRIX_DEAD * strongest_column(of->scene);
    if (median > 0)
        name_weak(of->scene, median, dead / median, MATRIX_WEAK, "the median actuator", found);
    return 1;
}

int measure_strong_column(const subject *of, int k, measured *found)
{
    if (!has_column(of, k, found))
        return 0;
    const double median = median_column(of->scene);
    if (median > 0)
        found->value = matrix_column_size(of->scene, k) / median;
    snprintf(found->what, WHAT, "effect of actuator '%s' over the median of all",
             of->scene->actuator[k].name);
    return 1;
}

/* Return the cosine of the angle between the columns j and k of the influence matrix. */
static double cosine(const scene *scene, int j, int k)
{
    const size_t amplifiers = (size_t)scene->amplifiers;
    double sum = 0;
    for (size_t i = 0; i < (size_t)scene->influence.outputs; i++)
        sum += scene->influence.matrix[i * amplifiers + (size_t)j] *
               scene->influence.matrix[i * amplifiers + (size_t)k];
    return sum / (matrix_column_size(scene, j) * matrix_column_size(scene, k));
}

int measure_repeated_column(const subject *of, int k, measured *found)
{
    int other = 0;
    if (!has_column(of, k, found) || of->scene->amplifiers > COMPARED)
        return 0;
    for (int j = 0; j < k; j++) {
        const double same = cosine(of->scene, j, k), differ = sqrt(fmax(0, 1 - same * same));
        if (isfinite(same) && !(differ >= found->value)) {
            found->value = differ;
            other = j;
        }
    }
    snprintf(found->what, WHAT, "sine of the angle between the columns of actuators '%s' and '%s'",
             of->scene->actuator[other].name, of->scene->actuator[k].name);
    return 1;
}

/* ---- measured modes --------------------------------------------------------- */

/*
 * Compare the measured vibration modes of a scene with its influence matrix. Returns whether the
 * scene has modes that can be compared; if so, matrix_modes_free must be called.
 */
static bool compare_modes(const subject *of, bool with_swaps, matrix_modes *compared,
                          measured *found)
{
    const scene_influence *influence = &of->scene->influence;
    if (!influence->given || influence->modes == 0)
        return false;
    found->at = influence->at;
    if (matrix_modes_find(compared, influence, (size_t)of->scene->amplifiers, with_swaps) == 0)
        return true;
    matrix_modes_free(compared);
    return false;
}

int measure_modes_share(const subject *of, int k, measured *found)
{
    matrix_modes compared;
    if (k > 0 || !compare_modes(of, false, &compared, found))
        return 0;
    found->value = compared.share / (1 - compared.rest);
    snprintf(found->what, WHAT,
             "the given responses explain %.3g%% of the influence matrix, others would explain "
             "%.3g%%: ratio",
             100 * compared.share, 100 * (1 - compared.rest));
    matrix_modes_free(&compared);
    return 1;
}

int measure_shuffled_modes(const subject *of, int k, measured *found)
{
    matrix_modes compared;
    if (k > 0 || !compare_modes(of, false, &compared, found))
        return 0;
    found->value = compared.rest / compared.random_rest;
    snprintf(
        found->what, WHAT,
        "the measured modes leave %.3g%% of the influence matrix, with their outputs in random "
        "order %.3g%%: ratio",
        100 * compared.rest, 100 * compared.random_rest);
    matrix_modes_free(&compared);
    return 1;
}

int measure_mode_share(const subject *of, int k, measured *found)
{
    matrix_modes compared;
    if (k >= of->scene->influence.modes || !compare_modes(of, false, &compared, found))
        return 0;
    found->value = compared.of_mode[k];
    snprintf(found->what, WHAT, "static part of mode %d over the influence matrix (squares)",
             k + 1);
    matrix_modes_free(&compared);
    return 1;
}

int measure_reversed_column(const subject *of, int k, measured *found)
{
    matrix_modes compared;
    char names[WHAT] = "";
    int count = 0;
    if (k > 0 || !compare_modes(of, false, &compared, found))
        return 0;
    for (int i = 0; i < of->scene->amplifiers; i++) {
        if (!(compared.cosine[i] < MATRIX_REVERSED))
            continue;
        found->value = count > 0 ? fmin(found->value, compared.cosine[i]) : compared.cosine[i];
        name_actuator(of->scene->actuator[i].name, count++, names);
    }
    const char *form = count > 1 ? "cosine between the columns of actuators%.200s and the modes' "
                                   "static responses to them, the least"
                                 : "cosine between the column of actuator%.200s and the modes' "
                                   "static response to it";
    snprintf(found->what, WHAT, form, names);
    matrix_modes_free(&compared);
    return 1;
}

int measure_swapped_outputs(const subject *of, int k, measured *found)
{
    const int *row = of->scene->influence.row;
    matrix_modes compared;
    if (k > 0 || !compare_modes(of, true, &compared, found))
        return 0;
    if (compared.swaps > 0)
        found->value = compared.swap_gain;
    snprintf(found->what, WHAT,
             "the modes leave %.3g%% of the influence matrix, and %.3g%% with outputs %d and %d "
             "of the shapes swapped%s: gain over what is left of two outputs",
             100 * compared.rest, 100 * compared.swapped_rest, row[compared.swapped[0]] + 1,
             row[compared.swapped[1]] + 1, compared.swaps > 1 ? " and others" : "");
    matrix_modes_free(&compared);
    return 1;
}
