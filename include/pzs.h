/*
 * piezoshape: shape control of piezoelectric shells in static memory.
 *
 *   tables -> assemble -> factor -> influence -> control -> tick -> volts
 *
 * A control image starts at `control`: its tables hold the influence matrix.
 * A linear image starts at `assemble`: its tables hold element matrices, and
 * the device computes the influence itself. Tables are made by `pzs tables`.
 *
 *   control image:  pzs_control_init(&control, &problem, NULL, work, bytes)
 *   linear image:   pzs_model_init, pzs_assemble, pzs_factor, pzs_influence, then pzs_control_init with that influence
 *   nonlinear:      pzs_model_init, pzs_path_init, pzs_attach_..., pzs_equilibrium, pzs_influence_at, then the same
 *   every tick:     pzs_feed_forward (readings, now; wanted, next), pzs_estimate_tick, pzs_tick, pzs_quantise,
 *                   pzs_watch_tick, control.volt to the amplifiers; all but the tick are options
 *
 * All memory is the caller's. Nothing here allocates, prints, recurses or
 * keeps a global. Every function leaves its outputs untouched when it returns
 * an error (PZS_E_...), except where it says so; a warning (PZS_W_...) comes
 * with a usable answer. Arrays are row-major; units are those of the scene,
 * written here as m, N, V, K.
 *
 * [P n] are the equations of S. V. Plotnikova's dissertation (Tambov 2013) that a part carries out.
 */
#ifndef PZS_H
#define PZS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include "pzs_config.h"

/* Version of the library and of pzs. */
#define PZS_VERSION "0.1.0"

/* ---- numbers ---------------------------------------------------------- */

#if PZS_REAL_BITS == 32
typedef float pzs_real;
#define pzs_model_init pzs_model_init_32
#define pzs_control_init pzs_control_init_32
#define PZS_BY_BITS(for32, for64) (for32)
#define PZS_EPSILON 1.1920929e-7f
#define PZS_SQRT(x) sqrtf(x)
#define PZS_ABS(x) fabsf(x)
#else
typedef double pzs_real;
#define pzs_model_init pzs_model_init_64
#define pzs_control_init pzs_control_init_64
#define PZS_BY_BITS(for32, for64) (for64)
#define PZS_EPSILON 2.2204460492503131e-16
#define PZS_SQRT(x) sqrt(x)
#define PZS_ABS(x) fabs(x)
#endif

/* A number of a generated table, rounded once from double. */
#define PZS_R(x) ((pzs_real)(x))

#if PZS_TILE == 4
#define PZS_BY_TILE(for4, for8, for16) (for4)
#elif PZS_TILE == 8
#define PZS_BY_TILE(for4, for8, for16) (for8)
#else
#define PZS_BY_TILE(for4, for8, for16) (for16)
#endif

/* Bytes of stack that no public function goes beyond, in a linear or control image and in a nonlinear one. */
#define PZS_STACK_LINEAR (256u * sizeof(pzs_real))
#define PZS_STACK_NONLINEAR (2176u * sizeof(pzs_real))

/* ---- statuses --------------------------------------------------------- */

typedef enum pzs_status {
    PZS_OK = 0,

    /* Warnings: the answer stands, something is to be known. */
    PZS_W_PASSES,    /* pass budget spent: volts allowed, no worse than the start, not yet optimal */
    PZS_W_SLEW,      /* slew and limit do not meet at input `where`: the limit won */
    PZS_W_SENSOR,    /* measurement `where` is not finite or frozen: its last disturbance is kept */
    PZS_W_HELD,      /* no usable measurement or target: the last safe volts are held */
    PZS_W_ELECTRODE, /* electrode `where` does not follow its amplifier: it is held from now on */
    PZS_W_BEHIND,    /* an equilibrium in contact, but a part of the shell that faces away from the
                        body lies in it at contact->spot: the shell has passed through itself, or
                        both of its faces would touch */
    PZS_W_UNSTABLE,  /* an equilibrium with negative pivots: the structure will not stay there by itself */

    /* Errors: outputs untouched. */
    PZS_E_ARGUMENT,  /* null pointer, or a size or index out of range */
    PZS_E_FORMAT,    /* tables of another format number, or of another scene than those they go with */
    PZS_E_CRC,       /* tables damaged */
    PZS_E_WORKSPACE, /* workspace too small or misaligned; `where` is the number of bytes needed */
    PZS_E_STAGE,     /* called before the stage it builds on */
    PZS_E_NONFINITE, /* NaN or infinity at index `where` of an input array */
    PZS_E_LIMITS,    /* lower limit above upper, or not a number, at input `where` */
    PZS_E_LOOSE,     /* no stiffness left at unknown `where`: a loose part, or a missing support */
    PZS_E_NEGATIVE,  /* negative pivot at unknown `where` in a structure at rest */
    PZS_E_CONDITION, /* condition estimate above what this precision carries */
    PZS_E_RESIDUAL,  /* refinement ended with an estimated error above the root of epsilon */

    /* Errors of the nonlinear path: the last equilibrium stands, `factor` of the way to the amounts asked for. */
    PZS_E_DIVERGED,  /* no equilibrium found beyond it, down to 1/64 of a load step (also: open electrodes kept changing) */
    PZS_E_LIMIT,     /* the same, and the tangent loses its sign there: a limit or branching point is near */
    PZS_E_CONTACT,   /* the same, and the nodes in contact kept changing; or a shell that its supports leave loose
                        does not touch the body from the start, is not pressed onto it, or slides away on it */
    PZS_E_PENETRATION, /* the same: beyond it the body of a contact enters element `where` at a node,
                        or between its nodes (refine the mesh there or enlarge the body), or passes
                        through it; contact->entered says which, contact->side from which side */
    PZS_E_SYSTEMS    /* budget of linear systems spent */
} pzs_status;

/* One line for a person; the text lives in flash and is linked only where it is called. */
const char *pzs_status_text(pzs_status status);

#define PZS_IS_ERROR(status) ((status) >= PZS_E_ARGUMENT)

/* ---- tables ----------------------------------------------------------- */

#define PZS_TABLE_FORMAT 2u
#define PZS_FIXED 0xFFFFu /* in node_dof: an unknown held at zero by a support */

/* Sparse rows over the free unknowns: one per input (a force) or output (a displacement). */
typedef struct pzs_rows {
    uint16_t count;        /* rows */
    const uint32_t *start; /* [count + 1] */
    const uint16_t *dof;   /* [start[count]] free unknown */
    const pzs_real *value; /* [start[count]] */
} pzs_rows;

