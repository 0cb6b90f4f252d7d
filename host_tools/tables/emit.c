/*
 * Arrays of generated C tables (emit.h). Numbers have 17 significant digits and are rounded once,
 * by the device's compiler, to its own real; the checksum is therefore given for both precisions.
 */
#include "emit.h"
#include <math.h>
#include "../../lib/core/guard.h"

/* ---- checksums -------------------------------------------------------- */

uint32_t emit_crc_reals(uint32_t crc, const double *x, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const float rounded = (float)x[i];
        crc = pzs_guard_crc(crc, &rounded, sizeof rounded);
    }
    return crc;
}

/* ---- arrays ----------------------------------------------------------- */

void emit_count_reals(emitter *w, const double *x, size_t n)
{
    w->crc32 = emit_crc_reals(w->crc32, x, n);
    w->reals += n;
}

void emit_count_bytes(emitter *w, const void *x, size_t bytes)
{
    w->crc32 = pzs_guard_crc(w->crc32, x, bytes);
    w->bytes += bytes;
}

void emit_real(FILE *file, double x)
{
    if (isinf(x))
        fprintf(file, "%sHUGE_VAL", x < 0 ? "-" : "");
    else if (x == 0 && signbit(x)) /* -0 would be the integer 0 */
        fputs("-0.0", file);
    else
        fprintf(file, "%.17g", x);
}

/* Values of an initialiser, `columns` a line. */
static void list_reals(FILE *file, const double *x, size_t n, size_t columns)
{
    for (size_t i = 0; i < n; i++) {
        fputs(i % columns == 0 ? "\n    PZS_R(" : " PZS_R(", file);
        emit_real(file, x[i]);
        fputs("),", file);
    }
}

void emit_reals(emitter *w, const char *name, const double *x, size_t n, const char *meaning)
{
    fprintf(w->file, "/* %s */\nstatic const pzs_real %s_%s[%zu] = {", meaning, w->prefix, name,
            n ? n : 1);
    list_reals(w->file, x, n, 4);
    fputs(n ? "\n};\n" : "0};\n", w->file);
    emit_count_reals(w, x, n);
}

/* Largest float not above x, or not below it. */
static double float_inside(double x, int upper)
{
    const float nearest = (float)x;
    const int outside = upper ? (double)nearest > x : (double)nearest < x;
    return (double)(outside ? nextafterf(nearest, upper ? -HUGE_VALF : HUGE_VALF) : nearest);
}

void emit_limits(emitter *w, const char *name, const double *x, size_t n, int upper,
                 const char *meaning)
{
    fprintf(w->file, "/* %s */\nstatic const pzs_real %s_%s[%zu] = {", meaning, w->prefix, name, n);
    for (size_t i = 0; i < n; i++) {
        const double inside = float_inside(x[i], upper);
        fputs(i % 4 == 0 ? "\n    PZS_R(" : " PZS_R(", w->file);
        if (inside < x[i] || inside > x[i])
            fprintf(w->file, "PZS_BY_BITS(%.17g, %.17g)", inside, x[i]);
        else
            emit_real(w->file, x[i]);
        fputs("),", w->file);
        emit_count_reals(w, &inside, 1);
    }
    fputs("\n};\n", w->file);
}

void emit_shorts(emitter *w, const char *name, const uint16_t *x, size_t n, const char *meaning)
{
    fprintf(w->file, "/* %s */\nstatic const uint16_t %s_%s[%zu] = {", meaning, w->prefix, name,
            n ? n : 1);
    for (size_t i = 0; i < n; i++)
        fprintf(w->file, "%s%u,", i % 16 == 0 ? "\n    " : " ", x[i]);
    fputs(n ? "\n};\n" : "0};\n", w->file);
    emit_count_bytes(w, x, n * sizeof *x);
}

void emit_longs(emitter *w, const char *name, const uint32_t *x, size_t n)
{
    fprintf(w->file, "static const uint32_t %s_%s[%zu] = {", w->prefix, name, n ? n : 1);
    for (size_t i = 0; i < n; i++)
        fprintf(w->file, "%s%uu,", i % 12 == 0 ? "\n    " : " ", (unsigned)x[i]);
    fputs(n ? "\n};\n" : "0};\n", w->file);
    emit_count_bytes(w, x, n * sizeof *x);
}

void emit_begin(const emitter *w, const char *type, const char *name, uint32_t scene, uint32_t crc)
{
    fprintf(w->file,
            "static const pzs_%s %s_%s = {\n    %uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu),", type,
            w->prefix, name, PZS_TABLE_FORMAT, (unsigned)scene, (unsigned)~w->crc32, (unsigned)crc);
}

const double *emit_nested(FILE *file, const double *x, const int *length, int depth)
{
    fputs("{", file);
    for (int i = 0; i < length[0]; i++) {
        if (depth > 1) {
            x = emit_nested(file, x, length + 1, depth - 1);
        } else {
            fputs("PZS_R(", file);
            emit_real(file, *x++);
            fputs(")", file);
        }
        fputs(i + 1 < length[0] ? depth > 2 ? ",\n     " : ", " : "", file);
    }
    fputs("}", file);
    return x;
}

void emit_blocks(emitter *w, const char *name, const double *x, size_t n, const int *length,
                 int depth, const char *meaning)
{
    size_t size = 1;
    fprintf(w->file, "/* %s */\nstatic const pzs_real %s_%s[%zu]", meaning, w->prefix, name, n);
    for (int i = 0; i < depth; i++) {
        fprintf(w->file, "[%d]", length[i]);
        size *= (size_t)length[i];
    }
    fputs(" = {", w->file);
    for (size_t i = 0; i < n; i++) {
        fputs("\n    ", w->file);
        emit_nested(w->file, x + i * size, length, depth);
        fputs(",", w->file);
    }
    fputs("\n};\n", w->file);
    emit_count_reals(w, x, n * size);
}

void emit_vector(emitter *w, const double x[3])
{
    const int length = 3;
    emit_nested(w->file, x, &length, 1);
}
