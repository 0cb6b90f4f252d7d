/* SPDX-License-Identifier: BSD-2-Clause */
/* Tables of the sensor gate (sensor_gate.h). */
#include "sensor_gate.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../model/curves.h"
#include "../../lib/modes/eigen.h"

/* Default range of a reading over what voltages, loads and target can make together. */
static const double range_margin = 4;
/* Threshold that no error of a reading reaches. */
static const double never = 1e30;
/* Part of the target by which an error that is not found may move the shape. */
static const double harmless = 0.02;
/* Ratio of the error of a gated sensor to what remains without it (pzs_sensor_gate). */
static const double ratio = 10;
/* Noise below which no error is found, in standard deviations. */
static const double noise_margin = 8;
/* Margin of thresholds above the largest errors that the directions left out can feign. */
static const double left_margin = 1.25;
/*
 * Smallest part of an error outside the span of the basis (its square, of 1) for the sensor to be
 * judged. Where it is smaller, the other sensors hardly determine the reading.
 */
static const double least_free = 0.08;
/* Columns whose part outside the earlier ones is smaller than this part of them are left out. */
static const double least_part = 1e-9;
/* Multiply-adds that the choice of the parity relations may take, roughly. */
static const double most_work = 3e7;
/* Margin of the limit `quiet` for the rounding of single precision. */
static const double rounding = 1e-5;
/* Part of its range from which on an error must be found for a sensor to be judged. */
static const double useful = 0.5;

enum {
    SWEEPS = 30,
    RELATIONS = 32,     /* largest number of parity relations. More of them make a tick longer; with
                           12 of them one of three sets of three wrong sensors is found */
    QUICK = 12,         /* number of them that every tick computes */
    TRIALS = 64,        /* number of random sets of parity relations from which one is chosen */
    FEW_TRIALS = 4,     /* the same number while the directions are chosen, and its least value
                           with many sensors */
    SPARE = 3,          /* fewest parity relations for each sensor that is found wrong */
    MOST = 4,           /* largest number of sensors to be gated or missing at once */
    LEAST_PATIENCE = 64 /* fewest ticks until a gated sensor is trusted again */
};

/* Intermediate results while the tables of the sensor gate are made. */
typedef struct builder {
    sensor_gate *gate;
    const design *design;
    const estimator *estimator;
    const damper *damper;
    const double *influence; /* [outputs][inputs] influence matrix, with the small entries that
                                count as zero in the controller */
    size_t inputs;
    int *reading; /* [sensors] index of the reading of the section `estimate` to which each sensor
                     belongs; 0 where the readings are the target displacements */
    bool is_few;  /* whether the sensors are those of the estimator */
    double unit;
    size_t sensors, outputs, amplifiers, loads, modes, frees, columns;
    size_t relations;          /* number of parity relations */
    double *range, *threshold; /* [sensors] tables; thresholds of weighted errors */
    double *weight;            /* [sensors] weight of each reading: the reciprocal of its noise */
    double *free;  /* [sensors] part of a weighted error outside the span of the basis, squared */
    double *shown; /* [sensors] square of each row of `parity` */
    double *noise; /* [sensors] standard deviation of each weighted reading */
    double *harm;  /* [sensors] motion of the shape by a weighted error of 1, in units of `unit` */
    double *made;  /* [sensors][columns] weighted readings that each cause can make at most */
    double *work;  /* [sensors][columns] work array */
    double *parity, *trial; /* [sensors][RELATIONS] orthonormal parity relations (columns) of the
                               weighted readings: the chosen ones, and those on trial */
    double *left;  /* [columns][RELATIONS] what each column of `made` adds to the relations */
    double *basis; /* [sensors][sensors] orthonormal basis of the readings that voltages,
                      modes and loads can make, by columns: the strongest first */
    double *square, *vector; /* [sensors][sensors] work arrays of the eigenvalue problem */
    double *span;    /* [outputs][amplifiers] orthonormal weighted shapes that voltages can make */
    double *shape;   /* [outputs] work vector */
    double *certain; /* [sensors] smallest weighted error that is found for certain */
    bool is_bounded; /* whether all voltages are bounded */
} builder;

