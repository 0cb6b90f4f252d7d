/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The types of reference surfaces, such as plate, cylinder or sphere, one row of a table each. The
 * reader of scene files, their schema and help, and the points, areas and checks of a surface are
 * made from its row.
 */
#ifndef SURFACE_TYPES_H
#define SURFACE_TYPES_H

#include "surface_point.h"

/*
 * Bits for sets of the surface coordinates theta1 and theta2. AROUND_AXIS stands for the angle
 * around the axis of a cylinder or spiral, which is theta1 or theta2, as scene_surface.axial tells.
 */
enum { ALONG_THETA1 = 1, ALONG_THETA2 = 2, AROUND_AXIS = 4 };

/*
 * Point (radius, height) of the meridian of a surface of revolution at the surface coordinate
 * theta1, and its first and second derivatives with respect to theta1.
 */
typedef struct surface_meridian {
    double x[2], d1[2], d2[2];
} surface_meridian;

/* Function that returns the point of a surface at its coordinates theta1 and theta2. */
typedef surface_point surface_at_function(const scene_surface *surface, double theta1,
                                          double theta2);

/*
 * Function that returns the point of the meridian of a surface of revolution at the surface
 * coordinate theta1.
 */
typedef surface_meridian surface_meridian_function(const scene_surface *surface, double theta1);

/*
 * Function that returns the area of a surface over the rectangle t1[0] to t1[1] of the surface
 * coordinate theta1 and t2[0] to t2[1] of theta2.
 */
typedef double surface_area_function(const scene_surface *surface, const double t1[2],
                                     const double t2[2]);

/*
 * Table of surface types. Columns:
 *   1. value of scene_surface_type
 *   2. word in a scene file
 *   3. keys in a scene file (?a: optional a; numbers are defined by SURFACE_NUMBERS)
 *   4. function that computes a point; revolution_at for surfaces of revolution
 *   5. function of the meridian of a surface of revolution; 0 for other surfaces
 *   6. function that computes an area; 0: numerical integration
 *   7. surface coordinates with the period 2 pi (bits)
 *   8. surface coordinates that are angles (bits)
 *   9. advice for a mesh that reaches a pole
 *   10. sentence of help
 */
#define SURFACE_TYPES(ROW)                                                                         \
    ROW(SURFACE_PLATE, "plate", "", plate_at, 0, plate_area, 0, 0, "",                             \
        "Plane: x = theta1, y = theta2, e3 = +z.")                                                 \
    ROW(SURFACE_POLAR, "polar", "", revolution_at, polar_meridian, polar_area, ALONG_THETA2,       \
        ALONG_THETA2, "let theta1 (the radius) start above 0",                                     \
        "Plane in polar coordinates: theta1 = radius, theta2 = angle in radians, e3 = +z.")        \
    ROW(SURFACE_CYLINDER, "cylinder", " radius axial", cylinder_at, 0, cylinder_area, AROUND_AXIS, \
        AROUND_AXIS, "",                                                                           \
        "Circular cylinder, e3 outwards. axial theta1: x = theta1, theta2 from the +z axis "       \
        "towards +y. axial theta2: z = theta2, theta1 from the +x axis towards +y. The other "     \
        "coordinate is the angle in radians.")                                                     \
    ROW(SURFACE_CONE, "cone", " radius angle", revolution_at, cone_meridian, cone_area,            \
        ALONG_THETA2, ALONG_THETA2, "keep radius + theta1 sin(angle) above 0",                     \
        "Cone: theta1 = length along the meridian downwards, theta2 = azimuth in radians, e3 "     \
        "outwards.")                                                                               \
    ROW(SURFACE_SPHERE, "sphere", " radius", revolution_at, sphere_meridian, sphere_area,          \
        ALONG_THETA2, ALONG_THETA1 | ALONG_THETA2,                                                 \
        "let theta1 run inside 0 and pi, leaving a small hole",                                    \
        "Sphere: theta1 = angle from the pole, theta2 = azimuth, both in radians, e3 outwards.")   \
    ROW(SURFACE_HYPERBOLOID, "hyperboloid", " waist height", revolution_at, hyperboloid_meridian,  \
        0, ALONG_THETA2, ALONG_THETA2, "",                                                         \
        "Hyperboloid of revolution: radius waist sqrt(1 + (z/height)^2), theta1 = -z, theta2 = "   \
        "azimuth in radians, e3 outwards.")                                                        \
    ROW(SURFACE_TORUS, "torus", " radius tube", revolution_at, torus_meridian, torus_area,         \
        ALONG_THETA1 | ALONG_THETA2, ALONG_THETA1 | ALONG_THETA2,                                  \
        "keep radius + tube cos(theta1) above 0",                                                  \
        "Torus: radius + tube cos(theta1) from the axis, z = -tube sin(theta1), theta2 = "         \
        "azimuth, both in radians, e3 out of the tube.")                                           \
    ROW(SURFACE_REVOLUTION, "revolution", " meridian ?smoothing ?ends", revolution_at,             \
        spline_meridian, 0, ALONG_THETA2, ALONG_THETA2,                                            \
        "let theta1 stay where the meridian's radius is above 0",                                  \
        "Surface of revolution about z whose meridian is a cubic spline; theta1 = length of the "  \
        "chords between the points from 0, theta2 = azimuth in radians. e3 lies to the left of "   \
        "the meridian seen with the radius to the right and z upwards: points that run downwards " \
        "on the outside give e3 outwards.")                                                        \
    ROW(SURFACE_SPIRAL, "spiral", " inner outer turns axial", spiral_at, 0, 0, 0, AROUND_AXIS, "", \
        "Cylinder over an Archimedean spiral, e3 outwards; the other coordinate is the angle in "  \
        "radians, from 0. axial theta1: angle from the +z axis towards +y. axial theta2: from "    \
        "the +x axis towards +y.")                                                                 \
    ROW(SURFACE_PARABOLOID, "paraboloid", " focal_length", revolution_at, paraboloid_meridian, 0,  \
        ALONG_THETA2, ALONG_THETA2, "let theta1 (the radius) start above 0",                       \
        "Paraboloid of revolution: z = theta1^2/(4 focal_length), theta1 = radius, theta2 = "      \
        "azimuth in radians, e3 towards the focus.")                                               \
    ROW(SURFACE_FORMULA, "formula", " ?x ?y z", formula_at, 0, formula_area, 0, 0, "",             \
        "Surface x, y, z of the two coordinates, which need not be lines of curvature. e1 along "  \
        "theta1, e3 normal, with theta2 to the left of theta1.")                                   \
    ROW(SURFACE_POINTS, "points", " points ?cells", formula_at, 0, formula_area, 0, 0, "",         \
        "Measured or free-form surface: smooth height z over x = theta1 and y = theta2, fitted "   \
        "to points by least squares. e1 along theta1, e3 upwards.")

