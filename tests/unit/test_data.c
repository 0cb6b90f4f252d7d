#define _XOPEN_SOURCE 700
/*
 * Arrays of numbers in files: tables as text and as .npy, named arrays as .npz, values at scattered
 * points and the areas of points.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>
#include "../../host_tools/data/named_array.h"
#include "../../host_tools/data/number_table.h"
#include "../../host_tools/data/point_area.h"
#include "../../host_tools/data/scatter.h"
#include "../../lib/core/guard.h"
#include "../rigs/uniform.h"

/* A file with given bytes, which close_file removes. */
typedef struct temporary {
    char path[64];
} temporary;

static temporary write_file(const void *bytes, size_t count)
{
    temporary t = {"/tmp/pzs-data-XXXXXX"};
    const int handle = mkstemp(t.path);
    FILE *file = handle >= 0 ? fdopen(handle, "wb") : NULL;
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, count, file), count);
    assert_int_equal(fclose(file), 0);
    return t;
}

static int read_bytes(number_table *table, const void *bytes, size_t count, char *error)
{
    const temporary t = write_file(bytes, count);
    const int failed = number_table_read(table, t.path, error);
    unlink(t.path);
    return failed;
}

/* ---- text ------------------------------------------------------------- */

/* Law: the same 2 x 3 numbers in every layout of text are the same table. */
static void test_text_layouts(void **state)
{
    (void)state;
    static const char *const layouts[] = {
        "1,-2.5,3e-3\n4,5,6\n",
        "1;-2.5;3e-3\r\n4;5;6\r\n",
        "1\t-2.5\t3e-3\r4\t5\t6",
        "  1   -2.5 3e-3  \n\n 4 5 6\n\n",
        "# a comment\n1, -2.5, 3e-3\n# another\n4, 5, 6\n",
        "a,b,c\n1,-2.5,3e-3\n4,5,6\n",
        "\xef\xbb\xbf\"a\";\"b\";\"c\"\n1;-2.5;3e-3\n4;5;6\n",
        "name,a,b,c\nfirst,1,-2.5,3e-3\nsecond,4,5,6\n",
        "first 1 -2.5 3e-3\nsecond 4 5 6\n",
    };
    static const double expected[6] = {1, -2.5, 3e-3, 4, 5, 6};
    for (size_t k = 0; k < sizeof layouts / sizeof *layouts; k++) {
        number_table table;
        char error[NUMBER_ERROR] = "";
        if (read_bytes(&table, layouts[k], strlen(layouts[k]), error) != 0)
            fail_msg("layout %zu: %s", k, error);
        assert_int_equal(table.rows, 2);
        assert_int_equal(table.columns, 3);
        for (int i = 0; i < 6; i++)
            assert_true(table.value[i] == expected[i]);
        assert_int_equal(table.column_name != NULL, k >= 5 && k <= 7);
        assert_int_equal(table.row_name != NULL, k >= 7);
        if (table.column_name) {
            assert_string_equal(table.column_name[2], "c");
            assert_int_equal(number_table_column(&table, "b"), 1);
        }
        if (table.row_name)
            assert_string_equal(table.row_name[1], "second");
        assert_int_equal(number_table_column(&table, "3"), 2);
        assert_int_equal(number_table_column(&table, "4"), -1);
        number_table_free(&table);
    }
}

/*
 * Law: a comment right above the numbers with a word for each column names the columns, as
 * numpy.savetxt writes a header; any other comment is only skipped.
 */
static void test_text_comments(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool names;
    } comments[] = {
        {"# x [mm]   y (mm) e1\n1 2 3\n", true},
        {"# x,y,e1\n1,2,3\n", true},
        {"# by hand\n# x y e1\n1 2 3\n", true},
        {"#x;y;e1\n\n1;2;3\n", true},
        {"# x,y\n1,2,3\n", false},
        {"# x,y,e 1\n1,2,3\n", false},
        {"# run,of,12\n1,2,3\n", false},
        {"# x,y,e1\n# mm\n1,2,3\n", false},
        {"1,2,3\n# x,y,e1\n4,5,6\n", false},
    };
    for (size_t k = 0; k < sizeof comments / sizeof *comments; k++) {
        number_table table;
        char error[NUMBER_ERROR] = "";
        const char *text = comments[k].text;
        if (read_bytes(&table, text, strlen(text), error) != 0)
            fail_msg("'%s': %s", text, error);
        if ((table.column_name != NULL) != comments[k].names)
            fail_msg("'%s': names expected: %d", text, comments[k].names);
        assert_int_equal(number_table_column(&table, "e1"), comments[k].names ? 2 : -1);
        assert_true(table.columns == 3 && table.value[2] == 3);
        number_table_free(&table);
    }
}

