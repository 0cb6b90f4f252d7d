/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Natural frequencies and mode shapes by a band Lanczos method (vibration.h). In the comments of
 * this file K is the stiffness matrix, M the mass matrix and A = (K + shift M)^-1 M the operator of
 * the method.
 */
#include "vibration.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/modes/eigen.h"
#include "../../lib/modes/open_matrix.h"
#include "../../lib/modes/orthogonal.h"
#include "../../lib/core/linalg.h"
#include "mass.h"
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"
#include "../mesh/springs.h"

/*
 * Constants of the Lanczos method:
 *   BLOCK        number of starting vectors for a supported structure
 *   BLOCK_LOOSE  number of starting vectors for a structure that can move as a rigid body
 *   SWEEPS       sweeps of Jacobi's method
 *   CHECKS       largest number of checks for missing vibration modes
 *   SHIFTS       largest number of trial shifts
 */
enum { BLOCK = 3, BLOCK_LOOSE = 6, SWEEPS = 30, CHECKS = 8, SHIFTS = 80 };

/*
 * Largest number of vectors to which the operator of the Lanczos method is applied at once. The
 * factors of the stiffness matrix are then read from memory only once for all these vectors.
 */
enum { BATCH = BLOCK_LOOSE };

/* Relative residual of a Ritz pair at which its vibration mode counts as converged. */
static const double converged_at = 1e-8;

/*
 * Two bounds for squared frequencies near 0, as fractions of the shift of the Lanczos method.
 * known_to: error of a computed squared frequency; rigid_below: size below which a vibration mode
 * counts as a rigid motion.
 */
static const double known_to = 1e-6, rigid_below = 1e-8;

/*
 * Condition number of the stiffness matrix above which the Lanczos method uses a positive shift, as
 * for a structure that can move as a rigid body.
 */
static const double held_below = 1e10;

static const double two_pi = 6.283185307179586;

/*
 * State of the Lanczos search for the lowest vibration modes with the operator A = (K + shift M)^-1
 * M (stiffness K, mass M), applied to `done` basis vectors so far. Entry (i, j) of the projection
 * is the M-product of basis vector i and A times vector j; entries with i >= done are the residual.
 */
typedef struct search {
    const design *design;
    mass mass;
    pzs_model model;
    void *work;
    const linearised *about; /* tangent stiffness matrix and forces at the equilibrium about which
                                the structure vibrates; NULL: the reference state */
    open_electrodes open; /* open electrodes, which stiffen the structure; in the comments of this
                             file K includes their stiffness */
    uint8_t *held; /* [free_dof] flags of dof with a prescribed displacement, which are fixed at 0
                      for vibration */
    size_t free_dof, room; /* number of free dof, and number of vectors of the Lanczos basis for
                              which there is memory */
    double shift;
    double *basis; /* [room][free_dof] vectors of the Lanczos basis, orthonormal with the mass
                      matrix, with memory for `room` vectors */
    size_t made, done;
    double *projection; /* [room][room] projection of the Lanczos operator (K + shift M)^-1 M, with
                           stiffness matrix K and mass matrix M, onto the basis; column j begins at
                           projection + j room */
    double *image, *mass_image; /* [BATCH][free_dof] image: products of the Lanczos operator with
                                   the basis vectors from number image_begin to image_end;
                                   mass_image: products of the mass matrix with the vectors in image
                                 */
    size_t image_begin, image_end;
    double *next;      /* [free_dof] work vector: the next vector of the Lanczos basis */
    double *mass_next; /* [free_dof] work vector: product of the mass matrix and the next vector of
                          the Lanczos basis */
    double *ritz, *turn; /* ritz [done][done]: Ritz values (approximate eigenvalues) on the
                            diagonal; turn [done][done]: eigenvectors of the operator projected onto
                            the `done` vectors of the Lanczos basis, as columns */
    size_t *order; /* [done] indices of the Ritz pairs (approximate eigenvalues with eigenvectors,
                      `done` in number) by decreasing Ritz value */
    uint64_t seed;
    int solves;
} search;

