/*
 * Products of tables and vectors have the bits of sums in the stated order, and checksums those of
 * single bytes, at any size and vector width.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/core/guard.h"
#include "../../lib/core/product.h"
#include "../rigs/uniform.h"

enum { ROWS = 37, COLUMNS = 150, SPARE = 16 };

static pzs_real table[ROWS * COLUMNS + SPARE], factor[ROWS + SPARE], left[COLUMNS + SPARE],
    product[COLUMNS + SPARE];

static void fill(pzs_real *array, unsigned count, unsigned *seed)
{
    for (unsigned i = 0; i < count; i++)
        array[i] = (pzs_real)uniform(seed, -1, 1);
}

static void fill_all(unsigned seed)
{
    fill(table, ROWS * COLUMNS, &seed);
    fill(factor, ROWS, &seed);
    fill(left, COLUMNS, &seed);
}

static void sums_of_rows(void **state)
{
    (void)state; /* law: each entry is the sum of its terms in ascending order of the rows */
    for (unsigned cols = 1; cols <= COLUMNS; cols++) {
        fill_all(cols);
        pzs_product_sum_rows(product, table, COLUMNS, factor, ROWS, cols);
        for (unsigned j = 0; j < cols; j++) {
            pzs_real sum = 0;
            for (unsigned i = 0; i < ROWS; i++)
                sum += factor[i] * table[i * COLUMNS + j];
            assert_memory_equal(&sum, &product[j], sizeof sum);
        }
    }
}

static void subtracted_rows(void **state)
{
    (void)state; /* law: the chosen rows are subtracted one after the other */
    static const uint16_t chosen[] = {5, 0, 36, 7, 20, 3};
    const unsigned count = sizeof chosen / sizeof *chosen;
    for (unsigned cols = 1; cols <= COLUMNS; cols++) {
        fill_all(cols);
        memcpy(product, left, sizeof product);
        pzs_product_subtract_rows(product, table, COLUMNS, chosen, factor, count, cols);
        for (unsigned j = 0; j < cols; j++) {
            pzs_real rest = left[j];
            for (unsigned q = 0; q < count; q++)
                rest -= factor[q] * table[chosen[q] * COLUMNS + j];
            assert_memory_equal(&rest, &product[j], sizeof rest);
        }
        assert_memory_equal(left + cols, product + cols, sizeof *left * (COLUMNS - cols));
    }
}

static void scalar_products(void **state)
{
    (void)state; /* law: the eight partial sums of a scalar product are added in pairs */
    for (unsigned count = 1; count <= COLUMNS; count++) {
        pzs_real sum[8] = {0};
        fill_all(count);
        for (unsigned i = 0; i < count; i++) {
            const unsigned rest = count - i / 8 * 8, lane = i % 8;
            const bool is_last = (rest < 4) || (rest < 8 && lane >= 4);
            sum[is_last ? 0 : lane] += left[i] * table[i];
        }
        const pzs_real expected =
            ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
        const pzs_real found = pzs_product_dot(left, table, count);
        assert_memory_equal(&expected, &found, sizeof found);
    }
}

static void checksums(void **state)
{
    (void)state; /* law: the checksum of an array is that of its bytes, one after the other */
    const uint8_t *bytes = (const uint8_t *)table;
    fill_all(9);
    for (size_t count = 1; count < 300; count++) {
        uint32_t slow = GUARD_CRC_START;
        for (size_t i = 0; i < count; i++)
            slow = pzs_guard_crc(slow, bytes + i, 1);
        assert_int_equal(pzs_guard_crc(GUARD_CRC_START, bytes, count), slow);
    }
    assert_int_equal(~pzs_guard_crc(GUARD_CRC_START, "123456789", 9), 0xCBF43926u);
}

static void numbers_that_are_not_finite(void **state)
{
    (void)state; /* law: the first NaN or infinity of an array is found at every place, and none in
                    an array of finite numbers, however large these are */
    const pzs_real bad[] = {(pzs_real)NAN, (pzs_real)HUGE_VAL, (pzs_real)-HUGE_VAL};
    fill_all(10);
    left[0] = PZS_BY_BITS(3e38f, 1e308);
    left[1] = -left[0];
    for (unsigned count = 1; count <= 40; count++) {
        assert_int_equal(pzs_guard_nonfinite(left, count), -1);
        for (unsigned at = 0; at < count; at++) {
            const pzs_real kept = left[at];
            left[at] = bad[at % 3u];
            assert_int_equal(pzs_guard_nonfinite(left, count), (int32_t)at);
            left[at] = kept;
        }
    }
}

static void products_of_rows(void **state)
{
    (void)state; /* law: a product of a table with a vector is that of its rows with it; a zero
                    vector gives zeros, a NaN in the vector a NaN in each entry */
    for (unsigned cols = 1; cols <= COLUMNS; cols++) {
        fill_all(cols);
        memset(left, 0, sizeof left);
        memset(product, 1, sizeof product);
        pzs_product_matrix(product, table, left, ROWS, cols);
        for (unsigned i = 0; i < ROWS; i++)
            assert_true(product[i] <= 0 && product[i] >= 0);
        left[cols - 1] = 2;
        pzs_product_matrix(product, table, left, ROWS, cols);
        for (unsigned i = 0; i < ROWS; i++) {
            const pzs_real expected = 2 * table[i * cols + cols - 1];
            assert_true(product[i] <= expected && product[i] >= expected);
        }
        left[cols / 2] = (pzs_real)NAN;
        pzs_product_matrix(product, table, left, ROWS, cols);
        for (unsigned i = 0; i < ROWS; i++)
            assert_false(product[i] <= 0 || product[i] >= 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_of_rows),
        cmocka_unit_test(subtracted_rows),
        cmocka_unit_test(scalar_products),
        cmocka_unit_test(checksums),
        cmocka_unit_test(numbers_that_are_not_finite),
        cmocka_unit_test(products_of_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
