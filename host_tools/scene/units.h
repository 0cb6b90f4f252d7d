/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Units of measurement: text such as "mm", "N/m2", "C/(m2 K)" or "1/K" to powers of six base units
 * and a power of ten.
 *
 * Base units: m, N, V, K, s, rad. The others follow: Pa = N/m2, C = N m/V, F = C/V, Hz = 1/s, kg =
 * N s2/m, t = 1000 kg. Grammar: factors joined by a blank, '*' or '.', then '/' and a factor or a
 * bracketed product, again and again. A factor is a unit with an SI prefix (f p n u m c d k M G T)
 * and a whole power, as m2, m^2, m^-1; 1 may stand before '/'.
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

/* Room for a number whose decimal exponent has been changed, with a factor behind it. */
enum { UNITS_NUMBER = 128 };

/* A unit: the product of the base units to these powers, times 10^ten, times (pi/180)^degrees. */
typedef struct units_unit {
    int power[UNITS_BASES];
    int ten;
    int degrees;
} units_unit;

/*
 * Read a whole text as a unit.
 *   why  out  where the text is none: what is wrong, a constant string
 * Returns 0, or -1 with *unit untouched.
 */
int units_parse(const char *text, units_unit *unit, const char **why);

/*
 * The unit that follows a plain number, as "mm" in "-0.3e2 mm"; NULL where the text is a number
 * alone or no number with a unit behind it (an expression). length  out  of the number
 */
const char *units_suffix(const char *text, size_t *length);

/*
 * Move the decimal exponent of a plain number by changing its text: "0.3" and -3 give "0.3e-3". No
 * rounding happens, so that the number is the same double as one that was typed in this way.
 * Returns 0, or -1 where the number is too long or its exponent beyond 9999.
 */
int units_shift(const char *number, size_t length, int ten, char text[UNITS_NUMBER]);

/* Have two units the same powers of the base units? */
int units_alike(const units_unit *a, const units_unit *b);

#endif