/* ---- matrices --------------------------------------------------------- */

/*
 * Assemble the stiffness matrix for the Lanczos search: that of the reference state, or the tangent
 * stiffness at the equilibrium about which the structure vibrates. Returns whether this has
 * succeeded.
 */
static bool assemble(search *search)
{
    if (pzs_assemble(&search->model, NULL, search->held) != PZS_OK)
        return false;
    if (search->about)
        memcpy(search->model.state.stiffness.value, search->about->tangent,
               search->about->entries * sizeof(double));
    return true;
}

/*
 * Prepare linear solves with the open electrodes for the factors that the model holds.
 *   inertia in/out  pivots of the matrix at prescribed voltages; out: of that with open electrodes
 */
static void add_open_electrodes(search *search, linalg_inertia *inertia)
{
    if (inertia->zero >= 0)
        return;
    open_electrodes_factor(&search->open, &search->model.state.stiffness, search->model.state.scale,
                           inertia);
    search->solves += search->open.matrix.count;
}

/*
 * Factor the matrix K + c M, with the stiffness matrix K, the mass matrix M and the factor c
 * (argument `times`). The rows are scaled by the diagonal of K. Returns the numbers of positive and
 * negative pivots, all zero where K has a zero on its diagonal.
 */
static linalg_inertia factor(search *search, double times, int keep_scale)
{
    linalg_inertia failed = {0, -1, 0, 0};
    const mesh *mesh = search->mass.mesh;
    if (!assemble(search))
        return failed;
    if (!keep_scale) {
        if (pzs_linalg_scale(&search->model.state.stiffness, search->model.state.scale) >= 0)
            return failed;
        if (!assemble(search))
            return failed;
    }
    for (int element = 0; element < mesh->elements && times != 0; element++)
        pzs_model_add_matrix(&search->model, mesh->element[element], 4, times,
                             mass_element(&search->mass, element));
    pzs_linalg_apply_scale(&search->model.state.stiffness, search->model.state.scale);
    const double norm = pzs_linalg_norm1(&search->model.state.stiffness, search->model.state.work);
    linalg_inertia inertia = pzs_linalg_factor(&search->model.state.stiffness);
    if (inertia.zero < 0)
        search->model.info.condition =
            pzs_linalg_condition(&search->model.state.stiffness, norm, search->model.state.work);
    add_open_electrodes(search, &inertia);
    return inertia;
}

/*
 * Number of squared angular frequencies below a bound, from the negative pivots of stiffness matrix
 * - bound * mass matrix, or -1 where this matrix cannot be factored.
 */
static int count_below(search *search, double bound)
{
    const linalg_inertia inertia = factor(search, -bound, 1);
    return inertia.zero < 0 ? (int)inertia.negative : -1;
}

/*
 * Whether the pivots of the stiffness matrix show, beyond rounding errors, that the supports
 * prevent every rigid motion.
 */
static int has_supports(const search *search, const linalg_inertia *inertia)
{
    return inertia->zero < 0 && inertia->negative == 0 && search->model.info.condition < held_below;
}

/*
 * Upper bound of the lowest squared angular frequency: the smallest ratio of the diagonal entries
 * of stiffness and mass matrix.
 */
static double upper_bound(search *search)
{
    double least = HUGE_VAL;
    for (size_t i = 0; i < search->free_dof; i++)
        search->next[i] = 1;
    if (!assemble(search))
        return least;
    for (size_t i = 0; i < search->free_dof; i++)
        search->next[i] =
            *pzs_linalg_entry(&search->model.state.stiffness, (uint32_t)i, (uint32_t)i);
    pzs_linalg_clear(&search->model.state.stiffness);
    for (int element = 0; element < search->mass.mesh->elements; element++)
        pzs_model_add_matrix(&search->model, search->mass.mesh->element[element], 4, 1,
                             mass_element(&search->mass, element));
    for (size_t i = 0; i < search->free_dof; i++) {
        const double diagonal =
            *pzs_linalg_entry(&search->model.state.stiffness, (uint32_t)i, (uint32_t)i);
        if (diagonal > 0)
            least = fmin(least, search->next[i] / diagonal);
    }
    return least;
}

