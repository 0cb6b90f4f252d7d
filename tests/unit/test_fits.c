#define _XOPEN_SOURCE 700
/*
 * Laws of tables from FITS images. Where pzs is built without cfitsio, a FITS file is refused with
 * the name of the package, and the other laws are skipped.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>
#include "../../host_tools/data/number_table.h"

enum { BLOCK = 2880, CARD = 80, FILE_BYTES = 2 * BLOCK, COUNT = 6 };

/* An image to write; its numbers are given apart. */
typedef struct image {
    int bits; /* -64: double precision; 16: integers */
    int dimensions, axis[4];
    const char *extra[3]; /* more cards of the header */
} image;

static void add_card(char *file, int *cards, const char *key, const char *value)
{
    char card[CARD + 1];
    snprintf(card, sizeof card, "%-8s= %20s", key, value);
    memcpy(file + CARD * (*cards)++, card, strlen(card));
}

/*
 * Write a FITS file as its standard says: cards of 80 bytes, blocks of 2880 bytes, the highest byte
 * of a number first. file [FILE_BYTES] out
 */
static void write_fits(char *file, const image *image, const double value[COUNT])
{
    char text[24];
    int cards = 0;
    memset(file, ' ', BLOCK);
    memset(file + BLOCK, 0, FILE_BYTES - BLOCK);
    add_card(file, &cards, "SIMPLE", "T");
    snprintf(text, sizeof text, "%d", image->bits);
    add_card(file, &cards, "BITPIX", text);
    snprintf(text, sizeof text, "%d", image->dimensions);
    add_card(file, &cards, "NAXIS", text);
    for (int i = 0; i < image->dimensions; i++) {
        char key[18];
        snprintf(key, sizeof key, "NAXIS%d", i + 1);
        snprintf(text, sizeof text, "%d", image->axis[i]);
        add_card(file, &cards, key, text);
    }
    for (int i = 0; i < 3 && image->extra[i]; i++)
        memcpy(file + CARD * cards++, image->extra[i], strlen(image->extra[i]));
    memcpy(file + CARD * cards, "END", 3);
    const int bytes = abs(image->bits) / 8;
    for (int i = 0; i < COUNT; i++) {
        uint64_t word = (uint64_t)(int64_t)value[i];
        if (image->bits < 0)
            memcpy(&word, &value[i], sizeof word);
        for (int k = 0; k < bytes; k++)
            file[BLOCK + i * bytes + k] = (char)(word >> (8 * (bytes - 1 - k)));
    }
}

/* Read a file from its bytes. Returns what number_table_read returns. */
static int read_fits(number_table *table, const char *bytes, size_t count, char *error)
{
    char path[] = "/tmp/pzs-fits-XXXXXX";
    const int handle = mkstemp(path);
    FILE *file = handle >= 0 ? fdopen(handle, "wb") : NULL;
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, count, file), count);
    assert_int_equal(fclose(file), 0);
    const int failed = number_table_read(table, path, error);
    unlink(path);
    return failed;
}

static const image plain = {-64, 2, {3, 2}, {NULL}};
static const double numbers[COUNT] = {1, -2.5, 3e-3, 4, 5, -7};
static const double integers[COUNT] = {1, -2, 3, 4, 5, -7};

/* Law: without cfitsio a FITS file is refused with the name of the package; else it is read. */
static void test_support(void **state)
{
    char bytes[FILE_BYTES], error[NUMBER_ERROR] = "";
    number_table table;
    write_fits(bytes, &plain, numbers);
    const int failed = read_fits(&table, bytes, sizeof bytes, error);
    if (failed)
        assert_non_null(strstr(error, "install libcfitsio-dev"));
    else
        assert_true(table.rows == 2 && table.columns == 3);
    *(bool *)*state = !failed;
    number_table_free(&table);
}

/*
 * Law: an image is a table whose columns run along its first axis; a cube has a row for each plane;
 * scale and offset of integers apply, and pixels without a value are NaN.
 */
