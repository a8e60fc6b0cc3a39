/* test_fault_memory.c - no allocation of a client's life may be the daemon's last. */
#include "cases.h"

#include <errno.h>
#include <unistd.h>

#include "keeper.h"
#include "witness.h"

#define CALLS_MAX 100000u /* more than any life takes */
#define MANY      200 /* connections: their user may have 64 sessions, the rest wait */

/* From a different start in every sample of the same stride. */
static uint64_t sweep(uint64_t length, uint64_t stride)
{
    uint64_t tried = 0;
    for (uint64_t first = 1; first < CALLS_MAX; first += stride) {
        if (keeper_try(FAULT_memory, first, length, ENOMEM) == 0) {
            break;
        }
        tried++;
    }
    assert_true(tried > 2);
    return tried;
}

/* If this failed, a client that meets a moment without memory would be told nothing, or
 * take the daemon with it, or leave something behind. */
CASE(memory__runs_out_for_one_allocation)
{
    uint64_t tried = sweep(1, keeper_stride(1));
    print_message("# %llu allocations failed, one a life\n", (unsigned long long)tried);
}

/* If this failed, a daemon would not survive a time without memory: what is freed or
 * taken back on the way must not need any. */
CASE(memory__runs_out_for_a_while)
{
    uint64_t stride = keeper_stride(5);
    uint64_t tried = sweep(3, stride) + sweep(CALLS_MAX, stride);
    print_message("# %llu times memory ran out for a while\n", (unsigned long long)tried);
}

/* If this failed, the event loop would end the process when it has to make room for the
 * descriptor of one client more. */
CASE(memory__runs_out_while_many_connect)
{
    static int sockets[MANY];
    uint64_t refusals = 0;
    fault_order(keeper_page, FAULT_realloc, 1, CALLS_MAX, ENOMEM);
    for (size_t i = 0; i < MANY; i++) {
        sockets[i] = keeper_connect();
        assert_true(sockets[i] >= 0);
    }
    test_witness_turn();
    refusals = fault_recall(keeper_page);
    for (size_t i = 0; i < MANY; i++) {
        (void)close(sockets[i]);
    }
    keeper_expect_peace("many connections");
    print_message("# %llu failures\n", (unsigned long long)refusals);
}

CASES_WITH(keeper_start, keeper_stop);