/*
 * Factor the stiffness matrix, or for a structure that can move as a rigid body stiffness matrix +
 * shift * mass matrix, with a shift of about the highest required squared angular frequency.
 * Returns whether this has succeeded.
 */
static int choose_shift(search *search, int number)
{
    linalg_inertia inertia = factor(search, 0, 0);
    if (has_supports(search, &inertia))
        return 1;
    double bound = upper_bound(search);
    for (int i = 0; i < SHIFTS && isfinite(bound); i++) {
        const int below = count_below(search, bound);
        if (below >= 0 && below <= number + 6)
            break;
        bound /= 4;
    }
    search->shift = bound;
    inertia = factor(search, search->shift, 1);
    return isfinite(bound) && inertia.zero < 0 && inertia.negative == 0;
}

/* ---- basis ------------------------------------------------------------ */

/* Pseudo-random number in [-1, 1]; the sequence is the same in every run. */
static double random_number(search *search)
{
    search->seed = search->seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(search->seed >> 11) / 4503599627370496.0 - 1;
}

/*
 * Make search->next orthogonal to the Lanczos basis by two Gram-Schmidt iterations, and append the
 * normalised remainder unless it is a rounding error. search->mass_next must hold the mass matrix
 * times `next`.
 *   column [room] in/out  vector to which the coefficients of `next` in the basis are added; NULL:
 *       not needed
 */
static void append(search *search, double *column)
{
    const uint32_t free_dof = (uint32_t)search->free_dof;
    const double before =
        sqrt(fmax(pzs_linalg_inner(search->next, search->mass_next, free_dof), 0));
    for (int pass = 0; pass < 2; pass++) {
        if (pass > 0)
            mass_multiply(&search->mass, &search->model, search->next, 1, search->mass_next);
        pzs_orthogonalise(search->basis, (uint32_t)search->made, free_dof, search->mass_next,
                          search->next, column);
    }
    /*
     * search->mass_next was computed before the last components along the basis were subtracted
     * from search->next. These components are orthogonal to the new `next` in the mass matrix. So
     * the product of both vectors is still the squared norm of `next`.
     */
    const double norm = sqrt(fmax(pzs_linalg_inner(search->next, search->mass_next, free_dof), 0));
    if (!(norm > 1e-10 * before) || search->made == search->room)
        return;
    for (size_t k = 0; k < search->free_dof; k++)
        search->basis[search->made * search->free_dof + k] = search->next[k] / norm;
    if (column)
        column[search->made] += norm;
    search->made++;
}

/*
 * Apply the operator (K + shift M)^-1 M of the Lanczos method to `count` successive vectors, at
 * most BATCH, and multiply the results by the mass matrix M. K is the stiffness matrix.
 *   vector [count][free_dof] in   vectors
 * The results are left in the arrays image and mass_image of the search.
 */
static void apply(search *search, const double *vector, size_t count)
{
    const pzs_envelope *factor = &search->model.state.stiffness;
    const double *scale = search->model.state.scale;
    mass_multiply(&search->mass, &search->model, vector, count, search->image);
    for (size_t i = 0; i < count * search->free_dof; i++)
        search->image[i] *= scale[i % search->free_dof];
    pzs_linalg_solve_many(factor, search->image, (uint32_t)count, search->free_dof);
    for (size_t i = 0; i < count * search->free_dof; i++)
        search->image[i] *= scale[i % search->free_dof];
    open_electrodes_correct(&search->open, search->image, count);
    mass_multiply(&search->mass, &search->model, search->image, count, search->mass_image);
    search->image_begin = search->image_end = 0;
    search->solves += (int)count;
}

