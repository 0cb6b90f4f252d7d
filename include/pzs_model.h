/*
 * piezoshape, linear image (build of the library for a device): computes the influence matrix on
 * the device from element matrices in flash, so that stiffness, temperature, supports and
 * electrodes may change in the field. `pzs tables` generates the tables.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 * Order of the calls: pzs_model_init, pzs_assemble, pzs_factor, pzs_influence (for open electrodes
 * see there), then pzs_loop_init or pzs_control_init with that influence matrix.
 */
#ifndef PZS_MODEL_H
#define PZS_MODEL_H

#include "pzs_base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- tables of the structure ----------------------------------------- */

/*
 * One element type: geometry and material of a four-node shell element; equal elements share one.
 * The formulations `published` (dissertation of Plotnikova, 2013) and `improved` differ only in
 * these numbers.
 *
 * Corners r = 0 to 3 lie at (-,-), (+,-), (+,+) and (-,+) along the surface coordinates theta1 and
 * theta2. The derivative of the displacement at corner r along theta_a is, in the local frame of r,
 *   S_a u_r + T_a u_r'
 *   r'          neighbour of corner r along theta_a
 *   u_r, u_r'   [3] displacements of both corners (m)
 *   S_a, T_a    [3][3] matrices (1/m)
 */
typedef struct pzs_element_type {
    /*
     * [4 corners][2 directions][3][3] matrix S of each corner and direction (1/m). S times the
     * displacement of the corner is the part of the derivative of the displacement, along theta1 or
     * theta2, that this corner causes
     */
    pzs_real s[4][2][3][3];
    /*
     * [4 corners][2 directions][3][3] matrix T of each corner and direction (1/m). T times the
     * displacement of the neighbouring corner in this direction is the part of the derivative of
     * the displacement, along theta1 or theta2, that this neighbour causes
     */
    pzs_real t[4][2][3][3];
    pzs_real g_mean[4][2][3]; /* [4 corners][2 directions][3] base vectors at each corner of the
                                 element along the surface coordinates theta1 and theta2, mean of
                                 outer and inner face of the shell (dimensionless) */
    pzs_real g_diff[4][2][3]; /* [4 corners][2 directions][3] difference of the base vectors at each
                                 corner of the element along theta1 and theta2: those of the outer
                                 face minus those of the inner face of the shell, divided by the
                                 thickness (1/m) */
    /*
     * Stiffness of the four strain modes of the element, as packed lower triangles, times
     * area/3^(a+b) (N m). Mode ab varies over the element as xi1^a xi2^b, with xi1 and xi2 from -1
     * to 1. Strains of each mode (m: mean, d: difference of both faces):
     *   mode 00  11m 11d 22m 22d 33m 33d 12m 12d 13 23 (55 entries)
     *   mode 01  11m 11d 33m 33d 13 (15 entries)
     *   mode 10  22m 22d 33m 33d 23 (15 entries)
     *   mode 11  33m 33d (3 entries)
     */
    pzs_real d[88];
    pzs_real thickness; /* thickness of the element (m) */
    /*
     * Straight lines a + b z/thickness that replace z^2 in the in-plane strains 11, 22 and 12, with
     * z the height above the middle of the shell: all a (m2), then all b (m2). The part of a strain
     * that is quadratic in z enters its mean with the factor a and its difference with the factor
     * b.
     */
    pzs_real height_squared[2][3];
    /*
     * Correction of the shear strain of a warped (not plane) element: nine factors (dimensionless).
     * The sum of factor times strain is added to the mean of strain 12 in mode 00. The strains are,
     * with modes as in member `d` and the difference of both faces:
     *   [0]        difference of strain 12, mode 00
     *   [1], [2]   strain 13, mode 01; strain 23, mode 10
     *   [3], [4]   strain 13, mode 00; strain 23, mode 00
     *   [5], [6]   difference of strain 11, modes 00 and 01
     *   [7], [8]   difference of strain 22, modes 00 and 10
     */
    pzs_real warp[9];
    /*
     * skew alpha_1, alpha_2 of the element, 0 on a parallelogram, and its length along theta2
     * divided by that along theta1 (dimensionless). The area varies over the element as 1 + alpha_1
     * xi2 + alpha_2 xi1, where xi1 and xi2 run from -1 to 1
     */
    pzs_real skew[3];
} pzs_element_type;