/* Law: text that is no table is one error with the line, the value and the cure. */
static void test_text_faults(void **state)
{
    (void)state;
    static const struct {
        const char *text, *expected;
    } bad[] = {
        {"", ": the file is empty"},
        {"# only\n", ": no numbers in the file"},
        {"a,b\n", "names but no numbers"},
        {"1,2,3\n4,5\n", ":2: 2 values where line 1 has 3"},
        {"1,2,3\n4,5,6,7\n", ":2: 4 values where line 1 has 3"},
        {"a,b\n1,2,3\n", ":2: 3 values where line 1 has 2"},
        {"1,2\n3,\n", ":2: value 2 is empty"},
        {"a,b,\n1,2,\n", ":2: value 3 is empty; write a number, or nan, or remove the delimiter"},
        {"\xff\xfe"
         "1\0,\0",
         "text in UTF-16"},
        {"1,2\n3,four\n", ":2: value 2, 'four', is not a number"},
        {"1,2x\n3,4\n", ":1: value 2, '2x', is not a number"},
        {"0,5;0,3\n1,5;1,3\n", ":1: value 1, '0,5', has a comma; write a point"},
        {"1;2\n1,5;1,3\n", ":2: value 1, '1,5', has a comma; write a point"},
        {"a;b\n1;0,3\n", ":2: value 2, '0,3', has a comma; write a point"},
        {"1,5\n2\n", ":2: 1 values where line 1 has 2; a value or a delimiter is missing or too "
                     "many in one of the two; for decimals write a point"},
        {"1 2\n1,2\n", ":2: 1 values where line 1 has 2; a value or a delimiter is missing or too "
                       "many in one of the two; for decimals write a point"},
        {"1;2\n1\n", ":2: 1 values where line 1 has 2; a value or a delimiter is missing or too "
                     "many"},
        {"1,0x10\n", ":1: value 2, '0x10', is not a number"},
        {"1 2\n3 \x01\n", ":2: binary data"},
        {"# x,y,e1\n1,2,3,4\n", ":2: the comment above has 3 names for 4 columns"},
        {"PK\x03\x04", "ZIP or .npz archive"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        number_table table;
        char error[NUMBER_ERROR] = "no fault";
        const int failed = read_bytes(&table, bad[k].text, strlen(bad[k].text), error);
        if (!failed || !strstr(error, bad[k].expected))
            fail_msg("'%s': expected '%s', got '%s'", bad[k].text, bad[k].expected, error);
        assert_null(table.value);
    }
}

/* Law: random bytes and every truncation of a table are read or refused, never a fault. */
static void test_text_garbage(void **state)
{
    (void)state;
    char bytes[400];
    uint32_t random = 1;
    for (int k = 0; k < 3000; k++) {
        const size_t count = (size_t)k % sizeof bytes;
        for (size_t i = 0; i < count; i++) {
            random = random * 1664525u + 1013904223u;
            const char *const common = "0123456789.,;-e \n\tna#x\"\xff";
            bytes[i] = k % 2 ? common[(random >> 24) % 23] : (char)(random >> 24);
        }
        number_table table;
        char error[NUMBER_ERROR];
        (void)read_bytes(&table, bytes, count, error);
        number_table_free(&table);
    }
}

/* Law: a file above the limit is refused by its size alone, before anything is read. */
static void test_huge(void **state)
{
    (void)state;
    const temporary t = write_file("1", 1);
    number_table table;
    char error[NUMBER_ERROR] = "";
    assert_int_equal(truncate(t.path, 100000000), 0);
    assert_int_equal(number_table_read(&table, t.path, error), -1);
    unlink(t.path);
    assert_non_null(strstr(error, "95.4 MB; a table of at most 64 MB"));
}

/* Law: a folder is refused as what it is; its "size" is no size. */
static void test_folder(void **state)
{
    (void)state;
    number_table table;
    char error[NUMBER_ERROR] = "";
    assert_int_equal(number_table_read(&table, "/tmp", error), -1);
    assert_non_null(strstr(error, "cannot read it"));
    assert_null(strstr(error, "MB"));
}

/* ---- .npy ------------------------------------------------------------- */

/* Bytes of a .npy file of a version with a header and data. Returns their number. */
static size_t npy(unsigned char *bytes, int version, const char *header, const void *data,
                  size_t count)
{
    const size_t length = strlen(header), first = version == 1 ? 10 : 12;
    memset(bytes, 0, first);
    memcpy(bytes, "\x93NUMPY", 6);
    bytes[6] = (unsigned char)version;
    bytes[8] = (unsigned char)length;
    memcpy(bytes + first, header, length);
    memcpy(bytes + first + length, data, count);
    return first + length + count;
}

#define HEADER(type, order, shape)                                                                 \
    "{'descr': '" type "', 'fortran_order': " order ", 'shape': " shape ", }\n"

/* Law: the same numbers in every type, byte order, order of indices and version are the same. */
static void test_npy_types(void **state)
{
    (void)state;
    static const double c_order[6] = {1, 2, 3, 4, 5, 6}, fortran[6] = {1, 4, 2, 5, 3, 6};
    static const float single[6] = {1, 2, 3, 4, 5, 6};
    static const int16_t integer[6] = {1, 2, 3, 4, 5, 6};
    static const unsigned char byte[6] = {1, 2, 3, 4, 5, 6};
    static const unsigned char big[12] = {0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6};
    static const struct {
        int version;
        const char *header;
        const void *data;
        size_t bytes;
    } files[] = {
        {1, HEADER("<f8", "False", "(2, 3)"), c_order, sizeof c_order},
        {2, HEADER("<f8", "False", "(2, 3)"), c_order, sizeof c_order},
        {3, HEADER("<f8", "False", "(2,3)"), c_order, sizeof c_order},
        {1, HEADER("<f8", "True", "(2, 3)"), fortran, sizeof fortran},
        {1, HEADER("<f4", "False", "(2, 3)"), single, sizeof single},
        {1, HEADER("<i2", "False", "(2, 3)"), integer, sizeof integer},
        {1, HEADER(">i2", "False", "(2, 3)"), big, sizeof big},
        {1, HEADER("|u1", "False", "(2, 3)"), byte, sizeof byte},
        {1, HEADER("|i1", "False", "(2, 3)"), byte, sizeof byte},
    };
    unsigned char bytes[512];
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        number_table table;
        char error[NUMBER_ERROR] = "";
        const size_t count =
            npy(bytes, files[k].version, files[k].header, files[k].data, files[k].bytes);
        if (read_bytes(&table, bytes, count, error) != 0)
            fail_msg("file %zu: %s", k, error);
        assert_int_equal(table.rows, 2);
        assert_int_equal(table.columns, 3);
        for (int i = 0; i < 6; i++)
            assert_true(table.value[i] == c_order[i]);
        number_table_free(&table);
    }
}

