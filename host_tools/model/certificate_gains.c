/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Spectral radius of a control loop in which each mode goes only a part (gain) of its wanted change
 * in a tick, and loses a part (leak) of its coordinate (certificate_gains.h).
 */
#include "certificate_gains.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "eigen.h"
#include "modal.h"

/* ---- groups ----------------------------------------------------------------- */

/*
 * Group of voltages that have the same gain (part of a wanted change that a tick makes) and the
 * same leak (part of a voltage that is lost in a tick), before its matrices are computed.
 */
typedef struct members {
    double gain, leak;
    size_t count;  /* number of modes in the group */
    bool is_other; /* whether the group contains the voltages that belong to no mode */
} members;

static bool are_same(double first, double second)
{
    return !(first < second) && !(first > second);
}

static bool belongs(const pzs_modal_gains *gains, size_t mode, const members *group)
{
    return are_same(gains->gain[mode], group->gain) && are_same(gains->leak[mode], group->leak);
}

/*
 * List the groups of voltages that have the same gain and the same leak (pzs_modal_gains): first
 * the group of the voltages that belong to no mode, then the groups of modes, in the order of the
 * modes.
 *   list [modes + 1] out  groups
 * Returns the number of groups; a group with gain 0 and leak 0 counts, too.
 */
static size_t list_members(const pzs_modal_gains *gains, members *list)
{
    size_t count = 1;
    list[0] = (members){gains->other_gain, gains->other_leak, 0, true};
    for (size_t mode = 0; mode < gains->modes; mode++) {
        size_t k = 0;
        while (k < count && !belongs(gains, mode, &list[k]))
            k++;
        if (k == count)
            list[count++] = (members){gains->gain[mode], gains->leak[mode], 0, false};
        list[k].count++;
    }
    return count;
}

/*
 * Return the number of coordinates of a group of voltages that have the same gain and leak; 0 for
 * gain 0 and leak 0, with which voltages never change, and 0 for an empty group.
 */
static size_t size_of(const members *group, const pzs_modal_gains *gains, size_t modes,
                      size_t moving)
{
    const bool is_empty = group->is_other && group->count == 0 && gains->modes >= moving;
    const bool stays = !(group->gain > 0) && !(group->leak > 0);
    if (is_empty || stays)
        return 0;
    return group->is_other || group->count > modes ? modes : group->count;
}

/*
 * Return the static coordinate of a vibration mode under the voltages of mode number `mode` of the
 * gains.
 */
static double shape_of(const pzs_modal_gains *gains, const certificate_answers *answers,
                       size_t vibration, size_t mode)
{
    double sum = 0;
    for (size_t k = 0; k < answers->moving; k++)
        sum += answers->modal_response[vibration * answers->moving + k] *
               gains->pattern[mode * gains->inputs + answers->amplifier[k]];
    return sum;
}

/*
 * A control step with gain 1 and leak 0 answers a unit of a vibration mode in the readings by
 * voltages that it subtracts. Return the component of these voltages along mode number `mode`
 * (pattern of voltages with a gain of its own).
 */
static double answer_of(const pzs_modal_gains *gains, const certificate_answers *answers,
                        size_t mode, size_t vibration)
{
    double sum = 0;
    for (size_t k = 0; k < answers->moving; k++)
        sum += answers->answer[vibration * answers->moving + k] *
               gains->effect[mode * gains->inputs + answers->amplifier[k]];
    return sum;
}

/*
 * Return entry (i, j) of the loop matrix for gain 1 and leak 0 of all voltages: static coordinate
 * of vibration mode i under the voltages that a step subtracts for a measured unit of mode j.
 */
static double whole_of(const certificate_answers *answers, size_t i, size_t j)
{
    double sum = 0;
    for (size_t k = 0; k < answers->moving; k++)
        sum += answers->modal_response[i * answers->moving + k] *
               answers->answer[j * answers->moving + k];
    return sum;
}

