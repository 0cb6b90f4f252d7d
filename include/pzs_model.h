/*
 * piezoshape, linear image: element matrices in flash to an influence matrix on the device.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 * Order of the calls: pzs_model_init, pzs_assemble, pzs_factor, pzs_influence, then
 * pzs_control_init with that influence. Stiffness, temperature, supports and electrodes may change
 * in the field. `pzs tables` generates the tables.
 */
#ifndef PZS_MODEL_H
#define PZS_MODEL_H

#include "pzs_base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- tables ----------------------------------------------------------- */

/*
 * One element type: all data of geometry and material that the element kernel needs; equal elements
 * share it. Corners r = 0..3 are (-,-) (+,-) (+,+) (-,+). Directions a = 0, 1 run along theta1,
 * theta2; r' is the neighbour of corner r in direction a. The displacement derivatives in the frame
 * of corner r are lam_a = S_a u_r + T_a u_r'. The formulation (published or improved) consists of
 * these values alone.
 */
typedef struct pzs_element_type {
    pzs_real s[4][2][3][3];   /* S of each corner and direction (1/m) */
    pzs_real t[4][2][3][3];   /* T of each corner and direction (1/m) */
    pzs_real g_mean[4][2][3]; /* base vectors at the corners, mean of the two faces (1) */
    pzs_real g_diff[4][2][3]; /* difference of the faces' base vectors over h (1/m) */
    /* stiffness D of the modes 00 01 10 11 (N m), packed lower triangle, times area/3^(r1+r2);
     * strain order 11m 11d 22m 22d 33m 33d 12m 12d 13 23, with m the mean and d the difference of
     * the two faces */
    pzs_real d[4][55];
    pzs_real thickness; /* thickness h of the element (m) */
    pzs_real warp[9]; /* factors of the strains that are added to the mean strain 12 of mode 00 on a
                         warped element (1): 12d^00, 13^01, 23^10, 13^00, 23^00, 11d^00, 11d^01,
                         22d^00, 22d^10. Their sum does not depend on the directors */
    pzs_real skew[3]; /* alpha_1, alpha_2 (1): the area varies as 1 + alpha_1 xi2 + alpha_2 xi1 over
                         the element, both are 0 on parallelograms and on elements along lines of
                         curvature; then L_2/L_1, the ratio of the element's lengths (1) */
} pzs_element_type;

/* A structure. All arrays are const and stay in flash. */
typedef struct pzs_structure {
    uint32_t format; /* PZS_TABLE_FORMAT */
    uint32_t scene;  /* hash of the scene that the tables were made from */
    uint32_t crc;    /* checksum of everything below; see pzs_structure_seal */
    uint16_t nodes, elements, types;
    uint16_t dof_per_node; /* dof per node, 7 or 6: mean u1 u2 u3, (u+ - u-)/h of u1 u2 u3, (u3M -
                              mean u3)/h */
    uint16_t free_dof;
    const uint16_t (*element)[4]; /* [elements] nodes of each element, in corner order */
    const uint16_t *element_type; /* [elements] type of each element */
    const uint16_t *node_dof;     /* [nodes][dof_per_node] free dof, or PZS_CONSTRAINED */
    const uint16_t *first_column; /* [free_dof] first column of each row of the lower triangle */
    const pzs_real *stiffness; /* [types][4u(4u+1)/2] element stiffness, packed lower triangle, u =
                                  dof_per_node */
    const pzs_element_type *type; /* [types] element types, or NULL: no refinement by strains and no
                                     nonlinear solver */
    pzs_rows input;               /* force of one unit of each input (N/V, N/K, N/Pa, 1) */
    pzs_rows output;              /* output per unit of the displacement (m) */
    pzs_rows spring; /* one row for each spring: its elongation per unit of the displacement (1);
                        count 0: no springs */
    const pzs_real *spring_stiffness; /* [spring.count] stiffness of each spring (N/m), not negative
                                       */
} pzs_structure;

/* Set format and checksum of tables that a firmware has built or changed itself. Errors: ARGUMENT.
 */
pzs_status pzs_structure_seal(pzs_structure *structure);

/* ---- model: structure to influence ------------------------------------ */