/* One node of a shell: its place in space and its triad (local axes). */
typedef struct pzs_node {
    pzs_real position[3]; /* coordinates x, y, z of the node on the reference surface (m); all nodes
                             of a shell have the same origin */
    pzs_real triad[3][3]; /* components along x, y, z of the unit vectors e1, e2, e3 (rows) of the
                             local axes of the node; e3 points to the outer face of the shell */
} pzs_node;

/*
 * One element type in a short form of 110 instead of 299 reals, for meshes on which nearly every
 * element is a type of its own. The library computes the missing members s, t, g_mean and g_diff of
 * pzs_element_type, to the same bits, from the nodes of one element of the type.
 */
typedef struct pzs_compact_type {
    pzs_real d[88];     /* stiffness of the four strain modes (variations over the element) of an
                           element type, as in pzs_element_type.d (N m) */
    pzs_real thickness; /* thickness of the element (m) */
    pzs_real height_squared[2][3]; /* numbers that replace the squared height z^2 in the in-plane
                                      strains 11, 22 and 12 (m2), as pzs_element_type.height_squared
                                      defines them */
    pzs_real middle;  /* height of the middle of the shell above the reference surface, on which
                         the nodes lie (m) */
    pzs_real warp[9]; /* factors that correct the shear strain of a warped (not plane) element, as
                         pzs_element_type.warp defines them (dimensionless) */
    pzs_real skew[3]; /* skew alpha_1, alpha_2 of the element and its length ratio, as
                         pzs_element_type.skew defines them (dimensionless) */
    pzs_real inverse_length[2]; /* 1 divided by the length of the element along theta1 and along
                                   theta2 (1/m) */
    uint16_t corner[4]; /* indices of the nodes at the four corners of one element of the compact
                           type; from these nodes the library computes the parts that the type
                           leaves out */
} pzs_compact_type;

/*
 * A shell structure: mesh, supports, element matrices, inputs and outputs. All arrays are const and
 * may stay in flash.
 */
typedef struct pzs_structure {
    uint32_t format; /* format number of the tables of the structure, PZS_TABLE_FORMAT */
    uint32_t scene;  /* hash of the scene file from which the tables of the structure were generated
                      */
    uint32_t crc;    /* checksum of the tables of the structure and their arrays, computed by
                        pzs_structure_seal */
    uint16_t nodes, elements, types;
    /*
     * number of degrees of freedom of a node, 6 or 7: displacement u1 u2 u3, mean of both faces of
     * the shell (m); (displacement of the outer face - that of the inner face) / thickness for u1
     * u2 u3 (dimensionless); with 7 also (u3 of the middle surface - mean u3 of the faces) /
     * thickness (dimensionless)
     */
    uint16_t dof_per_node;
    uint16_t free_dof;
    const uint16_t (*element)[4]; /* [elements] indices of the nodes at the four corners of each
                                     element, in the order of the corners in pzs_element_type */
    const uint16_t *element_type; /* [elements] index of the element type of each element */
    const uint16_t *node_dof;     /* [nodes][dof_per_node] index of each degree of freedom of a node
                                     among the free degrees of freedom, or PZS_CONSTRAINED */
    const uint16_t *first_column; /* [free_dof] column of the first stored entry in each row of the
                                     stiffness matrix */
    const pzs_real *stiffness;    /* [types][rows * (rows + 1) / 2] stiffness matrix of each element
                                     type, a packed lower triangle of 4 dof_per_node rows; NULL:
                                     pzs_assemble computes each matrix from its element type */
    const pzs_element_type *type; /* [types] geometry and material of each element type; where this
                                     member and `compact` are NULL, the model solves without
                                     iterative refinement, the nonlinear solver cannot be used, and
                                     `stiffness` must not be NULL */
    const pzs_compact_type *compact; /* [types] element types without the matrices and base vectors
                                        that the library computes from the nodes; not used where
                                        `type` is not NULL */
    const pzs_node *node; /* [nodes] nodes of the structure, from which the library computes the
                             matrices and base vectors that the element types in `compact` leave
                             out; NULL where `compact` is NULL */
    pzs_rows input;  /* one row for each input: force vector on the free degrees of freedom per unit
                        of the input (N/V, N/K, N/Pa or 1) */
    pzs_rows output; /* one row for each output, a displacement at a chosen point (m): coefficients
                        of the free degrees of freedom in the output */
    pzs_rows spring; /* one row for each spring: its elongation per unit of each free degree of
                        freedom (dimensionless); count 0: no springs */
    const pzs_real *spring_stiffness; /* [spring.count] stiffness of each spring (N/m), at least 0
                                       */
    /*
     * Rotated axes at the nodes of oblique supports. The first three degrees of freedom of such a
     * node are its mean displacements (mean of both faces of the shell) along these axes, not along
     * the triad (local axes) of the node.
     */
    uint16_t turns; /* number of different sets of rotated axes, along which the displacements of
                       nodes at oblique supports are counted */
    const uint16_t *node_turn;    /* [nodes] index of the set of rotated axes of each node, or
                                     PZS_UNTURNED; not read where `turns` is 0 */
    const pzs_real (*turn)[3][3]; /* [turns] rotation matrices, one for each set of rotated axes at
                                     oblique supports: each row is an axis, a unit vector in
                                     components along the triad (local axes) of the node */
} pzs_structure;