/*
 * One element kind: all that the element kernel needs of geometry and material.
 * Corner r = 0..3 is (-,-) (+,-) (+,+) (-,+); direction a = 0, 1 along theta1, theta2;
 * r' is the neighbour of r along a. Displacement derivatives in the frame of corner r:
 *   lam_a = S_a u_r + T_a u_r'
 * Formulation (published or improved) is nothing but the values in here.
 */
typedef struct pzs_kind {
    pzs_real s[4][2][3][3];  /* (1/m) */
    pzs_real t[4][2][3][3];  /* (1/m) */
    pzs_real g_mean[4][2][3]; /* base vectors, mean of the two faces (1) */
    pzs_real g_diff[4][2][3]; /* their difference over h (1/m) */
    pzs_real d[4][55];       /* (N m) D of modes 00 01 10 11, packed lower triangle, times area/3^(r1+r2);
                                order 11m 11d 22m 22d 33m 33d 12m 12d 13 23, m mean and d difference of the faces */
    pzs_real thickness;      /* h (m) */
    pzs_real warp[9];        /* shares added to the 12 mean of mode 00 (1), in this order: 12d^00, 13^01, 23^10,
                                13^00, 23^00, 11d^00, 11d^01, 22d^00, 22d^10; all 0 in the published element.
                                At rest their sum is the warp of the four nodes, free of the directors. */
} pzs_kind;

/* A structure for the linear image. All arrays const, in flash. */
typedef struct pzs_structure {
    uint32_t format;                /* PZS_TABLE_FORMAT */
    uint32_t scene;                 /* hash of the scene these tables were made from */
    uint32_t crc;                   /* over the five counts, then every array below, in their order */
    uint16_t nodes, elements, kinds;
    uint16_t unknowns;              /* 7 or 6 a node: mean u1 u2 u3, differences/h, (u3M - mean u3)/h */
    uint16_t dof;                   /* free unknowns */
    const uint16_t (*element)[4];   /* [elements] nodes, corner order */
    const uint16_t *element_kind;   /* [elements] */
    const uint16_t *node_dof;       /* [nodes][unknowns] free unknown or PZS_FIXED */
    const uint16_t *first;          /* [dof] first column of each row of the lower triangle */
    const pzs_real *stiffness;      /* [kinds][4u(4u+1)/2] packed lower triangle, u = unknowns */
    const pzs_kind *kind;           /* [kinds], or NULL: then no strain-based refinement */
    pzs_rows input;                 /* force of one unit of each input (N/V, N/K, N/Pa, 1) */
    pzs_rows output;                /* displacement per unknown (m) */
} pzs_structure;

/* ---- the linear image: structure to influence ------------------------- */

/* A symmetric matrix in envelope storage: dense, band and skyline in one form (lib/linalg.h). */
typedef struct pzs_envelope {
    uint32_t n;            /* rows */
    const uint16_t *first; /* [n] first column of each row */
    uint32_t *start;       /* [panels + 1] where each panel of PZS_TILE rows begins in value */
    pzs_real *value;       /* [start[panels]] */
    pzs_real *inverse;     /* [n] inverse pivots, once factored */
} pzs_envelope;

typedef struct pzs_model {
    const pzs_structure *structure;
    pzs_envelope k;        /* scaled stiffness, then its factor */
    pzs_real *scale;       /* [dof] powers of two: unit diagonal */
    pzs_real *work;        /* [6][dof] */
    const pzs_real *stiffness_factor; /* [kinds] of the last assembly, or NULL */
    const uint8_t *held;   /* [dof] of the last assembly, or NULL */
    pzs_real condition;    /* 1-norm condition estimate of the scaled stiffness */
    pzs_real residual;     /* |K u - f| / |f| of the last solve, scaled rows, formed from strains; -1 without kinds */
    pzs_real error;        /* estimated relative error of u in the energy norm; -1 without kinds */
    int32_t where;         /* index that goes with the last status, or -1 */
    uint16_t passes;       /* refinement passes of the last solve */
    uint16_t negative;     /* negative pivots of the last factor */
    uint8_t stage;         /* 1 ready, 2 assembled, 3 factored */
} pzs_model;

/* Bytes of workspace for a model; `envelope` is the padded number of factor entries
 * (generated headers give it per tile, linalg_reals computes it). */
#define PZS_MODEL_BYTES(dof, envelope) \
    (sizeof(pzs_real) * ((size_t)(envelope) + 8u * (size_t)(dof)) + \
     sizeof(uint32_t) * ((size_t)(dof) / PZS_TILE + 2u) + 2u * sizeof(pzs_real))

/*
 * Check the tables and lay a model out in the workspace.
 *   model     out
 *   structure in   must outlive the model
 *   work      in   caller's memory, aligned for pzs_real
 *   bytes     in   at least PZS_MODEL_BYTES
 * Errors: ARGUMENT (also an index out of range), FORMAT, CRC, WORKSPACE (where = bytes needed).
 */
pzs_status pzs_model_init(pzs_model *model, const pzs_structure *structure, void *work, size_t bytes);

/*
 * Sum the element matrices [P 10-16] into the envelope: K = sum_e P_e^T K_kind(e) P_e.
 *   stiffness_factor [kinds] in  multiplies each kind's matrix; NULL: 1
 *   held             [dof]   in  nonzero: an unknown held at zero besides the supports; NULL: none
 * Both arrays must outlive the following solves. Errors: ARGUMENT (also a negative factor), STAGE, NONFINITE.
 */
pzs_status pzs_assemble(pzs_model *model, const pzs_real *stiffness_factor, const uint8_t *held);

/*
 * Scale to unit diagonal by powers of two, factor L D L^T, estimate the condition.
 * Errors: STAGE, LOOSE and NEGATIVE (where = unknown), CONDITION: the estimate exceeds 1.2/epsilon,
 * or 600/epsilon where kinds are given and solves are refined, or 1e14.
 */
pzs_status pzs_factor(pzs_model *model);

/*
 * Displacement under the inputs: K u = sum_j amount_j f_j, refined from strains where kinds are given.
 *   amount [inputs] in   V, K, Pa or load factors
 *   u      [dof]    out  unknowns in their own units (m and 1)
 * Errors: STAGE, NONFINITE, RESIDUAL (u then holds the best reached).
 */
