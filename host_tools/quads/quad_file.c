/* SPDX-License-Identifier: BSD-2-Clause */
/* A mesh file in memory, and the numbers in it (quad_file.h). */
#define _POSIX_C_SOURCE 200809L
#include "quad_file.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { HEAD = 4096 };

static const size_t largest_file = (size_t)1 << 31;

/* ---- messages ---------------------------------------------------------- */

static long line_of(const quad_file *file, size_t at)
{
    long line = 1;
    for (size_t i = 0; i < at && i < file->bytes; i++)
        line += file->text[i] == '\n';
    return line;
}

/* Return the name of a file without its folders. */
static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static int write_fault(const quad_file *file, size_t at, const char *format, va_list list)
{
    int length;
    if (file->is_binary)
        length = snprintf(file->error, QUAD_ERROR, "%.80s: byte %zu: ", base_name(file->path), at);
    else
        length = snprintf(file->error, QUAD_ERROR, "%.80s:%ld: ", base_name(file->path),
                          line_of(file, at));
    vsnprintf(file->error + length, (size_t)(QUAD_ERROR - length), format, list);
    for (char *character = file->error; *character; character++)
        if ((unsigned char)*character < 32 || (unsigned char)*character > 126)
            *character = '?';
    return -1;
}

int quad_fault_at(const quad_file *file, size_t at, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    write_fault(file, at, format, list);
    va_end(list);
    return -1;
}

int quad_fault(const quad_file *file, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    write_fault(file, file->at, format, list);
    va_end(list);
    return -1;
}

/* Write an error message about a mesh file as a whole. Returns -1. */
static int refuse_file(const quad_file *file, const char *why)
{
    snprintf(file->error, QUAD_ERROR, "%.80s: %.200s", base_name(file->path), why);
    return -1;
}

/* ---- opening ----------------------------------------------------------- */

/*
 * Return whether the first bytes of a file can be the beginning of a Gmsh or an Abaqus mesh file.
 */
static bool is_mesh_head(const char *head, size_t bytes)
{
    size_t i = 0;
    while (i < bytes && strchr(" \t\r\n", head[i]) && head[i])
        i++;
    if (i < bytes && head[i] == '$')
        return true;
    for (size_t k = 0; k < bytes; k++)
        if ((unsigned char)head[k] < 9)
            return false;
    return i < bytes && head[i] == '*';
}

static int read_all(quad_file *file, FILE *stream, size_t bytes)
{
    char head[HEAD];
    const size_t first = fread(head, 1, sizeof head, stream);
    if (bytes == 0)
        return refuse_file(file, "the file is empty; export the mesh again");
    if (!is_mesh_head(head, first))
        return refuse_file(file, "this is no mesh file: a Gmsh file begins with $MeshFormat, an "
                                 "Abaqus or CalculiX file with a keyword as *NODE");
    file->text = malloc(bytes + 1);
    if (!file->text)
        return refuse_file(file, "the file does not fit into memory");
    memcpy(file->text, head, first);
    file->bytes = first + fread(file->text + first, 1, bytes - first, stream);
    file->text[file->bytes] = 0;
    return 0;
}

int quad_file_open(quad_file *file, const char *path, char *error)
{
    struct stat about;
    memset(file, 0, sizeof *file);
    file->path = path;
    file->error = error;
    if (stat(path, &about) != 0)
        return refuse_file(file, strerror(errno));
    if (!S_ISREG(about.st_mode))
        return refuse_file(file, "this is no regular file; name a mesh file");
    if ((uint64_t)about.st_size > largest_file)
        return refuse_file(file, "the file has more than 2 GB; use a coarser mesh");
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return refuse_file(file, strerror(errno));
    const int status = read_all(file, stream, (size_t)about.st_size);
    fclose(stream);
    if (status < 0)
        quad_file_close(file);
    return status;
}

void quad_file_close(quad_file *file)
{
    free(file->text);
    file->text = NULL;
    file->bytes = file->at = 0;
}

uint32_t quad_file_hash(const quad_file *file)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < file->bytes; i++)
        hash = (hash ^ (unsigned char)file->text[i]) * 16777619u;
    return hash;
}

/* ---- text -------------------------------------------------------------- */

