/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Products of matrices and vectors for Arm processors with a single-precision FPU (option PZS_VFP),
 * with the same bits as the portable functions. They take little more than one instruction for each
 * multiply-add instead of two, because one instruction loads up to 15 numbers.
 *
 * Registers (wider matrices are processed in groups of columns):
 *   s0 to s14   a part of a vector
 *   s15         sum over a matrix row, or factor of a row
 *   s16 to s30  a part of a matrix row
 */
#ifndef PZS_LIB_PRODUCT_VFP_H
#define PZS_LIB_PRODUCT_VFP_H

#include <string.h>
#include "pzs_base.h"

#if PZS_VFP

/*
 * Largest number of matrix columns that one assembler loop processes, so that a row fits into
 * registers.
 */
#define GROUP_LIMIT 15u

/*
 * Assembler instructions of products of matrix and vector on a processor with VFP registers s0 to
 * s31. The registers from s16 on hold the entries m_k of a matrix row, those from s0 on the entries
 * v_k of a vector.
 *   CHAIN_n   scalar product: s15 = s15 + m_1 v_1 + ... + m_n v_n, added in this order
 *   SPREAD_n  multiple of a row: v_k = v_k + s15 m_k for k = 1 to n
 */
#define CHAIN_1 "vmla.f32 s15, s0, s16\n\t"
#define CHAIN_2 CHAIN_1 "vmla.f32 s15, s1, s17\n\t"
#define CHAIN_3 CHAIN_2 "vmla.f32 s15, s2, s18\n\t"
#define CHAIN_4 CHAIN_3 "vmla.f32 s15, s3, s19\n\t"
#define CHAIN_5 CHAIN_4 "vmla.f32 s15, s4, s20\n\t"
#define CHAIN_6 CHAIN_5 "vmla.f32 s15, s5, s21\n\t"
#define CHAIN_7 CHAIN_6 "vmla.f32 s15, s6, s22\n\t"
#define CHAIN_8 CHAIN_7 "vmla.f32 s15, s7, s23\n\t"
#define CHAIN_9 CHAIN_8 "vmla.f32 s15, s8, s24\n\t"
#define CHAIN_10 CHAIN_9 "vmla.f32 s15, s9, s25\n\t"
#define CHAIN_11 CHAIN_10 "vmla.f32 s15, s10, s26\n\t"
#define CHAIN_12 CHAIN_11 "vmla.f32 s15, s11, s27\n\t"
#define CHAIN_13 CHAIN_12 "vmla.f32 s15, s12, s28\n\t"
#define CHAIN_14 CHAIN_13 "vmla.f32 s15, s13, s29\n\t"
#define CHAIN_15 CHAIN_14 "vmla.f32 s15, s14, s30\n\t"
#define SPREAD_1 "vmla.f32 s0, s15, s16\n\t"
#define SPREAD_2 SPREAD_1 "vmla.f32 s1, s15, s17\n\t"
#define SPREAD_3 SPREAD_2 "vmla.f32 s2, s15, s18\n\t"
#define SPREAD_4 SPREAD_3 "vmla.f32 s3, s15, s19\n\t"
#define SPREAD_5 SPREAD_4 "vmla.f32 s4, s15, s20\n\t"
#define SPREAD_6 SPREAD_5 "vmla.f32 s5, s15, s21\n\t"
#define SPREAD_7 SPREAD_6 "vmla.f32 s6, s15, s22\n\t"
#define SPREAD_8 SPREAD_7 "vmla.f32 s7, s15, s23\n\t"
#define SPREAD_9 SPREAD_8 "vmla.f32 s8, s15, s24\n\t"
#define SPREAD_10 SPREAD_9 "vmla.f32 s9, s15, s25\n\t"
#define SPREAD_11 SPREAD_10 "vmla.f32 s10, s15, s26\n\t"
#define SPREAD_12 SPREAD_11 "vmla.f32 s11, s15, s27\n\t"
#define SPREAD_13 SPREAD_12 "vmla.f32 s12, s15, s28\n\t"
#define SPREAD_14 SPREAD_13 "vmla.f32 s13, s15, s29\n\t"
#define SPREAD_15 SPREAD_14 "vmla.f32 s14, s15, s30\n\t"

