/* test_fault_limits.c - a daemon that the system gives nothing more. */
#include "cases.h"

#include <sys/resource.h>
#include <unistd.h>

#include "keeper.h"
#include "witness.h"

#define FULL 24 /* clients that hold what descriptors there are */

/* Live while the daemon may not have more than `most` of the resource. Returns what the
 * client was refused, and -1 for its connection. */
static int64_t live_below(enum __rlimit_resource resource, rlim_t most, const char *what)
{
    struct rlimit before;
    struct life life;
    assert_int_equal(prlimit(keeper_pid(), resource, NULL, &before), 0);
    const struct rlimit low = {most, before.rlim_max};
    assert_int_equal(prlimit(keeper_pid(), resource, &low, NULL), 0);
    life_run(&life, keeper_socket(), LIFE_PATIENT);
    assert_int_equal(prlimit(keeper_pid(), resource, &before, NULL), 0);
    if (life.wrong[0] != '\0') {
        fail_msg("%s, at most %llu: %s", what, (unsigned long long)most, life.wrong);
    }
    keeper_expect_peace(what);
    return life.is_lost ? -1 : (int64_t)life.refusals;
}

/* The number of the daemon's next descriptor. */
static int next_descriptor(void)
{
    char path[64];
    int fd = -1;
    do {
        (void)snprintf(path, sizeof path, "/proc/%d/fd/%d", keeper_pid(), ++fd);
    } while (access(path, F_OK) == 0);
    return fd;
}

/* If this failed, clients that use up all descriptors would end the daemon, or keep it
 * busy, or a client would wait for ever. */
CASE(limits__of_descriptors_are_met_in_order)
{
    int lost = 0;
    int refused = 0;
    for (int spare = 0; spare < 6; spare++) {
        int64_t refusals =
            live_below(RLIMIT_NOFILE, (rlim_t)(next_descriptor() + spare), "descriptors");
        lost += refusals < 0;
        refused += refusals > 0;
    }
    assert_true(lost > 0); /* without any: turned away */
    assert_true(refused > 0);
}

/* If this failed, one user's silent connections would be the end of everybody. */
CASE(limits__of_descriptors_leave_those_who_are_there)
{
    int sockets[FULL];
    struct rlimit before;
    assert_int_equal(prlimit(keeper_pid(), RLIMIT_NOFILE, NULL, &before), 0);
    const struct rlimit low = {(rlim_t)next_descriptor() + FULL / 2, before.rlim_max};
    assert_int_equal(prlimit(keeper_pid(), RLIMIT_NOFILE, &low, NULL), 0);
    for (int i = 0; i < FULL; i++) {
        sockets[i] = keeper_connect();
    }
    for (int i = 0; i < 20; i++) {
        test_witness_turn();
    }
    assert_int_equal(prlimit(keeper_pid(), RLIMIT_NOFILE, &before, NULL), 0);
    for (int i = 0; i < FULL; i++) {
        (void)close(sockets[i]);
    }
    keeper_expect_peace("no descriptor left");
}

/* Bytes of address space that the daemon has. */
static rlim_t address_space(void)
{
    char path[64];
    unsigned long long pages = 0;
    (void)snprintf(path, sizeof path, "/proc/%d/statm", keeper_pid());
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%llu", &pages), 1);
    (void)fclose(file);
    return (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

/* If this failed, a daemon whose memory is bounded would not answer, or not go on. */
CASE(limits__of_memory_are_met_in_order)
{
    int met = 0;
#ifdef PCCD_SANITIZED
    test_skip("a sanitizer needs the memory itself");
#endif
    for (rlim_t spare = 0; spare < 1u << 20; spare += 32768) {
        met += live_below(RLIMIT_AS, address_space() + spare, "memory") != 0;
    }
    assert_true(met > 0);
    assert_int_equal(live_below(RLIMIT_AS, address_space() + (64u << 20), "memory"), 0);
}

CASES_WITH(keeper_start, keeper_stop);
