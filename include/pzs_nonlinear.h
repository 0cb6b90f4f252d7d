/*
 * piezoshape, nonlinear image (PZS_NONLINEAR=1): equilibrium at large rotation, follower loads,
 * open electrodes, contact, influence at the deformed shape.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 * Order of the calls: pzs_model_init, pzs_solver_init, pzs_attach_..., pzs_equilibrium,
 * pzs_influence_at, then pzs_control_init with that influence.
 */
#ifndef PZS_NONLINEAR_H
#define PZS_NONLINEAR_H

#include "pzs_model.h"

#if PZS_NONLINEAR

#ifdef __cplusplus
extern "C" {
#endif

/* ---- tables ----------------------------------------------------------- */

/*
 * Prescribed resultants of the inputs: actuation and temperature, which turn with the shell. The
 * force of a dead load is a row of structure.input instead and keeps its direction.
 */
typedef struct pzs_prescribed_resultants {
    uint16_t values;       /* number of rows of `value` */
    const uint32_t *start; /* [inputs + 1] first entry of each input; an input without entries is a
                              load */
    const uint16_t *element;     /* [start[inputs]] element of each entry */
    const uint16_t *which;       /* [start[inputs]] row of `value` of each entry */
    const pzs_real (*value)[10]; /* [values] resultants H0 per unit of input, times the element's
                                    area (N m), in the strain order of pzs_element_type.d */
} pzs_prescribed_resultants;

/* Free dof whose motion is prescribed: u[dof] = value of the input times `value`. */
typedef struct pzs_prescribed_motion {
    uint16_t count;
    uint16_t input;        /* index of the input, whose force row is empty */
    const uint16_t *dof;   /* [count] free dof */
    const pzs_real *value; /* [count] displacement per unit of input, in the unit of the dof */
} pzs_prescribed_motion;

/*
 * Tables of the nonlinear solver, in addition to a structure with element types. All arrays are
 * const, in flash.
 */
typedef struct pzs_nonlinear {
    uint32_t format, scene; /* format and scene of the structure */
    uint32_t crc;           /* checksum of everything below; see pzs_nonlinear_seal */
    pzs_prescribed_resultants given;
    pzs_prescribed_motion prescribed;
} pzs_nonlinear;

/* Set format and checksum of tables that a firmware has built or changed itself. Errors: ARGUMENT.
 */
pzs_status pzs_nonlinear_seal(pzs_nonlinear *tables, const pzs_structure *structure);

/* ---- equilibrium solver ----------------------------------------------- */

/*
 * An option of the solver (follower load, circuit or contact) that takes part in its iteration
 * (lib/nonlinear/nonlinear.h).
 */
typedef struct pzs_solver_option {
    struct pzs_solver_option *next;
    const struct pzs_solver_option_calls *call;
} pzs_solver_option;

/* Settings of the equilibrium solver that a program may change after pzs_solver_init. */
typedef struct pzs_solver_settings {
    pzs_real tolerance;  /* convergence tolerance, 0 to 1: largest norm of the last (and of the
                            predicted next) increment relative to the displacement of the load step;
                            default 1e-4 */
    uint16_t load_steps; /* load steps tried first; default 1 */
    uint16_t extrapolated_iterations; /* iterations of a load step with extrapolated resultants
                                         before the true resultants are used; default 12; 0: plain
                                         Newton method */
    uint32_t solve_limit;             /* most linear solves of one call; default 400 */
} pzs_solver_settings;

/* Results of the equilibrium solver that a program may read. */
typedef struct pzs_solver_info {
    const pzs_real *displacement; /* [free_dof] displacement of the equilibrium reached (m and 1) */
    const pzs_real *input_value;  /* [inputs] input values of this equilibrium, voltages of open
                                     electrodes included */
    pzs_real load_factor; /* part of the way from the last equilibrium to the wanted input values
                             that was reached; 1: all of it */
    pzs_real residual;    /* |force imbalance| / |applied force|, in scaled rows */
    pzs_real relative_increment; /* norm of the last increment over that of the displacement of the
                                    load step */
    uint32_t linear_solves;      /* linear solves of the last call */
    uint32_t load_steps;         /* converged load steps of the last call */
    uint32_t shortened_steps; /* converged load steps of the last call that were shortened because
                                 the contact body moves far */
    uint32_t negative_pivots; /* negative pivots of the tangent at the equilibrium; 0: stable */
    int32_t where;            /* index that belongs to the last status, or -1 */
} pzs_solver_info;

typedef struct pzs_solver_state {
    pzs_model *model;
    const pzs_nonlinear *tables;
    pzs_solver_option *option;  /* first option of the list, or NULL */
    pzs_real *displacement;     /* [free_dof] present displacement (m and 1) */
    pzs_real *input_value;      /* [inputs] present input values */
    pzs_real (*resultant)[22];  /* [elements] extrapolated resultants, after convergence the true
                                   ones (N m) */
    pzs_real (*prescribed)[10]; /* [elements] prescribed resultants H0 of the present input values
                                   (N m) */
    pzs_real *load; /* [free_dof] applied forces at the last linear solve, without reactions (N, N
                       m) */
    pzs_real *converged_displacement; /* [free_dof] displacement of the last equilibrium (m and 1)
                                       */
    pzs_real *converged_input_value;  /* [inputs] input values of the last equilibrium */
    pzs_real (*converged_resultant)[22]; /* [elements] resultants of the last equilibrium (N m) */
    uint16_t iteration;                  /* linear solves made in the present load step */
    pzs_status pending_error; /* status of an option that had not converged when the last load step
                                 ended, or PZS_OK */
    pzs_status refused;       /* error by which an option refused the last load step, or PZS_OK */
    int32_t refused_at;       /* index that belongs to `refused` */
    pzs_status warned; /* warning of an option about the last converged load step, or PZS_OK */
    bool is_balanced;  /* the residual is at most 1, or is rounding */
    uint8_t stage;
} pzs_solver_state;

typedef struct pzs_solver {
    pzs_solver_settings settings;
    pzs_solver_info info;
    pzs_solver_state state;
} pzs_solver;

/* Bytes of workspace for a solver. */
#define PZS_SOLVER_BYTES(free_dof, elements, inputs)                                               \
    (sizeof(pzs_real) *                                                                            \
     (3u * (size_t)(free_dof) + 54u * (size_t)(elements) + 2u * (size_t)(inputs)))

/*
 * Lay out a solver in the workspace, in the undeformed state, with default settings.
 *   model  in/out an initialised model of the structure; its envelope holds tangents from now on
 *   tables in     must outlive the solver
 *   work   in     memory of the caller, aligned for pzs_real, at least PZS_SOLVER_BYTES
 * Errors: ARGUMENT (also a structure without element types, an index out of range), FORMAT, CRC,
 * WORKSPACE (where = bytes needed), LOOSE (where = free dof).
 */
pzs_status pzs_solver_init(pzs_solver *solver, pzs_model *model, const pzs_nonlinear *tables,
                           void *work, size_t bytes);

/*
 * Return to the undeformed state of pzs_solver_init: zero displacement, input values, voltages of
 * open electrodes and contact.
 */
void pzs_solver_reset(pzs_solver *solver);

/*
 * Equilibrium under input values, from the present equilibrium in `load_steps` load steps. A load
 * step that does not converge (within 40 linear solves, twice as many close to convergence, fewer
 * where it diverges fast) is halved, down to 1/64. Newton's method with independent resultants H [P
 * 17-22]: K(u, H) du = f - L(u)'H, where H is not that of u but is extrapolated along the last
 * increment, H + D (L du); at convergence it is that of u. The work is bounded by solve_limit.
 *   value [inputs] in
 * Warnings: BEHIND (takes precedence over UNSTABLE), UNSTABLE. Errors: ARGUMENT (also a setting out
 * of range, those of options included), STAGE, NONFINITE (where = input); DIVERGED, LIMIT, CONTACT,
 * PENETRATION (where = element), SOLVES: info.displacement is then the last converged equilibrium,
 * at info.load_factor.
 */
pzs_status pzs_equilibrium(pzs_solver *solver, const pzs_real *value);

/*
 * Influence at the deformed shape: outputs per unit of each input, by the tangent there. Under
 * follower loads the tangent is not symmetric, and each column takes a few more solves, at most 60.
 *   influence [outputs][inputs] out (m/V)
 * Errors: ARGUMENT, STAGE (no equilibrium before, or the model was used otherwise since),
 * NONFINITE, RESIDUAL (where = input; the columns before it are valid).
 */
pzs_status pzs_influence_at(pzs_solver *solver, pzs_real *influence);

/* ---- option: follower loads (lib/nonlinear/follower.c) ---------------- */

/* A pressure that turns with a face [P 23-31]. All arrays are const, in flash. */
typedef struct pzs_follower {
    uint32_t format, scene; /* format and scene of the structure */
    uint32_t crc;           /* checksum of everything below; see pzs_follower_seal */
    uint16_t input;    /* index of an input with an empty force row, whose value scales the load */
    uint8_t load_face; /* face on which the load acts: 0 inner face, 1 outer face, 2 half on each */
    uint8_t normal_face; /* face whose normal the load follows: 0 inner face, 1 outer face */
    uint8_t true_area;   /* 1: pressure per area of the deformed normal_face; 0: per reference area,
                            along the unit normal */
    pzs_real share[3];   /* parts of a corner's pressure carried by the corner itself, by its
                            neighbours, and by the opposite corner */
    const pzs_real (*area)[4];    /* [types] area that belongs to each corner (m2) */
    const pzs_real (*lean)[4][2]; /* [types] parts of the two base vectors of each corner along the
                                     director, which count where the base vectors are chords that
                                     lean out of the tangent plane; NULL: none */
    const pzs_real *pressure;     /* [nodes] pressure per unit of input, positive along e3 (N/m2) */
} pzs_follower;

/* Set format and checksum of tables that a firmware has built or changed itself. Errors: ARGUMENT.
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
 * Attach a follower load to a solver; load and tables must outlive it. The tangent of the load is
 * symmetrised for the equilibrium, so that the linear solves stay symmetric; pzs_influence_at uses
 * the exact one. Errors: ARGUMENT (also attached already, an index out of range), FORMAT, CRC.
 */
pzs_status pzs_attach_follower(pzs_solver *solver, pzs_follower_load *load,
                               const pzs_follower *tables);

/* ---- option: open electrodes (lib/nonlinear/electric.c) --------------- */

/* Settings of the circuit that a program may change after pzs_attach_circuit. */
typedef struct pzs_circuit_settings {
    pzs_real *charge; /* [count] prescribed charge of the open electrodes (C), constant during all
                         load steps; default 0 */
} pzs_circuit_settings;

typedef struct pzs_circuit_state {
    const pzs_electrodes *tables;
    pzs_real *voltage;           /* [open] present voltages (V) */
    pzs_real *converged_voltage; /* [open] voltages of the last equilibrium (V) */
    pzs_real *voltage_change;    /* [open] change of the voltages by the last linear solve (V) */
    pzs_envelope open; /* charge of the open electrodes per volt of one another at the present
                          shape, factored */
} pzs_circuit_state;

typedef struct pzs_circuit {
    pzs_solver_option option;
    pzs_circuit_settings settings;
    pzs_circuit_state state;
} pzs_circuit;

/* Bytes of workspace for a circuit: the open electrodes that pzs_attach_circuit adds. */
#define PZS_CIRCUIT_BYTES(electrodes, open)                                                        \
    (sizeof(pzs_real) * ((size_t)(electrodes) + 3u * (size_t)(open) + PZS_DENSE(open)) +           \
     sizeof(uint32_t) * ((size_t)(open) / PZS_TILE + 2u) + sizeof(uint16_t) * (size_t)(open))

/*
 * Attach open electrodes [P 49-55] to a solver in the undeformed state; tables must outlive it.
 * Their voltages are unknowns of the same Newton's method; they replace the wanted input values in
 * solver.info.input_value. pzs_influence_at returns their columns per unit of charge. Errors:
 * ARGUMENT (also attached already), FORMAT, CRC, WORKSPACE (solver->info.where = bytes needed).
 */
pzs_status pzs_attach_circuit(pzs_solver *solver, pzs_circuit *circuit,
                              const pzs_electrodes *tables, void *work, size_t bytes);

/*
 * Charges of all electrodes at the equilibrium: -H0 . e(u) of one volt, plus the charge that flows
 * while the shell cannot deform. The tables must have been checked by pzs_attach_circuit or
 * pzs_electric_init.
 *   charge [count] out (C)
 * Errors: ARGUMENT (also a solver without prescribed resultants).
 */
pzs_status pzs_charges_at(const pzs_solver *solver, const pzs_electrodes *tables, pzs_real *charge);

/* ---- option: contact with a rigid convex body (lib/nonlinear/contact.c) */

/* A rigid body, described by its signed distance [P 32-46]. */
typedef struct pzs_body {
    /*
     * Signed distance of x from the body, > 0 outside (m).
     *   normal  [3]    out gradient of the distance
     *   hessian [3][3] out second derivatives of the distance (1/m)
     */
    pzs_real (*gap)(const struct pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                    pzs_real hessian[3][3]);
    pzs_real point[3]; /* a point on the plane or on the axis of the cylinder, or the centre of the
                          sphere (m) */
    pzs_real axis[3];  /* unit normal of the plane (outward), or unit axis of the cylinder */
    pzs_real radius;   /* radius of cylinder or sphere, > 0 (m) */
    const void *own;   /* data for a gap function of the program */
    uint32_t crc;      /* checksum of point, axis and radius, as pzs_body_crc returns it */
} pzs_body;

/* Checksum of point, axis and radius, to be stored in body->crc. */
uint32_t pzs_body_crc(const pzs_body *body);

/*
 * Signed distance, normal and second derivatives of the bodies of the library: half-space behind a
 * plane, infinite cylinder, sphere.
 */
pzs_real pzs_gap_plane(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                       pzs_real hessian[3][3]);
pzs_real pzs_gap_cylinder(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                          pzs_real hessian[3][3]);
pzs_real pzs_gap_sphere(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                        pzs_real hessian[3][3]);

/* The face that may come into contact. All arrays are const, in flash. */
typedef struct pzs_contact_face {
    uint32_t format, scene; /* format and scene of the structure */
    uint32_t crc;           /* checksum of everything below; see pzs_contact_face_seal */
    uint8_t face;           /* face in contact: 0 inner face, 1 outer face */
    uint16_t input; /* index of an input with an empty force row, whose value times `motion` moves
                       the body; 0xFFFF: none */
    pzs_real motion[3];            /* displacement of the body per unit of its input (m) */
    pzs_real size;                 /* size of mesh or body; gaps below 1e-8 of it are closed (m) */
    const pzs_real (*place)[3];    /* [nodes] positions on the undeformed face (m) */
    const pzs_real (*triad)[3][3]; /* [nodes] unit vectors e1 e2 e3 of each node, in rows */
    const pzs_real *area; /* [nodes] sum of the quarter areas of the elements at the node (m2) */
} pzs_contact_face;

/* Set format and checksum of tables that a firmware has built or changed itself. Errors: ARGUMENT.
 */
pzs_status pzs_contact_face_seal(pzs_contact_face *tables, const pzs_structure *structure);

/* Settings of the contact that a program may change after pzs_attach_contact. */
typedef struct pzs_contact_settings {
    pzs_real stiffness; /* contact stiffness in the first iteration of a load step, relative to that
                           of the structure, > 0; default 10. It doubles with each iteration up to a
                           hundred; the result does not depend on it. */
} pzs_contact_settings;

/* How the body penetrates the shell. */
typedef enum pzs_penetration {
    PZS_PENETRATION_NONE = 0,
    PZS_PENETRATION_AT_NODE,       /* `node` lies in the body, and contact cannot push it out */
    PZS_PENETRATION_BETWEEN_NODES, /* the body enters `element` between its nodes */
    PZS_PENETRATION_PASSED         /* the body has passed through `element` */
} pzs_penetration;

/* Results of the contact that a program may read after an equilibrium. */
typedef struct pzs_contact_info {
    const pzs_real *pressure; /* [nodes] contact pressure per reference area (N/m2), 0 without
                                 contact */
    pzs_real force[3];        /* resultant contact force on the shell (N) */
    uint16_t nodes;           /* number of nodes in contact */
    pzs_real sag; /* largest depth between nodes in the last load step that was allowed as sag of
                     flat elements (m) */
    pzs_penetration penetration; /* penetration for which the last load step was refused or warned
                                    of */
    uint8_t side; /* face that the body enters: 0 inner, 1 outer; the body comes from behind if it
                     is not the face of the tables */
    uint16_t element, node; /* element and node of the penetration; node is PZS_CONSTRAINED between
                               nodes */
    pzs_real spot[3];       /* position of the deepest point found (m) */
    pzs_real depth; /* depth of this point in the body (m); 0 if the body has passed through */
} pzs_contact_info;

typedef struct pzs_contact_state {
    const pzs_contact_face *face;
    const pzs_body *body;
    pzs_real *pressure;           /* [nodes] contact pressure per reference area (N/m2) */
    pzs_real *converged_pressure; /* [nodes] contact pressure of the last equilibrium (N/m2) */
    pzs_real *facing;             /* [nodes] below 0 where the face points at the body (1) */
    uint8_t *touching;            /* [nodes] 1: the node is in contact; 0: it is not */
    uint8_t *converged_touching;  /* [nodes] nodes in contact at the last equilibrium, 1 or 0 */
    bool has_changed;             /* the active set changed before the last linear solve */
    bool is_warm;   /* the load step started with the active set of the last equilibrium alone */
    bool is_loose;  /* the supports alone do not hold the shell */
    pzs_real reach; /* half of the longest diagonal of an element (m) */
    bool lacks_contact; /* at the last linear solve no node touched the body, or none was pressed
                           onto it */
} pzs_contact_state;

typedef struct pzs_contact {
    pzs_solver_option option;
    pzs_contact_settings settings;
    pzs_contact_info info;
    pzs_contact_state state;
} pzs_contact;

/* Bytes of workspace for a contact. */
#define PZS_CONTACT_BYTES(nodes) ((3u * sizeof(pzs_real) + 2u) * (size_t)(nodes))

/*
 * Attach a contact to a solver in the undeformed state; face and body must outlive it. Where the
 * supports alone do not hold the shell, the body must touch the shell from the start. After an
 * equilibrium contact->info holds the contact found: every gap is open, or closed to within 1e-8 of
 * size (in float: to within rounding), no pressure is negative, and no pressure acts across a gap.
 * pzs_influence_at uses the contact stiffness of the last iteration instead of a rigid body (a ring
 * with R/h = 10: relative error 3e-8).
 *
 * After each load step the shape is checked against the body. A load step that fails is halved, and
 * finally refused with PZS_E_PENETRATION:
 *
 * - Nodes: every node of both faces lies outside the body, up to twice the closed gap.
 * - Between nodes: the smallest gap of each element is found by bisection of its slope, to 1/512 of
 *   a side. A flat element whose nodes touch a body of radius R sags into it by (length)^2 / (8 R),
 *   which is an error of the mesh: twice this sag is allowed, at most R/5; info.sag is the largest
 *   found. A body smaller than the diagonals of an element may enter it only if one of its nodes is
 *   in contact.
 * - During the load step: no point of an element has come from the front of the body to behind it,
 *   through the body. The straight motion of every point relative to the body since the last
 *   equilibrium is searched in the same manner.
 * - Length of a load step: the body moves freely until it is closer to a node than half of the
 *   longest diagonal of an element, and then by at most half of its smallest radius of curvature
 *   (or of the size of the face, if that is smaller). Load steps are added for this; solver
 *   info.shortened_steps counts them.
 *
 * The search is exact for flat elements and convex bodies. It does not find a tip that enters by
 * less than (side/512)^2 / (2 R), a second local minimum of the gap in a strongly warped element, a
 * body inside the thickness that touches neither face, or a body that is not convex.
 *
 * Errors: ARGUMENT (also attached already, an index out of range, an axis that is not a unit
 * vector, a radius that is not positive), FORMAT, CRC (also of the body), NONFINITE
 * (solver->info.where = index in point, axis, radius of the body), WORKSPACE (solver->info.where =
 * bytes needed).
 */
pzs_status pzs_attach_contact(pzs_solver *solver, pzs_contact *contact,
                              const pzs_contact_face *face, const pzs_body *body, void *work,
                              size_t bytes);

#ifdef __cplusplus
}
#endif
#endif
#endif