/*
 * List of the registers that the assembler code of a matrix product overwrites, for the compiler.
 */
#define ALL_REGISTERS                                                                              \
    "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10", "s11", "s12", "s13", "s14", \
        "s15", "s16", "s17", "s18", "s19", "s20", "s21", "s22", "s23", "s24", "s25", "s26", "s27", \
        "s28", "s29", "s30", "cc", "memory"

/*
 * Return how many matrix columns the next assembler loop of a product processes when `left` columns
 * are left. The columns are divided into groups of nearly equal size, of at most GROUP_LIMIT
 * columns.
 */
static size_t group_columns(size_t left)
{
    const size_t groups = (left + GROUP_LIMIT - 1u) / GROUP_LIMIT;
    return (left + groups - 1u) / groups;
}

/*
 * Assembler loop over matrix rows that computes product[i] = from[i] + row i times vector. The
 * operands are the parameters of the function multiply_group, which contains it.
 */
#define MULTIPLY_ROWS(chain, vector_registers, row_registers)                                      \
    __asm__ volatile(                                                                              \
        "vldmia %[vector], {" vector_registers "}\n"                                               \
        "1:\tvldmia %[from]!, {s15}\n\t"                                                           \
        "vldmia %[table]!, {" row_registers "}\n\t"                                                \
        "add %[table], %[table], %[skip]\n\t" chain "vstmia %[product]!, {s15}\n\t"                \
        "subs %[rows], %[rows], #1\n\t"                                                            \
        "bne 1b"                                                                                   \
        : [product] "+r"(product), [from] "+r"(from), [table] "+r"(table), [rows] "+r"(rows)       \
        : [vector] "r"(vector), [skip] "r"(skip)                                                   \
        : ALL_REGISTERS)

/*
 * Compute product [rows] = from [rows] + table [rows][cols] times vector [cols], for at most
 * GROUP_LIMIT columns.
 *   rows in  number of rows, above 0
 *   skip in  distance in memory from the end of a row of the table to the start of the next (bytes)
 */
static void multiply_group(pzs_real *product, const pzs_real *from, const pzs_real *table,
                           size_t skip, const pzs_real *vector, size_t rows, size_t cols)
{
    switch (cols) {
    case 1: MULTIPLY_ROWS(CHAIN_1, "s0", "s16"); break;
    case 2: MULTIPLY_ROWS(CHAIN_2, "s0-s1", "s16-s17"); break;
    case 3: MULTIPLY_ROWS(CHAIN_3, "s0-s2", "s16-s18"); break;
    case 4: MULTIPLY_ROWS(CHAIN_4, "s0-s3", "s16-s19"); break;
    case 5: MULTIPLY_ROWS(CHAIN_5, "s0-s4", "s16-s20"); break;
    case 6: MULTIPLY_ROWS(CHAIN_6, "s0-s5", "s16-s21"); break;
    case 7: MULTIPLY_ROWS(CHAIN_7, "s0-s6", "s16-s22"); break;
    case 8: MULTIPLY_ROWS(CHAIN_8, "s0-s7", "s16-s23"); break;
    case 9: MULTIPLY_ROWS(CHAIN_9, "s0-s8", "s16-s24"); break;
    case 10: MULTIPLY_ROWS(CHAIN_10, "s0-s9", "s16-s25"); break;
    case 11: MULTIPLY_ROWS(CHAIN_11, "s0-s10", "s16-s26"); break;
    case 12: MULTIPLY_ROWS(CHAIN_12, "s0-s11", "s16-s27"); break;
    case 13: MULTIPLY_ROWS(CHAIN_13, "s0-s12", "s16-s28"); break;
    case 14: MULTIPLY_ROWS(CHAIN_14, "s0-s13", "s16-s29"); break;
    default: MULTIPLY_ROWS(CHAIN_15, "s0-s14", "s16-s30"); break;
    }
}

