/* witness.h - an honest client that watches while another one misbehaves.
 *
 * Room:     tests/support. May include: crossing.h, daemon.h.
 * Does:     one daemon and one honest client for a whole test program; after every
 *           misdeed the client takes a turn, which must be right and prompt.
 * Threads:  one.
 */
#ifndef TEST_WITNESS_H
#define TEST_WITNESS_H

#include "crossing.h"
#include "daemon.h"
#include "raw.h"

struct test_witness {
    struct test_daemon daemon;
    struct test_crossing crossing;
};

extern struct test_witness test_witness;

/* Group setup and teardown of cmocka. The teardown fails unless the daemon, asked to end,
 * exits with 0. */
int test_witness_start(void **state);
int test_witness_stop(void **state);

/* Fail the test unless the honest client gets a right answer within 5 s. */
void test_witness_turn(void);

/* A raw peer that has said hello; with slot_bytes > 0 also with a ring of 2 slots. */
void test_witness_open_raw(struct test_raw *raw, uint64_t slot_bytes);

/* Descriptors that the daemon has open. */
int test_witness_fd_count(void);

#endif
