/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Natural frequencies and mode shapes (pzs_modes.h): preparation, count of the modes by the pivots
 * of the shifted stiffness matrix, results.
 */
#include "modes.h"
#include <string.h>
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../core/numbers.h"
#include "../model/model.h"
#include "../model/shell.h"
#include "element_mass.h"

#if PZS_MODES

/*
 * BLOCK, BLOCK_LOOSE: number of start vectors without and with a shift; with a shift six rigid
 * motions of the same frequency are expected. CHECKS: largest number of counts of the modes.
 * SPARE: least number of Lanczos vectors beyond the number of modes.
 */
enum { BLOCK = 2, BLOCK_LOOSE = 6, CHECKS = 8, SPARE = 4 };

/*
 * A mode counts as a rigid motion if its squared frequency is below this part of the shift; such a
 * squared frequency is a rounding error.
 */
static const pzs_real rigid_below = PZS_BY_BITS((pzs_real)1e-4, (pzs_real)1e-8);

static const pzs_real two_pi = (pzs_real)6.283185307179586;

static pzs_status fail(pzs_modes *modes, pzs_status status, int32_t where)
{
    modes->info.where = where;
    return status;
}

/* ---- init --------------------------------------------------------------- */

static bool sizes_in_range(const pzs_structure *structure, uint32_t number, uint32_t vectors)
{
    const uint32_t least =
        number + SPARE < structure->free_dof ? number + SPARE : structure->free_dof;
    return number > 0 && number <= structure->free_dof && vectors >= least;
}

/* Divide the workspace among the arrays of the search. */
static void divide_workspace(pzs_modes *modes, uint32_t free_dof, void *work)
{
    const size_t vectors = modes->state.vectors;
    modes->state.basis = work;
    modes->state.projection = modes->state.basis + vectors * free_dof;
    modes->state.ritz = modes->state.projection + vectors * vectors;
    modes->state.turn = modes->state.ritz + vectors * vectors;
    modes->state.square = modes->state.turn + vectors * vectors;
    modes->state.row = modes->state.square + vectors;
    modes->state.order = (uint16_t *)(void *)(modes->state.row + vectors);
    modes->info.square = modes->state.square;
    modes->info.shape = modes->state.basis;
}

uint32_t pzs_modes_solve_limit(uint32_t number)
{
    return 100u + 20u * number;
}

pzs_status pzs_modes_init(pzs_modes *modes, pzs_model *model, const pzs_mass *mass, uint16_t number,
                          uint16_t vectors, void *work, size_t bytes)
{
    int32_t where;
    if (!modes || !model || !mass || !work)
        return PZS_E_ARGUMENT;
    memset(modes, 0, sizeof *modes);
    modes->info.where = -1;
    if (model->state.stage < STAGE_READY)
        return PZS_E_STAGE;
    const pzs_structure *structure = model->state.structure;
    if (!sizes_in_range(structure, number, vectors))
        return PZS_E_ARGUMENT;
    const pzs_status status = pzs_mass_check(mass, structure, &where);
    if (status != PZS_OK)
        return fail(modes, status, where);
    const int32_t missing =
        guard_missing_bytes(work, bytes, PZS_MODES_BYTES(structure->free_dof, vectors));
    if (missing >= 0)
        return fail(modes, PZS_E_WORKSPACE, missing);
    modes->settings.tolerance = PZS_BY_BITS((pzs_real)1e-4, (pzs_real)1e-8);
    modes->settings.solve_limit = pzs_modes_solve_limit(number);
    modes->info.number = number;
    modes->state.model = model;
    modes->state.mass = mass;
    modes->state.vectors = vectors;
    divide_workspace(modes, structure->free_dof, work);
    modes->state.stage = MODES_READY;
    return PZS_OK;
}

/* ---- matrices ----------------------------------------------------------- */