/*
 * Compute product [rows] = table [rows][cols] times vector [cols], one group of columns after the
 * other.
 *   from [rows] in  numbers to be added, if step = 1; not read if step = 0
 */
static void multiply(pzs_real *product, const pzs_real *from, size_t step, const pzs_real *table,
                     const pzs_real *vector, size_t rows, size_t cols)
{
    if (step == 0) {
        memset(product, 0, rows * sizeof *product);
        from = product;
    }
    for (size_t j = 0, now; j < cols && rows > 0; j += now) {
        now = group_columns(cols - j);
        multiply_group(product, from, table + j, (cols - now) * sizeof *table, vector + j, rows,
                       now);
        from = product;
    }
}

/*
 * Assembler loop over matrix rows that adds vector[i] times row i to product. The operands are the
 * parameters of the function sum_group, which contains it.
 */
#define SUM_ROWS(spread, product_registers, row_registers)                                         \
    __asm__ volatile("vldmia %[product], {" product_registers "}\n"                                \
                     "1:\tvldmia %[vector]!, {s15}\n\t"                                            \
                     "vldmia %[table]!, {" row_registers "}\n\t"                                   \
                     "add %[table], %[table], %[skip]\n\t" spread "subs %[rows], %[rows], #1\n\t"  \
                     "bne 1b\n\t"                                                                  \
                     "vstmia %[product], {" product_registers "}"                                  \
                     : [vector] "+r"(vector), [table] "+r"(table), [rows] "+r"(rows)               \
                     : [product] "r"(product), [skip] "r"(skip)                                    \
                     : ALL_REGISTERS)

/*
 * Add to product [cols] the sum over the rows i of vector[i] times row i of the table [rows][cols],
 * for at most GROUP_LIMIT columns.
 *   rows in  number of rows, above 0
 *   skip in  distance in memory from the end of a row of the table to the start of the next (bytes)
 */
static void sum_group(pzs_real *product, const pzs_real *table, size_t skip, const pzs_real *vector,
                      size_t rows, size_t cols)
{
    switch (cols) {
    case 1: SUM_ROWS(SPREAD_1, "s0", "s16"); break;
    case 2: SUM_ROWS(SPREAD_2, "s0-s1", "s16-s17"); break;
    case 3: SUM_ROWS(SPREAD_3, "s0-s2", "s16-s18"); break;
    case 4: SUM_ROWS(SPREAD_4, "s0-s3", "s16-s19"); break;
    case 5: SUM_ROWS(SPREAD_5, "s0-s4", "s16-s20"); break;
    case 6: SUM_ROWS(SPREAD_6, "s0-s5", "s16-s21"); break;
    case 7: SUM_ROWS(SPREAD_7, "s0-s6", "s16-s22"); break;
    case 8: SUM_ROWS(SPREAD_8, "s0-s7", "s16-s23"); break;
    case 9: SUM_ROWS(SPREAD_9, "s0-s8", "s16-s24"); break;
    case 10: SUM_ROWS(SPREAD_10, "s0-s9", "s16-s25"); break;
    case 11: SUM_ROWS(SPREAD_11, "s0-s10", "s16-s26"); break;
    case 12: SUM_ROWS(SPREAD_12, "s0-s11", "s16-s27"); break;
    case 13: SUM_ROWS(SPREAD_13, "s0-s12", "s16-s28"); break;
    case 14: SUM_ROWS(SPREAD_14, "s0-s13", "s16-s29"); break;
    default: SUM_ROWS(SPREAD_15, "s0-s14", "s16-s30"); break;
    }
}

/*
 * Compute product [cols] = sum over the rows i of vector[i] times row i of the table, one group of
 * columns after the other. The rows of the table are `stride` numbers apart.
 */
static void sum_rows(pzs_real *product, const pzs_real *table, size_t stride,
                     const pzs_real *vector, size_t rows, size_t cols)
{
    memset(product, 0, cols * sizeof *product);
    for (size_t j = 0, now; j < cols && rows > 0; j += now) {
        now = group_columns(cols - j);
        sum_group(product + j, table + j, (stride - now) * sizeof *table, vector, rows, now);
    }
}

#endif
#endif