/* Law: negative integers, and the extreme ones, keep their value; one dimension is a column. */
static void test_npy_integers(void **state)
{
    (void)state;
    static const int64_t value[4] = {-1, INT64_MIN, INT64_MAX, 7};
    unsigned char bytes[512];
    number_table table;
    char error[NUMBER_ERROR] = "";
    const size_t count = npy(bytes, 1, HEADER("<i8", "False", "(4,)"), value, sizeof value);
    assert_int_equal(read_bytes(&table, bytes, count, error), 0);
    assert_int_equal(table.rows, 4);
    assert_int_equal(table.columns, 1);
    for (int i = 0; i < 4; i++)
        assert_true(table.value[i] == (double)value[i]);
    number_table_free(&table);
}

/*
 * Law: an array of three dimensions is a table with a row for each first index, in which the last
 * index runs fastest, in both orders of the file.
 */
static void test_npy_cube(void **state)
{
    (void)state;
    enum { PLANES = 2, LINES = 3, PIXELS = 2, NUMBERS = PLANES * LINES * PIXELS };
    for (int is_fortran = 0; is_fortran < 2; is_fortran++) {
        double value[NUMBERS];
        unsigned char bytes[512];
        number_table table;
        char error[NUMBER_ERROR] = "";
        for (int i = 0; i < PLANES; i++)
            for (int j = 0; j < LINES; j++)
                for (int k = 0; k < PIXELS; k++)
                    value[is_fortran ? i + PLANES * (j + LINES * k)
                                     : (i * LINES + j) * PIXELS + k] = 100 * i + 10 * j + k;
        const size_t count = npy(bytes, 1,
                                 is_fortran ? HEADER("<f8", "True", "(2, 3, 2)")
                                            : HEADER("<f8", "False", "(2, 3, 2)"),
                                 value, sizeof value);
        assert_int_equal(read_bytes(&table, bytes, count, error), 0);
        assert_true(table.rows == PLANES && table.columns == LINES * PIXELS);
        for (int i = 0; i < NUMBERS; i++)
            assert_true(table.value[i] == 100 * (i / 6) + 10 * (i % 6 / 2) + i % 2);
        number_table_free(&table);
    }
}