/* One array to be allocated: the address of the pointer to it, and its number of entries. */
typedef struct array {
    double **at;
    size_t count;
} array;

bool sensor_gate_is_asked(const design *design)
{
    bool has_range = design->control.sensor_gate || design->simulate.range > 0;
    for (int i = 0; i < design->estimate.readings; i++)
        has_range |= design->estimate.reading[i].range > 0;
    return has_range;
}

static bool take_memory(builder *builder, double **work)
{
    const size_t sensors = builder->sensors, columns = builder->columns;
    const array all[] = {{&builder->range, sensors},
                         {&builder->weight, sensors},
                         {&builder->threshold, sensors},
                         {&builder->free, sensors},
                         {&builder->noise, sensors},
                         {&builder->harm, sensors},
                         {&builder->certain, sensors},
                         {&builder->made, sensors * columns},
                         {&builder->work, sensors * columns},
                         {&builder->shown, sensors},
                         {&builder->parity, sensors * RELATIONS},
                         {&builder->trial, sensors * RELATIONS},
                         {&builder->left, columns * RELATIONS},
                         {&builder->basis, sensors * sensors},
                         {&builder->square, sensors * sensors},
                         {&builder->vector, sensors * sensors},
                         {&builder->span, builder->outputs * builder->amplifiers},
                         {&builder->shape, builder->outputs}};
    const size_t arrays = sizeof all / sizeof *all;
    size_t total = 0;
    for (size_t i = 0; i < arrays; i++)
        total += all[i].count + 1;
    double *at = *work = calloc(total, sizeof *at);
    for (size_t i = 0; i < arrays && at; i++) {
        *all[i].at = at;
        at += all[i].count + 1;
    }
    return at != NULL;
}

/* ---- sensors ------------------------------------------------------------ */

static const scene_reading *reading_of(const builder *builder, size_t sensor)
{
    return &builder->design->estimate.reading[builder->reading[sensor]];
}

/* Whether two sensors measure the same quantity, for example displacements. */
static bool are_alike(const builder *builder, size_t sensor, size_t other)
{
    const scene_output *output = builder->design->output;
    if (!builder->is_few)
        return true;
    const scene_output *one = &output[reading_of(builder, sensor)->output],
                       *two = &output[reading_of(builder, other)->output];
    return one->type == two->type;
}

static void fill_readings(const builder *builder, const analysis *analysis)
{
    size_t sensor = 0;
    for (int k = 0; k < builder->design->estimate.readings && builder->is_few; k++) {
        const int output = builder->design->estimate.reading[k].output;
        for (int i = 0; i < analysis_outputs(analysis, output); i++)
            builder->reading[sensor++] = k;
    }
}

/*
 * Largest absolute voltage of an amplifier, or, where actuators have curves, the largest absolute
 * effect: the value to which the displacement of the actuator is proportional.
 */
static double largest_voltage(const design *design, int amplifier)
{
    if (curves_are_used(design))
        return 2 * curves_half_range(design, amplifier);
    return fmax(fabs(design->lower[amplifier]), fabs(design->upper[amplifier]));
}

static void take_noise(builder *builder)
{
    const design *design = builder->design;
    for (size_t i = 0; i < builder->sensors; i++) {
        const double noise =
            builder->is_few ? reading_of(builder, i)->noise : design->simulate.noise;
        builder->weight[i] = noise > 0 ? 1 / noise : 1;
        builder->noise[i] = noise > 0 ? 1 : 0;
    }
}

/* Return the row of responses of a sensor, per volt or per unit of each load. */
static const double *direct_row(const builder *builder, size_t sensor)
{
    return builder->is_few ? builder->estimator->direct + sensor * builder->amplifiers
                           : builder->influence + sensor * builder->inputs;
}

static const double *load_row(const builder *builder, size_t sensor)
{
    return (builder->is_few ? builder->estimator->reading_per_load
                            : builder->estimator->shape_per_load) +
           sensor * builder->loads;
}

static const double *mode_row(const builder *builder, size_t sensor)
{
    const pzs_vibration *tables = &builder->damper->tables;
    return (tables->reading ? tables->reading : tables->shape) + sensor * builder->modes;
}

