/* cases.h - a program of cases: what CASE defines is run, in the order of the file. */
#ifndef TEST_CASES_H
#define TEST_CASES_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct test_case {
    int line;
    struct CMUnitTest unit;
    struct test_case *next;
};

void test_case_add(struct test_case *added);

/* Set what is done before the first case and after the last one; NULL: nothing. */
void test_group_set(CMFixtureFunction set_up, CMFixtureFunction tear_down);

/* Memory of zeros for free(), and a copy of what may be nothing. Both fail the case where
 * there is no memory. */
void *test_room(size_t bytes);
void *test_copy(const void *from, size_t bytes);

/* The call succeeds: its status is 0. */
#define assert_ok(call) assert_int_equal(call, 0)

#define CASE(name) CASE_WITH(name, NULL, NULL)

/* A case with something to be done before and after it; NULL: nothing. Both leave what
 * they have in *state. */
#define CASE_WITH(name, set_up, tear_down)                                               \
    static void name(void **state);                                                      \
    __attribute__((constructor)) static void add_##name(void)                            \
    {                                                                                    \
        static struct test_case added = {                                                \
            __LINE__, {#name, name, set_up, tear_down, NULL}, NULL};                     \
        test_case_add(&added);                                                           \
    }                                                                                    \
    static void name(__attribute__((unused)) void **state)

/* For all cases of the program, once. */
#define CASES_WITH(set_up, tear_down)                                                    \
    __attribute__((constructor)) static void set_group(void)                             \
    {                                                                                    \
        test_group_set(set_up, tear_down);                                               \
    }                                                                                    \
    _Static_assert(true, "takes a semicolon")

/* ---- skipping ---------------------------------------------------------------------- */

/* Does not return. `why` is a text of one line without '#'. */
#define test_skip(why)                                                                   \
    do {                                                                                 \
        printf("# skipped: %s\n", (why));                                                \
        skip();                                                                          \
    } while (0)

/* Skips where an emulator runs the program, as $PCCD_EMULATOR of `make check` says. */
#define test_skip_emulated(why)                                                          \
    do {                                                                                 \
        const char *test_emulator = getenv("PCCD_EMULATOR");                             \
        if (test_emulator != NULL && test_emulator[0] != '\0') {                         \
            test_skip(why);                                                              \
        }                                                                                \
    } while (0)

#define TEST_ONLY_ROOT "only root can act as another user"

#endif
