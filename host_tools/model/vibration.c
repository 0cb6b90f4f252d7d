/* SPDX-License-Identifier: BSD-2-Clause */
/* Natural frequencies and mode shapes (vibration.h). */
#include "vibration.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include "eigen.h"
#include "../../lib/core/linalg.h"
#include "mass.h"
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"

/*
 * Number of starting vectors of a supported and of a loose structure, sweeps of Jacobi's method,
 * attempts of the check and of the shift.
 */
enum { BLOCK = 3, BLOCK_LOOSE = 6, SWEEPS = 30, CHECKS = 8, SHIFTS = 80 };

/* Relative residual of a Ritz pair at which its mode has converged. */
static const double converged_at = 1e-8;

/*
 * Error of squares of frequencies near 0 relative to the shift, and bound below which a mode is a
 * rigid motion.
 */
static const double known_to = 1e-6, rigid_below = 1e-8;

/* A structure whose stiffness has a larger condition is shifted like a loose one. */
static const double held_below = 1e10;

static const double two_pi = 6.283185307179586;

/*
 * Lanczos search. Column j of h holds the products of A q_j with the basis, A = (K + shift M)^-1 M,
 * for the first `done` vectors; the rows from `done` on measure how far the span of these is from
 * being invariant.
 */
typedef struct search {
    const design *d;
    mass mass;
    pzs_model model;
    void *work;
    uint8_t *held;  /* [free dof] dof with a prescribed displacement; here they are fixed at 0 */
    size_t n, room; /* number of free dof; number of basis vectors that the memory holds */
    double shift;
    double *basis; /* [room][n] orthonormal with respect to M */
    size_t made, done;
    double *h;           /* [room][room] column j begins at h + j room */
    double *w, *mw;      /* [n] work */
    double *ritz, *turn; /* [done][done] Ritz values on the diagonal, their vectors as columns */
    size_t *order;       /* [done] columns by decreasing Ritz value */
    uint64_t seed;
    int solves;
} search;

/* ---- matrices --------------------------------------------------------- */

/*
 * Factor K + times M with rows scaled by the diagonal of K. Returns the signs of the pivots, all
 * zero where K has a zero on its diagonal.
 */
static linalg_inertia factor(search *s, double times, int keep_scale)
{
    linalg_inertia failed = {0, -1, 0, 0};
    const mesh *mesh = s->mass.mesh;
    if (pzs_assemble(&s->model, NULL, s->held) != PZS_OK)
        return failed;
    if (!keep_scale) {
        if (pzs_linalg_scale(&s->model.state.stiffness, s->model.state.scale) >= 0)
            return failed;
        if (pzs_assemble(&s->model, NULL, s->held) != PZS_OK)
            return failed;
    }
    for (int e = 0; e < mesh->elements && times != 0; e++)
        pzs_model_add_matrix(&s->model, mesh->element[e], 4, times, mass_element(&s->mass, e));
    pzs_linalg_apply_scale(&s->model.state.stiffness, s->model.state.scale);
    const double norm = pzs_linalg_norm1(&s->model.state.stiffness, s->model.state.work);
    const linalg_inertia inertia = pzs_linalg_factor(&s->model.state.stiffness);
    if (inertia.zero < 0)
        s->model.info.condition =
            pzs_linalg_condition(&s->model.state.stiffness, norm, s->model.state.work);
    return inertia;
}

/* Number of squared frequencies below a bound, or -1 where K - bound M cannot be factored. */
static int count_below(search *s, double bound)
{
    const linalg_inertia inertia = factor(s, -bound, 1);
    return inertia.zero < 0 ? (int)inertia.negative : -1;
}

/*
 * Whether the pivots of K alone show, beyond rounding, that the supports prevent every rigid
 * motion.
 */
static int is_held(const search *s, const linalg_inertia *inertia)
{
    return inertia->zero < 0 && inertia->negative == 0 && s->model.info.condition < held_below;
}

