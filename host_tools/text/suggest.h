/* SPDX-License-Identifier: BSD-2-Clause */
/* The name that a mistyped word was most likely meant to be. */
#ifndef SUGGEST_H
#define SUGGEST_H

/* SUGGEST_NAME: room for a name; longer names and words are not considered. SUGGEST_TEXT: room for
 * the suggestion. */
enum { SUGGEST_NAME = 64, SUGGEST_TEXT = SUGGEST_NAME + 32 };

typedef struct suggestion {
    const char *word;
    char nearest[SUGGEST_NAME];
    int distance; /* edits from word to nearest */
} suggestion;

/*
 * Edit distance: insertions, deletions, substitutions and exchanges of neighbours that turn one
 * word into another (optimal string alignment). Both words are shorter than SUGGEST_NAME.
 */
int suggest_distance(const char *from, const char *to);

/* Begin with a word, then consider every name that exists. */
void suggest_begin(suggestion *s, const char *word);
void suggest_consider(suggestion *s, const char *name);

/* " (did you mean 'NAME'?)", or nothing where no name is near. Returns text. */
const char *suggest_text(const suggestion *s, char text[SUGGEST_TEXT]);

#endif
