/* test_tool_shown.c - names that others chose, on a terminal. */
#include "cases.h"
#include "printable.h"
#include "shown.h"

#include <math.h>

/* If it failed: a file's name could clear the screen, or answer for the user. */
CASE(shown__lets_nothing_control_a_terminal)
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
        /* Right to left from here on, as in "a.rec" for "cer.a". */
        {"\xe2\x80\xae"
         "cer.a",
         "\\xe2\\x80\\xaecer.a"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_string_equal(tool_shown(cases[i].text), cases[i].shown);
        assert_string_equal(tool_shown(tool_shown(cases[i].text)), cases[i].shown);
    }
    assert_string_equal(tool_shown_field("0.1.0\033xyz", 6), "0.1.0\\x1b");
}

/* A code point as UTF-8, and as it is shown when it is not to be seen. */
static void encode(uint32_t at, char text[5], char shown[17])
{
    uint32_t length = at < 0x80 ? 1 : at < 0x800 ? 2 : at < 0x10000 ? 3 : 4;
    memset(text, 0, 5);
    for (uint32_t i = length; i-- > 1; at >>= 6) {
        text[i] = (char)(0x80 | (at & 0x3f));
    }
    text[0] = (char)(length == 1 ? at : (0xf00u >> length & 0xf0) | at);
    for (uint32_t i = 0; i < length; i++) {
        snprintf(shown + 4 * i, 5, "\\x%02x", (unsigned char)text[i]);
    }
}

/* If it failed: a name could look like another one, as what turns text, joins or hides it
 * is not seen itself; or names in other scripts would not be readable any more. */
CASE(shown__has_no_character_that_is_not_seen)
{
    static const uint32_t unseen[] = {
        0x80,    0x9f,    0xad,    0x600,   0x605,   0x61c,   0x6dd,   0x70f,   0x890,
        0x8e2,   0x180e,  0x200b,  0x200c,  0x200d,  0x200e,  0x200f,  0x2028,  0x2029,
        0x202a,  0x202b,  0x202c,  0x202d,  0x202e,  0x2060,  0x2064,  0x2066,  0x2067,
        0x2068,  0x2069,  0x206f,  0xfeff,  0xfff9,  0xfffb,  0x110bd, 0x110cd, 0x13430,
        0x1343f, 0x1bca0, 0x1bca3, 0x1d173, 0x1d17a, 0xe0001, 0xe0020, 0xe007f};
    static const uint32_t seen[] = {0x20,   0x7e,   0xa0,   0xae,    0xe4,
                                    0x5d0,  0x606,  0x627,  0x905,   0x200a,
                                    0x2010, 0x2027, 0x202f, 0x205f,  0x2070,
                                    0x4e2d, 0xfefe, 0xfffc, 0x1f600, 0x10ffff};
    char text[5], shown[17];
    for (size_t i = 0; i < sizeof unseen / sizeof unseen[0]; i++) {
        encode(unseen[i], text, shown);
        assert_string_equal(tool_shown(text), shown);
    }
    for (size_t i = 0; i < sizeof seen / sizeof seen[0]; i++) {
        encode(seen[i], text, shown);
        assert_string_equal(tool_shown(text), text);
    }
}

/* If it failed: half an \xNN or half a character would be shown, or memory overrun. */
CASE(printable__cuts_between_characters)
{
    char to[16];
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
CASE(shown__is_as_wide_as_its_column)
{
    assert_string_equal(tool_shown_column("ab", 4), "ab  ");
    assert_string_equal(tool_shown_column("abcd", 4), "abcd");
    assert_string_equal(tool_shown_column("abcde", 4), "abc+");
    assert_string_equal(tool_shown_column("\xc3\xbc\xc3\xbc\xc3\xbc", 2), "\xc3\xbc+");
    assert_string_equal(tool_shown_cut("ab", 4), "ab");
}

/* If it failed: what meets just before the end would be shown as if it met there. */
CASE(number__below_1_is_not_shown_as_1)
{
    assert_string_equal(tool_shown_number(0.99999999977), "0.9999999998");
    assert_string_equal(tool_shown_number(nextafter(1, 0)), "0.9999999999999999");
    assert_string_equal(tool_shown_number(0.99994), "0.9999");
    assert_string_equal(tool_shown_number(1), "1");
    assert_string_equal(tool_shown_number(-1), "-1");
    assert_string_equal(tool_shown_number(1.00001), "1");
}

/* If it failed: one would be many. */
CASE(plural__goes_with_the_number)
{
    assert_string_equal(proto_plural(0, "vertex", "vertices"), "vertices");
    assert_string_equal(proto_plural(1, "vertex", "vertices"), "vertex");
    assert_string_equal(proto_plural(2, "vertex", "vertices"), "vertices");
}
