/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Limits of sums and differences of voltages as limit rows (limits of weighted sums) of the
 * least-squares problem for the voltages (design_rows.h).
 */
#include "design_rows.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/limit_rows.h"

enum {
    SWEEPS = 20000,   /* largest number of repetitions in which voltages are projected on each limit
                         row (limit of a sum of voltages) and voltage limit in turn */
    MOST_TRIED = 400, /* largest number of limit rows (limits of weighted sums of voltages) among
                         which a smallest contradictory set is searched */
    MOST_NAMED = 4    /* largest number of limit rows (limits of sums of voltages) that an error
                         message names */
};

/*
 * Return the safety distance (V) that the sum in limit row k (limits of a weighted sum of voltages)
 * must keep from its limits when the host computes voltages that obey all limits. A controller in
 * single precision tightens the limits by a margin against rounding errors; the safety distance is
 * twice this margin.
 */
static double safe_margin(const design *design, int k)
{
    return 2 * 0x1p29 * pzs_limit_rows_margin(&design->problem, (uint32_t)k);
}

static double row_sum(const scene_limit_row *row, const double *voltage)
{
    double sum = 0;
    for (int i = 0; i < row->count; i++) {
        const double one = voltage[row->amplifier[i]];
        sum += row->factor[i] * (row->is_absolute ? fabs(one) : one);
    }
    return sum;
}

/*
 * Project voltages [amplifiers] on the set where a weighted sum of their absolute values is at most
 * `limit` (V): each absolute value falls by c times its weight, but not below 0. The number c
 * (`common`) is found by iteration, each time without the voltages that reach 0.
 */
static void shrink(const scene_limit_row *row, double limit, double *voltage)
{
    double common = 0;
    for (int repetition = 0; repetition <= row->count; repetition++) {
        double sum = 0, square = 0;
        for (int i = 0; i < row->count; i++) {
            const double size = fabs(voltage[row->amplifier[i]]), weight = row->factor[i];
            sum += size > common * weight ? weight * size : 0;
            square += size > common * weight ? weight * weight : 0;
        }
        const double next = square > 0 ? (sum - limit) / square : common;
        if (next <= common)
            break;
        common = next;
    }
    for (int i = 0; i < row->count; i++) {
        double *one = &voltage[row->amplifier[i]];
        *one = copysign(fmax(fabs(*one) - common * row->factor[i], 0), *one);
    }
}

/*
 * Project voltages [amplifiers] on the set that satisfies limit row k (limits of a weighted sum of
 * voltages), with its limits tightened by safe_margin. Returns by how much the sum exceeded a limit
 * that is tightened by half of safe_margin (V), at least 0.
 */
static double project(const design *design, int k, double *voltage)
{
    const scene_limit_row *row = &design->limits.row[k];
    const double margin = safe_margin(design, k);
    const double sum = row_sum(row, voltage);
    const double off = sum - fmin(fmax(sum, row->lower + margin), row->upper - margin);
    double square = 0;
    if (row->is_absolute)
        shrink(row, row->upper - margin, voltage);
    for (int i = 0; i < row->count; i++)
        square += row->factor[i] * row->factor[i];
    for (int i = 0; i < row->count && !row->is_absolute; i++)
        voltage[row->amplifier[i]] -= off * row->factor[i] / square;
    return fmax(fabs(off) - margin / 2, 0);
}

/*
 * Search for voltages that obey all voltage limits and limit rows (limits of sums of voltages), by
 * projections on each limit in turn, which converge if such voltages exist.
 *   is_used [rows] in  false: the limit row is ignored; NULL: all limit rows are used
 * Returns the largest violation after the last projections (V); 0 if all limits are obeyed.
 */
static double search(const design *design, const double *lower, const double *upper,
                     const bool *is_used, double *voltage)
{
    double most = HUGE_VAL;
    for (int sweep = 0; sweep < SWEEPS && most > 0; sweep++) {
        most = 0;
        for (int k = 0; k < design->limits.rows; k++)
            if (!is_used || is_used[k])
                most = fmax(most, project(design, k, voltage));
        for (int i = 0; i < design->amplifiers; i++)
            voltage[i] = fmin(fmax(voltage[i], lower[i]), upper[i]);
        for (int k = 0; most <= 0 && k < design->limits.rows; k++)
            if (!is_used || is_used[k]) {
                const double sum = row_sum(&design->limits.row[k], voltage);
                most = fmax(most, fmax(sum - design->limits.row[k].upper,
                                       design->limits.row[k].lower - sum));
            }
    }
    return most;
}