/*
 * Copy row `index` of the array image (Lanczos operator times a basis vector) to the work vector
 * `next`. Copy the same row of mass_image (mass matrix times that vector) to `mass_next`.
 */
static void take_image(search *search, size_t index)
{
    const size_t bytes = search->free_dof * sizeof *search->next;
    memcpy(search->next, search->image + index * search->free_dof, bytes);
    memcpy(search->mass_next, search->mass_image + index * search->free_dof, bytes);
}

/*
 * Append a random vector, in which the lowest vibration modes dominate, behind the last vector of
 * the Lanczos basis.
 */
static void append_random(search *search)
{
    double *vector = search->basis + search->made * search->free_dof;
    if (search->made == search->room)
        return;
    for (size_t k = 0; k < search->free_dof; k++)
        vector[k] = random_number(search);
    apply(search, vector, 1);
    take_image(search, 0);
    append(search, NULL);
}

/*
 * Apply the Lanczos operator (inverse of the shifted stiffness matrix, times the mass matrix) to
 * the basis vectors to which it has not been applied yet, at most BATCH of them.
 */
static void apply_to_waiting(search *search)
{
    const size_t waiting = search->made - search->done, count = waiting < BATCH ? waiting : BATCH;
    apply(search, search->basis + search->done * search->free_dof, count);
    search->image_begin = search->done;
    search->image_end = search->done + count;
}

/*
 * One step of the Lanczos method: apply the operator to the next basis vector. Products of the
 * result with the basis become a column of the projection, its part orthogonal to the basis a new
 * basis vector. Returns 0 where no basis vector is left, otherwise 1.
 */
static int extend_basis(search *search)
{
    if (search->done == search->made)
        append_random(search);
    if (search->done == search->made)
        return 0;
    if (search->done < search->image_begin || search->done >= search->image_end)
        apply_to_waiting(search);
    take_image(search, search->done - search->image_begin);
    append(search, search->projection + search->done * search->room);
    search->done++;
    return 1;
}

/* ---- Ritz values ------------------------------------------------------ */

static double ritz_value(const search *search, size_t i)
{
    const size_t k = search->order[i];
    return search->ritz[k * search->done + k];
}

/*
 * Squared angular frequency of the i-th lowest Ritz pair (approximate eigenvalue and eigenvector).
 */
static double square_of(const search *search, size_t i)
{
    return 1 / ritz_value(search, i) - search->shift;
}

static void sort_values(search *search)
{
    for (size_t i = 0; i < search->done; i++) {
        size_t at = i;
        search->order[i] = i;
        while (at > 0 && ritz_value(search, at) > ritz_value(search, at - 1)) {
            const size_t swapped = search->order[at];
            search->order[at] = search->order[at - 1];
            search->order[at - 1] = swapped;
            at--;
        }
    }
}

static void find_ritz(search *search)
{
    const size_t count = search->done;
    double largest = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++) {
            search->ritz[i * count + j] = (search->projection[j * search->room + i] +
                                           search->projection[i * search->room + j]) /
                                          2;
            largest = fmax(largest, fabs(search->ritz[i * count + j]));
        }
    pzs_eigen_symmetric(search->ritz, search->turn, count, SWEEPS,
                        PZS_EPSILON * PZS_EPSILON * largest);
    sort_values(search);
}

/*
 * Residual norm of the i-th Ritz pair (approximate eigenvalue and eigenvector) relative to its Ritz
 * value.
 */
static double residual(const search *search, size_t i)
{
    double sum = 0;
    for (size_t index = search->done; index < search->made; index++) {
        double row = 0;
        for (size_t j = 0; j < search->done; j++)
            row += search->projection[j * search->room + index] *
                   search->turn[j * search->done + search->order[i]];
        sum += row * row;
    }
    return sqrt(sum) / ritz_value(search, i);
}