/* Law: a file packed by gzip is refused with the cure, unless its name is that of a FITS file. */
static void test_packed(void **state)
{
    (void)state;
    static const unsigned char bytes[] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0};
    char error[NUMBER_ERROR] = "";
    number_table table;
    assert_int_equal(read_bytes(&table, bytes, sizeof bytes, error), -1);
    assert_non_null(strstr(error, "packed by gzip; unpack it"));
}

/* Law: a .npy file whose header lies is refused with what it says and what follows. */
static void test_npy_faults(void **state)
{
    (void)state;
    static const double value[6] = {1, 2, 3, 4, 5, 6};
    static const struct {
        int version;
        const char *header, *expected;
    } bad[] = {
        {1, HEADER("<f8", "False", "(3, 3)"), "3 x 3 numbers of 8 bytes, but 48 bytes follow"},
        {1, HEADER("<f8", "False", "(2, 2)"), "2 x 2 numbers of 8 bytes, but 48 bytes follow"},
        {1, HEADER("<f8", "False", "(4000000000, 4000000000)"), "above 8 million numbers"},
        {1, HEADER("<f8", "False", "(99999999999999999999999, 2)"), "above 8 million numbers"},
        {1, HEADER("<f8", "False", "(8000000, 8000000)"), "but 48 bytes follow"},
        {1, HEADER("<f8", "False", "(-2, 3)"), "not a list of numbers"},
        {1, HEADER("<f8", "False", "(0, 3)"), "empty or above"},
        {1, HEADER("<f8", "False", "(1, 1, 2, 3)"), "more than three dimensions"},
        {1, HEADER("<f8", "False", "(2, 8000000, 8000000)"), "but 48 bytes follow"},
        {1, HEADER("<c16", "False", "(2, 3)"),
         "type '<c16'; save the array as float64, with astype(float)"},
        {1, HEADER("<f2", "False", "(2, 3)"), "astype(float)"},
        {1, HEADER("|O", "False", "(2, 3)"), "astype(float)"},
        {1, HEADER("<f8", "Maybe", "(2, 3)"), "fortran_order"},
        {1, "{'descr': '<f8'", "no shape"},
        {1, "{'descr': '<f8', 'shape': (2,", "ends within the shape"},
        {1, "", "type nothing"},
        {7, HEADER("<f8", "False", "(2, 3)"), "no known version"},
    };
    unsigned char bytes[512];
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        number_table table;
        char error[NUMBER_ERROR] = "no fault";
        const size_t count = npy(bytes, bad[k].version, bad[k].header, value, sizeof value);
        const int failed = read_bytes(&table, bytes, count, error);
        if (!failed || !strstr(error, bad[k].expected))
            fail_msg("%s: expected '%s', got '%s'", bad[k].header, bad[k].expected, error);
    }
}