/*
 * Write the format number and the checksum into a structure that a firmware has built or changed
 * itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_structure_seal(pzs_structure *structure);

/* ---- model: from the structure to its influence matrix --------------- */

/* Results of the finite-element model that a program may read. */
typedef struct pzs_model_info {
    pzs_real condition; /* estimated condition number of the scaled stiffness matrix in the 1-norm
                         */
    /*
     * residual of the last solve: norm of (stiffness times displacement - force) divided by the
     * norm of the force, with scaled matrix rows, computed from the strains of the elements; -1
     * where the structure contains stiffness matrices alone and no element types
     */
    pzs_real residual;
    pzs_real error_estimate; /* estimated relative error of the last solution in the energy norm,
                                without the discretisation error of the mesh; -1 where the structure
                                contains stiffness matrices alone and no element types */
    int32_t where; /* index to which the last status of the model refers, for example of a free
                      degree of freedom, or -1 */
    uint16_t refinements;     /* number of iterations that refined the last solution of the linear
                                 equations */
    uint16_t negative_pivots; /* number of negative pivots in the last factorisation of the
                                 stiffness matrix */
} pzs_model_info;

typedef struct pzs_model_state {
    const pzs_structure *structure;
    pzs_envelope stiffness; /* scaled stiffness matrix of the model; after pzs_factor the factors of
                               this matrix */
    pzs_real *scale; /* [free_dof] powers of two that scale the diagonal of the stiffness matrix to
                        about one */
    pzs_real *work; /* [6][free_dof] work array of six vectors for the linear solves of the model */
    const pzs_real *stiffness_factor; /* [types] factor of the stiffness matrix of each element
                                         type, as passed to the last pzs_assemble; NULL: all 1 */
    pzs_element_type *rebuilt;  /* element type whose matrices and base vectors were last computed
                                   from the nodes; not used where the tables hold them for all
                                   element types */
    const uint8_t *constrained; /* [free_dof] nonzero: this degree of freedom is kept at zero
                                   although no support does so, as demanded in the last
                                   pzs_assemble; NULL: none is */
    const struct pzs_model_term *term; /* matrix that the factors contain in addition to the
                                          stiffness matrix, or NULL */
    uint8_t stage;
} pzs_model_state;

typedef struct pzs_model {
    pzs_model_info info;
    pzs_model_state state;
} pzs_model;

/*
 * Size of the workspace of a finite-element model (bytes). A structure with element types in the
 * short form pzs_compact_type needs PZS_COMPACT_BYTES more.
 *   envelope  number of stored entries of its stiffness matrix, padding included; generated headers
 *             define it for each value of PZS_TILE
 */
#define PZS_MODEL_BYTES(free_dof, envelope)                                                        \
    (sizeof(pzs_real) * ((size_t)(envelope) + 8u * (size_t)(free_dof)) +                           \
     sizeof(uint32_t) * ((size_t)(free_dof) / PZS_TILE + 2u) + 2u * sizeof(pzs_real))

/*
 * Bytes of the workspace of a model in which the library computes the parts that the tables of an
 * element type leave out (pzs_compact_type).
 */
#define PZS_COMPACT_BYTES                                                                          \
    (sizeof(pzs_real) * (sizeof(pzs_element_type) / sizeof(((pzs_element_type *)0)->thickness)))

