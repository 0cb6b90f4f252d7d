/*
 * Definitions that all parts of piezoshape share: real numbers, statuses, sparse rows and symmetric
 * matrices.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 *   - The caller owns all memory: the library does not allocate, print, recurse or keep global
 *     variables.
 *   - Arrays are row-major; [rows][columns] in a comment gives the shape of an array.
 *   - The unit of a quantity is that of the scene file from which `pzs tables` generated the
 *     tables; the comments assume m, N, V and K.
 *   - A function that returns an error (PZS_E_...) leaves its outputs untouched, unless its comment
 *     says otherwise. After a warning (PZS_W_...) the outputs are valid.
 *   - The member info.where of an object is the index to which its last status refers, or -1.
 *   - [P n] cites equation n of S. V. Plotnikova's dissertation (Tambov 2013).
 */
#ifndef PZS_BASE_H
#define PZS_BASE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "pzs_config.h"
#include "pzs_version.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- numbers ---------------------------------------------------------- */

/*
 * The names of pzs_model_init, pzs_control_init and pzs_loop_init contain the precision (32 or 64
 * bits), so that a program does not link with a library of the other precision.
 */
#if PZS_REAL_BITS == 32
typedef float pzs_real;
#define pzs_model_init pzs_model_init_32
#define pzs_control_init pzs_control_init_32
#define pzs_loop_init pzs_loop_init_32
#define PZS_BY_BITS(for32, for64) (for32)
#define PZS_EPSILON 1.1920929e-7f
#define PZS_SQRT(x) sqrtf(x)
#define PZS_ABS(x) fabsf(x)
#else
typedef double pzs_real;
#define pzs_model_init pzs_model_init_64
#define pzs_control_init pzs_control_init_64
#define pzs_loop_init pzs_loop_init_64
#define PZS_BY_BITS(for32, for64) (for64)
#define PZS_EPSILON 2.2204460492503131e-16
#define PZS_SQRT(x) sqrt(x)
#define PZS_ABS(x) fabs(x)
#endif

/*
 * PZS_R(x) converts the number x of a generated table from double to the library's type of real
 * numbers, pzs_real, by one rounding.
 */
#define PZS_R(x) ((pzs_real)(x))

#if PZS_TILE == 4
#define PZS_BY_TILE(for4, for8, for16) (for4)
#elif PZS_TILE == 8
#define PZS_BY_TILE(for4, for8, for16) (for8)
#else
#define PZS_BY_TILE(for4, for8, for16) (for16)
#endif

/*
 * Upper bounds of the stack (bytes) that a public function of the library uses: PZS_STACK_LINEAR in
 * a program without large rotations (built without PZS_NONLINEAR), PZS_STACK_MODES in one that also
 * computes vibration modes (PZS_MODES=1), PZS_STACK_NONLINEAR in a program built with
 * PZS_NONLINEAR=1.
 */
#define PZS_STACK_LINEAR (256u * sizeof(pzs_real))
#define PZS_STACK_MODES (320u * sizeof(pzs_real))
#define PZS_STACK_NONLINEAR (2192u * sizeof(pzs_real))

/* Return the version of the linked library: the value of PZS_VERSION_TEXT when it was compiled. */
const char *pzs_version(void);

/* ---- statuses --------------------------------------------------------- */

