/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Margin of a control loop against errors of the entries of its influence matrix (result of
 * simulate/certify_matrix.h).
 */
#ifndef CERTIFICATE_MATRIX_H
#define CERTIFICATE_MATRIX_H

#include <stdbool.h>

/*
 * Standard deviation of the relative errors of the entries below which the margin causes a warning:
 * for a measured influence matrix, and for that of a modelled structure.
 */
#define CERTIFICATE_MATRIX_BAR 0.05
#define CERTIFICATE_MODEL_BAR 0.01

/* Largest standard deviation of the relative errors that is tried. */
#define CERTIFICATE_MATRIX_MOST 0.5

typedef struct certificate_matrix {
    bool is_made;
    bool is_measured; /* whether the influence matrix is measured, not computed from a structure */
    double margin; /* largest standard deviation of random relative errors of the entries at which
                      the loop without voltage limits does not grow; 0: it grows at the smallest
                      that is tried; CERTIFICATE_MATRIX_MOST: it grows at none that is tried */
    bool is_unstable; /* whether the loop grows with the exact matrix, because the controller leaves
                         out small entries (influence.drop_below) */
    double stated;    /* standard deviation of the relative errors that a measured influence matrix
                         must be expected to have; 0 for a modelled structure */
    double cure; /* smallest of the tried regularisations, relative to the mean diagonal entry of
                    the Hessian, with which the margin reaches the bar; 0: none was found, or none
                    is needed */
    double cure_margin; /* margin with this regularisation */
    double cures_tried; /* largest regularisation that was tried, relative to the mean diagonal
                           entry of the Hessian; 0: none */
    double error, cure_error; /* relative RMS error of the shape that the optimal voltages within
                                 the limits leave, without and with the cure; NAN: target zero */
} certificate_matrix;

/*
 * Margin that a loop should have: the bar of measured or of modelled matrices, or the stated errors
 * where these are larger.
 */
double certificate_matrix_bar(const certificate_matrix *matrix);

/* Whether the errors that a measured matrix must be expected to have make the loop grow. */
bool certificate_matrix_refuses(const certificate_matrix *matrix);

#endif