/* Law: every truncation and every changed byte of a .npy file is read or refused. */
static void test_npy_garbage(void **state)
{
    (void)state;
    static const double value[6] = {1, 2, 3, 4, 5, 6};
    unsigned char bytes[512];
    const size_t count = npy(bytes, 1, HEADER("<f8", "False", "(2, 3)"), value, sizeof value);
    for (size_t k = 0; k < 2 * count; k++) {
        number_table table;
        char error[NUMBER_ERROR];
        bytes[k % count] ^= k < count ? 0 : 0x81;
        (void)read_bytes(&table, bytes, k < count ? k : count, error);
        number_table_free(&table);
        bytes[k % count] ^= k < count ? 0 : 0x81;
    }
}

/* ---- .pgm ------------------------------------------------------------- */

/*
 * Law: a picture is the table of its grey values, rows from top to bottom, whatever the format, the
 * comments and the depth; a picture that is damaged is refused, and every truncation and every
 * changed byte is read or refused.
 */
static void test_pgm(void **state)
{
    (void)state;
    static const struct {
        const char *bytes;
        size_t count;
    } good[] = {
        {"P2 3 2 9 1 2 3 4 5 6", 20},
        {"P2\n# three by two\n3 2\n# depth\n9\n1 2 3\n4 5 6\n", 43},
        {"P5 3 2 9\n\1\2\3\4\5\6", 15},
        {"P5\n3 2\n65535\n\0\1\0\2\0\3\0\4\0\5\0\6", 25},
    };
    static const char *const bad[] = {
        "P2 3 2 9 1 2 3 4 5",     "P2 3 2 9 1 2 3 4 5 10", "P2 0 2 9 1",
        "P2 3 -2 9 1 2 3 4 5 6",  "P2 3 2 0 0 0 0 0 0 0",  "P5 3 2 9 \1\2\3",
        "P2 9999999 9999999 9 1",
    };
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        number_table table;
        char error[NUMBER_ERROR] = "", bytes[64];
        if (read_bytes(&table, good[k].bytes, good[k].count, error) != 0)
            fail_msg("picture %zu: %s", k, error);
        assert_true(table.rows == 2 && table.columns == 3);
        for (int i = 0; i < 6; i++)
            assert_true(fabs(table.value[i] - (i + 1)) <= 0);
        number_table_free(&table);
        memcpy(bytes, good[k].bytes, good[k].count);
        for (size_t i = 0; i < 2 * good[k].count; i++) {
            const size_t at = i % good[k].count;
            bytes[at] ^= (char)(i < good[k].count ? 0 : 0x11);
            (void)read_bytes(&table, bytes, i < good[k].count ? i : good[k].count, error);
            number_table_free(&table);
            bytes[at] ^= (char)(i < good[k].count ? 0 : 0x11);
        }
    }
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        number_table table;
        char error[NUMBER_ERROR] = "";
        assert_int_equal(read_bytes(&table, bad[k], strlen(bad[k]), error), -1);
        assert_non_null(strstr(error, "picture"));
        number_table_free(&table);
    }
}

/* ---- .npz ------------------------------------------------------------- */

static uint32_t number_at(const unsigned char *bytes, int count)
{
    uint32_t number = 0;
    for (int i = count - 1; i >= 0; i--)
        number = number << 8 | bytes[i];
    return number;
}

/*
 * Law: each member of an archive holds its array as .npy bytes that number_table_read reads, with
 * the CRC-32 that its header states. The CRC of "123456789" is the published check value.
 */
static void test_npz(void **state)
{
    (void)state;
    static const double matrix[6] = {1, 2, 3, 4, 5, -6e-300}, vector[2] = {7, 8};
    static const named_array arrays[2] = {{"matrix", "um/V", NULL, 2, 3, matrix},
                                          {"vector", "", NULL, 2, 0, vector}};
    unsigned char bytes[4096];
    assert_true(~pzs_guard_crc(GUARD_CRC_START, "123456789", 9) == 0xCBF43926u);
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(named_array_npz(file, arrays, 2), 0);
    rewind(file);
    const size_t count = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    size_t at = 0;
    for (int k = 0; k < 2; k++) {
        const size_t length = number_at(bytes + at + 22, 4), name = number_at(bytes + at + 26, 2);
        const unsigned char *data = bytes + at + 30 + name;
        number_table table;
        char error[NUMBER_ERROR];
        assert_true(number_at(bytes + at, 4) == 0x04034b50u);
        assert_true(~pzs_guard_crc(GUARD_CRC_START, data, length) == number_at(bytes + at + 14, 4));
        assert_int_equal(read_bytes(&table, data, length, error), 0);
        assert_memory_equal(table.value, arrays[k].value,
                            table.rows * table.columns * sizeof(double));
        assert_int_equal(table.columns, k == 0 ? 3 : 1);
        number_table_free(&table);
        at += 30 + name + length;
    }
    assert_true(number_at(bytes + count - 22, 4) == 0x06054b50u);
    assert_int_equal(number_at(bytes + count - 12, 2), 3);
}