/* Upper bound of the lowest squared frequencies: K_ii/M_ii of each dof. */
static double upper_bound(search *s)
{
    double least = HUGE_VAL;
    for (size_t i = 0; i < s->n; i++)
        s->w[i] = 1;
    if (pzs_assemble(&s->model, NULL, s->held) != PZS_OK)
        return least;
    for (size_t i = 0; i < s->n; i++)
        s->w[i] = *pzs_linalg_entry(&s->model.state.stiffness, (uint32_t)i, (uint32_t)i);
    pzs_linalg_clear(&s->model.state.stiffness);
    for (int e = 0; e < s->mass.mesh->elements; e++)
        pzs_model_add_matrix(&s->model, s->mass.mesh->element[e], 4, 1, mass_element(&s->mass, e));
    for (size_t i = 0; i < s->n; i++) {
        const double diagonal =
            *pzs_linalg_entry(&s->model.state.stiffness, (uint32_t)i, (uint32_t)i);
        if (diagonal > 0)
            least = fmin(least, s->w[i] / diagonal);
    }
    return least;
}

/*
 * Factor K, or for a loose structure K + shift M with a shift of about the highest required squared
 * frequency. Returns success.
 */
static int choose_shift(search *s, int number)
{
    linalg_inertia inertia = factor(s, 0, 0);
    if (is_held(s, &inertia))
        return 1;
    double bound = upper_bound(s);
    for (int i = 0; i < SHIFTS && isfinite(bound); i++) {
        const int below = count_below(s, bound);
        if (below >= 0 && below <= number + 6)
            break;
        bound /= 4;
    }
    s->shift = bound;
    inertia = factor(s, s->shift, 1);
    return isfinite(bound) && inertia.zero < 0 && inertia.negative == 0;
}

/* ---- basis ------------------------------------------------------------ */

/* Pseudo-random number in [-1, 1]; the sequence is the same in every run. */
static double draw(search *s)
{
    s->seed = s->seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(s->seed >> 11) / 4503599627370496.0 - 1;
}

static double dot(const double *x, const double *y, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += x[i] * y[i];
    return sum;
}

/*
 * Make w orthogonal to the basis, in two iterations, and append the rest unless it is rounding
 * error.
 *   column [room]  in/out  the products with the basis are added, the norm is appended; NULL: not
 *                          needed
 */
static void append(search *s, double *column)
{
    mass_multiply(&s->mass, &s->model, s->w, s->mw);
    const double before = sqrt(fmax(dot(s->w, s->mw, s->n), 0));
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < s->made; i++) {
            const double *q = s->basis + i * s->n;
            const double part = dot(q, s->mw, s->n);
            for (size_t k = 0; k < s->n; k++)
                s->w[k] -= part * q[k];
            if (column)
                column[i] += part;
        }
        mass_multiply(&s->mass, &s->model, s->w, s->mw);
    }
    const double norm = sqrt(fmax(dot(s->w, s->mw, s->n), 0));
    if (!(norm > 1e-10 * before) || s->made == s->room)
        return;
    for (size_t k = 0; k < s->n; k++)
        s->basis[s->made * s->n + k] = s->w[k] / norm;
    if (column)
        column[s->made] += norm;
    s->made++;
}

/* w = (K + shift M)^-1 M x */
static void apply(search *s, const double *x)
{
    mass_multiply(&s->mass, &s->model, x, s->mw);
    pzs_model_backsolve(&s->model, s->mw, s->w);
    s->solves++;
}

/* Append a random direction in which the lowest modes dominate. */
static void inject(search *s)
{
    double *x = s->basis + s->made * s->n; /* orthogonal to the basis */
    if (s->made == s->room)
        return;
    for (size_t k = 0; k < s->n; k++)
        x[k] = draw(s);
    apply(s, x);
    append(s, NULL);
}

/* Multiply one more basis vector by A. Returns whether there was one. */
static int advance(search *s)
{
    if (s->done == s->made)
        inject(s);
    if (s->done == s->made)
        return 0;
    apply(s, s->basis + s->done * s->n);
    append(s, s->h + s->done * s->room);
    s->done++;
    return 1;
}

/* ---- Ritz values ------------------------------------------------------ */

static double value(const search *s, size_t i)
{
    const size_t k = s->order[i];
    return s->ritz[k * s->done + k];
}

/* Square of the frequency of the i-th lowest Ritz pair. */
static double square_of(const search *s, size_t i)
{
    return 1 / value(s, i) - s->shift;
}

