/* parallel.c - the begin and the end of parallel regions. */
#include "parallel.h"

#include <assert.h>
#include <stdbool.h>

static _Thread_local bool is_guest;
static _Thread_local struct common_rounding guests;

void eng_guest_enter(void)
{
    assert(!is_guest);
    guests = common_rounding_enter();
    is_guest = true;
}

void eng_guest_leave(void)
{
    assert(is_guest);
    is_guest = false;
    common_rounding_set(&guests);
}

struct eng_parallel eng_parallel_open(void)
{
    if (is_guest) {
        common_rounding_set(&guests);
    }
    return (struct eng_parallel){.payer = eng_payer()};
}

void eng_parallel_close(void)
{
    if (is_guest) {
        (void)common_rounding_enter();
    }
}
