/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Table of the load types. A row holds the type; the words for it in texts; the quantity that its
 * value measures, which gives its unit (words.h); and the function of its nodal forces
 * (load_forces.h).
 */
#ifndef LOAD_TYPES_H
#define LOAD_TYPES_H

#define LOAD_TYPES(ROW)                                                                            \
    ROW(LOAD_POINT, "point force", QUANTITY_FORCE, point_forces)                                   \
    ROW(LOAD_LINE, "line force", QUANTITY_LINE_FORCE, line_forces)                                 \
    ROW(LOAD_FACE, "pressure", QUANTITY_PRESSURE, face_forces)                                     \
    ROW(LOAD_WEIGHT, "weight", QUANTITY_OTHER, weight_forces)                                      \
    ROW(LOAD_TEMPERATURE, "temperature load", QUANTITY_TEMPERATURE, temperature_forces)            \
    ROW(LOAD_MOMENT, "moment", QUANTITY_OTHER, moment_forces)

#endif
