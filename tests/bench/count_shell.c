/*
 * Cost of the element at a shape: one Newton system, resultants, force. On a board with an FPU
 * instructions are counted; built with -mfloat-abi=soft and the linker's --wrap of the five double
 * operations (count_shell.sh), each addition, subtraction, multiplication and division. On the host
 * there is no count, only the bits to compare.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include "../../firmware_demo/boards/board.h"
#include "../../lib/core/guard.h"
#include "../../firmware_demo/demos/print.h"
#include "../../lib/model/shell.h"

#if defined(__SOFTFP__) && PZS_REAL_BITS == 64

static uint32_t operations;

#define COUNTED(name)                                                                              \
    double __real___aeabi_##name(double a, double b);                                              \
    double __wrap___aeabi_##name(double a, double b);                                              \
    double __wrap___aeabi_##name(double a, double b)                                               \
    {                                                                                              \
        operations++;                                                                              \
        return __real___aeabi_##name(a, b);                                                        \
    }
COUNTED(dadd)
COUNTED(dsub)
COUNTED(drsub)
COUNTED(dmul)
COUNTED(ddiv)

static uint32_t count(void)
{
    return operations;
}

static uint32_t between(uint32_t from, uint32_t to)
{
    return to - from;
}

#else

static uint32_t count(void)
{
    return board_count();
}

static uint32_t between(uint32_t from, uint32_t to)
{
    return board_instructions(from, to);
}

#endif

static pzs_element_type kind;
static pzs_real u[SHELL_MAX], du[SHELL_MAX], given[SHELL_STRAINS];
static struct {
    pzs_real f[SHELL_MAX], k[SHELL_PACKED(SHELL_MAX)], resultant[SHELL_RESULTANTS];
} out;

/* Numbers in steps of 2^-12 between -1 and 1, the same on every target. */
static void fill(void *to, size_t bytes, uint32_t seed)
{
    pzs_real *x = to;
    for (size_t i = 0; i < bytes / sizeof *x; i++) {
        seed = seed * 1664525u + 1013904223u;
        x[i] = (pzs_real)((int32_t)(seed >> 19) - 4096) / 4096;
    }
}

/* One line of counts, then one of the bits of all results. */
static void row(const char *word, unsigned dof_per_node)
{
    uint32_t time[4];
    fill(&out, sizeof out, 5);
    time[0] = count();
    pzs_shell_resultants(&kind, dof_per_node, u, du, given, out.resultant);
    time[1] = count();
    pzs_shell_force_at(&kind, dof_per_node, u, out.resultant, out.f);
    time[2] = count();
    pzs_shell_system(&kind, dof_per_node, u, given, out.resultant, out.f, out.k);
    time[3] = count();
    print_text(word);
    print_count("unknowns", dof_per_node);
    print_count("system", between(time[2], time[3]));
    print_count("resultants", between(time[0], time[1]));
    print_count("force", between(time[1], time[2]));
    print_text("\nbits");
    print_hex("all", ~pzs_guard_crc(GUARD_CRC_START, &out, sizeof out));
    print_text("\n");
}

int main(void)
{
    board_start();
    fill(&kind, sizeof kind, 1);
    fill(u, sizeof u, 2);
    fill(du, sizeof du, 3);
    fill(given, sizeof given, 4);
    kind.skew[0] = kind.skew[1] = 0;
    row("count", 7);
    row("count", 6);
    kind.skew[0] = (pzs_real)0.25;
    kind.skew[1] = (pzs_real)-0.125;
    kind.skew[2] = (pzs_real)1.5;
    row("skewed", 7);
    print_text("stack");
    print_count("bytes", board_stack_used());
    print_text("\n");
    return 0;
}
