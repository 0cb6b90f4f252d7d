/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Slow test pulse of a voltage, and the weights with which the response of a sensor is measured:
 *   pulse        b^4 times the height, with b = 1 - s^2
 *   even weight  b^3 (1 - 9 s^2), whose sum is zero
 *   odd weight   1.5 s b^2 (3 s^2 - 1), proportional to the derivative of the even weight
 *   s            time, from -1 to 1 over the duration of the pulse
 *   response     sum(readings * even weight) / sum(pulse * even weight)
 *
 * Without a pulse, the sums with even and odd weights give the amplitude of a vibration. The
 * functions are polynomials because polynomials, unlike trigonometric functions, have the same bits
 * on all processors.
 */
#ifndef PZS_LIB_TEST_PULSE_H
#define PZS_LIB_TEST_PULSE_H

#include "pzs_loop.h"

/*
 * Return the time of a tick within a test pulse of `ticks` ticks, as a number from -1 (start of the
 * pulse) to 1 (end).
 */
static inline pzs_real test_pulse_place(uint32_t tick, uint32_t ticks)
{
    return (pzs_real)(2u * tick + 1u) / (pzs_real)ticks - 1;
}

/*
 * Return the voltage of a test pulse, divided by the height of the pulse, at the time `place` from
 * -1 (start of the pulse) to 1 (end).
 */
static inline pzs_real test_pulse_at(pzs_real place)
{
    const pzs_real rest = 1 - place * place, squared = rest * rest;
    return squared * squared;
}

/*
 * Return the weight of a reading at the time `place` from -1 (start of a test pulse) to 1 (end) in
 * the sum that measures the response to the pulse. The weight is an even function of the time,
 * symmetric about the middle of the pulse.
 */
static inline pzs_real test_pulse_even(pzs_real place)
{
    const pzs_real rest = 1 - place * place;
    return rest * (rest * rest) * (1 - 9 * (place * place));
}

/*
 * Return the weight of a reading at the time `place` from -1 (start of a test pulse) to 1 (end) in
 * a sum that measures the amplitude of a vibration. The weight is an odd function of the time,
 * antisymmetric about the middle of the pulse, and proportional to the derivative of
 * test_pulse_even.
 */
static inline pzs_real test_pulse_odd(pzs_real place)
{
    const pzs_real rest = 1 - place * place;
    return PZS_R(1.5) * place * (rest * rest) * (3 * (place * place) - 1);
}

/*
 * Return the weight of a reading at the time `place`, from -1 (start of a test pulse) to 1 (end),
 * in a sum that detects a sudden step of the readings. The weights are antisymmetric in time. If
 * the readings step by 1 in the middle of the pulse, the sum is a twelfth of the number of ticks.
 */
static inline pzs_real test_pulse_late(pzs_real place)
{
    const pzs_real rest = 1 - place * place;
    return place * (rest * rest);
}

/*
 * Return the weight of a reading or voltage in its mean over an interval, at the time `place` from
 * -1 (start of the interval) to 1 (end). The weight is 0 at both ends, so that vibration hardly
 * changes the mean; the mean of the weights is 1.
 */
static inline pzs_real test_pulse_mean(pzs_real place)
{
    const pzs_real rest = 1 - place * place;
    return PZS_R(1.875) * (rest * rest);
}

/*
 * Check that the tables of test pulses are intact and fit the loop in which they are used. Writes
 * to `where` the index of the input whose pulse exceeds its limits, or -1.
 * Errors: PZS_E_FORMAT, PZS_E_ARGUMENT, PZS_E_CRC, PZS_E_NONFINITE, PZS_E_LIMITS.
 */
pzs_status pzs_selftest_check(const pzs_selftest_tables *tables, const pzs_loop_signals *signals,
                              int32_t *where);

/*
 * List the arrays that the checksum of tables of test pulses covers. Returns the number of arrays.
 */
uint32_t pzs_selftest_parts(const pzs_selftest_tables *tables,
                            pzs_table_part part[PZS_TABLE_PARTS]);

#endif
