/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A scene: everything that a user states about a structure, read from a YAML file and checked. The
 * members are plain input data in the units of the scene, ply angles in degrees. The scene owns all
 * strings and arrays, which scene_free releases.
 */
#ifndef SCENE_H
#define SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "bicubic.h"
#include "../quads/quad_read.h"
#include "load_types.h"
#include "outline.h"
#include "output_types.h"
#include "scene_dimension.h"
#include "scene_error.h"
#include "spline.h"

/*
 * Sizes and limits of a scene.
 *   SCENE_NAME   bytes of a name
 *   SCENE_LABEL  bytes of the name of an amplifier or electrode, which is a name and its position
 *       _i_j in a grid
 *   SCENE_NODES  largest number of mesh nodes
 *   SCENE_FREE   largest number of free functions of a target, such as rigid motions, any multiple
 *       of which may be added to it without counting as error
 */
enum { SCENE_NAME = 64, SCENE_LABEL = SCENE_NAME + 24, SCENE_NODES = 60000, SCENE_FREE = 16 };

typedef enum scene_surface_type {
    SURFACE_PLATE,
    SURFACE_POLAR,
    SURFACE_CYLINDER,
    SURFACE_CONE,
    SURFACE_SPHERE,
    SURFACE_HYPERBOLOID,
    SURFACE_TORUS,
    SURFACE_REVOLUTION,
    SURFACE_SPIRAL,
    SURFACE_PARABOLOID,
    SURFACE_FORMULA,
    SURFACE_POINTS
} scene_surface_type;

typedef struct scene_surface {
    scene_surface_type type;
    double radius; /* radius of a cylinder or sphere, radius of a cone at the surface coordinate
                      theta1 = 0, or major radius of a torus (length unit of the scene file) */
    double angle;  /* angle between the axis of a cone and its surface (degrees) */
    int axial; /* number of the surface coordinate that runs along the axis of a cylinder or spiral:
                  1 for theta1, 2 for theta2 */
    double waist, height; /* constants of a hyperboloid of revolution, whose radius at the height z
                             is waist sqrt(1 + (z/height)^2) */
    double tube;          /* minor radius of a torus (length unit of the scene file) */
    double inner, outer, turns; /* radius of a spiral at angle 0, its radius at its end, and its
                                   number of turns */
    double focal_length; /* distance of the focus of a paraboloid from its vertex (length unit of
                            the scene file) */
    expr *formula[3];    /* formulas of the coordinates x, y and z of a surface in the surface
                            coordinates theta1 and theta2; a coordinate whose formula is NULL is
                            theta1, theta2 or 0 */
    spline *meridian; /* meridian (r, z) of a surface of revolution, a spline whose parameter is the
                         chord length */
    bicubic points; /* height z over x and y of a surface fitted to measured points; empty on other
                       surfaces */
} scene_surface;

typedef enum scene_kinematics {
    KINEMATICS_LINEAR,
    KINEMATICS_NONLINEAR,
    KINEMATICS_AUTO
} scene_kinematics;

/* Settings of the solver for the nonlinear equilibrium. */
typedef struct scene_equilibrium {
    int load_steps;   /* number of load steps that the equilibrium solver tries first */
    double tolerance; /* convergence tolerance of a load step: largest norm of the last increment
                         relative to the displacement of the step */
    int extrapolated_iterations; /* number of iterations at the start of a load step whose tangent
                                    stiffness uses predicted stress resultants: those of the present
                                    displacement, extrapolated by the last increment. Later
                                    iterations use the present ones. 0: Newton's method throughout
                                  */
    int ramp_solves;    /* number of linear solves at the start of a load step over which its loads
                           rise in equal parts to their full size; 1: the first linear solve has the
                           full loads; 0: the program chooses */
    int linear_solves;  /* largest number of systems of linear equations that are solved for one
                           nonlinear equilibrium */
    bool path_in_steps; /* whether the load path consists of equal load steps, in place of steps of
                           the arc-length method */
    scene_at at;
} scene_equilibrium;

/*
 * Treatment of the in-plane strains, which contain a part quadratic in the height over the
 * reference surface: what replaces the squared height in this part.
 */
typedef enum scene_squares {
    SQUARES_OF_FACES, /* the squared height is replaced by the straight line with the same values at
                         the two faces of the shell */
    SQUARES_FITTED, /* the squared height is replaced by the straight line that deviates least from
                       it, with the stiffness of the plies as weight */
    SQUARES_OMITTED /* the squared height is replaced by zero in products of displacements, and
                       counts in the part that the curvature of the undeformed shell causes */
} scene_squares;

/*
 * Formulation of the finite element, selected in the scene file by `element: published`, `element:
 * improved`, or a map of single options.
 */
typedef struct scene_element {
    bool cartesian; /* true: strains are computed from differences of the displacement vectors of an
                       element's corners; false: from derivatives of displacement components in the
                       local axes of the surface (triad) */
    double tau; /* factor (dimensionless) of a term that is added to the membrane shear strain of
                   curved elements (warp.h). The term is proportional to their warping: normal
                   displacements of the four corners with alternating signs. 1: bending of curved
                   shells converges faster; 0: no such term */
    double rho; /* factor (dimensionless) of a flexibility that is added to the transverse shears of
                   an element: bending flexibility 12/(E h^3) times L^2/12, with the length L of the
                   element. Without it, elements much longer than thick bend too little */
    bool hr, lin33; /* hr: the linear and bilinear strain modes contain only some of the strains. In
                       these modes the stress resultants of the other strains are 0 if hr is true
                       (Hellinger-Reissner); if it is false, these strains are 0. lin33: true lets
                       each ply thicken freely */
    bool metric;    /* true: strains take the exact variation of the surface metric through the
                       thickness; false: metric of the reference surface */
    bool exact_area;  /* area of an element in its stiffness and loads, on a mesh along lines of
                         constant surface coordinates. true: its exact area on the surface; false:
                         the area from the metric of the surface at its centre */
    int dof_per_node; /* number of dof of a node, 7 or 6; the seventh is the displacement of the
                         middle surface along the normal, relative to the mean of both faces */
    bool equilibrium_shear; /* true: transverse shear stiffness of a laminate from equilibrium of
                               its layers; false: from a shear strain that is constant through the
                               thickness */
    int quadratic;          /* what replaces the squared height in the in-plane strains; a value of
                               scene_squares */
} scene_element;

typedef struct scene_line { /* Mesh lines along which one surface coordinate, theta1 or theta2, is
                               constant. */
    int elements;
    double *point; /* [elements + 1] coordinates of the mesh lines, ascending (length or rad) */
    bool slit; /* true: the two ends of a mesh direction that covers a full turn are not joined */
    scene_at at;
} scene_line;

/*
 * Mesh that is read from a file, in place of mesh lines on a surface. The regions (elements with
 * equal layers), constrained dof and axes of the mesh follow from the layers, patches and supports
 * of the scene.
 */
/*
 * Direction from which the angles of layers are measured on a mesh of quadrilaterals: its
 * projection on each element is axis 1 of a layer with angle 0.
 */