/* Assemble K + times M in the memory of the model, not scaled. */
static pzs_status assemble_sum(pzs_modes *modes, pzs_real times)
{
    const pzs_status status = modes->state.call->assemble_stiffness(modes);
    if (status != PZS_OK)
        return status;
    if (times < 0 || times > 0)
        pzs_mass_add(modes->state.mass, modes->state.model, times);
    if (modes->state.call->fix_matrix)
        modes->state.call->fix_matrix(modes);
    return PZS_OK;
}

/*
 * Count the modes below a bound of the squared angular frequency, by the negative pivots of K -
 * bound M. Overwrites the factors. Returns -1 where a pivot is zero.
 */
static int32_t count_below(pzs_modes *modes, pzs_real bound)
{
    pzs_model *model = modes->state.model;
    if (assemble_sum(modes, -bound) != PZS_OK)
        return -1;
    pzs_linalg_apply_scale(&model->state.stiffness, model->state.scale);
    linalg_inertia inertia = pzs_linalg_factor(&model->state.stiffness);
    if (inertia.zero < 0 && modes->state.open_call)
        modes->state.open_call->count_open(modes, &inertia);
    return inertia.zero < 0 ? (int32_t)inertia.negative : -1;
}

/*
 * Scale and factor K + shift M at prescribed voltages, and estimate its condition number.
 * info.where is set where the matrix cannot be factored. inertia out  its pivots, of which none is
 * negative where no electrode is open
 */
static pzs_status factor_shifted(pzs_modes *modes, linalg_inertia *inertia)
{
    pzs_model *model = modes->state.model;
    pzs_envelope *matrix = &model->state.stiffness;
    const pzs_status status = assemble_sum(modes, modes->settings.shift);
    if (status != PZS_OK)
        return status;
    const bool keeps_scale = modes->state.call->keeps_scale;
    const int32_t loose = keeps_scale ? -1 : pzs_linalg_scale(matrix, model->state.scale);
    if (loose >= 0)
        return fail(modes, PZS_E_LOOSE, loose);
    if (keeps_scale)
        pzs_linalg_apply_scale(matrix, model->state.scale);
    const pzs_real norm = pzs_linalg_norm1(matrix, model->state.work);
    *inertia = pzs_linalg_factor(matrix);
    if (inertia->zero >= 0)
        return fail(modes, PZS_E_LOOSE, inertia->zero);
    if (inertia->negative > 0 && !modes->state.open_call)
        return fail(modes, PZS_E_NEGATIVE, inertia->first_negative);
    modes->info.condition = pzs_linalg_condition(matrix, norm, model->state.work);
    return number_is_finite(modes->info.condition) ? PZS_OK : fail(modes, PZS_E_CONDITION, -1);
}

/* ---- preparation -------------------------------------------------------- */

/* Return the power of two next below a positive number, or next above it if it is below 1. */
static pzs_real power_of_two_near(pzs_real number)
{
    pzs_real power = 1;
    for (int i = 0; i < 1000 && power <= number / 2; i++)
        power *= 2;
    for (int i = 0; i < 1000 && power > 2 * number; i++)
        power /= 2;
    return power;
}

/*
 * Find a degree of freedom without mass, or choose state.unit near the smallest ratio of the
 * diagonal entries of stiffness and mass matrix, an upper bound of the lowest squared angular
 * frequency plus the shift. The diagonal entries of the stiffness matrix follow, to a factor of
 * two, from the scale factors of its rows. Returns the degree of freedom, or -1.
 */
static int32_t choose_unit(pzs_modes *modes)
{
    const pzs_model *model = modes->state.model;
    const uint32_t n = model->state.structure->free_dof;
    pzs_real *diagonal = model->state.work, least = 0;
    pzs_mass_diagonal(modes->state.mass, model->state.structure, diagonal);
    for (uint32_t i = 0; i < n; i++) {
        const pzs_real scale = model->state.scale[i];
        if (model->state.constrained && model->state.constrained[i])
            continue;
        if (!(diagonal[i] > 0))
            return (int32_t)i;
        const pzs_real ratio = 1 / (scale * diagonal[i] * scale);
        least = least > 0 && least < ratio ? least : ratio;
    }
    modes->state.unit = power_of_two_near(least);
    return -1;
}

