/* SPDX-License-Identifier: BSD-2-Clause */
/* Reading of tables of numbers in text form (number_table.h). */
#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "number_table.h"

/* Cell in a line of a text table, without the blanks and quotes around it. */
typedef struct cell {
    const char *text;
    size_t length;
} cell;

typedef struct text_reader {
    number_table *table;
    const char *at, *end; /* next byte of the text table to be read, and the end of the text */
    char delimiter; /* delimiter between the cells of the text table: ',', ';' or a tab, or ' ' for
                       any number of blanks */
    cell comment; /* text of the last comment line of the table, which begins with #, without the #
                   */
    unsigned long line; /* number of the line of the table file whose cells are in `cell`, counted
                           from 1 */
    unsigned long first_line; /* number, from 1, of the first line of the table file that holds
                                 values */
    cell *cell;               /* [cells] cells of the present line of the text table */
    size_t cells, room_cells, room_rows;
    char *error;
} text_reader;

static int fault(const text_reader *reader, const char *message)
{
    snprintf(reader->error, NUMBER_ERROR, "%lu: %.170s", reader->line, message);
    return -1;
}

static bool is_blank(char character)
{
    return character == ' ' || character == '\t';
}

/* ---- cells ------------------------------------------------------------ */

static cell trimmed(const char *from, const char *to)
{
    while (from < to && is_blank(*from))
        from++;
    while (to > from && is_blank(to[-1]))
        to--;
    if (to - from >= 2 && *from == '"' && to[-1] == '"') {
        from++;
        to--;
    }
    return (cell){from, (size_t)(to - from)};
}

static int add_cell(text_reader *reader, const char *from, const char *to)
{
    if (reader->cells == reader->room_cells) {
        const size_t room = 2 * reader->room_cells + 64;
        cell *more = realloc(reader->cell, room * sizeof *more);
        if (!more)
            return fault(reader, "out of memory");
        reader->cell = more;
        reader->room_cells = room;
    }
    reader->cell[reader->cells++] = trimmed(from, to);
    return 0;
}

/*
 * Return the end of a cell in a line of a text table whose cells are separated by blanks. A unit in
 * brackets after a name, as in "x [mm]", belongs to the cell of the name.
 */
static const char *end_between_blanks(const char *from, const char *to)
{
    const char *stop = from;
    while (stop < to && !is_blank(*stop))
        stop++;
    const char *unit = stop;
    while (unit < to && is_blank(*unit))
        unit++;
    if (unit == to || (*unit != '[' && *unit != '('))
        return stop;
    while (unit < to && *unit != ']' && *unit != ')')
        unit++;
    return unit < to ? unit + 1 : stop;
}

static const char *end_of_cell(const text_reader *reader, const char *from, const char *to)
{
    if (reader->delimiter == ' ')
        return end_between_blanks(from, to);
    const char *stop = memchr(from, reader->delimiter, (size_t)(to - from));
    return stop ? stop : to;
}

/* Split the text of a line into the cells of a table. Returns 0, or -1 with error filled. */
static int split(text_reader *reader, const char *from, const char *to)
{
    reader->cells = 0;
    while (from < to) {
        const char *stop = end_of_cell(reader, from, to);
        if (add_cell(reader, from, stop) < 0)
            return -1;
        from = stop < to ? stop + 1 : to;
        while (reader->delimiter == ' ' && from < to && is_blank(*from))
            from++;
        if (from == to && stop < to && reader->delimiter != ' ')
            return add_cell(reader, to, to); /* Behind the last delimiter of a line of the text
                                                table there is an empty cell. */
    }
    return 0;
}

/*
 * Return the delimiter between the cells of a line of the text table: the first of semicolon, comma
 * and tab that occurs in it, or else a blank.
 */
static char delimiter_of(const char *from, const char *to)
{
    static const char known[] = ";,\t";
    for (const char *candidate = known; *candidate; candidate++)
        if (memchr(from, *candidate, (size_t)(to - from)))
            return *candidate;
    return ' ';
}

/* ---- lines ------------------------------------------------------------ */

