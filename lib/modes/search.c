/* SPDX-License-Identifier: BSD-2-Clause */
/* Lanczos search for the lowest vibration modes, with thick restarts (search.h). */
#include "search.h"
#include <string.h>
#include "../core/guard.h"
#include "eigen.h"
#include "element_mass.h"
#include "orthogonal.h"

#if PZS_MODES

enum { SWEEPS = 30 }; /* Largest number of sweeps of Jacobi's method. */

/*
 * A new basis vector counts as dependent on the basis if orthogonalisation leaves at most this part
 * of it.
 */
static const pzs_real dependent = PZS_BY_BITS((pzs_real)1e-5, (pzs_real)1e-10);

/* Modes whose squared frequencies differ by at most this part a count cannot distinguish. */
static const pzs_real same = PZS_BY_BITS((pzs_real)1e-3, (pzs_real)1e-5);

/* Distance of the bound above the last mode, relative to its squared frequency plus the shift. */
static const pzs_real beyond = PZS_BY_BITS((pzs_real)5e-2, (pzs_real)1e-3);

static uint32_t free_dof(const pzs_modes *modes)
{
    return modes->state.model->state.structure->free_dof;
}

static pzs_real *basis_vector(const pzs_modes *modes, uint32_t i)
{
    return modes->state.basis + (size_t)i * free_dof(modes);
}

/* Column j of the projection, which has an entry for each basis vector. */
static pzs_real *column(const pzs_modes *modes, uint32_t j)
{
    return modes->state.projection + (size_t)j * modes->state.vectors;
}

/*
 * The vector that is to become the next basis vector, and its product with the mass matrix: the
 * sixth and the first vector of the work array of the model, which holds displacement and force of
 * a linear solve.
 */
static pzs_real *next_vector(const pzs_modes *modes)
{
    return modes->state.model->state.work + 5 * (size_t)free_dof(modes);
}

static pzs_real *weighted_vector(const pzs_modes *modes)
{
    return modes->state.model->state.work;
}

/* ---- basis -------------------------------------------------------------- */

void pzs_search_multiply(const pzs_modes *modes, const pzs_real *vector, pzs_real *product)
{
    memset(product, 0, free_dof(modes) * sizeof *product);
    pzs_mass_add_product(modes->state.mass, modes->state.model, 1, vector, product);
    if (modes->state.call->fix_product)
        modes->state.call->fix_product(modes, product);
}

void pzs_search_begin(pzs_modes *modes)
{
    const size_t vectors = modes->state.vectors;
    memset(modes->state.projection, 0, vectors * vectors * sizeof *modes->state.projection);
    modes->state.made = 0;
    modes->state.done = 0;
    modes->state.seed = 1;
    modes->info.linear_solves = 0;
    modes->info.converged = 0;
}

/*
 * Pseudo-random number in [-1, 1) of 24 bits; the sequence is the same in every search and in both
 * precisions.
 */
static pzs_real random_number(pzs_modes *modes)
{
    modes->state.seed = modes->state.seed * 1664525u + 1013904223u;
    return (pzs_real)(modes->state.seed >> 8) / 8388608 - 1;
}

/* Norm of next_vector in the scalar product with the mass matrix. */
static pzs_real mass_norm(const pzs_modes *modes)
{
    const pzs_real sum =
        pzs_linalg_inner(next_vector(modes), weighted_vector(modes), free_dof(modes));
    return sum > 0 ? PZS_SQRT(sum) : 0;
}

/* Solve as pzs_modes_calls.solve_force, with the open electrodes. */
static pzs_status solve(pzs_modes *modes)
{
    if (modes->state.open_call)
        return modes->state.open_call->solve_open(modes);
    return modes->state.call->solve_force(modes);
}

/*
 * Apply A to a vector [free_dof]. The result becomes next_vector, and its product with the mass
 * matrix weighted_vector.
 */
