/* SPDX-License-Identifier: BSD-2-Clause */
/* Suggestions for mistyped words (suggest.h). */
#include "suggest.h"
#include <stdio.h>
#include <string.h>

static int least(int first, int second)
{
    return first < second ? first : second;
}

int suggest_distance(const char *from, const char *to)
{
    int row[3][SUGGEST_NAME + 1]; /* rows i - 2, i - 1 and i of the table of edit distances between
                                     the beginnings of two words; row i is stored at i modulo 3 */
    const int rows = (int)strlen(from), columns = (int)strlen(to);
    for (int j = 0; j <= columns; j++)
        row[0][j] = j;
    for (int i = 1; i <= rows; i++) {
        int *const now = row[i % 3];
        const int *const before = row[(i + 2) % 3], *const earlier = row[(i + 1) % 3];
        now[0] = i;
        for (int j = 1; j <= columns; j++) {
            now[j] = least(before[j], now[j - 1]) + 1;
            now[j] = least(now[j], before[j - 1] + (from[i - 1] != to[j - 1]));
            if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1])
                now[j] = least(now[j], earlier[j - 2] + 1);
        }
    }
    return row[rows % 3][columns];
}

void suggest_begin(suggestion *suggestion, const char *word)
{
    suggestion->word = word;
    suggestion->nearest[0] = '\0';
    suggestion->distance = 0;
}

/*
 * Compare a name with the mistyped word. A name is suggested only if its edit distance is at most a
 * third of the letters of the word.
 */
void suggest_consider(suggestion *suggestion, const char *name)
{
    const size_t length = strlen(suggestion->word);
    if (length >= SUGGEST_NAME || strlen(name) >= SUGGEST_NAME)
        return;
    const int distance = suggest_distance(suggestion->word, name);
    const int allowed = (int)(length + 2) / 3;
    if (distance > allowed || (suggestion->nearest[0] && distance >= suggestion->distance))
        return;
    suggestion->distance = distance;
    strcpy(suggestion->nearest, name);
}

const char *suggest_text(const suggestion *suggestion, char text[SUGGEST_TEXT])
{
    text[0] = '\0';
    if (suggestion->nearest[0])
        snprintf(text, SUGGEST_TEXT, " (did you mean '%s'?)", suggestion->nearest);
    return text;
}
