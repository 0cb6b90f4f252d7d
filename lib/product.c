/* Product of a table and a vector (product.h). */
#include <string.h>
#include "product.h"
#include "unrolled.h"

#define FOURS PZS_BY_BITS(7, 3) /* fours of columns multiplied together: what the registers hold, and what fills up */
#define FEW PZS_BY_BITS(3, 2)

/* y_i += COUNT fours of entries of row i times x, the x held in registers. */
#define MULTIPLY(name, COUNT) \
    static void name(pzs_real *restrict y, const pzs_real *restrict a, size_t stride, const pzs_real *restrict x, \
                     size_t rows) \
    { \
        pzs_real part[4 * (COUNT)]; \
        UNROLLED \
        for (unsigned k = 0; k < 4 * (COUNT); k++) \
            part[k] = x[k]; \
        for (size_t i = 0; i < rows; i++, a += stride) { \
            pzs_real sum = y[i]; \
            UNROLLED \
            for (unsigned k = 0; k < 4 * (COUNT); k++) \
                sum += a[k] * part[k]; \
            y[i] = sum; \
        } \
    }

MULTIPLY(multiply_many, FOURS)
MULTIPLY(multiply_some, FEW)
MULTIPLY(multiply_one, 1)

/* Whole fours read on into the row below, where there is one and x is zero. */
void product(pzs_real *restrict y, const pzs_real *restrict a, const pzs_real *restrict x, size_t rows, size_t cols)
{
    const size_t last = 1u + 3u / cols, whole = last < rows ? rows - last : 0;
    memset(y, 0, rows * sizeof *y);
    for (size_t j = 0, now; j < cols; j += 4u * now) {
        const size_t fours = (cols - j + 3u) / 4u;
        now = fours >= FOURS ? FOURS : fours >= FEW ? FEW : 1u;
        if (now == FOURS)
            multiply_many(y, a + j, cols, x + j, whole);
        else if (now == FEW)
            multiply_some(y, a + j, cols, x + j, whole);
        else
            multiply_one(y, a + j, cols, x + j, whole);
    }
    for (size_t i = whole; i < rows; i++) {
        for (size_t k = 0; k < cols; k++)
            y[i] += a[i * cols + k] * x[k];
    }
}