static pzs_status apply(pzs_modes *modes, const pzs_real *vector)
{
    const uint32_t n = free_dof(modes);
    pzs_real *next = next_vector(modes);
    if (modes->info.linear_solves >= modes->settings.solve_limit)
        return PZS_E_MODES;
    pzs_search_multiply(modes, vector, weighted_vector(modes));
    modes->info.linear_solves++;
    const pzs_status status = solve(modes);
    if (status != PZS_OK)
        return status;
    for (uint32_t i = 0; i < n; i++)
        next[i] *= modes->state.unit;
    pzs_search_multiply(modes, next, weighted_vector(modes));
    return pzs_guard_nonfinite(next, n) < 0 ? PZS_OK : PZS_E_NONFINITE;
}

/*
 * Make next_vector orthogonal to the basis by two Gram-Schmidt iterations, and append the
 * normalised remainder unless it is a rounding error or the basis is full.
 *   part [vectors] in/out  the coefficients of next_vector in the basis are added; NULL: not needed
 */
static void append_next(pzs_modes *modes, pzs_real *part)
{
    const uint32_t n = free_dof(modes), made = modes->state.made;
    pzs_real *next = next_vector(modes);
    const pzs_real before = mass_norm(modes);
    pzs_orthogonalise(modes->state.basis, made, n, weighted_vector(modes), next, part);
    pzs_search_multiply(modes, next, weighted_vector(modes));
    pzs_orthogonalise(modes->state.basis, made, n, weighted_vector(modes), next, part);
    /*
     * weighted_vector belongs to next_vector before the second iteration. What this iteration has
     * subtracted is orthogonal to the remainder, so the product is still its squared norm.
     */
    const pzs_real norm = mass_norm(modes);
    if (!(norm > dependent * before) || made == modes->state.vectors)
        return;
    for (uint32_t k = 0; k < n; k++)
        basis_vector(modes, made)[k] = next[k] / norm;
    if (part)
        part[made] += norm;
    modes->state.made++;
}

pzs_status pzs_search_append(pzs_modes *modes, const pzs_real *start)
{
    if (modes->state.made == modes->state.vectors)
        return PZS_OK;
    pzs_real *vector = basis_vector(modes, modes->state.made);
    for (uint32_t k = 0; k < free_dof(modes); k++)
        vector[k] = start ? start[k] : random_number(modes);
    const pzs_status status = apply(modes, vector);
    if (status == PZS_OK)
        append_next(modes, NULL);
    return status;
}

/* Whether the next basis vector has no room, although the basis is not the whole space. */
static bool is_full(const pzs_modes *modes)
{
    return modes->state.made == modes->state.vectors && modes->state.vectors < free_dof(modes);
}

/*
 * Apply A to the next basis vector, a random one where none is left, unless the result would have
 * no room. The products of the result with the basis become a column of the projection, its part
 * orthogonal to the basis a new basis vector. *is_whole becomes true where no basis vector exists.
 */
static pzs_status extend(pzs_modes *modes, bool *is_whole)
{
    pzs_status status = PZS_OK;
    if (modes->state.done == modes->state.made)
        status = pzs_search_append(modes, NULL);
    *is_whole = modes->state.done == modes->state.made;
    if (status != PZS_OK || *is_whole || is_full(modes))
        return status;
    status = apply(modes, basis_vector(modes, modes->state.done));
    if (status != PZS_OK)
        return status;
    append_next(modes, column(modes, modes->state.done));
    modes->state.done++;
    return PZS_OK;
}

/* ---- Ritz values -------------------------------------------------------- */

static pzs_real ritz_value(const pzs_modes *modes, uint32_t i)
{
    const size_t k = modes->state.order[i];
    return modes->state.ritz[k * modes->state.done + k];
}

