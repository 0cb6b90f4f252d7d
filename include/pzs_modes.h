/*
 * piezoshape, vibration modes (build of the library for a device, with PZS_MODES=1): natural
 * frequencies and mode shapes of the structure of a linear or nonlinear image, in the undeformed
 * state or about the equilibrium that the nonlinear solver has found.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 * The modes are the lowest solutions of
 *   K x = w^2 M x,   x^T M x = 1
 *   K  stiffness matrix; at an equilibrium the tangent stiffness there, with the prestress
 *   M  mass matrix, the sum of the element matrices in pzs_mass
 *   x  mode shape over the free degrees of freedom;   w  angular frequency (rad/s)
 * Method: Lanczos on (K + shift M)^-1 M with full orthogonalisation in the product with M (B. N.
 * Parlett, The Symmetric Eigenvalue Problem, chapter 13), thick restarts (K. Wu, H. Simon, SIAM J.
 * Matrix Anal. Appl. 22, 2000) and new random vectors. Then the negative pivots of K - s M, with s
 * just above the last w^2, are counted: by Sylvester's law of inertia their number is that of the
 * modes below s, so that none is missing, not even one of several equal frequencies.
 *
 * Order of the calls: pzs_model_init, pzs_assemble, pzs_factor, pzs_modes_init, pzs_modes_find. At
 * an equilibrium: pzs_model_init, pzs_solver_init, pzs_modes_init, pzs_equilibrium,
 * pzs_modes_find_at.
 *
 * Electrodes have prescribed voltages, apart from those that pzs_modes_open_electrodes opens after
 * pzs_modes_init. Their voltages follow the displacement and stiffen the structure: K then stands
 * for K + B C^-1 B', with the forces B per volt on the open electrodes and their capacitances C.
 *
 * Accuracy: in double, squared frequencies agree with those of the host to rounding. In float, with
 * the element types in the tables, linear solves are refined and squared frequencies computed from
 * the strains; thin shells lose few digits (measured values: lib/modes/README.md). A mode shape has
 * an error of about settings.tolerance divided by the relative distance of its squared frequency
 * from the next.
 */
#ifndef PZS_MODES_H
#define PZS_MODES_H

#include "pzs_model.h"
#if PZS_NONLINEAR
#include "pzs_nonlinear.h"
#endif

#if PZS_MODES