static bool settings_in_range(const pzs_modes *modes)
{
    const pzs_modes_settings *settings = &modes->settings;
    const uint32_t n = modes->state.model->state.structure->free_dof;
    return settings->shift >= 0 && number_is_finite(settings->shift) && settings->tolerance > 0 &&
           settings->tolerance < 1 &&
           (!settings->start || pzs_guard_nonfinite(settings->start, n) < 0);
}

/*
 * Prepare linear solves with open electrodes.
 *   inertia in  pivots of K + shift M at prescribed voltages
 */
static pzs_status prepare_electrodes(pzs_modes *modes, linalg_inertia *inertia)
{
    if (!modes->state.open_call)
        return PZS_OK;
    const pzs_status status = modes->state.open_call->prepare_open(modes, inertia);
    if (status != PZS_OK)
        return status;
    if (inertia->zero >= 0)
        return fail(modes, PZS_E_LOOSE, inertia->zero);
    return inertia->negative == 0 ? PZS_OK : fail(modes, PZS_E_NEGATIVE, inertia->first_negative);
}

/*
 * Provide the factors of K + shift M: those that the model holds if the shift is 0 and their
 * condition number is known, otherwise new ones.
 */
static pzs_status prepare(pzs_modes *modes, uint8_t kept_stage)
{
    pzs_model *model = modes->state.model;
    linalg_inertia inertia = {0, -1, -1, 0};
    pzs_status status = PZS_OK;
    if (!settings_in_range(modes))
        return PZS_E_ARGUMENT;
    if (!(modes->settings.shift > 0) && model->state.stage != kept_stage)
        return PZS_E_STAGE;
    if (modes->settings.shift > 0 || modes->state.call->keeps_scale)
        status = factor_shifted(modes, &inertia);
    else
        modes->info.condition = model->info.condition;
    if (status == PZS_OK)
        status = prepare_electrodes(modes, &inertia);
    if (status != PZS_OK)
        return status;
    const int32_t massless = choose_unit(modes);
    return massless < 0 ? PZS_OK : fail(modes, PZS_E_MASS, massless);
}

/* ---- search ------------------------------------------------------------- */

/*
 * Append start vectors: that of the settings alone, or a block of random ones, which leaves room
 * for a restart.
 */
static pzs_status append_start(pzs_modes *modes, const pzs_real *start)
{
    const uint32_t made = modes->state.made, number = modes->info.number;
    const uint32_t room = modes->state.vectors - (made > number ? made : number);
    const uint32_t wanted = modes->settings.shift > 0 ? BLOCK_LOOSE : BLOCK;
    const uint32_t block = wanted < room / 2 ? wanted : room / 2;
    pzs_status status = pzs_search_append(modes, start);
    for (uint32_t i = 1; i < block && !start && status == PZS_OK; i++)
        status = pzs_search_append(modes, NULL);
    return status;
}

/*
 * Whether rounding errors are too small to change the count of the modes below a bound.
 *   distance in  distance of the bound from the modes, relative to the bound plus the shift
 */
static bool count_is_reliable(const pzs_modes *modes, pzs_real distance)
{
    return PZS_EPSILON * modes->info.condition * pzs_search_range(modes) < distance;
}

/*
 * Count the modes below a bound into info.below, a second and third time with a lower bound where a
 * pivot is zero, and restore the factors of K + shift M.
 */
static pzs_status count_modes(pzs_modes *modes, pzs_real bound, pzs_real distance)
{
    linalg_inertia inertia;
    int32_t below = -1;
    for (int i = 0; i < 3 && below < 0; i++) {
        const pzs_real lower = distance * (pzs_real)i / 8;
        below = count_below(modes, bound - lower * (bound + modes->settings.shift));
        modes->info.counts++;
    }
    modes->info.below = (uint16_t)(below < 0 ? 0 : below);
    return factor_shifted(modes, &inertia);
}