static bool is_blank(char character)
{
    return character == ' ' || character == '\t' || character == '\r' || character == '\n';
}

void quad_skip(quad_file *file)
{
    while (file->at < file->bytes && is_blank(file->text[file->at]))
        file->at++;
}

bool quad_next_line(quad_file *file)
{
    const char *end = memchr(file->text + file->at, '\n', file->bytes - file->at);
    file->at = end ? (size_t)(end - file->text) + 1 : file->bytes;
    return file->at < file->bytes;
}

bool quad_take_word(quad_file *file, const char *word)
{
    const size_t length = strlen(word);
    if (file->bytes - file->at < length || memcmp(file->text + file->at, word, length) != 0)
        return false;
    const char after = file->text[file->at + length];
    if (after && !is_blank(after))
        return false;
    file->at += length;
    return true;
}

/* ---- numbers ----------------------------------------------------------- */

static int refuse_end(const quad_file *file, const char *what)
{
    return quad_fault_at(file, file->bytes,
                         "the file ends where %s is expected; it is cut off, export it again",
                         what);
}

static int refuse_number(const quad_file *file, const char *what)
{
    const char *text = file->text + file->at;
    int length = 0;
    while (length < 20 && text[length] && !is_blank(text[length]))
        length++;
    return quad_fault(file, "'%.*s' stands where %s is expected", length, text, what);
}

/*
 * Copy the bytes of a binary number from the reading position of a mesh file. Returns 0, or -1
 * after writing an error message about the mesh file at the end of the file.
 */
static int take_bytes(quad_file *file, const char *what, void *value, size_t size)
{
    if (file->bytes - file->at < size)
        return refuse_end(file, what);
    memcpy(value, file->text + file->at, size);
    file->at += size;
    return 0;
}

/*
 * Move the reading position of a mesh file past a number in text form that ends at `end`. Returns
 * 0, or -1 after writing an error message about the mesh file if no blank, line end or end of the
 * file follows.
 */
static int take_number(quad_file *file, const char *what, const char *end)
{
    const char *text = file->text + file->at;
    if (end == text || (*end && !is_blank(*end)))
        return refuse_number(file, what);
    file->at += (size_t)(end - text);
    return 0;
}

static int text_integer(quad_file *file, const char *what, int64_t *value)
{
    char *end;
    quad_skip(file);
    if (file->at >= file->bytes)
        return refuse_end(file, what);
    errno = 0;
    *value = strtoll(file->text + file->at, &end, 10);
    if (errno)
        return refuse_number(file, what);
    return take_number(file, what, end);
}

int quad_read_int(quad_file *file, const char *what, int *value)
{
    int64_t wide;
    if (file->is_binary)
        return take_bytes(file, what, value, sizeof *value);
    const size_t at = file->at;
    if (text_integer(file, what, &wide) < 0)
        return -1;
    if (wide < INT32_MIN || wide > INT32_MAX)
        return quad_fault_at(file, at, "%s is out of range: %lld", what, (long long)wide);
    *value = (int)wide;
    return 0;
}

int quad_read_size(quad_file *file, const char *what, int64_t *value)
{
    uint64_t size = 0;
    if (!file->is_binary)
        return text_integer(file, what, value);
    if (take_bytes(file, what, &size, sizeof size) < 0)
        return -1;
    if (size > INT64_MAX)
        return quad_fault_at(file, file->at - sizeof size, "%s is out of range: %llu", what,
                             (unsigned long long)size);
    *value = (int64_t)size;
    return 0;
}

int quad_read_real(quad_file *file, const char *what, double *value)
{
    char *end;
    if (file->is_binary)
        return take_bytes(file, what, value, sizeof *value);
    quad_skip(file);
    if (file->at >= file->bytes)
        return refuse_end(file, what);
    *value = strtod(file->text + file->at, &end);
    return take_number(file, what, end);
}

int quad_check_count(const quad_file *file, const char *what, int64_t count, size_t bytes)
{
    const size_t rest = file->bytes - file->at;
    if (count >= 0 && (uint64_t)count <= rest / bytes)
        return 0;
    return quad_fault(file,
                      "%lld %s are announced, but only %zu bytes follow; the file is cut off, "
                      "damaged, or of another byte order",
                      (long long)count, what, rest);
}