#ifdef __cplusplus
extern "C" {
#endif

/* ---- mass tables ------------------------------------------------------ */

/*
 * Mass of a structure as element matrices, in the degrees of freedom of its element stiffness
 * matrices. All arrays are const and may stay in flash.
 */
typedef struct pzs_mass {
    uint32_t format, scene; /* format: format number of the mass tables; scene: hash of the scene
                               file from which they were generated; both must equal those in the
                               tables of the structure */
    uint32_t crc;   /* checksum of the mass tables and their arrays, computed by pzs_mass_seal */
    uint16_t types; /* number of different element mass matrices */
    const uint16_t *element_type; /* [elements] index of the mass matrix of each element */
    const pzs_real *matrix;       /* [types][rows * (rows + 1) / 2] element mass matrices (kg for
                                     mean displacements), packed lower triangles of 4 dof_per_node
                                     rows each; concentrated masses are part of them */
} pzs_mass;

/*
 * Write the format number and the checksum into mass tables that a firmware has built or changed
 * itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_mass_seal(pzs_mass *mass, const pzs_structure *structure);

/* ---- natural frequencies and mode shapes ------------------------------- */

/* Settings of the search for modes that a program may change after pzs_modes_init. */
typedef struct pzs_modes_settings {
    /*
     * squared angular frequency s >= 0 (rad2/s2) that is added as s M to the stiffness matrix;
     * default 0. A structure that can move as a rigid body, or an unstable equilibrium, needs a
     * value of about the highest wanted squared frequency
     */
    pzs_real shift;
    /*
     * residual of a mode, relative to its eigenvalue 1 / (w^2 + shift), at which it has converged;
     * between 0 and 1; default 1e-8 in double, 1e-4 in float. The error of a squared frequency is
     * about the square of this number
     */
    pzs_real tolerance;
    /*
     * [free_dof] vector from which the search begins, such as a mode shape before a small change of
     * the structure; default NULL: random vectors
     */
    const pzs_real *start;
    uint32_t solve_limit; /* largest number of linear solves in one call; default 100 + 20 times the
                             number of modes */
} pzs_modes_settings;

/* Results of the search for modes that a program may read. */
typedef struct pzs_modes_info {
    const pzs_real *square; /* [number] squared angular frequencies, ascending (rad2/s2); 0 for
                               rigid motions; negative for directions in which an equilibrium is
                               unstable */
    const pzs_real *shape;  /* [number][free_dof] mode shapes of unit modal mass, largest mean
                               displacement of a node positive */
    uint16_t number;        /* number of modes */
    uint16_t rigid;         /* number of rigid motions, which are the first modes */
    uint16_t converged;     /* number of modes that have converged; not less than `number` after
                               success */
    uint16_t below;  /* number of modes that the count of negative pivots has found below the bound;
                        equal to `converged` after success */
    uint16_t counts; /* number of counts of the negative pivots, each with two factorisations, and
                        a linear solve for each open electrode */
    uint32_t linear_solves; /* number of linear solves in the last call, those of the counts left
                               out */
    pzs_real condition;     /* estimated condition number of the scaled matrix K + shift M at
                               prescribed voltages; about an equilibrium it multiplies the rounding
                               errors of the result */
    int32_t where;          /* index to which the last status refers, or -1 */
} pzs_modes_info;

/*
 * Electrodes that are open while a structure vibrates, and two matrices with a row and a column for
 * each of them, both as factors L D L^T.
 */
typedef struct pzs_modes_electrodes {
    const pzs_electrodes *tables;
    uint16_t *electrode; /* [count] index of each open electrode in the tables */
    pzs_real *work;      /* [count] work of the force per volt on each open electrode on a
                            displacement (J/V) */
    pzs_real *voltage;   /* [count] voltage of each open electrode (V) */
    pzs_envelope held;   /* capacitances C while the shell cannot deform (C/V); during a count of
                            the modes the matrix below for the shift of the count */
    pzs_envelope moving; /* capacitances while the shell can deform, C + B' (K + shift M)^-1 B, with
                            the forces B per volt on each open electrode (C/V) */
    uint16_t count;      /* number of open electrodes */
} pzs_modes_electrodes;

typedef struct pzs_modes_state {
    pzs_model *model;
    const pzs_mass *mass;
    struct pzs_solver *solver; /* equilibrium solver about whose equilibrium the structure vibrates;
                                  not used in the undeformed state */
    const struct pzs_modes_calls *call; /* how the search assembles and solves */
    pzs_modes_electrodes open;          /* electrodes that are open while the structure vibrates */
    const struct pzs_modes_open_calls *open_call; /* functions of the open electrodes; NULL: no
                                                     electrode is open */
    pzs_real *force;      /* [free_dof] work array; not used where no electrode is open */
    pzs_real *basis;      /* [vectors][free_dof] Lanczos vectors, orthonormal with the mass matrix;
                             after success the first of them are the mode shapes */
    pzs_real *projection; /* [vectors][vectors] column j: products of the basis with the operator
                             times vector j */
    pzs_real *ritz;       /* [vectors][vectors] work array: projected matrix, then its eigenvalues
                             on the diagonal */
    pzs_real *turn;       /* [vectors][vectors] eigenvectors of the projected matrix, as columns */
    pzs_real *square;     /* [vectors] squared angular frequencies of the result */
    pzs_real *row;        /* [vectors] work array */
    uint16_t *order;  /* [vectors] columns of `turn` by descending eigenvalue of the projection */
    uint16_t vectors; /* number of Lanczos vectors for which there is memory */
    uint16_t made;    /* number of Lanczos vectors in `basis` */
    uint16_t done;    /* number of them to which the operator has been applied */
    uint32_t seed;    /* state of the generator of random numbers */
    pzs_real unit;    /* power of two that brings the eigenvalues of the operator near 1 */
    uint8_t stage;
} pzs_modes_state;

typedef struct pzs_modes {
    pzs_modes_settings settings;
    pzs_modes_info info;
    pzs_modes_state state;
} pzs_modes;

/*
 * Number of Lanczos vectors that suits a number of modes. More vectors need fewer linear solves;
 * fewer vectors, at least `modes` + 4, less memory.
 */
#define PZS_MODES_VECTORS(modes) (2u * (size_t)(modes) + 8u)

/* Size of the workspace of the search for modes with a number of Lanczos vectors (bytes). */
#define PZS_MODES_BYTES(free_dof, vectors)                                                         \
    (sizeof(pzs_real) * (size_t)(vectors) * ((size_t)(free_dof) + 3u * (size_t)(vectors) + 2u) +   \
     sizeof(uint16_t) * (size_t)(vectors))

/*
 * Check the mass tables and initialise the search for the lowest modes of a structure.
 *   modes   out     the search, with default settings
 *   model   in/out  an initialised model; must outlive the search
 *   mass    in      must outlive the search
 *   number  in      number of modes, 1 to the number of free degrees of freedom
 *   vectors in      number of Lanczos vectors, at least number + 4 or all free degrees of freedom;
 *                   equal frequencies beyond `number`, and rigid motions, need some more
 *   work    in      memory of the caller, aligned for pzs_real, at least PZS_MODES_BYTES
 * Errors: PZS_E_FORMAT, PZS_E_CRC, and
 *   PZS_E_ARGUMENT   also for an index out of range
 *   PZS_E_STAGE      the model is not initialised
 *   PZS_E_NONFINITE  info.where = element type of mass
 *   PZS_E_WORKSPACE  info.where = bytes needed
 */
pzs_status pzs_modes_init(pzs_modes *modes, pzs_model *model, const pzs_mass *mass, uint16_t number,
                          uint16_t vectors, void *work, size_t bytes);

/*
 * Size of the memory of the matrices of open electrodes, and of the workspace of
 * pzs_modes_open_electrodes (bytes).
 */
#define PZS_OPEN_MATRIX_BYTES(open)                                                                \
    (sizeof(pzs_real) * 2u * ((size_t)(open) + PZS_DENSE(open)) +                                  \
     sizeof(uint32_t) * ((size_t)(open) / PZS_TILE + 2u) + 2u * sizeof(uint16_t) * (size_t)(open))
#define PZS_MODES_OPEN_BYTES(free_dof, open)                                                       \
    (sizeof(pzs_real) * (size_t)(free_dof) + PZS_OPEN_MATRIX_BYTES(open))

/*
 * Open electrodes for the following searches, instead of those that an earlier call has opened: no
 * charge comes to them while the structure vibrates. A linear solve of the search then takes two;
 * settings.solve_limit becomes twice its default, and one solve more for each open electrode.
 *   tables  in  electrodes of the structure, with their capacitances; must outlive the search
 *   is_open in  [tables->count] nonzero: the electrode is open; NULL: as tables->open says. Without
 *               an open electrode the search has the bits of one without this call
 *   work    in  memory of the caller, aligned for pzs_real, at least PZS_MODES_OPEN_BYTES; not used
 *               where no electrode is open
 * Errors, with the index of an electrode in the tables:
 *   PZS_E_STAGE        the search is not initialised
 *   PZS_E_FORMAT, PZS_E_CRC
 *   PZS_E_ARGUMENT     also for an index out of range
 *   PZS_E_WORKSPACE    info.where = bytes needed
 *   PZS_E_NONFINITE    info.where = open electrode; one of its charges is NaN or infinite
 *   PZS_E_CAPACITANCE  info.where = open electrode
 *
 * After the last two no electrode is open; the others change nothing.
 */
pzs_status pzs_modes_open_electrodes(pzs_modes *modes, const pzs_electrodes *tables,
                                     const uint8_t *is_open, void *work, size_t bytes);

/*
 * Find the lowest modes in the undeformed state. With settings.shift 0 the search uses the factors
 * that pzs_factor has left in the model, and leaves the same factors there; otherwise the model
 * needs pzs_assemble afterwards. Stiffness factors and constrained degrees of freedom are those of
 * the last pzs_assemble. info.square and info.shape are valid after PZS_OK and after the warning.
 *
 * Warnings, errors:
 *   PZS_W_MODE_COUNT  The modes have converged, but the condition of the stiffness matrix is too
 *                     high in this precision to count them: a mode may be missing. A search from
 *                     further random vectors has found no other. Cure: double precision.
 *   PZS_E_ARGUMENT    also for a setting out of range or not finite
 *   PZS_E_STAGE       shift 0 and no factors in the model
 *   PZS_E_MASS        info.where = free degree of freedom without mass
 *   PZS_E_LOOSE, PZS_E_NEGATIVE, PZS_E_CONDITION  K + shift M cannot be factored; info.where = free
 *                     degree of freedom. Cure: a larger shift
 *   PZS_E_RESIDUAL    a linear solve could not be refined
 *   PZS_E_NONFINITE   a linear solve gave NaN or infinity
 *   PZS_E_MODES       not converged within settings.solve_limit; info.where = number of converged
 *                     modes. Cure: more Lanczos vectors, or a higher limit
 *   PZS_E_MODE_COUNT  info.where = number of modes below the bound by the count, which differs from
 *                     info.converged. Cure: one mode more or less, or a higher solve_limit
 */
pzs_status pzs_modes_find(pzs_modes *modes);

/*
 * Return the frequency of a mode that was found (Hz if the unit of time is the second); 0 where w^2
 * <= 0, and for an index out of range.
 */
pzs_real pzs_modes_frequency(const pzs_modes *modes, uint16_t mode);

/*
 * Compute the static value of each modal coordinate under a constant unit of each input: the work
 * of the input's force on the mode shape divided by w^2. For modes of pzs_modes_find_at the forces
 * are those at the equilibrium, zero for an input that prescribes displacements. The unit of an
 * open electrode is one of charge; the other inputs act while open electrodes have no charge.
 *   response [number][inputs] out  NAN for rigid motions
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE (no modes were found).
 */
pzs_status pzs_modes_response(const pzs_modes *modes, pzs_real *response);

#if PZS_NONLINEAR

/*
 * Find the lowest modes of small vibrations about the equilibrium that pzs_equilibrium has found,
 * from its tangent stiffness. Degrees of freedom with prescribed displacements do not vibrate; of
 * follower loads only the symmetric part of the stiffness counts; nodes in contact stay there. With
 * settings.shift 0 the model holds the factors of the tangent stiffness afterwards, as before;
 * otherwise pzs_equilibrium must be called before pzs_influence_at. Linear solves are not refined:
 * the condition number limits the accuracy in float.
 * Errors: those of pzs_modes_find, and
 *   PZS_E_ARGUMENT  also for a solver of another model
 *   PZS_E_STAGE     there is no equilibrium
 *   PZS_E_NEGATIVE  the equilibrium is unstable: it needs a shift
 */
pzs_status pzs_modes_find_at(pzs_modes *modes, pzs_solver *solver);

#endif

#ifdef __cplusplus
}
#endif
#endif
#endif