static void sort_values(pzs_modes *modes)
{
    uint16_t *order = modes->state.order;
    for (uint32_t i = 0; i < modes->state.done; i++) {
        uint32_t at = i;
        order[i] = (uint16_t)i;
        while (at > 0 && ritz_value(modes, at) > ritz_value(modes, at - 1)) {
            const uint16_t swapped = order[at];
            order[at] = order[at - 1];
            order[at - 1] = swapped;
            at--;
        }
    }
}

/*
 * Compute Ritz values and vectors. The entry (i, j) of the projection with i <= j is taken from
 * column j, which was orthogonalised against all basis vectors before it.
 */
static void find_ritz(pzs_modes *modes)
{
    const uint32_t count = modes->state.done;
    pzs_real largest = 0;
    for (uint32_t j = 0; j < count; j++)
        for (uint32_t i = 0; i <= j; i++) {
            const pzs_real entry = column(modes, j)[i], size = PZS_ABS(entry);
            modes->state.ritz[(size_t)i * count + j] = entry;
            modes->state.ritz[(size_t)j * count + i] = entry;
            largest = size > largest ? size : largest;
        }
    pzs_eigen_symmetric(modes->state.ritz, modes->state.turn, count, SWEEPS,
                        PZS_EPSILON * PZS_EPSILON * largest);
    sort_values(modes);
}

pzs_real pzs_search_square(const pzs_modes *modes, uint32_t i)
{
    return modes->state.unit / ritz_value(modes, i) - modes->settings.shift;
}

/*
 * Component of A times Ritz vector i along basis vector `row`, to which A has not been applied:
 * part of the residual of the Ritz pair.
 */
static pzs_real remainder_part(const pzs_modes *modes, uint32_t row, uint32_t i)
{
    const uint32_t count = modes->state.done;
    pzs_real sum = 0;
    for (uint32_t j = 0; j < count; j++)
        sum += column(modes, j)[row] * modes->state.turn[(size_t)j * count + modes->state.order[i]];
    return sum;
}

/* Whether Ritz pair i has a positive value and a residual within the tolerance. */
static bool has_converged(const pzs_modes *modes, uint32_t i)
{
    const pzs_real limit = modes->settings.tolerance * ritz_value(modes, i);
    pzs_real sum = 0;
    for (uint32_t row = modes->state.done; row < modes->state.made; row++) {
        const pzs_real part = remainder_part(modes, row, i);
        sum += part * part;
    }
    return limit > 0 && sum <= limit * limit;
}

/*
 * Number of modes that must converge: the wanted ones, and further ones whose frequencies cannot be
 * distinguished from that of the last wanted mode.
 */
static uint32_t cluster_end(const pzs_modes *modes, uint32_t wanted)
{
    uint32_t end = wanted;
    const pzs_real least = ritz_value(modes, end - 1) / (1 + same);
    while (end < modes->state.done && ritz_value(modes, end) > 0 && ritz_value(modes, end) > least)
        end++;
    return end;
}

/* Count the converged modes into info.converged. Returns whether all that must have converged. */
static bool all_converged(pzs_modes *modes, uint32_t wanted)
{
    const uint32_t done = modes->state.done;
    const uint32_t end = done < wanted ? wanted : cluster_end(modes, wanted);
    uint32_t count = 0;
    while (count < end && count < done && has_converged(modes, count))
        count++;
    modes->info.converged = (uint16_t)count;
    return count == end;
}

/* ---- restart ------------------------------------------------------------ */

/*
 * Replace the first basis vectors by the first `keep` Ritz vectors, degree of freedom by degree of
 * freedom in place.
 */
static void turn_basis(pzs_modes *modes, uint32_t keep)
{
    const uint32_t count = modes->state.done;
    for (uint32_t k = 0; k < free_dof(modes); k++) {
        for (uint32_t i = 0; i < keep; i++) {
            const pzs_real *turn = modes->state.turn + modes->state.order[i];
            modes->state.row[i] = 0;
            for (uint32_t j = 0; j < count; j++)
                modes->state.row[i] += turn[(size_t)j * count] * basis_vector(modes, j)[k];
        }
        for (uint32_t i = 0; i < keep; i++)
            basis_vector(modes, i)[k] = modes->state.row[i];
    }
}