void design_row_name(const design *design, int k, char *text, size_t size)
{
    const scene_limit_row *row = &design->limits.row[k];
    size_t length = 0;
    for (int i = 0; i < row->count && length + 1 < size; i++) {
        const bool is_left_out = i == 3 && row->count > 4;
        const char *sign = row->factor[i] < 0 ? " - " : " + ";
        const char *name = is_left_out ? "..." : design->amplifier_name[row->amplifier[i]];
        const char *bar = row->is_absolute && !is_left_out ? "|" : "";
        const int more =
            snprintf(text + length, size - length, "%s%s%s%s", i > 0 ? sign : "", bar, name, bar);
        length += more > 0 ? (size_t)more : 0;
        i = is_left_out ? row->count - 2 : i;
    }
}

void design_row_range(const design *design, int k, char *text, size_t size)
{
    const scene_limit_row *row = &design->limits.row[k];
    if (row->is_absolute)
        snprintf(text, size, "up to %g", row->upper);
    else
        snprintf(text, size, "from %g to %g", row->lower, row->upper);
}

/*
 * Write to `text` the names and limits of the limit rows (limits of sums of voltages) that
 * contradict each other. is_used [rows] is true for these rows.
 */
static void name_clash(const design *design, const bool *is_used, char *text, size_t size)
{
    size_t length = 0;
    int named = 0;
    for (int k = 0; k < design->limits.rows && length + 1 < size; k++) {
        char name[4 * SCENE_LABEL], range[64];
        if (!is_used[k] || named++ >= MOST_NAMED)
            continue;
        design_row_name(design, k, name, sizeof name);
        design_row_range(design, k, range, sizeof range);
        const int more =
            snprintf(text + length, size - length, "%s%s %s", length > 0 ? "; " : "", name, range);
        length += more > 0 ? (size_t)more : 0;
    }
    if (named > MOST_NAMED && length + 1 < size)
        snprintf(text + length, size - length, "; and %d more", named - MOST_NAMED);
}

/*
 * For an error message, reduce a contradictory set of limit rows (limits of sums of voltages) to a
 * minimal one: no voltages inside the voltage limits satisfy all its rows, but if any one row is
 * left out, some do.
 *   is_used [rows] in/out  true: the row belongs to the set
 */
static void reduce_clash(const design *design, const double *lower, const double *upper,
                         bool *is_used, double *voltage)
{
    for (int k = 0; k < design->limits.rows && design->limits.rows <= MOST_TRIED; k++) {
        is_used[k] = false;
        memset(voltage, 0, (size_t)design->amplifiers * sizeof *voltage);
        if (search(design, lower, upper, is_used, voltage) <= 0)
            is_used[k] = true;
    }
}

static int refuse_clash(const design *design, const double *lower, const double *upper,
                        double *voltage, char *error)
{
    char text[512] = "";
    bool *is_used = malloc(((size_t)design->limits.rows + 1) * sizeof *is_used);
    if (!is_used)
        return scene_fault(design->limits.at, error, "out of memory");
    for (int k = 0; k < design->limits.rows; k++)
        is_used[k] = true;
    reduce_clash(design, lower, upper, is_used, voltage);
    name_clash(design, is_used, text, sizeof text);
    free(is_used);
    return scene_fault(design->limits.row[0].at, error,
                       "no voltages keep these limits together with the voltage limits of their "
                       "amplifiers: %s; widen one of them",
                       text);
}

int design_rows_safe(const design *design, const double *lower, const double *upper, double *safe,
                     char *error)
{
    for (int i = 0; i < design->amplifiers; i++)
        safe[i] = fmin(fmax(design->reference_voltage[i], lower[i]), upper[i]);
    if (search(design, lower, upper, NULL, safe) <= 0)
        return 0;
    return refuse_clash(design, lower, upper, safe, error);
}

int design_rows_violated(const design *design, const double *voltage)
{
    for (int k = 0; k < design->limits.rows; k++) {
        const scene_limit_row *row = &design->limits.row[k];
        const double sum = row_sum(row, voltage), margin = safe_margin(design, k) / 2;
        if (!(sum >= row->lower + margin && sum <= row->upper - margin))
            return k;
    }
    return -1;
}

/*
 * Check that all amplifiers that occur in limit rows (limits of sums of voltages) have finite
 * voltage limits. Returns 0, or -1 with error filled.
 */
