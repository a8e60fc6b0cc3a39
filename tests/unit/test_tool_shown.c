/* tests/unit/test_tool_shown.c - names that others chose, on a terminal.
 *
 * Room:     client/tool (shown.h, printable.h, plural.h).
 * Does:     compares what is shown with what was worked out by hand.
 * Threads:  one.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "plural.h"
#include "printable.h"
#include "shown.h"

/* If it failed: a file's name could clear the screen, or answer for the user. */
static void shown__lets_nothing_control_a_terminal(void **state)
{
    static const struct {
        const char *text, *shown;
    } cases[] = {
        {"plain \\ name", "plain \\ name"},
        {"\033[2J\a\r\n\t\177", "\\x1b[2J\\x07\\x0d\\x0a\\x09\\x7f"},
        {"gr\xc3\xbc\xc3\x9f", "gr\xc3\xbc\xc3\x9f"}, /* UTF-8 */
        {"\xc2\x9b"
         "2J\xc2\xa0",
         "\\xc2\\x9b2J\xc2\xa0"}, /* CSI in eight bits */
        {"\x9b"
         "2J\xff",
         "\\x9b2J\\xff"},                                      /* no UTF-8 */
        {"\xc0\xaf\xed\xa0\x80", "\\xc0\\xaf\\xed\\xa0\\x80"}, /* overlong, surrogate */
        {"cut \xe2\x82", "cut \\xe2\\x82"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_string_equal(tool_shown(cases[i].text), cases[i].shown);
        assert_string_equal(tool_shown(tool_shown(cases[i].text)), cases[i].shown);
    }
    assert_string_equal(tool_shown_field("0.1.0\033xyz", 6), "0.1.0\\x1b");
}

/* If it failed: half an \xNN or half a character would be shown, or memory overrun. */
static void printable__cuts_between_characters(void **state)
{
    char to[16];
    (void)state;
    memset(to, 'z', sizeof to);
    assert_int_equal(proto_printable("ab\033c", 4, to, 6), 7);
    assert_string_equal(to, "ab");
    assert_int_equal(to[6], 'z');
    assert_int_equal(proto_printable("ab\033c", 4, to, 7), 7);
    assert_string_equal(to, "ab\\x1b");
    assert_int_equal(proto_printable("\xc3\xbc\xc3\xbc", 4, to, 4), 4);
    assert_string_equal(to, "\xc3\xbc");
    assert_int_equal(proto_printable("a\0b", 3, to, sizeof to), 6);
    assert_string_equal(to, "a\\x00b");
    assert_int_equal(proto_printable("abc", 3, NULL, 0), 3);
}

/* If it failed: a table's columns would not stand below each other. */
static void shown__is_as_wide_as_its_column(void **state)
{
    (void)state;
    assert_string_equal(tool_shown_column("ab", 4), "ab  ");
    assert_string_equal(tool_shown_column("abcd", 4), "abcd");
    assert_string_equal(tool_shown_column("abcde", 4), "abc+");
    assert_string_equal(tool_shown_column("\xc3\xbc\xc3\xbc\xc3\xbc", 2), "\xc3\xbc+");
    assert_string_equal(tool_shown_cut("ab", 4), "ab");
}

/* If it failed: one would be many. */
static void plural__goes_with_the_number(void **state)
{
    (void)state;
    assert_string_equal(proto_plural(0, "vertex", "vertices"), "vertices");
    assert_string_equal(proto_plural(1, "vertex", "vertices"), "vertex");
    assert_string_equal(proto_plural(2, "vertex", "vertices"), "vertices");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shown__lets_nothing_control_a_terminal),
        cmocka_unit_test(printable__cuts_between_characters),
        cmocka_unit_test(shown__is_as_wide_as_its_column),
        cmocka_unit_test(plural__goes_with_the_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