/* Results of the model that a program may read. */
typedef struct pzs_model_info {
    pzs_real condition; /* 1-norm condition estimate of the scaled stiffness */
    pzs_real residual; /* |K u - f| / |f| of the last solve, every row scaled as for the factor; K u
                          is computed from the strains of the elements, so that the value is -1
                          without element types */
    pzs_real error_estimate;  /* relative error of u by the linear solver, in the energy norm; -1
                                 without element types. The discretisation error of the mesh is not
                                 included */
    int32_t where;            /* index that belongs to the last status, or -1 */
    uint16_t refinements;     /* refinement iterations of the last solve */
    uint16_t negative_pivots; /* negative pivots of the last factorisation */
} pzs_model_info;

typedef struct pzs_model_state {
    const pzs_structure *structure;
    pzs_envelope stiffness;           /* scaled stiffness, then its factor */
    pzs_real *scale;                  /* [free_dof] powers of two that scale the diagonal to one */
    pzs_real *work;                   /* [6][free_dof] work */
    const pzs_real *stiffness_factor; /* [types] stiffness factors of the last assembly, or NULL */
    const uint8_t *constrained;       /* [free_dof] constrained dof of the last assembly, or NULL */
    uint8_t stage;
} pzs_model_state;

typedef struct pzs_model {
    pzs_model_info info;
    pzs_model_state state;
} pzs_model;

/*
 * Bytes of workspace for a model. `envelope` is the padded number of entries of the factor;
 * generated headers contain it for each PZS_TILE.
 */
#define PZS_MODEL_BYTES(free_dof, envelope)                                                        \
    (sizeof(pzs_real) * ((size_t)(envelope) + 8u * (size_t)(free_dof)) +                           \
     sizeof(uint32_t) * ((size_t)(free_dof) / PZS_TILE + 2u) + 2u * sizeof(pzs_real))

/*
 * Check the tables and lay out a model in the workspace.
 *   model     out
 *   structure in   must outlive the model
 *   work      in   memory of the caller, aligned for pzs_real
 *   bytes     in   at least PZS_MODEL_BYTES
 * Errors: ARGUMENT (also an index out of range), FORMAT, CRC, WORKSPACE (where = bytes needed).
 */
pzs_status pzs_model_init(pzs_model *model, const pzs_structure *structure, void *work,
                          size_t bytes);

/*
 * Sum the element matrices [P 10-16] and the springs in the envelope: K = sum_e P_e^T K_type(e) P_e
 * + sum_s k_s n_s n_s^T, with n_s the row of a spring and k_s its stiffness.
 *   stiffness_factor [types]    in  factor of the matrices of each element type; NULL: 1
 *   constrained      [free_dof] in  nonzero: this dof is held at zero in addition to the supports;
 *                                   NULL: none
 * Both arrays must outlive the following solves. Errors: ARGUMENT (also a negative factor), STAGE,
 * NONFINITE.
 */
pzs_status pzs_assemble(pzs_model *model, const pzs_real *stiffness_factor,
                        const uint8_t *constrained);

/*
 * Scale the stiffness to unit diagonal by powers of two, factor it as L D L^T and estimate its
 * condition number. Errors: STAGE, LOOSE and NEGATIVE (where = free dof), CONDITION: the estimate
 * exceeds 1.2/epsilon, or 600/epsilon where the structure has element types and solves are refined,
 * or 1e14.
 */
pzs_status pzs_factor(pzs_model *model);

/*
 * Displacement under the inputs: K u = sum_j value_j f_j, refined by strains where the structure
 * has element types.
 *   value [inputs]   in  (V, K, Pa or load factors)
 *   displacement     [free_dof] out (m and 1)
 * Errors: STAGE, NONFINITE, RESIDUAL (u is then the best result reached).
 */
pzs_status pzs_solve(pzs_model *model, const pzs_real *value, pzs_real *displacement);

/* Outputs of a displacement, y = output rows . u.  displacement [free_dof] in, output [outputs] out
 * (m) */
void pzs_observe(const pzs_structure *structure, const pzs_real *displacement, pzs_real *output);

/*
 * Influence matrix: outputs per unit of each input, by one solve for each column.
 *   influence [outputs][inputs] out (m/V)
 * Errors: those of pzs_solve (the columns before the failing input `where` are written).
 */
pzs_status pzs_influence(pzs_model *model, pzs_real *influence);