/* Largest size of the coordinate of an observed mode at the limits of the voltages, twice. */
static double mode_size(const builder *builder, size_t mode)
{
    double sum = 0;
    for (size_t k = 0; k < builder->amplifiers; k++)
        sum += fabs(builder->damper->tables.modal[mode * builder->amplifiers + k]) *
               largest_voltage(builder->design, (int)k);
    return 2 * sum;
}

/*
 * Fill the weighted readings that each voltage at its limit, each observed mode, each load and each
 * free function of the target make. Without limits the columns have other scales.
 */
static void fill_made(builder *builder)
{
    const design *design = builder->design;
    for (size_t i = 0; i < builder->sensors; i++) {
        double *row = builder->made + i * builder->columns;
        for (size_t k = 0; k < builder->amplifiers; k++)
            *row++ = builder->weight[i] * direct_row(builder, i)[k] *
                     (builder->is_bounded ? largest_voltage(design, (int)k) : 1);
        for (size_t k = 0; k < builder->modes; k++)
            *row++ = builder->weight[i] * mode_row(builder, i)[k] *
                     (builder->is_bounded ? mode_size(builder, k) : 1);
        for (size_t k = 0; k < builder->loads; k++)
            *row++ = 2 * builder->weight[i] * load_row(builder, i)[k];
        for (size_t k = 0; k < builder->frees; k++)
            *row++ =
                builder->weight[i] * builder->unit * design->free_value[k * builder->outputs + i];
    }
}

/* What voltages and loads can make of a reading together, and the target of a shape. */
static double reach_of(const builder *builder, size_t sensor)
{
    const double *row = builder->made + sensor * builder->columns;
    double sum = builder->is_few ? 0 : fabs(builder->design->target[sensor]);
    for (size_t k = 0; k < builder->amplifiers; k++)
        sum += fabs(row[k]) / builder->weight[sensor];
    for (size_t k = 0; k < builder->loads; k++)
        sum += fabs(row[builder->amplifiers + builder->modes + k]) / builder->weight[sensor];
    return sum;
}

static double given_range(const builder *builder, size_t sensor)
{
    return builder->is_few ? reading_of(builder, sensor)->range : builder->design->simulate.range;
}

/*
 * Set the range of each sensor: that of the scene, or the default, which is common to all sensors
 * that measure the same quantity.
 */
static void fill_ranges(builder *builder)
{
    const bool has_default = builder->is_bounded && builder->design->control.sensor_gate;
    for (size_t i = 0; i < builder->sensors; i++) {
        double reach = 0;
        for (size_t j = 0; j < builder->sensors; j++)
            if (are_alike(builder, i, j))
                reach = fmax(reach, reach_of(builder, j));
        builder->range[i] = has_default && reach > 0 ? range_margin * reach : SENSOR_GATE_NO_RANGE;
        if (given_range(builder, i) > 0)
            builder->range[i] = given_range(builder, i);
    }
}

/* ---- harm of an error ----------------------------------------------------- */

static double norm_of(const double *vector, size_t count, size_t stride)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += vector[i * stride] * vector[i * stride];
    return sqrt(sum);
}

/*
 * Orthonormalise the columns of a matrix [rows][stride], twice each, and move them to its first
 * columns. Returns the number of columns that are independent of the earlier ones.
 */
static size_t orthonormalise(double *matrix, size_t rows, size_t columns, size_t stride)
{
    size_t found = 0;
    for (size_t k = 0; k < columns; k++) {
        double *column = matrix + k, before = norm_of(column, rows, stride);
        for (size_t again = 0; again < 2 * found; again++) {
            const double *other = matrix + again % found;
            double product = 0;
            for (size_t i = 0; i < rows; i++)
                product += other[i * stride] * column[i * stride];
            for (size_t i = 0; i < rows; i++)
                column[i * stride] -= product * other[i * stride];
        }
        const double after = norm_of(column, rows, stride);
        for (size_t i = 0; i < rows && after > least_part * before; i++)
            matrix[i * stride + found] = column[i * stride] / after;
        found += after > least_part * before;
    }
    return found;
}

/*
 * Compute the shape that the controller believes for an error of 1 in one reading.
 *   shape [outputs] out
 */
