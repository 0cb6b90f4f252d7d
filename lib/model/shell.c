/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The four-node shell element with six or seven degrees of freedom at a node: strains and forces in
 * the undeformed state, and stress resultants at a displacement (shell.h).
 */
#include "shell.h"
#include "../core/vector3.h"
#include "shell_corner.h"
#include "shell_skew.h"
#include <string.h>

/*
 * Base vectors at a corner of a shell element, from which strains are measured. Shapes and units
 * are those of shell_corner. In the undeformed state the director beta is the normal. The
 * displacement q of the middle surface relative to the mean of both faces is then 0.
 */
typedef struct shape {
    const pzs_real (*mean)[3];
    const pzs_real (*diff)[3];
    const pzs_real *beta;
    pzs_real q;
} shape;

static const pzs_real e3[3] = {0, 0, 1};

/* Add the product of a 3 x 3 matrix and a vector x to a vector: y += matrix times x. */
static void add_product(pzs_real y[3], const pzs_real matrix[3][3], const pzs_real x[3])
{
    for (int i = 0; i < 3; i++)
        y[i] += matrix[i][0] * x[0] + matrix[i][1] * x[1] + matrix[i][2] * x[2];
}

/*
 * Add the product of a transposed 3 x 3 matrix and a vector x to a vector: y += matrix^T times x.
 */
static void add_transposed(pzs_real y[3], const pzs_real matrix[3][3], const pzs_real x[3])
{
    for (int j = 0; j < 3; j++)
        y[j] += matrix[0][j] * x[0] + matrix[1][j] * x[1] + matrix[2][j] * x[2];
}

/* Add a multiple of a vector x of three entries to a vector: y += factor times x. */
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
 * Compute the derivatives of the displacement along the surface coordinates theta1 and theta2 at
 * one corner of an element: the mean of both faces of the shell, and their difference divided by
 * the thickness. Matrices s and t of the element type multiply the displacements of the corner and
 * of its neighbour.
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
 * Turn forces that are conjugate to the displacement derivatives at one corner of an element (along
 * the surface coordinates theta1 and theta2) into nodal forces, and add them to nodal_force [4
 * dof_per_node]. This is the transpose of the linear map from nodal displacements to these
 * derivatives.
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
 * Compute the change of the strains at a corner of an element, to first order, when the derivatives
 * of the displacement change by `change`. On a face of the shell
 *   change of the strain = (g + l).dl
 *   g, l  base vector and derivative of the displacement
 *   dl    change of that derivative
 *   base   in   g + l: mean and difference of the two faces
 *   strain out  [10] changes of the strains 11, 22, 33 and 12 (each as mean and difference of the
 *               faces), 13 and 23
 */
static void corner_strains(const shape *base, const shell_corner *change,
                           const pzs_element_type *type, pzs_real strain[10])
{
    const pzs_real thickness = type->thickness;
    const pzs_real *square = type->height_squared[0], *slope = type->height_squared[1];
    // The difference of a strain between the faces is computed from means and differences of the
    // base vectors and of their changes. Subtracting the nearly equal strains of both faces would
    // lose digits.
    for (int direction = 0; direction < 2; direction++) {
        // part of the in-plane strain that is quadratic in the height above the middle of the
        // shell: coefficient of the squared height (1/m2). It contributes to the mean strain of
        // both faces and to their difference, by the factors in pzs_element_type.height_squared
        const pzs_real quadratic = vector3_dot(base->diff[direction], change->diff[direction]);
        strain[2 * direction] = vector3_dot(base->mean[direction], change->mean[direction]) +
                                square[direction] * quadratic;
        strain[2 * direction + 1] =
            thickness * (vector3_dot(base->mean[direction], change->diff[direction]) +
                         vector3_dot(base->diff[direction], change->mean[direction])) +
            slope[direction] * quadratic;
        strain[E13 + direction] =
            vector3_dot(base->mean[direction], change->beta) +
            vector3_dot(base->beta, change->mean[direction]) -
            2 * thickness *
                (base->diff[direction][2] * change->q + base->q * change->diff[direction][2]);
    }
    strain[E33M] = vector3_dot(base->beta, change->beta) + 16 * base->q * change->q;
    strain[E33D] = -8 * (base->beta[2] * change->q + base->q * change->beta[2]);
    const pzs_real quadratic =
        vector3_dot(base->diff[0], change->diff[1]) + vector3_dot(base->diff[1], change->diff[0]);
    strain[E12M] = vector3_dot(base->mean[0], change->mean[1]) +
                   vector3_dot(base->mean[1], change->mean[0]) + square[2] * quadratic;
    strain[E12D] = thickness * (vector3_dot(base->mean[0], change->diff[1]) +
                                vector3_dot(base->diff[0], change->mean[1]) +
                                vector3_dot(base->mean[1], change->diff[0]) +
                                vector3_dot(base->diff[1], change->mean[0])) +
                   slope[2] * quadratic;
}

