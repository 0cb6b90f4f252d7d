/* SPDX-License-Identifier: BSD-2-Clause */
/* Search for the name that is most similar to a mistyped word. */
#ifndef SUGGEST_H
#define SUGGEST_H

/*
 * SUGGEST_NAME: size of a name (characters); longer names and words are ignored. SUGGEST_TEXT: size
 * of the text of a suggestion (characters).
 */
enum { SUGGEST_NAME = 64, SUGGEST_TEXT = SUGGEST_NAME + 32 };

typedef struct suggestion {
    const char *word;
    char nearest[SUGGEST_NAME];
    int distance; /* edit distance between word and nearest */
} suggestion;

/*
 * Edit distance: least number of insertions, deletions, substitutions and exchanges of neighbours
 * that turn one word into another (optimal string alignment). Both words must be shorter than
 * SUGGEST_NAME.
 */
int suggest_distance(const char *from, const char *to);

/* Start with a mistyped word, then compare every existing name with the word. */
void suggest_begin(suggestion *suggestion, const char *word);
void suggest_consider(suggestion *suggestion, const char *name);

/* Write " (did you mean 'NAME'?)", or an empty text where no name is similar. Returns text. */
const char *suggest_text(const suggestion *suggestion, char text[SUGGEST_TEXT]);

#endif