pzs_status pzs_solve(pzs_model *model, const pzs_real *amount, pzs_real *u);

/* Outputs of a displacement: y = output rows . u.  u [dof] in, y [outputs] out (m). */
void pzs_observe(const pzs_structure *structure, const pzs_real *u, pzs_real *y);

/*
 * Influence matrix: outputs per unit of each input, one solve a column.
 *   influence [outputs][inputs] out (m/V)
 * Errors as pzs_solve (columns before the failing input `where` are written).
 */
pzs_status pzs_influence(pzs_model *model, pzs_real *influence);

/* ---- electrodes: charges, sensors, open circuits (lib/electrode.c) ----- */

/*
 * Inputs in volts whose charge is of interest. The charge of electrode k, on the side towards +e3, is
 *   q_k = f_k . u + sum_j direct(k, j) amount_j,
 * f_k the row of its input: what senses is the transpose of what acts. All arrays const, in flash.
 */
typedef struct pzs_electrodes {
    uint32_t format, scene;  /* those of the structure */
    uint32_t crc;            /* over the arrays below, in their order */
    uint16_t count;
    const uint16_t *input;   /* [count] whose amount is its volts */
    const uint8_t *open;     /* [count] 1: its charge is given and its volts are found, 0: its volts are given */
    pzs_rows direct;         /* [count] charge while the shell is held, per unit of the input `dof` (C/V, C/K):
                                capacitance for its own volts, pyroelectric charge for a temperature */
} pzs_electrodes;

typedef struct pzs_electric {
    pzs_model *model;
    const pzs_electrodes *tables;
    pzs_real *charge;        /* choice [count]: charge of the open electrodes (C); 0 */
    pzs_real *per;           /* [count][inputs] charge per unit of each input, every volt given (C/V, C/K, C/N) */
    pzs_real *amount;        /* [inputs] work */
    pzs_envelope open;       /* the part of `per` between open electrodes, factored */
    int32_t where;           /* index that goes with the last status, or -1 */
    uint8_t stage;
} pzs_electric;

/* Reals of a dense factor of n rows, and bytes of workspace for electrodes. */
#define PZS_DENSE(n) (PZS_CEIL(n) * (PZS_CEIL(n) + PZS_TILE) / 2u + (size_t)(n))
#define PZS_CEIL(n) (((size_t)(n) + PZS_TILE - 1u) / PZS_TILE * PZS_TILE)
#define PZS_ELECTRIC_BYTES(electrodes, open, inputs) \
    (sizeof(pzs_real) * (((size_t)(electrodes) + 1u) * ((size_t)(inputs) + 1u) + PZS_DENSE(open)) + \
     sizeof(uint32_t) * ((size_t)(open) / PZS_TILE + 2u) + sizeof(uint16_t) * (size_t)(open))

/*
 * Lay electrodes out in the workspace. model and tables must outlive them.
 * Errors: ARGUMENT, FORMAT, CRC, WORKSPACE (where = bytes needed).
 */
pzs_status pzs_electric_init(pzs_electric *electric, pzs_model *model, const pzs_electrodes *tables, void *work,
                             size_t bytes);

/*
 * Charges per unit of every input at rest [P 49-55], one solve an electrode; after each pzs_factor.
 * Errors: ARGUMENT, STAGE, those of pzs_solve, NEGATIVE: an open electrode without capacitance (where = electrode).
 */
pzs_status pzs_electric_factor(pzs_electric *electric);

/*
 * Volts of the open electrodes that leave them their charges, the other amounts given; pzs_solve takes all of them.
 *   amount [inputs] in/out  volts of open electrodes are not read but written
 * Errors: ARGUMENT, STAGE, NONFINITE.
 */
pzs_status pzs_open_volts(const pzs_electric *electric, pzs_real *amount);

/*
 * Charges under amounts, volts of open electrodes among them.
 *   amount [inputs] in
 *   charge [count]  out (C)
 * Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_charges(const pzs_electric *electric, const pzs_real *amount, pzs_real *charge);

/*
 * The influence with open electrodes left open, in the place of the one with their volts given.
 *   influence [outputs][inputs] in/out  in: of pzs_influence; out: columns of open electrodes per unit of charge (m/C)
 * Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_influence_open(const pzs_electric *electric, pzs_real *influence);

#if PZS_NONLINEAR
/* ---- the nonlinear image: equilibrium at large rotation --------------- */

/*
 * Resultants that an input puts into the elements: actuation and temperature turn with the shell,
 * while the force of a dead load, a row of structure.input, stays as it is.
 */
typedef struct pzs_given {
    uint16_t values;             /* rows of value */
    const uint32_t *start;       /* [inputs + 1]; an input without entries is a load */
    const uint16_t *element;     /* [start[inputs]] */
    const uint16_t *which;       /* [start[inputs]] row of value */
    const pzs_real (*value)[10]; /* [values] H0 per unit of input times area (N m), order of pzs_kind.d */
} pzs_given;

/* Free unknowns that are moved rather than loaded: u[dof] = amount[input] value. */
typedef struct pzs_prescribed {
    uint16_t count;
    uint16_t input;              /* an input whose row is empty */
    const uint16_t *dof;         /* [count] */
    const pzs_real *value;       /* [count] per unit of input, in the unknowns' units */
} pzs_prescribed;

/* What the nonlinear path needs besides a structure with kinds. All arrays const, in flash. */
typedef struct pzs_nonlinear {
    uint32_t format, scene;      /* those of the structure */
    uint32_t crc;                /* over the arrays of given, then of prescribed and its input, in their order */
    pzs_given given;
    pzs_prescribed prescribed;
} pzs_nonlinear;

/* A follower load or a contact that takes part in the iteration (lib/nonlinear.h). */
typedef struct pzs_option {
    struct pzs_option *next;
    const struct pzs_option_calls *call;
} pzs_option;

