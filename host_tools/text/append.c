/* SPDX-License-Identifier: BSD-2-Clause */
/* Texts that are put together piece by piece (append.h). */
#include "append.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void text_append(char *text, size_t room, const char *format, ...)
{
    const size_t length = strlen(text);
    va_list values;
    va_start(values, format);
    vsnprintf(text + length, room - length, format, values);
    va_end(values);
}
