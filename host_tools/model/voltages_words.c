/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Texts on optimised voltages: limits that they reach, and parts of the target that they cannot
 * change (voltages_words.h).
 */
#include "voltages_words.h"
#include <stdio.h>
#include "design_rows.h"
#include "../text/append.h"

/*
 * Append the names of those limits of sums and differences of voltages that the voltages of a
 * result reach.
 */
static void append_rows(const design *design, const voltages *result, char text[VOLTAGES_TEXT])
{
    enum { MOST_NAMED = 8 };
    int named = 0;
    if (design->limits.rows == 0)
        return;
    text_append(text, VOLTAGES_TEXT,
                "\n  limits between amplifiers (difference, sum%s): %d of %d bind",
                design->limits.absolute_rows > 0 ? ", absolute sum" : "", result->active_rows,
                design->limits.rows);
    for (int k = 0; k < design->limits.rows; k++) {
        char name[4 * SCENE_LABEL];
        if (!design_row_binds(design, k, result->voltage) || named++ >= MOST_NAMED)
            continue;
        design_row_name(design, k, name, sizeof name);
        text_append(text, VOLTAGES_TEXT, "%s%s", named == 1 ? ": " : ", ", name);
    }
    text_append(
        text, VOLTAGES_TEXT,
        "%s\n  clipped voltages are moved towards voltages inside all limits until they keep "
        "these limits\n",
        named > MOST_NAMED ? ", ..." : "");
}

/*
 * Append how many controlled displacements (target rows) lie on constrained dof and differ from the
 * wanted value, which the shape error does not include.
 */
static void append_fixed(const design *design, const voltages *result, char text[VOLTAGES_TEXT])
{
    if (result->fixed_off > 0)
        text_append(
            text, VOLTAGES_TEXT,
            "\n  %d of %d target rows lie on constrained dof and cannot move, %d of them away from "
            "the target;\n  the shape error does not count them, with them it would be %.3f%%\n",
            design->fixed_rows, design->targets, result->fixed_off, 100 * result->error_all);
}

/*
 * Append the names of the free functions (shapes that may be added to the target at no cost). For a
 * target that scattered points give, also append how far the target nodes are from these points.
 */
static void append_target(const design *design, char text[VOLTAGES_TEXT])
{
    const char *before = "\n  free functions, taken out of target and error: ";
    for (int k = 0; k < design->free_functions; k++, before = ", ")
        text_append(text, VOLTAGES_TEXT, "%s%s", before, design->goal.free[k].name);
    text_append(text, VOLTAGES_TEXT, design->free_functions > 0 ? "\n" : "");
    const double gap = design_target_gap(design);
    if (gap > 0)
        text_append(text, VOLTAGES_TEXT,
                    "\n  target through the points of %s: a node is at most %.3g times their usual "
                    "spacing from the nearest%s\n",
                    expr_text(design->goal.value), gap,
                    gap > 2 ? "; it is EXTRAPOLATED there, give more points" : "");
}

void voltages_words(const design *design, const voltages *result, char text[VOLTAGES_TEXT])
{
    text[0] = '\0';
    if (result->narrowed + result->held > 0)
        text_append(text, VOLTAGES_TEXT,
                    "\n  of %d amplifiers, with narrower limits than the table says (own limits, "
                    "field_limit): %d; held: %d\n",
                    design->amplifiers, result->narrowed, result->held);
    append_rows(design, result, text);
    append_fixed(design, result, text);
    append_target(design, text);
}