typedef struct pzs_path {
    pzs_model *model;
    const pzs_nonlinear *tables;
    pzs_option *option;          /* first of those attached, or NULL */
    pzs_real *u;                 /* [dof] the shape reached (m and 1) */
    pzs_real *amount;            /* [inputs] that hold it there */
    pzs_real (*resultant)[22];   /* [elements] extrapolated, then true resultants (N m) */
    pzs_real (*given)[10];       /* [elements] H0 of the amounts */
    pzs_real *load;              /* [dof] forces applied at the last system, without reactions (N, N m) */
    pzs_real *kept_u;            /* [dof] the last equilibrium, */
    pzs_real *kept_amount;       /* [inputs] */
    pzs_real (*kept_resultant)[22]; /* [elements] all of it */

    pzs_real change;             /* choice: a step has settled when the last increment, and the next one to come, are
                                    below this part of the step's displacement, 0 < change < 1; 1e-4 */
    uint16_t steps;              /* choice: load steps tried first; 1 */
    uint16_t mixed;              /* choice: systems of a step with extrapolated resultants before those of the shape
                                    take over; 12, 0: the plain Newton method */
    uint32_t systems_allowed;    /* choice: budget of one call; 400 */

    uint32_t systems;            /* linear systems solved in the last call */
    uint32_t steps_taken;        /* load steps that settled */
    uint32_t steps_short;        /* of them: shortened as the body of a contact moves far */
    uint32_t negative;           /* negative pivots of the tangent at u: 0 is a stable shape */
    pzs_real factor;             /* part of the way from the shape before to the amounts asked for: 1 is all */
    pzs_real residual;           /* |force imbalance| / |applied force| at u, scaled rows */
    pzs_real quiet;              /* last increment over the step's displacement */
    uint16_t iteration;          /* systems before the present one in its load step */
    int32_t where;               /* index that goes with the last status, or -1 */
    int32_t refused_at;          /* index that goes with refused */
    uint8_t refused;             /* error by which an option refused the last load step, or 0 */
    uint8_t warned;              /* its warning of the last settled load step, or 0 */
    uint8_t open;                /* error of an option that had not settled when the last step ended, or 0 */
    uint8_t balanced;            /* 1: residual at most 1, or by rounding alone */
    uint8_t stage;
} pzs_path;

/* Bytes of workspace for a path. */
#define PZS_PATH_BYTES(dof, elements, inputs) \
    (sizeof(pzs_real) * (3u * (size_t)(dof) + 54u * (size_t)(elements) + 2u * (size_t)(inputs)))

/*
 * Lay a path out in the workspace, at rest, unloaded, with its choices at their defaults.
 *   model   in/out a model initialised on the structure; its envelope holds tangents from now on
 *   tables  in     must outlive the path
 *   work    in     caller's memory, aligned for pzs_real, at least PZS_PATH_BYTES
 * Errors: ARGUMENT (also a structure without kinds, an index out of range), FORMAT, CRC, WORKSPACE (where = bytes needed),
 * LOOSE (where = unknown).
 */
pzs_status pzs_path_init(pzs_path *path, pzs_model *model, const pzs_nonlinear *tables, void *work, size_t bytes);

/* Back to rest: displacements, amounts, volts of open electrodes and contacts are zero, as after pzs_path_init. */
void pzs_path_rest(pzs_path *path);

/*
 * Equilibrium under the amounts, from the shape reached so far: the whole way in `steps` load steps, and where a
 * step does not settle (40 systems, twice as many near the end, fewer where it runs wild), in halves of it, down to 1/64.
 * Newton's method with independent resultants H [P 17-22]: K(u, H) du = f - L(u)'H, where H is not that of u but was
 * extrapolated along the last du, H + D (L du), and is that of u at the end.
 *   amount [inputs] in
 * Work is bounded by systems_allowed. Warnings: BEHIND (also where it is unstable), UNSTABLE.
 * Errors: ARGUMENT (also a choice out of range, of an option's, too), STAGE, NONFINITE (where =
 * input); DIVERGED, LIMIT, CONTACT, PENETRATION (where = element), SYSTEMS: path->u is the last
 * equilibrium, at path->factor.
 */
pzs_status pzs_equilibrium(pzs_path *path, const pzs_real *amount);

/*
 * Influence at the shape reached: outputs per unit of each input, by the tangent there. Under follower loads it is not
 * symmetric: each column takes a few solves more, 60 at most.
 *   influence [outputs][inputs] out (m/V)
 * Errors: ARGUMENT, STAGE (no equilibrium before, or the model used otherwise since), NONFINITE, RESIDUAL (where = input;
 * the columns before it stand).
 */
pzs_status pzs_influence_at(pzs_path *path, pzs_real *influence);

/* ---- option: follower loads (lib/follower.c) -------------------------- */

/* A pressure that turns with a face [P 23-31]. All arrays const, in flash. */
typedef struct pzs_follower {
    uint32_t format, scene;   /* those of the structure */
    uint32_t crc;             /* over all that follows, each of the four choices as 16 bits */
    uint16_t input;           /* an input with an empty row: its amount scales the load */
    uint8_t load_face;        /* where it acts: 0 inner face, 1 outer, 2 half on each */
    uint8_t normal_face;      /* whose normal it follows: 0 inner, 1 outer */
    uint8_t true_area;        /* 1: per area of the deformed normal_face; 0: per reference area, along the unit normal */
    pzs_real share[3];        /* of a corner's pressure carried by itself, its neighbours, the opposite corner */
    const pzs_real (*area)[4]; /* [kinds] area that goes with each corner (m2) */
    const pzs_real (*lean)[4][2]; /* [kinds] what counts of the two base vectors of each corner along the director, where
                                 they are chords and lean out of the tangent plane; NULL: nothing */
    const pzs_real *pressure; /* [nodes] per unit of input, positive along e3 (N/m2) */
} pzs_follower;

typedef struct pzs_follower_load {
    pzs_option option;
    const pzs_follower *tables;
} pzs_follower_load;

/*
 * Let a follower load take part in a path; both must outlive it.
 * Errors: ARGUMENT (also attached already, an index out of range), FORMAT, CRC.
 * Its tangent is symmetrised for the equilibrium, so the solver stays symmetric; influence has the true one.
 */
pzs_status pzs_attach_follower(pzs_path *path, pzs_follower_load *load, const pzs_follower *tables);

/* ---- option: open electrodes (lib/electric.c) ------------------------- */

typedef struct pzs_circuit {
    pzs_option option;
    const pzs_electrodes *tables;
    pzs_real *charge;        /* choice [count]: charge of the open electrodes (C), held on the whole way; 0 */
    pzs_real *volt;          /* [open] found */
    pzs_real *kept_volt;     /* [open] at the last equilibrium */
    pzs_real *change;        /* [open] of volt by the last system */
    pzs_envelope open;       /* charge of the open electrodes per volt at the shape, factored */
} pzs_circuit;