/* Law: an array written as CSV and read again has the same bits. */
static void test_csv(void **state)
{
    (void)state;
    static const double matrix[6] = {0.1, 1 / 3.0, -DBL_MIN, DBL_MAX, 5e-324, 1e22};
    static const named_array array = {"influence", "um/V", NULL, 2, 3, matrix};
    char bytes[1024];
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(named_array_csv(file, &array), 0);
    rewind(file);
    const size_t count = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    number_table table;
    char error[NUMBER_ERROR];
    assert_int_equal(read_bytes(&table, bytes, count, error), 0);
    assert_memory_equal(table.value, matrix, sizeof matrix);
    assert_string_equal(table.column_name[1], "influence_2 (um/V)");
    assert_int_equal(number_table_check(&table, "f.csv", error), -1);
    assert_non_null(strstr(error, "f.csv: line 3, column 1 holds 1.798e+308, and numbers go up"));
    table.value[3] = 1e60;
    assert_int_equal(number_table_check(&table, "f.csv", error), 0);
    number_table_free(&table);
}

/* ---- scattered points ------------------------------------------------- */

enum { POINTS = 400 };

/*
 * Law: moving least squares reproduces linear functions at every place, inside and outside, in one
 * to three coordinates, and returns the value at a point.
 */
static void test_scatter_linear(void **state)
{
    (void)state;
    for (int axes = 1; axes <= 3; axes++) {
        double point[POINTS * 3], value[POINTS], place[3];
        uint32_t random = 5;
        for (int i = 0; i < POINTS; i++) {
            value[i] = 0.3;
            for (int a = 0; a < axes; a++) {
                point[i * axes + a] = uniform(&random, 0, 1);
                value[i] += (a + 1) * point[i * axes + a];
            }
        }
        scatter *s = scatter_open(axes, POINTS, point, value);
        assert_non_null(s);
        for (int k = 0; k < 500; k++) {
            double expected = 0.3, distance;
            for (int a = 0; a < axes; a++) {
                place[a] = 1.2 * uniform(&random, 0, 1) - 0.1;
                expected += (a + 1) * place[a];
            }
            /* Rounding is amplified by the distance over the width of the nearest points. */
            assert_true(fabs(scatter_value(s, place, &distance) - expected) < 1e-11);
        }
        for (int i = 0; i < POINTS; i++)
            assert_true(scatter_value(s, point + i * axes, NULL) == value[i]);
        scatter_close(s);
    }
}

/* Law: points on a line in the plane give no slope across it, and their own slope along it. */
static void test_scatter_line(void **state)
{
    (void)state;
    double point[20], value[10];
    const double place[2] = {0.35, 9};
    for (int i = 0; i < 10; i++) {
        point[2 * i] = 0.1 * i;
        point[2 * i + 1] = 0;
        value[i] = 5 * point[2 * i];
    }
    scatter *s = scatter_open(2, 10, point, value);
    double distance;
    assert_non_null(s);
    assert_true(fabs(scatter_value(s, place, &distance) - 1.75) < 1e-9);
    assert_true(fabs(distance - hypot(0.05, 9)) < 1e-12);
    assert_true(fabs(scatter_spacing(s) - 0.1) < 1e-12);
    scatter_close(s);
}

