/* cases.c - the main function of programs of cases. */
#include "cases.h"

#include <errno.h> /* program_invocation_short_name */

static struct test_case *first; /* by their lines: constructors run in any order */
static size_t count;
static CMFixtureFunction group_set_up;
static CMFixtureFunction group_tear_down;

void test_case_add(struct test_case *added)
{
    struct test_case **at = &first;

    while (*at != NULL && (*at)->line < added->line) {
        at = &(*at)->next;
    }
    added->next = *at;
    *at = added;
    count++;
}

void test_group_set(CMFixtureFunction set_up, CMFixtureFunction tear_down)
{
    group_set_up = set_up;
    group_tear_down = tear_down;
}

void *test_room(size_t bytes)
{
    void *room = calloc(1, bytes + 1);
    assert_non_null(room);
    return room;
}

void *test_copy(const void *from, size_t bytes)
{
    void *copy = test_room(bytes);
    if (bytes > 0) {
        memcpy(copy, from, bytes);
    }
    return copy;
}

int main(void)
{
    struct CMUnitTest *units = calloc(count, sizeof *units);
    size_t at = 0;

    if (units == NULL) {
        return 1;
    }
    for (struct test_case *added = first; added != NULL; added = added->next) {
        units[at++] = added->unit;
    }
    int failed = _cmocka_run_group_tests(program_invocation_short_name, units, count,
                                         group_set_up, group_tear_down);
    free(units);
    return failed;
}