static void test_images(void **state)
{
    static const struct {
        image image;
        size_t rows, columns;
        double scale, offset, blank;
    } cases[] = {
        {{-64, 2, {3, 2}, {NULL}}, 2, 3, 1, 0, 99},
        {{-64, 1, {6}, {NULL}}, 6, 1, 1, 0, 99},
        {{-64, 3, {3, 1, 2}, {NULL}}, 2, 3, 1, 0, 99},
        {{16, 2, {3, 2}, {"BSCALE  =                  0.5", "BZERO   =                 10.0"}},
         2,
         3,
         0.5,
         10,
         99},
        {{16, 2, {2, 3}, {"BLANK   =                   -7"}}, 3, 2, 1, 0, -7},
    };
    if (!*(bool *)*state)
        skip();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const double *given = cases[k].image.bits < 0 ? numbers : integers;
        char bytes[FILE_BYTES], error[NUMBER_ERROR] = "";
        number_table table;
        write_fits(bytes, &cases[k].image, given);
        if (read_fits(&table, bytes, sizeof bytes, error) != 0)
            fail_msg("image %zu: %s", k, error);
        assert_true(table.rows == cases[k].rows && table.columns == cases[k].columns);
        for (int i = 0; i < COUNT; i++)
            if (given[i] == cases[k].blank)
                assert_true(isnan(table.value[i]));
            else
                assert_true(table.value[i] == cases[k].scale * given[i] + cases[k].offset);
        number_table_free(&table);
    }
}

/* Law: a FITS file that is no table is one error with what was found. */
static void test_faults(void **state)
{
    static const struct {
        image image;
        size_t bytes;
        const char *expected;
    } bad[] = {
        {{-64, 4, {1, 1, 1, 1}, {NULL}}, FILE_BYTES, "more than three dimensions"},
        {{-64, 0, {0}, {NULL}}, FILE_BYTES, "no image in the FITS file"},
        {{-64, 2, {0, 3}, {NULL}}, FILE_BYTES, "axes are empty"},
        {{-64, 2, {100000, 100000}, {NULL}}, FILE_BYTES, "above 8 million"},
        {{-64, 2, {3, 2}, {NULL}}, BLOCK + 8, "cfitsio cannot read it"},
        {{-64, 2, {3, 2}, {NULL}}, BLOCK, "cfitsio cannot read it"},
        {{-64, 2, {3, 2}, {NULL}}, 100, "cfitsio cannot read it"},
    };
    if (!*(bool *)*state)
        skip();
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char bytes[FILE_BYTES], error[NUMBER_ERROR] = "";
        number_table table;
        write_fits(bytes, &bad[k].image, numbers);
        if (read_fits(&table, bytes, bad[k].bytes, error) == 0 || !strstr(error, bad[k].expected))
            fail_msg("expected '%s', got '%s'", bad[k].expected, error);
        assert_null(table.value);
    }
}

/* Law: damaged headers and cut files are read or refused, never a fault. */
static void test_garbage(void **state)
{
    uint32_t random = 1;
    if (!*(bool *)*state)
        skip();
    for (int k = 0; k < 1000; k++) {
        char bytes[FILE_BYTES], error[NUMBER_ERROR];
        number_table table;
        write_fits(bytes, &plain, numbers);
        for (int i = 0; i < 3; i++) {
            random = random * 1664525u + 1013904223u;
            bytes[10 + (random >> 8) % (6 * CARD)] = (char)(32 + (random >> 24) % 95);
        }
        (void)read_fits(&table, bytes, k % 2 ? sizeof bytes : (size_t)(k % 3) * BLOCK, error);
        number_table_free(&table);
    }
}

int main(void)
{
    static bool is_supported;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_support, &is_supported),
        cmocka_unit_test_prestate(test_images, &is_supported),
        cmocka_unit_test_prestate(test_faults, &is_supported),
        cmocka_unit_test_prestate(test_garbage, &is_supported),
    };
    return cmocka_run_group_tests_name("fits", tests, NULL, NULL);
}