/*
 * Check the tables of a structure and initialise a model in the workspace.
 *   model     out  the model
 *   structure in   must outlive the model
 *   work      in   memory of the caller, aligned for pzs_real; the model uses it from now on
 *   bytes     in   size of the workspace, at least PZS_MODEL_BYTES; with element types given as
 *                  pzs_compact_type PZS_COMPACT_BYTES more
 * Errors: PZS_E_ARGUMENT (also for an index out of range), PZS_E_FORMAT, PZS_E_CRC, PZS_E_WORKSPACE
 * (info.where = bytes needed).
 */
pzs_status pzs_model_init(pzs_model *model, const pzs_structure *structure, void *work,
                          size_t bytes);

/*
 * Assemble the stiffness matrix of the structure from those of its elements and from the springs
 * (equations 10-16 of Plotnikova 2013). Both arrays must outlive the following solves.
 *   stiffness_factor [types]    in  factor of the matrix of each element type; NULL: all 1
 *   constrained      [free_dof] in  nonzero: this degree of freedom is kept at zero in addition to
 *                                   those of the supports; NULL: none
 * Errors: PZS_E_ARGUMENT (also for a negative factor), PZS_E_STAGE, PZS_E_NONFINITE.
 */
pzs_status pzs_assemble(pzs_model *model, const pzs_real *stiffness_factor,
                        const uint8_t *constrained);

/*
 * Scale the stiffness matrix of a model to unit diagonal by powers of two, factor it as L D L^T,
 * and estimate its condition number. Errors: PZS_E_STAGE, and
 *   PZS_E_LOOSE, PZS_E_NEGATIVE  info.where = free degree of freedom
 *   PZS_E_CONDITION              The estimate exceeds 1e14, or 1.2 / machine epsilon (600 / machine
 *                                epsilon where pzs_solve refines solutions iteratively).
 */
pzs_status pzs_factor(pzs_model *model);

/*
 * Compute the displacement under given input values. If the tables contain the element types of the
 * structure, the solution is refined iteratively with residuals computed from the strains.
 *   value        [inputs]   in   input values (V, K, Pa or load factors)
 *   displacement [free_dof] out  displacements of the free degrees of freedom: means over the
 *                                thickness (m) and differences over the thickness divided by it
 *                                (dimensionless)
 * Errors: PZS_E_STAGE, PZS_E_NONFINITE, PZS_E_RESIDUAL (`displacement` is the best that was
 * reached).
 */
pzs_status pzs_solve(pzs_model *model, const pzs_real *value, pzs_real *displacement);

/*
 * Compute the outputs of the structure, which are displacements at chosen points, from the
 * displacement of its free degrees of freedom.
 *   displacement [free_dof] in   displacement (m, or 1 for differences over the thickness)
 *   output       [outputs]  out  outputs (m)
 */
void pzs_observe(const pzs_structure *structure, const pzs_real *displacement, pzs_real *output);

/*
 * Compute the influence matrix of a structure, the outputs per unit of each input, by one solve for
 * each input. If some electrodes are open, pzs_electric_factor and pzs_influence_open must follow.
 *   influence [outputs][inputs] out  influence matrix (m/V), with PREFIX_ALL_OUTPUTS rows and
 *                                    PREFIX_ALL_INPUTS columns of generated tables
 * Errors: those of pzs_solve; the columns of the inputs before info.where are then written.
 *
 * The controller needs only the upper left part, PREFIX_OUTPUTS target nodes by PREFIX_INPUTS
 * amplifiers: copy it to a matrix of its own if it is smaller.
 */
pzs_status pzs_influence(pzs_model *model, pzs_real *influence);

/* ---- electrodes: charges, sensors, open circuits (lib/model/electrode.c) */

/*
 * Tables of electrodes whose charge is measured (sensors) or prescribed (open electrodes). The
 * charge is that on the side towards the normal e3. All arrays are const and may stay in flash.
 *   charge = force vector of the electrode's input . displacement  (sensing is the transpose of
 *            actuation) + charge that flows while the shell cannot deform
 */