/*
 * Go on with the converged modes and new random vectors, in which missing modes appear, until
 * `wanted` modes have converged.
 */
static pzs_status widen(pzs_modes *modes, uint32_t wanted)
{
    const uint32_t converged = modes->info.converged, most = (uint32_t)modes->state.vectors - 2u;
    pzs_search_restart(modes, converged < most ? converged : most, 0);
    const pzs_status status = append_start(modes, NULL);
    return status == PZS_OK ? pzs_search_converge(modes, wanted) : status;
}

/*
 * Check the converged modes where rounding errors forbid a count: go on with new random vectors
 * until one mode more has converged, and no mode among the wanted ones is new. Returns
 * PZS_W_MODE_COUNT, or an error.
 */
static pzs_status check_by_search(pzs_modes *modes)
{
    const pzs_real shift = modes->settings.shift;
    const uint32_t last = modes->info.number - 1u;
    for (int i = 0; i < CHECKS; i++) {
        const pzs_real before = pzs_search_square(modes, last) + shift;
        const pzs_status status = widen(modes, modes->info.converged + 1u);
        if (status != PZS_OK)
            return status;
        const pzs_real now = pzs_search_square(modes, last) + shift;
        if (now > before * (1 - 16 * modes->settings.tolerance))
            return PZS_W_MODE_COUNT;
    }
    return fail(modes, PZS_E_MODE_COUNT, -1);
}

/*
 * Number of modes that must converge after a count has shown that some are missing: new random
 * vectors have brought these, or at least one mode for each vector.
 */
static uint32_t more_modes(const pzs_modes *modes)
{
    const uint32_t more = modes->info.converged + (uint32_t)BLOCK;
    return modes->info.below < more ? modes->info.below : more;
}

/*
 * Find the modes, and go on with new random vectors as long as the count shows that some are
 * missing.
 */
static pzs_status search_and_count(pzs_modes *modes)
{
    pzs_status status = append_start(modes, modes->settings.start);
    if (status == PZS_OK)
        status = pzs_search_converge(modes, modes->info.number);
    for (int i = 0; i < CHECKS && status == PZS_OK; i++) {
        pzs_real distance;
        const pzs_real bound = pzs_search_bound(modes, &distance);
        const uint32_t found = pzs_search_found(modes);
        if (found == modes->state.model->state.structure->free_dof)
            return PZS_OK;
        if (!count_is_reliable(modes, distance))
            return check_by_search(modes);
        status = count_modes(modes, bound, distance);
        if (status != PZS_OK || modes->info.below == found)
            return status;
        if (modes->info.below < found)
            return fail(modes, PZS_E_MODE_COUNT, modes->info.below);
        status = widen(modes, more_modes(modes));
    }
    return status == PZS_OK ? fail(modes, PZS_E_MODE_COUNT, modes->info.below) : status;
}

/* ---- results ------------------------------------------------------------ */

/*
 * Return 1, or -1 where the largest mean displacement of a node in a mode shape is negative, the
 * first of those that are equal to rounding.
 */
static pzs_real leading_sign(const pzs_modes *modes, const pzs_real *shape)
{
    const pzs_model *model = modes->state.model;
    pzs_real leading = 0;
    for (uint32_t node = 0; node < model->state.structure->nodes; node++) {
        const uint16_t at = (uint16_t)node;
        pzs_real own[SHELL_MAX / SHELL_NODES];
        pzs_model_gather(model, &at, 1, shape, own);
        for (int axis = 0; axis < 3; axis++)
            if (PZS_ABS(own[axis]) > PZS_ABS(leading) * (1 + 16 * PZS_EPSILON))
                leading = own[axis];
    }
    return leading < 0 ? -1 : 1;
}

