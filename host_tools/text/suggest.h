/* SPDX-License-Identifier: BSD-2-Clause */
/* Search for the name that is most similar to a mistyped word. */
#ifndef SUGGEST_H
#define SUGGEST_H

/*
 * Sizes in characters: a name (SUGGEST_NAME), where longer names and words are ignored, and the
 * text of a suggestion (SUGGEST_TEXT).
 */
enum { SUGGEST_NAME = 64, SUGGEST_TEXT = SUGGEST_NAME + 32 };

typedef struct suggestion {
    const char *word;
    char nearest[SUGGEST_NAME];
    int distance; /* edit distance between the mistyped word and the nearest name */
} suggestion;

/*
 * Return the edit distance of two words: the least number of insertions, deletions, substitutions
 * and exchanges of neighbouring letters that turn one into the other (optimal string alignment).
 * Both words must be shorter than SUGGEST_NAME.
 */
int suggest_distance(const char *from, const char *to);

/*
 * Start the search for the name that is nearest to a mistyped word; suggest_consider then compares
 * one existing name with the word.
 */
void suggest_begin(suggestion *suggestion, const char *word);
void suggest_consider(suggestion *suggestion, const char *name);

/*
 * Write the text " (did you mean 'NAME'?)" with the most similar name, or an empty text if no name
 * is similar. Returns `text`.
 */
const char *suggest_text(const suggestion *suggestion, char text[SUGGEST_TEXT]);

#endif