/*
 * Turn the stresses at a corner of an element into forces that are conjugate to the displacement
 * derivatives along the surface there: stresses times a change of the strains equal these forces
 * times the change of the derivatives.
 *   stress [10] in  stresses conjugate to the strains 11, 22, 33 and 12 (each as mean and
 *                   difference of the two faces), 13 and 23
 */
static void corner_stresses(const shape *base, const pzs_real stress[10],
                            const pzs_element_type *type, shell_corner *force)
{
    const pzs_real thickness = type->thickness;
    pzs_real quadratic[3];
    shell_quadratic_stresses(type, stress, quadratic);
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
        add_scaled(force->diff[direction], quadratic[direction], base->diff[direction]);
        add_scaled(force->diff[direction], bending, base->mean[direction]);
        add_scaled(force->diff[direction], quadratic[2], base->diff[1 - direction]);
        add_scaled(force->diff[direction], thickness * stress[E12D], base->mean[1 - direction]);
        force->diff[direction][2] -= 2 * thickness * shear * base->q;
        add_scaled(force->beta, shear, base->mean[direction]);
        force->q -= 2 * thickness * shear * base->diff[direction][2];
    }
    add_scaled(force->beta, stress[E33M], base->beta);
    force->beta[2] -= 8 * stress[E33D] * base->q;
    force->q += 16 * stress[E33M] * base->q - 8 * stress[E33D] * base->beta[2];
}

/*
 * Add the strains of one corner to the strain modes 00, 01, 10 and 11 (constant, linear in either
 * direction, bilinear) of an element. Each strain mode is the mean over the corners of the strains,
 * multiplied by the sign (1 or -1) that the mode has at the corner.
 */
static void add_modes(pzs_real modes[4][10], const pzs_real strain[10], int corner)
{
    for (int mode = 0; mode < SHELL_MODES; mode++)
        for (int i = 0; i < SHELL_STRAINS; i++)
            modes[mode][i] += (pzs_real)0.25 * mode_sign[mode][corner] * strain[i];
}

/*
 * Compute the stresses at one corner of an element from the stress resultants of its four strain
 * modes, by the transpose of add_modes.
 *   stress [10] out  stresses conjugate to the strains 11, 22, 33 and 12 (each as mean and
 *                    difference of the two faces), 13 and 23
 */
static void stresses_of_modes(pzs_real resultant[4][10], int corner, pzs_real stress[10])
{
    for (int i = 0; i < SHELL_STRAINS; i++) {
        stress[i] = 0;
        for (int mode = 0; mode < SHELL_MODES; mode++)
            stress[i] += (pzs_real)0.25 * mode_sign[mode][corner] * resultant[mode][i];
    }
}

/*
 * Replace the strains of one strain mode (constant, linear or bilinear over the element) of an
 * element by the stress resultants of this mode. `stiffness` is the packed lower triangle of a
 * symmetric matrix; it has a row for each strain that the mode takes into account (kept_strain),
 * ten at most.
 */
static void multiply_mode(const pzs_real *stiffness, int mode, pzs_real strain[10])
{
    pzs_real resultant[10] = {0};
    for (int i = 0; i < kept_strains[mode]; i++) {
        const int row = kept_strain[mode][i];
        for (int j = 0; j < i; j++, stiffness++) {
            const int column = kept_strain[mode][j];
            resultant[row] += *stiffness * strain[column];
            resultant[column] += *stiffness * strain[row];
        }
        resultant[row] += *stiffness++ * strain[row];
    }
    memcpy(strain, resultant, sizeof resultant);
}

/*
 * Correct the mean in-plane shear strain 12 in the strain mode that is constant over the element
 * for the warp of the element (its distance from a plane): add a linear combination of other
 * strains, with the factors pzs_element_type.warp.
 */
static void add_warp(const pzs_element_type *type, pzs_real strain[4][10])
{
    const pzs_real *w = type->warp;
    strain[0][E12M] += w[0] * strain[0][E12D] + w[1] * strain[1][E13] + w[2] * strain[2][E23] +
                       w[3] * strain[0][E13] + w[4] * strain[0][E23] + w[5] * strain[0][E11D] +
                       w[6] * strain[1][E11D] + w[7] * strain[0][E22D] + w[8] * strain[2][E22D];
}

/*
 * In a warped (not plane) element, add multiples of the in-plane shear resultant of mode 00 to nine
 * other stress resultants, with the factors of pzs_element_type.warp. This is the transpose of
 * add_warp, which corrects the shear strain.
 */
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

/*
 * Correct the strains of all four strain modes (constant, linear and bilinear over the element) of
 * an element for the warp and the skew of the element.
 */
static void correct_modes(const pzs_element_type *type, pzs_real strain[4][10])
{
    add_warp(type, strain);
    if (shell_is_skewed(type))
        pzs_shell_skew_strains(type->skew, strain);
}