typedef enum pzs_status {
    PZS_OK = 0,

    /*
     * Warnings have the values 1 to 63: the outputs are valid, but the caller should know of the
     * event that the warning names.
     */
    PZS_W_ITERATIONS = 1, /* Warning: the optimiser reached its work limit (largest number of
                             multiply-adds in a tick), so the voltages are inside all limits and no
                             worse than before, but not optimal. */
    PZS_W_STEP_LIMIT, /* Warning: the step limit and the voltage limits of input info.where do not
                         overlap; the voltage limits take precedence. */
    PZS_W_SENSOR, /* Warning: the measurement with index info.where is missing or stuck; the last
                     difference between measurement and model is used instead. */
    /*
     * Warning: no measurement is usable, or the target is not finite. The voltages of the last tick
     * are kept; but where an estimator or a vibration damper predicts the shape, and only the
     * measurements are missing, the voltages follow the target by this prediction.
     */
    PZS_W_HELD,
    PZS_W_ELECTRODE, /* Warning: electrode info.where does not follow its amplifier; the fault
                        detector keeps its voltage constant from now on. */
    /*
     * Warning: the shell is in equilibrium and in contact with the rigid body, but a part of the
     * shell that faces away from the body lies inside the body: the shell has passed through
     * itself, or both of its faces would touch the body.
     */
    PZS_W_BEHIND,
    PZS_W_UNSTABLE, /* Warning: the equilibrium is unstable, because its tangent stiffness has
                       negative pivots. */
    /*
     * Warning: before control begins, or by command, the voltages are at safe voltages (park
     * voltages from the tables, or reference voltages) or on a ramp to them, and do not follow the
     * target.
     */
    PZS_W_PARKED,
    /*
     * Warning: after an error or an alarm the supervisor ramps the voltages to the park voltages,
     * the safe voltages in its tables. At the end of the ramp the status is PZS_E_LATCHED.
     */
    PZS_W_RAMP,
    PZS_W_OUTPUT,   /* Warning: the last gate, the check of all voltages at the end of a tick, has
                       corrected the voltage of input info.where, which was not finite or beyond a
                       limit because working memory was damaged. */
    PZS_W_SELFTEST, /* Warning: the self-test moves one amplifier after the other; the loop does not
                       yet control the voltages. */
    /*
     * Warning of a controller that also limits sums of voltages, in two cases. pzs_hold has fixed
     * input info.where at a voltage that it has not reached yet; or the start voltages exceed a
     * limit, and info.where is -1. In both cases the ticks move all voltages towards the safe
     * voltages of pzs_limit_rows, or keep the present voltages where the limits forbid such moves.
     */
    PZS_W_LIMIT_ROWS,
    PZS_W_UNOBSERVABLE, /* Warning: the records of a calibration do not determine the effect of
                           input info.where; its column of the influence matrix is kept. */
    PZS_W_GATED, /* Warning: measurement info.where is beyond its range or contradicts the others;
                    the sensor gate treats it as missing. */
    PZS_W_MODE_COUNT, /* Warning: the vibration modes have converged, but rounding errors are too
                         large to prove by a count that none is missing. */
    /*
     * Warning: the measurements contradict the model, and no few wrong sensors explain it. Either
     * there is a load that the tables do not know, or more sensors are wrong than the sensor gate
     * can find. The measurements are used as they are; that of sensor info.where contradicts most.
     */
    PZS_W_CONTRADICTION,
    /*
     * Warning: the measured shape is opposite to the predicted one, and the supervisor tests
     * whether amplifiers have the wrong polarity: the voltages ramp towards the park voltages and
     * back, and do not follow the target.
     */
    PZS_W_POLARITY,

    /*
     * Status codes of errors have values from 64 on: a function that returns one has left its
     * outputs untouched.
     */
    PZS_E_ARGUMENT = 64, /* Error: a pointer is NULL, or a size, an index or a setting is out of
                            range. */
    PZS_E_FORMAT,    /* Error: the tables have another format number than the library, or come from
                        another scene file than the tables with which they are used. */
    PZS_E_CRC,       /* Error: the tables do not match their checksum, so they are damaged or were
                        changed. */
    PZS_E_WORKSPACE, /* Error: the workspace (memory that the caller provides) is too small or
                        misaligned; info.where is the number of bytes needed. */
    PZS_E_STAGE,     /* Error: the function was called before the initialisation that it needs. */
    /*
     * Error: after an earlier error or alarm the supervisor keeps the voltages at the park
     * voltages, the safe voltages in its tables. Only pzs_loop_init starts the loop again.
     */
    PZS_E_LATCHED,
    PZS_E_NONFINITE, /* Error: an input array contains NaN or infinity at index info.where. */
    /*
     * Error: the lower limit of input info.where exceeds its upper limit, one of these limits is
     * not a number, or the park voltage of the input (safe voltage in the tables) is outside its
     * limits.
     */
    PZS_E_LIMITS,
    PZS_E_LOOSE, /* Error: the free degree of freedom info.where has no stiffness, because a part is
                    loose or a support is missing. */
    PZS_E_NEGATIVE,  /* Error: the stiffness matrix of the undeformed structure has a negative pivot
                        at the free degree of freedom info.where. */
    PZS_E_CONDITION, /* Error: the estimated condition number of the stiffness matrix exceeds what
                        this floating-point precision can solve. */
    PZS_E_RESIDUAL,  /* Error: iterative refinement ended with an estimated relative error of the
                        displacement above the square root of the machine epsilon. */

    /*
     * Errors of the equilibrium solver: the solver keeps the last converged equilibrium, and
     * info.load_factor tells where it lies on the way from the input values before the call (0) to
     * the wanted ones (dimensionless).
     */
    PZS_E_DIVERGED, /* Error: the load could not be raised beyond the last equilibrium, although
                       load steps were halved down to 1/64, or the voltages of open electrodes did
                       not converge. */
    PZS_E_LIMIT, /* Error: no equilibrium was found and the tangent stiffness becomes singular, so a
                    limit point or a bifurcation is near. */
    /*
     * Error: the set of nodes in contact with the rigid body kept changing from iteration to
     * iteration; or a shell that its supports leave loose does not touch the body at the start, is
     * not pressed onto the body, or slides along it.
     */
    PZS_E_CONTACT,
    /*
     * Error: the rigid contact body would enter element info.where, at a node or between its nodes,
     * or would pass through the element; info.penetration of the contact tells which. To be cured
     * by a finer mesh there or a larger body.
     */
    PZS_E_PENETRATION,
    PZS_E_SOLVES, /* Error: the limit on linear solves, settings.solve_limit, was reached before the
                     equilibrium. */
    /*
     * Error: the self-test found a faulty amplifier or sensor, or vibration hid the response of an
     * amplifier. The findings are in pzs_selftest_info, and the loop does not begin to control the
     * voltages.
     */
    PZS_E_SELFTEST,
    PZS_E_MASS,  /* Error: the free degree of freedom info.where has no mass. */
    PZS_E_MODES, /* Error: the vibration modes have not converged within the limit on linear solves;
                    info.where is the number of those that have. */
    PZS_E_MODE_COUNT, /* Error: more or fewer vibration modes lie below the last one than were
                         found: info.where of them, by a count of negative pivots. */
    PZS_E_CAPACITANCE /* Error: the open electrode info.where has no capacitance, or none of its own
                         beside the open electrodes before it. */
} pzs_status;