typedef struct scene_ply_direction {
    bool given; /* true: the scene gives the direction from which the angles of layers are measured;
                   false: this direction is that from corner 1 to corner 2 of each element */
    expr *formula[3];     /* components of the direction as functions of the position; NULL: the
                             direction follows a set of edges */
    char set[SCENE_NAME]; /* name of the set of edges whose direction the elements near them have;
                             empty: the direction is given by formulas */
    scene_at at;
} scene_ply_direction;

typedef struct scene_quads {
    quad_mesh mesh;
    quad_warnings warnings;
    char *file;            /* name of the mesh file as it is written in the scene file */
    bool accept_irregular; /* elements that are too thin for an irregular mesh (factor
                              quad_rule.lock above QUAD_LOCK) have too stiff a bending: true: they
                              are accepted with a warning; false: the mesh is refused */
    double place_gap; /* The scene uses the mesh node nearest to a place instead of a place that it
                         names by coordinates. Largest distance between such a place and its node,
                         over the longest diagonal of the elements at the node */
    int64_t place_node; /* number, in the mesh file, of the node to which the largest distance
                           place_gap belongs; 0 if the nodes have no numbers */
    scene_at place_at;  /* position in the scene file of the place that lies farthest from its node,
                           at the distance place_gap */
    scene_at at;
} scene_quads;

/* Rule by which the stresses of a ply are compared with its strengths. */
typedef enum scene_criterion { CRITERION_TSAI_HILL, CRITERION_MAXIMUM_STRESS } scene_criterion;

/* Strengths of a material in its axes. */
typedef struct scene_strength {
    bool given;
    double tension[2];     /* strength of a material under tension along its axes 1 and 2 */
    double compression[2]; /* strength of a material under compression along its axes 1 and 2, as
                              positive numbers */
    double shear;          /* strength of a material under shear in the plane of its axes 1 and 2 */
    scene_criterion criterion;
} scene_strength;

typedef struct scene_material {
    char name[SCENE_NAME];
    double e[3], g23, g13, g12, nu12, nu13, nu23; /* engineering constants of a material: Young's
                                                     moduli e, shear moduli g and Poisson's ratios
                                                     nu of the directions 1, 2 and 3; those of an
                                                     isotropic material follow from E and nu */
    double d31, d32, d33, d24, d15; /* piezoelectric constants (m/V): strain per electric field,
                                       with the poling along direction 3 */
    double piezo_e[5]; /* piezoelectric constants e31, e32, e33, e24, e15 (C/m2): stress per
                          electric field; valid if has_e is true */
    bool has_d, has_e;
    bool lacks_32;              /* true where the scene gives d31 but not d32, or e31 but not e32:
                                   the missing one is 0 */
    double permittivity;        /* permittivity along the poling at constant strain (F/m); 0 if not
                                   given */
    double permittivity_across; /* permittivity across the poling direction at constant strain (F/m)
                                 */
    double pyroelectric; /* pyroelectric constant along the poling direction at constant strain
                            (C/(m2 K)) */
    double alpha[3]; /* thermal expansion coefficients of a material along its axes 1, 2 and 3 (1/K)
                      */
    double density;  /* mass of the material per volume (units of the scene file); its weight per
                        volume is this density times gravity */
    double field_limit; /* depolarisation field of a piezoelectric material (V/m); 0: no limit */
    scene_strength strength; /* strengths of the material, with which `pzs solve --stress` compares
                                the stresses */
    double film_thickness; /* thickness of a film actuator whose constants come from its data sheet
                              (length unit of the scene file); 0: no film */
    double film_voltage;   /* voltage at which the data sheet of a film actuator states its free
                              strain (V); 0: no film */
    int poling; /* poling direction of a material: along the axis 1, 2 or 3 of its layer, negative
                   against that axis; the axis 3 is the normal of the surface */
    scene_at at;
} scene_material;

/*
 * Faces of a piezoelectric layer that carry no electrode, as bits: the potential of a bare face
 * (without electrode) varies from node to node. The other face of a layer with one bare face is an
 * electrode at 0 V.
 */
enum { BARE_NONE = 0, BARE_INNER = 1, BARE_OUTER = 2, BARE_BOTH = 3 };

typedef struct scene_layer {
    char name[SCENE_NAME];
    int material;
    double thickness, angle;
    bool patched; /* true: a piezoelectric layer consists of patches, and there is no material
                     between them */
    int poling;   /* poling direction of a layer, from the layer or else from its material: along
                     its axis 1, 2 or 3, negative against that axis */
    double finger_distance; /* distance of the interdigitated electrodes on the faces of a layer
                               that is poled along the surface (m): the field of a voltage is along
                               the poling; 0: electrodes cover the faces, the field is along the
                               normal */
    int bare;               /* faces without electrode: BARE_NONE, BARE_INNER, BARE_OUTER or
                               BARE_BOTH */
    unsigned char *present; /* [elements] 1 in the elements of the layer's element sets, on a mesh
                               from a file; NULL: the layer has no sets */
    scene_at at;
} scene_layer;

typedef struct scene_patches { /* Rectangular grid of piezoelectric patches on one layer. */
    char name[SCENE_NAME];
    int layer;
    double theta1[2], theta2[2]; /* ranges of the surface coordinates theta1 and theta2 that a grid
                                    of patches covers, both ends on mesh lines; default the whole
                                    mesh */
    int grid[2]; /* number of patches along the surface coordinates theta1 and theta2, default 1 and
                    1; every edge of a patch must be a mesh line; on a mesh from a file: number of
                    element sets and 1 */
    int *patch;  /* [elements] number of the patch to which each element of a mesh from a file
                    belongs; -1: the element has no patch; NULL on other meshes */
    outline_plane plane; /* plane in whose coordinates the outlines of the electrodes are given */
    bool cut; /* true: the outline of an electrode may extend beyond the surface, and its part on
                 the surface counts; false: such an outline is refused */
    scene_outlines *outlines; /* electrodes with outlines of any shape, which replace the coordinate
                                 ranges or element sets of the patches; NULL: patches of whole
                                 elements */
    bool is_smeared; /* true: the material of the layer ends at the outlines of the electrodes, and
                        its stiffness and mass are smeared over the elements that an outline cuts;
                        false: outlines are those of electrodes on a continuous layer */
    scene_at at;
} scene_patches;

typedef struct scene_drive {
    int patches;
    double factor;
} scene_drive;

typedef enum scene_edge {
    EDGE_NONE,
    EDGE_THETA1_MINUS,
    EDGE_THETA1_PLUS,
    EDGE_THETA2_MINUS,
    EDGE_THETA2_PLUS
} scene_edge;

/*
 * Type of a set of nodes: an edge, all nodes, the node at given surface coordinates, or the nodes
 * of a rectangular region of the mesh; on a mesh from a file also a named set, or the node nearest
 * to a point in space.
 */
typedef enum scene_where_type {
    WHERE_EDGE,
    WHERE_NODES,
    WHERE_POINT,
    WHERE_REGION,
    WHERE_SET,
    WHERE_PLACE
} scene_where_type;
typedef struct scene_where {
    scene_where_type type;
    scene_edge edge;
    double theta[2];   /* surface coordinates theta1 and theta2 of the node, where a single node of
                          the mesh is meant */
    double span[2][2]; /* start and end of a region along the surface coordinates theta1 and theta2;
                          infinite where the scene file gives no limit */
    int node[2]; /* indices of the mesh lines of the surface coordinates theta1 and theta2 on which
                    a point lies; on a mesh from a file, node[0] is the number of the node nearest
                    to the point */
    char set[SCENE_NAME]; /* name of the set of nodes, edges or elements in the mesh file to which
                             an item of the scene file refers */
    double x[3]; /* coordinates x, y, z of a point in space, on a mesh from a file (length unit of
                    the scene file) */
    scene_at at;
} scene_where;

