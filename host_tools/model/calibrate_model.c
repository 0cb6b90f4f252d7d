/* SPDX-License-Identifier: BSD-2-Clause */
/* Fit of the material constants of a scene to measured shapes by the Gauss-Newton method. */
#include "calibrate_model.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "analysis.h"
#include "material_scale.h"

enum { ITERATIONS = 8, ROUNDS = 6 };

static const double step = 1e-4, settled = 1e-5; /* Constants of the fit of factors for material
                                                    constants, in the logarithm of a factor. step:
                                                    change for a finite difference; settled: largest
                                                    change in the last iteration of a converged fit.
                                                  */

/* ---- model ------------------------------------------------------------ */

static int list_factors(calibration_model *model, const scene *scene)
{
    model->factor = calloc(2 * (size_t)scene->materials + 1, sizeof *model->factor);
    if (!model->factor)
        return -1;
    for (int i = 0; i < scene->materials; i++) {
        model->factor[model->factors++] = (model_factor){i, false, 1};
        if (scene->material[i].has_d || scene->material[i].has_e)
            model->factor[model->factors++] = (model_factor){i, true, 1};
    }
    return 0;
}

/*
 * Copy the influence of the amplifiers on the target nodes from a prepared analysis, and the
 * coordinates of these nodes.
 */
static int copy_influence(const calibration_model *model, analysis *analysis, const pokes *pokes,
                          double *influence, char *error)
{
    const design *design = &analysis->design;
    if (design->targets != (int)pokes->outputs || design->amplifiers != (int)pokes->actuators)
        return scene_fault(design->scene->target.what.at, error,
                           "the scene has %d target nodes and %d amplifiers, the pokes %lu outputs "
                           "and %lu actuators; write a column for each in both files",
                           design->targets, design->amplifiers, (unsigned long)pokes->outputs,
                           (unsigned long)pokes->actuators);
    if (analysis_influence(analysis, error) < 0)
        return -1;
    for (size_t i = 0; i < pokes->outputs; i++)
        memcpy(influence + i * pokes->actuators,
               analysis->influence + i * design->structure.input.count,
               pokes->actuators * sizeof *influence);
    for (size_t i = 0; i < pokes->outputs; i++)
        memcpy(model->place[i], design->mesh.point[design->target_node[i]].position,
               sizeof model->place[i]);
    return 0;
}

/*
 * Compute the influence matrix of the scene with the elastic and piezoelectric constants of its
 * materials multiplied by the factors of the fit.
 */
static int model_influence(const calibration_model *model, const scene *nominal, const pokes *pokes,
                           double *influence, char *error)
{
    scene scene;
    analysis analysis;
    if (scene_vary(&scene, nominal) < 0)
        return scene_fault(nominal->at_surface, error, "out of memory");
    scene.kinematics = KINEMATICS_LINEAR;
    for (int k = 0; k < model->factors; k++) {
        const model_factor *factor = &model->factor[k];
        const double stiffness = factor->is_piezo ? 1 : factor->value;
        const double piezo = factor->is_piezo ? factor->value : 1;
        material_scale(&scene.material[factor->material], stiffness, piezo);
    }
    int failed = analysis_prepare(&analysis, &scene, error);
    if (!failed) {
        failed = copy_influence(model, &analysis, pokes, influence, error);
        analysis_free(&analysis);
    }
    scene_vary_free(&scene);
    return failed;
}

/*
 * Compute the shapes that an influence matrix predicts for the voltages of all measurements
 * (pokes).
 *   shape [pokes][outputs] out  predicted shapes
 */
static void predict(const pokes *pokes, const double *influence, double *shape)
{
    for (size_t poke = 0; poke < pokes->count; poke++)
        for (size_t i = 0; i < pokes->outputs; i++)
            shape[poke * pokes->outputs + i] = calibration_predict(pokes, influence, poke, i);
}

/* ---- Gauss-Newton ----------------------------------------------------- */

/*
 * Arrays of one fit of the factors that multiply the constants of materials, in one allocation that
 * begins at `shape`.
 */