typedef struct pzs_electrodes {
    uint32_t format, scene; /* format: format number of the electrode tables; scene: hash of the
                               scene file from which they were generated; both must equal those in
                               the tables of the structure */
    uint32_t crc;           /* checksum of the electrode tables and their arrays, computed by
                               pzs_electrodes_seal */
    uint16_t count;
    const uint16_t *input; /* [count] index of the input whose value is the voltage of the electrode
                            */
    const uint8_t *open; /* [count] 1: open electrode, whose charge is prescribed and whose voltage
                            is unknown; 0: electrode of prescribed voltage */
    /*
     * one row for each electrode: charge per unit of an input while the shell cannot deform (C/V or
     * C/K); the member dof holds the indices of the inputs. For the electrode's own voltage this
     * charge is the capacitance, for a temperature the pyroelectric charge
     */
    pzs_rows direct;
} pzs_electrodes;

/*
 * Write the format number and the checksum into electrode tables that a firmware has built or
 * changed itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_electrodes_seal(pzs_electrodes *tables, const pzs_structure *structure);

/* Settings of the electrodes of a structure that a program may change after pzs_electric_init. */
typedef struct pzs_electric_settings {
    pzs_real *charge; /* [count] prescribed charge of each open electrode (C); default 0 */
} pzs_electric_settings;

typedef struct pzs_electric_info {
    int32_t where; /* index of the electrode, input or array entry to which the last status refers,
                      or -1 */
} pzs_electric_info;

typedef struct pzs_electric_state {
    pzs_model *model;
    const pzs_electrodes *tables;
    pzs_real *sensitivity; /* [count][inputs] charge of each electrode per unit of each input while
                              all voltages are prescribed (C/V, C/K or C/N) */
    pzs_real *value;       /* [inputs] work array with an entry for each input of the structure */
    pzs_envelope open;     /* L D L^T factors of a matrix with a row and a column for each open
                              electrode: charge of the electrode in the row per volt on the
                              electrode in the column (C/V) */
    uint8_t stage;
} pzs_electric_state;

typedef struct pzs_electric {
    pzs_electric_settings settings;
    pzs_electric_info info;
    pzs_electric_state state;
} pzs_electric;

/* Size of the workspace for computations of charges and voltages of electrodes (bytes). */
#define PZS_ELECTRIC_BYTES(electrodes, open, inputs)                                               \
    (sizeof(pzs_real) *                                                                            \
         (((size_t)(electrodes) + 1u) * ((size_t)(inputs) + 1u) + PZS_DENSE(open)) +               \
     sizeof(uint32_t) * ((size_t)(open) / PZS_TILE + 2u) + sizeof(uint16_t) * (size_t)(open))

/*
 * Initialise the electrodes of a model in the workspace; model and tables must outlive them.
 * Errors: PZS_E_ARGUMENT, PZS_E_FORMAT, PZS_E_CRC, PZS_E_WORKSPACE (info.where = bytes needed).
 */
pzs_status pzs_electric_init(pzs_electric *electric, pzs_model *model, const pzs_electrodes *tables,
                             void *work, size_t bytes);

/*
 * Compute the charge of each electrode per unit of every input in the undeformed state (equations
 * 49-55 of Plotnikova 2013), by one solve for each electrode. To be called after each pzs_factor.
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE, those of pzs_solve, and
 *   PZS_E_NEGATIVE  open electrode info.where has no capacitance
 */
pzs_status pzs_electric_factor(pzs_electric *electric);

/*
 * Compute the voltages at which the open electrodes carry their prescribed charges, under the other
 * input values. The input values with these voltages may then be passed to pzs_solve.
 *   value [inputs] in/out  input values; those of open electrodes are written, not read
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE, PZS_E_NONFINITE.
 */
pzs_status pzs_open_voltages(const pzs_electric *electric, pzs_real *value);

/*
 * Compute the charges of all electrodes under given input values, among which are the voltages of
 * the open electrodes.
 *   value  [inputs] in   input values
 *   charge [count]  out  charges of the electrodes (C)
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 */
pzs_status pzs_charges(const pzs_electric *electric, const pzs_real *value, pzs_real *charge);

/*
 * Transform the influence matrix for prescribed voltages into the influence matrix of a structure
 * with open electrodes.
 *   influence [outputs][inputs] in/out  in: result of pzs_influence (m/V); out: the columns of open
 *                                       electrodes are per unit of charge (m/C)
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 */
pzs_status pzs_influence_open(const pzs_electric *electric, pzs_real *influence);

#ifdef __cplusplus
}
#endif
#endif
