/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of the grey values of a picture in the PGM format, text (P2) or binary (P5), as a table
 * (number_table.h).
 */
#include "number_table.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct pgm_reader {
    const unsigned char *at, *end;
    char *error; /* [NUMBER_ERROR] memory of the error message of the PGM reader */
} pgm_reader;

static int fault(const pgm_reader *reader, const char *message)
{
    snprintf(reader->error, NUMBER_ERROR, "%s", message);
    return -1;
}

/*
 * Move the reading position to the next number, past blanks and past comments from # to the end of
 * a line.
 */
static void skip_blanks(pgm_reader *reader)
{
    bool is_comment = false;
    for (; reader->at < reader->end; reader->at++) {
        const unsigned char character = *reader->at;
        if (character == '#')
            is_comment = true;
        else if (character == '\n')
            is_comment = false;
        else if (!is_comment && character != ' ' && character != '\t' && character != '\r')
            return;
    }
}

/* Return the integer of at most 9 digits at the reading position, or -1 if there is no integer. */
static long read_whole(pgm_reader *reader)
{
    long value = 0;
    int digits = 0;
    skip_blanks(reader);
    for (; reader->at < reader->end && *reader->at >= '0' && *reader->at <= '9' && digits < 9;
         digits++)
        value = 10 * value + (*reader->at++ - '0');
    return digits > 0 ? value : -1;
}

/*
 * Return the next grey value, or -1 if the file ends or the value is no integer from 0 to `white`,
 * the value of white pixels.
 */
static long read_grey(pgm_reader *reader, bool is_text, long white)
{
    const long bytes = white > 255 ? 2 : 1;
    long value = -1;
    if (is_text)
        value = read_whole(reader);
    else if (reader->end - reader->at >= bytes) {
        value = reader->at[0];
        if (bytes == 2)
            value = 256 * value + reader->at[1];
        reader->at += bytes;
    }
    return value <= white ? value : -1;
}

int table_pgm_read(number_table *table, const char *bytes, size_t count, char *error)
{
    pgm_reader reader = {(const unsigned char *)bytes + 2, (const unsigned char *)bytes + count,
                         error};
    const bool is_text = bytes[1] == '2';
    const long columns = read_whole(&reader), rows = read_whole(&reader),
               white = read_whole(&reader);
    if (columns < 1 || rows < 1 || white < 1 || white > 65535)
        return fault(&reader, "the header of the picture is damaged; save it as PGM again");
    if (rows > NUMBER_VALUES / columns)
        return fault(&reader, "too many pixels; a picture of at most 8 million is read");
    if (!is_text)
        reader.at++; /* Exactly one blank separates the header of the PGM picture from its pixels.
                      */
    table->rows = (size_t)rows;
    table->columns = (size_t)columns;
    table->value = calloc(table->rows * table->columns, sizeof *table->value);
    if (!table->value)
        return fault(&reader, "the picture does not fit into memory; use fewer pixels");
    for (size_t i = 0; i < table->rows * table->columns; i++) {
        const long grey = read_grey(&reader, is_text, white);
        if (grey < 0)
            return fault(&reader, "a pixel is missing or brighter than the header says; save the "
                                  "picture as PGM again");
        table->value[i] = (double)grey;
    }
    return 0;
}