/*
 * Whether the first `number` Ritz pairs (approximate eigenvalues and eigenvectors) have converged.
 */
static int have_converged(const search *search, size_t number)
{
    if (search->done < number)
        return 0;
    for (size_t i = 0; i < number; i++)
        if (!(ritz_value(search, i) > 0) || !(residual(search, i) < converged_at))
            return 0;
    return 1;
}

/*
 * Number of vibration modes whose convergence is checked: the requested modes, and further ones
 * whose frequencies cannot be distinguished from that of the last requested mode.
 */
static size_t cluster_end(const search *search, size_t number)
{
    const double last = square_of(search, number - 1);
    const double limit = fmax(last * (1 + 1e-5), known_to * search->shift);
    size_t end = number;
    while (end < search->done && ritz_value(search, end) > 0 && square_of(search, end) < limit)
        end++;
    return end;
}

/*
 * Extend the Lanczos basis until the lowest vibration modes have converged. Returns the number of
 * converged modes, which is at least `number`, or 0 on failure.
 */
static size_t iterate(search *search, size_t number)
{
    size_t next = search->done + 2 * BLOCK;
    if (next < number + 2 * BLOCK)
        next = number + 2 * BLOCK;
    for (;;) {
        int is_whole = 0;
        while (search->done < next && !is_whole)
            is_whole = !extend_basis(search);
        find_ritz(search);
        const size_t end = search->done < number ? number : cluster_end(search, number);
        if (have_converged(search, end))
            return end;
        if (is_whole)
            return 0;
        next = search->done + search->done / 4 + BLOCK;
    }
}

/* ---- check ------------------------------------------------------------ */

/*
 * Bound for the squared angular frequencies that lies above the last computed vibration mode and,
 * where the next mode is known, below the next mode.
 */
static double bound_above(const search *search, size_t found)
{
    const double last = square_of(search, found - 1),
                 beyond = fmax(last, known_to * search->shift) * (1 + 1e-3);
    if (found == search->done || !(ritz_value(search, found) > 0))
        return beyond;
    return fmin(beyond, (last + square_of(search, found)) / 2);
}

/*
 * Number of vibration modes below a bound of the squared angular frequency, from the pivots of
 * stiffness matrix - bound * mass matrix, or -1 where it is unknown. The factor for linear solves
 * is restored afterwards.
 */
static int modes_below(search *search, double bound)
{
    int below = -1;
    for (int i = 0; i < 3 && below < 0; i++)
        below = count_below(search, bound * (1 - 1e-7 * i));
    const linalg_inertia again = factor(search, search->shift, 1);
    return again.zero < 0 ? below : -1;
}

/*
 * Find the lowest vibration modes, and continue with new random vectors of the Lanczos method as
 * long as the pivots of the shifted stiffness matrix show that more modes exist. Returns whether
 * this has succeeded.
 */
static int find_modes(search *search, size_t number, char *error)
{
    int below = 0;
    size_t found = 0;
    for (int i = 0; i < CHECKS; i++) {
        found = iterate(search, number);
        if (found == 0)
            return scene_fault(search->design->at, error,
                               "the lowest %zu modes have not converged in %zu vectors; ask for "
                               "fewer",
                               number, search->done);
        below =
            found < search->free_dof ? modes_below(search, bound_above(search, found)) : (int)found;
        if (below == (int)found)
            return 0;
        for (int k = 0; k < BLOCK; k++)
            append_random(search);
    }
    return scene_fault(search->design->at, error,
                       "%d modes lie below %.6g Hz, but %zu were found; ask for more or fewer",
                       below, sqrt(fmax(bound_above(search, found), 0)) / two_pi, found);
}

/* ---- results ---------------------------------------------------------- */