typedef enum scene_face {
    FACE_MIDDLE,
    FACE_INNER,
    FACE_OUTER,
    FACE_MEAN
} scene_face; /* Face of the shell on which a load acts or whose displacement is an output; a load
                 on the middle surface acts half on each face. */
typedef enum scene_component {
    COMPONENT_U1,
    COMPONENT_U2,
    COMPONENT_U3,
    COMPONENT_X,
    COMPONENT_Y,
    COMPONENT_Z
} scene_component;

/* Direction of a spring or of a stack actuator. */
typedef struct scene_direction {
    bool given;
    scene_component component; /* direction along an axis of the local triad (e1, e2, normal) or
                                  along a global axis, where the scene file gives no components of
                                  the direction */
    double vector[3]; /* direction of a spring or stack as a unit vector (x, y, z); zero if it is
                         not given as a vector */
} scene_direction;

/*
 * Quantity to which the stiffness of a spring refers: each point (PER_POINT), unit length of an
 * edge (PER_LENGTH), or unit area (PER_AREA).
 */
typedef enum scene_per { PER_POINT, PER_LENGTH, PER_AREA } scene_per;

/*
 * Springs of equal stiffness between points of the shell and the ground, or between points and one
 * node of the shell. A stack actuator is described by the same C struct; each stack has one
 * amplifier.
 */
typedef struct scene_spring {
    char name[SCENE_NAME]; /* name of the springs; empty if the scene file gives none */
    scene_where where; /* nodes to which one spring each is attached. If the springs are attached at
                          points instead, the key is absent and where.at.column is 0 (the column in
                          the scene file counts from 1) */
    int points;
    double (*point)[3]; /* [points] attachment points of the springs: surface coordinates theta1,
                           theta2 and 0, or x, y, z on a mesh from a file, where z is NAN if it is
                           not given */
    scene_where to; /* node at the other end of the springs. If they end at the ground, the key is
                       absent and to.at.column is 0 (the column in the scene file counts from 1) */
    scene_direction along; /* direction of elongation: a displacement of the shell along it
                              elongates the springs */
    scene_direction about; /* axis of torsional springs: a rotation of the shell about it twists
                              them */
    scene_face face;       /* face of the shell to which the springs are attached */
    double stiffness; /* stiffness of one spring, or of springs per length or area, as `per` tells:
                         force per elongation, for a torsional spring moment per angle (rad), in the
                         units of the scene file */
    int per; /* whether `stiffness` belongs to one spring, to a length or to an area; a value of
                scene_per */
    double force; /* blocked force (force without elongation) of a stack actuator per volt (or other
                     unit) of its input */
    double stroke; /* free stroke (elongation without load) of a stack actuator per volt (or other
                      unit) of its input; 0 if the blocked force is given */
    scene_at at;
} scene_spring;

/*
 * Equal concentrated masses at nodes or points of the shell, without stiffness.
 */
typedef struct scene_mass {
    char name[SCENE_NAME]; /* name of the masses; empty if the scene file gives none */
    scene_where where; /* nodes at which one mass each is attached. If the masses are attached at
                          points instead, the key is absent and where.at.column is 0 (the column in
                          the scene file counts from 1) */
    int points;
    double (*point)[3]; /* [points] attachment points: surface coordinates theta1, theta2 and 0, or
                           x, y, z on a mesh from a file, where z is NAN if it is not given */
    scene_face face;    /* face of the shell with which the masses move */
    double mass;        /* one mass, or mass per length or area, as `per` tells (units of the scene
                           file) */
    int per;        /* whether `mass` belongs to one point, to a length or to an area; a value of
                       scene_per */
    double inertia; /* moment of inertia of one mass about its centre, for rotations about any
                       axis in the surface (units of the scene file) */
    scene_at at;
} scene_mass;

/*
 * An actuator: amplifiers for grids of patches (one for each position in the grid, connected with
 * signed factors), one uniform temperature, heaters on patches, or stacks with one amplifier each.
 * The same struct describes a sensor, which has electrodes but no amplifiers.
 */
typedef struct scene_actuator {
    char name[SCENE_NAME];
    int drives;
    scene_drive *drive;
    bool is_temperature;  /* whether the input of the actuator is a temperature: that of the layers
                             under its patches or, if `drives` is 0, of the whole shell; otherwise
                             the input is a voltage */
    scene_spring *stacks; /* points, directions and stiffness of the stacks of a stack actuator;
                             NULL: the actuator has no stacks */
    double applied;       /* input that each amplifier of the actuator has where voltages are not
                             optimised: a voltage (V), or the temperature of a heater (K). If the
                             scene file gives a list with one value for each amplifier, this is the
                             value of largest magnitude */
    double *each; /* [grid[0] * grid[1]] input of each amplifier, a voltage (V) or the temperature
                     of a heater (K), where voltages are not optimised; NULL where all have the
                     value `applied` */
    bool open;    /* electrodes of a sensor: true: open circuit; false: short circuit */
    int first, grid[2]; /* first: number of the first amplifier of an actuator among those of all
                           actuators, or of the first electrode of a sensor among those of all
                           sensors; grid: number of patches along the surface coordinates theta1 and
                           theta2; amplifiers are numbered fastest along theta2 */
    scene_at at;
} scene_actuator;

/*
 * Bits of a support on a mesh from a file whose constrained dof depend on the edge or on the node:
 * simply supported edge, symmetry plane, and displacements along x, y and z. The lower seven bits
 * stand for the seven dof of a node.
 */
enum { FIX_SIMPLE = 128, FIX_SYMMETRIC = 256, FIX_X = 512, FIX_Y = 1024, FIX_Z = 2048 };

/*
 * Bits of an oblique support, which holds the mean displacement along a direction in space, or the
 * two mean displacements across this direction.
 */
enum { FIX_ALONG = 4096, FIX_ACROSS = 8192, FIX_OBLIQUE = FIX_ALONG | FIX_ACROSS };

typedef struct scene_support {
    char name[SCENE_NAME]; /* name of the support in the results; where the scene file gives none,
                              the name of its set or edge, or its number. The reactions of supports
                              of one name are added */
    scene_where where;
    double direction[3]; /* unit vector whose projection on the surface is the first local axis of
                            the support's nodes, or the direction of an oblique support; zero
                            vector: not given */
    expr *formula[3];    /* components of the direction of an oblique support as formulas of the
                            position of the node; NULL: the direction is given by numbers */
    /*
     * dof of its nodes that the support holds, one bit each:
     *   0 to 2    mean displacements of both faces along the local axes of the node
     *   3 to 5    differences of the displacements of both faces
     *   6         normal displacement of the middle surface relative to the mean of both faces
     *   from 128  FIX_SIMPLE to FIX_ACROSS: directions other than the local axes
     */
    unsigned fix;
    expr *value; /* formula of the displacement that a support prescribes at full load (length unit
                    of the scene file); NULL: 0 */
    unsigned move; /* displacements that the support prescribes as `value`: a part of the bits in
                      `fix`. The dof of all other bits in `fix` are 0. For a normal displacement,
                      for example, the mean of both faces is prescribed and their difference is 0.
                      FIX_ALONG: mean displacement along the direction of an oblique support */
    scene_direction about; /* axis of a support that holds or prescribes a rotation; not given for
                              other supports */
    int turn; /* local axis about which the support rotates its nodes. 1: e2; -1: e1; 0: no
                 rotation. The angle a (rad, formula `value`) prescribes the difference of both
                 faces' displacements over the thickness: sin(a) along e1 for a rotation about e2,
                 -sin(a) along e2 for one about e1 */
    scene_at at;
} scene_support;