/* Bytes of workspace for a circuit. */
#define PZS_CIRCUIT_BYTES(electrodes, open) \
    (sizeof(pzs_real) * ((size_t)(electrodes) + 3u * (size_t)(open) + PZS_DENSE(open)) + \
     sizeof(uint32_t) * ((size_t)(open) / PZS_TILE + 2u) + sizeof(uint16_t) * (size_t)(open))

/*
 * Let open electrodes [P 49-55] take part in a path at rest; tables must outlive it. Their volts are unknowns of the same
 * Newton's method, found in path->amount whatever was asked for; pzs_influence_at gives their columns per unit of charge.
 * Errors: ARGUMENT (also attached already), FORMAT, CRC, WORKSPACE (path->where = bytes needed).
 */
pzs_status pzs_attach_circuit(pzs_path *path, pzs_circuit *circuit, const pzs_electrodes *tables, void *work,
                              size_t bytes);

/*
 * Charges of all electrodes at the shape reached, under path->amount: -H0 . e(u) of a volt and what flows while the
 * shell is held, open or not. Of tables that pzs_attach_circuit or pzs_electric_init has checked.
 *   charge [count] out (C)
 * Errors: ARGUMENT (also tables of a path without given resultants).
 */
pzs_status pzs_charges_at(const pzs_path *path, const pzs_electrodes *tables, pzs_real *charge);

/* ---- option: contact with a rigid convex body (lib/contact.c) --------- */

/* A body by its signed distance [P 32-46]. */
typedef struct pzs_body {
    /* Distance of x from the body, > 0 outside (m); normal [3] = its gradient, hessian [3][3] (1/m). */
    pzs_real (*gap)(const struct pzs_body *body, const pzs_real x[3], pzs_real normal[3], pzs_real hessian[3][3]);
    pzs_real point[3];        /* on the plane, on the axis, centre (m) */
    pzs_real axis[3];         /* unit normal of the plane (outward), unit axis of the cylinder */
    pzs_real radius;          /* of cylinder and sphere, > 0 (m) */
    const void *own;          /* for a gap function of the caller's */
    uint32_t crc;             /* over point, axis and radius: pzs_body_crc */
} pzs_body;

/* What body->crc must be. */
uint32_t pzs_body_crc(const pzs_body *body);

/* Distance, normal and hessian of the bodies there are: outside of a plane, a cylinder without end, a sphere. */
pzs_real pzs_gap_plane(const pzs_body *body, const pzs_real x[3], pzs_real normal[3], pzs_real hessian[3][3]);
pzs_real pzs_gap_cylinder(const pzs_body *body, const pzs_real x[3], pzs_real normal[3], pzs_real hessian[3][3]);
pzs_real pzs_gap_sphere(const pzs_body *body, const pzs_real x[3], pzs_real normal[3], pzs_real hessian[3][3]);

/* The face that may touch. All arrays const, in flash. */
typedef struct pzs_contact_face {
    uint32_t format, scene;   /* those of the structure */
    uint32_t crc;             /* over all that follows, face and input as 16 bits each */
    uint8_t face;             /* 0 inner, 1 outer */
    uint16_t input;           /* an input with an empty row: its amount times motion displaces the body; 0xFFFF: none */
    pzs_real motion[3];       /* (m) */
    pzs_real size;            /* of mesh or body: gaps below 1e-8 of it are closed (m) */
    const pzs_real (*place)[3];    /* [nodes] of the face at rest (m) */
    const pzs_real (*triad)[3][3]; /* [nodes] rows e1 e2 e3 */
    const pzs_real *area;     /* [nodes] quarter areas of the elements at the node (m2) */
} pzs_contact_face;

/* Values of contact->entered: how the body penetrates the shell. */
enum { PZS_AT_NODE = 1, PZS_BETWEEN, PZS_PASSED };

typedef struct pzs_contact {
    pzs_option option;
    const pzs_contact_face *face;
    const pzs_body *body;
    pzs_real *pressure;       /* [nodes] contact pressure per reference area (N/m2), 0 where nothing touches */
    pzs_real *kept_pressure;  /* [nodes] at the last equilibrium */
    pzs_real *facing;         /* [nodes] below 0 where the face points at the body */
    uint8_t *touching;        /* [nodes] 1 in contact */
    uint8_t *kept_touching;   /* [nodes] at the last equilibrium */
    pzs_real stiffness;       /* choice: kappa at the first system of a step, in units of the structure's own; 10, > 0. It
                                 doubles with each system up to a hundred; the answer does not depend on it. */
    pzs_real force[3];        /* resultant on the shell (N) */
    uint16_t nodes;           /* in contact */
    uint8_t changed;          /* nodes came or went before the last system */
    uint8_t warm;             /* the load step began with the nodes of the last equilibrium alone */
    uint8_t loose;            /* the supports alone do not hold the shell */
    uint8_t adrift;           /* at the last system nothing touched the body, or was pressed onto it */

    pzs_real sag;             /* depth that was allowed between nodes in the last load step (m) */
    uint8_t entered;          /* why the last load step was refused or warned of, or 0. PZS_AT_NODE:
                                 `node` lies in the body, which cannot push it out; PZS_BETWEEN: so
                                 does `element`, between its nodes; PZS_PASSED: the body passed
                                 through it */
    uint8_t side;             /* the face that it enters: 0 inner, 1 outer; other than face->face:
                                 from behind */
    uint16_t element, node;   /* element, and node or PZS_FIXED */
    pzs_real spot[3];         /* place of the deepest point found (m) */
    pzs_real depth;           /* of that point in the body (m); 0 where it has passed */
    pzs_real reach;           /* half of the longest diagonal of an element (m) */
} pzs_contact;

/* Bytes of workspace for a contact. */
#define PZS_CONTACT_BYTES(nodes) ((3u * sizeof(pzs_real) + 2u) * (size_t)(nodes))