/*
 * Write the projection onto the kept Ritz vectors: their values on the diagonal, and below them
 * their components along the kept remainders. The Ritz values are in state.square, the components
 * of Ritz vector i in row i of state.ritz.
 */
static void write_projection(pzs_modes *modes, uint32_t keep, uint32_t remainders)
{
    const size_t vectors = modes->state.vectors;
    memset(modes->state.projection, 0, vectors * vectors * sizeof *modes->state.projection);
    for (uint32_t i = 0; i < keep; i++) {
        column(modes, i)[i] = modes->state.square[i];
        memcpy(column(modes, i) + keep, modes->state.ritz + i * vectors,
               remainders * sizeof *modes->state.ritz);
    }
}

void pzs_search_restart(pzs_modes *modes, uint32_t keep, uint32_t remainders)
{
    const uint32_t done = modes->state.done;
    for (uint32_t i = 0; i < keep; i++)
        modes->state.square[i] = ritz_value(modes, i);
    for (uint32_t i = 0; i < keep; i++)
        for (uint32_t row = 0; row < remainders; row++)
            modes->state.ritz[(size_t)i * modes->state.vectors + row] =
                remainder_part(modes, done + row, i);
    turn_basis(modes, keep);
    memmove(basis_vector(modes, keep), basis_vector(modes, done),
            (size_t)remainders * free_dof(modes) * sizeof *modes->state.basis);
    write_projection(modes, keep, remainders);
    modes->state.done = (uint16_t)keep;
    modes->state.made = (uint16_t)(keep + remainders);
}

/*
 * Restart with the lowest Ritz vectors where the basis is full: the wanted ones and half of the
 * others, but so few that there is room for a new vector.
 */
static void restart_full(pzs_modes *modes, uint32_t wanted)
{
    const uint32_t done = modes->state.done, remainders = (uint32_t)modes->state.made - done;
    uint32_t keep = wanted < done ? wanted + (done - wanted) / 2 : done;
    while (keep + remainders + 1u > modes->state.vectors && keep > 1)
        keep--;
    pzs_search_restart(modes, keep, remainders);
}

/* ---- convergence -------------------------------------------------------- */

pzs_status pzs_search_converge(pzs_modes *modes, uint32_t wanted)
{
    bool is_whole = false;
    for (;;) {
        const uint32_t done = modes->state.done, least = wanted + 4u,
                       quarter = done + done / 4 + 2u, target = quarter > least ? quarter : least;
        while (modes->state.done < target && !is_whole && !is_full(modes)) {
            const pzs_status status = extend(modes, &is_whole);
            if (status != PZS_OK)
                return status;
        }
        find_ritz(modes);
        if (all_converged(modes, wanted))
            return PZS_OK;
        if (is_whole)
            return PZS_E_MODES;
        if (is_full(modes))
            restart_full(modes, wanted);
    }
}

uint32_t pzs_search_found(const pzs_modes *modes)
{
    return cluster_end(modes, modes->info.number);
}

pzs_real pzs_search_bound(const pzs_modes *modes, pzs_real *distance)
{
    const uint32_t end = pzs_search_found(modes);
    const pzs_real last = modes->state.unit / ritz_value(modes, end - 1);
    pzs_real bound = last * (1 + beyond);
    if (end < modes->state.done && ritz_value(modes, end) > 0) {
        const pzs_real middle = (last + modes->state.unit / ritz_value(modes, end)) / 2;
        bound = middle < bound ? middle : bound;
    }
    *distance = (bound - last) / bound;
    return bound - modes->settings.shift;
}

pzs_real pzs_search_range(const pzs_modes *modes)
{
    return ritz_value(modes, pzs_search_found(modes) - 1u) / ritz_value(modes, 0);
}

#endif