#define LOAD_TYPE(type, words, quantity, forces) type,
typedef enum scene_load_type { LOAD_TYPES(LOAD_TYPE) LOAD_TYPE_COUNT } scene_load_type;
#undef LOAD_TYPE

/*
 * Type of a pressure whose direction follows the deformed shell. FOLLOWER_NORMAL acts along the
 * unit normal of the deformed outer face with its magnitude per reference area; FOLLOWER_PRESSURE
 * acts per deformed area.
 */
typedef enum scene_follower { FOLLOWER_NONE, FOLLOWER_NORMAL, FOLLOWER_PRESSURE } scene_follower;

typedef struct scene_load {
    scene_load_type type;
    scene_where where; /* nodes on which a point load or line load acts; for a face load on a mesh
                          from a file, the element set that it is limited to */
    scene_face face;
    scene_component component; /* displacement component along which a load acts, such as the one
                                  normal to the surface for a pressure */
    double vector[3]; /* unit vector (x, y, z) along which a weight acts; zero vector: the weight
                         acts along `component` */
    scene_direction about; /* axis about which a point load acts as a moment */
    expr *value; /* formula of the load: force or moment at a point, force per length or per area,
                    temperature (K), or the acceleration of gravity for a weight */
    expr *outer; /* formula of the temperature change at the outer face (K), where `value` is that
                    at the inner face; NULL: the temperature is uniform */
    bool true_area; /* face load: true: load per area of the loaded face; false: load per area of
                       the reference surface */
    scene_follower follower; /* way in which a pressure on a face turns with the deformed shell; a
                                FOLLOWER_PRESSURE acts on the deformed area */
    scene_at at;
} scene_load;

/* Rigid convex body that the shell may touch; all vectors have the components x, y, z. */
typedef enum scene_body_type { BODY_PLANE, BODY_CYLINDER, BODY_SPHERE, BODY_PSI } scene_body_type;
typedef struct scene_body {
    scene_body_type type;
    double point[3];  /* point that fixes the position of a rigid body: a point of a plane, a point
                         on the axis of a cylinder, or the centre of a sphere (length unit of the
                         scene file) */
    double normal[3]; /* unit normal of the plane that bounds a rigid body, pointing out of the body
                       */
    double axis[3];   /* unit vector along the axis of a rigid cylinder */
    double radius;    /* radius of a rigid cylinder or sphere (length unit of the scene file) */
    expr *value; /* level-set function psi(x, y, z) of a rigid body, positive outside the body */
} scene_body;

typedef struct scene_contact {
    bool given;
    scene_face face; /* face of the shell that may touch the rigid body, inner or outer */
    scene_body body;
    double move[3]; /* displacement x, y, z of the rigid body at full load (length unit of the scene
                       file) */
    double stiffness; /* penalty stiffness of the contact at a node in the first iteration of a load
                         step, as a multiple of the stiffness of the shell at this node
                         (dimensionless) */
    scene_at at;
} scene_contact;

#define OUTPUT_TYPE(type, ...) type,
typedef enum scene_output_type { OUTPUT_TYPES(OUTPUT_TYPE) OUTPUT_TYPE_COUNT } scene_output_type;
#undef OUTPUT_TYPE

/*
 * What each value of an output belongs to: SPREAD_NODES: a node of the mesh; SPREAD_ELECTRODES: an
 * electrode; SPREAD_TOTAL: the output has one value for all its nodes, or for the whole structure.
 */
typedef enum scene_output_spread {
    SPREAD_NODES,
    SPREAD_ELECTRODES,
    SPREAD_TOTAL
} scene_output_spread;

/*
 * When a sensor of the device may measure an output: always, only if the kinematics is linear
 * (READING_LINEAR), or never.
 */
typedef enum scene_output_reading {
    READING_ALWAYS,
    READING_LINEAR,
    READING_NEVER
} scene_output_reading;

typedef struct scene_output {
    char name[SCENE_NAME];
    scene_output_type type; /* quantity that the output measures */
    int part; /* component of the quantity, such as x, y or z of a force: index in the list of words
                 that the scene file accepts for this type of output */
    char support[SCENE_NAME]; /* name of the supports whose reaction an output gives; empty: the
                                 output is the reaction at given nodes of the mesh */
    int layer;  /* layer of a strain, stress or potential output; -1: a strain that is measured over
                   all layers together */
    int height; /* height of a strain, stress or potential output in its layer, or in all layers
                   together: 0 inner face, 1 middle, 2 outer face */
    double angle;      /* angle from axis 1 of the shell to axis 1 of the strain or stress that the
                          output      gives (degrees) */
    bool of_sensor;    /* used for voltages and charges of electrodes only. true: electrodes of
                          sensors; false: electrodes that amplifiers drive */
    int first, count;  /* range of the electrodes of an electric output: numbers first to first +
                          count - 1 */
    scene_where where; /* nodes of the output; its position in the scene file is 0 for an output
                          without nodes, such as a charge or the force of the whole contact */
    scene_component component; /* direction of a displacement output */
    scene_face face;           /* face of the shell whose displacement the output is */
    double reference; /* reference value of an output that is printed beside the computed value; NAN
                         if not given */
    scene_at at;
} scene_output;

/* Properties that all outputs of one type have in common, from the table in output_types.h. */
typedef struct scene_output_info {
    const char *word; /* name of the quantity in messages, such as "contact force" */
    const char *keys; /* keys, separated by blanks, that outputs of this type take in addition to
                         those of all outputs */
    dimension of;     /* physical dimension of the values of the output */
    scene_output_spread spread;
    scene_output_reading reading;
} scene_output_info;

const scene_output_info *scene_output_info_of(scene_output_type type);

/*
 * One of several target shapes for which the voltages are optimised one by one: its name and
 * formula; its displacement component, nodes and weights are those of the scene's target.
 */
typedef struct scene_mode {
    char name[SCENE_NAME];
    expr *value;
    scene_at at;
} scene_mode;

typedef struct scene_target {
    bool given;
    scene_output what; /* component of the displacement that is controlled, and the face and nodes
                          at which it is controlled */
    expr *value; /* formula of the desired displacement in the coordinates of the nodes (length unit
                    of the scene file) */
    int modes;
    scene_mode *mode; /* [modes] shapes for which the voltages are optimised one by one, where the
                         target is a list of shapes */
    bool weight_area; /* weights of the nodes in the target error: true: by the area of each node;
                         false: equal */
    int frees;
    scene_mode *free; /* [frees] functions that may be added to the target at no cost: their best
                         fit is removed from the shape error */
} scene_target;

typedef struct scene_compare {
    char name[SCENE_NAME];
    int count;
    double *value;
    scene_at at;
} scene_compare;