/*
 * Turn stress resultants that are conjugate to the strains corrected for warp and skew of the
 * element into resultants that are conjugate to the uncorrected strains. This is the transpose of
 * the correction of the strains.
 */
static void distribute_modes(const pzs_element_type *type, pzs_real resultant[4][10])
{
    if (shell_is_skewed(type))
        pzs_shell_skew_resultants(type->skew, resultant);
    distribute_warp(type, resultant);
}

/*
 * Replace the strains of an element by their stress resultants, the product with the stiffness of
 * the laminate, for each of the four strain modes: constant, linear in either direction, bilinear.
 */
static void multiply_modes(const pzs_element_type *type, pzs_real strain[4][10])
{
    for (int mode = 0; mode < SHELL_MODES; mode++)
        multiply_mode(type->d + first_entry[mode], mode, strain[mode]);
}

/*
 * Compute the strains of all four strain modes (constant, linear and bilinear over the element) of
 * an element in the undeformed state, where they are linear in the displacement.
 */
static void small_strains(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement, pzs_real modes[4][10])
{
    memset(modes, 0, sizeof(pzs_real[4][10]));
    for (int corner = 0; corner < SHELL_NODES; corner++) {
        const shape rest = undeformed_shape(type, corner);
        const shell_corner derivative =
            corner_derivatives(type, dof_per_node, displacement, corner);
        pzs_real strain[10];
        corner_strains(&rest, &derivative, type, strain);
        add_modes(modes, strain, corner);
    }
    correct_modes(type, modes);
}

/*
 * Compute the nodal forces [4 dof_per_node] of the stress resultants of all strain modes (constant,
 * linear and bilinear over the element) of an element in the undeformed state. The resultants are
 * overwritten.
 */
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
        corner_stresses(&rest, stress, type, &force);
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

pzs_real pzs_shell_energy(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement)
{
    pzs_real strain[4][10], resultant[4][10], sum = 0;
    small_strains(type, dof_per_node, displacement, strain);
    memcpy(resultant, strain, sizeof resultant);
    multiply_modes(type, resultant);
    for (int mode = 0; mode < SHELL_MODES; mode++)
        for (int i = 0; i < SHELL_STRAINS; i++)
            sum += strain[mode][i] * resultant[mode][i];
    return sum;
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

/*
 * Return pointers (struct shape) to the base vectors at a deformed corner of an element, which a
 * struct shell_corner holds.
 */
static shape shape_of(const shell_corner *corner)
{
    const shape base = {corner->mean, corner->diff, corner->beta, corner->q};
    return base;
}

/*
 * Return base vectors, director and degree of freedom q at one corner of a shell element that has
 * been deformed by a fraction of a displacement (shell_corner).
 *   derivative in  derivatives of the whole displacement at this corner along the surface
 *   part       in  fraction of the displacement, from 0 to 1
 */
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

static void all_derivatives(const pzs_element_type *type, unsigned dof_per_node,
                            const pzs_real *displacement, shell_corner derivative[4])
{
    for (int corner = 0; corner < SHELL_NODES; corner++)
        derivative[corner] = corner_derivatives(type, dof_per_node, displacement, corner);
}

/*
 * Add the first variation of the strains of an element for a displacement increment v, at a shape
 * deformed by the fraction `part` of a displacement u.
 *   derivative [4]     in      derivatives of u along the surface coordinates at the four corners
 *   variation  [4]     in      derivatives of v along the surface coordinates at the four corners
 *   strain     [4][10] in/out  ten strains for each of the four strain modes
 */
static void add_variation(const pzs_element_type *type, const shell_corner derivative[4],
                          pzs_real part, const shell_corner variation[4], pzs_real strain[4][10])
{
    for (int corner = 0; corner < SHELL_NODES; corner++) {
        const shell_corner at = deformed_corner(type, &derivative[corner], part, corner);
        const shape base = shape_of(&at);
        pzs_real corner_e[10];
        corner_strains(&base, &variation[corner], type, corner_e);
        add_modes(strain, corner_e, corner);
    }
}

/*
 * Compute the strains of an element's four strain modes (constant, linear and bilinear over the
 * element) at a displacement, plus their first variation for the increment du (NULL: no increment).
 */
static void extrapolated_strains(const pzs_element_type *type, unsigned dof_per_node,
                                 const pzs_real *displacement, const pzs_real *du,
                                 pzs_real strain[4][10])
{
    shell_corner derivative[4], variation[4];
    memset(strain, 0, sizeof(pzs_real[4][10]));
    all_derivatives(type, dof_per_node, displacement, derivative);
    // Strains are quadratic in the displacement u and zero at 0. They are therefore equal to the
    // first variation that the increment u causes at the displacement u/2.
    add_variation(type, derivative, (pzs_real)0.5, derivative, strain);
    if (du) {
        all_derivatives(type, dof_per_node, du, variation);
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
        corner_stresses(&base, stress[corner], type, &force);
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
