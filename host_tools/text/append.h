/* SPDX-License-Identifier: BSD-2-Clause */
/* Texts that are put together piece by piece. */
#ifndef APPEND_H
#define APPEND_H

#include <stddef.h>

/*
 * Append a formatted text to a text in a buffer of `room` characters, including its NUL; what does
 * not fit is cut off.
 */
void text_append(char *text, size_t room, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