/*
 * Limits of a group of amplifiers, those with the numbers first to first + count - 1, beside the
 * limits of all amplifiers.
 */
typedef struct scene_limit {
    int first, count;
    bool is_tied; /* whether this entry limits a single one of several actuators that one amplifier
                     drives together; the narrowest limits of these actuators then apply to the
                     amplifier. false: the entry limits amplifiers */
    int tied; /* index of the actuator to which these limits belong, in the file of the influence
                 matrix; used if is_tied is true */
    bool has_voltage;    /* whether the amplifiers from `first` on, `count` in number, have voltage
                            limits of their own; otherwise the limits of all amplifiers apply to
                            them */
    double lower, upper; /* lower and upper voltage limit (V); equal limits fix the voltage */
    double step_limit;   /* largest change of the voltage in one tick (V); infinite if not given. If
                            several entries limit one amplifier, the narrowest applies */
    scene_at at;
} scene_limit;

/*
 * Limit of a weighted sum of voltages: the sum over some amplifiers of (factor times voltage) has a
 * lower and an upper limit.
 */
typedef struct scene_limit_row {
    int count;
    int *amplifier; /* [count] numbers of the amplifiers whose voltages occur in the weighted sum */
    double *factor; /* [count] factor of the voltage of each amplifier in the weighted sum
                       (dimensionless) */
    double lower, upper; /* lower and upper limit of a weighted sum of voltages (V) */
    bool is_absolute;    /* whether the sum of the absolute values of the voltages is limited */
    scene_at at;
} scene_limit_row;

typedef struct scene_limits {
    double lower, upper, step_limit; /* lower and upper voltage limit (V) and step limit, the
                                        largest change of a voltage in one tick (V), of all
                                        amplifiers; infinite if not given */
    double regularisation; /* weight of the regularisation: factor of the sum of squared distances
                              of the voltages from their reference voltages in the objective;
                              absolute (length^2/V^2), or over the mean diagonal entry of the
                              Hessian if regularisation_is_relative is true */
    bool regularisation_is_relative;
    int each_count;
    scene_limit *each; /* [each_count] limits of single amplifiers: voltage limits, which override
                          the common ones, and step limits, which narrow the common one */
    int rows;
    int absolute_rows; /* number of limits of sums of absolute values; they are the last entries of
                          `row` */
    scene_limit_row *row; /* [rows] limits of several voltages together: first those of differences
                             and of weighted sums, then those of sums of absolute values */
    scene_at at;
} scene_limits;

/*
 * Measurement that the firmware receives: all values of one output, with noise of the given
 * standard deviation.
 */
typedef struct scene_reading {
    int output;
    double noise;
    double range; /* largest believable size of the reading (unit of the output); 0: not given */
    scene_at at;
} scene_reading;

/*
 * Measurements from which the firmware estimates the shape, and the standard deviations of the
 * disturbances that the estimator assumes.
 */
typedef struct scene_estimate {
    bool given;
    int readings;
    scene_reading *reading;
    double loads; /* standard deviation of the unknown factor by which each load of the scene file
                     is multiplied in reality (dimensionless) */
    double voltages;  /* assumed standard deviation of the difference between the voltage that an
                         amplifier should give an electrode and the true one (V); -1: a twentieth of
                         the voltage range of the electrode */
    double tolerance; /* largest permitted error of the estimated shape, as a fraction of the shape
                         that the disturbances cause (both root mean square); sensor readings that
                         leave a larger error are refused */
    scene_at at;
} scene_estimate;

/* Type of a change that takes place at one tick of a simulation. */
typedef enum scene_event_type {
    EVENT_TARGET,
    EVENT_VALUE, /* simulation event: the target is multiplied by a factor (EVENT_TARGET) or
                    replaced (EVENT_VALUE) */
    EVENT_LOAD,
    EVENT_TEMPERATURE, /* simulation event: a load is multiplied by a factor (EVENT_LOAD), or the
                          structure is heated (EVENT_TEMPERATURE); the controller is informed of
                          loads that are fed forward */
    EVENT_DEAD,
    EVENT_STUCK,
    EVENT_ALIVE, /* simulation event: electrodes fall to 0 V (EVENT_DEAD), keep their last voltage
                    (EVENT_STUCK), or work again (EVENT_ALIVE) */
    EVENT_MISSING_SENSORS,
    EVENT_STUCK_SENSORS, /* simulation event: a fraction of the sensors reads NaN
                     (EVENT_MISSING_SENSORS) or keeps its last value (EVENT_STUCK_SENSORS) */
    EVENT_WRONG_SENSORS, /* simulation event: for some ticks a fraction of the sensors reads too
                            much, by `error` */
    EVENT_MISSED_TICKS,  /* simulation event: the controller does not run for some ticks */
    EVENT_IMPULSE, /* simulation event: a load acts like a hammer blow; the impulse of its force
                      during `size` seconds is applied in one instant */
    EVENT_SINE,    /* simulation event: for some ticks a load is multiplied by `size` times sin(2 pi
                      frequency time) */
    EVENT_LATE,    /* simulation event: for some ticks each voltage change takes effect late, by a
                      random fraction of the tick interval that is at most `size` */
    EVENT_JITTER,  /* simulation event: for some ticks the tick interval is lengthened or shortened
                      by a random fraction of at most `size` */
    EVENT_DELAY    /* simulation event: for some ticks the readings arrive `size` ticks later than
                      the controller assumes */
} scene_event_type;

/*
 * Special values of the delay after which the controller learns of an electrode fault: it is never
 * informed, or it detects the fault itself.
 */
enum { ANNOUNCED_NEVER = -1, ANNOUNCED_DETECTED = -2 };

typedef struct scene_event {
    scene_event_type type;
    int tick;     /* number of the tick at which the simulation event takes place; events are in
                     ascending order */
    double size;  /* size of an event: factor of the target or of a load, temperature (K), or
                     probability that a sensor is affected */
    double error; /* EVENT_WRONG_SENSORS: what is added to the readings (unit of each reading) */
    int ticks; /* duration of those simulation events that end by themselves, such as missing sensor
                  readings or missed ticks (ticks) */
    int load;  /* index of the load that EVENT_LOAD, EVENT_IMPULSE and EVENT_SINE change */
    double frequency;  /* frequency (Hz) at which EVENT_SINE varies a load */
    bool feed_forward; /* EVENT_LOAD: whether the controller is given the factor of the load one
                          tick in advance */
    int amplifiers, *amplifier; /* [amplifiers] numbers of the amplifiers that EVENT_DEAD,
                                   EVENT_STUCK or EVENT_ALIVE changes */
    int announced_after; /* ticks until the controller is informed of EVENT_DEAD or EVENT_STUCK;
                            ANNOUNCED_NEVER: the controller is not informed; ANNOUNCED_DETECTED: the
                            controller has to detect the fault */
    expr *value; /* formula of the target shape that replaces the old one at a simulation event of
                    the type EVENT_VALUE */
    scene_at at;
} scene_event;

/*
 * Source of the measured shape in a simulation: the few readings of the scene's section `estimate`
 * (SIGHT_ESTIMATED), one sensor for each target node (SIGHT_MEASURED), or the readings if the scene
 * has that section and else the sensors (SIGHT_SCENE).
 */
