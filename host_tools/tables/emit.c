/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Arrays of generated C tables (emit.h). Numbers have 17 significant digits and are rounded once,
 * by the device's compiler, to the pzs_real of the device; a table therefore has one checksum for
 * each precision.
 */
#include "emit.h"
#include <math.h>
#include <stdarg.h>
#include "../../lib/core/guard.h"

/* ---- checksums of tables ---------------------------------------------- */

uint32_t emit_crc_reals(uint32_t crc, const double *value, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const float rounded = (float)value[i];
        crc = pzs_guard_crc(crc, &rounded, sizeof rounded);
    }
    return crc;
}

/* ---- comments in generated tables ------------------------------------- */

/*
 * Write a text into a C comment. A blank is inserted wherever the text contains the two characters
 * that begin or end a comment.
 */
static void write_text(FILE *file, const char *text)
{
    for (char before = ' '; *text; before = *text++) {
        if ((before == '*' && *text == '/') || (before == '/' && *text == '*'))
            fputc(' ', file);
        fprintf(file, *text == '\n' ? "\n * " : "%c", *text);
    }
}

void emit_comment_begin(const emitter *emitter)
{
    fprintf(emitter->file, "%c*\n", '/');
}

void emit_comment_end(const emitter *emitter)
{
    fprintf(emitter->file, " *%c\n", '/');
}

void emit_comment_lines(const emitter *emitter, const char *text)
{
    if (!text[0])
        return;
    fputs(" * ", emitter->file);
    write_text(emitter->file, text);
    fputc('\n', emitter->file);
}

void emit_comment(const emitter *emitter, const char *format, ...)
{
    char text[240];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fprintf(emitter->file, "%c* ", '/');
    write_text(emitter->file, text);
    emit_comment_end(emitter);
}

/* ---- arrays in generated tables --------------------------------------- */

void emit_count_reals(emitter *emitter, const double *value, size_t count)
{
    emitter->crc32 = emit_crc_reals(emitter->crc32, value, count);
    emitter->reals += count;
}

void emit_count_bytes(emitter *emitter, const void *value, size_t bytes)
{
    emitter->crc32 = pzs_guard_crc(emitter->crc32, value, bytes);
    emitter->bytes += bytes;
}

void emit_real(FILE *file, double value)
{
    if (isinf(value))
        fprintf(file, "%sHUGE_VAL", value < 0 ? "-" : "");
    else if (value == 0 && signbit(value)) /* Without a decimal point, -0 would be the integer 0 in
                                              C. */
        fputs("-0.0", file);
    else
        fprintf(file, "%.17g", value);
}

/* Write the values of a C array initialiser, `columns` of them in each line. */
static void list_reals(FILE *file, const double *value, size_t count, size_t columns)
{
    for (size_t i = 0; i < count; i++) {
        fputs(i % columns == 0 ? "\n    PZS_R(" : " PZS_R(", file);
        emit_real(file, value[i]);
        fputs("),", file);
    }
}

void emit_reals(emitter *emitter, const char *name, const double *value, size_t count,
                const char *meaning)
{
    emit_comment(emitter, "%s", meaning);
    fprintf(emitter->file, "static const pzs_real %s_%s[%zu] = {", emitter->prefix, name,
            count ? count : 1);
    list_reals(emitter->file, value, count, 4);
    fputs(count ? "\n};\n" : "0};\n", emitter->file);
    emit_count_reals(emitter, value, count);
}

/*
 * Round a limit inwards to single precision: the largest float that is not above an upper limit, or
 * the smallest float that is not below a lower limit.
 */
static double float_inside(double value, int upper)
{
    const float nearest = (float)value;
    const float inwards = upper ? -HUGE_VALF : HUGE_VALF;
    const int outside = upper ? (double)nearest > value : (double)nearest < value;
    return (double)(outside ? nextafterf(nearest, inwards) : nearest);
}

/*
 * Begin the definition of an array of reals, preceded by a comment with the meaning of the array.
 */
static void begin_reals(const emitter *emitter, const char *name, size_t count, const char *meaning)
{
    emit_comment(emitter, "%s", meaning);
    fprintf(emitter->file, "static const pzs_real %s_%s[%zu] = {", emitter->prefix, name, count);
}

/*
 * Write the entry with index i of an array of reals, whose values in single and in double precision
 * may differ; the compiler of the device chooses one of the two values.
 */
static void list_by_bits(emitter *emitter, size_t i, double single, double value)
{
    fputs(i % 4 == 0 ? "\n    PZS_R(" : " PZS_R(", emitter->file);
    if (single < value || single > value)
        fprintf(emitter->file, "PZS_BY_BITS(%.17g, %.17g)", single, value);
    else
        emit_real(emitter->file, value);
    fputs("),", emitter->file);
    emit_count_reals(emitter, &single, 1);
}

