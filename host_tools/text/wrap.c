/* SPDX-License-Identifier: BSD-2-Clause */
/* Printing of paragraphs with line breaks (wrap.h). */
#include "wrap.h"

enum { COLUMNS = 100 };

/*
 * Return the length of the longest beginning of a text that ends with a whole word and has at most
 * `room` characters. If the first word alone is longer, its length is returned.
 */
static int line_length(const char *text, int room)
{
    int end = 0;
    for (int i = 0; i == 0 || text[i - 1]; i++)
        if ((text[i] == ' ' || !text[i]) && (i <= room || end == 0))
            end = i;
    return end;
}

void wrap_print(FILE *file, const char *text, int at, int indent)
{
    while (*text) {
        const int length = line_length(text, COLUMNS - at);
        fprintf(file, "%.*s\n", length, text);
        text += length;
        text += *text == ' ';
        if (*text)
            fprintf(file, "%*s", indent, "");
        at = indent;
    }
}