typedef enum scene_sight { SIGHT_SCENE, SIGHT_ESTIMATED, SIGHT_MEASURED } scene_sight;

/*
 * Imperfections of sensors and amplifiers in the simulated plant, which the controller does not
 * know.
 */
typedef struct scene_imperfections {
    double bandwidth; /* corner frequency of the amplifiers, which are first-order low-pass filters
                         (Hz); 0: no limit */
    double creep; /* creep of the ceramic: increase of strain per decade (tenfold increase) of time,
                     as a fraction of the strain that the voltage causes */
    double drift; /* drift of every sensor, of random sign (unit of the reading per second) */
    double quantum; /* quantisation step of the sensors' analogue-to-digital converters (unit of the
                       reading) */
    double outlier_chance;    /* probability that a single reading is an outlier */
    double outlier_size;      /* largest error of an outlier of a sensor (unit of the reading) */
    int reversals, *reversed; /* [reversals] numbers of the amplifiers whose two wires are exchanged
                               */
    int swaps, *swapped; /* [swaps] numbers of the amplifiers whose cables are exchanged in pairs:
                            the first with the second, the third with the fourth, and so on */
} scene_imperfections;

/* State of the structure in which the controller's tables are computed. */
typedef enum scene_influence_at {
    /*
     * The controller's tables hold the influence matrix and the vibration modes of the reference
     * state, without loads.
     */
    INFLUENCE_UNDEFORMED,
    /*
     * The controller's tables hold the influence matrix at the nonlinear equilibrium with the
     * optimal voltages, but the vibration modes of the reference state.
     */
    INFLUENCE_TARGET,
    /*
     * The controller's tables hold the influence matrix and the vibration modes about the nonlinear
     * equilibrium under the scene's loads at 0 V, with its prestress.
     */
    INFLUENCE_LOADED
} scene_influence_at;

/*
 * Way in which the motion of a plant with inertia is computed. MOTION_MODAL: in the vibration modes
 * of the undeformed state about the static equilibrium; MOTION_NONLINEAR: with all degrees of
 * freedom, at large rotation.
 */
typedef enum scene_motion { MOTION_MODAL, MOTION_NONLINEAR } scene_motion;

/*
 * Closed-loop simulation of the controller with a plant that differs from the scene file, with
 * sensors, amplifiers and a schedule of events.
 */
typedef struct scene_simulate {
    bool given;
    int ticks, seed;
    scene_influence_at influence_at; /* state of the structure in which the influence matrix of the
                                        controller is computed */
    scene_kinematics kinematics;     /* kinematics of the simulated plant, linear or nonlinear */
    double *stiffness, *d; /* [materials] factors by which stiffness and piezoelectric constants of
                              the plant differ from what the controller knows */
    double *gain;   /* [amplifiers] factor by which each column of a measured influence matrix is
                       multiplied in the plant; the controller does not know it */
    double scatter; /* standard deviation of the relative error of each entry of a measured
                       influence matrix */
    double curve_error; /* by how much the curves of the actuators bulge in the plant: deviation of
                           the displacement from the curve of the scene, zero at both ends and
                           largest in the middle, as a fraction of the whole displacement */
    double hysteresis;  /* width of the hysteresis loop of an actuator over a full voltage cycle, as
                           a fraction of the voltage range */
    scene_sight sight;
    double noise; /* standard deviation of the noise of a measured shape (length unit of the scene
                     file); the readings of the section `estimate` have their own noise */
    double range; /* largest believable size of a measured displacement (length unit of the scene
                     file); 0: not given */
    int delay;    /* delay between measurement and use of the sensors' readings (ticks) */
    double step, dead_band; /* quantisation step of the digital-to-analogue converters and dead band
                               of the amplifiers (V) */
    double fault_chance;    /* probability that a random electrode fault occurs in a tick */
    int fault_until;        /* number of the tick from which on no random electrode faults occur */
    bool inertia_given, inertia; /* inertia_given: whether the scene file says if the plant has
                                    inertia; inertia: whether the plant has inertia */
    int modes;                   /* largest number of vibration modes of a plant with inertia */
    bool motion_given;   /* whether the scene file says how the motion of a plant with inertia is
                            computed */
    scene_motion motion; /* way in which the motion of a plant with inertia is computed */
    int steps; /* smallest number of time steps of a nonlinear motion in a control tick; 0: chosen
                  from the natural frequencies */
    bool hysteresis_given; /* whether the scene file gives the width of the hysteresis loop of the
                              actuators */
    scene_imperfections imperfections;
    bool detects_faults; /* whether the controller itself has to detect the fault of some electrode
                            (ANNOUNCED_DETECTED) */
    bool has_feed_forward; /* true if the controller is informed of at least one load event one tick
                              in advance */
    int events;
    scene_event *event;
    scene_at at;
} scene_simulate;

/* One vibration mode of a structure whose influence matrix is measured. */
typedef struct scene_measured_mode {
    double frequency; /* natural frequency of a measured vibration mode (Hz) */
    double *shape; /* [outputs] displacement of each output in the measured vibration mode, in any
                      unit */
    double *response; /* [amplifiers] static response of the vibration mode to 1 V of each
                         amplifier, as a multiple of `shape`: this multiple of the shape is a part
                         of the amplifier's column of the influence matrix; NULL where the scene
                         does not give it */
} scene_measured_mode;

/*
 * Curves of actuators whose displacement is not proportional to their voltage. The effect e of an
 * actuator is the function of its voltage to which its displacement is proportional. Between two
 * points (v0, e0) and (v1, e1) of a curve
 *
 *   e = e0 + (e1 - e0) t (1 - b (1 - t)),  t = (v - v0) / (v1 - v0),  with the bend b
 *
 * Effects are scaled so that the largest absolute effect of a curve equals its largest absolute
 * voltage, and are then volts.
 */
enum { SCENE_CURVE_POINTS = 128 }; /* largest number of points of a curve */
typedef struct scene_curves {
    bool given;
    bool is_square; /* whether the displacement of the actuators is proportional to the square of
                       the voltage. The points of the curve are then set after the voltage limits
                       have been read */
    int sets;       /* number of curves: 1 for all amplifiers together, otherwise one for each */
    int points;     /* number of points of each curve */
    double *voltage, *effect; /* [sets][points] points of each actuator curve, ascending: voltages,
                                 and effects (values to which the displacement of the actuator is
                                 proportional; V) */
    double *bend; /* [sets][points - 1] bends of the segments of a curve (dimensionless); NULL: all
                     segments are straight */
    double *unit; /* [sets] factor that converts the effects of an actuator curve (values to which
                     the displacement of the actuator is proportional) from volts into the unit of
                     the scene file */
    scene_at at;
} scene_curves;

/*
 * Measured influence matrix in place of a structural model. Its columns are the actuators of the
 * scene, with one amplifier for each. Outputs that the scene ignores are left out of every array
 * except output_name.
 */