static void believed_shape(const builder *builder, size_t sensor, double *shape)
{
    const pzs_vibration *tables = &builder->damper->tables;
    const size_t modes = builder->modes;
    if (!builder->is_few) {
        memset(shape, 0, builder->outputs * sizeof *shape);
        shape[sensor] = 1;
        return;
    }
    const double precision = modes > 0 && tables->precision ? tables->precision[sensor] : 1;
    for (size_t i = 0; i < builder->outputs; i++)
        shape[i] = builder->estimator->gain[i * builder->sensors + sensor];
    for (size_t m = 0; m < modes; m++) {
        double fit = 0;
        for (size_t k = 0; k < modes; k++)
            fit += tables->explain[m * modes + k] * precision * mode_row(builder, sensor)[k];
        for (size_t i = 0; i < builder->outputs; i++) {
            double unexplained = tables->shape[i * modes + m];
            for (size_t k = 0; k < builder->sensors; k++)
                unexplained -=
                    builder->estimator->gain[i * builder->sensors + k] * mode_row(builder, k)[m];
            shape[i] += fit * unexplained;
        }
    }
}

/* Orthonormalise the weighted shapes that voltages make. Returns their number. */
static size_t fill_span(builder *builder)
{
    const design *design = builder->design;
    for (size_t i = 0; i < builder->outputs; i++)
        for (size_t k = 0; k < builder->amplifiers; k++)
            builder->span[i * builder->amplifiers + k] =
                design->weight[i] * design->influence[i * builder->amplifiers + k];
    return orthonormalise(builder->span, builder->outputs, builder->amplifiers,
                          builder->amplifiers);
}

/*
 * Compute how far an error of each reading moves the shape: the part of the believed shape that
 * voltages can make, without their limits. All sensors that measure the
 * same quantity get the largest.
 */
static void fill_harm(builder *builder)
{
    const double *weight = builder->design->weight;
    const size_t span = fill_span(builder);
    const double all = norm_of(weight, builder->outputs, 1);
    for (size_t i = 0; i < builder->sensors; i++) {
        believed_shape(builder, i, builder->shape);
        double sum = 0;
        for (size_t k = 0; k < span; k++) {
            double part = 0;
            for (size_t j = 0; j < builder->outputs; j++)
                part += builder->span[j * builder->amplifiers + k] * weight[j] * builder->shape[j];
            sum += part * part;
        }
        builder->certain[i] = sqrt(sum) / all / builder->unit;
    }
    for (size_t i = 0; i < builder->sensors; i++)
        for (size_t j = 0; j < builder->sensors; j++)
            if (are_alike(builder, i, j))
                builder->harm[i] = fmax(builder->harm[i], builder->certain[j] / builder->weight[i]);
}

/* ---- basis ------------------------------------------------------------- */

/* Index of the largest entry on the diagonal of a matrix. */
static size_t largest_diagonal(const double *matrix, size_t n)
{
    size_t at = 0;
    for (size_t i = 1; i < n; i++)
        at = matrix[i * n + i] > matrix[at * n + at] ? i : at;
    return at;
}

/*
 * Fill the basis with the principal directions of `made`, the strongest first. Returns their
 * number.
 */
static size_t find_directions(builder *builder)
{
    const size_t n = builder->sensors, columns = builder->columns;
    size_t found = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double sum = 0;
            for (size_t k = 0; k < columns; k++)
                sum += builder->made[i * columns + k] * builder->made[j * columns + k];
            builder->square[i * n + j] = sum;
        }
    pzs_eigen_symmetric(builder->square, builder->vector, n, SWEEPS, 0);
    const size_t first = largest_diagonal(builder->square, n);
    const double least = builder->square[first * n + first] * least_part * least_part;
    for (size_t k = 0; k < n; k++) {
        const size_t at = largest_diagonal(builder->square, n);
        if (!(builder->square[at * n + at] > least))
            break;
        builder->square[at * n + at] = -1;
        for (size_t i = 0; i < n; i++)
            builder->basis[i * n + found] = builder->vector[i * n + at];
        found++;
    }
    return found;
}

/* Fill the basis with all that voltages, modes and loads can make. Returns the number of columns.
 */
