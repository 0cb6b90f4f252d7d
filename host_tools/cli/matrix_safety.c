/* SPDX-License-Identifier: BSD-2-Clause */
/* Margin of a control loop against errors of its influence matrix (matrix_safety.h). */
#include "matrix_safety.h"
#include <math.h>
#include <stdio.h>

enum { CURE = 200 }; /* characters of the sentence about the cure */

/* Shape error as a percentage; rounding errors count as 0. */
static double percent(double error)
{
    return error > 1e-9 ? 100 * error : 0;
}

/*
 * Describe the regularisation that gives the margin, with what it costs, or that none does. The
 * text is part of a sentence.
 */
static void cure_text(const certificate_matrix *matrix, char text[CURE])
{
    const double bar = certificate_matrix_bar(matrix);
    if (matrix->cure > 0 && isfinite(matrix->error) && isfinite(matrix->cure_error))
        snprintf(
            text, CURE,
            "limits: {regularisation: {relative: %g}} makes it %.2g %%; the shape error of the "
            "optimum is then %.3g %% instead of %.3g %%",
            matrix->cure, 100 * matrix->cure_margin, percent(matrix->cure_error),
            percent(matrix->error));
    else if (matrix->cure > 0)
        snprintf(text, CURE, "limits: {regularisation: {relative: %g}} makes it %.2g %%",
                 matrix->cure, 100 * matrix->cure_margin);
    else if (matrix->cures_tried > 0)
        snprintf(text, CURE, "no limits.regularisation up to {relative: %g} makes it %g %%",
                 matrix->cures_tried, 100 * bar);
    else
        snprintf(text, CURE, "limits.regularisation is larger than all that are tried");
}

void print_matrix_errors(const certificate_matrix *matrix)
{
    char cure[CURE];
    if (!matrix->is_made || matrix->is_unstable)
        return;
    if (!(matrix->margin > 0))
        puts("  Errors of the influence matrix: random relative errors of its entries of 0.01 % "
             "(standard\n  deviation) make the loop unstable.");
    else if (matrix->margin < CERTIFICATE_MATRIX_MOST)
        printf(
            "  Errors of the influence matrix: the loop is stable with random relative errors of "
            "its entries\n  of up to %.2g %% (standard deviation; tried: 0.01 to %g %%).\n",
            100 * matrix->margin, 100 * CERTIFICATE_MATRIX_MOST);
    else
        printf(
            "  Errors of the influence matrix: the loop is stable with random relative errors of "
            "its entries\n  of %g %% (standard deviation), the largest that is tried.\n",
            100 * CERTIFICATE_MATRIX_MOST);
    if (!(matrix->margin < certificate_matrix_bar(matrix)))
        return;
    cure_text(matrix, cure);
    printf("  Margin: %s.\n", cure);
}

void print_matrix_errors_json(json *json, const certificate_matrix *matrix)
{
    const bool has_cure = matrix->cure > 0;
    if (!matrix->is_made)
        return;
    json_open(json, "matrix_errors", '{');
    json_number(json, "margin", matrix->margin);
    json_number(json, "margin_tried", CERTIFICATE_MATRIX_MOST);
    json_number(json, "margin_wanted", certificate_matrix_bar(matrix));
    json_bool(json, "measured", matrix->is_measured);
    json_number(json, "expected", matrix->is_measured ? matrix->stated : (double)NAN);
    json_number(json, "regularisation", has_cure ? matrix->cure : (double)NAN);
    json_number(json, "regularised_margin", has_cure ? matrix->cure_margin : (double)NAN);
    json_number(json, "shape_error", has_cure ? matrix->error : (double)NAN);
    json_number(json, "regularised_shape_error", has_cure ? matrix->cure_error : (double)NAN);
    json_close(json, '}');
}

void warn_of_matrix(analysis *analysis)
{
    const certificate_matrix *matrix = &analysis->certificate.matrix;
    char cure[CURE];
    if (!matrix->is_made || certificate_matrix_refuses(matrix))
        return;
    cure_text(matrix, cure);
    plausible_matrix_errors(&analysis->warnings, analysis->design.scene, matrix->margin, cure);
}

int judge_matrix(const analysis *analysis, char *error)
{
    const certificate_matrix *matrix = &analysis->certificate.matrix;
    char cure[CURE];
    if (!certificate_matrix_refuses(matrix))
        return 0;
    if (matrix->is_unstable)
        return scene_fault(analysis->design.measured.at, error,
                           "the loop is unstable, because its controller leaves out small entries "
                           "of the influence matrix%s; lower influence.drop_below, %g",
                           analysis->design.free_functions > 0
                               ? " and thereby reacts to the free functions of the target"
                               : "",
                           analysis->design.measured.drop_below);
    cure_text(matrix, cure);
    return scene_fault(analysis->design.measured.at, error,
                       "errors of the influence matrix make the loop unstable: it bears random "
                       "relative errors of the entries of %.2g %% (standard deviation), and a "
                       "measured matrix has %g %% (influence.scatter) or more; %s",
                       100 * matrix->margin, 100 * matrix->stated, cure);
}