typedef struct scene_influence {
    bool given;
    char file[256]; /* name of the file of the influence matrix as it is written in the scene file
                     */
    int outputs;    /* number of rows of the influence matrix that are used, one for each output */
    int file_outputs;        /* number of outputs in the file of the influence matrix */
    bool rows_are_actuators; /* true: the rows of the file of the influence matrix are actuators;
                                false: they are outputs */
    int *row; /* [outputs] for each output that the scene uses: its index among the outputs in the
                 file of the influence matrix, some of which the scene may ignore */
    bool has_numbered_actuators; /* true where neither the scene file nor the file of the influence
                                    matrix names the actuators, which then are v1, v2 and so on */
    double *matrix; /* [outputs][amplifiers] measured influence matrix: displacement per volt. Where
                       actuators have curves, per volt of effect, the value to which the
                       displacement of the actuator is proportional */
    scene_curves curve; /* curves of actuators that are not linear */
    double drop_below;  /* fraction of the largest entry of a column of the influence matrix: the
                           controller treats smaller entries of this column as zero (dimensionless)
                         */
    double scatter;     /* standard deviation of the relative errors that the measured entries of
                           the influence matrix must be expected to have */
    double (*place)[3]; /* [outputs] coordinates x, y, z of the output points; NULL where the scene
                           file gives none */
    char (*output_name)[SCENE_NAME]; /* [file_outputs] names of the rows of the influence matrix's
                                        file, or NULL where it has no names */
    int tied; /* number of actuators in the file of the influence matrix if the scene ties some of
                 them together, so that one amplifier drives them; 0: each actuator has an amplifier
                 of its own */
    int *amplifier_of; /* [tied] number of the amplifier that drives each actuator of the file of
                          the influence matrix. Amplifiers are numbered in the order in which their
                          first actuators stand in the file */
    char (*tied_name)[SCENE_NAME]; /* [tied] names of the actuators in the file of the influence
                                      matrix */
    int modes;                     /* number of measured vibration modes that the scene gives */
    scene_measured_mode *mode; /* [modes] measured vibration modes in the order of their frequencies
                                */
    scene_at at;
} scene_influence;

/*
 * Data for vibration, in addition to the densities of the materials: damping, masses that are
 * attached to the structure without stiffening it, number of vibration modes.
 */
typedef struct scene_dynamics {
    double damping; /* damping ratio of every vibration mode, relative to critical damping */
    int dampings;   /* number of entries of damping_of_mode; 0: the ratio `damping` holds for every
                       vibration mode */
    double *damping_of_mode; /* [dampings] damping ratios of the first vibration modes; the last
                                entry holds for all later modes */
    bool is_rayleigh;        /* whether the damping ratios follow from Rayleigh's coefficients */
    double rayleigh[2]; /* Rayleigh coefficients a of mass (rad/s) and b of stiffness (s/rad): a
                           vibration mode of angular frequency w has the damping ratio a/(2 w) + b
                           w/2 */
    bool damping_given; /* true: the damping ratio is given by the scene; false: it is an assumed
                           value */
    int modes; /* number of vibration modes used to assess the stability of the control loop */
    double mass_per_area; /* mass per area that belongs to no layer, located at the middle of the
                             laminate (units of the scene file) */
} scene_dynamics;

/*
 * Section control.modal_gains of a scene: modes (shapes of the structure) with a gain, the part of
 * the wanted change that a control tick makes, and a leak, the part of a mode's coordinate that a
 * tick removes.
 */
typedef struct scene_modal_gains {
    bool given;
    int modes;     /* number of modes with gains of their own; 0: one gain and one leak hold for all
                      shapes */
    int functions; /* number of modes that the scene gives as functions, which is 0 or `modes`. 0:
                      the modes are the singular vectors of the influence matrix with the largest
                      singular values */
    scene_mode *function; /* [functions] modes as functions at the target nodes */
    double *gain, *leak;  /* [modes] gain of each mode, the part of its wanted change that a control
                             tick makes, and leak, the part of its coordinate that a tick removes;
                             NULL without modes */
    double other_gain, other_leak; /* gain and leak of all voltages that belong to no mode: part of
                                      their wanted change that a control tick makes, and part of the
                                      voltages that it removes */
    scene_at at;
} scene_modal_gains;

/* Settings of the control loop that runs on the embedded device. */
typedef struct scene_control {
    double rate; /* tick rate of the control loop (ticks per second); 0 if neither given nor needed
                    by a simulation */
    bool moving_target; /* true: the target moves with time, and a reference governor (stage of the
                           tick that shapes the motion of the target) compensates the lag of a
                           controller that damps vibration */
    double clock;       /* clock frequency of the device's processor (Hz); 0 if not given */
    int delay_margin;   /* number of ticks, 0 or 1, by which the sensor readings may be older than
                           stated: with 1 the loop has to stay stable with older readings, even if
                           it then compensates loads more slowly */
    scene_at margin_at; /* position of delay_margin in the scene file, for error messages */
    scene_modal_gains modal_gains;
    bool sensor_gate; /* true: the loop takes away readings that cannot be (sensor gate) */
} scene_control;

/* Settings of the supervisor, which brings the amplifiers to safe voltages when control is lost. */
typedef struct scene_safety {
    bool given;    /* true: the scene asks for a supervisor by the section `safety` */
    bool left_out; /* true: the scene says `safety: none`; otherwise a loop that damps vibration has
                      a supervisor even if the scene does not ask for it */
    double *park;  /* [amplifiers] park voltages: voltages of rest, to which the amplifiers are
                      ramped when control is lost (V); NAN where the scene file gives none for an
                      amplifier, NULL where it gives none at all */
    bool park_is_common; /* true: the scene file gives one park voltage (voltage of rest) for all
                            amplifiers; false: voltages of amplifiers by name, or none */
    scene_at at; /* position of the section `safety` in the scene file, for error messages */
    int timeout; /* number of ticks without usable readings after which the supervisor takes control
                    away; 0: never */
    int ramp_ticks; /* shortest duration of the ramp to the park voltages (voltages of rest when
                       control is lost) (ticks) */
    bool waits; /* true: the control loop waits for a command before it starts; false: it starts by
                   itself */
    double amplitude;      /* height of the test pulses of the self-test of the wiring (V); 0: no
                              self-test */
    double gain_tolerance; /* largest plausible deviation of an amplifier's gain from the mean gain
                              of all amplifiers, relative to this mean; a larger one is a fault in
                              the self-test of the wiring */
    int pulse_ticks; /* duration of a test pulse of the self-test of the wiring (ticks); 0: chosen
                        from the period of the first vibration mode */
} scene_safety;

enum { SCENE_PLAYS = 32, SCENE_CREEPS = 8 };

/* Short list of numbers (at most SCENE_PLAYS), stored in the C struct itself without allocation. */
typedef struct scene_short_list {
    int count;
    double value[SCENE_PLAYS];
} scene_short_list;

/*
 * Identified hysteresis and creep of the piezoelectric ceramic, which the control loop compensates.
 * Model (Prandtl-Ishlinskii): a piecewise linear function of the voltage, plus weighted play
 * operators, which follow a reversal only after a slack, plus creep terms.
 */
