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
static void add_product(pzs_real y[3], const pzs_real matrix[3][3], const pzs_real x[3])
{
    for (int i = 0; i < 3; i++)
        y[i] += matrix[i][0] * x[0] + matrix[i][1] * x[1] + matrix[i][2] * x[2];
}

/* y += M' x, M [3][3] */
static void add_transposed(pzs_real y[3], const pzs_real matrix[3][3], const pzs_real x[3])
{
    for (int j = 0; j < 3; j++)
        y[j] += matrix[0][j] * x[0] + matrix[1][j] * x[1] + matrix[2][j] * x[2];
}

/* y += factor x */
static void add_scaled(pzs_real y[3], pzs_real factor, const pzs_real x[3])
{
    for (int i = 0; i < 3; i++)
        y[i] += factor * x[i];
}

static shape undeformed_shape(const pzs_element_type *type, int corner)
{
    const shape base = {type->g_mean[corner], type->g_diff[corner], e3, 0};
    return base;
}

/*
 * Derivatives of a displacement at corner r:  lam_a = S_a u_r + T_a u_r', for the mean and the
 * difference of the faces.
 */
static shell_corner corner_derivatives(const pzs_element_type *type, unsigned dof_per_node,
                                       const pzs_real *displacement, int corner)
{
    shell_corner derivative;
    const pzs_real *own = displacement + (unsigned)corner * dof_per_node;
    memset(&derivative, 0, sizeof derivative);
    for (int direction = 0; direction < 2; direction++) {
        const pzs_real *other = displacement + neighbour[corner][direction] * dof_per_node;
        add_product(derivative.mean[direction], type->s[corner][direction], own);
        add_product(derivative.mean[direction], type->t[corner][direction], other);
        add_product(derivative.diff[direction], type->s[corner][direction], own + 3);
        add_product(derivative.diff[direction], type->t[corner][direction], other + 3);
    }
    memcpy(derivative.beta, own + 3, sizeof derivative.beta);
    derivative.q = dof_per_node == 7 ? own[6] : 0;
    return derivative;
}

/*
 * Transpose of corner_derivatives: add the forces c on the derivatives at corner r to the nodal
 * forces f.
 */
