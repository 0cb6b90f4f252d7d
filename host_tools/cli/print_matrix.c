/* SPDX-License-Identifier: BSD-2-Clause */
/* Description of a measured influence matrix (print_matrix.h). */
#include "print_matrix.h"
#include <stdio.h>
#include "../model/curves.h"
#include "../model/matrix_facts.h"
#include "../model/matrix_modes.h"
#include "../text/words.h"

void print_matrix_modes(const design *design)
{
    enum { LISTED = 12 };
    const scene_influence *influence = &design->measured;
    matrix_modes found;
    if (influence->modes > 0 &&
        matrix_modes_find(&found, influence, (size_t)design->amplifiers, false) == 0) {
        printf(
            "  share of the influence matrix (squares) that the measured modes explain: %.4g%%;\n"
            "  static part of each mode:",
            100 * found.share);
        for (int mode = 0; mode < influence->modes && mode < LISTED; mode++)
            printf(" %.3g%%", 100 * found.of_mode[mode]);
        puts(influence->modes > LISTED ? " ..." : "");
        matrix_modes_free(&found);
    }
}

/*
 * Write how much of the influence matrix the static responses of the measured vibration modes
 * explain, as members of a JSON object: the part of the sum of squares of the entries, for all
 * modes together and for each mode.
 */
static void json_modes(json *json, const design *design)
{
    const scene_influence *influence = &design->measured;
    matrix_modes found;
    if (influence->modes > 0 &&
        matrix_modes_find(&found, influence, (size_t)design->amplifiers, false) == 0) {
        json_number(json, "modes_share", found.share);
        json_numbers(json, "mode_shares", found.of_mode, influence->modes);
        matrix_modes_free(&found);
    }
}

/*
 * Print how many entries of a measured influence matrix count as zero in the controller, and the
 * largest error that this causes.
 */
static void print_dropped(const design *design)
{
    const scene_influence *influence = &design->measured;
    const design_dropped *dropped = &design->dropped;
    const double rms = design->targets > 0 ? design_target_rms(design) : 0;
    if (!(influence->drop_below > 0) || design->influence == NULL)
        return;
    printf("  drop_below %g: %zu of %zu entries count as zero in the controller",
           influence->drop_below, dropped->entries,
           (size_t)design->targets * (size_t)design->amplifiers);
    if (dropped->entries > 0) {
        const int row = design_row(design, dropped->output);
        char number[32];
        snprintf(number, sizeof number, "%d", row + 1);
        printf(";\n  with all voltages at their limits they move output %s by %.3g %s",
               influence->output_name ? influence->output_name[row] : number, dropped->error,
               design->units.length);
        if (rms > 0)
            printf(", %.3g of the target's root mean square", dropped->error / rms);
    }
    putchar('\n');
}

/*
 * For each amplifier that drives several actuators together, print its name and the names of these
 * actuators in the file of the influence matrix.
 */
static void print_tied(const scene_influence *influence, const design *design)
{
    for (int k = 0; k < design->amplifiers && influence->tied > 0; k++) {
        const char *separator = "= ";
        if (scene_tied_count(influence, k) < 2)
            continue;
        printf("  tied: %s ", design->amplifier_name[k]);
        for (int i = 0; i < influence->tied; i++)
            if (influence->amplifier_of[i] == k) {
                printf("%s%s", separator, influence->tied_name[i]);
                separator = " + ";
            }
        putchar('\n');
    }
}

/* Print the curves of actuators that are not linear. */
static void print_curves(const design *design)
{
    char text[CURVES_TEXT];
    curves_text(design, text);
    if (*text)
        printf("  %s\n", text);
}

void print_matrix(const analysis *analysis)
{
    const design *design = &analysis->design;
    const scene_influence *influence = &design->measured;
    char unit[WORDS_UNIT];
    matrix_facts facts;
    printf("  measured influence matrix %s: %d outputs, %d actuators", influence->file,
           influence->outputs, design->amplifiers);
    if (influence->outputs < influence->file_outputs)
        printf("; %d of %d rows ignored", influence->file_outputs - influence->outputs,
               influence->file_outputs);
    putchar('\n');
    print_tied(influence, design);
    if (matrix_facts_find(&facts, &design->measured, (size_t)design->amplifiers) < 0)
        return;
    words_unit(&design->units, QUANTITY_INFLUENCE, unit);
    printf("  largest entry %.4g%s%s", facts.entry, *unit ? " " : "", unit);
    if (curves_are_used(design))
        printf(" of effect");
    if (facts.rank >= 0)
        printf("; rank %d, singular values %.3g to %.3g (ratio %.3g)", facts.rank, facts.most,
               facts.least, facts.most / facts.least);
    putchar('\n');
    print_curves(design);
    print_dropped(design);
    print_matrix_modes(design);
}

void print_matrix_json(json *json, const analysis *analysis)
{
    const design *design = &analysis->design;
    matrix_facts facts;
    json_string(json, "influence_file", design->measured.file);
    if (curves_are_used(design)) {
        json_string(json, "actuator_curves",
                    design->measured.curve.is_square ? "quadratic" : "points");
        json_number(json, "actuator_curve_points", design->measured.curve.points);
    }
    json_number(json, "outputs", design->measured.outputs);
    json_modes(json, design);
    json_number(json, "ignored_outputs", design->measured.file_outputs - design->measured.outputs);
    if (matrix_facts_find(&facts, &design->measured, (size_t)design->amplifiers) < 0)
        return;
    json_number(json, "largest_entry", facts.entry);
    if (design->measured.drop_below > 0) {
        json_number(json, "dropped_entries", (double)design->dropped.entries);
        json_number(json, "dropped_error", design->dropped.error);
    }
    if (facts.rank < 0)
        return;
    json_number(json, "rank", facts.rank);
    json_number(json, "largest_singular_value", facts.most);
    json_number(json, "smallest_singular_value", facts.least);
}