/* Scale a mode shape [free_dof] to unit modal mass and a positive largest displacement. */
static void normalise(const pzs_modes *modes, pzs_real *shape)
{
    const uint32_t n = modes->state.model->state.structure->free_dof;
    pzs_real *weighted = modes->state.model->state.work;
    pzs_search_multiply(modes, shape, weighted);
    const pzs_real norm =
        leading_sign(modes, shape) * PZS_SQRT(pzs_linalg_inner(shape, weighted, n));
    for (uint32_t k = 0; k < n; k++)
        shape[k] /= norm;
}

/*
 * Make the mode shapes and squared frequencies of the result from the Ritz vectors and from the
 * Ritz values, which pzs_search_restart leaves in state.square.
 */
static void take_modes(pzs_modes *modes)
{
    const uint32_t n = modes->state.model->state.structure->free_dof;
    pzs_search_restart(modes, modes->info.number, 0);
    if (modes->state.open_call)
        (void)modes->state.open_call->hold_open(modes);
    modes->info.rigid = 0;
    for (uint32_t i = 0; i < modes->info.number; i++) {
        pzs_real *shape = modes->state.basis + (size_t)i * n;
        normalise(modes, shape);
        const pzs_real ritz = modes->state.unit / modes->state.square[i] - modes->settings.shift,
                       square = modes->state.call->squared_frequency(modes, shape, ritz);
        const bool is_rigid = PZS_ABS(square) < rigid_below * modes->settings.shift;
        modes->state.square[i] = is_rigid ? 0 : square;
        modes->info.rigid = (uint16_t)(modes->info.rigid + is_rigid);
    }
}

pzs_status pzs_modes_run(pzs_modes *modes, const struct pzs_modes_calls *call, uint8_t kept_stage)
{
    pzs_model *model = modes->state.model;
    modes->state.call = call;
    modes->state.stage = MODES_READY;
    modes->info.where = -1;
    modes->info.below = 0;
    modes->info.counts = 0;
    pzs_search_begin(modes);
    const bool keeps_factors = !(modes->settings.shift > 0) && model->state.stage == kept_stage;
    pzs_status status = prepare(modes, kept_stage);
    if (status == PZS_OK)
        status = search_and_count(modes);
    model->state.stage = keeps_factors ? kept_stage : model->state.stage;
    if (status == PZS_E_MODES)
        modes->info.where = modes->info.converged;
    if (PZS_IS_ERROR(status))
        return status;
    modes->info.converged = (uint16_t)pzs_search_found(modes);
    take_modes(modes);
    modes->state.stage = MODES_FOUND;
    return status;
}

pzs_real pzs_modes_frequency(const pzs_modes *modes, uint16_t mode)
{
    const bool is_known = modes->state.stage == MODES_FOUND && mode < modes->info.number;
    const pzs_real square = is_known ? modes->info.square[mode] : 0;
    return square > 0 ? PZS_SQRT(square) / two_pi : 0;
}

pzs_status pzs_modes_response(const pzs_modes *modes, pzs_real *response)
{
    if (!modes || !response)
        return PZS_E_ARGUMENT;
    if (modes->state.stage != MODES_FOUND)
        return PZS_E_STAGE;
    const pzs_structure *structure = modes->state.model->state.structure;
    const uint32_t n = structure->free_dof;
    pzs_real *force = modes->state.model->state.work;
    for (uint32_t input = 0; input < structure->input.count; input++) {
        memset(force, 0, n * sizeof *force);
        modes->state.call->add_input_force(modes, input, force);
        for (uint32_t i = 0; i < modes->info.number; i++) {
            const pzs_real work = pzs_linalg_inner(modes->state.basis + (size_t)i * n, force, n);
            response[(size_t)i * structure->input.count + input] =
                i < modes->info.rigid ? (pzs_real)NAN : work / modes->state.square[i];
        }
    }
    for (uint32_t i = modes->info.rigid; i < modes->info.number && modes->state.open_call; i++)
        modes->state.open_call->respond_open(modes, response + (size_t)i * structure->input.count);
    return PZS_OK;
}

#endif