static void sort_values(search *s)
{
    for (size_t i = 0; i < s->done; i++) {
        size_t at = i;
        s->order[i] = i;
        while (at > 0 && value(s, at) > value(s, at - 1)) {
            const size_t swapped = s->order[at];
            s->order[at] = s->order[at - 1];
            s->order[at - 1] = swapped;
            at--;
        }
    }
}

static void find_ritz(search *s)
{
    const size_t n = s->done;
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            s->ritz[i * n + j] = (s->h[j * s->room + i] + s->h[i * s->room + j]) / 2;
            largest = fmax(largest, fabs(s->ritz[i * n + j]));
        }
    eigen_symmetric(s->ritz, s->turn, n, SWEEPS, PZS_EPSILON * PZS_EPSILON * largest);
    sort_values(s);
}

/* Norm of A x - theta x of the i-th Ritz pair, relative to theta. */
static double residual(const search *s, size_t i)
{
    double sum = 0;
    for (size_t r = s->done; r < s->made; r++) {
        double row = 0;
        for (size_t j = 0; j < s->done; j++)
            row += s->h[j * s->room + r] * s->turn[j * s->done + s->order[i]];
        sum += row * row;
    }
    return sqrt(sum) / value(s, i);
}

/* Whether the first `number` Ritz pairs have converged. */
static int have_converged(const search *s, size_t number)
{
    if (s->done < number)
        return 0;
    for (size_t i = 0; i < number; i++)
        if (!(value(s, i) > 0) || !(residual(s, i) < converged_at))
            return 0;
    return 1;
}

/*
 * Number of modes to check: those required, and those whose frequencies cannot be distinguished
 * from the last one.
 */
static size_t cluster_end(const search *s, size_t number)
{
    const double last = square_of(s, number - 1);
    const double limit = fmax(last * (1 + 1e-5), known_to * s->shift);
    size_t end = number;
    while (end < s->done && value(s, end) > 0 && square_of(s, end) < limit)
        end++;
    return end;
}

/*
 * Extend the basis until the lowest modes have converged. Returns their number, at least `number`,
 * or 0.
 */
static size_t iterate(search *s, size_t number)
{
    size_t next = s->done + 2 * BLOCK;
    if (next < number + 2 * BLOCK)
        next = number + 2 * BLOCK;
    for (;;) {
        int is_whole = 0;
        while (s->done < next && !is_whole)
            is_whole = !advance(s);
        find_ritz(s);
        const size_t end = s->done < number ? number : cluster_end(s, number);
        if (have_converged(s, end))
            return end;
        if (is_whole)
            return 0;
        next = s->done + s->done / 4 + BLOCK;
    }
}

/* ---- check ------------------------------------------------------------ */

/* Bound above the last computed mode and, where the next mode is known, below that one. */
static double bound_above(const search *s, size_t found)
{
    const double last = square_of(s, found - 1),
                 beyond = fmax(last, known_to * s->shift) * (1 + 1e-3);
    if (found == s->done || !(value(s, found) > 0))
        return beyond;
    return fmin(beyond, (last + square_of(s, found)) / 2);
}

/*
 * Number of modes below the bound by the pivots of K - bound M, or -1 where it is unknown; the
 * factor for linear solves is restored afterwards.
 */
static int modes_below(search *s, double bound)
{
    int below = -1;
    for (int i = 0; i < 3 && below < 0; i++)
        below = count_below(s, bound * (1 - 1e-7 * i));
    const linalg_inertia again = factor(s, s->shift, 1);
    return again.zero < 0 ? below : -1;
}

/*
 * Find the lowest modes, and continue in new directions as long as the pivots show that more exist.
 * Returns success.
 */
static int find_modes(search *s, size_t number, char *error)
{
    const scene *of = s->d->scene;
    int below = 0;
    size_t found = 0;
    for (int i = 0; i < CHECKS; i++) {
        found = iterate(s, number);
        if (found == 0)
            return scene_fault(of, of->at_surface, error,
                               "the lowest %zu modes have not converged in %zu vectors; ask for "
                               "fewer",
                               number, s->done);
        below = found < s->n ? modes_below(s, bound_above(s, found)) : (int)found;
        if (below == (int)found)
            return 0;
        for (int k = 0; k < BLOCK; k++)
            inject(s);
    }
    return scene_fault(of, of->at_surface, error,
                       "%d modes lie below %.6g Hz, but %zu were found; ask for more or fewer",
                       below, sqrt(fmax(bound_above(s, found), 0)) / two_pi, found);
}

