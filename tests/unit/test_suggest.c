/* Edit distance and the suggestions made from it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/cli/commands.h"
#include "../../host_tools/text/suggest.h"
#include "../rigs/uniform.h"

enum { TRIALS = 20000, LETTERS = 9 };

/* A word of up to LETTERS letters out of three, so that words are often near each other. */
static void random_word(unsigned *seed, char *word)
{
    const int length = (int)uniform(seed, 0, LETTERS + 1);
    for (int i = 0; i < length; i++)
        word[i] = (char)('a' + (int)uniform(seed, 0, 3));
    word[length] = '\0';
}

/* Known distances: each kind of edit counts one. */
static void test_known(void **state)
{
    (void)state;
    assert_int_equal(suggest_distance("", ""), 0);
    assert_int_equal(suggest_distance("", "abc"), 3);
    assert_int_equal(suggest_distance("kitten", "sitting"), 3);
    assert_int_equal(suggest_distance("sovle", "solve"), 1);
    assert_int_equal(suggest_distance("shpe", "shape"), 1);
    assert_int_equal(suggest_distance("shaape", "shape"), 1);
    assert_int_equal(suggest_distance("ca", "abc"), 3); /* optimal string alignment edits no letter
                                                           twice */
}

/* Laws of a distance: zero only from a word to itself, symmetric, between the difference and the
 * larger of the lengths; one letter more changes it by at most one. */
static void test_laws(void **state)
{
    (void)state;
    unsigned seed = 7;
    for (int t = 0; t < TRIALS; t++) {
        char a[LETTERS + 2], b[LETTERS + 2];
        random_word(&seed, a);
        random_word(&seed, b);
        const int m = (int)strlen(a), n = (int)strlen(b), d = suggest_distance(a, b);
        assert_int_equal(d == 0, strcmp(a, b) == 0);
        assert_int_equal(d, suggest_distance(b, a));
        assert_true(d >= abs(m - n) && d <= (m > n ? m : n));
        strcat(a, "b");
        assert_true(abs(suggest_distance(a, b) - d) <= 1);
    }
}

/* The nearest of the commands for a word with one mistake; nothing for a word that is near none or
 * does not fit. */
static void test_commands(void **state)
{
    (void)state;
    static const char *const typed[][2] = {{"sovle", "solve"},   {"simulat", "simulate"},
                                           {"tabels", "tables"}, {"chekc", "check"},
                                           {"xyzzy", ""},        {"", ""}};
    char text[SUGGEST_TEXT], endless[4 * SUGGEST_NAME];
    suggestion s;
    for (size_t k = 0; k < sizeof typed / sizeof *typed; k++) {
        suggest_begin(&s, typed[k][0]);
        for (int c = 0; c < COMMANDS; c++)
            suggest_consider(&s, command_table[c].name);
        assert_string_equal(s.nearest, typed[k][1]);
    }
    assert_string_equal(suggest_text(&s, text), "");
    memset(endless, 'a', sizeof endless - 1);
    endless[sizeof endless - 1] = '\0';
    suggest_begin(&s, endless);
    suggest_consider(&s, "aaaa");
    suggest_begin(&s, "aaaa");
    suggest_consider(&s, endless);
    assert_string_equal(s.nearest, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_known), cmocka_unit_test(test_laws),
                                       cmocka_unit_test(test_commands)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