static void corner_scatter(const pzs_element_type *type, unsigned dof_per_node,
                           const shell_corner *force, int corner, pzs_real *nodal_force)
{
    pzs_real *own = nodal_force + (unsigned)corner * dof_per_node;
    for (int direction = 0; direction < 2; direction++) {
        pzs_real *other = nodal_force + neighbour[corner][direction] * dof_per_node;
        add_transposed(own, type->s[corner][direction], force->mean[direction]);
        add_transposed(other, type->t[corner][direction], force->mean[direction]);
        add_transposed(own + 3, type->s[corner][direction], force->diff[direction]);
        add_transposed(other + 3, type->t[corner][direction], force->diff[direction]);
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
static void corner_strains(const shape *base, const shell_corner *change, pzs_real thickness,
                           pzs_real strain[10])
{
    const pzs_real hh4 = thickness * thickness / 4;
    for (int direction = 0; direction < 2; direction++) {
        strain[2 * direction] = dot(base->mean[direction], change->mean[direction]) +
                                hh4 * dot(base->diff[direction], change->diff[direction]);
        strain[2 * direction + 1] =
            thickness * (dot(base->mean[direction], change->diff[direction]) +
                         dot(base->diff[direction], change->mean[direction]));
        strain[E13 + direction] =
            dot(base->mean[direction], change->beta) + dot(base->beta, change->mean[direction]) -
            2 * thickness *
                (base->diff[direction][2] * change->q + base->q * change->diff[direction][2]);
    }
    strain[E33M] = dot(base->beta, change->beta) + 16 * base->q * change->q;
    strain[E33D] = -8 * (base->beta[2] * change->q + base->q * change->beta[2]);
    strain[E12M] =
        dot(base->mean[0], change->mean[1]) + dot(base->mean[1], change->mean[0]) +
        hh4 * (dot(base->diff[0], change->diff[1]) + dot(base->diff[1], change->diff[0]));
    strain[E12D] =
        thickness * (dot(base->mean[0], change->diff[1]) + dot(base->diff[0], change->mean[1]) +
                     dot(base->mean[1], change->diff[0]) + dot(base->diff[1], change->mean[0]));
}

/* Transpose of corner_strains: forces f on the derivatives from the stresses t. */
static void corner_stresses(const shape *base, const pzs_real stress[10], pzs_real thickness,
                            shell_corner *force)
{
    const pzs_real hh4 = thickness * thickness / 4;
    memset(force, 0, sizeof *force);
    for (int direction = 0; direction < 2; direction++) {
        const pzs_real membrane = stress[2 * direction],
                       bending = thickness * stress[2 * direction + 1],
                       shear = stress[E13 + direction];
        add_scaled(force->mean[direction], membrane, base->mean[direction]);
        add_scaled(force->mean[direction], bending, base->diff[direction]);
        add_scaled(force->mean[direction], shear, base->beta);
        add_scaled(force->mean[direction], stress[E12M], base->mean[1 - direction]);
        add_scaled(force->mean[direction], thickness * stress[E12D], base->diff[1 - direction]);
        add_scaled(force->diff[direction], hh4 * membrane, base->diff[direction]);
        add_scaled(force->diff[direction], bending, base->mean[direction]);
        add_scaled(force->diff[direction], hh4 * stress[E12M], base->diff[1 - direction]);
        add_scaled(force->diff[direction], thickness * stress[E12D], base->mean[1 - direction]);
        force->diff[direction][2] -= 2 * thickness * shear * base->q;
        add_scaled(force->beta, shear, base->mean[direction]);
        force->q -= 2 * thickness * shear * base->diff[direction][2];
    }
    add_scaled(force->beta, stress[E33M], base->beta);
    force->beta[2] -= 8 * stress[E33D] * base->q;
    force->q += 16 * stress[E33M] * base->q - 8 * stress[E33D] * base->beta[2];
}

/* Add the strains e of corner r to the modes:  e^m = 1/4 sum_r sign e_r. */
static void add_modes(pzs_real modes[4][10], const pzs_real strain[10], int corner)
{
    for (int mode = 0; mode < SHELL_MODES; mode++)
        for (int i = 0; i < SHELL_STRAINS; i++)
            modes[mode][i] += (pzs_real)0.25 * mode_sign[mode][corner] * strain[i];
}

/* Stresses t at corner r from the resultants of the modes, the transpose of add_modes. */
static void stresses_of_modes(pzs_real resultant[4][10], int corner, pzs_real stress[10])
{
    for (int i = 0; i < SHELL_STRAINS; i++) {
        stress[i] = 0;
        for (int mode = 0; mode < SHELL_MODES; mode++)
            stress[i] += (pzs_real)0.25 * mode_sign[mode][corner] * resultant[mode][i];
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
static void multiply_mode(const pzs_real *stiffness, int mode, pzs_real strain[10])
{
    pzs_real resultant[10] = {0};
    for (int i = 0; i < kept_strains[mode]; i++) {
        const int row = kept_strain[mode][i];
        const pzs_real *entry = stiffness + row * (row + 1) / 2;
        for (int j = 0; j < i; j++) {
            const int column = kept_strain[mode][j];
            resultant[row] += entry[column] * strain[column];
            resultant[column] += entry[column] * strain[row];
        }
        resultant[row] += entry[row] * strain[row];
    }
    memcpy(strain, resultant, sizeof resultant);
}

/*
 * Add the warp to the mean strain 12 of mode 00: a fixed combination of other strains
 * (pzs_element_type).
 */
static void add_warp(const pzs_element_type *type, pzs_real strain[4][10])
{
    const pzs_real *w = type->warp;
    strain[0][E12M] += w[0] * strain[0][E12D] + w[1] * strain[1][E13] + w[2] * strain[2][E23] +
                       w[3] * strain[0][E13] + w[4] * strain[0][E23] + w[5] * strain[0][E11D] +
                       w[6] * strain[1][E11D] + w[7] * strain[0][E22D] + w[8] * strain[2][E22D];
}

/* Transpose of add_warp: add the part of the mean resultant 12 to the other resultants. */
static void distribute_warp(const pzs_element_type *type, pzs_real resultant[4][10])
{
    const pzs_real *w = type->warp, mean = resultant[0][E12M];
    resultant[0][E12D] += w[0] * mean;
    resultant[1][E13] += w[1] * mean;
    resultant[2][E23] += w[2] * mean;
    resultant[0][E13] += w[3] * mean;
    resultant[0][E23] += w[4] * mean;
    resultant[0][E11D] += w[5] * mean;
    resultant[1][E11D] += w[6] * mean;
    resultant[0][E22D] += w[7] * mean;
    resultant[2][E22D] += w[8] * mean;
}

/* Turn the strains of the plain modes into those that the resultants belong to. */
static void correct_modes(const pzs_element_type *type, pzs_real strain[4][10])
{
    add_warp(type, strain);
    if (shell_is_skewed(type))
        pzs_shell_skew_strains(type->skew, strain);
}

/* Transpose of correct_modes: resultants of the plain modes. */
static void distribute_modes(const pzs_element_type *type, pzs_real resultant[4][10])
{
    if (shell_is_skewed(type))
        pzs_shell_skew_resultants(type->skew, resultant);
    distribute_warp(type, resultant);
}

/* Replace the corrected strains of all modes by their resultants. distribute_modes must follow. */
static void multiply_modes(const pzs_element_type *type, pzs_real strain[4][10])
{
    for (int mode = 0; mode < SHELL_MODES; mode++)
        multiply_mode(type->d[mode], mode, strain[mode]);
}

/* Strains of each mode in the undeformed state, linear in u. */
static void small_strains(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement, pzs_real modes[4][10])
{
    memset(modes, 0, sizeof(pzs_real[4][10]));
    for (int corner = 0; corner < SHELL_NODES; corner++) {
        const shape rest = undeformed_shape(type, corner);
        const shell_corner derivative =
            corner_derivatives(type, dof_per_node, displacement, corner);
        pzs_real strain[10];
        corner_strains(&rest, &derivative, type->thickness, strain);
        add_modes(modes, strain, corner);
    }
    correct_modes(type, modes);
}

/* f = sum of L' h in the undeformed state */
static void small_force(const pzs_element_type *type, unsigned dof_per_node,
                        pzs_real resultant[4][10], pzs_real *nodal_force)
{
    distribute_modes(type, resultant);
    memset(nodal_force, 0, SHELL_NODES * dof_per_node * sizeof *nodal_force);
    for (int corner = 0; corner < SHELL_NODES; corner++) {
        const shape rest = undeformed_shape(type, corner);
        pzs_real stress[10];
        shell_corner force;
        stresses_of_modes(resultant, corner, stress);
        corner_stresses(&rest, stress, type->thickness, &force);
        corner_scatter(type, dof_per_node, &force, corner, nodal_force);
    }
}

void pzs_shell_force(const pzs_element_type *type, unsigned dof_per_node,
                     const pzs_real *displacement, pzs_real *force)
{
    pzs_real modes[4][10];
    small_strains(type, dof_per_node, displacement, modes);
    multiply_modes(type, modes);
    small_force(type, dof_per_node, modes, force);
}

void pzs_shell_stiffness(const pzs_element_type *type, unsigned dof_per_node, pzs_real *stiffness)
{
    const unsigned dof = SHELL_NODES * dof_per_node;
    pzs_real displacement[SHELL_MAX] = {0}, force[SHELL_MAX];
    for (unsigned i = 0; i < dof; i++) {
        displacement[i] = 1;
        pzs_shell_force(type, dof_per_node, displacement, force);
        memcpy(stiffness, force, (i + 1) * sizeof *stiffness);
        stiffness += i + 1;
        displacement[i] = 0;
    }
}

void pzs_shell_prescribed_force(const pzs_element_type *type, unsigned dof_per_node,
                                const pzs_real *h0, pzs_real *force)
{
    pzs_real resultant[4][10] = {{0}};
    for (int i = 0; i < SHELL_STRAINS; i++)
        resultant[0][i] = -h0[i];
    small_force(type, dof_per_node, resultant, force);
}

#if PZS_NONLINEAR

/* The members of a shell_corner as a shape. */
static shape shape_of(const shell_corner *corner)
{
    const shape base = {corner->mean, corner->diff, corner->beta, corner->q};
    return base;
}

/* Base vectors at corner r plus `part` of the derivatives d. */
static shell_corner deformed_corner(const pzs_element_type *type, const shell_corner *derivative,
                                    pzs_real part, int at_corner)
{
    shell_corner corner;
    memcpy(corner.mean, type->g_mean[at_corner], sizeof corner.mean);
    memcpy(corner.diff, type->g_diff[at_corner], sizeof corner.diff);
    memcpy(corner.beta, e3, sizeof corner.beta);
    for (int direction = 0; direction < 2; direction++) {
        add_scaled(corner.mean[direction], part, derivative->mean[direction]);
        add_scaled(corner.diff[direction], part, derivative->diff[direction]);
    }
    add_scaled(corner.beta, part, derivative->beta);
    corner.q = part * derivative->q;
    return corner;
}

static void derivatives(const pzs_element_type *type, unsigned dof_per_node,
                        const pzs_real *displacement, shell_corner derivative[4])
{
    for (int corner = 0; corner < SHELL_NODES; corner++)
        derivative[corner] = corner_derivatives(type, dof_per_node, displacement, corner);
}

/*
 * e += L(part u) v, the first variation of the strains of the plain modes.
 *   d, variation [4] in  derivatives of u and of v at the corners
 */
static void add_variation(const pzs_element_type *type, const shell_corner derivative[4],
                          pzs_real part, const shell_corner variation[4], pzs_real strain[4][10])
{
    for (int corner = 0; corner < SHELL_NODES; corner++) {
        const shell_corner at = deformed_corner(type, &derivative[corner], part, corner);
        const shape base = shape_of(&at);
        pzs_real corner_e[10];
        corner_strains(&base, &variation[corner], type->thickness, corner_e);
        add_modes(strain, corner_e, corner);
    }
}

/*
 * Strains e(u) + L(u) du of each mode; du may be NULL. The strains are quadratic in u, so half of
 * their variation is exact: e(u) = L(u/2) u.
 */
static void extrapolated_strains(const pzs_element_type *type, unsigned dof_per_node,
                                 const pzs_real *displacement, const pzs_real *du,
                                 pzs_real strain[4][10])
{
    shell_corner derivative[4], variation[4];
    memset(strain, 0, sizeof(pzs_real[4][10]));
    derivatives(type, dof_per_node, displacement, derivative);
    add_variation(type, derivative, (pzs_real)0.5, derivative, strain);
    if (du) {
        derivatives(type, dof_per_node, du, variation);
        add_variation(type, derivative, 1, variation, strain);
    }
    correct_modes(type, strain);
}

void pzs_shell_strains_at(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement, pzs_real strain[4][10])
{
    extrapolated_strains(type, dof_per_node, displacement, NULL, strain);
}

void pzs_shell_resultants(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement, const pzs_real *du, const pzs_real *given,
                          pzs_real *resultant)
{
    pzs_real mode_resultant[4][10];
    extrapolated_strains(type, dof_per_node, displacement, du, mode_resultant);
    multiply_modes(type, mode_resultant);
    for (int i = 0; given && i < SHELL_STRAINS; i++)
        mode_resultant[0][i] += given[i];
    for (int mode = 0; mode < SHELL_MODES; mode++)
        for (int i = 0; i < kept_strains[mode]; i++)
            *resultant++ = mode_resultant[mode][kept_strain[mode][i]];
}

void pzs_shell_corners(const pzs_element_type *type, unsigned dof_per_node,
                       const pzs_real *displacement, shell_corner now[4])
{
    for (int corner = 0; corner < SHELL_NODES; corner++) {
        const shell_corner derivative =
            corner_derivatives(type, dof_per_node, displacement, corner);
        now[corner] = deformed_corner(type, &derivative, 1, corner);
    }
}

void pzs_shell_stresses(const pzs_element_type *type, const pzs_real *resultant,
                        pzs_real stress[4][10])
{
    pzs_real mode_resultant[4][10];
    memset(mode_resultant, 0, sizeof mode_resultant);
    for (int mode = 0; mode < SHELL_MODES; mode++)
        for (int i = 0; i < kept_strains[mode]; i++)
            mode_resultant[mode][kept_strain[mode][i]] = *resultant++;
    distribute_modes(type, mode_resultant);
    for (int corner = 0; corner < SHELL_NODES; corner++)
        stresses_of_modes(mode_resultant, corner, stress[corner]);
}

void pzs_shell_skewed_resultants(const pzs_element_type *type, pzs_real strain[4][10])
{
    pzs_shell_skew_strains(type->skew, strain);
    multiply_modes(type, strain);
    pzs_shell_skew_resultants(type->skew, strain);
}

void pzs_shell_corner_force(const pzs_element_type *type, unsigned dof_per_node,
                            const shell_corner at[4], pzs_real stress[4][10], pzs_real *nodal_force)
{
    memset(nodal_force, 0, SHELL_NODES * dof_per_node * sizeof *nodal_force);
    for (int corner = 0; corner < SHELL_NODES; corner++) {
        const shape base = shape_of(&at[corner]);
        shell_corner force;
        corner_stresses(&base, stress[corner], type->thickness, &force);
        corner_scatter(type, dof_per_node, &force, corner, nodal_force);
    }
}

void pzs_shell_force_at(const pzs_element_type *type, unsigned dof_per_node,
                        const pzs_real *displacement, const pzs_real *resultant, pzs_real *force)
{
    pzs_real stress[4][10];
    shell_corner at[4];
    pzs_shell_corners(type, dof_per_node, displacement, at);
    pzs_shell_stresses(type, resultant, stress);
    pzs_shell_corner_force(type, dof_per_node, at, stress, force);
}

#endif