/*
 * Let a contact take part in a path at rest; face and body must outlive it. Where the supports do not hold the shell
 * without the body, the body must touch it from the start. After an equilibrium contact->pressure, force and nodes
 * hold what was found; settled, that is every gap open or closed to within 1e-8 of size (in float: of rounding),
 * no pressure negative, none across a gap. Influence at a shape in contact sees the body as stiff as kappa has grown (a
 * ring of R/h = 10: off by 3e-8).
 *
 * After each load step the shape is checked against the body. A load step that fails is halved, and
 * in the end refused with PZS_E_PENETRATION:
 *  - Nodes. Every node of both faces lies outside the body, to within twice the closed gap.
 *  - Between the nodes. The least gap of each element is found by bisection of its slope, to 1/512
 *    of a side. A facet whose nodes touch a body of radius R sags into it by (length)^2 / (8 R),
 *    which is an error of the mesh: twice the sag of its corners is allowed, at most R/5.
 *    contact->sag is the largest found. A body that is smaller than the diagonals of an element may
 *    enter it only if one of its nodes is in contact.
 *  - The way. No point of an element has come from the front of the body to behind it, through it:
 *    the straight way of every point relative to the body since the last equilibrium is searched
 *    likewise.
 *  - The length of the load step. The body moves freely until it is nearer to a node than half of
 *    the longest diagonal of an element; from there by at most half of its smallest radius of
 *    curvature, or of the face's size if that is smaller. Load steps are added for it;
 *    path->steps_short counts.
 * The search is exact for flat elements and convex bodies. Not found: a tip that enters by less
 * than (side/512)^2 / (2 R); a second least gap of a strongly warped element; a body inside the
 * thickness that touches neither face; a body that is not convex.
 * Errors: ARGUMENT (also attached already, an index out of range, an axis whose length is not 1, a
 * radius not above 0), FORMAT, CRC (also of the body), NONFINITE (path->where = index in point,
 * axis, radius of the body), WORKSPACE (path->where = bytes needed).
 */
pzs_status pzs_attach_contact(pzs_path *path, pzs_contact *contact, const pzs_contact_face *face, const pzs_body *body,
                              void *work, size_t bytes);
#endif

/* ---- the control image: influence to volts ---------------------------- */

/*
 * The voltage problem  min |W (B v - e)|^2 + effort |v - prefer|^2,
 * lower <= v <= upper, |v - v_last| <= slew. All arrays const, in flash.
 */
typedef struct pzs_problem {
    uint32_t format;           /* PZS_TABLE_FORMAT */
    uint32_t scene;            /* hash of the scene */
    uint32_t crc;              /* over the two counts, every array below that is not NULL, in order, and the effort */
    uint16_t inputs, outputs;
    const pzs_real *influence; /* B [outputs][inputs] (m/V), or NULL in a linear image */
    const pzs_real *hessian;   /* B'W^2 B [inputs][inputs] (m2/V2), or NULL: formed at init */
    const pzs_real *weight;    /* W [outputs] (1) */
    const pzs_real *lower;     /* [inputs] (V) */
    const pzs_real *upper;     /* [inputs] (V) */
    const pzs_real *slew;      /* [inputs] most change a step (V) */
    const pzs_real *prefer;    /* v0 [inputs] (V) */
    pzs_real effort;           /* (m2/V2) */
} pzs_problem;

/* More amplifiers than this are refused. */
#define PZS_MOST_INPUTS 4096

/* The optimiser's own: vectors of [width], inputs rounded up to whole tiles (lib/boxls.h). */
typedef struct pzs_optimiser {
    uint32_t n, width;
    uint32_t allowed, used; /* passes */
    pzs_real *h;            /* [n][width] Hessian (m2/V2) */
    pzs_real *m;            /* [n][width] tableau */
    pzs_real *v;            /* volts */
    pzs_real *lo, *hi;      /* limits (V) */
    pzs_real *free;         /* 1 swept, 0 standing */
    pzs_real *base;         /* volts around which the gradient is known best (V) */
    pzs_real *bias;         /* effort (base - prefer) */
    pzs_real *want;         /* B'W^2 (e - B base) */
    pzs_real *pull;         /* H (v - base) + bias; after a straight pass as foreseen, but for inputs measured */
    pzs_real *grad;         /* pull - want, the gradient at v */
    pzs_real *move;         /* swept: way to go (V); standing: gradient after it */
    pzs_real *diag;         /* of H */
    pzs_real *start, *start_grad; /* of the round */
    pzs_real *next;         /* grad on F, 0 on S; after boxls_aim the volts aimed at */
    pzs_real *spare;        /* for any sum; after boxls_aim next - base */
    pzs_real soft;          /* trace of the inverse of H on F (V2/m2), 0 where not known */
    pzs_real soft_most;     /* what it cannot exceed, because of effort; 0 where not known */
    pzs_real floor;         /* pivots below this part of their diagonal count as dependent */
    pzs_real rough;         /* epsilon times what rounding of pull is made of (m2/V) */
    pzs_real rough_want;    /* the same of want */
    pzs_real energy;        /* |W e|^2, the scale of the objective (m2) */
    pzs_real left;          /* largest violated optimality condition, of those measured (m2/V) */
    pzs_real noise;         /* what of it may be rounding */
    uint32_t standing;      /* inputs that are not swept */
    uint32_t proven;        /* nonzero where the tableau is: 1 + the first input measured next */
    int done;               /* nonzero at the optimum */
} pzs_optimiser;

typedef struct pzs_control {
    const pzs_problem *problem;
    const pzs_real *influence; /* B in use */
    pzs_optimiser optimiser;
    pzs_real *lower, *upper;   /* [inputs] limits in force (V): table, narrowed by pzs_hold */
    pzs_real *volt;            /* [inputs] last safe volts (V) */
    pzs_real *predicted;       /* [outputs] B volt as of the last tick (m) */
    pzs_real *disturbance;     /* [outputs] measured - predicted (m) */
    pzs_real *measured;        /* [outputs] last measurement (m) */
    pzs_real *slew;            /* [inputs] (V) */
    pzs_real *weighted;        /* [2][outputs] W^2 (e - B base), and what measurements should show */
    uint8_t *frozen;           /* [outputs] ticks a moving output has stood still */
    pzs_real base_energy;      /* |W B base|^2 (m2) */
    pzs_real stiffest;         /* root of the Hessian's largest diagonal (m/V) */
    int32_t where;             /* index that goes with the last status, or -1 */
    uint16_t passes_allowed;   /* budget of one step, at most PZS_STEP_PASSES */
    uint16_t passes;           /* used by the last step */
    uint16_t passes_most;      /* largest seen */
    uint8_t slews;             /* nonzero where a slew is shorter than the way from limit to limit */
    uint8_t ahead;             /* nonzero where volts have changed since `predicted`, 2 if not by a step */
    uint8_t stage;
} pzs_control;

