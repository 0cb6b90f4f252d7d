/*
 * Instructions of factor and solve on a Cortex-M: n = 200, half bandwidth 48, 197,176 multiply-adds.
 *
 * Runs on any board whose start-up calls main with semihosting. mark_start and mark_stop
 * enclose what is counted: QEMU runs the image with a TCG plugin that counts the
 * instructions from one address to the other and prints the number at each stop, first
 * the factor, then the solve:
 *
 *   arm-none-eabi-gcc -std=c99 -O2 -mcpu=cortex-m7 -mfpu=fpv5-d16 -mthumb -mfloat-abi=hard -ffp-contract=off \
 *       -fno-math-errno -DPZS_REAL_BITS=32 -DPZS_TILE=4 -Iinclude -Ilib count_linalg.c linalg.c <start-up> -T <board.ld>
 *   qemu-system-arm -M mps2-an500 -kernel x.elf -nographic -monitor none -serial stdio \
 *       -semihosting-config enable=on,target=native -plugin libicnt.so,start=0x<mark_start>,stop=0x<mark_stop>
 *
 * The addresses are those of `arm-none-eabi-nm x.elf`. QEMU counts instructions, not cycles.
 * The image exits with main's value and prints a hash of the factor and of the solution, to
 * be compared with the same program built for the host (-DON_HOST).
 */
#include <string.h>

#include "linalg.h"

#define N 200u
#define BAND 48u
#define REALS ((N + 15u) * (BAND + 32u))

static uint16_t first[N];
static uint32_t start[N / PZS_TILE + 2u];
static pzs_real value[REALS];
static pzs_real inverse[N];
static pzs_real x[N];

void mark_start(void);
void mark_stop(void);

#ifdef ON_HOST
#include <stdio.h>
static void say(const char *text)
{
    fputs(text, stdout);
}
#else
static void say(const char *text)
{
    register int operation __asm__("r0") = 4; /* SYS_WRITE0 */
    register const char *argument __asm__("r1") = text;

    __asm__ volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
}
#endif

__attribute__((noinline)) void mark_start(void)
{
    __asm__ volatile("" ::: "memory");
}

__attribute__((noinline)) void mark_stop(void)
{
    __asm__ volatile("" ::: "memory");
}

/* FNV-1a over the bits of one number. */
static uint32_t mix(uint32_t hash, pzs_real number)
{
    unsigned char byte[sizeof number];

    memcpy(byte, &number, sizeof byte);
    for (size_t i = 0; i < sizeof byte; i++)
        hash = (hash ^ byte[i]) * 16777619u;
    return hash;
}

static void say_hash(const char *name, uint32_t hash)
{
    char text[12];

    for (int i = 0; i < 8; i++)
        text[i] = "0123456789abcdef"[(hash >> (28 - 4 * i)) & 15u];
    text[8] = '\n';
    text[9] = 0;
    say(name);
    say(text);
}

int main(void)
{
    pzs_envelope a = {N, first, start, value, inverse};
    linalg_inertia found;
    uint32_t hash = 2166136261u;

    for (uint32_t i = 0; i < N; i++)
        first[i] = (uint16_t)(i > BAND ? i - BAND : 0u);
    if (linalg_reals(first, N) > REALS)
        return 3;
    linalg_layout(&a);
    linalg_clear(&a);
    for (uint32_t i = 0; i < N; i++) {
        for (uint32_t j = first[i]; j <= i; j++)
            *linalg_entry(&a, i, j) =
                i == j ? (pzs_real)(2u * BAND) : (pzs_real)((i * 37u + j * 101u) % 257u) / 128 - 1;
        x[i] = (pzs_real)(i % 7u) - 3;
    }
    mark_start();
    found = linalg_factor(&a);
    mark_stop();
    mark_start();
    linalg_solve(&a, x);
    mark_stop();
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t j = first[i]; j <= i; j++)
            hash = mix(hash, *linalg_entry(&a, i, j));
    say_hash("factor ", hash);
    hash = 2166136261u;
    for (uint32_t i = 0; i < N; i++)
        hash = mix(hash, x[i]);
    say_hash("solve  ", hash);
    return found.zero >= 0 ? 1 : 0;
}