/*
 * Largest displacement of the middle surface over all nodes.
 *   vector [free_dof] in  displacement vector
 *   sign              out  sign of the largest component of this displacement
 */
static double largest_displacement(const search *search, const double *vector, double *sign)
{
    const mesh *mesh = search->mass.mesh;
    double largest = 0, leading = 0;
    for (int node = 0; node < mesh->nodes; node++) {
        const uint16_t at = (uint16_t)node;
        double unknown[7], sum = 0;
        pzs_model_gather(&search->model, &at, 1, vector, unknown);
        for (int axis = 0; axis < 3; axis++) {
            sum += unknown[axis] * unknown[axis];
            if (fabs(unknown[axis]) > fabs(leading) * (1 + 1e-6))
                leading = unknown[axis];
        }
        largest = fmax(largest, sqrt(sum));
    }
    *sign = leading < 0 ? -1 : 1;
    return largest;
}

static void take_shape(search *search, size_t i, double *vector)
{
    double sign;
    memset(vector, 0, search->free_dof * sizeof *vector);
    for (size_t j = 0; j < search->done; j++) {
        const double part = search->turn[j * search->done + search->order[i]];
        for (size_t k = 0; k < search->free_dof; k++)
            vector[k] += part * search->basis[j * search->free_dof + k];
    }
    largest_displacement(search, vector, &sign);
    for (size_t k = 0; k < search->free_dof; k++)
        vector[k] *= sign;
}

/*
 * Twice the strain and electric energy of a displacement vector, from the strains of the elements,
 * the elongations of the springs and the voltages of the open electrodes. Unlike u'K u, this sum
 * has almost no rounding errors for a rigid motion. vector [free_dof] in  displacement vector u
 */
static double energy(const search *search, const double *vector)
{
    const mesh *mesh = search->mass.mesh;
    double sum = 0;
    for (int element = 0; element < mesh->elements; element++) {
        double local[SHELL_MAX];
        pzs_model_gather(&search->model, mesh->element[element], SHELL_NODES, vector, local);
        sum +=
            pzs_shell_energy(&mesh->type[mesh->element_type[element]], mesh->dof_per_node, local);
    }
    for (int row = 0; row < mesh->springs.count; row++) {
        const double elongation = springs_elongation(&mesh->springs, row, vector);
        sum += mesh->springs.stiffness[row] * elongation * elongation;
    }
    return sum + open_electrodes_energy(&search->open, vector);
}

static void take_modes(search *search, vibration *vibration)
{
    for (int i = 0; i < vibration->count; i++) {
        double *vector = vibration->shape + (size_t)i * search->free_dof, sign;
        take_shape(search, (size_t)i, vector);
        const double square = search->about ? square_of(search, (size_t)i) : energy(search, vector);
        const int is_rigid = search->shift > 0 && square < rigid_below * search->shift;
        vibration->rigid += is_rigid;
        vibration->square[i] = is_rigid ? 0 : square;
        vibration->frequency[i] = sqrt(vibration->square[i]) / two_pi;
        vibration->largest[i] = largest_displacement(search, vector, &sign);
    }
    vibration->solves = search->solves;
}

/*
 * Compute the effective modal masses: squared products of each mode shape with the mass matrix and
 * the unit rigid translations along x, y and z.
 */
static void take_masses(search *search, vibration *vibration)
{
    const double still[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; axis++) {
        double shift[3] = {0, 0, 0};
        shift[axis] = 1;
        vibration->mass =
            mass_rigid(&search->mass, &search->model, shift, still, search->mass_next);
        for (int i = 0; i < vibration->count; i++) {
            const double part = pzs_linalg_inner(vibration->shape + (size_t)i * search->free_dof,
                                                 search->mass_next, (uint32_t)search->free_dof);
            vibration->effective[i][axis] = part * part;
        }
    }
}