static size_t find_span(builder *builder)
{
    const size_t columns = builder->columns;
    memcpy(builder->work, builder->made, builder->sensors * columns * sizeof *builder->work);
    const size_t found = orthonormalise(builder->work, builder->sensors, columns, columns);
    for (size_t i = 0; i < builder->sensors && found < builder->sensors; i++)
        for (size_t k = 0; k < found; k++)
            builder->basis[i * builder->sensors + k] = builder->work[i * columns + k];
    return found;
}

/* ---- parity relations --------------------------------------------------- */

/* Next random number, +1 or -1 (splitmix64). */
static double random_sign(uint64_t *state)
{
    uint64_t bits = *state += 0x9e3779b97f4a7c15u;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return (bits >> 63) != 0 ? 1 : -1;
}

/* Take the part in the span of the first `directions` columns of the basis out of a column. */
static void leave_span(const builder *builder, size_t directions, double *column, size_t stride)
{
    const size_t n = builder->sensors;
    for (size_t k = 0; k < directions; k++) {
        double product = 0;
        for (size_t i = 0; i < n; i++)
            product += builder->basis[i * n + k] * column[i * stride];
        for (size_t i = 0; i < n; i++)
            column[i * stride] -= product * builder->basis[i * n + k];
    }
}

/* Fill `trial` with random orthonormal columns outside the span. Returns their number. */
static size_t draw_relations(builder *builder, size_t directions, uint64_t *random)
{
    const size_t spare = builder->sensors - directions,
                 wanted = spare < RELATIONS ? spare : RELATIONS;
    for (size_t k = 0; k < wanted; k++) {
        for (size_t i = 0; i < builder->sensors; i++)
            builder->trial[i * RELATIONS + k] = random_sign(random);
        for (int again = 0; again < 2; again++)
            leave_span(builder, directions, builder->trial + k, RELATIONS);
    }
    return orthonormalise(builder->trial, builder->sensors, wanted, RELATIONS);
}

static double row_product(const double *parity, size_t relations, size_t one, size_t other)
{
    double product = 0;
    for (size_t k = 0; k < relations; k++)
        product += parity[one * RELATIONS + k] * parity[other * RELATIONS + k];
    return product;
}

/*
 * Smallest square of the part of a row of `trial` that lies outside another row, of sensors that
 * the others determine: how well the relations tell one wrong sensor from another.
 */
static double trial_quality(builder *builder, size_t relations)
{
    const size_t n = builder->sensors;
    double worst = HUGE_VAL;
    for (size_t i = 0; i < n; i++)
        builder->shown[i] = row_product(builder->trial, relations, i, i);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i && builder->free[i] >= least_free; j++) {
            const double larger = fmax(builder->shown[i], builder->shown[j]);
            if (builder->free[j] < least_free)
                continue;
            const double common = row_product(builder->trial, relations, i, j);
            worst =
                fmin(worst, fmin(builder->shown[i], builder->shown[j]) - common * common / larger);
        }
    return worst;
}

/* Fill `left` and `shown` for the chosen relations. */
static void fill_left(builder *builder)
{
    for (size_t c = 0; c < builder->columns; c++)
        for (size_t k = 0; k < builder->relations; k++) {
            double sum = 0;
            for (size_t i = 0; i < builder->sensors; i++)
                sum += builder->parity[i * RELATIONS + k] * builder->made[i * builder->columns + c];
            builder->left[c * RELATIONS + k] = sum;
        }
    for (size_t i = 0; i < builder->sensors; i++)
        builder->shown[i] = row_product(builder->parity, builder->relations, i, i);
}

/* Smallest square of the row of a sensor in the relations chosen so far and relation k. */
static double least_seen(const builder *builder, const double *seen, size_t k)
{
    double least = HUGE_VAL;
    for (size_t i = 0; i < builder->sensors; i++)
        if (builder->free[i] >= least_free)
            least = fmin(least, seen[i] + pow(builder->parity[i * RELATIONS + k], 2));
    return least;
}

/*
 * Move the relations to the front that together see each sensor best, one after the other: those of
 * every tick.
 */
