/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Output files that are either complete or absent. A file is written under a temporary name in its
 * final folder and renamed at the end; the temporary file is removed when a step fails or a signal
 * ends the program.
 */
#ifndef OUTFILE_H
#define OUTFILE_H

#include <stdio.h>

enum { OUTFILE_PATH = 4096 };

typedef struct outfile {
    FILE *file;
    const char *path;
    char temporary[OUTFILE_PATH]; /* path of the temporary file; empty for a device, a pipe or
                                     standard output, which are written directly */
    int slot; /* index of the temporary file in the list of files that interrupt.h removes after a
                 signal */
} outfile;

/*
 * Keep standard output for the output file "-". All that the program prints otherwise on standard
 * output goes to standard error from now on. Returns 0, or 1 after printing an error message.
 */
int outfile_take_stdout(void);

/*
 * Check, before a long computation, that an output file can be begun: its folder exists and may be
 * written to. The path may also be a folder for the file, a device or a pipe. Returns 0, or 1 after
 * printing an error message on standard error.
 */
int outfile_check(const char *path);

/*
 * Open an output file for writing. The path "-" stands for standard output; the caller must then
 * have called outfile_take_stdout, which keeps standard output free of other text. The path must
 * outlive `output`. Returns 0, or 1 after printing an error message on standard error.
 */
int outfile_begin(outfile *output, const char *path);

/*
 * Close an output file and give the file its final name; where `failed` is set, remove the
 * incomplete file. Returns 0, or 1 after printing an error message on standard error.
 */
int outfile_end(outfile *output, int failed);

/* Remove an incomplete output file without a message. */
void outfile_drop(outfile *output);

#endif