/* Law: the error of a smooth function falls with the square of the spacing. */
static void test_scatter_order(void **state)
{
    (void)state;
    double error[2] = {0, 0};
    for (int level = 0; level < 2; level++) {
        const int n = level ? 40 : 20;
        double *point = calloc((size_t)(2 * n * n), sizeof *point);
        double *value = calloc((size_t)(n * n), sizeof *value);
        assert_true(point && value);
        for (int i = 0; i < n * n; i++) {
            point[2 * i] = i / n / (n - 1.0);
            point[2 * i + 1] = i % n / (n - 1.0);
            value[i] = sin(3 * point[2 * i]) * cos(2 * point[2 * i + 1]);
        }
        scatter *s = scatter_open(2, (size_t)(n * n), point, value);
        uint32_t random = 9;
        for (int k = 0; k < 2000; k++) {
            const double place[2] = {uniform(&random, 0, 1), uniform(&random, 0, 1)};
            error[level] = fmax(error[level], fabs(scatter_value(s, place, NULL) -
                                                   sin(3 * place[0]) * cos(2 * place[1])));
        }
        scatter_close(s);
        free(point);
        free(value);
    }
    print_message("error %.2e, with half of the spacing %.2e\n", error[0], error[1]);
    assert_true(error[1] < 0.35 * error[0]); /* second order: (19/39)^2 = 0.24 */
    assert_true(error[1] < 13 / pow(39, 2)); /* largest second derivative times spacing squared */
}

/* ---- areas ------------------------------------------------------------ */

/*
 * Law: on a grid with its border, inner points have the area of a cell, points of the border half
 * of it and corners a quarter.
 */
static void test_area_grid(void **state)
{
    (void)state;
    enum { N = 7 };
    double place[N * N][3], area[N * N];
    for (int i = 0; i < N * N; i++) {
        place[i][0] = 0.5 * (i / N);
        place[i][1] = 0.25 * (i % N);
        place[i][2] = i;
    }
    assert_int_equal(point_areas(N * N, place, area), 0);
    for (int i = 0; i < N * N; i++) {
        const int border = (i / N % (N - 1) == 0) + (i % N % (N - 1) == 0);
        assert_true(fabs(area[i] - 0.125 / (1 << border)) < 1e-14);
    }
}

/* Law: the areas of any points are positive and sum up to the area of their hull. */
static void test_area_sum(void **state)
{
    (void)state;
    enum { N = 500 };
    static double place[N][3];
    double area[N], sum = 0;
    uint32_t random = 3;
    for (int i = 0; i < N; i++) {
        place[i][0] = i < 4 ? i % 2 : uniform(&random, 0, 1);
        place[i][1] = i < 4 ? i / 2 : uniform(&random, 0, 1);
    }
    memcpy(place[100], place[99], sizeof *place); /* two points at the same place */
    assert_int_equal(point_areas(N, place, area), 0);
    for (int i = 0; i < N; i++) {
        assert_true(area[i] > 0);
        sum += area[i];
    }
    assert_true(fabs(sum - 1) < 1e-12);
    assert_true(area[100] == area[99]);
}

/* Law: points on a line have half the distance to each neighbour. */
static void test_area_line(void **state)
{
    (void)state;
    double place[4][3] = {{3, 3, 0}, {0, 0, 0}, {1, 1, 0}, {6, 6, 0}}, area[4];
    static const double expected[4] = {2.5, 0.5, 1.5, 1.5};
    assert_int_equal(point_areas(4, place, area), 0);
    for (int i = 0; i < 4; i++)
        assert_true(fabs(area[i] - expected[i] * sqrt(2)) < 1e-14);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text_layouts), cmocka_unit_test(test_text_comments),
        cmocka_unit_test(test_text_faults),  cmocka_unit_test(test_text_garbage),
        cmocka_unit_test(test_huge),         cmocka_unit_test(test_folder),
        cmocka_unit_test(test_npy_types),    cmocka_unit_test(test_npy_integers),
        cmocka_unit_test(test_npy_faults),   cmocka_unit_test(test_npy_cube),
        cmocka_unit_test(test_packed),       cmocka_unit_test(test_npy_garbage),
        cmocka_unit_test(test_npz),          cmocka_unit_test(test_pgm),
        cmocka_unit_test(test_csv),          cmocka_unit_test(test_scatter_linear),
        cmocka_unit_test(test_scatter_line), cmocka_unit_test(test_scatter_order),
        cmocka_unit_test(test_area_grid),    cmocka_unit_test(test_area_sum),
        cmocka_unit_test(test_area_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