/* Return whether a line contains a byte that does not occur in a text file. */
static bool is_binary(const char *from, const char *to)
{
    for (; from < to; from++)
        if ((unsigned char)*from < 32 && !is_blank(*from))
            return true;
    return false;
}

/*
 * Return the end of the present line, at the character that ends it or at the end of the text, and
 * move the reader to the next line. A line ends with LF, CR LF, or CR alone.
 */
static const char *end_of_line(text_reader *reader)
{
    const char *to = reader->at;
    while (to < reader->end && *to != '\n' && *to != '\r')
        to++;
    const bool is_pair = reader->end - to >= 2 && to[0] == '\r' && to[1] == '\n';
    reader->at = to < reader->end ? to + 1 + is_pair : to;
    return to;
}

/*
 * Find the next line of the text table that has cells. Returns 1 with the cells filled, 0 at the
 * end of the file, or -1 with error filled.
 */
static int next_line(text_reader *reader)
{
    while (reader->at < reader->end) {
        const char *from = reader->at;
        const char *to = end_of_line(reader);
        reader->line++;
        const cell all = trimmed(from, to);
        if (is_binary(from, to))
            return fault(reader, "binary data, not a table; give a text file or a .npy file");
        if (all.length > 0 && *all.text == '#')
            reader->comment = trimmed(all.text + 1, all.text + all.length);
        if (all.length == 0 || *all.text == '#')
            continue;
        if (reader->delimiter == 0)
            reader->delimiter = delimiter_of(all.text, all.text + all.length);
        if (reader->delimiter == ' ')
            return split(reader, all.text, all.text + all.length) < 0 ? -1 : 1;
        return split(reader, from, to) < 0 ? -1 : 1;
    }
    return 0;
}

/* ---- numbers ---------------------------------------------------------- */

/*
 * Return whether a cell of a text table is a number, and store the number in *value; nan and inf
 * are numbers.
 */
static bool is_number(const cell *cell, double *value)
{
    char text[64], *end;
    if (cell->length == 0 || cell->length >= sizeof text)
        return false;
    memcpy(text, cell->text, cell->length);
    text[cell->length] = '\0';
    if (strpbrk(text, "xXpP("))
        return false;
    *value = strtod(text, &end);
    return *end == '\0';
}

/*
 * Return whether a line of the text table contains names: none of its cells is a number or empty.
 * The first cell may be empty, as the corner above the names of the rows; so may the last cell,
 * where a delimiter ends the line.
 */
static bool holds_names(const text_reader *reader)
{
    double value;
    for (size_t k = 0; k < reader->cells; k++) {
        const bool is_inside = k > 0 && k + 1 < reader->cells;
        if (is_number(&reader->cell[k], &value) || (is_inside && reader->cell[k].length == 0))
            return false;
    }
    return reader->cells > 1 || reader->cell[0].length > 0;
}

static void keep_name(const cell *cell, char *name)
{
    const size_t length = cell->length < NUMBER_NAME ? cell->length : NUMBER_NAME - 1;
    memcpy(name, cell->text, length);
    name[length] = '\0';
}

/*
 * Take the cells (entries between delimiters) of the present line of the text table as the names of
 * the columns. Returns 0, or -1 with error filled.
 */
static int keep_column_names(text_reader *reader)
{
    number_table *table = reader->table;
    table->column_name = calloc(reader->cells + 1, sizeof *table->column_name);
    if (!table->column_name)
        return fault(reader, "out of memory");
    for (size_t k = 0; k < reader->cells; k++)
        keep_name(&reader->cell[k], table->column_name[k]);
    return 0;
}

/* ---- rows ------------------------------------------------------------- */