typedef struct fit {
    size_t entries; /* number of values in all measured shapes: number of pokes (measurements) times
                       number of outputs */
    double *shape;  /* [pokes][outputs] shapes that the scene's influence matrix predicts for the
                       voltages of each poke (measurement under known voltages) */
    double *slope;  /* [factors][measurements][outputs] derivative of the predicted shapes by the
                       logarithm of each fitted factor (of the elastic or piezoelectric constants of
                       one material) */
    double *influence; /* [outputs][actuators] influence matrix of the scene after the elastic or
                          piezoelectric constants of one material were changed by a small factor,
                          for finite differences */
    double *normal;    /* [factors][factors] matrix of the normal equations for the factors that
                          multiply the constants of materials */
    double *change; /* [factors] right-hand side of the normal equations for the logarithms of the
                       factors that multiply constants of materials, replaced by the solution:
                       change of each logarithm */
} fit;

static int fit_open(fit *fit, const calibration_model *model, const pokes *pokes)
{
    const size_t entries = pokes->count * pokes->outputs, factors = (size_t)model->factors;
    const size_t matrix = pokes->outputs * pokes->actuators;
    fit->entries = entries;
    fit->shape = calloc((1 + factors) * entries + matrix + factors * factors + factors + 1,
                        sizeof *fit->shape);
    fit->slope = fit->shape + entries;
    fit->influence = fit->slope + factors * entries;
    fit->normal = fit->influence + matrix;
    fit->change = fit->normal + factors * factors;
    return fit->shape ? 0 : -1;
}

static double squares_left(const fit *fit, const pokes *pokes)
{
    double sum = 0;
    for (size_t entry = 0; entry < fit->entries; entry++)
        sum += pow(pokes->shape[entry] - fit->shape[entry], 2);
    return sum;
}

static double squares_of(const pokes *pokes)
{
    double sum = 0;
    for (size_t entry = 0; entry < pokes->count * pokes->outputs; entry++)
        sum += pokes->shape[entry] * pokes->shape[entry];
    return sum;
}

/*
 * Compute the derivatives of the predicted shapes by the logarithms of the factors that multiply
 * the constants of materials, by finite differences. Returns 0, or -1 with error filled.
 */
static int differentiate(fit *fit, calibration_model *model, const scene *nominal,
                         const pokes *pokes, char *error)
{
    for (int k = 0; k < model->factors; k++) {
        double *slope = fit->slope + (size_t)k * fit->entries;
        const double kept = model->factor[k].value;
        model->factor[k].value = kept * exp(step);
        const int failed = model_influence(model, nominal, pokes, fit->influence, error);
        model->factor[k].value = kept;
        if (failed)
            return -1;
        predict(pokes, fit->influence, slope);
        for (size_t entry = 0; entry < fit->entries; entry++)
            slope[entry] = (slope[entry] - fit->shape[entry]) / step;
    }
    return 0;
}

/*
 * Solve the normal equations for the factors that multiply constants of materials, by Cholesky's
 * method. The prior standard deviation of the factors makes the matrix positive definite.
 *   matrix   [order][order] in/out  overwritten by its Cholesky factor
 *   solution [order]        in      right-hand side
 *                           out     solution
 */
static void solve(double *matrix, double *solution, int order)
{
    for (int j = 0; j < order; j++) {
        for (int i = j; i < order; i++)
            for (int k = 0; k < j; k++)
                matrix[i * order + j] -= matrix[i * order + k] * matrix[j * order + k];
        matrix[j * order + j] = sqrt(matrix[j * order + j]);
        for (int i = j + 1; i < order; i++)
            matrix[i * order + j] /= matrix[j * order + j];
        for (int k = 0; k < j; k++)
            solution[j] -= matrix[j * order + k] * solution[k];
        solution[j] /= matrix[j * order + j];
    }
    for (int j = order - 1; j >= 0; j--) {
        for (int k = j + 1; k < order; k++)
            solution[j] -= matrix[k * order + j] * solution[k];
        solution[j] /= matrix[j * order + j];
    }
}

/*
 * Make one Gauss-Newton step of the logarithms of the factors that multiply constants of materials.
 * Returns the largest change of a logarithm.
 */