/* ---- electrodes: charges, sensors, open circuits (lib/model/electrode.c) */

/*
 * Electrodes whose charge is of interest. The charge of electrode k on its side towards +e3 is q_k
 * = f_k . u + sum_j direct(k, j) value_j, with f_k the force row of its input: sensing is the
 * transpose of actuation. All arrays are const, in flash.
 */
typedef struct pzs_electrodes {
    uint32_t format, scene; /* format and scene of the structure */
    uint32_t crc;           /* checksum of everything below; see pzs_electrodes_seal */
    uint16_t count;
    const uint16_t *input; /* [count] the input whose value is the electrode's voltage */
    const uint8_t *open;   /* [count] 1: open electrode, its charge is prescribed and its voltage
                              unknown; 0: its voltage is prescribed */
    pzs_rows direct; /* [count] rows: charge while the shell cannot deform, per unit of the input
                        `dof` (C/V, C/K): the capacitance for the electrode's own voltage, the
                        pyroelectric charge for a temperature */
} pzs_electrodes;

/* Set format and checksum of tables that a firmware has built or changed itself. Errors: ARGUMENT.
 */
pzs_status pzs_electrodes_seal(pzs_electrodes *tables, const pzs_structure *structure);

/* Settings of the electrodes that a program may change after pzs_electric_init. */
typedef struct pzs_electric_settings {
    pzs_real *charge; /* [count] prescribed charge of the open electrodes (C); default 0 */
} pzs_electric_settings;

typedef struct pzs_electric_info {
    int32_t where; /* index that belongs to the last status, or -1 */
} pzs_electric_info;

typedef struct pzs_electric_state {
    pzs_model *model;
    const pzs_electrodes *tables;
    pzs_real *sensitivity; /* [count][inputs] charge per unit of each input, all voltages prescribed
                              (C/V, C/K, C/N) */
    pzs_real *value;       /* [inputs] work */
    pzs_envelope open;     /* charge of the open electrodes per volt of one another, factored */
    uint8_t stage;
} pzs_electric_state;

typedef struct pzs_electric {
    pzs_electric_settings settings;
    pzs_electric_info info;
    pzs_electric_state state;
} pzs_electric;

/* Bytes of workspace for electrodes. */
#define PZS_ELECTRIC_BYTES(electrodes, open, inputs)                                               \
    (sizeof(pzs_real) *                                                                            \
         (((size_t)(electrodes) + 1u) * ((size_t)(inputs) + 1u) + PZS_DENSE(open)) +               \
     sizeof(uint32_t) * ((size_t)(open) / PZS_TILE + 2u) + sizeof(uint16_t) * (size_t)(open))

/*
 * Lay out electrodes in the workspace; model and tables must outlive them.
 * Errors: ARGUMENT, FORMAT, CRC, WORKSPACE (where = bytes needed).
 */
pzs_status pzs_electric_init(pzs_electric *electric, pzs_model *model, const pzs_electrodes *tables,
                             void *work, size_t bytes);

/*
 * Charge per unit of every input in the undeformed state [P 49-55], by one solve for each
 * electrode; to be called after each pzs_factor. Errors: ARGUMENT, STAGE, those of pzs_solve,
 * NEGATIVE: an open electrode without capacitance (where = electrode).
 */
pzs_status pzs_electric_factor(pzs_electric *electric);

/*
 * Voltages of the open electrodes for which their charges are as prescribed, under the other input
 * values. All input values can then be passed to pzs_solve.
 *   value [inputs] in/out  the voltages of open electrodes are written, not read
 * Errors: ARGUMENT, STAGE, NONFINITE.
 */
pzs_status pzs_open_voltages(const pzs_electric *electric, pzs_real *value);

/*
 * Charges of all electrodes under input values that include the voltages of open electrodes.
 *   value  [inputs] in
 *   charge [count]  out (C)
 * Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_charges(const pzs_electric *electric, const pzs_real *value, pzs_real *charge);

/*
 * Transform the influence under prescribed voltages into the influence with open electrodes.
 *   influence [outputs][inputs] in/out  in: of pzs_influence; out: columns of open electrodes per
 *   unit charge (m/C)
 * Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_influence_open(const pzs_electric *electric, pzs_real *influence);

#ifdef __cplusplus
}
#endif
#endif