/* Inputs rounded up to whole tiles: the length of a row of hessian and tableau. */
#define PZS_CONTROL_WIDTH(inputs) (((size_t)(inputs) + PZS_TILE - 1u) / PZS_TILE * PZS_TILE)

/* Bytes of workspace for a controller. */
#define PZS_CONTROL_BYTES(inputs, outputs) \
    (sizeof(pzs_real) * ((2u * (size_t)(inputs) + 18u) * PZS_CONTROL_WIDTH(inputs) + 5u * (size_t)(outputs)) + \
     (size_t)(inputs) + (size_t)(outputs))

/*
 * Check the problem and lay a controller out in the workspace; volts start at `prefer`, cut to the limits.
 *   problem   in  must outlive the controller
 *   influence [outputs][inputs] in  computed on the device, read in every step (m/V), or NULL: the problem's own
 *   work      in  caller's memory, aligned for pzs_real, the controller's from now on
 *   bytes     in  at least PZS_CONTROL_BYTES
 * Errors: ARGUMENT, FORMAT, CRC, WORKSPACE, LIMITS (also a negative slew), NONFINITE. After an error the
 * controller cannot be used, whatever it was before.
 */
pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem, const pzs_real *influence,
                            void *work, size_t bytes);

/*
 * Start from volts that the amplifiers give already: after a reset, or after pzs_control_init with the influence at another
 * shape, so that nothing jumps. Cut to the limits; inputs that were held are to be held again.
 *   volt [inputs] in (V)
 * Errors: ARGUMENT, STAGE, NONFINITE (nothing changed).
 */
pzs_status pzs_control_start(pzs_control *control, const pzs_real *volt);

/*
 * Hold one input at a given voltage (dead: 0, stuck: its last), cut to its table limits; release it again.
 * The next step or tick takes it there: where the slew does not reach, the held voltage wins (SLEW).
 * Errors: ARGUMENT, STAGE, NONFINITE.
 */
pzs_status pzs_hold(pzs_control *control, uint16_t input, pzs_real volt);
pzs_status pzs_release(pzs_control *control, uint16_t input);

/*
 * One voltage step from the last volts.
 *   error [outputs] in  wanted shape minus the shape without volts (m)
 * control->volt holds the answer: inside every limit to the last bit, no worse than the last volts cut to the
 * limits, optimal unless a warning says otherwise; worse and optimal but for rounding, epsilon |W B|^2 |v|^2.
 * Work is bounded: passes of at most inputs^2 multiply-adds each, besides at most 16 rebuilds of the
 * tableau, inputs^3 each, where rounding asks for them.
 * Warnings: PASSES, SLEW. Errors: ARGUMENT, STAGE, NONFINITE (volts held; where may be -1: an overflow).
 */
pzs_status pzs_step(pzs_control *control, const pzs_real *error);

/*
 * One control tick: disturbance = measured - predicted, step towards wanted - disturbance, predict.
 *   wanted   [outputs] in  target shape (m)
 *   measured [outputs] in  measured shape (m); NULL: trust the model
 * A measurement that is not finite, or stands still while its output should move, keeps its
 * last disturbance (SENSOR). No usable measurement, or a target that is not finite: volts held, inside
 * the limits now in force (HELD). PASSES and SLEW are told rather than SENSOR. Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_tick(pzs_control *control, const pzs_real *wanted, const pzs_real *measured);

/* How good volts are. */
typedef struct pzs_report {
    pzs_real error;      /* |W (B v - e)| / |W e| */
    pzs_real optimality; /* largest violated KKT condition / largest entry of |B'W^2 e| */
    uint16_t active;     /* inputs at a limit */
} pzs_report;

/*
 * How good the present volts are, worked out from the influence matrix and not from what the step found:
 * 3 inputs*outputs multiply-adds, which no loop needs. Limits are those in force, with slews the last step's.
 *   error  [outputs] in  as of the last pzs_step; after pzs_tick wanted - control->disturbance (m)
 *   report out           untouched after an error
 * Errors: ARGUMENT, STAGE, NONFINITE.
 */
pzs_status pzs_assess(pzs_control *control, const pzs_real *error, pzs_report *report);

/* For comparison only: the unlimited optimum for an error, and the same cut to the limits. Steps after it may differ in
 * their last bits.
 *   volt [inputs] out (V).  Errors: ARGUMENT, STAGE, NONFINITE. */
pzs_status pzs_unlimited(pzs_control *control, const pzs_real *error, pzs_real *volt);
pzs_status pzs_clipped(pzs_control *control, const pzs_real *error, pzs_real *volt);

/* ---- option: dead and stuck electrodes (lib/faults.c) ------------------ */

/*
 * Finds electrodes that do not follow their amplifiers, by the shape alone, and takes them out of the step.
 * A suspect is probed: for about ten ticks it is held at two volts in turn, `swing` to either side of where it was,
 * inside limits and slew, while the step compensates with the others. At most PZS_PROBES are probed at a time.
 * An electrode that has lost more than two swings of volts at once, or is asked to move by as much and does not, is found
 * within 12 ticks of that and the delay of the sensors: 2 for the suspicion, 9 for the probe, 1 to hold it. While more than
 * an eighth of the outputs have no measurement, nobody is watched.
 */
#define PZS_PROBES 4
#define PZS_MOST_DELAY 16

/* States of an electrode; 1 to 100: it was probed, follows, and is left alone for so many ticks. */
enum { PZS_WATCHED = 0, PZS_PROBED = 253, PZS_BLIND = 254, PZS_HELD = 255 };

typedef struct pzs_probe {
    uint16_t input;            /* 0xFFFF: none */
    uint8_t shapes, moves;     /* seen, so far */
    uint8_t side, is_dead;
    pzs_real middle, set;      /* (V) */
    pzs_real lower, upper;     /* limits of the electrode before (V) */
    pzs_real sum, square, response_sum, response_square; /* of the moves, of the responses */
} pzs_probe;