/* Make room for one more row of a table. Returns 0, or -1 with error filled. */
static int grow(text_reader *reader, bool has_row_names)
{
    number_table *table = reader->table;
    if (table->rows < reader->room_rows)
        return 0;
    const size_t room = 2 * reader->room_rows + 64;
    double *value = realloc(table->value, room * table->columns * sizeof *value);
    table->value = value ? value : table->value;
    uint32_t *line = realloc(table->line, room * sizeof *line);
    table->line = line ? line : table->line;
    number_name *name = has_row_names ? realloc(table->row_name, room * sizeof *name) : NULL;
    table->row_name = name ? name : table->row_name;
    if (!value || !line || (has_row_names && !name))
        return fault(reader, "out of memory");
    reader->room_rows = room;
    return 0;
}

/* Return whether a cell of a text table is a number with a decimal comma. */
static bool has_decimal_comma(const cell *found)
{
    char text[64];
    double value;
    const char *comma = memchr(found->text, ',', found->length);
    if (!comma || found->length >= sizeof text)
        return false;
    memcpy(text, found->text, found->length);
    text[comma - found->text] = '.';
    const cell with_point = {text, found->length};
    return is_number(&with_point, &value);
}

/*
 * Check that the present line of the text table has as many cells as the first line. Returns 0, or
 * -1 with error filled.
 */
static int check_length(const text_reader *reader, size_t cells)
{
    char message[NUMBER_ERROR];
    bool has_commas = reader->delimiter == ',';
    if (reader->cells == cells)
        return 0;
    for (size_t k = 0; k < reader->cells; k++)
        has_commas |= has_decimal_comma(&reader->cell[k]);
    snprintf(message, sizeof message,
             "%lu values where line %lu has %lu; a value or a delimiter is missing or too many%s",
             (unsigned long)reader->cells, reader->first_line, (unsigned long)cells,
             has_commas ? " in one of the two; for decimals write a point, no comma" : "");
    return fault(reader, message);
}

static int check_cell(const text_reader *reader, size_t k)
{
    char message[NUMBER_ERROR], name[NUMBER_NAME];
    const cell *cell = &reader->cell[k];
    keep_name(cell, name);
    name[30] = '\0';
    if (cell->length == 0)
        snprintf(message, sizeof message, "value %lu is empty; write a number, or nan%s",
                 (unsigned long)k + 1,
                 k > 0 && k + 1 == reader->cells
                     ? ", or remove the delimiter at the end of the line"
                     : "");
    else if (strchr(name, ',') && reader->delimiter != ',')
        snprintf(message, sizeof message,
                 "value %lu, '%s', has a comma; write a point for decimals", (unsigned long)k + 1,
                 name);
    else
        snprintf(message, sizeof message,
                 "value %lu, '%s', is not a number; write numbers between commas, semicolons, "
                 "tabs or blanks",
                 (unsigned long)k + 1, name);
    return fault(reader, message);
}

/*
 * Append the cells of the present line as a row of the table; the first cell is the name of the row
 * if rows have names. Returns 0, or -1 with error filled.
 */
static int add_row(text_reader *reader, bool has_row_names)
{
    number_table *table = reader->table;
    if (check_length(reader, table->columns + has_row_names) < 0 || grow(reader, has_row_names) < 0)
        return -1;
    if ((table->rows + 1) * table->columns > NUMBER_VALUES)
        return fault(reader, "too many numbers; a table of at most 8 million is read");
    for (size_t k = 0; k < table->columns; k++)
        if (!is_number(&reader->cell[k + has_row_names],
                       &table->value[table->rows * table->columns + k]))
            return check_cell(reader, k + has_row_names);
    if (has_row_names)
        keep_name(&reader->cell[0], table->row_name[table->rows]);
    table->line[table->rows++] = (uint32_t)reader->line;
    return 0;
}

/*
 * Return the name in a cell of the text table without a unit in brackets after it, as `x [mm]` or
 * `x (mm)`. A number in brackets belongs to the name.
 */
static cell without_unit(cell named)
{
    for (size_t i = 1; i + 1 < named.length; i++)
        if (strchr("[(", named.text[i]) && isalpha((unsigned char)named.text[i + 1]))
            return trimmed(named.text, named.text + i);
    return named;
}

/*
 * Return whether all cells of the present line of the text table are single words, apart from units
 * in brackets: letters, digits, and the characters _ - . between them.
 */
