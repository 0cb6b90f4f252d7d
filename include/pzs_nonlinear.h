/*
 * piezoshape, nonlinear image (build of the library for a device, with PZS_NONLINEAR=1):
 * equilibrium of the shell at large rotation, and the influence matrix at the deformed shape.
 * Options: follower loads, open electrodes, contact.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 * Order of the calls: pzs_model_init, pzs_solver_init, pzs_attach_... for the options,
 * pzs_equilibrium, pzs_influence_at, then pzs_control_init with that influence matrix.
 */
#ifndef PZS_NONLINEAR_H
#define PZS_NONLINEAR_H

#include "pzs_model.h"

#if PZS_NONLINEAR

#ifdef __cplusplus
extern "C" {
#endif

/* ---- tables of the nonlinear solver ---------------------------------- */

/*
 * Prescribed stress resultants of the inputs: piezoelectric actuation and temperature, which turn
 * with the shell. A load that keeps its direction is a row of pzs_structure.input instead.
 */
typedef struct pzs_prescribed_resultants {
    /*
     * number of rows of the array `value`, each with the ten stress resultants that an input
     * prescribes on an element; elements with equal resultants share a row
     */
    uint16_t values;
    /*
     * [inputs + 1] index, in the arrays `element` and `which`, of the first element on which each
     * input acts by prescribed stress resultants. An input that acts on no element in this way is a
     * load
     */
    const uint32_t *start;
    const uint16_t *element; /* [start[inputs]] indices of the elements on which an input acts by
                                prescribed stress resultants, one input after the other */
    /*
     * [start[inputs]] for each entry of the array `element`, the row of the array `value` that
     * holds the stress resultants which the input prescribes on this element
     */
    const uint16_t *which;
    const pzs_real (*value)[10]; /* [values] rows of prescribed stress resultants per unit of an
                                    input, times the area of the element (N m), in the strain
                                    order of pzs_element_type.d. The array `which` tells the row
                                    for each element on which an input acts */
} pzs_prescribed_resultants;

/*
 * Degrees of freedom whose displacement an input prescribes: the value of the input times a
 * constant for each of them. They are listed among the free degrees of freedom of the structure,
 * because no support fixes them.
 */
typedef struct pzs_prescribed_motion {
    uint16_t count;
    uint16_t input; /* index of the input whose value scales the prescribed displacements of some
                       degrees of freedom; the tables of the structure contain no force entries
                       for this input */
    const uint16_t *dof;   /* [count] indices of the free degrees of freedom whose displacement is
                              prescribed */
    const pzs_real *value; /* [count] prescribed displacement of each degree of freedom in the array
                              `dof` per unit of the input `input` (m or 1) */
} pzs_prescribed_motion;

/*
 * Tables of the nonlinear solver, in addition to those of the structure, which must contain its
 * element types (pzs_element_type or pzs_compact_type). All arrays are const and may stay in flash.
 */
typedef struct pzs_nonlinear {
    uint32_t format, scene; /* format: format number of the nonlinear tables; scene: hash of the
                               scene file from which they were generated; both must equal those in
                               the tables of the structure */
    uint32_t crc; /* checksum of the nonlinear solver's tables and their arrays, computed by
                     pzs_nonlinear_seal */
    pzs_prescribed_resultants resultants;
    pzs_prescribed_motion prescribed;
} pzs_nonlinear;

/*
 * Write the format number and the checksum into nonlinear tables that a firmware has built or
 * changed itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_nonlinear_seal(pzs_nonlinear *tables, const pzs_structure *structure);

/* ---- equilibrium solver ----------------------------------------------- */

/*
 * An option of the equilibrium solver: a follower load, a circuit of open electrodes, or a contact.
 */
typedef struct pzs_solver_option {
    struct pzs_solver_option *next;
    const struct pzs_solver_option_calls *call;
} pzs_solver_option;

/* Settings of the equilibrium solver that a program may change after pzs_solver_init. */
typedef struct pzs_solver_settings {
    /*
     * convergence tolerance between 0 and 1: largest norm of the last increment of the
     * displacement, and of the predicted next one, relative to the displacement of the load step;
     * default 1e-4
     */
    pzs_real tolerance;
    uint16_t load_steps; /* number of load steps into which the equilibrium solver first divides the
                            way from the present input values to the wanted ones; default 1 */
    /*
     * number of iterations of a load step in which Newton's method extrapolates the stress
     * resultants along the last increment of the displacement; later iterations use those of the
     * present displacement; default 12; 0: plain Newton method
     */
    uint16_t extrapolated_iterations;
    /*
     * number of linear solves, at the start of a load step, over which the input values rise in
     * equal parts to their values at the end of the load step; default 1
     */
    uint16_t ramp_solves;
    uint32_t solve_limit; /* largest number of linear solves in one call of pzs_equilibrium; default
                             400 */
} pzs_solver_settings;

/* Results of the equilibrium solver that a program may read. */
typedef struct pzs_solver_info {
    const pzs_real *displacement; /* [free_dof] displacement of the equilibrium that was reached (m,
                                     or 1 for differences over the thickness) */
    const pzs_real *input_value;  /* [inputs] input values of the equilibrium that was reached, with
                                     the voltages of open electrodes */
    pzs_real load_factor; /* part (0 to 1) of the way from the previous equilibrium to the wanted
                             input values that the solver has reached */
    pzs_real residual; /* norm of the force imbalance divided by the norm of the applied force; both
                          norms weigh each force with the scale factor of its matrix row
                          (dimensionless) */
    pzs_real relative_increment; /* norm of the last increment of the displacement divided by the
                                    norm of the displacement of the load step (dimensionless) */
    uint32_t linear_solves;      /* number of linear solves in the last call of pzs_equilibrium */
    uint32_t load_steps; /* number of converged load steps in the last call of pzs_equilibrium */
    uint32_t shortened_steps; /* number of converged load steps in the last call of pzs_equilibrium
                                 that were shortened to limit the motion of the contact body */
    uint32_t negative_pivots; /* number of negative pivots of the tangent stiffness at the
                                 equilibrium; 0: stable */
    int32_t where; /* index to which the last status of the equilibrium solver refers, for example
                      of an element or an input, or -1 */
} pzs_solver_info;

typedef struct pzs_solver_state {
    pzs_model *model;
    const pzs_nonlinear *tables;
    pzs_solver_option *option;  /* first option of the equilibrium solver (such as a contact) in the
                                   linked list of its options, or NULL */
    pzs_real *displacement;     /* [free_dof] present displacement of the solver (m, or 1 for
                                   differences over the thickness) */
    pzs_real *input_value;      /* [inputs] present input values of the equilibrium solver, such as
                                   voltages */
    pzs_real (*resultant)[22];  /* [elements] stress resultants of each element, each times the area
                                   of the element (N m). During the iteration they are extrapolated
                                   along the last increment of the displacement; after convergence
                                   they are those of the displacement */
    pzs_real (*prescribed)[10]; /* [elements] stress resultants that the present input values
                                   prescribe (piezoelectric actuation, temperature), each times the
                                   area of the element (N m) */
    pzs_real *load; /* [free_dof] applied forces at the last linear solve, without support reactions
                       (N and N m) */
    pzs_real *converged_displacement; /* [free_dof] displacement of the last equilibrium (m, or 1
                                         for differences over the thickness) */
    pzs_real *converged_input_value; /* [inputs] input values (V, K, Pa or load factors) of the last
                                        equilibrium that the solver has found */
    pzs_real (*converged_resultant)[22]; /* [elements] stress resultants of each element at the last
                                            equilibrium, each times the area of the element (N m) */
    uint16_t iteration; /* number of linear solves of the equilibrium solver in the present load
                           step */
    pzs_status pending_error; /* error of an option of the solver (such as a contact) that had not
                                 converged when the last load step ended, or PZS_OK */
    pzs_status refused; /* error with which an option of the solver (such as a contact) rejected the
                           last load step, or PZS_OK */
    int32_t refused_at; /* index to which the status `refused` refers: for example of the element
                           that the contact body would enter */
    pzs_status warned;  /* warning of an option of the solver (such as a contact) about the last
                           converged load step, or PZS_OK */
    bool is_balanced;   /* whether the forces in the present load step are roughly in balance: the
                           imbalance   is at most as large as the applied force, or is a rounding
                           error
                         */
    uint8_t stage;
} pzs_solver_state;

typedef struct pzs_solver {
    pzs_solver_settings settings;
    pzs_solver_info info;
    pzs_solver_state state;
} pzs_solver;

/* Size of the workspace of an equilibrium solver (bytes). */
#define PZS_SOLVER_BYTES(free_dof, elements, inputs)                                               \
    (sizeof(pzs_real) *                                                                            \
     (3u * (size_t)(free_dof) + 54u * (size_t)(elements) + 2u * (size_t)(inputs)))

/*
 * Initialise an equilibrium solver in the workspace: undeformed state, default settings.
 *   model  in/out  an initialised model of a structure with element types; from now on its
 *                  stiffness matrix holds tangent matrices
 *   tables in      must outlive the solver
 *   work   in      memory of the caller, aligned for pzs_real, at least PZS_SOLVER_BYTES
 * Errors: PZS_E_FORMAT, PZS_E_CRC, and
 *   PZS_E_ARGUMENT   also for a structure without element types or an index out of range
 *   PZS_E_WORKSPACE  info.where = bytes needed
 *   PZS_E_LOOSE      info.where = free degree of freedom
 */
pzs_status pzs_solver_init(pzs_solver *solver, pzs_model *model, const pzs_nonlinear *tables,
                           void *work, size_t bytes);

/*
 * Return the solver to the undeformed state after pzs_solver_init: displacement, input values,
 * voltages of open electrodes and contact pressures are zero.
 */
void pzs_solver_reset(pzs_solver *solver);

/*
 * Compute the equilibrium under input values, starting from the present equilibrium, in
 * settings.load_steps load steps, by Newton's method with independent stress resultants (equations
 * 17-22 of Plotnikova 2013).
 *   value [inputs] in  wanted input values
 * A load step that does not converge within 40 linear solves (80 close to convergence) is halved,
 * down to 1/64 of the first one. settings.solve_limit bounds the work.
 *
 * Warnings, errors:
 *   PZS_W_BEHIND       takes precedence over PZS_W_UNSTABLE
 *   PZS_E_ARGUMENT     also for a setting out of range
 *   PZS_E_STAGE
 *   PZS_E_NONFINITE    info.where = input
 *   PZS_E_DIVERGED, PZS_E_LIMIT, PZS_E_CONTACT, PZS_E_PENETRATION (info.where = element),
 *                      PZS_E_SOLVES: info.displacement is the last converged equilibrium, at
 *                      info.load_factor
 */
pzs_status pzs_equilibrium(pzs_solver *solver, const pzs_real *value);

/*
 * Compute the influence matrix, the outputs per unit of each input, at the deformed shape from the
 * tangent stiffness there. With follower loads, whose tangent stiffness is unsymmetric, each column
 * takes up to 60 linear solves more.
 *   influence [outputs][inputs] out  influence matrix (m/V)
 * Errors: PZS_E_ARGUMENT, PZS_E_NONFINITE, and
 *   PZS_E_STAGE     no equilibrium was computed, or the model has been used otherwise since
 *   PZS_E_RESIDUAL  only the columns of the inputs before info.where are written
 */
pzs_status pzs_influence_at(pzs_solver *solver, pzs_real *influence);

/* ---- option: follower loads (lib/nonlinear/follower.c) ---------------- */

/*
 * Tables of a follower load: a pressure that turns with a face of the shell (equations 23-31 of
 * Plotnikova 2013). All arrays are const and may stay in flash.
 */
typedef struct pzs_follower {
    uint32_t format, scene; /* format: format number of the follower-load tables; scene: hash of the
                               scene file from which they were generated; both must equal those in
                               the tables of the structure */
    uint32_t crc;      /* checksum of the tables of the follower load and their arrays, computed by
                          pzs_follower_seal */
    uint16_t input;    /* index of the input whose value scales the follower pressure; the tables
                          of the structure contain no force entries for this input */
    uint8_t load_face; /* face of the shell on which the follower pressure acts: 0 inner, 1 outer, 2
                          half on each */
    uint8_t normal_face; /* face of the shell whose normal gives the direction of the follower
                            pressure: 0 inner, 1 outer */
    uint8_t true_area;   /* 1: the follower pressure is force per deformed area of the face given
                            by normal_face; 0: force per undeformed area. In both cases it acts
                            along the normal of the deformed face */
    /*
     * distribution of the force that the follower pressure at one corner of an element causes
     * (dimensionless): the part that acts on this corner [0], on each neighbouring corner [1] and
     * on the opposite corner [2]
     */
    pzs_real share[3];
    const pzs_real (*area)[4]; /* [types][4] area of the part of an element, for each element type,
                                  that belongs to each corner (m2) */
    /*
     * [types][4][2] components, along the director of the shell at each corner of an element, of
     * the two base vectors there (dimensionless). They are not zero where a flat element
     * approximates a curved shell; NULL: all zero
     */
    const pzs_real (*lean)[4][2];
    const pzs_real *pressure; /* [nodes] follower pressure at each node per unit of the input,
                                 positive along the normal e3 (N/m2) */
} pzs_follower;

/*
 * Write the format number and the checksum into follower-load tables that a firmware has built or
 * changed itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_follower_seal(pzs_follower *tables, const pzs_structure *structure);

typedef struct pzs_follower_state {
    const pzs_follower *tables;
} pzs_follower_state;

typedef struct pzs_follower_load {
    pzs_solver_option option;
    pzs_follower_state state;
} pzs_follower_load;

/*
 * Attach a follower load to an equilibrium solver; load and tables must outlive the solver. The
 * equilibrium iteration uses only the symmetric part of its tangent stiffness, so that linear
 * solves stay symmetric; pzs_influence_at uses the exact one.
 * Errors: PZS_E_ARGUMENT (also if attached already or for an index out of range), PZS_E_FORMAT,
 * PZS_E_CRC.
 */
pzs_status pzs_attach_follower(pzs_solver *solver, pzs_follower_load *load,
                               const pzs_follower *tables);

/* ---- option: open electrodes (lib/nonlinear/electric.c) --------------- */

/* Settings of a circuit of open electrodes that a program may change after pzs_attach_circuit. */
typedef struct pzs_circuit_settings {
    pzs_real *charge; /* [count] prescribed charge of each open electrode, constant during all load
                         steps (C); default 0 */
} pzs_circuit_settings;

typedef struct pzs_circuit_state {
    const pzs_electrodes *tables;
    pzs_real *voltage;           /* [open] present voltage of each open electrode (V) */
    pzs_real *converged_voltage; /* [open] voltage of each open electrode at the last equilibrium
                                    (V) */
    pzs_real *voltage_change;    /* [open] change of the voltage of each open electrode in the last
                                    linear solve (V) */
    pzs_envelope open; /* L D L^T factors of a matrix with a row and a column for each open
                          electrode, at the present shape: charge of the electrode in the row per
                          volt on the electrode in the column (C/V) */
} pzs_circuit_state;

typedef struct pzs_circuit {
    pzs_solver_option option;
    pzs_circuit_settings settings;
    pzs_circuit_state state;
} pzs_circuit;

/*
 * Size of the workspace of a circuit with `electrodes` electrodes, of which `open` are open
 * (bytes).
 */
#define PZS_CIRCUIT_BYTES(electrodes, open)                                                        \
    (sizeof(pzs_real) * ((size_t)(electrodes) + 3u * (size_t)(open) + PZS_DENSE(open)) +           \
     sizeof(uint32_t) * ((size_t)(open) / PZS_TILE + 2u) + sizeof(uint16_t) * (size_t)(open))

/*
 * Attach the open electrodes (equations 49-55 of Plotnikova 2013) to an equilibrium solver in the
 * undeformed state; tables and circuit must outlive the solver. The voltages of open electrodes
 * become unknowns of the equilibrium and are written into solver.info.input_value. In the influence
 * matrix of pzs_influence_at the columns of open electrodes are per unit of charge. Errors:
 * PZS_E_FORMAT, PZS_E_CRC, and
 *   PZS_E_ARGUMENT   also if attached already
 *   PZS_E_WORKSPACE  solver->info.where = bytes needed
 */
pzs_status pzs_attach_circuit(pzs_solver *solver, pzs_circuit *circuit,
                              const pzs_electrodes *tables, void *work, size_t bytes);

/*
 * Compute the charges of all electrodes at the equilibrium of a solver. The tables must have been
 * checked by pzs_attach_circuit or pzs_electric_init.
 *   charge [count] out  charges of the electrodes (C)
 * Errors: PZS_E_ARGUMENT (also for a solver whose tables prescribe no stress resultants for the
 * voltages).
 */
pzs_status pzs_charges_at(const pzs_solver *solver, const pzs_electrodes *tables, pzs_real *charge);

/* ---- option: contact with a rigid convex body (lib/nonlinear/contact.c) */

/*
 * A rigid body for contact, described by the signed distance of a point from its surface (equations
 * 32-46 of Plotnikova 2013).
 */
typedef struct pzs_body {
    /*
     * Return the signed distance of a point from the rigid contact body (m), positive outside.
     *   position [3]    in   the point (m)
     *   normal   [3]    out  gradient of the distance (dimensionless)
     *   hessian  [3][3] out  second derivatives of the distance (1/m)
     */
    pzs_real (*gap)(const struct pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                    pzs_real hessian[3][3]);
    pzs_real point[3]; /* contact body: a point on the plane or on the axis of the cylinder, or the
                          centre of the sphere (m) */
    pzs_real axis[3];  /* contact body: outward unit normal of the plane, or unit vector along the
                          axis of the cylinder (dimensionless) */
    pzs_real radius;   /* radius of the contact body if it is a cylinder or a sphere, above 0 (m) */
    const void *own; /* data of the program for its own distance function of a contact body, or NULL
                      */
    uint32_t crc;    /* checksum of point, axis and radius of the contact body, computed by
                        pzs_body_crc */
} pzs_body;

/*
 * Return the checksum of point, axis and radius of a contact body, to be stored in the member `crc`
 * of the body.
 */
uint32_t pzs_body_crc(const pzs_body *body);

/*
 * Distance functions of the contact bodies of the library: half-space behind a plane, infinite
 * cylinder, sphere. Each returns the signed distance of `position` (m) and writes the unit normal
 * and the second derivatives of the distance (1/m).
 */
pzs_real pzs_gap_plane(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                       pzs_real hessian[3][3]);
pzs_real pzs_gap_cylinder(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                          pzs_real hessian[3][3]);
pzs_real pzs_gap_sphere(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                        pzs_real hessian[3][3]);

/*
 * Tables of a face of the shell that may come into contact. All arrays are const and may stay in
 * flash.
 */
typedef struct pzs_contact_face {
    uint32_t format, scene; /* format: format number of the contact tables; scene: hash of the scene
                               file from which they were generated; both must equal those in the
                               tables of the structure */
    uint32_t crc;           /* checksum of the contact tables and their arrays, computed by
                               pzs_contact_face_seal */
    uint8_t face;           /* face of the shell that may come into contact: 0 inner, 1 outer */
    uint16_t input; /* index of the input of the structure (an entry of its input vector, such as a
                       voltage or a load) that moves the contact body: the body is displaced by the
                       value of this input times `motion`. 0xFFFF: the body does not move. For this
                       input the tables of the structure contain no forces */
    pzs_real motion[3]; /* displacement (m) of the contact body along x, y and z per unit of the
                           input that moves it (member `input`) */
    /*
     * length that scales tolerances of the contact (m): largest side of the axis-parallel box
     * around the contact face of the shell. A gap between shell and contact body counts as closed
     * if it is below 1e-8 of this length (in single precision 32 times the machine epsilon)
     */
    pzs_real size;
    const pzs_real (*place)[3]; /* [nodes] positions of the nodes on the undeformed contact face (m)
                                 */
    const pzs_real (*triad)[3][3]; /* [nodes] unit vectors e1, e2, e3 of the frame of each node, in
                                      rows (dimensionless) */
    const pzs_real *area; /* [nodes] area of each node: a quarter of the area of each adjacent
                             element (m2) */
} pzs_contact_face;

/*
 * Write the format number and the checksum into contact tables that a firmware has built or changed
 * itself. Errors: PZS_E_ARGUMENT.
 */
pzs_status pzs_contact_face_seal(pzs_contact_face *tables, const pzs_structure *structure);

/*
 * Settings of the contact between the shell and a rigid body that a program may change after
 * pzs_attach_contact.
 */
typedef struct pzs_contact_settings {
    /*
     * penalty stiffness of the contact in the first iteration of a load step, divided by the
     * stiffness of the structure, above 0 (dimensionless); default 10. It doubles in each iteration
     * until it is at least 100. The converged result does not depend on it
     */
    pzs_real stiffness;
} pzs_contact_settings;

/*
 * Faults that the checks of a contact may find after each load step: the rigid contact body reaches
 * into the shell. The checks are exact for flat elements and convex bodies.
 *   - Nodes: no node of a face may lie deeper in the body than twice the gap that counts as closed.
 *   - Points between nodes, found by bisection to 1/512 of a side: the depth may be at most R/5 and
 *     twice that of a flat element whose nodes touch the body, L^2 / (8 R) with side length L and
 *     radius R.
 *   - A body smaller than the diagonals of an element may enter it only if a node of the element is
 *     in contact.
 *   - Motion: no point of an element may have passed through the body since the last equilibrium,
 *     on a straight way relative to the body.
 *   - Length: a body nearer to a node than half of the longest diagonal of an element may move in a
 *     load step by at most half of its smallest radius of curvature and half of
 *     pzs_contact_face.size; solver->info.shortened_steps counts the load steps shortened for this.
 */
typedef enum pzs_penetration {
    PZS_PENETRATION_NONE = 0,
    PZS_PENETRATION_AT_NODE,       /* kind of penetration: a node lies in the contact body, and the
                                      contact pressure cannot push the node out */
    PZS_PENETRATION_BETWEEN_NODES, /* kind of penetration: the contact body enters an element
                                      between its nodes */
    PZS_PENETRATION_PASSED /* kind of penetration: the contact body has passed through an element */
} pzs_penetration;

/*
 * Penetrations that the checks of a contact do not find, with side length L of an element and
 * radius R of the contact body:
 *   - a tip that enters by less than (L/512)^2 / (2 R);
 *   - a second local minimum of the gap in a strongly warped element;
 *   - a body between the two faces that touches neither;
 *   - penetration by some parts of a body that is not convex.
 */

/*
 * Results of the contact between the shell and a rigid body that a program may read after an
 * equilibrium.
 */
typedef struct pzs_contact_info {
    const pzs_real *pressure; /* [nodes] contact pressure per undeformed area (N/m2), 0 without
                                 contact */
    pzs_real force[3];        /* resultant force of the contact pressure on the shell (N) */
    uint16_t nodes;           /* number of nodes in contact with the rigid body */
    /*
     * largest depth, in the last load step, by which the contact body entered an element between
     * its nodes without being rejected (m). Such a depth is allowed because the element is flat
     * where the shell is curved
     */
    pzs_real sag;
    pzs_penetration penetration; /* kind of penetration for which the solver rejected the last load
                                    step, or about which it warned */
    uint8_t side; /* face of the shell that the contact body enters: 0 inner, 1 outer. If this is
                     not the contact face of the tables, the contact body comes from the other side
                     of the shell */
    uint16_t element, node; /* indices of the element and node that the contact body penetrates; for
                               a penetration between nodes, `node` is PZS_CONSTRAINED */
    pzs_real spot[3]; /* position of the point of the shell that lies deepest in the contact body
                         (m) */
    pzs_real depth;   /* depth of the deepest point of the shell in the contact body (m); 0 if the
                         body has passed through the shell */
} pzs_contact_info;

typedef struct pzs_contact_state {
    const pzs_contact_face *face;
    const pzs_body *body;
    pzs_real *pressure;           /* [nodes] present contact pressure per undeformed area (N/m2) */
    pzs_real *converged_pressure; /* [nodes] contact pressure per undeformed area at the last
                                     equilibrium (N/m2) */
    /*
     * [nodes] sum over the elements at each node of the scalar product of two normals, of the
     * contact face and of the contact body (dimensionless); negative where the face is turned
     * towards the body
     */
    pzs_real *facing;
    uint8_t *touching; /* [nodes] active set of the contact: 1 if the node is in contact with the
                          body, otherwise 0 */
    uint8_t *converged_touching; /* [nodes] active set of the contact at the last equilibrium: 1 if
                                    the node was in contact with the body, otherwise 0 */
    bool has_changed; /* whether the set of nodes in contact changed before the last linear solve */
    bool is_warm;   /* whether the load step began with the same set of nodes in contact as the last
                       equilibrium */
    bool is_loose;  /* whether the shell can move as a rigid body on its supports, so that only
                       contact can hold it */
    pzs_real reach; /* half of the longest diagonal of all elements of the shell (m); every point of
                       the shell is at most this far from a node */
    bool lacks_contact; /* whether contact was missing at the last linear solve: no node was assumed
                           to touch the contact body, or none of these nodes had a compressive
                           contact force */
} pzs_contact_state;

typedef struct pzs_contact {
    pzs_solver_option option;
    pzs_contact_settings settings;
    pzs_contact_info info;
    pzs_contact_state state;
} pzs_contact;

/* Size of the workspace of a contact (bytes). */
#define PZS_CONTACT_BYTES(nodes) ((3u * sizeof(pzs_real) + 2u) * (size_t)(nodes))

/*
 * Attach a contact between a face of the shell and a rigid body to an equilibrium solver in the
 * undeformed state; contact, face and body must outlive the solver. A shell that its supports leave
 * loose must touch the body from the start.
 * Errors: PZS_E_FORMAT, PZS_E_CRC (also of the body), and
 *   PZS_E_ARGUMENT   also if attached already, or for an index out of range, an axis that is not a
 *                    unit vector, a radius that is not positive
 *   PZS_E_NONFINITE  solver->info.where = index among point, axis and radius
 *   PZS_E_WORKSPACE  solver->info.where = bytes needed
 *
 * Result, described by contact->info:
 *   - Every gap is open, or closed to within 1e-8 of pzs_contact_face.size (float: to rounding).
 *   - No contact pressure is negative, and none acts across an open gap.
 *   - pzs_influence_at treats the body as a layer with the penalty stiffness of the last iteration.
 *     On a ring of radius 10 thicknesses this changed the influence matrix by 3e-8 of its values.
 *
 * A load step that fails the checks of pzs_penetration is halved, and finally rejected with
 * PZS_E_PENETRATION.
 */
pzs_status pzs_attach_contact(pzs_solver *solver, pzs_contact *contact,
                              const pzs_contact_face *face, const pzs_body *body, void *work,
                              size_t bytes);

#ifdef __cplusplus
}
#endif
#endif
#endif