typedef struct scene_hysteresis {
    bool given;
    double range[2]; /* lowest and highest voltage at which the hysteresis was identified (V) */
    scene_short_list slope; /* [4] slopes of a piecewise linear function of the voltage in the four
                               quarters of the voltage range, from the lowest on (dimensionless).
                               The hysteresis model is the sum of this function, which has no
                               memory, and of play operators */
    scene_short_list slack; /* [plays] slack of each play operator: change of the voltage after a
                               reversal before the operator follows; ascending (V) */
    scene_short_list above; /* [plays] weight of each play operator while its output is above the
                               middle of the voltage range (dimensionless) */
    scene_short_list below; /* [plays] weight of each play operator while its output is below the
                               middle of the voltage range (dimensionless) */
    scene_short_list creep_time; /* [creeps] time constants of the ceramic's creep (s) */
    scene_short_list creep; /* [creeps] final value of the creep term of each time constant, as a
                               fraction of the voltage (dimensionless) */
    double offset; /* constant term of the hysteresis model: its output at 0 V before any other
                      voltage (V) */
} scene_hysteresis;

/* Units of the numbers of a scene, as text; empty if the scene file names no units. */
typedef struct scene_unit_names {
    char length[SCENE_NAME], force[SCENE_NAME], voltage[SCENE_NAME], temperature[SCENE_NAME];
} scene_unit_names;

typedef struct scene {
    scene_origin *origin; /* path of the scene file and changes of the option --set from which the
                             scene was read; NULL where the scene was not read from a file */
    char name[SCENE_NAME];
    char *about;
    scene_unit_names units;
    uint32_t hash; /* hash of the text of the scene file and of the changes of --set */
    scene_element element;
    scene_kinematics kinematics;
    double tolerance; /* tolerance of `kinematics: auto`: linear kinematics are used if the linear
                         and the nonlinear displacement differ by less than this fraction of the
                         nonlinear one */
    scene_equilibrium equilibrium;
    scene_surface surface;
    scene_line line[2]; /* mesh lines of the surface coordinates theta1 and theta2; without points
                           where the mesh comes from a file */
    scene_ply_direction ply_direction; /* direction from which the angles of layers are measured, on
                                      a mesh of quadrilaterals */
    scene_quads *quads; /* mesh that is read from a file, or NULL where the scene has mesh lines on
                           a surface */
    bool reference_is_middle;
    double reference; /* height of the reference surface above the inner face of the laminate
                         (length unit of the scene file) */
    int materials, layers, patch_grids, actuators, sensors, supports, springs, masses, loads,
        outputs, compares;
    scene_material *material;
    scene_layer *layer;
    scene_patches *patches;
    scene_actuator *actuator, *sensor;
    scene_support *support;
    scene_spring *spring;
    scene_mass *mass;
    scene_load *load;
    scene_contact contact;
    scene_output *output;
    scene_limits limits;
    scene_target target;
    scene_compare *compare;
    scene_estimate estimate;
    scene_simulate simulate;
    scene_dynamics dynamics;
    scene_control control;
    scene_safety safety;
    scene_hysteresis hysteresis;
    scene_influence influence;
    int amplifiers; /* number of amplifiers of all actuators together, numbered in the order of the
                       actuators */
    int electrodes; /* number of electrodes of all sensors together, numbered in the order of the
                       sensors */
    scene_at at_surface, at_layers;
} scene;

/*
 * Read and check a scene.
 *   path   in                 YAML file
 *   set    [sets] in          changes a.b.c=value (value in YAML), applied before the checks; a
 *       name or an index from 0 selects an item of a list; the last key may be new
 *   error  [SCENE_ERROR] out  one line "file:line:column: what is wrong and the cure"
 * Returns 0, or -1 with error filled and *scene empty.
 */
int scene_read(scene *scene, const char *path, const char *const *set, int sets, char *error);

/*
 * Read and check a scene from a text in memory; the path of its file is only named in messages.
 * Returns 0, or -1 with error filled and *scene empty.
 */
int scene_read_text(scene *scene, const char *path, const char *text, size_t bytes, char *error);
void scene_free(scene *scene);

/*
 * Copy a scene so that kinematics, material constants, loads (with room for one more) and measured
 * influence matrix may be changed. The copy shares the rest with the original, which must outlive
 * it. Returns 0, or -1 where memory runs out, with nothing to release.
 */
int scene_vary(scene *copy, const scene *original);

/*
 * Release a copy of a scene from scene_vary. Formulas of loads that the caller has added to the
 * copy are not released; the caller does that.
 */
void scene_vary_free(scene *copy);

/*
 * Write the name of amplifier number k: the name of its actuator, followed by _i_j (position in the
 * grid, counted from 1) if the grid has more than one patch.
 */
void scene_amplifier_name(const scene *scene, int k, char name[SCENE_LABEL]);

/*
 * Write the name of sensor electrode number k: the name of its sensor, followed by _i_j (position
 * in the grid, counted from 1) if the grid has more than one patch.
 */
void scene_sensor_name(const scene *scene, int k, char name[SCENE_LABEL]);

/*
 * Find the amplifiers that belong to the name of an actuator or of a single amplifier: numbers
 * *first to *first + *count - 1. Returns 1 if there are any, else 0.
 */
int scene_find_amplifier(const scene *scene, const char *name, int *first, int *count);

/*
 * Return the amplifier that drives an actuator of the file of a measured influence matrix
 * (scene_tied.c).
 */
int scene_tied_amplifier(const scene_influence *influence, int actuator);

/*
 * Return the number of actuators that an amplifier drives, in a scene that ties some of them to one
 * amplifier; 0 where no actuators are tied.
 */
int scene_tied_count(const scene_influence *influence, int amplifier);

/*
 * Return the index that an actuator has in the file of the influence matrix, in a scene that ties
 * some of its actuators to one amplifier. Returns -1 if no actuator has this name, or if no
 * actuators are tied.
 */
int scene_find_tied(const scene_influence *influence, const char *name);

/*
 * Add up the values of the actuators that one amplifier drives together, for each amplifier.
 *   value [influence->tied] in/out  value of each actuator in the file of the influence matrix;
 *                                   out: the first entries are the sums for the amplifiers
 */
void scene_tied_sum(const scene_influence *influence, double *value);

/*
 * Find the voltage limits of an amplifier, which may have limits of its own (limits.each): the
 * narrowest of several entries for it and of several actuators that it drives together. Where these
 * do not overlap, the lower limit is above the upper one.
 *   lower, upper in/out  in: limits that hold for an amplifier without limits of its own (V); out:
 *                        limits of this amplifier (V)
 */
void scene_own_limits(const scene *scene, int amplifier, double *lower, double *upper);

/*
 * Find the electrodes that belong to the name of a sensor or of a single electrode: numbers *first
 * to *first + *count - 1. Returns 1 if there are any, else 0.
 */
int scene_find_sensor(const scene *scene, const char *name, int *first, int *count);

/* Return whether the patches of an actuator or sensor are electrodes, not heaters. */
bool scene_has_electrodes(const scene_actuator *actuator);

/* Return whether the input of an actuator is the temperature of the whole shell. */
bool scene_heats_all(const scene_actuator *actuator);

/*
 * Return whether the input of the amplifier with an index is a temperature: that of a heater or of
 * the whole shell.
 */
bool scene_is_heater(const scene_actuator *actuator, int actuators, int amplifier);

/*
 * Mark the nodes of a named set, or the node nearest to a point, on a mesh from a file. A named set
 * is searched for among the node sets, then the edge sets, then the element sets.
 *   in_set [nodes] out  1 for the nodes of the set or point, else 0
 * Returns the number of nodes that are marked.
 */
size_t scene_mark_nodes(const scene *scene, const scene_where *where, unsigned char *in_set);

#endif
