/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Output files that are whole or not there: written under a temporary name beside their own,
 * renamed at the end, removed when a step fails or a signal ends the program.
 */
#ifndef OUTFILE_H
#define OUTFILE_H

#include <stdio.h>

enum { OUTFILE_PATH = 4096 };

typedef struct outfile {
    FILE *file;
    const char *path;
    char temporary[OUTFILE_PATH]; /* empty where the path is a device or a pipe, which is written to
                                     directly */
    int slot;                     /* of interrupt.h */
} outfile;

/* Each returns 0, or 1 after saying on standard error what is wrong. path must outlive f. */
int outfile_begin(outfile *f, const char *path);

/* Give the file its name; failed: its contents are not whole, remove it. */
int outfile_end(outfile *f, int failed);

/* Remove a file whose contents never came together, without a word. */
void outfile_drop(outfile *f);

#endif
