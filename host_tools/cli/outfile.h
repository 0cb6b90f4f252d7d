/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Output files that are either complete or absent. A file is written under a temporary name in its
 * final folder and renamed at the end; the file is removed when a step fails or a signal ends the
 * program.
 */
#ifndef OUTFILE_H
#define OUTFILE_H

#include <stdio.h>

enum { OUTFILE_PATH = 4096 };

typedef struct outfile {
    FILE *file;
    const char *path;
    char temporary[OUTFILE_PATH]; /* temporary name; empty for a device or a pipe, which is written
                                     directly */
    int slot;                     /* slot of the temporary file in interrupt.h */
} outfile;

/*
 * Open a file for writing. Returns 0, or 1 after printing an error message on standard error. path
 * must outlive f.
 */
int outfile_begin(outfile *output, const char *path);

/*
 * Close a file and give it its final name; with failed set, remove the incomplete file. Returns 0,
 * or 1 after printing an error message on standard error.
 */
int outfile_end(outfile *output, int failed);

/* Remove an incomplete file without a message. */
void outfile_drop(outfile *output);

#endif
