/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Physical dimensions, such as length or voltage, of the numbers in a scene file: each row of a
 * table of scene keys (scene_fields.h) names the dimension of its key.
 */
#ifndef SCENE_DIMENSION_H
#define SCENE_DIMENSION_H

/*
 * Physical dimension of the numbers in the value of a key. OF_NOTHING: the value is no number, but
 * a text or a mapping of further keys. From DIMENSIONS on the dimension depends on other keys: that
 * of a load, for example, is a force, a force per length or a pressure.
 */
typedef enum dimension {
    OF_NOTHING,
    OF_NUMBER,
    OF_LENGTH,
    OF_VOLUME,
    OF_RADIANS,
    OF_DEGREES,
    OF_FORCE,
    OF_LINE_FORCE,
    OF_STRESS,
    OF_ACCELERATION,
    OF_DENSITY,
    OF_AREA_DENSITY,
    OF_LINE_DENSITY,
    OF_MASS,
    OF_INERTIA,
    OF_RATE,
    OF_TEMPERATURE,
    OF_EXPANSION,
    OF_VOLTAGE,
    OF_VOLTAGE_RATE,
    OF_FIELD,
    OF_CHARGE,
    OF_STRAIN_CONSTANT,
    OF_STRESS_CONSTANT,
    OF_PERMITTIVITY,
    OF_PYROELECTRIC,
    OF_REGULARISATION,
    OF_STIFFNESS,
    OF_LINE_STIFFNESS,
    OF_FOUNDATION,
    OF_TORSION,
    OF_FORCE_CONSTANT,
    OF_MOMENT,
    OF_INFLUENCE,
    DIMENSIONS,
    OF_COORDINATE = DIMENSIONS, /* physical dimension of a surface coordinate: that of theta1 or
                                   theta2, depending on which of the two keys the value belongs to
                                   or is nested in */
    OF_POINT, /* physical dimension of a coordinate of a point (surface coordinate theta1 or theta2,
                 or x, y, z in space), by its position in a list */
    OF_OUTLINE, /* physical dimension of a coordinate or length in the plane of electrode outlines
                 */
    OF_SPRING,
    OF_ADDED_MASS,
    OF_SUPPORT,
    OF_LOAD,
    OF_OUTPUT,
    OF_READING,
    OF_ACTUATOR,
    OF_LIMIT,
    OF_COMPARE
} dimension;

#endif
