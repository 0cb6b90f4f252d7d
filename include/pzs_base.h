/*
 * What all parts of piezoshape share: numbers, statuses, sparse rows, symmetric matrices.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 * All memory belongs to the caller. Nothing in the library allocates, prints, recurses or keeps a
 * global variable. Arrays are row-major. Units are those of the scene; comments write m, N, V, K
 * for them. Every function leaves its outputs untouched when it returns an error (PZS_E_...),
 * except where its comment says so. After a warning (PZS_W_...) the outputs are valid. [P n] names
 * the equations of S. V. Plotnikova's dissertation (Tambov 2013) that a part implements.
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
 * The names of the three init functions contain the precision, so a program and a library of
 * different precision do not link.
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

/* A number of a generated table, rounded once from double to pzs_real. */
#define PZS_R(x) ((pzs_real)(x))

#if PZS_TILE == 4
#define PZS_BY_TILE(for4, for8, for16) (for4)
#elif PZS_TILE == 8
#define PZS_BY_TILE(for4, for8, for16) (for8)
#else
#define PZS_BY_TILE(for4, for8, for16) (for16)
#endif

/*
 * Most bytes of stack that a public function uses: in a control or linear image, and in a nonlinear
 * image.
 */
#define PZS_STACK_LINEAR (256u * sizeof(pzs_real))
#define PZS_STACK_NONLINEAR (2176u * sizeof(pzs_real))

/* Version of the linked library: the PZS_VERSION_TEXT with which it was compiled. */
const char *pzs_version(void);

/* ---- statuses --------------------------------------------------------- */

typedef enum pzs_status {
    PZS_OK = 0,

    /* Warnings: the result is valid, but the caller should be told. */
    PZS_W_ITERATIONS = 1, /* iteration limit reached: the voltages are feasible and no worse than
                             before, not optimal */
    PZS_W_STEP_LIMIT, /* step limit and voltage limits of input `where` do not overlap: the voltage
                         limit takes precedence */
    PZS_W_SENSOR,     /* measurement `where` is missing or stuck: its last disturbance is kept */
    PZS_W_HELD,       /* no usable measurement or target: the last safe voltages are held */
    PZS_W_ELECTRODE,  /* electrode `where` does not follow its amplifier: it is held from now on */
    /* The equilibrium is in contact, but a part of the shell that faces away from the body lies in
       it: the shell has passed through itself, or both of its faces would touch. */
    PZS_W_BEHIND,
    PZS_W_UNSTABLE, /* the equilibrium is unstable: the tangent has negative pivots */
    PZS_W_PARKED, /* the supervisor keeps the output at its park voltages, or ramps it there, as it
                     was told; the loop is not in control */
    PZS_W_RAMP,   /* the supervisor has taken control away and ramps the output to its park
                     voltages; LATCHED follows */
    PZS_W_OUTPUT, /* the last gate has corrected the voltage of input `where`: it was not a number,
                     or beyond its limits, because working memory was damaged */

    /* Errors: outputs are untouched. */
    PZS_E_ARGUMENT = 64, /* a null pointer, or a size, index or setting out of range */
    PZS_E_FORMAT,    /* the tables have another format number, or belong to another scene than the
                        tables they are used with */
    PZS_E_CRC,       /* the tables do not match their checksum */
    PZS_E_WORKSPACE, /* workspace too small or misaligned; `where` is the number of bytes needed */
    PZS_E_STAGE,     /* a function was called before the stage of initialisation that it needs */
    PZS_E_LATCHED,   /* the supervisor has taken control away; the output is at its park voltages,
                        and only an init starts the loop again */
    PZS_E_NONFINITE, /* NaN or infinity at index `where` of an input array */
    PZS_E_LIMITS,    /* lower limit above upper limit, or a limit that is not a number, at input
                        `where` */
    PZS_E_LOOSE,     /* no stiffness at free dof `where`: a loose part, or a missing support */
    PZS_E_NEGATIVE,  /* negative pivot at free dof `where` of a structure in its reference state */
    PZS_E_CONDITION, /* the condition estimate is above what this precision can solve */
    PZS_E_RESIDUAL,  /* iterative refinement ended with an estimated error above the square root of
                        epsilon */

    /* Solver errors: the last converged equilibrium is kept; info.load_factor tells how much of the
       load it carries. */
    PZS_E_DIVERGED,    /* no equilibrium was found beyond it with load steps down to 1/64 (or open
                          electrodes kept changing) */
    PZS_E_LIMIT,       /* as PZS_E_DIVERGED, and the tangent becomes singular: a limit point or a
                          bifurcation is near */
    PZS_E_CONTACT,     /* as PZS_E_DIVERGED, and the active set of contact kept changing; or a shell
                          that its supports leave loose does not touch the body at the start, is not
                          pressed onto it, or slides along it */
    PZS_E_PENETRATION, /* as PZS_E_DIVERGED: the body would enter element `where` at a node or
                          between its nodes (refine the mesh there or enlarge the body), or pass
                          through it; contact info.penetration tells which */
    PZS_E_SOLVES       /* the limit on linear solves is reached */
} pzs_status;

#define PZS_IS_ERROR(status) ((status) >= PZS_E_ARGUMENT)

/* Text of a status in one line. The texts are linked only where this function is called. */
const char *pzs_status_text(pzs_status status);

/* ---- shared tables and matrices --------------------------------------- */

/* Value in node_dof of a dof that a support holds at zero. */
#define PZS_CONSTRAINED 0xFFFFu

/*
 * Sparse rows over the free dof: one row for each input (a force) or each output (a displacement).
 */
typedef struct pzs_rows {
    uint16_t count;        /* number of rows */
    const uint32_t *start; /* [count + 1] first entry of each row */
    const uint16_t *dof;   /* [start[count]] free dof of each entry */
    const pzs_real *value; /* [start[count]] value of each entry */
} pzs_rows;

/* A symmetric matrix in envelope storage, which serves dense, banded and skyline matrices alike. */
typedef struct pzs_envelope {
    uint32_t n;            /* number of rows */
    const uint16_t *first; /* [n] first column of each row of the lower triangle */
    uint32_t *start;       /* [panels + 1] start of each panel of PZS_TILE rows in value */
    pzs_real *value;       /* [start[panels]] entries, panel by panel */
    pzs_real *inverse;     /* [n] inverse pivots, after factorisation */
} pzs_envelope;

/* n rounded up to whole tiles; number of reals of a dense factor of n rows. */
#define PZS_CEIL(n) (((size_t)(n) + PZS_TILE - 1u) / PZS_TILE * PZS_TILE)
#define PZS_DENSE(n) (PZS_CEIL(n) * (PZS_CEIL(n) + PZS_TILE) / 2u + (size_t)(n))

#ifdef __cplusplus
}
#endif
#endif