static void order_relations(builder *builder)
{
    const size_t n = builder->sensors;
    double *seen = builder->trial;
    memset(seen, 0, n * sizeof *seen);
    for (size_t first = 0; first < QUICK && first < builder->relations; first++) {
        size_t best = first;
        double most = -1;
        for (size_t k = first; k < builder->relations; k++) {
            const double least = least_seen(builder, seen, k);
            best = least > most ? k : best;
            most = fmax(most, least);
        }
        for (size_t i = 0; i < n; i++) {
            double *row = builder->parity + i * RELATIONS, kept = row[first];
            row[first] = row[best];
            row[best] = kept;
            seen[i] += row[first] * row[first];
        }
    }
}

/* Choose the best of a number of random sets of relations outside the span of the basis. */
static void choose_relations(builder *builder, size_t directions, int trials)
{
    const size_t n = builder->sensors;
    uint64_t random = 1;
    double best = -1;
    builder->relations = 0;
    for (size_t i = 0; i < n; i++) {
        builder->free[i] = 1;
        for (size_t k = 0; k < directions; k++)
            builder->free[i] -= pow(builder->basis[i * n + k], 2);
    }
    for (int trial = 0; trial < trials; trial++) {
        const size_t relations = draw_relations(builder, directions, &random);
        const double quality = trial_quality(builder, relations);
        if (!(quality > best))
            continue;
        best = quality;
        builder->relations = relations;
        memcpy(builder->parity, builder->trial, n * RELATIONS * sizeof *builder->parity);
    }
    order_relations(builder);
    fill_left(builder);
}

/* ---- thresholds ----------------------------------------------------------- */

/* What a number of basis columns can find. */
typedef struct sight {
    size_t directions;
    bool is_whole; /* whether the basis spans all readings that voltages, modes and loads can make
                    */
    int judged;
    double certain, moved;
} sight;

/* Largest error of a sensor that all columns of `made` together can feign. */
static double feigned(const builder *builder, size_t sensor)
{
    double sum = 0;
    for (size_t c = 0; c < builder->columns; c++) {
        double product = 0;
        for (size_t k = 0; k < builder->relations; k++)
            product += builder->parity[sensor * RELATIONS + k] * builder->left[c * RELATIONS + k];
        sum += fabs(product);
    }
    return sum / builder->shown[sensor];
}

/* Largest norm of the values of the relations that all columns of `made` and noise make. */
static double largest_norm(const builder *builder)
{
    double sum = 0, noise = 0;
    for (size_t c = 0; c < builder->columns; c++)
        sum += norm_of(builder->left + c * RELATIONS, builder->relations, 1);
    for (size_t i = 0; i < builder->sensors; i++)
        noise = fmax(noise, builder->noise[i]);
    return sum + noise_margin / 2 * noise * sqrt((double)builder->relations);
}

/* Whether the other sensors determine a reading well enough. */
static bool is_determined(const builder *builder, size_t sensor, size_t directions)
{
    const double part = (double)builder->relations / (double)(builder->sensors - directions);
    return builder->free[sensor] >= least_free && builder->shown[sensor] >= least_free * part;
}

/*
 * Set the thresholds for a number of basis columns, and judge what they find. An error is found for
 * certain if it exceeds its threshold, and `ratio` times what all else can add to the relations, by
 * what the causes and the noise may take from it.
 */
static sight judge(builder *builder, size_t directions, bool is_whole)
{
    sight sight = {.directions = directions, .is_whole = is_whole};
    const double others = largest_norm(builder);
    for (size_t i = 0; i < builder->sensors; i++) {
        const double shown = sqrt(fmax(builder->shown[i], 1e-30));
        const double left = feigned(builder, i), noise = builder->noise[i] / shown;
        const double small = harmless / fmax(builder->harm[i], harmless / never);
        const double least = fmax(fmax(small, noise_margin * noise), left_margin * left);
        const double certain =
            fmax(least, ratio * others / shown) + left + noise_margin / 2 * noise;
        const double range = builder->range[i] * builder->weight[i];
        const bool is_judged = is_determined(builder, i, directions) && certain < useful * range;
        builder->threshold[i] = is_judged ? least : never;
        sight.judged += is_judged;
        sight.certain = fmax(sight.certain, is_judged ? certain / range : 0);
        sight.moved =
            fmax(sight.moved, builder->harm[i] * (is_judged ? certain : fmin(range, never)));
    }
    return sight;
}