/*
 * Table of the numbers that describe surfaces. A row holds the name, which is a key in the scene
 * file and a member of scene_surface, the permitted range and the dimension (scene_fields.h), and a
 * sentence of help.
 */
#define SURFACE_NUMBERS(ROW)                                                                       \
    ROW(radius, above_zero, OF_LENGTH,                                                             \
        "Radius of a cylinder or sphere, of a cone at theta1 = 0, of the centre circle of a "      \
        "torus.")                                                                                  \
    ROW(angle, acute, OF_DEGREES, "Half angle of a cone, in degrees.")                             \
    ROW(waist, above_zero, OF_LENGTH, "Smallest radius of a hyperboloid, at theta1 = 0.")          \
    ROW(height, above_zero, OF_LENGTH,                                                             \
        "Height at which the radius of a hyperboloid is sqrt(2) times the waist.")                 \
    ROW(tube, above_zero, OF_LENGTH, "Radius of the tube of a torus.")                             \
    ROW(inner, above_zero, OF_LENGTH, "Radius of a spiral at the angle 0.")                        \
    ROW(outer, above_zero, OF_LENGTH, "Radius of a spiral after all turns.")                       \
    ROW(turns, above_zero, OF_NUMBER, "Number of turns of a spiral.")                              \
    ROW(focal_length, above_zero, OF_LENGTH,                                                       \
        "Distance of the focus of a paraboloid from its vertex.")

/*
 * Functions of the points, meridians and areas of the surface types (surface_plate.c,
 * surface_cylinder.c, surface_revolution.c, surface_paraboloid.c, surface_formula.c).
 */
surface_at_function plate_at, cylinder_at, spiral_at, revolution_at, formula_at;
surface_meridian_function polar_meridian, cone_meridian, sphere_meridian, hyperboloid_meridian,
    torus_meridian, spline_meridian, paraboloid_meridian;
surface_area_function plate_area, polar_area, cylinder_area, cone_area, sphere_area, torus_area,
    formula_area;

/*
 * Functions and constants of one type of surface, without the texts that only the reader of scene
 * files needs.
 */
typedef struct surface_type {
    surface_at_function *at;
    surface_meridian_function *meridian; /* function that returns the point (radius, height) of the
                                            meridian at a surface coordinate theta1; NULL: the
                                            surface is no surface of revolution */
    surface_area_function *area; /* function that returns the area of a part of the surface (length
                                    squared); NULL: the area is integrated numerically */
    int closed, angles; /* closed: surface coordinates with the period 2 pi. angles: surface
                           coordinates that are angles. Each is a sum of the bits ALONG_THETA1,
                           ALONG_THETA2 and AROUND_AXIS. AROUND_AXIS stands for the angle around the
                           axis of a cylinder or spiral, which is theta1 or theta2 */
    const char *pole_cure;
} surface_type;

const surface_type *surface_type_of(const scene_surface *surface);

#endif
