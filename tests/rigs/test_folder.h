/*
 * A folder of its own for the files that a test program writes. Include it after cmocka.h, in a
 * program that defines _XOPEN_SOURCE 700.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef TEST_FOLDER_H
#define TEST_FOLDER_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static char test_folder[] = "/tmp/pzs-test-XXXXXX";

/* Group set-up: make the folder. */
static inline int make_test_folder(void **state)
{
    (void)state;
    return mkdtemp(test_folder) ? 0 : -1;
}

/* Path of a file in the folder, which stays until the call after the next. */
static inline const char *path_of(const char *name)
{
    static char path[2][sizeof test_folder + 256];
    static int which;
    which = !which;
    snprintf(path[which], sizeof path[which], "%s/%s", test_folder, name);
    return path[which];
}

/* Open a file of the folder for writing. */
static inline FILE *write_file(const char *name)
{
    FILE *file = fopen(path_of(name), "wb");
    assert_non_null(file);
    return file;
}

/* Write a file of the folder, with a text as for printf. */
static inline void write_text(const char *name, const char *format, ...)
{
    FILE *file = write_file(name);
    va_list list;
    va_start(list, format);
    vfprintf(file, format, list);
    va_end(list);
    assert_int_equal(fclose(file), 0);
}

/* Group tear-down: remove the folder with its files. */
static inline int remove_test_folder(void **state)
{
    DIR *folder = opendir(test_folder);
    (void)state;
    for (struct dirent *entry = folder ? readdir(folder) : NULL; entry; entry = readdir(folder))
        (void)unlink(path_of(entry->d_name));
    return folder && closedir(folder) == 0 ? rmdir(test_folder) : -1;
}

#endif