/* Compute the static value of each modal coordinate under a unit of each input. */
static void take_responses(const search *search, vibration *vibration)
{
    const uint32_t inputs = search->design->structure.input.count;
    for (int mode = 0; mode < vibration->count; mode++) {
        const double *vector = vibration->shape + (size_t)mode * search->free_dof;
        double *response = vibration->response + (size_t)mode * inputs;
        for (uint32_t input = 0; input < inputs; input++)
            response[input] = linearised_work(search->about, search->design, input, vector) /
                              (mode < vibration->rigid ? (double)NAN : vibration->square[mode]);
        if (search->open.matrix.count > 0)
            pzs_open_matrix_respond(&search->open.matrix, response);
    }
}

bool vibration_allocate(vibration *vibration, const design *design, size_t count)
{
    const size_t dof = (size_t)design->mesh.free_dof, inputs = design->structure.input.count;
    memset(vibration, 0, sizeof *vibration);
    vibration->count = (int)count;
    vibration->frequency = calloc(count, sizeof *vibration->frequency);
    vibration->square = calloc(count, sizeof *vibration->square);
    vibration->largest = calloc(count, sizeof *vibration->largest);
    vibration->shape = calloc(count * dof, sizeof *vibration->shape);
    vibration->response = calloc(count * inputs + 1, sizeof *vibration->response);
    vibration->effective = calloc(count, sizeof *vibration->effective);
    return vibration->frequency && vibration->square && vibration->largest && vibration->shape &&
           vibration->response && vibration->effective;
}

bool vibration_copy(vibration *to, const vibration *from, const design *design)
{
    const size_t count = (size_t)from->count, dof = (size_t)design->mesh.free_dof,
                 inputs = design->structure.input.count;
    if (!vibration_allocate(to, design, count)) {
        vibration_free(to);
        return false;
    }
    to->rigid = from->rigid;
    to->solves = from->solves;
    to->mass = from->mass;
    to->open = from->open;
    to->bare = from->bare;
    memcpy(to->frequency, from->frequency, count * sizeof *to->frequency);
    memcpy(to->square, from->square, count * sizeof *to->square);
    memcpy(to->largest, from->largest, count * sizeof *to->largest);
    memcpy(to->shape, from->shape, count * dof * sizeof *to->shape);
    memcpy(to->response, from->response, count * inputs * sizeof *to->response);
    memcpy(to->effective, from->effective, count * sizeof *to->effective);
    return true;
}

/* ---- memory and result ------------------------------------------------- */

static int allocate_search(search *search, size_t number)
{
    const pzs_structure *structure = &search->design->structure;
    const mesh *mesh = &search->design->mesh;
    const size_t bytes = PZS_MODEL_BYTES(
        structure->free_dof, pzs_linalg_reals(structure->first_column, structure->free_dof));
    search->free_dof = structure->free_dof;
    search->room = 6 * number + 60 < search->free_dof ? 6 * number + 60 : search->free_dof;
    search->seed = 1;
    search->work = malloc(bytes);
    search->held = calloc(search->free_dof, sizeof *search->held);
    search->basis = malloc(search->room * search->free_dof * sizeof *search->basis);
    search->projection = calloc(search->room * search->room, sizeof *search->projection);
    search->ritz = malloc(search->room * search->room * sizeof *search->ritz);
    search->turn = malloc(search->room * search->room * sizeof *search->turn);
    search->order = malloc(search->room * sizeof *search->order);
    search->image = malloc(BATCH * search->free_dof * sizeof *search->image);
    search->mass_image = malloc(BATCH * search->free_dof * sizeof *search->mass_image);
    search->next = malloc(search->free_dof * sizeof *search->next);
    search->mass_next = malloc(search->free_dof * sizeof *search->mass_next);
    if (!search->work || !search->held || !search->basis || !search->projection || !search->ritz ||
        !search->turn || !search->order || !search->image || !search->mass_image || !search->next ||
        !search->mass_next)
        return 0;
    for (int i = 0; i < mesh->prescribed_count; i++)
        search->held[mesh->prescribed_dof[i]] = 1;
    return pzs_model_init(&search->model, structure, search->work, bytes) == PZS_OK;
}