static int check_finite(const design *design, char *error)
{
    for (int k = 0; k < design->limits.rows; k++) {
        const scene_limit_row *row = &design->limits.row[k];
        for (int i = 0; i < row->count; i++) {
            const int amplifier = row->amplifier[i];
            if (!isfinite(design->lower[amplifier]) || !isfinite(design->upper[amplifier]))
                return scene_fault(
                    row->at, error,
                    "limits between amplifiers need voltage limits, and %s has none; "
                    "add limits: {voltage: [lowest, highest]}",
                    design->amplifier_name[amplifier]);
        }
    }
    return 0;
}

/*
 * Check that lower and upper limit of every weighted sum of voltages are farther apart than the
 * rounding errors of the sum in single precision. Returns 0, or -1 with error filled.
 */
static int check_width(const design *design, char *error)
{
    for (int k = 0; k < design->limits.rows; k++) {
        const scene_limit_row *row = &design->limits.row[k];
        const double least = 4 * safe_margin(design, k);
        if (row->is_absolute && row->upper < least)
            return scene_fault(row->at, error,
                               "the limit %g is below the rounding errors of a float device, %g; "
                               "raise it",
                               row->upper, least);
        if (row->upper - row->lower < least)
            return scene_fault(
                row->at, error,
                "the limits %g and %g are closer than the rounding errors of a float "
                "device, %g; widen them",
                row->lower, row->upper, least);
    }
    return 0;
}

/*
 * Copy the limits of weighted sums of voltages (limit rows) of the scene into the arrays of the
 * library's tables.
 */
static void copy_rows(design *design)
{
    design_rows *rows = &design->rows;
    uint32_t entry = 0;
    rows->start[0] = 0;
    for (int k = 0; k < design->limits.rows; k++) {
        const scene_limit_row *row = &design->limits.row[k];
        for (int i = 0; i < row->count; i++, entry++) {
            rows->input[entry] = (uint16_t)row->amplifier[i];
            rows->value[entry] = row->factor[i];
        }
        rows->start[k + 1] = entry;
        rows->lower[k] = row->lower;
        rows->upper[k] = row->upper;
    }
    rows->tables = (pzs_limit_rows){
        .call = &pzs_limit_rows_calls,
        .sums = {(uint16_t)design->limits.rows, rows->start, rows->input, rows->value},
        .lower = rows->lower,
        .upper = rows->upper,
        .safe = rows->safe,
        .absolute_count = (uint16_t)design->limits.absolute_rows,
        .absolute_call = design->limits.absolute_rows > 0 ? &pzs_absolute_rows_calls : NULL};
}

static bool allocate_rows(design *design)
{
    design_rows *rows = &design->rows;
    const size_t count = (size_t)design->limits.rows;
    size_t entries = 0;
    for (size_t k = 0; k < count; k++)
        entries += (size_t)design->limits.row[k].count;
    rows->start = calloc(count + 1, sizeof *rows->start);
    rows->input = calloc(entries + 1, sizeof *rows->input);
    rows->value = calloc(entries + 1, sizeof *rows->value);
    rows->lower = calloc(count, sizeof *rows->lower);
    rows->upper = calloc(count, sizeof *rows->upper);
    rows->safe = calloc((size_t)design->amplifiers, sizeof *rows->safe);
    return rows->start && rows->input && rows->value && rows->lower && rows->upper && rows->safe;
}

int design_rows_build(design *design, char *error)
{
    if (design->limits.rows == 0)
        return 0;
    if (design->limits.rows > PZS_LIMIT_ROW_LIMIT)
        return scene_fault(design->limits.at, error,
                           "%d limits between amplifiers; at most %d are possible",
                           design->limits.rows, PZS_LIMIT_ROW_LIMIT);
    if (check_finite(design, error) < 0)
        return -1;
    if (!allocate_rows(design))
        return scene_fault(design->limits.at, error, "out of memory");
    copy_rows(design);
    design->problem.limit_rows = &design->rows.tables;
    if (check_width(design, error) < 0)
        return -1;
    return design_rows_safe(design, design->lower, design->upper, design->rows.safe, error);
}

bool design_row_binds(const design *design, int k, const double *voltage)
{
    const scene_limit_row *row = &design->limits.row[k];
    const double sum = row_sum(row, voltage);
    const double near = 4 * pzs_limit_rows_margin(&design->problem, (uint32_t)k);
    return sum >= row->upper - near || sum <= row->lower + near;
}

int design_rows_active(const design *design, const double *voltage)
{
    int active = 0;
    for (int k = 0; k < design->limits.rows; k++)
        active += design_row_binds(design, k, voltage);
    return active;
}