/* Add to the loop matrix of a group `factor` times the contribution of the voltages of one mode. */
static void add_mode(const pzs_modal_gains *gains, const certificate_answers *answers, size_t mode,
                     double factor, double *matrix)
{
    const size_t m = answers->modes;
    for (size_t i = 0; i < m; i++) {
        const double shape = factor * shape_of(gains, answers, i, mode);
        for (size_t j = 0; j < m; j++)
            matrix[i * m + j] += shape * answer_of(gains, answers, mode, j);
    }
}

/*
 * Fill a group whose coordinates are the static coordinates of all vibration modes under its
 * voltages. The matrix `shape` is then the unit matrix, and `answer` is the loop matrix of the
 * group.
 */
static void fill_matrix(certificate_group *group, const members *of, const pzs_modal_gains *gains,
                        const certificate_answers *answers)
{
    const size_t m = answers->modes;
    for (size_t i = 0; i < m; i++) {
        group->shape[i * m + i] = 1;
        for (size_t j = 0; j < m && of->is_other; j++)
            group->answer[i * m + j] = whole_of(answers, i, j);
    }
    for (size_t mode = 0; mode < gains->modes; mode++) {
        const bool is_in = belongs(gains, mode, of);
        if (is_in != of->is_other)
            add_mode(gains, answers, mode, is_in ? 1 : -1, group->answer);
    }
}

/*
 * Fill a group whose coordinates are the components of its voltages along its modes (voltage
 * patterns with gains of their own).
 */
static void fill_modes(certificate_group *group, const members *of, const pzs_modal_gains *gains,
                       const certificate_answers *answers)
{
    const size_t m = answers->modes;
    size_t k = 0;
    for (size_t mode = 0; mode < gains->modes; mode++) {
        if (!belongs(gains, mode, of))
            continue;
        for (size_t i = 0; i < m; i++) {
            group->shape[i * group->size + k] = shape_of(gains, answers, i, mode);
            group->answer[k * m + i] = answer_of(gains, answers, mode, i);
        }
        k++;
    }
}

static bool make_group(certificate_group *group, const members *of, const pzs_modal_gains *gains,
                       const certificate_answers *answers)
{
    const size_t m = answers->modes;
    group->gain = of->gain;
    group->leak = of->leak;
    group->size = size_of(of, gains, m, answers->moving);
    group->shape = calloc(m * group->size + 1, sizeof *group->shape);
    group->answer = calloc(m * group->size + 1, sizeof *group->answer);
    if (!group->shape || !group->answer)
        return false;
    if (of->is_other || of->count > m)
        fill_matrix(group, of, gains, answers);
    else
        fill_modes(group, of, gains, answers);
    return true;
}

bool certificate_groups_make(certificate_groups *groups, const pzs_modal_gains *gains,
                             const certificate_answers *answers)
{
    members *list = calloc((size_t)gains->modes + 1, sizeof *list);
    const size_t count = list ? list_members(gains, list) : 0;
    *groups = (certificate_groups){.modes = answers->modes};
    groups->group = calloc(count + 1, sizeof *groups->group);
    bool is_made = list && groups->group;
    for (size_t k = 0; k < count && is_made; k++)
        if (size_of(&list[k], gains, answers->modes, answers->moving) > 0)
            is_made = make_group(&groups->group[groups->count++], &list[k], gains, answers);
    free(list);
    return is_made;
}

void certificate_groups_free(certificate_groups *groups)
{
    for (size_t k = 0; k < groups->count; k++) {
        free(groups->group[k].shape);
        free(groups->group[k].answer);
    }
    free(groups->group);
    memset(groups, 0, sizeof *groups);
}

/* ---- transition matrix -------------------------------------------------------- */

/*
 * Return the number of states for each coordinate of a group: the coordinate of the commanded
 * voltages; what each of the last `delay` measurements asks the step to subtract; and, if the
 * amplifiers lag, the coordinates of their output at the tick and of its mean in the interval
 * before.
 */
static size_t states_of(const certificate_conditions *conditions)
{
    return 1 + (size_t)conditions->delay + (conditions->lag > 0 ? 2 : 0);
}