typedef struct pzs_watch {
    pzs_control *control;
    pzs_real *swing;           /* choice [inputs] of a probe (V), at most half the slew; just below half the slew or 1/32 of
                                  the limits, the smaller; 0: not watched */
    uint8_t *state;            /* [inputs] PZS_BLIND: its own volts cannot be told from the others' */
    pzs_envelope columns;      /* B'W^2 B over the outputs measured, factored */
    pzs_real *diagonal;        /* [inputs] of B'W^2 B over all */
    pzs_real *volt;            /* [delay + 1][inputs] of the last ticks (V) */
    pzs_real *before;          /* [inputs] that made the shape before (V) */
    pzs_real *answer;          /* [inputs] what each did beyond its command between two shapes, by least squares (V) */
    pzs_real *moved, *response; /* [inputs] fading sums of squares of moves and responses (V2) */
    pzs_real *lost_volt;       /* [inputs] fading sum of answer (V) */
    pzs_real *shape, *change;  /* [outputs] disturbance at the shape before (m), W^2 times its change */
    uint8_t *missing;          /* [outputs] bit 0: without measurement at the shape before, bit 1: not in columns */
    pzs_probe probe[PZS_PROBES];
    pzs_real ridge;            /* of the diagonal, added to it */
    int32_t where;             /* index that goes with the last status, or -1 */
    uint16_t delay, oldest;
    uint16_t found;            /* electrodes found since the start */
    uint16_t blind;            /* electrodes that cannot be watched */
    uint8_t stale;             /* columns are of other outputs */
    uint8_t stage;
} pzs_watch;

/* Bytes of workspace for a watch. */
#define PZS_WATCH_BYTES(inputs, outputs, delay) \
    (sizeof(pzs_real) * (PZS_DENSE(inputs) + ((size_t)(delay) + 8u) * (size_t)(inputs) + 2u * (size_t)(outputs)) + \
     sizeof(uint32_t) * ((size_t)(inputs) / PZS_TILE + 2u) + (sizeof(uint16_t) + 1u) * (size_t)(inputs) + (size_t)(outputs))

/*
 * Watch over a controller, from its present volts on.
 *   control in/out  must outlive the watch; after pzs_control_init
 *   delay   in      of the measurements, ticks, at most PZS_MOST_DELAY: measured is what the shape was then, and what
 *                   the prediction moved by since, an electrode taken out counting in both with the volts it is held at
 * Errors: ARGUMENT, STAGE, WORKSPACE (where = bytes needed), NONFINITE.
 */
pzs_status pzs_watch_init(pzs_watch *watch, pzs_control *control, uint16_t delay, void *work, size_t bytes);

/*
 * After each pzs_tick (and pzs_quantise), with the same measurements.
 * Warnings: ELECTRODE: input `where` was found (of several the first; all have state PZS_HELD). It is held, dead ones at
 * 0 V, others at their last volts, until pzs_release. Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_watch_tick(pzs_watch *watch, const pzs_real *measured);

/* ---- option: amplifiers with steps and a dead band (lib/amplifier.c) --- */

/*
 * After pzs_tick: what the amplifiers make of control->volt, written there, which the next tick then predicts with. A
 * change of at most dead_band is not made; others go to the last multiple of step on the way, inside limits and slew.
 *   given     [inputs] in/out  volts that the amplifiers give: at the start control->volt, then left alone (V)
 *   step               in      of the converter (V); 0: none
 *   dead_band          in      (V)
 * At rest volts stand still: a step is only taken where the whole of it is asked for. Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_quantise(pzs_control *control, pzs_real *given, pzs_real step, pzs_real dead_band);

/* ---- option: the shape from a few sensors, known loads (lib/estimate.c) - */

/* Gains of an estimator, made by the host from what may disturb the shape. All arrays const, in flash. */
typedef struct pzs_estimator {
    uint32_t format, scene;    /* those of the problem */
    uint32_t crc;              /* over the three counts and both arrays */
    uint16_t inputs, outputs, sensors;
    const pzs_real *direct;    /* S [sensors][inputs] what sensors show per volt (V/V, C/V, m/V) */
    const pzs_real *gain;      /* G [outputs][sensors] shape per what they show besides (m/V, m/C, 1) */
} pzs_estimator;

typedef struct pzs_estimate {
    pzs_control *control;
    const pzs_estimator *tables;
    pzs_real *expected;        /* [sensors] S volt */
    pzs_real *sensed;          /* [sensors] last readings */
    pzs_real *difference;      /* [sensors] reading - expected */
    uint8_t *frozen;           /* [sensors] ticks a reading has stood still that should move */
    int32_t where;             /* index that goes with the last status, or -1 */
    uint8_t stage;
} pzs_estimate;

/* Bytes of workspace for an estimate. */
#define PZS_ESTIMATE_BYTES(sensors) (sizeof(pzs_real) * 3u * (((size_t)(sensors) + 3u) / 4u * 4u) + (size_t)(sensors))

/*
 * Lay an estimate out in the workspace; control and tables must outlive it.
 * Errors: ARGUMENT (also tables of other counts), STAGE, FORMAT, CRC, NONFINITE, WORKSPACE (where = bytes needed).
 */
pzs_status pzs_estimate_init(pzs_estimate *estimate, pzs_control *control, const pzs_estimator *tables, void *work,
                             size_t bytes);

/*
 * Before each pzs_tick: the shape that goes with the sensors' readings under the controller's present volts,
 * B v + G (s - S v), to be handed to it as measured.
 *   sensed [sensors] in
 *   shape  [outputs] out (m)
 * A reading that is not finite or frozen keeps its last difference. Warnings: SENSOR, HELD: no reading is of use.
 * Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_estimate_tick(pzs_estimate *estimate, const pzs_real *sensed, pzs_real *shape);

/* The shape per unit of loads and temperatures whose amounts the firmware knows. In flash. */
typedef struct pzs_known {
    uint32_t format, scene;    /* those of the problem, which the firmware compares: a shape has no scene */
    uint32_t crc;              /* over the two counts and the array */
    uint16_t amounts, outputs;
    const pzs_real *per;       /* [outputs][amounts] (m/N, m/Pa, m/K) */
} pzs_known;

/* Are they complete and undamaged? OK, ARGUMENT, FORMAT, CRC, NONFINITE. */
pzs_status pzs_known_check(const pzs_known *tables);

/*
 * Take what known loads do out of a shape: before a tick, out of `measured` by the amounts at the measurement, out of
 * `wanted` by those to come; with an estimator not out of `measured` but out of its readings, by a table with a row for
 * each sensor. The controller then sees the unknown rest alone, and meets the known part before it shows.
 *   amount [amounts] in
 *   shape  [outputs] in/out (m)
 * Errors: ARGUMENT, NONFINITE (shape untouched).
 */
pzs_status pzs_feed_forward(const pzs_known *tables, const pzs_real *amount, pzs_real *shape);

#endif