static bool holds_words(const text_reader *reader)
{
    for (size_t k = 0; k < reader->cells; k++) {
        const cell named = without_unit(reader->cell[k]);
        for (size_t i = 0; i < named.length; i++) {
            const unsigned char character = (unsigned char)named.text[i];
            if (!isalnum(character) && !strchr("_-.", character))
                return false;
        }
    }
    return true;
}

/*
 * Refuse a line of column names that holds a few names more or fewer than the text table has
 * columns.
 */
static int refuse_names(const text_reader *reader, size_t names, size_t columns)
{
    char message[NUMBER_ERROR];
    snprintf(message, sizeof message,
             "the comment above has %lu names for %lu columns; name every column, or remove it",
             (unsigned long)names, (unsigned long)columns);
    return fault(reader, message);
}

/*
 * Take the last comment above the first numbers as the names of the columns if it has one word for
 * each column, as in a header that numpy.savetxt writes. The words may have another delimiter than
 * the numbers. Returns 0, or -1 with error filled.
 */
static int take_comment(text_reader *reader)
{
    const size_t columns = reader->cells;
    const char *text = reader->comment.text;
    cell *const numbers = reader->cell;
    const size_t room = reader->room_cells;
    const char delimiter = reader->delimiter;
    int failed = 0;
    if (!text)
        return 0;
    reader->cell = NULL;
    reader->room_cells = 0;
    reader->delimiter = delimiter_of(text, text + reader->comment.length);
    failed = split(reader, text, text + reader->comment.length);
    const bool has_names =
        !failed && reader->cells > 2 && holds_names(reader) && holds_words(reader);
    const bool is_list = has_names && reader->delimiter != ' ';
    if (has_names && reader->cells == columns)
        failed = keep_column_names(reader);
    else if (is_list && reader->cells + 2 >= columns && reader->cells <= columns + 2)
        failed = refuse_names(reader, reader->cells, columns);
    reader->delimiter = delimiter;
    free(reader->cell);
    reader->cell = numbers;
    reader->room_cells = room;
    reader->cells = columns;
    return failed;
}

/*
 * Read all lines of a text table: names of the columns if the first line has no numbers, then the
 * rows. Returns 0, or -1 with error filled.
 */
static int read_lines(text_reader *reader)
{
    double value;
    int more = next_line(reader);
    if (more < 0)
        return -1;
    if (more == 0)
        return fault(reader, "no numbers in the file; write a table of numbers");
    for (size_t k = 0; k < reader->cells; k++)
        if (has_decimal_comma(&reader->cell[k]))
            return check_cell(reader, k);
    reader->first_line = reader->line;
    const bool has_names = holds_names(reader);
    if (!has_names && take_comment(reader) < 0)
        return -1;
    if (has_names && keep_column_names(reader) < 0)
        return -1;
    const size_t named = reader->cells;
    if (has_names)
        more = next_line(reader);
    if (more <= 0)
        return more < 0 ? -1 : fault(reader, "names but no numbers; add the lines of numbers");
    const bool has_row_names = reader->cells > 1 && !is_number(&reader->cell[0], &value) &&
                               is_number(&reader->cell[1], &value);
    if (has_names && check_length(reader, named) < 0)
        return -1;
    if (reader->table->column_name && has_row_names)
        memmove(reader->table->column_name, reader->table->column_name + 1,
                (named - 1) * sizeof *reader->table->column_name);
    reader->table->columns = reader->cells - has_row_names;
    for (; more > 0; more = next_line(reader))
        if (add_row(reader, has_row_names) < 0)
            return -1;
    return more;
}

int table_text_read(number_table *table, const char *bytes, size_t count, char *error)
{
    static const char mark[] = "\xef\xbb\xbf"; /* Byte order mark at the start of a text file in
                                                  UTF-8. */
    text_reader reader = {.table = table, .at = bytes, .end = bytes + count, .error = error};
    if (count >= 3 && memcmp(bytes, mark, 3) == 0)
        reader.at += 3;
    const int failed = read_lines(&reader);
    free(reader.cell);
    return failed;
}
