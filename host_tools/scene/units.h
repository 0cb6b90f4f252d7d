/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Units of measurement: conversion of a text such as "mm", "N/m2" or "C/(m2 K)" to powers of six
 * base units and a power of ten.
 *   base     m, N, V, K, s, rad
 *   derived  Pa = N/m2, C = N m/V, F = C/V, Hz = 1/s, kg = N s2/m, t = 1000 kg
 *   text     factors joined by a blank, '*' or '.', then divisors: each a '/' and a factor or a
 *            product in parentheses; 1 may stand before '/'
 *   factor   unit with an optional SI prefix (f p n u m c d k M G T) and an optional integer power,
 *            as m2, m^2, m^-1
 */
#ifndef UNITS_H
#define UNITS_H

#include <stddef.h>

typedef enum units_base {
    UNITS_LENGTH,
    UNITS_FORCE,
    UNITS_VOLTAGE,
    UNITS_TEMPERATURE,
    UNITS_TIME,
    UNITS_ANGLE,
    UNITS_BASES
} units_base;

/*
 * Size of the text of a number that was converted to other units: its decimal exponent has been
 * changed, and a factor such as *pi/180 may follow (bytes).
 */
enum { UNITS_NUMBER = 128 };

/*
 * Unit of measurement: the product of the base units raised to the given powers, times 10^ten,
 * times (pi/180)^degrees.
 */
typedef struct units_unit {
    int power[UNITS_BASES];
    int ten;
    int degrees;
} units_unit;

/*
 * Parse a whole text as a unit of measurement.
 *   unit  out  the unit; untouched on an error
 *   why   out  reason of an error, a constant string
 * Returns 0, or -1 if the text is no unit.
 */
int units_parse(const char *text, units_unit *unit, const char **why);

/*
 * Return the unit that follows a plain number, such as "mm" in "-0.3e2 mm". Returns NULL if the
 * text is a number without a unit, or a formula.
 *   length  out  number of characters of the number
 */
const char *units_suffix(const char *text, size_t *length);

/*
 * Change the decimal exponent of a plain number in its text by `ten`: "0.3" and -3 give "0.3e-3".
 * The conversion does not round, so that the number equals the number that is typed with this
 * exponent. Returns 0, or -1 if the number is too long or its exponent exceeds 9999.
 */
int units_shift(const char *number, size_t length, int ten, char text[UNITS_NUMBER]);

/* Return whether two units have equal powers of the base units, whatever their powers of ten. */
int units_alike(const units_unit *first, const units_unit *second);

#endif
