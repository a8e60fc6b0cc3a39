/* witness.h - an honest client that must be served while another one misbehaves. */
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

/* Begin a step that works for a good while, in a scene of its own: 1000 triangles all
 * over each other in one plane. The peer has a ring of slots of 65536 bytes. Returns the
 * request's id. */
uint32_t test_witness_long_step(struct test_raw *raw);

/* Descriptors that the daemon has open. */
int test_witness_fd_count(void);

#endif