static double change_factors(fit *fit, calibration_model *model, const pokes *pokes)
{
    const int count = model->factors;
    const double least = DBL_EPSILON * squares_of(pokes);
    const double variance = fmax(squares_left(fit, pokes), least) / (double)fit->entries;
    double most = 0;
    for (int j = 0; j < count; j++) {
        const double *slope = fit->slope + (size_t)j * fit->entries;
        fit->change[j] = -log(model->factor[j].value) / pow(MODEL_SPREAD, 2);
        for (size_t entry = 0; entry < fit->entries; entry++)
            fit->change[j] += slope[entry] * (pokes->shape[entry] - fit->shape[entry]) / variance;
        for (int k = 0; k < count; k++) {
            const double *other = fit->slope + (size_t)k * fit->entries;
            double sum = j == k ? 1 / pow(MODEL_SPREAD, 2) : 0;
            for (size_t entry = 0; entry < fit->entries; entry++)
                sum += slope[entry] * other[entry] / variance;
            fit->normal[j * count + k] = sum;
        }
    }
    solve(fit->normal, fit->change, count);
    for (int j = 0; j < count; j++) {
        const double change = fmin(fmax(fit->change[j], -0.5), 0.5);
        model->factor[j].value *= exp(change);
        most = fmax(most, fabs(change));
    }
    return most;
}

/*
 * Fit the factors of the material constants to the pokes (shapes measured under known voltages).
 * Returns 0, or -1 with error filled.
 */
static int fit_factors(calibration_model *model, const scene *nominal, const pokes *pokes,
                       char *error)
{
    fit fit;
    double change = 1;
    int failed = fit_open(&fit, model, pokes) < 0
                     ? scene_fault(nominal->at_surface, error, "out of memory")
                     : 0;
    for (int again = 0; !failed && again < ITERATIONS && change > settled; again++) {
        failed = model_influence(model, nominal, pokes, model->influence, error);
        if (failed)
            break;
        predict(pokes, model->influence, fit.shape);
        if (model->before < 0) {
            model->before = sqrt(squares_left(&fit, pokes) / squares_of(pokes));
            model->size = calibration_size(pokes, model->influence);
        }
        failed = differentiate(&fit, model, nominal, pokes, error);
        change = failed ? 0 : change_factors(&fit, model, pokes);
    }
    if (!failed)
        failed = model_influence(model, nominal, pokes, model->influence, error);
    if (!failed) {
        predict(pokes, model->influence, fit.shape);
        model->after = sqrt(squares_left(&fit, pokes) / squares_of(pokes));
    }
    free(fit.shape);
    return failed ? -1 : 0;
}

/* ---- faults ----------------------------------------------------------- */

/* Whether two lists contain the same wiring faults in the same order. */
static bool are_same(const wiring_fault *first, int x_faults, const wiring_fault *second,
                     int y_faults)
{
    for (int fault = 0; fault < x_faults && x_faults == y_faults; fault++)
        if (first[fault].type != second[fault].type ||
            first[fault].actuator != second[fault].actuator ||
            first[fault].other != second[fault].other)
            return false;
    return x_faults == y_faults;
}

int calibration_model_fit(calibration_model *model, const scene *nominal, const pokes *given,
                          char *error)
{
    memset(model, 0, sizeof *model);
    model->before = -1;
    model->voltage = calloc(given->count * given->actuators + 1, sizeof *model->voltage);
    model->influence = calloc(given->outputs * given->actuators + 1, sizeof *model->influence);
    model->place = calloc(given->outputs + 1, sizeof *model->place);
    if (!model->voltage || !model->influence || !model->place || list_factors(model, nominal) < 0)
        return scene_fault(nominal->at_surface, error, "out of memory");
    pokes acting = *given;
    acting.voltage = model->voltage;
    for (int again = 0; again < ROUNDS; again++) {
        wiring_fault fault[WIRING_FAULTS];
        wiring_apply(model->fault, model->faults, given, model->voltage);
        if (fit_factors(model, nominal, &acting, error) < 0)
            return -1;
        const int faults = wiring_find(fault, given, model->influence);
        if (faults < 0)
            return scene_fault(nominal->at_surface, error, "out of memory");
        if (are_same(fault, faults, model->fault, model->faults))
            break;
        memcpy(model->fault, fault, sizeof fault);
        model->faults = faults;
    }
    wiring_apply(model->fault, model->faults, given, model->voltage);
    return 0;
}

void calibration_model_free(calibration_model *model)
{
    free(model->factor);
    free(model->influence);
    free(model->voltage);
    free(model->place);
    memset(model, 0, sizeof *model);
}