size_t certificate_groups_order(const pzs_modal_gains *gains, size_t modes, size_t moving,
                                const certificate_conditions *conditions)
{
    members *list = calloc((size_t)gains->modes + 1, sizeof *list);
    if (!list)
        return SIZE_MAX;
    const size_t count = list_members(gains, list);
    size_t order = 2 * modes;
    for (size_t k = 0; k < count; k++)
        order += size_of(&list[k], gains, modes, moving) * states_of(conditions);
    free(list);
    return order;
}

/*
 * Transition matrix of the loop over one tick, while it is filled. States: the deviation of each
 * vibration mode from equilibrium, the velocity of each vibration mode, then the states of each
 * coordinate of each group (states_of).
 */
typedef struct transition {
    const certificate_groups *groups;
    const certificate_conditions *conditions;
    size_t order;
    double kept, behind; /* The output of an amplifier follows its command with a first-order lag.
                            kept: fraction of their difference that is left at the end of a tick
                            interval; behind: mean of this fraction over the interval */
    double *matrix;      /* [order][order] transition matrix, row by row */
    double *change; /* [modes][order] change of the equilibrium of each vibration mode at the tick,
                       as factors of the states */
    double *measured; /* [order] work row: what the measurement of the tick asks the step to
                         subtract from one coordinate */
} transition;

/*
 * Return the row of the transition matrix for one state of coordinate i of a group of voltages.
 * `part` tells which of the states of this coordinate, counted from 0 in the order of states_of.
 */
static size_t state_of(const transition *transition, size_t group, size_t part, size_t i)
{
    size_t first = 2 * transition->groups->modes;
    for (size_t k = 0; k < group; k++)
        first += transition->groups->group[k].size * states_of(transition->conditions);
    return first + part * transition->groups->group[group].size + i;
}

/*
 * Fill a row with the factors of the states that give what the measurement of this tick asks the
 * step to subtract from coordinate i of a group.
 */
static void measure(const transition *transition, size_t group, size_t i, double *row)
{
    const certificate_group *of = &transition->groups->group[group];
    const size_t m = transition->groups->modes, delay = (size_t)transition->conditions->delay;
    const double gain = transition->conditions->gain;
    memset(row, 0, transition->order * sizeof *row);
    for (size_t j = 0; j < m; j++)
        row[j] = of->answer[i * m + j];
    if (transition->conditions->lag > 0) {
        row[state_of(transition, group, delay + 2, i)] += gain;
        row[state_of(transition, group, 0, i)] -= 1;
    } else {
        row[state_of(transition, group, 0, i)] += gain - 1;
    }
}

static void add_row(const transition *transition, double *row, double factor, const double *from)
{
    for (size_t j = 0; j < transition->order; j++)
        row[j] += factor * from[j];
}

static double *row_of(const transition *transition, size_t state)
{
    return transition->matrix + state * transition->order;
}

/*
 * Fill the rows of the transition matrix for coordinate i of a group: the row of the commanded
 * voltages, and the rows that store what the last measurements ask the step to subtract.
 */
static void fill_command(const transition *transition, size_t group, size_t i)
{
    const certificate_group *of = &transition->groups->group[group];
    const size_t delay = (size_t)transition->conditions->delay;
    const size_t command = state_of(transition, group, 0, i);
    double *row = row_of(transition, command);
    measure(transition, group, i, transition->measured);
    row[command] += 1 - of->gain - of->leak;
    if (delay == 0) {
        add_row(transition, row, -of->gain, transition->measured);
        return;
    }
    row[state_of(transition, group, delay, i)] -= of->gain;
    add_row(transition, row_of(transition, state_of(transition, group, 1, i)), 1,
            transition->measured);
    for (size_t k = 2; k <= delay; k++)
        row_of(transition,
               state_of(transition, group, k, i))[state_of(transition, group, k - 1, i)] = 1;
}

/*
 * Fill the rows of the transition matrix for the output of lagging amplifiers at the coming tick,
 * and for the mean output in the interval before it. Also add what the mean output changes in the
 * equilibrium of the structure.
 */