static bool is_better(const sight *one, const sight *other)
{
    return one->judged > other->judged ||
           (one->judged == other->judged && one->moved < other->moved);
}

/* Number of random sets of relations that are tried, fewer with many sensors. */
static int trials_of(const builder *builder)
{
    const double each = (double)builder->sensors * (double)builder->sensors * RELATIONS;
    return (int)fmin(fmax(most_work / each, FEW_TRIALS), TRIALS);
}

/*
 * Choose basis and parity relations. Where twice as many sensors as causes are there, the basis
 * spans all causes; otherwise the number of principal directions is chosen with which most sensors
 * are judged, and with which an error that is not found moves the shape least.
 */
static sight choose_basis(builder *builder)
{
    const size_t n = builder->sensors;
    if (n >= 2 * builder->columns) {
        const size_t directions = find_span(builder);
        choose_relations(builder, directions, trials_of(builder));
        return judge(builder, directions, true);
    }
    sight best = {.judged = -1};
    const size_t found = builder->is_bounded ? find_directions(builder) : 0;
    for (size_t r = 1; r <= found && r + SPARE <= n; r++) {
        choose_relations(builder, r, FEW_TRIALS);
        const sight sight = judge(builder, r, r == found);
        best = is_better(&sight, &best) ? sight : best;
    }
    choose_relations(builder, best.directions, trials_of(builder));
    return judge(builder, best.directions, best.directions == found);
}

/* ---- tables --------------------------------------------------------------- */

static size_t quick_of(const builder *builder)
{
    return builder->relations < QUICK ? builder->relations : QUICK;
}

/* Fill the tables of the redundancy, in the units of the sensors. Returns `quiet`. */
static double fill_parity(const builder *builder, double *parity, double *scale, double *threshold)
{
    const size_t relations = builder->relations, quick = quick_of(builder);
    double quiet = HUGE_VAL;
    for (size_t i = 0; i < builder->sensors; i++) {
        const double weight = builder->weight[i], shown = sqrt(builder->shown[i]);
        const bool is_judged = builder->threshold[i] < never;
        for (size_t k = 0; k < relations; k++)
            parity[i * relations + k] = weight * builder->parity[i * RELATIONS + k];
        scale[i] = is_judged ? 1 / (weight * shown) : 0;
        threshold[i] = is_judged ? builder->threshold[i] / weight : never;
        const double seen = sqrt(row_product(builder->parity, quick, i, i));
        quiet = is_judged ? fmin(quiet, builder->threshold[i] * seen) : quiet;
    }
    return (1 - rounding) * quiet;
}

static uint16_t patience_of(const builder *builder)
{
    const damper *damper = builder->damper;
    const double period =
        damper->is_used && damper->modes > 0 ? damper->rate / damper->frequency[0] : 0;
    return (uint16_t)fmin(fmax(LEAST_PATIENCE, ceil(period)), 60000);
}

static uint16_t most_of(const builder *builder)
{
    const size_t most = builder->relations / SPARE;
    return (uint16_t)(most < MOST ? most : MOST);
}

static bool pack(builder *builder, const sight *sight)
{
    sensor_gate *gate = builder->gate;
    const size_t sensors = builder->sensors, relations = sight->judged > 0 ? builder->relations : 0;
    double *at = gate->memory = calloc(3 * sensors + sensors * relations + 1, sizeof *at);
    if (!at)
        return false;
    memcpy(at, builder->range, sensors * sizeof *at);
    gate->tables = (pzs_sensor_gate){.scene = builder->design->problem.scene,
                                     .sensors = (uint16_t)sensors,
                                     .relations = (uint16_t)relations,
                                     .range = at};
    if (relations > 0) {
        gate->tables.quick = (uint16_t)quick_of(builder);
        gate->tables.most = most_of(builder);
        gate->tables.patience = patience_of(builder);
        gate->tables.replaces = sight->is_whole;
        gate->tables.scale = at + sensors;
        gate->tables.threshold = at + 2 * sensors;
        gate->tables.parity = at + 3 * sensors;
        gate->tables.ratio = ratio;
        gate->tables.quiet = fill_parity(builder, at + 3 * sensors, at + sensors, at + 2 * sensors);
    }
    gate->judged = relations > 0 ? sight->judged : 0;
    gate->certain = sight->certain;
    gate->moved = sight->moved;
    (void)pzs_sensor_gate_seal(&gate->tables);
    return true;
}