#define PZS_IS_ERROR(status) ((status) >= PZS_E_ARGUMENT)

/*
 * Return the text of a status, in one line. A program that does not call this function does not
 * link the texts.
 */
const char *pzs_status_text(pzs_status status);

/* ---- shared tables and matrices --------------------------------------- */

/*
 * Entry of the table pzs_structure.node_dof for a degree of freedom that a support keeps at zero.
 */
#define PZS_CONSTRAINED 0xFFFFu

/*
 * Entry of the table pzs_structure.node_turn for a node whose mean displacements (mean of both
 * faces of the shell) act along the axes of its own triad (local axes), not along axes of an
 * oblique support.
 */
#define PZS_UNTURNED 0xFFFFu

/*
 * Sparse matrix over the free degrees of freedom, row by row: one row for each input (a force
 * vector) or for each output (coefficients of the displacement).
 */
typedef struct pzs_rows {
    uint16_t count;
    const uint32_t *start; /* [count + 1] index of the first entry of each row of the sparse matrix;
                              the last element is the number of entries */
    const uint16_t *dof; /* [number of entries] column of each entry of the sparse matrix: the index
                            of a free degree of freedom */
    const pzs_real *value; /* [number of entries] values of the entries of the sparse matrix */
} pzs_rows;

/*
 * A symmetric matrix in envelope storage: the entries of each row of the lower triangle from its
 * first nonzero column to the diagonal. Dense, banded and skyline matrices are special cases.
 */
typedef struct pzs_envelope {
    uint32_t n;            /* number n of rows and columns of the symmetric matrix */
    const uint16_t *first; /* [n] column of the first stored entry in each row of the lower triangle
                              of the symmetric matrix */
    uint32_t *start;   /* [panels + 1] index in the array `value` at which each panel (a group of
                          PZS_TILE consecutive rows of the matrix) starts; the last element is the
                          length of `value` */
    pzs_real *value;   /* [start[panels]] stored entries of the symmetric matrix, panel by panel
                          (groups of PZS_TILE rows) */
    pzs_real *inverse; /* [n] reciprocals of the pivots of the symmetric matrix, valid after its L D
                          L^T factorisation */
} pzs_envelope;

/*
 * PZS_CEIL(n): n rounded up to a multiple of PZS_TILE. PZS_DENSE(n): number of reals that the
 * factor of a dense matrix of n rows takes in envelope storage, reciprocals of the pivots included.
 */
#define PZS_CEIL(n) (((size_t)(n) + PZS_TILE - 1u) / PZS_TILE * PZS_TILE)
#define PZS_DENSE(n) (PZS_CEIL(n) * (PZS_CEIL(n) + PZS_TILE) / 2u + (size_t)(n))

#ifdef __cplusplus
}
#endif
#endif