static void fill_output(const transition *transition, size_t group, size_t i)
{
    const certificate_group *of = &transition->groups->group[group];
    const size_t delay = (size_t)transition->conditions->delay;
    const bool lags = transition->conditions->lag > 0;
    const size_t command = state_of(transition, group, 0, i);
    const size_t output = state_of(transition, group, delay + 1, i);
    const size_t mean = lags ? state_of(transition, group, delay + 2, i) : command;
    const double *driven = row_of(transition, mean);
    if (lags) {
        row_of(transition, output)[output] += transition->kept;
        add_row(transition, row_of(transition, output), 1 - transition->kept,
                row_of(transition, command));
        row_of(transition, mean)[output] += transition->behind;
        add_row(transition, row_of(transition, mean), 1 - transition->behind,
                row_of(transition, command));
    }
    for (size_t k = 0; k < transition->groups->modes; k++) {
        const double factor = transition->conditions->gain * of->shape[k * of->size + i];
        double *change = transition->change + k * transition->order;
        add_row(transition, change, factor, driven);
        change[mean] -= factor;
    }
}

/*
 * Fill the two rows of a vibration mode in the transition matrix: the change of its equilibrium at
 * the tick, then free vibration about the new equilibrium over a tick interval.
 */
static void fill_vibration(const transition *transition, size_t i, const double turn[4])
{
    const size_t m = transition->groups->modes;
    for (size_t half = 0; half < 2; half++) {
        double *row = row_of(transition, half * m + i);
        add_row(transition, row, -turn[2 * half], transition->change + i * transition->order);
        row[i] += turn[2 * half];
        row[m + i] += turn[2 * half + 1];
    }
}

static void fill(transition *transition, const double *square, const double *damping)
{
    const certificate_conditions *conditions = transition->conditions;
    if (conditions->lag > 0) {
        const double times = conditions->interval / conditions->lag;
        transition->kept = exp(-times);
        transition->behind = -expm1(-times) / times;
    }
    for (size_t k = 0; k < transition->groups->count; k++)
        for (size_t i = 0; i < transition->groups->group[k].size; i++) {
            fill_command(transition, k, i);
            fill_output(transition, k, i);
        }
    for (size_t i = 0; i < transition->groups->modes; i++) {
        double turn[4];
        modal_propagator(sqrt(square[i]), damping[i], conditions->interval, turn);
        fill_vibration(transition, i, turn);
    }
}

/*
 * Make the transition matrix, with a work array of the same size behind it; NULL where memory runs
 * out. The caller frees it.
 */
static double *make_matrix(const certificate_groups *groups, const double *square,
                           const double *damping, const certificate_conditions *conditions,
                           size_t *order)
{
    transition transition = {.groups = groups, .conditions = conditions};
    transition.order = 2 * groups->modes;
    for (size_t k = 0; k < groups->count; k++)
        transition.order += groups->group[k].size * states_of(conditions);
    *order = transition.order;
    const size_t entries = transition.order * transition.order;
    transition.matrix = calloc(2 * entries + 1, sizeof *transition.matrix);
    transition.change =
        calloc((groups->modes + 1) * transition.order + 1, sizeof *transition.change);
    if (transition.matrix && transition.change) {
        transition.measured = transition.change + groups->modes * transition.order;
        fill(&transition, square, damping);
    } else {
        free(transition.matrix);
        transition.matrix = NULL;
    }
    free(transition.change);
    return transition.matrix;
}

double certificate_groups_radius(const certificate_groups *groups, const double *square,
                                 const double *damping, const certificate_conditions *conditions,
                                 int squarings)
{
    size_t order;
    double *matrix = make_matrix(groups, square, damping, conditions, &order);
    const double radius =
        matrix ? eigen_radius(matrix, matrix + order * order, order, squarings) : (double)NAN;
    free(matrix);
    return radius;
}

bool certificate_groups_decay(const certificate_groups *groups, const double *square,
                              const double *damping, const certificate_conditions *conditions,
                              int squarings)
{
    size_t order;
    double *matrix = make_matrix(groups, square, damping, conditions, &order);
    const bool decays = matrix && eigen_decays(matrix, matrix + order * order, order, squarings);
    free(matrix);
    return decays;
}
