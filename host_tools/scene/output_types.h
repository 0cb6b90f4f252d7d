/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Table of the types of outputs: the quantities that an output of a scene can measure. Columns:
 *   1. value of scene_output_type
 *   2. name of the quantity in messages
 *   3. keys, separated by blanks, that outputs of this type take in addition to those of all
 *       outputs: layer, face, angle and support
 *   4. physical dimension of a value, such as a reference value in the scene file
 *       (scene_dimension.h)
 *   5. quantity that a value measures, which gives its unit in texts (words.h)
 *   6. what each value of the output belongs to (scene_output_spread)
 *   7. when a sensor may measure the output (scene_output_reading)
 *   8. function that completes an output of the scene file and checks it (scene_output.c)
 *   9. functions that compute the output (host_tools/model/output_calls.h)
 */
#ifndef OUTPUT_TYPES_H
#define OUTPUT_TYPES_H

#define OUTPUT_TYPES(ROW)                                                                          \
    ROW(OUTPUT_DISPLACEMENT, "displacement", "", OF_LENGTH, QUANTITY_LENGTH, SPREAD_NODES,         \
        READING_ALWAYS, finish_at_place, displacement_calls)                                       \
    ROW(OUTPUT_ROTATION, "rotation", "", OF_RADIANS, QUANTITY_ANGLE, SPREAD_NODES, READING_LINEAR, \
        finish_at_place, rotation_calls)                                                           \
    ROW(OUTPUT_STRAIN, "strain", "layer face angle", OF_NUMBER, QUANTITY_OTHER, SPREAD_NODES,      \
        READING_LINEAR, finish_strain, strain_calls)                                               \
    ROW(OUTPUT_STRESS, "stress", "layer face angle", OF_STRESS, QUANTITY_PRESSURE, SPREAD_NODES,   \
        READING_NEVER, finish_stress, stress_calls)                                                \
    ROW(OUTPUT_REACTION_FORCE, "reaction", "support", OF_FORCE, QUANTITY_FORCE, SPREAD_TOTAL,      \
        READING_NEVER, finish_reaction, reaction_force_calls)                                      \
    ROW(OUTPUT_REACTION_MOMENT, "reaction", "support", OF_MOMENT, QUANTITY_MOMENT, SPREAD_TOTAL,   \
        READING_NEVER, finish_reaction, reaction_moment_calls)                                     \
    ROW(OUTPUT_CONTACT_FORCE, "contact force", "", OF_FORCE, QUANTITY_FORCE, SPREAD_TOTAL,         \
        READING_NEVER, finish_total, contact_force_calls)                                          \
    ROW(OUTPUT_CONTACT_NODES, "number of nodes in contact", "", OF_NUMBER, QUANTITY_NODES,         \
        SPREAD_TOTAL, READING_NEVER, finish_total, contact_nodes_calls)                            \
    ROW(OUTPUT_CONTACT_PRESSURE, "contact pressure", "", OF_STRESS, QUANTITY_PRESSURE,             \
        SPREAD_NODES, READING_NEVER, finish_at_place, contact_pressure_calls)                      \
    ROW(OUTPUT_VOLTAGE, "voltage", "", OF_VOLTAGE, QUANTITY_VOLTAGE, SPREAD_ELECTRODES,            \
        READING_ALWAYS, finish_electrodes, voltage_calls)                                          \
    ROW(OUTPUT_CHARGE, "charge", "", OF_CHARGE, QUANTITY_CHARGE, SPREAD_ELECTRODES,                \
        READING_ALWAYS, finish_electrodes, charge_calls)                                           \
    ROW(OUTPUT_POTENTIAL, "potential", "face", OF_VOLTAGE, QUANTITY_VOLTAGE, SPREAD_NODES,         \
        READING_ALWAYS, finish_potential, potential_calls)

#endif