void emit_limits(emitter *emitter, const char *name, const double *value, size_t count, int upper,
                 const char *meaning)
{
    begin_reals(emitter, name, count, meaning);
    for (size_t i = 0; i < count; i++)
        list_by_bits(emitter, i, float_inside(value[i], upper), value[i]);
    fputs("\n};\n", emitter->file);
}

void emit_inside(emitter *emitter, const char *name, const double *value, const double *lower,
                 const double *upper, size_t count, const char *meaning)
{
    begin_reals(emitter, name, count, meaning);
    for (size_t i = 0; i < count; i++) {
        const double least = float_inside(lower[i], 0), most = float_inside(upper[i], 1);
        list_by_bits(emitter, i, fmin(fmax((double)(float)value[i], least), most), value[i]);
    }
    fputs("\n};\n", emitter->file);
}

void emit_shorts(emitter *emitter, const char *name, const uint16_t *value, size_t count,
                 const char *meaning)
{
    emit_comment(emitter, "%s", meaning);
    fprintf(emitter->file, "static const uint16_t %s_%s[%zu] = {", emitter->prefix, name,
            count ? count : 1);
    for (size_t i = 0; i < count; i++)
        fprintf(emitter->file, "%s%u,", i % 16 == 0 ? "\n    " : " ", value[i]);
    fputs(count ? "\n};\n" : "0};\n", emitter->file);
    emit_count_bytes(emitter, value, count * sizeof *value);
}

void emit_bytes(emitter *emitter, const char *name, const uint8_t *value, size_t count,
                const char *meaning)
{
    emit_comment(emitter, "%s", meaning);
    fprintf(emitter->file, "static const uint8_t %s_%s[%zu] = {", emitter->prefix, name,
            count ? count : 1);
    for (size_t i = 0; i < count; i++)
        fprintf(emitter->file, "%s%u,", i % 16 == 0 ? "\n    " : " ", value[i]);
    fputs(count ? "\n};\n" : "0};\n", emitter->file);
    emit_count_bytes(emitter, value, count);
}

void emit_longs(emitter *emitter, const char *name, const uint32_t *value, size_t count)
{
    fprintf(emitter->file, "static const uint32_t %s_%s[%zu] = {", emitter->prefix, name,
            count ? count : 1);
    for (size_t i = 0; i < count; i++)
        fprintf(emitter->file, "%s%uu,", i % 12 == 0 ? "\n    " : " ", (unsigned)value[i]);
    fputs(count ? "\n};\n" : "0};\n", emitter->file);
    emit_count_bytes(emitter, value, count * sizeof *value);
}

void emit_begin(const emitter *emitter, const char *type, const char *name, uint32_t scene,
                uint32_t crc)
{
    fprintf(emitter->file,
            "static const pzs_%s %s_%s = {\n    %uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu),", type,
            emitter->prefix, name, PZS_TABLE_FORMAT, (unsigned)scene, (unsigned)~emitter->crc32,
            (unsigned)crc);
}

const double *emit_nested(FILE *file, const double *value, const int *length, int depth)
{
    fputs("{", file);
    for (int i = 0; i < length[0]; i++) {
        if (depth > 1) {
            value = emit_nested(file, value, length + 1, depth - 1);
        } else {
            fputs("PZS_R(", file);
            emit_real(file, *value++);
            fputs(")", file);
        }
        if (i + 1 < length[0])
            fputs(depth > 2 ? ",\n     " : ", ", file);
    }
    fputs("}", file);
    return value;
}

void emit_blocks(emitter *emitter, const char *name, const double *value, size_t count,
                 const int *length, int depth, const char *meaning)
{
    size_t size = 1;
    emit_comment(emitter, "%s", meaning);
    fprintf(emitter->file, "static const pzs_real %s_%s[%zu]", emitter->prefix, name, count);
    for (int i = 0; i < depth; i++) {
        fprintf(emitter->file, "[%d]", length[i]);
        size *= (size_t)length[i];
    }
    fputs(" = {", emitter->file);
    for (size_t i = 0; i < count; i++) {
        fputs("\n    ", emitter->file);
        emit_nested(emitter->file, value + i * size, length, depth);
        fputs(",", emitter->file);
    }
    fputs("\n};\n", emitter->file);
    emit_count_reals(emitter, value, count * size);
}

void emit_vector(emitter *emitter, const double value[3])
{
    const int length = 3;
    emit_nested(emitter->file, value, &length, 1);
}