static void free_search(search *search)
{
    mass_free(&search->mass);
    open_electrodes_free(&search->open);
    free(search->work);
    free(search->held);
    free(search->basis);
    free(search->projection);
    free(search->ritz);
    free(search->turn);
    free(search->order);
    free(search->image);
    free(search->mass_image);
    free(search->next);
    free(search->mass_next);
}

static int search_modes(search *search, vibration *vibration, size_t number, char *error)
{
    if (!choose_shift(search, (int)number))
        return scene_fault(search->design->at, error,
                           "the stiffness cannot be factored, not even with mass added: a dof "
                           "has neither");
    const int block = search->shift > 0 ? BLOCK_LOOSE : BLOCK;
    for (int i = 0; i < block; i++)
        append_random(search);
    if (find_modes(search, number, error) < 0)
        return -1;
    if (!vibration_allocate(vibration, search->design, number))
        return scene_fault(search->design->at, error, "%zu modes do not fit into memory", number);
    take_modes(search, vibration);
    take_masses(search, vibration);
    take_responses(search, vibration);
    vibration->open = search->open.matrix.count;
    vibration->bare = (int)search->open.bare;
    return 0;
}

int vibration_most(const design *design)
{
    return design->mesh.elements == 0 ? design->measured.modes
                                      : design->mesh.free_dof - design->mesh.prescribed_count;
}

/*
 * Compute the lowest vibration modes about the reference state (about NULL) or about a
 * nonlinear equilibrium. Returns 0, or -1 with error filled and the result empty.
 */
static int solve_structure(vibration *vibration, const design *design, const linearised *about,
                           electrode_circuit circuit, int number, double lumped, char *error)
{
    search search;
    memset(&search, 0, sizeof search);
    search.design = design;
    search.about = about;
    const int most = vibration_most(design), wanted = number < most ? number : most;
    int failed = -1;
    if (wanted < 1)
        scene_fault(design->at, error, "%d modes of %d free dof; ask for at least 1", number, most);
    else if (mass_build(&search.mass, design, lumped, error) == 0 &&
             open_electrodes_build(&search.open, design, about, circuit, error) == 0)
        failed = allocate_search(&search, (size_t)wanted)
                     ? search_modes(&search, vibration, (size_t)wanted, error)
                     : scene_fault(design->mesh.line[0].at, error,
                                   "%d modes of %d free dof do not fit into memory", wanted, most);
    free_search(&search);
    return failed;
}

int vibration_solve(vibration *vibration, const design *design, int number, double lumped,
                    char *error)
{
    return vibration_solve_at(vibration, design, NULL, CIRCUIT_SCENE, number, lumped, error);
}

int vibration_solve_at(vibration *vibration, const design *design, const linearised *about,
                       electrode_circuit circuit, int number, double lumped, char *error)
{
    const int most = vibration_most(design);
    memset(vibration, 0, sizeof *vibration);
    const size_t taken = (size_t)(number < most ? number : most);
    const int failed =
        design->mesh.elements == 0
            ? vibration_take_measured(vibration, design, taken, error)
            : solve_structure(vibration, design, about, circuit, number, lumped, error);
    if (failed)
        vibration_free(vibration);
    return failed;
}

void vibration_free(vibration *vibration)
{
    free(vibration->frequency);
    free(vibration->square);
    free(vibration->largest);
    free(vibration->shape);
    free(vibration->response);
    free(vibration->effective);
    memset(vibration, 0, sizeof *vibration);
}

int vibration_first(const vibration *vibration)
{
    return vibration->rigid;
}

double vibration_static(const vibration *vibration, const design *design, int mode, int input)
{
    return vibration->response[(size_t)mode * design->structure.input.count + (size_t)input];
}