static bool are_bounded(const design *design)
{
    bool are_finite = true;
    for (int k = 0; k < design->amplifiers; k++)
        are_finite = are_finite && isfinite(largest_voltage(design, k));
    return are_finite;
}

/* Judge nothing but ranges. */
static sight judge_ranges(const builder *builder)
{
    sight sight = {.judged = 0};
    for (size_t i = 0; i < builder->sensors; i++)
        sight.moved = fmax(sight.moved, builder->harm[i] * builder->weight[i] * builder->range[i]);
    return sight;
}

bool sensor_gate_open(sensor_gate *gate, const analysis *analysis, const estimator *estimator,
                      bool is_few, const damper *damper, double unit)
{
    const design *design = &analysis->design;
    builder builder = {.gate = gate,
                       .design = design,
                       .estimator = estimator,
                       .damper = damper,
                       .influence = analysis->influence,
                       .inputs = design->structure.input.count,
                       .is_few = is_few,
                       .unit = unit,
                       .outputs = (size_t)design->targets,
                       .amplifiers = (size_t)design->amplifiers,
                       .loads = (size_t)design->loads};
    double *work = NULL;
    memset(gate, 0, sizeof *gate);
    gate->is_used = sensor_gate_is_asked(design);
    if (!gate->is_used)
        return true;
    builder.sensors = is_few ? (size_t)estimator->sensors : builder.outputs;
    builder.modes = damper->is_used ? damper->tables.modes : 0;
    builder.frees = is_few ? 0 : (size_t)design->free_functions;
    builder.columns = builder.amplifiers + builder.modes + builder.loads + builder.frees;
    builder.is_bounded = are_bounded(design);
    builder.reading = calloc(builder.sensors + 1, sizeof *builder.reading);
    bool is_done = take_memory(&builder, &work) && builder.reading;
    if (is_done) {
        fill_readings(&builder, analysis);
        take_noise(&builder);
        fill_made(&builder);
        fill_ranges(&builder);
        fill_harm(&builder);
        const sight sight =
            design->control.sensor_gate ? choose_basis(&builder) : judge_ranges(&builder);
        is_done = pack(&builder, &sight);
    }
    free(work);
    free(builder.reading);
    return is_done;
}

void sensor_gate_text(const sensor_gate *gate, char text[SCENE_ERROR])
{
    const pzs_sensor_gate *tables = &gate->tables;
    double least = SENSOR_GATE_NO_RANGE, most = 0;
    for (size_t i = 0; i < tables->sensors; i++) {
        least = fmin(least, tables->range[i]);
        most = fmax(most, tables->range[i]);
    }
    int at = snprintf(text, SCENE_ERROR, "Sensor gate: readings beyond %.3g", least);
    if (most > least)
        at += snprintf(text + at, SCENE_ERROR - (size_t)at, " to %.3g", most);
    at += snprintf(text + at, SCENE_ERROR - (size_t)at, " (unit of each) count as missing.\n  ");
    if (gate->judged > 0)
        at += snprintf(
            text + at, SCENE_ERROR - (size_t)at,
            "%d of %u sensors are judged by the others, which finds up to %u wrong ones at "
            "once,\n  a single one from %.2g %% of its range. ",
            gate->judged, tables->sensors, tables->most, 100 * gate->certain);
    else
        at += snprintf(text + at, SCENE_ERROR - (size_t)at,
                       "No sensor is judged by the others: they are too few, or only ranges are "
                       "stated.\n  ");
    snprintf(text + at, SCENE_ERROR - (size_t)at,
             "An error of one reading that is not found moves the\n  shape by at most %.2g of the "
             "target.",
             gate->moved);
}

void sensor_gate_close(sensor_gate *gate)
{
    free(gate->memory);
    memset(gate, 0, sizeof *gate);
}