/* ---- results ---------------------------------------------------------- */

/*
 * Largest displacement of the middle surface over the nodes, with the sign of its largest
 * component.
 */
static double largest_displacement(const search *s, const double *x, double *sign)
{
    const mesh *mesh = s->mass.mesh;
    double largest = 0, leading = 0;
    for (int node = 0; node < mesh->nodes; node++) {
        const uint16_t at = (uint16_t)node;
        double u[7], sum = 0;
        pzs_model_gather(&s->model, &at, 1, x, u);
        for (int a = 0; a < 3; a++) {
            sum += u[a] * u[a];
            if (fabs(u[a]) > fabs(leading) * (1 + 1e-6))
                leading = u[a];
        }
        largest = fmax(largest, sqrt(sum));
    }
    *sign = leading < 0 ? -1 : 1;
    return largest;
}

static void take_shape(search *s, size_t i, double *x)
{
    double sign;
    memset(x, 0, s->n * sizeof *x);
    for (size_t j = 0; j < s->done; j++) {
        const double part = s->turn[j * s->done + s->order[i]];
        for (size_t k = 0; k < s->n; k++)
            x[k] += part * s->basis[j * s->n + k];
    }
    largest_displacement(s, x, &sign);
    for (size_t k = 0; k < s->n; k++)
        x[k] *= sign;
}

/* x' K x formed from strains, so that a rigid motion has none even to second order of rounding. */
static double energy(const search *s, const double *x)
{
    const mesh *mesh = s->mass.mesh;
    double sum = 0;
    for (int e = 0; e < mesh->elements; e++) {
        double u[SHELL_MAX], f[SHELL_MAX];
        pzs_model_gather(&s->model, mesh->element[e], SHELL_NODES, x, u);
        pzs_shell_force(&mesh->type[mesh->element_type[e]], mesh->dof_per_node, u, f);
        sum += dot(u, f, SHELL_NODES * (size_t)mesh->dof_per_node);
    }
    return sum;
}

static void take_modes(search *s, vibration *vibration)
{
    for (int i = 0; i < vibration->count; i++) {
        double *x = vibration->shape + (size_t)i * s->n, sign;
        take_shape(s, (size_t)i, x);
        const double square = energy(s, x);
        const int is_rigid = s->shift > 0 && square < rigid_below * s->shift;
        vibration->rigid += is_rigid;
        vibration->square[i] = is_rigid ? 0 : square;
        vibration->frequency[i] = sqrt(vibration->square[i]) / two_pi;
        vibration->largest[i] = largest_displacement(s, x, &sign);
    }
    vibration->solves = s->solves;
}

/* Effective modal masses: (x' M r)^2 of unit rigid translations r. */
static void take_masses(search *s, vibration *vibration)
{
    const double still[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; axis++) {
        double shift[3] = {0, 0, 0};
        shift[axis] = 1;
        vibration->mass = mass_rigid(&s->mass, &s->model, shift, still, s->mw);
        for (int i = 0; i < vibration->count; i++) {
            const double part = dot(vibration->shape + (size_t)i * s->n, s->mw, s->n);
            vibration->effective[i][axis] = part * part;
        }
    }
}

static int allocate_results(vibration *vibration, size_t count, size_t n)
{
    vibration->count = (int)count;
    vibration->frequency = calloc(count, sizeof *vibration->frequency);
    vibration->square = calloc(count, sizeof *vibration->square);
    vibration->largest = calloc(count, sizeof *vibration->largest);
    vibration->shape = calloc(count * n, sizeof *vibration->shape);
    vibration->effective = calloc(count, sizeof *vibration->effective);
    return vibration->frequency && vibration->square && vibration->largest && vibration->shape &&
           vibration->effective;
}

/* ---- memory and result ------------------------------------------------- */

