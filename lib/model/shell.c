/* SPDX-License-Identifier: BSD-2-Clause */
/* The GEX7P4 element: undeformed state and resultants at a displacement (shell.h). */
#include "shell.h"
#include "shell_corner.h"
#include "shell_skew.h"
#include <string.h>

/*
 * Base vectors at a corner, deformed by the displacement so far, to which strains refer. In the
 * undeformed state they are g_mean, g_diff, e3 and 0, directly from the tables.
 */
typedef struct shape {
    const pzs_real (*mean)[3];
    const pzs_real (*diff)[3];
    const pzs_real *beta;
    pzs_real q;
} shape;

static const pzs_real e3[3] = {0, 0, 1};

static pzs_real dot(const pzs_real a[3], const pzs_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* y += M x, M [3][3] */
static void add_product(pzs_real y[3], const pzs_real m[3][3], const pzs_real x[3])
{
    for (int i = 0; i < 3; i++)
        y[i] += m[i][0] * x[0] + m[i][1] * x[1] + m[i][2] * x[2];
}

/* y += M' x, M [3][3] */
static void add_transposed(pzs_real y[3], const pzs_real m[3][3], const pzs_real x[3])
{
    for (int j = 0; j < 3; j++)
        y[j] += m[0][j] * x[0] + m[1][j] * x[1] + m[2][j] * x[2];
}

/* y += factor x */
static void add_scaled(pzs_real y[3], pzs_real factor, const pzs_real x[3])
{
    for (int i = 0; i < 3; i++)
        y[i] += factor * x[i];
}

static shape undeformed_shape(const pzs_element_type *type, int r)
{
    const shape s = {type->g_mean[r], type->g_diff[r], e3, 0};
    return s;
}

/*
 * Derivatives of a displacement at corner r:  lam_a = S_a u_r + T_a u_r', for the mean and the
 * difference of the faces.
 */
static shell_corner corner_derivatives(const pzs_element_type *type, unsigned dof_per_node,
                                       const pzs_real *u, int r)
{
    shell_corner c;
    const pzs_real *own = u + (unsigned)r * dof_per_node;
    memset(&c, 0, sizeof c);
    for (int a = 0; a < 2; a++) {
        const pzs_real *other = u + neighbour[r][a] * dof_per_node;
        add_product(c.mean[a], type->s[r][a], own);
        add_product(c.mean[a], type->t[r][a], other);
        add_product(c.diff[a], type->s[r][a], own + 3);
        add_product(c.diff[a], type->t[r][a], other + 3);
    }
    memcpy(c.beta, own + 3, sizeof c.beta);
    c.q = dof_per_node == 7 ? own[6] : 0;
    return c;
}

/*
 * Transpose of corner_derivatives: add the forces c on the derivatives at corner r to the nodal
 * forces f.
 */
static void corner_scatter(const pzs_element_type *type, unsigned dof_per_node,
                           const shell_corner *force, int r, pzs_real *f)
{
    pzs_real *own = f + (unsigned)r * dof_per_node;
    for (int a = 0; a < 2; a++) {
        pzs_real *other = f + neighbour[r][a] * dof_per_node;
        add_transposed(own, type->s[r][a], force->mean[a]);
        add_transposed(other, type->t[r][a], force->mean[a]);
        add_transposed(own + 3, type->s[r][a], force->diff[a]);
        add_transposed(other + 3, type->t[r][a], force->diff[a]);
    }
    add_scaled(own + 3, 1, force->beta);
    if (dof_per_node == 7)
        own[6] += force->q;
}

/*
 * First variation of the ten strains at a corner with base vectors s, in the direction d. From e_aa
 * = g.lam + lam.lam/2 follows de = (g + lam).dlam on each face. Written in means and differences of
 * the faces, no terms cancel.
 */
static void corner_strains(const shape *base, const shell_corner *change, pzs_real h,
                           pzs_real e[10])
{
    const pzs_real hh4 = h * h / 4;
    for (int a = 0; a < 2; a++) {
        e[2 * a] = dot(base->mean[a], change->mean[a]) + hh4 * dot(base->diff[a], change->diff[a]);
        e[2 * a + 1] =
            h * (dot(base->mean[a], change->diff[a]) + dot(base->diff[a], change->mean[a]));
        e[E13 + a] = dot(base->mean[a], change->beta) + dot(base->beta, change->mean[a]) -
                     2 * h * (base->diff[a][2] * change->q + base->q * change->diff[a][2]);
    }
    e[E33M] = dot(base->beta, change->beta) + 16 * base->q * change->q;
    e[E33D] = -8 * (base->beta[2] * change->q + base->q * change->beta[2]);
    e[E12M] = dot(base->mean[0], change->mean[1]) + dot(base->mean[1], change->mean[0]) +
              hh4 * (dot(base->diff[0], change->diff[1]) + dot(base->diff[1], change->diff[0]));
    e[E12D] = h * (dot(base->mean[0], change->diff[1]) + dot(base->diff[0], change->mean[1]) +
                   dot(base->mean[1], change->diff[0]) + dot(base->diff[1], change->mean[0]));
}

/* Transpose of corner_strains: forces f on the derivatives from the stresses t. */
static void corner_stresses(const shape *base, const pzs_real t[10], pzs_real h,
                            shell_corner *force)
{
    const pzs_real hh4 = h * h / 4;
    memset(force, 0, sizeof *force);
    for (int a = 0; a < 2; a++) {
        const pzs_real m = t[2 * a], d = h * t[2 * a + 1], q = t[E13 + a];
        add_scaled(force->mean[a], m, base->mean[a]);
        add_scaled(force->mean[a], d, base->diff[a]);
        add_scaled(force->mean[a], q, base->beta);
        add_scaled(force->mean[a], t[E12M], base->mean[1 - a]);
        add_scaled(force->mean[a], h * t[E12D], base->diff[1 - a]);
        add_scaled(force->diff[a], hh4 * m, base->diff[a]);
        add_scaled(force->diff[a], d, base->mean[a]);
        add_scaled(force->diff[a], hh4 * t[E12M], base->diff[1 - a]);
        add_scaled(force->diff[a], h * t[E12D], base->mean[1 - a]);
        force->diff[a][2] -= 2 * h * q * base->q;
        add_scaled(force->beta, q, base->mean[a]);
        force->q -= 2 * h * q * base->diff[a][2];
    }
    add_scaled(force->beta, t[E33M], base->beta);
    force->beta[2] -= 8 * t[E33D] * base->q;
    force->q += 16 * t[E33M] * base->q - 8 * t[E33D] * base->beta[2];
}

/* Add the strains e of corner r to the modes:  e^m = 1/4 sum_r sign e_r. */
static void add_modes(pzs_real modes[4][10], const pzs_real e[10], int r)
{
    for (int m = 0; m < SHELL_MODES; m++)
        for (int i = 0; i < SHELL_STRAINS; i++)
            modes[m][i] += (pzs_real)0.25 * mode_sign[m][r] * e[i];
}

/* Stresses t at corner r from the resultants of the modes, the transpose of add_modes. */
static void stresses_of_modes(pzs_real h[4][10], int r, pzs_real t[10])
{
    for (int i = 0; i < SHELL_STRAINS; i++) {
        t[i] = 0;
        for (int m = 0; m < SHELL_MODES; m++)
            t[i] += (pzs_real)0.25 * mode_sign[m][r] * h[m][i];
    }
}

/*
 * Strains that each mode keeps. Mode 00: all; 01: those of 11, 33 and 13; 10: those of 22, 33 and
 * 23; 11: those of 33.
 */
static const uint8_t kept_strains[4] = {10, 5, 5, 2};
static const uint8_t kept_strain[4][10] = {
    {E11M, E11D, E22M, E22D, E33M, E33D, E12M, E12D, E13, E23},
    {E11M, E11D, E33M, E33D, E13},
    {E22M, E22D, E33M, E33D, E23},
    {E33M, E33D},
};

/* Replace the strains of one mode by its resultants D e.  d: packed lower triangle of 10 rows */
static void multiply_mode(const pzs_real *d, int mode, pzs_real e[10])
{
    pzs_real h[10] = {0};
    for (int i = 0; i < kept_strains[mode]; i++) {
        const int row = kept_strain[mode][i];
        const pzs_real *entry = d + row * (row + 1) / 2;
        for (int j = 0; j < i; j++) {
            const int column = kept_strain[mode][j];
            h[row] += entry[column] * e[column];
            h[column] += entry[column] * e[row];
        }
        h[row] += entry[row] * e[row];
    }
    memcpy(e, h, sizeof h);
}

/*
 * Add the warp to the mean strain 12 of mode 00: a fixed combination of other strains
 * (pzs_element_type).
 */
static void add_warp(const pzs_element_type *type, pzs_real e[4][10])
{
    const pzs_real *w = type->warp;
    e[0][E12M] += w[0] * e[0][E12D] + w[1] * e[1][E13] + w[2] * e[2][E23] + w[3] * e[0][E13] +
                  w[4] * e[0][E23] + w[5] * e[0][E11D] + w[6] * e[1][E11D] + w[7] * e[0][E22D] +
                  w[8] * e[2][E22D];
}

/* Transpose of add_warp: add the part of the mean resultant 12 to the other resultants. */
static void distribute_warp(const pzs_element_type *type, pzs_real h[4][10])
{
    const pzs_real *w = type->warp, mean = h[0][E12M];
    h[0][E12D] += w[0] * mean;
    h[1][E13] += w[1] * mean;
    h[2][E23] += w[2] * mean;
    h[0][E13] += w[3] * mean;
    h[0][E23] += w[4] * mean;
    h[0][E11D] += w[5] * mean;
    h[1][E11D] += w[6] * mean;
    h[0][E22D] += w[7] * mean;
    h[2][E22D] += w[8] * mean;
}

/* Turn the strains of the plain modes into those that the resultants belong to. */
static void correct_modes(const pzs_element_type *type, pzs_real e[4][10])
{
    add_warp(type, e);
    if (shell_is_skewed(type))
        pzs_shell_skew_strains(type->skew, e);
}

/* Transpose of correct_modes: resultants of the plain modes. */
static void distribute_modes(const pzs_element_type *type, pzs_real h[4][10])
{
    if (shell_is_skewed(type))
        pzs_shell_skew_resultants(type->skew, h);
    distribute_warp(type, h);
}

/* Replace the corrected strains of all modes by their resultants. distribute_modes must follow. */
static void multiply_modes(const pzs_element_type *type, pzs_real e[4][10])
{
    for (int m = 0; m < SHELL_MODES; m++)
        multiply_mode(type->d[m], m, e[m]);
}

/* Strains of each mode in the undeformed state, linear in u. */
static void small_strains(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                          pzs_real modes[4][10])
{
    memset(modes, 0, sizeof(pzs_real[4][10]));
    for (int r = 0; r < SHELL_NODES; r++) {
        const shape rest = undeformed_shape(type, r);
        const shell_corner d = corner_derivatives(type, dof_per_node, u, r);
        pzs_real e[10];
        corner_strains(&rest, &d, type->thickness, e);
        add_modes(modes, e, r);
    }
    correct_modes(type, modes);
}

/* f = sum of L' h in the undeformed state */
static void small_force(const pzs_element_type *type, unsigned dof_per_node, pzs_real h[4][10],
                        pzs_real *f)
{
    distribute_modes(type, h);
    memset(f, 0, SHELL_NODES * dof_per_node * sizeof *f);
    for (int r = 0; r < SHELL_NODES; r++) {
        const shape rest = undeformed_shape(type, r);
        pzs_real t[10];
        shell_corner force;
        stresses_of_modes(h, r, t);
        corner_stresses(&rest, t, type->thickness, &force);
        corner_scatter(type, dof_per_node, &force, r, f);
    }
}

void pzs_shell_force(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                     pzs_real *f)
{
    pzs_real modes[4][10];
    small_strains(type, dof_per_node, u, modes);
    multiply_modes(type, modes);
    small_force(type, dof_per_node, modes, f);
}

void pzs_shell_stiffness(const pzs_element_type *type, unsigned dof_per_node, pzs_real *k)
{
    const unsigned n = SHELL_NODES * dof_per_node;
    pzs_real u[SHELL_MAX] = {0}, f[SHELL_MAX];
    for (unsigned i = 0; i < n; i++) {
        u[i] = 1;
        pzs_shell_force(type, dof_per_node, u, f);
        memcpy(k, f, (i + 1) * sizeof *k);
        k += i + 1;
        u[i] = 0;
    }
}

void pzs_shell_prescribed_force(const pzs_element_type *type, unsigned dof_per_node,
                                const pzs_real *h0, pzs_real *f)
{
    pzs_real h[4][10] = {{0}};
    for (int i = 0; i < SHELL_STRAINS; i++)
        h[0][i] = -h0[i];
    small_force(type, dof_per_node, h, f);
}

#if PZS_NONLINEAR

/* The members of a shell_corner as a shape. */
static shape shape_of(const shell_corner *corner)
{
    const shape s = {corner->mean, corner->diff, corner->beta, corner->q};
    return s;
}

/* Base vectors at corner r plus `part` of the derivatives d. */
static shell_corner deformed_corner(const pzs_element_type *type, const shell_corner *derivative,
                                    pzs_real part, int r)
{
    shell_corner corner;
    memcpy(corner.mean, type->g_mean[r], sizeof corner.mean);
    memcpy(corner.diff, type->g_diff[r], sizeof corner.diff);
    memcpy(corner.beta, e3, sizeof corner.beta);
    for (int a = 0; a < 2; a++) {
        add_scaled(corner.mean[a], part, derivative->mean[a]);
        add_scaled(corner.diff[a], part, derivative->diff[a]);
    }
    add_scaled(corner.beta, part, derivative->beta);
    corner.q = part * derivative->q;
    return corner;
}

static void derivatives(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                        shell_corner d[4])
{
    for (int r = 0; r < SHELL_NODES; r++)
        d[r] = corner_derivatives(type, dof_per_node, u, r);
}

/*
 * e += L(part u) v, the first variation of the strains of the plain modes.
 *   d, v [4] in  derivatives of u and of v at the corners
 */
static void add_variation(const pzs_element_type *type, const shell_corner d[4], pzs_real part,
                          const shell_corner v[4], pzs_real e[4][10])
{
    for (int r = 0; r < SHELL_NODES; r++) {
        const shell_corner at = deformed_corner(type, &d[r], part, r);
        const shape s = shape_of(&at);
        pzs_real corner_e[10];
        corner_strains(&s, &v[r], type->thickness, corner_e);
        add_modes(e, corner_e, r);
    }
}

/*
 * Strains e(u) + L(u) du of each mode; du may be NULL. The strains are quadratic in u, so half of
 * their variation is exact: e(u) = L(u/2) u.
 */
static void extrapolated_strains(const pzs_element_type *type, unsigned dof_per_node,
                                 const pzs_real *u, const pzs_real *du, pzs_real e[4][10])
{
    shell_corner d[4], v[4];
    memset(e, 0, sizeof(pzs_real[4][10]));
    derivatives(type, dof_per_node, u, d);
    add_variation(type, d, (pzs_real)0.5, d, e);
    if (du) {
        derivatives(type, dof_per_node, du, v);
        add_variation(type, d, 1, v, e);
    }
    correct_modes(type, e);
}

void pzs_shell_strains_at(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                          pzs_real e[4][10])
{
    extrapolated_strains(type, dof_per_node, u, NULL, e);
}

void pzs_shell_resultants(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                          const pzs_real *du, const pzs_real *given, pzs_real *resultant)
{
    pzs_real h[4][10];
    extrapolated_strains(type, dof_per_node, u, du, h);
    multiply_modes(type, h);
    for (int i = 0; given && i < SHELL_STRAINS; i++)
        h[0][i] += given[i];
    for (int m = 0; m < SHELL_MODES; m++)
        for (int i = 0; i < kept_strains[m]; i++)
            *resultant++ = h[m][kept_strain[m][i]];
}

void pzs_shell_corners(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                       shell_corner now[4])
{
    for (int r = 0; r < SHELL_NODES; r++) {
        const shell_corner d = corner_derivatives(type, dof_per_node, u, r);
        now[r] = deformed_corner(type, &d, 1, r);
    }
}

void pzs_shell_stresses(const pzs_element_type *type, const pzs_real *resultant, pzs_real t[4][10])
{
    pzs_real h[4][10];
    memset(h, 0, sizeof h);
    for (int m = 0; m < SHELL_MODES; m++)
        for (int i = 0; i < kept_strains[m]; i++)
            h[m][kept_strain[m][i]] = *resultant++;
    distribute_modes(type, h);
    for (int r = 0; r < SHELL_NODES; r++)
        stresses_of_modes(h, r, t[r]);
}

void pzs_shell_skewed_resultants(const pzs_element_type *type, pzs_real e[4][10])
{
    pzs_shell_skew_strains(type->skew, e);
    multiply_modes(type, e);
    pzs_shell_skew_resultants(type->skew, e);
}

void pzs_shell_corner_force(const pzs_element_type *type, unsigned dof_per_node,
                            const shell_corner at[4], pzs_real t[4][10], pzs_real *f)
{
    memset(f, 0, SHELL_NODES * dof_per_node * sizeof *f);
    for (int r = 0; r < SHELL_NODES; r++) {
        const shape s = shape_of(&at[r]);
        shell_corner force;
        corner_stresses(&s, t[r], type->thickness, &force);
        corner_scatter(type, dof_per_node, &force, r, f);
    }
}

void pzs_shell_force_at(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                        const pzs_real *resultant, pzs_real *f)
{
    pzs_real t[4][10];
    shell_corner at[4];
    pzs_shell_corners(type, dof_per_node, u, at);
    pzs_shell_stresses(type, resultant, t);
    pzs_shell_corner_force(type, dof_per_node, at, t, f);
}

#endif