static int allocate_search(search *s, size_t number)
{
    const pzs_structure *structure = &s->d->structure;
    const mesh *mesh = &s->d->mesh;
    const size_t bytes = PZS_MODEL_BYTES(
        structure->free_dof, pzs_linalg_reals(structure->first_column, structure->free_dof));
    s->n = structure->free_dof;
    s->room = 6 * number + 60 < s->n ? 6 * number + 60 : s->n;
    s->seed = 1;
    s->work = malloc(bytes);
    s->held = calloc(s->n, sizeof *s->held);
    s->basis = malloc(s->room * s->n * sizeof *s->basis);
    s->h = calloc(s->room * s->room, sizeof *s->h);
    s->ritz = malloc(s->room * s->room * sizeof *s->ritz);
    s->turn = malloc(s->room * s->room * sizeof *s->turn);
    s->order = malloc(s->room * sizeof *s->order);
    s->w = malloc(s->n * sizeof *s->w);
    s->mw = malloc(s->n * sizeof *s->mw);
    if (!s->work || !s->held || !s->basis || !s->h || !s->ritz || !s->turn || !s->order || !s->w ||
        !s->mw)
        return 0;
    for (int i = 0; i < mesh->prescribed_count; i++)
        s->held[mesh->prescribed_dof[i]] = 1;
    return pzs_model_init(&s->model, structure, s->work, bytes) == PZS_OK;
}

static void free_search(search *s)
{
    mass_free(&s->mass);
    free(s->work);
    free(s->held);
    free(s->basis);
    free(s->h);
    free(s->ritz);
    free(s->turn);
    free(s->order);
    free(s->w);
    free(s->mw);
}

static int run(search *s, vibration *vibration, size_t number, char *error)
{
    const scene *of = s->d->scene;
    if (!choose_shift(s, (int)number))
        return scene_fault(of, of->at_surface, error,
                           "the stiffness cannot be factored, not even with mass added: a dof "
                           "has neither");
    const int block = s->shift > 0 ? BLOCK_LOOSE : BLOCK;
    for (int i = 0; i < block; i++)
        inject(s);
    if (find_modes(s, number, error) < 0)
        return -1;
    if (!allocate_results(vibration, number, s->n))
        return scene_fault(of, of->at_surface, error, "%zu modes do not fit into memory", number);
    take_modes(s, vibration);
    take_masses(s, vibration);
    return 0;
}

int vibration_solve(vibration *vibration, const design *design, int number, double lumped,
                    char *error)
{
    search s;
    memset(vibration, 0, sizeof *vibration);
    memset(&s, 0, sizeof s);
    s.d = design;
    if (design->mesh.elements == 0)
        return scene_fault(design->scene, design->scene->influence.at, error,
                           "natural frequencies need a structure, and this scene has none: a "
                           "measured influence matrix tells nothing of mass");
    const int most = design->mesh.free_dof - design->mesh.prescribed_count;
    const int wanted = number < most ? number : most;
    if (mass_build(&s.mass, &design->mesh, lumped, error) < 0)
        return -1;
    int failed = -1;
    if (wanted < 1)
        scene_fault(design->scene, design->scene->at_surface, error,
                    "%d modes of %d free dof; ask for at least 1", number, most);
    else if (!allocate_search(&s, (size_t)wanted))
        scene_fault(design->scene, design->scene->line[0].at, error,
                    "%d modes of %d free dof do not fit into memory", wanted, most);
    else
        failed = run(&s, vibration, (size_t)wanted, error);
    free_search(&s);
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
    free(vibration->effective);
    memset(vibration, 0, sizeof *vibration);
}

int vibration_first(const vibration *vibration)
{
    return vibration->rigid;
}

double vibration_static(const vibration *vibration, const design *design, int mode, int input)
{
    const pzs_rows *in = &design->structure.input;
    const double *x = vibration->shape + (size_t)mode * (size_t)design->mesh.free_dof;
    double sum = 0;
    for (uint32_t t = in->start[input]; t < in->start[input + 1]; t++)
        sum += in->value[t] * x[in->dof[t]];
    return mode < vibration->rigid ? (double)NAN : sum / vibration->square[mode];
}
